//! Groups and attributes of the InferenceData schema, which ArviZ reads.
//!
//! Every group names the library that made it, the method, whether the draws are `filtered`, `fixed-lag` or `smoothed`, and the seed;
//! a date only where the caller gives one, so that the same run gives the same bytes. The draws are equal-weight; what a
//! draw index means across frames is stated in `draw_meaning`.
//!
//! ```
//! use sinew_formats::zarr::inference_data::{group, DrawsKind, RunAttributes};
//! let run = RunAttributes { library_version: "0.1.0", method: "hmc", kind: DrawsKind::Filtered, seed: 7, created_at: None };
//! let posterior = group("posterior", &run);
//! assert_eq!(posterior.attributes["inference_library"], "sinew");
//! assert!(posterior.attributes["draw_meaning"].as_str().unwrap().contains("per frame"));
//! ```

use super::schema::{DataType, Group, Labels, Schema, Variable};
use serde_json::{Map, Value};

/// Whether draws of a frame know the frames after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawsKind {
    /// Given the frames up to this one.
    Filtered,
    /// Given a number of frames after this one, too.
    FixedLag,
    /// Given all frames.
    Smoothed,
}

impl DrawsKind {
    /// Name in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Filtered => "filtered",
            Self::FixedLag => "fixed-lag",
            Self::Smoothed => "smoothed",
        }
    }

    const fn draw_meaning(self) -> &'static str {
        match self {
            Self::Filtered => "equal-weight draws, resampled again per frame: a draw index means nothing across frames",
            Self::FixedLag => "equal-weight draws given some later frames: a draw index means nothing across frames",
            Self::Smoothed => "equal-weight draws: one draw index is one trajectory over all frames",
        }
    }
}

/// What the attributes of every group say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunAttributes<'a> {
    /// Version of the library.
    pub library_version: &'a str,
    /// Tracker.
    pub method: &'a str,
    /// Filtered, smoothed, or between.
    pub kind: DrawsKind,
    /// Seed.
    pub seed: u64,
    /// Date and time, where one is wanted (from `SOURCE_DATE_EPOCH`).
    pub created_at: Option<&'a str>,
}

/// A group with the attributes of the run.
#[must_use]
pub fn group(name: &str, run: &RunAttributes<'_>) -> Group {
    let mut group = Group::new(name);
    let mut set = |key: &str, value: &str| group.attributes.insert(key.into(), value.into());
    set("inference_library", "sinew");
    set("inference_library_version", run.library_version);
    set("method", run.method);
    set("kind", run.kind.name());
    if let Some(created_at) = run.created_at {
        set("created_at", created_at);
    }
    if name == "posterior" {
        set("draw_meaning", run.kind.draw_meaning());
    }
    group.attributes.insert("seed".into(), run.seed.into());
    group
}

/// Attributes of the root, which has no variables of its own: what is in the groups, and how they are opened.
#[must_use]
pub fn root(run: &RunAttributes<'_>, groups: &[Group]) -> Map<String, Value> {
    let names: Vec<&str> = groups.iter().map(|group| group.name.as_str()).collect();
    let mut attributes = group("", run).attributes;
    attributes.insert("groups".into(), names.into());
    attributes.insert(
        "open_with".into(),
        "xarray.open_zarr(store, group=\"posterior\"), or xarray.open_datatree(store, engine=\"zarr\") for all groups"
            .into(),
    );
    attributes
}

/// The posterior: `angle[chain, draw, frame, dof]` in rad, `root[…, axis]` and `marker_position[…, marker, axis]` in m,
/// float32. Values are pushed in this order.
///
/// The markers are not called `marker`, because that is the coordinate with their names, and a group holds one array of
/// a name.
#[must_use]
pub fn posterior(run: &RunAttributes<'_>) -> Group {
    let variable = |name: &str, last: &[&str], units: &str| {
        let dimensions = [&["chain", "draw", "frame"], last].concat();
        Variable::new(name, &dimensions, DataType::Float32).with_attribute("units", units)
    };
    let mut posterior = group("posterior", run);
    posterior.variables.push(variable("angle", &["dof"], "rad"));
    posterior.variables.push(variable("root", &["axis"], "m"));
    posterior.variables.push(variable("marker_position", &["marker", "axis"], "m"));
    posterior
}

/// Dimensions of the posterior: one chain unless there are independent runs, `axis` = x, y, z.
#[must_use]
pub fn schema(chains: usize, draws: usize, dof: Vec<String>, markers: Vec<String>) -> Schema {
    let mut schema = Schema::default();
    let mut set = |name: &str, labels| schema.dimensions.insert(name.into(), labels);
    set("chain", Labels::Count(chains));
    set("draw", Labels::Count(draws));
    set("dof", Labels::Names(dof));
    set("marker", Labels::Names(markers));
    set("axis", Labels::Names(["x", "y", "z"].map(Into::into).into()));
    schema
}
