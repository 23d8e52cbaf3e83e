//! Doubts about how bodies are held, how they meet, and how finely they are meshed.

use std::collections::HashMap;

use fractum_fem::Formulation;
use fractum_math::{Vec3, connected};
use fractum_mesh::Mesh;
use fractum_mesh::bodies::{SLENDER, SolidElements};
use fractum_output::number::{percent, quantity};
use fractum_output::warning::Code;

use crate::model::{
    BodyKind, Case, LoadKind, Motion, RigidShape, Selection, SolidBody, SolverKind, Support, SurfaceSupport,
};
use crate::{Diagnostic, Place, Spanned, TimeFunction};

/// Share of the deflection of a bent body above which it is told that its elements take it away.
const TOO_STIFF: f64 = 0.05;
/// Passages of a wave through a body after which it should be held.
const PASSAGES: f64 = 10.0;

/// A solid body of the case with its nodes in the mesh, ascending.
pub(super) struct Own<'a> {
    pub(super) name: &'a Spanned<String>,
    pub(super) solid: &'a SolidBody,
    pub(super) nodes: Vec<u32>,
    pub(super) plane: bool,
}

/// Bodies that hang together by common nodes or by interfaces, as the number of each one's first.
pub(super) fn pieces(mesh: &Mesh, bodies: &[Own]) -> Vec<u32> {
    // The nodes of both sides of an interface count as one.
    let sides = mesh.cuts.iter().flat_map(|face| (0..3).map(|corner| face.sides.map(|side| side[corner])));
    let same: HashMap<u32, u32> = sides.map(|[first, second]| (second, first)).collect();
    let one = |node: u32| same.get(&node).copied().unwrap_or(node);
    let of_body = |(body, own): (u32, &Own)| own.nodes.iter().map(move |&node| (node, body)).collect::<Vec<_>>();
    let mut owners: Vec<(u32, u32)> = (0..).zip(bodies).flat_map(of_body).collect();
    owners.extend(owners.clone().into_iter().map(|(node, body)| (one(node), body)));
    owners.sort_unstable();
    let shared = owners.windows(2).filter(|pair| pair[0].0 == pair[1].0);
    connected(bodies.len(), shared.map(|pair| [pair[0].1, pair[1].1]))
}

/// Nodes that are meant, ascending; none of sets of particles.
pub(super) fn nodes_of(mesh: &Mesh, on: &Selection) -> Option<Vec<u32>> {
    let mut nodes = match &on.group {
        Some(group) => mesh.group_nodes(&group.value),
        None => (0..mesh.nodes.len() as u32).collect(),
    };
    if let Some(within) = &on.within {
        nodes.retain(|&node| within.value.holds_at(mesh.nodes[node as usize]));
    }
    (!nodes.is_empty()).then_some(nodes)
}

impl Own<'_> {
    /// Those of its nodes that a selection means, ascending.
    fn nodes_of(&self, mesh: &Mesh, on: &Selection) -> Vec<u32> {
        let mut nodes = nodes_of(mesh, on).unwrap_or_default();
        nodes.retain(|node| self.nodes.binary_search(node).is_ok());
        nodes
    }

    /// Its elements.
    pub(super) fn elements(&self, mesh: &Mesh) -> SolidElements {
        let groups = mesh.group(&self.solid.group.value);
        if self.plane {
            let members = groups.iter().flat_map(|group| &group.triangles);
            SolidElements::Triangles(members.map(|&element| mesh.triangles[element as usize]).collect())
        } else {
            let members = groups.iter().flat_map(|group| &group.tetrahedra);
            SolidElements::Tetrahedra(members.map(|&element| mesh.tetrahedra[element as usize]).collect())
        }
    }
}

/// What a message says of a selection behind its key: the group; nothing of a condition.
pub(super) fn named(on: &Selection) -> String {
    on.group.as_ref().map_or_else(String::new, |group| format!("= \"{}\"", group.value))
}

/// What moves or loads a piece at one place.
struct Driven<'a> {
    place: &'a Place,
    nodes: Vec<u32>,
}

fn driven<'a>(mesh: &Mesh, on: &'a Selection) -> Option<Driven<'a>> {
    Some(Driven { place: on.place()?, nodes: nodes_of(mesh, on)? })
}

/// Solids that are moved, or loaded by a force, at one place and that nothing holds for long.
pub(super) fn unheld(case: &Case, mesh: &Mesh, bodies: &[Own]) -> Option<Diagnostic> {
    let alone = case.bodies.iter().all(|body| matches!(body.kind, BodyKind::Solid(_)));
    let moves = case.solver.kind == SolverKind::Explicit && case.later.is_empty() && case.in_situ.is_none();
    if bodies.is_empty()
        || !alone
        || !moves
        || mesh.whole.is_some()
        || pieces(mesh, bodies).iter().any(|piece| *piece != 0)
    {
        return None;
    }
    let thrown = bodies.iter().any(|body| body.solid.initial_velocity.iter().any(Option::is_some));
    let held = case.supports.iter().any(|support| {
        support.surface.is_some() || support.motion.iter().flatten().any(|motion| is_at_rest(&motion.value))
    });
    if thrown || held {
        return None;
    }
    let by_supports = case.supports.iter().map(|support| driven(mesh, &support.on));
    let forces = case.loads.iter().filter_map(|load| match &load.kind {
        LoadKind::Force { on, .. } | LoadKind::Traction { on, .. } => Some(driven(mesh, on)),
        _ => None,
    });
    let all: Vec<Driven> = by_supports.chain(forces).collect::<Option<_>>()?;
    let [one] = all.as_slice() else { return None };
    // What is prescribed all over the body needs no other hold.
    let whole: usize = bodies.iter().map(|body| body.nodes.len()).sum();
    if 2 * one.nodes.len() > whole {
        return None;
    }
    let passage = passage(case, mesh, bodies);
    if case.solver.end < PASSAGES * passage {
        return None;
    }
    let found = format!(
        ": it alone acts on the bodies, which nothing holds: the run lasts {:.0} passages of a wave ({} each)",
        case.solver.end / passage,
        quantity(passage, "s")
    );
    let note = Diagnostic::warning(Code::Unheld, one.place, found);
    Some(note.remedy("support the bodies elsewhere; what is thrown needs an initial_velocity"))
}

/// Solids that one support moves along an axis along which nothing else acts on them: they follow it without strain.
pub(super) fn moved_as_a_whole(case: &Case, mesh: &Mesh, bodies: &[Own]) -> Option<Diagnostic> {
    let alone = case.bodies.iter().all(|body| matches!(body.kind, BodyKind::Solid(_)));
    let flows = case.flows.gas.is_some() || case.flows.heat.is_some() || case.flows.liquid.is_some();
    let acted = !case.loads.is_empty() || case.in_situ.is_some() || flows || !case.later.is_empty();
    let thrown = bodies.iter().any(|body| body.solid.initial_velocity.iter().any(Option::is_some));
    let springs = case.supports.iter().any(|support| support.surface.is_some());
    let pressed = case.interfaces.iter().any(|interface| interface.pressure.is_some());
    if bodies.is_empty() || !alone || acted || thrown || springs || pressed || mesh.whole.is_some() {
        return None;
    }
    if pieces(mesh, bodies).iter().any(|piece| *piece != 0) {
        return None;
    }
    match case.solver.kind {
        SolverKind::Static => {}
        SolverKind::Explicit if case.solver.end >= PASSAGES * passage(case, mesh, bodies) => {}
        _ => return None,
    }
    let moves = |motion: &Option<Spanned<Motion>>| motion.as_ref().is_some_and(|own| !is_at_rest(&own.value));
    let mut driving = case.supports.iter().filter(|support| support.motion.iter().any(moves));
    let (support, None) = (driving.next()?, driving.next()) else { return None };
    let one = driven(mesh, &support.on)?;
    let lies_around = bodies.iter().any(|body| body.solid.is_axisymmetric());
    let is_free = |axis: usize| {
        let function = support.motion[axis].as_ref().map(|motion| &motion.value);
        let Some(Motion::Displacement(function) | Motion::Velocity(function)) = function else { return true };
        let holding = case.supports.iter().filter(|other| other.motion[axis].is_some()).count();
        let is_pinned = function.depends_on_position() || function.is_zero() || lies_around && axis == 0;
        holding == 1 && !is_pinned
    };
    if !(0..3).all(is_free) {
        return None;
    }
    let along: Vec<&str> =
        (0..3).filter(|&axis| moves(&support.motion[axis])).map(|axis| ["x", "y", "z"][axis]).collect();
    let along = along.join(" and ");
    let found = format!(
        "{}: it moves the bodies along {along}, and nothing holds them there: they follow without strain",
        named(&support.on)
    );
    let note = Diagnostic::warning(Code::Unheld, one.place, found);
    Some(note.remedy(format!("hold another side along {along}")))
}

/// Solids in motion that lasting forces or a weight push along an axis along which no support holds them, though supports act on them. A
/// weight beside absorbing supports alone is told of a short run too.
pub(super) fn pushed_away(case: &Case, mesh: &Mesh, bodies: &[Own]) -> Option<Diagnostic> {
    let alone = case.bodies.iter().all(|body| matches!(body.kind, BodyKind::Solid(_)));
    let moves = case.solver.kind == SolverKind::Explicit && case.later.is_empty() && case.in_situ.is_none();
    let thrown = bodies.iter().any(|body| body.solid.initial_velocity.iter().any(Option::is_some));
    let flows = case.flows.gas.is_some() || case.flows.heat.is_some();
    let pushed = flows || case.interfaces.iter().any(|interface| interface.pressure.is_some());
    if bodies.is_empty() || !alone || !moves || thrown || pushed || case.supports.is_empty() || mesh.whole.is_some() {
        return None;
    }
    if pieces(mesh, bodies).iter().any(|piece| *piece != 0) {
        return None;
    }
    let (passage, end) = (passage(case, mesh, bodies), case.solver.end);
    // What stands for ground that goes on should bear a weight from the start.
    let absorbs =
        |support: &Support| support.surface.as_ref().is_some_and(|own| own.value == SurfaceSupport::Absorbing);
    let grounded = case.supports.iter().any(absorbs);
    let soon = end < PASSAGES * passage;
    if soon && !grounded {
        return None;
    }
    let lies_around = bodies.iter().any(|body| body.solid.is_axisymmetric());
    let free = |axis: &usize| {
        let springs = |support: &Support| {
            support.surface.as_ref().is_some_and(|surface| surface.value != SurfaceSupport::Absorbing)
        };
        let held = case.supports.iter().any(|support| support.motion[*axis].is_some() || springs(support));
        !(held || lies_around && *axis == 0)
    };
    // One sense of a push that lasts; none of one that ends or turns back.
    let sense = |function: &TimeFunction| {
        let at = |share: f64| function.value(share * end, Vec3::zeros());
        let [middle, last] = [at(0.5), at(1.0)];
        (!function.depends_on_position() && middle * last > 0.0).then(|| last.signum())
    };
    let (axis, place) = (0..3).filter(free).find_map(|axis| {
        let mut along = case.loads.iter().filter_map(|load| match &load.kind {
            LoadKind::Gravity { acceleration: components } => components[axis].as_ref(),
            LoadKind::Force { force: components, .. } | LoadKind::Traction { traction: components, .. } if !soon => {
                components[axis].as_ref()
            }
            _ => None,
        });
        let first = along.next()?;
        let one = sense(&first.value)?;
        along.all(|other| sense(&other.value) == Some(one)).then_some((axis, &first.place))
    })?;
    let along = ["x", "y", "z"][axis];
    let found = format!(
        ": it pushes the bodies along {along}, along which nothing holds them: the run lasts {:.0} passages of a wave ({} each)",
        end / passage,
        quantity(passage, "s")
    );
    let note = Diagnostic::warning(Code::Unheld, place, found);
    Some(note.remedy(format!("hold them along {along} somewhere; absorbing supports hold nothing")))
}

/// Speed of a wave along a bar of the material of a body [m/s].
pub(super) fn wave_speed(case: &Case, body: &Own) -> f64 {
    let material = &case.materials[body.solid.material];
    (material.young_modulus / material.density).sqrt()
}

/// Time that a wave needs to pass through all bodies [s].
pub(super) fn passage(case: &Case, mesh: &Mesh, bodies: &[Own]) -> f64 {
    let (low, high) = extent(mesh, bodies);
    let slowest = bodies.iter().map(|body| wave_speed(case, body)).fold(f64::INFINITY, f64::min);
    (high - low).norm() / slowest
}

/// The box around some bodies [m].
pub(super) fn extent(mesh: &Mesh, bodies: &[Own]) -> (Vec3, Vec3) {
    let infinite = Vec3::repeat(f64::INFINITY);
    let places = bodies.iter().flat_map(|body| &body.nodes).map(|&node| mesh.nodes[node as usize]);
    places.fold((infinite, -infinite), |(low, high), x| (low.inf(&x), high.sup(&x)))
}

/// Few elements through the thickness of a body that is bent.
///
/// - `is_alone`: whether nothing is joined to it, so that its thickness is that of what bends
pub(super) fn thin(case: &Case, mesh: &Mesh, body: &Own, is_alone: bool) -> Option<Diagnostic> {
    if mesh.whole.is_some() || body.nodes.is_empty() || !is_bent(case, mesh, body) {
        return None;
    }
    let elements = body.elements(mesh);
    let vibrates = case.solver.kind == SolverKind::Modes;
    let (found, remedy) = match elements.layers() {
        Some(few) => (
            format!(
                "it has {} through its thickness, and {}",
                if few == 1 { "one element" } else { "two elements" },
                if vibrates { "bends as it vibrates" } else { "is bent" }
            ),
            "take three through the thickness, better six".to_string(),
        ),
        None if !is_alone => return None,
        None => {
            let stiffening = stiffening(mesh, body, &elements);
            let lost = stiffening / (1.0 + stiffening);
            if lost < TOO_STIFF {
                return None;
            }
            let smoothed = if body.solid.formulation == Formulation::Smoothed {
                ""
            } else {
                ", or formulation = \"smoothed\", which loses less"
            };
            let times = (stiffening / (0.5 * TOO_STIFF)).sqrt();
            let found = if vibrates {
                let raised = (1.0 + stiffening).sqrt() - 1.0;
                format!("it bends as it vibrates, and its elements make that some {} too fast", percent(raised))
            } else {
                format!("it is bent, and its elements take some {} of the deflection away", percent(lost))
            };
            (found, format!("take elements {times:.1} times as small{smoothed}"))
        }
    };
    let found = format!("= \"{}\": {found}", body.name.value);
    let note = Diagnostic::warning(Code::ThinMesh, &body.name.place, found);
    Some(note.remedy(format!("linear elements are too stiff in bending: {remedy}")))
}

/// What linear elements add to the stiffness of a bent body, over that stiffness: they answer bending by shear, with k (L/h)² of a longest edge L and the
/// thickness h. Cantilevers of one to six elements have k = 1.5 for triangles of any shape and 1.2 for tetrahedra. Smoothed triangles have none where they are
/// equilateral, and 0.6 where they are right ones; smoothed tetrahedra have 0.1.
fn stiffening(mesh: &Mesh, body: &Own, elements: &SolidElements) -> f64 {
    let smoothed = body.solid.formulation == Formulation::Smoothed;
    let corners = |element: &[u32]| element.iter().map(|&node| mesh.nodes[node as usize]).collect::<Vec<Vec3>>();
    let longest = |at: &[Vec3]| {
        let pairs = at.iter().flat_map(|a| at.iter().map(move |b| (a - b).norm_squared()));
        pairs.fold(0.0, f64::max)
    };
    let of_triangle = |element: &[u32; 3]| {
        let at = corners(element);
        let (area, longest) = (0.5 * (at[1] - at[0]).cross(&(at[2] - at[0])).norm(), longest(&at));
        // 2.3 of an equilateral one, 4 of a right one.
        let shape = longest / area;
        (area, longest * if smoothed { (0.35 * (shape - 2.3)).clamp(0.0, 0.6) } else { 1.5 })
    };
    let of_tetrahedron = |element: &[u32; 4]| {
        let at = corners(element);
        let volume = (at[1] - at[0]).cross(&(at[2] - at[0])).dot(&(at[3] - at[0])).abs();
        (volume, longest(&at) * if smoothed { 0.1 } else { 1.2 })
    };
    let parts: Vec<(f64, f64)> = match elements {
        SolidElements::Triangles(all) => all.iter().map(of_triangle).collect(),
        SolidElements::Tetrahedra(all) => all.iter().map(of_tetrahedron).collect(),
    };
    let (whole, sum) = parts.into_iter().fold((0.0, 0.0), |(whole, sum), (part, k)| (whole + part, sum + part * k));
    let (low, high) = extent(mesh, std::slice::from_ref(body));
    let axes = if body.plane { 0..2 } else { 0..3 };
    let thickness = axes.map(|axis| (high - low)[axis]).fold(f64::INFINITY, f64::min);
    sum / (whole * thickness * thickness)
}

/// Whether a slender body is bent: moved, loaded, pressed by round tools or heated on one side across, along an axis of the case along which it
/// is thin; or free to bend as it vibrates.
fn is_bent(case: &Case, mesh: &Mesh, body: &Own) -> bool {
    let (low, high) = extent(mesh, std::slice::from_ref(body));
    let size = high - low;
    let axes = if body.plane { 0..2 } else { 0..3 };
    let sizes = axes.clone().map(|axis| size[axis]);
    let [least, most] = sizes.fold([f64::INFINITY, 0.0], |[least, most], one| [least.min(one), most.max(one)]);
    if SLENDER * least > most {
        return false;
    }
    let own = |on: &Selection| body.nodes_of(mesh, on);
    let held: Vec<Vec<u32>> = case.supports.iter().map(|support| own(&support.on)).collect();
    // What is guided along its length does not bend.
    if held.iter().any(|nodes| 5 * nodes.len() > 2 * body.nodes.len()) {
        return false;
    }
    let is_held = held.iter().any(|nodes| !nodes.is_empty());
    let at = |node: &u32| mesh.nodes[*node as usize];
    let flat = |nodes: &[u32], axis: usize| {
        let places = nodes.iter().map(|node| at(node)[axis]);
        let [low, high] = places.fold([f64::INFINITY, -f64::INFINITY], |[l, h], x| [l.min(x), h.max(x)]);
        high - low < 0.1 * least
    };
    // Nor does what lies with a whole side on a support.
    let lies = |axis: usize| {
        [low[axis], high[axis]].into_iter().any(|side| {
            let is_there = |node: &u32| (at(node)[axis] - side).abs() < 1e-6 * least;
            let all = body.nodes.iter().filter(|node| is_there(node)).count();
            let holds = |nodes: &Vec<u32>| 10 * nodes.iter().filter(|node| is_there(node)).count() > 9 * all;
            case.supports.iter().zip(&held).any(|(support, nodes)| support.motion[axis].is_some() && holds(nodes))
        })
    };
    let bends = |axis: usize| {
        let moved = |motion: &Option<Spanned<Motion>>| motion.as_ref().is_some_and(|motion| !is_at_rest(&motion.value));
        let by_support =
            case.supports.iter().zip(&held).any(|(support, nodes)| !nodes.is_empty() && moved(&support.motion[axis]));
        let by_load = case.loads.iter().any(|load| match &load.kind {
            LoadKind::Force { on, force: components } | LoadKind::Traction { on, traction: components } => {
                components[axis].is_some() && !own(on).is_empty()
            }
            LoadKind::Gravity { acceleration } => acceleration[axis].is_some(),
            other => {
                let LoadKind::Pressure { on, .. } = other else { return false };
                let nodes = own(on);
                !nodes.is_empty() && flat(&nodes, axis)
            }
        });
        let [round_driven, round_still] = round_tools(case, axis);
        let by_tool = round_driven && (is_held || round_still);
        let pushed = by_support || by_load || body.solid.initial_velocity[axis].is_some();
        (pushed && is_held) || by_tool || is_heated_across(case, mesh, body, axis)
    };
    let vibrates = case.solver.kind == SolverKind::Modes;
    axes.filter(|&axis| size[axis] <= 1.1 * least).any(|axis| !lies(axis) && (vibrates || bends(axis)))
}

/// Whether round rigid bodies move along an axis, and whether others stand still: rollers and noses of a bending test.
fn round_tools(case: &Case, axis: usize) -> [bool; 2] {
    let mut found = [false; 2];
    for body in &case.bodies {
        let BodyKind::Rigid(rigid) = &body.kind else { continue };
        let is_round = match &rigid.shape {
            RigidShape::Cylinder { axis: along, .. } => along[axis].abs() < 0.1,
            RigidShape::Sphere { .. } => true,
            _ => false,
        };
        if is_round && !rigid.inside {
            let moves = rigid.velocity[axis].is_some() || rigid.free[axis] || rigid.servo.is_some();
            found[usize::from(!moves)] = true;
        }
    }
    found
}

/// Whether a body that expands is heated on one of its two sides across an axis alone, or unevenly from one to the other.
fn is_heated_across(case: &Case, mesh: &Mesh, body: &Own, axis: usize) -> bool {
    let Some(heat) = &case.flows.heat else { return false };
    let thermal = case.materials[body.solid.material].thermal.as_ref();
    if case.solver.kind == SolverKind::Heat || thermal.is_none_or(|thermal| thermal.value.expansion == 0.0) {
        return false;
    }
    let (low, high) = extent(mesh, std::slice::from_ref(body));
    let sides = [low[axis], high[axis]];
    let mut is_heated = [false; 2];
    for condition in &heat.conditions {
        let nodes = body.nodes_of(mesh, &condition.on);
        if nodes.is_empty() {
            continue;
        }
        let function = &condition.kind.function().value;
        let at = |side: f64| {
            let mut place = 0.5 * (low + high);
            place[axis] = side;
            function.value(0.5 * case.solver.end, place)
        };
        if function.depends_on_position() && at(sides[0]) != at(sides[1]) {
            return true;
        }
        for (side, is_heated) in sides.into_iter().zip(&mut is_heated) {
            let is_near = |node: &u32| (mesh.nodes[*node as usize][axis] - side).abs() < 0.1 * (sides[1] - sides[0]);
            *is_heated |= nodes.iter().all(is_near);
        }
    }
    is_heated[0] != is_heated[1]
}

fn is_at_rest(motion: &Motion) -> bool {
    matches!(motion, Motion::Fixed)
}
