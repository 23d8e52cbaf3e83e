//! Solid bodies: elements, nodes, materials, strength.

use std::collections::HashSet;
use std::sync::Arc;

use fractum_fem as fem;
use fractum_fem::{
    CriterionKind, DamageLaw, DamageZone, EXCESS_OF_PEAK, Elastic, Formulation, LengthReport, Plane, Region, Solid,
    crack_scale, motion,
};
use fractum_math::Vec3;
use fractum_mesh::renumber::hilbert_order;
use fractum_mesh::{fold_of_tetrahedra, fold_of_triangles, topology};
use fractum_output::number::quantity;
use fractum_output::warning::Code;

use super::notches::Notches;
use super::{Context, use_in_words};
use crate::model::{BodyKind, Case, Damage, GroupUse, SolidBody};
use crate::{Diagnostic, Place};

/// Excess of the loads of cracks by the size of elements that is told.
const LARGE_EXCESS: f64 = 0.05;
/// Size of elements over the smallest extent of a body above which a crack through it is a matter of one or two elements.
const WIDE: f64 = 0.5;

/// A solid body of the case with its elements in the mesh.
pub(super) struct Part<'a> {
    pub(super) body: &'a SolidBody,
    pub(super) name: &'a str,
    pub(super) place: Place,
    pub(super) shape: fem::ElementKind,
    /// Tetrahedra or triangles of the mesh.
    pub(super) elements: Vec<u32>,
}

/// The nodes of the scene: those of solid bodies, in an order that keeps neighbours close in memory.
#[derive(Clone)]
pub(super) struct Numbering {
    pub(super) scene_node: Vec<u32>,
    pub(super) positions: Vec<Vec3>,
    /// Nodes of the scene that have left with their bodies before the present stage, ascending.
    pub(super) gone: Vec<u32>,
}

impl Numbering {
    /// The numbers of nodes of a mesh that solid bodies use, along a Hilbert curve; with the nodes of the mesh in that order.
    pub(super) fn of(nodes: &[Vec3], is_used: &[bool]) -> (Self, Vec<u32>) {
        let used: Vec<u32> = (0..nodes.len() as u32).filter(|&n| is_used[n as usize]).collect();
        let points: Vec<Vec3> = used.iter().map(|&n| nodes[n as usize]).collect();
        let order: Vec<u32> = hilbert_order(&points).into_iter().map(|old| used[old as usize]).collect();
        let mut scene_node = vec![u32::MAX; nodes.len()];
        (0..).zip(&order).for_each(|(new, &old)| scene_node[old as usize] = new);
        let positions = order.iter().map(|&old| nodes[old as usize]).collect();
        (Numbering { scene_node, positions, gone: Vec::new() }, order)
    }

    /// The same with the nodes that have left.
    pub(super) fn whole(&self) -> Self {
        Numbering { gone: Vec::new(), ..self.clone() }
    }

    /// Whether a node of the scene has left.
    pub(super) fn has_left(&self, node: u32) -> bool {
        self.gone.binary_search(&node).is_ok()
    }

    /// Some nodes of the mesh by their numbers in the scene, each once, ascending.
    pub(super) fn ascending<'a>(&self, nodes: impl IntoIterator<Item = &'a u32>) -> Vec<u32> {
        let mut nodes: Vec<u32> = nodes.into_iter().map(|&node| self.scene_node[node as usize]).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Scene nodes in the order of the file.
    pub(super) fn file_order(&self) -> Vec<u32> {
        self.scene_node.iter().copied().filter(|&n| n != u32::MAX).collect()
    }
}

/// The elements of each solid body.
pub(super) fn solid_parts<'a>(context: &mut Context<'a>) -> Option<Vec<Part<'a>>> {
    let (case, mesh) = (context.case, context.mesh);
    let mut parts: Vec<Part<'a>> = Vec::new();
    for body in &case.bodies {
        let BodyKind::Solid(solid) = &body.kind else { continue };
        let groups = mesh.group(&solid.group.value);
        let collect = |of: fn(&fractum_mesh::Group) -> &Vec<u32>| -> Vec<u32> {
            groups.iter().flat_map(|g| of(g)).copied().collect()
        };
        let (tetrahedra, triangles) = (collect(|g| &g.tetrahedra), collect(|g| &g.triangles));
        let place = solid.group.place.clone();
        let (shape, elements) = if mesh.group_tetrahedra(&solid.group.value) > 0 {
            (fem::ElementKind::T4, tetrahedra)
        } else if !triangles.is_empty() {
            (fem::ElementKind::T3, triangles)
        } else {
            let found = format!("= \"{}\"", solid.group.value);
            let wanted = format!("tetrahedra or triangles as {}", use_in_words(GroupUse::Body));
            context.error(&place, found, wanted);
            continue;
        };
        parts.push(Part { body: solid, name: &body.name.value, place, shape, elements });
    }
    let particles = |kind: &BodyKind| matches!(kind, BodyKind::Bonded(_) | BodyKind::Particles(_));
    let bonded = case.bodies.iter().any(|body| particles(&body.kind));
    if parts.is_empty() && !bonded && context.diagnostics.is_empty() {
        let place = context.whole_case();
        context.error(
            &place,
            "no body of kind \"solid\", \"bonded\" or \"particles\"",
            "at least one; only rigid tools have nothing to compute",
        );
    }
    for part in &parts {
        check_dimension(context, part);
    }
    check_overlap(context, &parts);
    if context.diagnostics.is_empty() {
        check_folds(context, &parts);
    }
    context.diagnostics.is_empty().then_some(parts)
}

fn check_dimension(context: &mut Context<'_>, part: &Part) {
    let body = part.body;
    if part.shape == fem::ElementKind::T3 {
        let flat = part.elements.iter().flat_map(|&t| context.mesh.triangles[t as usize]);
        let z0 = flat.clone().next().map_or(0.0, |n| context.mesh.nodes[n as usize].z);
        let (low, high) = context.mesh.bounding_box();
        if flat.into_iter().any(|n| (context.mesh.nodes[n as usize].z - z0).abs() > 1e-9 * (high - low).norm()) {
            context.error(
                &part.place,
                format!("= \"{}\": triangles out of the xy-plane", body.group.value),
                "a plane body lies in the xy-plane; a solid needs tetrahedra",
            );
        }
        return;
    }
    if let Some(plane) = &body.plane {
        context.error(
            &plane.place,
            ": the body is made of tetrahedra",
            "no plane state in three dimensions; remove the key",
        );
    }
    if let Some(thickness) = &body.thickness {
        context.error(
            &thickness.place,
            ": the body is made of tetrahedra",
            "no thickness in three dimensions; remove the key",
        );
    }
}

/// Numbers of the solids that have left before the present stage, or come in after it.
pub(super) fn gone(case: &Case, parts: &[Part]) -> Vec<usize> {
    let Some(excavation) = &case.excavation else { return Vec::new() };
    numbers(parts, excavation.gone.iter().map(String::as_str))
}

/// Numbers of the parts of these names.
pub(super) fn numbers<'n>(parts: &[Part], names: impl Iterator<Item = &'n str>) -> Vec<usize> {
    names.filter_map(|name| parts.iter().position(|part| part.name == name)).collect()
}

/// Elements lie on both sides of what they share: those of all bodies, and of each one where bodies come and go.
fn check_folds(context: &mut Context<'_>, parts: &[Part]) {
    let at_once = if context.case.excavates() { 1 } else { parts.len().max(1) };
    for parts in parts.chunks(at_once) {
        let elements: Vec<u32> = parts.iter().flat_map(|part| &part.elements).copied().collect();
        let mesh = context.mesh;
        let (found, tags) = match parts[0].shape {
            fem::ElementKind::T4 => {
                let own: Vec<[u32; 4]> = elements.iter().map(|&e| mesh.tetrahedra[e as usize]).collect();
                (fold_of_tetrahedra(&own), &mesh.tetrahedron_tags)
            }
            fem::ElementKind::T3 => {
                let own: Vec<[u32; 3]> = elements.iter().map(|&e| mesh.triangles[e as usize]).collect();
                (fold_of_triangles(&own), &mesh.triangle_tags)
            }
        };
        let Some(fold) = found else { continue };
        let [first, second] = fold.elements.map(|element| elements[element as usize]);
        let part = parts.iter().find(|part| part.elements.contains(&first)).unwrap_or(&parts[0]);
        let more = if fold.count > 1 { format!(", {} such pairs", fold.count) } else { String::new() };
        let found = format!(
            "= \"{}\": elements {} and {} overlap: both lie on the same side of the facet that they share{more}",
            part.body.group.value, tags[first as usize], tags[second as usize]
        );
        let remedy = "one of them is inside out, or lies upon the other: mesh again, or take it out";
        let note = Diagnostic::error(&part.place, found).expected("a mesh without folds");
        context.diagnostics.push(note.remedy(remedy));
    }
}

/// An element may belong to one body only of those that are there at a time.
fn check_overlap(context: &mut Context<'_>, parts: &[Part]) {
    let gone = gone(context.case, parts);
    for (index, part) in parts.iter().enumerate() {
        for (before, other) in parts[..index].iter().enumerate() {
            let at_once = !gone.contains(&index) && !gone.contains(&before);
            if other.shape != part.shape {
                let found = format!("= \"{}\" mixes with \"{}\"", part.body.group.value, other.body.group.value);
                context.error(&part.place, found, "all solid bodies of triangles, or all of tetrahedra");
            } else if let Some(&element) =
                part.elements.iter().find(|e| at_once && other.elements.binary_search(e).is_ok())
            {
                let tags = match part.shape {
                    fem::ElementKind::T4 => &context.mesh.tetrahedron_tags,
                    fem::ElementKind::T3 => &context.mesh.triangle_tags,
                };
                let found = format!(
                    "= \"{}\": element {} also belongs to body \"{}\"",
                    part.body.group.value, tags[element as usize], other.name
                );
                let mut note = Diagnostic::error(&part.place, found).expected("bodies without common elements");
                if context.case.excavates() {
                    let stage = &context.case.source.stage;
                    note = note
                        .remedy(format!("in stage \"{stage}\" both are there; excavate one before the other comes in"));
                }
                context.diagnostics.push(note);
            }
        }
    }
}

/// Nodes of the bodies along a Hilbert curve.
pub(super) fn number_nodes(context: &Context<'_>, parts: &[Part]) -> Numbering {
    if let Some(division) = context.division {
        return division.numbering.clone();
    }
    let mut is_used = vec![false; context.mesh.nodes.len()];
    let nodes = parts.iter().flat_map(|part| element_nodes(context, part)).flatten();
    nodes.for_each(|node| is_used[node as usize] = true);
    Numbering::of(&context.mesh.nodes, &is_used).0
}

/// Mesh nodes of the elements of a part; triangles repeat their last node.
pub(super) fn element_nodes(context: &Context<'_>, part: &Part) -> Vec<[u32; 4]> {
    let of = |&e: &u32| match part.shape {
        fem::ElementKind::T4 => context.mesh.tetrahedra[e as usize],
        fem::ElementKind::T3 => {
            let [a, b, c] = context.mesh.triangles[e as usize];
            [a, b, c, c]
        }
    };
    part.elements.iter().map(of).collect()
}

/// - `boundary`: free facets of all solids
pub(super) fn solid_bodies<'a>(
    context: &mut Context<'a>,
    parts: &[Part<'a>],
    numbering: &Numbering,
    boundary: &[[u32; 3]],
) -> Option<Vec<fem::Body>> {
    let mut bodies = Vec::new();
    for (index, part) in parts.iter().enumerate() {
        let material = &context.case.materials[part.body.material];
        let elastic = Elastic {
            density: material.density,
            young_modulus: material.young_modulus,
            poisson_ratio: material.poisson_ratio,
        };
        let elements = element_nodes(context, part);
        let elements: Vec<[u32; 4]> = elements.iter().map(|e| e.map(|n| numbering.scene_node[n as usize])).collect();
        let mut body = fem::Body::new(part.name, part.shape, elements, elastic);
        body.formulation = part.body.formulation;
        body.kinematics = part.body.kinematics;
        body.plane = part.body.plane.as_ref().map_or(Plane::Strain, |plane| plane.value);
        body.thickness = part.body.depth;
        if let Some(beds) = &material.bedding {
            if beds.value.by_dip && part.shape == fem::ElementKind::T3 {
                let found = ".dip for a plane body, whose third axis is not vertical";
                context.error(&beds.place, found, "normal = [x, y, 0], the normal of the beds in the plane");
            }
            body.bedding = Some(beds.value.law);
        }
        if let Some(damage) = material.damage.as_ref().filter(|_| part.body.damage) {
            if damage.value.unilateral == Some(true) && body.formulation == Formulation::Standard {
                context.error(
                    &damage.place,
                    ".unilateral = true with the standard formulation",
                    "the smoothed formulation, which alone can close cracks; remove one of the two",
                );
            }
            if damage.value.law.friction.is_some() && body.formulation == Formulation::Standard {
                context.error(
                    &damage.place,
                    ".friction with the standard formulation",
                    "the smoothed formulation, whose cracks alone can close and rub; remove one of the two",
                );
            }
            if let Some(beds) = material.bedding.as_ref().filter(|_| body.formulation == Formulation::Standard) {
                context.error(
                    &beds.place,
                    "beside damage with the standard formulation",
                    "the smoothed formulation, whose edges alone know of beds; remove one of the three",
                );
            }
            body.damage = Some(damage_zone(context, (part, index), &body, &damage.value, numbering, boundary));
        }
        bodies.push(body);
    }
    context.diagnostics.is_empty().then_some(bodies)
}

fn damage_zone(
    context: &mut Context<'_>,
    (part, index): (&Part, usize),
    body: &fem::Body,
    damage: &Damage,
    numbering: &Numbering,
    boundary: &[[u32; 3]],
) -> DamageZone {
    let (marked, [strength_factor, strength_by_chance]) =
        context.edges_of((part, index), body, damage, numbering, boundary);
    let region = if part.body.damage_where.is_some() { Region::Edges(marked) } else { Region::Everywhere };
    // Rock that has failed under pressure goes on bearing it.
    let crushes = damage.law.criterion.kind() != CriterionKind::Rankine && context.case.is_blast();
    let crushes = crushes && body.bedding.is_none();
    let by_scene = crushes && body.formulation == Formulation::Smoothed && damage.law.friction.is_none();
    let unilateral = damage.unilateral.unwrap_or(by_scene);
    DamageZone {
        law: DamageLaw { unilateral, ..damage.law.clone() },
        region,
        strength_factor,
        strength_by_chance,
        reduce_strength_to_fit: damage.reduce_strength_to_fit,
        regularisation: damage.regularisation,
        rate: damage.rate.as_ref().map(|rate| Arc::new(rate.value.clone())),
    }
}

/// Warns where elements are large for their fracture energy, or strength had to be lowered.
///
/// - `boundary`: facets of the surface of all solids
pub(super) fn length_warnings(case: &Case, solid: &Solid, parts: &[Part], boundary: &[[u32; 3]]) -> Vec<Diagnostic> {
    let mut warnings = Vec::new();
    let notches = Notches::of(solid, boundary);
    for (index, part) in parts.iter().enumerate() {
        let LengthReport { reduced_edges: reduced, largest_ratio: ratio, size } = solid.length_report(index);
        if let Some([length, size]) = motion::phase_sizes(solid, index).filter(|[length, size]| *length < 1.5 * size) {
            let found = format!(": phase field of length {length:.3e} m on elements of {size:.3e} m");
            warnings.push(
                Diagnostic::warning(Code::PhaseFieldLength, &part.place, found)
                    .remedy("at least one and a half elements; two are the default"),
            );
        }
        if reduced > 0 {
            let found = format!(": strength lowered on {reduced} edges that are too long for the fracture energy");
            let note = Diagnostic::warning(Code::StrengthLowered, &part.place, found);
            warnings.push(note.remedy("refine the mesh where cracks are expected"));
            continue;
        }
        if motion::phase_sizes(solid, index).is_some() {
            continue;
        }
        let longest = (ratio > 0.25).then(|| {
            format!("the longest element reaches {:.0} % of the length at which softening snaps back", 100.0 * ratio)
        });
        if let Some(warning) = excess_warning(case, part, solid.body(index), &notches, size, longest.as_deref()) {
            warnings.push(warning);
        } else if let Some(longest) = longest {
            let found = format!(": {longest}");
            warnings.push(Diagnostic::warning(Code::CoarseMesh, &part.place, found).remedy(
                "elements below a quarter of that length resolve the softening; refine where cracks are expected",
            ));
        }
    }
    warnings
}

/// Warns where elements are so large beside the process zone, or beside the body, that cracks run late from its notches, or so large beside the
/// body that a crack through it has no energy of its own.
///
/// - `size`: of the elements where cracks are expected [m]; `longest`: what else is to be told of them
fn excess_warning(
    case: &Case,
    part: &Part,
    body: &fem::Body,
    notches: &Notches,
    size: f64,
    longest: Option<&str>,
) -> Option<Diagnostic> {
    let zone = case.materials[part.body.material].process_zone().filter(|_| part.body.damage)?;
    let extent = body.smallest_extent(notches.nodes);
    let whole = crack_scale(zone, extent);
    let [excess, most] = EXCESS_OF_PEAK.map(|factor| factor * size / whole);
    let is_local = body.damage.as_ref().is_some_and(|zone| zone.regularisation.is_none());
    if is_local && size > WIDE * extent {
        let [size, extent] = [size, extent].map(|length| quantity(length, "m"));
        let found = format!(
            ": elements of {size} where cracks are expected, in a body whose smallest extent is {extent}: a crack through so few of them may cost twice \
             its fracture energy, or three quarters of it"
        );
        return Some(
            Diagnostic::warning(Code::CoarseMesh, &part.place, found).remedy("take four elements across it at least"),
        );
    }
    if excess < LARGE_EXCESS || !(notches.has(body) || case.interfaces.iter().any(|own| !own.law.is_bonded())) {
        return None;
    }
    let off = match body.formulation {
        Formulation::Smoothed => {
            format!("come out some {:.0} % too high, {:.0} % at most", 100.0 * excess, 100.0 * most)
        }
        Formulation::Standard => format!("are off by {:.0} % at most", 100.0 * most),
    };
    let found = format!(
        ": elements of {} where cracks are expected are {:.2} of the {} that the process zone E Gf/ft^2 of {} and the smallest extent of the body of {} \
         make in series: loads at which cracks run from notches {off}{}{}",
        quantity(size, "m"),
        size / whole,
        quantity(whole, "m"),
        quantity(zone, "m"),
        quantity(extent, "m"),
        if longest.is_some() { "; " } else { "" },
        longest.unwrap_or_default()
    );
    Some(Diagnostic::warning(Code::CoarseMesh, &part.place, found).remedy(format!(
        "2 % want elements of {} there, or an interface where the path of the crack is known (docs/accuracy.md)",
        quantity(0.02 * whole / EXCESS_OF_PEAK[0], "m")
    )))
}

/// Warns where a body would be stronger by its few flaws than its elements allow.
pub(super) fn weibull_warnings(context: &Context<'_>, solid: &Solid, parts: &[Part]) -> Vec<Diagnostic> {
    let warning = |(index, part): (usize, &Part)| {
        let report = context.weibull.iter().find(|report| report.body == part.name)?;
        let strength = context.case.materials[part.body.material].damage.as_ref()?.value.law.tensile_strength;
        let ratio = solid.length_report(index).largest_ratio;
        let most = strength * (1.0 / ratio).sqrt();
        let expected = report.mean * (1.0 + report.variation);
        (expected > most).then(|| {
            let [expected, most] = [expected, most].map(|value| quantity(value, "Pa"));
            let found = format!(": by its flaws bodies like this bear up to {expected}, and its elements {most}");
            Diagnostic::warning(Code::CoarseMesh, &part.place, found)
                .remedy("smaller elements; their largest size goes with one over the strength squared")
        })
    };
    parts.iter().enumerate().filter_map(warning).collect()
}

pub(super) fn set_initial_velocity(context: &Context<'_>, solid: &mut Solid, parts: &[Part], numbering: &Numbering) {
    for (index, part) in parts.iter().enumerate() {
        for (axis, function) in part.body.initial_velocity.iter().enumerate() {
            let Some(function) = function else { continue };
            let corners = part.shape.node_count();
            let nodes: Vec<u32> = match &context.mesh.whole {
                Some(_) => context.nodes_of_group(&part.body.group.value, numbering),
                None => solid.body(index).elements.iter().flat_map(|e| &e[..corners]).copied().collect(),
            };
            for node in nodes {
                let place = solid.reference[node as usize];
                solid.velocity[node as usize][axis] = function.value.at(place);
            }
        }
    }
}

/// Outward facets of all solids (edges of plane bodies repeat their second node), in scene nodes.
///
/// - `gone`: numbers of parts that have left
pub(super) fn boundary(context: &Context<'_>, parts: &[Part], numbering: &Numbering, gone: &[usize]) -> Vec<[u32; 3]> {
    let scene = |n: u32| numbering.scene_node[n as usize];
    if let Some(division) = context.division {
        return division.boundary.all.iter().map(|facet| facet.map(scene)).collect();
    }
    let there = parts.iter().enumerate().filter(|(index, _)| !gone.contains(index));
    let mut known = HashSet::new();
    let mut elements: Vec<[u32; 4]> = there.flat_map(|(_, part)| element_nodes(context, part)).collect();
    if context.case.excavates() {
        // Bodies that are there one after the other may have common elements.
        elements.retain(|nodes| known.insert(*nodes));
    }
    if parts.iter().all(|part| part.shape == fem::ElementKind::T4) {
        topology::boundary_of_tetrahedra(&elements).iter().map(|f| f.nodes.map(scene)).collect()
    } else {
        let triangles: Vec<[u32; 3]> = elements.iter().map(|e| [e[0], e[1], e[2]]).collect();
        let edges = topology::boundary_of_triangles(&triangles);
        edges.iter().map(|e| [scene(e.nodes[0]), scene(e.nodes[1]), scene(e.nodes[1])]).collect()
    }
}
