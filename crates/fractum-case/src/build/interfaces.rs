//! Interfaces between elements: the mesh is cut along them before anything is built, and their faces go to the scene.

use std::collections::{BTreeMap, HashSet};

use fractum_fem::{ElementKind, Solid};
use fractum_math::Vec3;
use fractum_mesh::{CutAlong, CutError, Mesh};
use fractum_output::number::quantity;
use fractum_output::warning::Code;
use fractum_scene::{CrackMeasure, InsidePressure, InterfaceFace, InterfaceKind, Interfaces, Scene, SpringInterface};

use super::bodies::{Numbering, Part, element_nodes};
use super::doubts::ZONES;
use super::{Context, function};
use crate::model::{Case, Interface, InterfaceFaces, Load, LoadKind, ProbeKind, SolverKind};
use crate::read::interfaces::LEAST_DUCTILITY;
use crate::{Diagnostic, Diagnostics, Place, nearest};

/// Elements in a process zone below which it is not resolved.
const IN_ZONE: f64 = 3.0;
/// Slip over the largest extent of the solids beyond which no joint wears or rises.
const LONG: f64 = 0.1;
/// How much stiffer than an element an interface is at rest that is to be stiff: it gives way by a hundredth of one.
const FIRM: f64 = 100.0;
/// The same of a bonded one that liquid flows in: what it gives way to the stress that presses on it counts as its opening.
const FIRM_IF_WET: f64 = 1e4;
/// Most that the stiffness across or along such an interface is of the other: beyond it corners of faces that are pressed together slide by turns.
const FIRMEST: f64 = 16.0;

/// Cuts a mesh along the interfaces of a case.
///
/// # Errors
/// Groups that are not there, and faces that are not inside of the mesh.
pub fn cut_mesh(case: &Case, mesh: &mut Mesh) -> Result<(), Diagnostics> {
    if case.interfaces.is_empty() {
        return Ok(());
    }
    let names = mesh.group_names();
    let groups = case.interfaces.iter().flat_map(|interface| interface.along.groups());
    let unknown = groups.filter(|group| !names.contains(&group.value.as_str())).map(|group| {
        let note = Diagnostic::error(&group.place, format!("= \"{}\"", group.value));
        let note = note.expected(format!("a physical group of the mesh; groups there: {}", names.join(", ")));
        match nearest(&group.value, names.iter().copied()) {
            Some(near) => note.remedy(format!("did you mean \"{near}\"?")),
            None => note,
        }
    });
    let unknown: Vec<Diagnostic> = unknown.collect();
    if !unknown.is_empty() {
        return Err(Diagnostics::of_many(unknown));
    }
    let between =
        |along: &InterfaceFaces| -> Vec<String> { along.groups().iter().map(|group| group.value.clone()).collect() };
    let lists: Vec<Vec<String>> = case.interfaces.iter().map(|interface| between(&interface.along)).collect();
    let cuts = case.interfaces.iter().zip(&lists).map(|(interface, groups)| match &interface.along {
        InterfaceFaces::Group(group) => CutAlong::Group(&group.value),
        InterfaceFaces::Between(_) => CutAlong::Between(groups),
    });
    let cuts: Vec<CutAlong> = cuts.collect();
    mesh.cut(&cuts).map_err(|(number, error)| {
        let interface = &case.interfaces[number];
        let place = match &interface.along {
            InterfaceFaces::Group(group) => &group.place,
            InterfaceFaces::Between(groups) => &groups.place,
        };
        let note = Diagnostic::error(place, format!(": {error}"));
        let apart = matches!(error, CutError::NothingBetween { .. });
        let remedy = if apart && case.mesh.as_ref().is_some_and(|mesh| mesh.join.is_none()) {
            "set mesh.join = true where both have nodes at the same positions; else let them share a face (Gmsh: BooleanFragments)"
        } else {
            "embed the surface in its volume (Gmsh: BooleanFragments, or Line{...} In Surface{...}) and give it a physical group"
        };
        Diagnostics::of_many(vec![note.expected("faces with elements on both sides").remedy(remedy)])
    })
}

/// Facets of interfaces, which are no surface of the solids, by their nodes in the scene.
pub(super) fn inner_facets(context: &Context<'_>, numbering: &Numbering) -> HashSet<[u32; 3]> {
    let scene = |n: u32| numbering.scene_node[n as usize];
    let sides = context.mesh.cuts.iter().flat_map(|face| face.sides);
    sides.map(|side| by_nodes(side.map(scene))).collect()
}

/// A facet by its nodes alone; an edge repeats the higher one.
pub(super) fn by_nodes([a, b, c]: [u32; 3]) -> [u32; 3] {
    if b == c { [a.min(b), a.max(b), a.max(b)] } else { super::ties::sorted([a, b, c]) }
}

/// The scene with its interfaces.
pub(super) fn with_interfaces(context: &mut Context<'_>, scene: Scene, parts: &[Part], numbering: &Numbering) -> Scene {
    if context.mesh.cuts.is_empty() {
        return scene;
    }
    check_installed(context, parts);
    let case = context.case;
    let owner = |element: u32| {
        let own =
            |(body, part): (usize, &Part)| Some((body as u32, part.elements.binary_search(&element).ok()? as u32));
        parts.iter().enumerate().find_map(own)
    };
    let node = |n: u32| numbering.scene_node[n as usize];
    let (mut faces, mut outside) = (Vec::new(), vec![0usize; case.interfaces.len()]);
    for face in &context.mesh.cuts {
        let [first, second] = face.elements.map(owner);
        match first.zip(second) {
            Some((first, second)) => faces.push(InterfaceFace {
                kind: face.cut,
                sides: face.sides.map(|side| side.map(node)),
                elements: [first, second],
            }),
            None => outside[face.cut as usize] += 1,
        }
    }
    for (interface, count) in case.interfaces.iter().zip(outside).filter(|(_, count)| *count > 0) {
        let found = format!(": {count} of its faces have an element beside them that belongs to no solid body");
        context.error(&interface.place, found, "faces inside of solid bodies");
    }
    let kinds = (0u32..).zip(&case.interfaces).map(|(kind, interface)| InterfaceKind {
        name: interface.name.clone(),
        law: interface.law,
        stiffness: interface
            .stiffness
            .or_else(|| comes_to_rest(case).then(|| firm(&scene.solid, &faces, kind, interface, case))),
    });
    let kinds: Vec<InterfaceKind> = kinds.collect();
    for (kind, interface) in kinds.iter().zip(&case.interfaces).filter(|(_, given)| given.stiffness.is_none()) {
        let Some(stiffness) = kind.stiffness else { continue };
        if (SpringInterface { law: kind.law, stiffness }).least_ductility() < LEAST_DUCTILITY {
            let found = ": its faces are so large that softening has no equilibrium";
            context.error(&interface.place, found, "smaller elements along it, or a normal_stiffness");
        }
    }
    let pressures = case.interfaces.iter().map(|interface| {
        let (value, in_broken) = interface.pressure.as_ref()?;
        Some(InsidePressure { value: function(&value.value), in_broken: *in_broken })
    });
    let interfaces = Interfaces::new(&scene.solid, kinds, faces).with_pressures(pressures.collect());
    scene.with_interfaces(interfaces)
}

/// The mesh is cut from the start, and with it what comes in later: interfaces must end before that.
fn check_installed(context: &mut Context<'_>, parts: &[Part]) {
    let (mesh, case) = (context.mesh, context.case);
    let Some(excavation) = case.excavation.as_ref().filter(|_| case.is_first_stage()) else { return };
    // Nodes that stand twice, with the interface that has doubled them.
    let corners = mesh.cuts.iter().flat_map(|face| (0..3).map(|k| (face.cut, face.sides.map(|side| side[k]))));
    let doubled: BTreeMap<u32, u32> =
        corners.filter(|(_, [a, b])| a != b).flat_map(|(cut, pair)| pair.map(|node| (node, cut))).collect();
    for part in parts.iter().filter(|part| excavation.to_come.iter().any(|name| name == part.name)) {
        let mut nodes = element_nodes(context, part).into_iter().flatten();
        let Some((node, cut)) = nodes.find_map(|node| Some((node, *doubled.get(&node)?))) else { continue };
        let (interface, at) = (&case.interfaces[cut as usize], mesh.nodes[node as usize]);
        let found = format!(
            ": it cuts body \"{}\", which comes in later, at ({:.4e}, {:.4e}, {:.4e}) m",
            part.name, at.x, at.y, at.z
        );
        let note = Diagnostic::error(&interface.place, found).expected("interfaces that end where such a body begins");
        context.diagnostics.push(note.remedy("name the groups beside it alone, in mesh.joints[].within or in between"));
    }
}

/// Whether some stage of a case is at rest.
fn comes_to_rest(case: &Case) -> bool {
    std::iter::once(case).chain(&case.later).any(|stage| stage.solver.kind == SolverKind::Static)
}

/// Stiffness of an interface at rest that is to be stiff until its strength is met [Pa/m]: with [`FIRM`] or [`FIRM_IF_WET`] times that of an element of the stiffer side over
/// the size of its smallest face, and those across and along it in the ratio f_t²/c² (at most [`FIRMEST`], either way): so opening and sliding mix as they do in motion, without a stiffness.
fn firm(solid: &Solid, faces: &[InterfaceFace], kind: u32, interface: &Interface, case: &Case) -> [f64; 2] {
    let law = &interface.law;
    let is_wet = case.flows.liquid.as_ref().is_some_and(|liquid| liquid.flows_in(&interface.name));
    let firmness = if is_wet && law.is_bonded() { FIRM_IF_WET } else { FIRM };
    let of = |face: &InterfaceFace| {
        let [a, b, c] = face.sides[0].map(|node| solid.reference[node as usize]);
        let size = if face.corners() == 2 { (b - a).norm() } else { (b - a).cross(&(c - a)).norm().sqrt() };
        let modulus = |(body, _): (u32, u32)| solid.body(body as usize).elastic.young_modulus;
        modulus(face.elements[0]).max(modulus(face.elements[1])) / size
    };
    let stiffest = faces.iter().filter(|face| face.kind == kind).map(of).fold(0.0, f64::max);
    let [opens, slides] = [law.tensile_strength, law.cohesion].map(|strength| strength * strength);
    let least = opens.min(slides);
    let ratio = |strength: f64| if least > 0.0 { (strength / least).min(FIRMEST) } else { 1.0 };
    [opens, slides].map(|strength| firmness * stiffest * ratio(strength))
}

/// What does not go together with interfaces yet.
pub(super) fn check(context: &mut Context<'_>) {
    let case = context.case;
    let Some(first) = case.interfaces.first() else { return };
    let place = first.place.clone();
    if case.solver.kind == SolverKind::Modes {
        context.error(&place, "with solver.kind = \"modes\"", "solids without interfaces");
    }
    if case.solver.subcycling.is_some() {
        context.error(&place, "with solver.subcycling", "one step for all elements; remove subcycling");
    }
    if case.flows.heat.is_none() {
        for transfer in case.interfaces.iter().filter_map(|interface| interface.heat_transfer.as_ref()) {
            context.error(&transfer.place, "without [heat]", "a [heat] table, or no heat_transfer");
        }
    }
    check_cracks(context, &place);
    if context.exchange.is_some() || context.division.is_some() {
        context.error(&place, "in a run of several processes", "one process; threads are not limited");
    }
}

/// Pressure and counts go through cracks between elements alone.
fn check_cracks(context: &mut Context<'_>, place: &Place) {
    let case = context.case;
    let presses = |load: &&Load| matches!(load.kind, LoadKind::Pressure { in_cracks: Some(_), .. });
    if case.loads.iter().any(|load| presses(&load)) {
        context.error(
            place,
            "beside loads[].in_cracks",
            "a pressure on facets alone: interfaces have a pressure of their own",
        );
    }
    let counts = |kind: &ProbeKind| matches!(kind, ProbeKind::Crack(crack) if crack.measure == CrackMeasure::Count);
    for probe in case.probes.iter().filter(|probe| counts(&probe.kind)) {
        let found = format!("= \"{}\": interfaces are not counted as cracks", probe.name.value);
        context.error(&probe.name.place, found, "crack.measure = \"area\", \"length\" or \"tip\" beside interfaces");
    }
}

/// Doubts about the size of elements beside interfaces.
pub(super) fn doubts(context: &Context<'_>, scene: &Scene) -> Vec<Diagnostic> {
    let interfaces = scene.interfaces();
    let mut doubts = Vec::new();
    for (kind, interface) in (0u32..).zip(&context.case.interfaces) {
        if rubs_undamped(context.case, interface) {
            let note = Diagnostic::warning(
                Code::UndampedSliding,
                &interface.place,
                ": it rubs in motion, and the case has no damping",
            );
            doubts.push(note.remedy(
                "where it slides steadily its vibrations make the mean shear force too small: set [damping], or load it at rest",
            ));
        }
        let extent = extent(&scene.solid);
        let law = &interface.law;
        let slips = [("peak_slip", law.roughness.map(|own| own.peak_slip)), ("dilation_slip", Some(law.dilation_slip))];
        for (key, slip) in slips {
            if let Some(slip) = slip.filter(|slip| slip.is_finite() && *slip > LONG * extent) {
                let [slip, extent] = [slip, extent].map(|length| quantity(length, "m"));
                let found = format!(".{key} = {slip}, beside solids of {extent}");
                let note = Diagnostic::warning(Code::UnusualValue, &interface.place, found);
                doubts.push(note.remedy(
                    "joints wear and rise within a hundredth of their length; check the unit of the slip and mesh.unit",
                ));
            }
        }
        let Some((zone, size)) = process_zone(&scene.solid, interfaces, kind) else { continue };
        if zone > ZONES * extent {
            let [zone, extent] = [zone, extent].map(|length| quantity(length, "m"));
            let found = format!(": its process zone E G_I/ft^2 is {zone} long, beside solids of {extent}");
            let note = Diagnostic::warning(Code::ProcessZone, &interface.place, found);
            let expected = format!("solids of more than 1/{ZONES} of the zone");
            let remedy = "check tensile_strength, fracture_energy and mesh.unit; such an interface yields as a whole";
            doubts.push(note.expected(expected).remedy(remedy));
        }
        if zone < IN_ZONE * size {
            let place: &Place = &interface.place;
            let [zone, size] = [zone, size].map(|length| quantity(length, "m"));
            let found = format!(": its process zone of some {zone} meets faces of {size}");
            let note = Diagnostic::warning(Code::CoarseMesh, place, found);
            doubts.push(note.remedy("three faces at least resolve it: refine along the interface"));
        }
    }
    doubts
}

/// Largest extent of all solids along an axis [m].
fn extent(solid: &Solid) -> f64 {
    let far =
        |at: fn(&Vec3, &Vec3) -> Vec3, from: f64| solid.reference.iter().fold(Vec3::repeat(from), |a, b| at(&a, b));
    (far(|a, b| a.sup(b), f64::NEG_INFINITY) - far(|a, b| a.inf(b), f64::INFINITY)).max()
}

/// Whether an interface may slide under friction in motion that nothing damps.
fn rubs_undamped(case: &Case, interface: &Interface) -> bool {
    let damping = &case.damping;
    let damped = [damping.local, damping.mass, damping.stiffness].iter().any(|value| *value > 0.0);
    interface.law.residual_friction > 0.0 && !damped && case.solver.kind != SolverKind::Static
}

/// Length of the process zone of an interface between the solids beside it, E G_I/f_t² [m], and the mean size of its faces [m]; none of one that
/// was never joined.
pub fn process_zone(solid: &Solid, interfaces: &Interfaces, kind: u32) -> Option<(f64, f64)> {
    let law = &interfaces.kinds()[kind as usize].law;
    let own: Vec<&InterfaceFace> = interfaces.faces().iter().filter(|face| face.kind == kind).collect();
    if !law.is_bonded() || own.is_empty() {
        return None;
    }
    let modulus = |face: &&InterfaceFace| {
        let of = |(body, _): (u32, u32)| solid.body(body as usize).elastic.young_modulus;
        of(face.elements[0]).min(of(face.elements[1]))
    };
    let modulus = own.iter().map(modulus).fold(f64::INFINITY, f64::min);
    let (_, area) = interfaces.extent(kind);
    let mean = area / own.len() as f64;
    let shape = solid.body(own[0].elements[0].0 as usize).shape;
    let size = match shape {
        ElementKind::T3 => mean / solid.body(own[0].elements[0].0 as usize).thickness,
        ElementKind::T4 => (mean * 4.0 / 3.0f64.sqrt()).sqrt(),
    };
    Some((modulus * law.opening_energy / (law.tensile_strength * law.tensile_strength), size))
}
