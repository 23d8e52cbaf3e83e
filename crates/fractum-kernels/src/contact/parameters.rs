use serde::{Deserialize, Serialize};

/// What a surface does to one that touches it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactParameters {
    /// Coulomb's coefficient μ ≥ 0.
    pub friction: f64,
    /// Coefficient of rolling friction μ_r ≥ 0: the couple reaches μ_r R F_n, R the reduced radius.
    pub rolling_friction: f64,
    /// Fraction ξ of critical damping, 0..1.
    pub damping_ratio: f64,
}

impl Default for ContactParameters {
    #[inline]
    fn default() -> Self {
        ContactParameters { friction: 0.5, rolling_friction: 0.0, damping_ratio: 0.1 }
    }
}

impl ContactParameters {
    /// A pair of surfaces: the smaller coefficients of friction, the mean damping ratio.
    #[inline]
    pub fn against(self, other: ContactParameters) -> ContactParameters {
        ContactParameters {
            friction: self.friction.min(other.friction),
            rolling_friction: self.rolling_friction.min(other.rolling_friction),
            damping_ratio: 0.5 * (self.damping_ratio + other.damping_ratio),
        }
    }
}
