//! Reading the VTK files of a results folder again.

use std::fs;
use std::io;
use std::path::Path;

use fractum_vtk::{Arrays, Collection, PieceList};

use crate::error::ReadError;

/// Reads the arrays of these names, and nothing else of a file; what is not there is left out. The pieces that a PVTU or
/// PVTP lists come as the whole that they were cut from.
///
/// # Errors
/// [`ReadError`]: no such file, or none that this program wrote.
pub fn read_arrays(path: &Path, wanted: &[&str]) -> Result<Arrays, ReadError> {
    if path.extension().is_some_and(|ending| ending == "pvtu" || ending == "pvtp") {
        return read_pieces(path, wanted);
    }
    Arrays::read(&fs::read(path).map_err(|error| refused(path, error))?, wanted).ok_or_else(|| damaged(path))
}

fn read_pieces(path: &Path, wanted: &[&str]) -> Result<Arrays, ReadError> {
    let text = fs::read_to_string(path).map_err(|error| refused(path, error))?;
    let list = PieceList::parse(&text).ok_or_else(|| damaged(path))?;
    let names = [wanted, &[PieceList::NUMBERS]].concat();
    let folder = path.parent().unwrap_or(Path::new(""));
    let read = |piece: &String| read_arrays(&folder.join(piece), &names);
    let pieces = list.pieces.iter().map(read).collect::<Result<Vec<_>, _>>()?;
    list.joined(&pieces, wanted).map_err(|piece| damaged(&folder.join(&list.pieces[piece])))
}

/// Reads a `fields.pvd`.
///
/// # Errors
/// [`ReadError`].
pub fn read_collection(path: &Path) -> Result<Collection, ReadError> {
    let text = fs::read_to_string(path).map_err(|error| refused(path, error))?;
    Collection::parse(&text).ok_or_else(|| damaged(path))
}

fn damaged(path: &Path) -> ReadError {
    let text = "this is no whole VTK file of this program";
    refused(path, io::Error::new(io::ErrorKind::InvalidData, text))
}

fn refused(path: &Path, source: io::Error) -> ReadError {
    ReadError::Refused { path: path.to_owned(), source }
}
