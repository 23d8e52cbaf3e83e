use fractum_math::Vec3;
use serde::{Deserialize, Serialize};

/// Forces and moments of a step, which the scheme of Tchamwa and Wielgosz compares with those of the next (Mahéo, Grolleau
/// and Rio 2013).
///
/// It drifts by Δt v + φ Δt² a. Seen from velocities u = Δx/Δt at half steps this reads
/// uⁿ⁺½ = uⁿ⁻½ + Δt aⁿ + (φ − 1) Δt (aⁿ − aⁿ⁻¹): central differences with the resistance (φ − 1)(Fⁿ − Fⁿ⁻¹), which in a
/// linear body is damping proportional to stiffness with the time (φ − 1) Δt. So its work can be booked like that of any
/// damping. Without forces of a step before, as here by default, the first step is the one of the scheme from rest.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PastForces {
    /// Forces on the free degrees of freedom [N], one per particle.
    pub force: Vec<Vec3>,
    /// Moments on them [N m].
    pub moment: Vec<Vec3>,
}

impl PastForces {
    /// No forces on `count` particles.
    pub fn none(count: usize) -> Self {
        PastForces { force: vec![Vec3::zeros(); count], moment: vec![Vec3::zeros(); count] }
    }
}
