//! The books of a step: what each line of it has done goes into the ledger, and the balance is held against its guards.

use fractum_fem::rubbed_energy;
use fractum_math::{HalfSteps, Vec3, Work};

use crate::clock::ThisStep;
use crate::error::StepError;
use crate::interfaces::Interfaces;
use crate::ledger::{Books, EnergyKind, Ledger};
use crate::periodic::box_energies;
use crate::ranks::gather_all;
use crate::scene::{Optional, Scene};
use crate::watch::{Notice, Site};

/// Elastic energy over all energy put in, above which a run is unstable: a mode of the highest frequency at 0.95 of the
/// stable step reaches 10.
const UNSTABLE_RATIO: f64 = 20.0;
/// Share of the energy that changes of the step may bring or take, and friction may give, before a word is said.
const VISIBLE_CHANGE: f64 = 5e-3;
/// Share of the work that damping may take in the second half of a stage: what comes to rest before that has its time.
const DAMPED: f64 = 0.05;
/// Share of the energy that rigid shapes may take from solids that meet them.
const STOPPED: f64 = 0.05;

/// Part of the energy of in-situ stress below which an energy is what rounding leaves.
pub(crate) const IN_SITU_ROUND_OFF: f64 = 1e-9;
/// Part of the energy that gas holds likewise: as it begins to enter it has done no work yet.
const GAS_ROUND_OFF: f64 = 1e-12;

/// The ledger of a state of equilibrium.
pub(crate) fn book_equilibrium(scene: &mut Scene) -> Result<(), StepError> {
    let Scene { ledger, solid, books, optional: Optional { interfaces, liquid, .. }, .. } = scene;
    ledger[EnergyKind::Elastic] = solid.elastic_energy();
    ledger[EnergyKind::Damage] = solid.dissipated_energy();
    ledger[EnergyKind::External] = books.external;
    ledger[EnergyKind::Removed] = books.removed;
    ledger[EnergyKind::Friction] = books.friction;
    ledger[EnergyKind::Damping] = books.damping + solid.viscous_dissipation();
    ledger[EnergyKind::TimeStep] = books.time_step;
    ledger[EnergyKind::Left] = books.left;
    book_interfaces(ledger, books, interfaces);
    if let Some(liquid) = liquid {
        let [supplied, stored, viscous, lost] = liquid.energies();
        ledger[EnergyKind::LiquidSupplied] = supplied;
        ledger[EnergyKind::Liquid] = stored;
        ledger[EnergyKind::LiquidFlow] = viscous;
        ledger[EnergyKind::LiquidLeaked] = lost;
    }
    ledger.update_maxima();
    if ledger.residual().is_finite() {
        return Ok(());
    }
    let (step, time, dt, limit) = (scene.clock.step, scene.clock.time, scene.clock.dt_before, f64::INFINITY);
    Err(StepError::NotFinite { step, time, dt, limit, culprit: culprit(scene) })
}

/// Energy in interfaces, and what they have taken beyond it.
fn book_interfaces(ledger: &mut Ledger, books: &Books, interfaces: &Interfaces) {
    let stored = interfaces.stored();
    ledger[EnergyKind::Interfaces] = stored;
    ledger[EnergyKind::InterfaceFracture] = books.interfaces - stored;
}

/// Completes the ledger of tⁿ and holds it against the guard.
fn close_balance(scene: &mut Scene) -> Result<(), StepError> {
    let Scene { ledger, solid, bonded, books, contacts, optional, .. } = scene;
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
    ledger[EnergyKind::Friction] = books.friction + rubbed_energy(solid) + 0.0;
    ledger[EnergyKind::Damping] = books.damping + solid.viscous_dissipation();
    ledger[EnergyKind::TimeStep] = books.time_step;
    ledger[EnergyKind::Absorbed] = books.absorbed + optional.surface_supports.absorbed();
    ledger[EnergyKind::Left] = books.left;
    ledger[EnergyKind::Entered] = books.entered;
    let [of_box, streaming, flow] = box_energies(optional.periodic.as_deref());
    ledger[EnergyKind::PeriodicBox] = of_box;
    ledger[EnergyKind::Kinetic] -= streaming;
    book_interfaces(ledger, books, &optional.interfaces);
    ledger[EnergyKind::Foundation] = optional.surface_supports.stored();
    if scene.clock.step == 0 {
        ledger.initial = ledger[EnergyKind::Kinetic] + ledger[EnergyKind::Elastic] + ledger[EnergyKind::Contact];
        ledger.initial += ledger[EnergyKind::Interfaces];
        ledger.initial += ledger[EnergyKind::Damping]; // rigid shapes stop what meets them at once
        if !solid.initial_displacement.is_empty() {
            ledger.in_situ = ledger[EnergyKind::Elastic] + ledger[EnergyKind::Interfaces];
        }
        // Less than this is no energy: bodies that wait for a rigid body move by what rounding leaves, and so does rock
        // under stress.
        ledger.scale = bonded.round_off_energy(scene.clock.dt_after) + IN_SITU_ROUND_OFF * ledger.in_situ;
    }
    if let Some(gas) = scene.loads.gas() {
        let [held, supplied, leaked] = gas.energies();
        ledger[EnergyKind::Gas] = held;
        ledger[EnergyKind::GasSupplied] = supplied;
        ledger[EnergyKind::GasLeaked] = leaked;
        // What the gas has done is in play; what it holds may be much more, and its rounding is no energy.
        ledger.scale = ledger.scale.max((supplied - held - leaked).abs()).max(GAS_ROUND_OFF * held);
    }
    // Particles that meet in a box that deforms take from its mean flow.
    ledger.scale = ledger.scale.max(flow);
    // The first touch of a rigid body is found to a step only; it is measured by what a particle takes from it, not by the little
    // work done so far.
    ledger.scale = ledger.scale.max(contacts.touch_energy(&bonded.particles));
    ledger.update_maxima();
    let (relative, finite) = (ledger.relative_residual(), ledger.residual().is_finite());
    let (step, time, dt, limit) = (scene.clock.step, scene.clock.time, scene.clock.dt_after, scene.stable_dt());
    if !finite || !relative.is_finite() {
        return Err(StepError::NotFinite { step, time, dt, limit, culprit: culprit(scene) });
    }
    // An unstable run keeps the discrete balance while it blows up: its energies grow with opposite signs.
    let stored = scene.ledger[EnergyKind::Elastic] + scene.ledger[EnergyKind::Interfaces];
    let ratio = (stored - scene.ledger.in_situ) / scene.ledger.scale;
    if ratio > UNSTABLE_RATIO {
        return Err(StepError::Unstable { step, time, ratio, dt, limit, culprit: culprit(scene) });
    }
    note_what_the_ledger_hides(scene);
    let allowed = scene.settings.balance_stop;
    if relative > allowed {
        return Err(StepError::Unbalanced { step, time, relative, allowed, dt, limit, culprit: culprit(scene) });
    }
    Ok(())
}

/// Errors of a run that have entries of their own, so that the ledger closes with them, and what is taken from what should move.
fn note_what_the_ledger_hides(scene: &mut Scene) {
    let late = scene.settings.time_step.is_late(scene.clock.time);
    let scale = scene.ledger.scale;
    if scale <= 0.0 {
        return;
    }
    if !late {
        return;
    }
    let stopped = scene.books.stopped / scale;
    if stopped > STOPPED {
        scene.note(Notice::Stopped, Site::Scene, stopped);
    }
    let changed = (scene.books.time_step / scale).abs();
    if changed > VISIBLE_CHANGE {
        scene.note(Notice::ChangeOfStep, Site::Scene, changed);
    }
    let can_only_take = [EnergyKind::Friction, EnergyKind::Damping, EnergyKind::InterfaceFracture];
    let given = can_only_take.into_iter().map(|kind| -scene.ledger[kind] / scale).fold(0.0, f64::max);
    if given > VISIBLE_CHANGE {
        scene.note(Notice::Gained, Site::Scene, given);
    }
    let damped = scene.books.late_damping / scale;
    if damped > DAMPED {
        scene.note(Notice::Damping, Site::Scene, damped);
    }
}

/// The element or bonded particle with the largest kinetic energy, or with a value that is not a number.
fn culprit(scene: &mut Scene) -> String {
    gather_all(scene);
    let solid = &scene.solid;
    let energy = |node: u32| {
        let i = node as usize;
        let energy = solid.mass[i] * solid.velocity[i].norm_squared();
        if energy.is_finite() && solid.displacement[i].iter().all(|c| c.is_finite()) { energy } else { f64::INFINITY }
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
    if let Some((energy, particle)) = scene.bonded.fastest()
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

/// Enters the work of both half steps around tⁿ, and completes the ledger where it is measured.
///
/// - `given`: kinetic energy that velocities of the start had half a step before [J]
pub(crate) fn book(
    scene: &mut Scene,
    step: &ThisStep,
    contact: Work,
    work: HalfSteps,
    given: f64,
) -> Result<(), StepError> {
    scene.books += contact;
    if !step.is_first {
        scene.books += work.before;
    }
    if step.measure {
        // What central differences keep less of the energy of a start out of balance, ⅛ Δt² Σ F²/m, but for what shapes stop.
        let missing = if step.is_first { (given - work.before.kinetic).max(0.0) - contact.damping } else { 0.0 };
        scene.ledger[EnergyKind::Kinetic] = work.before.kinetic + missing;
        scene.ledger[EnergyKind::Contact] = contact.stored;
        close_balance(scene)?;
        scene.books.time_step += missing;
    }
    if step.changes {
        scene.books.time_step += work.before.kinetic - work.after.kinetic;
    }
    scene.books += work.after;
    Ok(())
}
