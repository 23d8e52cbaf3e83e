//! Meshes of other programs: what is read, written, refused and told.

use std::fmt::Write;
use std::fs;

use crate::common::{BREAKING_BAR, Workplace, bar};
use fractum_mesh::{Mesh, read_msh};

/// A mesh as an Abaqus input file, its groups as sets of elements.
fn abaqus(mesh: &Mesh) -> String {
    let mut text = String::from("*HEADING\nbar\n*NODE\n");
    for (tag, x) in mesh.node_tags.iter().zip(&mesh.nodes) {
        let _ = writeln!(text, "{tag}, {:?}, {:?}, {:?}", x.x, x.y, x.z);
    }
    let nodes = |element: &[u32]| {
        element.iter().map(|&node| mesh.node_tags[node as usize].to_string()).collect::<Vec<_>>().join(", ")
    };
    text += "*ELEMENT, TYPE=S3\n";
    for (tag, element) in mesh.triangle_tags.iter().zip(&mesh.triangles) {
        let _ = writeln!(text, "{tag}, {}", nodes(element));
    }
    text += "*ELEMENT, TYPE=C3D4\n";
    for (tag, element) in mesh.tetrahedron_tags.iter().zip(&mesh.tetrahedra) {
        let _ = writeln!(text, "{tag}, {}", nodes(element));
    }
    for group in &mesh.groups {
        let _ = writeln!(text, "*ELSET, ELSET=\"{}\"", group.name);
        let of_triangles = group.triangles.iter().map(|&index| mesh.triangle_tags[index as usize]);
        let of_tetrahedra = group.tetrahedra.iter().map(|&index| mesh.tetrahedron_tags[index as usize]);
        of_triangles.chain(of_tetrahedra).for_each(|tag| {
            let _ = writeln!(text, "{tag},");
        });
    }
    text
}

#[test]
fn a_case_on_an_abaqus_file_has_the_bits_of_that_on_a_gmsh_file() {
    let workplace = Workplace::new(BREAKING_BAR);
    fs::write(workplace.path("bar.inp"), abaqus(&bar())).unwrap();
    fs::write(workplace.path("abaqus.toml"), BREAKING_BAR.replace("bar.msh", "bar.inp")).unwrap();
    let hash = |case: &str| {
        let ended = workplace.fractum(&["run", case, "-o", case.trim_end_matches(".toml"), "--quiet"]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        let summary = fs::read(workplace.path(case.trim_end_matches(".toml")).join("summary.json")).unwrap();
        serde_json::from_slice::<serde_json::Value>(&summary).unwrap()["state_hash"].clone()
    };
    assert_eq!(hash("abaqus.toml"), hash("case.toml"));
}

#[test]
fn a_mesh_in_parts_is_told_of_and_converted_as_one() {
    let workplace = Workplace::new(BREAKING_BAR);
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../meshes/charge/parts.msh");
    let told = workplace.fractum(&["mesh", "info", file, "--parts", "3"]);
    assert!(
        told.code == Some(0) && told.stdout.contains("\"core\" (dimension 3, tag 1): 9409 elements"),
        "{}{}",
        told.stdout,
        told.stderr
    );
    let ended = workplace.fractum(&["mesh", "convert", file, "one.msh", "--parts", "3"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let mesh = read_msh(&fs::read(workplace.path("one.msh")).unwrap()).unwrap();
    assert_eq!((mesh.tetrahedra.len(), mesh.group("core").len()), (16640, 1));
    let wrong = workplace.fractum(&["mesh", "info", file, "--parts", "4"]);
    assert!(wrong.code == Some(1) && wrong.stderr.contains("parts_4.msh: cannot read the mesh"), "{}", wrong.stderr);
}

#[test]
fn the_ending_of_the_output_is_its_format() {
    let workplace = Workplace::new(BREAKING_BAR);
    fs::write(workplace.path("bar.inp"), abaqus(&bar())).unwrap();
    let convert = |arguments: &[&str]| workplace.fractum(&[&["mesh", "convert"], arguments].concat());
    for output in [&["a.msh"][..], &["b.MSH", "--to", "msh22"]] {
        assert_eq!(convert(&[&["bar.inp"], output].concat()).code, Some(0));
        let mesh = read_msh(&fs::read(workplace.path(output[0])).unwrap()).unwrap();
        let known = bar();
        assert_eq!((&mesh.tetrahedra, mesh.group_names()), (&known.tetrahedra, known.group_names()));
    }
    assert_eq!(convert(&["bar.inp", "bar.vtu"]).code, Some(0));
    let vtu = fs::read(workplace.path("bar.vtu")).unwrap();
    let head = String::from_utf8_lossy(&vtu[..2000]);
    for part in ["UnstructuredGrid", "Name=\"gmsh:physical\"", "Name=\"x- (2d)\"", "Name=\"body (3d)\""] {
        assert!(head.contains(part), "{part}: {head}");
    }
    for (output, says) in [
        (&["bar.stl"][..], "bar.stl: ends in neither .msh nor .vtu"),
        (&["bar"], "bar: ends in neither .msh nor .vtu"),
        (&["b.vtu", "--to", "msh22"], "--to is for files that end in .msh"),
    ] {
        let ended = convert(&[&["bar.inp"], output].concat());
        assert!(ended.code == Some(1) && ended.stderr.contains(says), "{}", ended.stderr);
        assert!(!workplace.path(output[0]).exists());
    }
}

#[test]
fn a_mesh_comes_back_from_vtu_with_its_groups() {
    let workplace = Workplace::new(BREAKING_BAR);
    for (from, to) in [("bar.msh", "bar.vtu"), ("bar.vtu", "back.msh")] {
        let ended = workplace.fractum(&["mesh", "convert", from, to]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    }
    let known = bar();
    for file in ["bar.vtu", "back.msh"] {
        let mesh = fractum_mesh::read_mesh(&fs::read(workplace.path(file)).unwrap()).unwrap();
        assert_eq!(
            (&mesh.nodes, &mesh.triangles, &mesh.tetrahedra),
            (&known.nodes, &known.triangles, &known.tetrahedra)
        );
        assert_eq!(mesh.groups.len(), known.groups.len());
        for group in &known.groups {
            let [found] = mesh.group(&group.name)[..] else { panic!("{file}: group {}", group.name) };
            assert_eq!(
                (found.dimension, &found.triangles, &found.tetrahedra),
                (group.dimension, &group.triangles, &group.tetrahedra)
            );
        }
    }
    // A case reads it too.
    fs::write(workplace.path("grid.toml"), BREAKING_BAR.replace("bar.msh", "bar.vtu")).unwrap();
    let checked = workplace.fractum(&["check", "grid.toml"]);
    assert_eq!(checked.code, Some(0), "{}", checked.stderr);
}

#[test]
fn information_on_a_mesh_is_in_the_unit_of_the_case_and_beside_its_material() {
    let workplace = Workplace::new(BREAKING_BAR);
    let info = |more: &[&str]| {
        let ended = workplace.fractum(&[&["mesh", "info", "bar.msh"], more].concat());
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        ended.stdout
    };
    let plain = info(&[]);
    assert!(plain.contains("edges of tetrahedra: 0.04 to ") && !plain.contains("process zone"), "{plain}");
    let beside = info(&["--case", "case.toml"]);
    // 30 GPa x 100 J/m2 / (3 MPa)2; twice and a sixteenth of that.
    for part in
        ["edges of tetrahedra: 40 mm to ", "E Gf/ft\u{b2} = 333.3 mm", "below 666.7 mm", "below 25.64 mm: coarse"]
    {
        assert!(beside.contains(part), "{part}: {beside}");
    }
    let json: serde_json::Value = serde_json::from_str(&info(&["--case", "case.toml", "--format", "json"])).unwrap();
    assert!((json["process_zones"]["concrete"].as_f64().unwrap() * 3.0 - 1.0).abs() < 1e-12, "{json}");
    assert!(json["edges"]["shortest"].as_f64().unwrap() > 0.039 && json["hints"].as_array().unwrap().is_empty());
    // The same file as one in mm, and a softening whose first line is steep.
    let small = BREAKING_BAR.replace("file = \"bar.msh\"", "file = \"bar.msh\"\nunit = \"mm\"");
    let bilinear = "fracture_energy = \"100 J/m^2\"\nsoftening = \"bilinear\"";
    fs::write(workplace.path("small.toml"), small.replace("fracture_energy = \"100 J/m^2\"", bilinear)).unwrap();
    let small = info(&["--case", "small.toml"]);
    assert!(small.contains("edges of tetrahedra: 40 \u{b5}m to ") && small.contains("edges below 400 mm"), "{small}");
    let json: serde_json::Value = serde_json::from_str(&info(&["--case", "small.toml", "--format", "json"])).unwrap();
    assert!((json["edges"]["shortest"].as_f64().unwrap() - 4e-5).abs() < 1e-6, "{json}");
    let mut mesh = bar();
    mesh.groups.clear();
    let without = Workplace::with_mesh("", &crate::common::mesh_bytes(&mesh, fractum_mesh::MshFormat::V2_2Ascii));
    let said = without.fractum(&["mesh", "info", "bar.msh"]).stdout;
    assert!(said.contains("hint: no groups: a case names bodies"), "{said}");
}

#[test]
fn a_zone_is_refined_by_the_command_as_by_the_case() {
    let zone = "x > 0.1 m && x < 0.2 m";
    let workplace = Workplace::new(BREAKING_BAR);
    let case = BREAKING_BAR.replace(
        "file = \"bar.msh\"",
        &format!("file = \"bar.msh\"\n[[mesh.refine]]\nwhere = \"{zone}\"\nsize = \"30 mm\""),
    );
    fs::write(workplace.path("fine.toml"), case).unwrap();
    let told = workplace.fractum(&["mesh", "refine", "bar.msh", "--where", zone, "--size", "3 cm", "-o", "fine.msh"]);
    assert!(told.code == Some(0) && told.stdout.starts_with("refined: "), "{told:?}");
    assert!(told.stdout.contains(" tetrahedra of 432; edges there up to 3") && told.stdout.contains("rows broken up"));
    let of_case = workplace.fractum(&["mesh", "refine", "fine.toml", "-o", "case.msh"]);
    assert_eq!((of_case.code, &of_case.stdout), (Some(0), &told.stdout), "{of_case:?}");
    let read = |name: &str| read_msh(&fs::read(workplace.path(name)).unwrap()).unwrap();
    let (fine, known) = (read("fine.msh"), bar());
    assert_eq!((&fine.nodes, fine.group_names()), (&read("case.msh").nodes, known.group_names()));
    assert!(fine.tetrahedra.len() > 4 * known.tetrahedra.len());
    // In another unit it is the same, and so is the case, which runs on.
    let unit = ["--unit", "1 mm", "--where", "x > 0.1 mm && x < 0.2 mm", "--size", "30 um", "-o", "mm.msh"];
    let of_unit = workplace.fractum(&[&["mesh", "refine", "bar.msh"], &unit[..]].concat());
    assert!(of_unit.code == Some(0) && read("mm.msh").tetrahedra.len() == fine.tetrahedra.len(), "{of_unit:?}");
    fs::write(workplace.path("whole.toml"), BREAKING_BAR.replace("bar.msh", "fine.msh")).unwrap();
    let hash = |case: &str| {
        let ended = workplace.fractum(&["run", case, "-o", case.trim_end_matches(".toml"), "--quiet"]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        let summary = fs::read(workplace.path(case.trim_end_matches(".toml")).join("summary.json")).unwrap();
        serde_json::from_slice::<serde_json::Value>(&summary).unwrap()["state_hash"].clone()
    };
    assert_eq!(hash("fine.toml"), hash("whole.toml"));
    let kept = workplace.fractum(&["mesh", "refine", "bar.msh", "--size", "30 mm", "--keep-rows", "-o", "kept.vtu"]);
    assert!(kept.code == Some(0) && kept.stdout.contains("rows kept"), "{kept:?}");
    for (arguments, says) in [
        (&["bar.msh"][..], "--size is missing"),
        (&["bar.msh", "--size", "0"], "--size \"0\"; expected a length above 0"),
        (&["bar.msh", "--size", "3 s"], "is a time; expected a length"),
        (&["bar.msh", "--size", "3 cm", "--where", "x + 1"], "expected a condition such as"),
        (&["bar.msh", "--size", "3 cm", "--where", "x > 5"], "no element of the mesh lies where --where holds"),
        (&["bar.msh", "--size", "1 um"], "more than 50000000 elements would come of it; a larger size, with its unit"),
        (&["case.toml"], "this case has no mesh.refine"),
        (&["fine.toml", "--size", "3 cm"], "a case says them in mesh.refine"),
        (&["bar.msh", "--size", "3 cm", "--set", "a=1"], "--set is for cases"),
    ] {
        let wrong = workplace.fractum(&[&["mesh", "refine"], arguments].concat());
        assert!(wrong.code == Some(1) && wrong.stderr.contains(says), "{says}: {wrong:?}");
        assert_eq!(wrong.stderr.lines().count(), 1, "{wrong:?}");
    }
}
