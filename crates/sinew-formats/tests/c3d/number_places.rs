//! Where words and reals stand in a C3D file of Intel or DEC, found without the reader.

use super::storage::DEC;

/// A number in a file.
pub enum Number {
    Word(usize),
    Real(usize),
}

fn word(bytes: &[u8], at: usize) -> usize {
    u16::from_le_bytes([bytes[at], bytes[at + 1]]).into()
}

/// Places of all numbers, and of the byte that names the processor.
pub fn number_places(bytes: &[u8]) -> (Vec<Number>, usize) {
    let mut numbers: Vec<Number> =
        [2, 3, 4, 5, 6, 9, 10, 147, 148, 149, 150, 151, 152].map(|number| Number::Word(2 * number - 2)).into();
    numbers.extend([7, 11].into_iter().chain((153..189).step_by(2)).map(|number| Number::Real(2 * number - 2)));
    let section = 512 * (usize::from(bytes[0]) - 1);
    let mut at = section + 4;
    while bytes[at] != 0 {
        let link = at + 2 + usize::from((bytes[at] as i8).unsigned_abs());
        numbers.push(Number::Word(link));
        if (bytes[at + 1] as i8) > 0 {
            let rank = usize::from(bytes[link + 3]);
            let count: usize = bytes[link + 4..link + 4 + rank].iter().map(|&extent| usize::from(extent)).product();
            let values = link + 4 + rank;
            match bytes[link + 2] as i8 {
                2 => numbers.extend((0..count).map(|index| Number::Word(values + 2 * index))),
                4 => numbers.extend((0..count).map(|index| Number::Real(values + 4 * index))),
                _ => {}
            }
        }
        if word(bytes, link) == 0 {
            break;
        }
        at = link + word(bytes, link);
    }
    let start = 512 * (word(bytes, 16) - 1);
    // The sign is in the same byte of Intel's reals and in another of DEC's.
    let is_real = bytes[if bytes[section + 3] == DEC { 13 } else { 15 }] >= 0x80;
    if is_real {
        numbers.extend((start..bytes.len() - 3).step_by(4).map(Number::Real));
    } else {
        numbers.extend((start..bytes.len() - 1).step_by(2).map(Number::Word));
    }
    (numbers, section + 3)
}
