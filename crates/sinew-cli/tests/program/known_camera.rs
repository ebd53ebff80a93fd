//! `sinew predict` of a linear Gaussian recording: what a third camera should see, by the formulas of what is known.

use crate::common::known_answers::{Said, constants, drawn, run};
use crate::common::linear_world::{FPS, POINTS, SCALE, Script, World, numbers};
use crate::common::path_posterior::DIM;
use crate::common::tally::Tally;

/// `sinew predict`: what camera C should see, which looks along y as A does. Its errors have the scales that the set-up draws of the other cameras' errors, but for its calibration, whose scale is 0 here.
#[test]
fn predictions_of_a_camera_are_exact() {
    let (hips, trunk, legs, late) = (0.008, 0.015, 0.011, 0.01);
    let scales = vec![("bias_hips_m", hips), ("bias_trunk_m", trunk), ("bias_legs_m", legs), ("lags_s", late)];
    let mut tally = Tally::default();
    const KEPT: usize = 2048;
    for seed in 1..=8 {
        let world = World::new(Script { seed, lasting: constants(16), scales: scales.clone(), ..Script::default() });
        let trial = world.write();
        run(&world, &trial, "out", &["--draws=2048"]);
        let output = trial.run(&["predict", "out", "--calibration=Calib.toml", "--camera=C", "-opredicted.csv"]);
        assert!(output.status.success(), "{}", trial.printed(&output));
        tally.begin_run();
        // A bias is heavy-tailed: its variance is twice the square of its scale. Scatter of 2 pixels, a model error of half a pixel.
        let alone = |point: usize| 2.0 * (SCALE * [hips, hips, trunk, trunk, legs, legs][point]).powi(2) + 4.0 + 0.25;
        let seen = Seen::of(&world, alone, 2.0 * late * late);
        let found = ["u", "v", "uu", "uv", "vv", "common_uu", "common_uv", "common_vv"]
            .map(|name| numbers(&trial, "predicted.csv", name));
        assert_eq!(found[0].len(), seen.pixels.len());
        for (k, pixel) in seen.pixels.iter().enumerate() {
            let [u, v, uu, uv, vv, shared_uu, shared_uv, shared_vv] = std::array::from_fn(|column| found[column][k]);
            let (total, own) = (pixel.total, pixel.own);
            let scatter = (total[0] * total[2]).sqrt();
            tally.place("predicted.csv: u", u, pixel.mean[0], total[0].sqrt(), KEPT);
            tally.place("predicted.csv: v", v, pixel.mean[1], total[2].sqrt(), KEPT);
            tally.width("predicted.csv: uu", uu.sqrt(), total[0].sqrt());
            tally.width("predicted.csv: vv", vv.sqrt(), total[2].sqrt());
            tally.place("predicted.csv: uv", uv, total[1], scatter, KEPT);
            tally.width("predicted.csv: uu − common_uu", (uu - shared_uu).sqrt(), own[0].sqrt());
            tally.width("predicted.csv: vv − common_vv", (vv - shared_vv).sqrt(), own[2].sqrt());
            tally.place("predicted.csv: uv − common_uv", uv - shared_uv, own[1], scatter, KEPT);
        }
    }
    tally.check();
}

/// What a camera that looks along y sees of a keypoint.
struct Pixel {
    mean: [f64; 2],
    /// Covariance uu, uv, vv.
    total: [f64; 3],
    /// The same without what all keypoints share in all frames.
    own: [f64; 3],
}

struct Seen {
    /// Frame after frame, keypoint after keypoint.
    pixels: Vec<Pixel>,
}

impl Seen {
    /// From filtered states: those of different frames are drawn apart, but for the draw of what is constant. `alone` is the variance that each keypoint has beside them, `late` the variance of the camera's lag.
    fn of(world: &World, alone: impl Fn(usize) -> f64, late: f64) -> Self {
        let frames = world.script.frames;
        let said: Vec<Said<'_>> = (0..frames).map(|frame| Said::new(world, frame)).collect();
        let draws = said[0].moves.len();
        // u grows with x, v falls with z.
        let (scales, axes) = ([SCALE, -SCALE], [0, 2]);
        let linear = |point: usize, a: usize| world.by_state(point, axes[a]).map(|by| scales[a] * by);
        let in_draw = |frame: usize, point: usize, a: usize| {
            let place = format!("body.{}.place_{}_m", POINTS[point].0, ["x", "y", "z"][axes[a]]);
            let mixture = said[frame].point(frame, point, axes[a], |draw| drawn(world, &place, draw, true));
            mixture.means.iter().map(|x| 10_000.0 + scales[a] * x).collect::<Vec<f64>>()
        };
        let all: Vec<(usize, usize)> =
            (0..frames).flat_map(|frame| (0..POINTS.len()).map(move |point| (frame, point))).collect();
        let means: Vec<[Vec<f64>; 2]> =
            all.iter().map(|(frame, point)| [0, 1].map(|a| in_draw(*frame, *point, a))).collect();
        let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
        let flow = |frame: usize, point: usize, a: usize| {
            let (before, after) = (frame.saturating_sub(1), (frame + 1).min(frames - 1));
            let at = |frame: usize| mean(&means[frame * POINTS.len() + point][a]);
            (at(after) - at(before)) * FPS / (after - before) as f64
        };
        let flows: Vec<[f64; 2]> = all.iter().map(|(frame, point)| [0, 1].map(|a| flow(*frame, *point, a))).collect();
        let covariance = |frame: usize, a: &[f64; DIM], b: &[f64; DIM]| {
            let cells = (0..DIM).flat_map(|i| (0..DIM).map(move |j| (i, j)));
            cells.map(|(i, j)| a[i] * b[j] * said[frame].path.covariance[DIM * frame + i][DIM * frame + j]).sum::<f64>()
        };
        let between = |a: &[f64], b: &[f64]| {
            a.iter().zip(b).map(|(x, y)| (x - mean(a)) * (y - mean(b))).sum::<f64>() / draws as f64
        };
        let pairs = [(0, 0), (0, 1), (1, 1)];
        let beside = |point: usize| [alone(point), 0.0, alone(point)];
        let total = |k: usize| {
            let (frame, point) = all[k];
            let of = |a: usize, b: usize| {
                covariance(frame, &linear(point, a), &linear(point, b))
                    + between(&means[k][a], &means[k][b])
                    + late * flows[k][a] * flows[k][b]
            };
            std::array::from_fn(|pair: usize| of(pairs[pair].0, pairs[pair].1) + beside(point)[pair])
        };
        let totals: Vec<[f64; 3]> = (0..all.len()).map(total).collect();
        // What all share is a mean with weights by what is known.
        let weights: Vec<f64> = totals.iter().map(|[uu, _, vv]| 1.0 / (uu + vv)).collect();
        let sum: f64 = weights.iter().sum();
        let shared = |what: &dyn Fn(usize) -> f64| (0..all.len()).map(|k| weights[k] / sum * what(k)).sum::<f64>();
        let shared_means: [Vec<f64>; 2] =
            [0, 1].map(|a| (0..draws).map(|draw| shared(&|k| means[k][a][draw])).collect());
        let shared_flow = [0, 1].map(|a: usize| shared(&|k| flows[k][a]));
        let shared_linear = |frame: usize, a: usize| -> [f64; DIM] {
            std::array::from_fn(|i| shared(&|k| if all[k].0 == frame { linear(all[k].1, a)[i] } else { 0.0 }))
        };
        let shared_linear: Vec<[[f64; DIM]; 2]> =
            (0..frames).map(|frame| [0, 1].map(|a| shared_linear(frame, a))).collect();
        let own = |k: usize| {
            let (frame, point) = all[k];
            let apart = |other: usize, a: usize| -> [f64; DIM] {
                std::array::from_fn(
                    |i| if other == frame { linear(point, a)[i] } else { 0.0 } - shared_linear[other][a][i],
                )
            };
            let less = |a: usize| means[k][a].iter().zip(&shared_means[a]).map(|(x, y)| x - y).collect::<Vec<f64>>();
            let of = |a: usize, b: usize| {
                let drawn: f64 = (0..frames).map(|other| covariance(other, &apart(other, a), &apart(other, b))).sum();
                drawn
                    + between(&less(a), &less(b))
                    + late * (flows[k][a] - shared_flow[a]) * (flows[k][b] - shared_flow[b])
            };
            std::array::from_fn(|pair: usize| of(pairs[pair].0, pairs[pair].1) + beside(point)[pair])
        };
        let pixel = |k: usize| Pixel { mean: [0, 1].map(|a| mean(&means[k][a])), total: totals[k], own: own(k) };
        Self { pixels: (0..all.len()).map(pixel).collect() }
    }
}
