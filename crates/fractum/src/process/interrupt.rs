//! The wish of the user that simulations end.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Whether simulations are asked to end.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Simulations of this process that have a state to save.
static UNDER_WAY: AtomicUsize = AtomicUsize::new(0);

/// Asks all simulations of this process to save their state and end, as Ctrl-C does.
///
/// Returns whether some simulation will do so: where none is under way, or they have been asked before, a program that
/// got a signal may end at once. Results are written under temporary names until they are whole.
pub fn interrupt() -> bool {
    !INTERRUPTED.swap(true, Ordering::Relaxed) && UNDER_WAY.load(Ordering::Relaxed) > 0
}

/// Whether simulations are asked to end.
pub fn is_interrupted() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}

/// Forgets that simulations were asked to end, once those that were under way have: others may start.
pub fn clear_interrupt() {
    INTERRUPTED.store(false, Ordering::Relaxed);
}

/// A simulation that has a state to save, as long as this lives.
pub(crate) struct UnderWay(());

impl UnderWay {
    pub(crate) fn new() -> Self {
        UNDER_WAY.fetch_add(1, Ordering::Relaxed);
        UnderWay(())
    }
}

impl Drop for UnderWay {
    fn drop(&mut self) {
        UNDER_WAY.fetch_sub(1, Ordering::Relaxed);
    }
}
