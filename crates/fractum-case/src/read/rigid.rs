//! `[[bodies]]` of the kind `rigid`.

use fractum_math::Vec3;

use super::bonded::file;
use super::boundary::fixed_axes;
use super::time_functions::time_function;
use super::{materials, servo, unit};
use crate::Diagnostic;
use crate::model::{Material, RigidBody, RigidShape};
use crate::reader::Table;
use crate::reader::presence::optional;
use crate::reader::vectors::{AXES, components, direction, initial_velocity, point};
use crate::unit::Dimension;

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

/// Reads a rigid body.
///
/// - `material`: that of its elastic constants, where it has one; `here`: what it says of contact, where it is right
pub(super) fn rigid(table: &Table<'_>, material: Option<Option<usize>>, here: Option<&Material>) -> Option<RigidBody> {
    let kinds: Vec<(&'static str, Kind)> = SHAPES.into_iter().zip(KINDS).collect();
    let kind = table.one_of("shape", &kinds).required();
    let own_contact = materials::contact(table, &[]);
    let contact = own_contact.over(here.map(|material| material.contact).unwrap_or_default());
    let of_material = here.map_or(0.0, |material| material.work_of_adhesion);
    let solid_shape = matches!(kind, Some(Kind::Box | Kind::Cylinder | Kind::Sphere));
    if kind.is_some() && !solid_shape {
        table.refuse("inside", "but on a box, cylinder or sphere");
        table.refuse("free_rotation", "but on a box, cylinder or sphere");
    }
    let inside = table.flag("inside").or(false);
    let free_rotation = table.flag("free_rotation").or(false);
    let free = optional(table, "free", |name| fixed_axes(table, name));
    let free = free.map(|axes| axes.map_or([false; 3], |axes| axes.map(|axis| axis.is_some())));
    let by_components = |key| {
        let function = |table: &Table<'_>, axis| time_function(table, axis).spanned().given();
        optional(table, key, |name| components(table, name, function)).map(Option::unwrap_or_default)
    };
    let (velocity, spin, force) = (by_components("velocity"), by_components("spin"), by_components("force"));
    let moves = free.is_none_or(|free| free.contains(&true)) || free_rotation;
    let mass = if moves {
        let mass = table.quantity("mass").positive();
        if free.is_some() { mass.required().map(Some) } else { Some(mass.given()) }
    } else {
        table.refuse("mass", "on a body that is not free");
        Some(None)
    };
    let shape = match kind {
        Some(kind) => shape(table, kind),
        None => {
            table.pass_over(&["point", "normal", "axis", "size", "length", "radius", "group", "file", "unit"]);
            None
        }
    };
    let initial_velocity = initial_velocity(table);
    let servo = servo::servo(table, shape.as_ref());
    let rigid = RigidBody {
        shape: shape?,
        inside,
        material: material.map_or(Some(None), |index| index.map(Some))?,
        contact,
        work_of_adhesion: own_contact.work_of_adhesion.unwrap_or(of_material),
        own_contact,
        velocity: velocity?,
        spin: spin?,
        free: free?,
        free_rotation,
        mass: mass?,
        force: force?,
        servo: servo?,
        initial_velocity: initial_velocity?,
    };
    moves_one_way(table, &rigid).then_some(rigid)
}

/// Whether every axis is held, prescribed or free, and no more than one of these; notes where it is not.
fn moves_one_way(table: &Table<'_>, rigid: &RigidBody) -> bool {
    let mut fits = true;
    let mut clash = |key: String, found: &str, expected: &str| {
        table.reader.note(Diagnostic::error(&table.place_below(&key), found).expected(expected));
        fits = false;
    };
    if let Some(servo) = &rigid.servo {
        let (velocity, force) = (rigid.velocity[servo.axis].is_some(), rigid.force[servo.axis].is_some());
        let thrown = rigid.initial_velocity[servo.axis].is_some();
        let taken =
            [("velocity", velocity), ("force", force), ("initial_velocity", thrown), ("free", rigid.free[servo.axis])];
        servo::clash(servo, &taken, &mut clash);
    }
    for (axis, name) in AXES.iter().enumerate() {
        if rigid.free[axis] && rigid.velocity[axis].is_some() {
            clash(format!("velocity.{name}"), "prescribes what free releases", "one of the two");
        }
        if !rigid.free[axis] && rigid.force[axis].is_some() {
            clash(format!("force.{name}"), "acts along an axis that is held", "a force along a free axis");
        }
        if !rigid.free[axis] && rigid.initial_velocity[axis].is_some() {
            clash(format!("initial_velocity.{name}"), "is along an axis that is held", "one along a free axis");
        }
        if rigid.free_rotation && rigid.spin[axis].is_some() {
            clash(format!("spin.{name}"), "prescribes what free_rotation releases", "one of the two");
        }
    }
    fits
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
            let open = table.one_of("ends", &[("closed", false), ("open", true)]).or(false);
            if open {
                table.refuse("inside", "on a cylinder whose ends are open: particles feel its wall from both sides");
            }
            RigidShape::Cylinder { point: start?, axis: axis?, length: long?, radius: wide?, open }
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
            let unit = optional(table, "unit", |name| unit(table, name, Dimension::LENGTH));
            RigidShape::Stl {
                file: file?,
                unit: unit?.unwrap_or(table.reader.scale.of(Dimension::LENGTH)),
                point: start?,
            }
        }
    })
}
