//! Interfaces side by side whose damage does not grow: the usual case of those that something has happened to.

use super::interface::ROUND_OFF;
use super::{InterfaceFailure, InterfaceMemory, LocalBond};
use crate::lanes::{Lanes, Vector, add, dot, scale, sub};

/// What interfaces side by side remember of their slips and of the last step, in the axes of their shear strains now.
pub(super) struct Past<const W: usize> {
    /// Slips; those of the interfaces that slip are replaced.
    pub(super) slip: Vector<W>,
    /// Last shear strains.
    pub(super) shear: Vector<W>,
}

/// `yes` where the condition holds, `no` elsewhere.
#[inline(always)]
fn choose<const W: usize>(condition: &[bool; W], yes: Lanes<W>, no: Lanes<W>) -> Lanes<W> {
    Lanes::of(|k| if condition[k] { yes.0[k] } else { no.0[k] })
}

#[inline(always)]
fn each<const W: usize>(condition: impl Fn(usize) -> bool) -> [bool; W] {
    let mut out = [false; W];
    for k in 0..W {
        out[k] = condition(k);
    }
    out
}

#[inline(always)]
fn bits<const W: usize>(condition: &[bool; W]) -> u32 {
    let mut out = 0;
    for k in 0..W {
        out |= u32::from(condition[k]) << k;
    }
    out
}

impl LocalBond {
    /// [`LocalBond::stress`] of those of some interfaces, as bits, that are whole but for compression, or have separated, and stay so: returns these, and
    /// those of them that slip.
    #[inline(always)]
    pub(super) fn steady<const W: usize>(
        &self,
        which: u32,
        (normal, shear): (Lanes<W>, Vector<W>),
        past: &mut Past<W>,
        memory: &mut [InterfaceMemory; W],
        (stress, across): (&mut Lanes<W>, &mut Vector<W>),
    ) -> [u32; 2] {
        let (young, modulus) = (Lanes::splat(self.young_modulus), Lanes::splat(self.shear_modulus()));
        let crushed = Lanes::of(|k| memory[k].crushed);
        let failed = Lanes::of(|k| memory[k].damage[1]);
        let yields = self.crushing.stress[0] / self.young_modulus;
        let crushes = each(|k| -normal.0[k] > crushed.0[k].max(yields));
        let now = choose(&crushes, -normal, crushed);
        let elastic = normal + self.plastic_strains(now);
        let compression = Lanes::of(|k| (-elastic.0[k]).max(0.0)) * young;
        let damage = self.keeps_damage(elastic, compression, dot(shear, shear).sqrt() * modulus);
        let steady: [bool; W] = each(|k| match memory[k].damage {
            [0.0, 0.0] => damage[k],
            [first, second] => first >= 1.0 && second >= 1.0,
        });
        let steady = which & bits(&steady);
        let (pull, energy) = stress_and_energy(elastic, failed, young);

        let trial = scale(sub(shear, past.slip), modulus);
        let (size, most) = (dot(trial, trial).sqrt(), compression * Lanes::splat(self.friction));
        let slides: [bool; W] = each(|k| failed.0[k] > 0.0 && size.0[k] > most.0[k] * (1.0 + ROUND_OFF));
        let share = Lanes::of(|k| most.0[k] / (size.0[k] * modulus.0[k]));
        let slid = sub(shear, scale(trial, share));
        let slip = past.slip;
        let new_slip = [0, 1, 2].map(|a| choose(&slides, slid[a], slip[a]));
        let (old, new) = (scale(slip, failed), scale(new_slip, failed));
        let held = scale(sub(shear, new), modulus);
        let sum = add(shear, past.shear);
        let work = dot(sub(new, old), sum) - dot(new, new_slip) + dot(old, slip);
        let mut dissipated = Lanes::of(|k| memory[k].dissipated) + modulus * work * Lanes::splat(0.5);
        if which & bits(&crushes) != 0 {
            let last = Lanes::of(|k| memory[k].last[0]);
            let (old_pull, old_energy) = stress_and_energy(last + self.plastic_strains(crushed), failed, young);
            let work = (pull + old_pull) * (normal - last) * Lanes::splat(0.5) - (energy - old_energy);
            dissipated = choose(&crushes, dissipated + work, dissipated);
        }
        for k in (0..W).filter(|k| steady >> k & 1 == 1) {
            (memory[k].crushed, memory[k].dissipated) = (now.0[k], dissipated.0[k]);
            stress.0[k] = pull.0[k];
            for a in 0..3 {
                across[a].0[k] = held[a].0[k];
                past.slip[a].0[k] = new_slip[a].0[k];
            }
        }
        [steady, steady & bits(&slides)]
    }

    /// Whether whole interfaces under these loads stay without damage; not known of all where tension and shear act together.
    #[inline(always)]
    fn keeps_damage<const W: usize>(&self, elastic: Lanes<W>, compression: Lanes<W>, shear: Lanes<W>) -> [bool; W] {
        let (cohesive, coupled) = (self.is_cohesive(), self.failure == InterfaceFailure::Coupled);
        each(|k| {
            let apart = (self.young_modulus * elastic.0[k] <= self.tensile_strength)
                & (shear.0[k] - self.internal_friction * compression.0[k] <= self.shear_strength);
            cohesive & apart & (!coupled | (elastic.0[k] <= 0.0))
        })
    }

    /// Compressive strains that stay without load.
    #[inline(always)]
    fn plastic_strains<const W: usize>(&self, crushed: Lanes<W>) -> Lanes<W> {
        let (mut stress, mut begin, mut slope) =
            (Lanes::splat(0.0), Lanes::splat(0.0), Lanes::splat(self.young_modulus));
        for [limit, strain, tangent] in self.crushing.lines(self.young_modulus) {
            let beyond = each(|k| crushed.0[k] > strain);
            stress = choose(&beyond, Lanes::splat(limit), stress);
            begin = choose(&beyond, Lanes::splat(strain), begin);
            slope = choose(&beyond, Lanes::splat(tangent), slope);
        }
        let borne = stress + slope * (crushed - begin);
        Lanes::of(|k| crushed.0[k] - borne.0[k] / self.young_modulus)
    }
}

/// Stresses and elastic energies per volume of whole or separated interfaces.
#[inline(always)]
fn stress_and_energy<const W: usize>(elastic: Lanes<W>, failed: Lanes<W>, young: Lanes<W>) -> (Lanes<W>, Lanes<W>) {
    let whole = Lanes::of(|k| if elastic.0[k] > 0.0 { 1.0 - failed.0[k] } else { 1.0 });
    let stress = whole * young * elastic;
    (stress, stress * elastic * Lanes::splat(0.5))
}
