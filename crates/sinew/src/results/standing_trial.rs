//! A run of a standing trial, read back as the zero of angles: what `--static` takes ([`sinew_angles::zero`]).
//!
//! TRIAL is the result folder of a run of that trial, of the same person. With the set-up of the standing trial (`--setup TRIAL/setup.toml`) draw i of both runs is of the same constants: what lasts, such as the place of a keypoint on its link, is
//! in both and goes with the difference. With a set-up of its own, draws are paired as they come, and what lasts counts twice. Draws of a smoothed run are trajectories; of a filtered one, draws
//! of different frames share what lasts and nothing else, so that what is left of their own errors in the mean over the trial counts too little.
//!
//! Draws are of states, which no zero was taken off: a trial that was itself tracked with `--static` gives the same zero as without.
//!
//! What is wrong with a trial is an error where there is no zero in it (another body, another convention), else a remark ([`super::standing_doubts`]).

use super::angle_draws::AngleDraws;
use super::error::ResultsError;
use super::people::refuse_several;
use super::standing_doubts::{FrameSpread, doubts, other_sizes};
use crate::setup::{Body, MeasuredErrors, Setup};
use crate::{Error, files};
use serde_json::Value;
use sinew_angles::zero::{has_zero, mean_directions};
use sinew_angles::{AngleZero, Convention, JointAngles};
use sinew_body::KinematicTree;
use sinew_formats::json_text;
use sinew_formats::source_text::{MAX_CONFIG_BYTES, MAX_TEXT_BYTES};
use std::path::{Path, PathBuf};

/// Share of the frames in which an angle may be unseen and still have a zero.
const MOST_UNSEEN: f64 = 0.5;

/// Angles of a standing trial.
#[derive(Clone, Debug, PartialEq)]
pub struct StandingTrial {
    folder: PathBuf,
    /// Angles that have a zero.
    names: Vec<String>,
    /// Mean directions over the frames, radians: a row for each draw, a number for each name.
    drawn: Vec<f64>,
    lasting: Option<MeasuredErrors>,
    body: Body,
    tree: KinematicTree,
    remarks: Vec<String>,
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
            let (folder, found, expected) = (folder.to_owned(), found.to_owned(), convention.name());
            return Err(ResultsError::OtherConvention { folder, found, expected }.into());
        }
        let path = folder.join("setup.toml");
        let setup = Setup::from_toml(&path.display().to_string(), &files::read_text(&path, MAX_CONFIG_BYTES)?)?;
        let draws = AngleDraws::read(folder, &setup)?.ok_or_else(|| ResultsError::NoDraws(folder.to_owned()))?;
        let angles = JointAngles::new(draws.tree(), &[], true, convention);
        let (kept, unseen) = with_zero(&angles, &summary);
        let kept_only = |all: Vec<f64>| kept.iter().map(|k| all[*k]).collect::<Vec<f64>>();
        let in_draw = |draw| {
            let states: Vec<Vec<f64>> = (0..draws.frames()).map(|frame| draws.state(draw, frame)).collect();
            kept_only(mean_directions(&angles, states.iter().map(Vec::as_slice)))
        };
        let drawn: Vec<Vec<f64>> = (0..draws.draws()).map(in_draw).collect();
        let in_frame = |frame| {
            let of = |(draw, zero): (usize, &Vec<f64>)| {
                let state = draws.state(draw, frame);
                let here = kept_only(mean_directions(&angles, std::iter::once(&state[..])));
                here.iter().zip(zero).map(|(angle, zero)| angle - zero).collect()
            };
            FrameSpread::new(&drawn.iter().enumerate().map(of).collect::<Vec<Vec<f64>>>())
        };
        let frames: Vec<FrameSpread> = (0..draws.frames()).map(in_frame).collect();
        let names: Vec<String> = kept.iter().map(|k| angles.names()[*k].clone()).collect();
        let remarks = doubts(&summary, &names, &drawn, &frames, &unseen);
        let drawn = drawn.concat();
        let (folder, tree) = (folder.to_owned(), draws.tree().clone());
        Ok(Self { folder, names, drawn, lasting: setup.lasting, body: setup.body, tree, remarks })
    }

    /// The zero of some angles, for a run with a set-up that knows this of what is constant.
    #[must_use]
    pub fn zero(&self, angles: &JointAngles, lasting: Option<&MeasuredErrors>) -> AngleZero {
        let shared = lasting.filter(|own| Some(*own) == self.lasting.as_ref()).map(MeasuredErrors::draws);
        AngleZero::new(angles, &self.names, &self.drawn, shared)
    }

    /// What a run with a body should know of the trial, in words.
    ///
    /// # Errors
    /// A trial of a body with other links or joints.
    pub fn remarks(&self, body: &Body, tree: &KinematicTree) -> Result<Vec<String>, Error> {
        let structure = |tree: &KinematicTree| -> Vec<_> {
            tree.links().iter().map(|link| (link.name.clone(), link.parent, link.joints.clone())).collect()
        };
        if structure(tree) != structure(&self.tree) {
            let [found, expected] = [&self.body, body].map(named);
            return Err(ResultsError::OtherBody { folder: self.folder.clone(), found, expected }.into());
        }
        Ok(self.remarks.iter().cloned().chain(other_sizes(&self.tree, tree)).collect())
    }
}

/// Places of the angles that have a zero, and names of the others that keypoints do not show.
fn with_zero(angles: &JointAngles, summary: &Value) -> (Vec<usize>, Vec<String>) {
    let is_unseen = |name: &str| summary["angles"]["unseen"][name].as_f64().is_some_and(|share| share > MOST_UNSEEN);
    let all = angles.names().iter().enumerate().filter(|(_, name)| has_zero(name));
    let (unseen, kept): (Vec<_>, Vec<_>) = all.partition(|(_, name)| is_unseen(name));
    (kept.into_iter().map(|(k, _)| k).collect(), unseen.into_iter().map(|(_, name)| name.clone()).collect())
}

/// How a body is called.
fn named(body: &Body) -> String {
    match body {
        Body::File(_) => "a body of a file".into(),
        known => format!("`{}`", known.name().to_lowercase()),
    }
}
