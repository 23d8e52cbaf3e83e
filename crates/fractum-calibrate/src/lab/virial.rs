use fractum_dem::{BondGraph, Tolerance, stress};
use fractum_math::sphere_volume;

use super::{STRAIN, tension};
use crate::{CalibrateError, Sample};

/// Mean stress of particles along a pull over that on the section, less 1 (Nguyen et al. 2019, eq. 9, Table 1): of the
/// particle alone, with those bonded to it, and with their partners. The particles of the pulled faces do not count.
///
/// - `fraction`: volume fraction that turns the volumes of spheres into space
///
/// # Errors
/// A shape without end faces along x; a solve that does not converge.
pub fn virial_errors(sample: &Sample, fraction: f64, tolerance: Tolerance) -> Result<[f64; 3], CalibrateError> {
    let (test, rest) = tension(sample, 0, None, tolerance)?;
    let on_section = test.young_modulus * STRAIN;
    let position = &sample.packing.position;
    let virials = stress::particle_virials(position.len(), |visit| {
        sample.lattice.bond_forces(&rest.state, |i, j, force| visit(i, j, position[j] - position[i], force));
    });
    let volume: Vec<f64> = sample.packing.radius.iter().map(|r| sphere_volume(*r)).collect();
    let graph = BondGraph::new(position.len(), &sample.network.pairs);
    let mut counts = vec![true; position.len()];
    for wall in ["x-", "x+"] {
        sample.packing.wall(wall).unwrap_or_default().iter().for_each(|&i| counts[i as usize] = false);
    }
    let (mut sums, mut particles) = ([0.0; 3], 0.0);
    for i in (0..position.len()).filter(|&i| counts[i]) {
        let mut near = vec![i];
        for sum in &mut sums {
            *sum += stress::mean_stress(&virials, &volume, fraction, near.iter().copied()).0[0];
            let partners: Vec<usize> =
                near.iter().flat_map(|&j| graph.neighbours(j)).map(|half| half.other as usize).collect();
            near.extend(partners);
            near.sort_unstable();
            near.dedup();
        }
        particles += 1.0;
    }
    Ok(sums.map(|sum| sum / particles / on_section - 1.0))
}
