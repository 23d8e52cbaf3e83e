//! Pieces of bonded bodies: particles that live bonds hold together.

use fractum_math::Vec3;

use super::Bonded;
use crate::fragment::Fragment;

impl Bonded {
    /// Pieces connected by live bonds, in the order of their first particles.
    pub fn fragments(&self) -> Vec<Fragment> {
        let mut root: Vec<u32> = (0..self.particles.len() as u32).collect();
        fn find(root: &mut [u32], mut i: u32) -> u32 {
            while root[i as usize] != i {
                root[i as usize] = root[root[i as usize] as usize];
                i = root[i as usize];
            }
            i
        }
        let mut bonds = vec![0usize; root.len()];
        for body in &self.bodies {
            for bond in (0..body.bonds.len()).filter(|&bond| body.bonds.is_live(bond)) {
                let [a, b] = body.bonds.pairs()[bond].map(|i| find(&mut root, i));
                root[a.max(b) as usize] = a.min(b);
            }
        }
        for body in &self.bodies {
            for bond in (0..body.bonds.len()).filter(|&bond| body.bonds.is_live(bond)) {
                bonds[find(&mut root, body.bonds.pairs()[bond][0]) as usize] += 1;
            }
        }
        let mut members: Vec<Vec<u32>> = vec![Vec::new(); root.len()];
        for i in 0..root.len() as u32 {
            let place = find(&mut root, i);
            members[place as usize].push(i);
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
        for i in particles.iter().map(|&i| i as usize) {
            mass += all.mass[i];
            centroid += all.position[i] * all.mass[i];
            velocity += all.velocity[i] * all.mass[i];
            low = low.inf(&all.position[i].add_scalar(-all.radius[i]));
            high = high.sup(&all.position[i].add_scalar(all.radius[i]));
        }
        Fragment {
            nodes: particles,
            elements: 0,
            bonds,
            mass,
            volume: mass / density,
            centroid: centroid / mass,
            velocity: velocity / mass,
            extent: (high - low).max(),
        }
    }
}
