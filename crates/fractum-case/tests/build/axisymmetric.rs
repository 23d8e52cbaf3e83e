//! Solids turned about the y axis: areas, masses and supports of the whole turn, and what is refused by name.

use std::f64::consts::PI;
use std::path::Path;

use fractum_case::build::build_scene;
use fractum_case::parse_case;
use fractum_mesh::Mesh;
use fractum_mesh::generate::structured_rectangle;
use fractum_scene::ProbedScene;

use crate::build;

const TUBE: &str = r#"fractum = 1
[mesh]
file = "mesh.msh"
[materials.steel]
density = 7800
young_modulus = 210e9
poisson_ratio = 0.3
[[bodies]]
name = "tube"
kind = "solid"
group = "body"
material = "steel"
plane = "axisymmetric"
[[supports]]
group = "y-"
fix = "y"
[solver]
end = "1 ms"
"#;

/// A section of 0.4 m by 0.1 m whose radii begin at this one.
fn section(inner: f64) -> Mesh {
    let mut mesh = structured_rectangle([8, 2], [0.4, 0.1], None);
    mesh.nodes.iter_mut().for_each(|node| node.x += inner);
    mesh
}

#[test]
fn loads_and_masses_are_those_of_the_whole_turn() {
    for inner in [0.0, 0.2] {
        let more = r#"
[[loads]]
group = "y+"
pressure = "1 MPa"
[[loads]]
group = "y+"
traction = { y = "3 MPa" }
[[loads]]
group = "x+"
force = { y = "4 kN" }
[[probes]]
name = "pushed"
load = { group = "y+", along = "y" }
[[probes]]
name = "pulled"
load = { group = "x+", along = "y" }
"#;
        let built = build(&format!("{TUBE}{more}"), &section(inner));
        let (mut scene, outer) = (built.scene, inner + 0.4);
        scene.step(true).unwrap();
        let values: Vec<f64> = built.probes.iter().flatten().map(|p| p.value(&ProbedScene::new(&scene))).collect();
        let area = PI * (outer * outer - inner * inner);
        let corner = 4e3 / 4.0;
        assert!((values[0] - 2e6 * area - corner).abs() < 1e-6 * 2e6 * area, "{inner}: {values:?}");
        // The upper corner has a share of what acts on the upper side.
        assert!(values[1] > 4e3, "{inner}: {values:?}");
        let mass: f64 = scene.solid.mass.iter().sum();
        assert!((mass / (7800.0 * area * 0.1) - 1.0).abs() < 1e-12, "{inner}: {mass}");
        let on_axis = if inner == 0.0 { 3 } else { 0 };
        let held = scene.supports().held().iter().filter(|bits| *bits & 1 == 1).count();
        assert_eq!(held, on_axis);
    }
}

/// What refuses a case on a section from this radius.
fn refusal(case: &str, inner: f64) -> String {
    let case = match parse_case(case, Path::new("case.toml"), &[]) {
        Ok(case) => case,
        Err(errors) => return errors.to_string(),
    };
    match build_scene(&case, &section(inner), Vec::new(), Vec::new()) {
        Ok(_) => panic!("it is accepted: {}", case.source.text),
        Err(errors) => errors.to_string(),
    }
}

#[test]
fn what_has_no_meaning_around_an_axis_is_refused_by_name() {
    let with = |more: &str| refusal(&format!("{TUBE}{more}"), 0.0);
    let instead = |from: &str, to: &str| refusal(&TUBE.replace(from, to), 0.0);
    let plane = "plane = \"axisymmetric\"";
    let rows = [
        (refusal(TUBE, -0.2), "node at (-200 mm, 0 m)", "x >= 0"),
        (instead(plane, &format!("{plane}\nthickness = \"1 cm\"")), "thickness", "remove the key"),
        (
            instead(plane, &format!("{plane}\ninitial_velocity = {{ x = \"1 m/s\" }}")),
            "radial component",
            "zero where x = 0",
        ),
        (
            instead(
                "[solver]",
                "[materials.steel.bedding]\nnormal = [0, 1, 0]\nyoung_modulus_normal = 1e11\npoisson_ratio_normal = 0.2\n[solver]",
            ),
            "beds",
            "without bedding",
        ),
        (with("[[loads]]\ngravity = { x = \"9.81 m/s^2\" }"), "not along the axis", "gravity along y"),
        (with("[[loads]]\ngroup = \"y+\"\ntraction = { z = \"1 MPa\" }"), "cannot move along z", "along x or y"),
        (instead("end = \"1 ms\"", "kind = \"modes\""), "bend or twist", "a case in space"),
        (with("[[supports]]\ngroup = \"y+\"\nvelocity = { x = \"1 m/s\" }"), "on the axis away from it", "x = 0"),
        (with("[[probes]]\nname = \"p\"\nmomentum = { along = \"x\" }"), "momentum across the axis", "along = \"y\""),
        (with("[[probes]]\nname = \"p\"\nangular_momentum = { along = \"z\" }"), "angular momentum", "momentum"),
        (with("[in_situ]\nstress = { yy = \"-1 MPa\" }"), "in-situ stress", "in the plane or in space"),
        (
            rigid("shape = \"sphere\"\npoint = [\"1 cm\", \"20 cm\", 0]\nradius = \"1 cm\""),
            "not round",
            "centre on the y axis",
        ),
        (
            rigid(
                "shape = \"cylinder\"\naxis = \"x\"\npoint = [0, \"20 cm\", 0]\nradius = \"1 cm\"\nlength = \"1 cm\"",
            ),
            "not round",
            "axis = \"y\"",
        ),
        (rigid("shape = \"box\"\npoint = [0, \"20 cm\", 0]\nsize = [1, 1, 1]"), "not round", "a cylinder or a sphere"),
        (
            rigid("shape = \"sphere\"\npoint = [0, \"20 cm\", 0]\nradius = \"1 cm\"\nvelocity = { x = \"1 m/s\" }"),
            "out of the axis",
            "along y",
        ),
    ];
    for (found, what, remedy) in rows {
        assert!(
            found.contains(what) && found.contains(remedy) && found.contains("case.toml:"),
            "{what}, {remedy}: {found}"
        );
    }
}

fn rigid(shape: &str) -> String {
    refusal(&format!("{TUBE}[[bodies]]\nname = \"tool\"\nkind = \"rigid\"\n{shape}\n"), 0.0)
}
