//! What stages take out and put in: `stages[].excavate` and how its forces fade, `stages[].install`.

use fractum_output::number::quantity;

use super::names;
use crate::model::{Body, BodyKind, Case, Excavation, LoadKind};
use crate::reader::{Reader, Table};
use crate::{Diagnostic, Place, Spanned, nearest};

/// Reads what a stage takes out and puts in from the tree of the stage; none where nothing leaves, fades or comes in.
pub(super) fn read(root: &Table<'_>) -> Option<Option<Excavation>> {
    let Some(table) = root.tables("stages").into_iter().next() else { return Some(None) };
    // Read before, by all stages together.
    _ = table.text("name").given();
    let bodies = names::read(&table, "excavate", "solid bodies");
    let installed = names::read(&table, "install", "solid bodies");
    let release = table.quantity("release").not_negative().spanned().given();
    if bodies.as_ref().is_some_and(Vec::is_empty) {
        table.refuse("release_share", "in a stage that takes nothing out");
    }
    let share = table.quantity("release_share").check(|share| *share > 0.0 && *share <= 1.0, "above 0 and at most 1");
    let share = share.or(1.0);
    let named = table.peek("excavate").or(table.peek("install"));
    let place = named.map_or_else(|| table.place.clone(), |node| node.place.clone());
    table.finish("here");
    let (bodies, installed) = (bodies?, installed?);
    let acts = !bodies.is_empty() || !installed.is_empty() || release.is_some();
    let nothing = Excavation::nothing(place);
    Some(acts.then_some(Excavation { bodies, installed, release, share, ..nothing }))
}

/// Checks what all stages take out and put in together, and tells each who is not there by then.
pub(super) fn join(reader: &Reader, cases: &mut [Case]) {
    if cases.iter().all(|case| case.excavation.is_none()) {
        return;
    }
    let stage_of = |case: &Case, name: &Spanned<String>| (name.value.clone(), case.source.stage.clone());
    let of_stage = |case: &Case| -> Vec<(String, String)> {
        case.excavation.iter().flat_map(|own| &own.installed).map(|name| stage_of(case, name)).collect()
    };
    let mut to_come: Vec<(String, String)> = cases.iter().flat_map(of_stage).collect();
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
        if let (None, Some(name)) = (begin, excavation.installed.first()) {
            let note = Diagnostic::error(&name.place, format!("= \"{}\" in the first stage", name.value));
            reader.note(note.remedy("name it in a later stage, or in none: then it is there from the start"));
        }
        for name in &excavation.bodies {
            if let Some((_, later)) = to_come.iter().find(|(body, _)| *body == name.value) {
                let found = format!("= \"{}\" comes in in stage \"{later}\" only", name.value);
                reader.note(Diagnostic::error(&name.place, found).remedy("take it out in a stage after that"));
            }
            check_body(reader, &case.bodies, name, &gone);
            gone.push((name.value.clone(), stage.clone()));
        }
        excavation.to_come = to_come.iter().map(|(name, _)| name.clone()).collect();
        for name in &excavation.installed {
            check_body(reader, &case.bodies, name, &gone);
            let count = to_come.iter().filter(|(body, _)| *body == name.value).count();
            if count > 1 {
                let note = Diagnostic::error(&name.place, format!("= \"{}\" is named {count} times", name.value));
                reader.note(note.remedy("a body comes in once; name it in one stage"));
            }
            to_come.retain(|(body, _)| *body != name.value);
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
        excavation.gone = gone.iter().chain(&to_come).map(|(name, _)| name.clone()).collect();
    }
    let acts = |own: &&Excavation| !own.bodies.is_empty() || !own.installed.is_empty();
    let Some(first) = cases.iter().filter_map(|case| case.excavation.as_ref()).find(acts) else { return };
    let first = first.place.clone();
    let solids = cases[0].bodies.iter().filter(|body| matches!(body.kind, BodyKind::Solid(_)));
    let stays = |name: &&String| {
        let is_gone = |case: &Case| case.excavation.as_ref().is_some_and(|own| own.gone.contains(name));
        !cases.iter().any(is_gone)
    };
    if solids.map(|body| &body.name.value).filter(stays).count() == 0 {
        let note = Diagnostic::error(&first, "leaves no solid that is there all the time, with other stages");
        reader.note(note.expected("one solid at least that stays from the start to the end"));
    }
    refuse_beside(reader, cases, &first);
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
fn refuse_beside(reader: &Reader, cases: &[Case], place: &Place) {
    let case = &cases[0];
    let installs = cases.iter().filter_map(|case| case.excavation.as_ref()).any(|own| !own.installed.is_empty());
    let expands = case.flows.heat.is_some() && installs;
    let beside = [
        (expands, "[heat] and with install", "bodies that are there from the start"),
        (case.flows.gas.is_some(), "[gas]", "pressures as loads"),
    ];
    for (_, what, instead) in beside.into_iter().filter(|(there, ..)| *there) {
        reader.note(
            Diagnostic::error(place, format!("beside {what}, which knows no bodies that leave")).expected(instead),
        );
    }
}
