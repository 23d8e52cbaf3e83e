//! Joints and grains of a case in meshes made here, and what is said of wrong ones.

use std::path::Path;

use fractum_case::build::{cut_mesh, cut_network};
use fractum_case::{Case, parse_case};
use fractum_mesh::generate::{Jitter, structured_box, structured_rectangle};
use fractum_mesh::{Mesh, Vec3};

/// A case with this in it.
fn case(network: &str) -> Case {
    let text = format!(
        r#"fractum = 1
[mesh]
file = "body.msh"
{network}
[materials.rock]
density = 2600
young_modulus = 50e9
poisson_ratio = 0.2
[[bodies]]
name = "body"
kind = "solid"
group = "body"
material = "rock"
[solver]
end = 1e-3
"#
    );
    parse_case(&text, Path::new("case.toml"), &[]).unwrap_or_else(|errors| panic!("{errors}"))
}

/// A plate of 2 x 1 m with elements of 5 cm.
fn plate() -> Mesh {
    structured_rectangle([40, 20], [2.0, 1.0], Some(Jitter { fraction: 0.15, seed: 1 }))
}

fn block() -> Mesh {
    structured_box([10, 10, 10], Vec3::new(1.0, 1.0, 1.0), None)
}

fn cut(network: &str, mesh: &mut Mesh) -> Vec<String> {
    let warnings = cut_network(&case(network).mesh.unwrap().network, mesh).unwrap_or_else(|errors| panic!("{errors}"));
    warnings.iter().map(ToString::to_string).collect()
}

fn wrong(network: &str, mut mesh: Mesh) -> String {
    cut_network(&case(network).mesh.unwrap().network, &mut mesh).expect_err(network).to_string()
}

#[test]
fn joints_of_tables_and_sets_become_groups_that_interfaces_open() {
    let network = r#"
[[mesh.joints]]
name = "steep"
angle = "70 deg"
spacing = 0.4
[[mesh.joints]]
name = "fault"
table = [[0.2, 0.3, "1.8 m", 0.4]]
[[interfaces]]
group = "steep"
bonded = false
"#;
    let mut mesh = plate();
    assert_eq!(cut(network, &mut mesh), Vec::<String>::new());
    let told = mesh.notices.join("\n");
    assert!(told.contains("mesh.joints[0] \"steep\": ") && told.contains("angle 70.0 deg, deviation 0.0"), "{told}");
    assert!(told.contains("\"fault\": 1 joints, 1.603 m"), "{told}");
    let before = mesh.nodes.len();
    cut_mesh(&case(network), &mut mesh).unwrap();
    assert!(mesh.nodes.len() > before + 60 && !mesh.cuts.is_empty());
    // The whole is as large as before.
    let area: f64 = mesh
        .triangles
        .iter()
        .map(|t| fractum_mesh::quality::area_vector(t.map(|node| mesh.nodes[node as usize])).z)
        .sum();
    assert!((area - 2.0).abs() < 1e-12);
}

#[test]
fn a_condition_bounds_joints() {
    let network = "[[mesh.joints]]\nangle = \"20 deg\"\nspacing = 0.3\nwhere = \"x < 1 m\"";
    let mut mesh = plate();
    cut(network, &mut mesh);
    let farthest = mesh.group_nodes("joints").iter().map(|&node| mesh.nodes[node as usize].x).fold(0.0, f64::max);
    assert!((0.9..1.03).contains(&farthest), "{farthest}");
}

#[test]
fn discs_and_grains_are_cut_in_space() {
    let network = r#"
[[mesh.joints]]
name = "beds"
dip = "20 deg"
dip_direction = "60 deg"
spacing = 0.35
persistence = 0.3
length = 0.4
[mesh.grains]
size = 0.45
share = 0.5
"#;
    let mut mesh = block();
    cut(network, &mut mesh);
    let told = mesh.notices.join("\n");
    assert!(told.contains("P32 ") && told.contains("dip 20.0 deg to 60.0, deviation 0.0"), "{told}");
    assert!(told.contains("boundaries follow the elements and are rough"), "{told}");
    let share = mesh.group("grains")[0].tetrahedra.len() as f64 / mesh.tetrahedra.len() as f64;
    assert!((0.3..0.7).contains(&share), "{share}");
    assert_eq!(mesh.group("body")[0].tetrahedra.len(), mesh.tetrahedra.len());
}

#[test]
fn what_does_not_fit_the_mesh_is_told_with_its_place() {
    let cases: &[(&str, bool, &str)] = &[
        (
            "[[mesh.joints]]\ntable = [[5, 5, 6, 6]]",
            true,
            "case.toml:5:10: mesh.joints[0].table[0] this joint is outside of the bodies",
        ),
        ("[[mesh.joints]]\ntable = [[0.5, 0.5, 0.51, 0.5]]", true, "this joint is 10 mm long, and an element there"),
        (
            "[[mesh.joints]]\ntable = [[0.2, 0.5, 1.8, 0.5], [0.2, 0.45, 1.8, 0.55]]",
            true,
            "this joint meets joint 1 at 4 deg, or lies upon it",
        ),
        ("[[mesh.joints]]\nangle = 0\nspacing = 0.3\nwithin = [\"bodi\"]", true, "did you mean \"body\"?"),
        ("[[mesh.joints]]\nname = \"x-\"\nangle = 0\nspacing = 0.3", true, "the mesh has a group \"x-\" already"),
        ("[[mesh.joints]]\ndip = 0\ndip_direction = 0\nspacing = 0.3", true, "expected joints of a plane mesh"),
        ("[[mesh.joints]]\nangle = 0\nspacing = 0.3", false, "expected joints of a mesh in space"),
        ("[[mesh.joints]]\nangle = 0\nspacing = 1e-7", true, "has more than a million joints"),
        (
            "[[mesh.joints]]\nangle = 0\nspacing = 0.01\npersistence = 0.5\nlength = 1e-6",
            true,
            "has more than a million joints",
        ),
        ("[[mesh.joints]]\nangle = 0\nspacing = 0.3\nwhere = \"x > 5 m\"", true, "holds in no element"),
        (
            "[[mesh.joints]]\nangle = 0\nspacing = 0.3\npersistence = 0.5\nlength = 0.01",
            true,
            "none of its joints is in the body",
        ),
        ("[mesh.grains]\nsize = 0.1", true, "grains of three elements at least"),
        ("[mesh.grains]\nsize = 20", true, "grains much smaller than the body"),
    ];
    for (network, is_plane, message) in cases {
        let told = wrong(network, if *is_plane { plate() } else { block() });
        assert!(told.contains(message), "{network}\n{told}");
    }
    // Sets that come too near to each other say how many they leave out.
    let crowded = "[[mesh.joints]]\nangle = 0\nspacing = 0.2\n[[mesh.joints]]\nangle = \"12 deg\"\nscatter = \"8 deg\"\nspacing = 0.2";
    let told = cut(crowded, &mut plate());
    assert!(told.len() == 1 && told[0].contains("[joints-left-out]"), "{told:?}");
    let short = "[[mesh.joints]]\nangle = 0\nspacing = 0.2\npersistence = 0.5\nlength = 0.04\nlength_scatter = 1";
    let told = cut(short, &mut plate());
    assert!(told.len() == 1 && told[0].contains("shorter than an element"), "{told:?}");
}

#[test]
fn the_density_of_joints_in_a_large_body_has_its_digits() {
    let mut mesh = structured_rectangle([40, 20], [2e5, 1e5], Some(Jitter { fraction: 0.15, seed: 1 }));
    cut("[[mesh.joints]]\nangle = \"70 deg\"\nspacing = \"40 km\"", &mut mesh);
    assert!(mesh.notices[0].contains("(asked 2.5e-5)"), "{:?}", mesh.notices);
}
