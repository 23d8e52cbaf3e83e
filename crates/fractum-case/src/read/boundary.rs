//! `[[supports]]` and `[[loads]]`.

use std::collections::HashMap;

use fractum_math::Vec3;
use fractum_output::warning::Code;

use super::detonation::{self, Acts};
use super::firing::{self, Pulses};
use super::time_functions::time_function;
use crate::model::{InCracks, Load, LoadKind, Motion, Support, SurfaceSupport};
use crate::reader::Table;
use crate::reader::presence::{exactly_one, optional};
use crate::reader::vectors::{AXES, components};
use crate::selection::selection;
use crate::{Diagnostic, Spanned, TimeFunction};

/// Reads all supports; nothing where one of them is wrong.
pub(super) fn supports(root: &Table<'_>) -> Option<Vec<Support>> {
    let mut complete = true;
    let mut supports: Vec<Support> = Vec::new();
    // The support that moves a group along an axis, with its line.
    let mut moved: HashMap<(String, usize), (usize, u32)> = HashMap::new();
    for (index, table) in root.tables("supports").into_iter().enumerate() {
        let Some(support) = support(table) else {
            complete = false;
            continue;
        };
        for (axis, motion) in support.motion.iter().enumerate() {
            let Some(motion) = motion else { continue };
            // What two conditions have in common only the mesh can tell.
            let (Some(group), None) = (&support.on.group, &support.on.within) else { continue };
            let key = (group.value.clone(), axis);
            let &mut (other, line) = moved.entry(key).or_insert((index, motion.place.line));
            if other != index {
                let found = format!("moves group \"{}\" along {} too", group.value, AXES[axis]);
                let note = Diagnostic::error(&motion.place, found);
                root.reader.note(note.remedy(format!("the support at line {line} already does")));
                complete = false;
            }
        }
        supports.push(support);
    }
    complete &= unique(root, supports.iter().filter_map(|support| support.name.as_ref()));
    complete.then_some(supports)
}

/// Whether no two names are the same; notes those that are.
fn unique<'s>(root: &Table<'_>, names: impl Iterator<Item = &'s Spanned<String>>) -> bool {
    let mut seen: HashMap<&str, u32> = HashMap::new();
    let mut unique = true;
    for name in names {
        if let Some(line) = seen.get(name.value.as_str()) {
            let found = format!("= \"{}\" is taken at line {line}", name.value);
            root.reader.note(Diagnostic::error(&name.place, found).remedy("names are unique"));
            unique = false;
        } else {
            seen.insert(&name.value, name.place.line);
        }
    }
    unique
}

fn support(table: Table<'_>) -> Option<Support> {
    let name = table.text("name").spanned().given();
    let on = selection(&table);
    let mut motion: [Option<Spanned<Motion>>; 3] = [None, None, None];
    let mut complete = true;
    if table.has("fix") {
        match fixed_axes(&table, "fix") {
            Some(fixed) => motion = fixed,
            None => complete = false,
        }
    }
    let fix_rotation = if table.has("fix_rotation") {
        let axes = fixed_axes(&table, "fix_rotation");
        complete &= axes.is_some();
        let bits =
            |fixed: &[Option<Spanned<Motion>>; 3]| (0..3).fold(0, |bits, a| bits | u8::from(fixed[a].is_some()) << a);
        axes.map(|axes| Spanned::new(bits(&axes), table.place_of("fix_rotation")))
    } else {
        None
    };
    type Wrap = fn(TimeFunction) -> Motion;
    for (key, wrap) in [("velocity", Motion::Velocity as Wrap), ("displacement", Motion::Displacement as Wrap)] {
        if !table.has(key) {
            continue;
        }
        let moved = components(&table, key, |table, axis| {
            let function = time_function(table, axis).spanned().given()?;
            // A later stage begins from the displacements that there are.
            if key == "displacement" && !table.reader.is_later_stage.get() {
                warn_of_jump(table, &function);
            }
            Some(function.map(wrap))
        });
        complete &= moved.is_some();
        for (axis, moved) in moved.into_iter().flatten().enumerate() {
            match (&motion[axis], moved) {
                (Some(_), Some(moved)) => {
                    let note = Diagnostic::error(&moved.place, "moves an axis that this support already moves");
                    table.reader.note(note.remedy("name each axis once among fix, velocity, displacement"));
                    complete = false;
                }
                (None, Some(moved)) => motion[axis] = Some(moved),
                (_, None) => {}
            }
        }
    }
    let surface = surface_support(&table);
    complete &= surface.is_some();
    if complete && motion.iter().all(Option::is_none) && fix_rotation.is_none() && surface == Some(None) {
        let note = Diagnostic::error(&table.place, "prescribes no motion");
        table.reader.note(note.expected("one of fix, velocity, displacement, absorbing, elastic"));
        complete = false;
    }
    table.finish("here");
    Some(Support { name, on: on?, fix_rotation, motion: complete.then_some(motion)?, surface: surface? })
}

/// The keys `absorbing` and `elastic`, which stand alone; none of them gives none, a wrong one nothing.
fn surface_support(table: &Table<'_>) -> Option<Option<Spanned<SurfaceSupport>>> {
    let key = match (table.has("absorbing"), table.has("elastic")) {
        (false, false) => return Some(None),
        (true, false) => "absorbing",
        _ => "elastic",
    };
    let place = table.place_of(key);
    let others = ["fix", "velocity", "displacement", "absorbing", "fix_rotation"];
    if let Some(other) = others.iter().find(|other| **other != key && table.has(other)) {
        table.pass_over(&["absorbing", "elastic"]);
        let note = Diagnostic::error(&place, format!("stands beside {other}"));
        table.reader.note(note.remedy("give each its own [[supports]]"));
        return None;
    }
    if key == "absorbing" {
        let absorbs = table.flag("absorbing").given()?;
        return Some(absorbs.then(|| Spanned::new(SurfaceSupport::Absorbing, place)));
    }
    let springs = table.table("elastic")?;
    let [normal, tangential] =
        ["normal", "tangential"].map(|name| springs.quantity(name).not_negative().or_if_absent(0.0));
    if normal == Some(0.0) && tangential == Some(0.0) {
        let note = Diagnostic::error(&springs.place, "has no stiffness");
        springs.reader.note(note.expected("normal or tangential above 0"));
        return None;
    }
    springs.finish("here");
    Some(Some(Spanned::new(SurfaceSupport::Elastic { normal: normal?, tangential: tangential? }, place)))
}

pub(super) fn fixed_axes(table: &Table<'_>, key: &'static str) -> Option<[Option<Spanned<Motion>>; 3]> {
    let expected = "each of x, y, z at most once, such as \"xy\"";
    let once = |axes: &String| {
        axes.chars().all(|c| "xyz".contains(c)) && AXES.iter().all(|axis| axes.matches(axis).count() <= 1)
    };
    let axes = table.text(key).check(once, expected).spanned().given()?;
    let fixed = |axis: &str| axes.value.contains(axis).then(|| Spanned::new(Motion::Fixed, axes.place.clone()));
    Some(AXES.map(fixed))
}

/// A displacement that is not zero at the start means an infinite velocity.
fn warn_of_jump(table: &Table<'_>, function: &Spanned<TimeFunction>) {
    let start = function.value.value(0.0, Vec3::zeros());
    if !function.value.depends_on_position() && start != 0.0 {
        let note = Diagnostic::warning(Code::Jump, &function.place, format!("starts with a jump to {start} m"));
        table.reader.note(note.remedy("let it begin at 0, by a ramp for instance"));
    }
}

/// Reads all loads; nothing where one of them is wrong.
pub(super) fn loads(root: &Table<'_>) -> Option<Vec<Load>> {
    let pulses = firing::pulses(root);
    let loads: Vec<Option<Vec<Load>>> = root.tables("loads").into_iter().map(|table| load(table, &pulses)).collect();
    // A firing sequence gives its name to the pressures of all its holes.
    let names = loads.iter().flatten().filter_map(|loads| loads.first()?.name.as_ref());
    let unique = unique(root, names);
    let loads = loads.into_iter().collect::<Option<Vec<_>>>().filter(|_| unique)?;
    if !root.has("stages") {
        // The other stages may have them.
        pulses.tell_unused(root.reader);
    }
    Some(loads.into_iter().flatten().collect())
}

fn load(table: Table<'_>, pulses: &Pulses) -> Option<Vec<Load>> {
    const KINDS: &[&str] = &["force", "traction", "pressure", "gravity", "firing"];
    let name = table.text("name").spanned().given();
    let kind = exactly_one(&table, KINDS)?;
    if kind == "firing" {
        for key in ["group", "where"] {
            table.refuse(key, "with firing, whose rows name the groups");
        }
        let how = acts(&table);
        let loads = firing::sequence(&table, pulses, name, how);
        table.finish("here");
        return loads;
    }
    let on = if kind == "gravity" {
        for key in ["group", "where"] {
            table.refuse(key, "with gravity, which acts on the whole scene");
        }
        None
    } else {
        selection(&table)
    };
    let by_components = || components(&table, kind, |table, axis| time_function(table, axis).spanned().given());
    let kind = match kind {
        "force" => by_components().and_then(|force| Some(LoadKind::Force { on: on?, force })),
        "traction" => by_components().and_then(|traction| Some(LoadKind::Traction { on: on?, traction })),
        "gravity" => by_components().map(|acceleration| LoadKind::Gravity { acceleration }),
        _ => {
            let pressure = time_function(&table, "pressure").spanned().required();
            table.refuse("scatter", "without firing, whose delays it is of");
            let how = acts(&table);
            pressure.and_then(|pressure| {
                let Acts { in_cracks, detonation } = how?;
                Some(LoadKind::Pressure { on: on?, pressure, in_cracks, detonation })
            })
        }
    };
    table.finish("here");
    Some(vec![Load { name, kind: kind? }])
}

/// Where and when a pressure acts beside its facets and time.
fn acts(table: &Table<'_>) -> Option<Acts> {
    let (in_cracks, detonation) = (in_cracks(table), detonation::detonation(table));
    let acts = Acts { in_cracks: in_cracks?, detonation: detonation? };
    if acts.in_cracks.is_some() {
        table.refuse("detonation", "with in_cracks, whose cracks have the pressure of all facets");
    }
    Some(acts)
}

/// The keys `in_cracks` and `front_speed` of a pressure; nothing where one of them is wrong.
fn in_cracks(table: &Table<'_>) -> Option<Option<InCracks>> {
    let enters = table.flag("in_cracks").or_if_absent(false)?;
    if !enters {
        table.refuse("front_speed", "where pressure does not enter cracks");
        return Some(None);
    }
    let speed = table.quantity("front_speed").check(|speed| *speed > 0.0, "a speed above 0");
    optional(table, "front_speed", |_| speed.given()).map(|front_speed| Some(InCracks { front_speed }))
}
