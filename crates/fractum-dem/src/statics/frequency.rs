//! The highest natural frequency of a bonded body.

use std::ops::Range;

use fractum_math::{Vec3, largest_eigenvalue};
use nalgebra::Vector6;

use super::Lattice;
use crate::DemError;
use crate::bond::Bonds;
use crate::particles::Particles;

/// Products of the Lanczos process.
const LANCZOS_STEPS: usize = 48;

/// Highest natural frequency ω [rad/s] of particles `range`, which hold all ends of these bonds, by the Lanczos process
/// on the linear stiffness of the live ones; it converges from below, and the value carries a margin of 2 %. Breaking
/// bonds only lowers it.
///
/// # Errors
/// A section that is no beam, a bond that joins nothing.
pub fn highest_frequency(bonds: &Bonds, particles: &Particles, range: Range<usize>) -> Result<f64, DemError> {
    // Laws without a lattice keep the bound.
    let Some(section) = bonds.beam() else { return Ok(2.0 / bonds.stable_step(particles, 1.0)) };
    let own = |i: u32| i - range.start as u32;
    let live = (0..bonds.len()).filter(|&bond| bonds.is_live(bond));
    let pairs: Vec<[u32; 2]> = live.map(|bond| bonds.pairs()[bond].map(own)).collect();
    let position = &particles.position[range.clone()];
    // Rotations times this length have the inertia of a displacement of the largest particle.
    let scale = particles.radius[range.clone()].iter().copied().fold(0.0, f64::max);
    let lattice = match bonds.through_box() {
        None => Lattice::new(position, &pairs, section, scale)?,
        Some((cell, _)) => {
            let nearest = |apart: Vec3| apart + cell.offset(&cell.nearest_image(&apart));
            Lattice::between(position, &pairs, &[], section, scale, &nearest)?
        }
    };
    let root = |i: usize| {
        let (mass, inertia) = (particles.mass[range.start + i], particles.inertia[range.start + i]);
        (1.0 / mass.sqrt(), scale / inertia.sqrt())
    };
    let scaled = |i: usize, v: &[f64; 6]| -> [f64; 6] {
        let (move_by, turn_by) = root(i);
        std::array::from_fn(|a| v[a] * if a < 3 { move_by } else { turn_by })
    };
    let free = vec![0; position.len()];
    let (mut x, mut force) = (vec![[0.0; 6]; position.len()], vec![[0.0; 6]; position.len()]);
    let square = largest_eigenvalue(position.len(), LANCZOS_STEPS, &mut |q: &[Vector6<f64>]| {
        x.iter_mut().zip(q).enumerate().for_each(|(i, (x, q))| *x = scaled(i, &q.data.0[0]));
        lattice.apply(&x, &free, &mut force);
        force.iter().enumerate().map(|(i, f)| Vector6::from(scaled(i, f))).collect()
    });
    Ok(1.02 * square.sqrt())
}
