//! Evaluates the keypoint likelihood a given number of times, for counting instructions:
//!
//! ```text
//! valgrind --tool=callgrind target/release/examples/count_keypoints avx2 brown gradient 1000
//! valgrind --tool=callgrind target/release/examples/count_keypoints avx2 brown gradient 2000
//! ```
//!
//! The difference of the two counts, divided by 8 · 1000, is the number of instructions a state: 26 points in four views, all seen. Valgrind shows the program a processor without AVX-512.

use sinew_body::standard::h32;
use sinew_body::{Plan, Proportions, point_positions};
use sinew_core::density::{GaussNewton, GradLogDensity, LogDensity};
use sinew_core::lanes::{Block, Isa, triangle};
use sinew_observe::cameras::lens::{Brown, Fisheye, Lens, Rational};
use sinew_observe::{Camera, Detection, KeypointFrame, KeypointModel, Mistakes, Noise, ObservationModel, View};
use std::error::Error;
use std::hint::black_box;
use std::sync::Arc;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [set, lens, part, blocks] = &arguments[..] else {
        return Err("give an instruction set, a lens (`perfect`, `brown`, `rational` or `fisheye`), `value`, `gradient` or `matrix`, and a number of blocks".into());
    };
    let isa = Isa::by_name(set).ok_or(format!("this processor has no `{set}`"))?;
    let lens = match lens.as_str() {
        "perfect" => Lens::default(),
        "brown" => Brown { k1: -0.3, k2: 0.09, p1: 1e-3, p2: -2e-3, k3: 0.0 }.into(),
        "rational" => {
            Rational { numerator: [0.3, -0.08, 0.004], denominator: [0.62, -0.05, 0.012], p1: 1e-3, p2: -2e-3 }.into()
        }
        "fisheye" => Fisheye { k: [-0.012, 0.021, -0.015, 0.0035] }.into(),
        other => return Err(format!("no lens `{other}`").into()),
    };
    let plan = Arc::new(Plan::with_all_points(&h32(&Proportions::default())));
    let mut standing = vec![0.0; plan.dof()];
    standing[2] = 1.0;
    let mut points = vec![0.0; 3 * plan.points()];
    point_positions(&plan, isa, &standing, &mut points);
    let mut views = vec![];
    let mut detections = vec![];
    for k in 0..4 {
        let (sin, cos) = (0.4 + 1.57 * f64::from(k)).sin_cos();
        let camera =
            Camera::look_at(&format!("C{k}"), [1000.0, 1200.0], 900.0, [4.0 * cos, 4.0 * sin, 1.5], [0.0, 0.0, 1.0])?;
        let camera = Camera { lens, ..camera };
        let detected = points.as_chunks::<3>().0.iter().map(|p| Some(Detection::new(camera.project(*p).pixel()?, 0.7)));
        detections.push(detected.collect::<Vec<_>>());
        views.push(View { camera, bias_px: vec![[3.0, -2.0]; points.len() / 3], sigma_px: 8.0, usual_confidence: 0.7 });
    }
    let noise = Noise::OutlierFloor { outlier: 0.02 };
    let model = KeypointModel {
        plan,
        views,
        noise,
        model_error_m: 0.015,
        least_confidence: 0.05,
        mistakes: Mistakes::default(),
        isa,
    };
    let bound = model.bind(KeypointFrame { detections: &detections, elsewhere: &[], predicted: &points });
    let x: Vec<Block> = standing.iter().map(|&x| Block::splat(x + 0.01)).collect();
    let d = x.len();
    let (mut gradient, mut matrix) = (vec![Block::ZERO; d], vec![Block::ZERO; triangle(d, 0)]);
    let mut workspace = vec![Block::ZERO; bound.workspace()];
    for _ in 0..blocks.parse::<usize>()? {
        match part.as_str() {
            "value" => _ = black_box(bound.log_density_block(black_box(&x), &mut workspace)),
            "gradient" => _ = black_box(bound.log_density_grad_block(black_box(&x), &mut gradient, &mut workspace)),
            "matrix" => bound.gauss_newton_block(black_box(&x), black_box(&mut matrix), &mut workspace),
            other => return Err(format!("no part `{other}`").into()),
        }
    }
    let value = bound.log_density_grad_block(&x, &mut gradient, &mut workspace);
    println!("{:016x} {:016x} {:016x}", value.0[0].to_bits(), gradient[7].0[3].to_bits(), matrix[40].0[5].to_bits());
    Ok(())
}
