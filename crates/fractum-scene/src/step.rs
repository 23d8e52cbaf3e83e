use fractum_dem::Particles;
use fractum_fem::InvertedElement;
use fractum_math::{HalfSteps, Vec3, Work};

use crate::contacts::{HoldStep, Touching, hold_nodes};
use crate::error::StepError;
use crate::ledger::EnergyKind;
use crate::scene::Scene;
use crate::watch::{Notice, Site};

/// Elastic energy over all energy put in, above which a run is unstable: a mode of the highest frequency at 0.95 of the
/// stable step reaches 10.
const UNSTABLE_RATIO: f64 = 20.0;

/// Part of the energy of in-situ stress below which an energy is what rounding leaves.
const IN_SITU_ROUND_OFF: f64 = 1e-9;

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
        let first = self.clock.begins_motion();
        let measure = measure || first;
        let (time, dt_before, dt_after) = (self.clock.time, self.clock.dt_before, self.clock.dt_after);
        // Nothing has moved before.
        let elapsed = if first { 0.0 } else { dt_before };
        let step_changes = (dt_after - dt_before).abs() > SAME_STEP * dt_before;
        self.solid.move_all_nodes_next(step_changes); // supports change their kinetic energy
        self.solid.set_parts(self.parts(dt_after), first);
        if self.solid.body_count() > 0 {
            self.solid.update_internal_forces(elapsed, measure); // -∫ Bᵀσ dV; damage evolves
            self.refuse_inverted_elements()?;
            passed(Phase::Solid);
        }
        let (bonded_load, faces) = self.add_bond_forces(time, elapsed, dt_before, measure);
        if self.bonded.has_bonds() {
            passed(Phase::Bonds);
        }
        if self.optional.heat.is_some() {
            self.finish_expansion();
            passed(Phase::Heat);
        }
        let mut contact = self.add_contact_forces(elapsed, faces);
        if self.may_touch() {
            passed(Phase::Contact);
        }
        self.pass_on_ties(&mut passed);
        let load = self.loads.add_forces(&mut self.solid, time, dt_before) + bonded_load;
        if self.loads.gas().is_some() {
            passed(Phase::Motion);
            self.loads.add_gas_forces(&mut self.solid, time, elapsed);
            passed(Phase::Gas);
        }
        self.add_surface_support_forces(first);
        contact += self.hold_nodes(elapsed, measure);
        let given = if first { self.start_half_a_step_early(dt_before) } else { 0.0 };
        self.let_left_rest();
        self.let_particles_leave(dt_before);
        let expansion = self.conduct(dt_after, &mut passed)?;
        self.break_bonds(measure || step_changes, &mut passed);
        let mut work = self.advance(measure || step_changes, &mut passed); // vⁿ⁺½, uⁿ⁺¹
        work.after.external += expansion;
        work.before.external += load;

        self.books += contact;
        if !first {
            self.books += work.before;
        }
        if measure {
            // What central differences keep less of the energy of a start out of balance, ⅛ Δt² Σ F²/m, but for what shapes stop.
            let missing = if first { (given - work.before.kinetic).max(0.0) - contact.damping } else { 0.0 };
            self.ledger[EnergyKind::Kinetic] = work.before.kinetic + missing;
            self.ledger[EnergyKind::Contact] = contact.stored;
            self.close_balance()?;
            self.books.time_step += missing;
        }
        if step_changes {
            self.books.time_step += work.before.kinetic - work.after.kinetic;
        }
        self.books += work.after;
        self.optional.surface_supports.absorb_after(&mut self.solid, dt_after);
        passed(Phase::Motion);

        let report = self.change_solids(dt_after);
        if self.solid.has_damage() {
            passed(Phase::Transition);
        }
        self.debris.search(&self.solid);
        self.let_pieces_leave(dt_after);
        if !self.debris.is_empty() {
            let renew = self.clock.step.is_multiple_of(STEPS_BETWEEN_CHECKS);
            self.update_contact_frequency(report.removed > 0, renew);
            passed(Phase::Contact);
        }
        let dt = self.next_dt(time + dt_after);
        self.clock.advance(dt);
        Ok(report)
    }

    fn refuse_inverted_elements(&self) -> Result<(), StepError> {
        let inverted = self.solid.inverted_element().filter(|inverted| !inverted.is_crushed());
        let Some(InvertedElement { body, element, centre, volume_ratio, .. }) = inverted else { return Ok(()) };
        let (step, time, dt, limit) = (self.clock.step, self.clock.time, self.clock.dt_before, self.stable_dt());
        let body = self.solid.body(body).name.clone();
        let [x, y, z] = [centre.x, centre.y, centre.z];
        Err(StepError::Inverted { step, time, body, element, x, y, z, volume_ratio, dt, limit })
    }

    /// Forces of the bonds, of crack faces and of the loads on their particles; the work of loads in the half step
    /// before [J], and that of crack faces.
    fn add_bond_forces(&mut self, time: f64, elapsed: f64, dt_before: f64, measure: bool) -> (f64, Work) {
        if self.bonded.is_empty() {
            return (0.0, Work::default());
        }
        let faces = self.bonded.update_bond_forces(elapsed, measure);
        (self.bonded.add_loads(time, dt_before), faces)
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
        self.bonded.tell_forces();
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
        self.books.time_step += self.solid.let_turn(self.clock.step, dt, &mut turning);
        StepReport { turning, ..self.release_cut_elements(dt) }
    }

    /// Elements that a crack has cut through leave; their nodes get discrete elements.
    ///
    /// - `dt`: time since the forces were last computed [s]
    pub(crate) fn release_cut_elements(&mut self, dt: f64) -> StepReport {
        self.removals.last.clear();
        if let Some((body, element)) = self.solid.crushed_element() {
            self.removals.crushed += 1;
            self.note(Notice::Crushed, Site::Element { body, element }, 1.0);
        }
        let energy = self.solid.remove_cut_elements(dt, &mut self.removals.last);
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
            self.removals.since_check += report.removed;
        }
        // Cells that lost elements may be stiffer for their mass than any before.
        if self.removals.since_check > 0 && self.clock.step.is_multiple_of(STEPS_BETWEEN_CHECKS) {
            self.removals.since_check = 0;
            if !self.settings.time_step.element_bound {
                let present = self.solid.stable_step();
                if present.frequency > self.frequencies.stable.frequency {
                    self.frequencies.stable = present;
                }
                let fine = self.solid.fine_stable_step(false);
                if fine.zip(self.frequencies.fine).is_some_and(|(now, before)| now.frequency > before.frequency) {
                    self.frequencies.fine = fine;
                }
            }
        }
        report
    }

    /// Completes the ledger of tⁿ and holds it against the guard.
    fn close_balance(&mut self) -> Result<(), StepError> {
        let Scene { ledger, solid, bonded, books, contacts, optional, .. } = self;
        optional.surface_supports.gather(solid);
        let bonds = bonded.energy();
        ledger[EnergyKind::BondTension] = bonds.tension;
        ledger[EnergyKind::BondBending] = bonds.bending;
        ledger[EnergyKind::BondTorsion] = bonds.torsion;
        ledger[EnergyKind::Elastic] = solid.elastic_energy() + bonds.total();
        // The sum over no block at all is -0.
        ledger[EnergyKind::Damage] = solid.dissipated_energy() + bonded.dissipated_energy() + 0.0;
        ledger[EnergyKind::External] = books.external;
        ledger[EnergyKind::Removed] = books.removed + bonded.released_energy();
        ledger[EnergyKind::Friction] = books.friction;
        ledger[EnergyKind::Damping] = books.damping + solid.viscous_dissipation();
        ledger[EnergyKind::TimeStep] = books.time_step;
        ledger[EnergyKind::Absorbed] = books.absorbed + optional.surface_supports.absorbed();
        ledger[EnergyKind::Left] = books.left;
        ledger[EnergyKind::Foundation] = optional.surface_supports.stored();
        if self.clock.step == 0 {
            ledger.initial = ledger[EnergyKind::Kinetic] + ledger[EnergyKind::Elastic] + ledger[EnergyKind::Contact];
            ledger.initial += ledger[EnergyKind::Damping]; // rigid shapes stop what meets them at once
            if !solid.initial_displacement.is_empty() {
                ledger.in_situ = ledger[EnergyKind::Elastic];
            }
            // Less than this is no energy: bodies that wait for a rigid body move by what rounding leaves, and so does rock
            // under stress.
            ledger.scale = bonded.round_off_energy(self.clock.dt_after) + IN_SITU_ROUND_OFF * ledger.in_situ;
        }
        if let Some(gas) = self.loads.gas() {
            let [held, supplied, leaked] = gas.energies();
            ledger[EnergyKind::Gas] = held;
            ledger[EnergyKind::GasSupplied] = supplied;
            ledger[EnergyKind::GasLeaked] = leaked;
            // What the gas has done is in play; what it holds may be much more.
            ledger.scale = ledger.scale.max((supplied - held - leaked).abs());
        }
        // The first touch of a rigid body is found to a step only; it is measured by what a particle takes from it, not by the little
        // work done so far.
        ledger.scale = ledger.scale.max(contacts.touch_energy(&bonded.particles));
        ledger.update_maxima();
        let (relative, finite) = (ledger.relative_residual(), ledger.residual().is_finite());
        let (step, time, dt, limit) = (self.clock.step, self.clock.time, self.clock.dt_after, self.stable_dt());
        if !finite || !relative.is_finite() {
            return Err(StepError::NotFinite { step, time, dt, limit, culprit: self.culprit() });
        }
        // An unstable run keeps the discrete balance while it blows up: its energies grow with opposite signs.
        let ratio = (self.ledger[EnergyKind::Elastic] - self.ledger.in_situ) / self.ledger.scale;
        if ratio > UNSTABLE_RATIO {
            return Err(StepError::Unstable { step, time, ratio, dt, limit, culprit: self.culprit() });
        }
        let allowed = self.settings.balance_stop;
        if relative > allowed {
            return Err(StepError::Unbalanced { step, time, relative, allowed, dt, limit, culprit: self.culprit() });
        }
        Ok(())
    }

    /// The ledger of a state of equilibrium.
    pub(crate) fn book_equilibrium(&mut self) -> Result<(), StepError> {
        let Scene { ledger, solid, books, .. } = self;
        ledger[EnergyKind::Elastic] = solid.elastic_energy();
        ledger[EnergyKind::Damage] = solid.dissipated_energy();
        ledger[EnergyKind::External] = books.external;
        ledger[EnergyKind::Removed] = books.removed;
        ledger[EnergyKind::Friction] = books.friction;
        ledger[EnergyKind::Damping] = books.damping + solid.viscous_dissipation();
        ledger[EnergyKind::TimeStep] = books.time_step;
        ledger.update_maxima();
        if ledger.residual().is_finite() {
            return Ok(());
        }
        let (step, time, dt, limit) = (self.clock.step, self.clock.time, self.clock.dt_before, f64::INFINITY);
        Err(StepError::NotFinite { step, time, dt, limit, culprit: self.culprit() })
    }

    /// The element or bonded particle with the largest kinetic energy, or with a value that is not a number.
    fn culprit(&mut self) -> String {
        self.gather_ranks();
        let solid = &self.solid;
        let energy = |node: u32| {
            let i = node as usize;
            let energy = solid.mass[i] * solid.velocity[i].norm_squared();
            if energy.is_finite() && solid.displacement[i].iter().all(|c| c.is_finite()) {
                energy
            } else {
                f64::INFINITY
            }
        };
        let mut worst = (-1.0, 0, 0);
        for body in 0..solid.body_count() {
            let corners = solid.body(body).shape.node_count();
            for (element, nodes) in solid.body(body).elements.iter().enumerate() {
                let sum: f64 = nodes[..corners].iter().map(|&n| energy(n)).sum();
                if sum > worst.0 {
                    worst = (sum, body, element);
                }
            }
        }
        let (largest, body, element) = worst;
        if let Some((energy, particle)) = self.bonded.fastest()
            && energy > largest
        {
            return particle;
        }
        let nodes = &solid.body(body).elements[element];
        let centre: Vec3 = nodes.iter().map(|&n| solid.reference[n as usize]).sum::<Vec3>() / 4.0;
        format!(
            "element {element} of body {} at ({:.4e}, {:.4e}, {:.4e}) m",
            solid.body(body).name,
            centre.x,
            centre.y,
            centre.z
        )
    }
}
