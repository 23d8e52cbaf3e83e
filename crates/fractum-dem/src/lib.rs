//! Discrete elements: particles joined by cohesive beams, in motion and at rest.
//!
//! [`BeamSection`] is the material of a bond. [`BeamNetwork`] moves [`Particles`] through time, with large rotations;
//! [`Lattice`] finds the static equilibrium of a bonded body for small
//! displacements in one solve. [`stress`] and [`strain`] turn its state into macroscopic fields.
//!
//! ```
//! use fractum_dem::{BeamSection, Lattice, LatticeSupports, Tolerance};
//! use fractum_math::Vec3;
//! // Two particles one metre apart, pulled by 1 µm: the force is E S u/l.
//! let position = [Vec3::zeros(), Vec3::x()];
//! let section = BeamSection::new(70e9, 0.1)?;
//! let lattice = Lattice::new(&position, &[[0, 1]], section, 0.5)?;
//! let mut supports = LatticeSupports::none(2);
//! for dof in 0..6 {
//!     supports.set(0, dof, 0.0);
//!     supports.set(1, dof, if dof == 0 { 1e-6 } else { 0.0 });
//! }
//! let rest = lattice.solve(&supports, None, &[[0.0; 6]; 2], Tolerance::default())?;
//! assert!((rest.force[1][0] - section.axial() * 1e-6).abs() < 1e-6);
//! # Ok::<(), fractum_dem::DemError>(())
//! ```

mod bond;
mod error;
mod fracture;
mod measure;
mod particles;
mod statics;

pub use bond::{
    BeamEnergy, BeamForces, BeamNetwork, BeamSection, BondGraph, BondedPair, HalfEdge, Parts, cohesive_beam,
    cohesive_beam_energy,
};
pub use error::DemError;
pub use fracture::{
    Break, Crack, CrackFaces, FaceWork, FailureSearch, FailureSite, Fracture, FractureCriterion, FractureState,
    LoadedBonds, Occasion, criterion,
};
pub use measure::{Piece, crack_shape, pieces, strain, stress};
pub use particles::{CentralDifference, ParticleDamping, Particles, PastForces, TimeStep};
pub use statics::{
    Batch, Breaking, BreakingOutcome, CriticalLoad, Dof6, Equilibrium, Lattice, LatticeSupports, LoadPoint, LoadStage,
    QuasiStatic, QuasiStaticState, StaticBody, Tolerance, highest_frequency, quasi_static,
};
