//! From equilibrium to motion where a step has no equilibrium, and back once the motion has died.

use fractum_contact::Frame;
use fractum_fem::{LocalDamping, motion};
use fractum_math::Vec3;
use serde::{Deserialize, Serialize};

use super::Stiffness;
use super::slowest::size;
use crate::clock::Frequencies;
use crate::error::StepError;
use crate::ledger::EnergyKind;
use crate::scene::Scene;
use crate::stable_step::{next_dt, update_contact_frequency, update_wall_frequency};

/// Kinetic over elastic energy below which motion has died, with a small part of all energy put in beside the elastic one: a
/// body in two holds none.
const AT_REST: f64 = 1e-5;
const SMALL: f64 = 1e-3;
/// Damping over the critical one of the first period where none is given: what then moves creeps.
const DAMPING: f64 = 2.0;
/// Looks at the energies per first period.
const LOOKS: f64 = 20.0;
/// Where no period is found: ways of a wave across the solid that take its place.
const CROSSINGS: f64 = 20.0;

/// Motion between two states of equilibrium.
///
/// The scene starts from rest, with the forces that its supports and loads have then; time goes on as real time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DynamicPhase {
    /// Time at which it began [s].
    pub begin: f64,
    /// First period of the solid as it was then [s].
    pub period: f64,
    /// Time for which it lasts at least [s].
    pub least: f64,
    /// Largest kinetic energy so far [J].
    pub most_kinetic: f64,
    damping: LocalDamping,
    /// Time of the next look at the energies [s].
    next_look: f64,
}

impl DynamicPhase {
    /// Whether to [`Scene::look`] at the energies in this step.
    pub fn look_is_due(&self, time: f64) -> bool {
        time >= self.next_look
    }
}

impl Scene {
    /// Lets the scene move from rest.
    ///
    /// - `damping`: instead of twice the critical damping of the first period
    /// - `periods`: first periods for which it moves at least
    pub fn begin_motion(&mut self, damping: Option<LocalDamping>, periods: f64) -> DynamicPhase {
        let time = self.clock.time;
        let period = period_as_it_is(self, time);
        let critical = 4.0 * std::f64::consts::PI / period;
        let damping = damping.unwrap_or(LocalDamping { local: 0.0, mass_rate: DAMPING * critical });
        self.settings.damping = damping;
        self.optional.is_between_equilibria = true;
        move_from_rest(self, false);
        DynamicPhase {
            begin: time,
            period,
            least: periods * period,
            most_kinetic: 0.0,
            damping,
            next_look: time + period / LOOKS,
        }
    }

    /// Lets motion begin at the present state, which is at rest, with the next step.
    pub fn start_from_rest(&mut self) {
        move_from_rest(self, self.settings.time_step.element_bound);
    }

    /// Finds the time step anew, for the solids as they are and the settings of the scene.
    pub fn renew_step(&mut self) {
        find_step(self, self.settings.time_step.element_bound);
    }

    /// Goes on with motion that a checkpoint interrupted.
    pub fn resume_motion(&mut self, interlude: &DynamicPhase) {
        self.settings.damping = interlude.damping;
        self.optional.is_between_equilibria = true;
    }

    /// Advances the scene by a step with its ledger; ends the motion at the beginning of that step if it has died by then,
    /// and says so. The kinetic energy that was left is booked as damping.
    ///
    /// # Errors
    /// As [`Scene::step`].
    pub fn look(&mut self, interlude: &mut DynamicPhase) -> Result<bool, StepError> {
        let (clock, displacement, heat) = (self.clock, self.solid.displacement.clone(), self.heat_state());
        let frames: Vec<Frame> = self.contacts.rigid_bodies().iter().map(|rigid_body| rigid_body.frame).collect();
        let report = self.step(true)?;
        let kinetic = self.ledger[EnergyKind::Kinetic];
        interlude.next_look = self.clock.time + interlude.period / LOOKS;
        interlude.most_kinetic = interlude.most_kinetic.max(kinetic);
        let early = clock.time < interlude.begin + interlude.least;
        if early
            || report.removed > 0
            || kinetic > AT_REST * (self.ledger[EnergyKind::Elastic] + SMALL * self.ledger.scale)
        {
            return Ok(false);
        }
        // What the step did after its energies were taken is taken back.
        self.clock = clock;
        self.solid.displacement = displacement;
        self.restore_heat(heat);
        self.solid.velocity.fill(Vec3::zeros());
        self.debris.stop();
        for (rigid_body, frame) in self.contacts.rigid_bodies_mut().iter_mut().zip(frames) {
            rigid_body.frame = Frame { velocity: Vec3::zeros(), ..frame };
        }
        self.books.external = self.ledger[EnergyKind::External];
        self.books.damping = self.ledger[EnergyKind::Damping] - self.solid.viscous_dissipation() + kinetic;
        self.books.time_step = self.ledger[EnergyKind::TimeStep];
        self.ledger[EnergyKind::Damping] += kinetic;
        self.ledger[EnergyKind::Kinetic] = 0.0;
        Ok(true)
    }
}

fn move_from_rest(scene: &mut Scene, element_bound: bool) {
    // Tangential springs let go: none stores energy at rest. Constraints hold what they held.
    let candidates = scene.shape_contacts.iter_mut().flat_map(|ground| &mut ground.candidates);
    candidates.for_each(|c| (c.memory.slip, c.brought_back) = (Vec3::zeros(), Vec3::zeros()));
    find_step(scene, element_bound);
    let clock = &mut scene.clock;
    (clock.dt_before, clock.dt_min) = (clock.dt_after, clock.dt_min.min(clock.dt_after));
    clock.motion_since = clock.step;
}

fn find_step(scene: &mut Scene, element_bound: bool) {
    let stable = if element_bound { motion::stable_step_bound(&scene.solid) } else { scene.solid.stable_step() };
    scene.frequencies = Frequencies::of(stable, None);
    scene.debris.search(&scene.solid);
    update_wall_frequency(scene);
    update_contact_frequency(scene, true, true);
    scene.clock.dt_after = next_dt(scene, scene.clock.time);
}

fn period_as_it_is(scene: &mut Scene, time: f64) -> f64 {
    let found = Stiffness::new(scene).and_then(|mut stiffness| {
        stiffness.prepare(scene)?;
        stiffness.first_period(scene, time)
    });
    found.ok().filter(|period| period.is_finite()).unwrap_or_else(|| {
        let speed = |body| scene.solid.body(body).bulk_wave_speed();
        let slowest = (0..scene.solid.body_count()).map(speed).fold(f64::INFINITY, f64::min);
        CROSSINGS * size(scene.solid.reference.iter()) / slowest
    })
}
