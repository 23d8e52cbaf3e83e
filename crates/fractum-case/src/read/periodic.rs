//! `[periodic]`: a box through whose sides particles meet.

use fractum_math::Vec3;

use super::names;
use super::time_functions::time_function;
use crate::model::{BoxServo, Periodic};
use crate::reader::Table;
use crate::reader::vectors::{AXES, point};
use crate::{Diagnostic, Spanned, TimeFunction};

/// Components of a gradient of velocity that a box can have.
const COMPONENTS: [(&str, [usize; 2]); 6] =
    [("xx", [0, 0]), ("yy", [1, 1]), ("zz", [2, 2]), ("xy", [0, 1]), ("yz", [1, 2]), ("xz", [0, 2])];

/// Reads the box; none where the case has none, nothing where it is wrong.
pub(super) fn read(root: &Table<'_>) -> Option<Option<Periodic>> {
    let Some(table) = root.table("periodic") else { return Some(None) };
    let corner = point(&table, "point").or_if_absent(Vec3::zeros());
    let size = point(&table, "size").check(|size| size.min() > 0.0, "three lengths above 0").spanned().required();
    let axes = axes(&table);
    let rates = components(&table, "strain_rate", &COMPONENTS);
    let servo = servo(&table);
    let rates = rates.map(Option::unwrap_or_default);
    let place = table.place.clone();
    table.finish("here");
    Some(Some(Periodic { place, point: corner?, size: size?, axes: axes?, rates: rates?, servo: servo? }))
}

fn axes(table: &Table<'_>) -> Option<[bool; 3]> {
    if !table.has("axes") {
        return Some([true; 3]);
    }
    let named = names::read(table, "axes", "axes")?;
    let mut axes = [false; 3];
    for name in &named {
        let Some(axis) = AXES.iter().position(|axis| *axis == name.value) else {
            let note = Diagnostic::error(&name.place, format!("= \"{}\" is no axis", name.value));
            table.reader.note(note.expected("\"x\", \"y\" or \"z\""));
            return None;
        };
        axes[axis] = true;
    }
    Some(axes)
}

/// A component of a tensor, by its indices.
type Component = ([usize; 2], Spanned<TimeFunction>);

/// Components of a table by their names; none where the table is absent.
fn components(
    parent: &Table<'_>,
    name: &'static str,
    known: &[(&'static str, [usize; 2])],
) -> Option<Option<Vec<Component>>> {
    if !parent.has(name) {
        return Some(None);
    }
    let table = parent.table(name)?;
    let given = known.iter().copied().filter(|(name, _)| table.has(name));
    let read: Option<Vec<_>> =
        given.map(|(name, at)| Some((at, time_function(&table, name).spanned().given()?))).collect();
    if read.as_ref().is_some_and(Vec::is_empty) {
        let names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
        let note = Diagnostic::error(&table.place, "has no component");
        table.reader.note(note.expected(format!("at least one of {}", names.join(", "))));
    }
    table.finish("here");
    read.filter(|read| !read.is_empty()).map(Some)
}

fn servo(parent: &Table<'_>) -> Option<Option<BoxServo>> {
    if !parent.has("servo") {
        return Some(None);
    }
    let table = parent.table("servo")?;
    let stress = components(&table, "stress", &COMPONENTS[..3]);
    if !table.has("stress") {
        table.reader.note_missing(&table.place_of("stress"), "a table such as { zz = \"-10 kPa\" }");
    }
    let rate = table.quantity("rate").positive().required();
    let slows_at = table.quantity("slows_at").check(|share| *share > 0.0 && *share <= 1.0, "above 0 and at most 1");
    let slows_at = slows_at.or_if_absent(0.1);
    table.finish("here");
    let stress = stress??.into_iter().map(|([axis, _], stress)| (axis, stress)).collect();
    Some(Some(BoxServo { stress, rate: rate?, slows_at: slows_at? }))
}
