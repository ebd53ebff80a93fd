//! The figure of actions: the error of the usual tracker over time, and which clusters moved its parts.
//!
//! One run is drawn, and its cell alone keeps its actions.

use super::contender::{Contender, Motion, USUAL, on};
use super::motions::RATE_HZ;
use crate::papers::seed_results::Keyed as _;
use crate::support::outcome::Outcome;
use crate::support::store::{Store, numbers};
use serde_json::{Value, json};
use sinew::body::{KinematicTree, hppf24};
use sinew::dynamics::primitives::switching::Choice;
use sinew_report::inspect::action_picture;
use sinew_results::action_trace::{ActionTrace, PartActions, Shares, add_share};

/// Motions that are drawn, the second in the reduced size, of the usual tracker with this seed.
const DRAWN: [Motion; 2] = [Motion::Combo, Motion::Walk];
const SEED: u64 = 1;

/// Whether the figure is of this run.
pub(super) fn is_drawn(contender: &Contender, seed: u64) -> bool {
    seed == SEED && DRAWN.iter().any(|&motion| *contender == on(USUAL, motion))
}

/// The shares of each part in a frame, in thousandths.
pub(super) fn stored(choices: &[Vec<(u32, f64)>]) -> Value {
    let part = |choices: &Vec<(u32, f64)>| {
        let mut shares = Shares::new();
        for &(number, share) in choices {
            let (cluster, model) = Choice::from_number(number);
            add_share(&mut shares, cluster, model, share);
        }
        shares.into_iter().map(|(by, share)| json!([by, (1e3 * share).round()])).collect::<Value>()
    };
    choices.iter().map(part).collect()
}

/// The trace that [`stored`] frames are, of the parts of a body.
fn trace(frames: &[Value], tree: &KinematicTree, motion: Motion) -> Outcome<ActionTrace> {
    let shares = |value: &Value| -> Shares {
        let share =
            |pair: &Value| (pair[0].as_u64().map(|cluster| cluster as usize), pair[1].as_f64().unwrap_or(0.0) / 1e3);
        value.as_array().into_iter().flatten().map(share).collect()
    };
    let flesh = hppf24::flesh_on(tree)?;
    let parts = flesh.solids().iter().enumerate().map(|(part, solid)| PartActions {
        name: solid.name.clone(),
        frames: frames.iter().map(|frame| shares(&frame[part])).collect(),
    });
    Ok(ActionTrace { time_s: (0..frames.len()).map(|frame| second(motion, frame)).collect(), parts: parts.collect() })
}

/// Time of a judged frame.
fn second(motion: Motion, frame: usize) -> f64 {
    (motion.first() + frame) as f64 / RATE_HZ
}

/// The figure of a motion as SVG.
pub(super) fn actions(store: &Store, tree: &KinematicTree, motion: Motion) -> Outcome<String> {
    let contender = on(USUAL, motion);
    let key = contender.key(SEED);
    let cell = store.get(&key).ok_or(format!("the cell {key} is missing"))?;
    let Some(frames) = cell["actions"].as_array() else {
        let file = store.path.display();
        return Err(
            format!("{file}: the cell {key} was made without its actions: remove its line, and run again").into()
        );
    };
    let errors: Vec<(f64, f64)> = numbers(&cell["absolute"])
        .into_iter()
        .enumerate()
        .map(|(frame, error)| (second(motion, frame), error))
        .collect();
    let title = format!("{}, {}, seed {SEED}", motion.name(), contender.method.name());
    Ok(action_picture(&title, &trace(frames, tree, motion)?, &errors))
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew::dynamics::primitives::switching::Branch;

    #[test]
    fn stored_actions_are_found_again() {
        let number = |cluster, branch| Choice { cluster, branch }.number();
        let torso = vec![(0, 1.0)];
        let head =
            vec![(number(4, Branch::Next), 0.25), (number(4, Branch::Step), 0.25), (number(7, Branch::Walk), 0.5)];
        let frame = stored(&[torso, head]);
        let found = trace(&[frame], &hppf24::tree(1.0), Motion::Combo).unwrap();
        assert_eq!(found.time_s, [second(Motion::Combo, 0)]);
        assert_eq!((found.parts[0].name.as_str(), found.parts[1].name.as_str()), ("torso", "head"));
        assert_eq!(found.parts[0].frames, [[(None, 1.0)]]);
        assert_eq!(found.parts[1].frames, [[(Some(4), 0.5), (None, 0.5)]]);
        let drawn = on(USUAL, Motion::Combo);
        assert!(is_drawn(&drawn, 1) && !is_drawn(&drawn, 2));
    }
}
