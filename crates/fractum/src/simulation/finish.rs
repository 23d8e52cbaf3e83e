//! The end of a run: last frame, last row, summary, report and final names.

use std::collections::BTreeMap;
use std::path::Path;

use fractum_case::model::{Case, Material};
use fractum_fem::{CrackFacet, CrackSurface, Solid, neighbours};
use fractum_output::atomic::{Group, create_folder};
use fractum_output::attenuation;
use fractum_output::fragments::{self, Fragment};
use fractum_output::frames::cracks::{self, Columns, FacetHistory};
use fractum_output::notes::{self, Notes, PictureNote};
use fractum_output::number::{at_instant, instant_text, mode_text, quantity};
use fractum_output::summary::{Breakage, Hashes, Status, Summary, hash_text};
use fractum_output::warning::{Code, Warning};
use fractum_scene::statics::{modes_of, show_mode};
use fractum_scene::{Scene, fragment_size, ranks};

use super::{End, Outcome, Saved, Simulation};
use crate::error::{ExitCode, Failure};
use crate::output::modes;
use crate::output::summary;
use crate::phases::Part;
use crate::plots;
use crate::report::{self, Skin};
use crate::solver::Measured;

impl Simulation {
    /// Writes the last frame and row, summary, fragments, cracks and report, and gives the history its final name.
    ///
    /// A simulation that is not over ends as if interrupted, with its state saved.
    ///
    /// # Errors
    /// [`Failure::Stopped`] for a step that failed, with its results written all the same; what cannot be written.
    pub fn finish(mut self) -> Result<Outcome, Failure> {
        let end = self.take_end()?;
        ranks::gather_all(&mut self.scene);
        self.solver.effort().map_or(Ok(()), |effort| self.messages.log.line(effort))?;
        self.ranks.steps(&self.scene).map_or(Ok(()), |steps| self.messages.log.line(steps))?;
        let state_hash = self.state_hash();
        let clock = self.scene.clock;
        if matches!(end, End::Finished(_)) && self.saved.is_none_or(|saved| saved.step != clock.step) {
            // So that the run can be continued to a later end.
            self.save()?;
        }
        self.audit()?; // before the one step more
        self.record_last(&end)?;
        if self.solver.shows_modes() {
            // The pictures show the slowest one.
            show_mode(&mut self.scene, 1);
        } else {
            self.messages.progress.finish(&self.snapshot(), self.started.elapsed());
        }
        let pieces = self.scene.fragments();
        self.warn_of_late_stations(clock.time)?;
        let end = self.audit_end(end)?;
        let (status, reason) = (end.status(), end.reason());
        // All files of the end get their names together.
        let mut files = Group::default();
        let skin = self.skin();
        let pictures = skin.map_or(Ok(Vec::new()), |skin| self.draw(&pieces, skin, &mut files))?;
        let movie = film(&mut self, &mut files)?;
        let mut summary = Summary {
            title: self.case.source.title.clone(),
            status,
            hashes: Hashes { case_hash: hash_text(self.about.case_hash), state_hash: hash_text(state_hash) },
            origin: self.about.origin.clone(),
            probes: summary::probes(&self.case, &self.recorder),
            breakage: Breakage {
                fragment_sizes: summary::fragment_sizes(&self.scene.solid, &pieces),
                ppv: self.recorder.attenuations(clock.time),
                largest_overlap: self.recorder.largest_overlap().cloned(),
            },
            mesh: self.about.mesh.clone(),
            warnings: self.messages.warnings().to_vec(),
            time: summary::time(&clock, reason, self.counts_load()),
            modes: modes_of(&self.scene).map(modes::of_summary),
            wall: summary::wall(self.started.elapsed(), &self.phases),
            ..summary::of_scene(&self.scene)
        };
        summary.expect = self.case.expect.iter().map(|e| summary::expectation(e, &summary)).collect();
        let ppv = &summary.breakage.ppv;
        if !ppv.is_empty() {
            files.add(&self.folder.join("ppv.csv"), attenuation::to_csv(ppv).as_bytes());
        }
        if let Some(found) = &summary.modes {
            files.add(&self.folder.join("modes.csv"), modes::to_csv(found).as_bytes());
        }
        let (steps, seconds) = (clock.step, summary.wall.total);
        self.messages.log.line(format!("{}: {steps} steps, {seconds:.2} s", summary::status_text(status)))?;
        let load = self.load().map(|(index, _)| self.case.probes[index].name.value.clone());
        let (at_rest, shows_modes) = (self.counts_load(), self.solver.shows_modes());
        let kept = Notes {
            case_file: self.case.source.path.display().to_string(),
            plan: self.about.plan.wrapped(PLAN_WIDTH, str::to_owned),
            pictures,
            movie,
            inputs: inputs_of(&self.case),
            plots: plots::notes(&self.case),
        };
        files.add(&self.folder.join("summary.json"), summary.to_json().as_bytes());
        notes::keep(&self.folder, &kept, &mut files);
        self.recorder.finish(&mut files);
        let page = report::add(&self.folder, &mut files);
        // A file that could not be written is the reason, not what the page lacks then.
        files.finish()?;
        page?;
        if let End::Failed(error) = &end {
            self.messages.log.line(error)?;
        }
        if status == Status::Stopped && !self.ranks.leads() {
            return Err(Failure::Elsewhere(ExitCode::Stopped));
        }
        let folder = self.folder.display();
        let instant = |time: f64| if shows_modes { mode_text(time) } else { at_instant(time, at_rest) };
        let saved = self.saved.map_or(format!("{folder}"), |Saved { step, time, .. }| {
            format!("{folder}: step {step}, {}", instant(time))
        });
        match end {
            End::Failed(error) => Err(Failure::Stopped { error, saved }),
            End::Strict(warning) => Err(Failure::Strict { warning, saved }),
            _ => Ok(Outcome { summary, folder: self.folder, load }),
        }
    }

    /// Why the run is over; one that is not is interrupted, with its state saved.
    fn take_end(&mut self) -> Result<End, Failure> {
        if let Some(end) = self.end.take() {
            return Ok(end);
        }
        self.save()?;
        Ok(End::Interrupted)
    }

    /// What is seen of the solids, for the process that draws it; those that share a mesh put it together.
    fn skin(&self) -> Option<Skin> {
        let leads = self.ranks.leads();
        if neighbours::is_divided(&self.scene.solid) {
            let parts = self.ranks.gather(Skin::of(&self.scene));
            return leads.then(|| Skin::joined(parts));
        }
        leads.then(|| Skin::of(&self.scene))
    }

    /// Cracks, pieces, the pictures of the end and, once the last frame is written, those over time.
    fn draw(
        &mut self,
        pieces: &[fractum_scene::Fragment],
        skin: Skin,
        files: &mut Group,
    ) -> Result<Vec<PictureNote>, Failure> {
        let (at_rest, shows_modes) = (self.counts_load(), self.solver.shows_modes());
        let peak = self.time_of_peak().filter(|_| !shows_modes);
        let instant = |time: f64| if shows_modes { mode_text(time) } else { instant_text(time, at_rest) };
        let Simulation { scene, folder, phases, recorder, .. } = self;
        phases.timed(Part::Output, || {
            create_folder(&folder.join("pictures"))?;
            add_cracks(scene, folder, &recorder.state().removed, files)?;
            let fragments = fragments::to_csv(&fragments_of(&scene.solid, pieces));
            files.add(&folder.join("fragments.csv"), fragments.as_bytes());
            let mut pictures = report::draw(scene, skin, folder, &instant(scene.clock.time), files);
            recorder.finish_frame()?;
            // Frames of a mesh that no process has whole may be larger than the memory of one.
            if !neighbours::is_divided(&scene.solid) {
                pictures.extend(report::strip(folder, peak, &instant, files));
            }
            Ok(pictures)
        })
    }

    /// The frame of the last instant, and its row.
    fn record_last(&mut self, end: &End) -> Result<(), Failure> {
        let Simulation { solver, scene, recorder, phases, .. } = self;
        if !matches!(end, End::Interrupted) {
            phases.timed(Part::Output, || recorder.frame(scene))?;
        }
        if matches!(end, End::Finished(_)) && solver.moves() {
            // The forces and energies of the last instant: one more step, of which nothing else is kept.
            let (time, dt) = (scene.clock.time, scene.clock.dt_after);
            if scene.step(true).is_ok() {
                ranks::gather_all(scene);
                recorder.row(scene, Measured { time, dt, in_motion: true }, true)?;
            }
        }
        // The pictures show all of them.
        self.finish_pieces()
    }
}

/// The movie, where the case asks for one and it can be made; whether it is among the files.
fn film(simulation: &mut Simulation, files: &mut Group) -> Result<bool, Failure> {
    if !simulation.case.output.movie || !simulation.ranks.leads() {
        return Ok(false);
    }
    let mode = simulation.solver.shows_modes().then_some(1);
    let Simulation { scene, folder, phases, messages, .. } = simulation;
    let made = if neighbours::is_divided(&scene.solid) {
        Err("no process has the whole mesh".to_owned())
    } else {
        phases.timed(Part::Output, || report::add_movie(folder, mode, files)).map_err(|error| error.to_string())
    };
    let Err(why) = made else { return Ok(true) };
    let found = Warning::new(Code::NoEffect, "output.movie", format!("no movie was made: {why}"));
    let remedy = format!("fractum movie {} makes one of the frames, where they fit into memory", folder.display());
    messages.warn(found.remedy(remedy))?;
    Ok(false)
}

/// Characters in a line of the plan in the report.
const PLAN_WIDTH: usize = 120;

/// The bonds that broke, where some could.
fn add_broken_bonds(scene: &Scene, folder: &Path, files: &mut Group) -> Result<(), Failure> {
    let bodies = scene.bonded.bodies();
    let all = bodies.iter().flat_map(|body| body.cracks().iter().map(|crack| (Some(body.name.as_str()), crack)));
    let columns = Columns { time: "time [s]", load: None };
    files.add(&folder.join("cracks.csv"), cracks::table(all.clone(), columns).as_bytes());
    let (position, reference) = (&scene.bonded.particles.position, scene.bonded.reference());
    let displacement = |particle: u32| position[particle as usize] - reference[particle as usize];
    let polygons = cracks::polygons(all.map(|(_, crack)| crack), Some(&displacement))?;
    files.add(&folder.join("cracks.vtp"), &polygons.bytes());
    Ok(())
}

/// The cracks of solids and of bonded bodies; those of solids have names of their own where both can break.
///
/// - `removed`: body, element and time of what was removed
fn add_cracks(scene: &Scene, folder: &Path, removed: &[(u32, u32, f64)], files: &mut Group) -> Result<(), Failure> {
    let bonds = scene.bonded.can_break();
    if bonds {
        add_broken_bonds(scene, folder, files)?;
    }
    let crack = CrackSurface::of(&scene.solid);
    if crack.facets.is_empty() {
        return Ok(());
    }
    let times: BTreeMap<(u32, u32), f64> =
        removed.iter().map(|&(body, element, time)| ((body, element), time)).collect();
    let nodes = scene.fragment_of_nodes();
    let of = |facet: &CrackFacet| {
        let (body, element) = facet.removed;
        times.get(&(body as u32, element)).copied().unwrap_or(scene.clock.time)
    };
    let history = FacetHistory {
        time: crack.facets.iter().map(of).collect(),
        fragment: crack.facets.iter().map(|facet| nodes[facet.nodes[0] as usize]).collect(),
    };
    let name = if bonds { "cracks-solids" } else { "cracks" };
    let table = cracks::facets_table(&scene.solid, &crack, &history);
    files.add(&folder.join(format!("{name}.csv")), table.as_bytes());
    let facets = cracks::facets_file(&scene.solid, &crack, Some(&history))?;
    files.add(&folder.join(format!("{name}.vtp")), &facets.bytes());
    Ok(())
}

fn fragments_of(solid: &Solid, pieces: &[fractum_scene::Fragment]) -> Vec<Fragment> {
    pieces
        .iter()
        .zip(1..)
        .map(|(piece, id)| Fragment {
            id,
            mass: piece.mass,
            volume: piece.volume,
            nodes: piece.nodes.len() as u64,
            elements: piece.elements as u64,
            centroid: piece.centroid.into(),
            velocity: piece.velocity.into(),
            largest_extent: piece.extent(),
            size: fragment_size(solid, piece),
            stays: piece.stays,
        })
        .collect()
}

/// Materials and settings of a case, as the table of the report: what and its value, line by line.
fn inputs_of(case: &Case) -> Vec<(String, String)> {
    let mut lines: Vec<(String, String)> =
        case.materials.iter().map(|material| (material.name.value.clone(), of_material(material))).collect();
    for (name, (value, unit)) in &case.source.parameters {
        lines.push((format!("parameter {name}"), quantity(*value, unit)));
    }
    for (name, value) in &case.source.overrides {
        lines.push((format!("--set {name}"), value.clone()));
    }
    lines.push(("end".to_owned(), quantity(case.solver.end, "s")));
    lines
}

fn of_material(material: &Material) -> String {
    let mut parts = vec![
        format!("density {}", quantity(material.density, "kg/m^3")),
        format!("E = {}", quantity(material.young_modulus, "Pa")),
        format!("Poisson's ratio {}", material.poisson_ratio),
    ];
    if let Some(beds) = &material.bedding {
        parts.push(format!("along the normal of its beds E' = {}", quantity(beds.value.law.young_modulus, "Pa")));
        if let Some(strength) = &beds.value.strength {
            parts.push(format!("tensile strength across its beds {}", quantity(strength.tensile_strength, "Pa")));
            parts.push(format!("cohesion along them {}", quantity(strength.cohesion, "Pa")));
        }
    }
    if let Some(damage) = &material.damage {
        let law = &damage.value.law;
        parts.push(format!("tensile strength {}", quantity(law.tensile_strength, "Pa")));
        parts.push(format!("fracture energy {}", quantity(law.fracture_energy, "J/m^2")));
    }
    if let Some(strength) = material.fracture.as_ref().and_then(|fracture| fracture.value.strength.tensile_strength) {
        parts.push(format!("tensile strength of bonds {}", quantity(strength, "Pa")));
    }
    parts.join(", ")
}
