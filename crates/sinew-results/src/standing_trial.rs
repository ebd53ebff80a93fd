//! A run of a standing trial, read back as the zero of angles: what `--static` takes ([`sinew_angles::zero`]).
//!
//! TRIAL is the result folder of a run of that trial, of the same person. With the set-up of the standing trial (`--setup TRIAL/setup.toml`) draw i of both runs is of the same constants: what lasts, such as the place of a keypoint on its link, is
//! in both and cancels in the difference. With a set-up of its own, draws are paired as they come, and what lasts counts twice. Draws of a smoothed run are trajectories; of a filtered one, draws
//! of different frames share what lasts and nothing else, so that what is left of their own errors in the mean over the trial counts too little.
//!
//! Draws are of states, from which no zero was subtracted: a trial that was itself tracked with `--static` gives the same zero as without.
//!
//! What is wrong with a trial is an error where there is no zero in it (another body, another convention), else a remark ([`sinew_angles::standing`]).

use super::people::refuse_several;
use super::results_error::ResultsError;
use super::stored_array::stored_array;
use crate::Error;
use serde_json::Value;
use sinew_angles::standing::{LARGEST_ZERO_DEG, MOST_MOVED_DEG, StandingAngles, StandingDoubt, TrialRun, other_sizes};
use sinew_angles::{AngleDraws, AngleZero, Convention, JointAngles};
use sinew_body::KinematicTree;
use sinew_formats::json_text;
use sinew_formats::source_text::{MAX_CONFIG_BYTES, MAX_TEXT_BYTES};
use sinew_input::files;
use sinew_input::flag::{flag, flag_with};
use sinew_setup::{MeasuredErrors, Setup};
use std::path::{Path, PathBuf};

/// Share of the frames in which an angle may be unseen and still have a zero.
const MOST_UNSEEN: f64 = 0.5;

/// Angles of a standing trial.
#[derive(Clone, Debug, PartialEq)]
pub struct StandingTrial {
    folder: PathBuf,
    angles: StandingAngles,
    setup: Setup,
}

impl StandingTrial {
    /// Reads the run of a standing trial, for a run with angles of a convention.
    ///
    /// # Errors
    /// A folder without a summary or without draws, angles of another convention; files that cannot be read.
    pub fn read(folder: &Path, convention: Convention) -> Result<Self, Error> {
        refuse_several(folder)?;
        let path = folder.join("summary.json");
        if !path.exists() {
            std::fs::read_dir(folder).map_err(Error::io("read", folder))?;
            return Err(ResultsError::NoSummary(folder.to_owned()).into());
        }
        let summary: Value = json_text::parse(&path.display().to_string(), &files::read_text(&path, MAX_TEXT_BYTES)?)?;
        let found = summary["angles"]["convention"].as_str().unwrap_or("none");
        if found != convention.name() {
            let [found, expected] = [found, convention.name()].map(|name| format!("angles by `{name}`"));
            return Err(ResultsError::OtherTrial { folder: folder.to_owned(), found, expected }.into());
        }
        let path = folder.join("setup.toml");
        let setup = Setup::from_toml(&path.display().to_string(), &files::read_text(&path, MAX_CONFIG_BYTES)?)?;
        let array = stored_array(folder, "posterior/angle")?;
        let draws = array.and_then(|array| AngleDraws::new(setup.tree(), &array.shape, array.values));
        let draws = draws.ok_or_else(|| ResultsError::NoDraws(folder.to_owned()))?;
        let angles = JointAngles::new(draws.tree(), &[], true, convention);
        let failed = summary["failed_diagnostics"].as_array().and_then(|all| all.first()?.as_str());
        let run = TrialRun { is_smoothed: summary["kind"] == "smoothed", failed };
        let unseen = &summary["angles"]["unseen"];
        let is_unseen = |name: &str| unseen[name].as_f64().is_some_and(|share| share > MOST_UNSEEN);
        let angles = StandingAngles::new(&angles, &draws, &run, is_unseen);
        Ok(Self { folder: folder.to_owned(), angles, setup })
    }

    /// The zero of some angles, for a run with a set-up that knows this of what is constant.
    #[must_use]
    pub fn zero(&self, angles: &JointAngles, lasting: Option<&MeasuredErrors>) -> AngleZero {
        let shared = lasting.filter(|own| Some(*own) == self.setup.lasting.as_ref()).map(MeasuredErrors::draws);
        AngleZero::new(angles, &self.angles.names, &self.angles.drawn, shared)
    }

    /// What a run with a set-up and its body should know of the trial, in words.
    ///
    /// # Errors
    /// A trial of a body with other links or joints.
    pub fn remarks(&self, setup: &Setup, tree: &KinematicTree) -> Result<Vec<String>, Error> {
        let own = self.setup.tree();
        let mut pairs = own.links().iter().zip(tree.links());
        let is_same = own.links().len() == tree.links().len()
            && pairs.all(|(a, b)| (&a.name, a.parent, &a.joints) == (&b.name, b.parent, &b.joints));
        if !is_same {
            let [found, expected] = [&self.setup, setup].map(|setup| format!("the body {}", setup.body.name()));
            return Err(ResultsError::OtherTrial { folder: self.folder.clone(), found, expected }.into());
        }
        Ok(self.angles.doubts.iter().chain(&other_sizes(&own, tree)).map(words).collect())
    }
}

/// A doubt in words.
fn words(doubt: &StandingDoubt) -> String {
    let words = match doubt {
        StandingDoubt::Filtered => format!(
            "it is filtered, and the mean over its frames is surer of itself than it is right: track it with {}",
            flag("smooth")
        ),
        StandingDoubt::Failed(failed) => format!("its diagnostics failed ({failed}): so may its zero"),
        StandingDoubt::Unseen(unseen) => {
            format!("its keypoints do not show {}: no zero is taken off these", unseen.join(", "))
        }
        StandingDoubt::Moves(angles) => format!(
            "angles move by more than {MOST_MOVED_DEG}° over it ({angles}): choose frames in which the person stands still, {}",
            flag_with("frames", "A..B")
        ),
        StandingDoubt::LargeZeros(angles) => format!(
            "zeros are above {LARGEST_ZERO_DEG}° ({angles}): angles are subtracted, not rotations, and angles of one joint mix; does the person stand upright and look ahead, with hanging arms?"
        ),
        StandingDoubt::OtherSizes(share) => format!(
            "the sizes of its body differ from this run's by {:.0} %: is it the same person? Take its set-up for both, {}",
            100.0 * share,
            flag_with("setup", "TRIAL/setup.toml")
        ),
    };
    format!("standing trial: {words}")
}
