//! A tracker behind the identity as decoder answers and stores what it does without one.
//! Trackers that take a state part by part too. Decoders that bend are in `tests/tests/whole/latent_seam.rs` of the workspace.

mod common;

use common::Sight;
use sinew_core::combinators::Through;
use sinew_core::decode::Identity;
use sinew_core::lanes::{Block, Isa};
use sinew_core::part::{Part, PartTree, Partition};
use sinew_core::random::Stage;
use sinew_dynamics::random_walk::{Between, RandomWalk};
use sinew_samplers::grid::GridAxis;
use sinew_tracking::coarse_to_fine::{self, CoarseToFine};
use sinew_tracking::decoded::Decoded;
use sinew_tracking::partitioned::{self, Partitioned};
use sinew_tracking::{Error, Resume, StepInfo, Tracker};

const START: [f64; 2] = [0.1, 0.9];

fn stepped(tracker: &mut impl Tracker<Sight>, frame: u32, product: bool) -> (StepInfo, Vec<Block>, Vec<f64>) {
    let angle = 0.1 * f64::from(frame);
    let observed = Sight::new(vec![angle.sin(), angle.cos()], vec![50.0, 200.0], product);
    let info = tracker.step(&observed, Stage::new(2, "identity").at_frame(frame)).expect("a posterior");
    assert_eq!(info.mean, tracker.estimate());
    (info, tracker.posterior().states.to_vec(), tracker.posterior().weights.to_vec())
}

fn check<K>(make: impl Fn() -> K)
where
    K: Tracker<Sight> + Resume + for<'a> Tracker<Through<&'a Sight, &'a Identity>>,
{
    for product in [false, true] {
        let mut plain = make();
        let mut behind = Decoded::new(Identity(2), &START, |_| Ok::<K, Error>(make())).expect("valid");
        for frame in 0..12 {
            assert_eq!(stepped(&mut behind, frame, product), stepped(&mut plain, frame, product), "frame {frame}");
            assert_eq!(behind.save(), [plain.estimate(), &plain.save()].concat());
        }
    }
}

#[test]
fn through_the_identity_parts_stay_parts() {
    let parts = || [0, 1].map(|j| Part::new(vec![j], 2).expect("valid")).to_vec();
    let tree = || PartTree::new(Partition::new(parts(), 2).expect("covers"), vec![None, Some(0)]).expect("a tree");
    check(|| {
        let walk = RandomWalk::new(&[0.2; 2], 1.0, Between::Mixture, Isa::best()).expect("valid");
        let config = partitioned::Config { particles: 203, ..Default::default() };
        Partitioned::new(config, walk, tree(), START.to_vec()).expect("valid")
    });
    check(|| {
        let axes = vec![GridAxis::new(-2.0, 2.0, 0.15, false).expect("valid"); 2];
        let config = coarse_to_fine::Config { coarse: 51, fine: 43, ..Default::default() };
        CoarseToFine::new(config, axes, tree(), START.to_vec(), Isa::best()).expect("valid")
    });
}
