//! A run that is killed, interrupted or spread over other threads gives the same bits as one that is not.

use std::fs;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use crate::common::{BREAKING_BAR, Workplace, checkpoints, files_below, signal, wait_for_checkpoint};
use serde_json::Value;

/// Everything of a results folder that must not depend on how the run went.
#[derive(PartialEq)]
struct Results {
    state_hash: String,
    history: String,
    frames: Vec<(PathBuf, Vec<u8>)>,
    summary: Value,
}

impl Results {
    fn read(folder: &Path) -> Self {
        let text = |name: &str| fs::read_to_string(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
        let mut summary: Value = serde_json::from_str(&text("summary.json")).unwrap();
        assert_eq!(summary["status"], "completed");
        let state_hash = summary["state_hash"].as_str().unwrap().to_owned();
        // Of the summary, only these tell about the machine and the command.
        for key in ["wall", "threads", "origin"] {
            assert!(summary.as_object_mut().unwrap().remove(key).is_some(), "{key}");
        }
        let mut frames = vec![PathBuf::from("fields.pvd"), PathBuf::from("fragments.csv")];
        let below = |suffix| files_below(folder, suffix);
        let relative = |path: PathBuf| path.strip_prefix(folder).unwrap().to_owned();
        let tables = files_below(&folder.join("gauges"), ".csv");
        frames.extend(below(".vtu").into_iter().chain(below(".vtp")).chain(tables).map(relative));
        let frames = frames.into_iter().map(|name| (name.clone(), fs::read(folder.join(&name)).unwrap())).collect();
        Results { state_hash, history: text("history.csv"), frames, summary }
    }

    /// Fails with the first thing that differs, rather than with all bytes.
    fn assert_same(&self, other: &Results, what: &str) {
        assert_eq!(self.summary, other.summary, "{what}");
        for (row, (ours, theirs)) in self.history.lines().zip(other.history.lines()).enumerate() {
            assert_eq!(ours, theirs, "{what}: row {row} of history.csv");
        }
        assert_eq!(self.history.len(), other.history.len(), "{what}: length of history.csv");
        let names = |results: &Results| results.frames.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
        assert_eq!(names(self), names(other), "{what}");
        for ((name, ours), (_, theirs)) in self.frames.iter().zip(&other.frames) {
            assert!(ours == theirs, "{what}: {} differs", name.display());
        }
    }
}

fn uninterrupted(place: &Workplace, folder: &str, threads: &str) -> Results {
    let ended = place.fractum(&["run", "case.toml", "-o", folder, "--threads", threads, "--quiet"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    Results::read(&place.path(folder))
}

/// The same numbers on every machine (SplitMix64).
struct Dice(u64);

impl Dice {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) % limit
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let place = Workplace::new(BREAKING_BAR);
    let one = uninterrupted(&place, "one", "1");
    // The case must exercise what it is for.
    let counts = &one.summary["counts"];
    for what in ["removed_elements", "particles", "broken_edges"] {
        assert!(counts[what].as_u64().unwrap() > 0, "{what}: {counts}");
    }
    assert!(counts["fragments"].as_u64().unwrap() >= 2, "{counts}");
    assert!(one.summary["energy"]["friction"].as_f64().unwrap() > 0.0);
    for threads in ["2", "7"] {
        one.assert_same(&uninterrupted(&place, threads, threads), threads);
    }
}

#[test]
fn killed_at_any_moment_and_resumed_gives_the_same_bits() {
    killed_and_resumed(BREAKING_BAR, 2);
}

/// A plate with a fine zone at its notch, whose cells take short steps of their own until elements have left.
fn graded_plate() -> String {
    let mesh = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../meshes/graded-plate-plane/plate.msh");
    format!(
        r#"fractum = 1
mesh = {{ file = {mesh:?} }}
bodies = [{{ name = "plate", kind = "solid", group = "plate", material = "concrete", damage_where = "abs(x - 0.5) < 0.05" }}]
supports = [
  {{ group = "left", velocity = {{ x = {{ smooth_ramp = [["0 s", "0 m/s"], ["0.1 ms", "-0.2 m/s"]] }} }} }},
  {{ group = "right", velocity = {{ x = {{ smooth_ramp = [["0 s", "0 m/s"], ["0.1 ms", "0.2 m/s"]] }} }} }},
]
loads = [{{ gravity = {{ y = "-9.81 m/s^2" }} }}]
solver = {{ end = "0.6 ms", subcycling = true }}
damping = {{ local = 0.05 }}
probes = [{{ name = "load", reaction = {{ group = "right", along = "x" }} }}]
output = {{ history = {{ every = "10 us" }}, fields = {{ every = "0.1 ms" }}, checkpoint = {{ every = "0.1 s" }} }}
[materials.concrete]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0.2
[materials.concrete.damage]
tensile_strength = "3.33 MPa"
fracture_energy = "20 J/m^2"
"#
    )
}

#[test]
fn cells_with_short_steps_of_their_own_keep_the_bits() {
    let case = graded_plate();
    let place = Workplace::new(&case);
    let one = uninterrupted(&place, "one", "1");
    one.assert_same(&uninterrupted(&place, "three", "3"), "three threads");
    // Elements have left, and the steps with them became short for all.
    assert!(one.summary["counts"]["removed_elements"].as_u64().unwrap() > 0, "{}", one.summary["counts"]);
    let [last, least] = ["dt", "dt_min"].map(|key| one.summary["time"][key].as_f64().unwrap());
    let first: f64 = one.history.lines().nth(1).unwrap().split(',').nth(1).unwrap().parse().unwrap();
    assert!(least < 0.3 * first && last < first, "{first} {last} {least}");
    killed_and_resumed(&case, 1);
}

fn killed_and_resumed(case: &str, trials: u32) {
    let place = Workplace::new(case);
    let expected = uninterrupted(&place, "whole", "2");
    let mut dice = Dice(20);
    for trial in 0..trials {
        let folder = format!("killed-{trial}");
        let results = place.path(&folder);
        let (mut kills, mut resumed_from) = (0, Vec::new());
        loop {
            let saved = checkpoints(&results);
            let threads = (1 + dice.below(4)).to_string();
            let mut arguments = vec!["run", "case.toml", "-o", &folder, "--quiet", "--threads", &threads];
            if kills > 0 {
                if saved.is_empty() {
                    // Killed before it saved anything: there is nothing to resume, and it says so.
                    let ended = place.fractum(&[&arguments[..], &["--resume"]].concat());
                    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
                    assert!(ended.stderr.contains("no checkpoint to resume from"), "{}", ended.stderr);
                } else {
                    resumed_from.push(saved.last().copied().unwrap_or(0));
                    arguments.push("--resume");
                }
            }
            let mut run = place.start(&arguments);
            if kills < 6 {
                // Early kills hit the start of the program, the others a run that has come further than before.
                if kills > 1 || (trial == 0 && kills > 0) {
                    wait_for_checkpoint(&mut run, &results, saved.last().copied().unwrap_or(0));
                }
                thread::sleep(Duration::from_micros(dice.below(60_000)));
                run.kill().unwrap();
                let status = run.wait().unwrap();
                kills += 1;
                if status.success() {
                    break;
                }
            } else {
                assert!(run.wait().unwrap().success());
                break;
            }
        }
        assert!(!resumed_from.is_empty(), "no run was resumed");
        expected.assert_same(&Results::read(&results), &format!("trial {trial}, resumed from {resumed_from:?}"));
        assert_eq!(files_below(&results, ".part"), Vec::<PathBuf>::new(), "nothing unfinished is left behind");
    }
}

#[test]
fn a_signal_saves_the_state_and_the_run_goes_on_from_it() {
    let place = Workplace::new(BREAKING_BAR);
    // A run that does not end by itself while this test lasts.
    let arguments = ["run", "case.toml", "-o", "long", "--set", "end=1000 s"];
    let results = place.path("long");
    let mut step = 0;
    for name in ["INT", "TERM"] {
        let resume: &[&str] = if step > 0 { &["--resume"] } else { &[] };
        let mut run = place.start(&[&arguments[..], resume].concat());
        wait_for_checkpoint(&mut run, &results, step);
        signal(&run, name);
        assert_eq!(run.wait().unwrap().code(), Some(130), "SIG{name}");
        let summary: Value = serde_json::from_slice(&fs::read(results.join("summary.json")).unwrap()).unwrap();
        assert_eq!(summary["status"], "interrupted");
        let saved = checkpoints(&results).last().copied().unwrap();
        assert_eq!(summary["time"]["steps"].as_u64(), Some(saved), "the state of the last step is the one saved");
        assert!(saved > step);
        step = saved;
    }
}

#[test]
fn interrupted_and_resumed_gives_the_same_bits() {
    let place = Workplace::new(BREAKING_BAR);
    let expected = uninterrupted(&place, "whole", "2");
    let results = place.path("stopped");
    let mut code = None;
    for (round, name) in ["INT", "TERM", "INT"].into_iter().enumerate() {
        let saved = checkpoints(&results).last().copied().unwrap_or(0);
        let threads = (round + 1).to_string();
        let mut arguments = vec!["run", "case.toml", "-o", "stopped", "--quiet", "--threads", &threads];
        arguments.extend((round > 0).then_some("--resume"));
        let mut run = place.start(&arguments);
        wait_for_checkpoint(&mut run, &results, saved);
        signal(&run, name);
        code = run.wait().unwrap().code();
        // It may end before the signal comes.
        assert!(matches!(code, Some(0 | 130)), "{code:?}");
        if code == Some(0) {
            break;
        }
    }
    if code != Some(0) {
        let ended = place.fractum(&["run", "case.toml", "-o", "stopped", "--quiet", "--resume"]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    }
    expected.assert_same(&Results::read(&results), "after signals");
}

#[test]
fn a_finished_run_resumes_to_the_same_results() {
    let place = Workplace::new(BREAKING_BAR);
    let expected = uninterrupted(&place, "done", "2");
    let ended = place.fractum(&["run", "case.toml", "-o", "done", "--quiet", "--resume"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    expected.assert_same(&Results::read(&place.path("done")), "resumed after its end");
}

#[test]
fn a_bad_checkpoint_is_refused_with_its_reason() {
    let place = Workplace::new(BREAKING_BAR);
    uninterrupted(&place, "done", "2");
    let folder = place.path("done").join("checkpoint");
    let saved = files_below(&folder, ".fck");
    let newest = saved.last().unwrap().clone();
    // Only one is left, so that no older one can step in.
    saved.iter().filter(|path| **path != newest).for_each(|path| fs::remove_file(path).unwrap());
    let whole = fs::read(&newest).unwrap();
    let flipped = |byte: usize| {
        let mut bytes = whole.clone();
        bytes[byte] ^= 0x10;
        bytes
    };
    let middle = whole.len() / 2;
    let cases: [(&str, Vec<u8>, &[&str]); 7] = [
        ("truncated", whole[..middle].to_vec(), &["cut off", "older one"]),
        ("one byte short", whole[..whole.len() - 1].to_vec(), &["cut off"]),
        ("empty", Vec::new(), &["checkpoint"]),
        ("foreign", b"PNG, or anything else that is no checkpoint at all".to_vec(), &["not a fractum checkpoint"]),
        ("bit flipped in the state", flipped(middle), &["damaged"]),
        ("bit flipped at the end", flipped(whole.len() - 1), &["damaged"]),
        ("bytes appended", [&whole[..], b"more"].concat(), &["damaged"]),
    ];
    let before = Results::read(&place.path("done"));
    for (what, bytes, words) in cases {
        fs::write(&newest, bytes).unwrap();
        let ended = place.fractum(&["run", "case.toml", "-o", "done", "--quiet", "--resume"]);
        assert_eq!(ended.code, Some(1), "{what}: {}", ended.stderr);
        assert_eq!(ended.stderr.lines().count(), 1, "{what}: {}", ended.stderr);
        assert!(ended.stderr.contains(&*newest.file_name().unwrap().to_string_lossy()), "{what}: {}", ended.stderr);
        for word in words {
            assert!(ended.stderr.contains(word), "{what}: {}", ended.stderr);
        }
        before.assert_same(&Results::read(&place.path("done")), what);
    }
    // Whole, but of another case or mesh.
    fs::write(&newest, &whole).unwrap();
    let ended = place.fractum(&["run", "case.toml", "-o", "done", "--quiet", "--resume", "--set", "solver.safety=0.7"]);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert!(ended.stderr.contains("another case"), "{}", ended.stderr);
    let mut mesh = crate::common::bar();
    mesh.nodes[0].x += 1e-6;
    fs::write(place.path("bar.msh"), crate::common::mesh_bytes(&mesh, fractum_mesh::MshFormat::V4_1Binary)).unwrap();
    let ended = place.fractum(&["run", "case.toml", "-o", "done", "--quiet", "--resume"]);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert!(ended.stderr.contains("another mesh"), "{}", ended.stderr);
}

#[test]
fn a_damaged_history_is_refused_before_the_run_goes_on() {
    let place = Workplace::new(BREAKING_BAR);
    uninterrupted(&place, "done", "2");
    let path = place.path("done").join("history.csv");
    let mut rows = fs::read(&path).unwrap();
    let middle = rows.len() / 4;
    rows[middle] ^= 1;
    fs::write(&path, &rows).unwrap();
    let log = || fs::read_to_string(place.path("done").join("run.log")).unwrap();
    let before = log().matches("state saved").count();
    let ended = place.fractum(&["run", "case.toml", "-o", "done", "--quiet", "--resume"]);
    assert_eq!(ended.code, Some(3), "{}", ended.stderr);
    assert!(ended.stderr.contains("history.csv: it was changed or damaged since"), "{}", ended.stderr);
    assert_eq!(log().matches("state saved").count(), before, "nothing was computed");
    assert!(fs::read(&path).unwrap() == rows);
}

#[test]
fn a_run_that_cannot_go_on_writing_has_a_state_from_its_start() {
    let place = Workplace::new(&BREAKING_BAR.replace("every = \"5 ms\"", "every = \"1000 s\""));
    let expected = uninterrupted(&place, "whole", "2");
    let results = place.path("full");
    // A name that is taken stands for a disk that is full: the first frame cannot be written.
    fs::create_dir_all(results.join("fields.pvd/taken")).unwrap();
    let ended = place.fractum(&["run", "case.toml", "-o", "full", "--quiet"]);
    assert_eq!(ended.code, Some(3), "{}", ended.stderr);
    fs::remove_dir_all(results.join("fields.pvd")).unwrap();
    let ended = place.fractum(&["run", "case.toml", "-o", "full", "--quiet", "--resume"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    expected.assert_same(&Results::read(&results), "from its first state");
}

#[test]
fn a_damaged_checkpoint_gives_way_to_the_one_before() {
    let place = Workplace::new(BREAKING_BAR);
    let expected = uninterrupted(&place, "done", "2");
    let saved = files_below(&place.path("done").join("checkpoint"), ".fck");
    assert_eq!(saved.len(), 2, "the newest and the one before: {saved:?}");
    let whole = fs::read(&saved[1]).unwrap();
    fs::write(&saved[1], &whole[..whole.len() / 3]).unwrap();
    let ended = place.fractum(&["run", "case.toml", "-o", "done", "--quiet", "--resume"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stderr.contains("warning") && ended.stderr.contains("cut off"), "{}", ended.stderr);
    let mut again = Results::read(&place.path("done"));
    // That it could not be read is all that is new.
    let warning = again.summary["warnings"].as_array_mut().unwrap().pop().unwrap();
    assert_eq!(warning["code"], "checkpoint");
    expected.assert_same(&again, "from the older checkpoint");
}

#[test]
fn without_a_checkpoint_there_is_nothing_to_resume() {
    let place = Workplace::new(BREAKING_BAR);
    let ended = place.fractum(&["run", "case.toml", "-o", "never", "--resume"]);
    assert_eq!(ended.code, Some(1));
    assert_eq!(ended.stderr.lines().count(), 1, "{}", ended.stderr);
    assert!(ended.stderr.contains("never: no checkpoint to resume from; run without --resume"), "{}", ended.stderr);
    assert!(!place.path("never").exists());
}

/// A brittle bar at equilibrium, which moves where it snaps back.
const SNAPPING_BAR: &str = r#"fractum = 1

[mesh]
file = "bar.msh"

[materials.concrete]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0.2
[materials.concrete.damage]
tensile_strength = "3 MPa"
fracture_energy = "15 J/m^2"

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
displacement = { x = "0.06 mm*t/1 s" }

[solver]
kind = "static"
control = "time"
no_equilibrium = "motion"
end = "1 s"

[[probes]]
name = "load"
reaction = { group = "x+", along = "x" }

[output.checkpoint]
every = "20 ms"
"#;

/// Results of a case that is ended by these signals in turn, each at least `steps` after the last checkpoint, and resumed.
fn interrupted(place: &Workplace, signals: &[&str], steps: u64) -> Results {
    let results = place.path("stopped");
    let mut code = None;
    for name in signals.iter().map(Some).chain([None]) {
        let saved = checkpoints(&results).last().copied().unwrap_or(0);
        let mut arguments = vec!["run", "case.toml", "-o", "stopped", "--quiet", "--threads", "1"];
        arguments.extend(results.exists().then_some("--resume"));
        let mut run = place.start(&arguments);
        if let Some(name) = name {
            wait_for_checkpoint(&mut run, &results, saved + steps);
            signal(&run, name);
        }
        code = run.wait().unwrap().code();
        assert!(matches!(code, Some(0 | 130)) || name == Some(&"KILL"), "{name:?}: {code:?}");
        if code == Some(0) {
            break;
        }
    }
    assert_eq!(code, Some(0));
    Results::read(&results)
}

#[test]
fn a_run_at_equilibrium_and_in_motion_goes_on_with_the_same_bits() {
    let place = Workplace::new(SNAPPING_BAR);
    let expected = uninterrupted(&place, "whole", "2");
    assert!(expected.history.lines().any(|line| line.contains(",1,")), "it moves");
    let signals = ["INT", "TERM", "INT", "TERM", "INT", "TERM", "INT"];
    expected.assert_same(&interrupted(&place, &signals, 5), "at equilibrium, after signals");
}

/// A bonded bar that is pulled apart at rest, from break to break.
const BONDED_BAR: &str = r#"fractum = 1

[materials.glass]
density = "2500 kg/m^3"
young_modulus = "72 GPa"
poisson_ratio = 0.23
[materials.glass.fracture]
criterion_strength = "60 MPa"

[[bodies]]
name = "bar"
kind = "bonded"
material = "glass"
shape = "box"
size = ["2 mm", "1 mm", "1 mm"]
particles = 600
coordination = 8

[[supports]]
group = "bar.x-"
fix = "x"
[[supports]]
group = "bar.x+"
displacement = { x = "6 um*t/1 s" }

[solver]
kind = "static"
end = "1 s"

[[probes]]
name = "pull"
reaction = { group = "bar.x+", along = "x" }

[output]
fields = { every = "0.2 s" }
checkpoint = { every = "1 ms" }
"#;

#[test]
fn a_bonded_body_at_rest_goes_on_with_the_same_bits() {
    let place = Workplace::new(BONDED_BAR);
    let expected = uninterrupted(&place, "whole", "2");
    assert!(expected.summary["counts"]["broken_bonds"].as_u64().unwrap() > 50, "{}", expected.summary);
    let signals = ["INT", "KILL", "TERM", "KILL", "KILL", "INT"];
    expected.assert_same(&interrupted(&place, &signals, 2), "from break to break, after signals");
}
