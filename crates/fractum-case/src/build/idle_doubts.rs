//! Doubts about scenes that nothing moves, and loads that a support takes at once.

use fractum_math::Vec3;
use fractum_mesh::Mesh;
use fractum_output::warning::Code;

use super::body_doubts::{Own, nodes_of};
use crate::measure::Count;
use crate::model::{
    BodyKind, Case, Load, LoadKind, LooseSource, Material, Motion, Probe, ProbeKind, SolverKind, Support,
};
use crate::{Diagnostic, Place, TimeFunction};

/// Share of the area of facets along an axis below which they do not look along it.
const FLAT: f64 = 1e-6;
const AXES: [&str; 3] = ["x", "y", "z"];

/// Forces and tractions in a stage whose nodes a support holds along them.
pub(super) fn taken_at_once(case: &Case, mesh: &Mesh) -> Vec<Diagnostic> {
    if mesh.whole.is_some() {
        return Vec::new();
    }
    let taken = |load: &Load| {
        let (on, pushed) = match &load.kind {
            LoadKind::Force { on, force: components } | LoadKind::Traction { on, traction: components } => {
                (on, (0..3).filter(|&axis| components[axis].is_some()).collect::<Vec<usize>>())
            }
            other => {
                let LoadKind::Pressure { on, .. } = other else { return None };
                (on, looks_along(mesh, &on.group.as_ref()?.value))
            }
        };
        let place = on.place().filter(|_| case.particle_group(on.group_name()).is_none())?;
        let loaded = nodes_of(mesh, on)?;
        let held = |axis: usize| {
            let mut free = loaded.clone();
            for support in case.supports.iter().filter(|support| support.motion[axis].is_some()) {
                let Some(own) = nodes_of(mesh, &support.on) else { continue };
                free.retain(|node| own.binary_search(node).is_err());
            }
            free.is_empty()
        };
        if loaded.is_empty() || pushed.is_empty() || !pushed.iter().all(|&axis| held(axis)) {
            return None;
        }
        let axes = pushed.into_iter().map(|axis| AXES[axis]).collect::<Vec<_>>().join(", ");
        let found = format!(
            "= \"{}\": supports prescribe the motion of all its nodes along {axes}, and take the load at once",
            on.label()
        );
        let note = Diagnostic::warning(Code::NoEffect, place, found);
        Some(note.remedy("load another group, or let these nodes free"))
    };
    case.loads.iter().filter_map(taken).collect()
}

/// Axes along which some facet of a group looks.
fn looks_along(mesh: &Mesh, group: &str) -> Vec<usize> {
    let mut areas = Vec3::zeros();
    facet_normals(mesh, group).iter().for_each(|normal| areas += normal.abs());
    (0..3).filter(|&axis| areas[axis] > FLAT * areas.max()).collect()
}

/// Normals of the facets of a group, as long as their areas (times two in space); those of its lines where it has no triangles.
pub(super) fn facet_normals(mesh: &Mesh, group: &str) -> Vec<Vec3> {
    let at = |node: u32| mesh.nodes[node as usize];
    let groups = mesh.group(group);
    let triangles = groups.iter().flat_map(|group| &group.triangles).map(|&facet| mesh.triangles[facet as usize]);
    let normals: Vec<Vec3> = triangles.map(|[a, b, c]| (at(b) - at(a)).cross(&(at(c) - at(a)))).collect();
    if !normals.is_empty() {
        return normals;
    }
    let lines = groups.iter().flat_map(|group| &group.lines).map(|&line| mesh.lines[line as usize]);
    lines.map(|[a, b]| (at(b) - at(a)).cross(&Vec3::z())).collect()
}

/// Solids whose every node supports prescribe along every axis: nothing is left to compute.
pub(super) fn all_prescribed(case: &Case, mesh: &Mesh, bodies: &[Own]) -> Option<Diagnostic> {
    let solids = case.bodies.iter().all(|body| matches!(body.kind, BodyKind::Solid(_)));
    let moves = matches!(case.solver.kind, SolverKind::Explicit | SolverKind::Static | SolverKind::Auto);
    let strains_itself = case.flows.heat.is_some() || case.in_situ.is_some() || !case.later.is_empty();
    if bodies.is_empty() || !solids || !moves || strains_itself || mesh.whole.is_some() {
        return None;
    }
    let axes = if bodies.iter().all(|body| body.plane) { 2 } else { 3 };
    let mut held = vec![0u8; mesh.nodes.len()];
    for support in &case.supports {
        let of_axes = (0..axes).filter(|&axis| support.motion[axis].is_some()).fold(0, |all, axis| all | (1 << axis));
        for node in nodes_of(mesh, &support.on).unwrap_or_default() {
            held[node as usize] |= of_axes;
        }
    }
    let all = (1 << axes) - 1;
    let mut nodes = bodies.iter().flat_map(|body| &body.nodes).peekable();
    if nodes.peek().is_none() || nodes.any(|&node| held[node as usize] != all) {
        return None;
    }
    let whole =
        case.supports.iter().max_by_key(|support| nodes_of(mesh, &support.on).map_or(0, |nodes| nodes.len()))?;
    let found = format!("= \"{}\": supports prescribe the motion of every node along every axis", whole.on.label());
    let note = Diagnostic::warning(Code::NoEffect, whole.on.place()?, found);
    Some(note.remedy("nothing is left to compute: take the group of one side"))
}

/// A scene that nothing moves in any stage.
pub(super) fn unmoved(case: &Case) -> Option<Diagnostic> {
    let stages = || std::iter::once(case).chain(&case.later);
    let moved = |support: &Support| {
        let functions = support.motion.iter().flatten();
        functions.filter_map(|motion| function_of(&motion.value)).any(|function| !function.is_zero())
    };
    let body = |kind: &BodyKind| match kind {
        BodyKind::Solid(solid) => {
            solid.initial_velocity.iter().flatten().any(|field| field.value.constant_value() != Some(0.0))
        }
        BodyKind::Rigid(rigid) => {
            let thrown = rigid.initial_velocity.iter().any(Option::is_some);
            thrown || rigid.functions().any(|function| !function.value.is_zero())
        }
        BodyKind::Bonded(bonded) => bonded.initial_velocity.iter().any(Option::is_some),
        BodyKind::Particles(loose) => {
            loose.initial_velocity.iter().any(Option::is_some)
                || matches!(loose.source, LooseSource::File { velocity_unit: Some(_), .. })
        }
    };
    let breaks = |material: &Material| material.damage.is_some() || material.fracture.is_some();
    let acts = |stage: &Case| {
        let pressed = stage.interfaces.iter().any(|interface| interface.pressure.is_some());
        let modes_or_heat = matches!(stage.solver.kind, SolverKind::Modes | SolverKind::Heat);
        let flows = stage.flows.gas.is_some() || stage.flows.heat.is_some() || stage.flows.liquid.is_some();
        modes_or_heat
            || flows
            || pressed
            || stage.in_situ.is_some() && (!stage.interfaces.is_empty() || stage.materials.iter().any(breaks))
            || stage.excavation.is_some()
            || stage.periodic.as_ref().is_some_and(|periodic| periodic.deforms())
            || stage.supports.iter().any(moved)
            || stage.loads.iter().any(|load| load.kind.functions().iter().any(|function| !function.value.is_zero()))
    };
    if stages().any(acts) || case.bodies.iter().any(|own| body(&own.kind)) {
        return None;
    }
    let name = &case.bodies.first()?.name;
    let found = format!(
        "= \"{}\": nothing moves this scene: it has no load, no prescribed motion and no initial velocity",
        name.value
    );
    let note = Diagnostic::warning(Code::NoEffect, &name.place, found);
    Some(note.remedy("add [[loads]], or give a support a velocity or a displacement"))
}

/// Tables of materials that none of the bodies of the material reads, such as the strength of bonds in a solid.
pub(super) fn tables_in_vain(case: &Case) -> Vec<Diagnostic> {
    let doubts = case.materials.iter().enumerate().flat_map(|(index, material)| {
        let bodies: Vec<&BodyKind> =
            case.bodies.iter().map(|body| &body.kind).filter(|kind| kind.material() == Some(index)).collect();
        let solid = bodies.iter().any(|kind| matches!(kind, BodyKind::Solid(_)));
        let bonded = bodies.iter().any(|kind| matches!(kind, BodyKind::Bonded(_)));
        let Material { damage, bedding, bonds, interfaces, fracture, .. } = material;
        let of_solids = [damage.as_ref().map(|own| &own.place), bedding.as_ref().map(|own| &own.place)];
        let of_bonds = [
            bonds.as_ref().map(|own| &own.place),
            interfaces.as_ref().map(|own| &own.place),
            fracture.as_ref().map(|own| &own.place),
        ];
        let of_solids = of_solids.into_iter().flatten().filter(move |_| !solid);
        let of_bonds = of_bonds.into_iter().flatten().filter(move |_| !bonded);
        let told = |place: &Place, reader: &str, remedy: &str| {
            let found = format!("is read by {reader} bodies alone, and no such body has this material");
            Diagnostic::warning(Code::NoEffect, place, found).remedy(remedy)
        };
        let of_solids =
            of_solids.map(move |place| told(place, "solid", "leave it out; bonds break by a table fracture"));
        let of_bonds = of_bonds.map(move |place| told(place, "bonded", "leave it out; solids break by a table damage"));
        if bodies.is_empty() { Vec::new() } else { of_solids.chain(of_bonds).collect() }
    });
    doubts.collect()
}

fn function_of(motion: &Motion) -> Option<&TimeFunction> {
    match motion {
        Motion::Velocity(function) | Motion::Displacement(function) => Some(function),
        Motion::Fixed => None,
    }
}

/// Probes of what the case has not: cracks where no material has a strength, gas, liquid.
pub(super) fn measured_in_vain(case: &Case) -> Vec<Diagnostic> {
    use fractum_scene::CountKind::{
        BrokenBonds, BrokenEdges, DamagedEdges, EnteredParticles, LeftPieces, RemovedElements, WaitingParticles,
    };
    let strong =
        |material: &Material| material.damage.is_none() && material.fracture.is_none() && material.interfaces.is_none();
    let stages = || std::iter::once(case).chain(&case.later);
    let holds = case.interfaces.is_empty() && case.materials.iter().all(strong);
    let doubt = |probe: &Probe| {
        let (found, remedy) = match &probe.kind {
            ProbeKind::CrackArea(_) | ProbeKind::Crack(_) | ProbeKind::RadialCracksAbout(_) if holds => {
                ("no material of the case can break", "give the material a table damage (solids) or fracture (bonds)")
            }
            ProbeKind::Count(Count(RemovedElements | BrokenEdges | DamagedEdges | BrokenBonds)) if holds => {
                ("no material of the case can break", "give the material a table damage (solids) or fracture (bonds)")
            }
            ProbeKind::Count(Count(EnteredParticles | WaitingParticles)) if !case.has_inlets() => {
                ("no particles come in as time goes on", "give a body of particles an inlet")
            }
            ProbeKind::Count(Count(LeftPieces)) if !stages().any(|stage| stage.solver.domain.is_some()) => {
                ("pieces have no domain that they could leave", "give the run a solver.domain")
            }
            ProbeKind::GasIn(_) if case.flows.gas.is_none() => ("the case has no gas", "add a table [gas]"),
            ProbeKind::LiquidIn(_) if case.flows.liquid.is_none() => ("the case has no liquid", "add a table [liquid]"),
            _ => return None,
        };
        let found = format!("= \"{}\" measures nothing: {found}", probe.name.value);
        Some(Diagnostic::warning(Code::NoEffect, &probe.name.place, found).remedy(remedy))
    };
    case.probes.iter().filter_map(doubt).collect()
}
