//! Rank histograms and ECDF differences of a calibration as SVG (feature `svg`).

use crate::calibration::{Ranks, ecdf_difference, histogram};
use plotters::prelude::*;
use statrs::distribution::{Binomial, DiscreteCDF};

const BLUE: RGBColor = RGBColor(0, 114, 178);
const BAND: RGBColor = RGBColor(225, 225, 225);
const SIZE: (u32, u32) = (320, 220);
const COLUMNS: usize = 3;

/// One histogram for each test function, with the band that 99 % of the bars of a calibrated sampler keep, each taken alone.
///
/// # Errors
/// Text when the picture cannot be drawn.
pub fn rank_histograms(ranks: &Ranks, bins: usize) -> Result<String, String> {
    pictures(ranks, |values| {
        let counts = histogram(values, ranks.draws, bins);
        let law = Binomial::new(1.0 / bins as f64, values.len() as u64).map_err(|error| error.to_string())?;
        let quantile = |p: f64| law.inverse_cdf(p) as f64;
        let width = (ranks.draws + 1) as f64 / bins as f64;
        let outline = counts
            .iter()
            .enumerate()
            .flat_map(|(bin, &count)| [(bin as f64 * width, count as f64), ((bin + 1) as f64 * width, count as f64)]);
        let ends = (ranks.draws + 1) as f64;
        let band = vec![(0.0, quantile(0.005), quantile(0.995)), (ends, quantile(0.005), quantile(0.995))];
        Ok(Panel { line: outline.collect(), band, from_zero: true })
    })
}

/// One curve for each test function: the distribution function of the ranks minus that of uniform ones, with the band that a calibrated sampler's whole curve keeps with 95 % (Dvoretzky, Kiefer & Wolfowitz).
///
/// # Errors
/// Text when the picture cannot be drawn.
pub fn ecdf_differences(ranks: &Ranks) -> Result<String, String> {
    pictures(ranks, |values| {
        let half = ((2.0_f64 / 0.05).ln() / (2.0 * values.len() as f64)).sqrt();
        let line = ecdf_difference(values, ranks.draws).into_iter().enumerate().map(|(rank, d)| ((rank + 1) as f64, d));
        let band = vec![(0.0, -half, half), ((ranks.draws + 1) as f64, -half, half)];
        Ok(Panel { line: std::iter::once((0.0, 0.0)).chain(line).collect(), band, from_zero: false })
    })
}

struct Panel {
    line: Vec<(f64, f64)>,
    band: Vec<(f64, f64, f64)>,
    from_zero: bool,
}

fn pictures(ranks: &Ranks, panel: impl Fn(&[usize]) -> Result<Panel, String>) -> Result<String, String> {
    let rows = ranks.names.len().div_ceil(COLUMNS).max(1);
    let size = (SIZE.0 * COLUMNS.min(ranks.names.len()).max(1) as u32, SIZE.1 * rows as u32);
    let mut picture = String::new();
    {
        let area = SVGBackend::with_string(&mut picture, size).into_drawing_area();
        area.fill(&WHITE).map_err(|error| error.to_string())?;
        let areas = area.split_evenly((rows, COLUMNS.min(ranks.names.len()).max(1)));
        for ((name, values), area) in ranks.names.iter().zip(&ranks.ranks).zip(&areas) {
            draw(area, name, &panel(values)?).map_err(|error| error.to_string())?;
        }
        area.present().map_err(|error| error.to_string())?;
    }
    Ok(picture)
}

fn draw<B: DrawingBackend>(
    area: &DrawingArea<B, plotters::coord::Shift>,
    name: &str,
    panel: &Panel,
) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
    let ys = || panel.line.iter().map(|p| p.1).chain(panel.band.iter().flat_map(|b| [b.1, b.2]));
    let low = if panel.from_zero { 0.0 } else { ys().fold(f64::INFINITY, f64::min) * 1.1 };
    let high = ys().fold(f64::NEG_INFINITY, f64::max) * 1.1;
    let right = panel.line.iter().map(|p| p.0).fold(1.0, f64::max);
    let mut chart = ChartBuilder::on(area)
        .caption(name, ("sans-serif", 14))
        .margin(8)
        .margin_right(18)
        .x_label_area_size(32)
        .y_label_area_size(54)
        .build_cartesian_2d(0.0..right, low..high)?;
    let upper = panel.band.iter().map(|b| (b.0, b.2));
    let lower = panel.band.iter().rev().map(|b| (b.0, b.1));
    chart.draw_series([Polygon::new(upper.chain(lower).collect::<Vec<_>>(), BAND.filled())])?;
    let decimals = if panel.from_zero { 0 } else { 2 };
    chart
        .configure_mesh()
        .disable_mesh()
        .x_desc("rank of the truth")
        .y_desc(if panel.from_zero { "data sets" } else { "share below, less uniform" })
        .x_label_formatter(&|x| format!("{x:.0}"))
        .y_label_formatter(&|y| format!("{y:.decimals$}"))
        .x_labels(6)
        .y_labels(5)
        .draw()?;
    chart.draw_series(LineSeries::new(panel.line.iter().copied(), BLUE.stroke_width(2)))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_name_every_function() {
        let ranks = Ranks {
            names: vec!["x0".into(), "log density".into()],
            ranks: vec![(0..200).map(|i| i % 100).collect(), vec![0; 200]],
            draws: 99,
        };
        for picture in [rank_histograms(&ranks, 20).unwrap(), ecdf_differences(&ranks).unwrap()] {
            assert!(picture.starts_with("<svg") && picture.contains("log density") && picture.contains("polygon"));
        }
    }
}
