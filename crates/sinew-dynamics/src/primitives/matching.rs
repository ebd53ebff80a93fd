//! Which cluster a piece of motion belongs to: the one at the smallest Mahalanobis distance.
//!
//! The similarity of Husz, Wallace & Green (2007, eqs. 2–4) is sim_k(a) = exp(−Δᵀ Σ_k⁻¹ Δ), Δ = M_k − â, with â the scores of the action primitive a, without determinant or weight. What is compared here are the quadratic forms, so that it
//! works where all exponentials are 0. Of equal ones the first is taken.
//!
//! The action primitive of a state is that of D − 1 older estimates, equal for all states, and the state's own feature vector as the newest.

use crate::Error;
use crate::factor::{cholesky, inverse_lower};
use crate::pca::Pca;
use crate::primitives::model::{Cluster, Primitives};
use sinew_core::lanes::{Block, Isa, Kernel, LANES, Real, dispatch};

/// The clusters of one feature vector, ready to be matched.
#[derive(Clone, Debug)]
pub struct Matcher {
    pca: Pca,
    features: usize,
    /// For each cluster M_k, then the rows of L⁻¹ up to their diagonal, Σ_k = L Lᵀ.
    tables: Vec<f64>,
    isa: Isa,
}

impl Matcher {
    /// Factors the covariances.
    ///
    /// # Errors
    /// [`Error::Shape`] without clusters or components, and as [`cholesky`].
    pub fn new(primitives: &Primitives, isa: Isa) -> Result<Self, Error> {
        let Primitives { feature, pca, clusters, .. } = primitives;
        let (q, features) = (pca.len(), feature.coordinates.len());
        if clusters.is_empty() || pca.is_empty() || features == 0 {
            return Err(Error::Shape { name: "clusters", found: 0, expected: 1 });
        }
        let mut tables = Vec::with_capacity(clusters.len() * table(q));
        for Cluster { past, .. } in clusters {
            if past.mean.len() != q {
                return Err(Error::Shape { name: "mean of a cluster", found: past.mean.len(), expected: q });
            }
            let inverse = inverse_lower(&cholesky("covariance of a cluster", &past.covariance, q)?.lower, q);
            tables.extend_from_slice(&past.mean);
            (0..q).for_each(|i| tables.extend_from_slice(&inverse[i * q..=i * (q + 1)]));
        }
        Ok(Self { pca: pca.clone(), features, tables, isa })
    }

    /// Numbers of the older feature vectors: (D − 1) F.
    #[must_use]
    pub fn older_len(&self) -> usize {
        self.pca.mean.len() - self.features
    }

    /// The cluster of each lane; `older` are the D − 1 feature vectors before, the oldest first, `own` the newest of each lane, F blocks.
    #[must_use]
    pub fn nearest_block(&self, older: &[f64], own: &[Block]) -> [usize; LANES] {
        let q = self.pca.len();
        let mut base = vec![0.0; q];
        let (past, newest) = self.pca.mean.split_at(self.older_len());
        for (base, row) in base.iter_mut().zip(self.pca.components.chunks_exact(self.pca.mean.len())) {
            *base = row.iter().zip(older.iter().zip(past)).map(|(u, (x, m))| u * (x - m)).sum();
        }
        let (mut ws, mut best) = (vec![Block::ZERO; q], Block::ZERO);
        dispatch(self.isa, Nearest { matcher: self, base: &base, newest, own, ws: &mut ws, best: &mut best });
        core::array::from_fn(|lane| best.0[lane] as usize)
    }
}

/// Length of the table of one cluster.
const fn table(q: usize) -> usize {
    q + q * (q + 1) / 2
}

struct Nearest<'a> {
    matcher: &'a Matcher,
    /// Scores of the older feature vectors.
    base: &'a [f64],
    /// Mean of the newest.
    newest: &'a [f64],
    own: &'a [Block],
    ws: &'a mut [Block],
    best: &'a mut Block,
}

impl Kernel<Block> for Nearest<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let pca = &self.matcher.pca;
        let (d, q) = (pca.mean.len(), self.base.len());
        let newest = d - self.newest.len();
        for ((&base, row), slot) in self.base.iter().zip(pca.components.chunks_exact(d)).zip(&mut *self.ws) {
            let mut score = V::splat(base);
            for ((own, &mean), &u) in self.own.iter().zip(self.newest).zip(&row[newest..]) {
                score = (V::load(own) - V::splat(mean)).fma(V::splat(u), score);
            }
            score.store(slot);
        }
        let (mut best, mut least, mut number) = (V::splat(0.0), V::splat(f64::INFINITY), 0.0);
        for cluster in self.matcher.tables.chunks_exact(table(q)) {
            let (mean, mut rows) = cluster.split_at(q);
            let mut square = V::splat(0.0);
            for i in 0..q {
                let (row, after) = rows.split_at(i + 1);
                rows = after;
                let mut sum = V::splat(0.0);
                for ((score, &mean), &w) in self.ws.iter().zip(mean).zip(row) {
                    sum = (V::load(score) - V::splat(mean)).fma(V::splat(w), sum);
                }
                square = sum.fma(sum, square);
            }
            let gain = least - square;
            best = gain.select_gt(0.0, V::splat(number), best);
            least = gain.select_gt(0.0, square, least);
            number += 1.0;
        }
        best.store(self.best);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives::made_up::primitives;
    use faer::linalg::solvers::Solve;
    use faer::{Mat, MatRef};

    /// Matching of primitives (M3): the smallest Mahalanobis distance by a solver that shares nothing with the tables, on every instruction set.
    #[test]
    fn the_nearest_cluster_has_the_smallest_mahalanobis_distance() {
        let learned = primitives();
        let features = learned.feature.coordinates.len();
        let past = learned.pca.mean.len() - features;
        let mut seen = std::collections::BTreeSet::new();
        // Near the clusters, and so far that all exponentials are 0.
        for (round, scale) in [0.5, 1.0, 1.0, 2.0, 100.0, 1e5].into_iter().enumerate() {
            let number = |i: usize| scale * (12.9898 * (i + 97 * round + 1) as f64).sin();
            let older: Vec<f64> = (0..past).map(number).collect();
            let own: Vec<Block> =
                (0..features).map(|j| Block(core::array::from_fn(|lane| number(1000 + 8 * j + lane)))).collect();
            for isa in Isa::available() {
                let found = Matcher::new(&learned, isa).expect("valid").nearest_block(&older, &own);
                for (lane, found) in found.into_iter().enumerate() {
                    let row = [&older[..], &own.iter().map(|b| b.0[lane]).collect::<Vec<_>>()].concat();
                    let scores = learned.pca.project(&row);
                    let q = scores.len();
                    let distance = |c: &Cluster| -> f64 {
                        let delta = Mat::from_fn(q, 1, |i, _| scores[i] - c.past.mean[i]);
                        let solved = MatRef::from_row_major_slice(&c.past.covariance, q, q).full_piv_lu().solve(&delta);
                        (delta.transpose() * solved)[(0, 0)]
                    };
                    let distances: Vec<f64> = learned.clusters.iter().map(distance).collect();
                    let least = distances.iter().copied().fold(f64::INFINITY, f64::min);
                    let (first, second) = (distances[found], least);
                    assert!(first <= second * (1.0 + 1e-9), "{isa:?}: {found} at {first}, nearest {second}");
                    let similarities: Vec<f64> = distances.iter().map(|d| (-d).exp()).collect();
                    let alike = similarities.iter().copied().fold(0.0, f64::max);
                    assert!(similarities[found] >= alike * (1.0 - 1e-9));
                    assert_eq!(alike == 0.0, scale > 50.0, "{alike} at {scale}");
                    seen.insert(found);
                }
            }
        }
        assert!(seen.len() > 3, "only {seen:?} were nearest to anything");
    }

    #[test]
    fn the_first_of_equal_clusters_is_taken() {
        let mut learned = primitives();
        let first = learned.clusters[0].clone();
        learned.clusters = vec![first; 3];
        let matcher = Matcher::new(&learned, Isa::best()).expect("valid");
        let own = vec![Block::splat(0.3); learned.feature.coordinates.len()];
        assert_eq!(matcher.nearest_block(&vec![0.1; matcher.older_len()], &own), [0; LANES]);
        learned.clusters.clear();
        assert!(Matcher::new(&learned, Isa::best()).is_err());
    }
}
