//! Every way to evaluate a density gives the same answer: lane leaf, reference, box, block, default method.

use sinew_core::combinators::{OnPart, Sum, Tempered, Through};
use sinew_core::decode::Identity;
use sinew_core::density::{GaussNewton, GradLogDensity, LaneDensity, LaneGaussNewton, Lanes, LogDensity};
use sinew_core::inlined;
use sinew_core::lanes::{Block, Isa, LANES, Real, get_lane, set_lane, triangle};
use sinew_core::part::Part;
use sinew_core::random::{BlockRng, Stage};
use sinew_core::toy::Quadratic;
use sinew_core::transition::{FramePrior, MotionModel, Transition, diagonal_matrix};
use std::backtrace::Backtrace;

const D: usize = 3;
/// Lower triangle of the curvature of [`Bent`].
const MATRIX: [f64; 6] = [2.0, 0.5, 3.0, -0.25, 0.75, 4.0];
/// What [`Bent`] gives where observations are weighted.
const WEIGHT: f64 = 0.125;

/// `−½ factor xᵀ M x`, written in lanes, with a scratch of five and a curvature that is no diagonal.
#[derive(Clone, Copy)]
struct Bent {
    factor: f64,
}

impl LaneDensity for Bent {
    fn dim(&self) -> usize {
        D
    }
    fn workspace(&self) -> usize {
        5
    }
    #[inline(always)]
    fn eval<V: Real, const GRAD: bool>(&self, x: &[V::Mem], grad: &mut [V::Mem], ws: &mut [V::Mem]) -> V {
        assert!(ws.len() >= 5);
        let mut sum = V::splat(0.0);
        for i in 0..D {
            let mut force = V::splat(0.0);
            for j in 0..D {
                let entry = MATRIX[triangle(i.max(j), i.min(j))];
                force = force - V::splat(self.factor * entry) * V::load(&x[j]);
            }
            sum = sum + force * V::load(&x[i]);
            if GRAD {
                force.store(&mut grad[i]);
            }
        }
        sum * V::splat(0.5)
    }
}

impl LaneGaussNewton for Bent {
    #[inline(always)]
    fn gauss_newton_diagonal<V: Real>(&self, _x: &[V::Mem], diagonal: &mut [V::Mem], _ws: &mut [V::Mem]) {
        for (i, d) in diagonal.iter_mut().enumerate() {
            V::splat(self.factor * MATRIX[triangle(i, i)]).store(d);
        }
    }
    #[inline(always)]
    fn gauss_newton<V: Real>(&self, _x: &[V::Mem], matrix: &mut [V::Mem], _ws: &mut [V::Mem]) {
        for (m, entry) in matrix.iter_mut().zip(MATRIX) {
            V::splat(self.factor * entry).store(m);
        }
    }
    #[inline(always)]
    fn weighted_gauss_newton<V: Real>(&self, _x: &[V::Mem], matrix: &mut [V::Mem], _ws: &mut [V::Mem]) {
        for (m, entry) in matrix.iter_mut().zip(MATRIX) {
            V::splat(self.factor * WEIGHT * entry).store(m);
        }
    }
    fn broadened(&self, factor: f64) -> Option<Self> {
        Some(Self { factor: self.factor / (factor * factor) })
    }
}

/// The same density, of one state at a time; everything else is a default.
struct OneByOne(Bent);

fn value(factor: f64, x: &[f64]) -> f64 {
    let entry = |i: usize, j: usize| factor * MATRIX[triangle(i.max(j), i.min(j))];
    -0.5 * (0..D).map(|i| (0..D).map(|j| x[i] * entry(i, j) * x[j]).sum::<f64>()).sum::<f64>()
}

impl LogDensity for OneByOne {
    fn dim(&self) -> usize {
        D
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        value(self.0.factor, x)
    }
}

impl GradLogDensity for OneByOne {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        for (i, g) in grad.iter_mut().enumerate() {
            *g = -(0..D).map(|j| self.0.factor * MATRIX[triangle(i.max(j), i.min(j))] * x[j]).sum::<f64>();
        }
        value(self.0.factor, x)
    }
}

impl GaussNewton for OneByOne {
    fn gauss_newton_diagonal(&self, _x: &[f64], diagonal: &mut [f64]) {
        for (i, d) in diagonal.iter_mut().enumerate() {
            *d = self.0.factor * MATRIX[triangle(i, i)];
        }
    }
}

/// A leaf that knows its diagonal only.
struct Diagonal;

impl LaneDensity for Diagonal {
    fn dim(&self) -> usize {
        D
    }
    #[inline(always)]
    fn eval<V: Real, const GRAD: bool>(&self, _x: &[V::Mem], _grad: &mut [V::Mem], _ws: &mut [V::Mem]) -> V {
        V::splat(0.0)
    }
}

impl LaneGaussNewton for Diagonal {
    #[inline(always)]
    fn gauss_newton_diagonal<V: Real>(&self, x: &[V::Mem], diagonal: &mut [V::Mem], _ws: &mut [V::Mem]) {
        for (x, d) in x.iter().zip(diagonal) {
            (V::load(x) + V::splat(1.0)).store(d);
        }
    }
}

/// Eight different states.
fn states() -> Vec<[f64; D]> {
    (0..LANES).map(|lane| [0.3, -0.7, 1.1].map(|x: f64| x * (1.0 + 0.2 * lane as f64) - 0.1 * lane as f64)).collect()
}

fn block(states: &[[f64; D]]) -> [Block; D] {
    let mut block = [Block::ZERO; D];
    states.iter().enumerate().for_each(|(lane, state)| set_lane(&mut block, lane, state));
    block
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-13 * (1.0 + b.abs())
}

/// Values and gradients, one by one and in a block with just the scratch that is required.
fn has_the_values_of_bent(density: &dyn GaussNewton, factor: f64) {
    assert_eq!(density.dim(), D);
    let mut ws = vec![Block::splat(f64::NAN); density.workspace()];
    let x = block(&states());
    let mut grad_block = [Block::splat(f64::NAN); D];
    let values = density.log_density_block(&x, &mut ws);
    let again = density.log_density_grad_block(&x, &mut grad_block, &mut ws);
    for (lane, state) in states().iter().enumerate() {
        let mut grad = [f64::NAN; D];
        let expected = value(factor, state);
        let with_gradient = density.log_density_grad(state, &mut grad);
        for found in [density.log_density(state), with_gradient, values.0[lane], again.0[lane]] {
            assert!(near(found, expected), "{found} against {expected}");
        }
        for (j, (one, many)) in grad.into_iter().zip(grad_block).enumerate() {
            let mut moved = *state;
            moved[j] += 1e-5;
            let above = value(factor, &moved);
            moved[j] -= 2e-5;
            let numeric = (above - value(factor, &moved)) / 2e-5;
            assert!((one - numeric).abs() < 1e-8 && near(many.0[lane], one), "{one} {numeric} {}", many.0[lane]);
        }
    }
}

/// Packed lower triangles: the curvature, and with observations weighted.
fn curvatures(density: &dyn GaussNewton, x: &[Block]) -> [Vec<f64>; 3] {
    let d = density.dim();
    let ask = |length: usize, what: &dyn Fn(&mut [Block], &mut [Block])| {
        let mut out = vec![Block::splat(f64::NAN); length];
        what(&mut out, &mut vec![Block::splat(f64::NAN); density.matrix_workspace()]);
        out.into_iter().map(|block| block.0[3]).collect()
    };
    [
        ask(d, &|out, ws| density.gauss_newton_diagonal_block(x, out, ws)),
        ask(triangle(d, 0), &|out, ws| density.gauss_newton_block(x, out, ws)),
        ask(triangle(d, 0), &|out, ws| density.weighted_gauss_newton_block(x, out, ws)),
    ]
}

#[test]
fn triangles_are_packed_row_after_row() {
    let places: Vec<usize> = (0..4).flat_map(|i| (0..=i).map(move |j| triangle(i, j))).collect();
    assert_eq!(places, (0..10).collect::<Vec<_>>());
    assert_eq!(diagonal_matrix(&[5.0, 6.0, 7.0]), [5.0, 0.0, 0.0, 0.0, 6.0, 0.0, 0.0, 0.0, 7.0]);
    let mut state = [0.0; D];
    get_lane(&block(&states()), 5, &mut state);
    assert_eq!(state, states()[5]);
}

#[test]
fn a_leaf_a_reference_and_a_box_are_one_density() {
    for isa in Isa::available() {
        let leaf = Lanes { leaf: Bent { factor: 1.5 }, isa };
        let boxed: Box<dyn GaussNewton> = Box::new(leaf);
        let by_reference = &leaf;
        let through = Through { target: leaf, decoder: Identity(D) };
        let x = block(&states());
        let scaled = |by: f64| MATRIX.map(|entry| 1.5 * by * entry).to_vec();
        assert_eq!([leaf.workspace(), boxed.workspace(), by_reference.workspace()], [5; 3]);
        for density in [&leaf as &dyn GaussNewton, &boxed, &by_reference, &through] {
            has_the_values_of_bent(density, 1.5);
            let [diagonal, matrix, weighted] = curvatures(density, &x);
            assert_eq!(diagonal, [3.0, 4.5, 6.0]);
            assert_eq!((matrix, weighted), (scaled(1.0), scaled(WEIGHT)));
            has_the_values_of_bent(&density.broadened(2.0).unwrap(), 1.5 / 4.0);
        }
    }
}

#[test]
fn defaults_ask_state_by_state_and_take_the_diagonal() {
    let density = OneByOne(Bent { factor: 0.75 });
    has_the_values_of_bent(&density, 0.75);
    let [diagonal, matrix, weighted] = curvatures(&density, &block(&states()));
    assert_eq!(diagonal, [1.5, 2.25, 3.0]);
    assert_eq!(matrix, [1.5, 0.0, 2.25, 0.0, 0.0, 3.0]);
    assert_eq!(weighted, matrix);
    assert!(density.broadened(2.0).is_none());
    let leaf = Lanes { leaf: Diagonal, isa: Isa::baseline() };
    let [diagonal, matrix, weighted] = curvatures(&leaf, &[0.5, 1.5, 2.5].map(Block::splat));
    assert_eq!(diagonal, [1.5, 2.5, 3.5]);
    assert_eq!(matrix, [1.5, 0.0, 2.5, 0.0, 0.0, 3.5]);
    assert_eq!(weighted, matrix);
    assert!(leaf.broadened(2.0).is_none() && leaf.workspace() == 0);
}

#[test]
fn the_toy_is_the_same_in_lanes_and_as_a_plain_density() {
    let toy = Quadratic { centre: vec![0.3, -1.0, 2.0], precision: vec![1.0, 4.0, 0.5] };
    let expected = |x: &[f64]| -0.5 * ((x[0] - 0.3).powi(2) + 4.0 * (x[1] + 1.0).powi(2) + 0.5 * (x[2] - 2.0).powi(2));
    let leaf = Lanes { leaf: toy.clone(), isa: Isa::best() };
    for density in [&toy as &dyn GaussNewton, &leaf] {
        assert_eq!(density.dim(), 3);
        for state in states() {
            let mut grad = [0.0; D];
            assert!(near(density.log_density_grad(&state, &mut grad), expected(&state)));
            assert!(near(density.log_density(&state), expected(&state)));
            let forces = [0.3 - state[0], 4.0 * (-1.0 - state[1]), 0.5 * (2.0 - state[2])];
            assert!(grad.into_iter().zip(forces).all(|(g, f)| near(g, f)), "{grad:?} {forces:?}");
        }
        assert_eq!(curvatures(density, &block(&states()))[0], [1.0, 4.0, 0.5]);
    }
}

#[test]
fn curvatures_add_and_are_restricted() {
    let isa = Isa::best();
    let leaf = |factor| Lanes { leaf: Bent { factor }, isa };
    let sum = Sum(leaf(1.0), leaf(2.0));
    has_the_values_of_bent(&sum, 3.0);
    let x = block(&states());
    let [diagonal, matrix, weighted] = curvatures(&sum, &x);
    assert_eq!(diagonal, [6.0, 9.0, 12.0]);
    assert_eq!(matrix, MATRIX.map(|entry| 3.0 * entry));
    assert_eq!(weighted, MATRIX.map(|entry| 3.0 * WEIGHT * entry));
    let part = Part::new(vec![0, 2], D).unwrap();
    let restricted = OnPart { target: leaf(1.0), part, fixed: vec![0.0; D] };
    let [diagonal, matrix, weighted] = curvatures(&restricted, &x[..2]);
    assert_eq!(diagonal, [2.0, 4.0]);
    assert_eq!(matrix, [2.0, -0.25, 4.0]);
    assert_eq!(weighted, matrix);
    let tempered = Tempered { target: leaf(2.0), beta: 0.25 };
    assert_eq!((tempered.dim(), tempered.workspace()), (D, 5));
    assert!(near(tempered.log_density(&states()[1]), value(0.5, &states()[1])));
}

/// Steps of one, exactly.
struct Steps;

impl MotionModel for Steps {
    fn dim(&self) -> usize {
        D
    }
}

impl Transition for Steps {
    fn sample_block(&self, previous: &[Block], next: &mut [Block], _rng: &mut BlockRng) {
        for (p, n) in previous.iter().zip(next) {
            *n = Block(p.0.map(|x| x + 1.0));
        }
    }
    fn log_density(&self, _previous: &[f64], _next: &[f64]) -> f64 {
        0.0
    }
}

impl LogDensity for Steps {
    fn dim(&self) -> usize {
        D
    }
    fn log_density(&self, _x: &[f64]) -> f64 {
        0.0
    }
}

impl GradLogDensity for Steps {
    fn log_density_grad(&self, _x: &[f64], _grad: &mut [f64]) -> f64 {
        0.0
    }
}

impl FramePrior for Steps {
    fn sample_block(&self, _block: usize, _out: &mut [Block], _rng: &mut BlockRng) {}
    fn precision_diagonal(&self) -> &[f64] {
        &[1.0, 2.0, 3.0]
    }
}

#[test]
fn a_first_frame_is_a_step_from_its_centre_and_a_precision_is_its_diagonal() {
    let mut rng = Stage::new(1, "steps").whole();
    let mut next = [Block::ZERO; D];
    Steps.sample_initial_block(&[5.0, 6.0, 7.0], &mut next, &mut rng);
    assert_eq!(next, [6.0, 7.0, 8.0].map(Block::splat));
    assert_eq!(FramePrior::precision(&Steps), [1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 3.0]);
}

/// Frames on the stack. Without debug information, as the profile of tests has it for this crate, functions that were inlined are none.
fn stack_frames() -> usize {
    let stack = Backtrace::force_capture().to_string();
    let is_numbered =
        |line: &&str| line.split_once(':').is_some_and(|(number, _)| number.trim().parse::<u32>().is_ok());
    stack.lines().filter(is_numbered).count()
}

macro_rules! counting_frames {
    ($name:ident, $($wrap:tt)*) => {
        /// Its value is the number of frames on the stack.
        struct $name;
        impl LaneDensity for $name {
            $($wrap)* {
                fn dim(&self) -> usize {
                    1
                }
                fn eval<V: Real, const GRAD: bool>(&self, x: &[V::Mem], _grad: &mut [V::Mem], _ws: &mut [V::Mem]) -> V {
                    V::load(&x[0]) + V::splat(stack_frames() as f64)
                }
            }
        }
    };
}

macro_rules! never_inlined {
    ($($function:item)*) => {
        $(#[inline(never)] $function)*
    };
}

counting_frames!(Inlined, inlined!);
counting_frames!(NotInlined, never_inlined!);

/// A function with a frame of its own is compiled for the baseline, whatever calls it.
#[test]
fn the_macro_inlines_a_density_into_its_instruction_set() {
    fn frames(leaf: impl LaneDensity) -> f64 {
        let mut grad = [Block::ZERO];
        Lanes { leaf, isa: Isa::best() }.log_density_grad_block(&[Block::ZERO], &mut grad, &mut []).0[0]
    }
    let (inlined, not) = (frames(Inlined), frames(NotInlined));
    assert!(inlined > 1.0 && not == inlined + 1.0, "{inlined} and {not} frames; is there debug information?");
}
