//! A mesh as a VTU, for ParaView and meshio.

use fractum::Failure;
use fractum_mesh::{Group, Mesh};
use fractum_vtk::{CellBlock, CellKind, Compression, Field, UnstructuredGrid};

/// Groups that have arrays of their own.
const MOST_ARRAYS: usize = 100;

/// The file: all elements, their group by its tag in `gmsh:physical` (of several the first), and 1 in the array of each group
/// that they are in.
///
/// # Errors
/// [`Failure`] of arrays that do not fit, which those of a mesh do.
pub(super) fn bytes(mesh: &Mesh) -> Result<Vec<u8>, Failure> {
    let points: Vec<[f64; 3]> = mesh.nodes.iter().map(|&node| node.into()).collect();
    let blocks = [
        (CellKind::Vertex, mesh.points.as_flattened()),
        (CellKind::Line, mesh.lines.as_flattened()),
        (CellKind::Triangle, mesh.triangles.as_flattened()),
        (CellKind::Tetrahedron, mesh.tetrahedra.as_flattened()),
    ];
    let cells = blocks.map(|(kind, nodes)| CellBlock { kind, nodes });
    let mut first = [0; 5];
    for (index, CellBlock { kind, nodes }) in cells.iter().enumerate() {
        first[index + 1] = first[index] + nodes.len() / kind.nodes();
    }
    let mut physical = vec![0i32; first[4]];
    let mut flags: Vec<Vec<u8>> = Vec::new();
    for (index, group) in mesh.groups.iter().enumerate() {
        let mut flag = vec![0u8; if index < MOST_ARRAYS { first[4] } else { 0 }];
        for cell in cells_of(group, &first) {
            if physical[cell] == 0 {
                physical[cell] = group.tag;
            }
            if let Some(flag) = flag.get_mut(cell) {
                *flag = 1;
            }
        }
        flags.push(flag);
    }
    let names: Vec<String> = mesh.groups.iter().map(|group| format!("{} ({}d)", group.name, group.dimension)).collect();
    let mut cell_data = vec![Field::integer("gmsh:physical", &physical)];
    cell_data.extend(names.iter().zip(&flags).take(MOST_ARRAYS).map(|(name, flag)| Field::flag(name, flag)));
    let grid = UnstructuredGrid { points: &points, cells: &cells, point_data: &[], cell_data: &cell_data, time: None };
    grid.to_bytes(Compression::Fast).map_err(|error| Failure::input(error.to_string()))
}

/// Numbers of the cells of a group.
fn cells_of(group: &Group, first: &[usize; 5]) -> Vec<usize> {
    let members = [&group.points, &group.lines, &group.triangles, &group.tetrahedra];
    let of_kind = |(members, first): (&Vec<u32>, &usize)| {
        members.iter().map(|&member| first + member as usize).collect::<Vec<_>>()
    };
    members.into_iter().zip(first).flat_map(of_kind).collect()
}
