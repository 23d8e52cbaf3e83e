//! A case that asks for an accuracy: passes on meshes of their own, error bars, and what is kept of them.

use std::collections::HashMap;
use std::fs;

use fractum_mesh::generate::structured_rectangle;
use fractum_mesh::{Group, Mesh, MshFormat, Vec3, write_msh};
use serde_json::Value;

use crate::common::{Workplace, summary};

/// Right half of a plate with a slit of two thirds of its process zone to either side, pulled apart at rest.
const PLATE: &str = r#"fractum = 1
mesh = { file = "plate.msh" }
[materials.m]
density = "2400 kg/m^3"
young_modulus = "20 GPa"
poisson_ratio = 0
[materials.m.damage]
tensile_strength = "2.5 MPa"
fracture_energy = "90 J/m^2"
softening = "linear"
[[bodies]]
name = "plate"
kind = "solid"
group = "plate"
material = "m"
plane = "stress"
thickness = "0.1 m"
damage_where = "x > 0.135 m && abs(y) < 0.072 m"
[[supports]]
group = "left"
fix = "x"
[[supports]]
group = "bottom"
displacement = { y = "-0.15 mm*t/1 s" }
[[supports]]
group = "top"
displacement = { y = "0.15 mm*t/1 s" }
[solver]
kind = "static"
end = "1 s"
accuracy = "20 %"
accuracy_runs = 4
stop_when = { probe = "load", below = 0.7, lasting = "0 s" }
[[probes]]
name = "load"
reaction = { group = "top", along = "y" }
[[probes]]
name = "peak"
expression = "max(load)"
unit = "N"
[[probes]]
name = "strength"
expression = "max(load) / 0.0432 m^2"
[[probes]]
name = "behind"
crack = { measure = "centre", along = "y", where = "x < 0.1 m" }
[[expect]]
quantity = "peak"
value = "55.46 kN"
tolerance = "8 %"
source = "exact cohesive crack, cases/crack-size/exact.py"
"#;

/// The plate on squares of a tenth of the process zone, cut into triangles.
fn plate() -> Mesh {
    let (width, height, slit, cells) = (0.432, 0.864, 0.144, [15, 30]);
    let square = structured_rectangle(cells, [width, height], None);
    let mut nodes: Vec<Vec3> = square.nodes.iter().map(|node| *node - Vec3::new(0.0, height / 2.0, 0.0)).collect();
    let mut twins = HashMap::new();
    for node in 0..nodes.len() {
        if nodes[node].y.abs() < 1e-9 && nodes[node].x < slit - 1e-9 {
            twins.insert(node as u32, nodes.len() as u32);
            nodes.push(nodes[node]);
        }
    }
    let is_above = |t: &[u32; 3]| t.iter().map(|&n| nodes[n as usize].y).sum::<f64>() > 0.0;
    let cut = |t: &[u32; 3]| if is_above(t) { t.map(|n| *twins.get(&n).unwrap_or(&n)) } else { *t };
    let triangles: Vec<[u32; 3]> = square.triangles.iter().map(cut).collect();
    let mut lines = Vec::new();
    let mut side = |name: &str, tag, axis: usize, at: f64| {
        let on = |n: u32| (nodes[n as usize][axis] - at).abs() < 1e-9;
        let edges = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let first = lines.len() as u32;
        lines.extend(edges.filter(|edge| edge.iter().all(|n| on(*n))));
        Group { name: name.into(), dimension: 1, tag, lines: (first..lines.len() as u32).collect(), ..Group::default() }
    };
    let mut groups =
        vec![side("left", 1, 0, 0.0), side("bottom", 2, 1, -height / 2.0), side("top", 3, 1, height / 2.0)];
    let all = (0..triangles.len() as u32).collect();
    groups.push(Group { name: "plate".into(), dimension: 2, tag: 4, triangles: all, ..Group::default() });
    let mut mesh = Mesh { nodes, lines, triangles, groups, ..Mesh::default() };
    mesh.number();
    mesh
}

fn place(case: &str) -> Workplace {
    let place = Workplace::new(case);
    let mut bytes = Vec::new();
    write_msh(&plate(), MshFormat::V4_1Binary, &mut bytes).unwrap();
    fs::write(place.path("plate.msh"), bytes).unwrap();
    place
}

fn names(summary: &Value) -> Vec<String> {
    let passes = summary["accuracy"]["passes"].as_array().unwrap();
    passes.iter().map(|pass| pass["name"].as_str().unwrap().to_owned()).collect()
}

/// What does not depend on the clock.
fn found(mut summary: Value) -> [Value; 2] {
    for pass in summary["accuracy"]["passes"].as_array_mut().unwrap() {
        pass["wall"] = Value::Null;
    }
    [summary["accuracy"].take(), summary["state_hash"].take()]
}

#[test]
fn peaks_get_error_bars_and_passes_are_kept() {
    let place = place(PLATE);
    let ended = place.fractum(&["run", "case.toml", "-o", "out", "--threads", "1"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    for words in ["pass 1-as-meshed: 900 elements", "pass 3-line: ", "; so far "] {
        assert!(ended.stderr.contains(words), "{words}: {}", ended.stderr);
    }
    assert_eq!(ended.stderr.matches("[coarse-mesh]").count(), 1, "once, of the mesh of the user: {}", ended.stderr);
    assert!(ended.stdout.contains("peak of load"), "{}", ended.stdout);
    let first = summary(&place, "out");
    let accuracy = &first["accuracy"];
    let of = |probe: &str, key: &str| accuracy["probes"][probe][key].as_f64().unwrap();
    let [value, half] = ["value", "half"].map(|key| of("load", key));
    // The exact load of the crack, and less than the first mesh says.
    assert!((value - 55.46e3).abs() < half && half < 0.02 * value, "{value} {half}");
    assert!((half / value - accuracy["reached"].as_f64().unwrap()).abs() < 1e-12);
    assert_eq!([of("peak", "value"), of("peak", "half")], [value, half]);
    // In another unit it is the same load.
    assert!((of("strength", "value") / value * 0.0432 - 1.0).abs() < 1e-12);
    assert!((of("strength", "half") / half * 0.0432 - 1.0).abs() < 1e-12);
    // There is no crack behind the tip of the slit, and a probe that looks there has neither value nor bar.
    assert_eq!([&first["probes"]["behind"]["max"], &accuracy["probes"]["behind"]], [&Value::Null; 2]);
    let sizes: Vec<f64> =
        accuracy["passes"].as_array().unwrap().iter().map(|pass| pass["size"].as_f64().unwrap()).collect();
    assert!(sizes[2] <= sizes[1] && sizes[1] < sizes[0], "{sizes:?}");
    let names = names(&first);
    assert_eq!(names, ["1-as-meshed", "2-refined", "3-line", "4-refined", "5-line"]);
    let expect = &first["expect"][0];
    assert_eq!((expect["value"].as_f64().unwrap(), expect["pass"].as_bool()), (value, Some(true)));
    for file in ["accuracy.md", "history.csv", "report.html", "fields.pvd", "run.log", "input/case.toml"] {
        assert!(place.path("out").join(file).is_file(), "{file}");
    }
    let page = fs::read_to_string(place.path("out/report.html")).unwrap();
    assert!(page.contains("Peak of load by size of elements"));
    assert!(place.path("out/passes").join(&names[4]).join("mesh.msh").is_file());

    // What is there is not replaced unasked, and what has finished is not run again; the last pass runs on other threads.
    assert_eq!(place.fractum(&["run", "case.toml", "-o", "out"]).code, Some(1));
    fs::remove_dir_all(place.path("out/passes").join(&names[4])).unwrap();
    let again = place.fractum(&["run", "case.toml", "-o", "out", "--resume", "--threads", "2"]);
    assert_eq!(again.code, Some(0), "{}", again.stderr);
    assert_eq!(found(summary(&place, "out")), found(first));

    // A single run puts itself in the place of all passes.
    let one = place.fractum(&["run", "case.toml", "-o", "out", "--overwrite", "--set", "solver.accuracy=0"]);
    assert_eq!(one.code, Some(0), "{}", one.stderr);
    assert!(!place.path("out/passes").exists() && !place.path("out/accuracy.md").exists());
    assert_eq!(summary(&place, "out")["accuracy"], Value::Null);
}

#[test]
fn what_cannot_get_an_error_bar_is_told() {
    let place = place(
        &PLATE.replace("tensile_strength = \"2.5 MPa\"", "tensile_strength = \"25 MPa\"").replace("90 J", "9 kJ"),
    );
    let ended = place.fractum(&["run", "case.toml", "-o", "out"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stderr.contains("no damage came"), "{}", ended.stderr);
    assert!(summary(&place, "out")["warnings"].to_string().contains("\"accuracy\""));
    assert!(fs::read_to_string(place.path("out/run.log")).unwrap().contains("[accuracy]"));
    let strict = place.fractum(&["run", "case.toml", "-o", "strict", "--strict"]);
    assert_eq!(strict.code, Some(2), "{}", strict.stderr);
    let set = ["criterion=\"mohr-coulomb\"", "compressive_strength=\"300 MPa\"", "friction_angle=\"40 deg\""];
    let set = set.map(|set| format!("materials.m.damage.{set}"));
    let arguments = ["run", "case.toml", "-o", "other", "--set", &set[0], "--set", &set[1], "--set", &set[2]];
    let other = place.fractum(&arguments);
    assert!(other.stderr.contains("and this is another criterion than Rankine's"), "{}", other.stderr);
    let wrong =
        place.fractum(&["run", "case.toml", "-o", "more", "--set", "solver.accuracy=\"1 %\"", "--set", "probes=[]"]);
    assert_eq!(wrong.code, Some(1), "{}", wrong.stderr);
}

#[test]
fn a_phase_field_becomes_narrower_with_the_elements() {
    let place = place(PLATE);
    let field = "materials.m.damage.regularisation=\"phase-field\"";
    let ended = place.fractum(&["run", "case.toml", "-o", "out", "--set", field, "--set", "solver.accuracy_runs=5"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let [first, second] = ["1-as-meshed", "3-refined"]
        .map(|pass| fs::read_to_string(place.path("out/passes").join(pass).join("run.log")).unwrap());
    assert!(!first.contains("phase field of length") && second.contains("phase field of length"), "{first}");
    let load = &summary(&place, "out")["accuracy"]["probes"]["load"];
    let [value, half] = ["value", "half"].map(|key| load[key].as_f64().unwrap());
    assert!((value - 55.46e3).abs() < half && half < 0.08 * value, "{value} {half}");
    let length = "materials.m.damage.length=\"20 mm\"";
    let given = place.fractum(&["run", "case.toml", "-o", "given", "--set", field, "--set", length]);
    assert_eq!(given.code, Some(1), "{}", given.stderr);
    assert!(given.stderr.contains("a phase field of a given length"), "{}", given.stderr);
}

#[test]
fn a_load_that_grows_to_the_end_has_no_bar() {
    let place = place(PLATE);
    let ended = place.fractum(&["run", "case.toml", "-o", "out", "--set", "solver.end=\"0.2 s\""]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stderr.contains("fewer than two of 4 passes have seen the load fall"), "{}", ended.stderr);
    let accuracy = &summary(&place, "out")["accuracy"];
    assert_eq!(accuracy["probes"], serde_json::json!({}));
    assert_eq!(accuracy["reached"], Value::Null);
    assert!(accuracy["passes"].to_string().contains("its load did not fall"));
}

/// A crack of which no line is known: passes with damage alone, as many as are asked for.
#[test]
fn where_strength_scatters_no_pass_runs_along_a_line() {
    let place = place(PLATE);
    let scatter = "materials.m.damage.scatter={ distribution = \"uniform-per-edge\", width = 0.02 }";
    let ended = place.fractum(&["run", "case.toml", "-o", "out", "--set", scatter]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_eq!(names(&summary(&place, "out")), ["1-as-meshed", "2-refined", "3-refined", "4-refined"]);
}
