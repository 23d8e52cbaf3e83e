use serde::{Deserialize, Serialize};

use crate::elementary::{asin, cos, sin};
#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;
use crate::{Lane, Sym3, by_component, widest};

/// The equivalent stress of a criterion, scaled so that uniaxial tension σ gives q = σ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum CriterionKind {
    /// Largest principal stress, max(σ₁, 0). Rankine, *Phil. Trans. R. Soc.* 147 (1857) 9-27.
    Rankine,
    /// Mohr-Coulomb with tension cut-off, max(σ₁, (N σ₁ - σ₃) f_t/f_c), N = (1 + sin φ)/(1 - sin φ).
    /// Chen, *Plasticity in Reinforced Concrete* (1982), ch. 5.
    MohrCoulomb,
    /// Mohr-Coulomb through the tensile strength, σ₁ - σ₃/N: no cut-off, loses strength where σ₃ is compressive.
    PureMohrCoulomb,
    /// Drucker-Prager cone through the tensile and the compressive strength. Drucker and Prager, *Q. Appl. Math.* 10 (1952)
    /// 157-165.
    DruckerPrager,
    /// Mazars' equivalent strain times E, E √(Σ ⟨ε_i⟩²). Mazars, *Eng. Fract. Mech.* 25 (1986) 729-737.
    Mazars,
    /// Modified Mohr-Coulomb with independent tensile and compressive strength. Oller, doctoral thesis, Universitat
    /// Politècnica de Catalunya (1988).
    ModifiedMohrCoulomb,
}

impl CriterionKind {
    /// Whether the angle of internal friction enters.
    pub fn uses_friction_angle(self) -> bool {
        matches!(self, Self::MohrCoulomb | Self::PureMohrCoulomb | Self::ModifiedMohrCoulomb)
    }

    /// Whether the uniaxial compressive strength enters.
    pub fn uses_compressive_strength(self) -> bool {
        matches!(self, Self::MohrCoulomb | Self::DruckerPrager | Self::ModifiedMohrCoulomb)
    }

    /// The strength ratio f_c/f_t below which the criterion would fail in uniaxial tension before f_t.
    ///
    /// - `friction_angle` φ [rad]
    pub fn least_strength_ratio(self, friction_angle: f64) -> f64 {
        match self {
            // The shear plane cuts off uniaxial tension.
            Self::MohrCoulomb => (1.0 + sin(friction_angle)) / (1.0 - sin(friction_angle)),
            _ => 1.0,
        }
    }
}

/// A criterion with the constants that its evaluation needs.
///
/// Besides q itself it knows, for its cheap test, linear bounds q ≤ a p + b √J₂ with p the mean stress: an edge whose
/// bound stays below its threshold needs no eigenvalue.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Criterion {
    kind: CriterionKind,
    /// Pairs (a, b²) of the bounds max over pairs of a p + b √J₂.
    bounds: [(f64, f64); 2],
    /// The second pair says the same as the first.
    one_bound: bool,
    /// Square of the largest q of a stress with unit norm √(σ : σ).
    norm_factor: f64,
    /// Constants of the kind, see [`Criterion::new`].
    constants: [f64; 4],
}

impl Criterion {
    /// Prepares a criterion.
    ///
    /// - `friction_angle` φ [rad]; `strength_ratio` f_c/f_t; `poisson_ratio` (for Mazars' strains)
    pub fn new(kind: CriterionKind, friction_angle: f64, strength_ratio: f64, poisson_ratio: f64) -> Self {
        let sin = sin(friction_angle);
        let n = (1.0 + sin) / (1.0 - sin);
        let first = (1.0, 2.0 / 3f64.sqrt());
        let (bounds, constants) = match kind {
            CriterionKind::Rankine => ([first, first], [0.0; 4]),
            CriterionKind::MohrCoulomb => {
                let scale = 1.0 / strength_ratio;
                let shear = ((n - 1.0) * scale, ((n - 1.0) * first.1 + 2.0) * scale);
                ([first, shear], [n, scale, 0.0, 0.0])
            }
            CriterionKind::PureMohrCoulomb => {
                let inverse = 1.0 / n;
                let bound = (1.0 - inverse, (1.0 - inverse) * first.1 + 2.0 * inverse);
                ([bound, bound], [inverse, 0.0, 0.0, 0.0])
            }
            CriterionKind::DruckerPrager => {
                let r = strength_ratio;
                let cone = (3.0 * (r - 1.0) / (2.0 * r), 3f64.sqrt() * (r + 1.0) / (2.0 * r));
                ([cone, cone], [cone.0, cone.1, 0.0, 0.0])
            }
            CriterionKind::Mazars => {
                let volumetric = 3f64.sqrt() * (1.0 - 2.0 * poisson_ratio);
                let deviatoric = 2f64.sqrt() * (1.0 + poisson_ratio);
                ([(volumetric, deviatoric), (-volumetric, deviatoric)], [poisson_ratio, 0.0, 0.0, 0.0])
            }
            CriterionKind::ModifiedMohrCoulomb => {
                let alpha = strength_ratio / n;
                let (sum, difference) = (0.5 * (1.0 + alpha), 0.5 * (1.0 - alpha));
                let k1 = sum - difference * sin;
                let k2_sin = sum * sin - difference;
                let k3 = sum * sin - difference;
                // Uniaxial tension 1: p = 1/3, √J₂ = 1/√3, Lode angle -30°.
                let tension = k3 / 3.0 + (k1 * 0.75f64.sqrt() + 0.5 * k2_sin / 3f64.sqrt()) / 3f64.sqrt();
                let (k1, k2_sin, k3) = (k1 / tension, k2_sin / tension, k3 / tension);
                let bound = (k3, (k1 * k1 + k2_sin * k2_sin / 3.0).sqrt());
                ([bound, bound], [k1, k2_sin, k3, 0.0])
            }
        };
        // By Cauchy-Schwarz with σ : σ = 3 p² + 2 J₂.
        let norm_factor = bounds.map(|(a, b)| a * a / 3.0 + b * b / 2.0).into_iter().fold(0.0, f64::max);
        let one_bound = bounds[0] == bounds[1];
        Criterion { kind, bounds: bounds.map(|(a, b)| (a, b * b)), one_bound, norm_factor, constants }
    }

    /// Largest principal stress (Rankine).
    pub fn rankine() -> Self {
        Criterion::new(CriterionKind::Rankine, 0.0, 10.0, 0.0)
    }

    /// Which criterion this is.
    #[inline]
    pub fn kind(&self) -> CriterionKind {
        self.kind
    }

    /// Whether q surely stays at or below `threshold`, from invariants of the stress alone; false when in doubt.
    #[inline(always)]
    pub fn surely_below(&self, stress: Sym3, threshold: f64) -> bool {
        let [xx, yy, zz, xy, yz, zx] = stress.0;
        let square = xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + yz * yz + zx * zx);
        threshold > 0.0
            && (square * self.norm_factor <= threshold * threshold || self.below_by_j2(stress, square, threshold))
    }

    /// [`Criterion::surely_below`] at more cost and without doubt but within rounding, for a threshold > 0 of Rankine's criterion; false for others.
    ///
    /// The threshold less the stress has positive leading minors, beyond the rounding of these and the 1e-8 of the norm by which closed forms of principal
    /// values miss.
    #[inline(always)]
    pub fn is_below_by_minors(&self, stress: Sym3, threshold: f64) -> bool {
        let [xx, yy, zz, xy, yz, zx] = stress.0;
        let norm = threshold + stress.0.iter().map(|c| c.abs()).sum::<f64>();
        let least = threshold - 1e-7 * norm;
        let (a, b, c) = (least - xx, least - yy, least - zz);
        let minor = a * b - xy * xy;
        let determinant = minor * c - a * yz * yz - b * zx * zx - 2.0 * xy * yz * zx;
        let rounding = 1e-12 * norm * norm;
        self.kind == CriterionKind::Rankine && a > 0.0 && minor > rounding && determinant > rounding * norm
    }

    /// The sharper test, for stresses that are large but mostly compressive.
    #[inline]
    fn below_by_j2(&self, stress: Sym3, square: f64, threshold: f64) -> bool {
        let trace = stress.trace();
        // The slack covers the cancellation between the two terms of J₂.
        let j2 = 0.5 * square * (1.0 + 1e-14) - trace * trace / 6.0;
        let mean = trace / 3.0;
        let below = |(a, b2): (f64, f64)| {
            let room = threshold - a * mean;
            room >= 0.0 && room * room >= b2 * j2
        };
        below(self.bounds[0]) && (self.one_bound || below(self.bounds[1]))
    }

    /// Rankine's and Mohr-Coulomb's equivalent stress from the first and the last principal value.
    #[inline(always)]
    fn of_outer_values(&self, first: f64, last: f64) -> f64 {
        let [n, scale, ..] = self.constants;
        if self.kind == CriterionKind::Rankine { first } else { first.max((n * first - last) * scale) }
    }

    /// Equivalent stress q ≥ 0 [Pa] of an effective stress.
    #[inline]
    pub fn equivalent_stress(&self, stress: Sym3) -> f64 {
        let c = self.constants;
        let q = match self.kind {
            CriterionKind::Rankine => stress.first_principal_value(),
            CriterionKind::MohrCoulomb => {
                let [first, _, last] = stress.principal_values();
                self.of_outer_values(first, last)
            }
            CriterionKind::PureMohrCoulomb => {
                let s = stress.principal_values();
                s[0] - s[2] * c[0]
            }
            CriterionKind::DruckerPrager => c[0] * stress.trace() / 3.0 + c[1] * stress.j2().sqrt(),
            CriterionKind::Mazars => {
                let s = stress.principal_values();
                let strain = |i: usize| s[i] - c[0] * (s[(i + 1) % 3] + s[(i + 2) % 3]);
                (0..3).map(|i| strain(i).max(0.0).powi(2)).sum::<f64>().sqrt()
            }
            CriterionKind::ModifiedMohrCoulomb => {
                let j2 = stress.j2();
                let sin3 =
                    if j2 > 0.0 { (-1.5 * 3f64.sqrt() * stress.j3() / (j2 * j2.sqrt())).clamp(-1.0, 1.0) } else { 0.0 };
                let lode = asin(sin3) / 3.0;
                c[2] * stress.trace() / 3.0 + j2.sqrt() * (c[0] * cos(lode) - c[1] * sin(lode) / 3f64.sqrt())
            }
        };
        q.max(0.0)
    }
}

widest! {
    /// Equivalent stresses of four effective stresses, with the bits of [`Criterion::equivalent_stress`]; zero where one surely stays below its threshold.
    pub fn equivalent_stresses(criterion: &Criterion, stresses: &[Sym3; 4], threshold: &Lane) -> [f64; 4]
        = equivalent_stresses_by_lanes;
}

/// The loops are those of one stress: so the compiler makes vectors of them.
#[inline(always)]
fn equivalent_stresses_by_lanes(criterion: &Criterion, stresses: &[Sym3; 4], threshold: &Lane) -> [f64; 4] {
    let [xx, yy, zz, xy, yz, zx] = by_component(stresses);
    let of = |k: usize| Sym3([xx.0[k], yy.0[k], zz.0[k], xy.0[k], yz.0[k], zx.0[k]]);
    let (Lane(threshold), mut room) = (threshold, [0.0; 4]);
    for k in 0..4 {
        room[k] = room_below(criterion, of(k), threshold[k]);
    }
    if room[0].min(room[1]).min(room[2].min(room[3])) >= 0.0 {
        return [0.0; 4];
    }
    let mut q = [0.0; 4];
    match criterion.kind {
        CriterionKind::Rankine => {
            for (k, q) in q.iter_mut().enumerate() {
                *q = of(k).first_principal_value();
            }
        }
        CriterionKind::MohrCoulomb => {
            let (mut first, mut last) = ([0.0; 4], [0.0; 4]);
            for k in 0..4 {
                [first[k], _, last[k]] = of(k).principal_values();
            }
            q = core::array::from_fn(|k| criterion.of_outer_values(first[k], last[k]));
        }
        _ => q = stresses.map(|stress| criterion.equivalent_stress(stress)),
    }
    for k in 0..4 {
        q[k] = if q[k] > 0.0 && room[k] < 0.0 { q[k] } else { 0.0 };
    }
    q
}

/// Not negative where q surely stays at or below a threshold > 0, as by [`Criterion::surely_below`]; without branches.
#[inline(always)]
fn room_below(criterion: &Criterion, stress: Sym3, threshold: f64) -> f64 {
    let [xx, yy, zz, xy, yz, zx] = stress.0;
    let square = xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + yz * yz + zx * zx);
    let trace = xx + yy + zz;
    let j2 = 0.5 * square * (1.0 + 1e-14) - trace * trace / 6.0;
    let mean = trace / 3.0;
    let least = |a: f64, b: f64| if a < b { a } else { b };
    let mut below = f64::INFINITY;
    for (a, b2) in criterion.bounds {
        let room = threshold - a * mean;
        below = least(least(below, room), room * room - b2 * j2);
    }
    let by_norm = threshold * threshold - square * criterion.norm_factor;
    if below > by_norm { below } else { by_norm }
}

/// Every kind.
#[cfg(test)]
pub(crate) const KINDS: &[CriterionKind] = &[
    CriterionKind::Rankine,
    CriterionKind::MohrCoulomb,
    CriterionKind::PureMohrCoulomb,
    CriterionKind::DruckerPrager,
    CriterionKind::Mazars,
    CriterionKind::ModifiedMohrCoulomb,
];

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn criterion(kind: CriterionKind) -> Criterion {
        Criterion::new(kind, 35f64.to_radians(), 10.0, 0.2)
    }

    proptest! {
        #[test]
        fn cheap_bound_never_hides_a_stress_above_the_threshold(c in prop::array::uniform6(-10f64..10.0), t in 0.1f64..20.0) {
            let stress = Sym3(c);
            for &kind in KINDS {
                let criterion = criterion(kind);
                if criterion.surely_below(stress, t) {
                    prop_assert!(criterion.equivalent_stress(stress) <= t * (1.0 + 1e-7), "{:?}", kind);
                }
            }
        }

        /// Why an edge among elements that each stay below may be left alone.
        #[test]
        fn the_mean_of_stresses_that_stay_below_stays_below(
            stresses in prop::collection::vec(prop::array::uniform6(-10f64..10.0), 1..8),
            least in 1f64..30.0,
        ) {
            for &kind in KINDS {
                let criterion = criterion(kind);
                let is_below = |s: &Sym3| criterion.surely_below(*s, least) || criterion.is_below_by_minors(*s, least);
                let below: Vec<Sym3> = stresses.iter().map(|&c| Sym3(c)).filter(is_below).collect();
                let mean = below.iter().fold(Sym3::ZERO, |sum, &s| sum + s) * (1.0 / below.len().max(1) as f64);
                prop_assert!(criterion.equivalent_stress(mean) <= least * (1.0 + 1e-7), "{:?}", kind);
            }
        }

        #[test]
        fn four_stresses_have_the_bits_of_each_alone(
            c in prop::array::uniform24(-10f64..10.0),
            t in prop::array::uniform4(0.1f64..20.0),
        ) {
            let stresses: [Sym3; 4] = std::array::from_fn(|k| Sym3(std::array::from_fn(|i| c[6 * k + i])));
            for &kind in KINDS {
                let criterion = criterion(kind);
                let together = equivalent_stresses(&criterion, &stresses, &Lane(t));
                for k in 0..4 {
                    let alone = criterion.equivalent_stress(stresses[k]);
                    let stays_below = together[k] == 0.0 && alone <= t[k] * (1.0 + 1e-7);
                    prop_assert!(together[k] == alone || stays_below, "{:?}: {} {}", kind, together[k], alone);
                }
            }
        }

        /// Also beside double values, where closed forms are least exact.
        #[test]
        fn rankines_bound_is_sharp_and_hides_nothing(
            c in prop::array::uniform6(-10f64..10.0),
            turn in prop::array::uniform3(-3.0f64..3.0),
            gap in prop::sample::select(vec![1.0, 1e-3, 1e-7, 1e-9, 1e-12, 0.0]),
        ) {
            let turn = nalgebra::Rotation3::new(turn.into()).into_inner();
            let values = nalgebra::Vector3::new(c[0].abs() + 0.1, c[0].abs() + 0.1 - gap, c[1]);
            let close = Sym3::symmetric_part(&(turn * nalgebra::Matrix3::from_diagonal(&values) * turn.transpose()));
            let rankine = criterion(CriterionKind::Rankine);
            for stress in [Sym3(c), close] {
                let q = rankine.equivalent_stress(stress);
                prop_assert!(!rankine.surely_below(stress, q * (1.0 - 1e-14)));
                prop_assert!(q == 0.0 || !rankine.is_below_by_minors(stress, q * (1.0 - 1e-14)));
                let above = q + 1e-3 * stress.to_matrix().norm();
                prop_assert!(rankine.is_below_by_minors(stress, above), "{stress:?} {q}");
                let [one, none] = [q * (1.0 - 1e-14), above].map(|t| {
                    equivalent_stresses(&rankine, &[stress, Sym3::ZERO, Sym3::ZERO, stress], &Lane([t, 1.0, 1.0, t]))
                });
                prop_assert_eq!(one, [q, 0.0, 0.0, q]);
                prop_assert!(none.iter().all(|seen| *seen == 0.0 || *seen == q));
            }
        }
    }
}
