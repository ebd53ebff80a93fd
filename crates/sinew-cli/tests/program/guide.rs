//! Every command of the guide and of the README runs and prints what its page shows.
//! Commands run in the order of the page.
//!
//! A page finds the files of "your own recording" in its folder: a simulated one. Blocks that open with `# sinew.toml` are written to that file. Runs are
//! shortened by settings in the environment; walkers are simulated for a second where a page does not say how long, before two cameras of small images. Nothing else differs from what a reader types. `sinew demo`, with which
//! several pages begin, is run once. A line that ends with a backslash continues in the next. Lines that do not begin with `sinew` are not run.

use crate::common::{Files, Trial, files, write_files};
use sinew::core::random::Stage;
use sinew::formats::{calib_toml, picture};
use sinew_simulate::render::RayCamera;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Settings that make runs short, and let their diagnostics pass.
const SHORT: [(&str, &str); 11] = [
    ("SINEW_UPDATES", "4"),
    ("SINEW_BURN_IN", "1"),
    ("SINEW_CHAINS", "8"),
    ("SINEW_PARTICLES", "24"),
    ("SINEW_LAYERS", "2"),
    ("SINEW_FINE", "16"),
    ("SINEW_DRAWS", "8"),
    ("SINEW_MAX_R_HAT_SHARE", "1"),
    ("SINEW_MAX_DIVERGENT_SHARE", "1"),
    ("SINEW_MIN_ESS", "0"),
    ("SINEW_CHECKPOINT_EVERY", "3600"),
];

/// Pages of the guide.
const PAGES: [&str; 10] = [
    "batch",
    "cameras",
    "first-recording",
    "laboratory",
    "live",
    "motion-models",
    "own-recording",
    "results",
    "silhouettes",
    "warnings",
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Fenced blocks of a page: language and lines.
fn blocks(page: &str) -> Vec<(&str, Vec<&str>)> {
    let mut found: Vec<(&str, Vec<&str>)> = vec![];
    let mut open = false;
    for line in page.lines() {
        match (open, line.strip_prefix("```")) {
            (false, Some(language)) => found.push((language, vec![])),
            (true, None) => found.last_mut().unwrap().1.push(line),
            _ => {}
        }
        open ^= line.starts_with("```");
    }
    found
}

/// The folder in which a page's commands run, with a recording of its reader's own if the page uses one.
fn folder(page: &str) -> Trial {
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    if ["--keypoints pose", "Calib.toml pose", "--images images"].iter().any(|own| page.contains(own)) {
        own_recording(&trial);
    }
    if page.contains("batch plan recordings") {
        own_recording(&trial);
        fs::create_dir_all(trial.path("recordings/S1/walk")).unwrap();
        fs::rename(trial.path("pose"), trial.path("recordings/S1/walk/pose")).unwrap();
        fs::rename(trial.path("Calib.toml"), trial.path("recordings/Calib.toml")).unwrap();
        let own = "root = true\ncalibration = \"Calib.toml\"\nfps = 30\nlayout = \"BODY_25B\"\n";
        let short =
            SHORT.map(|(name, value)| format!("{} = {value}\n", name.trim_start_matches("SINEW_").to_lowercase()));
        fs::write(trial.path("recordings/sinew.toml"), own.to_owned() + &short.concat()).unwrap();
    }
    trial
}

/// `Calib.toml`, `pose`, `images` and `empty` of cameras `cam01` … `cam04`.
fn own_recording(trial: &Trial) {
    let made = trial.run(&["simulate", "-o", "made", "--duration", "1", "--images", "5", "--no-progress"]);
    assert!(made.status.success(), "{}", trial.printed(&made));
    let calibration = fs::read_to_string(trial.path("made/Calib.toml")).unwrap();
    let renamed =
        (1..=4).fold(calibration, |text, camera| text.replace(&format!("C{camera}"), &format!("cam0{camera}")));
    for folder in ["pose", "images", "empty"] {
        fs::create_dir(trial.path(folder)).unwrap();
    }
    for (from, to) in [("keypoints", "pose"), ("images", "images")] {
        for entry in fs::read_dir(trial.path("made").join(from)).unwrap() {
            let entry = entry.unwrap();
            let name = entry.file_name().into_string().unwrap().replacen('C', "cam0", 1);
            fs::rename(entry.path(), trial.path(to).join(name)).unwrap();
        }
    }
    for camera in calib_toml::read("Calib.toml", &renamed).unwrap().cameras {
        let view = RayCamera::new(&camera);
        let room = view.room(1);
        for frame in 0..4_u32 {
            let mut file = fs::File::create(trial.path(&format!("empty/{}_{frame:04}.png", camera.name))).unwrap();
            picture::write_png(&mut file, &view.picture(&[], &room, &Stage::new(9, "empty room").at_frame(frame)))
                .unwrap();
        }
    }
    fs::write(trial.path("Calib.toml"), renamed).unwrap();
    fs::remove_dir_all(trial.path("made")).unwrap();
}

/// What `sinew demo` writes, and what it prints: it reads no file and nothing of the environment.
static DEMO: OnceLock<(Files, String)> = OnceLock::new();

fn demo() -> (Files, String) {
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    let output = trial.run(&["demo"]);
    assert!(output.status.success(), "{}", trial.printed(&output));
    (files(trial.folder.path()), String::from_utf8(output.stdout).unwrap())
}

/// Runs a line of a page, and returns what it printed.
fn run(trial: &Trial, line: &str) -> String {
    let line = line.split(" #").next().unwrap_or(line);
    let mut arguments: Vec<&str> = line.split_whitespace().skip(1).collect();
    if arguments == ["demo"] {
        let (files, printed) = DEMO.get_or_init(demo);
        write_files(trial.folder.path(), files);
        return printed.clone();
    }
    if arguments[0] == "simulate" && !arguments.contains(&"--people") {
        let is_said = arguments.contains(&"--duration");
        arguments.extend(["--cameras", "2", "--size", "160x120"]);
        arguments.extend(if is_said { &[][..] } else { &["--duration", "1"] });
    }
    let output = trial.command(&arguments).envs(SHORT).output().unwrap();
    // Who stands for a second says nothing of clocks.
    let is_unknown = arguments[0] == "sync" && output.status.code() == Some(4);
    assert!(output.status.success() || is_unknown, "{line}\n{}", trial.printed(&output));
    String::from_utf8(output.stdout).unwrap()
}

/// Runs a page. The first words of the lines that it shows must be printed.
fn run_page(path: &str) {
    let page = read(path);
    let trial = folder(&page);
    let (mut printed, mut commands) = (String::new(), 0);
    for (language, lines) in blocks(&page) {
        match language {
            "sh" => {
                let joined = lines.join("\n").replace("\\\n", "");
                let own = joined.lines().filter(|line| line.starts_with("sinew "));
                let answers: Vec<String> = own.map(|line| run(&trial, line)).collect();
                commands += answers.len();
                printed = answers.concat();
            }
            "text" if !printed.is_empty() => {
                for word in lines.iter().filter_map(|line| line.split_whitespace().next()) {
                    let found = printed.lines().any(|line| line.split_whitespace().next() == Some(word));
                    assert!(found, "{path} shows a line `{word} …`, the program printed\n{printed}");
                }
                printed.clear();
            }
            "toml" if lines.first() == Some(&"# sinew.toml") => {
                fs::write(trial.path("sinew.toml"), lines.join("\n")).unwrap();
            }
            _ => {}
        }
    }
    assert!(commands > 0, "{path} has no command");
}

#[test]
fn the_readme_runs() {
    run_page("README.md");
}

#[test]
fn many_trials_run() {
    run_page("docs/guide/batch.md");
}

#[test]
fn a_first_recording_runs() {
    run_page("docs/guide/first-recording.md");
}

#[test]
fn an_own_recording_runs() {
    run_page("docs/guide/own-recording.md");
}

#[test]
fn cameras_run() {
    run_page("docs/guide/cameras.md");
}

#[test]
fn live_tracking_runs() {
    run_page("docs/guide/live.md");
}

#[test]
fn silhouettes_run() {
    run_page("docs/guide/silhouettes.md");
}

#[test]
fn motion_models_run() {
    run_page("docs/guide/motion-models.md");
}

#[test]
fn results_run() {
    run_page("docs/guide/results.md");
}

#[test]
fn warnings_run() {
    run_page("docs/guide/warnings.md");
}

#[test]
fn every_page_of_the_guide_has_a_test() {
    let pages = fs::read_dir(root().join("docs/guide")).unwrap().map(|entry| entry.unwrap().file_name());
    // The page of Python is run by the package's own tests.
    let mut pages: Vec<String> =
        pages.map(|name| name.into_string().unwrap()).filter(|name| name != "python.md").collect();
    pages.sort();
    assert_eq!(pages, PAGES.map(|name| format!("{name}.md")));
}

/// Text of all Rust files below a folder.
fn sources(folder: &Path, text: &mut String) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, text);
        } else {
            text.push_str(&fs::read_to_string(&path).unwrap_or_default());
        }
    }
}

/// What the page of warnings quotes is what the program says.
#[test]
fn quoted_warnings_match_the_program() {
    let mut program = String::new();
    ["formats", "input", "setup", "angles", "results", "analysis", "cli"]
        .map(|name| format!("sinew-{name}"))
        .iter()
        .chain([&"sinew".to_owned()])
        .for_each(|name| sources(&root().join("crates").join(name).join("src"), &mut program));
    let page = read("docs/guide/warnings.md");
    let says = page
        .lines()
        .skip_while(|line| !line.starts_with("| it says"))
        .take_while(|line| !line.starts_with("## Errors"));
    let quoted: Vec<&str> = says.filter_map(|line| line.strip_prefix("| ")?.split(" |").next()).collect();
    // Flags are made out of the names of settings.
    let parts = quoted.iter().filter(|cell| **cell != "it says").flat_map(|cell| cell.split('…'));
    let parts: Vec<&str> = parts.flat_map(|part| part.split("`--fps`")).map(str::trim).collect();
    assert!(parts.len() > 20, "{parts:?}");
    for part in parts.iter().filter(|part| !part.is_empty()) {
        assert!(program.contains(part), "no message of the program has `{part}`");
    }
}
