//! What is written comes back equal: points of every kind, many points, many frames.

use proptest::prelude::*;
use sinew_formats::c3d::{self, C3dHeader, ScreenAxis};
use sinew_formats::trc::Units;

/// Numbers of four bytes: ordinary ones, denormals, zeros of both signs, the largest.
fn number() -> impl Strategy<Value = f64> {
    use proptest::num::f32::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    prop_oneof![-10.0..10.0f32, POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO, Just(f32::MAX)].prop_map(f64::from)
}

type Frames = Vec<Vec<Option<[f64; 3]>>>;

fn written(header: &C3dHeader, frames: &Frames) -> Vec<u8> {
    let mut out = Vec::new();
    c3d::write(&mut out, header, frames).unwrap();
    assert_eq!(out.len() % 512, 0);
    out
}

fn check(header: &C3dHeader, frames: &Frames) {
    let read = c3d::read("a.c3d", &written(header, frames)).unwrap();
    assert_eq!(read.header, *header);
    assert_eq!(read.frames.len(), frames.len());
    for (found, expected) in read.frames.iter().zip(frames) {
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(expected) {
            let bits = |position: [f64; 3]| position.map(f64::to_bits);
            assert_eq!(found.map(|point| bits(point.position)), expected.map(bits));
            assert!(found.is_none_or(|point| (point.residual, point.cameras) == (0.0, 0)));
        }
    }
    let assumed = usize::from(header.up.is_none());
    assert_eq!((read.warnings.len(), read.analog.channels.len(), read.events.len()), (assumed, 0, 0));
}

fn screen_axis() -> impl Strategy<Value = Option<ScreenAxis>> {
    prop::option::of((0..3_usize, any::<bool>()).prop_map(|(axis, is_negative)| ScreenAxis { axis, is_negative }))
}

prop_compose! {
    fn recording()(names in prop::collection::btree_set("[A-Za-z*_][A-Za-z0-9 _é]{0,6}[A-Za-z0-9]", 0..4))(
        frames in prop::collection::vec(
            prop::collection::vec(prop::option::of([number(), number(), number()]), names.len()), 0..5),
        rate_hz in prop_oneof![Just(59.94), Just(60.0), (1..1_000_000_u32).prop_map(|rate| f64::from(rate) / 100.0)],
        first_frame in prop_oneof![1..100_u32, 60_000..70_000_u32, Just(u32::MAX - 5)],
        units in prop_oneof![Just(Units::Metres), Just(Units::Centimetres), Just(Units::Millimetres)],
        right in screen_axis(),
        up in screen_axis(),
        names in Just(Vec::from_iter(names)),
    ) -> (C3dHeader, Frames) {
        (C3dHeader { rate_hz, units, first_frame, right, up, markers: names }, frames)
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        failure_persistence: Some(Box::new(proptest::test_runner::FileFailurePersistence::Direct("tests/properties.proptest-regressions"))),
        ..ProptestConfig::default()
    })]

    #[test]
    fn points_come_back_equal((header, frames) in recording()) {
        check(&header, &frames);
    }
}

#[test]
fn more_points_than_a_list_of_labels_holds() {
    let markers = (0..600).map(|number| format!("marker {number}")).collect();
    let frame = |frame: usize| (0..600).map(|point| (point != frame).then_some([point as f64, 0.5, -1.0])).collect();
    check(&C3dHeader::new(100.0, markers), &(0..3).map(frame).collect());
}

#[test]
fn labels_of_the_greatest_length() {
    let markers = (0..300).map(|number| format!("{number:0>255}")).collect();
    check(&C3dHeader::new(100.0, markers), &vec![vec![None; 300]]);
}

#[test]
fn more_frames_than_a_word_counts() {
    let header = C3dHeader { first_frame: 66_000, ..C3dHeader::new(1000.0, vec!["a".into()]) };
    check(&header, &(0..70_000).map(|frame| vec![Some([f64::from(frame), 0.0, 0.0])]).collect());
}
