//! The least value of a function of one variable on an interval, by golden sections.

/// The place of the least value that was tried, and that value; `steps` + 2 evaluations. Each step makes the bracket 0.618 times as wide. Where the function has several minima, one of them is approached.
///
/// # Errors
/// The first error of the function.
pub fn golden_section<E>(
    [mut low, mut high]: [f64; 2],
    steps: usize,
    mut value: impl FnMut(f64) -> Result<f64, E>,
) -> Result<(f64, f64), E> {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let mut inner = [high - golden * (high - low), low + golden * (high - low)];
    let mut values = [value(inner[0])?, value(inner[1])?];
    let mut best = if values[1] < values[0] { (inner[1], values[1]) } else { (inner[0], values[0]) };
    for _ in 0..steps {
        let tried = if values[0] < values[1] {
            high = inner[1];
            inner = [high - golden * (high - low), inner[0]];
            values = [value(inner[0])?, values[0]];
            (inner[0], values[0])
        } else {
            low = inner[0];
            inner = [inner[1], low + golden * (high - low)];
            values = [values[1], value(inner[1])?];
            (inner[1], values[1])
        };
        if tried.1 < best.1 {
            best = tried;
        }
    }
    Ok(best)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_minimum_is_approached_at_the_stated_rate() {
        for (centre, steps) in [(0.3, 8), (-0.9, 20), (0.95, 30)] {
            let mut evaluations = 0;
            let parabola = |x: f64| {
                evaluations += 1;
                Ok::<f64, ()>((x - centre).powi(2) + 2.0)
            };
            let (x, value) = golden_section([-1.0, 1.0], steps, parabola).unwrap();
            let bracket = 2.0 * 0.618_034_f64.powi(steps as i32 + 1);
            assert!((x - centre).abs() <= bracket, "{x} for {centre}, bracket {bracket}");
            assert_eq!((value, evaluations), ((x - centre).powi(2) + 2.0, steps + 2));
        }
    }

    #[test]
    fn errors_are_passed_on() {
        assert_eq!(golden_section([0.0, 1.0], 3, |x| if x < 0.5 { Ok(x) } else { Err("beyond") }), Err("beyond"));
    }
}
