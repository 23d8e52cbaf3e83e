//! Loads on sides, whatever the direction in which a mesh generator lists their nodes: resultant and direction against
//! closed forms.

use std::f64::consts::TAU;

use fractum_math::Vec3;
use fractum_mesh::generate::{plane_mesh, structured_box};
use fractum_mesh::topology::boundary_of_tetrahedra;
use fractum_mesh::{Group, Mesh};

use crate::build;

pub(crate) const AROUND: u32 = 32;
pub(crate) const RADIUS: [f64; 2] = [1.0, 2.0];
pub(crate) const THICKNESS: f64 = 0.3;
const PRESSURE: f64 = 2e6;

/// How the sides of a group are listed: as the first number says, as it says not, or in turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Listed {
    Along,
    Against,
    InTurn,
}

impl Listed {
    const ALL: [Listed; 3] = [Listed::Along, Listed::Against, Listed::InTurn];

    fn turned(self, index: usize) -> bool {
        match self {
            Listed::Along => false,
            Listed::Against => true,
            Listed::InTurn => index % 2 == 1,
        }
    }
}

/// A ring about the origin with groups `body` and, of the half with x > 0, `inner` and `outer`.
pub(crate) fn ring(lines_listed: Listed, triangles_listed: Listed) -> Mesh {
    let node = |ring: u32, place: u32| ring * AROUND + place % AROUND;
    let nodes: Vec<Vec3> = RADIUS
        .iter()
        .flat_map(|r| {
            (0..AROUND).map(move |k| (r, TAU * (f64::from(k) - 0.25 * f64::from(AROUND)) / f64::from(AROUND)))
        })
        .map(|(r, angle)| Vec3::new(r * angle.cos(), r * angle.sin(), 0.0))
        .collect();
    let mut triangles = Vec::new();
    for k in 0..AROUND {
        let [a, b, c, d] = [node(0, k), node(1, k), node(1, k + 1), node(0, k + 1)];
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    for (index, triangle) in triangles.iter_mut().enumerate() {
        if triangles_listed.turned(index) {
            triangle.swap(1, 2);
        }
    }
    let half = AROUND / 2;
    let mut lines: Vec<[u32; 2]> =
        (0..2).flat_map(|ring| (0..half).map(move |k| [node(ring, k), node(ring, k + 1)])).collect();
    for (index, line) in lines.iter_mut().enumerate() {
        if lines_listed.turned(index) {
            line.swap(0, 1);
        }
    }
    let side = |name: &str, tag, lines| Group { name: name.into(), dimension: 1, tag, lines, ..Group::default() };
    let sides = vec![side("inner", 1, (0..half).collect()), side("outer", 2, (half..2 * half).collect())];
    plane_mesh(nodes, lines, triangles, sides)
}

/// A cube of side 3 with a cubic hole of side 1 in its middle; groups `body`, `inner` and `outer`, the sides at the
/// higher x of hole and cube.
fn hollow_cube(listed: Listed) -> Mesh {
    let mut mesh = structured_box([6; 3], Vec3::repeat(3.0), None);
    let inside = |p: &Vec3| p.iter().all(|x| (0.9..2.1).contains(x));
    mesh.tetrahedra.retain(|t| !t.iter().all(|&n| inside(&mesh.nodes[n as usize])));
    mesh.triangles = boundary_of_tetrahedra(&mesh.tetrahedra).into_iter().map(|facet| facet.nodes).collect();
    let used = |n: &u32| mesh.tetrahedra.iter().any(|t| t.contains(n));
    let kept: Vec<u32> = (0..mesh.nodes.len() as u32).filter(used).collect();
    let number = |n: u32| kept.binary_search(&n).unwrap() as u32;
    mesh.nodes = kept.iter().map(|&n| mesh.nodes[n as usize]).collect();
    mesh.tetrahedra.iter_mut().for_each(|t| *t = t.map(number));
    mesh.triangles.iter_mut().for_each(|t| *t = t.map(number));
    for (index, triangle) in mesh.triangles.iter_mut().enumerate() {
        triangle.rotate_left(index % 3);
        if listed.turned(index) {
            triangle.swap(1, 2);
        }
    }
    let at = |x: f64| -> Vec<u32> {
        let flat = |t: &[u32; 3]| t.iter().all(|&n| (mesh.nodes[n as usize].x - x).abs() < 1e-9);
        (0..).zip(&mesh.triangles).filter(|(_, t)| flat(t)).map(|(index, _)| index).collect()
    };
    let side =
        |name: &str, tag, triangles| Group { name: name.into(), dimension: 2, tag, triangles, ..Group::default() };
    let tetrahedra = (0..mesh.tetrahedra.len() as u32).collect();
    mesh.groups = vec![
        side("inner", 1, at(2.0)),
        side("outer", 2, at(3.0)),
        Group { name: "body".into(), dimension: 3, tag: 1, tetrahedra, ..Group::default() },
    ];
    mesh.node_tags = (1..=mesh.nodes.len() as u64).collect();
    mesh.triangle_tags = (1..=mesh.triangles.len() as u64).collect();
    mesh.tetrahedron_tags = (10_001..=10_000 + mesh.tetrahedra.len() as u64).collect();
    mesh
}

/// Nodal forces of a load on a body at rest, with the positions of the nodes: what half a step, too short for elastic
/// forces, gives of momentum.
fn nodal_forces(mesh: &Mesh, load: &str) -> Vec<(Vec3, Vec3)> {
    const STEP: f64 = 1e-12;
    let flat = if mesh.tetrahedra.is_empty() { format!("thickness = \"{THICKNESS} m\"") } else { String::new() };
    let case = format!(
        r#"fractum = 1
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
{flat}
[[loads]]
{load}
[solver]
end = "1 ms"
step = "{STEP} s"
"#
    );
    let mut scene = build(&case, mesh).scene;
    scene.step(true).unwrap();
    let solid = &scene.solid;
    (0..solid.mass.len()).map(|n| (solid.reference[n], solid.velocity[n] * (2.0 * solid.mass[n] / STEP))).collect()
}

fn check(forces: &[(Vec3, Vec3)], expected: Vec3, what: &str) {
    let sum: Vec3 = forces.iter().map(|(_, force)| force).sum();
    assert!((sum - expected).norm() < 1e-6 * expected.norm(), "{what}: {sum:?} for {expected:?}");
}

#[test]
fn pressure_in_a_hole_and_around_a_disc_pushes_into_the_solid_whatever_the_direction_of_the_lines() {
    for lines in Listed::ALL {
        for triangles in Listed::ALL {
            let mesh = ring(lines, triangles);
            // On half a ring the resultant is that of its chord; it pushes outwards from a hole.
            for (group, radius, sign) in [("inner", RADIUS[0], 1.0), ("outer", RADIUS[1], -1.0)] {
                let what = format!("{group}, lines {lines:?}, triangles {triangles:?}");
                let forces = nodal_forces(&mesh, &format!("group = \"{group}\"\npressure = {PRESSURE}"));
                check(&forces, Vec3::x() * (sign * PRESSURE * 2.0 * radius * THICKNESS), &what);
                for (position, force) in forces.iter().filter(|(_, force)| force.norm() > 1.0) {
                    assert!((position.norm() - radius).abs() < 1e-9, "{what}");
                    assert!(sign * position.dot(force) > 0.9 * force.norm() * radius, "{what}: {force:?}");
                }
            }
        }
    }
}

#[test]
fn traction_and_force_on_lines_of_any_direction_have_their_resultant() {
    let mesh_side = 2.0 * (0.5 * TAU / f64::from(AROUND)).sin();
    for lines in Listed::ALL {
        let mesh = ring(lines, Listed::Along);
        for (group, radius) in [("inner", RADIUS[0]), ("outer", RADIUS[1])] {
            let area = mesh_side * radius * f64::from(AROUND / 2) * THICKNESS;
            let forces = nodal_forces(&mesh, &format!("group = \"{group}\"\ntraction = {{ x = 3e6, y = -1e6 }}"));
            check(&forces, Vec3::new(3e6, -1e6, 0.0) * area, &format!("traction, {group}, {lines:?}"));
            let forces = nodal_forces(&mesh, &format!("group = \"{group}\"\nforce = {{ y = 5e3 }}"));
            check(&forces, Vec3::y() * 5e3, &format!("force, {group}, {lines:?}"));
            // By length: the ends of the arc bear half of what a node between bears.
            let bearing: Vec<f64> = forces.iter().map(|(_, f)| f.y).filter(|f| *f > 1.0).collect();
            let (least, most) = bearing.iter().fold((f64::MAX, 0f64), |(low, high), f| (low.min(*f), high.max(*f)));
            assert!((most / least - 2.0).abs() < 1e-6, "{group}, {lines:?}: {least} to {most}");
        }
    }
}

#[test]
fn pressure_and_traction_on_facets_of_any_direction_have_their_resultant() {
    for listed in Listed::ALL {
        let mesh = hollow_cube(listed);
        for (group, side, sign) in [("inner", 1.0, 1.0), ("outer", 3.0, -1.0)] {
            let what = format!("{group}, {listed:?}");
            let forces = nodal_forces(&mesh, &format!("group = \"{group}\"\npressure = {PRESSURE}"));
            check(&forces, Vec3::x() * (sign * PRESSURE * side * side), &what);
            assert!(forces.iter().all(|(_, force)| sign * force.x > -1.0), "{what}");
            let forces = nodal_forces(&mesh, &format!("group = \"{group}\"\ntraction = {{ y = 1e6, z = 2e6 }}"));
            check(&forces, Vec3::new(0.0, 1e6, 2e6) * (side * side), &what);
        }
    }
}
