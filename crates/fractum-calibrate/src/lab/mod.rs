//! The virtual laboratory: elastic tests on bonded samples, each by one static solve; tests to failure; vibrations by
//! explicit steps.

mod bending;
mod breaking;
mod chain;
mod gauge;
mod hydrostatic;
mod periodic;
mod shear;
mod tension;
mod vibration;
mod virial;

pub use bending::{Bending, Torsion, bending, torsion};
pub use breaking::{
    Broken, BrokenInMotion, Diameter, Failure, FailureOptions, Geometry, MotionEnergy, MotionOptions, break_in_motion,
    break_sample, diameter, geometry, hondros,
};
pub use chain::chain;
pub use gauge::Gauge;
pub use hydrostatic::{Hydrostatic, hydrostatic};
pub use periodic::{stiffness, uniaxial, voigt};
pub use shear::{Shear, shear};
pub use tension::{Tension, tension};
pub use vibration::{Impact, Vibration, VibrationMode, impact, vibration};
pub use virial::virial_errors;

use fractum_dem::Dof6;
use fractum_math::Vec3;

/// Strain of the strain-driven tests; the solves are linear, so that it only sets the size of the numbers.
pub(crate) const STRAIN: f64 = 1e-4;

/// A displacement without rotation.
pub(crate) fn translation(u: Vec3) -> Dof6 {
    [u.x, u.y, u.z, 0.0, 0.0, 0.0]
}
