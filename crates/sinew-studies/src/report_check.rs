//! `cargo xtask study report-check PAGE`: opens a page of `sinew report` in a headless browser, with WebGL in software and without any.
//!
//! Judged, each time: the page says that it is ready, draws with what it should, plays without being asked, has its curves, says of no problem and writes nothing on the console. A picture of each lies beside the page: look at it.

use crate::support::outcome::Outcome;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Most bytes of a page.
const LARGEST: u64 = 3_000_000;

/// Time that passes on the page before it is judged, milliseconds.
const PASSED_MS: u32 = 3000;

/// What the page should draw with, and the flags of the browser that make it so.
const WAYS: [(&str, &[&str]); 2] = [
    ("webgl", &["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]),
    ("canvas", &["--disable-gpu", "--disable-3d-apis"]),
];

/// What to open, and with what.
#[derive(clap::Args)]
pub struct Args {
    /// The page.
    page: PathBuf,
    /// Chromium, or Chrome.
    #[arg(long, default_value = "chromium")]
    browser: String,
}

/// Checks a page.
pub fn run(args: &Args) -> Outcome<()> {
    let page = args.page.canonicalize()?;
    let size = page.metadata()?.len();
    println!("{}: {size} bytes, at most {LARGEST}", page.display());
    let mut holds = size <= LARGEST;
    for (way, flags) in WAYS {
        let (document, console) = opened(&args.browser, flags, &page, "--dump-dom".into())?;
        let picture = page.with_extension(format!("{way}.png"));
        opened(&args.browser, flags, &page, format!("--screenshot={}", picture.display()))?;
        let (root, body) = document.split_once("<head>").unwrap_or_default();
        let mut lacking =
            vec!["data-state=\"ready\"".to_owned(), "data-playing=\"true\"".into(), format!("data-view=\"{way}\"")];
        lacking.retain(|words| !root.contains(words));
        if !body.contains("<figure class=\"plot\">") {
            lacking.push("curves".into());
        }
        holds &= lacking.is_empty() && console.is_empty();
        println!("{way}: lacks {lacking:?}, console {console:?}; look at {}", picture.display());
    }
    if holds { Ok(()) } else { Err("the page does not hold what is said above".into()) }
}

/// The page's document after a while, as the browser prints it, and what was written on its console.
fn opened(browser: &str, flags: &[&str], page: &Path, then: String) -> Outcome<(String, Vec<String>)> {
    let output = Command::new(browser)
        .args([
            "--headless=new",
            "--no-sandbox",
            "--hide-scrollbars",
            "--window-size=1280,900",
            "--enable-logging=stderr",
        ])
        .args(flags)
        .arg(format!("--virtual-time-budget={PASSED_MS}"))
        .arg(then)
        .arg(format!("file://{}", page.display()))
        .output()
        .map_err(|error| format!("{browser}: {error}; give another with --browser"))?;
    let said = String::from_utf8_lossy(&output.stderr);
    let console = said.lines().filter(|line| line.contains("CONSOLE")).map(str::to_owned).collect();
    Ok((String::from_utf8_lossy(&output.stdout).into_owned(), console))
}
