//! Discrete elements: particles joined by bonds, in motion and at rest.
//!
//! What it models: spheres that move and turn ([`Particles`]), [`Bonds`] between them under a [`BondLaw`] (the cohesive beam
//! of a [`BeamSection`], with large rotations), criteria by which bonds break ([`FractureCriterion`]), contact of the crack
//! faces ([`Fracture`]), and static equilibria for small displacements in one solve ([`Lattice`], [`QuasiStatic`]).
//! [`stress`] and [`strain`] turn its state into macroscopic fields. What it leaves out: contact with other bodies and loads,
//! which a scene adds; packing and calibration, which make the particles and the numbers of the law.
//!
//! A new law of bonds is a file in `fractum-kernels/src/bond` and a line in `bond/kinds.rs`; a new criterion is a file in
//! `fracture/criterion` and a line in its `mod.rs`.
//!
//! A pair of particles in motion, its bond stretched by one per cent:
//! ```
//! use fractum_dem::{BeamSection, Bonds, CentralDifference, ParticleDamping, Particles};
//! use fractum_math::Vec3;
//! let mut particles = Particles::at_rest(vec![Vec3::zeros(), Vec3::x()], vec![0.5; 2], 2.0)?;
//! let mut bonds = Bonds::new(&particles, &[[0, 1]], BeamSection::new(1e9, 0.2)?)?;
//! particles.position[1].x = 1.01;
//! let dt = bonds.stable_step(&particles, 0.7);
//! bonds.add_forces(&mut particles);
//! particles.start_half_a_step_early(dt);
//! let mut motion = CentralDifference::new(&particles, dt, ParticleDamping::default());
//! // The kinetic energy that central differences keep is the one at the step: ½ m v⁻·v⁺.
//! let kinetic = motion.kick_drift_and_measure(&mut particles.clone()).before.kinetic;
//! let energy = kinetic + bonds.energy(&particles).total();
//! for _ in 0..100 {
//!     motion.kick_and_drift(&mut particles);
//!     particles.clear_forces();
//!     bonds.add_forces(&mut particles);
//! }
//! let kinetic = motion.kick_drift_and_measure(&mut particles.clone()).before.kinetic;
//! assert!(((kinetic + bonds.energy(&particles).total()) / energy - 1.0).abs() < 1e-9);
//! # Ok::<(), fractum_dem::DemError>(())
//! ```
//!
//! The same pair at rest:
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
mod cells;
mod clumps;
mod error;
mod fracture;
mod measure;
mod particles;
mod statics;

pub use bond::*;
pub use clumps::{CLUMP_SPHERES, ClumpMotion, ClumpShape, Clumps, NO_CLUMP};
pub use error::DemError;
pub use fractum_kernels::lanes;
pub use fracture::{
    Break, Crack, CrackFaces, FaceWork, FailureSearch, FailureSite, Fracture, FractureCriterion, FractureState,
    LoadedBonds, Occasion, criterion,
};
pub use measure::{Piece, StrainGauge, StrainMeasure, crack_shape, pieces, strain, stress};
pub use particles::{
    CentralDifference, NearPairs, ParticleDamping, ParticleSubdomain, ParticleSubdomainSize, Particles, PastForces,
    TimeStep,
};
pub use statics::{
    Batch, Breaking, BreakingOutcome, CriticalLoad, Dof6, Equilibrium, Lattice, LatticeSupports, LoadPoint, LoadStage,
    QuasiStatic, QuasiStaticState, StaticBody, Tolerance, highest_frequency, quasi_static,
};
