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
