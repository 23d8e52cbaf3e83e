//! `[liquid]`.

use fractum_scene::CubicLaw;

use super::gas::symmetry;
use super::names;
use super::time_functions::time_function;
use crate::Diagnostic;
use crate::model::{Liquid, LiquidDrive, LiquidHole, LiquidInjection};
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
    let symmetry = symmetry(&table);
    let holes: Vec<Option<LiquidHole>> = table.tables("holes").into_iter().map(hole).collect();
    let injections: Vec<Option<LiquidInjection>> = table.tables("injections").into_iter().map(injection).collect();
    if injections.is_empty() && holes.iter().flatten().all(|hole| hole.drive.is_none()) {
        let note = Diagnostic::error(&table.place_of("injections"), "is missing");
        table
            .reader
            .note(note.expected("at least one [[liquid.injections]], or liquid.holes[] with a rate or pressure"));
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
        symmetry: symmetry?,
        holes: holes.into_iter().collect::<Option<_>>()?,
        injections: injections.into_iter().collect::<Option<_>>()?,
    }))
}

fn hole(table: Table<'_>) -> Option<LiquidHole> {
    let on = selection(&table);
    let [stemmed, sealed] = ["stemmed", "sealed"].map(|key| table.flag(key).or_if_absent(false));
    let storage = table.quantity("storage").not_negative().or_if_absent(0.0);
    let is_driven = table.has("rate") || table.has("pressure");
    let drive = if is_driven { drive(&table).map(Some) } else { Some(None) };
    table.finish("here");
    Some(LiquidHole { on: on?, stemmed: stemmed?, is_sealed: sealed?, storage: storage?, drive: drive? })
}

fn injection(table: Table<'_>) -> Option<LiquidInjection> {
    let on = selection(&table);
    let drive = drive(&table);
    table.finish("here");
    Some(LiquidInjection { on: on?, drive: drive? })
}

/// The one of rate and pressure that is there.
fn drive(table: &Table<'_>) -> Option<LiquidDrive> {
    let kind = exactly_one(table, &["rate", "pressure"])?;
    let value = time_function(table, kind).spanned().required();
    Some(LiquidDrive { value: value?, by_pressure: kind == "pressure" })
}
