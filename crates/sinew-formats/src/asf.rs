//! ASF: the skeleton of an Acclaim recording, for which [`amc`](crate::amc) holds the motion.
//!
//! Each bone has a direction and a length in the rest pose (global axes), an axis frame, and degrees of freedom. With
//! `XYZ(a, b, c) = R_z(c) R_y(b) R_x(a)` (turn about fixed x first), `C` the matrix of the bone's axis and `M` that of its
//! degrees of freedom (missing ones 0):
//!
//! ```text
//! R = R_parent C M C⁻¹,        end = start + R · length · direction
//! ```
//!
//! Lengths and root translations are in file units: `:units length 0.45` means 1 unit = 1/0.45 inch, so that metres =
//! value · 0.0254 / 0.45 in the files of the CMU Graphics Lab Motion Capture Database. Degrees of freedom other than
//! rotations are refused.
//!
//! ```
//! # let text = ":units\n length 0.45\n angle deg\n:root\n order TX TY TZ RX RY RZ\n axis XYZ\n position 0 0 0\n orientation 0 0 0\n\
//! # :bonedata\n begin\n id 1\n name thigh\n direction 0 -1 0\n length 7\n axis 0 0 20 XYZ\n dof rx\n limits (-10.0 170.0)\n end\n\
//! # :hierarchy\n begin\n root thigh\n end\n";
//! let skeleton = sinew_formats::asf::read("07.asf", text)?;
//! assert_eq!(skeleton.bones[0].name, "thigh");
//! assert!((skeleton.metres_per_unit() - 0.0564444).abs() < 1e-7);
//! # Ok::<(), sinew_formats::Error>(())
//! ```

mod parser;
mod skeleton;

pub use parser::read;
pub use skeleton::{Asf, AsfBone, RootChannel};
