//! The demo's walker, tracked: `docs/images/demo.svg`.
//!
//! The recording of `sinew demo` is tracked with the program's settings. Above, one camera's view at three instants: keypoints, draws from the posterior, the pose of the mean state and the true joints. Below, the knee's flexion over time with its 90 % band.

use crate::support::outcome::Outcome;
use sinew::body::{KinematicTree, Plan, point_positions};
use sinew::config::settings::Settings;
use sinew::core::lanes::Isa;
use sinew::input::source::FrameSource as _;
use sinew::observe::Camera;
use sinew::setup::Setup;
use sinew_results::estimate::FrameEstimate;
use sinew_simulate::recording::{Script, SyntheticRecording};
use sinew_tests::evaluation::{self, Filtered};
use sinew_tests::simulated_source::source;
use std::fmt::Write as _;

/// The demo's seed.
const SEED: u64 = 1;

/// Camera whose view is shown.
const CAMERA: usize = 1;

/// Frames shown.
const INSTANTS: [usize; 3] = [15, 64, 105];

/// Draws shown of each.
const DRAWS: usize = 40;

/// Degree of freedom in the chart.
const KNEE: &str = "r_shin.rx";

const BONES: [[&str; 2]; 18] = [
    ["Head", "Neck"],
    ["Neck", "MidHip"],
    ["LShoulder", "RShoulder"],
    ["RShoulder", "RElbow"],
    ["RElbow", "RWrist"],
    ["LShoulder", "LElbow"],
    ["LElbow", "LWrist"],
    ["LHip", "RHip"],
    ["RHip", "RKnee"],
    ["RKnee", "RAnkle"],
    ["RAnkle", "RHeel"],
    ["RHeel", "RBigToe"],
    ["RAnkle", "RBigToe"],
    ["LHip", "LKnee"],
    ["LKnee", "LAnkle"],
    ["LAnkle", "LHeel"],
    ["LHeel", "LBigToe"],
    ["LAnkle", "LBigToe"],
];

const WIDTH: f64 = 960.0;
const PANEL_WIDTH: f64 = 304.0;
const PANEL_TOP: f64 = 58.0;
const PANEL_HEIGHT: f64 = 360.0;
const CHART: [f64; 4] = [64.0, 474.0, 880.0, 150.0];
const HEIGHT: f64 = 664.0;

const STYLE: &str = "text{font-family:system-ui,sans-serif;font-size:13px;fill:#3c4654}.h{font-size:15px;font-weight:600;fill:#17202c}\
.d{fill:none;stroke:#2a7fc1;stroke-width:1.5;stroke-opacity:.24;stroke-linecap:round;stroke-linejoin:round}\
.m{fill:none;stroke:#0b3c66;stroke-width:1.3;stroke-linecap:round;stroke-linejoin:round}\
.t{fill:#e4741b;stroke:#fff;stroke-width:.7}.k{fill:none;stroke:#7d8896;stroke-width:1.1}\
.b{fill:#2a7fc1;fill-opacity:.28}.u{fill:none;stroke:#e4741b;stroke-width:1.6;stroke-dasharray:4 3}\
.g{fill:none;stroke:#d5dbe2;stroke-width:1}.p{fill:#f5f7f9}";

/// A tracked recording.
struct Tracked {
    recording: SyntheticRecording,
    setup: Setup,
    tree: KinematicTree,
    estimates: Vec<FrameEstimate>,
}

/// The picture as SVG.
pub(super) fn svg() -> Outcome<String> {
    draw(&track()?)
}

fn track() -> Outcome<Tracked> {
    let script = Script::default();
    let recording = SyntheticRecording::new(&script, SEED)?;
    let mut frames_of = source(&recording);
    let frames = frames_of.frames();
    // One instruction set, so that every machine draws the same picture.
    let settings = Settings { fps: script.rate_hz, seed: SEED, isa: Isa::baseline(), ..Settings::default() };
    let setup = evaluation::set_up(&mut frames_of, frames.clone(), &settings, |_| ())?;
    let Filtered { tree, estimates, .. } = evaluation::filter(&mut frames_of, &setup, frames, &settings)?;
    Ok(Tracked { recording, setup, tree, estimates })
}

fn draw(tracked: &Tracked) -> Outcome<String> {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" role=\"img\" aria-label=\"A tracked walker and the flexion of a knee, with uncertainty\">\n\
         <style>{STYLE}</style>\n<rect width=\"{WIDTH}\" height=\"{HEIGHT}\" rx=\"8\" fill=\"#fff\"/>\n"
    );
    let camera = tracked.recording.cameras.get(CAMERA).ok_or("no such camera")?;
    writeln!(svg, "<text class=\"h\" x=\"16\" y=\"26\">The demo's walker, seen by camera {}</text>", camera.name)?;
    let legend = [
        (370.0, "<path class=\"k\" d=\"M-4-4 4 4M-4 4 4-4\"/>", "keypoint"),
        (
            470.0,
            "<path class=\"d\" style=\"stroke-opacity:.5\" d=\"M-8-3H8M-8 0H8M-8 3H8\"/>",
            "draws from the posterior",
        ),
        (662.0, "<path class=\"m\" d=\"M-8 0H8\"/>", "pose of the mean"),
        (806.0, "<circle class=\"t\" r=\"3.4\"/>", "true joint"),
    ];
    for (x, sign, text) in legend {
        writeln!(svg, "<g transform=\"translate({x} 21)\">{sign}<text x=\"14\" y=\"4.5\">{text}</text></g>")?;
    }
    let scale = scale(tracked, camera);
    for (i, frame) in INSTANTS.into_iter().enumerate() {
        panel(&mut svg, tracked, camera, frame, 16.0 + i as f64 * (PANEL_WIDTH + 8.0), scale)?;
    }
    chart(&mut svg, tracked)?;
    svg.push_str("</svg>\n");
    Ok(svg)
}

/// Position in the image, freed of the lens.
fn project(camera: &Camera, point: [f64; 3]) -> Option<[f64; 2]> {
    camera.project(point).pixel()
}

/// Panel units per pixel: the body fills the panel in the instant in which it is largest.
fn scale(tracked: &Tracked, camera: &Camera) -> f64 {
    let height = |frame: usize| {
        let rows = tracked.recording.truth.frames[frame].iter().filter_map(|&point| project(camera, point));
        let (low, high) = rows.fold((f64::MAX, f64::MIN), |(low, high), [_, v]| (low.min(v), high.max(v)));
        high - low
    };
    (PANEL_HEIGHT - 60.0) / INSTANTS.into_iter().map(height).fold(0.0, f64::max)
}

fn panel(svg: &mut String, tracked: &Tracked, camera: &Camera, frame: usize, left: f64, scale: f64) -> Outcome<()> {
    let Tracked { recording, setup, tree, estimates } = tracked;
    let estimate = estimates.get(frame).ok_or("no such frame")?;
    let truth = &recording.truth.frames[frame];
    let seen: Vec<[f64; 2]> = truth.iter().filter_map(|&point| project(camera, point)).collect();
    let middle = |k: usize| {
        let (low, high) = seen.iter().fold((f64::MAX, f64::MIN), |(low, high), p| (low.min(p[k]), high.max(p[k])));
        (low + high) / 2.0
    };
    let centre = [middle(0), middle(1)];
    let place = |pixel: [f64; 2]| {
        [(pixel[0] - centre[0]) * scale + PANEL_WIDTH / 2.0, (pixel[1] - centre[1]) * scale + PANEL_HEIGHT / 2.0 + 8.0]
    };
    writeln!(
        svg,
        "<svg x=\"{left}\" y=\"{PANEL_TOP}\" width=\"{PANEL_WIDTH}\" height=\"{PANEL_HEIGHT}\"><rect class=\"p\" width=\"100%\" height=\"100%\" rx=\"6\"/>\
         <text x=\"12\" y=\"22\">{:.1} s</text>",
        estimate.time_s
    )?;
    for state in estimate.draws.states.chunks_exact(tree.dof()).take(DRAWS) {
        writeln!(svg, "<path class=\"d\" d=\"{}\"/>", figure(tree, state, |point| project(camera, point).map(place)))?;
    }
    let mean = figure(tree, &estimate.mean_state, |point| project(camera, point).map(place));
    writeln!(svg, "<path class=\"m\" d=\"{mean}\"/>")?;
    let offset = setup.camera.iter().find(|known| known.name == camera.name).map_or([0.0; 2], |known| known.offset_px);
    let mut crosses = String::new();
    for keypoint in recording.keypoints[CAMERA][frame].iter().flatten() {
        let [x, y] = place([keypoint.x - offset[0], keypoint.y - offset[1]]);
        if (4.0..PANEL_WIDTH - 4.0).contains(&x) && (4.0..PANEL_HEIGHT - 4.0).contains(&y) {
            write!(crosses, "M{:.1} {:.1}l6 6m-6 0l6-6", x - 3.0, y - 3.0)?;
        }
    }
    writeln!(svg, "<path class=\"k\" d=\"{crosses}\"/>")?;
    for name in sinew::body::standard::EVALUATION_JOINTS {
        let joint = recording.truth.index(name).map(|index| truth[index]);
        if let Some([x, y]) = joint.and_then(|joint| project(camera, joint)).map(place) {
            writeln!(svg, "<circle class=\"t\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.2\"/>")?;
        }
    }
    svg.push_str("</svg>\n");
    Ok(())
}

/// Path data of the stick figure in a state.
fn figure(tree: &KinematicTree, state: &[f64], place: impl Fn([f64; 3]) -> Option<[f64; 2]>) -> String {
    let plan = Plan::with_all_points(tree);
    let mut points = vec![0.0; 3 * tree.points().len()];
    point_positions(&plan, Isa::baseline(), state, &mut points);
    let at = |name: &str| {
        let i = 3 * tree.point_index(name)?;
        place([points[i], points[i + 1], points[i + 2]])
    };
    let mut path = String::new();
    for [from, to] in BONES {
        if let (Some([x, y]), Some([u, v])) = (at(from), at(to)) {
            // Writing to a String cannot fail.
            let _ = write!(path, "M{x:.1} {y:.1}L{u:.1} {v:.1}");
        }
    }
    path
}

/// The knee over time.
fn chart(svg: &mut String, tracked: &Tracked) -> Outcome<()> {
    let [left, top, width, height] = CHART;
    let Tracked { recording, tree, estimates, .. } = tracked;
    let index = |tree: &KinematicTree| tree.dof_names().iter().position(|name| name == KNEE).ok_or("no knee");
    let (knee, true_knee) = (index(tree)?, index(&recording.body)?);
    let duration = estimates.len() as f64 / recording.rate_hz;
    // Flexion is a negative rotation about the axis to the right.
    let flexion = |angle: f64| -angle.to_degrees();
    let (low, high) = (-5.0, 75.0);
    let x = |time: f64| left + width * time / duration;
    let y = |degrees: f64| top + height * (high - degrees) / (high - low);
    writeln!(
        svg,
        "<text class=\"h\" x=\"16\" y=\"448\">Flexion of the right knee</text><g transform=\"translate(370 443)\"><rect class=\"b\" x=\"-8\" y=\"-5\" width=\"16\" height=\"10\"/><text x=\"14\" y=\"4.5\">90 % interval</text></g>\
         <g transform=\"translate(494 443)\"><path class=\"m\" d=\"M-8 0H8\"/><text x=\"14\" y=\"4.5\">mean</text></g><g transform=\"translate(568 443)\"><path class=\"u\" d=\"M-10 0H10\"/><text x=\"16\" y=\"4.5\">truth</text></g>"
    )?;
    for degrees in [0.0, 30.0, 60.0] {
        let row = y(degrees);
        writeln!(
            svg,
            "<path class=\"g\" d=\"M{left} {row:.1}h{width}\"/><text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{degrees}°</text>",
            left - 8.0,
            row + 4.5
        )?;
    }
    for second in 0..=duration as u32 {
        let column = x(f64::from(second));
        writeln!(
            svg,
            "<text x=\"{column:.1}\" y=\"{}\" text-anchor=\"middle\">{second} s</text>",
            top + height + 18.0
        )?;
    }
    for frame in INSTANTS {
        let column = x(frame as f64 / recording.rate_hz);
        writeln!(svg, "<path class=\"g\" stroke-dasharray=\"2 3\" d=\"M{column:.1} {top}v{height}\"/>")?;
    }
    let line = |values: &mut dyn Iterator<Item = (f64, f64)>| {
        let points: Vec<String> =
            values.map(|(time, angle)| format!("{:.1} {:.1}", x(time), y(flexion(angle)))).collect();
        points.join("L")
    };
    let upper = line(&mut estimates.iter().map(|e| (e.time_s, e.state[knee].q05)));
    let lower = line(&mut estimates.iter().rev().map(|e| (e.time_s, e.state[knee].q95)));
    let mean = line(&mut estimates.iter().map(|e| (e.time_s, e.state[knee].mean)));
    let truth = line(&mut recording.states.iter().zip(estimates).map(|(state, e)| (e.time_s, state[true_knee])));
    writeln!(
        svg,
        "<path class=\"b\" d=\"M{upper}L{lower}Z\"/><path class=\"m\" d=\"M{mean}\"/><path class=\"u\" d=\"M{truth}\"/>"
    )?;
    Ok(())
}
