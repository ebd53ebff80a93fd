//! Writes the straight-line kinematics of the built-in bodies, from the same functions that make the bodies at run time.

#[path = "src/error.rs"]
#[allow(dead_code, reason = "the script uses a part of the crate")]
mod error;
#[path = "src/rotation.rs"]
#[allow(dead_code, reason = "as above")]
mod rotation;
#[path = "src/standard.rs"]
#[allow(dead_code, reason = "as above")]
mod standard;
#[path = "build/straight_line.rs"]
mod straight_line;
#[path = "src/kinematics/structure.rs"]
mod structure;
#[path = "src/tree.rs"]
#[allow(dead_code, reason = "as above")]
mod tree;

use error::Error;
use standard::Proportions;
use std::path::Path;
use std::{env, fs, io};

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed=build");
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=src");
    let adult = Proportions::default();
    let bodies = [("cf28", standard::cf28(&adult)), ("h32", standard::h32(&adult))];
    let out = env::var("OUT_DIR").map_err(io::Error::other)?;
    fs::write(Path::new(&out).join("straight_line.rs"), straight_line::source(&bodies))
}
