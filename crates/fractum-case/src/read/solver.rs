//! `[damping]` and `[solver]`.

use fractum_dem::Batch;
use fractum_fem::Formulation;
use fractum_output::warning::Code;
use fractum_scene::Domain;
use fractum_scene::statics::{LinearSolver, NoEquilibrium};

use super::probes::ReadProbe;
use crate::model::{
    AskedAccuracy, Body, BodyKind, Control, Damping, InitialOverlap, Material, ModesOptions, Opening, Solver,
    SolverKind, StaticOptions, StopWhen, TimeStep,
};
use crate::reader::Table;
use crate::reader::vectors::{direction, point};
use crate::tree::{Entry, Value};
use crate::{Choice, Diagnostic, Dimension, Place, Spanned};

/// Reads the damping, which may belong to another stage; which keys have an effect depends on the solver, and on the bodies where they are known.
pub(super) fn damping(root: &Table<'_>, bodies: Option<&[Body]>, staged: bool) -> Damping {
    let table = root.table_or_empty("damping");
    let tchamwa_wielgosz = table.quantity("tchamwa_wielgosz").between(1.0, 2.0).given();
    let is = |key: &str, value: &str| {
        entry_of_solver(root, key)
            .is_some_and(|entry| matches!(&entry.node.value, Value::Text(text) if text.as_str() == value))
    };
    const ALL: [&str; 6] = ["local", "mass", "stiffness", "bulk_linear", "bulk_quadratic", "tchamwa_wielgosz"];
    if !staged && is("kind", "static") && !is("no_equilibrium", "motion") {
        refuse_motion(root, &table, &ALL, "with solver.kind = \"static\", where nothing moves fast");
    } else if is("kind", "heat") {
        refuse_motion(root, &table, &ALL, WHILE_CONDUCTING);
    } else if is("kind", "modes") {
        refuse_motion(root, &table, &ALL, WITH_MODES);
    } else if bodies.is_some_and(|bodies| !bodies.iter().any(is_of_particles)) {
        table.refuse("tchamwa_wielgosz", "where no body is made of particles");
    }
    let damping = Damping {
        local: table.quantity("local").check(|local| (0.0..1.0).contains(local), "from 0 to below 1").or(0.0),
        mass: table.quantity("mass").not_negative().or(0.0),
        stiffness: table.quantity("stiffness").not_negative().or(0.0),
        bulk_linear: table.quantity("bulk_linear").not_negative().or(0.0),
        bulk_quadratic: table.quantity("bulk_quadratic").not_negative().or(0.0),
        tchamwa_wielgosz,
    };
    table.finish("here");
    damping
}

/// Why what acts on motion has no effect on conduction alone.
const WHILE_CONDUCTING: &str = "with solver.kind = \"heat\", where nothing moves";

/// Why what acts on motion has no effect on natural vibrations.
const WITH_MODES: &str = "with solver.kind = \"modes\", which looks for free vibrations";

/// A key of the solver as it is written.
fn entry_of_solver<'n>(root: &'n Table<'_>, key: &str) -> Option<&'n Entry> {
    let Value::Table(entries) = &root.peek("solver")?.value else { return None };
    entries.iter().find(|entry| entry.name == key)
}

/// Refuses keys of a table that act on motion; what the file says may stay where `--set` has chosen the solver.
fn refuse_motion(root: &Table<'_>, table: &Table<'_>, keys: &[&str], why: &str) {
    let switched = entry_of_solver(root, "kind").is_some_and(|kind| kind.node.place.is_override());
    for key in keys {
        if switched { table.set_aside(key, why) } else { table.refuse(key, why) }
    }
}

/// Safety factor above which a run is close to the edge of stability.
const RISKY_SAFETY: f64 = 0.95;

fn is_of_particles(body: &Body) -> bool {
    matches!(body.kind, BodyKind::Bonded(_) | BodyKind::Particles(_))
}

pub(super) fn read(root: &Table<'_>, probes: &[ReadProbe], bodies: Option<&[Body]>) -> Option<Solver> {
    let table = root.table_or_empty("solver");
    let kind = table.choice("kind").or_if_absent(SolverKind::Explicit);
    let place = table.peek("kind").map_or_else(|| table.place_of("kind"), |node| node.place.clone());
    let modes = modes(root, &table, kind);
    let end = match &modes {
        // An instant is the number of a vibration.
        Some(modes) => Some(modes.count as f64),
        None => table.quantity("end").positive().required(),
    };
    let end_place = table.place_below("end");
    if kind == Some(SolverKind::Heat) {
        refuse_while_conducting(root, &table);
    }
    let is_static = kind == Some(SolverKind::Static);
    let statics = match kind {
        Some(SolverKind::Static | SolverKind::Auto) => statics(&table, bodies).map(Some),
        Some(kind @ (SolverKind::Explicit | SolverKind::Heat)) => {
            for key in ["control", "opening", "linear_solver", "tolerance", "batch", "max_steps", "no_equilibrium"] {
                table.refuse(key, &format!("with kind = \"{}\"", kind.name()));
            }
            Some(None)
        }
        Some(SolverKind::Modes) | None => Some(None),
    };
    if kind == Some(SolverKind::Auto) {
        table.refuse("step", "with kind = \"auto\": its meaning depends on the solver");
    }
    let step = table.quantity("step").positive();
    let step =
        step.check(|step| end.is_none_or(|end| *step <= end), "no more than the end of the run").spanned().given();
    let moves = statics
        .as_ref()
        .is_some_and(|statics| statics.as_ref().is_none_or(|statics| statics.no_equilibrium == NoEquilibrium::Motion));
    if is_static {
        table.refuse("initial_overlap", "with kind = \"static\"");
        table.refuse("domain", "with kind = \"static\"");
        for key in ["safety", "time_step", "balance_stop"].into_iter().filter(|_| !moves) {
            table.refuse(key, "with kind = \"static\"");
        }
    } else if step.is_some() {
        table.refuse("safety", "beside a fixed step");
    }
    let safety =
        table.quantity("safety").check(|safety| *safety > 0.0 && *safety <= 2.0, "more than 0, at most 2").or(0.8);
    if let Some(node) = table.peek("safety")
        && safety > RISKY_SAFETY
    {
        let why = if safety > 1.0 { "above 1 the run is unstable" } else { "this is close to the limit of stability" };
        let note =
            Diagnostic::warning(Code::TimeStep, &node.place, node.found()).remedy(format!("{why}; 0.8 is usual"));
        table.reader.note(note);
    }
    let time_step = table.choice("time_step").or(TimeStep::PowerIteration);
    let subcycling = subcycling(&table, kind);
    let initial_overlap = table.choice("initial_overlap").or(InitialOverlap::Push);
    let domain = if table.has("domain") { domain(&table).map(Some) } else { Some(None) };
    let stop_when = if table.has("stop_when") { stop_when(&table, probes).map(Some) } else { Some(None) };
    let accuracy = accuracy(&table, kind, probes, bodies);
    let balance_warning = table.quantity("balance_warning").positive().or(1e-3);
    let expected = format!("at least balance_warning, which is {balance_warning}");
    let balance_stop = table.quantity("balance_stop").check(|stop| *stop >= balance_warning, &expected);
    let balance_stop = balance_stop.or(balance_warning.max(1e-2));
    table.finish("here");
    Some(Solver {
        kind: kind?,
        place,
        end: end?,
        begin: 0.0,
        end_place,
        safety,
        time_step,
        step,
        subcycling,
        initial_overlap,
        domain: domain?,
        statics: statics?,
        modes,
        stop_when: stop_when?,
        accuracy,
        balance_warning,
        balance_stop,
    })
}

/// An accuracy that is asked for, which needs a crack that may run and a load that tells it.
fn accuracy(
    table: &Table<'_>,
    kind: Option<SolverKind>,
    probes: &[ReadProbe],
    bodies: Option<&[Body]>,
) -> Option<AskedAccuracy> {
    for key in ["accuracy", "accuracy_runs"] {
        match kind {
            Some(kind @ (SolverKind::Heat | SolverKind::Modes)) => {
                table.refuse(key, &format!("with kind = \"{}\", where nothing breaks", kind.name()));
            }
            _ if !bodies.is_none_or(|bodies| bodies.iter().any(may_crack)) => {
                table.refuse(key, "where no solid has damage: its meshes are refined where damage comes");
            }
            _ => {}
        }
    }
    let is_load =
        |probe: &ReadProbe| probe.dimension.is_none_or(|own| [Dimension::FORCE, Dimension::ENERGY].contains(&own));
    let share = table.quantity("accuracy");
    let share =
        share.check(|share| *share == 0.0 || (0.002..=0.5).contains(share), "from 0.2 % to 50 %, or 0 for one run");
    let share = share.spanned().given().filter(|share| share.value > 0.0);
    let runs = table.integer("accuracy_runs").check(|runs| (4..=100).contains(runs), "from 4 to 100");
    let most_runs = runs.or(12) as usize;
    let share = share?;
    if !probes.iter().any(is_load) {
        let note = Diagnostic::error(&share.place, ": no probe measures a load, whose error it limits".to_owned());
        table
            .reader
            .note(note.remedy("add one, such as [[probes]] with reaction = { group = \"top\", along = \"y\" }"));
    }
    Some(AskedAccuracy { share, most_runs })
}

/// Refuses an accuracy where error bars were not held against exact loads.
pub(super) fn refuse_accuracy(
    root: &Table<'_>,
    solver: Option<&Solver>,
    bodies: Option<&[Body]>,
    materials: &[(String, Option<Material>)],
) {
    let (Some(asked), Some(bodies)) = (solver.and_then(|solver| solver.accuracy.as_ref()), bodies) else { return };
    let solids = bodies.iter().filter_map(|body| match &body.kind {
        BodyKind::Solid(solid) if solid.damage => Some((body, solid)),
        _ => None,
    });
    for (body, solid) in solids {
        let damage = materials.get(solid.material).and_then(|(_, material)| material.as_ref()?.damage.as_ref());
        let field = damage.and_then(|damage| damage.value.regularisation);
        let what = if field.is_some_and(|field| field.length.is_some()) {
            ("a phase field of a given length", "leave length out: it becomes smaller with the elements of each pass")
        } else if solid.formulation == Formulation::Standard {
            ("standard elements", "leave formulation out")
        } else {
            continue;
        };
        let found = format!(": error bars are not known with {} (body \"{}\")", what.0, body.name.value);
        root.reader.note(Diagnostic::error(&asked.share.place, found).remedy(what.1));
    }
}

fn may_crack(body: &Body) -> bool {
    matches!(&body.kind, BodyKind::Solid(solid) if solid.damage)
}

/// What natural vibrations are looked for with; nothing with another solver.
fn modes(root: &Table<'_>, table: &Table<'_>, kind: Option<SolverKind>) -> Option<ModesOptions> {
    if kind != Some(SolverKind::Modes) {
        table.refuse("count", "without kind = \"modes\"");
        return None;
    }
    const OTHERS: [&str; 16] = [
        "end",
        "safety",
        "time_step",
        "step",
        "subcycling",
        "initial_overlap",
        "domain",
        "control",
        "opening",
        "tolerance",
        "batch",
        "no_equilibrium",
        "max_steps",
        "stop_when",
        "balance_warning",
        "balance_stop",
    ];
    OTHERS.iter().for_each(|key| table.refuse(key, "with kind = \"modes\""));
    if !root.has("in_situ") {
        // Loads of t = 0 belong to the stress of the start.
        refuse_motion(
            root,
            root,
            &["loads"],
            "with solver.kind = \"modes\" and without [in_situ], since free vibrations have no loads",
        );
    }
    for body in root.tables("bodies") {
        refuse_motion(root, &body, &["initial_velocity"], WITH_MODES);
    }
    let count = table.integer("count").check(|&count| count > 0, "at least 1").or(10) as usize;
    Some(ModesOptions { count, linear_solver: table.choice("linear_solver").or(LinearSolver::Auto) })
}

/// Tells what has no effect where nothing moves.
pub(super) fn tell_at_rest(root: &Table<'_>, solver: Option<&Solver>) {
    let rests = |solver: &Solver| {
        let moves = |statics: &StaticOptions| statics.no_equilibrium == NoEquilibrium::Motion;
        solver.kind == SolverKind::Static && !solver.statics.as_ref().is_some_and(moves)
    };
    for body in root.tables("bodies").iter().filter(|_| solver.is_some_and(rests)) {
        body.set_aside("initial_velocity", "with solver.kind = \"static\", where nothing moves");
    }
}

/// Refuses what acts on motion alone.
fn refuse_while_conducting(root: &Table<'_>, table: &Table<'_>) {
    for key in ["step", "time_step", "subcycling", "initial_overlap", "domain", "balance_warning", "balance_stop"] {
        table.refuse(key, "with kind = \"heat\"");
    }
    refuse_motion(root, root, &["loads", "in_situ"], WHILE_CONDUCTING);
    // Supports say where bodies will be held once they move.
    root.set_aside("supports", WHILE_CONDUCTING);
    for body in root.tables("bodies") {
        refuse_motion(root, &body, &["initial_velocity"], WHILE_CONDUCTING);
    }
}

/// Where steps of two sizes are asked for.
fn subcycling(table: &Table<'_>, kind: Option<SolverKind>) -> Option<Place> {
    if matches!(kind, Some(SolverKind::Static | SolverKind::Auto)) {
        table.refuse("subcycling", "where the solver may be static");
    }
    let wanted = table.flag("subcycling").or(false) && kind == Some(SolverKind::Explicit);
    table.peek("subcycling").filter(|_| wanted).map(|node| node.place.clone())
}

fn domain(solver: &Table<'_>) -> Option<Spanned<Domain>> {
    let table = solver.table("domain")?;
    let min = point(&table, "min").required();
    let max = point(&table, "max").required();
    let place = table.place.clone();
    table.finish("here");
    let (min, max) = (min?, max?);
    if (0..2).any(|axis| min[axis] >= max[axis]) || min.z > max.z {
        let note = Diagnostic::error(&place, "has a min that is not below its max");
        solver.reader.note(note.expected("min < max on every axis"));
        return None;
    }
    Some(Spanned { value: Domain { min, max }, place })
}

fn statics(table: &Table<'_>, bodies: Option<&[Body]>) -> Option<StaticOptions> {
    let holds = |of: fn(&Body) -> bool| bodies.is_none_or(|bodies| bodies.iter().any(of));
    if !holds(|body| matches!(body.kind, BodyKind::Solid(_))) {
        table.refuse("linear_solver", "where no body is a solid: bonds are solved by conjugate gradients");
        table.refuse("no_equilibrium", "where no body is a solid");
    }
    if !holds(|body| matches!(body.kind, BodyKind::Bonded(_))) {
        table.refuse("batch", "where no body is bonded");
    }
    let control = table.choice::<Control>("control").given();
    let opening = if control == Some(Control::Opening) {
        opening(table).map(Some)
    } else {
        table.refuse("opening", "without control = \"opening\"");
        Some(None)
    };
    Some(StaticOptions {
        control,
        opening: opening?,
        linear_solver: table.choice("linear_solver").or(LinearSolver::Auto),
        tolerance: table
            .quantity("tolerance")
            .check(|&part| part > 0.0 && part <= 0.05, "above 0, at most 0.05")
            .or(1e-4),
        most_steps: table.integer("max_steps").check(|&steps| steps > 0, "at least 1").or(10_000),
        batch: table.choice("batch").or(Batch::PerSite),
        no_equilibrium: table.choice("no_equilibrium").or(NoEquilibrium::Stop),
    })
}

fn opening(solver: &Table<'_>) -> Option<Opening> {
    if !solver.has("opening") {
        let note = Diagnostic::error(&solver.place_of("opening"), "is missing");
        solver.reader.note(note.expected("the groups whose distance controls the run, with along, step and end"));
        return None;
    }
    let table = solver.table("opening")?;
    let group = table.text("group").spanned().required();
    let against = table.text("against").spanned().required();
    let along = direction(&table, "along").required();
    let step = table.quantity("step").positive().required();
    let end = table.quantity("end").positive().required();
    table.finish("here");
    Some(Opening { group: group?, against: against?, along: along?, step: step?, end: end? })
}

fn stop_when(solver: &Table<'_>, probes: &[ReadProbe]) -> Option<StopWhen> {
    let table = solver.table("stop_when")?;
    let probe = table.text("probe").spanned().required().and_then(|name| {
        let columns = probes.iter().filter(|probe| !probe.scalar).map(|probe| probe.name.as_str());
        let found = probes.iter().position(|probe| probe.name == name.value && !probe.scalar);
        if found.is_none() {
            let note = Diagnostic::error(&name.place, format!("= \"{}\" is not a probe with a history", name.value));
            table.reader.note(table.reader.suggest(note, &name.value, columns, "there are"));
        }
        found
    });
    let below = table.quantity("below").between(0.0, 1.0).required();
    let after = table.quantity("after").not_negative().or(0.0);
    let lasting = table.quantity("lasting").not_negative().given();
    table.finish("here");
    Some(StopWhen { probe: probe?, below: below?, after, lasting })
}
