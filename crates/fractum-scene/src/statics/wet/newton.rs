//! Newton's method for the jumps of pairs and the pressures of cells.

use fractum_math::{Mat3, Vec3};

use super::WetStep;
use super::compliance::{Compliance, HoleColumn};
use super::dense::Dense;
use super::trial::{NONE, Trial, Way, more};
use crate::error::StepError;
use crate::liquid::Liquid;
use crate::liquid::network::WetPoint;
use crate::scene::Scene;

/// Iterations at most, and those in which the residual may grow; the part of a way that is gone in any case.
const MOST: usize = 60;
const FREE: usize = 8;
const LEAST_PART: f64 = 0.02;
/// Change of a pressure in an iteration at most, over the largest pressure and traction there is.
const MOST_PRESSURE: f64 = 1.0;
/// Change over the largest value below which the solution is found, and below which it is if it does not become smaller any more: rounding.
const SETTLED: f64 = 1e-9;
const ROUNDING: f64 = 1e-6;

/// Newton's method with its matrix.
#[derive(Default)]
pub(super) struct Newton {
    matrix: Dense,
    right: Vec<f64>,
    /// Way to the solution of the linear system.
    way: Vec<f64>,
}

/// Places of the unknowns.
struct Places {
    axes: usize,
    /// Components of jumps.
    jumps: usize,
    /// Jump over pressure by which pressures are scaled [m/Pa].
    scale: f64,
}

impl Newton {
    /// Solves for what is unknown; the iterations, or nothing where they come to no end.
    pub(super) fn solve(
        &mut self,
        scene: &Scene,
        compliance: &Compliance,
        step: &WetStep,
        trial: &mut Trial,
        stop: fn() -> bool,
    ) -> Result<Option<usize>, StepError> {
        let places = Places::of(scene, compliance, trial);
        let bears = trial.largest_traction(scene, compliance);
        self.assemble(scene, compliance, step, trial, &places);
        if self.right.is_empty() {
            return Ok(Some(0));
        }
        // What only presses on walls that bear it has no part that is too long.
        let bears = if trial.active.is_empty() { f64::INFINITY } else { bears };
        let (mut missing, mut before) = (norm(&self.right), f64::INFINITY);
        for iteration in 1..=MOST {
            if stop() {
                return Err(StepError::Interrupted { step: scene.clock.step, time: scene.clock.time });
            }
            if !self.matrix.solve(&mut self.right) {
                return Ok(None);
            }
            self.way.clone_from(&self.right);
            let mut part = self.within(&places, MOST_PRESSURE * (trial.largest_pressure() + bears));
            let change = self.change(trial, &places);
            if part == 1.0 && (change <= SETTLED || change <= ROUNDING && change >= before) {
                self.advance(trial, &places, 1.0);
                trial.drop_noise();
                return Ok(Some(iteration));
            }
            before = change;
            loop {
                self.advance(trial, &places, part);
                self.assemble(scene, compliance, step, trial, &places);
                let left = norm(&self.right);
                // Where sides open and close by turns, and softening begins and ends, no step may lead away from the solution.
                if iteration <= FREE || left < missing || part < LEAST_PART {
                    missing = left;
                    break;
                }
                self.advance(trial, &places, -part);
                part *= 0.5;
            }
        }
        Ok(None)
    }

    /// Part of the way to the solution on which no pressure changes by more than `most`: where sides that are pressed together are about to part, the way
    /// that their stiffness tells is far too long.
    fn within(&self, places: &Places, most: f64) -> f64 {
        let change = largest(&self.way[places.jumps..]) / places.scale;
        if change > most { most / change } else { 1.0 }
    }

    /// Change of jumps and of pressures on the whole way, over the largest of each; the larger of both.
    fn change(&self, trial: &Trial, places: &Places) -> f64 {
        let jump =
            trial.active.iter().map(|&joint| trial.jump[joint as usize].amax()).fold(f64::MIN_POSITIVE, f64::max);
        let pressure = trial.largest_pressure().max(f64::MIN_POSITIVE);
        let (jumps, pressures) = self.way.split_at(places.jumps);
        (largest(jumps) / jump).max(largest(pressures) / places.scale / pressure)
    }

    /// Goes a part of the way to the solution of the linear system.
    fn advance(&self, trial: &mut Trial, places: &Places, part: f64) {
        for (&joint, way) in trial.active.iter().zip(self.way[..places.jumps].chunks_exact(places.axes)) {
            way.iter().enumerate().for_each(|(axis, way)| trial.jump[joint as usize][axis] -= part * way);
        }
        for (&cell, way) in trial.unknown.iter().zip(&self.way[places.jumps..]) {
            trial.pressure[cell as usize] -= part * way / places.scale;
        }
        trial.share_pressures();
    }

    /// Residuals, and their derivatives.
    fn assemble(&mut self, scene: &Scene, compliance: &Compliance, step: &WetStep, trial: &Trial, places: &Places) {
        let size = places.jumps + trial.unknown.len();
        self.matrix.reset(size);
        self.right.clear();
        self.right.resize(size, 0.0);
        let network = &scene.optional.liquid.as_ref().expect("liquid").network;
        let law = |&joint: &u32| {
            let (force, slope) =
                more(scene.interfaces(), &compliance.joints[joint as usize], &trial.jump[joint as usize]);
            (force + trial.thrust(network, joint), slope)
        };
        let laws: Vec<(Vec3, Mat3)> = trial.active.iter().map(law).collect();
        self.assemble_jumps(scene, compliance, step, trial, places, &laws);
        if !trial.unknown.is_empty() {
            self.assemble_cells(scene, compliance, step, trial, places, &laws);
        }
    }

    /// δ - δ₀ - D f of the unknown pairs.
    fn assemble_jumps(
        &mut self,
        scene: &Scene,
        compliance: &Compliance,
        step: &WetStep,
        trial: &Trial,
        places: &Places,
        laws: &[(Vec3, Mat3)],
    ) {
        let own = scene.optional.liquid.as_ref().expect("liquid");
        let (network, axes) = (&own.network, places.axes);
        for (row, &joint) in trial.active.iter().enumerate() {
            let mut missing = trial.jump[joint as usize] - trial.driven(compliance, step, joint);
            for (hole, column) in own.holes.iter().zip(&compliance.holes) {
                let place = trial.cell_place[hole.cell as usize];
                if place != NONE {
                    let opens = column.jumps[joint as usize] / places.scale;
                    (0..axes).for_each(|a| self.matrix.add(axes * row + a, places.cell(place), -opens[a]));
                }
            }
            for (column, (&pushed, (force, slope))) in trial.active.iter().zip(laws).enumerate() {
                let between = compliance.between(joint, pushed);
                missing -= between * force;
                let block = between * slope;
                for a in 0..axes {
                    for b in 0..axes {
                        self.matrix.add(axes * row + a, axes * column + b, -block[(a, b)]);
                    }
                }
                for &point in &network.points_of_joint[pushed as usize] {
                    let WetPoint { cell, normal, area, .. } = &network.points[point as usize];
                    let place = trial.cell_place[*cell as usize];
                    if place != NONE {
                        let opens = between * normal * (area / places.scale);
                        (0..axes).for_each(|a| self.matrix.add(axes * row + a, places.cell(place), -opens[a]));
                    }
                }
            }
            for a in 0..axes {
                self.matrix.add(axes * row + a, axes * row + a, 1.0);
                self.right[axes * row + a] = missing[a];
            }
        }
    }

    /// The balance of the cells in play: each is full, or has no pressure.
    fn assemble_cells(
        &mut self,
        scene: &Scene,
        compliance: &Compliance,
        step: &WetStep,
        trial: &Trial,
        places: &Places,
        laws: &[(Vec3, Mat3)],
    ) {
        let own = scene.optional.liquid.as_ref().expect("liquid");
        let network = &own.network;
        let inflow = trial.inflow(scene, step.dt);
        let compressibility = own.settings.compressibility;
        let forces = || trial.active.iter().copied().zip(laws.iter().map(|(force, _)| *force));
        let room_of = |cell: u32| match hole_at(own, cell) {
            Some(hole) => trial.hole_volume(compliance, step, hole, forces()),
            None => trial.room(scene, cell),
        };
        // Pressure per volume that is too much in a cell [Pa/m³], for those that are full.
        let mut is_full = vec![0.0; trial.unknown.len()];
        for (place, &cell) in (0u32..).zip(&trial.unknown) {
            let (index, row) = (cell as usize, places.cell(place));
            let pressure = trial.pressure[index];
            if !trial.prescribed[index].is_nan() {
                self.right[row] = (pressure - trial.prescribed[index]) * places.scale;
                self.matrix.add(row, row, 1.0);
                continue;
            }
            let members = trial.with_pressure_of(own, cell);
            let give = give(compliance, own, cell);
            let (mut missing, mut amount, mut grows) = (0.0, 0.0, 0.0);
            for member in members.clone() {
                let (room, member) = (room_of(member), member as usize);
                let comes = trial.before.amount[member] + inflow[member] + trial.comes[member];
                let there = comes - trial.taken(member, comes);
                missing += (room + own.compressed(member, room, pressure) - there) / give;
                grows += own.compressed(member, room, 1.0);
                amount += there;
            }
            // A full cell stays full while it pushes: how its room grows, it cannot know before it opens. What has closed more than at the start has less
            // than no room.
            if pressure <= 0.0 && (missing >= 0.0 || amount <= 0.0) {
                self.right[row] = pressure * places.scale;
                self.matrix.add(row, row, 1.0);
                continue;
            }
            is_full[place as usize] = 1.0 / give;
            self.right[row] = missing * places.scale;
            self.matrix.add(row, row, grows / give);
            let weight = (1.0 + compressibility * pressure) / give;
            for &point in members.flat_map(|member| &network.cells[member as usize].points) {
                let WetPoint { joint, normal, area, .. } = &network.points[point as usize];
                let opens = normal * (area * weight * places.scale);
                self.add_jump(row, trial, places, *joint, &opens);
            }
            if let Some(hole) = hole_at(own, cell) {
                self.assemble_volume(row, compliance, own, trial, places, (hole, weight, laws));
            }
        }
        for Way { slit, cells, conductance, slope } in trial.ways(scene) {
            let difference = trial.pressure[cells[0] as usize] - trial.pressure[cells[1] as usize];
            let ends = cells.map(|cell| trial.cell_place[cell as usize]);
            for (side, sign) in [(0, 1.0), (1, -1.0)] {
                let full = is_full[ends[side] as usize];
                if full == 0.0 {
                    continue;
                }
                // What flows away from a cell is missing there.
                let (row, weight) = (places.cell(ends[side]), sign * step.dt * full);
                self.matrix.add(row, places.cell(ends[0]), weight * conductance);
                self.matrix.add(row, places.cell(ends[1]), -weight * conductance);
                for &point in slit.points.iter().flatten() {
                    let WetPoint { joint, normal, .. } = &network.points[point as usize];
                    if trial.aperture(scene, point) > 0.0 {
                        let widens = normal * (weight * slope * difference * places.scale);
                        self.add_jump(row, trial, places, *joint, &widens);
                    }
                }
            }
        }
    }

    /// Derivatives of the volume of a hole.
    ///
    /// - `weight`: of a volume in the row
    fn assemble_volume(
        &mut self,
        row: usize,
        compliance: &Compliance,
        own: &Liquid,
        trial: &Trial,
        places: &Places,
        (hole, weight, laws): (usize, f64, &[(Vec3, Mat3)]),
    ) {
        let network = &own.network;
        let HoleColumn { jumps, gains } = &compliance.holes[hole];
        for (other, gain) in own.holes.iter().zip(gains) {
            let place = trial.cell_place[other.cell as usize];
            if place != NONE {
                self.matrix.add(row, places.cell(place), weight * gain);
            }
        }
        for (&joint, (_, slope)) in trial.active.iter().zip(laws) {
            let gains = jumps[joint as usize];
            self.add_jump(row, trial, places, joint, &(slope.tr_mul(&gains) * (weight * places.scale)));
            for &point in &network.points_of_joint[joint as usize] {
                let WetPoint { cell, normal, area, .. } = &network.points[point as usize];
                let place = trial.cell_place[*cell as usize];
                if place != NONE {
                    self.matrix.add(row, places.cell(place), weight * area * gains.dot(normal));
                }
            }
        }
    }

    /// Adds a derivative by the jump of a pair, if that is unknown.
    fn add_jump(&mut self, row: usize, trial: &Trial, places: &Places, joint: u32, by: &Vec3) {
        let place = trial.place[joint as usize];
        if place != NONE {
            (0..places.axes).for_each(|a| self.matrix.add(row, places.axes * place as usize + a, by[a]));
        }
    }
}

fn norm(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>().sqrt()
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

/// Volume that a cell gains per pressure in it alone [m³/Pa].
fn give(compliance: &Compliance, own: &Liquid, cell: u32) -> f64 {
    if let Some(hole) = hole_at(own, cell) {
        return compliance.holes[hole].gains[hole] + own.compressed(cell as usize, own.holes[hole].volume, 1.0);
    }
    let of = |&point: &u32| {
        let point = &own.network.points[point as usize];
        let between = compliance.between(point.joint, point.joint);
        point.area * point.area * point.normal.dot(&(between * point.normal))
    };
    own.network.cells[cell as usize].points.iter().map(of).sum()
}

/// Number of the hole that a cell is, if it is one.
fn hole_at(own: &Liquid, cell: u32) -> Option<usize> {
    (cell as usize).checked_sub(own.cell_count())
}

impl Places {
    fn of(scene: &Scene, compliance: &Compliance, trial: &Trial) -> Self {
        let own = scene.optional.liquid.as_ref().expect("liquid");
        let per_area = |&cell: &u32| give(compliance, own, cell) / own.area(cell as usize);
        let scale = trial.unknown.iter().map(per_area).fold(f64::MIN_POSITIVE, f64::max);
        Places { axes: compliance.axes, jumps: compliance.axes * trial.active.len(), scale }
    }

    /// Place of the pressure of a cell.
    fn cell(&self, place: u32) -> usize {
        self.jumps + place as usize
    }
}
