//! Particles that come in as time goes on: against free fall, the balance of momentum and the rate that is asked for.

use std::fs;

use fractum_math::Vec3;
use fractum_mesh::MshFormat;
use fractum_mesh::generate::structured_box;
use serde_json::Value;

use crate::common::{Workplace, history, mesh_bytes, resumed, run};
use crate::ranks::{on_ranks, options};

/// Beads that come in and fall; `INLET`, `MORE` and `END` are put in.
const STREAM: &str = r#"fractum = 1
title = "A stream of beads"

[materials.glass]
density = "2500 kg/m^3"
young_modulus = "1 MPa"
poisson_ratio = 0.22
contact = { friction = 0.4, rolling_friction = 0.02, restitution = 0.3 }

[[bodies]]
name = "beads"
kind = "particles"
material = "glass"
shape = "box"
point = ["-10 mm", "-10 mm", "50 mm"]
size = ["20 mm", "20 mm", "10 mm"]
particle_radius = "1 mm"
dispersion = 0.4
INLET

MORE

[[loads]]
gravity = { z = "-9.81 m/s^2" }

[solver]
end = "END"

[output]
history = { every = "1 ms" }
fields = { every = "20 ms", xyz = true }
checkpoint = { steps = 7000 }
"#;

/// A floor with walls around it, wide enough for a heap.
const FLOOR: &str = r#"[[bodies]]
name = "floor"
kind = "rigid"
shape = "box"
inside = true
point = ["-12 mm", "-12 mm", "0 mm"]
size = ["24 mm", "24 mm", "100 mm"]
[[probes]]
name = "floor_force"
reaction = { group = "floor", along = "z" }
[[probes]]
name = "fall"
displacement = { group = "beads", along = "-z" }
"#;

fn stream(inlet: &str, more: &str, end: &str) -> Workplace {
    Workplace::new(&STREAM.replace("INLET", inlet).replace("MORE", more).replace("END", end))
}

fn number(of: &Value, path: &[&str]) -> f64 {
    path.iter().fold(of, |value, key| &value[key]).as_f64().unwrap()
}

#[test]
fn a_stream_has_the_same_bits_on_any_threads_and_after_a_checkpoint() {
    let place = stream("inlet = { mass_rate = \"60 g/s\", from = \"5 ms\", until = \"80 ms\" }", FLOOR, "0.12 s");
    let one = run(&place, "one", "1");
    assert!(number(&one, &["counts", "contacts"]) > 10.0, "{}", one["counts"]);
    assert!(number(&one, &["energy", "residual_max_relative"]) < 1e-3, "{}", one["energy"]);
    for threads in ["2", "7"] {
        let other = run(&place, threads, threads);
        assert_eq!((&other["state_hash"], &other["probes"]), (&one["state_hash"], &one["probes"]), "{threads}");
    }
    let resumed = resumed(&place, "2");
    assert_eq!((&resumed["state_hash"], &resumed["energy"]), (&one["state_hash"], &one["energy"]));
    assert_eq!((&resumed["counts"], &resumed["probes"]), (&one["counts"], &one["probes"]));
}

#[test]
fn as_much_comes_in_as_the_rate_says() {
    // By mass within one particle, whose radius is at most 1.2 mm.
    let heaviest = 2500.0 * 4.0 / 3.0 * std::f64::consts::PI * 1.2e-3f64.powi(3);
    for seed in [1, 2, 3] {
        let inlet = format!(
            "seed = {seed}\ninitial_velocity = {{ z = \"-0.5 m/s\" }}\ninlet = {{ mass_rate = \"60 g/s\", from = \"20 ms\", until = \"80 ms\" }}"
        );
        let place = stream(&inlet, "", "0.1 s");
        run(&place, "out", "1");
        for row in history(&place, "out", &["time", "entered_mass", "waiting_particles", "particles"]) {
            let asked = 60e-3 * (row[0].min(80e-3) - 20e-3).max(0.0);
            let missing = asked - row[1];
            assert!((-1e-12..heaviest).contains(&missing) && row[2] == 0.0, "{row:?}");
        }
        let counts = history(&place, "out", &["particles", "entered_particles"]);
        assert!(counts.iter().all(|row| row[0] == row[1]));
        // Frames show those that are there, and no other.
        let first = fs::read_to_string(place.path("out/particles/particles-00000.xyz")).unwrap();
        assert_eq!(first.lines().next(), Some("0"));
    }
    // By number exactly.
    let place = stream(
        "initial_velocity = { z = \"-0.5 m/s\" }\ninlet = { number_rate = \"2000 1/s\", until = \"50 ms\" }",
        "",
        "60 ms",
    );
    assert_eq!(number(&run(&place, "out", "1"), &["counts", "entered_particles"]), 100.0);
    let place = stream(
        "particles = 30\ninitial_velocity = { z = \"-0.5 m/s\" }\ninlet = { number_rate = \"2000 1/s\" }",
        "",
        "60 ms",
    );
    assert_eq!(number(&run(&place, "out", "1"), &["counts", "entered_particles"]), 30.0);
}

#[test]
fn a_particle_that_comes_in_falls_freely_with_the_velocity_it_is_given() {
    const WATCHED: &str = "[[probes]]\nname = \"speed\"\nvelocity = { group = \"beads\", along = \"-z\" }\n\
                           [[probes]]\nname = \"fall\"\ndisplacement = { group = \"beads\", along = \"-z\" }";
    let place = stream(
        "particles = 1\ninitial_velocity = { z = \"-0.5 m/s\" }\ninlet = { number_rate = \"100 1/s\" }",
        WATCHED,
        "0.1 s",
    );
    let run = run(&place, "out", "1");
    let mut seen = 0;
    for row in history(&place, "out", &["time", "dt", "speed", "fall"]) {
        if row[3].is_nan() || row[3] == 0.0 {
            assert!(row[0] < 10.1e-3, "{row:?}");
            continue;
        }
        seen += 1;
        // Velocities are those of the half step behind the instant.
        let speed = row[2] - 0.5 * 9.81 * row[1];
        assert!((speed * speed / (0.25 + 2.0 * 9.81 * row[3]) - 1.0).abs() < 1e-9, "{row:?}");
    }
    assert!(seen > 80);
    assert!(number(&run, &["energy", "residual_max_relative"]) < 1e-9, "{}", run["energy"]);
}

/// The momentum of all beads changes by their weight, by what comes in and by the force of the floor: as long as what falls does
/// not change, the floor bears the weight of all, also of those in the air, and the momentum that comes in.
#[test]
fn a_floor_bears_all_weight_and_the_momentum_that_comes_in() {
    let place = stream(
        "initial_velocity = { z = \"-1 m/s\" }\ninlet = { mass_rate = \"50 g/s\", until = \"1 s\" }",
        FLOOR,
        "0.2 s",
    );
    let run = run(&place, "out", "1");
    assert!(number(&run, &["energy", "residual_max_relative"]) < 1e-3, "{}", run["energy"]);
    let rows = history(&place, "out", &["time", "entered_mass", "floor_force"]);
    let later: Vec<_> = rows.iter().filter(|row| row[0] > 0.08).collect();
    let mean = |of: &dyn Fn(&[f64]) -> f64| later.iter().map(|row| of(row)).sum::<f64>() / later.len() as f64;
    let (borne, expected) = (mean(&|row| row[2]), mean(&|row| 9.81 * row[1]) + 50e-3 * 1.0);
    assert!((borne / expected - 1.0).abs() < 0.03, "{borne} for {expected}");
}

#[test]
fn particles_without_a_free_place_wait_and_are_told() {
    // A box below the inlet that is soon full.
    let lid = FLOOR.replace("size = [\"24 mm\", \"24 mm\", \"100 mm\"]", "size = [\"24 mm\", \"24 mm\", \"61 mm\"]");
    let lid = lid.replace("\"0 mm\"]", "\"45 mm\"]").replace("\"61 mm\"", "\"16 mm\"");
    let place = stream("inlet = { mass_rate = \"400 g/s\", until = \"50 ms\" }", &lid, "60 ms");
    let run = run(&place, "out", "2");
    let told = |code: &str| {
        let mut told = run["warnings"].as_array().unwrap().iter().filter(|warning| warning["code"] == code);
        told.next().map_or("", |warning| warning["text"].as_str().unwrap()).to_owned()
    };
    assert!(told("inlet-rate").contains("the inlet has room for about"), "{}", run["warnings"]);
    assert!(told("inlet-blocked").contains("its inlet has no free place"), "{}", run["warnings"]);
    assert!(number(&run, &["counts", "waiting_particles"]) > 100.0, "{}", run["counts"]);
    assert!(number(&run, &["counts", "most_waiting_particles"]) >= number(&run, &["counts", "waiting_particles"]));
    // None came in where another was: nothing was pressed apart.
    assert!(number(&run, &["energy", "residual_max_relative"]) < 1e-3, "{}", run["energy"]);
    assert!(number(&run, &["largest_overlap", "share"]) < 0.2, "{}", run["largest_overlap"]);
}

/// A held block of 80 g bears what has come to rest on it, within a fence of rigid walls.
#[test]
fn a_solid_bears_what_falls_on_it() {
    let block = "[mesh]\nfile = \"bar.msh\"\n[materials.stone]\ndensity = \"2500 kg/m^3\"\nyoung_modulus = \"5 MPa\"\npoisson_ratio = 0.2\n\
        contact = { friction = 0.4, rolling_friction = 0.02, restitution = 0.3 }\n\
        [[bodies]]\nname = \"block\"\nkind = \"solid\"\ngroup = \"body\"\nmaterial = \"stone\"\n\
        [[bodies]]\nname = \"fence\"\nkind = \"rigid\"\nshape = \"box\"\ninside = true\npoint = [\"-1 mm\", \"-1 mm\", \"-20 mm\"]\nsize = [\"42 mm\", \"42 mm\", \"150 mm\"]\n\
        [[supports]]\ngroup = \"z-\"\nfix = \"xyz\"\n\
        [[probes]]\nname = \"borne\"\nreaction = { group = \"z-\", along = \"z\" }\n";
    let inlet = "initial_velocity = { z = \"-0.5 m/s\" }\ninlet = { number_rate = \"2000 1/s\", until = \"0.1 s\" }";
    let text = STREAM.replace("INLET", inlet).replace("MORE", block).replace("END", "0.5 s");
    let text = text.replace("point = [\"-10 mm\", \"-10 mm\", \"50 mm\"]", "point = [\"10 mm\", \"10 mm\", \"50 mm\"]");
    let mesh = structured_box([6, 6, 3], Vec3::new(0.04, 0.04, 0.02), None);
    let place = Workplace::with_mesh(&text, &mesh_bytes(&mesh, MshFormat::V4_1Binary));
    let one = run(&place, "one", "1");
    assert!(number(&one, &["energy", "residual_max_relative"]) < 1e-3, "{}", one["energy"]);
    let rows = history(&place, "one", &["time", "borne", "entered_mass"]);
    let late: Vec<&Vec<f64>> = rows.iter().filter(|row| row[0] > 0.4).collect();
    let mean = late.iter().map(|row| row[1]).sum::<f64>() / late.len() as f64;
    let weight = 9.81 * (2500.0 * 0.04 * 0.04 * 0.02 + late[0][2]);
    assert!((mean / weight - 1.0).abs() < 0.02 && late[0][2] > 1e-3, "{mean} {weight}");
}

#[test]
fn streams_that_cannot_be_are_refused_with_their_place() {
    let cases = [
        ("inlet = { mass_rate = \"0 kg/s\", until = \"1 s\" }", "more than 0"),
        ("inlet = { mass_rate = \"2 kg\", until = \"1 s\" }", "mass flow"),
        ("inlet = { mass_rate = \"2 kg/s\", number_rate = \"1 1/s\", until = \"1 s\" }", "number_rate"),
        ("inlet = { until = \"1 s\" }", "mass_rate"),
        ("inlet = { mass_rate = \"2 g/s\" }", "has no until"),
        ("inlet = { mass_rate = \"2 g/s\", from = \"1 s\", until = \"0.5 s\" }", "is not after from"),
        ("inlet = { mass_rate = \"1 ug/s\", until = \"1 s\" }", "less than one particle"),
        ("groups = { low = \"z < 1 mm\" }\ninlet = { mass_rate = \"2 g/s\", until = \"1 s\" }", "groups"),
        ("solid_fraction = 0.2\ninlet = { mass_rate = \"2 g/s\", until = \"1 s\" }", "solid_fraction"),
    ];
    for (inlet, expected) in cases {
        let ended = stream(inlet, "", "0.1 s").fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(1), "{inlet}: {}", ended.stderr);
        assert!(ended.stderr.contains(expected) && ended.stderr.contains("case.toml:"), "{inlet}: {}", ended.stderr);
    }
    let inlet = "inlet = { mass_rate = \"2 g/s\", until = \"1 s\" }";
    let more = [
        ("[[supports]]\ngroup = \"beads\"\nfix = \"xyz\"", "come in through an inlet"),
        ("[[loads]]\ngroup = \"beads\"\nforce = { x = \"1 N\" }", "come in through an inlet"),
    ];
    for (more, expected) in more {
        let ended = stream(inlet, more, "0.1 s").fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(1), "{more}: {}", ended.stderr);
        assert!(ended.stderr.contains(expected), "{more}: {}", ended.stderr);
    }
    let text = STREAM.replace("INLET", inlet).replace("MORE", "").replace("END", "0.1 s");
    let at_rest =
        Workplace::new(&text.replace("[solver]\n", "[solver]\nkind = \"static\"\n")).fractum(&["check", "case.toml"]);
    assert!(at_rest.code == Some(1) && at_rest.stderr.contains("come in as time goes on"), "{}", at_rest.stderr);
    let place = Workplace::new(&text);
    let shared = on_ranks(&place, 2, &options(&place, "shared"));
    let words = shared[0].as_ref().unwrap_err().to_string();
    assert!(words.contains("come in through an inlet cannot be run by several"), "{words}");
    let far = STREAM.replace("INLET", inlet).replace("MORE", "").replace("END", "0.1 s");
    let far =
        far.replace("[solver]\n", "[solver]\ndomain = { min = [0, 0, 0], max = [\"1 mm\", \"1 mm\", \"1 mm\"] }\n");
    let ended = Workplace::new(&far).fractum(&["check", "case.toml"]);
    assert!(ended.code == Some(1) && ended.stderr.contains("outside at the start"), "{}", ended.stderr);
    // Too small for its particles.
    let small = STREAM.replace("INLET", inlet).replace("MORE", "").replace("END", "0.1 s");
    let small = small.replace("\"20 mm\", \"10 mm\"]", "\"20 mm\", \"1 mm\"]");
    let ended = Workplace::new(&small).fractum(&["check", "case.toml"]);
    assert!(ended.code == Some(1) && ended.stderr.contains("no room for its largest"), "{}", ended.stderr);
}
