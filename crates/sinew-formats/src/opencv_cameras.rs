//! Calibrations in files of OpenCV's `FileStorage`, YAML or XML.
//!
//! OpenCV has no one layout. A list of cameras is what [`write()`] writes, and what a script writes best:
//!
//! ```yaml
//! %YAML:1.0
//! ---
//! unit: "m"                       # of translations; "mm" and "cm" are read as well
//! cameras:
//!    -
//!       name: "left"
//!       image_width: 1280
//!       image_height: 720
//!       camera_matrix: !!opencv-matrix
//!          rows: 3
//!          cols: 3
//!          dt: d
//!          data: [ 894.5, 0., 624., 0., 896.9, 361.3, 0., 0., 1. ]
//!       distortion_coefficients: !!opencv-matrix
//!          rows: 1
//!          cols: 5
//!          dt: d
//!          data: [ -0.338, 0.097, -0.001, 0.003, -0.004 ]
//!       rvec: [ 1.399, 1.041, -0.935 ]      # camera from world
//!       tvec: [ -0.643, 0.263, 1.452 ]
//!       fisheye: 0                          # 1 for the model of cv::fisheye
//! ```
//!
//! Other layouts are read, too:
//!
//! | layout | keys |
//! |---|---|
//! | one camera, outermost | as in the list above, in the spellings of [`FIELDS`]; the pose must be there |
//! | OpenCV's `multiview_calibration.py` | `Ks`, `distortions`, `rvecs`, `Ts` and, as far as they are there, `cam_ids`, `image_sizes`, `is_fisheye` |
//! | a pair of `stereoCalibrate`, as OpenCV's sample `stereo_calib` writes it | `M1`, `D1`, `M2`, `D2`, `R`, `T` in one file, or `extrinsics.yml` after `intrinsics.yml` in one (YAML); `image_size` as far as it is there |
//! | EasyMocap's `intri.yml` and `extri.yml` in one file | `names`; for each `K_name`, `dist_name`, `R_name` (Rodrigues) or `Rot_name`, `T_name` and perhaps `W_name`, `H_name` |
//!
//! Coefficients are OpenCV's: 4, 5 or 8, or 12 and 14 whose later ones are 0; 4 where the camera is a fisheye. An
//! image size that is missing is taken as twice the principal point, with a warning. Lengths are in the unit of the
//! board: without `unit` metres are assumed where no camera stands more than 100 units from the origin, and millimetres,
//! with a warning, where one does.
//!
//! Of a pair, the world is the first camera, `cam_1`, and the second, `cam_2`, sees a point x of it at R x + T.
//!
//! ```
//! let text = "%YAML:1.0\n---\ncamera_matrix: [ 500., 0., 320., 0., 500., 240., 0., 0., 1. ]\ndistortion_coefficients: [ 0., 0., 0., 0. ]\nimage_width: 640\nimage_height: 480\nrvec: [ 0., 0., 0. ]\ntvec: [ 0., 0., 3. ]\n";
//! let calibration = sinew_formats::opencv_cameras::read("left.yml", text)?;
//! assert_eq!(calibration.cameras[0].name, "left");
//! let lens = "[ 500., 0., 320., 0., 500., 240., 0., 0., 1. ]";
//! let pair = format!("%YAML:1.0\n---\nM1: {lens}\nD1: [ 0., 0., 0., 0. ]\nM2: {lens}\nD2: [ 0., 0., 0., 0. ]\nR: [ 0., 0., 0. ]\nT: [ -0.1, 0., 0. ]\n");
//! let calibration = sinew_formats::opencv_cameras::read("stereo.yml", &pair)?;
//! assert_eq!(calibration.cameras[1].translation, [-0.1, 0.0, 0.0]);
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::calib_toml::Calibration;
use crate::length_unit::{self, LengthUnit, to_metres};
use crate::numbers::plain;
use crate::opencv_storage::{Node, parse};
use crate::rotation::{Matrix, from_rodrigues, to_rodrigues};
use crate::source_text::shortened;
use crate::toml_text::{array, quoted};
use crate::{Error, Place, Warning, camera_checks};
use sinew_observe::{Camera, Intrinsics};
use std::fmt::Write as _;

/// Spellings of what a camera has: matrix, distortion, rotation, translation, size, width, height, fisheye, name.
pub const FIELDS: [&[&str]; 9] = [
    &["camera_matrix", "cameraMatrix", "K", "intrinsic_matrix", "matrix"],
    &["distortion_coefficients", "distCoeffs", "dist_coeffs", "distortion", "dist", "D"],
    &["rvec", "rotation_vector", "rotation_matrix", "rotation", "R"],
    &["tvec", "translation_vector", "translation", "T"],
    &["image_size", "imageSize", "size"],
    &["image_width", "width", "W"],
    &["image_height", "height", "H"],
    &["fisheye", "is_fisheye"],
    &["name", "camera_name", "id"],
];

/// Keys of matrix and distortion of the two cameras of a pair.
const STEREO: [[&str; 2]; 2] = [["M1", "D1"], ["M2", "D2"]];

/// What a file says of a camera.
struct Found {
    name: String,
    line: usize,
    matrix: Vec<f64>,
    distortion: Vec<f64>,
    rotation: Vec<f64>,
    translation: Vec<f64>,
    size: Vec<f64>,
    is_fisheye: bool,
}

/// Reads a calibration.
///
/// # Errors
/// A file that is malformed or of another layout, and for each camera: fields that are missing or of another number of
/// numbers, numbers that are no numbers or out of range, a rotation that is none, terms that no lens has.
pub fn read(name: &str, text: &str) -> Result<Calibration, Error> {
    let root = parse(name, text)?;
    let mut calibration = Calibration::default();
    for found in cameras(name, &root)? {
        let place = Place::file(name).at_line(found.line).within(&found.name);
        if calibration.cameras.iter().any(|camera| camera.name == found.name) {
            return Err(place.twice("camera", found.name));
        }
        calibration.cameras.push(camera(place, found, &mut calibration.warnings)?);
    }
    let unit = root.get("unit").map_or(Ok(None), |node| stated_unit(name, node))?;
    to_metres(&mut calibration.cameras, unit, Place::file(name), &mut calibration.warnings);
    Ok(calibration)
}

fn stated_unit(file: &str, node: &Node) -> Result<Option<LengthUnit>, Error> {
    let text = node.text().unwrap_or_default();
    let unit = LengthUnit::named(text);
    unit.map(Some).ok_or_else(|| {
        Place::file(file).at_line(node.line).bad_value("unit", format!("\"{}\"", shortened(text)), length_unit::NAMES)
    })
}

fn cameras(file: &str, root: &Node) -> Result<Vec<Found>, Error> {
    if let Some(list) = root.get("cameras") {
        let cameras = list.items().iter().enumerate();
        let found: Vec<Found> =
            cameras.map(|(index, node)| by_fields(file, node, &format!("camera {index}"))).collect::<Result<_, _>>()?;
        if !found.is_empty() {
            return Ok(found);
        }
    } else if root.get("Ks").is_some() {
        return multiview(file, root);
    } else if let Some(names) = root.get("names") {
        let names: Vec<&str> = names.items().iter().filter_map(Node::text).collect();
        if !names.is_empty() {
            return names.into_iter().map(|name| by_name(file, root, name)).collect();
        }
    } else if STEREO.iter().flatten().any(|key| root.get(key).is_some()) {
        return stereo(file, root);
    } else if root.first(FIELDS[0]).is_some() {
        let stem = file.rsplit(['/', '\\']).next().unwrap_or(file);
        let stem = stem.split('.').next().filter(|stem| !stem.is_empty()).unwrap_or(stem);
        return Ok(vec![by_fields(file, root, stem)?]);
    }
    Err(Place::file(file).lacks("cameras (or Ks, names, M1, camera_matrix)"))
}

fn required<'n>(file: &str, node: &'n Node, keys: &[&str], within: &str) -> Result<&'n Node, Error> {
    node.first(keys).ok_or_else(|| {
        let place = Place::file(file).at_line(node.line).within(within);
        place.lacks(keys.first().copied().unwrap_or_default())
    })
}

/// A camera whose map has its fields.
fn by_fields(file: &str, node: &Node, name: &str) -> Result<Found, Error> {
    let [matrix, distortion, rotation, translation, size, width, height, fisheye, names] = FIELDS;
    let name = node.first(names).and_then(Node::text).unwrap_or(name).to_owned();
    let numbers = |keys| required(file, node, keys, &name)?.numbers(file, &name);
    let size = match (node.first(size), node.first(width), node.first(height)) {
        (Some(size), ..) => size.numbers(file, &name)?,
        (None, Some(width), Some(height)) => [width.numbers(file, &name)?, height.numbers(file, &name)?].concat(),
        _ => vec![],
    };
    let is_fisheye = node.first(fisheye).and_then(Node::text).is_some_and(|text| matches!(text, "1" | "true"));
    Ok(Found {
        line: node.line,
        matrix: numbers(matrix)?,
        distortion: numbers(distortion)?,
        rotation: numbers(rotation)?,
        translation: numbers(translation)?,
        size,
        is_fisheye,
        name,
    })
}

/// A camera whose fields are outermost and carry its name.
fn by_name(file: &str, root: &Node, name: &str) -> Result<Found, Error> {
    let optional = |field: &str| root.get(&format!("{field}_{name}"));
    let numbers = |fields: [&str; 2]| {
        let node = fields.into_iter().find_map(optional).ok_or_else(|| {
            let field = format!("{}_{name}", fields[0]);
            Place::file(file).lacks(shortened(&field))
        })?;
        node.numbers(file, name)
    };
    let size = match (optional("W"), optional("H")) {
        (Some(width), Some(height)) => [width.numbers(file, name)?, height.numbers(file, name)?].concat(),
        _ => vec![],
    };
    Ok(Found {
        name: name.into(),
        line: optional("K").map_or(root.line, |node| node.line),
        matrix: numbers(["K", "K"])?,
        distortion: numbers(["dist", "D"])?,
        rotation: numbers(["R", "Rot"])?,
        translation: numbers(["T", "T"])?,
        size,
        is_fisheye: false,
    })
}

/// Cameras whose fields are rows of matrices, as OpenCV's calibration of several views writes them.
fn multiview(file: &str, root: &Node) -> Result<Vec<Found>, Error> {
    let matrices = required(file, root, &["Ks"], "Ks")?.numbers(file, "Ks")?;
    let count = matrices.len() / 9;
    let ids = root.get("cam_ids").and_then(Node::text).unwrap_or_default();
    let ids: Vec<&str> = ids.split(',').map(str::trim).filter(|id| !id.is_empty()).collect();
    let rows = |key: &'static str, node: &Node| -> Result<Vec<Vec<f64>>, Error> {
        let numbers = node.numbers(file, key)?;
        let width = numbers.len().checked_div(count).unwrap_or(0);
        if width == 0 || numbers.len() != count * width {
            let place = Place::file(file).at_line(node.line).within(key);
            return Err(Error::RowLength { place, found: numbers.len(), expected: count * width.max(1) });
        }
        Ok(numbers.chunks(width).map(<[f64]>::to_vec).collect())
    };
    let all = |key: &'static str| rows(key, required(file, root, &[key], key)?);
    let some = |key: &'static str| root.get(key).map_or(Ok(vec![vec![]; count]), |node| rows(key, node));
    let (matrix, distortion, rotation, translation) = (all("Ks")?, all("distortions")?, all("rvecs")?, all("Ts")?);
    let (size, is_fisheye) = (some("image_sizes")?, some("is_fisheye")?);
    let found = (0..count).map(|index| Found {
        name: ids.get(index).map_or_else(|| format!("cam_{index}"), |id| (*id).to_owned()),
        line: root.get("Ks").map_or(root.line, |node| node.line),
        matrix: matrix[index].clone(),
        distortion: distortion[index].clone(),
        rotation: rotation[index].clone(),
        translation: translation[index].clone(),
        size: size[index].clone(),
        is_fisheye: is_fisheye[index].first().is_some_and(|&flag| flag != 0.0),
    });
    Ok(found.collect())
}

/// The two cameras of `stereoCalibrate`; the world is the first one's.
fn stereo(file: &str, root: &Node) -> Result<Vec<Found>, Error> {
    let [_, _, rotation, translation, size, width, height, ..] = FIELDS;
    let size = match (root.first(size), root.first(width), root.first(height)) {
        (Some(size), ..) => size.numbers(file, "image_size")?,
        (None, Some(width), Some(height)) => {
            [width.numbers(file, "image_width")?, height.numbers(file, "image_height")?].concat()
        }
        _ => vec![],
    };
    let camera = |(index, [matrix, distortion]): (usize, [&'static str; 2])| {
        let name = format!("cam_{}", index + 1);
        let numbers = |keys: &[&str]| required(file, root, keys, &name)?.numbers(file, &name);
        let pose = |keys: &[&'static str]| {
            let capital = *keys.last().unwrap_or(&"");
            if index == 0 { Ok(vec![0.0; 3]) } else { numbers(&[&[capital], keys].concat()) }
        };
        Ok(Found {
            line: root.get(matrix).map_or(root.line, |node| node.line),
            matrix: numbers(&[matrix])?,
            distortion: numbers(&[distortion])?,
            rotation: pose(rotation)?,
            translation: pose(translation)?,
            size: size.clone(),
            is_fisheye: false,
            name: name.clone(),
        })
    };
    STEREO.into_iter().enumerate().map(camera).collect()
}

fn camera(place: Place, found: Found, warnings: &mut Vec<Warning>) -> Result<Camera, Error> {
    let bad = |field: &str, numbers: &[f64], expected: String| {
        place.clone().bad_value(field, shortened(&format!("{numbers:?}")), expected)
    };
    let matrix = camera_checks::rows(&found.matrix);
    let matrix: Matrix = matrix.ok_or_else(|| bad("camera_matrix", &found.matrix, "9 numbers, rows first".into()))?;
    let size = match found.size[..] {
        [] => {
            let size = [matrix[0][2], matrix[1][2]].map(|centre| (2.0 * centre).round());
            let value = format!("{} x {} px, twice the principal point,", size[0], size[1]);
            warnings.push(Warning::Assumed { place: place.clone(), field: "image size", value });
            size
        }
        [width, height] => [width, height],
        _ => return Err(bad("image_size", &found.size, "width and height".into())),
    };
    if !size.iter().all(|&pixels| pixels > 0.0) {
        return Err(bad("image_size", &size, "two positive numbers, width and height in pixels".into()));
    }
    let rotation = match (found.rotation[..].try_into(), camera_checks::rows(&found.rotation)) {
        (Ok(vector), _) => from_rodrigues(vector),
        (_, Some(matrix)) => camera_checks::rotation(place.clone(), &matrix, warnings)?,
        _ => {
            let expected = "a Rodrigues vector of 3 numbers or a matrix of 9".into();
            return Err(bad("rvec", &found.rotation, expected));
        }
    };
    let translation = found.translation[..].try_into();
    Ok(Camera {
        image_size_px: size,
        intrinsics: camera_checks::intrinsics(place.clone(), &matrix, size, warnings)?,
        lens: camera_checks::lens(found.is_fisheye, &found.distortion)
            .map_err(|expected| bad("distortion_coefficients", &found.distortion, expected))?,
        rotation,
        translation: translation.map_err(|_| bad("tvec", &found.translation, "3 numbers".into()))?,
        name: found.name,
    })
}

/// Writes a list of cameras in YAML, which [`read`] and `cv::FileStorage` read.
#[must_use]
pub fn write(cameras: &[Camera]) -> String {
    let mut out = String::from("%YAML:1.0\n---\nunit: \"m\"\ncameras:\n");
    for camera in cameras {
        let Intrinsics { fx, fy, cx, cy } = camera.intrinsics;
        let [width, height] = camera.image_size_px.map(plain);
        let matrix = |rows: usize, numbers: &[f64]| {
            let (columns, data) = (numbers.len() / rows, array(numbers));
            format!(
                "!!opencv-matrix\n         rows: {rows}\n         cols: {columns}\n         dt: d\n         data: {data}"
            )
        };
        // Writing to a String cannot fail.
        let _ = write!(
            out,
            "   -\n      name: {}\n      image_width: {width}\n      image_height: {height}\n      camera_matrix: {}\n      \
             distortion_coefficients: {}\n      rvec: {}\n      tvec: {}\n      fisheye: {}\n",
            quoted(&camera.name),
            matrix(3, &[fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]),
            matrix(1, &camera.lens.coefficients()),
            matrix(3, &to_rodrigues(&camera.rotation)),
            matrix(3, &camera.translation),
            u8::from(camera.lens.is_fisheye()),
        );
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const MATRIX: &str = "[ 500., 0., 320., 0., 510., 240., 0., 0., 1. ]";

    fn check(file: &str, text: &str, name: &str, warnings: usize) {
        let read = read(file, text).unwrap();
        let camera = &read.cameras[0];
        assert_eq!((&camera.name[..], camera.image_size_px), (name, [640.0, 480.0]), "{text}");
        assert_eq!(camera.intrinsics, Intrinsics { fx: 500.0, fy: 510.0, cx: 320.0, cy: 240.0 });
        assert_eq!(camera.lens.coefficients(), [0.1, 0.2, 0.01, 0.02]);
        assert_eq!(camera.rotation, from_rodrigues([0.1, 0.2, 0.3]));
        assert_eq!((camera.translation, read.warnings.len()), ([1.0, 2.0, 3.0], warnings), "{text}");
    }

    #[test]
    fn every_layout_is_read() {
        let list = format!(
            "%YAML:1.0\n---\nunit: \"cm\"\ncameras:\n   - {{ name: a, image_size: [ 640, 480 ], K: {MATRIX}, \
             D: [ 0.1, 0.2, 0.01, 0.02 ], R: [ 0.1, 0.2, 0.3 ], T: [ 100, 200, 300 ] }}\n"
        );
        check("rig.yml", &list, "a", 0);
        let names = format!(
            "%YAML:1.0\n---\nnames:\n  - \"1\"\nK_1: {MATRIX}\ndist_1: [ 0.1, 0.2, 0.01, 0.02, 0. ]\n\
             %YAML:1.0\n---\nnames:\n  - \"1\"\nR_1: [ 0.1, 0.2, 0.3 ]\nT_1: [ 1, 2, 3 ]\n"
        );
        check("both.yml", &names, "1", 1);
        let views = format!(
            "%YAML:1.0\n---\nKs: {MATRIX}\ndistortions: [ 0.1, 0.2, 0.01, 0.02, 0. ]\nrvecs: [ 0.1, 0.2, 0.3 ]\n\
             Ts: [ 1000, 2000, 3000 ]\ncam_ids: \"left\"\nimage_sizes: [ 640, 480 ]\nis_fisheye: [ 0 ]\n"
        );
        check("views.yml", &views, "left", 1);
        let one = "<?xml version=\"1.0\"?>\n<opencv_storage>\n<cameraMatrix type_id=\"opencv-matrix\">\n  \
            <data>500. 0. 320. 0. 510. 240. 0. 0. 1.</data></cameraMatrix>\n<distCoeffs>0.1 0.2 0.01 0.02</distCoeffs>\n\
            <imageSize>640 480</imageSize>\n<rvec>0.1 0.2 0.3</rvec>\n<tvec>1 2 3</tvec></opencv_storage>\n";
        check("lab/front.xml", one, "front", 0);
    }

    /// The sample `stereo_calib` writes two files; one after the other they are one.
    #[test]
    fn the_second_camera_of_a_pair_is_turned_and_shifted_from_the_first() {
        let intrinsics = format!(
            "%YAML:1.0\n---\nM1: {MATRIX}\nD1: [ 0.1, 0.2, 0.01, 0.02, 0. ]\nM2: [ 520., 0., 300., 0., 530., 250., 0., 0., 1. ]\n\
             D2: [ 0., 0., 0., 0., 0. ]\n"
        );
        let extrinsics = "%YAML:1.0\n---\nR: [ 0., -1., 0., 1., 0., 0., 0., 0., 1. ]\nT: [ -0.5, 0.25, 1. ]\n\
                          R1: [ 1., 0., 0., 0., 1., 0., 0., 0., 1. ]\nimage_size: [ 640, 480 ]\n";
        let text = intrinsics.clone() + extrinsics;
        check_pair(&read("stereo.yml", &text).unwrap());
        let element = |line: &str| {
            let (key, value) = line.split_once(": ")?;
            let numbers = value.trim_matches(['[', ']', ' ']).replace(',', " ");
            Some(format!("<{key}>{numbers}</{key}>\n"))
        };
        let elements: String = text.lines().filter_map(element).collect();
        let xml = format!("<?xml version=\"1.0\"?>\n<opencv_storage>\n{elements}</opencv_storage>\n");
        check_pair(&read("stereo.xml", &xml).unwrap());
        assert_eq!(
            read("intrinsics.yml", &intrinsics).unwrap_err().to_string(),
            "intrinsics.yml:3 (cam_2): `R` is missing"
        );
        assert_eq!(
            read("extrinsics.yml", &extrinsics.replace("R1", "M1")).unwrap_err().to_string(),
            "extrinsics.yml:3 (cam_1): `D1` is missing"
        );
    }

    fn check_pair(read: &Calibration) {
        let [first, second] = &read.cameras[..] else { panic!("{:?}", read.cameras) };
        assert_eq!((&first.name[..], &second.name[..], read.warnings.len()), ("cam_1", "cam_2", 0));
        assert_eq!(first.intrinsics, Intrinsics { fx: 500.0, fy: 510.0, cx: 320.0, cy: 240.0 });
        assert_eq!(second.intrinsics, Intrinsics { fx: 520.0, fy: 530.0, cx: 300.0, cy: 250.0 });
        assert_eq!([first.image_size_px, second.image_size_px], [[640.0, 480.0]; 2]);
        assert_eq!((first.point_in_camera([3.0, 5.0, 7.0])), [3.0, 5.0, 7.0]);
        assert_eq!(second.point_in_camera([3.0, 5.0, 7.0]), [-5.0 - 0.5, 3.0 + 0.25, 7.0 + 1.0]);
    }

    #[test]
    fn rows_that_do_not_belong_to_the_cameras_are_refused() {
        let views = format!("%YAML:1.0\n---\nKs: {MATRIX}\ndistortions: [ 0.1 ]\nrvecs: []\nTs: [ 1, 2, 3 ]\n");
        assert_eq!(read("views.yml", &views).unwrap_err().to_string(), "views.yml:5 (rvecs): 0 values; expected 1");
    }
}
