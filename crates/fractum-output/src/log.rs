//! What a run tells while it goes: `run.log` for later, a progress line for now.

use std::fmt;
use std::fs::{File, TryLockError};
use std::io::{self, IsTerminal, Stderr, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use fractum_math::elementary::exp;

use crate::error::WriteError;
use crate::number::{instant_text, quantity, significant};

/// `run.log`: plain lines, appended as they come, under its final name from the start, so that it can be watched and
/// tells what happened if the run was killed.
///
/// It stays locked as long as it is open: no second run writes into the same folder.
#[derive(Debug)]
pub struct RunLog {
    path: PathBuf,
    file: File,
}

impl RunLog {
    /// Starts an empty log.
    ///
    /// # Errors
    /// [`WriteError`].
    pub fn create(path: &Path) -> Result<Self, WriteError> {
        let log = Self::resume(path)?;
        // Only once it is locked: the log of another run stays as it is.
        if log.file.metadata().is_ok_and(|file| file.len() > 0) {
            log.file.set_len(0).map_err(|error| WriteError::new(path, error))?;
        }
        Ok(log)
    }

    /// Goes on with the log of a run that is resumed; starts one if there is none.
    ///
    /// # Errors
    /// [`WriteError`].
    pub fn resume(path: &Path) -> Result<Self, WriteError> {
        let file = File::options().append(true).create(true).open(path).map_err(|e| WriteError::new(path, e))?;
        match file.try_lock() {
            // A file system without locks keeps nobody from running.
            Ok(()) => {}
            Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => {}
            Err(error) => return Err(WriteError::new(path, error.into())),
        }
        Ok(Self { path: path.to_path_buf(), file })
    }

    /// Adds a line; of a text with several lines, each.
    ///
    /// # Errors
    /// [`WriteError`].
    pub fn line(&mut self, text: impl fmt::Display) -> Result<(), WriteError> {
        self.file.write_all(format!("{text}\n").as_bytes()).map_err(|error| WriteError::new(&self.path, error))
    }
}

/// Where a run stands.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// Steps done.
    pub step: u64,
    /// Simulated time [s].
    pub time: f64,
    /// Simulated time at which the run ends [s].
    pub end: f64,
    /// Time step [s].
    pub dt: f64,
    /// Kinetic energy [J].
    pub kinetic: f64,
    /// Elastic energy [J].
    pub elastic: f64,
    /// Energy dissipated so far, by damage, friction, damping and removal [J].
    pub dissipated: f64,
    /// Imbalance of the energy ledger relative to the external work [-].
    pub balance_error: f64,
    /// Broken edges.
    pub broken_edges: u64,
    /// Broken bonds.
    pub broken_bonds: u64,
    /// Particles.
    pub particles: u64,
    /// The load, its largest absolute value so far, and their unit, where a probe measures one.
    pub load: Option<([f64; 2], &'static str)>,
    /// Whether the scene is at rest, so that `time` is a load factor.
    pub at_rest: bool,
}

impl Snapshot {
    /// What it says, the most wanted first: load, time and balance fit a line of 80 columns.
    fn words(&self) -> Vec<String> {
        let mut words = Vec::new();
        if let Some((load, unit)) = self.load {
            let [load, peak] = load.map(|load| quantity(load, unit));
            words.push(format!("load {load} (peak {peak})"));
        }
        let instant = instant_text(self.time, self.at_rest);
        words.push(if self.at_rest { instant } else { format!("t {instant}") });
        words.push(format!("balance {}", significant(self.balance_error, 2)));
        words.push(format!("step {}", self.step));
        let counts =
            [(self.broken_edges, "broken edges"), (self.broken_bonds, "broken bonds"), (self.particles, "particles")];
        words.extend(counts.iter().filter(|(count, _)| *count > 0).map(|(count, name)| format!("{count} {name}")));
        let energies = [("dissipated", self.dissipated), ("elastic", self.elastic), ("kinetic", self.kinetic)];
        words.extend(energies.map(|(name, energy)| format!("{name} {}", quantity(energy, "J"))));
        words.extend((!self.at_rest).then(|| format!("dt {}", quantity(self.dt, "s"))));
        words
    }
}

impl fmt::Display for Snapshot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.words().join("  "))
    }
}

/// As many of these words, from the first, as fit a line of this width.
fn fitted(first: String, words: Vec<String>, width: usize) -> String {
    let mut line = first;
    for word in words {
        if line.chars().count() + 2 + word.chars().count() > width {
            break;
        }
        line = line + "  " + &word;
    }
    line
}

/// How progress is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// Not at all; messages still are.
    Quiet,
    /// One line that is overwritten, for a terminal.
    Overwrite,
    /// A line now and then, for a file or a batch system.
    Lines,
}

/// The progress line. Errors of its output are ignored: nobody watching is no reason to stop.
#[derive(Debug)]
pub struct Progress<W: Write> {
    out: W,
    style: Style,
    /// Elapsed and simulated time when it was shown last.
    shown: Option<(Duration, f64)>,
    /// Simulated time per time on the clock, smoothed.
    rate: Option<f64>,
    line_open: bool,
    /// Columns of the terminal, where it is one.
    width: fn() -> Option<usize>,
}

impl Progress<Stderr> {
    /// The progress line on stderr, in the style that suits what stderr is.
    pub fn on_stderr(quiet: bool) -> Self {
        let style = match (quiet, io::stderr().is_terminal()) {
            (true, _) => Style::Quiet,
            (false, true) => Style::Overwrite,
            (false, false) => Style::Lines,
        };
        let width = || terminal_size::terminal_size_of(io::stderr()).map(|(width, _)| usize::from(width.0));
        Self { width, ..Self::new(io::stderr(), style) }
    }
}

impl<W: Write> Progress<W> {
    /// A progress line on `out`.
    pub fn new(out: W, style: Style) -> Self {
        Self { out, style, shown: None, rate: None, line_open: false, width: || None }
    }

    /// Whether it is time to show progress again, `elapsed` after the run began. Cheap: ask after every step.
    pub fn due(&self, elapsed: Duration) -> bool {
        let pause = match self.style {
            Style::Quiet => return false,
            Style::Overwrite => Duration::from_millis(200),
            Style::Lines => Duration::from_secs(10),
        };
        self.shown.is_none_or(|(last, _)| elapsed.saturating_sub(last) >= pause)
    }

    /// Shows where the run stands, `elapsed` after it began (or was resumed).
    pub fn show(&mut self, snapshot: &Snapshot, elapsed: Duration) {
        if self.style == Style::Quiet {
            return;
        }
        self.update_rate(snapshot, elapsed);
        let percent = match 100.0 * snapshot.time / snapshot.end {
            share if share.is_finite() => format!("{:3.0} %", share.clamp(0.0, 100.0)),
            _ => "  ? %".into(),
        };
        let width = (self.width)().unwrap_or(usize::MAX);
        let line = fitted(format!("{percent}  ETA {}", self.eta(snapshot)), snapshot.words(), width);
        self.write(&line);
    }

    /// Shows what is being done before a run begins, `elapsed` after the work on it began: in one line that is overwritten, or in a line now and
    /// then.
    pub fn prepare(&mut self, doing: &str, elapsed: Duration) {
        let since = elapsed.saturating_sub(self.shown.map_or(Duration::ZERO, |(last, _)| last));
        let due = match self.style {
            Style::Quiet => false,
            Style::Overwrite => self.shown.is_none() || since >= Duration::from_millis(200),
            Style::Lines => since >= Duration::from_secs(10),
        };
        if !due {
            return;
        }
        self.write(&format!("{}  {doing}", duration(elapsed.as_secs_f64())));
        self.shown = Some((elapsed, 0.0));
    }

    /// Clears the line of a preparation.
    pub fn clear(&mut self) {
        if std::mem::take(&mut self.line_open) {
            let _ = write!(self.out, "\r\x1b[K");
            let _ = self.out.flush();
        }
    }

    fn write(&mut self, line: &str) {
        // Write errors are nobody's business, see the type. Without wrapping, a line of a terminal that has just become
        // narrower is cut at its edge, so that the next can overwrite it.
        let _ = match self.style {
            Style::Overwrite => write!(self.out, "\r\x1b[K\x1b[?7l{line}\x1b[?7h"),
            _ => writeln!(self.out, "{line}"),
        };
        let _ = self.out.flush();
        self.line_open = self.style == Style::Overwrite;
    }

    /// Shows a message on a line of its own, in every style: what a user should know comes through.
    pub fn message(&mut self, text: impl fmt::Display) {
        let clear = if self.line_open { "\r\x1b[K" } else { "" };
        let _ = writeln!(self.out, "{clear}{text}");
        self.line_open = false;
    }

    /// Leaves the last state standing on its line.
    pub fn finish(&mut self, snapshot: &Snapshot, elapsed: Duration) {
        self.show(snapshot, elapsed);
        if self.line_open {
            let _ = writeln!(self.out);
        }
        self.line_open = false;
    }

    fn update_rate(&mut self, snapshot: &Snapshot, elapsed: Duration) {
        if let Some((last, time)) = self.shown {
            let seconds = elapsed.saturating_sub(last).as_secs_f64();
            let rate = (snapshot.time - time) / seconds;
            if rate.is_finite() && rate >= 0.0 {
                // Fades over some ten seconds: cracks slow a run down, and the ETA should tell soon.
                let weight = 1.0 - exp(-seconds / 10.0);
                self.rate = Some(self.rate.map_or(rate, |old| old + weight * (rate - old)));
            }
        }
        self.shown = Some((elapsed, snapshot.time));
    }

    fn eta(&self, snapshot: &Snapshot) -> String {
        let seconds = self.rate.map(|rate| (snapshot.end - snapshot.time).max(0.0) / rate);
        match seconds {
            Some(seconds) if seconds < 1e7 => duration(seconds),
            _ => "--:--".into(),
        }
    }
}

/// `0:32`, `12:05`, `3:25:10`, `2 d 3 h`.
pub fn duration(seconds: f64) -> String {
    if !(seconds.is_finite() && seconds >= 0.0) {
        return "--:--".into();
    }
    let total = seconds.round() as u64;
    let (minutes, hours, days) = (total / 60, total / 3600, total / 86_400);
    match (days, hours) {
        (0, 0) => format!("{minutes}:{:02}", total % 60),
        (0, _) => format!("{hours}:{:02}:{:02}", minutes % 60, total % 60),
        _ => format!("{days} d {} h", hours % 24),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_being_prepared_is_one_line_or_one_now_and_then() {
        let shown = |style: Style| {
            let mut progress = Progress::new(Vec::new(), style);
            for second in 0..25 {
                progress.prepare(&format!("round {second}"), Duration::from_secs(second));
                progress.prepare("at once", Duration::from_millis(1000 * second + 10));
            }
            progress.clear();
            text(&progress).to_owned()
        };
        assert_eq!(shown(Style::Quiet), "");
        assert_eq!(shown(Style::Lines), "0:10  round 10\n0:20  round 20\n");
        let line = shown(Style::Overwrite);
        assert!(
            line.starts_with("\r\x1b[K\x1b[?7l0:00  round 0\x1b[?7h\r\x1b[K\x1b[?7l0:01  round 1\x1b[?7h"),
            "{line:?}"
        );
        assert!(
            line.ends_with("round 24\x1b[?7h\r\x1b[K") && !line.contains(['\n']) && !line.contains("at once"),
            "{line:?}"
        );
    }

    fn snapshot(time: f64) -> Snapshot {
        Snapshot {
            step: 1200,
            time,
            end: 2e-3,
            dt: 7.3e-8,
            kinetic: 1.2e-3,
            elastic: 0.034,
            balance_error: 1.234e-6,
            broken_edges: 12,
            ..Default::default()
        }
    }

    fn text(progress: &Progress<Vec<u8>>) -> &str {
        std::str::from_utf8(&progress.out).unwrap()
    }

    #[test]
    fn a_snapshot_names_what_is_there_and_no_more() {
        let text = snapshot(1.84e-4).to_string();
        assert_eq!(
            text,
            "t 184 µs  balance 1.2e-6  step 1200  12 broken edges  dissipated 0 J  elastic 34 mJ  kinetic 1.2 mJ  dt 73 ns"
        );
        let loaded = Snapshot { load: Some(([3100.0, -3400.0], "N")), ..snapshot(1.84e-4) }.to_string();
        assert!(loaded.starts_with("load 3.1 kN (peak -3.4 kN)  t 184 µs  balance 1.2e-6  step 1200"), "{loaded}");
    }

    #[test]
    fn the_line_fits_the_terminal_load_and_balance_first() {
        for width in [20, 60, 79, 80, 120, 200] {
            let mut progress = Progress { width: || None, ..Progress::new(Vec::new(), Style::Lines) };
            progress.width = match width {
                20 => || Some(20),
                60 => || Some(60),
                79 => || Some(79),
                80 => || Some(80),
                120 => || Some(120),
                _ => || Some(200),
            };
            progress.show(&Snapshot { load: Some(([3100.0, 3400.0], "N")), ..snapshot(1e-4) }, Duration::ZERO);
            let line = text(&progress).trim_end();
            assert!(line.chars().count() <= width, "{width}: {line}");
            assert_eq!(line.ends_with("dt 73 ns"), width == 200, "{width}: {line}");
            assert_eq!(line.contains("load 3.1 kN (peak 3.4 kN)"), width >= 60, "{width}: {line}");
            assert_eq!(line.contains("balance 1.2e-6"), width >= 79, "{width}: {line}");
        }
    }

    #[test]
    fn a_terminal_line_is_overwritten_and_a_message_stands_alone() {
        let mut progress = Progress::new(Vec::new(), Style::Overwrite);
        progress.show(&snapshot(1e-4), Duration::from_secs(1));
        progress.message("warning: element 5 is large");
        progress.finish(&snapshot(2e-3), Duration::from_secs(2));
        let text = text(&progress);
        assert!(text.starts_with("\r\x1b[K\x1b[?7l  5 %  ETA --:--  t 100 µs"), "{text:?}");
        assert!(text.contains("\x1b[?7h\r\x1b[Kwarning: element 5 is large\n\r\x1b[K\x1b[?7l100 %"), "{text:?}");
        assert!(text.ends_with("\x1b[?7h\n"), "{text:?}");
    }

    #[test]
    fn lines_come_now_and_then_without_control_characters() {
        let mut progress = Progress::new(Vec::new(), Style::Lines);
        assert!(progress.due(Duration::ZERO));
        progress.show(&snapshot(0.0), Duration::ZERO);
        assert!(!progress.due(Duration::from_secs(9)));
        assert!(progress.due(Duration::from_secs(10)));
        progress.show(&snapshot(5e-4), Duration::from_secs(10));
        assert_eq!(text(&progress).lines().count(), 2);
        assert!(!text(&progress).contains(['\r', '\x1b']));
        // 0.5 ms took 10 s, 1.5 ms are left.
        assert!(text(&progress).lines().last().unwrap().starts_with(" 25 %  ETA 0:30  "), "{}", text(&progress));
    }

    #[test]
    fn quiet_shows_messages_only() {
        let mut progress = Progress::new(Vec::new(), Style::Quiet);
        assert!(!progress.due(Duration::from_secs(100)));
        progress.show(&snapshot(0.0), Duration::ZERO);
        progress.finish(&snapshot(0.0), Duration::ZERO);
        assert_eq!(text(&progress), "");
        progress.message("error");
        assert_eq!(text(&progress), "error\n");
    }

    #[test]
    fn a_run_that_stands_still_or_has_no_end_has_no_eta() {
        let mut progress = Progress::new(Vec::new(), Style::Lines);
        for end in [2e-3, f64::NAN, 0.0] {
            for seconds in [0, 10, 20] {
                progress.show(&Snapshot { end, ..snapshot(1e-3) }, Duration::from_secs(seconds));
            }
        }
        assert!(text(&progress).lines().all(|line| line.contains("ETA --:--") || line.contains("ETA 0:00")));
    }

    #[test]
    fn durations_read_as_on_a_clock() {
        let cases = [(0.4, "0:00"), (32.0, "0:32"), (725.0, "12:05"), (12_310.0, "3:25:10"), (2e5, "2 d 7 h")];
        for (seconds, text) in cases {
            assert_eq!(duration(seconds), text);
        }
        assert_eq!(duration(f64::INFINITY), "--:--");
    }

    #[test]
    fn a_resumed_log_goes_on_and_a_new_one_begins_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.log");
        RunLog::resume(&path).unwrap().line("one").unwrap();
        RunLog::resume(&path).unwrap().line(format_args!("two {}", 2)).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "one\ntwo 2\n");
        RunLog::create(&path).unwrap().line("again").unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "again\n");
        let error = RunLog::create(&folder.path().join("absent").join("run.log")).unwrap_err();
        assert!(matches!(error, WriteError::MissingFolder { .. }));
    }
}
