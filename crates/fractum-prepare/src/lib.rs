//! Bodies of particles made ready for a scene.
//!
//! - [`prepare_bonded`]: a bonded body is packed (or its packing is read), bonded, calibrated to the material and given its
//!   strengths. What takes long is kept in a [`Cache`].
//! - [`prepare_loose`]: a cloud of loose particles is filled or read
//!
//! Materials, shapes and the bytes of files come in; a [`PreparedBody`] comes out, or a [`Fault`] that says what of the request
//! it is about. Nothing here knows a case, and nothing moves.
//!
//! ```
//! use fractum_math::Vec3;
//! use fractum_mesh::Mesh;
//! use fractum_prepare::{LooseFill, LooseRequest, Region, prepare_loose};
//! let region = Region::Box { point: Vec3::zeros(), size: Vec3::repeat(1.0) };
//! let source = LooseFill::Cloud { region: &region, radius: 0.1, dispersion: 0.0, count: Some(20), seed: 1 };
//! let (density, young_modulus, repeats) = (2500.0, 70e9, [false; 3]);
//! let made = prepare_loose(&LooseRequest { source, density, young_modulus, clump: None, thickness: None, repeats }, &Mesh::default(), &|_| {});
//! let made = made.unwrap().body;
//! assert_eq!((made.particles.len(), made.pairs.len()), (20, 0));
//! ```

#![forbid(unsafe_code)]

mod asked;
mod body;
mod bonded;
mod cache;
mod loose;
mod particle_file;
mod region;

pub use asked::{
    Amount, At, BondLawKind, BondStrength, BondedRequest, BondedSubstance, Clump, Doubt, Fault, Filled, InterfaceArea,
    Interfaces, LooseFill, LooseRequest, PackingRequest, ParticleFile, ParticleSize, Rate, Region, Shape, Stream, Turn,
    graded_count,
};
pub use body::PreparedBody;
pub use bonded::{
    BondedReport, FoundStrengths, InterfaceReport, Joints, MadeBody, Origin, group_surface, prepare_bonded,
};
pub use cache::Cache;
pub use fractum_calibrate::Micro;
pub use loose::{MadeParticles, prepare_loose};
