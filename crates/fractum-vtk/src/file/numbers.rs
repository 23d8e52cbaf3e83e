//! From stored bytes to numbers.

use std::io::Read;

use super::document::{Array, Document, Stored};
use super::fault::Fault;
use crate::text::quote;

impl Document<'_> {
    /// The numbers of an array of reals or of whole numbers.
    ///
    /// - `count`: how many it must have
    ///
    /// # Errors
    /// Another number of them, other types, bytes that are damaged.
    pub fn reals(&self, array: &Array, count: usize) -> Result<Vec<f64>, Fault> {
        if let Stored::Text(text) = &array.stored {
            return parsed(array, text, count, "a finite number", |word| {
                word.parse::<f64>().ok().filter(|x| x.is_finite())
            });
        }
        match array.kind.as_str() {
            "Float64" => self.decoded(array, count, f64::from_le_bytes),
            "Float32" => self.decoded(array, count, |bytes| f64::from(f32::from_le_bytes(bytes))),
            _ => Ok(self.wholes(array, count)?.into_iter().map(|number| number as f64).collect()),
        }
    }

    /// The numbers of an array of whole numbers.
    ///
    /// # Errors
    /// As [`reals`](Self::reals).
    pub fn wholes(&self, array: &Array, count: usize) -> Result<Vec<i64>, Fault> {
        if let Stored::Text(text) = &array.stored {
            return parsed(array, text, count, "a whole number", |word| word.parse().ok());
        }
        match array.kind.as_str() {
            "Int8" => self.decoded(array, count, |[byte]: [u8; 1]| i64::from(byte as i8)),
            "UInt8" => self.decoded(array, count, |[byte]: [u8; 1]| i64::from(byte)),
            "Int16" => self.decoded(array, count, |bytes| i64::from(i16::from_le_bytes(bytes))),
            "UInt16" => self.decoded(array, count, |bytes| i64::from(u16::from_le_bytes(bytes))),
            "Int32" => self.decoded(array, count, |bytes| i64::from(i32::from_le_bytes(bytes))),
            "UInt32" => self.decoded(array, count, |bytes| i64::from(u32::from_le_bytes(bytes))),
            "Int64" => self.decoded(array, count, i64::from_le_bytes),
            // Numbers beyond 2⁶³ become negative, which none may be.
            "UInt64" => self.decoded(array, count, |bytes| u64::from_le_bytes(bytes) as i64),
            other => {
                let found = format!("type {other} of array \"{}\"", array.name);
                Err(Fault::unexpected(
                    array.at,
                    found,
                    "one of Int8 to Int64 and UInt8 to UInt64, or Float32, Float64 of points",
                ))
            }
        }
    }

    /// The bytes of all numbers of an array that is not stored as text, in the order of the file; none of damaged ones.
    pub fn bytes(&self, array: &Array) -> Option<Vec<u8>> {
        let mut source = self.source(array)?;
        let length = match self.word(&mut source)? {
            length if !self.compressed => length,
            0 => 0,
            blocks => {
                let [size, last] = [self.word(&mut source)?, self.word(&mut source)?];
                (blocks - 1).checked_mul(size)?.checked_add(if last == 0 { size } else { last })?
            }
        };
        let mut source = self.source(array)?;
        if self.compressed { self.inflated(&mut source, length) } else { self.plain(&mut source, length) }
    }

    /// All numbers of an array as doubles; none of damaged ones, and of other types.
    pub fn numbers(&self, array: &Array) -> Option<Vec<f64>> {
        let size = array.kind.trim_start_matches(char::is_alphabetic).parse::<usize>().ok()? / 8;
        let count = match &array.stored {
            Stored::Text(text) => text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).count(),
            _ => self.bytes(array)?.len().checked_div(size)?,
        };
        self.reals(array, count).ok()
    }

    /// Where an array begins; none beyond the end of the file.
    fn source<'s>(&'s self, array: &'s Array) -> Option<Source<'s>> {
        let (data, encoded) = match &array.stored {
            Stored::Appended(offset) => (self.appended.get(*offset..)?, self.encoded),
            Stored::Base64(text) | Stored::Text(text) => (&text[..], true),
        };
        Some(Source { data, encoded, pending: Vec::new() })
    }

    fn decoded<const SIZE: usize, N>(
        &self,
        array: &Array,
        count: usize,
        number: impl Fn([u8; SIZE]) -> N,
    ) -> Result<Vec<N>, Fault> {
        let wrong = || {
            let message = format!(
                "array \"{}\" has not {count} numbers of type {}, as the sizes of the grid want, or is damaged; save the file again",
                array.name, array.kind
            );
            Fault::inconsistent(array.at, message)
        };
        let mut source = self.source(array).ok_or_else(wrong)?;
        let length = count.checked_mul(SIZE).ok_or_else(wrong)?;
        let bytes = if self.compressed { self.inflated(&mut source, length) } else { self.plain(&mut source, length) };
        let in_order = |group: &[u8]| {
            let mut bytes = [0; SIZE];
            bytes.copy_from_slice(group);
            if self.big_endian {
                bytes.reverse();
            }
            number(bytes)
        };
        Ok(bytes.ok_or_else(wrong)?.chunks_exact(SIZE).map(in_order).collect())
    }

    /// A number in the head of an array.
    fn word(&self, source: &mut Source) -> Option<usize> {
        let mut bytes = source.take(self.word)?;
        if !self.big_endian {
            bytes.reverse();
        }
        usize::try_from(bytes.into_iter().fold(0u64, |number, byte| number << 8 | u64::from(byte))).ok()
    }

    fn plain(&self, source: &mut Source, length: usize) -> Option<Vec<u8>> {
        (self.word(source)? == length).then(|| source.take(length))?
    }

    /// Blocks of zlib; no more than `length` bytes are made of them.
    fn inflated(&self, source: &mut Source, length: usize) -> Option<Vec<u8>> {
        let [blocks, _size, _last] = [self.word(source)?, self.word(source)?, self.word(source)?];
        let mut sizes = Vec::new();
        for _ in 0..blocks {
            sizes.push(self.word(source)?);
        }
        let mut bytes = Vec::new();
        for size in sizes {
            let block = source.take(size)?;
            let room = (length - bytes.len()) as u64 + 1;
            flate2::read::ZlibDecoder::new(&block[..]).take(room).read_to_end(&mut bytes).ok()?;
            if bytes.len() > length {
                return None;
            }
        }
        (bytes.len() == length).then_some(bytes)
    }
}

/// Numbers written as text.
fn parsed<N>(
    array: &Array,
    text: &[u8],
    count: usize,
    expected: &str,
    number: impl Fn(&str) -> Option<N>,
) -> Result<Vec<N>, Fault> {
    let words = text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    let read = |word: &[u8]| {
        let wrong = || Fault::unexpected(array.at, format!("{} in array \"{}\"", quote(word), array.name), expected);
        std::str::from_utf8(word).ok().and_then(&number).ok_or_else(wrong)
    };
    let numbers = words.map(read).collect::<Result<Vec<N>, Fault>>()?;
    if numbers.len() != count {
        let message =
            format!("array \"{}\" has {} numbers; the sizes of the grid want {count}", array.name, numbers.len());
        return Err(Fault::inconsistent(array.at, message));
    }
    Ok(numbers)
}

/// Bytes one after the other, stored as they are or in base64.
struct Source<'a> {
    data: &'a [u8],
    encoded: bool,
    /// Decoded bytes that nobody took yet.
    pending: Vec<u8>,
}

impl Source<'_> {
    /// The next bytes; none where fewer are left.
    fn take(&mut self, count: usize) -> Option<Vec<u8>> {
        if !self.encoded {
            let (taken, rest) = self.data.split_at_checked(count)?;
            self.data = rest;
            return Some(taken.to_vec());
        }
        let mut bytes = std::mem::take(&mut self.pending);
        while bytes.len() < count {
            bytes.extend_from_slice(&self.group()?);
        }
        self.pending = bytes.split_off(count);
        Some(bytes)
    }

    /// The one to three bytes of four letters. Padding may end a part of the data: the next part goes on behind it.
    fn group(&mut self) -> Option<Vec<u8>> {
        let mut bits = 0u32;
        let mut letters = 0;
        let mut padding = 0;
        while letters + padding < 4 {
            let (&letter, rest) = self.data.split_first()?;
            self.data = rest;
            let value = match letter {
                b'A'..=b'Z' => letter - b'A',
                b'a'..=b'z' => letter - b'a' + 26,
                b'0'..=b'9' => letter - b'0' + 52,
                b'+' => 62,
                b'/' => 63,
                b'=' if letters >= 2 => {
                    padding += 1;
                    continue;
                }
                _ if letter.is_ascii_whitespace() => continue,
                _ => return None,
            };
            if padding > 0 {
                return None;
            }
            letters += 1;
            bits = bits << 6 | u32::from(value);
        }
        let [_, bytes @ ..] = (bits << (6 * padding)).to_be_bytes();
        Some(bytes[..3 - padding].to_vec())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The test vectors of RFC 4648, section 10, one behind the other.
    #[test]
    fn base64_goes_on_behind_padding() {
        let mut source = Source { data: b"Zg==Zm8=\n Zm9v Zm9vYg==", encoded: true, pending: Vec::new() };
        for part in ["f", "fo", "foof", "oob"] {
            assert_eq!(source.take(part.len()).as_deref(), Some(part.as_bytes()));
        }
        assert_eq!(source.take(1), None);
        for wrong in ["Zg=A", "Z===", "Zm9", "Zm!v"] {
            assert_eq!(Source { data: wrong.as_bytes(), encoded: true, pending: Vec::new() }.take(1), None, "{wrong}");
        }
    }
}
