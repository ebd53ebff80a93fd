//! No bytes make the reader panic, take long or take memory that the file does not account for.

use super::built::{self, BLOCKS_BEFORE, Build};
use super::by_hand::builds;
use super::storage::INTEL;
use proptest::prelude::*;
use sinew_formats::c3d;
use std::time::Instant;

const PLAIN: Build = Build { processor: INTEL, is_real: false, is_unsigned: true };

/// Reads; an error says something.
fn read(bytes: &[u8]) -> Option<c3d::C3d> {
    match c3d::read("a.c3d", bytes) {
        Ok(file) => {
            assert!(file.frames.len() <= bytes.len());
            assert!(file.frames.iter().all(|frame| frame.len() == file.header.markers.len()));
            let positions = file.frames.iter().flatten().flatten().flat_map(|point| point.position);
            assert!(positions.into_iter().all(f64::is_finite));
            Some(file)
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            None
        }
    }
}

#[test]
fn a_file_cut_at_any_byte_is_refused() {
    for build in builds() {
        let file = built::file(build);
        let width = if build.is_real { 4 } else { 2 };
        let frames = built::FRAMES * (4 * built::POINTS + built::CHANNELS * built::SAMPLES_PER_FRAME) * width;
        let whole = BLOCKS_BEFORE * 512 + frames;
        for end in 0..whole {
            assert!(read(&file[..end]).is_none(), "{build:?}: cut at {end}");
        }
        assert!(read(&file[..whole]).is_some(), "{build:?}");
    }
}

#[test]
fn a_byte_changed_anywhere_is_read_or_refused() {
    let file = built::file(PLAIN);
    for at in 0..file.len() {
        for change in [0x01, 0x80, 0xff, file[at]] {
            let mut damaged = file.clone();
            damaged[at] ^= change;
            read(&damaged);
        }
    }
}

fn with(changes: &[(usize, &[u8])]) -> Vec<u8> {
    let mut file = built::file(PLAIN);
    for (at, bytes) in changes {
        file[*at..at + bytes.len()].copy_from_slice(bytes);
    }
    file
}

#[test]
fn claims_are_checked_before_memory_is_taken() {
    let nothing = (2, &[0, 0, 0, 0][..]);
    // Frames of nothing, and four thousand million of them.
    let trial = b"\x05\xfcTRIAL\x03\x00\x00\
        \x12\x04ACTUAL_START_FIELD\x0a\x00\x02\x01\x02\x01\x00\x00\x00\x00\
        \x10\x04ACTUAL_END_FIELD\x0a\x00\x02\x01\x02\xff\xff\xff\xff\x00\x00\x00";
    let claim = with(&[nothing, (8, &[0, 0, 0, 0]), (512 + 4, trial)]);
    let error = c3d::read("a.c3d", &claim).unwrap_err();
    assert_eq!(error.to_string(), "a.c3d: file claims 4 294 967 295 frames, holds 2.6 kB");
    // A text of 255^7 bytes.
    let large = b"\x01\x01A\x00\x00\xff\x07\xff\xff\xff\xff\xff\xff\xff";
    assert!(read(&with(&[(512 + 4, large)])).is_none());
    // Texts without letters, as many as that.
    let none = b"\x01\x01A\x00\x00\xff\x07\x00\xff\xff\xff\xff\xff\xff\x00";
    assert!(read(&with(&[(512 + 4, none)])).is_some());
    // A parameter that points to itself.
    let back = b"\x01\x01A\x01\x00\x01\x00\x07\x00";
    assert!(read(&with(&[(512 + 4, back)])).is_none());
}

/// A file whose parameters are the same record again and again, a megabyte of it.
fn megabyte(record: impl Fn(usize) -> Vec<u8>) -> Vec<u8> {
    let mut file = built::file(PLAIN)[..516].to_vec();
    (0..)
        .map(record)
        .take_while(|record| {
            file.extend(record);
            file.len() < 1 << 20
        })
        .for_each(drop);
    file.extend([0; 600]);
    // The frames begin in the last block: there are none.
    file[4..10].copy_from_slice(&[0, 0, 1, 0, 0, 0]);
    file
}

#[test]
fn a_megabyte_of_parameters_is_no_burden() {
    let groups = |_: usize| b"\x01\xffA\x03\x00\x00".to_vec();
    let orphans = |index: usize| [b"\x01", &[1 + (index % 127) as u8][..], b"A\x06\x00\x02\x01\x00\x00"].concat();
    let labels = |index: usize| {
        let name = if index == 0 { "LABELS".into() } else { format!("LABELS{}", index + 1) };
        let head = if index == 0 { &b"\x05\xffPOINT\x03\x00\x00"[..] } else { b"" };
        [head, &[name.len() as u8, 1], name.as_bytes(), b"\x07\x00\xff\x01\x01a\x00"].concat()
    };
    let letters = |_: usize| [&b"\x01\x01A\x08\xfe\xff\x03\x01\xff\xff"[..], &vec![b'a'; 255 * 255], b"\x00"].concat();
    for record in [&groups as &dyn Fn(usize) -> Vec<u8>, &orphans, &labels, &letters] {
        let file = megabyte(record);
        let start = Instant::now();
        read(&file);
        assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        failure_persistence: Some(Box::new(proptest::test_runner::FileFailurePersistence::Direct("tests/properties.proptest-regressions"))),
        ..ProptestConfig::default()
    })]

    #[test]
    fn arbitrary_bytes_are_refused_or_read(input in any::<Vec<u8>>()) {
        read(&input);
        read(&[&[2, 0x50][..], &input].concat());
    }

    #[test]
    fn damaged_files_are_refused_or_read(
        build in 0..12_usize,
        changes in prop::collection::vec((any::<prop::sample::Index>(), prop::collection::vec(any::<u8>(), 0..6), 0..6_usize), 1..4),
    ) {
        let mut damaged = built::file(builds()[build]);
        for (place, bytes, cut) in changes {
            let start = place.index(damaged.len());
            let end = (start + cut).min(damaged.len());
            damaged.splice(start..end, bytes);
        }
        read(&damaged);
    }
}
