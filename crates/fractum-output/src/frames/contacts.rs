//! Contacts of particles as lines for ParaView.

use fractum_math::Vec3;
use fractum_scene::{ContactBody, ParticleContact, Scene, into_periodic_box, periodic_cell_of};
use fractum_vtk::{Compression, Field, PendingFile, PolyCells, PolyData};

use crate::OutputError;

/// The contacts of the last step that bear a force: lines from the centre of a particle to that of the other, or to its place on a rigid body or
/// solid, with their forces, overlap, particles and bodies; none where nothing touches.
///
/// # Errors
/// Arrays that do not fit together.
pub(crate) fn file(scene: &Scene) -> Result<Option<PendingFile>, OutputError> {
    let (all, reference) = (&scene.bonded.particles, scene.bonded.reference());
    let mut contacts: Vec<ParticleContact> = Vec::new();
    scene.contacts.of_particles(all, |contact| contacts.extend((contact.force.norm() > 0.0).then_some(contact)));
    if contacts.is_empty() {
        return Ok(None);
    }
    let (mut points, mut displacement) = (Vec::new(), Vec::new());
    for contact in &contacts {
        let i = contact.particle as usize;
        let moved = all.position[i] - reference[i];
        let [beyond, _] = into_periodic_box(scene, &all.position[i]);
        // The place on a wall moves with the particle.
        let (other, other_moved) = match contact.other.map(|j| j as usize) {
            Some(j) => {
                // The image that is touched: the place of contact is in the middle.
                let image = if periodic_cell_of(scene).is_some() {
                    contact.place * 2.0 - all.position[i] - all.position[j]
                } else {
                    Vec3::zeros()
                };
                (reference[j] + image, all.position[j] - reference[j])
            }
            None => (contact.place - moved, moved),
        };
        points.extend([reference[i] + beyond, other + beyond].map(<[f64; 3]>::from));
        displacement.extend([moved, other_moved].map(<[f64; 3]>::from));
    }
    let lines: Vec<[u32; 2]> = (0..contacts.len() as u32).map(|line| [2 * line, 2 * line + 1]).collect();
    let column = |of: fn(&ParticleContact) -> f64| contacts.iter().map(of).collect::<Vec<f64>>();
    let (normal, overlap) = (column(ParticleContact::normal_force), column(|contact| contact.overlap));
    let tangential = column(|contact| (contact.force + contact.normal * contact.normal_force()).norm());
    let force: Vec<[f64; 3]> = contacts.iter().map(|contact| contact.force.into()).collect();
    let number = |of: fn(&ParticleContact) -> i32| contacts.iter().map(of).collect::<Vec<i32>>();
    let first = number(|contact| contact.particle as i32);
    let second = number(|contact| contact.other.map_or(-1, |other| other as i32));
    let first_body = number(|contact| number_of(contact.bodies[0]).0);
    let second_body = number(|contact| number_of(contact.bodies[1]).0);
    let second_kind = number(|contact| number_of(contact.bodies[1]).1);
    let data = PolyData {
        points: &points,
        cells: PolyCells::Lines(&lines),
        point_data: &[Field::vector("displacement", &displacement)],
        cell_data: &[
            Field::scalar("normal_force", &normal),
            Field::scalar("tangential_force", &tangential),
            Field::vector("force", &force),
            Field::scalar("overlap", &overlap),
            Field::integer("first_particle", &first),
            Field::integer("second_particle", &second),
            Field::integer("first_body", &first_body),
            Field::integer("second_body", &second_body),
            Field::integer("second_kind", &second_kind),
        ],
        time: Some(scene.clock.time),
    };
    data.pending(Compression::Fast).map(Some).map_err(OutputError::from)
}

/// Number of a body among those of its kind, and of the kind: particles, rigid bodies, solids.
fn number_of(body: ContactBody) -> (i32, i32) {
    match body {
        ContactBody::Particles(body) => (body as i32, 0),
        ContactBody::Rigid(body) => (body as i32, 1),
        ContactBody::Solid(body) => (body as i32, 2),
    }
}
