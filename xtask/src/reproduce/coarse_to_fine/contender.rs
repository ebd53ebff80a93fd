//! Who is compared: the paper's settings, its opponent, and those beside them.

use sinew::observe::image_score::ImageScore;
use sinew_simulate::segmentation_noise::Level;

/// What tracks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Method {
    /// Coarse and fine particles; parts judged one by one or under the chosen ancestors; coarse particles on their grid or not.
    CoarseToFine { coarse: usize, fine: usize, chained: bool, snapped: bool },
    /// Coarse and fine particles; parts judged by all of their own contour.
    OwnContours { coarse: usize, fine: usize, chained: bool },
    /// With a number of particles.
    Condensation(usize),
    /// With a number of particles in five layers.
    Annealed(usize),
    /// With a number of particles.
    Partitioned(usize),
    /// The fitted true pose: what the body can reach.
    Truth,
}

/// Who was drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Person {
    /// The evaluation body, which shares no shape with the tracker's.
    Other,
    /// The tracker's own body in its true pose: never for a pass.
    Own,
}

/// A method with what it is weighted by and what it sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Contender {
    pub(super) method: Method,
    pub(super) score: ImageScore,
    pub(super) person: Person,
}

/// Layers of annealing.
pub(super) const LAYERS: usize = 5;

/// The likelihood of the paper (eq. 3), by which all estimates are judged.
pub(super) const EQ3: ImageScore = eq3(0.2);

const fn eq3(sigma: f64) -> ImageScore {
    ImageScore::CoarseToFine { sigma_edge: sigma, sigma_region: sigma }
}

/// With κ = 1/(2 · 0.2²) the weights of both formulas are on the same scale.
const fn reid(bidirectional: Option<f64>) -> ImageScore {
    ImageScore::DeutscherReid { kappa: 12.5, bidirectional }
}

/// The tracker with these numbers of coarse and fine particles.
pub(super) const fn c2f(coarse: usize, fine: usize) -> Contender {
    Contender {
        method: Method::CoarseToFine { coarse, fine, chained: false, snapped: true },
        score: EQ3,
        person: Person::Other,
    }
}

/// Its opponent.
pub(super) const fn condensation(particles: usize) -> Contender {
    Contender { method: Method::Condensation(particles), score: EQ3, person: Person::Other }
}

/// The fitted true pose.
pub(super) const TRUTH: Contender = Contender { method: Method::Truth, score: EQ3, person: Person::Other };

/// Settings of the paper, by rising numbers of particles.
pub(super) const SETTINGS: [Contender; 4] = [c2f(50, 200), c2f(100, 200), c2f(300, 200), c2f(300, 500)];

/// The pairs of Table 2.
pub(super) const PAIRS: [(Contender, Contender); 3] =
    [(c2f(50, 200), condensation(600)), (c2f(300, 200), condensation(1000)), (c2f(300, 500), condensation(1500))];

/// Those that the claims are about, and the true pose.
pub(super) fn main() -> Vec<Contender> {
    let opponents = PAIRS.map(|(_, opponent)| opponent);
    SETTINGS.into_iter().chain(opponents).chain([TRUTH]).collect()
}

/// Beyond the paper.
pub(super) fn beside() -> Vec<Contender> {
    let with = |contender: Contender, score| Contender { score, ..contender };
    let of = |method| Contender { method, score: EQ3, person: Person::Other };
    let variant = |coarse, fine, chained, snapped| of(Method::CoarseToFine { coarse, fine, chained, snapped });
    let (small, large, many) = (c2f(50, 200), c2f(300, 500), condensation(1500));
    let mut all = vec![
        of(Method::OwnContours { coarse: 50, fine: 200, chained: false }),
        of(Method::OwnContours { coarse: 300, fine: 500, chained: false }),
        of(Method::OwnContours { coarse: 300, fine: 500, chained: true }),
        variant(50, 200, true, true),
        variant(300, 500, true, true),
        variant(300, 500, false, false),
        variant(300, 500, true, false),
        of(Method::Annealed(160)),
        of(Method::Partitioned(421)),
    ];
    for sigma in [0.1, 0.4] {
        all.extend([with(large, eq3(sigma)), with(many, eq3(sigma))]);
    }
    for score in [reid(None), reid(Some(0.5))] {
        all.extend([with(large, score), with(many, score)]);
    }
    all.extend([small, large, many, TRUTH].map(|contender| Contender { person: Person::Own, ..contender }));
    all
}

impl Contender {
    /// Its name in tables and keys.
    pub(super) fn name(&self) -> String {
        let mut name = match self.method {
            Method::CoarseToFine { coarse, fine, chained, snapped } => {
                let chained = if chained { ", chained" } else { "" };
                let snapped = if snapped { "" } else { ", no grid" };
                format!("c2f {coarse}+{fine}{chained}{snapped}")
            }
            Method::OwnContours { coarse, fine, chained } => {
                let chained = if chained { ", chained" } else { "" };
                format!("c2f {coarse}+{fine}{chained}, own contours")
            }
            Method::Condensation(n) => format!("condensation {n}"),
            Method::Annealed(n) => format!("annealed {n} x {LAYERS}"),
            Method::Partitioned(n) => format!("partitioned {n}"),
            Method::Truth => "true pose".into(),
        };
        match self.score {
            ImageScore::CoarseToFine { sigma_edge, .. } if self.score != EQ3 => {
                name.push_str(&format!(", sigma {sigma_edge}"));
            }
            ImageScore::DeutscherReid { bidirectional: None, .. } => name.push_str(", one direction"),
            ImageScore::DeutscherReid { bidirectional: Some(_), .. } => name.push_str(", both directions"),
            _ => {}
        }
        if self.person == Person::Own {
            name.push_str(", own body");
        }
        name
    }

    /// Evaluations of the whole likelihood a frame, at most; evaluations of a part count as a tenth.
    pub(super) const fn evaluations(&self) -> usize {
        match self.method {
            Method::CoarseToFine { coarse, fine, .. } | Method::OwnContours { coarse, fine, .. } => coarse + fine,
            Method::Condensation(n) => n,
            Method::Annealed(n) => n * LAYERS,
            Method::Partitioned(n) => n * 19 / 10,
            Method::Truth => 0,
        }
    }

    /// The name of its result with a level of noise and a seed.
    pub(super) fn key(&self, level: Level, seed: u64) -> String {
        let level = Level::ALL.iter().find(|(_, of)| *of == level).map_or("", |(name, _)| name);
        format!("{level}/{seed}/{}", self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_distinguish_all() {
        let names: Vec<String> = main().iter().chain(&beside()).map(Contender::name).collect();
        let mut distinct = names.clone();
        distinct.sort();
        distinct.dedup();
        assert_eq!(distinct.len(), names.len());
        assert_eq!(names[0], "c2f 50+200");
    }
}
