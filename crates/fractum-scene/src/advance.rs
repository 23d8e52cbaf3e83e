//! From the forces of tⁿ to the velocities after it and the displacements of tⁿ⁺¹.

use fractum_dem::Particles;
use fractum_fem::{Prescribe, WholeStep, motion};
use fractum_math::{HalfSteps, sum_chunks};

use crate::clock::{Clock, Phase};
use crate::conditions::Kick;
use crate::scene::Scene;

/// Advances nodes, particles and rigid bodies with the forces of tⁿ; prescribed motion takes the place of free motion.
pub(crate) fn advance(scene: &mut Scene, measure: bool, passed: &mut impl FnMut(Phase)) -> HalfSteps {
    let (dt_before, dt_after) = (scene.clock.dt_before, scene.clock.dt_after);
    let mut work = if scene.solid.is_subcycled() {
        passed(Phase::Motion);
        let work = advance_in_parts(scene, measure);
        passed(Phase::Subcycling);
        work
    } else {
        advance_together(scene, measure)
    };
    work += scene.debris.turn(&scene.solid, dt_before, dt_after, measure);
    work += move_bonded(scene, measure);
    work += scene.contacts.move_bodies(&scene.clock);
    work.after.external += 0.5 * dt_after * scene.loads.power(&scene.solid);
    scene.loads.spend_gas_work(&scene.solid, dt_after);
    book_late_damping(scene, &work);
    work
}

/// Keeps apart what damping of nodes and particles takes in the second half of a stage.
fn book_late_damping(scene: &mut Scene, work: &HalfSteps) {
    if scene.settings.damping.is_off() || !scene.settings.time_step.is_late(scene.clock.time) {
        return;
    }
    let before = if scene.clock.begins_motion() { 0.0 } else { work.before.damping };
    scene.books.late_damping += before + work.after.damping;
}

/// Advances all nodes by the same step.
fn advance_together(scene: &mut Scene, measure: bool) -> HalfSteps {
    let Clock { time, dt_before, dt_after, .. } = scene.clock;
    let begins = scene.clock.begins_motion();
    let (damping, Scene { solid, supports, .. }) = (scene.settings.damping, scene);
    supports.remember(solid, None);
    let mut work = solid.kick_and_drift(dt_before, dt_after, damping, supports.held(), measure);
    work += supports.impose(solid, &Kick { time, dt_before, dt_after, is_fine: None, is_first: true, begins });
    work
}

/// Advances the nodes that need it by short steps, and the others by one.
fn advance_in_parts(scene: &mut Scene, measure: bool) -> HalfSteps {
    let Clock { time, dt_before, dt_after, .. } = scene.clock;
    let begins = scene.clock.begins_motion();
    let (damping, Scene { solid, supports, .. }) = (scene.settings.damping, scene);
    let held = supports.shared_held();
    let step = WholeStep { dt_before, dt_after, damping, held: &held, measure };
    motion::advance_in_parts(solid, step, |solid, prescribe| match prescribe {
        Prescribe::Remember { fine } => {
            supports.remember(solid, Some(fine));
            HalfSteps::default()
        }
        Prescribe::Impose { fine, since, dt_before, dt_after } => {
            let (time, is_first) = (time + since, since == 0.0);
            let kick = Kick { time, dt_before, dt_after, is_fine: Some(fine), is_first, begins: begins && is_first };
            supports.impose(solid, &kick)
        }
    })
}

/// The velocities given at the start become those of the half step before it; returns the kinetic energy of those given [J].
pub(crate) fn start_half_a_step_early(scene: &mut Scene, dt: f64) -> f64 {
    let Scene { solid, supports, bonded, contacts, .. } = scene;
    let of_node = |i: usize| 0.5 * solid.mass[i] * solid.velocity[i].norm_squared();
    let given = sum_chunks(solid.mass.len(), of_node) + bonded.kinetic_energy() + contacts.kinetic_energy();
    bonded.start_half_a_step_early(dt);
    contacts.start_half_a_step_early(dt);
    for i in 0..solid.mass.len() {
        let half_kick = match motion::own_acceleration(solid, i, dt) {
            Some((acceleration, dt)) => acceleration * (0.5 * dt),
            None => solid.force[i] * (0.5 * dt / solid.mass[i]),
        };
        let held = supports.held().get(i).copied().unwrap_or(0);
        for axis in (0..3).filter(|axis| held & (1 << axis) == 0) {
            solid.velocity[i][axis] -= half_kick[axis];
        }
    }
    given
}

pub(crate) fn move_bonded(scene: &mut Scene, measure: bool) -> HalfSteps {
    if scene.bonded.is_empty() {
        return HalfSteps::default();
    }
    let Scene { bonded, ties, solid, settings, clock, .. } = scene;
    let follow = |particles: &mut Particles| ties.follow(solid, particles);
    bonded.advance(*clock, settings.damping, measure, follow)
}
