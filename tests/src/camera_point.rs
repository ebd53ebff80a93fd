//! A point in space seen by two pinhole cameras (`exact/point_two_cameras_a.json`), through the project's own camera and its derivative.

use crate::linear_series::rows;
use crate::stored::{number, numbers, stored};
use serde_json::Value;
use sinew::core::combinators::Sum;
use sinew::core::density::{GradLogDensity, Lanes, LogDensity};
use sinew::core::lanes::Isa;
use sinew::core::transition::Moments;
use sinew::dynamics::gaussian::Gaussian;
use sinew::observe::Camera;
use std::f64::consts::TAU;

/// A camera and what it sees of the point.
#[derive(Clone, Debug)]
pub struct View {
    /// The camera.
    pub camera: Camera,
    /// Observed pixel.
    pub pixel: [f64; 2],
    /// Standard deviation of its errors.
    pub sigma_px: f64,
}

/// log p(pixels | point), with all constants; −∞ behind a camera.
#[derive(Clone, Debug)]
pub struct Sight(pub Vec<View>);

/// What is stored.
#[derive(Clone, Debug)]
pub struct CameraPoint {
    /// The observation.
    pub sight: Sight,
    /// The prior of the point.
    pub prior: Lanes<Gaussian>,
    /// Log evidence.
    pub log_evidence: f64,
    /// Exact moments.
    pub moments: Moments,
    /// The mode.
    pub mode: Vec<f64>,
    /// The whole file.
    pub stored: Value,
}

impl CameraPoint {
    /// The stored problem; `None`, with a note, where the data folder is missing.
    #[must_use]
    pub fn stored() -> Option<Self> {
        let v = stored("exact/point_two_cameras_a.json")?;
        let three = |row: Vec<f64>| -> [f64; 3] { row.try_into().expect("three numbers") };
        let view = |of: &Value| {
            let k = rows(&of["K"]);
            let mut camera = Camera::look_at("stored", [1280.0, 720.0], 900.0, [0.0, -4.0, 1.0], [0.0, 0.0, 1.0])
                .expect("not straight down");
            camera.intrinsics.fx = k[0][0];
            camera.intrinsics.fy = k[1][1];
            camera.intrinsics.cx = k[0][2];
            camera.intrinsics.cy = k[1][2];
            let rotation: Vec<[f64; 3]> = rows(&of["R"]).into_iter().map(three).collect();
            camera.rotation = rotation.try_into().expect("three rows");
            camera.translation = three(numbers(&of["t"]));
            let pixel = numbers(&of["y"]);
            View { camera, pixel: [pixel[0], pixel[1]], sigma_px: number(&of["sd"]) }
        };
        let variance = number(&v["p0"]).powi(2);
        let covariance: Vec<f64> = (0..9).map(|e| if e / 3 == e % 3 { variance } else { 0.0 }).collect();
        let leaf = Gaussian::new(numbers(&v["m0"]), &covariance).expect("positive definite");
        Some(Self {
            sight: Sight(v["cameras"].as_array().expect("array").iter().map(view).collect()),
            prior: Lanes { leaf, isa: Isa::best() },
            log_evidence: number(&v["log_evidence"]),
            moments: Moments { mean: numbers(&v["posterior_mean"]), covariance: rows(&v["posterior_cov"]).concat() },
            mode: numbers(&v["map"]),
            stored: v,
        })
    }

    /// Observation and prior.
    #[must_use]
    pub fn target(&self) -> Sum<&Sight, &Lanes<Gaussian>> {
        Sum(&self.sight, &self.prior)
    }
}

impl LogDensity for Sight {
    fn dim(&self) -> usize {
        3
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.log_density_grad(x, &mut [0.0; 3])
    }
}

impl GradLogDensity for Sight {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        grad.fill(0.0);
        let mut value = 0.0;
        for View { camera, pixel, sigma_px } in &self.0 {
            let Some((seen, jacobian)) = camera.project_with_jacobian([x[0], x[1], x[2]]) else {
                return f64::NEG_INFINITY;
            };
            for axis in 0..2 {
                let error = (pixel[axis] - seen[axis]) / sigma_px;
                value -= 0.5 * error * error + 0.5 * TAU.ln() + sigma_px.ln();
                for (g, slope) in grad.iter_mut().zip(jacobian[axis]) {
                    *g += error / sigma_px * slope;
                }
            }
        }
        value
    }
}
