//! Wrong units are told, and right ones raise no alarm.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use fractum_case::build::{cut_network, doubts};
use fractum_case::{Diagnostic, Severity, parse_case, read_case};
use fractum_math::Vec3;
use fractum_mesh::generate::{structured_box, structured_rectangle};
use fractum_mesh::{Group, Mesh, read_msh};
use fractum_output::warning::Code;

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
            let unit = case.mesh.as_ref().map_or(1.0, |source| source.unit.length);
            mesh.nodes.iter_mut().for_each(|node| *node *= unit);
            mesh
        });
        // These have few elements through the thickness, to show what that costs, or far from where they are looked at.
        let is_thin = ["cantilever", "ball-on-edge"].iter().any(|name| path.to_string_lossy().contains(name));
        // Of the source, on elements of half a front.
        let is_short = path.to_string_lossy().contains("granite-cylinder/pulse");
        // Cut short, since what a step costs is all that is asked.
        let is_cut = path.to_string_lossy().contains("cases/speed");
        // Loaded fast, since it slides on for long; its references are met.
        let is_fast = path.to_string_lossy().contains("closed-cracks/triaxial");
        let known = [
            (is_thin, Code::ThinMesh),
            (is_short, Code::ShortPulse),
            (is_cut, Code::EndsEarly),
            (is_fast, Code::FastLoading),
        ];
        let is_known = |doubt: &Diagnostic| known.iter().any(|(known, code)| *known && doubt.code == Some(*code));
        let mut mesh = mesh.clone();
        if let Some(source) = case.mesh.as_ref().filter(|_| !mesh.nodes.is_empty()) {
            cut_network(&source.network, &mut mesh).unwrap_or_else(|errors| panic!("{errors}"));
        }
        let told = doubts(&case, &mesh).into_iter().filter(|doubt| !is_known(doubt));
        doubted.extend(told.map(|doubt| doubt.to_string()));
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
[[supports]]
group = "x-"
fix = "yz"
"#;

/// What is said of a bar with one text in place of another: warnings of the case, and doubts about a mesh of this length.
fn said(old: &str, new: &str, length: f64, origin: f64) -> Vec<String> {
    assert!(BAR.contains(old), "{old}");
    let mut mesh = structured_box([8, 3, 3], Vec3::new(length, 0.3 * length, 0.3 * length), None);
    mesh.nodes.iter_mut().for_each(|node| node.x += origin);
    said_of(&BAR.replace(old, new), &mesh)
}

/// What is said of a case and its mesh.
fn said_of(case: &str, mesh: &Mesh) -> Vec<String> {
    let case = parse_case(case, Path::new("case.toml"), &[]);
    let case = case.unwrap_or_else(|errors| panic!("{errors}"));
    let all = case.warnings().iter().cloned().chain(doubts(&case, mesh));
    all.inspect(|doubt| assert_eq!(doubt.severity, Severity::Warning)).map(|doubt| doubt.to_string()).collect()
}

#[track_caller]
fn doubted(old: &str, new: &str, words: &[&str]) {
    let held = BAR.replace("fix = \"yz\"", "fix = \"xyz\"");
    assert!(held.contains(old), "{old}");
    let all = said_of(&held.replace(old, new), &structured_box([8, 3, 3], Vec3::new(0.4, 0.12, 0.12), None));
    assert_eq!(all.len(), 1, "{all:?}");
    assert!(words.iter().all(|word| all[0].contains(word)), "{all:?}");
}

/// Cantilevers of four elements through the thickness lose 16 % of their deflection in triangles and 17 to 20 % in tetrahedra of the plain formulation, less than
/// 2 % in smoothed tetrahedra, and 7.6 % in triangles half as large.
#[test]
fn a_bent_body_is_told_what_its_elements_take_of_its_deflection() {
    let plain = "kind = \"solid\"\nformulation = \"standard\"";
    let bent = BAR
        .replace("displacement = { x", "displacement = { y")
        .replace("0.1 mm", "1 um")
        .replace("kind = \"solid\"", plain);
    let rectangle = |rows: u32| structured_rectangle([8 * rows, rows], [0.4, 0.05], None);
    let block = |rows: u32| structured_box([8 * rows, rows, rows], Vec3::new(0.4, 0.05, 0.05), None);
    let flat = bent.replace("fix = \"yz\"", "fix = \"xy\"");
    for (case, mesh, least, most) in
        [(&flat, rectangle(4), 13.0, 18.0), (&flat, rectangle(6), 6.0, 9.0), (&bent, block(4), 15.0, 20.0)]
    {
        let all = said_of(case, &mesh);
        let told: Vec<&String> = all.iter().filter(|text| text.contains("is bent")).collect();
        let [text] = told.as_slice() else { panic!("{all:?}") };
        let share = text.split("take some ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
        assert!((least..most).contains(&share.parse::<f64>().unwrap()), "{text}");
        assert!(text.contains("formulation = \"smoothed\""), "{text}");
    }
    for (case, mesh) in [(flat, rectangle(12)), (bent.replace(plain, "kind = \"solid\""), block(4))] {
        let all = said_of(&case, &mesh);
        assert!(!all.iter().any(|text| text.contains("is bent")), "{all:?}");
    }
}

/// A body is bent by supports and loads that are chosen by their place, by rollers, by heat on one side and by its own vibrations; not where a
/// whole side lies on a support, or where both sides are heated.
#[test]
fn what_bends_a_body_is_seen_however_it_is_written() {
    const HEAD: &str = r#"fractum = 1
mesh = { file = "bar.msh" }
[materials.rock]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0.2
[materials.rock.thermal]
conductivity = "2 W/(m K)"
heat_capacity = "900 J/(kg K)"
expansion = "1e-5 1/K"
[[bodies]]
name = "bar"
kind = "solid"
group = "body"
material = "rock"
plane = "stress"
thickness = "50 mm"
"#;
    let solver = |kind: &str| match kind {
        "modes" => "[solver]\nkind = \"modes\"\n".to_owned(),
        kind => format!("[solver]\nkind = \"{kind}\"\nend = \"1 s\"\n"),
    };
    let held = "[[supports]]\nwhere = \"x < 1 mm\"\nfix = \"xy\"\n";
    let foot = "[[supports]]\nwhere = \"x < 1 mm && y < 1 mm\"\nfix = \"xy\"\n[[supports]]\nwhere = \"x > 399 mm && y < 1 mm\"\nfix = \"y\"\n";
    let load = "[[loads]]\nwhere = \"x > 399 mm\"\nforce = { y = \"-100 N\" }\n";
    let lies = "[[supports]]\nwhere = \"y < 1 mm\"\nfix = \"xy\"\n";
    let roller = |x: f64, y: f64, moves: &str| {
        format!(
            "[[bodies]]\nname = \"roller{x}\"\nkind = \"rigid\"\nshape = \"cylinder\"\naxis = \"z\"\nlength = 0.2\nradius = 0.01\npoint = [{x}, {y}, -0.1]\n{moves}"
        )
    };
    let rollers =
        [roller(0.02, -0.01, ""), roller(0.38, -0.01, ""), roller(0.2, 0.06, "velocity = { y = \"-1 um/s\" }\n")];
    let rollers =
        format!("{}[[supports]]\nwhere = \"abs(x - 0.2) < 1e-3 && y < 1 mm\"\nfix = \"x\"\n", rollers.concat());
    let heated = |side: &str| format!("[[heat.conditions]]\nwhere = \"{side}\"\ntemperature = \"300 K + 10 K/s*t\"\n");
    let heat = "[heat]\ninitial_temperature = \"300 K\"\n";
    let graded = "[[heat.conditions]]\nwhere = \"x >= 0\"\ntemperature = \"300 K + 10 K/s*t*y/50 mm\"\n";
    let cases = [
        (format!("{held}{load}"), "static", true),
        (format!("{lies}{load}"), "static", false),
        (held.to_owned(), "modes", true),
        (String::new(), "modes", true),
        (lies.to_owned(), "modes", false),
        (rollers, "static", true),
        (format!("{foot}{heat}{}", heated("y > 49 mm")), "static", true),
        (format!("{foot}{heat}{graded}"), "static", true),
        (format!("{foot}{heat}{}{}", heated("y > 49 mm"), heated("y < 1 mm")), "static", false),
    ];
    let mesh = structured_rectangle([32, 4], [0.4, 0.05], None);
    for (scene, kind, bends) in cases {
        let all = said_of(&format!("{HEAD}{scene}{}", solver(kind)), &mesh);
        assert_eq!(all.iter().any(|text| text.ends_with("[thin-mesh]")), bends, "{scene}: {all:?}");
    }
}

/// Supports and loads by their place are doubted as those by a group are.
#[test]
fn what_is_chosen_by_its_place_is_doubted_too() {
    let mesh = structured_box([8, 3, 3], Vec3::new(0.4, 0.12, 0.12), None);
    let scene = |rest: &str| {
        let start = BAR.find("[[supports]]").unwrap();
        let bar = BAR[..start].replace("[materials.concrete.damage]", "[materials.concrete.thermal]");
        let bar = bar.replace("tensile_strength = \"3 MPa\"", "conductivity = 2");
        let bar = bar.replace("fracture_energy = \"100 J/m^2\"", "heat_capacity = 900");
        said_of(&format!("{bar}{rest}"), &mesh)
    };
    let one = "[[supports]]\nPLACE\ndisplacement = { x = \"0.1 mm * t / 10 ms\" }\n[solver]\nend = \"10 ms\"\n";
    let pulse = "[[supports]]\nPLACE\nfix = \"xyz\"\n[[loads]]\nwhere = \"x > 399 mm\"\npressure = { pulse = \"half-sine\", peak = \"1 MPa\", duration = \"0.4 ms\" }\n[solver]\nend = \"2 ms\"\n";
    for (text, code) in [(one, "[unheld]"), (pulse, "[reflections]")] {
        for place in ["group = \"x-\"", "where = \"x < 1 mm\""] {
            let all = scene(&text.replace("PLACE", place));
            assert!(all.iter().any(|text| text.ends_with(code)), "{place}: {all:?}");
        }
    }
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
    assert!(text.ends_with("did you mean \"3 MPa\"? [unusual-value]"), "{text}");
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

#[test]
fn what_lasts_shorter_than_the_looks_of_a_long_run_is_not_doubted() {
    let mesh = structured_box([8, 3, 3], Vec3::new(0.4, 0.12, 0.12), None);
    let loaded = |support: &str, load: &str, end: &str| {
        let case = BAR.replace("displacement = { x = \"0.1 mm * t / 1 ms\" }", support);
        let solver = format!("[[loads]]\n{load}\n[solver]\nend = \"{end}\"");
        said_of(&case.replace("[solver]\nend = \"1 ms\"", &solver), &mesh)
    };
    let pressure = |pressure: &str| loaded("fix = \"x\"", &format!("group = \"x-\"\npressure = {pressure}"), "1.5 s");
    let pulse = "{ pulse = \"double-exponential\", peak = \"50 MPa\", rise_time = \"40 us\", decay_time = \"100 us\" }";
    let bump = "{ ramp = [[\"0 s\", \"1 Pa\"], [\"10 us\", \"5 MPa\"], [\"20 us\", \"1 Pa\"]] }";
    for right in [pulse, bump, "\"50 MPa*exp(-t/50 us)*t/10 us\""] {
        assert_eq!(pressure(right), [""; 0], "{right}");
    }
    let small = "{ ramp = [[\"0 s\", \"0 Pa\"], [\"10 us\", \"8 Pa\"], [\"20 us\", \"0 Pa\"]] }";
    let said = pressure(small);
    assert!(said.len() == 1 && said[0].contains("is 8 Pa at most"), "{said:?}");
    // Half a metre per second of the velocity is no way: it lasts 50 us, or swings.
    let velocity = |velocity: &str| {
        let support = format!("velocity = {{ x = {velocity} }}");
        loaded(&support, "gravity = { y = \"-9.81 m/s^2\" }", "0.2 s")
    };
    let blow =
        "{ ramp = [[\"0 s\", \"0 m/s\"], [\"10 us\", \"10 m/s\"], [\"50 us\", \"10 m/s\"], [\"60 us\", \"0 m/s\"]] }";
    for right in [blow, "\"10 m/s*sin(2*pi*t/10 ms)\""] {
        assert_eq!(velocity(right), [""; 0], "{right}");
    }
    let there_and_back = "{ ramp = [[\"0 s\", \"0 m/s\"], [\"1 ms\", \"20 m/s\"], [\"0.1005 s\", \"20 m/s\"], [\"0.1015 s\", \"-20 m/s\"]] }";
    let said = velocity(there_and_back);
    assert!(said.len() == 1 && said[0].contains("moves a body of 400 mm by 2 m"), "{said:?}");
}

#[test]
fn loads_of_every_stage_are_doubted_once() {
    let stages = "[[loads]]\ngroup = \"x-\"\npressure = 8\nstages = [\"b\"]\n\
                  [[loads]]\ngroup = \"x-\"\npressure = 7\n\
                  [[stages]]\nname = \"a\"\nsolver = { end = \"1 ms\" }\n[[stages]]\nname = \"b\"\nsolver = { end = \"2 ms\" }";
    let said = said("[solver]\nend = \"1 ms\"", stages, 0.4, 0.0);
    let about = |text: &str| said.iter().filter(|doubt| doubt.contains(text)).count();
    assert_eq!((said.len(), about("is 8 Pa at most"), about("is 7 Pa at most")), (2, 1, 1), "{said:?}");
}

#[test]
fn only_solids_are_looked_at_for_their_distance_from_the_origin_and_with_all_their_edges() {
    let group = |name: &str, tetrahedra: Vec<u32>, points: Vec<u32>| {
        let dimension = if points.is_empty() { 3 } else { 0 };
        Group { name: name.into(), dimension, tag: 1, tetrahedra, points, ..Group::default() }
    };
    let mut mesh = Mesh {
        // The short edge joins the first node and the third.
        nodes: [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1e-3, 0.0, 0.0], [0.0, 0.0, 1.0], [4e11, 0.0, 0.0]]
            .map(Vec3::from)
            .to_vec(),
        tetrahedra: vec![[0, 1, 2, 3]],
        points: vec![[4]],
        groups: vec![group("body", vec![0], vec![]), group("target", vec![], vec![0])],
        ..Mesh::default()
    };
    assert_eq!(said_of(BAR, &mesh), [""; 0], "the point far away belongs to no solid");
    mesh.nodes.iter_mut().for_each(|node| node.y += 1e6);
    let said = said_of(BAR, &mesh);
    assert!(said.len() == 1 && said[0].contains("an edge of 1 mm"), "{said:?}");
}

#[test]
fn a_velocity_that_tears_elements_at_once_is_told() {
    let thrown = |speed: &str| format!("material = \"concrete\"\ninitial_velocity = {{ x = \"{speed}\" }}\n");
    let step = "if(x > 20 cm, 40 m/s, 0 m/s)";
    let told = format!("{:?}", said("material = \"concrete\"\n", &thrown(step), 0.4, 0.0));
    assert!(["initial_velocity", "40 m/s", "fracture energy"].iter().all(|word| told.contains(word)), "{told}");
    // Neither a turn of the whole nor a slow change tears anything.
    for speed in ["if(x > 20 cm, 0.4 m/s, 0 m/s)", "1 m/s * x / 1 m", "40 m/s", "-100 m/s * y / 1 m"] {
        let case = thrown(speed);
        let turns = if speed.contains('y') { case.replace("\" }", "\", y = \"100 m/s * x / 1 m\" }") } else { case };
        let all = said("material = \"concrete\"\n", &turns, 0.4, 0.0);
        assert!(!format!("{all:?}").contains("fracture energy"), "{speed}: {all:?}");
    }
}

/// As docs/limits.md tells it of bars in plane strain.
#[test]
fn a_criterion_that_counts_the_stress_across_a_plate_is_told_in_plane_strain() {
    let mesh = structured_rectangle([8, 3], [0.4, 0.12], None);
    let said = |criterion: &str, ratio: &str, plane: &str| {
        let crushing = if criterion == "mazars" { "" } else { "compressive_strength = \"30 MPa\"" };
        let case = BAR
            .replace("\"100 J/m^2\"", &format!("\"100 J/m^2\"\ncriterion = \"{criterion}\"\n{crushing}"))
            .replace("poisson_ratio = 0.2", &format!("poisson_ratio = {ratio}"))
            .replace("kind = \"solid\"", &format!("kind = \"solid\"\n{plane}"))
            .replace("fix = \"yz\"", "fix = \"xy\"");
        let told = said_of(&case, &mesh);
        told.into_iter().find(|text| text.contains("[plane-strain]"))
    };
    for (criterion, ratio, words) in [
        ("mazars", "0.3", "at 1.10 of tensile_strength, and cracks cost 1.21 of"),
        ("mazars", "0.45", "at 1.25 of"),
        ("drucker-prager", "0.3", "at 0.93 of"),
        ("drucker-prager", "0.45", "at 0.89 of"),
    ] {
        let told = said(criterion, ratio, "");
        assert!(told.as_ref().is_some_and(|text| text.contains(words)), "{criterion} {ratio}: {told:?}");
    }
    assert_eq!(said("drucker-prager", "0.3", "plane = \"stress\""), None);
    assert_eq!(said("mazars", "0", ""), None);
    assert_eq!(said("mohr-coulomb", "0.45", ""), None);
}

/// Its wave has 0.6 of the strength at rest, and 0.47 of that at half a per second.
#[test]
fn a_strength_that_grows_with_the_rate_of_strain_allows_faster_loading() {
    let measured =
        "[[probes]]\nname = \"load\"\nreaction = { group = \"x+\", along = \"x\" }\n[solver]\nend = \"2 ms\"";
    let fast =
        BAR.replace("[solver]\nend = \"1 ms\"", measured).replace("0.1 mm", "0.2 mm").replace("\"yz\"", "\"xyz\"");
    let mesh = structured_box([8, 3, 3], Vec3::new(0.4, 0.12, 0.12), None);
    let told = said_of(&fast, &mesh);
    assert!(
        told.len() == 1 && told[0].contains("of the tensile strength") && told[0].ends_with("[fast-loading]"),
        "{told:?}"
    );
    let by_rate = "\"100 J/m^2\"\nrate = { strength = \"fib-2010\" }";
    assert_eq!(said_of(&fast.replace("\"100 J/m^2\"", by_rate), &mesh), [""; 0]);
}

#[test]
fn a_restitution_that_holds_for_nodes_alone_is_told() {
    let case = |restitution: &str, free: &str, damage: &str| {
        let ball = format!(
            "[[bodies]]\nname = \"ball\"\nkind = \"rigid\"\nshape = \"sphere\"\npoint = [\"20 cm\", \"6 cm\", \"20 cm\"]\nradius = \"5 cm\"\n{free}"
        );
        let contact = format!("poisson_ratio = 0.2\ncontact = {{ restitution = {restitution} }}\n");
        let text = BAR
            .replace("poisson_ratio = 0.2\n", &contact)
            .replace("[[supports]]\ngroup = \"x+\"", &format!("{ball}[[supports]]\ngroup = \"x+\""));
        let text = if damage.is_empty() {
            text.replace(
                "[materials.concrete.damage]\ntensile_strength = \"3 MPa\"\nfracture_energy = \"100 J/m^2\"\n",
                "",
            )
        } else {
            text
        };
        let mesh = structured_box([8, 3, 3], Vec3::new(0.4, 0.12, 0.12), None);
        format!("{:?}", said_of(&text, &mesh))
    };
    let free = "free = \"z\"\nmass = \"1 kg\"\ninitial_velocity = { z = \"-1 m/s\" }\n";
    assert!(case("0.5", free, "").contains("holds for single nodes"), "{}", case("0.5", free, ""));
    assert!(!case("0.95", free, "").contains("holds for single nodes"));
    // Discrete elements of what breaks have it.
    assert!(!case("0.5", free, "damage").contains("holds for single nodes"));
}
