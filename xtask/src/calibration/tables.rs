//! The tables, for docs and for programs.

use super::Scene;
use super::found::{Found, Uniform};
use super::scene::{Sizes, Wrong};
use sinew::body::standard::EVALUATION_JOINTS;
use sinew_tests::evaluation::ranks::LEVELS;

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

fn uniform(found: Option<Uniform>) -> String {
    match found {
        None => "–".into(),
        Some(Uniform { coordinates, p, below }) => format!("{p:.2e} ({below} of {coordinates})"),
    }
}

/// All tables; Markdown.
pub(super) fn markdown(series: &[(Scene, Found)], recordings: &[(Scene, Found)], ranked: &[Scene]) -> String {
    let mut text = String::new();
    let mut line = |row: String| text.extend([row.as_str(), "\n"]);
    let ranks = |scene: &Scene| ranked.contains(scene);
    for (scene, found) in series.iter().filter(|(scene, _)| ranks(scene)) {
        let [method, cameras, sizes, keypoints] = named(scene);
        line(format!(
            "\n{method}, {cameras} cameras, sizes {sizes}, keypoints {keypoints}; {} series:\n",
            found.series
        ));
        line(format!("| joint |{}", levels()));
        line(format!("|---|{}", "---|".repeat(LEVELS.len())));
        let pooled: String = found.pooled().into_iter().map(|share| format!(" {} |", percent(share))).collect();
        line(format!("| all |{pooled}"));
        for (j, joint) in EVALUATION_JOINTS.iter().enumerate() {
            let cells: String = (0..LEVELS.len()).map(|l| format!(" {} |", percent(found.joint(l, j)))).collect();
            line(format!("| {joint} |{cells}"));
        }
    }
    line("\n| method | keypoints | series | bias | width | joints: p, (below 0.05) | state: p, (below 0.05) |".into());
    line("|---|---|---|---|---|---|---|".into());
    for (scene, found) in series.iter().filter(|(scene, _)| ranks(scene)) {
        let [method, _, _, keypoints] = named(scene);
        let shape = found.shape();
        line(format!(
            "| {method} | {keypoints} | {} | {:+.3} | {:.3} | {} | {} |",
            found.series,
            shape.bias,
            shape.width,
            uniform(found.uniform_points()),
            uniform(found.uniform_state())
        ));
    }
    for (scene, found) in series.iter().filter(|(_, found)| !found.state().is_empty()) {
        let [method, _, _, keypoints] = named(scene);
        line(format!("\n{method}, keypoints {keypoints}, ranks of each degree of freedom; {} series:\n", found.series));
        line(super::coordinates::table(found));
    }
    for (title, first, wanted) in [
        ("Noise as assumed", "method, cameras, sizes", true),
        ("Otherwise; hmc, four cameras, sizes of the set-up", "keypoints", false),
    ] {
        line(format!("\n{title}:\n"));
        line(format!(
            "| {first} | series |{} mean distance from promise | in files, 90 % | error, mm | R-hat above 1.05 |",
            levels()
        ));
        line(format!("|---|---|{}---|---|---|---|", "---|".repeat(LEVELS.len())));
        for (scene, found) in series {
            let Scene::Person { wrong, .. } = scene else { continue };
            if (*wrong == Wrong::Right) != wanted {
                continue;
            }
            let [method, cameras, sizes, keypoints] = named(scene);
            let name = if wanted { format!("{method}, {cameras}, {sizes}") } else { keypoints };
            let pooled: String = found.pooled().into_iter().map(|share| format!(" {} |", percent(share))).collect();
            line(format!(
                "| {name} | {} |{pooled} {:.1} | {} | {:.1} | {:.0} % |",
                found.series,
                100.0 * found.calibration_error(),
                percent(found.in_files()),
                found.error_mm(),
                100.0 * found.disagreeing()
            ));
        }
    }
    line("\nWarnings, recordings of at most 120 frames:\n".into());
    line("| cameras | sizes | keypoints | coverage, 90 % | recordings with a warning | of which |".into());
    line("|---|---|---|---|---|---|".into());
    for (scene, found) in recordings {
        let [_, cameras, sizes, keypoints] = named(scene);
        let (kinds, any) = found.warned();
        let kinds: Vec<String> = kinds.into_iter().map(|(kind, count)| format!("{kind} {count}")).collect();
        let kinds = if kinds.is_empty() { "–".into() } else { kinds.join(", ") };
        let share = percent(found.pooled_at(0.9));
        line(format!("| {cameras} | {sizes} | {keypoints} | {share} | {any} of {} | {kinds} |", found.series));
    }
    let expected = recordings.iter().filter(|(scene, _)| is_right(scene));
    let [alarms, of] = expected.fold([0, 0], |[a, n], (_, found)| [a + found.warned().1, n + found.series]);
    line(format!("\n{alarms} of {of} recordings whose noise and sizes are as assumed have a warning."));
    text
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
