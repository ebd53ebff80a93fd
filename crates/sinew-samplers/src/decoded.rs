//! Decoding blocks of sampled states, such as particles or draws of chains, and back.

use rayon::prelude::*;
use sinew_core::decode::Decode;
use sinew_core::lanes::{Block, LANES, get_lane, set_lane};

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

/// The sampled states of `count` decoded ones, stored alike; idle lanes repeat the last. A state that nothing decodes to gets what the next one gets that has a sampled state, beyond the last the first; none where no state has one.
#[must_use]
pub fn encoded<C: Decode + ?Sized>(states: &[Block], count: usize, decoder: &C) -> Option<Vec<Block>> {
    let (m, n) = (decoder.target_dim(), decoder.source_dim());
    let encode = |index: usize| {
        let mut decoded = vec![0.0; m];
        get_lane(&states[index / LANES * m..][..m], index % LANES, &mut decoded);
        decoder.encode(&decoded)
    };
    let mut found: Vec<Option<Vec<f64>>> = (0..count).into_par_iter().map(encode).collect();
    let mut next = found.iter().flatten().next()?.clone();
    for state in found.iter_mut().rev() {
        next.clone_from(state.get_or_insert_with(|| next.clone()));
    }
    let mut out = vec![Block::ZERO; count.div_ceil(LANES) * n];
    for slot in 0..out.len() / n * LANES {
        let state = found[slot.min(count - 1)].as_deref()?;
        set_lane(&mut out[slot / LANES * n..][..n], slot % LANES, state);
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::density::Lanes;
    use sinew_core::lanes::Isa;
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

    /// Eleven points of a sheet, of which two are on its axis, where nothing decodes to: the one between takes what its successor gets, the last what the first gets.
    #[test]
    fn encoding_leads_back_in_its_place() {
        let sheet = Lanes { leaf: Sheet { radius: 1.0, twist: 0.5 }, isa: Isa::best() };
        let latent = |index: usize| [0.1 * index as f64 - 0.3, 0.02 * index as f64];
        let mut sampled = vec![Block::ZERO; 4];
        (0..11).for_each(|i| set_lane(&mut sampled[i / LANES * 2..][..2], i % LANES, &latent(i)));
        let mut poses = decoded(&sampled, &sheet);
        for lost in [4, 10] {
            set_lane(&mut poses[lost / LANES * 4..][..4], lost % LANES, &[0.0, 1.0, 0.0, 0.0]);
        }
        let found = encoded(&poses, 11, &sheet).expect("most are on the sheet");
        for (i, like) in [0, 1, 2, 3, 5, 5, 6, 7, 8, 9, 0].into_iter().enumerate() {
            let mut state = [0.0; 2];
            get_lane(&found[i / LANES * 2..][..2], i % LANES, &mut state);
            assert!(state.iter().zip(latent(like)).all(|(a, b)| (a - b).abs() < 1e-12), "{i}: {state:?}");
        }
        assert!(encoded(&[Block::ZERO, Block::splat(1.0), Block::ZERO, Block::ZERO], 8, &sheet).is_none());
    }
}
