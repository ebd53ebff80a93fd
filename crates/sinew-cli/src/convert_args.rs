//! Arguments of `sinew convert`.

use super::answer_args::Answer;
use clap::{Args, ValueEnum};
use sinew::formats::calibration::CalibrationFormat;
use sinew_motion::convert::BoneNames;
use std::path::PathBuf;

#[derive(Args, Debug)]
pub(crate) struct ConvertArgs {
    /// Motion file (.trc, .c3d, .bvh, .mot, .csv or .amc), or a calibration
    #[arg(value_name = "IN")]
    pub(crate) input: PathBuf,
    /// File to write: .trc, .c3d, .bvh, .glb, .mot or .csv; calibrations: .toml, .yml or .qca.txt
    #[arg(value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// Program: pose2sim, caliscope, anipose, freemocap, opencv or qualisys
    #[arg(long, value_enum, value_name = "PROGRAM", hide_possible_values = true)]
    pub(crate) to: Option<Program>,
    /// Bones of our motion.bvh named for mixamo, unreal or rigify, front at rest
    #[arg(long, value_enum, value_name = "NAMES", hide_possible_values = true)]
    pub(crate) bones: Option<Bones>,
    /// Skeleton of an .amc file
    #[arg(long, value_name = "F.asf")]
    pub(crate) skeleton: Option<PathBuf>,
    /// Frames per second where the input has none [default: 120 for .amc]
    #[arg(long, value_name = "F")]
    pub(crate) fps: Option<f64>,
    #[command(flatten)]
    pub(crate) answer: Answer,
}

/// Names of bones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Bones {
    Mixamo,
    Unreal,
    Rigify,
}

impl Bones {
    pub(crate) const fn names(self) -> BoneNames {
        match self {
            Self::Mixamo => BoneNames::Mixamo,
            Self::Unreal => BoneNames::Unreal,
            Self::Rigify => BoneNames::Rigify,
        }
    }
}

/// Programs that calibrations are written for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Program {
    Pose2sim,
    Caliscope,
    Anipose,
    Freemocap,
    Opencv,
    Qualisys,
}

impl Program {
    pub(crate) const fn format(self) -> CalibrationFormat {
        match self {
            Self::Pose2sim => CalibrationFormat::Pose2Sim,
            Self::Caliscope => CalibrationFormat::Caliscope,
            Self::Anipose | Self::Freemocap => CalibrationFormat::Anipose,
            Self::Opencv => CalibrationFormat::OpenCv,
            Self::Qualisys => CalibrationFormat::Qualisys,
        }
    }
}
