//! What is seen of a liquid.

use fractum_math::Vec3;

use super::network::WetPoint;
use super::{Liquid, LiquidState};
use crate::interfaces::Interfaces;

/// Something about a liquid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LiquidMeasure {
    /// Pressure where it comes in: mean over the cells [Pa].
    Pressure,
    /// Aperture there, mean over the cells [m].
    Aperture,
    /// Rate at which it comes in [m³/s].
    Rate,
    /// Volume put in so far [m³].
    Injected,
    /// Volume in the interfaces [m³].
    Volume,
    /// Volume that the walls have taken [m³].
    Leaked,
    /// Area that is wet; of cells that are partly filled that part [m²].
    WettedArea,
    /// Distance of the front from where it comes in, or from the middle of the hole where it does [m].
    Front,
    /// Pressure in a hole; of all holes the mean over their volumes [Pa].
    HolePressure,
    /// Volume in a hole, or in all of them [m³].
    HoleVolume,
}

/// Liquid on a face: means over its corners.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LiquidReading {
    /// Pressure [Pa].
    pub pressure: f64,
    /// Aperture; 0 where rough walls are closed [m].
    pub aperture: f64,
    /// Part of the room that is filled.
    pub filled: f64,
}

/// Volume below nothing in a cell, over its area and the extent of all cells, that is more than rounding.
const OVERDRAWN: f64 = 1e-9;

impl Liquid {
    /// Area of all cells, if liquid is in each [m²].
    pub(crate) fn area_if_all_wet(&self, interfaces: &Interfaces) -> Option<f64> {
        let cells = &self.network.cells[..self.cell_count()];
        let all_wet = (0..cells.len()).all(|cell| self.wet_area(interfaces, cell) > 0.0);
        (all_wet && !cells.is_empty()).then(|| cells.iter().map(|cell| cell.area).sum())
    }

    /// Area of a cell that liquid is in: that at the tip presses on a cell that is still whole [m²].
    fn wet_area(&self, interfaces: &Interfaces, cell: usize) -> f64 {
        let points = self.network.cells[cell].points.iter().map(|&point| &self.network.points[point as usize]);
        let lets_in = |point: &&WetPoint| point.is_permeable || interfaces.state_of(point.at).residual < 1.0;
        // The sum over no point at all is -0.
        self.filled(cell) * points.filter(lets_in).map(|point| point.area).sum::<f64>() + 0.0
    }

    /// Volume that was drawn and was not there, if there is any [m³].
    pub(crate) fn overdrawn(&self) -> Option<f64> {
        let LiquidState { pressure, amount, room, .. } = &self.state;
        let extent = (0..amount.len()).map(|cell| self.area(cell)).sum::<f64>().sqrt();
        // Sides that press on each other have less than no room.
        let missing = |cell: usize| {
            let below = room[cell].min(0.0) - amount[cell];
            let seen = OVERDRAWN * self.area(cell) * extent;
            if pressure[cell] <= 0.0 && below > seen { below } else { 0.0 }
        };
        let missing: f64 = (0..amount.len()).map(missing).sum();
        (missing > 0.0).then_some(missing)
    }

    /// Part of the room of a cell that is filled.
    fn filled(&self, cell: usize) -> f64 {
        let [amount, room] = [self.state.amount[cell], self.state.room[cell]];
        if self.state.pressure[cell] > 0.0 {
            1.0
        } else if amount > 0.0 && room > 0.0 {
            (amount / room).min(1.0)
        } else {
            0.0
        }
    }

    fn aperture_of(&self, cell: usize) -> f64 {
        let cell = &self.network.cells[cell];
        let sum = |&point: &u32| self.network.points[point as usize].area * self.state.aperture[point as usize];
        cell.points.iter().map(sum).sum::<f64>() / cell.area
    }

    /// Area of a cell, or of the wall of a hole [m²].
    pub(crate) fn area(&self, cell: usize) -> f64 {
        cell.checked_sub(self.cell_count()).map_or(self.network.cells[cell].area, |hole| self.holes[hole].area)
    }

    /// Something about it.
    ///
    /// - `hole`: the one that is meant, by its number; all of them if absent
    pub fn measure(&self, interfaces: &Interfaces, measure: LiquidMeasure, hole: Option<usize>) -> f64 {
        let at = || self.injected_at.iter().flatten().map(|(cell, _)| *cell as usize);
        let mean = |cells: &[usize], weight: &dyn Fn(usize) -> f64, of: &dyn Fn(usize) -> f64| {
            let weights = cells.iter().map(|&cell| weight(cell)).sum::<f64>();
            cells.iter().map(|&cell| weight(cell) * of(cell)).sum::<f64>() / weights
        };
        let (area, pressure) = (|cell: usize| self.area(cell), |cell: usize| self.state.pressure[cell]);
        let cells = 0..self.cell_count();
        let meant = self.holes.iter().enumerate().filter(|(index, _)| hole.is_none_or(|own| own == *index));
        let meant: Vec<usize> = meant.map(|(_, own)| own.cell as usize).collect();
        match measure {
            LiquidMeasure::HolePressure => mean(&meant, &|cell| self.holes[cell - self.cell_count()].volume, &pressure),
            LiquidMeasure::HoleVolume => meant.iter().map(|&cell| self.state.amount[cell]).sum(),
            LiquidMeasure::Pressure => mean(&at().collect::<Vec<_>>(), &area, &pressure),
            LiquidMeasure::Aperture => {
                // What opens beside a hole that liquid is put in does so on its wall.
                let beside = |cell: usize| match cell.checked_sub(self.cell_count()) {
                    Some(hole) => self.holes[hole].cells.iter().map(|&cell| cell as usize).collect(),
                    None => vec![cell],
                };
                mean(&at().flat_map(beside).collect::<Vec<_>>(), &area, &|cell| self.aperture_of(cell))
            }
            LiquidMeasure::Rate => self.state.rates.iter().sum(),
            LiquidMeasure::Injected => self.state.injected,
            LiquidMeasure::Volume => self.state.amount[cells].iter().sum(),
            LiquidMeasure::Leaked => self.state.leaked.iter().sum(),
            LiquidMeasure::WettedArea => cells.map(|cell| self.wet_area(interfaces, cell)).sum(),
            LiquidMeasure::Front => {
                let places: Vec<Vec3> = at().map(|cell| self.network.cells[cell].place).collect();
                let middle = places.iter().sum::<Vec3>() / places.len().max(1) as f64;
                let wet = cells.filter(|&cell| self.wet_area(interfaces, cell) > 0.0);
                wet.map(|cell| (self.network.cells[cell].place - middle).norm()).fold(0.0, f64::max)
            }
        }
    }

    /// Liquid on a face; none of an interface that it does not flow in.
    pub fn reading(&self, interfaces: &Interfaces, face: usize) -> Option<LiquidReading> {
        let own = &interfaces.faces()[face];
        if !self.settings.interfaces.contains(&own.kind) {
            return None;
        }
        let share = 1.0 / own.corners() as f64;
        let mut mean = LiquidReading::default();
        for at in interfaces.points_of_face(face).into_iter().flatten() {
            let Some(index) = self.network.point_at(at).map(|point| point as usize) else { continue };
            let cell = self.network.points[index].cell as usize;
            mean.pressure += share * self.state.pressure[cell];
            mean.aperture += share * self.state.aperture[index].max(0.0);
            mean.filled += share * self.filled(cell);
        }
        Some(mean)
    }
}
