//! `[[ties]]`, and the solids that bonded bodies take the place of.

use crate::model::{Body, BodyKind, Tie};
use crate::reader::Table;
use crate::{Diagnostic, Spanned, nearest};

/// Reads all ties against the bodies read before; nothing where one of them is wrong.
pub(super) fn read(root: &Table<'_>, bodies: Option<&[Body]>) -> Option<Vec<Tie>> {
    let tables = root.tables("ties");
    let ties: Vec<Option<Tie>> = tables.into_iter().map(|table| tie(table, bodies)).collect();
    let solids = bodies
        .is_none_or(|bodies| bodies.iter().filter(|body| !replaced_solid_exists(root, body, bodies)).count() == 0);
    ties.into_iter().collect::<Option<_>>().filter(|_| solids)
}

fn tie(table: Table<'_>, bodies: Option<&[Body]>) -> Option<Tie> {
    let solid = table.text("solid").spanned().required();
    let bonded = table.text("bonded").spanned().required();
    let within = table.quantity("within").positive().map(Some).or_if_absent(None);
    let known = |name: &Spanned<String>| {
        let body = name.value.split('.').next().unwrap_or_default();
        let Some(bodies) = bodies else { return true };
        let names: Vec<&str> = bodies
            .iter()
            .filter(|body| matches!(body.kind, BodyKind::Bonded(_)))
            .map(|body| body.name.value.as_str())
            .collect();
        let found = names.contains(&body) || names.contains(&name.value.as_str());
        if !found {
            let note = Diagnostic::error(&name.place, format!("= \"{}\"", name.value));
            let note = note.expected("a body of kind \"bonded\", or a set of its particles, BODY.SET");
            table.reader.note(match nearest(body, names.iter().copied()) {
                Some(near) => note.remedy(format!("did you mean \"{near}\"?")),
                None => note,
            });
        }
        found
    };
    let bonded = bonded.filter(|name| known(name));
    table.finish("here");
    Some(Tie { solid: solid?, bonded: bonded?, within: within? })
}

/// Whether the solid that a body takes the place of is one; notes it where it is not.
fn replaced_solid_exists(root: &Table<'_>, body: &Body, bodies: &[Body]) -> bool {
    let BodyKind::Bonded(bonded) = &body.kind else { return true };
    let Some(replaces) = &bonded.replaces else { return true };
    let solids = bodies.iter().filter(|body| matches!(body.kind, BodyKind::Solid(_)));
    let names: Vec<&str> = solids.map(|body| body.name.value.as_str()).collect();
    let found = names.contains(&replaces.value.as_str());
    if !found {
        let note = Diagnostic::error(&replaces.place, format!("= \"{}\"", replaces.value));
        let note = note.expected("a body of kind \"solid\"");
        root.reader.note(match nearest(&replaces.value, names.iter().copied()) {
            Some(near) => note.remedy(format!("did you mean \"{near}\"?")),
            None => note,
        });
    }
    found
}
