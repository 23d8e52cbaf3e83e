//! The gallery against its references.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use fractum_io::case::read_case;
use fractum_io::expectation::Expectation;
use fractum_io::number::quantity;
use fractum_io::summary::Status;
use fractum_io::verified::{self, Verified};

use crate::error::Failure;
use crate::needs::needs;
use crate::run::run;
use crate::simulation::Options;
use crate::{say, tell};
use fractum_prepare::Cache;

/// What is verified, and where results go.
#[derive(Clone, Debug)]
pub struct Selection {
    /// Folder with the cases.
    pub cases: PathBuf,
    /// Only cases whose path contains one of these; all if empty.
    pub names: Vec<String>,
    /// Only cases marked `[verify] quick = true`.
    pub quick: bool,
    /// Folder for results, `verify.json` and `verify.md`.
    pub output: PathBuf,
    /// Threads per case; all cores if none is given.
    pub threads: Option<usize>,
    /// Where packings and beams of bonded bodies are kept.
    pub cache: Cache,
}

/// Runs the selected cases that expect something, prints the table and writes it after every case into `verify.json` and
/// `verify.md`, with the shares of the parts of each run beside those that the case needs in `phases.md`; the lines of the table.
///
/// # Errors
/// [`Failure::Input`] if nothing is selected, [`Failure::Write`] if the table cannot be written. A case that fails to
/// run is a line that does not pass.
pub fn verify(selection: &Selection) -> Result<Vec<Verified>, Failure> {
    let mut cases = Vec::new();
    find_cases(&selection.cases, &mut cases).map_err(|error| {
        Failure::input(format!(
            "{}: cannot list the cases: {error}; name the folder with --cases",
            selection.cases.display()
        ))
    })?;
    cases.sort();
    let name_of =
        |path: &Path| path.strip_prefix(&selection.cases).unwrap_or(path).with_extension("").display().to_string();
    cases.retain(|path| {
        selection.names.is_empty() || selection.names.iter().any(|n| name_of(path).contains(n.as_str()))
    });
    let mut lines = Vec::new();
    say!(
        "{:<36} {:<30} {:>14} {:>22} {:>10}  {:<5} {:>8}",
        "case",
        "quantity",
        "value",
        "expected",
        "off by",
        "pass",
        "seconds"
    );
    for path in cases {
        let name = name_of(&path);
        let case = read_case(&path, &[])?;
        if case.expect.is_empty() || selection.quick && !case.source.verify_quick {
            continue;
        }
        let options = Options {
            output: Some(selection.output.join(&name)),
            threads: selection.threads,
            quiet: true,
            overwrite: true,
            cache: selection.cache.clone(),
            ..Options::default()
        };
        let started = Instant::now();
        let outcome = run(&path, &options);
        let seconds = started.elapsed().as_secs_f64();
        let (first, needs) = (lines.len(), needs(&case));
        match outcome {
            Ok(outcome) if outcome.summary.status == Status::Interrupted => return Err(Failure::Interrupted),
            Ok(outcome) => {
                let phases = outcome.summary.wall.phases;
                lines.extend(outcome.summary.expect.into_iter().map(|expectation| Verified {
                    case: name.clone(),
                    expectation,
                    seconds,
                    phases: phases.clone(),
                    needs: needs.clone(),
                }));
            }
            Err(error) => {
                tell!("{name}: {error}");
                let expectation =
                    Expectation { quantity: "run".into(), source: error.to_string(), ..Expectation::default() };
                lines.push(Verified { case: name.clone(), expectation, seconds, phases: BTreeMap::new(), needs });
            }
        }
        lines[first..].iter().for_each(print_line);
        fractum_io::atomic::create_folder(&selection.output)?;
        verified::write(&selection.output, &lines)?;
    }
    if lines.is_empty() {
        return Err(Failure::input(format!("{}: no case with [[expect]] matches", selection.cases.display())));
    }
    let passed = lines.iter().filter(|line| line.expectation.pass).count();
    say!("{passed} of {} passed; {}", lines.len(), selection.output.join("verify.md").display());
    Ok(lines)
}

fn print_line(line: &Verified) {
    let expectation = &line.expectation;
    say!(
        "{:<36} {:<30} {:>14} {:>22} {:>10}  {:<5} {:>8.2}",
        line.case,
        expectation.quantity,
        quantity(expectation.value, &expectation.unit),
        expectation.required(),
        expectation.off(),
        if expectation.pass { "pass" } else { "FAIL" },
        line.seconds
    );
}

fn find_cases(folder: &Path, found: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            find_cases(&path, found)?;
        } else if path.extension().is_some_and(|e| e == "toml") && path.file_name().is_some_and(|n| n != "study.toml") {
            found.push(path);
        }
    }
    Ok(())
}
