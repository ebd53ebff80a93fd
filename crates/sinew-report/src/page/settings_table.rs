//! Versions, hashes and settings of a run, as tables.

use super::html::{escaped, table};
use serde_json::Value;

/// Keys of the summary that are shown, by their names on the page.
const SHOWN: [(&str, &str); 7] = [
    ("sinew", "sinew_version"),
    ("method", "method"),
    ("kind", "kind"),
    ("seed", "seed"),
    ("instruction set", "isa"),
    ("degrees of freedom", "degrees_of_freedom"),
    ("hash of the settings", "settings_hash"),
];

/// What was run, the settings that were chosen, and behind a click the others.
pub(super) fn settings_table(summary: &Value) -> String {
    let mut rows: Vec<Vec<String>> =
        SHOWN.iter().map(|(name, key)| vec![(*name).to_owned(), plain(&summary[key])]).collect();
    let hashes = summary["input_hashes"].as_object().into_iter().flatten();
    rows.extend(hashes.map(|(name, hash)| vec![format!("hash of {}", escaped(name)), plain(hash)]));
    let settings = summary["settings"].as_object().into_iter().flatten();
    let (chosen, usual): (Vec<_>, Vec<_>) = settings.partition(|(_, setting)| setting["origin"] != "default");
    let listed = |caption: &str, settings: Vec<(&String, &Value)>| match settings.is_empty() {
        true => String::new(),
        false => table(caption, &["setting", "value", "from"], &settings.into_iter().map(row).collect::<Vec<_>>()),
    };
    let [chosen, usual] = [listed("Settings that were chosen", chosen), listed("Settings as they usually are", usual)];
    format!("{}{chosen}<details><summary>All other settings</summary>\n{usual}</details>\n", table("Run", &[], &rows))
}

fn row((key, setting): (&String, &Value)) -> Vec<String> {
    vec![format!("<code>{}</code>", escaped(key)), plain(&setting["value"]), plain(&setting["origin"])]
}

fn plain(value: &Value) -> String {
    escaped(&value.as_str().map_or_else(|| value.to_string(), str::to_owned))
}
