use std::io::{self, BufWriter, Write};

/// Writes numbers as text, one record to a line, or as little-endian bytes.
pub(super) struct Sink<W: Write> {
    out: BufWriter<W>,
    binary: bool,
    line_open: bool,
}

impl<W: Write> Sink<W> {
    pub(super) fn new(out: W, binary: bool) -> Self {
        Sink { out: BufWriter::with_capacity(1 << 16, out), binary, line_open: false }
    }

    pub(super) fn is_binary(&self) -> bool {
        self.binary
    }

    /// Text as it is, in both encodings.
    pub(super) fn text(&mut self, text: &str) -> io::Result<()> {
        self.out.write_all(text.as_bytes())
    }

    fn separate(&mut self) -> io::Result<()> {
        if std::mem::replace(&mut self.line_open, true) { self.out.write_all(b" ") } else { Ok(()) }
    }

    pub(super) fn int(&mut self, value: i32) -> io::Result<()> {
        if self.binary {
            return self.out.write_all(&value.to_le_bytes());
        }
        self.separate()?;
        write!(self.out, "{value}")
    }

    pub(super) fn word(&mut self, value: u64) -> io::Result<()> {
        if self.binary {
            return self.out.write_all(&value.to_le_bytes());
        }
        self.separate()?;
        write!(self.out, "{value}")
    }

    /// Text has the fewest digits that read back to the same value.
    pub(super) fn real(&mut self, value: f64) -> io::Result<()> {
        if self.binary {
            return self.out.write_all(&value.to_le_bytes());
        }
        self.separate()?;
        write!(self.out, "{value:?}")
    }

    /// Ends a line of text.
    pub(super) fn end_record(&mut self) -> io::Result<()> {
        self.line_open = false;
        if self.binary { Ok(()) } else { self.out.write_all(b"\n") }
    }

    /// Ends a block of bytes, so that the closing line of the section starts a line.
    pub(super) fn end_block(&mut self) -> io::Result<()> {
        if self.binary { self.out.write_all(b"\n") } else { Ok(()) }
    }

    pub(super) fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}
