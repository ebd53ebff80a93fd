//! Writes masks and pictures as PNG (Portable Network Graphics, third edition).
//!
//! A mask is a grey image of one bit a pixel, 1 (which readers show as 255) where the person is; a picture has 8 bits for each of red, green and blue.
//!
//! ```
//! let mut file = Vec::new();
//! sinew_formats::mask_png::write_mask(&mut file, [3, 2], |x, y| x == 2 && y == 0)?;
//! assert_eq!(&file[1..4], b"PNG");
//! # Ok::<(), std::io::Error>(())
//! ```

use std::io::{self, Write};

/// Writes a mask of the given width and height; `is_person` is asked for column and row.
///
/// # Errors
/// Those of the stream; [`io::ErrorKind::InvalidInput`] for an image without pixels.
pub fn write_mask(out: &mut impl Write, size: [usize; 2], is_person: impl Fn(usize, usize) -> bool) -> io::Result<()> {
    let [width, height] = size;
    let mut bytes = Vec::with_capacity(width.div_ceil(8) * height);
    for y in 0..height {
        for first in (0..width).step_by(8) {
            let bit = |k: usize| first + k < width && is_person(first + k, y);
            bytes.push((0..8).fold(0, |byte, k| byte << 1 | u8::from(bit(k))));
        }
    }
    write(out, size, png::ColorType::Grayscale, png::BitDepth::One, &bytes)
}

/// Writes a picture of the given width and height from its pixels, row by row.
///
/// # Errors
/// Those of the stream; [`io::ErrorKind::InvalidInput`] where the number of pixels is 0 or not width times height.
pub fn write_picture(out: &mut impl Write, size: [usize; 2], pixels: &[[u8; 3]]) -> io::Result<()> {
    write(out, size, png::ColorType::Rgb, png::BitDepth::Eight, pixels.as_flattened())
}

fn write(
    out: &mut impl Write,
    size: [usize; 2],
    colour: png::ColorType,
    depth: png::BitDepth,
    bytes: &[u8],
) -> io::Result<()> {
    let refused = |error: png::EncodingError| match error {
        png::EncodingError::IoError(error) => error,
        other => io::Error::new(io::ErrorKind::InvalidInput, other),
    };
    let [width, height] = size.map(|pixels| u32::try_from(pixels).unwrap_or(u32::MAX));
    let mut encoder = png::Encoder::new(out, width, height);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    let mut writer = encoder.write_header().map_err(refused)?;
    writer.write_image_data(bytes).map_err(refused)?;
    writer.finish().map_err(refused)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(file: &[u8]) -> (png::OutputInfo, Vec<u8>) {
        let mut decoder = png::Decoder::new(io::Cursor::new(file));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        (info, bytes)
    }

    #[test]
    fn masks_have_255_where_the_person_is() {
        for width in [1, 7, 8, 9, 70] {
            let person = |x: usize, y: usize| (x * 7 + y * 3) % 5 < 2;
            let mut file = Vec::new();
            write_mask(&mut file, [width, 4], person).unwrap();
            let (info, bytes) = decoded(&file);
            assert_eq!((info.width as usize, info.height, info.color_type), (width, 4, png::ColorType::Grayscale));
            let expected: Vec<u8> =
                (0..4 * width).map(|i| if person(i % width, i / width) { 255 } else { 0 }).collect();
            assert_eq!(bytes, expected);
        }
    }

    #[test]
    fn pictures_keep_their_pixels() {
        let pixels: Vec<[u8; 3]> = (0..35_u8).map(|i| [i, 7 * i, 255 - i]).collect();
        let mut file = Vec::new();
        write_picture(&mut file, [7, 5], &pixels).unwrap();
        let (info, bytes) = decoded(&file);
        assert_eq!((info.width, info.height, info.color_type), (7, 5, png::ColorType::Rgb));
        assert_eq!(bytes, pixels.as_flattened());
    }

    #[test]
    fn what_is_no_image_is_refused() {
        let mut file = Vec::new();
        for (size, count) in [([0, 5], 0), ([2, 2], 3), ([2, 2], 5)] {
            let error = write_picture(&mut file, size, &vec![[0; 3]; count]).unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::InvalidInput, "{size:?} {count}");
        }
    }
}
