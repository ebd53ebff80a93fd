//! Tests of the program `sinew`, one file a subject.
//!
//! They are modules of one test program, which is linked with the whole library once.

mod angles_real;
mod bad_keypoints;
mod bad_settings;
mod bad_silhouette_runs;
mod batch;
mod bent_limbs;
mod calibrations;
mod caliscope_real;
mod checkpoint_fields;
mod clean_masks;
mod common;
mod determinism;
mod failing_disk;
mod files_of_others;
mod fixed_lag;
mod gait;
mod guide;
mod inspect_own_files;
mod killed_runs;

mod laboratory;
mod lag;
mod learn;
mod learn_latent;
mod left_out_cameras;
mod live;
mod motion_files;
mod other_detectors;
mod overlay;
mod own_body;
mod predictive_check;
mod report;
mod result_folder;
mod resume;
mod resume_latent_model;
mod resume_motion_model;
mod segment;
mod several_people;
mod simulate;
mod sync;
mod track_latent;
mod write_calibration;
mod wrong_paths;
