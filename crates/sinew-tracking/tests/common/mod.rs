//! An observation that serves every tracker.

use sinew_core::density::{GaussNewton, GradLogDensity, Lanes, LogDensity, PartLogDensity};
use sinew_core::lanes::{Block, Isa};
use sinew_core::toy::Quadratic;

/// A Gaussian of which each coordinate is a part, said to be their product or not.
pub struct Sight {
    pub whole: Lanes<Quadratic>,
    pub product: bool,
}

impl Sight {
    pub fn new(centre: Vec<f64>, precision: Vec<f64>, product: bool) -> Self {
        Self { whole: Lanes { leaf: Quadratic { centre, precision }, isa: Isa::best() }, product }
    }
}

impl LogDensity for Sight {
    fn dim(&self) -> usize {
        self.whole.dim()
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.whole.log_density(x)
    }
    fn log_density_block(&self, x: &[Block], ws: &mut [Block]) -> Block {
        self.whole.log_density_block(x, ws)
    }
}

impl GradLogDensity for Sight {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        self.whole.log_density_grad(x, grad)
    }
    fn log_density_grad_block(&self, x: &[Block], grad: &mut [Block], ws: &mut [Block]) -> Block {
        self.whole.log_density_grad_block(x, grad, ws)
    }
}

impl GaussNewton for Sight {
    fn gauss_newton_diagonal_block(&self, x: &[Block], diagonal: &mut [Block], ws: &mut [Block]) {
        self.whole.gauss_newton_diagonal_block(x, diagonal, ws);
    }
}

impl PartLogDensity for Sight {
    fn parts(&self) -> usize {
        self.dim()
    }
    fn is_product(&self) -> bool {
        self.product
    }
    fn log_density_parts_block(&self, parts: &[usize], x: &[Block], out: &mut [Block], _ws: &mut [Block]) {
        let Quadratic { centre, precision } = &self.whole.leaf;
        for (&k, out) in parts.iter().zip(out) {
            *out = Block(x[k].0.map(|x| -0.5 * precision[k] * (x - centre[k]).powi(2)));
        }
    }
}
