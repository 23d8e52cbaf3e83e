//! Heat on the parts of a body.

use fractum_math::Vec3;
use fractum_mesh::Group;
use fractum_mesh::generate::structured_box;
use fractum_scene::HeatMeasure;

use crate::build;

const HEATED: &str = r#"fractum = 1
[mesh]
file = "mesh.msh"
[materials.steel]
density = 7800
young_modulus = 210e9
poisson_ratio = 0.3
[materials.steel.thermal]
conductivity = "50 W/(m K)"
heat_capacity = "500 J/(kg K)"
[[bodies]]
name = "body"
kind = "solid"
group = "body"
material = "steel"
[heat]
initial_temperature = "300 K"
[solver]
kind = "heat"
end = "1 s"
"#;

/// Heat that a source of 1 MW/m³ has brought after a step, over the step [W], in a box of 0.4 m by 0.1 m by 0.1 m.
fn power(on: &str) -> f64 {
    let mut mesh = structured_box([8, 2, 2], Vec3::new(0.4, 0.1, 0.1), None);
    let middle = |nodes: &[u32; 4]| nodes.iter().map(|&n| mesh.nodes[n as usize].x).sum::<f64>() / 4.0;
    let left = (0..).zip(&mesh.tetrahedra).filter(|(_, nodes)| middle(nodes) < 0.1).map(|(element, _)| element);
    let tetrahedra: Vec<u32> = left.collect();
    mesh.groups.push(Group { name: "left".into(), dimension: 3, tag: 2, tetrahedra, ..Group::default() });
    let case = format!("{HEATED}[[heat.conditions]]\n{on}\nsource = \"1 MW/m^3\"\n");
    let mut scene = build(&case, &mesh).scene;
    scene.conduct_alone().unwrap();
    let heat = scene.heat().unwrap();
    heat.measure(HeatMeasure::Supplied) / scene.clock.time
}

#[test]
fn a_source_heats_the_volume_of_its_elements_and_no_other() {
    for (on, volume) in [
        ("group = \"body\"", 0.4 * 0.1 * 0.1),
        ("group = \"left\"", 0.1 * 0.1 * 0.1),
        ("where = \"x < 100 mm\"", 0.1 * 0.1 * 0.1),
        ("group = \"left\"\nwhere = \"x < 50 mm\"", 0.05 * 0.1 * 0.1),
    ] {
        assert!((power(on) / (1e6 * volume) - 1.0).abs() < 1e-12, "{on}: {} W", power(on));
    }
}
