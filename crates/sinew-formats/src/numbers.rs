//! Numbers as messages and files show them.
//!
//! Counts from 10 000 on are grouped by thousands with spaces, large powers of ten are written as such, and a deviation
//! is shown with two significant digits. In files an `f64` is written with the fewest digits that read back equal.

use std::fmt::{self, Write as _};
use std::io;

/// A count: `1203`, `40 961`, `10^9`.
pub(crate) struct Count(pub(crate) u64);

impl fmt::Display for Count {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = self.0.to_string();
        if digits.len() > 6 && digits.starts_with('1') && digits.bytes().skip(1).all(|b| b == b'0') {
            return write!(f, "10^{}", digits.len() - 1);
        }
        if digits.len() < 5 {
            return f.write_str(&digits);
        }
        for (i, digit) in digits.chars().enumerate() {
            if i > 0 && (digits.len() - i).is_multiple_of(3) {
                f.write_char(' ')?;
            }
            f.write_char(digit)?;
        }
        Ok(())
    }
}

/// A file size: `12 kB`, `4.2 GB`, `900 bytes`.
pub(crate) struct Bytes(pub(crate) u64);

impl fmt::Display for Bytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0 < 1000 {
            return write!(f, "{} bytes", self.0);
        }
        let mut value = self.0 as f64 / 1e3;
        let mut unit = "kB";
        for next in ["MB", "GB", "TB", "PB", "EB"] {
            if value < 999.5 {
                break;
            }
            value /= 1e3;
            unit = next;
        }
        if value < 9.95 {
            write!(f, "{} {unit}", (value * 10.0).round() / 10.0)
        } else {
            write!(f, "{value:.0} {unit}")
        }
    }
}

/// A deviation with two significant digits: `0.04`, `0.00012`, `3.1e-7`.
pub(crate) struct Rough(pub(crate) f64);

impl fmt::Display for Rough {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rounded: f64 = format!("{:.1e}", self.0).parse().unwrap_or(self.0);
        write!(f, "{rounded:?}")
    }
}

/// Writes a number so that it reads back equal; `NaN` stands for a missing one.
///
/// # Errors
/// `InvalidInput` for an infinite number, which no reader of these files accepts.
pub(crate) fn write_number(out: &mut impl io::Write, value: f64) -> io::Result<()> {
    if value.is_infinite() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "an infinite number cannot be written"));
    }
    write!(out, "{value:?}")
}

/// A size that is whole as a rule, without a fraction then.
pub(crate) fn plain(value: f64) -> String {
    if value.fract() == 0.0 && value.abs() < 1e15 { format!("{value:.0}") } else { format!("{value:?}") }
}

/// Writes a rate or a count that happens to be an `f64`: whole numbers without the fraction.
pub(crate) fn write_plain(out: &mut impl io::Write, value: f64) -> io::Result<()> {
    if value.is_infinite() { write_number(out, value) } else { out.write_all(plain(value).as_bytes()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_sizes_and_deviations_are_readable() {
        assert_eq!(Count(1203).to_string(), "1203");
        assert_eq!(Count(40_961).to_string(), "40 961");
        assert_eq!(Count(1_000_000_000).to_string(), "10^9");
        assert_eq!(Count(u64::MAX).to_string(), "18 446 744 073 709 551 615");
        assert_eq!(Bytes(12_000).to_string(), "12 kB");
        assert_eq!(Bytes(999).to_string(), "999 bytes");
        assert_eq!(Bytes(4_200_000_000).to_string(), "4.2 GB");
        assert_eq!(Rough(0.040_000_000_1).to_string(), "0.04");
        assert_eq!(Rough(f64::NAN).to_string(), "NaN");
    }
}
