//! Points of a result beside points of a reference: alignment of clocks and worlds, then pairs.
//!
//! The misfit of an offset in time is the mean square distance that is left after the best rigid motion ([`super::rigid`]); the offset of least misfit is taken with its motion. Standard deviations are by [`super::clusters`], of offset, turn about the world's axes, place of the middle of all points, and scale.
//!
//! What all points share, in place and turn, is part of the alignment and none of their errors. With `align` off nothing is taken away.

use super::agreement::Pair;
use super::clock::{BestOffset, best_offset, possible, thinned};
use super::clusters::{MOST, ResidualRow, standard_deviations};
use super::estimates::{Estimate, Estimates};
use super::outcome::{AlignedWorlds, Alignment, ComparedSeries, PartsToAlign};
use super::rigid::{PairSums, Similarity};
use super::sampled::Sampled;
use nalgebra::Vector3;

/// Frames that are looked at for each offset: of the first search, and of the last.
const COARSE: usize = 150;
const FINE: usize = 2000;

/// Axes in the order of the tables.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Why there is no alignment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unaligned {
    /// So few frames have a value beside them.
    Frames(usize),
    /// The turn is open.
    OnALine,
}

/// Frames that must have a value of the reference beside them.
pub(super) const LEAST_FRAMES: usize = 10;

struct Beside<'a> {
    ours: &'a Estimates<3>,
    reference: &'a Sampled<3>,
    parts: PartsToAlign,
}

impl Beside<'_> {
    /// Pairs of the reference's and our points in a frame, with the place of the point.
    fn pairs(&self, frame: usize, offset_s: f64) -> impl Iterator<Item = (usize, [f64; 3], &Estimate<3>)> {
        let values = self.reference.at(self.ours.times_s[frame] + offset_s);
        let ours = self.ours.series.iter().map(move |series| &series[frame]);
        let both = values.into_iter().zip(ours).enumerate();
        both.filter_map(|(at, (value, ours))| {
            value.filter(|_| ours.mean.iter().all(|x| x.is_finite())).map(|value| (at, value, ours))
        })
    }

    /// The best motion at an offset with its mean square distance, m².
    fn motion(&self, frames: impl Iterator<Item = usize>, offset_s: f64) -> Option<(Similarity, f64)> {
        let mut sums = PairSums::new();
        let mut square = 0.0;
        for frame in frames {
            for (_, value, ours) in self.pairs(frame, offset_s) {
                sums.add(value, ours.mean);
                square += (0..3).map(|axis| (ours.mean[axis] - value[axis]).powi(2)).sum::<f64>();
            }
        }
        if self.parts.space {
            sums.fit(self.parts.scale)
        } else {
            (sums.count() > 0.0).then(|| (Similarity::IDENTITY, square / sums.count()))
        }
    }

    fn misfit(&self, most: usize) -> impl Fn(f64) -> Option<f64> {
        let frames = thinned(self.ours.times_s.len(), most);
        move |offset_s| self.motion(frames.clone(), offset_s).map(|(_, misfit)| misfit)
    }

    fn offset(&self) -> Option<BestOffset> {
        if !self.parts.time {
            return Some(BestOffset { offset_s: 0.0, rival: None });
        }
        let range = possible(self.ours.ends_s(), self.reference.ends_s());
        best_offset(range, self.misfit(COARSE), self.misfit(FINE))
    }

    /// The middle of all points of the reference in our world.
    fn middle(&self, offset_s: f64, motion: &Similarity) -> Vector3<f64> {
        let mut sums = PairSums::new();
        for frame in thinned(self.ours.times_s.len(), FINE) {
            self.pairs(frame, offset_s).for_each(|(_, value, _)| sums.add(value, motion.apply(value)));
        }
        sums.middle()
    }

    /// Residuals with their gradients by what is aligned: offset, turn, place, scale.
    fn rows(&self, offset_s: f64, motion: &Similarity, piece_s: f64) -> Vec<ResidualRow> {
        let middle = self.middle(offset_s, motion);
        let PartsToAlign { time, space, scale } = self.parts;
        let mut rows = vec![];
        for frame in thinned(self.ours.times_s.len(), FINE) {
            let time_s = self.ours.times_s[frame];
            let piece = ((time_s - self.ours.times_s[0]) / piece_s) as usize;
            let rates = self.reference.rate_at(time_s + offset_s);
            for (joint, value, ours) in self.pairs(frame, offset_s) {
                let Some(rate) = rates[joint] else { continue };
                let aligned = motion.apply(value);
                let rate = motion.scale * (motion.rotation * Vector3::from(rate));
                let lever = Vector3::from(aligned) - middle;
                let turn = lever.cross_matrix();
                for axis in 0..3 {
                    let place = |other: usize| if other == axis { -1.0 } else { 0.0 };
                    let by_offset = time.then_some(-rate[axis]).into_iter();
                    let by_turn = (0..3).filter(|_| space).map(|other| turn[(axis, other)]);
                    let by_place = (0..3).filter(|_| space).map(place);
                    let by_scale = scale.then_some(-lever[axis]).into_iter();
                    let mut gradient = [0.0; MOST];
                    let all = by_offset.chain(by_turn).chain(by_place).chain(by_scale);
                    gradient.iter_mut().zip(all).for_each(|(own, by)| *own = by);
                    rows.push(ResidualRow { piece, joint, residual: ours.mean[axis] - aligned[axis], gradient });
                }
            }
        }
        rows
    }

    /// Standard deviations of what is aligned; none where it is not, or where the recordings leave it open.
    fn spreads(&self, offset_s: f64, motion: &Similarity, piece_s: f64) -> Spreads {
        let PartsToAlign { time, space, scale } = self.parts;
        let parameters = usize::from(time) + 6 * usize::from(space) + usize::from(scale);
        let found =
            if parameters == 0 { None } else { standard_deviations(&self.rows(offset_s, motion, piece_s), parameters) };
        let Some(found) = found else { return Spreads::default() };
        let mut rest = found.into_iter();
        let offset_s = if time { rest.next() } else { None };
        let mut triple =
            || -> Option<[f64; 3]> { if space { Some([rest.next()?, rest.next()?, rest.next()?]) } else { None } };
        let (turn_rad, place_m) = (triple(), triple());
        Spreads { offset_s, turn_rad, place_m, scale: if scale { rest.next() } else { None } }
    }
}

/// Standard deviations of an alignment.
#[derive(Clone, Copy, Default)]
struct Spreads {
    offset_s: Option<f64>,
    turn_rad: Option<[f64; 3]>,
    place_m: Option<[f64; 3]>,
    scale: Option<f64>,
}

/// Aligns a reference with a result; channels of the reference are in the order of the names of `ours`.
pub(super) fn aligned(
    ours: &Estimates<3>,
    reference: &Sampled<3>,
    parts: PartsToAlign,
) -> Result<(Alignment, Vec<ComparedSeries>), Unaligned> {
    let beside = Beside { ours, reference, parts };
    let seen = |offset_s: f64| {
        (0..ours.times_s.len()).filter(|frame| beside.pairs(*frame, offset_s).next().is_some()).collect::<Vec<_>>()
    };
    let found = beside.offset().ok_or(if parts.space { Unaligned::OnALine } else { Unaligned::Frames(0) })?;
    let frames = seen(found.offset_s);
    if frames.len() < LEAST_FRAMES {
        return Err(Unaligned::Frames(frames.len()));
    }
    let all = 0..ours.times_s.len();
    let (motion, square) = beside.motion(all.clone(), found.offset_s).ok_or(Unaligned::OnALine)?;
    let overlap_s = ours.times_s[frames[frames.len() - 1]] - ours.times_s[frames[0]];
    let piece_s = Alignment::piece_s(overlap_s);
    let sd = beside.spreads(found.offset_s, &motion, piece_s);
    let worlds = AlignedWorlds {
        motion,
        turn_sd_deg: sd.turn_rad.map(|sd| sd.map(f64::to_degrees)),
        place_sd_m: sd.place_m,
        scale_sd: sd.scale,
    };
    let alignment = Alignment {
        parts,
        offset_s: found.offset_s,
        offset_sd_s: sd.offset_s,
        rival: found.rival,
        overlap_s,
        piece_s,
        rms: square.sqrt(),
        worlds: Some(worlds),
    };
    Ok((alignment, series(&beside, found.offset_s, &motion)))
}

/// Pairs of each point and axis.
fn series(beside: &Beside<'_>, offset_s: f64, motion: &Similarity) -> Vec<ComparedSeries> {
    let names = beside.ours.names.iter().flat_map(|name| AXES.map(|axis| (name.clone(), Some(axis))));
    let mut found: Vec<ComparedSeries> =
        names.map(|(name, axis)| ComparedSeries { name, axis, pairs: vec![] }).collect();
    for frame in 0..beside.ours.times_s.len() {
        for (at, value, ours) in beside.pairs(frame, offset_s) {
            let aligned = motion.apply(value);
            for axis in 0..3 {
                found[3 * at + axis].pairs.push(Pair {
                    ours: ours.mean[axis],
                    reference: aligned[axis],
                    sd: ours.sd[axis],
                    sd_within: ours.sd_within[axis],
                });
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;
    use statrs::distribution::{ContinuousCDF as _, Normal};

    /// Standard normal numbers by inversion of Lehmer's generator (Park and Miller 1988).
    struct Normals(u64);

    impl Normals {
        fn next(&mut self) -> f64 {
            self.0 = self.0 * 48_271 % 2_147_483_647;
            Normal::standard().inverse_cdf(self.0 as f64 / 2_147_483_647.0)
        }
    }

    const POINTS: usize = 12;

    /// Where a point of somebody who wanders about is: each swings in its own way.
    fn place(point: usize, time_s: f64) -> [f64; 3] {
        let k = point as f64;
        let wander = [0.8 * (0.31 * time_s).sin(), 0.6 * (0.47 * time_s + 1.0).sin(), 0.0];
        let swing = |axis: usize| {
            let phase = 1.7 * k + 2.3 * axis as f64;
            0.12 * (5.7 * time_s + phase).sin() + 0.05 * (3.1 * time_s + 2.0 * phase).cos()
        };
        let rest = [0.3 * (1.9 * k).sin(), 0.15 * (2.7 * k).cos(), 0.15 * k];
        std::array::from_fn(|axis| rest[axis] + wander[axis] + swing(axis))
    }

    /// A result of 15 s at 60 frames a second that is off, by joint and in time.
    fn ours(bias_m: f64, noise_m: f64, seed: u64) -> Estimates<3> {
        let mut normals = Normals(seed);
        let times_s: Vec<f64> = (0..900).map(|frame| f64::from(frame) / 60.0).collect();
        let kept = (-1.0_f64 / (60.0 * 0.2)).exp();
        let series = (0..POINTS).map(|point| {
            let bias: [f64; 3] = std::array::from_fn(|_| bias_m * normals.next());
            let mut error: [f64; 3] = std::array::from_fn(|_| noise_m * normals.next());
            let one = |time_s: &f64| {
                error = error.map(|error| kept * error + noise_m * (1.0 - kept * kept).sqrt() * normals.next());
                let truth = place(point, *time_s);
                let mean = std::array::from_fn(|axis| truth[axis] + bias[axis] + error[axis]);
                Estimate { mean, sd: [noise_m; 3], sd_within: [noise_m; 3] }
            };
            times_s.iter().map(one).collect()
        });
        let series = series.collect();
        Estimates { names: (0..POINTS).map(|point| format!("P{point}")).collect(), times_s, series }
    }

    /// The truth by a system with a clock and a world of its own, at 100 frames a second.
    fn reference(motion: &Similarity, offset_s: f64) -> Sampled<3> {
        let times: Vec<f64> = (0..2200).map(|frame| 0.01 * f64::from(frame)).collect();
        let back = motion.rotation.transpose();
        let seen = |point: usize, time_s: f64| {
            let shifted = Vector3::from(place(point, time_s - offset_s)) - motion.shift;
            Some((back * shifted / motion.scale).into())
        };
        let channels = (0..POINTS).map(|point| times.iter().map(|time| seen(point, *time)).collect()).collect();
        Sampled::new(times, channels)
    }

    fn turned(scale: f64) -> Similarity {
        let rotation = Rotation3::from_euler_angles(0.2, -0.1, 2.0).into_inner();
        Similarity { scale, rotation, shift: Vector3::new(1.5, -0.7, 0.2) }
    }

    const BOTH: PartsToAlign = PartsToAlign { time: true, space: true, scale: false };

    #[test]
    fn a_known_clock_and_a_known_world_are_recovered() {
        for (parts, scale) in [(BOTH, 1.0), (PartsToAlign { scale: true, ..BOTH }, 1.03)] {
            let truth = turned(scale);
            let (found, series) = aligned(&ours(0.0, 0.0, 1), &reference(&truth, 3.2145), parts).unwrap();
            let worlds = found.worlds.unwrap();
            assert!((found.offset_s - 3.2145).abs() < 1e-5, "{found:?}");
            assert!((worlds.motion.rotation - truth.rotation).norm() < 1e-5, "{worlds:?}");
            assert!((worlds.motion.shift - truth.shift).norm() < 1e-5, "{worlds:?}");
            assert!((worlds.motion.scale - scale).abs() < 1e-6 && found.rms < 1e-5, "{worlds:?}");
            assert_eq!((series.len(), series[0].pairs.len()), (3 * POINTS, 900));
        }
    }

    #[test]
    fn a_shared_clock_and_world_are_not_aligned() {
        let truth = turned(1.0);
        let time_only = PartsToAlign { space: false, ..BOTH };
        let (found, _) = aligned(&ours(0.0, 0.0, 1), &reference(&Similarity::IDENTITY, 3.2145), time_only).unwrap();
        assert!((found.offset_s - 3.2145).abs() < 1e-5 && found.rms < 1e-5, "{found:?}");
        assert_eq!(found.worlds.unwrap().place_sd_m, None);
        let space_only = PartsToAlign { time: false, ..BOTH };
        let (found, _) = aligned(&ours(0.0, 0.0, 1), &reference(&truth, 0.0), space_only).unwrap();
        assert!(found.rms < 1e-9 && found.offset_sd_s.is_none());
        let none = PartsToAlign { time: false, space: false, scale: false };
        let (found, series) = aligned(&ours(0.0, 0.0, 1), &reference(&truth, 0.0), none).unwrap();
        assert!(found.rms > 1.0 && series[0].pairs[0].difference().abs() > 0.1);
    }

    /// Errors last 0.2 s, and every joint has a bias of 10 mm along each axis.
    /// Biases place the world wrongly.
    #[test]
    fn standard_deviations_of_an_alignment_are_as_large_as_its_errors() {
        const SEEDS: u64 = 60;
        let truth = turned(1.0);
        let reference = reference(&truth, 3.2145);
        let middle = (0..POINTS).fold(Vector3::zeros(), |sum, k| sum + Vector3::from(place(k, 7.0))) / POINTS as f64;
        let (mut time, mut places) = (0.0, 0.0);
        for seed in 1..=SEEDS {
            let (found, _) = aligned(&ours(0.01, 0.01, 1000 * seed + 17), &reference, BOTH).unwrap();
            let worlds = found.worlds.unwrap();
            time += ((found.offset_s - 3.2145) / found.offset_sd_s.unwrap()).powi(2);
            // The world's error at the middle of the points.
            let back = truth.rotation.transpose() * (middle - truth.shift);
            let off = Vector3::from(worlds.motion.apply(back.into())) - middle;
            places += (0..3).map(|axis| (off[axis] / worlds.place_sd_m.unwrap()[axis]).powi(2)).sum::<f64>() / 3.0;
        }
        let [time, places] = [time, places].map(|sum| (sum / SEEDS as f64).sqrt());
        // Root mean squares of 60 and 180 standard normal numbers: 1 ± 0.09 and ± 0.05; 12 joints as clusters cost some.
        assert!((0.7..1.4).contains(&time) && (0.7..1.4).contains(&places), "{time} {places}");
    }

    #[test]
    fn recordings_that_hardly_overlap_are_refused() {
        let far = Sampled::new(vec![100.0, 100.01], vec![vec![Some([0.0; 3]); 2]; POINTS]);
        let none = PartsToAlign { time: false, space: false, scale: false };
        assert_eq!(aligned(&ours(0.0, 0.0, 1), &far, none).unwrap_err(), Unaligned::Frames(0));
    }
}
