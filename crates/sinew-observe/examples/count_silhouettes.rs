//! Compares bodies with silhouettes a given number of times, for counting instructions:
//!
//! ```text
//! valgrind --tool=callgrind target/release/examples/count_silhouettes avx2 pixels 100
//! valgrind --tool=callgrind target/release/examples/count_silhouettes avx2 pixels 200
//! ```
//!
//! The difference of the two counts, divided by 8 · 100, is the number of instructions a body: ten solids in four views of 320 × 240 pixels. Valgrind shows the program a processor without AVX-512.

use sinew_body::hppf24;
use sinew_core::density::{LogDensity, PartLogDensity};
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_observe::silhouettes::contour_map::contour_map;
use sinew_observe::silhouettes::image_likelihood::{Cues, ImageModel};
use sinew_observe::silhouettes::image_score::ImageScore;
use sinew_observe::silhouettes::solid_body::SolidBody;
use sinew_observe::{Camera, ObservationModel};
use std::error::Error;
use std::hint::black_box;
use std::sync::Arc;

/// The parts that the hierarchical filter judges: torso; head, upper limbs and torso; all.
const LEVELS: [&[usize]; 3] = [&[0], &[1, 2, 4, 6, 8, 0], &[3, 5, 7, 9, 0, 1, 2, 4, 6, 8]];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [set, part, blocks] = &arguments[..] else {
        return Err(
            "give an instruction set, `pixels`, `alignment`, `one-sided`, `both`, `parts` or `levels`, and a number of blocks"
                .into(),
        );
    };
    let isa = Isa::by_name(set).ok_or(format!("this processor has no `{set}`"))?;
    let reid = |bidirectional| ImageScore::DeutscherReid { kappa: 1.0, bidirectional };
    let score = match part.as_str() {
        "pixels" | "both" => reid(Some(0.5)),
        "one-sided" => reid(None),
        "parts" | "alignment" | "levels" => ImageScore::Parts,
        other => return Err(format!("no part `{other}`").into()),
    };
    let mut cameras = vec![];
    for k in 0..4 {
        let angle = (0.25 + 0.5 * f64::from(k)) * std::f64::consts::PI;
        let centre = [4.0 * angle.cos(), 4.0 * angle.sin(), 2.2];
        cameras.push(Camera::look_at(&format!("C{k}"), [320.0, 240.0], 330.0, centre, [0.0, 0.0, 1.0])?);
    }
    let body = Arc::new(SolidBody::new(&hppf24::tree(1.0), &hppf24::flesh(1.0))?);
    let model = ImageModel { body, cameras, score, colours: Arc::default(), isa };
    let mut truth = vec![0.0; 24];
    truth[2] = hppf24::STANDING_HEIGHT_M;
    let cues = |silhouette| {
        let edges = (!["pixels", "alignment"].contains(&part.as_str())).then(|| contour_map(&silhouette));
        Some(Cues { edges, silhouette, picture: None })
    };
    let bound = model.bind(model.silhouettes(&truth).into_iter().map(cues).collect());
    // Eight bodies a few degrees and centimetres apart.
    let lanes = |(j, &x): (usize, &f64)| {
        Block(core::array::from_fn(|lane| x + 0.02 * (((7 * j + 3 * lane) % LANES) as f64 - 3.5)))
    };
    let x: Vec<Block> = truth.iter().enumerate().map(lanes).collect();
    for _ in 0..blocks.parse::<usize>()? {
        match part.as_str() {
            "pixels" => bound.overlaps_block(black_box(&x), |_, overlaps| _ = black_box(overlaps)),
            "alignment" => _ = black_box(bound.alignment_block(black_box(&x))),
            "levels" => {
                let mut out = [Block::ZERO; 10];
                for level in LEVELS {
                    bound.log_density_parts_block(level, black_box(&x), &mut out[..level.len()], &mut []);
                    black_box(&out);
                }
                black_box(bound.alignment_block(black_box(&x)));
            }
            _ => _ = black_box(bound.log_density_block(black_box(&x), &mut [])),
        }
    }
    Ok(())
}
