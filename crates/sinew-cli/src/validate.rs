//! `sinew validate`: leaves each camera out in turn and holds what it sees against what the others predict.

use super::args::{General, ValidateArgs};
use super::ended::Ended;
use super::error::Error;
use super::report::{self, Report};
use super::table::aligned;
use super::terminal::Terminal;
use serde_json::json;
use sinew::config::common::{CAMERAS, PERSON};
use sinew::config::{Resolved, TrackConfig};
use sinew::input::recording::{Recording, RecordingOptions};
use sinew::input::roll::Roll;
use sinew::predict::predict;
use sinew::run::settings::{settings, with_stated_rate};
use sinew::run::whom::{Whom, looked_for};
use sinew::run::{calibration, read_from, track_alone};
use sinew_analysis::validate::{LEVELS, LeftOut, left_out, sentence, to_csv, to_svg, together};
use sinew_results::{Occupied, Summary, write_whole};
use std::path::Path;

/// Files of the command, beside the runs without a camera.
const FILES: [&str; 2] = ["validation.csv", "reliability.svg"];

/// Runs the command.
pub(crate) fn run(args: &ValidateArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    let given = [&args.settings.given[..], &general.settings()].concat();
    let resolved = with_stated_rate(settings(&given, general.config.as_deref())?, &Terminal { general, report })?;
    report.warnings(&resolved.warnings);
    let config = resolved.track();
    let calibration = calibration(&config)?;
    let Some(keypoints) = config.keypoints.clone() else { return Err(Error::NothingToValidate) };
    let cameras = Recording::open(&calibration, &keypoints, &config.recording)?;
    let cameras: Vec<String> = cameras.cameras().iter().map(|camera| camera.name.clone()).collect();
    if cameras.len() < 3 {
        return Err(Error::TooFewToLeaveOut(cameras.len()));
    }
    if config.setup.is_some() {
        return Err(Error::SetupToValidate);
    }
    if let Some(path) = FILES.map(|name| config.out.join(name)).into_iter().find(|path| path.exists())
        && !config.force
    {
        return Err(sinew_results::Error::OutputExists { path, found: Occupied::File }.into());
    }
    let chosen = chosen(&resolved, &calibration, general, report)?;
    let (mut found, mut said): (Vec<LeftOut>, Said) = (vec![], Said::default());
    for (place, camera) in cameras.iter().enumerate() {
        let others: Vec<&str> = cameras.iter().filter(|other| *other != camera).map(String::as_str).collect();
        let folder = sinew_results::place(&config.out, format!("without_{camera}"))?;
        let run = resolved.clone().with_flag(&CAMERAS, &others.join(","))?.into_folder(&folder);
        report.detail(&format!("without {camera}"));
        let chosen = chosen.as_ref().map(|(roll, person)| (roll.without_view(place), *person));
        let chosen = chosen.as_ref().map(|(roll, person)| (roll, *person));
        let read_from = read_from(&config, &calibration, general.config.as_deref());
        let outcome = track_alone(&run, chosen, &read_from, &Terminal { general, report })?;
        if !outcome.summary.complete {
            report.note("interrupted; nothing can be said about the intervals yet");
            return Ok(Ended::Interrupted);
        }
        said.add(camera, &outcome.summary);
        found.push(held_against(&config, &calibration, &keypoints, camera, &folder)?);
    }
    write_whole(&config.out.join(FILES[0]), to_csv(&found).as_bytes())?;
    write_whole(&config.out.join(FILES[1]), to_svg(&found).as_bytes())?;
    report.warnings(&Said::by_run(&said.warnings));
    answer(&found, args, &config.out)?;
    Said::by_run(&said.failed).iter().for_each(|failed| report.failed(failed));
    Ok(if said.failed.is_empty() { Ended::Done } else { Ended::Doubtful })
}

/// Everybody and the place of the one whom `--person` names, if it does and there are several.
///
/// All cameras say who is who, also the one that is left out afterwards: numbers are then the same in every run.
fn chosen(
    resolved: &Resolved,
    calibration: &Path,
    general: &General,
    report: &Report,
) -> Result<Option<(Roll, usize)>, Error> {
    if resolved.of(&PERSON).is_none() {
        return Ok(None);
    }
    let (_, whom) = looked_for(resolved, calibration, &Terminal { general, report }, || Ok(None))?;
    Ok(if let Whom::One(roll, person) = whom { Some((roll, person)) } else { None })
}

/// What the runs said, each text with the cameras that were left out when it was said.
#[derive(Default)]
struct Said {
    warnings: Vec<(String, Vec<String>)>,
    failed: Vec<(String, Vec<String>)>,
}

impl Said {
    fn add(&mut self, camera: &str, summary: &Summary) {
        let all = [(&mut self.warnings, &summary.warnings), (&mut self.failed, &summary.failed_diagnostics)];
        for (known, texts) in all {
            for text in texts {
                match known.iter_mut().find(|(own, _)| own == text) {
                    Some((_, runs)) => runs.push(camera.to_owned()),
                    None => known.push((text.clone(), vec![camera.to_owned()])),
                }
            }
        }
    }

    fn by_run(said: &[(String, Vec<String>)]) -> Vec<String> {
        said.iter().map(|(text, runs)| format!("without {}: {text}", runs.join(", "))).collect()
    }
}

/// What the camera saw against what the run in a folder predicts.
fn held_against(
    config: &TrackConfig,
    calibration: &Path,
    keypoints: &Path,
    camera: &str,
    folder: &Path,
) -> Result<LeftOut, Error> {
    let prediction = predict(folder, calibration, camera)?;
    let options = RecordingOptions { cameras: Some(vec![camera.to_owned()]), ..config.recording.clone() };
    let mut recording = Recording::open(calibration, keypoints, &options)?;
    let columns: Vec<Option<usize>> = prediction.keypoints.iter().map(|name| recording.layout().index(name)).collect();
    let mut people = vec![];
    for number in &prediction.frames {
        people.push(recording.people(*number)?.pop().unwrap_or_default());
    }
    Ok(left_out(&prediction, &people, &columns))
}

/// A table, and a sentence.
fn answer(found: &[LeftOut], args: &ValidateArgs, out: &Path) -> Result<(), Error> {
    let all = together(found);
    if args.answer.json {
        let camera = |left: &LeftOut| {
            let tally = left.all();
            json!({
                "camera": left.camera,
                "observations": tally.squares.len(),
                "offset_px": left.offset_px,
                "offset_size": left.offset_size,
                "error_median_px": tally.quantile_px(0.5),
                "error_90_px": tally.quantile_px(0.9),
                "inside": LEVELS.map(|level| tally.coverage(level)),
                "log_score": tally.log_score(),
            })
        };
        return report::answer_json(&json!({
            "levels": LEVELS,
            "cameras": found.iter().map(camera).collect::<Vec<_>>(),
            "inside": LEVELS.map(|level| all.coverage(level)),
            "error_median_px": all.quantile_px(0.5),
            "error_90_px": all.quantile_px(0.9),
            "log_score": all.log_score(),
            "calibration_error": all.calibration_error(),
            "sentence": sentence(found),
            "out": out.to_string_lossy(),
        }));
    }
    let percent = |x: f64| format!("{:3.0}", 100.0 * x);
    let row = |name: &str, tally: &sinew_analysis::validate::ObservationTally| {
        let inside = LEVELS.map(|level| percent(tally.coverage(level))).join(" ");
        (
            name.to_owned(),
            format!(
                "{inside} % inside, error {:.1} px (90 %: {:.1} px)",
                tally.quantile_px(0.5),
                tally.quantile_px(0.9)
            ),
        )
    };
    let mut rows: Vec<(String, String)> = vec![("regions of".into(), LEVELS.map(percent).join(" ") + " %")];
    for left in found {
        let (name, text) = row(&left.camera, &left.all());
        let [u, v] = left.offset_px;
        rows.push((name, format!("{text}, offset {u:+.1} {v:+.1} px ({:.1} sd)", left.offset_size)));
    }
    rows.push(row("all", &all));
    rows.push((
        "log score".into(),
        format!("{:.2}; calibration error {:.3}", all.log_score(), all.calibration_error()),
    ));
    rows.push(("results".into(), out.display().to_string()));
    report::answer(&format!("{}\n{}\n", aligned(&rows), sentence(found)))
}
