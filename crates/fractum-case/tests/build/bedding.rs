//! Bedded rock in scenes: in-situ stress, absorbing sides, and what does not fit to beds.

use std::path::Path;

use fractum_case::build::build_scene;
use fractum_case::parse_case;
use fractum_fem::fields;
use fractum_math::Vec3;
use fractum_mesh::generate::{Jitter, structured_box};

use crate::build;
use crate::sides::{Listed, ring};

fn case(beds: &str, rest: &str) -> String {
    format!(
        "fractum = 1\n[materials.shale]\ndensity = 2500\nyoung_modulus = 27e9\npoisson_ratio = 0.15\n[materials.shale.bedding]\n{beds}\n\
         young_modulus_normal = 12e9\npoisson_ratio_normal = 0.2\n[mesh]\nfile = \"mesh.msh\"\n[[bodies]]\nname = \"rock\"\nkind = \"solid\"\ngroup = \"body\"\n\
         material = \"shale\"\n[solver]\nend = 1e-3\n{rest}"
    )
}

/// A box with beds out of all axes begins with the stress asked for, on symmetry planes or none; and nothing moves.
#[test]
fn beds_begin_under_the_stress_in_situ() {
    let mesh = structured_box([4, 3, 3], Vec3::new(0.4, 0.3, 0.3), Some(Jitter { fraction: 0.15, seed: 2 }));
    for (formulation, normal) in [("standard", "[1, 2, 3]"), ("smoothed", "[1, 2, 3]"), ("smoothed", "\"z\"")] {
        let rest = "[[supports]]\nwhere = \"min(min(x, y), min(min(z, 0.4 - x), min(0.3 - y, 0.3 - z))) < 1e-6\"\nabsorbing = true\n\
                    [in_situ]\nstress = { xx = -2e6, yy = -1e6, zz = -3e6, xy = 0.4e6, yz = -0.3e6, zx = 0.2e6 }\n";
        let text = case(&format!("normal = {normal}"), rest);
        let text =
            text.replace("material = \"shale\"", &format!("material = \"shale\"\nformulation = \"{formulation}\""));
        let mut scene = build(&text, &mesh).scene;
        for _ in 0..50 {
            scene.step(true).unwrap();
        }
        let expected = [-2e6, -1e6, -3e6, 0.4e6, -0.3e6, 0.2e6];
        for (stress, _) in fields::element_fields(&scene.solid, 0, None) {
            let off = stress.0.iter().zip(expected).map(|(found, wanted)| (found - wanted).abs()).fold(0.0, f64::max);
            assert!(off < 1.0, "{formulation} {normal}: {stress:?}");
        }
    }
}

#[test]
fn what_does_not_fit_to_beds_is_refused_with_its_place() {
    let probe = "[[probes]]\nname = \"c\"\nwave_speed = { body = \"rock\", wave = \"shear\" }\n";
    for (beds, rest, place, said) in [
        ("dip = 0.5\ndip_direction = 1", "", "materials.shale.bedding", "third axis is not vertical"),
        ("normal = [1, 2, 0]", probe, "probes[0].wave_speed.body", "speeds by direction"),
        ("normal = [1, 2, 0]", "", "", ""),
    ] {
        let text = case(beds, rest);
        let case = parse_case(&text, Path::new("case.toml"), &[]).unwrap_or_else(|errors| panic!("{errors}"));
        let built = build_scene(&case, &ring(Listed::Along, Listed::Along), Vec::new(), Vec::new());
        let found = built.err().map_or(String::new(), |errors| errors.to_string());
        assert!(
            found.contains(place) && found.contains(said) && found.is_empty() == said.is_empty(),
            "{text}\n{found}"
        );
    }
}
