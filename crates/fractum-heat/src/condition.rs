use std::fmt;
use std::sync::Arc;

use fractum_math::Vec3;

/// A value over time [s] and position at the start [m], in SI units.
pub type HeatFunction = Arc<dyn Fn(f64, &Vec3) -> f64 + Send + Sync>;

/// What heats or cools points from outside.
#[derive(Clone)]
pub enum HeatCondition {
    /// Prescribed temperature.
    Temperature {
        /// The points.
        points: Vec<u32>,
        /// Temperature [K].
        value: HeatFunction,
    },
    /// Heat that flows in: per area, per volume, or a total that is shared.
    Supply {
        /// Points with their areas [m²], volumes [m³] or shares [-].
        points: Vec<(u32, f64)>,
        /// Heat flow [W/m²], [W/m³] or [W]; negative takes heat out.
        value: HeatFunction,
    },
    /// Convection by Newton's law: h A (T∞ - T).
    Convection {
        /// Points with their areas [m²].
        points: Vec<(u32, f64)>,
        /// Coefficient h of heat transfer [W/(m² K)], ≥ 0.
        coefficient: f64,
        /// Temperature T∞ of what flows by [K].
        ambient: HeatFunction,
    },
}

impl fmt::Debug for HeatCondition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            HeatCondition::Temperature { points, .. } => write!(f, "Temperature({} points)", points.len()),
            HeatCondition::Supply { points, .. } => write!(f, "Supply({} points)", points.len()),
            HeatCondition::Convection { points, coefficient, .. } => {
                write!(f, "Convection({} points, {coefficient})", points.len())
            }
        }
    }
}
