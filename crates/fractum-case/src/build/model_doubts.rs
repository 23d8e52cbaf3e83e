//! Is this the model that was meant? Doubts about what mesh and case make together.

use std::collections::HashMap;

use fractum_fem::Plane;
use fractum_math::{Sym3, Vec3};
use fractum_mesh::bodies::SolidElements;
use fractum_mesh::{Group, Mesh};
use fractum_output::number::{grouped, percent, quantity};
use fractum_output::warning::Code;

use super::body_doubts::{Own, extent, moved_as_a_whole, nodes_of, pieces, pushed_away, thin, unheld};
use super::idle_doubts::{all_prescribed, facet_normals, measured_in_vain, tables_in_vain, taken_at_once, unmoved};
use super::in_situ_doubts::doubts_of_in_situ;
use super::load_doubts::{doubts_of_loads, odd_reactions};
use super::meeting_doubts::{
    adhesion_in_vain, beside_at_rest, coincident, meetings, missing, overlapping, rebounds, undamped,
};
use super::{contact_pairs, inlets, periodic};
use crate::model::{BodyKind, Case, GroupUse, Load, LoadKind, Motion, Probe, ProbeKind, Selection, SolverKind};
use crate::{Choice, Diagnostic, Spanned, TimeFunction};

/// Poisson's ratio above which linear elements are too stiff.
const LOCKING: f64 = 0.45;
/// Part of its strength in tension by which that in plane strain may differ.
const COUNTS: f64 = 0.03;
/// Stress of the wave of a jump over the strength, above which the jump shows in what breaks.
const JUMP: f64 = 0.1;
/// Opening of an edge within a passage of a wave over that at which it has no strength, above which it takes clearly less than its energy
/// (88 % of it at 0.4, 59 % at 0.9, a third at 1.6).
const TORN: f64 = 0.5;
/// Cosine between normals of facets that lie in one plane.
const FLAT: f64 = 0.999;
/// Instants at which a motion is looked at, and the share of its range that it may change by between two of them.
const LOOKS: u32 = 2000;
const LEAP: f64 = 0.2;
/// Part of a displacement by which it may differ where a stage begins.
const STEP: f64 = 0.01;

/// Doubts about what case and mesh make together, coordinates in metres.
pub(super) fn doubts_of_model(case: &Case, mesh: &Mesh) -> Vec<Diagnostic> {
    let own = |group: &Group| !group.triangles.is_empty() && group.tetrahedra.is_empty();
    let bodies: Vec<Own> = case
        .bodies
        .iter()
        .filter_map(|body| {
            let BodyKind::Solid(solid) = &body.kind else { return None };
            let (nodes, groups) = (mesh.group_nodes(&solid.group.value), mesh.group(&solid.group.value));
            let plane = mesh.whole.is_none() && groups.iter().all(|group| own(group));
            Some(Own { name: &body.name, solid, nodes, plane })
        })
        .collect();
    let mut doubts: Vec<Diagnostic> = left_out(case, mesh, &bodies).into_iter().collect();
    doubts.extend(beyond_bodies(case, mesh, &bodies));
    // What lies within another body is told, and not also that it touches.
    // One that comes in later may lie where another has left by then.
    let gone = |own: &Own| case.excavation.as_ref().is_some_and(|excavation| excavation.gone.contains(&own.name.value));
    let mut meets = overlapping(mesh, &bodies, gone);
    if meets.is_empty() {
        meets = coincident(case, mesh, &bodies);
    }
    if meets.is_empty() {
        doubts.extend(meetings(case, mesh, &bodies).or_else(|| beside_at_rest(case, mesh, &bodies, gone)));
    }
    doubts.extend(meets);
    doubts.extend(missing(case, mesh, &bodies));
    let without = undamped(case, mesh, &bodies);
    doubts.extend(if without.is_empty() { rebounds(case) } else { without });
    doubts.extend(adhesion_in_vain(case));
    doubts.extend(inlets::doubts(case));
    doubts.extend(periodic::doubts(case));
    doubts.extend(contact_pairs::in_vain(case, bodies.iter().any(|body| body.plane)));
    let unheld = unheld(case, mesh, &bodies).or_else(|| moved_as_a_whole(case, mesh, &bodies));
    doubts.extend(unheld.or_else(|| pushed_away(case, mesh, &bodies)));
    let joined = pieces(mesh, &bodies);
    let is_alone = |piece: u32| joined.iter().filter(|other| **other == piece).count() == 1;
    doubts.extend(bodies.iter().zip(&joined).filter_map(|(body, &piece)| thin(case, mesh, body, is_alone(piece))));
    doubts.extend(bodies.iter().filter_map(|body| torn_at_once(case, mesh, body)));
    doubts.extend(unequal_plates(mesh, &bodies));
    doubts.extend(bodies.iter().filter_map(|body| locking(case, body)));
    doubts.extend(bodies.iter().filter_map(|body| counts_across(case, body)));
    doubts.extend(bodies.iter().filter_map(|body| thickness(case, mesh, body)));
    doubts.extend(odd_reactions(case, mesh, &bodies));
    doubts.extend(unmoved(case));
    doubts.extend(all_prescribed(case, mesh, &bodies));
    doubts.extend(doubts_of_in_situ(case, mesh, &bodies));
    doubts.extend(measured_in_vain(case));
    doubts.extend(tables_in_vain(case));
    for (before, stage) in std::iter::once(case).chain(&case.later).zip(&case.later) {
        doubts.extend(steps_between(before, stage));
    }
    let (mut begin, mut before) = (0.0, None);
    for stage in std::iter::once(case).chain(&case.later) {
        doubts.extend(suctions(stage, mesh));
        doubts.extend(leaps(stage, begin, mesh, &bodies));
        doubts.extend(taken_at_once(stage, mesh));
        doubts.extend(doubts_of_loads(stage, before, begin, mesh, &bodies));
        (begin, before) = (stage.solver.end, Some(stage));
    }
    doubts
}

/// Elements that no body takes.
fn left_out(case: &Case, mesh: &Mesh, bodies: &[Own]) -> Option<Diagnostic> {
    let source = case.mesh.as_ref()?;
    if bodies.is_empty() || mesh.whole.is_some() {
        return None;
    }
    let is_plane = bodies.iter().all(|body| body.plane);
    let (count, what) = match is_plane {
        true => (mesh.triangles.len(), "triangles"),
        false => (mesh.tetrahedra.len(), "tetrahedra"),
    };
    let mut taken = vec![false; count];
    let used = case.groups_used();
    let whole = used.iter().filter(|(_, of)| matches!(of, GroupUse::Body | GroupUse::Filled | GroupUse::Tool));
    for group in whole.flat_map(|(group, _)| mesh.group(&group.value)) {
        let elements = if is_plane { &group.triangles } else { &group.tetrahedra };
        elements.iter().for_each(|&element| taken[element as usize] = true);
    }
    let left = taken.iter().filter(|taken| !**taken).count();
    if left == 0 {
        return None;
    }
    let [left, count] = [left, count].map(|count| grouped(&count.to_string()));
    let found = format!("= \"{}\": {left} of its {count} {what} are in no body", source.file.value.display());
    let note = Diagnostic::warning(Code::LeftOut, &source.file.place, found);
    Some(note.remedy("add a body for their group, or leave them out of the mesh"))
}

/// Groups of supports and loads whose nodes are in no body.
fn beyond_bodies(case: &Case, mesh: &Mesh, bodies: &[Own]) -> Vec<Diagnostic> {
    // Particles may fill what a group names.
    if bodies.is_empty() || case.bodies.iter().any(|body| !matches!(body.kind, BodyKind::Solid(_))) {
        return Vec::new();
    }
    let mut inside = vec![false; mesh.nodes.len()];
    bodies.iter().flat_map(|body| &body.nodes).for_each(|&node| inside[node as usize] = true);
    let acts = |of: &GroupUse| matches!(of, GroupUse::Support | GroupUse::Force | GroupUse::Facets);
    let doubt = |group: &Spanned<String>| {
        let nodes = mesh.group_nodes(&group.value);
        let beyond = nodes.iter().filter(|&&node| !inside[node as usize]).count();
        if beyond == 0 {
            return None;
        }
        let found = format!("= \"{}\": {beyond} of its {} nodes are in no body", group.value, nodes.len());
        let note = Diagnostic::warning(Code::BeyondBodies, &group.place, found);
        Some(note.remedy("what acts there is lost or falls on the others: add the body, or take a smaller group"))
    };
    case.groups_used().iter().filter(|(_, of)| acts(of)).filter_map(|(group, _)| doubt(group)).collect()
}

/// Plane bodies with common nodes and two thicknesses or plane states.
fn unequal_plates(mesh: &Mesh, bodies: &[Own]) -> Vec<Diagnostic> {
    let plates: Vec<&Own> = bodies.iter().filter(|body| body.plane).collect();
    let thickness = |body: &Own| body.solid.depth;
    let state = |body: &Own| if in_plane_stress(body) { "stress" } else { "strain" };
    let mut doubts = Vec::new();
    for (index, second) in plates.iter().enumerate() {
        let other = |first: &&&Own| thickness(first) != thickness(second) || state(first) != state(second);
        let mut marked =
            vec![false; if plates[..index].iter().any(|first| other(&first)) { mesh.nodes.len() } else { 0 }];
        if marked.is_empty() {
            continue;
        }
        second.nodes.iter().for_each(|&node| marked[node as usize] = true);
        // Both sides of an interface count as one.
        for [one, other] in mesh.cuts.iter().flat_map(|face| (0..3).map(|corner| face.sides.map(|side| side[corner]))) {
            if second.nodes.binary_search(&one).is_ok() || second.nodes.binary_search(&other).is_ok() {
                (marked[one as usize], marked[other as usize]) = (true, true);
            }
        }
        let touches = |first: &&&Own| first.nodes.iter().any(|&node| marked[node as usize]);
        if let Some(first) = plates[..index].iter().find(|first| other(first) && touches(first)) {
            let found = format!(
                "= \"{}\" has a thickness of {} in plane {}, and \"{}\", with which it has nodes or an interface in common, {} in plane {}",
                second.name.value,
                quantity(thickness(second), "m"),
                state(second),
                first.name.value,
                quantity(thickness(first), "m"),
                state(first)
            );
            let note = Diagnostic::warning(Code::UnequalPlates, &second.name.place, found);
            doubts
                .push(note.remedy("give both bodies the same thickness and plane state, unless the plate has a step"));
        }
    }
    doubts
}

/// Whether a plane body is free across its plane.
fn in_plane_stress(body: &Own) -> bool {
    body.plane && body.solid.plane.as_ref().is_some_and(|own| own.value == Plane::Stress)
}

/// A plane body without a thickness in a case of forces, which is one metre thick; or a plate in plane stress that is thicker than it is large.
fn thickness(case: &Case, mesh: &Mesh, body: &Own) -> Option<Diagnostic> {
    if let Some(thickness) = body.solid.thickness.as_ref().filter(|own| in_plane_stress(body) && own.value != 1.0) {
        let (low, high) = extent(mesh, std::slice::from_ref(body));
        let size = (high - low).max();
        if body.nodes.is_empty() || mesh.whole.is_some() || thickness.value <= size {
            return None;
        }
        let [thick, size] = [thickness.value, size].map(|length| quantity(length, "m"));
        let found = format!("makes a plate of {size} that is {thick} thick, in plane stress");
        let note = Diagnostic::warning(Code::Thickness, &thickness.place, found).expected("a plate, or plane strain");
        return Some(note.remedy("check its unit: a number without one is in metres"));
    }
    let force = |load: &Load| matches!(&load.kind, LoadKind::Force { .. });
    let in_newton = |probe: &Probe| matches!(&probe.kind, ProbeKind::Reaction(_) | ProbeKind::ContactForce(_));
    let forces = case.loads.iter().any(force) || case.probes.iter().any(in_newton);
    if !body.plane || body.nodes.is_empty() || body.solid.thickness.is_some() || body.solid.is_axisymmetric() || !forces
    {
        return None;
    }
    let found = format!(
        "= \"{}\" has no thickness: forces are those of a plate of {}",
        body.name.value,
        quantity(body.solid.depth, "m")
    );
    let note = Diagnostic::warning(Code::Thickness, &body.name.place, found);
    Some(note.remedy("set thickness; \"1 m\" says that forces per metre are meant"))
}

/// A material so incompressible that elements of constant strain are too stiff.
fn locking(case: &Case, body: &Own) -> Option<Diagnostic> {
    let material = &case.materials[body.solid.material];
    if material.poisson_ratio <= LOCKING || in_plane_stress(body) {
        return None;
    }
    let found = format!("has a Poisson's ratio of {}", material.poisson_ratio);
    let note = Diagnostic::warning(Code::Locking, &material.name.place, found).expected(format!("at most {LOCKING}"));
    Some(note.remedy("elements of constant strain lock: displacements are too small; take 0.45, or many more elements"))
}

/// A criterion by which the stress across a plate of plane strain counts, so that it does not bear its tensile strength.
fn counts_across(case: &Case, body: &Own) -> Option<Diagnostic> {
    let material = &case.materials[body.solid.material];
    let damage = material.damage.as_ref().filter(|_| body.solid.damage && body.plane)?;
    if body.solid.plane.as_ref().is_some_and(|plane| plane.value != Plane::Strain) {
        return None;
    }
    let law = &damage.value.law;
    // A pull with what keeps the plate as thick as it is.
    let pull = Sym3([1.0, 0.0, material.poisson_ratio, 0.0, 0.0, 0.0]);
    let strength = 1.0 / law.criterion.equivalent_stress(pull);
    if (strength - 1.0).abs() <= COUNTS {
        return None;
    }
    let found = format!(
        ".criterion = \"{}\" in plane strain: a pull breaks it at {strength:.2} of tensile_strength, and cracks cost {:.2} of fracture_energy",
        law.criterion.kind().name(),
        strength * strength
    );
    let note = Diagnostic::warning(Code::PlaneStrain, &damage.place, found);
    Some(
        note.remedy("take mohr-coulomb, which knows compression too and has its strength there, or plane = \"stress\""),
    )
}

/// Pressures that pull, on anything but a plane face: there a negative pressure is a way to write a tension.
fn suctions(case: &Case, mesh: &Mesh) -> Vec<Diagnostic> {
    let end = case.solver.end;
    let doubt = |kind: &LoadKind| {
        let LoadKind::Pressure { pressure, on, .. } = kind else { return None };
        if pressure.value.depends_on_position() || on.group.as_ref().is_some_and(|group| is_flat(mesh, &group.value)) {
            return None;
        }
        let at = |look: u32| pressure.value.value(end * f64::from(look) / f64::from(LOOKS), Vec3::zeros());
        let [low, high] = (0..=LOOKS).map(at).fold([0.0f64; 2], |[low, high], p| [low.min(p), high.max(p)]);
        if low >= 0.0 || -low < 1e-6 * high {
            return None;
        }
        let found = format!("is {} during the run: it pulls", quantity(low, "Pa"));
        let note =
            Diagnostic::warning(Code::Suction, &pressure.place, found).expected("a positive pressure, which pushes");
        Some(note.remedy("change its sign, or write a traction if it is to pull"))
    };
    case.loads.iter().filter_map(|load| doubt(&load.kind)).collect()
}

/// Whether all facets of a group have one normal.
fn is_flat(mesh: &Mesh, group: &str) -> bool {
    let mut normals = facet_normals(mesh, group).into_iter().map(|normal| normal.normalize());
    let Some(first) = normals.next() else { return false };
    normals.all(|normal| normal.dot(&first).abs() > FLAT)
}

/// Motions that leap: displacements at any time, and velocities that begin at once where the wave of it comes near the strength.
fn leaps(case: &Case, begin: f64, mesh: &Mesh, bodies: &[Own]) -> Vec<Diagnostic> {
    if case.solver.kind != SolverKind::Explicit {
        return Vec::new();
    }
    let mut doubts = Vec::new();
    for support in &case.supports {
        for (axis, motion) in support.motion.iter().enumerate() {
            let Some(motion) = motion else { continue };
            match &motion.value {
                Motion::Displacement(function) => doubts.extend(leap([begin, case.solver.end], motion, function)),
                Motion::Velocity(function) if !function.depends_on_position() => {
                    let nodes = nodes_of(mesh, &support.on);
                    let strikes = |body: &&Own| {
                        let meets = |node: &u32| body.nodes.binary_search(node).is_ok();
                        let rests = body.solid.initial_velocity[axis].is_none();
                        rests && nodes.as_ref().is_some_and(|nodes| nodes.iter().any(meets))
                    };
                    let speed = function.value(0.0, Vec3::zeros()).abs();
                    let struck = bodies.iter().filter(strikes);
                    doubts.extend(struck.filter_map(|body| strike(case, motion, body, speed)).next());
                }
                _ => {}
            }
        }
    }
    doubts
}

/// Velocities at the start that differ so much along an edge that it is torn within less than a passage of a wave through it.
fn torn_at_once(case: &Case, mesh: &Mesh, body: &Own) -> Option<Diagnostic> {
    let material = &case.materials[body.solid.material];
    let law = &material.damage.as_ref().filter(|_| body.solid.damage)?.value.law;
    let velocity = &body.solid.initial_velocity;
    let varies = velocity.iter().flatten().any(|field| field.value.constant_value().is_none());
    if !varies || mesh.whole.is_some() || case.solver.kind != SolverKind::Explicit {
        return None;
    }
    let at = |place: Vec3| Vec3::from_fn(|axis, _| velocity[axis].as_ref().map_or(0.0, |field| field.value.at(place)));
    let speeds: HashMap<u32, Vec3> = body.nodes.iter().map(|&node| (node, at(mesh.nodes[node as usize]))).collect();
    let parted = |nodes: &[u32]| -> Option<(f64, f64, Vec3)> {
        let pairs = (0..nodes.len()).flat_map(|i| (0..i).map(move |j| [nodes[i], nodes[j]]));
        let speed = |[a, b]: [u32; 2]| {
            let (from, to) = (mesh.nodes[a as usize], mesh.nodes[b as usize]);
            let length = (to - from).norm();
            ((speeds[&b] - speeds[&a]).dot(&(to - from)) / length, length, (from + to) * 0.5)
        };
        pairs.map(speed).max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let fastest = match body.elements(mesh) {
        SolidElements::Tetrahedra(all) => {
            all.iter().filter_map(|nodes| parted(nodes)).max_by(|a, b| a.0.total_cmp(&b.0))
        }
        SolidElements::Triangles(all) => {
            all.iter().filter_map(|nodes| parted(nodes)).max_by(|a, b| a.0.total_cmp(&b.0))
        }
    };
    let (speed, length, place) = fastest?;
    let wave = (material.young_modulus / material.density).sqrt();
    let breaks = 0.5 * speed * material.density * wave > law.tensile_strength;
    let opened = speed * length / wave;
    if !breaks || opened <= TORN * 2.0 * law.fracture_energy / law.tensile_strength {
        return None;
    }
    let found = format!(
        "= \"{}\": its initial_velocity parts an edge of {} at ({:.4e}, {:.4e}, {:.4e}) m by {} at once: it is torn before a wave has passed, and \
         takes less than its fracture energy",
        body.name.value,
        quantity(length, "m"),
        place.x,
        place.y,
        place.z,
        quantity(speed, "m/s")
    );
    let note = Diagnostic::warning(Code::Jump, &body.name.place, found);
    Some(note.remedy("let the velocity change over some elements, or take smaller ones there"))
}

/// Displacements that begin a stage elsewhere than where those of the stage before have ended.
fn steps_between(before: &Case, stage: &Case) -> Vec<Diagnostic> {
    let at = before.solver.end;
    let displaced = |motion: &Option<Spanned<Motion>>| match motion.as_ref().map(|motion| &motion.value) {
        Some(Motion::Displacement(function)) if !function.depends_on_position() => {
            Some(function.value(at, Vec3::zeros()))
        }
        _ => None,
    };
    let mut doubts = Vec::new();
    for support in &stage.supports {
        let Some(group) = support.on.group.as_ref().filter(|_| support.on.within.is_none()) else { continue };
        let is_same =
            |on: &Selection| on.within.is_none() && on.group.as_ref().is_some_and(|own| own.value == group.value);
        let earlier = before.supports.iter().filter(|earlier| is_same(&earlier.on));
        for (earlier, axis) in earlier.flat_map(|earlier| (0..3).map(move |axis| (earlier, axis))) {
            let (Some(motion), Some(from), Some(to)) =
                (&support.motion[axis], displaced(&earlier.motion[axis]), displaced(&support.motion[axis]))
            else {
                continue;
            };
            if (to - from).abs() > STEP * from.abs().max(to.abs()) {
                let [way, from] = [to - from, from].map(|length| quantity(length, "m"));
                let found = format!("leaps by {way} as stage \"{}\" begins, from {from}", stage.source.stage);
                let note = Diagnostic::warning(Code::Jump, &motion.place, found);
                doubts.push(note.remedy("displacements count from the start of the run: begin with the one before"));
            }
        }
    }
    doubts
}

/// A displacement that leaps.
fn leap([begin, end]: [f64; 2], motion: &Spanned<Motion>, function: &TimeFunction) -> Option<Diagnostic> {
    if function.depends_on_position() {
        return None;
    }
    let at = |look: u32| begin + (end - begin) * f64::from(look) / f64::from(LOOKS);
    let values: Vec<f64> = (0..=LOOKS).map(|look| function.value(at(look), Vec3::zeros())).collect();
    let range = values.iter().fold(0.0f64, |range, value| range.max(value.abs()));
    let look = values.windows(2).position(|pair| (pair[1] - pair[0]).abs() > LEAP * range)?;
    // A steep ramp changes little within a part of the interval, a leap does not.
    let (mut low, mut high) = (at(look as u32), at(look as u32 + 1));
    for _ in 0..20 {
        let middle = 0.5 * (low + high);
        let [a, b, c] = [low, middle, high].map(|time| function.value(time, Vec3::zeros()));
        if (b - a).abs() >= (c - b).abs() { high = middle } else { low = middle }
    }
    let way = function.value(high, Vec3::zeros()) - function.value(low, Vec3::zeros());
    if way.abs() <= LEAP * range {
        return None;
    }
    let found = format!("leaps by {} at t = {}", quantity(way, "m"), quantity(high, "s"));
    let note = Diagnostic::warning(Code::Jump, &motion.place, found);
    Some(note.remedy("let it change by a ramp of some periods of the body: a leap is a blow"))
}

/// A velocity that begins at once.
fn strike(case: &Case, motion: &Spanned<Motion>, body: &Own, speed: f64) -> Option<Diagnostic> {
    let material = &case.materials[body.solid.material];
    let damage = material.damage.as_ref().filter(|_| body.solid.damage)?;
    let stress = speed * (material.density * material.young_modulus).sqrt();
    let share = stress / damage.value.law.tensile_strength;
    if share <= JUMP {
        return None;
    }
    let found = format!(
        "begins at {} at once: the wave of it has {} of the tensile strength",
        quantity(speed, "m/s"),
        percent(share)
    );
    let note = Diagnostic::warning(Code::Jump, &motion.place, found);
    Some(note.remedy("let it begin at zero, by a ramp, unless the body is struck"))
}
