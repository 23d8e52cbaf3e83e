//! Checkpoints: the whole state of a run in one file, from which it continues bit for bit.
//!
//! A checkpoint is `state-<step>.fck` in the folder `checkpoint`. It is written whole or not at all, and the one before
//! it stays, so that a run killed at any moment finds its last state. Only the program, case and mesh that wrote it may
//! read it; every byte is covered by a checksum. Several processes may write parts of it beforehand,
//! `state-<step>.part-<process>.fck`, each in the same form.
//!
//! ```
//! use fractum_output::checkpoint::{Header, Identity, load_latest, save};
//! use fractum_vtk::Compression;
//! # let folder = tempfile::tempdir().unwrap();
//! # let folder = folder.path();
//! let identity = Identity { program: "0.1.0".into(), case_hash: 1, mesh_hash: 2 };
//! let state = vec![0.1, 0.2];
//! save(folder, &Header { identity: identity.clone(), step: 40, time: 1e-4 }, &state, Compression::Fast)?;
//! let found = load_latest::<Vec<f64>>(folder, &identity)?.unwrap();
//! assert_eq!((found.header.step, found.state), (40, state));
//! # Ok::<(), fractum_output::checkpoint::CheckpointError>(())
//! ```

mod container;
mod error;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use fractum_vtk::Compression;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

pub use error::CheckpointError;

use crate::atomic::{self, UNFINISHED};
use crate::error::WriteError;

/// Version of the container's format.
pub const FORMAT: u32 = 18;

/// What a state belongs to. A state of another program version, case or mesh is refused.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Version of the program, as exact as the layout of its state needs.
    pub program: String,
    /// Hash of everything in the case that the result depends on.
    pub case_hash: u128,
    /// Hash of the mesh.
    pub mesh_hash: u128,
}

/// What a checkpoint says of itself before its state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// What the state belongs to.
    pub identity: Identity,
    /// Steps done.
    pub step: u64,
    /// Simulated time [s].
    pub time: f64,
}

/// A state that was read, and what was passed over to find it.
#[derive(Debug)]
pub struct Loaded<T> {
    /// What the checkpoint says of itself.
    pub header: Header,
    /// The state.
    pub state: T,
    /// The file it is from.
    pub path: PathBuf,
    /// Newer checkpoints that had to be passed over, newest first, each with the reason. The user wants to know.
    pub passed_over: Vec<CheckpointError>,
}

/// Saves `state` as `state-<step>.fck` in `folder` (created if absent) and returns the file's path.
///
/// Of the older checkpoints the newest stays; the others go, and so do those of later steps: they belong to a past that
/// this run did not take.
///
/// # Errors
/// [`CheckpointError::Write`], [`CheckpointError::NotStorable`]; the former checkpoints are then untouched.
pub fn save<T: Serialize>(
    folder: &Path,
    header: &Header,
    state: &T,
    compression: Compression,
) -> Result<PathBuf, CheckpointError> {
    let path = folder.join(format!("state-{:09}.fck", header.step));
    write(folder, &path, header, state, compression)?;
    // The new state is safe: what cannot be removed does no harm.
    let _ = remove_outdated(folder, header.step);
    Ok(path)
}

/// Saves the part of one of several processes, before the first of them saves the state that needs all parts.
///
/// # Errors
/// As [`save`].
pub fn save_part<T: Serialize>(
    folder: &Path,
    header: &Header,
    process: usize,
    part: &T,
    compression: Compression,
) -> Result<(), CheckpointError> {
    write(folder, &part_path(folder, header.step, process), header, part, compression)
}

/// Reads the parts of a state.
///
/// # Errors
/// As [`load`]; [`CheckpointError::OtherStep`] for a part of another state.
pub fn load_parts<T: DeserializeOwned>(
    folder: &Path,
    identity: &Identity,
    step: u64,
    count: usize,
) -> Result<Vec<T>, CheckpointError> {
    let part = |process: usize| {
        let path = part_path(folder, step, process);
        let (header, part) = load(&path, identity)?;
        if header.step == step { Ok(part) } else { Err(CheckpointError::OtherStep { path, found: header.step }) }
    };
    (0..count).map(part).collect()
}

fn part_path(folder: &Path, step: u64, process: usize) -> PathBuf {
    folder.join(format!("state-{step:09}.part-{process:04}.fck"))
}

fn write<T: Serialize>(
    folder: &Path,
    path: &Path,
    header: &Header,
    state: &T,
    compression: Compression,
) -> Result<(), CheckpointError> {
    atomic::create_folder(folder)?;
    let mut not_storable = None;
    atomic::write_with(path, |file| {
        container::write(file, header, state, compression).map_err(|error| match error {
            container::Failure::Io(error) => error,
            container::Failure::Serialiser(reason) => {
                not_storable = Some(reason);
                io::ErrorKind::InvalidData.into()
            }
        })
    })
    .map_err(|error| match not_storable {
        Some(reason) => CheckpointError::NotStorable { reason },
        None => error.into(),
    })
}

/// Reads the newest checkpoint in `folder` that is whole and belongs to `identity`; `None` if there is no checkpoint.
///
/// # Errors
/// If there are checkpoints but none that can be used: why the newest cannot.
pub fn load_latest<T: DeserializeOwned>(
    folder: &Path,
    identity: &Identity,
) -> Result<Option<Loaded<T>>, CheckpointError> {
    load_latest_with(folder, identity, |_, state| Ok(state))
}

/// [`load_latest`] of states that need more than one file; a state is passed over like one that is not whole where `complete` fails.
///
/// # Errors
/// As [`load_latest`].
pub fn load_latest_with<S: DeserializeOwned, T>(
    folder: &Path,
    identity: &Identity,
    complete: impl Fn(&Header, S) -> Result<T, CheckpointError>,
) -> Result<Option<Loaded<T>>, CheckpointError> {
    let unreadable = |source| CheckpointError::Unreadable { path: folder.to_path_buf(), source };
    let mut found = match checkpoints(folder) {
        Ok(found) => found,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(unreadable(error)),
    };
    found.sort();
    let mut passed_over = Vec::new();
    for (_, path) in found.into_iter().rev() {
        let whole = load(&path, identity).and_then(|(header, state)| Ok((complete(&header, state)?, header)));
        match whole {
            Ok((state, header)) => return Ok(Some(Loaded { header, state, path, passed_over })),
            Err(error) => passed_over.push(error),
        }
    }
    match passed_over.into_iter().next() {
        Some(newest) => Err(newest),
        None => Ok(None),
    }
}

/// Reads the checkpoint at `path`, if it belongs to `identity`.
///
/// # Errors
/// [`CheckpointError`]: unreadable, not a checkpoint, of another format, program, case or mesh, cut off, or damaged.
pub fn load<T: DeserializeOwned>(path: &Path, identity: &Identity) -> Result<(Header, T), CheckpointError> {
    let bytes = fs::read(path).map_err(|source| CheckpointError::Unreadable { path: path.to_path_buf(), source })?;
    let (header, rest) = container::read_header(&bytes).map_err(|refusal| refusal.at(path))?;
    let path_buf = || path.to_path_buf();
    let Identity { program, case_hash, mesh_hash } = &header.identity;
    if program != &identity.program {
        let (found, expected) = (program.clone(), identity.program.clone());
        return Err(CheckpointError::OtherProgram { path: path_buf(), found, expected });
    }
    if *case_hash != identity.case_hash {
        return Err(CheckpointError::OtherCase { path: path_buf() });
    }
    if *mesh_hash != identity.mesh_hash {
        return Err(CheckpointError::OtherMesh { path: path_buf() });
    }
    let state = container::read_state(rest).map_err(|refusal| refusal.at(path))?;
    Ok((header, state))
}

/// Whether `folder` holds a checkpoint. What a killed run has left unfinished is none.
pub fn is_there(folder: &Path) -> bool {
    checkpoints(folder).is_ok_and(|found| !found.is_empty())
}

/// Step and file of the newest checkpoint in `folder`.
pub fn newest(folder: &Path) -> Option<(u64, PathBuf)> {
    checkpoints(folder).ok()?.into_iter().max()
}

/// Checkpoints in `folder` with their steps.
fn checkpoints(folder: &Path) -> io::Result<Vec<(u64, PathBuf)>> {
    files(folder, |name| name.parse().ok())
}

/// Parts of checkpoints in `folder` with their steps.
fn parts(folder: &Path) -> io::Result<Vec<(u64, PathBuf)>> {
    files(folder, |name| name.split_once(".part-")?.0.parse().ok())
}

/// Files of states whose steps are in their names.
fn files(folder: &Path, step: impl Fn(&str) -> Option<u64>) -> io::Result<Vec<(u64, PathBuf)>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name();
        let of = |name: &str| step(name.strip_prefix("state-")?.strip_suffix(".fck")?);
        found.extend(name.to_str().and_then(of).map(|step| (step, entry.path())));
    }
    Ok(found)
}

/// Removes all checkpoints of `folder`, and the folder once nothing else is in it: other files are the user's, and stay.
///
/// # Errors
/// [`WriteError`]; a folder that is not there is none.
pub fn discard(folder: &Path) -> Result<(), WriteError> {
    if !folder.is_dir() {
        return Ok(());
    }
    let error = |error| WriteError::new(folder, error);
    let found = checkpoints(folder).and_then(|found| Ok(found.into_iter().chain(parts(folder)?))).map_err(error)?;
    found.into_iter().try_for_each(|(_, path)| fs::remove_file(path)).map_err(error)?;
    remove_unfinished(folder).map_err(error)?;
    match fs::remove_dir(folder) {
        Err(found) if found.kind() != io::ErrorKind::DirectoryNotEmpty => Err(error(found)),
        _ => Ok(()),
    }
}

/// Removes all but the checkpoint of `step` and the newest before it, with their parts, and what killed runs left unfinished.
fn remove_outdated(folder: &Path, step: u64) -> io::Result<()> {
    let mut found = checkpoints(folder)?;
    found.sort();
    let previous = found.iter().map(|(step, _)| *step).filter(|&other| other < step).max();
    for (other, path) in found.into_iter().chain(parts(folder)?) {
        if other != step && Some(other) != previous {
            fs::remove_file(path)?;
        }
    }
    remove_unfinished(folder)
}

/// Removes what killed runs left unfinished.
fn remove_unfinished(folder: &Path) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        if name.starts_with("state-") && name.ends_with(UNFINISHED) {
            fs::remove_file(path)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory;
    use proptest::prelude::*;

    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    struct State {
        clock: f64,
        positions: Vec<[f64; 3]>,
        broken: Vec<bool>,
        name: String,
    }

    fn state(size: usize) -> State {
        State {
            clock: 0.1 + 0.2,
            positions: (0..size).map(|i| [(i as f64).sin(), f64::MIN_POSITIVE / 4.0, -0.0]).collect(),
            broken: (0..size).map(|i| i % 3 == 0).collect(),
            name: "disc".into(),
        }
    }

    #[test]
    fn a_state_in_parts_needs_all_of_them_and_they_go_with_it() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path();
        let header = |step| Header { identity: identity(), step, time: 0.0 };
        let complete = |header: &Header, count: usize| load_parts::<u32>(place, &identity(), header.step, count);
        let latest = || load_latest_with(place, &identity(), complete);
        for step in [10, 20, 30] {
            for process in 0..3 {
                save_part(place, &header(step), process, &(step as u32 + process as u32), Compression::Fast).unwrap();
            }
            // Without the file that names them, parts are no checkpoint.
            assert_eq!(latest().unwrap().map_or(0, |found| found.header.step), step - 10);
            save(place, &header(step), &3usize, Compression::Fast).unwrap();
            assert_eq!(latest().unwrap().unwrap().state, [0, 1, 2].map(|process| step as u32 + process));
        }
        assert_eq!(parts(place).unwrap().iter().filter(|(step, _)| *step == 10).count(), 0);
        assert_eq!(parts(place).unwrap().len(), 6);
        fs::remove_file(part_path(place, 30, 1)).unwrap();
        let older = latest().unwrap().unwrap();
        assert_eq!((older.header.step, older.passed_over.len()), (20, 1));
        fs::rename(part_path(place, 30, 2), part_path(place, 20, 2)).unwrap();
        assert!(matches!(latest(), Err(CheckpointError::Unreadable { .. })));
        assert!(matches!(
            load_parts::<u32>(place, &identity(), 20, 3),
            Err(CheckpointError::OtherStep { found: 30, .. })
        ));
    }

    fn identity() -> Identity {
        Identity { program: "0.1.0".into(), case_hash: u128::MAX - 5, mesh_hash: 7 }
    }

    fn header(step: u64) -> Header {
        Header { identity: identity(), step, time: step as f64 * 1e-7 }
    }

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// A saved state's path and bytes.
    fn saved(folder: &Path, size: usize, compression: Compression) -> (PathBuf, Vec<u8>) {
        let path = save(folder, &header(10), &state(size), compression).unwrap();
        let bytes = fs::read(&path).unwrap();
        (path, bytes)
    }

    #[test]
    fn a_state_comes_back_bit_for_bit() {
        let folder = tempfile::tempdir().unwrap();
        // None, some, and more than one block of state.
        for size in [0, 100, 100_000] {
            for compression in [Compression::None, Compression::Fast] {
                let (path, _) = saved(folder.path(), size, compression);
                let (found, back): (Header, State) = load(&path, &identity()).unwrap();
                assert_eq!(found, header(10));
                assert_eq!(back, state(size));
                assert!(size == 0 || back.positions[0][2].is_sign_negative());
            }
        }
    }

    #[test]
    fn bytes_are_the_same_for_any_number_of_threads() {
        let bytes = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let folder = tempfile::tempdir().unwrap();
            pool.install(|| saved(folder.path(), 200_000, Compression::Fast).1)
        };
        assert!(bytes(1) == bytes(3));
    }

    #[test]
    fn the_last_two_stay_and_rests_of_killed_runs_go() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        fs::write(folder.join("state-000000015.fck.part"), b"half").unwrap();
        fs::write(folder.join("notes.txt"), b"mine").unwrap();
        for step in [10, 20, 30] {
            save(folder, &header(step), &state(3), Compression::Fast).unwrap();
        }
        assert_eq!(names(folder), ["notes.txt", "state-000000020.fck", "state-000000030.fck"]);
        // Resumed from 20 after 30 was lost: 30 is a past that was not taken.
        save(folder, &header(25), &state(3), Compression::Fast).unwrap();
        assert_eq!(names(folder), ["notes.txt", "state-000000020.fck", "state-000000025.fck"]);
        discard(folder).unwrap();
        assert_eq!(names(folder), ["notes.txt"]);
        fs::remove_file(folder.join("notes.txt")).unwrap();
        discard(folder).unwrap();
        assert!(!folder.exists());
        discard(folder).unwrap();
    }

    #[test]
    fn the_newest_whole_one_is_taken_and_the_others_are_told() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        assert!(load_latest::<State>(&folder.join("absent"), &identity()).unwrap().is_none());
        assert!(load_latest::<State>(folder, &identity()).unwrap().is_none());
        for step in [10, 20] {
            save(folder, &header(step), &state(3), Compression::Fast).unwrap();
        }
        let found = load_latest::<State>(folder, &identity()).unwrap().unwrap();
        assert_eq!((found.header.step, found.passed_over.len()), (20, 0));
        assert_eq!(newest(folder), Some((20, found.path)));

        let newest = folder.join("state-000000020.fck");
        let bytes = fs::read(&newest).unwrap();
        fs::write(&newest, &bytes[..bytes.len() - 1]).unwrap();
        let found = load_latest::<State>(folder, &identity()).unwrap().unwrap();
        assert_eq!((found.header.step, &found.state), (10, &state(3)));
        assert!(matches!(&found.passed_over[..], [CheckpointError::Truncated { .. }]));

        fs::write(folder.join("state-000000010.fck"), b"").unwrap();
        let error = load_latest::<State>(folder, &identity()).unwrap_err();
        assert!(matches!(&error, CheckpointError::Truncated { path } if *path == newest), "{error}");
    }

    #[test]
    fn a_foreign_state_is_refused_by_what_is_foreign() {
        let folder = tempfile::tempdir().unwrap();
        let (path, bytes) = saved(folder.path(), 5, Compression::Fast);
        let error = |identity| load::<State>(&path, &identity).unwrap_err();
        assert!(matches!(error(Identity { case_hash: 1, ..identity() }), CheckpointError::OtherCase { .. }));
        assert!(matches!(error(Identity { mesh_hash: 1, ..identity() }), CheckpointError::OtherMesh { .. }));
        let other = error(Identity { program: "0.2.0".into(), ..identity() });
        assert!(matches!(other, CheckpointError::OtherProgram { .. }), "{other}");

        let mut newer = bytes.clone();
        newer[8] += 1;
        fs::write(&path, newer).unwrap();
        assert!(matches!(error(identity()), CheckpointError::OtherFormat { found, .. } if found == FORMAT + 1));

        fs::write(&path, "time [s],load [N]\n0,1\n").unwrap();
        assert!(matches!(error(identity()), CheckpointError::NotACheckpoint { .. }));

        fs::write(&path, [bytes.clone(), vec![0]].concat()).unwrap();
        assert!(matches!(error(identity()), CheckpointError::Corrupt { .. }));

        fs::write(&path, bytes).unwrap();
        let layout = load::<Vec<String>>(&path, &identity()).unwrap_err();
        assert!(matches!(layout, CheckpointError::OtherLayout { .. }), "{layout}");
    }

    #[test]
    fn what_cannot_be_stored_leaves_the_former_checkpoint() {
        struct Endless;
        impl Serialize for Endless {
            fn serialize<S: serde::Serializer>(&self, _: S) -> Result<S::Ok, S::Error> {
                Err(serde::ser::Error::custom("endless"))
            }
        }
        let folder = tempfile::tempdir().unwrap();
        saved(folder.path(), 5, Compression::Fast);
        let error = save(folder.path(), &header(11), &Endless, Compression::Fast).unwrap_err();
        assert!(matches!(error, CheckpointError::NotStorable { .. }), "{error}");
        assert_eq!(names(folder.path()), ["state-000000010.fck"]);
    }

    /// Blocks of a thousandth of what they inflate to, twice as many as the memory holds, with all checksums right.
    #[test]
    #[cfg(target_os = "linux")]
    fn a_state_larger_than_the_memory_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("state-000000010.fck");
        let blocks = memory::available().unwrap() / (1 << 19) + 1;
        fs::write(&path, container::inflating_to(&header(10), blocks)).unwrap();
        let error = load::<State>(&path, &identity()).unwrap_err();
        assert!(matches!(error, CheckpointError::TooLarge { .. }), "{error}");
        assert!(error.to_string().contains(".fck: reading the checkpoint needs about "), "{error}");
    }

    proptest! {
        #[test]
        fn a_cut_off_file_is_refused(share in 0.0f64..1.0, size in 0usize..3000, compress: bool) {
            let folder = tempfile::tempdir().unwrap();
            let compression = if compress { Compression::Fast } else { Compression::None };
            let (path, bytes) = saved(folder.path(), size, compression);
            fs::write(&path, &bytes[..(bytes.len() as f64 * share) as usize]).unwrap();
            let error = load::<State>(&path, &identity()).unwrap_err();
            prop_assert!(matches!(error, CheckpointError::Truncated { .. }), "{}", error);
        }

        #[test]
        fn flipped_bits_are_refused(
            places in proptest::collection::vec((0.0f64..1.0, 0u8..8), 1..4),
            size in 0usize..300,
            compress: bool,
        ) {
            let folder = tempfile::tempdir().unwrap();
            let compression = if compress { Compression::Fast } else { Compression::None };
            let (path, whole) = saved(folder.path(), size, compression);
            let mut bytes = whole.clone();
            for (share, bit) in places {
                bytes[(whole.len() as f64 * share) as usize] ^= 1 << bit;
            }
            prop_assume!(bytes != whole);
            fs::write(&path, bytes).unwrap();
            prop_assert!(load::<State>(&path, &identity()).is_err());
        }

        #[test]
        fn random_bytes_are_refused(bytes in proptest::collection::vec(any::<u8>(), 0..300), with_magic: bool) {
            let folder = tempfile::tempdir().unwrap();
            let (path, whole) = saved(folder.path(), 3, Compression::None);
            let start = if with_magic { &whole[..16] } else { &[] };
            fs::write(&path, [start, &bytes].concat()).unwrap();
            prop_assert!(load::<State>(&path, &identity()).is_err());
        }
    }

    /// Not only random ones: each single bit of a small file.
    #[test]
    fn every_single_flipped_bit_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let (path, whole) = saved(folder.path(), 4, Compression::Fast);
        for bit in 0..whole.len() * 8 {
            let mut bytes = whole.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            fs::write(&path, bytes).unwrap();
            assert!(load::<State>(&path, &identity()).is_err(), "bit {bit}");
        }
    }
}
