//! `cargo xtask study picture`: draws `docs/images/demo.svg`, the drawings of angles, and `real.png` where the recordings are.

mod angles;
mod demo;
mod real;

use crate::support::outcome::Outcome;
use std::fs;
use std::path::Path;

/// Draws the pictures.
pub fn run(root: &Path) -> Outcome<()> {
    let folder = root.join("docs/images");
    let data = std::env::var_os("SINEW_DATA").map_or_else(|| root.join("../shared/data"), Into::into);
    fs::create_dir_all(&folder)?;
    for sheet in angles::SHEETS {
        write(&folder.join(sheet.file), angles::svg(&sheet)?.as_bytes())?;
    }
    write(&folder.join("demo.svg"), demo::svg()?.as_bytes())?;
    if real::is_there(&data) {
        write(&folder.join("real.png"), &real::png(&data)?)?;
    } else {
        println!("skipped real.png: no data in {}", data.display());
    }
    Ok(())
}

fn write(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    fs::write(path, bytes)?;
    println!("{}: {} kB", path.display(), bytes.len() / 1000);
    Ok(())
}
