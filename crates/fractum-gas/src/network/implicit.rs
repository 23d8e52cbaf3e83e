//! A step that is implicit in the pressures: cells that exchange their gas many times in a step find a common pressure.

use crate::network::{Amount, Network};
use crate::slit::{Passage, SlitFlow};

/// Largest storage of a cell: its pressure stays, and products with it stay numbers.
const FIRMEST: f64 = 1e100;
/// Residual of the pressures over the right-hand side at which the iteration ends. The flows conserve mass whatever it is.
const TOLERANCE: f64 = 1e-9;
/// Iterations at most.
const MOST_ITERATIONS: usize = 200;
/// Part of what it has that a cell passes on in a step at most.
const LARGEST_PASS: f64 = 0.9;

/// Arrays of the implicit step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    /// Mass per pressure of each cell over the step [kg/(s Pa)].
    storage: Vec<f64>,
    diagonal: Vec<f64>,
    pressure: Vec<f64>,
    residual: Vec<f64>,
    direction: Vec<f64>,
    product: Vec<f64>,
    /// Cells by falling pressure, and the rank of each.
    order: Vec<u32>,
    rank: Vec<u32>,
    /// Rank of the upstream cell and index of each passage.
    ways: Vec<(u32, u32)>,
}

impl Network {
    /// One step of backward Euler: S (pⁿ⁺¹ − pⁿ)/Δt = Σ C (pⁿ⁺¹ⱼ − pⁿ⁺¹ᵢ), with conductances C of tⁿ; mass and enthalpy then
    /// go with these flows, cell by cell down the pressures, so that what a cell passes on has been mixed with what it got.
    pub(crate) fn implicit_step(&mut self, dt: f64, passages: &[Passage]) {
        self.assemble(dt, passages);
        self.solve_pressures(passages);
        self.limit_flows(passages);
        self.sweep(dt, passages);
    }

    fn assemble(&mut self, dt: f64, passages: &[Passage]) {
        let crate::network::Scratch { cells, conductance, rate, implicit, .. } = &mut self.scratch;
        let Scratch { storage, diagonal, pressure, residual, .. } = implicit;
        pressure.clear();
        pressure.extend(cells.iter().map(|cell| cell.upstream.pressure));
        diagonal.clear();
        diagonal.resize(cells.len(), 0.0);
        residual.clear();
        residual.resize(cells.len(), 0.0);
        for (passage, &c) in passages.iter().zip(&*conductance) {
            let [i, j] = passage.cells.map(|cell| cell as usize);
            diagonal[i] += c;
            match pressure.get(j) {
                Some(other) => {
                    diagonal[j] += c;
                    residual[i] += c * (other - pressure[i]);
                    residual[j] += c * (pressure[i] - other);
                }
                None => residual[i] += c * (self.outside_pressure - pressure[i]),
            }
        }
        // The rate of a cell is Σ C times the change of its pressure per mass, which gives that change back.
        storage.clear();
        storage.extend(
            rate.iter().zip(&*diagonal).map(|(rate, c)| if *rate > 0.0 { (c / (rate * dt)).min(FIRMEST) } else { 1.0 }),
        );
        diagonal.iter_mut().zip(&*storage).for_each(|(d, s)| *d += s);
    }

    /// Conjugate gradients with the diagonal, from the present pressures.
    fn solve_pressures(&mut self, passages: &[Passage]) {
        let crate::network::Scratch { conductance, implicit, .. } = &mut self.scratch;
        let Scratch { storage, diagonal, pressure, residual, direction, product, .. } = implicit;
        let weighted = |r: &[f64], d: &[f64]| r.iter().zip(d).map(|(r, d)| r * r / d).sum::<f64>();
        direction.clear();
        direction.extend(residual.iter().zip(&*diagonal).map(|(r, d)| r / d));
        product.resize(storage.len(), 0.0);
        let mut square = weighted(residual, diagonal);
        let enough = square * TOLERANCE * TOLERANCE;
        for _ in 0..MOST_ITERATIONS {
            if square <= enough {
                break;
            }
            product.iter_mut().zip(storage.iter().zip(&*direction)).for_each(|(y, (s, x))| *y = s * x);
            for (passage, &c) in passages.iter().zip(&*conductance) {
                let [i, j] = passage.cells.map(|cell| cell as usize);
                let flow = c * (direction[i] - direction.get(j).copied().unwrap_or(0.0));
                product[i] += flow;
                if let Some(y) = product.get_mut(j) {
                    *y -= flow;
                }
            }
            let along: f64 = direction.iter().zip(&*product).map(|(d, y)| d * y).sum();
            if along <= 0.0 {
                break;
            }
            let step = square / along;
            pressure.iter_mut().zip(&*direction).for_each(|(p, d)| *p += step * d);
            residual.iter_mut().zip(&*product).for_each(|(r, y)| *r -= step * y);
            let next = weighted(residual, diagonal);
            let ratio = next / square;
            square = next;
            for (d, (r, diagonal)) in direction.iter_mut().zip(residual.iter().zip(&*diagonal)) {
                *d = r / diagonal + ratio * *d;
            }
        }
    }

    /// Flows of the new pressures, never above the choked ones.
    fn limit_flows(&mut self, passages: &[Passage]) {
        let crate::network::Scratch { cells, conductance, flow, implicit, .. } = &mut self.scratch;
        for ((passage, &c), flow) in passages.iter().zip(&*conductance).zip(flow) {
            let [i, j] = passage.cells.map(|cell| cell as usize);
            let other = implicit.pressure.get(j).copied().unwrap_or(self.outside_pressure);
            *flow = c * (implicit.pressure[i] - other);
            let up = if *flow >= 0.0 { cells.get(i) } else { cells.get(j) };
            // An empty cell that has gas by now is as tight as the cell before it.
            let most = match up {
                Some(up) if up.upstream.density > 0.0 => SlitFlow::choked(passage, &up.upstream),
                Some(_) => flow.abs(),
                None => 0.0,
            };
            *flow = flow.clamp(-most, most);
        }
    }

    /// Moves mass and enthalpy down the pressures.
    fn sweep(&mut self, dt: f64, passages: &[Passage]) {
        let nothing = self.contents.nothing();
        let crate::network::Scratch { cells, flow, implicit, .. } = &mut self.scratch;
        let Scratch { pressure, order, rank, ways, .. } = implicit;
        order.clear();
        order.extend(0..cells.len() as u32);
        order.sort_unstable_by(|&a, &b| pressure[b as usize].total_cmp(&pressure[a as usize]).then(a.cmp(&b)));
        rank.resize(cells.len(), 0);
        (0..).zip(&*order).for_each(|(place, &cell)| rank[cell as usize] = place);
        ways.clear();
        let moving = (0u32..).zip(passages.iter().zip(&*flow)).filter(|(_, (_, flow))| **flow != 0.0);
        ways.extend(moving.map(|(k, (passage, flow))| (rank[passage.cells[usize::from(*flow < 0.0)] as usize], k)));
        ways.sort_unstable();
        for group in ways.chunk_by(|a, b| a.0 == b.0) {
            let from = order[group[0].0 as usize];
            let Amount { mass, energy } = self.contents.cells[from as usize];
            let wanted = dt * group.iter().map(|way| flow[way.1 as usize].abs()).sum::<f64>();
            if mass <= nothing || energy <= 0.0 || wanted <= 0.0 {
                continue;
            }
            let share = (LARGEST_PASS * mass / wanted).min(1.0);
            let passed = share * wanted;
            // What leaves has the enthalpy of what is left: U' = U − h m, h = k U'/(M − m).
            let ratio = cells[from as usize].enthalpy_ratio;
            let energy_left = energy / (1.0 + passed * ratio / (mass - passed));
            let enthalpy = (energy - energy_left) / passed;
            for way in group {
                let index = way.1 as usize;
                let [a, b] = passages[index].cells;
                let to = if flow[index] < 0.0 { a } else { b };
                let mass = share * dt * flow[index].abs();
                self.contents.pass(from, to, Amount { mass, energy: mass * enthalpy });
                // An empty cell has no ratio of its own yet.
                if let Some(cell) = cells.get_mut(to as usize).filter(|cell| cell.upstream.density == 0.0) {
                    cell.enthalpy_ratio = ratio;
                }
            }
        }
    }
}

#[cfg(test)]
impl Scratch {
    /// Room of all arrays together.
    pub(crate) fn capacity(&self) -> usize {
        let Scratch { storage, diagonal, pressure, residual, direction, product, order, rank, ways } = self;
        let of_cells = [storage, diagonal, pressure, residual, direction, product].map(Vec::capacity);
        of_cells.iter().sum::<usize>() + order.capacity() + rank.capacity() + ways.capacity()
    }
}
