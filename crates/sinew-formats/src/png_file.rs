//! PNG files as samples of eight bits, the claims in their headers checked before memory is taken.

use crate::numbers::Count;
use crate::{Error, Place};
use png::{BitDepth, ColorType, DecodingError, Limits, Transformations};
use std::io::{self, Cursor, Write};

/// Pixels of the largest image that is read: 8192 x 8192.
pub(crate) const MAX_PIXELS: u64 = 1 << 26;

/// Memory that the decoder may take beside the pixels, bytes.
const WORKSPACE_BYTES: usize = 64 << 20;

/// Bytes that one byte of a deflated stream can stand for (zlib's technical notes: 1032).
const MAX_DEFLATION: u64 = 1032;

pub(crate) const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Samples of an image: eight bits each, row by row, or indices into a palette.
pub(crate) struct Samples {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// 1 grey, 2 grey and alpha, 3 colour, 4 colour and alpha; 1 with a palette.
    pub(crate) channels: usize,
    /// Bits of a sample in the file.
    pub(crate) bits: u8,
    pub(crate) values: Vec<u8>,
    pub(crate) palette: Option<Vec<[u8; 3]>>,
}

/// What must be said in place of an expectation.
pub(crate) const EXPECTED: &str = "a whole PNG file";

/// Refuses images larger than any camera's.
pub(crate) fn check_pixels(name: &str, width: u32, height: u32) -> Result<(), Error> {
    if u64::from(width) * u64::from(height) <= MAX_PIXELS {
        return Ok(());
    }
    Err(Error::TooManyPixels { place: Place::file(name), width, height, limit: MAX_PIXELS })
}

/// Decodes a file.
pub(crate) fn read(name: &str, bytes: &[u8]) -> Result<Samples, Error> {
    check_chunks(name, bytes)?;
    let broken = |error: &DecodingError| Place::file(name).syntax(error.to_string(), EXPECTED);
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: WORKSPACE_BYTES });
    let info = decoder.read_header_info().map_err(|error| broken(&error))?;
    let (width, height, bits, is_indexed) =
        (info.width, info.height, info.bit_depth as u8, info.color_type == ColorType::Indexed);
    check_pixels(name, width, height)?;
    let row_bits = u64::from(width) * info.color_type.samples() as u64 * u64::from(bits);
    let claimed = row_bits.div_ceil(8) * u64::from(height);
    if claimed > MAX_DEFLATION * bytes.len() as u64 {
        return Err(Error::ImpossibleCount {
            place: Place::file(name),
            claimed,
            unit: "bytes of pixels",
            bytes: bytes.len() as u64,
        });
    }
    decoder.set_transformations(if is_indexed {
        Transformations::IDENTITY
    } else {
        Transformations::EXPAND | Transformations::STRIP_16
    });
    let mut reader = decoder.read_info().map_err(|error| broken(&error))?;
    let palette = reader.info().palette.as_deref().filter(|_| is_indexed);
    let palette = palette.map(|palette| palette.as_chunks::<3>().0.to_vec());
    let (color, depth) = reader.output_color_type();
    let size = reader.output_buffer_size().ok_or_else(|| broken(&DecodingError::LimitsExceeded))?;
    let mut values = vec![0; size];
    reader.next_frame(&mut values).map_err(|error| broken(&error))?;
    if depth != BitDepth::Eight {
        values = unpacked(&values, width as usize, height as usize, depth as u8);
    }
    let (width, height) = (width as usize, height as usize);
    Ok(Samples { width, height, channels: color.samples(), bits, values, palette })
}

/// Walks the chunks, so that a truncated file is reported with the place where it ends.
fn check_chunks(name: &str, bytes: &[u8]) -> Result<(), Error> {
    let cut = |inside| Error::Truncated { place: Place::file(name), inside, offset: bytes.len(), line: None };
    if !bytes.starts_with(SIGNATURE) {
        if SIGNATURE.starts_with(bytes) {
            return Err(cut("the signature"));
        }
        let found =
            if bytes.starts_with(b"\xFF\xD8\xFF") { "a JPEG file".to_owned() } else { "no PNG file".to_owned() };
        return Err(Place::file(name).syntax(found, EXPECTED));
    }
    let mut at = SIGNATURE.len();
    loop {
        let rest = bytes.get(at..).unwrap_or_default();
        let Some((length, rest)) = rest.split_first_chunk::<4>() else { return Err(cut("the list of chunks")) };
        let Some((kind, _)) = rest.split_first_chunk::<4>() else { return Err(cut("the list of chunks")) };
        let length = u32::from_be_bytes(*length) as usize;
        // Length, kind and checksum are four bytes each.
        let end = at.saturating_add(12).saturating_add(length);
        if !kind.iter().all(u8::is_ascii_alphabetic) {
            return Err(Place::file(name).syntax(format!("no chunk at byte {}", Count(at as u64)), EXPECTED));
        }
        if end > bytes.len() {
            return Err(cut(match kind {
                b"IHDR" => "the header",
                b"IDAT" => "the pixels",
                _ => "a chunk",
            }));
        }
        if kind == b"IEND" {
            return Ok(());
        }
        at = end;
    }
}

/// Samples of less than eight bits, one a byte; rows begin at whole bytes.
fn unpacked(packed: &[u8], width: usize, height: usize, bits: u8) -> Vec<u8> {
    let per_byte = 8 / usize::from(bits);
    let mask = u8::MAX >> (8 - bits);
    let mut values = Vec::with_capacity(width * height);
    for row in packed.chunks_exact(width.div_ceil(per_byte)).take(height) {
        let samples =
            row.iter().flat_map(|byte| (1..=per_byte).map(move |i| byte >> (8 - i * usize::from(bits)) & mask));
        values.extend(samples.take(width));
    }
    values
}

/// Writes an image from rows that begin at whole bytes.
pub(crate) fn write(
    out: &mut impl Write,
    size: [usize; 2],
    color: ColorType,
    depth: BitDepth,
    data: &[u8],
) -> io::Result<()> {
    let too_large = |_| io::Error::new(io::ErrorKind::InvalidInput, "the image is too large for a PNG file");
    let [width, height] = [u32::try_from(size[0]).map_err(too_large)?, u32::try_from(size[1]).map_err(too_large)?];
    let mut encoder = png::Encoder::new(out, width, height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(data)?;
    Ok(writer.finish()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_samples_are_unpacked_row_by_row() {
        assert_eq!(unpacked(&[0b1010_0000, 0b0110_0000], 3, 2, 1), [1, 0, 1, 0, 1, 1]);
        assert_eq!(unpacked(&[0b0001_1011, 0b0100_0000], 5, 1, 2), [0, 1, 2, 3, 1]);
        assert_eq!(unpacked(&[0x1f, 0x20], 3, 1, 4), [1, 15, 2]);
        assert_eq!(unpacked(&[7], 1, 1, 8), [7]);
    }
}
