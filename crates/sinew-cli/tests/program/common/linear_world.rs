//! A recording in which all is known: every pixel is a linear function of the state, and its error is Gaussian.
//!
//! A body of three translations and one turn about z stands before two cameras that are 10⁷ m away: `A` looks along y and sees x and z, `B` looks along −x and sees y and z. Two of its points are 50 m from the axis of the turn, which is
//! seen to a milliradian: what is not linear is a thousandth of the errors.

use super::path_posterior::{DIM, PathPosterior, Row, Walk, inverse};
use super::{Trial, column};
use std::f64::consts::PI;
use std::fmt::Write as _;
use std::fs;
use std::process::Output;

pub const FPS: f64 = 30.0;
const DISTANCE_M: f64 = 1e7;
/// Pixels for a metre.
pub const SCALE: f64 = 100.0;
const CENTRE_PX: f64 = 10_000.0;
/// Usual confidence.
const USUAL: f64 = 0.9;
const MODEL_ERROR_M: f64 = 0.005;
/// Spread of the first state about the set-up's, of translations and turns.
const START_SD: [f64; DIM] = [0.05, 0.05, 0.05, 0.12];

pub const CAMERAS: [&str; 2] = ["A", "B"];

/// Name, whether it turns, place at zero.
pub const POINTS: [(&str, bool, [f64; 3]); 6] = [
    ("LHip", false, [0.0, 0.1, -0.2]),
    ("RHip", false, [0.0, -0.1, -0.2]),
    ("LShoulder", true, [50.0, 0.3, 0.4]),
    ("RShoulder", true, [0.2, -0.3, 0.4]),
    ("LKnee", false, [0.1, 0.2, -0.9]),
    ("RKnee", true, [-50.0, 0.0, -0.9]),
];

/// Random numbers that are no one else's.
pub struct Numbers(u64);

impl Numbers {
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn normal(&mut self) -> f64 {
        let (radius, angle) = (-2.0 * (1.0 - self.uniform()).ln(), 2.0 * PI * self.uniform());
        radius.sqrt() * angle.cos()
    }
}

/// How the numbers of the state move a coordinate of a point, where the body turns and where it only translates.
fn by_state(turns: bool, point: usize, axis: usize) -> [f64; DIM] {
    let (_, on_arm, [x, y, _]) = POINTS[point];
    let mut by = [0.0; DIM];
    by[axis] = 1.0;
    by[3] = if turns && on_arm { [-y, x, 0.0][axis] } else { 0.0 };
    by
}

/// Pixels by metres of the coordinate that a camera's image axis shows, and the coordinate.
fn shown(camera: usize, image_axis: usize) -> (f64, usize) {
    if image_axis == 1 { (-SCALE, 2) } else { (SCALE, camera) }
}

/// What is constant: in units of its name, the value that the set-up states and draws of the truth less that.
#[derive(Clone, Debug)]
pub struct Constant {
    pub name: String,
    pub value: f64,
    pub draws: Vec<f64>,
}

/// What a world is made with.
#[derive(Clone, Debug)]
pub struct Script {
    pub seed: u64,
    pub frames: usize,
    /// Of a detection of usual confidence.
    pub sigma_px: f64,
    /// Of a step: metres, radians.
    pub step_sd: [f64; 2],
    /// Whether the body has a turn; without it, the fourth number of the state moves nothing.
    pub turns: bool,
    /// Whether people, cameras and points are missing and confidences differ.
    pub has_gaps: bool,
    /// What is constant, and the scales of its prior by name; none: a set-up that knows of no such errors.
    pub lasting: Vec<Constant>,
    pub scales: Vec<(&'static str, f64)>,
    /// Time in which errors are forgotten, seconds.
    pub persistence_s: f64,
}

impl Default for Script {
    fn default() -> Self {
        Self {
            seed: 1,
            frames: 10,
            sigma_px: 2.0,
            step_sd: [0.02, 4e-4],
            turns: true,
            has_gaps: true,
            lasting: vec![],
            scales: vec![],
            persistence_s: 0.0,
        }
    }
}

/// The recording.
pub struct World {
    pub script: Script,
    pub walk: Walk,
    /// What was observed, the stated values of constants taken off.
    pub rows: Vec<Row>,
    /// Detections: frame, camera, point; pixel and confidence.
    seen: Vec<Vec<Vec<[f64; 3]>>>,
}

impl World {
    pub fn new(script: Script) -> Self {
        let mut numbers = Numbers::new(script.seed);
        let [metres, radians] = script.step_sd;
        let step_sd = [metres, metres, metres, radians];
        let mut state = [0.03, -0.02, 0.01, 1e-4];
        let mut walk = Walk { start: [0.0; DIM], start_sd: START_SD, step_sd };
        let (mut rows, mut seen) = (vec![], vec![]);
        for frame in 0..script.frames {
            if frame > 0 {
                state.iter_mut().zip(step_sd).for_each(|(x, sd)| *x += sd * numbers.normal());
            }
            let mut cameras = vec![];
            for camera in 0..CAMERAS.len() {
                let is_there = |point: usize| !script.has_gaps || is_seen(frame, camera, point);
                let mut points = vec![];
                for (point, (.., place)) in POINTS.iter().enumerate() {
                    let confidence = if script.has_gaps && (frame + point) % 4 == 3 { 0.5 * USUAL } else { USUAL };
                    let views =
                        (0..CAMERAS.len()).filter(|other| !script.has_gaps || is_seen(frame, *other, point)).count();
                    let variance = script.sigma_px.powi(2) * USUAL / confidence
                        + 2.0 / 3.0 * views as f64 * (MODEL_ERROR_M * script.sigma_px / 2.0 * SCALE).powi(2);
                    let mut pixel = [CENTRE_PX; 2];
                    for (image_axis, pixel) in pixel.iter_mut().enumerate() {
                        let (scale, axis) = shown(camera, image_axis);
                        let by_state = by_state(script.turns, point, axis).map(|by| scale * by);
                        let stated: f64 =
                            script.lasting.iter().map(|g| g.value * pixels(&g.name, [camera, point, image_axis])).sum();
                        let at: f64 = by_state.iter().zip(state).map(|(by, x)| by * x).sum();
                        let value = at + variance.sqrt() * numbers.normal();
                        *pixel += scale * place[axis] + stated + value;
                        let of = (camera * POINTS.len() + point) * 2 + image_axis;
                        if is_there(point) {
                            rows.push(Row { frame, of, by_state, value, variance });
                        }
                    }
                    points.push([pixel[0], pixel[1], if is_there(point) { confidence } else { 0.0 }]);
                }
                cameras.push(points);
            }
            seen.push(cameras);
        }
        walk.start = fitted(&rows, script.turns);
        Self { script, walk, rows, seen }
    }

    /// What frames up to `known` say of the states of the frames up to it.
    pub fn posterior(&self, known: usize) -> PathPosterior {
        PathPosterior::new(&self.walk, &self.rows, known.min(self.script.frames - 1))
    }

    /// How the numbers of the state move a coordinate of a point.
    pub fn by_state(&self, point: usize, axis: usize) -> [f64; DIM] {
        by_state(self.script.turns, point, axis)
    }

    /// Degrees of freedom of the body.
    pub fn dof(&self) -> usize {
        if self.script.turns { DIM } else { DIM - 1 }
    }

    /// A frame's people in a camera, as OpenPose writes them.
    fn people(&self, frame: usize, camera: usize) -> String {
        let points = &self.seen[frame][camera];
        if points.iter().all(|[_, _, confidence]| *confidence == 0.0) {
            return "{\"people\":[]}".into();
        }
        let numbers: Vec<String> = points
            .iter()
            .flat_map(|[u, v, c]| if *c > 0.0 { [*u, *v, *c] } else { [0.0; 3] })
            .map(|x| format!("{x:?}"))
            .collect();
        format!("{{\"people\":[{{\"pose_keypoints_2d\":[{}]}}]}}", numbers.join(","))
    }

    /// The line of a frame of a live run.
    pub fn line(&self, frame: usize) -> String {
        format!("{{\"frame\":{frame},\"cameras\":{{\"A\":{},\"B\":{}}}}}", self.people(frame, 0), self.people(frame, 1))
    }

    /// Writes the recording into a folder.
    pub fn write(&self) -> Trial {
        let trial = Trial { folder: tempfile::tempdir().unwrap() };
        for frame in 0..self.script.frames {
            for (camera, name) in CAMERAS.iter().enumerate() {
                let path = trial.path(&format!("pose/{name}_json/{name}.{frame:04}.json"));
                fs::create_dir_all(path.parent().unwrap()).unwrap();
                fs::write(path, self.people(frame, camera)).unwrap();
            }
        }
        let names: Vec<String> = POINTS.iter().map(|(name, ..)| format!("{name:?}")).collect();
        fs::write(trial.path("layout.toml"), format!("points = [{}]\n", names.join(", "))).unwrap();
        fs::write(trial.path("Calib.toml"), calibration()).unwrap();
        fs::write(trial.path("setup.toml"), self.setup()).unwrap();
        trial
    }

    fn setup(&self) -> String {
        let Script { sigma_px, step_sd: [metres, radians], turns, .. } = self.script;
        let model_error = MODEL_ERROR_M * sigma_px / 2.0;
        let motion: Vec<f64> =
            [metres, metres, metres, radians].iter().map(|sd| sd * FPS.sqrt()).take(self.dof()).collect();
        let mut text = format!(
            "schema = 2\nbody = '''{}'''\nlayout = \"layout.toml\"\nperson = 0\nworld_up = \"+z\"\nup_axis = \"+z\"\nmodel_error_m = {model_error:?}\n\
             start_frame = 0\nstart_pose = {:?}\nstep_size = 0.5\nleapfrog_steps = 5\nmotion_sd = {motion:?}\n[proportions]\n",
            body(turns),
            &self.walk.start[..self.dof()]
        );
        for size in [
            "spine",
            "shoulder_height",
            "shoulder_half_width",
            "hip_half_width",
            "pelvis_drop",
            "upper_arm",
            "forearm",
            "thigh",
            "shin",
        ] {
            let _ = writeln!(text, "{size} = 0.3");
        }
        for point in ["head_top", "nose", "eye", "ear", "heel", "big_toe", "small_toe"] {
            let _ = writeln!(text, "{point} = [0.0, 0.1, 0.1]");
        }
        for camera in CAMERAS {
            let _ = writeln!(
                text,
                "[[camera]]\nname = {camera:?}\noffset_px = [0.0, 0.0]\nsigma_px = {sigma_px:?}\nusual_confidence = {USUAL:?}\nexchanged = 0.0\nelsewhere = 0.0"
            );
        }
        if !self.script.lasting.is_empty() {
            text += &self.lasting();
        }
        text
    }

    /// The table of what is constant: all numbers of the format in their order, 0 where the script has none.
    fn lasting(&self) -> String {
        let Script { lasting, scales, persistence_s, .. } = &self.script;
        let points: Vec<String> = POINTS.iter().map(|(name, ..)| format!("{name:?}")).collect();
        let mut text = format!(
            "[lasting]\nversion = 5\ncameras = [\"A\", \"B\"]\npoints = [{}]\nmiddle_m = [0.0, 0.0, 0.0]\nframes = 10\nworth = 10.0\npersistence_s = {persistence_s:?}\n",
            points.join(", ")
        );
        let draws = lasting[0].draws.len();
        if scales.is_empty() {
            text += "scale = []\n";
        }
        for (name, scale) in scales {
            let _ = writeln!(text, "[[lasting.scale]]\nname = {name:?}\ndraws = {:?}", vec![*scale; draws]);
        }
        for name in names_of_constants() {
            let known = lasting.iter().find(|constant| constant.name == name);
            let (value, own) = known.map_or((0.0, vec![0.0; draws]), |known| (known.value, known.draws.clone()));
            let _ = writeln!(
                text,
                "[[lasting.number]]\nname = {name:?}\nvalue = {value:?}\nprior_sd = 1.0\ndraws = {own:?}"
            );
        }
        assert!(lasting.iter().all(|constant| names_of_constants().contains(&constant.name)));
        text
    }
}

/// The names of all constants, in the order of the format.
fn names_of_constants() -> Vec<String> {
    let mut names = vec![];
    let numbers = "rotation_x_rad rotation_y_rad rotation_z_rad translation_x_m translation_y_m translation_z_m log_focal_length principal_point_u principal_point_v k1";
    for camera in CAMERAS {
        names.extend(numbers.split(' ').map(|number| format!("{camera}.{number}")));
    }
    names.extend((0..9).map(|length| format!("body.length{length}_m")));
    for (point, ..) in POINTS {
        names.extend(["x", "y", "z"].map(|axis| format!("body.{point}.place_{axis}_m")));
    }
    for camera in CAMERAS {
        for (point, ..) in POINTS {
            names.extend(["u", "v"].map(|axis| format!("{camera}.{point}.bias_{axis}_m")));
        }
    }
    names.extend(CAMERAS.map(|camera| format!("{camera}.lag_s")));
    names
}

/// By how many pixels a unit of a constant moves what a camera shows of a point, along an image axis.
pub fn pixels(name: &str, [camera, point, image_axis]: [usize; 3]) -> f64 {
    let (scale, axis) = shown(camera, image_axis);
    let (camera, point) = (CAMERAS[camera], POINTS[point].0);
    let (u_or_v, x_y_or_z) = (["u", "v"][image_axis], ["x", "y", "z"][axis]);
    match () {
        // Biases are metres at the distance of the middle, principal points shares of the focal length.
        () if name == format!("{camera}.{point}.bias_{u_or_v}_m") => SCALE,
        () if name == format!("{camera}.principal_point_{u_or_v}") => SCALE * DISTANCE_M,
        () if name == format!("body.{point}.place_{x_y_or_z}_m") => scale,
        () => 0.0,
    }
}

/// Whether a camera shows a point in a frame of a world with gaps: nobody in two frames, one camera in another, points missing.
fn is_seen(frame: usize, camera: usize, point: usize) -> bool {
    !matches!((frame, camera, point), (4 | 5, ..) | (7, 1, _) | (2 | 8, 0, 4) | (3, 1, 2))
}

/// The least squares fit of the first frame: where a set-up starts.
fn fitted(rows: &[Row], turns: bool) -> [f64; DIM] {
    let dof = if turns { DIM } else { DIM - 1 };
    let mut normal = vec![vec![0.0; dof]; dof];
    let mut pull = vec![0.0; dof];
    for row in rows.iter().filter(|row| row.frame == 0) {
        for i in 0..dof {
            pull[i] += row.by_state[i] * row.value;
            (0..dof).for_each(|j| normal[i][j] += row.by_state[i] * row.by_state[j]);
        }
    }
    let (inverse, _) = inverse(&normal);
    let fit = |i: usize| inverse.get(i).map_or(0.0, |row| row.iter().zip(&pull).map(|(a, b)| a * b).sum());
    std::array::from_fn(fit)
}

fn body(turns: bool) -> String {
    let joints = if turns { "\"rz\"" } else { "" };
    let mut text = format!(
        "[[link]]\nname = \"trunk\"\njoints = [\"tx\", \"ty\", \"tz\"]\n[[link]]\nname = \"arm\"\nparent = \"trunk\"\njoints = [{joints}]\n"
    );
    for (name, turns, place) in POINTS {
        let link = if turns { "arm" } else { "trunk" };
        let _ = writeln!(text, "[[point]]\nname = {name:?}\nlink = {link:?}\noffset = {place:?}");
    }
    text
}

/// A third camera, `C`, looks along y as `A` does: nothing was recorded with it.
fn calibration() -> String {
    let third = 2.0 * PI / 3.0 / 3.0_f64.sqrt();
    let (along_y, along_x) = ([PI / 2.0, 0.0, 0.0], [third, third, -third]);
    let mut text = String::new();
    for (name, rotation) in [("A", along_y), ("B", along_x), ("C", along_y)] {
        let focal = SCALE * DISTANCE_M;
        let size = 2.0 * CENTRE_PX;
        let _ = writeln!(
            text,
            "[{name}]\nname = {name:?}\nsize = [{size:?}, {size:?}]\nmatrix = [[{focal:?}, 0.0, {CENTRE_PX:?}], [0.0, {focal:?}, {CENTRE_PX:?}], [0.0, 0.0, 1.0]]\n\
             distortions = [0.0, 0.0, 0.0, 0.0]\nrotation = {rotation:?}\ntranslation = [0.0, 0.0, {DISTANCE_M:?}]\nfisheye = false\n"
        );
    }
    text
}

/// What `sinew track` needs on a world.
pub const LINEAR: [&str; 10] = [
    "track",
    "--calibration=Calib.toml",
    "--layout=layout.toml",
    "--cameras=A,B",
    "--setup=setup.toml",
    "--fps=30",
    "--joint-limits=off",
    "--patience=1",
    "--max-r-hat=1e9",
    "--no-progress",
];

/// A density of keypoints that is Gaussian.
pub const GAUSSIAN: [&str; 2] = ["--noise=student-t", "--degrees=1e9"];

/// Runs `sinew track` on the files of a world.
pub fn tracked(trial: &Trial, more: &[&str]) -> Output {
    let output = trial.run(&[&LINEAR[..], &["--keypoints=pose"], more].concat());
    assert!(output.status.success(), "{}", trial.printed(&output));
    output
}

/// Numbers of a column of a file; NaN where a cell is empty.
pub fn numbers(trial: &Trial, file: &str, name: &str) -> Vec<f64> {
    let cells = column(&fs::read(trial.path(file)).unwrap(), name);
    cells.iter().map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()
}
