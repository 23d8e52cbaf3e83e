//! Explicit finite elements (T4 in space, T3 in the plane) with damage that lives on the edges of the mesh.
//!
//! A solid is a set of *cells*: small patches of nodes over which the strain is constant. In the standard formulation
//! a cell is an element; in the smoothed one it is the domain of an edge (a share of every element around it), which
//! makes the elements less stiff and gives damage a place to live without any heuristics. Both run through one kernel.
//! The smoothed element is the ES-FEM of Liu, Nguyen-Thoi and Lam, *J. Sound Vib.* 320 (2009) 1100-1130, in the plane, and
//! its tetrahedral form (He et al., *Comput. Mech.* 52 (2013) 221-236) in space; the face-based relative is that of
//! Nguyen-Thoi et al., *Int. J. Numer. Meth. Eng.* 78 (2009) 324-353. Softening is scaled with the size of the elements as
//! in the crack band of Bažant and Oh, *Mater. Struct.* 16 (1983) 155-177.
//! Elements that a crack has cut through are removed; their mass stays on the nodes.
//!
//! Left out on purpose: discrete elements and contact (the coupling knows both), files, and the wall clock.
//!
//! ```
//! use fractum_fem::{Body, Elastic, Kinematics, Plane, Region, ElementKind, Solid};
//! use fractum_math::Vec3;
//! let nodes = vec![Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z()];
//! let steel = Elastic { density: 7850.0, young_modulus: 210e9, poisson_ratio: 0.3 };
//! let body = Body::new("tetrahedron", ElementKind::T4, vec![[0, 1, 2, 3]], steel);
//! let mut solid = Solid::new(nodes, vec![body]).unwrap();
//! solid.displacement[1].x = 1e-6;
//! solid.update_internal_forces(1e-9, true);
//! assert!(solid.force[1].x < 0.0 && solid.elastic_energy() > 0.0);
//! # let _ = (Kinematics::Small, Plane::Strain, Region::Everywhere);
//! ```

mod body;
mod cells;
pub mod cracks;
mod damage;
mod divided;
mod element;
mod error;
pub mod fields;
pub mod motion;
pub mod neighbours;
pub mod removal;
mod secant;
mod solid;
mod state;

pub use body::edges::BodyEdges;
pub use body::rate::RateCurves;
pub use body::{Body, DamageZone, Depth, ElementKind, Formulation, Kinematics, Region, Regularisation, facet_area};
pub use cells::viscosity::Viscosity;
pub use cracks::{
    CrackCell, CrackEdge, CrackFacet, CrackMouth, CrackNetwork, CrackNetworkState, CrackPlane, CrackSide, CrackSurface,
    Fracture, SeparatedElement, SeparatedFacet, Separation,
};
pub use damage::rate::RateReport;
pub use damage::threshold::{IN_RESERVE, LengthReport};
pub use divided::{
    BodyShare, ConnectedPieces, DividedBoundary, KnownAround, ReadBody, Replication, SharedNodes, all_elements, deal,
    divided_boundary,
};
pub use element::{CUT_MODES, InvertedElement};
pub use error::SolidError;
pub use fields::{Extreme, Extremes};
pub use fractum_kernels::damage::{EdgeDamage, EdgeRate, Seen, rate_factor};
pub use fractum_kernels::material::{
    BedStrength, Bedding, Criterion, CriterionKind, DamageLaw, Degradation, EXCESS_OF_PEAK, Elastic, Plane, Softening,
    Stiffness, Wave, crack_scale,
};
pub use motion::{LocalDamping, Prescribe, StableStep, WholeStep};
pub use secant::{CellDamage, DamagePoint, NotSecant, SecantCell};
pub use solid::Solid;
pub use solid::depths::{Depths, depths_of, facet_depth, is_axisymmetric, thickness_at};
pub use solid::subcycling::rubbed_energy;
pub use state::{BodyState, SolidState, rate_report};
