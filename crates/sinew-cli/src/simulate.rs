//! `sinew simulate`: a recording of a simulated person, with everything that a tracker may want.

use super::args::{General, SimulateArgs};
use super::ended::Ended;
use super::error::Error;
use super::progress::Progress;
use super::report::{self, Report};
use super::simulate_crowd;
use super::simulated_files::{CALIBRATION, FOLDERS, README, TRUTH, WALK_S, cameras, is_of_recording, track_command};
use super::table::aligned;
use super::terminal::Terminal;
use rayon::prelude::*;
use serde_json::json;
use sinew::body::points::{Trajectories, points_of_states};
use sinew::config::{Sources, TrackConfig, common, resolve};
use sinew::core::random::Stage;
use sinew::formats::{calib_toml, mask, picture};
use sinew::run::claimed::claimed;
use sinew::run::threads::{wanted, with_threads};
use sinew_motion::convert::{RecordedJoints, recorded_joints};
use sinew_results::Staged;
use sinew_simulate::detector::{DetectorNoise, STATED_ROWS, detect};
use sinew_simulate::footage::SyntheticFootage;
use sinew_simulate::recording::{body_25b, keypoint_files, write_trc};
use sinew_simulate::ring::{Ring, subject_px_and_extent_m};
use sinew_simulate::segmentation_noise::Level;
use sinew_simulate::walker::{Gait, Walker, walker_states};
use std::path::{Path, PathBuf};

/// Default output folder.
const OUT: &str = "sinew-out/simulated";
/// The motion that needs no file.
const WALK: &str = "walk";
/// More frames than anybody looks at.
const MOST_FRAMES: usize = 1_000_000;

/// Runs the command.
pub(crate) fn run(args: &SimulateArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    let config = settings(general)?;
    if args.people > 1 {
        check_numbers(args)?;
        return match args.motion.as_os_str() == WALK {
            true => simulate_crowd::run(args, &config, general, report),
            false => Err(Error::CrowdOfMotion),
        };
    }
    let (motion, inputs) = motion(args, report)?;
    refuse_inputs_inside(&config.out, &inputs)?;
    let claim = claimed(&config, &inputs, &Terminal { general, report })?;
    let ring = Ring { cameras: args.cameras, image_size_px: args.size.map(f64::from), ..Ring::SMALL_PICTURES };
    let footage = SyntheticFootage::new(motion, args.fps, &ring, config.seed).map_err(Error::Scene)?;
    report.warnings(small_person(&footage, &ring).as_slice());
    let staged = claim.staged()?;
    write_points(&footage, config.seed, &staged)?;
    let total = footage.frames();
    with_threads(wanted(&config), || {
        let mut progress = Progress::start(general, "simulate", total as u64);
        for frame in 0..total {
            let write_camera = |camera| write_images(&footage, camera, frame, args, &staged);
            (0..footage.cameras.len()).into_par_iter().try_for_each(write_camera)?;
            progress.at(frame as u64 + 1);
        }
        Ok::<(), sinew::Error>(())
    })?;
    staged.write(README, readme(args, &config, &footage).as_bytes())?;
    staged.finish(is_of_recording)?;
    drop(claim);
    answer(args, &config, &footage)?;
    Ok(Ended::Done)
}

fn settings(general: &General) -> Result<TrackConfig, Error> {
    let resolved = resolve(&Sources { flags: general.settings(), environment: Vec::new(), file: None })?;
    Ok(resolved.with_default(&common::OUT, Some(OUT.into())).track())
}

/// The motion, and the files that it is read from.
fn motion(args: &SimulateArgs, report: &Report) -> Result<(Trajectories, Vec<PathBuf>), Error> {
    let most = check_numbers(args)?;
    let (mut motion, inputs) = if args.motion.as_os_str() == WALK {
        if args.skeleton.is_some() {
            return Err(Error::SkeletonOfWalk);
        }
        let duration_s = args.duration.unwrap_or(WALK_S);
        let walker = Walker::new(Gait { duration_s, ..Gait::default() });
        (points_of_states(&walker.body, &walker_states(&walker, args.fps)), vec![])
    } else {
        let RecordedJoints { motion, warnings, .. } =
            recorded_joints(&args.motion, args.skeleton.as_deref(), None, |_| args.fps)?;
        report.warnings(&warnings);
        (motion, [Some(args.motion.clone()), args.skeleton.clone()].into_iter().flatten().collect())
    };
    motion.frames.truncate(most);
    match motion.frames.len() {
        0 => Err(Error::NoFrames),
        frames if frames > MOST_FRAMES => Err(Error::TooManyFrames(MOST_FRAMES)),
        _ => Ok((motion, inputs)),
    }
}

/// Refuses rates and durations that are no numbers or too many frames; gives the most frames.
fn check_numbers(args: &SimulateArgs) -> Result<usize, Error> {
    for (flag, value) in [("fps", Some(args.fps)), ("duration", args.duration)] {
        if let Some(value) = value.filter(|value| !(*value > 0.0 && value.is_finite())) {
            return Err(Error::NotPositive { flag, value, help: "for example 30" });
        }
    }
    let frames = |duration_s: f64| (duration_s * args.fps).round() as usize;
    let most = args.duration.map_or(MOST_FRAMES, frames);
    if most > MOST_FRAMES || args.fps > MOST_FRAMES as f64 {
        return Err(Error::TooManyFrames(MOST_FRAMES));
    }
    if most == 0 { Err(Error::NoFrames) } else { Ok(most) }
}

/// What is replaced must not be what was read.
fn refuse_inputs_inside(out: &Path, inputs: &[PathBuf]) -> Result<(), sinew_results::Error> {
    let Ok(folder) = out.canonicalize() else { return Ok(()) };
    let inside = |input: &&PathBuf| input.canonicalize().is_ok_and(|input| input.starts_with(&folder));
    match inputs.iter().find(inside) {
        Some(input) => Err(sinew_results::Error::OutputIsInput { path: out.to_owned(), input: input.clone() }),
        None => Ok(()),
    }
}

/// Height of the person in the images below which they show little of a pose, pixels.
const LEAST_PX: f64 = 40.0;

/// A warning about a motion that goes so far that cameras which see all of it hardly see the person.
fn small_person(footage: &SyntheticFootage, ring: &Ring) -> Option<String> {
    let (height_px, extent_m) = subject_px_and_extent_m(footage.cameras.first()?, &footage.motion, ring);
    (height_px < LEAST_PX).then(|| {
        format!(
            "the motion covers {extent_m:.0} m, and cameras that see all of it show the person {height_px:.0} px tall: tracking will fail; ask for less with `--duration` (a walk makes 1.2 m a second), or for larger images with `--size`"
        )
    })
}

/// Calibration, keypoints and truth.
fn write_points(footage: &SyntheticFootage, seed: u64, out: &Staged<'_>) -> Result<(), sinew::Error> {
    let rows = footage.cameras.first().map_or(STATED_ROWS, |camera| camera.image_size_px[1]);
    let noise = DetectorNoise::DETECTOR_LIKE.in_rows(rows);
    let stage = Stage::new(seed, "synthetic recording");
    let found = detect(&footage.motion, &body_25b(), (&footage.cameras, &[]), &noise, stage);
    for (name, text) in keypoint_files(&footage.cameras, &found.keypoints) {
        out.write(&format!("{}/{name}", FOLDERS[0]), text.as_bytes())?;
    }
    out.write(CALIBRATION, calib_toml::write(&footage.cameras).as_bytes())?;
    let mut truth = Vec::new();
    write_trc(&mut truth, TRUTH, &footage.motion, footage.rate_hz).map_err(sinew::Error::io("write", TRUTH))?;
    Ok(out.write(TRUTH, &truth)?)
}

/// Mask and picture of a camera in a frame.
fn write_images(
    footage: &SyntheticFootage,
    camera: usize,
    frame: usize,
    args: &SimulateArgs,
    out: &Staged<'_>,
) -> Result<(), sinew::Error> {
    let name = format!("{}_{frame:04}.png", footage.cameras[camera].name);
    let path = format!("{}/{name}", FOLDERS[1]);
    let level = Level::named(&args.segmentation).unwrap_or_default();
    let silhouette = footage.mask(camera, frame, level);
    let mut bytes = Vec::new();
    mask::write(&mut bytes, &silhouette).map_err(sinew::Error::io("write", &path))?;
    out.write(&path, &bytes)?;
    if args.images.0.is_some_and(|every| frame.is_multiple_of(every)) {
        let path = format!("{}/{name}", FOLDERS[2]);
        let seen = footage.picture(camera, frame);
        bytes.clear();
        picture::write_png(&mut bytes, &seen).map_err(sinew::Error::io("write", &path))?;
        out.write(&path, &bytes)?;
    }
    Ok(())
}

/// The command that tracks its silhouettes.
fn silhouette_command(folder: &str, fps: f64) -> String {
    format!(
        "sinew track --calibration {folder}/{CALIBRATION} --silhouettes {folder}/{} --init {folder}/{TRUTH} --method annealed --fps {fps} -o {folder}-silhouettes",
        FOLDERS[1]
    )
}

/// The command that draws what was found.
fn overlay_command(folder: &str) -> String {
    format!(
        "sinew overlay {folder}-silhouettes --calibration {folder}/{CALIBRATION} --silhouettes {folder}/{} --every 10 -o {folder}-pictures",
        FOLDERS[1]
    )
}

fn readme(args: &SimulateArgs, config: &TrackConfig, footage: &SyntheticFootage) -> String {
    let Trajectories { names, frames } = &footage.motion;
    let folder = config.out.file_name().unwrap_or_default().to_string_lossy();
    format!(
        "A synthetic recording by sinew {}: motion {}, {} frames at {} per second, {}, seed {}.\n\n\
         {CALIBRATION}   cameras\n\
         keypoints/   what a detector with errors found, BODY_25B\n\
         masks/       silhouettes, segmentation `{}`: <camera>_<frame>.png, one bit a pixel, white is the person\n\
         images/      pictures of some frames, if any were requested\n\
         {TRUTH}    the true positions of {} points\n\n\
         To track it, from the folder above:\n  {}\n\n\
         The same from its silhouettes, and pictures of what was found:\n  {}\n  {}\n",
        env!("CARGO_PKG_VERSION"),
        args.motion.display(),
        frames.len(),
        args.fps,
        cameras(footage.cameras.len()),
        config.seed,
        args.segmentation,
        names.len(),
        track_command(&folder, args.fps),
        silhouette_command(&folder, args.fps),
        overlay_command(&folder),
    )
}

/// Where the recording is, and commands for it.
fn answer(args: &SimulateArgs, config: &TrackConfig, footage: &SyntheticFootage) -> Result<(), Error> {
    let out = config.out.display().to_string();
    if args.answer.json {
        return report::answer_json(&json!({
            "frames": footage.frames(),
            "cameras": footage.cameras.len(),
            "rate_hz": args.fps,
            "segmentation": args.segmentation,
            "seed": config.seed,
            "out": out,
        }));
    }
    let rows = [
        ("motion", args.motion.display().to_string()),
        ("frames", format!("{} at {} per second, {}", footage.frames(), args.fps, cameras(footage.cameras.len()))),
        ("masks", format!("segmentation {}, seed {}", args.segmentation, config.seed)),
        ("written", out.clone()),
    ];
    let rows: Vec<(String, String)> = rows.map(|(left, right)| (left.to_owned(), right)).into();
    let next = [track_command(&out, args.fps), silhouette_command(&out, args.fps), overlay_command(&out)];
    report::answer(&format!("{}\nNext:\n  {}\n", aligned(&rows), next.join("\n  ")))
}
