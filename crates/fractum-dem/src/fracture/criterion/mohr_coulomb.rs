use fractum_math::elementary::{cos, sin};
use fractum_math::{Sym3, Vec3};
use serde::{Deserialize, Serialize};

use super::{
    BreakMode, CriterionNumbers, CriterionParameter, Level, NamedCriterion, Release, Strengths, StressCriterion,
    first_bound, last_bound, positive,
};
use crate::DemError;

/// Mohr–Coulomb with tension cut-off on the virial stress: max(min(σ₁, (σ₁ + b σ₃)/(1 − K b))/f_t, (N σ₁ − σ₃)/f_c) with
/// N = (1 + sin φ)/(1 − sin φ), K = min(4, 0.95/b), tension positive.
///
/// The cut-off is f_t as long as no compression exceeds K f_t (it is 3 f_t in the middle of a Brazilian disc), and grows with it beyond:
/// where a body is compressed along one axis, chains of particles bear the load, and between them neighbourhoods are pulled apart
/// by a share of it, where a continuum bears nothing across. With f_t alone these chains split, and no body of spheres bears more
/// than some eight times its tensile strength, whatever its strength in shear. The share b follows from the bonds: it is larger the
/// fewer they are and the higher Poisson's ratio is. From 1/3 on the middle of a disc is spared too.
///
/// In tension the bond nearest to the first principal direction breaks; in shear the one nearest to a normal of the two
/// planes on which shear slips, at 45° − φ/2 from the first principal direction towards the third.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MohrCoulomb {
    /// Tensile strength f_t [Pa].
    pub tensile_strength: f64,
    /// Uniaxial compressive strength f_c, a positive number [Pa].
    pub compressive_strength: f64,
    /// Friction angle φ [rad].
    pub friction_angle: f64,
    /// Share b of a compression that chains of particles turn into tension across it.
    pub chains: f64,
    /// Over which particles stress is taken.
    #[serde(default)]
    pub level: Level,
}

/// Compression over tensile strength up to which the tension cut-off never depends on it: three in the middle of a disc that splits.
const COMPRESSED: f64 = 4.0;
/// The most of the tensile strength that chains may have at the compression from which on the cut-off grows.
const MOST: f64 = 0.95;

impl MohrCoulomb {
    #[inline]
    fn tension(&self, first: f64, last: f64) -> f64 {
        let left = 1.0 - (COMPRESSED * self.chains).min(MOST);
        first.min((first + self.chains * last) / left) / self.tensile_strength
    }

    #[inline]
    fn shear(&self, first: f64, last: f64) -> f64 {
        let sine = sin(self.friction_angle);
        ((1.0 + sine) / (1.0 - sine) * first - last) / self.compressive_strength
    }
}

/// A number from zero to below a limit.
fn below(what: &'static str, value: f64, limit: f64, expected: &'static str) -> Result<(), DemError> {
    if (0.0..limit).contains(&value) { Ok(()) } else { Err(DemError::BadCriterion { what, value, expected }) }
}

impl NamedCriterion for MohrCoulomb {
    const NAME: &'static str = "mohr-coulomb";
    const WORDS: &'static str = "Mohr-Coulomb on the virial stress";
    const SLIPS: bool = true;
    const TAKES: &'static [CriterionParameter] =
        &[CriterionParameter::CompressiveStrength, CriterionParameter::FrictionAngle, CriterionParameter::Level];

    fn from_numbers(numbers: &CriterionNumbers) -> Self {
        let &CriterionNumbers { tensile_strength, friction_angle, chains, level, .. } = numbers;
        let compressive_strength = numbers.compressive_or_usual();
        MohrCoulomb { tensile_strength, compressive_strength, friction_angle, chains, level }
    }

    fn numbers(&self) -> CriterionNumbers {
        let &MohrCoulomb { friction_angle, chains, level, .. } = self;
        let (compressive_strength, alone) =
            (Some(self.compressive_strength), CriterionNumbers::new(self.tensile_strength));
        CriterionNumbers { compressive_strength, friction_angle, chains, level, ..alone }
    }
}

impl Strengths for MohrCoulomb {
    fn check(&self) -> Result<(), DemError> {
        positive("tensile strength", self.tensile_strength)?;
        positive("compressive strength", self.compressive_strength)?;
        let (right_angle, expected) = (std::f64::consts::FRAC_PI_2, "0 to below pi/2");
        below("friction angle in radians", self.friction_angle, right_angle, expected)?;
        below("share of chains", self.chains, 1.0, "0 to below 1")
    }

    fn scale(&mut self, factor: f64) {
        self.tensile_strength *= factor;
        self.compressive_strength *= factor;
    }
}

impl StressCriterion for MohrCoulomb {
    fn level(&self) -> Level {
        self.level
    }

    #[inline]
    fn bound(&self, stress: &Sym3) -> f64 {
        let (first, last) = (first_bound(stress), last_bound(stress));
        (first / self.tensile_strength).max(self.shear(first, last)).max(0.0)
    }

    #[inline]
    fn bound_between(&self, tension: f64, compression: f64) -> f64 {
        (tension / self.tensile_strength).max(self.shear(tension, -compression))
    }

    #[inline]
    fn ratio(&self, stress: &Sym3) -> f64 {
        let [first, _, last] = stress.principal_values();
        self.tension(first, last).max(self.shear(first, last)).max(0.0)
    }

    fn release(&self, stress: &Sym3) -> Release {
        let ([first, _, last], axes) = stress.eigen();
        let (along, across): (Vec3, Vec3) = (axes.column(0).into_owned(), axes.column(2).into_owned());
        if self.tension(first, last) >= self.shear(first, last) {
            return Release::Nearest([along; 2], BreakMode::Tension);
        }
        let angle = std::f64::consts::FRAC_PI_4 - 0.5 * self.friction_angle;
        let normal = |sign: f64| along * cos(angle) + across * (sign * sin(angle));
        Release::Nearest([normal(1.0), normal(-1.0)], BreakMode::Shear)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tension_cut_off_grows_where_compression_exceeds_four_times_the_strength() {
        let (tensile_strength, compressive_strength) = (2.0, 1e9);
        let criterion = MohrCoulomb {
            tensile_strength,
            compressive_strength,
            friction_angle: 0.6,
            chains: 0.2,
            level: Level::Neighbours,
        };
        let at_limit = |first: f64, last: f64| criterion.ratio(&Sym3::new(first, 0.5 * last, last, 0.0, 0.0, 0.0));
        for (first, last) in [(2.0, 0.0), (2.0, -6.0), (2.0, -8.0), (4.0, -18.0), (20.4, -100.0)] {
            assert!((at_limit(first, last) - 1.0).abs() < 1e-7, "{first} {last}: {}", at_limit(first, last));
            // Proportional to the stress, and never above its bound.
            assert!((at_limit(3.0 * first, 3.0 * last) - 3.0).abs() < 1e-6);
            assert!(criterion.bound(&Sym3::new(first, 0.5 * last, last, 0.0, 0.0, 0.0)) >= at_limit(first, last));
        }
        assert!(at_limit(1.0, -8.0) < 1e-7);
    }

    #[test]
    fn what_chains_pull_apart_is_spared_and_the_middle_of_a_disc_is_not() {
        for chains in [0.0, 0.2, 0.25, 0.3] {
            let criterion = MohrCoulomb {
                tensile_strength: 2.0,
                compressive_strength: 1e9,
                friction_angle: 0.6,
                chains,
                level: Level::Neighbours,
            };
            let ratio = |first: f64, last: f64| criterion.ratio(&Sym3::new(first, last, last, 0.0, 0.0, 0.0));
            assert!((ratio(2.0, 0.0) - 1.0).abs() < 1e-7 && (ratio(2.0, -6.0) - 1.0).abs() < 1e-7, "{chains}");
            if chains > 0.0 {
                assert!(ratio(0.99 * chains * 50.0, -50.0) < 1e-6, "{chains}");
            }
        }
    }

    #[test]
    fn slip_planes_make_the_angle_of_coulomb_with_the_compression() {
        let friction_angle = 0.6;
        let criterion = MohrCoulomb {
            tensile_strength: 1.0,
            compressive_strength: 10.0,
            friction_angle,
            chains: 0.2,
            level: Level::Neighbours,
        };
        let Release::Nearest(normals, BreakMode::Shear) = criterion.release(&Sym3::new(0.0, 0.1, -20.0, 0.0, 0.0, 0.0))
        else {
            panic!("compression does not slip");
        };
        // The normal of the slip plane lies at 45° + φ/2 from the compression.
        for n in normals {
            let angle = n.z.abs().acos();
            assert!((angle - std::f64::consts::FRAC_PI_4 - 0.5 * friction_angle).abs() < 1e-9, "{angle}");
        }
    }
}
