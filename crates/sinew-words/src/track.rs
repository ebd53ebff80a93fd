//! What ends a run early.

use crate::{models, results};
use sinew::Error;
use sinew::predict::PredictError;
use sinew::run::live::LiveError;
use sinew::track::error::TrackError;

/// Commands to try where there was nothing to track with.
const TRY: &str = "try one of
  sinew track --calibration Calib.toml --keypoints pose --fps 60
  sinew track --calibration Calib.toml --silhouettes masks --keypoints pose --method annealed --fps 60
  sinew demo";

/// What the user can do about an error of a run.
#[must_use]
pub fn help(error: &Error) -> Option<String> {
    let words = match error {
        Error::Results(error) => return results::help(error),
        Error::Track(error) => return tracking(error),
        Error::Predict(error) => prediction(error)?,
        Error::Live(error) => live(error)?,
        Error::NothingToTrack { .. } => TRY,
        Error::SetupFrames { .. } => "`--setup-frames A..B` takes the numbers in the file names, A included, B not",
        Error::NoSuchPerson { .. } => {
            "`--person` counts from 1 in the order of coming; `sinew inspect` with calibration and keypoints says who is there"
        }
        Error::InputIsOutput(_) | Error::ResultIsOutput(_) => "write to another file",
        Error::Interrupted(_) | Error::Tracking(_) | Error::Threads(_) | _ => return None,
    };
    Some(words.to_owned())
}

fn tracking(error: &TrackError) -> Option<String> {
    let fixed = match error {
        TrackError::ModelRate { format, tracked, .. } => {
            return Some(format!(
                "learn it at that rate with `{} --fps {tracked}`, or state the recording's with `--fps`",
                format.command
            ));
        }
        TrackError::ModelBody { format, .. } => {
            let command = format.command;
            return Some(format!("track with `--body` of that name, or learn a model with `{command} --body`"));
        }
        TrackError::UpAxis { setting, .. } => {
            return Some(format!("leave `{setting}` out: the set-up knows it"));
        }
        TrackError::MotionModel(error) => return models::help(error),
        TrackError::LatentModel(error) => return models::help(error),
        TrackError::UnknownCamera { .. } => "use the set-up of this recording, or leave `--setup` out",
        TrackError::FewPoints { .. } => "name the body's points as the layout does: `sinew body` lists them",
        TrackError::StartPose { .. } => "use the set-up of this body, or leave `--setup` out",
        TrackError::FrameNumber { .. } => "renumber the files",
        TrackError::Parts(_) => "give every link at most one solid",
        TrackError::UpTwice => "leave one of them out",
        TrackError::Body { .. } => "leave `--body` out: the set-up knows it; or leave `--setup` out",
        TrackError::SetupFile { .. } => {
            "give `--setup` the setup.toml of a result folder of this version, or leave it out"
        }
        TrackError::NoMotionModel { .. } => {
            "leave `--motion-model` out, or use `--method hmc`, `bootstrap`, `guided`, `annealed` or `hppf`"
        }
        TrackError::NoLatentModel { .. } => "name one with `--latent`; `sinew learn latent` makes it",
        TrackError::LatentRest { .. } => "learn and track another body (`--body cf28`), or use `--method gpapf`",
        TrackError::Latent(_) => "learn the latent model again with `--model gpdm`, or `hgplvm` with one root",
        TrackError::NoInstructionSet { .. } => "leave `--simd` out to take the best",
        TrackError::Solids(_)
        | TrackError::NoParts
        | TrackError::StoredSettings(_)
        | TrackError::Encoding(_)
        | TrackError::Sampler(_)
        | TrackError::Motion(_)
        | _ => return None,
    };
    Some(fixed.into())
}

const fn prediction(error: &PredictError) -> Option<&'static str> {
    Some(match error {
        PredictError::NoKeypoints(_) => "track again from keypoints, with a set-up of this version",
        PredictError::OtherRun(_) => "track again into an empty folder",
        PredictError::UnknownCamera { .. } => "`sinew inspect` lists the cameras of a calibration",
        PredictError::UsedCamera(_) => {
            "track with the other cameras (`--cameras`), or use `sinew validate`, which does that"
        }
        _ => return None,
    })
}

const fn live(error: &LiveError) -> Option<&'static str> {
    Some(match error {
        LiveError::Place(_) => "`--live -` reads standard input, `--live tcp:127.0.0.1:7777` a socket",
        LiveError::NotLoopback(_) => {
            "listen on 127.0.0.1 or [::1], and bring frames of other machines there by a tunnel"
        }
        LiveError::Listen { .. } => "choose another port; 0 takes one that is free",
        LiveError::OfFiles(_) => "leave it out, or track a recording without `--live`",
        LiveError::NoFrame => "send one line a frame: {\"frame\": 0, \"cameras\": {\"cam1\": {\"people\": [...]}}}",
        LiveError::SetupCutShort { .. } => {
            "give a set-up of an earlier run (`--setup`), or fewer seconds (`--setup-seconds`)"
        }
        _ => return None,
    })
}
