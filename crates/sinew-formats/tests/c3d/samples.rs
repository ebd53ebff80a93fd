//! Recordings of three laboratories against what ezc3d 1.7.2 reads in them (`crates/sinew-studies/peers/c3d_ezc3d.py`).
//!
//! Residuals and cameras are the bytes that the format's manual names, which the same script prints: ezc3d
//! takes the high byte of words for the residual and the low byte for the cameras, and has a point at the origin where
//! the real 65 535 stands for the word −1.

use super::shared_data::shared;
use sinew_formats::c3d::{self, C3d, ScreenAxis};
use sinew_formats::trc::Units;

pub const SAMPLES: [&str; 3] = ["cmu_dribble_shoot_basketball", "JA1Gait35", "trial2"];

/// Bytes of a recording, where it is there.
pub fn bytes(name: &str) -> Option<Vec<u8>> {
    Some(std::fs::read(shared("c3d_samples")?.join(format!("{name}.c3d"))).unwrap())
}

fn sample(name: &str) -> Option<C3d> {
    Some(c3d::read(name, &bytes(name)?).unwrap())
}

/// What ezc3d says of points.
struct Points {
    points: usize,
    frames: usize,
    rate_hz: f64,
    first_frame: u32,
    right: ScreenAxis,
    labels: [&'static str; 2],
    /// Points that are missing, and points with a residual.
    missing_and_measured: [usize; 2],
    /// Frame, point, position in mm, residual, cameras.
    positions: [(usize, usize, [f64; 3], f32, u8); 5],
}

fn check_points(file: &C3d, expected: &Points) {
    assert_eq!(file.warnings, []);
    let header = &file.header;
    assert_eq!((header.markers.len(), file.frames.len()), (expected.points, expected.frames));
    assert_eq!((header.rate_hz, header.units), (expected.rate_hz, Units::Millimetres));
    assert_eq!((header.first_frame, header.right), (expected.first_frame, Some(expected.right)));
    assert_eq!(header.up, Some(ScreenAxis::Z));
    assert_eq!([&header.markers[0], &header.markers[expected.points - 1]], expected.labels);
    let all = || file.frames.iter().flatten();
    let missing = all().filter(|point| point.is_none()).count();
    let measured = all().flatten().filter(|point| point.residual > 0.0).count();
    assert_eq!([missing, measured], expected.missing_and_measured);
    for (frame, point, position, residual, cameras) in expected.positions {
        let found = file.frames[frame][point].unwrap();
        assert_eq!(found.position, position, "frame {frame}, point {point}");
        assert!((found.residual - residual).abs() <= 1e-6 * residual, "{found:?}");
        assert_eq!(found.cameras, cameras);
    }
}

fn check_analog(file: &C3d, rate_hz: f64, names: [(&str, &str); 2], samples: &[(usize, usize, f64)]) {
    assert_eq!(file.analog_rate_hz(), rate_hz);
    let channels = &file.analog.channels;
    let ends = [&channels[0], &channels[channels.len() - 1]].map(|channel| (&channel.name[..], &channel.units[..]));
    assert_eq!(ends, names);
    for &(channel, sample, value) in samples {
        assert_eq!(channels[channel].samples[sample], value, "channel {channel}, sample {sample}");
    }
}

#[test]
fn words_of_a_motion_capture_database() {
    let Some(file) = sample("cmu_dribble_shoot_basketball") else { return };
    check_points(
        &file,
        &Points {
            points: 41,
            frames: 494,
            rate_hz: 120.0,
            first_frame: 187,
            right: ScreenAxis::X,
            labels: ["Justin:LFHD", "Justin:RMT5"],
            missing_and_measured: [0, 20_120],
            positions: [
                (0, 0, [-1226.050030708313, 194.96430373191833, 1658.7159113883972], 0.0, 6),
                (0, 40, [-1174.2948007583618, -25.387508630752563, 22.25082802772522], 1.176_255_2, 115),
                (100, 5, [-618.7102489471436, 86.94486546516418, 1270.7477293014526], 0.980_212_7, 7),
                (493, 0, [3021.603633403778, -42.443209409713745, 1700.669014453888], 2.352_510_5, 120),
                (493, 40, [3063.3606939315796, -172.1253480911255, 43.42342209815979], 1.372_297_8, 15),
            ],
        },
    );
    assert_eq!((file.analog.channels.len(), file.analog_rate_hz(), file.events.len()), (0, 600.0, 0));
}

#[test]
fn reals_of_a_sprint_with_force_plates_muscles_and_events() {
    let Some(file) = sample("JA1Gait35") else { return };
    check_points(
        &file,
        &Points {
            points: 53,
            frames: 324,
            rate_hz: 250.0,
            first_frame: 833,
            right: ScreenAxis::X,
            labels: ["C7", "*53"],
            missing_and_measured: [1, 0],
            positions: [
                (0, 0, [160.038330078125, -5971.802734375, 1494.5751953125], 0.0, 0),
                (0, 52, [-135.24769592285156, -6433.88134765625, 1114.513916015625], 0.0, 0),
                (100, 5, [-81.370361328125, -2246.189697265625, 1274.919921875], 0.0, 0),
                (323, 0, [290.8525695800781, 6328.3125, 1433.8201904296875], 0.0, 0),
                (323, 52, [9.227657318115234, 6371.34326171875, 766.08740234375], 0.0, 0),
            ],
        },
    );
    assert_eq!((file.analog.channels.len(), file.analog.is_unsigned), (60, true));
    let samples = [(0, 0, 0.0), (3, 7, 0.0), (59, 1943, -0.04974365234375)];
    check_analog(&file, 1500.0, [("Fx1", "N"), ("MSOLEUS", "V")], &samples);
    let events: Vec<(f64, &str, &str)> =
        file.events.iter().map(|event| (event.time_s, &event.context[..], &event.label[..])).collect();
    assert_eq!(events.len(), 10);
    assert_eq!(events[0], (4.599999904632568, "Right", "Foot Strike"));
    assert_eq!(events[9], (4.363999843597412, "Left", "Foot Strike"));
    // The events lie within the recording.
    assert!(events.iter().all(|(time_s, ..)| (file.time_s(0)..file.time_s(323)).contains(time_s)));
    assert!(file.events.iter().all(|event| event.subject == "JA1"));
}

#[test]
fn reals_of_a_laboratory_with_samples_of_force_plates() {
    let Some(file) = sample("trial2") else { return };
    check_points(
        &file,
        &Points {
            points: 37,
            frames: 48,
            rate_hz: 240.0,
            first_frame: 1,
            right: ScreenAxis::Y,
            labels: ["R.Shoulder", "L.MedialAnkle"],
            missing_and_measured: [0, 0],
            positions: [
                (0, 0, [-248.03805541992188, -418.4676513671875, 1480.06396484375], 0.0, 0),
                (0, 36, [-347.44659423828125, -178.85275268554688, 115.48247528076172], 0.0, 0),
                (4, 5, [-335.1160888671875, 94.2823715209961, 1260.96923828125], 0.0, 0),
                (47, 0, [-248.06898498535156, -419.01031494140625, 1481.06884765625], 0.0, 0),
                (47, 36, [-347.4896240234375, -178.86585998535156, 115.56588745117188], 0.0, 0),
            ],
        },
    );
    let samples = [
        (0, 0, 0.1983642578125),
        (3, 7, -0.0152587890625),
        (23, 239, -0.5340576171875),
        (2, 100, 0.030517578125),
        (8, 120, -0.0762939453125),
    ];
    check_analog(&file, 1200.0, [("F1X", "N"), ("M4Z", "Nmm")], &samples);
    assert_eq!((file.analog.channels.len(), file.analog.is_unsigned, file.events.len()), (24, false, 0));
}
