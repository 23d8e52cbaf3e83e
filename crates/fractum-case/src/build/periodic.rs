//! Boxes through whose sides particles meet: what they cannot be beside, and the box of the scene.

use fractum_output::number::quantity;
use fractum_output::warning::Code;
use fractum_scene::{BoxServo, BoxStrain, PeriodicCell, Scene, narrowest_box, periodic_cell, with_periodic_box};

use super::{Context, function};
use crate::measure::ContactForce;
use crate::model::{
    Body, BodyKind, BondLawKind, BondedBody, BondedShape, Case, LoadKind, LooseSource, PackingSource, Periodic,
    ProbeKind, RigidShape, SolverKind,
};
use crate::reader::vectors::AXES;
use crate::{Diagnostic, Place};

/// Component of the normal of a plane along an axis that is rounding.
const ACROSS: f64 = 1e-9;

/// Refuses what knows no box that repeats, and probes of one that is not there.
pub(super) fn check(context: &mut Context<'_>) {
    let case = context.case;
    let Some(periodic) = &case.periodic else {
        for probe in case.probes.iter().filter(|probe| matches!(probe.kind, ProbeKind::PeriodicBox(_))) {
            let found = format!("= \"{}\": the case has no periodic box", probe.name.value);
            context.error(&probe.name.place, found, "a table [periodic]");
        }
        return;
    };
    for (place, found, expected) in refused(case, periodic) {
        context.error(place, found, expected);
    }
    for function in periodic.functions() {
        if function.value.depends_on_position() {
            context.error(&function.place, "depends on the position", "a function of time only");
        }
    }
}

/// What a box that repeats cannot be beside: place, what is found there, what was expected.
fn refused<'c>(case: &'c Case, periodic: &'c Periodic) -> Vec<(&'c Place, String, &'static str)> {
    const LOOSE: &str = "loose particles (kind = \"particles\") with rigid planes across the axes that do not repeat, or one bonded body";
    let mut found = Vec::new();
    let mut refuse = |place: &'c Place, text: String, expected| found.push((place, text, expected));
    if periodic.axes == [false; 3] {
        refuse(&periodic.place, "repeats along no axis".into(), "one of x, y and z in periodic.axes");
    }
    if case.solver.kind != SolverKind::Explicit {
        let expected = "kind = \"explicit\" beside [periodic]";
        refuse(&case.solver.place, "is not explicit, and the box is periodic".into(), expected);
    }
    if !case.source.stage.is_empty() {
        refuse(&periodic.place, "has stages beside it".into(), "one run: let strain_rate and servo change with time");
    }
    if let Some(domain) = &case.solver.domain {
        let text = "is beside a periodic box, which nothing leaves";
        refuse(&domain.place, text.into(), "one of solver.domain and [periodic]");
    }
    if let Some(heat) = &case.flows.heat {
        refuse(&heat.place, "is beside a periodic box, whose images know no heat".into(), "no [heat]");
    }
    for body in &case.bodies {
        let (place, name) = (&body.name.place, &body.name.value);
        match &body.kind {
            BodyKind::Solid(_) => refuse(place, format!("= \"{name}\" is a solid in a periodic box"), LOOSE),
            BodyKind::Bonded(bonded) => {
                for (place, text, expected) in refused_of_bonded(case, periodic, body, bonded) {
                    refuse(place, format!("{text}, in a periodic box"), expected);
                }
            }
            BodyKind::Particles(loose) if matches!(loose.source, LooseSource::Inlet { .. }) => {
                let expected = "particles that are there from the start";
                refuse(place, format!("= \"{name}\" comes in through an inlet, in a periodic box"), expected);
            }
            BodyKind::Particles(_) => {}
            BodyKind::Rigid(rigid) => {
                let across = |normal: &fractum_math::Vec3| {
                    (0..3).all(|axis| !periodic.axes[axis] || normal[axis].abs() < ACROSS)
                };
                let turns = rigid.free_rotation || rigid.spin.iter().any(Option::is_some);
                let is_plane = matches!(&rigid.shape, RigidShape::Plane { normal, .. } if across(normal));
                if !is_plane || turns {
                    refuse(
                        place,
                        format!("= \"{name}\": this rigid body would cross sides of the periodic box"),
                        LOOSE,
                    );
                }
            }
        }
    }
    let held = periodic.servo.iter().flat_map(|servo| &servo.stress).map(|(axis, stress)| ([*axis; 2], &stress.place));
    for ([i, j], place) in periodic.rates.iter().map(|(at, rate)| (*at, &rate.place)).chain(held.clone()) {
        if let Some(axis) = [i, j].into_iter().find(|&axis| !periodic.axes[axis]) {
            let text = format!("deforms the box along {}, along which it does not repeat", AXES[axis]);
            refuse(place, text, "components of the axes in periodic.axes");
        }
    }
    for (at, place) in held {
        if periodic.rates.iter().any(|(rate, _)| *rate == at) {
            refuse(place, "is held, and strain_rate gives its rate too".into(), "one of both");
        }
    }
    if periodic.deforms() {
        let resist = case.damping.local != 0.0 || case.damping.mass != 0.0 || case.damping.tchamwa_wielgosz.is_some();
        if resist {
            let text = "deforms, and damping would act on its mean flow";
            refuse(&periodic.place, text.into(), "no [damping], or a box that keeps its shape");
        }
        if !case.supports.is_empty() {
            let text = "deforms, and supports would hold particles against its mean flow";
            refuse(&periodic.place, text.into(), "no [[supports]], or a box that keeps its shape");
        }
    }
    for probe in &case.probes {
        if let ProbeKind::ContactForce(ContactForce { along, .. }) = &probe.kind
            && !matches!(along, fractum_scene::Along::Direction(_))
        {
            let text = format!("= \"{}\" is about an axis, which a periodic box has not", probe.name.value);
            refuse(&probe.name.place, text, "along = a direction");
        }
    }
    found
}

/// What a bonded body cannot be in a box that repeats: place, what is found there, what was expected.
fn refused_of_bonded<'c>(
    case: &'c Case,
    periodic: &'c Periodic,
    body: &'c Body,
    bonded: &'c BondedBody,
) -> Vec<(&'c Place, String, &'static str)> {
    const FILLS: &str = "shape = \"box\" with the point and the size of [periodic]";
    let (place, name) = (&body.name.place, &body.name.value);
    let material = &case.materials[bonded.material];
    let mut found = Vec::new();
    let mut refuse = |is_wrong: bool, place: &'c Place, text: String, expected| {
        if is_wrong {
            found.push((place, text, expected));
        }
    };
    let partly = periodic.axes != [true; 3];
    refuse(partly, &periodic.place, "has a bonded body, and does not repeat along all axes".into(), "no periodic.axes");
    let alone = case.bodies.len() == 1;
    refuse(!alone, place, format!("= \"{name}\" is bonded and not alone"), "one bonded body, which fills the box");
    refuse(bonded.replaces.is_some(), place, format!("= \"{name}\" replaces a part of a solid"), "no replaces");
    let stiffens = bonded.wall_stiffening > 0.0;
    refuse(stiffens, place, format!("= \"{name}\" has wall_stiffening and no walls"), "no wall_stiffening");
    let beside_mean = bonded.law == BondLawKind::LocalNonlocal;
    let laws = "bond = \"cohesive-beam\" or \"local\"";
    refuse(beside_mean, place, format!("= \"{name}\": its bonds know the mean strain of particles"), laws);
    let viscous = bonded.law == BondLawKind::Local
        && material.interfaces.as_ref().is_some_and(|own| own.value.law.damping_ratio > 0.0);
    let interfaces = "no damping_ratio in materials.NAME.interface";
    refuse(viscous, place, format!("= \"{name}\": its bonds are viscous"), interfaces);
    let at_walls = material.fracture.as_ref().filter(|own| own.value.strength.at_walls);
    if let Some(own) = at_walls {
        refuse(true, &own.place, ".at_walls is true without walls".into(), "at_walls = false");
    }
    let fills = |shape: &BondedShape| {
        let BondedShape::Box { point, size } = shape else { return false };
        (0..3).all(|axis| periodic.spans(axis, point[axis], size[axis]))
    };
    match &bonded.packing {
        PackingSource::File(file) => {
            let text = format!("= \"{}\" is a packing with walls", file.name.value);
            refuse(true, &file.name.place, text, "shape = \"box\", or a file of particles");
        }
        PackingSource::Particles { shape: Some(shape), .. } | PackingSource::Shape { shape, .. } => {
            refuse(!fills(&shape.value), &shape.place, "is not that box: a bonded body fills it".into(), FILLS);
        }
        PackingSource::Particles { shape: None, .. } => {}
    }
    found
}

/// Gravity along axes that all repeat.
pub(super) fn doubts(case: &Case) -> Vec<Diagnostic> {
    let Some(periodic) = case.periodic.as_ref().filter(|own| own.axes == [true; 3]) else { return Vec::new() };
    let gravity = |load: &&crate::model::Load| matches!(load.kind, LoadKind::Gravity { .. });
    let doubt = |_| {
        let found = "repeats along x, y and z, and gravity acts: all particles fall freely, together";
        let remedy = "leave gravity out, or let the box not repeat along it (periodic.axes) and give it a rigid plane";
        Diagnostic::warning(Code::FreeFall, &periodic.place, found).remedy(remedy)
    };
    case.loads.iter().find(gravity).map(doubt).into_iter().collect()
}

/// The box of the scene as it begins, where the case has one.
pub(super) fn cell(case: &Case) -> Option<PeriodicCell> {
    let periodic = case.periodic.as_ref()?;
    Some(periodic_cell(periodic.point, &periodic.size.value, periodic.axes))
}

/// The same scene, with its contacts, in the box of the case.
pub(super) fn with_box(context: &mut Context<'_>, scene: Scene, cell: PeriodicCell) -> Scene {
    let Some(periodic) = &context.case.periodic else { return scene };
    let needed = scene.contacts.narrowest_box().max(narrowest_box(&scene.bonded));
    check_size(context, periodic, needed, &cell);
    let rates = periodic.rates.iter().map(|(at, rate)| (*at, function(&rate.value))).collect();
    let servos = periodic.servo.iter().flat_map(|servo| {
        let of = |(axis, stress): &(usize, crate::Spanned<crate::TimeFunction>)| BoxServo {
            axis: *axis,
            stress: function(&stress.value),
            rate: servo.rate,
            slows_at: servo.slows_at,
        };
        servo.stress.iter().map(of).collect::<Vec<_>>()
    });
    with_periodic_box(scene, cell, BoxStrain { rates, servos: servos.collect() })
}

fn check_size(context: &mut Context<'_>, periodic: &Periodic, needed: f64, cell: &PeriodicCell) {
    if cell.narrowest() >= needed {
        return;
    }
    let short = (0..3).find(|&axis| periodic.axes[axis] && periodic.size.value[axis] < needed).unwrap_or(0);
    let found = format!(
        "is {} along {}: its particles could meet each other twice",
        quantity(periodic.size.value[short], "m"),
        AXES[short]
    );
    let note = Diagnostic::error(&periodic.size.place, found);
    let note = note.expected(format!("{} or more along the axes that repeat", quantity(needed, "m")));
    context.diagnostics.push(note.remedy("a larger box, or smaller particles"));
}
