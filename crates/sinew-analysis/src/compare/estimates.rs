//! What a result says of points or angles: `joints.csv` or `angles.csv`.

use crate::Error;
use sinew::angles::circle::{TURN_DEG, turns};
use sinew_results::folder_table::{FolderTable, NamedSeries};
use std::path::Path;

/// Estimates of points (three axes, metres) or angles (one, degrees).
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Estimates<const D: usize> {
    pub(super) times_s: Vec<f64>,
    pub(super) names: Vec<String>,
    /// Of each name, frame by frame.
    pub(super) series: Vec<Vec<Estimate<D>>>,
}

/// Mean and standard deviations in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Estimate<const D: usize> {
    pub(super) mean: [f64; D],
    pub(super) sd: [f64; D],
    /// Within the run, without the shift that all points share; NaN where there is none.
    pub(super) sd_within: [f64; D],
}

/// Half the width of an interval of 90 % over the standard deviation.
const HALF_OF_90: f64 = 1.644_853_626_951_472_2;

impl<const D: usize> Estimates<D> {
    pub(super) fn ends_s(&self) -> [f64; 2] {
        [self.times_s.first(), self.times_s.last()].map(|end| end.copied().unwrap_or(f64::NAN))
    }
}

/// Times of the frames, seconds.
fn times(folder: &Path) -> Result<Vec<f64>, Error> {
    Ok(FolderTable::read(folder, "frames.csv")?.column("time_s")?)
}

fn assembled<const D: usize>(
    times_s: Vec<f64>,
    named: Vec<NamedSeries>,
    estimate: impl Fn(&[Vec<f64>], usize) -> Estimate<D>,
) -> Estimates<D> {
    let frames = times_s.len();
    let series = named.iter().map(|(_, columns)| (0..frames).map(|frame| estimate(columns, frame)).collect()).collect();
    Estimates { times_s, names: named.into_iter().map(|(name, _)| name).collect(), series }
}

/// Points of a result folder.
pub(super) fn points(folder: &Path) -> Result<Estimates<3>, Error> {
    const COLUMNS: [&str; 9] = [
        "x_mean_m",
        "y_mean_m",
        "z_mean_m",
        "x_sd_m",
        "y_sd_m",
        "z_sd_m",
        "x_sd_within_m",
        "y_sd_within_m",
        "z_sd_within_m",
    ];
    let times_s = times(folder)?;
    let named = FolderTable::read(folder, "joints.csv")?.by_name("joint", &COLUMNS, times_s.len())?;
    Ok(assembled(times_s, named, |columns, frame| {
        let from = |first: usize| std::array::from_fn(|axis| columns[first + axis][frame]);
        Estimate { mean: from(0), sd: from(3), sd_within: from(6) }
    }))
}

/// Angles of a result folder, made continuous; their standard deviation is taken from the interval of 90 %.
pub(super) fn angles(folder: &Path) -> Result<Estimates<1>, Error> {
    let times_s = times(folder)?;
    let columns = ["mean_deg", "q05_deg", "q95_deg"];
    let mut named = FolderTable::read(folder, "angles.csv")?.by_name("name", &columns, times_s.len())?;
    for (_, columns) in &mut named {
        let by: Vec<f64> = turns(columns[0].iter().copied(), TURN_DEG).collect();
        columns.iter_mut().for_each(|column| column.iter_mut().zip(&by).for_each(|(angle, by)| *angle += by));
    }
    Ok(assembled(times_s, named, |columns, frame| {
        let [mean, low, high] = [0, 1, 2].map(|column: usize| columns[column][frame]);
        Estimate { mean: [mean], sd: [0.5 * (high - low) / HALF_OF_90], sd_within: [f64::NAN] }
    }))
}
