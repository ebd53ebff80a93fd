//! A name that belongs to no body.

/// A name that is no body's.
#[derive(Debug, thiserror::Error)]
#[error("no body `{name}`; known: {}{}", known.join(", "), nearest.map(|name| format!("; did you mean `{name}`?")).unwrap_or_default())]
#[non_exhaustive]
pub struct UnknownBody {
    /// Name given.
    pub name: String,
    /// Names of bodies.
    pub known: &'static [&'static str],
    /// Name that was likely meant.
    pub nearest: Option<&'static str>,
}
