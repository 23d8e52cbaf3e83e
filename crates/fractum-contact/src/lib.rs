//! Contact search and contact laws.
//!
//! [`close_pairs`] finds the spheres that may touch, [`SphereGrid`] those around a few that come or move; [`SphereContacts`] carries their contacts through time, and
//! [`SurfaceContacts`] those of spheres with facets and rigid shapes, found by the [`DoubleHierarchy`]. [`law`] says what
//! a touching pair feels. None of them knows particles or nodes as populations: they see positions, radii and velocities.
//!
//! Left out: contact of facets with facets. Behind the facets of a body with an inside, a centre is pushed out only where that is
//! asked for ([`SurfaceContacts::on_solid_ground`]).
//!
//! ```
//! use fractum_contact::close_pairs;
//! use fractum_math::Vec3;
//! let centres = [Vec3::zeros(), Vec3::x() * 1.9, Vec3::x() * 9.0];
//! assert_eq!(close_pairs(&centres, &[1.0; 3], 0.0), [[0, 1]]);
//! ```

#![forbid(unsafe_code)]

mod broad_phase;
mod error;
mod foot;
mod frame;
mod hierarchy;
mod inside;
mod nearest;
mod passes;
mod periodic;
mod shape;
mod sphere_facet;
mod sphere_grid;
mod sphere_sphere;
pub mod surface;
mod surface_block;
mod touch;

pub use fractum_kernels::contact as law;

pub use broad_phase::{close_pairs, close_pairs_of};
pub use error::SurfaceError;
pub use foot::Foot;
pub use frame::Frame;
pub use hierarchy::DoubleHierarchy;
pub use nearest::{Nearest, nearest_facets};
pub use periodic::{Image, PeriodicCell, close_pairs_within};
pub use shape::{Outside, Shape};
pub use sphere_facet::SurfaceContacts;
pub use sphere_grid::SphereGrid;
pub use sphere_sphere::{SUMMED_SPHERES, SphereContacts};
pub use surface::FacetMesh;
pub use touch::{Spheres, Surface, Touch};
