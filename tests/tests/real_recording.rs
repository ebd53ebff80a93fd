//! The real recording: set-up from frames 0–59, judged on frames 60–99. Skipped where the shared data are missing.

use sinew::evaluation::{self, LIMB_JOINTS, LeftOut, Track};
use sinew::formats::trc;
use sinew::observe::association::Person;
use sinew::pipeline::{FrameSource as _, Settings};
use sinew::recording::{Options, Recording};
use std::path::{Path, PathBuf};

const RATE_HZ: f64 = 60.0;

fn data() -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let folder = std::env::var_os("SINEW_DATA").map_or_else(beside, PathBuf::from).join("pose2sim_single");
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: no data");
    None
}

fn open(data: &Path, folder: &str, cameras: Option<Vec<String>>) -> Recording {
    let options = Options { layout: Some("BODY_25B".into()), cameras, ..Options::default() };
    Recording::open(&data.join("Calib.toml"), &data.join("T01_BalancingTrial").join(folder), &options).unwrap()
}

fn reference(data: &Path) -> Track {
    let name = "S00_P00_T01_BalancingTrial_0-100_filt_butterworth.trc";
    let text = std::fs::read_to_string(data.join("T01_BalancingTrial/pose-3d").join(name)).unwrap();
    let file = trc::read(name, &text).unwrap();
    let frame = |f| LIMB_JOINTS.iter().map(|joint| file.point_in_world(f, file.marker_index(joint)?)).collect();
    (0..file.frames.len()).map(frame).collect()
}

fn settings() -> Settings {
    Settings { fps: RATE_HZ, ..Settings::default() }
}

#[test]
fn hmc_is_within_35_mm_of_the_reference_with_and_without_bystanders() {
    let Some(data) = data() else { return };
    let reference = reference(&data);
    for folder in ["pose", "pose-associated"] {
        let run = evaluation::run(&mut open(&data, folder, None), 0..60, 0..100, &settings(), None).unwrap();
        let track = evaluation::positions(&run.tree, &run.filtered, &LIMB_JOINTS);
        let millimetres = 1e3 * evaluation::mean_distance(&track, &reference, 60..100);
        println!("{folder}: {millimetres:.1} mm");
        assert!(millimetres <= 35.0, "{folder}: {millimetres} mm");
    }
}

/// Two of the four cameras are left out in turn, so that the test stays short; `cargo xtask accuracy` measures all.
#[test]
fn hmc_predicts_a_camera_left_out_better_than_triangulation() {
    let Some(data) = data() else { return };
    let mut whole = open(&data, "pose-associated", None);
    let (cameras, layout) = (whole.cameras().to_vec(), whole.layout().clone());
    let seen: Vec<Vec<Person>> = (0..100)
        .map(|f| whole.people(f).unwrap().into_iter().map(|p| p.into_iter().next().unwrap_or_default()).collect())
        .collect();
    let mut sums = [[0.0; 2]; 4];
    for left in [0, 2] {
        let used: Vec<usize> = (0..4).filter(|c| *c != left).collect();
        let names = used.iter().map(|&c| cameras[c].name.clone()).collect();
        let mut recording = open(&data, "pose-associated", Some(names));
        let run = evaluation::run(&mut recording, 0..60, 0..100, &settings(), None).unwrap();
        let chosen: Vec<_> = used.iter().map(|&c| cameras[c].clone()).collect();
        let views: Vec<Vec<Person>> = seen.iter().map(|f| used.iter().map(|&c| f[c].clone()).collect()).collect();
        let points = evaluation::triangulated(&chosen, &layout, &views, &LIMB_JOINTS);
        let tracks = [
            evaluation::filled(&points),
            evaluation::zero_phase(&points, RATE_HZ, 6.0),
            evaluation::positions(&run.tree, &run.filtered, &LIMB_JOINTS),
            evaluation::positions(&run.tree, &run.smoothed, &LIMB_JOINTS),
        ];
        let keypoints = seen.iter().map(|frame| &frame[left]).collect();
        let left_out = LeftOut { camera: &cameras[left], keypoints, least_confidence: 0.3 };
        for (sum, track) in sums.iter_mut().zip(&tracks) {
            let e = evaluation::pixel_errors(&left_out, &layout, track, &LIMB_JOINTS, 0..60, 60..100);
            sum[0] += 0.5 * e.median;
            sum[1] += 0.5 * e.p90;
        }
    }
    println!("raw, zero-phase, hmc, hmc --smooth (median, 90 %): {sums:.1?}");
    let [raw, zero_phase, hmc, smooth] = sums;
    for i in 0..2 {
        assert!(hmc[i] < raw[i], "{sums:?}");
        assert!(smooth[i] < zero_phase[i], "{sums:?}");
    }
}
