//! A picture of an action trace: which clusters moved each part over time, below the errors of the joints.
//!
//! Each part is a band with a row for each of the clusters that moved most particles, in the order in which they first did so; the darker, the larger the share. The last row of a band is the share that no primitive moved.

use sinew_formats::svg::{Svg, clipped};
use sinew_results::action_trace::{ActionTrace, PartActions};

/// Clusters of a part that have a row.
const ROWS: usize = 12;
/// Height of a row, and of that without a primitive, pixels.
const ROW: f64 = 5.0;
/// Space between bands, pixels.
const GAP: f64 = 12.0;
/// Width of the labels, of the time axis and of margins, pixels.
const LABEL: f64 = 110.0;
const TIME: f64 = 860.0;
const MARGIN: f64 = 20.0;
/// Place of the first panel and height of that with errors, pixels.
const TOP: f64 = 74.0;
const ERRORS: f64 = 110.0;
/// Steps of darkness.
const SHADES: f64 = 10.0;
/// Most times on the axis, and most lines across the errors.
const TICKS: [f64; 2] = [10.0, 4.0];

const CLUSTER: &str = "#0b3d5c";
const WALK: &str = "#c2410c";
const GRID: &str = "#e5e7eb";

/// Draws a trace, with errors in millimetres over seconds where they are known.
#[must_use]
pub fn action_picture(title: &str, trace: &ActionTrace, errors_mm: &[(f64, f64)]) -> String {
    let rows: Vec<Vec<usize>> = trace.parts.iter().map(drawn_clusters).collect();
    let bands: f64 = rows.iter().map(|rows| band_height(rows) + GAP).sum();
    let top = if errors_mm.is_empty() { TOP } else { TOP + ERRORS + 2.0 * GAP };
    let (bottom, axis) = (top + bands, Axis::new(trace));
    let mut svg = Svg::new(2.0 * MARGIN + LABEL + TIME, bottom + 40.0);
    svg.text(MARGIN, 24.0, 15.0, &clipped(title));
    svg.text(
        MARGIN,
        42.0,
        12.0,
        &format!(
            "Rows: clusters that moved most particles of a part (at most {ROWS}), in the order in which they first did; dark: many."
        ),
    );
    svg.text(MARGIN, 58.0, 12.0, "Red row: particles that no primitive moved, but a random walk.");
    for second in ticks(axis.from, axis.to, TICKS[0]) {
        let x = axis.place(second);
        svg.line([x, TOP], [x, bottom], 0.5, GRID);
        svg.text(x - 4.0, bottom + 16.0, 12.0, &shown(second));
    }
    svg.text(MARGIN + LABEL + 0.5 * TIME - 40.0, bottom + 32.0, 12.0, "time, seconds");
    if !errors_mm.is_empty() {
        draw_errors(&mut svg, &axis, errors_mm);
    }
    let mut y = top;
    for (part, rows) in trace.parts.iter().zip(&rows) {
        draw_part(&mut svg, &axis, part, rows, y);
        y += band_height(rows) + GAP;
    }
    svg.done()
}

/// Times of the frames as places.
struct Axis {
    from: f64,
    to: f64,
    /// Left and right end of each frame.
    ends: Vec<[f64; 2]>,
}

impl Axis {
    fn new(trace: &ActionTrace) -> Self {
        let times = &trace.time_s;
        let (first, last) = (times.first().copied().unwrap_or(0.0), times.last().copied().unwrap_or(0.0));
        let frame = if times.len() > 1 { (last - first) / (times.len() - 1) as f64 } else { 1.0 };
        let mut axis = Self { from: first - 0.5 * frame, to: last + 0.5 * frame, ends: vec![] };
        axis.ends = times.iter().map(|t| [axis.place(t - 0.5 * frame), axis.place(t + 0.5 * frame)]).collect();
        axis
    }

    fn place(&self, second: f64) -> f64 {
        MARGIN + LABEL + TIME * (second - self.from) / (self.to - self.from)
    }
}

fn share_of(shares: &[(Option<usize>, f64)], by: Option<usize>) -> f64 {
    shares.iter().find(|(known, _)| *known == by).map_or(0.0, |(_, share)| *share)
}

/// The clusters that moved most, each in the order of the first frame in which it moved half of its most.
fn drawn_clusters(part: &PartActions) -> Vec<usize> {
    let mut known: Vec<usize> = part.frames.iter().flatten().filter_map(|(by, _)| *by).collect();
    known.sort_unstable();
    known.dedup();
    let series = |cluster: usize| part.frames.iter().map(move |shares| share_of(shares, Some(cluster)));
    let total = |cluster: &usize| series(*cluster).sum::<f64>();
    known.sort_by(|a, b| total(b).total_cmp(&total(a)));
    known.truncate(ROWS);
    known.sort_by_key(|&cluster| {
        let most = series(cluster).fold(0.0, f64::max);
        series(cluster).position(|share| share >= 0.5 * most)
    });
    known
}

fn band_height(rows: &[usize]) -> f64 {
    ROW * (rows.len() + 1) as f64
}

fn draw_part(svg: &mut Svg, axis: &Axis, part: &PartActions, rows: &[usize], top: f64) {
    svg.text(MARGIN, top + 0.5 * band_height(rows) + 4.0, 12.0, &clipped(&part.name));
    let walked = rows.len();
    for (row, by) in rows.iter().copied().map(Some).chain([None]).enumerate() {
        let y = top + ROW * row as f64;
        let shade = |shares: &Vec<(Option<usize>, f64)>| (SHADES * share_of(shares, by)).round();
        let shades: Vec<f64> = part.frames.iter().map(shade).collect();
        let mut first = 0;
        for run in shades.chunk_by(|a, b| a == b) {
            let last = first + run.len() - 1;
            if run[0] > 0.0 && last < axis.ends.len() {
                let [x, end] = [axis.ends[first][0], axis.ends[last][1]];
                svg.cell([x, y], [end - x, ROW], if row == walked { WALK } else { CLUSTER }, run[0] / SHADES);
            }
            first += run.len();
        }
    }
    svg.line([MARGIN + LABEL, top + band_height(rows)], [MARGIN + LABEL + TIME, top + band_height(rows)], 0.5, WALK);
}

fn draw_errors(svg: &mut Svg, axis: &Axis, errors_mm: &[(f64, f64)]) {
    let most = errors_mm.iter().map(|(_, error)| *error).fold(0.0, f64::max).max(1.0);
    let place = |error: f64| TOP + ERRORS * (1.0 - error / most);
    svg.text(MARGIN, TOP + 0.5 * ERRORS, 12.0, "joint error,");
    svg.text(MARGIN, TOP + 0.5 * ERRORS + 15.0, 12.0, "mm");
    for error in ticks(0.0, most, TICKS[1]) {
        svg.line([MARGIN + LABEL, place(error)], [MARGIN + LABEL + TIME, place(error)], 0.5, GRID);
        svg.text(MARGIN + LABEL - 30.0, place(error) + 4.0, 12.0, &shown(error));
    }
    let places: Vec<[f64; 2]> = errors_mm.iter().map(|(second, error)| [axis.place(*second), place(*error)]).collect();
    svg.polyline(&places, 1.2, CLUSTER);
}

/// Round numbers in a range, at most about that many.
fn ticks(from: f64, to: f64, most: f64) -> Vec<f64> {
    let rough = (to - from) / most;
    let decade = 10.0_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|k| k * decade).into_iter().find(|step| *step >= rough).unwrap_or(rough);
    let first = (from / step).ceil();
    (0..).map(|i| (first + f64::from(i)) * step).take_while(|tick| *tick <= to).collect()
}

/// A round number without the digits that it does not have.
fn shown(tick: f64) -> String {
    format!("{}", (1e6 * tick).round() / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trace(frames: usize) -> ActionTrace {
        // Cluster 9 moves first, then cluster 4; a quarter of the particles walks.
        let torso = |k: usize| vec![(Some(if 2 * k < frames { 9 } else { 4 }), 0.75), (None, 0.25)];
        let parts = vec![
            PartActions { name: "torso".into(), frames: (0..frames).map(torso).collect() },
            PartActions { name: "a<b".into(), frames: vec![vec![(None, 1.0)]; frames] },
        ];
        ActionTrace { time_s: (0..frames).map(|k| 0.05 * k as f64).collect(), parts }
    }

    #[test]
    fn clusters_have_rows_in_the_order_in_which_they_move() {
        let trace = trace(40);
        assert_eq!(drawn_clusters(&trace.parts[0]), [9, 4]);
        assert!(drawn_clusters(&trace.parts[1]).is_empty());
        let svg = action_picture("a trace", &trace, &[]);
        // Two clusters and the walk of the torso, the walk of the other part: equal neighbours are one.
        assert_eq!(svg.matches("fill-opacity").count(), 4);
        assert_eq!(svg.matches("fill-opacity=\"0.80\"").count(), 2);
        assert!(svg.contains("a&lt;b") && svg.contains(">1.6</text>") && !svg.contains("polyline"));
        let errors: Vec<(f64, f64)> = trace.time_s.iter().map(|t| (*t, 50.0 + 100.0 * t)).collect();
        let with_errors = action_picture("a trace", &trace, &errors);
        assert!(with_errors.contains("polyline") && with_errors.contains("joint error"));
    }

    #[test]
    fn many_clusters_are_cut_to_those_that_move_most() {
        let shares = |k: usize| (0..30).map(|c| (Some(c), (1.0 + (c * 7 + k) as f64 % 30.0) / 465.0)).collect();
        let part = PartActions { name: "head".into(), frames: vec![shares(0)] };
        let drawn = drawn_clusters(&part);
        assert!(drawn.len() == ROWS && drawn.contains(&17), "{drawn:?}");
    }

    #[test]
    fn a_trace_of_one_frame_or_none_is_drawn() {
        for frames in [0, 1] {
            let svg = action_picture("short", &trace(frames), &[]);
            assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        }
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(ticks(0.0, 100.0, 10.0), [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 90.0, 100.0]);
        assert_eq!(ticks(0.3, 1.1, 4.0), [0.4, 0.6000000000000001, 0.8, 1.0]);
        assert_eq!(shown(0.6000000000000001), "0.6");
    }
}
