//! The fuzz targets and their corpus, for ordinary tests.

#[path = "../../../fuzz/src/checks.rs"]
mod checks;
#[path = "../../../fuzz/src/program_checks.rs"]
mod program_checks;

use std::path::Path;

/// A check of the fuzz targets.
pub type Check = fn(&[u8]);

/// Every fuzz target.
pub const CHECKS: [(&str, Check); 32] = [
    ("openpose", checks::openpose),
    ("live_frame", checks::live_frame),
    ("calib_toml", checks::calib_toml),
    ("calibration", checks::calibration),
    ("caliscope_xy", checks::caliscope_xy),
    ("coco_results", checks::coco_results),
    ("deeplabcut_csv", checks::deeplabcut_csv),
    ("mediapipe_json", checks::mediapipe_json),
    ("mmpose_json", checks::mmpose_json),
    ("rtmlib_json", checks::rtmlib_json),
    ("layout", checks::layout),
    ("osim_model", checks::osim_model),
    ("point_mapping", checks::point_mapping),
    ("body_toml", checks::body_toml),
    ("trc", checks::trc),
    ("c3d", checks::c3d),
    ("mot", checks::mot),
    ("bvh", checks::bvh),
    ("asf_amc", checks::asf_amc),
    ("tidy_csv", checks::tidy_csv),
    ("mask", checks::mask),
    ("picture", checks::picture),
    ("file_names", checks::file_names),
    ("settings", program_checks::settings),
    ("setup", program_checks::setup),
    ("summary", program_checks::summary),
    ("zarr_metadata", program_checks::zarr_metadata),
    ("result_tables", program_checks::result_tables),
    ("checkpoint", program_checks::checkpoint),
    ("primitive_model", program_checks::primitive_model),
    ("latent_model", program_checks::latent_model),
    ("filter_step", program_checks::filter_step),
];

/// Name and bytes of every file in the corpus of a target.
pub fn corpus(target: &str) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus").join(target);
    let mut files: Vec<_> = std::fs::read_dir(&folder)
        .unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
        .map(|entry| {
            let path = entry.unwrap().path();
            (path.display().to_string(), std::fs::read(&path).unwrap())
        })
        .collect();
    files.sort();
    files
}
