//! Pressures and tractions on particles: by the area of the walls of their body that each of them shows.

use fractum_math::{Mat3, Vec3};
use fractum_scene::Bonded;

use super::Context;
use crate::model::Selection;

/// What a particle shows of the walls of its body.
pub(super) struct Shown {
    /// The particle in the scene.
    pub(super) particle: u32,
    /// Area vector out of the body [m²].
    pub(super) vector: Vec3,
    /// Area [m²].
    pub(super) size: f64,
    /// Moment of its area about the origin, ∫ x × n dA [m³].
    moment: Vec3,
}

impl Context<'_> {
    /// What the particles that are meant show of the wall that is named, or of all walls of their body; an error if that is nothing.
    pub(super) fn shown_areas(&mut self, on: &Selection, bonded: &Bonded) -> Vec<Shown> {
        let Some(group) = &on.group else { return Vec::new() };
        let mut wanted = self.selected_particles(on, group, bonded);
        wanted.sort_unstable();
        let Some((body, set)) = self.case.particle_group(&group.value) else { return Vec::new() };
        let mut shown: Vec<Shown> = Vec::new();
        if let Some((domain, walls)) = self.walls_of(body) {
            let (position, radius) = (&bonded.particles.position, &bonded.particles.radius);
            let named = walls.iter().any(|(name, _)| Some(name.as_str()) == set);
            for (wall, (name, particles)) in walls.iter().enumerate() {
                if named && Some(name.as_str()) != set {
                    continue;
                }
                let areas = domain.wall_areas(wall, particles, position, radius);
                let own = particles.iter().zip(areas).filter(|(i, _)| wanted.binary_search(i).is_ok());
                shown.extend(own.map(|(&particle, [vector, moment])| Shown {
                    particle,
                    vector,
                    size: vector.norm(),
                    moment,
                }));
            }
        }
        shown.sort_by_key(|own| own.particle);
        shown.dedup_by(|next, kept| {
            let same = next.particle == kept.particle;
            if same {
                kept.vector += next.vector;
                kept.size += next.size;
                kept.moment += next.moment;
            }
            same
        });
        if shown.is_empty() && !wanted.is_empty() {
            let found = format!("= \"{}\": none of its particles lies at a wall of the body", group.value);
            self.error(&group.place, found, "a set with particles at a wall, such as BODY.WALL; or force");
        }
        balance(&mut shown, &bonded.particles.position);
        shown
    }
}

/// Gives area vectors at the centres of particles the moment of the areas that they stand for, whose middles are elsewhere: a pressure on a closed
/// surface must not turn the body. What is added is a field of rotation, some 1e-4 of the vectors, without a resultant.
fn balance(shown: &mut [Shown], position: &[Vec3]) {
    let place = |own: &Shown| position[own.particle as usize];
    let whole: f64 = shown.iter().map(|own| own.size).sum();
    if whole <= 0.0 {
        return;
    }
    let middle = shown.iter().map(|own| place(own) * own.size).sum::<Vec3>() / whole;
    let missing: Vec3 = shown.iter().map(|own| own.moment - place(own).cross(&own.vector)).sum();
    let inertia = shown.iter().fold(Mat3::zeros(), |sum, own| {
        let arm = place(own) - middle;
        sum + (Mat3::identity() * arm.norm_squared() - arm * arm.transpose()) * own.size
    });
    let Some(turn) = inertia.try_inverse().map(|inverse| inverse * missing) else { return };
    for own in shown {
        let arm = position[own.particle as usize] - middle;
        own.vector += turn.cross(&arm) * own.size;
    }
}
