//! `[[bodies]]`.

use std::collections::HashMap;

use fractum_fem::{Formulation, Kinematics, Plane};
use fractum_output::warning::Code;

use super::bonded::bonded;
use super::loose::loose;
use super::materials;
use super::rigid::rigid;
use crate::model::{Body, BodyKind, Material, SolidBody, WHOLE_MESH};
use crate::reader::Table;
use crate::reader::presence::optional;
use crate::reader::vectors::{condition, field, initial_velocity};
use crate::unit::Dimension;
use crate::{Diagnostic, Spanned};

/// Reads all bodies against the materials read before; nothing where one of them is wrong.
pub(super) fn read(root: &Table<'_>, materials: &[(String, Option<Material>)]) -> Option<Vec<Body>> {
    let mut used = vec![false; materials.len()];
    let mut complete = true;
    let mut bodies: Vec<Body> = Vec::new();
    let mut taken = Taken::default();
    let tables = root.tables("bodies");
    if !root.has("bodies") || (tables.is_empty() && root.holds_array("bodies")) {
        root.reader.note_missing(&root.place_of("bodies"), "at least one body in [[bodies]]");
    }
    for table in tables {
        let Some(body) = body(table, materials, &mut used) else {
            complete = false;
            continue;
        };
        complete &= taken.add(root, &body);
        bodies.push(body);
    }
    for ((_, material), _) in materials.iter().zip(used).filter(|(_, used)| !used) {
        if let Some(material) = material
            && complete
        {
            root.reader.note(Diagnostic::warning(Code::Unused, &material.name.place, "is not used by any body"));
        }
    }
    (complete && !bodies.is_empty()).then_some(bodies)
}

/// Names and mesh groups that bodies have taken.
#[derive(Default)]
struct Taken {
    /// Line of each name.
    names: HashMap<String, u32>,
    /// Body of each mesh group.
    groups: HashMap<String, String>,
}

impl Taken {
    /// Adds a body; notes it where an earlier one has its name or its group, and gives false.
    fn add(&mut self, root: &Table<'_>, body: &Body) -> bool {
        let name = &body.name;
        if let Some(line) = self.names.get(&name.value) {
            let found = format!("= \"{}\" is taken by the body at line {line}", name.value);
            root.reader.note(Diagnostic::error(&name.place, found).remedy("names of bodies are unique"));
            return false;
        }
        self.names.insert(name.value.clone(), name.place.line);
        let BodyKind::Solid(solid) = &body.kind else { return true };
        let group = &solid.group;
        // In stages one may come in where the other has left; who is there at a time, the mesh tells.
        if let Some(other) = self.groups.get(&group.value).filter(|_| !root.has("stages")) {
            let found = format!("= \"{}\" is already the body \"{other}\"", group.value);
            root.reader.note(Diagnostic::error(&group.place, found).remedy("an element belongs to one body"));
            return false;
        }
        self.groups.insert(group.value.clone(), name.value.clone());
        true
    }
}

fn body(table: Table<'_>, materials: &[(String, Option<Material>)], used: &mut [bool]) -> Option<Body> {
    #[derive(Clone, Copy)]
    enum Kind {
        Solid,
        Bonded,
        Particles,
        Rigid,
    }
    let name = table.text("name").spanned().required();
    let kinds =
        [("solid", Kind::Solid), ("bonded", Kind::Bonded), ("particles", Kind::Particles), ("rigid", Kind::Rigid)];
    let kind = table.one_of("kind", &kinds).required();
    let (kind, why) = match kind {
        Some(Kind::Solid) => (solid(&table, materials, used).map(BodyKind::Solid), "on a solid body"),
        Some(Kind::Bonded) => {
            let material = material_of(&table, materials, used);
            let here = material.and_then(|index| materials[index].1.as_ref());
            refuse_beds(&table, here, "bonded bodies");
            (bonded(&table, material, here).map(BodyKind::Bonded), "on a bonded body")
        }
        Some(Kind::Particles) => {
            let material = material_of(&table, materials, used);
            refuse_beds(&table, material.and_then(|index| materials[index].1.as_ref()), "loose particles");
            (loose(&table, material).map(BodyKind::Particles), "on loose particles")
        }
        Some(Kind::Rigid) => {
            let material = table.has("material").then(|| material_of(&table, materials, used));
            let here = material.flatten().and_then(|index| materials[index].1.as_ref());
            (rigid(&table, material, here).map(Box::new).map(BodyKind::Rigid), "on a rigid body")
        }
        None => return None, // which keys belong here is not known
    };
    table.finish(why);
    Some(Body { name: name?, kind: kind? })
}

/// Beds have an effect in solids only.
fn refuse_beds(table: &Table<'_>, material: Option<&Material>, bodies: &str) {
    let Some(material) = material.filter(|material| material.bedding.is_some()) else { return };
    let place = table.place_below("material");
    let found = format!("= \"{}\", whose bedding has no effect on {bodies}", material.name.value);
    let note = Diagnostic::error(&place, found).expected("a material without bedding");
    table.reader.note(note.remedy("take a solid body, or a material without the table"));
}

fn solid(table: &Table<'_>, materials: &[(String, Option<Material>)], used: &mut [bool]) -> Option<SolidBody> {
    let group = if table.has("group") {
        table.text("group").spanned().required()
    } else {
        Some(Spanned { value: WHOLE_MESH.to_owned(), place: table.place_below("group") })
    };
    let material = material_of(table, materials, used);
    let material_here = material.and_then(|index| materials[index].1.as_ref());
    // A material that is wrong itself says nothing about damage.
    let may_damage = material_here.map(|material| material.damage.is_some());
    if may_damage == Some(false) {
        table.refuse("damage", "without damage in its material");
    }
    let is_wanted = table.flag("damage").or(true);
    let damage = may_damage.unwrap_or(false) && is_wanted;
    for key in ["damage_where", "strength_factor"] {
        match may_damage {
            Some(true) if !damage => table.set_aside(key, "while damage = false"),
            Some(false) => table.refuse(key, "without damage"),
            _ => {}
        }
    }
    let damage_where = optional(table, "damage_where", |name| condition(table, name).spanned().given());
    let strength_factor = optional(table, "strength_factor", |name| {
        let factor =
            field(table, name).check(|field| field.constant_value().is_none_or(|value| value > 0.0), "more than 0");
        factor.spanned().given()
    });
    let usual = if damage { Formulation::Smoothed } else { Formulation::Standard };
    let formulation = table.choice("formulation").or(usual);
    let kinematics = table.choice("kinematics").or(Kinematics::Auto);
    let plane = table.choice::<Plane>("plane").spanned().given();
    let thickness = table.quantity("thickness").positive().spanned().given();
    let depth = thickness.as_ref().map_or(table.reader.scale.of(Dimension::LENGTH), |thickness| thickness.value);
    let initial_velocity = initial_velocity(table);
    Some(SolidBody {
        group: group?,
        material: material?,
        formulation,
        kinematics,
        plane,
        thickness,
        depth,
        initial_velocity: initial_velocity?,
        damage,
        damage_where: damage_where?,
        strength_factor: strength_factor?,
    })
}

/// The material that a body names, which counts as used from now on.
fn material_of(table: &Table<'_>, materials: &[(String, Option<Material>)], used: &mut [bool]) -> Option<usize> {
    let name = table.text("material").spanned().required();
    let material = name.and_then(|name| materials::named(table.reader, &name, materials));
    if let Some(used) = material.and_then(|index| used.get_mut(index)) {
        *used = true;
    }
    material
}
