//! Grids of VTK as its writer and meshio store them, and those that are refused. The files are one grid of two tetrahedra, two
//! triangles and a line, written by VTK 9.7 in each of its modes, and two tetrahedra and two triangles of meshio 5.3.

use fractum_mesh::{Mesh, Vec3, read_mesh, read_vtu};

fn bytes_of(name: &str) -> Vec<u8> {
    let path = format!("{}/tests/data/grid-{name}.vtu", env!("CARGO_MANIFEST_DIR"));
    std::fs::read(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

fn members(mesh: &Mesh, group: &str) -> Vec<(u8, usize)> {
    mesh.group(group).iter().map(|group| (group.dimension, group.element_count())).collect()
}

#[test]
fn every_mode_of_storage_gives_the_same_mesh() {
    let mesh = read_mesh(&bytes_of("ascii")).unwrap();
    assert_eq!(mesh.nodes[4], Vec3::new(1.0, 1.0, 1.0));
    assert_eq!(
        (mesh.tetrahedra.len(), mesh.triangles.as_slice(), mesh.lines.as_slice()),
        (2, &[[0, 2, 1], [1, 2, 4]][..], &[[0, 1]][..])
    );
    // Groups are arrays of zeros and ones: of cells, whatever their type, and of points.
    for (group, expected) in [("left", (2, 1)), ("both facets", (2, 2)), ("body", (3, 2)), ("held", (0, 2))] {
        assert_eq!(members(&mesh, group), [expected], "{group}");
    }
    assert_eq!(mesh.groups.len(), 4, "{:?}", mesh.group_names());
    assert_eq!(mesh.group_nodes("held"), [0, 3]);
    for name in ["inline", "inline-zlib", "appended", "appended-raw"] {
        assert_eq!(read_mesh(&bytes_of(name)).unwrap(), mesh, "{name}");
    }
}

#[test]
fn numbers_of_parts_are_groups_where_no_array_names_them() {
    let mesh = read_vtu(&bytes_of("meshio")).unwrap();
    assert_eq!(mesh.group_names(), ["physical-3", "physical-7"]);
    assert_eq!((members(&mesh, "physical-7"), members(&mesh, "physical-3")), (vec![(3, 2)], vec![(2, 1)]));
}

#[test]
fn empty_pieces_are_passed_over() {
    let text = String::from_utf8(bytes_of("ascii")).unwrap();
    let array = |name: &str| format!("<DataArray type=\"Int32\" Name=\"{name}\" format=\"ascii\"></DataArray>");
    let empty = format!(
        "<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"><PointData>{}</PointData><CellData/><Points>{}</Points></Piece>",
        array("held"),
        array("Points")
    );
    let whole = read_vtu(text.as_bytes()).unwrap();
    let before = text.replacen("<Piece", &format!("{empty}<Piece"), 1);
    let after = text.replacen("</Piece>", &format!("</Piece>{empty}"), 1);
    for text in [before, after] {
        let mesh = read_vtu(text.as_bytes()).unwrap();
        assert_eq!(
            (&mesh.nodes, &mesh.tetrahedra, mesh.group_names()),
            (&whole.nodes, &whole.tetrahedra, whole.group_names())
        );
    }
}

/// The message for the file as text with one change.
fn message(from: &str, to: &str) -> String {
    let text = String::from_utf8(bytes_of("ascii")).unwrap();
    assert!(text.contains(from), "{from}");
    let read = read_vtu(text.replacen(from, to, 1).as_bytes());
    read.err().map_or_else(|| panic!("{to} is read"), |error| error.to_string())
}

#[test]
fn what_cannot_be_read_is_refused_with_its_line_and_a_remedy() {
    for (from, to, says) in [
        (
            "UnstructuredGrid",
            "PolyData",
            "line 2: a VTK file of type PolyData; expected UnstructuredGrid (.vtu): in ParaView",
        ),
        (
            "header_type",
            "compressor=\"vtkLZ4DataCompressor\" header_type",
            "line 2: compressed by vtkLZ4DataCompressor; expected vtkZLib",
        ),
        ("<VTKFile", "<html", "line 2: found `<html type"),
        (
            "</Piece>",
            "</Piece><Piece NumberOfPoints=\"1\">",
            "fractum reads grids of one piece: in ParaView apply Merge Blocks",
        ),
        ("10 10 5 5 3", "42 10 5 5 3", "cell 0 has type 42 of VTK; expected points"),
        ("10 10 5 5 3", "12 10 5 5 3", "hexahedron"),
        ("10 10 5 5 3", "10 10 5 5", "line 48: array \"types\" has 4 numbers; the sizes of the grid want 5"),
        ("4 8 11 14 16", "4 8 5 14 16", "line 45: offset 5 of cell 2 is out of order"),
        ("4 8 11 14 16", "4 8 11 13 16", "line 45: cell 3, a triangle, has 2 nodes"),
        ("0 1 2 3 1 2", "0 1 2 5 1 2", "line 40: cell 0 names point 5 of 5"),
        ("1 0 0 1 0", "1 0 0 0.5 0", "line 6: found `0.5` in array \"held\"; expected a whole number"),
        ("0 0 0 1 0 0", "0 0 0 nan 0 0", "line 25: found `nan` in array \"Points\"; expected a finite number"),
        ("Name=\"types\"", "Name=\"kinds\"", "expected the array types of the grid"),
        (
            "NumberOfPoints=\"5\"",
            "NumberOfPoints=\"9\"",
            "array \"Points\" has 15 numbers; the sizes of the grid want 27",
        ),
        ("</DataArray>", "</DataArray", "expected"),
        ("Name=\"left\"", "Name=\"vtkGhostType\"", "cells that VTK hides or has twice (vtkGhostType)"),
    ] {
        let said = message(from, to);
        assert!(said.contains(says), "{to}: {said}");
    }
    let cut = bytes_of("appended-raw");
    let said = read_vtu(&cut[..cut.len() - 150]).unwrap_err().to_string();
    assert!(said.contains("or is damaged; save the file again"), "{said}");
}
