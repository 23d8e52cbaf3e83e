use serde::{Deserialize, Serialize};

use crate::Sym3;
#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;

/// Isotropic linear elasticity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Elastic {
    /// Mass density [kg/m³].
    pub density: f64,
    /// Young's modulus E [Pa].
    pub young_modulus: f64,
    /// Poisson's ratio ν, between -1 and 0.5.
    pub poisson_ratio: f64,
}

impl Elastic {
    /// Lamé's first parameter λ = E ν / ((1 + ν)(1 - 2ν)) [Pa].
    #[inline]
    pub fn lame_lambda(&self) -> f64 {
        Hooke::in_space(self.young_modulus, self.poisson_ratio).lambda
    }

    /// Shear modulus μ = E / (2 (1 + ν)) [Pa].
    #[inline]
    pub fn shear_modulus(&self) -> f64 {
        Hooke::in_space(self.young_modulus, self.poisson_ratio).mu
    }

    /// Speed of a compression wave in the bulk, √((λ + 2μ)/ρ) [m/s].
    #[inline]
    pub fn p_wave_speed(&self) -> f64 {
        ((self.lame_lambda() + 2.0 * self.shear_modulus()) / self.density).sqrt()
    }

    /// Speed of a shear wave, √(μ/ρ) [m/s].
    #[inline]
    pub fn s_wave_speed(&self) -> f64 {
        (self.shear_modulus() / self.density).sqrt()
    }
}

/// What a plane body assumes across its thickness.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Plane {
    /// No strain across the thickness.
    Strain,
    /// No stress across the thickness.
    Stress,
    /// A section through the y axis, about which the body is turned: the strain across is that of the circumference, and the law is that in space.
    Axisymmetric,
}

/// Isotropic Hooke's law with the plane-stress variant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hooke {
    /// Lamé's λ, in plane stress 2 λ μ/(λ + 2 μ) [Pa].
    pub lambda: f64,
    /// Shear modulus μ [Pa].
    pub mu: f64,
    /// 1, or 0 where the stress across the thickness vanishes.
    pub zz: f64,
}

impl Hooke {
    /// The law in space and in plane strain.
    #[inline]
    pub fn in_space(young_modulus: f64, poisson_ratio: f64) -> Self {
        let (e, nu) = (young_modulus, poisson_ratio);
        Hooke { lambda: e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), mu: e / (2.0 * (1.0 + nu)), zz: 1.0 }
    }

    /// The law of a body in space, or of a plane one.
    #[inline]
    pub fn new(elastic: &Elastic, plane: Option<Plane>) -> Self {
        let hooke = Hooke::in_space(elastic.young_modulus, elastic.poisson_ratio);
        let Hooke { lambda, mu, .. } = hooke;
        match plane {
            Some(Plane::Stress) => Hooke { lambda: 2.0 * lambda * mu / (lambda + 2.0 * mu), mu, zz: 0.0 },
            _ => hooke,
        }
    }

    /// Stress of a strain [Pa].
    #[inline(always)]
    pub fn stress(&self, strain: Sym3) -> Sym3 {
        let [xx, yy, zz, xy, yz, zx] = strain.0;
        let pressure = self.lambda * (xx + yy + zz);
        let g = 2.0 * self.mu;
        Sym3([pressure + g * xx, pressure + g * yy, self.zz * (pressure + g * zz), g * xy, g * yz, g * zx])
    }
}
