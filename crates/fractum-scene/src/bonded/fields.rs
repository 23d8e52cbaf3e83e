//! Strain of every particle.

use fractum_dem::strain::small_part_of_stretch;
use fractum_math::{Mat3, Sym3};

use super::Bonded;

impl Bonded {
    /// Strain of every particle: the affine field closest to the displacements of those that it is bonded to, against its own;
    /// zero where they do not span a volume.
    pub fn strains(&self) -> Vec<Sym3> {
        let mut sums = vec![[Mat3::zeros(); 2]; self.particles.len()];
        let displacement = |i: usize| self.particles.position[i] - self.reference[i];
        for body in &self.bodies {
            let repeats = body.bonds.through_box().is_some();
            for (bond, pair) in body.bonds.pairs().iter().enumerate().filter(|(bond, _)| body.is_joined(*bond)) {
                let [i, j] = pair.map(|i| i as usize);
                let [from, to] = body.bonds.ends(bond, &self.reference);
                let way = to - from;
                let moved = match repeats {
                    true => body.bonds.gap(bond, &self.particles) - way,
                    false => displacement(j) - displacement(i),
                };
                let parts = [way * way.transpose(), moved * way.transpose()];
                for end in [i, j] {
                    (0..2).for_each(|k| sums[end][k] += parts[k]);
                }
            }
        }
        let strain = |[moments, mixed]: &[Mat3; 2]| {
            let size = moments.trace();
            let inverse = (moments / size).try_inverse().filter(|inverse| inverse.norm() < 1e6);
            inverse.map_or(Sym3::ZERO, |inverse| small_part_of_stretch(&(mixed * inverse / size)))
        };
        sums.iter().map(strain).collect()
    }
}
