//! The latent space of a node as a plane: its two coordinates of largest variance.
//!
//! Off its latents, a place of the plane stands for the latent there whose other coordinates are the nearest known one's: near every latent that was learned from the variance is small, however the space bends. A latent of one
//! coordinate is drawn over time.

use sinew_latent::Error;
use sinew_latent::mapping::Mapping;
use sinew_latent::model::LatentModel;

/// Share of the extent of the latents by which the plane continues beyond them, on each side.
const BEYOND: f64 = 0.27;

/// A plane.
pub(super) struct Plane {
    mapping: Mapping,
    /// Coordinates that are drawn to the right and upwards; none where that is time.
    axes: [Option<usize>; 2],
    /// Names of the axes.
    pub(super) names: [String; 2],
    /// Places of the latents, one a row.
    pub(super) points: Vec<[f64; 2]>,
    /// Time of each row in its sequence, from 0 to 1.
    pub(super) times: Vec<f64>,
    /// Rows of each sequence.
    pub(super) lengths: Vec<usize>,
    /// Least and largest value of each axis.
    pub(super) extent: [[f64; 2]; 2],
}

impl Plane {
    /// Of a node.
    ///
    /// # Errors
    /// [`Error::Singular`].
    pub(super) fn new(model: &LatentModel, node: usize) -> Result<Self, Error> {
        let own = &model.nodes[node];
        let lengths = lengths_within(model, &own.rows);
        let variances: Vec<f64> = (0..own.dim).map(|j| variance(&own.latents, own.dim, j)).collect();
        let total = variances.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let mut order: Vec<usize> = (0..own.dim).collect();
        order.sort_by(|&a, &b| variances[b].total_cmp(&variances[a]));
        let axes = match order[..] {
            [only] => [None, Some(only)],
            [first, second, ..] => [Some(first), Some(second)],
            [] => [None, None],
        };
        let name = |axis: Option<usize>| match axis {
            Some(j) => format!("coordinate {} ({:.0} % of the variance)", j + 1, 100.0 * variances[j] / total),
            None => "frame of the sequence".into(),
        };
        let frames: Vec<usize> = lengths.iter().flat_map(|&length| 0..length).collect();
        let place = |row: usize, axis: Option<usize>| axis.map_or(frames[row] as f64, |j| own.latent(row)[j]);
        let points: Vec<[f64; 2]> = (0..own.rows.len()).map(|row| axes.map(|axis| place(row, axis))).collect();
        let times = lengths.iter().flat_map(|&n| (0..n).map(move |t| t as f64 / (n.max(2) - 1) as f64)).collect();
        let extent = [0, 1].map(|k| extent(points.iter().map(|point| point[k])));
        let (mapping, names) = (Mapping::new(model, node)?, axes.map(name));
        Ok(Self { mapping, axes, names, points, times, lengths, extent })
    }

    /// Predictive standard deviation at a place, as a share of that where nothing is known.
    pub(super) fn uncertainty(&self, place: [f64; 2]) -> f64 {
        let distance = |point: &[f64; 2]| {
            let share = |k: usize| (point[k] - place[k]) / (self.extent[k][1] - self.extent[k][0]);
            share(0).powi(2) + share(1).powi(2)
        };
        let nearest = self.points.iter().map(distance).enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        let (row, dim) = (nearest.map_or(0, |(row, _)| row), self.mapping.dim());
        let mut latent = self.mapping.latents()[row * dim..][..dim].to_vec();
        for (axis, x) in self.axes.into_iter().zip(place) {
            if let Some(j) = axis {
                latent[j] = x;
            }
        }
        (self.mapping.variance_at(&latent) / self.mapping.prior_variance(&latent)).sqrt().clamp(0.0, 1.0)
    }
}

/// Rows of each sequence within some rows, which whole sequences make up.
fn lengths_within(model: &LatentModel, rows: &std::ops::Range<usize>) -> Vec<usize> {
    let mut start = 0;
    let mut within = vec![];
    for &length in &model.sequences {
        if rows.contains(&start) {
            within.push(length);
        }
        start += length;
    }
    within
}

fn variance(latents: &[f64], dim: usize, j: usize) -> f64 {
    let column = || latents.iter().skip(j).step_by(dim);
    let count = (latents.len() / dim) as f64;
    let mean = column().sum::<f64>() / count;
    column().map(|x| (x - mean).powi(2)).sum::<f64>() / count
}

/// Least and largest of some numbers, and somewhat beyond.
fn extent(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    let beyond = if high > low { BEYOND * (high - low) } else { 1.0 };
    [low - beyond, high + beyond]
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_latent::gplvm;

    #[test]
    fn a_plane_is_certain_at_its_latents_and_not_far_away() {
        let rows: Vec<f64> = (0..20).flat_map(|n| [0.3, 0.9, 1.7, 0.2].map(|f| (f * f64::from(n)).sin())).collect();
        for dim in [1, 2, 3] {
            let model = gplvm::model(&rows, 4, &gplvm::Config { dim, ..gplvm::Config::default() }).unwrap();
            let plane = Plane::new(&model, 0).unwrap();
            assert_eq!((plane.points.len(), plane.lengths.as_slice()), (20, &[20][..]));
            let largest = plane.points.iter().map(|&place| plane.uncertainty(place)).fold(0.0, f64::max);
            let [[_, right], [_, top]] = plane.extent;
            let far = plane.uncertainty([right + 50.0, top + 50.0]);
            assert!(largest < 0.6 && far > 0.9, "{dim}: {largest} {far}");
            assert_eq!(plane.names[0] == "frame of the sequence", dim == 1);
        }
    }
}
