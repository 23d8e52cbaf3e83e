//! A share of `fractum verify --stress` that takes a few seconds: one scene of every kind that needs no packing.

use std::fs;

use fractum::stress::{End, Line, Settings, stress};

#[test]
fn random_scenes_close_their_balance_or_say_why_not() {
    let output = tempfile::tempdir().unwrap();
    let settings = Settings {
        scenes: 10,
        seed: 1,
        output: output.path().to_owned(),
        threads: Some(1),
        cache: fractum_prepare::Cache::new(None),
    };
    let lines = stress(&settings).unwrap();
    let bad: Vec<&Line> = lines.iter().filter(|line| matches!(line.end, End::Silent | End::Refused)).collect();
    assert!(bad.is_empty(), "{bad:#?}");
    assert!(lines.iter().filter(|line| line.end == End::Good).count() >= 9, "{lines:#?}");
    let written: serde_json::Value =
        serde_json::from_slice(&fs::read(output.path().join("stress.json")).unwrap()).unwrap();
    assert_eq!(written.as_array().map(Vec::len), Some(lines.len()));
}
