use std::fmt;

/// Why a mesh could not be read, and where. Displays as `line 12: …` or `byte 4711: …`; the caller prefixes the name
/// of the file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {problem}")]
pub struct MeshError {
    /// Where in the file.
    pub place: Place,
    /// What is wrong there.
    pub problem: Problem,
}

/// A place in a mesh file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// Line of an ASCII file, from 1.
    Line(usize),
    /// Line of a further file that the file names.
    LineOf(String, usize),
    /// Offset in a binary file, from 0.
    Byte(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Line(line) => write!(out, "line {line}"),
            Place::LineOf(file, line) => write!(out, "line {line} of {file}"),
            Place::Byte(byte) => write!(out, "byte {byte}"),
        }
    }
}

/// What is wrong with a mesh file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Problem {
    /// No bytes, or blank lines only.
    #[error("the file is empty; expected a Gmsh mesh (.msh), {}", crate::OTHERS)]
    Empty,
    /// The file is something else.
    #[error("found {found}; expected a Gmsh mesh, which begins with $MeshFormat, {}{hint}", crate::OTHERS)]
    NotGmsh {
        /// Start of the file.
        found: String,
        /// What the file seems to be and what to do, or nothing.
        hint: &'static str,
    },
    /// A version that is not read.
    #[error("MSH version {0} is not read; convert with: gmsh in.msh -save -format msh41 -o out.msh")]
    Version(String),
    /// Something other than what the format wants here.
    #[error("found {found}; expected {expected}")]
    Unexpected {
        /// What stands there.
        found: String,
        /// What should stand there.
        expected: String,
    },
    /// The file ends too early.
    #[error("the file ends here; expected {expected}; it is cut off, copy or save it again")]
    Truncated {
        /// What is missing.
        expected: String,
    },
    /// A valid file that fractum cannot use.
    #[error("{0}")]
    Unsupported(String),
    /// Parts of the file contradict each other.
    #[error("{0}")]
    Inconsistent(String),
    /// An element without length, area or volume.
    #[error("{0}")]
    Degenerate(String),
}

/// A [`Problem`] at a byte offset, before it is known whether the user counts in lines.
#[derive(Debug)]
pub(crate) struct Fault {
    pub(crate) at: usize,
    pub(crate) problem: Problem,
}

impl Fault {
    pub(crate) fn unexpected(at: usize, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Fault { at, problem: Problem::Unexpected { found: found.into(), expected: expected.into() } }
    }

    pub(crate) fn truncated(at: usize, expected: impl Into<String>) -> Self {
        Fault { at, problem: Problem::Truncated { expected: expected.into() } }
    }

    pub(crate) fn inconsistent(at: usize, message: impl Into<String>) -> Self {
        Fault { at, problem: Problem::Inconsistent(message.into()) }
    }

    pub(crate) fn unsupported(at: usize, message: impl Into<String>) -> Self {
        Fault { at, problem: Problem::Unsupported(message.into()) }
    }

    /// Turns the offset into what the user counts in.
    pub(crate) fn into_error(self, bytes: &[u8], binary: bool) -> MeshError {
        let at = self.at.min(bytes.len());
        let place = if binary {
            Place::Byte(at)
        } else {
            Place::Line(1 + bytes[..at].iter().filter(|&&byte| byte == b'\n').count())
        };
        MeshError { place, problem: self.problem }
    }
}
