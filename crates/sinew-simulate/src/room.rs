//! A way through a room that turns before its walls.
//!
//! In the walker's frame the room's middle is the origin and y is the direction of the first steps. The way is a line up through the middle, a half turn to the left, a line down
//! beside the wall, a half turn back to the middle, and the same to the right, over and over. At the way σ from the middle the heading is
//!
//! ```text
//! straight: constant        half turn of length ℓ, u = (σ − σ₀)/ℓ:   ± π (I(4u) − I(4u − 3)) / 3,   I the integral of a quintic step
//! ```
//!
//! so that the curvature rises to 4π/3ℓ, stays, and falls, without a jump. The first line begins at the wall.

use crate::walker::step_integral;
use std::f64::consts::PI;

/// How far the root of the body stays from the walls: room for arms and feet, metres.
pub const WALL_M: f64 = 0.6;
/// Sides below which no half turn of a person fits, metres.
const LEAST_SIDE_M: f64 = 4.0;
/// Width of a half turn that needs no hurry, metres.
const WIDE_M: f64 = 2.5;
/// Steps of the way in which it is summed, metres.
const STEP_M: f64 = 0.005;
/// How far ahead of the root and behind it a foot is, metres.
const FEET_M: f64 = 1.0;
/// Steps in which the shape of a half turn is summed.
const SHAPE: u32 = 1000;

/// Heading of a half turn to the left after a part u of it, radians.
fn turned(u: f64) -> f64 {
    PI * (step_integral(4.0 * u) - step_integral(4.0 * u - 3.0)) / 3.0
}

/// A way through a room.
#[derive(Clone, Debug, PartialEq)]
pub struct Way {
    /// Half of the line through the middle, metres.
    half_line: f64,
    /// Length of a half turn, metres.
    turn: f64,
    /// From the first wall to the middle, metres.
    start: f64,
    /// Places at multiples of [`STEP_M`] from [`FEET_M`] before the start.
    places: Vec<[f64; 2]>,
}

impl Way {
    /// Through a room of some width and depth, metres, for a walk of some length; `None` where that goes straight through the middle. Sides of less than 4 m count as 4 m.
    #[must_use]
    pub fn new(room_m: [f64; 2], length: f64) -> Option<Self> {
        let [across, start] = room_m.map(|side| 0.5 * side.max(LEAST_SIDE_M) - WALL_M);
        if length <= 2.0 * start {
            return None;
        }
        // Width and depth of a half turn of length 1.
        let heading = |k: u32| turned((f64::from(k) + 0.5) / f64::from(SHAPE));
        let width = (0..SHAPE).map(|k| heading(k).sin()).sum::<f64>() / f64::from(SHAPE);
        let depth = (0..SHAPE / 2).map(|k| heading(k).cos()).sum::<f64>() / f64::from(SHAPE);
        let turn = (across.min(WIDE_M) / width).min(start / depth);
        let mut way = Self { half_line: start - depth * turn, turn, start, places: vec![] };
        let steps = ((length + 2.0 * FEET_M) / STEP_M).ceil() as usize + 1;
        let mut place = [0.0, -start - FEET_M];
        for step in 0..=steps {
            way.places.push(place);
            let (sin, cos) = way.heading(-FEET_M + STEP_M * (step as f64 + 0.5)).sin_cos();
            place = [place[0] - STEP_M * sin, place[1] + STEP_M * cos];
        }
        Some(way)
    }

    /// Heading after some way from the start, radians, positive to the left.
    #[must_use]
    pub fn heading(&self, way: f64) -> f64 {
        let leg = 2.0 * self.half_line + self.turn;
        let from_corner = (way - self.start + self.half_line).max(0.0);
        let leg_number = (from_corner / leg).floor();
        let u = (from_corner - leg_number * leg - 2.0 * self.half_line).max(0.0) / self.turn;
        match leg_number as u64 % 4 {
            0 => turned(u),
            1 => PI + turned(u),
            2 => 2.0 * PI - turned(u),
            _ => PI - turned(u),
        }
    }

    /// Place after some way from the start, seen from the room's middle, metres.
    #[must_use]
    pub fn place(&self, way: f64) -> [f64; 2] {
        let at = ((way + FEET_M) / STEP_M).clamp(0.0, self.places.len().saturating_sub(2) as f64);
        let [a, b] = [0, 1].map(|k| self.places[at as usize + k]);
        let part = at.fract();
        [0, 1].map(|k| a[k] + part * (b[k] - a[k]))
    }

    /// From the start to the room's middle, metres.
    #[must_use]
    pub const fn start(&self) -> f64 {
        self.start
    }

    /// Place and heading of a foot that is at `[across, ahead]` of the root of somebody who walks straight: along the way, so that it stands while the root passes. Both relative to root and heading.
    #[must_use]
    pub fn bent(&self, way: f64, [across, ahead]: [f64; 2]) -> ([f64; 2], f64) {
        let (heading, own) = (self.heading(way), self.heading(way + ahead));
        let (root, under) = (self.place(way), self.place(way + ahead));
        let [x, y] = [under[0] - root[0] + across * own.cos(), under[1] - root[1] + across * own.sin()];
        let (sin, cos) = heading.sin_cos();
        ([cos * x + sin * y, cos * y - sin * x], own - heading)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_stays_in_its_room_and_turns_smoothly() {
        for room_m in [[6.0, 6.0], [4.0, 4.0], [5.0, 12.0], [12.0, 4.0], [1.0, f64::NAN]] {
            let way = Way::new(room_m, 80.0).unwrap();
            let half = room_m.map(|side| 0.5 * side.max(4.0) - WALL_M + 1e-6);
            let (mut last, mut left, mut right) = (0.0, 0.0_f64, 0.0_f64);
            for step in 0..8000 {
                let at = 0.01 * f64::from(step);
                let place = way.place(at);
                assert!((0..2).all(|k| place[k].abs() < half[k]), "{room_m:?}: {place:?} after {at} m");
                let heading = way.heading(at);
                let curvature = (heading - last) / 0.01;
                assert!(curvature.abs() < 4.0 * PI / 3.0 / way.turn + 1e-6, "{curvature} 1/m");
                (left, right) = (left.max(place[0]), right.min(place[0]));
                last = heading;
            }
            // To both sides, and no step of the table is a jump.
            let wide = half[0].min(half[1]).min(WIDE_M);
            assert!(left > 0.9 * wide && right < -0.9 * wide, "{left} {right}");
            let steps = way.places.windows(2).map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]));
            assert!(steps.into_iter().all(|length| (length - STEP_M).abs() < 1e-12));
        }
        assert_eq!(Way::new([6.0, 6.0], 4.7), None);
        assert_eq!(Way::new([f64::INFINITY; 2], 1e3), None);
    }
}
