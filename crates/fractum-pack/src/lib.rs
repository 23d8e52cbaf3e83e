//! Random packings of spheres: a closed shape in, a checked packing and its bond network out.
//!
//! [`pack`] fills a box, a cylinder, a sphere or any closed triangulated surface with spheres of uniformly scattered
//! radii (the *cooker* of Jebahi et al. 2015: random insertion, forced insertion, relaxation, compaction, wall
//! release). [`Certificate`] measures the result. [`bond`] joins neighbours to an asked coordination number.
//!
//! A box may repeat along its edges ([`Domain::Periodic`]): it has no walls.
//!
//! [`cloud`], [`insert`], [`dense`] and [`dense_discs`] place loose particles that do not touch.
//!
//! Not modelled: friction and gravity during packing, prescribed size distributions other than uniform.
//!
//! ```
//! use fractum_pack::{Convention, Domain, PackSpec, bond, pack};
//! let packing = pack(&PackSpec::new(Domain::cuboid(1.0, 1.0, 1.0), 300, 7))?;
//! let network = bond(&packing, 8.0, Convention::All)?;
//! assert!((network.coordination_all - 8.0).abs() < 0.01);
//! # Ok::<(), fractum_pack::PackError>(())
//! ```

#![forbid(unsafe_code)]

mod certificate;
mod cloud;
mod cooker;
mod dense;
mod domain;
mod error;
mod grading;
mod insertion;
mod isotropy;
mod neighbours;
mod network;
mod orientations;
mod packing;
mod period;
mod random;
mod regular;
mod relax;
mod stl;
mod stream;
mod surface;
mod wall_areas;

pub use certificate::{Certificate, ContactFigures, OverlapFigures, interior_fraction};
pub use cloud::{cloud, cloud_cells};
pub use cooker::{PackProgress, PackSize, PackSpec, pack, pack_and_tell, pack_certified};
pub use dense::{dense, dense_discs};
pub use domain::{Domain, DomainData};
pub use error::PackError;
pub use grading::Grading;
pub use insertion::insert;
pub use isotropy::Isotropy;
pub use network::{BondNetwork, Convention, bond, pairs_within};
pub use orientations::orientations;
pub use packing::{Compaction, Packing};
pub use period::Period;
pub use regular::{Arrangement, regular, regular_repeating};
pub use stl::{read_stl, read_stl_facets};
pub use stream::{Sizes, place_in};
pub use surface::{ClosedSurface, SurfaceData};
