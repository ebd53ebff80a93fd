//! Eight chains of random-walk Metropolis, one a lane, on the eight schools of Rubin (1981).
//!
//! `cargo run --release -p sinew-core --example metropolis_in_lanes`

use sinew_core::density::{LaneDensity, Lanes, LogDensity};
use sinew_core::diagnostics::{effective_sample_size, split_r_hat};
use sinew_core::elementary::{exp, ln};
use sinew_core::inlined;
use sinew_core::lanes::{Block, Isa, LANES, Real};
use sinew_core::random::Stage;

const EFFECTS: [f64; 8] = [28.0, 8.0, -3.0, 7.0, -1.0, 1.0, 18.0, 12.0];
const ERRORS: [f64; 8] = [15.0, 10.0, 16.0, 11.0, 9.0, 11.0, 10.0, 18.0];

/// State: μ ~ N(0, 5), ln τ with τ ~ half-Cauchy(5), z_j ~ N(0, 1); effect j is N(μ + τ z_j, error j).
struct Schools;

impl LaneDensity for Schools {
    inlined! {
        fn dim(&self) -> usize {
            2 + EFFECTS.len()
        }
        fn eval<V: Real, const GRAD: bool>(&self, x: &[V::Mem], grad: &mut [V::Mem], _ws: &mut [V::Mem]) -> V {
            let (mu, log_tau) = (V::load(&x[0]), V::load(&x[1]));
            let tau = exp(log_tau);
            let spread = (tau * tau).fma(V::splat(0.04), V::splat(1.0));
            let mut sum = mu * mu * V::splat(-0.02) + log_tau - ln(spread);
            let (mut by_mu, mut by_log_tau) = (mu * V::splat(-0.04), V::splat(2.0) / spread - V::splat(1.0));
            for j in 0..EFFECTS.len() {
                let z = V::load(&x[2 + j]);
                let residual = (V::splat(EFFECTS[j]) - tau.fma(z, mu)) * V::splat(1.0 / ERRORS[j]);
                sum = sum - (residual * residual + z * z) * V::splat(0.5);
                if GRAD {
                    let pull = residual * V::splat(1.0 / ERRORS[j]);
                    by_mu = by_mu + pull;
                    by_log_tau = by_log_tau + pull * tau * z;
                    (pull * tau - z).store(&mut grad[2 + j]);
                }
            }
            if GRAD {
                by_mu.store(&mut grad[0]);
                by_log_tau.store(&mut grad[1]);
            }
            sum
        }
    }
}

fn main() {
    let isa = Isa::best();
    let target = Lanes { leaf: Schools, isa };
    let d = target.dim();
    let mut rng = Stage::new(42, "eight schools").whole();
    let mut state = vec![Block::ZERO; d];
    rng.fill_normal(isa, &mut state);
    let mut value = target.log_density_block(&state, &mut []);
    let (mut proposed, mut uniform) = (state.clone(), [Block::ZERO]);
    let mut kept = vec![vec![Vec::new(); LANES]; 2];
    for step in 0..40_000 {
        rng.fill_normal(isa, &mut proposed);
        rng.fill_uniform(&mut uniform);
        for (j, (y, x)) in proposed.iter_mut().zip(&state).enumerate() {
            let sd = if j == 0 { 3.0 } else { 0.5 };
            y.0.iter_mut().zip(x.0).for_each(|(y, x)| *y = x + sd * *y);
        }
        let there = target.log_density_block(&proposed, &mut []);
        for lane in 0..LANES {
            if uniform[0].0[lane].ln() < there.0[lane] - value.0[lane] {
                value.0[lane] = there.0[lane];
                state.iter_mut().zip(&proposed).for_each(|(x, y)| x.0[lane] = y.0[lane]);
            }
        }
        if step >= 4000 {
            kept[0].iter_mut().zip(state[0].0).for_each(|(chain, mu)| chain.push(mu));
            kept[1].iter_mut().zip(state[1].0).for_each(|(chain, log_tau)| chain.push(log_tau.exp()));
        }
    }
    for (name, chains) in ["mu", "tau"].into_iter().zip(&kept) {
        let draws = chains.iter().map(Vec::len).sum::<usize>() as f64;
        let mean = chains.iter().flatten().sum::<f64>() / draws;
        let (r_hat, effective) = (split_r_hat(chains), effective_sample_size(chains));
        println!("{name:>3}: mean {mean:.2}, R-hat {r_hat:.3}, {effective:.0} effective draws");
    }
}
