//! Abaqus input files as programs write them, and those that are refused.

use fractum_mesh::{Mesh, Vec3, read_inp, read_mesh};

fn bytes_of(name: &str) -> Vec<u8> {
    let path = format!("{}/tests/data/{name}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Positions of the nodes of a group, in a fixed order.
fn places(mesh: &Mesh, group: &str) -> Vec<[i64; 3]> {
    let place = |x: &Vec3| [x.x, x.y, x.z].map(|x| (1e6 * x).round() as i64);
    let mut places: Vec<_> = mesh.group_nodes(group).iter().map(|&node| place(&mesh.nodes[node as usize])).collect();
    places.sort_unstable();
    places
}

#[test]
fn a_file_of_gmsh_has_the_groups_of_its_mesh() {
    let [inp, msh] = ["box.inp", "box-inp.msh"].map(|name| read_mesh(&bytes_of(name)).unwrap());
    assert_eq!((inp.tetrahedra.len(), inp.nodes.len()), (msh.tetrahedra.len(), msh.nodes.len()));
    // Gmsh writes no blanks into names of sets.
    for (of_inp, of_msh) in [("part", "part"), ("left", "left"), ("right_side", "right side")] {
        let count = |mesh: &Mesh, name: &str| {
            mesh.group(name).iter().map(|group| (group.dimension, group.element_count())).collect::<Vec<_>>()
        };
        assert_eq!(count(&inp, of_inp), count(&msh, of_msh), "{of_inp}");
        assert_eq!(places(&inp, of_inp), places(&msh, of_msh), "{of_inp}");
        // The set of nodes of the same name, under a name of its own.
        assert_eq!(places(&inp, &format!("{of_inp}-nodes")), places(&msh, of_msh), "{of_inp}");
    }
    assert!(inp.notices.iter().any(|notice| notice.contains("called \"left-nodes\"")), "{:?}", inp.notices);
}

#[test]
fn a_part_with_its_instance_has_sets_and_surfaces() {
    let mesh = read_inp(&bytes_of("part.inp")).unwrap();
    assert_eq!((mesh.nodes.len(), mesh.tetrahedra.len(), mesh.tetrahedron_tags.as_slice()), (5, 2, &[1, 7][..]));
    assert_eq!(mesh.group_names(), ["Set-1-nodes", "Fixed end", "Surf-1", "Set-1", "whole"]);
    for name in ["Set-1", "whole"] {
        assert_eq!(mesh.group(name)[0].tetrahedra, [0, 1], "{name}");
    }
    // Face 3 of 2 3 4 5 is 3 5 4; face 1 of 1 2 3 4 is 1 2 3.
    let facets: Vec<[u64; 3]> = mesh.group("Surf-1")[0]
        .triangles
        .iter()
        .map(|&facet| {
            let mut nodes = mesh.triangles[facet as usize].map(|node| mesh.node_tags[node as usize]);
            nodes.sort_unstable();
            nodes
        })
        .collect();
    assert_eq!(facets, [[3, 4, 5], [1, 2, 3]]);
    assert_eq!(places(&mesh, "Fixed end"), [[0, 0, 0], [0, 0, 1_000_000], [0, 1_000_000, 0]]);
    assert_eq!(mesh.nodes[4], Vec3::new(1.0, 1.0, 1.0));
}

#[test]
fn plane_elements_have_edges_and_lose_their_mid_nodes() {
    let mesh = read_inp(&bytes_of("plane.inp")).unwrap();
    assert_eq!((mesh.triangles.len(), mesh.group("plate")[0].triangles.len()), (2, 2));
    assert_eq!(places(&mesh, "top"), [[0, 2_000_000, 0], [2_000_000, 2_000_000, 0]]);
    assert_eq!(mesh.group("top")[0].lines.len(), 1);
    assert_eq!(mesh.group_nodes("base").len(), 2, "mid nodes leave with their elements' order");
    assert_eq!(mesh.nodes.len(), 4);
    for said in [
        "5 mid node(s) left out of sets of nodes",
        "1 of type SPRINGA",
        "2 triangles of higher order",
        "clockwise",
        "\"springs\"",
    ] {
        assert!(mesh.notices.iter().any(|notice| notice.contains(said)), "{said}: {:?}", mesh.notices);
    }
}

#[test]
fn labels_that_nothing_bears_are_told_with_what_lists_them() {
    let flat = "*NODE\n1,0,0\n2,1,0\n3,0,1\n*ELEMENT, TYPE=CPS3\n1,1,2,3\n";
    let sets = "*ELSET, ELSET=e\n1, 8, 9\n*NSET, NSET=n\n1, 7\n*NSET, NSET=range, GENERATE\n1, 9, 1\n";
    let mesh = read_inp(format!("{flat}{sets}*SURFACE, NAME=s\n1, S1\n5, S1\n").as_bytes()).unwrap();
    for said in [
        "set \"e\" lists element 8 and 1 more, which the mesh does not have",
        "set \"n\" lists node 7, which the mesh does not have",
        "surface \"s\" lists element 5, which the mesh does not have",
    ] {
        assert!(mesh.notices.iter().any(|notice| notice == said), "{said}: {:?}", mesh.notices);
    }
    assert!(!mesh.notices.iter().any(|notice| notice.contains("range")), "{:?}", mesh.notices);
    assert_eq!(mesh.group("s")[0].lines.len(), 1);
}

#[test]
fn what_cannot_be_used_is_refused_with_its_line_and_the_remedy() {
    let flat = "*NODE\n1,0,0\n2,1,0\n3,0,1\n";
    let triangle = "*ELEMENT, TYPE=S3\n1,1,2,3\n";
    let after = |more: &str| format!("{flat}{triangle}{more}");
    let cases = [
        ("*HEADING\nnothing\n".to_owned(), "line 3: the file has no elements; expected at least one *ELEMENT"),
        (
            format!("{flat}*ELEMENT, TYPE=MASS\n1,1\n"),
            "line 7: all elements are of types that are no bodies (MASS); expected at least one *ELEMENT",
        ),
        (after("*NGEN, NSET=n\n"), "line 7: *NGEN gives nodes or elements by a rule; write them out"),
        (format!("{flat}*ELEMENT\n1,1,2,3\n"), "line 5: found *ELEMENT without TYPE; expected TYPE=NAME on that line"),
        (
            format!("{flat}*ELEMENT, TYPE=S3\n1,1,2\n"),
            "line 6: found `1, 1, 2`; expected an element of type S3: label and 3 nodes",
        ),
        (
            format!("{flat}*ELEMENT, TYPE=S3\n1,1,2,9\n"),
            "line 6: element 1 names node 9, which the file does not define",
        ),
        (format!("{flat}*ELEMENT, TYPE=S3\n1,1,2,x\n"), "line 6: found `1, 1, 2, x`"),
        ("*NODE\n1,0,zero\n".to_owned(), "line 2: found `1, 0, zero`; expected a node"),
        ("*NODE, SYSTEM=C\n".to_owned(), "line 1: *NODE gives coordinates about an axis"),
        (
            after("*ELSET, ELSET=a\nb\n"),
            "line 8: found `b` in set \"a\"; expected a label, or the name of a set that is defined above",
        ),
        (after("*ELSET, ELSET=a, GENERATE\n1\n"), "line 8: found `1`; expected first, last and step"),
        (after("*SURFACE, NAME=s\n1, S6\n"), "line 7: surface \"s\" takes face `S6` of element 1, a triangle"),
        (
            after("*INSTANCE, NAME=a\n1, 0, y\n"),
            "line 8: found `1, 0, y`; expected three numbers that move an instance",
        ),
        (
            after("*INSTANCE, NAME=a\n0, 0, 0\n0,0,0, 0,0,0, 90\n"),
            "line 9: found `0, 0, 0, 0, 0, 0, 90`; expected three",
        ),
        (after("*INCLUDE, INPUT=nodes.inp\n"), "line 7: *INCLUDE gives a further file; put its lines here"),
        (format!("\u{feff}{flat}{triangle}"), ""),
        (format!("{flat}*ELEMENT, TYPE=S3,\n** corners\nELSET=e\n1,1,2,3\n*ELSET, ELSET=f\ne\n"), ""),
        (after("*END PART,\n*ELSET, ELSET=a\nb\n"), "line 9: found `b` in set \"a\""),
        (after("*ELEMENT, TYPE=S3\n1,2,3,1\n2,1,2,3\n1,3,2,1\n"), ""),
        // An independent instance has its mesh in the assembly.
        (
            format!(
                "*PART, NAME=p\n*END PART\n*ASSEMBLY, NAME=a\n*INSTANCE, NAME=i, PART=p\n{flat}{triangle}*END INSTANCE\n"
            ),
            "",
        ),
        // A reference point has a label of the assembly.
        (after("*ASSEMBLY, NAME=a\n*INSTANCE, NAME=i, PART=p\n*END INSTANCE\n*NODE\n1, 0, 0\n"), ""),
        (after("*NSET, NSET=_Picked, INTERNAL\n1\n*ASSEMBLY, NAME=a\n*NSET, NSET=_Picked, INTERNAL\n2\n"), ""),
    ];
    for (text, says) in cases {
        match read_mesh(text.as_bytes()) {
            Ok(_) => assert_eq!(says, "", "{text}"),
            Err(error) => assert!(!says.is_empty() && error.to_string().starts_with(says), "{error}\n{text}"),
        }
    }
}

#[test]
fn beams_of_second_order_go_from_end_to_end() {
    let text = "*NODE\n1,0,0\n2,2,0\n3,1,0\n4,0,1\n*ELEMENT, TYPE=B32\n1,1,3,2\n*ELEMENT, TYPE=CPS3\n2,1,2,4\n";
    let mesh = read_inp(text.as_bytes()).unwrap();
    assert_eq!((mesh.lines.as_slice(), mesh.nodes.len()), (&[[0, 1]][..], 3));
}

#[test]
fn sets_that_multiply_are_refused() {
    let mut text = "*NODE\n1,0,0\n2,1,0\n3,0,1\n*ELEMENT, TYPE=S3\n1,1,2,3\n*NSET, NSET=s0\n1,2,3\n".to_owned();
    for set in 1..100 {
        text += &format!("*NSET, NSET=s{set}\ns{}, s{}\n", set - 1, set - 1);
    }
    let error = read_inp(text.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("have more than 192 members in all"), "{error}");
}

#[test]
fn a_file_that_is_cut_at_its_end_is_told() {
    let whole = "*NODE\n1,0,0\n2,1,0\n3,0,1\n4,1,1\n*ELEMENT, TYPE=CPS3, ELSET=part\n1,1,2,3\n2,2,4,3\n";
    let told = |text: &str| {
        let notices = read_inp(text.as_bytes()).unwrap().notices;
        notices.into_iter().find(|notice| notice.contains("may have been cut")).unwrap_or_default()
    };
    let with_step = format!("{whole}*STEP\n*STATIC\n*END STEP\n");
    let in_part = format!(
        "*PART, NAME=p\n{whole}*END PART\n*ASSEMBLY, NAME=a\n*INSTANCE, NAME=i, PART=p\n*END INSTANCE\n*END ASSEMBLY"
    );
    for complete in [whole, &with_step, &in_part] {
        assert_eq!(told(complete), "", "{complete}");
    }
    // Within a line of an element whose last number is shorter than it was, between two elements, and within a step, a part and an assembly.
    let cuts = [
        (whole.trim_end().to_owned(), "ends with a line of *ELEMENT without a line break"),
        (whole.replace("2,2,4,3\n", ""), "ends with elements, and 1 node(s) have none"),
        (with_step.replace("*END STEP\n", ""), "*STEP has no *END STEP"),
        (in_part.split("*END PART").next().unwrap().to_owned(), "*PART has no *END PART"),
        (
            in_part.split("*END INSTANCE").next().unwrap().to_owned(),
            "*ASSEMBLY has no *END ASSEMBLY, *INSTANCE has no *END INSTANCE",
        ),
    ];
    for (text, says) in cuts {
        assert!(told(&text).ends_with(says), "{:?}: {text}", told(&text));
    }
}
