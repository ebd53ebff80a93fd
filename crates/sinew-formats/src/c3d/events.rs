//! Events of a C3D file: the header's and the group EVENT's.

use super::parameters::{C3dGroup, count, reals, texts};

/// Something that happened at a time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct C3dEvent {
    /// Time, seconds: 0 is the time of frame 1, which may lie before the first frame of the file.
    pub time_s: f64,
    /// What happened: `Foot Strike`.
    pub label: String,
    /// To what it happened: `Left`, `Right`, `General`; empty in events of the header.
    pub context: String,
    /// To whom; empty in events of the header.
    pub subject: String,
}

/// Events of the group EVENT. `TIMES` are pairs of minutes and seconds.
pub(super) fn events(groups: &[C3dGroup]) -> Vec<C3dEvent> {
    let times = reals(groups, "EVENT", "TIMES");
    let [labels, contexts, subjects] = ["LABELS", "CONTEXTS", "SUBJECTS"].map(|name| texts(groups, "EVENT", name));
    let used = count(groups, "EVENT", "USED").map_or(usize::MAX, |used| usize::try_from(used).unwrap_or(usize::MAX));
    let at = |list: &[&str], index: usize| list.get(index).copied().unwrap_or_default().to_owned();
    let pairs = times.as_chunks::<2>().0.iter().take(used).enumerate();
    let events = pairs.map(|(index, [minutes, seconds])| C3dEvent {
        time_s: 60.0 * minutes + seconds,
        label: at(&labels, index),
        context: at(&contexts, index),
        subject: at(&subjects, index),
    });
    events.filter(|event| event.time_s.is_finite()).collect()
}
