//! Pairs of materials with coefficients of contact of their own: in the scene, and where they are in vain.

use fractum_output::warning::Code;
use fractum_scene::{ContactBody, ContactPairs};

use super::bodies::Part;
use crate::Diagnostic;
use crate::model::{Body, BodyKind, Case, ContactPair, SolverKind};

/// The pairs of bodies of a scene whose contact has coefficients of its own.
pub(super) fn contact_pairs<'c>(case: &'c Case, parts: &[Part]) -> ContactPairs {
    let mut pairs = ContactPairs::default();
    if case.contact_pairs.is_empty() {
        return pairs;
    }
    let (mut rigid_bodies, mut particles) = (0.., 0..);
    let in_scene = |body: &'c Body| {
        let found = match body.kind {
            BodyKind::Solid(_) => parts.iter().position(|part| part.name == body.name.value).map(ContactBody::Solid),
            BodyKind::Rigid(_) => rigid_bodies.next().map(ContactBody::Rigid),
            BodyKind::Bonded(_) | BodyKind::Particles(_) => particles.next().map(ContactBody::Particles),
        };
        found.map(|found| (body, found))
    };
    let bodies: Vec<(&Body, ContactBody)> = case.bodies.iter().filter_map(in_scene).collect();
    for (index, first) in bodies.iter().enumerate() {
        for second in &bodies[index..] {
            if let Some(contact) = case.contact_between([first.0, second.0]) {
                pairs.set([first.1, second.1], contact);
            }
        }
    }
    pairs
}

/// Pairs, and coefficients of pairs, that act nowhere.
///
/// - `is_plane`: whether the solids are plane
pub(super) fn in_vain(case: &Case, is_plane: bool) -> Vec<Diagnostic> {
    let doubts = case.contact_pairs.iter().flat_map(|pair| {
        let meeting: Vec<[&Body; 2]> = bodies_of(case, pair).filter(|pair| may_touch(case, is_plane, *pair)).collect();
        if meeting.is_empty() {
            return vec![without_contact(case, pair)];
        }
        let acts = |key: usize| meeting.iter().any(|bodies| case.acting(pair, *bodies).named()[key].1.is_some());
        let given = pair.coefficients.named().into_iter().enumerate().filter(|(_, (_, value))| value.is_some());
        given.filter(|(key, _)| !acts(*key)).map(|(_, (name, _))| without_effect(pair, name)).collect()
    });
    doubts.collect()
}

/// Bodies of the two materials of a pair, each two of them once, and each body with itself.
fn bodies_of<'c>(case: &'c Case, pair: &'c ContactPair) -> impl Iterator<Item = [&'c Body; 2]> {
    let bodies = &case.bodies;
    let all = (0..bodies.len()).flat_map(move |i| (i..bodies.len()).map(move |j| [&bodies[i], &bodies[j]]));
    all.filter(|bodies| case.pair_of(*bodies) == Some(pair))
}

/// Whether two bodies, or what comes off one, may ever touch.
fn may_touch(case: &Case, is_plane: bool, [first, second]: [&Body; 2]) -> bool {
    if std::ptr::eq(first, second) {
        return match &first.kind {
            BodyKind::Solid(own) => own.damage,
            BodyKind::Bonded(own) => {
                let material = &case.materials[own.material];
                material.fracture.is_some() || material.interfaces.is_some()
            }
            BodyKind::Particles(_) => true,
            BodyKind::Rigid(_) => false,
        };
    }
    match (&first.kind, &second.kind) {
        (BodyKind::Rigid(_), BodyKind::Rigid(_)) => false,
        (BodyKind::Rigid(_), _) | (_, BodyKind::Rigid(_)) => true,
        (BodyKind::Solid(first), BodyKind::Solid(second)) => {
            (!is_plane && case.solver.kind != SolverKind::Static) || (first.damage && second.damage)
        }
        (BodyKind::Solid(_), _) | (_, BodyKind::Solid(_)) => !is_plane,
        (BodyKind::Bonded(_) | BodyKind::Particles(_), BodyKind::Bonded(_) | BodyKind::Particles(_)) => true,
    }
}

/// A pair of which no two bodies touch.
fn without_contact(case: &Case, pair: &ContactPair) -> Diagnostic {
    let name = |index: usize| case.materials[index].name.value.as_str();
    let bodies = |index: usize| case.bodies.iter().filter(move |body| body.kind.material() == Some(index));
    let [first, second] = pair.materials.map(name);
    let rigid = |index: usize| bodies(index).all(|body| matches!(body.kind, BodyKind::Rigid(_)));
    let absent = pair.materials.into_iter().find(|index| bodies(*index).next().is_none());
    let why = match absent {
        Some(index) => format!("no body is made of {}", name(index)),
        None if pair.materials.into_iter().all(rigid) => "rigid bodies do not touch each other".to_owned(),
        None => "their bodies do not touch".to_owned(),
    };
    let found = format!(": {first} and {second} never touch: {why}");
    let remedy = "check between; a rigid body has the material that its key material names";
    Diagnostic::warning(Code::NoEffect, &pair.place, found).remedy(remedy)
}

/// A coefficient of a pair that acts between none of its bodies.
fn without_effect(pair: &ContactPair, name: &str) -> Diagnostic {
    let (name, why) = match name {
        "work_of_adhesion" => (name, "loose particles alone stick, to each other and to rigid bodies"),
        "damping_ratio" => ("damping ratio or restitution", "the rigid bodies say their own"),
        _ => (name, "the rigid bodies say their own"),
    };
    let found = format!(": its {name} has no effect: {why}");
    Diagnostic::warning(Code::NoEffect, &pair.place, found)
        .remedy("remove it here, or the key in the contact of the rigid body")
}
