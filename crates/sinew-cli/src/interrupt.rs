//! Ctrl-C and SIGTERM: the first finishes what is at hand, the second ends at once.

use std::io::Write as _;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

/// Exit code of a second interrupt: nothing was saved since the first.
const AT_ONCE: i32 = 130;

/// The flag of the process: a handler can be set once, and a command may make several runs.
static FLAG: OnceLock<Arc<AtomicBool>> = OnceLock::new();

/// A flag that the first interrupt sets; `unit` is what is finished before the end.
pub(crate) fn flag(unit: &'static str) -> Arc<AtomicBool> {
    let set_up = || {
        let asked = Arc::new(AtomicBool::new(false));
        let seen = Arc::clone(&asked);
        // Where no handler can be set, an interrupt ends the program as usual.
        let _ = ctrlc::set_handler(move || {
            if seen.swap(true, Ordering::SeqCst) {
                std::process::exit(AT_ONCE);
            }
            let _ = writeln!(std::io::stderr(), "interrupted: finishing {unit}; once more to end at once");
        });
        asked
    };
    Arc::clone(FLAG.get_or_init(set_up))
}
