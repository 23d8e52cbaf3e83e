//! Discs in the plane z = 0: what they cannot be beside.

use fractum_fem::ElementKind;
use fractum_output::number::quantity;

use super::Context;
use super::bodies::Part;
use crate::model::{Body, BodyKind, RigidShape, SolverKind};

/// Refuses what discs do not meet, and what knows spheres only; whether there are discs.
///
/// - `plane`: z of 2D solids [m]
pub(super) fn check(context: &mut Context<'_>, parts: &[Part], plane: f64) -> bool {
    let (case, shares) = (context.case, context.exchange.is_some());
    let thickness = |body: &Body| match &body.kind {
        BodyKind::Particles(own) => own.thickness.as_ref().map(|thickness| thickness.value),
        _ => None,
    };
    let Some((discs, of_discs)) = case.bodies.iter().find_map(|body| Some((body, thickness(body)?))) else {
        return false;
    };
    let mut refuse = |body: &Body, found: String, expected: &str| {
        context.error(&body.name.place, format!("= \"{}\": {found}", body.name.value), expected);
    };
    let name = &discs.name.value;
    for body in &case.bodies {
        match &body.kind {
            BodyKind::Particles(own) => {
                let found = match thickness(body) {
                    Some(own) if own == of_discs => None,
                    Some(own) => Some(format!(
                        "discs of thickness {} beside those of \"{name}\", of {}",
                        quantity(own, "m"),
                        quantity(of_discs, "m")
                    )),
                    None => Some(format!("spheres beside the discs of \"{name}\"")),
                };
                if let Some(found) = found {
                    refuse(body, found, "bodies of particles that all have the same thickness, or none");
                }
                if case.materials[own.material].work_of_adhesion != 0.0 {
                    refuse(body, "discs do not stick".to_owned(), "a material without contact.work_of_adhesion");
                }
            }
            BodyKind::Bonded(_) => {
                let found = format!("spheres with bonds beside the discs of \"{name}\"");
                refuse(body, found, "2D solids, or loose spheres: discs have no bonds");
            }
            BodyKind::Rigid(rigid) => {
                if matches!(rigid.shape, RigidShape::Sphere { .. } | RigidShape::Group { .. } | RigidShape::Stl { .. })
                {
                    let found = format!("the discs of \"{name}\" touch neither spheres nor facets");
                    refuse(body, found, "a plane, a box, or a cylinder along z");
                }
            }
            BodyKind::Solid(_) => {
                let Some(part) = parts.iter().find(|part| part.name == body.name.value) else { continue };
                if part.shape == ElementKind::T4 {
                    let found = format!("a solid in space beside the discs of \"{name}\"");
                    refuse(body, found, "2D solids beside discs, or spheres (without thickness) beside it");
                } else if part.body.is_axisymmetric() {
                    let found = format!("a section about an axis beside the discs of \"{name}\"");
                    refuse(body, found, "plane strain or plane stress");
                } else if part.body.depth != of_discs {
                    let [own, discs] = [part.body.depth, of_discs].map(|length| quantity(length, "m"));
                    let found = format!("its thickness of {own} is not that of the discs of \"{name}\", {discs}");
                    refuse(body, found, "one thickness of all that lies in the plane");
                } else if plane != 0.0 {
                    let found = format!("its plane is z = {}, and discs lie in z = 0", quantity(plane, "m"));
                    refuse(body, found, "a mesh in the plane z = 0");
                }
            }
        }
    }
    let sticks = case.contact_pairs.iter().any(|pair| pair.coefficients.work_of_adhesion.is_some());
    let beside = [
        (shares && !parts.is_empty(), "several processes share the solids beside discs", "one process"),
        (case.solver.kind != SolverKind::Explicit, "discs only move", "solver.kind = \"explicit\""),
        (case.periodic.is_some(), "discs know no periodic box", "no [periodic], or spheres in it"),
        (case.flows.heat.is_some(), "discs know no heat", "no [heat]"),
        (sticks, "discs do not stick", "contact_pairs without work_of_adhesion"),
    ];
    for (_, found, expected) in beside.into_iter().filter(|(is_there, ..)| *is_there) {
        refuse(discs, found.to_owned(), expected);
    }
    true
}
