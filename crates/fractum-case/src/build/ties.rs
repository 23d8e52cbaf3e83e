//! Ties of bonded bodies to solids, and elements that bonded bodies take the place of.

use std::collections::HashSet;

use fractum_fem::{ElementKind, Solid};
use fractum_math::Vec3;
use fractum_mesh::topology;
use fractum_output::number::quantity;
use fractum_output::warning::Code;
use fractum_prepare::PreparedBody;
use fractum_scene::Bonded;
use fractum_scene::coupling::{Attachment, Layer};

use super::Context;
use super::bodies::{Numbering, Part};
use crate::model::{BodyKind, GroupUse};
use crate::{Diagnostic, Place, Spanned};

/// Largest gap of a tied particle over the mean radius: a packing touches its walls within a few hundredths.
const WITHIN: f64 = 0.1;
/// Mean edge of tied facets over the diameter of particles below which many facets have no particle.
const SMALL_FACET: f64 = 0.75;
/// Cosine between facets that lie in one surface.
const SAME_SURFACE: f64 = 0.9;

/// A tie of the scene, for the plan.
#[derive(Clone, Debug, PartialEq)]
pub struct TieReport {
    /// Bonded body.
    pub bonded: String,
    /// Solid body or group of facets.
    pub solid: String,
    /// Particles tied.
    pub particles: usize,
    /// Facets that they follow.
    pub facets: usize,
    /// Largest gap that was allowed [m].
    pub within: f64,
}

/// All ties of a scene.
#[derive(Default)]
pub(super) struct TiedLayers {
    pub(super) attachments: Vec<Attachment>,
    pub(super) reports: Vec<TieReport>,
    /// Facets under tied particles, which the particles do not touch as well.
    pub(super) covered: HashSet<[u32; 3]>,
    pub(super) warnings: Vec<Diagnostic>,
}

/// Elements of a solid that a bonded body has taken.
pub(super) struct Taken {
    /// Bonded body, as an index into `Case::bodies`.
    body: usize,
    elements: Vec<u32>,
}

/// What the bonded bodies take from the solids.
pub(super) fn taken(context: &Context<'_>, prepared: &[PreparedBody]) -> Vec<Taken> {
    let particles = |kind: &BodyKind| matches!(kind, BodyKind::Bonded(_) | BodyKind::Particles(_));
    let bodies = context.case.bodies.iter().enumerate().filter(|(_, body)| particles(&body.kind));
    let of = |((body, _), made): ((usize, _), &PreparedBody)| Taken { body, elements: made.replaced.clone() };
    bodies.zip(prepared).map(of).filter(|taken| !taken.elements.is_empty()).collect()
}

/// Takes the elements out of the solids that lose them.
pub(super) fn take_out(context: &mut Context<'_>, parts: &mut [Part], taken: &[Taken]) {
    let mut gone: Vec<u32> = Vec::new();
    for Taken { body, elements } in taken {
        let name = &context.case.bodies[*body].name;
        if let Some(element) = elements.iter().find(|e| gone.binary_search(e).is_ok()) {
            let tag = context.mesh.tetrahedron_tags[*element as usize];
            let found = format!("= \"{}\": element {tag} is within another bonded body too", name.value);
            context.error(&name.place.clone(), found, "shapes without common elements");
        }
        gone.extend(elements);
        gone.sort_unstable();
    }
    if gone.is_empty() {
        return;
    }
    for part in parts.iter_mut().filter(|part| part.shape == ElementKind::T4) {
        part.elements.retain(|e| gone.binary_search(e).is_err());
        if part.elements.is_empty() {
            let place = part.place.clone();
            context.error(&place, ": bonded bodies take the place of all of it", "elements that are left");
        }
    }
}

/// Finds all ties.
pub(super) fn ties(
    context: &mut Context<'_>,
    solid: &Solid,
    bonded: &Bonded,
    taken: &[Taken],
    parts: &[Part],
    numbering: &Numbering,
    facets: &[Vec<[u32; 3]>],
) -> TiedLayers {
    let mut all = TiedLayers::default();
    for Taken { body, elements } in taken {
        let BodyKind::Bonded(own) = &context.case.bodies[*body].kind else { continue };
        let Some(replaces) = &own.replaces else { continue };
        let cells: Vec<[u32; 4]> = elements.iter().map(|&e| context.mesh.tetrahedra[e as usize]).collect();
        let scene = |n: u32| numbering.scene_node[n as usize];
        let left = topology::boundary_of_tetrahedra(&cells);
        let left: HashSet<[u32; 3]> = left.iter().map(|f| sorted(f.nodes.map(scene))).collect();
        let shared: Vec<[u32; 3]> = facets.iter().flatten().copied().filter(|f| left.contains(&sorted(*f))).collect();
        // The whole of what the region has in common with the rest.
        all.covered.extend(shared.iter().map(|f| sorted(*f)));
        let among = Spanned::new(context.case.bodies[*body].name.value.clone(), replaces.place.clone());
        tie_one(context, solid, bonded, &shared, (&replaces.value, &replaces.place), &among, None, &mut all);
    }
    let case = context.case;
    for tie in &case.ties {
        let of_body: Vec<[u32; 3]> = parts
            .iter()
            .zip(facets)
            .filter(|(part, _)| part.name == tie.solid.value)
            .flat_map(|(_, facets)| facets.iter().copied())
            .collect();
        let wanted = if of_body.is_empty() { facets_of_group(context, &tie.solid, numbering, facets) } else { of_body };
        if wanted.is_empty() {
            let found = format!("= \"{}\"", tie.solid.value);
            let expected = format!("a solid body of tetrahedra, or {}", super::use_in_words(GroupUse::Facets));
            context.error(&tie.solid.place, found, expected);
            continue;
        }
        let of = (tie.solid.value.as_str(), &tie.solid.place);
        tie_one(context, solid, bonded, &wanted, of, &tie.bonded, tie.within, &mut all);
    }
    all
}

/// Facets of a group that are on the surface of a solid, outward.
fn facets_of_group(
    context: &Context<'_>,
    group: &Spanned<String>,
    numbering: &Numbering,
    facets: &[Vec<[u32; 3]>],
) -> Vec<[u32; 3]> {
    let scene = |n: u32| numbering.scene_node[n as usize];
    let triangles = context.mesh.group(&group.value);
    let triangles = triangles.iter().flat_map(|g| &g.triangles).map(|&t| context.mesh.triangles[t as usize]);
    let named: HashSet<[u32; 3]> = triangles.map(|t| sorted(t.map(scene))).collect();
    facets.iter().flatten().copied().filter(|f| named.contains(&sorted(*f))).collect()
}

#[allow(clippy::too_many_arguments)] // one tie, and where it goes
fn tie_one(
    context: &mut Context<'_>,
    solid: &Solid,
    bonded: &Bonded,
    facets: &[[u32; 3]],
    of: (&str, &Place),
    among: &Spanned<String>,
    within: Option<f64>,
    all: &mut TiedLayers,
) {
    let particles = context.particles(among);
    if particles.is_empty() {
        return;
    }
    let radius = |i: &u32| bonded.particles.radius[*i as usize];
    let mean_radius = particles.iter().map(radius).sum::<f64>() / particles.len() as f64;
    let within = within.unwrap_or(WITHIN * mean_radius);
    let layer = match Layer::find(solid, facets, &bonded.particles, &particles, within) {
        Ok(layer) => layer,
        Err(error) => {
            context.error(of.1, format!("= \"{}\": {error}", of.0), "");
            return;
        }
    };
    if layer.attachments.is_empty() {
        let found = format!(
            "= \"{}\": no particle of \"{}\" is within {within:.3e} m of its facets; the nearest is {:.3e} m off",
            of.0, among.value, layer.least_gap
        );
        let error = Diagnostic::error(of.1, found);
        context.diagnostics.push(error.remedy("let the shape of the particles end at the surface, or raise within"));
        return;
    }
    cover(solid, bonded, facets, &layer.attachments, 2.0 * mean_radius, &mut all.covered);
    all.warnings.extend(small_facets(solid, &layer.attachments, 2.0 * mean_radius, of, &among.value));
    all.reports.push(TieReport {
        bonded: among.value.clone(),
        solid: of.0.to_owned(),
        particles: layer.attachments.len(),
        facets: layer.facets,
        within,
    });
    all.attachments.extend(layer.attachments);
}

/// Facets smaller than particles: those without a particle are free, the tie gives way, and waves are reflected.
fn small_facets(
    solid: &Solid,
    tied: &[Attachment],
    diameter: f64,
    (name, place): (&str, &Place),
    bonded: &str,
) -> Option<Diagnostic> {
    let edge = |a: &Attachment| {
        let [a, b, c] = a.facet.map(|n| solid.position(n as usize));
        ((b - a).norm() + (c - b).norm() + (a - c).norm()) / 3.0
    };
    let mean = tied.iter().map(edge).sum::<f64>() / tied.len() as f64;
    if mean >= SMALL_FACET * diameter {
        return None;
    }
    let (edges, diameter) = (quantity(mean, "m"), quantity(diameter, "m"));
    let found = format!(
        "= \"{name}\": its tied facets have edges of {edges}, and particles of \"{bonded}\" are {diameter} across"
    );
    let note = Diagnostic::warning(Code::TieFacets, place, found);
    Some(note.remedy("facets without a particle are not held, so that waves are reflected; take larger elements there, or smaller particles"))
}

/// Adds the facets that tied particles cover: their own, and small ones that lie between them in the same surface.
fn cover(
    solid: &Solid,
    bonded: &Bonded,
    facets: &[[u32; 3]],
    tied: &[Attachment],
    reach: f64,
    covered: &mut HashSet<[u32; 3]>,
) {
    let corners = |facet: &[u32; 3]| facet.map(|n| solid.position(n as usize));
    let normal = |facet: &[u32; 3]| {
        let [a, b, c] = corners(facet);
        (b - a).cross(&(c - a)).normalize()
    };
    let own: HashSet<[u32; 3]> = tied.iter().map(|a| sorted(a.facet)).collect();
    covered.extend(&own);
    let places: Vec<(Vec3, Vec3)> =
        tied.iter().map(|a| (bonded.particles.position[a.particle as usize], normal(&a.facet))).collect();
    for facet in facets.iter().filter(|f| !own.contains(&sorted(**f))) {
        let middle: Vec3 = corners(facet).iter().sum::<Vec3>() / 3.0;
        let direction = normal(facet);
        let near =
            |(x, n): &(Vec3, Vec3)| (x - middle).norm_squared() < reach * reach && n.dot(&direction) > SAME_SURFACE;
        if places.iter().any(near) {
            covered.insert(sorted(*facet));
        }
    }
}

/// A facet by its nodes alone.
pub(super) fn sorted(mut nodes: [u32; 3]) -> [u32; 3] {
    nodes.sort_unstable();
    nodes
}
