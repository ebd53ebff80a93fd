//! What is shown of recordings and results: it reads files and folders, never a run.
//!
//! | module | what |
//! |---|---|
//! | [`mod@page`] | one HTML page that shows a result |
//! | [`written_page`] | the page, written into a result folder |
//! | [`overlay`] | pictures of results over the images |
//! | [`inspect`] | what a file or folder holds, and whether calibration and keypoints fit |

mod error;
pub mod inspect;
pub mod overlay;
pub mod page;
pub mod written_page;

pub use error::Error;
