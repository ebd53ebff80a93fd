//! Parameters that last over a run, carried beside a filter, against one filter of both together.

use faer::linalg::solvers::{DenseSolveCore, Solve};
use faer::{Mat, MatRef, Side};
use sinew_core::lanes::{Block, Isa, LANES, numbers, numbers_mut};
use sinew_core::transition::Moments;
use sinew_dynamics::kalman::{Filtered, Form, Kalman, Model};
use sinew_dynamics::lasting::{FrameInformation, Lasting, widened};
use sinew_dynamics::lasting_draws::LastingMoves;
use sinew_dynamics::linearised_filter::LinearisedFilter;
use sinew_dynamics::smoother::Smoother;

const D: usize = 3;
const K: usize = 4;
const P: usize = 5;
const FRAMES: usize = 12;

/// How observations answer to what lasts, K × P.
fn answer() -> Vec<f64> {
    (0..K * P).map(|e| (0.7 * e as f64 + 0.4).sin()).collect()
}

/// Of a state that moves little from frame to frame, so that a frame inherits most of what it knows.
fn model() -> Model {
    Model {
        dim: D,
        matrix: vec![1.0, 0.1, 0.0, 0.0, 0.95, -0.1, 0.02, 0.0, 1.0],
        noise: vec![0.02, 0.005, 0.0, 0.005, 0.03, 0.004, 0.0, 0.004, 0.01],
        observation: (0..K * D).map(|e| (1.3 * e as f64).cos()).collect(),
        error: (0..K * K).map(|e| if e % (K + 1) == 0 { 0.5 } else { 0.1 }).collect(),
    }
}

fn start() -> Moments {
    Moments { mean: vec![0.5, -1.0, 2.0], covariance: vec![0.4, 0.1, 0.0, 0.1, 0.3, 0.05, 0.0, 0.05, 0.2] }
}

/// Λ₀⁻¹.
fn prior() -> Vec<f64> {
    (0..P * P).map(|e| if e % (P + 1) == 0 { 0.3 + 0.1 * (e / P) as f64 } else { 0.05 }).collect()
}

fn observations() -> Vec<Vec<Option<f64>>> {
    let z = |t: usize, i: usize| 2.0 * (1.3 * t as f64 + 2.0 * i as f64).sin();
    (0..FRAMES).map(|t| (0..K).map(|i| Some(z(t, i)).filter(|_| (t + 2 * i) % 7 != 3 && t != 6)).collect()).collect()
}

fn matrix(rows: &[f64], width: usize) -> MatRef<'_, f64> {
    MatRef::from_row_major_slice(rows, rows.len() / width, width)
}

fn rows(m: MatRef<'_, f64>) -> Vec<f64> {
    (0..m.nrows() * m.ncols()).map(|e| m[(e / m.ncols(), e % m.ncols())]).collect()
}

/// The model whose state holds what lasts, too.
fn together() -> (Model, Moments) {
    let Model { matrix: a, noise, observation, error, .. } = model();
    let size = D + P;
    let block = |top: &[f64], still: f64| -> Vec<f64> {
        let entry = |i: usize, j: usize| match (i < D, j < D) {
            (true, true) => top[i * D + j],
            (false, false) if i == j => still,
            _ => 0.0,
        };
        (0..size * size).map(|e| entry(e / size, e % size)).collect()
    };
    let answer = answer();
    let seen = |i: usize, j: usize| if j < D { observation[i * D + j] } else { answer[i * P + j - D] };
    let model = Model {
        dim: size,
        matrix: block(&a, 1.0),
        noise: block(&noise, 0.0),
        observation: (0..K * size).map(|e| seen(e / size, e % size)).collect(),
        error,
    };
    let mut covariance = block(&start().covariance, 0.0);
    let prior = prior();
    (0..P * P).for_each(|e| covariance[(D + e / P) * size + D + e % P] = prior[e]);
    (model, Moments { mean: [start().mean, vec![0.0; P]].concat(), covariance })
}

/// Part of moments, from `first` on.
fn part(moments: &Moments, first: usize, count: usize) -> Moments {
    let size = moments.mean.len();
    let entry = |e: usize| moments.covariance[(first + e / count) * size + first + e % count];
    Moments { mean: moments.mean[first..first + count].to_vec(), covariance: (0..count * count).map(entry).collect() }
}

fn near(found: &Moments, expected: &Moments) {
    let pairs = found.mean.iter().zip(&expected.mean).chain(found.covariance.iter().zip(&expected.covariance));
    pairs.for_each(|(f, e)| assert!((f - e).abs() < 1e-10, "{found:?} for {expected:?}"));
}

/// What a frame says, from the sensors that it has.
fn information(z: &[Option<f64>], predicted: &Moments) -> FrameInformation {
    let Model { observation, error, .. } = model();
    let seen: Vec<usize> = (0..K).filter(|&i| z[i].is_some()).collect();
    let n = seen.len();
    let answer = answer();
    let h = Mat::from_fn(n, D, |i, j| observation[seen[i] * D + j]);
    let g = Mat::from_fn(n, P, |i, j| answer[seen[i] * P + j]);
    let r = Mat::from_fn(n, n, |i, j| error[seen[i] * K + seen[j]]);
    let innovation = Mat::from_fn(n, 1, |i, _| {
        z[seen[i]].unwrap_or_default() - (0..D).map(|j| h[(i, j)] * predicted.mean[j]).sum::<f64>()
    });
    if n == 0 {
        let none = |length| vec![0.0; length];
        return FrameInformation {
            state: none(D * D),
            between: none(D * P),
            lasting: vec![],
            state_pull: none(D),
            lasting_pull: none(P),
        };
    }
    let factor = r.llt(Side::Lower).unwrap();
    let (hr, gr) = (factor.solve(&h).transpose().to_owned(), factor.solve(&g).transpose().to_owned());
    let mut whitened = g.clone();
    factor.L().solve_lower_triangular_in_place(whitened.as_mut());
    FrameInformation {
        state: rows((&hr * &h).as_ref()),
        between: rows((&hr * &g).as_ref()),
        lasting: (0..n).map(|i| (0..P).map(|j| (j, whitened[(i, j)])).collect()).collect(),
        state_pull: rows((&hr * &innovation).as_ref()),
        lasting_pull: rows((&gr * &innovation).as_ref()),
    }
}

/// Frames of the filter that knows nothing of what lasts, and what is carried beside it after each; `inherits` is false where a frame's response is its own alone.
fn beside(inherits: bool) -> (Vec<Filtered>, Vec<Lasting>) {
    let filter = Kalman::new(model(), Form::Joseph).unwrap();
    let frames = filter.filter(&start(), &observations()).unwrap();
    let mut lasting = Lasting::new(D, P, &prior()).unwrap();
    let mut after = vec![];
    for (t, (frame, z)) in frames.iter().zip(observations()).enumerate() {
        match (t > 0, inherits) {
            (false, _) => {}
            (true, true) => lasting.predict(&model().matrix).unwrap(),
            (true, false) => lasting.restart(),
        }
        lasting.update(&frame.filtered.covariance, &information(&z, &frame.predicted)).unwrap();
        after.push(lasting.clone());
    }
    (frames, after)
}

#[test]
fn filtered_moments_and_what_lasts_agree_with_one_filter_of_both() {
    let (model, start) = together();
    let exact = Kalman::new(model, Form::SquareRoot).unwrap().filter(&start, &observations()).unwrap();
    let (frames, lasting) = beside(true);
    for ((exact, frame), lasting) in exact.iter().zip(&frames).zip(&lasting) {
        let posterior = lasting.posterior().unwrap();
        near(&posterior, &part(&exact.filtered, D, P));
        near(&lasting.total(&frame.filtered, &posterior).unwrap(), &part(&exact.filtered, 0, D));
    }
}

#[test]
fn smoothed_moments_agree_with_one_filter_of_both() {
    let (both, start) = together();
    let filter = Kalman::new(both, Form::Joseph).unwrap();
    let exact = filter.smooth(&filter.filter(&start, &observations()).unwrap()).unwrap();
    let (frames, lasting) = beside(true);
    let alone = Kalman::new(model(), Form::Joseph).unwrap().smooth(&frames).unwrap();
    let posterior = lasting[FRAMES - 1].posterior().unwrap();
    let Model { matrix: motion, .. } = model();
    let mut response = lasting[FRAMES - 1].response();
    for t in (0..FRAMES).rev() {
        if t + 1 < FRAMES {
            // C_t = P_t Fᵀ (P⁻_{t+1})⁻¹.
            let ahead = matrix(&frames[t + 1].predicted.covariance, D).to_owned();
            let across = matrix(&motion, D) * matrix(&frames[t].filtered.covariance, D);
            let gain = ahead.partial_piv_lu().solve(&across);
            response = lasting[t].smoothed(&rows(gain.transpose()), &motion, &response).unwrap();
        }
        near(&widened(&response, &alone[t], &posterior).unwrap(), &part(&exact[t], 0, D));
    }
}

/// What the frame alone says of its response is far from what it inherits: a widening by it would be too narrow.
#[test]
fn a_frames_own_response_is_not_enough() {
    let [inherited, own] = [true, false].map(|inherits| {
        let (frames, lasting) = beside(inherits);
        let last = FRAMES - 1;
        let posterior = beside(true).1[last].posterior().unwrap();
        let total = lasting[last].total(&frames[last].filtered, &posterior).unwrap();
        (0..D).map(|j| total.covariance[j * (D + 1)] - frames[last].filtered.covariance[j * (D + 1)]).sum::<f64>()
    });
    assert!(own < 0.5 * inherited, "{own} of {inherited}");
}

#[test]
fn sizes_that_do_not_fit_are_refused_by_name() {
    use sinew_dynamics::Error;
    let shape = |found: Result<(), Error>, expected: &str| {
        assert!(matches!(&found, Err(Error::Shape { name, .. }) if *name == expected), "{found:?}");
    };
    shape(Lasting::new(0, P, &prior()).map(drop), "state");
    shape(Lasting::new(D, 0, &[]).map(drop), "what lasts");
    shape(Lasting::new(D, P, &prior()[1..]).map(drop), "covariance of what lasts");
    let mut lasting = Lasting::new(D, P, &prior()).unwrap();
    shape(lasting.predict(&[1.0]), "motion");
    let frame = information(&observations()[0], &start());
    shape(lasting.update(&[1.0], &frame), "filtered covariance");
    let short = FrameInformation { between: vec![0.0; D], ..frame.clone() };
    shape(lasting.update(&start().covariance, &short), "information between state and what lasts");
    let beyond = FrameInformation { lasting: vec![vec![(P, 1.0)]], ..frame.clone() };
    shape(lasting.update(&start().covariance, &beyond), "row of what lasts");
    let bad = FrameInformation { lasting_pull: vec![f64::NAN; P], ..frame };
    let refused = lasting.update(&start().covariance, &bad);
    assert!(matches!(refused, Err(Error::OutOfRange { name: "pull of what lasts", index: 0, .. })), "{refused:?}");
}

/// A random walk: what is carried for some draws is the whole response times each of them, filtered and smoothed.
#[test]
fn draws_move_as_the_response_says() {
    const DRAWS: usize = 16;
    let variances = [0.02, 0.05, 0.01];
    let identity: Vec<f64> = (0..D * D).map(|e| if e % (D + 1) == 0 { 1.0 } else { 0.0 }).collect();
    let noise: Vec<f64> = (0..D * D).map(|e| if e % (D + 1) == 0 { variances[e / D] } else { 0.0 }).collect();
    let walk = Model { matrix: identity.clone(), noise, ..model() };
    let begins: Vec<f64> = (0..D * D).map(|e| if e % (D + 1) == 0 { 0.3 } else { 0.0 }).collect();
    let begin = Moments { mean: start().mean, covariance: begins };
    let frames = Kalman::new(walk, Form::Joseph).unwrap().filter(&begin, &observations()).unwrap();
    let deviations: Vec<f64> = (0..P * DRAWS).map(|e| (2.3 * e as f64).cos()).collect();
    let expected = |response: &[f64]| rows((matrix(response, P) * matrix(&deviations, DRAWS)).as_ref());
    let agree = |found: &[f64], expected: &[f64]| {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-10), "{found:?} for {expected:?}");
    };
    let mut whole = Lasting::new(D, P, &prior()).unwrap();
    let mut drawn = LastingMoves::new(D, DRAWS / LANES, Isa::best());
    let mut filter = LinearisedFilter::new(&[0.3; D]);
    let mut after = vec![];
    for (t, (frame, z)) in frames.iter().zip(observations()).enumerate() {
        let said = information(&z, &frame.predicted);
        if t > 0 {
            whole.predict(&identity).unwrap();
            filter.predict(&variances);
        }
        if t == 5 {
            let mut resumed = LastingMoves::new(D, DRAWS / LANES, Isa::best());
            resumed.restore(&drawn.save()).unwrap();
            drawn = resumed;
            let mut resumed = LinearisedFilter::new(&[9.0; D]);
            resumed.restore(&filter.covariance()).unwrap();
            filter = resumed;
        }
        whole.update(&frame.filtered.covariance, &said).unwrap();
        filter.update(&said.state).unwrap();
        agree(&filter.covariance(), &frame.filtered.covariance);
        let mut pull = vec![Block::ZERO; D * DRAWS / LANES];
        numbers_mut(&mut pull).copy_from_slice(&rows((matrix(&said.between, P) * matrix(&deviations, DRAWS)).as_ref()));
        drawn.update(&filter.covariance(), &said.state, pull).unwrap();
        agree(numbers(drawn.moves()), &expected(&whole.response()));
        after.push((whole.clone(), numbers(drawn.moves()).to_vec()));
    }
    let smoother = Smoother::random_walk(&variances.map(f64::sqrt));
    let (last, _) = &after[FRAMES - 1];
    let (mut response, mut moves) = (last.response(), after[FRAMES - 1].1.clone());
    for t in (0..FRAMES - 1).rev() {
        let filtered = &frames[t].filtered;
        let total: Vec<f64> = filtered
            .covariance
            .iter()
            .enumerate()
            .map(|(e, x)| x + if e % (D + 1) == 0 { variances[e / D] } else { 0.0 })
            .collect();
        let gain =
            rows((matrix(&filtered.covariance, D) * matrix(&total, D).llt(Side::Lower).unwrap().inverse()).as_ref());
        response = after[t].0.smoothed(&gain, &identity, &response).unwrap();
        moves = smoother.changes(filtered, &after[t].1, &moves).unwrap();
        agree(&moves, &expected(&response));
    }
    assert!(drawn.restore(&[0.0; 4]).is_err());
    drawn.restart();
    assert!(drawn.moves().iter().all(|x| *x == Block::ZERO));
}
