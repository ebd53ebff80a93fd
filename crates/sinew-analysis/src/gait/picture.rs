//! A picture of gait: when each foot stands, and the angles over the cycle of both sides.
//!
//! Above, a bar for each stance, from heel strike to toe off, with the 90 % interval of both ends. Below, a panel for each angle: mean over the cycles, a band of one standard deviation between cycles, and a dashed line where the foot leaves in the mean. Of the pelvis and the trunk, which have no side, each line is over the cycles of that foot.

use super::analysis::GaitAnalysis;
use super::cycles::{AngleCycle, PLACES};
use super::events::{GaitEvent, GaitEventKind};
use super::strides::PARAMETERS;
use super::summary::summary;
use super::varied::interval;
use super::walk::SIDES;
use sinew_formats::svg::ticks;
use sinew_formats::svg::{Anchor, Svg, clipped};

/// Colours of left and right, readable beside each other for whoever sees red and green alike.
const COLOURS: [&str; 2] = ["#c2410c", "#1d4ed8"];
const GRID: &str = "#e5e7eb";
const AXIS: &str = "#9ca3af";

/// Width and height of a panel, room left of and below it, panels side by side, pixels.
const PANEL: [f64; 2] = [250.0, 150.0];
const GAP: [f64; 2] = [60.0, 58.0];
const BESIDE: usize = 3;
/// Margin, place of the timeline, and height of its rows, pixels.
const MARGIN: f64 = 24.0;
const TIMELINE: f64 = 86.0;
const ROW: f64 = 26.0;
const BAR: f64 = 12.0;
/// What bars, bands and dashes are.
const CAPTION: &str = "Bars: stance, with the 90 % intervals of its ends below. Curves: mean over the cycles from heel strike, ± 1 sd between cycles. Dashed: toe off.";
/// Least span of an axis of angles, degrees.
const LEAST_SPAN: f64 = 10.0;
/// Room beside the first and the last event, seconds.
const BESIDE_S: f64 = 0.2;

/// Angles with a panel, as `gait_cycles.csv` calls them without their side, and their words.
const ANGLES: [(&str, &str); 9] = [
    ("pelvic_tilt", "pelvis, tilt"),
    ("pelvic_obliquity", "pelvis, obliquity"),
    ("pelvic_rotation", "pelvis, rotation"),
    ("hip_flexion", "hip, flexion"),
    ("hip_adduction", "hip, adduction"),
    ("hip_rotation", "hip, rotation"),
    ("knee_angle", "knee, flexion"),
    ("ankle_angle", "ankle, dorsiflexion"),
    ("arm_flex", "shoulder, flexion"),
];

/// A panel: its words, and the cycles of left and right.
type Panel<'a> = (&'static str, [Option<&'a AngleCycle>; 2]);

/// The picture as SVG.
#[must_use]
pub fn gait_picture(title: &str, gait: &GaitAnalysis) -> String {
    let panels = panels(gait);
    let rows = panels.len().div_ceil(BESIDE) as f64;
    let width = MARGIN + BESIDE as f64 * (PANEL[0] + GAP[0]);
    let top = TIMELINE + 2.0 * ROW + 66.0;
    let mut svg = Svg::new(width, top + rows * (PANEL[1] + GAP[1]));
    svg.text(MARGIN, 28.0, 16.0, &clipped(title));
    svg.text(MARGIN, 48.0, 12.0, &words(gait));
    svg.text(MARGIN, 65.0, 11.0, CAPTION);
    timeline(&mut svg, gait, width - MARGIN);
    for (index, panel) in panels.iter().enumerate() {
        let (column, row) = ((index % BESIDE) as f64, (index / BESIDE) as f64);
        let corner = [MARGIN + 26.0 + column * (PANEL[0] + GAP[0]), top + row * (PANEL[1] + GAP[1])];
        draw_panel(&mut svg, gait, panel, corner);
    }
    svg.done()
}

/// What the strides come to, in a row.
fn words(gait: &GaitAnalysis) -> String {
    let all = summary(&gait.strides, None);
    let shown = |name: &str, factor: f64, digits: usize, words: &str| {
        let found = all[PARAMETERS.iter().position(|own| *own == name)?].as_ref()?;
        Some(format!("{:.digits$} {words}", factor * found.mean.mean))
    };
    let parts = [
        Some(format!("{} strides", gait.strides.len())),
        shown("speed_m_per_s", 1.0, 2, "m/s"),
        shown("cadence_per_min", 1.0, 0, "steps a minute"),
        shown("step_length_m", 1000.0, 0, "mm a step"),
        shown("stance_share", 100.0, 0, "% stance"),
    ];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// Bars of stance over time.
fn timeline(svg: &mut Svg, gait: &GaitAnalysis, right: f64) {
    let [Some(first), Some(last)] = [gait.events.first(), gait.events.last()] else { return };
    let (from, to) = (first.time_s - BESIDE_S, last.time_s + BESIDE_S);
    let left = MARGIN + 46.0;
    let x = |time_s: f64| left + (right - left) * (time_s - from) / (to - from);
    let bottom = TIMELINE + 2.0 * ROW;
    for tick in ticks([from, to]) {
        svg.line([x(tick), TIMELINE - 6.0], [x(tick), bottom], 0.5, GRID);
        svg.label([x(tick), bottom + 15.0], 11.0, Anchor::Middle, &number(tick));
    }
    svg.label([right, bottom + 29.0], 11.0, Anchor::End, "time, seconds");
    for (side, colour) in COLOURS.into_iter().enumerate() {
        let y = TIMELINE + ROW * side as f64;
        svg.label([left - 8.0, y + BAR - 1.0], 12.0, Anchor::End, SIDES[side]);
        let own: Vec<&GaitEvent> = gait.events.iter().filter(|event| event.side == side).collect();
        for pair in own.windows(2) {
            if let [GaitEventKind::HeelStrike, GaitEventKind::ToeOff] = [pair[0].kind, pair[1].kind] {
                let [start, end] = [x(pair[0].time_s), x(pair[1].time_s)];
                svg.cell([start, y], [end - start, BAR], colour, 0.35);
            }
        }
        for event in own {
            let at = x(event.time_s);
            svg.line([at, y - 1.0], [at, y + BAR + 1.0], 1.5, colour);
            if let Some([low, high]) = interval(&event.draws_s) {
                svg.line([x(low), y + BAR + 4.0], [x(high), y + BAR + 4.0], 2.0, colour);
            }
        }
    }
}

fn panels(gait: &GaitAnalysis) -> Vec<Panel<'_>> {
    let cycle = |side: usize, name: &str| {
        let own = format!("{name}_{}", ["l", "r"][side]);
        gait.cycles.iter().find(|cycle| cycle.side == side && (cycle.angle == name || cycle.angle == own))
    };
    let panel = |(name, words): (&str, &'static str)| (words, [cycle(0, name), cycle(1, name)]);
    ANGLES.into_iter().map(panel).filter(|(_, sides)| sides.iter().any(Option::is_some)).collect()
}

/// The mean less and plus the standard deviation between cycles, where there is one.
fn band(cycle: &AngleCycle) -> [Vec<f64>; 2] {
    let sd = |place: usize| if cycle.sd_deg[place].is_finite() { cycle.sd_deg[place] } else { 0.0 };
    [-1.0, 1.0].map(|sign| (0..PLACES).map(|place| cycle.mean_deg[place] + sign * sd(place)).collect())
}

fn draw_panel(svg: &mut Svg, gait: &GaitAnalysis, (words, sides): &Panel<'_>, [left, top]: [f64; 2]) {
    let values = sides.iter().flatten().flat_map(|cycle| band(cycle)).flatten().filter(|x| x.is_finite());
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    if low > high {
        return;
    }
    let wider = 0.5 * (LEAST_SPAN - (high - low)).max(0.1 * (high - low));
    let (low, high) = (low - wider, high + wider);
    let [width, height] = PANEL;
    let x = |percent: f64| left + width * percent / 100.0;
    let y = |degrees: f64| top + height * (high - degrees) / (high - low);
    svg.text(left, top - 8.0, 13.0, &format!("{words}, °"));
    for tick in ticks([low, high]) {
        svg.line([left, y(tick)], [left + width, y(tick)], 0.5, if tick == 0.0 { AXIS } else { GRID });
        svg.label([left - 6.0, y(tick) + 4.0], 11.0, Anchor::End, &number(tick));
    }
    for percent in [0.0, 20.0, 40.0, 60.0, 80.0, 100.0] {
        svg.line([x(percent), top], [x(percent), top + height], 0.5, GRID);
        svg.label([x(percent), top + height + 15.0], 11.0, Anchor::Middle, &number(percent));
    }
    svg.label([left + 0.5 * width, top + height + 29.0], 11.0, Anchor::Middle, "% of the cycle");
    let line = |values: &[f64]| -> Vec<[f64; 2]> {
        values.iter().enumerate().map(|(percent, value)| [x(percent as f64), y(*value)]).collect()
    };
    let stance = PARAMETERS.iter().position(|name| *name == "stance_share").unwrap_or_default();
    for (side, cycle) in sides.iter().enumerate().filter_map(|(side, cycle)| Some((side, (*cycle)?))) {
        let [below, above] = band(cycle).map(|ends| line(&ends));
        svg.area(&[below, above.into_iter().rev().collect()].concat(), COLOURS[side], 0.18);
        svg.polyline(&line(&cycle.mean_deg), 1.8, COLOURS[side]);
        if let Some(found) = &summary(&gait.strides, Some(side))[stance] {
            let at = x(100.0 * found.mean.mean);
            svg.dashed([at, top], [at, top + height], COLOURS[side]);
        }
    }
}

/// A number with as many digits as it needs, at most one behind the point.
fn number(value: f64) -> String {
    let text = format!("{value:.1}");
    let short = text.strip_suffix(".0").unwrap_or(&text);
    if short == "-0" { "0".into() } else { short.replace('-', "−") }
}

#[cfg(test)]
mod tests {
    use super::super::strides::Stride;
    use super::*;

    fn gait() -> GaitAnalysis {
        let event = |side, kind, time_s: f64| GaitEvent {
            side,
            kind,
            point: "Heel".into(),
            time_s,
            draws_s: vec![time_s - 0.01, time_s + 0.01],
        };
        let stride = Stride { side: 0, start_s: 1.0, end_s: 2.0, toe_off_s: None, parameters: Default::default() };
        let cycle = |side: usize, angle: &str| AngleCycle {
            side,
            angle: angle.into(),
            cycles: 1,
            mean_deg: (0..PLACES).map(|k| (k as f64 / 16.0).sin() * 30.0).collect(),
            sd_deg: vec![if side == 0 { f64::NAN } else { 2.0 }; PLACES],
            interval_deg: None,
        };
        GaitAnalysis {
            events: vec![event(0, GaitEventKind::HeelStrike, 1.0), event(0, GaitEventKind::ToeOff, 1.6)],
            strides: vec![stride],
            cycles: vec![cycle(0, "knee_angle_l"), cycle(1, "knee_angle_r"), cycle(1, "knee_angle_l")],
            ..GaitAnalysis::default()
        }
    }

    /// Values of an attribute of all elements of a kind, in their order.
    fn attributes<'a>(svg: &'a str, element: &str, name: &str) -> Vec<&'a str> {
        let value =
            |element: &'a str| element.split_once(&format!(" {name}=\""))?.1.split_once('"').map(|(value, _)| value);
        svg.split(&format!("<{element}")).skip(1).map(|own| value(own.split('>').next().unwrap()).unwrap()).collect()
    }

    /// Where a text stands.
    fn label(svg: &str, text: &str) -> [f64; 2] {
        let own = svg
            .split("<text")
            .find(|own| own.split_once('>').is_some_and(|(_, rest)| rest.starts_with(&format!("{text}<"))));
        ["x", "y"].map(|name| attributes(&format!("<text{}", own.unwrap()), "text", name)[0].parse().unwrap())
    }

    fn points(text: &str) -> Vec<[f64; 2]> {
        let point = |text: &str| text.split_once(',').map(|(x, y)| [x, y].map(|number| number.parse().unwrap()));
        text.split(' ').filter_map(point).collect()
    }

    /// Curves and bands against the numbers at the axes: 0° at the beginning, two standard deviations above and below.
    #[test]
    fn curves_lie_where_the_axes_say() {
        let svg = gait_picture("walk", &gait());
        let curves: Vec<_> = attributes(&svg, "polyline", "points").into_iter().map(points).collect();
        let bands: Vec<_> = attributes(&svg, "polygon", "points").into_iter().map(points).collect();
        // Degrees come before shares of the cycle.
        let (_, panel) = svg.split_once("knee, flexion").unwrap();
        let [_, zero_y] = label(panel, "0");
        let [_, twenty_y] = label(panel, "20");
        let degree = (zero_y - twenty_y) / 20.0;
        for (curve, band) in curves.iter().zip(&bands) {
            assert_eq!((curve.len(), band.len()), (PLACES, 2 * PLACES));
            for percent in [0_usize, 40, 80, 100] {
                let expected = (percent as f64 / 16.0).sin() * 30.0;
                let [x, y] = curve[percent];
                assert!((y - (zero_y - 4.0 - degree * expected)).abs() < 0.2, "{percent}: {y}");
                let from_left = (x - curve[0][0]) / (curve[100][0] - curve[0][0]);
                assert!((from_left - percent as f64 / 100.0).abs() < 1e-3, "{percent}: {x}");
            }
        }
        for (side, sd) in [(0, 0.0), (1, 2.0)] {
            let (curve, band) = (&curves[side], &bands[side]);
            for place in [0, 33] {
                let [below, above] = [band[place], band[2 * PLACES - 1 - place]].map(|[_, y]| y - curve[place][1]);
                assert!((below - sd * degree).abs() < 0.2 && (above + sd * degree).abs() < 0.2, "{below} {above}");
            }
        }
        let [forty_x, _] = label(panel, "40");
        assert!((forty_x - curves[0][40][0]).abs() < 0.1, "{forty_x}");
        let [width, height] = ["width", "height"].map(|name| attributes(&svg, "svg", name)[0].parse::<f64>().unwrap());
        let all = curves.iter().chain(&bands).flatten();
        assert!(all.clone().all(|[x, y]| (0.0..width).contains(x) && (0.0..height).contains(y)), "{width} × {height}");
        assert!(label(panel, "% of the cycle")[1] < height);
    }

    #[test]
    fn both_sides_of_an_angle_share_a_panel_and_nothing_leaves_the_picture() {
        let svg = gait_picture("walk <1>", &gait());
        assert_eq!(svg.matches("knee, flexion").count(), 1);
        assert_eq!(svg.matches("<polyline").count(), 2);
        assert_eq!(svg.matches("<polygon").count(), 2);
        assert!(svg.contains("walk &lt;1&gt;") && svg.ends_with("</svg>\n"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        assert_eq!(svg.matches("fill-opacity=\"0.35\"").count(), 1);
    }

    #[test]
    fn gait_of_nothing_is_a_picture_without_panels() {
        let svg = gait_picture("none", &GaitAnalysis::default());
        assert!(svg.contains("0 strides") && !svg.contains("NaN"));
    }

    #[test]
    fn numbers_are_short() {
        let shown: Vec<String> = [0.0, -0.0, -20.0, 2.5].map(number).into();
        assert_eq!(shown, ["0", "0", "−20", "2.5"]);
    }
}
