//! Densities made of densities: [`Sum`], [`Tempered`], [`OnPart`], [`GivenCurvature`], [`Through`].

use crate::density::{GaussNewton, GradLogDensity, LogDensity};
use crate::lanes::{Block, triangle};
use crate::part::Part;

pub use crate::through::Through;

/// Product of two densities over the same state: the sum of their logarithms.
///
/// Law `sum_adds`: value and gradient are the sums of the parts'; −∞ on either side gives −∞.
#[derive(Clone, Copy, Debug)]
pub struct Sum<A, B>(pub A, pub B);

impl<A: LogDensity, B: LogDensity> LogDensity for Sum<A, B> {
    fn dim(&self) -> usize {
        self.0.dim()
    }
    fn workspace(&self) -> usize {
        self.dim() + self.0.workspace().max(self.1.workspace())
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.0.log_density(x) + self.1.log_density(x)
    }
    fn log_density_block(&self, x: &[Block], ws: &mut [Block]) -> Block {
        add(self.0.log_density_block(x, ws), self.1.log_density_block(x, ws))
    }
}

impl<A: GradLogDensity, B: GradLogDensity> GradLogDensity for Sum<A, B> {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        let mut other = vec![0.0; self.dim()];
        let value = self.0.log_density_grad(x, grad) + self.1.log_density_grad(x, &mut other);
        for (g, o) in grad.iter_mut().zip(other) {
            *g += o;
        }
        value
    }
    fn log_density_grad_block(&self, x: &[Block], grad: &mut [Block], ws: &mut [Block]) -> Block {
        let (other, ws) = ws.split_at_mut(self.dim());
        let a = self.0.log_density_grad_block(x, grad, ws);
        let b = self.1.log_density_grad_block(x, other, ws);
        add_to(grad, other);
        add(a, b)
    }
}

impl<A: GaussNewton, B: GaussNewton> GaussNewton for Sum<A, B> {
    fn matrix_workspace(&self) -> usize {
        triangle(self.dim(), 0) + self.0.matrix_workspace().max(self.1.matrix_workspace())
    }
    fn gauss_newton_diagonal_block(&self, x: &[Block], diagonal: &mut [Block], ws: &mut [Block]) {
        let (other, ws) = ws.split_at_mut(self.dim());
        self.0.gauss_newton_diagonal_block(x, diagonal, ws);
        self.1.gauss_newton_diagonal_block(x, other, ws);
        add_to(diagonal, other);
    }
    fn gauss_newton_block(&self, x: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
        let (other, ws) = ws.split_at_mut(matrix.len());
        self.0.gauss_newton_block(x, matrix, ws);
        self.1.gauss_newton_block(x, other, ws);
        add_to(matrix, other);
    }
    fn weighted_gauss_newton_block(&self, x: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
        let (other, ws) = ws.split_at_mut(matrix.len());
        self.0.weighted_gauss_newton_block(x, matrix, ws);
        self.1.weighted_gauss_newton_block(x, other, ws);
        add_to(matrix, other);
    }
}

fn add_to(a: &mut [Block], b: &[Block]) {
    for (a, b) in a.iter_mut().zip(b) {
        *a = add(*a, *b);
    }
}

#[inline]
fn add(a: Block, b: Block) -> Block {
    let mut sum = a;
    for (s, b) in sum.0.iter_mut().zip(b.0) {
        *s += b;
    }
    sum
}

/// A density raised to the power `beta` ≥ 0.
///
/// Law `tempered_scales`: value and gradient are multiplied by `beta`; −∞ stays −∞ for every `beta`, also 0.
#[derive(Clone, Copy, Debug)]
pub struct Tempered<D> {
    /// The density.
    pub target: D,
    /// The exponent.
    pub beta: f64,
}

fn tempered(beta: f64, value: f64) -> f64 {
    if value == f64::NEG_INFINITY { value } else { beta * value }
}

impl<D: LogDensity> LogDensity for Tempered<D> {
    fn dim(&self) -> usize {
        self.target.dim()
    }
    fn workspace(&self) -> usize {
        self.target.workspace()
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        tempered(self.beta, self.target.log_density(x))
    }
    fn log_density_block(&self, x: &[Block], ws: &mut [Block]) -> Block {
        let mut value = self.target.log_density_block(x, ws);
        value.0.iter_mut().for_each(|v| *v = tempered(self.beta, *v));
        value
    }
}

impl<D: GradLogDensity> GradLogDensity for Tempered<D> {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        let value = self.target.log_density_grad(x, grad);
        grad.iter_mut().for_each(|g| *g *= self.beta);
        tempered(self.beta, value)
    }
    fn log_density_grad_block(&self, x: &[Block], grad: &mut [Block], ws: &mut [Block]) -> Block {
        let mut value = self.target.log_density_grad_block(x, grad, ws);
        grad.iter_mut().flat_map(|b| &mut b.0).for_each(|g| *g *= self.beta);
        value.0.iter_mut().for_each(|v| *v = tempered(self.beta, *v));
        value
    }
}

/// A density of the coordinates of one part, the others held at fixed values.
///
/// Law `on_part_masks`: the value is the full density's at the completed state, the gradient its restriction.
#[derive(Clone, Debug)]
pub struct OnPart<D> {
    /// Density of the full state.
    pub target: D,
    /// Free coordinates.
    pub part: Part,
    /// A full state; its free coordinates are ignored.
    pub fixed: Vec<f64>,
}

impl<D: LogDensity> OnPart<D> {
    fn complete(&self, x: &[f64]) -> Vec<f64> {
        let mut full = self.fixed.clone();
        for (&i, &x) in self.part.indices().iter().zip(x) {
            full[i] = x;
        }
        full
    }
    fn complete_block(&self, x: &[Block], full: &mut [Block]) {
        for (b, &x) in full.iter_mut().zip(&self.fixed) {
            *b = Block::splat(x);
        }
        for (&i, &x) in self.part.indices().iter().zip(x) {
            full[i] = x;
        }
    }
}

impl<D: LogDensity> LogDensity for OnPart<D> {
    fn dim(&self) -> usize {
        self.part.indices().len()
    }
    fn workspace(&self) -> usize {
        2 * self.target.dim() + self.target.workspace()
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.target.log_density(&self.complete(x))
    }
    fn log_density_block(&self, x: &[Block], ws: &mut [Block]) -> Block {
        let (full, ws) = ws.split_at_mut(self.target.dim());
        self.complete_block(x, full);
        self.target.log_density_block(full, ws)
    }
}

impl<D: GradLogDensity> GradLogDensity for OnPart<D> {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        let mut full = vec![0.0; self.target.dim()];
        let value = self.target.log_density_grad(&self.complete(x), &mut full);
        for (g, &i) in grad.iter_mut().zip(self.part.indices()) {
            *g = full[i];
        }
        value
    }
    fn log_density_grad_block(&self, x: &[Block], grad: &mut [Block], ws: &mut [Block]) -> Block {
        let (full, ws) = ws.split_at_mut(self.target.dim());
        let (full_grad, ws) = ws.split_at_mut(self.target.dim());
        self.complete_block(x, full);
        let value = self.target.log_density_grad_block(full, full_grad, ws);
        for (g, &i) in grad.iter_mut().zip(self.part.indices()) {
            *g = full_grad[i];
        }
        value
    }
}

impl<D: GaussNewton> GaussNewton for OnPart<D> {
    fn matrix_workspace(&self) -> usize {
        self.target.dim() + triangle(self.target.dim(), 0) + self.target.matrix_workspace()
    }
    fn gauss_newton_diagonal_block(&self, x: &[Block], diagonal: &mut [Block], ws: &mut [Block]) {
        let (full, ws) = ws.split_at_mut(self.target.dim());
        let (full_diagonal, ws) = ws.split_at_mut(self.target.dim());
        self.complete_block(x, full);
        self.target.gauss_newton_diagonal_block(full, full_diagonal, ws);
        for (d, &i) in diagonal.iter_mut().zip(self.part.indices()) {
            *d = full_diagonal[i];
        }
    }
    fn gauss_newton_block(&self, x: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
        let (full, ws) = ws.split_at_mut(self.target.dim());
        let (full_matrix, ws) = ws.split_at_mut(triangle(self.target.dim(), 0));
        self.complete_block(x, full);
        self.target.gauss_newton_block(full, full_matrix, ws);
        let indices = self.part.indices();
        for (a, &i) in indices.iter().enumerate() {
            for (b, &j) in indices[..=a].iter().enumerate() {
                matrix[triangle(a, b)] = full_matrix[triangle(i, j)];
            }
        }
    }
}

/// A density that has only a gradient, with a diagonal that the caller gives in place of its Gauss–Newton matrix, for what asks for one to choose its steps.
///
/// The diagonal changes no target: a sampler whose metric comes from it draws from the same density, the better the nearer the diagonal is to the inverse variances of the density's coordinates. With zeros a filter's metric is that of its prior, which serves while
/// the observation says little more than the prior.
///
/// Law `given_curvature_keeps_the_density`: value and gradient are the density's.
///
/// ```
/// use sinew_core::combinators::GivenCurvature;
/// use sinew_core::density::{GaussNewton, GradLogDensity, LogDensity};
///
/// /// A place seen with an error of Laplace's kind: log p = −√(1 + (x / 0.1)²).
/// struct Seen;
/// impl LogDensity for Seen {
///     fn dim(&self) -> usize {
///         1
///     }
///     fn log_density(&self, x: &[f64]) -> f64 {
///         -(10.0 * x[0]).hypot(1.0)
///     }
/// }
/// impl GradLogDensity for Seen {
///     fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
///         grad[0] = -100.0 * x[0] / (10.0 * x[0]).hypot(1.0);
///         self.log_density(x)
///     }
/// }
/// fn steps(density: &impl GaussNewton) -> f64 {
///     let mut diagonal = [0.0];
///     density.gauss_newton_diagonal(&[0.3], &mut diagonal);
///     diagonal[0].sqrt().recip()
/// }
/// assert_eq!(steps(&GivenCurvature { target: &Seen, diagonal: vec![100.0] }), 0.1);
/// ```
#[derive(Clone, Debug)]
pub struct GivenCurvature<D> {
    /// The density.
    pub target: D,
    /// Diagonal of the matrix, one entry a coordinate, in units of one over the square of the coordinate's; not negative.
    pub diagonal: Vec<f64>,
}

impl<D: LogDensity> LogDensity for GivenCurvature<D> {
    fn dim(&self) -> usize {
        self.target.dim()
    }
    fn workspace(&self) -> usize {
        self.target.workspace()
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.target.log_density(x)
    }
    fn log_density_block(&self, x: &[Block], ws: &mut [Block]) -> Block {
        self.target.log_density_block(x, ws)
    }
}

impl<D: GradLogDensity> GradLogDensity for GivenCurvature<D> {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        self.target.log_density_grad(x, grad)
    }
    fn log_density_grad_block(&self, x: &[Block], grad: &mut [Block], ws: &mut [Block]) -> Block {
        self.target.log_density_grad_block(x, grad, ws)
    }
}

impl<D: GradLogDensity> GaussNewton for GivenCurvature<D> {
    fn gauss_newton_diagonal_block(&self, _x: &[Block], diagonal: &mut [Block], _ws: &mut [Block]) {
        debug_assert_eq!(diagonal.len(), self.diagonal.len());
        diagonal.iter_mut().zip(&self.diagonal).for_each(|(block, &entry)| *block = Block::splat(entry));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toy::Quadratic;

    fn target() -> Quadratic {
        Quadratic { centre: vec![0.3, -1.0, 2.0], precision: vec![1.0, 4.0, 0.5] }
    }

    struct Cliff;
    impl LogDensity for Cliff {
        fn dim(&self) -> usize {
            3
        }
        fn log_density(&self, x: &[f64]) -> f64 {
            if x[0] > 0.0 { f64::NEG_INFINITY } else { 0.0 }
        }
    }

    fn check_gradient(density: &impl GradLogDensity, x: &[f64]) {
        let d = density.dim();
        let mut grad = vec![0.0; d];
        density.log_density_grad(x, &mut grad);
        for j in 0..d {
            let at = |h: f64| {
                let mut x = x.to_vec();
                x[j] += h;
                density.log_density(&x)
            };
            let numeric = (at(1e-5) - at(-1e-5)) / 2e-5;
            assert!((numeric - grad[j]).abs() < 1e-7, "coordinate {j}: {numeric} against {}", grad[j]);
        }
        let block: Vec<Block> = x.iter().map(|&x| Block::splat(x)).collect();
        let mut grad_block = vec![Block::ZERO; d];
        let mut ws = vec![Block::ZERO; density.workspace()];
        let value = density.log_density_grad_block(&block, &mut grad_block, &mut ws);
        assert_eq!(value.0[5], density.log_density(x));
        assert!((grad_block[d - 1].0[2] - grad[d - 1]).abs() < 1e-14);
        assert_eq!(density.log_density_block(&block, &mut ws).0[7], density.log_density(x));
    }

    #[test]
    fn sum_adds() {
        let sum = Sum(target(), target());
        check_gradient(&sum, &[0.1, 0.2, 0.3]);
        assert_eq!(sum.log_density(&[1.0, 2.0, 3.0]), 2.0 * target().log_density(&[1.0, 2.0, 3.0]));
        assert_eq!(Sum(target(), Cliff).log_density(&[1.0, 0.0, 0.0]), f64::NEG_INFINITY);
    }

    #[test]
    fn tempered_scales() {
        let half = Tempered { target: target(), beta: 0.5 };
        check_gradient(&half, &[0.1, 0.2, 0.3]);
        assert_eq!(half.log_density(&[1.0, 2.0, 3.0]), 0.5 * target().log_density(&[1.0, 2.0, 3.0]));
        let off = Tempered { target: Cliff, beta: 0.0 };
        assert_eq!(off.log_density(&[1.0, 0.0, 0.0]), f64::NEG_INFINITY);
        assert_eq!(off.log_density_block(&[Block::splat(1.0); 3], &mut []).0[0], f64::NEG_INFINITY);
    }

    #[test]
    fn given_curvature_keeps_the_density() {
        let given = GivenCurvature { target: target(), diagonal: vec![3.0, 0.0, 7.0] };
        check_gradient(&given, &[0.1, 0.2, 0.3]);
        assert_eq!(given.log_density(&[1.0, 2.0, 3.0]), target().log_density(&[1.0, 2.0, 3.0]));
        let mut matrix = [Block::splat(f64::NAN); 6];
        given.gauss_newton_block(&[Block::splat(9.0); 3], &mut matrix, &mut []);
        assert_eq!(matrix.map(|entry| entry.0[4]), [3.0, 0.0, 0.0, 0.0, 0.0, 7.0]);
    }

    #[test]
    fn on_part_masks() {
        let part = Part::new(vec![2, 0], 3).expect("valid part");
        let masked = OnPart { target: target(), part, fixed: vec![9.0, 0.7, 9.0] };
        check_gradient(&masked, &[0.1, 0.3]);
        assert_eq!(masked.log_density(&[0.1, 0.3]), target().log_density(&[0.1, 0.7, 0.3]));
    }
}
