//! Interfaces between elements with a strength of their own.
//!
//! A point of an interface sees the jump of displacement across it: the opening along the normal, and the slip along two
//! directions in the face. It pulls back with a cohesive traction that softens, rubs once it slides under pressure, and does not let
//! the sides pass through each other. [`InterfaceLaw`] says what it bears; [`SpringInterface`] gives it the stiffness of a case, and
//! [`stiff_traction`] none at all: it holds until its strength is met.

mod spring;
mod stiff;

use serde::{Deserialize, Serialize};

use crate::Vec3;
use crate::elementary::{atan, exp, log10, pow, tan};
#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;

pub use spring::{Led, SpringInterface, Standing};
pub use stiff::{FreeJump, stiff_traction};

/// What an interface bears.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct InterfaceLaw {
    /// f_t [Pa], > 0, or 0 together with the cohesion: sides that were never joined.
    pub tensile_strength: f64,
    /// c [Pa], > 0, or 0 together with the tensile strength.
    pub cohesion: f64,
    /// G_I [J/m²], > 0.
    pub opening_energy: f64,
    /// G_II [J/m²], > 0.
    pub sliding_energy: f64,
    /// Coefficient of friction μ while the interface is whole, ≥ that of the residual friction.
    pub friction: f64,
    /// Coefficient of friction μ_r once it is broken, ≥ 0.
    pub residual_friction: f64,
    /// Opening over slip under pressure, tan ψ, 0 to μ_r.
    pub dilation: f64,
    /// Slip beyond which sliding opens it no further [m].
    pub dilation_slip: f64,
    /// How opening and sliding share the energy.
    pub mixed_mode: MixedMode,
    /// How it softens.
    pub softening: InterfaceSoftening,
    /// Asperities, which raise the friction under small pressures; none of smooth sides.
    pub roughness: Option<Roughness>,
}

/// Asperities of a rock joint: under a pressure p it rubs as at the angle φ_r + JRC log10(JCS/p) in degrees, at most 70 (Barton and Choubey 1977).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Roughness {
    /// Joint roughness coefficient JRC, 0 to 20.
    pub coefficient: f64,
    /// Compressive strength of its walls JCS [Pa], > 0.
    pub wall_strength: f64,
    /// Slip beyond which asperities wear [m], > 0: JRC falls with (peak_slip / slip)^0.381 (Olsson and Barton 2001).
    pub peak_slip: f64,
}

/// Largest angle of friction of rough sides.
const STEEPEST: f64 = 70.0 * core::f64::consts::PI / 180.0;
/// Exponent by which asperities wear.
const WEAR: f64 = 0.381;

/// Energy that breaks an interface which opens and slides.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum MixedMode {
    /// (G_1/G_I)^α + (G_2/G_II)^α = 1: a straight line for α = 1, an ellipse for α = 2 (Wu and Reuter 1965).
    Power(f64),
    /// G_c = G_I + (G_II - G_I) B^η, B the share of sliding (Benzeggagh and Kenane 1996).
    BenzeggaghKenane(f64),
}

/// Shape of the curve of traction over jump.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum InterfaceSoftening {
    /// Straight line to zero.
    Linear,
    /// Exponential decay.
    Exponential,
}

/// History of a point of an interface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct InterfaceState {
    /// Share of the strength that is left χ: 1 whole, 0 broken.
    pub residual: f64,
    /// With a stiffness: the share of it that is whole, 1 - D. Stiff: traction over weighted jump [m²/J], infinite where it has not given way.
    pub secant: f64,
    /// Slip that friction has taken [m]; of interfaces with a stiffness.
    pub slip: [f64; 2],
}

/// Traction of a point on its second side [Pa]: it resists the jump from the first side to the second.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InterfaceForce {
    /// Cohesive part: normal, then two tangential components.
    pub cohesive: Vec3,
    /// Friction, without a normal component.
    pub friction: Vec3,
    /// Pressure of the closed interface, ≥ 0.
    pub contact: f64,
    /// Energy stored per area [J/m²].
    pub stored: f64,
}

impl InterfaceForce {
    /// All of it: pulls the second side towards the first where positive.
    #[inline]
    pub fn traction(&self) -> Vec3 {
        self.cohesive + self.friction - Vec3::new(self.contact, 0.0, 0.0)
    }
}

impl Roughness {
    /// Coefficient of friction under a pressure [Pa], after a slip [m].
    ///
    /// - `smooth`: that of worn sides, tan φ_r
    #[inline]
    pub fn friction(&self, smooth: f64, pressure: f64, slip: f64) -> f64 {
        let wear = if slip > self.peak_slip { pow(self.peak_slip / slip, WEAR) } else { 1.0 };
        let raised = (self.coefficient * wear * log10((self.wall_strength / pressure).max(1.0))).min(90.0);
        let angle = (atan(smooth) + raised.to_radians()).min(STEEPEST);
        tan(angle).max(smooth)
    }
}

impl InterfaceLaw {
    /// Whether its sides were joined at all.
    #[inline]
    pub fn is_bonded(&self) -> bool {
        self.tensile_strength > 0.0
    }

    /// The state before any load.
    ///
    /// - `is_stiff`: whether it has no stiffness of its own
    #[inline]
    pub fn intact(&self, is_stiff: bool) -> InterfaceState {
        let (residual, secant) = match (self.is_bonded(), is_stiff) {
            (false, _) => (0.0, 0.0),
            (true, false) => (1.0, 1.0),
            (true, true) => (1.0, f64::INFINITY),
        };
        InterfaceState { residual, secant, slip: [0.0; 2] }
    }

    /// Energy that breaks it [J/m²].
    ///
    /// - `sliding`: share of sliding in it, 0 to 1
    #[inline]
    pub fn energy(&self, sliding: f64) -> f64 {
        let (first, second) = (self.opening_energy, self.sliding_energy);
        match self.mixed_mode {
            MixedMode::BenzeggaghKenane(exponent) => first + (second - first) * pow(sliding, exponent),
            MixedMode::Power(exponent) => {
                let sum = pow((1.0 - sliding) / first, exponent) + pow(sliding / second, exponent);
                pow(sum, -1.0 / exponent)
            }
        }
    }

    /// Coefficient of friction.
    ///
    /// - `residual`: share χ of the strength that is left
    /// - `pressure` [Pa], `slip` so far [m]: what asperities depend on
    #[inline]
    pub fn friction_at(&self, residual: f64, pressure: f64, slip: f64) -> f64 {
        let smooth = self.residual_friction + (self.friction - self.residual_friction) * residual;
        match &self.roughness {
            None => smooth,
            Some(roughness) => {
                smooth - self.residual_friction + roughness.friction(self.residual_friction, pressure, slip)
            }
        }
    }

    /// Opening that asperities ask for after a slip [m].
    #[inline]
    pub fn dilated(&self, slip: f64) -> f64 {
        self.dilation * slip.min(self.dilation_slip)
    }

    /// Share χ of the strength that is left after an energy-weighted jump.
    ///
    /// - `spent`: λ with dλ = t·dδ/χ [J/m²]; `energy` [J/m²]
    #[inline]
    fn left(&self, spent: f64, energy: f64) -> f64 {
        match self.softening {
            InterfaceSoftening::Linear => (1.0 - 0.5 * spent / energy).max(0.0),
            InterfaceSoftening::Exponential => exp(-spent / energy),
        }
    }
}

/// Length of the tangential part.
#[inline]
fn tangential(v: &Vec3) -> f64 {
    (v.y * v.y + v.z * v.z).sqrt()
}
