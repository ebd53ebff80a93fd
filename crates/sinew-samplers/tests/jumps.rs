//! Trajectories with jumps on a target of two narrow clusters, with exact draws.
//! Jumps keep the target although their proposal is wrong, and reach both clusters from one.

use sinew_core::density::{GradLogDensity, LogDensity};
use sinew_core::diagnostics::effective_sample_size;
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::Stage;
use sinew_samplers::chains::Schedule;
use sinew_samplers::gaussian_mixture::GaussianMixture;
use sinew_samplers::hmc::Hmc;
use sinew_samplers::jumps::{Jumps, draw_with_jumps};

/// 0.3 N((−4, 0), I) + 0.7 N((4, 0), I).
struct Clusters;

impl LogDensity for Clusters {
    fn dim(&self) -> usize {
        2
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.log_density_grad(x, &mut [0.0; 2])
    }
}

impl GradLogDensity for Clusters {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        let [a, b] = [(0.3_f64, -4.0), (0.7, 4.0)].map(|(w, m)| w.ln() - 0.5 * (x[0] - m) * (x[0] - m));
        let sum = a.max(b) + (-(a - b).abs()).exp().ln_1p();
        grad[0] = -(a - sum).exp() * (x[0] + 4.0) - (b - sum).exp() * (x[0] - 4.0);
        grad[1] = -x[1];
        sum - 0.5 * x[1] * x[1]
    }
}

fn exact(blocks: usize, left: f64, stage: Stage) -> Vec<Block> {
    let mut states = vec![Block::ZERO; 2 * blocks];
    let mut side = vec![Block::ZERO; blocks];
    let mut rng = stage.whole();
    rng.fill_normal(Isa::best(), &mut states);
    rng.fill_uniform(&mut side);
    for (state, side) in states.chunks_exact_mut(2).zip(&side) {
        for lane in 0..LANES {
            state[0].0[lane] += if side.0[lane] < left { -4.0 } else { 4.0 };
        }
    }
    states
}

/// A proposal with the wrong weights, places and widths.
fn rough() -> Jumps {
    let mut states = exact(500, 0.5, Stage::new(1, "rough"));
    states.iter_mut().flat_map(|b| &mut b.0).for_each(|x| *x = 1.2 * *x + 0.3);
    let proposal = GaussianMixture::fit(Isa::best(), &states, 2, 2, 4000.0).expect("fits");
    Jumps { proposal, count: 2 }
}

/// Values of x, y, x², y² and the indicator of the left cluster.
fn moments(states: &[Block]) -> [Vec<f64>; 5] {
    let of: [fn(f64, f64) -> f64; 5] =
        [|x, _| x, |_, y| y, |x, _| x * x, |_, y| y * y, |x, _| f64::from(u8::from(x < 0.0))];
    let all = |lane: usize| states.chunks_exact(2).map(move |s| (s[0].0[lane], s[1].0[lane]));
    of.map(|of| (0..LANES).flat_map(all).map(|(x, y)| of(x, y)).collect())
}

/// 5 statistics at |z| < 4.5: false alarm 4e-5.
#[test]
fn a_start_from_the_target_stays_in_the_target() {
    let hmc = Hmc::new(0.9, &[1.0; 2], 3, 0.2, Isa::best()).expect("valid");
    let starts = exact(2500, 0.3, Stage::new(2, "start"));
    let schedule = Schedule { updates: 2, burn_in: 2 };
    let run = draw_with_jumps(&Clusters, &hmc, &rough(), &starts, 20_000, schedule, &Stage::new(2, "stays"))
        .expect("finite starts");
    assert!(run.acceptance > 0.3 && run.acceptance < 0.9, "{}", run.acceptance);
    for (k, (old, new)) in moments(&starts).iter().zip(moments(&run.draws.states)).enumerate() {
        let change: Vec<f64> = old.iter().zip(&new).map(|(old, new)| new - old).collect();
        let n = change.len() as f64;
        let mean = change.iter().sum::<f64>() / n;
        let variance = change.iter().map(|c| (c - mean) * (c - mean)).sum::<f64>() / n;
        let z = mean / (variance / n).sqrt();
        assert!(z.abs() < 4.5, "moment {k} changed by {mean}, z = {z}, bound 4.5, seed 2");
    }
    for (index, stat) in run.draws.stats.iter().enumerate() {
        let state = [0, 1].map(|j| run.draws.states[index / LANES * 2 + j].0[index % LANES]);
        assert!((Clusters.log_density(&state) - stat.log_density).abs() < 1e-12 && stat.energy >= -stat.log_density);
    }
}

/// From the left cluster alone, where trajectories stay. 5 statistics at |z| < 4.5: false alarm 4e-5.
#[test]
fn a_start_in_one_cluster_reaches_both() {
    let hmc = Hmc::new(0.9, &[1.0; 2], 3, 0.2, Isa::best()).expect("valid");
    let starts = exact(1000, 1.0, Stage::new(3, "start"));
    let schedule = Schedule { updates: 30, burn_in: 30 };
    let run = |jumps: &Jumps| {
        let run = draw_with_jumps(&Clusters, &hmc, jumps, &starts, 8000, schedule, &Stage::new(3, "reach"));
        run.expect("finite starts").draws
    };
    let draws = run(&rough());
    for (values, exact) in moments(&draws.states).iter().zip([1.6, 0.0, 17.0, 1.0, 0.3]) {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / n;
        let z = (mean - exact) / (variance / n).sqrt();
        assert!(z.abs() < 4.5, "{mean} against {exact}, z = {z}, bound 4.5, seed 3");
    }
    assert_eq!(draws, run(&rough()));
    let without = run(&Jumps { count: 0, ..rough() });
    let left = moments(&without.states)[4].iter().sum::<f64>() / 8000.0;
    assert!(left > 0.95, "trajectories alone have left: {left}");
}

/// One chain that takes the proposals of all lanes: 5 statistics at |z| < 4.5, false alarm 4e-5.
#[test]
fn one_chain_alone_takes_every_lane_s_proposals() {
    let hmc = Hmc::new(0.9, &[1.0; 2], 3, 0.2, Isa::best()).expect("valid");
    let start = exact(1, 1.0, Stage::new(4, "start"));
    let schedule = Schedule { updates: 20_000, burn_in: 20 };
    let run =
        draw_with_jumps(&Clusters, &hmc, &rough(), &start, 1, schedule, &Stage::new(4, "alone")).expect("finite start");
    let [x, y] = [0, 1].map(|j| run.draws.series(j).concat());
    let values: [Vec<f64>; 5] = [
        x.clone(),
        y.clone(),
        x.iter().map(|x| x * x).collect(),
        y.iter().map(|y| y * y).collect(),
        x.iter().map(|x| f64::from(u8::from(*x < 0.0))).collect(),
    ];
    for (values, exact) in values.iter().zip([1.6, 0.0, 17.0, 1.0, 0.3]) {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let variance = values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / values.len() as f64;
        let effective = effective_sample_size(&[values]);
        assert!(effective > 10_000.0, "{effective} of {} draws", values.len());
        let z = (mean - exact) / (variance / effective).sqrt();
        assert!(z.abs() < 4.5, "{mean} against {exact}, z = {z}, bound 4.5, seed 4");
    }
}
