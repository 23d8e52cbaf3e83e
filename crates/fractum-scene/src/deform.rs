//! The box of a scene that repeats, in its step and for its results.

use fractum_contact::PeriodicCell;
use fractum_math::Vec3;

use crate::clock::ThisStep;
use crate::error::StepError;
use crate::periodic::{BoxMeasure, BoxStrain, PeriodicBox, PeriodicState};
use crate::scene::Scene;

/// The same scene in a box that repeats, before its first step and with contacts [within](crate::Contacts::within) it.
pub fn with_periodic_box(mut scene: Scene, cell: PeriodicCell, strain: BoxStrain) -> Scene {
    scene.optional.periodic = Some(Box::new(PeriodicBox::new(cell, strain)));
    scene
}

/// The box of a scene that repeats, as it is now; none where nothing does.
pub fn periodic_cell_of(scene: &Scene) -> Option<&PeriodicCell> {
    scene.optional.periodic.as_ref().map(|own| own.cell())
}

/// Where a particle is within the box that repeats: what its image there has beyond its own place and velocity [m, m/s].
pub fn into_periodic_box(scene: &Scene, place: &Vec3) -> [Vec3; 2] {
    periodic_cell_of(scene).map_or([Vec3::zeros(); 2], |cell| cell.into_box(place))
}

/// What changes in the box that repeats, for a checkpoint.
pub fn periodic_state(scene: &Scene) -> Option<PeriodicState> {
    scene.optional.periodic.as_ref().map(|own| own.state())
}

/// Puts it back, after the state of the scene.
pub fn restore_periodic(scene: &mut Scene, state: Option<PeriodicState>) {
    if let (Some(own), Some(state)) = (&mut scene.optional.periodic, state) {
        own.restore(state);
        scene.contacts.set_cell(own.cell());
    }
}

/// What a probe shows of the box that repeats, when last measured; not a number without one.
pub fn measure_periodic_box(scene: &Scene, measure: BoxMeasure) -> f64 {
    let own = scene.optional.periodic.as_ref();
    own.map_or(f64::NAN, |own| own.measure(&scene.bonded.particles, &scene.contacts, measure))
}

/// Sets the box and the mean flow in motion before the first step.
pub(crate) fn start_box(scene: &mut Scene, step: &ThisStep) {
    if let Some(own) = scene.optional.periodic.as_mut().filter(|_| step.is_first) {
        own.start(&mut scene.bonded.particles, step);
        scene.contacts.set_cell(own.cell());
    }
}

/// Has the box deform, see [`PeriodicBox::deform`].
pub(crate) fn deform_box(scene: &mut Scene, step: &ThisStep) -> Result<(), StepError> {
    let Scene { optional, bonded, contacts, clock, .. } = scene;
    let own = optional.periodic.as_mut();
    own.map_or(Ok(()), |own| own.deform(&mut bonded.particles, contacts, step, clock.step))
}

/// Books what the sides do in the half step that has begun.
pub(crate) fn book_box(scene: &mut Scene) {
    scene.optional.periodic.iter_mut().for_each(|own| own.book());
}
