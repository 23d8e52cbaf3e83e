//! What a user sees in the terminal: help, completions, manual pages, the plan, and how a run ends.

use crate::common::{BONDED_BAR, SNAP_BACK, Workplace, files_below};

const CASE: &str = include_str!("wrong/case.toml");

#[test]
fn help_shows_examples_and_exit_codes() {
    let workplace = Workplace::new(CASE);
    for arguments in [&["--help"][..], &["run", "--help"]] {
        let ended = workplace.fractum(arguments);
        assert_eq!(ended.code, Some(0));
        for words in ["Examples:\n  fractum ", "130", "Exit codes:"] {
            assert!(ended.stdout.contains(words), "{words}: {}", ended.stdout);
        }
    }
}

#[test]
fn completions_and_manual_pages_know_all_commands() {
    let workplace = Workplace::new(CASE);
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let ended = workplace.fractum(&["completions", shell]);
        assert_eq!(ended.code, Some(0), "{shell}: {}", ended.stderr);
        assert!(["check", "explain", "overrid", "resume"].iter().filter(|w| ended.stdout.contains(**w)).count() >= 3);
    }
    let page = workplace.fractum(&["man"]);
    assert!(page.stdout.contains(".TH fractum 1") && page.stdout.contains("NO_COLOR"), "{}", page.stdout);
    let ended = workplace.fractum(&["man", "pages"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let pages = files_below(&workplace.path("pages"), ".1");
    for name in ["fractum.1", "fractum-run.1", "fractum-mesh-info.1"] {
        assert!(pages.iter().any(|page| page.ends_with(name)), "{name}: {pages:?}");
    }
}

#[test]
fn what_is_skipped_is_one_short_line() {
    let ended = Workplace::new(CASE).fractum(&["check", "case.toml"]);
    let skipped: Vec<&str> = ended.stdout.lines().filter(|line| line.starts_with("skipped")).collect();
    assert_eq!(skipped, ["skipped      bonds, contact, damping, large rotations"]);
}

#[test]
fn the_last_lines_show_the_peak_and_why_the_run_ended() {
    let workplace = Workplace::new(CASE);
    let ended = workplace.fractum(&["run", "case.toml", "-o", "out"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let last: Vec<&str> = ended.stdout.lines().rev().take(3).collect();
    assert!(last[2].starts_with("peak ") && last[2].contains("load ") && last[2].contains(" N at t = "), "{last:?}");
    assert!(last[1].starts_with("end ") && last[1].ends_with("t = 20 µs is the end of the run"), "{last:?}");
    assert!(last[0].starts_with("results in "), "{last:?}");
    let summary = crate::common::summary(&workplace, "out");
    assert_eq!(summary["time"]["reason"], "t = 20 µs is the end of the run");
    assert!(!ended.stdout.contains('\x1b') && !ended.stderr.contains('\x1b'), "no colours in a pipe");
    let shown = ended.stderr.lines().find(|line| line.contains("ETA")).unwrap();
    assert!(shown.contains("load ") && shown.contains(" (peak ") && shown.trim_end().contains("balance "), "{shown}");
    // Stopped early by the load, which falls with the velocity of the wave that leaves the end.
    let fallen = CASE.replace("x = \"pull\" }", "x = \"pull*(1 - t/40 us)\" }");
    let stop = "end = \"80 us\"\nstop_when = { probe = \"load\", below = 0.5 }";
    let fallen = fallen.replace("end = \"20 us\"", stop);
    let ended = Workplace::new(&fallen).fractum(&["run", "case.toml", "-o", "out"]);
    assert!(ended.stdout.contains("load fell below 50 % of its largest value at t = "), "{ended:?}");
}

#[test]
fn runs_at_rest_name_load_factors_instead_of_times() {
    for (case, words) in [(SNAP_BACK, "N at load factor "), (BONDED_BAR, " bonds broke (crack area ")] {
        let ended = Workplace::new(case).fractum(&["run", "case.toml", "-o", "out"]);
        assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        let said: Vec<&str> = ended.stdout.lines().filter(|line| line.contains(words)).collect();
        assert!(!said.is_empty() && said.iter().all(|line| !line.contains("t = ")), "{words}: {}", ended.stdout);
    }
}
