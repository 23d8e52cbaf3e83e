//! Bodies of a case made ready for the scene, and the solver chosen where the case leaves it open.
//!
//! - [`prepare_bodies`]: bonded bodies are packed (or their packing is read), bonded, calibrated to the material and given
//!   their strengths; clouds of loose particles are filled or read. What takes long is kept in a [`Cache`].
//! - [`facets`]: closed surfaces of rigid bodies from STL files
//! - [`check_memory`]: bodies larger than the memory are refused before they are made
//! - [`choose`] and [`compare`]: motion or equilibrium, by what each would cost
//!
//! Nothing moves here: the scene is built by `fractum-io` from what this crate returns, and stepped by `fractum-scene`.
//!
//! ```no_run
//! use fractum_io::build::build_scene;
//! use fractum_io::case::read_case;
//! use fractum_mesh::Mesh;
//! use fractum_prepare::{Cache, facets, prepare_bodies};
//! let case = read_case("cases/bonded-box/tension.toml".as_ref(), &[])?;
//! let mesh = Mesh::default();
//! let made = prepare_bodies(&case, &mesh, &Cache::new(Some("cache".into())), &|_| {})?;
//! let built = build_scene(&case, &mesh, made.prepared, facets(&case)?)?;
//! # Ok::<(), fractum_io::case::Diagnostics>(())
//! ```

#![forbid(unsafe_code)]

mod bonded;
mod cache;
mod choice;
mod loose;
mod memory;
mod region;

pub use bonded::{
    BondedBodies, BondedReport, FoundStrengths, InterfaceReport, Joints, Origin, group_surface, prepare_bodies,
};
pub use cache::Cache;
pub use choice::{PATH_ITERATIONS, choose, compare, solution_time};
pub use loose::facets;
pub use memory::{Processes, check_memory};
