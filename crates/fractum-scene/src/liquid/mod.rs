//! Liquid in interfaces and in holes: injection, flow by the cubic law, storage, leak-off, and the front up to which a crack is filled.
//!
//! Every place at which nodes are doubled is a cell with a pressure. Its room is that between the sides of the interfaces there; it is full, or partly filled and
//! without pressure: so the front and the dry part ahead of it follow from p ≥ 0, V - m ≥ 0 and p (V - m) = 0. Along every face liquid flows by the mean
//! aperture of its corners. A hole is a cell too, whose pressure those on its wall have. The equations are solved together with the equilibrium of the solids,
//! implicit in the pressures (`statics/wet`).

mod holes;
pub(crate) mod network;
mod reading;

use std::fmt;

use fractum_fem::Solid;
use fractum_kernels::liquid::CubicLaw;
use fractum_math::Vec3;
use serde::{Deserialize, Serialize};

use crate::interfaces::Interfaces;
use crate::time_function::TimeFunction;
use network::{Cell, Network};

pub(crate) use holes::Hole;
pub use holes::LiquidHole;
pub use reading::{LiquidMeasure, LiquidReading};

/// What a liquid is, and where it comes in.
#[derive(Clone, Debug)]
pub struct LiquidSettings {
    /// Numbers of the interfaces that it flows in.
    pub interfaces: Vec<u32>,
    /// How it flows.
    pub law: CubicLaw,
    /// Aperture of an interface under the in-situ stress and the loads before anything is injected [m].
    pub aperture: f64,
    /// Change of volume over volume and pressure [1/Pa].
    pub compressibility: f64,
    /// Carter's coefficient of one wall [m/√s].
    pub leak_off: f64,
    /// Holes that hold it.
    pub holes: Vec<LiquidHole>,
    /// Where it comes in.
    pub injections: Vec<Injection>,
}

/// A place at which liquid is put in.
#[derive(Clone)]
pub struct Injection {
    /// Where.
    pub place: InjectionPlace,
    /// By a rate, or by a pressure.
    pub drive: InjectionDrive,
}

/// Where liquid is put in.
#[derive(Clone, Debug)]
pub enum InjectionPlace {
    /// Cells at nodes, ascending; those that are on no interface count for nothing.
    Nodes(Vec<u32>),
    /// A hole, by its number.
    Hole(usize),
}

/// What drives an injection.
#[derive(Clone)]
pub enum InjectionDrive {
    /// Volume per time, shared among the cells by their area [m³/s].
    Rate(TimeFunction),
    /// Pressure of the cells [Pa].
    Pressure(TimeFunction),
}

impl fmt::Debug for Injection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let by = if matches!(self.drive, InjectionDrive::Rate(_)) { "rate" } else { "pressure" };
        write!(f, "Injection({:?}, by {by})", self.place)
    }
}

/// Liquid in the interfaces of a scene.
#[derive(Clone, Debug)]
pub struct Liquid {
    pub(crate) settings: LiquidSettings,
    pub(crate) network: Network,
    /// Holes, whose cells are behind those of the network.
    pub(crate) holes: Vec<Hole>,
    /// Cells of each injection with their shares.
    pub(crate) injected_at: Vec<Vec<(u32, f64)>>,
    pub(crate) state: LiquidState,
}

/// Everything about a liquid that changes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LiquidState {
    /// Whether the equilibrium before any injection has been found.
    pub(crate) has_begun: bool,
    /// Pressure in each cell [Pa].
    pub(crate) pressure: Vec<f64>,
    /// Volume of the liquid in each cell, as it is without pressure [m³].
    pub(crate) amount: Vec<f64>,
    /// Room in each cell [m³].
    pub(crate) room: Vec<f64>,
    /// When liquid came to each cell [s]; infinite before.
    pub(crate) wet_since: Vec<f64>,
    /// What the walls of each cell have taken [m³].
    pub(crate) leaked: Vec<f64>,
    /// Aperture of each point, with its rough walls closed where it is negative [m].
    pub(crate) aperture: Vec<f64>,
    /// Normal jump of each point from which its aperture counts: 0, or less where the loads before any injection had closed it; under in-situ stress that of its start [m].
    pub(crate) closed: Vec<f64>,
    /// Pairs of nodes whose jump is an unknown, ascending.
    pub(crate) active: Vec<u32>,
    /// Volume put in so far [m³], and the present rate of each injection [m³/s].
    pub(crate) injected: f64,
    pub(crate) rates: Vec<f64>,
    /// Energies so far: put in, stored by compression, taken by viscosity, leaked [J].
    pub(crate) supplied: f64,
    pub(crate) stored: f64,
    pub(crate) viscous: f64,
    pub(crate) lost: f64,
}

impl Liquid {
    /// Liquid in the interfaces of a solid, none of which is there yet.
    pub fn new(solid: &Solid, interfaces: &Interfaces, settings: LiquidSettings) -> Self {
        let joints = interfaces.joints();
        let mut network = Network::new(solid, interfaces, &joints, &settings.interfaces, settings.aperture > 0.0);
        let holes = (network.cells.len() as u32..).zip(&settings.holes);
        let holes: Vec<Hole> = holes.map(|(cell, own)| Hole::new(solid, interfaces, &network, cell, own)).collect();
        for (hole, own) in holes.iter().zip(&settings.holes) {
            network.cells.push(Cell { place: hole.middle(solid, &own.ends), ..Cell::default() });
            network.slits_of.push(Vec::new());
        }
        let injected_at = settings.injections.iter().map(|injection| match &injection.place {
            InjectionPlace::Hole(hole) => vec![(holes[*hole].cell, 1.0)],
            InjectionPlace::Nodes(nodes) => {
                let cells = network.cells_at(interfaces, nodes);
                let area: f64 = cells.iter().map(|&cell| network.cells[cell as usize].area).sum();
                cells.into_iter().map(|cell| (cell, network.cells[cell as usize].area / area)).collect()
            }
        });
        let injected_at: Vec<Vec<(u32, f64)>> = injected_at.collect();
        let (cells, points) = (network.cells.len(), network.points.len());
        // Holes are full at the start.
        let mut amount = vec![0.0; cells];
        holes.iter().for_each(|hole| amount[hole.cell as usize] = hole.volume);
        let state = LiquidState {
            pressure: vec![0.0; cells],
            room: amount.clone(),
            amount,
            wet_since: vec![f64::INFINITY; cells],
            leaked: vec![0.0; cells],
            aperture: vec![settings.aperture; points],
            closed: vec![0.0; points],
            rates: vec![0.0; injected_at.len()],
            ..LiquidState::default()
        };
        Liquid { settings, network, holes, injected_at, state }
    }

    /// What it is and where it comes in.
    pub fn settings(&self) -> &LiquidSettings {
        &self.settings
    }

    /// Number of its cells in interfaces.
    pub fn cell_count(&self) -> usize {
        self.network.cells.len() - self.holes.len()
    }

    /// Number of cells that an injection reaches.
    pub fn cells_of_injection(&self, injection: usize) -> usize {
        self.injected_at[injection].len()
    }

    /// A hole on whose wall a cell lies that an injection into interfaces reaches.
    pub fn hole_at_injection(&self, injection: usize) -> Option<usize> {
        let at = &self.injected_at[injection];
        self.holes.iter().position(|hole| at.iter().any(|(cell, _)| hole.cells.binary_search(cell).is_ok()))
    }

    /// Volume of a hole without load [m³], and the number of cells of interfaces on its wall that take liquid from it.
    pub fn hole(&self, hole: usize) -> (f64, usize) {
        (self.holes[hole].volume, self.holes[hole].cells.len())
    }

    /// Adds the forces of the liquid on the walls of holes.
    pub(crate) fn push_walls(&self, forces: &mut [Vec3]) {
        self.holes.iter().for_each(|hole| hole.push(self.state.pressure[hole.cell as usize], forces));
    }

    /// Volume of the liquid in a room of a cell, as it is without pressure, beyond that room [m³].
    pub(crate) fn compressed(&self, cell: usize, room: f64, pressure: f64) -> f64 {
        let hole = cell.checked_sub(self.cell_count()).map(|hole| &self.holes[hole]);
        (room * self.settings.compressibility + hole.map_or(0.0, |hole| hole.storage)) * pressure
    }

    /// Everything that changes.
    pub(crate) fn state(&self) -> LiquidState {
        self.state.clone()
    }

    /// Puts a saved state back.
    pub(crate) fn restore(&mut self, state: LiquidState) {
        self.state = state;
    }

    /// Energies so far: put in, stored, taken by viscosity, leaked [J].
    pub(crate) fn energies(&self) -> [f64; 4] {
        let LiquidState { supplied, stored, viscous, lost, .. } = &self.state;
        [*supplied, *stored, *viscous, *lost]
    }
}
