//! Rigid tools that are open: sheets from STL files, and cylinders without lids.

use std::fs;

use crate::common::{Workplace, resumed, run};

/// A bead of 10 mm on a floor, within a can that is lifted.
const LIFTED: &str = r#"fractum = 1
title = "A can is lifted off its bead"
[materials.m]
density = "2500 kg/m^3"
young_modulus = "5 MPa"
poisson_ratio = 0.3
[[bodies]]
name = "bead"
kind = "particles"
material = "m"
file = "bead.csv"
[[bodies]]
name = "floor"
kind = "rigid"
shape = "plane"
normal = "z"
[[bodies]]
name = "can"
kind = "rigid"
shape = "cylinder"
ENDS
axis = "z"
point = [0, 0, "-1 mm"]
length = "0.1 m"
radius = "0.03 m"
velocity = { z = "0.1 m/s" }
[[loads]]
gravity = { z = "-9.81 m/s^2" }
[solver]
end = "0.2 s"
[[probes]]
name = "rise"
displacement = { group = "bead", along = "z" }
"#;

#[test]
fn a_cylinder_without_lids_leaves_its_beads() {
    for (ends, least, most) in [("inside = true", 0.015, 0.03), ("ends = \"open\"", -1e-4, 1e-4)] {
        let place = Workplace::new(&LIFTED.replace("ENDS", ends));
        fs::write(place.path("bead.csv"), "0,0,0.01,0.01\n").unwrap();
        let rise = run(&place, "one", "1")["probes"]["rise"]["final"].as_f64().unwrap();
        assert!(least < rise && rise < most, "{ends}: {rise} m");
    }
    let place = Workplace::new(&LIFTED.replace("ENDS", "inside = true\nends = \"open\""));
    fs::write(place.path("bead.csv"), "0,0,0.01,0.01\n").unwrap();
    let ended = place.fractum(&["check", "case.toml"]);
    assert_eq!(ended.code, Some(1));
    assert!(ended.stderr.contains("bodies[2].inside") && ended.stderr.contains("both sides"), "{}", ended.stderr);
}

/// A bead without friction and losses falls on the rim of a pipe, over the inner wall, the rim itself, or the outer wall.
#[test]
fn a_bead_on_the_rim_of_a_pipe_keeps_its_energy() {
    for x in [0.024, 0.0295, 0.03, 0.0305, 0.036] {
        let case = LIFTED.replace("ENDS", "ends = \"open\"").replace("velocity = { z = \"0.1 m/s\" }\n", "");
        let case =
            case.replace("poisson_ratio = 0.3", "poisson_ratio = 0.3\ncontact = { friction = 0, restitution = 1.0 }");
        let place = Workplace::new(&case.replace("[solver]", "[solver]\nsafety = 0.2"));
        fs::write(place.path("bead.csv"), format!("{x},0,0.12,0.01\n")).unwrap();
        let found = run(&place, "one", "1");
        assert!(found["probes"]["rise"]["final"].as_f64().unwrap() < -0.005, "{}", found["probes"]);
        // It falls with the square of the step.
        let residual = found["energy"]["residual_max_relative"].as_f64().unwrap();
        assert!(residual < 2e-4, "{x}: {residual}");
    }
}

/// A sheet of two triangles, 0.1 m wide.
const SHEET: &str = "solid s\nfacet normal 0 0 1\nouter loop\nvertex -50 -50 0\nvertex 50 -50 0\nvertex 50 50 0\nendloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex -50 -50 0\nvertex 50 50 0\nvertex -50 50 0\nendloop\nendfacet\nendsolid s\n";

/// A bead lies on the sheet, or hangs below it where gravity points up.
const ON_SHEET: &str = r#"fractum = 1
title = "A bead on a sheet"
[materials.m]
density = "2500 kg/m^3"
young_modulus = "5 MPa"
poisson_ratio = 0.3
contact = { restitution = 0.3, friction = 0.5, rolling_friction = 0.3 }
[[bodies]]
name = "bead"
kind = "particles"
material = "m"
file = "bead.csv"
[[bodies]]
name = "sheet"
kind = "rigid"
shape = "stl"
file = "sheet.stl"
unit = "mm"
velocity = { z = { smooth_ramp = [["0 s", "0 m/s"], ["20 ms", "LIFT m/s"]] } }
[[loads]]
gravity = { z = "GRAVITY m/s^2" }
[solver]
end = "0.3 s"
[[probes]]
name = "force"
reaction = { group = "sheet", along = "z" }
[[probes]]
name = "about_y"
moment = { group = "sheet", about = { axis = "y" } }
[[probes]]
name = "about_a_point"
moment = { group = "sheet", about = { point = ["10 mm", 0, 0], axis = "y" } }
[[probes]]
name = "work"
work = { group = "sheet" }
[[probes]]
name = "external"
energy = "external"
[[probes]]
name = "kinetic"
energy = "kinetic"
[[probes]]
name = "rise"
displacement = { group = "bead", along = "z" }
[output]
checkpoint = { steps = 3000 }
"#;

#[test]
fn an_open_surface_is_felt_from_both_sides_with_force_moment_and_work() {
    let weight = 2500.0 * 4.0 / 3.0 * std::f64::consts::PI * 0.01f64.powi(3) * 9.81;
    for side in [1.0, -1.0] {
        let case = ON_SHEET.replace("LIFT", &(0.02 * side).to_string());
        let place = Workplace::new(&case.replace("GRAVITY", &(-9.81 * side).to_string()));
        fs::write(place.path("sheet.stl"), SHEET).unwrap();
        fs::write(place.path("bead.csv"), format!("0.02,0.01,{},0.01\n", 0.01 * side)).unwrap();
        let one = run(&place, "one", "1");
        let value = |name: &str| one["probes"][name]["final"].as_f64().unwrap();
        let near = |name: &str, right: f64, error: f64| {
            assert!((value(name) - right).abs() < error * right.abs(), "{side}, {name}: {} for {right}", value(name));
        };
        near("force", side * weight, 1e-3);
        // (r x F) along y = z Fx - x Fz.
        near("about_y", -0.02 * side * weight, 1e-3);
        near("about_a_point", -0.01 * side * weight, 2e-3);
        // The sheet lifts the bead: weight times way, and its kinetic energy.
        near("work", weight * value("rise").abs() + value("kinetic"), 5e-3);
        // The rest of the external work is that of gravity.
        near("external", value("work") - weight * value("rise").abs(), 1e-6);
        let two = run(&place, "two", "2");
        assert_eq!((&two["state_hash"], &two["probes"]), (&one["state_hash"], &one["probes"]));
        let resumed = resumed(&place, "two");
        assert_eq!((&resumed["state_hash"], &resumed["probes"]), (&one["state_hash"], &one["probes"]));
    }
    let place = Workplace::new(
        &ON_SHEET.replace("LIFT", "0").replace("GRAVITY", "-9.81").replace("group = \"sheet\" }", "group = \"bead\" }"),
    );
    fs::write(place.path("sheet.stl"), SHEET).unwrap();
    fs::write(place.path("bead.csv"), "0.02,0.01,0.01,0.01\n").unwrap();
    let ended = place.fractum(&["check", "case.toml"]);
    assert_eq!(ended.code, Some(1));
    assert!(ended.stderr.contains("probes[3].work.group = \"bead\": no rigid body"), "{}", ended.stderr);
}

#[test]
fn the_plan_tells_that_a_surface_is_open() {
    let place = Workplace::new(&ON_SHEET.replace("LIFT", "0").replace("GRAVITY", "-9.81"));
    fs::write(place.path("sheet.stl"), SHEET).unwrap();
    fs::write(place.path("bead.csv"), "0.02,0.01,0.01,0.01\n").unwrap();
    let told = place.fractum(&["check", "case.toml"]);
    assert!(told.stdout.contains("mesh of 2 facets, open at 4 edges and felt from both sides"), "{}", told.stdout);
    fs::write(place.path("sheet.stl"), SHEET.replace("endsolid s\n", "")).unwrap();
    let cut = place.fractum(&["check", "case.toml"]);
    assert_eq!(cut.code, Some(1));
    assert!(cut.stderr.contains("the file ends before `endsolid`"), "{}", cut.stderr);
}
