//! Lines on the terminal, or wherever the user sends them: a closed pipe or a full disk there is no panic.

use std::fmt::Display;
use std::io::{self, IsTerminal, Write};
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

/// Where a line goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stream {
    /// Standard output.
    Out,
    /// Standard error.
    Error,
}

impl Stream {
    fn is_terminal(self) -> bool {
        match self {
            Stream::Out => io::stdout().is_terminal(),
            Stream::Error => io::stderr().is_terminal(),
        }
    }

    /// Columns of the terminal; none where it is none.
    pub fn width(self) -> Option<usize> {
        let size = match self {
            Stream::Out => terminal_size::terminal_size_of(io::stdout()),
            Stream::Error => terminal_size::terminal_size_of(io::stderr()),
        };
        size.map(|(width, _)| usize::from(width.0))
    }
}

/// What a colour says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// As it should be: green.
    Good,
    /// Doubtful: yellow.
    Doubt,
    /// Wrong: red.
    Wrong,
    /// A heading: bold.
    Name,
}

/// A text in the colour of its tone, where a stream is a terminal that shows colours and `NO_COLOR` is not set.
pub fn toned(text: &str, tone: Tone, stream: Stream) -> String {
    let set = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
    if stream.is_terminal() && !set("NO_COLOR") && !dumb { coloured(text, tone) } else { text.to_owned() }
}

fn coloured(text: &str, tone: Tone) -> String {
    let code = match tone {
        Tone::Good => "32",
        Tone::Doubt => "33",
        Tone::Wrong => "31",
        Tone::Name => "1",
    };
    format!("\x1b[{code}m{text}\x1b[0m")
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_that_goes_to_no_terminal_has_no_colour() {
        assert_eq!(coloured("no", Tone::Wrong), "\x1b[31mno\x1b[0m");
        if !Stream::Out.is_terminal() {
            assert_eq!((toned("text", Tone::Good, Stream::Out).as_str(), Stream::Out.width()), ("text", None));
        }
    }
}
