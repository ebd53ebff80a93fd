//! Who is compared: the paper's settings, its opponent, and those beside them.

use super::girth::Thickness;
use sinew::observe::silhouettes::image_score::ImageScore;
use sinew::tracking::coarse_to_fine::Judging;
use sinew_simulate::segmentation_noise::Level;

/// What tracks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Method {
    /// Coarse and fine particles; how parts are judged; coarse particles on their grid or not.
    CoarseToFine { coarse: usize, fine: usize, judging: Judging, snapped: bool },
    /// Coarse and fine particles; parts judged by all of their own contour.
    OwnContours { coarse: usize, fine: usize, judging: Judging },
    /// With a number of particles.
    Condensation(usize),
    /// With a number of particles in five layers.
    Annealed(usize),
    /// With a number of particles.
    Partitioned(usize),
    /// The fitted true pose: what the body can reach.
    Truth,
    /// The pose of the first frame, in every frame.
    Frozen,
    /// The mean pose of training, at the true position and heading.
    MeanPose,
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
    pub(super) thickness: Thickness,
}

/// Parts of the body.
const PARTS: usize = 10;

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

const fn of(method: Method) -> Contender {
    Contender { method, score: EQ3, person: Person::Other, thickness: Thickness::Printed }
}

const fn c2f(coarse: usize, fine: usize, judging: Judging) -> Contender {
    of(Method::CoarseToFine { coarse, fine, judging, snapped: true })
}

const fn condensation(particles: usize) -> Contender {
    of(Method::Condensation(particles))
}

/// The fitted true pose.
pub(super) const TRUTH: Contender = of(Method::Truth);

/// Coarse and fine particles of the paper, by rising numbers.
const SETTINGS: [(usize, usize); 4] = [(50, 200), (100, 200), (300, 200), (300, 500)];

/// Settings of Table 2, by their place, with the particles of their opponents.
const PAIRS: [(usize, usize); 3] = [(0, 600), (2, 1000), (3, 1500)];

/// What claims are judged for: a reading of how parts are judged, and a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reading {
    pub(super) judging: Judging,
    pub(super) thickness: Thickness,
}

/// All readings; the first is that of the printed formulas.
pub(super) const READINGS: [Reading; 4] = [
    Reading { judging: Judging::Decoupled, thickness: Thickness::Printed },
    Reading { judging: Judging::Whole, thickness: Thickness::Printed },
    Reading { judging: Judging::Decoupled, thickness: Thickness::Fitted },
    Reading { judging: Judging::Whole, thickness: Thickness::Fitted },
];

impl Reading {
    /// Words for titles.
    pub(super) const fn title(&self) -> &'static str {
        match (self.judging, self.thickness) {
            (Judging::Whole, Thickness::Printed) => "parts judged by the whole body",
            (Judging::Whole, Thickness::Fitted) => "parts judged by the whole body, fitted girth",
            (_, Thickness::Printed) => "parts judged on their own particle",
            (_, Thickness::Fitted) => "parts judged on their own particle, fitted girth",
        }
    }

    const fn with(&self, contender: Contender) -> Contender {
        Contender { thickness: self.thickness, ..contender }
    }

    /// The settings of the paper.
    pub(super) fn settings(&self) -> [Contender; 4] {
        SETTINGS.map(|(coarse, fine)| self.with(c2f(coarse, fine, self.judging)))
    }

    /// CONDENSATION with that many particles.
    pub(super) const fn condensation(&self, particles: usize) -> Contender {
        self.with(condensation(particles))
    }

    /// The pairs of Table 2.
    pub(super) fn pairs(&self) -> [(Contender, Contender); 3] {
        PAIRS.map(|(setting, particles)| (self.settings()[setting], self.condensation(particles)))
    }

    /// The same with opponents of as many evaluations of the whole likelihood.
    pub(super) fn equal_pairs(&self) -> [(Contender, Contender); 3] {
        self.pairs().map(|(setting, _)| (setting, self.condensation(setting.evaluations())))
    }
}

/// Those that the claims are about, of some readings.
pub(super) fn main(readings: &[Reading]) -> Vec<Contender> {
    let of = |reading: &Reading| {
        let opponents = reading.pairs().map(|(_, opponent)| opponent);
        let references = [Method::Truth, Method::MeanPose, Method::Frozen].map(|method| reading.with(of(method)));
        reading.settings().into_iter().chain(opponents).chain(references).collect::<Vec<_>>()
    };
    distinct(readings.iter().flat_map(of))
}

/// Opponents at equal evaluations, of some readings.
pub(super) fn equal(readings: &[Reading]) -> Vec<Contender> {
    distinct(readings.iter().flat_map(|reading| reading.equal_pairs().map(|(_, opponent)| opponent)))
}

/// Who is compared in the pilot.
pub(super) fn pilot() -> Vec<Contender> {
    let of = |reading: &Reading| {
        let references = [Method::Truth, Method::MeanPose, Method::Frozen].map(|method| reading.with(of(method)));
        references.into_iter().chain([reading.condensation(1500), reading.settings()[3]]).collect::<Vec<_>>()
    };
    distinct(READINGS.iter().flat_map(of))
}

fn distinct(all: impl Iterator<Item = Contender>) -> Vec<Contender> {
    let mut distinct: Vec<Contender> = vec![];
    for contender in all {
        if !distinct.contains(&contender) {
            distinct.push(contender);
        }
    }
    distinct
}

/// Beyond the paper.
pub(super) fn beside() -> Vec<Contender> {
    let with = |contender: Contender, score| Contender { score, ..contender };
    let variant = |coarse, fine, judging, snapped| of(Method::CoarseToFine { coarse, fine, judging, snapped });
    let [small, .., large] = READINGS[0].settings();
    let many = condensation(1500);
    let mut all = vec![
        of(Method::OwnContours { coarse: 50, fine: 200, judging: Judging::Decoupled }),
        of(Method::OwnContours { coarse: 300, fine: 500, judging: Judging::Decoupled }),
        of(Method::OwnContours { coarse: 300, fine: 500, judging: Judging::Chained }),
        variant(50, 200, Judging::Chained, true),
        variant(300, 500, Judging::Chained, true),
        variant(300, 500, Judging::Decoupled, false),
        variant(300, 500, Judging::Chained, false),
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

const fn judged(judging: Judging) -> &'static str {
    match judging {
        Judging::Decoupled => "",
        Judging::Chained => ", chained",
        Judging::Whole => ", whole",
    }
}

impl Contender {
    /// Whether it searches nothing.
    pub(super) const fn is_reference(&self) -> bool {
        matches!(self.method, Method::Truth | Method::Frozen | Method::MeanPose)
    }

    /// Its name in tables and keys.
    pub(super) fn name(&self) -> String {
        let mut name = match self.method {
            Method::CoarseToFine { coarse, fine, judging, snapped } => {
                let snapped = if snapped { "" } else { ", no grid" };
                format!("c2f {coarse}+{fine}{}{snapped}", judged(judging))
            }
            Method::OwnContours { coarse, fine, judging } => {
                format!("c2f {coarse}+{fine}{}, own contours", judged(judging))
            }
            Method::Condensation(n) => format!("condensation {n}"),
            Method::Annealed(n) => format!("annealed {n} x {LAYERS}"),
            Method::Partitioned(n) => format!("partitioned {n}"),
            Method::Truth => "true pose".into(),
            Method::Frozen => "first pose".into(),
            Method::MeanPose => "mean pose".into(),
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
        if self.thickness == Thickness::Fitted {
            name.push_str(", fitted girth");
        }
        name
    }

    /// Evaluations of the whole likelihood a frame, at most; evaluations of a part count as a tenth.
    pub(super) const fn evaluations(&self) -> usize {
        match self.method {
            Method::CoarseToFine { coarse, fine, judging: Judging::Whole, .. } => coarse + PARTS * fine,
            Method::CoarseToFine { coarse, fine, .. } | Method::OwnContours { coarse, fine, .. } => coarse + fine,
            Method::Condensation(n) => n,
            Method::Annealed(n) => n * LAYERS,
            Method::Partitioned(n) => n * 19 / 10,
            Method::Truth | Method::Frozen | Method::MeanPose => 0,
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
        let all = [main(&READINGS), equal(&READINGS), beside()].concat();
        let names: Vec<String> = all.iter().map(Contender::name).collect();
        let mut distinct = names.clone();
        distinct.sort();
        distinct.dedup();
        assert_eq!(distinct.len(), names.len());
        assert_eq!((&names[0][..], &names[4][..]), ("c2f 50+200", "condensation 600"));
    }

    #[test]
    fn equal_opponents_have_as_many_evaluations() {
        let counts =
            READINGS[1].equal_pairs().map(|(setting, opponent)| [setting.evaluations(), opponent.evaluations()]);
        assert_eq!(counts, [[2050; 2], [2300; 2], [5300; 2]]);
        assert_eq!(READINGS[0].equal_pairs()[2].1.name(), "condensation 800");
    }
}
