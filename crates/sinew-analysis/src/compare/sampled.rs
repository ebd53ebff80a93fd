//! A reference between its frames: by interpolation, never beyond its ends and never over a gap.
//!
//! Between two frames a cubic through four (Lagrange) where all four are there, else a line. Motion of 50 m/s² sampled at 100 Hz is off by 0.6 mm with the line and less than that with the cubic.

use sinew_core::estimators::median;

/// Values of some channels over time, with gaps.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sampled<const D: usize> {
    times_s: Vec<f64>,
    /// Largest step between frames that is no gap, seconds.
    largest_step_s: f64,
    step_s: f64,
    channels: Vec<Vec<Option<[f64; D]>>>,
}

/// Steps that are longer than this multiple of the usual one are gaps.
const GAP: f64 = 1.5;

/// Where a time lies: the frame before it, the share of the way to the next, and weights of four frames where they are evenly apart.
struct Between {
    before: usize,
    share: f64,
    cubic: bool,
}

impl<const D: usize> Sampled<D> {
    /// Times rise; a channel has a value for each.
    pub(super) fn new(times_s: Vec<f64>, channels: Vec<Vec<Option<[f64; D]>>>) -> Self {
        let mut steps: Vec<f64> = times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let step_s = if steps.is_empty() { 0.0 } else { median(&mut steps) };
        Self { times_s, largest_step_s: GAP * step_s, step_s, channels }
    }

    /// First and last time, seconds.
    pub(super) fn ends_s(&self) -> [f64; 2] {
        [self.times_s.first(), self.times_s.last()].map(|end| end.copied().unwrap_or(f64::NAN))
    }

    fn between(&self, time_s: f64) -> Option<Between> {
        let times = &self.times_s;
        let [first, last] = self.ends_s();
        // Times are written with few digits: what is beyond an end by rounding is at it.
        let slack = 1e-3 * self.step_s;
        if !(time_s >= first - slack && time_s <= last + slack) || times.len() < 2 {
            return None;
        }
        let before = times.partition_point(|time| *time <= time_s).clamp(1, times.len() - 1) - 1;
        let span = times[before + 1] - times[before];
        let share = ((time_s - times[before]) / span).clamp(0.0, 1.0);
        let step = |from: usize| times.get(from + 1).zip(times.get(from)).map(|(next, this)| next - this);
        let even = |step: Option<f64>| step.is_some_and(|step| (step - span).abs() < 0.1 * span);
        let cubic = before > 0 && even(step(before - 1)) && even(step(before + 1));
        (span <= self.largest_step_s).then_some(Between { before, share, cubic })
    }

    /// Values of all channels at a time.
    pub(super) fn at(&self, time_s: f64) -> Vec<Option<[f64; D]>> {
        let Some(place) = self.between(time_s) else { return vec![None; self.channels.len()] };
        self.channels.iter().map(|channel| one(channel, &place)).collect()
    }

    /// How fast they change, a second.
    pub(super) fn rate_at(&self, time_s: f64) -> Vec<Option<[f64; D]>> {
        let half = 0.5 * self.step_s;
        let (before, after) = (self.at(time_s - half), self.at(time_s + half));
        let rate = |(before, after): (Option<[f64; D]>, Option<[f64; D]>)| {
            let (before, after) = (before?, after?);
            Some(std::array::from_fn(|axis| (after[axis] - before[axis]) / self.step_s))
        };
        before.into_iter().zip(after).map(rate).collect()
    }
}

fn one<const D: usize>(channel: &[Option<[f64; D]>], place: &Between) -> Option<[f64; D]> {
    let (before, share) = (place.before, place.share);
    if share == 0.0 {
        return channel[before];
    }
    if share == 1.0 {
        return channel[before + 1];
    }
    let (this, next) = (channel[before]?, channel[before + 1]?);
    let around = if place.cubic { channel[before - 1].zip(channel[before + 2]) } else { None };
    let Some((last, then)) = around else {
        return Some(std::array::from_fn(|axis| this[axis] + share * (next[axis] - this[axis])));
    };
    let (s, after, ahead, left) = (share, share + 1.0, share - 1.0, share - 2.0);
    let weights =
        [-s * ahead * left / 6.0, after * ahead * left / 2.0, -after * s * left / 2.0, after * s * ahead / 6.0];
    let four = [last, this, next, then];
    Some(std::array::from_fn(|axis| weights.iter().zip(&four).map(|(weight, value)| weight * value[axis]).sum()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sampled(values: &[Option<f64>]) -> Sampled<1> {
        let times = (0..values.len()).map(|k| 0.1 * k as f64).collect();
        Sampled::new(times, vec![values.iter().map(|value| value.map(|value| [value])).collect()])
    }

    fn at(values: &Sampled<1>, time_s: f64) -> Option<f64> {
        values.at(time_s)[0].map(|[value]| value)
    }

    #[test]
    fn a_cubic_is_met_exactly_between_its_frames() {
        let cubic = |t: f64| 2.0 - t + 3.0 * t * t - 4.0 * t * t * t;
        let values = sampled(&(0..20).map(|k| Some(cubic(0.1 * f64::from(k)))).collect::<Vec<_>>());
        for time in [0.1, 0.17, 0.95, 1.5, 1.799] {
            assert!((at(&values, time).unwrap() - cubic(time)).abs() < 1e-12, "{time}");
        }
        let rate = values.rate_at(0.95)[0].unwrap()[0];
        assert!((rate - (-1.0 + 6.0 * 0.95 - 12.0 * 0.95 * 0.95)).abs() < 0.02, "{rate}");
    }

    #[test]
    fn nothing_is_said_beyond_the_ends_and_in_gaps() {
        let values = sampled(&[Some(0.0), Some(1.0), None, Some(3.0), Some(4.0)]);
        assert_eq!([-0.01, 0.15, 0.2, 0.25, 0.41].map(|time| at(&values, time)), [None; 5]);
        assert!([0.0, 0.05, 0.35].iter().all(|time| (at(&values, *time).unwrap() - 10.0 * time).abs() < 1e-12));
        assert!(at(&values, 0.1).is_some() && at(&values, 0.4).is_some());
        // Frames that are not there are a gap as well.
        let gap = Sampled::new(vec![0.0, 0.1, 0.2, 0.5, 0.6], vec![vec![Some([1.0]); 5]]);
        assert_eq!([0.15, 0.35, 0.55].map(|time| at(&gap, time)), [Some(1.0), None, Some(1.0)]);
        assert_eq!(at(&Sampled::new(vec![0.0], vec![vec![Some([1.0])]]), 0.0), None);
    }
}
