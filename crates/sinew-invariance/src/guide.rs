//! A guide: a broken sampler, caught and mended.
//!
//! # A sampler with a bug
//!
//! We want draws from an exponential distribution, x ≥ 0 with density e⁻ˣ. A random walk would step below zero, so the proposal multiplies: y = x eᶻ, z normal. The acceptance rule looks right:
//!
//! ```
//! use sinew_core::random::BlockRng;
//! use sinew_invariance::draws::{normals, uniform};
//!
//! fn broken(x: &[f64], rng: &mut BlockRng) -> Vec<f64> {
//!     let y = x[0] * normals(1, rng)[0].exp();
//!     if uniform(rng).ln() < x[0] - y { vec![y] } else { x.to_vec() }
//! }
//! # let _ = broken;
//! ```
//!
//! It runs, its chains mix, R̂ is 1.00, and the mean is wrong by a lot: the proposal is not symmetric, and the ratio q(x | y) / q(y | x) = y / x is missing.
//!
//! # Catching it
//!
//! The target can be drawn from exactly ([`crate::targets::HalfLine`]), so [`crate::exact_start`] is the test to begin with:
//!
//! ```
//! # use sinew_core::random::BlockRng;
//! # use sinew_invariance::draws::{normals, uniform};
//! # fn broken(x: &[f64], rng: &mut BlockRng) -> Vec<f64> {
//! #     let y = x[0] * normals(1, rng)[0].exp();
//! #     if uniform(rng).ln() < x[0] - y { vec![y] } else { x.to_vec() }
//! # }
//! use sinew_invariance::targets::{ExactTarget, HalfLine};
//! use sinew_invariance::{ExactStart, TestFunctions, exact_start};
//!
//! let target = HalfLine { rate: vec![1.0] };
//! let report = exact_start(&ExactStart::default(), |rng| target.draw(rng), broken, &TestFunctions::moments(1));
//! assert!(!report.holds());
//! println!("{report}");
//! ```
//!
//! prints
//!
//! ```text
#![doc = include_str!("guide/broken.txt")]
//! ```
//!
//! # Mending it
//!
//! ```
//! # use sinew_core::random::BlockRng;
//! # use sinew_invariance::draws::{normals, uniform};
//! # use sinew_invariance::targets::{ExactTarget, HalfLine};
//! # use sinew_invariance::{ExactStart, LongRun, TestFunctions, exact_start, long_run};
//! fn mended(x: &[f64], rng: &mut BlockRng) -> Vec<f64> {
//!     let y = x[0] * normals(1, rng)[0].exp();
//!     let proposals = (y / x[0]).ln();
//!     if uniform(rng).ln() < x[0] - y + proposals { vec![y] } else { x.to_vec() }
//! }
//!
//! let target = HalfLine { rate: vec![1.0] };
//! exact_start(&ExactStart::default(), |rng| target.draw(rng), mended, &TestFunctions::moments(1)).assert_holds();
//!
//! // Keeping the target is half of it; the other half is to get there. E x = 1, E x² = 2.
//! let starts = [vec![0.01], vec![0.1], vec![3.0], vec![10.0]];
//! long_run(&LongRun::default(), &starts, mended, &TestFunctions::moments(1), &[1.0, 2.0]).assert_holds();
//! ```
//!
//! # When the target has no exact draws
//!
//! A posterior can be drawn from jointly with its data: draw the parameters from the prior, then data given them. That is all that [`crate::geweke`] and [`crate::calibration()`] need. Here the mean θ ~ N(0, 1) of five observations of variance 1,
//! sampled by a kernel that believes in a variance of 0.5:
//!
//! ```
//! use sinew_core::random::BlockRng;
//! use sinew_invariance::draws::{normals, uniform};
//! use sinew_invariance::{Geweke, TestFunctions, geweke};
//!
//! let kernel = |believed: f64| {
//!     move |theta: &[f64], y: &[f64], rng: &mut BlockRng| {
//!         let log_density = |t: f64| -0.5 * t * t - y.iter().map(|y| (y - t).powi(2)).sum::<f64>() / (2.0 * believed);
//!         let proposed = theta[0] + normals(1, rng)[0];
//!         if uniform(rng).ln() < log_density(proposed) - log_density(theta[0]) { vec![proposed] } else { theta.to_vec() }
//!     }
//! };
//! let simulate = |theta: &[f64], rng: &mut BlockRng| normals(5, rng).iter().map(|z| theta[0] + z).collect();
//! let functions = || TestFunctions::moments(1).with("misfit", |x| x[1..].iter().map(|y| (y - x[0]).powi(2)).sum());
//! let prior = |rng: &mut BlockRng| normals(1, rng);
//! geweke(&Geweke::default(), prior, simulate, kernel(1.0), &functions()).assert_holds();
//! geweke(&Geweke::default(), prior, simulate, kernel(0.5), &functions()).assert_fails();
//! ```
//!
//! # Choosing sizes
//!
//! - A report that holds says what it would have seen ([`crate::Report::detectable`]); four times the starts see half of that. A kernel whose own mean is off by δ standard deviations is seen, nine times in ten, by about
//!   45 / ((1 − ρ) δ²) starts, ρ the correlation of a test function before and after the steps: 4500 for a tenth where nothing is left of it.
//! - A kernel that errs a little at each step errs more after several: raise `steps`.
//! - Add the log density as a test function: it pools all coordinates, and an error of scale shows there first.
//! - In a suite, keep seeds fixed and sizes small; once a night, turn the seed and multiply the sizes.
