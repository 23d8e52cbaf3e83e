//! Who may name whom, and what may happen where: the rules of `docs/architecture.md`, held by a test.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// What each crate may name of the others. A new crate or arrow is entered here on purpose, or not at all.
const ARROWS: [(&str, &[&str]); 12] = [
    ("fractum-math", &[]),
    ("fractum-mesh", &["math"]),
    ("fractum-contact", &["math", "mesh"]),
    ("fractum-dem", &["math", "contact"]),
    ("fractum-pack", &["math", "dem"]),
    ("fractum-calibrate", &["math", "dem", "pack"]),
    ("fractum-fem", &["math", "mesh"]),
    ("fractum-sparse", &["math"]),
    ("fractum-scene", &["math", "mesh", "contact", "dem", "fem", "sparse"]),
    ("fractum-io", &["math", "mesh", "fem", "dem", "pack", "scene"]),
    ("fractum-prepare", &["math", "mesh", "dem", "pack", "calibrate", "scene", "io"]),
    ("fractum", &["math", "mesh", "fem", "dem", "pack", "calibrate", "scene", "io", "prepare"]),
];

/// Crates whose kernels take numbers: no files, no printing, no wall clock, nothing of the case format.
const BELOW_IO: [&str; 9] = [
    "fractum-math",
    "fractum-mesh",
    "fractum-contact",
    "fractum-dem",
    "fractum-pack",
    "fractum-calibrate",
    "fractum-fem",
    "fractum-sparse",
    "fractum-scene",
];

fn crates() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates")
}

fn manifest(name: &str) -> toml::Table {
    let text = fs::read_to_string(crates().join(name).join("Cargo.toml")).unwrap();
    text.parse().unwrap()
}

/// Names in a dependency table; those of this workspace and all others.
fn dependencies(manifest: &toml::Table, table: &str) -> (BTreeSet<String>, BTreeSet<String>) {
    let names = manifest.get(table).and_then(toml::Value::as_table).into_iter().flatten().map(|(name, _)| name.clone());
    names.partition(|name| name.starts_with("fractum"))
}

/// Sources of a crate without its tests: files below `src`, each up to its test module.
fn sources(name: &str) -> BTreeMap<PathBuf, String> {
    let mut found = BTreeMap::new();
    let mut folders = vec![crates().join(name).join("src")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let text = fs::read_to_string(&path).unwrap();
                let code = text.split("#[cfg(test)]").next().unwrap_or_default().to_owned();
                found.insert(path, code);
            }
        }
    }
    assert!(!found.is_empty(), "{name} has no sources");
    found
}

#[test]
fn crates_name_only_those_below_them() {
    let present: BTreeSet<String> = fs::read_dir(crates())
        .unwrap()
        .map(|entry| entry.unwrap())
        .filter(|entry| entry.path().join("Cargo.toml").is_file())
        .map(|entry| entry.file_name().into_string().unwrap())
        .collect();
    assert_eq!(present, ARROWS.iter().map(|(name, _)| (*name).to_owned()).collect(), "crates without a rule, or gone");
    for (name, allowed) in ARROWS {
        let allowed: BTreeSet<String> = allowed.iter().map(|part| format!("fractum-{part}")).collect();
        let manifest = manifest(name);
        for table in ["dependencies", "dev-dependencies", "build-dependencies"] {
            let (named, _) = dependencies(&manifest, table);
            let wrong: Vec<_> = named.difference(&allowed).collect();
            assert!(wrong.is_empty(), "{name} must not name {wrong:?} in [{table}]");
        }
    }
}

#[test]
fn finite_and_discrete_elements_do_not_know_each_other() {
    let rules = [
        ("fractum-fem", &["fractum_dem", "fractum_contact"][..]),
        ("fractum-dem", &["fractum_fem"]),
        ("fractum-contact", &["fractum_fem", "fractum_dem"]),
        ("fractum-mesh", &["fractum_fem", "fractum_dem"]),
    ];
    for (name, foreign) in rules {
        for (path, code) in sources(name) {
            for word in foreign {
                assert!(!code.contains(word), "{} names {word}", path.display());
            }
        }
    }
}

#[test]
fn below_io_there_are_no_files_no_printing_and_no_clock() {
    let forbidden = [
        "std::fs",
        "File::",
        "std::path",
        "PathBuf",
        "println!",
        "print!(",
        "dbg!",
        "std::env",
        "std::process",
        "Instant",
        "SystemTime",
        "toml",
        "serde_json",
    ];
    for name in BELOW_IO {
        for (path, code) in sources(name) {
            let code = code.lines().map(|line| line.split("//").next().unwrap_or_default());
            for (number, line) in code.enumerate() {
                for word in forbidden {
                    assert!(!line.contains(word), "{}:{}: {word}", path.display(), number + 1);
                }
            }
        }
        let (_, foreign) = dependencies(&manifest(name), "dependencies");
        for library in ["toml", "serde_json", "clap", "tempfile", "postcard", "flate2", "png", "maud", "ctrlc"] {
            assert!(!foreign.contains(library), "{name} depends on {library}");
        }
    }
}

#[test]
fn hash_maps_are_not_walked_through_in_the_solvers() {
    // Their order differs from run to run; results must not.
    for name in ["fractum-contact", "fractum-dem", "fractum-pack", "fractum-calibrate", "fractum-fem", "fractum-scene"]
    {
        for (path, code) in sources(name) {
            for word in ["HashMap", "HashSet"] {
                assert!(!code.contains(word), "{}: {word}; use a sorted list or a BTreeMap", path.display());
            }
        }
    }
}

#[test]
fn transcendental_functions_come_from_one_place() {
    // Those of the standard library, and what of nalgebra and rand_distr calls them, go to the C library: other bits on
    // another processor. `fractum_math::elementary` and the rotations beside it have the same everywhere.
    let functions = [
        "acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "cbrt", "cos", "cosh", "exp", "exp2", "exp_m1",
        "hypot", "ln", "ln_1p", "log", "log10", "log2", "powf", "sin", "sin_cos", "sinh", "tan", "tanh",
    ];
    let of_nalgebra = [
        "from_scaled_axis",
        ".scaled_axis(",
        "::rotation_between",
        "from_axis_angle",
        "from_euler_angles",
        ".axis_angle(",
        ".angle(",
        ".slerp(",
        ".svd(",
        "SVD::",
        "Rotation3::from_matrix(",
    ];
    let of_rand_distr = ["Weibull::new", "Normal::new", "Exp::new", "Gamma::new", "StandardNormal"];
    for (name, _) in ARROWS {
        for (path, code) in sources(name) {
            if path.ends_with("fractum-math/src/elementary.rs") {
                continue;
            }
            for (number, line) in code.lines().enumerate() {
                let line = line.split("//").next().unwrap_or_default();
                let calls = functions.iter().flat_map(|f| [format!(".{f}("), format!("f64::{f}"), format!("f32::{f}")]);
                for word in calls.chain(of_nalgebra.iter().chain(&of_rand_distr).map(|word| (*word).to_owned())) {
                    assert!(!line.contains(&word), "{}:{}: {word}; see fractum_math", path.display(), number + 1);
                }
            }
        }
    }
}

#[test]
fn every_crate_has_a_front_page_and_the_rules_of_the_workspace() {
    for (name, _) in ARROWS {
        let root = fs::read_to_string(crates().join(name).join("src/lib.rs")).unwrap();
        let page = root.lines().take_while(|line| line.starts_with("//!")).count();
        assert!(page > 0, "{name}: lib.rs begins without a front page");
        let manifest = manifest(name);
        assert_eq!(manifest["lints"]["workspace"].as_bool(), Some(true), "{name}: [lints]");
        for key in ["version", "edition", "rust-version", "license"] {
            assert_eq!(manifest["package"][key]["workspace"].as_bool(), Some(true), "{name}: {key}");
        }
        assert!(manifest["package"]["description"].as_str().is_some_and(|text| !text.is_empty()), "{name}");
    }
}
