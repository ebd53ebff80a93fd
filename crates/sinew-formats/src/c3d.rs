//! C3D: points, analog channels and events of a motion laboratory, in binary blocks of 512 bytes.
//!
//! ```text
//! block 1    header: where the other sections are, points and samples of a frame, first and last frame, scale, rate
//! block 2 …  parameters in groups: POINT (LABELS, UNITS, RATE, …), ANALOG, EVENT, TRIAL, …
//! then       frames: X, Y, Z and a fourth number of each point, then analog samples
//! ```
//!
//! The format is described in *The C3D File Format: A Technical User Guide* (Motion Lab Systems, 2021). Read are files of
//! all three processors (Intel, DEC, MIPS), of words and of reals, with frame counts above 65 535, labels that continue
//! in LABELS2 …, and events of the header and of the group EVENT. Points keep axes and units of the file;
//! [`C3d::point_in_world`] turns the axis up that POINT:Y_SCREEN names. A point is missing where its fourth number is
//! negative. Analog samples are scaled. What the reader does not use is in [`C3d::groups`].
//!
//! Results of models that a file has among its points, as angles and forces, are named by [`C3d::are_positions`].
//!
//! Where header and parameters disagree, the header says how frames are laid out and the parameters what they mean.
//!
//! A file that was read is written again with all that it holds, for Intel and of reals ([`write_whole`]). Of other
//! motions points are written alone, as reals for Intel with scale −1, axes and units as in TRC files
//! ([`trc_from_world`](crate::trc::trc_from_world)): the fourth number is 0 (no residual was measured), or −1 for a
//! missing point, whose position is 0. The header and the parameters have a fixed length, so that they can be written
//! again over themselves once the number of frames is known.
//!
//! ```
//! use sinew_formats::{c3d, trc};
//! let header = c3d::C3dHeader::new(59.94, vec!["RHip".into(), "Nose".into()]);
//! let mut file = Vec::new();
//! c3d::write_header(&mut file, &header, 1)?;
//! c3d::write_frame(&mut file, &[Some(trc::trc_from_world([1.0, 2.0, 3.0])), None])?;
//! c3d::write_end(&mut file, &header, 1)?;
//! let read = c3d::read("markers.c3d", &file)?;
//! assert_eq!((read.header.rate_hz, &read.header.markers[1][..]), (59.94, "Nose"));
//! assert_eq!((read.point_in_world(0, 0), read.point_in_world(0, 1)), (Some([1.0, 2.0, 3.0]), None));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod events;
mod frame_range;
mod frames;
mod header;
mod parameter_records;
mod parameters;
mod processor;
mod quantities;
mod reader;
mod recording;
mod screen_axes;
mod source;
mod whole_file;
mod writer;
mod written_parameters;

pub use events::C3dEvent;
pub use parameters::{C3dGroup, C3dParameter, C3dValues, find};
pub use processor::Processor;
pub use reader::read;
pub use recording::{Analog, AnalogChannel, C3d, C3dHeader, C3dPoint};
pub use screen_axes::ScreenAxis;
pub use whole_file::write_whole;
pub use writer::{write, write_end, write_frame, write_header};
