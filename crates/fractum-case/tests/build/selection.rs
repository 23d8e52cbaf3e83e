//! Nodes, facets and particles chosen by a condition: as by a group of the same ones, in supports, loads and probes.

use std::path::Path;

use fractum_case::build::build_scene;
use fractum_case::parse_case;
use fractum_dem::{BeamSection, Clumps, Particles};
use fractum_math::Vec3;
use fractum_mesh::Mesh;
use fractum_mesh::generate::structured_box;
use fractum_prepare::PreparedBody;
use fractum_scene::ProbedScene;

use crate::build;

const SOLID: &str = r#"fractum = 1
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
[solver]
end = "1 ms"
"#;

/// Histories of the probes over some steps of a box of 0.4 m by 0.1 m by 0.1 m.
fn histories(conditions: &str) -> Vec<f64> {
    let mesh = structured_box([8, 2, 2], Vec3::new(0.4, 0.1, 0.1), None);
    let built = build(&format!("{SOLID}{conditions}"), &mesh);
    let mut scene = built.scene;
    let mut values = Vec::new();
    for _ in 0..20 {
        scene.step(true).unwrap();
        values.extend(built.probes.iter().flatten().map(|probe| probe.value(&ProbedScene::new(&scene))));
    }
    values
}

fn conditions(low: &str, high: &str) -> String {
    format!(
        r#"
[[supports]]
{low}
fix = "xyz"
[[loads]]
{high}
pressure = "1 MPa"
[[loads]]
{high}
force = {{ z = "3 kN" }}
[[loads]]
{high}
traction = {{ y = "0.1 MPa" }}
[[probes]]
name = "held"
reaction = {{ {}, along = "x" }}
[[probes]]
name = "shift"
displacement = {{ {}, along = "z" }}
[[probes]]
name = "speed"
velocity = {{ {}, along = "y" }}
"#,
        low.replace('\n', ", "),
        high.replace('\n', ", "),
        high.replace('\n', ", ")
    )
}

#[test]
fn a_condition_means_the_nodes_and_facets_where_it_holds() {
    let by_group = histories(&conditions("group = \"x-\"", "group = \"x+\""));
    assert!(by_group.iter().all(|v| v.is_finite()) && by_group[by_group.len() - 3..].iter().all(|v| *v != 0.0));
    let low = "where = \"x < 1 mm\"";
    assert_eq!(histories(&conditions(low, "where = \"x > 399 mm\"")), by_group);
    // Both: of the group those that fulfil it. On this side all do.
    assert_eq!(histories(&conditions(low, "group = \"x+\"\nwhere = \"z < 1 m\"")), by_group);
    assert_ne!(histories(&conditions(low, "group = \"x+\"\nwhere = \"z < 51 mm\"")), by_group);
    assert_ne!(histories(&conditions("group = \"x-\"\nwhere = \"z < 51 mm\"", "where = \"x > 399 mm\"")), by_group);
}

#[test]
fn facets_count_where_all_of_their_nodes_fulfil_the_condition() {
    let mesh = structured_box([8, 2, 2], Vec3::new(0.4, 0.1, 0.1), None);
    for (condition, area) in
        [("where = \"x > 399 mm\"", 0.01), ("group = \"x+\"\nwhere = \"z < 51 mm\"", 0.005), ("group = \"x+\"", 0.01)]
    {
        let case = format!("{SOLID}step = \"1e-12 s\"\n[[loads]]\n{condition}\npressure = \"1 MPa\"\n");
        let mut scene = build(&case, &mesh).scene;
        scene.step(true).unwrap();
        let solid = &scene.solid;
        let force: Vec3 = (0..solid.mass.len()).map(|n| solid.velocity[n] * (2.0 * solid.mass[n] / 1e-12)).sum();
        assert!((force - Vec3::x() * (-1e6 * area)).norm() < 1e-3 * area * 1e6, "{condition}: {force:?}");
    }
}

/// What is said of a case that is wrong on its mesh.
pub(crate) fn refused(conditions: &str) -> String {
    let mesh = structured_box([2, 2, 2], Vec3::repeat(0.1), None);
    refused_on(&format!("{SOLID}{conditions}"), &mesh)
}

/// The same of a whole case.
pub(crate) fn refused_on(case: &str, mesh: &Mesh) -> String {
    let read = parse_case(case, Path::new("case.toml"), &[]).unwrap();
    match build_scene(&read, mesh, Vec::new(), Vec::new()) {
        Err(errors) => errors.to_string(),
        Ok(_) => panic!("{case} should be refused"),
    }
}

#[test]
fn a_condition_that_holds_nowhere_is_refused_with_its_place() {
    for (conditions, place, found) in [
        ("[[supports]]\nwhere = \"x > 1 m\"\nfix = \"x\"\n", "supports[0].where", "for none of 27 nodes"),
        (
            "[[supports]]\ngroup = \"x+\"\nwhere = \"x < 0 m\"\nfix = \"x\"\n",
            "supports[0].where",
            "for none of 9 nodes",
        ),
        ("[[loads]]\nwhere = \"x > 1 m\"\npressure = 1\n", "loads[0].where", "for no facet"),
        ("[[loads]]\nwhere = \"x > 1 m\"\nforce = { x = 1 }\n", "loads[0].where", "for none of 27 nodes"),
    ] {
        let said = refused(conditions);
        assert!(said.contains(place) && said.contains(found) && said.lines().count() == 1, "{conditions}: {said}");
    }
}

#[test]
fn particles_of_a_group_are_chosen_by_their_centres() {
    let case = r#"fractum = 1
[materials.glass]
density = 2500
young_modulus = 70e9
poisson_ratio = 0.2
[[bodies]]
name = "row"
kind = "particles"
material = "glass"
shape = "box"
size = [1, 1, 1]
particle_radius = "1 mm"
[[loads]]
group = "row"
where = "x > 2.5 mm"
force = { y = "1 N" }
[[supports]]
group = "row"
where = "x < 1 mm"
velocity = { z = "1 m/s" }
[[probes]]
name = "pushed"
velocity = { group = "row", where = "x > 2.5 mm", along = "y" }
[[probes]]
name = "between"
velocity = { group = "row", where = "abs(x - 2 mm) < 0.1 mm", along = "y" }
[[probes]]
name = "driven"
displacement = { group = "row", where = "x < 1 mm", along = "z" }
[solver]
end = "1 ms"
step = "0.1 us"
"#;
    let case = parse_case(case, Path::new("case.toml"), &[]).unwrap_or_else(|errors| panic!("{errors}"));
    let position: Vec<Vec3> = (0..4).map(|i| Vec3::new(2e-3 * f64::from(i), 0.0, 0.0)).collect();
    let made = PreparedBody {
        particles: Particles::at_rest(position, vec![0.9e-3; 4], 4e-3).unwrap(),
        pairs: Vec::new(),
        law: BeamSection::new(70e9, 1.0).unwrap().into(),
        shares: Vec::new(),
        walls: Vec::new(),
        domain: None,
        shift_to_walls: Vec::new(),
        out_of_flat_walls: Vec::new(),
        fraction: 0.6,
        fracture: None,
        arrivals: None,
        clumps: Clumps::default(),
        replaced: Vec::new(),
    };
    let built =
        build_scene(&case, &Mesh::default(), vec![made], Vec::new()).unwrap_or_else(|errors| panic!("{errors}"));
    let mut scene = built.scene;
    for _ in 0..1000 {
        scene.step(true).unwrap();
    }
    let time = scene.clock.time;
    let values: Vec<f64> = built.probes.iter().flatten().map(|probe| probe.value(&ProbedScene::new(&scene))).collect();
    // 1 N over two particles of 1 g, half a step ago.
    assert!((values[0] / (500.0 * (time - 0.05e-6)) - 1.0).abs() < 1e-9, "{values:?} at {time}");
    assert_eq!(values[1], 0.0);
    assert!((values[2] / time - 1.0).abs() < 0.02, "{values:?} at {time}");
}
