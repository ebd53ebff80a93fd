//! The real recording: set-up from frames 0–59, judged on frames 60–99. Skipped where the shared data are missing.

use sinew::config::settings::Settings;
use sinew::formats::trc;
use sinew::input::recording::{Recording, RecordingOptions};
use sinew::observe::association::Person;
use sinew_tests::data::shared;
use sinew_tests::evaluation::{self, LIMB_JOINTS, LeftOut, Track};
use std::path::{Path, PathBuf};

const RATE_HZ: f64 = 60.0;

fn data() -> Option<PathBuf> {
    shared("pose2sim_single")
}

fn open(data: &Path, folder: &str, cameras: Option<Vec<String>>) -> Recording {
    let options = RecordingOptions { layout: Some("BODY_25B".into()), cameras, ..RecordingOptions::default() };
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

/// What the person shows in each frame and camera.
fn sightings(data: &Path) -> Vec<Vec<Person>> {
    let mut whole = open(data, "pose-associated", None);
    let first = |people: Vec<Vec<Person>>| people.into_iter().map(|p| p.into_iter().next().unwrap_or_default());
    (0..100).map(|f| first(whole.people(f).unwrap()).collect()).collect()
}

/// Median and 90th percentile, pixels, of raw triangulation, zero-phase filter, `hmc` and `hmc --smooth` from the cameras `used` in the others, the mean over these.
fn pixels_elsewhere(data: &Path, seen: &[Vec<Person>], used: &[usize]) -> [[f64; 2]; 4] {
    let whole = open(data, "pose-associated", None);
    let (cameras, layout) = (whole.cameras().to_vec(), whole.layout().clone());
    let names = used.iter().map(|&c| cameras[c].name.clone()).collect();
    let mut recording = open(data, "pose-associated", Some(names));
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
    let others: Vec<usize> = (0..cameras.len()).filter(|c| !used.contains(c)).collect();
    tracks.map(|track| {
        let errors = others.iter().map(|&other| {
            let keypoints = seen.iter().map(|frame| &frame[other]).collect();
            let left_out = LeftOut { camera: &cameras[other], keypoints, least_confidence: 0.3 };
            evaluation::pixel_errors(&left_out, &layout, &track, &LIMB_JOINTS, 0..60, 60..100)
        });
        let n = others.len() as f64;
        errors.fold([0.0; 2], |[a, b], e| [a + e.median / n, b + e.p90 / n])
    })
}

fn mean(of: &[[[f64; 2]; 4]]) -> [[f64; 2]; 4] {
    let one = |contender: usize, i: usize| of.iter().map(|e| e[contender][i]).sum::<f64>() / of.len() as f64;
    [0, 1, 2, 3].map(|contender| [0, 1].map(|i| one(contender, i)))
}

#[test]
fn hmc_predicts_a_camera_left_out_better_than_triangulation() {
    let Some(data) = data() else { return };
    let seen = sightings(&data);
    let found: Vec<_> =
        [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]].iter().map(|used| pixels_elsewhere(&data, &seen, used)).collect();
    let errors = mean(&found);
    println!("three cameras: raw, zero-phase, hmc, hmc --smooth (median, 90 %): {errors:.1?}");
    let [raw, zero_phase, hmc, smooth] = errors;
    for i in 0..2 {
        assert!(hmc[i] < raw[i], "{errors:?}");
        assert!(smooth[i] < zero_phase[i], "{errors:?}");
    }
    assert!(smooth[0] <= 14.5, "{errors:?}");
}

/// Opposite and neighbouring cameras; all six pairs are measured by `cargo xtask study accuracy`.
#[test]
fn two_cameras_leave_hmc_far_fewer_gross_errors_than_triangulation() {
    let Some(data) = data() else { return };
    let seen = sightings(&data);
    let found: Vec<_> = [[0, 1], [1, 3], [2, 3]].iter().map(|used| pixels_elsewhere(&data, &seen, used)).collect();
    let errors = mean(&found);
    println!("two cameras: raw, zero-phase, hmc, hmc --smooth (median, 90 %): {errors:.1?}");
    let [raw, zero_phase, hmc, smooth] = errors;
    assert!(hmc[0] < raw[0] && smooth[0] < zero_phase[0], "{errors:?}");
    assert!(hmc[1] < 0.85 * raw[1] && smooth[1] < 0.85 * zero_phase[1], "{errors:?}");
}

#[test]
fn with_one_camera_error_and_intervals_grow_together() {
    let Some(data) = data() else { return };
    let reference = reference(&data);
    let run = |cameras: &[&str]| {
        let names = cameras.iter().map(|name| (*name).into()).collect();
        let mut recording = open(&data, "pose-associated", Some(names));
        let run = evaluation::run(&mut recording, 0..60, 0..100, &settings(), None).unwrap();
        let track = evaluation::positions(&run.tree, &run.filtered, &LIMB_JOINTS);
        let spread = evaluation::mean_spread(&run.tree, &run.filtered[60..100], &LIMB_JOINTS);
        [evaluation::mean_distance(&track, &reference, 60..100), spread]
    };
    let whole = open(&data, "pose-associated", None);
    let names: Vec<&str> = whole.cameras().iter().map(|camera| camera.name.as_str()).collect();
    let (all, one) = (run(&names), run(&names[..1]));
    println!("four cameras and one: distance from the reference and spread, m: {all:.3?} {one:.3?}");
    assert!(one[0] > 3.0 * all[0] && one[1] > 3.0 * all[1], "{all:?} {one:?}");
    // The expected distance of one draw from another place is about the spread.
    assert!((0.5..2.0).contains(&(one[1] / one[0])), "{one:?}");
}
