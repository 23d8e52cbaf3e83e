//! A results folder is not overwritten unasked, says where it came from, and lets a run be continued.

use std::fs;
use std::process::Command;

use crate::common::{
    BREAKING_BAR, SNAP_BACK, Workplace, checkpoints, files_below, run, signal, summary, wait_for_checkpoint,
};

#[test]
fn results_are_replaced_only_where_the_user_says_so() {
    let place = Workplace::new(BREAKING_BAR);
    run(&place, "out", "2");
    let names = ["summary.json", "history.csv", "fields.pvd", "run.log"];
    let contents = || names.map(|name| fs::read(place.path("out").join(name)).unwrap());
    let before = contents();
    let ended = place.fractum(&["run", "case.toml", "-o", "out", "--quiet"]);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    for word in ["out: holds the results of another run", "--resume", "--overwrite", "-o"] {
        assert!(ended.stderr.contains(word), "{word}: {}", ended.stderr);
    }
    assert!(contents() == before, "the results are as they were");
    // A state alone is worth keeping, too.
    for name in ["summary.json", "history.csv"] {
        fs::remove_file(place.path("out").join(name)).unwrap();
    }
    assert_eq!(place.fractum(&["run", "case.toml", "-o", "out", "--quiet"]).code, Some(1));
    let both = place.fractum(&["run", "case.toml", "-o", "out", "--overwrite", "--resume"]);
    assert_eq!(both.code, Some(1), "{}", both.stderr);
    assert_eq!(place.fractum(&["movie", "out", "--width", "40", "--height", "30"]).code, Some(0));
    fs::rename(place.path("case.toml"), place.path("shorter.toml")).unwrap();
    let of_the_user =
        ["pictures/sketch.svg", "pictures/photo.png", "input/other.toml"].map(|name| place.path("out").join(name));
    of_the_user.iter().for_each(|path| fs::write(path, "own").unwrap());
    let strip = || {
        let pictures = files_below(&place.path("out/pictures"), ".png");
        pictures.iter().filter(|path| path.to_string_lossy().contains("strip-")).count()
    };
    assert!(strip() > 3);
    let ended = place.fractum(&["run", "shorter.toml", "-o", "out", "--quiet", "--overwrite", "--set", "end=0.1 ms"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_eq!(summary(&place, "out")["status"], "completed");
    // Nothing of the longer run is left, and what is not of a run stays.
    assert!(!place.path("out/movie.png").exists() && strip() < 3);
    assert!(!place.path("out/input/case.toml").exists() && place.path("out/input/shorter.toml").exists());
    assert!(of_the_user.iter().all(|path| path.exists()));
    let listed = fs::read_to_string(place.path("out/fields.pvd")).unwrap();
    for path in files_below(&place.path("out"), ".vtu") {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        assert!(listed.contains(&name), "{name}");
    }
}

#[test]
fn a_run_that_was_killed_within_its_first_save_starts_anew_unasked() {
    let place = Workplace::new(BREAKING_BAR);
    fs::create_dir_all(place.path("out/checkpoint")).unwrap();
    fs::write(place.path("out/checkpoint/state-000000000012.fck.part"), "half").unwrap();
    let ended = place.fractum(&["run", "case.toml", "-o", "out", "--quiet", "--set", "end=1 us"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
}

#[test]
fn files_of_the_user_stay_where_no_run_has_been() {
    let place = Workplace::new(BREAKING_BAR);
    let names = ["input/other.toml", "pictures/damage.png", "movie.png", "solid/mine.vtu", "gauges/face.csv"];
    for path in names.map(|name| place.path(name)) {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, "own").unwrap();
    }
    let ended = place.fractum(&["run", "case.toml", "-o", ".", "--quiet", "--set", "end=1 us"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    for name in ["input/other.toml", "movie.png", "solid/mine.vtu", "gauges/face.csv"] {
        assert_eq!(fs::read_to_string(place.path(name)).unwrap(), "own", "{name}");
    }
    // A case among them is one of the user's files, too; so is what has no name of a frame.
    fs::copy(place.path("case.toml"), place.path("input/a.toml")).unwrap();
    fs::copy(place.path("bar.msh"), place.path("input/bar.msh")).unwrap();
    for case in ["input/a.toml", "case.toml"] {
        let ended = place.fractum(&["run", case, "-o", ".", "--quiet", "--overwrite", "--set", "end=1 us"]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    }
    let kept = ["input/a.toml", "input/other.toml", "solid/mine.vtu", "gauges/face.csv"];
    assert!(kept.iter().all(|name| place.path(name).exists()));
}

#[test]
fn the_printed_command_goes_on_with_an_interrupted_run() {
    let place = Workplace::new(BREAKING_BAR);
    fs::rename(place.path("case.toml"), place.path("my case.toml")).unwrap();
    let arguments = ["run", "my case.toml", "-o", "it's out", "--set", "end=1000 s", "--set", "solver.safety=0.7"];
    let mut run = place.command(&arguments);
    let mut run = run.stdout(std::process::Stdio::null()).stderr(std::process::Stdio::piped()).spawn().unwrap();
    let results = place.path("it's out");
    wait_for_checkpoint(&mut run, &results, 0);
    signal(&run, "INT");
    let told = String::from_utf8(run.wait_with_output().unwrap().stderr).unwrap();
    let (_, command) = told.split_once("go on with: ").unwrap_or_else(|| panic!("{told}"));
    let step = checkpoints(&results).last().copied().unwrap();
    // As it stands, but for an end that comes.
    let shorter = command.trim().replace("end=1000 s", "end=0.3 ms");
    let output = Command::new("sh").args(["-c", &shorter]).current_dir(place.path("")).output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{shorter}\n{told}");
    assert!(told.contains(&format!("goes on from step {step}, t = ")), "{told}");
    assert!(told.contains("to t = 300 µs instead of 1000 s"), "{told}");
}

#[test]
fn a_finished_run_goes_on_to_a_later_end() {
    let place = Workplace::new(BREAKING_BAR);
    let rows = || fs::read_to_string(place.path("out/history.csv")).unwrap();
    let run = |extra: &[&str]| {
        let ended = place.fractum(&[&["run", "case.toml", "-o", "out", "--quiet"], extra].concat());
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        summary(&place, "out")
    };
    let short = run(&["--set", "end=0.4 ms"]);
    let before = rows();
    let long = run(&["--resume"]);
    let log = fs::read_to_string(place.path("out/run.log")).unwrap();
    let steps = short["time"]["steps"].as_u64().unwrap();
    assert!(log.contains(&format!("goes on from step {steps}, t = ")), "{log}");
    assert!(long["time"]["end"].as_f64().unwrap() >= 1e-3 * (1.0 - 1e-9), "{}", long["time"]);
    // All rows of the shorter run but the one that its last instant got for its end.
    let (kept, _) = before.trim_end().rsplit_once('\n').unwrap();
    assert!(rows().starts_with(kept) && rows().len() > 2 * kept.len());
    let times = crate::common::history(&place, "out", &["time"]);
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]));
    assert!(long["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-4, "{}", long["energy"]);
    let early = place.fractum(&["run", "case.toml", "-o", "out", "--resume", "--set", "end=0.2 ms"]);
    assert_eq!(early.code, Some(1), "{}", early.stderr);
    assert!(early.stderr.contains("solver.end = 200 µs: the saved run has reached"), "{}", early.stderr);
}

#[test]
fn rows_and_frames_of_a_run_with_a_later_end_go_on() {
    let case = BREAKING_BAR.replace("fields = { every = \"0.1 ms\" }\nhistory = { every = \"10 us\" }", "");
    let place = Workplace::new(&case);
    let run = |extra: &[&str]| {
        let ended = place.fractum(&[&["run", "case.toml", "-o", "out", "--quiet"], extra].concat());
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        let listed = fs::read_to_string(place.path("out/fields.pvd")).unwrap();
        let rows = crate::common::history(&place, "out", &["time"]);
        (rows.len(), listed.matches("name=\"solid\"").count())
    };
    let (rows, frames) = run(&["--set", "end=0.2 ms"]);
    let (more_rows, more_frames) = run(&["--resume", "--set", "end=0.4 ms"]);
    // A 50th and a 1000th of the run, which is now twice as long; rows are those of steps.
    assert!(more_rows > rows && more_frames > frames + 20, "{rows} {more_rows} {frames} {more_frames}");
    let times = crate::common::history(&place, "out", &["time"]);
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]));
}

#[test]
fn the_state_that_a_stopped_run_names_is_there() {
    let place = Workplace::new(&SNAP_BACK.replace("kind = \"static\"", "kind = \"static\", control = \"time\""));
    let ended = place.fractum(&["run", "case.toml", "-o", "out", "--quiet"]);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    let step = checkpoints(&place.path("out")).last().copied().unwrap();
    assert!(
        ended.stderr.contains(&format!("last good state saved in out: step {step}, load factor ")),
        "{}",
        ended.stderr
    );
    let steps = crate::common::history(&place, "out", &["time"]).len() as u64;
    assert!(step > 0 && step <= steps, "the last equilibrium, {step} of {steps}");
    let summary = summary(&place, "out");
    assert_eq!(summary["time"]["steps"].as_u64(), Some(step));
}

#[test]
fn results_say_where_they_come_from() {
    let place = Workplace::new(BREAKING_BAR);
    let ended = place.fractum(&["run", "case.toml", "-o", "out", "--quiet", "--set", "end=0.1 ms"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_eq!(fs::read_to_string(place.path("out/input/case.toml")).unwrap(), BREAKING_BAR);
    let origin = summary(&place, "out")["origin"].clone();
    assert_eq!(origin["overrides"], serde_json::json!(["end=0.1 ms"]));
    assert_eq!(origin["command"], "fractum run case.toml -o out --set 'end=0.1 ms' --quiet");
    let hash = format!("{:032x}", xxhash_rust::xxh3::xxh3_128(&fs::read(place.path("bar.msh")).unwrap()));
    assert_eq!(origin["files"][0]["hash"].as_str(), Some(&*hash));
    let started = origin["started"].as_str().unwrap();
    assert!(started.starts_with("20") && started.ends_with('Z'), "{started}");
    let page = fs::read_to_string(place.path("out/report.html")).unwrap();
    let log = fs::read_to_string(place.path("out/run.log")).unwrap();
    for word in [&*hash, started, "end=0.1 ms"] {
        assert!(page.contains(word) && log.contains(word), "{word}");
    }
}
