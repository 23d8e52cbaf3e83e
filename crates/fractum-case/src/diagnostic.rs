//! What is wrong in a case file, where, and what to do about it.

use std::fmt;

use fractum_output::warning::{Code, Warning};
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
    /// What a warning is of; errors have none.
    pub code: Option<Code>,
    /// Where it stands; `None` where no file could be read.
    pub place: Option<Place>,
    /// What was found there: `= 0.62` for the value of a key, else a phrase that follows the key: `is missing`, or
    /// `: triangles in space`.
    pub found: String,
    /// What would have been right, as the object of "expected"; may be empty.
    pub expected: String,
    /// What to do; may be empty.
    pub remedy: String,
}

impl Diagnostic {
    /// An error; `found` follows the key of the place.
    pub fn error(place: &Place, found: impl Into<String>) -> Self {
        Self { place: Some(place.clone()), ..Self::without_place(found) }
    }

    /// A warning; `found` follows the key of the place.
    pub fn warning(code: Code, place: &Place, found: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, code: Some(code), ..Self::error(place, found) }
    }

    /// A mistake that has no place in a case file.
    pub fn without_place(found: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            code: None,
            place: None,
            found: found.into(),
            expected: String::new(),
            remedy: String::new(),
        }
    }

    /// The warning as results show it; none of an error.
    pub fn to_warning(&self) -> Option<Warning> {
        let place = self.place.as_ref().map_or(String::new(), |place| printable(&place.to_string()));
        Some(Warning::new(self.code?, place, self.text()).remedy(printable(&self.remedy)))
    }

    /// Key, what was found there, and what was expected.
    fn text(&self) -> String {
        let key = self.place.as_ref().map_or("", |place| place.key.as_str());
        // What begins with a stop belongs to the key: `mesh.file: cannot be read`.
        let gap = if key.is_empty() || self.found.starts_with([':', ',', '.']) { "" } else { " " };
        let expected = if self.expected.is_empty() { String::new() } else { format!("; expected {}", self.expected) };
        printable(&format!("{key}{gap}{}{expected}", self.found))
    }

    /// Adds what would have been right.
    pub fn expected(mut self, expected: impl Into<String>) -> Self {
        self.expected = expected.into();
        self
    }

    /// Adds what to do.
    pub fn remedy(mut self, remedy: impl Into<String>) -> Self {
        self.remedy = remedy.into();
        self
    }
}

/// `cases/beam.toml:14:17: materials.concrete.poisson_ratio = 0.62; expected between -1 and 0.5`, on one line.
impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = &self.place {
            write!(f, "{}: ", printable(&place.to_string()))?;
        }
        if self.severity == Severity::Warning {
            write!(f, "warning: ")?;
        }
        write!(f, "{}", self.text())?;
        if !self.remedy.is_empty() {
            write!(f, "; {}", printable(&self.remedy))?;
        }
        self.code.map_or(Ok(()), |code| write!(f, " [{code}]"))
    }
}

/// Text with control characters escaped, so that it stays on its line and no terminal obeys it.
pub fn printable(text: &str) -> String {
    text.chars().flat_map(|c| if c.is_control() { c.escape_default().collect() } else { vec![c] }).collect()
}

/// Everything found wrong in one reading, in the order of the file.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Diagnostics(pub Vec<Diagnostic>);

/// Diagnostics that are listed; beyond them a file is probably of another kind.
pub(crate) const MOST_LISTED: usize = 20;

impl Diagnostics {
    /// The same with every warning as an error.
    pub fn as_errors(self) -> Self {
        Self(self.0.into_iter().map(|one| Diagnostic { severity: Severity::Error, ..one }).collect())
    }

    /// The first of many, mistakes before warnings, with the count of the others. Warnings alone are all listed: the case
    /// runs, and nothing of it is an error.
    pub(crate) fn of_many(mut diagnostics: Vec<Diagnostic>) -> Self {
        let is_warning = |diagnostic: &Diagnostic| diagnostic.severity == Severity::Warning;
        if diagnostics.iter().all(is_warning) {
            return Self(diagnostics);
        }
        let more = diagnostics.len().saturating_sub(MOST_LISTED);
        let last = diagnostics.get(MOST_LISTED).and_then(|diagnostic| diagnostic.place.clone());
        if more > 1
            && let Some(place) = last
        {
            diagnostics.sort_by_key(is_warning);
            diagnostics.truncate(MOST_LISTED);
            let whole = Place { line: 0, column: 0, key: String::new(), ..place };
            diagnostics.push(Diagnostic::error(&whole, format!("{more} further messages are not listed")));
        }
        Self(diagnostics)
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_diagnostic_reads_as_printable() {
        let key = "materials.concrete.poisson_ratio".to_string();
        let place = Place { file: "cases/beam.toml".to_string(), line: 14, column: 17, key };
        let diagnostic = Diagnostic::error(&place, "= 0.62").expected("between -1 and 0.5");
        assert_eq!(
            diagnostic.to_string(),
            "cases/beam.toml:14:17: materials.concrete.poisson_ratio = 0.62; expected between -1 and 0.5"
        );
        let diagnostic = Diagnostic::warning(Code::NoEffect, &place, "= \"a\nb\"").remedy("do this");
        assert_eq!(
            diagnostic.to_string(),
            "cases/beam.toml:14:17: warning: materials.concrete.poisson_ratio = \"a\\nb\"; do this [no-effect]"
        );
        assert_eq!(
            Diagnostic::error(&place, ": too stiff").to_string(),
            "cases/beam.toml:14:17: materials.concrete.poisson_ratio: too stiff"
        );
        let json = serde_json::to_value(Diagnostics(vec![diagnostic])).unwrap();
        assert_eq!((&json[0]["severity"], &json[0]["code"]), (&"warning".into(), &"no-effect".into()));
        assert_eq!(json[0]["place"]["line"], 14);
    }

    fn place(line: u32) -> Place {
        Place { file: "case.toml".to_string(), line, column: 1, key: String::new() }
    }

    #[test]
    fn warnings_alone_are_all_listed() {
        let warnings: Vec<Diagnostic> =
            (1..=23).map(|line| Diagnostic::warning(Code::NoEffect, &place(line), "is odd")).collect();
        assert_eq!(Diagnostics::of_many(warnings.clone()).0, warnings);
    }

    #[test]
    fn warnings_do_not_hide_mistakes() {
        let mut many: Vec<Diagnostic> =
            (1..=30).map(|line| Diagnostic::warning(Code::NoEffect, &place(line), "is odd")).collect();
        let wrong = [31, 32].map(|line| Diagnostic::error(&place(line), "is wrong"));
        many.extend(wrong.clone());
        let listed = Diagnostics::of_many(many.clone()).0;
        assert_eq!(listed[..2], wrong, "mistakes first");
        assert_eq!(listed[2..MOST_LISTED], many[..18], "then warnings in the order of the file");
        assert_eq!(listed[MOST_LISTED].found, "12 further messages are not listed");
        assert_eq!(listed.len(), MOST_LISTED + 1);
        // Few are left in their order.
        assert_eq!(Diagnostics::of_many(many[20..].to_vec()).0, many[20..]);
    }
}
