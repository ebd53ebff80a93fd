//! How long the points of 100,000 poses take, on one thread: what the Python package is compared with.
//!
//! Prints nanoseconds a pose, the least and the median of 15 rounds: positions into memory that is there, into new memory, and Jacobians of 10,000 poses.

use sinew_body::standard::h32;
use sinew_body::{Plan, Proportions, point_jacobian_each, point_positions_each, point_positions_into};
use sinew_core::lanes::Isa;
use std::time::Instant;

const POSES: usize = 100_000;
const WITH_JACOBIAN: usize = 10_000;
const ROUNDS: usize = 15;

fn measure(what: &str, poses: usize, mut run: impl FnMut()) {
    let mut times: Vec<f64> = (0..ROUNDS)
        .map(|_| {
            let begun = Instant::now();
            run();
            begun.elapsed().as_secs_f64() * 1e9 / poses as f64
        })
        .collect();
    times.sort_by(f64::total_cmp);
    println!("{what} {:.1} {:.1}", times[0], times[ROUNDS / 2]);
}

fn main() {
    let plan = Plan::with_all_points(&h32(&Proportions::default()));
    let (isa, dof, width) = (Isa::best(), plan.dof(), 3 * plan.points());
    let states: Vec<f64> = (0..POSES * dof).map(|k| 0.3 * (k as f64).sin()).collect();
    let mut out = vec![1.0; POSES * width];
    measure("positions", POSES, || point_positions_into(&plan, isa, &states, &mut out));
    measure("positions_in_new_memory", POSES, || out = point_positions_each(&plan, isa, &states));
    let states = &states[..WITH_JACOBIAN * dof];
    measure("jacobian_in_new_memory", WITH_JACOBIAN, || {
        let (mut at, mut by) = (vec![0.0; WITH_JACOBIAN * width], vec![0.0; WITH_JACOBIAN * width * dof]);
        point_jacobian_each(&plan, isa, states, &mut at, &mut by);
        out[0] = by[0];
    });
}
