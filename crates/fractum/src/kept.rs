//! A run of many: it is done unless it has finished before, goes on from its last state, and is found again.

use std::fs;
use std::path::Path;

use fractum_case::read_case;
use fractum_output::study::run::{End, Measured, Planned, Run};
use fractum_output::summary::{Status, Summary, hash_text};
use fractum_output::{atomic, checkpoint};
use serde::{Deserialize, Serialize};

use crate::error::{ExitCode, Failure};
use crate::input::mesh_hash;
use crate::simulation::{Measure, Options, Outcome, kept_hash};
use crate::tell;

/// File in the folder of a run with what its summary does not tell.
const RECORD: &str = "study-run.json";

/// What is kept of a run beside its summary.
#[derive(Clone, Default, Serialize, Deserialize)]
struct Record {
    /// What the result depends on.
    identity: Identity,
    /// Mean length of edges or diameter of particles [m].
    size: Option<f64>,
    /// Particles of bonded and loose bodies.
    particles: u64,
    /// Processor time up to its last state [s], where that is known.
    processor: Option<f64>,
    /// How it ended.
    end: Ended,
}

/// Hashes of what a result depends on.
#[derive(Clone, Default, PartialEq, Serialize, Deserialize)]
struct Identity {
    /// This program.
    program: String,
    /// Case with what was set; empty where it cannot be read.
    case: String,
    /// Files of the mesh.
    mesh: String,
}

#[derive(Clone, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Ended {
    /// Interrupted, killed or under way.
    #[default]
    Open,
    Completed,
    /// It stopped itself, and why.
    Stopped(String),
    /// Case, mesh or machine did not allow it, and why.
    Refused(String),
}

/// Runs a case from its file.
pub(crate) type Runner = fn(&Path, &Options) -> Result<(Outcome, Measure), Failure>;

/// Hash of this program, by which what another build has found is told from its own results.
pub(crate) fn program() -> Result<u128, Failure> {
    let read = std::env::current_exe().and_then(fs::read);
    let bytes =
        read.map_err(|error| Failure::input(format!("this program cannot be read, to tell its results: {error}")))?;
    Ok(xxhash_rust::xxh3::xxh3_128(&bytes))
}

/// Does a run, unless it has finished before; goes on from its last state, if there is one of this case, mesh and program.
/// Its end, and whether that is of before.
///
/// - `options`: their `output` is replaced by the folder of the run, overrides and `resume` by those of the run
/// - `anew`: from the start in any case
/// - `program`: its hash; `runner`: what runs the case
///
/// # Errors
/// As [`crate::run`]; what the case is to blame for is kept beside the results.
pub(crate) fn run_one(
    planned: &Planned,
    results: &Path,
    options: &Options,
    anew: bool,
    (program, runner): (u128, Runner),
) -> Result<(Status, bool), Failure> {
    let place = results.join(&planned.name);
    let mut record = Record::default();
    record.identity.program = hash_text(program);
    let ended = done(&mut record, planned, &place, options, (anew, runner));
    match &ended {
        Ok((_, true)) | Err(Failure::StoppedBefore(_)) => return ended,
        Ok((Status::Interrupted, _)) => {}
        Ok(_) => record.end = Ended::Completed,
        Err(failure) if !is_of_case(failure) => return ended,
        Err(failure) if failure.exit_code() == ExitCode::Stopped => record.end = Ended::Stopped(failure.to_string()),
        Err(failure) => record.end = Ended::Refused(failure.to_string()),
    }
    record.write(&place)?;
    ended
}

/// Whether a failure is that of one run, and others may do better.
pub(crate) fn is_of_case(failure: &Failure) -> bool {
    matches!(failure, Failure::Input(_) | Failure::Stopped { .. } | Failure::StoppedBefore(_) | Failure::Memory(_))
}

fn done(
    record: &mut Record,
    planned: &Planned,
    place: &Path,
    options: &Options,
    (anew, runner): (bool, Runner),
) -> Result<(Status, bool), Failure> {
    let case = read_case(&planned.case, &planned.overrides)?;
    let hash = hash_text(case.hash());
    record.identity.case.clone_from(&hash);
    record.identity.mesh = hash_text(mesh_hash(&case)?);
    let kept = Record::read(place).filter(|kept| kept.identity == record.identity && !anew);
    let own_summary = || Summary::read(&place.join("summary.json")).is_ok_and(|found| found.hashes.case_hash == hash);
    match kept.as_ref().map(|kept| &kept.end) {
        Some(Ended::Completed) if own_summary() => return Ok((Status::Completed, true)),
        Some(Ended::Stopped(why)) if own_summary() => return Err(Failure::StoppedBefore(why.clone())),
        _ => {}
    }
    // A state by itself does not tell whether it was reached with the end of this case.
    let has_state = checkpoint::is_there(&place.join("checkpoint"));
    let resume = kept.is_some() && has_state && kept_hash(place) == Some(hash);
    if !resume && !anew && has_state {
        tell!("{}: a state of another case, mesh or program; run {} starts anew", place.display(), planned.name);
    }
    let before = if resume { kept.and_then(|kept| kept.processor) } else { Some(0.0) };
    let options = Options {
        output: Some(place.to_owned()),
        overrides: planned.overrides.clone(),
        resume,
        overwrite: !resume,
        ..options.clone()
    };
    // What is killed goes on from its last state too, and its processor time is not known.
    record.write(place)?;
    let (outcome, Measure { processor, size, particles }) = match runner(&planned.case, &options) {
        Err(failure @ Failure::Checkpoint(_)) if resume && failure.exit_code() == ExitCode::Input => {
            tell!("{failure}; run {} starts anew", planned.name);
            runner(&planned.case, &Options { resume: false, overwrite: true, ..options })
        }
        ended => ended,
    }?;
    record.processor = before.zip(processor).map(|(before, more)| before + more);
    (record.size, record.particles) = (Some(size), particles);
    Ok((outcome.summary.status, false))
}

impl Record {
    fn read(place: &Path) -> Option<Self> {
        serde_json::from_slice(&fs::read(place.join(RECORD)).ok()?).ok()
    }

    fn write(&self, place: &Path) -> Result<(), Failure> {
        atomic::create_folder(place)?;
        let text = serde_json::to_string_pretty(self).unwrap_or_default();
        Ok(atomic::write(&place.join(RECORD), text.as_bytes())?)
    }
}

/// What the folder of a run tells of it, as far as it is of its case as that is now.
///
/// - `from`: the folder of all results, from that of the tables
pub(crate) fn found(planned: &Planned, results: &Path, from: &Path) -> Run {
    let place = results.join(&planned.name);
    let hash = read_case(&planned.case, &planned.overrides).ok().map(|case| hash_text(case.hash()));
    let is_own = |found: &str| hash.as_ref().is_none_or(|own| own == found);
    let record = Record::read(&place).filter(|record| is_own(&record.identity.case));
    let summary = Summary::read(&place.join("summary.json")).ok().filter(|summary| is_own(&summary.hashes.case_hash));
    let record = record.unwrap_or_default();
    let (end, summary) = match (&record.end, summary) {
        (Ended::Refused(why), _) => (End::Failed(why.clone()), None),
        (_, None) => (End::Open, None),
        (Ended::Stopped(why), Some(summary)) if summary.status == Status::Stopped => {
            (End::Failed(why.clone()), Some(summary))
        }
        (_, Some(summary)) => match summary.status {
            Status::Completed => (End::Finished(Box::new(measured(&record, &summary))), Some(summary)),
            Status::Stopped => (End::Failed(summary.time.reason.clone()), Some(summary)),
            Status::Interrupted => (End::Open, Some(summary)),
        },
    };
    Run { planned: planned.clone(), folder: from.join(&planned.name), end, summary: summary.map(Box::new) }
}

fn measured(record: &Record, summary: &Summary) -> Measured {
    Measured {
        size: record.size.unwrap_or(f64::NAN),
        elements: summary.counts.elements,
        particles: record.particles,
        steps: summary.time.steps,
        wall: summary.wall.total,
        processor: record.processor,
        expect: summary.expect.clone(),
    }
}
