//! Calibrations as Qualisys Track Manager exports them: `.qca.txt`, which is XML.
//!
//! ```xml
//! <calibration type="regular">
//!   <cameras>
//!     <camera active="1" model="Miqus Video" serial="26580" viewrotation="0">
//!       <fov_video left="0" top="0" right="1087" bottom="1919"/>
//!       <transform x="1460.2" y="-1909.2" z="1896.5" r11="0.5536" r12="0.8047" … r33="0.3826"/>
//!       <intrinsic focalLengthU="107599.7" focalLengthV="107588.8" centerPointU="34110.3" centerPointV="60680.8"
//!                  sensorMinU="0" sensorMaxU="69568" skew="0" radialDistortion1="-0.0462" radialDistortion2="0.14"
//!                  radialDistortion3="0" tangentalDistortion1="0.0006" tangentalDistortion2="0.0007"/>
//!     </camera>
//! ```
//!
//! `fov_video` is the part of the sensor that the video shows, in pixels, its last ones included. `x`, `y` and `z` are the
//! camera's place in the world, millimetres, and `rij` turn the world to a camera that looks along −z with y up. Focal
//! lengths and centre are in sub-pixels, 64 to a pixel, counted from the corner of the sensor.
//!
//! **Distortions are plain numbers**, as in [`Brown`], and are *not* divided by 64:
//! they act on coordinates that have no unit. Pose2Sim divides them when it converts (`calib_qca_fun`, to version 0.10.49), so
//! that nearly nothing is left of them. Its `Calib.toml` and the file that it was made of differ by the distortion.
//!
//! Cameras are called by their `serial`. A camera that is not active, or has no `fov_video`, is left out with a warning.
//! A `viewrotation` is warned of: Qualisys calibrates the picture as the sensor records it.
//! A video of fewer pixels than `fov_video` (binning) has scaled images, as after any resizing.
//!
//! ```
//! # let text = "<calibration><cameras><camera active='1' serial='7'><fov_video left='0' top='0' right='639' bottom='479'/><transform x='0' y='0' z='3000' r11='1' r12='0' r13='0' r21='0' r22='1' r23='0' r31='0' r32='0' r33='1'/><intrinsic focalLengthU='32000' focalLengthV='32000' centerPointU='20480' centerPointV='15360' radialDistortion1='-0.1' radialDistortion2='0' radialDistortion3='0' tangentalDistortion1='0' tangentalDistortion2='0'/></camera></cameras></calibration>";
//! let calibration = sinew_formats::qualisys_cameras::read("Calib.qca.txt", text)?;
//! let camera = &calibration.cameras[0];
//! assert_eq!((camera.name.as_str(), camera.intrinsics.fx), ("7", 500.0));
//! assert_eq!(camera.translation, [0.0, 0.0, 3.0]); // it stands 3 m above the floor and looks down
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::calib_toml::Calibration;
use crate::numbers::plain;
use crate::rotation::{Matrix, apply};
use crate::source_text::finite;
use crate::xml_text::{Element, Xml, escaped};
use crate::{Error, Place, Warning, camera_checks};
use sinew_observe::cameras::lens::{Brown, Distortion};
use sinew_observe::{Camera, Intrinsics};
use std::fmt::Write as _;

/// Sub-pixels of a pixel.
const SUBPIXELS: f64 = 64.0;

/// Millimetres of a metre.
const MILLIMETRES: f64 = 1000.0;

/// Whether the element, or one in it, is of this format.
pub(crate) fn is_of(root: Element<'_>) -> bool {
    calibration(root).is_some()
}

fn calibration(root: Element<'_>) -> Option<Element<'_>> {
    let has_cameras =
        |element: &Element<'_>| element.name() == "calibration" && element.named("cameras").next().is_some();
    std::iter::once(root).chain(root.children()).find(has_cameras)
}

/// Reads the cameras that are active and film.
///
/// # Errors
/// XML that is malformed, no active camera with a `fov_video`, and for each camera: missing elements and attributes,
/// numbers that are no numbers or out of range, sub-pixels of another size, a rotation that is none.
pub fn read(name: &str, text: &str) -> Result<Calibration, Error> {
    let xml = Xml::parse(name, text)?;
    let missing = |field: &str| Place::file(name).lacks(field);
    let cameras = calibration(xml.root()).ok_or_else(|| missing("<calibration> with <cameras>"))?;
    let mut read = Calibration::default();
    for element in cameras.named("cameras").flat_map(|cameras| cameras.named("camera")) {
        let serial = attribute(name, element, "serial", "camera")?.to_owned();
        let place = Place::file(name).at_line(element.line()).within(&serial);
        if let Some(why) = why_left_out(element) {
            read.warnings.push(Warning::CameraLeftOut { place, camera: serial, why });
            continue;
        }
        if read.cameras.iter().any(|camera| camera.name == serial) {
            return Err(place.twice("camera", serial));
        }
        read.cameras.push(camera(name, serial, element, &mut read.warnings)?);
    }
    if read.cameras.is_empty() {
        return Err(missing("<camera> that is active and has <fov_video>, <transform> and <intrinsic>"));
    }
    Ok(read)
}

fn why_left_out(camera: Element<'_>) -> Option<&'static str> {
    let is = |attribute: &str, value: &str| camera.attribute(attribute).is_some_and(|found| found == value);
    if is("active", "0") {
        Some("it is not active")
    } else if is("calibrated", "false") {
        Some("it is not calibrated")
    } else if camera.named("fov_video").next().is_none() {
        Some("it has no video (`fov_video`)")
    } else {
        None
    }
}

fn attribute<'x>(name: &str, element: Element<'x>, key: &str, within: &str) -> Result<&'x str, Error> {
    let place = || Place::file(name).at_line(element.line()).within(within);
    element.attribute(key).ok_or_else(|| place().lacks(key))
}

/// An element of a camera, whose attributes are numbers.
struct Numbers<'a> {
    element: Element<'a>,
    file: &'a str,
    camera: &'a str,
}

impl<'a> Numbers<'a> {
    fn of(file: &'a str, camera: &'a str, element: Element<'a>, name: &'a str) -> Result<Self, Error> {
        let place = || Place::file(file).at_line(element.line()).within(camera);
        let element = element.named(name).next();
        let element = element.ok_or_else(|| place().lacks(format!("<{name}>")))?;
        Ok(Self { element, file, camera })
    }

    fn place(&self) -> Place {
        Place::file(self.file).at_line(self.element.line()).within(self.camera)
    }

    fn get(&self, key: &str) -> Result<f64, Error> {
        finite(|| self.place(), attribute(self.file, self.element, key, self.camera)?.trim())
    }

    fn all<const N: usize>(&self, keys: [&str; N]) -> Result<[f64; N], Error> {
        let mut values = [0.0; N];
        for (value, key) in values.iter_mut().zip(keys) {
            *value = self.get(key)?;
        }
        Ok(values)
    }
}

fn camera(file: &str, serial: String, element: Element<'_>, warnings: &mut Vec<Warning>) -> Result<Camera, Error> {
    let video = Numbers::of(file, &serial, element, "fov_video")?;
    let [left, top, right, bottom] = video.all(["left", "top", "right", "bottom"])?;
    let size = [right - left + 1.0, bottom - top + 1.0];
    if !size.iter().all(|&pixels| pixels > 0.0) {
        return Err(video.place().bad_value(
            "fov_video",
            format!("left {left}, top {top}, right {right}, bottom {bottom}"),
            "right of left and below top",
        ));
    }
    let optics = Numbers::of(file, &serial, element, "intrinsic")?;
    check_subpixels(element, &optics, right)?;
    let [fx, fy, cx, cy] =
        optics.all(["focalLengthU", "focalLengthV", "centerPointU", "centerPointV"])?.map(|length| length / SUBPIXELS);
    let skew = if optics.element.attribute("skew").is_some() { optics.get("skew")? / SUBPIXELS } else { 0.0 };
    let matrix = [[fx, skew, cx - left], [0.0, fy, cy - top], [0.0, 0.0, 1.0]];
    let [k1, k2, k3] = optics.all(["radialDistortion1", "radialDistortion2", "radialDistortion3"])?;
    let [p1, p2] = optics.all(["tangentalDistortion1", "tangentalDistortion2"])?;
    let transform = Numbers::of(file, &serial, element, "transform")?;
    let rows = transform.all(["r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"])?;
    let rows = camera_checks::rows(&rows).map(looking_along_z).unwrap_or_default();
    let rotation = camera_checks::rotation(transform.place(), &rows, warnings)?;
    let centre = transform.all(["x", "y", "z"])?.map(|length| length / MILLIMETRES);
    if element.attribute("viewrotation").is_some() {
        let place = Place::file(file).at_line(element.line()).within(&serial);
        let turned = attribute(file, element, "viewrotation", &serial)?;
        let degrees = finite(|| place.clone(), turned.trim())?;
        if degrees != 0.0 {
            warnings.push(Warning::TurnedView { place, degrees });
        }
    }
    Ok(Camera {
        image_size_px: size,
        intrinsics: camera_checks::intrinsics(optics.place(), &matrix, size, warnings)?,
        lens: Brown { k1, k2, p1, p2, k3 }.into(),
        rotation,
        translation: apply(&rotation, centre).map(|x| 0.0 - x),
        name: serial,
    })
}

/// From axes with y up, looking along −z, to axes with y down, looking along z; its own inverse.
fn looking_along_z([right, up, back]: Matrix) -> Matrix {
    [right, up.map(|x| 0.0 - x), back.map(|x| 0.0 - x)]
}

/// Refuses files whose sensor has not [`SUBPIXELS`] to a pixel of the video, such as those in pixels that Theia writes.
fn check_subpixels(element: Element<'_>, optics: &Numbers<'_>, right: f64) -> Result<(), Error> {
    if optics.element.attribute("sensorMaxU").is_none() {
        return Ok(());
    }
    let sensor = optics.get("sensorMaxU")?;
    let whole = Numbers::of(optics.file, optics.camera, element, "fov_video_max").and_then(|whole| whole.get("right"));
    let pixels = whole.map_or(right, |whole| whole.max(right)) + 1.0;
    if (SUBPIXELS - 1.0..=SUBPIXELS + 1.0).contains(&(sensor / pixels)) {
        return Ok(());
    }
    Err(optics.place().bad_value(
        "sensorMaxU",
        sensor.to_string(),
        format!("{SUBPIXELS} for each of the {pixels} pixels of the video"),
    ))
}

/// Writes a calibration that [`read`] and programs that know Qualisys read.
///
/// # Errors
/// [`Error::CameraUnwritable`] for a lens with other terms than the format's.
pub fn write(cameras: &[Camera]) -> Result<String, Error> {
    let mut out =
        String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<calibration type=\"regular\">\n  <cameras>\n");
    for camera in cameras {
        let Distortion::Brown(Brown { k1, k2, p1, p2, k3 }) = *camera.lens.distortion() else {
            let reason = "its lens is neither perfect nor one with k1, k2, k3, p1 and p2";
            return Err(Error::CameraUnwritable { camera: camera.name.clone(), program: "Qualisys", reason });
        };
        let Intrinsics { fx, fy, cx, cy } = camera.intrinsics;
        let [fx, fy, cx, cy] = [fx, fy, cx, cy].map(|length| SUBPIXELS * length);
        let [width, height] = camera.image_size_px;
        let [right, bottom] = [width - 1.0, height - 1.0].map(plain);
        let [u, v] = [width, height].map(|pixels| SUBPIXELS * pixels - 1.0);
        let [x, y, z] = camera.centre().map(|length| MILLIMETRES * length);
        let [[a, b, c], [d, e, f], [g, h, i]] = looking_along_z(camera.rotation);
        // Writing to a String cannot fail.
        let _ = write!(
            out,
            r#"    <camera active="1" serial="{}" model="none" avg-residual="0" viewrotation="0">
      <fov_video left="0" top="0" right="{right}" bottom="{bottom}"/>
      <fov_video_max left="0" top="0" right="{right}" bottom="{bottom}"/>
      <transform x="{x:?}" y="{y:?}" z="{z:?}" r11="{a:?}" r12="{b:?}" r13="{c:?}" r21="{d:?}" r22="{e:?}" r23="{f:?}" r31="{g:?}" r32="{h:?}" r33="{i:?}"/>
      <intrinsic sensorMinU="0" sensorMaxU="{u:?}" sensorMinV="0" sensorMaxV="{v:?}" focalLengthU="{fx:?}" focalLengthV="{fy:?}" centerPointU="{cx:?}" centerPointV="{cy:?}" skew="0" radialDistortion1="{k1:?}" radialDistortion2="{k2:?}" radialDistortion3="{k3:?}" tangentalDistortion1="{p1:?}" tangentalDistortion2="{p2:?}"/>
    </camera>
"#,
            escaped(&camera.name),
        );
    }
    out.push_str("  </cameras>\n</calibration>\n");
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAMERA: &str = "<fov_video left='100' top='20' right='739' bottom='499'/>\
        <fov_video_max left='0' top='0' right='1087' bottom='1919'/>\
        <transform x='1000' y='2000' z='3000' r11='1' r12='0' r13='0' r21='0' r22='0' r23='1' r31='0' r32='-1' r33='0'/>\
        <intrinsic sensorMaxU='69568' skew='0' focalLengthU='32000' focalLengthV='32064' centerPointU='26880' \
        centerPointV='16640' radialDistortion1='-0.1' radialDistortion2='0.2' radialDistortion3='0.3' \
        tangentalDistortion1='0.01' tangentalDistortion2='0.02'/>";

    #[test]
    fn a_cropped_camera_that_looks_along_y() {
        let text = format!(
            "<QTM_Parameters_Ver_1.25><calibration><cameras><camera active='0' serial='1'/><camera serial='2'/>\
             <camera serial='3'>{CAMERA}</camera></cameras></calibration></QTM_Parameters_Ver_1.25>"
        );
        let read = read("Calib.qca.txt", &text).unwrap();
        let why: Vec<String> = read.warnings.iter().map(ToString::to_string).collect();
        assert_eq!(
            why,
            [
                "Calib.qca.txt:1 (1): camera `1` is left out: it is not active",
                "Calib.qca.txt:1 (2): camera `2` is left out: it has no video (`fov_video`)",
            ]
        );
        let camera = &read.cameras[0];
        assert_eq!((&camera.name[..], camera.image_size_px), ("3", [640.0, 480.0]));
        assert_eq!(camera.intrinsics, Intrinsics { fx: 500.0, fy: 501.0, cx: 320.0, cy: 240.0 });
        assert_eq!(camera.lens.coefficients(), [-0.1, 0.2, 0.01, 0.02, 0.3]);
        assert_eq!(camera.centre(), [1.0, 2.0, 3.0]);
        // Straight ahead, along y, is the principal point; what is above it lies above it in the image.
        assert_eq!(camera.project([1.0, 5.0, 3.0]).pixel(), Some([320.0, 240.0]));
        assert!(camera.project([1.0, 5.0, 3.1]).pixel().unwrap()[1] < 240.0);
    }
}
