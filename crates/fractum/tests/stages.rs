//! Stages: a bar pulled at rest, then released.

use std::fs;
use std::path::Path;

use crate::common::{Workplace, checkpoints, history, mesh_bytes, run, signal, summary, wait_for_checkpoint};
use fractum_math::Vec3;
use fractum_mesh::MshFormat;
use fractum_mesh::generate::structured_box;
use fractum_output::frames::read_collection;

/// A bar of 0.4 m without lateral strain, pulled at rest by 10 um and let go.
const RELEASED: &str = r#"fractum = 1

[parameters]
end = "1.3 ms"

[mesh]
file = "bar.msh"

[materials.concrete]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0

[[bodies]]
name = "bar"
kind = "solid"
formulation = "standard"
group = "body"
material = "concrete"

[[supports]]
group = "x-"
fix = "x"
[[supports]]
group = "body"
fix = "yz"
[[supports]]
group = "x+"
displacement = { x = "10 um*t/1 ms" }
stages = ["pull"]

[[stages]]
name = "pull"
solver = { kind = "static", end = "1 ms" }
[[stages]]
name = "release"
solver = { kind = "explicit", end = "end", step = "2 us" }

[[probes]]
name = "tip"
displacement = { group = "x+", along = "x" }
[[probes]]
name = "pulled"
reaction = { group = "x+", along = "x" }

[output]
history = { every = "2 us" }
fields = { every = "0.1 ms" }
checkpoint = { every = "1 ms" }
"#;

#[test]
fn a_bar_released_from_rest_swings_with_its_own_period_and_keeps_its_energy() {
    // Fine enough for the corner of the triangular wave.
    let mesh = structured_box([16, 3, 3], Vec3::new(0.4, 0.12, 0.12), None);
    let place = Workplace::with_mesh(RELEASED, &mesh_bytes(&mesh, MshFormat::V4_1Binary));
    let one = run(&place, "one", "1");
    let rows = history(&place, "one", &["time", "tip", "pulled", "in_motion", "elastic", "kinetic", "external"]);
    assert_eq!(rows[0], [0.0; 7], "the history begins without load");
    let released = rows.iter().rfind(|row| row[3] == 0.0).expect("a row at rest");
    // E A u / L, and half of its product with u.
    let force = 30e9 * 0.12 * 0.12 * 10e-6 / 0.4;
    assert!((released[2] / force - 1.0).abs() < 1e-6 && (released[1] / 10e-6 - 1.0).abs() < 1e-6, "{released:?}");
    let work = 0.5 * force * 10e-6;
    assert!((released[4] / work - 1.0).abs() < 1e-6, "{released:?}");
    // Motion begins at that state, without the force that held it; the energy swings and stays.
    let moving: Vec<_> = rows.iter().filter(|row| row[3] == 1.0).collect();
    assert!((moving[0][1] / 10e-6 - 1.0).abs() < 0.05 && moving[0][2] == 0.0, "{:?}", moving[0]);
    assert!(moving.iter().all(|row| (row[6] / work - 1.0).abs() < 1e-6), "no work after the release");
    assert!(one["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-7, "{}", one["energy"]);
    // To -u in half of the period 4 L / c.
    let half = 2.0 * 0.4 / (30e9f64 / 2400.0).sqrt();
    let least = moving.iter().map(|row| row[1]).fold(0.0, f64::min);
    assert!((least / -10e-6 - 1.0).abs() < 0.06, "{least:e}");
    let crossing = moving.windows(2).find(|w| w[0][1] > 0.0 && w[1][1] <= 0.0).unwrap()[1][0] - 1e-3;
    assert!((crossing / (0.5 * half) - 1.0).abs() < 0.03, "{crossing:e} {half:e}");
    assert_eq!(one["state_hash"], run(&place, "two", "2")["state_hash"]);
}

/// A short motion after a long rest: it has the rows and frames of a run of its own, and damping is judged in its own second half.
#[test]
fn a_short_motion_after_a_long_rest_has_rows_and_frames_of_its_own() {
    let mesh = structured_box([8, 2, 2], Vec3::new(0.4, 0.12, 0.12), None);
    let case = RELEASED
        .replace("10 um*t/1 ms", "10 um*t/1 s")
        .replace("end = \"1 ms\"", "end = \"1 s\"")
        .replace("end = \"1.3 ms\"", "end = \"1.004 s\"\n[damping]\nmass = \"8000 1/s\"")
        .replace("history = { every = \"2 us\" }\n", "")
        .replace("fields = { every = \"0.1 ms\" }\n", "")
        .replace("checkpoint = { every = \"1 ms\" }\n", "");
    let place = Workplace::with_mesh(&case, &mesh_bytes(&mesh, MshFormat::V4_1Binary));
    run(&place, "one", "1");
    let rows = history(&place, "one", &["in_motion", "kinetic", "tip"]);
    let moving: Vec<_> = rows.iter().filter(|row| row[0] == 1.0).collect();
    assert!(moving.len() > 900, "{} rows in motion", moving.len());
    let frames = read_collection(&place.path("one/fields.pvd")).unwrap().entries;
    let [at_rest, moving_frames] =
        [false, true].map(|moves| frames.iter().filter(|at| (at.time > 1.0) == moves).count());
    assert!(at_rest <= 51 && (48..=52).contains(&moving_frames), "{at_rest} frames at rest, {moving_frames} in motion");
    assert!(moving.last().unwrap()[2].abs() < 1e-8, "it has come to rest: {:?}", moving.last());
    assert_eq!(
        summary(&place, "one")["warnings"].as_array().unwrap().len(),
        0,
        "{}",
        summary(&place, "one")["warnings"]
    );
}

#[test]
fn a_run_with_stages_goes_on_in_either_with_the_same_bits() {
    let place =
        Workplace::new(&RELEASED.replace("static\", end = \"1 ms\"", "static\", end = \"1 ms\", step = \"2 us\""));
    let arguments = ["run", "case.toml", "--threads", "1", "--quiet", "--set", "end=40 ms"];
    let go = |folder: &str, more: &[&str]| place.start(&[&arguments[..], &["-o", folder], more].concat());
    assert!(go("whole", &[]).wait().unwrap().success());
    let results = place.path("stopped");
    let mut code = None;
    for name in ["INT", "KILL", "TERM", "KILL", "INT"] {
        let saved = checkpoints(&results).last().copied().unwrap_or(0);
        let mut one = go("stopped", if results.exists() { &["--resume"] } else { &[] });
        wait_for_checkpoint(&mut one, &results, saved + 20);
        signal(&one, name);
        code = one.wait().unwrap().code();
        if code == Some(0) {
            break;
        }
    }
    if code != Some(0) {
        assert!(go("stopped", &["--resume"]).wait().unwrap().success());
    }
    let [whole, stopped] = ["whole", "stopped"].map(|folder| summary(&place, folder));
    assert_eq!(whole["state_hash"], stopped["state_hash"]);
    let rows = |folder: &str| fs::read_to_string(place.path(folder).join("history.csv")).unwrap();
    assert_eq!(rows("whole"), rows("stopped"));
}

#[test]
fn wrong_stages_are_explained() {
    for (from, to, words) in [
        ("stages = [\"pull\"]", "stages = [\"pul\"]", "expected some of \"pull\", \"release\""),
        ("kind = \"static\"", "kind = \"auto\"", "\"static\" or \"explicit\""),
        (
            "kind = \"explicit\", end = \"end\", step = \"2 us\"",
            "kind = \"explicit\", end = \"1 us\"",
            "one clock runs",
        ),
        ("kind = \"explicit\"", "kin = \"explicit\"", "did you mean kind?"),
        ("name = \"release\"", "name = \"pull\"", "names are unique"),
        ("[[probes]]\nname = \"tip\"", "[solver]\nend = 1\n[[probes]]\nname = \"tip\"", "has no effect beside stages"),
    ] {
        let place = Workplace::new(&RELEASED.replacen(from, to, 1));
        let ended = place.fractum(&["check", "case.toml"]);
        assert!(ended.code == Some(1) && ended.stderr.contains(words), "{words}: {ended:?}");
    }
    let swapped = RELEASED
        .replace("kind = \"static\"", "kind = \"KIND\"")
        .replace("explicit\", end = \"end\", step = \"2 us\"", "static\", end = \"end\"");
    let place = Workplace::new(&swapped.replace("KIND", "explicit"));
    let ended = place.fractum(&["check", "case.toml"]);
    assert!(ended.code == Some(1) && ended.stderr.contains("cannot follow a stage in motion"), "{ended:?}");
    let planned = Workplace::new(RELEASED).fractum(&["check", "case.toml"]);
    assert_eq!(planned.code, Some(0), "{}", planned.stderr);
    assert!(planned.stdout.contains("stage        release"), "{}", planned.stdout);
}

#[test]
fn warnings_of_a_later_stage_are_told_once() {
    // Above the stable step of 7.4 us, but less than twice: a doubt of the second stage alone.
    let case = RELEASED.replace("step = \"2 us\"", "step = \"12 us\"");
    let load = "[[loads]]\ngroup = \"y+\"\npressure = 8\n";
    let ended = Workplace::new(&format!("{case}{load}")).fractum(&["check", "case.toml"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    for words in ["stages[1].solver.step = 12 µs is above the stable step", "loads[0].pressure is 8 Pa at most"] {
        assert_eq!(ended.stdout.matches(words).count(), 1, "{words}: {}", ended.stdout);
    }
}

/// A hole that is taken out of a quarter of a plate in motion.
fn hole(changes: &[(&str, &str)]) -> Workplace {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = fs::read_to_string(root.join("cases/excavation/hole-motion.toml")).unwrap();
    let text = text.replace("../../meshes/excavation-plane/hole.msh", "bar.msh");
    let text = text.replace("[output]\n", "[output]\ncheckpoint = { every = \"1 ms\" }\n");
    let text = changes.iter().fold(text, |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    });
    Workplace::with_mesh(&text, &fs::read(root.join("meshes/excavation-plane/hole.msh")).unwrap())
}

#[test]
fn excavation_goes_on_with_the_same_bits_on_threads_and_after_a_stop() {
    // The core leaves, and another comes in where it was.
    let fill = "[[bodies]]\nname = \"fill\"\nkind = \"solid\"\ngroup = \"core\"\nmaterial = \"shale\"\n[in_situ]";
    let stage = "[[stages]]\nname = \"fill\"\ninstall = [\"fill\"]\nsolver = { kind = \"explicit\", end = \"0.4 ms\" }\n\n[output]";
    let place = hole(&[("end = \"0.6 ms\"", "end = \"0.3 ms\""), ("[in_situ]", fill), ("[output]", stage)]);
    let plan = place.fractum(&["check", "case.toml"]);
    assert_eq!(plan.code, Some(0), "{}", plan.stderr);
    for words in ["body \"core\" leaves: ", "what they bore fades over 200 µs", "body \"fill\" comes in without stress"]
    {
        assert!(plan.stdout.contains(words), "{words}: {}", plan.stdout);
    }
    let whole = run(&place, "whole", "1");
    assert!(whole["energy"]["left"].as_f64().unwrap() > 0.0, "{}", whole["energy"]);
    assert!(whole["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-6, "{}", whole["energy"]);
    for threads in ["2", "7"] {
        assert_eq!(whole["state_hash"], run(&place, &format!("on-{threads}"), threads)["state_hash"]);
    }
    let arguments = ["run", "case.toml", "--threads", "1", "--quiet", "-o", "stopped"];
    let results = place.path("stopped");
    let mut code = None;
    for name in ["INT", "KILL", "INT"] {
        let saved = checkpoints(&results).last().copied().unwrap_or(0);
        let more: &[&str] = if results.exists() { &["--resume"] } else { &[] };
        let mut one = place.start(&[&arguments[..], more].concat());
        wait_for_checkpoint(&mut one, &results, saved + 200);
        signal(&one, name);
        code = one.wait().unwrap().code();
        if code == Some(0) {
            break;
        }
    }
    if code != Some(0) {
        assert!(place.start(&[&arguments[..], &["--resume"]].concat()).wait().unwrap().success());
    }
    assert_eq!(whole["state_hash"], summary(&place, "stopped")["state_hash"]);
    let rows = |folder: &str| fs::read_to_string(place.path(folder).join("history.csv")).unwrap();
    assert_eq!(rows("whole"), rows("stopped"));
}

#[test]
fn wrong_excavation_is_explained() {
    let excavate = "excavate = [\"core\"]";
    let before = "name = \"before\"\n";
    let third = "[[stages]]\nname = \"late\"\nexcavate = [\"core\"]\nsolver = { kind = \"explicit\", end = \"1 ms\" }\n\n[output]";
    let lining = "[[bodies]]\nname = \"lining\"\nkind = \"solid\"\ngroup = \"core\"\nmaterial = \"shale\"\n[in_situ]";
    let held = "[[supports]]\nname = \"in the core\"\nwhere = \"hypot(x, y) < 5 mm\"\nfix = \"xy\"\nstages = [\"hole\"]\n[in_situ]";
    let pushed = "[[loads]]\nname = \"inside\"\nwhere = \"hypot(x, y) < 5 mm\"\nforce = { x = \"1 N\" }\nstages = [\"hole\"]\n[in_situ]";
    for (from, to, words) in [
        (excavate, "excavate = [\"cor\"]", "did you mean \"core\"?"),
        (excavate, "excavate = \"core\"", "expected a list of names of solid bodies"),
        (excavate, "excavate = [\"core\", \"core\"]", "has left in stage \"hole\""),
        (excavate, "excavate = [\"rock\", \"core\"]", "one solid at least that stays"),
        (excavate, "release_share = 0.5", "in a stage that takes nothing out"),
        (excavate, "", "has no effect in a stage in which nothing is released"),
        (excavate, "excavate = [\"core\"]\nrelease_share = 1.5", "above 0 and at most 1"),
        ("release = \"0.2 ms\"", "release = \"2 ms\"", "no more than the stage lasts"),
        ("release = \"0.2 ms\"", "release = \"-1 ms\"", "release"),
        ("release = \"0.2 ms\"", "release = \"2 mm\"", "a time"),
        ("release = \"0.2 ms\"", "releas = \"2 ms\"", "did you mean release?"),
        (before, "name = \"before\"\nexcavate = [\"core\"]\n", "in the first stage"),
        (before, "name = \"before\"\ninstall = [\"core\"]\n", "in the first stage"),
        (excavate, "excavate = [\"core\"]\ninstall = [\"cor\"]", "did you mean \"core\"?"),
        (excavate, "excavate = [\"core\"]\ninstall = [\"core\"]", "comes in in stage \"hole\" only"),
        (excavate, "install = [\"core\", \"core\"]", "is named 2 times"),
        (excavate, "install = [\"rock\"]\nexcavate = [\"core\"]", "one solid at least that stays"),
        ("[in_situ]", lining, "in stage \"before\" both are there"),
        ("[output]", third, "has left in stage \"hole\""),
        ("[in_situ]", held, "have left in stage \"hole\""),
        ("[in_situ]", pushed, "have left in stage \"hole\""),
        (
            "[in_situ]",
            "[[loads]]\ngroup = \"outer\"\npressure = \"1 MPa\"\nin_cracks = true\n[in_situ]",
            "what leaves would count as cracks",
        ),
    ] {
        let ended = hole(&[(from, to)]).fractum(&["check", "case.toml"]);
        assert!(ended.code == Some(1) && ended.stderr.contains(words), "{to}: {words}: {ended:?}");
    }
    let probe =
        "[[probes]]\nname = \"gone\"\ndisplacement = { group = \"core\", along = \"x\" }\n[[probes]]\nname = \"crown\"";
    let ended = hole(&[("[[probes]]\nname = \"crown\"", probe)]).fractum(&["check", "case.toml"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stdout.contains("[excavated]") || ended.stderr.contains("[excavated]"), "{ended:?}");
}

/// The pull ends at 1 ms on the one clock of both stages.
#[test]
fn a_pulse_that_begins_before_its_stage_is_told() {
    for (start, told) in [
        ("0 s", Some("[no-effect]")),
        ("0.9 ms", Some("1 ms on, where it leaps to 78.5 % of its peak")),
        ("1 ms", None),
    ] {
        let pulse = format!(
            "[[loads]]\ngroup = \"x+\"\npressure = {{ pulse = \"triangle\", peak = \"1 MPa\", start = \"{start}\", duration = \"0.2548 ms\" }}\nstages = [\"release\"]\n[[stages]]"
        );
        let ended = Workplace::new(&RELEASED.replacen("[[stages]]", &pulse, 1)).fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        assert_eq!(ended.stdout.contains("before it may act"), told.is_some(), "{}", ended.stdout);
        assert!(ended.stdout.contains(told.unwrap_or("")), "{}", ended.stdout);
    }
}

#[test]
fn a_displacement_that_begins_a_stage_elsewhere_is_told() {
    let second = |from: &str| {
        format!(
            "stages = [\"pull\"]\n[[supports]]\ngroup = \"x+\"\ndisplacement = {{ x = \"{from}\" }}\nstages = [\"release\"]\n"
        )
    };
    for (from, is_told) in [("5 um*(t - 1 ms)/1 ms", true), ("10 um + 5 um*(t - 1 ms)/1 ms", false)] {
        let place = Workplace::new(&RELEASED.replace("stages = [\"pull\"]\n", &second(from)));
        let ended = place.fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        let told = ended.stdout.contains("leaps by -10 µm as stage \"release\" begins, from 10 µm");
        assert_eq!((told, ended.stdout.contains("[jump]")), (is_told, is_told), "{}", ended.stdout);
    }
}
