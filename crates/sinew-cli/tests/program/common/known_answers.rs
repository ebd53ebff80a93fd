//! What is known of a [`World`]: exact moments and quantiles of any combination of its states, with what is constant mixed over the draws of the set-up.

use super::Trial;
use super::linear_world::{Constant, FPS, GAUSSIAN, Numbers, POINTS, SCALE, World, pixels, tracked};
use super::path_posterior::{DIM, PathPosterior};
use super::tally::{normal_below, reached};

pub const DEGREES: f64 = 180.0 / std::f64::consts::PI;
/// Draws of a frame of a filtered run with 200 updates (16 chains, 8 samples discarded, the start counts).
pub const DRAWS: usize = 16 * 193;

/// An equal mixture of Gaussians of one variance: one for each draw of what is constant.
pub struct Mixture {
    pub means: Vec<f64>,
    pub variance: f64,
}

impl Mixture {
    pub fn mean(&self) -> f64 {
        self.means.iter().sum::<f64>() / self.means.len() as f64
    }

    pub fn sd(&self) -> f64 {
        let mean = self.mean();
        let between = self.means.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / self.means.len() as f64;
        (self.variance + between).sqrt()
    }

    /// Its 5 % and 95 % quantiles, by bisection.
    pub fn interval(&self) -> [f64; 2] {
        let sd = self.variance.sqrt();
        let below =
            |x: f64| self.means.iter().map(|mean| normal_below((x - mean) / sd)).sum::<f64>() / self.means.len() as f64;
        let ends = [-10.0, 10.0].map(|z| self.mean() + z * self.sd());
        [0.05, 0.95].map(|p| reached(below, p, ends))
    }
}

/// What frames up to some one say.
pub struct Said<'a> {
    pub world: &'a World,
    pub path: PathPosterior,
    /// By how much each draw of what is constant moves the states, path after path.
    pub moves: Vec<Vec<f64>>,
    /// What errors that last some frames add to the covariance, times the share of it that its draws have.
    pub missing: Option<Vec<Vec<f64>>>,
}

/// Share of a detector's variance that lasts from frame to frame.
const LASTING_SHARE: f64 = 0.93;

impl<'a> Said<'a> {
    pub fn new(world: &'a World, known: usize) -> Self {
        let path = world.posterior(known);
        let rows: Vec<_> = world.rows.iter().filter(|row| row.frame <= known).collect();
        let draws = world.script.lasting.first().map_or(0, |constant| constant.draws.len());
        let of_draw = |draw: usize| {
            let shown = |of: usize| {
                let place = [of / 2 / POINTS.len(), of / 2 % POINTS.len(), of % 2];
                world.script.lasting.iter().map(|g| pixels(&g.name, place) * g.draws[draw]).sum::<f64>()
            };
            let off: Vec<f64> = rows.iter().map(|row| shown(row.of)).collect();
            path.gain.iter().map(|gain| -gain.iter().zip(&off).map(|(k, x)| k * x).sum::<f64>()).collect()
        };
        let moves: Vec<Vec<f64>> =
            if draws == 0 { vec![vec![0.0; path.mean.len()]] } else { (0..draws).map(of_draw).collect() };
        let missing = (world.script.persistence_s > 0.0).then(|| {
            // The covariance of the errors less that which the filter takes them to have: rows of one camera, point and axis correlate.
            let lasting = |a: usize, b: usize| {
                let (a, b) = (rows[a], rows[b]);
                let apart = a.frame.abs_diff(b.frame) as f64 / FPS;
                if a.of == b.of && a.frame != b.frame {
                    LASTING_SHARE * (a.variance * b.variance).sqrt() * (-apart / world.script.persistence_s).exp()
                } else {
                    0.0
                }
            };
            let errors: Vec<Vec<f64>> =
                (0..rows.len()).map(|a| (0..rows.len()).map(|b| lasting(a, b)).collect()).collect();
            let times = |gain: &Vec<f64>| {
                errors.iter().map(|row| row.iter().zip(gain).map(|(e, k)| e * k).sum::<f64>()).collect::<Vec<f64>>()
            };
            let of_draws = (draws as f64 - 1.0) / draws as f64;
            let product = |a: &Vec<f64>, b: &Vec<f64>| of_draws * a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let right: Vec<Vec<f64>> = path.gain.iter().map(times).collect();
            path.gain.iter().map(|left| right.iter().map(|right| product(left, right)).collect()).collect()
        });
        Self { world, path, moves, missing }
    }

    /// What is said of a combination of the states of some frames, and of a number that is constant, with a value for each draw.
    pub fn of(&self, parts: &[(usize, [f64; DIM])], constant: impl Fn(usize) -> f64) -> Mixture {
        let places: Vec<(usize, f64)> = parts
            .iter()
            .flat_map(|(frame, by)| by.iter().enumerate().map(move |(i, by)| (DIM * frame + i, *by)))
            .collect();
        let known: f64 = places.iter().map(|(k, by)| by * self.path.mean[*k]).sum();
        let means = self
            .moves
            .iter()
            .enumerate()
            .map(|(draw, moves)| known + places.iter().map(|(k, by)| by * moves[*k]).sum::<f64>() + constant(draw))
            .collect();
        let quadratic = |matrix: &[Vec<f64>]| {
            places.iter().flat_map(|(k, a)| places.iter().map(move |(l, b)| a * b * matrix[*k][*l])).sum::<f64>()
        };
        Mixture { means, variance: quadratic(&self.path.covariance) + self.missing.as_deref().map_or(0.0, quadratic) }
    }

    pub fn number(&self, frame: usize, number: usize) -> Mixture {
        self.of(&[(frame, unit(number, 1.0))], |_| 0.0)
    }

    /// A coordinate of a point of the body, where `constant` lies between it and what is asked for.
    pub fn point(&self, frame: usize, point: usize, axis: usize, constant: impl Fn(usize) -> f64) -> Mixture {
        let place = POINTS[point].2[axis];
        self.of(&[(frame, self.world.by_state(point, axis))], |draw| place + constant(draw))
    }
}

pub fn unit(number: usize, scale: f64) -> [f64; DIM] {
    std::array::from_fn(|k| if k == number { scale } else { 0.0 })
}

/// A draw of a constant, less the stated value unless that is wanted, too; 0 for one that the world has not.
pub fn drawn(world: &World, name: &str, draw: usize, with_value: bool) -> f64 {
    let known = world.script.lasting.iter().find(|constant| constant.name == name);
    known.map_or(0.0, |known| known.draws[draw] + if with_value { known.value } else { 0.0 })
}

/// The shift of the whole world that a draw of the cameras looks like, by least squares over what both show.
pub fn world_shift(world: &World, axis: usize, draw: usize) -> f64 {
    let moved = |camera: usize, image_axis: usize| {
        let name = format!("{}.principal_point_{}", ["A", "B"][camera], ["u", "v"][image_axis]);
        pixels(&name, [camera, 0, image_axis]) * drawn(world, &name, draw, false)
    };
    match axis {
        2 => 0.5 * (moved(0, 1) + moved(1, 1)) / SCALE,
        camera => -moved(camera, 0) / SCALE,
    }
}

pub fn run(world: &World, trial: &Trial, out: &str, more: &[&str]) {
    let seed = format!("--seed={}", world.script.seed);
    tracked(trial, &[&GAUSSIAN[..], &["--updates=200", "-o", out, &seed], more].concat());
}

/// Draws of biases, a place and principal points, and values that tracking uses.
pub fn constants(draws: usize) -> Vec<Constant> {
    let mut numbers = Numbers::new(77);
    let mut constant = |name: &str, value: f64, sd: f64| {
        let draws = (0..draws).map(|_| sd * numbers.normal()).collect();
        Constant { name: name.to_owned(), value, draws }
    };
    vec![
        constant("A.LHip.bias_u_m", 0.02, 0.02),
        constant("B.LShoulder.bias_u_m", -0.01, 0.03),
        constant("B.RKnee.bias_v_m", 0.01, 0.02),
        constant("body.LKnee.place_x_m", 0.03, 0.02),
        constant("body.RShoulder.place_z_m", -0.02, 0.02),
        // Shares of a focal length of 10⁹ pixels.
        constant("A.principal_point_u", 1e-9, 1.5e-9),
        constant("A.principal_point_v", 0.0, 1e-9),
        constant("B.principal_point_u", -1e-9, 1.5e-9),
        constant("B.principal_point_v", 0.0, 2e-9),
    ]
}
