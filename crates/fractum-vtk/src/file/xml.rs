//! Tags of an XML file one by one, as far as VTK files use XML.

use super::fault::Fault;
use crate::text::quote;

/// A tag, and the text between it and the one before.
pub(crate) struct Tag<'a> {
    pub(super) text: &'a [u8],
    pub(super) at: usize,
    pub(crate) name: &'a str,
    /// `</name>`
    pub(crate) closes: bool,
    /// `<name/>`
    pub(super) empty: bool,
    /// What stands behind the name.
    rest: &'a str,
}

/// The tags of a file.
pub(crate) struct Tags<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) at: usize,
}

/// All tags of a text; none of one that is malformed.
pub(crate) fn tags(text: &str) -> Option<Vec<Tag<'_>>> {
    let mut tags = Tags { bytes: text.as_bytes(), at: 0 };
    let mut all = Vec::new();
    while let Some(tag) = tags.next().ok()? {
        all.push(tag);
    }
    Some(all)
}

impl<'a> Tags<'a> {
    /// The next tag; none at the end of the file. Comments and declarations are passed over.
    pub(super) fn next(&mut self) -> Result<Option<Tag<'a>>, Fault> {
        loop {
            let from = self.at;
            let Some(text) = self.bytes[from..].iter().position(|&byte| byte == b'<') else { return Ok(None) };
            let at = from + text;
            let rest = &self.bytes[at..];
            let end = if rest.starts_with(b"<!--") { find(rest, b"-->") } else { end_of_tag(rest) };
            let end = end.ok_or_else(|| Fault::truncated(self.bytes.len(), format!("the end of {}", quote(rest))))?;
            self.at = at + end;
            if matches!(rest.get(1), Some(b'!' | b'?')) {
                continue;
            }
            let inside = std::str::from_utf8(&rest[1..end - 1])
                .map_err(|_| Fault::unexpected(at, quote(rest), "a tag in UTF-8"))?;
            if inside.contains('<') {
                return Err(Fault::unexpected(at, quote(rest), "a tag that ends with >"));
            }
            let (inside, empty) = inside.strip_suffix('/').map_or((inside, false), |inside| (inside, true));
            let (inside, closes) = inside.strip_prefix('/').map_or((inside, false), |inside| (inside, true));
            let name = inside.split(|c: char| c.is_ascii_whitespace()).next().unwrap_or_default();
            let text = &self.bytes[from..at];
            return Ok(Some(Tag { text, at, name, closes, empty, rest: &inside[name.len()..] }));
        }
    }
}

/// Length of a tag with its `>`, which does not end it inside of quotes.
fn end_of_tag(bytes: &[u8]) -> Option<usize> {
    let mut quoted = None;
    for (index, &byte) in bytes.iter().enumerate() {
        match (quoted, byte) {
            (None, b'>') => return Some(index + 1),
            (None, b'"' | b'\'') => quoted = Some(byte),
            (Some(open), byte) if open == byte => quoted = None,
            _ => {}
        }
    }
    None
}

/// End of the first place of `pattern`.
fn find(bytes: &[u8], pattern: &[u8]) -> Option<usize> {
    bytes.windows(pattern.len()).position(|window| window == pattern).map(|at| at + pattern.len())
}

impl Tag<'_> {
    /// The value of an attribute.
    pub(crate) fn attribute(&self, name: &str) -> Option<String> {
        let mut rest = self.rest;
        while let Some((before, after)) = rest.split_once('=') {
            let after = after.trim_start();
            let quote = after.chars().next().filter(|c| matches!(c, '"' | '\''))?;
            let (value, after) = after[1..].split_once(quote)?;
            if before.trim() == name {
                return Some(plain(value));
            }
            rest = after;
        }
        None
    }

    /// A count among the attributes, 0 where it is not given.
    pub(crate) fn count(&self, name: &str) -> Result<usize, Fault> {
        let Some(text) = self.attribute(name) else { return Ok(0) };
        text.trim().parse().map_err(|_| {
            Fault::unexpected(self.at, quote(text.as_bytes()), format!("a whole number of at least 0 as {name}"))
        })
    }
}

/// Text without the five names of characters that XML knows and without control characters, which would break lines of messages.
fn plain(text: &str) -> String {
    let names = [("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&apos;", "'"), ("&amp;", "&")];
    let text = names.iter().fold(text.to_owned(), |text, (name, character)| text.replace(name, character));
    text.replace(char::is_control, "\u{fffd}")
}
