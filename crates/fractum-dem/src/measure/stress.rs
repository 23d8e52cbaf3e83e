//! Stress of particles and bodies from the forces of their bonds.

use fractum_math::{Sym3, Vec3};

/// Sums, for each particle, of half its bonds' dyads sym(r_ij ⊗ f_ij) [N m], with r_ij from the particle to its
/// neighbour and f_ij the force on the particle (positive in tension).
///
/// - `bonds`: calls back `(i, j, r_ij, force on i)` once per bond
///
/// Dividing by a volume Ω = ΣV/f_v gives the virial stress: Nguyen et al. (2019), eq. (5), with f_v the volume
/// fraction of the interior.
pub fn particle_virials(count: usize, bonds: impl FnOnce(&mut dyn FnMut(usize, usize, Vec3, Vec3))) -> Vec<Sym3> {
    let mut virials = vec![Sym3::ZERO; count];
    bonds(&mut |i, j, arm, force| {
        let virial = virial(arm, force);
        virials[i] += virial;
        virials[j] += virial;
    });
    virials
}

/// Half the dyad sym(r ⊗ f) of a bond, which is the share of each of its particles [N m].
///
/// - `arm`: from the first to the second particle [m]; `force` on the first [N]
pub fn virial(arm: Vec3, force: Vec3) -> Sym3 {
    Sym3::symmetric_part(&(arm * force.transpose())) * 0.5
}

/// Mean stress [Pa] of a set of particles: their virials over ΣV/f_v.
///
/// - `volume`: sphere volumes [m³]
/// - `fraction`: interior volume fraction f_v of the packing
pub fn mean_stress(virials: &[Sym3], volume: &[f64], fraction: f64, set: impl Iterator<Item = usize>) -> Sym3 {
    let (mut sum, mut space) = (Sym3::ZERO, 0.0);
    for i in set {
        sum += virials[i];
        space += volume[i];
    }
    sum * (fraction / space)
}
