//! `bodies[].servo`: rigid bodies that press with a given force.

use fractum_math::Vec3;

use super::names;
use super::time_functions::time_function;
use crate::Diagnostic;
use crate::model::{RigidShape, Servo, ServoArea, ServoForce};
use crate::reader::Table;
use crate::reader::presence::{exactly_one, optional};
use crate::reader::vectors::{AXES, direction};

/// Length of a unit vector's component along another axis that is rounding.
const ROUNDING: f64 = 1e-9;

/// Reads how a rigid body presses; nothing inside where it does not.
///
/// - `shape`: that of the body, where it is right
pub(super) fn servo(body: &Table<'_>, shape: Option<&RigidShape>) -> Option<Option<Servo>> {
    if !body.has("servo") {
        return Some(None);
    }
    let table = body.table("servo")?;
    let along = along(&table, shape);
    let force = force(&table, shape, along);
    let speed = table.quantity("speed").positive().required();
    let slows_at = table.quantity("slows_at").check(|share| *share > 0.0 && *share <= 1.0, "above 0 and at most 1");
    let slows_at = slows_at.or_if_absent(0.1);
    table.finish("here");
    let (axis, sign) = along?;
    Some(Some(Servo { axis, sign, force: force?, speed: speed?, slows_at: slows_at? }))
}

/// The axis along which it presses, and the sign.
fn along(table: &Table<'_>, shape: Option<&RigidShape>) -> Option<(usize, f64)> {
    let given = direction(table, "along");
    let wanted = match shape {
        Some(RigidShape::Plane { normal, .. }) => given.or_if_absent(*normal),
        Some(_) => given.required(),
        None => given.given(),
    }?;
    let axis = axis_of(&wanted);
    if axis.is_none() {
        let note = Diagnostic::error(&table.place_below("along"), "is not along an axis");
        table.reader.note(note.expected("x, y or z, or the opposite of one; turn the scene"));
    }
    axis
}

fn axis_of(direction: &Vec3) -> Option<(usize, f64)> {
    let axis = direction.iamax();
    (direction[axis].abs() > 1.0 - ROUNDING).then(|| (axis, direction[axis].signum()))
}

fn force(table: &Table<'_>, shape: Option<&RigidShape>, along: Option<(usize, f64)>) -> Option<ServoForce> {
    if exactly_one(table, &["force", "pressure"])? == "force" {
        for key in ["area", "between"] {
            table.refuse(key, "with a force");
        }
        return time_function(table, "force").spanned().required().map(ServoForce::Force);
    }
    let pressure = time_function(table, "pressure").spanned().required();
    let area = optional(table, "area", |name| table.quantity(name).positive().given());
    let between = names::read(table, "between", "rigid planes");
    let area = match (area?, between?) {
        (Some(area), planes) => {
            if !planes.is_empty() {
                table.refuse("between", "beside area");
            }
            ServoArea::Given(area)
        }
        (None, planes) if table.has("between") => {
            let Ok(planes) = <[_; 4]>::try_from(planes) else {
                let note = Diagnostic::error(&table.place_below("between"), "is not four planes");
                table.reader.note(note.expected("four rigid planes, each before the one opposite to it"));
                return None;
            };
            ServoArea::Between(Box::new(planes))
        }
        (None, _) => {
            let face = shape.zip(along).and_then(|(shape, (axis, _))| face(shape, axis));
            if shape.is_some() && along.is_some() && face.is_none() {
                let note = Diagnostic::error(&table.place, "has neither area nor between");
                let note = note.expected("the area that the pressure acts on, or the planes that enclose it");
                table.reader.note(note.remedy("boxes and cylinders along the direction have an area of their own"));
            }
            ServoArea::Given(face?)
        }
    };
    Some(ServoForce::Pressure { pressure: pressure?, area })
}

/// Area of the face of a shape across an axis [m²]; none where it has no flat one.
fn face(shape: &RigidShape, axis: usize) -> Option<f64> {
    match shape {
        RigidShape::Box { size, .. } => Some(size.product() / size[axis]),
        RigidShape::Cylinder { axis: own, radius, open: false, .. } if axis_of(own)?.0 == axis => {
            Some(std::f64::consts::PI * radius * radius)
        }
        _ => None,
    }
}

/// Notes what an axis along which a body presses cannot have beside.
pub(super) fn clash(servo: &Servo, taken: &[(&'static str, bool)], mut note: impl FnMut(String, &str, &str)) {
    let name = AXES[servo.axis];
    for (key, _) in taken.iter().filter(|(_, taken)| *taken) {
        let place = if *key == "free" { (*key).to_owned() } else { format!("{key}.{name}") };
        note(place, "is along the axis of servo", "another axis, or no servo");
    }
}
