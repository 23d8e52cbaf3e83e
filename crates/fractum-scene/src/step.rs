use fractum_fem::{InvertedElement, motion, neighbours, removal};
use fractum_math::Work;

use crate::advance::{advance, start_half_a_step_early};
use crate::balance::book;
use crate::clock::{Phase, ThisStep};
use crate::conduct::{conduct, finish_expansion, heat_loses_elements};
use crate::contacts::{HoldStep, Touching, hold_nodes};
use crate::enter::let_particles_enter;
use crate::error::StepError;
use crate::interfaces::motion::InterfaceStep;
use crate::leave::{hold_departed_particles, remove_departed_fragments, remove_departed_particles};
use crate::ranks::{follow_near, follow_removal, gather_watched, search_together};
use crate::repeat::{book_box, deform_box, put_bonds_in_box, start_box};
use crate::scene::Scene;
use crate::stable_step::{next_dt, update_contact_frequency, update_wall_frequency};
use crate::subcycling::short_steps_in;
use crate::watch::{Notice, Site};

/// Relative difference of two steps that is rounding.
const SAME_STEP: f64 = 1e-9;
/// Removals after which the stable step is looked at again, and the steps that must lie between two looks.
const STEPS_BETWEEN_CHECKS: u64 = 200;

/// What happened in a step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepReport {
    /// Elements removed.
    pub removed: usize,
    /// Discrete elements born.
    pub particles_born: usize,
    /// Solid bodies that have begun to turn, and are corotational from now on.
    pub turning: Vec<u32>,
}

impl Scene {
    /// Advances the scene from tⁿ to tⁿ⁺¹ (central differences, velocities at the half steps).
    ///
    /// - `measure`: whether the ledger of tⁿ is wanted; it costs one more sum over cells and nodes
    ///
    /// # Errors
    /// [`StepError`] when the balance that was measured does not close, or is not a number.
    pub fn step(&mut self, measure: bool) -> Result<StepReport, StepError> {
        self.step_observed(measure, |_| {})
    }

    /// [`Scene::step`], telling `passed` when a phase is over. A phase that the scene has no work for is not passed.
    ///
    /// # Errors
    /// As [`Scene::step`].
    pub fn step_observed(&mut self, measure: bool, mut passed: impl FnMut(Phase)) -> Result<StepReport, StepError> {
        let step = this_step(self, measure);
        start_box(self, &step);
        add_internal_forces(self, &step, &mut passed)?; // -∫ Bᵀσ dV; damage evolves
        let (bonded_load, faces) = add_bond_forces(self, &step, &mut passed);
        finish_expansion(self, &mut passed);
        let mut contact = add_contact_forces(self, step.elapsed, faces);
        if may_touch(self) {
            passed(Phase::Contact);
        }
        apply_tie_forces(self, &mut passed);
        let load = add_load_forces(self, &step, &mut passed) + bonded_load;
        add_surface_support_forces(self, step.is_first);
        contact += add_interface_forces(self, step.elapsed);
        contact += hold_solid_nodes(self, step.elapsed, step.measure);
        let given = if step.is_first { start_half_a_step_early(self, step.dt_before) } else { 0.0 };
        hold_departed_particles(self);
        remove_departed_particles(self, step.dt_before);
        let_particles_enter(self, &step);
        deform_box(self, &step)?;
        let expansion = conduct(self, step.dt_after, &mut passed)?;
        break_bonds(self, step.measure || step.changes, &mut passed);
        let mut work = advance(self, step.measure || step.changes, &mut passed); // vⁿ⁺½, uⁿ⁺¹
        work.after.external += expansion;
        work.before.external += load;
        book(self, &step, contact, work, given)?;
        book_box(self);
        self.optional.surface_supports.absorb_after(&mut self.solid, step.dt_after);
        passed(Phase::Motion);
        let report = change_solids(self, step.dt_after);
        if self.solid.has_damage() {
            passed(Phase::Transition);
        }
        look_at_debris(self, report.removed > 0, step.dt_after, &mut passed);
        let dt = next_dt(self, step.time + step.dt_after);
        self.clock.advance(dt);
        Ok(report)
    }
}

/// The forces between bodies that probes ask for.
pub(crate) fn sum_watched_contacts(scene: &mut Scene) {
    gather_watched(scene);
    let Scene { contacts, solid, debris, bonded, shape_contacts, .. } = scene;
    contacts.sum_watched(&Touching { solid, debris, particles: &bonded.particles, shapes: shape_contacts });
}

/// Elements that a crack has cut through leave; their nodes get discrete elements.
///
/// - `dt`: time since the forces were last computed [s]
pub(crate) fn release_cut_elements(scene: &mut Scene, dt: f64) -> StepReport {
    scene.removals.last.clear();
    if let Some((body, element)) = motion::crushed_element(&scene.solid) {
        scene.removals.tally.crushed += 1;
        scene.note(Notice::Crushed, Site::Element { body, element }, 1.0);
    }
    let energy = removal::remove_cut_elements(&mut scene.solid, dt, &mut scene.removals.last);
    let mut report = StepReport { removed: scene.removals.last.len(), ..StepReport::default() };
    if report.removed > 0 {
        follow_removal(scene);
        scene.books.removed += energy;
        lose_interfaces(scene);
        heat_loses_elements(scene);
        scene.loads.extend_cracks(&scene.solid, &scene.removals.last);
        let before = scene.debris.len();
        scene.debris.release(&scene.solid, &scene.removals.last);
        report.particles_born = scene.debris.len() - before;
        for ground in &mut scene.shape_contacts {
            for &node in &scene.debris.state().nodes[before..] {
                ground.watch_node(node, &scene.solid, &scene.debris);
            }
        }
        update_wall_frequency(scene);
        scene.bonded.gather_motion();
        let Scene { contacts, solid, debris, bonded, removals, .. } = scene;
        contacts.release(solid, debris, &bonded.particles, &removals.last, before);
        follow_near(scene);
        scene.removals.tally.since_check += report.removed;
    }
    // Cells that lost elements may be stiffer for their mass than any before.
    if scene.removals.tally.since_check > 0 && scene.clock.step.is_multiple_of(STEPS_BETWEEN_CHECKS) {
        scene.removals.tally.since_check = 0;
        if !scene.settings.time_step.element_bound {
            let present = scene.solid.stable_step();
            if present.frequency > scene.frequencies.stable.frequency {
                scene.frequencies.stable = present;
            }
            let fine = motion::fine_stable_step(&mut scene.solid, false);
            if fine.zip(scene.frequencies.fine).is_some_and(|(now, before)| now.frequency > before.frequency) {
                scene.frequencies.fine = fine;
            }
        }
    }
    report
}

/// Forces of interfaces between elements; what friction and the meeting of their sides took.
fn add_interface_forces(scene: &mut Scene, elapsed: f64) -> Work {
    if scene.interfaces().is_empty() {
        return Work::default();
    }
    let Scene { optional, solid, supports, clock, books, .. } = scene;
    let step = InterfaceStep { time: clock.time, elapsed, dt_after: clock.dt_after, held: supports.held() };
    let (work, taken) = optional.interfaces.add_forces(solid, &step);
    books.interfaces += taken;
    work
}

/// Faces of interfaces beside elements that have left are no more; what was stored in them went too.
fn lose_interfaces(scene: &mut Scene) {
    let Scene { optional, solid, removals, books, .. } = scene;
    let lost = optional.interfaces.lose(solid, &removals.last);
    books.removed += lost;
    books.interfaces -= lost;
}

/// Instants and sizes of the step that begins.
fn this_step(scene: &Scene, measure: bool) -> ThisStep {
    let is_first = scene.clock.begins_motion();
    let (time, dt_before, dt_after) = (scene.clock.time, scene.clock.dt_before, scene.clock.dt_after);
    ThisStep {
        is_first,
        measure: measure || is_first,
        changes: (dt_after - dt_before).abs() > SAME_STEP * dt_before,
        time,
        elapsed: if is_first { 0.0 } else { dt_before },
        dt_before,
        dt_after,
    }
}

/// Forces of the stress in solids at tⁿ.
fn add_internal_forces(scene: &mut Scene, step: &ThisStep, passed: &mut impl FnMut(Phase)) -> Result<(), StepError> {
    neighbours::move_all_nodes_next(&mut scene.solid, step.changes); // supports change their kinetic energy
    let parts = short_steps_in(scene, step.dt_after);
    motion::set_short_steps(&mut scene.solid, parts, step.is_first);
    if scene.solid.body_count() > 0 {
        scene.solid.update_internal_forces(step.elapsed, step.measure);
        refuse_inverted_elements(scene)?;
        passed(Phase::Solid);
    }
    Ok(())
}

/// Forces of loads and of gas at tⁿ; the work of loads in the half step before [J].
fn add_load_forces(scene: &mut Scene, step: &ThisStep, passed: &mut impl FnMut(Phase)) -> f64 {
    let load = scene.loads.add_forces(&mut scene.solid, step.time, step.dt_before);
    if scene.loads.gas().is_some() {
        passed(Phase::Motion);
        scene.loads.add_gas_forces(&mut scene.solid, &scene.optional.interfaces, step.time, step.elapsed);
        passed(Phase::Gas);
    }
    load
}

/// Finds what discrete elements may touch, and lets pieces leave.
fn look_at_debris(scene: &mut Scene, has_grown: bool, dt: f64, passed: &mut impl FnMut(Phase)) {
    scene.debris.search(&scene.solid);
    remove_departed_fragments(scene, dt);
    if !scene.debris.is_empty() {
        let renew = scene.clock.step.is_multiple_of(STEPS_BETWEEN_CHECKS);
        update_contact_frequency(scene, has_grown, renew);
        passed(Phase::Contact);
    }
}

fn refuse_inverted_elements(scene: &Scene) -> Result<(), StepError> {
    let inverted = motion::inverted_element(&scene.solid).filter(|inverted| !inverted.is_crushed());
    let Some(InvertedElement { body, element, centre, volume_ratio, .. }) = inverted else { return Ok(()) };
    let (step, time, dt, limit) = (scene.clock.step, scene.clock.time, scene.clock.dt_before, scene.stable_dt());
    let body = scene.solid.body(body).name.clone();
    let [x, y, z] = [centre.x, centre.y, centre.z];
    Err(StepError::Inverted { step, time, body, element, x, y, z, volume_ratio, dt, limit })
}

/// Forces of the bonds, of crack faces and of the loads on their particles; the work of loads in the half step
/// before [J], and that of crack faces.
fn add_bond_forces(scene: &mut Scene, step: &ThisStep, passed: &mut impl FnMut(Phase)) -> (f64, Work) {
    if scene.bonded.is_empty() {
        return (0.0, Work::default());
    }
    put_bonds_in_box(scene);
    let faces = scene.bonded.update_bond_forces(step.elapsed, step.measure);
    let load = scene.bonded.add_loads(step.time, step.dt_before);
    if scene.bonded.has_bonds() {
        passed(Phase::Bonds);
    }
    (load, faces)
}

/// Forces of supports on facets.
fn add_surface_support_forces(scene: &mut Scene, first: bool) {
    let Scene { optional, solid, supports, clock, .. } = scene;
    let surface_supports = &mut optional.surface_supports;
    surface_supports.push(solid);
    let dt_kick = 0.5 * (clock.dt_before + clock.dt_after);
    surface_supports.absorb(solid, supports.held(), [clock.dt_before, dt_kick], first);
}

/// Breaks the bonds that are overloaded at tⁿ, where there are any that can break.
fn break_bonds(scene: &mut Scene, measure: bool, passed: &mut impl FnMut(Phase)) {
    if scene.bonded.can_break() {
        passed(Phase::Motion);
        scene.bonded.break_overloaded(scene.clock.step, scene.clock.time, measure);
        passed(Phase::Fracture);
    }
}

/// Hands the forces of tied particles to the solids, where there are any; all ranks know the forces on what all of them move.
fn apply_tie_forces(scene: &mut Scene, passed: &mut impl FnMut(Phase)) {
    scene.bonded.exchange_forces();
    if !scene.ties.is_empty() {
        scene.ties.pass_on(&mut scene.solid, &mut scene.bonded.particles);
        passed(Phase::Ties);
    }
}

/// Whether there is anything that could touch: particles, discrete elements, rigid bodies, or solids apart.
fn may_touch(scene: &Scene) -> bool {
    !(scene.contacts.is_empty() && scene.shape_contacts.is_empty() && scene.debris.is_empty())
}

/// Has rigid shapes hold nodes of solids against all other forces; all contacts are known then.
///
/// - `elapsed`: step that led here [s]
fn hold_solid_nodes(scene: &mut Scene, elapsed: f64, measure: bool) -> Work {
    let Scene { shape_contacts, contacts, solid, supports, settings, clock, .. } = scene;
    let (dt_after, damping, held) = (clock.dt_after, settings.damping, supports.held());
    let dt_kick = 0.5 * (elapsed + dt_after);
    let step = HoldStep { time: clock.time, elapsed, dt_kick, dt_after, damping, held };
    let work = hold_nodes(shape_contacts, contacts.rigid_bodies_mut(), solid, &step);
    scene.books.stopped += work.damping;
    if measure {
        sum_watched_contacts(scene);
    }
    work
}

/// - `work`: that of the contacts counted so far
fn add_contact_forces(scene: &mut Scene, dt: f64, mut work: Work) -> Work {
    search_together(scene);
    if !scene.contacts.is_empty() {
        let Scene { contacts, solid, bonded, .. } = scene;
        work += bonded.with_part(|part, particles| contacts.add_forces(part, solid, particles, dt));
    }
    if scene.debris.is_empty() && scene.shape_contacts.is_empty() && !scene.contacts.has_node_contacts() {
        return work;
    }
    work += scene.debris.add_forces(&mut scene.solid, dt);
    let Scene { contacts, solid, debris, bonded, .. } = scene;
    let searches = !bonded.is_distributed();
    work += contacts.add_node_forces(solid, debris, &mut bonded.particles, searches, dt);
    for ground in &mut scene.shape_contacts {
        work += ground.add_forces(scene.contacts.rigid_bodies_mut(), &mut scene.solid, &mut scene.debris, dt);
    }
    scene.debris.pass_on_torques(&mut scene.solid);
    work
}

/// Bodies that begin to turn become corotational, and cut elements leave.
fn change_solids(scene: &mut Scene, dt: f64) -> StepReport {
    let mut turning = Vec::new();
    if scene.optional.is_between_equilibria {
        return release_cut_elements(scene, dt);
    }
    // What small strains had found beyond was never put in.
    if scene.clock.begins_motion() {
        scene.books.time_step += motion::let_spin(&mut scene.solid, scene.settings.time_step.end, dt, &mut turning);
    }
    scene.books.time_step += motion::let_turn(&mut scene.solid, scene.clock.step, dt, &mut turning);
    StepReport { turning, ..release_cut_elements(scene, dt) }
}
