//! What a file built by hand says, whatever processor and numbers it is built for.

use super::built::{self, Build, FRAMES, MISSING, POINTS, SAMPLES_PER_FRAME, stored_position, stored_sample};
use super::storage::{DEC, INTEL, MIPS};
use sinew_formats::c3d::{self, C3d, C3dEvent, C3dValues, Processor, ScreenAxis};
use sinew_formats::trc::Units;

pub fn builds() -> Vec<Build> {
    let processors = [INTEL, DEC, MIPS].into_iter();
    let kinds = [(false, false), (false, true), (true, false), (true, true)];
    processors
        .flat_map(|processor| kinds.map(|(is_real, is_unsigned)| Build { processor, is_real, is_unsigned }))
        .collect()
}

fn check_points(file: &C3d, build: Build) {
    for frame in 0..FRAMES {
        for index in 0..POINTS {
            let Some(point) = file.frames[frame][index] else {
                assert_eq!((frame, index), MISSING);
                continue;
            };
            assert_ne!((frame, index), MISSING);
            let factor = if build.is_real { 1.0 } else { 0.5 };
            assert_eq!(point.position, stored_position(frame, index).map(|x| f64::from(x) * factor));
            assert_eq!((point.residual, point.cameras), (3.0, 0b101));
        }
    }
    // Y up, centimetres: (x, y, z) of the world = (Z, X, Y) of the file.
    let [x, y, z] = stored_position(1, 2).map(|x| f64::from(x) * if build.is_real { 1.0 } else { 0.5 });
    assert_eq!(file.point_in_world(1, 2), Some([z, x, y].map(|v| v * 0.01)));
}

fn check_analog(file: &C3d, build: Build) {
    assert_eq!((file.analog.samples_per_frame, file.analog.general_scale), (2, 0.5));
    assert_eq!((file.analog.is_unsigned, file.analog_rate_hz()), (build.is_unsigned, 100.0));
    let without_sign = [40_000.0, 100.0];
    let with_sign = [40_000.0 - 65_536.0, 100.0];
    let expected = [("Fz1", "N", 0.25), ("EMG", "V", 2.0)];
    for (index, (channel, (name, units, scale))) in file.analog.channels.iter().zip(expected).enumerate() {
        assert_eq!((&channel.name[..], &channel.units[..], channel.scale), (name, units, scale));
        assert_eq!(channel.offset, if build.is_unsigned { without_sign } else { with_sign }[index]);
        assert_eq!(channel.samples.len(), FRAMES * SAMPLES_PER_FRAME);
        for (time, sample) in channel.samples.iter().enumerate() {
            assert_eq!(*sample, (f64::from(stored_sample(time, index)) - channel.offset) * scale * 0.5);
        }
    }
}

#[test]
fn the_same_file_of_every_processor_says_the_same() {
    for build in builds() {
        let file = c3d::read("a.c3d", &built::file(build)).unwrap_or_else(|error| panic!("{build:?}: {error}"));
        assert_eq!(file.warnings, [], "{build:?}");
        let processor = [Processor::Intel, Processor::Dec, Processor::Mips][usize::from(build.processor - INTEL)];
        assert_eq!(file.processor, processor);
        let header = &file.header;
        assert_eq!((header.rate_hz, header.units, header.first_frame), (50.0, Units::Centimetres, 5));
        assert_eq!((header.right, header.up), (Some(ScreenAxis::X), Some(ScreenAxis::Y)));
        assert_eq!(header.markers, ["LASI", "R.Knee", "C7"]);
        assert_eq!((file.frames.len(), file.time_s(0), file.time_s(3)), (FRAMES, 0.08, 0.14));
        check_points(&file, build);
        check_analog(&file, build);
        let event = |time_s, label: &str, context: &str, subject: &str| C3dEvent {
            time_s,
            label: label.into(),
            context: context.into(),
            subject: subject.into(),
        };
        let expected = [
            event(1.25, "LHS", "", ""),
            event(0.5, "Foot Strike", "Left", "P1"),
            event(62.25, "Foot Off", "Right", "P1"),
        ];
        assert_eq!(file.events, expected);
        let names: Vec<&str> = file.groups.iter().map(|group| &group.name[..]).collect();
        assert_eq!(names, ["POINT", "ANALOG", "EVENT"]);
        let bits = c3d::find(&file.groups, "analog", "bits").unwrap();
        assert_eq!((&bits.values, &bits.dimensions[..]), (&C3dValues::Bytes(vec![16]), &[1][..]));
        assert_eq!(bits.description, "made for tests");
    }
}
