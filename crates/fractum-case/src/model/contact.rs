//! Coefficients of contact, as they are given.

use fractum_scene::ContactParameters;

/// Coefficients of contact, where they are given.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ContactCoefficients {
    /// Coulomb's coefficient, ≥ 0.
    pub friction: Option<f64>,
    /// Coefficient of rolling friction, ≥ 0.
    pub rolling_friction: Option<f64>,
    /// Fraction of critical damping, 0 to 1; or what follows from a coefficient of restitution.
    pub damping_ratio: Option<f64>,
    /// Work of adhesion [J/m²], ≥ 0.
    pub work_of_adhesion: Option<f64>,
}

impl ContactCoefficients {
    /// Friction and damping; those of `other` where nothing is given.
    pub fn over(&self, other: ContactParameters) -> ContactParameters {
        ContactParameters {
            friction: self.friction.unwrap_or(other.friction),
            rolling_friction: self.rolling_friction.unwrap_or(other.rolling_friction),
            damping_ratio: self.damping_ratio.unwrap_or(other.damping_ratio),
        }
    }

    /// The coefficients, each with the name of its key.
    pub fn named(&self) -> [(&'static str, Option<f64>); 4] {
        [
            ("friction", self.friction),
            ("rolling_friction", self.rolling_friction),
            ("damping_ratio", self.damping_ratio),
            ("work_of_adhesion", self.work_of_adhesion),
        ]
    }

    /// The same without those that another table gives.
    pub(super) fn without(&self, other: &ContactCoefficients) -> ContactCoefficients {
        let free = |own: Option<f64>, other: Option<f64>| own.filter(|_| other.is_none());
        ContactCoefficients {
            friction: free(self.friction, other.friction),
            rolling_friction: free(self.rolling_friction, other.rolling_friction),
            damping_ratio: free(self.damping_ratio, other.damping_ratio),
            work_of_adhesion: free(self.work_of_adhesion, other.work_of_adhesion),
        }
    }
}
