//! Gas in holes and in the cracks that open to them.

use fractum_scene::{Charge, EquationOfState, Explosive, SlitFlow, Stemming};

use super::Selection;
use crate::choice::choice;
use crate::{Choice, Place, Spanned, TimeFunction};

/// The gas of a case: one law, any number of holes.
#[derive(Debug, Clone, PartialEq)]
pub struct Gas {
    /// Where it is written.
    pub place: Place,
    /// Law of the gas.
    pub law: EquationOfState,
    /// Viscosity, and roughness of the walls of cracks.
    pub slits: SlitFlow,
    /// Opening of a crack whose walls are where they were without load [m], > 0.
    pub least_opening: f64,
    /// Whether gas enters cracks.
    pub in_cracks: bool,
    /// Pressure where cracks reach the surface [Pa].
    pub outside_pressure: f64,
    /// Planes of symmetry, each across its axis.
    pub symmetry: [Option<Spanned<f64>>; 3],
    /// Holes, in the order of the file; at least one.
    pub holes: Vec<GasHole>,
}

/// A hole that gas is put in.
#[derive(Debug, Clone, PartialEq)]
pub struct GasHole {
    /// Facets of its wall.
    pub on: Selection,
    /// Whether flat open ends are closed by stemming.
    pub stemmed: bool,
    /// What it holds at the start.
    pub charge: Charge,
    /// Mass [kg/s] and energy [W] that come in over time.
    pub source: Option<[Spanned<TimeFunction>; 2]>,
    /// Stemming that is ejected.
    pub stemming: Option<Stemming>,
}

/// Explosives of the open literature by name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Preset(pub Explosive);

impl Choice for Preset {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("anfo", Preset(Explosive::ANFO)),
        ("emulsion", Preset(Explosive::EMULSION)),
        ("tnt", Preset(Explosive::TNT)),
        ("petn-1.77", Preset(Explosive::PETN_1770)),
        ("petn-1.50", Preset(Explosive::PETN_1500)),
        ("petn-1.26", Preset(Explosive::PETN_1260)),
        ("petn-0.88", Preset(Explosive::PETN_880)),
    ];
}

/// Names of the laws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GasLaw {
    /// Perfect gas.
    PerfectGas,
    /// Noble-Abel.
    NobleAbel,
    /// Jones-Wilkins-Lee.
    Jwl,
}

choice!(GasLaw { "perfect-gas" => PerfectGas, "noble-abel" => NobleAbel, "jwl" => Jwl });
