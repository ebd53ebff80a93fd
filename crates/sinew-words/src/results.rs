//! Result folders that cannot be written, read or continued.

use crate::setup;
use sinew_results::problem::Problem;
use sinew_results::{Error, Occupied, ReadError, ResultsError};

pub(crate) fn help(error: &Error) -> Option<String> {
    match error {
        Error::Setup(error) => setup::help(error),
        Error::Results(error) => results(error),
        Error::Read(error) => reading(error).map(Into::into),
        Error::OutputExists { found, .. } => Some(occupied(*found).into()),
        Error::OutputLocked { .. } => Some("wait for it to end, or choose another folder with `-o`".into()),
        Error::Checkpoint { problem, .. } => Some(checkpoint(problem).into()),
        Error::OutputIsInput { .. } => Some("choose another folder with `-o`".into()),
        Error::OutputOutside { .. } => Some("give it a name that is one of a file or folder below that folder".into()),
        Error::OutputLink(_) => Some("remove the link, or choose another folder with `-o`".into()),
        _ => None,
    }
}

const fn reading(error: &ReadError) -> Option<&'static str> {
    Some(match error {
        ReadError::NoSummary(_) => "give the folder that `sinew track` wrote, `sinew-out/<trial>` or what `-o` said",
        ReadError::Stopped(_) => {
            "continue with the same command and `--resume`; an interrupt with Ctrl-C writes its files"
        }
        ReadError::Running(_) => "wait for its end",
        ReadError::NoFile { .. } | ReadError::OtherRun(_) => "track again, or take the folder as the run left it",
        ReadError::NoFrames(_) => "track again, or continue with `--resume`",
        _ => return None,
    })
}

fn results(error: &ResultsError) -> Option<String> {
    let fixed = match error {
        ResultsError::SeveralPeople(folder) => {
            return Some(format!("give one of them, for example `{}`", folder.join("people/01").display()));
        }
        ResultsError::NoSummary(_) => {
            "give the folder that `sinew track` wrote with `-o`; a run that was stopped is continued with `--resume`"
        }
        ResultsError::OtherTrial { .. } => "track both with the same `--body` and `--angles`",
        ResultsError::NoDraws(_) => "give the folder of a run of `sinew track` that came to its end",
        ResultsError::NoSuchFrames { .. } => "`--frames A..B` takes the numbers in the file names, A included, B not",
        ResultsError::UnknownCamera { .. } => "give the calibration that was tracked with",
        ResultsError::OtherLength { .. } => "are all files of this folder of one run?",
        ResultsError::NoColumn { .. } => "is this file of a result folder?",
        ResultsError::Shares { .. } => {
            "a frame has a row for each cluster and model; take the file as the run wrote it"
        }
        ResultsError::EstimateSize { .. }
        | ResultsError::NotFinite { .. }
        | ResultsError::LackingStatistics(_)
        | ResultsError::Cell { .. }
        | ResultsError::Value { .. }
        | _ => return None,
    };
    Some(fixed.into())
}

const fn occupied(found: Occupied) -> &'static str {
    match found {
        Occupied::File => "write to another file, or replace it with `--force`",
        Occupied::NotAFolder => "choose another folder with `-o`, or remove the file",
        Occupied::StoppedRun => {
            "continue it with `--resume`, choose another folder with `-o`, or replace what is there with `--force`"
        }
        Occupied::NotOurs => "move it away, or choose another folder with `-o`",
        Occupied::Results | Occupied::NotEmpty => {
            "choose another folder with `-o`, or replace what is there with `--force`"
        }
    }
}

const fn checkpoint(error: &Problem) -> &'static str {
    match error {
        Problem::Missing => "leave `--resume` out to begin a run, or name the folder of a stopped one with `-o`",
        Problem::BeforeFirst => "repeat the command without `--resume`: it begins again",
        Problem::Whom { .. } => {
            "give `--people` and `--person` as that run had them, another folder with `-o`, or `--force` instead of `--resume` to begin again"
        }
        Problem::Settings(_) => {
            "repeat the settings of the run that was stopped (its config.toml or config.toml.partial holds them), or begin again with `--force` instead of `--resume`"
        }
        Problem::Inputs(_) => "put the data back as they were, or begin again with `--force` instead of `--resume`",
        Problem::Program { .. } | Problem::Format { .. } => {
            "continue with the version of the program that began the run, or begin again with `--force` instead of `--resume`"
        }
        Problem::Summary
        | Problem::Foreign
        | Problem::Length { .. }
        | Problem::Checksum { .. }
        | Problem::State { .. }
        | Problem::Changed { .. }
        | _ => "begin again with `--force` instead of `--resume`",
    }
}
