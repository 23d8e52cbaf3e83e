//! Regularised damage: a cohesive phase field whose unknown sits on the edges, where damage lives.
//!
//! Every edge has a value d that never falls, 0 intact and 1 parted, and a stiffness ω(d) ([`Degradation`]). With Y, the largest
//! q²/2E that it has seen and at least f_t²/2E, the values solve
//!
//! R_g = V_g \[ω'(d_g) Y_g + k (1 - d_g)\] + c (L d)_g = 0, or ≥ 0 where d_g does not grow; k = 2 G_f/(π b), c = 2 b G_f/π,
//!
//! with the Laplacian L of a field on edges and one length b for the body. Without L this would be a local law; with it a crack is a band of
//! width π b whatever the mesh, and dissipates G_f per area. Only active edges take part, those that have
//! seen their strength and those beside a damaged one.
//!
//! Wu, *J. Mech. Phys. Solids* 103 (2017) 72-99, and 119 (2018) 20-42; the unknown on edges is our own.

mod laplacian;
mod rest;

use std::f64::consts::PI;

use fractum_kernels::damage::{Seen, Taken};
use fractum_kernels::material::{Degradation, Softening};
use fractum_math::{FOUR, Lane, widest};
use rayon::prelude::*;

use crate::body::edges::BodyEdges;
use crate::body::{Body, DamageZone, ElementKind, Formulation};
use crate::cells::cell::Geometry;
use crate::error::SolidError;
use laplacian::Rows;

/// Value from which on the neighbours of an edge are active.
const SPREADS: f64 = 1e-4;
/// Sweeps of a step of motion.
const SWEEPS: usize = 2;
/// a₁ beyond the least one: beside a band damage falls off over b/√(2 (a₁ - least)), over 0.8 b at most with this, to less than 0.01 four lengths
/// away. Without it damage reaches further and further as b nears its bound, and under a load near the strength goes through the body a little sooner.
const BEYOND_LEAST: f64 = 0.8;
/// Edges that one thread takes at least.
pub(crate) const AT_LEAST: usize = 512;

/// Constants of a regularised body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PhaseLaw {
    pub(crate) degradation: Degradation,
    /// b [m].
    pub(crate) length: f64,
    /// Mean size of the elements where damage may occur [m].
    pub(crate) size: f64,
    /// k [J/m³].
    resistance: f64,
    /// c [J/m].
    gradient: f64,
    /// 4 E G_f/(π b) [Pa²], a₁ times f_t².
    strength_scale: f64,
    /// The smallest a₁ that an edge may have.
    least_a1: f64,
}

impl PhaseLaw {
    /// The law of a body.
    ///
    /// - `sizes`: length b, and mean size of the elements where cracks go [m]
    ///
    /// # Errors
    /// [`SolidError::NotRegularised`] for what does not go with a phase field.
    pub(crate) fn of(body: &Body, zone: &DamageZone, [length, size]: [f64; 2]) -> Result<Self, SolidError> {
        let refuse = |reason, expected| Err(SolidError::NotRegularised { body: body.name.clone(), reason, expected });
        if zone.law.rate_time > 0.0 {
            return refuse("a rate time, which would act as toughness", "rate_time = 0");
        }
        // Measured on tension bars with Poisson's ratio 0 (three meshes of triangles, one of tetrahedra), without end of the opening
        // and on a straight line: elements leave d in the middle of the band below its peak, plain ones average the stiffness of
        // their edges instead of the strain, and a curve that ends takes more of the last elements before they leave.
        let (endless, straight) = match (body.formulation, body.shape) {
            (Formulation::Smoothed, ElementKind::T3) => (0.03, -0.08),
            (Formulation::Smoothed, ElementKind::T4) => (0.08, -0.04),
            (Formulation::Standard, ElementKind::T3) => (-0.23, -0.25),
            (Formulation::Standard, ElementKind::T4) => (-0.28, -0.31),
        };
        let lost = match zone.law.softening {
            Softening::Exponential => endless,
            Softening::Linear => straight,
            Softening::Bilinear { .. } => 0.5 * (endless + straight),
        };
        let fracture_energy = zone.law.fracture_energy * (1.0 + lost * size / length);
        let degradation = Degradation::new(zone.law.softening);
        Ok(PhaseLaw {
            degradation,
            length,
            size,
            resistance: 2.0 * fracture_energy / (PI * length),
            gradient: 2.0 * length * fracture_energy / PI,
            strength_scale: 4.0 * body.opening_modulus() * fracture_energy / (PI * length),
            least_a1: degradation.least_a1() + BEYOND_LEAST,
        })
    }

    pub(crate) fn a1(&self, strength: f64) -> f64 {
        self.strength_scale / (strength * strength)
    }

    /// Part of the stress across a crack that is left, ω.
    #[inline(always)]
    pub(crate) fn stiffness(&self, a1: f64, d: f64) -> f64 {
        self.degradation.stiffness(a1, d)
    }

    /// Largest b that an edge of this strength allows [m].
    pub(crate) fn largest_length(&self, strength: f64) -> f64 {
        self.length * self.a1(strength) / self.least_a1
    }
}

/// What drives an edge in a step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Drive {
    /// V_g [m³].
    pub(crate) volume: f64,
    /// Y_g [J/m³].
    pub(crate) energy: f64,
    pub(crate) a1: f64,
}

/// An edge that takes part.
#[derive(Clone, Debug)]
pub(crate) struct ActiveEdge {
    pub(crate) edge: u32,
    /// The process that sweeps it.
    pub(crate) rank: u32,
    pub(crate) drive: Drive,
    /// d at the end of the step before, and of the one before that.
    old: f64,
    before: f64,
    pub(crate) next: f64,
    /// Its neighbours are active.
    spread: bool,
    /// Elements around it have left since the last forces, so that the stress of what is left did not act at the start of the step.
    pub(crate) rebuilt: bool,
}

/// What an active edge of smoothed cells sees and gives in a step of motion; the standard formulation keeps the one and books the other itself.
#[derive(Clone, Debug)]
pub(crate) struct EdgeStep {
    /// What it sees now, where that is more than ever before.
    pub(crate) seen: Seen,
    /// What damage takes if it grows [J].
    pub(crate) taken: Taken,
    /// The edge had no damage at the step before, and `taken` is not known yet.
    pub(crate) is_intact: bool,
    /// ω now, where d has grown.
    pub(crate) stiffness: f64,
}

/// The phase field of a body.
#[derive(Clone, Debug)]
pub(crate) struct PhaseField {
    pub(crate) law: PhaseLaw,
    /// d of every edge of the body.
    pub(crate) value: Vec<f64>,
    pub(crate) active: Vec<ActiveEdge>,
    /// The present step of every active edge.
    pub(crate) steps: Vec<EdgeStep>,
    /// Place in `active` of every edge, [`PhaseField::ASLEEP`] if it is not there.
    slot: Vec<u32>,
    /// Whether some of every [`AT_LEAST`] edges are active; the rest costs nothing in a step.
    awake: Vec<bool>,
    /// The same of the edges of every block of cells, up to the last with such edges.
    awake_blocks: Vec<bool>,
    rows: Rows,
    /// The process whose active edges are advanced here.
    pub(crate) rank: u32,
}

impl PhaseField {
    const ASLEEP: u32 = u32::MAX;

    /// The intact field of a body.
    pub(crate) fn new(law: PhaseLaw, edges: usize) -> Self {
        let (value, slot) = (vec![0.0; edges], vec![Self::ASLEEP; edges]);
        PhaseField {
            law,
            value,
            active: Vec::new(),
            steps: Vec::new(),
            slot,
            awake: vec![false; edges.div_ceil(AT_LEAST)],
            awake_blocks: Vec::new(),
            rows: Rows::default(),
            rank: 0,
        }
    }

    pub(crate) fn is_active(&self, edge: u32) -> bool {
        self.slot[edge as usize] != Self::ASLEEP
    }

    /// Leaves each edge to the process that `rank_of` says; this one is number `rank`.
    pub(crate) fn distribute(&mut self, rank: u32, rank_of: impl Fn(u32) -> u32) {
        self.rank = rank;
        self.active.iter_mut().for_each(|own| own.rank = rank_of(own.edge));
    }

    /// Lets an edge of a rank take part from now on.
    pub(crate) fn activate(&mut self, patch: &Patch<'_>, (edge, rank): (u32, u32), a1: f64) {
        self.slot[edge as usize] = self.active.len() as u32;
        self.awake[edge as usize / AT_LEAST] = true;
        self.rows.push(&patch.geometry, patch.edges, (edge, &patch.edges.around(edge)), patch.alive);
        self.active.push(ActiveEdge {
            edge,
            rank,
            drive: Drive { a1, ..Drive::default() },
            old: 0.0,
            before: 0.0,
            next: 0.0,
            spread: false,
            rebuilt: false,
        });
        self.steps.push(EdgeStep { seen: Seen::NOTHING, taken: Taken::default(), is_intact: false, stiffness: 1.0 });
    }

    /// Some edge of a block of cells takes part from now on.
    pub(crate) fn wake_block(&mut self, block: usize) {
        let count = self.awake_blocks.len().max(block + 1);
        self.awake_blocks.resize(count, false);
        self.awake_blocks[block] = true;
    }

    /// Whether some edge of a block of cells takes part.
    pub(crate) fn has_block(&self, block: usize) -> bool {
        self.awake_blocks.get(block).is_some_and(|awake| *awake)
    }

    /// Puts the active edges in the order of `place`, that of memory, when an eighth to a quarter more are active than last time.
    ///
    /// - `before`: how many were active before the last were added
    pub(crate) fn arrange(&mut self, before: usize, place: impl Fn(u32) -> (u32, u32)) {
        let stage = |count: usize| (count.max(4).ilog2(), count >> (count.max(4).ilog2() - 2));
        if stage(before) == stage(self.active.len()) {
            return;
        }
        let mut order: Vec<usize> = (0..self.active.len()).collect();
        order.sort_by_key(|&row| place(self.active[row].edge));
        self.active = order.iter().map(|&row| self.active[row].clone()).collect();
        self.rows = self.rows.in_order(&order);
        for (own, row) in self.active.iter().zip(0..) {
            self.slot[own.edge as usize] = row;
        }
    }

    /// Area of crack in the volume of an edge [1/m]: for the profile of a full crack half of it is that of the gradient.
    pub(crate) fn area_density(&self, edge: usize) -> f64 {
        let d = self.value[edge];
        2.0 * d * (2.0 - d) / (PI * self.law.length)
    }

    /// Takes the share of removed elements out of the rows of these edges.
    pub(crate) fn refresh(&mut self, patch: &Patch<'_>, edges: &[u32]) {
        for &edge in edges.iter().filter(|&&edge| self.slot[edge as usize] != Self::ASLEEP) {
            let (around, slot) = (patch.edges.around(edge), self.slot[edge as usize] as usize);
            self.active[slot].rebuilt = true;
            self.rows.refresh(slot, &patch.geometry, patch.edges, &around, patch.alive);
        }
    }

    /// Active edges, each with d, d of the step before, and whether elements have left it since the last forces.
    pub(crate) fn state(&self) -> impl Iterator<Item = (u32, [f64; 2], bool)> + '_ {
        self.active.iter().map(|active| (active.edge, [active.old, active.before], active.rebuilt))
    }

    /// Nothing is active any more.
    pub(crate) fn clear(&mut self) {
        self.value.fill(0.0);
        self.slot.fill(Self::ASLEEP);
        self.awake.fill(false);
        self.awake_blocks.clear();
        self.active.clear();
        self.steps.clear();
        self.rows.clear();
    }

    /// Gives the edge that became active last its saved values.
    pub(crate) fn restore_last(&mut self, [old, before]: [f64; 2], rebuilt: bool) {
        let Some(last) = self.active.last_mut() else { return };
        (last.old, last.before, last.rebuilt) = (old, before, rebuilt);
        self.value[last.edge as usize] = old;
    }

    /// (L d) of the active edges.
    #[cfg(test)]
    pub(crate) fn laplacian<'a>(&'a self, field: &'a [f64]) -> impl Iterator<Item = (u32, f64)> + 'a {
        let flow = |row: usize| self.rows.products(row / FOUR, field).0[row % FOUR];
        self.active.iter().enumerate().map(move |(row, own)| (own.edge, flow(row)))
    }

    /// What a sweep divides by in the row of every edge.
    #[cfg(test)]
    pub(crate) fn bounds(&self) -> nalgebra::DVector<f64> {
        let mut bounds = nalgebra::DVector::zeros(self.value.len());
        for (row, own) in self.active.iter().enumerate() {
            bounds[own.edge as usize] = self.rows.bounds(row / FOUR).0[row % FOUR];
        }
        bounds
    }

    /// Advances d by a step of motion with the drives of its end.
    ///
    /// Begins with the growth of the step before; two sweeps then are as good as the exact solution.
    ///
    /// - `exchange`: gets the d of edges that are advanced elsewhere, after each sweep
    pub(crate) fn sweep(&mut self, mut exchange: impl FnMut(&mut [ActiveEdge])) {
        let PhaseField { law, value, active, slot, awake, rows, rank, .. } = self;
        let rank = *rank;
        let placed = (&slot[..], &awake[..]);
        spread(value, placed, |slot| {
            let own = &active[slot];
            (own.old + (own.old - own.before)).min(1.0)
        });
        for _ in 0..SWEEPS {
            let field = &*value;
            active.par_chunks_mut(FOUR).enumerate().with_min_len(AT_LEAST / FOUR).for_each(|(group, four)| {
                if four.iter().any(|own| own.rank == rank) {
                    sweep_four(law, rows, group, field, four);
                }
            });
            exchange(active);
            spread(value, placed, |slot| active[slot].next);
        }
    }

    /// Finds the damage of the edges whose d has grown, and what it takes of intact ones by `taken(edge)` [J].
    pub(crate) fn book(&mut self, taken: impl Fn(&ActiveEdge) -> Taken + Sync) {
        let PhaseField { law, value, active, steps, rank, .. } = self;
        let rank = *rank;
        active.par_iter().zip(steps).with_min_len(AT_LEAST).for_each(|(own, step)| {
            let d = value[own.edge as usize];
            if d > own.old && own.rank == rank {
                step.stiffness = law.stiffness(own.drive.a1, d);
                if step.is_intact {
                    step.taken = taken(own);
                }
            }
        });
    }

    /// The step of an edge that this rank has and that has seen more than before, or whose d has grown; and whether it has.
    pub(crate) fn change(&self, edge: u32) -> Option<(&EdgeStep, bool)> {
        let slot = self.slot[edge as usize];
        let own = self.active.get(slot as usize)?;
        let (step, grown) = (&self.steps[slot as usize], self.value[edge as usize] > own.old);
        (own.rank == self.rank && (grown || step.seen.stress > 0.0)).then_some((step, grown))
    }

    /// Takes d over.
    pub(crate) fn end_step(&mut self) {
        let PhaseField { value, active, .. } = self;
        active.par_iter_mut().with_min_len(AT_LEAST).for_each(|own| {
            (own.before, own.old, own.rebuilt) = (own.old, value[own.edge as usize], false);
        });
    }

    /// Takes over values found at rest.
    pub(crate) fn take_rest(&mut self, found: &[f64], mut work: impl FnMut(&ActiveEdge, f64)) {
        for own in &mut self.active {
            let value = found[own.edge as usize];
            work(own, value);
            self.value[own.edge as usize] = value;
            (own.before, own.old) = (value, value);
        }
    }

    /// Raises the damage of edges of the body to that of these values.
    ///
    /// - `share`: part of the largest principal stress that belongs to the opening of an edge
    pub(crate) fn raise(&self, value: &[f64], share: impl Fn(u32) -> f64, damage: &mut [f64]) {
        for own in &self.active {
            let damage = &mut damage[own.edge as usize];
            let stiffness = self.law.stiffness(own.drive.a1, value[own.edge as usize]);
            *damage = damage.max(1.0 - share(own.edge) * stiffness);
        }
    }

    /// Edges beside damaged ones that are not active yet; each asks once.
    pub(crate) fn newly_reached(&mut self, reached: &mut Vec<u32>) {
        let PhaseField { value, active, rows, slot, .. } = self;
        for (row, own) in active.iter_mut().enumerate() {
            if !own.spread && value[own.edge as usize] > SPREADS {
                own.spread = true;
                reached.extend(rows.edges(row).filter(|&edge| slot[edge as usize] == Self::ASLEEP));
            }
        }
    }
}

/// Gives every active edge a value by its place among them.
///
/// - `placed`: that place, and which runs of edges have active ones
fn spread(value: &mut [f64], (slot, awake): (&[u32], &[bool]), of: impl Fn(usize) -> f64 + Sync) {
    let runs = value.par_chunks_mut(AT_LEAST).zip(slot.par_chunks(AT_LEAST)).zip(awake);
    runs.filter(|(_, awake)| **awake).for_each(|((value, slot), _)| {
        for (value, &slot) in value.iter_mut().zip(slot).filter(|(_, slot)| **slot != PhaseField::ASLEEP) {
            *value = of(slot as usize);
        }
    });
}

widest! {
    /// Sweeps a group of rows, up to four.
    fn sweep_four(law: &PhaseLaw, rows: &Rows, group: usize, field: &[f64], active: &mut [ActiveEdge]) = swept_four;
}

#[inline(always)]
fn swept_four(law: &PhaseLaw, rows: &Rows, group: usize, field: &[f64], active: &mut [ActiveEdge]) {
    let (mut drives, mut d, mut old) = (DriveOfFour::default(), Lane::ZERO, Lane::ZERO);
    for (k, own) in active.iter().enumerate() {
        drives.set(k, &own.drive);
        (d.0[k], old.0[k]) = (field[own.edge as usize], own.old);
    }
    let next = law.swept(&drives, (rows.products(group, field), rows.bounds(group)), d, old);
    for (own, next) in active.iter_mut().zip(next.0) {
        own.next = next;
    }
}

/// The same as [`Drive`], of four edges.
#[derive(Default)]
struct DriveOfFour {
    volume: Lane,
    energy: Lane,
    a1: Lane,
}

impl DriveOfFour {
    #[inline(always)]
    fn set(&mut self, k: usize, drive: &Drive) {
        (self.volume.0[k], self.energy.0[k], self.a1.0[k]) = (drive.volume, drive.energy, drive.a1);
    }
}

impl PhaseLaw {
    /// d of four edges after one sweep.
    ///
    /// - `flow`: (L d); `bound`: that of the row; `d`: now; `old`: at the step before
    #[inline(always)]
    fn swept(&self, drive: &DriveOfFour, (flow, bound): (Lane, Lane), d: Lane, old: Lane) -> Lane {
        let (residual, slope) = self.residual(drive, flow, d);
        let slope = slope + Lane::splat(self.gradient) * bound;
        let next = (d - residual / slope).max(old).min(Lane::splat(1.0));
        Lane::choose(slope.0.map(|slope| slope > 0.0), next, d.max(old))
    }

    /// R_g and the part V max(ω'', 0) Y of its slope.
    #[inline(always)]
    fn residual(&self, &DriveOfFour { volume, energy, a1 }: &DriveOfFour, flow: Lane, d: Lane) -> (Lane, Lane) {
        let [first, second] = self.degradation.derivatives(a1, d);
        let resistance = Lane::splat(self.resistance) * (Lane::splat(1.0) - d);
        let residual = volume * (first * energy + resistance) + Lane::splat(self.gradient) * flow;
        (residual, volume * second.max(Lane::ZERO) * energy)
    }
}

/// What rows are made of.
pub(crate) struct Patch<'a> {
    pub(crate) geometry: Geometry<'a>,
    pub(crate) edges: &'a BodyEdges,
    pub(crate) alive: &'a [bool],
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use fractum_kernels::material::{DamageLaw, Elastic};
    use fractum_mesh::generate::structured_box;

    use super::*;
    use crate::body::Regularisation;
    use crate::solid::Solid;

    #[test]
    fn order_of_active_edges_changes_no_row() {
        let mesh = structured_box([3, 2, 2], fractum_math::Vec3::new(0.03, 0.02, 0.02), None);
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.2 };
        let body = Body::new("block", ElementKind::T4, mesh.tetrahedra, elastic).smoothed();
        let mut body = body.with_damage(DamageLaw::rankine(3e6, 100.0));
        body.damage.as_mut().unwrap().regularisation = Some(Regularisation { length: None });
        let mut solid = Solid::new(mesh.nodes, vec![body]).unwrap();
        crate::motion::phase_edges::wake_phase_fields(&mut solid);
        let field = solid.bodies[0].phase.as_mut().unwrap();
        let d: Vec<f64> = (0..field.value.len()).map(|edge| (edge as f64).sin()).collect();
        let rows = |field: &PhaseField| {
            let bounds = field.bounds();
            field.laplacian(&d).map(|(edge, flow)| (edge, [flow, bounds[edge as usize]])).collect::<BTreeMap<_, _>>()
        };
        let (before, edges) = (rows(field), field.active.len());
        let order = |field: &PhaseField| field.active.iter().map(|own| own.edge).collect::<Vec<_>>();
        let kept = order(field);
        field.arrange(edges, |edge| (0, !edge));
        assert_eq!(order(field), kept);
        field.arrange(0, |edge| (0, !edge));
        assert_eq!(order(field), kept.into_iter().rev().collect::<Vec<_>>());
        assert_eq!(rows(field), before);
        assert!((0..).zip(&field.active).all(|(row, own)| field.slot[own.edge as usize] == row));
    }
}
