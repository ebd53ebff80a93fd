//! Values that cells share, made by the first that needs them.

use crate::support::outcome::Outcome;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Values that the first cell makes which needs them.
pub(super) type Shared<T> = Mutex<BTreeMap<String, Arc<OnceLock<T>>>>;

/// The value of that name, made where it is not there yet.
pub(super) fn shared<T>(all: &Shared<T>, name: &str, make: impl FnOnce() -> Outcome<T>) -> Outcome<Arc<OnceLock<T>>> {
    let place = Arc::clone(all.lock().unwrap_or_else(PoisonError::into_inner).entry(name.into()).or_default());
    if place.get().is_none() {
        // Another cell may have made the same in the meantime.
        let _ = place.set(make()?);
    }
    Ok(place)
}
