//! This process: its threads, its ranks, and how it is ended from outside.

pub(crate) mod interrupt;
pub(crate) mod last_words;
pub(crate) mod ranks;

use crate::error::Failure;

/// Threads for one case; as many as cores if no number is given.
pub(crate) fn pool(threads: Option<usize>) -> Result<rayon::ThreadPool, Failure> {
    // None is told by zero.
    Ok(rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build()?)
}
