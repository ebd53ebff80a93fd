//! A ship from bearings alone: one station sees the direction to it, with an error of 0.5 degrees, and its path is drawn from all bearings.

use sinew_tracking::BlockRng;
use sinew_tracking::state_space::{Settings, StateSpace, TransitionDensity, filter_with_history};

/// Place (km) and velocity (km a frame).
struct Ship;

const ACCELERATION: f64 = 0.02;
const BEARING_SD: f64 = 0.5_f64.to_radians();

impl StateSpace for Ship {
    type Observation = Option<f64>;
    fn dim(&self) -> usize {
        4
    }
    fn draw_first(&self, state: &mut [f64], rng: &mut BlockRng) {
        for (x, (mean, sd)) in state.iter_mut().zip([(-5.0, 1.0), (4.0, 1.0), (0.5, 0.1), (0.0, 0.1)]) {
            *x = mean + sd * rng.normal();
        }
    }
    fn draw_next(&self, _frame: usize, before: &[f64], next: &mut [f64], rng: &mut BlockRng) {
        for axis in 0..2 {
            next[2 + axis] = before[2 + axis] + ACCELERATION * rng.normal();
            next[axis] = before[axis] + 0.5 * (before[2 + axis] + next[2 + axis]);
            next[axis] += 0.1 * ACCELERATION * rng.normal();
        }
    }
    fn log_density(&self, _frame: usize, bearing: &Option<f64>, state: &[f64]) -> f64 {
        bearing.map_or(0.0, |bearing| -0.5 * ((bearing - state[1].atan2(state[0])) / BEARING_SD).powi(2))
    }
}

impl TransitionDensity for Ship {
    fn log_transition(&self, _frame: usize, before: &[f64], next: &[f64]) -> f64 {
        let axis = |axis: usize| {
            let change = (next[2 + axis] - before[2 + axis]) / ACCELERATION;
            let rest = next[axis] - before[axis] - 0.5 * (before[2 + axis] + next[2 + axis]);
            -0.5 * change.powi(2) - 0.5 * (rest / (0.1 * ACCELERATION)).powi(2)
        };
        axis(0) + axis(1)
    }
}

fn main() -> Result<(), sinew_tracking::Error> {
    // Straight on at 0.5 km a frame; in the fog of frames 8 to 11 nothing is seen.
    let place = |frame: usize| [-5.0 + 0.5 * frame as f64, 4.0];
    let bearing = |frame: usize| (!(8..12).contains(&frame)).then(|| place(frame)[1].atan2(place(frame)[0]));
    let bearings: Vec<Option<f64>> = (0..20).map(bearing).collect();
    let settings = Settings { particles: 5000, seed: 1, ..Settings::default() };
    let (found, history) = filter_with_history(&Ship, &bearings, settings)?;
    let paths = history.backward_samples(&Ship, 50, 1)?;
    for (frame, now) in found.frames.iter().enumerate() {
        let mean = |axis: usize| paths.iter().map(|path| path[4 * frame + axis]).sum::<f64>() / 50.0;
        println!(
            "frame {frame:2}: at ({:5.2}, {:5.2}), then ({:5.2} ± {:.2}, {:5.2} ± {:.2}), from all bearings ({:5.2}, {:5.2})",
            place(frame)[0],
            place(frame)[1],
            now.mean[0],
            now.sd[0],
            now.mean[1],
            now.sd[1],
            mean(0),
            mean(1)
        );
    }
    Ok(())
}
