//! How two measurements of the same agree: bias, spread, limits of agreement, and how often intervals hold the other.
//!
//! Differences are ours − the reference. With d̄ their mean and s their standard deviation, 95 % of them are expected
//! between the limits of agreement d̄ ± 1.96 s. Standard errors are s/√n of d̄ and s √(1/n + 1.96²/(2(n − 1))) of a limit,
//! intervals have Student's t with n − 1 degrees of freedom (Bland and Altman, Lancet 1986; Statistical Methods in Medical
//! Research 8, 1999, section 2.1). Frames follow each other closely, so n is what the differences are worth as independent
//! ones, once for their mean and once for their standard deviation, and s counts the variance of their mean ([`super::worth`]).

use super::worth::worth;
use sinew_core::estimators::mean;
use statrs::distribution::{ContinuousCDF as _, StudentsT};

/// Probabilities of the intervals of ours.
pub const LEVELS: [f64; 3] = [0.5, 0.9, 0.95];

/// How many standard deviations they reach on either side.
const REACH: [f64; 3] = [0.674_489_750_196_081_7, 1.644_853_626_951_472_2, 1.959_963_984_540_054];

/// One value of ours beside the reference's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Ours.
    pub ours: f64,
    /// The reference.
    pub reference: f64,
    /// Standard deviation of ours.
    pub sd: f64,
    /// The same within the run, without the shift that all points share; NaN where there is none.
    pub sd_within: f64,
}

impl Pair {
    /// Ours less the reference.
    #[must_use]
    pub fn difference(&self) -> f64 {
        self.ours - self.reference
    }
}

/// Mean, spread and limits of differences.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AgreementLimits {
    /// Mean difference.
    pub bias: f64,
    /// Standard deviation of the differences.
    pub sd: f64,
    /// Ends of the 95 % interval of the bias.
    pub bias_interval: [f64; 2],
    /// Limits of agreement, the lower first.
    pub limits: [f64; 2],
    /// Ends of the 95 % interval of each.
    pub limit_intervals: [[f64; 2]; 2],
}

/// Mean, spread and limits of agreement of differences that are worth so many independent ones: for their mean, and for their standard deviation.
#[must_use]
pub fn limits_of_agreement(bias: f64, sd: f64, [of_mean, of_sd]: [f64; 2]) -> AgreementLimits {
    let limits = [-1.0, 1.0].map(|sign| bias + sign * REACH[2] * sd);
    let freedom = of_sd - 1.0;
    let student = StudentsT::new(0.0, 1.0, freedom).map_or(f64::NAN, |student| student.inverse_cdf(0.975));
    let mean_square = of_mean.recip();
    let limit_square = mean_square + REACH[2] * REACH[2] / (2.0 * freedom);
    let [for_bias, for_limit] = [mean_square, limit_square].map(|square| student * square.sqrt() * sd);
    let around = |centre: f64, half: f64| [centre - half, centre + half];
    AgreementLimits {
        bias,
        sd,
        bias_interval: around(bias, for_bias),
        limits,
        limit_intervals: limits.map(|limit| around(limit, for_limit)),
    }
}

/// How a series of ours agrees with the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Agreement {
    /// Values that are compared.
    pub count: usize,
    /// Independent values that they are worth for their mean.
    pub worth: f64,
    /// Root mean square difference.
    pub rms: f64,
    /// Bias and limits.
    pub limits: AgreementLimits,
    /// Shares of the reference inside our intervals of [`LEVELS`].
    pub inside: [f64; 3],
    /// The same within the run: the shift that all share is taken off, and intervals are without it. NaN without.
    pub inside_within: [f64; 3],
}

/// Share of the pairs whose difference, less a shift, is within the reach of each level.
fn share_inside(pairs: &[Pair], shift: f64, sd: impl Fn(&Pair) -> f64) -> [f64; 3] {
    if pairs.iter().any(|pair| !sd(pair).is_finite()) {
        return [f64::NAN; 3];
    }
    let inside = |reach: f64| pairs.iter().filter(|pair| (pair.difference() - shift).abs() <= reach * sd(pair)).count();
    REACH.map(|reach| inside(reach) as f64 / pairs.len() as f64)
}

/// Agreement of pairs in the order of time; `shift` is the mean difference that all series of the axis share. `None` of fewer than two.
#[must_use]
pub fn agreement(pairs: &[Pair], shift: f64) -> Option<Agreement> {
    let count = pairs.len();
    if count < 2 {
        return None;
    }
    let differences: Vec<f64> = pairs.iter().map(Pair::difference).collect();
    let bias = mean(&differences);
    let square = differences.iter().map(|difference| difference * difference).sum::<f64>();
    let worth = worth(&differences);
    Some(Agreement {
        count,
        worth: worth.of_mean,
        rms: (square / count as f64).sqrt(),
        limits: limits_of_agreement(bias, worth.variance.sqrt(), [worth.of_mean, worth.of_sd]),
        inside: share_inside(pairs, 0.0, |pair| pair.sd),
        inside_within: share_inside(pairs, shift, |pair| pair.sd_within),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(ours: f64, reference: f64, sd: f64) -> Pair {
        Pair { ours, reference, sd, sd_within: f64::NAN }
    }

    /// Peak expiratory flow by a large and a mini meter, l/min: Bland and Altman 1986, their table and their numbers.
    #[test]
    fn bias_and_spread_are_as_bland_and_altman_found_them_in_1986() {
        let large = [494, 395, 516, 434, 476, 557, 413, 442, 650, 433, 417, 656, 267, 478, 178, 423, 427];
        let mini = [512, 430, 520, 428, 500, 600, 364, 380, 658, 445, 432, 626, 260, 477, 259, 350, 451];
        let differences: Vec<f64> = large.iter().zip(mini).map(|(large, mini)| f64::from(large - mini)).collect();
        let [bias, sd] = [mean(&differences), sinew_core::estimators::variance(&differences).sqrt()];
        assert!((bias + 2.1).abs() < 0.05 && (sd - 38.8).abs() < 0.05, "{bias} {sd}");
        // They take 2 standard deviations for 1.96, which moves the limits and not the widths of their intervals.
        let limits = limits_of_agreement(bias, sd, [17.0; 2]);
        let [low, high] = limits.bias_interval;
        assert!((low + 22.1).abs() < 0.1 && (high - 17.8).abs() < 0.1, "{limits:?}");
        let theirs = [[-114.3, -45.1], [40.9, 110.1]];
        for (own, theirs) in limits.limit_intervals.iter().zip(theirs) {
            assert!((own[1] - own[0] - (theirs[1] - theirs[0])).abs() < 0.4, "{limits:?}");
        }
    }

    /// Systolic blood pressure by an observer and a machine, mmHg: Bland and Altman 1999, from their summary of 85 pairs.
    #[test]
    fn limits_are_as_bland_and_altman_found_them_in_1999() {
        let found = limits_of_agreement(-16.29, 19.61, [85.0; 2]);
        let near =
            |own: [f64; 2], theirs: [f64; 2]| own.iter().zip(theirs).all(|(own, theirs)| (own - theirs).abs() < 0.15);
        assert!(near(found.limits, [-54.7, 22.1]), "{found:?}");
        assert!(near(found.bias_interval, [-20.5, -12.1]), "{found:?}");
        assert!(near(found.limit_intervals[0], [-61.9, -47.5]), "{found:?}");
        assert!(near(found.limit_intervals[1], [14.9, 29.4]), "{found:?}");
    }

    /// Places of a thousand equal steps through the normal distribution.
    fn normal_quantiles() -> impl Iterator<Item = f64> {
        let normal = statrs::distribution::Normal::standard();
        (0..1000).map(move |k| normal.inverse_cdf((f64::from(k) + 0.5) / 1000.0))
    }

    #[test]
    fn intervals_of_a_gaussian_hold_their_share() {
        let share = |scale: f64, shift: f64| {
            let pairs: Vec<Pair> = normal_quantiles()
                .map(|z| Pair { ours: 3.0 * z + shift, reference: 0.0, sd: 3.0 * scale, sd_within: 3.0 })
                .collect();
            agreement(&pairs, shift).unwrap()
        };
        assert_eq!(share(1.0, 0.0).inside, [0.5, 0.9, 0.95]);
        assert_eq!(share(1.0, 60.0).inside, [0.0; 3]);
        assert_eq!(share(1.0, 60.0).inside_within, [0.5, 0.9, 0.95]);
        // Half the standard deviation: Φ(z/2) − Φ(−z/2).
        let [half, most, _] = share(0.5, 0.0).inside;
        assert!((half - 0.264).abs() < 0.002 && (most - 0.589).abs() < 0.002, "{half} {most}");
    }

    #[test]
    fn values_that_hardly_change_are_worth_few() {
        let slow: Vec<Pair> = (0..200).map(|k| pair((0.02 * f64::from(k)).sin(), 0.0, 1.0)).collect();
        let fast: Vec<Pair> = (0..200).map(|k| pair(f64::from(k * 7919 % 200), 0.0, 1.0)).collect();
        let worth = |pairs: &[Pair]| agreement(pairs, 0.0).unwrap().worth;
        assert!(worth(&slow) < 10.0 && worth(&fast) > 50.0, "{} {}", worth(&slow), worth(&fast));
        assert!(agreement(&slow[..1], 0.0).is_none());
        // Differences that are all equal have no limits apart, and no more than their bias.
        let same = agreement(&[pair(1.0, 0.0, 1.0); 9], 0.0).unwrap();
        assert_eq!((same.limits.limits, same.rms), ([1.0, 1.0], 1.0));
    }

    /// Standard normal numbers by inversion of Lehmer's generator (Park and Miller 1988).
    fn normals(seed: u64) -> impl FnMut() -> f64 {
        let (normal, mut state) = (statrs::distribution::Normal::standard(), seed);
        move || {
            state = state * 48_271 % 2_147_483_647;
            normal.inverse_cdf(state as f64 / 2_147_483_647.0)
        }
    }

    /// Shares of 95 % intervals, in 200 recordings, that hold the truth: of the bias, of the limits of agreement, and of the limits themselves, which are to hold one more draw; and the mean of s² over what it should be.
    fn held(frames: usize, lasting: f64) -> [f64; 4] {
        const RUNS: u64 = 200;
        let mut found = [0.0; 4];
        for run in 1..=RUNS {
            let mut normal = normals(7_919 * run + frames as u64);
            let kept = if lasting > 0.0 { (-1.0 / lasting).exp() } else { 0.0 };
            let mut error = normal();
            let mut next = || {
                error = kept * error + (1.0 - kept * kept).sqrt() * normal();
                pair(error, 0.0, 1.0)
            };
            let pairs: Vec<Pair> = (0..frames).map(|_| next()).collect();
            let more = (0..2000).map(|_| next()).last().unwrap().ours;
            let AgreementLimits { bias_interval, limits, limit_intervals, sd, .. } =
                agreement(&pairs, 0.0).unwrap().limits;
            let inside = |[low, high]: [f64; 2], truth: f64| f64::from(u8::from((low..=high).contains(&truth)));
            let of_limits = [-1.0, 1.0].iter().zip(limit_intervals).map(|(sign, ends)| inside(ends, sign * REACH[2]));
            let all = [inside(bias_interval, 0.0), 0.5 * of_limits.sum::<f64>(), inside(limits, more), sd * sd];
            found.iter_mut().zip(all).for_each(|(sum, own)| *sum += own / RUNS as f64);
        }
        found
    }

    /// Errors that last some frames, as those of keypoints do: what is claimed of a recording holds in nearly as many as it says, and is not too wide for frames that are independent.
    #[test]
    fn intervals_hold_the_truth_where_frames_hang_together() {
        for (frames, lasting) in [(120, 12.0), (120, 6.0), (300, 24.0), (300, 12.0), (900, 12.0), (200, 0.0)] {
            let [bias, limits, more, square] = held(frames, lasting);
            // Of 200: 0.95 ± 0.046 at three standard errors; a mean that errs lets limits hold less.
            assert!(bias > 0.90 && limits > 0.90, "{frames} {lasting}: {bias} {limits}");
            assert!((0.85..1.0).contains(&more), "{frames} {lasting}: {more}");
            assert!((square - 1.0).abs() < 0.2, "{frames} {lasting}: {square}");
        }
    }

    /// Frames that do not hang together are worth more than half of themselves in the mean over 50 recordings.
    #[test]
    fn independent_frames_are_worth_most_of_themselves() {
        let worth = |run: u64| {
            let mut normal = normals(104_729 * run);
            let pairs: Vec<Pair> = (0..400).map(|_| pair(normal(), 0.0, 1.0)).collect();
            agreement(&pairs, 0.0).unwrap().worth
        };
        let middle = mean(&(1..=50).map(worth).collect::<Vec<_>>());
        assert!((200.0..=400.0).contains(&middle), "{middle}");
    }
}
