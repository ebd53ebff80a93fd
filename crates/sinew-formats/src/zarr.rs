//! Zarr stores (format 3) of draws, as ArviZ and xarray open them: groups, named dimensions, streamed frame by frame.
//!
//! - A [`Schema`] names the labels of every dimension and the variables of every group. Each dimension of a group gets a
//!   coordinate of the same name; `frame` grows while the [`Writer`] streams, with the coordinates `frame` (number) and
//!   `time` (seconds), and every variable over it carries the attribute `coordinates = "time"`, without which xarray takes
//!   `time` for a variable.
//! - Arrays are cut into regular chunks of [`CHUNK_FRAMES`] frames, the last one padded with the fill value (NaN for
//!   numbers with a point; a store of fewer frames has one chunk of these alone), keys like `posterior/angle/c.0.0.3.0`, codec `bytes` little-endian, no compression. Strings
//!   are data type `string`, codec `vlen-utf8`: u32 count, then u32 length and bytes of each.
//! - Chunks are written as they fill, and metadata with the shape so far after each of them: a killed run is readable up
//!   to the last chunk. [`Writer::finish`] writes the rest and copies all metadata into the root's
//!   `consolidated_metadata`.
//!
//! No file is opened here: whoever does implements [`Store`] for a folder. [`inference_data`] holds the attributes and
//! groups of the InferenceData schema.
//!
//! Source: Zarr core specification 3.1, <https://zarr-specs.readthedocs.io>; consolidated metadata as zarr-python writes
//! it.
//!
//! ```
//! use sinew_formats::zarr::{DataType, Group, Labels, MemoryStore, Schema, FrameValues, Variable, Writer};
//! let mut schema = Schema::default();
//! schema.dimensions.insert("draw".into(), Labels::Count(2));
//! let mut posterior = Group::new("posterior");
//! posterior.variables.push(Variable::new("angle", &["draw", "frame"], DataType::Float32));
//! schema.groups.push(posterior);
//!
//! let mut writer = Writer::create(MemoryStore::default(), schema)?;
//! writer.push(0, 0.0, &[FrameValues::Numbers(&[0.5, 0.25])])?;
//! let store = writer.finish()?;
//! assert_eq!(store.0["posterior/angle/c.0.0"].len(), 2 * 4);
//! # Ok::<(), std::io::Error>(())
//! ```

pub mod inference_data;
mod metadata;
pub mod reader;
mod schema;
mod writer;

pub use schema::{
    CHUNK_FRAMES, Constant, DataType, FRAME, FrameValues, Group, Labels, MemoryStore, Schema, Store, Variable,
};
pub use writer::Writer;
