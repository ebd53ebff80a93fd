//! Recordings of laboratories as other processors would have written them: the samples are Intel's and DEC's.

use super::number_places::{Number, number_places};
use super::samples::{SAMPLES, bytes};
use super::storage::{DEC, INTEL, MIPS, real, stored_real, word};
use sinew_formats::c3d::{self, C3d, Processor};

fn transcoded(bytes: &[u8], processor: u8) -> Vec<u8> {
    let mut out = bytes.to_vec();
    let (numbers, processor_at) = number_places(bytes);
    for number in numbers {
        match number {
            Number::Word(at) => {
                let value = u16::from_le_bytes([bytes[at], bytes[at + 1]]);
                out[at..at + 2].copy_from_slice(&word(processor, value));
            }
            Number::Real(at) => {
                let stored = [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]];
                let value = stored_real(bytes[processor_at], stored);
                // VAX has no numbers that are not normal, and no zero with a sign.
                let value = if processor == DEC && !value.is_normal() { 0.0 } else { value };
                out[at..at + 4].copy_from_slice(&real(processor, value));
            }
        }
    }
    out[processor_at] = processor;
    out
}

#[test]
fn recordings_of_other_processors_are_the_same() {
    for name in SAMPLES {
        let Some(bytes) = bytes(name) else { return };
        let original = c3d::read(name, &bytes).unwrap();
        for (number, processor) in [(INTEL, Processor::Intel), (DEC, Processor::Dec), (MIPS, Processor::Mips)] {
            let transcoded = transcoded(&bytes, number);
            assert_eq!(transcoded == bytes, processor == original.processor);
            let read = c3d::read(name, &transcoded).unwrap_or_else(|error| panic!("{name}, {processor:?}: {error}"));
            assert_eq!(read.processor, processor);
            assert!(C3d { processor: original.processor, ..read } == original, "{name}, {processor:?}");
        }
    }
}
