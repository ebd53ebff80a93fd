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

/// What was run, then every setting, chosen ones first.
pub(super) fn settings_table(summary: &Value) -> String {
    let mut rows: Vec<Vec<String>> = SHOWN.iter().map(|(name, key)| vec![(*name).to_owned(), plain(&summary[key])]).collect();
    let hashes = summary["input_hashes"].as_object().into_iter().flatten();
    rows.extend(hashes.map(|(name, hash)| vec![format!("hash of {}", escaped(name)), plain(hash)]));
    let settings = summary["settings"].as_object().into_iter().flatten();
    let (chosen, usual): (Vec<_>, Vec<_>) = settings.partition(|(_, setting)| setting["origin"] != "default");
    let row = |(key, setting): (&String, &Value)| {
        vec![format!("<code>{}</code>", escaped(key)), plain(&setting["value"]), plain(&setting["origin"])]
    };
    let rest: Vec<Vec<String>> = chosen.into_iter().chain(usual).map(row).collect();
    table("Run", &[], &rows) + &table("Settings", &["setting", "value", "from"], &rest)
}

fn plain(value: &Value) -> String {
    escaped(&value.as_str().map_or_else(|| value.to_string(), str::to_owned))
}
