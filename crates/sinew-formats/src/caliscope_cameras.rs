//! Calibrations as Caliscope writes them: `camera_array.toml`, and `config.toml` of its first versions (Pyxy3D).
//!
//! ```toml
//! [cameras.0]
//! cam_id = 0                      # `port` in older files
//! size = [1280, 720]              # pixels
//! rotation_count = 0              # quarter turns of the picture on the screen
//! matrix = [[894.5, 0.0, 624.0], [0.0, 896.9, 361.3], [0.0, 0.0, 1.0]]
//! distortions = [-0.338, 0.097, -0.001, 0.003, -0.004]
//! rotation = [1.399, 1.041, -0.935]                 # camera from world: Rodrigues vector, a 3 x 3 matrix in older files
//! translation = [-0.643, 0.263, 1.452]              # metres
//! fisheye = false                                   # not in older files
//! ```
//!
//! The table of a camera is `[cameras.N]`, in the oldest files `[cam_N]` with a `port`. Cameras are called `cam_N`, as
//! Caliscope calls them when it writes for other programs. Numbers mean what they mean in [`calib_toml`](crate::calib_toml).
//! A camera with `ignore = true`, without intrinsics or without a pose is left out with a warning. Values that are
//! missing may be written `"null"`. `rotation_count` turns what Caliscope shows, not what it calibrates, and is ignored.
//! The world is that of a camera or of a board: no axis need point up.
//!
//! ```
//! # let text = "[cameras.3]\ncam_id = 3\nsize = [640, 480]\nmatrix = [[500, 0, 320], [0, 500, 240], [0, 0, 1]]\ndistortions = [0, 0, 0, 0, 0]\nrotation = [0, 0, 0]\ntranslation = [0, 0, 3]\n";
//! let calibration = sinew_formats::caliscope_cameras::read("camera_array.toml", text)?;
//! assert_eq!(calibration.cameras[0].name, "cam_3");
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::calib_toml::{Calibration, add_camera, camera_fields};
use crate::numbers::plain;
use crate::toml_text::{Document, Table};
use crate::{Error, Warning};
use sinew_observe::Camera;
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// Whether the document is of this format.
pub(crate) fn is_of(root: Table<'_>) -> bool {
    !tables(root).is_empty()
}

/// Numbers and tables of the cameras.
fn tables<'a>(root: Table<'a>) -> Vec<(&'a str, Table<'a>)> {
    let tables = root.tables();
    match tables.iter().find(|(title, _)| *title == "cameras") {
        Some((_, cameras)) => cameras.tables(),
        None => {
            let with_port = |&(title, table): &(&'a str, Table<'a>)| {
                let number = title.strip_prefix("cam_")?;
                table.get("port").map(|_| (number, table))
            };
            tables.iter().filter_map(with_port).collect()
        }
    }
}

/// Reads the cameras that are used and have a pose.
///
/// # Errors
/// TOML that is malformed, no camera with a pose, and for each camera what [`calib_toml::read`](crate::calib_toml::read)
/// refuses.
pub fn read(name: &str, text: &str) -> Result<Calibration, Error> {
    let document = Document::parse(name, text)?;
    let mut calibration = Calibration::default();
    for (number, table) in tables(document.root()) {
        let camera = format!("cam_{number}");
        let table = table.within(&camera);
        match why_left_out(table)? {
            Some(why) => {
                calibration.warnings.push(Warning::CameraLeftOut { place: table.place(), camera: camera.clone(), why });
            }
            None => add_camera(&mut calibration, &camera, table)?,
        }
    }
    if calibration.cameras.is_empty() {
        return Err(document.root().place().lacks("[cameras.N] with matrix, rotation and translation"));
    }
    Ok(calibration)
}

fn why_left_out(table: Table<'_>) -> Result<Option<&'static str>, Error> {
    let is_ignored = table.get("ignore").map_or(Ok(false), |value| value.bool())?;
    let lacks = |key| table.get(key).is_none_or(|value| value.string().is_ok_and(|text| text == "null"));
    Ok(if is_ignored {
        Some("the file says `ignore = true`")
    } else if lacks("matrix") || lacks("distortions") {
        Some("it has no intrinsics")
    } else if lacks("rotation") || lacks("translation") {
        Some("it has no pose")
    } else {
        None
    })
}

/// The numbers under which [`write()`] writes cameras: those at the end of `cam_N`, else their places in the list.
#[must_use]
pub fn numbers(cameras: &[Camera]) -> Vec<u64> {
    let own: Option<Vec<u64>> = cameras.iter().map(|camera| camera.name.strip_prefix("cam_")?.parse().ok()).collect();
    let is_distinct = |numbers: &Vec<u64>| numbers.iter().collect::<BTreeSet<_>>().len() == numbers.len();
    own.filter(is_distinct).unwrap_or_else(|| (0..cameras.len() as u64).collect())
}

/// Writes a `camera_array.toml` that [`read`] and Caliscope read, each camera under its [number](numbers).
#[must_use]
pub fn write(cameras: &[Camera]) -> String {
    let mut out = String::new();
    for (number, camera) in numbers(cameras).into_iter().zip(cameras) {
        let [width, height] = camera.image_size_px.map(plain);
        let fields = camera_fields(camera, camera.translation);
        // Writing to a String cannot fail.
        let _ = write!(
            out,
            "[cameras.{number}]\ncam_id = {number}\nsize = [{width}, {height}]\nrotation_count = 0\n{fields}"
        );
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAMERA: &str = "size = [640, 480]\nmatrix = [[500, 0, 320], [0, 500, 240], [0, 0, 1]]\n\
        distortions = [0.1, 0, 0, 0, 0]\n";
    const POSE: &str = "rotation = [0, 0, 0]\ntranslation = [0, 0, 3]\n";

    #[test]
    fn both_generations_and_the_first_one_are_read() {
        let matrix = "rotation = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\ntranslation = [0, 0, 3]\n";
        for text in [
            format!("[cameras.1]\ncam_id = 1\n{CAMERA}{POSE}fisheye = false\n"),
            format!("[cameras.1]\nport = 1\nignore = false\n{CAMERA}{matrix}"),
            format!("camera_count = 1\n[cam_1]\nport = 1\n{CAMERA}{POSE}[stereo_1_2]\nRMSE = 3.1\n"),
        ] {
            let calibration = read("camera_array.toml", &text).unwrap();
            assert_eq!((&calibration.cameras[0].name[..], calibration.cameras.len()), ("cam_1", 1));
            assert_eq!(calibration.warnings, []);
        }
    }

    #[test]
    fn cameras_that_are_not_used_are_named() {
        let text = format!(
            "[cameras.0]\n{CAMERA}{POSE}[cameras.1]\nignore = true\n{CAMERA}{POSE}[cameras.2]\nsize = [640, 480]\n\
             [cameras.3]\n{CAMERA}rotation = \"null\"\ntranslation = \"null\"\n"
        );
        let calibration = read("camera_array.toml", &text).unwrap();
        assert_eq!(calibration.cameras.len(), 1);
        let warnings: Vec<String> = calibration.warnings.iter().map(ToString::to_string).collect();
        assert_eq!(
            warnings,
            [
                "camera_array.toml:7 (cam_1): camera `cam_1` is left out: the file says `ignore = true`",
                "camera_array.toml:14 (cam_2): camera `cam_2` is left out: it has no intrinsics",
                "camera_array.toml:16 (cam_3): camera `cam_3` is left out: it has no pose",
            ]
        );
        assert!(read("camera_array.toml", &format!("[cameras.0]\n{CAMERA}")).is_err());
    }

    #[test]
    fn cameras_keep_their_numbers_where_all_have_one() {
        let named = |names: &[&str]| {
            let camera =
                |name: &&str| Camera::look_at(name, [640.0, 480.0], 500.0, [0.0, -4.0, 1.0], [0.0; 3]).unwrap();
            numbers(&names.iter().map(camera).collect::<Vec<_>>())
        };
        assert_eq!(named(&["cam_4", "cam_02"]), [4, 2]);
        assert_eq!(named(&["cam_4", "cam_04"]), [0, 1]);
        assert_eq!(named(&["cam_4", "left"]), [0, 1]);
    }
}
