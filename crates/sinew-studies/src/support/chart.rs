//! Panels of lines with error bars and direct labels, as SVG.

use crate::support::outcome::Outcome;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::ops::Range;
use std::path::Path;

/// Colours that people who see red and green alike distinguish (Okabe & Ito 2008).
pub const BLUE: RGBColor = RGBColor(0, 114, 178);
pub const ORANGE: RGBColor = RGBColor(213, 94, 0);
pub const GREEN: RGBColor = RGBColor(0, 158, 115);
pub const PURPLE: RGBColor = RGBColor(204, 121, 167);

pub const GREY: RGBColor = RGBColor(120, 120, 120);

/// A line of points with the lower and upper end of each error bar.
pub struct Line {
    /// Its name, written beside it.
    pub name: String,
    /// Its colour.
    pub colour: RGBColor,
    /// Places and, for the vertical one, the ends of its bar.
    pub points: Vec<[f64; 4]>,
}

/// Part of a picture.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Where the names of lines stand.
#[derive(Clone, Copy)]
pub enum Names {
    /// At the last points.
    Inside,
    /// In a margin of that width on the right, one below the other, with a thin line from the last point.
    Beside(u32),
    /// Nowhere.
    None,
}

/// A panel; on axes (x, y) that are in decades, values are logarithms of base ten.
pub struct Panel<'a> {
    pub title: String,
    pub axes: [&'a str; 2],
    pub lines: Vec<Line>,
    pub in_decades: [bool; 2],
    pub names: Names,
}

/// A point whose bar ends at two standard errors.
pub fn with_bar(x: f64, [y, error]: [f64; 2]) -> [f64; 4] {
    [x, y, y - 2.0 * error, y + 2.0 * error]
}

/// A point without a bar.
pub fn bare(x: f64, y: f64) -> [f64; 4] {
    [x, y, y, y]
}

/// Draws panels on white, rows and columns of them; one without lines leaves its place empty.
pub fn draw(path: &Path, size: (u32, u32), grid: (usize, usize), panels: &[Panel<'_>]) -> Outcome<()> {
    let root = SVGBackend::new(path, size).into_drawing_area();
    root.fill(&WHITE)?;
    for (area, panel) in root.split_evenly(grid).iter().zip(panels).filter(|(_, panel)| !panel.lines.is_empty()) {
        draw_panel(area, panel)?;
    }
    finish(&root)
}

fn draw_panel(area: &Area<'_>, panel: &Panel<'_>) -> Outcome<()> {
    let Panel { title, axes: [x, y], lines, in_decades, names } = panel;
    let (wide, high) = (extent(lines, |p| [p[0], p[0]]), extent(lines, |p| [p[2], p[3]]));
    let [across, up] = [decimals(&wide), decimals(&high)];
    let mut chart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 15))
        .margin(8)
        .margin_right(if let Names::Beside(width) = names { *width } else { 8 })
        .x_label_area_size(36)
        .y_label_area_size(58)
        .build_cartesian_2d(wide, high)?;
    chart
        .configure_mesh()
        .x_desc(*x)
        .y_desc(*y)
        .x_label_formatter(&|v| shown(*v, in_decades[0], across))
        .y_label_formatter(&|v| shown(*v, in_decades[1], up))
        .x_labels(5)
        .y_labels(5)
        .light_line_style(WHITE)
        .bold_line_style(RGBColor(225, 225, 225))
        .label_style(("sans-serif", 12))
        .draw()?;
    for line in lines {
        chart.draw_series(LineSeries::new(line.points.iter().map(|p| (p[0], p[1])), line.colour.stroke_width(2)))?;
        for &[x, _, low, high] in line.points.iter().filter(|p| p[3] > p[2]) {
            chart.draw_series(std::iter::once(PathElement::new(
                vec![(x, low), (x, high)],
                line.colour.stroke_width(1),
            )))?;
        }
    }
    match names {
        Names::None => {}
        Names::Inside => {
            for (line, at) in lines.iter().filter_map(|line| Some((line, last(line)?))) {
                let style = ("sans-serif", 12).into_font().color(&line.colour);
                let style = style.pos(Pos::new(HPos::Right, VPos::Bottom));
                chart.draw_series(std::iter::once(Text::new(line.name.clone(), at, style)))?;
            }
        }
        Names::Beside(_) => {
            let ends = lines.iter().filter_map(|line| Some((line, chart.backend_coord(&last(line)?)))).collect();
            let (across, down) = chart.plotting_area().get_pixel_range();
            names_beside(area, ends, [across.end, down.end])?;
        }
    }
    Ok(())
}

/// What an axis shows: all points' ends on it with a margin.
fn extent(lines: &[Line], of: impl Fn(&[f64; 4]) -> [f64; 2]) -> Range<f64> {
    let all = || lines.iter().flat_map(|line| &line.points).map(&of);
    let low = all().map(|ends| ends[0]).fold(f64::INFINITY, f64::min);
    let high = all().map(|ends| ends[1]).fold(f64::NEG_INFINITY, f64::max);
    let margin = 0.05 * (high - low).max(1e-3);
    (low - margin)..(high + margin)
}

/// Decimals of the labels of an axis.
fn decimals(range: &Range<f64>) -> usize {
    if range.end - range.start < 1.0 { 2 } else { usize::from(range.end < 10.0) }
}

/// Where a line ends.
fn last(line: &Line) -> Option<(f64, f64)> {
    line.points.last().map(|p| (p[0], p[1]))
}

/// A value on an axis, in decades or not.
fn shown(v: f64, in_decades: bool, decimals: usize) -> String {
    let power = 10_f64.powf(v);
    if !in_decades {
        format!("{v:.decimals$}")
    } else if power < 0.95 {
        format!("{power:.1}")
    } else if power < 1000.0 {
        format!("{power:.0}")
    } else {
        format!("{power:.0e}")
    }
}

/// Writes names to the right of a panel that ends at a pixel, each with a thin line from the pixel where its line ends.
fn names_beside(area: &Area<'_>, mut ends: Vec<(&Line, (i32, i32))>, [right, bottom]: [i32; 2]) -> Outcome<()> {
    let (across, down) = area.get_pixel_range();
    let (right, bottom) = (right - across.start, bottom - down.start);
    ends.iter_mut().for_each(|(_, (x, y))| (*x, *y) = (*x - across.start, *y - down.start));
    ends.sort_by_key(|(_, (_, y))| *y);
    for ((line, (x, y)), label) in ends.iter().zip(spread(ends.iter().map(|(_, (_, y))| *y), bottom)) {
        let leader = vec![(*x, *y), (right + 2, label), (right + 6, label)];
        area.draw(&PathElement::new(leader, line.colour.mix(0.4).stroke_width(1)))?;
        let style = ("sans-serif", 12).into_font().color(&line.colour);
        let style = style.pos(Pos::new(HPos::Left, VPos::Center));
        area.draw(&Text::new(line.name.clone(), (right + 8, label), style))?;
    }
    Ok(())
}

/// Heights of names, from the top down, that are a line of text apart and not below the bottom.
fn spread(wanted: impl Iterator<Item = i32>, bottom: i32) -> Vec<i32> {
    const APART: i32 = 14;
    let mut heights: Vec<i32> = wanted.collect();
    for i in 1..heights.len() {
        heights[i] = heights[i].max(heights[i - 1] + APART);
    }
    let mut limit = bottom;
    for height in heights.iter_mut().rev() {
        *height = (*height).min(limit);
        limit = *height - APART;
    }
    heights
}

/// Writes the picture.
pub fn finish(root: &Area<'_>) -> Outcome<()> {
    Ok(root.present()?)
}

#[cfg(test)]
mod tests {
    use super::spread;

    #[test]
    fn names_stand_apart_and_above_the_bottom() {
        assert_eq!(spread([10, 12, 90].into_iter(), 100), [10, 24, 90]);
        assert_eq!(spread([80, 95, 99].into_iter(), 100), [72, 86, 100]);
        assert_eq!(spread([].into_iter(), 100), [0; 0]);
    }
}
