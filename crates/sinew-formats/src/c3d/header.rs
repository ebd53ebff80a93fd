//! First block of a C3D file: where its sections are, the layout of a frame, up to 18 events.
//!
//! Words of two bytes are counted from 1, as the format's manual does.

use super::events::C3dEvent;
use super::processor::Processor;
use super::source::{BLOCK, Source};
use crate::Error;
use crate::source_text::shortened;

/// Second byte of every file.
const MARK: u8 = 0x50;

/// Word 150 where the header has events.
pub(super) const HAS_EVENTS: u16 = 12_345;

/// Events that a header can hold.
pub(super) const EVENTS: usize = 18;

const INSIDE: &str = "the header";

/// What the first block says.
pub(super) struct Header {
    /// First byte of the parameter section, from 0.
    pub(super) parameters_at: usize,
    pub(super) points: u16,
    /// Samples of all analog channels in a frame.
    pub(super) analog_words: u16,
    pub(super) first_frame: u16,
    pub(super) last_frame: u16,
    /// Negative where points and samples are reals.
    pub(super) scale: f64,
    /// Block with the first frame, from 1; 0 where it is not given.
    pub(super) data_block: u16,
    /// Samples of a channel in a frame.
    pub(super) samples_per_frame: u16,
    pub(super) rate_hz: f64,
    pub(super) events: Vec<C3dEvent>,
}

/// The file with the order of bytes that its parameter section names, and its header.
pub(super) fn read<'a>(name: &'a str, bytes: &'a [u8]) -> Result<(Source<'a>, Header), Error> {
    let mut source = Source { name, bytes, processor: Processor::Intel };
    let start = source.slice(0, 2, INSIDE)?;
    if start[1] != MARK {
        return Err(source.place(1).syntax(format!("{:#04X}", start[1]), "0x50, which marks a C3D file"));
    }
    let parameters_at = match usize::from(start[0]) {
        0 => return Err(source.bad("the block of the parameters", 0, "1 or more")),
        block => (block - 1) * BLOCK,
    };
    let number = source.byte(parameters_at + 3, "the parameter section")?;
    source.processor = Processor::numbered(number)
        .ok_or_else(|| source.bad("the processor", number, "84 (Intel), 85 (DEC) or 86 (MIPS)"))?;
    source.slice(0, BLOCK, INSIDE)?;
    let word = |number: usize| source.word(2 * (number - 1), INSIDE);
    let real = |number: usize| source.real(2 * (number - 1), INSIDE);
    let header = Header {
        parameters_at,
        points: word(2)?,
        analog_words: word(3)?,
        first_frame: word(4)?,
        last_frame: word(5)?,
        scale: real(7)?,
        data_block: word(9)?,
        samples_per_frame: word(10)?,
        rate_hz: real(11)?,
        events: if word(150)? == HAS_EVENTS { events(&source, word(151)?)? } else { Vec::new() },
    };
    Ok((source, header))
}

/// Times from word 153, labels of four letters from word 199.
fn events(source: &Source<'_>, count: u16) -> Result<Vec<C3dEvent>, Error> {
    let count = usize::from(count).min(EVENTS);
    let event = |index: usize| {
        let label = source.slice(396 + 4 * index, 4, INSIDE)?;
        let label = shortened(&super::parameters::text(label));
        Ok(C3dEvent { time_s: source.real(304 + 4 * index, INSIDE)?, label, ..C3dEvent::default() })
    };
    let events = (0..count).map(event).collect::<Result<Vec<_>, Error>>()?;
    Ok(events.into_iter().filter(|event| event.time_s.is_finite()).collect())
}
