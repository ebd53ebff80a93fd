//! Cameras that are left out: `sinew predict` and `sinew validate`.

use crate::common::{QUICK, TRACK, Trial, trial};
use sinew::setup::Setup;
use std::fs;

/// Numbers of the columns of a table's rows that begin with some cells.
fn rows(text: &str, begin: &str) -> Vec<Vec<f64>> {
    let numbers = |line: &str| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
    text.lines().filter(|line| line.starts_with(begin)).map(numbers).collect()
}

/// The same results at twice the rate: keypoints move twice as fast, and a lag of ℓ seconds moves them twice as far, which adds 3 ℓ² f fᵀ to their covariance, f pixels a second at the rate that they were tracked at.
fn lags_count_by_the_rate(trial: &Trial, at_30: &str) {
    let summary = trial.path("out/summary.json");
    trial.edit(&summary, |text| text.replacen("\"fps\": 30.0", "\"fps\": 60.0", 1));
    let predicted = trial.run(&["predict", "out", "--calibration=Calib.toml", "--camera=C4", "-ofast.csv"]);
    assert!(predicted.status.success(), "{}", trial.printed(&predicted));
    trial.edit(&summary, |text| text.replacen("\"fps\": 60.0", "\"fps\": 30.0", 1));
    let at_60 = fs::read_to_string(trial.path("fast.csv")).unwrap();
    let text = fs::read_to_string(trial.path("out/setup.toml")).unwrap();
    let known = Setup::from_toml("setup.toml", &text).unwrap().lasting.unwrap();
    let scales = known.scale("lags_s").unwrap();
    // The mean square of Student's t with four degrees of freedom is twice its squared scale.
    let square = 2.0 * scales.iter().map(|scale| scale * scale).sum::<f64>() / scales.len() as f64;
    let mut most = 0.0_f64;
    for name in ["LWrist", "RAnkle", "Nose"] {
        let of = |text: &str, frame: usize| rows(text, &format!("{frame},C4,{name},")).remove(0);
        for frame in 1..44 {
            let (before, after) = (of(at_30, frame - 1), of(at_30, frame + 1));
            let flow = [3, 4].map(|column: usize| (after[column] - before[column]) * 15.0);
            let (slow, fast) = (of(at_30, frame), of(&at_60, frame));
            for (column, [a, b]) in [(5, [0, 0]), (6, [0, 1]), (7, [1, 1])] {
                let expected = 3.0 * square * flow[a] * flow[b];
                let found = fast[column] - slow[column];
                assert!((found - expected).abs() < 1e-3 + 1e-3 * expected.abs(), "{name} {frame}: {found} {expected}");
                most = most.max(found);
            }
        }
    }
    assert!(most > 0.1, "{most}");
}

/// A walker before four cameras of 5 px offsets: three predict what the fourth sees.
#[test]
fn a_left_out_camera_is_predicted() {
    let trial = trial(1.5);
    let tracked = trial.track(&["--cameras=C1,C2,C3"]);
    assert!(tracked.status.success(), "{}", trial.printed(&tracked));
    let predict = |camera: &str, more: &[&str]| {
        trial.run(&[&["predict", "out", "--calibration=Calib.toml", "--camera", camera], more].concat())
    };
    let predicted = predict("C4", &["-opredicted.csv"]);
    assert!(predicted.status.success(), "{}", trial.printed(&predicted));
    let text = fs::read_to_string(trial.path("predicted.csv")).unwrap();
    assert!(text.starts_with("frame,camera,keypoint,u,v,uu,uv,vv,common_uu,common_uv,common_vv\n"), "{text}");
    let noses: Vec<Vec<f64>> = (0..45).flat_map(|frame| rows(&text, &format!("{frame},C4,Nose,"))).collect();
    assert_eq!(noses.len(), 45);
    for nose in &noses {
        let [uu, uv, vv] = [nose[5], nose[6], nose[7]];
        assert!(uu > nose[8] && vv > nose[10] && uu * vv > uv * uv, "{nose:?}");
    }
    lags_count_by_the_rate(&trial, &text);
    // What it sees lies there, but for its own offset and noise.
    let seen = sinew::formats::openpose::read(
        "C4",
        &fs::read_to_string(trial.keypoints(4, 20)).unwrap(),
        &sinew::formats::openpose::OpenposeOptions::default(),
    );
    let seen = seen.unwrap().people[0].keypoints[11].unwrap();
    let hip = rows(&text, "20,C4,LHip,").remove(0);
    assert!((hip[3] - seen.x).hypot(hip[4] - seen.y) < 60.0, "{hip:?} for {seen:?}");

    let refused = |camera: &str, more: &[&str]| trial.printed(&predict(camera, more));
    assert!(refused("C4", &["-opredicted.csv"]).contains("`--force`"), "{}", refused("C4", &["-opredicted.csv"]));
    assert!(refused("C4", &[]).contains("-o predicted.csv"));
    let used = refused("C1", &["-oused.csv"]);
    assert!(used.starts_with("exit 2") && used.contains("the run, or its set-up, used camera `C1`"), "{used}");
    let unknown = refused("C9", &["-ounknown.csv"]);
    assert!(unknown.starts_with("exit 2") && unknown.contains("no camera `C9`; calibrated are: C1, C2, C3, C4"));
    fs::remove_dir_all(trial.path("out/posterior.zarr/posterior/keypoint_position")).unwrap();
    let without = refused("C4", &["-owithout.csv"]);
    assert!(without.starts_with("exit 3") && without.contains("no draws of where keypoints lie"), "{without}");
}

/// Every camera is left out in turn.
#[test]
fn a_recording_is_validated() {
    let trial = trial(1.2);
    let flags = [&["validate"], &TRACK[1..], &QUICK, &["-oworth", "--json"]].concat();
    let output = trial.run(&flags);
    assert!(output.status.success(), "{}", trial.printed(&output));
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let cameras = answer["cameras"].as_array().unwrap();
    assert_eq!(cameras.len(), 4);
    let inside = answer["inside"][2].as_f64().unwrap();
    assert!((0.7..=1.0).contains(&inside), "{answer}");
    let table = fs::read_to_string(trial.path("worth/validation.csv")).unwrap();
    assert_eq!(table.lines().filter(|line| line.contains(",all,")).count(), 4, "{table}");
    assert!(fs::read_to_string(trial.path("worth/reliability.svg")).unwrap().contains("polyline"));
    let warned = "warning: without C1: the set-up found cameras that see everything aside of the others";
    assert!(trial.printed(&output).contains(warned), "{}", trial.printed(&output));
    let circular =
        trial.run(&[&["validate"], &TRACK[1..], &["--setup=worth/without_C1/setup.toml", "-ocircle"]].concat());
    assert!(trial.printed(&circular).contains("a set-up is given"), "{}", trial.printed(&circular));
    let few = trial.run(&[&["validate"], &TRACK[1..], &QUICK, &["-ofew", "--cameras=C1,C2"]].concat());
    assert!(trial.printed(&few).contains("2 cameras; three are needed"), "{}", trial.printed(&few));
    let none = trial.run(&["validate", "--calibration=Calib.toml", "--silhouettes=pose", "-onone"]);
    assert!(trial.printed(&none).contains("no keypoints to hold a prediction against"), "{}", trial.printed(&none));
}
