use serde::{Deserialize, Serialize};

use super::{BadLaw, BondLanes, BondLaw, BondStiffness, EnergyLanes, ForceLanes, Turn};
#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;
use crate::lanes::{Lanes, Vector, add, cross, dot, rotate, scale, sub};

/// The beam that makes a bond: one circular section for all bonds of a body.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BeamSection {
    /// Young's modulus of the beam E_m [Pa].
    pub young_modulus: f64,
    /// Poisson's ratio of the beam; it only sets the torsional stiffness and hardly matters (0.3 by convention).
    pub poisson_ratio: f64,
    /// Radius r = r_m R_mean [m].
    pub radius: f64,
}

impl BeamSection {
    /// A section with the conventional Poisson's ratio 0.3.
    ///
    /// # Errors
    /// [`BadLaw::Section`] unless both numbers are positive and finite.
    #[inline]
    pub fn new(young_modulus: f64, radius: f64) -> Result<Self, BadLaw> {
        let section = BeamSection { young_modulus, poisson_ratio: 0.3, radius };
        section.check()?;
        Ok(section)
    }

    /// Refuses numbers that make no beam.
    ///
    /// # Errors
    /// [`BadLaw::Section`].
    pub fn check(&self) -> Result<(), BadLaw> {
        let positive = |v: f64| v.is_finite() && v > 0.0;
        if positive(self.young_modulus)
            && positive(self.radius)
            && self.poisson_ratio > -1.0
            && self.poisson_ratio <= 0.5
        {
            Ok(())
        } else {
            let BeamSection { young_modulus, poisson_ratio, radius } = *self;
            Err(BadLaw::Section { young_modulus, poisson_ratio, radius })
        }
    }

    /// E S [N], with S = π r².
    #[inline]
    pub fn axial(&self) -> f64 {
        self.young_modulus * core::f64::consts::PI * self.radius.powi(2)
    }

    /// E I [N m²], with I = π r⁴/4.
    #[inline]
    pub fn bending(&self) -> f64 {
        self.young_modulus * core::f64::consts::PI * self.radius.powi(4) / 4.0
    }

    /// G I₀ [N m²], with I₀ = 2 I and G = E/(2(1 + ν)).
    #[inline]
    pub fn torsion(&self) -> f64 {
        self.bending() / (1.0 + self.poisson_ratio)
    }
}

/// Rotation of the second particle seen from the first.
#[inline(always)]
fn relative<const W: usize>((w1, u1): Turn<W>, (w2, u2): Turn<W>) -> Turn<W> {
    (w1 * w2 + dot(u1, u2), sub(sub(scale(u2, w1), scale(u1, w2)), cross(u1, u2)))
}

/// t × (n × m): the moment on an end with tangent t. No closure, which might be compiled apart, for any processor.
#[inline(always)]
fn end_moment<const W: usize>(n: Vector<W>, m: Vector<W>, t: Vector<W>) -> Vector<W> {
    sub(scale(n, dot(t, m)), scale(m, dot(t, n)))
}

/// A cohesive beam, whose forces are the derivative of its energy
///
/// U = ½ (E S/l₀)(l − l₀)² + (2 E I/l₀)(θ₁² + θ₁·θ₂ + θ₂²) + ½ (G I₀/l₀) τ²
///
/// with the chord direction n, the tangents tᵢ = Rᵢ n₀ that the particles carry, θᵢ = n × tᵢ (the bending rotation of
/// end i against the chord, exact to third order), and the twist τ = 2 v·n₀ of the relative rotation (s, v) = R₁⁻¹ R₂.
/// U depends on relative quantities only, so that rigid motion gives no force and momentum and angular momentum are
/// kept to round-off at any rotation. For small motion it is the 12 × 12 Euler–Bernoulli stiffness.
///
/// The beam as a bond of discrete elements: André, Iordanoff, Charles and Néauport, *Comput. Methods Appl. Mech. Eng.*
/// 213–216 (2012) 113–125; forces after Jebahi et al. (2015), 2.4.1, with the signs corrected.
impl BondLaw for BeamSection {
    /// Factor on the stiffness of the section.
    type Parameters = f64;
    type Memory = ();
    type Recent<const W: usize> = ();

    fn check(&self) -> Result<(), BadLaw> {
        BeamSection::check(self)
    }

    #[inline]
    fn parameters(&self, _: f64, _: [f64; 2], share: f64) -> f64 {
        share
    }

    #[inline(always)]
    fn forces<const W: usize>(
        &self,
        bonds: &BondLanes<W>,
        own: &[f64; W],
        _: &mut (),
        _: &mut [(); W],
    ) -> ForceLanes<W> {
        let BondLanes { gap, turns, axis, inverse, live } = *bonds;
        let stiffness = inverse * live * Lanes(*own);
        let axial = stiffness * Lanes::splat(self.axial());
        let bend = stiffness * Lanes::splat(2.0 * self.bending());
        let twist = stiffness * Lanes::splat(self.torsion());
        let [(w1, u1), (w2, u2)] = turns;
        let square = dot(gap, gap);
        let l = square.sqrt();
        let over = l.recip();
        let n = scale(gap, over);
        let (t1, t2) = (rotate(w1, u1, axis), rotate(w2, u2, axis));
        let (a, b) = (cross(n, t1), cross(n, t2));
        let sum = add(a, b);
        // Derivatives of the bending energy with respect to θ₁ and θ₂.
        let (m1, m2) = (scale(add(a, sum), bend), scale(add(b, sum), bend));
        // Twist: relative rotation seen from the first particle, v·n₀ and its derivative s n₀ + v × n₀.
        let (s, v) = relative((w1, u1), (w2, u2));
        let torque = twist * (dot(v, axis) + dot(v, axis));
        let torque = scale(rotate(w1, u1, add(scale(axis, s), cross(v, axis))), torque);
        // Shear from the moments over the length, so that angular momentum is kept exactly.
        let h = add(cross(t1, m1), cross(t2, m2));
        let h = scale(sub(h, scale(n, dot(h, n))), over);
        let rest = inverse.recip();
        let force = sub(scale(n, -(axial * (l - rest))), h);
        ForceLanes { force, moment: [add(end_moment(n, m1, t1), torque), sub(end_moment(n, m2, t2), torque)] }
    }

    #[inline(always)]
    fn energies<const W: usize>(&self, bonds: &BondLanes<W>, own: &[f64; W], _: &(), _: &[(); W]) -> EnergyLanes<W> {
        let BondLanes { gap, turns: [first, second], axis, inverse, .. } = *bonds;
        let half = inverse * Lanes::splat(0.5) * Lanes(*own);
        let l = dot(gap, gap).sqrt();
        let n = scale(gap, l.recip());
        let (a, b) = (cross(n, rotate(first.0, first.1, axis)), cross(n, rotate(second.0, second.1, axis)));
        let stretch = l - inverse.recip();
        let (_, v) = relative(first, second);
        let twist = dot(v, axis) + dot(v, axis);
        EnergyLanes {
            tension: half * Lanes::splat(self.axial()) * stretch * stretch,
            bending: half * Lanes::splat(4.0 * self.bending()) * (dot(a, a) + dot(a, b) + dot(b, b)),
            torsion: half * Lanes::splat(self.torsion()) * twist * twist,
        }
    }

    #[inline]
    fn dissipated(&self, _: f64, _: &f64, _: &()) -> f64 {
        0.0
    }

    #[inline]
    fn stiffness(&self, length: f64, share: &f64) -> BondStiffness {
        let bending = share * self.bending() / length;
        BondStiffness {
            axial: share * self.axial() / length,
            bending: 4.0 * bending,
            carry_over: 2.0 * bending,
            twist: share * self.torsion() / length,
        }
    }

    #[inline]
    fn face_stiffness(&self, rest: f64) -> [f64; 2] {
        [self.axial() / rest, 12.0 * self.bending() / rest.powi(3)]
    }

    #[inline]
    fn section_radius(&self) -> f64 {
        self.radius
    }

    #[inline]
    fn beam(&self) -> Option<BeamSection> {
        Some(*self)
    }

    #[inline]
    fn share(own: &f64) -> f64 {
        *own
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::bond::{BondForces, BondedPair};
    use crate::{Rotation, Vec3};

    fn pair_of(x: [f64; 3], r: [f64; 3], s: [f64; 3], axis: [f64; 3]) -> BondedPair {
        let axis = (Vec3::from(axis) + Vec3::new(2.5, 0.0, 0.0)).normalize();
        let place = axis * 1.3 + Vec3::from(x) * 0.3;
        let rotation = [Rotation::from_scaled_axis(Vec3::from(r)), Rotation::from_scaled_axis(Vec3::from(s))];
        BondedPair {
            position: [Vec3::new(0.3, -0.2, 0.1), Vec3::new(0.3, -0.2, 0.1) + place],
            rotation,
            axis,
            length: 1.2,
        }
    }

    const UNIT: std::ops::Range<f64> = -1.0..1.0;
    const SHARE: f64 = 1.3;

    fn section() -> BeamSection {
        BeamSection { young_modulus: 2.0, poisson_ratio: 0.3, radius: 0.6 }
    }

    proptest! {
        #[test]
        fn forces_are_the_derivative_of_the_energy(
            x in prop::array::uniform3(UNIT), r in prop::array::uniform3(UNIT), s in prop::array::uniform3(UNIT), n in prop::array::uniform3(UNIT),
        ) {
            let pair = pair_of(x, r, s, n);
            let forces = section().force(&pair, &SHARE, &mut ());
            let energy = |p: &BondedPair| section().energy(p, &SHARE, &()).total();
            let h = 1e-5;
            let size = forces.force.norm() + forces.moment[0].norm() + forces.moment[1].norm() + 1e-3;
            for axis in 0..3 {
                let mut step = Vec3::zeros();
                step[axis] = h;
                let slope = |moved: &dyn Fn(f64) -> BondedPair| (energy(&moved(1.0)) - energy(&moved(-1.0))) / (2.0 * h);
                for end in 0..2 {
                    let push = slope(&|k| { let mut p = pair; p.position[end] += step * k; p });
                    let force = if end == 1 { forces.force } else { -forces.force };
                    prop_assert!((push + force[axis]).abs() < 1e-7 * size, "force {push} {}", force[axis]);
                    let turn = slope(&|k| { let mut p = pair; p.rotation[end] = Rotation::from_scaled_axis(step * k) * p.rotation[end]; p });
                    prop_assert!((turn + forces.moment[end][axis]).abs() < 1e-7 * size, "moment {turn} {}", forces.moment[end][axis]);
                }
            }
        }

        #[test]
        fn momentum_and_angular_momentum_are_kept_to_round_off(
            x in prop::array::uniform3(UNIT), r in prop::array::uniform3(UNIT), s in prop::array::uniform3(UNIT), n in prop::array::uniform3(UNIT),
        ) {
            let pair = pair_of(x, r, s, n);
            let BondForces { force, moment } = section().force(&pair, &SHARE, &mut ());
            let arm = pair.position[1] - pair.position[0];
            let total = arm.cross(&force) + moment[0] + moment[1];
            prop_assert!(total.norm() < 1e-13 * (arm.norm() * force.norm() + moment[0].norm() + moment[1].norm()));
        }

        #[test]
        fn rigid_motion_gives_no_force_at_any_rotation(
            x in prop::array::uniform3(-9.0f64..9.0), r in prop::array::uniform3(-3.0f64..3.0), n in prop::array::uniform3(UNIT),
        ) {
            let rotation = Rotation::from_scaled_axis(Vec3::from(r));
            let axis = (Vec3::from(n) + Vec3::new(2.5, 0.0, 0.0)).normalize();
            let start = Vec3::from(x);
            let pair = BondedPair { position: [start, start + rotation * axis * 1.2], rotation: [rotation; 2], axis, length: 1.2 };
            let BondForces { force, moment } = section().force(&pair, &SHARE, &mut ());
            let stiff = section().axial() / 1.2;
            prop_assert!(force.norm() + moment[0].norm() + moment[1].norm() < 3e-14 * stiff * (1.0 + start.norm()));
        }

        #[test]
        fn rotating_everything_rotates_the_forces(
            x in prop::array::uniform3(UNIT), r in prop::array::uniform3(UNIT), s in prop::array::uniform3(UNIT), q in prop::array::uniform3(-3.0f64..3.0),
        ) {
            let pair = pair_of(x, r, s, [0.0; 3]);
            let turn = Rotation::from_scaled_axis(Vec3::from(q));
            let turned = BondedPair { position: pair.position.map(|p| turn * p), rotation: pair.rotation.map(|r| turn * r), ..pair };
            let (a, b) = (section().force(&pair, &SHARE, &mut ()), section().force(&turned, &SHARE, &mut ()));
            prop_assert!((turn * a.force - b.force).norm() < 1e-13 * (1.0 + a.force.norm()));
            prop_assert!((turn * a.moment[0] - b.moment[0]).norm() < 1e-13 * (1.0 + a.moment[0].norm()));
        }
    }
}
