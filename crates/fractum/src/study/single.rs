//! One run of a study, or what is kept of it.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use fractum_math::Vec3;
use fractum_output::atomic;
use fractum_output::study::run::{End, Measured, Planned, Run};
use fractum_output::summary::{Status, Summary, hash_text};
use fractum_scene::Scene;
use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::Xxh3;

use super::Settings;
use crate::error::Failure;
use crate::input::{Input, load};
use crate::process::interrupt::is_interrupted;
use crate::run::run_measured;
use crate::simulation::Options;

/// File in the folder of a run that says what it took and gave.
const RECORD: &str = "study-run.json";

/// A run that is to be done.
pub(super) struct Single<'a> {
    pub(super) planned: &'a Planned,
    pub(super) settings: &'a Settings,
    /// Hash of this program.
    pub(super) program: u128,
    /// Folders of runs under way.
    pub(super) busy: &'a Mutex<BTreeSet<PathBuf>>,
}

/// What is kept of a run.
#[derive(Serialize, Deserialize)]
struct Record {
    /// What the result depends on.
    key: String,
    /// What came of it.
    end: End,
}

impl Single<'_> {
    /// Runs it, unless it has been interrupted or has finished before.
    ///
    /// # Errors
    /// What the machine refuses; mistakes of the case are its end.
    pub(super) fn run(&self) -> Result<Run, Failure> {
        let Planned { case, overrides, .. } = self.planned;
        let run = |folder: PathBuf, end| Run { planned: self.planned.clone(), folder, end };
        if is_interrupted() {
            return Ok(run(PathBuf::new(), End::Open));
        }
        let input = match load(case, overrides, &self.settings.cache) {
            Ok(input) => input,
            Err(failure @ (Failure::Input(_) | Failure::Memory(_))) => {
                return Ok(run(PathBuf::new(), End::Failed(failure.to_string())));
            }
            Err(failure) => return Err(failure),
        };
        let key = key(self.program, &input, self.settings.threads);
        let folder = Path::new("runs").join(format!("{}-{}", name(case), &key[..16]));
        let place = self.settings.output.join(&folder);
        if !self.claim(&place) {
            // Another worker does the same run.
            while !self.is_free(&place) {
                std::thread::sleep(std::time::Duration::from_millis(50));
            }
            return Ok(run(folder, kept(&place, &key).unwrap_or_default()));
        }
        let end = match kept(&place, &key) {
            Some(end) if !self.settings.anew => Ok(end),
            _ if self.settings.only_tables => Ok(End::Open),
            _ => self.fresh(&input, &place, key),
        };
        self.release(&place);
        Ok(run(folder, end?))
    }

    /// Runs it from its start.
    fn fresh(&self, input: &Input, place: &Path, key: String) -> Result<End, Failure> {
        let options = Options {
            output: Some(place.to_owned()),
            threads: Some(self.settings.threads),
            overrides: self.planned.overrides.clone(),
            quiet: true,
            strict: false,
            cache: self.settings.cache.clone(),
            resume: false,
            overwrite: true,
        };
        let end = match run_measured(&self.planned.case, &options) {
            Ok((outcome, _)) if outcome.summary.status == Status::Interrupted => return Ok(End::Open),
            Ok((outcome, processor)) => {
                End::Finished(Box::new(measured(&input.built.scene, outcome.summary, processor)))
            }
            Err(failure @ (Failure::Input(_) | Failure::Stopped { .. } | Failure::Memory(_))) => {
                End::Failed(failure.to_string())
            }
            Err(failure) => return Err(failure),
        };
        let record = Record { key, end };
        let text = serde_json::to_string_pretty(&record).unwrap_or_default();
        atomic::write(&place.join(RECORD), text.as_bytes())?;
        // As it is read later: a number of a JSON file comes back to the last digit but one.
        Ok(kept(place, &record.key).unwrap_or(record.end))
    }

    fn claim(&self, place: &Path) -> bool {
        self.busy.lock().unwrap_or_else(PoisonError::into_inner).insert(place.to_owned())
    }

    fn is_free(&self, place: &Path) -> bool {
        !self.busy.lock().unwrap_or_else(PoisonError::into_inner).contains(place)
    }

    fn release(&self, place: &Path) {
        self.busy.lock().unwrap_or_else(PoisonError::into_inner).remove(place);
    }
}

/// `tilt-10` for `cases/notched-beam/tilt-10.toml`.
fn name(case: &Path) -> String {
    case.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// What a result depends on: program, case with what was set, mesh, and for its run time the threads.
fn key(program: u128, input: &Input, threads: usize) -> String {
    let mut hasher = Xxh3::new();
    hasher.update(&program.to_le_bytes());
    hasher.update(&input.case.hash().to_le_bytes());
    hasher.update(&input.mesh_hash.to_le_bytes());
    hasher.update(&(threads as u64).to_le_bytes());
    hash_text(hasher.digest128())
}

/// The end of an earlier run of the same; none where it has not finished.
fn kept(place: &Path, key: &str) -> Option<End> {
    let text = fs::read(place.join(RECORD)).ok()?;
    let record: Record = serde_json::from_slice(&text).ok()?;
    (record.key == key).then_some(record.end)
}

fn measured(scene: &Scene, summary: Summary, processor: Option<f64>) -> Measured {
    Measured {
        size: size(scene),
        elements: summary.counts.elements,
        particles: scene.bonded.particles.len() as u64,
        steps: summary.time.steps,
        wall: summary.wall.total,
        processor,
        expect: summary.expect,
    }
}

/// Mean length of the edges of all elements, else mean diameter of the particles [m].
fn size(scene: &Scene) -> f64 {
    let solid = &scene.solid;
    let (mut length, mut count) = (0.0, 0usize);
    for body in (0..solid.body_count()).map(|body| solid.body(body)) {
        body.each_edge(solid.reference.len(), |ends| {
            let [a, b]: [Vec3; 2] = ends.map(|node| solid.reference[node as usize]);
            length += (b - a).norm();
            count += 1;
        });
    }
    if count == 0 {
        let radius = &scene.bonded.particles.radius;
        // Those that have left have negative radii.
        (length, count) = (2.0 * radius.iter().map(|radius| radius.abs()).sum::<f64>(), radius.len());
    }
    length / count as f64
}
