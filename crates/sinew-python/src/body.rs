//! Bodies: kinematic trees with named points, for batches of poses.

use crate::arrays::{Numbers, Two, array, empty, filled, given_place, numbers, shaped};
use crate::background::detached;
use crate::failure::Failure;
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use pyo3::types::IntoPyDict;
use rayon::prelude::*;
use sinew::bodies;
use sinew::body::bones::{Bone, skeleton};
use sinew::body::subject::{SIZES, scaled};
use sinew::body::{Joint, KinematicTree, Plan, Proportions, point_jacobian_each, point_positions_into};
use sinew::core::lanes::{Isa, LANES};
use sinew::files::read_text;
use sinew::formats::source_text::MAX_TEXT_BYTES;
use sinew::formats::{body_toml, bvh};
use sinew::setup::{Body, FileBody};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// States that a thread takes at a time.
const STATES_A_TASK: usize = 64 * LANES;

/// A body: a tree of links with degrees of freedom and named points.
///
/// Parameters
/// ----------
/// name
///     `h32` (32 degrees of freedom, for real people), `cf28`, `hppf24` or `hapf31`, or a file (`body.toml`, URDF).
/// scale
///     Factor on all sizes of an adult of 1.75 m.
/// sizes
///     Single sizes in metres, by the names of `Body.sizes`; they override `scale`.
/// text
///     What a file would hold; `name` is then for messages.
///
/// A pose is a vector of `dof` numbers: metres for translations, radians for rotations, in the order of `dof_names`. The world has z up.
#[pyclass(frozen, name = "Body", module = "sinew")]
pub(crate) struct PyBody {
    name: String,
    pub(crate) body: Body,
    proportions: Proportions,
    pub(crate) tree: KinematicTree,
    plan: Plan,
}

#[pymethods]
impl PyBody {
    #[new]
    #[pyo3(signature = (name = "h32", *, scale = 1.0, sizes = None, text = None))]
    fn new(name: &str, scale: f64, sizes: Option<BTreeMap<String, f64>>, text: Option<&str>) -> PyResult<Self> {
        if let Some(text) = text {
            return Self::from_text(name, text);
        }
        if !(scale > 0.0 && scale.is_finite()) {
            return Err(Failure::argument(format!("`scale` is {scale}; it must be positive")).into());
        }
        let body = bodies::to_track(name).map_err(Failure::from)?;
        let mut proportions = scaled(&Proportions::default(), scale);
        for (name, value) in sizes.unwrap_or_default() {
            set_size(&mut proportions, &name, value)?;
        }
        let longest = Proportions::LONGEST_M;
        if !proportions.are_within(longest) {
            let what = format!("a size of the body is more than {longest} m; `scale` and `sizes` set them, in metres");
            return Err(Failure::argument(what).into());
        }
        Self::of(name.into(), body, proportions)
    }

    /// A body from a table of offsets, a line a link: parents come first, and each link has a point of its name at its origin.
    ///
    /// Parameters
    /// ----------
    /// links
    ///     Names of the links.
    /// parents
    ///     Name of each link's parent; None for a root.
    /// offsets
    ///     (links, 3), origin of each link in its parent's frame, metres.
    /// joints
    ///     Degrees of freedom of each link, left to right: `"tx ty tz rz ry rx"`; empty for a rigid one.
    #[staticmethod]
    fn from_offsets(
        links: Vec<String>,
        parents: Vec<Option<String>>,
        offsets: &Bound<'_, PyAny>,
        joints: Vec<String>,
    ) -> PyResult<Self> {
        for (name, found) in [("parents", parents.len()), ("joints", joints.len())] {
            if found != links.len() {
                let what = format!("`{name}` has {found} entries; expected links = {}", links.len());
                return Err(Failure::argument(what).into());
            }
        }
        let offsets = numbers("offsets", offsets)?;
        offsets.exactly(&[("links", Some(links.len())), ("3", Some(3))])?;
        let offsets = offsets.finite()?.as_chunks::<3>().0;
        let bone = |link: usize| Bone {
            name: &links[link],
            parent: parents[link].as_deref().unwrap_or_default(),
            offset: offsets[link],
            joints: &joints[link],
        };
        let tree = skeleton(&(0..links.len()).map(bone).collect::<Vec<_>>()).map_err(Failure::from)?;
        Self::from_text("body", &body_toml::write(&tree, None))
    }

    /// The skeleton of a BVH file; `unit_m` is the length of the file's unit in metres (0.01 where it has centimetres).
    #[staticmethod]
    #[pyo3(signature = (path, *, unit_m = 1.0))]
    fn from_bvh(py: Python<'_>, path: PathBuf, unit_m: f64) -> PyResult<Self> {
        let name = path.display().to_string();
        let tree = detached(py, || Ok(bvh::read(&name, &read_text(&path, MAX_TEXT_BYTES)?)?.body(unit_m)?))?;
        Self::from_text(&name, &body_toml::write(&tree, None))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (&str,))> {
        let made = match &self.body {
            Body::File(_) => [("text", String::from(self.body.clone()))].into_py_dict(py)?,
            _ => [("sizes", self.sizes())].into_py_dict(py)?,
        };
        let class = py.get_type::<Self>();
        Ok((py.import("functools")?.getattr("partial")?.call((class,), Some(&made))?, (&self.name,)))
    }

    /// Name or file of the body.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// Number of degrees of freedom.
    #[getter]
    fn dof(&self) -> usize {
        self.tree.dof()
    }

    /// Name of every degree of freedom, in the order of a pose: `link.tx` (metres) or `link.rx` (radians).
    #[getter]
    fn dof_names(&self) -> Vec<String> {
        self.tree.dof_names()
    }

    /// Names of the points, in the order of `positions`.
    #[getter]
    fn points(&self) -> Vec<&str> {
        self.tree.points().iter().map(|point| point.name.as_str()).collect()
    }

    /// Names of the links, parents before children.
    #[getter]
    fn links(&self) -> Vec<&str> {
        self.tree.links().iter().map(|link| link.name.as_str()).collect()
    }

    /// Index of each link's parent among `links`; None for the root.
    #[getter]
    fn parents(&self) -> Vec<Option<usize>> {
        self.tree.links().iter().map(|link| link.parent).collect()
    }

    /// For each degree of freedom the index of its link, `translate` or `rotate`, and the axis (0, 1, 2) of the link's frame so far; None for a free axis.
    #[getter]
    fn joints(&self) -> Vec<(usize, &'static str, Option<usize>)> {
        let word = |(link, joint)| match joint {
            Joint::Translate(axis) => (link, "translate", axis.index()),
            Joint::Rotate(axis) => (link, "rotate", axis.index()),
        };
        self.tree.joints().map(word).collect()
    }

    /// Origin of each link in its parent's frame, (links, 3), metres.
    #[getter]
    fn offsets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let links = self.tree.links();
        array(py, [links.len(), 3], links.iter().flat_map(|link| link.offset).collect())
    }

    /// Index of the link that carries each point.
    #[getter]
    fn point_links(&self) -> Vec<usize> {
        self.tree.points().iter().map(|point| point.link).collect()
    }

    /// Place of each point in the frame of its link, (points, 3), metres.
    #[getter]
    fn point_offsets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let points = self.tree.points();
        array(py, [points.len(), 3], points.iter().flat_map(|point| point.offset).collect())
    }

    /// The sizes that the body was made with, by name, metres. A body of a file has its own.
    #[getter]
    fn sizes(&self) -> BTreeMap<&'static str, f64> {
        let mut proportions = self.proportions;
        SIZES.iter().map(|(name, _, size)| (*name, *size(&mut proportions))).collect()
    }

    /// World positions of the points.
    ///
    /// Parameters
    /// ----------
    /// poses
    ///     (..., dof), metres and radians.
    /// out
    ///     Array (..., points, 3) of float64 for the result, which spares the time that the system takes to hand out memory.
    ///
    /// Returns
    /// -------
    /// (..., points, 3), metres. Eight poses are evaluated together, on all threads; the number of threads changes nothing.
    #[pyo3(signature = (poses, *, out = None))]
    fn positions<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let poses = self.poses(poses)?;
        let (states, d, plan) = (poses.values()?, self.tree.dof(), &self.plan);
        let (shape, width) = (shaped(self.leading(&poses)?, &[plan.points(), 3]), 3 * plan.points());
        let out = out.map_or_else(|| empty(py, &shape), |out| given_place("out", out, &shape))?;
        let write = |out: &mut [f64]| {
            let parts = states.par_chunks(STATES_A_TASK * d).zip(out.par_chunks_mut(STATES_A_TASK * width));
            parts.for_each(|(states, out)| point_positions_into(plan, Isa::best(), states, out));
            Ok(())
        };
        if width > 0 {
            filled(&out, |out| detached(py, || write(out)))?;
        }
        Ok(out)
    }

    /// World positions of the points and their derivatives by the degrees of freedom.
    ///
    /// Parameters
    /// ----------
    /// poses
    ///     (..., dof), metres and radians.
    ///
    /// Returns
    /// -------
    /// Positions (..., points, 3) in metres and Jacobians (..., points, 3, dof) in metres per metre or radian.
    fn jacobian<'py>(&self, py: Python<'py>, poses: &Bound<'py, PyAny>) -> PyResult<Two<'py>> {
        let poses = self.poses(poses)?;
        let (states, d, plan) = (poses.values()?, self.tree.dof(), &self.plan);
        let (leading, points, width) = (self.leading(&poses)?, plan.points(), 3 * plan.points());
        let positions = empty(py, &shaped(leading, &[points, 3]))?;
        let jacobians = empty(py, &shaped(leading, &[points, 3, d]))?;
        let write = |to: &mut [f64], by: &mut [f64]| {
            let results = to.par_chunks_mut(STATES_A_TASK * width).zip(by.par_chunks_mut(STATES_A_TASK * width * d));
            let parts = states.par_chunks(STATES_A_TASK * d).zip(results);
            parts.for_each(|(states, (to, by))| point_jacobian_each(plan, Isa::best(), states, to, by));
            Ok(())
        };
        if width > 0 {
            filled(&positions, |to| filled(&jacobians, |by| detached(py, || write(to, by))))?;
        }
        Ok((positions, jacobians))
    }

    /// The body as a body file (`body.toml`).
    pub(crate) fn to_toml(&self) -> String {
        body_toml::write(&self.tree, self.body.flesh(&self.tree).ok().as_ref())
    }

    fn __repr__(&self) -> String {
        let (links, points) = (self.tree.links().len(), self.tree.points().len());
        format!("Body({:?}: {} degrees of freedom, {links} links, {points} points)", self.name, self.tree.dof())
    }
}

impl PyBody {
    fn from_text(name: &str, text: &str) -> PyResult<Self> {
        let body = FileBody::read(name, text).map_err(Failure::from)?;
        Self::of(name.into(), Body::File(body), Proportions::default())
    }

    fn of(name: String, body: Body, proportions: Proportions) -> PyResult<Self> {
        let tree = body.tree(&proportions);
        if tree.dof() == 0 {
            return Err(Failure::argument(format!("the body `{name}` has no degree of freedom")).into());
        }
        let plan = Plan::with_all_points(&tree);
        Ok(Self { name, body, proportions, tree, plan })
    }

    fn poses<'py>(&self, poses: &Bound<'py, PyAny>) -> PyResult<Numbers<'py>> {
        let poses = numbers("poses", poses)?;
        self.leading(&poses)?;
        Ok(poses)
    }

    fn leading<'a>(&self, poses: &'a Numbers<'_>) -> Result<&'a [usize], Failure> {
        poses.leading(&[("degrees of freedom", Some(self.tree.dof()))])
    }
}

fn set_size(proportions: &mut Proportions, name: &str, value: f64) -> Result<(), Failure> {
    let Some((_, is_length, size)) = SIZES.iter().find(|(known, _, _)| *known == name) else {
        let known = SIZES.map(|(name, _, _)| name).join(", ");
        return Err(Failure::argument(format!("`sizes`: unknown size `{name}`; known: {known}")));
    };
    if !value.is_finite() || (*is_length && value <= 0.0) {
        let due = if *is_length { "positive" } else { "finite" };
        return Err(Failure::argument(format!("`sizes`: {name} is {value}; it must be {due}")));
    }
    *size(proportions) = value;
    Ok(())
}
