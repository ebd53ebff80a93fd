//! Lenses: where a camera shows a ray, and which rays it can show.
//!
//! A ray is given by its normalised coordinates (x, y) = (X/Z, Y/Z), where a lens without distortion shows it; r² = x² + y². [`Lens::distorted`] says where a lens shows it, in the same units. Every lens has a
//! domain: beyond [`Lens::valid_radius`] two rays would share a pixel, and fitted coefficients mean nothing. What lies beyond has no image, neither for a camera nor for a likelihood.
//!
//! | lens | model | coefficients in `Calib.toml`, ordered as in OpenCV |
//! |---|---|---|
//! | [`Brown`] | radial polynomial and decentring | k1 k2 p1 p2 \[k3\] |
//! | [`Rational`] | quotient of radial polynomials and decentring | k1 k2 p1 p2 k3 k4 k5 k6 |
//! | [`Fisheye`] | polynomial of the angle from the axis | k1 k2 k3 k4, with `fisheye = true` |
//!
//! Each is written once, over lanes, and is a file of this folder and a line of the list of lenses below.
//!
//! ```
//! use sinew_observe::cameras::lens::{Brown, Lens};
//! let barrel = Lens::from(Brown { k1: -0.3, ..Brown::default() });
//! let shown = barrel.distorted([0.5, 0.0]).unwrap();
//! assert!((shown[0] - 0.5 * (1.0 - 0.3 * 0.25)).abs() < 1e-15);
//! assert!((barrel.undistorted(shown).unwrap()[0] - 0.5).abs() < 1e-12);
//! assert_eq!(barrel.distorted([1.1, 0.0]), None); // the polynomial falls from r = 1.054 on
//! ```

mod inverse;
mod model;
mod polynomial;

pub(crate) use model::Distort;
use model::{DistortionModel, Image};
use sinew_core::lanes::{Isa, Kernel, Real, dispatch_one};

/// Makes [`Distortion`] of the list of lenses.
macro_rules! lenses {
    ($($(#[$doc:meta])* $name:ident in $module:ident;)+) => {
        $(mod $module; pub use $module::$name;)+

        /// A model of distortion with its coefficients.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Distortion { $($(#[$doc])* $name($name)),+ }

        $(impl From<$name> for Lens {
            fn from(lens: $name) -> Self {
                Self { distortion: Distortion::$name(lens), valid_radius: lens.valid_radius() }
            }
        })+

        impl Distortion {
            fn coefficients(&self) -> Vec<f64> {
                match self { $(Self::$name(lens) => lens.coefficients()),+ }
            }

            const fn is_fisheye(&self) -> bool {
                match self { $(Self::$name(_) => $name::IS_FISHEYE),+ }
            }

            fn radius_after(&self, radius: f64) -> f64 {
                match self { $(Self::$name(lens) => lens.radius_after(radius)),+ }
            }
        }

        impl Distort for Distortion {
            #[inline(always)]
            fn image<V: Real, const DERIVATIVE: bool>(&self, at: [V; 2], square: V) -> Image<V> {
                match self { $(Self::$name(lens) => lens.image::<V, DERIVATIVE>(at, square)),+ }
            }
        }

        impl Lens {
            /// The lens that `Calib.toml` describes by these `distortions`.
            ///
            /// # Errors
            /// Where no such lens has that number of coefficients: how many there may be, and which.
            pub fn from_coefficients(is_fisheye: bool, coefficients: &[f64]) -> Result<Self, String> {
                let mut expected: Vec<&str> = vec![];
                $(if $name::IS_FISHEYE == is_fisheye {
                    if let Some(lens) = $name::from_coefficients(coefficients) {
                        return Ok(lens.into());
                    }
                    expected.push($name::COEFFICIENTS);
                })+
                Err(expected.join(", or "))
            }
        }
    };
}

lenses! {
    /// Radial polynomial and decentring.
    Brown in brown;
    /// Quotient of radial polynomials and decentring.
    Rational in rational;
    /// Polynomial of the angle from the axis.
    Fisheye in fisheye;
}

/// A lens: its distortion and the domain of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    distortion: Distortion,
    valid_radius: f64,
}

impl Default for Lens {
    /// A lens without distortion.
    fn default() -> Self {
        Brown::default().into()
    }
}

impl Lens {
    /// The model with its coefficients.
    #[must_use]
    pub const fn distortion(&self) -> &Distortion {
        &self.distortion
    }

    /// Coefficients in OpenCV's order.
    #[must_use]
    pub fn coefficients(&self) -> Vec<f64> {
        self.distortion.coefficients()
    }

    /// Whether `Calib.toml` marks it by `fisheye = true`.
    #[must_use]
    pub const fn is_fisheye(&self) -> bool {
        self.distortion.is_fisheye()
    }

    /// Whether nothing is distorted.
    #[must_use]
    pub fn is_perfect(&self) -> bool {
        self.distortion == Distortion::Brown(Brown::default())
    }

    /// Radius in normalised coordinates, before the lens, up to which it is one-to-one; infinite where it always is.
    #[must_use]
    pub const fn valid_radius(&self) -> f64 {
        self.valid_radius
    }

    /// Whether the lens shows a point.
    #[must_use]
    pub fn shows(&self, [x, y]: [f64; 2]) -> bool {
        x * x + y * y <= self.valid_radius * self.valid_radius
    }

    /// Where the lens shows a point; `None` beyond its domain.
    #[must_use]
    pub fn distorted(&self, at: [f64; 2]) -> Option<[f64; 2]> {
        self.shows(at).then(|| self.extended::<false>(at).0)
    }

    /// Where the lens shows a point, and the derivative of that by the point, rows x_d and y_d; `None` beyond its domain.
    #[must_use]
    pub fn distorted_with_derivative(&self, at: [f64; 2]) -> Option<([f64; 2], [[f64; 2]; 2])> {
        self.shows(at).then(|| self.extended::<true>(at))
    }

    /// The same on the whole plane, beyond the domain without a meaning.
    fn extended<const DERIVATIVE: bool>(&self, at: [f64; 2]) -> ([f64; 2], [[f64; 2]; 2]) {
        if self.is_perfect() {
            return (at, [[1.0, 0.0], [0.0, 1.0]]);
        }
        let mut out = ([0.0; 2], [[0.0; 2]; 2]);
        dispatch_one(Isa::baseline(), AtOne::<DERIVATIVE> { distortion: &self.distortion, at, out: &mut out });
        out
    }
}

/// The code of the lanes on one point.
struct AtOne<'a, const DERIVATIVE: bool> {
    distortion: &'a Distortion,
    at: [f64; 2],
    out: &'a mut ([f64; 2], [[f64; 2]; 2]),
}

impl<const DERIVATIVE: bool> Kernel<f64> for AtOne<'_, DERIVATIVE> {
    #[inline(always)]
    fn run<V: Real<Mem = f64>>(&mut self) {
        let [x, y] = [V::load(&self.at[0]), V::load(&self.at[1])];
        let image = self.distortion.image::<V, DERIVATIVE>([x, y], y.fma(y, x * x));
        for row in 0..2 {
            image.at[row].store(&mut self.out.0[row]);
            for column in 0..2 {
                image.derivative[row][column].store(&mut self.out.1[row][column]);
            }
        }
    }
}
