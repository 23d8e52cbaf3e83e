//! `[liquid]`.

use fractum_scene::CubicLaw;

use super::names;
use super::time_functions::time_function;
use crate::Diagnostic;
use crate::model::{Liquid, LiquidInjection};
use crate::reader::Table;
use crate::reader::presence::exactly_one;
use crate::selection::selection;

/// Reads the liquid, if there is any; nothing where it is wrong.
pub(super) fn read(root: &Table<'_>) -> Option<Option<Liquid>> {
    let Some(table) = root.table("liquid") else { return Some(None) };
    let place = table.place.clone();
    let interfaces = names::read(&table, "interfaces", "interfaces");
    let viscosity = table.quantity("viscosity").positive().required();
    let [roughness, aperture, compressibility, leak_off] =
        ["wall_roughness", "aperture", "compressibility", "leak_off"]
            .map(|key| table.quantity(key).not_negative().or_if_absent(0.0));
    let injections: Vec<Option<LiquidInjection>> = table.tables("injections").into_iter().map(injection).collect();
    if injections.is_empty() {
        let note = Diagnostic::error(&table.place_of("injections"), "is missing");
        table.reader.note(note.expected("at least one [[liquid.injections]]"));
        return None;
    }
    table.finish("here");
    Some(Some(Liquid {
        place,
        interfaces: interfaces?,
        law: CubicLaw { viscosity: viscosity?, roughness: roughness? },
        aperture: aperture?,
        compressibility: compressibility?,
        leak_off: leak_off?,
        injections: injections.into_iter().collect::<Option<_>>()?,
    }))
}

fn injection(table: Table<'_>) -> Option<LiquidInjection> {
    let on = selection(&table);
    let kind = exactly_one(&table, &["rate", "pressure"])?;
    let value = time_function(&table, kind).spanned().required();
    table.finish("here");
    Some(LiquidInjection { on: on?, value: value?, by_pressure: kind == "pressure" })
}
