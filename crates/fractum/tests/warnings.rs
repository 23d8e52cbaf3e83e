//! One list of warnings: terminal, log, report, summary and page say the same, and a resumed run says it again.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use fractum_math::Vec3;
use fractum_mesh::generate::{structured_box, structured_rectangle};
use fractum_mesh::{Group, Mesh, MshFormat};
use fractum_output::warning::Code;
use serde_json::Value;

use crate::common::{Workplace, bar, mesh_bytes, resumed, run, summary};

/// A block whose heat sink cools it below zero, with a parameter that nothing uses.
const FROZEN: &str = r#"fractum = 1
[parameters]
spare = 1
[mesh]
file = "bar.msh"
[materials.steel]
density = "7800 kg/m^3"
young_modulus = "200 GPa"
poisson_ratio = 0.3
[materials.steel.thermal]
conductivity = "50 W/(m K)"
heat_capacity = "500 J/(kg K)"
expansion = "1e-5 1/K"
[[bodies]]
name = "bar"
kind = "solid"
group = "body"
material = "steel"
[heat]
initial_temperature = "20 K"
step = "20 us"
[[heat.conditions]]
group = "body"
source = "-4e10 W/m^3"
[[supports]]
group = "x-"
fix = "x"
[solver]
end = "4 ms"
[output]
history = { every = "0.1 ms" }
fields = { every = "4 ms" }
"#;

/// Code, place and text of all warnings of a results folder.
pub(crate) fn listed(place: &Workplace, folder: &str) -> Vec<[String; 3]> {
    let summary = summary(place, folder);
    let text = |warning: &Value, key: &str| warning[key].as_str().unwrap_or_else(|| panic!("{warning}")).to_owned();
    let all = summary["warnings"].as_array().unwrap().iter();
    all.map(|warning| ["code", "where", "text"].map(|key| text(warning, key))).collect()
}

#[test]
fn the_page_explains_every_code_and_no_other() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/warnings.md");
    let page = fs::read_to_string(page).unwrap();
    let rows = page.lines().filter_map(|line| line.strip_prefix("| `")?.split_once('`'));
    let listed: Vec<&str> = rows.map(|(code, _)| code).collect();
    let known: BTreeSet<&str> = Code::ALL.iter().map(|code| code.name()).collect();
    assert_eq!(listed.iter().copied().collect::<BTreeSet<_>>(), known);
    assert_eq!(listed.len(), known.len(), "each once");
}

#[test]
fn every_place_shows_the_same_warnings_once() {
    let place = Workplace::new(FROZEN);
    let ended = place.fractum(&["run", "case.toml", "-o", "out", "--quiet", "--threads", "1"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let all = listed(&place, "out");
    let codes: Vec<&str> = all.iter().map(|[code, ..]| code.as_str()).collect();
    assert_eq!(codes, ["unused", "below-zero"], "{all:?}");
    assert_eq!(all[0][1], "case.toml:3:9");
    assert!(all[1][1].starts_with("node at (") && all[1][1].contains("t = "), "{all:?}");
    let [log, report] =
        ["run.log", "report.html"].map(|name| fs::read_to_string(place.path("out").join(name)).unwrap());
    for [code, where_, text] in &all {
        for (shown, what) in [(&ended.stderr, "terminal"), (&log, "log"), (&report, "report")] {
            let lines: Vec<&str> =
                shown.split(['\n', '<']).filter(|line| line.contains(&format!("[{code}]"))).collect();
            assert_eq!(lines.len(), 1, "{what}: {lines:?}");
            assert!(lines[0].contains(where_.as_str()) && lines[0].contains(text.as_str()), "{what}: {}", lines[0]);
        }
    }
    let head = report.find("[below-zero]").unwrap();
    assert!(head < report.find("<h2>").unwrap(), "warnings stand at the head of the report");
}

#[test]
fn a_resumed_run_has_the_warnings_of_the_steps_before_it() {
    let place = Workplace::new(&FROZEN.replace("[output]\n", "[output]\ncheckpoint = { steps = 650 }\n"));
    run(&place, "out", "1");
    let before = listed(&place, "out");
    assert!(before.iter().any(|[code, ..]| code == "below-zero"), "{before:?}");
    resumed(&place, "out");
    assert_eq!(listed(&place, "out"), before);
    // The state has them, so that nothing is told twice.
    let log = fs::read_to_string(place.path("out/run.log")).unwrap();
    assert_eq!(log.matches("[below-zero]").count(), 2, "once for each of both runs: {log}");
}

/// What a step has noticed is told at the next look, or at the end: a state in between has it.
#[test]
fn what_was_noticed_but_not_told_outlives_a_resume() {
    let text = BAR.replace("PLANE", "x").replace("every = \"20 us\"", "every = \"1 us\"");
    let place = Workplace::new(&(text + "checkpoint = { steps = 1 }\n[damping]\nmass = \"20000 1/s\"\n"));
    fs::write(place.path("bar.msh"), mesh_bytes(&bar(), MshFormat::V4_1Binary)).unwrap();
    let whole = run(&place, "out", "1");
    let steps = whole["time"]["steps"].as_u64().unwrap();
    assert!(steps < 128, "no look before the end: {steps} steps");
    let before = listed(&place, "out");
    assert!(before.iter().any(|[code, ..]| code == "damping"), "{before:?}");
    resumed(&place, "out");
    assert_eq!(listed(&place, "out"), before);
}

#[test]
fn strict_makes_warnings_errors() {
    let place = Workplace::new(FROZEN);
    for command in [&["check", "case.toml"][..], &["run", "case.toml", "-o", "out"]] {
        let ended = place.fractum(&[command, &["--strict"]].concat());
        let right = ended.stderr.contains("case.toml:3:9: parameters.spare") && ended.stderr.contains("[unused]");
        assert!(ended.code == Some(1) && right && !ended.stderr.contains("warning: "), "{}", ended.stderr);
    }
    assert!(!place.path("out/summary.json").exists());
    fs::write(place.path("case.toml"), FROZEN.replace("[parameters]\nspare = 1\n", "")).unwrap();
    assert_eq!(place.fractum(&["check", "case.toml", "--strict"]).code, Some(0));
    // What the run finds ends it, with its results and its last state.
    let ended = place.fractum(&["run", "case.toml", "-o", "out", "--strict", "--quiet", "--threads", "1"]);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(ended.stderr.contains("[below-zero]") && ended.stderr.contains("last good state"), "{}", ended.stderr);
    let summary = summary(&place, "out");
    assert_eq!(summary["status"], "stopped");
    assert!(summary["time"]["end"].as_f64().unwrap() < 4e-3);
}

/// A bar in space or in the plane, right as it stands.
pub(crate) const BAR: &str = r#"fractum = 1
[mesh]
file = "bar.msh"
[materials.stone]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0.2
[[bodies]]
name = "bar"
kind = "solid"
group = "body"
material = "stone"
[[supports]]
group = "x-"
fix = "PLANE"
[[supports]]
group = "x+"
velocity = { x = { ramp = [["0 s", "0 m/s"], ["0.1 ms", "1 mm/s"]] } }
[solver]
end = "0.3 ms"
[output]
history = { every = "20 us" }
"#;

const WALL: &str =
    "[[bodies]]\nname = \"wall\"\nkind = \"rigid\"\nshape = \"plane\"\nnormal = \"x\"\npoint = [\"-0.1 mm\", 0, 0]\n";
/// Bonds that a solid has not, and damage that a plate has not which does not deform.
const FRACTURE: &str = "[materials.stone.fracture]\ntensile_strength = \"3 MPa\"\n[[bodies]]";
const BROKEN_PLATE: &str = "[materials.glass]\ndensity = \"2500 kg/m^3\"\nyoung_modulus = \"70 GPa\"\npoisson_ratio = 0.2\n\
[materials.glass.damage]\ntensile_strength = \"30 MPa\"\nfracture_energy = \"10 J/m^2\"\n\
[[bodies]]\nname = \"plate\"\nkind = \"rigid\"\nshape = \"plane\"\nnormal = \"x\"\npoint = [\"-0.1 mm\", 0, 0]\nmaterial = \"glass\"\n[[bodies]]";
const GRAVITY: &str = "[[loads]]\ngravity = { z = \"-9.81 m/s^2\" }\n[solver]";

const DAMAGE: &str = "[materials.stone.damage]\ncriterion = \"rankine\"\ntensile_strength = \"3 MPa\"\nfracture_energy = \"100 J/m^2\"\n[[bodies]]";

/// Moves the elements of the far half into a group of their own; `apart` gives that half nodes of its own.
pub(crate) fn halves(mut mesh: Mesh, apart: bool) -> Mesh {
    let middle = 0.5 * (mesh.bounding_box().0.x + mesh.bounding_box().1.x);
    let twins = (apart).then(|| {
        let count = mesh.nodes.len() as u32;
        let nodes = mesh.nodes.clone();
        mesh.nodes.extend(nodes);
        mesh.node_tags = (1..=mesh.nodes.len() as u64).collect();
        count
    });
    let is_far = |nodes: &[u32], mesh: &Mesh| {
        nodes.iter().map(|&n| mesh.nodes[n as usize].x).sum::<f64>() > middle * nodes.len() as f64
    };
    let far_tetrahedra: Vec<bool> = mesh.tetrahedra.iter().map(|nodes| is_far(nodes, &mesh)).collect();
    let far_triangles: Vec<bool> = mesh.triangles.iter().map(|nodes| is_far(nodes, &mesh)).collect();
    let far_lines: Vec<bool> = mesh.lines.iter().map(|nodes| is_far(nodes, &mesh)).collect();
    let shift = twins.unwrap_or(0);
    for (nodes, _) in mesh.tetrahedra.iter_mut().zip(&far_tetrahedra).filter(|(_, far)| **far) {
        nodes.iter_mut().for_each(|node| *node += shift);
    }
    for (nodes, _) in mesh.triangles.iter_mut().zip(&far_triangles).filter(|(_, far)| **far) {
        nodes.iter_mut().for_each(|node| *node += shift);
    }
    for (nodes, _) in mesh.lines.iter_mut().zip(&far_lines).filter(|(_, far)| **far) {
        nodes.iter_mut().for_each(|node| *node += shift);
    }
    let body = mesh.groups.iter().position(|group| group.name == "body").unwrap();
    let mut far = Group { name: "far".into(), tag: 99, ..mesh.groups[body].clone() };
    far.tetrahedra.retain(|&element| far_tetrahedra[element as usize]);
    far.triangles.retain(|&element| far_triangles[element as usize]);
    mesh.groups[body].tetrahedra.retain(|&element| !far_tetrahedra[element as usize]);
    mesh.groups[body].triangles.retain(|&element| !far_triangles[element as usize]);
    mesh.groups.push(far);
    mesh
}

/// Moves the half with nodes of its own away.
fn away(mut mesh: Mesh, by: f64) -> Mesh {
    let count = mesh.nodes.len() / 2;
    mesh.nodes[count..].iter_mut().for_each(|node| node.x += by);
    mesh
}

/// The bar with an upper side that is no plane.
fn channel() -> Mesh {
    let mut mesh = bar();
    mesh.nodes.iter_mut().for_each(|node| node.y *= 1.0 + 4.0 * (node.x - 0.2).powi(2));
    mesh
}

fn plate() -> Mesh {
    structured_rectangle([8, 4], [0.4, 0.2], None)
}

/// A second body of the far half.
fn second(keys: &str) -> String {
    format!(
        "[[bodies]]\nname = \"far\"\nkind = \"solid\"\ngroup = \"far\"\nmaterial = \"stone\"\n{keys}[[supports]]\ngroup = \"x-\""
    )
}

/// A mistake: mesh, what replaces what, and the code that tells it; those that need a run say so.
pub(crate) struct Mistake {
    mesh: Mesh,
    edits: Vec<(&'static str, String)>,
    code: &'static str,
    runs: bool,
}

/// Rock around a hole that bursts: a piece of it is pressed flat after it has come loose.
#[test]
fn a_crushed_element_is_taken_out_and_told() {
    let case = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/charge/breaking.toml");
    let place = Workplace::new("");
    let poisson_ratio = "materials.rock.poisson_ratio=0.1";
    let ended = place.fractum(&["run", case.to_str().unwrap(), "-o", "results", "--set", poisson_ratio]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let summary = summary(&place, "results");
    assert!(summary["counts"]["crushed_elements"].as_u64().unwrap() > 0, "{}", summary["counts"]);
    assert!(listed(&place, "results").iter().any(|[code, ..]| code == "crushed"));
    assert!(summary["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-3, "{}", summary["energy"]);
}

pub(crate) fn mistakes() -> Vec<Mistake> {
    let [checked, moving] = [false, true].map(|runs| {
        move |code: &'static str, mesh: Mesh, edits: &[(&'static str, &str)]| {
            let edits = edits.iter().map(|(old, new)| (*old, (*new).to_owned())).collect();
            Mistake { mesh, edits, code, runs }
        }
    });
    let support = "[[supports]]\ngroup = \"x-\"";
    let (ramp, end) = ("{ ramp = [[\"0 s\", \"0 m/s\"], [\"0.1 ms\", \"1 mm/s\"]] }", "end = \"0.3 ms\"");
    let static_end = "kind = \"static\"\nend = \"0.3 ms\"";
    let load = |text: &str| format!("[[loads]]\ngroup = \"y+\"\n{text}\n[solver]");
    let pulse = |start: &str| {
        load(&format!(
            "pressure = {{ pulse = \"half-sine\", peak = \"1 MPa\", start = \"{start}\", duration = \"0.4 ms\" }}"
        ))
    };
    let far_support = &BAR[BAR.rfind("[[supports]]").unwrap()..BAR.find("[solver]").unwrap()];
    let loaded_side = (far_support, "[[loads]]\ngroup = \"y+\"\npressure = \"1 kPa\"\n");
    let held_across = ("velocity = { x = ", "fix = \"yz\"\nvelocity = { x = ");
    let unequal = "thickness = \"10 mm\"\n";
    vec![
        checked("left-out", halves(bar(), false), &[loaded_side]),
        checked("left-out", halves(plate(), false), &[loaded_side]),
        checked("beyond-bodies", halves(bar(), false), &[loaded_side]),
        checked("coincident-nodes", halves(bar(), true), &[(support, &second("")), (end, static_end), held_across]),
        checked("coincident-nodes", halves(plate(), true), &[(support, &second(""))]),
        checked("unequal-plates", halves(plate(), false), &[(support, &second(unequal))]),
        checked("unequal-plates", halves(plate(), false), &[(support, &second("plane = \"stress\"\n"))]),
        checked("coincident-nodes", halves(bar(), true), &[(support, &second(""))]),
        checked(
            "no-contact",
            away(halves(plate(), true), 0.01),
            &[
                ("material = \"stone\"\n[[supports]]", "material = \"stone\"\nplane = \"axisymmetric\"\n[[supports]]"),
                (support, &second("plane = \"axisymmetric\"\n")),
            ],
        ),
        checked(
            "no-contact",
            away(halves(bar(), true), 1e-4),
            &[(support, &second("")), (end, static_end), held_across],
        ),
        checked("unheld", bar(), &[("[[supports]]\ngroup = \"x-\"\nfix = \"PLANE\"\n", ""), (end, "end = \"4 ms\"")]),
        checked(
            "unheld",
            bar(),
            &[
                ("fix = \"PLANE\"", "fix = \"x\""),
                (end, "end = \"4 ms\""),
                ("[solver]", "[[loads]]\ngroup = \"x+\"\nforce = { y = \"5 N\" }\n[solver]"),
            ],
        ),
        checked(
            "unheld",
            bar(),
            &[
                ("fix = \"PLANE\"", "absorbing = true"),
                (far_support, ""),
                (end, "end = \"4 ms\""),
                ("[solver]", "[[loads]]\ngravity = { x = \"-9.81 m/s^2\" }\n[solver]"),
            ],
        ),
        checked(
            "unheld",
            bar(),
            &[
                ("fix = \"PLANE\"", "absorbing = true"),
                (far_support, ""),
                ("[solver]", "[[loads]]\ngravity = { x = \"-9.81 m/s^2\" }\n[solver]"),
            ],
        ),
        checked("no-effect", bar(), &[("[[bodies]]", FRACTURE)]),
        checked("no-effect", bar(), &[("[[bodies]]", BROKEN_PLATE)]),
        checked("unused", bar(), &[("[[bodies]]", "[pulses]\ncut = \"1 MPa\"\n[[bodies]]")]),
        checked("thin-mesh", structured_rectangle([16, 2], [0.4, 0.05], None), &[("{ x = {", "{ y = {")]),
        checked("thin-mesh", structured_box([8, 8, 1], Vec3::new(0.4, 0.4, 0.02), None), &[("{ x = {", "{ z = {")]),
        checked("thin-mesh", structured_box([16, 2, 2], Vec3::new(0.4, 0.05, 0.05), None), &[("[solver]", GRAVITY)]),
        checked("thin-mesh", structured_rectangle([32, 4], [0.4, 0.05], None), &[("{ x = {", "{ y = {")]),
        checked("locking", bar(), &[("poisson_ratio = 0.2", "poisson_ratio = 0.49")]),
        checked("locking", plate(), &[("poisson_ratio = 0.2", "poisson_ratio = 0.4999")]),
        checked("suction", channel(), &[("[solver]", &load("pressure = \"-2 MPa\""))]),
        checked(
            "jump",
            bar(),
            &[("velocity = { x = ", "displacement = { x = "), (ramp, "\"if(t < 50 us, 0 m, 10 um)\"")],
        ),
        checked("jump", bar(), &[("[[bodies]]", DAMAGE), (ramp, "\"0.5 m/s\"")]),
        checked("jump", bar(), &[("[solver]", &pulse("-0.1 ms"))]),
        checked("no-effect", bar(), &[("[solver]", &pulse("-2 ms"))]),
        checked("unit-of-load", bar(), &[("[solver]", &load("pressure = 8"))]),
        checked("unit-of-load", bar(), &[("[solver]", &load("pressure = 10"))]),
        checked(
            "unusual-value",
            bar(),
            &[(
                "[solver]",
                &load(
                    "pressure = { pulse = \"half-sine\", peak = \"1 MPa\", duration = \"1 ms\" }\ndetonation = { velocity = \"4.5 m/s\", along = \"x\" }",
                ),
            )],
        ),
        checked("unit-of-motion", bar(), &[(ramp, "\"10 km/s\"")]),
        checked("unusual-value", bar(), &[("density = \"2400 kg/m^3\"", "density = 2.4")]),
        checked("time-step", bar(), &[(end, "safety = 1.2\nend = \"0.3 ms\"")]),
        checked("output-interval", bar(), &[("every = \"20 us\"", "every = \"20 ms\"")]),
        moving(
            "rotation",
            bar(),
            &[
                (ramp, "\"-300 1/s*(y - 6 cm)\""),
                ("fix = \"PLANE\"\n", "velocity = { x = \"-300 1/s*(y - 6 cm)\" }\n"),
                (
                    "material = \"stone\"\n",
                    "material = \"stone\"\nkinematics = \"small\"\ninitial_velocity = { x = \"-300 1/s*(y - 6 cm)\", y = \"300 1/s*(x - 20 cm)\" }\n",
                ),
                (end, "end = \"1 ms\""),
            ],
        ),
        moving(
            "impact-loss",
            structured_box([3, 2, 2], Vec3::new(0.4, 0.12, 0.12), None),
            &[
                ("[[supports]]\ngroup = \"x-\"\nfix = \"PLANE\"\n", WALL),
                (far_support, ""),
                ("[solver]", "[[loads]]\ngravity = { x = \"-4e3 m/s^2\" }\n[solver]"),
                (end, "end = \"0.5 ms\""),
            ],
        ),
        // Half an element gives way beside the bar: a third of its energy under its own weight.
        moving(
            "soft-contact",
            structured_box([3, 2, 2], Vec3::new(0.4, 0.12, 0.12), None),
            &[
                ("[[supports]]\ngroup = \"x-\"\nfix = \"PLANE\"\n", &WALL.replace("-0.1 mm", "0 mm")),
                (far_support, ""),
                ("material = \"stone\"\n", "material = \"stone\"\ninitial_velocity = { x = \"-1 mm/s\" }\n"),
                ("[solver]", "[[loads]]\ngravity = { x = \"-400 m/s^2\" }\n[solver]"),
                (end, "end = \"30 ms\""),
            ],
        ),
        // The false strain of a slow turn is worth as much as the turn.
        moving(
            "change-of-step",
            structured_box([3, 2, 2], Vec3::new(0.4, 0.12, 0.12), None),
            &[
                ("[[supports]]\ngroup = \"x-\"\nfix = \"PLANE\"\n", ""),
                (far_support, ""),
                (
                    "[solver]",
                    "[[loads]]\ngroup = \"x-\"\nforce = { y = \"5 N\" }\n[[loads]]\ngroup = \"x+\"\nforce = { y = \"-5 N\" }\n[solver]",
                ),
                (end, "end = \"40 ms\""),
            ],
        ),
        moving("large-strain", bar(), &[(ramp, "{ ramp = [[\"0 s\", \"0 m/s\"], [\"0.1 ms\", \"-150 m/s\"]] }")]),
        moving(
            "tension-outside",
            bar(),
            &[
                ("[[bodies]]", DAMAGE),
                (
                    "material = \"stone\"\n",
                    "material = \"stone\"\ndamage_where = \"x < 6 cm\"\nstrength_factor = \"if(x < 6 cm, 3, 1)\"\n",
                ),
                (ramp, "{ ramp = [[\"0 s\", \"0 m/s\"], [\"0.1 ms\", \"1 m/s\"]] }"),
            ],
        ),
        moving(
            "tension-outside",
            bar(),
            &[
                ("[[bodies]]", DAMAGE),
                (
                    "material = \"stone\"\n",
                    "material = \"stone\"\nformulation = \"standard\"\ndamage_where = \"x < 6 cm\"\nstrength_factor = \"if(x < 6 cm, 3, 1)\"\n",
                ),
                (ramp, "{ ramp = [[\"0 s\", \"0 m/s\"], [\"0.1 ms\", \"1 m/s\"]] }"),
                // Before the wave comes back.
                (end, "end = \"0.15 ms\""),
            ],
        ),
        moving(
            "compression",
            bar(),
            &[("[[bodies]]", DAMAGE), (ramp, "{ ramp = [[\"0 s\", \"0 m/s\"], [\"0.1 ms\", \"-10 m/s\"]] }")],
        ),
        moving(
            "single-nodes",
            bar(),
            &[
                ("[[bodies]]", DAMAGE),
                (ramp, "\"20 m/s\""),
                ("[solver]", "[[probes]]\nname = \"out\"\nvelocity = { group = \"x+\", along = \"x\" }\n[solver]"),
            ],
        ),
        moving("damping", bar(), &[(end, "end = \"2 ms\"\n[damping]\nmass = \"1e6 1/s\"")]),
    ]
}

#[test]
fn mistakes_are_told_with_their_code() {
    for plane in [false, true] {
        let place = Workplace::with_mesh(
            &BAR.replace("PLANE", if plane { "xy" } else { "xyz" }),
            &mesh_bytes(&if plane { plate() } else { bar() }, MshFormat::V4_1Binary),
        );
        let ended = place.fractum(&["run", "case.toml", "-o", "out", "--quiet", "--strict"]);
        assert_eq!(ended.code, Some(0), "the case that is spoilt is right: {}", ended.stderr);
    }
    let mut missed = Vec::new();
    for Mistake { mesh, edits, code, runs } in mistakes() {
        let fix = if mesh.tetrahedra.is_empty() { "xy" } else { "xyz" };
        let mut case = BAR.to_owned();
        for (old, new) in &edits {
            assert!(case.contains(old), "{old}");
            case = case.replacen(old, new, 1);
        }
        let case = case.replace("PLANE", fix);
        let place = Workplace::with_mesh(&case, &mesh_bytes(&mesh, MshFormat::V4_1Binary));
        let arguments: &[&str] =
            if runs { &["run", "case.toml", "-o", "out", "--quiet"] } else { &["check", "case.toml"] };
        let ended = place.fractum(arguments);
        let said = if runs { &ended.stderr } else { &ended.stdout };
        if !said.contains(&format!("[{code}]")) {
            missed.push(format!("{code} ({edits:?}): {} {}", said, ended.stderr));
        }
    }
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}

/// A block that begins on a plane is stopped from the first step on, before there is any energy that it could lose.
#[test]
fn a_block_that_lies_on_a_plane_loses_nothing() {
    let case = r#"fractum = 1
mesh = { file = "bar.msh" }
[materials.rock]
density = "2600 kg/m^3"
young_modulus = "1 GPa"
poisson_ratio = 0.2
contact = { friction = 0.3 }
[[bodies]]
name = "block"
kind = "solid"
group = "body"
material = "rock"
[[bodies]]
name = "floor"
kind = "rigid"
shape = "plane"
normal = "z"
[[loads]]
gravity = { x = "5 m/s^2", z = "-9 m/s^2" }
[solver]
end = "4 ms"
[[probes]]
name = "speed"
velocity = { group = "body", along = "x" }
"#;
    let mesh = structured_box([3, 3, 2], Vec3::new(0.04, 0.04, 0.02), None);
    let place = Workplace::with_mesh(case, &mesh_bytes(&mesh, MshFormat::V4_1Binary));
    let speed = run(&place, "out", "1")["probes"]["speed"]["final"].as_f64().unwrap();
    assert!((speed / ((5.0 - 0.3 * 9.0) * 4e-3) - 1.0).abs() < 0.02, "it slides: {speed}");
    let told = listed(&place, "out");
    assert!(told.iter().all(|[code, ..]| code != "impact-loss"), "{told:?}");
}

/// The file of a plate, two of whose triangles are one quadrilateral.
fn with_quadrilateral(mesh: &Mesh) -> Vec<u8> {
    let nodes = |list: &[u32]| list.iter().map(|node| format!(" {}", node + 1)).collect::<String>();
    let [first, second] = [mesh.triangles[0], mesh.triangles[1]];
    let corner = *second.iter().find(|node| !first.contains(node)).unwrap();
    let common: Vec<u32> = first.into_iter().filter(|node| second.contains(node)).collect();
    let single = *first.iter().find(|node| !common.contains(node)).unwrap();
    let quadrilateral = [single, common[0], corner, common[1]];
    let text = String::from_utf8(mesh_bytes(mesh, MshFormat::V2_2Ascii)).unwrap();
    let lines = text.lines().filter(|line| !line.ends_with(&nodes(&second))).map(|line| {
        let number = line.split(' ').next().unwrap_or_default();
        let tags = line.strip_suffix(&nodes(&first)).and_then(|line| line.strip_prefix(&format!("{number} 2")));
        tags.map_or(line.to_owned(), |tags| format!("{number} 3{tags}{}", nodes(&quadrilateral)))
    });
    let count = |kind: usize| format!("$Elements\n{}\n", kind);
    let all = mesh.element_count();
    lines.map(|line| line + "\n").collect::<String>().replace(&count(all), &count(all - 1)).into_bytes()
}

#[test]
fn quadrilaterals_of_a_plane_body_become_triangles() {
    let place = Workplace::with_mesh(&BAR.replace("PLANE", "xy"), &with_quadrilateral(&plate()));
    let ended = place.fractum(&["check", "case.toml"]);
    let told = ended.stdout.contains("1 quadrilateral split into 2 triangles");
    assert!(ended.code == Some(0) && told, "{} {}", ended.stdout, ended.stderr);
}

#[test]
fn what_has_ended_by_its_curve_stays_ended() {
    let stop = "stop_when = { probe = \"load\", below = 0.5 }\nend = \"2 ms\"";
    let probe = "[[probes]]\nname = \"load\"\nreaction = { group = \"x+\", along = \"x\" }\n[solver]";
    let case = BAR.replace("PLANE", "xyz").replace("[solver]", probe).replace("end = \"0.3 ms\"", stop);
    let case = case.replace("[\"0.1 ms\", \"1 mm/s\"]", "[\"0.1 ms\", \"0.1 m/s\"], [\"0.2 ms\", \"-0.1 m/s\"]");
    let place = Workplace::new(&case);
    let ended = place.fractum(&["run", "case.toml", "-o", "out", "--quiet"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let before = summary(&place, "out");
    assert!(before["time"]["reason"].as_str().unwrap().contains("fell below"), "{before}");
    fs::remove_file(place.path("out/summary.json")).unwrap();
    let ended = place.fractum(&["run", "case.toml", "-o", "out", "--quiet", "--resume"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let after = summary(&place, "out");
    for key in ["steps", "end", "reason"] {
        assert_eq!(before["time"][key], after["time"][key], "{key}");
    }
    assert_eq!(before["state_hash"], after["state_hash"]);
}
