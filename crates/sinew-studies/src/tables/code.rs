//! Tables that derive from lists in the code: settings, methods, layouts.

use crate::support::table::{header, row};
use sinew::config::setting::{Setting, SettingKind};
use sinew::config::table::settings;
use sinew::config::value::to_text;
use sinew::formats::layout;
use sinew::methods::{About, Gives, METHODS};

/// The table of that name; Markdown.
pub(super) fn table(name: &str) -> Option<String> {
    match name.split_once(' ') {
        None if name == "methods" => Some(methods()),
        None if name == "layouts" => Some(layouts()),
        Some(("settings", group)) => group_table(group),
        _ => None,
    }
}

fn group_table(group: &str) -> Option<String> {
    let mut table = header("| setting | values | default | meaning |");
    let chosen: Vec<&Setting> = settings().iter().filter(|setting| setting.group == group).collect();
    for setting in &chosen {
        let default = setting.default.as_ref().map(|value| format!("`{}`", to_text(value))).unwrap_or_default();
        row!(table, "`{}` | {} | {default} | {}", setting.key, values(setting), escaped(setting.help));
    }
    (!chosen.is_empty()).then_some(table)
}

/// Placeholders in angle brackets would be taken for HTML.
fn escaped(help: &str) -> String {
    help.replace('<', "\\<").replace('|', "\\|")
}

fn values(setting: &Setting) -> String {
    match setting.kind {
        SettingKind::Path => "path".into(),
        SettingKind::NameOrPath => "name or path".into(),
        SettingKind::Text => "text".into(),
        SettingKind::Choice(names) => names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", "),
        SettingKind::Count(least, u64::MAX) => format!("whole, from {least}"),
        SettingKind::Count(least, most) => format!("{least} to {most}"),
        SettingKind::Number { least, excluded, most } => {
            let above = if excluded { "above" } else { "from" };
            if most.is_finite() { format!("{above} {least} to {most}") } else { format!("{above} {least}") }
        }
        SettingKind::Flag => "`true`, `false`".into(),
        SettingKind::Frames => "`A..B`, B not included".into(),
        SettingKind::Names => "names, `a,b,c`".into(),
        SettingKind::Lags => "frames by camera, `a=1,b=-2`".into(),
        SettingKind::Direction => "`auto`, or three numbers `X,Y,Z`".into(),
    }
}

fn methods() -> String {
    let mut table = header("| method | what | observes | gives | particles | score of masks | settings of its own |");
    for about in METHODS {
        let About { name, help, needs_gradients, needs_parts, score, particles, settings, .. } = about;
        let observes = match (needs_gradients, needs_parts) {
            (true, _) => "keypoints; masks beside them",
            (false, true) => "keypoints, masks, both; part by part",
            (false, false) => "keypoints, masks, both",
        };
        let gives = match about.gives {
            Gives::Chains => "posterior, by chains",
            Gives::Particles => "posterior, by weighted particles",
            Gives::Search => "best states, no posterior",
        };
        let particles = particles.map_or_else(|| "–".into(), |count| count().to_string());
        let score = match (needs_gradients, about.score_beside_keypoints) {
            (true, _) => "limbs inside the contour".into(),
            (_, beside) if beside == *score => format!("`{}`", score.name()),
            (_, beside) => format!("`{}`, beside keypoints `{}`", score.name(), beside.name()),
        };
        let own: Vec<String> = settings.iter().map(|setting| format!("`{}`", setting.row().key)).collect();
        let own = if own.is_empty() { "–".into() } else { own.join(", ") };
        row!(table, "`{name}` | {help} | {observes} | {gives} | {particles} | {score} | {own}");
    }
    table
}

fn layouts() -> String {
    let mut table = header("| layout | numbers a person | named points |");
    for name in layout::names() {
        if let Ok(layout) = layout::find(name) {
            row!(table, "`{name}` | {} | {}", layout.numbers(), layout.points.iter().flatten().count());
        }
    }
    table
}
