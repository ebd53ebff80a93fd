//! The corpus of the fuzz targets, run through all readers on the stable compiler.
//! No panic, under a second a file, for whole files and for files cut at every byte.

use crate::fuzzed::{CHECKS, corpus};
use rayon::prelude::*;
use sinew::formats;
use std::path::Path;
use std::time::{Duration, Instant};

const LIMIT: Duration = Duration::from_secs(1);

#[test]
fn every_reader_survives_its_corpus() {
    for (target, check) in CHECKS {
        let files = corpus(target);
        assert!(!files.is_empty(), "{target} has no corpus");
        // The first use of a check may prepare what all uses share.
        check(&files[0].1);
        for (path, bytes) in files {
            let start = Instant::now();
            check(&bytes);
            assert!(start.elapsed() < LIMIT, "{path} takes {:?}", start.elapsed());
        }
    }
}

/// A step of the filter takes any bytes for a scene: files cut or of others say nothing about it.
#[test]
fn every_reader_survives_cut_files() {
    let targets = CHECKS.into_iter().filter(|(target, _)| *target != "filter_step");
    let files: Vec<_> =
        targets.flat_map(|(target, check)| corpus(target).into_iter().map(move |file| (check, file))).collect();
    files.into_par_iter().for_each(|(check, (path, bytes))| {
        assert!(bytes.len() < 6144, "{path} is too long to be cut everywhere");
        for end in 0..bytes.len() {
            check(&bytes[..end]);
        }
    });
}

#[test]
fn every_reader_survives_the_files_of_the_others() {
    for (target, _) in CHECKS {
        for (_, bytes) in corpus(target) {
            CHECKS.iter().filter(|(name, _)| *name != "filter_step").for_each(|(_, check)| check(&bytes));
        }
    }
}

#[test]
fn valid_files_are_read() {
    let bytes = |target: &str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus").join(target).join("valid");
        std::fs::read(path).unwrap()
    };
    let text = |target: &str| String::from_utf8(bytes(target)).unwrap();
    formats::openpose::read("valid", &text("openpose"), &formats::openpose::OpenposeOptions::default()).unwrap();
    let line = text("live_frame");
    formats::live_frame::read("valid", &line, &formats::openpose::OpenposeOptions::default()).unwrap();
    formats::calib_toml::read("valid", &text("calib_toml")).unwrap();
    assert_eq!(formats::calibration::read("valid", &text("calibration")).unwrap().cameras.len(), 1);
    assert_eq!(formats::osim_model::read("valid", &text("osim_model")).unwrap().bodies.len(), 2);
    assert_eq!(formats::point_mapping::read("valid", &text("point_mapping")).unwrap().len(), 2);
    formats::layout::read("valid", &text("layout")).unwrap();
    formats::body_toml::read("valid", &text("body_toml")).unwrap();
    formats::trc::read("valid", &text("trc")).unwrap();
    assert_eq!(formats::c3d::read("valid", &bytes("c3d")).unwrap().events.len(), 3);
    formats::mot::read("valid", &text("mot")).unwrap();
    formats::bvh::read("valid", &text("bvh")).unwrap();
    let pair = text("asf_amc");
    let (skeleton, motion) = pair.split_once("%%%\n").unwrap();
    let skeleton = formats::asf::read("valid", skeleton).unwrap();
    assert_eq!(formats::amc::read("valid", motion, &skeleton).unwrap().frames.len(), 2);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus/checkpoint/valid");
    assert_eq!(sinew::track::checkpoint::Checkpoint::decode(&std::fs::read(path).unwrap()).unwrap().done, 7);
    assert_eq!(formats::mask::read("valid", &bytes("mask")).unwrap().image.count(), 16 * 12);
    assert_eq!(formats::picture::read("valid", &bytes("picture")).unwrap().width, 37);
    formats::tidy_csv::read_numbers("valid", &text("tidy_csv")).unwrap();
    let model = sinew::dynamics::primitives::file::read("valid", &text("primitive_model")).unwrap();
    assert_eq!(model.primitives[1].feature.coordinates, [2, 1]);
    let model = sinew_latent::file::read("valid", &text("latent_model")).unwrap();
    assert_eq!(model.model.nodes.len(), 4);
}
