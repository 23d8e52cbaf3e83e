//! Smaller elements where a case asks for them.

use fractum_mesh::{Mesh, RefineError, RefineOptions, Refined, Vec3, bytes_to_refine, longest_edge, refined};
use fractum_output::number::{grouped, quantity, significant};
use fractum_output::warning::Code;

use crate::model::RefineZone;
use crate::{Diagnostic, Diagnostics};

/// About how much memory it takes to refine a mesh [bytes].
pub fn refine_bytes(zones: &[RefineZone], mesh: &Mesh) -> u64 {
    bytes_to_refine(mesh, &|at| finest(zones, at).map_or(f64::INFINITY, |zone| zone.size))
}

/// Refines a mesh in the zones of a case; what was made is told in its notices.
///
/// - returns what is doubtful
///
/// # Errors
/// Zones without elements, and too many elements.
pub fn refine_mesh(zones: &[RefineZone], mesh: &mut Mesh) -> Result<Vec<Diagnostic>, Diagnostics> {
    let Some(smallest) = zones.iter().min_by(|a, b| a.size.total_cmp(&b.size)) else { return Ok(Vec::new()) };
    let mut warnings = Vec::new();
    let mut wrong = Vec::new();
    for zone in zones {
        let place = zone.condition.as_ref().map_or(&zone.place, |condition| &condition.place);
        match longest_edge(mesh, &|at| holds(zone, at)) {
            None => {
                let note = Diagnostic::error(place, ": no element of the mesh lies there".to_owned());
                let note = note.expected("a place in the bodies");
                wrong.push(note.remedy("compare with the box that fractum mesh info tells, and mesh.unit"));
            }
            Some(longest) if longest <= zone.size => {
                let found = format!(
                    ": size is {}, and the longest edge there {}: nothing to refine",
                    quantity(zone.size, "m"),
                    quantity(longest, "m")
                );
                let note = Diagnostic::warning(Code::NoEffect, &zone.place, found);
                warnings.push(note.remedy("a smaller size, or leave it out"));
            }
            Some(_) => {}
        }
    }
    if !wrong.is_empty() {
        return Err(Diagnostics::of_many(wrong));
    }
    let size = |at: Vec3| finest(zones, at).map_or(f64::INFINITY, |zone| zone.size);
    let seed = |at: Vec3| finest(zones, at).and_then(|zone| zone.seed);
    let options = RefineOptions { seed: &seed, ..RefineOptions::default() };
    let made = refined(mesh, &size, options).map_err(|error| {
        let note = Diagnostic::error(&smallest.place, format!(".size = {}: {error}", quantity(smallest.size, "m")));
        Diagnostics::of_many(vec![note.remedy(remedy(&error))])
    })?;
    let notice = told(&made, 1.0);
    *mesh = made.mesh;
    mesh.notices.push(notice);
    Ok(warnings)
}

fn holds(zone: &RefineZone, at: Vec3) -> bool {
    zone.condition.as_ref().is_none_or(|condition| condition.value.holds_at(at))
}

/// The zone of the smallest elements at a place; of equals the first.
fn finest(zones: &[RefineZone], at: Vec3) -> Option<&RefineZone> {
    zones.iter().filter(|zone| holds(zone, at)).min_by(|a, b| a.size.total_cmp(&b.size))
}

/// What to do about a mesh that cannot be refined.
pub fn remedy(error: &RefineError) -> &'static str {
    match error {
        RefineError::TooMany(_) => "a larger size, with its unit, or a smaller zone",
        RefineError::Size(_) => "a size above 0",
        RefineError::Nowhere | RefineError::Empty | RefineError::NotWhole => {
            "compare with what fractum mesh info tells, and mesh.unit"
        }
    }
}

/// What was made, in words.
///
/// - `unit`: length of the unit of the mesh [m]
pub fn told(made: &Refined, unit: f64) -> String {
    let [before, after] = made.elements.map(|count| grouped(&count.to_string()));
    let is_plane = made.mesh.tetrahedra.is_empty();
    let what = if is_plane { "triangles" } else { "tetrahedra" };
    let length = |length: f64| quantity(unit * length, "m");
    let [longest, reached] = made.longest.map(length);
    let angles = made.quality.map(|quality| significant(quality.smallest_angle.value.to_degrees(), 3));
    let ratios = made.quality.map(|quality| significant(quality.worst_radius_ratio.value, 2));
    let altitudes = made.quality.map(|quality| length(quality.shortest_altitude.value));
    let moved = match made.moved {
        0 => "rows kept".to_owned(),
        count => format!("rows broken up by moves of {} nodes", grouped(&count.to_string())),
    };
    format!(
        "refined: {after} {what} of {before}; edges there up to {reached} (before {longest}), {} on average; smallest angle {} deg (before {}), \
         radius ratio {} ({}), altitude {} ({}); {moved}",
        length(made.mean),
        angles[1],
        angles[0],
        ratios[1],
        ratios[0],
        altitudes[1],
        altitudes[0],
    )
}
