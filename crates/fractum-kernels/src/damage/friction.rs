//! Friction of cracks that have closed.

use crate::Sym3;
use crate::contact::slip_to_cone;
#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;
use crate::material::Hooke;

/// What the damaged part of an edge bears: nothing while its crack is open, pressure and friction once it is closed.
///
/// A share 1 - d of an edge is whole and elastic; the share d is broken (Alfano and Sacco, *Int. J. Numer. Meth. Eng.* 68 (2006) 542-582, of interfaces).
/// The broken share is closed while its volume is smaller than without load. Its elastic strain is e = ε - ε_s with the slip ε_s, which changes no volume:
///
/// c = K ⟨tr ε⟩₋ 1 + 2 μ dev e,  ½ (c₁ - c₃) ≤ -k ½ (c₁ + c₃)
///
/// with the outer principal stresses c₁ ≥ c₃; in plane stress those in the plane. Beyond, slip takes what is too much of the deviator along its own direction.
/// It takes all of it where the crack is open: such a crack has no stress, and forgets where it slid from.
///
/// - A crack that began in tension is a band of one element that slides along itself. Strain rates there are those of simple shear, the axes of stress turn until
///   they are those of the slip, and the traction on the band is τ = k σ: Coulomb's friction with k = f, whatever the direction of the crack in the mesh. No normal is
///   kept. A band that runs zigzag through a mesh is rough, and bears more.
/// - What failed by shear under pressure is crushed rock without cohesion, whose strength is Mohr-Coulomb's: k = sin φ, tan φ = f.
#[derive(Clone, Copy, Debug)]
pub struct CrackFriction {
    /// k of cracks, and of crushed rock.
    limits: [f64; 2],
    /// K [Pa].
    bulk: f64,
    /// μ [Pa].
    shear: f64,
    /// Whether there is no stress across the thickness.
    is_flat: bool,
}

/// Largest principal stress over the equivalent stress at onset from which on damage is a crack.
const CRACKS: f64 = 0.5;

/// A step of an edge whose cracks rub.
#[derive(Clone, Copy, Debug)]
pub struct RubbingStep {
    /// Strain before the step and after it.
    pub strains: [Sym3; 2],
    /// Slip before the step.
    pub slip: Sym3,
    /// k, see [`CrackFriction::limit`].
    pub limit: f64,
    /// Damage before the step; 0 where it has just begun.
    pub damage: f64,
}

/// What a step has made of it.
#[derive(Clone, Copy, Debug)]
pub struct Rubbed {
    /// Stress of the broken share c [Pa].
    pub closed: Sym3,
    /// Slip after the step.
    pub slip: Sym3,
    /// Energy that a step takes per growth of damage [J/m³].
    pub per_damage: f64,
    /// Energy that friction takes [J/m³].
    pub taken: f64,
}

impl CrackFriction {
    /// - `coefficient`: f, 0 to below 1: from 1 on, nothing that presses would slide
    pub fn new(coefficient: f64, hooke: &Hooke) -> Self {
        let is_flat = hooke.zz == 0.0;
        let bulk = hooke.lambda + if is_flat { hooke.mu } else { 2.0 / 3.0 * hooke.mu };
        let crushed = coefficient / (1.0 + coefficient * coefficient).sqrt();
        CrackFriction { limits: [coefficient, crushed], bulk, shear: hooke.mu, is_flat }
    }

    /// k of an edge that begins to break, below 1.
    ///
    /// - `first`, `q`: largest principal stress and equivalent stress [Pa]
    #[inline]
    pub fn limit(&self, first: f64, q: f64) -> f64 {
        self.limits[usize::from(first < CRACKS * q)]
    }

    /// Pressure ≥ 0 [Pa], and the deviator of a strain.
    #[inline]
    fn parts(&self, strain: Sym3) -> (f64, Sym3) {
        let [xx, yy, zz, xy, yz, zx] = strain.0;
        let trace = xx + yy + zz;
        let deviator = if self.is_flat {
            let half = 0.5 * (xx - yy);
            Sym3([half, -half, 0.0, xy, 0.0, 0.0])
        } else {
            let mean = trace / 3.0;
            Sym3([xx - mean, yy - mean, zz - mean, xy, yz, zx])
        };
        (self.bulk * (-trace).max(0.0), deviator)
    }

    #[inline]
    fn of_parts(&self, pressure: f64, deviator: Sym3) -> Sym3 {
        let [xx, yy, zz, xy, yz, zx] = (deviator * (2.0 * self.shear)).0;
        Sym3([xx - pressure, yy - pressure, if self.is_flat { 0.0 } else { zz - pressure }, xy, yz, zx])
    }

    /// Stress of an elastic strain e, whatever friction allows [Pa].
    #[inline]
    pub fn stress(&self, elastic: Sym3) -> Sym3 {
        let (pressure, deviator) = self.parts(elastic);
        self.of_parts(pressure, deviator)
    }

    /// Stress under a strain [Pa]; what is too much of it slips.
    ///
    /// - `limit`: k
    #[inline]
    pub fn load(&self, strain: Sym3, slip: &mut Sym3, limit: f64) -> Sym3 {
        let (pressure, trial) = self.parts(strain - *slip);
        let [first, last] = if self.is_flat {
            let [xx, _, _, xy, ..] = trial.0;
            let radius = (xx * xx + xy * xy).sqrt();
            [radius, -radius]
        } else {
            let [first, _, last] = trial.principal_values();
            [first, last]
        };
        // ½ (c₁ - c₃) + k ½ (c₁ + c₃), but for k p.
        let size = self.shear * ((1.0 + limit) * first - (1.0 - limit) * last);
        let held = slip_to_cone(trial, size, limit * pressure);
        *slip += trial - held;
        self.of_parts(pressure, held)
    }

    /// Stress after a step, and the energies that it takes.
    ///
    /// The work of the step from ε⁰ to ε¹ less the change of the energy ½ (1 - d) s : ε + ½ d c : e is
    /// ½ (d¹ - d⁰) (s¹ : ε⁰ - c¹ : (ε⁰ - ε_s¹)) + ½ d⁰ (c⁰ : (ε¹ - ε_s⁰) - c¹ : (ε⁰ - ε_s¹)) exactly, of which the second part is friction.
    ///
    /// - `stress`: effective stress s¹ [Pa]
    #[inline]
    pub fn step(&self, step: &RubbingStep, stress: Sym3) -> Rubbed {
        let &RubbingStep { strains: [before, strain], slip: slip_before, limit, damage } = step;
        let mut slip = slip_before;
        let closed = self.load(strain, &mut slip, limit);
        let kept = closed.dot(before - slip);
        let taken = match damage {
            0.0 => 0.0,
            _ => 0.5 * damage * (self.stress(before - slip_before).dot(strain - slip_before) - kept),
        };
        Rubbed { closed, slip, per_damage: 0.5 * (stress.dot(before) - kept), taken }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Elastic, Plane};

    const E: f64 = 30e9;

    fn law(f: f64, nu: f64, plane: Option<Plane>) -> (CrackFriction, Hooke) {
        let hooke = Hooke::new(&Elastic { density: 2400.0, young_modulus: E, poisson_ratio: nu }, plane);
        (CrackFriction::new(f, &hooke), hooke)
    }

    /// A band that is pressed together, slides along x to a strain and back beyond where it began, opens, and closes again.
    #[test]
    fn a_band_that_slides_to_and_fro_bears_f_times_its_pressure_and_takes_the_work_of_it() {
        let planes = [None, Some(Plane::Strain), Some(Plane::Stress)];
        let bands = [0.0, 0.2, 0.45].into_iter().flat_map(|nu| planes.map(|plane| (nu, plane)));
        for ((nu, plane), f) in bands.flat_map(|band| [0.0, 0.3, 0.6, 0.95].map(|f| (band, f))) {
            let (law, hooke) = law(f, nu, plane);
            let limit = law.limit(1.0, 1.0);
            let (gap, far, steps) = (1e-4, 1e-2, 8000);
            let band = |gap: f64, slide: f64| Sym3([0.0, -gap, 0.0, slide, 0.0, 0.0]);
            let (mut slip, mut at) = (Sym3::ZERO, Sym3::ZERO);
            let pressure = law.bulk * gap;
            let mut go = |from: f64, to: f64| {
                let (mut taken, mut stress) = (0.0, Sym3::ZERO);
                for step in 0..=steps {
                    let strain = band(gap, from + (to - from) * f64::from(step) / f64::from(steps));
                    let rubbed = law.step(&RubbingStep { strains: [at, strain], slip, limit, damage: 1.0 }, Sym3::ZERO);
                    taken += rubbed.taken;
                    (slip, at, stress) = (rubbed.slip, strain, rubbed.closed);
                }
                let [_, normal, _, shear, ..] = stress.0;
                assert!((normal + pressure).abs() < 1e-6 * pressure, "{nu} {plane:?} {f}: {normal} of {pressure}");
                let friction = f * pressure * (to - from).signum();
                assert!((shear - friction).abs() < 1e-6 * pressure, "{nu} {plane:?} {f}: {shear} of {friction}");
                taken
            };
            // Its axes turn towards those of the slip on the first way.
            go(0.0, far);
            let taken = go(far, -far) + go(-far, 0.0);
            // It sticks until its shear stress has changed sign.
            let exact = 2.0 * f * pressure * (3.0 * far - 2.0 * f * pressure / hooke.mu);
            assert!(
                (taken - exact).abs() <= 1e-3 * exact + 1e-9 * pressure * far,
                "{nu} {plane:?} {f}: {taken} {exact}"
            );
            let open = law.load(band(-1e-9, 0.5 * far), &mut slip, limit);
            assert!(open.0.iter().all(|c| c.abs() < 1e-9 * pressure), "{open:?}");
            let again = law.load(band(gap, 0.5 * far), &mut slip, limit);
            assert!(again.0[3].abs() < 1e-9 * pressure && again.0[1] <= -pressure * (1.0 - 1e-12), "{again:?}");
        }
    }

    /// Pressed from two sides and more along the third, crushed rock bears (1 + sin φ)/(1 - sin φ) times as much there.
    #[test]
    fn crushed_rock_bears_what_mohr_and_coulomb_say() {
        for (nu, plane) in
            [0.0, 0.2, 0.45].into_iter().flat_map(|nu| [None, Some(Plane::Stress)].map(|plane| (nu, plane)))
        {
            for angle in [0.0, 10.0, 30.0, 44.0f64] {
                let (law, _) = law(angle.to_radians().tan(), nu, plane);
                let limit = law.limit(-1.0, 10.0);
                let mut slip = Sym3::ZERO;
                let mut stress = Sym3::ZERO;
                for step in 1..=4000 {
                    // It gives way sideways, so that its volume shrinks by a hundredth of the strain.
                    let axial = 1e-5 * f64::from(step);
                    let side = 0.99 * axial / if plane.is_none() { 2.0 } else { 1.0 };
                    let across = if plane.is_none() { side } else { 0.0 };
                    stress = law.load(Sym3([side, -axial, across, 0.0, 0.0, 0.0]), &mut slip, limit);
                }
                let [side, axial, ..] = stress.0;
                let sine = angle.to_radians().sin();
                let exact = (1.0 + sine) / (1.0 - sine);
                assert!((axial / side / exact - 1.0).abs() < 1e-6, "{nu} {plane:?} {angle}: {axial} {side} {exact}");
            }
        }
    }
}
