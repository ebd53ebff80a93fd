//! Standard problems that are defined in any number of variables.

use super::{Problem, Residual};

/// From a start given by the number of the variable (from 1) and how many there are.
fn spread(name: &str, n: usize, start: fn(f64, f64) -> f64, terms: usize, residual: Residual, least: f64) -> Problem {
    let start: Vec<f64> = (1..=n).map(|j| start(j as f64, n as f64)).collect();
    Problem::new(name, &start, terms, residual, least)
}

pub fn problems() -> Vec<Problem> {
    let even_odd = |odd: f64, even: f64, n: usize| [odd, even].repeat(n / 2);
    let grid: fn(f64, f64) -> f64 = |j, n| j / (n + 1.0) * (j / (n + 1.0) - 1.0);
    let powell = [3.0, -1.0, 0.0, 1.0];
    vec![
        Problem::new("1 Rosenbrock", &[-1.2, 1.0], 2, rosenbrock, 0.0),
        Problem::new("13 Powell singular", &powell, 4, powell_singular, 0.0),
        spread("20 Watson", 6, |_, _| 0.0, 31, watson, 2.28767e-3),
        spread("20 Watson", 9, |_, _| 0.0, 31, watson, 1.39976e-6),
        Problem::new("21 extended Rosenbrock", &even_odd(-1.2, 1.0, 100), 100, rosenbrock, 0.0),
        Problem::new("22 extended Powell singular", &powell.repeat(25), 100, powell_singular, 0.0),
        spread("23 penalty I", 4, |j, _| j, 5, penalty_one, 2.24997e-5),
        spread("23 penalty I", 10, |j, _| j, 11, penalty_one, 7.08765e-5),
        spread("24 penalty II", 4, |_, _| 0.5, 8, penalty_two, 9.37629e-6),
        spread("24 penalty II", 10, |_, _| 0.5, 20, penalty_two, 2.93660e-4),
        spread("25 variably dimensioned", 10, |j, n| 1.0 - j / n, 12, variably_dimensioned, 0.0),
        spread("26 trigonometric", 10, |_, n| 1.0 / n, 10, trigonometric, 0.0),
        spread("27 Brown almost linear", 10, |_, _| 0.5, 10, brown_almost_linear, 0.0),
        spread("28 discrete boundary value", 10, grid, 10, discrete_boundary_value, 0.0),
        spread("29 discrete integral equation", 10, grid, 10, discrete_integral, 0.0),
        spread("30 Broyden tridiagonal", 10, |_, _| -1.0, 10, broyden_tridiagonal, 0.0),
        spread("31 Broyden banded", 10, |_, _| -1.0, 10, broyden_banded, 0.0),
        spread("32 linear of full rank", 10, |_, _| 1.0, 20, linear_full_rank, 10.0),
        spread("33 linear of rank one", 10, |_, _| 1.0, 20, linear_rank_one, 380.0 / 82.0),
        spread("35 Chebyquad", 8, |j, n| j / (n + 1.0), 8, chebyquad, 3.51687e-3),
        spread("35 Chebyquad", 9, |j, n| j / (n + 1.0), 9, chebyquad, 0.0),
    ]
}

fn rosenbrock(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let j = i / 2 * 2;
    if i.is_multiple_of(2) {
        (row[j], row[j + 1]) = (-20.0 * x[j], 10.0);
        return 10.0 * (x[j + 1] - x[j] * x[j]);
    }
    row[j] = -1.0;
    1.0 - x[j]
}

fn powell_singular(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let (x, row) = (&x[i / 4 * 4..][..4], &mut row[i / 4 * 4..][..4]);
    let (five, ten) = (5.0_f64.sqrt(), 10.0_f64.sqrt());
    let (inner, outer) = (x[1] - 2.0 * x[2], x[0] - x[3]);
    let (gradient, residual) = match i % 4 {
        0 => ([1.0, 10.0, 0.0, 0.0], x[0] + 10.0 * x[1]),
        1 => ([0.0, 0.0, five, -five], five * (x[2] - x[3])),
        2 => ([0.0, 2.0 * inner, -4.0 * inner, 0.0], inner * inner),
        _ => ([2.0 * ten * outer, 0.0, 0.0, -2.0 * ten * outer], ten * outer * outer),
    };
    row.copy_from_slice(&gradient);
    residual
}

fn watson(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    if i == 29 {
        row[0] = 1.0;
        return x[0];
    }
    if i == 30 {
        (row[0], row[1]) = (-2.0 * x[0], 1.0);
        return x[1] - x[0] * x[0] - 1.0;
    }
    let t = (i + 1) as f64 / 29.0;
    let sum: f64 = x.iter().rev().fold(0.0, |sum, x| sum * t + x);
    let mut slope = 0.0;
    for (j, (x, row)) in x.iter().zip(row).enumerate() {
        let derivative = if j == 0 { 0.0 } else { j as f64 * t.powi(j as i32 - 1) };
        slope += derivative * x;
        *row = derivative - 2.0 * sum * t.powi(j as i32);
    }
    slope - sum * sum - 1.0
}

fn penalty_one(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    if i == x.len() {
        row.iter_mut().zip(x).for_each(|(row, x)| *row = 2.0 * x);
        return x.iter().map(|x| x * x).sum::<f64>() - 0.25;
    }
    row[i] = 1e-5_f64.sqrt();
    row[i] * (x[i] - 1.0)
}

fn penalty_two(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let (n, root) = (x.len(), 1e-5_f64.sqrt());
    let step = |j: usize| ((j as f64) / 10.0).exp();
    if i == 0 {
        row[0] = 1.0;
        return x[0] - 0.2;
    }
    if i < n {
        (row[i - 1], row[i]) = (0.1 * root * (x[i - 1] / 10.0).exp(), 0.1 * root * (x[i] / 10.0).exp());
        return root * ((x[i] / 10.0).exp() + (x[i - 1] / 10.0).exp() - step(i + 1) - step(i));
    }
    if i < 2 * n - 1 {
        row[i - n + 1] = 0.1 * root * (x[i - n + 1] / 10.0).exp();
        return root * ((x[i - n + 1] / 10.0).exp() - (-0.1_f64).exp());
    }
    row.iter_mut().enumerate().for_each(|(j, row)| *row = 2.0 * (n - j) as f64 * x[j]);
    x.iter().enumerate().map(|(j, x)| (n - j) as f64 * x * x).sum::<f64>() - 1.0
}

fn variably_dimensioned(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    if i < x.len() {
        row[i] = 1.0;
        return x[i] - 1.0;
    }
    let sum: f64 = x.iter().enumerate().map(|(j, x)| (j + 1) as f64 * (x - 1.0)).sum();
    let (factor, residual) = if i == x.len() { (1.0, sum) } else { (2.0 * sum, sum * sum) };
    row.iter_mut().enumerate().for_each(|(j, row)| *row = factor * (j + 1) as f64);
    residual
}

fn trigonometric(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let (n, number) = (x.len() as f64, (i + 1) as f64);
    row.iter_mut().zip(x).for_each(|(row, x)| *row = x.sin());
    row[i] += number * x[i].sin() - x[i].cos();
    n - x.iter().map(|x| x.cos()).sum::<f64>() + number * (1.0 - x[i].cos()) - x[i].sin()
}

fn brown_almost_linear(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let n = x.len();
    if i < n - 1 {
        row.fill(1.0);
        row[i] = 2.0;
        return x[i] + x.iter().sum::<f64>() - (n + 1) as f64;
    }
    for (j, row) in row.iter_mut().enumerate() {
        *row = x.iter().enumerate().filter(|(k, _)| *k != j).map(|(_, x)| x).product();
    }
    x.iter().product::<f64>() - 1.0
}

fn discrete_boundary_value(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let width = 1.0 / (x.len() + 1) as f64;
    let cubed = x[i] + (i + 1) as f64 * width + 1.0;
    let mut residual = 2.0 * x[i] + 0.5 * width * width * cubed.powi(3);
    row[i] = 2.0 + 1.5 * width * width * cubed * cubed;
    for j in [i.wrapping_sub(1), i + 1] {
        if let Some(neighbour) = x.get(j) {
            residual -= neighbour;
            row[j] = -1.0;
        }
    }
    residual
}

fn discrete_integral(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let width = 1.0 / (x.len() + 1) as f64;
    let place = |j: usize| (j + 1) as f64 * width;
    let mut residual = x[i];
    for j in 0..x.len() {
        let weight = 0.5 * width * (1.0 - place(i.max(j))) * place(i.min(j));
        let cubed = x[j] + place(j) + 1.0;
        residual += weight * cubed.powi(3);
        row[j] = 3.0 * weight * cubed * cubed;
    }
    row[i] += 1.0;
    residual
}

fn broyden_tridiagonal(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let mut residual = (3.0 - 2.0 * x[i]) * x[i] + 1.0;
    row[i] = 3.0 - 4.0 * x[i];
    for (j, factor) in [(i.wrapping_sub(1), 1.0), (i + 1, 2.0)] {
        if let Some(neighbour) = x.get(j) {
            residual -= factor * neighbour;
            row[j] = -factor;
        }
    }
    residual
}

fn broyden_banded(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let mut residual = x[i] * (2.0 + 5.0 * x[i] * x[i]) + 1.0;
    for j in i.saturating_sub(5)..(i + 2).min(x.len()) {
        if j != i {
            residual -= x[j] * (1.0 + x[j]);
            row[j] = -1.0 - 2.0 * x[j];
        }
    }
    row[i] = 2.0 + 15.0 * x[i] * x[i];
    residual
}

/// Of 20 equations.
fn linear_full_rank(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    row.fill(-0.1);
    let common = -0.1 * x.iter().sum::<f64>() - 1.0;
    let Some(own) = row.get_mut(i) else { return common };
    *own += 1.0;
    common + x[i]
}

fn linear_rank_one(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let number = (i + 1) as f64;
    row.iter_mut().enumerate().for_each(|(j, row)| *row = number * (j + 1) as f64);
    row.iter().zip(x).map(|(row, x)| row * x).sum::<f64>() - 1.0
}

/// Shifted Chebyshev polynomial of degree i + 1 and its derivative, by the recurrence of both; its mean over [0, 1] is −1/(k² − 1) for even degrees k, else 0.
fn chebyquad(i: usize, x: &[f64], row: &mut [f64]) -> f64 {
    let (n, degree) = (x.len() as f64, (i + 1) as f64);
    let mut sum = 0.0;
    for (x, row) in x.iter().zip(row) {
        let shifted = 2.0 * x - 1.0;
        let (mut before, mut now) = ((1.0, 0.0), (shifted, 2.0));
        for _ in 0..i {
            let next = (2.0 * shifted * now.0 - before.0, 4.0 * now.0 + 2.0 * shifted * now.1 - before.1);
            (before, now) = (now, next);
        }
        sum += now.0;
        *row = now.1 / n;
    }
    sum / n + if i % 2 == 1 { 1.0 / (degree * degree - 1.0) } else { 0.0 }
}
