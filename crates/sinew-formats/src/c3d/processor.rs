//! Words and numbers as the three processors store them that write C3D files.
//!
//! Intel stores the low byte first, MIPS the high byte first. DEC stores words as Intel does; its number of four bytes
//! (VAX F_floating: VAX Architecture Reference Manual, 1987, §2.4) is two words, the first with sign, exponent e and the
//! upper seven bits of the mantissa m: (−1)ˢ (1 + m / 2²³) 2^(e − 129). It is 0 for e = 0, and no number if s = 1 then.

/// Processor for which a file was written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Processor {
    /// Low byte first, IEEE numbers.
    #[default]
    Intel,
    /// Low byte first, VAX numbers.
    Dec,
    /// High byte first, IEEE numbers.
    Mips,
}

impl Processor {
    /// Processor of a number in byte 4 of the parameter section.
    pub(super) const fn numbered(number: u8) -> Option<Self> {
        match number {
            84 => Some(Self::Intel),
            85 => Some(Self::Dec),
            86 => Some(Self::Mips),
            _ => None,
        }
    }

    /// Name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Intel => "Intel",
            Self::Dec => "DEC",
            Self::Mips => "MIPS",
        }
    }

    pub(super) const fn word(self, bytes: [u8; 2]) -> u16 {
        match self {
            Self::Intel | Self::Dec => u16::from_le_bytes(bytes),
            Self::Mips => u16::from_be_bytes(bytes),
        }
    }

    pub(super) fn real(self, bytes: [u8; 4]) -> f64 {
        match self {
            Self::Intel => f32::from_le_bytes(bytes).into(),
            Self::Mips => f32::from_be_bytes(bytes).into(),
            Self::Dec => vax_f(bytes),
        }
    }
}

fn vax_f([a, b, c, d]: [u8; 4]) -> f64 {
    let bits = u32::from_be_bytes([b, a, d, c]);
    let is_negative = bits >> 31 == 1;
    let exponent = (bits >> 23) & 0xff;
    if exponent == 0 {
        return if is_negative { f64::NAN } else { 0.0 };
    }
    let mantissa = 1.0 + f64::from(bits & 0x7f_ffff) / f64::from(1 << 23);
    let size = mantissa * (f64::from(exponent) - 129.0).exp2();
    if is_negative { -size } else { size }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes from the tables of the VAX Architecture Reference Manual: 1.0 is 4080 (hex), −12.5 is C248.
    #[test]
    fn numbers_of_all_processors() {
        for (processor, one, other) in [
            (Processor::Intel, [0, 0, 0x80, 0x3f], [0, 0, 0x48, 0xc1]),
            (Processor::Mips, [0x3f, 0x80, 0, 0], [0xc1, 0x48, 0, 0]),
            (Processor::Dec, [0x80, 0x40, 0, 0], [0x48, 0xc2, 0, 0]),
        ] {
            assert_eq!((processor.real(one), processor.real(other), processor.real([0; 4])), (1.0, -12.5, 0.0));
        }
        assert_eq!((Processor::Dec.word([1, 2]), Processor::Mips.word([1, 2])), (0x201, 0x102));
        assert!(Processor::Dec.real([0, 0x80, 0, 0]).is_nan());
        assert_eq!(Processor::Dec.real([0xff, 0x7f, 0, 0]), 1.9921875 * 126f64.exp2());
    }
}
