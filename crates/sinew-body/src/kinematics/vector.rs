//! Vectors of three lanes.

use sinew_core::lanes::Real;

/// Vector of three lanes.
pub type V3<V> = [V; 3];

/// Componentwise `[e(0), e(1), e(2)]`, spelled out so that nothing is outlined.
macro_rules! v3 {
    ($k:ident => $e:expr) => {
        [
            {
                const $k: usize = 0;
                $e
            },
            {
                const $k: usize = 1;
                $e
            },
            {
                const $k: usize = 2;
                $e
            },
        ]
    };
}
pub(super) use v3;

#[inline(always)]
pub(super) fn dot<V: Real>(a: V3<V>, b: V3<V>) -> V {
    a[2].fma(b[2], a[1].fma(b[1], a[0] * b[0]))
}

/// `c + a × b`.
#[inline(always)]
pub(super) fn cross_add<V: Real>(a: V3<V>, b: V3<V>, c: V3<V>) -> V3<V> {
    [
        a[2].fnma(b[1], a[1].fma(b[2], c[0])),
        a[0].fnma(b[2], a[2].fma(b[0], c[1])),
        a[1].fnma(b[0], a[0].fma(b[1], c[2])),
    ]
}

/// `c − a × b`.
#[inline(always)]
pub(super) fn cross_sub<V: Real>(a: V3<V>, b: V3<V>, c: V3<V>) -> V3<V> {
    [
        a[2].fma(b[1], a[1].fnma(b[2], c[0])),
        a[0].fma(b[2], a[2].fnma(b[0], c[1])),
        a[1].fma(b[0], a[0].fnma(b[1], c[2])),
    ]
}

#[inline(always)]
pub(super) fn load3<V: Real>(m: &[V::Mem; 3]) -> V3<V> {
    [V::load(&m[0]), V::load(&m[1]), V::load(&m[2])]
}

#[inline(always)]
pub(super) fn store3<V: Real>(v: V3<V>, m: &mut [V::Mem; 3]) {
    v[0].store(&mut m[0]);
    v[1].store(&mut m[1]);
    v[2].store(&mut m[2]);
}

/// `p + cx·o₀ + cy·o₁ + cz·o₂`, skipping zero components.
#[inline(always)]
pub(super) fn moved<V: Real>(p: V3<V>, columns: [V3<V>; 3], offset: &[f64; 3]) -> V3<V> {
    let mut p = p;
    for (column, &x) in columns.into_iter().zip(offset) {
        if x != 0.0 {
            let x = V::splat(x);
            p = v3!(K => x.fma(column[K], p[K]));
        }
    }
    p
}

/// The two columns after a rotation by the angle of (s, c) that carries `a` towards `b`.
#[inline(always)]
pub(super) fn turned<V: Real>(a: V3<V>, b: V3<V>, s: V, c: V) -> (V3<V>, V3<V>) {
    (v3!(K => s.fma(b[K], c * a[K])), v3!(K => s.fnma(a[K], c * b[K])))
}

/// `cx·a₀ + cy·a₁ + cz·a₂`.
#[inline(always)]
pub(super) fn along<V: Real>(a: [f64; 3], [cx, cy, cz]: [V3<V>; 3]) -> V3<V> {
    let [x, y, z] = a.map(V::splat);
    v3!(K => z.fma(cz[K], y.fma(cy[K], x * cx[K])))
}

/// The columns of a frame after a rotation by the angle of (s, c) about its own unit vector `a`, which is `u` in the world:
/// `cos·c_k + (1 − cos) a_k u + sin·(u × c_k)`, where `u × cx = a₂ cy − a₁ cz` and so on around.
#[inline(always)]
pub(super) fn turned_about<V: Real>(a: [f64; 3], u: V3<V>, [cx, cy, cz]: [V3<V>; 3], s: V, c: V) -> [V3<V>; 3] {
    let [x, y, z] = a.map(V::splat);
    let t = V::splat(1.0) - c;
    let [tx, ty, tz] = [t * x, t * y, t * z];
    let [sx, sy, sz] = [s * x, s * y, s * z];
    [
        v3!(K => sy.fnma(cz[K], sz.fma(cy[K], tx.fma(u[K], c * cx[K])))),
        v3!(K => sz.fnma(cx[K], sx.fma(cz[K], ty.fma(u[K], c * cy[K])))),
        v3!(K => sx.fnma(cy[K], sy.fma(cx[K], tz.fma(u[K], c * cz[K])))),
    ]
}
