//! The codes with which a program ends.
//!
//! | code | meaning |
//! |---|---|
//! | 0 | done |
//! | 1 | failed for another reason: numerical failure, a bug |
//! | 2 | wrong usage or configuration |
//! | 3 | bad input data |
//! | 4 | finished and written, but a diagnostic failed |
//! | 5 | files and disk |
//! | 75 | interrupted; what was done is written and marked incomplete, `--resume` continues from there |
//! | 130 | second interrupt, nothing saved since |

use sinew::predict::PredictError;
use sinew::run::live::LiveError;
use sinew::track::error::TrackError;
use sinew_analysis::compare::CompareError;
use sinew_analysis::segment::SegmentError;
use sinew_input::InputError;
use sinew_motion::convert::MotionError;
use sinew_report::inspect::InspectError;
use sinew_report::overlay::OverlayError;
use sinew_results::problem::Problem;
use sinew_results::{ReadError, ResultsError};
use sinew_setup::SetupError;

/// Failed for another reason than those below.
pub const FAILED: u8 = 1;
/// Wrong usage or configuration.
pub const USAGE: u8 = 2;
/// Bad input data.
pub const INPUT: u8 = 3;
/// Finished and written, but a diagnostic failed.
pub const DOUBTFUL: u8 = 4;
/// Files and disk.
pub const FILES: u8 = 5;
/// Interrupted; what was done is written.
pub const INTERRUPTED: u8 = 75;

/// The code with which a program ends for an error.
#[must_use]
pub const fn exit_code(error: &sinew_report::Error) -> u8 {
    use sinew_report::Error;
    match error {
        Error::Analysis(error) => analysis(error),
        Error::Inspect(
            InspectError::NoStore { .. } | InspectError::NoPoints { .. } | InspectError::OtherMotion { .. },
        )
        | Error::Overlay(OverlayError::Solids(_) | OverlayError::NoImages) => INPUT,
        Error::Inspect(
            InspectError::TwoSkeletons { .. } | InspectError::UnknownKind { .. } | InspectError::Video { .. },
        )
        | Error::Overlay(OverlayError::Scale { .. }) => USAGE,
        _ => FAILED,
    }
}

const fn analysis(error: &sinew_analysis::Error) -> u8 {
    use sinew_analysis::Error;
    match error {
        Error::Run(error) => run(error),
        Error::Motion(error) => motion(error),
        Error::Compare(CompareError::SpaceOfAngles(_))
        | Error::Segment(SegmentError::OutOfRange { .. })
        | Error::Sync(_) => USAGE,
        Error::Compare(_) | Error::Gait(_) | Error::Opensim(_) | Error::Segment(_) | Error::ShapeFit(_) => INPUT,
        _ => FAILED,
    }
}

const fn motion(error: &sinew_motion::Error) -> u8 {
    use sinew_motion::Error;
    match error {
        Error::Results(error) => results(error),
        Error::Motion(
            MotionError::NoMotion { .. }
            | MotionError::NoTimes { .. }
            | MotionError::NoColumns { .. }
            | MotionError::Unwritable { .. }
            | MotionError::NoPoints { .. }
            | MotionError::Joints { .. },
        )
        | Error::Learn(_) => INPUT,
        Error::Motion(_) => USAGE,
        _ => FAILED,
    }
}

/// The code for an error of a run.
#[must_use]
pub const fn run(error: &sinew::Error) -> u8 {
    use sinew::Error;
    match error {
        Error::Results(error) => results(error),
        Error::Track(error) => tracking(error),
        Error::Predict(PredictError::UnknownCamera { .. } | PredictError::UsedCamera(_))
        | Error::Live(LiveError::Place(_) | LiveError::NotLoopback(_) | LiveError::OfFiles(_))
        | Error::NothingToTrack { .. }
        | Error::InputIsOutput(_)
        | Error::ResultIsOutput(_) => USAGE,
        Error::Predict(PredictError::NoKeypoints(_) | PredictError::OtherRun(_))
        | Error::Live(LiveError::NoFrame | LiveError::SetupCutShort { .. })
        | Error::SetupFrames { .. }
        | Error::NoSuchPerson { .. } => INPUT,
        Error::Live(LiveError::Listen { .. }) => FILES,
        Error::Interrupted(_) => INTERRUPTED,
        Error::Tracking(_) | Error::Threads(_) | _ => FAILED,
    }
}

const fn tracking(error: &TrackError) -> u8 {
    match error {
        TrackError::UpAxis { .. }
        | TrackError::UpTwice
        | TrackError::Body { .. }
        | TrackError::NoInstructionSet { .. }
        | TrackError::ModelBody { .. }
        | TrackError::ModelRate { .. }
        | TrackError::NoMotionModel { .. }
        | TrackError::NoLatentModel { .. }
        | TrackError::LatentRest { .. }
        | TrackError::Latent(_) => USAGE,
        TrackError::UnknownCamera { .. }
        | TrackError::FewPoints { .. }
        | TrackError::StartPose { .. }
        | TrackError::FrameNumber { .. }
        | TrackError::Parts(_)
        | TrackError::Solids(_)
        | TrackError::SetupFile { .. }
        | TrackError::MotionModel(_)
        | TrackError::LatentModel(_) => INPUT,
        TrackError::NoParts
        | TrackError::StoredSettings(_)
        | TrackError::Encoding(_)
        | TrackError::Sampler(_)
        | TrackError::Motion(_)
        | _ => FAILED,
    }
}

const fn results(error: &sinew_results::Error) -> u8 {
    use sinew_results::Error;
    match error {
        Error::Setup(error) => setup(error),
        Error::Results(
            ResultsError::EstimateSize { .. } | ResultsError::NotFinite { .. } | ResultsError::LackingStatistics(_),
        ) => FAILED,
        Error::Results(ResultsError::SeveralPeople(_)) | Error::OutputIsInput { .. } => USAGE,
        Error::Read(ReadError::Running(_))
        | Error::OutputExists { .. }
        | Error::OutputLocked { .. }
        | Error::OutputLink(_) => FILES,
        Error::Results(_) | Error::Read(_) | Error::OutputOutside { .. } => INPUT,
        Error::Checkpoint { problem, .. } => checkpoint(problem),
        _ => FAILED,
    }
}

const fn checkpoint(problem: &Problem) -> u8 {
    match problem {
        Problem::Missing
        | Problem::BeforeFirst
        | Problem::Whom { .. }
        | Problem::Settings(_)
        | Problem::Program { .. } => USAGE,
        Problem::Inputs(_) => INPUT,
        Problem::Summary
        | Problem::Foreign
        | Problem::Length { .. }
        | Problem::Checksum { .. }
        | Problem::Format { .. }
        | Problem::State { .. }
        | Problem::Changed { .. } => FILES,
        _ => FAILED,
    }
}

const fn setup(error: &sinew_setup::Error) -> u8 {
    use sinew_setup::Error;
    match error {
        Error::Input(error) => input(error),
        Error::Setup(SetupError::Unwritable(_) | SetupError::Lasting(_)) => FAILED,
        Error::Setup(_) => INPUT,
        Error::Body(_) => USAGE,
        _ => FAILED,
    }
}

const fn input(error: &sinew_input::Error) -> u8 {
    use sinew_input::Error;
    match error {
        Error::Input(
            InputError::NoSuchCamera { .. }
            | InputError::LagOfNoCamera { .. }
            | InputError::NoKeypointsOfCamera { .. }
            | InputError::ImageScale { .. }
            | InputError::GradientsOfSilhouettes { .. }
            | InputError::InitWithoutKeypoints
            | InputError::NoStart,
        )
        | Error::Config(_)
        | Error::Format(sinew::formats::Error::UnknownLayout { .. }) => USAGE,
        Error::Input(_) | Error::Format(_) => INPUT,
        Error::Io(_) => FILES,
        _ => FAILED,
    }
}
