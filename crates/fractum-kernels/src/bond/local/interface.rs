//! Stress against strain at the interface of two particles: damage, friction, plastic compression.

use serde::{Deserialize, Serialize};

use super::LocalBond;
#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;

/// When an interface fails under tension and shear together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InterfaceFailure {
    /// Tension and shear damage the interface each for itself, until one of them has separated it.
    #[default]
    Uncoupled,
    /// One damage for both, with the root of the sum of squares of their ratios to the strengths.
    Coupled,
}

/// Plastic compression: straight lines beyond three limits of the stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crushing {
    /// Compressive stresses at which the lines begin [Pa], ascending (LCS1 to LCS3 of the source).
    pub stress: [f64; 3],
    /// Young's modulus over the slope of each line, at least 1 (YRC1 to YRC3 of the source).
    pub ratio: [f64; 3],
}

impl Crushing {
    /// Elastic at any stress.
    pub const NONE: Crushing = Crushing { stress: [f64::INFINITY; 3], ratio: [1.0; 3] };

    /// Stress and strain at which each line begins, and its slope; not numbers beyond an infinite stress.
    #[inline(always)]
    pub(super) fn lines(&self, young_modulus: f64) -> [[f64; 3]; 3] {
        let mut lines = [[0.0; 3]; 3];
        let mut last = [0.0, 0.0, young_modulus];
        for k in 0..3 {
            let [stress, begin, slope] = last;
            last = [self.stress[k], begin + (self.stress[k] - stress) / slope, young_modulus / self.ratio[k]];
            lines[k] = last;
        }
        lines
    }

    /// Compressive stress [Pa] at a compressive strain that grows from zero.
    #[inline]
    fn stress_at(&self, young_modulus: f64, strain: f64) -> f64 {
        let below = |line: &[f64; 3]| strain > line[1];
        let lines = self.lines(young_modulus);
        let [stress, begin, slope] = lines.into_iter().rfind(below).unwrap_or([0.0, 0.0, young_modulus]);
        stress + slope * (strain - begin)
    }
}

/// How an interface separated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Separation {
    /// In tension.
    Tension,
    /// In shear.
    Shear,
}

/// What an interface remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct InterfaceMemory {
    /// Largest compressive strain, once it has passed the elastic limit.
    pub(super) crushed: f64,
    /// Damage in tension and in shear, 0 to 1.
    pub(super) damage: [f64; 2],
    /// Strain by which the failed part has slipped, in axes that turn with the first particle.
    pub(super) slip: [f64; 3],
    /// Normal strain and shear strain of the last step; the latter in axes that turn with the first particle where the interface is not whole.
    pub(super) last: [f64; 4],
    /// Energy dissipated so far, per volume of the bond [J/m³].
    pub(super) dissipated: f64,
    /// How it separated; never where it had no strength from the start.
    pub(super) separation: Option<Separation>,
}

impl InterfaceMemory {
    /// Whether nothing but elastic strain has happened.
    #[inline]
    pub(super) fn is_whole(&self) -> bool {
        self.crushed == 0.0 && self.damage == [0.0; 2]
    }

    /// Whether no cohesion is left.
    #[inline]
    pub(super) fn is_separated(&self) -> bool {
        self.damage[0] >= 1.0
    }
}

/// What every step reads and writes of interfaces side by side.
#[derive(Clone, Copy, Debug)]
pub struct RecentStrains<const W: usize> {
    /// Normal strain and shear strain of the last step.
    pub(super) last: [[f64; W]; 4],
    /// Interfaces that something other than elastic strain has happened to, as bits.
    pub(super) inelastic: u32,
    /// Interfaces that have separated, as bits.
    pub(super) separated: u32,
}

impl<const W: usize> Default for RecentStrains<W> {
    #[inline]
    fn default() -> Self {
        RecentStrains { last: [[0.0; W]; 4], inelastic: 0, separated: 0 }
    }
}

impl<const W: usize> RecentStrains<W> {
    #[inline]
    pub(super) fn recall(&self, memory: &InterfaceMemory, lane: usize) -> InterfaceMemory {
        let last = if self.inelastic >> lane & 1 == 1 { memory.last } else { self.last.map(|of| of[lane]) };
        InterfaceMemory { last, ..*memory }
    }

    #[inline]
    pub(super) fn remember(&mut self, memory: &InterfaceMemory, lane: usize) {
        (0..4).for_each(|k| self.last[k][lane] = memory.last[k]);
        let set = |bits: u32, on: bool| bits & !(1 << lane) | u32::from(on) << lane;
        self.inelastic = set(self.inelastic, !memory.is_whole());
        self.separated = set(self.separated, memory.separation.is_some());
    }
}

#[inline]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
fn times(a: [f64; 3], factor: f64) -> [f64; 3] {
    a.map(|a| a * factor)
}

#[inline]
fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    core::array::from_fn(|k| a[k] - b[k])
}

/// Damage at a load `ratio` times the strength, if the force falls on a line to zero at `end` times the elastic limit.
#[inline]
fn softened(ratio: f64, end: f64) -> f64 {
    if ratio <= 1.0 {
        0.0
    } else if ratio >= end {
        1.0
    } else {
        1.0 - (end - ratio) / (ratio * (end - 1.0))
    }
}

/// Load over strength; without strength any load is too much.
#[inline]
fn ratio(load: f64, strength: f64) -> f64 {
    if load > 0.0 { load / strength } else { 0.0 }
}

/// Part of the strength by which friction may be exceeded: rounding.
pub(super) const ROUND_OFF: f64 = 1e-12;

impl LocalBond {
    /// Compressive strain that stays without load.
    #[inline]
    fn plastic_strain(&self, memory: &InterfaceMemory) -> f64 {
        match memory.crushed {
            0.0 => 0.0,
            crushed => crushed - self.crushing.stress_at(self.young_modulus, crushed) / self.young_modulus,
        }
    }

    /// Stress and elastic energy per volume at a normal strain.
    #[inline]
    fn normal(&self, strain: f64, memory: &InterfaceMemory) -> [f64; 2] {
        let elastic = strain + self.plastic_strain(memory);
        let whole = if elastic > 0.0 { 1.0 - memory.damage[0] } else { 1.0 };
        let stress = whole * self.young_modulus * elastic;
        [stress, 0.5 * stress * elastic]
    }

    /// Whether an interface that has separated is in contact at a normal strain.
    #[inline]
    pub(super) fn is_closed(&self, strain: f64, memory: &InterfaceMemory) -> bool {
        strain + self.plastic_strain(memory) < 0.0
    }

    /// Interfaces, as bits, that stay whole at these strains if they are.
    #[inline(always)]
    pub(super) fn stay_whole<const W: usize>(&self, normal: &[f64; W], shear_square: &[f64; W]) -> u32 {
        if !self.is_cohesive() {
            return 0;
        }
        let modulus = self.shear_modulus();
        let (square, coupled) = (modulus * modulus, self.failure == InterfaceFailure::Coupled);
        let whole = |k: usize| {
            let stress = self.young_modulus * normal[k];
            let strength = self.shear_strength + self.internal_friction * (-stress).max(0.0);
            let (shear, most) = (square * shear_square[k], strength * strength);
            let apart = (stress <= self.tensile_strength) & (-stress <= self.crushing.stress[0]) & (shear <= most);
            // Under pressure both criteria are one.
            let together = || stress <= 0.0 || (stress / self.tensile_strength).powi(2) + shear / most <= 1.0;
            apart && (!coupled || together())
        };
        let mut bits = 0;
        for k in 0..W {
            bits |= u32::from(whole(k)) << k;
        }
        bits
    }

    /// Stresses at the present strains (normal, and a vector across), and the slip; carries the memory on.
    ///
    /// - `slip`, `from`: slip and last shear strain of the memory in the axes of `shear`
    #[inline]
    pub(super) fn stress(
        &self,
        normal: f64,
        shear: [f64; 3],
        [slip, from]: [[f64; 3]; 2],
        memory: &mut InterfaceMemory,
    ) -> (f64, [f64; 3], [f64; 3]) {
        let before = *memory;
        let yields = self.crushing.stress[0] / self.young_modulus;
        if -normal > before.crushed.max(yields) {
            memory.crushed = -normal;
        }
        let elastic = normal + self.plastic_strain(memory);
        let compression = self.young_modulus * (-elastic).max(0.0);
        self.damage(elastic, dot(shear, shear).sqrt(), compression, memory);
        let [stress, energy] = self.normal(normal, memory);
        let modulus = self.shear_modulus();
        let failed = memory.damage[1];
        let new_slip = if failed > 0.0 { self.slipped(shear, slip, compression) } else { slip };
        let (old, new) = (times(slip, before.damage[1]), times(new_slip, failed));
        let across = times(minus(shear, new), modulus);
        // Work by the trapezoid of the stresses less what is stored: that of the slip, then that along the normal.
        let (last, sum) = (before.last[0], core::array::from_fn(|k| shear[k] + from[k]));
        memory.dissipated += 0.5 * modulus * (dot(minus(new, old), sum) - dot(new, new_slip) + dot(old, slip));
        if memory.crushed != before.crushed || memory.damage[0] != before.damage[0] {
            let [old_stress, old_energy] = self.normal(last, &before);
            memory.dissipated += 0.5 * (stress + old_stress) * (normal - last) - (energy - old_energy);
        }
        (stress, across, new_slip)
    }

    /// Lets damage grow.
    #[inline]
    fn damage(&self, elastic: f64, shear: f64, compression: f64, memory: &mut InterfaceMemory) {
        if memory.is_separated() {
            return;
        }
        if !self.is_cohesive() {
            memory.damage = [1.0; 2];
            return;
        }
        let tension = ratio(self.young_modulus * elastic, self.tensile_strength);
        let load = self.shear_modulus() * shear - self.internal_friction * compression;
        let sliding = ratio(load, self.shear_strength);
        let [end_tension, end_shear] = self.softening.map(|h| 1.0 + 1.0 / h);
        let grown = match self.failure {
            InterfaceFailure::Uncoupled => [softened(tension, end_tension), softened(sliding, end_shear)],
            InterfaceFailure::Coupled => {
                let square = tension * tension + sliding * sliding;
                if square <= 1.0 {
                    return;
                }
                // Without strength the ratio has no bound.
                let share = if tension.is_finite() { tension * tension / square } else { 1.0 };
                let share = if sliding.is_finite() { share } else { 0.0 };
                [softened(square.sqrt(), share * end_tension + (1.0 - share) * end_shear); 2]
            }
        };
        (0..2).for_each(|k| memory.damage[k] = memory.damage[k].max(grown[k]));
        if memory.damage.contains(&1.0) {
            let by_shear = grown[1] >= 1.0 && (grown[0] < 1.0 || sliding > tension);
            memory.separation = Some(if by_shear { Separation::Shear } else { Separation::Tension });
            memory.damage = [1.0; 2];
        }
    }

    /// The memory of an interface that was whole and separates at once, and rubs where it is closed.
    ///
    /// - `normal`, `shear`: normal strain, and shear strain in the axes of the first particle
    #[inline]
    pub(super) fn separated_memory(&self, how: Separation, normal: f64, shear: [f64; 3]) -> InterfaceMemory {
        let compression = self.young_modulus * (-normal).max(0.0);
        let slip = self.slipped(shear, [0.0; 3], compression);
        let last = [normal, shear[0], shear[1], shear[2]];
        InterfaceMemory { damage: [1.0; 2], slip, last, separation: Some(how), ..InterfaceMemory::default() }
    }

    /// Slip of the failed part under Coulomb's law.
    #[inline]
    fn slipped(&self, shear: [f64; 3], slip: [f64; 3], compression: f64) -> [f64; 3] {
        let most = self.friction * compression;
        let modulus = self.shear_modulus();
        let trial = times(minus(shear, slip), modulus);
        let size = dot(trial, trial).sqrt();
        if size <= most * (1.0 + ROUND_OFF) { slip } else { minus(shear, times(trial, most / (size * modulus))) }
    }

    /// Elastic energy per volume of a bond at a normal strain and a shear strain, along and across.
    #[inline]
    pub(super) fn stored(&self, normal: f64, shear: [f64; 3], slip: [f64; 3], memory: &InterfaceMemory) -> [f64; 2] {
        let [_, along] = self.normal(normal, memory);
        let failed = memory.damage[1];
        let held = minus(shear, slip);
        let across = (1.0 - failed) * dot(shear, shear) + failed * dot(held, held);
        [along, 0.5 * self.shear_modulus() * across]
    }
}
