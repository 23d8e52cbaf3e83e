//! Lines on the terminal, or wherever the user sends them: a closed pipe or a full disk there is no panic.

use std::fmt::Display;
use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};

/// Standard output could not take what was written to it.
static FAILED: AtomicBool = AtomicBool::new(false);

/// Writes a line to standard output. Who closed the pipe, like `head`, has read enough.
pub fn print(line: impl Display) {
    match writeln!(io::stdout().lock(), "{line}") {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe && !FAILED.swap(true, Ordering::Relaxed) => {
            print_error(format_args!("standard output cannot be written: {error}"));
        }
        _ => {}
    }
}

/// Writes a line to standard error; where nobody can be told, nobody is.
pub fn print_error(line: impl Display) {
    let _ = writeln!(io::stderr().lock(), "{line}");
}

/// Whether standard output lost something.
pub fn has_failed() -> bool {
    FAILED.load(Ordering::Relaxed)
}

/// A formatted line to standard output, see [`print`](crate::terminal::print).
#[macro_export]
macro_rules! say {
    ($($text:tt)*) => { $crate::terminal::print(format_args!($($text)*)) };
}

/// A formatted line to standard error, see [`print_error`](crate::terminal::print_error).
#[macro_export]
macro_rules! tell {
    ($($text:tt)*) => { $crate::terminal::print_error(format_args!($($text)*)) };
}
