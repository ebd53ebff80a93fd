//! The trackers, each with its settings of the program where it has others than the usual ones.

/// What a tracker sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Seen {
    Keypoints,
    Masks,
}

impl Seen {
    /// Its name in tables and keys.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Keypoints => "keypoints",
            Self::Masks => "masks",
        }
    }
}

/// A model that a tracker needs, learned from walks that it does not track.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Learned {
    /// Action primitives of HPPF24.
    Primitives,
    /// One latent space of poses with dynamics, of CF28.
    Gpdm,
    /// A hierarchy of latent spaces, of CF28.
    Hgplvm,
}

impl Learned {
    pub(super) const ALL: [Self; 3] = [Self::Primitives, Self::Gpdm, Self::Hgplvm];

    /// Its name in tables and files.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Primitives => "primitives",
            Self::Gpdm => "gpdm",
            Self::Hgplvm => "hgplvm",
        }
    }

    /// The body whose poses it knows.
    pub(super) const fn body(self) -> &'static str {
        match self {
            Self::Primitives => "hppf24",
            Self::Gpdm | Self::Hgplvm => "cf28",
        }
    }

    /// The flag of `sinew track` that takes it.
    pub(super) const fn flag(self) -> &'static str {
        match self {
            Self::Primitives => "--motion-model",
            Self::Gpdm | Self::Hgplvm => "--latent",
        }
    }
}

/// A tracker on keypoints or masks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) method: &'static str,
    pub(super) seen: Seen,
    pub(super) learned: Option<Learned>,
    pub(super) flags: &'static [&'static str],
}

const fn entry(method: &'static str, seen: Seen, learned: Option<Learned>) -> Entry {
    Entry { method, seen, learned, flags: &[] }
}

/// All, as the program runs them where nothing else is said; `hmc` and `guided` do not track from masks alone.
pub(super) const ENTRIES: [Entry; 16] = [
    entry("hmc", Seen::Keypoints, None),
    entry("bootstrap", Seen::Keypoints, None),
    entry("guided", Seen::Keypoints, None),
    entry("annealed", Seen::Keypoints, None),
    entry("partitioned", Seen::Keypoints, None),
    entry("hppf", Seen::Keypoints, Some(Learned::Primitives)),
    entry("coarse-to-fine", Seen::Keypoints, None),
    entry("gpapf", Seen::Keypoints, Some(Learned::Gpdm)),
    entry("h-apf", Seen::Keypoints, Some(Learned::Hgplvm)),
    entry("bootstrap", Seen::Masks, None),
    entry("annealed", Seen::Masks, None),
    entry("partitioned", Seen::Masks, None),
    entry("hppf", Seen::Masks, Some(Learned::Primitives)),
    entry("coarse-to-fine", Seen::Masks, None),
    entry("gpapf", Seen::Masks, Some(Learned::Gpdm)),
    entry("h-apf", Seen::Masks, Some(Learned::Hgplvm)),
];

#[cfg(test)]
mod tests {
    use super::*;
    use sinew::methods::METHODS;

    #[test]
    fn every_method_of_the_program_is_there() {
        for method in METHODS {
            let seen: Vec<Seen> = ENTRIES.iter().filter(|e| e.method == method.name).map(|e| e.seen).collect();
            let expected =
                if method.needs_gradients { &[Seen::Keypoints][..] } else { &[Seen::Keypoints, Seen::Masks][..] };
            assert_eq!(seen, expected, "{}", method.name);
        }
    }
}
