//! Cells that take several short steps while the others take a long one.
//!
//! Nodes that cells of both kinds share stand twice: once with the short steps and the mass of the fine cells around, once as a
//! *copy* with the long steps and the mass of the others. A force between the two, the link, keeps their velocities together at the
//! end of every short step, where the velocity of the copy is interpolated between those that it would have without the link at
//! both ends of the long step: Gravouil and Combescure, *Int. J. Numer. Meth. Eng.* 50 (2001) 199-225, with central differences on
//! both sides. Masses are lumped, so that the link of every node is found by itself. The scheme is stable wherever both sides are;
//! the link takes a little energy, never gives any, and is booked. It ties velocities and not displacements: the two drift apart by
//! what the interpolation misses.

mod fine_elements;
mod linked_node;
mod set_up;

use fractum_math::{CHUNK, HalfSteps, Vec3};
use linked_node::LinkedNode;
use rayon::prelude::*;

use crate::motion::central_difference::{WholeStep, free_axes, kick_runs, work_of_chunks};
use crate::solid::Solid;
use crate::solid::evaluate::Block;
use crate::solid::subcycling::{Subcycling, rubbed_energy};

/// What the solid wants done about prescribed motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Prescribe {
    /// Keep the velocities of these nodes before they are kicked.
    Remember {
        /// Nodes with short steps, or those with long ones.
        fine: bool,
    },
    /// Give the prescribed ones of these nodes their motion.
    Impose {
        /// Nodes with short steps, or those with long ones.
        fine: bool,
        /// Time since tⁿ of the kick [s].
        since: f64,
        /// Step before the kick [s].
        dt_before: f64,
        /// Step after it [s].
        dt_after: f64,
    },
}

impl Solid {
    /// Whether some nodes take shorter steps than others.
    pub fn is_subcycled(&self) -> bool {
        self.subcycling.is_some()
    }

    /// Whether a node takes short steps.
    pub fn is_fine(&self, node: usize) -> bool {
        self.subcycling.as_ref().is_some_and(|own| own.is_fine.get(node).copied().unwrap_or(false))
    }

    /// The node of the mesh that a node is, or is a copy of.
    #[inline]
    pub fn original(&self, node: usize) -> usize {
        match node.checked_sub(self.reference.len()) {
            None => node,
            Some(copy) => self.copies[copy] as usize,
        }
    }
}

/// Nodes of the mesh, ascending, with their copies after them.
pub fn with_copies(solid: &Solid, mut nodes: Vec<u32>) -> Vec<u32> {
    let copies = (solid.reference.len() as u32..).zip(&solid.copies);
    let of: Vec<u32> = copies.filter(|(_, node)| nodes.binary_search(node).is_ok()).map(|(copy, _)| copy).collect();
    nodes.extend(of);
    nodes
}

/// Shares of cells and nodes with short steps, and the number of nodes that stand twice; none where all take the same.
pub fn fine_shares(solid: &Solid) -> Option<(f64, usize)> {
    solid.subcycling.as_ref()?;
    let cells = |fine: bool| -> usize {
        solid.blocks.iter().filter(|block| !fine || block.is_fine).map(|block| block.cells.len()).sum()
    };
    Some((cells(true) as f64 / cells(false).max(1) as f64, solid.copies.len()))
}

/// Begins a step with this many short ones in it; it follows the last one.
///
/// - `is_first`: whether there is none before it
pub fn set_short_steps(solid: &mut Solid, parts: u32, is_first: bool) {
    let Some(own) = &mut solid.subcycling else { return };
    own.parts = [if is_first { parts } else { own.parts[1] }, parts];
}

/// Short steps in the last step; none where all nodes take the same.
pub fn short_steps(solid: &Solid) -> Option<u32> {
    Some(solid.subcycling.as_ref()?.parts[1])
}

/// Takes the number of short steps in the last one.
pub fn restore_short_steps(solid: &mut Solid, parts: u32) {
    solid.subcycling.iter_mut().for_each(|own| own.parts = [parts; 2]);
}

/// Gives copies the velocities of their nodes.
pub fn set_copies_off(solid: &mut Solid) {
    for (copy, &node) in (solid.reference.len()..).zip(&solid.copies) {
        solid.velocity[copy] = solid.velocity[node as usize];
    }
}

/// Where steps have two sizes: acceleration at tⁿ [m/s²], of a node and its copy that of both together; and their step before tⁿ,
/// of a whole one `dt` [s].
pub fn own_acceleration(solid: &Solid, node: usize, dt: f64) -> Option<(Vec3, f64)> {
    let own = solid.subcycling.as_ref()?;
    let dt = if solid.is_fine(node) { dt / f64::from(own.parts[0]) } else { dt };
    let original = solid.original(node);
    let Ok(link) = solid.copies.binary_search(&(original as u32)) else {
        return Some((solid.force[node] * solid.inverse_mass[node], dt));
    };
    let both = [original, solid.reference.len() + link];
    let force = both.iter().map(|&i| solid.force[i]).sum::<Vec3>();
    Some((force / both.iter().map(|&i| solid.mass[i]).sum::<f64>(), dt))
}

/// Once the internal forces are those of tⁿ: what is added to them stays until tⁿ⁺¹.
pub(crate) fn keep_internal(solid: &mut Solid) {
    let Some(own) = &mut solid.subcycling else { return };
    own.is_ahead = false;
    own.outer.copy_from_slice(&solid.force);
}

/// The last step of the cells of a block, where that of the scene was `dt` [s].
pub(crate) fn own_step(solid: &Solid, block: &Block, dt: f64) -> f64 {
    match &solid.subcycling {
        Some(own) if block.is_fine => dt / f64::from(own.parts[1]),
        _ => dt,
    }
}

/// As [`Solid::kick_and_drift`], with short steps for the nodes that need them.
///
/// - `prescribe`: sees to what is prescribed, before and after some nodes move
pub fn advance_in_parts(
    solid: &mut Solid,
    step: WholeStep,
    mut prescribe: impl FnMut(&mut Solid, Prescribe) -> HalfSteps,
) -> HalfSteps {
    let Some(mut own) = solid.subcycling.take() else { return HalfSteps::default() };
    let parts = f64::from(own.parts[1]);
    let long = [step.dt_before, step.dt_after];
    let (before, after) = (step.dt_before / f64::from(own.parts[0]), step.dt_after / parts);
    own.outer.iter_mut().zip(&solid.force).for_each(|(outer, force)| *outer = force - *outer);
    own.has_outer = own.outer.iter().zip(&own.is_fine).any(|(outer, is_fine)| *is_fine && *outer != Vec3::zeros());
    let mut work = HalfSteps::default();
    // Whoever put these forces on has booked their work for whole steps.
    work.before.external += own.outer_work(solid, 0.5 * (before - step.dt_before));
    for fine in [false, true] {
        prescribe(solid, Prescribe::Remember { fine });
    }
    work += own.kick(solid, false, long, &step);
    work += own.kick(solid, true, [before, after], &step);
    work += own.kick_linked(solid, [before, after], &step);
    for (fine, [dt_before, dt_after]) in [(false, long), (true, [before, after])] {
        work += prescribe(solid, Prescribe::Impose { fine, since: 0.0, dt_before, dt_after });
    }
    own.energies = [solid.elastic_energy(), solid.dissipated_energy(), rubbed_energy(solid)];
    own.look_ahead(solid, &step);
    let step = WholeStep { measure: false, ..step };
    for part in 1..own.parts[1] {
        work.after.external += own.outer_work(solid, after);
        own.update_fine_forces(solid, after);
        prescribe(solid, Prescribe::Remember { fine: true });
        let share = f64::from(part) / parts;
        let mut later = own.kick(solid, true, [after; 2], &step);
        later += own.kick_fine_linked(solid, share, after, &step);
        let since = share * step.dt_after;
        later += prescribe(solid, Prescribe::Impose { fine: true, since, dt_before: after, dt_after: after });
        // All of it lies after tⁿ.
        work.after += later.before;
        work.after += later.after;
    }
    work.after.external += own.outer_work(solid, 0.5 * (after - step.dt_after));
    solid.subcycling = Some(own);
    work
}

impl Subcycling {
    /// Work that the outer forces do on nodes with short steps at their present velocities [J].
    fn outer_work(&mut self, solid: &Solid, dt: f64) -> f64 {
        if !self.has_outer || dt == 0.0 {
            return 0.0;
        }
        let Subcycling { outer, runs, power, .. } = self;
        let of = |node: usize| outer[node].dot(&solid.velocity[node]);
        power.par_iter_mut().zip(&runs[1]).enumerate().for_each(|(chunk, (power, runs))| {
            *power = runs.iter().cloned().flatten().map(|i| of(chunk * CHUNK + i)).sum();
        });
        let linked: f64 = solid.copies.iter().map(|&node| of(node as usize)).sum();
        (power.iter().sum::<f64>() + linked) * dt
    }

    /// Kicks the nodes with short steps or those with long ones, but those that stand twice.
    fn kick(&self, solid: &mut Solid, fine: bool, [dt_before, dt_after]: [f64; 2], step: &WholeStep) -> HalfSteps {
        let step = WholeStep { dt_before, dt_after, ..*step };
        kick_runs(solid, &step, |chunk| self.runs[usize::from(fine)].get(chunk).map(Vec::as_slice));
        work_of_chunks(solid)
    }

    /// Kicks nodes and their copies at tⁿ.
    ///
    /// - `short`: short steps on both sides [s]
    fn kick_linked(&mut self, solid: &mut Solid, short: [f64; 2], step: &WholeStep) -> HalfSteps {
        let mut work = HalfSteps::default();
        let first = solid.reference.len();
        let Subcycling { ends, accelerations, .. } = self;
        for (link, (ends, acceleration)) in ends.iter_mut().zip(accelerations).enumerate() {
            let (node, copy) = (solid.copies[link] as usize, first + link);
            let free = free_axes(step.held.get(node).copied().unwrap_or(0));
            let long = [step.dt_before, step.dt_after];
            *acceleration = (solid.force[node] + solid.force[copy]) / (solid.mass[node] + solid.mass[copy]);
            let (mut fine, mut coarse) = (
                LinkedNode::new(solid, node, *acceleration, short, step),
                LinkedNode::new(solid, copy, *acceleration, long, step),
            );
            ends[0] = coarse.velocity_at();
            let link = (ends[0] - fine.velocity_at()).component_mul(&free)
                / (fine.yield_per_force() + coarse.yield_per_force());
            work += fine.kick(solid, link, step.measure);
            work += coarse.kick(solid, -link, step.measure);
        }
        work
    }

    /// Kicks those of nodes and copies that take short steps, within a long one.
    ///
    /// - `share`: where in the long step, above 0 and below 1
    fn kick_fine_linked(&self, solid: &mut Solid, share: f64, dt: f64, step: &WholeStep) -> HalfSteps {
        let mut work = HalfSteps::default();
        let first = solid.reference.len();
        for (link, [begin, end]) in self.ends.iter().enumerate() {
            let node = solid.copies[link] as usize;
            let free = free_axes(step.held.get(node).copied().unwrap_or(0));
            let mut fine = LinkedNode::new(solid, node, self.accelerations[link], [dt; 2], step);
            let of_copy = 0.5 * step.dt_after * solid.inverse_mass[first + link];
            let target = begin * (1.0 - share) + end * share;
            let link = (target - fine.velocity_at()).component_mul(&free) / (fine.yield_per_force() + of_copy);
            work += fine.kick(solid, link, false);
        }
        work
    }

    /// Finds the forces of the cells around copies at tⁿ⁺¹, and the velocities that the copies will have without the link.
    fn look_ahead(&mut self, solid: &mut Solid, step: &WholeStep) {
        let Solid { displacement, velocity, blocks, bodies, .. } = solid;
        blocks
            .par_iter_mut()
            .enumerate()
            .filter(|(index, _)| self.near.binary_search(index).is_ok())
            .for_each(|(_, block)| block.evaluate(&bodies[block.body], displacement, velocity, step.dt_after, true));
        self.is_ahead = true;
        let first = solid.reference.len();
        let Subcycling { ends, accelerations, .. } = self;
        for (copy, ([_, end], acceleration)) in (first..).zip(ends.iter_mut().zip(accelerations)) {
            solid.force[copy] = solid.slots.gather(copy, |block| solid.blocks[block].forces()) + self.outer[copy];
            *end = LinkedNode::new(solid, copy, *acceleration, [step.dt_after; 2], step).velocity_at();
        }
    }

    /// Forces on the nodes with short steps, after one of these [s].
    fn update_fine_forces(&self, solid: &mut Solid, dt: f64) {
        let Solid { displacement, velocity, force, blocks, bodies, slots, copies, .. } = solid;
        blocks
            .par_iter_mut()
            .filter(|block| block.is_fine)
            .for_each(|block| block.evaluate(&bodies[block.body], displacement, velocity, dt, false));
        let sum = |node: usize| slots.gather(node, |block| blocks[block].forces()) + self.outer[node];
        force.par_chunks_mut(CHUNK).zip(&self.runs[1]).enumerate().for_each(|(chunk, (force, runs))| {
            runs.iter().cloned().flatten().for_each(|i| force[i] = sum(chunk * CHUNK + i));
        });
        copies.iter().for_each(|&node| force[node as usize] = sum(node as usize));
    }
}
