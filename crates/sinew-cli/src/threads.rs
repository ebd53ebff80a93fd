//! A pool of the threads that the settings ask for.

use super::error::Error;
use sinew::config::TrackConfig;

/// Runs in a pool of the requested threads.
pub(crate) fn with_threads<T: Send, E: Send>(
    config: &TrackConfig,
    run: impl FnOnce() -> Result<T, E> + Send,
) -> Result<T, Error>
where
    Error: From<E>,
{
    let granted = std::thread::available_parallelism().map_or(1, |n| n.get());
    let pool = rayon::ThreadPoolBuilder::new().num_threads(config.threads.unwrap_or(granted)).build();
    Ok(pool.map_err(Error::Threads)?.install(run)?)
}
