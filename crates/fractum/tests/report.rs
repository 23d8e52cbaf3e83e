//! The report and the movie of a run.

use std::fs;

use crate::common::{BREAKING_BAR, Workplace};

/// How often some bytes occur.
fn count(bytes: &[u8], pattern: &[u8]) -> usize {
    bytes.windows(pattern.len()).filter(|window| *window == pattern).count()
}

#[test]
fn a_report_has_a_strip_over_time_inputs_scales_and_titles_by_quantity() {
    let workplace = Workplace::new(BREAKING_BAR);
    let ended = workplace.fractum(&["run", "case.toml", "-o", "out", "--quiet"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let html = fs::read_to_string(workplace.path("out/report.html")).unwrap();
    for part in ["<h2>Over time", "(nearest to the peak)", "<h2>Inputs</h2>", "tensile strength 3 MPa"] {
        assert!(html.contains(part), "{part} is missing");
    }
    // The scale bar, an axis, and why the run ended.
    for part in [" mm</text>", ">x</text>", "End: t = 1 ms is the end of the run"] {
        assert!(html.contains(part), "{part} is missing");
    }
    assert!(!html.contains("probes in"), "titles name quantities, not units");
    // Made again from the folder alone, it is the same.
    fs::remove_file(workplace.path("out/report.html")).unwrap();
    assert_eq!(workplace.fractum(&["report", "out"]).code, Some(0));
    assert!(html == fs::read_to_string(workplace.path("out/report.html")).unwrap());

    let ended = workplace.fractum(&["movie", "out", "--width", "200", "--height", "170"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let movie = fs::read(workplace.path("out/movie.png")).unwrap();
    let collection = fs::read_to_string(workplace.path("out/fields.pvd")).unwrap();
    let frames = collection.matches("name=\"solid\"").count();
    assert!(movie.starts_with(b"\x89PNG") && frames > 5);
    assert_eq!((count(&movie, b"acTL"), count(&movie, b"fcTL")), (1, frames));
    assert!(ended.stdout.contains(&format!("{frames} frames, colours are damage from 0 to 1")), "{}", ended.stdout);
}

#[test]
fn a_key_makes_the_movie_with_the_run_and_shows_it_in_the_report() {
    let workplace = Workplace::new(&BREAKING_BAR.replace("[output]", "[output]\nmovie = true"));
    let run = |more: &[&str]| {
        let ended = workplace.fractum(&[&["run", "case.toml", "-o", "out", "--quiet"], more].concat());
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        fs::read_to_string(workplace.path("out/report.html")).unwrap()
    };
    let html = run(&[]);
    let made = fs::read(workplace.path("out/movie.png")).unwrap();
    let frames = fs::read_to_string(workplace.path("out/fields.pvd")).unwrap().matches("name=\"solid\"").count();
    assert_eq!((count(&made, b"acTL"), count(&made, b"fcTL")), (1, frames));
    assert!(html.contains("alt=\"movie of all frames\""));
    // The same movie as that of the command, and the same page as that made later.
    assert_eq!(workplace.fractum(&["movie", "out", "-o", "later.png"]).code, Some(0));
    let other = workplace.fractum(&["movie", "out", "-o", "later.gif"]);
    assert!(other.code == Some(1) && other.stderr.contains("expected a name that ends with .png"), "{}", other.stderr);
    assert!(made == fs::read(workplace.path("later.png")).unwrap());
    assert_eq!(workplace.fractum(&["report", "out"]).code, Some(0));
    assert!(html == fs::read_to_string(workplace.path("out/report.html")).unwrap());
    // A run anew without the key leaves none behind, and one that shows no movie of another state.
    let without = run(&["--overwrite", "--set", "output.movie=false"]);
    assert!(!without.contains("movie of all frames") && !workplace.path("out/movie.png").exists());
}

/// Plots over the probes of the breaking bar: of its own columns, with a level, and with points from a file.
const PLOTS: &str = r#"
[[plots]]
title = "Work and damage"
x = "harmed"
y = ["external", "damage"]
x_label = "share of damaged elements"

[[plots]]
x = "time"
y = ["load", "largest_load"]
scale = "log-x"
reference = { file = "measured.csv", y = 2, x_unit = "ms", y_unit = "kN", name = "measured <1>" }
"#;

#[test]
fn plots_of_a_case_come_first_and_change_no_result() {
    let workplace = Workplace::new(BREAKING_BAR);
    let summary = |folder: &str| -> serde_json::Value {
        serde_json::from_slice(&fs::read(workplace.path(folder).join("summary.json")).unwrap()).unwrap()
    };
    let run = |folder: &str, more: &[&str]| {
        let ended = workplace.fractum(&[&["run", "case.toml", "-o", folder, "--quiet"], more].concat());
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        fs::read_to_string(workplace.path(folder).join("report.html")).unwrap()
    };
    let titles = |html: &str| -> Vec<String> {
        let (_, curves) = html.split_once("<h2>Curves</h2>").unwrap();
        let charts = curves.split("aria-label=\"").skip(1);
        charts.map(|chart| chart.split_once('"').unwrap().0.to_owned()).collect()
    };
    let without = titles(&run("without", &[]));
    fs::write(workplace.path("case.toml"), format!("{BREAKING_BAR}{PLOTS}")).unwrap();
    fs::write(workplace.path("measured.csv"), "t [ms],note,F [kN]\n0.1,a,0.2\n0.2,b,4e3\n").unwrap();
    let html = run("with", &[]);
    let own = ["Work and damage", "load against time"].map(String::from);
    assert_eq!(titles(&html), [&own[..], &without[..]].concat());
    assert_eq!(summary("with")["state_hash"], summary("without")["state_hash"]);
    let (_, curves) = html.split_once("<h2>Curves</h2>").unwrap();
    let charts: Vec<&str> = curves.split("<svg").skip(1).collect();
    assert!(
        charts[0].contains(">share of damaged elements</text>") && charts[0].contains(">energy ["),
        "{}",
        charts[0]
    );
    // 4 MN is beyond all loads of the bar: the axis reaches it, where the unit is known.
    let points = charts[1].matches("<circle").count();
    assert!(
        charts[1].contains("load [MN]") && charts[1].contains("measured &lt;1&gt;") && points == 3,
        "{}",
        charts[1]
    );
    assert!(charts[1].contains("largest load: ") && charts[1].contains("stroke-dasharray"), "{}", charts[1]);
    // The plots are kept in the folder, and a run goes on with others.
    fs::remove_file(workplace.path("with/report.html")).unwrap();
    assert_eq!(workplace.fractum(&["report", "with"]).code, Some(0));
    assert!(html == fs::read_to_string(workplace.path("with/report.html")).unwrap());
    fs::write(workplace.path("case.toml"), BREAKING_BAR).unwrap();
    assert_eq!(titles(&run("with", &["--resume"])), without);
}

#[test]
fn plots_of_what_is_not_there_are_refused() {
    let refused = |old: &str, new: &str| {
        assert!(PLOTS.contains(old), "{old}");
        let workplace = Workplace::new(&format!("{BREAKING_BAR}{}", PLOTS.replacen(old, new, 1)));
        fs::write(workplace.path("measured.csv"), "0.1,0.2,1\n0.2,0.3,2\n").unwrap();
        let ended = workplace.fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(1), "{new}: {}", ended.stdout);
        ended.stderr
    };
    let cases = [
        (
            "\"harmed\"",
            "\"harm\"",
            "plots[0].x = \"harm\" is neither a probe nor a column of history.csv; did you mean \"harmed\"?",
        ),
        ("\"harmed\"", "\"zzz\"", "there are: load, largest_load"),
        ("\"harmed\"", "\"largest_load\"", "which is one number at the end"),
        (
            "\"harmed\"",
            "\"broken_bonds\"",
            "a column that the history of this run does not have; it has time, dt, external",
        ),
        ("[\"external\", \"damage\"]", "[\"largest_load\"]", "names no column of the history"),
        ("[\"external\", \"damage\"]", "\"external\"", "expected a list of names of probes or columns"),
        ("\"log-x\"", "\"log\"", "did you mean \"log-x\"?"),
        ("\"ms\"", "\"mm\"", "expected a unit of a time"),
        (
            "y = 2",
            "y = 5",
            "measured.csv:1:1: \"0.1,0.2,1\" has 3 columns; columns 0 and 5 are read, counted from 0; read for plots[1].reference.file",
        ),
        ("measured.csv", "absent.csv", "= \"absent.csv\" cannot be opened"),
    ];
    for (old, new, says) in cases {
        let said = refused(old, new);
        assert!(said.contains(says), "{new}: {said}");
    }
}

#[test]
fn a_movie_of_no_results_is_refused() {
    let workplace = Workplace::new(BREAKING_BAR);
    let ended = workplace.fractum(&["movie", "."]);
    assert_eq!((ended.code, ended.stderr.lines().count()), (Some(1), 1), "{}", ended.stderr);
    assert!(ended.stderr.contains("fields.pvd") && ended.stderr.contains("name the results folder of a run"));
    fs::write(workplace.path("fields.pvd"), "<DataSet timestep=\"0\" part=\"0\" name=\"solid\" file=\"bar.msh\"/>")
        .unwrap();
    let ended = workplace.fractum(&["movie", "."]);
    assert_eq!(ended.code, Some(1));
    assert!(ended.stderr.contains("bar.msh: cannot be read: this is no whole VTK file"), "{}", ended.stderr);
    assert_eq!(workplace.fractum(&["movie", ".", "--width", "0"]).code, Some(1));
}
