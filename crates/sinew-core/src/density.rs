//! Log densities on a flat state, of one state or of a block of eight.
//!
//! [`LogDensity`] ⊂ [`GradLogDensity`] ⊂ [`GaussNewton`]: a function asks for the least that it needs, and the compiler says which target offers it.
//! A numerical leaf is written once as a [`LaneDensity`] and becomes all of these through the wrapper [`Lanes`].
//!
//! # Laws
//! 1. The value is finite or −∞, never NaN or +∞.
//! 2. Evaluation is pure: the same state gives the same bits.
//! 3. Block and single state agree to `1e-12 · max(1, |log p|)`.
//! 4. A gradient is overwritten, never added to; where the value is −∞ its content is unspecified.
//! 5. The content of a workspace before and after a call means nothing.

use crate::lanes::{Block, Isa, LaneMap, Real, each_lane, get_lane, map_block, map_one, splat, triangle};

/// A log density on ℝᵈ, up to a constant that does not depend on the state.
pub trait LogDensity: Sync {
    /// Dimension d of the state.
    fn dim(&self) -> usize;

    /// Blocks of scratch that the block methods need.
    fn workspace(&self) -> usize {
        0
    }

    /// Log density of one state of length d.
    fn log_density(&self, x: &[f64]) -> f64;

    /// Log densities of a block of states, `x` = d blocks, `ws` ≥ [`LogDensity::workspace`] blocks.
    fn log_density_block(&self, x: &[Block], ws: &mut [Block]) -> Block {
        let _ = ws;
        let mut out = [Block::ZERO];
        each_lane(x, &mut out, |x, out| out[0] = self.log_density(x));
        out[0]
    }
}

/// A log density with its gradient.
pub trait GradLogDensity: LogDensity {
    /// Log density of one state; its gradient is written to `grad` (length d).
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64;

    /// Log densities of a block; gradients are written to `grad` (d blocks).
    fn log_density_grad_block(&self, x: &[Block], grad: &mut [Block], ws: &mut [Block]) -> Block {
        let _ = ws;
        let mut out = Block::ZERO;
        let mut lane = 0;
        each_lane(x, grad, |x, grad| {
            out.0[lane] = self.log_density_grad(x, grad);
            lane += 1;
        });
        out
    }
}

/// A log density that knows its Gauss–Newton curvature `Jᵀ W J ≈ −∂² log p`, a positive semi-definite matrix.
pub trait GaussNewton: GradLogDensity {
    /// Blocks of scratch that the methods of this trait need, at least [`LogDensity::workspace`].
    fn matrix_workspace(&self) -> usize {
        self.workspace()
    }

    /// Writes the diagonal of one state to `diagonal` (length d). By default a block of it: implement this method or [`GaussNewton::gauss_newton_diagonal_block`], since each falls back on the other.
    fn gauss_newton_diagonal(&self, x: &[f64], diagonal: &mut [f64]) {
        let mut out = vec![Block::ZERO; self.dim()];
        self.gauss_newton_diagonal_block(&splat(x), &mut out, &mut vec![Block::ZERO; self.matrix_workspace()]);
        get_lane(&out, 0, diagonal);
    }

    /// Writes the diagonals for a block of states to `diagonal` (d blocks). By default state after state.
    fn gauss_newton_diagonal_block(&self, x: &[Block], diagonal: &mut [Block], ws: &mut [Block]) {
        let _ = ws;
        each_lane(x, diagonal, |x, diagonal| self.gauss_newton_diagonal(x, diagonal));
    }

    /// Writes the matrices for a block of states to `matrix`: lower triangle, row after row, d (d + 1) / 2 blocks. By default only their diagonals.
    fn gauss_newton_block(&self, x: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
        let mut diagonal = vec![Block::ZERO; self.dim()];
        self.gauss_newton_diagonal_block(x, &mut diagonal, ws);
        matrix.fill(Block::ZERO);
        for (j, entry) in diagonal.into_iter().enumerate() {
            matrix[triangle(j, j)] = entry;
        }
    }

    /// The same matrices with every observation weighted as its density weighs it at `x`, so that what counts as an outlier there adds nothing. Else each counts in full: an upper bound, safe far from the mode, and what this method gives by default.
    fn weighted_gauss_newton_block(&self, x: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
        self.gauss_newton_block(x, matrix, ws);
    }

    /// The same observation with its errors `factor` times as large, for a search that would not reach the mode of a robust density from afar. `None` by default, also from combinators.
    fn broadened(&self, factor: f64) -> Option<Box<dyn GaussNewton + '_>> {
        let _ = factor;
        None
    }
}

/// A log density that also says how well each part of what was observed is explained, for trackers that search a state part by part. Part k of the density is part k of the tracker's [`crate::part::PartTree`].
pub trait PartLogDensity: LogDensity {
    /// Number of parts K.
    fn parts(&self) -> usize;

    /// Whether the log density is the sum of its parts and part k depends on no coordinates beyond the parts up to k.
    fn is_product(&self) -> bool {
        false
    }

    /// Whether parts are better chosen by [`PartLogDensity::log_intermediate_block`] than by their own values, which may say little of a part alone or name a wrong place.
    fn has_intermediates(&self) -> bool {
        false
    }

    /// Log of an intermediate density for a block of states whose parts up to `part` are in place and whose later parts are still where they were: any function that is positive where the density is. By default the whole density.
    fn log_intermediate_block(&self, part: usize, x: &[Block], ws: &mut [Block]) -> Block {
        let _ = part;
        self.log_density_block(x, ws)
    }

    /// What searches compare whole states by that were put together from parts ([`Global`]). By default the density, of which every state meets something.
    fn global_block(&self, x: &[Block], ws: &mut [Block]) -> Global {
        Global { log_likelihood: self.log_density_block(x, ws), met: Block::splat(1.0) }
    }

    /// Log likelihood of one part at one state. By default a block of it: implement this method or [`PartLogDensity::log_density_parts_block`], since each falls back on the other.
    fn log_density_part(&self, part: usize, x: &[f64]) -> f64 {
        let mut out = [Block::ZERO];
        self.log_density_parts_block(&[part], &splat(x), &mut out, &mut vec![Block::ZERO; self.workspace()]);
        out[0].0[0]
    }

    /// Writes the log likelihoods of some parts for a block of states: one block a part to `out`, in their order; `ws` ≥ [`LogDensity::workspace`] blocks. A part's value may depend on the whole state. By default part after
    /// part and state after state.
    fn log_density_parts_block(&self, parts: &[usize], x: &[Block], out: &mut [Block], ws: &mut [Block]) {
        let _ = ws;
        each_lane(x, out, |x, out| {
            for (out, &part) in out.iter_mut().zip(parts) {
                *out = self.log_density_part(part, x);
            }
        });
    }
}

/// How well a block of whole states explains what was observed, compared with each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Global {
    /// Log likelihoods.
    pub log_likelihood: Block,
    /// In how many observations, such as views, each state meets anything of what was seen. A likelihood may be largest for states that meet nothing; those that meet the most are to be preferred.
    pub met: Block,
}

/// A numerical leaf, written once over the lane scalar. Write all methods within [`inlined!`](crate::inlined), or with `#[inline(always)]`: without it blocks take some 25 times as long (AVX2, `cargo bench -p sinew-core --bench inlining`). Those that
/// [`compile_density_here!`](crate::compile_density_here) writes stay outside.
pub trait LaneDensity: Sync {
    /// Dimension d of the state.
    fn dim(&self) -> usize;

    /// Length of the scratch that [`LaneDensity::eval`] needs.
    fn workspace(&self) -> usize {
        0
    }

    /// Log density at `x`; with `GRAD` the gradient is written to `grad` (else `grad` is not touched).
    fn eval<V: Real, const GRAD: bool>(&self, x: &[V::Mem], grad: &mut [V::Mem], ws: &mut [V::Mem]) -> V;

    /// [`LaneDensity::eval`] of a block on an instruction set, with gradient if it is wanted.
    fn eval_block(&self, isa: Isa, x: &[Block], grad: Option<&mut [Block]>, ws: &mut [Block]) -> Block
    where
        Self: Sized,
    {
        run_block(self, isa, x, grad, ws)
    }

    /// The same of one state.
    fn eval_one(&self, isa: Isa, x: &[f64], grad: Option<&mut [f64]>) -> f64
    where
        Self: Sized,
    {
        run_one(self, isa, x, grad)
    }
}

/// Which part of a curvature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curvature {
    /// [`GaussNewton::gauss_newton_diagonal_block`].
    Diagonal,
    /// [`GaussNewton::gauss_newton_block`].
    Matrix,
    /// [`GaussNewton::weighted_gauss_newton_block`].
    Weighted,
}

/// A [`LaneDensity`] with Gauss–Newton curvature.
pub trait LaneGaussNewton: LaneDensity {
    /// Writes the diagonal of the Gauss–Newton matrix at `x`.
    fn gauss_newton_diagonal<V: Real>(&self, x: &[V::Mem], diagonal: &mut [V::Mem], ws: &mut [V::Mem]);

    /// Writes the lower triangle of the Gauss–Newton matrix at `x`, row after row. By default only its diagonal.
    #[inline(always)]
    fn gauss_newton<V: Real>(&self, x: &[V::Mem], matrix: &mut [V::Mem], ws: &mut [V::Mem]) {
        let d = self.dim();
        self.gauss_newton_diagonal::<V>(x, &mut matrix[..d], ws);
        // From the last row up, no entry is overwritten before it has moved.
        for i in (0..d).rev() {
            let entry = V::load(&matrix[i]);
            for off_diagonal in &mut matrix[triangle(i, 0)..triangle(i, i)] {
                V::splat(0.0).store(off_diagonal);
            }
            entry.store(&mut matrix[triangle(i, i)]);
        }
    }

    /// See [`GaussNewton::weighted_gauss_newton_block`].
    #[inline(always)]
    fn weighted_gauss_newton<V: Real>(&self, x: &[V::Mem], matrix: &mut [V::Mem], ws: &mut [V::Mem]) {
        self.gauss_newton::<V>(x, matrix, ws);
    }

    /// See [`GaussNewton::broadened`]. Not a kernel.
    fn broadened(&self, factor: f64) -> Option<Self>
    where
        Self: Sized,
    {
        let _ = factor;
        None
    }

    /// One of the three of a block, on an instruction set.
    fn curvature_block(&self, isa: Isa, which: Curvature, x: &[Block], out: &mut [Block], ws: &mut [Block])
    where
        Self: Sized,
    {
        run_curvature(self, isa, which, x, out, ws);
    }
}

/// A leaf together with the instruction set that runs it: an object-safe density.
#[derive(Clone, Copy, Debug)]
pub struct Lanes<T> {
    /// The leaf.
    pub leaf: T,
    /// The instruction set.
    pub isa: Isa,
}

struct Eval<'a, T, const GRAD: bool>(&'a T);

impl<T: LaneDensity, const GRAD: bool> LaneMap<1, 2> for Eval<'_, T, GRAD> {
    #[inline(always)]
    fn run<V: Real>(&self, [x]: [&[V::Mem]; 1], [grad, value]: [&mut [V::Mem]; 2], ws: &mut [V::Mem]) {
        self.0.eval::<V, GRAD>(x, grad, ws).store(&mut value[0]);
    }
}

struct Diagonal<'a, T>(&'a T);

impl<T: LaneGaussNewton> LaneMap<1, 1> for Diagonal<'_, T> {
    #[inline(always)]
    fn run<V: Real>(&self, [x]: [&[V::Mem]; 1], [diagonal]: [&mut [V::Mem]; 1], ws: &mut [V::Mem]) {
        self.0.gauss_newton_diagonal::<V>(x, diagonal, ws);
    }
}

struct Matrix<'a, T, const WEIGHTED: bool>(&'a T);

impl<T: LaneGaussNewton, const WEIGHTED: bool> LaneMap<1, 1> for Matrix<'_, T, WEIGHTED> {
    #[inline(always)]
    fn run<V: Real>(&self, [x]: [&[V::Mem]; 1], [matrix]: [&mut [V::Mem]; 1], ws: &mut [V::Mem]) {
        if WEIGHTED {
            self.0.weighted_gauss_newton::<V>(x, matrix, ws);
        } else {
            self.0.gauss_newton::<V>(x, matrix, ws);
        }
    }
}

/// [`LaneDensity::eval_block`].
pub fn run_block<T: LaneDensity>(
    leaf: &T,
    isa: Isa,
    x: &[Block],
    grad: Option<&mut [Block]>,
    ws: &mut [Block],
) -> Block {
    let mut value = [Block::ZERO];
    match grad {
        Some(grad) => map_block(isa, &Eval::<_, true>(leaf), [x], [grad, &mut value], ws),
        None => map_block(isa, &Eval::<_, false>(leaf), [x], [&mut [], &mut value], ws),
    }
    value[0]
}

/// [`LaneDensity::eval_one`].
pub fn run_one<T: LaneDensity>(leaf: &T, isa: Isa, x: &[f64], grad: Option<&mut [f64]>) -> f64 {
    let mut value = [0.0];
    match grad {
        Some(grad) => map_one(isa, &Eval::<_, true>(leaf), [x], [grad, &mut value], leaf.workspace()),
        None => map_one(isa, &Eval::<_, false>(leaf), [x], [&mut [], &mut value], leaf.workspace()),
    }
    value[0]
}

/// [`LaneGaussNewton::curvature_block`].
pub fn run_curvature<T: LaneGaussNewton>(
    leaf: &T,
    isa: Isa,
    which: Curvature,
    x: &[Block],
    out: &mut [Block],
    ws: &mut [Block],
) {
    match which {
        Curvature::Diagonal => map_block(isa, &Diagonal(leaf), [x], [out], ws),
        Curvature::Matrix => map_block(isa, &Matrix::<_, false>(leaf), [x], [out], ws),
        Curvature::Weighted => map_block(isa, &Matrix::<_, true>(leaf), [x], [out], ws),
    }
}

impl<T: LaneDensity> LogDensity for Lanes<T> {
    fn dim(&self) -> usize {
        self.leaf.dim()
    }
    fn workspace(&self) -> usize {
        self.leaf.workspace()
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.leaf.eval_one(self.isa, x, None)
    }
    fn log_density_block(&self, x: &[Block], ws: &mut [Block]) -> Block {
        self.leaf.eval_block(self.isa, x, None, ws)
    }
}

impl<T: LaneDensity> GradLogDensity for Lanes<T> {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        self.leaf.eval_one(self.isa, x, Some(grad))
    }
    fn log_density_grad_block(&self, x: &[Block], grad: &mut [Block], ws: &mut [Block]) -> Block {
        self.leaf.eval_block(self.isa, x, Some(grad), ws)
    }
}

impl<T: LaneGaussNewton> GaussNewton for Lanes<T> {
    fn gauss_newton_diagonal_block(&self, x: &[Block], diagonal: &mut [Block], ws: &mut [Block]) {
        self.leaf.curvature_block(self.isa, Curvature::Diagonal, x, diagonal, ws);
    }
    fn gauss_newton_block(&self, x: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
        self.leaf.curvature_block(self.isa, Curvature::Matrix, x, matrix, ws);
    }
    fn weighted_gauss_newton_block(&self, x: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
        self.leaf.curvature_block(self.isa, Curvature::Weighted, x, matrix, ws);
    }
    fn broadened(&self, factor: f64) -> Option<Box<dyn GaussNewton + '_>> {
        let leaf = self.leaf.broadened(factor)?;
        Some(Box::new(Lanes { leaf, isa: self.isa }))
    }
}
