use std::ops::AddAssign;

use serde::{Deserialize, Serialize};

mod implicit;

use crate::law::{EquationOfState, Law};
use crate::slit::{Passage, SlitFlow, Upstream};

/// Part of its mass that a cell loses in a substep at most.
const LARGEST_LOSS: f64 = 0.2;
/// Part of the stable step of the pressures that a substep takes.
const SAFETY: f64 = 0.5;
/// Substeps above which the pressures are found implicitly.
const MOST_SUBSTEPS: f64 = 200.0;
/// Times that an implicit step may exchange the contents of a cell.
const LARGEST_EXCHANGE: f64 = 2.0;
/// Part of all gas below which a cell counts as empty: gas that runs ahead through a long crack falls as a square from cell to cell, and would
/// soon be too little for a number.
const NOTHING: f64 = 1e-30;
/// Implicit steps in a step at most.
const MOST_IMPLICIT: f64 = 20.0;

/// Mass and internal energy of some gas.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Amount {
    /// Mass [kg].
    pub mass: f64,
    /// Internal energy; of gas that flows, enthalpy [J].
    pub energy: f64,
}

impl AddAssign for Amount {
    fn add_assign(&mut self, other: Amount) {
        self.mass += other.mass;
        self.energy += other.energy;
    }
}

/// Everything that changes in a network, for a checkpoint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Contents {
    /// What each cell holds.
    pub cells: Vec<Amount>,
    /// What rounding has taken from each of these, to be made good with what comes next (Kahan's sum): a large cell that
    /// loses tiny amounts in a million steps would lose some mass for nothing.
    rounding: Vec<Amount>,
    /// What was put in so far.
    pub supplied: Amount,
    /// What has flowed to the outside so far, with its enthalpy.
    pub leaked: Amount,
}

/// What flow needs to know about a cell at one instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CellNow {
    pub(crate) upstream: Upstream,
    /// Enthalpy per mass [J/kg].
    pub(crate) enthalpy: f64,
    /// Enthalpy over internal energy.
    pub(crate) enthalpy_ratio: f64,
    /// Change of pressure per mass that comes or goes [Pa/kg].
    pub(crate) stiffness: f64,
    /// Change of pressure per energy that comes [Pa/J].
    pub(crate) slope: f64,
}

/// Arrays of one substep, kept so that a step allocates nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    pub(crate) cells: Vec<CellNow>,
    /// Conductance of each passage [kg/(s Pa)].
    pub(crate) conductance: Vec<f64>,
    /// Flow through each passage, from its first cell to its second [kg/s].
    pub(crate) flow: Vec<f64>,
    /// What leaves each cell [kg/s].
    pub(crate) outflow: Vec<f64>,
    /// How fast the pressure of each cell follows its neighbours [1/s].
    pub(crate) rate: Vec<f64>,
    pub(crate) implicit: implicit::Scratch,
}

/// Cells of gas.
#[derive(Clone, Debug)]
pub struct Network {
    gas: EquationOfState,
    pub(crate) slits: SlitFlow,
    pub(crate) outside_pressure: f64,
    pub(crate) contents: Contents,
    pub(crate) scratch: Scratch,
}

impl Network {
    /// A network without cells.
    ///
    /// - `outside_pressure`: where gas that leaks goes [Pa]
    pub fn new(gas: EquationOfState, slits: SlitFlow, outside_pressure: f64) -> Self {
        Network { gas, slits, outside_pressure, contents: Contents::default(), scratch: Scratch::default() }
    }

    /// The law of the gas.
    pub fn law(&self) -> &dyn Law {
        self.gas.law()
    }

    /// Adds a cell with what it holds, which counts as supplied.
    pub fn push_cell(&mut self, amount: Amount) {
        self.contents.cells.push(amount);
        self.contents.rounding.push(Amount::default());
        self.contents.supplied += amount;
    }

    /// Leaves the first cells, of which the others have got nothing yet.
    pub fn truncate(&mut self, count: usize) {
        self.contents.cells.truncate(count);
        self.contents.rounding.truncate(count);
    }

    /// Puts gas into a cell.
    pub fn supply(&mut self, cell: usize, amount: Amount) {
        self.contents.add(cell, amount);
        self.contents.supplied += amount;
    }

    /// Everything that changes.
    pub fn contents(&self) -> &Contents {
        &self.contents
    }

    /// Puts saved contents back.
    pub fn restore(&mut self, contents: Contents) {
        self.contents = contents;
    }

    /// Gas in all cells.
    pub fn total(&self) -> Amount {
        let mut sum = Amount::default();
        self.contents.cells.iter().for_each(|&cell| sum += cell);
        sum
    }

    /// Pressure of a cell in its volume [Pa].
    pub fn pressure(&self, cell: usize, volume: f64) -> f64 {
        let Amount { mass, energy } = self.contents.cells[cell];
        self.law().pressure_line(mass, volume).at(energy)
    }

    /// Temperature of a cell in its volume [K]; 0 where it is empty.
    pub fn temperature(&self, cell: usize, volume: f64) -> f64 {
        let Amount { mass, energy } = self.contents.cells[cell];
        if mass > 0.0 { self.law().temperature(mass / volume, energy / mass) } else { 0.0 }
    }

    /// ρ c² of a cell: how much its pressure rises as its volume shrinks, over the relative change [Pa].
    pub fn modulus(&self, cell: usize, volume: f64) -> f64 {
        let Amount { mass, energy } = self.contents.cells[cell];
        let density = mass / volume;
        if mass > 0.0 { density * self.law().sound_speed_squared(density, energy / mass) } else { 0.0 }
    }

    /// Takes work out of a cell [J].
    pub fn do_work(&mut self, cell: usize, work: f64) {
        self.contents.add(cell, Amount { mass: 0.0, energy: -work });
    }

    /// Takes the work p · `swept` of the pressure that is left after it out of a cell; returns that pressure [Pa].
    ///
    /// - `swept`: volume that the walls sweep at this pressure [m³]
    pub fn push_walls(&mut self, cell: usize, volume: f64, swept: f64) -> f64 {
        let Amount { mass, energy } = self.contents.cells[cell];
        let line = self.law().pressure_line(mass, volume);
        let divisor = 1.0 + line.slope * swept;
        // Walls that come in by more than half of what is there are pushed by the pressure before.
        let after = if divisor > 0.5 { (energy - line.at_zero * swept) / divisor } else { energy };
        let pressure = line.at(after);
        // Where the law would give a negative pressure there is none, and no work.
        self.do_work(cell, pressure * swept);
        pressure
    }

    /// Lets gas flow between the cells, and to the outside, for a time [s]; returns the substeps taken.
    ///
    /// Explicit substeps in which no cell loses more than a fifth of its mass and no pressure overshoots its neighbours';
    /// implicit in the pressures where more than 200 of them would be needed.
    ///
    /// - `volumes`: of the cells [m³]
    /// - `passages`: slits between them; those without opening let nothing through
    pub fn flow(&mut self, dt: f64, volumes: &[f64], passages: &[Passage]) -> usize {
        let mut left = dt;
        let mut steps = 0;
        while left > 0.0 {
            let step = self.find_flows(volumes, passages);
            if left / step + steps as f64 > MOST_SUBSTEPS {
                return steps + self.flow_implicitly(left, volumes, passages);
            }
            let step = left / (left / step).ceil().max(1.0);
            self.transfer(step, passages);
            left -= step;
            steps += 1;
            if left < 1e-12 * dt {
                break;
            }
        }
        steps
    }

    fn flow_implicitly(&mut self, dt: f64, volumes: &[f64], passages: &[Passage]) -> usize {
        let cells = self.contents.cells.iter().zip(&self.scratch.outflow);
        let exchange = cells.filter(|(cell, _)| cell.mass > 0.0).map(|(cell, out)| out / cell.mass).fold(0.0, f64::max);
        let count = (dt * exchange / LARGEST_EXCHANGE).ceil().clamp(1.0, MOST_IMPLICIT);
        for index in 0..count as usize {
            if index > 0 {
                self.find_flows(volumes, passages);
            }
            self.implicit_step(dt / count, passages);
        }
        count as usize
    }

    /// The state of every cell and the flow through every passage; returns the largest explicit substep [s].
    fn find_flows(&mut self, volumes: &[f64], passages: &[Passage]) -> f64 {
        let Network { gas, slits, outside_pressure, contents, scratch } = self;
        let Scratch { cells, conductance, flow, outflow, rate, .. } = scratch;
        let (law, nothing) = (gas.law(), contents.nothing());
        cells.clear();
        let now = |(amount, &volume): (&Amount, &f64)| CellNow::new(law, *amount, volume, nothing);
        cells.extend(contents.cells.iter().zip(volumes).map(now));
        conductance.clear();
        flow.clear();
        outflow.clear();
        outflow.resize(cells.len(), 0.0);
        rate.clear();
        rate.resize(cells.len(), 0.0);
        for passage in passages {
            let [first, second] = passage.cells.map(|cell| cells.get(cell as usize).copied());
            let Some(first) = first else { continue };
            let p = [first.upstream.pressure, second.map_or(*outside_pressure, |cell| cell.upstream.pressure)];
            let (up, drop) = if p[0] >= p[1] { (Some(first), p[0] - p[1]) } else { (second, p[1] - p[0]) };
            // Nothing flows in from the outside, out of an empty cell or through a closed slit.
            let Some(up) = up.filter(|up| up.upstream.density > 0.0 && passage.opening > 0.0) else {
                conductance.push(0.0);
                flow.push(0.0);
                continue;
            };
            let c = slits.conductance(passage, &up.upstream, drop);
            conductance.push(c);
            flow.push(c * (p[0] - p[1]));
            outflow[passage.cells[usize::from(p[0] < p[1])] as usize] += c * drop;
            for (end, cell) in passage.cells.iter().zip([Some(first), second]) {
                if let Some(cell) = cell {
                    rate[*end as usize] += c * cell.stiffness.max(cell.slope * up.enthalpy);
                }
            }
        }
        let losses = contents.cells.iter().zip(&*outflow).filter(|(_, out)| **out > 0.0);
        let loss = losses.map(|(cell, out)| LARGEST_LOSS * cell.mass / out).fold(f64::INFINITY, f64::min);
        let fastest = rate.iter().copied().fold(0.0, f64::max);
        if fastest > 0.0 { loss.min(SAFETY / fastest) } else { loss }
    }

    /// Moves mass and enthalpy for a substep.
    fn transfer(&mut self, dt: f64, passages: &[Passage]) {
        let Network { contents, scratch, .. } = self;
        for (passage, &flow) in passages.iter().zip(&scratch.flow) {
            let [from, to] = if flow >= 0.0 { passage.cells } else { [passage.cells[1], passage.cells[0]] };
            let mass = flow.abs() * dt;
            if mass > 0.0 {
                contents.pass(from, to, Amount { mass, energy: mass * scratch.cells[from as usize].enthalpy });
            }
        }
    }
}

impl Contents {
    /// Mass up to which a cell counts as empty [kg].
    pub(crate) fn nothing(&self) -> f64 {
        NOTHING * self.supplied.mass
    }

    /// Passes gas on, to the outside if there is no cell `to`.
    pub(crate) fn pass(&mut self, from: u32, to: u32, amount: Amount) {
        self.add(from as usize, Amount { mass: -amount.mass, energy: -amount.energy });
        if (to as usize) < self.cells.len() {
            self.add(to as usize, amount);
        } else {
            self.leaked += amount;
        }
    }

    fn add(&mut self, cell: usize, amount: Amount) {
        let (cell, rounding) = (&mut self.cells[cell], &mut self.rounding[cell]);
        let add = |to: &mut f64, lost: &mut f64, more: f64| {
            let more = more - *lost;
            let sum = *to + more;
            *lost = (sum - *to) - more;
            *to = sum;
        };
        add(&mut cell.mass, &mut rounding.mass, amount.mass);
        add(&mut cell.energy, &mut rounding.energy, amount.energy);
    }
}

impl CellNow {
    /// - `nothing`: mass up to which it is empty [kg]
    fn new(law: &dyn Law, amount: Amount, volume: f64, nothing: f64) -> Self {
        let Amount { mass, energy } = amount;
        let line = law.pressure_line(mass, volume);
        if mass <= nothing || energy <= 0.0 {
            let upstream = Upstream { pressure: line.at(energy), density: 0.0, sound_speed: 0.0 };
            return CellNow { upstream, enthalpy: 0.0, enthalpy_ratio: 1.0, stiffness: 0.0, slope: line.slope };
        }
        let (density, pressure) = (mass / volume, line.at(energy));
        let square = law.sound_speed_squared(density, energy / mass);
        let enthalpy = (energy + pressure * volume) / mass;
        CellNow {
            upstream: Upstream { pressure, density, sound_speed: square.sqrt() },
            enthalpy,
            enthalpy_ratio: enthalpy * mass / energy,
            stiffness: square / volume,
            slope: line.slope,
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::law::PerfectGas;

    /// Room of every array of a step.
    fn capacities(scratch: &Scratch) -> [usize; 6] {
        let Scratch { cells, conductance, flow, outflow, rate, implicit } = scratch;
        let own = [cells.capacity(), conductance.capacity(), flow.capacity(), outflow.capacity(), rate.capacity()];
        [own[0], own[1], own[2], own[3], own[4], implicit.capacity()]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4000))]

        #[test]
        fn gas_that_runs_ahead_through_a_long_crack_stays_a_number(
            cells in prop::collection::vec((-323.0f64..1.0, -9.0f64..7.0, -10.0f64..0.0, -9.0f64..-1.0), 2..12),
            step in -9.0f64..-2.0,
        ) {
            let gas = EquationOfState::PerfectGas(PerfectGas { heat_ratio: 1.25, gas_constant: 320.0 });
            let mut network = Network::new(gas, SlitFlow { viscosity: 2e-5, roughness: 1e-5 }, 1e5);
            network.push_cell(Amount { mass: 100.0, energy: 3e8 });
            let (mut passages, mut volumes) = (Vec::new(), vec![1.7]);
            for (cell, (mass, energy, volume, opening)) in (0..).zip(cells) {
                let mass = 10f64.powf(mass);
                network.push_cell(Amount { mass, energy: 10f64.powf(energy) * mass });
                let opening = 10f64.powf(opening);
                passages.push(Passage { cells: [cell, cell + 1], length: 0.3, width: 1.0, opening });
                volumes.push(10f64.powf(volume));
            }
            let before = network.total();
            for _ in 0..20 {
                network.flow(10f64.powf(step), &volumes, &passages);
                let now = network.total();
                prop_assert!((now.mass / before.mass - 1.0).abs() < 1e-12 && (now.energy / before.energy - 1.0).abs() < 1e-12, "{now:?}");
            }
        }
    }

    #[test]
    fn a_warm_step_asks_for_no_memory_explicit_or_implicit() {
        let air = EquationOfState::PerfectGas(PerfectGas { heat_ratio: 1.4, gas_constant: 287.0 });
        let mut network = Network::new(air, SlitFlow { viscosity: 2e-5, roughness: 1e-5 }, 1e5);
        network.push_cell(Amount { mass: 1e-3, energy: 1e3 });
        let mut passages = Vec::new();
        for cell in 0..30 {
            network.push_cell(Amount::default());
            passages.push(Passage { cells: [cell, cell + 1], length: 1e-3, width: 0.01, opening: 1e-4 });
        }
        let volumes = vec![1e-8; 31];
        let substeps = [1e-8, 1e-3].map(|dt| network.flow(dt, &volumes, &passages));
        assert!(substeps[0] <= 200 && substeps[1] > 0);
        let warm = capacities(&network.scratch);
        assert!(warm.iter().all(|capacity| *capacity > 0), "both ways were gone: {warm:?}");
        for _ in 0..50 {
            network.flow(1e-8, &volumes, &passages);
            network.flow(1e-3, &volumes, &passages);
        }
        assert_eq!(capacities(&network.scratch), warm);
    }
}
