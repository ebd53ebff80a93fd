//! The sentences at the top of the page: how well the person is known, and whether to doubt it.

use super::doubts::doubts;
use super::html::{escaped, with_code};
use super::recorded::{Recorded, RecordedPoint};
use sinew_core::estimators::median;
use sinew_input::flag::flag;

/// What the intervals are worth in a few words, as HTML, with the sentence of a validation if there was one.
pub(super) fn verdict(recorded: &Recorded, validated: Option<&str>) -> String {
    let middle =
        |values: &mut dyn Iterator<Item = f64>| median(&mut values.filter(|x| x.is_finite()).collect::<Vec<_>>());
    let all_m = middle(&mut recorded.points.iter().flat_map(|point| &point.axes).flat_map(|axis| axis.half_widths()));
    let within_m = middle(&mut recorded.points.iter().flat_map(half_widths_within));
    let angles_deg = middle(&mut recorded.angles.iter().flat_map(|angle| angle.band.half_widths()));
    let known = format!(
        "A coordinate of a joint is known to <b>±{:.0} mm</b> (±{:.0} mm against other places of the run), an angle to <b>±{angles_deg:.1}°</b>: medians of 90 % intervals.",
        1e3 * all_m,
        1e3 * within_m
    );
    let found = doubts(recorded);
    let failed = found.iter().filter(|doubt| doubt.is_failed).count();
    let warned = found.len() - failed;
    let doubted = match (failed, warned) {
        (0, 0) => "<span class=\"good\">The run doubts nothing that it checks.</span>".to_owned(),
        (0, 1) => "<a class=\"warn\" href=\"#doubts\">The run has one doubt.</a>".to_owned(),
        (0, warned) => format!("<a class=\"warn\" href=\"#doubts\">The run has {warned} doubts.</a>"),
        (1, _) => "<a class=\"bad\" href=\"#doubts\">A diagnostic failed: doubt the intervals.</a>".to_owned(),
        (failed, _) => {
            format!("<a class=\"bad\" href=\"#doubts\">{failed} diagnostics failed: doubt the intervals.</a>")
        }
    };
    let worth = validated.map_or_else(String::new, |worth| format!(" Cameras that were left out: {}.", escaped(worth)));
    format!("{}{known}{worth} {doubted}", interrupted(recorded))
}

/// Half the widths that the intervals of a point have within the run: the share of its standard deviation that is left there.
fn half_widths_within(point: &RecordedPoint) -> impl Iterator<Item = f64> + '_ {
    let axes = point.axes.iter().zip(&point.sd).zip(&point.sd_within);
    axes.flat_map(|((band, sd), within)| {
        band.half_widths().zip(sd).zip(within).map(|((half, sd), within)| half * within / sd)
    })
}

/// What is said of a run that did not come to its end.
fn interrupted(recorded: &Recorded) -> String {
    if recorded.summary["complete"] == true {
        return String::new();
    }
    if let Some(skipped) = recorded.summary["skipped_frames"].as_u64() {
        return format!(
            "<strong class=\"bad\">{skipped} frames came faster than they could be tracked and were left out: there the motion prior alone says where the person is.</strong> "
        );
    }
    let until = recorded.numbers.last().map_or(String::new(), |number| format!(" to frame {number}"));
    format!(
        "<strong class=\"bad\">The run was interrupted: this page shows the frames up{}. The same command with {} continues.</strong> ",
        escaped(&until),
        with_code(&flag("resume"))
    )
}

#[cfg(test)]
mod tests {
    use super::super::recorded::Band;
    use super::*;

    /// Of a standard deviation of 4 mm 2 mm are left within the run, and so is half of the interval.
    #[test]
    fn intervals_within_the_run_are_narrower_by_the_share_of_the_standard_deviation() {
        let band = || Band { mean: vec![1.0], low: vec![0.99], high: vec![1.01] };
        let point = RecordedPoint {
            name: "Nose".into(),
            axes: [band(), band(), band()],
            sd: [(); 3].map(|()| vec![0.004]),
            sd_within: [(); 3].map(|()| vec![0.002]),
        };
        let found: Vec<f64> = half_widths_within(&point).collect();
        assert!(found.len() == 3 && found.iter().all(|half| (half - 0.005).abs() < 1e-12), "{found:?}");
    }
}
