//! A world in which all is known: what `sinew track` writes of a linear Gaussian recording is what one Gaussian of all its states says.

use crate::common::Trial;
use crate::common::known_answers::{DEGREES, DRAWS, Mixture, Said, constants, drawn, run, unit, world_shift};
use crate::common::linear_world::{Constant, FPS, POINTS, Script, World, numbers};
use crate::common::path_posterior::{DIM, inverse};
use crate::common::tally::Tally;

/// Draws of which rates of filtered frames are made, and trajectories of a smoother.
const RATE_DRAWS: usize = 256;
const TRAJECTORIES: usize = 128;

/// What a run promises to know of the frames after each.
#[derive(Clone, Copy, PartialEq)]
enum Knows {
    Past,
    /// So many frames; all for large numbers.
    Later(usize),
}

impl Knows {
    /// The last frame that is known.
    fn last(self, frame: usize) -> usize {
        match self {
            Self::Past => frame,
            Self::Later(frames) => frame + frames,
        }
    }

    /// First and last frame of the window over which angles change, two frames long.
    fn window(self, frame: usize, frames: usize) -> [usize; 2] {
        match self {
            Self::Past => [frame.saturating_sub(2), frame],
            Self::Later(_) => [frame.saturating_sub(1), (frame + 1).min(frames - 1)],
        }
    }

    /// Draws that points, angles and rates are described by.
    fn draws(self) -> [usize; 2] {
        match self {
            Self::Past => [DRAWS, RATE_DRAWS],
            Self::Later(_) => [TRAJECTORIES; 2],
        }
    }
}

/// Holds the tables of a run against the exact posterior.
fn hold(world: &World, trial: &Trial, out: &str, knows: Knows, tally: &mut Tally) {
    tally.begin_run();
    let (frames, dof) = (world.script.frames, world.dof());
    let column = |file: &str, name: &str| numbers(trial, &format!("{out}/{file}"), name);
    let state = ["mean", "q05", "q95"].map(|name| column("state.csv", name));
    let of_angles = ["mean_deg", "q05_deg", "q95_deg", "rate_mean_deg_s", "rate_q05_deg_s", "rate_q95_deg_s"];
    let angles = of_angles.map(|name| column("angles.csv", name));
    assert_eq!((state[0].len(), angles[0].len()), (dof * frames, (dof - 3) * frames));
    let of_points = |file| {
        let of_axis =
            |axis| ["mean", "sd", "q05", "q95", "sd_within"].map(|what| column(file, &format!("{axis}_{what}_m")));
        ["x", "y", "z"].map(of_axis)
    };
    let (joints, keypoints) = (of_points("joints.csv"), of_points("keypoints.csv"));
    let has_keypoints = !world.script.lasting.is_empty();
    assert_eq!(keypoints[0][0].len(), if has_keypoints { POINTS.len() * frames } else { 0 });
    let [draws, rate_draws] = knows.draws();
    // Smoothed means come from filtered moments of many frames, not from trajectories.
    let of_means = if knows == Knows::Past { draws } else { DRAWS / 3 };
    let mut said = Said::new(world, knows.last(0).min(frames - 1));
    for frame in 0..frames {
        let last = knows.last(frame).min(frames - 1);
        if DIM * (last + 1) != said.path.mean.len() {
            said = Said::new(world, last);
        }
        for number in 0..dof {
            let exact = said.number(frame, number);
            let (name, scale) = if number < 3 { ("state.csv, m", 1.0) } else { ("state.csv, deg", DEGREES) };
            let [mean, low, high] = [0, 1, 2].map(|k: usize| state[k][dof * frame + number] / scale);
            tally.place(&format!("{name}: mean"), mean, exact.mean(), exact.sd(), of_means);
            tally.interval(&format!("{name}: q05 to q95"), [low, high], exact.interval(), draws);
        }
        if world.script.turns {
            let exact = said.number(frame, 3);
            let [mean, low, high, rate, slow, fast] = [0, 1, 2, 3, 4, 5].map(|k: usize| angles[k][frame] / DEGREES);
            tally.place("angles.csv: mean_deg", mean, exact.mean(), exact.sd(), draws);
            tally.interval("angles.csv: q05_deg to q95_deg", [low, high], exact.interval(), draws);
            let [first, last] = knows.window(frame, frames);
            assert_eq!(rate.is_nan(), first == last);
            // Changes under errors that last some frames are wider than they are, by intent.
            if first < last && said.missing.is_none() {
                let a_second = FPS / (last - first) as f64;
                let exact = said.of(&[(last, unit(3, a_second)), (first, unit(3, -a_second))], |_| 0.0);
                tally.place("angles.csv: rate_mean_deg_s", rate, exact.mean(), exact.sd(), rate_draws);
                tally.interval(
                    "angles.csv: rate_q05_deg_s to rate_q95_deg_s",
                    [slow, fast],
                    exact.interval(),
                    rate_draws,
                );
            }
        }
        let shared: [Vec<f64>; 3] = if has_keypoints {
            let middle = |axis: usize| {
                let all = (0..POINTS.len()).map(|point| said.point(frame, point, axis, |_| 0.0).means);
                all.reduce(|a, b| a.iter().zip(b).map(|(a, b)| a + b).collect()).unwrap()
            };
            let shifts =
                [0, 1, 2].map(|axis| (0..middle(0).len()).map(|draw| world_shift(world, axis, draw)).collect());
            [0, 1, 2].map(|axis| followed(&middle(axis), &shifts).iter().map(|sum| sum / POINTS.len() as f64).collect())
        } else {
            Default::default()
        };
        for (point, (name, ..)) in POINTS.iter().enumerate() {
            for axis in 0..3 {
                let place = format!("body.{name}.place_{}_m", ["x", "y", "z"][axis]);
                let joint = said.point(frame, point, axis, |_| 0.0);
                let keypoint = said.point(frame, point, axis, |draw| drawn(world, &place, draw, true));
                let files = [("joints.csv", &joints, joint), ("keypoints.csv", &keypoints, keypoint)];
                for (file, found, exact) in files.into_iter().take(1 + usize::from(has_keypoints)) {
                    let [mean, sd, low, high, within] =
                        [0, 1, 2, 3, 4].map(|k: usize| found[axis][k][POINTS.len() * frame + point]);
                    tally.place(&format!("{file}: mean_m"), mean, exact.mean(), exact.sd(), draws);
                    tally.sd(&format!("{file}: sd_m"), sd, exact.sd(), draws);
                    tally.interval(&format!("{file}: q05_m to q95_m"), [low, high], exact.interval(), draws);
                    let shift = |draw: usize| shared[axis].get(draw).copied().unwrap_or(0.0);
                    let means = exact.means.iter().enumerate().map(|(draw, mean)| mean - shift(draw)).collect();
                    tally.sd(&format!("{file}: sd_within_m"), within, Mixture { means, ..exact }.sd(), draws);
                }
            }
        }
    }
}

/// The least-squares fit to a series over draws by others, all less their means; one that never changes explains nothing.
fn followed(series: &[f64], by: &[Vec<f64>; 3]) -> Vec<f64> {
    let centred = |series: &[f64]| -> Vec<f64> {
        let mean = series.iter().sum::<f64>() / series.len() as f64;
        series.iter().map(|x| x - mean).collect()
    };
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let series = centred(series);
    let by: Vec<Vec<f64>> = by.iter().map(|by| centred(by)).filter(|by| product(by, by) > 0.0).collect();
    let squares: Vec<Vec<f64>> = by.iter().map(|a| by.iter().map(|b| product(a, b)).collect()).collect();
    let (inverse, _) = inverse(&squares);
    let right: Vec<f64> = by.iter().map(|by| product(by, &series)).collect();
    let factors: Vec<f64> = inverse.iter().map(|row| product(row, &right)).collect();
    (0..series.len()).map(|draw| factors.iter().zip(&by).map(|(factor, by)| factor * by[draw]).sum()).collect()
}

/// Holds runs on worlds of some seeds.
fn check(seeds: u64, script: &Script, more: &[&str], knows: Knows) {
    let mut tally = Tally::default();
    for seed in 1..=seeds {
        let world = World::new(Script { seed, ..script.clone() });
        let trial = world.write();
        run(&world, &trial, "out", more);
        hold(&world, &trial, "out", knows, &mut tally);
    }
    tally.check();
}

#[test]
fn filtered_numbers_are_exact() {
    check(16, &Script::default(), &[], Knows::Past);
}

#[test]
fn smoothed_numbers_are_exact() {
    check(32, &Script::default(), &["--smooth"], Knows::Later(1000));
}

#[test]
fn numbers_of_a_fixed_lag_are_exact() {
    check(32, &Script::default(), &["--lag-frames=2"], Knows::Later(2));
}

#[test]
fn constants_are_mixed_over_their_draws() {
    check(16, &Script { lasting: constants(16), ..Script::default() }, &[], Knows::Past);
}

#[test]
fn smoothed_constants_are_mixed_over_their_draws() {
    check(32, &Script { lasting: constants(16), ..Script::default() }, &["--smooth"], Knows::Later(1000));
}

#[test]
fn errors_that_last_some_frames_widen_filtered_numbers() {
    let nothing = Constant { name: "A.lag_s".into(), value: 0.0, draws: vec![0.0; 128] };
    check(8, &Script { lasting: vec![nothing], persistence_s: 0.1, ..Script::default() }, &[], Knows::Past);
}

/// The last frame of a smoothed run knows no more than the filter does, and is as wide with what errors that last some frames add.
#[test]
fn errors_that_last_some_frames_widen_the_end_of_a_smoothed_run() {
    let nothing = Constant { name: "A.lag_s".into(), value: 0.0, draws: vec![0.0; 128] };
    let script = Script { lasting: vec![nothing], persistence_s: 0.1, ..Script::default() };
    let mut ratios = vec![];
    for seed in 1..=6 {
        let world = World::new(Script { seed, ..script.clone() });
        let trial = world.write();
        run(&world, &trial, "out", &["--smooth"]);
        let (last, points) = (world.script.frames - 1, POINTS.len());
        let said = Said::new(&world, last);
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let found = numbers(&trial, "out/joints.csv", &format!("{name}_sd_m"));
            let ratio = |point: usize| found[points * last + point] / said.point(last, point, axis, |_| 0.0).sd();
            ratios.extend((0..points).map(ratio));
        }
    }
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    assert!((mean - 1.0).abs() < 0.06, "{mean}");
}

/// The draws of the keypoints in `posterior.zarr` are moved by the constants as those that `keypoints.csv` describes.
#[test]
fn draws_of_keypoints_have_the_spread_of_the_table() {
    let mut ratios = vec![];
    for seed in 1..=4 {
        let world = World::new(Script { seed, lasting: constants(16), ..Script::default() });
        let trial = world.write();
        run(&world, &trial, "out", &[]);
        let found = sinew::predict::drawn(&trial.path("out"), "keypoint_position").unwrap();
        let [_, draws, frames, points, 3] = found.shape[..] else { panic!("{:?}", found.shape) };
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            for (place, sd) in numbers(&trial, "out/keypoints.csv", &format!("{name}_sd_m")).into_iter().enumerate() {
                let at = |draw: usize| found.values[(draw * frames * points + place) * 3 + axis];
                let mean = (0..draws).map(at).sum::<f64>() / draws as f64;
                let square = (0..draws).map(|draw| (at(draw) - mean).powi(2)).sum::<f64>() / (draws as f64 - 1.0);
                ratios.push(square / (sd * sd));
            }
        }
    }
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    assert!((mean - 1.0).abs() < 0.15, "{mean}");
}

#[test]
fn a_body_that_only_translates_is_tracked() {
    check(4, &Script { turns: false, ..Script::default() }, &[], Knows::Past);
}
