//! `[heat]`, and what materials are to it.

use fractum_output::number::push_shortest;
use fractum_output::warning::Code;
use fractum_scene::PackingConduction;

use super::time_functions::time_function;
use crate::model::{Control, Heat, HeatCondition, HeatKind, HeatScheme, Solver, SolverKind, Thermal};
use crate::reader::Table;
use crate::reader::presence::{exactly_one, optional};
use crate::reader::vectors::field;
use crate::selection::selection;
use crate::usual::{EXPANSION, HEAT_CAPACITY};
use crate::{Diagnostic, Spanned};

/// Reads what a material is to heat; `Some(None)` where it says nothing.
pub(super) fn thermal(material: &Table<'_>) -> Option<Option<Spanned<Thermal>>> {
    let Some(table) = material.table("thermal") else { return Some(None) };
    let place = table.place.clone();
    let conductivity = table.quantity("conductivity").physical().required();
    let heat_capacity = table.quantity("heat_capacity").physical().usual(&HEAT_CAPACITY).required();
    let least = |value: &f64| value.abs() < 1.0;
    let expansion =
        table.quantity("expansion").check(least, "a strain per kelvin, such as \"1e-5 1/K\"").usual(&EXPANSION);
    let expansion = expansion.or_if_absent(0.0);
    table.finish("here");
    let thermal = Thermal { conductivity: conductivity?, heat_capacity: heat_capacity?, expansion: expansion? };
    Some(Some(Spanned::new(thermal, place)))
}

/// Temperatures in degrees Celsius that are none in kelvin, but for the coldest of laboratories.
const CELSIUS: std::ops::Range<f64> = -273.15..200.0;

/// Warns of a temperature without a unit that was probably meant in degrees Celsius.
pub(super) fn doubt_kelvin(table: &Table<'_>, name: &str) {
    let Some(node) = table.node_below(name) else { return };
    let Some(number) = node.bare_number().filter(|number| CELSIUS.contains(number)) else { return };
    let note = Diagnostic::warning(Code::UnusualValue, &node.place, format!("{}, which is in kelvin", node.found()));
    let [celsius, kelvin] = [number + 273.15, number].map(|kelvin| {
        let mut text = String::new();
        push_shortest(&mut text, kelvin);
        text
    });
    table.reader.note(note.remedy(format!("write \"{celsius} K\" for degrees Celsius, else \"{kelvin} K\"")));
}

/// Reads heat, if there is any; nothing where it is wrong.
pub(super) fn read(root: &Table<'_>, solver: Option<&Solver>, staged: bool) -> Option<Option<Heat>> {
    let alone = |solver: &&Solver| solver.kind == SolverKind::Heat;
    let Some(table) = root.table("heat") else {
        if let Some(solver) = solver.filter(alone) {
            let note = Diagnostic::error(&solver.place, "= \"heat\" without heat").expected("a table [heat]");
            root.reader.note(note);
            return None;
        }
        return Some(None);
    };
    let place = table.place.clone();
    let initial = field(&table, "initial_temperature").spanned().required();
    ["initial_temperature", "stress_free_temperature"].iter().for_each(|name| doubt_kelvin(&table, name));
    let stress_free = optional(&table, "stress_free_temperature", |name| table.quantity(name).positive().given());
    let scheme = table.choice("scheme").or_if_absent(HeatScheme::Explicit);
    let step = optional(&table, "step", |name| table.quantity(name).positive().spanned().given());
    if let (Some(HeatScheme::Implicit), Some(None)) = (scheme, &step) {
        table.reader.note_missing(&table.place_of("step"), "with scheme = \"implicit\": a time such as \"1 ms\"");
        return None;
    }
    let packing = table.choice("packing").or_if_absent(PackingConduction::Measured);
    let conditions: Vec<Option<HeatCondition>> = table.tables("conditions").into_iter().map(condition).collect();
    table.finish("here");
    if let Some(solver) = solver.filter(|solver| matches!(solver.kind, SolverKind::Auto | SolverKind::Modes)) {
        let note = Diagnostic::error(&place, "is conducted in motion, at rest, or alone");
        let note = note.expected("solver.kind = \"explicit\", \"static\" or \"heat\"");
        root.reader.note(note.remedy(format!("solver.kind at line {} is another one", solver.place.line)));
        return None;
    }
    let statics = solver.filter(|solver| solver.kind == SolverKind::Static).and_then(|solver| solver.statics.as_ref());
    if statics.is_some_and(|statics| statics.opening.is_some() || matches!(statics.control, Some(Control::Path))) {
        let note = Diagnostic::error(&place, "does not flow back along a path of equilibrium");
        root.reader.note(note.expected("control = \"time\" in [solver], or none"));
        return None;
    }
    if staged {
        root.reader.note(Diagnostic::error(&place, "stands beside stages").expected("one [solver] without stages"));
        return None;
    }
    Some(Some(Heat {
        place,
        initial: initial?,
        stress_free: stress_free?,
        scheme: scheme?,
        step: step?,
        packing: packing?,
        conditions: conditions.into_iter().collect::<Option<_>>()?,
    }))
}

fn condition(table: Table<'_>) -> Option<HeatCondition> {
    let on = selection(&table);
    let kind = exactly_one(&table, &["temperature", "flux", "power", "source", "convection"]);
    doubt_kelvin(&table, "temperature");
    let function = |name| time_function(&table, name).spanned().required();
    let kind = kind.and_then(|kind| match kind {
        "temperature" => function(kind).map(HeatKind::Temperature),
        "flux" => function(kind).map(HeatKind::Flux),
        "power" => function(kind).map(HeatKind::Power),
        "source" => function(kind).map(HeatKind::Source),
        _ => convection(&table),
    });
    let on_surface = matches!(kind, Some(HeatKind::Flux(_) | HeatKind::Convection { .. }));
    if kind.is_some() && !on_surface {
        table.refuse("area", "without flux or convection");
    }
    let area = optional(&table, "area", |name| table.quantity(name).positive().spanned().given());
    table.finish("here");
    Some(HeatCondition { on: on?, area: area?, kind: kind? })
}

fn convection(condition: &Table<'_>) -> Option<HeatKind> {
    let table = condition.table("convection")?;
    let coefficient = table.quantity("coefficient").physical().required();
    doubt_kelvin(&table, "ambient");
    let ambient = time_function(&table, "ambient").spanned().required();
    table.finish("here");
    Some(HeatKind::Convection { coefficient: coefficient?, ambient: ambient? })
}
