//! Why a result folder cannot be written or read.

use std::fmt;
use std::ops::Range;
use std::path::PathBuf;

/// Results that cannot be written or read back.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ResultsError {
    /// An estimate of another size than the run's.
    #[error("frame {frame}: {what}: {found} numbers instead of {expected}")]
    EstimateSize {
        /// Frame.
        frame: u64,
        /// Part of the estimate.
        what: &'static str,
        /// Numbers found.
        found: usize,
        /// Numbers of the run.
        expected: usize,
    },
    /// An estimate with numbers that are not finite.
    #[error("frame {frame}: the estimate has numbers that are not finite")]
    NotFinite {
        /// Frame.
        frame: u64,
    },
    /// An estimate without statistics that its run has.
    #[error("a frame lacks the {0} statistics that its run announces")]
    LackingStatistics(&'static str),
    /// A folder without the summary of a run that came to its end.
    #[error("`{}` holds no results of a run that came to its end: summary.json is missing", .0.display())]
    NoSummary(PathBuf),
    /// Results of several people where one person is needed.
    #[error("{}: results of several people, each in a folder of their own", .0.display())]
    SeveralPeople(PathBuf),
    /// Frames that the results do not have.
    #[error("{} were requested; the results have {}", frames(asked.as_ref()), available.as_ref().map_or_else(|| "none".into(), span))]
    NoSuchFrames {
        /// Requested frames; all of them if `None`.
        asked: Option<Range<u64>>,
        /// Frames there, if any.
        available: Option<Range<u64>>,
    },
    /// A calibration without a camera of the run.
    #[error("{}: no camera `{camera}`, which the results come from; calibrated: {}", calibration.display(), calibrated.join(", "))]
    UnknownCamera {
        /// Calibration file.
        calibration: PathBuf,
        /// Camera of the run.
        camera: String,
        /// Cameras of the file.
        calibrated: Vec<String>,
    },
    /// A run without draws of its angles.
    #[error("{}: no draws of angles in posterior.zarr", .0.display())]
    NoDraws(PathBuf),
    /// A standing trial of another kind than the run.
    #[error("{}: a standing trial with {found}; this run has {expected}", folder.display())]
    OtherTrial {
        /// Result folder of the trial.
        folder: PathBuf,
        /// Its body or angles.
        found: String,
        /// The run's.
        expected: String,
    },
    /// A file whose length is not that of the others.
    #[error("{file}: {found} {unit}; the other files of the folder speak of {expected}")]
    OtherLength {
        /// File.
        file: String,
        /// Rows or frames found.
        found: usize,
        /// `rows` or `frames`.
        unit: &'static str,
        /// What the other files have.
        expected: usize,
    },
    /// A table without a column.
    #[error("{file}: no column `{wanted}`; there are: {}", columns.join(", "))]
    NoColumn {
        /// File.
        file: String,
        /// The column.
        wanted: &'static str,
        /// Columns that are there.
        columns: Vec<String>,
    },
    /// A value of a summary that is not what it must be.
    #[error("{file}: `{found}`; must be {expected}")]
    Value {
        /// File.
        file: String,
        /// Value found.
        found: String,
        /// What belongs there.
        expected: Expected,
    },
    /// A cell of a table that is not what its column says.
    #[error("{file}:{line}: `{found}`; must be {expected}")]
    Cell {
        /// File.
        file: String,
        /// Line.
        line: usize,
        /// Content.
        found: String,
        /// What belongs there.
        expected: Expected,
    },
    /// Shares that leave particles out or count them twice.
    #[error("{file}: the shares of part `{part}` at {time_s} s add to {sum}; must be 1")]
    Shares {
        /// File.
        file: String,
        /// Part of the body.
        part: String,
        /// Time.
        time_s: f64,
        /// What they add to.
        sum: f64,
    },
}

/// What belongs into a cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Expected {
    /// Number of a frame.
    FrameNumber,
    /// Name of a degree of freedom.
    Coordinate(String),
    /// A finite number.
    Number,
    /// A time that is not before the last one.
    LaterTime,
    /// Number of a cluster.
    Cluster,
    /// Name of a model that moves particles.
    Model,
    /// A share of all particles.
    Share,
    /// How late a camera is.
    Lag,
}

impl fmt::Display for Expected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::FrameNumber => write!(f, "the number of a frame"),
            Self::Coordinate(name) => write!(f, "`{name}`, as in the body of setup.toml"),
            Self::Number => write!(f, "a number"),
            Self::LaterTime => write!(f, "a time in seconds, not before the row above"),
            Self::Cluster => write!(f, "the number of a cluster, or nothing"),
            Self::Model => write!(f, "`next`, `step` or `walk`"),
            Self::Share => write!(f, "a share from 0 to 1"),
            Self::Lag => write!(f, "a camera with the frames that it is late, `cam_03=-2.4`"),
        }
    }
}

fn span(range: &Range<u64>) -> String {
    format!("{}..{}", range.start, range.end)
}

fn frames(asked: Option<&Range<u64>>) -> String {
    asked.map_or_else(|| "frames".into(), |range| format!("frames {}", span(range)))
}

/// What is in the way of an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Occupied {
    /// The file to be written.
    File,
    /// A file where a folder is to be.
    NotAFolder,
    /// Results.
    Results,
    /// A run that was stopped and can be resumed.
    StoppedRun,
    /// Files of others.
    NotEmpty,
    /// A file that no earlier run wrote, where one is to be written.
    NotOurs,
}

impl Occupied {
    /// The rest of the sentence that begins with the path.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::File => "exists",
            Self::NotAFolder => "exists and is not a folder",
            Self::Results => "exists and holds results",
            Self::StoppedRun => "exists and holds a run that was stopped",
            Self::NotEmpty => "exists and is not empty",
            Self::NotOurs => "is in the way, and no earlier run wrote it",
        }
    }
}
