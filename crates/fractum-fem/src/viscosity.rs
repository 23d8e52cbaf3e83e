use fractum_math::Sym3;
use serde::{Deserialize, Serialize};

use crate::body::ElementKind;
use crate::element::regular_edge;
use crate::kernel::Hooke;

/// Viscous stress: β D ε̇, and a bulk viscosity for shocks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Viscosity {
    /// Stiffness-proportional time β [s].
    pub stiffness_time: f64,
    /// Coefficient of the linear bulk viscosity, about 0.06.
    pub bulk_linear: f64,
    /// Coefficient of the quadratic bulk viscosity, about 1.2.
    pub bulk_quadratic: f64,
}

impl Viscosity {
    /// Whether there is nothing to do.
    pub fn is_off(&self) -> bool {
        self.stiffness_time == 0.0 && self.bulk_linear == 0.0 && self.bulk_quadratic == 0.0
    }
}

/// [`Viscosity`] with the density and wave speed of a body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyViscosity {
    pub(crate) constants: Viscosity,
    pub(crate) density: f64,
    pub(crate) wave_speed: f64,
}

impl BodyViscosity {
    /// Viscous stress of a cell for its strain rate [Pa].
    pub(crate) fn stress(&self, hooke: &Hooke, rate: Sym3, integrity: f64, volume: f64) -> Sym3 {
        let Viscosity { stiffness_time, bulk_linear, bulk_quadratic } = self.constants;
        let mut stress = hooke.stress(rate) * (stiffness_time * integrity);
        let volumetric = rate.trace();
        if volumetric < 0.0 {
            let length = regular_edge(ElementKind::T4, volume);
            let quadratic = bulk_quadratic * bulk_quadratic * length * volumetric * volumetric;
            let pressure = self.density * length * (bulk_linear * self.wave_speed * -volumetric + quadratic);
            stress += Sym3::isotropic(-pressure);
        }
        stress
    }
}
