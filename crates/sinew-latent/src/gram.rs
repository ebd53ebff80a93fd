//! The matrix of covariances between all points, and what its gradient makes of theirs.
//!
//! Both work on some columns of the lower triangle, eight rows at once.

use crate::columns::Columns;
use crate::covariance::{Covariance, PARAMETERS};
use sinew_core::elementary::exp;
use sinew_core::lanes::{Block, Kernel, LANES, Real};

/// Writes columns `first`, `first + 1`, … of the radial basis functions and of the whole covariances, from the block of the diagonal down.
pub(crate) struct Fill<'a> {
    pub(crate) covariance: Covariance,
    pub(crate) x: &'a Columns,
    pub(crate) first: usize,
    pub(crate) radial: &'a mut [Block],
    pub(crate) gram: &'a mut [Block],
}

/// Squared distance and product of eight points and one.
#[inline(always)]
fn pair<V: Real<Mem = Block>>(x: &Columns, block: usize, one: usize) -> (V, V) {
    let (mut square, mut product) = (V::splat(0.0), V::splat(0.0));
    for k in 0..x.cols() {
        let eight = V::load(&x.column(k)[block]);
        let other = V::splat(x.column(k)[one / LANES].0[one % LANES]);
        let difference = eight - other;
        square = difference.fma(difference, square);
        product = eight.fma(other, product);
    }
    (square, product)
}

impl Kernel<Block> for Fill<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let Covariance { variance, inverse_width, linear, bias, .. } = self.covariance;
        let height = self.x.height();
        let columns = self.radial.chunks_exact_mut(height).zip(self.gram.chunks_exact_mut(height));
        for (j, (radial, gram)) in (self.first..).zip(columns) {
            for b in j / LANES..height {
                let (square, product) = pair::<V>(self.x, b, j);
                let r = exp(square * V::splat(-0.5 * inverse_width)) * V::splat(variance);
                r.store(&mut radial[b]);
                (product.fma(V::splat(linear), r) + V::splat(bias)).store(&mut gram[b]);
            }
        }
    }
}

/// Sums over some columns of the lower triangle, with G = dL/dK: of the parameters but white noise, and of the points.
///
/// `sums` are G∘R, G∘R∘D², G∘XXᵀ and G, R the radial part and D² the squared distances, entries off the diagonal counted twice; `rows` is dL/dX from the rows of these entries (q columns), `cols` the same from their
/// columns (q blocks a column, to be summed over lanes).
pub(crate) struct Gather<'a> {
    pub(crate) covariance: Covariance,
    pub(crate) x: &'a Columns,
    pub(crate) first: usize,
    pub(crate) radial: &'a [Block],
    /// −2 G / D, from the diagonal down; what is above it in its block does not count.
    pub(crate) slope: &'a [Block],
    /// −D / 2.
    pub(crate) factor: f64,
    pub(crate) sums: &'a mut [Block; PARAMETERS - 1],
    pub(crate) rows: &'a mut [Block],
    pub(crate) cols: &'a mut [Block],
}

/// Weight of the rows of a block for the column at this place in it: 0 above the diagonal, 1 on it, 2 below.
const WEIGHTS: [Block; LANES] = {
    let mut weights = [Block::splat(2.0); LANES];
    let mut place = 0;
    while place < LANES {
        let mut lane = 0;
        while lane < place {
            weights[place].0[lane] = 0.0;
            lane += 1;
        }
        weights[place].0[place] = 1.0;
        place += 1;
    }
    weights
};
const BELOW: Block = Block::splat(2.0);

impl Kernel<Block> for Gather<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let Covariance { inverse_width, linear, .. } = self.covariance;
        let (height, q) = (self.x.height(), self.x.cols());
        let mut sums = [V::splat(0.0); PARAMETERS - 1];
        let columns = self.radial.chunks_exact(height).zip(self.slope.chunks_exact(height));
        for ((j, (radial, slope)), cols) in (self.first..).zip(columns).zip(self.cols.chunks_exact_mut(q)) {
            for b in j / LANES..height {
                let weight = if b == j / LANES { &WEIGHTS[j % LANES] } else { &BELOW };
                let g = V::load(&slope[b]) * (V::load(weight) * V::splat(self.factor));
                let (square, product) = pair::<V>(self.x, b, j);
                let r = g * V::load(&radial[b]);
                sums[0] = sums[0] + r;
                sums[1] = r.fma(square, sums[1]);
                sums[2] = g.fma(product, sums[2]);
                sums[3] = sums[3] + g;
                let (pull, along) = (r * V::splat(-inverse_width), g * V::splat(linear));
                for (k, col) in cols.iter_mut().enumerate() {
                    let eight = V::load(&self.x.column(k)[b]);
                    let other = V::splat(self.x.column(k)[j / LANES].0[j % LANES]);
                    let pulled = pull * (eight - other);
                    let row = &mut self.rows[k * height + b];
                    (V::load(row) + along.fma(other, pulled)).store(row);
                    (V::load(col) + (along * eight - pulled)).store(col);
                }
            }
        }
        for (sum, total) in sums.iter().zip(self.sums.iter_mut()) {
            sum.store(total);
        }
    }
}
