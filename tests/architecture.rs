//! Who may name whom, and what may happen where: the rules of `docs/architecture.md`, held by a test.

mod modules;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use modules::Modules;

/// What each crate may name of the others. A new crate or arrow is entered here on purpose, or not at all.
const ARROWS: [(&str, &[&str]); 20] = [
    ("fractum-kernels", &[]),
    ("fractum-math", &["kernels"]),
    ("fractum-parallel", &[]),
    ("fractum-vtk", &[]),
    ("fractum-mesh", &["math", "vtk"]),
    ("fractum-contact", &["kernels", "math"]),
    ("fractum-dem", &["kernels", "math", "contact", "parallel"]),
    ("fractum-pack", &["math"]),
    ("fractum-calibrate", &["math", "dem", "pack"]),
    ("fractum-fem", &["kernels", "math", "mesh", "parallel"]),
    ("fractum-sparse", &["math"]),
    ("fractum-faer", &[]),
    ("fractum-gas", &["math"]),
    ("fractum-heat", &["math", "sparse"]),
    (
        "fractum-scene",
        &["math", "kernels", "mesh", "contact", "dem", "fem", "sparse", "faer", "gas", "heat", "parallel"],
    ),
    ("fractum-output", &["math", "vtk", "fem", "dem", "scene"]),
    ("fractum-report", &["math", "vtk", "mesh", "fem", "scene", "output"]),
    ("fractum-prepare", &["math", "mesh", "dem", "pack", "calibrate", "scene", "output"]),
    ("fractum-case", &["math", "mesh", "fem", "dem", "pack", "scene", "parallel", "output", "prepare"]),
    (
        "fractum",
        &[
            "math",
            "vtk",
            "mesh",
            "fem",
            "dem",
            "pack",
            "calibrate",
            "scene",
            "output",
            "report",
            "case",
            "prepare",
            "parallel",
        ],
    ),
];

/// Crates whose kernels take numbers: no files, no printing, no wall clock, nothing of the case format.
const BELOW_OUTPUT: [&str; 15] = [
    "fractum-kernels",
    "fractum-math",
    "fractum-parallel",
    "fractum-vtk",
    "fractum-mesh",
    "fractum-contact",
    "fractum-dem",
    "fractum-pack",
    "fractum-calibrate",
    "fractum-fem",
    "fractum-sparse",
    "fractum-faer",
    "fractum-gas",
    "fractum-heat",
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

/// Sources of a crate without its tests: files below `src` but `tests.rs`, each up to its test module.
fn sources(name: &str) -> BTreeMap<PathBuf, String> {
    let mut found = BTreeMap::new();
    let mut folders = vec![crates().join(name).join("src")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") && !path.ends_with("tests.rs") {
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
fn below_output_there_are_no_files_no_printing_and_no_clock() {
    let forbidden = [
        "std::fs",
        "File::open",
        "File::create",
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
    for name in BELOW_OUTPUT {
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
            // A packing has a format of its own, arrays of VTK may be compressed, and ranks send bytes: none of it is a file.
            let allowed = [("fractum-pack", "postcard"), ("fractum-vtk", "flate2"), ("fractum-parallel", "postcard")];
            let allowed = allowed.contains(&(name, library));
            assert!(allowed || !foreign.contains(library), "{name} depends on {library}");
        }
    }
}

#[test]
fn hash_maps_are_not_walked_through_in_the_solvers() {
    // Their order differs from run to run; results must not.
    for name in [
        "fractum-contact",
        "fractum-dem",
        "fractum-pack",
        "fractum-calibrate",
        "fractum-fem",
        "fractum-gas",
        "fractum-scene",
    ] {
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
    // another processor. `fractum_kernels::elementary` and the rotations of `fractum_math` have the same everywhere.
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
            if path.ends_with("fractum-kernels/src/elementary.rs") {
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
fn fused_products_stay_in_the_kernels_that_are_compiled_for_them() {
    // Elsewhere each is a call of the C library.
    let kernels = [
        "fractum-kernels/src/exact.rs",
        "fractum-kernels/src/lane.rs",
        "fractum-fem/src/element/polar.rs",
        "fractum-sparse/src/dense.rs",
    ];
    for (name, _) in ARROWS {
        for (path, code) in sources(name) {
            let code = code.lines().filter(|line| !line.trim_start().starts_with("//"));
            let fused = code.filter(|line| line.contains("mul_add(")).count();
            assert!(fused == 0 || kernels.iter().any(|kernel| path.ends_with(kernel)), "{}", path.display());
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

/// Methods of a type over all of its `impl` blocks, those of traits apart, at most.
const METHODS: usize = 60;

/// Lines of a file without its tests that no file passes which does one job.
const FILE: usize = 600;

/// Methods of the types of a source, by type.
fn methods(code: &str) -> BTreeMap<String, usize> {
    let mut found = BTreeMap::new();
    let mut of = None;
    for line in code.lines() {
        if let Some(head) = line.strip_prefix("impl").map(|head| head.replace("->", "")) {
            // `impl<..> Type<..> {` but not `impl Trait for Type {`; the parameters of the block end at their bracket.
            let mut depth = 0;
            let end = head.find(|c| {
                depth += i32::from(c == '<') - i32::from(c == '>');
                c == ' ' && depth == 0
            });
            let name = end.map(|end| head[end..].trim_start()).filter(|rest| !rest.contains(" for "));
            let name = name.and_then(|rest| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next());
            of = name.map(str::to_owned);
        } else if line == "}" {
            of = None;
        } else if let (Some(of), Some(code)) = (&of, line.strip_prefix("    ").filter(|code| !code.starts_with(' '))) {
            let is_fn = code.split("fn ").next().unwrap_or_default();
            let words = is_fn.split_whitespace();
            let is_method = code.contains("fn ")
                && words.into_iter().all(|w| w.starts_with("pub") || ["const", "unsafe", "async", "in"].contains(&w));
            *found.entry(of.clone()).or_default() += usize::from(is_method);
        }
    }
    found
}

#[test]
fn types_are_state_and_files_stay_readable() {
    let mut wrong = Vec::new();
    for (name, _) in ARROWS {
        let mut of_types: BTreeMap<String, usize> = BTreeMap::new();
        for (path, code) in sources(name) {
            let file = path.strip_prefix(crates()).unwrap_or(&path).to_string_lossy().into_owned();
            let lines = code.lines().count();
            if lines > FILE {
                wrong.push(format!("{file}: {lines} lines, at most {FILE}"));
            }
            methods(&code).into_iter().for_each(|(of, count)| *of_types.entry(of).or_default() += count);
        }
        for (of, count) in of_types {
            if count > METHODS {
                wrong.push(format!(
                    "{name}: {of} has {count} methods, at most {METHODS}; make what acts on it free functions"
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn methods_are_counted_over_blocks_and_without_traits() {
    let code = "impl<T: Fn(u8) -> u8> A<T> {\n    /// fn x\n    pub(crate) fn f(&self) {\n        fn g() {}\n    }\n    const fn h() {}\n}\nimpl B for A {\n    fn i() {}\n}\nimpl A {\n    fn j() {}\n}\n";
    assert_eq!(methods(code), [("A".to_owned(), 3)].into());
}

/// Cargo finds no tests in the folders of the two large test programs by itself: a file that is no module would never be compiled.
#[test]
fn every_test_file_belongs_to_a_test_program() {
    let folders = [(crates().join("fractum/tests"), "program"), (crates().join("../tests/verification"), "main")];
    for (folder, program) in folders {
        let modules = fs::read_to_string(folder.join(program).with_extension("rs")).unwrap();
        let files = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
        let names = files.filter(|path| path.extension().is_some_and(|e| e == "rs"));
        let names: Vec<String> = names.map(|path| path.file_stem().unwrap().to_string_lossy().into_owned()).collect();
        assert!(names.len() > 5, "{}", folder.display());
        for name in names.iter().filter(|name| ![program, "no_allocation"].contains(&name.as_str())) {
            assert!(
                modules.contains(&format!("\nmod {name};\n")),
                "{program}.rs of {} lacks mod {name};",
                folder.display()
            );
        }
    }
}

#[test]
fn modules_name_each_other_in_no_circle() {
    let mut found = Vec::new();
    for (name, _) in ARROWS {
        let src = crates().join(name).join("src");
        let sources = sources(name);
        let files = sources.iter().map(|(path, code)| (path.strip_prefix(&src).unwrap(), code.as_str()));
        let modules = Modules::new(files);
        found.extend(modules.circles().into_iter().map(|circle| format!("{name}: {circle}")));
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// The crates from the top down, each with those it names that no other one of its names leads to.
fn drawing() -> String {
    let below =
        |name: &str| ARROWS.iter().find(|(n, _)| n.trim_start_matches("fractum-") == name).map_or(&[][..], |a| a.1);
    let mut text = String::new();
    for (name, named) in ARROWS.iter().rev() {
        let short = name.trim_start_matches("fractum-");
        let implied = |part: &str| named.iter().any(|other| *other != part && reaches(below, other, part));
        let direct: Vec<&str> = named.iter().copied().filter(|part| !implied(part)).collect();
        text.push_str(format!("{short:<10} → {}", direct.join(", ")).trim_end_matches([' ', '→']));
        text.push('\n');
    }
    text
}

fn reaches(below: impl Fn(&str) -> &'static [&'static str] + Copy, from: &str, to: &str) -> bool {
    below(from).iter().any(|next| *next == to || reaches(below, next, to))
}

#[test]
fn the_drawing_in_the_docs_is_that_of_the_table() {
    // `FRACTUM_BLESS=1 cargo test -p fractum-tests --test architecture` writes it again.
    let path = crates().join("../docs/architecture.md");
    let text = fs::read_to_string(&path).unwrap();
    let start =
        text.find("## Crates and arrows").and_then(|at| text[at..].find("```\n").map(|fence| at + fence + 4)).unwrap();
    let end = start + text[start..].find("```").unwrap();
    if std::env::var_os("FRACTUM_BLESS").is_some() {
        fs::write(&path, [&text[..start], &drawing(), &text[end..]].concat()).unwrap();
        return;
    }
    assert_eq!(&text[start..end], drawing(), "FRACTUM_BLESS=1 writes it again");
}
