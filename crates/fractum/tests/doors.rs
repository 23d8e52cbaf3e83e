//! Meshes of other programs on their way through the program: hexahedra of second order in two files, bodies that `mesh info` judges.

use std::fmt::Write;
use std::fs;

use fractum_math::Vec3;
use fractum_mesh::generate::structured_rectangle;
use fractum_mesh::{Mesh, MshFormat};

use crate::common::{Workplace, bar as box_of_tetrahedra, mesh_bytes, run};

/// A bar without lateral strain, pulled by a ten-thousandth of its length.
const PULLED: &str = r#"fractum = 1
title = "A bar of hexahedra"

[mesh]
file = "bar.inp"

[materials.steel]
density = "7850 kg/m^3"
young_modulus = "200 GPa"
poisson_ratio = 0.3

[[bodies]]
name = "bar"
kind = "solid"
group = "bar"
material = "steel"

[[supports]]
group = "left"
fix = "x"
[[supports]]
group = "base"
fix = "z"
[[supports]]
group = "side"
fix = "y"
[[supports]]
group = "right"
displacement = { x = "0.1 mm*t/1 s" }

[solver]
kind = "static"
end = "1 s"

[[probes]]
name = "load"
reaction = { group = "right", along = "x" }
[[probes]]
name = "across"
displacement = { group = "corner", along = "y" }
"#;

/// Nodes and the rest of a bar of 8 by 2 by 3 hexahedra of 20 nodes, 1 m by 0.02 m by 0.03 m, whose inner nodes are moved.
fn bar() -> (String, String) {
    let counts = [8usize, 2, 3];
    let at = |[i, j, k]: [usize; 3]| 1 + i + 17 * (j + 5 * k);
    let (mut nodes, mut text) = (String::from("*NODE, NSET=ALL\n"), String::from("*ELEMENT, TYPE=C3D20, ELSET=bar\n"));
    for (k, j, i) in (0..7).flat_map(|k| (0..5).flat_map(move |j| (0..17).map(move |i| (k, j, i)))) {
        if i % 2 + j % 2 + k % 2 > 1 {
            continue; // middles of faces and cells
        }
        let inner = i > 0 && i < 16 && j > 0 && j < 4 && k > 0 && k < 6;
        let moved = if inner { 0.3 * ((7 * i + 5 * j + 3 * k) % 5) as f64 / 5.0 } else { 0.0 };
        let [x, y, z] = [(i, 16.0), (j, 4.0), (k, 6.0)].map(|(at, count)| (at as f64 + moved) / count);
        let _ = writeln!(nodes, "{}, {:?}, {:?}, {:?}", at([i, j, k]), x, 0.02 * y, 0.03 * z);
    }
    const ORDER: [[usize; 3]; 20] = [
        [0, 0, 0],
        [2, 0, 0],
        [2, 2, 0],
        [0, 2, 0],
        [0, 0, 2],
        [2, 0, 2],
        [2, 2, 2],
        [0, 2, 2],
        [1, 0, 0],
        [2, 1, 0],
        [1, 2, 0],
        [0, 1, 0],
        [1, 0, 2],
        [2, 1, 2],
        [1, 2, 2],
        [0, 1, 2],
        [0, 0, 1],
        [2, 0, 1],
        [2, 2, 1],
        [0, 2, 1],
    ];
    let mut sides: [Vec<String>; 4] = Default::default();
    let mut label = 0;
    for (k, j, i) in
        (0..counts[2]).flat_map(|k| (0..counts[1]).flat_map(move |j| (0..counts[0]).map(move |i| (k, j, i))))
    {
        label += 1;
        let of = ORDER.map(|[a, b, c]| at([2 * i + a, 2 * j + b, 2 * k + c]).to_string());
        let _ = writeln!(text, "{label}, {},\n{}", of[..12].join(", "), of[12..].join(", "));
        for (side, (is_there, face)) in [(i == 0, 6), (i == 7, 4), (k == 0, 1), (j == 0, 3)].into_iter().enumerate() {
            if is_there {
                sides[side].push(format!("{label}, S{face}"));
            }
        }
    }
    for (name, faces) in ["left", "right", "base", "side"].iter().zip(sides) {
        let _ = writeln!(text, "*SURFACE, NAME={name}\n{}", faces.join("\n"));
    }
    let _ = writeln!(text, "*NSET, NSET=corner\n{}", at([16, 4, 6]));
    (nodes, text)
}

#[test]
fn a_bar_of_hexahedra_has_the_stress_of_a_bar() {
    let (nodes, rest) = bar();
    let place = Workplace::new(PULLED);
    fs::create_dir(place.path("parts")).unwrap();
    fs::write(place.path("parts/nodes.inp"), &nodes).unwrap();
    fs::write(place.path("bar.inp"), format!("*HEADING\nbar\n*INCLUDE, INPUT=parts\\nodes.inp\n{rest}")).unwrap();
    let summary = run(&place, "out", "2");
    let last = |name: &str| summary["probes"][name]["final"].as_f64().unwrap();
    // A uniform strain is exact on any mesh: F = E A u/L, and ν u/L of the width across.
    let (force, across) = (200e9 * 0.02 * 0.03 * 1e-4, -0.3 * 1e-4 * 0.02);
    assert!((last("load") / force - 1.0).abs() < 1e-8, "{} N of {force} N", last("load"));
    assert!((last("across") / across - 1.0).abs() < 1e-6, "{} m of {across} m", last("across"));
    assert_eq!(summary["counts"]["nodes"], 9 * 3 * 4, "{}", summary["counts"]);
    assert_eq!(summary["counts"]["elements"], 6 * 48, "{}", summary["counts"]);
    // Log, report and summary tell what became of the mesh.
    let told = ["48 hexahedra split into 288 tetrahedra", "48 hexahedra of higher order read with corners only"];
    let [log, page] = ["run.log", "report.html"].map(|name| fs::read_to_string(place.path("out").join(name)).unwrap());
    // Long lines are broken.
    let [log, page] = [log, page].map(|text| text.split_whitespace().collect::<Vec<_>>().join(" "));
    for told in told {
        assert!(log.contains(told) && page.contains(told), "{told}: {log}");
        assert!(
            summary["mesh"].as_array().unwrap().iter().any(|said| said.as_str().unwrap().contains(told)),
            "{summary}"
        );
    }
    // The same nodes by another text, on other threads.
    fs::write(place.path("parts/nodes.inp"), nodes.replace("*NODE", "** moved\n*NODE")).unwrap();
    let other = run(&place, "other", "1");
    assert_eq!(other["state_hash"], summary["state_hash"]);
    fs::remove_file(place.path("parts/nodes.inp")).unwrap();
    let ended = place.fractum(&["check", "case.toml"]);
    let says = "line 3: *INCLUDE names \"parts\\nodes.inp\", which cannot be read";
    assert!(ended.code == Some(1) && ended.stderr.contains(says), "{}", ended.stderr);
}

#[test]
fn every_body_is_judged_by_its_own_elements() {
    let (nodes, rest) = bar();
    let place = Workplace::new(PULLED);
    let part = format!("*PART, NAME=bar\n{nodes}{rest}*END PART\n");
    let instance = |name: &str, shift: &str| format!("*INSTANCE, NAME={name}, PART=bar\n{shift}\n*END INSTANCE\n");
    let text = format!(
        "{part}*ASSEMBLY, NAME=a\n{}{}*END ASSEMBLY\n",
        instance("low", "0, 0, 0"),
        instance("high", "0, 0, 0.03")
    );
    fs::write(place.path("two.inp"), text).unwrap();
    let ended = place.fractum(&["mesh", "info", "two.inp"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    for says in [
        "group \"low\": edges of tetrahedra",
        "group \"high\": edges of tetrahedra",
        "96 hexahedra split into 576 tetrahedra",
        "groups \"low.bar\" and \"high.bar\": 27 nodes of one lie on nodes of the other",
        "group \"low.bar\": two elements through the thickness",
    ] {
        assert!(ended.stdout.contains(says), "{says}: {}", ended.stdout);
    }
    let ended = place.fractum(&["mesh", "info", "two.inp", "--format", "json"]);
    let value: serde_json::Value = serde_json::from_str(&ended.stdout).unwrap();
    let names: Vec<&str> =
        value["bodies"].as_array().unwrap().iter().filter_map(|body| body["name"].as_str()).collect();
    assert!(names.contains(&"low") && names.contains(&"high"), "{names:?}");
    // Tags of pieces have more than the 32 bits of MSH 2.2.
    let ended = place.fractum(&["mesh", "convert", "two.inp", "two.msh", "--to", "msh22"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(place.fractum(&["mesh", "info", "two.msh"]).stdout.contains("576 tetrahedra"));
}

/// A node beyond the side opposite to it turns elements inside out. They were flipped, and their overlap counted twice.
#[test]
fn a_folded_mesh_is_refused_with_the_elements_that_overlap() {
    let case = r#"fractum = 1
mesh = { file = "bar.msh" }
materials = { rock = { density = 2600, young_modulus = "20 GPa", poisson_ratio = 0.2 } }
bodies = [{ name = "body", kind = "solid", group = "body", material = "rock" THICK }]
supports = [{ group = "x-", fix = "x" }]
solver = { end = "10 us" }
"#;
    let fold = |mut mesh: Mesh, near: Vec3, way: Vec3| {
        let node = mesh.nodes.iter_mut().find(|node| (**node - near).norm() < 1e-9).unwrap();
        *node += way;
        mesh
    };
    let sheet = structured_rectangle([4, 4], [0.4, 0.4], None);
    let meshes = [
        (fold(sheet, Vec3::new(0.2, 0.2, 0.0), Vec3::new(0.15, 0.02, 0.0)), ", thickness = \"1 mm\""),
        (fold(box_of_tetrahedra(), Vec3::new(0.2, 0.04, 0.08), Vec3::new(0.08, 0.0, 0.01)), ""),
    ];
    for (mesh, thick) in meshes {
        let place = Workplace::with_mesh(&case.replace("THICK", thick), &mesh_bytes(&mesh, MshFormat::V4_1Binary));
        let ended = place.fractum(&["run", "case.toml", "-o", "out", "--quiet"]);
        assert_eq!(ended.code, Some(1), "{}", ended.stderr);
        assert!(ended.stderr.contains("overlap: both lie on the same side"), "{}", ended.stderr);
        let told = place.fractum(&["mesh", "info", "bar.msh"]).stdout;
        assert!(told.contains("the mesh is folded"), "{told}");
    }
}
