//! TRC: trajectories of named points, as OpenSim and Pose2Sim exchange them.
//!
//! ```text
//! PathFileType  4  (X/Y/Z)  markers.trc
//! DataRate  CameraRate  NumFrames  NumMarkers  Units  OrigDataRate  OrigDataStartFrame  OrigNumFrames
//! 60  60  0000000100  2  m  60  1  0000000100
//! Frame#  Time  RHip  .  .  RKnee  .  .
//! .  .  X1  Y1  Z1  X2  Y2  Z2
//!
//! 1  0.0  -0.06497  0.9015  -1.40059  -0.03962  0.49309  -1.44852
//! ```
//!
//! Columns are separated by tabs (a dot above is an empty cell). The axes are Y up: (X, Y, Z) = (y, z, x) of the world,
//! see [`trc_from_world`]. This module keeps axes and units of the file.
//!
//! Quirks that are read: empty cells and `NaN` (the point is missing), CRLF, no blank line 6, names with spaces, labels
//! that do not start at X1, spaces for tabs (names cannot have spaces then), header counts that disagree, `mm` and `cm`.
//!
//! Written are `NaN`, never an empty cell (a row that ends in empty cells makes OpenSim 4.6 reject the file), and frame
//! counts of ten digits, so that the header can be written again over itself once the number of frames is known. They
//! have leading zeros rather than blanks, because many readers split the header at any blank.
//!
//! ```
//! use sinew_formats::trc;
//! let header = trc::Header::new("markers.trc", 60.0, vec!["RHip".into()]);
//! let mut file = Vec::new();
//! trc::write_header(&mut file, &header, 1)?;
//! trc::write_frame(&mut file, 1, 0.0, &[Some(trc::trc_from_world([1.0, 2.0, 3.0]))])?;
//! let read = trc::read("markers.trc", std::str::from_utf8(&file).unwrap())?;
//! assert_eq!(read.frames[0].points[0], Some([2.0, 3.0, 1.0]));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod reader;
mod table;
mod writer;

pub use reader::read;
pub use table::{Header, Trc, TrcFrame, Units, trc_from_world, world_from_trc};
pub use writer::{write, write_frame, write_header};
