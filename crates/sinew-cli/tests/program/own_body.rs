//! `sinew track --body FILE`: the tree of the file is tracked, and its set-up repeats that without the file.

use crate::common::trial;
use sinew::body::standard::h32;
use sinew::body::{Joint, KinematicTree, Proportions};
use sinew::formats::body_toml;
use std::fs;

/// H32 without its hands' and feet's freedom: 4 degrees of freedom fewer, points as they were.
fn stiff() -> KinematicTree {
    let body = h32(&Proportions::default());
    let mut links = body.links().to_vec();
    for link in &mut links {
        if link.name.contains("foot") || link.name.contains("head") {
            link.joints.retain(|joint| *joint == Joint::Rotate(sinew::body::Axis::X));
        }
    }
    KinematicTree::new(links, body.points().to_vec()).unwrap()
}

#[test]
fn the_body_of_a_file_is_tracked() {
    let trial = trial(0.4);
    let body = stiff();
    assert!(body.dof() < 32, "{}", body.dof());
    fs::write(trial.path("mine.toml"), body_toml::write(&body, None)).unwrap();
    let printed = trial.track_printed(&["--body", "mine.toml"]);
    assert!(printed.starts_with("exit 0"), "{printed}");
    let summary = |out: &str| -> serde_json::Value {
        serde_json::from_slice(&fs::read(trial.path(out).join("summary.json")).unwrap()).unwrap()
    };
    assert_eq!(summary("out")["degrees_of_freedom"], body.dof());
    for camera in summary("out")["cameras"].as_array().unwrap() {
        assert!(camera["residual_px"].as_f64().unwrap() < 15.0, "{camera}");
    }
    let text = fs::read_to_string(trial.path("out/setup.toml")).unwrap();
    let setup = sinew::setup::Setup::from_toml("setup.toml", &text).unwrap();
    assert_eq!(setup.tree(), body);
    assert!(setup.model_error_m < 0.05, "{}", setup.model_error_m);
    assert_eq!(setup.to_toml().unwrap(), text);

    fs::remove_file(trial.path("mine.toml")).unwrap();
    let printed = trial.track_printed(&["-oagain", "--setup", "out/setup.toml"]);
    assert!(printed.starts_with("exit 0"), "{printed}");
    let joints = |out: &str| fs::read(trial.path(out).join("joints.csv")).unwrap();
    assert_eq!(joints("again"), joints("out"));
}

/// A root with its heading first, as no standard body has it.
#[test]
fn a_body_built_otherwise_finds_its_heading() {
    let trial = trial(0.3);
    let mut text = body_toml::write(&h32(&Proportions::default()), None);
    let (usual, other) =
        ("\"tx\", \"ty\", \"tz\", \"rz\", \"ry\", \"rx\"", "\"tz\", \"tx\", \"ty\", \"rz\", \"rx\", \"ry\"");
    assert!(text.contains(usual), "{text}");
    text = text.replacen(usual, other, 1);
    fs::write(trial.path("other.toml"), text).unwrap();
    let printed = trial.track_printed(&["--body", "other.toml"]);
    assert!(printed.starts_with("exit 0"), "{printed}");
    let trc = fs::read_to_string(trial.path("out/markers.trc")).unwrap();
    let trc = sinew::formats::trc::read("markers.trc", &trc).unwrap();
    let nose = trc.point_in_world(3, trc.marker_index("Nose").unwrap()).unwrap();
    assert!((1.3..1.9).contains(&nose[2]), "{nose:?}");
}

#[test]
fn a_body_that_is_none_is_refused() {
    let trial = trial(0.1);
    fs::write(trial.path("mine.toml"), "[[link]]\nname = \"a\"\njoint = [\"rz\"]\n").unwrap();
    let printed = trial.track_printed(&["--body", "mine.toml"]);
    assert!(printed.contains("mine.toml:3: unknown key `joint`; did you mean `joints`?"), "{printed}");
    let printed = trial.track_printed(&["--body", "h33"]);
    assert!(printed.starts_with("exit 2") && printed.contains("did you mean `h32`?"), "{printed}");
}
