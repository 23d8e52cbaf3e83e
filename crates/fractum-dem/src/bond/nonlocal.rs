//! Networks whose bonds resist what their particles do beside their mean strain.

use fractum_kernels::bond::{BondForces, BondLaw};
use fractum_math::{Vec3, largest_eigenvalue};
use nalgebra::Vector6;
use rayon::prelude::*;

use super::block::sum_deviations;
use super::network::{BLOCK, BondNetwork};
use crate::particles::{Particles, turned};

/// Products of the Lanczos process.
const LANCZOS_STEPS: usize = 48;

/// Displacement by which stiffness is measured, over the shortest bond: far above the rounding of places far from the origin, far below
/// what fails.
const PROBE: f64 = 1e-6;

impl<L: BondLaw> BondNetwork<L> {
    /// Adds the forces of the bonds and of the mean strains, and separates what fails under them; the forces of this instant are those of
    /// before, and act on the kick that follows: [`BondNetwork::book_last_work`].
    pub(super) fn add_deviating_forces(&mut self, particles: &mut Particles) {
        self.find_deviations(particles);
        self.add_found_forces(&mut particles.force, &mut particles.moment);
        self.separate_overloaded(particles);
    }

    /// Finds the mean strains, the sums of bonds, the bonds that fail, and the stresses of the mean strains.
    fn find_deviations(&mut self, particles: &Particles) {
        let law = self.law;
        let Some(mean) = self.mean.as_mut() else { return };
        let Particles { position, orientation, .. } = particles;
        mean.find_strains(position);
        let field = &*mean;
        self.blocks.par_iter_mut().for_each(|block| sum_deviations(block, position, orientation, &law, field));
        let blocks = &self.blocks;
        mean.find_stresses(BLOCK, |number, sums| {
            let block = &blocks[number];
            sums.copy_from_slice(&block.shares[..block.count]);
            for &(from, slot, own) in &block.incoming {
                let incoming = blocks[from as usize].shares[slot as usize];
                (0..6).for_each(|k| sums[own as usize][k] += incoming[k]);
            }
        });
    }

    fn add_found_forces(&self, force: &mut [Vec3], moment: &mut [Vec3]) {
        self.add_sums(force, moment);
        self.mean.iter().for_each(|mean| mean.add_forces(force));
    }

    /// Takes the mean strains away that a bond which has separated leaves no particle.
    pub(super) fn release_about(&mut self, bond: usize) {
        let Some(mean) = self.mean.as_mut() else { return };
        let about = &mut self.separating.about;
        mean.spanning(self.pairs[bond], about);
        mean.release(about);
    }

    /// Force of a bond with the stress that the mean strain of its particles adds.
    pub(super) fn traction_of(&self, bond: usize, particles: &Particles) -> Option<BondForces> {
        let mean = self.mean.as_ref()?;
        if L::separation(self.lasting_memory(bond)).is_some() {
            return None;
        }
        self.law.traction(&self.pair(bond, particles), mean.between(self.pairs[bond]), &self.own[bond])
    }

    /// Highest natural frequency of the bonds as they were made [rad/s], by the Lanczos process on their forces; it converges from below, and the
    /// value carries a margin of 2 %.
    pub(super) fn measured_frequency(&self, particles: &Particles) -> f64 {
        let (mut bonds, mut moved) = (self.clone(), particles.clone());
        let shortest = self.length.iter().copied().fold(f64::INFINITY, f64::min);
        let roots: Vec<[f64; 2]> =
            particles.mass.iter().zip(&particles.inertia).map(|(m, r)| [1.0 / m.sqrt(), 1.0 / r.sqrt()]).collect();
        let parts =
            |q: &Vector6<f64>, [m, r]: [f64; 2]| (Vec3::new(q[0], q[1], q[2]) * m, Vec3::new(q[3], q[4], q[5]) * r);
        let square = largest_eigenvalue(particles.len(), LANCZOS_STEPS, &mut |q: &[Vector6<f64>]| {
            let size = q
                .iter()
                .zip(&roots)
                .map(|(q, root)| parts(q, *root))
                .map(|(x, turn)| x.norm() + turn.norm() * shortest);
            let scale = PROBE * shortest / size.fold(f64::MIN_POSITIVE, f64::max);
            for (i, (q, root)) in q.iter().zip(&roots).enumerate() {
                let (shift, turn) = parts(q, *root);
                moved.position[i] = particles.position[i] + shift * scale;
                moved.orientation[i] = turned(&particles.orientation[i], turn * scale);
            }
            moved.clear_forces();
            bonds.add_forces(&mut moved);
            let pulls = moved.force.iter().zip(&moved.moment).zip(&roots);
            let back = |((f, m), [root, turn]): ((&Vec3, &Vec3), &[f64; 2])| {
                let (f, m) = (f * (-root / scale), m * (-turn / scale));
                Vector6::new(f.x, f.y, f.z, m.x, m.y, m.z)
            };
            pulls.map(back).collect()
        });
        1.02 * square.max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bond::{BondNetwork, LocalBond};
    use crate::particles::{CentralDifference, ParticleDamping};
    use fractum_math::{Rotation, Sym3};

    const YOUNG: f64 = 1e9;
    const POISSON: f64 = 0.3;

    fn scatter(seed: usize) -> Vec3 {
        let one = |k: usize| ((seed * 3 + k) as f64 * 12.9898).sin() * 43_758.545;
        Vec3::from_fn(|a, _| 2.0 * (one(a) - one(a).floor()) - 1.0)
    }

    /// Spheres of a jittered cubic lattice of unit spacing and their bonds to the nearest and some further ones; the body has the volume side³.
    fn body(side: usize, law: LocalBond) -> (Particles, BondNetwork<LocalBond>) {
        let site = |i: usize| Vec3::new((i % side) as f64, (i / side % side) as f64, (i / side / side) as f64);
        let position: Vec<Vec3> = (0..side.pow(3)).map(|i| site(i) + scatter(i) * 0.1).collect();
        let radius: Vec<f64> = (0..position.len()).map(|i| 0.5 + 0.05 * scatter(i).x).collect();
        let mut pairs = Vec::new();
        for j in 0..position.len() {
            pairs.extend((0..j).filter(|&i| (position[i] - position[j]).norm() < 1.35).map(|i| [i as u32, j as u32]));
        }
        let particles = Particles::at_rest(position, radius, 1000.0).unwrap();
        let spheres: f64 = particles.radius.iter().map(|r| fractum_math::sphere_volume(*r)).sum();
        let law = LocalBond { mean_strain: Some(spheres / side.pow(3) as f64), ..law };
        let bonds = BondNetwork::with_shares(&particles, &pairs, &vec![0.9; pairs.len()], law).unwrap();
        (particles, bonds)
    }

    /// The lattice without some of its sites.
    fn body_without(
        side: usize,
        law: LocalBond,
        gone: impl Fn([usize; 3]) -> bool,
    ) -> (Vec<[usize; 3]>, Particles, BondNetwork<LocalBond>) {
        let site = |i: usize| [i % side, i / side % side, i / side / side];
        let (whole, bonds) = body(side, law);
        let kept: Vec<usize> = (0..whole.len()).filter(|&i| !gone(site(i))).collect();
        let number = |i: u32| kept.binary_search(&(i as usize)).ok().map(|k| k as u32);
        let pairs: Vec<[u32; 2]> = bonds.pairs.iter().filter_map(|[i, j]| Some([number(*i)?, number(*j)?])).collect();
        let of = |k: &usize| (whole.position[*k], whole.radius[*k]);
        let (position, radius) = kept.iter().map(of).unzip();
        let particles = Particles::at_rest(position, radius, 1000.0).unwrap();
        let bonds = BondNetwork::with_shares(&particles, &pairs, &vec![0.9; pairs.len()], *bonds.law()).unwrap();
        (kept.into_iter().map(site).collect(), particles, bonds)
    }

    fn elastic() -> (Particles, BondNetwork<LocalBond>) {
        body(6, LocalBond::elastic(YOUNG, POISSON))
    }

    fn forces(particles: &mut Particles, bonds: &mut BondNetwork<LocalBond>) -> (Vec<Vec3>, Vec<Vec3>) {
        particles.clear_forces();
        bonds.add_forces(particles);
        (particles.force.clone(), particles.moment.clone())
    }

    fn shake(particles: &mut Particles, size: f64) {
        for i in 0..particles.len() {
            particles.position[i] += scatter(i + 1000) * size;
            particles.orientation[i] = Rotation::from_scaled_axis(scatter(i + 2000) * size) * particles.orientation[i];
        }
    }

    #[test]
    fn uniform_strain_has_the_energy_of_hookes_law_and_no_forces_inside() {
        let (mut particles, mut bonds) = body(8, LocalBond::elastic(YOUNG, POISSON));
        let strain = Sym3::new(3e-7, -1e-7, 2e-7, 1e-7, -2e-7, 0.5e-7);
        particles.position.iter_mut().for_each(|x| *x += strain * *x);
        let (force, moment) = forces(&mut particles, &mut bonds);
        let (lame, shear) = (YOUNG * POISSON / (1.3 * 0.4), YOUNG / 2.6);
        let stress = Sym3::isotropic(lame * strain.trace()) + strain * (2.0 * shear);
        let exact = 0.5 * stress.dot(strain) * 512.0;
        assert!(
            (bonds.energy(&particles).total() / exact - 1.0).abs() < 1e-5,
            "{} {exact}",
            bonds.energy(&particles).total()
        );
        // Two layers share the volume of the border, and their cells reach the third.
        let inside = |i: usize| [i % 8, i / 8 % 8, i / 64].iter().all(|site| (3..5).contains(site));
        let scale = YOUNG * 3e-7;
        let deep: Vec<usize> = (0..force.len()).filter(|&i| inside(i)).collect();
        assert!(!deep.is_empty());
        for i in deep {
            assert!(
                force[i].norm() < 1e-5 * scale && moment[i].norm() < 1e-5 * scale,
                "{i}: {} {}",
                force[i],
                moment[i]
            );
        }
    }

    #[test]
    fn forces_are_the_derivative_of_the_energy_and_keep_momentum_and_angular_momentum() {
        let (mut particles, mut bonds) = elastic();
        let turn = Rotation::from_scaled_axis(Vec3::new(0.4, -0.7, 0.2));
        particles.position.iter_mut().for_each(|x| *x = turn * *x);
        particles.orientation.iter_mut().for_each(|q| *q = turn * *q);
        let (still, _) = forces(&mut particles, &mut bonds);
        shake(&mut particles, 0.02);
        let (force, moment) = forces(&mut particles, &mut bonds);
        let largest = force.iter().map(|f| f.norm()).fold(0.0, f64::max);
        assert!(still.iter().all(|f| f.norm() < 1e-9 * largest), "rigid motion");
        let sum: Vec3 = force.iter().sum();
        let about: Vec3 = (0..force.len()).map(|i| particles.position[i].cross(&force[i]) + moment[i]).sum();
        assert!(sum.norm() < 1e-11 * largest * 216.0 && about.norm() < 1e-11 * largest * 1296.0, "{sum} {about}");
        let step = 1e-6;
        for i in [0, 43, 129, 215] {
            for a in 0..3 {
                let axis = Vec3::ith(a, step);
                let energy = |particles: &Particles| {
                    let mut bonds = bonds.clone();
                    forces(&mut particles.clone(), &mut bonds);
                    bonds.energy(particles).total()
                };
                let quotient = |change: &dyn Fn(&mut Particles, f64)| {
                    let [up, down] = [1.0, -1.0].map(|sign| {
                        let mut moved = particles.clone();
                        change(&mut moved, sign);
                        energy(&moved)
                    });
                    (down - up) / (2.0 * step)
                };
                let pull = quotient(&|p, sign| p.position[i] += axis * sign);
                let twist =
                    quotient(&|p, sign| p.orientation[i] = Rotation::from_scaled_axis(axis * sign) * p.orientation[i]);
                assert!((pull - force[i][a]).abs() < 1e-6 * largest, "{i} {a}: {pull} {}", force[i][a]);
                assert!((twist - moment[i][a]).abs() < 1e-6 * largest, "{i} {a}: {twist} {}", moment[i][a]);
            }
        }
    }

    #[test]
    fn energy_is_kept_over_many_periods_at_a_step_comparable_to_that_of_the_bonds_alone() {
        let (mut particles, mut bonds) = elastic();
        let alone = BondNetwork::with_shares(
            &particles,
            &bonds.pairs.clone(),
            &vec![0.9; bonds.pairs.len()],
            LocalBond::elastic(YOUNG, POISSON),
        );
        let dt = bonds.stable_step(&particles, 0.7);
        let ratio = alone.unwrap().stable_step(&particles, 0.7) / dt;
        assert!((1.0..2.5).contains(&ratio), "{ratio}");
        particles.velocity.iter_mut().enumerate().for_each(|(i, v)| *v = scatter(i) * 1e-4);
        particles.start_half_a_step_early(dt);
        let mut motion = CentralDifference::new(&particles, dt, ParticleDamping::default());
        let (mut start, mut most) = (f64::NAN, 0.0f64);
        for step in 0..4000 {
            particles.clear_forces();
            bonds.add_forces(&mut particles);
            let elastic = bonds.energy(&particles).total();
            let total = motion.kick_drift_and_measure(&mut particles).before.kinetic + elastic;
            if step == 0 {
                start = total;
            }
            most = most.max((total / start - 1.0).abs());
        }
        assert!(most < 1e-6, "{most}");
    }

    #[test]
    fn what_fails_leaves_the_mean_strain_with_its_energy_booked_and_a_saved_memory_goes_on() {
        let strengths = LocalBond {
            tensile_strength: 1e5,
            shear_strength: 1e6,
            friction: 0.3,
            ..LocalBond::elastic(YOUNG, POISSON)
        };
        let (mut particles, mut bonds) = body(6, strengths);
        let mut separated = 0;
        for step in 1..=40 {
            particles.position.iter_mut().for_each(|x| x.x *= 1.0 + 4e-6);
            // Bonds that hold for ever, with the same past: nothing is lost against them but what is booked.
            let mut strong = bonds.clone();
            (strong.law.tensile_strength, strong.law.shear_strength) = (f64::INFINITY, f64::INFINITY);
            let expected = forces(&mut particles, &mut strong);
            assert_eq!(forces(&mut particles, &mut bonds), expected, "what fails still pulls in step {step}");
            let [held, left] = [&strong, &bonds].map(|of| of.energy(&particles).total() + of.dissipated());
            assert!((left / held - 1.0).abs() < 1e-12, "step {step}: {held} {left}");
            let mut listed = Vec::new();
            bonds.take_separated(&mut listed);
            separated += listed.len();
        }
        assert!(separated > 20 && bonds.dissipated() > 0.0, "{separated} {}", bonds.dissipated());
        let expected = forces(&mut particles, &mut bonds);
        let (_, mut other) = body(6, strengths);
        other.restore_memory(&bonds.memory());
        assert_eq!(forces(&mut particles, &mut other), expected);
    }

    #[test]
    fn parts_that_have_come_apart_exert_no_force_on_each_other() {
        let strengths = LocalBond { tensile_strength: 1e5, shear_strength: 1e5, ..LocalBond::elastic(YOUNG, POISSON) };
        // Across the diagonals of cells, which bonds do not join.
        let beyond = |[x, y, z]: [usize; 3]| x + y + z > 7;
        let (sites, mut particles, mut bonds) = body_without(6, strengths, |_| false);
        let mut memory = bonds.memory();
        for (bond, memory) in memory.iter_mut().enumerate() {
            let [i, j] = bonds.pairs[bond].map(|i| sites[i as usize]);
            if beyond(i) != beyond(j) {
                *memory = bonds.law.failed(&bonds.pair(bond, &particles), Sym3::ZERO, &bonds.own[bond]);
            }
        }
        bonds.restore_memory(&memory);
        let moves = particles.position.iter_mut().zip(&sites).filter(|(_, site)| beyond(**site));
        moves.for_each(|(x, _)| *x += Vec3::repeat(0.3));
        let (force, moment) = forces(&mut particles, &mut bonds);
        let scale = YOUNG * 0.3;
        let largest = force.iter().chain(&moment).map(|f| f.norm()).fold(0.0, f64::max);
        assert!(largest < 1e-12 * scale, "{largest} {scale}");
        let (mean, mut about) = (bonds.mean.as_ref().unwrap(), Vec::new());
        let mut is_intact = |i: u32| {
            mean.spanning([i, i], &mut about);
            about.contains(&i)
        };
        let intact = (0..sites.len() as u32).filter(|&i| is_intact(i)).count();
        let broken = (0..memory.len()).filter(|&bond| LocalBond::separation(&memory[bond]).is_some());
        let mut lost: Vec<u32> = broken.flat_map(|bond| bonds.pairs[bond]).collect();
        lost.sort_unstable();
        lost.dedup();
        // Particles that have lost no bond themselves had both sides in their cells.
        assert!(intact > 0 && intact + lost.len() < sites.len(), "{intact} {}", lost.len());
    }

    #[test]
    fn sides_of_a_notch_do_not_see_each_other() {
        // A slot of one row, open but for two rows at its bottom.
        let (sites, mut particles, mut bonds) =
            body_without(7, LocalBond::elastic(YOUNG, POISSON), |[x, y, _]| x == 3 && y > 1);
        let across = |cell: &[u32; 4]| {
            let on = |side: &dyn Fn(usize) -> bool| {
                cell.iter().map(|i| sites[*i as usize]).any(|[x, y, _]| y > 3 && side(x))
            };
            on(&|x| x < 3) && on(&|x| x > 3)
        };
        let cells = crate::cells::Tessellation::new(&particles.position, &particles.radius, 0).tetrahedra;
        assert!(cells.iter().any(across), "no cell joins the sides");
        for i in (0..sites.len()).filter(|&i| sites[i][0] > 3 && sites[i][1] > 3) {
            particles.position[i].x += 1e-6;
        }
        let (force, _) = forces(&mut particles, &mut bonds);
        let largest = force.iter().map(|f| f.norm()).fold(0.0, f64::max);
        for i in (0..sites.len()).filter(|&i| sites[i][0] < 3 && sites[i][1] > 3) {
            assert!(force[i].norm() < 1e-9 * largest, "{:?}: {} {largest}", sites[i], force[i]);
        }
        assert!(largest > 0.0);
    }

    #[test]
    fn the_work_of_what_breaks_in_its_last_half_step_is_booked() {
        let strengths = LocalBond {
            tensile_strength: 2e5,
            shear_strength: 1e6,
            friction: 0.3,
            ..LocalBond::elastic(YOUNG, POISSON)
        };
        let (mut particles, mut bonds) = body(6, strengths);
        let dt = bonds.stable_step(&particles, 0.7);
        let centre = Vec3::repeat(2.5);
        particles.velocity = particles.position.iter().map(|x| (x - centre) * 20.0).collect();
        let mut motion = CentralDifference::new(&particles, dt, ParticleDamping::default());
        particles.start_half_a_step_early(dt);
        let (mut start, mut most) = (f64::NAN, 0.0f64);
        for step in 0..600 {
            particles.clear_forces();
            bonds.add_forces(&mut particles);
            let held = bonds.energy(&particles).total() + bonds.dissipated();
            let total = motion.kick_drift_and_measure(&mut particles).before.kinetic + held;
            bonds.book_last_work(&particles, dt);
            if step == 0 {
                start = total;
            }
            most = most.max((total / start - 1.0).abs());
        }
        let mut separated = Vec::new();
        bonds.take_separated(&mut separated);
        assert!(separated.len() > 50, "{}", separated.len());
        assert!(most < 1e-4, "{most}");
    }
}
