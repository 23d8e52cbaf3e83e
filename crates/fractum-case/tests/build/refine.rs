//! Refined zones of a case in meshes made here, and what is said of them.

use std::path::Path;

use fractum_case::build::{cut_mesh, cut_network, refine_mesh};
use fractum_case::{Case, parse_case};
use fractum_mesh::generate::{Jitter, structured_rectangle};
use fractum_mesh::{Group, Mesh};

/// A case with this in it.
fn case(mesh: &str) -> Case {
    let text = format!(
        r#"fractum = 1
[mesh]
file = "body.msh"
{mesh}
[materials.rock]
density = 2600
young_modulus = 50e9
poisson_ratio = 0.2
[[bodies]]
name = "body"
kind = "solid"
group = "body"
material = "rock"
plane = "strain"
thickness = "1 m"
[[interfaces]]
name = "joint"
group = "joints"
tensile_strength = "1 MPa"
fracture_energy = "100 J/m^2"
[solver]
end = 1e-3
"#
    );
    parse_case(&text, Path::new("case.toml"), &[]).unwrap_or_else(|errors| panic!("{errors}"))
}

/// A plate of 2 x 1 m with elements of 10 cm.
fn plate() -> Mesh {
    structured_rectangle([20, 10], [2.0, 1.0], Some(Jitter { fraction: 0.15, seed: 1 }))
}

fn refined(mesh: &str) -> (Mesh, Vec<String>) {
    let mut made = plate();
    let warnings = refine_mesh(&case(mesh).mesh.unwrap().refine, &mut made).unwrap_or_else(|errors| panic!("{errors}"));
    (made, warnings.iter().map(ToString::to_string).collect())
}

#[test]
fn the_smallest_size_holds_and_nothing_is_said_twice() {
    let wide = "[[mesh.refine]]\nwhere = \"x < 1\"\nsize = \"7 cm\"\nrows = \"keep\"\n";
    let narrow = "[[mesh.refine]]\nwhere = \"abs(y - 50 cm) < 10 cm\"\nsize = \"3 cm\"\nseed = 5\n";
    let (one, _) = refined(&format!("{wide}{narrow}"));
    let (other, warnings) = refined(&format!("{narrow}{wide}"));
    assert_eq!(one, other);
    assert!(warnings.is_empty() && one.notices.len() == 1, "{warnings:?} {:?}", one.notices);
    assert!(one.notices[0].starts_with("refined: ") && one.notices[0].contains("(before 172."), "{:?}", one.notices);
    let (kept, _) = refined(wide);
    assert!(kept.notices[0].ends_with("rows kept") && one.triangles.len() > 2 * kept.triangles.len());
    // A zone that asks for nothing is told of, and does nothing.
    let (same, warnings) = refined("[[mesh.refine]]\nsize = \"1 m\"\nrows = \"keep\"");
    assert!(warnings.len() == 1 && warnings[0].contains("nothing to refine") && warnings[0].ends_with("[no-effect]"));
    assert_eq!(same.triangles, plate().triangles);
    let (_, warnings) = refined(&format!("{narrow}[[mesh.refine]]\nsize = \"1 m\""));
    assert!(warnings.len() == 1 && warnings[0].starts_with("case.toml:8:1: "), "{warnings:?}");
}

#[test]
fn joints_and_interfaces_are_cut_into_refined_elements() {
    let mesh = "[[mesh.refine]]\nwhere = \"abs(y - 0.5) < 0.2\"\nsize = \"4 cm\"\n[[mesh.joints]]\ntable = [[0.2, 0.5, 1.8, 0.5]]";
    let case = case(mesh);
    let faces = |is_fine: bool| {
        let mut made = plate();
        let source = case.mesh.as_ref().unwrap();
        if is_fine {
            refine_mesh(&source.refine, &mut made).unwrap();
        }
        cut_network(&source.network, &mut made).unwrap();
        cut_mesh(&case, &mut made).unwrap();
        made.cuts.len()
    };
    assert!(faces(true) > 2 * faces(false), "{} {}", faces(true), faces(false));
    // A line of the mesh that an interface opens is one of refined edges.
    let mut made = plate();
    let row: Vec<u32> = (0..21).map(|i| 21 * 5 + i).collect();
    let first = made.lines.len() as u32;
    made.lines.extend(row.windows(2).map(|pair| [pair[0], pair[1]]));
    let lines = (first..made.lines.len() as u32).collect();
    made.groups.push(Group { name: "joints".into(), dimension: 1, tag: 9, lines, ..Group::default() });
    made.number();
    refine_mesh(&case.mesh.as_ref().unwrap().refine, &mut made).unwrap();
    let lines = made.group("joints")[0].lines.len();
    cut_mesh(&case, &mut made).unwrap();
    assert!(lines >= 40 && made.cuts.len() == lines, "{lines} {}", made.cuts.len());
}

#[test]
fn seeds_of_zones_are_neighbours() {
    let mesh = "[[mesh.refine]]\nsize = \"4 cm\"\nseed = 5\n[[mesh.refine]]\nsize = \"5 cm\"\nrows = \"keep\"";
    let neighbours = case(mesh).source.verify.neighbours;
    let seed = neighbours.iter().find(|neighbour| neighbour.name() == "seed +1").expect("one of seeds");
    assert_eq!(seed.set, [("mesh.refine[0].seed".to_owned(), "6".to_owned())]);
}
