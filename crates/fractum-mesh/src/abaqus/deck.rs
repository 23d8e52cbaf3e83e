//! Lines of an input file: keywords with their parameters, and data.

use crate::tagged::cursor::{Cursor, quote};
use crate::tagged::error::Fault;

/// A line of the file that is no comment.
pub(super) enum Line<'a> {
    /// `*ELEMENT, TYPE=C3D4, ELSET=part`
    Keyword(Keyword),
    /// Fields between commas, and where the line starts.
    Data { at: usize, fields: Vec<&'a str> },
}

/// A keyword; names of keywords and parameters in capitals and without blanks.
pub(super) struct Keyword {
    pub(super) at: usize,
    pub(super) name: String,
    parameters: Vec<(String, String)>,
}

impl Keyword {
    /// Value of a parameter; empty of one without a value.
    pub(super) fn get(&self, name: &str) -> Option<&str> {
        self.parameters.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    /// Value of a parameter that must be there.
    pub(super) fn require(&self, name: &str) -> Result<&str, Fault> {
        self.get(name).filter(|value| !value.is_empty()).ok_or_else(|| {
            Fault::unexpected(self.at, format!("*{} without {name}", self.name), format!("{name}=NAME on that line"))
        })
    }
}

/// The next line that is neither blank nor a comment.
pub(super) fn next<'a>(cursor: &mut Cursor<'a>) -> Result<Option<Line<'a>>, Fault> {
    while let Some((at, line)) = cursor.line() {
        if line.starts_with(b"**") {
            continue;
        }
        let text = text(at, line)?;
        let Some(keyword) = text.strip_prefix('*') else {
            return Ok(Some(Line::Data { at, fields: fields(text) }));
        };
        let mut parts: Vec<&str> = fields(keyword);
        // A keyword goes on in the next line after a comma.
        while parts.last().is_some_and(|last| last.is_empty()) {
            let before = cursor.at;
            let Some((at, more)) = cursor.line() else { break };
            if more.starts_with(b"**") {
                continue;
            }
            if more.starts_with(b"*") {
                // The comma was one too many.
                cursor.at = before;
                break;
            }
            parts.pop();
            parts.extend(fields(self::text(at, more)?));
        }
        let mut parts = parts.into_iter();
        let name = plain(parts.next().unwrap_or_default());
        let parameter = |part: &str| match part.split_once('=') {
            Some((name, value)) => (plain(name), unquoted(value).to_owned()),
            None => (plain(part), String::new()),
        };
        return Ok(Some(Line::Keyword(Keyword { at, name, parameters: parts.map(parameter).collect() })));
    }
    Ok(None)
}

/// Whether a line has that keyword, which is given in capitals and without blanks.
pub(super) fn is_keyword(line: &[u8], name: &str) -> bool {
    let Some(text) = line.strip_prefix(b"*") else { return false };
    let word = text.split(|&byte| byte == b',').next().unwrap_or_default();
    word.iter().filter(|byte| !byte.is_ascii_whitespace()).map(u8::to_ascii_uppercase).eq(name.bytes())
}

fn text(at: usize, line: &[u8]) -> Result<&str, Fault> {
    std::str::from_utf8(line).map_err(|_| Fault::unexpected(at, quote(line), "text in UTF-8"))
}

/// What stands between the commas outside of quotes, without blanks around it.
fn fields(line: &str) -> Vec<&str> {
    let mut quoted = false;
    let split = line.split(move |c| {
        quoted ^= c == '"';
        c == ',' && !quoted
    });
    split.map(str::trim).collect()
}

/// A word of the format, whose capitals and blanks do not matter.
fn plain(word: &str) -> String {
    word.chars().filter(|c| !c.is_whitespace()).collect::<String>().to_uppercase()
}

/// A name without the quotes around it.
pub(super) fn unquoted(name: &str) -> &str {
    let name = name.trim();
    name.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')).unwrap_or(name)
}
