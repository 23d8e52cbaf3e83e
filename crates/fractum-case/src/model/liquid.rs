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
    /// Where it comes in, in the order of the file; at least one.
    pub injections: Vec<LiquidInjection>,
}

impl Liquid {
    /// Whether it flows in an interface of some name.
    pub fn flows_in(&self, interface: &str) -> bool {
        self.interfaces.is_empty() || self.interfaces.iter().any(|own| own.value == interface)
    }
}

/// A place at which liquid comes in.
#[derive(Debug, Clone, PartialEq)]
pub struct LiquidInjection {
    /// Nodes there.
    pub on: Selection,
    /// Volume per time [m³/s], or pressure [Pa].
    pub value: Spanned<TimeFunction>,
    /// Whether it is a pressure.
    pub by_pressure: bool,
}
