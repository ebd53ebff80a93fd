//! Decoders: maps from a latent state, which is sampled, to the state that a density understands.
//!
//! Blocks of eight states are decoded at once. Trackers and densities see [`Decode`]. A numerical decoder is written once as a [`LaneDecode`] and becomes one through [`Lanes`]; [`Identity`] is pose space itself.
//!
//! # Laws
//! 1. `pullbacks_are_derivatives`: with J the derivative of [`Decode::decode_block`], [`Decode::pullback_block`] is Jᵀ g and [`Decode::pullback_matrix_block`] Jᵀ H J.
//! 2. Block and single state agree to `1e-12 · max(1, |y|)`; evaluation is pure.
//! 3. `encoding_leads_back`: of a decoded state [`Decode::encode`] gives a sampled state that decodes to it, to rounding; of a state that no sampled one decodes to, one that decodes nearby.
//! 4. What is written is overwritten; the content of a workspace before and after a call means nothing.

use crate::Error;
use crate::density::Lanes;
use crate::lanes::{
    Block, Isa, Kernel, LaneMap, Real, dispatch, each_lane, get_lane, map_block, map_one, splat, triangle,
};
use std::sync::Arc;

/// A differentiable map.
pub trait Decode: Sync {
    /// Dimension n of the sampled state.
    fn source_dim(&self) -> usize;

    /// Dimension m of the decoded state.
    fn target_dim(&self) -> usize;

    /// Blocks of scratch that [`Decode::decode_block`] and [`Decode::pullback_block`] need.
    fn workspace(&self) -> usize {
        0
    }

    /// Blocks of scratch that [`Decode::pullback_matrix_block`] needs, at least [`Decode::workspace`].
    fn matrix_workspace(&self) -> usize {
        self.target_dim() * (self.source_dim() + 1) + self.workspace()
    }

    /// Writes the decoded states (m blocks) of a block of sampled ones (n blocks). By default state after state.
    fn decode_block(&self, x: &[Block], out: &mut [Block], ws: &mut [Block]) {
        let _ = ws;
        each_lane(x, out, |x, out| self.decode(x, out));
    }

    /// Given gradients with respect to the decoded states (m blocks), writes those with respect to `x` (n blocks). By default state after state.
    fn pullback_block(&self, x: &[Block], grad_out: &[Block], grad: &mut [Block], ws: &mut [Block]) {
        let _ = ws;
        let mut lane = 0;
        let mut of_one = vec![0.0; grad_out.len()];
        each_lane(x, grad, |x, grad| {
            get_lane(grad_out, lane, &mut of_one);
            lane += 1;
            self.pullback(x, &of_one, grad);
        });
    }

    /// Given symmetric matrices H of the decoded states, writes Jᵀ H J: both lower triangles, row after row. By default J is made of one pullback a row.
    fn pullback_matrix_block(&self, x: &[Block], matrix_out: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
        let (m, n) = (self.target_dim(), self.source_dim());
        let (jacobian, ws) = ws.split_at_mut(m * n);
        let (unit, ws) = ws.split_at_mut(m);
        unit.fill(Block::ZERO);
        for (i, row) in jacobian.chunks_exact_mut(n).enumerate() {
            unit[i] = Block::splat(1.0);
            self.pullback_block(x, unit, row, ws);
            unit[i] = Block::ZERO;
        }
        dispatch(Isa::baseline(), Congruence { jacobian, matrix_out, column: unit, matrix });
    }

    /// Whether m = n and coordinate j of the decoded state depends on coordinate j of the sampled one alone. Then parts of the one are parts of the other, and diagonals of curvature stay diagonals.
    fn is_coordinatewise(&self) -> bool {
        false
    }

    /// The sampled state of a decoded one (length m), of those that exist; none where there is no such state.
    fn encode(&self, decoded: &[f64]) -> Option<Vec<f64>>;

    /// Writes the decoded state of one sampled state. By default a block of it: implement this method or [`Decode::decode_block`], since each falls back on the other.
    fn decode(&self, x: &[f64], out: &mut [f64]) {
        let mut decoded = vec![Block::ZERO; self.target_dim()];
        self.decode_block(&splat(x), &mut decoded, &mut vec![Block::ZERO; self.workspace()]);
        get_lane(&decoded, 0, out);
    }

    /// [`Decode::pullback_block`] of one state. By default a block of it: implement this method or that, since each falls back on the other.
    fn pullback(&self, x: &[f64], grad_out: &[f64], grad: &mut [f64]) {
        let mut pulled = vec![Block::ZERO; self.source_dim()];
        self.pullback_block(&splat(x), &splat(grad_out), &mut pulled, &mut vec![Block::ZERO; self.workspace()]);
        get_lane(&pulled, 0, grad);
    }
}

/// A numerical decoder, written once over the lane scalar. Write all methods but [`LaneDecode::encode`] within [`inlined!`](crate::inlined), or with `#[inline(always)]`.
pub trait LaneDecode: Sync {
    /// Dimension n of the sampled state.
    fn source_dim(&self) -> usize;

    /// Dimension m of the decoded state.
    fn target_dim(&self) -> usize;

    /// Length of the scratch that [`LaneDecode::decode`] and [`LaneDecode::pullback`] need.
    fn workspace(&self) -> usize {
        0
    }

    /// Writes the decoded state.
    fn decode<V: Real>(&self, x: &[V::Mem], out: &mut [V::Mem], ws: &mut [V::Mem]);

    /// Given the gradient with respect to the decoded state, writes the one with respect to `x`.
    fn pullback<V: Real>(&self, x: &[V::Mem], grad_out: &[V::Mem], grad: &mut [V::Mem], ws: &mut [V::Mem]);

    /// Writes the derivative, one row of n a decoded coordinate; `ws` has m entries more than the other methods need. By default one pullback a row.
    #[inline(always)]
    fn jacobian<V: Real>(&self, x: &[V::Mem], jacobian: &mut [V::Mem], ws: &mut [V::Mem]) {
        let (unit, ws) = ws.split_at_mut(self.target_dim());
        for u in unit.iter_mut() {
            V::splat(0.0).store(u);
        }
        for (i, row) in jacobian.chunks_exact_mut(self.source_dim()).enumerate() {
            V::splat(1.0).store(&mut unit[i]);
            self.pullback::<V>(x, unit, row, ws);
            V::splat(0.0).store(&mut unit[i]);
        }
    }

    /// See [`Decode::encode`]. Not a kernel.
    fn encode(&self, decoded: &[f64]) -> Option<Vec<f64>>;
}

/// Writes Jᵀ H J, a column after the other; `column` is scratch of m entries.
#[inline(always)]
fn congruence<V: Real>(jacobian: &[V::Mem], matrix_out: &[V::Mem], column: &mut [V::Mem], matrix: &mut [V::Mem]) {
    let m = column.len();
    let n = jacobian.len() / m;
    for b in 0..n {
        for i in 0..m {
            let mut sum = V::splat(0.0);
            for (k, row) in jacobian.chunks_exact(n).enumerate() {
                sum = V::load(&matrix_out[triangle(i.max(k), i.min(k))]).fma(V::load(&row[b]), sum);
            }
            sum.store(&mut column[i]);
        }
        for a in b..n {
            let mut sum = V::splat(0.0);
            for (row, entry) in jacobian.chunks_exact(n).zip(column.iter()) {
                sum = V::load(&row[a]).fma(V::load(entry), sum);
            }
            sum.store(&mut matrix[triangle(a, b)]);
        }
    }
}

struct Congruence<'a> {
    jacobian: &'a [Block],
    matrix_out: &'a [Block],
    column: &'a mut [Block],
    matrix: &'a mut [Block],
}

impl Kernel<Block> for Congruence<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        congruence::<V>(self.jacobian, self.matrix_out, self.column, self.matrix);
    }
}

struct Decoding<'a, T>(&'a T);

impl<T: LaneDecode> LaneMap<1, 1> for Decoding<'_, T> {
    #[inline(always)]
    fn run<V: Real>(&self, [x]: [&[V::Mem]; 1], [out]: [&mut [V::Mem]; 1], ws: &mut [V::Mem]) {
        self.0.decode::<V>(x, out, ws);
    }
}

struct Pulling<'a, T>(&'a T);

impl<T: LaneDecode> LaneMap<2, 1> for Pulling<'_, T> {
    #[inline(always)]
    fn run<V: Real>(&self, [x, grad_out]: [&[V::Mem]; 2], [grad]: [&mut [V::Mem]; 1], ws: &mut [V::Mem]) {
        self.0.pullback::<V>(x, grad_out, grad, ws);
    }
}

struct PullingMatrix<'a, T>(&'a T);

impl<T: LaneDecode> LaneMap<2, 1> for PullingMatrix<'_, T> {
    #[inline(always)]
    fn run<V: Real>(&self, [x, matrix_out]: [&[V::Mem]; 2], [matrix]: [&mut [V::Mem]; 1], ws: &mut [V::Mem]) {
        let m = self.0.target_dim();
        let (jacobian, ws) = ws.split_at_mut(m * self.0.source_dim());
        self.0.jacobian::<V>(x, jacobian, ws);
        congruence::<V>(jacobian, matrix_out, &mut ws[..m], matrix);
    }
}

impl<T: LaneDecode> Decode for Lanes<T> {
    fn source_dim(&self) -> usize {
        self.leaf.source_dim()
    }
    fn target_dim(&self) -> usize {
        self.leaf.target_dim()
    }
    fn workspace(&self) -> usize {
        self.leaf.workspace()
    }
    fn decode_block(&self, x: &[Block], out: &mut [Block], ws: &mut [Block]) {
        map_block(self.isa, &Decoding(&self.leaf), [x], [out], ws);
    }
    fn pullback_block(&self, x: &[Block], grad_out: &[Block], grad: &mut [Block], ws: &mut [Block]) {
        map_block(self.isa, &Pulling(&self.leaf), [x, grad_out], [grad], ws);
    }
    fn pullback_matrix_block(&self, x: &[Block], matrix_out: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
        map_block(self.isa, &PullingMatrix(&self.leaf), [x, matrix_out], [matrix], ws);
    }
    fn encode(&self, decoded: &[f64]) -> Option<Vec<f64>> {
        self.leaf.encode(decoded)
    }
    fn decode(&self, x: &[f64], out: &mut [f64]) {
        map_one(self.isa, &Decoding(&self.leaf), [x], [out], self.leaf.workspace());
    }
    fn pullback(&self, x: &[f64], grad_out: &[f64], grad: &mut [f64]) {
        map_one(self.isa, &Pulling(&self.leaf), [x, grad_out], [grad], self.leaf.workspace());
    }
}

macro_rules! forward_to_decoder {
    ($($wrapper:ty),*) => {$(
        impl<C: Decode + ?Sized> Decode for $wrapper where Self: Sync {
            fn source_dim(&self) -> usize {
                (**self).source_dim()
            }
            fn target_dim(&self) -> usize {
                (**self).target_dim()
            }
            fn workspace(&self) -> usize {
                (**self).workspace()
            }
            fn matrix_workspace(&self) -> usize {
                (**self).matrix_workspace()
            }
            fn decode_block(&self, x: &[Block], out: &mut [Block], ws: &mut [Block]) {
                (**self).decode_block(x, out, ws);
            }
            fn pullback_block(&self, x: &[Block], grad_out: &[Block], grad: &mut [Block], ws: &mut [Block]) {
                (**self).pullback_block(x, grad_out, grad, ws);
            }
            fn pullback_matrix_block(&self, x: &[Block], matrix_out: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
                (**self).pullback_matrix_block(x, matrix_out, matrix, ws);
            }
            fn is_coordinatewise(&self) -> bool {
                (**self).is_coordinatewise()
            }
            fn encode(&self, decoded: &[f64]) -> Option<Vec<f64>> {
                (**self).encode(decoded)
            }
            fn decode(&self, x: &[f64], out: &mut [f64]) {
                (**self).decode(x, out);
            }
            fn pullback(&self, x: &[f64], grad_out: &[f64], grad: &mut [f64]) {
                (**self).pullback(x, grad_out, grad);
            }
        }
    )*};
}
forward_to_decoder!(&C, Arc<C>);

/// Pose space itself: a state of this number of coordinates decodes to itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity(pub usize);

impl Decode for Identity {
    fn source_dim(&self) -> usize {
        self.0
    }
    fn target_dim(&self) -> usize {
        self.0
    }
    fn matrix_workspace(&self) -> usize {
        0
    }
    fn decode_block(&self, x: &[Block], out: &mut [Block], _ws: &mut [Block]) {
        out.copy_from_slice(x);
    }
    fn pullback_block(&self, _x: &[Block], grad_out: &[Block], grad: &mut [Block], _ws: &mut [Block]) {
        grad.copy_from_slice(grad_out);
    }
    fn pullback_matrix_block(&self, _x: &[Block], matrix_out: &[Block], matrix: &mut [Block], _ws: &mut [Block]) {
        matrix.copy_from_slice(matrix_out);
    }
    fn is_coordinatewise(&self) -> bool {
        true
    }
    fn encode(&self, decoded: &[f64]) -> Option<Vec<f64>> {
        Some(decoded.to_vec())
    }
    fn decode(&self, x: &[f64], out: &mut [f64]) {
        out.copy_from_slice(x);
    }
    fn pullback(&self, _x: &[f64], grad_out: &[f64], grad: &mut [f64]) {
        grad.copy_from_slice(grad_out);
    }
}

/// A linear decoder `y = A x`.
#[derive(Clone, Debug, PartialEq)]
pub struct Linear {
    matrix: Vec<f64>,
    source_dim: usize,
}

impl Linear {
    /// A with rows of `source_dim` entries, row after row.
    ///
    /// # Errors
    /// [`Error::Rows`] where the entries are no whole rows.
    pub fn new(matrix: Vec<f64>, source_dim: usize) -> Result<Self, Error> {
        if source_dim == 0 || matrix.is_empty() || !matrix.len().is_multiple_of(source_dim) {
            return Err(Error::Rows { entries: matrix.len(), columns: source_dim });
        }
        Ok(Self { matrix, source_dim })
    }

    fn rows(&self) -> impl Iterator<Item = &[f64]> {
        self.matrix.chunks_exact(self.source_dim)
    }
}

impl LaneDecode for Linear {
    fn source_dim(&self) -> usize {
        self.source_dim
    }
    fn target_dim(&self) -> usize {
        self.matrix.len() / self.source_dim
    }
    #[inline(always)]
    fn decode<V: Real>(&self, x: &[V::Mem], out: &mut [V::Mem], _ws: &mut [V::Mem]) {
        for (y, row) in out.iter_mut().zip(self.matrix.chunks_exact(self.source_dim)) {
            let mut sum = V::splat(0.0);
            for (&a, x) in row.iter().zip(x) {
                sum = V::load(x).fma(V::splat(a), sum);
            }
            sum.store(y);
        }
    }
    #[inline(always)]
    fn pullback<V: Real>(&self, _x: &[V::Mem], grad_out: &[V::Mem], grad: &mut [V::Mem], _ws: &mut [V::Mem]) {
        for (j, g) in grad.iter_mut().enumerate() {
            let mut sum = V::splat(0.0);
            for (row, o) in self.matrix.chunks_exact(self.source_dim).zip(grad_out) {
                sum = V::load(o).fma(V::splat(row[j]), sum);
            }
            sum.store(g);
        }
    }
    #[inline(always)]
    fn jacobian<V: Real>(&self, _x: &[V::Mem], jacobian: &mut [V::Mem], _ws: &mut [V::Mem]) {
        for (entry, &a) in jacobian.iter_mut().zip(&self.matrix) {
            V::splat(a).store(entry);
        }
    }

    /// The least-squares solution of smallest norm, by conjugate gradients on AᵀA x = Aᵀy.
    fn encode(&self, decoded: &[f64]) -> Option<Vec<f64>> {
        let square = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>();
        let transposed = |y: &[f64]| {
            let mut x = vec![0.0; self.source_dim];
            self.rows().zip(y).for_each(|(row, y)| x.iter_mut().zip(row).for_each(|(x, a)| *x += a * y));
            x
        };
        let (mut x, mut residual) = (vec![0.0; self.source_dim], decoded.to_vec());
        let mut force = transposed(&residual);
        let mut direction = force.clone();
        let (first, mut size) = (square(&force), square(&force));
        for _ in 0..4 * self.source_dim {
            let step: Vec<f64> = self.rows().map(|row| row.iter().zip(&direction).map(|(a, d)| a * d).sum()).collect();
            if size <= 1e-30 * first || square(&step) == 0.0 {
                break;
            }
            let length = size / square(&step);
            x.iter_mut().zip(&direction).for_each(|(x, d)| *x += length * d);
            residual.iter_mut().zip(&step).for_each(|(r, s)| *r -= length * s);
            force = transposed(&residual);
            let before = std::mem::replace(&mut size, square(&force));
            direction.iter_mut().zip(&force).for_each(|(d, f)| *d = f + size / before * *d);
        }
        x.iter().all(|x| x.is_finite()).then_some(x)
    }
}
