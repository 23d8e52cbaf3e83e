use fractum_gas::{Amount, EquationOfState, Passage, SlitFlow};

use super::hole_ends::{HoleEnds, SymmetryPlanes};
use crate::time_function::TimeFunction;

/// What stays the same about the gas of a scene.
#[derive(Clone)]
pub struct GasSettings {
    /// Law of the gas.
    pub law: EquationOfState,
    /// Viscosity, and roughness of the walls of cracks.
    pub slits: SlitFlow,
    /// Opening of a crack whose walls are where they were without load [m], > 0.
    pub least_opening: f64,
    /// Whether gas enters cracks, rather than push on the walls of the holes alone.
    pub in_cracks: bool,
    /// Pressure where cracks reach the surface of the solids [Pa]; nothing flows in from there.
    pub outside_pressure: f64,
    /// Planes of symmetry that the model ends at: holes end there, and nothing leaks.
    pub symmetry: SymmetryPlanes,
    /// Holes that gas is put in; no facet is in two of them.
    pub holes: Vec<GasHole>,
}

/// A hole that gas is put in.
#[derive(Clone)]
pub struct GasHole {
    /// Outward facets of the solids around it: a closed surface with its ends, in the plane a closed line.
    pub facets: Vec<[u32; 3]>,
    /// Its ends; they do not move along the hole, and nothing leaks through them.
    pub ends: HoleEnds,
    /// What it holds at the start.
    pub charge: Charge,
    /// What comes in over time.
    pub source: Option<GasSource>,
    /// Its stemming, where that is ejected.
    pub stemming: Option<Stemming>,
}

/// Stemming that closes a hole until it is ejected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stemming {
    /// Diameter of the hole there [m].
    pub diameter: f64,
    /// Length through which gas flows to the outside [m].
    pub length: f64,
    /// When it has left the hole [s].
    pub ejected_at: f64,
}

impl Stemming {
    /// The way to the outside from a cell: a slit of the same cross-section and hydraulic diameter; shut before the stemming is ejected.
    pub(crate) fn passage(&self, cell: usize, time: f64) -> Passage {
        let opening = if time < self.ejected_at { 0.0 } else { 0.5 * self.diameter };
        let width = 0.5 * std::f64::consts::PI * self.diameter;
        Passage { cells: [cell as u32, Passage::OUTSIDE], length: self.length, width, opening }
    }
}

/// What a hole holds at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Charge {
    /// Mass and internal energy.
    Amount(Amount),
    /// Pressure [Pa] and temperature [K] in the hole without load.
    State {
        /// Pressure [Pa].
        pressure: f64,
        /// Temperature [K].
        temperature: f64,
    },
}

/// Gas that comes in over time.
#[derive(Clone)]
pub struct GasSource {
    /// Mass [kg/s].
    pub mass: TimeFunction,
    /// Energy, that of the pressure included [W].
    pub energy: TimeFunction,
}
