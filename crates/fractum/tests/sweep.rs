//! Lists of runs as a job scheduler works through them: one at a time, by number, and one table at the end.

use std::fs;

use crate::common::{BREAKING_BAR, Workplace, signal, summary, wait_for_checkpoint};

/// Rows of a table without quotes, column by column of its header.
fn table(place: &Workplace, path: &str) -> (Vec<String>, Vec<Vec<String>>) {
    let text = fs::read_to_string(place.path(path)).unwrap();
    let mut rows = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    (rows.next().unwrap(), rows.collect())
}

#[test]
fn runs_of_a_list_are_done_by_number_and_collected() {
    let place = Workplace::new(BREAKING_BAR);
    let listed = place.fractum(&["sweep", "list", "case.toml", "--vary", "end=10 us,20 us,-1 s", "-o", "runs.csv"]);
    assert_eq!(listed.code, Some(0), "{}", listed.stderr);
    assert_eq!(fs::read_to_string(place.path("runs.csv")).unwrap().lines().nth(2), Some("2,case.toml,20 us"));
    for (run, code) in [("1", 0), ("2", 0), ("3", 1), ("4", 1)] {
        let ended = place.fractum(&["sweep", "run", "runs.csv", run]);
        assert_eq!(ended.code, Some(code), "{run}: {}", ended.stderr);
    }
    // What has finished is not done again, and is what `fractum run` gives.
    let before = fs::metadata(place.path("runs/2/summary.json")).unwrap().modified().unwrap();
    let again = place.fractum(&["sweep", "run", "runs.csv", "2"]);
    assert!(again.code == Some(0) && again.stderr.contains("has finished before"), "{}", again.stderr);
    assert_eq!(fs::metadata(place.path("runs/2/summary.json")).unwrap().modified().unwrap(), before);
    let direct = place.fractum(&["run", "case.toml", "--set", "end=20 us", "-o", "direct"]);
    assert_eq!(direct.code, Some(0), "{}", direct.stderr);
    assert_eq!(summary(&place, "direct")["state_hash"], summary(&place, "runs/2")["state_hash"]);

    let collected = place.fractum(&["sweep", "collect", "runs.csv"]);
    assert!(collected.stdout.starts_with("2 of 3 runs have finished"), "{}{}", collected.stdout, collected.stderr);
    let (header, rows) = table(&place, "runs/summary.csv");
    let value = |row: usize, name: &str| &rows[row][header.iter().position(|column| column == name).unwrap()];
    assert_eq!([0, 1, 2].map(|row| value(row, "end").as_str()), ["10 us", "20 us", "-1 s"]);
    assert_eq!([0, 1, 2].map(|row| value(row, "status").as_str()), ["completed", "completed", "missing"]);
    assert_eq!(*value(1, "state_hash"), summary(&place, "direct")["state_hash"].as_str().unwrap());
    let load = summary(&place, "direct")["probes"]["load"]["final"].as_f64().unwrap();
    assert_eq!(value(1, "probes.load.final").parse::<f64>().unwrap(), load);
}

#[test]
fn a_run_that_was_interrupted_goes_on_by_the_same_command() {
    let place = Workplace::new(BREAKING_BAR);
    let listed =
        place.fractum(&["sweep", "list", "case.toml", "--set", "end=0.3 ms", "--set", "output.checkpoint.every=1 ms"]);
    assert_eq!(listed.code, Some(0), "{}", listed.stderr);
    let mut run = place.start(&["sweep", "run", "runs.csv", "1"]);
    wait_for_checkpoint(&mut run, &place.path("runs/1"), 0);
    signal(&run, "INT");
    assert_eq!(run.wait().unwrap().code(), Some(130));
    assert_eq!(summary(&place, "runs/1")["status"], "interrupted");
    let collected = place.fractum(&["sweep", "collect", "runs.csv"]);
    assert!(collected.stdout.starts_with("0 of 1 runs have finished"), "{}", collected.stdout);
    let ended = place.fractum(&["sweep", "run", "runs.csv", "1"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let log = fs::read_to_string(place.path("runs/1/run.log")).unwrap();
    assert!(log.contains("interrupted") && log.contains("completed"), "{log}");
    let whole = place.fractum(&["run", "case.toml", "--set", "end=0.3 ms", "-o", "whole"]);
    assert_eq!(whole.code, Some(0), "{}", whole.stderr);
    assert_eq!(summary(&place, "runs/1")["state_hash"], summary(&place, "whole")["state_hash"]);
    // A state of another case is none to go on from.
    fs::write(place.path("case.toml"), BREAKING_BAR.replace("width = 0.1", "width = 0.2")).unwrap();
    let ended = place.fractum(&["sweep", "run", "runs.csv", "1"]);
    assert!(ended.code == Some(0) && ended.stderr.contains("starts anew"), "{}", ended.stderr);
    let whole = place.fractum(&["run", "case.toml", "--set", "end=0.3 ms", "-o", "whole", "--overwrite"]);
    assert_eq!(whole.code, Some(0), "{}", whole.stderr);
    assert_eq!(summary(&place, "runs/1")["state_hash"], summary(&place, "whole")["state_hash"]);
}

#[test]
fn a_run_of_the_same_name_with_another_end_is_another_run() {
    let place = Workplace::new(BREAKING_BAR);
    for end in ["10.3 us", "20 us", "5 us"] {
        let set = format!("end={end}");
        let listed = place.fractum(&["sweep", "list", "case.toml", "--set", &set]);
        assert_eq!(listed.code, Some(0), "{}", listed.stderr);
        let ended = place.fractum(&["sweep", "run", "runs.csv", "1"]);
        assert_eq!(ended.code, Some(0), "{end}: {}", ended.stderr);
        let direct = place.fractum(&["run", "case.toml", "--set", &set, "-o", "direct", "--overwrite"]);
        assert_eq!(direct.code, Some(0), "{}", direct.stderr);
        assert_eq!(summary(&place, "runs/1")["state_hash"], summary(&place, "direct")["state_hash"], "{end}");
    }
}

#[test]
fn results_stay_until_the_case_of_a_run_is_read() {
    let place = Workplace::new(BREAKING_BAR);
    let listed = place.fractum(&["sweep", "list", "case.toml", "--set", "end=10 us"]);
    assert_eq!(listed.code, Some(0), "{}", listed.stderr);
    assert_eq!(place.fractum(&["sweep", "run", "runs.csv", "1"]).code, Some(0));
    let before = summary(&place, "runs/1");
    fs::rename(place.path("bar.msh"), place.path("away.msh")).unwrap();
    let ended = place.fractum(&["sweep", "run", "runs.csv", "1", "--anew"]);
    assert_eq!(ended.code, Some(1), "{}", ended.stderr);
    assert_eq!(summary(&place, "runs/1"), before);
}

#[test]
fn a_run_that_went_on_to_another_end_by_hand_starts_anew() {
    let place = Workplace::new(BREAKING_BAR);
    let set = ["--set", "end=20 us", "--set", "output.checkpoint.every=1 ms"];
    let listed = place.fractum(&[&["sweep", "list", "case.toml"][..], &set].concat());
    assert_eq!(listed.code, Some(0), "{}", listed.stderr);
    assert_eq!(place.fractum(&["sweep", "run", "runs.csv", "1"]).code, Some(0));
    let later =
        ["run", "case.toml", "-o", "runs/1", "--resume", "--set", "end=30 us", "--set", "output.checkpoint.every=1 ms"];
    let ended = place.fractum(&later);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let ended = place.fractum(&["sweep", "run", "runs.csv", "1"]);
    assert!(ended.code == Some(0) && ended.stderr.contains("starts anew"), "{}", ended.stderr);
    assert_eq!(summary(&place, "runs/1")["time"]["end"], 20e-6);
}
