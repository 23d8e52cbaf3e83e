//! The box that repeats of a scene: its motion between the forces of a step and the kick, and what is measured of it.

use fractum_contact::PeriodicCell;
use fractum_dem::Particles;
use fractum_math::{Mat3, Vec3, sphere_volume};

use crate::bonded::{narrowest_box, set_cell, touching_faces};
use crate::clock::ThisStep;
use crate::error::StepError;
use crate::periodic::{BoxStrain, MeanMotion, PeriodicBox, PeriodicState, gradient};
use crate::scene::Scene;

/// What a probe measures in a box that repeats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoxMeasure {
    /// Stress of contacts and of motion against the mean flow, tension positive [Pa].
    Stress([usize; 2]),
    /// The part of it that motion has [Pa].
    KineticStress([usize; 2]),
    /// Mean pressure [Pa].
    Pressure,
    /// Volume of the particles over that of the box.
    SolidFraction,
    /// Contacts and bonds per particle.
    Coordination,
    /// Volume of the box [m³].
    Volume,
    /// Component of the deformation since the start: of length along an axis, or shear ∂x_i/∂X_j.
    Strain([usize; 2]),
}

/// The same scene in a box that repeats, before its first step and with contacts [within](crate::Contacts::within) it.
pub fn with_periodic_box(mut scene: Scene, cell: PeriodicCell, strain: BoxStrain) -> Scene {
    let state = PeriodicState {
        cell,
        start: cell.edges,
        work: [0.0; 2],
        streaming: 0.0,
        flow: 0.0,
        stress: Mat3::zeros(),
        kinetic_stress: Mat3::zeros(),
    };
    let bonded_needs = narrowest_box(&scene.bonded);
    scene.optional.periodic = Some(Box::new(PeriodicBox { strain, state, bonded_needs }));
    scene
}

/// The box of a scene that repeats, as it is now; none where nothing does.
pub fn periodic_cell_of(scene: &Scene) -> Option<&PeriodicCell> {
    scene.optional.periodic.as_ref().map(|own| &own.state.cell)
}

/// Where a particle is within the box that repeats: what its image there has beyond its own place and velocity [m, m/s].
pub fn into_periodic_box(scene: &Scene, place: &Vec3) -> [Vec3; 2] {
    periodic_cell_of(scene).map_or([Vec3::zeros(); 2], |cell| cell.into_box(place))
}

/// What changes in the box that repeats, for a checkpoint.
pub fn periodic_state(scene: &Scene) -> Option<PeriodicState> {
    scene.optional.periodic.as_ref().map(|own| own.state.clone())
}

/// Puts it back, after the state of the scene.
pub fn restore_periodic(scene: &mut Scene, state: Option<PeriodicState>) {
    if let (Some(own), Some(state)) = (&mut scene.optional.periodic, state) {
        scene.contacts.set_cell(&state.cell);
        own.state = state;
    }
}

/// What a probe shows of the box that repeats, when last measured; not a number without one.
pub fn measure_periodic_box(scene: &Scene, measure: BoxMeasure) -> f64 {
    let Some(own) = &scene.optional.periodic else { return f64::NAN };
    let PeriodicState { cell, start, stress, kinetic_stress, .. } = &own.state;
    match measure {
        BoxMeasure::Stress([i, j]) => 0.5 * (stress[(i, j)] + stress[(j, i)]),
        BoxMeasure::KineticStress([i, j]) => kinetic_stress[(i, j)],
        BoxMeasure::Pressure => -stress.trace() / 3.0,
        BoxMeasure::SolidFraction => {
            let radii = scene.bonded.particles.radius.iter();
            radii.map(|radius| sphere_volume(*radius)).sum::<f64>() / cell.volume()
        }
        BoxMeasure::Coordination => {
            let (bonds, broken) = scene.bonded.bond_counts();
            let touching = scene.contacts.touching_among() + touching_faces(&scene.bonded) + bonds - broken;
            2.0 * touching as f64 / scene.bonded.particles.len() as f64
        }
        BoxMeasure::Volume => cell.volume(),
        BoxMeasure::Strain([i, j]) => cell.edges[(i, j)] / start[(j, j)] - if i == j { 1.0 } else { 0.0 },
    }
}

/// Sets the box and the mean flow in motion before the first step.
pub(crate) fn start_box(scene: &mut Scene, step: &ThisStep) {
    let Scene { optional, bonded, contacts, .. } = scene;
    let Some(own) = optional.periodic.as_mut().filter(|_| step.is_first) else { return };
    let cell = &mut own.state.cell;
    let after = cell.velocity_under(&gradient(&own.strain, step.time + 0.5 * step.dt_after), step.dt_after);
    let change = PeriodicCell { velocity: after - cell.velocity, ..*cell }.velocity_gradient();
    cell.velocity = after;
    let mean = MeanMotion::of(&bonded.particles);
    let Particles { position, velocity, .. } = &mut bonded.particles;
    velocity.iter_mut().zip(position).for_each(|(v, x)| *v += change * (*x - mean.centre));
    contacts.set_cell(cell);
}

/// Gives the bonds the box of tⁿ, before their forces are found; it stays theirs until those of the next step.
pub(crate) fn put_bonds_in_box(scene: &mut Scene) {
    if let Some(own) = &scene.optional.periodic {
        set_cell(&mut scene.bonded, &own.state.cell);
    }
}

/// Finds the stress of the box at tⁿ, has it deform until tⁿ⁺¹, and changes the mean flow with it; between the forces of tⁿ and the kick.
///
/// # Errors
/// [`StepError::BoxTooNarrow`].
pub(crate) fn deform_box(scene: &mut Scene, step: &ThisStep) -> Result<(), StepError> {
    let Scene { optional, bonded, contacts, clock, .. } = scene;
    let Some(own) = &mut optional.periodic else { return Ok(()) };
    own.deform(bonded, contacts, step).map_err(|[narrowest, needed]| StepError::BoxTooNarrow {
        step: clock.step,
        time: step.time,
        narrowest,
        needed,
    })
}

/// Books what the sides do in the half step that has begun.
pub(crate) fn book_box(scene: &mut Scene) {
    if let Some(own) = &mut scene.optional.periodic {
        let [work, after] = &mut own.state.work;
        *work += std::mem::take(after);
    }
}
