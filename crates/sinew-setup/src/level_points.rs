//! Points of head and feet that are level where the angles are 0.
//!
//! Keypoints do not say which way a foot or a head faces: turned in its link, with its joint turned back, it shows the same keypoints. So that is a definition: in the zero pose soles are level, and the line of the eyes goes across. Along such an axis the points
//! of a group have one place.

use sinew_body::point_derivatives::Neighbours;
use sinew_dynamics::lasting_scales::LastingData;
use sinew_observe::lasting::lasting_errors::LastingErrors;

/// Points of which one coordinate is the same in the frame of their link.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LevelPoints {
    /// Their places among the keypoints.
    pub points: Vec<usize>,
    /// The axis.
    pub axis: usize,
}

const NAMES: [(&[&str], usize); 4] = [
    (&["LBigToe", "LSmallToe", "LHeel"], 2),
    (&["RBigToe", "RSmallToe", "RHeel"], 2),
    (&["LEye", "REye"], 1),
    (&["LEye", "REye"], 2),
];

/// Precision, one over square metres: a tenth of a millimetre.
const LEVEL: f64 = 1e8;

/// The groups of some keypoints.
#[must_use]
pub fn level_points(names: &[String]) -> Vec<LevelPoints> {
    let index = |name: &&str| names.iter().position(|point| point == name);
    let group =
        |(names, axis): (&[&str], usize)| LevelPoints { points: names.iter().filter_map(index).collect(), axis };
    NAMES.map(group).to_vec()
}

/// How many numbers are equal to another one.
#[must_use]
pub fn tied(level: &[LevelPoints]) -> usize {
    level.iter().map(|group| group.points.len().saturating_sub(1)).sum()
}

/// What the data say, and that the groups are level on a body whose places count from `body`.
#[must_use]
pub fn levelled(data: &LastingData, errors: &LastingErrors, body: &Neighbours, level: &[LevelPoints]) -> LastingData {
    let (mut data, p) = (data.clone(), errors.count());
    for LevelPoints { points, axis } in level {
        for pair in points.windows(2) {
            let [a, b] = [0, 1].map(|k: usize| errors.place(pair[k]).start + axis);
            let [at_a, at_b] = [0, 1].map(|k: usize| body.offset(pair[k])[*axis]);
            for (i, j, precision) in [(a, a, LEVEL), (b, b, LEVEL), (a, b, -LEVEL), (b, a, -LEVEL)] {
                data.information[i * p + j] += precision;
            }
            data.pull[a] += LEVEL * (at_b - at_a);
            data.pull[b] -= LEVEL * (at_b - at_a);
        }
    }
    data
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_body::Proportions;
    use sinew_body::standard::h32;
    use sinew_core::random::Stage;
    use sinew_dynamics::lasting_scales::{LastingPrior, PriorCluster, SweepSchedule, alike, draws};

    #[test]
    fn a_sole_that_is_not_level_becomes_so() {
        let names = ["LHeel", "LKnee", "LBigToe"].map(str::to_owned);
        let tree = h32(&Proportions::default());
        let raised: Vec<[f64; 3]> =
            tree.points().iter().map(|point| [0.0, 0.0, if point.name == "LHeel" { 0.02 } else { 0.0 }]).collect();
        let indices = names.each_ref().map(|name| tree.point_index(name).unwrap());
        let body = Neighbours::new(|sizes| h32(sizes).with_points_moved(&raised), &Proportions::default(), &indices);
        let errors = LastingErrors { cameras: 0, lengths: 0, points: 3 };
        let level = level_points(&names);
        assert_eq!((level.len(), level[0].points.clone(), tied(&level)), (4, vec![2, 0], 1));

        let p = errors.count();
        let nothing = LastingData { information: vec![0.0; p * p], pull: vec![0.0; p] };
        let cluster = PriorCluster { numbers: alike(0..p, 0.01), scale: None, heavy_tails: false, tied: 0 };
        let prior = LastingPrior { clusters: vec![cluster], scales: vec![] };
        let schedule = SweepSchedule { draws: 8, burn_in: 0, apart: 1 };
        let found =
            draws(&levelled(&nothing, &errors, &body, &level), &prior, schedule, Stage::new(1, "level")).unwrap();
        for g in &found.errors {
            let height = |point: usize| body.offset(point)[2] + g[errors.place(point).start + 2];
            assert!((height(0) - height(2)).abs() < 1e-3, "{} {}", height(0), height(2));
        }
        assert!((found.mean[errors.place(0).start + 2] + 0.01).abs() < 1e-6);
    }
}
