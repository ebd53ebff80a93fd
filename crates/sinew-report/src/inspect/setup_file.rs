//! What a set-up of ours holds: the body, the subject's sizes, the noise of each camera.

use super::facts::{Facts, Odd};
use super::lasting_facts;
use crate::Error;
use sinew::files::read_text;
use sinew::setup::{Body, Setup};
use sinew_body::{Joint, Proportions};
use sinew_formats::source_text::MAX_CONFIG_BYTES;
use sinew_observe::Camera;
use std::path::Path;

/// What a set-up holds; `calibration` are its cameras, where they are known.
pub(super) fn facts(path: &Path, calibration: &[Camera]) -> Result<Facts, Error> {
    let setup = Setup::parse(&path.display().to_string(), &read_text(path, MAX_CONFIG_BYTES)?)?;
    let tree = setup.body.tree(&Proportions::default());
    let mut facts = Facts::new(format!("{}: set-up with {} cameras", path.display(), setup.camera.len()));
    facts.row("body", format!("{}, {} degrees of freedom", setup.body.name(), tree.dof()));
    facts.row("layout", &setup.layout);
    let person = match setup.person {
        0 => "the most complete one at the start".into(),
        place => format!("{} at the start, the most complete one first", place + 1),
    };
    facts.row("person", person);
    facts.row("up axis", format!("{} as declared, {} as found", setup.world_up, setup.up_axis));
    facts.row("model error", format!("{:.1} mm per axis", 1e3 * setup.model_error_m));
    facts.row("start frame", setup.start_frame.to_string());
    if let Some(motion_sd) = &setup.motion_sd {
        let range = |is_wanted: fn(&Joint) -> bool| {
            let joints = tree.joints().zip(motion_sd).filter(|((_, joint), _)| is_wanted(joint));
            let (low, high) =
                joints.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (_, sd)| (low.min(*sd), high.max(*sd)));
            format!("{low:.2} to {high:.2}")
        };
        let translations = range(|joint| matches!(joint, Joint::Translate(_)));
        let rotations = range(|joint| matches!(joint, Joint::Rotate(_)));
        facts.row("motion sd", format!("{translations} m, {rotations} rad per square-root second"));
    }
    if let (Some(size), Some(steps)) = (setup.step_size, setup.leapfrog_steps) {
        facts.row("trajectory", format!("{steps} leapfrog steps of {size:.3}"));
    }
    let Proportions { spine, shoulder_half_width, hip_half_width, upper_arm, forearm, thigh, shin, .. } =
        setup.proportions;
    // The subject of a body file is measured with H32.
    let whose = if matches!(setup.body, Body::File(_)) { "subject, m" } else { "lengths, m" };
    facts.row(
        whose,
        format!(
            "spine {spine:.3}, shoulders {:.3}, hips {:.3}, upper arm {upper_arm:.3}, forearm {forearm:.3}, thigh {thigh:.3}, shin {shin:.3}",
            2.0 * shoulder_half_width,
            2.0 * hip_half_width
        ),
    );
    for camera in &setup.camera {
        let [u, v] = camera.offset_px;
        let [exchanged, elsewhere] = [camera.exchanged, camera.elsewhere].map(|share| 100.0 * share);
        let mistakes = format!("sides exchanged in {exchanged:.1} % of frames, somebody else's in {elsewhere:.1} %");
        let scatter = format!("offset ({u:+.1}, {v:+.1}) px, then {:.1} px per axis", camera.sigma_px);
        facts.row(&camera.name, format!("{scatter}, {mistakes}"));
    }
    let problems = setup.problems();
    if let Some(known) = setup.lasting.as_ref().filter(|_| problems.is_empty()) {
        lasting_facts::add(&mut facts, known, calibration);
    }
    facts.odd.extend(problems.into_iter().map(Odd::Words));
    Ok(facts)
}
