//! The annealed and the coarse-to-fine tracker against exact results.
//! One annealed layer against the bootstrap filter (A1), the verbs of the coarse-to-fine search (A12), validity, counts of evaluations, equality of the two ways of a product likelihood.

use sinew_core::density::{Lanes, LogDensity, PartLogDensity};
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::part::{Part, PartTree, Partition};
use sinew_core::random::Stage;
use sinew_core::toy::Quadratic;
use sinew_dynamics::random_walk::{Between, RandomWalk};
use sinew_samplers::annealed_search::{self, Last};
use sinew_samplers::grid::GridAxis;
use sinew_samplers::particles::aggregate;
use sinew_samplers::resample::Scheme;
use sinew_tracking::annealed::{self, Annealed};
use sinew_tracking::bootstrap::{self, Bootstrap};
use sinew_tracking::coarse_to_fine::{self, CoarseToFine, Judging};
use sinew_tracking::partitioned::{self, Partitioned};
use sinew_tracking::{Inferred, StepInfo, Tracker};
use std::sync::Arc;

const SD: [f64; 3] = [0.3, 0.1, 0.2];

fn walk() -> RandomWalk {
    RandomWalk::new(&SD, 1.0, Between::Mixture, Isa::best()).expect("valid")
}

fn seen(frame: u32) -> Lanes<Quadratic> {
    let angle = 0.2 * f64::from(frame);
    let leaf = Quadratic { centre: vec![angle.sin(), angle.cos(), 0.1 * angle], precision: vec![60.0, 30.0, 10.0] };
    Lanes { leaf, isa: Isa::best() }
}

/// One layer against the bootstrap filter (A1): weights, ancestors and particles of ten frames.
#[test]
fn one_layer_with_an_exponent_of_one_is_the_bootstrap_filter() {
    for scheme in [Scheme::Multinomial, Scheme::Systematic] {
        let config = bootstrap::Config { particles: 203, scheme, ..bootstrap::Config::default() };
        let mut filter = Bootstrap::new(config, walk(), vec![0.0, 1.0, 0.0]).expect("valid");
        let layers = annealed_search::Config { layers: 1, last: Last::Fixed(1.0), scheme, ..Default::default() };
        let config = annealed::Config { particles: 203, layers };
        let mut one = Annealed::new(config, walk(), SD.to_vec(), vec![0.0, 1.0, 0.0], Isa::best()).expect("valid");
        for frame in 0..10 {
            let stage = || Stage::new(11, "A1").at_frame(frame);
            let (filter_step, search_step) = (
                filter.step(&seen(frame), stage()).expect("weights"),
                one.step(&seen(frame), stage()).expect("weights"),
            );
            let (a, b) = (filter.particles(), one.particles());
            assert_eq!((a.weights(), a.log_weights()), (b.weights(), b.log_weights()), "frame {frame}");
            for i in 0..203 {
                assert_eq!((a.state(i), a.ancestor(i)), (b.state(i), b.ancestor(i)), "frame {frame}, particle {i}");
            }
            assert_eq!(search_step.exponents, [1.0]);
            assert_eq!(search_step.survivors, [filter_step.ess]);
            assert_eq!(StepInfo { exponents: vec![], survivors: vec![], ..search_step }, filter_step);
        }
    }
}

#[test]
fn layers_are_counted_and_recorded() {
    let config = annealed::Config::default();
    let mut tracker = Annealed::new(config, walk(), SD.to_vec(), vec![0.0, 1.0, 0.0], Isa::best()).expect("valid");
    for frame in 0..4 {
        let info = tracker.step(&seen(frame), Stage::new(1, "layers").at_frame(frame)).expect("weights");
        assert_eq!((info.likelihood_evaluations, info.log_evidence, info.resampled), (2000, None, Some(frame > 0)));
        assert_eq!((info.exponents.len(), info.survivors.len()), (10, 10));
        assert!(info.survivors.iter().all(|d| (d / 200.0 - 0.5).abs() < 1e-6), "{:?}", info.survivors);
        assert!(info.exponents[9] > 10.0 * info.exponents[0]);
        let (state, log_likelihood) = tracker.best();
        assert_eq!(log_likelihood, seen(frame).log_density(&state));
        assert!(log_likelihood > -0.5, "{log_likelihood}");
    }
}

/// 0 where the first coordinate is negative.
struct Negative;
impl LogDensity for Negative {
    fn dim(&self) -> usize {
        3
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        if x[0] < 0.0 { 0.0 } else { f64::NEG_INFINITY }
    }
}

#[test]
fn what_is_not_valid_weighs_nothing() {
    let mut tracker = Annealed::new(annealed::Config::default(), walk(), SD.to_vec(), vec![0.0, 1.0, 0.0], Isa::best())
        .and_then(|tracker| tracker.with_validity(Arc::new(Negative)))
        .expect("valid");
    for frame in 0..4 {
        tracker.step(&seen(frame), Stage::new(2, "validity").at_frame(frame)).expect("weights");
        let particles = tracker.particles();
        let weighted = (0..200).filter(|&i| particles.weights()[i] > 0.0);
        assert!(weighted.clone().count() > 50);
        assert!(weighted.clone().all(|i| particles.state(i)[0] < 0.0));
        // Particles of weight zero are there: the predicate is asked in the last layer too.
        assert!((0..200).any(|i| particles.state(i)[0] >= 0.0));
        assert!(tracker.best().0[0] < 0.0);
    }
}

/// The same Gaussian with a part for each coordinate; part 2 also looks at coordinate 0, if the whole is not declared a product.
struct InParts {
    whole: Lanes<Quadratic>,
    product: bool,
}
impl LogDensity for InParts {
    fn dim(&self) -> usize {
        3
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.whole.log_density(x)
    }
    fn log_density_block(&self, x: &[Block], ws: &mut [Block]) -> Block {
        self.whole.log_density_block(x, ws)
    }
}
impl PartLogDensity for InParts {
    fn parts(&self) -> usize {
        3
    }
    fn is_product(&self) -> bool {
        self.product
    }
    fn log_density_parts_block(&self, parts: &[usize], x: &[Block], out: &mut [Block], _ws: &mut [Block]) {
        let Quadratic { centre, precision } = &self.whole.leaf;
        for (&k, out) in parts.iter().zip(out) {
            let other = if k == 2 && !self.product { x[0].0 } else { [centre[0]; 8] };
            let value = |lane: usize| {
                let error = x[k].0[lane] - centre[k] + 3.0 * (other[lane] - centre[0]);
                -0.5 * precision[k] * error * error
            };
            *out = Block(core::array::from_fn(value));
        }
    }
}

fn tree() -> PartTree {
    let parts = (0..3).map(|j| Part::new(vec![j], 3).expect("valid")).collect();
    PartTree::new(Partition::new(parts, 3).expect("covers"), vec![None, Some(0), Some(0)]).expect("parents first")
}

/// With the factors of the likelihood as importance, dividing them out and multiplying by all of it is multiplying by the last factor. Equal but for rounding.
#[test]
fn a_product_is_weighed_by_its_last_factor() {
    struct Whole(InParts);
    impl LogDensity for Whole {
        fn dim(&self) -> usize {
            3
        }
        fn log_density(&self, x: &[f64]) -> f64 {
            self.0.log_density(x)
        }
        fn log_density_block(&self, x: &[Block], ws: &mut [Block]) -> Block {
            self.0.log_density_block(x, ws)
        }
    }
    impl PartLogDensity for Whole {
        fn parts(&self) -> usize {
            3
        }
        fn log_density_parts_block(&self, parts: &[usize], x: &[Block], out: &mut [Block], ws: &mut [Block]) {
            self.0.log_density_parts_block(parts, x, out, ws);
        }
    }
    let make = || {
        let config = partitioned::Config { particles: 301, ..Default::default() };
        Partitioned::new(config, walk(), tree(), vec![0.0, 1.0, 0.0]).expect("valid")
    };
    let (mut by_factors, mut by_whole) = (make(), make());
    let product = InParts { whole: seen(3), product: true };
    let a = by_factors.step(&product, Stage::new(3, "product")).expect("weights");
    let b = by_whole.step(&Whole(product), Stage::new(3, "product")).expect("weights");
    assert_eq!((a.part_evaluations, a.likelihood_evaluations), (3 * 301, 0));
    assert_eq!((b.part_evaluations, b.likelihood_evaluations), (2 * 301, 301));
    assert_eq!(by_factors.particles().states(), by_whole.particles().states());
    let pairs = by_factors.particles().weights().iter().zip(by_whole.particles().weights());
    assert!(pairs.clone().all(|(a, b)| (a - b).abs() < 1e-12));
    let [za, zb] = [a.log_evidence, b.log_evidence].map(|z| z.expect("evidence"));
    assert!((za - zb).abs() < 1e-10, "{za} and {zb}");
    assert_eq!(a.survivors.len(), 3);
    assert_eq!(by_factors.survivors(), a.survivors);
    assert!(a.survivors.iter().all(|d| (2.0..301.0).contains(d)), "{:?}", a.survivors);
}

/// Intermediate densities that are the products of the factors so far choose as the factors do: what is divided out leaves the last one. Equal but for rounding.
#[test]
fn intermediate_densities_telescope() {
    struct SoFar(InParts);
    impl LogDensity for SoFar {
        fn dim(&self) -> usize {
            3
        }
        fn log_density(&self, x: &[f64]) -> f64 {
            self.0.log_density(x)
        }
        fn log_density_block(&self, x: &[Block], ws: &mut [Block]) -> Block {
            self.0.log_density_block(x, ws)
        }
    }
    impl PartLogDensity for SoFar {
        fn parts(&self) -> usize {
            3
        }
        fn has_intermediates(&self) -> bool {
            true
        }
        fn log_intermediate_block(&self, part: usize, x: &[Block], ws: &mut [Block]) -> Block {
            let mut factors = [Block::ZERO; 3];
            self.0.log_density_parts_block(&[0, 1, 2], x, &mut factors, ws);
            Block(core::array::from_fn(|lane| factors[..=part].iter().map(|factor| factor.0[lane]).sum()))
        }
        fn log_density_parts_block(&self, parts: &[usize], _x: &[Block], out: &mut [Block], _ws: &mut [Block]) {
            out[..parts.len()].fill(Block::splat(f64::NAN));
        }
    }
    let make = || {
        let config = partitioned::Config { particles: 301, ..Default::default() };
        Partitioned::new(config, walk(), tree(), vec![0.0, 1.0, 0.0]).expect("valid")
    };
    let (mut by_factors, mut by_intermediates) = (make(), make());
    for frame in 0..3 {
        let product = || InParts { whole: seen(3), product: true };
        let stage = || Stage::new(3, "telescope").at_frame(frame);
        let a = by_factors.step(&product(), stage()).expect("weights");
        let b = by_intermediates.step(&SoFar(product()), stage()).expect("weights");
        assert_eq!((b.part_evaluations, b.likelihood_evaluations), (0, 3 * 301));
        assert_eq!(by_factors.particles().states(), by_intermediates.particles().states());
        let pairs = by_factors.particles().weights().iter().zip(by_intermediates.particles().weights());
        assert!(pairs.clone().all(|(a, b)| (a - b).abs() < 1e-12));
        let [za, zb] = [a.log_evidence, b.log_evidence].map(|z| z.expect("evidence"));
        assert!((za - zb).abs() < 1e-10, "{za} and {zb}");
        assert!(a.survivors.iter().zip(&b.survivors).all(|(a, b)| (a - b).abs() < 1e-8));
    }
}

fn axes(width: f64) -> Vec<GridAxis> {
    vec![GridAxis::new(-2.0, 2.0, width, false).expect("valid"); 3]
}

fn coarse_to_fine(config: coarse_to_fine::Config, width: f64) -> CoarseToFine {
    CoarseToFine::new(config, axes(width), tree(), vec![0.0, 1.0, 0.0], Isa::best()).expect("valid")
}

/// Coarse to fine (second half of A12): coarse states stand on centres and the coarse estimate is the best of them; equal ones are evaluated once.
#[test]
fn coarse_states_stand_on_centres_and_share_evaluations() {
    for (width, snapped) in [(0.5, true), (0.1, true), (0.3, false)] {
        let mut tracker = coarse_to_fine(coarse_to_fine::Config { snapped, ..Default::default() }, width);
        for frame in 0..3 {
            let observed = InParts { whole: seen(frame), product: true };
            let info = tracker.step(&observed, Stage::new(4, "centres").at_frame(frame)).expect("weights");
            let particles = tracker.particles();
            let states: Vec<Vec<f64>> = (0..particles.count()).map(|i| particles.state(i)).collect();
            assert_eq!(tracker.posterior().mean(), tracker.fine().state);
            let on_centres =
                states.iter().all(|state| state.iter().zip(axes(width)).all(|(x, axis)| axis.snap(*x) == *x));
            assert_eq!(on_centres, snapped);
            let best = states.iter().map(|state| observed.log_density(state)).fold(f64::NEG_INFINITY, f64::max);
            assert_eq!(tracker.coarse().log_likelihood, best);
            assert_eq!(observed.log_density(&tracker.coarse().state), best);
            assert_eq!(tracker.fine().log_likelihood, observed.log_density(&tracker.fine().state));
            let different: std::collections::BTreeSet<Vec<u64>> =
                states.iter().map(|state| state.iter().map(|x| x.to_bits()).collect()).collect();
            assert_eq!(info.likelihood_evaluations, different.len() + 1);
            assert_eq!(info.part_evaluations, 1500);
            assert_eq!(info.likelihood_evaluations < 301, snapped);
        }
    }
}

/// Coarse to fine (second half of A12): with one fine particle the parts are its own, and it is one draw around the coarse estimate.
#[test]
fn one_fine_particle_is_the_estimate() {
    for judging in [Judging::Decoupled, Judging::Chained, Judging::Whole] {
        let mut tracker = coarse_to_fine(coarse_to_fine::Config { fine: 1, judging, ..Default::default() }, 0.2);
        let observed = InParts { whole: seen(1), product: false };
        tracker.step(&observed, Stage::new(5, "one")).expect("weights");
        let [_, _, to_refine] = Stage::new(5, "one").split(["resample", "walk", "refine"]);
        let mut noise = [Block::ZERO; 3];
        to_refine.block(0).fill_normal(Isa::best(), &mut noise);
        for ((fine, coarse), noise) in tracker.fine().state.iter().zip(&tracker.coarse().state).zip(noise) {
            assert_eq!(*fine, coarse + 0.2 * noise.0[0]);
        }
    }
}

/// The drift follows the change of the estimates, from the third frame on: with a flat likelihood and many particles the mean moves by A times the change.
#[test]
fn coarse_states_drift_with_the_estimate() {
    let config = coarse_to_fine::Config { coarse: 20_000, fine: 1, drift: 5.0, snapped: false, ..Default::default() };
    let mut tracker = coarse_to_fine(config, 0.01);
    let flat = InParts {
        whole: Lanes { leaf: Quadratic { centre: vec![0.0; 3], precision: vec![0.0; 3] }, isa: Isa::best() },
        product: true,
    };
    let mut before = vec![vec![0.0, 1.0, 0.0]];
    let mut estimates: Vec<Vec<f64>> = vec![];
    for frame in 0..4_u32 {
        tracker.step(&flat, Stage::new(6, "drift").at_frame(frame)).expect("weights");
        let mean = aggregate(tracker.particles());
        for j in 0..3 {
            let change = match &estimates[..] {
                [.., a, b] => b[j] - a[j],
                _ => 0.0,
            };
            let moved = mean[j] - before[frame as usize][j];
            // Resampling and noise shift the mean of 20 000 by some 1e-4 times √frame; changes are some 1e-2.
            assert!((moved - 5.0 * change).abs() < 2e-3, "frame {frame}: {moved} for {change}");
        }
        before.push(mean);
        estimates.push(tracker.fine().state.clone());
    }
    assert!(estimates.windows(2).any(|pair| (pair[1][0] - pair[0][0]).abs() > 4e-3), "there was something to follow");
}

/// Chained, part 2 is judged under the chosen part 0, and not under its own.
#[test]
fn chained_parts_are_judged_under_the_chosen_ones() {
    let observed = InParts { whole: seen(1), product: false };
    let run = |judging| {
        let mut tracker = coarse_to_fine(coarse_to_fine::Config { judging, ..Default::default() }, 0.2);
        tracker.step(&observed, Stage::new(7, "chained")).expect("weights");
        let value = |part: usize| {
            let x: Vec<Block> = tracker.fine().state.iter().map(|&x| Block::splat(x)).collect();
            let mut out = [Block::ZERO];
            observed.log_density_parts_block(&[part], &x, &mut out, &mut []);
            out[0].0[0]
        };
        [0, 1, 2].map(value)
    };
    let (apart, chained) = (run(Judging::Decoupled), run(Judging::Chained));
    assert_eq!(apart[..2], chained[..2], "parts without ancestors that matter are chosen alike");
    assert!(chained[2] > apart[2], "{chained:?} against {apart:?}");
    assert!(chained[2] > -1e-2, "the best of 500 is near the peak: {chained:?}");
}

/// Coordinates that see each other.
struct Coupled;
impl LogDensity for Coupled {
    fn dim(&self) -> usize {
        3
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        -20.0 * (x[0] + x[1] - 1.3).powi(2) - 30.0 * (x[1] - x[2] + 0.4).powi(2) - 2.0 * x[0] * x[0]
    }
}
impl PartLogDensity for Coupled {
    fn parts(&self) -> usize {
        3
    }
    fn log_density_parts_block(&self, _: &[usize], _: &[Block], out: &mut [Block], _: &mut [Block]) {
        out.fill(Block::splat(f64::NEG_INFINITY));
    }
}

/// Judged as a whole, part after part is the best of all fine particles', the parts before as chosen and the others as in X_c.
#[test]
fn whole_states_are_put_together_greedily() {
    let observed = Coupled;
    let config = coarse_to_fine::Config { fine: LANES, judging: Judging::Whole, ..Default::default() };
    let mut tracker = coarse_to_fine(config, 0.2);
    let info = tracker.step(&observed, Stage::new(8, "whole")).expect("weights");
    assert_eq!((info.likelihood_evaluations > 3 * LANES, info.part_evaluations), (true, 0));
    let [_, _, to_refine] = Stage::new(8, "whole").split(["resample", "walk", "refine"]);
    let mut noise = [Block::ZERO; 3];
    to_refine.block(0).fill_normal(Isa::best(), &mut noise);
    let coarse = &tracker.coarse().state;
    let mut state = coarse.clone();
    for part in [0, 1, 2] {
        let with = |lane: usize| {
            let mut with = state.clone();
            with[part] = coarse[part] + 0.2 * noise[part].0[lane];
            with
        };
        let likelier =
            |a: &usize, b: &usize| observed.log_density(&with(*a)).total_cmp(&observed.log_density(&with(*b)));
        let best = (0..LANES).max_by(likelier).expect("eight lanes");
        state = with(best);
    }
    assert_eq!(tracker.fine().state, state);
    assert_ne!(state, *coarse);
}
