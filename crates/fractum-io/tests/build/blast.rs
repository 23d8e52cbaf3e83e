//! Supports on facets, in-situ stress and firing sequences on a ring of rock.

use std::path::Path;

use fractum_io::build::build_scene;
use fractum_io::case::parse_case;

use crate::sides::{Listed, ring};

const HEAD: &str = "fractum = 1\n[materials.rock]\ndensity = 2500\nyoung_modulus = 20e9\npoisson_ratio = 0.25\n\
                    [mesh]\nfile = \"ring.msh\"\n[[bodies]]\nname = \"rock\"\nkind = \"solid\"\ngroup = \"body\"\nmaterial = \"rock\"\n\
                    [solver]\nend = 1e-3\n";
const OUTSIDE: &str = "[[supports]]\nwhere = \"hypot(x, y) > 1.9\"\nabsorbing = true\n";
const STRESS: &str = "[in_situ]\nstress = { xx = -2e6, yy = -2e6 }\n";

/// What is wrong with the case, a line per mistake; nothing where it is built.
fn mistakes(text: &str) -> String {
    let case = parse_case(&format!("{HEAD}{text}"), Path::new("case.toml"), &[]).unwrap_or_else(|e| panic!("{e}"));
    let built = build_scene(&case, &ring(Listed::Along, Listed::Along), Vec::new(), Vec::new());
    built.err().map_or(String::new(), |errors| errors.to_string())
}

#[test]
fn what_does_not_fit_is_refused_with_its_place() {
    let inner = OUTSIDE.replace("> 1.9", "< 1.1");
    let sheared = format!("{OUTSIDE}{}", STRESS.replace("yy = -2e6", "xy = 1e6"));
    let cases = [
        (inner.clone(), "supports[0].where", "has facets of a cavity, an inner boundary"),
        (
            format!("{OUTSIDE}[pulses]\ncut = 1e6\n[[loads]]\nfiring = [[\"hole_9\", 0, \"cut\"]]\n"),
            "loads[0].firing[0][0]",
            "groups there: inner, outer, body",
        ),
        (STRESS.to_owned(), "in_situ", "acts on no facet"),
        (format!("{STRESS}[[supports]]\nwhere = \"x > 1.9\"\nabsorbing = true\n"), "in_situ", "do not balance"),
        (
            format!("{OUTSIDE}{STRESS}[[supports]]\nwhere = \"abs(y) < 0.3\"\nfix = \"x\"\n"),
            "supports[1].where",
            "contradicts the in-situ stress",
        ),
        (format!("{OUTSIDE}{}", STRESS.replace("-2e6,", "\"1 MPa/m*y\",")), "", ""),
        (
            format!("{OUTSIDE}{}", STRESS.replace("-2e6 }", "\"25 kPa/m*y - 1 MPa\" }")),
            "in_situ",
            "gravity y = \"-10 m/s²\"",
        ),
        (format!("{OUTSIDE}{}", STRESS.replace("-2e6,", "\"1 MPa/m^2*x*y\",")), "in_situ", "is not linear"),
        (sheared, "", ""),
        (format!("{OUTSIDE}{STRESS}"), "", ""),
    ];
    for (text, place, said) in cases {
        let found = mistakes(&text);
        if said.is_empty() {
            assert_eq!(found, "", "{text}");
        } else {
            assert!(found.contains(place) && found.contains(said) && found.lines().count() == 1, "{text}\n{found}");
        }
    }
}

#[test]
fn the_rock_is_at_rest_and_displacements_count_from_there() {
    let case = parse_case(&format!("{HEAD}{OUTSIDE}{STRESS}"), Path::new("case.toml"), &[]).unwrap();
    let mut scene = build_scene(&case, &ring(Listed::Along, Listed::Along), Vec::new(), Vec::new()).unwrap().scene;
    let stressed = scene.solid.displacement.iter().map(|u| u.norm()).fold(0.0, f64::max);
    assert!(stressed > 1e-5, "the ring gives way by {stressed} m");
    for _ in 0..50 {
        scene.step(true).unwrap();
    }
    let moved = (0..scene.solid.mass.len()).map(|n| scene.solid.displacement_from_start(n).norm()).fold(0.0, f64::max);
    assert!(moved < 1e-9 * stressed, "{moved}");
}
