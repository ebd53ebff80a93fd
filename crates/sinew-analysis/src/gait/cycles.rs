//! Joint angles over the gait cycle, 0 to 100 % from heel strike to heel strike of a side.
//!
//! Every stride of a side is cut out of the angles of the mean pose and read at 101 shares of its duration, on the line between the frames. Series are continuous, and cycles lie as near to each other as whole turns allow: who walks round the room has turned, not their hip. The band is the standard deviation between cycles. Where the ends of its 90 % intervals are known (`angles.csv`), they are read alike, and the mean over the cycles of these ends is the interval of the angle in one cycle: it does not shrink with the number of cycles.

use super::strides::Stride;
use super::walk::interpolated;
use crate::Error;
use sinew::angles::circle::{TURN_DEG, direction, near, turns};
use sinew::files::read_text;
use sinew_formats::mot;
use sinew_formats::source_text::MAX_TEXT_BYTES;
use sinew_results::folder_table::FolderTable;
use std::path::Path;

/// Shares of the cycle: 0, 1, … 100 %.
pub const PLACES: usize = 101;

/// An angle over the cycle of a side.
#[derive(Clone, Debug, PartialEq)]
pub struct AngleCycle {
    /// 0: left, 1: right.
    pub side: usize,
    /// Name in `angles.mot`; of the pelvis always by `--angles isb`.
    pub angle: String,
    /// Cycles that it is the mean of.
    pub cycles: usize,
    /// Mean over the cycles, degrees, at each per cent.
    pub mean_deg: Vec<f64>,
    /// Standard deviation between cycles; NaN for one cycle.
    pub sd_deg: Vec<f64>,
    /// Ends of the 90 % interval of one cycle, where `angles.csv` has it.
    pub interval_deg: Option<[Vec<f64>; 2]>,
}

/// An angle in each frame.
pub(super) struct Series {
    pub(super) name: String,
    pub(super) mean_deg: Vec<f64>,
    /// Ends of its 90 % interval, where they are known.
    pub(super) ends_deg: Option<[Vec<f64>; 2]>,
}

/// The cycles of all angles: side by side, in their order.
pub(super) fn cycles(series: &[Series], times_s: &[f64], strides: &[Stride]) -> Vec<AngleCycle> {
    let sides = [0, 1].into_iter().flat_map(|side| series.iter().map(move |series| (side, series)));
    let cycle = |(side, series): (usize, &Series)| cycle(side, series, times_s, strides);
    sides.filter_map(cycle).collect()
}

/// The angles of a folder, in the order of the file.
pub(super) fn series(folder: &Path, frames: usize) -> Result<Vec<Series>, Error> {
    let path = folder.join("angles.mot");
    if !path.exists() {
        let folder = folder.to_owned();
        return Err(sinew_results::ReadError::NoFile { folder, file: "angles.mot" }.into());
    }
    let motion = mot::read(&path.display().to_string(), &read_text(&path, MAX_TEXT_BYTES)?)?;
    if motion.rows.len() != frames {
        return Err(sinew_results::ReadError::OtherRun(path).into());
    }
    let known = intervals(folder, frames)?;
    let is_angle = |name: &str| !name.ends_with("_tx") && !name.ends_with("_ty") && !name.ends_with("_tz");
    let factor = if motion.in_degrees { 1.0 } else { 180.0 / std::f64::consts::PI };
    let columns = motion.columns.iter().enumerate().filter(|(_, name)| is_angle(name));
    let one = |(column, name): (usize, &String)| Series {
        name: name.clone(),
        mean_deg: motion.rows.iter().map(|row| factor * row[column]).collect(),
        ends_deg: known.iter().find(|(own, _)| own == name).map(|(_, ends)| ends.clone()),
    };
    Ok(columns.map(one).collect())
}

/// The name of an angle, and the ends of its 90 % interval in each frame, degrees.
type NamedEnds = (String, [Vec<f64>; 2]);

/// The intervals that a folder has.
fn intervals(folder: &Path, frames: usize) -> Result<Vec<NamedEnds>, Error> {
    if !folder.join("angles.csv").exists() {
        return Ok(vec![]);
    }
    let table = FolderTable::read(folder, "angles.csv")?.by_name("name", &["q05_deg", "q95_deg"], frames)?;
    let ends = |series: Vec<Vec<f64>>| <[Vec<f64>; 2]>::try_from(series).unwrap_or_default();
    Ok(table.into_iter().map(|(name, series)| (name, ends(series))).collect())
}

fn cycle(side: usize, series: &Series, times_s: &[f64], strides: &[Stride]) -> Option<AngleCycle> {
    let own: Vec<&Stride> = strides.iter().filter(|stride| stride.side == side).collect();
    let count = own.len() as f64;
    let by: Vec<f64> = turns(series.mean_deg.iter().copied(), TURN_DEG).collect();
    let read = |values: &[f64]| -> Vec<Vec<f64>> {
        let values: Vec<f64> = values.iter().zip(&by).map(|(angle, by)| angle + by).collect();
        let over = |stride: &&Stride| {
            let time = |place: usize| place as f64 / (PLACES - 1) as f64 * (stride.end_s - stride.start_s);
            (0..PLACES).map(|place| interpolated(times_s, &values, stride.start_s + time(place))).collect()
        };
        own.iter().map(over).collect()
    };
    let mut cycles = read(&series.mean_deg);
    let middles: Vec<f64> = cycles.iter().map(|cycle| cycle.iter().sum::<f64>() / PLACES as f64).collect();
    let middle = direction(middles.iter().copied(), TURN_DEG);
    let turned: Vec<f64> = middles.iter().map(|own| near(*own, middle, TURN_DEG) - own).collect();
    let turn = |cycles: &mut Vec<Vec<f64>>| {
        cycles.iter_mut().zip(&turned).for_each(|(cycle, by)| cycle.iter_mut().for_each(|angle| *angle += by));
    };
    let mean = |cycles: &[Vec<f64>]| -> Vec<f64> {
        (0..PLACES).map(|place| cycles.iter().map(|cycle| cycle[place]).sum::<f64>() / count).collect()
    };
    turn(&mut cycles);
    let mean_deg = mean(&cycles);
    let sd = |place: usize| {
        let square: f64 = cycles.iter().map(|cycle| (cycle[place] - mean_deg[place]).powi(2)).sum();
        (square / (count - 1.0)).sqrt()
    };
    let sd_deg = (0..PLACES).map(sd).collect();
    let end = |values: &Vec<f64>| {
        let mut ends = read(values);
        turn(&mut ends);
        mean(&ends)
    };
    let interval_deg = series.ends_deg.as_ref().map(|ends| ends.each_ref().map(end));
    let angle = series.name.clone();
    (!own.is_empty()).then_some(AngleCycle { side, angle, cycles: own.len(), mean_deg, sd_deg, interval_deg })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stride(side: usize, start_s: f64, end_s: f64) -> Stride {
        Stride { side, start_s, end_s, toe_off_s: None, parameters: Default::default() }
    }

    #[test]
    fn an_angle_that_rises_over_each_cycle_is_a_line() {
        let times_s: Vec<f64> = (0..401).map(|k| f64::from(k) / 100.0).collect();
        let saw = |t: f64, by: f64| by * (t - t.floor());
        // Cycles of 10° and 20°, and an interval that is 3° wide.
        let mean_deg: Vec<f64> = times_s.iter().map(|t| saw(*t, if *t < 2.0 { 10.0 } else { 20.0 })).collect();
        let ends_deg = [-1.0, 2.0].map(|by| mean_deg.iter().map(|x| x + by).collect::<Vec<f64>>());
        let series = Series { name: "knee_angle_l".into(), mean_deg, ends_deg: Some(ends_deg) };
        let strides = [stride(0, 1.0, 1.99), stride(1, 0.0, 1.0), stride(0, 2.0, 2.99)];
        let found = cycle(0, &series, &times_s, &strides).unwrap();
        assert_eq!((found.cycles, found.mean_deg.len()), (2, PLACES));
        for place in [0, 37, 99] {
            let expected = 0.1485 * place as f64;
            assert!((found.mean_deg[place] - expected).abs() < 1e-9, "{place}: {}", found.mean_deg[place]);
            assert!((found.sd_deg[place] - 0.099 * place as f64 / 2.0_f64.sqrt()).abs() < 1e-9);
            let [low, high] = found.interval_deg.as_ref().unwrap();
            assert!((low[place] - expected + 1.0).abs() < 1e-9 && (high[place] - expected - 2.0).abs() < 1e-9);
        }
        assert!(cycle(1, &series, &times_s, &strides[..1]).is_none());
        assert!(cycle(0, &series, &times_s, &strides[..1]).unwrap().sd_deg[3].is_nan());
    }

    /// Somebody who walks backwards, facing 178° from where they walk, sways by 5°, once given within half a turn, once turned round by another lap.
    #[test]
    fn cycles_do_not_know_the_cut() {
        let times_s: Vec<f64> = (0..401).map(|k| f64::from(k) / 100.0).collect();
        let sways = |t: f64| 178.0 + 5.0 * (std::f64::consts::TAU * t).sin();
        let strides = [stride(0, 0.0, 1.0), stride(0, 1.0, 2.0), stride(0, 2.0, 3.0)];
        let within = |x: f64| if x > 180.0 { x - 360.0 } else { x };
        let laps = |t: f64| sways(t) + if t < 1.5 { 0.0 } else { 360.0 };
        for given in [&(|t: f64| within(sways(t))) as &dyn Fn(f64) -> f64, &laps] {
            let mean_deg: Vec<f64> = times_s.iter().map(|t| given(*t)).collect();
            let ends_deg = [-1.0, 2.0].map(|by| mean_deg.iter().map(|x| x + by).collect::<Vec<f64>>());
            let series = Series { name: "pelvic_rotation".into(), mean_deg, ends_deg: Some(ends_deg) };
            let found = cycle(0, &series, &times_s, &strides).unwrap();
            let [low, high] = found.interval_deg.as_ref().unwrap();
            for place in [0, 25, 60, 75] {
                let expected = sways(place as f64 / 100.0);
                assert!((found.mean_deg[place] - expected).abs() < 1e-9, "{place}: {}", found.mean_deg[place]);
                assert!(found.sd_deg[place] < 1e-9, "{place}: {}", found.sd_deg[place]);
                assert!((low[place] - expected + 1.0).abs() < 1e-9 && (high[place] - expected - 2.0).abs() < 1e-9);
            }
        }
    }
}
