//! Components about an axis, on a ring: against closed forms.

use std::f64::consts::TAU;

use fractum_math::Vec3;
use fractum_scene::ProbedScene;

use crate::build;
use crate::selection::{refused, refused_on};
use crate::sides::{AROUND, Listed, RADIUS, THICKNESS, ring};

const CASE: &str = r#"fractum = 1
[mesh]
file = "mesh.msh"
[materials.steel]
density = 7800
young_modulus = 210e9
poisson_ratio = 0.3
[[bodies]]
name = "body"
kind = "solid"
group = "body"
material = "steel"
formulation = "FORMULATION"
thickness = "0.3 m"
initial_velocity = { x = "if(hypot(x, y) < 1.5 m, -(0.02 1/s)*y, 0 m/s)", y = "if(hypot(x, y) < 1.5 m, (0.02 1/s)*x, 0 m/s)" }
[[supports]]
group = "outer"
fix = "xy"
[[loads]]
group = "outer"
pressure = "2 MPa"
[solver]
end = "1 ms"
step = "1e-12 s"
[[probes]]
name = "held"
reaction = { group = "outer", along = "radial" }
[[probes]]
name = "torque"
reaction = { group = "outer", along = "tangential" }
[[probes]]
name = "turning"
velocity = { group = "inner", along = "tangential" }
[[probes]]
name = "turning_back"
velocity = { group = "inner", along = "tangential", about = { axis = "-z" } }
[[probes]]
name = "widening"
velocity = { group = "inner", along = "radial" }
[[probes]]
name = "wider"
displacement = { group = "inner", along = "radial" }
[[probes]]
name = "radial"
stress = { group = "body", component = "radial" }
[[probes]]
name = "hoop"
stress = { group = "body", component = "tangential" }
[[probes]]
name = "between"
stress = { group = "body", component = "radial_tangential" }
[[probes]]
name = "xx"
stress = { group = "body", component = "xx" }
"#;

#[test]
fn a_ring_that_turns_and_widens_has_its_components_about_the_axis() {
    for formulation in ["standard", "smoothed"] {
        let mesh = ring(Listed::Along, Listed::Along);
        let built = build(&CASE.replace("FORMULATION", formulation), &mesh);
        let mut scene = built.scene;
        let values = |scene: &fractum_scene::Scene| -> Vec<f64> {
            built.probes.iter().flatten().map(|probe| probe.value(&ProbedScene::new(scene))).collect()
        };
        scene.step(true).unwrap();
        let now = values(&scene);
        // Each side gives half of its force to either node, half of its angle away from the side's normal.
        let angle = TAU / f64::from(AROUND);
        let side = 2.0 * RADIUS[1] * (0.5 * angle).sin();
        let held = 2e6 * THICKNESS * side * f64::from(AROUND / 2) * (0.5 * angle).cos();
        assert!((now[0] / held - 1.0).abs() < 1e-6, "{formulation}: {} for {held}", now[0]);
        assert!(now[1].abs() < 1e-6 * held, "{formulation}: {}", now[1]);
        assert!((now[2] - 0.02 * RADIUS[0]).abs() < 1e-8 && (now[3] + now[2]).abs() < 1e-12, "{formulation}: {now:?}");
        assert!(now[4].abs() < 1e-8, "{formulation}: {}", now[4]);
        // A uniform strain: its mean components about the axis are those of the mean circle.
        let (xx, yy) = (1e-3, 4e-4);
        for n in 0..scene.solid.reference.len() {
            let p = scene.solid.reference[n];
            scene.solid.displacement[n] = Vec3::new(xx * p.x, yy * p.y, 0.0);
            scene.solid.velocity[n] = Vec3::zeros();
        }
        let now = values(&scene);
        let (mu, lambda) = (210e9 / 2.6, 210e9 * 0.3 / (1.3 * 0.4));
        let (sxx, syy) = (lambda * (xx + yy) + 2.0 * mu * xx, lambda * (xx + yy) + 2.0 * mu * yy);
        let mean = 0.5 * (sxx + syy);
        assert!((now[6] / mean - 1.0).abs() < 1e-9 && (now[7] / mean - 1.0).abs() < 1e-9, "{formulation}: {now:?}");
        assert!(now[8].abs() < 1e-9 * mean && (now[9] / sxx - 1.0).abs() < 1e-9, "{formulation}: {now:?}");
        // Nodes of the half circle, its ends included: the mean of xx cos^2 + yy sin^2.
        let half = AROUND / 2;
        let own = |k: u32| {
            let at = f64::from(k) * angle;
            RADIUS[0] * (xx * at.sin().powi(2) + yy * at.cos().powi(2))
        };
        let wider = (0..=half).map(own).sum::<f64>() / f64::from(half + 1);
        assert!((now[5] / wider - 1.0).abs() < 1e-9, "{formulation}: {} for {wider}", now[5]);
    }
}

#[test]
fn moments_of_what_nothing_holds_or_turns_are_refused_with_their_place() {
    let held = "[[supports]]\ngroup = \"x-\"\nfix = \"xyz\"\n[[probes]]\nname = \"m\"\n";
    for (probe, said) in [
        ("moment = { group = \"x+\" }", "probes[0].moment.group = \"x+\": nothing holds it"),
        ("moment = { group = \"body.x+\" }", "expected a group that touches a solid body"),
    ] {
        let found = refused(&format!("{held}{probe}\n"));
        assert!(found.contains(said), "{probe}: {found}");
    }
    let case = CASE.replace("FORMULATION", "standard");
    for probe in
        ["moment = { group = \"outer\", about = { axis = \"x\" } }", "rotation = { group = \"outer\", along = \"y\" }"]
    {
        let said =
            refused_on(&format!("{case}[[probes]]\nname = \"m\"\n{probe}\n"), &ring(Listed::Along, Listed::Along));
        assert!(said.contains("plane bodies turn about z alone"), "{probe}: {said}");
    }
}
