//! Named points in space over time.

use crate::Error;
use crate::{KinematicTree, Plan, point_positions};
use sinew_core::estimators::mean;
use sinew_core::lanes::Isa;

/// Positions of named points, frame by frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trajectories {
    /// Names, as keypoint layouts use them.
    pub names: Vec<String>,
    /// Positions in the world (Z up) in metres, in the order of the names, for each frame.
    pub frames: Vec<Vec<[f64; 3]>>,
}

impl Trajectories {
    /// Column of the point of that name.
    #[must_use]
    pub fn index(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|other| other == name)
    }

    /// The same, where there must be one.
    ///
    /// # Errors
    /// [`Error::NoPoint`].
    pub fn column(&self, name: &str) -> Result<usize, Error> {
        self.index(name).ok_or_else(|| Error::NoPoint(name.to_owned()))
    }

    /// The points of the given names that exist, in that order.
    #[must_use]
    pub fn select(&self, names: &[&str]) -> Self {
        let columns: Vec<usize> = names.iter().filter_map(|name| self.index(name)).collect();
        let frames = self.frames.iter().map(|frame| columns.iter().map(|&k| frame[k]).collect()).collect();
        Self { names: columns.iter().map(|&k| self.names[k].clone()).collect(), frames }
    }

    /// Smallest and largest coordinates over all frames and points; `None` if there is none.
    #[must_use]
    pub fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        let mut all = self.frames.iter().flatten();
        let first = *all.next()?;
        Some(all.fold([first; 2], |[low, high], p| {
            [std::array::from_fn(|i| low[i].min(p[i])), std::array::from_fn(|i| high[i].max(p[i]))]
        }))
    }
}

/// All points of a body in a sequence of its states. Computed on the baseline instruction set, so that every processor gives the same bits.
#[must_use]
pub fn points_of_states(body: &KinematicTree, states: &[Vec<f64>]) -> Trajectories {
    let plan = Plan::with_all_points(body);
    let mut flat = vec![0.0; 3 * plan.points()];
    let frames = states.iter().map(|state| {
        point_positions(&plan, Isa::baseline(), state, &mut flat);
        flat.as_chunks::<3>().0.to_vec()
    });
    Trajectories { names: body.points().iter().map(|point| point.name.clone()).collect(), frames: frames.collect() }
}

/// Distance of two points.
#[must_use]
pub fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// The point at a fraction of the way from a to b.
#[must_use]
pub fn between(a: [f64; 3], b: [f64; 3], fraction: f64) -> [f64; 3] {
    [0, 1, 2].map(|k: usize| a[k] + fraction * (b[k] - a[k]))
}

/// Mean distance of points of the same name, metres; NaN without any.
#[must_use]
pub fn mean_distance(a: &Trajectories, b: &Trajectories) -> f64 {
    let pairs: Vec<(usize, usize)> =
        a.names.iter().enumerate().filter_map(|(i, name)| Some((i, b.index(name)?))).collect();
    let frames = a.frames.iter().zip(&b.frames);
    let apart: Vec<f64> =
        frames.flat_map(|(a, b)| pairs.iter().map(|&(i, j)| distance(a[i], b[j])).collect::<Vec<_>>()).collect();
    mean(&apart)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Proportions;
    use crate::standard::h32;

    #[test]
    fn points_are_found_by_name_and_bounded() {
        let body = h32(&Proportions::default());
        let all = points_of_states(&body, &[vec![0.0; body.dof()]]);
        let some = all.select(&["Head", "nothing", "MidHip"]);
        assert_eq!(some.names, ["Head", "MidHip"]);
        assert_eq!(some.bounds(), Some([[0.0, 0.0, -0.1], [0.0, 0.0, 0.73]]));
        assert_eq!(Trajectories::default().bounds(), None);
    }
}
