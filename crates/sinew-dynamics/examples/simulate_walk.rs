//! Eight draws of where a random walk goes in ten frames at 30 frames a second.

use sinew_core::lanes::{Block, Isa};
use sinew_core::random::Stage;
use sinew_core::transition::Transition;
use sinew_dynamics::random_walk::{Between, RandomWalk};

fn main() -> Result<(), sinew_dynamics::Error> {
    let walk = RandomWalk::new(&[1.0], 1.0 / 30.0, Between::Mixture, Isa::best())?;
    let mut state = [Block::ZERO];
    for frame in 0..10 {
        let previous = state;
        walk.sample_block(&previous, &mut state, &mut Stage::new(1, "example").at_frame(frame).whole());
        println!("{frame}: {:5.2?}", state[0].0);
    }
    Ok(())
}
