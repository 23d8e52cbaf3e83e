//! Cracks that liquid opens in rock under in-situ stress.

use std::f64::consts::PI;

use fractum_mesh::MshFormat;
use fractum_mesh::generate::structured_rectangle;
use serde_json::Value;

use crate::common::{Workplace, history, mesh_bytes, resumed, run, summary};

/// A case of cases/liquid with its mesh.
fn of_gallery(case: &str) -> Workplace {
    let mesh = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../../meshes/interfaces/liquid.msh")).unwrap();
    Workplace::with_mesh(&case.replace("../../meshes/interfaces/liquid.msh", "bar.msh"), &mesh)
}

const CONFINED: &str = include_str!("../../../cases/liquid/confined.toml");
const VISCOSITY: &str = include_str!("../../../cases/liquid/viscosity.toml");

/// Runs a place with parameters; its summary.
fn run_with(place: &Workplace, sets: &[&str]) -> Value {
    let mut arguments = vec!["run", "case.toml", "--quiet", "-o", "one", "--overwrite", "--threads", "1"];
    sets.iter().for_each(|set| arguments.extend(["--set", set]));
    let ended = place.fractum(&arguments);
    assert_eq!(ended.code, Some(0), "{sets:?}: {}", ended.stderr);
    let one = summary(place, "one");
    assert!(energy(&one, "residual_max_relative") < 1e-6, "{sets:?}: {}", one["energy"]);
    one
}

fn probes<const N: usize>(of: &Value, names: [&str; N]) -> [f64; N] {
    names.map(|name| of["probes"][name]["final"].as_f64().unwrap())
}

fn energy(of: &Value, name: &str) -> f64 {
    of["energy"][name].as_f64().unwrap_or(0.0)
}

/// Elastic solids: what the stress adds is the pressure that it takes to open the crack against it.
#[test]
fn a_crack_under_in_situ_stress_is_the_one_without_at_the_pressure_above_it() {
    let place = of_gallery(&CONFINED.replace("duration/60", "duration/20"));
    for nu in ["0.1", "0.2", "0.3", "0.4"] {
        let of = |sets: &[&str]| {
            let sets = [&[&format!("nu={nu}")], sets].concat();
            probes(&run_with(&place, &sets), ["opening", "net", "area"])
        };
        let free = of(&["stress=1 Pa", "along=1 Pa"]);
        for sets in [["stress=1 MPa", "along=1 MPa"], ["stress=10 MPa", "along=6 MPa"], ["stress=50 MPa", "along=80 MPa"]] {
            let found = of(&sets);
            for (found, free) in found.iter().zip(free) {
                assert!((found / free - 1.0).abs() < 1e-3, "nu {nu}, {sets:?}: {found} {free}");
            }
        }
    }
}
