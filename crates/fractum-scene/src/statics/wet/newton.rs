//! Newton's method for the jumps of pairs and the pressures of cells.

use fractum_math::{Mat3, Vec3};

use super::WetStep;
use super::compliance::Compliance;
use super::dense::Dense;
use super::trial::{NONE, Trial, Way, more};
use crate::error::StepError;
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
        for (&cell, way) in trial.play.iter().zip(&self.way[places.jumps..]) {
            trial.pressure[cell as usize] -= part * way / places.scale;
        }
    }

    /// Residuals, and their derivatives.
    fn assemble(&mut self, scene: &Scene, compliance: &Compliance, step: &WetStep, trial: &Trial, places: &Places) {
        let size = places.jumps + trial.play.len();
        self.matrix.reset(size);
        self.right.clear();
        self.right.resize(size, 0.0);
        self.assemble_jumps(scene, compliance, step, trial, places);
        if !trial.play.is_empty() {
            self.assemble_cells(scene, compliance, step, trial, places);
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
    ) {
        let (network, axes) = (&scene.optional.liquid.as_ref().expect("liquid").network, places.axes);
        let laws: Vec<(Vec3, Mat3)> = trial
            .active
            .iter()
            .map(|&joint| {
                let (force, slope) =
                    more(scene.interfaces(), &compliance.joints[joint as usize], &trial.jump[joint as usize]);
                (force + trial.thrust(network, joint), slope)
            })
            .collect();
        for (row, &joint) in trial.active.iter().enumerate() {
            let mut missing = trial.jump[joint as usize] - step.loaded[joint as usize];
            for (column, (&pushed, (force, slope))) in trial.active.iter().zip(&laws).enumerate() {
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
    ) {
        let own = scene.optional.liquid.as_ref().expect("liquid");
        let network = &own.network;
        let inflow = trial.inflow(scene, step.dt);
        let compressibility = own.settings.compressibility;
        // Pressure per volume that is too much in a cell [Pa/m³], for those that are full.
        let mut is_full = vec![0.0; trial.play.len()];
        for (place, &cell) in (0u32..).zip(&trial.play) {
            let (index, row) = (cell as usize, places.cell(place));
            let pressure = trial.pressure[index];
            if !trial.prescribed[index].is_nan() {
                self.right[row] = (pressure - trial.prescribed[index]) * places.scale;
                self.matrix.add(row, row, 1.0);
                continue;
            }
            let room = trial.room(scene, cell);
            let comes = trial.before.amount[index] + inflow[index] + trial.comes[index];
            let amount = comes - trial.taken(index, comes);
            let give = give(compliance, network.cells[index].points.iter().map(|&p| &network.points[p as usize]));
            let missing = (room * (1.0 + compressibility * pressure) - amount) / give;
            // A full cell stays full while it pushes: how its room grows, it cannot know before it opens. What has closed more than at the start has less
            // than no room.
            if pressure <= 0.0 && (missing >= 0.0 || amount <= 0.0) {
                self.right[row] = pressure * places.scale;
                self.matrix.add(row, row, 1.0);
                continue;
            }
            is_full[place as usize] = 1.0 / give;
            self.right[row] = missing * places.scale;
            self.matrix.add(row, row, room * compressibility / give);
            for &point in &network.cells[index].points {
                let WetPoint { joint, normal, area, .. } = &network.points[point as usize];
                let opens = normal * (area * (1.0 + compressibility * pressure) / give * places.scale);
                self.add_jump(row, trial, places, *joint, &opens);
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
fn give<'a>(compliance: &Compliance, points: impl Iterator<Item = &'a WetPoint>) -> f64 {
    let of = |point: &WetPoint| {
        let own = compliance.between(point.joint, point.joint);
        point.area * point.area * point.normal.dot(&(own * point.normal))
    };
    points.map(of).sum()
}

impl Places {
    fn of(scene: &Scene, compliance: &Compliance, trial: &Trial) -> Self {
        let network = &scene.optional.liquid.as_ref().expect("liquid").network;
        let per_area = |&cell: &u32| {
            let own = &network.cells[cell as usize];
            give(compliance, own.points.iter().map(|&p| &network.points[p as usize])) / own.area
        };
        let scale = trial.play.iter().map(per_area).fold(f64::MIN_POSITIVE, f64::max);
        Places { axes: compliance.axes, jumps: compliance.axes * trial.active.len(), scale }
    }

    /// Place of the pressure of a cell.
    fn cell(&self, place: u32) -> usize {
        self.jumps + place as usize
    }
}
