//! What is wrong in a case file, where, and what to do about it.

use std::fmt;

use serde::Serialize;

use super::Place;

/// How serious a diagnostic is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The case cannot run.
    Error,
    /// The case runs, and probably not as meant.
    Warning,
}

/// One mistake, or one doubtful choice.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Diagnostic {
    /// How serious it is.
    pub severity: Severity,
    /// Where it stands; `None` where no file could be read.
    pub place: Option<Place>,
    /// What was found there: the value as written for a key, else a phrase.
    pub found: String,
    /// What would have been right; may be empty.
    pub expected: String,
    /// What to do; may be empty.
    pub remedy: String,
}

/// `cases/beam.toml:14:17: materials.concrete.poisson_ratio = 0.62; expected between -1 and 0.5`, on one line.
impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = &self.place {
            write!(f, "{place}: ")?;
            if self.severity == Severity::Warning {
                write!(f, "warning: ")?;
            }
            write!(f, "{}", place.key)?;
            if !place.key.is_empty() && !self.found.is_empty() && !self.found.starts_with(['=', ':']) {
                write!(f, " ")?;
            }
        }
        write!(f, "{}", self.found)?;
        for part in [&self.expected, &self.remedy] {
            if !part.is_empty() {
                write!(f, "; {part}")?;
            }
        }
        Ok(())
    }
}

/// Everything found wrong in one reading, in the order of the file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Diagnostics(pub Vec<Diagnostic>);

/// One diagnostic per line.
impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, diagnostic) in self.0.iter().enumerate() {
            if i > 0 {
                writeln!(f)?;
            }
            write!(f, "{diagnostic}")?;
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostics {}
