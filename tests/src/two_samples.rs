//! Two-sample test of Kolmogorov and Smirnov.

/// p value of the largest distance D between two empirical distributions, by the limit 2 Σ (−1)^{k−1} exp(−2 k² λ²) with λ = (√n + 0.12 + 0.11 / √n) D and n the harmonic size (Stephens 1970).
#[must_use]
pub fn kolmogorov_smirnov(a: &[f64], b: &[f64]) -> f64 {
    let sorted = |values: &[f64]| {
        let mut values = values.to_vec();
        values.sort_by(f64::total_cmp);
        values
    };
    let (a, b) = (sorted(a), sorted(b));
    let (n, m) = (a.len() as f64, b.len() as f64);
    let (mut i, mut j, mut distance) = (0, 0, 0.0_f64);
    while i < a.len() && j < b.len() {
        let x = a[i].min(b[j]);
        while i < a.len() && a[i] <= x {
            i += 1;
        }
        while j < b.len() && b[j] <= x {
            j += 1;
        }
        distance = distance.max((i as f64 / n - j as f64 / m).abs());
    }
    let root = (n * m / (n + m)).sqrt();
    let lambda = (root + 0.12 + 0.11 / root) * distance;
    if lambda < 0.2 {
        return 1.0;
    }
    let term = |k: i32| f64::from(1 - 2 * ((k - 1) % 2)) * (-2.0 * f64::from(k * k) * lambda * lambda).exp();
    (2.0 * (1..=100).map(term).sum::<f64>()).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew::core::lanes::Block;
    use sinew::core::random::Stage;

    fn uniforms(count: usize, stage: Stage) -> Vec<f64> {
        let mut blocks = vec![Block::ZERO; count / 8];
        stage.whole().fill_uniform(&mut blocks);
        blocks.iter().flat_map(|b| b.0).collect()
    }

    /// Quantiles of the limiting distribution, and how often equal distributions are told apart at 5 %.
    #[test]
    fn p_values_are_those_of_the_table_and_uniform_under_the_hypothesis() {
        let a: Vec<f64> = (0..1000).map(f64::from).collect();
        let b: Vec<f64> = a.iter().map(|x| x + 99.5).collect();
        let lambda = (500.0_f64.sqrt() + 0.12 + 0.11 / 500.0_f64.sqrt()) * 0.1;
        assert!((kolmogorov_smirnov(&a, &b) - 2.0 * (-2.0 * lambda * lambda).exp()).abs() < 1e-6);
        let root = Stage::new(1, "two samples");
        let rejected = (0..1000)
            .filter(|&r| {
                let [a, b] = root.round(r).split(["a", "b"]).map(|stage| uniforms(400, stage));
                kolmogorov_smirnov(&a, &b) < 0.05
            })
            .count();
        assert!((20..=80).contains(&rejected), "{rejected} of 1000 at 5 %");
        let shifted: Vec<f64> = uniforms(4000, root.round(2000)).iter().map(|x| x + 0.08).collect();
        assert!(kolmogorov_smirnov(&uniforms(4000, root.round(2001)), &shifted) < 1e-6);
    }
}
