//! How the calibration's world was turned, for `summary.json`.

use serde::Serialize;

/// How the calibration's world was turned to that of the results.
#[derive(Clone, Debug, Serialize)]
pub struct WorldTurn {
    /// What points up in the calibration's world: an axis or a direction `X,Y,Z`.
    pub up: String,
    /// Its standard deviation about each horizontal axis, degrees, where the person showed it.
    pub sd_deg: Option<f64>,
    /// Takes points of the calibration's world to that of the results, row by row.
    pub results_from_calibration: [[f64; 3]; 3],
}
