//! Outlines, pixels and scores of bodies in images against brute force.

mod hull;

use hull::convex_hull;
use proptest::prelude::*;
use sinew_body::frustum::Frustum;
use sinew_body::{KinematicTree, Plan, hppf24, point_positions};
use sinew_core::density::{LogDensity, PartLogDensity};
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::Stage;
use sinew_observe::silhouettes::bit_image::{BitImage, overlap};
use sinew_observe::silhouettes::colour_histogram::Counts;
use sinew_observe::silhouettes::image_likelihood::{Cues, ImageModel};
use sinew_observe::silhouettes::image_score::ImageScore;
use sinew_observe::silhouettes::solid_body::SolidBody;
use sinew_observe::{Camera, Map, ObservationModel, RgbImage};
use std::sync::Arc;

const SIZE: [usize; 2] = [160, 120];

fn cameras() -> Vec<Camera> {
    let camera = |k: usize| {
        let angle = (0.25 + 0.5 * k as f64) * std::f64::consts::PI;
        let centre = [4.0 * angle.cos(), 4.0 * angle.sin(), 2.2];
        Camera::look_at(&format!("C{k}"), SIZE.map(|x| x as f64), 200.0, centre, [0.0, 0.0, 1.0]).expect("a view")
    };
    (0..3).map(camera).collect()
}

fn model(score: ImageScore, isa: Isa) -> (ImageModel, KinematicTree) {
    let tree = hppf24::tree(1.0);
    let body = Arc::new(SolidBody::new(&tree, &hppf24::flesh(1.0)).expect("ten solids"));
    (ImageModel { body, cameras: cameras(), score, colours: Arc::default(), isa }, tree)
}

/// Poses around one that stands, with limbs anywhere in reach of half a radian.
fn poses(count: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut noise = vec![Block::ZERO; 24 * count.div_ceil(LANES)];
    Stage::new(seed, "poses").whole().fill_normal(Isa::baseline(), &mut noise);
    let pose = |i: usize| {
        let z = |j: usize| noise[i / LANES * 24 + j].0[i % LANES];
        (0..24)
            .map(|j| match j {
                0 | 1 => 0.2 * z(j),
                2 => hppf24::STANDING_HEIGHT_M + 0.05 * z(j),
                3 => 2.0 * z(j),
                _ => 0.5 * z(j),
            })
            .collect()
    };
    (0..count).map(pose).collect()
}

/// Frames of all solids: base, x, y, top.
fn frames(tree: &KinematicTree, state: &[f64]) -> Vec<[[f64; 3]; 4]> {
    let (with, first) = hppf24::flesh(1.0).with_frames(tree).expect("new names");
    let plan = Plan::new(&with, &(first..with.points().len()).collect::<Vec<_>>());
    let mut at = vec![0.0; 3 * plan.points()];
    point_positions(&plan, Isa::baseline(), state, &mut at);
    at.chunks(12).map(|p| [0, 1, 2, 3].map(|k: usize| [p[3 * k], p[3 * k + 1], p[3 * k + 2]])).collect()
}

/// A point of a solid in the world.
fn placed(frame: &[[f64; 3]; 4], solid: &Frustum, local: [f64; 3]) -> [f64; 3] {
    let [base, x, y, top] = frame;
    [0, 1, 2].map(|k| {
        base[k]
            + local[0] * (x[k] - base[k])
            + local[1] * (y[k] - base[k])
            + local[2] / solid.height * (top[k] - base[k])
    })
}

fn area(corners: &[[f64; 2]]) -> f64 {
    let next = |i: usize| corners[(i + 1) % corners.len()];
    0.5 * (0..corners.len()).map(|i| corners[i][0] * next(i)[1] - corners[i][1] * next(i)[0]).sum::<f64>()
}

/// The hull of the projected rims of a solid, `per_rim` points each.
fn hull(camera: &Camera, frame: &[[f64; 3]; 4], solid: &Frustum, per_rim: usize) -> Option<Vec<[f64; 2]>> {
    let mut points = vec![];
    for z in [0.0, solid.height] {
        for k in 0..per_rim {
            let v = std::f64::consts::TAU * k as f64 / per_rim as f64;
            points.push(camera.project_ideal(placed(frame, solid, solid.surface(v, z)))?);
        }
    }
    let mut corners = vec![];
    convex_hull(&mut points, &mut corners);
    Some(corners)
}

/// Area of outlines (K11): the outline without sorting is the hull: no corner outside of the hull of many points, and no smaller than the hull of 24 a rim.
#[test]
fn outlines_are_hulls() {
    let (model, tree) = model(ImageScore::Parts, Isa::best());
    let flesh = hppf24::flesh(1.0);
    let mut count = 0;
    for state in poses(60, 1) {
        let frames = frames(&tree, &state);
        for (camera, outlines) in model.cameras.iter().zip(model.outlines(&state)) {
            for (solid, outline) in outlines {
                let shape = &flesh.solids()[solid].frustum;
                let fine = hull(camera, &frames[solid], shape, 2000).expect("in front");
                let coarse = hull(camera, &frames[solid], shape, 24).expect("in front");
                let (exact, found, usual) = (area(&fine), -area(&outline), area(&coarse));
                assert!(found < exact * 1.005 + 0.05, "{found} of {exact}, solid {solid}");
                assert!(found > 0.99 * exact - 0.05, "{found} of {exact}, {usual} by 24 points, solid {solid}");
                for corner in &outline {
                    let inside = |i: usize| {
                        let (a, b) = (fine[i], fine[(i + 1) % fine.len()]);
                        (b[0] - a[0]) * (corner[1] - a[1]) - (b[1] - a[1]) * (corner[0] - a[0])
                            > -0.3 * (b[0] - a[0]).hypot(b[1] - a[1])
                    };
                    assert!((0..fine.len()).all(inside), "a corner sticks out of solid {solid}");
                }
                count += 1;
            }
        }
    }
    assert_eq!(count, 60 * 3 * 10);
}

/// Eyes beside, before, behind and on the axis, also where no generator is seen.
#[test]
fn outlines_hold_from_all_sides() {
    let tree = hppf24::tree(1.0);
    let flesh = hppf24::flesh(1.0);
    let body = Arc::new(SolidBody::new(&tree, &flesh).expect("ten solids"));
    let state = vec![0.0; 24];
    let frames = frames(&tree, &state);
    let mut without_sides = 0;
    for k in 0..400 {
        let angle = f64::from(k) * 0.37;
        let height = f64::from(k % 40) * 0.15 - 3.0;
        let away = 0.02 + 0.9 * f64::from(k % 7);
        // The left forearm hangs at x = −0.18, between z = −0.04 and 0.22.
        let centre = [away * angle.cos() - 0.18, away * angle.sin(), 0.1 + height];
        let Ok(camera) = Camera::look_at("C", [400.0, 400.0], 300.0, centre, [-0.18, 0.001, 0.1]) else { continue };
        let solid = 3;
        let shape = &flesh.solids()[solid].frustum;
        let Some(fine) = hull(&camera, &frames[solid], shape, 1000) else { continue };
        let one = ImageModel {
            body: Arc::clone(&body),
            cameras: vec![camera],
            score: ImageScore::Parts,
            colours: Arc::default(),
            isa: Isa::best(),
        };
        let outlines = one.outlines(&state).remove(0);
        let Some((_, outline)) = outlines.iter().find(|(found, _)| *found == solid) else { continue };
        let local = [0, 1, 2].map(|k| centre[k] - frames[solid][0][k]);
        let eye = [-local[0], local[1], -local[2]];
        // An eye in the solid sees no outline.
        if shape.contour(eye).is_none() && (0.0..shape.height).contains(&eye[2]) {
            continue;
        }
        without_sides += usize::from(shape.contour(eye).is_none());
        let (exact, found) = (area(&fine), -area(outline));
        assert!(found < exact * 1.01 + 0.1 && found > 0.98 * exact - 0.1, "{found} of {exact} from {centre:?}");
    }
    assert!(without_sides > 10, "{without_sides} views along the axis");
}

/// The outline without what rounding to parts of a pixel has turned inwards, counter-clockwise as seen.
fn ordered(mut outline: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let mut corners = vec![];
    convex_hull(&mut outline, &mut corners);
    corners.reverse();
    corners
}

fn covered(polygon: &[[f64; 2]], x: i32, y: i32) -> bool {
    let [px, py] = [f64::from(x) + 0.5, f64::from(y) + 0.5];
    // Counter-clockwise as seen, y down.
    (0..polygon.len()).all(|i| {
        let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
        let side = (b[0] - a[0]) * (py - a[1]) - (b[1] - a[1]) * (px - a[0]);
        side < 0.0 || side == 0.0 && (b[1] > a[1] || b[1] == a[1] && b[0] < a[0] || a == b)
    })
}

/// What a score is by its words: every point by itself, every polygon by its edges.
struct BruteForce<'a> {
    model: &'a ImageModel,
    tree: &'a KinematicTree,
    outer: bool,
}

#[derive(Default, Clone, Copy)]
struct Sum {
    inside: f64,
    outside: f64,
    misses: f64,
}

impl BruteForce<'_> {
    /// Region and edge sums of each solid in a camera.
    fn sums(&self, camera: usize, cues: &Cues, state: &[f64]) -> Vec<[Sum; 2]> {
        self.sums_and_pixels(camera, cues, state, |_, _, _| {})
    }

    /// The same, showing each region pixel that is seen, with its solid.
    fn sums_and_pixels(
        &self,
        camera: usize,
        cues: &Cues,
        state: &[f64],
        mut seen: impl FnMut(usize, usize, usize),
    ) -> Vec<[Sum; 2]> {
        let flesh = hppf24::flesh(1.0);
        let frames = frames(self.tree, state);
        let view = &self.model.cameras[camera];
        let mut polygons = vec![vec![]; 10];
        for (solid, outline) in self.model.outlines(state).swap_remove(camera) {
            polygons[solid] = ordered(outline);
        }
        let depth = |solid: usize| {
            let [base, _, _, top] = &frames[solid];
            view.point_in_camera([0, 1, 2].map(|k| 0.5 * (base[k] + top[k])))[2]
        };
        let hangs_together = |a: usize, b: usize| flesh.parents()[a] == Some(b) || flesh.parents()[b] == Some(a);
        let hidden = |solid: usize, u: f64, x: i32, y: i32| {
            (0..10).filter(|&other| other != solid).any(|other| {
                let may = if self.outer {
                    true
                } else {
                    let joint = !(0.15..=0.85).contains(&u);
                    depth(other) < depth(solid) && !(joint && hangs_together(solid, other))
                };
                may && polygons[other].len() > 2 && covered(&polygons[other], x, y)
            })
        };
        let mut sums = vec![[Sum::default(); 2]; 10];
        for (solid, sums) in sums.iter_mut().enumerate() {
            let shape = &flesh.solids()[solid].frustum;
            let [base, ax, ay, top] = &frames[solid];
            let unit = |end: &[f64; 3], scale: f64| [0, 1, 2].map(|k| (end[k] - base[k]) / scale);
            let axes = [unit(ax, 1.0), unit(ay, 1.0), unit(top, shape.height)];
            let sight = [0, 1, 2].map(|k| view.centre()[k] - base[k]);
            let eye = axes.map(|axis| (0..3).map(|k| axis[k] * sight[k]).sum());
            let Some(contour) = shape.contour(eye) else { continue };
            let at = |v: f64, u: f64| {
                view.project_ideal(placed(&frames[solid], shape, shape.surface(v, u * shape.height))).expect("in front")
            };
            let mut add = |cue: usize, u: f64, [x, y]: [f64; 2]| {
                let (x, y) = (x.floor() as i32, y.floor() as i32);
                let sum = &mut sums[cue];
                if x < 0 || y < 0 || x >= SIZE[0] as i32 || y >= SIZE[1] as i32 {
                    sum.outside += 1.0;
                    return;
                }
                if !(self.outer && cue == 0) && hidden(solid, u, x, y) {
                    return;
                }
                let (x, y) = (x as usize, y as usize);
                if cue == 0 {
                    seen(solid, x, y);
                }
                let value = match cue {
                    0 => f64::from(u8::from(cues.silhouette.get(x, y))),
                    _ => cues.edges.as_ref().map_or(0.0, |map| f64::from(map.get(x, y).expect("inside"))),
                };
                sum.inside += 1.0;
                sum.misses += (1.0 - value) * (1.0 - value);
            };
            for i in 0..10 {
                let u = (f64::from(i) + 0.5) / 10.0;
                let [minus, plus] = contour.map(|v| at(v, u));
                for j in 0..6 {
                    let w = (f64::from(j) + 0.5) / 6.0;
                    add(0, u, [0, 1].map(|k| (1.0 - w) * plus[k] + w * minus[k]));
                }
            }
            for v in contour {
                for i in 0..12 {
                    let u = (f64::from(i) + 0.5) / 12.0;
                    add(1, u, at(v, u));
                }
            }
        }
        sums
    }

    fn means(sums: &[[Sum; 2]]) -> [f64; 2] {
        [0, 1].map(|cue| {
            let (mut all, mut misses) = (0.0, 0.0);
            for sum in sums {
                all += sum[cue].inside + sum[cue].outside;
                misses += sum[cue].misses + sum[cue].outside;
            }
            misses / all
        })
    }
}

/// Images of a body and of nothing in particular: a silhouette of another pose, edges of a pattern.
fn seen(model: &ImageModel, truth: &[f64]) -> Vec<Option<Cues>> {
    let pattern = |x: usize, y: usize| ((x * 7 + y * 13) % 32) as f32 / 31.0;
    model
        .silhouettes(truth)
        .into_iter()
        .map(|silhouette| {
            Some(Cues { edges: Some(Map::from_fn(SIZE[0], SIZE[1], pattern)), silhouette, picture: None })
        })
        .collect()
}

#[test]
fn scores_match_brute_force() {
    let reid = ImageScore::DeutscherReid { kappa: 10.0, bidirectional: None };
    let fine = ImageScore::CoarseToFine { sigma_edge: 0.2, sigma_region: 0.3 };
    for isa in Isa::available() {
        for (score, outer) in [(reid, false), (fine, true), (ImageScore::Parts, false)] {
            let (model, tree) = model(score, isa);
            let states = poses(24, 2);
            let frame = seen(&model, &states[0]);
            let bound = model.bind(frame.clone());
            let brute = BruteForce { model: &model, tree: &tree, outer };
            for state in &states {
                let views: Vec<_> = frame
                    .iter()
                    .enumerate()
                    .map(|(camera, cues)| brute.sums(camera, cues.as_ref().expect("seen"), state))
                    .collect();
                let part = |[region, edges]: &[Sum; 2]| {
                    let hits = |sum: &Sum| if sum.inside > 0.0 { 1.0 - sum.misses / sum.inside } else { 1.0 };
                    let relevance = 0.5 * (region.inside / 60.0 + edges.inside / 24.0);
                    relevance * (0.5 * (hits(region) + hits(edges))).max(1e-3).ln()
                };
                let expected: f64 = views
                    .iter()
                    .map(|sums| match score {
                        ImageScore::Parts => sums.iter().map(part).sum(),
                        ImageScore::DeutscherReid { .. } => -10.0 * BruteForce::means(sums).iter().sum::<f64>(),
                        ImageScore::CoarseToFine { .. } => {
                            let [region, edges] = BruteForce::means(sums);
                            -0.5 * (edges / 0.04 + region / 0.09)
                        }
                    })
                    .sum();
                let found = bound.log_density(state);
                assert!((found - expected).abs() < 1e-9, "{found} for {expected}, {score:?}, {}", isa.name());
                if score == ImageScore::Parts {
                    let block: Vec<Block> = state.iter().map(|&x| Block::splat(x)).collect();
                    let mut parts = vec![Block::ZERO; 10];
                    bound.log_density_parts_block(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 9], &block, &mut parts, &mut []);
                    for (solid, found) in parts.iter().enumerate() {
                        let expected: f64 = views.iter().map(|sums| part(&sums[solid])).sum();
                        assert!((found.0[3] - expected).abs() < 1e-9, "{} for {expected}", found.0[3]);
                    }
                    let mut some = vec![Block::ZERO; 3];
                    bound.log_density_parts_block(&[7, 2, 5], &block, &mut some, &mut []);
                    assert_eq!(some, [7, 2, 5].map(|solid| parts[solid]));
                }
            }
        }
    }
}

/// Colours of the visible region, against histograms by their definition.
#[test]
fn colours_match_brute_force() {
    let (mut model, tree) = model(ImageScore::Parts, Isa::best());
    let states = poses(12, 5);
    let bands =
        |x: usize, y: usize| [(x / 9 * 37 % 256) as u8, (y / 11 * 53 % 256) as u8, ((x + y) / 17 * 91 % 256) as u8];
    let pixels = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| bands(x, y))).collect();
    let picture = RgbImage { width: SIZE[0], height: SIZE[1], pixels };
    let frame: Vec<Option<Cues>> = model
        .silhouettes(&states[0])
        .into_iter()
        .map(|silhouette| Some(Cues { silhouette, edges: None, picture: Some(picture.clone()) }))
        .collect();
    let reference = |camera| model.colours_of(camera, &states[0], &picture).iter().map(Counts::reference).collect();
    let references: Vec<Vec<_>> = (0..3).map(reference).collect();
    let histograms = |model: &ImageModel, camera: usize, state: &[f64]| {
        let brute = BruteForce { model, tree: &tree, outer: false };
        let mut counts = vec![vec![0.0; 512]; 10];
        let cues = frame[camera].as_ref().expect("seen");
        let sums = brute.sums_and_pixels(camera, cues, state, |solid, x, y| {
            let [r, g, b] = bands(x, y).map(|channel| usize::from(channel) / 32);
            counts[solid][64 * r + 8 * g + b] += 1.0;
        });
        (sums, counts)
    };
    let known: Vec<_> = (0..3).map(|camera| histograms(&model, camera, &states[0]).1).collect();
    model.colours = Arc::new(references);
    let bound = model.bind(frame.clone());
    let mut values = vec![];
    for state in &states {
        let mut expected = 0.0;
        for (camera, known) in known.iter().enumerate() {
            let (sums, counts) = histograms(&model, camera, state);
            for solid in 0..10 {
                let region = sums[solid][0];
                let hits = if region.inside > 0.0 { 1.0 - region.misses / region.inside } else { 1.0 };
                let [total, known_total] = [&counts[solid], &known[solid]].map(|h| h.iter().sum::<f64>());
                // A solid that was never seen has no colours to be found again.
                let (cues, colour) = if known_total == 0.0 {
                    (1.0, 0.0)
                } else {
                    let product = |(a, b): (&f64, &f64)| (a / total * b / known_total).sqrt();
                    let alike: f64 = counts[solid].iter().zip(&known[solid]).map(product).sum();
                    (2.0, if total > 0.0 { 1.0 - (1.0 - alike).max(0.0).sqrt() } else { 1.0 })
                };
                expected += region.inside / 60.0 * ((hits + colour) / cues).max(1e-3).ln();
            }
        }
        let found = bound.log_density(state);
        assert!((found - expected).abs() < 1e-6, "{found} for {expected}");
        values.push(found);
    }
    assert!(
        values[1..].iter().all(|value| *value < values[0] - 1.0),
        "the pose that gave the colours is best: {values:?}"
    );
}

/// Rasterised counts against pixels taken by their centres (K12), also of the mismatch in both directions.
#[test]
fn pixels_are_counted_as_brute_force_counts_them() {
    let score = ImageScore::DeutscherReid { kappa: 1.0, bidirectional: Some(0.5) };
    let (model, _) = model(score, Isa::best());
    let states = poses(16, 3);
    let silhouettes = model.silhouettes(&states[0]);
    let frame: Vec<_> =
        silhouettes.iter().map(|image| Some(Cues { silhouette: image.clone(), edges: None, picture: None })).collect();
    let bound = model.bind(frame);
    for state in &states {
        let mut expected = 0.0;
        let mut all = vec![];
        for (outlines, silhouette) in model.outlines(state).iter().zip(&silhouettes) {
            let polygons: Vec<_> = outlines.iter().map(|(_, outline)| ordered(outline.clone())).collect();
            let body = BitImage::from_fn(SIZE[0], SIZE[1], |x, y| {
                polygons.iter().any(|polygon| covered(polygon, x as i32, y as i32))
            });
            let counts = overlap(silhouette, &body, 0..SIZE[0]);
            all.push(counts);
            let share = |part: u64| part as f64 / (part + counts.both) as f64;
            expected -= 0.5 * share(counts.first_only) + 0.5 * share(counts.second_only);
        }
        assert!((bound.log_density(state) - expected).abs() < 1e-12);
        let block: Vec<Block> = state.iter().map(|&x| Block::splat(x)).collect();
        bound.overlaps_block(&block, |camera, found| assert_eq!(found, &[all[camera]; LANES]));
    }
    assert_eq!(bound.log_density(&states[0]), 0.0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// Lanes do not see each other, and one state gives what it gives in a block; also far outside of all views and behind cameras.
    #[test]
    fn lanes_are_independent(seed in 0..1000u64, far in -30.0..30.0f64) {
        let (model, _) = model(ImageScore::DeutscherReid { kappa: 5.0, bidirectional: None }, Isa::best());
        let mut states = poses(LANES, seed);
        states[3][0] += far;
        states[5][1] -= far;
        let bound = model.bind(seen(&model, &states[0]));
        let block: Vec<Block> = (0..24).map(|j| Block(core::array::from_fn(|lane| states[lane][j]))).collect();
        let values = bound.log_density_block(&block, &mut []);
        for (state, value) in states.iter().zip(values.0) {
            prop_assert_eq!(bound.log_density(state), value);
            prop_assert!(value.is_finite() && (-30.0..=0.0).contains(&value));
        }
    }
}

/// To leave all views is as bad as can be, and a view without anything seen says nothing.
#[test]
fn a_body_out_of_all_views_misses_everything() {
    let (model, _) = model(ImageScore::DeutscherReid { kappa: 1.0, bidirectional: None }, Isa::best());
    let state = poses(1, 4).remove(0);
    let mut frame = seen(&model, &state);
    let mut gone = state.clone();
    gone[2] = 500.0;
    assert_eq!(model.bind(frame.clone()).log_density(&gone), -6.0);
    frame[1] = None;
    assert_eq!(model.bind(frame).log_density(&gone), -4.0);
    assert_eq!(model.bind(vec![None; 3]).log_density(&gone), 0.0);
}
