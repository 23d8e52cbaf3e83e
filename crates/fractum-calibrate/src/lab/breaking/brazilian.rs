use fractum_math::elementary::{atan, cos, sin};
use std::f64::consts::PI;

use fractum_dem::{Dof6, stress};
use fractum_math::{Vec3, sphere_volume};
use serde::Serialize;

use crate::Sample;

/// Half the angle of the loading arcs [rad].
pub(super) const HALF_ARC: f64 = 12.0 * PI / 180.0;

/// Hoop stress over the pressure on the arcs, on the loaded diameter of a disc at r/R (Hondros 1959; Nguyen et al.
/// 2019, eq. 28).
pub fn hondros(share: f64) -> f64 {
    let (a, s) = (2.0 * HALF_ARC, share * share);
    let first = (1.0 - s) * sin(a) / (1.0 - 2.0 * s * cos(a) + s * s);
    2.0 / PI * (first - atan(s * sin(a) / (1.0 - s * cos(a))) - HALF_ARC)
}

/// Horizontal stress in a slice of the loaded diameter.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Diameter {
    /// r/R of the middle of the slice; both halves of the diameter are taken together.
    pub share: f64,
    /// Mean virial stress across the diameter over the pressure 𝑃/(2 α R t) on the arcs.
    pub measured: f64,
    /// Hondros' value, mean over the slice.
    pub theory: f64,
    /// Particles in the slice.
    pub particles: usize,
}

/// Horizontal stress along the loaded diameter (y) of a disc for a state and its load [N], in ten slices from the
/// centre to the rim, each 0.2 R wide across the diameter.
pub fn diameter(sample: &Sample, state: &[Dof6], load: f64) -> Vec<Diameter> {
    let Some((thickness, radius)) = sample.cylinder_extents() else { return Vec::new() };
    let position = &sample.packing.position;
    let virials = stress::particle_virials(position.len(), |visit| {
        sample.lattice.bond_forces(state, |i, j, force| visit(i, j, position[j] - position[i], force));
    });
    let volume: Vec<f64> = sample.packing.radius.iter().map(|r| sphere_volume(*r)).collect();
    let (lower, upper) = sample.packing.domain.bounds();
    let centre = (lower + upper) * 0.5;
    let pressure = load / (2.0 * HALF_ARC * radius * thickness);
    const SLICES: usize = 10;
    let slice = |k: usize| {
        let inside = |x: &Vec3| {
            let d = (x - centre) / radius;
            ((d.y.abs() * SLICES as f64) as usize) == k && d.z.abs() < 0.1
        };
        let set: Vec<usize> = (0..position.len()).filter(|&i| inside(&position[i])).collect();
        let measured = stress::mean_stress(&virials, &volume, sample.fraction, set.iter().copied()).0[2] / pressure;
        let theory = (0..20).map(|j| hondros((k as f64 + (f64::from(j) + 0.5) / 20.0) / SLICES as f64)).sum::<f64>();
        Diameter { share: (k as f64 + 0.5) / SLICES as f64, measured, theory: theory / 20.0, particles: set.len() }
    };
    (0..SLICES).map(slice).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hondros_has_the_values_of_the_table() {
        let table = [(0.0, 0.12560), (0.2, 0.12363), (0.4, 0.11487), (0.5, 0.10386), (0.6, 0.08113), (0.7, 0.02919)];
        for (share, value) in table.into_iter().chain([(0.8, -0.10177), (0.9, -0.42868)]) {
            assert!((hondros(share) - value).abs() < 6e-6, "{share}: {}", hondros(share));
        }
    }
}
