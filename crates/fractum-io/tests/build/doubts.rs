//! Wrong units are told, and right ones raise no alarm.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use fractum_io::build::doubts;
use fractum_io::case::{Severity, parse_case, read_case};
use fractum_math::Vec3;
use fractum_mesh::generate::structured_box;
use fractum_mesh::{Mesh, read_msh};

fn cases_below(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap().flatten() {
        let path = entry.path();
        if path.is_dir() {
            cases_below(&path, found);
        } else if path.extension().is_some_and(|end| end == "toml") {
            found.push(path);
        }
    }
}

#[test]
fn no_case_of_the_gallery_and_no_template_is_doubted() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut paths = Vec::new();
    cases_below(&root.join("cases"), &mut paths);
    cases_below(&root.join("crates/fractum/templates"), &mut paths);
    let mut meshes: HashMap<PathBuf, Mesh> = HashMap::new();
    let mut doubted = Vec::new();
    let mut checked = 0;
    for path in paths {
        // Studies and tables of values are no cases.
        let Ok(case) = read_case(&path, &[]) else { continue };
        checked += 1;
        let unusual = case.warnings().iter().filter(|warning| {
            warning.remedy.starts_with("did you mean") || warning.remedy.starts_with("check the units")
        });
        doubted.extend(unusual.map(ToString::to_string));
        let file = case.mesh.as_ref().map(|source| source.file.value.clone()).unwrap_or_default();
        let mesh = meshes.entry(file).or_insert_with_key(|file| {
            // Meshes too large for the repository are made by a command, and are empty here.
            let mut mesh = fs::read(file).map_or_else(|_| Mesh::default(), |bytes| read_msh(&bytes).unwrap());
            let unit = case.mesh.as_ref().map_or(1.0, |source| source.unit);
            mesh.nodes.iter_mut().for_each(|node| *node *= unit);
            mesh
        });
        doubted.extend(doubts(&case, mesh).iter().map(ToString::to_string));
    }
    assert!(meshes.len() > 60, "{} meshes", meshes.len());
    assert!(checked > 150, "{checked} cases");
    assert!(doubted.is_empty(), "{}", doubted.join("\n"));
}

const BAR: &str = r#"fractum = 1
mesh = { file = "bar.msh" }
[materials.concrete]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0.2
[materials.concrete.damage]
tensile_strength = "3 MPa"
fracture_energy = "100 J/m^2"
[[bodies]]
name = "bar"
kind = "solid"
group = "body"
material = "concrete"
[[supports]]
group = "x+"
displacement = { x = "0.1 mm * t / 1 ms" }
[solver]
end = "1 ms"
"#;

/// What is said of a bar with one text in place of another: warnings of the case, and doubts about a mesh of this length.
fn said(old: &str, new: &str, length: f64, origin: f64) -> Vec<String> {
    assert!(BAR.contains(old), "{old}");
    let case = parse_case(&BAR.replace(old, new), Path::new("case.toml"), &[]);
    let case = case.unwrap_or_else(|errors| panic!("{errors}"));
    let mut mesh = structured_box([8, 3, 3], Vec3::new(length, 0.3 * length, 0.3 * length), None);
    mesh.nodes.iter_mut().for_each(|node| node.x += origin);
    let all = case.warnings().iter().cloned().chain(doubts(&case, &mesh));
    all.inspect(|doubt| assert_eq!(doubt.severity, Severity::Warning)).map(|doubt| doubt.to_string()).collect()
}

#[track_caller]
fn doubted(old: &str, new: &str, words: &[&str]) {
    let all = said(old, new, 0.4, 0.0);
    assert_eq!(all.len(), 1, "{all:?}");
    assert!(words.iter().all(|word| all[0].contains(word)), "{all:?}");
}

#[test]
fn a_wrong_unit_is_told_with_its_line_and_the_likely_one() {
    assert_eq!(said("fractum = 1", "fractum = 1", 0.4, 0.0), [""; 0]);
    doubted("\"2400 kg/m^3\"", "2.4", &["case.toml:4:11: ", "density = 2.4, which is 2.4 kg/m³", "\"2.4 g/cm^3\"?"]);
    doubted("\"30 GPa\"", "30", &["case.toml:5:17: ", "= 30, which is 30 Pa", "\"30 GPa\"?"]);
    doubted("\"3 MPa\"", "\"3 Pa\"", &["case.toml:8:20: ", "\"3 MPa\"?"]);
    doubted("\"3 MPa\"", "\"30 GPa\"", &["case.toml:8:20: ", "of young_modulus", "check the units of both"]);
    doubted("\"30 GPa\"", "\"30000 GPa\"", &["case.toml:5:17: ", "\"30000 MPa\"?"]);
    // In N/mm the number is a thousandth.
    doubted("\"100 J/m^2\"", "\"100 uJ/m^2\"", &["case.toml:9:19: ", "process zone", "\"100 J/m^2\"?"]);
    doubted("0.1 mm * t", "100 mm * t / 1 us * 1 ms", &["case.toml:17:", "moves a body of 400 mm by 100 m"]);
}

#[test]
fn a_parameter_is_doubted_where_it_stands() {
    let text = "parameters = { strength = 3 }\nmesh = { file = \"bar.msh\" }";
    let case = BAR.replace("mesh = { file = \"bar.msh\" }", text).replace("\"3 MPa\"", "\"strength\"");
    let case = parse_case(&case, Path::new("case.toml"), &[]).unwrap();
    let [doubt] = case.warnings() else { panic!("{:?}", case.warnings()) };
    let text = doubt.to_string();
    assert!(text.starts_with("case.toml:2:27: warning: parameters.strength is 3 Pa"), "{text}");
    assert!(text.ends_with("did you mean \"3 MPa\"?"), "{text}");
}

#[test]
fn a_mesh_in_another_unit_is_told() {
    let all = said("fractum = 1", "fractum = 1", 400.0, 0.0);
    assert!(all.len() == 1 && all[0].contains("set mesh.unit = \"mm\"") && all[0].contains("400 m large"), "{all:?}");
    let rock = said("[solver]", "[[loads]]\ngravity = { y = \"-9.81 m/s^2\" }\n[solver]", 400.0, 0.0);
    assert_eq!(rock, [""; 0], "rock may be large");
    let unit = "mesh = { unit = \"mm\", file = \"bar.msh\" }";
    let all = said("mesh = { file = \"bar.msh\" }", unit, 4e-4, 0.0);
    assert!(all.iter().any(|doubt| doubt.contains("leave mesh.unit out")), "{all:?}");
    let all = said("fractum = 1", "fractum = 1", 0.4, 4e8);
    assert!(all.len() == 1 && all[0].contains("move the origin into the body"), "{all:?}");
}

#[test]
fn loads_of_another_unit_are_told() {
    let load = |load: &str| said("[solver]", &format!("[[loads]]\n{load}\n[solver]"), 0.4, 0.0);
    let all = load("gravity = { y = -9810 }");
    assert!(all.len() == 1 && all[0].contains("case.toml:19:17: ") && all[0].contains("mm/s^2?"), "{all:?}");
    let all = load("group = \"x-\"\npressure = 8");
    assert!(all.len() == 1 && all[0].contains("case.toml:20:12: ") && all[0].contains("is 8 Pa at most"), "{all:?}");
}
