//! Interfaces between elements, as their user meets them.

use std::fs;
use std::path::Path;

use fractum_mesh::MshFormat;

use crate::common::{Workplace, files_below, mesh_bytes, run, summary};
use crate::heat::layers;

/// Two layers that an interface joins, peeled off each other at one end.
const PEELED: &str = r#"fractum = 1
[mesh]
file = "bar.msh"
[materials.m]
density = "2500 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = NU
[[bodies]]
name = "low"
kind = "solid"
group = "body"
material = "m"
plane = "stress"
thickness = "10 mm"
[[bodies]]
name = "up"
kind = "solid"
group = "up"
material = "m"
plane = "stress"
thickness = "10 mm"
[[interfaces]]
between = ["body", "up"]
tensile_strength = "2 MPa"
cohesion = "3 MPa"
fracture_energy = "20 J/m^2"
residual_friction_angle = "30 deg"
[[supports]]
where = "x < 0.01 mm"
fix = "xy"
[[supports]]
where = "x > 59.99 mm && y > 1.99 mm"
velocity = { y = { ramp = [["0 s", "0 m/s"], ["0.5 ms", "SPEED"]] } }
[[supports]]
where = "x > 59.99 mm && y < 0.01 mm"
velocity = { y = { ramp = [["0 s", "0 m/s"], ["0.5 ms", "-SPEED"]] } }
[[probes]]
name = "cracked"
crack_area = true
[solver]
end = "1 ms"
"#;

#[test]
fn supports_that_hold_nodes_of_both_sides_bring_no_energy() {
    // The nodes of both sides at the end are held along y alone, while the sides turn.
    let mesh = mesh_bytes(&layers([30, 4]), MshFormat::V4_1Binary);
    for (nu, speed, safety) in [("0.3", "0.5 m/s", "0.8"), ("0", "0.5 m/s", "0.4"), ("0.45", "0.2 m/s", "0.8")] {
        let case = PEELED.replace("NU", nu).replace("SPEED", speed);
        let case = case.replace("[solver]\n", &format!("[solver]\nsafety = {safety}\n"));
        let summary = run(&Workplace::with_mesh(&case, &mesh), "out", "1");
        let energy = |name: &str| summary["energy"][name].as_f64().unwrap();
        let external = energy("external");
        let warnings = summary["warnings"].to_string();
        assert!(warnings.contains("undamped-sliding") && !warnings.contains("energy-gained"), "{warnings}");
        for name in ["friction", "damping", "interface_fracture"] {
            assert!(energy(name) > -1e-5 * external, "nu {nu}, {speed}, {safety}: {name} {}", summary["energy"]);
        }
        assert!(energy("kinetic") < 0.05 * external, "nu {nu}, {speed}, {safety}: {}", summary["energy"]);
        let spent = energy("interface_fracture") + energy("interfaces");
        let cracked = summary["probes"]["cracked"]["final"].as_f64().unwrap();
        assert!(spent > 0.95 * 20.0 * cracked, "nu {nu}, {speed}, {safety}: {spent} J for {cracked} m2");
    }
}

/// Two layers that are pulled off each other at rest. The upper one is held along y alone, and so by nothing once it has parted.
const PARTED: &str = r#"[[supports]]
where = "y < 0.01 mm"
fix = "y"
[[supports]]
where = "x < 0.01 mm && y < 0.01 mm"
fix = "x"
[[supports]]
where = "y > 3.99 mm"
displacement = { y = "WAY um*t/1 s" }
[solver]
kind = "static"
end = "1 s"
[output]
checkpoint = { steps = 1 }
"#;

#[test]
fn a_path_goes_on_to_where_a_piece_comes_loose() {
    // The face opens by 20 um, 2 G/f_t, until it bears nothing: at the end, before it, and long before it.
    for (cells, way) in [([15, 2], 20.0), ([16, 4], 20.0), ([15, 2], 20.4), ([15, 2], 24.0), ([15, 2], 60.0)] {
        let mesh = mesh_bytes(&layers(cells), MshFormat::V4_1Binary);
        let head = &PEELED[..PEELED.find("[[supports]]").unwrap()];
        let case = [head, PARTED].concat().replace("NU", "0.2").replace("WAY", &way.to_string());
        let place = Workplace::with_mesh(&case, &mesh);
        for threads in ["1", "2"] {
            place.fractum(&["run", "case.toml", "-o", threads, "--threads", threads]);
        }
        let [one, two] = ["1", "2"].map(|folder| summary(&place, folder));
        assert_eq!(one["state_hash"], two["state_hash"], "{cells:?} {way} um");
        let spent = one["energy"]["interface_fracture"].as_f64().unwrap();
        assert!(spent > 0.98 * 20.0 * 0.06 * 0.01, "{cells:?} {way} um: {spent} J, {}", one["time"]);
        // From the state before the last.
        let states = files_below(&place.path("2/checkpoint"), ".fck");
        assert_eq!(states.len(), 2, "{cells:?} {way} um");
        fs::remove_file(&states[1]).unwrap();
        place.fractum(&["run", "case.toml", "-o", "2", "--threads", "1", "--resume"]);
        assert_eq!(one["state_hash"], summary(&place, "2")["state_hash"], "{cells:?} {way} um, resumed");
    }
}

/// Liquid that is put in at one end.
const LIQUID: &str =
    "[liquid]\nviscosity = \"1 mPa s\"\n[[liquid.injections]]\nwhere = \"x > 0 m\"\nrate = \"1e-9 m^3/s\"\n";

#[test]
fn what_does_not_enter_interfaces_is_refused() {
    let mesh = mesh_bytes(&layers([30, 4]), MshFormat::V4_1Binary);
    let case = PEELED.replace("NU", "0.3").replace("SPEED", "0.5 m/s");
    let rest = |text: &str| case.replace("[solver]\n", &format!("{text}[solver]\n"));
    let at_rest = |text: &str| rest(text).replace("end = \"1 ms\"", "kind = \"static\"\nend = \"1 ms\"");
    let pressed = "[[loads]]\nwhere = \"y < 0.01 mm\"\npressure = \"1 MPa\"\nin_cracks = true\n";
    for (text, words) in [
        (case.replace("end = \"1 ms\"", "kind = \"modes\""), "with solver.kind = \"modes\""),
        (rest(pressed), "beside loads[].in_cracks"),
        (case.replace("crack_area = true", "crack = { measure = \"count\" }"), "interfaces are not counted as cracks"),
        (rest(LIQUID), "flows between states of equilibrium alone"),
        (at_rest(&LIQUID.replace("x > 0 m", "x > 5 m")), "holds for none of"),
        (at_rest(&LIQUID.replace("x > 0 m", "y < 0.01 mm")), "none of its nodes is on an interface"),
        (
            at_rest(&LIQUID.replace("viscosity", "interfaces = [\"gleu\"]\nviscosity")),
            "the name of one of [[interfaces]]",
        ),
        (
            at_rest(LIQUID).replace("cohesion", "pressure = \"1 MPa\"\ncohesion"),
            "in an interface that [liquid] flows in",
        ),
        (at_rest(LIQUID).replace("kind = \"static\"", "kind = \"static\"\ncontrol = \"path\""), "liquid flows in time"),
    ] {
        let ended = Workplace::with_mesh(&text, &mesh).fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(1), "{words}: {}", ended.stderr);
        assert!(ended.stderr.contains(words), "{words}: {}", ended.stderr);
    }
}

#[test]
fn a_solver_that_is_left_open_is_motion_beside_interfaces() {
    // Slow, so that equilibrium would be cheaper; stiff interfaces have no force there.
    let mesh = mesh_bytes(&layers([30, 4]), MshFormat::V4_1Binary);
    let case = PEELED.replace("NU", "0.3").replace("SPEED", "1 mm/s").replace("0.5 ms", "100 ms");
    let case = case.replace("end = \"1 ms\"", "kind = \"auto\"\nend = \"100 ms\"");
    let spring = case.replace("cohesion", "normal_stiffness = \"1e13 Pa/m\"\ncohesion");
    for case in [case, spring] {
        let ended = Workplace::with_mesh(&case, &mesh).fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        assert!(ended.stdout.contains("interfaces go with motion"), "{}", ended.stdout);
        assert!(ended.stdout.contains("time step"), "{}", ended.stdout);
    }
}

#[test]
fn what_an_interface_joins_leaves_the_domain_as_one() {
    let mesh = mesh_bytes(&layers([30, 4]), MshFormat::V4_1Binary);
    let case = PEELED.replace("NU", "0.3");
    let flying = &case[..case.find("[[supports]]").unwrap()];
    let flying = flying.replace("thickness", "initial_velocity = { y = \"10 m/s\" }\nthickness");
    // The upper layer is outside from 0.2 ms on, the lower one from 0.4 ms on.
    let within = "domain = { min = [\"-1 m\", \"-1 m\", \"-1 m\"], max = [\"1 m\", \"4 mm\", \"1 m\"] }";
    for (end, gone) in [("0.3 ms", false), ("0.6 ms", true)] {
        let text = format!("{flying}[solver]\nend = \"{end}\"\n{within}\n");
        let summary = run(&Workplace::with_mesh(&text, &mesh), "out", "1");
        let energy = |name: &str| summary["energy"][name].as_f64().unwrap();
        let whole = 0.5 * 2500.0 * 0.06 * 0.004 * 0.01 * 100.0;
        let left = energy("left") / whole;
        assert!((left - f64::from(u8::from(gone))).abs() < 1e-9, "{end}: {left} of all has left");
        assert!(energy("residual_max_relative") < 1e-9, "{}", summary["energy"]);
    }
}

#[test]
fn stiff_interfaces_rest_on_stiffness_enough() {
    // The cases of the gallery with their stiffness, and without.
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    for name in ["dcb", "shear"] {
        let case = std::fs::read_to_string(format!("{root}/cases/interfaces/{name}.toml")).unwrap();
        let mesh = std::fs::read(format!("{root}/meshes/interfaces/{name}.msh")).unwrap();
        let stiff: String =
            case.lines().filter(|line| !line.contains("_stiffness =")).flat_map(|line| [line, "\n"]).collect();
        let stiff = stiff.replace(&format!("../../meshes/interfaces/{name}.msh"), "bar.msh");
        let ended = Workplace::with_mesh(&stiff, &mesh).fractum(&["run", "case.toml", "-o", "out"]);
        assert_eq!(ended.code, Some(0), "{name}: {}", ended.stderr);
        assert!(ended.stdout.contains("as expected") && !ended.stdout.contains("NOT as"), "{name}: {}", ended.stdout);
    }
}

#[test]
fn liquid_that_fills_its_interface_or_is_overdrawn_is_told() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = fs::read_to_string(root.join("cases/liquid/viscosity.toml")).unwrap();
    let mesh = fs::read(root.join("meshes/interfaces/liquid.msh")).unwrap();
    let text = text.split("[[expect]]").next().unwrap().replace("../../meshes/interfaces/liquid.msh", "bar.msh");
    let text = text.replace("\"20 s\"", "\"4 s\"").replace("duration/240", "duration/20");
    for (from, to, code) in [
        ("", "", None),
        ("viscosity = \"0.1 Pa s\"", "viscosity = \"1e-6 Pa s\"", Some("liquid-at-end")),
        ("rate = \"0.5*rate*1 m\"", "rate = \"-0.5*rate*1 m\"", Some("liquid-overdrawn")),
    ] {
        let place = Workplace::with_mesh(&text.replacen(from, to, 1), &mesh);
        let ended = place.fractum(&["run", "case.toml", "-o", "out"]);
        assert_eq!(ended.code, Some(0), "{to}: {}", ended.stderr);
        let said = summary(&place, "out")["warnings"].to_string();
        for one in ["liquid-at-end", "liquid-overdrawn"] {
            assert_eq!(said.contains(one), code == Some(one), "{to}: {said}");
        }
    }
}
