//! Oddities of a recording that are no motion of the person, noticed while it is tracked.
//!
//! Cameras that exchange left and right for a span, people who jump.
//!
//! - A camera has *swapped* sides in frames where the keypoints of the left lie nearer to the projected points of the right and the other way: exchanging them
//!   lowers the median distance to less than half, and by more than three times the camera's noise, in three frames at least. Up to two frames in which
//!   it does not do so do not end a span.
//! - A person *jumps* in a camera that has shown this one person alone so far and suddenly shows one who is not where they are expected, not even with left and
//!   right exchanged: the detector has turned to someone else. The robust association leaves the camera out until the person is back.
//!
//! Memory does not grow with the frames: a span is kept as its ends and sums, and only the first few of each camera are listed.

use crate::SetupWarning;
use serde::{Deserialize, Serialize};
use sinew_core::estimators::median;

/// Frames that a span has at least.
const SPAN: u32 = 3;
/// Successive frames without swapped sides that do not end a span.
const PATIENCE: u32 = 2;
/// Least number of distances from which a swap or a jump is judged.
const FEWEST: usize = 4;
/// Spans and jumps listed for each camera.
const LISTED: usize = 3;

/// Frames in which a camera has swapped sides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Span {
    first: u64,
    last: u64,
    frames: u32,
    straight: f64,
    crossed: f64,
}

/// One camera.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Watched {
    name: String,
    sigma_px: f64,
    open: Span,
    quiet: u32,
    swaps: Vec<Span>,
    more_swaps: u64,
    /// First frame and distance of each jump.
    jumps: Vec<(u64, f64)>,
    more_jumps: u64,
    /// Whether the last frame showed the person and nobody else.
    alone: bool,
}

/// What is odd of the first person that a camera shows in a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OddPerson {
    /// Median distance of their keypoints from where the person is expected, pixels, if this is a jump.
    jump_px: Option<f64>,
    /// Distances from the expected keypoints, pixels, with labels as they are and with left and right exchanged, of someone who was not taken for the person because of the labels.
    swapped_px: Option<(f64, f64)>,
}

impl Watched {
    fn close(&mut self) {
        if self.open.frames >= SPAN {
            if self.swaps.len() < LISTED {
                self.swaps.push(self.open);
            } else {
                self.more_swaps += 1;
            }
        }
        self.open = Span::default();
        self.quiet = 0;
    }
}

/// All cameras.
#[derive(Clone, Debug, Default)]
pub struct Oddities {
    cameras: Vec<Watched>,
    /// Left and right, by point of the plan.
    pairs: Vec<(usize, usize)>,
}

/// Whether exchanging left and right brings keypoints decidedly nearer.
fn is_swap(straight: f64, crossed: f64, sigma_px: f64) -> bool {
    crossed < 0.5 * straight && straight - crossed > 3.0 * sigma_px
}

impl Oddities {
    /// Nothing seen yet in cameras of these names and noises.
    pub fn new(cameras: impl Iterator<Item = (String, f64)>, pairs: Vec<(usize, usize)>) -> Self {
        let watched = |(name, sigma_px)| Watched { name, sigma_px, ..Watched::default() };
        Self { cameras: cameras.map(watched).collect(), pairs }
    }

    /// What is remembered of each camera.
    pub fn save(&self) -> Vec<Watched> {
        self.cameras.clone()
    }

    /// Takes up what [`Oddities::save`] gave, of as many cameras.
    pub fn restore(&mut self, saved: &[Watched]) {
        self.cameras = saved.to_vec();
    }

    /// Takes what a camera shows before the frame is tracked: how many people, whether the tracked one is among them, and the distances of the first one's
    /// keypoints from where they are expected, as labelled and with left and right exchanged.
    pub fn people(
        &mut self,
        camera: usize,
        count: usize,
        found: bool,
        [straight, crossed]: [&mut [f64]; 2],
    ) -> OddPerson {
        let Some(watched) = self.cameras.get_mut(camera) else { return OddPerson::default() };
        let is_other = count == 1 && !found && straight.len() >= FEWEST;
        let (straight, crossed) = (median(straight), median(crossed));
        let swapped = is_other && is_swap(straight, crossed, watched.sigma_px);
        let jump_px = (is_other && watched.alone && !swapped).then_some(straight);
        watched.alone = count == 1 && (found || swapped);
        OddPerson { jump_px, swapped_px: swapped.then_some((straight, crossed)) }
    }

    /// Closes a frame, of which `odd` is what each camera showed before: `distance(camera, seen, at)` is that of keypoint `seen` from the projection of point `at` of the tracked pose.
    pub fn note(&mut self, number: u64, odd: &[OddPerson], distance: impl Fn(usize, usize, usize) -> Option<f64>) {
        for (c, (watched, odd)) in self.cameras.iter_mut().zip(odd).enumerate() {
            if let Some(px) = odd.jump_px {
                if watched.jumps.len() < LISTED {
                    watched.jumps.push((number, px));
                } else {
                    watched.more_jumps += 1;
                }
            }
            let (mut straight, mut crossed) = (vec![], vec![]);
            for &(l, r) in &self.pairs {
                for (a, b) in [(l, r), (r, l)] {
                    if let (Some(s), Some(x)) = (distance(c, a, a), distance(c, a, b)) {
                        straight.push(s);
                        crossed.push(x);
                    }
                }
            }
            let enough = straight.len() >= FEWEST;
            let medians = enough.then(|| (median(&mut straight), median(&mut crossed)));
            let swapped = medians.filter(|(s, x)| is_swap(*s, *x, watched.sigma_px)).or(odd.swapped_px);
            if let Some((straight, crossed)) = swapped {
                let open = &mut watched.open;
                if open.frames == 0 {
                    open.first = number;
                }
                open.last = number;
                open.frames += 1;
                open.straight += straight;
                open.crossed += crossed;
                watched.quiet = 0;
            } else if watched.open.frames > 0 {
                watched.quiet += 1;
                if watched.quiet > PATIENCE {
                    watched.close();
                }
            }
        }
    }

    /// What was odd so far.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = vec![];
        for watched in &self.cameras {
            let mut watched = watched.clone();
            watched.close();
            let camera = &watched.name;
            warnings.extend(watched.swaps.iter().map(|span| {
                let frames = f64::from(span.frames);
                SetupWarning::Swapped {
                    camera: camera.clone(),
                    first: span.first,
                    last: span.last,
                    residual_px: span.straight / frames,
                    swapped_px: span.crossed / frames,
                }
                .to_string()
            }));
            if watched.more_swaps > 0 {
                warnings.push(format!("{camera}: {} more spans with left and right swapped", watched.more_swaps));
            }
            let jump = |&(frame, px)| SetupWarning::Jump { camera: camera.clone(), frame, px }.to_string();
            warnings.extend(watched.jumps.iter().map(jump));
            if watched.more_jumps > 0 {
                warnings.push(format!("{camera}: {} more jumps", watched.more_jumps));
            }
        }
        warnings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_end_and_jumps_begin_where_they_do() {
        let mut oddities = Oddities::new([("cam1".to_owned(), 2.0)].into_iter(), vec![(0, 1), (2, 3)]);
        for number in 0..40 {
            let swapped = (10..20).contains(&number) && number != 15 || number == 30;
            let is_there = !(35..38).contains(&number);
            let px = |seen: usize, at: usize| if (seen == at) == swapped { 41.0 } else { 6.0 };
            let distance = |_, seen: usize, at: usize| is_there.then(|| px(seen, at));
            let near = if (35..38).contains(&number) { 6.0 } else { 300.0 };
            let odd = oddities.people(0, 1, !matches!(number, 25 | 26 | 35..38), [&mut [310.0; 5], &mut [near; 5]]);
            oddities.note(number, &[odd], distance);
        }
        assert_eq!(
            oddities.warnings(),
            [
                "cam1 frames 10-19: swapping left and right lowers the residual from 41 to 6 px",
                "cam1 frames 35-37: swapping left and right lowers the residual from 310 to 6 px",
                "cam1 frame 25: jump of 310 px in all joints"
            ]
        );
    }
}
