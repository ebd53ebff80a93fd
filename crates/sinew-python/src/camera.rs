//! Cameras: projection of points with its derivative, and lenses taken back.

use crate::arrays::{Two, array, fixed, numbers, room, shaped};
use crate::background::detached;
use crate::failure::Failure;
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sinew::observe::{Camera, Intrinsics, Lens};

/// Name, size of the image, focal lengths, rotation and translation.
type CameraArguments<'py> = (String, (f64, f64), (f64, f64), Bound<'py, PyArrayDyn<f64>>, Bound<'py, PyArrayDyn<f64>>);

/// A calibrated camera.
///
/// Parameters
/// ----------
/// name
///     Name of the camera.
/// image_size_px
///     Width and height, pixels.
/// focal_px
///     Focal lengths (fx, fy), pixels.
/// centre_px
///     Principal point (cx, cy), pixels; the middle of the image by default.
/// rotation, translation
///     From the world to the camera: (3, 3) and (3,) metres; a camera looks along z with y down.
/// distortion
///     OpenCV's coefficients: 4 or 5 (Brown), 8 (rational), or 4 with `fisheye`.
#[pyclass(frozen, name = "Camera", module = "sinew", eq)]
#[derive(Clone, PartialEq)]
pub(crate) struct PyCamera(pub(crate) Camera);

#[pymethods]
impl PyCamera {
    #[new]
    #[pyo3(signature = (name, image_size_px, focal_px, rotation, translation, *, centre_px = None, distortion = None, fisheye = false))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        name: String,
        image_size_px: &Bound<'_, PyAny>,
        focal_px: &Bound<'_, PyAny>,
        rotation: &Bound<'_, PyAny>,
        translation: &Bound<'_, PyAny>,
        centre_px: Option<&Bound<'_, PyAny>>,
        distortion: Option<Vec<f64>>,
        fisheye: bool,
    ) -> PyResult<Self> {
        let image_size_px = fixed("image_size_px", image_size_px)?;
        let [fx, fy] = fixed("focal_px", focal_px)?;
        let centre = centre_px.map(|centre| fixed("centre_px", centre)).transpose()?;
        let [cx, cy] = centre.unwrap_or(image_size_px.map(|size| 0.5 * size));
        let rows = numbers("rotation", rotation)?;
        rows.exactly(&[("3", Some(3)), ("3", Some(3))])?;
        let (rows, _) = rows.finite()?.as_chunks::<3>();
        let rotation = rows.try_into().map_err(|_| Failure::bug("a rotation"))?;
        let distortion = distortion.unwrap_or_else(|| vec![0.0; 4]);
        let lens = Lens::from_coefficients(fisheye, &distortion).map_err(|expected| {
            Failure::argument(format!("`distortion` has {} coefficients; expected {expected}", distortion.len()))
        })?;
        let (intrinsics, translation) = (Intrinsics { fx, fy, cx, cy }, fixed("translation", translation)?);
        let camera = Camera { name, image_size_px, intrinsics, lens, rotation, translation };
        camera.validate().map_err(Failure::from)?;
        Ok(Self(camera))
    }

    /// A camera without distortion at `position` that looks at `target` (world, metres, z up), its image upright.
    #[staticmethod]
    #[pyo3(signature = (name, position, target, *, image_size_px, focal_px))]
    fn look_at(
        name: &str,
        position: &Bound<'_, PyAny>,
        target: &Bound<'_, PyAny>,
        image_size_px: &Bound<'_, PyAny>,
        focal_px: f64,
    ) -> PyResult<Self> {
        let (position, target) = (fixed("position", position)?, fixed("target", target)?);
        let camera = Camera::look_at(name, fixed("image_size_px", image_size_px)?, focal_px, position, target);
        Ok(Self(camera.map_err(Failure::from)?))
    }

    /// Name, as the calibration gives it.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// Image width and height, pixels.
    #[getter]
    fn image_size_px(&self) -> (f64, f64) {
        self.0.image_size_px.into()
    }

    /// Focal lengths (fx, fy), pixels.
    #[getter]
    fn focal_px(&self) -> (f64, f64) {
        (self.0.intrinsics.fx, self.0.intrinsics.fy)
    }

    /// Principal point (cx, cy), pixels.
    #[getter]
    fn centre_px(&self) -> (f64, f64) {
        (self.0.intrinsics.cx, self.0.intrinsics.cy)
    }

    /// Coefficients of the lens in OpenCV's order.
    #[getter]
    fn distortion(&self) -> Vec<f64> {
        self.0.lens.coefficients()
    }

    /// Whether the lens is a fisheye.
    #[getter]
    fn fisheye(&self) -> bool {
        self.0.lens.is_fisheye()
    }

    /// Rotation from the world to the camera, (3, 3).
    #[getter]
    fn rotation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        array(py, [3, 3], self.0.rotation.concat())
    }

    /// Translation from the world to the camera, (3,), metres.
    #[getter]
    fn translation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        array(py, [3], self.0.translation.to_vec())
    }

    /// Place of the camera in the world, (3,), metres.
    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        array(py, [3], self.0.centre().to_vec())
    }

    /// The matrix K [R | t] of the camera with a perfect lens, (3, 4).
    #[getter]
    fn matrix<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        array(py, [3, 4], self.0.matrix().concat())
    }

    /// Pixels of world points.
    ///
    /// Parameters
    /// ----------
    /// points
    ///     (..., 3), metres.
    ///
    /// Returns
    /// -------
    /// (..., 2), pixels, lens included; NaN behind the camera and beyond the domain of the lens.
    fn project<'py>(&self, py: Python<'py>, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let points = numbers("points", points)?;
        let leading = points.leading(&[("3", Some(3))])?;
        let (at, _) = points.values()?.as_chunks::<3>();
        let pixels = detached(py, || {
            let mut pixels = room(&[at.len(), 2])?;
            for (pixel, point) in pixels.as_chunks_mut::<2>().0.iter_mut().zip(at) {
                *pixel = self.0.project(*point).pixel().unwrap_or([f64::NAN; 2]);
            }
            Ok(pixels)
        })?;
        array(py, shaped(leading, &[2]), pixels)
    }

    /// Pixels of world points and their derivatives by the points.
    ///
    /// Parameters
    /// ----------
    /// points
    ///     (..., 3), metres.
    ///
    /// Returns
    /// -------
    /// Pixels (..., 2) and derivatives (..., 2, 3) in pixels per metre; NaN where there is no pixel.
    fn project_with_jacobian<'py>(&self, py: Python<'py>, points: &Bound<'py, PyAny>) -> PyResult<Two<'py>> {
        let points = numbers("points", points)?;
        let leading = points.leading(&[("3", Some(3))])?;
        let (at, _) = points.values()?.as_chunks::<3>();
        let (pixels, jacobians) = detached(py, || {
            let mut results = (room(&[at.len(), 2])?, room(&[at.len(), 6])?);
            let out = results.0.as_chunks_mut::<2>().0.iter_mut().zip(results.1.as_chunks_mut::<6>().0);
            for ((pixel, rows), point) in out.zip(at) {
                let found = self.0.project_with_jacobian(*point);
                let (found, by_point) = found.unwrap_or(([f64::NAN; 2], [[f64::NAN; 3]; 2]));
                *pixel = found;
                rows.copy_from_slice(by_point.as_flattened());
            }
            Ok(results)
        })?;
        let pixels = array(py, shaped(leading, &[2]), pixels)?;
        Ok((pixels, array(py, shaped(leading, &[2, 3]), jacobians)?))
    }

    /// Pixels that a perfect lens would have shown.
    ///
    /// Parameters
    /// ----------
    /// pixels
    ///     (..., 2), observed.
    ///
    /// Returns
    /// -------
    /// (..., 2), pixels; NaN where the lens shows no ray.
    fn undistort<'py>(&self, py: Python<'py>, pixels: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let pixels = numbers("pixels", pixels)?;
        let leading = pixels.leading(&[("2", Some(2))])?;
        let (at, _) = pixels.values()?.as_chunks::<2>();
        let ideal = detached(py, || {
            let mut ideal = room(&[at.len(), 2])?;
            for (out, pixel) in ideal.as_chunks_mut::<2>().0.iter_mut().zip(at) {
                *out = self.0.undistort(*pixel).unwrap_or([f64::NAN; 2]);
            }
            Ok(ideal)
        })?;
        array(py, shaped(leading, &[2]), ideal)
    }

    /// Arguments that make the same camera.
    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<(CameraArguments<'py>, Bound<'py, PyDict>)> {
        let options = PyDict::new(py);
        options.set_item("centre_px", self.centre_px())?;
        options.set_item("distortion", self.distortion())?;
        options.set_item("fisheye", self.fisheye())?;
        let (rotation, translation) = (self.rotation(py)?, self.translation(py)?);
        Ok(((self.name().to_owned(), self.image_size_px(), self.focal_px(), rotation, translation), options))
    }

    fn __repr__(&self) -> String {
        let ([width, height], [x, y, z]) = (self.0.image_size_px, self.0.centre());
        format!("Camera({:?}: {width} x {height} px at ({x:.3}, {y:.3}, {z:.3}) m)", self.0.name)
    }
}
