use core::ops::{Add, AddAssign, Mul, Sub};

use serde::{Deserialize, Serialize};

use crate::elementary::cos_of_third;
use crate::{Mat3, Number, Vec3};

/// J₂ below which a tensor is isotropic.
const ISOTROPIC: f64 = 1e-300;

/// A symmetric tensor in Voigt order xx yy zz xy yz zx, with tensor (not engineering) shear components.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sym3(pub [f64; 6]);

impl Sym3 {
    /// The zero tensor.
    pub const ZERO: Sym3 = Sym3([0.0; 6]);

    /// A tensor from its components xx yy zz xy yz zx.
    #[inline]
    pub fn new(xx: f64, yy: f64, zz: f64, xy: f64, yz: f64, zx: f64) -> Self {
        Sym3([xx, yy, zz, xy, yz, zx])
    }

    /// `value` times the unit tensor.
    #[inline]
    pub fn isotropic(value: f64) -> Self {
        Sym3([value, value, value, 0.0, 0.0, 0.0])
    }

    /// The symmetric part of a matrix.
    #[inline(always)]
    pub fn symmetric_part(m: &Mat3) -> Self {
        Sym3([m.m11, m.m22, m.m33, 0.5 * (m.m12 + m.m21), 0.5 * (m.m23 + m.m32), 0.5 * (m.m13 + m.m31)])
    }

    /// The tensor as a full matrix.
    #[inline]
    pub fn to_matrix(self) -> Mat3 {
        let [xx, yy, zz, xy, yz, zx] = self.0;
        Mat3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz)
    }

    /// Sum of the diagonal.
    #[inline(always)]
    pub fn trace(self) -> f64 {
        self.0[0] + self.0[1] + self.0[2]
    }

    /// Double contraction `a : b`.
    #[inline]
    pub fn dot(self, other: Sym3) -> f64 {
        let (a, b) = (self.0, other.0);
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + 2.0 * (a[3] * b[3] + a[4] * b[4] + a[5] * b[5])
    }

    /// Second invariant of the deviator, J₂ = ½ s : s.
    #[inline(always)]
    pub fn j2(self) -> f64 {
        j2(self.0)
    }

    /// Third invariant of the deviator, J₃ = det s.
    #[inline(always)]
    pub fn j3(self) -> f64 {
        j3(self.0, self.trace() / 3.0)
    }

    /// Principal values in descending order, by the trigonometric solution of the characteristic equation.
    ///
    /// Near a double value the error grows to about 1e-8 of the norm; [`Sym3::eigen`] is exact to round-off.
    #[inline(always)]
    pub fn principal_values(self) -> [f64; 3] {
        let [mean, radius, cos3] = lode(self.0);
        let (first, last) = (mean + radius * cos_of_third(cos3), mean - radius * cos_of_third(-cos3));
        [first, 3.0 * mean - first - last, last]
    }

    /// The first of [`Sym3::principal_values`].
    #[inline(always)]
    pub fn first_principal_value(self) -> f64 {
        let [mean, radius, cos3] = lode(self.0);
        mean + radius * cos_of_third(cos3)
    }

    /// Principal values in descending order with their directions (columns), by cyclic Jacobi rotations.
    pub fn eigen(self) -> ([f64; 3], Mat3) {
        let mut a = self.to_matrix();
        let mut q = Mat3::identity();
        for _ in 0..30 {
            let off = a.m12.abs() + a.m13.abs() + a.m23.abs();
            if off <= 1e-300 || off <= 1e-17 * (a.m11.abs() + a.m22.abs() + a.m33.abs()) {
                break;
            }
            for (i, j) in [(0, 1), (0, 2), (1, 2)] {
                if a[(i, j)] == 0.0 {
                    continue;
                }
                let theta = (a[(j, j)] - a[(i, i)]) / (2.0 * a[(i, j)]);
                let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                let mut g = Mat3::identity();
                g[(i, i)] = c;
                g[(j, j)] = c;
                g[(i, j)] = s;
                g[(j, i)] = -s;
                a = g.transpose() * a * g;
                q *= g;
            }
        }
        let mut order = [0, 1, 2];
        for (i, j) in [(0, 1), (1, 2), (0, 1)] {
            if a[(order[j], order[j])].total_cmp(&a[(order[i], order[i])]).is_gt() {
                order.swap(i, j);
            }
        }
        let values = order.map(|i| a[(i, i)]);
        (values, Mat3::from_columns(&order.map(|i| q.column(i).into_owned())))
    }
}

/// J₂ of one tensor or of four side by side.
#[inline(always)]
fn j2<N: Number>([xx, yy, zz, xy, yz, zx]: [N; 6]) -> N {
    let (a, b, c) = (xx - yy, yy - zz, zz - xx);
    (a * a + b * b + c * c) / N::splat(6.0) + xy * xy + yz * yz + zx * zx
}

/// J₃ of tensors of this mean.
#[inline(always)]
fn j3<N: Number>([xx, yy, zz, xy, yz, zx]: [N; 6], mean: N) -> N {
    determinant([xx - mean, yy - mean, zz - mean, xy, yz, zx])
}

#[inline(always)]
pub(crate) fn determinant<N: Number>([xx, yy, zz, xy, yz, zx]: [N; 6]) -> N {
    xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * zx) + zx * (xy * yz - yy * zx)
}

/// Mean m, r = 2 √(J₂/3) and cos 3θ: the first principal value is m + r cos θ, the last m - r cos(π/3 - θ).
#[inline(always)]
pub(crate) fn lode<N: Number>(tensor: [N; 6]) -> [N; 3] {
    let [xx, yy, zz, ..] = tensor;
    let (mean, j2) = ((xx + yy + zz) / N::splat(3.0), j2(tensor));
    let radius = N::splat(2.0) * (j2 / N::splat(3.0)).sqrt();
    let cos3 = N::splat(4.0) * j3(tensor, mean) / (radius * radius * radius);
    let cos3 = cos3.map(|c| c.clamp(-1.0, 1.0));
    // Chosen at the end rather than returned before, which would keep loops over tensors from becoming vectors.
    let unless_isotropic = |value: f64, j2: f64| if j2 <= ISOTROPIC { 0.0 } else { value };
    [mean, radius.with(j2, unless_isotropic), cos3.with(j2, unless_isotropic)]
}

impl Add for Sym3 {
    type Output = Sym3;
    #[inline]
    fn add(self, other: Sym3) -> Sym3 {
        Sym3(core::array::from_fn(|i| self.0[i] + other.0[i]))
    }
}

impl AddAssign for Sym3 {
    #[inline]
    fn add_assign(&mut self, other: Sym3) {
        *self = *self + other;
    }
}

impl Sub for Sym3 {
    type Output = Sym3;
    #[inline]
    fn sub(self, other: Sym3) -> Sym3 {
        Sym3(core::array::from_fn(|i| self.0[i] - other.0[i]))
    }
}

impl Mul<f64> for Sym3 {
    type Output = Sym3;
    #[inline]
    fn mul(self, factor: f64) -> Sym3 {
        Sym3(self.0.map(|c| c * factor))
    }
}

impl Mul<Vec3> for Sym3 {
    type Output = Vec3;
    #[inline]
    fn mul(self, v: Vec3) -> Vec3 {
        let [xx, yy, zz, xy, yz, zx] = self.0;
        Vec3::new(xx * v.x + xy * v.y + zx * v.z, xy * v.x + yy * v.y + yz * v.z, zx * v.x + yz * v.y + zz * v.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn jacobi_reproduces_the_tensor(c in prop::array::uniform6(-1e3f64..1e3)) {
            let tensor = Sym3(c);
            let (values, q) = tensor.eigen();
            let back = q * Mat3::from_diagonal(&Vec3::from(values)) * q.transpose();
            prop_assert!((back - tensor.to_matrix()).norm() < 1e-11 * (1.0 + tensor.to_matrix().norm()));
            prop_assert!(values[0] >= values[1] && values[1] >= values[2]);
        }

        #[test]
        fn closed_form_agrees_with_jacobi(c in prop::array::uniform6(-1e3f64..1e3)) {
            let tensor = Sym3(c);
            let (values, _) = tensor.eigen();
            for (a, b) in tensor.principal_values().iter().zip(values) {
                prop_assert!((a - b).abs() < 1e-5 * (1.0 + tensor.to_matrix().norm()));
            }
        }

        #[test]
        fn first_principal_value_stays_below_its_invariant_bound(c in prop::array::uniform6(-1e3f64..1e3)) {
            let tensor = Sym3(c);
            let bound = tensor.trace() / 3.0 + 2.0 * (tensor.j2() / 3.0).sqrt();
            prop_assert!(tensor.eigen().0[0] <= bound + 1e-9 * (1.0 + bound.abs()));
        }
    }

    #[test]
    fn zero_and_isotropic_tensors_have_equal_principal_values() {
        assert_eq!(Sym3::ZERO.principal_values(), [0.0; 3]);
        assert_eq!(Sym3::isotropic(-4.0).principal_values(), [-4.0; 3]);
        assert_eq!(Sym3::ZERO.eigen().0, [0.0; 3]);
    }
}
