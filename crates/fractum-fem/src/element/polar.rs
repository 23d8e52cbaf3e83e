//! Polar decomposition F = R U of the deformation gradient of a cell: its rotation and its strain U - 1.
//!
//! What cells that are stretched by little need is written once, for one cell and for four side by side.

use std::ops::{Add, Mul, Sub};

use fractum_math::{Lane, Mat3, Sym3, Vec3, widest};

use crate::element::reflection::without_reflection;

/// Norm of FᵀF - 1 up to which the series of [`roots`] is exact to rounding: the first term left out is 63/256 of its fifth
/// power.
pub(crate) const NEAR: f64 = 1e-3;

/// Strain U - 1 of a displacement gradient F - 1, and R as the product M (1 + n) of a matrix and a tensor coaxial with the strain.
///
/// Cells of solids are stretched by little, however far they turn: then M is F, and U and its inverse 1 + n are the square
/// roots of FᵀF, by a short series. There is no threshold below which a cell counts as not turned, and hence no jump in energy.
#[inline(always)]
pub(crate) fn strain_and_turn(h: &Mat3) -> (Sym3, Mat3, Sym3) {
    let square = Sym3(stretch_square(&rows_of(h)));
    let f = Mat3::identity() + h;
    if square.dot(square) <= NEAR * NEAR && f.determinant() > 0.0 {
        let (strain, inverse) = roots(square.0);
        return (Sym3(strain), f, Sym3(inverse));
    }
    let (strain, rotation) = corotational_strain(h);
    (strain, rotation, Sym3::ZERO)
}

widest! {
    /// Strain U - 1 of a displacement gradient F - 1, and the rotation R.
    #[inline(never)]
    pub(crate) fn corotational_strain(h: &Mat3) -> (Sym3, Mat3) = strain_and_rotation;
}

#[inline(always)]
fn strain_and_rotation(h: &Mat3) -> (Sym3, Mat3) {
    let f = Mat3::identity() + h;
    let r = polar_rotation(&f);
    (Sym3::symmetric_part(&(r.transpose() * f - Mat3::identity())), r)
}

/// The Biot stress T of a law whose stress does not have the axes of strain, with the skew part W by which R (T + W) does the work of T on U at any
/// displacement: T + W = U S with a symmetric S, so that U W + W U = ε T - T ε.
#[inline]
pub(crate) fn conjugate(strain: Sym3, stress: Sym3) -> Mat3 {
    let (strain, stress) = (strain.to_matrix(), stress.to_matrix());
    let product = strain * stress;
    let right = axis_of(&(product - product.transpose()));
    let stretch = strain + Mat3::identity();
    let axis = (Mat3::identity() * stretch.trace() - stretch).try_inverse().map_or(Vec3::zeros(), |m| m * right);
    stress + axis.cross_matrix()
}

/// The vector w of a skew matrix, which is w × on vectors.
#[inline]
fn axis_of(skew: &Mat3) -> Vec3 {
    Vec3::new(skew.m32, skew.m13, skew.m21)
}

/// A number of one cell, or those of four.
pub(crate) trait Number: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// The same number for all.
    fn of(value: f64) -> Self;
    /// `self + a · b`, rounded once.
    fn plus_product(self, a: Self, b: Self) -> Self;
}

impl Number for f64 {
    #[inline(always)]
    fn of(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        a.mul_add(b, self)
    }
}

impl Number for Lane {
    #[inline(always)]
    fn of(value: f64) -> Self {
        Lane::splat(value)
    }

    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        Lane::plus_product(self, a, b)
    }
}

/// FᵀF - 1 = H + Hᵀ + HᵀH by the rows of H: small numbers are not taken from large ones where H is small.
#[inline(always)]
pub(crate) fn stretch_square<T: Number>(h: &[[T; 3]; 3]) -> [T; 6] {
    let of = |i: usize, j: usize| h[i][j] + h[j][i] + dot([h[0][i], h[1][i], h[2][i]], [h[0][j], h[1][j], h[2][j]]);
    [of(0, 0), of(1, 1), of(2, 2), of(0, 1), of(1, 2), of(2, 0)]
}

#[inline(always)]
fn rows_of(h: &Mat3) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| h[(i, j)]))
}

/// (1 + a)^½ - 1 and (1 + a)^-½ - 1 to the fourth power of a; by Cayley and Hamilton both are sums of 1, a and a².
#[inline(always)]
pub(crate) fn roots<T: Number>(a: [T; 6]) -> ([T; 6], [T; 6]) {
    let b = product(a, a);
    let [xx, yy, zz, xy, yz, zx] = a;
    let i1 = xx + yy + zz;
    let i2 = T::of(0.5) * (i1 * i1 - (b[0] + b[1] + b[2]));
    let i3 = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * zx) + zx * (xy * yz - yy * zx);
    let (powers, invariants) = ([a, b], [i1, i2, i3]);
    (
        power_sum(&powers, invariants, [1.0 / 2.0, -1.0 / 8.0, 1.0 / 16.0, -5.0 / 128.0]),
        power_sum(&powers, invariants, [-1.0 / 2.0, 3.0 / 8.0, -5.0 / 16.0, 35.0 / 128.0]),
    )
}

/// c₁ a + c₂ a² + c₃ a³ + c₄ a⁴ from a and a²: a³ = i1 a² - i2 a + i3, a⁴ = (i1² - i2) a² + (i3 - i1 i2) a + i1 i3.
///
/// A function and no closure, which might be compiled apart, for any processor.
#[inline(always)]
fn power_sum<T: Number>([a, b]: &[[T; 6]; 2], [i1, i2, i3]: [T; 3], coefficients: [f64; 4]) -> [T; 6] {
    let [c1, c2, c3, c4] = coefficients;
    let of_square = T::of(c2) + T::of(c3) * i1 + T::of(c4) * (i1 * i1 - i2);
    let of_a = T::of(c1) - T::of(c3) * i2 + T::of(c4) * (i3 - i1 * i2);
    let of_one = i3 * (T::of(c3) + T::of(c4) * i1);
    let none = T::of(0.0);
    let mut sum = [of_one, of_one, of_one, none, none, none];
    for i in 0..6 {
        sum[i] = sum[i].plus_product(of_a, a[i]).plus_product(of_square, b[i]);
    }
    sum
}

/// Product of two symmetric tensors that commute, which is symmetric.
#[inline(always)]
pub(crate) fn product<T: Number>(a: [T; 6], b: [T; 6]) -> [T; 6] {
    let rows = |[xx, yy, zz, xy, yz, zx]: [T; 6]| [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
    let (a, b) = (rows(a), rows(b));
    [dot(a[0], b[0]), dot(a[1], b[1]), dot(a[2], b[2]), dot(a[0], b[1]), dot(a[1], b[2]), dot(a[2], b[0])]
}

#[inline(always)]
fn dot<T: Number>(a: [T; 3], b: [T; 3]) -> T {
    (a[0] * b[0]).plus_product(a[1], b[1]).plus_product(a[2], b[2])
}

/// Rotation R of F = R U: Higham's iteration R ← ½ (R + R⁻ᵀ) until the series ends it.
///
/// Where F turns a cell inside out, Q of F = Q H is a reflection, and R comes from [`without_reflection`]. A cell that is exactly
/// flat has no rotation; the identity then keeps the linear strain.
#[inline(always)]
fn polar_rotation(f: &Mat3) -> Mat3 {
    let mut r = *f;
    for _ in 0..40 {
        let square = Sym3(stretch_square(&rows_of(&(r - Mat3::identity()))));
        if square.dot(square) <= NEAR * NEAR {
            r += r * Sym3(roots(square.0).1).to_matrix();
            break;
        }
        let Some(inverse) = r.try_inverse() else { return Mat3::identity() };
        r = (r + inverse.transpose()) * 0.5;
    }
    if !r.iter().all(|c| c.is_finite()) {
        return Mat3::identity();
    }
    if r.determinant() > 0.0 { r } else { without_reflection(&r, f) }
}

#[cfg(test)]
mod tests {
    use fractum_math::rotation_by;
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn rotation_and_stretch_are_found_to_rounding(
            turn in prop::array::uniform3(-2.0f64..2.0),
            stretch in prop::array::uniform6(-1.0f64..1.0),
            power in -9.0f64..-0.7,
        ) {
            let rotation = rotation_by(Vec3::from(turn)).to_rotation_matrix().into_inner();
            let wanted = Sym3(stretch) * 10f64.powf(power);
            let h = rotation * (Mat3::identity() + wanted.to_matrix()) - Mat3::identity();
            let (strain, m, n) = strain_and_turn(&h);
            let (same_strain, same_rotation) = corotational_strain(&h);
            for (strain, r) in [(strain, m + m * n.to_matrix()), (same_strain, same_rotation)] {
                let (error, defect) = (strain - wanted, r.transpose() * r - Mat3::identity());
                prop_assert!((r - rotation).norm() < 5e-15, "{:e}", (r - rotation).norm());
                prop_assert!(error.dot(error).sqrt() < 5e-15, "{error:?}");
                prop_assert!(defect.norm() < 5e-15, "{defect}");
            }
        }
    }

    /// Strain passes from the series to the iteration without a step that energy would feel.
    #[test]
    fn the_series_ends_without_a_jump() {
        let shape = Sym3([0.7, -0.3, 0.2, 0.4, -0.5, 0.1]);
        let at = |size: f64| {
            let f = Mat3::new(0.36, 0.48, -0.8, -0.8, 0.6, 0.0, 0.48, 0.64, 0.6)
                * (Mat3::identity() + (shape * size).to_matrix());
            strain_and_turn(&(f - Mat3::identity())).0
        };
        let edge = NEAR / (2.0 * shape.dot(shape).sqrt());
        let change = at(edge * 1.001) - at(edge * 0.999);
        let wanted = shape * (edge * 0.002);
        let error = change - wanted;
        assert!(error.dot(error).sqrt() < 2e-15, "{error:?}");
    }
}
