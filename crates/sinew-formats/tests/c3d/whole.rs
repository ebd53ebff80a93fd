//! A file that was read and written again holds the same, as reals for Intel.

use super::built::{self, Build};
use super::samples::{SAMPLES, bytes};
use super::storage::{DEC, INTEL, MIPS};
use sinew_formats::c3d::{self, C3d, C3dGroup, Processor};

/// Parameters that say how frames are stored, which is another way now.
const ABOUT_LAYOUT: [&str; 3] = ["SCALE", "DATA_START", "FRAMES"];

fn without_layout(groups: &[C3dGroup]) -> Vec<C3dGroup> {
    let mut groups = groups.to_vec();
    for group in groups.iter_mut().filter(|group| group.name == "POINT") {
        group.parameters.retain(|parameter| !ABOUT_LAYOUT.contains(&&parameter.name[..]));
    }
    // Whether a text has room behind it is no difference.
    for parameter in groups.iter_mut().flat_map(|group| &mut group.parameters) {
        if let (c3d::C3dValues::Texts(_), Some(width)) = (&parameter.values, parameter.dimensions.first_mut()) {
            *width = 0;
        }
    }
    groups
}

fn again(name: &str, file: &C3d) -> C3d {
    let mut out = vec![];
    c3d::write_whole(&mut out, file).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_eq!(out.len() % 512, 0);
    c3d::read(name, &out).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn near(found: f64, expected: f64, unit: f64) -> bool {
    (found - expected).abs() <= 2e-7 * expected.abs().max(unit)
}

fn check(name: &str, bytes: &[u8]) {
    let file = c3d::read(name, bytes).unwrap();
    let found = again(name, &file);
    assert_eq!((found.processor, &found.header), (Processor::Intel, &file.header), "{name}");
    assert_eq!((&found.events, &found.warnings), (&file.events, &file.warnings), "{name}");
    assert_eq!(without_layout(&found.groups), without_layout(&file.groups), "{name}");
    assert!(near(found.scale, file.scale, 0.0));
    for (found, expected) in found.frames.iter().flatten().zip(file.frames.iter().flatten()) {
        let (Some(found), Some(expected)) = (found, expected) else {
            assert!(found.is_none() && expected.is_none(), "{name}: {found:?} {expected:?}");
            continue;
        };
        assert!((0..3).all(|k| near(found.position[k], expected.position[k], 0.0)), "{name}: {found:?} {expected:?}");
        assert_eq!(found.cameras, expected.cameras, "{name}");
        assert!(near(found.residual.into(), expected.residual.into(), 0.0), "{name}: {found:?} {expected:?}");
    }
    assert_eq!(found.frames.len(), file.frames.len());
    let (found, expected) = (&found.analog, &file.analog);
    assert_eq!((found.samples_per_frame, found.channels.len()), (expected.samples_per_frame, expected.channels.len()));
    for (found, expected) in found.channels.iter().zip(&expected.channels) {
        assert_eq!((&found.name, &found.units), (&expected.name, &expected.units));
        // What is stored are the sample and its offset together, in four bytes.
        let unit = expected.samples.iter().fold(expected.scale * expected.offset, |most, x| most.abs().max(x.abs()));
        assert_eq!(found.samples.len(), expected.samples.len());
        assert!(found.samples.iter().zip(&expected.samples).all(|(a, b)| near(*a, *b, unit)), "{name} {}", found.name);
    }
}

#[test]
fn recordings_of_laboratories_keep_all_that_they_hold() {
    for name in SAMPLES {
        let Some(bytes) = bytes(name) else { return };
        check(name, &bytes);
    }
}

#[test]
fn files_of_every_processor_and_kind_keep_all_that_they_hold() {
    for processor in [INTEL, DEC, MIPS] {
        for (is_real, is_unsigned) in [(false, false), (false, true), (true, false)] {
            check("built.c3d", &built::file(Build { processor, is_real, is_unsigned }));
        }
    }
}

#[test]
fn a_second_time_nothing_changes() {
    let file = c3d::read("a", &built::file(Build { processor: MIPS, is_real: false, is_unsigned: true })).unwrap();
    let first = again("a", &file);
    let second = again("a", &first);
    assert!(first == second);
}
