//! Principal values and negative parts of symmetric tensors, four at a time.

use crate::elementary::cos_of_third;
use crate::sym3::{determinant, lode};
use crate::{Lane, Sym3, widest};

impl Sym3 {
    /// The negative part Σ min(λᵢ, 0) nᵢ ⊗ nᵢ, see [`negative_parts`].
    #[inline]
    pub fn negative_part(self) -> Self {
        negative_parts(&[self, Sym3::ZERO, Sym3::ZERO, Sym3::ZERO])[0]
    }
}

widest! {
    /// The negative parts Σ min(λᵢ, 0) nᵢ ⊗ nᵢ of four tensors.
    ///
    /// How many principal values are negative follows from the signs of the three invariants; only the value that stands alone on its
    /// side of zero is found, with its direction. Where that is uncertain, beside a value close by, both are close to zero: the
    /// error stays about 1e-8 of the norm.
    pub fn negative_parts(tensors: &[Sym3; 4]) -> [Sym3; 4] = negative_parts_by_lanes;
}

#[inline(always)]
fn negative_parts_by_lanes(tensors: &[Sym3; 4]) -> [Sym3; 4] {
    let full = by_component(tensors);
    let [xx, yy, zz, xy, yz, zx] = full;
    let trace = xx + yy + zz;
    let minors = (xx * yy - xy * xy) + (yy * zz - yz * yz) + (zz * xx - zx * zx);
    let determinant = determinant(full);
    // None, all, one alone; else two.
    let of = |test: fn(f64, f64, f64) -> bool| -> [bool; 4] {
        core::array::from_fn(|k| test(trace.0[k], minors.0[k], determinant.0[k]))
    };
    let none = of(|trace, minors, determinant| trace >= 0.0 && minors >= 0.0 && determinant >= 0.0);
    let all = of(|trace, minors, determinant| trace <= 0.0 && minors >= 0.0 && determinant <= 0.0);
    let one = of(|_, _, determinant| determinant <= 0.0);

    let (plus, minus) = (Lane::splat(1.0), Lane::splat(-1.0));
    let side = Lane::choose(one, minus, plus);
    let value = outer_value(lode(full), side);
    let projector = projectors([xx - value, yy - value, zz - value, xy, yz, zx]);
    // One negative value λ₃ gives λ₃ n ⊗ n, two of them A − λ₁ n ⊗ n.
    let beyond = Lane(core::array::from_fn(|k| if one[k] { value.0[k].min(0.0) } else { value.0[k].max(0.0) }));
    let definite: [bool; 4] = core::array::from_fn(|k| none[k] || all[k]);
    let weight = Lane::choose(definite, Lane::ZERO, Lane::ZERO - beyond * side);
    let kept = Lane::choose(all, plus, Lane::choose(none, Lane::ZERO, Lane::choose(one, Lane::ZERO, plus)));
    let part: [Lane; 6] = core::array::from_fn(|c| full[c] * kept + projector[c] * weight);
    core::array::from_fn(|k| Sym3(part.map(|component| component.0[k])))
}

/// The same component of all four tensors side by side.
#[inline(always)]
pub fn by_component(tensors: &[Sym3; 4]) -> [Lane; 6] {
    core::array::from_fn(|c| Lane(core::array::from_fn(|k| tensors[k].0[c])))
}

/// The first principal value where `side` is 1, the last where it is −1, with the bits of [`Sym3::principal_values`].
#[inline(always)]
fn outer_value([mean, radius, cos3]: [Lane; 3], side: Lane) -> Lane {
    mean + side * (radius * cos_of_third(side * cos3))
}

/// n ⊗ n of the single principal value 0: the adjugate over its trace; zero beside a value so close that rounding leaves no direction.
#[inline(always)]
fn projectors([a, b, c, xy, yz, zx]: [Lane; 6]) -> [Lane; 6] {
    let adjugate =
        [b * c - yz * yz, c * a - zx * zx, a * b - xy * xy, yz * zx - xy * c, zx * xy - yz * a, xy * yz - zx * b];
    let [xx, yy, zz, xy, yz, zx] = adjugate;
    let trace = xx + yy + zz;
    let square = xx * xx + yy * yy + zz * zz + Lane::splat(2.0) * (xy * xy + yz * yz + zx * zx);
    let single = core::array::from_fn(|k| trace.0[k] > 0.0 && square.0[k] < 2.0 * trace.0[k] * trace.0[k]);
    let inverse = Lane::choose(single, Lane::splat(1.0) / trace, Lane::ZERO);
    adjugate.map(|component| component * inverse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mat3, Vec3};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn negative_part_agrees_with_jacobi(
            c in prop::array::uniform6(-1e3f64..1e3), turn in prop::array::uniform3(-3.0f64..3.0),
            values in prop::array::uniform3(prop::sample::select(vec![-1.0, -1e-3, -1e-9, 0.0, 1e-9, 1e-3, 1.0])),
        ) {
            let q = nalgebra::Rotation3::new(Vec3::from(turn)).into_inner();
            let close = Sym3::symmetric_part(&(q * Mat3::from_diagonal(&Vec3::from(values)) * q.transpose()));
            let in_plane = Sym3([c[0], c[1], 0.0, c[3], 0.0, 0.0]);
            let along_axes = Sym3([values[0], values[1], values[2], 0.0, 0.0, 0.0]);
            for tensor in [Sym3(c), close, in_plane, along_axes] {
                let (values, q) = tensor.eigen();
                let negative = Mat3::from_diagonal(&Vec3::from(values.map(|value| value.min(0.0))));
                let off = tensor.negative_part().to_matrix() - q * negative * q.transpose();
                prop_assert!(off.norm() <= 1e-7 * tensor.to_matrix().norm(), "{:e}", off.norm());
            }
        }

        #[test]
        fn four_tensors_do_not_mix_and_any_processor_gives_the_same_bits(c in prop::array::uniform24(-1f64..1.0)) {
            let tensors: [Sym3; 4] = core::array::from_fn(|k| Sym3(core::array::from_fn(|i| c[6 * k + i])));
            let bits = |parts: [Sym3; 4]| parts.map(|part| part.0.map(f64::to_bits));
            let together = bits(negative_parts(&tensors));
            prop_assert_eq!(together, bits(negative_parts_by_lanes(&tensors)));
            prop_assert_eq!(together, bits(tensors.map(Sym3::negative_part)));
            let values = tensors.map(Sym3::principal_values);
            let outer = |side: f64| outer_value(lode(by_component(&tensors)), Lane::splat(side)).0;
            prop_assert_eq!([outer(1.0), outer(-1.0)], [values.map(|values| values[0]), values.map(|values| values[2])]);
        }
    }

    #[test]
    fn zero_and_isotropic_tensors_are_their_negative_part_or_have_none() {
        assert_eq!(outer_value(lode([Lane::ZERO; 6]), Lane::splat(1.0)).0, [0.0; 4]);
        assert_eq!([Sym3::ZERO, Sym3::isotropic(2.0)].map(Sym3::negative_part), [Sym3::ZERO; 2]);
        assert_eq!(Sym3::isotropic(-2.0).negative_part(), Sym3::isotropic(-2.0));
    }
}
