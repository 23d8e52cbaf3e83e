//! Doubts about the stress of the solids before the run: its sign, and components that were forgotten.

use fractum_fem::Plane;
use fractum_math::Vec3;
use fractum_mesh::Mesh;
use fractum_output::number::quantity;
use fractum_output::warning::Code;

use super::body_doubts::Own;
use super::idle_doubts::facet_normals;
use crate::Diagnostic;
use crate::model::{Case, InSitu, SolverKind, StressField};

/// Tension over the largest stress that is told.
const TENSION: f64 = 0.01;
/// Largest stress below which a rock mass bears nothing [Pa]: a centimetre of it.
const FAINT: f64 = 250.0;
/// Share of the largest component by which that across a plane may differ from what follows from the others.
const FOLLOWS: f64 = 0.01;
/// Share of the area of the far field along an axis above which its stress should be given.
const FACING: f64 = 0.1;

/// Doubts about the in-situ stress.
pub(super) fn doubts_of_in_situ(case: &Case, mesh: &Mesh, bodies: &[Own]) -> Vec<Diagnostic> {
    // Strings and struts vibrate under either sign.
    let Some(stress) = case.in_situ.as_ref().filter(|_| case.solver.kind != SolverKind::Modes) else {
        return Vec::new();
    };
    let of_field = |field: &StressField| {
        let own: Vec<&Own> = bodies.iter().filter(|body| stress.is_of(&body.name.value, field)).collect();
        let pulls = pulling(field, mesh, &own).into_iter();
        pulls.chain(across(case, stress.is_as_written(), field, mesh, &own)).collect::<Vec<_>>()
    };
    let doubts = stress.fields().flat_map(of_field).chain(faint(stress, mesh, bodies));
    doubts.chain(forgotten(case, stress, mesh, bodies)).collect()
}

/// Rock that is pulled, as it is where compression was written as positive.
fn pulling(stress: &StressField, mesh: &Mesh, bodies: &[&Own]) -> Option<Diagnostic> {
    let is_plane = bodies.iter().all(|body| body.plane);
    let (mut tension, mut largest, mut place) = (0.0, 0.0f64, Vec3::zeros());
    for &node in bodies.iter().flat_map(|body| &body.nodes) {
        let at = mesh.nodes[node as usize];
        let matrix = stress.at(at).to_matrix();
        let principal = if is_plane {
            let plane = matrix.fixed_view::<2, 2>(0, 0).into_owned().symmetric_eigenvalues();
            [plane.max(), plane.min()]
        } else {
            let all = matrix.symmetric_eigenvalues();
            [all.max(), all.min()]
        };
        largest = principal.iter().fold(largest, |largest, stress| largest.max(stress.abs()));
        if principal[0] > tension {
            (tension, place) = (principal[0], at);
        }
    }
    if tension <= TENSION * largest {
        return None;
    }
    let found =
        format!("is a tension of {} at ({:.4e}, {:.4e}, {:.4e}) m", quantity(tension, "Pa"), place.x, place.y, place.z);
    let note = Diagnostic::warning(Code::Suction, &stress.place, found).expected("compression, which is negative");
    Some(note.remedy("change its sign, unless the body is pulled"))
}

/// A stress that is none: its unit was forgotten.
fn faint(stress: &InSitu, mesh: &Mesh, bodies: &[Own]) -> Option<Diagnostic> {
    let largest_in = |body: &Own| {
        let at = |field: &StressField, node: u32| field.at(mesh.nodes[node as usize]).to_matrix().amax();
        let field = stress.of(&body.name.value);
        body.nodes.iter().map(|&node| field.map_or(0.0, |field| at(field, node))).fold(0.0, f64::max)
    };
    let largest = bodies.iter().map(largest_in).fold(0.0, f64::max);
    if largest == 0.0 || largest >= FAINT {
        return None;
    }
    let found = format!(".stress is {} at most", quantity(largest, "Pa"));
    let note = Diagnostic::warning(Code::UnitOfLoad, &stress.place, found).expected(format!("{FAINT} Pa at least"));
    Some(note.remedy("did you mean MPa? A number without a unit is in Pa"))
}

/// A stress across the plane of 2D solids that is not the one that these have.
fn across(case: &Case, is_as_written: bool, stress: &StressField, mesh: &Mesh, bodies: &[&Own]) -> Option<Diagnostic> {
    let field = stress.components[2].as_ref().filter(|_| bodies.iter().all(|body| body.plane))?;
    let differs = |body: &&Own| {
        let plane_stress = body.solid.plane.as_ref().is_some_and(|plane| plane.value == Plane::Stress);
        if is_as_written && !plane_stress {
            return false; // it has the one that is given
        }
        let follows = if plane_stress { 0.0 } else { case.materials[body.solid.material].poisson_ratio };
        body.nodes.iter().any(|&node| {
            let given = stress.at(mesh.nodes[node as usize]).to_matrix();
            (given[(2, 2)] - follows * (given[(0, 0)] + given[(1, 1)])).abs() > FOLLOWS * given.amax()
        })
    };
    let found = ": across the plane of 2D solids stress follows from the others: nu (xx + yy), none in plane stress";
    let note = Diagnostic::warning(Code::NoEffect, &field.place, found);
    bodies.iter().any(differs).then(|| note.remedy("leave it out, or take a case in space"))
}

/// A normal stress that is not given, along which facets of the far field look: nothing presses there.
fn forgotten(case: &Case, stress: &InSitu, mesh: &Mesh, bodies: &[Own]) -> Option<Diagnostic> {
    if mesh.whole.is_some() || stress.is_as_written() {
        return None;
    }
    let answering = case.supports.iter().filter(|support| support.surface.is_some());
    let groups = answering.filter_map(|support| support.on.group.as_ref()).chain(&stress.groups);
    let mut areas = Vec3::zeros();
    for group in groups {
        facet_normals(mesh, &group.value).iter().for_each(|normal| areas += normal.abs());
    }
    let axes = if bodies.iter().all(|body| body.plane) { 2 } else { 3 };
    let own = stress.stress.as_ref()?;
    let axis = (0..axes).find(|&axis| own.components[axis].is_none() && areas[axis] > FACING * areas.sum())?;
    let (name, along) = [("xx", "x"), ("yy", "y"), ("zz", "z")][axis];
    let found = format!("has no {name}: facets of the far field that look along {along} bear nothing");
    let note = Diagnostic::warning(Code::NoEffect, &own.place, found);
    Some(note.remedy(format!("give {name}; {name} = 0 where nothing presses")))
}
