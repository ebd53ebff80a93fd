#![doc = include_str!("../README.md")]
//!
//! ## Modules
//!
//! | module | format | reads | writes |
//! |---|---|---|---|
//! | [`openpose`] | OpenPose-style JSON keypoints, with [`layout`], [`frame_number`] and [`camera_name`] | yes | yes |
//! | [`calibration`] | calibrations, recognised by content: the five below | yes | yes |
//! | [`live_frame`] | frames as they come, a line of JSON each | yes | – |
//! | [`keypoint_formats`] | keypoints of whole recordings: [`caliscope_xy`], [`deeplabcut_csv`], [`mmpose_json`], [`rtmlib_json`], [`coco_results`], [`mediapipe_json`] | yes | – |
//! | [`calib_toml`] | Pose2Sim `Calib.toml` | yes | yes |
//! | [`caliscope_cameras`] | Caliscope `camera_array.toml` | yes | yes |
//! | [`anipose_cameras`] | Anipose and FreeMoCap `calibration.toml` | yes | yes |
//! | [`qualisys_cameras`] | Qualisys `.qca.txt` | yes | yes |
//! | [`opencv_cameras`] | OpenCV's YAML and XML | yes | YAML |
//! | [`trc`], [`mot`] | trajectories of points, coordinates (OpenSim) | yes | yes |
//! | [`c3d`] | points, analog channels and events of laboratories | yes | points |
//! | [`bvh`] | skeleton and joint angles (Blender) | yes | yes |
//! | [`tidy_csv`], [`point_table`] | tables with the unit in every column name | yes | yes |
//! | [`body_toml`], [`urdf`] | kinematic trees: our own files, and robots (ROS); [`body_file`] reads either | yes | ours |
//! | [`zarr`] | draws and statistics (ArviZ, xarray) | – | yes |
//! | [`asf`], [`amc`] | Acclaim skeleton and motion | yes | – |
//! | [`mask`] | silhouettes (PNG) | yes | yes |
//! | [`picture`] | colour images (PNG, JPEG) | yes | PNG |

pub mod amc;
pub mod anipose_cameras;
pub mod asf;
pub mod body_file;
pub mod body_toml;
pub mod bvh;
pub mod c3d;
pub mod calib_toml;
pub mod calibration;
pub mod caliscope_cameras;
pub mod caliscope_xy;
mod camera_checks;
pub mod camera_name;
pub mod coco_results;
mod csv_text;
pub mod deeplabcut_csv;
mod error;
pub mod frame_number;
pub mod json_text;
pub mod keypoint_formats;
pub mod keypoint_table;
pub mod layout;
mod length_unit;
pub mod limits;
pub mod live_frame;
pub mod mask;
pub mod mediapipe_json;
pub mod mmpose_json;
pub mod mot;
pub mod nearest;
mod numbers;
pub mod opencv_cameras;
mod opencv_storage;
pub mod openpose;
pub mod osim_model;
pub mod picture;
mod place;
mod png_file;
pub mod point_mapping;
pub mod point_name;
pub mod point_table;
pub mod qualisys_cameras;
pub mod rotation;
mod row_time;
pub mod rtmlib_json;
pub mod source_text;
pub mod svg;
pub mod tidy_csv;
mod toml_text;
pub mod trc;
pub mod urdf;
mod warning;
pub mod xml_text;
pub mod zarr;

pub use error::Error;
pub use layout::Layout;
pub use place::Place;
pub use warning::Warning;
