use fractum_dem::{Equilibrium, strain, stress};
use fractum_math::{Sym3, Vec3};
use serde::Serialize;

use crate::Sample;

/// Mean stress and strain of an inner part of a sample, away from grips and free surfaces.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Gauge {
    /// Particles in the gauge section.
    pub particles: usize,
    /// Virial stress with the interior volume fraction [Pa], xx yy zz xy yz zx.
    pub stress: [f64; 6],
    /// Best-fit strain.
    pub strain: [f64; 6],
}

impl Gauge {
    /// Measures the particles whose reference centres satisfy `inside`; none when they are too few to fit a strain.
    pub fn of(sample: &Sample, rest: &Equilibrium, inside: impl Fn(&Vec3) -> bool) -> Option<Self> {
        let position = &sample.packing.position;
        let set: Vec<usize> = (0..position.len()).filter(|&i| inside(&position[i])).collect();
        if set.len() < 30 {
            return None;
        }
        let virials = stress::particle_virials(position.len(), |visit| {
            sample.lattice.bond_forces(&rest.state, |i, j, force| visit(i, j, position[j] - position[i], force));
        });
        let sphere = |r: &f64| 4.0 / 3.0 * std::f64::consts::PI * r.powi(3);
        let volume: Vec<f64> = sample.packing.radius.iter().map(sphere).collect();
        let stress = stress::mean_stress(&virials, &volume, sample.fraction, set.iter().copied());
        let displacement = |i: usize| Vec3::new(rest.state[i][0], rest.state[i][1], rest.state[i][2]);
        let strain = strain::best_fit(set.iter().map(|&i| (position[i], displacement(i))))?;
        Some(Gauge { particles: set.len(), stress: stress.0, strain: strain.0 })
    }

    /// Isotropic elastic constants that fit stress and strain of a uniaxial test along an axis: E and ν.
    pub fn uniaxial(&self, axis: usize) -> (f64, f64) {
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        let lateral = 0.5 * (self.strain[a] + self.strain[b]);
        (self.stress[axis] / self.strain[axis], -lateral / self.strain[axis])
    }

    /// Stress as a tensor [Pa].
    pub fn stress(&self) -> Sym3 {
        Sym3(self.stress)
    }
}
