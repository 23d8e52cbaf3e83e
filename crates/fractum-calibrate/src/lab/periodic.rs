use fractum_dem::{Dof6, Equilibrium, LatticeSupports, Tolerance};
use fractum_math::Mat3;

use crate::{CalibrateError, Sample};

/// Stiffness of a sample that repeats along x, y and z, as it is without walls: stresses xx, yy, zz, xy, yz, zx under unit strains
/// (γ in shear) [Pa].
///
/// All bonds are strained alike, and particles move and turn from there to equilibrium: C_kl = (a_k · K a_l + w_k · f_l)/V with uniform
/// strains a, the forces f of these and the ways w to equilibrium. The first part alone is the bound of Voigt.
///
/// - `count`: how many of the strains are applied, the first ones; rows and columns of others are zero
/// - `warm`: ways to start from, and those found
///
/// # Errors
/// A sample with walls; a solve that does not converge.
pub fn stiffness(
    sample: &Sample,
    count: usize,
    warm: &mut [Option<Equilibrium>; 6],
    tolerance: Tolerance,
) -> Result<[[f64; 6]; 6], CalibrateError> {
    let packing = &sample.packing;
    if packing.domain.period().is_none() {
        return Err(CalibrateError::Shape { test: "stiffness without walls", shape: "a box that repeats" });
    }
    let forces: Vec<Vec<Dof6>> =
        (0..count).map(|strain| sample.lattice.internal_of_gradient(&gradient(strain))).collect();
    for (forces, warm) in forces.iter().zip(warm.iter_mut()) {
        let loads: Vec<Dof6> = forces.iter().map(|force| force.map(|f| -f)).collect();
        let rest = vec![[0.0; 6]; packing.len()];
        let guess = warm.as_ref().map_or(&rest, |known| &known.state);
        let found = sample.lattice.solve(&LatticeSupports::none(packing.len()), Some(&loads), guess, tolerance)?;
        *warm = Some(found);
    }
    let volume = packing.domain.volume();
    let mut found = [[0.0; 6]; 6];
    for k in 0..count {
        for (l, forces) in forces.iter().enumerate() {
            let uniform = sample.lattice.energy_of_gradients(&gradient(k), &gradient(l));
            let way = warm[k].iter().flat_map(|own| &own.state).flatten();
            let given: f64 = way.zip(forces.iter().flatten()).map(|(way, force)| way * force).sum();
            found[k][l] = (uniform + given) / volume;
        }
    }
    Ok(found)
}

/// Bound of Voigt on [`stiffness`]: all bonds strained alike, without turning particles [Pa].
pub fn voigt(sample: &Sample) -> [[f64; 6]; 6] {
    let volume = sample.packing.domain.volume();
    let entry = |k: usize, l: usize| sample.lattice.energy_of_gradients(&gradient(k), &gradient(l)) / volume;
    std::array::from_fn(|k| std::array::from_fn(|l| entry(k, l)))
}

/// Young's modulus [Pa] and Poisson's ratio under a pull along x, y and z that leaves the sides free, from a [`stiffness`].
pub fn uniaxial(stiffness: &[[f64; 6]; 6]) -> [(f64, f64); 3] {
    let normal = Mat3::from_fn(|row, column| stiffness[row][column]);
    let compliance = normal.try_inverse().unwrap_or_else(Mat3::zeros);
    [0, 1, 2].map(|axis| {
        let lateral = compliance.column(axis).sum() - compliance[(axis, axis)];
        (1.0 / compliance[(axis, axis)], -0.5 * lateral / compliance[(axis, axis)])
    })
}

/// Gradient of displacement of a unit strain, xx, yy, zz, xy, yz, zx.
fn gradient(strain: usize) -> Mat3 {
    let (row, column) = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)][strain];
    let mut gradient = Mat3::zeros();
    gradient[(row, column)] += 0.5;
    gradient[(column, row)] += 0.5;
    gradient
}

#[cfg(test)]
mod tests {
    use fractum_math::Vec3;
    use fractum_pack::{Arrangement, Convention, Domain, PackSpec, pack, regular_repeating};

    use super::*;
    use crate::prepare::{BondedMaterial, prepare};
    use crate::{Micro, laws};

    const TIGHT: Tolerance = Tolerance { residual: 1e-8, iterations: 20_000, stop: || false };

    fn full(sample: &Sample) -> [[f64; 6]; 6] {
        stiffness(sample, 6, &mut Default::default(), TIGHT).unwrap()
    }

    #[test]
    fn a_cubic_lattice_has_its_closed_form() {
        let packing = regular_repeating(Vec3::zeros(), Vec3::new(1.0, 1.2, 1.4), 0.1, Arrangement::Cartesian).unwrap();
        let mut sample = Sample::new(packing, 6.0, Convention::All).unwrap();
        sample.set_micro(Micro { radius_ratio: 0.5, young_modulus: 2e9 }).unwrap();
        let section = sample.lattice.section();
        let (along, across) = (section.axial() / 0.04, 6.0 * section.bending() / 0.2f64.powi(4));
        let (found, bound) = (full(&sample), voigt(&sample));
        for k in 0..6 {
            for l in 0..6 {
                let expected = if k != l {
                    0.0
                } else if k < 3 {
                    along
                } else {
                    across
                };
                for found in [found[k][l], bound[k][l]] {
                    assert!((found - expected).abs() < 1e-9 * along, "{k} {l}: {found} {expected}");
                }
            }
        }
        assert!(
            uniaxial(&found).iter().all(|(young, poisson)| (young / along - 1.0).abs() < 1e-9 && poisson.abs() < 1e-9)
        );
    }

    #[test]
    fn bodies_without_walls_are_isotropic_with_the_moduli_that_were_asked_for() {
        let domain = || Domain::Periodic { lower: Vec3::repeat(-1e-3), upper: Vec3::repeat(1e-3) };
        for (seed, coordination, poisson_ratio) in [(1, 7.0, 0.26), (2, 8.5, 0.2), (3, 10.0, 0.15)] {
            let packing = pack(&PackSpec::new(domain(), 2000, seed)).unwrap();
            let material = BondedMaterial {
                young_modulus: 72e9,
                poisson_ratio,
                density: 2500.0,
                coordination,
                convention: Convention::Interior,
                wall_stiffening: 0.0,
                beams: None,
            };
            let body = prepare(packing, &material).unwrap();
            let mass: f64 = body.particles.mass.iter().sum();
            assert!((mass / (2500.0 * 8e-9) - 1.0).abs() < 1e-12, "no part of it is wall: {mass}");
            let (found, bound) = (full(&body.sample), voigt(&body.sample));
            let axes = uniaxial(&found);
            let mean = |of: fn(&(f64, f64)) -> f64| axes.iter().map(of).sum::<f64>() / 3.0;
            assert!(
                (mean(|axis| axis.0) / 72e9 - 1.0).abs() < 1e-4 && (mean(|axis| axis.1) - poisson_ratio).abs() < 2e-4
            );
            let modulus = 72e9 / (2.0 * (1.0 + poisson_ratio));
            for k in 0..3 {
                assert!((axes[k].0 / 72e9 - 1.0).abs() < 0.03, "seed {seed}: {axes:?}");
                assert!(
                    (found[k + 3][k + 3] / modulus - 1.0).abs() < 0.03,
                    "seed {seed}: {} {modulus}",
                    found[k + 3][k + 3]
                );
            }
            // Symmetric, and softer than all bonds strained alike.
            for k in 0..6 {
                assert!(found[k][k] < bound[k][k]);
                assert!((0..6).all(|l| (found[k][l] - found[l][k]).abs() < 1e-6 * found[0][0]));
            }
            // Beams of walled boxes of 10,000 give as much.
            let law = laws::stored(Convention::Interior).unwrap().micro(72e9, poisson_ratio, coordination).unwrap();
            let ratio = body.beams.micro.radius_ratio / law.radius_ratio;
            assert!((ratio - 1.0).abs() < 0.1, "{:?} {law:?}", body.beams.micro);
        }
    }
}
