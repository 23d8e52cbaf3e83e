//! Holes that hold liquid: pressure by volume, breakdown, and the crack after it.

use std::f64::consts::PI;
use std::path::Path;

use serde_json::Value;

use crate::common::{Workplace, history, resumed, run, summary};

const HOLE: &str = include_str!("../../../cases/liquid/hole.toml");
const BOREHOLE: &str = include_str!("../../../cases/liquid/borehole.toml");

/// A case of cases/liquid with its mesh.
fn of_gallery(case: &str, mesh: &str) -> Workplace {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../meshes").join(mesh);
    let text = case.replace(&format!("../../meshes/{mesh}"), "bar.msh");
    let head = text.split("[[expect]]").next().unwrap();
    Workplace::with_mesh(head, &std::fs::read(file).unwrap())
}

fn ring(case: &str) -> Workplace {
    of_gallery(case, "ring-plane/ring.msh")
}

fn borehole(case: &str) -> Workplace {
    of_gallery(case, "borehole-plane/half.msh")
}

/// Runs a place with parameters; its summary.
fn run_with(place: &Workplace, sets: &[&str]) -> Value {
    let mut arguments = vec!["run", "case.toml", "--quiet", "-o", "one", "--overwrite", "--threads", "1"];
    sets.iter().for_each(|set| arguments.extend(["--set", set]));
    let ended = place.fractum(&arguments);
    assert_eq!(ended.code, Some(0), "{sets:?}: {}", ended.stderr);
    let one = summary(place, "one");
    let off = one["energy"]["residual_max_relative"].as_f64().unwrap();
    assert!(off < 1e-3, "{sets:?}: {}", one["energy"]);
    one
}

fn probe(of: &Value, name: &str, what: &str) -> f64 {
    of["probes"][name][what].as_f64().unwrap()
}

/// Q/(V c + S + dV/dp), with the opening of the wall of a thick ring: Lamé in plane strain and plane stress.
#[test]
fn pressure_in_a_hole_follows_from_liquid_lines_and_wall() {
    let (inner, outer, young) = (0.05f64, 0.1f64, 30e9);
    for plane in ["strain", "stress"] {
        let place = ring(&HOLE.replace("plane = \"strain\"", &format!("plane = \"{plane}\"")));
        for nu in [0.0, 0.2, 0.45] {
            for (compressibility, storage, depth) in [(0.0, 0.0, 1.0), (4.5e-10, 0.0, 0.1), (4.5e-10, 1e-12, 1.0)] {
                let sets = [
                    format!("nu={nu}"),
                    format!("compressibility={compressibility} 1/Pa"),
                    format!("storage={storage} m^3/Pa"),
                    format!("depth={depth} m"),
                ];
                let one = run_with(&place, &sets.each_ref().map(String::as_str));
                let (a, b) = (inner * inner, outer * outer);
                let of_ring = match plane {
                    "strain" => (1.0 + nu) * ((1.0 - 2.0 * nu) * a + b),
                    _ => (1.0 - nu) * a + (1.0 + nu) * b,
                };
                let opens = of_ring / young * inner / (b - a);
                let gives = 0.25 * PI * a * depth * compressibility + storage + 0.5 * PI * inner * depth * opens;
                let error = probe(&one, "pressure", "final") * gives / 1e-8 - 1.0;
                assert!(error.abs() < 3e-3, "{plane} {nu} {compressibility} {storage}: {error}");
                assert!(one["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-8, "{}", one["energy"]);
            }
        }
    }
}

/// Steps end where the rate jumps or has a kink: each puts in what the rate says.
#[test]
fn what_is_put_in_is_the_rate_over_time() {
    for (rate, volume) in [
        ("if(t < 5 s, put_in/5 s, 0 m^3/s)", 1e-8),
        ("put_in/10 s*t/10 s", 0.5e-8),
        ("if(t < 5 s, put_in/5 s, -put_in/10 s)", 0.5e-8),
    ] {
        let place =
            ring(&HOLE.replace("rate = \"put_in/10 s\"", &format!("rate = \"{rate}\"")).replace("\"1 s\"", "\"4 s\""));
        let jumping = run_with(&place, &[]);
        let steady = run_with(&ring(HOLE), &[&format!("put_in={volume} m^3")]);
        let error = probe(&jumping, "pressure", "final") / probe(&steady, "pressure", "final") - 1.0;
        assert!(error.abs() < 1e-6, "{rate}: {error}");
    }
}

/// The stress at the wall of a circular hole meets the strength at 3 s_min - s_max + f_t, whatever the liquid; then the pressure falls.
#[test]
fn a_borehole_breaks_down_as_the_strength_at_its_wall_is_met() {
    let place = borehole(&BOREHOLE.replace("duration/200", "duration/50"));
    for (sets, least, most) in [
        (["stress=10 MPa", "along=15 MPa", "volume=3e-5 m^3", "nu=0"], 20e6, 15e6),
        (["stress=10 MPa", "along=10 MPa", "volume=4e-5 m^3", "nu=0.2"], 25e6, 20e6),
        (["stress=10 MPa", "along=23 MPa", "volume=2e-5 m^3", "nu=0.3"], 12e6, 11.8e6),
        (["storage=1e-11 m^3/Pa", "compressibility=4.5e-10 1/Pa", "volume=4.5e-4 m^3", "nu=0.2"], 20e6, 15e6),
    ] {
        let one = run_with(&place, &sets);
        let [peak, last] = ["max", "final"].map(|what| probe(&one, "pressure", what));
        // A step is some 3 % of the pressure.
        assert!(peak > 0.94 * least && peak < 1.03 * least, "{sets:?}: {peak}");
        assert!(last < most, "{sets:?}: {last}");
    }
}

/// A sleeve presses on the wall alone: the line softens step by step under ever more pressure, and no liquid enters it.
#[test]
fn a_sealed_hole_gives_no_liquid_to_its_cracks() {
    let place =
        borehole(&BOREHOLE.replace("duration/200", "duration/50").replace("storage = \"storage\"", "sealed = true"));
    let one = run_with(&place, &["volume=3.5e-5 m^3"]);
    assert!(probe(&one, "pressure", "final") > 21e6 && probe(&one, "area", "final") == 0.0, "{}", one["probes"]);
}

#[test]
fn a_borehole_has_the_same_bits_on_any_threads_and_after_a_resume() {
    let text = BOREHOLE.replace("duration/200", "duration/40");
    let text = text.split("[[expect]]").next().unwrap();
    let place = borehole(&format!("{text}\n[output]\ncheckpoint = {{ steps = 12 }}\n"));
    let one = run(&place, "one", "1");
    for threads in ["2", "7"] {
        assert_eq!(one["state_hash"], run(&place, threads, threads)["state_hash"]);
    }
    assert_eq!(one["state_hash"], resumed(&place, "2")["state_hash"]);
    assert_eq!(summary(&place, "2")["energy"], one["energy"]);
}

/// A tenth of a millimetre, and kilometres: the pressures are those of the case.
#[test]
fn a_borehole_of_any_size_breaks_down_at_the_same_pressure() {
    let text = BOREHOLE.replace("duration/200", "duration/50");
    let of = |unit: &str, scale: f64| {
        let place = borehole(&text.replace("unit = \"m\"", &format!("unit = \"{unit}\"")));
        let sets = [format!("energy={} J/m^2", 32.0 * scale), format!("volume={} m^3", 4e-5 * scale * scale)];
        run_with(&place, &sets.each_ref().map(String::as_str));
        history(&place, "one", &["pressure", "opening"])
    };
    let large = of("m", 1.0);
    for (unit, scale) in [("mm", 1e-3), ("km", 1e3)] {
        let own = of(unit, scale);
        assert_eq!(own.len(), large.len());
        for (own, large) in own.iter().zip(&large) {
            assert!((own[0] - large[0]).abs() < 1e-4 * 20e6, "{unit}: {own:?} {large:?}");
            assert!((own[1] / scale - large[1]).abs() < 1e-3 * 8e-5, "{unit}: {own:?} {large:?}");
        }
    }
}

/// A hole that no interface meets is told, and one whose wall is held all around refused.
#[test]
fn holes_that_cannot_be_meant_are_told() {
    let alone = BOREHOLE.replace("group = \"line\"", "group = \"gap\"");
    let gap = "[[mesh.joints]]\nname = \"gap\"\ntable = [[\"1.5 m\", \"1 m\", \"1.5 m\", \"2 m\"]]\n";
    let place = borehole(&alone.replace("[materials.rock]", &format!("{gap}[materials.rock]")));
    let ended = place.fractum(&["check", "case.toml"]);
    assert!(ended.stdout.contains("[liquid-hole-alone]"), "{} {}", ended.stdout, ended.stderr);
    let held = format!("{HOLE}\n")
        .replace("where = \"x < 1e-4*inner\"\nfix = \"x\"", "where = \"x < 1e3*inner\"\nfix = \"xy\"");
    let place = ring(&held.replacen("[[supports]]\nwhere = \"y < 1e-4*inner\"\nfix = \"y\"\n", "", 1));
    let ended = place.fractum(&["check", "case.toml", "--set", "compressibility=0 1/Pa", "--set", "storage=0 m^3/Pa"]);
    assert!(ended.code == Some(1) && ended.stderr.contains("held all around"), "{} {}", ended.stdout, ended.stderr);
}
