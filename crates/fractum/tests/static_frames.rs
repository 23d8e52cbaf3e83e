//! Frames and rows of runs at rest follow their path, which may turn back.

use std::fs;

use fractum_output::frames::read_collection;

use crate::common::{BONDED_BAR, SNAP_BACK, Workplace, history, run, summary};

/// Instants and files of the frames of a part, in the order of the index.
fn frames(place: &Workplace, part: &str) -> Vec<(f64, String)> {
    let listed = read_collection(&place.path("out/fields.pvd")).unwrap().entries;
    listed.into_iter().filter(|entry| entry.name == part).map(|entry| (entry.time, entry.file)).collect()
}

/// A number in the head of a VTK file.
fn number_of(place: &Workplace, file: &str, key: &str) -> u64 {
    let bytes = fs::read(place.path("out").join(file)).unwrap();
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(2000)]).into_owned();
    head.split(&format!("{key}=\"")).nth(1).unwrap().split('"').next().unwrap().parse().unwrap()
}

/// Rows begin with nothing, run on, and their largest load has a frame; loads and the load factors of the rows.
fn check_path(place: &Workplace, part: &str) -> Vec<(f64, String)> {
    let summary = summary(place, "out");
    assert_eq!(summary["time"]["at_rest"], true);
    let rows = history(place, "out", &["step", "time", "external", "elastic", "load"]);
    assert_eq!(rows[0], [0.0; 5], "{part}");
    assert!(rows.windows(2).all(|pair| pair[0][0] < pair[1][0]), "{part}: steps of the rows");
    // Bonds break one after the other while the load factor stands still; in solids it runs back.
    assert!(rows.windows(2).any(|pair| pair[0][1] >= pair[1][1]), "{part}: the load factor does not order the rows");
    let peak = rows.iter().max_by(|a, b| a[4].total_cmp(&b[4])).unwrap();
    let frames = frames(place, part);
    assert!(frames.windows(2).all(|pair| pair[0].0 < pair[1].0), "{part}: {frames:?}");
    assert!(
        frames.iter().any(|frame| frame.0 == peak[0]),
        "{part}: no frame of the peak, step {}: {frames:?}",
        peak[0]
    );
    assert_eq!(frames[0].0, 0.0);
    assert_eq!(frames.last().unwrap().0, rows.last().unwrap()[0], "{part}: the last state");
    let page = fs::read_to_string(place.path("out/report.html")).unwrap();
    assert!(page.contains("load factor") && !page.contains("simulated"), "{part}");
    let notes = fs::read_to_string(place.path("out/pictures/notes.json")).unwrap();
    let notes: serde_json::Value = serde_json::from_str(&notes).unwrap();
    let titles = || notes["pictures"].as_array().unwrap().iter().map(|picture| picture["title"].as_str().unwrap());
    assert!(titles().count() > 2 && titles().all(|title| title.contains("load factor ")), "{part}: {notes}");
    frames
}

#[test]
fn cracks_grow_from_frame_to_frame_through_snap_back() {
    let place = Workplace::new(SNAP_BACK);
    run(&place, "out", "2");
    let frames = check_path(&place, "solid");
    let factors = history(&place, "out", &["time"]);
    assert!(factors.windows(2).any(|pair| pair[0][0] > pair[1][0]), "the load factor runs back");
    let cells: Vec<u64> = frames.iter().map(|(_, file)| number_of(&place, file, "NumberOfCells")).collect();
    assert!(cells.is_sorted_by(|a, b| a >= b), "{cells:?}");
    assert!(cells.last() < cells.first(), "{cells:?}");
    // Not all of it between two frames.
    let damage = history(&place, "out", &["step", "damage"]);
    let at = |step: f64| damage.iter().find(|row| row[0] == step).unwrap()[1];
    let last = damage.last().unwrap()[1];
    let largest = frames.windows(2).map(|pair| (at(pair[1].0) - at(pair[0].0)) / last).fold(0.0, f64::max);
    assert!(largest < 0.25, "{largest}");
}

#[test]
fn a_bonded_body_has_frames_along_its_path() {
    let place = Workplace::new(BONDED_BAR);
    run(&place, "out", "2");
    let frames = check_path(&place, "bonds");
    let bonds: Vec<u64> = frames.iter().map(|(_, file)| number_of(&place, file, "NumberOfLines")).collect();
    assert!(bonds.is_sorted_by(|a, b| a >= b) && bonds.last() < bonds.first(), "{bonds:?}");
}
