//! Weighting functions of silhouettes by name.

use sinew_observe::silhouettes::image_score::ImageScore;

/// Weighting functions of images that the program offers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Score {
    /// Edges and region of Deutscher, Blake & Reid.
    DeutscherReid,
    /// The same with the mismatch of silhouettes in both directions.
    Bidirectional,
    /// That of the coarse-to-fine tracker.
    CoarseToFine,
    /// The product over parts of Husz, Wallace & Green.
    Parts,
}

impl Score {
    /// All of them, in the order of the help.
    pub const ALL: [Self; 4] = [Self::DeutscherReid, Self::Bidirectional, Self::CoarseToFine, Self::Parts];

    /// Their names.
    pub const NAMES: [&str; 4] = {
        let mut names = [""; 4];
        let mut i = 0;
        while i < names.len() {
            names[i] = Self::ALL[i].name();
            i += 1;
        }
        names
    };

    /// Name on the command line and in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::DeutscherReid => "deutscher-reid",
            Self::Bidirectional => "bidirectional",
            Self::CoarseToFine => "coarse-to-fine",
            Self::Parts => "parts",
        }
    }

    /// The weighting function of that name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|score| score.name() == name)
    }

    /// The weighting function, with the factor κ where it has one.
    #[must_use]
    pub const fn with_kappa(self, kappa: f64) -> ImageScore {
        match self {
            Self::DeutscherReid => ImageScore::DeutscherReid { kappa, bidirectional: None },
            Self::Bidirectional => ImageScore::DeutscherReid { kappa, bidirectional: Some(0.5) },
            Self::CoarseToFine => ImageScore::CoarseToFine { sigma_edge: 0.2, sigma_region: 0.2 },
            Self::Parts => ImageScore::Parts,
        }
    }
}
