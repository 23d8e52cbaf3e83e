//! Pieces of bonded bodies: particles that live bonds hold together.

use fractum_math::{Vec3, connected};

use super::Bonded;
use crate::fragment::Fragment;

impl Bonded {
    /// Pieces connected by live bonds, in the order of their first particles.
    pub fn fragments(&self) -> Vec<Fragment> {
        let live = self.bodies.iter().flat_map(|body| {
            let live = (0..body.bonds.len()).filter(|&bond| body.bonds.is_live(bond));
            live.map(|bond| body.bonds.pairs()[bond])
        });
        let part = connected(self.particles.len(), live.clone());
        let mut bonds = vec![0usize; part.len()];
        live.for_each(|[first, _]| bonds[part[first as usize] as usize] += 1);
        let mut members: Vec<Vec<u32>> = vec![Vec::new(); part.len()];
        for (particle, &place) in (0..).zip(&part) {
            members[place as usize].push(particle);
        }
        let whole = members.into_iter().enumerate().filter(|(_, own)| !own.is_empty());
        whole.map(|(place, own)| self.piece(own, bonds[place])).collect()
    }

    fn piece(&self, particles: Vec<u32>, bonds: usize) -> Fragment {
        let all = &self.particles;
        let density =
            self.bodies.iter().find(|b| b.range.contains(&(particles[0] as usize))).map_or(1.0, |b| b.density);
        let (mut mass, mut centroid, mut velocity) = (0.0, Vec3::zeros(), Vec3::zeros());
        let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
        let mut volume = 0.0;
        for i in particles.iter().map(|&i| i as usize) {
            let own = self.own_mass(i);
            mass += own;
            volume += all.mass[i] / density;
            centroid += all.position[i] * own;
            velocity += all.velocity[i] * own;
            low = low.inf(&all.position[i].add_scalar(-all.radius[i]));
            high = high.sup(&all.position[i].add_scalar(all.radius[i]));
        }
        // Tied particles alone have no mass of their own.
        let share = if mass > 0.0 { 1.0 / mass } else { 0.0 };
        Fragment {
            nodes: particles,
            elements: 0,
            bonds,
            mass,
            volume,
            centroid: centroid * share,
            velocity: velocity * share,
            bounds: [low, high],
        }
    }
}
