use fractum_dem::Particles;
use fractum_fem::{InvertedElement, motion, neighbours, removal};
use fractum_math::{HalfSteps, Work};

use crate::contacts::{HoldStep, Touching, hold_nodes};
use crate::error::StepError;
use crate::scene::Scene;
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

/// The step around tⁿ that is being done.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ThisStep {
    /// Whether motion begins with it.
    pub(crate) is_first: bool,
    /// Whether the ledger of tⁿ is wanted.
    pub(crate) measure: bool,
    /// Whether the steps before and after tⁿ differ.
    pub(crate) changes: bool,
    /// tⁿ [s].
    pub(crate) time: f64,
    /// Time since the forces of before; zero where nothing has moved [s].
    pub(crate) elapsed: f64,
    /// Step to tⁿ [s].
    pub(crate) dt_before: f64,
    /// Step from tⁿ [s].
    pub(crate) dt_after: f64,
}

/// A part of the step, for those who time it. A step passes those alone that its scene has work for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Phase {
    /// Internal forces, damage included.
    Solid,
    /// Motion and internal forces in short steps, of the cells that need them.
    Subcycling,
    /// Temperatures, and the strains that follow them.
    Heat,
    /// Forces of the bonds, and the loads on their particles.
    Bonds,
    /// Search for overloaded bonds, and their breaking.
    Fracture,
    /// Contact of particles and rigid bodies, search included.
    Contact,
    /// Forces that tied particles hand to solids.
    Ties,
    /// Gas in holes and cracks.
    Gas,
    /// Loads, supports and the motion of the nodes.
    Motion,
    /// Removal of elements and birth of particles.
    Transition,
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
        let step = self.this_step(measure);
        self.add_internal_forces(&step, &mut passed)?; // -∫ Bᵀσ dV; damage evolves
        let (bonded_load, faces) = self.add_bond_forces(&step, &mut passed);
        self.finish_expansion(&mut passed);
        let mut contact = self.add_contact_forces(step.elapsed, faces);
        if self.may_touch() {
            passed(Phase::Contact);
        }
        self.pass_on_ties(&mut passed);
        let load = self.add_load_forces(&step, &mut passed) + bonded_load;
        self.add_surface_support_forces(step.is_first);
        contact += self.hold_nodes(step.elapsed, step.measure);
        let given = if step.is_first { self.start_half_a_step_early(step.dt_before) } else { 0.0 };
        self.let_left_rest();
        self.let_particles_leave(step.dt_before);
        let expansion = self.conduct(step.dt_after, &mut passed)?;
        self.break_bonds(step.measure || step.changes, &mut passed);
        let mut work = self.advance(step.measure || step.changes, &mut passed); // vⁿ⁺½, uⁿ⁺¹
        work.after.external += expansion;
        work.before.external += load;
        self.book(&step, contact, work, given)?;
        self.optional.surface_supports.absorb_after(&mut self.solid, step.dt_after);
        passed(Phase::Motion);
        let report = self.change_solids(step.dt_after);
        if self.solid.has_damage() {
            passed(Phase::Transition);
        }
        self.look_at_debris(report.removed > 0, step.dt_after, &mut passed);
        let dt = self.next_dt(step.time + step.dt_after);
        self.clock.advance(dt);
        Ok(report)
    }

    /// Instants and sizes of the step that begins.
    fn this_step(&self, measure: bool) -> ThisStep {
        let is_first = self.clock.begins_motion();
        let (time, dt_before, dt_after) = (self.clock.time, self.clock.dt_before, self.clock.dt_after);
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
    fn add_internal_forces(&mut self, step: &ThisStep, passed: &mut impl FnMut(Phase)) -> Result<(), StepError> {
        neighbours::move_all_nodes_next(&mut self.solid, step.changes); // supports change their kinetic energy
        let parts = self.parts(step.dt_after);
        motion::set_short_steps(&mut self.solid, parts, step.is_first);
        if self.solid.body_count() > 0 {
            self.solid.update_internal_forces(step.elapsed, step.measure);
            self.refuse_inverted_elements()?;
            passed(Phase::Solid);
        }
        Ok(())
    }

    /// Forces of loads and of gas at tⁿ; the work of loads in the half step before [J].
    fn add_load_forces(&mut self, step: &ThisStep, passed: &mut impl FnMut(Phase)) -> f64 {
        let load = self.loads.add_forces(&mut self.solid, step.time, step.dt_before);
        if self.loads.gas().is_some() {
            passed(Phase::Motion);
            self.loads.add_gas_forces(&mut self.solid, step.time, step.elapsed);
            passed(Phase::Gas);
        }
        load
    }

    /// Finds what discrete elements may touch, and lets pieces leave.
    fn look_at_debris(&mut self, has_grown: bool, dt: f64, passed: &mut impl FnMut(Phase)) {
        self.debris.search(&self.solid);
        self.let_pieces_leave(dt);
        if !self.debris.is_empty() {
            let renew = self.clock.step.is_multiple_of(STEPS_BETWEEN_CHECKS);
            self.update_contact_frequency(has_grown, renew);
            passed(Phase::Contact);
        }
    }

    fn refuse_inverted_elements(&self) -> Result<(), StepError> {
        let inverted = motion::inverted_element(&self.solid).filter(|inverted| !inverted.is_crushed());
        let Some(InvertedElement { body, element, centre, volume_ratio, .. }) = inverted else { return Ok(()) };
        let (step, time, dt, limit) = (self.clock.step, self.clock.time, self.clock.dt_before, self.stable_dt());
        let body = self.solid.body(body).name.clone();
        let [x, y, z] = [centre.x, centre.y, centre.z];
        Err(StepError::Inverted { step, time, body, element, x, y, z, volume_ratio, dt, limit })
    }

    /// Forces of the bonds, of crack faces and of the loads on their particles; the work of loads in the half step
    /// before [J], and that of crack faces.
    fn add_bond_forces(&mut self, step: &ThisStep, passed: &mut impl FnMut(Phase)) -> (f64, Work) {
        if self.bonded.is_empty() {
            return (0.0, Work::default());
        }
        let faces = self.bonded.update_bond_forces(step.elapsed, step.measure);
        let load = self.bonded.add_loads(step.time, step.dt_before);
        if self.bonded.has_bonds() {
            passed(Phase::Bonds);
        }
        (load, faces)
    }

    /// Forces of supports on facets.
    fn add_surface_support_forces(&mut self, first: bool) {
        let Scene { optional, solid, supports, clock, .. } = self;
        let surface_supports = &mut optional.surface_supports;
        surface_supports.push(solid);
        let dt_kick = 0.5 * (clock.dt_before + clock.dt_after);
        surface_supports.absorb(solid, supports.held(), [clock.dt_before, dt_kick], first);
    }

    /// Breaks the bonds that are overloaded at tⁿ, where there are any that can break.
    fn break_bonds(&mut self, measure: bool, passed: &mut impl FnMut(Phase)) {
        if self.bonded.can_break() {
            passed(Phase::Motion);
            self.bonded.break_overloaded(self.clock.step, self.clock.time, measure);
            passed(Phase::Fracture);
        }
    }

    /// Hands the forces of tied particles to the solids, where there are any; all ranks know the forces on what all of them move.
    fn pass_on_ties(&mut self, passed: &mut impl FnMut(Phase)) {
        self.bonded.exchange_forces();
        if !self.ties.is_empty() {
            self.ties.pass_on(&mut self.solid, &mut self.bonded.particles);
            passed(Phase::Ties);
        }
    }

    /// Whether there is anything that could touch: particles, discrete elements, rigid bodies, or solids apart.
    fn may_touch(&self) -> bool {
        !self.contacts.is_empty() || self.has_contacts()
    }

    pub(crate) fn move_bonded(&mut self, measure: bool) -> HalfSteps {
        if self.bonded.is_empty() {
            return HalfSteps::default();
        }
        let Scene { bonded, ties, solid, settings, clock, .. } = self;
        let follow = |particles: &mut Particles| ties.follow(solid, particles);
        bonded.advance(*clock, settings.damping, measure, follow)
    }

    /// The forces between bodies that probes ask for.
    pub(crate) fn sum_watched_contacts(&mut self) {
        self.gather_watched();
        let Scene { contacts, solid, debris, bonded, shape_contacts, .. } = self;
        contacts.sum_watched(&Touching { solid, debris, particles: &bonded.particles, shapes: shape_contacts });
    }

    /// Has rigid shapes hold nodes of solids against all other forces; all contacts are known then.
    ///
    /// - `elapsed`: step that led here [s]
    fn hold_nodes(&mut self, elapsed: f64, measure: bool) -> Work {
        let Scene { shape_contacts, contacts, solid, supports, settings, clock, .. } = self;
        let (dt_after, damping, held) = (clock.dt_after, settings.damping, supports.held());
        let dt_kick = 0.5 * (elapsed + dt_after);
        let step = HoldStep { time: clock.time, elapsed, dt_kick, dt_after, damping, held };
        let work = hold_nodes(shape_contacts, contacts.rigid_bodies_mut(), solid, &step);
        self.books.stopped += work.damping;
        if measure {
            self.sum_watched_contacts();
        }
        work
    }

    /// - `work`: that of the contacts counted so far
    fn add_contact_forces(&mut self, dt: f64, mut work: Work) -> Work {
        self.search_together();
        if !self.contacts.is_empty() {
            let Scene { contacts, solid, bonded, .. } = self;
            work += bonded.with_part(|part, particles| contacts.add_forces(part, solid, particles, dt));
        }
        if self.debris.is_empty() && self.shape_contacts.is_empty() && !self.contacts.has_node_contacts() {
            return work;
        }
        work += self.debris.add_forces(&mut self.solid, dt);
        let Scene { contacts, solid, debris, bonded, .. } = self;
        let searches = !bonded.is_shared();
        work += contacts.add_node_forces(solid, debris, &mut bonded.particles, searches, dt);
        for ground in &mut self.shape_contacts {
            work += ground.add_forces(self.contacts.rigid_bodies_mut(), &mut self.solid, &mut self.debris, dt);
        }
        self.debris.pass_on_torques(&mut self.solid);
        work
    }

    /// Bodies that begin to turn become corotational, and cut elements leave.
    fn change_solids(&mut self, dt: f64) -> StepReport {
        let mut turning = Vec::new();
        // What small strains had found beyond was never put in.
        self.books.time_step += motion::let_turn(&mut self.solid, self.clock.step, dt, &mut turning);
        StepReport { turning, ..self.release_cut_elements(dt) }
    }

    /// Elements that a crack has cut through leave; their nodes get discrete elements.
    ///
    /// - `dt`: time since the forces were last computed [s]
    pub(crate) fn release_cut_elements(&mut self, dt: f64) -> StepReport {
        self.removals.last.clear();
        if let Some((body, element)) = motion::crushed_element(&self.solid) {
            self.removals.tally.crushed += 1;
            self.note(Notice::Crushed, Site::Element { body, element }, 1.0);
        }
        let energy = removal::remove_cut_elements(&mut self.solid, dt, &mut self.removals.last);
        let mut report = StepReport { removed: self.removals.last.len(), ..StepReport::default() };
        if report.removed > 0 {
            self.follow_removal();
            self.books.removed += energy;
            self.heat_loses_elements();
            self.loads.extend_cracks(&self.solid, &self.removals.last);
            let before = self.debris.len();
            self.debris.release(&self.solid, &self.removals.last);
            report.particles_born = self.debris.len() - before;
            for ground in &mut self.shape_contacts {
                for &node in &self.debris.state().nodes[before..] {
                    ground.watch_node(node, &self.solid, &self.debris);
                }
            }
            self.update_wall_frequency();
            self.bonded.gather_motion();
            let Scene { contacts, solid, debris, bonded, removals, .. } = self;
            contacts.release(solid, debris, &bonded.particles, &removals.last, before);
            self.follow_near();
            self.removals.tally.since_check += report.removed;
        }
        // Cells that lost elements may be stiffer for their mass than any before.
        if self.removals.tally.since_check > 0 && self.clock.step.is_multiple_of(STEPS_BETWEEN_CHECKS) {
            self.removals.tally.since_check = 0;
            if !self.settings.time_step.element_bound {
                let present = self.solid.stable_step();
                if present.frequency > self.frequencies.stable.frequency {
                    self.frequencies.stable = present;
                }
                let fine = motion::fine_stable_step(&mut self.solid, false);
                if fine.zip(self.frequencies.fine).is_some_and(|(now, before)| now.frequency > before.frequency) {
                    self.frequencies.fine = fine;
                }
            }
        }
        report
    }
}
