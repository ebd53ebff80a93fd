//! Weights of inverse kinematics from what a run knows of each marker.
//!
//! Least squares count a marker by the inverse of its variance. What counts is the variance within the run, without the shift that all markers share in all frames (`markers_sd.csv`): that shift moves the whole body and bends no joint. The weight of marker m in frame t is w(m, t) = c / sd(m, t)², with c such that the mean over markers and frames is 1; for the whole run it is the harmonic mean over the frames, c / mean sd², as one variance stands for all frames.
//!
//! That a model does not fit the person is not in these variances, and weights know nothing of it.

use super::error::OpensimError;
use super::marker_set::ModelMarker;
use crate::Error;
use sinew::files::read_text;
use sinew_core::estimators::mean;
use sinew_formats::source_text::MAX_TEXT_BYTES;
use sinew_formats::tidy_csv::{self, Cell};
use std::path::Path;

/// Digits of a weight behind its point: more are noise.
const STEP: f64 = 1e-4;

/// Standard deviations of markers in each frame.
pub(super) struct MarkerWeights {
    pub(super) names: Vec<String>,
    times_s: Vec<f64>,
    /// 1/sd² for each frame and marker, 1/m².
    precisions: Vec<Vec<f64>>,
}

impl MarkerWeights {
    /// Reads the table of a result folder for markers of the model.
    pub(super) fn read(folder: &Path, markers: &[ModelMarker]) -> Result<Self, Error> {
        let file = folder.join("markers_sd.csv");
        let name = file.display().to_string();
        let table = tidy_csv::read_numbers(&name, &read_text(&file, MAX_TEXT_BYTES)?)?;
        let place = |column: &str| {
            let missing = || sinew_formats::Error::MissingField {
                place: sinew_formats::Place::file(&name),
                field: column.to_owned(),
            };
            table.column(column).ok_or_else(missing)
        };
        let time = place("time_s")?;
        let columns: Vec<usize> =
            markers.iter().map(|marker| place(&format!("{}_sd_m", marker.name))).collect::<Result<_, _>>()?;
        let mut precisions = vec![];
        for (row, values) in table.rows.iter().enumerate() {
            let one = |(marker, column): (&ModelMarker, &usize)| match values[*column] {
                sd if sd > 0.0 => Ok((sd * sd).recip()),
                sd => Err(OpensimError::NoSpread { file: file.clone(), marker: marker.name.clone(), row: row + 2, sd }),
            };
            precisions.push(markers.iter().zip(&columns).map(one).collect::<Result<Vec<f64>, _>>()?);
        }
        let names = markers.iter().map(|marker| marker.name.clone()).collect();
        Ok(Self { names, times_s: table.rows.iter().map(|row| row[time]).collect(), precisions })
    }

    /// Of markers with 1/sd² in each frame.
    #[cfg(test)]
    pub(super) fn of(names: &[&str], precisions: Vec<Vec<f64>>) -> Self {
        let times_s = (0..precisions.len()).map(|frame| frame as f64).collect();
        Self { names: names.iter().map(|name| (*name).to_owned()).collect(), times_s, precisions }
    }

    /// A weight for each marker, for all frames; 1 in the mean.
    pub(super) fn constant(&self) -> Vec<f64> {
        let frames = self.precisions.len() as f64;
        let mean_square = |marker: usize| self.precisions.iter().map(|row| row[marker].recip()).sum::<f64>() / frames;
        let precisions: Vec<f64> = (0..self.names.len()).map(|marker| mean_square(marker).recip()).collect();
        let mean = mean(&precisions);
        precisions.iter().map(|precision| rounded(precision / mean)).collect()
    }

    /// `time_s` and a column for each marker: its weight in each frame, 1 in the mean over all.
    pub(super) fn to_csv(&self) -> Result<String, sinew::Error> {
        let count = (self.precisions.len() * self.names.len()) as f64;
        let mean = self.precisions.iter().flatten().sum::<f64>() / count;
        let mut bytes = vec![];
        let mut write = || {
            let columns: Vec<String> = std::iter::once("time_s".to_owned()).chain(self.names.iter().cloned()).collect();
            tidy_csv::write_header(&mut bytes, &columns)?;
            self.times_s.iter().zip(&self.precisions).try_for_each(|(time_s, row)| {
                let weights = row.iter().map(|precision| Cell::Number(rounded(precision / mean)));
                let cells: Vec<Cell<'_>> = std::iter::once(Cell::Number(*time_s)).chain(weights).collect();
                tidy_csv::write_row(&mut bytes, &cells)
            })
        };
        write().map_err(sinew::Error::io("write", "a table of weights"))?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }
}

fn rounded(weight: f64) -> f64 {
    ((weight / STEP).round() * STEP * 1e4).round() / 1e4
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<MarkerWeights, Error> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("markers_sd.csv"), text).unwrap();
        let marker = |name: &str| ModelMarker { name: name.into(), body: "femur_r".into(), place: [0.0; 3] };
        MarkerWeights::read(folder.path(), &[marker("RHip"), marker("RKnee")])
    }

    #[test]
    fn weights_go_with_the_inverse_variance_and_are_one_in_the_mean() {
        let found = read("frame,time_s,RHip_sd_m,RKnee_sd_m\n0,0,0.01,0.02\n1,0.1,0.01,0.02\n").unwrap();
        assert_eq!(found.constant(), [1.6, 0.4]);
        assert_eq!(found.to_csv().unwrap(), "time_s,RHip,RKnee\n0.0,1.6,0.4\n0.1,1.6,0.4\n");
        // In a frame in which the knee is not seen its weight falls; of the run it has the mean variance.
        let found = read("frame,time_s,RHip_sd_m,RKnee_sd_m\n0,0,0.01,0.01\n1,0.1,0.01,0.03\n").unwrap();
        let [hip, knee] = found.constant()[..] else { panic!() };
        assert!((hip / knee - 5.0).abs() < 1e-2, "{hip} {knee}");
    }

    #[test]
    fn markers_that_are_known_exactly_or_not_at_all_are_refused() {
        for cell in ["0", "", "-1"] {
            let found = read(&format!("frame,time_s,RHip_sd_m,RKnee_sd_m\n0,0,0.01,{cell}\n"));
            assert!(found.err().unwrap().to_string().contains("`RKnee`"), "{cell}");
        }
        assert!(read("frame,time_s,RHip_sd_m\n0,0,0.01\n").err().unwrap().to_string().contains("RKnee_sd_m"));
    }
}
