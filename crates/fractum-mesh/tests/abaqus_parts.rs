//! Abaqus input files in several files, and of several parts.

use std::collections::BTreeMap;

use fractum_mesh::{Gathered, Mesh, Vec3, quality, read_inp};

const CUBE: &str = "*NODE, NSET=all\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n7, 1, 1, 1\n8, 0, 1, 1\n\
                    *ELEMENT, TYPE=C3D8, ELSET=solid\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*SURFACE, NAME=top\n1, S2\n";

fn gather(main: &str, files: &[(&str, &str)]) -> Result<Mesh, String> {
    let files: BTreeMap<&str, &str> = files.iter().copied().collect();
    let read = |name: &str| files.get(name).map(|text| text.as_bytes().to_vec()).ok_or("no such file".to_owned());
    let gathered = Gathered::new(main.as_bytes().to_vec(), read).map_err(|error| error.to_string())?;
    gathered.read().map_err(|error| error.to_string())
}

fn center(mesh: &Mesh, group: &str) -> [f64; 3] {
    let nodes = mesh.group_nodes(group);
    let sum = nodes.iter().map(|&node| mesh.nodes[node as usize]).sum::<Vec3>() / nodes.len() as f64;
    [sum.x, sum.y, sum.z].map(|x| (1e9 * x).round() / 1e9)
}

#[test]
fn further_files_stand_where_they_are_named() {
    let (nodes, rest) = CUBE.split_at(CUBE.find("*ELEMENT").unwrap());
    let data = nodes.split_once('\n').unwrap().1;
    let whole = read_inp(CUBE.as_bytes()).unwrap();
    let main = format!("*HEADING\n*Include, input=\"mesh/nodes.inp\"\n{rest}");
    assert_eq!(gather(&main, &[("mesh/nodes.inp", nodes)]).unwrap(), whole);
    // A keyword may have its data in a file, which may name others.
    let main = "*NODE, NSET=all, INPUT=nodes.txt\n*INCLUDE,\nINPUT=rest.inp";
    let files = [("nodes.txt", data.trim_end()), ("rest.inp", "*INCLUDE, INPUT=more.inp\n"), ("more.inp", rest)];
    assert_eq!(gather(main, &files).unwrap(), whole);
}

#[test]
fn errors_tell_the_file_and_its_line() {
    let (nodes, rest) = CUBE.split_at(CUBE.find("*ELEMENT").unwrap());
    let main = format!("*INCLUDE, INPUT=nodes.inp\n{rest}*NSET, NSET=a\nb\n");
    let wrong = nodes.replace("3, 1, 1, 0", "3, 1, one, 0");
    let error = gather(&main, &[("nodes.inp", &wrong)]).unwrap_err();
    assert!(error.starts_with("line 4 of nodes.inp: found `3, 1, one, 0`"), "{error}");
    let error = gather(&main, &[("nodes.inp", nodes)]).unwrap_err();
    assert!(error.starts_with("line 7: found `b` in set \"a\""), "{error}");
    // What is not there is told, as a notice where the mesh is whole without it.
    let mesh = gather(&format!("{CUBE}*INCLUDE, INPUT=steps.inp\n"), &[]).unwrap();
    let said = "line 14: *INCLUDE names \"steps.inp\", which cannot be read (no such file): read without it";
    assert!(mesh.notices.iter().any(|notice| notice == said), "{:?}", mesh.notices);
    let error = gather(&main.replace("*NSET, NSET=a\nb\n", ""), &[]).unwrap_err();
    let says =
        ["element 1 names node 1", "line 1: *INCLUDE names \"nodes.inp\", which cannot be read", "put these files in"];
    assert!(says.iter().all(|says| error.contains(says)), "{error}");
    let error = gather(&main, &[("nodes.inp", "version https://git-lfs.github.com/spec/v1\n")]).unwrap_err();
    assert!(error.contains("it is a pointer of Git LFS") && error.contains("git lfs pull"), "{error}");
    let error = gather("*INCLUDE, INPUT=main.inp\n", &[("main.inp", "*INCLUDE, INPUT=main.inp\n")]).unwrap_err();
    assert!(error.starts_with("line 1 of main.inp: ") && error.ends_with("does it name itself?"), "{error}");
    assert!(gather("*INCLUDE\n", &[]).unwrap_err().starts_with("line 1: *INCLUDE names no file; expected INPUT=FILE"));
}

#[test]
fn instances_are_moved_and_turned_and_have_sets_of_their_own() {
    let text = format!(
        "*PART, NAME=block\n{CUBE}*END PART\n*PART, NAME=other\n{CUBE}*END PART\n*ASSEMBLY, NAME=a\n\
         *INSTANCE, NAME=low, PART=block\n*END INSTANCE\n\
         *INSTANCE, NAME=high, PART=Block\n0, 0, 2\n*END INSTANCE\n\
         *INSTANCE, NAME=turned, PART=other\n3, 0, 0\n3, 0, 0, 3, 0, 1, 90\n*END INSTANCE\n\
         *NODE\n1, 9, 9, 9\n*NSET, NSET=point\n1\n\
         *NSET, NSET=corner, INSTANCE=high\n7\n*NSET, NSET=corner, INSTANCE=turned\n2\n*ELSET, ELSET=pair\nlow.solid, high.1\n\
         *NSET, NSET=of, ELSET=pair\n*SURFACE, NAME=roof\nhigh.solid, S2\n*END ASSEMBLY\n"
    );
    let mesh = read_inp(text.as_bytes()).unwrap();
    assert_eq!((mesh.nodes.len(), mesh.tetrahedra.len()), (25, 18));
    for (group, at) in [
        ("low", [0.5, 0.5, 0.5]),
        ("high", [0.5, 0.5, 2.5]),
        // A quarter turn about the axis through (3, 0) takes the cube from x = 3 to 4 to x = 2 to 3.
        ("turned", [2.5, 0.5, 0.5]),
        ("turned.solid", [2.5, 0.5, 0.5]),
        ("high.top", [0.5, 0.5, 3.0]),
        ("roof", [0.5, 0.5, 3.0]),
        ("pair", [0.5, 0.5, 1.5]),
        ("of", [0.5, 0.5, 1.5]),
        ("point", [9.0, 9.0, 9.0]),
        ("corner", [2.0, 1.0, 1.5]),
    ] {
        assert_eq!(center(&mesh, group), at, "{group}");
    }
    let volume: f64 = mesh.tetrahedra.iter().map(|e| quality::signed_volume(e.map(|n| mesh.nodes[n as usize]))).sum();
    assert!((volume - 3.0).abs() < 1e-12);
    // One instance alone keeps the labels and names of its part.
    let one = format!(
        "*PART, NAME=p\n{CUBE}*END PART\n*ASSEMBLY, NAME=a\n*INSTANCE, NAME=i, PART=p\n*END INSTANCE\n*END ASSEMBLY\n"
    );
    let (one, flat) = (read_inp(one.as_bytes()).unwrap(), read_inp(CUBE.as_bytes()).unwrap());
    assert_eq!(one, flat);
    assert_eq!(read_inp(format!("*PART, NAME=p\n{CUBE}*END PART\n").as_bytes()).unwrap(), flat);
}

#[test]
fn a_node_that_is_defined_again_has_its_last_place() {
    let mesh = read_inp(format!("{CUBE}*NODE\n7, 1, 1, 2\n").as_bytes()).unwrap();
    assert_eq!((mesh.nodes.len(), mesh.bounding_box().1.z), (8, 2.0));
    assert!(mesh.notices.iter().any(|notice| notice.starts_with("1 node(s) are defined again")), "{:?}", mesh.notices);
}
