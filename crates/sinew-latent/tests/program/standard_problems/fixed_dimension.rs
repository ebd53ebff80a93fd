//! Standard problems in two, three, four and six variables.

use super::Problem;
use std::f64::consts::{PI, TAU};

const GAUSSIAN: [f64; 8] = [0.0009, 0.0044, 0.0175, 0.0540, 0.1295, 0.2420, 0.3521, 0.3989];
const BARD: [f64; 15] = [0.14, 0.18, 0.22, 0.25, 0.29, 0.32, 0.35, 0.39, 0.37, 0.58, 0.73, 0.96, 1.34, 2.10, 4.39];
const MEYER: [f64; 16] = [
    34780.0, 28610.0, 23650.0, 19630.0, 16370.0, 13720.0, 11540.0, 9744.0, 8261.0, 7030.0, 6005.0, 5147.0, 4427.0,
    3820.0, 3307.0, 2872.0,
];
const KOWALIK_OSBORNE: [(f64, f64); 11] = [
    (0.1957, 4.0),
    (0.1947, 2.0),
    (0.1735, 1.0),
    (0.1600, 0.5),
    (0.0844, 0.25),
    (0.0627, 0.167),
    (0.0456, 0.125),
    (0.0342, 0.1),
    (0.0323, 0.0833),
    (0.0235, 0.0714),
    (0.0246, 0.0625),
];

pub fn problems() -> Vec<Problem> {
    vec![
        Problem::new("2 Freudenstein–Roth", &[0.5, -2.0], 2, freudenstein_roth, 0.0),
        Problem::new("3 Powell badly scaled", &[0.0, 1.0], 2, powell_badly_scaled, 0.0),
        Problem::new("4 Brown badly scaled", &[1.0, 1.0], 3, brown_badly_scaled, 0.0),
        Problem::new("5 Beale", &[1.0, 1.0], 3, beale, 0.0),
        Problem::new("6 Jennrich–Sampson", &[0.3, 0.4], 10, jennrich_sampson, 124.362),
        Problem::new("7 helical valley", &[-1.0, 0.0, 0.0], 3, helical_valley, 0.0),
        Problem::new("8 Bard", &[1.0, 1.0, 1.0], 15, bard, 8.21487e-3),
        Problem::new("9 Gaussian", &[0.4, 1.0, 0.0], 15, gaussian, 1.12793e-8),
        Problem::new("10 Meyer", &[0.02, 4000.0, 250.0], 16, meyer, 87.9458),
        Problem::new("11 Gulf research", &[5.0, 2.5, 0.15], 99, gulf, 0.0),
        Problem::new("12 box three-dimensional", &[0.0, 10.0, 20.0], 10, box_three, 0.0),
        Problem::new("14 Wood", &[-3.0, -1.0, -3.0, -1.0], 6, wood, 0.0),
        Problem::new("15 Kowalik–Osborne", &[0.25, 0.39, 0.415, 0.39], 11, kowalik_osborne, 3.07505e-4),
        Problem::new("16 Brown–Dennis", &[25.0, 5.0, -5.0, -1.0], 20, brown_dennis, 85822.2),
        Problem::new("18 Biggs EXP6", &[1.0, 2.0, 1.0, 1.0, 1.0, 1.0], 13, biggs, 0.0),
    ]
}

fn freudenstein_roth(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let (a, b) = (x[0], x[1]);
    row[0] = 1.0;
    if i == 0 {
        row[1] = (10.0 - 3.0 * b) * b - 2.0;
        return -13.0 + a + ((5.0 - b) * b - 2.0) * b;
    }
    row[1] = (3.0 * b + 2.0) * b - 14.0;
    -29.0 + a + ((b + 1.0) * b - 14.0) * b
}

fn powell_badly_scaled(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    if i == 0 {
        row.copy_from_slice(&[1e4 * x[1], 1e4 * x[0]]);
        return 1e4 * x[0] * x[1] - 1.0;
    }
    row.copy_from_slice(&[-(-x[0]).exp(), -(-x[1]).exp()]);
    (-x[0]).exp() + (-x[1]).exp() - 1.0001
}

fn brown_badly_scaled(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    match i {
        0 => {
            row[0] = 1.0;
            x[0] - 1e6
        }
        1 => {
            row[1] = 1.0;
            x[1] - 2e-6
        }
        _ => {
            row.copy_from_slice(&[x[1], x[0]]);
            x[0] * x[1] - 2.0
        }
    }
}

fn beale(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let power = x[1].powi(i as i32);
    row.copy_from_slice(&[x[1] * power - 1.0, (i + 1) as f64 * x[0] * power]);
    [1.5, 2.25, 2.625][i] - x[0] * (1.0 - x[1] * power)
}

fn jennrich_sampson(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let k = (i + 1) as f64;
    let (a, b) = ((k * x[0]).exp(), (k * x[1]).exp());
    row.copy_from_slice(&[-k * a, -k * b]);
    2.0 + 2.0 * k - (a + b)
}

fn helical_valley(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let square = x[0] * x[0] + x[1] * x[1];
    match i {
        0 => {
            let turns = (x[1] / x[0]).atan() / TAU + if x[0] < 0.0 { 0.5 } else { 0.0 };
            row.copy_from_slice(&[100.0 * x[1] / (TAU * square), -50.0 * x[0] / (PI * square), 10.0]);
            10.0 * (x[2] - 10.0 * turns)
        }
        1 => {
            row[..2].copy_from_slice(&[10.0 * x[0] / square.sqrt(), 10.0 * x[1] / square.sqrt()]);
            10.0 * (square.sqrt() - 1.0)
        }
        _ => {
            row[2] = 1.0;
            x[2]
        }
    }
}

fn bard(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let (u, v) = ((i + 1) as f64, (15 - i) as f64);
    let w = u.min(v);
    let below = v * x[1] + w * x[2];
    row.copy_from_slice(&[-1.0, u * v / (below * below), u * w / (below * below)]);
    BARD[i] - (x[0] + u / below)
}

fn gaussian(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let offset = (7.0 - i as f64) / 2.0 - x[2];
    let bell = (-0.5 * x[1] * offset * offset).exp();
    row.copy_from_slice(&[bell, -0.5 * x[0] * bell * offset * offset, x[0] * bell * x[1] * offset]);
    x[0] * bell - GAUSSIAN[i.min(14 - i)]
}

fn meyer(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let below = 45.0 + 5.0 * (i + 1) as f64 + x[2];
    let growth = (x[1] / below).exp();
    row.copy_from_slice(&[growth, x[0] * growth / below, -x[0] * growth * x[1] / (below * below)]);
    x[0] * growth - MEYER[i]
}

fn gulf(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let t = (i + 1) as f64 / 100.0;
    let offset = 25.0 + (-50.0 * t.ln()).cbrt().powi(2) - x[1];
    let power = offset.abs().powf(x[2]) / x[0];
    let decay = (-power).exp();
    let pull = decay * power;
    row.copy_from_slice(&[pull / x[0], pull * x[2] / offset, -pull * offset.abs().ln()]);
    decay - t
}

fn box_three(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let t = (i + 1) as f64 / 10.0;
    let (a, b, c) = ((-t * x[0]).exp(), (-t * x[1]).exp(), (-t).exp() - (-10.0 * t).exp());
    row.copy_from_slice(&[-t * a, t * b, -c]);
    a - b - x[2] * c
}

fn wood(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let (steep, sum, difference) = (90.0_f64.sqrt(), 10.0_f64.sqrt(), 0.1_f64.sqrt());
    let (gradient, residual) = match i {
        0 => ([-20.0 * x[0], 10.0, 0.0, 0.0], 10.0 * (x[1] - x[0] * x[0])),
        1 => ([-1.0, 0.0, 0.0, 0.0], 1.0 - x[0]),
        2 => ([0.0, 0.0, -2.0 * steep * x[2], steep], steep * (x[3] - x[2] * x[2])),
        3 => ([0.0, 0.0, -1.0, 0.0], 1.0 - x[2]),
        4 => ([0.0, sum, 0.0, sum], sum * (x[1] + x[3] - 2.0)),
        _ => ([0.0, difference, 0.0, -difference], difference * (x[1] - x[3])),
    };
    row.copy_from_slice(&gradient);
    residual
}

fn kowalik_osborne(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let (y, u) = KOWALIK_OSBORNE[i];
    let (above, below) = (u * (u + x[1]), u * (u + x[2]) + x[3]);
    let ratio = above / below;
    row.copy_from_slice(&[-ratio, -x[0] * u / below, x[0] * ratio * u / below, x[0] * ratio / below]);
    y - x[0] * ratio
}

fn brown_dennis(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let t = (i + 1) as f64 / 5.0;
    let (a, b) = (x[0] + t * x[1] - t.exp(), x[2] + x[3] * t.sin() - t.cos());
    row.copy_from_slice(&[2.0 * a, 2.0 * a * t, 2.0 * b, 2.0 * b * t.sin()]);
    a * a + b * b
}

fn biggs(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let t = (i + 1) as f64 / 10.0;
    let y = (-t).exp() - 5.0 * (-10.0 * t).exp() + 3.0 * (-4.0 * t).exp();
    let (a, b, c) = ((-t * x[0]).exp(), (-t * x[1]).exp(), (-t * x[4]).exp());
    row.copy_from_slice(&[-t * x[2] * a, t * x[3] * b, a, -b, -t * x[5] * c, c]);
    x[2] * a - x[3] * b + x[5] * c - y
}
