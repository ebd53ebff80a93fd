//! What is said of settings before a run: a frame rate that nobody gave, flags that change nothing.

use super::common::{ASSUMED_FPS, FPS};
use super::idle::idle_beside;
use super::resolved::Resolved;
use super::setting::Origin;
use super::track::TrackConfig;
use crate::input::flag::flag;
use crate::methods::METHODS;

impl TrackConfig {
    /// That the frame rate is assumed, where nobody gave one.
    #[must_use]
    pub fn assumed_rate(&self) -> Option<String> {
        let is_assumed = self.fps.is_none();
        is_assumed.then(|| format!("no frame rate given; {ASSUMED_FPS} frames per second assumed ({})", flag(FPS.key)))
    }
}

impl Resolved {
    /// Warnings about flags that change nothing beside the other settings.
    #[must_use]
    pub fn idle_flags(&self) -> Vec<String> {
        let given = self.values.by_key.iter().filter(|(_, (_, origin))| *origin == Origin::Flag);
        let idle = |key: &str| idle_beside(key, self.method(), &METHODS, &self.values);
        given.filter_map(|(key, _)| Some(format!("{} changes nothing with {}", flag(key), idle(key)?))).collect()
    }
}
