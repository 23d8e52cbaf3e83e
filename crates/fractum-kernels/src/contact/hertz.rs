use serde::{Deserialize, Serialize};

use super::accounted_spring::{AccountedSpring, Pressed};
use super::rolling::{Rolling, RollingMemory};
use super::slip::slip_to_cone;
use super::{ContactForce, ContactLaw, ContactParameters, PairMotion};
use crate::Vec3;
use crate::elementary::cbrt;
#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;

/// Elastic constants of a material in contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ElasticMaterial {
    /// Young's modulus E [Pa]; infinite for a rigid body.
    pub young_modulus: f64,
    /// Poisson's ratio ν.
    pub poisson_ratio: f64,
}

impl ElasticMaterial {
    /// A body that does not deform.
    pub const RIGID: Self = ElasticMaterial { young_modulus: f64::INFINITY, poisson_ratio: 0.0 };

    /// (1 - ν²)/E [1/Pa].
    #[inline]
    fn normal_compliance(&self) -> f64 {
        (1.0 - self.poisson_ratio * self.poisson_ratio) / self.young_modulus
    }

    /// (2 - ν)/G [1/Pa].
    #[inline]
    fn shear_compliance(&self) -> f64 {
        2.0 * (1.0 + self.poisson_ratio) * (2.0 - self.poisson_ratio) / self.young_modulus
    }
}

/// What two materials in contact share, whatever the size of the bodies.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MaterialPair {
    /// Effective modulus E* = 1/((1 - ν₁²)/E₁ + (1 - ν₂²)/E₂) [Pa].
    pub effective_modulus: f64,
    /// Effective shear modulus G* = 1/((2 - ν₁)/G₁ + (2 - ν₂)/G₂) [Pa].
    pub effective_shear_modulus: f64,
    /// Work of adhesion W: energy that separates a unit of area [J/m²]; 0 without adhesion.
    pub work_of_adhesion: f64,
    /// Thickness t of plane discs [m]; none of spheres.
    pub thickness: Option<f64>,
    /// Friction and damping; a damping ratio ζ gives the restitution [`restitution_of_damping`](super::restitution_of_damping)
    /// at every speed.
    pub surface: ContactParameters,
}

impl MaterialPair {
    /// Two materials; `surface` is that of the pair, [`ContactParameters::against`].
    #[inline]
    pub fn new(materials: [ElasticMaterial; 2], surface: ContactParameters) -> Self {
        let sum = |of: fn(&ElasticMaterial) -> f64| 1.0 / (of(&materials[0]) + of(&materials[1]));
        MaterialPair {
            effective_modulus: sum(ElasticMaterial::normal_compliance),
            effective_shear_modulus: sum(ElasticMaterial::shear_compliance),
            work_of_adhesion: 0.0,
            thickness: None,
            surface,
        }
    }

    /// The same of plane discs, where there is a thickness [m].
    #[inline]
    pub fn of_thickness(self, thickness: Option<f64>) -> Self {
        MaterialPair { thickness, ..self }
    }

    /// Effective radius R* of a particle on a ground of the given mean curvature [m]: a disc feels that of the section, which is twice as large.
    #[inline]
    pub fn radius_on(&self, radius: f64, curvature: f64) -> f64 {
        let curvature = if self.thickness.is_some() { 2.0 * curvature } else { curvature };
        1.0 / (1.0 / radius + curvature)
    }

    /// The same, with a work of adhesion W ≥ 0 [J/m²].
    #[inline]
    pub fn sticking(self, work_of_adhesion: f64) -> Self {
        MaterialPair { work_of_adhesion, ..self }
    }
}

/// Hertz-Mindlin contact of two spheres, with friction and with damping that gives one restitution at every speed.
///
/// - normal: F_n = k_h δ^(3/2) + c_n dδ/dt, k_h = 4/3 E* √R*, c_n = √5 ζ √(m* k_h) δ^¼; never pulls
/// - tangential: stiffness 8 G* √(R* δ) on the slip s, Coulomb's limit μ F_n, damper c_t = c_n √(k_t/(3/2 k_h √δ))
///   while it sticks. Under growing load the force is kept and new slip meets the new stiffness; under falling load the
///   force falls with the stiffness: no path gains energy (Thornton, Cummins and Cleary 2011).
///
/// *Adhesion* pulls with F_a = 2π W R* beside Hertz' force (Derjaguin, Muller and Toporov 1975). Across a gap the pull falls linearly to zero at
/// h = (F_a/k_h)^(2/3), the overlap of a pair without other forces. Its energy is -F_a (δ + h/2) in contact and -F_a (h + δ)²/2h across
/// the gap. Friction and damping are those of the elastic part of the force.
///
/// A *flat* contact has its full size from the first touch on, as that of a flat punch: F_n = k δ + c dδ/dt with constant
/// stiffnesses, c = 2 ζ √(m* k). Where it begins or ends within a step its force is the one that gives back the energy
/// it has taken.
///
/// *Plane discs* touch along a line: F_n = k δ + c dδ/dt with k = π/4 E* t and the tangential stiffness π G* t, whatever their radii. The exact approach of
/// two cylinders has a logarithm in it that depends on what is far from the contact (Johnson, section 5.6); the straight line is that of Popov, chapter 5,
/// and the ratio of both stiffnesses that of spheres. They begin and end as flat contacts do.
///
/// Johnson, *Contact Mechanics* (1985), eqs (3.36), (4.22), (7.43); Popov, *Contact Mechanics and Friction* (2010); Antypov and Elliott (2011) for the
/// damping.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hertz {
    /// k_h [N/m^(3/2)]; the normal stiffness of a flat contact [N/m].
    pub normal: f64,
    /// 8 G* √R* [N/m^(3/2)]: tangential stiffness over √δ; that of a flat contact [N/m].
    pub tangential: f64,
    /// √5 ζ √(m* k_h) [N s/m^(5/4)]: normal damping over δ^¼; that of a flat contact [N s/m].
    pub damping: f64,
    /// Tangential over normal damping.
    pub damping_share: f64,
    /// Coulomb's coefficient μ.
    pub friction: f64,
    /// Friction against rolling.
    pub rolling: Rolling,
    /// Pull F_a of adhesion [N].
    pub pull: f64,
    /// Gap h across which it acts [m].
    pub reach: f64,
    /// Effective mass m* [kg] of a contact whose stiffnesses do not grow with the overlap: of a flat one, or of discs.
    pub flat: Option<f64>,
    /// Whether that is of discs, whose normal turns: the energy of the spring is that of the overlap.
    pub of_discs: bool,
}

/// What a Hertz contact remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HertzMemory {
    /// Slip s of the tangential spring [m].
    pub slip: Vec3,
    /// Force of the tangential damper on i at the last step [N].
    drag: Vec3,
    /// √δ at the last step [m^½].
    root: f64,
    /// Force of the normal damper at the last step [N].
    damper: f64,
    rolling: RollingMemory,
    /// Normal spring of a flat contact.
    spring: AccountedSpring,
    /// Part of the overlap that gives no force [m], see [`ContactLaw::add_overlap_offset`].
    overlap_offset: f64,
}

impl Hertz {
    /// The law of two bodies of effective radius R* = R₁R₂/(R₁ + R₂) [m] and effective mass m* = m₁m₂/(m₁ + m₂) [kg];
    /// a flat or very heavy partner counts as infinite, so that the particle's own value is left.
    #[inline]
    pub fn new(pair: &MaterialPair, effective_radius: f64, effective_mass: f64) -> Self {
        if let Some(thickness) = pair.thickness {
            let normal = 0.25 * core::f64::consts::PI * pair.effective_modulus * thickness;
            let tangential = core::f64::consts::PI * pair.effective_shear_modulus * thickness;
            let flat = Hertz::flat([normal, tangential], pair.surface, effective_radius, effective_mass);
            let rolling = Rolling::of_disc(pair.surface.rolling_friction, effective_radius, effective_mass);
            return Hertz { rolling, of_discs: true, ..flat };
        }
        let root = effective_radius.sqrt();
        let normal = 4.0 / 3.0 * pair.effective_modulus * root;
        let tangential = 8.0 * pair.effective_shear_modulus * root;
        let pull = 2.0 * core::f64::consts::PI * pair.work_of_adhesion * effective_radius;
        let reach = if pull > 0.0 { cbrt((pull / normal) * (pull / normal)) } else { 0.0 };
        Hertz {
            normal,
            tangential,
            damping: 5f64.sqrt() * pair.surface.damping_ratio * (effective_mass * normal).sqrt(),
            damping_share: (tangential / (1.5 * normal)).sqrt(),
            friction: pair.surface.friction,
            rolling: Rolling::new(pair.surface.rolling_friction, effective_radius, effective_mass),
            pull,
            reach,
            flat: None,
            of_discs: false,
        }
    }

    /// The flat contact of a body of effective mass m* [kg].
    ///
    /// - `stiffness`: normal and tangential [N/m]; `arm`: radius that friction against rolling takes [m]
    #[inline]
    pub fn flat(stiffness: [f64; 2], surface: ContactParameters, arm: f64, effective_mass: f64) -> Self {
        let [normal, tangential] = stiffness;
        Hertz {
            normal,
            tangential,
            damping: 2.0 * surface.damping_ratio * (effective_mass * normal).sqrt(),
            damping_share: (tangential / normal).sqrt(),
            friction: surface.friction,
            rolling: Rolling::new(surface.rolling_friction, arm, effective_mass),
            pull: 0.0,
            reach: 0.0,
            flat: Some(effective_mass),
            of_discs: false,
        }
    }

    /// Force [N] and energy [J] of the normal spring at an overlap δ > 0, and √δ [m^½], which is 1 for a flat contact.
    ///
    /// - `way`: change of the overlap in the step [m]
    #[inline]
    fn elastic(&self, overlap: f64, way: f64, dt: f64, spring: &mut AccountedSpring) -> (f64, f64, f64) {
        if let Some(mass) = self.flat {
            let force =
                spring.press(&Pressed { stiffness: self.normal, mass, viscosity: self.damping, overlap, way, dt });
            return (force, spring.energy(), 1.0);
        }
        let root = overlap.sqrt();
        let force = self.normal * overlap * root;
        (force, 0.4 * force * overlap, root)
    }
}

impl Hertz {
    /// Forces [N] of spring and damper of discs of the effective mass m* [kg] at an overlap δ > 0, and the energy that the spring has lost since the last
    /// step where what it pressed on has gone [J].
    ///
    /// The damper acts for the part of the first step in which they touch. It sees the velocity of half a step before, which lets it act as
    /// c √(1 + c Δt/2m*): it is the smaller by that.
    #[inline]
    fn press_discs(
        &self,
        mass: f64,
        overlap: f64,
        approach: f64,
        dt: f64,
        spring: &mut AccountedSpring,
    ) -> (f64, f64, f64) {
        let way = approach * dt;
        let part = if spring.is_new() && way > overlap { 0.5 + overlap / way } else { 1.0 };
        let viscosity = part * self.damping / (1.0 + 0.25 * self.damping * dt / mass);
        let force = spring.press(&Pressed { stiffness: self.normal, mass, viscosity, overlap, way, dt });
        let whole = force == self.normal * overlap;
        let lost = if whole { spring.take_energy_of(self.normal, overlap).max(0.0) } else { 0.0 };
        (force, (viscosity * approach).max(-force), lost)
    }

    /// Force of a contact of spheres or discs at the last step on j [N].
    ///
    /// - `normal`: unit normal from i to j; `overlap` [m]: where the pull acts across a gap
    pub fn last_force(&self, memory: &HertzMemory, normal: &Vec3, overlap: f64) -> Vec3 {
        let HertzMemory { slip, drag, root, damper, spring, .. } = memory;
        let elastic = if self.of_discs { spring.force() } else { self.normal * root * root * root };
        let overlap = if *root > 0.0 { 0.0 } else { overlap.clamp(-self.reach, 0.0) };
        normal * (elastic + damper - self.adhesion(overlap).0) - slip * (self.tangential * root) - drag
    }

    /// Pull [N] and energy [J] of adhesion at an overlap δ > -h.
    #[inline]
    fn adhesion(&self, overlap: f64) -> (f64, f64) {
        if self.pull == 0.0 {
            return (0.0, 0.0);
        }
        if overlap >= 0.0 {
            return (self.pull, -self.pull * (overlap + 0.5 * self.reach));
        }
        let force = self.pull * (1.0 + overlap / self.reach);
        (force, -0.5 * force * (self.reach + overlap))
    }
}

impl ContactLaw for Hertz {
    type Memory = HertzMemory;

    #[inline]
    fn reach(&self) -> f64 {
        self.reach
    }

    #[inline]
    fn force(&self, motion: &PairMotion, memory: &mut HertzMemory) -> ContactForce {
        let n = motion.normal;
        let approach = -motion.velocity.dot(&n);
        let across = motion.velocity + n * approach;
        let mut old = *memory;
        let old_stiffness = self.tangential * old.root;
        let old_spring = 0.5 * old_stiffness * old.slip.norm_squared();
        let overlap_offset = old.overlap_offset.min((motion.overlap + self.reach).max(0.0));
        let overlap = motion.overlap - overlap_offset;
        if overlap <= -self.reach {
            *memory = HertzMemory { overlap_offset, ..HertzMemory::default() };
            return ContactForce {
                damping: 0.5 * (old.damper * approach + old.drag.dot(&across)) * motion.dt
                    + old.spring.part(approach * motion.dt)
                    + old.rolling.last_damping(motion),
                friction: old_spring + 0.5 * old_stiffness * old.slip.dot(&across) * motion.dt + old.rolling.stored(),
                ..ContactForce::default()
            };
        }
        let (pull, bound) = self.adhesion(overlap);
        let mut lost = 0.0;
        let (elastic, damper, compressed, root) = if let (true, Some(mass)) = (self.of_discs, self.flat) {
            let (elastic, damper, gone) = self.press_discs(mass, overlap, approach, motion.dt, &mut old.spring);
            lost = gone;
            (elastic, damper, old.spring.energy(), 1.0)
        } else {
            let (elastic, compressed, root) =
                self.elastic(overlap.max(0.0), approach * motion.dt, motion.dt, &mut old.spring);
            (elastic, (self.damping * root.sqrt() * approach).max(-elastic), compressed, root)
        };
        let viscosity = self.damping * root.sqrt();
        let normal_force = elastic + damper;

        // The spring lives in the tangent plane of the moment; turned there it keeps its length.
        let height = old.slip.dot(&n);
        let flat = old.slip - n * height;
        let flat_square = flat.norm_squared();
        let turned = if height == 0.0 || flat_square == 0.0 {
            flat
        } else {
            flat * (1.0 + height * height / flat_square).sqrt()
        };
        let stiffness = self.tangential * root;
        let kept = if root > old.root { turned * (old.root / root) } else { turned };
        let trial = kept + across * motion.dt;
        let limit = self.friction * normal_force;
        let reach_square = stiffness * stiffness * trial.norm_squared();
        let (slip, drag) = if reach_square > limit * limit {
            (slip_to_cone(trial, reach_square.sqrt(), limit), Vec3::zeros())
        } else {
            // The damper acts within what friction leaves.
            let drag = across * (viscosity * self.damping_share);
            let whole = trial * stiffness + drag;
            let size = whole.norm();
            (trial, if size > limit { slip_to_cone(whole, size, limit) - trial * stiffness } else { drag })
        };
        *memory = HertzMemory { slip, drag, root, damper, rolling: old.rolling, spring: old.spring, overlap_offset };

        let spring = 0.5 * stiffness * slip.norm_squared();
        let work = 0.5 * (turned * old_stiffness + slip * stiffness).dot(&across) * motion.dt;
        let mut force = ContactForce {
            on_second: n * (normal_force - pull) - slip * stiffness - drag,
            couple_on_second: Vec3::zeros(),
            stored: compressed + bound + spring,
            friction: work + old_spring - spring,
            damping: 0.5 * ((old.damper + damper) * approach + (old.drag + drag).dot(&across)) * motion.dt,
        };
        if lost > 0.0 {
            force.damping += lost;
        }
        if self.rolling.arm > 0.0 && overlap <= 0.0 {
            force.friction += old.rolling.stored();
            force.damping += old.rolling.last_damping(motion);
            memory.rolling = RollingMemory::default();
        } else if self.rolling.arm > 0.0 {
            let normal_stiffness = self.stiffness(overlap).0;
            let rolled = self.rolling.couple(motion, normal_force, normal_stiffness, &mut memory.rolling);
            force.couple_on_second = rolled.on_second;
            force.stored += rolled.stored;
            force.friction += rolled.friction;
            force.damping += rolled.damping;
        }
        force
    }

    #[inline]
    fn add_overlap_offset(memory: &mut HertzMemory, by: f64) {
        memory.overlap_offset += by;
    }

    #[inline]
    fn overlap_offset(memory: &HertzMemory) -> f64 {
        memory.overlap_offset
    }

    #[inline]
    fn stiffness(&self, overlap: f64) -> (f64, f64) {
        if self.flat.is_some() {
            return (self.normal, self.tangential);
        }
        let root = overlap.max(0.0).sqrt();
        (1.5 * self.normal * root, self.tangential * root)
    }
}
