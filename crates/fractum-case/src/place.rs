//! Where in the case file a value stands.

use std::fmt;

use serde::Serialize;

/// The place of a key or value in the user's input.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct Place {
    /// File as the user named it, or `--set` for a value of the command line.
    pub file: String,
    /// Line, from 1; 0 where there is none (command line, whole file).
    pub line: u32,
    /// Column in characters, from 1; 0 where there is none.
    pub column: u32,
    /// Dotted path of the key, such as `supports[0].group`; empty for the file itself.
    pub key: String,
}

/// What stands for the file of values from the command line.
pub(super) const COMMAND_LINE: &str = "--set";

impl Place {
    /// Whether the value comes from the command line.
    pub(super) fn is_override(&self) -> bool {
        self.file == COMMAND_LINE
    }
}

/// `file:line:column`, without the key.
impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file)?;
        if self.line > 0 {
            write!(f, ":{}:{}", self.line, self.column)?;
        }
        Ok(())
    }
}

/// A value that remembers its place, for checks that need more than the case file (mesh groups, say).
#[derive(Debug, Clone, PartialEq)]
pub struct Spanned<T> {
    /// The value.
    pub value: T,
    /// Where it stands.
    pub place: Place,
}

impl<T> Spanned<T> {
    /// A value with its place.
    pub fn new(value: T, place: Place) -> Self {
        Self { value, place }
    }

    /// The same place with another value.
    pub fn map<U>(self, f: impl FnOnce(T) -> U) -> Spanned<U> {
        Spanned { value: f(self.value), place: self.place }
    }
}
