//! The tables, for docs and for programs.

use super::found::Found;
use super::scene::{Scene, Sizes, Wrong};
use sinew::body::standard::EVALUATION_JOINTS;
use sinew_tests::evaluation::ranks::{AllUniform, LEVELS};

fn percent([share, error]: [f64; 2]) -> String {
    format!("{:.1} ± {:.1}", 100.0 * share, 100.0 * error)
}

fn levels() -> String {
    LEVELS.iter().map(|level| format!(" {:.0} % |", 100.0 * level)).collect()
}

/// What a scene is, for people: method, cameras, sizes, keypoints.
fn named(scene: &Scene) -> [String; 4] {
    match scene {
        Scene::Person { cameras, tracker, sizes, wrong } => {
            [tracker.name(), cameras.to_string(), sizes.name().into(), wrong.name()]
        }
        Scene::OwnModel { tracker } => {
            [tracker.name(), "4".into(), "known".into(), "drawn from the model, motion too".into()]
        }
    }
}

fn uniform(found: Option<AllUniform>) -> String {
    match found {
        None => "–".into(),
        Some(AllUniform { coordinates, p, below }) => format!("{p:.2e} ({below} of {coordinates})"),
    }
}

/// Adds a line to a text.
fn line(text: &mut String, row: &str) {
    text.extend([row, "\n"]);
}

/// All tables; Markdown.
pub(super) fn markdown(series: &[(Scene, Found)], recordings: &[(Scene, Found)], ranked: &[Scene]) -> String {
    let mut text = String::new();
    let ranked: Vec<&(Scene, Found)> = series.iter().filter(|(scene, _)| ranked.contains(scene)).collect();
    ranked.iter().for_each(|(scene, found)| joints(&mut text, scene, found));
    ranks(&mut text, &ranked, series);
    coverages(&mut text, series, true);
    coverages(&mut text, series, false);
    warnings(&mut text, recordings);
    text
}

fn pooled(found: &Found) -> String {
    found.pooled().into_iter().map(|share| format!(" {} |", percent(share))).collect()
}

/// Coverage of each joint in a scene.
fn joints(text: &mut String, scene: &Scene, found: &Found) {
    let [method, cameras, sizes, keypoints] = named(scene);
    let title = format!("{method}, {cameras} cameras, sizes {sizes}, keypoints {keypoints}");
    line(text, &format!("\n{title}; {} series:\n", found.series));
    line(text, &format!("| joint |{}", levels()));
    line(text, &format!("|---|{}", "---|".repeat(LEVELS.len())));
    line(text, &format!("| all |{}", pooled(found)));
    for (j, joint) in EVALUATION_JOINTS.iter().enumerate() {
        let cells: String = (0..LEVELS.len()).map(|l| format!(" {} |", percent(found.joint(l, j)))).collect();
        line(text, &format!("| {joint} |{cells}"));
    }
}

/// Shapes of the ranks of scenes, and of single degrees of freedom where they are known.
fn ranks(text: &mut String, ranked: &[&(Scene, Found)], series: &[(Scene, Found)]) {
    line(text, "\n| method | keypoints | series | bias | width | joints: p, (below 0.05) | state: p, (below 0.05) |");
    line(text, "|---|---|---|---|---|---|---|");
    for (scene, found) in ranked {
        let [method, _, _, keypoints] = named(scene);
        let shape = found.shape();
        let row = format!(
            "| {method} | {keypoints} | {} | {:+.3} | {:.3} | {} | {} |",
            found.series,
            shape.bias,
            shape.width,
            uniform(found.uniform_points()),
            uniform(found.uniform_state())
        );
        line(text, &row);
    }
    for (scene, found) in series.iter().filter(|(_, found)| !found.state().is_empty()) {
        let [method, _, _, keypoints] = named(scene);
        let title = format!("{method}, keypoints {keypoints}, ranks of each degree of freedom");
        line(text, &format!("\n{title}; {} series:\n", found.series));
        line(text, &super::coordinates::table(found));
    }
}

/// Coverages of people whose keypoints are as assumed, or otherwise.
fn coverages(text: &mut String, series: &[(Scene, Found)], as_assumed: bool) {
    let [title, first] = if as_assumed {
        ["Noise as assumed", "method, cameras, sizes"]
    } else {
        ["Otherwise; hmc, sizes of the set-up", "keypoints, cameras"]
    };
    line(text, &format!("\n{title}:\n"));
    let last = "mean distance from promise | in files, 90 % | half-width, mm | error, mm | R-hat above 1.05 |";
    line(text, &format!("| {first} | series |{} {last}", levels()));
    line(text, &format!("|---|---|{}---|---|---|---|---|", "---|".repeat(LEVELS.len())));
    for (scene, found) in series {
        let Scene::Person { wrong, .. } = scene else { continue };
        if (*wrong == Wrong::Right) != as_assumed {
            continue;
        }
        let [method, cameras, sizes, keypoints] = named(scene);
        let name = if as_assumed { format!("{method}, {cameras}, {sizes}") } else { format!("{keypoints}; {cameras}") };
        let row = format!(
            "| {name} | {} |{} {:.1} | {} | {:.1} | {:.1} | {:.0} % |",
            found.series,
            pooled(found),
            100.0 * found.calibration_error(),
            percent(found.in_files()),
            found.half_width_mm(),
            found.error_mm(),
            100.0 * found.disagreeing()
        );
        line(text, &row);
    }
}

/// How many recordings have warnings.
fn warnings(text: &mut String, recordings: &[(Scene, Found)]) {
    line(text, "\nWarnings, recordings of at most 120 frames:\n");
    line(text, "| cameras | sizes | keypoints | coverage, 90 % | recordings with a warning | of which |");
    line(text, "|---|---|---|---|---|---|");
    for (scene, found) in recordings {
        let [_, cameras, sizes, keypoints] = named(scene);
        let (kinds, any) = found.warned();
        let kinds: Vec<String> = kinds.into_iter().map(|(kind, count)| format!("{kind} {count}")).collect();
        let kinds = if kinds.is_empty() { "–".into() } else { kinds.join(", ") };
        let share = percent(found.pooled_at(0.9));
        let row = format!("| {cameras} | {sizes} | {keypoints} | {share} | {any} of {} | {kinds} |", found.series);
        line(text, &row);
    }
    let expected = recordings.iter().filter(|(scene, _)| is_right(scene));
    let [alarms, of] = expected.fold([0, 0], |[a, n], (_, found)| [a + found.warned().1, n + found.series]);
    line(text, &format!("\n{alarms} of {of} recordings whose noise and sizes are as assumed have a warning."));
}

/// Whether nothing about a scene is wrong.
fn is_right(scene: &Scene) -> bool {
    matches!(scene, Scene::Person { sizes: Sizes::Known | Sizes::Fitted, wrong: Wrong::Right, .. })
}

/// Every coverage.
pub(super) fn csv(series: &[(Scene, Found)]) -> String {
    let mut text = String::from("method,cameras,sizes,keypoints,series,joint,level,coverage,standard_error\n");
    for (scene, found) in series {
        let start = format!("{},{}", named(scene).join(","), found.series);
        for (l, level) in LEVELS.iter().enumerate() {
            let [share, error] = found.pooled_at(*level);
            text += &format!("{start},all,{level},{share:.5},{error:.5}\n");
            for (j, joint) in EVALUATION_JOINTS.iter().enumerate() {
                let [share, error] = found.joint(l, j);
                text += &format!("{start},{joint},{level},{share:.5},{error:.5}\n");
            }
        }
    }
    text
}

/// Every histogram of ranks.
pub(super) fn ranks_csv(series: &[(Scene, Found)]) -> String {
    let mut text = String::from("method,cameras,sizes,keypoints,series,bin,relative_frequency,standard_error\n");
    for (scene, found) in series {
        for (bin, [share, error]) in found.histogram().into_iter().enumerate() {
            text += &format!("{},{},{bin},{share:.5},{error:.5}\n", named(scene).join(","), found.series);
        }
    }
    text
}
