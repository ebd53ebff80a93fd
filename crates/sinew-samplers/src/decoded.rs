//! Decoding blocks of sampled states, such as particles or draws of chains.

use rayon::prelude::*;
use sinew_core::decode::Decode;
use sinew_core::lanes::Block;

/// Blocks that one task decodes at least.
const BLOCKS_A_TASK: usize = 4;

/// Decodes all states; both are stored in blocks of eight states, one after the other.
#[must_use]
pub fn decoded<C: Decode + ?Sized>(states: &[Block], decoder: &C) -> Vec<Block> {
    let (m, n) = (decoder.target_dim(), decoder.source_dim());
    let mut out = vec![Block::ZERO; states.len() / n * m];
    out.par_chunks_exact_mut(m).zip(states.par_chunks_exact(n)).with_min_len(BLOCKS_A_TASK).for_each_init(
        || vec![Block::ZERO; decoder.workspace()],
        |ws, (out, states)| decoder.decode_block(states, out, ws),
    );
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::density::Lanes;
    use sinew_core::lanes::{Isa, LANES};
    use sinew_core::toy::Sheet;

    #[test]
    fn every_state_is_decoded_in_its_place() {
        let sheet = Lanes { leaf: Sheet { radius: 1.0, twist: 0.5 }, isa: Isa::best() };
        let place = |index: usize| 0.01 * index as f64;
        let states: Vec<Block> =
            (0..20 * 2).map(|k| Block(std::array::from_fn(|lane| place(k * LANES + lane)))).collect();
        let all = decoded(&states, &sheet);
        assert_eq!(all.len(), 20 * 4);
        for index in 0..20 * LANES {
            let (block, lane) = (index / LANES, index % LANES);
            let mut one = [0.0; 4];
            sheet.decode(&[states[2 * block].0[lane], states[2 * block + 1].0[lane]], &mut one);
            assert_eq!(one, [0, 1, 2, 3].map(|j| all[4 * block + j].0[lane]));
        }
    }
}
