//! Properties of the elasticity of bedded rock.

use fractum_kernels::material::{Bedding, Elastic, Hooke, Plane, Stiffness};
use fractum_kernels::{Mat3, Sym3, Vec3};
use nalgebra::{Matrix3, Matrix6};

use super::draw::{Draw, Held, hold};

/// Beds of any direction and any constants that store energy, with the elasticity within them, and how far they are from storing none.
fn beds(draw: &mut Draw) -> (Elastic, Bedding, f64) {
    let (young, nu) = (draw.over_decades(1e6, 1e12), draw.between(-0.9, 0.49));
    let elastic = Elastic { density: draw.between(500.0, 20e3), young_modulus: young, poisson_ratio: nu };
    let young_modulus = young * draw.over_decades(0.01, 100.0);
    let share = draw.between(-0.99, 0.99);
    let bedding = Bedding {
        normal: draw.vector().normalize(),
        young_modulus,
        poisson_ratio: share * Bedding::poisson_limit(&elastic, young_modulus),
        shear_modulus: young.min(young_modulus) * draw.over_decades(0.01, 10.0),
    };
    (elastic, bedding, (1.0 - share * share) * (0.5 - nu).min(1.0 + nu))
}

/// Strain in the plane only where a body is plane.
fn strain(draw: &mut Draw, plane: Option<Plane>) -> Sym3 {
    let [xx, yy, zz, xy, yz, zx] = std::array::from_fn(|_| draw.between(-1e-3, 1e-3));
    if plane.is_some() { Sym3([xx, yy, 0.0, xy, 0.0, 0.0]) } else { Sym3([xx, yy, zz, xy, yz, zx]) }
}

fn turned(turn: &Mat3, tensor: Sym3) -> Sym3 {
    Sym3::symmetric_part(&(turn * tensor.to_matrix() * turn.transpose()))
}

/// Energy is positive and symmetric; turned axes change nothing; a pull has the modulus of its angle to the beds; waves have positive moduli and go
/// no faster than those that were sought; beds that differ in nothing are Hooke's law.
pub(crate) fn bedding(draw: &mut Draw, plane: Option<Plane>) -> Held {
    let (elastic, bedding, margin) = beds(draw);
    let law = Stiffness::new(&elastic, &bedding, plane);
    let words = format!("{plane:?}, {elastic:?}, {bedding:?}");
    let largest = law.rows().iter().flatten().fold(0.0_f64, |most, c| most.max(c.abs()));
    let moduli = [elastic.young_modulus, bedding.young_modulus, bedding.shear_modulus];
    // Constants of any size, and close to the limits the terms cancel.
    let spread = largest / moduli.into_iter().fold(f64::INFINITY, f64::min);
    let (one, two) = (strain(draw, plane), strain(draw, plane));
    let scale = largest * (one.dot(one) * two.dot(two)).sqrt();
    let both = [law.stress(one).dot(two), law.stress(two).dot(one)];
    hold((both[0] - both[1]).abs() < 1e-12 * scale, || format!("{words}: not symmetric, {both:?}"))?;
    let stored = law.stress(one).dot(one);
    hold(stored > 0.0, || format!("{words}: stores {stored}"))?;

    let turn = if plane.is_some() { draw.turn_in_plane() } else { draw.turn() };
    let of_turned = Stiffness::new(&elastic, &Bedding { normal: turn * bedding.normal, ..bedding }, plane);
    let off = turned(&turn, law.stress(one)) - of_turned.stress(turned(&turn, one));
    let rounding = 1e-13 * spread.max(1.0) * largest;
    hold(off.dot(off).sqrt() < rounding * one.dot(one).sqrt(), || format!("{words}: turned axes change {off:?}"))?;

    pull(draw, plane, (&elastic, &bedding, &law), spread / margin)?;

    let direction = if plane.is_some() {
        Vec3::new(draw.between(-1.0, 1.0), draw.between(-1.0, 1.0), 0.0).normalize()
    } else {
        draw.vector().normalize()
    };
    let of_waves = law.of_waves(direction);
    let moduli = of_waves.eigen().0;
    let motions = if plane.is_some() { 2 } else { 3 };
    hold(moduli[motions - 1] > 0.0, || format!("{words}: waves of {moduli:?}"))?;
    let sum = direction.dot(&(law.sum_over_waves().to_matrix() * direction));
    hold((sum / of_waves.trace() - 1.0).abs() < 1e-12, || format!("{words}: waves of {moduli:?} have the sum {sum}"))?;
    let normal = bedding.normal;
    let spanned = match plane {
        None => [normal, normal.cross(&Vec3::ith(normal.iamin(), 1.0)).normalize()],
        Some(_) => [Vec3::x(), Vec3::y()],
    };
    let [fastest, slowest] = law.extreme_moduli(spanned, plane.is_some());
    let within = moduli[0] <= fastest + 1e-3 * largest && moduli[motions - 1] >= slowest - 1e-3 * largest;
    hold(within, || format!("{words}: {moduli:?} beyond {fastest} and {slowest}"))?;

    let (young_modulus, poisson_ratio) = (elastic.young_modulus, elastic.poisson_ratio);
    let shear_modulus = Bedding::estimated_shear_modulus(&elastic, young_modulus, poisson_ratio);
    let none = Bedding { young_modulus, poisson_ratio, shear_modulus, ..bedding };
    let (hooke, without) = (Hooke::new(&elastic, plane), Stiffness::new(&elastic, &none, plane));
    let off = without.stress(one) - hooke.stress(one);
    let nu = poisson_ratio;
    let rounding = 1e-12 * young_modulus * one.dot(one).sqrt() / (0.5 - nu).min(1.0 + nu).powi(2);
    hold(off.dot(off).sqrt() < rounding, || format!("{words}: without beds {off:?} beside Hooke's law"))
}

/// A pull along a direction gives the closed form of Young's modulus; in plane strain that of the compliance in the plane.
fn pull(
    draw: &mut Draw,
    plane: Option<Plane>,
    (elastic, bedding, law): (&Elastic, &Bedding, &Stiffness),
    cancelled: f64,
) -> Held {
    let along = if plane.is_some() {
        let angle = draw.between(0.0, 3.0);
        Vec3::new(angle.cos(), angle.sin(), 0.0)
    } else {
        draw.vector().normalize()
    };
    let stress = Sym3::symmetric_part(&(along * along.transpose()));
    let rows = law.rows();
    let strain = if plane.is_some() {
        let axes = [0, 1, 3];
        let in_plane = Matrix3::from_fn(|i, j| rows[axes[i]][axes[j]]);
        let strain = in_plane.try_inverse().unwrap_or_default() * Vec3::from_fn(|i, _| stress.0[axes[i]]);
        Sym3([strain.x, strain.y, 0.0, 0.5 * strain.z, 0.0, 0.0])
    } else {
        let all = Matrix6::from_fn(|i, j| rows[i][j]);
        let strain = all.try_inverse().unwrap_or_default() * nalgebra::Vector6::from(stress.0);
        Sym3(std::array::from_fn(|i| if i < 3 { strain[i] } else { 0.5 * strain[i] }))
    };
    let seen = 1.0 / strain.dot(stress);
    let free = bedding.young_modulus_along(elastic, along.dot(&bedding.normal));
    let off = seen / free - 1.0;
    match plane {
        // What is held across the plane makes it stiffer.
        Some(Plane::Strain) => hold(off > -1e-11 * cancelled, || format!("{bedding:?}: {seen} held, {free} free")),
        _ => hold(off.abs() < 1e-11 * cancelled.max(1.0), || format!("{bedding:?}: {seen} of {free}, {cancelled}")),
    }
}
