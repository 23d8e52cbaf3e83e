//! What a step of solids and liquid is tried with: jumps, pressures, and what of it is unknown.

use fractum_kernels::liquid::leaked;
use fractum_math::{Mat3, Vec3};

use super::compliance::{Compliance, HoleColumn, spring_of};
use super::{MORE, WetStep};
use crate::interfaces::Interfaces;
use crate::interfaces::joints::{Joint, JointPoint};
use crate::liquid::network::{Network, Slit, WetPoint};
use crate::liquid::{InjectionDrive, Liquid, LiquidState};
use crate::scene::Scene;

/// Pressure over the largest one that is rounding.
const NOISE: f64 = 1e-9;
/// No place.
pub(super) const NONE: u32 = u32::MAX;

/// Jumps and pressures at the end of a step, as far as they are known.
pub(super) struct Trial {
    /// Pairs whose jump is an unknown, ascending; and the place of each pair among them.
    pub(super) active: Vec<u32>,
    pub(super) place: Vec<u32>,
    /// Jump of each pair [m].
    pub(super) jump: Vec<Vec3>,
    /// Pressure of each cell [Pa].
    pub(super) pressure: Vec<f64>,
    /// Cells that liquid may be in, ascending; those of them whose pressure is an unknown; and the place of each cell among these.
    pub(super) play: Vec<u32>,
    pub(super) unknown: Vec<u32>,
    pub(super) cell_place: Vec<u32>,
    /// The cell of the hole whose pressure a cell on its wall has; none before liquid may enter it.
    hole_of: Vec<u32>,
    /// Slits that let liquid through.
    is_open: Vec<bool>,
    /// The liquid at the start of the step.
    pub(super) before: LiquidState,
    /// Volume that comes to each cell by a rate, and goes into its walls, in the step [m³].
    pub(super) comes: Vec<f64>,
    pub(super) leaks: Vec<f64>,
    /// Pressure that is prescribed, by cell [Pa]; not a number elsewhere.
    pub(super) prescribed: Vec<f64>,
}

/// Flow along a way between two cells.
pub(super) struct Way<'a> {
    pub(super) slit: &'a Slit,
    pub(super) cells: [u32; 2],
    /// Flow from the first to the second per difference of pressure [m³/(Pa s)].
    pub(super) conductance: f64,
    /// Its slope by the aperture of each open corner [m²/(Pa s)].
    pub(super) slope: f64,
}

/// Force on the second node of a pair beyond the springs, and how it grows with the jump.
pub(super) fn more(interfaces: &Interfaces, joint: &Joint, jump: &Vec3) -> (Vec3, Mat3) {
    let (mut force, mut slope) = (Vec3::zeros(), Mat3::zeros());
    for point in &joint.points {
        let (local, state) = (point.local(jump), interfaces.state_of(point.at));
        let traction = point.interface.load(local, &mut state.clone()).traction();
        let spring = spring_of(point);
        force += spring * (jump - point.unloaded) - point.frame.tr_mul(&traction) * point.area;
        let tangent = point.interface.jacobian(&local, state);
        slope += spring - point.frame.transpose() * tangent * point.frame * point.area;
    }
    (force, slope)
}

/// A wet point among those of its pair.
fn of_pair<'a>(compliance: &'a Compliance, point: &WetPoint) -> Option<&'a JointPoint> {
    compliance.joints[point.joint as usize].points.iter().find(|own| own.at == point.at)
}

fn liquid(scene: &Scene) -> &Liquid {
    scene.optional.liquid.as_ref().expect("a scene that is solved with liquid has one")
}

impl Trial {
    pub(super) fn begin(scene: &Scene, compliance: &Compliance, step: &WetStep) -> Self {
        let own = liquid(scene);
        let network = &own.network;
        let (cells, joints) = (network.cells.len(), compliance.joints.len());
        let before = own.state.clone();
        let mut trial = Trial {
            active: before.active.clone(),
            place: vec![NONE; joints],
            jump: compliance.jumps(&scene.solid.displacement),
            pressure: before.pressure.clone(),
            play: Vec::new(),
            unknown: Vec::new(),
            cell_place: vec![NONE; cells],
            hole_of: vec![NONE; cells],
            is_open: vec![false; network.slits.len()],
            before,
            comes: vec![0.0; cells],
            leaks: vec![0.0; cells],
            prescribed: vec![f64::NAN; cells],
        };
        if step.dt > 0.0 {
            trial.drive(own, step);
            trial.play = (0..cells as u32).filter(|&cell| trial.is_wet(cell)).collect();
            let driven = own.injected_at.iter().flatten().map(|(cell, _)| *cell);
            trial.play.extend(driven.chain(own.holes.iter().map(|hole| hole.cell)));
        }
        trial.open_slits(scene, compliance);
        trial.number(own);
        trial
    }

    /// What comes in and leaks in the step.
    fn drive(&mut self, own: &Liquid, step: &WetStep) {
        for (injection, cells) in own.settings.injections.iter().zip(&own.injected_at) {
            for &(cell, share) in cells {
                let place = &own.network.cells[cell as usize].place;
                match &injection.drive {
                    // A step may end just behind an instant at which the rate jumps.
                    InjectionDrive::Rate(rate) => {
                        self.comes[cell as usize] += rate(step.time - 0.5 * step.dt, place) * share * step.dt
                    }
                    InjectionDrive::Pressure(value) => {
                        self.prescribed[cell as usize] = value(step.time, place).max(0.0)
                    }
                }
            }
        }
        for (index, cell) in own.network.cells.iter().enumerate() {
            // What liquid reaches first in this step, it reaches half-way on the average.
            let age = (step.time - self.before.wet_since[index]).max(0.5 * step.dt);
            if own.settings.leak_off > 0.0 {
                let all = cell.area * leaked(own.settings.leak_off, age);
                self.leaks[index] = (all - self.before.leaked[index]).max(0.0);
            }
        }
    }

    fn is_wet(&self, cell: u32) -> bool {
        self.pressure[cell as usize] > 0.0 || self.before.amount[cell as usize] > 0.0
    }

    /// Opens the slits that liquid may enter by now: those that have begun to break at all corners, or let it through whole; whether there were any.
    fn open_slits(&mut self, scene: &Scene, compliance: &Compliance) -> bool {
        let network = &liquid(scene).network;
        let lets_in = |point: &WetPoint| {
            if point.is_permeable {
                return true;
            }
            of_pair(compliance, point).is_some_and(|own| {
                let mut state = *scene.interfaces().state_of(own.at);
                own.interface.load(own.local(&self.jump[point.joint as usize]), &mut state);
                state.residual < 1.0
            })
        };
        let open: Vec<bool> = network.points.iter().map(lets_in).collect();
        let mut more = false;
        for (slit, is_open) in network.slits.iter().zip(&mut self.is_open).filter(|(_, is_open)| !**is_open) {
            *is_open = slit.points.iter().flatten().any(|&point| open[point as usize]);
            more |= *is_open;
        }
        more
    }

    /// Gives cells on the walls of holes the pressure there, if liquid may enter them.
    fn enter_from_holes(&mut self, own: &Liquid) {
        if self.play.is_empty() {
            return;
        }
        for hole in &own.holes {
            for &cell in &hole.cells {
                let may_enter = || own.network.slits_of[cell as usize].iter().any(|&slit| self.is_open[slit as usize]);
                if self.hole_of[cell as usize] == NONE && (self.is_wet(cell) || may_enter()) {
                    self.hole_of[cell as usize] = hole.cell;
                    self.play.push(cell);
                }
            }
        }
        self.share_pressures();
    }

    /// Gives cells the pressure of the hole that they belong to.
    pub(super) fn share_pressures(&mut self) {
        for (cell, &hole) in self.hole_of.iter().enumerate().filter(|(_, hole)| **hole != NONE) {
            self.pressure[cell] = self.pressure[hole as usize];
        }
    }

    /// Cells that have the pressure of one, which is the first of them.
    pub(super) fn with_pressure_of<'a>(&'a self, own: &'a Liquid, cell: u32) -> impl Iterator<Item = u32> + Clone + 'a {
        let hole = cell.checked_sub(own.cell_count() as u32).map(|hole| &own.holes[hole as usize]);
        let beside = hole.into_iter().flat_map(|hole| &hole.cells).copied();
        std::iter::once(cell).chain(beside.filter(move |&beside| self.hole_of[beside as usize] == cell))
    }

    /// Sorts what is unknown, the pairs of cells in play included; whether there are new ones.
    fn number(&mut self, own: &Liquid) -> bool {
        let network = &own.network;
        self.enter_from_holes(own);
        self.play.sort_unstable();
        self.play.dedup();
        let of = |cell: &u32| network.cells[*cell as usize].points.iter();
        let joints = self.play.iter().flat_map(of).map(|&point| network.points[point as usize].joint);
        self.active.extend(joints);
        self.active.sort_unstable();
        self.active.dedup();
        let mut is_new = false;
        for (place, &joint) in (0..).zip(&self.active) {
            is_new |= std::mem::replace(&mut self.place[joint as usize], place) == NONE;
        }
        self.unknown = self.play.iter().copied().filter(|&cell| self.hole_of[cell as usize] == NONE).collect();
        for (place, &cell) in (0..).zip(&self.unknown) {
            is_new |= std::mem::replace(&mut self.cell_place[cell as usize], place) == NONE;
        }
        for (cell, &hole) in self.hole_of.iter().enumerate().filter(|(_, hole)| **hole != NONE) {
            let place = self.cell_place[hole as usize];
            is_new |= std::mem::replace(&mut self.cell_place[cell], place) == NONE;
        }
        is_new
    }

    /// Makes unknown what turns out to break, to move or to get wet; whether there is any.
    pub(super) fn grow(&mut self, scene: &Scene, compliance: &Compliance, step: &WetStep) -> bool {
        let own = liquid(scene);
        let network = &own.network;
        let forces = self.forces(scene, compliance);
        let mut largest = f64::MIN_POSITIVE;
        let mut beyond = Vec::new();
        for (index, joint) in (0u32..).zip(&compliance.joints) {
            if self.place[index as usize] == NONE {
                let pushed = forces.iter().map(|&(active, force)| compliance.between(index, active) * force);
                self.jump[index as usize] = self.driven(compliance, step, index) + pushed.sum::<Vec3>();
                let (force, _) = more(scene.interfaces(), joint, &self.jump[index as usize]);
                beyond.push((index, force.norm()));
            }
            let pull = |own: &JointPoint| spring_of(own) * (self.jump[index as usize] - own.unloaded);
            largest = largest.max(joint.points.iter().map(pull).sum::<Vec3>().norm());
        }
        self.active.extend(beyond.iter().filter(|(_, force)| *force > MORE * largest).map(|(index, _)| *index));
        let mut more_slits = false;
        if step.dt > 0.0 {
            more_slits = self.open_slits(scene, compliance);
            let comes = |cell: &u32| self.comes[*cell as usize] > 0.0;
            let wet = self.play.iter().copied().filter(|cell| self.is_wet(*cell) || comes(cell));
            let open =
                wet.flat_map(|cell| &network.slits_of[cell as usize]).filter(|&&slit| self.is_open[slit as usize]);
            let reached = open.flat_map(|&slit| network.slits[slit as usize].ways.iter().flat_map(|way| way.0));
            let reached: Vec<u32> = reached.collect();
            self.play.extend(reached);
        }
        self.number(own) || more_slits
    }

    /// Jump of a pair under the loads and the pressures in holes [m].
    pub(super) fn driven(&self, compliance: &Compliance, step: &WetStep, joint: u32) -> Vec3 {
        let pushed = compliance.holes.iter().zip(self.of_holes(compliance));
        let pushed = pushed.map(|(hole, pressure)| hole.jumps[joint as usize] * *pressure);
        step.loaded[joint as usize] + pushed.sum::<Vec3>()
    }

    /// Pressures in holes, whose cells are the last ones [Pa].
    fn of_holes(&self, compliance: &Compliance) -> &[f64] {
        &self.pressure[self.pressure.len() - compliance.holes.len()..]
    }

    /// Volume of a hole [m³].
    ///
    /// - `forces`: of [`Trial::forces`]
    pub(super) fn hole_volume(
        &self,
        compliance: &Compliance,
        step: &WetStep,
        hole: usize,
        forces: impl Iterator<Item = (u32, Vec3)>,
    ) -> f64 {
        let HoleColumn { jumps, gains } = &compliance.holes[hole];
        let by_pressure = gains.iter().zip(self.of_holes(compliance)).map(|(gain, pressure)| gain * pressure);
        let by_forces = forces.map(|(joint, force)| jumps[joint as usize].dot(&force));
        step.volumes[hole] + by_pressure.sum::<f64>() + by_forces.sum::<f64>()
    }

    /// Adds the forces of the liquid on the walls of holes.
    pub(super) fn push_walls(&self, scene: &Scene, forces: &mut [Vec3]) {
        liquid(scene).holes.iter().for_each(|hole| hole.push(self.pressure[hole.cell as usize], forces));
    }

    /// Forces between the nodes of unknown pairs beyond the springs [N].
    pub(super) fn forces(&self, scene: &Scene, compliance: &Compliance) -> Vec<(u32, Vec3)> {
        let network = &liquid(scene).network;
        let force = |&index: &u32| {
            let (force, _) = more(scene.interfaces(), &compliance.joints[index as usize], &self.jump[index as usize]);
            (index, force + self.thrust(network, index))
        };
        self.active.iter().map(force).collect()
    }

    /// Force of the liquid on the second node of a pair [N].
    pub(super) fn thrust(&self, network: &Network, joint: u32) -> Vec3 {
        let of = |&point: &u32| {
            let WetPoint { cell, normal, area, .. } = &network.points[point as usize];
            normal * (area * self.pressure[*cell as usize])
        };
        network.points_of_joint[joint as usize].iter().map(of).sum()
    }

    /// Largest pressure of a cell [Pa].
    pub(super) fn largest_pressure(&self) -> f64 {
        self.pressure.iter().fold(0.0, |most, pressure| most.max(*pressure))
    }

    /// Largest normal traction that unknown pairs bear, or may bear [Pa].
    pub(super) fn largest_traction(&self, scene: &Scene, compliance: &Compliance) -> f64 {
        let of = |joint: &u32| {
            let jump = self.jump[*joint as usize];
            let bears = |own: &JointPoint| {
                let traction =
                    own.interface.load(own.local(&jump), &mut scene.interfaces().state_of(own.at).clone()).traction();
                traction.x.abs().max(own.interface.law.tensile_strength)
            };
            compliance.joints[*joint as usize].points.iter().map(bears).fold(0.0, f64::max)
        };
        self.active.iter().map(of).fold(f64::MIN_POSITIVE, f64::max)
    }

    /// What the walls of a cell take in the step: all that there is, if that is less than they could [m³].
    ///
    /// - `comes`: what is there without them
    pub(super) fn taken(&self, cell: usize, comes: f64) -> f64 {
        if self.pressure[cell] > 0.0 { self.leaks[cell] } else { self.leaks[cell].min(comes.max(0.0)) }
    }

    /// Takes away what rounding leaves of pressures that are none.
    pub(super) fn drop_noise(&mut self) {
        let noise = NOISE * self.largest_pressure();
        for &cell in &self.play {
            let pressure = &mut self.pressure[cell as usize];
            *pressure = if *pressure < noise { 0.0 } else { *pressure };
        }
    }

    /// Room of a cell of interfaces [m³].
    pub(super) fn room(&self, scene: &Scene, cell: u32) -> f64 {
        let network = &liquid(scene).network;
        let of = |&point: &u32| network.points[point as usize].area * self.aperture(scene, point);
        network.cells[cell as usize].points.iter().map(of).sum()
    }

    /// Aperture of a point, negative where its rough walls are closed [m].
    pub(super) fn aperture(&self, scene: &Scene, point: u32) -> f64 {
        let own = liquid(scene);
        let WetPoint { joint, normal, .. } = &own.network.points[point as usize];
        own.settings.aperture + normal.dot(&self.jump[*joint as usize]) - self.before.closed[point as usize]
    }

    /// The ways between cells in play.
    pub(super) fn ways<'a>(&'a self, scene: &'a Scene) -> impl Iterator<Item = Way<'a>> {
        let own = liquid(scene);
        let slits = own.network.slits.iter().zip(&self.is_open).filter(|(_, is_open)| **is_open);
        slits.flat_map(move |(slit, _)| {
            let in_play = |(cells, _): &&([u32; 2], f64)| cells.iter().all(|&c| self.cell_place[c as usize] != NONE);
            let any = slit.ways.iter().any(|way| in_play(&way));
            let mean = if any {
                let open = slit.points.iter().flatten().map(|&point| self.aperture(scene, point).max(0.0));
                open.sum::<f64>() / slit.corners as f64
            } else {
                0.0
            };
            let [flow, slope] = own.settings.law.transmissivity(mean);
            let way = move |&(cells, ratio): &([u32; 2], f64)| {
                let (conductance, slope) = (ratio * flow, ratio * slope / slit.corners as f64);
                Way { slit, cells, conductance, slope }
            };
            slit.ways.iter().filter(in_play).map(way).collect::<Vec<_>>()
        })
    }

    /// Volume that flows into each cell in the step [m³].
    pub(super) fn inflow(&self, scene: &Scene, dt: f64) -> Vec<f64> {
        let mut inflow = vec![0.0; self.pressure.len()];
        for Way { cells: [a, b], conductance, .. } in self.ways(scene) {
            let flow = dt * conductance * (self.pressure[a as usize] - self.pressure[b as usize]);
            inflow[a as usize] -= flow;
            inflow[b as usize] += flow;
        }
        inflow
    }

    /// The liquid at the end of the step.
    pub(super) fn into_state(self, scene: &Scene, compliance: &Compliance, step: &WetStep) -> LiquidState {
        let own = liquid(scene);
        let mut state = self.before.clone();
        if step.dt == 0.0 {
            let closed = |point: &WetPoint| {
                let [jump, unloaded] = [
                    self.jump[point.joint as usize],
                    of_pair(compliance, point).map_or_else(Vec3::zeros, |own| own.unloaded),
                ];
                point.normal.dot(&unloaded) + point.normal.dot(&(jump - unloaded)).min(0.0)
            };
            state.closed = own.network.points.iter().map(closed).collect();
            state.has_begun = true;
        }
        let trial = Trial { before: LiquidState { closed: state.closed.clone(), ..self.before.clone() }, ..self };
        state.aperture = (0..own.network.points.len() as u32).map(|point| trial.aperture(scene, point)).collect();
        state.room = (0..own.cell_count() as u32).map(|cell| trial.room(scene, cell)).collect();
        let forces = trial.forces(scene, compliance);
        let volume = |hole: usize| trial.hole_volume(compliance, step, hole, forces.iter().copied());
        state.room.extend((0..own.holes.len()).map(volume));
        if step.dt == 0.0 {
            own.holes.iter().for_each(|hole| state.amount[hole.cell as usize] = state.room[hole.cell as usize]);
        } else {
            trial.book(own, scene, step, &mut state);
        }
        state.active = trial.active;
        state.pressure = trial.pressure;
        state
    }

    /// Amounts and energies at the end of a step.
    fn book(&self, own: &Liquid, scene: &Scene, step: &WetStep, state: &mut LiquidState) {
        let before = &self.before;
        let mean = |cell: usize| 0.5 * (before.pressure[cell] + self.pressure[cell]);
        let mut inflow = self.inflow(scene, step.dt);
        let mut put_in = vec![0.0; inflow.len()];
        for (cell, hole) in self.hole_of.iter().enumerate().filter(|(_, hole)| **hole != NONE) {
            let (hole, room, pressure) = (*hole as usize, state.room[cell], self.pressure[cell]);
            let without = before.amount[cell] + inflow[cell];
            let without = without - self.taken(cell, without);
            // A cell on the wall of a hole is as full as the hole: it takes the rest from there.
            let full = room + own.compressed(cell, room, pressure);
            let amount = if pressure > 0.0 { full } else { without.clamp(0.0, full.max(0.0)) };
            inflow[cell] += amount - without;
            inflow[hole] -= amount - without;
            state.viscous += (amount - without) * (mean(hole) - mean(cell));
        }
        for &cell in &self.play {
            let cell = cell as usize;
            let pressure = self.pressure[cell];
            let held = [(before.room[cell], before.pressure[cell]), (state.room[cell], pressure)];
            let [was, is] = held.map(|(room, pressure)| own.compressed(cell, room, pressure));
            let comes = before.amount[cell] + inflow[cell];
            let taken = self.taken(cell, comes + self.comes[cell]);
            let without = comes - taken;
            put_in[cell] = self.comes[cell];
            if !self.prescribed[cell].is_nan() {
                put_in[cell] = state.room[cell] + is - without;
            }
            state.amount[cell] = without + put_in[cell];
            state.leaked[cell] += taken;
            if (pressure > 0.0 || comes + self.comes[cell] > 0.0) && state.wet_since[cell].is_infinite() {
                state.wet_since[cell] = step.time - 0.5 * step.dt;
            }
            let empty = [before.room[cell] + was - before.amount[cell], state.room[cell] + is - state.amount[cell]];
            state.injected += put_in[cell];
            state.supplied += mean(cell) * put_in[cell];
            state.stored += mean(cell) * (is - was);
            state.lost += mean(cell) * taken;
            state.viscous += mean(cell) * (empty[0] - empty[1]);
        }
        for Way { cells, conductance, .. } in self.ways(scene) {
            let [a, b] = cells.map(|cell| cell as usize);
            let flow = step.dt * conductance * (self.pressure[a] - self.pressure[b]);
            state.viscous += flow * (mean(a) - mean(b));
        }
        let rate =
            |cells: &Vec<(u32, f64)>| cells.iter().map(|(cell, _)| put_in[*cell as usize]).sum::<f64>() / step.dt;
        state.rates = own.injected_at.iter().map(rate).collect();
    }
}
