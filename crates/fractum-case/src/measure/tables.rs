//! What several tables of probes have.

use fractum_dem::crack_shape::Axis;
use fractum_math::Vec3;
use fractum_scene::Along;

use crate::choice::choice;
use crate::reader::Table;
use crate::reader::vectors::{direction, point};
use crate::selection::{Selection, selection};
use crate::tree::Value;

/// A selection and a component of a vector.
pub(super) fn on_along(probe: &Table<'_>, key: &'static str) -> Option<(Selection, Along)> {
    let table = probe.table(key)?;
    let on = selection(&table);
    let along = along_or_about(&table);
    table.finish("here");
    Some((on?, along?))
}

/// A direction alone.
pub(super) fn along(probe: &Table<'_>, key: &'static str) -> Option<Vec3> {
    let table = probe.table(key)?;
    let along = direction(&table, "along").required();
    table.finish("here");
    along
}

/// The key `along`: a direction, or "radial" or "tangential" with the axis `about`.
pub(super) fn along_or_about(table: &Table<'_>) -> Option<Along> {
    let about: fn(Axis) -> Along = match table.peek("along").map(|node| &node.value) {
        Some(Value::Text(text)) if text == "radial" => Along::Radial,
        Some(Value::Text(text)) if text == "tangential" => Along::Tangential,
        _ => {
            table.refuse("about", "with a direction");
            return direction(table, "along").required().map(Along::Direction);
        }
    };
    table.node("along");
    axis(table).map(about)
}

/// The table `about`: an axis through a point, by default that of z.
pub(super) fn axis(table: &Table<'_>) -> Option<Axis> {
    let inner = table.table_or_empty("about");
    let point = point(&inner, "point").or_if_absent(Vec3::zeros());
    let direction = direction(&inner, "axis").or_if_absent(Vec3::z());
    inner.finish("here");
    Some(Axis { point: point?, direction: direction? })
}

/// Components of a symmetric tensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum StressComponent {
    /// σxx
    Xx,
    /// σyy
    Yy,
    /// σzz
    Zz,
    /// σxy
    Xy,
    /// σyz
    Yz,
    /// σzx
    Zx,
    /// Normal stress away from an axis.
    Radial,
    /// Normal stress around an axis.
    Tangential,
    /// Shear stress between both.
    RadialTangential,
}

choice!(StressComponent {
    "xx" => Xx, "yy" => Yy, "zz" => Zz, "xy" => Xy, "yz" => Yz, "zx" => Zx,
    "radial" => Radial, "tangential" => Tangential, "radial_tangential" => RadialTangential,
});

/// Where a tensor is measured, its component, and what else the table says of it.
pub(super) fn stress_or_strain<T>(
    table: Table<'_>,
    other: impl FnOnce(&Table<'_>) -> Option<T>,
) -> Option<(Selection, [Along; 2], T)> {
    let (on, other) = (selection(&table), other(&table));
    let component = table.choice("component").required();
    let between = component.and_then(|component| between(&table, component));
    table.finish("here");
    Some((on?, between?, other?))
}

/// Normal of the plane and direction of a component of stress or strain.
fn between(table: &Table<'_>, component: StressComponent) -> Option<[Along; 2]> {
    use StressComponent::{Radial, RadialTangential, Tangential, Xx, Xy, Yy, Yz, Zx, Zz};
    let [x, y, z] = [Vec3::x(), Vec3::y(), Vec3::z()].map(Along::Direction);
    let fixed = match component {
        Xx => [x, x],
        Yy => [y, y],
        Zz => [z, z],
        Xy => [x, y],
        Yz => [y, z],
        Zx => [z, x],
        Radial | Tangential | RadialTangential => {
            let axis = axis(table)?;
            let (radial, tangential) = (Along::Radial(axis), Along::Tangential(axis));
            return Some(match component {
                Radial => [radial, radial],
                Tangential => [tangential, tangential],
                _ => [radial, tangential],
            });
        }
    };
    table.refuse("about", "with this component");
    Some(fixed)
}
