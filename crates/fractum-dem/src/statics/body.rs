//! A bonded body at rest while its bonds break, each equilibrium found from the last.

use std::ops::{Add, Mul};

use fractum_math::{Sym3, Vec3};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::conjugate_gradients::Iterate;
use super::lattice::{BLOCK, Dof6, HalfBond, Lattice, LatticeSupports, Stiffness, Tolerance, clear, dot};
use crate::DemError;
use crate::fracture::LoadedBonds;
use crate::fracture::criterion::BondLoad;

/// Bits of the three displacements.
pub(super) const ALL_AXES: u8 = 0b111;

/// Solves after which the unbalanced forces are computed afresh, so that round-off does not add up.
const REFRESH: usize = 32;

/// The first equilibrium is found to this share of the tolerance.
const FIRST: f64 = 0.01;

/// A lattice held by supports, in equilibrium; its bonds break one after another.
///
/// Breaking a bond changes the unbalanced forces of its two particles only, and the next solve starts from there.
#[derive(Clone, Debug)]
pub struct StaticBody {
    lattice: Lattice,
    supports: LatticeSupports,
    /// Forces from outside on every particle, in scaled variables; none where nothing is loaded.
    loads: Vec<Dof6>,
    /// Sums of the sizes of these forces at the start, and of those that were handed over since.
    loads_at_start: f64,
    handed_over: f64,
    iterate: Iterate,
    tolerance: Tolerance,
    /// Square of the support reactions at the first equilibrium: what unbalanced forces are compared with.
    reference: f64,
    solves: usize,
    iterations: usize,
}

/// What a body remembers beside its lattice: scaled displacements and unbalanced forces, and the work so far.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct BodyMemory {
    x: Vec<Dof6>,
    r: Vec<Dof6>,
    loads: Vec<Dof6>,
    handed_over: f64,
    /// Bonds without stiffness.
    loose: Vec<u32>,
    reference: f64,
    solves: u64,
    iterations: u64,
}

impl StaticBody {
    /// What it remembers, for a checkpoint.
    pub(super) fn memory(&self) -> BodyMemory {
        let Iterate { x, r, .. } = &self.iterate;
        let (solves, iterations) = (self.solves as u64, self.iterations as u64);
        BodyMemory {
            x: x.clone(),
            r: r.clone(),
            loads: self.loads.clone(),
            handed_over: self.handed_over,
            loose: self.lattice.loose().collect(),
            reference: self.reference,
            solves,
            iterations,
        }
    }

    /// Puts it back into a body as it was at the start.
    pub(super) fn recall(&mut self, memory: BodyMemory) {
        memory.loose.iter().for_each(|&bond| self.loosen(bond));
        (self.loads, self.handed_over) = (memory.loads, memory.handed_over);
        (self.iterate.x, self.iterate.r, self.reference) = (memory.x, memory.r, memory.reference);
        (self.solves, self.iterations) = (memory.solves as usize, memory.iterations as usize);
    }

    /// Brings a lattice to equilibrium under its supports.
    ///
    /// - `guess`: displacements and rotations to start from
    ///
    /// # Errors
    /// Array lengths; [`DemError::NotConverged`].
    pub fn new(
        lattice: Lattice,
        supports: LatticeSupports,
        guess: &[Dof6],
        tolerance: Tolerance,
    ) -> Result<Self, DemError> {
        StaticBody::under_loads(lattice, supports, &[], guess, tolerance)
    }

    /// [`StaticBody::new`] under forces from outside too.
    ///
    /// - `loads`: forces [N] and moments [N m] on every particle; empty where there are none
    ///
    /// # Errors
    /// As [`StaticBody::new`].
    pub fn under_loads(
        lattice: Lattice,
        supports: LatticeSupports,
        loads: &[Dof6],
        guess: &[Dof6],
        tolerance: Tolerance,
    ) -> Result<Self, DemError> {
        // The first equilibrium tells the first break, and is compared with theory.
        let first = Tolerance { residual: FIRST * tolerance.residual, ..tolerance };
        let rest = lattice.solve(&supports, (!loads.is_empty()).then_some(loads), guess, first)?;
        let x: Vec<Dof6> = rest.state.iter().map(|u| lattice.rescale(u, lattice.scale())).collect();
        let n = x.len();
        let mut body = StaticBody {
            iterate: Iterate::new(&lattice, x, vec![[0.0; 6]; n]),
            loads: loads.iter().map(|load| lattice.rescale(load, 1.0 / lattice.scale())).collect(),
            loads_at_start: 0.0,
            handed_over: 0.0,
            lattice,
            supports,
            tolerance,
            reference: 0.0,
            solves: 1,
            iterations: rest.iterations,
        };
        let k = body.lattice.stiffness();
        for i in 0..n {
            let force = body.lattice.row(i, &body.iterate.x, &k);
            let held = |d: &usize| body.supports.fixed[i] >> d & 1 == 1;
            body.reference += (0..6).filter(held).map(|d| force[d] * force[d]).sum::<f64>();
        }
        body.reference += body.loads.iter().map(|load| dot(load, load)).sum::<f64>();
        body.loads_at_start = body.loads.iter().map(size).sum();
        body.refresh();
        Ok(body)
    }

    /// Computes the unbalanced forces afresh.
    fn refresh(&mut self) {
        let Iterate { x, r, .. } = &mut self.iterate;
        self.lattice.apply(x, &self.supports.fixed, r);
        r.iter_mut().for_each(|r| *r = r.map(|v| -v));
        for ((r, load), fixed) in r.iter_mut().zip(&self.loads).zip(&self.supports.fixed) {
            (0..6).filter(|d| fixed >> d & 1 == 0).for_each(|d| r[d] += load[d]);
        }
    }

    /// Force from outside on a particle, in scaled variables.
    fn load(&self, particle: usize) -> Dof6 {
        self.loads.get(particle).copied().unwrap_or_default()
    }

    /// Work of the forces from outside on the displacements, at their full size all the way [J].
    pub fn work_of_loads(&self) -> f64 {
        self.work_of_loads_on(self)
    }

    /// Whether forces from outside act.
    pub fn is_loaded(&self) -> bool {
        !self.loads.is_empty()
    }

    /// Share of the forces from outside on some particles, and of those that were handed over before, in all at the start.
    pub(super) fn share_of_loads(&self, particles: impl Iterator<Item = usize>) -> f64 {
        (particles.map(|i| size(&self.load(i))).sum::<f64>() + self.handed_over) / self.loads_at_start
    }

    /// Axes along which supports hold a particle, as bits.
    pub(super) fn held_along(&self, particle: usize) -> u8 {
        self.supports.fixed[particle] & ALL_AXES
    }

    /// Hands the forces from outside on a particle that nothing holds over to the nearest of those that are held, with the moment that
    /// goes with them; equilibrium is lost until [`StaticBody::solve`].
    ///
    /// - `held`: whether a particle hangs together with a support
    pub(super) fn hand_over(&mut self, particle: usize, held: impl Fn(usize) -> bool) {
        let load = self.load(particle);
        if load == [0.0; 6] {
            return;
        }
        let place = self.lattice.position();
        let distance = |i: usize| (place[i] - place[particle]).norm_squared();
        let takers = (0..place.len()).filter(|&i| held(i));
        let Some(taker) = takers.min_by(|&a, &b| distance(a).total_cmp(&distance(b))) else { return };
        let moment =
            (place[particle] - place[taker]).cross(&Vec3::new(load[0], load[1], load[2])) / self.lattice.scale();
        let mut given = load;
        (0..3).for_each(|axis| given[3 + axis] += moment[axis]);
        (0..6).for_each(|d| self.iterate.r[particle][d] -= load[d]);
        self.handed_over += size(&load);
        self.loads[particle] = [0.0; 6];
        let fixed = self.supports.fixed[taker];
        (0..6).for_each(|d| self.loads[taker][d] += given[d]);
        (0..6).filter(|d| fixed >> d & 1 == 0).for_each(|d| self.iterate.r[taker][d] += given[d]);
    }

    /// Breaks a bond; equilibrium is lost until [`StaticBody::solve`].
    ///
    /// A particle that hangs on one last bond and that nothing holds bears no load, nor does its bond: it is taken out,
    /// and so on along its chain. That is exact, and spares the solver the softest motions of a cracked body.
    pub fn break_bond(&mut self, bond: u32) {
        let ends = self.lattice.bond(bond).map(|end| end.other as usize);
        self.loosen(bond);
        for mut i in ends {
            while self.supports.fixed[i] == 0
                && self.load(i) == [0.0; 6]
                && let Some((last, next)) = self.lattice.last_bond(i)
            {
                self.loosen(last);
                i = next;
            }
        }
    }

    /// Takes the stiffness of a bond away, with what that changes at its two particles.
    fn loosen(&mut self, bond: u32) {
        let ends = self.lattice.bond(bond).map(|end| end.other as usize);
        self.lattice.break_bond(bond);
        let k = self.lattice.stiffness();
        for i in ends {
            let mut force = self.lattice.row(i, &self.iterate.x, &k);
            let load = self.load(i);
            (0..6).for_each(|d| force[d] -= load[d]);
            clear(&mut force, self.supports.fixed[i]);
            self.iterate.r[i] = force.map(|v| -v);
            // Recomputed and not subtracted, so that a particle without bonds has exactly none.
            self.iterate.inverse[i] = self.lattice.diagonal_row(i, &k).map(|v| if v > 0.0 { 1.0 / v } else { 0.0 });
        }
    }

    /// Finds the equilibrium again. Returns the number of iterations.
    ///
    /// # Errors
    /// [`DemError::NotConverged`].
    pub fn solve(&mut self) -> Result<usize, DemError> {
        self.solves += 1;
        if self.solves.is_multiple_of(REFRESH) {
            self.refresh();
        }
        let target = self.tolerance.residual.powi(2) * self.reference;
        let fixed = &self.supports.fixed;
        let iterations = self.iterate.solve(&self.lattice, fixed, target, self.reference, self.tolerance)?;
        self.iterations += iterations;
        Ok(iterations)
    }

    /// Elastic energy ½ u·K u [J].
    pub fn energy(&self) -> f64 {
        let Iterate { x, r, .. } = &self.iterate;
        let k = self.lattice.stiffness();
        // Free forces are those from outside less r; those of supports are computed where there are supports.
        let work = |i: usize| {
            let load = self.load(i);
            let mut force: Dof6 = std::array::from_fn(|d| load[d] - r[i][d]);
            if self.supports.fixed[i] != 0 {
                let row = self.lattice.row(i, x, &k);
                (0..6).filter(|d| self.supports.fixed[i] >> d & 1 == 1).for_each(|d| force[d] = row[d]);
            }
            dot(&force, &x[i])
        };
        0.5 * (0..x.len()).map(work).sum::<f64>()
    }

    /// Displacements [m] and rotations.
    pub fn state(&self) -> Vec<Dof6> {
        self.iterate.x.iter().map(|u| self.lattice.rescale(u, 1.0 / self.lattice.scale())).collect()
    }

    /// Force [N] and moment [N m] that a support exerts on a particle; it bears what loads the particle itself, too.
    pub fn reaction(&self, particle: u32) -> Dof6 {
        let row = self.lattice.row(particle as usize, &self.iterate.x, &self.lattice.stiffness());
        let load = self.load(particle as usize);
        self.lattice.rescale(&std::array::from_fn(|d| row[d] - load[d]), self.lattice.scale())
    }

    /// The lattice with the bonds that hold.
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// Equilibria found, and iterations for all of them.
    pub fn effort(&self) -> (usize, usize) {
        (self.solves, self.iterations)
    }

    /// Elastic energy of a bond where this state is taken `factor` times, beside another one of the same body [J].
    pub(super) fn bond_energy(&self, bond: u32, factor: f64, beside: Option<&StaticBody>) -> f64 {
        let energy = |strained: Strained| {
            let end = self.lattice.bond(bond)[0];
            let load = strained.load(end, &self.lattice.stiffness(), self.lattice.section().radius);
            let [first, second] = strained.turn;
            0.5 * (load.normal * strained.stretch
                + load.bending[0].dot(&first)
                + load.bending[1].dot(&second)
                + load.torsion * strained.twist)
        };
        match beside {
            Some(beside) => energy(self.strained(bond) * factor + beside.strained(bond)),
            None => factor * factor * energy(self.strained(bond)),
        }
    }

    fn strained(&self, bond: u32) -> Strained {
        let [own, end] = self.lattice.bond(bond);
        let (a, b) = (&self.iterate.x[end.other as usize], &self.iterate.x[own.other as usize]);
        Strained::of(own, a, b, &self.lattice.stiffness())
    }

    /// Elastic work of this state's forces on the displacements of another one that its supports do not move, u'·K u [J].
    pub(super) fn work_on(&self, other: &StaticBody) -> f64 {
        let free = |i: usize, d: usize| self.supports.fixed[i] >> d & 1 == 0;
        let force = |i: usize, d: usize| self.load(i)[d] - self.iterate.r[i][d];
        let displacement = &other.iterate.x;
        let work =
            |i: usize| -> f64 { (0..6).filter(|&d| free(i, d)).map(|d| force(i, d) * displacement[i][d]).sum::<f64>() };
        (0..displacement.len()).map(work).sum()
    }

    /// Work of the forces from outside of this state on the displacements of another one, at their full size all the way [J].
    pub fn work_of_loads_on(&self, other: &StaticBody) -> f64 {
        self.loads.iter().zip(&other.iterate.x).map(|(load, x)| dot(load, x)).sum()
    }
}

/// Size of a force with its moment.
fn size(load: &Dof6) -> f64 {
    dot(load, load).sqrt()
}

/// How a bond is deformed.
#[derive(Clone, Copy)]
struct Strained {
    /// Change of length [m].
    stretch: f64,
    /// Bending rotations of the ends against the chord.
    turn: [Vec3; 2],
    /// Relative rotation about the axis.
    twist: f64,
}

impl Strained {
    /// From the scaled states of the particle that owns `end` and of the other.
    fn of(end: &HalfBond, own: &Dof6, other: &Dof6, k: &Stiffness) -> Self {
        let n = Vec3::from(end.axis);
        let du = Vec3::new(other[0] - own[0], other[1] - own[1], other[2] - own[2]);
        let turn = |s: &Dof6| Vec3::new(s[3], s[4], s[5]) * k.scale;
        let (a, b) = (turn(own), turn(other));
        let chord = n.cross(&du) * end.inverse;
        let across = |t: Vec3| t - n * t.dot(&n) - chord;
        Strained { stretch: du.dot(&n), turn: [across(a), across(b)], twist: (b - a).dot(&n) }
    }

    /// Of the section itself: its stress goes with its strain, whatever its share.
    ///
    /// - `radius`: of the section [m]
    fn load(&self, end: &HalfBond, k: &Stiffness, radius: f64) -> BondLoad {
        let bend = 2.0 * k.bending * end.inverse;
        let [a, b] = self.turn;
        BondLoad {
            normal: k.axial * end.inverse * self.stretch,
            bending: [(a * 2.0 + b) * bend, (a + b * 2.0) * bend],
            torsion: k.torsion * end.inverse * self.twist,
            radius,
        }
    }
}

impl Add for Strained {
    type Output = Strained;

    fn add(self, other: Strained) -> Strained {
        Strained {
            stretch: self.stretch + other.stretch,
            turn: [self.turn[0] + other.turn[0], self.turn[1] + other.turn[1]],
            twist: self.twist + other.twist,
        }
    }
}

impl Mul<f64> for Strained {
    type Output = Strained;

    fn mul(self, factor: f64) -> Strained {
        Strained {
            stretch: self.stretch * factor,
            turn: self.turn.map(|turn| turn * factor),
            twist: self.twist * factor,
        }
    }
}

impl LoadedBonds for StaticBody {
    fn virials(&self, out: &mut [Sym3]) {
        let k = self.lattice.stiffness();
        let x = &self.iterate.x;
        out.par_chunks_mut(BLOCK).enumerate().for_each(|(block, out)| {
            for (slot, out) in out.iter_mut().enumerate() {
                let i = block * BLOCK + slot;
                let own = &x[i];
                let mut sum = [0.0; 6];
                for end in self.lattice.ends(i).iter().filter(|end| end.inverse > 0.0) {
                    let other = &x[end.other as usize];
                    let n = end.axis;
                    let du = [other[0] - own[0], other[1] - own[1], other[2] - own[2]];
                    let s = [own[3] + other[3], own[4] + other[4], own[5] + other[5]].map(|v| v * k.scale);
                    // l times the force on i, as in `Lattice::bond_forces`.
                    let bend = 6.0 * k.bending * end.share * end.inverse;
                    let transverse = 2.0 * bend * end.inverse;
                    let along = (k.axial * end.share - transverse) * (du[0] * n[0] + du[1] * n[1] + du[2] * n[2]);
                    let force = [
                        along * n[0] + transverse * du[0] - bend * (s[1] * n[2] - s[2] * n[1]),
                        along * n[1] + transverse * du[1] - bend * (s[2] * n[0] - s[0] * n[2]),
                        along * n[2] + transverse * du[2] - bend * (s[0] * n[1] - s[1] * n[0]),
                    ];
                    for (sum, [a, b]) in sum.iter_mut().zip([[0, 0], [1, 1], [2, 2], [0, 1], [1, 2], [2, 0]]) {
                        *sum += n[a] * force[b] + n[b] * force[a];
                    }
                }
                *out = Sym3(sum) * 0.25;
            }
        });
    }

    fn load(&self, bond: u32) -> BondLoad {
        let radius = self.lattice.section().radius;
        self.strained(bond).load(self.lattice.bond(bond)[0], &self.lattice.stiffness(), radius)
    }

    fn axis(&self, bond: u32) -> Vec3 {
        Vec3::from(self.lattice.bond(bond)[0].axis)
    }
}
