//! A case with a bonded body, as its user meets it: no mesh, everything from a material and a shape.

use std::fs;

use crate::common::{Workplace, files_below, history, resumed, run};
use fractum_pack::{Domain, PackSpec, pack};

const BAR: &str = r#"fractum = 1
title = "A bonded bar, pulled"

[materials.glass]
density = "2500 kg/m^3"
young_modulus = "72 GPa"
poisson_ratio = 0.23

[[bodies]]
name = "bar"
kind = "bonded"
material = "glass"
shape = "box"
point = ["1 mm", "0 mm", "0 mm"]
size = ["3 mm", "1 mm", "1 mm"]
particles = 1500
coordination = 8
initial_velocity = { y = "0.01 mm/s*(x - 1 mm)/3 mm" }
[bodies.groups]
middle = "abs(x - 2.5 mm) < 0.3 mm"

[[supports]]
group = "bar.x-"
fix = "xyz"
fix_rotation = "xyz"
[[supports]]
group = "bar.x+"
velocity = { x = { smooth_ramp = [["0 s", "0 m/s"], ["1 us", "0.1 mm/s"]] } }

[[loads]]
group = "bar.middle"
force = { z = "0.01 mN" }
[[loads]]
gravity = { z = "-9.81 m/s^2" }

[damping]
mass = "1000 1/s"

[solver]
end = "3 us"

[[probes]]
name = "pull"
reaction = { group = "bar.x+", along = "x" }
[[probes]]
name = "stretch"
displacement = { group = "bar.x+", along = "x" }
[[probes]]
name = "turn"
rotation = { group = "bar.middle", along = "z" }
[[probes]]
name = "bending"
energy = "bond_bending"

[output]
fields = { every = "1 us" }
history = { every = "20 ns" }
checkpoint = { steps = 170 }
"#;

fn log(place: &Workplace, folder: &str) -> String {
    fs::read_to_string(place.path(folder).join("run.log")).unwrap()
}

#[test]
fn a_bonded_body_runs_from_its_material_alone() {
    let place = Workplace::new(BAR);
    let summary = run(&place, "one", "1");
    let counts = &summary["counts"];
    assert_eq!((counts["particles"].as_u64(), counts["nodes"].as_u64()), (Some(1500), Some(0)));
    assert!(counts["bonds"].as_u64().unwrap() > 4500, "{counts}");
    assert_eq!((counts["broken_bonds"].as_u64(), counts["fragments"].as_u64()), (Some(0), Some(1)));
    let energy = |name: &str| summary["energy"][name].as_f64().unwrap();
    assert!(energy("residual_max_relative") < 1e-5, "{}", summary["energy"]);
    let bonds = energy("bond_tension") + energy("bond_bending") + energy("bond_torsion");
    assert!(bonds > 0.0 && (bonds / energy("elastic") - 1.0).abs() < 1e-12);
    assert!(energy("damping") > 0.0);
    // Long waves: the mean stress of the bar is near E times its mean strain.
    let value = |name: &str| summary["probes"][name]["final"].as_f64().unwrap();
    let strain = value("stretch") / 3e-3;
    assert!((value("pull") / (72e9 * 1e-6 * strain) - 1.0).abs() < 0.3, "{}", value("pull"));
    for folder in ["particles", "bonds"] {
        assert_eq!(files_below(&place.path("one").join(folder), ".vtp").len(), 4, "{folder}");
    }
    assert!(place.path("one/report.html").is_file() && place.path("one/pictures/particles.png").is_file());
    assert!(files_below(&place.path("one").join("fields"), ".vtu").is_empty());

    let first = log(&place, "one");
    assert!(first.contains("packing made now") && first.contains("beams calibrated now"), "{first}");
    for threads in ["2", "7"] {
        let other = run(&place, threads, threads);
        assert_eq!(other["state_hash"], summary["state_hash"], "{threads} threads");
        assert_eq!(other["probes"], summary["probes"], "{threads} threads");
    }
    let second = log(&place, "2");
    assert!(second.contains("packing from the cache") && second.contains("beams from the cache"), "{second}");

    let resumed = resumed(&place, "2");
    assert_eq!((&resumed["state_hash"], &resumed["energy"]), (&summary["state_hash"], &summary["energy"]));
    let rows = |folder: &str| fs::read_to_string(place.path(folder).join("history.csv")).unwrap();
    assert!(rows("one") == rows("2"));

    // What is damaged in the cache is made again.
    let kept = files_below(&place.path("cache"), "");
    assert_eq!(kept.len(), 2, "{kept:?}");
    for file in kept {
        let bytes = fs::read(&file).unwrap();
        fs::write(&file, &bytes[..bytes.len() / 2]).unwrap();
    }
    let again = run(&place, "again", "2");
    assert_eq!(again["state_hash"], summary["state_hash"]);
    assert!(log(&place, "again").contains("packing made now"));
}

#[test]
fn beams_and_packings_made_before_are_used_as_they_are() {
    let beams = r#"poisson_ratio = 0.23
[materials.glass.bonds]
coordination = 9
convention = "all"
radius_ratio = 0.4
young_modulus = "500 GPa"
"#;
    let shape = &BAR[BAR.find("shape = ").unwrap()..BAR.find("initial_velocity").unwrap()];
    let case = BAR.replace("poisson_ratio = 0.23\n", beams).replace(shape, "packing = \"old.fpk\"\n");
    let place = Workplace::new(&case.replace("middle = \"abs(x - 2.5 mm) < 0.3 mm\"", "middle = \"x > 0.5 mm\""));
    let packing = pack(&PackSpec::new(Domain::cylinder(1e-3, 0.4e-3), 300, 5)).unwrap();
    fs::write(place.path("old.fpk"), packing.to_bytes()).unwrap();
    let checked = place.fractum(&["check", "case.toml"]);
    assert_eq!(checked.code, Some(0), "{}", checked.stderr);
    for words in ["300 bonded particles", "packing as given", "beams as given: radius 0.4000", "9.00 of all"] {
        assert!(checked.stdout.contains(words), "{words}: {}", checked.stdout);
    }
    let mut bytes = packing.to_bytes();
    bytes[200] ^= 1;
    fs::write(place.path("old.fpk"), bytes).unwrap();
    let damaged = place.fractum(&["check", "case.toml"]);
    assert_eq!(damaged.code, Some(1));
    assert!(damaged.stderr.contains("bodies[0].packing = \"old.fpk\": packing file: it is cut short or damaged"));
    assert!(damaged.stderr.contains("fractum pack"), "{}", damaged.stderr);
}

#[test]
fn stiffer_wall_bonds_bear_their_rim() {
    let stiffened = BAR.replace("coordination = 8", "coordination = 8\nwall_stiffening = 0.25");
    let place = Workplace::new(&stiffened);
    let summary = run(&place, "one", "1");
    assert!(log(&place, "one").contains("stiffer by 0.25 for each of their particles at a wall"));
    assert!(summary["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-5, "{}", summary["energy"]);
    assert_eq!(run(&place, "2", "2")["state_hash"], summary["state_hash"]);
    assert_eq!(resumed(&place, "2")["state_hash"], summary["state_hash"]);
    // What is calibrated is what is pulled at rest: both bodies have their material's modulus.
    let text = &stiffened[stiffened.find("[[loads]]").unwrap()..stiffened.find("[[probes]]").unwrap()];
    let still = stiffened.replace(text, "[solver]\nkind = \"static\"\nend = \"1 us\"\n");
    let still = still.replace("initial_velocity = { y = \"0.01 mm/s*(x - 1 mm)/3 mm\" }\n", "");
    let still = still.replace("fix_rotation = \"xyz\"\n", "");
    let (x, ramp) = (
        "velocity = { x = { smooth_ramp = [[\"0 s\", \"0 m/s\"], [\"1 us\", \"0.1 mm/s\"]] } }",
        "displacement = { x = \"1 um*t/1 us\" }",
    );
    let still = still.replace("group = \"bar.x-\"\nfix = \"xyz\"", "group = \"bar.x-\"\nfix = \"x\"").replace(x, ramp);
    let still = still.replace(
        "[[supports]]\ngroup = \"bar.x+\"",
        "[[supports]]\ngroup = \"bar.middle\"\nfix = \"yz\"\n[[supports]]\ngroup = \"bar.x+\"",
    );
    let pull = |case: &str| {
        let place = Workplace::new(case);
        run(&place, "still", "2")["probes"]["pull"]["final"].as_f64().unwrap()
    };
    let [plain, stiffened] = [&still.replace("wall_stiffening = 0.25\n", ""), &still].map(|case| pull(case));
    assert!((stiffened / plain - 1.0).abs() < 0.01, "{stiffened} {plain}");
    // Tension and torsion agree on the radius of a rod.
    let modulus = |test: &str, name: &str, by: &str| {
        let ended = place.fractum(&[
            "lab",
            "test",
            test,
            "--cylinder",
            "5 mm,0.5 mm",
            "--count",
            "2500",
            "--coordination",
            "8",
            "--wall-stiffening",
            by,
        ]);
        let value: serde_json::Value =
            serde_json::from_str(&ended.stdout).unwrap_or_else(|error| panic!("{error}: {}", ended.stderr));
        value[name].as_f64().unwrap()
    };
    let error = |by: &str| {
        let shear = modulus("tension", "young_modulus", by) / (2.0 * (1.0 + modulus("tension", "poisson_ratio", by)));
        modulus("torsion", "shear_modulus", by) / shear - 1.0
    };
    let [soft, stiff] = ["0", "0.25"].map(error);
    assert!(soft < -0.05 && stiff.abs() < 0.4 * soft.abs(), "{soft} {stiff}");
}

#[test]
fn what_cannot_be_packed_bonded_or_calibrated_is_refused_with_a_remedy() {
    let small = BAR.replace("particles = 1500", "particles = 300");
    let cases = [
        // what is replaced, by what, key, words
        ("particles = 300", "particles = 40", "bodies[0].particles", "ask for more and smaller particles"),
        ("coordination = 8", "wall_stiffening = -0.2", "bodies[0].wall_stiffening", "at least 0"),
        ("coordination = 8", "bond = \"local\"\nwall_stiffening = 0.2", "bodies[0].wall_stiffening", "cohesive-beam"),
        ("coordination = 8", "coordination = 35", "bodies[0].coordination", "is out of reach: this packing gives"),
        ("poisson_ratio = 0.23", "poisson_ratio = 0.48", "bodies[0].coordination", "lower coordinations reach higher"),
        (
            "group = \"bar.x+\", along = \"x\"",
            "group = \"bar.x*\", along = \"x\"",
            "probes[0].reaction.group",
            "bar.x+",
        ),
        ("group = \"bar.x-\"", "group = \"bra.x-\"", "supports[0].group", "the case has no mesh"),
    ];
    for (from, to, key, words) in cases {
        let place = Workplace::new(&small.replace(from, to));
        let ended = place.fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(1), "{to}: {}", ended.stderr);
        assert!(ended.stderr.contains(key) && ended.stderr.contains(words), "{to}: {}", ended.stderr);
        assert!(ended.stderr.starts_with("case.toml:"), "{to}: {}", ended.stderr);
    }
    let shape = &small[small.find("shape = ").unwrap()..small.find("particles").unwrap()];
    let small = small.replace(shape, "shape = \"stl\"\nfile = \"open.stl\"\n");
    // A triangulated surface is one wall.
    let place = Workplace::new(&small.replace("bar.x-", "bar.surface").replace("bar.x+", "bar.middle"));
    let open = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid s\n";
    fs::write(place.path("open.stl"), open).unwrap();
    let ended = place.fractum(&["check", "case.toml"]);
    assert_eq!(ended.code, Some(1));
    assert!(ended.stderr.contains("bodies[0].file: the surface is not closed: 3 edges"), "{}", ended.stderr);
    assert!(ended.stderr.contains("repair it in the mesher"), "{}", ended.stderr);
}

/// The bar, kicked by a step of velocity at an end, with what else stands under `[damping]`.
fn kicked(damping: &str) -> String {
    let gentle = r#"velocity = { x = { smooth_ramp = [["0 s", "0 m/s"], ["1 us", "0.1 mm/s"]] } }"#;
    let small = BAR.replace("particles = 1500", "particles = 600").replace(gentle, "velocity = { x = \"1 m/s\" }");
    small.replace("mass = \"1000 1/s\"", damping)
}

#[test]
fn the_scheme_of_tchamwa_and_wielgosz_damps_a_front_and_closes_the_balance() {
    let energies = |damping: &str| {
        let place = Workplace::new(&kicked(damping));
        let summary = run(&place, "out", "1");
        let energy = |name: &str| summary["energy"][name].as_f64().unwrap();
        assert!(energy("residual_max_relative") < 1e-4, "{damping}: {}", summary["energy"]);
        if damping.is_empty() {
            // The half step before the start is booked there; nothing comes after it.
            let rows = crate::common::history(&place, "out", &["damping"]);
            assert!(rows.len() > 2 && rows[1..].iter().all(|row| row == &rows[1]), "{rows:?}");
            return [energy("damping"), energy("external")];
        }
        // A checkpoint holds the forces of the step before.
        assert_eq!(resumed(&place, "out")["state_hash"], summary["state_hash"]);
        [energy("damping"), energy("external")]
    };
    // Without damping, only the half step before the start loses the rounding of the forces at rest.
    let [none, work] = energies("");
    assert!(none.abs() < 1e-12 * work, "{none} of {work}");
    let [little, work] = energies("tchamwa_wielgosz = 1.05");
    let [much, more_work] = energies("tchamwa_wielgosz = 1.3");
    let (little, much) = (little / work, much / more_work);
    assert!(little > 1e-3 && much > 1.5 * little && much < 0.5, "{little} {much}");
}

#[test]
fn a_dissipation_that_would_do_nothing_is_refused() {
    let place = Workplace::new(&kicked("tchamwa_wielgosz = 1.0"));
    let ended = place.fractum(&["check", "case.toml"]);
    assert_eq!(ended.code, Some(1));
    assert!(ended.stderr.contains("damping.tchamwa_wielgosz = 1.0; expected between 1 and 2"), "{}", ended.stderr);
}

#[test]
fn a_packing_that_misses_its_targets_is_refused_unless_it_is_given() {
    // Three particles thick: its walls put it into layers.
    let thin = BAR.replace("[\"3 mm\", \"1 mm\", \"1 mm\"]", "[\"3 mm\", \"3 mm\", \"0.35 mm\"]");
    let place = Workplace::new(&thin);
    let ended = place.fractum(&["check", "case.toml"]);
    assert_eq!(ended.code, Some(1), "{}", ended.stdout);
    for words in ["bodies[0].name: the packing misses its target", "reached", "--keep"] {
        assert!(ended.stderr.contains(words), "{words}: {}", ended.stderr);
    }
    let made = place.fractum(&["pack", "--box", "3 mm,3 mm,0.35 mm", "--count", "1500", "--keep", "-o", "kept"]);
    assert_eq!(made.code, Some(0), "{}", made.stderr);
    let shape = &thin[thin.find("shape = ").unwrap()..thin.find("coordination").unwrap()];
    let given = thin.replace(shape, "packing = \"kept/packing.fpk\"\n").replace("abs(x - 2.5 mm)", "abs(x - 1.5 mm)");
    fs::write(place.path("case.toml"), given).unwrap();
    let ended = place.fractum(&["check", "case.toml"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!((ended.stdout + &ended.stderr).contains("misses its target"));
}

const BETWEEN_PLATES: &str = r#"fractum = 1
title = "A bonded cylinder between two plates"

[parameters]
length = "40 mm"
radius = "10 mm"
E = "30 GPa"
transit = "length/sqrt(E/2400 kg/m^3)"
# Of the upper plate into the body.
depth = "0 mm"

[materials.stone]
density = "2400 kg/m^3"
young_modulus = "E"
poisson_ratio = 0.2

[[bodies]]
name = "core"
kind = "bonded"
material = "stone"
shape = "cylinder"
length = "length"
radius = "radius"
particles = 600

[[bodies]]
name = "lower"
kind = "rigid"
shape = "plane"
point = ["0 mm", "0 mm", "0 mm"]
normal = ["1", "0", "0"]
contact = { friction = 0 }

[[bodies]]
name = "upper"
kind = "rigid"
shape = "box"
point = ["length - depth", "-2*radius", "-2*radius"]
size = ["10 mm", "4*radius", "4*radius"]
contact = { friction = 0 }
velocity = { x = { smooth_ramp = [["0 s", "0 m/s"], ["10*transit", "-0.4 m/s"]] } }

[solver]
end = "20*transit"

[[probes]]
name = "press"
reaction = { group = "upper", along = "-x" }
[[probes]]
name = "way"
displacement = { group = "upper", along = "-x" }

[output]
history = { every = "transit/4" }
"#;

/// Young's modulus by the motion of the plates, and the first row: press and kinetic energy.
fn pressed(place: &Workplace, folder: &str) -> (f64, [f64; 2]) {
    let rows = history(place, folder, &["press", "way", "kinetic"]);
    let (first, last) = (&rows[0], rows.last().unwrap());
    // Two transits and more before the end: waves have run to and fro.
    let early = &rows[rows.len() - 32];
    let stress = (last[0] - early[0]) / (std::f64::consts::PI * 1e-4);
    (stress / ((last[1] - early[1]) / 40e-3), [first[0], first[2]])
}

#[test]
fn a_cylinder_between_plates_has_the_modulus_of_its_material_and_starts_without_load() {
    let place = Workplace::new(BETWEEN_PLATES);
    let one = run(&place, "one", "1");
    let (modulus, start) = pressed(&place, "one");
    assert!((modulus / 30e9 - 1.0).abs() < 0.03, "{modulus:e}");
    assert_eq!(start, [0.0; 2]);
    assert!(one["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-4, "{}", one["energy"]);
    assert_eq!(run(&place, "two", "2")["state_hash"], one["state_hash"]);
    // A plate that stands in the body is told, and brings no energy either.
    let deep = place.fractum(&["run", "case.toml", "-o", "deep", "--threads", "1", "--set", "depth=0.5 mm"]);
    assert!(deep.code == Some(0) && deep.stderr.contains("give no force until they have parted"), "{}", deep.stderr);
    let (modulus, start) = pressed(&place, "deep");
    assert!((modulus / 30e9 - 1.0).abs() < 0.06 && start == [0.0; 2], "{modulus:e} {start:?}");
}

/// A bonded body of gypsum, but for its shape.
const GYPSUM: &str = r#"fractum = 1
[materials.gypsum]
density = "2000 kg/m^3"
young_modulus = "5 GPa"
poisson_ratio = 0.2
[[bodies]]
name = "body"
kind = "bonded"
material = "gypsum"
"#;

/// A plate meets a bonded body across a gap.
fn plate_meets(shape: &str, gap: f64, speed: f64, seed: u32) -> String {
    format!(
        r#"{GYPSUM}{shape}
particles = 150
seed = {seed}
[[bodies]]
name = "upper"
kind = "rigid"
shape = "plane"
normal = "-z"
point = [0, 0, "10 mm + {gap} um"]
velocity = {{ z = "-{speed} m/s" }}
[solver]
end = "{gap} um/({speed} m/s) + 40 us"
[[probes]]
name = "momentum"
momentum = {{ along = "-z" }}
[[probes]]
name = "push"
reaction = {{ group = "upper", along = "z" }}
"#
    )
}

/// A block that falls on a cylinder beside the middle of its face.
const FALLS_ON_ROLLER: &str = r#"shape = "box"
size = ["10 mm", "10 mm", "10 mm"]
particles = 150
seed = SEED
initial_velocity = { y = "-0.5 m/s" }
[[bodies]]
name = "roller"
kind = "rigid"
shape = "cylinder"
point = ["AT mm", "-8.003 mm", "-1 mm"]
axis = "z"
length = "12 mm"
radius = "8 mm"
contact = { friction = FRICTION, damping_ratio = 0 }
[solver]
end = "80 us"
[output]
checkpoint = { steps = 150 }
[[probes]]
name = "momentum"
momentum = { along = "y" }
[[probes]]
name = "kinetic"
energy = "kinetic"
"#;

#[test]
fn flat_faces_fall_on_a_roller() {
    for (seed, at, friction) in [("1", "5", "0"), ("2", "6", "0"), ("3", "2", "0.4")] {
        let case = [("SEED", seed), ("AT", at), ("FRICTION", friction)];
        let case = case.iter().fold(format!("{GYPSUM}{FALLS_ON_ROLLER}"), |text, (from, to)| text.replace(from, to));
        let place = Workplace::new(&case);
        let summary = run(&place, "one", "1");
        let residual = summary["energy"]["residual_max_relative"].as_f64().unwrap();
        let momentum = summary["probes"]["momentum"]["final"].as_f64().unwrap();
        assert!(residual < 1e-3 && momentum > 0.0, "seed {seed} at {at} mm: {residual}, {momentum}");
        let two = run(&place, "two", "2");
        assert_eq!(two["state_hash"], summary["state_hash"]);
        assert_eq!(resumed(&place, "two")["state_hash"], summary["state_hash"]);
    }
}

#[test]
fn flat_faces_meet_a_plate_across_a_gap() {
    let block = "shape = \"box\"\nsize = [\"10 mm\", \"10 mm\", \"10 mm\"]";
    let rows = [(block, 0.0, 0.5, 1), (block, 10.0, 0.5, 2), (block, 3.0, 0.05, 3)];
    for (shape, gap, speed, seed) in rows {
        let place = Workplace::new(&plate_meets(shape, gap, speed, seed));
        let summary = run(&place, "out", "1");
        let residual = summary["energy"]["residual_max_relative"].as_f64().unwrap();
        let momentum = summary["probes"]["momentum"]["final"].as_f64().unwrap();
        assert!(residual < 1e-3 && momentum > 0.0, "{shape} {gap} {speed} {seed}: {residual}, {momentum}");
    }
}

/// The material of the rods at rest.
const SOFT: &str = r#"fractum = 1
[materials.rock]
density = "2500 kg/m^3"
young_modulus = "50 MPa"
poisson_ratio = 0.2
[[bodies]]
name = "rod"
kind = "bonded"
material = "rock"
particles = 500
"#;

/// A rod that hangs from a support, which goes down with it.
const HANGS: &str = r#"shape = "box"
size = ["0.3 m", "0.1 m", "0.1 m"]
[[supports]]
group = "rod.x-"
displacement = { x = "DOWN*t/1 s", y = "0 m", z = "0 m" }
[[loads]]
gravity = { x = "9.81 m/s^2" }
[solver]
kind = "static"
end = "1 s"
[[probes]]
name = "hold"
reaction = { group = "rod.x-", along = "-x" }
"#;

/// A support at rest bears what loads the particles that it holds, as it does in motion, and no work is counted twice where it moves.
#[test]
fn a_support_at_rest_bears_the_weight_of_what_it_holds() {
    for down in ["0 m", "1 mm"] {
        let place = Workplace::new(&(SOFT.to_owned() + &HANGS.replace("DOWN", down)));
        let summary = run(&place, "out", "1");
        // The packing is larger than its box by 6e-5.
        let weight = 2500.0 * 0.3 * 0.1 * 0.1 * 9.81;
        let [hold, balance] = [&summary["probes"]["hold"]["final"], &summary["energy"]["residual_max_relative"]]
            .map(|value| value.as_f64().unwrap());
        assert!((hold / weight - 1.0).abs() < 1e-3 && balance < 1e-5, "{down}: {hold} of {weight}, {balance}");
    }
}

/// A rod that is twisted at the end of a support.
const TWISTED: &str = r#"shape = "cylinder"
length = "0.3 m"
radius = "0.05 m"
[[supports]]
group = "rod.x-"
fix = "xyz"
HOLD
[[supports]]
group = "rod.x+"
displacement = { y = "-z*0.01*COURSE", z = "y*0.01*COURSE" }
[solver]
SOLVER
[[probes]]
name = "twists"
moment = { group = "rod.x+", about = { axis = "x" } }
[[probes]]
name = "holds"
moment = { group = "rod.x-", about = { axis = "x" } }
[[probes]]
name = "stored"
energy = "elastic"
"#;

/// Moments of the supports at both ends of a rod are opposite, and the energy is half of their product with the twist: at rest, and in
/// motion once it has come to rest.
#[test]
fn supports_twist_a_rod_by_the_moment_that_its_energy_says() {
    let rest = ("kind = \"static\"\nend = \"1 s\"", "t/1 s", 1e-4);
    let motion = ("end = \"0.1 s\"\n[damping]\nmass = \"300 1/s\"", "min(1, t/40 ms)", 5e-3);
    for (solver, course, allowed) in [rest, motion] {
        for hold in ["", "fix_rotation = \"xyz\""] {
            let case = TWISTED.replace("HOLD", hold).replace("SOLVER", solver).replace("COURSE", course);
            let place = Workplace::new(&(SOFT.to_owned() + &case));
            let summary = run(&place, "out", "1");
            let [twists, holds, stored] =
                ["twists", "holds", "stored"].map(|name| summary["probes"][name]["final"].as_f64().unwrap());
            let torque = 2.0 * stored / 0.01;
            let off = [twists, -holds].map(|moment| (moment / torque - 1.0).abs());
            assert!(off.iter().all(|off| *off < allowed), "{solver} {hold}: {twists} {holds} {torque}");
        }
    }
}

/// What moves with a clump, or stands free, is held by no support.
#[test]
fn a_moment_of_particles_that_nothing_holds_is_refused() {
    let (solver, course) = ("kind = \"static\"\nend = \"1 s\"", "t/1 s");
    let rod = TWISTED.replace("HOLD", "").replace("SOLVER", solver).replace("COURSE", course);
    let rod = rod.replace("{ group = \"rod.x-\", about", "{ group = \"rod.middle\", about");
    let rod = SOFT.to_owned() + "groups = { middle = \"abs(x - 0.15 m) < 20 mm\" }\n" + &rod;
    let clump = r#"fractum = 1
materials = { glass = { density = 2500, young_modulus = "70 MPa", poisson_ratio = 0.2 } }
[[bodies]]
name = "grain"
kind = "particles"
material = "glass"
centre = ["0 m", "0 m", "0 m"]
clump = [{ at = ["0 mm", "0 mm", "0 mm"], radius = "1 mm" }, { at = ["1 mm", "0 mm", "0 mm"], radius = "1 mm" }]
initial_velocity = { x = "1 m/s" }
[solver]
end = "1 ms"
[[probes]]
name = "moment"
moment = { group = "grain", about = { axis = "z" } }
"#;
    for case in [&rod[..], clump] {
        let told = Workplace::new(case).fractum(&["check", "case.toml"]);
        assert!(told.code == Some(1) && told.stderr.contains("nothing holds it"), "{}", told.stderr);
    }
}
