//! Masks: PNG images that say which pixels show a person.
//!
//! One channel of 1, 2, 4 or 8 bits, or a palette. Quirks that are ordinary input:
//!
//! - 0 and any one other value (1, 255, a label): what is not 0 is the person.
//! - More values than two: those from 128 on are the person, the others not; [`Mask::between`] counts what is neither 0 nor 255. Where all are below 128 they
//!   are labels of several things, and refused.
//! - Three channels, or four of which alpha is opaque everywhere: taken as one where they are equal everywhere, else refused.
//! - A palette: its brightness where the colours in use are grey, else its indices, of which 0 is the background.
//!
//! A mask is written with one bit a pixel.
//!
//! ```
//! use sinew_formats::mask;
//! use sinew_observe::silhouettes::bit_image::BitImage;
//! let image = BitImage::from_fn(70, 40, |x, y| x > 20 && x < 50 && y > 10);
//! let mut file = Vec::new();
//! mask::write(&mut file, &image)?;
//! assert_eq!(mask::read("cam01_0034.png", &file)?.image, image);
//! let error = mask::read("cam01_0034.png", &file[..60]).unwrap_err();
//! assert_eq!(error.to_string(), "cam01_0034.png: ends inside the pixels at byte 60");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::png_file::{self, Samples};
use crate::{Error, Place};
use sinew_observe::silhouettes::bit_image::BitImage;
use std::io::{self, Write};

/// Largest mask file that is read.
pub const MAX_BYTES: u64 = 64 << 20;

/// Value from which on a pixel is the person's where there are more than two.
pub const THRESHOLD: u8 = 128;

/// A mask, and what is odd about its file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mask {
    /// The pixels of the person.
    pub image: BitImage,
    /// Channels of the file, all equal if several.
    pub channels: usize,
    /// Pixels that are neither 0 nor 255 where there are more values than two, else 0.
    pub between: u64,
}

/// Reads a mask.
///
/// # Errors
/// Files that are no PNG, cut or damaged; more than 2²⁶ pixels or more than the file can hold; 16 bits a sample; colours, transparency and labels of several
/// things, as described above.
pub fn read(name: &str, bytes: &[u8]) -> Result<Mask, Error> {
    let samples = png_file::read(name, bytes)?;
    if samples.bits > 8 {
        let what = format!("a mask of {} bits a sample", samples.bits);
        return Err(Error::Unsupported { place: Place::file(name), what });
    }
    let Samples { width, height, channels, .. } = samples;
    let values = one_channel(name, samples)?;
    let mut counts = [0_u64; 256];
    for &value in &values {
        counts[usize::from(value)] += 1;
    }
    let levels: Vec<u8> = (0..=u8::MAX).filter(|&level| counts[usize::from(level)] > 0).collect();
    let lit = levels.iter().filter(|&&level| level > 0).count();
    if lit > 1 && levels.iter().all(|&level| level < THRESHOLD) {
        return Err(Error::MaskLevels { place: Place::file(name), levels });
    }
    let from = if lit > 1 { THRESHOLD } else { 1 };
    let between = if lit > 1 { counts[1..255].iter().sum() } else { 0 };
    let image = BitImage::from_fn(width, height, |x, y| values[y * width + x] >= from);
    Ok(Mask { image, channels, between })
}

/// The one value of each pixel.
fn one_channel(name: &str, samples: Samples) -> Result<Vec<u8>, Error> {
    let Samples { width, channels, values, palette, .. } = samples;
    if let Some(palette) = palette {
        let brightness = |index: u8| {
            let color = palette.get(usize::from(index)).copied().unwrap_or_default();
            (color[0] == color[1] && color[1] == color[2]).then_some(color[0])
        };
        let grey: Option<Vec<u8>> = values.iter().map(|&index| brightness(index)).collect();
        return Ok(grey.unwrap_or(values));
    }
    let colors = if channels < 3 { 1 } else { 3 };
    let odd = values.chunks_exact(channels).position(|pixel| {
        let (color, alpha) = pixel.split_at(colors);
        color.iter().any(|value| *value != color[0]) || alpha.iter().any(|alpha| *alpha < u8::MAX)
    });
    if let Some(pixel) = odd {
        let shown: Vec<String> = values[pixel * channels..][..channels].iter().map(u8::to_string).collect();
        let (x, y) = (pixel % width, pixel / width);
        let differ = if channels == 3 { "that differ" } else { "that differ or are not opaque" };
        let found = format!("{channels} channels {differ} at pixel ({x}, {y}): {}", shown.join(", "));
        return Err(Error::MaskChannels { place: Place::file(name), found });
    }
    Ok(if channels == 1 { values } else { values.into_iter().step_by(channels).collect() })
}

/// Writes a mask with one bit a pixel: 1 for the person. The same mask gives the same bytes.
///
/// # Errors
/// What the stream refuses; a mask without pixels or with more than 2³¹ in a row or column.
pub fn write(out: &mut impl Write, image: &BitImage) -> io::Result<()> {
    let (width, height) = (image.width(), image.height());
    let mut packed = Vec::with_capacity(width.div_ceil(8) * height);
    for y in 0..height {
        for first in (0..width).step_by(8) {
            packed.push((first..first + 8).fold(0, |byte, x| byte << 1 | u8::from(image.get(x, y))));
        }
    }
    png_file::write(out, [width, height], png::ColorType::Grayscale, png::BitDepth::One, &packed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use png::{BitDepth, ColorType};

    fn file(width: usize, color: ColorType, depth: BitDepth, data: &[u8]) -> Vec<u8> {
        let mut out = Vec::new();
        png_file::write(&mut out, [width, 1], color, depth, data).unwrap();
        out
    }

    fn indexed(palette: &[u8], data: &[u8]) -> Vec<u8> {
        let mut out = Vec::new();
        let mut encoder = png::Encoder::new(&mut out, 4, 1);
        encoder.set_color(ColorType::Indexed);
        encoder.set_depth(BitDepth::Two);
        encoder.set_palette(palette);
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        out
    }

    fn check(file: &[u8], wanted: &str, between: u64) {
        let mask = read("a.png", file).unwrap();
        let found: String = (0..mask.image.width()).map(|x| if mask.image.get(x, 0) { '#' } else { '.' }).collect();
        assert_eq!((found.as_str(), mask.between), (wanted, between));
    }

    fn refused(file: &[u8], words: &str) {
        assert_eq!(read("a.png", file).unwrap_err().to_string(), format!("a.png: {words}"));
    }

    #[test]
    fn two_values_of_any_kind() {
        let grey = |data: &[u8]| file(data.len(), ColorType::Grayscale, BitDepth::Eight, data);
        check(&grey(&[0, 255, 255, 0]), ".##.", 0);
        check(&grey(&[0, 1, 1, 0]), ".##.", 0);
        check(&grey(&[0, 38, 38, 0]), ".##.", 0);
        check(&grey(&[0, 0]), "..", 0);
        check(&grey(&[1, 1]), "##", 0);
        check(&file(4, ColorType::Grayscale, BitDepth::One, &[0b0110_0000]), ".##.", 0);
        check(&file(4, ColorType::Grayscale, BitDepth::Two, &[0b0001_0100]), ".##.", 0);
    }

    #[test]
    fn more_values() {
        let grey = |data: &[u8]| file(data.len(), ColorType::Grayscale, BitDepth::Eight, data);
        check(&grey(&[0, 127, 128, 255]), "..##", 2);
        refused(&grey(&[0, 1, 2]), "values 0, 1, 2; a mask has two, 0 and 255");
        refused(&grey(&[0, 1, 2, 3, 4, 5, 6]), "values 0, 1, 2, 3, 4 and 2 more; a mask has two, 0 and 255");
        let deep = file(2, ColorType::Grayscale, BitDepth::Sixteen, &[0, 0, 0, 1]);
        refused(&deep, "a mask of 16 bits a sample is not supported");
    }

    #[test]
    fn more_channels() {
        check(&file(2, ColorType::Rgb, BitDepth::Eight, &[255, 255, 255, 0, 0, 0]), "#.", 0);
        check(&file(2, ColorType::Rgba, BitDepth::Eight, &[9, 9, 9, 255, 0, 0, 0, 255]), "#.", 0);
        check(&file(2, ColorType::GrayscaleAlpha, BitDepth::Eight, &[255, 255, 0, 255]), "#.", 0);
        let color = file(2, ColorType::Rgb, BitDepth::Eight, &[1, 1, 1, 12, 200, 40]);
        refused(&color, "3 channels that differ at pixel (1, 0): 12, 200, 40; a mask has one channel");
        let clear = file(1, ColorType::GrayscaleAlpha, BitDepth::Eight, &[255, 7]);
        refused(&clear, "2 channels that differ or are not opaque at pixel (0, 0): 255, 7; a mask has one channel");
    }

    #[test]
    fn palettes() {
        check(&indexed(&[255, 255, 255, 0, 0, 0], &[0b0001_0100]), "#..#", 0);
        check(&indexed(&[0, 0, 0, 128, 0, 0], &[0b0001_0100]), ".##.", 0);
        let labels = indexed(&[0, 0, 0, 128, 0, 0, 0, 128, 0], &[0b0001_1000]);
        refused(&labels, "values 0, 1, 2; a mask has two, 0 and 255");
    }

    #[test]
    fn damaged_files() {
        let whole = file(4, ColorType::Grayscale, BitDepth::One, &[0b0110_0000]);
        for end in 0..whole.len() {
            let error = read("a.png", &whole[..end]).unwrap_err();
            assert!(matches!(error, Error::Truncated { offset, line: None, .. } if offset == end), "{end}: {error}");
        }
        refused(b"\xFF\xD8\xFF\xE0", "a JPEG file; expected a whole PNG file");
        refused(b"P4 1 1", "no PNG file; expected a whole PNG file");
        let mut claims = whole.clone();
        claims[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]);
        assert!(read("a.png", &claims).is_err());
        let mut harmed = whole;
        let last = harmed.len() - 13;
        harmed[last] ^= 1;
        assert!(matches!(read("a.png", &harmed), Err(Error::Syntax { .. })));
    }

    #[test]
    fn claims_are_checked_before_memory_is_taken() {
        let claiming = |width: u32, height: u32| {
            let mut out = Vec::new();
            let mut encoder = png::Encoder::new(&mut out, width, height);
            encoder.set_depth(BitDepth::Eight);
            drop(encoder.write_header());
            out.truncate(33);
            out.extend(*b"\0\0\0\0IDAT\x35\xaf\x06\x1e\0\0\0\0IEND\xae\x42\x60\x82");
            out
        };
        refused(&claiming(100_000, 100_000), "the image has 100000 x 100000 pixels; at most 67 108 864 are read");
        refused(&claiming(8000, 8000), "file claims 64 000 000 bytes of pixels, holds 57 bytes");
    }
}
