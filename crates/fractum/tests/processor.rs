//! The same bits on every processor: the C library chooses its functions by instruction set, and nothing of it reaches a state.

use std::fs;
use std::path::Path;

use crate::common::{BREAKING_BAR, Workplace, summary};

/// Hides AVX2 and FMA from the C library.
const OLDER_PROCESSOR: &str = "glibc.cpu.hwcaps=-AVX2,-FMA,-AVX2_Usable,-FMA_Usable";

fn assert_same_bits_on_an_older_processor(case: &str) {
    let place = Workplace::new(case);
    let hash = |folder: &str, capabilities: &str| {
        let mut command = place.command(&["run", "case.toml", "-o", folder, "--threads", "1", "--quiet"]);
        let output = command.env("GLIBC_TUNABLES", capabilities).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        let summary = summary(&place, folder);
        assert!(summary["energy"]["damage"].as_f64() > Some(0.0), "{}", summary["energy"]);
        summary["state_hash"].as_str().unwrap().to_owned()
    };
    assert_eq!(hash("all", ""), hash("fewer", OLDER_PROCESSOR));
}

/// A case of the gallery with the path of its mesh, and one text for another.
fn of_gallery(name: &str, [now, instead]: [&str; 2]) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap();
    let case = fs::read_to_string(root.join(format!("cases/{name}.toml"))).unwrap();
    assert!(case.contains(now) && case.contains("\"../../meshes/"));
    case.replace("\"../../meshes/", &format!("\"{}/meshes/", root.display())).replace(now, instead)
}

#[test]
fn a_softening_bar_in_motion_has_the_bits_of_an_older_processor() {
    assert_same_bits_on_an_older_processor(&of_gallery("tension-bar/gmsh-coarse", ["\"6 ms\"", "\"2.4 ms\""]));
}

#[test]
fn a_softening_bar_at_equilibrium_has_the_bits_of_an_older_processor() {
    assert_same_bits_on_an_older_processor(&of_gallery(
        "tension-bar/gmsh-coarse-static",
        ["below = 0.01", "below = 0.9"],
    ));
}

#[test]
fn debris_with_scattered_strengths_has_the_bits_of_an_older_processor() {
    let scattered = BREAKING_BAR.replace(
        "distribution = \"uniform-per-edge\"\nwidth = 0.1",
        "distribution = \"weibull-per-edge\"\nmodulus = 8",
    );
    assert!(scattered.contains("weibull"));
    assert_same_bits_on_an_older_processor(&scattered);
}
