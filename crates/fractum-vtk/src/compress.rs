//! Compression shared by the binary outputs: zlib at its fastest level, block by block.

use flate2::{Compress, Compression as Level, FlushCompress, Status};
use serde::{Deserialize, Serialize};

/// Whether arrays and states are compressed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Compression {
    /// Raw bytes: fastest where the disk is.
    None,
    /// zlib at its fastest level.
    #[default]
    Fast,
}

/// A compressor to be reused for many blocks.
pub fn compressor() -> Compress {
    Compress::new(Level::fast(), true)
}

/// `block` as a zlib stream of its own.
pub fn deflate(compressor: &mut Compress, block: &[u8]) -> Vec<u8> {
    compressor.reset();
    // Deflate never adds more than a few bytes per 16 KiB; the loop is there should a back end need more.
    let mut stored = Vec::with_capacity(block.len() + block.len() / 1000 + 64);
    loop {
        let done = compressor.total_in() as usize;
        match compressor.compress_vec(&block[done..], &mut stored, FlushCompress::Finish) {
            Ok(Status::StreamEnd) => return stored,
            _ => stored.reserve(block.len() / 2 + 64),
        }
    }
}
