//! From the arrays of a grid to a raw mesh.

use std::collections::BTreeMap;

use fractum_math::Vec3;
use fractum_vtk::file::{Array, Document, Section};

use crate::tagged::builder::Builder;
use crate::tagged::element_type::{ElementType, Shape};
use crate::tagged::error::Fault;
use crate::tagged::raw::{Raw, Records};

/// Arrays that other programs number the parts of a mesh with; 0 and less is no part.
const PARTS: [&str; 8] = [
    "gmsh:physical",
    "medit:ref",
    "nastran:ref",
    "netgen:index",
    "tetgen:ref",
    "ugrid:ref",
    "su2:tag",
    "CellEntityIds",
];

/// Flags by which VTK hides points and cells, or says that another piece has them too.
const GHOSTS: &str = "vtkGhostType";

/// A group and which cells or points are in it.
type Members = (i32, Vec<bool>);

/// The raw mesh, checked as far as only this format needs it.
pub(super) fn raw(document: &Document, bytes: &[u8]) -> Result<Raw, Fault> {
    let mut groups = Groups::default();
    let points = document.array(Section::Points, "Points")?;
    let positions = document.reals(points, 3usize.saturating_mul(document.points))?;
    groups.builder.raw.nodes = positions.chunks_exact(3).map(|x| Vec3::new(x[0], x[1], x[2])).collect();
    groups.builder.raw.node_tags = (1..=document.points as u64).collect();
    groups.builder.raw.node_blocks = vec![(0, Records { at: points.at, stride: 0 })];

    let mut of_cells = document.arrays.iter().filter(|array| array.section == Section::CellData);
    if let Some(ghosts) = of_cells.find(|array| array.name == GHOSTS)
        && document.wholes(ghosts, document.cells)?.iter().any(|&flags| flags != 0)
    {
        let hidden = "cells that VTK hides or has twice (vtkGhostType); in ParaView remove them and save again";
        return Err(Fault::unsupported(ghosts.at, hidden));
    }
    let of_cells = groups.of_cells(document)?;
    let of_points = groups.flags(document, Section::PointData, document.points)?;
    let mut builder = groups.builder;
    add_cells(&mut builder, document, &of_cells)?;
    for node in 0..document.points {
        let own = groups_of(&of_points, node);
        if !own.is_empty() {
            let kind = ElementType { shape: Shape::Point, nodes: 1 };
            builder.push(kind, own, points.at, builder.next_tag(), &[node as u64 + 1]);
        }
    }
    builder.finish(bytes)
}

fn groups_of(members: &[Members], index: usize) -> Vec<i32> {
    members.iter().filter(|(_, members)| members[index]).map(|(group, _)| *group).collect()
}

#[derive(Default)]
struct Groups {
    builder: Builder,
    /// Tags of the groups by name.
    tags: BTreeMap<String, i32>,
}

impl Groups {
    /// The tag of a group, the same for the same name.
    fn tag(&mut self, name: &str, at: usize) -> i32 {
        *self.tags.entry(name.to_owned()).or_insert_with(|| self.builder.group(name, at, ""))
    }

    /// Groups of cells.
    fn of_cells(&mut self, document: &Document) -> Result<Vec<Members>, Fault> {
        let mut members = self.flags(document, Section::CellData, document.cells)?;
        let is_ours = |array: &&Array| array.section == Section::CellData && own_name(&array.name) != array.name;
        if document.arrays.iter().any(|array| is_ours(&array)) {
            return Ok(members);
        }
        let find = |name: &&str| document.arrays.iter().find(|a| a.section == Section::CellData && a.name == **name);
        let Some(parts) = PARTS.iter().find_map(find).filter(|array| array.is_whole()) else {
            return Ok(members);
        };
        let numbers = document.wholes(parts, document.cells.saturating_mul(parts.components))?;
        let of_cell = |cell: usize| numbers[cell * parts.components];
        let mut found: BTreeMap<i64, Vec<bool>> = BTreeMap::new();
        for (cell, number) in (0..document.cells).map(|cell| (cell, of_cell(cell))).filter(|(_, number)| *number > 0) {
            if found.len() >= MOST_PARTS && !found.contains_key(&number) {
                let message = format!("array \"{}\" numbers more than {MOST_PARTS} parts", parts.name);
                return Err(Fault::unsupported(parts.at, message));
            }
            found.entry(number).or_insert_with(|| vec![false; document.cells])[cell] = true;
        }
        for (number, cells) in found {
            members.push((self.tag(&format!("physical-{number}"), parts.at), cells));
        }
        Ok(members)
    }

    /// Groups by arrays of zeros and ones.
    fn flags(&mut self, document: &Document, section: Section, count: usize) -> Result<Vec<Members>, Fault> {
        let mut members = Vec::new();
        let is_flag = |array: &&Array| array.section == section && array.is_whole() && array.components == 1;
        for array in
            document.arrays.iter().filter(is_flag).filter(|array| array.name != GHOSTS && !array.name.is_empty())
        {
            let numbers = document.wholes(array, count)?;
            if numbers.contains(&1)
                && numbers.iter().all(|number| matches!(number, 0 | 1))
                && !PARTS.contains(&array.name.as_str())
            {
                let group = self.tag(own_name(&array.name), array.at);
                members.push((group, numbers.iter().map(|&number| number == 1).collect()));
            }
        }
        Ok(members)
    }
}

/// Parts that one array may number.
const MOST_PARTS: usize = 1000;

/// The name of a group, without the dimension that fractum writes behind it.
fn own_name(array: &str) -> &str {
    (0..=3).find_map(|dimension| array.strip_suffix(&format!(" ({dimension}d)"))).unwrap_or(array)
}

fn add_cells(builder: &mut Builder, document: &Document, groups: &[Members]) -> Result<(), Fault> {
    let [ends, types, connectivity] =
        ["offsets", "types", "connectivity"].map(|name| document.array(Section::Cells, name));
    let (ends_array, types, connectivity) = (ends?, types?, connectivity?);
    let ends = document.wholes(ends_array, document.cells)?;
    let codes = document.wholes(types, document.cells)?;
    let total = usize::try_from(ends.last().copied().unwrap_or(0)).unwrap_or(usize::MAX);
    let nodes = document.wholes(connectivity, total)?;
    let (mut begin, mut mid_nodes) = (0, Vec::new());
    for (cell, (&end, &code)) in ends.iter().zip(&codes).enumerate() {
        let disorder = || Fault::inconsistent(ends_array.at, format!("offset {end} of cell {cell} is out of order"));
        let end = usize::try_from(end).map_err(|_| disorder())?;
        let own = nodes.get(begin..end).ok_or_else(disorder)?;
        begin = end;
        let shape = shape_of(code).ok_or_else(|| unheld(code, cell, types.at))?;
        if own.len() < shape.corners() {
            let message = format!("cell {cell}, a {}, has {} nodes", shape.singular(), own.len());
            return Err(Fault::inconsistent(ends_array.at, message));
        }
        if let Some(node) = own.iter().find(|&&node| node < 0 || node as usize >= document.points) {
            let message = format!("cell {cell} names point {node} of {}, which are counted from 0", document.points);
            return Err(Fault::inconsistent(connectivity.at, message));
        }
        let mut nodes: Vec<u64> = own.iter().map(|&node| node as u64 + 1).collect();
        let corners = &mut nodes[..shape.corners()];
        if matches!(code, PIXEL | VOXEL) {
            // The corners go along the axes instead of around.
            corners.chunks_exact_mut(4).for_each(|face| face.swap(2, 3));
        }
        let kind = ElementType { shape, nodes: own.len() };
        builder.push(kind, groups_of(groups, cell), types.at, cell as u64 + 1, corners);
        mid_nodes.extend_from_slice(&nodes[shape.corners()..]);
    }
    builder.leave_out(mid_nodes);
    Ok(())
}

const PIXEL: i64 = 8;
const VOXEL: i64 = 11;

/// The shape of a cell type of VTK (`vtkCellType.h`) whose corners come first.
fn shape_of(code: i64) -> Option<Shape> {
    Some(match code {
        1 => Shape::Point,
        3 | 21 | 35 | 68 => Shape::Line,
        5 | 22 | 34 | 69 => Shape::Triangle,
        PIXEL | 9 | 23 | 28 | 30 | 70 => Shape::Quad,
        10 | 24 | 71 => Shape::Tetrahedron,
        VOXEL | 12 | 25 | 29 | 33 | 72 => Shape::Hexahedron,
        13 | 26 | 31 | 32 | 73 => Shape::Prism,
        14 | 27 | 37 | 74 => Shape::Pyramid,
        _ => return None,
    })
}

fn unheld(code: i64, cell: usize, at: usize) -> Fault {
    let message = format!(
        "cell {cell} has type {code} of VTK; expected points, lines, triangles, quadrilaterals, tetrahedra, hexahedra, wedges and pyramids: in ParaView apply \
         Tetrahedralize and save the data as .vtu"
    );
    Fault::unsupported(at, message)
}
