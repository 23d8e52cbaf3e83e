//! Liquid in interfaces.

use fractum_scene::CubicLaw;

use super::Selection;
use crate::{Place, Spanned, TimeFunction};

/// The liquid of a case.
#[derive(Debug, Clone, PartialEq)]
pub struct Liquid {
    /// Where it is written.
    pub place: Place,
    /// Names of the interfaces that it flows in; all of them if there are none.
    pub interfaces: Vec<Spanned<String>>,
    /// How it flows.
    pub law: CubicLaw,
    /// Aperture under the in-situ stress and the loads at t = 0 [m].
    pub aperture: f64,
    /// Change of volume over volume and pressure [1/Pa].
    pub compressibility: f64,
    /// Carter's coefficient of one wall [m/√s].
    pub leak_off: f64,
    /// Places of planes of symmetry at which holes may end, across each axis [m].
    pub symmetry: [Option<Spanned<f64>>; 3],
    /// Holes that hold it, in the order of the file.
    pub holes: Vec<LiquidHole>,
    /// Where it comes into interfaces, in the order of the file; at least one where none is put into holes.
    pub injections: Vec<LiquidInjection>,
}

impl Liquid {
    /// Whether it flows in an interface of some name.
    pub fn flows_in(&self, interface: &str) -> bool {
        self.interfaces.is_empty() || self.interfaces.iter().any(|own| own.value == interface)
    }

    /// What drives it, and where.
    pub fn drives(&self) -> impl Iterator<Item = (&LiquidDrive, &Selection)> {
        let into_holes = self.holes.iter().filter_map(|hole| Some((hole.drive.as_ref()?, &hole.on)));
        self.injections.iter().map(|injection| (&injection.drive, &injection.on)).chain(into_holes)
    }
}

/// A hole that holds liquid.
#[derive(Debug, Clone, PartialEq)]
pub struct LiquidHole {
    /// Facets around it.
    pub on: Selection,
    /// Whether flat open ends are closed.
    pub stemmed: bool,
    /// Whether no interface takes liquid from it.
    pub is_sealed: bool,
    /// Volume that lines and pump beside it take per pressure [m³/Pa].
    pub storage: f64,
    /// What is put in; nothing where interfaces alone feed it.
    pub drive: Option<LiquidDrive>,
}

/// A place at which liquid comes in.
#[derive(Debug, Clone, PartialEq)]
pub struct LiquidInjection {
    /// Nodes there.
    pub on: Selection,
    /// What is put in.
    pub drive: LiquidDrive,
}

/// What drives liquid.
#[derive(Debug, Clone, PartialEq)]
pub struct LiquidDrive {
    /// Volume per time [m³/s], or pressure [Pa].
    pub value: Spanned<TimeFunction>,
    /// Whether it is a pressure.
    pub by_pressure: bool,
}
