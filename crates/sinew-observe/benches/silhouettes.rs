//! Silhouette scores per body and frame: ten solids in four views of 320 × 240 pixels.
//!
//! One iteration is one body, so criterion prints what a body costs.

use criterion::{Bencher, Criterion, criterion_group, criterion_main};
use sinew_body::hppf24;
use sinew_core::density::{LogDensity, PartLogDensity};
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::Stage;
use sinew_observe::silhouettes::colour_histogram::Counts;
use sinew_observe::silhouettes::image_likelihood::{Cues, ImageLikelihood, ImageModel};
use sinew_observe::silhouettes::image_score::ImageScore;
use sinew_observe::silhouettes::solid_body::SolidBody;
use sinew_observe::{Camera, Map, ObservationModel, RgbImage};
use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Times `call`, which treats a block of bodies, so that one iteration is one body.
fn per_body(b: &mut Bencher<'_>, mut call: impl FnMut()) {
    b.iter_custom(|iterations| {
        let calls = iterations.div_ceil(LANES as u64);
        let start = Instant::now();
        for _ in 0..calls {
            call();
        }
        Duration::from_secs_f64(start.elapsed().as_secs_f64() * iterations as f64 / (calls * LANES as u64) as f64)
    });
}

/// The parts that the hierarchical filter judges: torso; head, upper limbs and torso; all.
const LEVELS: [&[usize]; 3] = [&[0], &[1, 2, 4, 6, 8, 0], &[3, 5, 7, 9, 0, 1, 2, 4, 6, 8]];

fn model(score: ImageScore) -> ImageModel {
    let tree = hppf24::tree(1.0);
    let camera = |k: usize| {
        let angle = (0.25 + 0.5 * k as f64) * std::f64::consts::PI;
        let centre = [4.0 * angle.cos(), 4.0 * angle.sin(), 2.2];
        Camera::look_at(&format!("C{k}"), [320.0, 240.0], 330.0, centre, [0.0, 0.0, 1.0]).expect("a view")
    };
    ImageModel {
        body: Arc::new(SolidBody::new(&tree, &hppf24::flesh(1.0)).expect("ten solids")),
        cameras: (0..4).map(camera).collect(),
        score,
        colours: Arc::default(),
        isa: Isa::best(),
    }
}

/// Bodies about a standing one, 0.1 rad and 3 cm around it: what annealing looks at.
fn bodies() -> Vec<Block> {
    let mut states = vec![Block::ZERO; 24];
    Stage::new(1, "bodies").whole().fill_normal(Isa::best(), &mut states);
    for (j, x) in states.iter_mut().enumerate() {
        let (centre, sd) = match j {
            0 | 1 => (0.0, 0.03),
            2 => (hppf24::STANDING_HEIGHT_M, 0.03),
            _ => (0.0, 0.1),
        };
        x.0 = x.0.map(|z| centre + sd * z);
    }
    states
}

/// The product over parts with colours besides edges, which a body in a known pose had in a picture of many colours.
fn with_colours(truth: &[f64], edge: &Map) -> ImageLikelihood {
    let plain = model(ImageScore::Parts);
    let colour = |x: usize, y: usize| [(x / 9 * 37) as u8, (y / 11 * 53) as u8, ((x + y) / 17 * 91) as u8];
    let pixels = (0..240).flat_map(|y| (0..320).map(move |x| colour(x, y))).collect();
    let picture = RgbImage { width: 320, height: 240, pixels };
    let reference = |camera| plain.colours_of(camera, truth, &picture).iter().map(Counts::reference).collect();
    let colours = Arc::new((0..plain.cameras.len()).map(reference).collect());
    let cues = |silhouette| Cues { silhouette, edges: Some(edge.clone()), picture: Some(picture.clone()) };
    let frame = plain.silhouettes(truth).into_iter().map(|silhouette| Some(cues(silhouette))).collect();
    ImageModel { colours, ..plain }.bind(frame)
}

fn scores(c: &mut Criterion) {
    let mut group = c.benchmark_group("ten solids, four views of 320 x 240");
    let mut truth = [0.0; 24];
    truth[2] = hppf24::STANDING_HEIGHT_M;
    let states = bodies();
    let edge = Map::from_fn(320, 240, |x, y| ((x * 7 + y * 13) % 32) as f32 / 31.0);
    let bound = |score: ImageScore, with_edges: bool| {
        let model = model(score);
        let frame = model
            .silhouettes(&truth)
            .into_iter()
            .map(|silhouette| Some(Cues { silhouette, edges: with_edges.then(|| edge.clone()), picture: None }));
        model.bind(frame.collect())
    };
    let reid = |bidirectional| ImageScore::DeutscherReid { kappa: 1.0, bidirectional };
    let counted = bound(reid(Some(0.5)), false);
    group.bench_function("union and mismatch", |b| {
        per_body(b, || counted.overlaps_block(black_box(&states), |_, overlaps| _ = black_box(overlaps)));
    });
    group.bench_function("alignment", |b| {
        per_body(b, || _ = black_box(counted.alignment_block(black_box(&states))));
    });
    for (name, score, edges) in [
        ("region", reid(None), false),
        ("edges and region", reid(None), true),
        ("edges and pixels in both directions", reid(Some(0.5)), true),
        ("coarse to fine", ImageScore::CoarseToFine { sigma_edge: 0.2, sigma_region: 0.2 }, true),
        ("parts", ImageScore::Parts, true),
    ] {
        let bound = bound(score, edges);
        group.bench_function(name, |b| {
            per_body(b, || _ = black_box(bound.log_density_block(black_box(&states), &mut [])));
        });
    }
    let coloured = with_colours(&truth, &edge);
    group.bench_function("parts with colours", |b| {
        per_body(b, || _ = black_box(coloured.log_density_block(black_box(&states), &mut [])));
    });
    let parts = bound(ImageScore::Parts, true);
    group.bench_function("parts of three levels (1 + 6 + 10) and alignment", |b| {
        per_body(b, || {
            let mut out = [Block::ZERO; 10];
            for level in LEVELS {
                parts.log_density_parts_block(level, black_box(&states), &mut out[..level.len()], &mut []);
                black_box(&out);
            }
            black_box(parts.alignment_block(black_box(&states)));
        });
    });
    group.finish();
}

criterion_group!(benches, scores);
criterion_main!(benches);
