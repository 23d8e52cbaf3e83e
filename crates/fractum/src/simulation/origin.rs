//! Where results come from, and the command that makes or continues them.

use std::fs;
use std::path::Path;
use std::time::SystemTime;

use fractum_case::Case;
use fractum_output::WriteError;
use fractum_output::atomic::{self, Group};
use fractum_output::origin::{InputFile, Origin, utc};
use fractum_output::summary::hash_text;

use super::Options;
use crate::error::Failure;

impl Options {
    /// The command that runs `case` with these options, for a shell.
    ///
    /// - `program`: how the program is called
    /// - `results`: folder of the results
    pub fn command(&self, program: &str, case: &Path, results: &Path) -> String {
        let mut words = vec![program.to_owned(), "run".to_owned(), case.display().to_string()];
        words.extend(["-o".to_owned(), results.display().to_string()]);
        words.extend(self.overrides.iter().flat_map(|(name, value)| ["--set".to_owned(), format!("{name}={value}")]));
        words.extend(self.threads.iter().flat_map(|threads| ["--threads".to_owned(), threads.to_string()]));
        let flags = [
            (self.resume, "--resume"),
            (self.overwrite, "--overwrite"),
            (self.quiet, "--quiet"),
            (self.strict, "--strict"),
        ];
        words.extend(flags.into_iter().filter(|(given, _)| *given).map(|(_, flag)| flag.to_owned()));
        words.iter().map(|word| for_shell(word)).collect::<Vec<_>>().join(" ")
    }
}

/// A word as a shell (sh, bash, zsh) takes it.
pub fn for_shell(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_@%+=:,./-".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

/// Where the results of this run come from.
pub(super) fn origin(case: &Case, mesh_hash: u128, options: &Options, results: &Path) -> Origin {
    let source = &case.source;
    let mesh = case.mesh.iter().map(|mesh| (mesh.file.value.display().to_string(), mesh_hash));
    let tables = source.tables.iter().map(|(name, bytes)| (name.clone(), xxhash_rust::xxh3::xxh3_128(bytes)));
    Origin {
        case: source.path.display().to_string(),
        overrides: source.overrides.iter().map(|(name, value)| format!("{name}={value}")).collect(),
        files: mesh.chain(tables).map(|(file, hash)| InputFile { file, hash: hash_text(hash) }).collect(),
        command: options.command("fractum", &source.path, results),
        folder: std::env::current_dir().map_or(String::new(), |folder| folder.display().to_string()),
        started: utc(SystemTime::now()),
    }
}

/// Folder in the results with the text of the case.
const INPUT: &str = "input";

/// File beside that text: hash of the case, or [`MIXED`], and the name of the text.
const HASH: &str = "case-hash.txt";

/// In place of a hash where a run has gone on from a state of another end.
const MIXED: &str = "mixed";

/// Keeps the text of the case in the folder `input` of the results, and its hash.
///
/// - `is_new`: whether the run starts with it; one that goes on may have begun with another end
///
/// # Errors
/// [`Failure::Write`].
pub(crate) fn keep_case(case: &Case, results: &Path, is_new: bool) -> Result<(), Failure> {
    let hash = hash_text(case.hash());
    let is_own = is_new || kept_hash(results).as_ref() == Some(&hash);
    let folder = results.join(INPUT);
    atomic::create_folder(&folder)?;
    let name = case.source.path.file_name().map_or("case.toml".into(), |name| name.to_string_lossy());
    let kept = folder.join(&*name);
    // A case that lies there is the user's own file, which no run removes.
    let is_source =
        fs::canonicalize(&kept).is_ok_and(|own| fs::canonicalize(&case.source.path).is_ok_and(|path| path == own));
    let line = format!("{} {}\n", if is_own { &hash } else { MIXED }, if is_source { "" } else { &*name });
    let mut files = Group::default();
    files.add(&folder.join(HASH), line.as_bytes());
    if !is_source {
        files.add(&kept, case.source.text.as_bytes());
    }
    Ok(files.finish()?)
}

/// Hash of the case, its end included, that all results in a folder are of.
pub(crate) fn kept_hash(results: &Path) -> Option<String> {
    let line = fs::read_to_string(results.join(INPUT).join(HASH)).ok()?;
    line.split_once(' ').map(|(hash, _)| hash.to_owned())
}

/// Removes what [`keep_case`] has kept.
///
/// # Errors
/// [`Failure::Write`].
pub(super) fn forget_case(results: &Path) -> Result<(), Failure> {
    let folder = results.join(INPUT);
    let Ok(line) = fs::read_to_string(folder.join(HASH)) else { return Ok(()) };
    let name = line.split_once(' ').and_then(|(_, name)| Path::new(name.trim_end()).file_name());
    for path in name.into_iter().chain([HASH.as_ref()]).map(|name| folder.join(name)).filter(|path| path.is_file()) {
        fs::remove_file(&path).map_err(|error| WriteError::new(&path, error))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_with_spaces_and_quotes_are_one_word_for_a_shell() {
        for word in ["plain-1.toml", "end=2 ms", "it's $HOME", "", "a;b", "\"x\"", "bodies[0].damage=false"] {
            let script = format!("printf %s {}", for_shell(word));
            let echoed = std::process::Command::new("sh").args(["-c", &script]).output().unwrap();
            assert_eq!(String::from_utf8_lossy(&echoed.stdout), word);
        }
    }
}
