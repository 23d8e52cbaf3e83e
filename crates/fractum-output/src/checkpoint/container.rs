//! The bytes of a checkpoint.
//!
//! Little-endian: magic (8 bytes), format (u32), length of the header (u32), header (postcard), checksum of all that;
//! then blocks of the state (postcard): raw length (u32, positive), stored length (u32), checksum (u32), stored bytes,
//! which are a zlib stream where the stored length is below the raw length; then an end mark of the same form: raw
//! length 0, stored length 8, checksum, and the raw length of the whole state (u64). A block's checksum covers its
//! number, its lengths and its bytes, so that no block can be lost, doubled or moved.

use std::fmt;
use std::io::{self, Read, Write};
use std::path::Path;

use fractum_vtk::{Compression, compressor, deflate};
use rayon::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{CheckpointError, FORMAT, Header};
use crate::memory::{self, TooLarge};

/// As PNG's: a transfer that strips the eighth bit or converts line ends is noticed at once.
const MAGIC: &[u8; 8] = b"\x89FCK\r\n\x1a\n";
const BLOCK: usize = 1 << 20;
/// Blocks gathered before they are compressed together.
const GROUP: usize = 16;

/// Why writing failed.
pub(super) enum Failure {
    Io(io::Error),
    Serialiser(String),
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

/// Writes a whole checkpoint.
pub(super) fn write<T: Serialize>(
    file: &mut impl Write,
    header: &Header,
    state: &T,
    compression: Compression,
) -> Result<(), Failure> {
    let mut start = MAGIC.to_vec();
    let header = postcard::to_stdvec(header).map_err(|error| Failure::Serialiser(error.to_string()))?;
    start.extend_from_slice(&FORMAT.to_le_bytes());
    start.extend_from_slice(&(header.len() as u32).to_le_bytes());
    start.extend_from_slice(&header);
    let checksum = crc32fast::hash(&start);
    file.write_all(&start)?;
    file.write_all(&checksum.to_le_bytes())?;

    let mut blocks = BlockWriter { file, compression, pending: Vec::new(), written: 0, total: 0, error: None };
    let result = postcard::to_io(state, &mut blocks).map(|_| ());
    match (blocks.error.take(), result) {
        (Some(error), _) => return Err(Failure::Io(error)),
        (None, Err(error)) => return Err(Failure::Serialiser(error.to_string())),
        (None, Ok(())) => {}
    }
    blocks.flush_pending()?;
    let (number, total) = (blocks.written, blocks.total.to_le_bytes());
    file.write_all(&block_head(number, 0, &total))?;
    file.write_all(&total)?;
    Ok(())
}

/// Takes the serialiser's bytes and writes them block by block.
struct BlockWriter<'a, W> {
    file: &'a mut W,
    compression: Compression,
    pending: Vec<u8>,
    written: u32,
    total: u64,
    /// The serialiser keeps no cause of a failed write; it is kept here.
    error: Option<io::Error>,
}

impl<W: Write> BlockWriter<'_, W> {
    fn flush_pending(&mut self) -> io::Result<()> {
        let stored: Vec<(u32, std::borrow::Cow<[u8]>)> = self
            .pending
            .par_chunks(BLOCK)
            .map_init(compressor, |compressor, raw| {
                let smaller = match self.compression {
                    Compression::None => None,
                    Compression::Fast => Some(deflate(compressor, raw)).filter(|stored| stored.len() < raw.len()),
                };
                (raw.len() as u32, smaller.map_or(raw.into(), Into::into))
            })
            .collect();
        for (raw_length, stored) in stored {
            self.file.write_all(&block_head(self.written, raw_length, &stored))?;
            self.file.write_all(&stored)?;
            self.written += 1;
            self.total += u64::from(raw_length);
        }
        self.pending.clear();
        Ok(())
    }
}

impl<W: Write> Write for BlockWriter<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // Whole groups only: where a group ends must not depend on how the serialiser cuts its writes.
        let taken = bytes.len().min(GROUP * BLOCK - self.pending.len());
        self.pending.extend_from_slice(&bytes[..taken]);
        if self.pending.len() == GROUP * BLOCK
            && let Err(error) = self.flush_pending()
        {
            let kind = error.kind();
            self.error = Some(error);
            return Err(kind.into());
        }
        Ok(taken)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Raw length, stored length and checksum of block `number`.
fn block_head(number: u32, raw_length: u32, stored: &[u8]) -> [u8; 12] {
    let mut head = [0; 12];
    head[..4].copy_from_slice(&raw_length.to_le_bytes());
    head[4..8].copy_from_slice(&(stored.len() as u32).to_le_bytes());
    let mut checksum = crc32fast::Hasher::new();
    checksum.update(&number.to_le_bytes());
    checksum.update(&head[..8]);
    checksum.update(stored);
    head[8..].copy_from_slice(&checksum.finalize().to_le_bytes());
    head
}

/// Why bytes are refused.
pub(super) enum Refusal {
    NotACheckpoint,
    OtherFormat(u32),
    Truncated,
    Corrupt(String),
    OtherLayout(String),
    TooLarge(TooLarge),
}

impl Refusal {
    pub(super) fn at(self, path: &Path) -> CheckpointError {
        let path = path.to_path_buf();
        match self {
            Self::NotACheckpoint => CheckpointError::NotACheckpoint { path },
            Self::OtherFormat(found) => CheckpointError::OtherFormat { path, found },
            Self::Truncated => CheckpointError::Truncated { path },
            Self::Corrupt(what) => CheckpointError::Corrupt { path, what },
            Self::OtherLayout(reason) => CheckpointError::OtherLayout { path, reason },
            Self::TooLarge(source) => CheckpointError::TooLarge { path, source },
        }
    }

    fn layout(reason: impl fmt::Display) -> Self {
        Self::OtherLayout(reason.to_string())
    }
}

/// The header, and the bytes after it.
pub(super) fn read_header(bytes: &[u8]) -> Result<(Header, &[u8]), Refusal> {
    let known = bytes.len().min(MAGIC.len());
    if bytes[..known] != MAGIC[..known] {
        return Err(Refusal::NotACheckpoint);
    }
    let mut rest = bytes;
    take(&mut rest, MAGIC.len())?;
    let format = take_u32(&mut rest)?;
    if format != FORMAT {
        return Err(Refusal::OtherFormat(format));
    }
    let length = take_u32(&mut rest)? as usize;
    let header = take(&mut rest, length)?;
    let checked = &bytes[..bytes.len() - rest.len()];
    if take_u32(&mut rest)? != crc32fast::hash(checked) {
        return Err(Refusal::Corrupt("header".into()));
    }
    Ok((postcard::from_bytes(header).map_err(Refusal::layout)?, rest))
}

/// The state, from the bytes after the header.
pub(super) fn read_state<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, Refusal> {
    let mut rest = bytes;
    let mut blocks = Vec::new();
    let total = loop {
        let number = blocks.len() as u32;
        let corrupt = || Refusal::Corrupt(format!("block {number}"));
        let head = take(&mut rest, 12)?;
        let raw_length = take_u32(&mut &head[..4])?;
        let stored_length = take_u32(&mut &head[4..8])?;
        // Before the checksum, which a cut-off file cannot have: a length beyond what a block may hold is damage.
        if raw_length as usize > BLOCK || stored_length > raw_length.max(8) {
            return Err(corrupt());
        }
        let stored = take(&mut rest, stored_length as usize)?;
        if head != block_head(number, raw_length, stored) {
            return Err(corrupt());
        }
        if raw_length == 0 {
            break u64::from_le_bytes(stored.try_into().map_err(|_| corrupt())?);
        }
        blocks.push((raw_length as usize, stored));
    };
    if !rest.is_empty() {
        return Err(Refusal::Corrupt("bytes after the end".into()));
    }
    let length: usize = blocks.iter().map(|(raw_length, _)| raw_length).sum();
    if length as u64 != total {
        return Err(Refusal::Corrupt("length of the state".into()));
    }
    // The bytes of the state, and the state that is read from them.
    memory::require(2 * total, "reading the checkpoint").map_err(Refusal::TooLarge)?;
    let mut state = vec![0; length];
    let mut rooms = Vec::with_capacity(blocks.len());
    let mut rest = &mut state[..];
    for &(raw_length, _) in &blocks {
        let (room, after) = std::mem::take(&mut rest).split_at_mut(raw_length);
        rooms.push(room);
        rest = after;
    }
    blocks.par_iter().zip(rooms).enumerate().try_for_each(|(number, (&(_, stored), room))| {
        inflate(stored, room).ok_or_else(|| Refusal::Corrupt(format!("block {number}")))
    })?;
    match postcard::take_from_bytes(&state) {
        Ok((state, [])) => Ok(state),
        Ok((_, rest)) => Err(Refusal::OtherLayout(format!("{} bytes too many", rest.len()))),
        Err(error) => Err(Refusal::layout(error)),
    }
}

/// Fills `room` with the bytes of a block; none if it holds more or fewer.
fn inflate(stored: &[u8], room: &mut [u8]) -> Option<()> {
    if stored.len() == room.len() {
        room.copy_from_slice(stored);
        return Some(());
    }
    let mut stream = flate2::read::ZlibDecoder::new(stored);
    stream.read_exact(room).ok()?;
    // The stream must end here.
    (stream.read(&mut [0]).ok()? == 0).then_some(())
}

fn take<'a>(rest: &mut &'a [u8], length: usize) -> Result<&'a [u8], Refusal> {
    let (taken, after) = rest.split_at_checked(length).ok_or(Refusal::Truncated)?;
    *rest = after;
    Ok(taken)
}

fn take_u32(rest: &mut &[u8]) -> Result<u32, Refusal> {
    let bytes = take(rest, 4)?;
    Ok(bytes.try_into().map(u32::from_le_bytes).unwrap_or_default())
}

/// A checkpoint of so many blocks of zeros.
#[cfg(test)]
pub(super) fn inflating_to(header: &Header, blocks: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    assert!(write(&mut bytes, header, &(), Compression::Fast).is_ok());
    bytes.truncate(bytes.len() - 20);
    let stored = deflate(&mut compressor(), &[0; BLOCK]);
    for number in 0..blocks {
        bytes.extend(block_head(number as u32, BLOCK as u32, &stored));
        bytes.extend(&stored);
    }
    let total = (blocks * BLOCK as u64).to_le_bytes();
    bytes.extend(block_head(blocks as u32, 0, &total));
    bytes.extend(total);
    bytes
}
