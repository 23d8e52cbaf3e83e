//! Bonds that break: criteria, the search for what they overload, and the contact of what has broken.

mod crack;
pub mod criterion;
mod faces;
mod moving;
mod search;
mod separated;

pub use crack::Crack;
pub(crate) use crack::facet_area;
pub use criterion::{FailureSite, FractureCriterion};
pub use faces::{CrackFaces, FaceWork};
pub use moving::{Fracture, FractureState, Occasion};
pub use search::{Break, FailureSearch, LoadedBonds};
