//! Plane bodies: patch test of both plane states, the two-triangle tension test, discs as discrete elements.

use fractum_fem::{Body, DamageLaw, Elastic, ElementKind, Formulation, Plane, Solid, fields};
use fractum_math::Vec3;
use fractum_mesh::generate::{Jitter, structured_rectangle};
use fractum_scene::ContactParameters;
use fractum_scene::coupling::Debris;
use fractum_tests::CONCRETE;

const FORMULATIONS: [Formulation; 2] = [Formulation::Standard, Formulation::Smoothed];

#[test]
fn constant_plane_strain_gives_constant_stress_and_no_inner_force() {
    let (xx, yy, shear, thickness) = (3e-4, -1e-4, 2e-4, 0.07);
    for formulation in FORMULATIONS {
        for plane in [Plane::Strain, Plane::Stress] {
            let mesh = structured_rectangle([5, 4], [1.0, 0.8], Some(Jitter { fraction: 0.15, seed: 5 }));
            let elements = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
            let body = Body::new("sheet", ElementKind::T3, elements, CONCRETE);
            let mut solid = Solid::new(mesh.nodes, vec![Body { formulation, plane, thickness, ..body }]).unwrap();
            for i in 0..solid.reference.len() {
                let p = solid.reference[i];
                solid.displacement[i] = Vec3::new(xx * p.x + shear * p.y, yy * p.y, 0.0);
            }
            solid.update_internal_forces(0.0, true);
            let (lambda, mu) = (CONCRETE.lame_lambda(), CONCRETE.shear_modulus());
            let zz = if plane == Plane::Stress { -lambda / (lambda + 2.0 * mu) * (xx + yy) } else { 0.0 };
            let pressure = lambda * (xx + yy + zz);
            let expected = [pressure + 2.0 * mu * xx, pressure + 2.0 * mu * yy, pressure + 2.0 * mu * zz, mu * shear];
            for (stress, _) in fields::element_fields(&solid, 0, None) {
                for (found, wanted) in stress.0.iter().zip(expected) {
                    assert!((found - wanted).abs() < 1e-12 * expected[0], "{formulation:?} {plane:?}: {stress:?}");
                }
            }
            let inside = |p: &Vec3| p.x > 1e-9 && p.x < 1.0 - 1e-9 && p.y > 1e-9 && p.y < 0.8 - 1e-9;
            for i in (0..solid.reference.len()).filter(|&i| inside(&solid.reference[i])) {
                assert!(solid.force[i].norm() < 1e-12 * expected[0], "{formulation:?} {plane:?}");
            }
            let density = 0.5 * (expected[0] * xx + expected[1] * yy + expected[3] * shear);
            assert!((solid.elastic_energy() / (density * 0.8 * thickness) - 1.0).abs() < 1e-12);
        }
    }
}

/// Two triangles under uniaxial stress with Rankine damage: a regression test of another code and a closed form at once.
///
/// Its characteristic length is 2.317690 m; only G_f/l enters the law, so that G_f takes the ratio of our length to it.
#[test]
fn two_triangles_in_tension_follow_the_softening_curve() {
    const NODES: [[f64; 2]; 4] =
        [[-2.43214, -0.656895], [-4.38654, -0.656895], [-2.43214, 1.46037], [-4.38654, 1.46037]];
    let steel = Elastic { density: 2400.0, young_modulus: 35e9, poisson_ratio: 0.2 };
    let area: f64 = 0.5 * (4.38654 - 2.43214) * (1.46037 + 0.656895);
    let side = (4.0 * area / 3f64.sqrt()).sqrt();
    for (formulation, factor) in [(Formulation::Standard, 1.28), (Formulation::Smoothed, 1.124)] {
        let law = DamageLaw::rankine(1.5e6, 400.0 * factor * side / 2.317690);
        let nodes: Vec<Vec3> = NODES.iter().map(|p| Vec3::new(p[0], p[1], 0.0)).collect();
        let elements = vec![[3, 1, 2, 2], [1, 0, 2, 2]];
        let body = Body::new("pair", ElementKind::T3, elements, steel).with_damage(law);
        let mut solid = Solid::new(nodes, vec![Body { formulation, plane: Plane::Stress, ..body }]).unwrap();
        let mut stretch = |u: f64| {
            let strain = u / (4.38654 - 2.43214);
            for i in 0..4 {
                let from = solid.reference[i] - solid.reference[3];
                solid.displacement[i] = Vec3::new(strain * from.x, -0.2 * strain * from.y, 0.0);
            }
            solid.update_internal_forces(0.05, true);
            let (stress, damage) = fields::element_fields(&solid, 0, None)[0];
            (stress.0[0], damage)
        };
        for step in 1..80 {
            let time = 0.05 * f64::from(step);
            let (stress, damage) = stretch(7e-5 * time.min(4.0 - time));
            let expected = match step {
                26 => (1_441_810.0, 0.1152671),
                36 => (1_190_805.0, 0.4722653),
                41.. => (stress, 0.56002),
                _ => continue,
            };
            assert!((damage - expected.1).abs() < 2e-5, "{formulation:?}, step {step}: {damage}");
            assert!((stress / expected.0 - 1.0).abs() < 3e-5, "{formulation:?}, step {step}: {stress}");
        }
    }
}

#[test]
fn particles_of_a_plane_body_are_discs_of_its_thickness() {
    let mesh = structured_rectangle([2, 2], [1.0, 1.0], None);
    let elements = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
    let body = Body::new("sheet", ElementKind::T3, elements, CONCRETE);
    let solid = Solid::new(mesh.nodes, vec![Body { thickness: 0.07, ..body }]).unwrap();
    let mut debris = Debris::new(&solid, vec![ContactParameters::default()]);
    debris.prepare(&solid);
    assert!((0..solid.reference.len() as u32).all(|node| debris.thickness(node) == 0.07));
    let mass: f64 = solid.mass.iter().sum();
    assert!((mass - 0.07 * CONCRETE.density).abs() < 1e-9);
}
