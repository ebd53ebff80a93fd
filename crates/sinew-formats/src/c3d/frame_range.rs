//! Which frames a C3D file holds, from four places that may say it.
//!
//! The header's words end at 65 535. Beyond it TRIAL:ACTUAL_START_FIELD and ACTUAL_END_FIELD say it in two words each, or
//! POINT:LONG_FRAMES as a real. The first statement that the file has room for is taken: TRIAL, LONG_FRAMES, the
//! header, POINT:FRAMES. Programs that cut a recording often leave TRIAL as it was.

use super::header::Header;
use super::parameters::{C3dGroup, count};
use super::source::Source;
use crate::{Error, Place, Warning};

/// Number of the first frame, and how many there are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FrameRange {
    pub(super) first: u32,
    pub(super) count: usize,
}

/// What a file says in one of the places.
struct Statement {
    field: &'static str,
    first: u64,
    count: u64,
    /// Whether the place ends at 65 535.
    is_short: bool,
}

/// `room` is the number of frames that the bytes can hold.
pub(super) fn frame_range(
    source: &Source<'_>,
    header: &Header,
    groups: &[C3dGroup],
    room: u64,
    warnings: &mut Vec<Warning>,
) -> Result<FrameRange, Error> {
    let stated = statements(header, groups);
    let place = || Place::file(source.name);
    let Some(taken) = stated.iter().find(|statement| statement.count <= room) else {
        let least = stated.iter().map(|statement| statement.count).min().unwrap_or_default();
        let bytes = source.bytes.len() as u64;
        return Err(Error::ImpossibleCount { place: place(), claimed: least, unit: "frames", bytes });
    };
    let is_long = taken.first + taken.count > u64::from(u16::MAX);
    let others = stated.iter().filter(|other| other.count != taken.count && !(is_long && other.is_short));
    let disagreement = |other: &Statement| Warning::CountDisagrees {
        place: place(),
        field: other.field,
        stated: other.count,
        found: taken.count,
    };
    warnings.extend(others.map(disagreement));
    let range = u32::try_from(taken.first).ok().zip(usize::try_from(taken.count).ok());
    let (first, count) = range.ok_or_else(|| source.bad(taken.field, taken.first, "a frame number below 2^32"))?;
    Ok(FrameRange { first, count })
}

/// In the order in which they are believed.
fn statements(header: &Header, groups: &[C3dGroup]) -> Vec<Statement> {
    let ends = ["ACTUAL_START_FIELD", "ACTUAL_END_FIELD"].map(|name| count(groups, "TRIAL", name));
    let between = |first: u64, last: u64| (last + 1).checked_sub(first);
    let in_header = [header.first_frame, header.last_frame].map(u64::from);
    let mut stated = Vec::new();
    let mut state = |field, first, count: Option<u64>, is_short| {
        stated.extend(count.map(|count| Statement { field, first, count, is_short }));
    };
    let mut first = in_header[0];
    if let [Some(start), Some(end)] = ends
        && let Some(count) = between(start, end)
    {
        first = start;
        state("TRIAL:ACTUAL_END_FIELD", start, Some(count), false);
    }
    state("POINT:LONG_FRAMES", first, count(groups, "POINT", "LONG_FRAMES"), false);
    state("the header", in_header[0], between(in_header[0], in_header[1]), true);
    state("POINT:FRAMES", first, count(groups, "POINT", "FRAMES"), true);
    if stated.is_empty() {
        stated.push(Statement { field: "the header", first, count: 0, is_short: true });
    }
    stated
}

#[cfg(test)]
mod tests {
    use super::super::parameters::{C3dParameter, C3dValues};
    use super::super::processor::Processor;
    use super::*;

    fn check(
        header: [u16; 2],
        trial: Option<[u32; 2]>,
        frames: Option<u16>,
        room: u64,
        expected: Result<(u32, usize, usize), &str>,
    ) {
        let parameter = |name: &str, words: Vec<u16>| C3dParameter {
            name: name.into(),
            description: String::new(),
            dimensions: vec![words.len() as u8],
            values: C3dValues::Integers(words.into_iter().map(|word| word as i16).collect()),
        };
        let names = ["ACTUAL_START_FIELD", "ACTUAL_END_FIELD"];
        let trial = trial.into_iter().flatten().zip(names);
        let trial = trial.map(|(value, name)| parameter(name, vec![value as u16, (value >> 16) as u16])).collect();
        let point = frames.into_iter().map(|count| parameter("FRAMES", vec![count])).collect();
        let group = |name: &str, parameters| C3dGroup { name: name.into(), parameters, ..C3dGroup::default() };
        let header = Header {
            parameters_at: 512,
            points: 1,
            analog_words: 0,
            first_frame: header[0],
            last_frame: header[1],
            scale: -1.0,
            data_block: 3,
            samples_per_frame: 1,
            rate_hz: 50.0,
            events: vec![],
        };
        let source = Source { name: "a.c3d", bytes: &[0; 900], processor: Processor::Intel };
        let mut warnings = vec![];
        let groups = [group("TRIAL", trial), group("POINT", point)];
        let found = frame_range(&source, &header, &groups, room, &mut warnings);
        let found = found.map(|range| (range.first, range.count, warnings.len()));
        assert_eq!(found.map_err(|error| error.to_string()), expected.map_err(String::from));
    }

    #[test]
    fn the_first_statement_that_the_file_has_room_for() {
        check([1, 10], None, None, 10, Ok((1, 10, 0)));
        check([187, 680], Some([187, 680]), Some(494), 500, Ok((187, 494, 0)));
        // Cut after it was recorded; one place disagrees.
        check([11, 20], Some([1, 100]), Some(10), 12, Ok((11, 10, 1)));
        check([1, 65_535], Some([1, 70_000]), Some(65_535), 70_000, Ok((1, 70_000, 0)));
        check([65_535, 65_535], Some([80_000, 80_009]), Some(10), 10, Ok((80_000, 10, 0)));
        check([1, 10], None, None, 9, Err("a.c3d: file claims 10 frames, holds 900 bytes"));
        // Without any frame.
        check([1, 0], Some([1, 0]), Some(0), 0, Ok((1, 0, 0)));
        check([5, 1], None, None, 0, Ok((5, 0, 0)));
    }
}
