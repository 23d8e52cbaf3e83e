//! No part of a run that its scene does not need: `summary.json` names those that ran.

use std::fs;
use std::path::Path;

use crate::common::{BONDED_BAR, BREAKING_BAR, Workplace, run};

const SOLID: &str = r#"fractum = 1
mesh = { file = "bar.msh" }
bodies = [{ name = "bar", kind = "solid", group = "body", material = "stone" }]
supports = [{ group = "x-", fix = "xyz" }]
loads = [{ gravity = { x = "9.81 m/s^2" } }]
solver = { kind = "explicit", end = "0.1 ms" }
[materials.stone]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0.2
"#;

const THERMAL: &str = r#"[materials.stone.thermal]
conductivity = "3 W/(m K)"
heat_capacity = "800 J/(kg K)"
expansion = "1e-5 1/K"
[heat]
initial_temperature = "293 K"
stress_free_temperature = "293 K"
[[heat.conditions]]
group = "body"
source = "1 GW/m^3"
"#;

const BEADS: &str = r#"fractum = 1
solver = { end = "0.2 ms" }
[materials.soft]
density = "2500 kg/m^3"
young_modulus = "1 MPa"
poisson_ratio = 0.25
[[bodies]]
name = "beads"
kind = "particles"
material = "soft"
shape = "box"
size = ["20 mm", "20 mm", "20 mm"]
particle_radius = "2 mm"
[[loads]]
gravity = { z = "-9.81 m/s^2" }
"#;

const TIED: &str = r#"fractum = 1
mesh = { file = "bar.msh" }
supports = [{ group = "left", fix = "xyz" }]
solver = { end = "0.5 us" }
[materials.glass]
density = "2500 kg/m^3"
young_modulus = "70 GPa"
poisson_ratio = 0.2
bonds = { coordination = 8, convention = "all", radius_ratio = 0.5, young_modulus = "200 GPa" }
[[bodies]]
name = "bar"
kind = "solid"
group = "bar"
material = "glass"
[[bodies]]
name = "core"
kind = "bonded"
replaces = "bar"
shape = "box"
point = ["2 mm", 0, 0]
size = ["2 mm", "2 mm", "2 mm"]
material = "glass"
particles = 200
"#;

/// A bonded bar that is pulled.
fn bonded(solver: &str, breaks: bool) -> String {
    let bonds = "bonds = { coordination = 8, convention = \"all\", radius_ratio = 0.5, young_modulus = \"200 GPa\" }";
    let bar =
        BONDED_BAR.replace("kind = \"static\", end = \"1 s\"", solver).replace("particles = 600", "particles = 200");
    let bar = bar.replace("poisson_ratio = 0.23\n", &format!("poisson_ratio = 0.23\n{bonds}\n"));
    let bar = bar.trim_end().strip_suffix("coordination = 8").unwrap().to_owned();
    if breaks { bar } else { bar.replace("fracture = { criterion_strength = \"60 MPa\" }\n", "") }
}

#[test]
fn no_part_runs_that_the_scene_does_not_need() {
    let damaged = SOLID.to_owned() + "damage = { tensile_strength = \"3 MPa\", fracture_energy = \"100 J/m^2\" }\n";
    let at_rest = SOLID.replace("kind = \"explicit\", end = \"0.1 ms\"", "kind = \"static\", end = \"1 s\"");
    let hot = SOLID.to_owned() + THERMAL;
    let heat_alone = hot.replace("kind = \"explicit\"", "kind = \"heat\"");
    let heat_alone = heat_alone
        .replace("supports = [{ group = \"x-\", fix = \"xyz\" }]\n", "")
        .replace("loads = [{ gravity = { x = \"9.81 m/s^2\" } }]\n", "");
    let moving = "kind = \"explicit\", end = \"0.5 us\"";
    let scenes = [
        ("an elastic solid", SOLID.to_owned(), "motion output solid"),
        ("a solid that may break", damaged, "motion output solid transition"),
        ("a solid that breaks above a floor", BREAKING_BAR.to_owned(), "contact motion output solid transition"),
        ("an elastic solid at rest", at_rest, "output solid"),
        ("bonds that hold", bonded(moving, false), "bonds motion output"),
        ("bonds that may break", bonded(moving, true), "bonds fracture motion output"),
        ("bonds that may break at rest", bonded("kind = \"static\", end = \"0.1 s\"", true), "bonds output"),
        ("loose particles", BEADS.to_owned(), "contact motion output"),
        ("a hot solid in motion", hot, "heat motion output solid"),
        ("heat alone", heat_alone, "heat output"),
        ("a bonded part tied to a solid", TIED.to_owned(), "bonds contact motion output solid ties"),
    ];
    for (what, case, needed) in scenes {
        let place = Workplace::new(&case);
        if case == TIED {
            let mesh = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../meshes/tied/bar.msh");
            fs::copy(mesh, place.path("bar.msh")).unwrap();
        }
        let summary = run(&place, "out", "1");
        let mut ran: Vec<&str> = summary["wall"]["phases"].as_object().unwrap().keys().map(String::as_str).collect();
        ran.sort_unstable();
        assert_eq!(ran.join(" "), needed, "{what}");
    }
}
