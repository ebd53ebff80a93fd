//! Frames per second of the trackers of silhouettes with the papers' settings.
//! Ten solids, four views of 320 × 240 pixels, one thread and two.
//!
//! One iteration is one frame: the step of the tracker and the binding of the frame's masks.

use criterion::{Criterion, criterion_group, criterion_main};
use sinew::body::hppf24;
use sinew::core::density::PartLogDensity;
use sinew::core::lanes::Isa;
use sinew::core::part::PartTree;
use sinew::core::random::Stage;
use sinew::dynamics::level_walk::LevelWalk;
use sinew::dynamics::random_walk::{Between, RandomWalk};
use sinew::observe::silhouettes::bit_image::BitImage;
use sinew::observe::silhouettes::contour_map::contour_map;
use sinew::observe::silhouettes::image_likelihood::{Cues, ImageModel};
use sinew::observe::silhouettes::image_score::ImageScore;
use sinew::observe::silhouettes::solid_body::{SolidBody, part_tree};
use sinew::observe::{Camera, ObservationModel};
use sinew::samplers::annealed_search;
use sinew::samplers::grid::GridAxis;
use sinew::tracking::annealed::{self, Annealed};
use sinew::tracking::coarse_to_fine::{self, CoarseToFine};
use sinew::tracking::hppf::{self, Hppf};
use sinew::tracking::partitioned::{self, Partitioned};
use sinew::tracking::{StepInfo, Tracker};
use std::hint::black_box;
use std::sync::Arc;

fn model(score: ImageScore) -> ImageModel {
    let camera = |k: usize| {
        let angle = (0.25 + 0.5 * k as f64) * std::f64::consts::PI;
        let centre = [4.0 * angle.cos(), 4.0 * angle.sin(), 2.2];
        Camera::look_at(&format!("C{k}"), [320.0, 240.0], 330.0, centre, [0.0, 0.0, 1.0]).expect("a view")
    };
    let body = SolidBody::new(&hppf24::tree(1.0), &hppf24::flesh(1.0)).expect("ten solids");
    ImageModel {
        body: Arc::new(body),
        cameras: (0..4).map(camera).collect(),
        score,
        colours: Arc::default(),
        isa: Isa::best(),
    }
}

fn standing() -> Vec<f64> {
    let mut state = vec![0.0; 24];
    state[2] = hppf24::STANDING_HEIGHT_M;
    state
}

/// Half of a fast step of a walker at 30 frames a second.
fn sd() -> Vec<f64> {
    (0..24).map(|j| if j < 3 { 0.02 } else { 0.06 }).collect()
}

fn parts() -> PartTree {
    part_tree(&hppf24::tree(1.0), &hppf24::flesh(1.0)).expect("a solid a link")
}

fn bound(model: &ImageModel, masks: &[BitImage]) -> impl PartLogDensity {
    let cues = |mask: &BitImage| Some(Cues { edges: Some(contour_map(mask)), silhouette: mask.clone(), picture: None });
    model.bind(masks.iter().map(cues).collect())
}

fn trackers(c: &mut Criterion) {
    let isa = Isa::best();
    let walk = || RandomWalk::new(&sd(), 1.0, Between::Gaussian, isa).expect("valid");
    let one_sided = ImageScore::DeutscherReid { kappa: 1.0, bidirectional: None };
    let both = ImageScore::DeutscherReid { kappa: 1.0, bidirectional: Some(0.5) };
    let fine = ImageScore::CoarseToFine { sigma_edge: 0.2, sigma_region: 0.2 };
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let mut group = c.benchmark_group(format!("silhouettes, a frame of four views, {threads} threads"));
        group.sample_size(20);
        let mut row =
            |name: &str, score: ImageScore, step: &mut (dyn FnMut(&dyn PartLogDensity, Stage) -> StepInfo + Send)| {
                let model = model(score);
                let masks = model.silhouettes(&standing());
                let mut frame = 0;
                group.bench_function(name, |b| {
                    b.iter(|| {
                        frame += 1;
                        let stage = Stage::new(1, "bench").at_frame(frame);
                        pool.install(|| black_box(step(&bound(&model, &masks), stage)))
                    });
                });
            };
        let annealed = |particles, layers| {
            let layers = annealed_search::Config { layers, ..annealed_search::Config::default() };
            let config = annealed::Config { particles, layers };
            Annealed::new(config, walk(), sd(), standing(), isa).expect("valid")
        };
        let mut tracker = annealed(200, 5);
        row("annealed, 5 x 200", one_sided, &mut |seen, stage| tracker.step(seen, stage).expect("weights"));
        let mut tracker = annealed(200, 5);
        row("annealed, 5 x 200, both directions", both, &mut |seen, stage| tracker.step(seen, stage).expect("weights"));
        let mut tracker = annealed(100, 5);
        row("annealed, 5 x 100", one_sided, &mut |seen, stage| tracker.step(seen, stage).expect("weights"));
        let axes = sd().iter().map(|sd| GridAxis::new(-3.2, 3.2, *sd, false).expect("an axis")).collect();
        let config = coarse_to_fine::Config::default();
        let mut tracker = CoarseToFine::new(config, axes, parts(), standing(), isa).expect("valid");
        row("coarse to fine, 300 + 500", fine, &mut |seen, stage| tracker.step(seen, stage).expect("weights"));
        let config = partitioned::Config { particles: 200, ..partitioned::Config::default() };
        let mut tracker = Partitioned::new(config, walk(), parts(), standing()).expect("valid");
        row("partitioned, 200", ImageScore::Parts, &mut |seen, stage| tracker.step(seen, stage).expect("weights"));
        let motion = LevelWalk::new(parts(), sd(), sd(), isa).expect("valid");
        let mut tracker = Hppf::new(hppf::Config::default(), motion, &parts(), standing()).expect("valid");
        row("hppf, 200", ImageScore::Parts, &mut |seen, stage| tracker.step(seen, stage).expect("weights"));
        group.finish();
    }
}

criterion_group!(benches, trackers);
criterion_main!(benches);
