//! `[[bodies]]` of the kind `rigid`.

use super::bonded::file;
use super::boundary::fixed_axes;
use super::time_functions::time_function;
use super::vectors::{AXES, components, direction, field, point};
use super::{materials, unit};
use crate::case::Diagnostic;
use crate::case::model::{Components, RigidBody, RigidShape};
use crate::case::reader::Table;
use crate::case::unit::Dimension;
use fractum_math::Vec3;

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Plane,
    Box,
    Cylinder,
    Sphere,
    Group,
    Stl,
}

/// Names of the shapes of rigid bodies.
pub(super) const SHAPES: [&str; 6] = ["plane", "box", "cylinder", "sphere", "group", "stl"];
const KINDS: [Kind; 6] = [Kind::Plane, Kind::Box, Kind::Cylinder, Kind::Sphere, Kind::Group, Kind::Stl];

/// Reads a rigid body; `material` is that of its elastic constants, where it has one.
pub(super) fn rigid(table: &Table<'_>, material: Option<Option<usize>>) -> Option<RigidBody> {
    let kinds: Vec<(&'static str, Kind)> = SHAPES.into_iter().zip(KINDS).collect();
    let kind = table.one_of("shape", &kinds).required();
    let contact = materials::contact(table);
    let free = if table.has("free") {
        fixed_axes(table, "free").map(|axes| axes.map(|axis| axis.is_some()))
    } else {
        Some([false; 3])
    };
    let by_components = |key: &'static str| -> Option<Components> {
        if !table.has(key) {
            return Some([None, None, None]);
        }
        components(table, key, |table, axis| time_function(table, axis).given())
    };
    let (velocity, spin, force) = (by_components("velocity"), by_components("spin"), by_components("force"));
    let solid_shape = matches!(kind, Some(Kind::Box | Kind::Cylinder | Kind::Sphere));
    if kind.is_some() && !solid_shape {
        table.refuse("inside", "but on a box, cylinder or sphere");
        table.refuse("free_rotation", "but on a box, cylinder or sphere");
    }
    let inside = table.flag("inside").or(false);
    let free_rotation = table.flag("free_rotation").or(false);
    let moves = free.is_some_and(|free| free.contains(&true)) || free_rotation;
    let mass = if moves {
        table.quantity("mass").positive().required().map(Some)
    } else {
        table.refuse("mass", "on a body that is not free");
        Some(None)
    };
    let shape = shape(table, kind?);
    let initial_velocity = match table.has("initial_velocity") {
        true => components(table, "initial_velocity", |table, axis| field(table, axis).given()),
        false => Some([None, None, None]),
    };
    let (velocity, spin, force, free, initial_velocity) = (velocity?, spin?, force?, free?, initial_velocity?);
    let mut fits = true;
    for axis in 0..3 {
        let mut clash = |found: String, expected: &str| {
            table.reader.note(Diagnostic::error(&table.place, found).expected(expected));
            fits = false;
        };
        if free[axis] && velocity[axis].is_some() {
            clash(format!("prescribes the velocity along {} and frees it", AXES[axis]), "one of the two");
        }
        if !free[axis] && force[axis].is_some() {
            clash(format!("has a force along {}, which is held", AXES[axis]), "a force along a free axis");
        }
        if !free[axis] && initial_velocity[axis].is_some() {
            clash(format!("has an initial velocity along {}, which is held", AXES[axis]), "one along a free axis");
        }
    }
    if free_rotation && spin.iter().any(Option::is_some) {
        table
            .reader
            .note(Diagnostic::error(&table.place, "prescribes its spin and frees it").expected("one of the two"));
        fits = false;
    }
    let material = match material {
        Some(material) => Some(material?),
        None => None,
    };
    let (shape, mass) = (shape?, mass?);
    fits.then_some(RigidBody {
        shape,
        inside,
        material,
        contact,
        velocity,
        spin,
        free,
        free_rotation,
        mass,
        force,
        initial_velocity,
    })
}

fn shape(table: &Table<'_>, kind: Kind) -> Option<RigidShape> {
    let start = point(table, "point").or_if_absent(Vec3::zeros());
    let length = |key: &'static str| table.quantity(key).positive().required();
    Some(match kind {
        Kind::Plane => {
            let normal = direction(table, "normal").required();
            RigidShape::Plane { point: start?, normal: normal? }
        }
        Kind::Box => {
            let size = point(table, "size").check(|size| size.min() > 0.0, "three lengths above 0").required();
            RigidShape::Box { point: start?, size: size? }
        }
        Kind::Cylinder => {
            let axis = direction(table, "axis").or_if_absent(Vec3::x());
            let (long, wide) = (length("length"), length("radius"));
            RigidShape::Cylinder { point: start?, axis: axis?, length: long?, radius: wide? }
        }
        Kind::Sphere => {
            let wide = length("radius");
            RigidShape::Sphere { point: start?, radius: wide? }
        }
        Kind::Group => {
            let group = table.text("group").spanned().required();
            RigidShape::Group { group: group?, point: start? }
        }
        Kind::Stl => {
            let file = file(table, "file");
            let given = unit(table, "unit", Dimension::LENGTH);
            if table.has("unit") && given.is_none() {
                return None;
            }
            RigidShape::Stl { file: file?, unit: given.unwrap_or(1.0), point: start? }
        }
    })
}
