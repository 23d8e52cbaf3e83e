//! The report and the movie of a run.

mod common;

use std::fs;

use common::{BREAKING_BAR, Workplace};

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
    for part in ["<h2>Over time</h2>", "(nearest to the peak)", "<h2>Inputs</h2>", "tensile strength 3 MPa"] {
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
