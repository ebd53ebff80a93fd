//! Words and reals as the three processors store them, written from the format's manual without the reader.

/// A processor by its number in a file.
pub const INTEL: u8 = 84;
/// DEC: words as Intel has them, reals with a larger exponent and their words exchanged.
pub const DEC: u8 = 85;
/// MIPS: all bytes the other way round.
pub const MIPS: u8 = 86;

pub fn word(processor: u8, value: u16) -> [u8; 2] {
    if processor == MIPS { value.to_be_bytes() } else { value.to_le_bytes() }
}

pub fn real(processor: u8, value: f32) -> [u8; 4] {
    match processor {
        MIPS => value.to_be_bytes(),
        DEC => {
            assert!(value == 0.0 || value.is_normal(), "{value}");
            // VAX: four times the IEEE number of the same bits, so that a quarter of the bits' number is meant.
            let bits = if value == 0.0 { 0 } else { (4.0 * value).to_bits() };
            let [a, b, c, d] = bits.to_be_bytes();
            [b, a, d, c]
        }
        _ => value.to_le_bytes(),
    }
}

/// The number of four bytes, of VAX no larger than a quarter of the largest of IEEE.
pub fn stored_real(processor: u8, [a, b, c, d]: [u8; 4]) -> f32 {
    match processor {
        MIPS => f32::from_be_bytes([a, b, c, d]),
        DEC => f32::from_be_bytes([b, a, d, c]) / 4.0,
        _ => f32::from_le_bytes([a, b, c, d]),
    }
}
