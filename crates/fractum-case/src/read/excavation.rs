//! What stages take out: `stages[].excavate` and how its forces fade.

use fractum_output::number::quantity;

use super::names;
use crate::model::{Body, BodyKind, Case, Excavation, LoadKind};
use crate::reader::{Reader, Table};
use crate::{Diagnostic, Place, Spanned, nearest};

/// Reads what a stage takes out from the tree of the stage; none where nothing leaves and nothing fades.
pub(super) fn read(root: &Table<'_>) -> Option<Option<Excavation>> {
    let Some(table) = root.tables("stages").into_iter().next() else { return Some(None) };
    // Read before, by all stages together.
    _ = table.text("name").given();
    let bodies = names::read(&table, "excavate", "solid bodies");
    let release = table.quantity("release").not_negative().spanned().given();
    if bodies.as_ref().is_some_and(Vec::is_empty) {
        table.refuse("release_share", "in a stage that takes nothing out");
    }
    let share = table.quantity("release_share").check(|share| *share > 0.0 && *share <= 1.0, "above 0 and at most 1");
    let share = share.or(1.0);
    let place = table.peek("excavate").map_or_else(|| table.place.clone(), |node| node.place.clone());
    table.finish("here");
    let bodies = bodies?;
    let acts = !bodies.is_empty() || release.is_some();
    Some(acts.then_some(Excavation { place, bodies, release, share, gone: Vec::new() }))
}

/// Checks what all stages take out together, and tells each what has left by then.
pub(super) fn join(reader: &Reader, cases: &mut [Case]) {
    if cases.iter().all(|case| case.excavation.is_none()) {
        return;
    }
    let (mut gone, mut held_back): (Vec<(String, String)>, bool) = (Vec::new(), false);
    for index in 0..cases.len() {
        let begin = index.checked_sub(1).map(|before| cases[before].solver.end);
        let case = &mut cases[index];
        let stage = case.source.stage.clone();
        let (end, place) = (case.solver.end, case.solver.place.clone());
        let excavation = case.excavation.get_or_insert_with(|| Excavation::nothing(place));
        if begin.is_none() && !excavation.bodies.is_empty() {
            let note = Diagnostic::error(&excavation.place, "in the first stage, before which nothing is at rest");
            reader.note(note.expected("a later stage").remedy(
                "let a static stage come first, such as { name = \"before\", solver = { kind = \"static\", end = ... } }",
            ));
        }
        for name in &excavation.bodies {
            check_body(reader, &case.bodies, name, &gone);
            gone.push((name.value.clone(), stage.clone()));
        }
        if let Some(release) = &excavation.release {
            let lasts = end - begin.unwrap_or(0.0);
            if excavation.bodies.is_empty() && !held_back {
                let note = Diagnostic::error(&release.place, "has no effect in a stage in which nothing is released");
                reader.note(note.remedy("name bodies in excavate, or remove the key"));
            } else if release.value > lasts * (1.0 + 1e-9) {
                let [over, lasts] = [release.value, lasts].map(|time| quantity(time, "s"));
                let found = format!("= {over} in a stage that lasts {lasts}");
                reader.note(Diagnostic::error(&release.place, found).expected("no more than the stage lasts"));
            }
        }
        held_back = excavation.share < 1.0;
        excavation.gone = gone.iter().map(|(name, _)| name.clone()).collect();
    }
    let Some(first) = cases.iter().filter_map(|case| case.excavation.as_ref()).find(|own| !own.bodies.is_empty())
    else {
        return;
    };
    let first = first.place.clone();
    let solids = cases[0].bodies.iter().filter(|body| matches!(body.kind, BodyKind::Solid(_)));
    if solids.map(|body| &body.name.value).all(|name| gone.iter().any(|(left, _)| left == name)) {
        let note = Diagnostic::error(&first, "takes out all solids, with those of other stages");
        reader.note(note.expected("one solid at least that stays to the end"));
    }
    refuse_beside(reader, &cases[0], &first);
    for case in cases.iter() {
        let enters = |kind: &LoadKind| matches!(kind, LoadKind::Pressure { in_cracks: Some(_), .. });
        if case.loads.iter().any(|load| enters(&load.kind)) {
            let found = "beside a load with in_cracks: what leaves would count as cracks";
            reader.note(Diagnostic::error(&first, found).expected("pressures on facets alone"));
            break;
        }
    }
}

fn check_body(reader: &Reader, bodies: &[Body], name: &Spanned<String>, gone: &[(String, String)]) {
    let found = bodies.iter().find(|body| body.name.value == name.value);
    let solids = || bodies.iter().filter(|body| matches!(body.kind, BodyKind::Solid(_)));
    let names = || solids().map(|body| body.name.value.as_str());
    if !found.is_some_and(|body| matches!(body.kind, BodyKind::Solid(_))) {
        let found = found.map_or("is no body", |_| "is no solid body");
        let note = Diagnostic::error(&name.place, format!("= \"{}\" {found}", name.value));
        reader.note(match nearest(&name.value, names()) {
            Some(near) => note.remedy(format!("did you mean \"{near}\"?")),
            None => note.expected(format!("some of {}", names().collect::<Vec<_>>().join(", "))),
        });
    } else if let Some((_, stage)) = gone.iter().find(|(left, _)| *left == name.value) {
        let note = Diagnostic::error(&name.place, format!("= \"{}\" has left in stage \"{stage}\"", name.value));
        reader.note(note.remedy("a body leaves once; remove its name here"));
    }
}

/// What does not go together with bodies that leave.
fn refuse_beside(reader: &Reader, case: &Case, place: &Place) {
    let beside = [
        (!case.interfaces.is_empty(), "[[interfaces]]", "solids with common nodes"),
        (case.flows.gas.is_some(), "[gas]", "pressures as loads"),
    ];
    for (_, what, instead) in beside.into_iter().filter(|(there, ..)| *there) {
        reader.note(
            Diagnostic::error(place, format!("beside {what}, which knows no bodies that leave")).expected(instead),
        );
    }
}
