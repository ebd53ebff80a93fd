//! Products of a scalar triangular matrix with lanes.

use sinew_core::lanes::{Block, Real};

/// Σ a_i x_i over the length of `a`, in four sums side by side, so that none waits for the one before.
#[inline(always)]
pub(crate) fn dot<V: Real<Mem = Block>>(a: &[f64], x: &[Block]) -> V {
    let x = &x[..a.len()];
    let (mut s0, mut s1, mut s2, mut s3) = (V::splat(0.0), V::splat(0.0), V::splat(0.0), V::splat(0.0));
    let (mut a4, mut x4) = (a.chunks_exact(4), x.chunks_exact(4));
    for (a, x) in a4.by_ref().zip(x4.by_ref()) {
        s0 = V::splat(a[0]).fma(V::load(&x[0]), s0);
        s1 = V::splat(a[1]).fma(V::load(&x[1]), s1);
        s2 = V::splat(a[2]).fma(V::load(&x[2]), s2);
        s3 = V::splat(a[3]).fma(V::load(&x[3]), s3);
    }
    for (&a, x) in a4.remainder().iter().zip(x4.remainder()) {
        s0 = V::splat(a).fma(V::load(x), s0);
    }
    (s0 + s1) + (s2 + s3)
}
