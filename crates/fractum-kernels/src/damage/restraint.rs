//! What neighbours that hold a crack sideways add to the stress that it sees.

use crate::Sym3;
use crate::damage::seen::Seen;
#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;
use crate::material::{Criterion, CriterionKind, Elastic, Hooke, Plane};

/// Lateral restraint of a crack.
///
/// The elements of a crack band are held sideways by their neighbours, which stay as short as they are. The strain ε₁ that opens the
/// crack therefore brings lateral stresses with it, which raise the largest effective principal stress s₁ above E ε₁, up to
/// E (1-ν)/((1+ν)(1-2ν)) ε₁ in space. Softening is a law of the opening, so that the stress that it is computed from is
///
/// x = s₁ - ν' ⟨L - L₀⟩,  ν' = ν in space and plane stress, ν/(1-ν) in plane strain,
///
/// with the sum L of the lateral principal stresses and its value L₀ at the onset of damage: x grows by E' per strain across the crack, whatever holds it
/// sideways, with E' = E in space and plane stress, E/(1-ν²) in plane strain. Damage then is 1 - (x/s₁) f_t χ(x)/x, which leaves the stress f_t χ(x) across the crack.
///
/// A crack zigzags through the mesh: its elements open askew, so that a lateral strain falls by r per strain ε₁ since the onset, and the lateral stresses, which
/// pull, take work away. The work of a step is that of f_t χ(x) on m⁻¹ dε₁,
///
/// m = (1 - ν̂ r)/(1 - 2 ν̂ r + r²) where r < ν̂ and 1 beyond, ν̂ = ν' in the plane, ν/(1-ν) in space,
///
/// and the same strain may also be that of an element that is held in part. What exceeds f_t in x therefore counts by m^-½ (docs/theory/damage.md). The wide band of
/// a phase field opens less askew: by m^-¼ in the plane, and by x itself in space.
#[derive(Clone, Copy, Debug)]
pub struct Restraint {
    /// ν'.
    factor: f64,
    /// ν̂.
    askew: f64,
    /// Whether a phase field spreads the crack, whose elements open less askew.
    pub is_spread: bool,
    /// E' [Pa].
    pub modulus: f64,
    /// Ratio of the stress across the thickness to the sum of those in the plane; none in space.
    thickness: Option<f64>,
}

impl Restraint {
    /// The restraint in a body in space, or in a plane one.
    ///
    /// - `is_spread`: whether a phase field spreads the crack
    pub fn new(elastic: &Elastic, plane: Option<Plane>, is_spread: bool) -> Self {
        let Hooke { lambda, mu, zz } = Hooke::new(elastic, plane);
        let askew = lambda / (lambda + 2.0 * mu);
        match plane {
            None => Restraint {
                factor: elastic.poisson_ratio,
                askew,
                is_spread,
                modulus: elastic.young_modulus,
                thickness: None,
            },
            Some(_) => Restraint {
                factor: askew,
                askew,
                is_spread,
                modulus: 4.0 * mu * (lambda + mu) / (lambda + 2.0 * mu),
                thickness: Some(zz * elastic.poisson_ratio),
            },
        }
    }

    /// What an edge sees whose equivalent stress is `q` [Pa].
    ///
    /// - `[strength, kappa, at_onset]`: strength, largest equivalent stress so far, and sum of the lateral principal stresses at the onset of damage [Pa]
    #[inline(always)]
    pub fn seen(&self, criterion: &Criterion, [strength, kappa, at_onset]: [f64; 3], stress: Sym3, q: f64) -> Seen {
        if q <= kappa {
            return Seen { stress: q, ..Seen::NOTHING };
        }
        let is_rankine = criterion.kind() == CriterionKind::Rankine;
        let [xx, yy, ..] = stress.0;
        let (sum, first) = match self.thickness {
            Some(_) => (xx + yy, if is_rankine { q } else { in_plane(stress)[0] }),
            None => (stress.trace(), if is_rankine { q } else { stress.first_principal_value() }),
        };
        let lateral = sum - first;
        if at_onset == f64::INFINITY {
            return Seen { stress: q, lateral: lateral * (kappa / q), ..Seen::NOTHING };
        }
        let more = lateral - at_onset;
        if more <= 0.0 || first <= 0.0 {
            return Seen { stress: q, ..Seen::NOTHING };
        }
        let opening = first - self.factor * more;
        let stress = if is_rankine { opening } else { q.min(self.released(criterion, stress, more)) };
        let share = (opening / first).max(0.0);
        if stress <= strength {
            return Seen { stress, share, lateral: at_onset, ..Seen::NOTHING };
        }
        let obliquity = || obliquity(self.askew, self.thickness.is_some(), more / (first - strength)).sqrt();
        let divisor = match (self.is_spread, self.thickness) {
            (false, _) => obliquity(),
            (true, Some(_)) => obliquity().sqrt(),
            (true, None) => 1.0,
        };
        let counted = strength + (stress - strength) / divisor;
        Seen { stress: counted, share: share * (counted / stress), lateral: at_onset, ..Seen::NOTHING }
    }

    /// Equivalent stress without what restraint adds: principal stresses with `more` of the lateral sum and its effect on the first taken away [Pa].
    #[inline(never)]
    fn released(&self, criterion: &Criterion, stress: Sym3, more: f64) -> f64 {
        let [first, second, third] = match self.thickness {
            Some(ratio) => {
                let [first, second] = in_plane(stress);
                let (first, second) = (first - self.factor * more, second - more);
                [first, second, ratio * (first + second)]
            }
            None => {
                let [first, second, third] = stress.principal_values();
                [first - self.factor * more, second - 0.5 * more, third - 0.5 * more]
            }
        };
        criterion.equivalent_stress(Sym3([first, second, third, 0.0, 0.0, 0.0]))
    }
}

/// m.
///
/// - `askew`: ν̂; `ratio`: growth of the lateral sum since the onset over that of the largest principal stress
#[inline(always)]
pub(super) fn obliquity(askew: f64, is_plane: bool, ratio: f64) -> f64 {
    let fallen = if is_plane {
        (askew - ratio) / (1.0 - askew * ratio)
    } else {
        (2.0 * askew - ratio) / (1.0 + askew - askew * ratio)
    };
    // A band that cannot move sideways at all, and numbers beyond that, leave 1.
    let fallen = fallen.clamp(0.0, 1.0);
    ((1.0 - askew * fallen) / (1.0 - 2.0 * askew * fallen + fallen * fallen)).max(1.0)
}

/// Principal stresses in the plane, the larger first.
#[inline(always)]
pub(super) fn in_plane(stress: Sym3) -> [f64; 2] {
    let [xx, yy, _, xy, ..] = stress.0;
    let (middle, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let radius = (half * half + xy * xy).sqrt();
    [middle + radius, middle - radius]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::damage::{EdgeDamage, Softens};
    use crate::material::{DamageLaw, KINDS, Softening};

    const STRENGTH: f64 = 3e6;
    const LENGTH: f64 = 0.002;
    fn softens(plane: Option<Plane>, nu: f64, kind: CriterionKind, softening: Softening) -> (Softens, f64) {
        let criterion = Criterion::new(kind, 0.6, 10.0, nu);
        let law = DamageLaw { criterion, softening, ..DamageLaw::rankine(STRENGTH, 100.0) };
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: nu };
        let restraint = Restraint::new(&elastic, plane, false);
        (Softens::new(&law, Hooke::new(&elastic, plane), restraint), restraint.modulus)
    }

    fn see(softens: &Softens, edge: &EdgeDamage, strain: Sym3) -> (Seen, Sym3) {
        let stress = softens.hooke.stress(strain);
        (softens.see(edge, STRENGTH, stress, softens.criterion.equivalent_stress(stress)), stress)
    }

    proptest! {
        /// Every criterion sees a crack that began in uniaxial tension as the others do; but Mohr-Coulomb's without cut-off, which lateral tension spares a little.
        #[test]
        fn every_criterion_sees_the_opening_of_a_crack_in_tension(
            nu in 0.0f64..0.49, held in 0.0f64..1.0, opening in 0.0f64..20.0, in_plane in any::<bool>(),
        ) {
            for &kind in KINDS {
                // Mazars' criterion has strains in space; the others need the stress alone.
                let plane = in_plane.then_some(Plane::Stress);
                let (softens, modulus) = softens(plane, nu, kind, Softening::Exponential);
                let thick = |side: f64| if in_plane { 0.0 } else { side };
                let onset = STRENGTH / modulus;
                let mut edge = EdgeDamage::intact(STRENGTH);
                let (seen, _) = see(&softens, &edge, Sym3([1.0, -nu, thick(-nu), 0.0, 0.0, 0.0]) * (onset * (1.0 + 1e-9)));
                softens.load(&mut edge, seen, STRENGTH, LENGTH, 0.0);
                let more = opening * onset;
                let side = -nu * onset - (1.0 - held) * nu * more;
                let (seen, _) = see(&softens, &edge, Sym3([onset + more, side, thick(side), 0.0, 0.0, 0.0]));
                // What of the lateral strain has fallen counts as askew in part.
                let hooke = softens.hooke;
                let (askew, sides) = (hooke.lambda / (hooke.lambda + 2.0 * hooke.mu), if in_plane { 1.0 } else { 2.0 });
                let fallen = sides * (1.0 - held) * nu;
                let m = (1.0 - askew * fallen) / (1.0 - 2.0 * askew * fallen + fallen * fallen);
                let expected = STRENGTH * (1.0 + opening / m.max(1.0).sqrt());
                let has_cut_off = !matches!(kind, CriterionKind::PureMohrCoulomb | CriterionKind::ModifiedMohrCoulomb);
                let spared = if has_cut_off { 1e-6 } else { 0.02 };
                let ratio = seen.stress / expected;
                prop_assert!(ratio < 1.0 + 1e-6 && ratio > 1.0 - spared, "{kind:?}: {ratio}");
            }
        }

        /// Restraint never adds to what an edge sees, and takes nothing away under lateral compression.
        #[test]
        fn restraint_takes_from_the_equivalent_stress_only_what_lateral_tension_added(
            nu in 0.0f64..0.49,
            kind in 0usize..6,
            strain in prop::array::uniform6(-1e-3f64..1e-3),
            lateral in -1e7f64..1e7,
        ) {
            let (softens, _) = softens(None, nu, KINDS[kind], Softening::Linear);
            let edge = EdgeDamage { lateral, ..EdgeDamage::intact(STRENGTH) };
            let (seen, stress) = see(&softens, &edge, Sym3(strain));
            let q = softens.criterion.equivalent_stress(stress);
            prop_assert!(seen.stress <= q && (0.0..=1.0).contains(&seen.share));
            if stress.trace() - stress.first_principal_value() < lateral {
                prop_assert!(seen.stress == q && seen.share == 1.0);
            }
        }
    }
}
