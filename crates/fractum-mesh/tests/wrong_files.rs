//! Wrong files get one message with place, finding, expectation and remedy.

use fractum_mesh::generate::structured_box;
use fractum_mesh::{Mesh, MshFormat, Vec3, read_msh, write_msh};

const V2: &str = "\
$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
1
3 1 \"body\"
$EndPhysicalNames
$Nodes
5
1 0 0 0
2 1 0 0
3 0 1 0
4 0 0 1
5 1 1 1
$EndNodes
$Elements
2
1 4 2 1 1 1 2 3 4
2 4 2 1 1 2 3 4 5
$EndElements
";

const V4: &str = "\
$MeshFormat
4.1 0 8
$EndMeshFormat
$Entities
0 0 0 1
1 0 0 0 1 1 1 1 7 0
$EndEntities
$Nodes
1 5 1 5
3 1 0 5
1
2
3
4
5
0 0 0
1 0 0
0 1 0
0 0 1
1 1 1
$EndNodes
$Elements
1 2 1 2
3 1 4 2
1 1 2 3 4
2 2 3 4 5
$EndElements
";

fn message(bytes: &[u8]) -> String {
    read_msh(bytes).expect_err("the file should be refused").to_string()
}

/// The message for a text in which one thing is replaced.
fn with(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from:?} is not in the text");
    message(text.replacen(from, to, 1).as_bytes())
}

#[test]
fn the_base_texts_are_right() {
    let mesh = read_msh(V2.as_bytes()).unwrap();
    assert_eq!((mesh.nodes.len(), mesh.tetrahedra.len()), (5, 2));
    assert_eq!(mesh.tetrahedra[0], [0, 1, 2, 3]);
    let other = read_msh(V4.as_bytes()).unwrap();
    assert_eq!(other.tetrahedra, mesh.tetrahedra);
    assert_eq!(other.group_names(), ["physical-7"]);
}

#[test]
fn foreign_and_empty_files_are_named() {
    assert_eq!(
        message(b""),
        "line 1: the file is empty; expected a Gmsh mesh (.msh), an Abaqus input file (.inp) or a VTK grid (.vtu)"
    );
    assert_eq!(
        message(b" \r\n\n"),
        "line 1: the file is empty; expected a Gmsh mesh (.msh), an Abaqus input file (.inp) or a VTK grid (.vtu)"
    );
    let start = "expected a Gmsh mesh, which begins with $MeshFormat, an Abaqus input file (.inp) or a VTK grid (.vtu)";
    assert_eq!(message(b"hello\n"), format!("line 1: found `hello`; {start}"));
    assert!(message(b"$NOD\n8\n").contains("this is MSH version 1, convert with: gmsh in.msh -save"));
    assert!(message(b"solid box\nfacet normal").contains("convert with: gmsh FILE -save"));
    assert!(
        message(b"(1 \"meshio 5.3.5\")\n").contains("an Ansys mesh, convert with: meshio convert --input-format ansys")
    );
    for (begin, says) in [
        (
            "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 8\n",
            "a pointer of Git LFS, which stands for the mesh",
        ),
        ("$ a model\nGRID,1,,0.,0.,0.\n", "a Nastran file, convert with: meshio convert --input-format nastran"),
        ("BEGIN BULK\n", "a Nastran file"),
        ("# vtk DataFile Version 3.0\n", "convert with: meshio convert IN OUT.vtu"),
        ("MeshVersionFormatted 2\n", "convert with: meshio convert IN OUT.vtu"),
    ] {
        assert!(message(begin.as_bytes()).contains(says), "{}", message(begin.as_bytes()));
    }
    assert!(message(&[0xff; 4096]).starts_with("line 1: found `"));
    let versions = [("1", "1"), ("3", "3"), ("4", "4"), ("4.2", "4.2"), ("2.3", "2.3")];
    for (written, shown) in versions {
        let expected = format!(
            "line 2: MSH version {shown} is not read; convert with: gmsh in.msh -save -format msh41 -o out.msh"
        );
        assert_eq!(with(V2, "2.2 0 8", &format!("{written} 0 8")), expected);
    }
    assert_eq!(with(V2, "2.2 0 8", "2.2 5 8"), "line 2: found file type 5; expected 0 (ASCII) or 1 (binary)");
    assert!(with(V2, "2.2 0 8", "nan 0 8").contains("found `nan`; expected the version"));
}

#[test]
fn records_of_wrong_content_are_shown_with_their_line() {
    for (text, from, to, expected) in [
        (V2, "2 1 0 0\n", "2 1 0\n", "line 11: found the end of the line; expected z of node 2 of 5"),
        (V2, "2 1 0 0\n", "2 1 0 0 9\n", "line 11: found `9`; expected the end of node 2 of 5"),
        (V2, "2 1 0 0\n", "2 1 x 0\n", "line 11: found `x`; expected y of node 2 of 5 (a finite number)"),
        (V2, "2 1 0 0\n", "2 1 nan 0\n", "line 11: found `nan`; expected y of node 2 of 5 (a finite number)"),
        (V2, "2 1 0 0\n", "2 1 0 1e999\n", "line 11: found `1e999`; expected z of node 2 of 5 (a finite number)"),
        (
            V2,
            "2 1 0 0\n",
            "-2 1 0 0\n",
            "line 11: found `-2`; expected the tag of node 2 of 5 (a whole number of at least 0)",
        ),
        (
            V2,
            "5\n1 0",
            "-5\n1 0",
            "line 9: found `-5`; expected the count of the number of nodes (a whole number of at least 0)",
        ),
        (V2, "5\n1 0", "6\n1 0", "line 15: found `$EndNodes`; expected node 6 of 6"),
        (
            V2,
            "5\n1 0",
            "4\n1 0",
            "line 14: found `5 1 1 1`; expected $EndNodes; the count at the start of the section may be wrong",
        ),
        (
            V2,
            "1 4 2 1 1 1 2 3 4",
            "1 4 2 1 1 1 2 3",
            "line 18: found the end of the line; expected a node of element 1 of 2",
        ),
        (V2, "1 4 2 1 1 1 2 3 4", "1 4 2 1 1 1 2 3 4 5", "line 18: found `5`; expected the end of element 1 of 2"),
        (
            V2,
            "1 4 2 1 1 1 2 3 4",
            "1 4 99 1 1 1 2 3 4",
            "line 18: found the end of the line; expected a tag of element 1 of 2",
        ),
        (V2, "3 1 \"body\"", "3 1 body", "line 6: found `body`; expected a name in double quotes in physical name"),
        (V2, "3 1 \"body\"", "5 1 \"body\"", "line 6: found dimension 5; expected 0 to 3 in physical name"),
        (V2, "3 1 \"body\"", "1 \"body\"", "line 6: found a physical name without a dimension (MSH 2.0)"),
        (V2, "$EndNodes", "$EndNode", "line 15: found `$EndNode`; expected $EndNodes"),
        (V2, "$Nodes", "$Knoten", "the file ends here; expected $EndKnoten; it is cut off"),
        (V4, "1 5 1 5", "1 6 1 5", "line 9: the section announces 6 nodes, its blocks hold 5"),
        (V4, "1 5 1 5", "2 5 1 5", "line 21: found `$EndNodes`; expected a block of nodes"),
        (V4, "3 1 0 5", "4 1 0 5", "line 10: found nodes on an entity of dimension 4; expected 0 to 3"),
        (V4, "3 1 0 5", "3 1 2 5", "line 10: found parametric = 2; expected 0 or 1"),
        (V4, "3 1 0 5", "3 1 0 99999999999999999999", "line 10: found `99999999999999999999`; expected the count"),
        (V4, "0 1 0\n", "0 1 0 3\n", "line 18: found `3`; expected the end of node coordinates 3 of 5"),
        (
            V4,
            "3 1 4 2",
            "2 1 4 2",
            "line 24: found a block of tetrahedra on an entity of dimension 2; expected dimension 3",
        ),
        (V4, "1 2 1 2", "1 3 1 2", "line 23: the section announces 3 elements, its blocks hold 2"),
        (V4, "0 0 0 1\n1", "0 0 0 2\n1", "line 7: found `$EndEntities`; expected an entity"),
        (
            V4,
            "0 0 0 1 1 1 1 7 0",
            "0 0 0 1 1 1 2 7 0",
            "line 6: found the end of the line; expected the number of bounding",
        ),
    ] {
        let message = with(text, from, to);
        assert!(message.contains(expected), "{to:?} gave {message:?}");
    }
}

#[test]
fn tags_that_do_not_fit_together_are_named() {
    for (text, from, to, expected) in [
        (V2, "2 1 0 0\n", "1 1 0 0\n", "line 11: node tag 1 occurs twice; expected each once"),
        (
            V2,
            "2 1 0 0\n",
            "1000000007 1 0 0\n",
            "line 18: element 1 (tetrahedron) names node 2, which $Nodes does not list",
        ),
        (V2, "2 4 2 1 1 2 3 4 5", "2 4 2 1 1 2 3 4 77", "line 19: element 2 (tetrahedron) names node 77"),
        (V2, "2 4 2 1 1 2 3 4 5", "1 4 2 1 1 2 3 4 5", "line 19: element tag 1 occurs twice with different nodes"),
        (V4, "\n2\n3\n", "\n3\n3\n", "line 13: node tag 3 occurs twice; expected each once"),
        (V4, "2 2 3 4 5", "1 2 3 4 5", "line 26: element tag 1 occurs twice with different nodes"),
        (
            V4,
            "2 2 3 4 5",
            "2 2 3 4 18446744073709551615",
            "line 26: element 2 (tetrahedron) names node 18446744073709551615",
        ),
        (V4, "0 0 0 1\n1", "0 0 0 2\n1 0 0 0 1 1 1 0 0\n1", "line 7: entity 1 of dimension 3 is listed twice"),
    ] {
        let message = with(text, from, to);
        assert!(message.contains(expected), "{to:?} gave {message:?}");
    }
    let twice = V2.replacen("$Elements", "$Nodes\n0\n$EndNodes\n$Elements", 1);
    assert_eq!(message(twice.as_bytes()), "line 16: section $Nodes occurs twice; expected one");
    let names = V2.replacen("1\n3 1 \"body\"", "2\n3 1 \"body\"\n3 1 \"core\"", 1);
    let expected = "line 7: physical tag 1 of dimension 3 is named \"body\" and \"core\"; expected one name";
    assert_eq!(message(names.as_bytes()), expected);
}

#[test]
fn elements_that_fractum_does_not_know_are_refused_by_name() {
    for (code, name) in [(34, "34 (polygon)"), (35, "35 (polyhedron)"), (999, "999"), (0, "0"), (-4, "-4")] {
        let message = with(V2, "2 4 2 1 1 2 3 4 5", &format!("2 {code} 2 1 1 2 3 4 5"));
        let expected = format!("line 19: found element type {name}; expected points, lines, triangles");
        assert!(message.contains(&expected), "{message}");
    }
    let no_elements = with(V2, "2\n1 4 2 1 1 1 2 3 4\n2 4 2 1 1 2 3 4 5\n", "0\n");
    assert!(no_elements.contains("expected at least one element; mesh the model before saving it"), "{no_elements}");
}

#[test]
fn flat_elements_are_named_with_tag_nodes_and_place() {
    let message = with(V2, "5 1 1 1\n", "5 1 -1 1\n"); // in the plane of 2, 3, 4: x + y + z = 1
    assert!(message.starts_with("line 19: element 2 (nodes [2, 3, 4, 5]) at 5e-1 0e0 5e-1 has no volume"), "{message}");
    let message = with(V2, "2 4 2 1 1 2 3 4 5", "2 4 2 1 1 2 3 4 4");
    assert!(message.starts_with("line 19: element 2 (nodes [2, 3, 4, 4])"), "{message}");
    for (element, expected) in
        [("2 2 2 1 1 1 2 2", "triangle 2 (nodes [1, 2, 2])"), ("2 1 2 1 1 3 3", "line 2 (nodes [3, 3])")]
    {
        let message = with(V2, "2 4 2 1 1 2 3 4 5", element);
        assert!(message.starts_with(&format!("line 19: {expected}")), "{message}");
        assert!(message.ends_with("mesh again or remove it"), "{message}");
    }
    for (element, expected) in [
        ("2 3 2 1 1 1 2 2 1", "quadrilateral 2 (nodes [1, 2, 2, 1])"),
        ("2 3 2 1 1 1 2 5 5", "quadrilateral 2"),
        ("2 7 2 1 1 1 2 3 4 3", "pyramid 2 (nodes [1, 2, 3, 4, 3])"),
        ("2 6 2 1 1 1 2 3 4 2 3", "prism 2 (nodes [1, 2, 3, 4, 2, 3])"),
    ] {
        let said = message_or_ok(V2.replacen("2 4 2 1 1 2 3 4 5", element, 1).as_bytes());
        match said {
            Ok(mesh) => assert!(!mesh.notices.is_empty(), "{element}: corners in one node make it a simpler one"),
            Err(said) => {
                assert!(said.starts_with(&format!("line 19: {expected}")) && said.contains("is flat, or"), "{said}")
            }
        }
    }
    let large = V2.replace(" 1 ", " 1e200 ").replace(" 1\n", " 1e200\n");
    assert!(message_or_ok(large.as_bytes()).is_err()); // a volume beyond the range of numbers
}

fn message_or_ok(bytes: &[u8]) -> Result<Mesh, String> {
    read_msh(bytes).map_err(|error| error.to_string())
}

#[test]
fn flatness_is_judged_by_the_size_of_the_element() {
    for scale in [1e-30, 1e-6, 1e30] {
        let scaled = |text: &str| text.replace('\u{1}', &format!("{scale:e}"));
        let base = V2
            .replace("2 1 0 0\n", "2 \u{1} 0 0\n")
            .replace("3 0 1 0\n", "3 0 \u{1} 0\n")
            .replace("4 0 0 1\n", "4 0 0 \u{1}\n")
            .replace("5 1 1 1\n", "5 \u{1} \u{1} \u{1}\n");
        assert!(message_or_ok(scaled(&base).as_bytes()).is_ok(), "{scale}");
    }
    let sliver = |height: f64| V2.replace("4 0 0 1\n", &format!("4 0 0 {height:e}\n"));
    assert!(message_or_ok(sliver(1e-10).as_bytes()).is_ok());
    assert!(message_or_ok(sliver(1e-13).as_bytes()).is_err());
}

#[test]
fn negative_volumes_are_flipped_and_counted() {
    let mesh = read_msh(V2.replace("1 1 2 3 4\n", "1 2 1 3 4\n").as_bytes()).unwrap();
    assert_eq!(mesh.tetrahedra[0], [1, 0, 3, 2]);
    assert_eq!(mesh.notices, ["1 tetrahedra of negative volume were flipped (two nodes exchanged)"]);
}

/// A small binary file and its layout.
fn binary(format: MshFormat) -> Vec<u8> {
    let mesh = structured_box([1, 1, 1], Vec3::new(1.0, 1.0, 1.0), None);
    let mut bytes = Vec::new();
    write_msh(&mesh, format, &mut bytes).unwrap();
    bytes
}

fn find(bytes: &[u8], text: &str) -> usize {
    bytes.windows(text.len()).position(|window| window == text.as_bytes()).unwrap()
}

fn patched(bytes: &[u8], at: usize, patch: &[u8]) -> String {
    let mut bytes = bytes.to_vec();
    bytes[at..at + patch.len()].copy_from_slice(patch);
    message(&bytes)
}

#[test]
fn binary_files_are_refused_with_the_byte() {
    let file = binary(MshFormat::V4_1Binary);
    assert_eq!(
        patched(&file, 18, b"7"),
        "byte 12: found data size 7; expected 4 or 8 bytes".replace("byte 12", "line 2")
    );
    let one = 20;
    assert!(patched(&file, one, &[13, 10, 0, 0]).ends_with("was the file transferred as text?"));
    let nodes = find(&file, "$Nodes\n") + 7;
    for (offset, patch, expected) in [
        (8, u64::MAX.to_le_bytes(), format!("byte {nodes}: the section announces {} nodes", u64::MAX)),
        (0, u64::MAX.to_le_bytes(), "found nodes on an entity of dimension".to_owned()),
        (44, (1u64 << 61).to_le_bytes(), format!("byte {}: the file ends here; expected node tag of", nodes + 52)),
        (44, (1u64 << 40).to_le_bytes(), "announced".to_owned()),
        (52, 2u64.to_le_bytes(), format!("byte {}: node tag 2 occurs twice", nodes + 60)),
        (52 + 8 * 8, f64::NAN.to_le_bytes(), format!("byte {}: found coordinates NaN 0 0", nodes + 52 + 64)),
        (52 + 9 * 8, f64::INFINITY.to_le_bytes(), "found coordinates 0 inf 0; expected finite numbers".to_owned()),
    ] {
        let message = patched(&file, nodes + offset, &patch);
        assert!(message.starts_with("byte ") && message.contains(&expected), "{message}");
    }
    let elements = find(&file, "$Elements\n") + 10;
    for (offset, patch, expected) in [
        (8, u64::MAX.to_le_bytes(), "the section announces"),
        (44, (u64::MAX / 2).to_le_bytes(), "expected element of 9223372036854775807 announced"),
        (40, [231, 3, 0, 0, 2, 0, 0, 0], "found element type 999"),
        (60, 4711u64.to_le_bytes(), "element 1 (triangle) names node 4711, which $Nodes does not list"),
    ] {
        let message = patched(&file, elements + offset, &patch);
        assert!(message.starts_with("byte ") && message.contains(expected), "{message}");
    }
    let entities = find(&file, "$Entities\n") + 10;
    let message = patched(&file, entities + 24, &u64::MAX.to_le_bytes());
    assert!(message.contains("the file ends here; expected a"), "{message}");

    let file = binary(MshFormat::V2_2Binary);
    let elements = find(&file, "$Elements\n") + 13;
    for (offset, patch, expected) in [
        (4, (-3i32).to_le_bytes(), "found a block of -3 elements; expected 1 to 18"),
        (4, i32::MAX.to_le_bytes(), "found a block of 2147483647 elements"),
        (8, (-1i32).to_le_bytes(), "found -1 tags per element; expected at least 0"),
        (8, i32::MAX.to_le_bytes(), "the file ends here; expected element of 12 announced"),
        (12, (-1i32).to_le_bytes(), "found element tag -1; expected at least 0"),
        (24, (-9i32).to_le_bytes(), "found node tag -9; expected at least 0"),
    ] {
        let message = patched(&file, elements + offset, &patch);
        assert!(message.starts_with("byte ") && message.contains(expected), "{message}");
    }
    assert_eq!(patched(&file, 18, b"4"), "line 2: found data size 4; expected 8 bytes");
}

#[test]
fn a_mark_of_the_other_byte_order_turns_all_numbers() {
    let mut file = binary(MshFormat::V4_1Binary);
    file[20..24].reverse();
    let message = message(&file);
    assert!(message.starts_with("byte ") && message.contains("the file ends here"), "{message}");
}

#[test]
fn memberships_beyond_reason_are_refused_before_they_take_memory() {
    let groups = 20_000;
    let list: String = (1..=groups).map(|tag| format!("{tag} ")).collect();
    let points: String = (1..=20_000).map(|tag| format!("{tag} 1\n")).collect();
    let file = format!(
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n1 0 0 0\n1 0 0 0 {groups} {list}\n$EndEntities\n\
         $Nodes\n1 1 1 1\n0 1 0 1\n1\n0 0 0\n$EndNodes\n$Elements\n1 20000 1 20000\n0 1 15 20000\n{points}$EndElements\n"
    );
    let message = message(file.as_bytes());
    assert!(message.contains("element 1 lies in 20000 physical groups; fractum reads up to 64"), "{message}");
}

#[test]
fn the_writer_refuses_what_the_format_cannot_hold() {
    let mesh = structured_box([1, 1, 1], Vec3::new(1.0, 1.0, 1.0), None);
    let refused = |change: fn(&mut Mesh), format: MshFormat| {
        let mut mesh = mesh.clone();
        change(&mut mesh);
        let error = write_msh(&mesh, format, &mut Vec::new()).expect_err("should be refused");
        assert_eq!(error.kind(), std::io::ErrorKind::InvalidInput);
        error.to_string()
    };
    let v4 = MshFormat::V4_1Ascii;
    assert!(refused(|mesh| mesh.groups[0].name = "a \"b\"".to_owned(), v4).contains("holds a quote"));
    assert!(refused(|mesh| mesh.groups[0].tag = 0, v4).contains("has tag 0"));
    assert!(refused(|mesh| mesh.groups[1].tag = 1, v4).contains("have the same tag 1"));
    assert!(refused(|mesh| mesh.groups[0].triangles.push(99), v4).contains("names element 99 of 12"));
    assert!(refused(|mesh| mesh.groups[0].tetrahedra.push(0), v4).contains("has elements of dimension 3"));
    assert!(refused(|mesh| mesh.triangle_tags.truncate(3), v4).contains("12 elements of Gmsh type 2 have 3 tags"));
    assert!(refused(|mesh| mesh.node_tags.truncate(3), v4).contains("8 nodes have 3 tags"));
    assert!(refused(|mesh| mesh.tetrahedra[2][1] = 8, v4).contains("names node 8 of 8"));
    let far = |mesh: &mut Mesh| mesh.node_tags[3] = 1 << 31;
    assert!(refused(far, MshFormat::V2_2Ascii).contains("does not fit into the 32 bits of MSH 2.2"));
}

#[test]
fn a_flood_of_groups_is_refused() {
    let count = 70_000;
    let points: String = (1..=count).map(|tag| format!("{tag} 15 1 {tag} 1\n")).collect();
    let names: String = (1..=count).map(|tag| format!("0 {tag} \"\"\n")).collect();
    let file = |names: &str, elements: &str| {
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{}\n{names}$EndPhysicalNames\n\
             $Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n{}\n{elements}$EndElements\n",
            names.lines().count(),
            elements.lines().count()
        )
    };
    let expected = "found more than 65536 physical groups; give parts that act alike one group";
    assert_eq!(message(file("", &points).as_bytes()), format!("line {}: {expected}", 12 + 65_537));
    assert_eq!(message(file(&names, "1 15 0 1\n").as_bytes()), format!("line {}: {expected}", 5 + 65_537));
}
