//! The benchmark of missing limbs: published rows to their digits, and a small latent model.

use sinew_tests::data;
use sinew_tests::missing_limbs::latent::{Config, Rows, covered, learn, means};
use sinew_tests::missing_limbs::{BODY, Benchmark, LEG, mixture, neighbours};

#[test]
fn nearest_neighbours_have_the_published_errors() {
    let Some(folder) = data::shared("mocap35_missing") else { return };
    let benchmark = Benchmark::read(&folder).unwrap();
    assert_eq!(benchmark.training.len(), 31);
    for (missing, is_scaled, cumulative, rms_deg) in
        [(LEG, false, 14.01, 4.11), (LEG, true, 13.50, 4.44), (BODY, false, 30.89, 3.20), (BODY, true, 20.86, 2.62)]
    {
        let task = benchmark.published(&missing);
        let found = benchmark.judged(&task, &neighbours::fill(&task, is_scaled));
        let rounded = |x: f64| (100.0 * x).round() / 100.0;
        assert_eq!((rounded(found.cumulative), rounded(found.rms_deg)), (cumulative, rms_deg), "{found:?}");
    }
}

/// A walk that is left out of training.
const WALK: usize = 9;

#[test]
fn a_small_latent_model_beats_nearest_neighbours_on_a_walk_left_out() {
    let Some(folder) = data::shared("mocap35_missing") else { return };
    let benchmark = Benchmark::read(&folder).unwrap();
    let config = Config { dim: 3, weights: true, dynamics: true, back: None, every: 8, steps: 20 };
    let learned = learn(&benchmark.left_out(&[WALK], WALK, &LEG).training, &config).unwrap();
    for missing in [LEG, BODY] {
        let task = benchmark.left_out(&[WALK], WALK, &missing);
        let said = learned.fill(&task, Rows::Walk(5.0)).unwrap();
        let own = benchmark.judged(&task, &means(&said));
        let near = [false, true].map(|is_scaled| benchmark.judged(&task, &neighbours::fill(&task, is_scaled)));
        assert!(near.iter().all(|near| own.rms_deg < near.rms_deg), "{missing:?}: {own:?}, neighbours {near:?}");
        let [half, .., most] = covered(&task, &said);
        assert!(
            half > 0.3 && most > 0.8,
            "{missing:?}: {half} and {most} of the truth in the intervals of 50 and 95 %"
        );
    }
}

#[test]
fn a_mixture_of_one_is_linear_regression_and_fills_in_what_it_was_given() {
    let Some(folder) = data::shared("mocap35_missing") else { return };
    let benchmark = Benchmark::read(&folder).unwrap();
    let task = benchmark.left_out(&[WALK], WALK, &LEG);
    let filled = mixture::fill(&task, 1).unwrap();
    for (filled, truth) in filled.iter().zip(task.judged()) {
        assert!(task.observed().iter().all(|&j| filled[j] == truth[j]));
    }
    let mean: Vec<Vec<f64>> = task.with(|_| task.scales().mean[LEG].to_vec());
    let [own, mean] = [&filled, &mean].map(|filled| benchmark.judged(&task, filled).rms_deg);
    assert!(own < 0.5 * mean, "{own} and {mean} of the mean row");
}
