//! Two recordings that share some numbers, against the posterior of both at once.

use faer::Mat;
use faer::linalg::solvers::DenseSolveCore;
use sinew_core::random::Stage;
use sinew_dynamics::lasting_scales::{
    HeldDraws, LastingData, LastingPrior, PriorCluster, SweepSchedule, draws, draws_given,
};
use sinew_dynamics::shared_numbers::{disagreement, said_of, together};

/// Shared numbers, and numbers of a recording's own.
const SHARED: usize = 2;
const OWN: usize = 3;
const ALL: usize = SHARED + OWN;

fn known(numbers: Vec<(usize, f64, f64)>) -> LastingPrior {
    LastingPrior { clusters: vec![PriorCluster { numbers, scale: None, heavy_tails: false, tied: 0 }], scales: vec![] }
}

/// Prior of a recording's numbers, the shared ones first.
fn prior() -> LastingPrior {
    known((0..ALL).map(|i| (i, 0.3 - 0.2 * i as f64, 0.5 + 0.1 * i as f64)).collect())
}

/// Four observations of a recording: fewer than its numbers.
fn data(recording: usize) -> LastingData {
    let (mut information, mut pull) = (vec![0.0; ALL * ALL], vec![0.0; ALL]);
    for row in 0..4 {
        let design: Vec<f64> = (0..ALL).map(|j| (1.7 * (recording * 50 + row * 8 + j) as f64).sin()).collect();
        let seen = (2.3 * (recording * 9 + row) as f64).cos();
        for (i, a) in design.iter().enumerate() {
            pull[i] += 4.0 * a * seen;
            design.iter().enumerate().for_each(|(j, b)| information[i * ALL + j] += 4.0 * a * b);
        }
    }
    LastingData { information, pull }
}

/// Mean and covariance of the shared numbers, then of each recording's own, by one solution for all.
fn exact() -> (Vec<f64>, Mat<f64>) {
    let count = SHARED + 2 * OWN;
    let place = |recording: usize, i: usize| if i < SHARED { i } else { i + recording * OWN };
    let (mut information, mut pull) = (Mat::<f64>::zeros(count, count), Mat::<f64>::zeros(count, 1));
    for recording in 0..2 {
        let said = data(recording);
        for i in 0..ALL {
            pull[(place(recording, i), 0)] += said.pull[i];
            for j in 0..ALL {
                information[(place(recording, i), place(recording, j))] += said.information[i * ALL + j];
            }
        }
        for &(i, mean, unit) in &prior().clusters[0].numbers {
            if recording == 0 || i >= SHARED {
                information[(place(recording, i), place(recording, i))] += unit.powi(-2);
                pull[(place(recording, i), 0)] += unit.powi(-2) * mean;
            }
        }
    }
    let covariance = information.partial_piv_lu().inverse();
    let mean = &covariance * &pull;
    ((0..count).map(|i| mean[(i, 0)]).collect(), covariance)
}

fn said() -> LastingData {
    let each = [0, 1].map(|recording| said_of(&data(recording), &prior(), &[], &(0..SHARED)).expect("a posterior"));
    together(&each).expect("two")
}

#[test]
fn the_sum_of_information_is_that_of_the_joint_posterior() {
    let (mean, covariance) = exact();
    let said = said();
    let mut information = Mat::from_fn(SHARED, SHARED, |i, j| said.information[i * SHARED + j]);
    let mut pull = Mat::from_fn(SHARED, 1, |i, _| said.pull[i]);
    for &(i, mean, unit) in &prior().clusters[0].numbers[..SHARED] {
        information[(i, i)] += unit.powi(-2);
        pull[(i, 0)] += unit.powi(-2) * mean;
    }
    let found = information.partial_piv_lu().inverse();
    let found_mean = &found * &pull;
    for i in 0..SHARED {
        assert!((found_mean[(i, 0)] - mean[i]).abs() < 1e-9, "mean of {i}");
        (0..SHARED).for_each(|j| assert!((found[(i, j)] - covariance[(i, j)]).abs() < 1e-9, "covariance of {i}, {j}"));
    }
}

/// Draws of the shared numbers, then of each recording's own given them: moments of the joint posterior, also between recordings.
#[test]
fn draws_of_each_belong_to_the_same_draws_of_what_is_shared() {
    const DRAWS: usize = 40_000;
    let schedule = SweepSchedule { draws: DRAWS, burn_in: 2, apart: 1 };
    let shared = known(prior().clusters[0].numbers[..SHARED].to_vec());
    let held = draws(&said(), &shared, schedule, Stage::new(1, "shared")).expect("a posterior").errors;
    let held = HeldDraws { places: 0..SHARED, draws: held };
    let own = [0, 1].map(|recording| {
        let stage = Stage::new(2 + recording as u64, "own");
        draws_given(&data(recording), &prior(), schedule, stage, Some(&held)).expect("a posterior").errors
    });
    let joint = |draw: usize| [&own[0][draw][..], &own[1][draw][SHARED..]].concat();
    let all: Vec<Vec<f64>> = (0..DRAWS).map(joint).collect();
    let (mean, covariance) = exact();
    assert_eq!(own[0][7][..SHARED], held.draws[7][..], "what is held stays where it is");
    let of = |f: &dyn Fn(&[f64]) -> f64| all.iter().map(|draw| f(draw)).sum::<f64>() / DRAWS as f64;
    for i in 0..mean.len() {
        let sd = covariance[(i, i)].sqrt();
        assert!((of(&|g| g[i]) - mean[i]).abs() < 0.03 * sd, "mean of {i}");
        for j in 0..mean.len() {
            let found = of(&|g| (g[i] - mean[i]) * (g[j] - mean[j]));
            let unit = sd * covariance[(j, j)].sqrt();
            assert!((found - covariance[(i, j)]).abs() < 0.03 * unit, "covariance of {i}, {j}");
        }
    }
}

/// Two that know a number as well and one unit apart are half a unit from what both say; a third number is known to neither.
#[test]
fn disagreement_is_what_no_common_value_explains() {
    let says = |at: f64| LastingData {
        information: vec![4.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
        pull: vec![4.0 * at, 0.3, 0.0],
    };
    let found = disagreement(&[says(0.0), says(1.0)], &[2.0, 1.0, 1.0]).expect("known");
    assert!((found.square - 2.0).abs() < 1e-12 && found.degrees == 2 && !found.is_gross(), "{found:?}");
    assert!(disagreement(&[says(0.0), says(4.0)], &[2.0, 1.0, 1.0]).expect("known").is_gross());
    assert_eq!(disagreement(&[says(1.0)], &[1.0; 3]).expect("known").degrees, 0);
}
