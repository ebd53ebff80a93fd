//! What the fuzz targets call: one check per reader of `sinew-formats`.

pub mod checks;

use sinew_formats as formats;
