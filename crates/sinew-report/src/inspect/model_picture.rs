//! A picture of a motion model: mean motion of the clusters that have most windows, and what follows what.
//!
//! Above, each row is a cluster of the feature vector `body`: its mean window, an action primitive and the frame after it, from the front and from the right. The root stands still and upright.
//!
//! Below is the transition picture of Husz, Wallace & Green (2007, figure 3): a square in row i and column j has an area that grows with the number of windows of cluster i that one of cluster j follows. Clusters stand in the order in
//! which they follow each other most often, so that repeated motion is a line beside the diagonal.

use super::motion_model::read;
use super::stick_figure::{FROM_THE_FRONT, FROM_THE_RIGHT, MIDDLE, RIGHT, figure};
use crate::Error;
use sinew_body::points::points_of_states;
use sinew_dynamics::primitives::model::{PrimitiveModel, Primitives};
use sinew_formats::svg::{Svg, clipped};
use sinew_motion::follow::NamedBody;
use std::path::Path;

/// Clusters whose motion is drawn.
const DRAWN: usize = 6;
/// Frames of a window that are drawn.
const FRAMES: usize = 8;
/// Clusters in the transition picture.
const MOST_CLUSTERS: usize = 200;
/// Width of a figure and height of a row, pixels.
const CELL: [f64; 2] = [52.0, 104.0];
/// Pixels a metre.
const SCALE: f64 = 48.0;
/// Width of the labels and of margins, pixels.
const LABEL: f64 = 110.0;
const MARGIN: f64 = 20.0;
/// Side of the transition picture, pixels.
const SQUARE: f64 = 420.0;

/// The picture of the model in a file, as SVG.
///
/// # Errors
/// A file that cannot be read or is no motion model.
pub fn model_picture(path: &Path) -> Result<String, Error> {
    let model = read(path)?;
    Ok(picture(&model, &path.file_name().unwrap_or_default().to_string_lossy()))
}

fn picture(model: &PrimitiveModel, name: &str) -> String {
    let Some(primitives) = model.find("body").or(model.primitives.first()) else { return String::new() };
    let most_used = most_used(primitives);
    let drawn = &most_used[..most_used.len().min(DRAWN)];
    let body = NamedBody::find(&model.state).filter(|body| body.tree().dof() == model.dim);
    let rows = if body.is_some() { drawn.len() as f64 } else { 0.0 };
    let shown = shown_frames(model.length + 1);
    let figures = LABEL + MARGIN + 2.0 * CELL[0] * shown.len() as f64;
    let width = figures.max(LABEL + SQUARE) + 2.0 * MARGIN;
    let top = 70.0 + CELL[1] * rows;
    let mut svg = Svg::new(width, top + SQUARE + 60.0);
    let (feature, rate) = (clipped(&primitives.feature.name), model.frame_rate);
    svg.text(
        MARGIN,
        24.0,
        15.0,
        &format!("{}: {}, {rate} frames per second, feature vector {feature}", clipped(name), clipped(&model.state)),
    );
    if let Some(body) = body {
        svg.text(MARGIN + LABEL, 46.0, 12.0, "from the front (left is blue)");
        svg.text(2.0 * MARGIN + LABEL + CELL[0] * shown.len() as f64, 46.0, 12.0, "from the right");
        for (row, &cluster) in drawn.iter().enumerate() {
            let y = 54.0 + CELL[1] * row as f64;
            draw_cluster(&mut svg, model, primitives, body, cluster, &shown, y);
        }
    }
    transitions(&mut svg, primitives, top);
    svg.done()
}

/// Clusters, those with most windows first.
fn most_used(primitives: &Primitives) -> Vec<usize> {
    let mut order: Vec<usize> = (0..primitives.clusters.len()).collect();
    order.sort_by_key(|&k| std::cmp::Reverse(primitives.clusters[k].members));
    order
}

/// Frames of a window that are drawn, evenly spaced, the last one among them.
fn shown_frames(frames: usize) -> Vec<usize> {
    let count = frames.min(FRAMES);
    (0..count).map(|i| ((i + 1) * frames).div_ceil(count) - 1).collect()
}

fn draw_cluster(
    svg: &mut Svg,
    model: &PrimitiveModel,
    primitives: &Primitives,
    body: NamedBody,
    cluster: usize,
    shown: &[usize],
    y: f64,
) {
    let members = primitives.clusters[cluster].members;
    let windows = if members == 1 { "window" } else { "windows" };
    svg.text(MARGIN, y + 0.5 * CELL[1], 12.0, &format!("cluster {cluster}"));
    svg.text(MARGIN, y + 0.5 * CELL[1] + 16.0, 12.0, &format!("{members} {windows}"));
    let window = primitives.mean_window(cluster);
    let coordinates = &primitives.feature.coordinates;
    let state = |frame: &usize| {
        let mut state = vec![0.0; model.dim];
        let features = window.chunks_exact(coordinates.len()).nth(*frame).unwrap_or_default();
        coordinates.iter().zip(features).for_each(|(&j, &x)| state[j] = x);
        state
    };
    let states: Vec<Vec<f64>> = shown.iter().map(state).collect();
    let motion = points_of_states(&body.tree(), &states);
    for (view, to_the_right) in [FROM_THE_FRONT, FROM_THE_RIGHT].into_iter().enumerate() {
        let left = MARGIN + LABEL + view as f64 * (MARGIN + CELL[0] * shown.len() as f64);
        for (column, frame) in motion.frames.iter().enumerate() {
            let centre = [left + CELL[0] * (column as f64 + 0.5), y + 0.46 * CELL[1]];
            figure(svg, &motion, frame, to_the_right, SCALE, centre);
        }
    }
}

/// Clusters in an order in which each is followed by its most frequent successor that is still left.
fn chained(primitives: &Primitives) -> Vec<usize> {
    let n = primitives.clusters.len();
    let mut left = most_used(primitives);
    left.truncate(MOST_CLUSTERS);
    let mut order: Vec<usize> = vec![];
    while !left.is_empty() {
        let after = |&(_, &k): &(usize, &usize)| order.last().map_or(0, |&last| primitives.transitions[last * n + k]);
        // Of equal ones the most used is the first.
        let best = left.iter().enumerate().rev().max_by_key(after).map_or(0, |(at, _)| at);
        order.push(left.remove(best));
    }
    order
}

fn transitions(svg: &mut Svg, primitives: &Primitives, top: f64) {
    let (n, order) = (primitives.clusters.len(), chained(primitives));
    let count = |i: usize, j: usize| primitives.transitions[i * n + j];
    let most = order.iter().flat_map(|&i| order.iter().map(move |&j| count(i, j))).max().unwrap_or_default().max(1);
    let (x, y, cell) = (MARGIN + LABEL, top + 20.0, SQUARE / order.len().max(1) as f64);
    svg.text(
        x,
        y - 8.0,
        12.0,
        &format!("what follows what in {} clusters; largest square: {most} times; dark: itself", order.len()),
    );
    svg.text(MARGIN, y + 14.0, 12.0, "from cluster");
    svg.text(x, y + SQUARE + 18.0, 12.0, "to cluster, in the order of the rows");
    svg.frame(x, y, SQUARE);
    for (row, &i) in order.iter().enumerate() {
        for (column, &j) in order.iter().enumerate().filter(|(_, j)| count(i, **j) > 0) {
            let side = cell * (count(i, j) as f64 / most as f64).sqrt();
            let corner = [x + cell * column as f64 + 0.5 * (cell - side), y + cell * row as f64 + 0.5 * (cell - side)];
            svg.square(corner, side, if i == j { MIDDLE } else { RIGHT });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::stick_figure::BONES;
    use super::*;
    use sinew_dynamics::pca::Pca;
    use sinew_dynamics::primitives::model::{Cluster, Clustering, FeatureVector, Normal};

    fn model(clusters: usize, length: usize) -> PrimitiveModel {
        let (features, past) = (26, length * 26);
        let normal = |dim: usize, at: f64| Normal { mean: vec![at; dim], covariance: vec![0.0; dim * dim] };
        let cluster = |k: usize| Cluster {
            members: 10 * (k + 1),
            past: normal(1, 0.0),
            next: normal(features, 0.1 * k as f64),
            step: normal(features, 0.0),
        };
        let mut unit = vec![0.0; past];
        unit[0] = 1.0;
        let pca = Pca { mean: vec![0.2; past], components: unit, variances: vec![1.0], total: 1.0 };
        let transitions = (0..clusters * clusters).map(|k| usize::from(k % clusters == (k / clusters + 1) % clusters));
        let clustering = Clustering { requested: clusters, components: clusters, ..Clustering::default() };
        let primitives = Primitives {
            feature: FeatureVector { name: "body".into(), coordinates: (6..32).collect() },
            pca,
            clusters: (0..clusters).map(cluster).collect(),
            transitions: transitions.collect(),
            clustering,
        };
        let (noise_sd, primitives) = (vec![0.1; 32], vec![primitives]);
        PrimitiveModel { state: "h32".into(), dim: 32, frame_rate: 20.0, length, noise_sd, primitives }
    }

    #[test]
    fn figures_of_the_most_used_clusters_and_all_transitions_are_drawn() {
        let svg = picture(&model(9, 3), "a<b.json");
        let count = |what: &str| svg.matches(what).count();
        // Six clusters of four frames in two views.
        assert_eq!((count("<circle"), count("<line")), (6 * 4 * 2, 6 * 4 * 2 * BONES.len()));
        assert_eq!(count("class=\"t\""), 9);
        assert!(svg.contains("cluster 8") && svg.contains("90 windows") && !svg.contains("cluster 2<"));
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n") && svg.contains("a&lt;b.json"));
    }

    #[test]
    fn bodies_that_are_unknown_have_transitions_alone() {
        let unknown = PrimitiveModel { state: "horse".into(), ..model(2, 1) };
        let svg = picture(&unknown, "m");
        assert!(!svg.contains("<line") && svg.contains("class=\"t\""));
    }

    #[test]
    fn clusters_stand_in_the_order_in_which_they_follow() {
        assert_eq!(chained(&model(4, 1).primitives[0]), [3, 0, 1, 2]);
        assert_eq!(shown_frames(4), [0, 1, 2, 3]);
        assert_eq!(shown_frames(17), [2, 4, 6, 8, 10, 12, 14, 16]);
    }
}
