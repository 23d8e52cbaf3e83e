//! Bonded bodies of interfaces, as their user meets them.

use std::fs;

use crate::common::{Workplace, resumed, run};

/// A block that is crushed between two faces.
const BLOCK: &str = include_str!("../../../cases/cement/block.toml");

/// A case that saves its state as often as it can: `every` is wall time.
fn saving(text: &str) -> Workplace {
    Workplace::new(&text.replace("[output]", "[output]\ncheckpoint = { steps = 170 }"))
}

fn assert_same_on_threads_and_after_a_checkpoint(place: &Workplace, one: &serde_json::Value) {
    let state = |run: &serde_json::Value| (run["state_hash"].clone(), run["energy"].clone());
    for threads in ["2", "7"] {
        assert_eq!(state(&run(place, threads, threads)), state(one), "{threads} threads");
    }
    assert_eq!(state(&resumed(place, "2")), state(one), "resumed");
}

#[test]
fn interfaces_separate_with_the_same_bits_on_any_threads_and_after_a_checkpoint() {
    let place = saving(&BLOCK.replace("1.5 m/s", "8 m/s"));
    let one = run(&place, "one", "1");
    let broken = one["counts"]["broken_bonds"].as_u64().unwrap();
    assert!(broken > 50, "{}", one["counts"]);
    let energy = |name: &str| one["energy"][name].as_f64().unwrap();
    assert!(energy("damage") > 0.1 * energy("external"), "{}", one["energy"]);
    assert!(energy("residual_max_relative") < 1e-3, "{}", one["energy"]);
    let table = fs::read_to_string(place.path("one/cracks.csv")).unwrap();
    assert_eq!(table.lines().count() as u64, broken + 1);
    assert!(table.contains("shear") && table.contains("tension"));
    assert_same_on_threads_and_after_a_checkpoint(&place, &one);
    assert_eq!(fs::read_to_string(place.path("2/cracks.csv")).unwrap(), table);
}

#[test]
fn interfaces_beside_the_mean_strain_separate_with_the_same_bits_on_any_threads_and_after_a_checkpoint() {
    let left_out = ["softening", "crushing"];
    let kept = BLOCK.lines().filter(|line| !left_out.iter().any(|word| line.contains(word)));
    let text = kept.collect::<Vec<_>>().join("\n").replace("bond = \"local\"", "bond = \"local-nonlocal\"");
    let place = saving(&text.replace("every = \"20 us\"", "every = \"1 ms\""));
    let one = run(&place, "one", "1");
    assert!(one["counts"]["broken_bonds"].as_u64().unwrap() > 50, "{}", one["counts"]);
    let energy = |name: &str| one["energy"][name].as_f64().unwrap();
    assert!(energy("damage") > 0.01 * energy("external").abs(), "{}", one["energy"]);
    assert!(energy("residual_max_relative") < 1e-3, "{}", one["energy"]);
    assert_same_on_threads_and_after_a_checkpoint(&place, &one);
}

#[test]
fn tables_that_the_law_of_a_body_does_not_read_are_refused() {
    let beams = BLOCK.replace("bond = \"local\"\n", "");
    let both = BLOCK.replace("[[bodies]]", "[materials.cement.fracture]\ntensile_strength = 1e6\n[[bodies]]");
    let regular = BLOCK.replace("particles = 600", "particles = 600\narrangement = \"cartesian\"");
    let corrected = BLOCK.replace("bond = \"local\"", "bond = \"local-nonlocal\"");
    for (text, words) in [
        (corrected, "softens or crushes, which bond = \"local-nonlocal\" does not know"),
        (beams, "has no effect on body bonds with bond = \"cohesive-beam\""),
        (both, "give the strengths in the table interface"),
        (regular, "particle_radius"),
        (BLOCK.replace("[3, 9, 24]", "[0.5, 9, 24]"), "three numbers, 1 or more"),
        (BLOCK.replace("\"9 MPa\"", "\"8 MPa\""), "three positive stresses, ascending"),
        (BLOCK.replace("crushing_ratio = [3, 9, 24]\n", ""), "crushing_ratio"),
        (BLOCK.replace("[solver]", "[solver]\nkind = \"static\""), "and bond = \"local\""),
    ] {
        let place = Workplace::new(&text);
        let ended = place.fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(1), "{words}: {}", ended.stderr);
        assert!(ended.stderr.contains(words), "{words}: {}", ended.stderr);
    }
}
