//! The local constitutive bond: an interface of its own area between two particles, with cohesion and friction.

mod deviation;
mod interface;
mod steady;
#[cfg(test)]
mod tests;

pub use interface::{Crushing, InterfaceFailure, InterfaceMemory, RecentStrains, Separation};

use steady::Past;

use super::{
    BadLaw, BondForces, BondLanes, BondLaw, BondStiffness, BondedPair, DeviatingForces, EnergyLanes, ForceLanes,
    MeanElasticity, Turn,
};
use crate::Sym3;
#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;
use crate::lanes::{Lanes, Vector, add, cross, dot, rotate, rotate_back, scale, sub};
use crate::material::Hooke;

/// Stress at the interface of two particles from their relative displacement:
///
/// σ = E u_n/d, τ = G u_s/d, G = E/(2(1 + ν)), forces are stresses times α A with A = π min(r)², d the distance at which
/// the bond was made. Elastic up to σ = σ_t in tension and |τ| = τ_f + μ₁ p under a pressure p, then linear softening; an
/// interface that has separated is a contact with Coulomb's friction μ₂; plastic compression with elastic unloading. Part D
/// of an interface that is damaged in shear rubs, and 1 − D is elastic (Alfano and Sacco, *Int. J. Numer. Methods Eng.* 68
/// (2006) 542–582), so that strength passes over into friction without a jump. The relative displacement is that of the
/// points which both particles carry where they touch, so that rigid motion gives no force, and the distance at which a
/// bond is made is free of force.
///
/// Oñate, Zárate, Celigueta et al., *Advances in the DEM and coupled DEM and FEM techniques in non linear solid
/// mechanics* (2017), eqs. (5)–(20).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalBond {
    /// Young's modulus E [Pa].
    pub young_modulus: f64,
    /// Poisson's ratio ν, which sets the shear stiffness.
    pub poisson_ratio: f64,
    /// Tensile strength σ_t of the interface [Pa]; infinite where it holds for ever.
    pub tensile_strength: f64,
    /// Shear strength τ_f without pressure [Pa]; infinite where it holds for ever.
    pub shear_strength: f64,
    /// Coefficient μ₁ ≥ 0 by which pressure adds to the shear strength.
    pub internal_friction: f64,
    /// Coulomb's coefficient μ₂ ≥ 0 of what has separated.
    pub friction: f64,
    /// Slopes of softening in tension and shear over those of elasticity, H_n/K_n and H_t/K_s, > 0; infinite where it is brittle.
    pub softening: [f64; 2],
    /// How tension and shear act together.
    pub failure: InterfaceFailure,
    /// Plastic compression.
    pub crushing: Crushing,
    /// Local viscous damping ξ ≥ 0 of the normal motion.
    pub damping_ratio: f64,
    /// Volume of the spheres over that of the body where interfaces resist deviations from the mean strain of their particles, which follows
    /// Hooke's law: `bond = "local-nonlocal"`. Such interfaces are brittle, and elastic in compression.
    pub mean_strain: Option<f64>,
}

/// What an interface has of its own.
#[derive(Clone, Copy, Debug)]
pub struct Interface {
    /// α A [m²].
    area: f64,
    /// Distance from the first particle to the interface over that of both particles.
    arm: f64,
    /// Smaller radius of the two [m].
    radius: f64,
}

/// Strains of `W` bonds, and what turns stresses into forces.
struct Kinematics<const W: usize> {
    direction: Vector<W>,
    over: Lanes<W>,
    normal: Lanes<W>,
    shear: Vector<W>,
    /// Arms from both particles to the interface, turned with them, over the length of the bond.
    arms: [Vector<W>; 2],
    along: Lanes<W>,
}

impl<const W: usize> Kinematics<W> {
    #[inline(always)]
    fn of(bonds: &BondLanes<W>, own: &[Interface; W]) -> Self {
        let BondLanes { gap, turns, axis, inverse, .. } = *bonds;
        let length = dot(gap, gap).sqrt();
        let over = length.recip();
        let n = scale(gap, over);
        let first = Lanes::of(|k| own[k].arm);
        let second = Lanes::splat(1.0) - first;
        let [(w1, u1), (w2, u2)] = turns;
        let arms = [scale(rotate(w1, u1, axis), first), scale(rotate(w2, u2, axis), second)];
        let sum = add(arms[0], arms[1]);
        let along = dot(n, sum);
        let shear = sub(scale(n, along), sum);
        Kinematics { direction: n, over, normal: length * inverse - Lanes::splat(1.0), shear, arms, along }
    }

    /// Forces of a normal stress and a stress across, times areas, as derivatives of an energy of the strains and of slips that turn with the first
    /// particles, which so take the moment of a stress that is not along its strain.
    #[inline(always)]
    fn forces(&self, pull: Lanes<W>, across: Vector<W>, length: Lanes<W>) -> ForceLanes<W> {
        let force = sub(scale(self.direction, -pull), scale(across, self.along * length * self.over));
        let missing = scale(cross(self.shear, across), length);
        let [first, second] = [cross(self.arms[0], across), cross(self.arms[1], across)];
        let (first, second) = (scale(first, length), scale(second, length));
        ForceLanes { force, moment: [add(first, missing), second] }
    }
}

/// Slips in the axes of the first particles, as they lie across the bonds now.
#[inline(always)]
fn turned_slips<const W: usize>((w, u): Turn<W>, slips: Vector<W>, direction: Vector<W>) -> Vector<W> {
    let slips = rotate(w, u, slips);
    sub(slips, scale(direction, dot(direction, slips)))
}

impl LocalBond {
    /// Largest Poisson's ratio with [`LocalBond::mean_strain`]: beyond it steps become very short.
    pub const LARGEST_POISSON_RATIO: f64 = 0.49;

    /// An elastic interface that holds for ever.
    #[inline]
    pub fn elastic(young_modulus: f64, poisson_ratio: f64) -> Self {
        LocalBond {
            young_modulus,
            poisson_ratio,
            tensile_strength: f64::INFINITY,
            shear_strength: f64::INFINITY,
            internal_friction: 0.0,
            friction: 0.0,
            softening: [f64::INFINITY; 2],
            failure: InterfaceFailure::default(),
            crushing: Crushing::NONE,
            damping_ratio: 0.0,
            mean_strain: None,
        }
    }

    /// The elastic law of the material.
    #[inline]
    pub fn hooke(&self) -> Hooke {
        Hooke::in_space(self.young_modulus, self.poisson_ratio)
    }

    /// G = E/(2(1 + ν)) [Pa].
    #[inline]
    pub fn shear_modulus(&self) -> f64 {
        self.hooke().mu
    }

    /// Whether there is any strength.
    #[inline]
    pub(super) fn is_cohesive(&self) -> bool {
        self.tensile_strength > 0.0 || self.shear_strength > 0.0
    }

    /// Whether bonds can separate.
    #[inline]
    pub fn can_fail(&self) -> bool {
        self.tensile_strength.is_finite() || self.shear_strength.is_finite()
    }

    /// Energies of whole interfaces at these strains.
    #[inline(always)]
    fn elastic_energies<const W: usize>(
        &self,
        normal: Lanes<W>,
        shear: Vector<W>,
        bonds: &BondLanes<W>,
        own: &[Interface; W],
    ) -> EnergyLanes<W> {
        let half = Lanes::of(|k| 0.5 * own[k].area) * bonds.inverse.recip();
        EnergyLanes {
            tension: half * Lanes::splat(self.young_modulus) * normal * normal,
            bending: half * Lanes::splat(self.shear_modulus()) * dot(shear, shear),
            torsion: Lanes::splat(0.0),
        }
    }

    /// Energies of some interfaces, as bits, that are not whole, in the place of the elastic ones.
    #[inline(always)]
    fn inelastic_energies<const W: usize>(
        &self,
        (which, bonds): (u32, &BondLanes<W>),
        at: &Kinematics<W>,
        own: &[Interface; W],
        memory: &[InterfaceMemory; W],
        energies: &mut EnergyLanes<W>,
    ) {
        let of = |a: usize| Lanes::of(|k| memory[k].slip[a]);
        let slip = turned_slips(bonds.turns[0], [of(0), of(1), of(2)], at.direction);
        for k in (0..W).filter(|k| which >> k & 1 == 1) {
            let vector = |v: &Vector<W>| [v[0].0[k], v[1].0[k], v[2].0[k]];
            let [along, across] = self.stored(at.normal.0[k], vector(&at.shear), vector(&slip), &memory[k]);
            let volume = own[k].area / bonds.inverse.0[k];
            (energies.tension.0[k], energies.bending.0[k]) = (along * volume, across * volume);
        }
    }

    /// Stresses of some interfaces, as bits, that are not, or do not stay, whole, in the place of the elastic ones.
    #[inline(always)]
    fn inelastic<const W: usize>(
        &self,
        (which, (w, u)): (u32, Turn<W>),
        at: &Kinematics<W>,
        recent: &mut RecentStrains<W>,
        memory: &mut [InterfaceMemory; W],
        (stress, across): (&mut Lanes<W>, &mut Vector<W>),
    ) {
        let of = |a: usize| Lanes::of(|k| memory[k].slip[a]);
        let slip = turned_slips((w, u), [of(0), of(1), of(2)], at.direction);
        let of = |a: usize| Lanes::of(|k| memory[k].last[a]);
        let mut past = Past { slip, shear: rotate(w, u, [of(1), of(2), of(3)]) };
        let [x, y, z] = rotate_back(w, u, at.shear);
        let known = which & recent.inelastic;
        let [steady, mut moved] = self.steady(known, (at.normal, at.shear), &mut past, memory, (stress, across));
        for k in (0..W).filter(|k| (which & !steady) >> k & 1 == 1) {
            let vector = |v: &Vector<W>| [v[0].0[k], v[1].0[k], v[2].0[k]];
            let (shear, slip) = (vector(&at.shear), vector(&past.slip));
            memory[k] = recent.recall(&memory[k], k);
            let [_, first, second, third] = memory[k].last;
            let last = if known >> k & 1 == 1 { vector(&past.shear) } else { [first, second, third] };
            let (normal_stress, shear_stress, new) = self.stress(at.normal.0[k], shear, [slip, last], &mut memory[k]);
            recent.remember(&memory[k], k);
            stress.0[k] = normal_stress;
            moved |= u32::from(new != slip) << k;
            for a in 0..3 {
                across[a].0[k] = shear_stress[a];
                past.slip[a].0[k] = new[a];
            }
        }
        for k in (0..W).filter(|k| which >> k & 1 == 1) {
            memory[k].last = [at.normal.0[k], x.0[k], y.0[k], z.0[k]];
        }
        if moved != 0 {
            let [x, y, z] = rotate_back(w, u, past.slip);
            for k in (0..W).filter(|k| moved >> k & 1 == 1) {
                memory[k].slip = [x.0[k], y.0[k], z.0[k]];
            }
        }
    }
}

impl BondLaw for LocalBond {
    type Parameters = Interface;
    type Memory = InterfaceMemory;
    type Recent<const W: usize> = RecentStrains<W>;

    #[inline]
    fn recall<const W: usize>(
        recent: &RecentStrains<W>,
        memory: &[InterfaceMemory; W],
        lane: usize,
    ) -> InterfaceMemory {
        recent.recall(&memory[lane], lane)
    }

    #[inline]
    fn remember<const W: usize>(
        saved: InterfaceMemory,
        lane: usize,
        recent: &mut RecentStrains<W>,
        memory: &mut [InterfaceMemory; W],
    ) {
        recent.remember(&saved, lane);
        memory[lane] = saved;
    }

    #[inline(always)]
    fn separated<const W: usize>(recent: &RecentStrains<W>) -> u32 {
        recent.separated
    }

    fn check(&self) -> Result<(), BadLaw> {
        let wrong = |what, value, expected| Err(BadLaw::Number { what, value, expected });
        if !(self.young_modulus.is_finite() && self.young_modulus > 0.0) {
            return wrong("Young's modulus", self.young_modulus, "a positive number of pascals");
        }
        if !(self.poisson_ratio > -1.0 && self.poisson_ratio <= 0.5) {
            return wrong("Poisson's ratio", self.poisson_ratio, "above -1, at most 0.5");
        }
        let named = [
            ("tensile strength", self.tensile_strength),
            ("shear strength", self.shear_strength),
            ("internal friction", self.internal_friction),
            ("friction", self.friction),
            ("damping ratio", self.damping_ratio),
        ];
        if let Some((what, value)) = named.into_iter().find(|(_, value)| value.is_nan() || *value < 0.0) {
            return wrong(what, value, "zero or more");
        }
        if let Some(value) = self.softening.into_iter().find(|h| h.is_nan() || *h <= 0.0) {
            return wrong("softening", value, "a slope above zero");
        }
        if let Some(fraction) = self.mean_strain {
            if !(fraction > 0.0 && fraction.is_finite()) {
                return wrong("solid fraction of the body", fraction, "a number above zero");
            }
            if self.poisson_ratio > Self::LARGEST_POISSON_RATIO {
                return wrong(
                    "Poisson's ratio",
                    self.poisson_ratio,
                    "at most 0.49 with bonds that follow the mean strain",
                );
            }
            if !(self.tensile_strength > 0.0 && self.shear_strength > 0.0) {
                let least = self.tensile_strength.min(self.shear_strength);
                return wrong("strength", least, "above zero with bonds that follow the mean strain");
            }
            if self.softening != [f64::INFINITY; 2] || self.crushing != Crushing::NONE {
                return wrong(
                    "softening",
                    self.softening[0],
                    "brittle and elastic in compression where bonds follow the mean strain",
                );
            }
        }
        let Crushing { stress, ratio } = self.crushing;
        if let Some(value) = ratio.into_iter().find(|ratio| !(ratio.is_finite() && *ratio >= 1.0)) {
            return wrong("ratio of moduli in compression", value, "a finite number, 1 or more");
        }
        match stress.is_sorted() && stress[0] > 0.0 {
            true => Ok(()),
            false => wrong("limit of compressive stress", stress[0], "three positive numbers, ascending"),
        }
    }

    #[inline]
    fn parameters(&self, length: f64, [first, second]: [f64; 2], share: f64) -> Interface {
        let radius = first.min(second);
        let area = share * core::f64::consts::PI * radius * radius;
        let arm = 0.5 + 0.5 * (first - second) / length;
        Interface { area, arm: arm.clamp(0.0, 1.0), radius }
    }

    #[inline(always)]
    fn forces<const W: usize>(
        &self,
        bonds: &BondLanes<W>,
        own: &[Interface; W],
        recent: &mut RecentStrains<W>,
        memory: &mut [InterfaceMemory; W],
    ) -> ForceLanes<W> {
        let at = Kinematics::of(bonds, own);
        let mut stress = at.normal * Lanes::splat(self.young_modulus);
        let mut across = scale(at.shear, Lanes::splat(self.shear_modulus()));
        let whole = self.stay_whole(&at.normal.0, &dot(at.shear, at.shear).0) & !recent.inelastic;
        let live = bonds.acting();
        let which = live & !whole;
        if which != 0 {
            self.inelastic((which, bonds.turns[0]), &at, recent, memory, (&mut stress, &mut across));
        }
        recent.last = [at.normal.0, at.shear[0].0, at.shear[1].0, at.shear[2].0];
        let area = Lanes::of(|k| own[k].area) * bonds.live;
        at.forces(stress * area, scale(across, area), bonds.inverse.recip())
    }

    #[inline(always)]
    fn energies<const W: usize>(
        &self,
        bonds: &BondLanes<W>,
        own: &[Interface; W],
        recent: &RecentStrains<W>,
        memory: &[InterfaceMemory; W],
    ) -> EnergyLanes<W> {
        let at = Kinematics::of(bonds, own);
        let mut energies = self.elastic_energies(at.normal, at.shear, bonds, own);
        if recent.inelastic != 0 {
            self.inelastic_energies((recent.inelastic, bonds), &at, own, memory, &mut energies);
        }
        energies
    }

    #[inline]
    fn dissipated(&self, length: f64, own: &Interface, memory: &InterfaceMemory) -> f64 {
        memory.dissipated * own.area * length
    }

    #[inline]
    fn stiffness(&self, length: f64, own: &Interface) -> BondStiffness {
        let across = self.shear_modulus() * own.area / length;
        // The longer arm at both ends: a bound where the interface is not in the middle.
        let bending = across * (own.arm.max(1.0 - own.arm) * length).powi(2);
        BondStiffness { axial: self.young_modulus * own.area / length, bending, carry_over: bending, twist: 0.0 }
    }

    #[inline]
    fn mean_elasticity(&self) -> Option<MeanElasticity> {
        let of = |fraction| MeanElasticity { hooke: self.hooke(), fraction };
        self.mean_strain.map(of)
    }

    #[inline(always)]
    fn deviating_forces<const W: usize>(
        &self,
        bonds: &BondLanes<W>,
        mean: [Lanes<W>; 6],
        own: &[Interface; W],
        recent: &mut RecentStrains<W>,
        memory: &mut [InterfaceMemory; W],
    ) -> DeviatingForces<W> {
        self.deviating(bonds, mean, own, recent, memory)
    }

    #[inline(always)]
    fn deviating_energies<const W: usize>(
        &self,
        bonds: &BondLanes<W>,
        mean: [Lanes<W>; 6],
        own: &[Interface; W],
        recent: &RecentStrains<W>,
        memory: &[InterfaceMemory; W],
    ) -> EnergyLanes<W> {
        self.energies_beside(mean, bonds, own, recent, memory)
    }

    #[inline]
    fn traction(&self, pair: &BondedPair, mean: Sym3, own: &Interface) -> Option<BondForces> {
        Some(self.traction_of(pair, mean, own))
    }

    #[inline]
    fn failed(&self, pair: &BondedPair, mean: Sym3, own: &Interface) -> InterfaceMemory {
        self.failed_memory(pair, mean, own)
    }

    #[inline]
    fn with_dissipated(&self, memory: InterfaceMemory, energy: f64, length: f64, own: &Interface) -> InterfaceMemory {
        let mut memory = memory;
        memory.dissipated += energy / (own.area * length);
        memory
    }

    #[inline]
    fn face_stiffness(&self, rest: f64) -> [f64; 2] {
        let normal = self.young_modulus * core::f64::consts::PI * rest / 4.0;
        [normal, normal * self.shear_modulus() / self.young_modulus]
    }

    #[inline]
    fn section_radius(&self) -> f64 {
        1.0
    }

    #[inline]
    fn separation(memory: &InterfaceMemory) -> Option<Separation> {
        memory.separation
    }

    /// C = 2 ξ α A/(d r) √(m K_n) [N s/m], with the smaller radius r and the reduced mass m (eq. 10 of the source).
    #[inline]
    fn viscosity(&self, length: f64, own: &Interface, mass: f64) -> f64 {
        let stiffness = self.young_modulus * own.area / length;
        2.0 * self.damping_ratio * own.area / (length * own.radius) * (mass * stiffness).sqrt()
    }

    #[inline]
    fn touches(&self, strain: f64, memory: &InterfaceMemory) -> bool {
        !memory.is_separated() || self.is_closed(strain, memory)
    }
}
