//! Several ranks, here threads of one process, leave the files of one process.

use std::fs;
use std::path::Path;

use fractum::{Failure, Options, Ranks, Simulation, run, run_shared};
use fractum_output::frames::{read_arrays, read_collection};
use fractum_parallel::threads;

use crate::common::{BREAKING_BAR, FLYING, Workplace, files_below};

/// The breaking bar without its floor.
fn bar() -> String {
    let (before, rest) = BREAKING_BAR.split_once("[[bodies]]\nname = \"floor\"").unwrap();
    let (_, after) = rest.split_once("[[supports]]").unwrap();
    format!("{before}[[supports]]{after}")
}

pub(crate) fn options(place: &Workplace, folder: &str) -> Options {
    Options { output: Some(place.path(folder)), threads: Some(1), quiet: true, ..Options::default() }
}

/// Runs a case on several ranks; what each of them comes to.
pub(crate) fn on_ranks(place: &Workplace, ranks: usize, options: &Options) -> Vec<Result<String, Failure>> {
    let case = place.path("case.toml");
    std::thread::scope(|scope| {
        let start = |exchange| scope.spawn(|| run_shared(&case, options, Ranks::new(exchange)));
        let started: Vec<_> = threads(ranks).into_iter().map(start).collect();
        let outcome = |thread: std::thread::ScopedJoinHandle<'_, Result<fractum::Outcome, Failure>>| {
            thread.join().unwrap().map(|outcome| outcome.summary.hashes.state_hash)
        };
        started.into_iter().map(outcome).collect()
    })
}

/// Runs a case on several ranks up to a time [s], and ends there as if interrupted.
pub(crate) fn interrupted_on_ranks(place: &Workplace, ranks: usize, options: &Options, until: f64) {
    let case = place.path("case.toml");
    std::thread::scope(|scope| {
        for exchange in threads(ranks) {
            scope.spawn(|| {
                let mut simulation = Simulation::open_shared(&case, options, Ranks::new(exchange)).unwrap();
                while simulation.time() < until {
                    simulation.step().unwrap();
                    simulation.record().unwrap();
                }
                simulation.finish().unwrap();
            });
        }
    });
}

/// Files of a results folder that do not tell about the machine and the time.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let below =
        [".vtu", ".vtp", ".pvtu", ".pvtp", ".csv", ".pvd"].iter().flat_map(|suffix| files_below(folder, suffix));
    let name = |path: &Path| path.strip_prefix(folder).unwrap().display().to_string();
    below.map(|path| (name(&path), fs::read(&path).unwrap())).collect()
}

fn assert_same_files(place: &Workplace, folder: &str, what: &str) {
    let (ours, expected) = (files(&place.path(folder)), files(&place.path("alone")));
    let names = |files: &[(String, Vec<u8>)]| files.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&ours), names(&expected), "{what}");
    for ((name, ours), (_, expected)) in ours.iter().zip(&expected) {
        assert!(ours == expected, "{what}: {name}");
    }
}

#[test]
fn ranks_leave_the_files_of_one_process() {
    let place = Workplace::new(&bar());
    let alone = run(&place.path("case.toml"), &options(&place, "alone")).unwrap().summary;
    assert!(alone.counts.removed_elements > 0 && alone.counts.particles > 0);
    for ranks in [2, 3] {
        let folder = format!("of-{ranks}");
        for hash in on_ranks(&place, ranks, &options(&place, &folder)) {
            assert_eq!(hash.unwrap(), alone.hashes.state_hash, "{ranks} ranks");
        }
        assert_same_files(&place, &folder, &format!("{ranks} ranks"));
    }
}

/// Names of the arrays that tell frames apart.
const ARRAYS: [&str; 9] =
    ["Points", "displacement", "velocity", "stress", "damage", "radius", "connectivity", "offsets", "TimeValue"];

#[test]
fn frames_in_pieces_are_those_of_whole_files_whoever_writes_them() {
    let place = Workplace::new(&bar().replace("fields = { ", "fields = { pieces = 5, "));
    run(&place.path("case.toml"), &options(&place, "alone")).unwrap();
    let one = vec![("output.fields.pieces".into(), "1".into())];
    let of_one_file = Options { overrides: one, ..options(&place, "whole") };
    run(&place.path("case.toml"), &of_one_file).unwrap();
    let frames = |folder: &str| read_collection(&place.path(folder).join("fields.pvd")).unwrap().entries;
    let (in_pieces, whole) = (frames("alone"), frames("whole"));
    assert!(whole.iter().any(|entry| entry.name == "discrete elements"));
    assert_eq!(in_pieces.len(), whole.len());
    for (ours, expected) in in_pieces.iter().zip(&whole) {
        let is_cut = ["solid", "discrete elements"].contains(&expected.name.as_str());
        assert_eq!(ours.file, expected.file.replace(".v", if is_cut { ".pv" } else { ".v" }));
        let read = |folder: &str, file: &str| read_arrays(&place.path(folder).join(file), &ARRAYS).unwrap();
        assert_eq!(read("alone", &ours.file), read("whole", &expected.file), "{}", ours.file);
    }
    for ranks in [2, 3] {
        let folder = format!("of-{ranks}");
        on_ranks(&place, ranks, &options(&place, &folder)).into_iter().for_each(|hash| drop(hash.unwrap()));
        assert_same_files(&place, &folder, &format!("{ranks} ranks"));
    }
    assert_eq!(
        files_below(&place.path("alone/fields"), "-0004.vtu").len() * 5,
        files_below(&place.path("alone/fields"), ".vtu").len()
    );
    // Nothing of them stays behind a run without pieces.
    let again = Options { overwrite: true, output: Some(place.path("alone")), ..of_one_file };
    run(&place.path("case.toml"), &again).unwrap();
    assert!(
        files_below(&place.path("alone"), ".pvtu").is_empty()
            && files_below(&place.path("alone/fields"), "-0004.vtu").is_empty()
    );
}

#[test]
fn a_run_is_continued_by_another_number_of_ranks() {
    let place = Workplace::new(&bar());
    let case = place.path("case.toml");
    let alone = run(&case, &options(&place, "alone")).unwrap().summary;
    for (from, to) in [(1, 3), (3, 2), (2, 1)] {
        let folder = format!("from-{from}-to-{to}");
        let options = options(&place, &folder);
        interrupted_on_ranks(&place, from, &options, 4e-4);
        for hash in on_ranks(&place, to, &Options { resume: true, ..options.clone() }) {
            assert_eq!(hash.unwrap(), alone.hashes.state_hash, "{folder}");
        }
        assert_same_files(&place, &folder, &folder);
    }
}

/// The bar, too strong to break and held at one end: what the support does is in frames between rows.
fn held_bar() -> String {
    let changes = [
        ("[[loads]]\ngravity = { y = \"-9.81 m/s^2\" }\n", ""),
        ("\"3 MPa\"", "\"300 MPa\""),
        ("\"100 J/m^2\"", "\"1e6 J/m^2\""),
        ("velocity = { x = { ramp = [[\"0 s\", \"0 m/s\"], [\"0.2 ms\", \"-0.2 m/s\"]] } }", "fix = \"xyz\""),
        ("fields = { every = \"0.1 ms\"", "fields = { every = \"37 us\", reaction = true"),
        ("history = { every = \"10 us\"", "history = { every = \"0.3 ms\""),
    ];
    changes.iter().fold(bar(), |case, (from, to)| {
        assert!(case.contains(from), "{from}");
        case.replacen(from, to, 1)
    })
}

/// A scene of every kind that ranks share: what it is, and its case.
fn kinds() -> Vec<(&'static str, String)> {
    let standard = BREAKING_BAR.replacen("kinematics =", "formulation = \"standard\"\nkinematics =", 1);
    let beads = "[[bodies]]\nname = \"beads\"\nkind = \"particles\"\nmaterial = \"concrete\"\nshape = \"box\"\n\
        point = [\"10 cm\", \"12.5 cm\", \"2 cm\"]\nsize = [\"20 cm\", \"6 cm\", \"8 cm\"]\nparticle_radius = \"1 cm\"\nseed = 1\n[[supports]]";
    let with_phase_field = |case: &str| {
        case.replacen(
            "fracture_energy",
            "regularisation = \"phase-field\"\nreduce_strength_to_fit = true\nfracture_energy",
            1,
        )
    };
    vec![
        ("rigid floor", BREAKING_BAR.into()),
        ("phase field", with_phase_field(BREAKING_BAR)),
        ("phase field in the standard formulation", with_phase_field(&standard)),
        ("standard formulation", standard),
        ("reactions in frames", held_bar()),
        ("loose particles", BREAKING_BAR.replacen("[[supports]]", beads, 1)),
        ("bonded body beside a solid", FLYING.replacen("\"0 m/s\"", "\"600 m/s\"", 1)),
    ]
}

#[test]
fn scenes_of_every_kind_have_the_state_of_one_process() {
    for (index, (kind, case)) in kinds().into_iter().enumerate() {
        let place = Workplace::new(&case);
        let with = |folder: &str| options(&place, folder);
        let alone = run(&place.path("case.toml"), &with("alone")).unwrap_or_else(|error| panic!("{kind}: {error}"));
        // Two and three by turns.
        let ranks = 2 + index % 2;
        let folder = format!("of-{ranks}");
        for hash in on_ranks(&place, ranks, &with(&folder)) {
            assert_eq!(hash.unwrap(), alone.summary.hashes.state_hash, "{kind}, {ranks} ranks");
        }
        assert_same_files(&place, &folder, &format!("{kind}, {ranks} ranks"));
    }
}

/// One of them cannot write its results: the others hear of it instead of waiting.
#[test]
fn a_rank_that_cannot_begin_ends_all() {
    let place = Workplace::new(&bar());
    fs::write(place.path("taken"), "a file where the results should be").unwrap();
    let results = on_ranks(&place, 3, &options(&place, "taken/results"));
    let text = results[0].as_ref().unwrap_err().to_string();
    assert!(text.contains("taken"), "{text}");
    assert!(results[1..].iter().all(|result| matches!(result, Err(Failure::Elsewhere(_)))));
}

#[test]
fn what_ranks_cannot_run_is_refused_once_and_by_name() {
    let kinds = [
        ("kind = \"auto\"", "a solver that is not explicit"),
        ("kind = \"explicit\"\naccuracy = \"3 %\"", "passes to an accuracy"),
    ];
    for (kind, what) in kinds {
        let place = Workplace::new(&bar().replace("kind = \"explicit\"", kind));
        let results = on_ranks(&place, 3, &options(&place, "refused"));
        let text = results[0].as_ref().unwrap_err().to_string();
        let what = format!("{what} cannot be run by several");
        assert!(text.contains("case.toml:") && text.contains(&what), "{text}");
        assert!(results[1..].iter().all(|result| matches!(result, Err(Failure::Elsewhere(_)))));
        assert!(!place.path("refused").exists());
    }
}
