//! `sinew inspect`: what files contain, and whether calibration and keypoints fit.
//!
//! Keypoints are read with the settings of their trial, as `sinew track` reads them.

use super::args::{General, InspectArgs};
use super::ended::Ended;
use super::error::Error;
use super::report::{self, Report};
use super::table::aligned;
use super::terminal::Terminal;
use serde_json::json;
use sinew::config::common::{ASSUMED_FPS, KEYPOINTS};
use sinew::input::recording::{Recording, RecordingOptions};
use sinew::run::settings::{settings, with_stated_rate};
use sinew_report::inspect::{
    Facts, Subject, file_facts, fit, latent_picture, model_picture, picture_of_actions, subjects,
};
use sinew_results::Occupied;
use sinew_results::write_whole;
use std::path::{Path, PathBuf};

/// Runs the command.
pub(crate) fn run(args: &InspectArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    let subjects = subjects(&args.files)?;
    let calibration =
        subjects.iter().find_map(|subject| if let Subject::Calibration(path) = subject { Some(path) } else { None });
    let keypoints =
        subjects.iter().find_map(|subject| if let Subject::Keypoints(path) = subject { Some(path) } else { None });
    let (options, fps) = match keypoints {
        Some(keypoints) => options(args, general, keypoints, report)?,
        None => {
            refuse_settings(args, general)?;
            (RecordingOptions::default(), ASSUMED_FPS)
        }
    };
    let mut all: Vec<Facts> = Vec::new();
    for subject in &subjects {
        all.push(file_facts(subject, &options, calibration.map(PathBuf::as_path))?);
    }
    if let (Some(calibration), Some(keypoints)) = (calibration, keypoints) {
        let mut recording = Recording::open(calibration, keypoints, &options)?;
        // What was said about a file is not said again about the pair.
        let known: Vec<String> = all.iter().flat_map(|facts| facts.odd.iter().map(sinew_words::odd)).collect();
        all.push(fit::facts(&mut recording, fps, &known)?);
    }
    if let Some(out) = &general.out {
        draw(&subjects, Path::new(out), general.force)?;
    }
    if args.answer.json {
        let facts = |facts: &Facts| {
            let rows: serde_json::Map<_, _> =
                facts.rows.iter().map(|(name, value)| (name.clone(), value.clone().into())).collect();
            json!({ "title": facts.title, "facts": rows, "odd": facts.odd.iter().map(sinew_words::odd).collect::<Vec<_>>() })
        };
        report::answer_json(&all.iter().map(facts).collect::<Vec<_>>().into())?;
    } else {
        let text: Vec<String> = all.iter().map(shown).collect();
        report::answer(&text.join("\n"))?;
    }
    report.detail(&format!("{} things looked at", all.len()));
    Ok(Ended::Done)
}

/// Draws the model or the actions among the files; a motion beside actions is the truth.
fn draw(subjects: &[Subject], out: &Path, force: bool) -> Result<(), Error> {
    let is_drawn =
        |subject: &&Subject| matches!(subject, Subject::MotionModel(_) | Subject::LatentModel(_) | Subject::Actions(_));
    let drawn: Vec<&Subject> = subjects.iter().filter(is_drawn).collect();
    let [Subject::MotionModel(path) | Subject::LatentModel(path) | Subject::Actions(path)] = drawn[..] else {
        return Err(Error::NothingToDraw);
    };
    let truth = subjects.iter().find_map(|subject| if let Subject::Motion(path) = subject { Some(path) } else { None });
    if out.exists() && !force {
        return Err(sinew_results::Error::OutputExists { path: out.to_owned(), found: Occupied::File }.into());
    }
    let is_out =
        |path: &&PathBuf| out.canonicalize().is_ok_and(|out| path.canonicalize().is_ok_and(|path| path == out));
    if let Some(input) = [Some(path), truth].into_iter().flatten().find(is_out) {
        return Err(sinew::Error::InputIsOutput(input.clone()).into());
    }
    let picture = match drawn[0] {
        Subject::Actions(_) => picture_of_actions(path, truth.map(PathBuf::as_path))?,
        Subject::LatentModel(_) => latent_picture(path)?,
        _ => model_picture(path)?,
    };
    Ok(write_whole(out, picture.as_bytes())?)
}

/// How to read the keypoints, and their frames a second, from all sources of settings.
fn options(
    args: &InspectArgs,
    general: &General,
    keypoints: &Path,
    report: &Report,
) -> Result<(RecordingOptions, f64), Error> {
    let mut given = [&args.settings.given[..], &general.settings()].concat();
    given.push((KEYPOINTS.key, keypoints.to_string_lossy().into_owned()));
    let resolved = with_stated_rate(settings(&given, general.config.as_deref())?, &Terminal { general, report })?;
    report.warnings(&resolved.warnings);
    let config = resolved.track();
    let fps = config.fps();
    Ok((config.recording, fps))
}

/// Refuses flags on how to read keypoints where there are none.
fn refuse_settings(args: &InspectArgs, general: &General) -> Result<(), Error> {
    let given = args.settings.given.iter().map(|(key, _)| *key);
    match given.chain(general.config.as_ref().map(|_| "config")).next() {
        None => Ok(()),
        Some(key) => Err(Error::NoKeypointsToRead { flag: key.replace('_', "-") }),
    }
}

fn shown(facts: &Facts) -> String {
    let rows: Vec<(String, String)> =
        facts.rows.iter().map(|(name, value)| (format!("  {name}"), value.clone())).collect();
    let odd: String = facts.odd.iter().map(|odd| format!("  odd: {}\n", sinew_words::odd(odd))).collect();
    format!("{}\n{}{odd}", facts.title, aligned(&rows))
}
