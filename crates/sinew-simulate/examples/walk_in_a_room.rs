//! Where a walker is and where they head, twice a second for half a minute, in a room of 6 m × 6 m.

use sinew_simulate::walker::{Gait, Walker, walker_pose};

fn main() {
    let walker = Walker::new(Gait { duration_s: 30.0, ..Gait::default() });
    println!("{:.1} m in 30 s", walker.length());
    for half_second in 0..60 {
        let time_s = 0.5 * f64::from(half_second);
        let pose = walker_pose(&walker, time_s);
        println!("{time_s:4.1} s  {:5.2} {:5.2} m  {:6.1}°", pose[0], pose[1], pose[3].to_degrees());
    }
}
