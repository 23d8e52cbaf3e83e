//! Contact search and contact laws.
//!
//! [`close_pairs`] finds the spheres that may touch; [`law`] says what a touching pair feels. Neither knows particles,
//! nodes or facets as populations: they see positions, radii and relative velocities.
//!
//! ```
//! use fractum_contact::close_pairs;
//! use fractum_math::Vec3;
//! let centres = [Vec3::zeros(), Vec3::x() * 1.9, Vec3::x() * 9.0];
//! assert_eq!(close_pairs(&centres, &[1.0; 3], 0.0), [[0, 1]]);
//! ```

mod broad_phase;
pub mod law;

pub use broad_phase::close_pairs;
