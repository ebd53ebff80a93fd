//! The paper's claims CF1–CF10, judged by criteria that were fixed before any run.
//!
//! Costs are counted in likelihood evaluations, a gradient as c_g of them (measured); wall times on one thread stand beside them in the files ([`super::tables`]).

use super::multi_claims::multi_claims;
use super::single_claims::single_claims;
use super::study::Study;
use crate::papers::claim::Claim;
use crate::support::outcome::Outcome;
use crate::support::store::Store;

/// Judges what was run.
pub(super) fn judge(study: &Study, store: &Store, single: bool, multi: bool) -> Outcome<Vec<Claim>> {
    let mut claims = vec![];
    if single {
        single_claims(study, store, &mut claims)?;
    }
    if multi {
        multi_claims(study, store, &mut claims)?;
    }
    claims.sort_by_key(|claim| claim.id[2..].parse::<u32>().unwrap_or(u32::MAX));
    Ok(claims)
}
