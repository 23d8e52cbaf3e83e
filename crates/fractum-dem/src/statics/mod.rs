//! Bonded bodies at rest: equilibria for small displacements, and the bonds that break between them.

mod body;
mod conjugate_gradients;
mod events;
mod frequency;
mod lattice;

pub use body::StaticBody;
pub use events::{
    Batch, Breaking, BreakingOutcome, CriticalLoad, LoadPoint, LoadStage, QuasiStatic, QuasiStaticState, quasi_static,
};
pub use frequency::highest_frequency;
pub use lattice::{Dof6, Equilibrium, Lattice, LatticeSupports, Tolerance};
