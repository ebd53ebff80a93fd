//! The tables.

use super::found::Found;
use super::scene::{Scene, Sizes, Wrong};
use crate::support::table::{header, percent, row};
use sinew::body::standard::EVALUATION_JOINTS;
use sinew_tests::evaluation::ranks::{AllUniform, LEVELS};

fn levels() -> String {
    LEVELS.map(|level| format!("{:.0} %", 100.0 * level)).join(" | ")
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
    found.pooled().into_iter().map(|share| percent(share, 1)).collect::<Vec<_>>().join(" | ")
}

/// Coverage of each joint in a scene.
fn joints(text: &mut String, scene: &Scene, found: &Found) {
    let [method, cameras, sizes, keypoints] = named(scene);
    let title = format!("{method}, {cameras} cameras, sizes {sizes}, keypoints {keypoints}");
    *text += &format!("\n{title}; {} series:\n\n{}", found.series, header(&format!("| joint | {} |", levels())));
    row!(*text, "all | {}", pooled(found));
    for (j, joint) in EVALUATION_JOINTS.iter().enumerate() {
        let cells: Vec<String> = (0..LEVELS.len()).map(|l| percent(found.joint(l, j), 1)).collect();
        row!(*text, "{joint} | {}", cells.join(" | "));
    }
}

/// Shapes of the ranks of scenes, and of single degrees of freedom where they are known.
fn ranks(text: &mut String, ranked: &[&(Scene, Found)], series: &[(Scene, Found)]) {
    *text += "\n";
    *text +=
        &header("| method | keypoints | series | bias | width | joints: p, (below 0.05) | state: p, (below 0.05) |");
    for (scene, found) in ranked {
        let [method, _, _, keypoints] = named(scene);
        let shape = found.shape();
        let [joints, state] = [found.uniform_points(), found.uniform_state()].map(uniform);
        let (series, bias, width) = (found.series, shape.bias, shape.width);
        row!(*text, "{method} | {keypoints} | {series} | {bias:+.3} | {width:.3} | {joints} | {state}");
    }
    for (scene, found) in series.iter().filter(|(_, found)| !found.state().is_empty()) {
        let [method, _, _, keypoints] = named(scene);
        let title = format!("{method}, keypoints {keypoints}, ranks of each degree of freedom");
        *text += &format!("\n{title}; {} series:\n\n{}\n", found.series, super::coordinates::table(found));
    }
}

/// Coverages of people whose keypoints are as assumed, or otherwise.
fn coverages(text: &mut String, series: &[(Scene, Found)], as_assumed: bool) {
    let [title, first] = if as_assumed {
        ["Noise as assumed", "method, cameras, sizes"]
    } else {
        ["Otherwise; hmc, sizes of the set-up", "keypoints, cameras"]
    };
    let last = "mean distance from promise | in files, 90 % | half-width, mm | error, mm | R-hat above 1.05 |";
    *text += &format!("\n{title}:\n\n{}", header(&format!("| {first} | series | {} | {last}", levels())));
    for (scene, found) in series {
        let Scene::Person { wrong, .. } = scene else { continue };
        if (*wrong == Wrong::Right) != as_assumed {
            continue;
        }
        let [method, cameras, sizes, keypoints] = named(scene);
        let name = if as_assumed { format!("{method}, {cameras}, {sizes}") } else { format!("{keypoints}; {cameras}") };
        row!(
            *text,
            "{name} | {} | {} | {:.1} | {} | {:.1} | {:.1} | {:.0} %",
            found.series,
            pooled(found),
            100.0 * found.calibration_error(),
            percent(found.in_files(), 1),
            found.half_width_mm(),
            found.error_mm(),
            100.0 * found.disagreeing()
        );
    }
}

/// How many recordings have warnings.
fn warnings(text: &mut String, recordings: &[(Scene, Found)]) {
    *text += "\nWarnings, recordings of at most 120 frames:\n\n";
    *text += &header("| cameras | sizes | keypoints | coverage, 90 % | recordings with a warning | of which |");
    for (scene, found) in recordings {
        let [_, cameras, sizes, keypoints] = named(scene);
        let (kinds, any) = found.warned();
        let kinds: Vec<String> = kinds.into_iter().map(|(kind, count)| format!("{kind} {count}")).collect();
        let kinds = if kinds.is_empty() { "–".into() } else { kinds.join(", ") };
        let share = percent(found.pooled_at(0.9), 1);
        row!(*text, "{cameras} | {sizes} | {keypoints} | {share} | {any} of {} | {kinds}", found.series);
    }
    let expected = recordings.iter().filter(|(scene, _)| is_right(scene));
    let [alarms, of] = expected.fold([0, 0], |[a, n], (_, found)| [a + found.warned().1, n + found.series]);
    *text += &format!("\n{alarms} of {of} recordings whose noise and sizes are as assumed have a warning.\n");
}

/// Whether nothing about a scene is wrong.
fn is_right(scene: &Scene) -> bool {
    matches!(scene, Scene::Person { sizes: Sizes::Known | Sizes::Fitted, wrong: Wrong::Right, .. })
}
