use fractum_math::Sym3;

use crate::body::{Body, ElementKind, Plane};

/// Isotropic Hooke's law with the plane-stress variant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hooke {
    pub(crate) lambda: f64,
    pub(crate) mu: f64,
    /// 1, or 0 where the stress across the thickness vanishes.
    pub(crate) zz: f64,
}

impl Hooke {
    /// The law of a body, with the Lamé parameter of plane stress where it is one.
    pub(crate) fn of(body: &Body) -> Self {
        let (lambda, mu) = (body.elastic.lame_lambda(), body.elastic.shear_modulus());
        if body.shape == ElementKind::T3 && body.plane == Plane::Stress {
            return Hooke { lambda: 2.0 * lambda * mu / (lambda + 2.0 * mu), mu, zz: 0.0 };
        }
        Hooke { lambda, mu, zz: 1.0 }
    }

    #[inline(always)]
    pub(crate) fn stress(&self, strain: Sym3) -> Sym3 {
        let [xx, yy, zz, xy, yz, zx] = strain.0;
        let pressure = self.lambda * (xx + yy + zz);
        let g = 2.0 * self.mu;
        Sym3([pressure + g * xx, pressure + g * yy, self.zz * (pressure + g * zz), g * xy, g * yz, g * zx])
    }
}
