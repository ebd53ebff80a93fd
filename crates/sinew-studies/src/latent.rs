//! Latent models on data that others have published: missing limbs, and the flow of oil.

pub(crate) mod missing_limbs;
pub(crate) mod oil_flow;
