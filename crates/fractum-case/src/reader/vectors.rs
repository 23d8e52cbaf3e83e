//! Directions, points and components.

use fractum_math::Vec3;

use crate::expression::Type;
use crate::reader::{Reader, Reading, Table};
use crate::tree::{Node, Value};
use crate::unit::Dimension;
use crate::{Diagnostic, Field, Spanned};

/// Names of the axes.
pub(crate) const AXES: [&str; 3] = ["x", "y", "z"];

/// Takes a direction: `x`, `-y`, or three numbers; gives a unit vector.
pub(crate) fn direction<'t, 'a>(table: &'t Table<'a>, name: &'static str) -> Reading<'t, 'a, Vec3> {
    table.read(name, |node| {
        if let Value::Text(text) = &node.value {
            let (sign, axis) = match text.strip_prefix(['-', '+']) {
                Some(axis) => (if text.starts_with('-') { -1.0 } else { 1.0 }, axis),
                None => (1.0, text.as_str()),
            };
            if let Some(axis) = AXES.iter().position(|known| *known == axis) {
                let mut direction = Vec3::zeros();
                direction[axis] = sign;
                return Some(direction);
            }
        } else if let Value::Array(_) = node.value {
            let vector = triple(table.reader, node, Dimension::NONE)?;
            // scaled first, so that the length neither overflows nor vanishes
            let direction = (vector / vector.amax()).try_normalize(0.0).filter(|v| v.iter().all(|x| x.is_finite()));
            if direction.is_some() {
                return direction;
            }
        }
        let expected = "an axis such as \"x\" or \"-y\", or three numbers that are not all zero";
        table.reader.note(Diagnostic::error(&node.place, node.found()).expected(expected));
        None
    })
}

/// Takes a point: three quantities of the key's dimension.
pub(crate) fn point<'t, 'a>(table: &'t Table<'a>, name: &'static str) -> Reading<'t, 'a, Vec3> {
    table.read(name, |node| triple(table.reader, node, table.dimension(name)))
}

/// Takes a point in the plane of discs: two quantities of the key's dimension.
pub(crate) fn point_in_plane<'t, 'a>(table: &'t Table<'a>, name: &'static str) -> Reading<'t, 'a, Vec3> {
    table.read(name, |node| match &node.value {
        Value::Array(items) if items.len() == 2 => {
            let [x, y] = [0, 1].map(|i| table.reader.quantity(&items[i], table.dimension(name)));
            Some(Vec3::new(x?, y?, 0.0))
        }
        _ => {
            let note = Diagnostic::error(&node.place, node.found());
            table.reader.note(note.expected("a list of two numbers: discs lie in the xy-plane"));
            None
        }
    })
}

fn triple(reader: &Reader, node: &Node, dimension: Dimension) -> Option<Vec3> {
    match &node.value {
        Value::Array(items) if items.len() == 3 => {
            let [x, y, z] = [0, 1, 2].map(|i| reader.quantity(&items[i], dimension));
            Some(Vec3::new(x?, y?, z?))
        }
        _ => {
            reader.note(Diagnostic::error(&node.place, node.found()).expected("a list of three numbers"));
            None
        }
    }
}

/// Takes components along x, y, z from a table, at least one; nothing where the table is absent or a component is
/// wrong.
pub(crate) fn components<T>(
    parent: &Table<'_>,
    name: &'static str,
    mut read: impl FnMut(&Table<'_>, &'static str) -> Option<T>,
) -> Option<[Option<T>; 3]> {
    let table = parent.table(name)?;
    let mut complete = true;
    let components = AXES.map(|axis| {
        let value = table.has(axis).then(|| read(&table, axis));
        complete &= !matches!(value, Some(None));
        value.flatten()
    });
    if complete && components.iter().all(Option::is_none) {
        let note = Diagnostic::error(&table.place, "has no component").expected("at least one of x, y, z");
        table.reader.note(note);
        complete = false;
    }
    table.finish("here");
    complete.then_some(components)
}

/// Takes the velocity at the start by components; none where the key is absent.
pub(crate) fn initial_velocity(body: &Table<'_>) -> Option<[Option<Spanned<Field>>; 3]> {
    if !body.has("initial_velocity") {
        return Some([None, None, None]);
    }
    components(body, "initial_velocity", |table, axis| field(table, axis).spanned().given())
}

/// Takes an expression of x, y, z.
pub(crate) fn field<'t, 'a>(table: &'t Table<'a>, name: &'static str) -> Reading<'t, 'a, Field> {
    table.read(name, |node| {
        let (field, kind) = position_expression(table.reader, node, table.dimension(name))?;
        table.reader.check_dimension(node, kind, table.dimension(name)).then_some(field)
    })
}

/// Takes a condition on x, y, z.
pub(crate) fn condition<'t, 'a>(table: &'t Table<'a>, name: &'static str) -> Reading<'t, 'a, Field> {
    table.read(name, |node| condition_of(table.reader, node))
}

/// A condition on x, y, z.
pub(crate) fn condition_of(reader: &Reader, node: &Node) -> Option<Field> {
    let expected = "a condition such as \"abs(y) < 8 cm\"";
    if !matches!(node.value, Value::Text(_)) {
        reader.note(Diagnostic::error(&node.place, node.found()).expected(expected));
        return None;
    }
    let (field, kind) = position_expression(reader, node, Dimension::NONE)?;
    if kind != Type::Truth {
        let found = format!("{}, which is {}", node.found(), kind.phrase());
        reader.note(Diagnostic::error(&node.place, found).expected(expected));
        return None;
    }
    Some(field)
}

fn position_expression(reader: &Reader, node: &Node, dimension: Dimension) -> Option<(Field, Type)> {
    let variables =
        [("t", Dimension::TIME), ("x", Dimension::LENGTH), ("y", Dimension::LENGTH), ("z", Dimension::LENGTH)];
    let (field, kind) = expression(reader, node, dimension, &variables)?;
    if field.depends_on_time() {
        let note =
            Diagnostic::error(&node.place, node.found()).expected("an expression of x, y, z, without the time t");
        reader.note(note);
        return None;
    }
    Some((field, kind))
}

/// A number, or an expression of t, x, y, z and parameters; refused where it is constant and not finite.
pub(crate) fn expression(
    reader: &Reader,
    node: &Node,
    dimension: Dimension,
    variables: &[(&str, Dimension)],
) -> Option<(Field, Type)> {
    let Value::Text(text) = &node.value else {
        let (value, kind) = reader.constant(node, &dimension.expected())?;
        return Some((Field::constant(value * reader.scale.of_bare(kind, dimension)), kind));
    };
    let compiled = reader.compile(node, text, &mut reader.names(variables), false)?;
    if compiled.program.constant().is_some_and(|value| !value.is_finite()) {
        reader.note(Diagnostic::error(&node.place, node.found()).expected("a finite number"));
        return None;
    }
    let scale = reader.scale.of_bare(compiled.kind, dimension);
    if scale == 1.0 {
        return Some((Field(compiled.program), compiled.kind));
    }
    let larger = compiled.program.times(scale);
    if larger.is_none() {
        reader.note(Diagnostic::error(&node.place, node.found()).expected("an expression that is less deeply nested"));
    }
    Some((Field(larger?), compiled.kind))
}
