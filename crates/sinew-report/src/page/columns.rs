//! Columns of numbers as few bytes.
//!
//! A number is rounded to whole steps n. What is written is 0 where there is none, else 1 + z(n − m) with m the whole steps of the last number before it (0 at the beginning) and z(d) = 2d for d ≥ 0, −2d − 1 below: seven bits a byte, the lowest first, the eighth says that more follow.
//! A minute of one person at 60 frames a second takes 1.8 MB so, and deflated 1.2.

/// Steps beyond which numbers are cut: their differences are exact in the browser's numbers of 53 bits.
const MOST: f64 = (1_u64 << 50) as f64;

/// Appends a column.
pub(super) fn encode(out: &mut Vec<u8>, values: impl IntoIterator<Item = f64>, step: f64) {
    let mut before = 0_i64;
    for value in values {
        let whole = (value / step).round();
        if whole.is_nan() {
            out.push(0);
            continue;
        }
        let whole = whole.clamp(-MOST, MOST) as i64;
        let difference = whole - before;
        let folded = if difference < 0 { -2 * difference - 1 } else { 2 * difference };
        seven_bits(out, folded.unsigned_abs() + 1);
        before = whole;
    }
}

fn seven_bits(out: &mut Vec<u8>, mut value: u64) {
    while value > 127 {
        out.push((value & 127) as u8 | 128);
        value >>= 7;
    }
    out.push(value as u8);
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Reads a column as the page does.
    pub(in super::super) fn decode(bytes: &mut &[u8], count: usize, step: f64) -> Vec<f64> {
        let mut before = 0_i64;
        let mut one = || {
            let mut value = 0_u64;
            for place in 0..10 {
                let (first, rest) = bytes.split_first().expect("a byte");
                *bytes = rest;
                value |= u64::from(first & 127) << (7 * place);
                if *first < 128 {
                    break;
                }
            }
            let folded = (value as i64 - 1).max(0);
            before += if folded % 2 == 0 { folded / 2 } else { -(folded + 1) / 2 };
            if value == 0 { f64::NAN } else { before as f64 * step }
        };
        (0..count).map(|_| one()).collect()
    }

    #[test]
    fn numbers_come_back_to_half_a_step() {
        let values = [0.0, 1.2345, -3.0, f64::NAN, -2.9994, 1e9, f64::INFINITY, f64::NEG_INFINITY, 5.5];
        let mut bytes = vec![];
        encode(&mut bytes, values, 0.001);
        encode(&mut bytes, [7.0], 1.0);
        let mut rest = &bytes[..];
        let back = decode(&mut rest, values.len(), 0.001);
        for (value, back) in values.iter().zip(&back).filter(|(value, _)| !value.is_infinite()) {
            assert!((value - back).abs() <= 0.000_501 || value.is_nan() && back.is_nan(), "{value} {back}");
        }
        assert!(back[6] > 1e12 && back[7] < -1e12);
        assert_eq!((decode(&mut rest, 1, 1.0), rest.len()), (vec![7.0], 0));
    }

    #[test]
    fn what_hardly_moves_takes_a_byte_a_number() {
        let mut bytes = vec![];
        encode(&mut bytes, (0..100).map(|k| 0.01 * f64::from(k)), 0.001);
        assert_eq!(bytes.len(), 100);
    }
}
