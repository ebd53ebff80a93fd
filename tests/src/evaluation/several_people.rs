//! How well several people are found and kept apart, in space.
//!
//! Truth and estimate are tracks of people; in a frame a person is where their points are. An estimate is of a person where their mean distance over the points is at most [`NEAR_M`].
//!
//! - **MOTA** (Bernardin & Stiefelhagen, EURASIP J. Image Video Process. 2008, 246309): matches of the frame before stay where they still hold, the rest is assigned at least distance; with misses m, false people f and switches s, MOTA = 1 − Σ (m + f + s) / Σ people.
//! - **IDF1** (Ristani et al., ECCV workshops 2016): one track of the estimate for each true one, chosen so that most frames agree; IDF1 = 2 TP / (people + estimates).
//! - **PCP** (Ferrari et al., CVPR 2008; Belagiannis et al., CVPR 2014): share of limbs whose two ends are off by at most half of the limb's length in the mean.

use sinew::observe::association::assignment::least_cost;

/// Mean distance up to which an estimate is of a person, metres.
pub const NEAR_M: f64 = 0.3;

/// Points of a person in a frame.
pub type Points = Vec<Option<[f64; 3]>>;

/// A track: points in each frame, `None` where the person is not there.
pub type Track = Vec<Option<Points>>;

/// What was counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counts {
    /// People in all frames.
    pub people: usize,
    /// Estimates in all frames.
    pub estimates: usize,
    /// People without an estimate.
    pub misses: usize,
    /// Estimates without a person.
    pub false_people: usize,
    /// Matches to another track than the last one of that person.
    pub switches: usize,
    /// Frames that agree, tracks matched as a whole.
    pub same: usize,
    /// Limbs of all people, and those that are right.
    pub limbs: [usize; 2],
}

impl Counts {
    /// Multiple object tracking accuracy.
    #[must_use]
    pub fn mota(&self) -> f64 {
        1.0 - (self.misses + self.false_people + self.switches) as f64 / self.people as f64
    }

    /// Identity F1.
    #[must_use]
    pub fn idf1(&self) -> f64 {
        2.0 * self.same as f64 / (self.people + self.estimates) as f64
    }

    /// Share of limbs that are right.
    #[must_use]
    pub fn pcp(&self) -> f64 {
        self.limbs[1] as f64 / self.limbs[0] as f64
    }
}

/// Mean distance over the points that both have, metres; infinite without any.
pub(super) fn distance(a: &Points, b: &Points) -> f64 {
    let both: Vec<f64> = a.iter().zip(b).filter_map(|(a, b)| Some(between((*a)?, (*b)?))).collect();
    if both.is_empty() { f64::INFINITY } else { both.iter().sum::<f64>() / both.len() as f64 }
}

fn between(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// Counts over all frames; `limbs` are pairs of points.
#[must_use]
pub fn counted(truth: &[Track], estimate: &[Track], limbs: &[(usize, usize)]) -> Counts {
    let frames = truth.first().map_or(0, Vec::len);
    let at = |tracks: &[Track], k: usize, frame: usize| tracks[k].get(frame).cloned().flatten();
    let mut counts = Counts::default();
    let mut last: Vec<Option<usize>> = vec![None; truth.len()];
    let mut agree = vec![vec![0_usize; estimate.len()]; truth.len()];
    for frame in 0..frames {
        let people: Vec<Option<Points>> = (0..truth.len()).map(|k| at(truth, k, frame)).collect();
        let found: Vec<Option<Points>> = (0..estimate.len()).map(|k| at(estimate, k, frame)).collect();
        let metres = |person: usize, track: usize| {
            let both = people[person].as_ref().zip(found[track].as_ref());
            both.map_or(f64::INFINITY, |(a, b)| Some(distance(a, b)).filter(|m| *m <= NEAR_M).unwrap_or(f64::INFINITY))
        };
        let mut matched: Vec<Option<usize>> =
            last.iter().enumerate().map(|(k, track)| track.filter(|track| metres(k, *track).is_finite())).collect();
        let taken = matched.clone();
        let free = |person: usize, track: usize| taken[person].is_none() && !taken.contains(&Some(track));
        let cost = |k, track| if free(k, track) { metres(k, track) } else { f64::INFINITY };
        let costs: Vec<Vec<f64>> =
            (0..truth.len()).map(|k| (0..estimate.len()).map(|track| cost(k, track)).collect()).collect();
        for (own, new) in matched.iter_mut().zip(least_cost(&costs, NEAR_M)) {
            *own = own.or(new);
        }
        counts.people += people.iter().flatten().count();
        counts.estimates += found.iter().flatten().count();
        counts.false_people += found.iter().flatten().count() - matched.iter().flatten().count();
        for (person, points) in people.iter().enumerate() {
            let Some(points) = points else { continue };
            let estimate = matched[person].and_then(|track| found[track].as_ref());
            counts.misses += usize::from(estimate.is_none());
            if let (Some(new), Some(old)) = (matched[person], last[person]) {
                counts.switches += usize::from(new != old);
            }
            last[person] = matched[person].or(last[person]);
            for (track, agree) in agree[person].iter_mut().enumerate() {
                *agree += usize::from(metres(person, track).is_finite());
            }
            for &(a, b) in limbs {
                let Some((at_a, at_b)) = points[a].zip(points[b]) else { continue };
                counts.limbs[0] += 1;
                let ends = estimate.and_then(|found| found[a].zip(found[b]));
                let off = ends.map(|(a, b)| 0.5 * (between(at_a, a) + between(at_b, b)));
                counts.limbs[1] += usize::from(off.is_some_and(|off| off <= 0.5 * between(at_a, at_b)));
            }
        }
    }
    let costs: Vec<Vec<f64>> = agree.iter().map(|row| row.iter().map(|same| -(*same as f64)).collect()).collect();
    let whole = least_cost(&costs, 0.0).into_iter().enumerate();
    counts.same = whole.filter_map(|(person, track)| Some(agree[person][track?])).sum();
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64) -> Option<Points> {
        Some(vec![Some([x, 0.0, 0.0]), Some([x, 0.0, 0.4])])
    }

    #[test]
    fn two_who_change_names_are_two_switches_and_half_the_identity() {
        let truth = [vec![at(0.0); 4], vec![at(2.0); 4]];
        let changed = [vec![at(0.0), at(0.0), at(2.0), at(2.0)], vec![at(2.0), at(2.0), at(0.0), at(0.0)]];
        let counts = counted(&truth, &changed, &[(0, 1)]);
        assert_eq!((counts.misses, counts.false_people, counts.switches), (0, 0, 2));
        assert_eq!((counts.mota(), counts.idf1(), counts.pcp()), (0.75, 0.5, 1.0));
    }

    #[test]
    fn misses_false_people_and_wrong_limbs_count() {
        let truth = [vec![at(0.0), at(0.0)]];
        let estimate = [vec![at(0.25), None], vec![at(5.0), None]];
        let counts = counted(&truth, &estimate, &[(0, 1)]);
        assert_eq!((counts.people, counts.estimates, counts.misses, counts.false_people), (2, 2, 1, 1));
        assert_eq!((counts.mota(), counts.idf1(), counts.pcp()), (0.0, 0.5, 0.0));
    }
}
