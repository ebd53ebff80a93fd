//! Three angles of a rotation.
//!
//! Our bodies have the axes x right, y forward, z up. ISB names the same axes z, x, y.
//!
//! | sequence | rotation | angles | singular |
//! |---|---|---|---|
//! | flexion, adduction, rotation | R_x(a) R_y(b) R_z(c) | Grood & Suntay, J. Biomech. Eng. 105 (1983) 136–144: about the right axis of the proximal link, the floating axis, the long axis of the distal link | b = ±90° |
//! | rotation, obliquity, tilt | R_z(c) R_y(b) R_x(a) | Baker, Gait & Posture 13 (2001) 1–6: about the vertical, the floating axis, the pelvis' own right axis; tilt and obliquity do not depend on where somebody faces | b = ±90° |
//! | plane, elevation, rotation | R_z(a) R_y(b) R_z(c) | Wu et al., J. Biomech. 38 (2005) 981–992, §2.4.7: Y–X–Y of the ISB's axes | b = 0, 180° |

use crate::circle::{self, TURN_RAD};
use std::f64::consts::PI;

/// A rotation, rows first.
pub(crate) type Matrix = [[f64; 3]; 3];

/// How a rotation is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AngleSequence {
    /// One axis.
    Hinge,
    /// R_x(a) R_y(b) R_z(c).
    FlexionAdductionRotation,
    /// R_z(c) R_y(b) R_x(a), of a link against the ground.
    RotationObliquityTilt,
    /// R_z(a) R_y(b) R_z(c) of a right arm, b from −π to 0: a right arm is raised by turning about back.
    RightElevation,
    /// The same of a left arm, b from 0 to π.
    LeftElevation,
}

impl AngleSequence {
    /// The angles, each but the middle one within half a turn.
    #[must_use]
    pub fn angles(self, m: &Matrix) -> [f64; 3] {
        match self {
            Self::Hinge | Self::FlexionAdductionRotation => {
                let flexion = (-m[1][2]).atan2(m[2][2]);
                [flexion, m[0][2].atan2(m[0][0].hypot(m[0][1])), (-m[0][1]).atan2(m[0][0])]
            }
            Self::RotationObliquityTilt => {
                let obliquity = (-m[2][0]).atan2(m[2][1].hypot(m[2][2]));
                [m[2][1].atan2(m[2][2]), obliquity, m[1][0].atan2(m[0][0])]
            }
            Self::RightElevation | Self::LeftElevation => {
                let tilt = m[0][2].hypot(m[1][2]);
                if tilt == 0.0 {
                    // The plane is any: all of the turn is rotation.
                    return [0.0, if m[2][2] < 0.0 { PI } else { 0.0 }, m[1][0].atan2(m[1][1])];
                }
                let [a, b, c] = [m[1][2].atan2(m[0][2]), tilt.atan2(m[2][2]), m[2][1].atan2(-m[2][0])];
                if self == Self::LeftElevation { [a, b, c] } else { [within_half(a + PI), -b, within_half(c + PI)] }
            }
        }
    }
}

fn within_half(angle: f64) -> f64 {
    circle::near(angle, 0.0, TURN_RAD)
}

/// Of the angles that give the same rotation, those nearest to the ones before.
#[must_use]
pub fn near(sequence: AngleSequence, [a, b, c]: [f64; 3], before: [f64; 3]) -> [f64; 3] {
    let turned = |angles: [f64; 3]| [0, 1, 2].map(|k| circle::near(angles[k], before[k], TURN_RAD));
    let one = turned([a, b, c]);
    if !matches!(sequence, AngleSequence::FlexionAdductionRotation | AngleSequence::RotationObliquityTilt) {
        return one;
    }
    let other = turned([a + PI, PI - b, c + PI]);
    let apart = |angles: &[f64; 3]| angles.iter().zip(before).map(|(x, y)| (x - y).abs()).sum::<f64>();
    if apart(&other) < apart(&one) { other } else { one }
}

/// m R_axis(angle).
#[must_use]
pub fn turned(mut m: Matrix, axis: usize, angle: f64) -> Matrix {
    let (s, c) = angle.sin_cos();
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    for row in &mut m {
        (row[i], row[j]) = (c * row[i] + s * row[j], c * row[j] - s * row[i]);
    }
    m
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_formats::rotation::{IDENTITY, about_axis, product};

    fn about_axes(axes: [usize; 3], angles: [f64; 3]) -> Matrix {
        let [a, b, c] = [0, 1, 2].map(|k| about_axis(axes[k], angles[k]));
        product(&product(&a, &b), &c)
    }

    #[test]
    fn a_turn_is_a_product() {
        let m = about_axes([0, 2, 1], [0.3, -1.1, 2.0]);
        for axis in 0..3 {
            let (found, expected) = (turned(m, axis, 0.7), product(&m, &about_axis(axis, 0.7)));
            assert!(found.iter().flatten().zip(expected.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-15));
        }
    }

    #[test]
    fn angles_of_a_ball_come_back_and_do_not_jump() {
        for sequence in [AngleSequence::FlexionAdductionRotation, AngleSequence::RotationObliquityTilt] {
            let mut before = None;
            for step in 0..400 {
                let t = f64::from(step) * 0.02;
                let angles = [0.8 * t, 0.9 * (1.3 * t).sin(), -0.7 * t];
                let [a, b, c] = angles;
                let m = match sequence {
                    AngleSequence::RotationObliquityTilt => about_axes([2, 1, 0], [c, b, a]),
                    _ => about_axes([0, 1, 2], angles),
                };
                let found = sequence.angles(&m);
                let found = before.map_or(found, |before| near(sequence, found, before));
                assert!(found.iter().zip(angles).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} {angles:?}");
                before = Some(found);
            }
        }
    }

    /// A pelvis that leans forward and to the right, seen by people who face everywhere.
    #[test]
    fn tilt_and_obliquity_do_not_depend_on_where_somebody_faces() {
        let own = about_axes([1, 0, 2], [0.2, -0.3, 0.1]);
        let still = AngleSequence::RotationObliquityTilt.angles(&own);
        let opensim = AngleSequence::FlexionAdductionRotation.angles(&own);
        // About axes of the ground they do.
        let turned = product(&about_axis(2, PI), &own);
        assert!((AngleSequence::FlexionAdductionRotation.angles(&turned)[0] + opensim[0]).abs() < 0.1);
        assert!(opensim[0] < -0.2, "{opensim:?}");
        for turn in [PI / 2.0, PI, -PI / 2.0, 0.7] {
            let m = product(&about_axis(2, turn), &own);
            let [tilt, obliquity, rotation] = AngleSequence::RotationObliquityTilt.angles(&m);
            assert!((tilt - still[0]).abs() < 1e-12 && (obliquity - still[1]).abs() < 1e-12, "{turn}");
            assert!(within_half(rotation - still[2] - turn).abs() < 1e-12, "{turn}");
        }
    }

    #[test]
    fn elevations_of_both_arms_come_back() {
        for (sequence, sign) in [(AngleSequence::RightElevation, -1.0), (AngleSequence::LeftElevation, 1.0)] {
            let mut before = None;
            for step in 0..400 {
                let t = f64::from(step) * 0.02;
                let angles = [0.8 * t, sign * (1.4 + 1.3 * (1.3 * t).sin()), -0.7 * t];
                let found = sequence.angles(&about_axes([2, 1, 2], angles));
                let found = before.map_or(found, |before| near(sequence, found, before));
                assert!(found.iter().zip(angles).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} {angles:?}");
                before = Some(found);
            }
            assert_eq!(sequence.angles(&IDENTITY), [0.0; 3]);
        }
    }
}
