//! Further files that an input file names, in the place where it does.

use super::deck::{self, Line};
use crate::mesh::list;
use crate::tagged::cursor::Cursor;
use crate::tagged::error::{Fault, MeshError, Place, Problem};
use crate::{GIT_LFS, IS_POINTER, Mesh, read_mesh};

/// Files within files beyond which one is refused: it may name itself.
const DEEPEST: usize = 8;
/// Further files in all.
const MOST: usize = 1000;
/// Keywords whose data may stand in a file of their own.
const WITH_INPUT: [&str; 5] = ["NODE", "ELEMENT", "NSET", "ELSET", "SURFACE"];

/// A mesh file, in which further files stand where it names them: those of `*INCLUDE` and of `INPUT=` in an Abaqus input file.
pub struct Gathered {
    bytes: Vec<u8>,
    /// Stretches that are of one file; none where there is one file only.
    stretches: Vec<Stretch>,
    /// What to say of files that could not be read.
    missing: Vec<String>,
}

/// Lines that follow each other in one file.
struct Stretch {
    /// Its first line in what was gathered, from 1.
    first: usize,
    /// The file; none for the one that names the others.
    file: Option<String>,
    /// The same line there.
    own: usize,
}

impl Gathered {
    /// Puts further files where a mesh file names them. Those that cannot be read may have steps and materials alone: they are left out,
    /// and a notice of the mesh tells so.
    ///
    /// - `read`: the bytes of a further file by the name that stands there, or why there are none
    ///
    /// # Errors
    /// With the place, for keywords without the name of a file, and for many or deeply nested files.
    pub fn new(bytes: Vec<u8>, mut read: impl FnMut(&str) -> Result<Vec<u8>, String>) -> Result<Self, MeshError> {
        let mut cursor = Cursor::new(&bytes);
        cursor.skip_byte_order_mark();
        if cursor.line().is_none_or(|(_, line)| !line.starts_with(b"*")) || !names_files(&bytes) {
            return Ok(Gathered { bytes, stretches: Vec::new(), missing: Vec::new() });
        }
        let all = Gathered { bytes: Vec::new(), stretches: Vec::new(), missing: Vec::new() };
        let mut gatherer = Gatherer { read: &mut read, all, lines: 1, files: 0 };
        gatherer.add(&bytes, None, 0)?;
        Ok(gatherer.all)
    }

    /// All files in one.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Reads the mesh.
    ///
    /// # Errors
    /// As [`read_mesh`], with the line in the file that it is in.
    pub fn read(&self) -> Result<Mesh, MeshError> {
        let mut mesh = read_mesh(&self.bytes).map_err(|error| self.placed(error))?;
        mesh.notices.extend(self.missing.iter().map(|missing| format!("{missing}: read without it")));
        Ok(mesh)
    }

    /// The error as one of the file that its line is in.
    fn placed(&self, MeshError { place: at, mut problem }: MeshError) -> MeshError {
        if !self.missing.is_empty() {
            let missing = list(&self.missing);
            problem = Problem::Unsupported(format!("{problem}; {missing}: put these files in their places"));
        }
        let Place::Line(line) = at else { return MeshError { place: at, problem } };
        let after = self.stretches.partition_point(|stretch| stretch.first <= line);
        let stretch = after.checked_sub(1).map(|index| &self.stretches[index]);
        let own = |Stretch { first, file, own }: &Stretch| place(file.as_deref(), own + line - first);
        MeshError { place: stretch.map_or(at, own), problem }
    }
}

fn place(file: Option<&str>, line: usize) -> Place {
    file.map_or(Place::Line(line), |file| Place::LineOf(file.to_owned(), line))
}

/// Whether some keyword may name a file; false saves copying.
fn names_files(bytes: &[u8]) -> bool {
    bytes.windows(5).any(|word| word.eq_ignore_ascii_case(b"INPUT") || word.eq_ignore_ascii_case(b"INCLU"))
}

struct Gatherer<'r> {
    read: &'r mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
    all: Gathered,
    /// The line that comes next, from 1.
    lines: usize,
    files: usize,
}

impl Gatherer<'_> {
    /// Adds a file and those that it names.
    fn add(&mut self, bytes: &[u8], file: Option<&str>, depth: usize) -> Result<(), MeshError> {
        let mut cursor = Cursor::new(bytes);
        let (mut from, mut line) = (0, 1);
        while let Some((at, text)) = cursor.line() {
            if !text.starts_with(b"*") || text.starts_with(b"**") {
                continue;
            }
            let before = cursor.at;
            cursor.at = at;
            let Ok(Some(Line::Keyword(keyword))) = deck::next(&mut cursor) else {
                cursor.at = before;
                continue;
            };
            let is_include = keyword.name == "INCLUDE";
            if !is_include && !WITH_INPUT.contains(&keyword.name.as_str()) {
                continue;
            }
            let own = line + newlines(&bytes[from..at]);
            let refuse = |message: String| {
                let problem = Fault::unsupported(at, message).problem;
                MeshError { place: place(file, own), problem }
            };
            let name = match keyword.get("INPUT") {
                Some(name) if !name.is_empty() => name,
                None if !is_include => continue,
                _ => return Err(refuse(format!("*{} names no file; expected INPUT=FILE", keyword.name))),
            };
            self.files += 1;
            if depth == DEEPEST || self.files > MOST {
                let message = format!(
                    "*{} names \"{name}\" as a further file after {} others, {depth} within each other; fractum reads {MOST}, \
                     {DEEPEST} within each other: does it name itself?",
                    keyword.name,
                    self.files - 1
                );
                return Err(refuse(message));
            }
            let more = match (self.read)(name) {
                Ok(more) if more.starts_with(GIT_LFS) => Err(format!("it is{IS_POINTER}")),
                other => other,
            };
            self.push(&bytes[from..if is_include { at } else { cursor.at }], file, line);
            self.end_line();
            line += newlines(&bytes[from..cursor.at]);
            from = cursor.at;
            match more {
                Ok(more) => self.add(&more, Some(name), depth + 1)?,
                Err(why) => {
                    let at = place(file, own);
                    self.all
                        .missing
                        .push(format!("{at}: *{} names \"{name}\", which cannot be read ({why})", keyword.name));
                }
            }
            self.end_line();
        }
        self.push(&bytes[from..], file, line);
        Ok(())
    }

    /// Adds lines of a file.
    ///
    /// - `own`: number of the first of them there
    fn push(&mut self, bytes: &[u8], file: Option<&str>, own: usize) {
        let text = bytes.strip_prefix(fractum_vtk::text::BYTE_ORDER_MARK).unwrap_or(bytes);
        self.all.stretches.push(Stretch { first: self.lines, file: file.map(str::to_owned), own });
        self.all.bytes.extend_from_slice(text);
        self.lines += newlines(text);
    }

    fn end_line(&mut self) {
        if self.all.bytes.last().is_some_and(|byte| *byte != b'\n') {
            self.all.bytes.push(b'\n');
            self.lines += 1;
        }
    }
}

fn newlines(bytes: &[u8]) -> usize {
    bytes.iter().filter(|&&byte| byte == b'\n').count()
}
