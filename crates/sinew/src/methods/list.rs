//! The one list of methods.

use super::about::About;
use super::{annealed, bootstrap, coarse_to_fine, gpapf, guided, h_apf, hmc, hppf, partitioned};

/// All methods, in the order of the help; the first is the default.
pub const METHODS: [&About; 9] = [
    &hmc::ABOUT,
    &bootstrap::ABOUT,
    &guided::ABOUT,
    &annealed::ABOUT,
    &partitioned::ABOUT,
    &hppf::ABOUT,
    &coarse_to_fine::ABOUT,
    &gpapf::ABOUT,
    &h_apf::ABOUT,
];

/// The method of that name.
#[must_use]
pub fn find(name: &str) -> Option<&'static About> {
    METHODS.into_iter().find(|about| about.name == name)
}
