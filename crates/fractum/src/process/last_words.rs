//! What is said where several processes are told to end and cannot save the state, since one of them has died or the time is too short.

use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::Duration;

use fractum_output::checkpoint;

use crate::process::interrupt::is_interrupted;
use crate::tell;

/// How often to see whether a signal has come.
const LOOK: Duration = Duration::from_millis(100);
/// Time for saving the state and ending by oneself. Open MPI kills a second after the signal.
const WAIT: Duration = Duration::from_millis(500);
/// What the processes that do not write wait beyond that.
const WAIT_FOR_LEADER: Duration = Duration::from_millis(200);

/// Speaks as long as it lives, if a signal comes and nothing follows.
pub(crate) struct LastWords {
    /// The thread ends with it.
    _alive: Sender<()>,
}

/// A run as the thread that may have the last word knows it.
struct Watch {
    /// Results folder of the run.
    results: PathBuf,
    /// The command that goes on.
    command: String,
    /// Whether this process writes the results.
    leads: bool,
    over: Receiver<()>,
}

impl LastWords {
    pub(crate) fn new(results: &Path, command: String, leads: bool) -> Self {
        let (alive, over) = channel();
        let watch = Watch { results: results.to_owned(), command, leads, over };
        thread::spawn(move || watch.speak_at_the_end());
        LastWords { _alive: alive }
    }
}

impl Watch {
    fn speak_at_the_end(&self) {
        while self.goes_on_for(LOOK) {
            if !is_interrupted() {
                continue;
            }
            let wait = if self.leads { WAIT } else { WAIT + WAIT_FOR_LEADER };
            if self.goes_on_for(wait)
                && let Some(_speaks) = self.right_to_speak()
            {
                tell!("{}", last_words(&self.results, &self.command));
                // Kept to the end, so that no other process says it again.
                while self.goes_on_for(LOOK) {}
            }
            return;
        }
    }

    /// Whether the run is still under way after that time.
    fn goes_on_for(&self, time: Duration) -> bool {
        self.over.recv_timeout(time) == Err(RecvTimeoutError::Timeout)
    }

    /// The process that writes has it, and once it has died the first that locks its log.
    fn right_to_speak(&self) -> Option<Option<File>> {
        if self.leads {
            return Some(None);
        }
        let log = File::options().append(true).open(self.results.join("run.log")).ok()?;
        match log.try_lock() {
            Ok(()) => Some(Some(log)),
            Err(TryLockError::WouldBlock | TryLockError::Error(_)) => None,
        }
    }
}

fn last_words(results: &Path, command: &str) -> String {
    let why = "the processes are ended from outside, or since one of them has died or failed";
    let on_any = "under mpirun with any number of processes, or without it";
    match checkpoint::newest(&results.join("checkpoint")) {
        Some((step, file)) => {
            format!("{why}; last saved state: step {step} in {}; go on with: {command}, {on_any}", file.display())
        }
        None => format!("{why}; no state was saved, start again with --overwrite"),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn last_words_name_the_newest_state_and_how_to_go_on() {
        let folder = tempfile::tempdir().unwrap();
        let said = last_words(folder.path(), "fractum run case.toml --resume");
        assert!(said.contains("no state was saved"), "{said}");
        fs::create_dir(folder.path().join("checkpoint")).unwrap();
        for step in ["000000040", "000000200"] {
            fs::write(folder.path().join(format!("checkpoint/state-{step}.fck")), "").unwrap();
        }
        let said = last_words(folder.path(), "fractum run case.toml --resume");
        assert!(said.contains("step 200 in ") && said.contains("go on with: fractum run case.toml --resume"), "{said}");
    }

    #[test]
    fn others_speak_for_a_process_that_has_died_and_only_one_of_them() {
        let folder = tempfile::tempdir().unwrap();
        let watch = |leads| {
            let (_, over) = channel();
            Watch { results: folder.path().to_owned(), command: String::new(), leads, over }
        };
        assert!(watch(true).right_to_speak().is_some());
        let path = folder.path().join("run.log");
        let leader = fractum_output::log::RunLog::create(&path).unwrap();
        assert!(watch(false).right_to_speak().is_none());
        drop(leader);
        let first = watch(false).right_to_speak();
        assert!(first.is_some() && watch(false).right_to_speak().is_none());
    }
}
