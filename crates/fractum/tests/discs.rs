//! Plane discs, as their user meets them: `cases/discs`, and what they cannot be beside.

use std::fs;

use crate::common::{Workplace, resumed, run};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// A case of `cases/discs`, with the mesh of its beam.
fn case(name: &str, change: impl Fn(String) -> String) -> Workplace {
    let text = fs::read_to_string(format!("{ROOT}/cases/discs/{name}.toml")).unwrap();
    let text = change(text);
    let size = if text.contains("delaunay-8") { 8 } else { 4 };
    let mesh = format!("meshes/cantilever-plane/delaunay-{size}.msh");
    let bytes = fs::read(format!("{ROOT}/{mesh}")).unwrap();
    Workplace::with_mesh(&text.replace(&format!("../../{mesh}"), "bar.msh"), &bytes)
}

/// Discs fall on a free beam and roll off its ends: many contacts on edges and corners.
fn shower() -> Workplace {
    case("edge", |text| {
        let drop = "centre = [\"0.8 m\", \"0.05 m + radius + speed*0.1 ms\"]\nparticle_radius = \"radius\"";
        let cloud = "shape = \"rectangle\"\npoint = [\"-0.2 m\", \"0.052 m\"]\nsize = [\"1.4 m\", \"0.3 m\"]\n\
                     particle_radius = \"15 mm\"\ndispersion = 0.6\nsolid_fraction = 0.7";
        assert!(text.contains(drop));
        text.replace(drop, cloud).replace("end = \"4 ms\"", "end = \"20 ms\"\n[output.checkpoint]\nsteps = 2000")
    })
}

#[test]
fn a_shower_of_discs_has_the_same_bits_on_any_threads_and_after_a_checkpoint() {
    let place = shower();
    let one = run(&place, "one", "1");
    let value = |name: &str, which: &str| one["probes"][name][which].as_f64().unwrap();
    assert!(value("blow", "max") > 100.0, "{}", one["probes"]);
    assert!(one["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-3, "{}", one["energy"]);
    assert!(value("off", "final") < 1e-9, "{}", one["probes"]);
    for threads in ["2", "7"] {
        let more = run(&place, threads, threads);
        assert_eq!((&more["state_hash"], &more["probes"]), (&one["state_hash"], &one["probes"]), "{threads}");
    }
    let resumed = resumed(&place, "2");
    assert_eq!((&resumed["state_hash"], &resumed["energy"]), (&one["state_hash"], &one["energy"]));
}

#[test]
fn a_disc_breaks_a_beam_and_meets_what_lies_behind_its_edge() {
    let place = case("edge", |text| {
        let damage = "[materials.concrete.damage]\ntensile_strength = \"1 MPa\"\nfracture_energy = \"10 J/m^2\"\n\n";
        let text = text.replacen("[[bodies]]", &format!("{damage}[[bodies]]"), 1);
        text.replace("speed = \"2 m/s\"", "speed = \"20 m/s\"").replace("delaunay-4", "delaunay-8")
    });
    let found = run(&place, "one", "1");
    assert!(found["counts"]["removed_elements"].as_u64().unwrap() > 20, "{}", found["counts"]);
    for (probe, most) in [("off", 1e-9), ("off_turning", 1e-9)] {
        assert!(found["probes"][probe]["final"].as_f64().unwrap() < most, "{}", found["probes"]);
    }
    assert!(found["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-3, "{}", found["energy"]);
    // It would fly through with its 20 m/s.
    assert!(found["probes"]["disc"]["final"].as_f64().unwrap() > -5.0, "{}", found["probes"]);
}

#[test]
fn what_discs_cannot_be_beside_is_told_with_its_place() {
    let told = |name: &str, change: &dyn Fn(String) -> String, expected: &str| {
        let place = case(name, change);
        let ended = place.fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(1), "{expected}: {}", ended.stderr);
        assert!(ended.stderr.contains(expected) && ended.stderr.contains("case.toml:"), "{expected}: {}", ended.stderr);
    };
    let more = |body: &'static str| move |text: String| format!("{text}\n[[bodies]]\nname = \"other\"\n{body}");
    let spheres = "kind = \"particles\"\nmaterial = \"stone\"\ncentre = [\"0 mm\", \"1 m\", \"0 mm\"]\nparticle_radius = \"5 mm\"\n";
    told("roll", &more(spheres), "spheres beside the discs of \"disc\"");
    let thick = "kind = \"particles\"\nmaterial = \"stone\"\ncentre = [\"0 mm\", \"1 m\"]\nparticle_radius = \"5 mm\"\nthickness = \"1 m\"\n";
    told("roll", &more(thick), "discs of thickness 1 m beside those of \"disc\", of 50 mm");
    let ball = "kind = \"rigid\"\nshape = \"sphere\"\npoint = [\"1 m\", \"0 m\", \"0 m\"]\nradius = \"0.1 m\"\n";
    told("roll", &more(ball), "touch neither spheres nor facets");
    let beside = "kind = \"rigid\"\nshape = \"box\"\npoint = [\"1 m\", \"0 m\", \"0.1 m\"]\nsize = [\"1 m\", \"1 m\", \"1 m\"]\n";
    told("roll", &more(beside), "not through the plane of the discs, z = 0 m");
    told(
        "roll",
        &|text| text.replace("gravity = { y", "gravity = { z"),
        "discs lie in the xy-plane and cannot move along z",
    );
    told("roll", &|text| text.replace("x = \"speed\"", "z = \"speed\""), "moves discs out of their plane");
    told("roll", &|text| text.replace("\"radius\"]", "\"radius\", \"0 mm\"]"), "a list of two numbers");
    told("roll", &|text| text + "\n[periodic]\nsize = [\"1 m\", \"1 m\", \"1 m\"]\n", "periodic box");
    told(
        "roll",
        &|text| {
            text.replace(
                "restitution = 0.2 }\n\n[[bodies]]\nname = \"disc\"",
                "restitution = 0.2, work_of_adhesion = \"1 J/m^2\" }\n\n[[bodies]]\nname = \"disc\"",
            )
        },
        "discs do not stick",
    );
    told(
        "edge",
        &|text| text.replacen("thickness = \"0.1 m\"", "thickness = \"0.2 m\"", 1),
        "its thickness of 200 mm is not that of the discs",
    );
    told(
        "edge",
        &|text| text.replacen("plane = \"stress\"\nthickness = \"0.1 m\"", "plane = \"axisymmetric\"", 1),
        "axis",
    );
}
