//! A C3D file built byte by byte, with all that a file may have.

use super::storage::{real, word};

/// What differs between builds.
#[derive(Clone, Copy, Debug)]
pub struct Build {
    pub processor: u8,
    pub is_real: bool,
    pub is_unsigned: bool,
}

/// Blocks of 512 bytes before the frames.
pub const BLOCKS_BEFORE: usize = 4;
pub const POINTS: usize = 3;
pub const FRAMES: usize = 4;
pub const SAMPLES_PER_FRAME: usize = 2;
pub const CHANNELS: usize = 2;
/// Point that is missing in a frame.
pub const MISSING: (usize, usize) = (2, 1);

/// What is stored of a point in a frame.
pub fn stored_position(frame: usize, point: usize) -> [i16; 3] {
    let x = (10 * point + frame) as i16;
    [x, -x, 200 + 2 * x]
}

/// What is stored of a channel at a time.
pub fn stored_sample(time: usize, channel: usize) -> u16 {
    (1000 * channel + 7 * time) as u16
}

/// The file.
pub fn file(build: Build) -> Vec<u8> {
    let mut out = header(build);
    out.extend(parameters(build));
    out.resize(BLOCKS_BEFORE * 512, 0);
    for frame in 0..FRAMES {
        for point in 0..POINTS {
            let is_missing = (frame, point) == MISSING;
            // Cameras 1 and 3 saw the point; residual 6 times the scale.
            let fourth = if is_missing { -1 } else { 0x0506 };
            for value in stored_position(frame, point).into_iter().chain([fourth]) {
                number(&mut out, build, value.into());
            }
        }
        for sample in 0..SAMPLES_PER_FRAME {
            for channel in 0..CHANNELS {
                let stored = stored_sample(frame * SAMPLES_PER_FRAME + sample, channel);
                number(&mut out, build, if build.is_unsigned { stored.into() } else { f32::from(stored as i16) });
            }
        }
    }
    out.resize(out.len().next_multiple_of(512), 0);
    out
}

fn number(out: &mut Vec<u8>, build: Build, value: f32) {
    if build.is_real {
        out.extend(real(build.processor, value));
    } else {
        out.extend(word(build.processor, value as i32 as u16));
    }
}

fn scale(build: Build) -> f32 {
    if build.is_real { -0.5 } else { 0.5 }
}

fn header(build: Build) -> Vec<u8> {
    let processor = build.processor;
    let mut out = vec![0; 512];
    out[..2].copy_from_slice(&[2, 0x50]);
    let mut put = |number: usize, bytes: &[u8]| out[2 * number - 2..][..bytes.len()].copy_from_slice(bytes);
    let words = [
        (2, POINTS),
        (3, CHANNELS * SAMPLES_PER_FRAME),
        (4, 5),
        (5, 4 + FRAMES),
        (9, BLOCKS_BEFORE + 1),
        (10, SAMPLES_PER_FRAME),
        (150, 12_345),
        (151, 1),
    ];
    for (number, value) in words {
        put(number, &word(processor, value as u16));
    }
    put(7, &real(processor, scale(build)));
    put(11, &real(processor, 50.0));
    put(153, &real(processor, 1.25));
    put(199, b"LHS ");
    out
}

/// A record of a parameter: type, extents, values.
fn parameter(out: &mut Vec<u8>, processor: u8, group: u8, name: &str, kind: i8, extents: &[u8], values: &[u8]) {
    // Negative lengths lock a parameter.
    let length = -(name.len() as i8);
    out.extend([length as u8, group]);
    out.extend(name.as_bytes());
    let description = b"made for tests";
    let distance = 2 + 2 + extents.len() + values.len() + 1 + description.len();
    out.extend(word(processor, distance as u16));
    out.extend([kind as u8, extents.len() as u8]);
    out.extend(extents);
    out.extend(values);
    out.push(description.len() as u8);
    out.extend(description);
}

fn group(out: &mut Vec<u8>, processor: u8, number: u8, name: &str) {
    out.extend([name.len() as u8, (-(number as i8)) as u8]);
    out.extend(name.as_bytes());
    out.extend(word(processor, 3));
    out.push(0);
}

fn parameters(build: Build) -> Vec<u8> {
    let processor = build.processor;
    let words = |values: &[u16]| values.iter().flat_map(|&value| word(processor, value)).collect::<Vec<_>>();
    let reals = |values: &[f32]| values.iter().flat_map(|&value| real(processor, value)).collect::<Vec<_>>();
    let mut out = vec![0, 0, 2, processor];
    // A parameter may stand before its group.
    parameter(&mut out, processor, 3, "USED", 2, &[], &words(&[2]));
    group(&mut out, processor, 1, "POINT");
    let mut point = |name, kind, extents: &[u8], values: &[u8]| {
        parameter(&mut out, processor, 1, name, kind, extents, values);
    };
    point("USED", 2, &[], &words(&[POINTS as u16]));
    point("SCALE", 4, &[], &reals(&[scale(build)]));
    point("RATE", 4, &[], &reals(&[50.0]));
    point("FRAMES", 2, &[], &words(&[FRAMES as u16]));
    point("DATA_START", 2, &[], &words(&[BLOCKS_BEFORE as u16 + 1]));
    point("LABELS", -1, &[6, 2], b"LASI  R.Knee");
    point("LABELS2", -1, &[4, 1], b"C7  ");
    point("UNITS", -1, &[2], b"cm");
    point("X_SCREEN", -1, &[2], b"+X");
    point("Y_SCREEN", -1, &[2], b"+Y");
    group(&mut out, processor, 2, "ANALOG");
    let mut analog = |name, kind, extents: &[u8], values: &[u8]| {
        parameter(&mut out, processor, 2, name, kind, extents, values);
    };
    analog("USED", 2, &[], &words(&[CHANNELS as u16]));
    analog("LABELS", -1, &[3, 2], b"Fz1EMG");
    analog("UNITS", -1, &[1, 2], b"NV");
    analog("SCALE", 4, &[2], &reals(&[0.25, 2.0]));
    analog("OFFSET", 2, &[2], &words(&[40_000, 100]));
    analog("GEN_SCALE", 4, &[], &reals(&[0.5]));
    let format: &[u8] = if build.is_unsigned { b"UNSIGNED" } else { b"SIGNED  " };
    analog("FORMAT", -1, &[8], format);
    analog("BITS", 1, &[1], &[16]);
    group(&mut out, processor, 3, "EVENT");
    let mut event = |name, kind, extents: &[u8], values: &[u8]| {
        parameter(&mut out, processor, 3, name, kind, extents, values);
    };
    event("LABELS", -1, &[11, 2], b"Foot StrikeFoot Off   ");
    event("CONTEXTS", -1, &[5, 2], b"Left Right");
    event("SUBJECTS", -1, &[2, 2], b"P1P1");
    event("TIMES", 4, &[2, 2], &reals(&[0.0, 0.5, 1.0, 2.25]));
    out.extend([0; 2]);
    out
}
