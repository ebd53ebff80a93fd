//! Is a person who was away known again when they come back?
//!
//! A track is a person's in a frame if it is the nearest to them, at most [`NEAR_M`] away. Its owner before a frame is the person whose it was in most frames before. When a person comes, the name that they get is the track that is theirs in most frames of their stay:
//!
//! - they are **known again** if that track was their own before,
//! - they have a **new name** if it was nobody's,
//! - they have **another's name** if it was somebody else's,
//! - they are **missed** if no track is theirs.

use super::several_people::{NEAR_M, Track, distance};

/// What became of those who come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Returns {
    /// Who was there before and has their own name again.
    pub known: usize,
    /// Who was there before and has a new name.
    pub new: usize,
    /// Who was there before and has another's name.
    pub mistaken: usize,
    /// Who was there before and has no name.
    pub missed: usize,
    /// People who come for the first time after the first frame.
    pub newcomers: usize,
    /// Those among them who have another's name.
    pub newcomers_mistaken: usize,
}

/// Counts over all people, who are away where `truth` has no points for them.
#[must_use]
pub fn returns(truth: &[Track], estimate: &[Track]) -> Returns {
    let frames = truth.first().map_or(0, Vec::len);
    let nearest = |person: usize, frame: usize| {
        let own = truth[person][frame].as_ref()?;
        let metres = |track: &Track| Some(distance(own, track.get(frame)?.as_ref()?)).filter(|m| *m <= NEAR_M);
        let near = estimate.iter().enumerate().filter_map(|(k, track)| Some((metres(track)?, k)));
        near.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, k)| k)
    };
    let whose: Vec<Vec<Option<usize>>> =
        (0..truth.len()).map(|person| (0..frames).map(|frame| nearest(person, frame)).collect()).collect();
    let count = |person: usize, from: usize, to: usize, track: usize| {
        whose[person][from..to].iter().filter(|found| **found == Some(track)).count()
    };
    let most = |counts: Vec<usize>| (0..counts.len()).rev().max_by_key(|k| counts[*k]).filter(|k| counts[*k] > 0);
    let mut all = Returns::default();
    for (person, track) in truth.iter().enumerate() {
        let comes = (1..frames).filter(|&frame| track[frame - 1].is_none() && track[frame].is_some());
        for frame in comes {
            let end = (frame..frames).find(|&f| track[f].is_none()).unwrap_or(frames);
            let name = most((0..estimate.len()).map(|k| count(person, frame, end, k)).collect());
            let owner = name.map(|name| most((0..truth.len()).map(|other| count(other, 0, frame, name)).collect()));
            let was_there = track[..frame].iter().any(Option::is_some);
            match owner {
                _ if !was_there => {
                    all.newcomers += 1;
                    all.newcomers_mistaken += usize::from(owner.flatten().is_some());
                }
                None => all.missed += 1,
                Some(None) => all.new += 1,
                Some(Some(owner)) if owner == person => all.known += 1,
                Some(Some(_)) => all.mistaken += 1,
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(places: [f64; 6]) -> Track {
        places.iter().map(|x| x.is_finite().then(|| vec![Some([*x, 0.0, 0.0]), Some([*x, 0.0, 0.4])])).collect()
    }

    const AWAY: f64 = f64::NAN;

    #[test]
    fn people_who_come_back_are_known_new_or_mistaken() {
        let truth = [track([0.0, 0.0, AWAY, AWAY, 0.0, 0.0]), track([2.0, 2.0, 2.0, AWAY, AWAY, 2.0])];
        assert_eq!(returns(&truth, &truth), Returns { known: 2, ..Returns::default() });
        let cut = |track: &Track, frames: std::ops::Range<usize>| -> Track {
            track.iter().enumerate().map(|(f, points)| points.clone().filter(|_| frames.contains(&f))).collect()
        };
        let parts: Vec<Track> = truth.iter().flat_map(|one| [cut(one, 0..3), cut(one, 4..6)]).collect();
        assert_eq!(returns(&truth, &parts), Returns { new: 2, ..Returns::default() });
        let exchanged = [track([0.0, 0.0, AWAY, AWAY, AWAY, 2.0]), track([2.0, 2.0, 2.0, AWAY, 0.0, 0.0])];
        assert_eq!(returns(&truth, &exchanged), Returns { mistaken: 2, ..Returns::default() });
        assert_eq!(returns(&truth, &parts[..1]), Returns { missed: 2, ..Returns::default() });
    }

    #[test]
    fn a_newcomer_with_the_name_of_somebody_who_left_counts() {
        let truth = [track([0.0, 0.0, 0.0, AWAY, AWAY, AWAY]), track([AWAY, AWAY, AWAY, AWAY, 1.0, 1.0])];
        assert_eq!(returns(&truth, &truth), Returns { newcomers: 1, ..Returns::default() });
        let one = [track([0.0, 0.0, 0.0, AWAY, 1.0, 1.0])];
        assert_eq!(returns(&truth, &one), Returns { newcomers: 1, newcomers_mistaken: 1, ..Returns::default() });
    }
}
