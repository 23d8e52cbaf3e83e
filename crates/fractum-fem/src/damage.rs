//! Damage on the edges of a smoothed body.

use std::sync::Arc;

use fractum_math::Sym3;
use serde::{Deserialize, Serialize};

use crate::kernel::{CellLaw, Hooke};
use crate::material::DamageLaw;

/// History of one edge.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EdgeDamage {
    /// Largest equivalent stress so far [Pa]; starts at the strength.
    pub kappa: f64,
    /// Damage d, 0 to 1.
    pub damage: f64,
    /// Strain at the last step, kept from the onset of damage on.
    pub strain: Sym3,
    /// Whether the residual stress ratio has fallen to the limit.
    pub broken: bool,
}

impl EdgeDamage {
    /// An edge that nothing has happened to yet.
    pub(crate) fn intact(strength: f64) -> Self {
        EdgeDamage { kappa: strength, damage: 0.0, strain: Sym3::ZERO, broken: false }
    }

    /// What the cheap test compares with: never passed by a damaged edge.
    pub(crate) fn threshold(&self) -> f64 {
        if self.damage > 0.0 { f64::NEG_INFINITY } else { self.kappa }
    }
}

/// Law and constants shared by all edges of a body.
#[derive(Clone, Debug)]
pub(crate) struct Softens {
    pub(crate) law: DamageLaw,
    pub(crate) hooke: Hooke,
    pub(crate) young_modulus: f64,
}

impl Softens {
    /// Part of the effective stress that damage leaves alone.
    fn closed_stress(&self, strain: Sym3) -> Sym3 {
        if self.law.unilateral { compressive_stress(&self.hooke, strain) } else { Sym3::ZERO }
    }

    /// Advances the history of an edge to the equivalent stress `q`; returns the growth of damage.
    pub(crate) fn load(&self, edge: &mut EdgeDamage, q: f64, strength: f64, length: f64, dt: f64) -> f64 {
        if q <= edge.kappa {
            return 0.0;
        }
        let law = &self.law;
        edge.kappa += (q - edge.kappa) * if law.rate_time > 0.0 { (dt / law.rate_time).min(1.0) } else { 1.0 };
        let chi = law.softening.residual_ratio(edge.kappa, strength, length, self.young_modulus, law.fracture_energy);
        let before = edge.damage;
        edge.damage = before.max(1.0 - strength / edge.kappa * chi);
        edge.broken = edge.broken || chi <= law.residual;
        edge.damage - before
    }
}

/// The edges of one block.
#[derive(Clone, Debug)]
pub(crate) struct EdgeCells {
    pub(crate) softens: Arc<Softens>,
    pub(crate) edges: Vec<EdgeDamage>,
    /// Equivalent stress [Pa] below which an edge is known to stay intact; negative once it is damaged.
    pub(crate) threshold: Vec<f64>,
    /// Strength [Pa] of each edge; infinite where damage may not occur.
    pub(crate) strength: Vec<f64>,
    /// Characteristic length [m] of each edge.
    pub(crate) length: Vec<f64>,
    /// Energy dissipated in this block so far [J].
    pub(crate) dissipated: f64,
    /// An edge of this block broke in the last step.
    pub(crate) fresh: bool,
    pub(crate) dt: f64,
    /// Elastic energy of the last step, where it was asked for [J].
    pub(crate) energy: Option<f64>,
}

impl EdgeCells {
    /// Energy density that damage acts on [J/m³].
    pub(crate) fn opening_energy_density(&self, strain: Sym3) -> f64 {
        0.5 * (self.softens.hooke.stress(strain) - self.softens.closed_stress(strain)).dot(strain)
    }

    /// Takes over the strain that an edge has all at once because elements around it left; what damage this brings acts at
    /// that strain.
    pub(crate) fn settle(&mut self, cell: usize, strain: Sym3, volume: f64) {
        let stress = self.softens.hooke.stress(strain);
        if self.softens.law.criterion.surely_below(stress, self.threshold[cell]) {
            return;
        }
        let energy = self.energy.take();
        self.edges[cell].strain = strain;
        self.loaded_stress(cell, strain, stress, volume, Some(strain));
        self.energy = energy;
    }

    /// The path of an edge that is damaged or may become so.
    ///
    /// - `before`: strain at the last step, where it is known better than by the edge's own history
    #[inline(never)]
    fn loaded_stress(&mut self, cell: usize, strain: Sym3, stress: Sym3, volume: f64, before: Option<Sym3>) -> Sym3 {
        let softens = Arc::as_ref(&self.softens);
        let edge = &mut self.edges[cell];
        let (was_broken, was_intact) = (edge.broken, edge.damage == 0.0);
        let closed = softens.closed_stress(strain);
        let opening = stress - closed;
        // Below its history an edge only unloads: no eigenvalues.
        let (q, growth) = if softens.law.criterion.surely_below(stress, edge.kappa) {
            (0.0, 0.0)
        } else {
            let q = softens.law.criterion.equivalent_stress(stress);
            (q, softens.load(edge, q, self.strength[cell], self.length[cell], self.dt))
        };
        self.threshold[cell] = edge.threshold();
        if growth > 0.0 {
            // The work of the step between the strains ε⁰ and ε¹ minus the change of the stored energy is exactly
            // ½ σ¹ : ε⁰ per damage. An edge that was intact has kept no strain: it is taken at its strength.
            let kept = if was_intact { strain * (self.strength[cell] / q) } else { edge.strain };
            let before = before.unwrap_or(kept);
            self.dissipated += 0.5 * opening.dot(before) * growth * volume;
        }
        edge.strain = strain;
        self.fresh |= edge.broken && !was_broken;
        let nominal = opening * (1.0 - edge.damage) + closed;
        if let Some(energy) = &mut self.energy {
            *energy += 0.5 * nominal.dot(strain) * volume;
        }
        nominal * volume
    }
}

impl CellLaw for EdgeCells {
    #[inline(always)]
    fn scaled_stress(&mut self, cell: usize, strain: Sym3, volume: f64) -> Sym3 {
        let stress = self.softens.hooke.stress(strain);
        if self.softens.law.criterion.surely_below(stress, self.threshold[cell]) {
            if let Some(energy) = &mut self.energy {
                *energy += 0.5 * stress.dot(strain) * volume;
            }
            return stress * volume;
        }
        self.loaded_stress(cell, strain, stress, volume, None)
    }

    #[inline(always)]
    fn integrity(&self, cell: usize) -> f64 {
        1.0 - self.edges[cell].damage
    }
}

/// Stress of the compressive part of the strain, λ⟨tr ε⟩₋ + 2μ ε₋ (Miehe's spectral split).
fn compressive_stress(hooke: &Hooke, strain: Sym3) -> Sym3 {
    let (values, directions) = strain.eigen();
    let mut part = fractum_math::Mat3::zeros();
    for (i, value) in values.into_iter().enumerate() {
        let n = directions.column(i);
        part += (n * n.transpose()) * value.min(0.0);
    }
    let stress =
        Sym3::symmetric_part(&part) * (2.0 * hooke.mu) + Sym3::isotropic(hooke.lambda * strain.trace().min(0.0));
    Sym3([stress.0[0], stress.0[1], hooke.zz * stress.0[2], stress.0[3], stress.0[4], stress.0[5]])
}
