//! The largest stable step of a scene.

use fractum_fem::{StableStep, motion};

use crate::clock::{Clock, Frequencies, TimeStepSettings};
use crate::gas::Gas;
use crate::scene::Scene;

/// How much faster than it is a wall contact counts in the stable step: the whole weight of a body may come on few of
/// them, and half a period of contact wants some twenty steps for the energy balance.
const RESOLUTION: f64 = 4.0;

/// Phase of the motion that starts a run [rad] beyond which a step leads damaged edges past their onset at once: what they take then
/// is no longer what the forces at both ends of the step do, and the energy balance is off by some 1e-2 (`docs/stress.md`).
const PHASE: f64 = 0.75;

impl Scene {
    /// Largest stable step of the solid by itself, and what governs it; none where bonds or contacts ask for a
    /// smaller one.
    pub fn governing_element(&self) -> Option<StableStep> {
        let bonds = self.bonded.frequency().max(self.ties.frequency());
        let others = bonds.max(self.contacts.frequency_square().sqrt());
        (self.frequencies.stable.frequency >= others && self.solid.body_count() > 0).then_some(self.frequencies.stable)
    }

    /// Whether the contacts of particles ask for a smaller step than elements and bonds.
    pub fn contacts_govern(&self) -> bool {
        let bodies = self.frequencies.stable.frequency.max(self.bonded.frequency()).max(self.ties.frequency());
        self.contacts.frequency_square().sqrt() > bodies
    }

    /// Largest stable step with contacts and damping [s]; of the cells with long steps where others take short ones.
    ///
    /// Contacts know no short steps: where something may touch, all cells take those of the fine ones.
    pub fn stable_dt(&self) -> f64 {
        let (Frequencies { stable, fine, .. }, contacts) = (self.frequencies, contact_frequency_square(self));
        let stable = match fine {
            Some(fine) if contacts > 0.0 => stable_dt_at(self, fine.frequency, contacts),
            _ => stable_dt_at(self, stable.frequency, contacts),
        };
        let motion = self.frequencies.motion;
        if motion * stable > PHASE { PHASE / motion } else { stable }
    }

    /// Whether given velocities that change from node to node ask for a smaller step than stability does.
    pub fn given_velocities_govern(&self) -> bool {
        self.frequencies.motion > 0.0 && self.stable_dt() == PHASE / self.frequencies.motion
    }

    /// Whether a rigid body holds the nodes of solids that touch it in motion, by its number; springs press on them elsewhere. Known once the
    /// first step is.
    pub fn holds_nodes(&self, rigid_body: usize) -> bool {
        self.shape_contacts.iter().any(|ground| ground.rigid_body() == Some(rigid_body) && ground.holds_points())
    }
}

/// - `solids`: highest frequency of the solids by themselves [rad/s]
/// - `contacts`: square of that of contacts [1/s²]
pub(crate) fn stable_dt_at(scene: &Scene, solids: f64, contacts: f64) -> f64 {
    let divisor = scene.bonded.step_divisor();
    let frequency = solids.max(scene.bonded.frequency() * divisor).max(scene.ties.frequency());
    let Frequencies { walls_square, contact_square, .. } = scene.frequencies;
    let contacts = contacts + scene.optional.surface_supports.frequency_square();
    let contacts = contacts + scene.optional.interfaces.frequency_square();
    // Local damping opposes the motion with up to `local` times the unbalanced force: on the way back it stiffens.
    let frequency = ((frequency * frequency + contacts) * (1.0 + scene.settings.damping.local)).sqrt();
    let contact = if walls_square + contact_square > 0.0 { scene.debris.damping_ratio() } else { 0.0 };
    let contact = contact.max(scene.bonded.damping_ratio());
    let damping = scene.settings.damping;
    let xi = 0.5 * scene.settings.stiffness_time * frequency + 0.5 * damping.mass_rate / frequency + contact;
    let xi = xi + motion::bulk_damping_ratio(&scene.solid);
    2.0 / frequency * ((1.0 + xi * xi).sqrt() - xi)
}

/// The step that follows `time`: the largest that is allowed and divides what is left into equal steps, since a
/// change of the step costs a little of the energy balance.
pub(crate) fn next_dt(scene: &Scene, time: f64) -> f64 {
    let TimeStepSettings { safety, fixed, end, .. } = scene.settings.time_step;
    let dt = fixed.unwrap_or_else(|| safety * scene.stable_dt());
    // Where all has left the domain nothing asks for a step; it goes on as it was.
    let before = if scene.clock.dt_after > 0.0 { scene.clock.dt_after } else { end - time };
    equal_steps(if dt.is_finite() { dt } else { before }, end - time)
}

/// Finds, before the first step, what rigid shapes hold, and what their springs ask of the step.
pub(crate) fn prepare_shapes(scene: &mut Scene) {
    for ground in &mut scene.shape_contacts {
        ground.prepare(scene.contacts.rigid_bodies(), &scene.solid, &scene.debris);
    }
    find_first_step(scene);
}

/// Finds the first step, with springs on the rigid shapes as they stand.
pub(crate) fn find_first_step(scene: &mut Scene) {
    update_wall_frequency(scene);
    scene.clock = Clock::new(next_dt(scene, 0.0));
}

pub(crate) fn update_wall_frequency(scene: &mut Scene) {
    let Scene { solid, shape_contacts, debris, .. } = scene;
    let walls: f64 = shape_contacts.iter().map(|ground| ground.frequency_square(solid, debris)).sum();
    scene.frequencies.walls_square = RESOLUTION * RESOLUTION * walls;
}

/// Takes the discrete elements that touch into account: the step gets shorter at once, and longer where `renew` holds and all
/// contacts since then allow it. It changes by whole factors, since each change costs a little of the energy balance.
///
/// - `near`: whether to look for those that are about to touch
pub(crate) fn update_contact_frequency(scene: &mut Scene, near: bool, renew: bool) {
    let now = scene.debris.frequency_square(&scene.solid, near || renew);
    let Frequencies { stable, contact_square, contact_peak, .. } = &mut scene.frequencies;
    *contact_peak = contact_peak.max(now);
    if now > *contact_square || renew {
        *contact_square = rounded_up(*contact_peak, stable.frequency * stable.frequency);
    }
    if renew {
        *contact_peak = now;
    }
}

fn contact_frequency_square(scene: &Scene) -> f64 {
    let divisor = scene.bonded.step_divisor();
    let gas = scene.loads.gas().map_or(0.0, Gas::frequency_square);
    let Frequencies { walls_square, contact_square, .. } = scene.frequencies;
    walls_square + contact_square + scene.contacts.frequency_square() * divisor * divisor + gas
}

/// The largest step up to `dt` that divides what is left of a run into equal ones [s].
pub(crate) fn equal_steps(dt: f64, left: f64) -> f64 {
    if left > 1e-9 * dt { left / (left / dt * (1.0 - 1e-9)).ceil() } else { dt }
}

/// The smallest of the values unit · 2^(k/2), from a quarter of the unit on, that is no smaller; 0 for 0.
fn rounded_up(square: f64, unit: f64) -> f64 {
    if square <= 0.0 || !square.is_finite() || unit <= 0.0 {
        return square;
    }
    let mut level = 0.25 * unit;
    while level < square {
        level *= std::f64::consts::SQRT_2;
    }
    level
}
