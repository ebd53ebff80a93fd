//! Rest orientation of the feet: the sole is level at the zero pose.
//!
//! How the points of a foot lie at its zero angles and how its angles lie around zero are one question that no measurement answers: turning the former by R_x(α) R_y(β) and the latter back gives the same places. The
//! documented zero answers it, "feet at right angles to the shins": heel, big toe and small toe lie in a level plane. Where not all of them are seen,
//!
//! | seen | level is |
//! |---|---|
//! | heel and one toe | the line between them, from the side |
//! | toes, or the heel, alone | the direction from the ankle that it had at the start, from the side |

use crate::fit::Target;
use crate::standard::Proportions;
use crate::tree::KinematicTree;

/// Least sine of the angle at the heel, and of the height of the normal, by which three points are taken for a sole.
const FLATTEST: f64 = 0.1;

/// Which points of the feet were ever measured, on either side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct FootPoints {
    pub heel: bool,
    pub big_toe: bool,
    pub small_toe: bool,
}

impl FootPoints {
    /// Those that some frame measured, with an entry per point of the body.
    pub fn measured(tree: &KinematicTree, frames: &[Vec<Option<Target>>]) -> Self {
        let seen = |name: &str| {
            ["L", "R"].iter().any(|side| {
                let index = tree.point_index(&format!("{side}{name}"));
                index.is_some_and(|k| frames.iter().any(|frame| frame.get(k).is_some_and(Option::is_some)))
            })
        };
        Self { heel: seen("Heel"), big_toe: seen("BigToe"), small_toe: seen("SmallToe") }
    }
}

/// The same sizes with the measured points of the feet turned to their rest orientation about the ankle.
pub(crate) fn levelled(sizes: &Proportions, start: &Proportions, measured: FootPoints) -> Proportions {
    let [alpha, beta] = rest_turn(sizes, start, measured);
    let turned = |seen: bool, point: [f64; 3]| if seen { back(point, alpha, beta) } else { point };
    Proportions {
        heel: turned(measured.heel, sizes.heel),
        big_toe: turned(measured.big_toe, sizes.big_toe),
        small_toe: turned(measured.small_toe, sizes.small_toe),
        ..*sizes
    }
}

/// Turns α and β of the feet out of their rest orientation, radians.
pub(crate) fn rest_turn(sizes: &Proportions, start: &Proportions, measured: FootPoints) -> [f64; 2] {
    let FootPoints { heel, big_toe, small_toe } = measured;
    let toes = |p: &Proportions| match (big_toe, small_toe) {
        (true, true) => Some([0, 1, 2].map(|k: usize| 0.5 * (p.big_toe[k] + p.small_toe[k]))),
        (true, false) => Some(p.big_toe),
        (false, true) => Some(p.small_toe),
        (false, false) => None,
    };
    let pitch = |[_, y, z]: [f64; 3]| z.atan2(y);
    match (heel, toes(sizes), toes(start)) {
        (true, Some(toe), _) => {
            let sole = if big_toe && small_toe { tilt(sizes) } else { None };
            sole.unwrap_or_else(|| [pitch(minus(toe, sizes.heel)), 0.0])
        }
        (false, Some(toe), Some(before)) => [pitch(toe) - pitch(before), 0.0],
        (true, None, _) => [pitch(sizes.heel) - pitch(start.heel), 0.0],
        _ => [0.0; 2],
    }
}

/// α and β of the sole's plane, whose normal is R_x(α) R_y(β) z; `None` where the points lie in a line or are no right foot.
fn tilt(sizes: &Proportions) -> Option<[f64; 2]> {
    let (a, b) = (minus(sizes.small_toe, sizes.heel), minus(sizes.big_toe, sizes.heel));
    let normal = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let (size, sides) = (length(normal), length(a) * length(b));
    let [x, y, z] = normal.map(|n| n / size);
    (size > FLATTEST * sides && z > FLATTEST).then(|| [(-y).atan2(z), x.clamp(-1.0, 1.0).asin()])
}

/// R_y(−β) R_x(−α) applied to a point.
fn back([x, y, z]: [f64; 3], alpha: f64, beta: f64) -> [f64; 3] {
    let ((sin, cos), (s, c)) = (alpha.sin_cos(), beta.sin_cos());
    let (y, z) = (cos * y + sin * z, cos * z - sin * y);
    [c * x - s * z, y, s * x + c * z]
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: FootPoints = FootPoints { heel: true, big_toe: true, small_toe: true };

    fn close(a: &Proportions, b: &Proportions) -> bool {
        [(a.heel, b.heel), (a.big_toe, b.big_toe), (a.small_toe, b.small_toe)]
            .iter()
            .all(|(a, b)| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-12))
    }

    /// R_x(α) R_y(β) applied to the points of the foot.
    fn tilted(p: &Proportions, alpha: f64, beta: f64) -> Proportions {
        let turn = |v| back(back(v, 0.0, -beta), -alpha, 0.0);
        Proportions { heel: turn(p.heel), big_toe: turn(p.big_toe), small_toe: turn(p.small_toe), ..*p }
    }

    #[test]
    fn a_turned_foot_is_levelled_and_a_level_one_is_left() {
        let level = Proportions::default();
        assert!(close(&levelled(&level, &level, ALL), &level));
        for (alpha, beta) in [(-0.75, 0.0), (0.4, 0.2), (-1.2, -0.5), (0.0, 0.3)] {
            let found = levelled(&tilted(&level, alpha, beta), &level, ALL);
            assert!(close(&found, &level), "{alpha} {beta}: {found:?}");
        }
    }

    #[test]
    fn with_fewer_points_the_turn_from_the_side_is_undone() {
        let level = Proportions::default();
        for measured in [
            FootPoints { small_toe: false, ..ALL },
            FootPoints { heel: false, ..ALL },
            FootPoints { heel: true, ..FootPoints::default() },
        ] {
            let found = levelled(&tilted(&level, -0.75, 0.0), &level, measured);
            let expected = tilted(&level, -0.75, 0.0);
            let pick = |seen: bool, level: [f64; 3], turned: [f64; 3]| if seen { level } else { turned };
            let expected = Proportions {
                heel: pick(measured.heel, level.heel, expected.heel),
                big_toe: pick(measured.big_toe, level.big_toe, expected.big_toe),
                small_toe: pick(measured.small_toe, level.small_toe, expected.small_toe),
                ..level
            };
            assert!(close(&found, &expected), "{measured:?}: {found:?}");
        }
        let turned = tilted(&level, -0.75, 0.0);
        assert_eq!(levelled(&turned, &level, FootPoints::default()), turned);
    }

    /// Toes that were exchanged are no reason to turn the foot over.
    #[test]
    fn a_foot_that_is_none_is_levelled_by_its_line() {
        let level = Proportions::default();
        let exchanged = Proportions { big_toe: level.small_toe, small_toe: level.big_toe, ..level };
        let found = levelled(&tilted(&exchanged, -0.75, 0.0), &level, ALL);
        assert!(close(&found, &exchanged), "{found:?}");
    }
}
