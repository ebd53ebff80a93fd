//! Laws of decoders and of densities seen through them, for random states on every instruction set.

use proptest::prelude::*;
use sinew_core::Error;
use sinew_core::beside::Beside;
use sinew_core::combinators::Through;
use sinew_core::decode::{Decode, Identity, Linear};
use sinew_core::density::{GaussNewton, GradLogDensity, Lanes, LogDensity, PartLogDensity};
use sinew_core::lanes::{Block, Isa, LANES, get_lane, set_lane, triangle};
use sinew_core::toy::{Quadratic, Sheet};
use std::sync::Arc;

/// A decoder with what must be written and no more, one state at a time, by a sheet.
struct Bare(Lanes<Sheet>);

impl Decode for Bare {
    fn source_dim(&self) -> usize {
        2
    }
    fn target_dim(&self) -> usize {
        4
    }
    fn decode(&self, x: &[f64], out: &mut [f64]) {
        self.0.decode(x, out);
    }
    fn pullback(&self, x: &[f64], grad_out: &[f64], grad: &mut [f64]) {
        self.0.pullback(x, grad_out, grad);
    }
    fn encode(&self, decoded: &[f64]) -> Option<Vec<f64>> {
        self.0.encode(decoded)
    }
}

/// A Gaussian of which each coordinate is a part.
struct Parts(Lanes<Quadratic>);

impl LogDensity for Parts {
    fn dim(&self) -> usize {
        self.0.dim()
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.0.log_density(x)
    }
}

impl PartLogDensity for Parts {
    fn parts(&self) -> usize {
        self.dim()
    }
    fn is_product(&self) -> bool {
        true
    }
    fn has_intermediates(&self) -> bool {
        true
    }
    fn log_intermediate_block(&self, part: usize, x: &[Block], ws: &mut [Block]) -> Block {
        let mut factors = vec![Block::ZERO; part + 1];
        self.log_density_parts_block(&(0..=part).collect::<Vec<_>>(), x, &mut factors, ws);
        Block(core::array::from_fn(|lane| factors.iter().map(|factor| factor.0[lane]).sum()))
    }
    fn log_density_part(&self, part: usize, x: &[f64]) -> f64 {
        let Quadratic { centre, precision } = &self.0.leaf;
        -0.5 * precision[part] * (x[part] - centre[part]).powi(2)
    }
}

const MATRIX: [f64; 20] =
    [1.0, 0.5, -0.25, 0.3, 0.0, 2.0, 0.7, -0.4, 0.1, 0.2, -1.5, 0.6, 0.9, -0.8, 0.4, 1.1, -0.3, 0.5, 0.8, -1.2];

/// 5 × 4.
fn linear(isa: Isa) -> Lanes<Linear> {
    Lanes { leaf: Linear::new(MATRIX.to_vec(), 4).expect("rows"), isa }
}

fn sheet(isa: Isa) -> Lanes<Sheet> {
    Lanes { leaf: Sheet { radius: 1.3, twist: 0.4 }, isa }
}

fn quadratic(dim: usize, isa: Isa) -> Lanes<Quadratic> {
    let centre = (0..dim).map(|j| 0.3 * j as f64 - 0.5).collect();
    Lanes { leaf: Quadratic { centre, precision: (1..=dim).map(|j| 1.5 / j as f64).collect() }, isa }
}

/// One free coordinate and two of a pose that pass; a sheet writes the others, in an order of its own.
fn beside(isa: Isa) -> Beside<Lanes<Sheet>> {
    Beside::new(1, sheet(isa), &[4, 0, 5, 2], 6).expect("fits")
}

/// Scratch that holds nothing useful.
fn scratch(blocks: usize) -> Vec<Block> {
    vec![Block::splat(f64::NAN); blocks]
}

fn blocks(states: &[Vec<f64>]) -> Vec<Block> {
    let mut block = vec![Block::ZERO; states[0].len()];
    states.iter().enumerate().for_each(|(lane, state)| set_lane(&mut block, lane, state));
    block
}

fn lane(block: &[Block], lane: usize) -> Vec<f64> {
    let mut state = vec![0.0; block.len()];
    get_lane(block, lane, &mut state);
    state
}

fn decoded(decoder: &dyn Decode, x: &[f64]) -> Vec<f64> {
    let mut out = vec![f64::NAN; decoder.target_dim()];
    decoder.decode(x, &mut out);
    out
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12 * b.abs().max(1.0)
}

/// J by central differences, row after row; exact to 1e-9 at these sizes.
fn slopes(decoder: &dyn Decode, x: &[f64]) -> Vec<f64> {
    let (m, n, h) = (decoder.target_dim(), x.len(), 1e-5);
    let mut jacobian = vec![0.0; m * n];
    for j in 0..n {
        let at = |by: f64| {
            let mut x = x.to_vec();
            x[j] += by;
            decoded(decoder, &x)
        };
        for (i, (above, below)) in at(h).into_iter().zip(at(-h)).enumerate() {
            jacobian[i * n + j] = (above - below) / (2.0 * h);
        }
    }
    jacobian
}

/// Lower triangle of Jᵀ H J.
fn congruent(jacobian: &[f64], h: &[f64], n: usize) -> Vec<f64> {
    let m = jacobian.len() / n;
    let entry = |a: usize, b: usize| {
        let term = |i: usize, k: usize| jacobian[i * n + a] * h[triangle(i.max(k), i.min(k))] * jacobian[k * n + b];
        (0..m).flat_map(|i| (0..m).map(move |k| (i, k))).map(|(i, k)| term(i, k)).sum::<f64>()
    };
    (0..n).flat_map(|a| (0..=a).map(move |b| (a, b))).map(|(a, b)| entry(a, b)).collect()
}

/// Laws 1 and 2 of decoders.
fn pullbacks_are_derivatives(decoder: &dyn Decode, states: &[Vec<f64>], grad: &[f64]) -> Result<(), TestCaseError> {
    let (m, n, x) = (decoder.target_dim(), decoder.source_dim(), blocks(states));
    let (mut out, mut pulled) = (scratch(m), scratch(n));
    decoder.decode_block(&x, &mut out, &mut scratch(decoder.workspace()));
    let grad_out: Vec<Block> = grad[..m].iter().map(|&g| Block::splat(g)).collect();
    decoder.pullback_block(&x, &grad_out, &mut pulled, &mut scratch(decoder.workspace()));
    let h: Vec<f64> = (0..triangle(m, 0)).map(|e| (1.7 * e as f64).sin()).collect();
    let mut matrix = scratch(triangle(n, 0));
    let given: Vec<Block> = h.iter().map(|&h| Block::splat(h)).collect();
    decoder.pullback_matrix_block(&x, &given, &mut matrix, &mut scratch(decoder.matrix_workspace()));
    for (l, state) in states.iter().enumerate() {
        let mut one = vec![f64::NAN; n];
        decoder.pullback(state, &grad[..m], &mut one);
        prop_assert!(decoded(decoder, state).iter().zip(lane(&out, l)).all(|(a, b)| near(*a, b)));
        prop_assert!(one.iter().zip(lane(&pulled, l)).all(|(a, b)| near(*a, b)));
        let jacobian = slopes(decoder, state);
        for (j, one) in one.iter().enumerate() {
            let expected: f64 = (0..m).map(|i| jacobian[i * n + j] * grad[i]).sum();
            prop_assert!((one - expected).abs() < 1e-7, "{one} against {expected}");
        }
        for (found, expected) in lane(&matrix, l).into_iter().zip(congruent(&jacobian, &h, n)) {
            prop_assert!((found - expected).abs() < 1e-6, "{found} against {expected}");
        }
    }
    Ok(())
}

/// The law of [`Through`]: value, gradient and both curvatures, of blocks and single states.
fn through_pulls_back(
    target: &dyn GaussNewton,
    decoder: &dyn Decode,
    states: &[Vec<f64>],
) -> Result<(), TestCaseError> {
    let through = Through { target, decoder };
    let (m, n, x) = (decoder.target_dim(), decoder.source_dim(), blocks(states));
    prop_assert_eq!(through.dim(), n);
    let mut ws = scratch(through.workspace());
    let mut grads = scratch(n);
    let values = through.log_density_block(&x, &mut ws);
    let again = through.log_density_grad_block(&x, &mut grads, &mut ws);
    let mut ws = scratch(through.matrix_workspace());
    let (mut matrix, mut weighted, mut diagonal) = (scratch(triangle(n, 0)), scratch(triangle(n, 0)), scratch(n));
    through.gauss_newton_block(&x, &mut matrix, &mut ws);
    through.weighted_gauss_newton_block(&x, &mut weighted, &mut ws);
    through.gauss_newton_diagonal_block(&x, &mut diagonal, &mut ws);
    for (l, state) in states.iter().enumerate() {
        let y = decoded(decoder, state);
        let (mut grad, mut target_grad) = (vec![f64::NAN; n], vec![f64::NAN; m]);
        let expected = target.log_density_grad(&y, &mut target_grad);
        let value = through.log_density_grad(state, &mut grad);
        for found in [value, through.log_density(state), values.0[l], again.0[l]] {
            prop_assert!(near(found, expected), "{found} against {expected}");
        }
        for (j, (one, many)) in grad.iter().zip(lane(&grads, l)).enumerate() {
            let at = |h: f64| {
                let mut x = state.clone();
                x[j] += h;
                through.log_density(&x)
            };
            let numeric = (at(1e-5) - at(-1e-5)) / 2e-5;
            prop_assert!((one - numeric).abs() < 1e-6 && near(*one, many), "{one} {numeric} {many}");
        }
        let mut h = scratch(triangle(m, 0));
        let at: Vec<Block> = y.iter().map(|&y| Block::splat(y)).collect();
        target.gauss_newton_block(&at, &mut h, &mut scratch(target.matrix_workspace()));
        let expected = congruent(&slopes(decoder, state), &lane(&h, l), n);
        let (found, weighted) = (lane(&matrix, l), lane(&weighted, l));
        for ((found, weighted), expected) in found.iter().zip(weighted).zip(expected) {
            prop_assert!((found - expected).abs() < 1e-6 && near(weighted, *found), "{found} against {expected}");
        }
        prop_assert!((0..n).all(|j| near(diagonal[j].0[l], found[triangle(j, j)])));
    }
    Ok(())
}

fn states(dim: usize) -> impl Strategy<Value = Vec<Vec<f64>>> {
    prop::collection::vec(prop::collection::vec(-2.0..2.0f64, dim), LANES)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn decoders_keep_their_laws(flat in states(2), wide in states(4), grad in prop::collection::vec(-3.0..3.0f64, 7), free in states(5)) {
        for isa in Isa::available() {
            pullbacks_are_derivatives(&sheet(isa), &flat, &grad)?;
            pullbacks_are_derivatives(&Bare(sheet(isa)), &flat, &grad)?;
            pullbacks_are_derivatives(&Arc::new(sheet(isa)), &flat, &grad)?;
            pullbacks_are_derivatives(&linear(isa), &wide, &grad)?;
            pullbacks_are_derivatives(&Identity(4), &wide, &grad)?;
            pullbacks_are_derivatives(&beside(isa), &free, &grad)?;
            pullbacks_are_derivatives(&Beside::whole(2, sheet(isa)).expect("fits"), &wide, &grad)?;
            pullbacks_are_derivatives(&Beside::whole(0, Bare(sheet(isa))).expect("fits"), &flat, &grad)?;
        }
    }

    #[test]
    fn encoding_leads_back(flat in states(2), wide in states(4), free in states(5)) {
        let isa = Isa::best();
        let (sheet, linear) = (sheet(isa), linear(isa));
        let beside = beside(isa);
        let ways: [(&dyn Decode, &[Vec<f64>]); 5] = [
            (&sheet, &flat),
            (&&Bare(sheet), &flat),
            (&linear, &wide),
            (&Arc::new(Identity(4)), &wide),
            (&beside, &free),
        ];
        for (decoder, states) in ways {
            for state in states {
                let encoded = decoder.encode(&decoded(decoder, state)).expect("reachable");
                prop_assert!(encoded.iter().zip(state).all(|(a, b)| (a - b).abs() < 1e-9), "{encoded:?} {state:?}");
            }
        }
    }

    #[test]
    fn through_keeps_its_law(flat in states(2), wide in states(4), free in states(5)) {
        for isa in Isa::available() {
            // A target whose curvature is no diagonal is itself one through a matrix.
            let full = Through { target: quadratic(5, isa), decoder: linear(isa) };
            through_pulls_back(&quadratic(5, isa), &linear(isa), &wide)?;
            through_pulls_back(&full, &sheet(isa), &flat)?;
            through_pulls_back(&full, &Bare(sheet(isa)), &flat)?;
            through_pulls_back(&full, &Identity(4), &wide)?;
            through_pulls_back(&quadratic(7, isa), &beside(isa), &free)?;
        }
    }
}

#[test]
fn coordinates_beside_a_decoder_pass() {
    let isa = Isa::best();
    let y = decoded(&sheet(isa), &[0.4, -0.7]);
    assert_eq!(decoded(&beside(isa), &[9.0, 0.4, -0.7, 8.0, 7.0]), [9.0, y[1], 8.0, y[3], 7.0, y[0], y[2]]);
    assert_eq!(beside(isa).latent(), 1..3);
    let identity = |coordinates: &[usize]| Beside::new(1, Identity(2), coordinates, 3).expect("fits");
    assert!(identity(&[0, 1]).is_coordinatewise() && !identity(&[1, 0]).is_coordinatewise());
    assert!(!beside(isa).is_coordinatewise());
    assert_eq!(beside(isa).encode(&[0.0; 7]).map(|x| x.len()), Some(5));
    assert_eq!(beside(isa).encode(&[1.0, 1.3, 0.0, 0.0, 0.0, 0.0, 0.5]), None, "on the axis of the sheet");
    let refused = |coordinates: &[usize]| Beside::new(1, sheet(isa), coordinates, 6).expect_err("does not fit");
    assert_eq!(refused(&[0, 1, 2]), Error::Dimension { name: "decoder", found: 4, expected: 3 });
    assert_eq!(refused(&[0, 1, 2, 6]), Error::IndexOutOfRange { index: 6, dim: 6 });
    assert_eq!(refused(&[0, 1, 2, 2]), Error::DuplicateIndex { index: 2 });
}

#[test]
fn parts_match_the_decoded_state() {
    let isa = Isa::best();
    let x = blocks(&vec![vec![0.4, -0.7]; LANES]);
    let through = Through { target: Parts(quadratic(4, isa)), decoder: sheet(isa) };
    let mut found = scratch(2);
    through.log_density_parts_block(&[1, 2], &x, &mut found, &mut scratch(through.workspace()));
    let y: Vec<Block> = decoded(&through.decoder, &[0.4, -0.7]).into_iter().map(Block::splat).collect();
    let mut expected = scratch(2);
    through.target.log_density_parts_block(&[1, 2], &y, &mut expected, &mut []);
    assert_eq!((through.parts(), found), (4, expected));
    assert!(through.has_intermediates());
    let found = through.log_intermediate_block(2, &x, &mut scratch(through.workspace()));
    assert_eq!(found, through.target.log_intermediate_block(2, &y, &mut []));
    let found = through.global_block(&x, &mut scratch(through.workspace()));
    assert_eq!(found, through.target.global_block(&y, &mut []));
    assert!(!through.is_product(), "a coordinate of the sheet moves several parts");
    assert!(Through { target: Parts(quadratic(4, isa)), decoder: Identity(4) }.is_product());
}

#[test]
fn what_has_no_sampled_state_is_said_or_approached() {
    let (sheet, linear) = (sheet(Isa::best()), linear(Isa::best()));
    assert_eq!(sheet.encode(&[0.0, 1.3, 0.5, 0.0]), None);
    assert_eq!(sheet.encode(&[0.1, f64::NAN, 0.5, 0.0]), None);
    assert_eq!(linear.encode(&[f64::NAN; 5]), None);
    // The least-squares solution leaves a residual on which every column stands upright.
    let y = [1.0, -2.0, 0.5, 3.0, 0.7];
    let residual: Vec<f64> =
        y.iter().zip(decoded(&linear, &linear.encode(&y).expect("finite"))).map(|(y, a)| y - a).collect();
    assert!(residual.iter().any(|r| r.abs() > 0.1));
    for j in 0..4 {
        let product: f64 = residual.iter().zip(MATRIX.chunks(4)).map(|(r, row)| r * row[j]).sum();
        assert!(product.abs() < 1e-12, "column {j}: {product}");
    }
    assert_eq!(Linear::new(vec![1.0; 7], 3), Err(Error::Rows { entries: 7, columns: 3 }));
    assert!(Linear::new(vec![], 3).is_err() && Linear::new(vec![1.0], 0).is_err());
}
