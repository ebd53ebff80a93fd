//! The set-up's posterior of the body, where lengths and places are not what its prior expects.

use rayon::prelude::*;
use sinew::setup::SetupRequest;
use sinew_tests::drawn_rig::{RATE_HZ, Rig, truth};
use sinew_tests::simulated_source::set_up;

/// Rigs.
const RIGS: u64 = 10;

/// Lengths are right in the mean, and squared deviations over the variances of their draws about 1. Were the steps of poses to tell lengths, bodies would be 5 mm too long in these rigs.
#[test]
fn lengths_that_nobody_expects_are_held() {
    let found = |seed: u64| -> Vec<[f64; 2]> {
        let rig = Rig::drawn(seed).unwrap();
        let request = SetupRequest { fps: Some(RATE_HZ), any_size: true, ..SetupRequest::default() };
        let setup = set_up(&mut rig.source(), &request, RATE_HZ, seed).unwrap();
        let known = setup.lasting.as_ref().unwrap();
        let truth = truth(&rig, &setup, known);
        let one = |place: usize| {
            let known = known.known(place);
            let too_long = known.mean - truth[place];
            [too_long, (too_long / known.sd).powi(2)]
        };
        known.layout().lengths().map(one).collect()
    };
    let found: Vec<[f64; 2]> = (1..=RIGS).into_par_iter().flat_map_iter(found).collect();
    let [too_long, square] = [0, 1].map(|k: usize| found.iter().map(|row| row[k]).sum::<f64>() / found.len() as f64);
    assert!(too_long.abs() < 3e-3, "{:.1} mm too long", 1e3 * too_long);
    assert!((0.4..2.0).contains(&square), "{square:.2}");
}
