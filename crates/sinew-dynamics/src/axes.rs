//! The covariance of a filter's draws, along the axes that a linearised filter has.
//!
//! n draws have correlations of some 1/√n that their distribution has not. A direction that nothing sees is as wide as chance has made it by then, its mean wanders as far, and through such correlations a backward pass carries that into
//! what is seen. The covariance P of the filter that is linearised at the estimates ([`crate::linearised_filter`]) has none of it, but does not know what else is in a prior or a likelihood. So axes are
//! taken from P, and variances along them from the covariance C of the draws. With the covariance Q of a step,
//!
//! ```text
//! Q^(−½) P Q^(−½) = U D Uᵀ        Q^½ U diag(Uᵀ Q^(−½) C Q^(−½) U) Uᵀ Q^½
//! ```
//!
//! These are the axes along which the gain P (P + Q)⁻¹ of a random walk is diagonal.

use crate::Error;
use crate::lasting::rows;
use crate::linear_motion::to_rows;
use faer::{Mat, Side};

/// C along the axes of P, both d × d, row after row; `step` are the variances of a step, above 0.
///
/// # Errors
/// [`Error::Shape`], [`Error::OutOfRange`]; [`Error::Indefinite`] for a P without eigenvalues.
pub fn along_axes(drawn: &[f64], linearised: &[f64], step: &[f64]) -> Result<Vec<f64>, Error> {
    let d = step.len();
    let in_steps = |name, matrix| {
        let matrix = rows(name, matrix, d, d)?;
        Ok::<_, Error>(Mat::from_fn(d, d, |i, j| matrix[(i, j)] / (step[i] * step[j]).sqrt()))
    };
    let (drawn, linearised) =
        (in_steps("covariance of draws", drawn)?, in_steps("covariance of the linearised filter", linearised)?);
    let Ok(eigen) = linearised.self_adjoint_eigen(Side::Lower) else {
        return Err(Error::Indefinite { name: "covariance of the linearised filter", smallest: f64::NAN });
    };
    let axes = eigen.U();
    let turned = drawn * axes;
    let variance = |k: usize| (0..d).map(|i| axes[(i, k)] * turned[(i, k)]).sum::<f64>();
    let root = Mat::from_fn(d, d, |i, k| axes[(i, k)] * (step[i] * variance(k).max(0.0)).sqrt());
    Ok(to_rows(&(&root * root.transpose())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::factor::cholesky;
    use crate::linearised_filter::LinearisedFilter;
    use crate::smoother::Smoother;
    use sinew_core::lanes::{Block, Isa, numbers};
    use sinew_core::random::Stage;
    use sinew_core::transition::Moments;

    fn close(a: &[f64], b: &[f64]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12)
    }

    #[test]
    fn draws_that_have_the_axes_stay_as_they_are() {
        let p = [2.0, 0.6, 0.6, 1.0];
        assert!(close(&along_axes(&p, &p, &[0.3, 0.1]).unwrap(), &p));
        // Along coordinates only variances are left.
        let correlated = [1.5, 0.4, 0.4, 0.7];
        assert!(close(&along_axes(&correlated, &[2.0, 0.0, 0.0, 1.0], &[1.0, 1.0]).unwrap(), &[1.5, 0.0, 0.0, 0.7]));
    }

    /// Draws that a prior or limits hold closer keep that, along the axes.
    #[test]
    fn variances_are_the_draws() {
        let (p, step) = ([2.0, 1.2, 1.2, 1.0], [1.0, 1.0]);
        let half: Vec<f64> = p.iter().map(|x| 0.5 * x).collect();
        assert!(close(&along_axes(&half, &p, &step).unwrap(), &half));
    }

    const DIM: usize = 8;
    const FRAMES: usize = 200;
    const DRAWS: usize = 64;

    /// A walk with steps of 1, seen along four directions with errors of 0.3 and along four others with errors of 40; the filter is exact, its covariance is taken from draws.
    /// Errors of the smoothed means against the exact smoother's, in steps: root mean squares over the first half of the series, which a backward pass comes to last.
    fn errors_of_the_smoother(by: impl Fn(&[f64], &[f64]) -> Vec<f64>) -> f64 {
        let noise = |name: &str, count: usize| {
            let mut blocks = vec![Block::ZERO; count.div_ceil(8)];
            Stage::new(7, name).whole().fill_normal(Isa::baseline(), &mut blocks);
            numbers(&blocks)[..count].to_vec()
        };
        let directions = Mat::from_fn(DIM, DIM, {
            let entries = noise("directions", DIM * DIM);
            move |i, j| entries[i * DIM + j] / (DIM as f64).sqrt()
        });
        let errors: Vec<f64> = (0..DIM).map(|k| if k < 4 { 0.3 } else { 40.0 }).collect();
        let whitened = Mat::from_fn(DIM, DIM, |i, j| directions[(i, j)] / errors[i]);
        let information = to_rows(&(whitened.transpose() * &whitened));
        let (steps, seen) = (noise("steps", FRAMES * DIM), noise("errors", FRAMES * DIM));
        let step = [1.0; DIM];
        let mut filter = LinearisedFilter::new(&[10.0; DIM]);
        let (mut state, mut mean) = (vec![0.0; DIM], Mat::<f64>::zeros(DIM, 1));
        let (mut exact, mut sampled) = (vec![], vec![]);
        for t in 0..FRAMES {
            filter.predict(&step);
            state.iter_mut().zip(&steps[t * DIM..]).for_each(|(x, z)| *x += z);
            filter.update(&information).unwrap();
            let p = filter.covariance();
            let truth = Mat::from_fn(DIM, 1, |i, _| state[i]);
            let error = Mat::from_fn(DIM, 1, |i, _| seen[t * DIM + i]);
            let found = &whitened * (truth - &mean) + error;
            mean += rows("P", &p, DIM, DIM).unwrap() * (whitened.transpose() * found);
            let m: Vec<f64> = (0..DIM).map(|i| mean[(i, 0)]).collect();
            let root = rows("L", &cholesky("P", &p, DIM).unwrap().lower, DIM, DIM).unwrap();
            let normal = noise(&format!("draws {t}"), DIM * DRAWS);
            let draws = root * Mat::from_fn(DIM, DRAWS, |i, k| normal[i * DRAWS + k]);
            let drawn = to_rows(&(faer::Scale(1.0 / DRAWS as f64) * (&draws * draws.transpose())));
            sampled.push(Moments { mean: m.clone(), covariance: by(&drawn, &p) });
            exact.push(Moments { mean: m, covariance: p });
        }
        let smoother = Smoother::random_walk(&step);
        let smoothed = |filtered: &[Moments]| {
            let mut means = vec![filtered[FRAMES - 1].mean.clone()];
            for moments in filtered[..FRAMES - 1].iter().rev() {
                let next = &means[means.len() - 1];
                means.push(smoother.backward(moments).unwrap().mean(next));
            }
            means
        };
        let (exact, sampled) = (smoothed(&exact), smoothed(&sampled));
        let early = exact.iter().flatten().zip(sampled.iter().flatten()).skip(FRAMES / 2 * DIM);
        let count = (FRAMES / 2 * DIM) as f64;
        (early.map(|(a, b)| (a - b).powi(2)).sum::<f64>() / count).sqrt()
    }

    #[test]
    fn a_backward_pass_errs_less_than_half_as_much_along_the_axes() {
        let by_draws = errors_of_the_smoother(|drawn, _| drawn.to_vec());
        let by_axes = errors_of_the_smoother(|drawn, p| along_axes(drawn, p, &[1.0; DIM]).unwrap());
        assert!(by_axes < 0.5 * by_draws, "{by_axes} along the axes, {by_draws} by draws");
    }
}
