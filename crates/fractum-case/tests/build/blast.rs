//! Supports on facets, in-situ stress and firing sequences on a ring of rock.

use std::path::Path;

use fractum_case::build::build_scene;
use fractum_case::parse_case;
use fractum_fem::fields;
use fractum_math::Vec3;
use fractum_mesh::generate::{Jitter, structured_box};
use fractum_mesh::read_msh;

use crate::build;
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
        (STRESS.to_owned(), "in_situ: it acts", "on no facet"),
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

/// A box whose sides do not give way, and whose base may be clamped, begins with the stress asked for, whatever elastic rock would have between
/// such sides; supports hold it there, and nothing moves. Rollers bear no shear.
#[test]
fn sides_that_are_held_bear_the_stress_asked_for() {
    let mesh = structured_box([4, 3, 3], Vec3::new(0.4, 0.3, 0.3), Some(Jitter { fraction: 0.15, seed: 2 }));
    let support = |place: &str, fix: &str| format!("[[supports]]\nwhere = \"{place}\"\nfix = \"{fix}\"\n");
    let (left, front) = ("min(x, 0.4 - x) < 1e-6", "min(y, 0.3 - y) < 1e-6");
    let top = "[[supports]]\nwhere = \"z > 0.3 - 1e-6\"\nabsorbing = true\n";
    let inner = format!("z < 1e-6 && !({left}) && !({front})");
    let rollers = |base: &str| {
        let rim = format!("z < 1e-6 && ({left} || {front})");
        [support(left, "x"), support(front, "y"), support(&inner, base), support(&rim, "z"), top.to_owned()].concat()
    };
    let clamped = [support(&format!("{left} || {front} || z < 1e-6"), "xyz"), top.to_owned()].concat();
    let refused = rollers("z");
    for (supports, shear) in [(rollers("z"), 0.0), (rollers("xyz"), 0.0), (clamped, 0.4e6)] {
        let stress = format!("[in_situ]\nstress = {{ xx = -2e6, yy = -1e6, zz = -3e6, xy = {shear} }}\n");
        let mut scene = build(&format!("{HEAD}{supports}{stress}"), &mesh).scene;
        for _ in 0..20 {
            scene.step(true).unwrap();
        }
        for (stress, _) in fields::element_fields(&scene.solid, 0, None) {
            let off = stress.0.iter().zip([-2e6, -1e6, -3e6, shear, 0.0, 0.0]);
            let off = off.map(|(found, wanted)| (found - wanted).abs()).fold(0.0, f64::max);
            assert!(off < 1.0, "{supports}{stress:?}");
        }
    }
    let sheared = format!("{HEAD}{refused}[in_situ]\nstress = {{ xx = -2e6, yy = -1e6, zz = -3e6, xy = 0.4e6 }}\n");
    let case = parse_case(&sheared, Path::new("case.toml"), &[]).unwrap();
    let found = build_scene(&case, &mesh, Vec::new(), Vec::new()).err().map(|errors| errors.to_string());
    assert!(found.as_ref().is_some_and(|text| text.contains("contradicts the in-situ stress")), "{found:?}");
}

/// Layers of two materials between sides that do not give way have the stress asked for only where they need no strain for it: it is told, where the
/// stress was another one without a word.
#[test]
fn layers_between_held_sides_have_their_stress_or_are_refused() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../meshes/interfaces/shear.msh");
    let mesh = read_msh(&std::fs::read(file).unwrap()).unwrap();
    let body = |name: &str, young: f64| {
        format!(
            "[materials.{name}]\ndensity = 2500\nyoung_modulus = {young}\npoisson_ratio = 0.25\n\
             [[bodies]]\nname = \"{name}\"\nkind = \"solid\"\ngroup = \"{name}\"\nmaterial = \"{name}\"\n"
        )
    };
    let text_of = |xx: f64, upper: f64, sides: &str, groups: &str| {
        format!(
            "fractum = 1\n[mesh]\nfile = \"mesh.msh\"\n{}{}[solver]\nend = 1e-3\n[[supports]]\nwhere = \"{sides}\"\nfix = \"x\"\n\
             [[supports]]\ngroup = \"bottom\"\nfix = \"y\"\n[in_situ]\nstress = {{ xx = {xx}, yy = -3e6 }}\ngroups = {groups}\n",
            body("lower", 2e9),
            body("upper", upper)
        )
    };
    let case = |xx: f64, upper: f64, sides: &str| {
        let text = text_of(xx, upper, sides, "[\"top\"]");
        let case = parse_case(&text, Path::new("case.toml"), &[]).unwrap_or_else(|errors| panic!("{errors}"));
        let built = build_scene(&case, &mesh, Vec::new(), Vec::new());
        built.err().map_or(String::new(), |errors| errors.to_string())
    };
    let both = "min(x, 0.1 - x) < 1e-6";
    let refused = case(-2e6, 4e9, both);
    assert!(refused.contains("supports[0].where") && refused.contains("bodies of one material"), "{refused}");
    assert_eq!(case(-1e6, 4e9, both), "", "no strain along x");
    assert_eq!(case(-2e6, 2e9, both), "", "one material");
    let heavy = text_of(-1e6, 4e9, both, "[\"top\"]").replacen("density = 2500", "density = 3000", 1);
    let heavy = heavy.replace("yy = -3e6", "yy = \"25 kPa/m*y - 3 MPa\"") + "[[loads]]\ngravity = { y = -10 }\n";
    let case_of = parse_case(&heavy, Path::new("case.toml"), &[]).unwrap_or_else(|errors| panic!("{errors}"));
    let found = build_scene(&case_of, &mesh, Vec::new(), Vec::new()).err().map_or(String::new(), |e| e.to_string());
    assert!(found.contains("bodies of one density"), "{found}");
    // Between a plane of symmetry and the stress they share it by their stiffness, which is told.
    let pressed = |upper: f64| {
        let text = text_of(-2e6, upper, "x < 1e-6", "[\"top\"]");
        let text = text + "[[supports]]\nwhere = \"x > 0.1 - 1e-6\"\nabsorbing = true\n";
        let built = build(&text, &mesh);
        built.warnings.iter().map(ToString::to_string).filter(|text| text.contains("shared-stress")).collect::<Vec<_>>()
    };
    let told = pressed(20e9);
    assert!(told.len() == 1 && told[0].contains("a mean xx of"), "{told:?}");
    assert!(pressed(2e9).is_empty());
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
