//! Bonds that break: criteria, the search for what they overload, and the contact of what has broken.

mod crack;
pub mod criterion;
mod exchanges;
mod face_contacts;
mod faces;
mod moving;
mod search;
mod separated;
mod subdomain;

pub(crate) use crack::facet_area;
pub use crack::{Crack, Occasion};
pub use criterion::{FailureSite, FractureCriterion};
pub use faces::{CrackFaces, FaceWork};
pub use moving::{Fracture, FractureState};
pub use search::{Break, FailureSearch, LoadedBonds};
