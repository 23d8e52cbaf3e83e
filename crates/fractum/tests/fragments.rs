//! One count of fragments in the probe, the summary, the table and the history.

mod common;

use std::fs;

use common::{BREAKING_BAR, Workplace, run};

/// The breaking bar with a probe of the number of fragments.
fn counted(output: &str) -> String {
    BREAKING_BAR
        .replace("[output]", &format!("[[probes]]\nname = \"pieces\"\ncount = \"fragments\"\n\n[output]\n{output}"))
}

#[test]
fn probe_summary_and_table_count_the_same_fragments() {
    let place = Workplace::new(&counted(""));
    let summary = run(&place, "results", "1");
    let table = fs::read_to_string(place.path("results/fragments.csv")).unwrap();
    let listed = table.lines().count() as u64 - 1;
    assert!(summary["counts"]["particles"].as_u64() > Some(0) && listed >= 2, "{}", summary["counts"]);
    assert_eq!(summary["counts"]["fragments"].as_u64(), Some(listed));
    assert_eq!(summary["probes"]["pieces"]["final"].as_f64(), Some(listed as f64));
    assert!(table.lines().skip(1).all(|line| line.split(',').nth(3).unwrap().parse::<u64>().unwrap() > 1), "{table}");
}

#[test]
fn a_body_in_single_nodes_is_warned_of() {
    // Strong enough for its own weight, and no more: the pull damages every edge.
    let case = counted("fragments = { joined_below = 1e-9 }").replace("if(abs(x - 20 cm) < 3 cm, 0.5, 1.0)", "0.01");
    let place = Workplace::new(&case);
    let ended = place.fractum(&["run", "case.toml", "-o", "results"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(
        ended.stderr.contains("warning: body \"bar\"") && ended.stderr.contains("single nodes"),
        "{}",
        ended.stderr
    );
}
