//! Doubts about scenes that nothing moves, and loads that a support takes at once.

use fractum_mesh::Mesh;
use fractum_output::warning::Code;

use crate::measure::Count;
use crate::model::{
    BodyKind, Case, Load, LoadKind, Material, Motion, Probe, ProbeKind, Selection, SolverKind, Support,
};
use crate::{Diagnostic, TimeFunction};

const AXES: [&str; 3] = ["x", "y", "z"];

/// Forces and tractions in a stage whose nodes a support holds along them.
pub(super) fn taken_at_once(case: &Case, mesh: &Mesh) -> Vec<Diagnostic> {
    if mesh.whole.is_some() {
        return Vec::new();
    }
    let taken = |load: &Load| {
        let (LoadKind::Force { on, force: components } | LoadKind::Traction { on, traction: components }) = &load.kind
        else {
            return None;
        };
        let place = on.place().filter(|_| case.particle_group(on.group_name()).is_none())?;
        let loaded = nodes_of(mesh, on)?;
        let pushed: Vec<usize> = (0..3).filter(|&axis| components[axis].is_some()).collect();
        let held = |axis: usize| {
            let mut free = loaded.clone();
            for support in case.supports.iter().filter(|support| support.motion[axis].is_some()) {
                let Some(own) = nodes_of(mesh, &support.on) else { continue };
                free.retain(|node| own.binary_search(node).is_err());
            }
            free.is_empty()
        };
        if loaded.is_empty() || !pushed.iter().all(|&axis| held(axis)) {
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

/// Nodes that are meant, ascending; none of sets of particles.
fn nodes_of(mesh: &Mesh, on: &Selection) -> Option<Vec<u32>> {
    let mut nodes = match &on.group {
        Some(group) => mesh.group_nodes(&group.value),
        None => (0..mesh.nodes.len() as u32).collect(),
    };
    if let Some(within) = &on.within {
        nodes.retain(|&node| within.value.holds_at(mesh.nodes[node as usize]));
    }
    (!nodes.is_empty()).then_some(nodes)
}

/// A scene of solids that nothing moves in any stage.
pub(super) fn unmoved(case: &Case) -> Option<Diagnostic> {
    let stages = || std::iter::once(case).chain(&case.later);
    let moved = |support: &Support| {
        let functions = support.motion.iter().flatten();
        functions.filter_map(|motion| function_of(&motion.value)).any(|function| !function.is_zero())
    };
    let body = |kind: &BodyKind| match kind {
        BodyKind::Solid(solid) => {
            solid.initial_velocity.iter().flatten().any(|field| field.constant_value() != Some(0.0))
        }
        BodyKind::Rigid(rigid) => {
            let thrown = rigid.initial_velocity.iter().any(Option::is_some);
            thrown || rigid.functions().any(|function| !function.value.is_zero())
        }
        BodyKind::Bonded(_) | BodyKind::Particles(_) => true,
    };
    let acts = |stage: &Case| {
        let pressed = stage.interfaces.iter().any(|interface| interface.pressure.is_some());
        let modes_or_heat = matches!(stage.solver.kind, SolverKind::Modes | SolverKind::Heat);
        let flows = stage.flows.gas.is_some() || stage.flows.heat.is_some() || stage.flows.liquid.is_some();
        modes_or_heat
            || flows
            || pressed
            || stage.in_situ.is_some()
            || stage.excavation.is_some()
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

fn function_of(motion: &Motion) -> Option<&TimeFunction> {
    match motion {
        Motion::Velocity(function) | Motion::Displacement(function) => Some(function),
        Motion::Fixed => None,
    }
}

/// Probes of what the case has not: cracks where no material has a strength, gas, liquid.
pub(super) fn measured_in_vain(case: &Case) -> Vec<Diagnostic> {
    use fractum_scene::CountKind::{BrokenBonds, BrokenEdges, DamagedEdges, RemovedElements};
    let strong =
        |material: &Material| material.damage.is_none() && material.fracture.is_none() && material.interfaces.is_none();
    let holds = case.interfaces.is_empty() && case.materials.iter().all(strong);
    let doubt = |probe: &Probe| {
        let (found, remedy) = match &probe.kind {
            ProbeKind::CrackArea(_) | ProbeKind::Crack(_) | ProbeKind::RadialCracksAbout(_) if holds => {
                ("no material of the case can break", "give the material a table damage (solids) or fracture (bonds)")
            }
            ProbeKind::Count(Count(RemovedElements | BrokenEdges | DamagedEdges | BrokenBonds)) if holds => {
                ("no material of the case can break", "give the material a table damage (solids) or fracture (bonds)")
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
