//! The set-up pass on made-up recordings, of which everything is known.

use sinew::body::standard::h32;
use sinew::body::{Plan, Proportions, point_positions};
use sinew::core::lanes::Isa;
use sinew::formats::layout::{self, Layout};
use sinew::input::up_axis::z_up_from;
use sinew::observe::association::Person;
use sinew::observe::{Camera, Detection};
use sinew::setup::{self, Setup, SetupRequest, SetupWarning};

type Frames = Vec<(u64, Vec<Vec<Person>>)>;

fn ring(n: usize) -> Vec<Camera> {
    (0..n)
        .map(|i| {
            let angle = 0.4 + std::f64::consts::TAU * i as f64 / n as f64;
            let centre = [4.0 * angle.cos(), 4.0 * angle.sin(), 1.8];
            Camera::look_at(&format!("cam{}", i + 1), [1000.0, 1000.0], 1000.0, centre, [0.0, 0.0, 1.0]).unwrap()
        })
        .collect()
}

fn subject() -> Proportions {
    let mut p = Proportions { thigh: 0.46, shin: 0.40, upper_arm: 0.27, forearm: 0.24, ..Proportions::default() };
    p.big_toe[1] = 0.20;
    p.nose = [0.0, 0.12, 0.10];
    p
}

fn pose(t: f64, place: [f64; 2]) -> Vec<f64> {
    let tree = h32(&subject());
    let names = tree.dof_names();
    let mut q = vec![0.0; tree.dof()];
    q[..4].copy_from_slice(&[place[0], place[1], 1.03, 2.2 + 0.3 * t.sin()]);
    for (name, value) in [
        ("l_upper_arm.rx", 0.5 * t.sin()),
        ("l_upper_arm.ry", 0.3),
        ("r_upper_arm.rx", -0.5 * t.sin()),
        ("r_upper_arm.ry", -0.3),
        ("l_forearm.rx", 0.6 + 0.3 * t.cos()),
        ("r_forearm.rx", 0.6 - 0.3 * t.cos()),
        ("l_thigh.rx", -0.5 * t.sin()),
        ("r_thigh.rx", 0.5 * t.sin()),
        ("l_shin.rx", -0.5 - 0.4 * t.cos()),
        ("r_shin.rx", -0.5 + 0.4 * t.cos()),
        ("head.rz", 0.2 * t.cos()),
        ("pelvis.rx", 0.1 * t.sin()),
        ("l_foot.rx", 0.2 * t.cos()),
        ("r_foot.rx", -0.2 * t.cos()),
    ] {
        q[names.iter().position(|n| n == name).unwrap()] = value;
    }
    q
}

/// A repeatable number in [-1, 1].
fn noise(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

const OFFSETS: [[f64; 2]; 4] = [[8.0, -3.0], [-6.0, 2.0], [3.0, 5.0], [-4.0, -4.0]];

fn seen_by(camera: &Camera, layout: &Layout, q: &[f64], offset: [f64; 2], jitter: f64, seed: &mut u64) -> Person {
    let tree = h32(&subject());
    let plan = Plan::with_all_points(&tree);
    let mut p = vec![0.0; 3 * plan.points()];
    point_positions(&plan, Isa::baseline(), q, &mut p);
    layout
        .points
        .iter()
        .map(|name| {
            let k = tree.point_index(name.as_deref()?)?;
            let [u, v] = camera.project([p[3 * k], p[3 * k + 1], p[3 * k + 2]]).pixel()?;
            let mut off = || jitter * (noise(seed) + noise(seed) + noise(seed));
            Some(Detection::new([u + offset[0] + off(), v + offset[1] + off()], 0.8))
        })
        .collect()
}

fn record(cameras: &[Camera], layout: &Layout, frames: u64, jitter: f64) -> Frames {
    let mut seed = 7;
    (0..frames)
        .map(|n| {
            let q = pose(0.2 * n as f64, [0.01 * n as f64 - 0.2, 0.1]);
            let views = cameras
                .iter()
                .enumerate()
                .map(|(c, camera)| vec![seen_by(camera, layout, &q, OFFSETS[c % 4], jitter, &mut seed)])
                .collect();
            (n, views)
        })
        .collect()
}

fn set_up(cameras: &[Camera], layout: &Layout, frames: Frames) -> Result<(Setup, Vec<SetupWarning>), sinew::Error> {
    setup::set_up(cameras, layout, &SetupRequest::default(), frames.into_iter().map(Ok))
}

fn body_25b() -> Layout {
    layout::find("BODY_25B").unwrap()
}

#[test]
fn sizes_offsets_and_noise_are_found() {
    let (cameras, layout) = (ring(4), body_25b());
    let (found, warnings) = set_up(&cameras, &layout, record(&cameras, &layout, 60, 2.0)).unwrap();
    assert_eq!(warnings, []);
    let (p, truth) = (found.proportions, subject());
    for (name, found, truth) in [
        ("thigh", p.thigh, truth.thigh),
        ("shin", p.shin, truth.shin),
        ("upper arm", p.upper_arm, truth.upper_arm),
        ("forearm", p.forearm, truth.forearm),
        ("shoulders", p.shoulder_half_width, truth.shoulder_half_width),
        ("hips", p.hip_half_width, truth.hip_half_width),
        ("toe", p.big_toe[1] - p.heel[1], truth.big_toe[1] - truth.heel[1]),
    ] {
        assert!((found - truth).abs() < 0.006, "{name}: {found} m, truly {truth} m");
    }
    // The offsets but for a common shift of the world: the relative ones decide how the rays meet.
    for (camera, truth) in found.camera.iter().zip(OFFSETS) {
        assert!((camera.offset_px[0] - truth[0]).hypot(camera.offset_px[1] - truth[1]) < 8.0, "{:?}", camera.offset_px);
        assert!((camera.sigma_px - 2.0).abs() < 0.5, "{}", camera.sigma_px);
    }
    assert!(found.model_error_m < 0.006, "{}", found.model_error_m);
}

#[test]
fn a_swap_and_a_slow_clock_are_reported() {
    let (cameras, layout) = (ring(4), body_25b());
    let mut frames = record(&cameras, &layout, 80, 1.0);
    for (_, views) in &mut frames[20..41] {
        for (l, r) in layout.left_right_pairs() {
            views[1][0].swap(l, r);
        }
    }
    let late: Vec<_> = frames.iter().map(|(_, views)| views[2].clone()).collect();
    for (n, (_, views)) in frames.iter_mut().enumerate().skip(4) {
        views[2] = late[n - 4].clone();
    }
    let (_, warnings) = set_up(&cameras, &layout, frames).unwrap();
    let text: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    assert!(
        text.iter().any(|t| t.starts_with("cam2 frames 20-40: swapping left and right lowers the residual from ")),
        "{text:?}"
    );
    assert!(text.iter().any(|t| t.starts_with("cam3 is 4.") && t.contains("`--lag cam3=4`")), "{text:?}");
    assert_eq!(text.len(), 2, "{text:?}");
}

#[test]
fn a_camera_of_another_frame_rate_is_refused() {
    let (cameras, layout) = (ring(4), body_25b());
    let mut frames = record(&cameras, &layout, 300, 1.0);
    let all: Vec<_> = frames.iter().map(|(_, views)| views[2].clone()).collect();
    assert_eq!(set_up(&cameras, &layout, frames.clone()).unwrap().1, []);
    // Of a hundred frames cam3 drops one, but its files are numbered without a hole.
    for (n, (_, views)) in frames.iter_mut().enumerate() {
        views[2] = all[(n + n / 99).min(299)].clone();
    }
    let error = set_up(&cameras, &layout, frames).unwrap_err().to_string();
    let expected = "cam3 records 0.9905 frames for each frame of the other cameras: from frame 60 to 270 its lag changes by -2 frames";
    assert_eq!(error, expected);
}

#[test]
fn units_axes_and_inverted_cameras_are_diagnosed() {
    let (cameras, layout) = (ring(4), body_25b());
    let frames = record(&cameras, &layout, 12, 0.5);
    let in_mm: Vec<Camera> =
        cameras.iter().map(|c| Camera { translation: c.translation.map(|x| 1e3 * x), ..c.clone() }).collect();
    let error = set_up(&in_mm, &layout, frames.clone()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "cameras stand 4386 units from the origin but the skeleton is 1.8 tall; are translations in millimetres?"
    );

    let upside_down = |c: &Camera| Camera { rotation: c.rotation.map(|[x, y, z]| [x, -y, -z]), ..c.clone() };
    let turned: Vec<Camera> = cameras.iter().map(upside_down).collect();
    let (found, warnings) = set_up(&turned, &layout, frames.clone()).unwrap();
    assert_eq!(found.up_axis, "-z");
    let text: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    assert_eq!(
        text,
        [
            "feet are above the head in the first 12 frames; set `up_axis` (found: -z), or let the person say where up is: `--up auto`"
        ]
    );

    let z_up = z_up_from("-z").unwrap();
    let repaired: Vec<Camera> = turned.iter().map(|c| c.turned(z_up)).collect();
    assert_eq!(set_up(&repaired, &layout, frames.clone()).unwrap().0.up_axis, "+z");
    for up in ["+x", "-x", "+y", "-y", "+z", "-z"] {
        let turn = z_up_from(up).unwrap();
        let old = ["+x", "+y", "+z", "-x", "-y", "-z"].iter().position(|u| *u == up).unwrap();
        let axis = [0, 1, 2].map(|k: usize| f64::from(u8::from(k == old % 3)) * if old < 3 { 1.0 } else { -1.0 });
        let moved = turn.map(|row| row.iter().zip(axis).map(|(r, a)| r * a).sum::<f64>());
        assert_eq!(moved, [0.0, 0.0, 1.0], "{up}");
        assert!(ring(1)[0].turned(turn).validate().is_ok(), "{up} keeps right-handed axes");
    }

    let one_away = |away: &dyn Fn(&Camera) -> Camera| -> Vec<Camera> {
        cameras.iter().enumerate().map(|(c, camera)| if c == 2 { away(camera) } else { camera.clone() }).collect()
    };
    let facing_away = |c: &Camera| {
        let rotation = [c.rotation[0].map(|x| -x), c.rotation[1], c.rotation[2].map(|x| -x)];
        let t = c.translation;
        Camera { rotation, translation: [-t[0], t[1], -t[2]], ..c.clone() }
    };
    let (_, warnings) = set_up(&one_away(&facing_away), &layout, frames.clone()).unwrap();
    let text: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    assert_eq!(text, ["in 1 of 4 cameras the subject lies behind the lens; is the pose inverted? (cam3)"]);
    let inverted: Vec<Camera> = cameras.iter().map(facing_away).collect();
    let mut mirrored = frames.clone();
    for (_, views) in &mut mirrored {
        for d in views.iter_mut().flatten().flatten().flatten() {
            d.pixel[1] = 1000.0 - d.pixel[1];
        }
    }
    let error = set_up(&inverted, &layout, mirrored).unwrap_err();
    assert_eq!(error.to_string(), "in 4 of 4 cameras the subject lies behind the lens; is the pose inverted?");

    let empty: Frames = (0..5).map(|n| (n, vec![vec![]; 4])).collect();
    assert_eq!(set_up(&cameras, &layout, empty).unwrap_err().to_string(), "no person in any view of 5 frames");
}

#[test]
fn someone_who_leaves_is_found_again_and_sixteen_cameras_do_not_hang() {
    use sinew::observe::association::Config;
    use sinew::observe::association::following::{Following, follow};
    let (cameras, layout) = (ring(16), body_25b());
    let mut seed = 3;
    let mut following = Following::default();
    let started = std::time::Instant::now();
    for n in 0..60_u64 {
        let (him, other) = (pose(0.2 * n as f64, [0.01 * n as f64, 0.0]), pose(1.0 + 0.1 * n as f64, [-0.9, 0.8]));
        let away = (20..40).contains(&n);
        let people: Vec<Vec<Person>> = cameras
            .iter()
            .enumerate()
            .map(|(c, camera)| {
                let mut view = vec![];
                // The bystander is in half of the views, before or after the subject.
                if c % 2 == 0 {
                    view.push(seen_by(camera, &layout, &other, [0.0; 2], 1.0, &mut seed));
                }
                if !away {
                    view.insert(c % 3 % (view.len() + 1), seen_by(camera, &layout, &him, [0.0; 2], 1.0, &mut seed));
                }
                view
            })
            .collect();
        if n == 0 {
            let thigh = subject().thigh;
            let at = |name: &str| layout.index(name).unwrap();
            following.lengths = vec![(at("LHip"), at("LKnee"), thigh), (at("RHip"), at("RKnee"), thigh)];
        }
        let found = follow(&mut following, &cameras, &people, None, &Config { lost_frames: 25, ..Config::default() });
        let expected: Vec<Option<usize>> =
            (0..16).map(|c| (!away).then_some(if c % 2 == 0 { c % 3 % 2 } else { 0 })).collect();
        assert_eq!(found.members, expected, "frame {n}");
    }
    assert!(started.elapsed().as_secs() < 30);
}

#[test]
fn a_set_up_file_that_cannot_be_is_refused_with_every_reason() {
    let (cameras, layout) = (ring(3), body_25b());
    let (found, _) = set_up(&cameras, &layout, record(&cameras, &layout, 12, 1.0)).unwrap();
    let text = found.to_toml().unwrap();
    assert_eq!(Setup::from_toml("setup.toml", &text).unwrap(), found);
    let wrong = text.replace("model_error_m = ", "model_error_m = -").replace("body = \"H32\"", "body = \"CF28\"");
    let error = Setup::from_toml("setup.toml", &wrong).unwrap_err();
    assert!(error.to_string().starts_with("2 problems in setup.toml:"), "{error}");
    assert!(Setup::from_toml("setup.toml", &format!("colour = 1\n{text}")).is_err());
    let (before, after) = text.split_once("forearm = ").unwrap();
    let rest = after.split_once('\n').unwrap().1;
    let [not_finite, too_long] = ["a number that is not finite", "a length of more than 1000000 m"];
    for (size, problem) in [("nan", not_finite), ("inf", not_finite), ("1.7e308", too_long)] {
        let error = Setup::from_toml("setup.toml", &format!("{before}forearm = {size}\n{rest}")).unwrap_err();
        assert_eq!(error.to_string(), format!("setup.toml: proportions hold {problem}"));
        assert_eq!(sinew_words::exit_code(&error.into()), 2);
    }
}
