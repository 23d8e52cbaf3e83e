//! Elements that make cracks run late are told of bodies with notches, and of no others.

use fractum_mesh::generate::structured_rectangle;
use fractum_mesh::{Group, Mesh};
use fractum_output::warning::Code;

/// A plate of 0.8 m.
const PLATE: &str = r#"fractum = 1
mesh = { file = "plate.msh" }
[materials.concrete]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0.2
damage = { tensile_strength = "3 MPa", fracture_energy = "100 J/m^2" }
[[bodies]]
name = "plate"
kind = "solid"
group = "plate"
material = "concrete"
plane = "stress"
thickness = "0.1 m"
[[supports]]
group = "plate"
fix = "xyz"
[solver]
kind = "explicit"
end = "1 ms"
"#;

/// The plate on squares of 0.1 m, without its upper right quarter where it is an angle.
fn plate(is_angle: bool) -> Mesh {
    let mut mesh = structured_rectangle([8, 8], [0.8, 0.8], None);
    let is_there = |t: &[u32; 3]| {
        let [x, y] = [0, 1].map(|axis| t.iter().map(|&n| mesh.nodes[n as usize][axis]).sum::<f64>() / 3.0);
        !is_angle || x < 0.4 || y < 0.4
    };
    let triangles: Vec<[u32; 3]> = mesh.triangles.iter().filter(|t| is_there(t)).copied().collect();
    let group = Group {
        name: "plate".into(),
        dimension: 2,
        tag: 1,
        triangles: (0..triangles.len() as u32).collect(),
        ..Group::default()
    };
    mesh = Mesh { nodes: mesh.nodes, triangles, groups: vec![group], ..Mesh::default() };
    mesh.number();
    mesh
}

/// What is told of coarse elements.
fn told(case: &str, is_angle: bool) -> Option<String> {
    let built = super::build(case, &plate(is_angle));
    built.warnings.iter().find(|warning| warning.code == Some(Code::CoarseMesh)).map(ToString::to_string)
}

#[test]
fn coarse_elements_are_told_where_cracks_run_from_a_notch() {
    let says = |case: &str, words: [&str; 3]| {
        let text = told(case, true).expect("a warning");
        assert!(words.iter().all(|part| text.contains(part)), "{text}");
    };
    // Squares of 0.1 m have triangles of equilateral size 0.107 m.
    let of_both = "the process zone E Gf/ft^2 of 333.3 mm and the smallest extent of the body of ";
    says(PLATE, [of_both, "too high, ", "2 % want elements of "]);
    assert_eq!(told(PLATE, false), None, "without a notch");
    let standard = PLATE.replace("thickness", "formulation = \"standard\"\nthickness");
    says(&standard, [of_both, "are off by ", "2 % want elements of "]);
    // A body smaller than its process zone.
    let tough = PLATE.replace("100 J/m^2", "1000 J/m^2");
    says(&tough, ["process zone E Gf/ft^2 of 3.333 m", "too high", "2 % want elements of "]);
    let elsewhere = PLATE.replace("thickness", "damage_where = \"x < 0.2\"\nthickness");
    assert_eq!(told(&elsewhere, true), None, "no damage at the notch");
    let long = PLATE.replace("100 J/m^2", "1000 kJ/m^2");
    says(&long, ["of the 848.3 mm that the process zone", "too high", "2 % want elements of "]);
}
