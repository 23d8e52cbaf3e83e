use crate::tagged::cursor::{Cursor, What};
use crate::tagged::error::Fault;

/// How numbers are stored in a binary file. Integers take four bytes and reals eight everywhere; MSH 4.1 counts and
/// tags take a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    /// Most significant byte first.
    pub(super) big_endian: bool,
    /// Bytes of a word: 4 or 8.
    pub(super) word: usize,
}

impl Layout {
    pub(super) fn i32(self, bytes: &[u8]) -> i32 {
        let value = bytes.try_into().expect("four bytes");
        if self.big_endian { i32::from_be_bytes(value) } else { i32::from_le_bytes(value) }
    }

    pub(super) fn f64(self, bytes: &[u8]) -> f64 {
        let value = bytes.try_into().expect("eight bytes");
        if self.big_endian { f64::from_be_bytes(value) } else { f64::from_le_bytes(value) }
    }

    /// A count or tag of MSH 4.1.
    pub(super) fn word(self, bytes: &[u8]) -> u64 {
        if self.word == 8 {
            let value = bytes.try_into().expect("eight bytes");
            if self.big_endian { u64::from_be_bytes(value) } else { u64::from_le_bytes(value) }
        } else {
            self.i32(bytes) as u32 as u64
        }
    }

    pub(super) fn take_i32(self, cursor: &mut Cursor, noun: &'static str) -> Result<i32, Fault> {
        cursor.take(4, What::one(noun)).map(|bytes| self.i32(bytes))
    }

    pub(super) fn take_word(self, cursor: &mut Cursor, noun: &'static str) -> Result<u64, Fault> {
        cursor.take(self.word, What::one(noun)).map(|bytes| self.word(bytes))
    }
}
