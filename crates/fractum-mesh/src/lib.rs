//! Meshes for fractum: readers of Gmsh, Abaqus and VTK files, a writer of Gmsh files, and what is derived from nodes and elements alone.
//!
//! - [`read_msh`] and [`write_msh`]: MSH 2.2 and 4.1, ASCII and binary, from bytes and to any writer
//! - [`read_inp`]: Abaqus input files; [`read_vtu`]: grids of VTK; [`read_mesh`] chooses by the first bytes; [`Gathered`]: one with the files
//!   that it names
//! - [`joined`]: one mesh of the files into which Gmsh writes its partitions
//! - [`joined_bodies`]: bodies of which each has nodes of its own, joined where their faces conform
//! - [`Mesh::cut`]: nodes doubled along faces inside of a mesh
//! - [`refined`]: smaller elements where they are asked for; [`halved`] everywhere; [`scrambled`]: another mesh of the same size
//! - [`Mesh`]: points, lines, triangles and tetrahedra with named [`Group`]s
//! - [`topology`]: edges, facets, outward boundary, elements of a node
//! - [`quality`]: volumes, altitudes, lengths of edges, radius ratios, dihedral angles; [`hints`] says what to mend
//! - [`bodies`]: each group that a body may be made of, and how they lie beside each other
//! - [`renumber`]: orders that keep neighbours close in memory
//! - [`generate`]: structured boxes and rectangles for tests and benches
//!
//! The crate models straight-sided simplices: elements of higher order lose their mid nodes on reading, and
//! quadrilaterals, hexahedra, prisms and pyramids are split. It opens no file; the caller hands over the bytes.
//!
//! ```
//! use fractum_mesh::{MshFormat, Vec3, generate::structured_box, read_msh, topology, write_msh};
//!
//! let mesh = structured_box([2, 2, 2], Vec3::new(1.0, 1.0, 1.0), None);
//! assert_eq!(mesh.tetrahedra.len(), 48);
//! assert_eq!(mesh.group_nodes("x-").len(), 9);
//! assert_eq!(topology::boundary_of_tetrahedra(&mesh.tetrahedra).len(), 48);
//!
//! let mut file = Vec::new();
//! write_msh(&mesh, MshFormat::V4_1Binary, &mut file)?;
//! assert_eq!(read_msh(&file)?, mesh);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

mod abaqus;
pub mod bodies;
mod coincident;
mod cut;
mod folds;
mod free;
pub mod generate;
mod gmsh;
mod hints;
mod join;
mod joints;
mod mesh;
mod neighbour;
pub mod quality;
mod refine;
pub mod renumber;
mod tagged;
pub mod topology;
mod trail;
mod vtk;

pub use abaqus::{Gathered, read_inp};
pub use coincident::{Coincident, Joint, coincident_nodes, joined_bodies};
pub use cut::{CutAlong, CutError};
pub use folds::{Fold, fold_of_tetrahedra, fold_of_triangles};
pub use fractum_math::Vec3;
pub use gmsh::{MshFormat, partitions, read_msh, write_msh};
pub use hints::hints;
pub use join::{JoinError, joined};
pub use joints::{
    Cutting, Disc, Fate, Grains, GrainsMade, JointGroup, JointSet, NetworkError, Orientation, Trace, mean_dip,
    mean_direction, normal_of,
};
pub use mesh::{CutFace, Group, Mesh, WholeMesh};
pub use neighbour::{halved, scrambled};
pub use refine::{RefineError, RefineOptions, Refined, bytes_to_refine, longest_edge, refined};
pub use tagged::{MeshError, Place, Problem};
pub use trail::{Ridge, RidgeError, SplitError, Spot, ridge};
pub use vtk::read_vtu;

/// The formats beside Gmsh's, for messages.
const OTHERS: &str = "an Abaqus input file (.inp) or a VTK grid (.vtu)";

/// How a pointer of Git LFS begins.
const GIT_LFS: &[u8] = b"version https://git-lfs";
/// What to say of one, behind its name.
const IS_POINTER: &str = " a pointer of Git LFS, which stands for the file; fetch the file itself with: git lfs pull";

/// Reads a mesh: a Gmsh file, an Abaqus input file or a grid of VTK, by its first bytes.
///
/// # Errors
/// As [`read_msh`], [`read_inp`] and [`read_vtu`].
pub fn read_mesh(bytes: &[u8]) -> Result<Mesh, MeshError> {
    let begins = bytes.strip_prefix(tagged::cursor::BYTE_ORDER_MARK).unwrap_or(bytes).trim_ascii_start();
    match begins.first() {
        Some(b'*') => read_inp(bytes),
        Some(b'<') => read_vtu(bytes),
        _ => read_msh(bytes),
    }
}
