//! The quick part of the gallery meets its references.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use fractum::verify::neighbours::{neighbours, unsaid};
use fractum::verify::{Selection, verify};
use fractum::{Options, Simulation};
use fractum_case::read_case;
use fractum_output::beside::{End, Row};

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

fn cases() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases")
}

#[test]
fn a_share_of_the_gallery_holds_beside_itself() {
    let output = tempfile::tempdir().unwrap();
    let selection = Selection {
        cases: cases(),
        names: ["lame-static", "pressurised-crack/coarse", "cantilever-static/plane-depth-2-standard"]
            .map(String::from)
            .to_vec(),
        quick: false,
        output: output.path().to_owned(),
        jobs: 2,
        threads: Some(1),
        cache: fractum_prepare::Cache::new(None),
    };
    let rows = neighbours(&selection, true).unwrap();
    let holds = rows.iter().filter(|row| row.end == End::Holds).count();
    let fails: Vec<_> = rows.iter().filter(|row| matches!(row.end, End::Fails | End::Open | End::Unsaid)).collect();
    assert!(holds > 40 && fails.is_empty(), "{holds} hold; {fails:#?}");
    // Powers of two change no digit: nothing in the program has a size of its own.
    let same = |row: &&Row| row.kind == "size" && row.end == End::Holds && ["1", "Pa"].contains(&row.unit.as_str());
    let sized: Vec<&Row> = rows.iter().filter(same).collect();
    assert!(sized.len() > 4);
    for row in sized {
        assert_eq!(row.value, row.at_home, "{} {} {}", row.case, row.neighbour, row.quantity);
    }
}

#[test]
fn a_case_that_promises_something_says_something_of_each_neighbour() {
    let (mut silent, mut count) = (Vec::new(), 0);
    for folder in std::fs::read_dir(cases()).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_dir()) {
        for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.extension().is_none_or(|ending| ending != "toml") || path.ends_with("study.toml") {
                continue;
            }
            let case = read_case(&path, &[]).unwrap();
            let promise = &case.source.verify.promise;
            if promise.holds_for.is_some() || !promise.excepted.is_empty() {
                count += case.expect.len();
                silent.extend(unsaid(&case).into_iter().map(|row| format!("{}: {row}", path.display())));
            }
        }
    }
    assert!(count > 8 && silent.is_empty(), "of {count} references: {silent:#?}");
}

/// One case of every kind, small ones.
const KINDS: [&str; 22] = [
    "absorbing/normal",
    "ball-on-edge/ball",
    "bonded-box/tension-vibration",
    "brazilian-static/coarse",
    "cantilever-static/plane-depth-2",
    "excavation/hole-motion",
    "excavation/lining",
    "excavation/tunnel",
    "falling-block/block",
    "gas-blast/gas",
    "graded-plate/in-parts",
    "granular/pour",
    "heat/bar-implicit",
    "kirsch-in-situ/pressurised",
    "rigid-ball/ball-on-cube",
    "sphere-on-beam/case1",
    "stages/released-bar",
    "tension-bar/gmsh-coarse",
    "tension-bar-plane/delaunay-coarse",
    "tied/strike",
    "vibrating-cantilever/depth-2",
    "weibull/bar",
];

#[test]
fn every_kind_goes_on_from_its_first_a_middle_and_its_last_state() {
    const STEPS: u64 = 10;
    let output = tempfile::tempdir().unwrap();
    let cache = fractum_prepare::Cache::new(Some(output.path().join("cache")));
    let mut differ = Vec::new();
    for kind in KINDS {
        let path = cases().join(format!("{kind}.toml"));
        let open = |folder: &str, resume: bool| {
            let output = Some(output.path().join(kind).join(folder));
            let options = Options { output, resume, quiet: true, cache: cache.clone(), ..Options::default() };
            Simulation::open(&path, &options).unwrap_or_else(|failure| panic!("{kind}: {failure}"))
        };
        // Until a step, or the end of what has few of them.
        let advance = |mut simulation: Simulation, until: u64| {
            while simulation.steps() < until && !simulation.is_over() {
                simulation.step().unwrap();
                simulation.record().unwrap();
            }
            let reached = (simulation.steps(), simulation.state_hash());
            simulation.stop().unwrap();
            simulation.finish().unwrap();
            reached
        };
        let expected = advance(open("whole", false), STEPS);
        for saved in BTreeSet::from([0, expected.0 / 2, expected.0 - 1]) {
            let folder = format!("from-{saved}");
            advance(open(&folder, false), saved);
            if advance(open(&folder, true), STEPS) != expected {
                differ.push(format!("{kind} from step {saved}"));
            }
        }
    }
    assert!(differ.is_empty(), "{differ:#?}");
}
