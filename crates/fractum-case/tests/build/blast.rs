//! Supports on facets, in-situ stress and firing sequences on a ring of rock.

use std::path::Path;

use fractum_case::build::build_scene;
use fractum_case::parse_case;

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

#[test]
fn measures_that_do_not_fit_are_refused_with_their_place() {
    let probe = |what: &str| format!("[[probes]]\nname = \"p\"\n{what}\n");
    let ppv = |what: &str| format!("[[output.ppv]]\nname = \"s\"\nhole = \"inner\"\n{what}\n");
    let cases = [
        (probe("damaged = { measure = \"share\" }"), "nothing there may be damaged"),
        (probe("damaged = { measure = \"share\", group = \"body\" }"), "nothing there may be damaged"),
        (probe("wave_speed = { body = \"stone\", wave = \"shear\" }"), "the name of a solid body"),
        (probe("wave_speed = { body = \"rock\", wave = \"shear\" }"), ""),
        (ppv("groups = [\"outer\", \"rim\"]"), "rim"),
        (ppv("groups = [\"inner\"]"), ""),
        (ppv("centre = [2, 0, 0]\ngroups = [\"outer\"]"), "a station lies on the axis or centre of the hole"),
        (ppv("line = { from = [1.1, 0, 0], to = [2, 0, 0], stations = 3 }"), ""),
    ];
    for (text, said) in cases {
        let found = mistakes(&format!("{OUTSIDE}{text}"));
        assert!(found.contains(said) && found.is_empty() == said.is_empty(), "{text}\n{found}");
    }
}

#[test]
fn stations_have_their_distances_in_radii_of_the_hole_or_scaled_by_the_charge() {
    let line = "line = { from = [1.1, 0, 0], to = [2, 0, 0], stations = 3 }";
    for (charge, scale, unit) in [("", 1.0, "-"), ("charge = 16", 4.0, "m/kg^(1/2)")] {
        let text = format!(
            "{HEAD}{OUTSIDE}[[output.ppv]]\nname = \"s\"\nhole = \"inner\"\ncentre = [0, 0, 0]\n{line}\n{charge}\n"
        );
        let case = parse_case(&text, Path::new("case.toml"), &[]).unwrap_or_else(|e| panic!("{e}"));
        let built = build_scene(&case, &ring(Listed::Along, Listed::Along), Vec::new(), Vec::new());
        let built = built.unwrap_or_else(|e| panic!("{e}"));
        let ppv = &built.ppv[0];
        assert!((ppv.scale - scale).abs() < 1e-9 && ppv.unit == unit, "{} {}", ppv.scale, ppv.unit);
        let (first, last) = (&ppv.stations[0], ppv.stations.last().unwrap());
        let [first, last] = [first, last].map(|station| station.places[0].distance);
        assert!(first < last && (last - 2.0).abs() < 1e-9, "{:?}", ppv.stations);
        let mut places = ppv.stations.iter().flat_map(|of| &of.places);
        assert!(places.all(|of| (of.place.norm() - of.distance).abs() < 1e-9), "{:?}", ppv.stations);
    }
}
