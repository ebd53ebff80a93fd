//! A picture of a latent model: one panel a node, the root first.
//!
//! Dots are the latents that were learned from, coloured by time, with a line through each sequence. The background is darker where the node knows less. Stick figures around them are poses that the model decodes from the latents farthest
//! out in eight directions; what a node does not generate stays at its mean.

use super::latent_model::{body_of, read};
use super::latent_plane::Plane;
use super::stick_figure::{FROM_THE_RIGHT, MIDDLE, figure};
use crate::Error;
use rayon::prelude::*;
use sinew_body::points::points_of_states;
use sinew_core::decode::Decode as _;
use sinew_core::lanes::Isa;
use sinew_formats::svg::{Anchor, Svg, clipped, ticks};
use sinew_latent::file::StoredModel;
use sinew_latent::space::Below;
use sinew_motion::follow::NamedBody;
use sinew_motion::learn::LearnError;
use sinew_motion::learn::limbs::name_of;
use std::path::Path;

/// Nodes that are drawn at most.
const MOST: usize = 24;
/// Panels side by side.
const BESIDE: usize = 3;
/// Side of the panel of a single node, and of one among several, pixels.
const SIDES: [f64; 2] = [600.0, 360.0];
/// Room left of a panel and below it for its axes, above it for its name.
const AXES: [f64; 2] = [64.0, 52.0];
const NAME: f64 = 30.0;
/// Margin of the picture, height of its title and of its legend.
const MARGIN: f64 = 16.0;
const TITLE: f64 = 34.0;
const LEGEND: f64 = 64.0;
/// Cells of the background along a side, and levels of grey.
const CELLS: usize = 60;
const LEVELS: f64 = 10.0;
/// Background where nothing is known.
const DARKEST: [u8; 3] = [163, 170, 180];
const LIGHT: &str = "#94a3b8";
/// Directions in which a figure stands.
const FIGURES: usize = 8;
/// Distance of the middle of a figure from the edge, and its height a metre, as shares of the side.
const INSET: f64 = 0.085;
const METRE: f64 = 0.075;
/// Least distance of two latents that have a figure, as a share of the side.
const APART: f64 = 0.05;
/// Colours of time, from the start of a sequence to its end.
const TIME: [[u8; 3]; 5] = [[30, 58, 138], [11, 110, 153], [63, 156, 109], [217, 165, 20], [194, 65, 12]];

/// The picture of the model in a file, as SVG.
///
/// # Errors
/// A file that cannot be read or is no latent model.
pub fn latent_picture(path: &Path) -> Result<String, Error> {
    let stored = read(path)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    Ok(picture(&stored, &name).map_err(LearnError::Latent)?)
}

/// Where a panel is.
#[derive(Clone, Copy)]
struct Panel {
    corner: [f64; 2],
    side: f64,
}

impl Panel {
    /// Pixels of a place of a plane.
    fn at(&self, plane: &Plane, place: [f64; 2]) -> [f64; 2] {
        let share = |k: usize| (place[k] - plane.extent[k][0]) / (plane.extent[k][1] - plane.extent[k][0]);
        [self.corner[0] + self.side * share(0), self.corner[1] + self.side * (1.0 - share(1))]
    }
}

fn picture(stored: &StoredModel, name: &str) -> Result<String, sinew_latent::Error> {
    let StoredModel { state, frame_rate, kind, model, .. } = stored;
    let count = model.nodes.len().min(MOST);
    let (columns, side) = (count.min(BESIDE), if count == 1 { SIDES[0] } else { SIDES[1] });
    let step = [side + AXES[0] + MARGIN, NAME + side + AXES[1]];
    let height = TITLE + step[1] * count.div_ceil(BESIDE) as f64;
    let mut svg = Svg::new(2.0 * MARGIN + step[0] * columns as f64, height + LEGEND + MARGIN);
    let rows = model.rows();
    let title =
        format!("{}: {kind} of {}, {frame_rate} frames per second, {rows} poses", clipped(name), clipped(state));
    svg.text(MARGIN, 24.0, 15.0, &title);
    let body = body_of(stored);
    for n in 0..count {
        let place = [n % BESIDE, n / BESIDE].map(|k| k as f64);
        let corner = [MARGIN + AXES[0] + step[0] * place[0], TITLE + NAME + step[1] * place[1]];
        let panel = Panel { corner, side };
        let plane = Plane::new(model, n)?;
        let coordinates = if model.nodes[n].dim == 1 { "coordinate" } else { "coordinates" };
        let words = format!("{}: {} {coordinates}", name_of(body, model, n), model.nodes[n].dim);
        svg.text(corner[0], corner[1] - 8.0, 13.0, &words);
        background(&mut svg, panel, &plane);
        paths(&mut svg, panel, &plane);
        if let Some(body) = body {
            figures(&mut svg, panel, &plane, stored, body, n)?;
        }
        axes(&mut svg, panel, &plane);
    }
    legend(&mut svg, [MARGIN + AXES[0], height + 8.0], body.is_some());
    Ok(svg.done())
}

/// Cells of equal grey side by side are one.
fn background(svg: &mut Svg, panel: Panel, plane: &Plane) {
    let cell = panel.side / CELLS as f64;
    let level = |row: usize, column: usize| {
        let share = |k: usize| (k as f64 + 0.5) / CELLS as f64;
        let value = |k: usize, share: f64| plane.extent[k][0] + share * (plane.extent[k][1] - plane.extent[k][0]);
        (LEVELS * plane.uncertainty([value(0, share(column)), value(1, 1.0 - share(row))])).round() as usize
    };
    let rows: Vec<Vec<usize>> =
        (0..CELLS).into_par_iter().map(|row| (0..CELLS).map(|column| level(row, column)).collect()).collect();
    for (row, levels) in rows.iter().enumerate() {
        let mut column = 0;
        for run in levels.chunk_by(|a, b| a == b).filter(|run| !run.is_empty()) {
            let corner = [panel.corner[0] + cell * column as f64, panel.corner[1] + cell * row as f64];
            // A little more than a cell, so that no seams are seen.
            let size = [cell * run.len() as f64 + 0.2, cell + 0.2];
            svg.cell(corner, size, &shade(run[0] as f64 / LEVELS), 1.0);
            column += run.len();
        }
    }
}

/// Colour of the background at an uncertainty: white where it is 0.
fn shade(uncertainty: f64) -> String {
    blend([255; 3], DARKEST, uncertainty)
}

fn blend(from: [u8; 3], to: [u8; 3], share: f64) -> String {
    let mix = |k: usize| ((1.0 - share) * f64::from(from[k]) + share * f64::from(to[k])).round() as u8;
    format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2))
}

/// Sequences as lines, latents as dots.
fn paths(svg: &mut Svg, panel: Panel, plane: &Plane) {
    let places: Vec<[f64; 2]> = plane.points.iter().map(|&point| panel.at(plane, point)).collect();
    let mut rest = &places[..];
    for &length in &plane.lengths {
        let (own, others) = rest.split_at(length.min(rest.len()));
        svg.polyline(own, 0.8, MIDDLE);
        rest = others;
    }
    let radius = if panel.side > SIDES[1] { 3.0 } else { 2.0 };
    for (place, time) in places.iter().zip(&plane.times) {
        svg.circle(*place, radius, &time_color(*time));
    }
}

fn time_color(time: f64) -> String {
    let at = time.clamp(0.0, 1.0) * (TIME.len() - 1) as f64;
    let first = (at as usize).min(TIME.len() - 2);
    blend(TIME[first], TIME[first + 1], at - first as f64)
}

/// The rows farthest out in each direction, with the middles of their figures; none near another.
fn outermost(panel: Panel, plane: &Plane) -> Vec<(usize, [f64; 2])> {
    let centre = [0, 1].map(|k| panel.corner[k] + 0.5 * panel.side);
    let mut found: Vec<(usize, [f64; 2])> = vec![];
    for k in 0..FIGURES {
        let angle = std::f64::consts::TAU * k as f64 / FIGURES as f64;
        let way = [angle.cos(), -angle.sin()];
        let along = |&point: &[f64; 2]| {
            let at = panel.at(plane, point);
            (at[0] - centre[0]) * way[0] + (at[1] - centre[1]) * way[1]
        };
        let Some((row, _)) = plane.points.iter().map(along).enumerate().max_by(|a, b| a.1.total_cmp(&b.1)) else {
            continue;
        };
        // On the edge of a square, not on a circle.
        let reach = panel.side * (0.5 - INSET) / way[0].abs().max(way[1].abs());
        let from = |known: usize| {
            let [a, b] = [known, row].map(|row| panel.at(plane, plane.points[row]));
            (a[0] - b[0]).hypot(a[1] - b[1])
        };
        if found.iter().all(|(known, _)| from(*known) > APART * panel.side) {
            found.push((row, [centre[0] + reach * way[0], centre[1] + reach * way[1]]));
        }
    }
    found
}

fn figures(
    svg: &mut Svg,
    panel: Panel,
    plane: &Plane,
    stored: &StoredModel,
    body: NamedBody,
    n: usize,
) -> Result<(), sinew_latent::Error> {
    let StoredModel { model, free, .. } = stored;
    let below = Below::new(model, n, Isa::baseline())?;
    let (drawn, tree) = (outermost(panel, plane), body.tree());
    let state = |&(row, _): &(usize, [f64; 2])| {
        let mut decoded = vec![0.0; below.columns().len()];
        below.decode(model.nodes[n].latent(row), &mut decoded);
        let mut state = [&vec![0.0; *free], &model.standard.mean[..]].concat();
        state.resize(tree.dof(), 0.0);
        below.columns().iter().zip(&decoded).for_each(|(&j, &x)| state[free + j] = x);
        state
    };
    let states: Vec<Vec<f64>> = drawn.iter().map(state).collect();
    let motion = points_of_states(&tree, &states);
    let scale = METRE * panel.side;
    for ((row, centre), frame) in drawn.iter().zip(&motion.frames) {
        let place = panel.at(plane, plane.points[*row]);
        svg.line(place, *centre, 0.7, LIGHT);
        svg.ring(place, 4.5, MIDDLE);
        // Hips are a little above the middle of a figure.
        figure(svg, &motion, frame, FROM_THE_RIGHT, scale, [centre[0], centre[1] - 0.1 * scale]);
    }
    Ok(())
}

fn axes(svg: &mut Svg, panel: Panel, plane: &Plane) {
    let Panel { corner: [left, top], side } = panel;
    svg.frame(left, top, side);
    let bottom = top + side;
    for x in ticks(plane.extent[0]) {
        let [at, _] = panel.at(plane, [x, plane.extent[1][0]]);
        svg.line([at, bottom], [at, bottom + 5.0], 1.0, MIDDLE);
        svg.label([at, bottom + 18.0], 11.0, Anchor::Middle, &number(x));
    }
    for y in ticks(plane.extent[1]) {
        let [_, at] = panel.at(plane, [plane.extent[0][0], y]);
        svg.line([left - 5.0, at], [left, at], 1.0, MIDDLE);
        svg.label([left - 8.0, at + 4.0], 11.0, Anchor::End, &number(y));
    }
    svg.label([left + 0.5 * side, bottom + 36.0], 12.0, Anchor::Middle, &plane.names[0]);
    svg.upright([left - 46.0, top + 0.5 * side], 12.0, &plane.names[1]);
}

/// A tick's number, without digits that mean nothing.
fn number(x: f64) -> String {
    let rounded = format!("{x:.4}");
    let shown = rounded.trim_end_matches('0').trim_end_matches('.');
    let shown = if shown == "-0" { "0" } else { shown };
    shown.replace('-', "−")
}

fn legend(svg: &mut Svg, [left, top]: [f64; 2], has_figures: bool) {
    const STEPS: usize = 40;
    const WIDTH: f64 = 120.0;
    let step = WIDTH / STEPS as f64;
    for k in 0..STEPS {
        let (share, x) = (k as f64 / (STEPS - 1) as f64, left + step * k as f64);
        svg.cell([x, top], [step + 0.2, 12.0], &time_color(share), 1.0);
        svg.cell([x, top + 22.0], [step + 0.2, 12.0], &shade(share), 1.0);
    }
    let after = left + WIDTH + 10.0;
    svg.text(after, top + 10.0, 12.0, "dots: time, from the start of a sequence to its end");
    svg.text(after, top + 32.0, 12.0, "background: predictive standard deviation, 0 to that where nothing is known");
    if has_figures {
        svg.text(after, top + 54.0, 12.0, "figures, from the right: poses decoded from the latents with a ring");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_latent::file::LatentKind;
    use sinew_latent::{gplvm, hgplvm};
    use sinew_motion::learn::limbs::branches;

    fn rows() -> Vec<f64> {
        (0..30 * 18).map(|k| 0.3 * (0.4 * f64::from(k / 18) * (1.0 + 0.1 * f64::from(k % 18))).sin()).collect()
    }

    #[test]
    fn a_space_has_dots_lines_and_figures() {
        let model = gplvm::model(&rows(), 18, &gplvm::Config::default()).unwrap();
        let mut stored =
            StoredModel { state: "hppf24".into(), frame_rate: 20.0, free: 6, kind: LatentKind::Gplvm, model };
        let svg = picture(&stored, "a<b.json").unwrap();
        assert!(svg.contains("a&lt;b.json: gplvm of hppf24") && svg.contains("body: 3 coordinates"));
        assert_eq!(svg.matches("<polyline").count(), 1);
        let rings = svg.matches("class=\"ring\"").count();
        assert!((3..=FIGURES).contains(&rings), "{rings}");
        // Each figure has a head.
        assert_eq!(svg.matches("<circle").count(), 30 + 2 * rings);
        stored.state = "horse".into();
        let svg = picture(&stored, "m").unwrap();
        assert!(!svg.contains("class=\"ring\"") && svg.contains("node 0: 3 coordinates"));
    }

    #[test]
    fn a_tree_has_a_panel_a_node() {
        let rows = rows();
        let tree = branches(NamedBody::Hppf24, &rows, 2).unwrap();
        let config = hgplvm::Config { tree, root_per_motion: true };
        let model = hgplvm::model(&rows, 18, &[12, 18], &[1, 1], &config).unwrap();
        let stored = StoredModel { state: "hppf24".into(), frame_rate: 20.0, free: 6, kind: LatentKind::Hgplvm, model };
        let svg = picture(&stored, "m").unwrap();
        for name in [
            "body of rows 0 to 11",
            "body of rows 12 to 29",
            "legs",
            "arms",
            "trunk",
            "l_leg",
            "r_leg",
            "l_arm",
            "r_arm",
        ] {
            assert!(svg.contains(&format!("{name}: 2 coordinates")), "{name}");
        }
        // Two roots with a sequence each, seven other nodes with both.
        assert_eq!(svg.matches("<polyline").count(), 2 + 7 * 2);
    }

    #[test]
    fn ticks_have_short_numbers() {
        assert_eq!([0.5, -2.0, -1e-9, 0.0025].map(number), ["0.5", "−2", "0", "0.0025"]);
    }
}
