//! When a bond breaks: criteria, each in its file, behind one interface.
//!
//! Every criterion is a *ratio* of what a bond or a particle bears to what it can bear, homogeneous of degree one: a
//! load twice as large has twice the ratio, so that a linear solution tells the load of the first break. A criterion of
//! stress looks at the virial stress of a particle and its neighbours, one of beams at the bond itself.

mod at_walls;
mod batch;
mod beam_rankine;
mod drucker_prager;
mod hydrostatic;
mod kind;
mod mohr_coulomb;
mod principal;

pub(super) use at_walls::{AtWalls, MOST};
pub use batch::FailureSite;
pub(super) use batch::{LoadBatch, Neighbourhoods, SeenBonds, StressBatch, weakness_of};
pub use beam_rankine::BeamRankine;
pub use drucker_prager::DruckerPrager;
pub use hydrostatic::Hydrostatic;
pub use kind::{BondCriterionKind, CriterionNumbers, CriterionParameter, NamedCriterion};
pub use mohr_coulomb::MohrCoulomb;
pub use principal::Principal;

use fractum_math::{Sym3, Vec3};
use serde::{Deserialize, Serialize};

use crate::DemError;
use crate::bond::LoadSizes;

/// What a bond bears.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BondLoad {
    /// Axial force [N], positive in tension.
    pub normal: f64,
    /// Bending moments at the two ends, perpendicular to the bond, as they act on the particles' side [N m].
    pub bending: [Vec3; 2],
    /// Torsional moment [N m].
    pub torsion: f64,
    /// Radius of its section [m].
    pub radius: f64,
}

impl BondLoad {
    /// Without directions.
    fn sizes(&self) -> LoadSizes {
        let [first, second] = self.bending;
        LoadSizes {
            normal: self.normal,
            mean_bending: 0.5 * (first - second).norm(),
            largest_bending: first.norm_squared().max(second.norm_squared()).sqrt(),
            torsion: self.torsion,
            radius: self.radius,
        }
    }
}

/// How a bond broke.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum BreakMode {
    /// Pulled apart.
    Tension,
    /// Crushed.
    Compression,
    /// Sheared off, under compression or by friction-like criteria.
    Shear,
    /// Bent.
    Bending,
    /// Twisted.
    Torsion,
}

impl BreakMode {
    /// All modes, in the order of their codes in result files.
    pub const ALL: [BreakMode; 5] =
        [BreakMode::Tension, BreakMode::Compression, BreakMode::Shear, BreakMode::Bending, BreakMode::Torsion];

    /// The word for it.
    pub fn word(self) -> &'static str {
        match self {
            BreakMode::Tension => "tension",
            BreakMode::Compression => "compression",
            BreakMode::Shear => "shear",
            BreakMode::Bending => "bending",
            BreakMode::Torsion => "torsion",
        }
    }
}

/// Over which particles the stress of a particle is taken. Particles count only while bonds lead to them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Level {
    /// The particle alone.
    Own,
    /// The particle and those bonded to it.
    #[default]
    Neighbours,
    /// Their partners too.
    Second,
}

impl Level {
    /// Level 0, 1 or 2.
    pub fn from_number(level: u8) -> Option<Self> {
        [Level::Own, Level::Neighbours, Level::Second].get(level as usize).copied()
    }
}

/// Which bending moment of a beam the criterion takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum EndMoments {
    /// The mean along the beam, which is the moment at its middle: ½ |M₁ − M₂| of the moments M₁ and M₂ on the two ends.
    /// Uniform bending, in which these are opposite, counts in full; ends that shift across each other do not count.
    #[default]
    Mean,
    /// The largest in the beam: max(|M₁|, |M₂|).
    Largest,
}

/// Which bonds of an overloaded particle go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Release {
    /// All of them.
    All(BreakMode),
    /// The one nearest to one of these directions (unit vectors; both senses).
    Nearest([Vec3; 2], BreakMode),
}

/// The strengths of a criterion.
pub trait Strengths {
    /// Refuses impossible numbers.
    ///
    /// # Errors
    /// [`DemError::BadCriterion`].
    fn check(&self) -> Result<(), DemError>;

    /// Multiplies all strengths.
    fn scale(&mut self, factor: f64);
}

/// A criterion on the stress of a particle. It sees one tensor, never the body.
pub trait StressCriterion: Sync {
    /// Over which particles stress is taken.
    fn level(&self) -> Level;

    /// Whether stress is taken over the volume of the spheres alone, without the voids between them.
    fn without_voids(&self) -> bool {
        false
    }

    /// Largest value that [`StressCriterion::ratio`] can have for this stress, cheaply: without eigenvalues.
    fn bound(&self, stress: &Sym3) -> f64;

    /// Largest value that [`StressCriterion::ratio`] can have for any stress with principal values from −`compression` to
    /// `tension`, neither below zero.
    fn bound_between(&self, tension: f64, compression: f64) -> f64;

    /// Stress over strength: one where the particle fails, proportional to the stress.
    fn ratio(&self, stress: &Sym3) -> f64;

    /// What breaks.
    fn release(&self, stress: &Sym3) -> Release;
}

/// A criterion on what a single bond bears; the bond itself breaks.
pub trait LoadCriterion: Sync {
    /// Load over strength: one where the bond fails, proportional to the load; not negative.
    fn ratio(&self, load: &BondLoad) -> f64 {
        self.ratio_of(&load.sizes())
    }

    /// [`LoadCriterion::ratio`] without directions.
    fn ratio_of(&self, load: &LoadSizes) -> f64;

    /// How a bond breaks under this load.
    fn mode(&self, load: &BondLoad) -> BreakMode;
}

/// What a criterion is applied to, as the search sees it.
pub(super) enum Rule<'a> {
    /// To bonds.
    Load(&'a dyn LoadBatch),
    /// To particles.
    Stress(&'a dyn StressBatch),
}

/// The enum of all criteria, with the only matches over it: a new criterion is its file and a line here.
macro_rules! criteria {
    ($($(#[$doc:meta])* $name:ident: $rule:ident,)*) => {
        /// When bonds break.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "kind", rename_all = "kebab-case")]
        pub enum FractureCriterion {
            $($(#[$doc])* $name($name),)*
        }

        impl FractureCriterion {
            /// Every kind of criterion, by the names that users give.
            pub const KINDS: &'static [BondCriterionKind] = &[$(BondCriterionKind {
                name: $name::NAME,
                words: $name::WORDS,
                takes: $name::TAKES,
                slips: $name::SLIPS,
                make: |numbers| FractureCriterion::$name($name::from_numbers(numbers)),
            },)*];

            /// Its numbers.
            pub fn numbers(&self) -> CriterionNumbers {
                match self {
                    $(FractureCriterion::$name(c) => c.numbers(),)*
                }
            }

            fn name(&self) -> &'static str {
                match self {
                    $(FractureCriterion::$name(_) => $name::NAME,)*
                }
            }

            pub(super) fn rule(&self) -> Rule<'_> {
                match self {
                    $(FractureCriterion::$name(c) => Rule::$rule(c),)*
                }
            }

            fn strengths(&self) -> &dyn Strengths {
                match self {
                    $(FractureCriterion::$name(c) => c,)*
                }
            }

            fn strengths_mut(&mut self) -> &mut dyn Strengths {
                match self {
                    $(FractureCriterion::$name(c) => c,)*
                }
            }
        }
    };
}

criteria! {
    /// Largest principal stress in the beam itself.
    BeamRankine: Load,
    /// Mean stress of a particle; all its bonds go.
    Hydrostatic: Stress,
    /// Principal stress of a neighbourhood; one bond goes.
    Principal: Stress,
    /// Mohr–Coulomb with tension cut-off on the stress of a neighbourhood.
    MohrCoulomb: Stress,
    /// Drucker–Prager on the stress of a neighbourhood.
    DruckerPrager: Stress,
}

impl FractureCriterion {
    /// Refuses strengths that are not positive.
    ///
    /// # Errors
    /// [`DemError::BadCriterion`].
    pub fn check(&self) -> Result<(), DemError> {
        self.strengths().check()
    }

    /// Which kind it is.
    pub fn kind(&self) -> &'static BondCriterionKind {
        let own = |kind: &&BondCriterionKind| kind.name == self.name();
        Self::KINDS.iter().find(own).unwrap_or(&Self::KINDS[0])
    }

    /// The same criterion with all its strengths multiplied.
    pub fn scaled(mut self, factor: f64) -> Self {
        self.strengths_mut().scale(factor);
        self
    }

    /// The same criterion with another strength in compression [Pa], where it has one.
    pub fn with_compressive_strength(self, strength: f64) -> Self {
        let numbers = self.numbers();
        let compressive_strength = numbers.compressive_strength.map(|_| strength);
        (self.kind().make)(&CriterionNumbers { compressive_strength, ..numbers })
    }

    /// The same criterion with another share of a compression that chains of particles turn into tension across it.
    pub fn with_chains(self, chains: f64) -> Self {
        (self.kind().make)(&CriterionNumbers { chains, ..self.numbers() })
    }

    /// Over which particles stress is taken; none for a criterion of single bonds.
    pub fn level(&self) -> Option<Level> {
        match self.rule() {
            Rule::Load(_) => None,
            Rule::Stress(c) => Some(c.level()),
        }
    }
}

/// Refuses a strength that is not positive.
fn positive(what: &'static str, value: f64) -> Result<(), DemError> {
    let fine = value.is_finite() && value > 0.0;
    if fine { Ok(()) } else { Err(DemError::BadCriterion { what, value, expected: "a positive number" }) }
}

/// Upper bound of the first principal value, from invariants.
#[inline]
fn first_bound(stress: &Sym3) -> f64 {
    stress.trace() / 3.0 + 2.0 * (stress.j2() / 3.0).sqrt()
}

/// Lower bound of the last principal value, from invariants.
#[inline]
fn last_bound(stress: &Sym3) -> f64 {
    stress.trace() / 3.0 - 2.0 * (stress.j2() / 3.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A criterion with its strengths in uniaxial tension and compression; none where it has no such strength.
    type Row = (Box<dyn StressCriterion>, [Option<f64>; 2]);

    fn criteria() -> Vec<Row> {
        let level = Level::Neighbours;
        let crushing = Principal { tensile_strength: 2.0, compressive_strength: Some(15.0), level };
        vec![
            (Box::new(Hydrostatic { strength: 2.0 }), [Some(6.0), None]),
            (Box::new(Principal { compressive_strength: None, ..crushing }), [Some(2.0), None]),
            (Box::new(crushing), [Some(2.0), Some(15.0)]),
            (
                Box::new(MohrCoulomb {
                    tensile_strength: 2.0,
                    compressive_strength: 15.0,
                    friction_angle: 0.6,
                    chains: 0.2,
                    level,
                }),
                [Some(2.0), Some(15.0)],
            ),
            (
                Box::new(DruckerPrager { tensile_strength: 2.0, compressive_strength: 15.0, level }),
                [Some(2.0), Some(15.0)],
            ),
        ]
    }

    proptest! {
        #[test]
        fn bounds_hold_and_ratios_grow_with_the_stress(c in prop::array::uniform6(-9.0f64..9.0), factor in 0.1f64..7.0) {
            let stress = Sym3(c);
            for (criterion, _) in criteria() {
                let ratio = criterion.ratio(&stress);
                prop_assert!(ratio >= 0.0);
                prop_assert!(criterion.bound(&stress) >= ratio * (1.0 - 1e-9) - 1e-9);
                prop_assert!((criterion.ratio(&(stress * factor)) - factor * ratio).abs() < 1e-6 * (1.0 + factor * ratio));
            }
        }

        #[test]
        fn no_stress_within_a_range_exceeds_its_bound(c in prop::array::uniform6(-9.0f64..9.0)) {
            let stress = Sym3(c);
            let [first, _, last] = stress.principal_values();
            for (criterion, _) in criteria() {
                let bound = criterion.bound_between(first.max(0.0), (-last).max(0.0));
                prop_assert!(bound >= criterion.ratio(&stress) * (1.0 - 1e-9) - 1e-9);
            }
        }

        #[test]
        fn ratios_do_not_depend_on_the_axes(c in prop::array::uniform6(-9.0f64..9.0), r in prop::array::uniform3(-3.0f64..3.0)) {
            let q = fractum_math::Rotation::from_scaled_axis(Vec3::from(r)).to_rotation_matrix().into_inner();
            let turned = Sym3::symmetric_part(&(q * Sym3(c).to_matrix() * q.transpose()));
            for (criterion, _) in criteria() {
                prop_assert!((criterion.ratio(&turned) - criterion.ratio(&Sym3(c))).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn uniaxial_strengths_are_the_given_ones() {
        let along = |s: f64| Sym3::new(s, 0.0, 0.0, 0.0, 0.0, 0.0);
        for (criterion, strengths) in criteria() {
            for (strength, sign) in strengths.into_iter().zip([1.0, -1.0]) {
                match strength {
                    Some(strength) => assert!((criterion.ratio(&along(sign * strength)) - 1.0).abs() < 1e-9),
                    None => assert!(criterion.ratio(&along(sign * 15.0)) < 1e-12),
                }
            }
        }
    }

    #[test]
    fn strengths_that_are_none_are_refused() {
        let level = Level::Own;
        let bad = FractureCriterion::Principal(Principal { tensile_strength: -1.0, compressive_strength: None, level });
        assert!(matches!(bad.check(), Err(DemError::BadCriterion { .. })));
        let steep =
            MohrCoulomb { tensile_strength: 1.0, compressive_strength: 9.0, friction_angle: 2.0, chains: 0.2, level };
        assert!(FractureCriterion::MohrCoulomb(steep).check().is_err());
        assert!(FractureCriterion::Hydrostatic(Hydrostatic { strength: f64::NAN }).check().is_err());
    }
}
