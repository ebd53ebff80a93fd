//! Methods by name, and what each of them can use.

use sinew_observe::image_score::ImageScore;

/// Trackers that the program offers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Hybrid Monte Carlo filter.
    #[default]
    Hmc,
    /// Bootstrap particle filter.
    Bootstrap,
    /// Annealed particle filter, a search.
    Annealed,
    /// Partitioned sampling.
    Partitioned,
    /// Two-level coarse-to-fine tracker, a search.
    CoarseToFine,
}

/// All of them.
pub const METHODS: [Method; 5] =
    [Method::Hmc, Method::Bootstrap, Method::Annealed, Method::Partitioned, Method::CoarseToFine];

impl Method {
    /// Name on the command line and in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hmc => "hmc",
            Self::Bootstrap => "bootstrap",
            Self::Annealed => "annealed",
            Self::Partitioned => "partitioned",
            Self::CoarseToFine => "coarse-to-fine",
        }
    }

    /// The method of that name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        METHODS.into_iter().find(|method| method.name() == name)
    }

    /// Whether it moves along gradients: images are then compared by the distance of limbs from contours, which says nothing of what no limb covers and belongs beside keypoints.
    #[must_use]
    pub const fn takes_gradients(self) -> bool {
        matches!(self, Self::Hmc)
    }

    /// Whether it looks for a peak, so that its particles are no posterior.
    #[must_use]
    pub const fn is_search(self) -> bool {
        matches!(self, Self::Annealed | Self::CoarseToFine)
    }

    /// Whether it takes the body part by part.
    #[must_use]
    pub const fn takes_parts(self) -> bool {
        matches!(self, Self::Partitioned | Self::CoarseToFine)
    }

    /// Particles where nobody says how many.
    #[must_use]
    pub const fn usual_particles(self) -> usize {
        match self {
            Self::Hmc | Self::Bootstrap => 10_000,
            Self::Annealed => 200,
            Self::Partitioned => 1000,
            Self::CoarseToFine => 300,
        }
    }

    /// Weighting function of images where nobody names one: the paper's, but for the filters that take the whole body at once, which lose arms in the silhouette of the torso unless uncovered pixels count, too.
    #[must_use]
    pub const fn usual_score(self) -> Score {
        match self {
            Self::Hmc | Self::Bootstrap | Self::Annealed => Score::Bidirectional,
            Self::Partitioned => Score::Parts,
            Self::CoarseToFine => Score::CoarseToFine,
        }
    }
}

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
    /// The weighting function of that name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        let named = [
            ("deutscher-reid", Self::DeutscherReid),
            ("bidirectional", Self::Bidirectional),
            ("coarse-to-fine", Self::CoarseToFine),
            ("parts", Self::Parts),
        ];
        named.into_iter().find(|(known, _)| *known == name).map(|(_, score)| score)
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
