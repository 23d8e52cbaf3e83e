//! Discrete elements: particles joined by cohesive beams, in motion and at rest.
//!
//! [`BeamSection`] is the material of a bond. [`BeamNetwork`] moves [`Particles`] through time, with large rotations;
//! [`Lattice`] finds the static equilibrium of a bonded body for small
//! displacements in one solve. [`stress`] and [`strain`] turn its state into macroscopic fields.
//!
//! ```
//! use fractum_dem::{BeamSection, Lattice, Supports, Tolerance};
//! use fractum_math::Vec3;
//! // Two particles one metre apart, pulled by 1 µm: the force is E S u/l.
//! let position = [Vec3::zeros(), Vec3::x()];
//! let section = BeamSection::new(70e9, 0.1)?;
//! let lattice = Lattice::new(&position, &[[0, 1]], section, 0.5)?;
//! let mut supports = Supports::none(2);
//! for dof in 0..6 {
//!     supports.set(0, dof, 0.0);
//!     supports.set(1, dof, if dof == 0 { 1e-6 } else { 0.0 });
//! }
//! let rest = lattice.solve(&supports, None, &[[0.0; 6]; 2], Tolerance::default())?;
//! assert!((rest.force[1][0] - section.axial() * 1e-6).abs() < 1e-6);
//! # Ok::<(), fractum_dem::DemError>(())
//! ```

mod bond;
mod breaking;
mod conjugate;
pub mod crack_shape;
pub mod criterion;
mod error;
mod face;
mod fracture;
mod graph;
mod lattice;
mod leapfrog;
mod particles;
mod piece;
mod static_body;
pub mod strain;
pub mod stress;
mod watch;

pub use bond::{BeamEnergy, BeamForces, BeamNetwork, BeamSection, BondedPair, cohesive_beam, cohesive_beam_energy};
pub use breaking::{Batch, Breaking, Crack, LoadPoint, Outcome, Point, QuasiStatic, Stage, quasi_static};
pub use criterion::Criterion;
pub use error::DemError;
pub use face::{CrackFaces, FaceWork};
pub use fracture::{Fracture, FractureState, Occasion};
pub use graph::{BondGraph, HalfEdge, Parts};
pub use lattice::{Dof6, Equilibrium, Lattice, Supports, Tolerance};
pub use leapfrog::{Leap, LeapWork, ParticleDamping, PastForces};
pub use particles::{Integrator, Particles};
pub use piece::{Piece, pieces};
pub use static_body::StaticBody;
pub use watch::{Bonded, Break, Site, Watch};
