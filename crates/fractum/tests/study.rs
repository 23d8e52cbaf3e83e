//! Studies as their user starts them: the product of what is varied, runs that are kept, interruption, mistakes.

use std::fs;

use crate::common::{BREAKING_BAR, Workplace, signal};
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
        ("study = 1", "study = 2", "the version this program reads"),
    ] {
        fs::write(place.path("study.toml"), file.replace(from, to)).unwrap();
        let ended = place.fractum(&["study", "study.toml", "-o", "out"]);
        assert_eq!(ended.code, Some(1), "{to}");
        assert!(ended.stderr.contains(words), "{words} in\n{}", ended.stderr);
    }
    for (vary, words) in [("nu", "expected KEY=a,b,c"), ("nu=1,1", "twice"), ("nu=", "a value is missing")] {
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
    // The second run has begun once its folder has a state.
    let under_way = || {
        let folders = fs::read_dir(place.path("out/runs")).map_or(0, Iterator::count);
        folders == 2 && crate::common::files_below(&place.path("out/runs"), "study-run.json").len() == 1
    };
    while !(under_way() && crate::common::files_below(&place.path("out/runs"), ".fck").len() > 1)
        && run.try_wait().unwrap().is_none()
    {
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
