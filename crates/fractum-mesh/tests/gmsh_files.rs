//! Files written by Gmsh 4.15, meshio 5.3 and `data/make.py`, read as these read them.
//!
//! The tables are the output of `data/make.py`: what Gmsh (and meshio where it can) finds in each file, elements of
//! equal nodes counted once.

use fractum_mesh::{Mesh, MeshError, MshFormat, Problem, Vec3, quality, read_msh, topology, write_msh};

fn bytes_of(name: &str) -> Vec<u8> {
    let path = format!("{}/tests/data/{name}.msh", env!("CARGO_MANIFEST_DIR"));
    std::fs::read(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

fn read(name: &str) -> Mesh {
    read_msh(&bytes_of(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn refused(bytes: &[u8]) -> MeshError {
    read_msh(bytes).expect_err("the file should be refused")
}

/// Dimension, tag, name, elements, nodes.
type Row = (u8, i32, &'static str, usize, usize);

const BOXES: &[Row] = &[
    (0, 4, "corner", 1, 1),
    (1, 1, "left", 1, 2),
    (2, 7, "physical-7", 4, 5),
    (2, 8, "interface é", 4, 5),
    (2, 9, "reversed", 4, 5),
    (3, 1, "left", 24, 14),
    (3, 2, "left too", 24, 14),
];
const SAVED_WITHOUT_GROUPS: &[Row] = &[
    (0, 4, "corner", 0, 0),
    (1, 1, "left", 0, 0),
    (2, 8, "interface é", 0, 0),
    (2, 9, "reversed", 0, 0),
    (3, 1, "left", 0, 0),
    (3, 2, "left too", 0, 0),
];
const BY_MESHIO: &[Row] = &[
    (0, 4, "corner", 1, 1),
    (1, 1, "physical-1", 1, 2), // meshio 5.3 drops one of two names that are equal in different dimensions
    (2, 7, "physical-7", 4, 5),
    (2, 8, "interface é", 4, 5),
    (2, 9, "reversed", 4, 5),
    (3, 1, "left", 24, 14),
    (3, 2, "left too", 24, 14),
];
const BY_MESHIO_41: &[Row] = &[
    (0, 4, "corner", 1, 1),
    (2, 7, "physical-7", 4, 5),
    (2, 8, "interface é", 4, 5),
    (2, 9, "reversed", 0, 0),
    (3, 1, "left", 0, 0),
    (3, 2, "left too", 0, 0),
];
const PLANE: &[Row] = &[(2, 1, "triangles", 14, 12), (2, 2, "quads", 8, 9)]; // four quadrilaterals
const PERIODIC: &[Row] = &[(2, 2, "right", 4, 5), (3, 1, "body", 24, 14)];
const STORAGE: &[Row] = &[(3, 3, "body", 24, 14)];
const SPARSE: &[Row] = &[(3, 1, "body", 2, 5)];

/// File, nodes in use, points, lines, triangles, tetrahedra, volume, groups.
type File = (&'static str, usize, [usize; 4], f64, &'static [Row]);

const FILES: &[File] = &[
    ("all-22-ascii", 23, [12, 20, 44, 48], 2.0, SAVED_WITHOUT_GROUPS),
    ("all-41-binary", 23, [12, 20, 44, 48], 2.0, BOXES),
    ("boxes-22-ascii", 14, [1, 1, 8, 24], 1.0, BOXES),
    ("boxes-22-binary", 14, [1, 1, 8, 24], 1.0, BOXES),
    ("boxes-41-ascii", 14, [1, 1, 8, 24], 1.0, BOXES),
    ("boxes-41-binary", 14, [1, 1, 8, 24], 1.0, BOXES),
    ("data-22-binary", 14, [1, 1, 8, 24], 1.0, BOXES),
    ("data-41-binary", 14, [1, 1, 8, 24], 1.0, BOXES),
    ("ghosts-22-ascii", 14, [1, 1, 8, 24], 1.0, BOXES),
    ("ghosts-41-binary", 14, [1, 1, 8, 24], 1.0, BOXES),
    ("layers-41-binary", 42, [24, 44, 72, 60], 3.0, &[(3, 1, "simplices", 24, 14)]),
    ("meshio-22-ascii", 14, [1, 1, 8, 24], 1.0, BY_MESHIO),
    ("meshio-22-binary", 14, [1, 1, 8, 24], 1.0, BY_MESHIO),
    ("meshio-41-ascii", 14, [1, 1, 8, 24], 1.0, BY_MESHIO_41),
    ("order3-22-ascii", 14, [1, 1, 8, 24], 1.0, BOXES),
    ("parametric-22-ascii", 23, [12, 20, 44, 48], 2.0, SAVED_WITHOUT_GROUPS),
    ("parametric-22-binary", 23, [12, 20, 44, 48], 2.0, SAVED_WITHOUT_GROUPS),
    ("parametric-41-ascii", 23, [12, 20, 44, 48], 2.0, BOXES),
    ("parametric-41-binary", 23, [12, 20, 44, 48], 2.0, BOXES),
    ("parts-22-ascii", 14, [1, 1, 8, 24], 1.0, BOXES),
    ("parts-22-binary", 14, [1, 1, 8, 24], 1.0, BOXES),
    ("parts-41-ascii", 14, [1, 1, 8, 24], 1.0, BOXES),
    ("parts-41-binary", 14, [1, 1, 8, 24], 1.0, BOXES),
    ("periodic-41-ascii", 14, [0, 0, 4, 24], 1.0, PERIODIC),
    ("periodic-41-binary", 14, [0, 0, 4, 24], 1.0, PERIODIC),
    ("plane-22-ascii", 21, [0, 0, 22, 0], 0.0, PLANE),
    ("plane-22-binary", 21, [0, 0, 22, 0], 0.0, PLANE),
    ("plane-41-ascii", 21, [0, 0, 22, 0], 0.0, PLANE),
    ("plane-41-binary", 21, [0, 0, 22, 0], 0.0, PLANE),
    ("quadratic-22-ascii", 14, [1, 1, 8, 24], 1.0, BOXES),
    ("quadratic-41-binary", 14, [1, 1, 8, 24], 1.0, BOXES),
    ("sparse-22-ascii", 5, [0, 0, 0, 2], 0.5, SPARSE),
    ("sparse-41-ascii", 5, [0, 0, 0, 2], 0.5, SPARSE),
    ("sparse-41-binary", 5, [0, 0, 0, 2], 0.5, SPARSE),
    ("storage-22-big", 14, [0, 0, 0, 24], 1.0, STORAGE),
    ("storage-22-little", 14, [0, 0, 0, 24], 1.0, STORAGE),
    ("storage-41-big-4", 14, [0, 0, 0, 24], 1.0, STORAGE),
    ("storage-41-big-8", 14, [0, 0, 0, 24], 1.0, STORAGE),
    ("storage-41-little-4", 14, [0, 0, 0, 24], 1.0, STORAGE),
];

#[test]
fn every_file_has_the_elements_and_groups_that_gmsh_finds() {
    for &(name, nodes, counts, volume, groups) in FILES {
        let mesh = read(name);
        let lengths = [mesh.points.len(), mesh.lines.len(), mesh.triangles.len(), mesh.tetrahedra.len()];
        assert_eq!((mesh.nodes.len(), lengths), (nodes, counts), "{name}");
        let total: f64 =
            mesh.tetrahedra.iter().map(|e| quality::signed_volume(e.map(|n| mesh.nodes[n as usize]))).sum();
        assert!((total - volume).abs() < 1e-12, "{name}: volume {total}");
        let nodes_of = |group: &fractum_mesh::Group| {
            let alone = Mesh { groups: vec![group.clone()], ..mesh.clone() };
            alone.group_nodes(&group.name).len()
        };
        let found: Vec<_> = mesh
            .groups
            .iter()
            .map(|group| (group.dimension, group.tag, group.name.as_str(), group.element_count(), nodes_of(group)))
            .collect();
        assert_eq!(found, groups, "{name}");
    }
}

#[test]
fn one_model_reads_alike_from_every_format() {
    let sorted = |name: &str| {
        let mesh = read(name);
        let mut centers: Vec<[i64; 3]> = mesh
            .tetrahedra
            .iter()
            .map(|e| e.iter().map(|&n| mesh.nodes[n as usize]).sum::<Vec3>())
            .map(|sum| [sum.x, sum.y, sum.z].map(|x| (x * 1e6).round() as i64))
            .collect();
        centers.sort_unstable();
        (centers, mesh.group_names().join(" "))
    };
    let reference = sorted("boxes-41-binary");
    for name in ["boxes-22-ascii", "boxes-22-binary", "boxes-41-ascii", "data-22-binary", "order3-22-ascii"] {
        assert_eq!(sorted(name), reference, "{name}");
    }
}

#[test]
fn a_name_may_stand_for_groups_of_several_dimensions() {
    let mesh = read("boxes-41-ascii");
    let left = mesh.group("left");
    assert_eq!(left.iter().map(|group| group.dimension).collect::<Vec<_>>(), [1, 3]);
    assert_eq!(mesh.group_nodes("left").len(), 14);
    assert!(mesh.group("suport").is_empty() && mesh.group_nodes("suport").is_empty());
    assert_eq!(mesh.group_names(), ["corner", "left", "physical-7", "interface é", "reversed", "left too"]);
    assert_eq!(mesh.bounding_box(), (Vec3::zeros(), Vec3::new(1.0, 1.0, 1.0)));
}

#[test]
fn notices_tell_what_was_done_to_the_file() {
    for (name, expected) in [
        ("boxes-22-ascii", "28 repeated listing(s) of an element merged with the first"),
        ("boxes-41-ascii", "physical group(s) without a name: called \"physical-7\" of dimension 2"),
        ("all-22-ascii", "saved with all elements (Mesh.SaveAll) loses its groups"),
        ("quadratic-22-ascii", "1 line, 8 triangles, 24 tetrahedra of higher order read with corners only"),
        ("quadratic-41-binary", "49 node(s) that no element uses were dropped"),
        ("periodic-41-ascii", "section(s) skipped: $Periodic"),
        ("data-41-binary", "section(s) skipped: $InterpolationScheme, $NodeData"),
        ("ghosts-41-binary", "section(s) skipped: $GhostElements"),
        (
            "layers-41-binary",
            "4 hexahedra, 4 prisms split into 36 tetrahedra; 20 quadrilaterals split into 40 triangles",
        ),
        ("plane-22-ascii", "22 clockwise element(s) of the plane mesh were flipped"),
        ("meshio-41-ascii", "25 element(s) lie on entities that $Entities does not list"),
    ] {
        let notices = read(name).notices;
        assert!(notices.iter().any(|notice| notice.contains(expected)), "{name}: {notices:?}");
    }
    assert!(read("storage-41-big-8").notices.is_empty());
}

#[test]
fn plane_meshes_are_counter_clockwise() {
    for name in ["plane-22-ascii", "plane-41-binary"] {
        let mesh = read(name);
        let area = |corners: &[u32; 3]| quality::area_vector(corners.map(|n| mesh.nodes[n as usize])).z;
        assert!(mesh.triangles.iter().all(|triangle| area(triangle) > 0.0), "{name}");
        let total = mesh.triangles.iter().map(area).sum::<f64>();
        assert!((total - 2.0).abs() < 1e-12, "{name}");
    }
}

#[test]
fn hexahedra_and_prisms_become_tetrahedra_of_their_groups() {
    // Three cubes: two prisms over each half of the first, four hexahedra in the second, tetrahedra in the third.
    for name in ["blocks-41-ascii", "blocks-22-binary", "layers-22-binary"] {
        let mesh = read(name);
        let volume = |e: &[u32; 4]| quality::signed_volume(e.map(|n| mesh.nodes[n as usize]));
        let total: f64 = mesh.tetrahedra.iter().map(volume).sum();
        assert!((total - 3.0).abs() < 1e-12, "{name}: volume {total}");
        let sides = topology::boundary_of_tetrahedra(&mesh.tetrahedra);
        let area = |facet: &topology::Facet| quality::area_vector(facet.nodes.map(|n| mesh.nodes[n as usize])).norm();
        let surface: f64 = sides.iter().map(area).sum();
        assert!((surface - 18.0).abs() < 1e-12, "{name}: surface {surface}");
        for (group, count, size) in [("layers", 12, 1.0), ("blocks", 24, 1.0), ("simplices", 24, 1.0)] {
            for group in mesh.group(group).into_iter().filter(|_| name.starts_with("blocks")) {
                let own: f64 = group.tetrahedra.iter().map(|&e| volume(&mesh.tetrahedra[e as usize])).sum();
                assert!(group.tetrahedra.len() == count && (own - size).abs() < 1e-12, "{name} {group:?}");
            }
        }
    }
}

#[test]
fn what_gmsh_wrote_survives_our_writer() {
    for &(name, ..) in FILES {
        let mut mesh = read(name);
        mesh.notices.clear();
        if name.starts_with("layers") || name.starts_with("plane") {
            mesh.number(); // tags of pieces have more than 32 bits
        }
        for format in [MshFormat::V2_2Ascii, MshFormat::V2_2Binary, MshFormat::V4_1Ascii, MshFormat::V4_1Binary] {
            let mut bytes = Vec::new();
            if let Err(error) = write_msh(&mesh, format, &mut bytes) {
                assert!(name.starts_with("sparse-41") && error.to_string().contains("32 bits"), "{name}: {error}");
                continue;
            }
            let mut back = read_msh(&bytes).unwrap_or_else(|error| panic!("{name} {format:?}: {error}"));
            back.notices.clear();
            assert_eq!(back, mesh, "{name} {format:?}");
        }
    }
}

#[test]
fn every_truncation_is_an_error_and_none_panics() {
    for &(name, ..) in FILES {
        let bytes = bytes_of(name);
        let whole = bytes.trim_ascii_end().len();
        // what comes before the end of $Elements is needed; behind it only whole sections may go
        let needed = bytes.windows(12).position(|window| window == b"$EndElements").unwrap() + 12;
        for length in 0..whole {
            let result = read_msh(&bytes[..length]);
            assert!(length >= needed || result.is_err(), "{name} cut to {length} bytes was read");
        }
        assert!(read_msh(&bytes[..whole]).is_ok());
    }
}

#[test]
fn line_ends_comments_blank_lines_and_marks_do_not_matter() {
    for name in ["boxes-22-ascii", "boxes-41-ascii", "parametric-41-ascii", "parts-22-ascii"] {
        let mesh = read(name);
        let text = String::from_utf8(bytes_of(name)).unwrap();
        let comment = "$Comments\nany text, even $Nodes\n$EndComments\n";
        let variants = [
            text.replace('\n', "\r\n"),
            text.replace('\n', " \n\n\t"),
            format!("\u{feff}{text}"),
            format!("\n\n{text}\n\n{comment}"),
            format!("\u{feff}{comment}\n{comment}{text}"),
            text.replacen("$Nodes", &format!("{comment}$Nodes"), 1),
        ];
        for variant in &variants {
            assert_eq!(read_msh(variant.as_bytes()).unwrap(), mesh, "{name}");
        }
        let stray = text.replacen("$Nodes", "# made by hand\n$Nodes", 1);
        assert!(read_msh(stray.as_bytes()).unwrap().notices[0].contains("1 line(s) outside any section"));
    }
    // binary sections with text lines ended by another system
    let bytes = bytes_of("boxes-41-binary");
    let text_end = bytes.windows(9).position(|window| window == b"$Entities").unwrap();
    let header_end = bytes.iter().position(|&byte| byte == 1).unwrap() + 4;
    let names = String::from_utf8(bytes[header_end..text_end].to_vec()).unwrap().replace('\n', "\r\n");
    let mixed = [&bytes[..header_end], names.as_bytes(), &bytes[text_end..]].concat();
    assert_eq!(read_msh(&mixed).unwrap(), read("boxes-41-binary"));
    let commented = [b"$Comments\n$MeshFormat\n$EndComments\n", &bytes[..]].concat();
    assert_eq!(read_msh(&commented).unwrap(), read("boxes-41-binary"));
}

#[test]
fn comments_alone_are_no_mesh() {
    for text in ["$Comments\nnothing else\n$EndComments\n", "$Comments\nwithout end\n"] {
        assert!(matches!(refused(text.as_bytes()).problem, Problem::Truncated { .. }), "{text}");
    }
}

#[test]
fn sections_may_come_in_another_order() {
    let text = String::from_utf8(bytes_of("boxes-41-ascii")).unwrap();
    let (head, rest) = text.split_at(text.find("$Entities").unwrap());
    let (entities, rest) = rest.split_at(rest.find("$Nodes").unwrap());
    let (nodes, elements) = rest.split_at(rest.find("$Elements").unwrap());
    let (format, names) = head.split_at(head.find("$PhysicalNames").unwrap());
    let shuffled = [format, elements, nodes, entities, names].concat();
    assert_eq!(read_msh(shuffled.as_bytes()).unwrap(), read("boxes-41-ascii"));
}
