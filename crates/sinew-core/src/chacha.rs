//! ChaCha with eight rounds (Bernstein 2008): words that follow from a key of 256 bits, the number of a stream and the number of a block of sixteen words.
//!
//! A block is a matrix of four by four words: a row of constants, two rows of key, and a row for its place (number of the block, number of the stream, 64 bits each). Rounds mix columns and diagonals in turn; then the matrix before them is added.
//! Four blocks are made together: following ones of one stream, or one of each of four streams.

/// First row of every block: "expand 32-byte k".
pub(crate) const CONSTANTS: [u32; 4] = [0x6170_7865, 0x3320_646e, 0x7962_2d32, 0x6b20_6574];

/// Second and third row of every block.
pub(crate) type Key = [[u32; 4]; 2];

/// Last rows of four blocks.
pub(crate) type Places = [[u32; 4]; 4];

/// Words of a block.
pub(crate) type Words = [[u8; 4]; 16];

/// Four blocks, one after the other.
pub(crate) fn blocks(key: &Key, places: &Places, out: &mut [Words; 4]) {
    for (place, out) in places.iter().zip(out) {
        let before = [CONSTANTS, key[0], key[1], *place];
        let mut rows = before;
        for _ in 0..4 {
            round(&mut rows);
            turn(&mut rows, [0, 1, 2, 3]);
            round(&mut rows);
            turn(&mut rows, [0, 3, 2, 1]);
        }
        let sums = rows.as_flattened().iter().zip(before.as_flattened()).map(|(x, y)| x.wrapping_add(*y));
        out.iter_mut().zip(sums).for_each(|(word, sum)| *word = sum.to_le_bytes());
    }
}

/// A quarter round of each column.
fn round([a, b, c, d]: &mut [[u32; 4]; 4]) {
    mix(a, b, d, 16);
    mix(c, d, b, 12);
    mix(a, b, d, 8);
    mix(c, d, b, 7);
}

fn mix(a: &mut [u32; 4], b: &[u32; 4], d: &mut [u32; 4], by: u32) {
    for ((a, b), d) in a.iter_mut().zip(b).zip(d) {
        *a = a.wrapping_add(*b);
        *d = (*d ^ *a).rotate_left(by);
    }
}

fn turn(rows: &mut [[u32; 4]; 4], by: [usize; 4]) {
    rows.iter_mut().zip(by).for_each(|(row, by)| row.rotate_left(by));
}
