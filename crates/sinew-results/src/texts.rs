//! Texts of a run that stand in its result folder as they are.

/// Texts that stand in the folder as they are.
#[derive(Clone, Debug, Default)]
pub struct Texts {
    /// `config.toml`.
    pub config_toml: String,
    /// Settings with their origins, for the summary.
    pub settings: serde_json::Value,
    /// Hash of the settings that matter for the numbers.
    pub settings_hash: String,
}
