//! Every setting of a run, in one table.

use super::common::*;
use super::setting::{AnySetting, Setting, SettingKind, SettingType, Typed, Value, setting};
use crate::methods::about::About;
use crate::methods::list::{self, METHODS};
use std::sync::LazyLock;

/// The method.
pub const METHOD: Typed<&'static About> =
    setting((OF_METHOD, "method", SettingKind::Choice(&[]), "NAME", || METHODS[0], ""));

impl SettingType for &'static About {
    fn read(value: &Value) -> Option<Self> {
        list::find(&String::read(value)?)
    }
    fn value(self) -> Option<Value> {
        self.name.to_owned().value()
    }
}

/// Settings before the settings of single methods.
#[rustfmt::skip]
const FIRST: &[&dyn AnySetting] = &[
    &CALIBRATION, &KEYPOINTS, &SILHOUETTES, &IMAGES, &LAYOUT, &FRAMES, &FPS, &CAMERAS, &PERSON, &PEOPLE, &SUBJECT,
    &TRIM, &LAG, &CONFIDENCE_SCALE, &IMAGE_SCALE, &MASK_SCALE, &UP_AXIS, &UP, &METHOD, &BODY, &SETUP, &INIT,
    &SETUP_FRAMES, &ANY_SIZE, &SMOOTH, &LAG_FRAMES, &PRIOR, &MOTION_SCALE, &MOTION_MODEL, &LATENT, &NOISE, &OUTLIER,
    &DEGREES, &LEAST_CONFIDENCE,
];

/// Settings after the settings of single methods.
#[rustfmt::skip]
const LAST: &[&dyn AnySetting] = &[
    &SCORE, &KAPPA, &RASTER, &DRAWS, &SIMD, &MAX_R_HAT, &MAX_R_HAT_SHARE, &MAX_DIVERGENT_SHARE, &MIN_ESS, &SEED,
    &THREADS, &ANGLES, &STATIC, &OUT, &CHECKPOINT_EVERY, &FORCE,
];

/// Names as a sentence lists them.
fn listed(names: &[&str]) -> String {
    match names {
        [first @ .., last] if !first.is_empty() => format!("{} or {last}", first.join(", ")),
        _ => names.concat(),
    }
}

fn particles(methods: &[&'static About]) -> Setting {
    let usual = |about: &&About| about.particles.map(|count| format!("{} {}", count(), about.name));
    let usual: Vec<String> = methods.iter().filter_map(usual).collect();
    Setting { help: format!("particles [default: {}]", usual.join(", ")).leak(), ..PARTICLES.row() }
}

/// The table of a list of methods.
#[must_use]
pub fn table(methods: &[&'static About]) -> Vec<Setting> {
    let rows = |settings: &[&dyn AnySetting]| settings.iter().map(|setting| setting.row()).collect::<Vec<_>>();
    let mut all = rows(FIRST);
    let mut has_particles = false;
    for about in methods {
        if about.particles.is_some() && !has_particles {
            all.push(particles(methods));
            has_particles = true;
        }
        all.extend(rows(about.settings));
    }
    all.extend(rows(LAST));
    if let Some(method) = all.iter_mut().find(|setting| setting.key == METHOD.key) {
        let names: &'static [&'static str] = methods.iter().map(|about| about.name).collect::<Vec<_>>().leak();
        method.kind = SettingKind::Choice(names);
        method.help = listed(names).leak();
    }
    all
}

/// Every setting.
#[must_use]
pub fn settings() -> &'static [Setting] {
    static TABLE: LazyLock<Vec<Setting>> = LazyLock::new(|| table(&list::METHODS));
    &TABLE
}

/// The setting of that name.
#[must_use]
pub fn find(key: &str) -> Option<&'static Setting> {
    settings().iter().find(|setting| setting.key == key)
}

/// Settings that say where to write and how to behave, not what to compute: they are not repeated in `config.toml`.
#[must_use]
pub fn is_local(key: &str) -> bool {
    [OUT.key, FORCE.key, THREADS.key, CHECKPOINT_EVERY.key].contains(&key)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_constant_stands_in_the_table() {
        let constants = include_str!("common.rs")
            .lines()
            .filter_map(|line| line.strip_prefix("pub const ")?.split_once(": Typed<"));
        for (name, _) in constants {
            assert!(find(&name.to_lowercase()).is_some(), "`{name}` is in no table");
        }
    }
}
