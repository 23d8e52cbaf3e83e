//! Pieces of a body: particles that live bonds hold together.

use fractum_math::{Vec3, connected};

use crate::particles::Particles;

/// A connected piece.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Its particles, ascending.
    pub particles: Vec<u32>,
    /// Bonds that hold in it.
    pub bonds: usize,
    /// Mass [kg].
    pub mass: f64,
    /// Mass of all its particles, whoever carries it: over the density the volume that it stands for [kg].
    pub content: f64,
    /// Centre of mass [m].
    pub centroid: Vec3,
    /// Velocity of the centre of mass [m/s].
    pub velocity: Vec3,
    /// Corners of the box around its spheres [m].
    pub bounds: [Vec3; 2],
}

/// Pieces in the order of their first particles.
///
/// - `live`: the particles of each bond that holds
/// - `own_mass` [kg]: of a particle, without what is carried elsewhere
pub fn pieces(
    particles: &Particles,
    live: impl Iterator<Item = [u32; 2]> + Clone,
    own_mass: impl Fn(usize) -> f64,
) -> Vec<Piece> {
    let part = connected(particles.len(), live.clone());
    let mut bonds = vec![0usize; part.len()];
    live.for_each(|[first, _]| bonds[part[first as usize] as usize] += 1);
    let mut members: Vec<Vec<u32>> = vec![Vec::new(); part.len()];
    for (particle, &own) in (0..).zip(&part) {
        members[own as usize].push(particle);
    }
    let whole = members.into_iter().enumerate().filter(|(_, own)| !own.is_empty());
    whole.map(|(first, own)| piece(particles, own, bonds[first], &own_mass)).collect()
}

fn piece(all: &Particles, particles: Vec<u32>, bonds: usize, own_mass: impl Fn(usize) -> f64) -> Piece {
    let (mut mass, mut content, mut centroid, mut velocity) = (0.0, 0.0, Vec3::zeros(), Vec3::zeros());
    let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    for i in particles.iter().map(|&i| i as usize) {
        let own = own_mass(i);
        mass += own;
        content += all.mass[i];
        centroid += all.position[i] * own;
        velocity += all.velocity[i] * own;
        low = low.inf(&all.position[i].add_scalar(-all.radius[i]));
        high = high.sup(&all.position[i].add_scalar(all.radius[i]));
    }
    // Without a mass of its own a piece has no centre either.
    let share = if mass > 0.0 { 1.0 / mass } else { 0.0 };
    let (centroid, velocity) = (centroid * share, velocity * share);
    Piece { particles, bonds, mass, content, centroid, velocity, bounds: [low, high] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_broken_chain_is_two_pieces_with_their_mass_and_motion() {
        let position: Vec<Vec3> = (0..5).map(|i| Vec3::x() * f64::from(i)).collect();
        let mut all = Particles::at_rest(position, vec![0.5; 5], 10.0).unwrap();
        (0..2).for_each(|i| all.velocity[i].x = -1.0);
        all.velocity[4].y = 3.0;
        let found = pieces(&all, [[0, 1], [2, 3], [3, 4]].into_iter(), |i| all.mass[i]);
        assert_eq!(found.len(), 2);
        assert_eq!((found[0].particles.as_slice(), found[0].bonds, found[0].mass), ([0, 1].as_slice(), 1, 4.0));
        assert_eq!((found[0].centroid, found[0].velocity), (Vec3::x() * 0.5, -Vec3::x()));
        assert_eq!((found[1].mass, found[1].centroid.x, found[1].velocity), (6.0, 3.0, Vec3::y()));
        assert_eq!(found[1].bounds, [Vec3::new(1.5, -0.5, -0.5), Vec3::new(4.5, 0.5, 0.5)]);
    }
}
