//! Wrong input: the exit code, one message a mistake with its place, no panic, no half-written file.

use std::f64::consts::PI;
use std::fs;
use std::path::PathBuf;

use crate::common::{BREAKING_BAR, Ended, Workplace, bar, files_below, mesh_bytes};
use fractum_mesh::{Mesh, MshFormat};
use serde_json::Value;

/// An elastic bar that is pulled: ends within a blink where it is right.
const SMALL: &str = r#"fractum = 1
title = "A bar"

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

[[supports]]
group = "x-"
fix = "xyz"

[[supports]]
group = "x+"
velocity = { x = "1 mm/s" }

[solver]
kind = "explicit"
end = "2 ms"

[[probes]]
name = "load"
reaction = { group = "x+", along = "x" }
"#;

/// [`SMALL`] with one text in place of another.
fn with(old: &str, new: &str) -> String {
    assert_eq!(SMALL.matches(old).count(), 1, "{old}");
    SMALL.replace(old, new)
}

/// Line and column at which a text begins in a case, from 1.
fn place(case: &str, text: &str) -> String {
    let (before, _) = case.split_once(text).unwrap();
    let column = before.len() - before.rfind('\n').map_or(0, |end| end + 1) + 1;
    format!("case.toml:{}:{column}: ", before.matches('\n').count() + 1)
}

/// [`BREAKING_BAR`] with an interval between checkpoints that nobody is warned of.
fn breaking_bar() -> String {
    BREAKING_BAR.replace("\"5 ms\"", "\"5 min\"")
}

/// What every failure owes its user: the exit code, as many lines as mistakes, no panic, nothing half written.
fn check_failure(place: &Workplace, ended: &Ended, code: i32, lines: usize, what: &str) {
    assert!(!ended.stderr.contains("panicked") && !ended.stdout.contains("panicked"), "{what}: {ended:?}");
    assert_eq!(ended.code, Some(code), "{what}: {ended:?}");
    assert_eq!(ended.stderr.lines().count(), lines, "{what}: {}", ended.stderr);
    assert_eq!(files_below(&place.path("out"), ".part"), Vec::<PathBuf>::new(), "{what}");
}

const RUN: [&str; 5] = ["run", "case.toml", "-o", "out", "--quiet"];

/// A wrong case on a good mesh: one message with place, key and these words, from `run` and `check` alike.
fn refused(case: &str, at: &str, key: &str, words: &[&str]) {
    let workplace = Workplace::new(case);
    let ended = workplace.fractum(&RUN);
    check_failure(&workplace, &ended, 1, 1, key);
    let start = format!("{}{key}", place(case, at));
    let rest = ended.stderr.strip_prefix(&start).unwrap_or_else(|| panic!("expected {start}: {}", ended.stderr));
    assert!(rest.starts_with([' ', ':']), "{}", ended.stderr);
    for word in words {
        assert!(ended.stderr.contains(word), "expected {word}: {}", ended.stderr);
    }
    assert!(!workplace.path("out").exists(), "{key}: a case that is wrong leaves no folder");
    let checked = workplace.fractum(&["check", "case.toml"]);
    assert_eq!((checked.code, &checked.stderr), (Some(1), &ended.stderr));
}

#[test]
fn the_case_that_these_tests_spoil_is_right() {
    let workplace = Workplace::new(SMALL);
    let ended = workplace.fractum(&RUN);
    assert_eq!((ended.code, ended.stderr.as_str(), ended.stdout.as_str()), (Some(0), "", ""));
}

#[test]
fn a_typo_in_a_key_names_the_nearest_one() {
    // A required key under a wrong name is one mistake, not one more that is missing.
    let words = ["is not a key", "did you mean young_modulus?"];
    let case = with("young_modulus", "young_modulos");
    refused(&case, "young_modulos", "materials.concrete.young_modulos", &words);
    let case = with("kind = \"explicit\"", "kind = \"explicit\"\nsafty = 0.8");
    refused(&case, "safty", "solver.safty", &["is not a key", "did you mean safety?"]);
}

#[test]
fn wrong_values_are_refused_with_what_was_expected() {
    let young = "materials.concrete.young_modulus";
    refused(&with("30 GPa", "30 m"), "\"30 m\"", young, &["30 m", "expected a pressure"]);
    refused(&with("30 GPa", "30 Gpa"), "Gpa\"", young, &["\"Gpa\" is not a unit", "did you mean \"GPa\"?"]);
    let poisson = "materials.concrete.poisson_ratio";
    refused(&with("poisson_ratio = 0.2", "poisson_ratio = 0.7"), "0.7", poisson, &["= 0.7", "between -1 and 0.5"]);
    let density = "materials.concrete.density";
    refused(&with("2400 kg", "-2400 kg"), "\"-2400 kg", density, &["= \"-2400 kg/m^3\"", "more than 0"]);
}

#[test]
fn an_unknown_group_names_the_nearest_one() {
    let words = ["= \"bodi\"", "groups there: ", "x+", "did you mean \"body\"?"];
    refused(&with("group = \"body\"", "group = \"bodi\""), "\"bodi\"", "bodies[0].group", &words);
}

#[test]
fn what_has_no_effect_is_refused() {
    let solid = "material = \"concrete\"\n";
    let plane = with(solid, &format!("{solid}plane = \"stress\"\n"));
    refused(&plane, "\"stress\"", "bodies[0].plane", &["tetrahedra", "remove the key"]);
    let thick = with(solid, &format!("{solid}thickness = \"1 cm\"\n"));
    refused(&thick, "\"1 cm\"", "bodies[0].thickness", &["tetrahedra", "remove the key"]);
    let unheld = with("along = \"x\"", "along = \"y\"");
    refused(
        &unheld,
        "\"x+\", along",
        "probes[0].reaction.group",
        &["nothing holds it along the direction", "a support prescribes"],
    );
}

#[test]
fn contradictory_supports_are_named() {
    // Of the same group, and of two groups that share nodes.
    let again = with("[solver]", "[[supports]]\ngroup = \"x+\"\nfix = \"x\"\n\n[solver]");
    refused(&again, "\"x\"\n\n[solver]", "supports[2].fix", &["\"x+\" along x too", "the support at line 27"]);
    let side = with("[solver]", "[[supports]]\ngroup = \"y-\"\nvelocity = { x = \"1 m/s\" }\n\n[solver]");
    refused(&side, "\"y-\"", "supports[2].group", &["x- and y- both prescribe x of the node at", "only once"]);
}

#[test]
fn an_element_too_large_for_its_fracture_energy_is_refused() {
    let words = ["body bar", "characteristic length", "refine the mesh", "reduce_strength_to_fit"];
    refused(&with("\"100 J/m^2\"", "\"1 J/m^2\""), "\"body\"", "bodies[0].group", &words);
}

#[test]
fn every_mistake_is_reported_at_once() {
    let case = with("30 GPa", "30 m")
        .replace("poisson_ratio = 0.2", "poisson_ratio = 0.7")
        .replace("2400 kg", "-2400 kg")
        .replace("kind = \"explicit\"", "kind = \"explicit\"\nsafty = 0.8");
    let workplace = Workplace::new(&case);
    let ended = workplace.fractum(&RUN);
    check_failure(&workplace, &ended, 1, 4, "four mistakes");
    for text in ["\"-2400", "\"30 m\"", "0.7", "safty"] {
        assert!(ended.stderr.lines().any(|line| line.starts_with(&place(&case, text))), "{text}: {}", ended.stderr);
    }
    let ended = workplace.fractum(&["run", "case.toml", "-o", "out", "--format", "json"]);
    check_failure(&workplace, &ended, 1, 4, "four mistakes as JSON");
    for line in ended.stderr.lines() {
        let value: Value = serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}: {line}"));
        assert_eq!(value["severity"], "error");
        assert_eq!(value["place"]["file"], "case.toml");
        assert!(value["place"]["line"].as_u64().unwrap() > 0 && value["place"]["column"].as_u64().unwrap() > 0);
        assert!(!value["place"]["key"].as_str().unwrap().is_empty() && !value["found"].as_str().unwrap().is_empty());
    }
}

#[test]
fn a_case_that_is_absent_or_no_toml_is_refused() {
    let workplace = Workplace::new("fractum = 1\n[mesh\n");
    let ended = workplace.fractum(&RUN);
    check_failure(&workplace, &ended, 1, 1, "broken TOML");
    assert!(ended.stderr.starts_with("case.toml:2:"), "{}", ended.stderr);
    let ended = workplace.fractum(&["run", "absent.toml", "-o", "out"]);
    check_failure(&workplace, &ended, 1, 1, "absent case");
    assert!(ended.stderr.contains("absent.toml"), "{}", ended.stderr);
    fs::write(workplace.path("case.toml"), [0xff, 0xfe, 0x00, 0x41]).unwrap();
    let ended = workplace.fractum(&RUN);
    check_failure(&workplace, &ended, 1, 1, "not UTF-8");
    assert!(ended.stderr.contains("case.toml"), "{}", ended.stderr);
}

/// A wrong mesh under a good case: one message that names the mesh, and where in it.
fn refused_mesh(mesh: Option<&[u8]>, words: &[&str]) {
    let workplace = Workplace::with_mesh(SMALL, mesh.unwrap_or_default());
    if mesh.is_none() {
        fs::remove_file(workplace.path("bar.msh")).unwrap();
    }
    let ended = workplace.fractum(&RUN);
    check_failure(&workplace, &ended, 1, 1, &format!("{words:?}"));
    assert!(ended.stderr.starts_with(&place(SMALL, "\"bar.msh\"")), "{}", ended.stderr);
    for word in [&["bar.msh"], words].concat() {
        assert!(ended.stderr.contains(word), "expected {word}: {}", ended.stderr);
    }
    assert!(!workplace.path("out").exists());
}

#[test]
fn a_mesh_that_cannot_be_read_is_refused() {
    let whole = mesh_bytes(&bar(), MshFormat::V4_1Binary);
    let text = mesh_bytes(&bar(), MshFormat::V4_1Ascii);
    refused_mesh(None, &["cannot read the mesh", "paths are taken from the folder of the case file"]);
    refused_mesh(Some(b""), &["empty"]);
    for part in [1, 2, 3] {
        refused_mesh(Some(&whole[..whole.len() * part / 4]), &["byte"]);
        refused_mesh(Some(&text[..text.len() * part / 4]), &["line"]);
    }
    // Bytes without any pattern (SplitMix64), and the same behind a good start.
    let random: Vec<u8> = (1u64..5000)
        .flat_map(|i| {
            let z = i.wrapping_mul(0x9e37_79b9_7f4a_7c15);
            ((z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9)).to_le_bytes()
        })
        .collect();
    refused_mesh(Some(&random), &["line 1"]);
    refused_mesh(Some(&[&whole[..whole.len() / 2], &random].concat()), &["byte"]);
}

#[test]
fn an_element_with_a_node_that_does_not_exist_is_refused() {
    let text = String::from_utf8(mesh_bytes(&bar(), MshFormat::V2_2Ascii)).unwrap();
    let nodes = bar().nodes.len();
    // The last element's last node.
    let end = text.find("$EndElements").unwrap();
    let line_start = text[..end - 1].rfind('\n').unwrap() + 1;
    let (kept, _) = text[line_start..end - 1].rsplit_once(' ').unwrap();
    let dangling = format!("{}{kept} {}\n{}", &text[..line_start], nodes + 55, &text[end..]);
    let line = format!("line {}", text[..end].lines().count());
    refused_mesh(Some(dangling.as_bytes()), &[&line, &format!("node {}", nodes + 55)]);
}

#[test]
fn an_element_without_volume_is_refused() {
    let mut mesh = bar();
    let [a, b, c, d] = mesh.tetrahedra[100];
    let corners = [a, b, c].map(|n| mesh.nodes[n as usize]);
    mesh.nodes[d as usize] = (corners[0] + corners[1] + corners[2]) / 3.0;
    let workplace = Workplace::with_mesh(SMALL, &mesh_bytes(&mesh, MshFormat::V4_1Binary));
    let ended = workplace.fractum(&RUN);
    check_failure(&workplace, &ended, 1, 1, "flat element");
    assert!(ended.stderr.starts_with("case.toml:"), "{}", ended.stderr);
    assert!(ended.stderr.contains("volume"), "{}", ended.stderr);
}

/// The state hash of a run of [`SMALL`] on this mesh, which must be right, and what the program said.
fn run_on(mesh: &Mesh) -> (String, String) {
    let workplace = Workplace::with_mesh(SMALL, &mesh_bytes(mesh, MshFormat::V4_1Binary));
    let ended = workplace.fractum(&["run", "case.toml", "-o", "out"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let summary: Value = serde_json::from_slice(&fs::read(workplace.path("out/summary.json")).unwrap()).unwrap();
    (summary["state_hash"].as_str().unwrap().to_owned(), ended.stderr)
}

#[test]
fn inverted_elements_are_flipped_with_a_notice() {
    let mut mesh = bar();
    let (_, said) = run_on(&mesh);
    assert!(!said.contains("flipped"), "{said}");
    for element in [3, 50, 400] {
        mesh.tetrahedra[element].swap(0, 1);
    }
    let (_, said) = run_on(&mesh);
    assert!(said.contains("3 tetrahedra of negative volume were flipped"), "{said}");
}

#[test]
fn a_folder_that_cannot_be_written_is_a_failure_of_the_machine() {
    let workplace = Workplace::new(SMALL);
    fs::write(workplace.path("file"), b"kept").unwrap();
    for folder in ["file", "file/below", "/dev/null/below", "/proc/fractum"] {
        let ended = workplace.fractum(&["run", "case.toml", "-o", folder, "--quiet"]);
        check_failure(&workplace, &ended, 3, 1, folder);
        assert!(ended.stderr.contains(folder), "{folder}: {}", ended.stderr);
        let ended = workplace.fractum(&["run", "case.toml", "-o", folder, "--quiet", "--format", "json"]);
        check_failure(&workplace, &ended, 3, 1, folder);
        let value: Value = serde_json::from_str(&ended.stderr).unwrap();
        assert_eq!(value["severity"], "error");
    }
    assert_eq!(fs::read(workplace.path("file")).unwrap(), b"kept");
}

/// A run that must fail on the machine while it writes the file `name`.
fn cannot_write(workplace: &Workplace, name: &str) -> String {
    let ended = workplace.fractum(&RUN);
    assert!(!ended.stderr.contains("panicked"), "{name}: {ended:?}");
    assert_eq!(ended.code, Some(3), "{name}: {ended:?}");
    assert_eq!(ended.stderr.lines().count(), 1, "{name}: {}", ended.stderr);
    assert!(ended.stderr.contains(name), "{name}: {}", ended.stderr);
    ended.stderr
}

#[test]
fn a_name_that_is_taken_is_a_failure_of_the_machine() {
    let files = ["history.csv", "run.log", "fields/solid-00003.vtu", "fields.pvd", "summary.json", "report.html"];
    for taken in files {
        let workplace = Workplace::new(&breaking_bar());
        fs::create_dir_all(workplace.path("out").join(taken)).unwrap();
        cannot_write(&workplace, taken);
    }
    for taken in ["fields", "particles", "checkpoint", "pictures"] {
        let workplace = Workplace::new(&breaking_bar());
        fs::create_dir_all(workplace.path("out")).unwrap();
        fs::write(workplace.path("out").join(taken), b"a file where a folder must go").unwrap();
        cannot_write(&workplace, taken);
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_a_failure_of_the_machine_that_leaves_no_half_file() {
    // The unfinished file of each result leads to the device that is always full.
    for name in ["history.csv", "run.log", "fields/solid-00003.vtu", "fields.pvd", "summary.json", "report.html"] {
        let workplace = Workplace::new(&breaking_bar());
        let results = workplace.path("out");
        fs::create_dir_all(results.join("fields")).unwrap();
        let growing = name == "run.log";
        let unfinished = if growing { name.to_owned() } else { format!("{name}.part") };
        std::os::unix::fs::symlink("/dev/full", results.join(unfinished)).unwrap();
        let message = cannot_write(&workplace, name);
        assert!(message.contains("disk is full"), "{message}");
        assert!(growing || !results.join(name).exists(), "{name} is written in half");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn limits_of_the_user_are_failures_of_the_machine() {
    // Blocks of 512 bytes, and KiB.
    for (limit, word) in [("-f 40", "too large"), ("-v 36000", "memory"), ("-v 44000", "memory")] {
        let workplace = Workplace::new(&breaking_bar());
        let program = workplace.command(&RUN);
        let mut shell = std::process::Command::new("sh");
        let command = format!("ulimit {limit}; exec \"$0\" \"$@\"");
        shell.args(["-c", &command]).arg(program.get_program()).args(program.get_args());
        let ended = shell.current_dir(program.get_current_dir().unwrap()).output().unwrap();
        let said = String::from_utf8_lossy(&ended.stderr);
        assert_eq!(ended.status.code(), Some(3), "{limit}: {said}");
        // A thread needs memory too.
        assert!(said.contains(word) || said.contains("threads could not be started"), "{limit}: {said}");
        assert!(!workplace.path("out/summary.json").exists());
    }
}

#[test]
fn an_unstable_run_stops_names_the_element_and_keeps_its_results() {
    let unstable = with("kind = \"explicit\"", "kind = \"explicit\"\nsafety = 1.5").replace("2 ms", "20 ms");
    let elastic = unstable.replace("name = \"bar\"", "name = \"bar\"\ndamage = false");
    for case in [unstable, elastic] {
        let workplace = Workplace::new(&case);
        let ended = workplace.fractum(&RUN);
        assert!(!ended.stderr.contains("panicked"), "{ended:?}");
        assert_eq!(ended.code, Some(2), "{ended:?}");
        let message = ended.stderr.lines().last().unwrap();
        for word in ["step ", "t = ", "element ", "of body bar", "stable limit", "lower solver.safety", "saved in out"]
        {
            assert!(message.contains(word), "expected {word}: {message}");
        }
        let out = workplace.path("out");
        let summary: Value = serde_json::from_slice(&fs::read(out.join("summary.json")).unwrap()).unwrap();
        assert_eq!(summary["status"], "stopped");
        for file in ["history.csv", "fields.pvd", "fields/solid-00000.vtu", "report.html", "run.log"] {
            assert!(out.join(file).is_file(), "{file}");
        }
        assert_eq!(files_below(&out, ".part"), Vec::<PathBuf>::new());
        assert!(fs::read_to_string(out.join("run.log")).unwrap().contains("element "));
    }
}

#[test]
fn a_wrong_override_is_refused() {
    let workplace = Workplace::new(&breaking_bar());
    for (set, words) in [("ende=1 ms", ["ende", "did you mean"]), ("end=1 kg", ["which is a mass", "expected a time"])]
    {
        let ended = workplace.fractum(&[&RUN[..], &["--set", set]].concat());
        check_failure(&workplace, &ended, 1, 1, set);
        for word in words {
            assert!(ended.stderr.contains(word), "{set}, expected {word}: {}", ended.stderr);
        }
    }
}

#[test]
#[cfg(target_os = "linux")]
fn what_is_larger_than_the_memory_is_refused_with_its_size() {
    let body = &SMALL[SMALL.find("[[bodies]]").unwrap()..SMALL.find("[solver]").unwrap()];
    let cloud = r#"[[bodies]]
name = "dust"
kind = "particles"
material = "concrete"
shape = "SHAPE"
particle_radius = "0.1 um"

"#;
    let shapes = [
        ("box\"\nsize = [\"1 m\", \"1 m\", \"1 m\"]", 1.0),
        ("sphere\"\nradius = \"1 m\"", 4.0 / 3.0 * PI),
        ("cylinder\"\naxis = \"z\"\nradius = \"1 m\"\nlength = \"1 m\"", PI),
    ];
    for (shape, volume) in shapes {
        let case = SMALL.replace(body, &cloud.replace("SHAPE\"", shape)).replace("[mesh]\nfile = \"bar.msh\"", "");
        let case = &case[..case.find("[[probes]]").unwrap()];
        let workplace = Workplace::new(case);
        let ended = workplace.fractum(&RUN);
        check_failure(&workplace, &ended, 3, 1, shape);
        assert!(ended.stderr.contains(" TiB of memory"), "{}", ended.stderr);
        let number = ended
            .stderr
            .split("body \"dust\" of about ")
            .nth(1)
            .and_then(|rest| rest.split(" particles needs about ").next());
        let count: f64 = number.and_then(|number| number.parse().ok()).unwrap_or_else(|| panic!("{}", ended.stderr));
        // A loose cloud fills a fifth to half of its region.
        let fraction = count * 4.0 / 3.0 * PI * 1e-7f64.powi(3) / volume;
        assert!((0.2..0.5).contains(&fraction), "{fraction}: {}", ended.stderr);
    }
    // A mesh of 8 TiB, of which nothing is on the disk.
    let workplace = Workplace::new(SMALL);
    fs::File::create(workplace.path("bar.msh")).unwrap().set_len(1 << 43).unwrap();
    let ended = workplace.fractum(&RUN);
    check_failure(&workplace, &ended, 3, 1, "mesh");
    assert!(ended.stderr.starts_with("reading ") && ended.stderr.contains("bar.msh needs about 16 TiB"), "{ended:?}");
}

#[test]
fn an_interval_beyond_all_time_is_never_over() {
    let workplace = Workplace::new(&format!("{SMALL}\n[output.checkpoint]\nevery = \"1e300 s\"\n"));
    let ended = workplace.fractum(&RUN);
    assert_eq!((ended.code, ended.stderr.as_str()), (Some(0), ""));
}

#[test]
fn a_wrong_option_is_wrong_input() {
    let workplace = Workplace::new(SMALL);
    for arguments in [
        &["run", "case.toml", "--thread", "2"][..],
        &["run"],
        &["walk"],
        &[],
        &["verify", "--stress"],
        &["lab", "strength", "tension"],
    ] {
        let ended = workplace.fractum(arguments);
        assert_eq!(ended.code, Some(1), "{arguments:?}: {ended:?}");
    }
    assert_eq!(workplace.fractum(&["--help"]).code, Some(0));
}

#[test]
#[cfg(target_os = "linux")]
fn output_that_nobody_takes_is_no_panic() {
    let workplace = Workplace::new(SMALL);
    let full = || fs::File::options().write(true).open("/dev/full").unwrap();
    let ended = workplace.command(&["schema"]).stdout(full()).output().unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert_eq!(ended.status.code(), Some(3), "{said}");
    assert!(said.starts_with("standard output cannot be written: ") && said.lines().count() == 1, "{said}");
    // Plan and progress are lost, the run is not.
    let ended = workplace.command(&["run", "case.toml", "-o", "out"]).stderr(full()).output().unwrap();
    assert_eq!(ended.status.code(), Some(0));
    assert!(workplace.path("out/summary.json").is_file());
    // A pipe whose reader has gone.
    let mut listing = workplace.command(&["explain"]);
    let mut listing =
        listing.stdout(std::process::Stdio::piped()).stderr(std::process::Stdio::piped()).spawn().unwrap();
    drop(listing.stdout.take());
    let ended = listing.wait_with_output().unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert_eq!((ended.status.code(), said.as_str()), (Some(0), ""));
}

#[test]
fn functions_that_are_no_numbers_are_found_before_the_run() {
    let words = ["is NaN at t = ", "expected a finite number during the whole run"];
    let case = with("x = \"1 mm/s\"", "x = \"sqrt(1 - t/10 us)*1 mm/s\"");
    refused(&case, "\"sqrt(1", "supports[1].velocity.x", &words);
    let case = with("[solver]", "[[loads]]\ngroup = \"x+\"\npressure = \"1 MPa*log(y/1 m - 1)\"\n[solver]");
    refused(&case, "\"1 MPa*log", "loads[0].pressure", &words);
    let case = with("[solver]", "[[loads]]\ngravity = { x = \"1 m/s^2/(t/1 s)\" }\n[solver]");
    refused(&case, "\"1 m/s^2/", "loads[0].gravity.x", &["is inf at t = 0 s"]);
}

#[test]
fn what_a_run_begins_with_is_a_number_everywhere() {
    let word = ["expected a finite number wherever it is taken"];
    let body = "group = \"body\"";
    let case = with(body, &format!("{body}\ninitial_velocity = {{ x = \"1 mm/s*x/abs(x)\" }}"));
    refused(&case, "\"1 mm/s*x/abs", "bodies[0].initial_velocity.x", &word);
}

#[test]
fn steps_and_ends_out_of_all_proportion_are_found_before_the_run() {
    let case = with("end = \"2 ms\"", "end = \"2 ms\"\nstep = \"2 ms\"");
    refused(&case, "\"2 ms\"\n\n[[probes]]", "solver.step", &["is above the stable step", "lower it, or leave it out"]);
    let case = with("end = \"2 ms\"", "end = \"1e30 s\"");
    refused(&case, "\"1e30 s\"", "solver.end", &["steps of", "expected an end within 1e15 steps"]);
}

#[test]
fn an_unknown_set_of_particles_is_told_before_twenty_million_are_packed() {
    let body = "[[bodies]]\nname = \"box\"\nkind = \"bonded\"\nshape = \"box\"\nsize = [1, 1, 1]\n\
                particles = 20000000\nmaterial = \"concrete\"\n\n[[supports]]\ngroup = \"x-\"";
    let case = with("[[supports]]\ngroup = \"x-\"", body);
    let of_set = case.replace("reaction = { group = \"x+\"", "reaction = { group = \"box.x=\"");
    let words = ["expected a set of particles of \"box\": box, box.x-", "did you mean \"box.x-\"?"];
    refused(&of_set, "\"box.x=\"", "probes[0].reaction.group", &words);
    let pressed = case.replace("[solver]", "[[loads]]\ngroup = \"box.x=\"\npressure = 1\n[solver]");
    refused(&pressed, "\"box.x=\"", "loads[0].group", &words);
}

#[test]
fn columns_of_the_history_have_different_names() {
    let workplace = Workplace::new(&with("name = \"load\"", "name = \"kinetic\""));
    assert_eq!(workplace.fractum(&RUN).code, Some(0));
    let history = fs::read_to_string(workplace.path("out/history.csv")).unwrap();
    let mut columns: Vec<&str> = history.lines().next().unwrap().split(',').collect();
    assert!(columns.contains(&"kinetic [J]") && columns.contains(&"probe.kinetic [N]"), "{columns:?}");
    let all = columns.len();
    columns.sort_unstable();
    columns.dedup();
    assert_eq!(columns.len(), all);
}

#[test]
fn the_information_on_a_mesh_is_json_where_that_is_asked() {
    let workplace = Workplace::new(SMALL);
    let ended = workplace.fractum(&["mesh", "info", "bar.msh", "--format", "json"]);
    let info: Value = serde_json::from_str(&ended.stdout).unwrap_or_else(|error| panic!("{error}: {}", ended.stdout));
    assert!(info["nodes"].as_u64().unwrap() > 0 && info["elements"]["tetrahedra"].as_u64().unwrap() > 0, "{info}");
    assert!(info["groups"].as_array().unwrap().iter().any(|group| group["name"] == "body"), "{info}");
}
