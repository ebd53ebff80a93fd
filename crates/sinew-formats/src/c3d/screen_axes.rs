//! Axes of a C3D file: POINT:X_SCREEN and POINT:Y_SCREEN, which say what points right and up when it is shown.
//!
//! A file has any axes; nothing else in it says which of them is vertical. Vicon and most laboratories have +Z up,
//! programs that come from animation +Y.

/// An axis of a file with its sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScreenAxis {
    /// 0, 1 or 2 for X, Y or Z.
    pub axis: usize,
    /// Whether its negative direction is meant.
    pub is_negative: bool,
}

impl ScreenAxis {
    /// +X.
    pub const X: Self = Self { axis: 0, is_negative: false };
    /// +Y.
    pub const Y: Self = Self { axis: 1, is_negative: false };
    /// +Z.
    pub const Z: Self = Self { axis: 2, is_negative: false };

    /// The axis that a text names: `+X`, `-z`, `Y`.
    #[must_use]
    pub fn named(text: &str) -> Option<Self> {
        let is_negative = text.starts_with('-');
        let axis = match text.strip_prefix(['+', '-']).unwrap_or(text) {
            "X" | "x" => 0,
            "Y" | "y" => 1,
            "Z" | "z" => 2,
            _ => return None,
        };
        Some(Self { axis, is_negative })
    }

    /// Its name: `+X`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match (self.axis, self.is_negative) {
            (0, false) => "+X",
            (0, true) => "-X",
            (1, false) => "+Y",
            (1, true) => "-Y",
            (_, false) => "+Z",
            (_, true) => "-Z",
        }
    }

    /// From the axes of a file in which this axis points up to the world (z up).
    ///
    /// Axes keep their order around the vertical: with +Z up nothing changes, with +Y up (x, y, z) = (Z, X, Y) as in TRC
    /// files, with +X up (Y, Z, X). An axis that points down is turned up by half a turn about the world's x.
    #[must_use]
    pub fn world_from_file(self, point: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = [1, 2, 3].map(|step| point[(self.axis + step) % 3]);
        if self.is_negative { [x, -y, -z] } else { [x, y, z] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_named_axis_becomes_z_by_a_turn() {
        for (name, expected) in [
            ("+Z", [1.0, 2.0, 3.0]),
            ("+Y", crate::trc::world_from_trc([1.0, 2.0, 3.0])),
            ("+X", [2.0, 3.0, 1.0]),
            ("-Z", [1.0, -2.0, -3.0]),
            ("-Y", [3.0, -1.0, -2.0]),
        ] {
            let axis = ScreenAxis::named(name).unwrap();
            assert_eq!((axis.name(), axis.world_from_file([1.0, 2.0, 3.0])), (name, expected));
        }
        assert_eq!(ScreenAxis::named("z"), Some(ScreenAxis::Z));
        assert_eq!(["", "+", "W", "+XY"].map(ScreenAxis::named), [None; 4]);
    }
}
