//! Velocities of points in space: of keypoints from the frames around, of tracked points from the frames so far.
//!
//! How a camera's lag shows depends on them. A lag that all cameras share is a shift of time, which a person who moves freely makes up for: so velocities must be some that the body can have ([`body_velocities`]), or their errors would seem to tell the time.

use crate::cameras::camera::Camera;
use crate::cameras::offsets::{CameraNoise, Sighted, point_from_views};
use nalgebra::{DMatrix, DVector, Vector3};

/// Seconds on each side from which a velocity is estimated.
pub const REACH_S: f64 = 0.05;
/// Faster than people move, metres a second: something was taken for something else.
const FASTEST_M_S: f64 = 12.0;

/// Frames on each side from which a velocity is estimated, of `fps` a second.
#[must_use]
pub fn reach(fps: f64) -> u64 {
    (REACH_S * fps).round().max(1.0) as u64
}

/// Least-squares slope of positions over the numbers of their frames, up to `reach` of them on each side, metres a frame; `None` without frames on both sides.
#[must_use]
pub fn velocity(points: &[Option<[f64; 3]>], numbers: &[u64], at: usize, reach: u64) -> Option<Vector3<f64>> {
    slope(points, numbers, at, reach, |_| true).filter(|(_, used)| *used > reach as usize).map(|(slope, _)| slope)
}

/// The same from the frames with odd distances and from those with even ones, whose errors are apart; `None` without frames on both sides.
pub(crate) fn two_velocities(
    points: &[Option<[f64; 3]>],
    numbers: &[u64],
    at: usize,
    reach: u64,
) -> Option<[Vector3<f64>; 2]> {
    let of = |even: bool| slope(points, numbers, at, reach, |distance| (distance % 2 == 0) == even);
    Some([of(false)?.0, of(true)?.0])
}

/// Least-squares slope over frames whose distances `is_used` takes, and how many these are.
fn slope(
    points: &[Option<[f64; 3]>],
    numbers: &[u64],
    at: usize,
    reach: u64,
    is_used: impl Fn(u64) -> bool,
) -> Option<(Vector3<f64>, usize)> {
    let (centre, side) = (numbers[at], reach as usize);
    let near: Vec<(f64, Vector3<f64>)> = (at.saturating_sub(side)..numbers.len().min(at + side + 1))
        .filter(|&i| numbers[i].abs_diff(centre) <= reach && is_used(numbers[i].abs_diff(centre)))
        .filter_map(|i| Some((numbers[i] as f64 - centre as f64, Vector3::from(points[i]?))))
        .collect();
    let has = |side: fn(f64) -> bool| near.iter().any(|(offset, _)| side(*offset));
    if !has(|offset| offset < 0.0) || !has(|offset| offset > 0.0) {
        return None;
    }
    let count = near.len() as f64;
    let middle = near.iter().map(|(offset, _)| offset).sum::<f64>() / count;
    let mean = near.iter().map(|(_, point)| point).sum::<Vector3<f64>>() / count;
    let slope = near.iter().map(|(offset, point)| (offset - middle) * (point - mean)).sum::<Vector3<f64>>();
    Some((slope / near.iter().map(|(offset, _)| (offset - middle).powi(2)).sum::<f64>(), near.len()))
}

/// Velocities of keypoints in the frame at a place of `frames` (number, detections) that are `fps` a second, metres a second, where cameras show them.
#[must_use]
pub fn keypoint_velocities(
    (cameras, noise): (&[Camera], &[CameraNoise]),
    frames: &[(u64, Sighted)],
    at: usize,
    keypoints: &[usize],
    (fps, least_confidence): (f64, f64),
) -> Vec<Option<[f64; 3]>> {
    let (centre, reach) = (frames[at].0, reach(fps));
    let first = frames.partition_point(|(number, _)| number + reach < centre);
    let end = frames.partition_point(|(number, _)| *number <= centre + reach);
    let near = &frames[first..end];
    let numbers: Vec<u64> = near.iter().map(|(number, _)| *number).collect();
    let of = |keypoint: &usize| {
        let point = |(_, views): &(u64, Sighted)| {
            Some(point_from_views(cameras, noise, views, *keypoint, least_confidence)?.0.point)
        };
        let points: Vec<Option<[f64; 3]>> = near.iter().map(point).collect();
        let found = velocity(&points, &numbers, at - first, reach)? * fps;
        (found.norm() < FASTEST_M_S).then(|| found.into())
    };
    keypoints.iter().map(of).collect()
}

/// Standard deviation of a velocity, metres a second, for one of the positions that it comes from, metres.
#[must_use]
pub fn velocity_sd(position_sd_m: f64, fps: f64) -> f64 {
    let squares = 2 * (1..=reach(fps)).map(|k| k * k).sum::<u64>();
    position_sd_m * fps / (squares as f64).sqrt()
}

/// How the points of a body move in a frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodyVelocities {
    /// Of each point, metres a second.
    pub velocities: Vec<[f64; 3]>,
    /// Sum of the squares of those whose velocity was seen, and of what was seen less them.
    squares: f64,
    left: f64,
    /// How many numbers were seen, and how many of their errors the velocities have taken in.
    seen: f64,
    taken: f64,
}

/// Velocities of the points of a body, metres a second: the posterior mean J ṡ, with J the derivatives of the points by the pose (three rows a point, row after row), ṡ ~ N(0, usual²), and velocities that were `seen` with errors of `sd`.
#[must_use]
pub fn body_velocities(by_pose: &[f64], seen: &[Option<[f64; 3]>], usual: &[f64], sd: f64) -> BodyVelocities {
    let dof = usual.len();
    let moves = DMatrix::from_row_slice(by_pose.len() / dof.max(1), dof, by_pose);
    let mut information = DMatrix::from_diagonal(&DVector::from_fn(dof, |j, _| usual[j].powi(-2)));
    let mut pull = DVector::zeros(dof);
    let rows = seen.iter().enumerate().filter_map(|(point, seen)| Some((point, (*seen)?)));
    let rows: Vec<(usize, f64)> =
        rows.flat_map(|(point, seen)| (0..3).map(move |axis| (3 * point + axis, seen[axis]))).collect();
    for (row, speed) in &rows {
        let by = moves.row(*row).transpose();
        information.ger(sd.powi(-2), &by, &by, 1.0);
        pull.axpy(speed * sd.powi(-2), &by, 1.0);
    }
    let Some(factor) = information.cholesky() else {
        return BodyVelocities { velocities: vec![[0.0; 3]; seen.len()], ..BodyVelocities::default() };
    };
    let found = moves * factor.solve(&pull);
    let covariance = factor.inverse();
    let sum = |of: &dyn Fn(&(usize, f64)) -> f64| rows.iter().map(of).sum();
    BodyVelocities {
        squares: sum(&|(row, _)| found[*row].powi(2)),
        left: sum(&|(row, speed)| (speed - found[*row]).powi(2)),
        seen: rows.len() as f64,
        taken: (0..dof).map(|j| 1.0 - covariance[(j, j)] / usual[j].powi(2)).sum(),
        velocities: found.as_slice().as_chunks::<3>().0.to_vec(),
    }
}

/// The share of the squares of velocities that is motion; the rest is errors, whose size is that of what was seen and the body cannot do. A regression on velocities finds too little by this share; on velocities times it, what is right in the mean (regression calibration: Carroll et al., Measurement Error in Nonlinear Models, 2006, chapter 4).
#[must_use]
pub fn share_of_motion(frames: &[BodyVelocities]) -> f64 {
    let sum = |of: fn(&BodyVelocities) -> f64| frames.iter().map(of).sum::<f64>();
    let errors = sum(|own| own.left) / sum(|own| own.seen - own.taken) * sum(|own| own.taken);
    let share = 1.0 - errors / sum(|own| own.squares);
    if share.is_finite() { share.clamp(0.0, 1.0) } else { 1.0 }
}

/// Velocities of points that are tracked, a mean over the steps so far of which older ones count less: by the factor e after a thirtieth of a second.
#[derive(Clone, Debug)]
pub struct RunningVelocities {
    seconds: f64,
    /// Positions in the frame before, metres; none before the first.
    former: Vec<f64>,
    velocities: Vec<[f64; 3]>,
}

const FORGOTTEN_S: f64 = 1.0 / 30.0;

impl RunningVelocities {
    /// Of points that stand still, in frames that are `seconds` apart.
    #[must_use]
    pub fn new(points: usize, seconds: f64) -> Self {
        Self { seconds, former: vec![], velocities: vec![[0.0; 3]; points] }
    }

    /// What was before does not count.
    pub fn restart(&mut self) {
        self.former.clear();
        self.velocities.fill([0.0; 3]);
    }

    /// Velocities, metres a second, once the points are at `positions`, x, y, z each.
    pub fn next(&mut self, positions: &[f64]) -> &[[f64; 3]] {
        let share = 1.0 - (-self.seconds / FORGOTTEN_S).exp();
        let steps = positions.iter().zip(&self.former);
        for (velocity, (now, before)) in self.velocities.as_flattened_mut().iter_mut().zip(steps) {
            *velocity += share * ((now - before) / self.seconds - *velocity);
        }
        self.former.clear();
        self.former.extend_from_slice(positions);
        &self.velocities
    }

    /// Velocities at the last positions, metres a second.
    #[must_use]
    pub fn known(&self) -> &[[f64; 3]] {
        &self.velocities
    }

    /// What [`RunningVelocities::restore`] takes: positions and velocities; nothing before the first frame.
    #[must_use]
    pub fn save(&self) -> Vec<f64> {
        if self.former.is_empty() {
            return vec![];
        }
        [&self.former, self.velocities.as_flattened()].concat()
    }

    /// Continues where [`RunningVelocities::save`] was called, after at least one frame; `saved` has six numbers a point.
    pub fn restore(&mut self, saved: &[f64]) {
        let (former, velocities) = saved.split_at(saved.len() / 2);
        self.former = former.to_vec();
        self.velocities.as_flattened_mut().iter_mut().zip(velocities).for_each(|(own, saved)| *own = *saved);
    }

    /// Numbers that are saved.
    #[must_use]
    pub const fn saved(&self) -> usize {
        6 * self.velocities.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Detection;
    use sinew_core::lanes::{Block, Isa};
    use sinew_core::random::Stage;

    #[test]
    fn a_point_at_constant_speed_is_found_to_move_so_and_continues_after_a_restore() {
        let mut running = RunningVelocities::new(2, 0.02);
        let at = |frame: u32| [0.03 * f64::from(frame), 1.0, 0.0, 5.0, -0.01 * f64::from(frame), 2.0];
        assert!(running.save().is_empty());
        assert_eq!(running.next(&at(0)), [[0.0; 3]; 2]);
        (1..20).for_each(|frame| {
            running.next(&at(frame));
        });
        let saved = running.save();
        assert_eq!(saved.len(), running.saved());
        let found = running.next(&at(20)).to_vec();
        assert!((found[0][0] - 1.5).abs() < 1e-4 && (found[1][1] + 0.5).abs() < 1e-4, "{found:?}");
        let mut other = RunningVelocities::new(2, 0.02);
        other.restore(&saved);
        assert_eq!(other.next(&at(20)), found);
        assert_eq!(other.known(), found);
        running.restart();
        assert_eq!(running.next(&at(21)), [[0.0; 3]; 2]);
    }

    /// A point on a parabola has the velocity of its tangent; one that jumps has none.
    #[test]
    fn a_point_that_is_thrown_has_the_velocity_of_the_moment() {
        let from = |place| Camera::look_at("C", [1280.0, 960.0], 900.0, place, [0.0, 0.0, 1.0]).unwrap();
        let cameras = [from([0.0, -4.0, 1.3]), from([4.0, 0.0, 1.3])];
        let noise = [0, 1].map(|_| CameraNoise::without_offset(3.0, 0.9));
        let fps = 60.0;
        let at = |number: u64| {
            let t = number as f64 / fps;
            [0.4 * t, -0.2, 1.0 + 2.0 * t - 0.5 * 9.81 * t * t]
        };
        let jumping = |number: u64| [0.6 * number as f64, 0.0, 1.0];
        let seen = |camera: &Camera, number: u64| {
            let shown = |point| Some(Detection::new(camera.project(point).pixel()?, 0.9));
            vec![shown(at(number)), shown(jumping(number)), None]
        };
        let frames: Vec<(u64, Sighted)> =
            [0, 1, 2, 3, 5, 6, 7].map(|n| (n, cameras.iter().map(|camera| seen(camera, n)).collect())).to_vec();
        let found = keypoint_velocities((&cameras, &noise), &frames, 3, &[0, 1, 2], (fps, 0.3));
        // The frames 3 − 3 to 3 + 3 without the fourth: their parabola's chord is that of the mean time, which is early.
        let expected = [0.4, 0.0, 2.0 - 9.81 * 3.0 / fps];
        assert!(found[0].unwrap().iter().zip(expected).all(|(f, e)| (f - e).abs() < 0.05), "{found:?}");
        assert_eq!(found[1..], [None; 2]);
    }

    /// A rod that turns, seen with errors: of the squares of its velocities, what errors add is known from what a rod cannot do, and a regression on what is left of the velocities has the slope 1.
    #[test]
    fn errors_of_velocities_are_known_from_what_a_body_cannot_do() {
        let by_pose = [0.0, 1.0, 0.0, 0.0, 2.0, 0.0];
        let frames = 4000;
        let errors = normals(7, 6 * frames);
        let turns = normals(8, frames);
        let seen = |frame: usize| -> Vec<Option<[f64; 3]>> {
            let at = |row: usize| by_pose[row] * turns[frame] + 1.5 * errors[6 * frame + row];
            (0..2).map(|point| Some([0, 1, 2].map(|axis: usize| at(3 * point + axis)))).collect()
        };
        let found: Vec<_> = (0..frames).map(|frame| body_velocities(&by_pose, &seen(frame), &[1e3], 1.5)).collect();
        let share = share_of_motion(&found);
        let (along, squares) = found.iter().zip(&turns).fold((0.0, 0.0), |(along, squares), (found, turn)| {
            let velocity = share * found.velocities[1][1];
            (along + velocity * 2.0 * turn, squares + velocity * velocity)
        });
        assert!((share - 5.0 / (5.0 + 2.25)).abs() < 0.02, "{share}");
        assert!((along / squares - 1.0).abs() < 0.03, "{}", along / squares);
        assert_eq!(share_of_motion(&[]), 1.0);
    }

    /// Standard normals.
    fn normals(seed: u64, count: usize) -> Vec<f64> {
        let mut blocks = vec![Block::ZERO; count.div_ceil(8)];
        Stage::new(seed, "test").whole().fill_normal(Isa::baseline(), &mut blocks);
        blocks.iter().flat_map(|block| block.0).take(count).collect()
    }

    /// Two points of a rod that turns about the first move as it does, whatever is seen of them; without a sighting nothing moves.
    #[test]
    fn a_body_moves_as_it_can() {
        // The rod lies along x and turns about z.
        let by_pose = [0.0, 0.0, 0.0, 0.0, 2.0, 0.0];
        let seen = [Some([0.3, -0.2, 0.1]), Some([0.7, 3.0, 0.5])];
        let found = body_velocities(&by_pose, &seen, &[1e3], 0.1).velocities;
        let near = |found: [f64; 3], expected: [f64; 3]| found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-6);
        assert!(near(found[0], [0.0; 3]) && near(found[1], [0.0, 3.0, 0.0]), "{found:?}");
        // Errors as large as the usual velocity leave half of it.
        assert!(near(body_velocities(&by_pose, &seen, &[0.5], 1.0).velocities[1], [0.0, 1.5, 0.0]));
        assert_eq!(body_velocities(&by_pose, &[None, None], &[1.0], 0.1).velocities, [[0.0; 3]; 2]);
        // Slopes over two frames on each side: Σ k² = 10.
        assert!((velocity_sd(0.01, 30.0) - 0.3 / 10.0_f64.sqrt()).abs() < 1e-12);
    }
}
