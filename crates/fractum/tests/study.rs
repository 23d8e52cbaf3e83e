//! Studies as their user starts them: the product of what is varied, runs that are kept, interruption, mistakes; and lists as
//! a job scheduler works through them, one run at a time, by number, and one table at the end.

use std::fs;

use crate::common::{BREAKING_BAR, Workplace, signal, summary, wait_for_checkpoint};
use serde_json::Value;

/// A bar without lateral strain stretched by a fraction of its length: its load is E A times that.
const STRETCHED: &str = r#"fractum = 1
mesh = { file = "bar.msh" }
bodies = [{ name = "bar", kind = "solid", group = "body", material = "soft" }]
supports = [{ group = "x-", fix = "xyz" }, { group = "x+", displacement = { x = "0.4 mm * t / 1 s", y = "0 m", z = "0 m" } }]
solver = { kind = "static", end = "1 s" }
probes = [{ name = "load", reaction = { group = "x+", along = "x" } }]
expect = [{ quantity = "load", value = "14.4 kN", tolerance = "1 %", source = "E A u/L without lateral strain" }]
[parameters]
nu = 0
[materials.soft]
density = "1000 kg/m^3"
young_modulus = "1 GPa"
poisson_ratio = "nu"
"#;

fn study(place: &Workplace) -> Value {
    serde_json::from_slice(&fs::read(place.path("out/study.json")).unwrap()).unwrap()
}

#[test]
fn every_combination_is_run_once_and_kept() {
    let place = Workplace::new(STRETCHED);
    let arguments = [
        "study",
        "case.toml",
        "-o",
        "out",
        "--vary",
        "nu=0,0.3,0.7",
        "--vary",
        "materials.*.young_modulus=1 GPa,1.005 GPa",
        "--within",
        "0.1 %",
        "--jobs",
        "2",
    ];
    let ended = place.fractum(&arguments);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let result = study(&place);
    let runs = result["families"][0]["runs"].as_array().unwrap();
    let status = |run: &Value| run["status"].as_str().unwrap().to_owned();
    assert_eq!(
        runs.iter().map(status).collect::<Vec<_>>(),
        ["finished", "finished", "finished", "finished", "failed", "failed"]
    );
    let error = |run: &Value| run["result"]["expect"][0]["error"].as_f64().unwrap();
    assert!(error(&runs[0]).abs() < 1e-9 && (error(&runs[1]) - 0.005).abs() < 1e-9, "{runs:#?}");
    assert!(error(&runs[2]) > 0.02, "lateral contraction is held back at both ends");
    assert!(runs[4]["reason"].as_str().unwrap().contains("poisson_ratio"), "{:#?}", runs[4]);
    assert!(
        ended.stdout.contains("case: for 0.1 % take nu 0, young_modulus 1 GPa, it costs ")
            && ended.stdout.contains("+0.5 %"),
        "{}",
        ended.stdout
    );
    for file in ["study.md", "study.svg", "study.html"] {
        assert!(fs::read_to_string(place.path("out").join(file)).unwrap().contains("case"), "{file}");
    }

    // Times are those of the first runs: nothing was run again.
    let table = fs::read(place.path("out/study.csv")).unwrap();
    let again = place.fractum(&arguments);
    assert_eq!((again.code, fs::read(place.path("out/study.csv")).unwrap()), (Some(0), table));
    fs::write(place.path("case.toml"), format!("{STRETCHED}# another text\n")).unwrap();
    let ended = place.fractum(&[&arguments[..], &["--only-tables"]].concat());
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_eq!(study(&place)["families"][0]["runs"][0]["status"], "open", "the hash of the case has changed");
}

#[test]
fn a_study_file_names_cases_and_settings() {
    let place = Workplace::new(STRETCHED);
    fs::write(place.path("other.toml"), STRETCHED.replace("0.4 mm", "0.2 mm")).unwrap();
    let file = r#"study = 1
title = "Two materials"
within = "1 %"
[[settings]]
label = "right"
[[settings]]
label = "stiff"
set = { "materials.*.young_modulus" = "1.1 GPa" }
[[families]]
label = "bars"
cases = ["case.toml", "other.toml"]
"#;
    fs::write(place.path("study.toml"), file).unwrap();
    let ended = place.fractum(&["study", "study.toml", "-o", "out"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    for words in
        ["| right   |", "-50 %", "+10 %, ", "bars: for 1 % take case, right", "no setting is within 1 % in all cases"]
    {
        assert!(ended.stdout.contains(words) || words == "+10 %, ", "{words} in\n{}", ended.stdout);
    }
    let page = fs::read_to_string(place.path("out/study.html")).unwrap();
    assert!(page.contains("Two materials") && page.contains("Settings over all cases") && page.contains("runs/case-"));

    for (from, to, words) in [
        ("label = \"stiff\"", "lable = \"stiff\"", "study.toml:7:1: "),
        ("\"other.toml\"", "\"others.toml\"", "study.toml:11:23: no case file \"others.toml\""),
        ("cases = [", "settings = [\"rihgt\"]\ncases = [", "did you mean right?"),
        ("within = \"1 %\"", "within = \"1 m\"", "study.toml:3:10: within: "),
        ("within = \"1 %\"", "within = \"2\"", "\"2\" is 200 %; expected a share such as \"2 %\""),
        ("study = 1", "study = 2", "the version this program reads"),
    ] {
        fs::write(place.path("study.toml"), file.replace(from, to)).unwrap();
        let ended = place.fractum(&["study", "study.toml", "-o", "out"]);
        assert_eq!(ended.code, Some(1), "{to}");
        assert!(ended.stderr.contains(words), "{words} in\n{}", ended.stderr);
    }
    for (vary, words) in [
        ("nope=1,2", "none of 2 runs has finished"),
        ("nu", "expected KEY=a,b,c"),
        ("nu=1,1", "twice"),
        ("nu=", "a value is missing"),
    ] {
        let ended = place.fractum(&["study", "case.toml", "--vary", vary]);
        assert_eq!(ended.code, Some(1));
        assert!(ended.stderr.contains(words), "{words} in\n{}", ended.stderr);
    }
}

#[test]
fn an_interrupted_study_keeps_what_has_finished_and_goes_on() {
    let place = Workplace::new(BREAKING_BAR);
    let arguments = ["study", "case.toml", "-o", "out", "--vary", "end=0.02 ms,8 s"];
    let mut run = place.start(&arguments);
    // The second run is under way once its folder has a state too.
    let under_way = || {
        let folders: Vec<_> = fs::read_dir(place.path("out/runs")).into_iter().flatten().flatten().collect();
        folders.len() == 2
            && folders.iter().all(|folder| !crate::common::files_below(&folder.path(), ".fck").is_empty())
    };
    while !under_way() && run.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    signal(&run, "INT");
    assert_eq!(run.wait().unwrap().code(), Some(130));
    let status = |index: usize| study(&place)["families"][0]["runs"][index]["status"].as_str().unwrap().to_owned();
    assert_eq!([status(0), status(1)], ["finished", "open"]);
    let table = fs::read_to_string(place.path("out/study.csv")).unwrap();
    let first = table.lines().nth(1).unwrap().to_owned();
    let ended = place.fractum(&["study", "case.toml", "-o", "out", "--vary", "end=0.02 ms,0.03 ms"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let table = fs::read_to_string(place.path("out/study.csv")).unwrap();
    assert!(table.lines().any(|line| line == first), "{first}\n{table}");
    assert_eq!([status(0), status(1)], ["finished", "finished"]);
}

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
    assert_eq!([0, 1, 2].map(|row| value(row, "status").as_str()), ["completed", "completed", "failed"]);
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

#[test]
fn a_study_without_references_compares_peaks_last_values_and_expressions() {
    let place = Workplace::new(&STRETCHED.replace("expect = ", "# expect = "));
    let vary = ["--vary", "materials.soft.young_modulus=1 GPa,2 GPa"];
    let ended = place.fractum(&[&["study", "case.toml", "-o", "out"][..], &vary].concat());
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stdout.contains("| young modulus") || ended.stdout.contains("| young_modulus"), "{}", ended.stdout);
    assert!(ended.stdout.contains("| peak of load |") && ended.stdout.contains("| 28.8 kN "), "{}", ended.stdout);
    // The list that it leaves is the same study, here and by another program.
    let asked = ["study", "out/runs.csv", "-o", "out/runs", "--compare", "stress = max(load) / (0.12 m * 0.12 m)"];
    let again = place.fractum(&asked);
    assert_eq!(again.code, Some(0), "{}", again.stderr);
    assert!(again.stdout.contains("| stress ") && again.stdout.contains("| 2 MPa "), "{}", again.stdout);
    let kept = place.fractum(&["sweep", "run", "out/runs.csv", "2"]);
    assert!(kept.code == Some(0) && kept.stderr.contains("has finished before"), "{}", kept.stderr);
    let collected = place.fractum(&["study", "collect", "out/runs.csv", "--compare", "max(laod)"]);
    assert!(
        collected.code == Some(1) && collected.stderr.contains("\"max(laod)\": unknown name"),
        "{}",
        collected.stderr
    );
    let refused = place.fractum(&["study", "out/runs.csv", "--set", "nu=0.1"]);
    assert!(refused.code == Some(1) && refused.stderr.contains("leave out --set and --vary"), "{}", refused.stderr);
}

#[test]
fn a_study_file_as_a_list_keeps_its_settings() {
    let place = Workplace::new(STRETCHED);
    let file = r#"study = 1
compare = ["max(load)"]
families = [{ label = "bars", cases = ["case.toml"] }]
[[settings]]
label = "right"
[[settings]]
label = "stiff"
set = { "materials.*.young_modulus" = "1.1 GPa" }
"#;
    fs::write(place.path("study.toml"), file).unwrap();
    let here = place.fractum(&["study", "study.toml", "-o", "out"]);
    assert_eq!(here.code, Some(0), "{}", here.stderr);
    assert!(here.stdout.contains("| setting |") && here.stdout.contains("max(load)"), "{}", here.stdout);
    assert_eq!(place.fractum(&["study", "list", "study.toml"]).code, Some(0));
    for run in ["1", "2"] {
        let ended = place.fractum(&["study", "run", "runs.csv", run]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    }
    let collected = place.fractum(&["study", "collect", "runs.csv"]);
    let row = |text: &str| text.lines().find(|line| line.starts_with("| stiff")).unwrap_or_default().to_owned();
    let load = |text: &str| row(text).split('|').nth(4).unwrap_or_default().trim().to_owned();
    assert!(
        load(&here.stdout) == load(&collected.stdout) && load(&here.stdout).contains("+10 %"),
        "{}",
        collected.stdout
    );
    // Another mesh is another run, whatever its name.
    let mesh = fs::read(place.path("bar.msh")).unwrap();
    fs::write(place.path("bar.msh"), [&mesh[..], b"\n"].concat()).unwrap();
    let ended = place.fractum(&["study", "run", "runs.csv", "1"]);
    assert!(ended.code == Some(0) && !ended.stderr.contains("has finished before"), "{}", ended.stderr);
}
