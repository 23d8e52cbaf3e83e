//! Probes of the contact force between two bodies: which names they take.

use crate::selection::refused;

#[test]
fn two_bodies_that_cannot_touch_are_refused_with_their_place() {
    let probe = |on: &str, from: &str| {
        let rigid = |name: &str| {
            format!("[[bodies]]\nname = \"{name}\"\nkind = \"rigid\"\nshape = \"plane\"\nnormal = \"z\"\n")
        };
        let probe = format!("contact_force = {{ on = \"{on}\", from = \"{from}\", along = \"x\" }}");
        refused(&format!("{}{}[[probes]]\nname = \"push\"\n{probe}\n", rigid("floor"), rigid("wall")))
    };
    for (on, from, place, said) in [
        ("bodi", "floor", "probes[0].contact_force.on", "did you mean \"body\"?"),
        ("body", "x+", "probes[0].contact_force.from", "the name of a body: body, floor, wall"),
        ("body", "body", "probes[0].contact_force.from", "another body"),
        ("floor", "wall", "probes[0].contact_force.from", "rigid bodies do not touch each other"),
    ] {
        let found = probe(on, from);
        assert!(found.contains(place) && found.contains(said) && found.lines().count() == 1, "{on} {from}: {found}");
    }
}
