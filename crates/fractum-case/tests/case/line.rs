//! Cases whose crack runs along a line of the mesh.

use fractum_case::model::{BodyKind, CRACK_LINE, Control, InterfaceFaces};
use fractum_scene::InterfaceSoftening;

use crate::{SMALL, good};

fn cracked() -> String {
    let damage =
        "poisson_ratio = 0.3\ndamage = { tensile_strength = 3e6, fracture_energy = 100, softening = \"linear\" }";
    let text = SMALL.replace("poisson_ratio = 0.3", damage).replace("end = 1e-3", "kind = \"static\"\nend = 1");
    let probes = "[[probes]]\nname = \"pull\"\nreaction = { group = \"top\", along = \"y\" }\n[[probes]]\nname = \"crack\"\ncrack_area = true\n";
    text.replace("material = \"steel\"", "material = \"steel\"\ndamage_where = \"x > 0\"") + probes
}

#[test]
fn a_crack_runs_along_a_line_with_the_strength_of_its_material() {
    let mut case = good(&cracked(), &[]);
    assert!(case.run_along_line(0.3));
    let [interface] = &case.interfaces[..] else { panic!("{:?}", case.interfaces) };
    assert!(matches!(&interface.along, InterfaceFaces::Group(group) if group.value == CRACK_LINE));
    let law = interface.law;
    assert_eq!((law.tensile_strength, law.cohesion), (3e6, 3e6));
    assert_eq!((law.opening_energy, law.sliding_energy), (100.0, 100.0));
    assert_eq!(law.softening, InterfaceSoftening::Linear);
    assert!(case.materials.iter().all(|material| material.damage.is_none()));
    let BodyKind::Solid(solid) = &case.bodies[0].kind else { panic!() };
    assert!(!solid.damage && solid.damage_where.is_none() && solid.is_smoothed());
    assert_eq!(case.probes.len(), 1, "the load alone");
    let statics = case.solver.statics.unwrap();
    assert_eq!((statics.control, case.solver.step.unwrap().value), (Some(Control::Time), 0.3 / 60.0));
}

#[test]
fn where_it_would_be_another_crack_there_is_no_line() {
    let others = [
        ("solver.kind", "\"explicit\""),
        ("materials.steel.damage.regularisation", "\"phase-field\""),
        ("materials.steel.damage.softening", "\"bilinear\""),
        ("materials.steel.damage.scatter", "{ distribution = \"uniform-per-edge\", width = 0.1 }"),
        ("bodies[0].formulation", "\"standard\""),
        ("bodies[0].strength_factor", "\"1 + x/1 m\""),
        ("bodies[0].damage", "false"),
    ];
    for other in &others {
        let text = match other.0 {
            "bodies[0].damage" => cracked().replace("damage_where = \"x > 0\"\n", ""),
            _ => cracked(),
        };
        let mut case = good(&text, &[*other]);
        let before = case.clone();
        assert!(!case.run_along_line(0.3), "{other:?}");
        assert_eq!(case, before, "{other:?}");
    }
    let seam = "[[interfaces]]\ngroup = \"seam\"\ntensile_strength = 1e6\nfracture_energy = 10\n";
    assert!(good(&(cracked() + seam), &[]).line_law().is_none());
}
