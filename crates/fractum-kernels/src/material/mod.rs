//! Elasticity, the equivalent stress that drives damage, and softening.

mod bedding;
mod criterion;
mod damage_law;
mod degradation;
mod elastic;
mod softening;
mod wave;

pub use bedding::{Bedding, Stiffness};
#[cfg(test)]
pub(crate) use criterion::KINDS;
pub use criterion::{Criterion, CriterionKind, equivalent_stresses};
pub use damage_law::{BedStrength, DamageLaw, EXCESS_OF_PEAK, crack_scale};
pub use degradation::Degradation;
pub use elastic::{Elastic, Hooke, Plane};
pub use softening::Softening;
pub use wave::{Wave, rayleigh_wave_speed};
