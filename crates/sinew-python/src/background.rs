//! Work without the interpreter's lock: other threads of Python run meanwhile, and Ctrl-C is seen.

use crate::failure::Failure;
use pyo3::prelude::*;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

/// How often signals are looked at.
const LOOK: Duration = Duration::from_millis(50);

fn words(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "a panic".into())
}

/// Short work, without the lock. A panic is a failure like others.
pub(crate) fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> Result<T, Failure> + Send) -> PyResult<T> {
    let done = py.detach(|| catch_unwind(AssertUnwindSafe(work)));
    Ok(done.unwrap_or_else(|panic| Err(Failure::bug(words(&*panic))))?)
}

/// Work that may take long, on a thread of its own. On Ctrl-C `stop` is raised, and once the work has ended `KeyboardInterrupt` is.
///
/// `meanwhile` is called now and then under the lock; what it raises stops the work like a signal.
pub(crate) fn interruptible<T: Send>(
    py: Python<'_>,
    stop: &Arc<AtomicBool>,
    mut meanwhile: impl FnMut(Python<'_>) -> PyResult<()>,
    work: impl FnOnce() -> Result<T, Failure> + Send,
) -> PyResult<T> {
    let waiting = thread::current();
    thread::scope(|scope| {
        let worker = scope.spawn(move || {
            let done = catch_unwind(AssertUnwindSafe(work));
            waiting.unpark();
            done
        });
        let mut signal = None;
        while !worker.is_finished() {
            py.detach(|| thread::park_timeout(LOOK));
            let looked = py.check_signals().and_then(|()| meanwhile(py));
            if let Err(error) = looked {
                stop.store(true, Ordering::Relaxed);
                signal.get_or_insert(error);
            }
        }
        let done = py.detach(|| worker.join()).and_then(|done| done);
        match (signal, done) {
            (Some(signal), _) => Err(signal),
            (None, Ok(done)) => meanwhile(py).and(Ok(done?)),
            (None, Err(panic)) => Err(Failure::bug(words(&*panic)).into()),
        }
    })
}
