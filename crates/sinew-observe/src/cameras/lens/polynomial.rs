//! Zeros of polynomials on the positive half-line, for the domains of lenses.
//!
//! Coefficients rise: `c[0] + c[1] s + c[2] s² + …`. Between neighbouring zeros of its derivative a polynomial is monotone, so a change of sign there is a single zero, found by bisection.

/// Steps of bisection, enough for a double's 53 bits.
const BISECTIONS: usize = 200;

/// Value at `s`.
pub(super) fn value(c: &[f64], s: f64) -> f64 {
    c.iter().rev().copied().reduce(|sum, c| c + s * sum).unwrap_or(0.0)
}

pub(super) fn derivative(c: &[f64]) -> Vec<f64> {
    c.iter().enumerate().skip(1).map(|(power, c)| power as f64 * c).collect()
}

pub(super) fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; a.len() + b.len() - 1];
    for (i, a) in a.iter().enumerate() {
        for (out, b) in out[i..].iter_mut().zip(b) {
            *out += a * b;
        }
    }
    out
}

/// Largest s ≥ 0 up to which a polynomial that is positive at 0 stays so; infinite where it always does.
pub(super) fn positive_up_to(c: &[f64]) -> f64 {
    if c.iter().all(|c| *c >= 0.0) {
        return f64::INFINITY;
    }
    let at = |s: f64| value(c, s);
    let mut low = 0.0;
    for high in ends(c) {
        if at(high) < 0.0 {
            return bisect(at, low, high);
        }
        low = high;
    }
    f64::INFINITY
}

/// Positive zeros of the derivative, rising, and last a bound beyond all zeros (Cauchy's).
fn ends(c: &[f64]) -> Vec<f64> {
    let leading = c.iter().rev().find(|c| **c != 0.0).map_or(1.0, |c| c.abs());
    let bound = 1.0 + c.iter().fold(0.0_f64, |most, c| most.max(c.abs())) / leading;
    let mut ends = zeros(&derivative(c));
    ends.retain(|s| *s > 0.0 && *s < bound);
    ends.push(bound);
    ends
}

/// Real zeros, rising: all of them up to degree two, of higher degrees the positive ones at which the sign changes.
fn zeros(c: &[f64]) -> Vec<f64> {
    let terms = c.iter().rposition(|c| *c != 0.0).map_or(0, |degree| degree + 1);
    match c[..terms] {
        [] | [_] => vec![],
        [c, b] => vec![-c / b],
        [c, b, a] => zeros_of_quadratic(a, b, c),
        ref c => {
            let mut out = vec![];
            let mut low = 0.0;
            for high in ends(c) {
                let sign = value(c, low).signum();
                if sign * value(c, high) < 0.0 {
                    out.push(bisect(|s| sign * value(c, s), low, high));
                }
                low = high;
            }
            out
        }
    }
}

/// Real zeros of a s² + b s + c, rising.
fn zeros_of_quadratic(a: f64, b: f64, c: f64) -> Vec<f64> {
    let discriminant = b * b - 4.0 * a * c;
    if discriminant.is_nan() || discriminant <= 0.0 {
        return vec![];
    }
    let q = -0.5 * (b + discriminant.sqrt().copysign(b));
    let mut zeros = vec![q / a];
    if q != 0.0 {
        zeros.push(c / q);
    }
    zeros.sort_by(f64::total_cmp);
    zeros
}

/// Last point in [low, high] at which `f`, positive at `low` and falling, is not yet negative.
pub(super) fn bisect(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if f(middle) < 0.0 { high = middle } else { low = middle }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_of_low_degrees_are_in_closed_form() {
        for (coefficients, expected) in [
            (&[2.0, -3.0, 1.0][..], &[1.0, 2.0][..]),
            (&[-6.0, 4.0, 2.0], &[-3.0, 1.0]),
            (&[4.0, 0.0, -1.0], &[-2.0, 2.0]),
            (&[1.0, 0.0, 1.0], &[]),
            (&[1.0, -2.0, 1.0], &[]),
            (&[-5.0, 2.0, 0.0], &[2.5]),
            (&[1.0, 0.0, 0.0], &[]),
            (&[1.0, f64::NAN, 1.0], &[]),
            (&[], &[]),
        ] {
            assert_eq!(zeros(coefficients), expected, "{coefficients:?}");
        }
    }

    /// (1 − s)(1 − s/2)(1 − s/3)(1 + s)(1 + s²) and the like, whose zeros are known.
    #[test]
    fn the_first_zero_of_products_is_found() {
        for zeros in [&[1.0, 2.0, 3.0, -1.0][..], &[0.25, 0.5, 0.6, 4.0], &[7.0, -0.1, -2.0], &[0.01, 50.0, 60.0]] {
            let mut c = vec![1.0, 0.0, 1.0];
            for zero in zeros {
                c = product(&c, &[1.0, -1.0 / zero]);
            }
            let first = zeros.iter().copied().filter(|z| *z > 0.0).fold(f64::INFINITY, f64::min);
            let found = positive_up_to(&c);
            assert!((found - first).abs() < 1e-9 * first, "{found} for {first}");
        }
        assert_eq!(positive_up_to(&[1.0, -0.5, 1.0]), f64::INFINITY);
        assert_eq!(positive_up_to(&[1.0, f64::NAN, 1.0]), f64::INFINITY);
    }
}
