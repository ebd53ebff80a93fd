//! Draws of what is constant over a recording, as a frame answers to them.
//!
//! With deviations δ = g⁽ⁱ⁾ − ĝ of some draws ([`crate::lasting::lasting_errors`]), a frame's keypoints would lie elsewhere, and pull its pose elsewhere:
//!
//! ```text
//! shift of point k        S_k = L_k δ_lengths + R_k δ_place,k               by lengths, and along the axes of its link
//! Hᵀ W G δ                Σ_k J_kᵀ Σ_c W Pᵀ (P S_k + E δ_camera + m δ_bias − P v_k δ_lag)      P, E: derivatives of a pixel by point and camera; m: pixels for a metre
//! ```
//!
//! J_k is the derivative of the point by the pose, v_k its velocity. No matrix as large as G is made.

use crate::lasting::lasting_errors::{FrameResidual, LastingErrors, LinearisedDetection, by_lag, point_information};
use sinew_body::point_derivatives::PointDerivatives;
use sinew_core::combinations::add_combinations;
use sinew_core::lanes::{Block, Isa};

/// Draws of g, less the value that a tracker takes for true.
#[derive(Clone, Debug)]
pub struct DrawnErrors {
    /// Where each number of g stands.
    pub errors: LastingErrors,
    /// A row of blocks for each number of g.
    pub deviations: Vec<Block>,
    /// Blocks of draws in a row.
    pub blocks: usize,
    /// Instruction set.
    pub isa: Isa,
}

impl DrawnErrors {
    fn rows(&self, places: std::ops::Range<usize>) -> &[Block] {
        &self.deviations[places.start * self.blocks..places.end * self.blocks]
    }

    /// Shifts of points by the lengths, metres: a row for each of `by_length` ([`PointDerivatives::by_length`]).
    #[must_use]
    pub fn by_length(&self, by_length: &[f64]) -> Vec<Block> {
        let mut shifts = vec![Block::ZERO; by_length.len() / self.errors.lengths * self.blocks];
        add_combinations(self.isa, by_length, self.rows(self.errors.lengths()), &mut shifts, self.blocks);
        shifts
    }

    /// Shifts S of the keypoints, metres: three rows a point.
    #[must_use]
    pub fn keypoint_shifts(&self, body: &PointDerivatives) -> Vec<Block> {
        let mut shifts = self.by_length(&body.by_length);
        let points = shifts.chunks_exact_mut(3 * self.blocks).zip(body.link_axes.chunks_exact(9));
        for (point, (shifts, axes)) in points.enumerate() {
            add_combinations(self.isa, axes, self.rows(self.errors.place(point)), shifts, self.blocks);
        }
        shifts
    }

    /// Shifts points, three rows each, as keypoints do; `pairs` have the places of both.
    pub fn follow(&self, points: &mut [Block], keypoints: &[Block], pairs: &[(usize, usize)]) {
        let three = 3 * self.blocks;
        for &(point, keypoint) in pairs {
            points[point * three..][..three].copy_from_slice(&keypoints[keypoint * three..][..three]);
        }
    }

    /// Hᵀ W G δ, a row for each degree of freedom. `shifts` are [`DrawnErrors::keypoint_shifts`], `scales` the pixels for a metre of each camera, `velocities` how the points move, metres a second.
    #[must_use]
    pub fn pull(
        &self,
        found: &[LinearisedDetection],
        (body, velocities): (&PointDerivatives, &[[f64; 3]]),
        shifts: &[Block],
        scales: &[f64],
        dof: usize,
    ) -> Vec<Block> {
        let mut at_points = vec![Block::ZERO; shifts.len()];
        let mut add = |coefficients: &[f64], rows: &[Block], point: usize| {
            let at_point = &mut at_points[3 * point * self.blocks..][..3 * self.blocks];
            add_combinations(self.isa, coefficients, rows, at_point, self.blocks);
        };
        for seen_there in found.chunk_by(|a, b| a.seen.point == b.seen.point) {
            let point = seen_there[0].seen.point;
            let own = &shifts[3 * point * self.blocks..][..3 * self.blocks];
            add(point_information(seen_there).as_flattened(), own, point);
            for detection in seen_there {
                let LinearisedDetection { seen: FrameResidual { camera, .. }, weight, by } = detection;
                let [u, v] = by.by_point.map(|row| row.map(|by| weight * by));
                let [by_u, by_v] = by.by_error;
                let by_camera = [0, 1, 2].map(|a: usize| {
                    let mut row = by_u.map(|by| u[a] * by);
                    row.iter_mut().zip(by_v).for_each(|(sum, by)| *sum += v[a] * by);
                    row
                });
                add(by_camera.as_flattened(), self.rows(self.errors.camera(*camera)), point);
                let by_bias = [0, 1, 2].map(|a: usize| [scales[*camera] * u[a], scales[*camera] * v[a]]);
                add(by_bias.as_flattened(), self.rows(self.errors.bias(*camera, point)), point);
                let [later_u, later_v] = by_lag(detection, velocities);
                let late = [0, 1, 2].map(|a: usize| u[a] * later_u + v[a] * later_v);
                let lag = self.errors.lag(*camera);
                add(&late, self.rows(lag..lag + 1), point);
            }
        }
        let transposed: Vec<f64> = (0..dof).flat_map(|j| body.by_pose.iter().skip(j).step_by(dof)).copied().collect();
        let mut pull = vec![Block::ZERO; dof * self.blocks];
        add_combinations(self.isa, &transposed, &at_points, &mut pull, self.blocks);
        pull
    }
}
