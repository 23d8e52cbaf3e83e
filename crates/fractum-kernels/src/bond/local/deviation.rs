//! Interfaces that resist what their particles do beside their mean strain.

use super::{Interface, InterfaceMemory, Kinematics, LocalBond, RecentStrains, Separation};
use crate::Sym3;
use crate::bond::{BondForces, BondLanes, BondedPair, DeviatingForces, EnergyLanes, ForceLanes};
#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;
use crate::lanes::{Lanes, Vector, add, cross, dot, rotate, rotate_back, scale, sub};
use crate::material::Hooke;

/// Strains of `W` interfaces in the axes of the undeformed body: the mean of their particles, and what they have beside it.
struct Deviations<const W: usize> {
    at: Kinematics<W>,
    /// N · Ē N, and Ē N across N.
    mean: (Lanes<W>, Vector<W>),
    normal: Lanes<W>,
    shear: Vector<W>,
}

/// A v of a symmetric tensor in Voigt order.
#[inline(always)]
fn times<const W: usize>([xx, yy, zz, xy, yz, zx]: [Lanes<W>; 6], v: Vector<W>) -> Vector<W> {
    [dot([xx, xy, zx], v), dot([xy, yy, yz], v), dot([zx, yz, zz], v)]
}

/// The part of a vector across a unit vector.
#[inline(always)]
fn across<const W: usize>(v: Vector<W>, unit: Vector<W>) -> Vector<W> {
    sub(v, scale(unit, dot(unit, v)))
}

impl<const W: usize> Deviations<W> {
    #[inline(always)]
    fn of(bonds: &BondLanes<W>, mean: [Lanes<W>; 6], own: &[Interface; W]) -> Self {
        let at = Kinematics::of(bonds, own);
        let traction = times(mean, bonds.axis);
        let mean = (dot(traction, bonds.axis), across(traction, bonds.axis));
        let normal = at.normal - mean.0;
        let (w, u) = bonds.turns[0];
        let shear = sub(rotate_back(w, u, at.shear), mean.1);
        Deviations { at, mean, normal, shear }
    }

    /// Forces of a normal stress and a stress across, times areas, as derivatives of an energy of the change of length and of the shear in the
    /// axes of the first particles.
    #[inline(always)]
    fn forces(&self, pull: Lanes<W>, stress: Vector<W>, length: Lanes<W>) -> ForceLanes<W> {
        let Kinematics { direction: n, over, shear, arms, along, .. } = self.at;
        let tangent = across(stress, n);
        let turned = sub(scale(tangent, along), scale(shear, dot(n, stress)));
        let force = sub(scale(n, -pull), scale(turned, length * over));
        let (first, second) = (scale(cross(arms[0], tangent), length), scale(cross(arms[1], tangent), length));
        ForceLanes { force, moment: [add(first, scale(cross(shear, stress), length)), second] }
    }
}

impl LocalBond {
    /// Stresses of Hooke's law at a mean strain that go beyond those of the interface, normal and across.
    #[inline(always)]
    fn mean_stress<const W: usize>(&self, mean: [Lanes<W>; 6], at: &Deviations<W>) -> (Lanes<W>, Vector<W>) {
        let Hooke { lambda, mu, .. } = self.hooke();
        let (lame, double) = (Lanes::splat(lambda), Lanes::splat(2.0 * mu));
        ((mean[0] + mean[1] + mean[2]) * lame + at.mean.0 * double, scale(at.mean.1, double))
    }

    /// Forces of interfaces between particles with mean strains `mean`, what they add to the stresses of these, and which whole ones fail under
    /// the stress that the mean strain and the deviation from it give together.
    #[inline(always)]
    pub(super) fn deviating<const W: usize>(
        &self,
        bonds: &BondLanes<W>,
        mean: [Lanes<W>; 6],
        own: &[Interface; W],
        recent: &mut RecentStrains<W>,
        memory: &mut [InterfaceMemory; W],
    ) -> DeviatingForces<W> {
        let at = Deviations::of(bonds, mean, own);
        let (young, modulus) = (Lanes::splat(self.young_modulus), Lanes::splat(self.shear_modulus()));
        let (mut stress, shear_stress) = (at.normal * young, scale(at.shear, modulus));
        let (mean_normal, mean_shear) = self.mean_stress(mean, &at);
        let (normal, shear) = (stress + mean_normal, add(shear_stress, mean_shear));
        let (young_inverse, modulus_inverse) = (1.0 / self.young_modulus, 1.0 / self.shear_modulus());
        let strain = normal * Lanes::splat(young_inverse);
        let square = dot(shear, shear) * Lanes::splat(modulus_inverse * modulus_inverse);
        let live = bonds.acting();
        let failing = live & !self.stay_whole(&strain.0, &square.0) & !recent.inelastic;
        let (w, u) = bonds.turns[0];
        let mut stress_across = rotate(w, u, shear_stress);
        let which = live & recent.inelastic;
        if which != 0 {
            self.inelastic((which, (w, u)), &at.at, recent, memory, (&mut stress, &mut stress_across));
        }
        let [x, y, z] = at.at.shear;
        recent.last = [at.at.normal.0, x.0, y.0, z.0];
        let area = Lanes::of(|k| own[k].area) * bonds.live;
        let length = bonds.inverse.recip();
        let forces = at.forces(stress * area, scale(stress_across, area), length);
        let volume = area * length * Lanes::splat(0.5);
        let n = bonds.axis;
        let (pull, slide) = (at.normal * young * volume, scale(across(at.shear, n), modulus * volume));
        let half = Lanes::splat(0.5);
        let part = |a: usize, b: usize| n[a] * n[b] * pull + (n[a] * slide[b] + n[b] * slide[a]) * half;
        let share = [part(0, 0), part(1, 1), part(2, 2), part(0, 1), part(1, 2), part(2, 0)];
        DeviatingForces { forces, share, failing }
    }

    /// Energies of interfaces, whole ones beside the mean strain of their particles.
    #[inline(always)]
    pub(super) fn energies_beside<const W: usize>(
        &self,
        mean: [Lanes<W>; 6],
        bonds: &BondLanes<W>,
        own: &[Interface; W],
        recent: &RecentStrains<W>,
        memory: &[InterfaceMemory; W],
    ) -> EnergyLanes<W> {
        let at = Deviations::of(bonds, mean, own);
        let mut energies = self.elastic_energies(at.normal, at.shear, bonds, own);
        if recent.inelastic != 0 {
            self.inelastic_energies((recent.inelastic, bonds), &at.at, own, memory, &mut energies);
        }
        energies
    }

    /// Force that an interface transmits, that of the mean strain included (eqs. 21 and 22 of the source).
    #[inline]
    pub(super) fn traction_of(&self, pair: &BondedPair, mean: Sym3, own: &Interface) -> BondForces {
        let lanes = pair.lanes();
        let mean = mean.0.map(|e| Lanes([e]));
        let at = Deviations::of(&lanes, mean, &[*own]);
        let (normal, shear) = self.mean_stress(mean, &at);
        let area = Lanes([own.area]);
        let pull = (at.normal * Lanes::splat(self.young_modulus) + normal) * area;
        let shear = add(scale(at.shear, Lanes::splat(self.shear_modulus())), shear);
        let (w, u) = lanes.turns[0];
        at.forces(pull, scale(rotate(w, u, shear), area), lanes.inverse.recip()).into()
    }

    /// The memory of a whole interface that fails now, and rubs from now on where it is closed.
    #[inline]
    pub(super) fn failed_memory(&self, pair: &BondedPair, mean: Sym3, own: &Interface) -> InterfaceMemory {
        let lanes = pair.lanes();
        let mean = mean.0.map(|e| Lanes([e]));
        let at = Deviations::of(&lanes, mean, &[*own]);
        let (normal, shear) = self.mean_stress(mean, &at);
        let tension = (self.young_modulus * at.normal.0[0] + normal.0[0]) / self.tensile_strength;
        let shear = add(scale(at.shear, Lanes::splat(self.shear_modulus())), shear);
        let by_shear = dot(shear, shear).0[0].sqrt() / self.shear_strength > tension;
        let how = if by_shear { Separation::Shear } else { Separation::Tension };
        let (w, u) = lanes.turns[0];
        let local = rotate_back(w, u, at.at.shear).map(|s| s.0[0]);
        self.separated_memory(how, at.at.normal.0[0], local)
    }
}
