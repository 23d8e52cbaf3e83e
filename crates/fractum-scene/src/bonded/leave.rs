//! Bonded and loose particles that leave the run.

use fractum_dem::{NO_CLUMP, Particles};
use fractum_math::{Vec3, connected};

use super::Bonded;
use super::momentum::energy_of;
use crate::domain::{Domain, Left};

impl Bonded {
    /// Whether some particle that is still in the run is wholly outside a box.
    pub(crate) fn has_outside(&self, domain: &Domain) -> bool {
        let all = &self.particles;
        (0..all.len()).any(|i| !all.is_out(i) && domain.is_ball_outside(&all.position[i], all.radius[i]))
    }

    /// Lets every piece leave that bonds connect, also those that have separated by their law and may close again, that is wholly outside a box, that nothing holds, and that touches nothing.
    /// Returns its energy of motion at tⁿ, ½ m v·(v + Δt a) as central differences conserve it [J], and its particles: what its bonds
    /// store stays in the energy of the bonds. To be called between the forces of tⁿ and the kick.
    ///
    /// - `touching`: particles that touch something else than particles of their body
    /// - `dt` [s]: the step that led to tⁿ
    pub(crate) fn let_leave(&mut self, domain: &Domain, touching: &[u32], dt: f64, left: &mut Left) -> (f64, Vec<u32>) {
        let all = &self.particles;
        let bonds = self.pairs_of(|body, bond| body.bonds.is_live(bond));
        let of_clumps = (0..self.clumps.len()).flat_map(|clump| {
            let own = self.clumps.particles_of(clump);
            own.clone().skip(1).map(move |i| [own.start as u32, i as u32])
        });
        let piece = connected(all.len(), bonds.chain(of_clumps));
        let clump_of = self.clumps.of_particles(all.len());
        let mut stays = vec![false; all.len()];
        touching.iter().for_each(|&i| stays[piece[i as usize] as usize] = true);
        for i in 0..all.len() {
            // Clumps hold their spheres, and nothing holds clumps; what is out has left.
            let held = all.is_held(i) && (all.is_out(i) || clump_of.get(i).is_none_or(|clump| *clump == NO_CLUMP));
            let bound = held || !domain.is_ball_outside(&all.position[i], all.radius[i]);
            stays[piece[i] as usize] |= bound;
        }
        for [i, j] in self.bodies.iter().filter_map(|body| body.fracture.as_ref()).flat_map(|f| f.touching(all)) {
            let [one, other] = [i, j].map(|i| piece[i as usize] as usize);
            if one != other {
                stays[one] = true;
                stays[other] = true;
            }
        }
        let leaves: Vec<u32> = (0..all.len() as u32).filter(|&i| !stays[piece[i as usize] as usize]).collect();
        let mut energy = 0.0;
        for &i in &leaves {
            let particle = i as usize;
            left.pieces += usize::from(piece[particle] == i);
            if let Some(&clump) = clump_of.get(particle).filter(|clump| **clump != NO_CLUMP) {
                // With the first of its spheres it leaves as a whole.
                if piece[particle] == i {
                    let clump = clump as usize;
                    let [force, moment] = self.clumps.load(clump, &self.particles);
                    let (velocity, spin) = (self.clumps.motion.velocity[clump], self.clumps.motion.spin[clump]);
                    energy += self.clumps.kinetic_energy_of(clump);
                    energy += 0.5 * dt * (force.dot(&velocity) + moment.dot(&spin));
                    left.mass += self.clumps.mass(clump);
                    left.momentum += velocity * self.clumps.mass(clump);
                }
                continue;
            }
            let Particles { velocity, spin, force, moment, mass, .. } = &self.particles;
            let (v, w, mass) = (velocity[particle], spin[particle], mass[particle]);
            // What resists the change of lengths books its own work.
            let viscous = self.viscous.get(particle).copied().unwrap_or_default();
            energy += energy_of(&self.particles, &[i]);
            energy += 0.5 * dt * ((force[particle] - viscous).dot(&v) + moment[particle].dot(&w));
            left.mass += mass;
            left.momentum += v * mass;
        }
        self.take_out(&leaves);
        (energy, leaves)
    }

    /// Takes particles out of the run, which touch nothing but each other.
    pub(crate) fn take_out(&mut self, particles: &[u32]) {
        if particles.is_empty() {
            return;
        }
        for i in particles.iter().map(|&i| i as usize) {
            self.particles.take_out(i);
            for past in [&mut self.past.force, &mut self.past.moment] {
                past.get_mut(i).into_iter().for_each(|past| *past = Vec3::zeros());
            }
        }
        for clump in 0..self.clumps.len() {
            if self.particles.is_out(self.clumps.particles_of(clump).start) {
                self.clumps.take_out(clump);
            }
        }
        for body in &mut self.bodies {
            body.fracture.iter_mut().for_each(|fracture| fracture.part_from_left(&self.particles));
        }
    }

    /// Gives a particle that has come in the force of the moment as that of the step before, where damping looks at it.
    pub(crate) fn let_past_be_present(&mut self, particle: usize) {
        let Bonded { particles, past, .. } = self;
        for (past, present) in [(&mut past.force, &particles.force), (&mut past.moment, &particles.moment)] {
            past.get_mut(particle).into_iter().for_each(|past| *past = present[particle]);
        }
    }
}
