//! A case that asks for an accuracy: it runs on the mesh as it is, then on meshes that are finer where damage came, until the error bar of its load is as
//! short as asked. Where it can be told where the crack runs, passes along a line of the mesh tell most.
//!
//! Every pass is a run of its own in a folder of its own, which has its mesh; one that has finished is not run again, and one that was interrupted goes on.
//! The results of the finest pass become those of the case, with the estimates beside them.

mod line;
mod publish;
mod zone;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use fractum_case::model::{AskedAccuracy, Material, SolverKind, WHOLE_MESH, load_of};
use fractum_case::{Case, Diagnostic, Diagnostics};
use fractum_fem::CriterionKind;
use fractum_mesh::{Mesh, MshFormat, RefineError, RefineOptions, refined, write_msh};
use fractum_output::accuracy::{Estimate, Known, OF_FIELDS, OF_LOADS, OF_OTHERS, Pass, estimate, of_lines};
use fractum_output::atomic;
use fractum_output::number::{grouped, quantity, significant};
use fractum_output::study::run::Planned;
use fractum_output::summary::{Status, Summary};
use fractum_output::warning::{Code, Warning};

use crate::error::Failure;
use crate::input::mesh_of_case;
use crate::kept;
use crate::output::summary::status_text;
use crate::process::ranks::Ranks;
use crate::simulation::{Damaged, Measure, Options, Outcome, PASSES, results_folder, run_whole};
use crate::tell;
use zone::Zone;

/// File of the mesh of a pass.
const MESH: &str = "mesh.msh";

/// Size of the elements of the first two meshes that are refined, over l, which every two passes halve: the excess is a line below it.
const FIRST: f64 = 0.1;

/// How many times smaller the elements of a pass may be than those of the passes before.
const STEP: f64 = 4.0;

/// Size of the elements that bisection makes, over the longest edge that it leaves.
const SIZE_OF_EDGE: f64 = 0.6;

/// Elements of a pass at most, so that a path in space ends within hours, and how many times those of the pass before they may be where they are many.
const MOST: usize = 300_000;
const GROWTH: usize = 6;
const LITTLE: usize = 10_000;

/// How much larger elements become where those wanted are too many: in space a step of two would leave an eighth of them.
const COARSER: [f64; 2] = [2.0, 1.26];

/// Passes with damage, with that on the mesh of the user, before the first bar is believed; or passes along lines.
const LEAST: usize = 6;
const LEAST_LINES: usize = 2;

/// What is left at the end of the peak of a load, where a pass has gone beyond it.
const PASSED: f64 = 0.98;

/// What a pass is for.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// It looks where the crack goes, without a phase field, which its elements may be too large for.
    Coarse,
    /// It tells how late the crack runs.
    Fine,
    /// Its crack runs along a line of its mesh: about when its load is largest, and the size of its elements [m].
    Line { peak: f64, size: f64 },
}

/// The passes of a case.
struct Passes<'a> {
    case: &'a Case,
    path: &'a Path,
    options: &'a Options,
    /// Folder of the passes.
    folder: PathBuf,
    /// Name of the probe of the load, and its unit.
    load: (String, &'static str),
    /// Why its error bars are not known to hold; empty where they are.
    untried: Vec<&'static str>,
    /// Done so far, with their summaries and where damage came.
    done: Vec<(Pass, Summary, Damaged)>,
}

/// Runs a case that asks for an accuracy.
///
/// # Errors
/// As [`crate::run`], of the first pass; what cannot be refined or written.
pub(crate) fn run(
    path: &Path,
    case: &Case,
    asked: &AskedAccuracy,
    options: &Options,
) -> Result<(Outcome, Measure), Failure> {
    let results = &results_folder(path, options)?;
    if options.resume && !results.join(PASSES).is_dir() {
        let text = format!("{}: no passes to go on with; run without --resume", results.display());
        return Err(Failure::input(text));
    }
    let Some((load, unit)) = load_of(&case.probes) else {
        let note = Diagnostic::error(&asked.share.place, ": no probe measures a force or a moment".to_owned());
        return Err(Failure::Input(Diagnostics(vec![note.remedy("add a probe of a reaction")])));
    };
    let load = (case.probes[load].name.value.clone(), unit);
    let (base, _) = mesh_of_case(case)?;
    let untried = untried(case, &base);
    let mut passes = Passes { case, path, options, folder: results.join(PASSES), load, untried, done: Vec::new() };
    passes.add("1-as-meshed", None, Kind::Coarse)?;
    passes.refuse_warnings(&passes.warnings_of(0), results)?;
    passes.tell_last();
    while passes.goes_on(asked) {
        let (mesh, name, kind) = passes.mesh(&base, asked)?;
        passes.add(&name, Some(&mesh), kind)?;
        passes.tell_last();
        if !passes.is_interrupted() {
            passes.add_line(&base)?;
        }
    }
    let (finest, particles) = (passes.finest(), passes.done[0].1.counts.particles);
    let measure = Measure { processor: None, size: passes.done[finest].0.size, particles };
    Ok((publish::publish(&passes, finest, asked, results)?, measure))
}

/// What sets a case apart from those whose bars were held against exact loads: plane bodies at rest that crack in tension.
fn untried(case: &Case, mesh: &Mesh) -> Vec<&'static str> {
    let stages = || std::iter::once(case).chain(&case.later);
    let moves = stages().any(|stage| stage.solver.kind != SolverKind::Static);
    let is_other = |material: &Material| {
        material.damage.as_ref().is_some_and(|damage| damage.value.law.criterion.kind() != CriterionKind::Rankine)
    };
    let all = [
        (!mesh.tetrahedra.is_empty(), "a body in space"),
        (moves, "motion"),
        (case.materials.iter().any(is_other), "another criterion than Rankine's"),
    ];
    all.into_iter().filter_map(|(is_so, what)| is_so.then_some(what)).collect()
}

fn has_field(material: &Material) -> bool {
    material.damage.as_ref().is_some_and(|damage| damage.value.regularisation.is_some())
}

impl Passes<'_> {
    /// Warnings of a pass that are those of the case. How late cracks run on its mesh is what the bars are about.
    fn warnings_of(&self, pass: usize) -> Vec<Warning> {
        let summary = &self.done[pass].1;
        // A parameter of the mesh alone is used by the first pass.
        let first = &self.done[0].1.warnings;
        let is_own = |warning: &&Warning| match warning.code {
            Code::Unused => first.contains(warning),
            code => code != Code::CoarseMesh,
        };
        summary.warnings.iter().filter(is_own).cloned().collect()
    }

    /// Ends the run with a warning where warnings are errors.
    fn refuse_warnings(&self, warnings: &[Warning], results: &Path) -> Result<(), Failure> {
        match warnings.first().filter(|_| self.options.strict) {
            Some(warning) => {
                let saved = results.join(PASSES).display().to_string();
                Err(Failure::Strict { warning: warning.clone(), saved })
            }
            None => Ok(()),
        }
    }

    /// Whether another pass is to follow.
    fn goes_on(&self, asked: &AskedAccuracy) -> bool {
        let count = self.done.iter().filter(|(pass, ..)| !pass.line).count();
        let are_enough = count >= LEAST || self.counted(true).count() >= LEAST_LINES;
        let is_met = are_enough && self.reached().is_some_and(|reached| reached <= asked.share.value);
        let is_elastic = count == 1 && self.done[0].2.is_empty();
        !is_met && !is_elastic && !self.is_interrupted() && count < asked.most_runs
    }

    fn is_interrupted(&self) -> bool {
        self.done.last().is_some_and(|(_, summary, _)| summary.status == Status::Interrupted)
    }

    /// The pass with the smallest elements whose peaks count; the first where none does.
    fn finest(&self) -> usize {
        let counts = |index: &usize| self.done[*index].0.left_out.is_empty() && !self.done[*index].0.line;
        let size = |index: &usize| self.done[*index].0.size;
        (1..self.done.len()).filter(counts).min_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(0)
    }

    /// Does a pass, unless it has been done before.
    ///
    /// - `mesh`: file of its mesh; none for that of the case
    fn add(&mut self, name: &str, mesh: Option<&Path>, kind: Kind) -> Result<(), Failure> {
        let mut overrides = self.options.overrides.clone();
        let fields = self.case.materials.iter().filter(|material| has_field(material));
        if kind == Kind::Coarse {
            let none = |material: &Material| format!("materials.{}.damage.regularisation", material.name.value);
            overrides.extend(fields.map(|material| (none(material), "\"none\"".to_owned())));
        }
        if let Some(mesh) = mesh {
            let file = std::path::absolute(mesh).unwrap_or_else(|_| mesh.to_owned());
            let file = file.display().to_string().replace('\\', "/").replace('"', "\\\"");
            overrides.push(("mesh".to_owned(), format!("{{ file = \"{file}\", unit = \"m\" }}")));
        }
        let key = if self.case.source.stage.is_empty() { "solver.accuracy" } else { "stages[*].solver.accuracy" };
        overrides.push((key.to_owned(), "0".to_owned()));
        let planned = Planned { name: name.to_owned(), case: self.path.to_owned(), overrides, ..Planned::default() };
        let peak = if let Kind::Line { peak, .. } = kind { Some(peak) } else { None };
        let options = Options { pass: Some(self.done.len()), line: peak, strict: false, ..self.options.clone() };
        let summary = summary_of(&planned, &self.folder, &options)?;
        let damaged = Damaged::read(&self.folder.join(name));
        let mut pass = self.pass(name, &summary, &damaged, kind);
        if kind == Kind::Coarse && mesh.is_some() && self.has_field() {
            pass.left_out = "without its phase field".to_owned();
        }
        self.done.push((pass, summary, damaged));
        Ok(())
    }

    fn pass(&self, name: &str, summary: &Summary, damaged: &Damaged, kind: Kind) -> Pass {
        let line = if let Kind::Line { size, .. } = kind { Some(size) } else { None };
        let of_probe = |probe: &fractum_output::summary::Probe| {
            if probe.min.abs() > probe.max.abs() { probe.min } else { probe.max }
        };
        // A probe that looks where no crack has come has no value.
        let of_probes = summary.probes.iter().map(|(name, probe)| (name.clone(), of_probe(probe)));
        let peaks: BTreeMap<String, f64> = of_probes.filter(|(_, peak)| peak.is_finite()).collect();
        let load = &self.load.0;
        let (peak, end) = (peaks.get(load).copied().unwrap_or(f64::NAN), summary.probes.get(load));
        let has_passed = end.is_some_and(|probe| probe.r#final.abs() < PASSED * peak.abs());
        let left_out = match summary.status {
            // At rest a load behind its peak often has no equilibrium; it has none beyond the peak of a force.
            Status::Stopped if line.is_some() => self.wrong_line(peak),
            _ if line.is_some() && has_passed => self.wrong_line(peak),
            _ if line.is_none() && damaged.is_empty() => "no damage".to_owned(),
            Status::Stopped if !has_passed => format!("stopped before its peak: {}", summary.time.reason),
            // What grows to the end says nothing of the crack that stops it.
            _ if !has_passed => "its load did not fall".to_owned(),
            _ => String::new(),
        };
        Pass {
            name: name.to_owned(),
            size: line.unwrap_or_else(|| damaged.size()),
            line: line.is_some(),
            elements: summary.counts.elements,
            end: status_text(summary.status).to_owned(),
            left_out,
            wall: summary.wall.total,
            peaks,
        }
    }

    /// Length beside which elements are large or small [m]: the shortest that any pass has told.
    fn length(&self) -> f64 {
        let damaged = self.done.iter().map(|(_, _, damaged)| damaged).filter(|damaged| !damaged.is_empty());
        damaged.map(|damaged| damaged.length).fold(f64::INFINITY, f64::min)
    }

    /// Passes whose peaks count: those on refined meshes, along lines or with damage.
    fn counted(&self, line: bool) -> impl Iterator<Item = &Pass> {
        let counts = move |pass: &&Pass| pass.left_out.is_empty() && pass.line == line;
        self.done.iter().skip(1).map(|(pass, _, _)| pass).filter(counts)
    }

    /// Estimate of the peak of a probe.
    fn estimate(&self, name: &str, unit: &str) -> Option<Estimate> {
        let length = self.length();
        let sizes: Vec<f64> = self.counted(false).map(|pass| pass.size / length).collect();
        let peaks = |name: &str, line: bool| -> Option<Vec<f64>> {
            self.counted(line).map(|pass| pass.peaks.get(name).copied()).collect()
        };
        let (own, loads, lines) = (peaks(name, false)?, peaks(&self.load.0, false)?, peaks(&self.load.0, true)?);
        let [value, half] = match proportion(&own, &loads) {
            // The load itself, or what is made of it, such as a strength.
            Some(ratio) if lines.len() >= LEAST_LINES => of_lines(&lines)?.map(|value| ratio * value),
            Some(ratio) => estimate(&sizes, &loads, self.of_loads())?.map(|value| ratio * value),
            None => estimate(&sizes, &own, OF_OTHERS)?,
        };
        Some(Estimate { unit: unit.to_owned(), value, half: half.abs() })
    }

    /// What is known of loads of cracks on meshes like those of the passes.
    fn of_loads(&self) -> Known {
        if self.has_field() { OF_FIELDS } else { OF_LOADS }
    }

    fn has_field(&self) -> bool {
        self.case.materials.iter().any(has_field)
    }

    /// Half of the bar of the load over the load.
    fn reached(&self) -> Option<f64> {
        let estimate = self.estimate(&self.load.0, self.load.1)?;
        Some((estimate.half / estimate.value).abs())
    }

    /// Size of the elements of the first passes that tell how late cracks run [m].
    fn first_size(&self) -> f64 {
        self.done[0].0.size.min(FIRST * self.length())
    }

    /// Size of the elements of the next pass [m].
    fn next_size(&self) -> f64 {
        let sizes = || self.done.iter().filter(|(pass, ..)| !pass.line).map(|(pass, ..)| pass.size);
        let first = self.first_size();
        // Around a crack that a very coarse mesh has found fine elements would be many.
        let nearest = sizes().fold(f64::INFINITY, f64::min) / STEP;
        let made = sizes().skip(1).filter(|size| *size < 1.5 * first).count();
        nearest.max(first * 0.5f64.powi(made as i32 / 2))
    }

    /// Where elements of a size are wanted. Passes of such sizes tell more exactly where cracks run than coarser ones.
    fn zone(&self, size: f64) -> Zone {
        let all = || self.done.iter().map(|(_, _, damaged)| damaged).filter(|damaged| !damaged.is_empty());
        let near: Vec<&Damaged> = all().filter(|damaged| damaged.size() < 2.5 * size).collect();
        if near.is_empty() { Zone::around(all()) } else { Zone::around(near.into_iter()) }
    }

    /// File of the mesh of the next pass, the name of the pass, and what it is for.
    fn mesh(&self, base: &Mesh, asked: &AskedAccuracy) -> Result<(PathBuf, String, Kind), Failure> {
        let number = self.done.len();
        let seed = |_| Some(number as u64);
        let mut size = self.next_size();
        let most = self.most_elements(base);
        let mesh = loop {
            let zone = self.zone(size);
            let wanted = |at| if zone.contains(at) { size / SIZE_OF_EDGE } else { f64::INFINITY };
            match refined(base, &wanted, RefineOptions { seed: &seed, most }) {
                Ok(made) => break made.mesh,
                // Another mesh of a size before it.
                Err(RefineError::TooMany(_)) => size *= COARSER[usize::from(!base.is_plane())],
                Err(error) => {
                    let note = Diagnostic::error(&asked.share.place, format!(": {error}"));
                    let note = note.remedy("set solver.accuracy to 0, and refine the mesh yourself (mesh.refine)");
                    return Err(Failure::Input(Diagnostics(vec![note])));
                }
            }
        };
        let (file, name) = self.write_mesh(mesh, "refined")?;
        Ok((file, name, if size > 1.5 * self.first_size() { Kind::Coarse } else { Kind::Fine }))
    }

    /// Elements of the next pass at most.
    fn most_elements(&self, base: &Mesh) -> usize {
        let last = self.done.last().map_or(0, |(pass, ..)| pass.elements as usize);
        (GROWTH * last).clamp(LITTLE, MOST).max(2 * base.element_count())
    }

    /// Lengths of a file are scaled as those of the case are.
    fn scale(&self) -> f64 {
        self.case.source.verify.scale.unwrap_or(1.0)
    }

    /// File of the mesh of the next pass, and the name of the pass.
    fn write_mesh(&self, mut mesh: Mesh, kind: &str) -> Result<(PathBuf, String), Failure> {
        mesh.groups.retain(|group| group.name != WHOLE_MESH);
        let scale = self.scale();
        mesh.nodes.iter_mut().for_each(|node| *node /= scale);
        let name = format!("{}-{kind}", self.done.len() + 1);
        let folder = self.folder.join(&name);
        atomic::create_folder(&folder)?;
        let file = folder.join(MESH);
        atomic::write_with(&file, |out| write_msh(&mesh, MshFormat::V4_1Binary, out))?;
        Ok((file, name))
    }

    /// A line on what the last pass came to.
    fn tell_last(&self) {
        let Some((pass, _, _)) = self.done.last().filter(|_| !self.options.quiet) else { return };
        let (load, unit) = &self.load;
        let peak = pass.peaks.get(load).copied().unwrap_or(f64::NAN);
        let estimate = self.estimate(load, unit).map(|estimate| format!("; so far {}", estimate.words()));
        let end = if pass.left_out.is_empty() { String::new() } else { format!(" ({})", pass.left_out) };
        tell!(
            "pass {}: {} elements, {} at the crack; peak of {load} {}{end} in {} s{}",
            pass.name,
            grouped(&pass.elements.to_string()),
            quantity(pass.size, "m"),
            quantity(peak, unit),
            significant(pass.wall, 3),
            estimate.unwrap_or_default()
        );
    }
}

/// What peaks are of those of the load, where that is the same in all passes but for the tolerance of equilibrium.
fn proportion(peaks: &[f64], loads: &[f64]) -> Option<f64> {
    let ratio = peaks.first()? / loads.first()?;
    let is_same = |(peak, load): (&f64, &f64)| (peak - ratio * load).abs() <= 1e-3 * peak.abs();
    (ratio.is_finite() && ratio != 0.0 && peaks.iter().zip(loads).all(is_same)).then_some(ratio)
}

/// Does a pass; its summary, also where it stopped itself.
fn summary_of(planned: &Planned, folder: &Path, options: &Options) -> Result<Summary, Failure> {
    let runner = |path: &Path, options: &Options| run_whole(path, options, Ranks::alone());
    match kept::run_one(planned, folder, options, options.overwrite, (kept::program()?, runner)) {
        Ok(_) | Err(Failure::Stopped { .. } | Failure::StoppedBefore(_)) => {
            let file = folder.join(&planned.name).join("summary.json");
            Summary::read(&file).map_err(|error| Failure::input(error.to_string()))
        }
        Err(failure) => Err(failure),
    }
}
