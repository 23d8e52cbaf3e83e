//! A share of `record stress` that takes a few seconds: one scene of every kind that needs no packing.

use std::fs;

use super::{End, Line, Settings, stress};

/// Runs a few scenes: those that ended without a word or were refused, how many were good, and how many there were.
fn run(blasts: bool, first: usize, scenes: usize) -> (Vec<Line>, usize, usize) {
    let output = tempfile::tempdir().unwrap();
    let cache = fractum_prepare::Cache::new(None);
    let settings =
        Settings { scenes, first, blasts, seed: 1, output: output.path().to_owned(), threads: Some(1), cache };
    let lines = stress(&settings).unwrap();
    let written: serde_json::Value =
        serde_json::from_slice(&fs::read(output.path().join("stress.json")).unwrap()).unwrap();
    assert_eq!(written.as_array().map(Vec::len), Some(lines.len()));
    let good = lines.iter().filter(|line| line.end == End::Good).count();
    let count = lines.len();
    (lines.into_iter().filter(|line| matches!(line.end, End::Silent | End::Refused)).collect(), good, count)
}

#[test]
fn random_scenes_close_their_balance_or_say_why_not() {
    let (bad, good, count) = run(false, 0, 10);
    assert!(bad.is_empty() && good + 1 >= count, "{good} of {count} {bad:#?}");
}

#[test]
fn damage_brings_no_energy_where_a_step_turns_compression_into_tension_beyond_the_strength() {
    let (bad, good, _) = run(false, 785, 1);
    assert!(bad.is_empty() && good == 1, "{bad:#?}");
}

#[test]
fn random_blasts_end_or_stop_with_a_reason() {
    let (bad, good, count) = run(true, 0, 12);
    assert!(bad.is_empty() && 2 * good > count, "{good} of {count} {bad:#?}");
}
