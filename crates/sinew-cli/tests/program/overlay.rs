//! `sinew overlay` and `sinew fit-shape` after `sinew track`, and what `sinew inspect` says of masks.

use crate::common::{QUICK, Trial, files};
use sinew::formats::{calib_toml, picture, trc};
use std::fs;

fn ran(trial: &Trial, arguments: &[&str]) -> String {
    let output = trial.run(arguments);
    let printed = trial.printed(&output);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {printed}");
    String::from_utf8_lossy(&output.stdout).replace(&trial.folder.path().display().to_string(), "[trial]")
}

/// A recording `rec`, tracked by its keypoints into `out`.
fn tracked() -> Trial {
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    let small = ["--duration=0.4", "--size=160x120", "--segmentation=clean", "--images=5", "--no-progress"];
    ran(&trial, &[&["simulate", "-orec"], &small[..]].concat());
    let input = ["--calibration=rec/Calib.toml", "--keypoints=rec/keypoints", "--layout=BODY_25B", "--fps=30"];
    ran(&trial, &[&["track", "-oout", "--no-progress"], &input[..], &QUICK].concat());
    trial
}

const WITH: [&str; 3] = ["out", "--calibration=rec/Calib.toml", "--no-progress"];

#[test]
fn bodies_are_drawn_where_cameras_see_them() {
    let trial = tracked();
    let drawn = ran(&trial, &[&["overlay", "-oblack"], &WITH[..], &["--frames=2..9", "--every=3"]].concat());
    assert_eq!(drawn, "12 pictures in black\n");
    let pictures = files(&trial.path("black"));
    assert_eq!(pictures.keys().filter(|name| name.ends_with(".png")).count(), 12);
    let cameras = fs::read_to_string(trial.path("rec/Calib.toml")).unwrap();
    let cameras = calib_toml::read("Calib.toml", &cameras).unwrap().cameras;
    let markers = fs::read_to_string(trial.path("out/markers.trc")).unwrap();
    let markers = trc::read("markers.trc", &markers).unwrap();
    let knee = markers.point_in_world(5, markers.marker_index("LKnee").unwrap()).unwrap();
    for camera in &cameras {
        let image = picture::read("a", &pictures[&format!("{}_000005.png", camera.name)]).unwrap();
        assert_eq!([image.width, image.height], [160, 120]);
        let [u, v] = camera.project(knee).pixel().unwrap();
        // Offsets of the set-up may move it by a pixel.
        let near = |dx: i64, dy: i64| image.pixels[(v as i64 + dy) as usize * 160 + (u as i64 + dx) as usize];
        let is_left = |[red, _, blue]: [u8; 3]| red > 100 && blue < 100;
        assert!((-2..3).any(|dx| (-2..3).any(|dy| is_left(near(dx, dy)))), "{}", camera.name);
    }
    assert_eq!(
        ran(&trial, &[&["overlay", "-oimages", "--images=rec/images"], &WITH[..]].concat()),
        "12 pictures in images; 36 views have no image and were left out\n"
    );
    assert_eq!(
        ran(&trial, &[&["overlay", "-omasks", "--silhouettes=rec/masks"], &WITH[..]].concat()),
        "48 pictures in masks\n"
    );
    let refused = |more: &[&str]| trial.printed(&trial.run(&[&["overlay"], more].concat()));
    insta::assert_snapshot!("frames", refused(&[&WITH[..], &["-oa", "--frames=50..60"]].concat()));
    insta::assert_snapshot!("no_results", refused(&["rec", "--calibration=rec/Calib.toml", "-oa"]));
    insta::assert_snapshot!("no_folder", refused(&WITH));
    insta::assert_snapshot!("into_results", refused(&[&WITH[..], &["-oout"]].concat()));
    insta::assert_snapshot!(
        "no_image",
        refused(&[&WITH[..], &["-oa", "--images=rec/images", "--frames=1..4"]].concat())
    );
}

/// The fitted body is read by tracking, and covers the masks better.
#[test]
fn a_fitted_body_is_tracked() {
    let trial = tracked();
    let fitted = ran(&trial, &[&["fit-shape", "-obody.toml", "--silhouettes=rec/masks", "--json"], &WITH[..]].concat());
    let fitted: serde_json::Value = serde_json::from_str(&fitted).unwrap();
    let share = |key: &str| fitted[key].as_f64().unwrap();
    assert!(share("mismatch_after") < 0.9 * share("mismatch_before"), "{fitted}");
    assert!(fitted["masks"] == 48 && fitted["scales"].as_array().unwrap().len() == 8);
    assert!(ran(&trial, &["body", "body.toml"]).contains("l_upper_arm  0."));
    assert!(ran(&trial, &["inspect", "body.toml"]).contains("solids"));
    let masks = ["--calibration=rec/Calib.toml", "--silhouettes=rec/masks", "--init=rec/truth.trc", "--fps=30"];
    let small = ["--method=annealed", "--particles=16", "--layers=2", "--raster=64", "--body=body.toml", "-oagain"];
    ran(&trial, &[&["track", "--no-progress"], &masks[..], &small].concat());
    let setup = fs::read_to_string(trial.path("again/setup.toml")).unwrap();
    assert!(setup.contains("[[solid]]"));
    let refused = |more: &[&str]| trial.printed(&trial.run(&[&["fit-shape"], &WITH[..], more].concat()));
    insta::assert_snapshot!("body_is_there", refused(&["-obody.toml", "--silhouettes=rec/masks"]));
    insta::assert_snapshot!("masks_of_nobody", {
        for (name, _) in files(&trial.path("rec/masks")) {
            let mut bytes = Vec::new();
            sinew::formats::mask::write(&mut bytes, &sinew::observe::silhouettes::bit_image::BitImage::new(160, 120))
                .unwrap();
            fs::write(trial.path("rec/masks").join(name), bytes).unwrap();
        }
        refused(&["-oother.toml", "--silhouettes=rec/masks", "-q"])
    });
}

#[test]
fn folders_of_masks_and_images_are_distinguished() {
    let trial = tracked();
    fs::remove_file(trial.path("rec/masks/C2_0004.png")).unwrap();
    let text = ran(&trial, &["inspect", "rec/masks", "rec/images"]);
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines[0].contains("masks of 4 cameras"), "{text}");
    assert!(text.contains("11 files, frames 0..12, 160x120 pixels, person "), "{text}");
    assert!(text.contains("C2: 1 frames between the first and the last have no mask"), "{text}");
    assert!(text.contains("images of 4 cameras") && text.contains("3 files, frames 0..11, 160x120 pixels\n"), "{text}");
}
