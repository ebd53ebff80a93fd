//! Time that a thread spends on a processor, which other work on the machine does not lengthen.

/// Seconds of this thread on a processor so far; not a number where the system does not say.
pub(crate) fn thread_seconds() -> f64 {
    let nanoseconds = std::fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
    nanoseconds.map_or(f64::NAN, |nanoseconds| 1e-9 * nanoseconds)
}
