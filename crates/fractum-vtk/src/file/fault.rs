//! Why a file is no grid that can be used.

/// What is wrong with a file, at a byte of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Byte of the file, from 0; beyond its end where something is missing.
    pub at: usize,
    /// What is wrong there.
    pub wrong: Wrong,
}

/// What is wrong with a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wrong {
    /// No tags at all.
    Empty,
    /// The file is something else.
    Foreign {
        /// Start of the file.
        found: String,
        /// What the file seems to be.
        hint: &'static str,
    },
    /// Something other than what the format wants here.
    Unexpected {
        /// What stands there.
        found: String,
        /// What should stand there.
        expected: String,
    },
    /// The file ends too early: what is missing.
    Truncated(String),
    /// A valid file of a kind that is not read.
    Unsupported(String),
    /// Parts of the file contradict each other.
    Inconsistent(String),
}

impl Fault {
    /// Something other than what the format wants.
    pub fn unexpected(at: usize, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Fault { at, wrong: Wrong::Unexpected { found: found.into(), expected: expected.into() } }
    }

    /// A file that ends too early.
    pub fn truncated(at: usize, expected: impl Into<String>) -> Self {
        Fault { at, wrong: Wrong::Truncated(expected.into()) }
    }

    /// Parts that contradict each other.
    pub fn inconsistent(at: usize, message: impl Into<String>) -> Self {
        Fault { at, wrong: Wrong::Inconsistent(message.into()) }
    }

    /// A kind of file that is not read.
    pub fn unsupported(at: usize, message: impl Into<String>) -> Self {
        Fault { at, wrong: Wrong::Unsupported(message.into()) }
    }
}
