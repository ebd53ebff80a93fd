//! Which points of a reference are which of ours, by a mapping or by their names.
//!
//! By name: what stands before a colon is a subject of the laboratory's and does not count; a name that people give to a point of the body ([`known_point`]) is that point, `RHJC` and its like are centres of joints. Markers on the skin (`RKNE`) lie elsewhere than joints and are matched by a mapping alone.

use super::error::CompareError;
use sinew_formats::nearest::nearest;
use sinew_formats::point_mapping::MappedPoint;
use sinew_formats::point_name::known_point;

/// Centres of joints as laboratories abbreviate them, behind L or R.
const CENTRES: [(&str, &str); 6] =
    [("HJC", "Hip"), ("KJC", "Knee"), ("AJC", "Ankle"), ("SJC", "Shoulder"), ("EJC", "Elbow"), ("WJC", "Wrist")];

/// A point of ours and the points of the reference whose mean it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct MatchedPoint {
    pub(super) ours: usize,
    pub(super) reference: Vec<usize>,
}

/// The name without the subject.
fn bare(name: &str) -> &str {
    name.rsplit_once(':').map_or(name, |(_, bare)| bare).trim()
}

/// Our name for a point of a reference.
fn meant(name: &str) -> String {
    let bare = bare(name);
    let centre = bare.get(..1).zip(bare.get(1..)).and_then(|(side, part)| {
        let (_, joint) = CENTRES.iter().find(|(short, _)| part.eq_ignore_ascii_case(short))?;
        ["L", "R"].iter().find(|known| side.eq_ignore_ascii_case(known)).map(|side| format!("{side}{joint}"))
    });
    centre.or_else(|| known_point(bare)).unwrap_or_else(|| bare.to_owned())
}

/// Points of a result beside points of a reference that mean the same.
pub(super) fn matched(
    ours: &[String],
    reference: &[String],
    mapping: Option<&[MappedPoint]>,
) -> Result<Vec<MatchedPoint>, CompareError> {
    let Some(mapping) = mapping else { return Ok(by_name(ours, reference)) };
    let place = |names: &[String], name: &str, is_ours: bool| {
        let found = names.iter().position(|own| own == name);
        let found = found.or_else(|| names.iter().position(|own| !is_ours && bare(own) == name));
        found.ok_or_else(|| CompareError::NoSuchName {
            name: name.to_owned(),
            whose: if is_ours { "result" } else { "reference" },
            nearest: nearest(name, names.iter().map(String::as_str)).map(str::to_owned),
        })
    };
    let one = |point: &MappedPoint| {
        let from = point.from.iter().map(|name| place(reference, name, false)).collect::<Result<_, _>>()?;
        Ok(MatchedPoint { ours: place(ours, &point.name, true)?, reference: from })
    };
    mapping.iter().map(one).collect()
}

fn by_name(ours: &[String], reference: &[String]) -> Vec<MatchedPoint> {
    let meant: Vec<String> = reference.iter().map(|name| meant(name)).collect();
    let place = |name: &String| {
        let exact = reference.iter().position(|own| own == name);
        exact.or_else(|| meant.iter().position(|own| own == name))
    };
    let found = ours.iter().enumerate().filter_map(|(at, name)| Some((at, place(name)?)));
    found.map(|(ours, reference)| MatchedPoint { ours, reference: vec![reference] }).collect()
}

/// Names that belong to nothing of the other side: ours, and the reference's.
pub(super) fn unmatched(ours: &[String], reference: &[String], matched: &[MatchedPoint]) -> [Vec<String>; 2] {
    let left = |names: &[String], used: &dyn Fn(usize) -> bool| {
        names.iter().enumerate().filter(|(at, _)| !used(*at)).map(|(_, name)| name.clone()).collect()
    };
    [
        left(ours, &|at| matched.iter().any(|one| one.ours == at)),
        left(reference, &|at| matched.iter().any(|one| one.reference.contains(&at))),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(names: &[&str]) -> Vec<String> {
        names.iter().map(|name| (*name).to_owned()).collect()
    }

    #[test]
    fn names_of_laboratories_are_recognised() {
        let ours = names(&["RHip", "LKnee", "Nose", "RAnkle", "LWrist"]);
        let theirs = names(&["RKNE", "Anna:RHJC", "ljc", "anna:l_knee", "right ankle", "LWrist", "l_wrist"]);
        let found = by_name(&ours, &theirs);
        let pairs: Vec<(usize, usize)> = found.iter().map(|one| (one.ours, one.reference[0])).collect();
        assert_eq!(pairs, [(0, 1), (1, 3), (3, 4), (4, 5)]);
        assert_eq!(unmatched(&ours, &theirs, &found), [names(&["Nose"]), names(&["RKNE", "ljc", "l_wrist"])]);
    }

    #[test]
    fn a_mapping_names_what_is_there_on_both_sides() {
        let (ours, theirs) = (names(&["RKnee", "Nose"]), names(&["S1:RKNE", "S1:RKNM", "S1:HEAD"]));
        let mapping = |text: &str| sinew_formats::point_mapping::read("n.toml", text).unwrap();
        let knee = mapping("[points]\nRKnee = ['RKNE', 'S1:RKNM']");
        let found = matched(&ours, &theirs, Some(&knee)).unwrap();
        assert_eq!(found, [MatchedPoint { ours: 0, reference: vec![0, 1] }]);
        let refused = |text: &str| matched(&ours, &theirs, Some(&mapping(text))).unwrap_err().to_string();
        let found = refused("[points]\nRKnees = 'RKNE'");
        assert!(
            found.contains("`RKnees`") && found.contains("result") && found.contains("did you mean `RKnee`"),
            "{found}"
        );
        assert!(refused("[points]\nRKnee = 'RKNX'").contains("reference"));
    }
}
