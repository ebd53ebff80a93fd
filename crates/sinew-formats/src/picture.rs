//! Pictures of a camera: PNG or JPEG, distinguished by their first bytes.
//!
//! Grey pictures become colour ones of equal channels, palettes are looked up, an alpha channel is left out, and of 16 bits a sample the upper eight are taken.
//! A JPEG that is cut or damaged is refused, although parts of it could be shown.
//!
//! ```
//! use sinew_formats::picture;
//! use sinew_observe::RgbImage;
//! let image = RgbImage { width: 2, height: 1, pixels: vec![[10, 20, 30], [255, 0, 7]] };
//! let mut file = Vec::new();
//! picture::write_png(&mut file, &image)?;
//! assert_eq!(picture::read("cam01_0034.png", &file)?, image);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::png_file::{self, Samples};
use crate::{Error, Place};
use sinew_observe::RgbImage;
use std::io::{self, Write};
use zune_jpeg::JpegDecoder;
use zune_jpeg::errors::DecodeErrors;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// Largest picture file that is read.
pub const MAX_BYTES: u64 = 256 << 20;

/// Pixels that a byte of a JPEG can stand for: a block of 64 takes at least one bit.
const MAX_PIXELS_A_BYTE: u64 = 512;

/// Reads a picture.
///
/// # Errors
/// Files that are neither PNG nor JPEG, cut or damaged; more than 2²⁶ pixels or more than the file can hold; JPEGs of four colours or with arithmetic coding.
pub fn read(name: &str, bytes: &[u8]) -> Result<RgbImage, Error> {
    if bytes.starts_with(&png_file::SIGNATURE[..4]) {
        return Ok(from_samples(png_file::read(name, bytes)?));
    }
    if bytes.starts_with(b"\xFF\xD8\xFF") {
        return read_jpeg(name, bytes);
    }
    Err(Place::file(name).syntax("neither PNG nor JPEG", "a picture of one of them"))
}

fn from_samples(samples: Samples) -> RgbImage {
    let Samples { width, height, channels, values, palette, .. } = samples;
    let pixels = match palette {
        Some(palette) => {
            values.iter().map(|&index| palette.get(usize::from(index)).copied().unwrap_or_default()).collect()
        }
        None if channels < 3 => values.iter().step_by(channels).map(|&grey| [grey; 3]).collect(),
        None => values.chunks_exact(channels).filter_map(|pixel| pixel.first_chunk::<3>().copied()).collect(),
    };
    RgbImage { width, height, pixels }
}

fn read_jpeg(name: &str, bytes: &[u8]) -> Result<RgbImage, Error> {
    let broken = |error: &DecodeErrors| {
        let place = Place::file(name);
        match error {
            DecodeErrors::ExhaustedData | DecodeErrors::IoErrors(_) => {
                Error::Truncated { place, inside: "the pixels", offset: bytes.len(), line: None }
            }
            error => place.syntax(error.to_string(), "a whole JPEG file"),
        }
    };
    let options = DecoderOptions::default()
        .set_strict_mode(true)
        .set_max_width(usize::from(u16::MAX))
        .set_max_height(usize::from(u16::MAX))
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|error| broken(&error))?;
    let (width, height) = decoder.dimensions().unwrap_or_default();
    png_file::check_pixels(name, width as u32, height as u32)?;
    let claimed = width as u64 * height as u64;
    let held = bytes.len() as u64;
    if claimed > MAX_PIXELS_A_BYTE * held {
        return Err(Error::ImpossibleCount { place: Place::file(name), claimed, unit: "pixels", bytes: held });
    }
    let values = decoder.decode().map_err(|error| broken(&error))?;
    let (pixels, rest) = values.as_chunks::<3>();
    if pixels.len() as u64 != claimed || !rest.is_empty() {
        let found = decoder
            .input_colorspace()
            .map_or_else(String::new, |space| format!(" of {} colours", space.num_components()));
        return Err(Error::Unsupported { place: Place::file(name), what: format!("a JPEG{found}") });
    }
    Ok(RgbImage { width, height, pixels: pixels.to_vec() })
}

/// Writes a picture as PNG, which keeps every bit. The same picture gives the same bytes.
///
/// # Errors
/// What the stream refuses; a picture without pixels, or with another number of them than its size says.
pub fn write_png(out: &mut impl Write, image: &RgbImage) -> io::Result<()> {
    let data = image.pixels.as_flattened();
    png_file::write(out, [image.width, image.height], png::ColorType::Rgb, png::BitDepth::Eight, data)
}
