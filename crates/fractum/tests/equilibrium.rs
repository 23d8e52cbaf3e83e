//! Quasi-static runs as their user starts them: path and opening control, crack probes, the advice of `check`.

use fractum_mesh::generate::structured_rectangle;
use fractum_mesh::{Group, MshFormat};

use crate::common::{Workplace, history, mesh_bytes, run};

/// A bar with a weak slab in its middle, pulled apart at equilibrium.
const BAR: &str = r#"fractum = 1
title = "A bar at equilibrium"

[mesh]
file = "bar.msh"

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
strength_factor = "if(abs(x - 20 cm) < 3 cm, 0.5, 1.0)"

[[supports]]
group = "x-"
fix = "xyz"
[[supports]]
group = "x+"
displacement = { x = "0.4 mm*t/1 s" }

[solver]
kind = "static"
end = "1 s"
stop_when = { probe = "load", below = 0.2 }

[[probes]]
name = "load"
reaction = { group = "x+", along = "x" }
[[probes]]
name = "angle"
crack = { measure = "angle", along = "x" }
[[probes]]
name = "middle"
crack = { measure = "centre", along = "x" }
[[probes]]
name = "place"
crack = { measure = "centre", along = "x", where = "y < 6 cm" }
"#;

#[test]
fn a_bar_parts_at_its_weak_slab_whatever_controls_the_path() {
    // In a uniform slab a crack may lie anywhere; this one is weakest in the middle.
    let bar = BAR.replace("if(abs(x - 20 cm) < 3 cm, 0.5, 1.0)", "min(1, 0.5 + 0.02*abs(x - 20 cm)/1 cm)");
    let by_damage = Workplace::new(&bar);
    let opening = r#"kind = "static"
control = "opening"
opening = { group = "x+", against = "x-", along = "x", step = "2 um", end = "0.2 mm" }"#;
    let by_opening = Workplace::new(&bar.replace("kind = \"static\"", opening));
    let probe = |summary: &serde_json::Value, name: &str, of: &str| summary["probes"][name][of].as_f64().unwrap();
    let first = run(&by_damage, "one", "1");
    assert_eq!(first["state_hash"], run(&by_damage, "two", "2")["state_hash"]);
    let second = run(&by_opening, "one", "1");
    for summary in [&first, &second] {
        let peak = probe(summary, "load", "max") / (0.12 * 0.12);
        assert!((peak / 1.5e6 - 1.0).abs() < 0.08, "{peak} Pa");
        // The crack lies in the middle, rather across the bar than along it: three elements cannot tell better.
        assert!(probe(summary, "angle", "final") > 45f64.to_radians(), "{}", summary["probes"]["angle"]);
        for name in ["middle", "place"] {
            assert!((probe(summary, name, "final") - 0.2).abs() < 0.02, "{name}: {}", summary["probes"][name]);
        }
        assert!(summary["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-3, "{}", summary["energy"]);
    }
    let peaks = [&first, &second].map(|summary| probe(summary, "load", "max"));
    // The crack may run through the slab in more than one way.
    assert!((peaks[0] / peaks[1] - 1.0).abs() < 0.05, "{peaks:?}");
}

/// Beyond the strength under a force: only what may follow its path is led there.
#[test]
fn no_equilibrium_leads_to_the_path_where_there_is_one_to_follow() {
    let (before, after) = (BAR.find("[[supports]]\ngroup = \"x+\"").unwrap(), BAR.find("[solver]").unwrap());
    let end = BAR.find("stop_when").unwrap();
    let load = "[[loads]]\ngroup = \"x+\"\npressure = \"-2 MPa*t/1 s\"\n";
    let pulled = format!("{}{load}{}", &BAR[..before], &BAR[after..end]);
    let warm = "[materials.concrete.thermal]\nconductivity = \"3 W/(m K)\"\nheat_capacity = \"800 J/(kg K)\"\nexpansion = \"1e-5 1/K\"\n";
    let heated = pulled.replace("[[bodies]]", &format!("{warm}[heat]\ninitial_temperature = \"293 K\"\n[[bodies]]"));
    let by_time = pulled.replace("kind = \"static\"", "kind = \"static\"\ncontrol = \"time\"");
    for (case, leads) in [(by_time, true), (pulled, false), (heated, false)] {
        let ended = Workplace::new(&case).fractum(&["run", "case.toml", "--quiet"]);
        assert!(ended.code != Some(0) && ended.stderr.contains("no equilibrium found"), "{}", ended.stderr);
        assert_eq!(ended.stderr.contains("control = \"path\""), leads, "{}", ended.stderr);
    }
}

#[test]
fn check_compares_motion_and_equilibrium() {
    let place = Workplace::new(BAR);
    let checked = place.fractum(&["check", "case.toml"]);
    assert_eq!(checked.code, Some(0), "{}", checked.stderr);
    for words in ["first period of", "equilibrium takes about", "steps of motion about"] {
        assert!(checked.stdout.contains(words), "{words}: {}", checked.stdout);
    }
    // A free body has no period of its own.
    let free = BAR.replace("fix = \"xyz\"", "fix = \"x\"").replace("kind = \"static\"", "kind = \"explicit\"");
    let place = Workplace::new(&free);
    let checked = place.fractum(&["check", "case.toml"]);
    assert!(checked.stdout.contains("kind = \"explicit\": a body is free to move"), "{}", checked.stdout);
}

#[test]
fn check_tells_of_rows_that_cracks_of_local_damage_may_follow() {
    let told = |case: &str| {
        let checked = Workplace::new(case).fractum(&["check", "case.toml"]);
        assert_eq!(checked.code, Some(0), "{}", checked.stderr);
        checked.stdout.contains("rows: 100 % of the edges that may be damaged lie within 5 deg of 7 directions")
    };
    assert!(told(BAR), "boxes cut into six tetrahedra");
    assert!(!told(&BAR.replace("[[bodies]]", "regularisation = \"phase-field\"\n[[bodies]]")));
}

#[test]
fn opening_and_probes_are_refused_where_they_cannot_act() {
    for (from, to, words) in [
        ("kind = \"static\"", "kind = \"static\"\ncontrol = \"opening\"", "solver.opening is missing"),
        (
            "reaction = { group = \"x+\", along = \"x\" }",
            "moment = { group = \"y+\", where = \"abs(x - 20 cm) < 10 cm\" }",
            "nothing holds it; expected nodes that a support prescribes",
        ),
        (
            "kind = \"static\"",
            "kind = \"static\"\nopening = { group = \"x+\", against = \"x-\", along = \"x\", step = 1e-6, end = 1e-4 }",
            "solver.opening has no effect without control = \"opening\"",
        ),
        (
            "\"y < 6 cm\"",
            "\"y > 6 m\"",
            "no edge of a body that may be damaged and no bond that may break fulfils the condition",
        ),
    ] {
        let place = Workplace::new(&BAR.replacen(from, to, 1));
        let ended = place.fractum(&["check", "case.toml"]);
        let found: String = ended.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(ended.code == Some(1) && found.contains(words), "{words}: {}", ended.stderr);
    }
}

/// A bar so brittle that it snaps back, pulled by an end that goes on.
fn brittle_bar(solver: &str) -> String {
    BAR.replace("100 J/m^2", "15 J/m^2")
        .replace(
            "kind = \"static\"\nend = \"1 s\"\nstop_when = { probe = \"load\", below = 0.2 }",
            &format!("kind = \"static\"\nend = \"1 s\"\n{solver}"),
        )
        .replace("0.4 mm*t", "0.06 mm*t")
}

#[test]
fn a_bar_that_snaps_back_moves_to_the_state_that_the_path_reaches_and_its_ledger_closes() {
    let path = Workplace::new(&brittle_bar("control = \"path\""));
    run(&path, "out", "1");
    let path = history(&path, "out", &["time", "load"]);
    let moved = Workplace::new(&brittle_bar("control = \"time\"\nno_equilibrium = \"motion\""));
    let summary = run(&moved, "out", "2");
    assert!(summary["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-3, "{}", summary["energy"]);
    let rows = history(&moved, "out", &["time", "load", "in_motion", "kinetic", "damping", "damage"]);
    let begin = rows.iter().position(|row| row[2] == 1.0).expect("it jumps");
    let end = rows.iter().rposition(|row| row[2] == 1.0).unwrap();
    // What the jump sets free is taken by damping.
    let (before, after) = (&rows[begin], &rows[end + 1]);
    assert!(after[4] > before[4] + 0.005 * after[5], "{before:?} {after:?}");
    assert!(rows.iter().any(|row| row[3] > 0.0) && after[3] == 0.0);
    // The path comes back to this extension after its turn.
    let turn = (1..path.len()).find(|&i| path[i][0] < path[i - 1][0]).expect("it snaps back");
    let there = (turn..path.len()).find(|&i| path[i][0] >= after[0] && path[i - 1][0] < after[0]).expect("it returns");
    let [low, high] = [&path[there - 1], &path[there]];
    let load = low[1] + (high[1] - low[1]) * (after[0] - low[0]) / (high[0] - low[0]);
    let peak = path.iter().map(|row| row[1]).fold(0.0, f64::max);
    assert!(after[1] < 0.6 * peak && (after[1] - load).abs() < 0.02 * peak, "{} {load} {peak}", after[1]);
    // Steps of motion between them are no states of equilibrium.
    let steps = summary["time"]["steps"].as_u64().unwrap();
    for (most, ends) in [(400, true), (3, false)] {
        let limited = format!("control = \"time\"\nno_equilibrium = \"motion\"\nmax_steps = {most}");
        let ended = Workplace::new(&brittle_bar(&limited)).fractum(&["run", "case.toml", "-o", "out"]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        assert!(steps > 400 && ended.stdout.contains("solver.max_steps allows no more") != ends, "{}", ended.stdout);
        assert_eq!(ended.stderr.contains("as many steps as it may"), !ends, "{}", ended.stderr);
        assert_eq!(ended.stdout.contains("is the end of the run"), ends, "{}", ended.stdout);
    }
    // Without motion the run says where it ends.
    let stopped = Workplace::new(&brittle_bar("control = \"time\""));
    let ended = stopped.fractum(&["run", "case.toml", "-o", "out"]);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(ended.stderr.contains("no_equilibrium = \"motion\""), "{}", ended.stderr);
}

#[test]
fn the_program_chooses_the_solver_and_says_why() {
    let kind = |from: &str, to: &str| BAR.replace("kind = \"static\"", "kind = \"auto\"").replace(from, to);
    for (case, words) in [
        (kind("", ""), "kind = \"static\": loads are slow against the first period of"),
        (
            kind("\"0.4 mm*t/1 s\"", "{ pulse = \"half-sine\", peak = \"1 um\", duration = \"1 ms\" }"),
            "a load is a pulse",
        ),
        (kind("fix = \"xyz\"", "fix = \"x\""), "kind = \"explicit\": a body is free to move"),
        (kind("end = \"1 s\"", "end = \"2 ms\""), "so that inertia counts"),
    ] {
        let checked = Workplace::new(&case).fractum(&["check", "case.toml"]);
        assert!(
            checked.code == Some(0) && checked.stdout.contains(words),
            "{words}: {}{}",
            checked.stdout,
            checked.stderr
        );
    }
    let place = Workplace::new(&kind("stop_when", "step = \"1 ms\"\nstop_when"));
    let checked = place.fractum(&["check", "case.toml"]);
    assert!(checked.code == Some(1) && checked.stderr.contains("solver.step has no effect"), "{}", checked.stderr);
}

#[test]
fn the_work_of_a_twist_is_that_of_the_moments_of_its_supports() {
    let probes = r#"[[probes]]
name = "torque"
moment = { group = "x+", about = { point = ["0 m", "6 cm", "6 cm"], axis = "x" } }
[[probes]]
name = "opposite"
moment = { group = "x-", about = { point = ["0 m", "6 cm", "6 cm"], axis = "x" } }
[[probes]]
name = "twist"
rotation = { group = "x+", along = "x" }
"#;
    let twisted = BAR
        .replace(r#"x = "0.4 mm*t/1 s""#, r#"y = "-1e-3*(z - 6 cm)*t/1 s", z = "1e-3*(y - 6 cm)*t/1 s""#)
        .replace("material = \"concrete\"", "material = \"concrete\"\ndamage = false")
        .replace("stop_when = { probe = \"load\", below = 0.2 }", "step = \"0.5 s\"");
    let (head, _) = twisted.split_once("[[probes]]").unwrap();
    let place = Workplace::new(&format!("{head}{probes}"));
    let summary = run(&place, "out", "1");
    let last = |name: &str| summary["probes"][name]["final"].as_f64().unwrap();
    assert_eq!(summary["probes"]["torque"]["unit"], "N m");
    assert!((last("twist") / 1e-3 - 1.0).abs() < 1e-9, "{}", last("twist"));
    assert!((last("opposite") / last("torque") + 1.0).abs() < 1e-6, "{}", last("opposite"));
    let work = summary["energy"]["external"].as_f64().unwrap();
    assert!((0.5 * last("torque") * last("twist") / work - 1.0).abs() < 1e-6, "{work} J, {} N m", last("torque"));
    // Three plain elements across are much stiffer than Saint-Venant's square bar.
    let shear = 30e9 / 2.4;
    let theory = 0.1406 * 0.12f64.powi(4) * shear * 1e-3 / 0.4;
    assert!(last("torque") > theory && last("torque") < 2.0 * theory, "{} N m, {theory}", last("torque"));
}

/// The bar on a plane, pushed down, sideways and up again by its other end.
fn pressed_bar(motion: &str, friction: &str) -> String {
    let body = "[[bodies]]\nname = \"floor\"\nkind = \"rigid\"\nshape = \"plane\"\nnormal = \"x\"\n";
    let (head, rest) = BAR.split_once("[[supports]]").unwrap();
    let (_, solver) = rest.split_once("[solver]").unwrap();
    let (solver, _) = solver.split_once("[[probes]]").unwrap();
    let (before, after) = head.split_once("[materials.concrete.damage]").unwrap();
    let (_, after) = after.split_once("[[bodies]]").unwrap();
    let solver = solver.replace("stop_when = { probe = \"load\", below = 0.2 }", "step = \"50 ms\"");
    let contact = format!("[materials.concrete.contact]\nfriction = {friction}\n");
    let after = after.replace("strength_factor = \"if(abs(x - 20 cm) < 3 cm, 0.5, 1.0)\"", "");
    let before = before.replace("poisson_ratio = 0.2", "poisson_ratio = 0");
    format!(
        r#"{before}{contact}[[bodies]]{after}{body}contact = {{ friction = {friction} }}
[[supports]]
group = "x+"
{motion}
[solver]{solver}
[[probes]]
name = "load"
reaction = {{ group = "x+", along = "-x" }}
[[probes]]
name = "carried"
reaction = {{ group = "floor", along = "-x" }}
[[probes]]
name = "side"
reaction = {{ group = "floor", along = "y" }}
"#
    )
}

#[test]
fn a_bar_presses_on_a_plane_and_leaves_it_without_sticking() {
    let motion = r#"fix = "yz"
displacement = { x = { ramp = [["0 s", "0 m"], ["0.4 s", "-20 um"], ["1 s", "10 um"]] } }"#;
    let place = Workplace::new(&pressed_bar(motion, "0"));
    let summary = run(&place, "out", "1");
    assert!(summary["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-6, "{}", summary["energy"]);
    let rows = history(&place, "out", &["time", "load", "carried", "contact"]);
    let rigid = 30e9 * 0.12 * 0.12 * 20e-6 / 0.4;
    let deepest = rows.iter().find(|row| (row[0] - 0.4).abs() < 1e-9).unwrap();
    // The springs of the contact give way as half a row of elements would.
    assert!(deepest[1] < rigid && deepest[1] > 0.9 * rigid, "{deepest:?} {rigid}");
    for row in &rows {
        assert!((row[1] + row[2]).abs() < 1e-4 * rigid && row[1] > -1e-4 * rigid, "{row:?}");
    }
    let last = rows.last().unwrap();
    assert!(last[1].abs() < 1e-9 * rigid && last[3] == 0.0, "{last:?}");
}

#[test]
fn a_pressed_bar_slides_at_the_friction_of_coulomb() {
    let motion = r#"fix = "z"
displacement = { x = "-20 um*min(t/0.3 s, 1)", y = "0.5 mm*max(t - 0.3 s, 0 s)/0.7 s" }"#;
    let place = Workplace::new(&pressed_bar(motion, "0.05"));
    let summary = run(&place, "out", "1");
    // Sliding steps are booked with the mean of the forces at their ends.
    assert!(summary["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-2, "{}", summary["energy"]);
    assert!(summary["energy"]["friction"].as_f64().unwrap() > 0.0);
    let rows = history(&place, "out", &["carried", "side"]);
    assert!(rows.iter().all(|row| row[1].abs() <= 0.05 * row[0].abs() * (1.0 + 1e-6)), "{rows:?}");
    let last = rows.last().unwrap();
    assert!((last[1] / last[0]).abs() > 0.05 * (1.0 - 1e-3), "{last:?}");
}

/// The bar pulled apart at its weak slab, pushed back by 20 um more, and let go.
fn closing_bar() -> String {
    let way = r#"x = { ramp = [["0 s", "0 m"], ["0.5 s", "0.4 mm"], ["0.9 s", "-20 um"], ["1 s", "10 um"]] } }
fix = "yz""#;
    BAR.replace("stop_when = { probe = \"load\", below = 0.2 }", "control = \"time\"\nstep = \"5 ms\"")
        .replace("x = \"0.4 mm*t/1 s\" }", way)
}

#[test]
fn a_crack_that_closes_carries_compression_and_opens_without_sticking() {
    let place = Workplace::new(&closing_bar());
    let summary = run(&place, "one", "1");
    assert_eq!(summary["state_hash"], run(&place, "two", "2")["state_hash"]);
    assert!(summary["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-3, "{}", summary["energy"]);
    let planned = place.fractum(&["check", "case.toml"]);
    assert!(planned.stdout.contains("without friction"), "{}", planned.stdout);
    let rows = history(&place, "one", &["time", "load", "contact"]);
    let rigid = 30e9 * 0.12 * 0.12 * 20e-6 / 0.4;
    let at = |time: f64| rows.iter().find(|row| (row[0] - time).abs() < 1e-9).unwrap();
    // Faces meet where they parted; spheres in place of the slab give way more than it did.
    let deepest = at(0.9);
    assert!(-deepest[1] > 0.6 * rigid && -deepest[1] < rigid, "{deepest:?} {rigid}");
    for row in rows.iter().filter(|row| row[0] > 0.7 && row[0] < 0.88 || row[0] > 0.97) {
        assert!(row[1].abs() < 0.02 * rigid && row[2] < 1e-4 * deepest[2], "{row:?}");
    }
    // On the way back the same springs let go.
    let half = at(0.935);
    assert!((half[1] / deepest[1] - (20.0 - 10.5) / 20.0).abs() < 0.02, "{half:?} {deepest:?}");
}

#[test]
fn halves_that_have_slid_press_on_nodes_that_they_shared_no_element_with() {
    let way = r#"x = { ramp = [["0 s", "0 m"], ["0.5 s", "0.4 mm"], ["0.6 s", "120 mm"], ["0.7 s", "120 mm"],
["0.9 s", "-11.25 mm"], ["1 s", "-11.33 mm"]] }, y = { ramp = [["0 s", "0 m"], ["0.6 s", "0 m"], ["0.7 s", "30 mm"]] } }
fix = "z""#;
    let case = closing_bar().replace("fix = \"yz\"", "");
    let (head, rest) = case.split_once("x = { ramp").unwrap();
    let (_, tail) = rest.split_once("[solver]").unwrap();
    let place = Workplace::new(&format!("{head}{way}\n[solver]{tail}"));
    let summary = run(&place, "one", "1");
    assert_eq!(summary["state_hash"], run(&place, "two", "2")["state_hash"]);
    assert!(summary["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-4, "{}", summary["energy"]);
    let rows = history(&place, "one", &["time", "load", "contact"]);
    let at = |time: f64| rows.iter().find(|row| (row[0] - time).abs() < 1e-3).unwrap();
    assert!(at(0.9)[1].abs() < 1e-3 && at(0.9)[2] == 0.0, "{:?}", at(0.9));
    // No contact ever pulls, and as many springs bear as they close further.
    let [first, second, third] = [at(0.945), at(0.955), at(0.965)].map(|row| row[1]);
    assert!(first < -1e3 && ((third - second) / (second - first) - 1.0).abs() < 0.01, "{first} {second} {third}");
}

#[test]
fn an_early_end_by_a_load_that_is_never_above_zero_is_told() {
    // The load of a bar that is pressed is negative.
    for (along, is_told) in [("x", true), ("-x", false)] {
        let case = BAR.replace(
            "along = \"x\" }\n[[probes]]\nname = \"angle\"",
            &format!("along = \"{along}\" }}\n[[probes]]\nname = \"angle\""),
        );
        let place = Workplace::new(&case.replace("0.4 mm*t/1 s", "-1 um*t/1 s"));
        let told = format!("{}", run(&place, "out", "1")["warnings"]);
        assert_eq!(told.contains("was never above zero"), is_told, "{told}");
    }
}

/// A load that holds from the start does not fall with what the bar bears: the path ends where nothing more may be taken off it.
#[test]
fn a_path_below_no_load_at_all_ends_there_and_is_told() {
    let pulled = "[[loads]]\ngroup = \"x+\"\nforce = { x = \"10 kN + 20 kN*t/1 s\" }\n\n[solver]\ncontrol = \"path\"\n";
    let case = BAR
        .replace("[[supports]]\ngroup = \"x+\"\ndisplacement = { x = \"0.4 mm*t/1 s\" }\n", "")
        .replace("[solver]\n", pulled)
        .replace("stop_when = { probe = \"load\", below = 0.2 }\n", "")
        .replace("group = \"x+\", along = \"x\" }", "group = \"x-\", along = \"-x\" }");
    let place = Workplace::new(&case);
    let summary = run(&place, "out", "1");
    let told = format!("{}", summary["warnings"]);
    assert!(told.contains("gave-way") && told.contains("load factor below zero"), "{told}");
    let rows = history(&place, "out", &["time", "load"]);
    let below = rows.iter().filter(|row| row[0] < 0.0).count();
    assert_eq!((below, rows.last().unwrap()[0] < 0.0), (1, true), "{rows:?}");
    // The peak is the strength of the slab.
    let peak = summary["probes"]["load"]["max"].as_f64().unwrap();
    assert!((peak / (1.5e6 * 0.0144) - 1.0).abs() < 0.08, "{peak}");
}

/// A bar of a phase field that is weakest beside its middle, pulled apart.
const PLATE: &str = r#"fractum = 1
[mesh]
file = "bar.msh"
[materials.m]
density = "2500 kg/m^3"
young_modulus = "10 GPa"
poisson_ratio = 0.2
[materials.m.damage]
tensile_strength = "2 MPa"
fracture_energy = "40 J/m^2"
regularisation = "phase-field"
BODIES
[[supports]]
group = "x-"
fix = "x"
[[supports]]
where = "x < 1 um && y < 1 um"
fix = "y"
[[supports]]
group = "x+"
displacement = { x = "0.1 mm*t/1 s" }
[solver]
kind = "static"
end = "1 s"
stop_when = { probe = "load", below = 0.001 }
[[probes]]
name = "load"
reaction = { group = "x-", along = "-x" }
[[probes]]
name = "area"
crack = { measure = "area" }
"#;

/// The field of a body ends at its border: a crack there takes half of the fracture energy, and is told.
#[test]
fn a_crack_of_a_phase_field_along_the_border_of_its_body_is_told() {
    let whole = structured_rectangle([16, 8], [0.02, 0.01], None);
    let mut halves = whole.clone();
    let body = halves.groups.iter().position(|group| group.name == "body").unwrap();
    let middle = |triangle: u32| {
        halves.triangles[triangle as usize].iter().map(|&node| halves.nodes[node as usize].x).sum::<f64>() / 3.0
    };
    let (right, left) = halves.groups[body].triangles.iter().partition(|&&triangle| middle(triangle) > 0.01);
    halves.groups[body].triangles = left;
    let second = Group { name: "right".into(), tag: 99, triangles: right, ..halves.groups[body].clone() };
    halves.groups.push(second);
    let part = |name: &str, group: &str| {
        format!(
            "[[bodies]]\nname = \"{name}\"\nkind = \"solid\"\ngroup = \"{group}\"\nmaterial = \"m\"\nplane = \"stress\"\nthickness = \"10 mm\"\n\
             strength_factor = \"0.9 + 0.01*abs(x - 9.4 mm)/1 mm\"\n"
        )
    };
    let two = part("left", "body") + &part("rest", "right");
    // Of the fracture energy of the section, 4 mJ, what damage has taken; of its area that of the crack.
    let cost = |case: &str, bodies: &str, mesh: &fractum_mesh::Mesh| {
        let place = Workplace::with_mesh(&case.replace("BODIES", bodies), &mesh_bytes(mesh, MshFormat::V4_1Binary));
        let summary = run(&place, "out", "1");
        let told = format!("{}", summary["warnings"]).contains("cut-band");
        let area = summary["probes"]["area"]["final"].as_f64().unwrap() / 1e-4;
        (summary["energy"]["damage"].as_f64().unwrap() / 4e-3, told, area)
    };
    let (one, is_told, area) = cost(PLATE, &part("bar", "body"), &whole);
    println!("{one} {area}");
    assert!((one - 0.95).abs() < 0.1 && !is_told && (area - 1.0).abs() < 1e-6, "{one} {is_told} {area}");
    let (cut, is_told, _) = cost(PLATE, &two, &halves);
    assert!(cut < 0.7 && is_told, "{cut} {is_told}");
    let local = PLATE.replace("regularisation = \"phase-field\"\n", "");
    let (taken, is_told, area) = cost(&local, &two, &halves);
    println!("{taken} {area}");
    assert!(taken > 0.75 && !is_told && (area - 1.0).abs() < 1e-6, "{taken} {is_told} {area}");
}

/// A load that has gone again at the end was there before: 1 mm/m of 30 GPa over 0.12 x 0.12 m.
#[test]
fn an_elastic_bar_that_is_pulled_and_let_go_has_borne_its_load() {
    let pulled = BAR.split("[materials.concrete.damage]").next().unwrap().to_owned()
        + "[[bodies]]"
        + BAR.split("[[bodies]]").nth(1).unwrap().split("strength_factor").next().unwrap()
        + r#"
[[supports]]
group = "x-"
fix = "x"
[[supports]]
where = "hypot(x, hypot(y, z)) < 1 mm"
fix = "yz"
[[supports]]
where = "hypot(x, hypot(y - 12 cm, z)) < 1 mm"
fix = "z"
[[supports]]
group = "x+"
MOTION
[solver]
kind = "static"
end = "1 s"
[[probes]]
name = "load"
reaction = { group = "x+", along = "x" }
"#;
    for motion in [
        r#"displacement = { x = { ramp = [["0 s", 0], ["0.5 s", "0.4 mm"], ["1 s", 0]] } }"#,
        r#"displacement = { x = "0.4 mm*sin(pi*t/1 s)" }"#,
        r#"velocity = { x = { ramp = [["0 s", "0.8 mm/s"], ["0.499 s", "0.8 mm/s"], ["0.501 s", "-0.8 mm/s"]] } }"#,
    ] {
        let one = run(&Workplace::new(&pulled.replace("MOTION", motion)), "one", "1");
        let most = one["probes"]["load"]["max"].as_f64().unwrap() / (30e9 * 1e-3 * 0.12 * 0.12);
        assert!((most - 1.0).abs() < 0.01, "{motion}: {most}");
    }
}

/// A crack through one or two elements has no energy of its own.
#[test]
fn a_body_of_one_element_across_that_may_crack_is_told() {
    let sheet = BAR.replace("strength_factor = \"if(abs(x - 20 cm) < 3 cm, 0.5, 1.0)\"", "thickness = \"10 mm\"");
    let sheet = sheet.replace("fix = \"xyz\"", "fix = \"xy\"");
    for (across, told) in [(1, true), (4, false)] {
        let cells = [10 * across, across];
        let mesh = structured_rectangle(cells, [0.4, 0.04], None);
        let place = Workplace::with_mesh(&sheet, &mesh_bytes(&mesh, MshFormat::V4_1Binary));
        let ended = place.fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        assert_eq!(ended.stdout.contains("may cost twice its fracture energy"), told, "{across}: {}", ended.stdout);
        let phase = sheet.replace(
            "fracture_energy = \"100 J/m^2\"",
            "fracture_energy = \"100 J/m^2\"\nregularisation = \"phase-field\"",
        );
        let place = Workplace::with_mesh(&phase, &mesh_bytes(&mesh, MshFormat::V4_1Binary));
        assert!(!place.fractum(&["check", "case.toml"]).stdout.contains("may cost twice"));
    }
}

/// The arch of cases/interfaces, with its thickness times a factor.
fn arch(factor: f64) -> Workplace {
    let mesh = include_str!("../../../meshes/interfaces/arch.msh");
    let (head, rest) = mesh.split_once("$Nodes\n").unwrap();
    let (nodes, tail) = rest.split_once("$EndNodes").unwrap();
    let thinned = nodes.lines().map(|line| match line.split(' ').collect::<Vec<_>>()[..] {
        [node, x, y, z] => {
            let (x, y): (f64, f64) = (x.parse().unwrap(), y.parse().unwrap());
            // The blocks below the arch are straight.
            let (radius, foot) = if y > 0.0 { (x.hypot(y), y) } else { (x.abs(), 0.0) };
            let scale = (10.0 + factor * (radius - 10.0)) / radius;
            format!("{node} {} {} {z}\n", scale * x, if foot > 0.0 { scale * y } else { y })
        }
        _ => format!("{line}\n"),
    });
    let mesh = format!("{head}$Nodes\n{}$EndNodes{tail}", thinned.collect::<String>());
    let case = include_str!("../../../cases/interfaces/arch.toml");
    Workplace::with_mesh(&case.replace("../../meshes/interfaces/arch.msh", "bar.msh"), mesh.as_bytes())
}

#[test]
fn an_arch_stands_as_long_as_a_line_of_thrust_lies_within_it() {
    let stands = run(&arch(0.113 / 0.112), "out", "1");
    assert_eq!(stands["status"], "completed");
    let fallen = arch(0.105 / 0.112).fractum(&["run", "case.toml", "-o", "out", "--quiet"]);
    assert_eq!(fallen.code, Some(2), "{}", fallen.stderr);
    assert!(fallen.stderr.contains("a piece has come loose"), "{}", fallen.stderr);
}
