//! Where the links of a robot are: `robot [FILE.urdf [ANGLE …]]`, radians and metres in the order that is printed. Without a file an arm that is written here.

use sinew_formats::urdf;
use std::error::Error;

const ARM: &str = "<robot name='arm'>
  <link name='base'/> <link name='upper_arm'/> <link name='forearm'/> <link name='hand'/>
  <joint name='shoulder' type='revolute'><parent link='base'/><child link='upper_arm'/>
    <origin xyz='0 0 0.4'/><axis xyz='0 1 0'/><limit lower='-2' upper='2'/></joint>
  <joint name='elbow' type='revolute'><parent link='upper_arm'/><child link='forearm'/>
    <origin xyz='0 0 0.3' rpy='0 0.2 0'/><axis xyz='0 0.8 0.6'/><limit lower='0' upper='2.5'/></joint>
  <joint name='wrist' type='fixed'><parent link='forearm'/><child link='hand'/><origin xyz='0 0 0.25'/></joint>
</robot>";

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let file = arguments.next();
    let text = file.as_ref().map_or(Ok(ARM.into()), std::fs::read_to_string)?;
    let robot = urdf::read(file.as_deref().unwrap_or("arm.urdf"), &text)?;
    let mut state = arguments.map(|angle| angle.parse()).collect::<Result<Vec<f64>, _>>()?;
    state.resize(robot.tree.dof(), 0.5);
    for ((name, value), range) in robot.tree.dof_names().iter().zip(&state).zip(&robot.ranges) {
        println!("{name} = {value} of {range:?}");
    }
    for (link, (_, [x, y, z])) in robot.tree.links().iter().zip(robot.tree.link_frames(&state)) {
        println!("{:12} {x:8.3} {y:8.3} {z:8.3} m", link.name);
    }
    Ok(())
}
