//! The points of a BVH file over its frames, metres, z up: `bvh_body [FILE.bvh METRES_PER_UNIT]`. Without a file a short one that is written here, in centimetres.

use sinew_body::{Isa, Plan, point_positions_each};
use sinew_formats::bvh;
use std::error::Error;

const LEG: &str = "HIERARCHY
ROOT Hip
{
  OFFSET 0 90 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation
  JOINT Knee
  {
    OFFSET 0 -43 0
    CHANNELS 1 Xrotation
    End Site
    {
      OFFSET 0 -42 0
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.04
0 0 0 0 0 0 0
0 0 5 0 0 -20 40
";

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (name, text, unit_m) = match &arguments[..] {
        [] => ("leg.bvh", LEG.to_owned(), 0.01),
        [file, unit] => (file.as_str(), std::fs::read_to_string(file)?, unit.parse()?),
        _ => return Err("give a file and the metres of its unit, or nothing".into()),
    };
    let file = bvh::read(name, &text)?;
    let body = file.body(unit_m)?;
    let plan = Plan::with_all_points(&body);
    for frame in 0..file.frames.len() {
        let state = file.state(frame, unit_m).ok_or("a frame without all its channels")?;
        let points = point_positions_each(&plan, Isa::best(), &state);
        for (point, [x, y, z]) in body.points().iter().zip(points.as_chunks::<3>().0) {
            println!("{frame} {} {x:.3} {y:.3} {z:.3}", point.name);
        }
    }
    Ok(())
}
