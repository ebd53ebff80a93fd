//! `sinew demo`: a synthetic walker is recorded to files and tracked, and the truth is known.
//!
//! The walker has other sizes with every seed.
//!
//! Mean error: distance between the points of the mean pose and the true ones, over frames and the fifteen joints of pose evaluation. Coverage: share of true
//! coordinates inside their 90 % intervals, over the same. The cameras differ from their calibration as real ones do, which shifts a whole run: the coverage of one demo is near all or nothing, however right its intervals, and within the run it is not.

use super::answer_args::Answer;
use super::args::General;
use super::ended::Ended;
use super::error::Error;
use super::report::{self, Report};
use super::simulated_files::{CALIBRATION, FOLDERS, TRUTH, is_of_recording};
use super::table::aligned;
use super::terminal::Terminal;
use serde_json::json;
use sinew::body::standard::EVALUATION_JOINTS;
use sinew::config::{Resolved, Sources, common, resolve};
use sinew::core::random::Stage;
use sinew::formats;
use sinew::input::in_memory::InMemory;
use sinew::run::claimed::claimed;
use sinew::run::listener::watched;
use sinew::run::threads::{wanted, with_threads};
use sinew::track::job::{self, Outcome};
use sinew_report::written_page;
use sinew_results::{LOCK_NAME, is_incomplete, is_own};
use sinew_simulate::adult;
use sinew_simulate::calibration_error::CalibrationError;
use sinew_simulate::detector::DetectorNoise;
use sinew_simulate::recording::{Script, SyntheticRecording};
use std::collections::BTreeMap;
use std::path::Path;

/// Default output folder.
const OUT: &str = "sinew-out/demo";

/// Runs the command.
pub(crate) fn run(answer: Answer, general: &General, report: &Report) -> Result<Ended, Error> {
    let terminal = Terminal { general, report };
    let noise = DetectorNoise { offset_px: 0.0, ..DetectorNoise::DETECTOR_LIKE };
    let script = Script { calibration: CalibrationError::USUAL, noise, ..Script::default() };
    let resolved = settings(general, &script)?;
    let mut config = resolved.track();
    // A former demo is no loss.
    config.force |= is_own(&config.out, TRUTH);
    let claim = claimed(&config, &[], &terminal)?;
    let seed = config.seed;
    let script = Script { proportions: adult::drawn(&Stage::new(seed, "walker")), ..script };
    let recording = SyntheticRecording::new(&script, seed).map_err(Error::Demo)?;
    let files = recording_files(&recording).map_err(sinew::Error::io("write", config.out.join(TRUTH)))?;
    claim.refuse_others(files.keys())?;
    let frames = recording.truth.frames.len() as u64;
    let mut source = InMemory {
        cameras: recording.cameras.clone(),
        layout: recording.layout.clone(),
        keypoints: recording.keypoints.clone(),
    };
    let outcome = watched(&terminal, |watch| {
        with_threads(wanted(&config), || job::track(&mut source, 0..frames, &resolved, claim, watch, None))
    })?;
    report.warnings(&outcome.summary.warnings);
    if !outcome.summary.complete && !is_incomplete(&config.out) {
        report.note("interrupted; the demo that was there is as it was");
        return Ok(Ended::Interrupted);
    }
    config.force = true;
    let claim = claimed(&config, &[], &terminal)?;
    let staged = claim.staged()?;
    files.iter().try_for_each(|(name, bytes)| staged.write(name, bytes))?;
    staged.finish(is_of_recording)?;
    drop(claim);
    let request = written_page::with_calibration(&config.out.join(CALIBRATION));
    written_page::write(&config.out, &request, &config.out.join(sinew_results::PAGE_NAME), &terminal)?;
    answer_of(&recording, &outcome, &config.out, answer)?;
    for failed in &outcome.summary.failed_diagnostics {
        report.failed(failed);
    }
    if !outcome.summary.complete {
        report.note("interrupted; what was done is written and marked incomplete");
    }
    Ok(if outcome.summary.complete { Ended::Done } else { Ended::Interrupted })
}

fn settings(general: &General, script: &Script) -> Result<Resolved, Error> {
    let mut flags = general.settings();
    if !flags.iter().any(|(key, _)| *key == common::OUT.key) {
        flags.push((common::OUT.key, OUT.into()));
    }
    flags.push((common::FPS.key, script.rate_hz.to_string()));
    // The demo is the same everywhere: no files and no environment.
    Ok(resolve(&Sources { flags, environment: Vec::new(), file: general.config.clone() })?)
}

/// The recording as files that `sinew track` reads, by name.
fn recording_files(recording: &SyntheticRecording) -> std::io::Result<BTreeMap<String, Vec<u8>>> {
    let keypoints = recording.keypoint_files();
    let mut files: BTreeMap<String, Vec<u8>> =
        keypoints.into_iter().map(|(name, text)| (format!("{}/{name}", FOLDERS[0]), text.into_bytes())).collect();
    files.insert(CALIBRATION.into(), recording.calibration_toml().into_bytes());
    let mut truth = Vec::new();
    recording.write_truth_trc(&mut truth)?;
    files.insert(TRUTH.into(), truth);
    Ok(files)
}

/// How near results are to the truth.
struct Compared {
    /// Mean error, millimetres.
    error_mm: f64,
    /// Share of true coordinates inside their 90 % intervals.
    coverage: f64,
    /// The same once the shift that the whole run shares, the mean of truth − mean, is taken off both.
    coverage_within: f64,
}

/// Standard deviations to the end of a 90 % interval.
const HALF_WIDTH: f64 = 1.645;

/// Compares the files just written with the truth.
fn compare(recording: &SyntheticRecording, out: &Path) -> Result<Compared, Error> {
    let path = out.join("joints.csv");
    let text = sinew::files::read_text(&path, formats::source_text::MAX_TEXT_BYTES)?;
    let table = formats::tidy_csv::read_cells(&path.display().to_string(), &text).map_err(sinew::Error::from)?;
    let column = |name: &str| table.columns.iter().position(|column| column == name).unwrap_or(usize::MAX);
    let (frame, joint) = (column("frame"), column("joint"));
    let places =
        ["mean", "q05", "q95", "sd_within"].map(|what| ["x", "y", "z"].map(|axis| column(&format!("{axis}_{what}_m"))));
    let index: BTreeMap<&str, usize> =
        recording.truth.names.iter().enumerate().map(|(i, name)| (name.as_str(), i)).collect();
    let (mut distance, mut inside) = (0.0, 0.0);
    let mut within: Vec<[[f64; 3]; 2]> = vec![];
    for (_, row) in &table.rows {
        let cell = |column: usize| row.get(column).map_or("", String::as_str);
        let number = |column: usize| cell(column).parse::<f64>().unwrap_or(f64::NAN);
        let name = cell(joint);
        let truth = cell(frame)
            .parse()
            .ok()
            .and_then(|frame: usize| Some(recording.truth.frames.get(frame)?[*index.get(name)?]));
        let Some(truth) = truth.filter(|_| EVALUATION_JOINTS.contains(&name)) else { continue };
        let [mean, low, high, sd_within] = places.map(|columns| columns.map(number));
        distance += (0..3).map(|k| (mean[k] - truth[k]).powi(2)).sum::<f64>().sqrt();
        inside += (0..3).filter(|&k| low[k] <= truth[k] && truth[k] <= high[k]).count() as f64;
        within.push([[0, 1, 2].map(|k: usize| truth[k] - mean[k]), sd_within]);
    }
    let joints = within.len() as f64;
    let shift = [0, 1, 2].map(|k: usize| within.iter().map(|[error, _]| error[k]).sum::<f64>() / joints);
    let is_within = |[error, sd]: &[[f64; 3]; 2], k: usize| (error[k] - shift[k]).abs() <= HALF_WIDTH * sd[k];
    let held: usize = within.iter().map(|point| (0..3).filter(|&k| is_within(point, k)).count()).sum();
    Ok(Compared {
        error_mm: 1e3 * distance / joints,
        coverage: inside / (3.0 * joints),
        coverage_within: held as f64 / (3.0 * joints),
    })
}

/// The answer: how near the results are to the truth, and the line that opens their page.
fn answer_of(recording: &SyntheticRecording, outcome: &Outcome, out: &Path, answer: Answer) -> Result<(), Error> {
    let Compared { error_mm, coverage, coverage_within } = compare(recording, out)?;
    let summary = &outcome.summary;
    let shown = out.display();
    if answer.json {
        return report::answer_json(&json!({
            "frames": summary.frame_count,
            "cameras": recording.cameras.len(),
            "method": summary.method,
            "mean_error_mm": error_mm,
            "coverage_90": coverage,
            "coverage_90_within": coverage_within,
            "ms_per_frame": outcome.ms_per_frame,
            "out": out.to_string_lossy(),
        }));
    }
    let rows = [
        (
            "simulated",
            format!(
                "a walker in front of {} cameras, {} frames at {} per second",
                recording.cameras.len(),
                summary.frame_count,
                recording.rate_hz
            ),
        ),
        ("method", format!("{}, seed {}", summary.method, summary.seed)),
        ("mean error", format!("{error_mm:.1} mm over {} joints", EVALUATION_JOINTS.len())),
        ("coverage", format!("{:.0} % of true coordinates lie in their 90 % intervals", 100.0 * coverage)),
        ("within", format!("{:.0} % once the shift that the whole run shares is taken off", 100.0 * coverage_within)),
        ("speed", format!("{:.1} ms per frame", outcome.ms_per_frame)),
        ("results", shown.to_string()),
    ];
    let rows: Vec<(String, String)> = rows.map(|(left, right)| (left.to_owned(), right)).into();
    let next = format!(
        "\nNext, the same from files, and then from yours:\n  sinew track --calibration {shown}/Calib.toml --keypoints {shown}/keypoints --layout BODY_25B --fps {} -o sinew-out/demo-track\n\nA page that shows the result:\n  {}\n",
        recording.rate_hz,
        written_page::opening(&out.join(sinew_results::PAGE_NAME))
    );
    debug_assert!(!out.join(LOCK_NAME).exists());
    report::answer(&(aligned(&rows) + &next))
}
