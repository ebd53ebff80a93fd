//! Draws of what lasts against simulated problems (ranks) and an integral.

use sinew_core::lanes::{Block, Isa};
use sinew_core::random::Stage;
use sinew_dynamics::lasting_scales::{
    HeldDraws, LastingData, LastingPrior, PriorCluster, ScalePrior, SweepSchedule, alike, draws, draws_given, mean_at,
};

const COUNT: usize = 9;

/// A cluster of fixed size, two of one scale with heavy tails, and one of a scale of its own.
fn prior() -> LastingPrior {
    let cluster = |numbers, scale, heavy_tails| PriorCluster { numbers, scale, heavy_tails, tied: 0 };
    LastingPrior {
        clusters: vec![
            cluster(vec![(0, 0.7, 0.5)], None, false),
            cluster(alike(1..3, 2.0), Some(0), true),
            cluster(vec![(3, -0.2, 1.0), (4, 0.0, 1.0)], Some(0), true),
            cluster(alike(5..9, 1.0), Some(1), false),
        ],
        scales: vec![ScalePrior { median: 0.5, log_sd: 0.8 }, ScalePrior { median: 1.0, log_sd: 1.0 }],
    }
}

struct Numbers(Vec<f64>);

impl Numbers {
    fn new(stage: Stage) -> Self {
        let mut blocks = [Block::ZERO; 20];
        stage.whole().fill_normal(Isa::baseline(), &mut blocks);
        Self(blocks.iter().flat_map(|block| block.0).collect())
    }

    fn take(&mut self) -> f64 {
        self.0.pop().expect("enough numbers")
    }
}

/// g and the logarithms of its scales from the prior, and data about some of its combinations: number 8 is seen by none.
fn simulated(run: u64) -> (Vec<f64>, Vec<f64>, LastingData) {
    let prior = prior();
    let mut z = Numbers::new(Stage::new(run, "problem"));
    let scales: Vec<f64> = prior.scales.iter().map(|s| (s.median.ln() + s.log_sd * z.take()).exp()).collect();
    let mut g = vec![0.0; COUNT];
    for cluster in &prior.clusters {
        // Gamma(2, 2): a quarter of the sum of four squared normals.
        let weight = if cluster.heavy_tails { 0.25 * (0..4).map(|_| z.take().powi(2)).sum::<f64>() } else { 1.0 };
        let size = cluster.scale.map_or(1.0, |scale| scales[scale]) / weight.sqrt();
        for &(place, mean, unit) in &cluster.numbers {
            g[place] = mean + unit * size * z.take();
        }
    }
    let (mut information, mut pull) = (vec![0.0; COUNT * COUNT], vec![0.0; COUNT]);
    for row in 0..6 {
        let design: Vec<f64> = (0..COUNT - 1).map(|j| (1.7 * (row * 8 + j) as f64).sin()).collect();
        let noise = 0.4;
        let seen = design.iter().zip(&g).map(|(a, g)| a * g).sum::<f64>() + noise * z.take();
        for (i, a) in design.iter().enumerate() {
            pull[i] += a * seen / (noise * noise);
            design.iter().enumerate().for_each(|(j, b)| information[i * COUNT + j] += a * b / (noise * noise));
        }
    }
    (g, scales, LastingData { information, pull })
}

/// Problems drawn as the prior says: ranks of the truth among draws are uniform. χ² of ten cells, false alarm 1e-6 each.
#[test]
fn ranks_of_the_truth_are_uniform() {
    check_ranks(0..0);
}

/// The same where some numbers are known, which share a scale with others.
#[test]
fn ranks_are_uniform_given_some_numbers() {
    check_ranks(1..3);
}

fn check_ranks(known: std::ops::Range<usize>) {
    const RUNS: u64 = 500;
    let mut cells = vec![[0.0; 10]; COUNT + 2];
    for run in 0..RUNS {
        let (g, scales, data) = simulated(run);
        let schedule = SweepSchedule { draws: 99, burn_in: 60, apart: 4 };
        let held = HeldDraws { places: known.clone(), draws: vec![g[known.clone()].to_vec()] };
        let held = (!known.is_empty()).then_some(&held);
        let found = draws_given(&data, &prior(), schedule, Stage::new(run, "draws"), held).expect("a posterior");
        for (k, (cells, truth)) in cells.iter_mut().zip(g.iter().chain(&scales)).enumerate() {
            let of = |draw: usize| if k < COUNT { found.errors[draw][k] } else { found.scales[draw][k - COUNT] };
            cells[(0..99).filter(|&draw| of(draw) < *truth).count() / 10] += 1.0;
        }
    }
    for (k, cells) in cells.iter().enumerate().filter(|(k, _)| !known.contains(k)) {
        let expected = RUNS as f64 / 10.0;
        let square: f64 = cells.iter().map(|cell| (cell - expected).powi(2) / expected).sum();
        assert!(square < 45.1, "number {k}: {cells:?}");
    }
}

/// Seen at 2.0 with standard deviation 0.8.
const SEEN: (f64, f64) = (2.0, 0.8);

fn one_scale(numbers: Vec<(usize, f64, f64)>, tied: usize) -> LastingPrior {
    let cluster = PriorCluster { numbers, scale: Some(0), heavy_tails: false, tied };
    LastingPrior { clusters: vec![cluster], scales: vec![ScalePrior { median: 1.0, log_sd: 1.0 }] }
}

#[test]
fn one_number_has_the_moments_of_the_integral() {
    let precision = SEEN.1.powi(-2);
    let data = LastingData { information: vec![precision], pull: vec![SEEN.0 * precision] };
    let away = away_from_the_integral(&data, &one_scale(vec![(0, 0.3, 1.0)], 0));
    assert!(is_within_bounds(away), "{away:?}");
}

/// Two numbers that are equal are one, of 1/√2 of their size.
#[test]
fn equal_numbers_have_the_moments_of_one() {
    let (precision, equal) = (SEEN.1.powi(-2), 1e8);
    let data = LastingData {
        information: vec![precision + equal, -equal, -equal, equal],
        pull: vec![SEEN.0 * precision, 0.0],
    };
    let numbers = vec![(0, 0.3, 2.0_f64.sqrt()), (1, 0.3, 2.0_f64.sqrt())];
    let away = away_from_the_integral(&data, &one_scale(numbers, 1));
    assert!(is_within_bounds(away), "{away:?}");
}

fn is_within_bounds([mean, drawn_mean, drawn_variance]: [f64; 3]) -> bool {
    mean.abs() < 0.015 && drawn_mean.abs() < 0.02 && drawn_variance.abs() < 0.05
}

/// The scale of four known numbers, of which the data say something else, against mean and variance by quadrature: ranks would be uniform also of draws that know less.
#[test]
fn the_scale_of_known_numbers_has_the_moments_of_the_integral() {
    let known = [0.2, -0.5, 0.1, 0.3];
    let squares: f64 = known.iter().map(|x| x * x).sum();
    let (mut total, mut mean, mut square) = (0.0, 0.0, 0.0);
    for cell in 0..20_000 {
        let log = -8.0 + 16.0 * (f64::from(cell) + 0.5) / 20_000.0;
        let density = (-0.5 * log * log - 4.0 * log - 0.5 * squares * (-2.0 * log).exp()).exp();
        (total, mean, square) = (total + density, mean + density * log, square + density * log * log);
    }
    let (mean, variance) = (mean / total, square / total - (mean / total).powi(2));
    let information: Vec<f64> = (0..16).map(|k| if k % 5 == 0 { 4.0 } else { 0.0 }).collect();
    let data = LastingData { information, pull: vec![2.0; 4] };
    let held = HeldDraws { places: 0..4, draws: vec![known.to_vec()] };
    let schedule = SweepSchedule { draws: 40_000, burn_in: 10, apart: 1 };
    let prior = one_scale(alike(0..4, 1.0), 0);
    let found = draws_given(&data, &prior, schedule, Stage::new(3, "known"), Some(&held)).expect("a posterior");
    let logs: Vec<f64> = found.scales.iter().map(|scales| scales[0].ln()).collect();
    let drawn = logs.iter().sum::<f64>() / logs.len() as f64;
    let drawn_variance = logs.iter().map(|log| (log - drawn).powi(2)).sum::<f64>() / logs.len() as f64;
    assert!((drawn - mean).abs() < 0.01, "{drawn} {mean}");
    assert!((drawn_variance / variance - 1.0).abs() < 0.05, "{drawn_variance} {variance}");
}

/// One number seen with noise, of an unknown scale, against mean and variance by quadrature over the scale: how far off the mean is, that of the draws, and their variance as a share.
fn away_from_the_integral(data: &LastingData, prior: &LastingPrior) -> [f64; 3] {
    let (seen, noise) = SEEN;
    let (mut total, mut mean, mut square) = (0.0, 0.0, 0.0);
    for cell in 0..20_000 {
        let log = -8.0 + 16.0 * (f64::from(cell) + 0.5) / 20_000.0;
        let variance = (2.0 * log).exp();
        let all = variance + noise * noise;
        let density = (-0.5 * log * log - 0.5 * (seen - 0.3_f64).powi(2) / all).exp() / all.sqrt();
        let given = 0.3 + variance / all * (seen - 0.3);
        total += density;
        mean += density * given;
        square += density * (given * given + variance * noise * noise / all);
    }
    let (mean, variance) = (mean / total, square / total - (mean / total).powi(2));
    let schedule = SweepSchedule { draws: 40_000, burn_in: 100, apart: 2 };
    let found = draws(data, prior, schedule, Stage::new(5, "one")).expect("a posterior");
    let drawn: Vec<f64> = found.errors.iter().map(|g| g[0]).collect();
    let drawn_mean = drawn.iter().sum::<f64>() / drawn.len() as f64;
    let drawn_variance = drawn.iter().map(|x| (x - drawn_mean).powi(2)).sum::<f64>() / drawn.len() as f64;
    [found.mean[0] - mean, drawn_mean - mean, drawn_variance / variance - 1.0]
}

#[test]
fn wrong_sizes_and_units_are_refused() {
    let (_, _, data) = simulated(0);
    let refused = |data: &LastingData, prior: &LastingPrior| {
        draws(data, prior, SweepSchedule::default(), Stage::new(0, "refused")).unwrap_err().to_string()
    };
    let short = LastingData { information: vec![0.0; 4], ..data.clone() };
    assert_eq!(refused(&short, &prior()), "information of what lasts has 4 entries; expected 81");
    let mut twice = prior();
    twice.clusters[0].numbers[0].0 = 1;
    assert_eq!(refused(&data, &twice), "clusters of a number of what lasts has 0 entries; expected 1");
    let mut flat = prior();
    flat.clusters[0].numbers[0].2 = 0.0;
    assert!(refused(&data, &flat).contains("must be positive"), "{}", refused(&data, &flat));
}

/// At the mean the posterior of these scales is stationary: what the data pull is what the prior holds back.
#[test]
fn the_mean_at_some_scales_is_where_their_posterior_is_flat() {
    let (prior, scales) = (prior(), [0.3, 2.0]);
    for run in 0..5 {
        let (_, _, data) = simulated(run);
        let g = mean_at(&data, &prior, &scales, None).expect("valid");
        for cluster in &prior.clusters {
            let size = cluster.scale.map_or(1.0, |scale| scales[scale]);
            for &(place, mean, unit) in &cluster.numbers {
                let against: f64 = (0..COUNT).map(|other| data.information[place * COUNT + other] * g[other]).sum();
                let held = (g[place] - mean) / (unit * size).powi(2);
                let left = data.pull[place] - against - held;
                assert!(left.abs() < 1e-9 * (1.0 + data.pull[place].abs()), "run {run}, number {place}: {left}");
            }
        }
    }
}
