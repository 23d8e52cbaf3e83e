use std::fmt;

pub(crate) use fractum_vtk::text::{BYTE_ORDER_MARK, quote};

use super::error::Fault;

/// Names a record in a message: `node 3 of 14`. Formatting waits until there is something to say.
#[derive(Clone, Copy)]
pub(crate) struct What {
    pub(crate) noun: &'static str,
    pub(crate) index: usize,
    pub(crate) count: usize,
}

impl What {
    pub(crate) fn one(noun: &'static str) -> Self {
        What { noun, index: 0, count: 1 }
    }
}

impl fmt::Display for What {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.count {
            1 => write!(out, "{}", self.noun),
            _ => write!(out, "{} {} of {}", self.noun, self.index + 1, self.count),
        }
    }
}

/// A position in the bytes of a file, read as lines or as raw blocks.
#[derive(Clone)]
pub(crate) struct Cursor<'a> {
    pub(crate) bytes: &'a [u8],
    pub(crate) at: usize,
}

impl<'a> Cursor<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Cursor { bytes, at: 0 }
    }

    /// Passes the mark that some programs write at the start of a file in UTF-8.
    pub(crate) fn skip_byte_order_mark(&mut self) {
        if self.bytes[self.at..].starts_with(BYTE_ORDER_MARK) {
            self.at += BYTE_ORDER_MARK.len();
        }
    }

    pub(crate) fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// The next line that is not blank, without the blanks around it, and where it starts.
    pub(crate) fn line(&mut self) -> Option<(usize, &'a [u8])> {
        while self.at < self.bytes.len() {
            let start = self.at;
            let rest = &self.bytes[start..];
            let length = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
            self.at = (start + length + 1).min(self.bytes.len());
            let line = rest[..length].trim_ascii_start();
            if !line.is_empty() {
                return Some((start + length - line.len(), line.trim_ascii_end()));
            }
        }
        None
    }

    /// The next line that is not blank as fields; a `$` line or the end of the file is not a record.
    pub(crate) fn record(&mut self, what: What) -> Result<Record<'a>, Fault> {
        match self.line() {
            None => Err(Fault::truncated(self.bytes.len(), what.to_string())),
            Some((at, line)) if line[0] == b'$' => Err(Fault::unexpected(at, quote(line), what.to_string())),
            Some((at, line)) => Ok(Record { rest: line, at, what }),
        }
    }

    /// The next `count` bytes.
    pub(crate) fn take(&mut self, count: usize, what: What) -> Result<&'a [u8], Fault> {
        if count > self.remaining() {
            let expected = format!("{what} ({count} bytes, {} left)", self.remaining());
            return Err(Fault::truncated(self.at, expected));
        }
        let block = &self.bytes[self.at..self.at + count];
        self.at += count;
        Ok(block)
    }

    /// `count` records of `size` bytes each; a count that the rest of the file cannot hold is an error.
    pub(crate) fn take_records(&mut self, count: u64, size: usize, what: What) -> Result<&'a [u8], Fault> {
        match usize::try_from(count).ok().and_then(|count| count.checked_mul(size)) {
            Some(length) if length <= self.remaining() => self.take(length, what),
            _ => {
                let expected = format!("{} of {count} announced ({} bytes left)", what.noun, self.remaining());
                Err(Fault::truncated(self.at, expected))
            }
        }
    }

    /// Room for `count` items of which each takes at least `size` bytes of the file.
    pub(crate) fn capacity(&self, count: u64, size: usize) -> usize {
        (self.remaining() / size).min(usize::try_from(count).unwrap_or(usize::MAX))
    }

    /// The line `$EndNAME` that closes a section.
    pub(crate) fn end_section(&mut self, name: &str) -> Result<(), Fault> {
        let expected = || format!("$End{name}");
        match self.line() {
            None => Err(Fault::truncated(self.bytes.len(), expected())),
            Some((_, line)) if line.strip_prefix(b"$End") == Some(name.as_bytes()) => Ok(()),
            Some((at, line)) => Err(Fault::unexpected(
                at,
                quote(line),
                format!("{}; the count at the start of the section may be wrong", expected()),
            )),
        }
    }

    /// Skips to behind the line `$EndNAME`, through text or binary data.
    pub(crate) fn skip_section(&mut self, name: &str) -> Result<(), Fault> {
        let end = [b"$End", name.as_bytes()].concat();
        let mut from = self.at;
        while let Some(step) = self.bytes[from..].iter().position(|&byte| byte == b'$') {
            let start = from + step;
            let after = self.bytes.get(start + end.len());
            if self.bytes[start..].starts_with(&end) && after.is_none_or(u8::is_ascii_whitespace) {
                self.at = start + end.len();
                return Ok(());
            }
            from = start + 1;
        }
        Err(Fault::truncated(self.bytes.len(), format!("$End{name}")))
    }
}

/// The fields of one line, taken from the left.
pub(crate) struct Record<'a> {
    rest: &'a [u8],
    at: usize,
    what: What,
}

impl<'a> Record<'a> {
    /// Where the next field starts.
    pub(crate) fn at(&self) -> usize {
        self.at
    }

    /// What is left of the line.
    pub(crate) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    fn skip_blanks(&mut self) {
        let blanks = self.rest.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(self.rest.len());
        self.rest = &self.rest[blanks..];
        self.at += blanks;
    }

    fn field(&mut self, expected: &'static str) -> Result<(usize, &'a [u8]), Fault> {
        self.skip_blanks();
        if self.rest.is_empty() {
            return Err(Fault::unexpected(self.at, "the end of the line", format!("{expected} of {}", self.what)));
        }
        let length = self.rest.iter().position(u8::is_ascii_whitespace).unwrap_or(self.rest.len());
        let (field, start) = (&self.rest[..length], self.at);
        self.rest = &self.rest[length..];
        self.at += length;
        Ok((start, field))
    }

    fn wrong(&self, at: usize, field: &[u8], expected: &str, kind: &str) -> Fault {
        Fault::unexpected(at, quote(field), format!("{expected} of {} ({kind})", self.what))
    }

    /// A whole number of either sign.
    pub(crate) fn integer(&mut self, expected: &'static str) -> Result<i64, Fault> {
        let (at, field) = self.field(expected)?;
        let (negative, digits) = match field {
            [b'-', digits @ ..] => (true, digits),
            [b'+', digits @ ..] | digits => (false, digits),
        };
        parse_digits(digits)
            .and_then(|magnitude| i64::try_from(magnitude).ok())
            .map(|magnitude| if negative { -magnitude } else { magnitude })
            .ok_or_else(|| self.wrong(at, field, expected, "a whole number"))
    }

    /// A 32 bit whole number of either sign.
    pub(crate) fn integer32(&mut self, expected: &'static str) -> Result<i32, Fault> {
        self.skip_blanks();
        let (at, rest) = (self.at, self.rest);
        let value = self.integer(expected)?;
        i32::try_from(value).map_err(|_| {
            let length = rest.len() - self.rest.len();
            self.wrong(at, &rest[..length], expected, "a whole number of 32 bits")
        })
    }

    /// A whole number of at least 0.
    pub(crate) fn unsigned(&mut self, expected: &'static str) -> Result<u64, Fault> {
        let (at, field) = self.field(expected)?;
        parse_digits(field).ok_or_else(|| self.wrong(at, field, expected, "a whole number of at least 0"))
    }

    /// A finite real number.
    pub(crate) fn real(&mut self, expected: &'static str) -> Result<f64, Fault> {
        let (at, field) = self.field(expected)?;
        std::str::from_utf8(field)
            .ok()
            .and_then(|text| text.parse::<f64>().ok())
            .filter(|value| value.is_finite())
            .ok_or_else(|| self.wrong(at, field, expected, "a finite number"))
    }

    /// Ensures that nothing is left on the line.
    pub(crate) fn end(mut self) -> Result<(), Fault> {
        self.skip_blanks();
        match self.rest {
            [] => Ok(()),
            rest => Err(Fault::unexpected(self.at, quote(rest), format!("the end of {}", self.what))),
        }
    }
}

/// Digits only, at least one, below 2⁶⁴.
fn parse_digits(digits: &[u8]) -> Option<u64> {
    if digits.is_empty() {
        return None;
    }
    let mut value = 0u64;
    for &byte in digits {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            return None;
        }
        value = value.checked_mul(10)?.checked_add(digit.into())?;
    }
    Some(value)
}
