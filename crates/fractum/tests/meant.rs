//! Is this the model that was meant? A corpus of mistakes, of which `fractum check` tells nearly all with the right words.

use std::collections::BTreeMap;
use std::fs;

use fractum_mesh::generate::{structured_box, structured_rectangle};
use fractum_mesh::topology::boundary_of_tetrahedra;
use fractum_mesh::{Mesh, MshFormat};

use fractum_math::Vec3;

use crate::common::{Workplace, bar, mesh_bytes};
use crate::warnings::{BAR, halves};

const MISTAKES: &str = include_str!("wrong/meant.toml");

/// A square under in-situ stress, across which a joint goes.
const JOINT: &str = r#"fractum = 1
mesh = { file = "bar.msh", joints = [{ name = "joint", table = [["0 m", "0.11 m", "0.4 m", "0.11 m"]] }] }
[materials.rock]
density = "2600 kg/m^3"
young_modulus = "20 GPa"
poisson_ratio = 0.2
[[bodies]]
name = "rock"
kind = "solid"
group = "body"
material = "rock"
thickness = "100 mm"
[[interfaces]]
group = "joint"
tensile_strength = "1 MPa"
cohesion = "2 MPa"
fracture_energy = "100 J/m^2"
residual_friction_angle = "30 deg"
pressure = "0.1 MPa"
[in_situ]
stress = { xx = "-2 MPa", yy = "-3 MPa" }
groups = ["x-", "x+", "y-", "y+"]
[damping]
mass = "100 1/s"
[solver]
end = "2 ms"
[[probes]]
name = "way"
velocity = { group = "x+", along = "x" }
"#;

/// What is done to a bar that breaks, rests, is heated, struck, or blasted.
fn cases() -> BTreeMap<&'static str, String> {
    let support = "[[supports]]\ngroup = \"x+\"\nvelocity = { x = { ramp = [[\"0 s\", \"0 m/s\"], [\"0.1 ms\", \"1 mm/s\"]] } }\n";
    let end = "end = \"0.3 ms\"";
    let bar = BAR.replace("PLANE", "xyz");
    assert!(bar.contains(support) && bar.contains(end));
    let replaced = |new: &str, at_end: &str| bar.replace(support, new).replace(end, at_end);
    let damage = "[materials.stone.damage]\ncriterion = \"rankine\"\ntensile_strength = \"3 MPa\"\nfracture_energy = \"100 J/m^2\"\n[[bodies]]";
    let pull = "[[probes]]\nname = \"pull\"\nreaction = { group = \"x+\", along = \"x\" }\n";
    let long = "[\"0.1 ms\", \"1 mm/s\"]";
    let broken = bar
        .replacen("[[bodies]]", damage, 1)
        .replace(end, "end = \"3 ms\"")
        .replace("[output]", &format!("{pull}[output]"));
    assert!(broken.contains(long));
    let rest = format!("[[supports]]\ngroup = \"x+\"\ndisplacement = {{ x = \"0.1 mm*t/1 s\" }}\n{pull}");
    let at_rest = replaced(&rest, "kind = \"static\"\nend = \"1 s\"").replace("history = { every = \"20 us\" }", "");
    let pulse = "[[loads]]\ngroup = \"y+\"\npressure = { pulse = \"half-sine\", peak = \"2 MPa\", start = \"0 s\", duration = \"100 us\" }\n";
    let ball = "[[bodies]]\nname = \"ball\"\nkind = \"rigid\"\nshape = \"sphere\"\npoint = [\"20 cm\", \"141 mm\", \"6 cm\"]\nradius = \"20 mm\"\nvelocity = { y = \"-1 m/s\" }\n";
    let heat = "[materials.stone.thermal]\nconductivity = \"3 W/(m K)\"\nheat_capacity = \"800 J/(kg K)\"\n[[bodies]]";
    let conditions = "[heat]\ninitial_temperature = \"300 K\"\n[[heat.conditions]]\ngroup = \"x+\"\ntemperature = \"400 K\"\n[solver]";
    let heated = replaced("", "kind = \"heat\"\nend = \"5000 s\"").replacen("[[bodies]]", heat, 1);
    let heated = heated.replace("[[supports]]\ngroup = \"x-\"\nfix = \"xyz\"\n", "").replace("[solver]", conditions);
    BTreeMap::from([
        ("broken", broken),
        ("static", at_rest),
        ("blast", replaced(pulse, "end = \"0.2 ms\"").replace("fix = \"xyz\"", "absorbing = true")),
        ("tool", replaced(ball, "end = \"2 ms\"")),
        ("heated", heated.replace("history = { every = \"20 us\" }", "")),
        ("plate", BAR.replace("PLANE", "xy")),
        ("joint", JOINT.to_owned()),
        ("bead", crate::told::BEAD.to_owned()),
        ("bar", bar),
    ])
}

fn mesh(name: &str) -> Mesh {
    let plate = || structured_rectangle([8, 4], [0.4, 0.2], None);
    let scaled = |by: f64, away: f64| {
        let mut mesh = bar();
        mesh.nodes.iter_mut().for_each(|node| *node = *node * by + Vec3::new(away, 0.0, 0.0));
        mesh
    };
    match name {
        "bar" => bar(),
        "plate" => plate(),
        "halves" => halves(bar(), false),
        "thousandfold" => scaled(1e3, 0.0),
        "far" => scaled(1.0, 1e8),
        "shifted" => {
            let mut mesh = halves(bar(), true);
            let half = mesh.nodes.len() / 2;
            mesh.nodes[half..].iter_mut().for_each(|node| node.x -= 0.08);
            mesh
        }
        other => panic!("{other}"),
    }
}

/// A box as an STL file.
fn stl_box(corner: [f64; 3], size: [f64; 3]) -> String {
    let mesh = structured_box([1; 3], Vec3::from(size), None);
    let at = |node: u32| mesh.nodes[node as usize] + Vec3::from(corner);
    let vertex = |x: Vec3| format!("vertex {} {} {}\n", x.x, x.y, x.z);
    let facet = |nodes: [u32; 3]| {
        let corners: String = nodes.map(|node| vertex(at(node))).concat();
        format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n")
    };
    let facets: String = boundary_of_tetrahedra(&mesh.tetrahedra).iter().map(|side| facet(side.nodes)).collect();
    format!("solid box\n{facets}endsolid box\n")
}

#[test]
fn nearly_all_mistakes_are_told() {
    let table: toml::Table = MISTAKES.parse().unwrap();
    let mistakes = table["mistake"].as_array().unwrap();
    assert!(mistakes.len() + crate::warnings::mistakes().len() >= 120, "{}", mistakes.len());
    let cases = cases();
    let place = Workplace::new("");
    fs::write(place.path("bead.csv"), "0,0,0.01,0.01\n").unwrap();
    fs::write(place.path("deep.csv"), "0,0,0.005,0.01\n").unwrap();
    fs::write(place.path("grains.csv"), "0.233,0.11,0.053,0.001\n0.333,0.11,0.053,0.001\n0.433,0.11,0.053,0.001\n")
        .unwrap();
    fs::write(place.path("tooth.stl"), stl_box([231.0, 90.0, 51.0], [5.0, 50.0, 5.0])).unwrap();
    fs::write(place.path("words.csv"), "a bead of ten millimetres\n").unwrap();
    let mesh_of = |case: &str| if ["plate", "joint"].contains(&case) { "plate" } else { "bar" };
    let checked = |case: &str, name: &str| {
        fs::write(place.path("bar.msh"), mesh_bytes(&mesh(name), MshFormat::V4_1Binary)).unwrap();
        let case = if name == "plate" { case.replace("\"xyz\"", "\"xy\"") } else { case.to_owned() };
        fs::write(place.path("case.toml"), case).unwrap();
        place.fractum(&["check", "case.toml"])
    };
    for (name, case) in &cases {
        let ended = checked(case, mesh_of(name));
        let right = ended.code == Some(0) && !ended.stdout.contains("warning: ");
        assert!(right, "the case {name} that is spoilt is right: {} {}", ended.stdout, ended.stderr);
    }
    let mut missed = Vec::new();
    for mistake in mistakes {
        let text = |key: &str| mistake.get(key).map(|text| text.as_str().unwrap());
        let (of, old, new) = (text("of").unwrap(), text("old").unwrap(), text("new").unwrap());
        let says = text("says").unwrap();
        assert!(old.is_empty() || cases[of].contains(old), "{of} holds no {old}");
        let case = if old.is_empty() { cases[of].clone() } else { cases[of].replacen(old, new, 1) };
        let ended = checked(&case, text("mesh").unwrap_or(mesh_of(of)));
        let mut lines = ended.stderr.lines().chain(ended.stdout.lines().filter(|line| line.contains("warning: ")));
        if !lines.any(|line| line.contains(says)) {
            missed.push(format!("{of}: {old} -> {new}\n  wanted {says}\n  {} {}", ended.stderr, ended.stdout));
        }
    }
    assert!(missed.is_empty(), "{} of {} missed:\n{}", missed.len(), mistakes.len(), missed.join("\n"));
}

/// A second body of the far half, which `halves` makes.
const FAR: &str =
    "[[bodies]]\nname = \"far\"\nkind = \"solid\"\ngroup = \"far\"\nmaterial = \"stone\"\n[[supports]]\ngroup = \"x-\"";

#[test]
fn blocks_whose_nodes_are_joined_are_as_one_mesh() {
    let cases = cases();
    for (of, scale) in [("broken", 1.0), ("static", 1.0), ("static", 1e3), ("plate", 1e3)] {
        let base = || mesh(if of == "plate" { "plate" } else { "bar" });
        let (unit, fix) = (if scale > 1.0 { "unit = \"mm\"\n" } else { "" }, if of == "plate" { "xy" } else { "xyz" });
        let case = cases[of].replacen("[[supports]]\ngroup = \"x-\"", FAR, 1).replace("\"xyz\"", &format!("\"{fix}\""));
        // What acts on the side of the second body, and a probe of it.
        let load = "[[loads]]\ngroup = \"y+\"\npressure = \"1 kPa\"\n[solver]";
        let case = case.replace("[solver]", load);
        let ended = |apart: bool| {
            let mut mesh = halves(base(), apart);
            mesh.nodes.iter_mut().for_each(|node| *node *= scale);
            let join = if apart { "join = [\"far\", \"bar\"]\n" } else { "" };
            let case = case.replace("[mesh]\n", &format!("[mesh]\n{unit}{join}"));
            let place = Workplace::with_mesh(&case, &mesh_bytes(&mesh, MshFormat::V4_1Binary));
            let summary = crate::common::run(&place, "out", "1");
            let log = fs::read_to_string(place.path("out/run.log")).unwrap();
            let told = log.contains("\"far\" and \"bar\" joined at") && log.contains("such as that at (");
            assert_eq!(told, apart, "{log}");
            assert!(!log.contains("[coincident-nodes]"), "{log}");
            summary
        };
        let (joined, one) = (ended(true), ended(false));
        assert_eq!(joined["state_hash"], one["state_hash"], "{of}");
        assert_eq!(joined["probes"], one["probes"], "{of}");
    }
}

#[test]
fn a_mesh_without_groups_is_one_body() {
    let mut mesh = bar();
    mesh.groups.clear();
    let by_place = |case: &str| {
        case.replace("group = \"x-\"", "where = \"x < 1 mm\"").replace("group = \"x+\"", "where = \"x > 399 mm\"")
    };
    let case = by_place(&BAR.replace("PLANE", "xyz").replace("group = \"body\"\n", ""));
    let place = Workplace::with_mesh(&case, &mesh_bytes(&mesh, MshFormat::V2_2Ascii));
    let ended = place.fractum(&["run", "case.toml", "-o", "out", "--quiet", "--strict"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let with_group = by_place(&BAR.replace("PLANE", "xyz"));
    let other = Workplace::new(&with_group);
    assert_eq!(other.fractum(&["run", "case.toml", "-o", "out", "--quiet"]).code, Some(0));
    let of = |place: &Workplace| crate::common::summary(place, "out")["counts"]["elements"].clone();
    assert_eq!(of(&place), of(&other));
    // A group is told to be missing where a body is asked for by a name that the mesh does not know.
    fs::write(place.path("case.toml"), with_group).unwrap();
    let ended = place.fractum(&["check", "case.toml"]);
    assert!(ended.code == Some(1) && ended.stderr.contains("groups there: none; leave group out"), "{}", ended.stderr);
}

#[test]
fn the_peak_velocity_of_a_group_is_that_of_its_fastest_node() {
    let thrown = "group = \"body\"\ninitial_velocity = { y = \"x*1 m/s/40 cm\" }";
    let stations = "[[output.ppv]]\nname = \"side\"\nhole = \"x-\"\ncentre = [\"-1 m\", 0, 0]\ngroups = [\"y+\"]";
    let free = BAR.split("[[supports]]").next().unwrap().replace("group = \"body\"", thrown);
    let case = format!("{free}{stations}\n[solver]\nend = \"5 us\"\n");
    let place = Workplace::new(&case);
    let summary = crate::common::run(&place, "out", "1");
    let station = &summary["ppv"][0]["stations"][0];
    let [velocity, x] = [&station["velocity"], &station["place"][0]].map(|value| value.as_f64().unwrap());
    assert!((velocity - 1.0).abs() < 0.02 && (x - 0.4).abs() < 1e-9, "{station}");
}

#[test]
fn a_small_drop_before_the_peak_ends_no_run() {
    // A drop to 0.6 of the first peak at 0.2 s, then twice that peak at 0.5 s, and down.
    let pull = "displacement = { x = { ramp = [[\"0 s\", 0], [\"0.2 s\", \"2 um\"], [\"0.22 s\", \"1.2 um\"], [\"0.24 s\", \"2 um\"], [\"0.5 s\", \"4 um\"], [\"1 s\", \"0.8 um\"]] } }";
    let case = cases()["static"].replace("displacement = { x = \"0.1 mm*t/1 s\" }", pull);
    let ended = |below: &str| {
        let stop = format!("stop_when = {{ probe = \"pull\", below = {below} }}\nstep = \"0.01 s\"\nend = \"1 s\"");
        let place = Workplace::new(&case.replace("end = \"1 s\"", &stop));
        let summary = crate::common::run(&place, "out", "1");
        let [end, max] =
            [&summary["time"]["end"], &summary["probes"]["pull"]["max"]].map(|value| value.as_f64().unwrap());
        let log = fs::read_to_string(place.path("out/run.log")).unwrap();
        let told = log.lines().find(|line| line.contains("ends early")).unwrap().to_owned();
        (end, max, format!("{told} {}", summary["time"]["reason"].as_str().unwrap()))
    };
    let (early, first, reason) = ended("0.7, lasting = \"0 s\"");
    assert!(early < 0.23 && reason.contains("whether it would rise again is not known"), "{early} {reason}");
    // Below 0.7 at 0.688 s, and for a quarter of the 0.5 s to the peak at 0.813 s; below 0.9 at 0.563 s, and below half at 0.813 s.
    for (below, [from, to]) in [("0.9", [0.69, 0.71]), ("0.7", [0.8, 0.83]), ("0.5", [0.8, 0.83]), ("0.4", [0.87, 0.9])]
    {
        let (late, peak, reason) = ended(below);
        assert!(from < late && late < to && (peak / first - 2.0).abs() < 0.02, "{below}: {late} {peak} {first}");
        let waits = reason.contains("for 25 % of the time that the peak took, or below 50 % of it");
        assert_eq!(waits, below > "0.5", "{reason}");
    }
    let (late, ..) = ended("0.9, lasting = \"0.2 s\"");
    assert!(0.75 < late && late < 0.79, "{late}");
}

#[test]
fn the_plan_tells_what_makes_another_model() {
    let case = cases()["static"]
        .replace("file = \"bar.msh\"", "file = \"bar.msh\"\nhalvings = 1\nscramble = { share = 0.2, seed = 5 }");
    let place = Workplace::new(&case);
    let set = |more: &[&str]| place.fractum(&[&["check", "case.toml"], more].concat()).stdout;
    let told = set(&["--set", "verify.scale=1000"]);
    for says in [
        "verify.scale: lengths and times are 1000 times",
        "mesh.halvings: elements 2 times smaller than in the file, 8 for each",
        "mesh.scramble: inner nodes moved at random by up to 20 % of their shortest edge, seed 5",
    ] {
        let one_line = told.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(one_line.contains(says), "{says}: {told}");
    }
    assert!(!set(&[]).contains("verify.scale"));
}

#[test]
fn stiffnesses_that_differ_by_a_million_are_solved_by_iteration_too() {
    let second = "[materials.hard]\ndensity = 2400\nyoung_modulus = \"1 TPa\"\npoisson_ratio = 0\n[[bodies]]\nname = \"far\"\nkind = \"solid\"\ngroup = \"far\"\nmaterial = \"hard\"\n[[supports]]\ngroup = \"x-\"";
    let case = cases()["static"].replace("[[supports]]\ngroup = \"x-\"", second).replace("\"30 GPa\"", "\"1 MPa\"");
    let case = case.replace("poisson_ratio = 0.2", "poisson_ratio = 0").replace("0.1 mm*t", "1 um*t");
    let pull = |solver: &str| {
        let case = case.replace("end = \"1 s\"", &format!("linear_solver = \"{solver}\"\nend = \"1 s\""));
        let place = Workplace::with_mesh(&case, &mesh_bytes(&halves(bar(), false), MshFormat::V4_1Binary));
        crate::common::run(&place, "out", "1")["probes"]["pull"]["final"].as_f64().unwrap()
    };
    // The soft half of 0.2 m takes all of the micrometre.
    let exact = 1e6 * 0.12 * 0.12 * 1e-6 / 0.2;
    for solver in ["direct", "iterative"] {
        let found = pull(solver);
        assert!((found / exact - 1.0).abs() < 1e-3, "{solver}: {found} for {exact}");
    }
}

/// Plates of 10 and 30 mm beside each other under a load along y, at rest.
const PLATES: &str = r#"fractum = 1
[mesh]
file = "bar.msh"
[materials.stone]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0.2
[[bodies]]
name = "thin"
kind = "solid"
group = "body"
material = "stone"
plane = "stress"
thickness = "10 mm"
[[bodies]]
name = "thick"
kind = "solid"
group = "far"
material = "stone"
plane = "stress"
thickness = "30 mm"
[[supports]]
group = "x-"
fix = "x"
[[supports]]
group = "x+"
fix = "x"
[[supports]]
group = "y-"
fix = "y"
[[loads]]
group = "y+"
LOAD
[solver]
kind = "static"
end = "1 s"
[[probes]]
name = "thin"
displacement = { where = "x < 19 cm && y > 19 cm", along = "y" }
[[probes]]
name = "thick"
displacement = { where = "x > 21 cm && y > 19 cm", along = "y" }
[[probes]]
name = "reaction"
reaction = { group = "y-", along = "y" }
[[probes]]
name = "area"
surface = { group = "y+", measure = "area" }
"#;

#[test]
fn every_plate_has_its_own_thickness() {
    let mesh = mesh_bytes(&halves(mesh("plate"), true), MshFormat::V4_1Binary);
    for load in ["pressure = \"-3 MPa\"", "traction = { y = \"3 MPa\" }", "force = { y = \"24 kN\" }"] {
        let place = Workplace::with_mesh(&PLATES.replace("LOAD", load), &mesh);
        let summary = crate::common::run(&place, "out", "1");
        let expected = [("thin", 2e-5), ("thick", 2e-5), ("reaction", -24e3), ("area", 8e-3)];
        for (name, expected) in expected {
            let found = summary["probes"][name]["final"].as_f64().unwrap();
            assert!((found / expected - 1.0).abs() < 1e-3, "{load}: {name} {found}, expected {expected}");
        }
        let log = fs::read_to_string(place.path("out/run.log")).unwrap();
        assert!(load.starts_with("force") || log.contains("y+ (0.008 m²)"), "{log}");
    }
}

#[test]
fn facets_of_a_load_that_lie_within_the_bodies_are_told() {
    let mut mesh = bar();
    let sorted = |mut nodes: [u32; 3]| {
        nodes.sort_unstable();
        nodes
    };
    let outer: Vec<[u32; 3]> = mesh.triangles.iter().map(|nodes| sorted(*nodes)).collect();
    let mut sides = mesh.tetrahedra.iter().map(|&[a, b, c, _]| sorted([a, b, c]));
    let inner = sides.find(|side| !outer.contains(side)).unwrap();
    let index = mesh.triangles.len() as u32;
    mesh.triangles.push(inner);
    mesh.triangle_tags.push(1_000_000);
    mesh.groups.iter_mut().find(|group| group.name == "y+").unwrap().triangles.push(index);
    let load = "[[loads]]\ngroup = \"y+\"\ntraction = { y = \"1 MPa*t/1 s\" }\n[solver]";
    let pull = cases()["static"].replace("[solver]", load);
    let place = Workplace::with_mesh(&pull, &mesh_bytes(&mesh, MshFormat::V4_1Binary));
    let ended = place.fractum(&["check", "case.toml"]);
    assert!(
        ended.stdout.contains("\"y+\": 1 of its") && ended.stdout.contains("[beyond-bodies]"),
        "{} {}",
        ended.stdout,
        ended.stderr
    );
}

#[test]
fn a_force_on_elements_is_shared_by_their_volume() {
    // Elements that grow from end to end: u = F L/(2 E A) at the free end of a bar under a force all along it.
    let graded = |mut mesh: Mesh| {
        mesh.nodes.iter_mut().for_each(|node| node.x = 0.4 * (node.x / 0.4).powi(3));
        mesh
    };
    let plane = graded(structured_rectangle([32, 4], [0.4, 0.2], None));
    let space = graded(structured_box([32, 4, 4], Vec3::new(0.4, 0.2, 0.01), None));
    for (mesh, plate) in [(plane, "plane = \"stress\"\nthickness = \"10 mm\"\n"), (space, "")] {
        let case = PLATES.split("[[bodies]]").next().unwrap().replace("poisson_ratio = 0.2", "poisson_ratio = 0");
        let body =
            format!("[[bodies]]\nname = \"bar\"\nkind = \"solid\"\ngroup = \"body\"\nmaterial = \"stone\"\n{plate}");
        let held =
            "[[supports]]\ngroup = \"x-\"\nfix = \"xyz\"\n[[loads]]\ngroup = \"body\"\nforce = { x = \"6 kN\" }\n";
        let held = if plate.is_empty() { held.to_owned() } else { held.replace("xyz", "xy") };
        let rest = "[solver]\nkind = \"static\"\nend = \"1 s\"\n[[probes]]\nname = \"end\"\ndisplacement = { group = \"x+\", along = \"x\" }\n";
        let place =
            Workplace::with_mesh(&format!("{case}{body}{held}{rest}"), &mesh_bytes(&mesh, MshFormat::V4_1Binary));
        let summary = crate::common::run(&place, "out", "1");
        let found = summary["probes"]["end"]["final"].as_f64().unwrap();
        let expected = 6e3 * 0.4 / (2.0 * 30e9 * 0.2 * 0.01);
        assert!((found / expected - 1.0).abs() < 0.01, "{found}, expected {expected}");
    }
}

#[test]
fn a_force_on_elements_around_an_axis_is_shared_by_the_volume_of_their_rings() {
    let mut mesh = structured_rectangle([6, 24], [0.2, 0.4], None);
    mesh.nodes.iter_mut().for_each(|node| node.x = 0.2 * (node.x / 0.2).powi(2));
    let case = PLATES.split("[[bodies]]").next().unwrap().replace("poisson_ratio = 0.2", "poisson_ratio = 0");
    let rest = "[[bodies]]\nname = \"rod\"\nkind = \"solid\"\ngroup = \"body\"\nmaterial = \"stone\"\nplane = \"axisymmetric\"\n\
                [[supports]]\ngroup = \"y-\"\nfix = \"y\"\n[[loads]]\ngroup = \"body\"\nforce = { y = \"60 kN\" }\n\
                [solver]\nkind = \"static\"\nend = \"1 s\"\n\
                [[probes]]\nname = \"axis\"\ndisplacement = { group = \"y+\", where = \"x < 1 mm\", along = \"y\" }\n\
                [[probes]]\nname = \"rim\"\ndisplacement = { group = \"y+\", where = \"x > 19 cm\", along = \"y\" }\n";
    let place = Workplace::with_mesh(&format!("{case}{rest}"), &mesh_bytes(&mesh, MshFormat::V4_1Binary));
    let summary = crate::common::run(&place, "out", "1");
    // A rod under its weight: u = F L/(2 E A).
    let expected = 60e3 * 0.4 / (2.0 * 30e9 * std::f64::consts::PI * 0.2 * 0.2);
    for name in ["axis", "rim"] {
        let found = summary["probes"][name]["final"].as_f64().unwrap();
        assert!((found / expected - 1.0).abs() < 0.01, "{name}: {found}, expected {expected}");
    }
}

#[test]
fn a_name_that_means_a_body_and_a_group_of_the_mesh_is_refused() {
    let probe = "[[probes]]\nname = \"sunk\"\ndisplacement = { group = \"y+\", along = \"y\" }\n[solver]";
    let tool = cases()["tool"].replace("[solver]", probe);
    for (name, is_told) in [("y+", true), ("ball", false)] {
        let place = Workplace::new(&tool.replace("name = \"ball\"", &format!("name = \"{name}\"")));
        let ended = place.fractum(&["check", "case.toml"]);
        let told = ended.stderr.contains("a body and a group of the mesh have this name");
        assert_eq!((told, ended.code), (is_told, Some(i32::from(is_told))), "{} {}", ended.stdout, ended.stderr);
    }
}
