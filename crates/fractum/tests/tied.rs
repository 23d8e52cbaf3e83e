//! A body that is solid here and bonded there, as its user meets it.

use std::fs;
use std::path::Path;

use crate::common::{Workplace, resumed, run};

const BAR: &str = r#"fractum = 1
title = "A bar with a bonded middle"

[mesh]
file = "bar.msh"

[materials.glass]
density = "2500 kg/m^3"
young_modulus = "70 GPa"
poisson_ratio = 0.2

[[bodies]]
name = "bar"
kind = "solid"
group = "bar"
material = "glass"

[[bodies]]
name = "core"
kind = "bonded"
replaces = "bar"
shape = "box"
point = ["2 mm", 0, 0]
size = ["2 mm", "2 mm", "2 mm"]
material = "glass"
particles = 800
[bodies.groups]
first = "x < 2.1 mm"

[[supports]]
group = "left"
fix = "xyz"
[[supports]]
group = "right"
velocity = { x = { smooth_ramp = [["0 s", "0 m/s"], ["1 us", "50 mm/s"]] } }

[solver]
end = "4 us"

[[probes]]
name = "load"
reaction = { group = "right", along = "x" }

[output]
fields = { every = "2 us" }
history = { every = "50 ns" }
checkpoint = { steps = 170 }
"#;

fn place(case: &str) -> Workplace {
    let place = Workplace::new(case);
    let mesh = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../meshes/tied/bar.msh");
    fs::copy(mesh, place.path("bar.msh")).unwrap();
    place
}

#[test]
fn one_key_bonds_a_body_in_part_and_the_run_has_one_result() {
    let place = place(BAR);
    let checked = place.fractum(&["check", "case.toml"]);
    assert_eq!(checked.code, Some(0), "{}", checked.stderr);
    // The mesh ends the parts at x = 2 and 4 mm: the box takes just the middle third.
    for words in ["bar: 781 standard tetrahedra", "mass 40 mg", "800 bonded particles", "tie          core to bar: "] {
        assert!(checked.stdout.contains(words), "{words}: {}", checked.stdout);
    }
    let one = run(&place, "one", "1");
    assert_eq!(one["counts"]["fragments"].as_u64(), Some(1));
    assert!(one["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-4, "{}", one["energy"]);
    assert!(one["probes"]["load"]["max"].as_f64().unwrap() > 1.0);
    for threads in ["2", "7"] {
        let other = run(&place, threads, threads);
        assert_eq!((&other["state_hash"], &other["probes"]), (&one["state_hash"], &one["probes"]), "{threads}");
    }
    let resumed = resumed(&place, "2");
    assert_eq!((&resumed["state_hash"], &resumed["energy"]), (&one["state_hash"], &one["energy"]));
}

#[test]
fn an_explicit_tie_is_the_one_that_a_replaced_part_finds() {
    let by_group = BAR.replace("group = \"bar\"\n", "group = \"first\"\n").replace("replaces = \"bar\"\n", "");
    let tied = by_group.clone() + "[[ties]]\nsolid = \"bar\"\nbonded = \"core\"\n";
    let tied = tied.replace("group = \"right\"\nvelocity", "group = \"core.x+\"\nvelocity");
    let tied = tied.replace("group = \"right\", along", "group = \"core.x+\", along");
    let line = |case: &str| {
        let place = place(case);
        let checked = place.fractum(&["check", "case.toml"]);
        assert_eq!(checked.code, Some(0), "{}", checked.stderr);
        let found = checked.stdout.lines().find(|line| line.starts_with("tie ")).unwrap().to_owned();
        found.split_whitespace().nth(4).unwrap().parse::<usize>().unwrap()
    };
    // Both ends of the core, against one of them.
    let (both, one) = (line(BAR), line(&tied));
    assert!(one > 40 && both > 2 * one - 20 && both < 2 * one + 20, "{one} {both}");
}

#[test]
fn what_cannot_be_tied_is_refused_with_a_remedy() {
    let apart = "[[ties]]\nsolid = \"bar\"\nbonded = \"core\"\n";
    let alone = BAR.replace("replaces = \"bar\"\n", "");
    let cases = [
        // case, key, words
        (BAR.replace("size = [\"2 mm\"", "size = [\"0.1 mm\""), "bodies[1].replaces", "none of its elements wholly"),
        (BAR.replace("replaces = \"bar\"", "replaces = \"bra\""), "bodies[1].replaces", "did you mean \"bar\"?"),
        (
            alone.replace("point = [\"2 mm\"", "point = [\"7 mm\"").replace("x < 2.1 mm", "x > 0 mm") + apart,
            "ties[0].solid",
            "the nearest is 9.8",
        ),
        (BAR.to_owned() + &apart.replace("\"core\"", "\"cor\""), "ties[0].bonded", "did you mean \"core\"?"),
        (BAR.to_owned() + &apart.replace("\"bar\"", "\"bra\""), "ties[0].solid", "did you mean \"bar\"?"),
        (BAR.replace("group = \"left\"", "group = \"core.first\""), "supports[0].group", "are tied to a solid"),
        (BAR.to_owned() + apart + "within = \"-1 um\"", "ties[0].within", "more than 0"),
    ];
    for (case, key, words) in cases {
        let place = place(&case);
        let ended = place.fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(1), "{key}: {}{}", ended.stdout, ended.stderr);
        assert!(ended.stderr.contains(key) && ended.stderr.contains(words), "{key}, {words}: {}", ended.stderr);
        assert!(ended.stderr.starts_with("case.toml:"), "{}", ended.stderr);
    }
}

#[test]
fn facets_smaller_than_particles_are_told() {
    let told = |case: &str, halvings: &str| {
        let place = place(case);
        let set = format!("mesh.halvings={halvings}");
        let checked = place.fractum(&["check", "case.toml", "--set", &set]);
        assert_eq!(checked.code, Some(0), "{}", checked.stderr);
        checked.stdout.contains("[tie-facets]")
    };
    // Edges of 0.45 mm against particles of 0.22 mm.
    assert!(!told(BAR, "0"));
    assert!(!told(BAR, "1"));
    assert!(told(BAR, "2"));
}
