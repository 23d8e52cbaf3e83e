use fractum_dem::{Equilibrium, strain, stress};
use fractum_math::{Sym3, Vec3, sphere_volume};
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
        let volume: Vec<f64> = sample.packing.radius.iter().map(|r| sphere_volume(*r)).collect();
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

#[cfg(test)]
mod tests {
    use fractum_dem::{StrainGauge, StrainMeasure, Tolerance};
    use fractum_math::rotation_by;
    use fractum_pack::{Convention, Domain, PackSpec, pack};

    use super::*;
    use crate::Micro;
    use crate::lab::tension;

    #[test]
    fn every_strain_of_a_random_packing_under_tension_is_that_of_its_borders_within_three_per_cent() {
        let packing = pack(&PackSpec::new(Domain::cuboid(2e-3, 1e-3, 1e-3), 4000, 1)).unwrap();
        let mut sample = Sample::new(packing, 10.0, Convention::Interior).unwrap();
        sample.set_micro(Micro { radius_ratio: 0.5, young_modulus: 100e9 }).unwrap();
        let (_, rest) = tension(&sample, 0, None, Tolerance::default()).unwrap();
        let place = &sample.packing.position;
        let mean = |wall: &str, axis: usize| {
            let set = sample.packing.wall(wall).unwrap();
            let [x, u] = [0, 1].map(|k| {
                let of = |i: &u32| if k == 0 { place[*i as usize][axis] } else { rest.state[*i as usize][axis] };
                set.iter().map(of).sum::<f64>() / set.len() as f64
            });
            (x, u)
        };
        let border = |low: &str, high: &str, axis: usize| {
            let ((x0, u0), (x1, u1)) = (mean(low, axis), mean(high, axis));
            (u1 - u0) / (x1 - x0)
        };
        let borders = [border("x-", "x+", 0), border("y-", "y+", 1), border("z-", "z+", 2)];
        let set: Vec<u32> = (0..place.len() as u32).collect();
        let rotation = |i: usize| rotation_by(Vec3::new(rest.state[i][3], rest.state[i][4], rest.state[i][5]));
        let displacement = |i: usize| Vec3::new(rest.state[i][0], rest.state[i][1], rest.state[i][2]);
        for measure in [StrainMeasure::Cundall, StrainMeasure::Bagi, StrainMeasure::Satake] {
            let gauge = StrainGauge::new(measure, &set, |i| place[i], |i| sample.packing.radius[i]).unwrap();
            let found = gauge.strain(displacement, rotation).0;
            for (found, border) in found.iter().zip(borders) {
                assert!((found - border).abs() < 0.03 * borders[0].abs(), "{measure:?}: {found} {border}");
            }
        }
    }
}
