//! Seeded mutations of the corpus through every check, on the stable compiler.
//! Cuts, flipped and changed bytes, swapped, doubled and dropped pieces and lines, splices of two files.
//!
//! 10⁴ inputs a target, 10³ for a step of the filter, which is a hundred times a reader's work. The same seed gives the same inputs; a failure names target, file and number, and
//! writes the input where it says. Each must be done in a second, in one of four attempts: the
//! machine may be busy.

use crate::fuzzed::{CHECKS, corpus};
use sinew::core::lanes::Block;
use sinew::core::random::{BlockRng, Stage};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

const SEED: u64 = 4;
const LIMIT: Duration = Duration::from_secs(1);

/// Small numbers from a keyed stream.
struct Dice {
    rng: BlockRng,
    thrown: Vec<f64>,
}

impl Dice {
    fn below(&mut self, count: usize) -> usize {
        if self.thrown.is_empty() {
            let mut blocks = [Block::ZERO; 32];
            self.rng.fill_uniform(&mut blocks);
            self.thrown.extend(blocks.iter().flat_map(|block| block.0));
        }
        (self.thrown.pop().unwrap_or(0.0) * count as f64) as usize
    }
}

/// Pieces that readers stumble over.
const PIECES: [&[u8]; 16] = [
    b"NaN",
    b"inf",
    b"-1",
    b"1e999",
    b"4294967296",
    b"\xff",
    b"\0",
    b"\r\n",
    b"\t",
    b"\"",
    b"[[[[",
    b"}}",
    b"=",
    b",",
    b"1e-320",
    "\u{feff}".as_bytes(),
];

fn mutated(bytes: &[u8], other: &[u8], dice: &mut Dice) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..=dice.below(4) {
        let length = bytes.len();
        let at = dice.below(length);
        match dice.below(10) {
            0 => bytes.truncate(at),
            1 => drop(bytes.drain(..at)),
            2 if length > 0 => bytes[at] ^= 1 << dice.below(8),
            3 if length > 0 => bytes[at] = dice.below(256) as u8,
            4 if length > 0 => bytes.swap(at, dice.below(length)),
            5 => {
                let end = length.min(at + 1 + dice.below(16));
                bytes.drain(at.min(end)..end);
            }
            6 => {
                let piece = PIECES[dice.below(PIECES.len())];
                bytes.splice(at..at, piece.iter().copied());
            }
            7 | 8 => {
                let mut lines: Vec<Vec<u8>> = bytes.split_inclusive(|b| *b == b'\n').map(<[u8]>::to_vec).collect();
                let (a, b) = (dice.below(lines.len()), dice.below(lines.len()));
                match dice.below(3) {
                    _ if lines.is_empty() => {}
                    0 => lines.swap(a, b),
                    1 => drop(lines.remove(a)),
                    _ => lines.insert(b, lines[a].clone()),
                }
                bytes = lines.concat();
            }
            _ => {
                let from = dice.below(other.len());
                let end = other.len().min(from + dice.below(64));
                bytes.splice(at..at, other[from..end].iter().copied());
            }
        }
    }
    bytes
}

fn check_target(target: &str, inputs: usize) {
    let (_, check) = CHECKS.into_iter().find(|(name, _)| *name == target).expect("a target");
    let files = corpus(target);
    let mut dice = Dice { rng: Stage::new(SEED, target).whole(), thrown: vec![] };
    let started = Instant::now();
    for number in 0..inputs {
        let (path, bytes) = &files[dice.below(files.len())];
        let other = &files[dice.below(files.len())].1;
        let input = mutated(bytes, other, &mut dice);
        let start = Instant::now();
        if catch_unwind(AssertUnwindSafe(|| check(&input))).is_err() {
            let kept = std::env::temp_dir().join(format!("sinew-{target}-{number}"));
            let _ = std::fs::write(&kept, &input);
            panic!("{target}: mutation {number} of {path} panics; it is kept in {}", kept.display());
        }
        // A machine that does other things may stop for a second at any input; at the same one four times it does not.
        let is_slow = |_: &i32| {
            let start = Instant::now();
            check(&input);
            start.elapsed() >= LIMIT
        };
        let took = start.elapsed();
        let always_slow = took >= LIMIT && (0..3).filter(is_slow).count() == 3;
        assert!(
            !always_slow,
            "{target}: mutation {number} of {path} takes {took:?} and more than a second in each of three repetitions"
        );
    }
    println!("{target}: {inputs} inputs, seed {SEED}, {:.2} s", started.elapsed().as_secs_f64());
}

macro_rules! targets {
    ($($target:ident: $inputs:literal),+ $(,)?) => {
        $(#[test]
        fn $target() {
            check_target(stringify!($target), $inputs);
        })+

        #[test]
        fn no_target_is_left_out() {
            let named = [$(stringify!($target)),+];
            assert!(CHECKS.iter().all(|(name, _)| named.contains(name)) && named.len() == CHECKS.len());
        }
    };
}

targets! {
    openpose: 10_000,
    calib_toml: 10_000,
    calibration: 10_000,
    caliscope_xy: 10_000,
    coco_results: 10_000,
    deeplabcut_csv: 10_000,
    mediapipe_json: 10_000,
    mmpose_json: 10_000,
    rtmlib_json: 10_000,
    layout: 10_000,
    live_frame: 10_000,
    osim_model: 10_000,
    point_mapping: 10_000,
    body_toml: 10_000,
    trc: 10_000,
    c3d: 10_000,
    mot: 10_000,
    bvh: 10_000,
    asf_amc: 10_000,
    tidy_csv: 10_000,
    mask: 10_000,
    picture: 10_000,
    file_names: 10_000,
    settings: 10_000,
    setup: 10_000,
    summary: 10_000,
    zarr_metadata: 10_000,
    result_tables: 10_000,
    checkpoint: 10_000,
    primitive_model: 10_000,
    latent_model: 10_000,
    filter_step: 1_000,
}
