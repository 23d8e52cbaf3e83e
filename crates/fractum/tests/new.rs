//! `fractum new`: what it writes can be checked and run as it stands.

use crate::common::{Workplace, summary};

const NAMES: [&str; 10] =
    ["plate", "bracket", "brazilian", "beam", "bonded-ucs", "triaxial", "impact", "quench", "shear", "blast"];

#[test]
fn every_template_is_listed_and_passes_check_without_a_doubt() {
    let place = Workplace::new("");
    let list = place.fractum(&["new"]);
    for name in NAMES {
        assert!(list.stdout.contains(name), "{}", list.stdout);
        let made = place.fractum(&["new", name]);
        assert_eq!(made.code, Some(0), "{name}: {}", made.stderr);
        if !["bonded-ucs", "triaxial"].contains(&name) {
            assert!(place.path(&format!("{name}/part.geo")).is_file());
            let checked = place.fractum(&["check", "--strict", &format!("{name}/case.toml")]);
            assert_eq!((checked.code, checked.stderr.as_str()), (Some(0), ""), "{name}");
        }
    }
    let again = place.fractum(&["new", "plate"]);
    assert_eq!(again.code, Some(1));
    assert!(again.stderr.contains("exists already; name another folder"), "{}", again.stderr);
    assert!(place.fractum(&["new", "plat"]).stderr.contains("templates: plate, bracket"));
}

/// Runs a template; its largest value of a probe.
fn largest(name: &str, probe: &str) -> f64 {
    let place = Workplace::new("");
    assert_eq!(place.fractum(&["new", name, "my case"]).code, Some(0));
    let ran = place.fractum(&["run", "my case/case.toml", "-o", "out", "--quiet"]);
    assert_eq!(ran.code, Some(0), "{name}: {}", ran.stderr);
    let summary = summary(&place, "out");
    assert_eq!(summary["status"], "completed");
    assert!(summary["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-3, "{}", summary["energy"]);
    summary["probes"][probe]["max"].as_f64().unwrap()
}

#[test]
fn templates_run_to_their_cracks() {
    // Between the strength of the ligament in bending without softening, ft b h^2/(6 L/4), and twice that.
    let ligament = 3e6 * 0.1 * 0.07 * 0.07 / (6.0 * 0.3 / 4.0);
    let load = largest("beam", "load");
    assert!((1.0..2.0).contains(&(load / ligament)), "{load} N of {ligament} N");
    let strength = largest("bonded-ucs", "strength");
    assert!((90e6..110e6).contains(&strength), "{strength} Pa");
    assert!(largest("impact", "push") > 1e4);
    // Between the residual strength, tan 30 deg, and cohesion with friction, 0.5 + tan 35 deg.
    let ratio = largest("shear", "stress_ratio");
    assert!((1.1..1.201).contains(&ratio), "{ratio}");
}
