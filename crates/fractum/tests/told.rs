//! Small inputs that gave wrong numbers without a word: each is told, or right.

use std::fs;

use fractum_mesh::MshFormat;
use fractum_mesh::generate::structured_rectangle;

use crate::common::{Workplace, history, mesh_bytes, run};
use crate::warnings::listed;

/// A bead between a floor and a press, or shot at the floor.
pub(crate) const BEAD: &str = r#"fractum = 1
[materials.stuff]
density = "2500 kg/m^3"
young_modulus = "5 MPa"
poisson_ratio = 0.3
[[bodies]]
name = "bead"
kind = "particles"
material = "stuff"
file = "bead.csv"
[[bodies]]
name = "floor"
kind = "rigid"
shape = "plane"
normal = "z"
[[bodies]]
name = "press"
kind = "rigid"
shape = "plane"
normal = "-z"
point = [0, 0, "20 mm"]
velocity = { z = "-1 m/s" }
[solver]
end = "19 ms"
"#;

#[test]
fn a_bead_pressed_flat_is_told_once_with_its_share_of_the_radius() {
    let place = Workplace::new(BEAD);
    fs::write(place.path("bead.csv"), "0,0,0.01,0.01\n").unwrap();
    run(&place, "out", "1");
    let all = listed(&place, "out");
    let [[code, site, text]] = all.as_slice() else { panic!("{all:?}") };
    assert_eq!(code, "deep-overlap");
    assert!(
        site.starts_with("particle 0 of body \"bead\" at (0.0000e0, 0.0000e0, ") && site.contains("t = "),
        "{all:?}"
    );
    // A tenth of the radius on each side is reached after 2 ms, and looked for every 20 steps.
    assert!(text.starts_with("the overlap is 10"), "{text}");
    let light = BEAD.replace("\"19 ms\"", "\"1.5 ms\"");
    fs::write(place.path("case.toml"), light).unwrap();
    run(&place, "light", "1");
    assert_eq!(listed(&place, "light"), [[""; 3]; 0]);
}

#[test]
fn the_balance_of_the_last_step_is_judged() {
    // A shot so fast that it ends within a few steps, before the second row of the history.
    let shot = BEAD.replace("file = \"bead.csv\"", "file = \"bead.csv\"\ninitial_velocity = { z = \"-20 km/s\" }");
    let place = Workplace::new(&shot.replace("\"19 ms\"", "\"0.2 us\"").replace("5 MPa", "30 GPa"));
    fs::write(place.path("bead.csv"), "0,0,0.003,0.001\n").unwrap();
    let ended = run(&place, "out", "1");
    let residual = ended["ledger"]["relative_residual"].as_f64().unwrap_or_else(|| panic!("{}", ended["ledger"]));
    let told = listed(&place, "out").iter().any(|[code, ..]| code == "energy-balance");
    assert!(residual > 1e-2 && told, "{residual}: {:?}", listed(&place, "out"));
}

/// A strip whose upper side is cooled: it bends without stress.
const STRIP: &str = r#"fractum = 1
[mesh]
file = "bar.msh"
[materials.steel]
density = "8000 kg/m^3"
young_modulus = "200 GPa"
poisson_ratio = 0.0
[materials.steel.thermal]
conductivity = "50 W/(m K)"
heat_capacity = "500 J/(kg K)"
expansion = "1e-5 1/K"
[[bodies]]
name = "strip"
kind = "solid"
group = "body"
material = "steel"
plane = "stress"
formulation = "smoothed"
[heat]
initial_temperature = "300 K"
[[heat.conditions]]
where = "x > -1 m"
temperature = "300 K - 100 K*t/2 ms*y/2 mm"
[[supports]]
group = "x-"
fix = "x"
[[supports]]
where = "x < 0.01 mm && y < 0.01 mm"
fix = "y"
[solver]
end = "2 ms"
[[probes]]
name = "tip"
displacement = { group = "x+", along = "y" }
[output]
history = { every = "20 us" }
[damping]
local = LOCAL
"#;

#[test]
fn local_damping_does_not_brake_what_expands_slowly() {
    let tip = |local: &str| {
        let mesh = structured_rectangle([30, 4], [0.03, 0.002], None);
        let place = Workplace::with_mesh(&STRIP.replace("LOCAL", local), &mesh_bytes(&mesh, MshFormat::V4_1Binary));
        run(&place, "out", "1");
        history(&place, "out", &["tip"]).last().unwrap()[0]
    };
    let [free, damped] = ["0", "0.2"].map(tip);
    // Curvature alpha dT/h: a tip of alpha dT L^2/(2 h), bent towards the cooled side.
    let exact = 1e-5 * 100.0 * 0.03 * 0.03 / (2.0 * 0.002);
    assert!((free / exact - 1.0).abs() < 0.05 && (damped / exact - 1.0).abs() < 0.05, "{free} {damped} {exact}");
}
