//! Bland–Altman pictures: the difference over the mean of both, with bias and limits of agreement.

use super::agreement::{Agreement, Pair};
use super::outcome::{ComparedSeries, Comparison};
use sinew_formats::svg::{Anchor, Svg, clipped, ticks};

/// Panels beside each other, their size and what is between them, pixels.
const BESIDE: usize = 4;
const PANEL: [f64; 2] = [190.0, 130.0];
const GAP: [f64; 2] = [58.0, 58.0];
const MARGIN: f64 = 20.0;
const TOP: f64 = 92.0;

/// Pairs of a series that are drawn, at most.
const SHOWN: usize = 150;

/// Colours of x, y and z; angles have the first.
const COLOURS: [&str; 3] = ["#2563eb", "#d97706", "#059669"];
const AXIS: &str = "#9ca3af";
const GRID: &str = "#e5e7eb";

/// A series with its numbers.
type Shown<'a> = (&'a ComparedSeries, &'a Agreement);

/// The picture as SVG.
pub(super) fn bland_altman(title: &str, found: &Comparison) -> String {
    let series: Vec<Shown<'_>> = found.series.iter().zip(&found.agreements).collect();
    let (beside, unit) = if found.is_of_points() { (3, "mm") } else { (1, "°") };
    let panels: Vec<&[Shown<'_>]> = series.chunks(beside).collect();
    let rows = panels.len().div_ceil(BESIDE) as f64;
    let mut svg =
        Svg::new(2.0 * MARGIN + BESIDE as f64 * (PANEL[0] + GAP[0]), TOP + rows * (PANEL[1] + GAP[1]) + MARGIN);
    svg.text(MARGIN, 28.0, 16.0, &clipped(title));
    let across = if found.is_of_points() { "the mean of both, from its middle," } else { "the mean of both," };
    let words = format!("Result less reference over {across} {unit}; lines: bias, dashed: 95 % limits of agreement");
    svg.text(MARGIN, 48.0, 12.0, &words);
    if found.is_of_points() {
        for (at, (axis, colour)) in ["x", "y", "z"].into_iter().zip(COLOURS).enumerate() {
            let x = MARGIN + 40.0 * at as f64;
            svg.circle([x + 4.0, 62.0], 3.0, colour);
            svg.text(x + 12.0, 66.0, 12.0, axis);
        }
    }
    for (index, panel) in panels.iter().enumerate() {
        let (column, row) = ((index % BESIDE) as f64, (index / BESIDE) as f64);
        let corner = [MARGIN + GAP[0] - 10.0 + column * (PANEL[0] + GAP[0]), TOP + row * (PANEL[1] + GAP[1])];
        draw(&mut svg, panel, corner, if found.is_of_points() { 1000.0 } else { 1.0 });
    }
    svg.done()
}

/// The pairs of a series as places: mean less the series' mean for points, whose axes would lie apart, and difference.
fn places((series, _): &Shown<'_>, factor: f64) -> Vec<[f64; 2]> {
    let mean = |pair: &Pair| 0.5 * (pair.ours + pair.reference);
    let centre = if series.axis.is_some() {
        series.pairs.iter().map(mean).sum::<f64>() / series.pairs.len() as f64
    } else {
        0.0
    };
    let every = series.pairs.len().div_ceil(SHOWN).max(1);
    let place = |pair: &Pair| [factor * (mean(pair) - centre), factor * pair.difference()];
    series.pairs.iter().step_by(every).map(place).collect()
}

fn draw(svg: &mut Svg, panel: &[Shown<'_>], [left, top]: [f64; 2], factor: f64) {
    let places: Vec<Vec<[f64; 2]>> = panel.iter().map(|shown| places(shown, factor)).collect();
    let lines = panel.iter().flat_map(|(_, agreement)| agreement.limits.limits).map(|limit| factor * limit);
    let range = |values: &mut dyn Iterator<Item = f64>| {
        let ends = |(low, high): (f64, f64), x: f64| (low.min(x), high.max(x));
        let (low, high) = values.filter(|x| x.is_finite()).fold((f64::INFINITY, f64::NEG_INFINITY), ends);
        let wider = 0.05 * (high - low).max(1e-3);
        [low - wider, high + wider]
    };
    let all = || places.iter().flatten();
    let [across, along] = [range(&mut all().map(|at| at[0])), range(&mut all().map(|at| at[1]).chain(lines))];
    let [width, height] = PANEL;
    let x = |value: f64| left + width * (value - across[0]) / (across[1] - across[0]);
    let y = |value: f64| top + height * (along[1] - value) / (along[1] - along[0]);
    svg.text(left, top - 8.0, 13.0, &clipped(&panel[0].0.name));
    for tick in ticks(along) {
        svg.line([left, y(tick)], [left + width, y(tick)], 0.5, if tick == 0.0 { AXIS } else { GRID });
        svg.label([left - 6.0, y(tick) + 4.0], 11.0, Anchor::End, &number(tick));
    }
    for tick in ticks(across) {
        svg.line([x(tick), top], [x(tick), top + height], 0.5, GRID);
        svg.label([x(tick), top + height + 15.0], 11.0, Anchor::Middle, &number(tick));
    }
    for (((_, agreement), places), colour) in panel.iter().zip(&places).zip(COLOURS) {
        places.iter().for_each(|[across, along]| svg.circle([x(*across), y(*along)], 1.2, colour));
        let bias = y(factor * agreement.limits.bias);
        svg.line([left, bias], [left + width, bias], 1.5, colour);
        for limit in agreement.limits.limits.map(|limit| y(factor * limit)) {
            svg.dashed([left, limit], [left + width, limit], colour);
        }
    }
}

/// A number with as few digits as it needs.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".into() } else { short.replace('-', "−") }
}
