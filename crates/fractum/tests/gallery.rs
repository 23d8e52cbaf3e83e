//! The quick part of the gallery meets its references.

use std::path::Path;

use fractum::verify::{Selection, verify};

#[test]
fn quick_cases_meet_their_references() {
    let output = tempfile::tempdir().unwrap();
    let selection = Selection {
        cases: Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases"),
        names: Vec::new(),
        quick: true,
        output: output.path().to_owned(),
        jobs: 2,
        threads: Some(1),
        cache: fractum_prepare::Cache::new(Some(output.path().join("cache"))),
    };
    let lines = verify(&selection).unwrap();
    let missed: Vec<String> = lines
        .iter()
        .filter(|line| !line.expectation.pass)
        .map(|line| {
            let found = &line.expectation;
            format!("{} {}: {}, expected {}", line.case, found.quantity, found.value, found.required())
        })
        .collect();
    assert!(lines.len() > 40, "{} references were checked", lines.len());
    assert!(missed.is_empty(), "{missed:#?}");
    assert!(output.path().join("verify.json").is_file());
}
