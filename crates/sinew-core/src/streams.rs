//! Streams of random words: the blocks of [`crate::chacha`], one after the other, and the first ones of four streams together.

use crate::chacha::{Key, Words};
use crate::lanes::{Word, chacha_blocks};

fn place(block: u64, stream: u64) -> [u32; 4] {
    [block as u32, (block >> 32) as u32, stream as u32, (stream >> 32) as u32]
}

/// First blocks of four streams.
pub(crate) fn first_blocks(key: &Key, streams: [u64; 4], out: &mut [Words; 4]) {
    chacha_blocks(key, &streams.map(|stream| place(0, stream)), out);
}

/// One stream, drawn word after word.
#[derive(Clone, Debug)]
pub(crate) struct Stream {
    key: Key,
    number: u64,
    /// Number of the block that is made next.
    next: u64,
    /// Four blocks, of which the words from `used` on have not been drawn.
    made: [Words; 4],
    used: usize,
}

impl Stream {
    pub(crate) fn new(key: Key, number: u64) -> Self {
        Self { key, number, next: 0, made: Default::default(), used: 64 }
    }

    /// Becomes another stream of the same key, whose first block is known.
    pub(crate) fn restart(&mut self, number: u64, first: &Words) {
        (self.number, self.next, self.used) = (number, 1, 48);
        self.made[3] = *first;
    }

    /// Draws the next N words where they have been made.
    pub(crate) fn made<const N: usize>(&mut self) -> Option<&[Word; N]> {
        let words = self.made.as_flattened()[self.used..].first_chunk()?;
        self.used += N;
        Some(words)
    }

    /// Draws the next N words.
    pub(crate) fn next<const N: usize>(&mut self) -> [Word; N] {
        if let Some(words) = self.made() {
            return *words;
        }
        let mut words = [Word::default(); N];
        self.fill(&mut words);
        words
    }

    /// Draws words.
    pub(crate) fn fill(&mut self, mut out: &mut [Word]) {
        loop {
            let left = &self.made.as_flattened()[self.used..];
            let count = left.len().min(out.len());
            out[..count].copy_from_slice(&left[..count]);
            self.used += count;
            out = &mut out[count..];
            if out.is_empty() {
                return;
            }
            let places = [0, 1, 2, 3].map(|k| place(self.next.wrapping_add(k), self.number));
            chacha_blocks(&self.key, &places, &mut self.made);
            (self.next, self.used) = (self.next.wrapping_add(4), 0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chacha::blocks;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    const KEY: Key = [[1, 2, 3, u32::MAX], [5, 1 << 31, 7, 8]];

    fn theirs(stream: u64) -> ChaCha8Rng {
        let mut seed = [0; 32];
        for (bytes, word) in seed.chunks_exact_mut(4).zip(KEY.as_flattened()) {
            bytes.copy_from_slice(&word.to_le_bytes());
        }
        let mut rng = ChaCha8Rng::from_seed(seed);
        rng.set_stream(stream);
        rng
    }

    fn words(rng: &mut impl Rng, count: usize) -> Vec<Word> {
        (0..count).map(|_| rng.next_u32().to_le_bytes()).collect()
    }

    /// By any instructions, from any place, across the carry of the block's number, in any portions.
    #[test]
    fn streams_are_those_of_rand_chacha() {
        for number in [0, 1, u64::from(u32::MAX), u64::MAX, 0x0123_4567_89ab_cdef] {
            let mut reference = theirs(number);
            let mut stream = Stream::new(KEY, number);
            for count in [0, 1, 2, 13, 16, 48, 64, 65, 200, 3, 512] {
                let mut found = vec![Word::default(); count];
                stream.fill(&mut found);
                assert_eq!(found, words(&mut reference, count), "{count} words of stream {number}");
            }
            let block = (1 << 32) - 3;
            stream = Stream { next: block, ..Stream::new(KEY, number) };
            reference.set_word_pos(16 * u128::from(block));
            let mut found = vec![Word::default(); 100];
            stream.fill(&mut found);
            assert_eq!(found, words(&mut reference, 100), "stream {number} after 2³² blocks");
        }
    }

    #[test]
    fn first_blocks_begin_their_streams() {
        let (streams, mut first) = ([3, 1 << 40, u64::MAX, 4], Default::default());
        first_blocks(&KEY, streams, &mut first);
        let mut again = Stream::new(KEY, 9);
        for (number, first) in streams.into_iter().zip(&first) {
            let expected = words(&mut theirs(number), 100);
            again.restart(number, first);
            let made: Vec<Word> = again.made::<16>().into_iter().flatten().copied().collect();
            assert!(again.made::<1>().is_none());
            let mut rest = vec![Word::default(); 84];
            again.fill(&mut rest);
            assert_eq!([made, rest].concat(), expected, "stream {number}");
        }
    }

    #[test]
    fn all_instructions_make_the_same_blocks() {
        let places = [place(0, 1), place(u64::MAX, 2), place(1 << 33, u64::MAX), place(7, 7)];
        let (mut best, mut plain) = (<[Words; 4]>::default(), <[Words; 4]>::default());
        chacha_blocks(&KEY, &places, &mut best);
        blocks(&KEY, &places, &mut plain);
        assert_eq!(best, plain);
    }
}
