//! Learns a two-dimensional map of walking and draws it.
//!
//! `cargo run --release -p sinew-latent --example walking_map [FILE.csv]`
//!
//! The rows are poses, read from a table with a line of names and then numbers (angles in radians, one row a frame), or, without one, six angles of two made-up walks, hips, knees and shoulders. A GPDM with two coordinates a latent is learned,
//! a walk is continued by its dynamics, and `walking_map.svg` shows latents, what the model knows around them and the continued walk.

use sinew_core::lanes::Isa;
use sinew_latent::gpdm;
use sinew_latent::mapping::Mapping;
use sinew_latent::motion::{LatentMotion, StepNoise, path};
use sinew_latent::training::{Config, Training};
use std::error::Error;
use std::fmt::Write as _;

fn main() -> Result<(), Box<dyn Error>> {
    let (rows, columns, sequences) = match std::env::args().nth(1) {
        Some(file) => table(&std::fs::read_to_string(file)?)?,
        None => (walks(), 6, vec![50, 50]),
    };
    let config = gpdm::Config { dim: 2, ..gpdm::Config::default() };
    let start = gpdm::model(&rows, columns, &sequences, &config)?;
    let mut training = Training::new(start, Config { steps: 300, ..Config::default() }, Isa::best())?;
    let end = training.run(|_| true);
    println!(
        "{} poses of {columns} angles, objective {:.1} after {} steps",
        rows.len() / columns,
        end.objective,
        end.steps
    );
    let model = training.into_model();
    let mapping = Mapping::new(&model, 0)?;
    let motion = LatentMotion::new(&model, 0, StepNoise::Predicted, Isa::best())?;
    let continued = path(&motion, model.nodes[0].latent(sequences[0] - 1), 40, None);
    std::fs::write("walking_map.svg", drawn(&mapping, &sequences, &continued))?;
    println!("walking_map.svg is written");
    Ok(())
}

/// Hips, knees and shoulders, left and right, over two walks of different pace.
fn walks() -> Vec<f64> {
    let pose = |phase: f64| {
        let side =
            |phase: f64| [0.45 * phase.sin(), -0.5 * (1.0 - (phase + 0.9).cos()).powi(2) / 2.0, -0.3 * phase.sin()];
        let ([left_hip, left_knee, left_shoulder], [right_hip, right_knee, right_shoulder]) =
            (side(phase), side(phase + std::f64::consts::PI));
        [left_hip, right_hip, left_knee, right_knee, left_shoulder, right_shoulder]
    };
    let walk = |pace: f64| (0..50).flat_map(move |n| pose(pace * f64::from(n)));
    walk(0.30).chain(walk(0.36)).collect()
}

/// Rows one after the other, their length, and the number of rows of each sequence.
type Table = (Vec<f64>, usize, Vec<usize>);

/// Numbers below a line of names: the rows, how long each is, and that they are one sequence.
fn table(text: &str) -> Result<Table, Box<dyn Error>> {
    let mut lines = text.lines();
    let columns = lines.next().ok_or("an empty table")?.split(',').count();
    let cells = lines.flat_map(|line| line.split(',').map(|cell| cell.trim().parse()));
    let rows: Vec<f64> = cells.collect::<Result<_, _>>()?;
    let count = rows.len() / columns;
    Ok((rows, columns, vec![count]))
}

/// Side of the picture, pixels, and cells along it.
const SIDE: f64 = 600.0;
const CELLS: usize = 60;

fn drawn(mapping: &Mapping, sequences: &[usize], continued: &[f64]) -> String {
    let largest = mapping.latents().iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let reach = 1.2 * largest;
    let pixel = |x: &[f64]| [(x[0] / reach + 1.0) * SIDE / 2.0, (1.0 - x[1] / reach) * SIDE / 2.0];
    let mut svg = format!("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {SIDE} {SIDE}\">\n");
    let cell = SIDE / CELLS as f64;
    for k in 0..CELLS * CELLS {
        let corner = [(k % CELLS) as f64 * cell, (k / CELLS) as f64 * cell];
        let place = [0, 1].map(|i| (2.0 * (corner[i] + cell / 2.0) / SIDE - 1.0) * reach);
        let latent = [place[0], -place[1]];
        let unknown = (mapping.variance_at(&latent) / mapping.prior_variance(&latent)).sqrt();
        let grey = (255.0 - 110.0 * unknown) as u8;
        let _ = writeln!(
            svg,
            "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{cell:.1}\" height=\"{cell:.1}\" fill=\"rgb({grey},{grey},{grey})\"/>",
            corner[0], corner[1]
        );
    }
    let mut line = |latents: &[f64], color: &str| {
        let points: Vec<String> = latents.chunks_exact(2).map(pixel).map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        let _ = writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"/>",
            points.join(" ")
        );
    };
    let mut rest = mapping.latents();
    for (&length, color) in sequences.iter().zip(["#0b6e99", "#3f9c6d"].iter().cycle()) {
        let (own, others) = rest.split_at(2 * length);
        line(own, color);
        rest = others;
    }
    line(continued, "#c2410c");
    svg + "</svg>\n"
}
