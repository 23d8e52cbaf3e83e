//! What probes measure, key by key.

use fractum_dem::StrainMeasure;
use fractum_dem::crack_shape::Axis;
use fractum_math::Vec3;
use fractum_scene::{
    Along, CrackMeasure, DamagedMeasure, FragmentMeasure, GasMeasure, RadialMeasure, SurfaceMeasure, TemperatureTake,
};

use super::boundary::selection;
use super::presence::optional;
use super::vectors::{condition, direction, point};
use crate::case::model::{ProbeKind, Selection, StressComponent};
use crate::case::reader::Table;
use crate::case::tree::Value;
use crate::case::unit::Dimension;

/// Everything but expressions, with its dimension.
pub(super) fn measured(table: &Table<'_>, key: &'static str) -> Option<(ProbeKind, Dimension)> {
    let on_along = || {
        let inner = table.table(key)?;
        let on = selection(&inner);
        let along = along_or_about(&inner);
        inner.finish("here");
        Some((on?, along?))
    };
    let along = || {
        let inner = table.table(key)?;
        let along = direction(&inner, "along").required();
        inner.finish("here");
        along
    };
    Some(match key {
        "reaction" => on_along().map(|(on, along)| (ProbeKind::Reaction { on, along }, Dimension::FORCE))?,
        "moment" => moment(table)?,
        "displacement" => on_along().map(|(on, along)| (ProbeKind::Displacement { on, along }, Dimension::LENGTH))?,
        "velocity" => on_along().map(|(on, along)| (ProbeKind::Velocity { on, along }, Dimension::VELOCITY))?,
        "rotation" => rotation(table)?,
        "contact_force" => {
            let inner = table.table(key)?;
            let [on, from] = ["on", "from"].map(|name| inner.text(name).spanned().required());
            let along = along_or_about(&inner);
            inner.finish("here");
            (ProbeKind::ContactForce { on: on?, from: from?, along: along? }, Dimension::FORCE)
        }
        "stress" => {
            let (on, between, _) = stress_or_strain(table.table(key)?, |_| Some(()))?;
            (ProbeKind::Stress { on, between }, Dimension::PRESSURE)
        }
        "strain" => {
            let measure = |inner: &Table<'_>| inner.choice("measure").or_if_absent(StrainMeasure::default());
            let (on, between, measure) = stress_or_strain(table.table(key)?, measure)?;
            (ProbeKind::Strain { on, measure, between }, Dimension::NONE)
        }
        "extensometer" => extensometer(table)?,
        "load" => on_along().map(|(on, along)| (ProbeKind::Load { on, along }, Dimension::FORCE))?,
        "surface" => {
            let inner = table.table(key)?;
            let on = selection(&inner);
            let measure = inner.choice("measure").required();
            inner.finish("here");
            let measure = measure?;
            let dimension = if measure == SurfaceMeasure::Area { Dimension::AREA } else { Dimension::VOLUME };
            (ProbeKind::Surface { on: on?, measure }, dimension)
        }
        "fragment" => fragment(table)?,
        "fragment_size" => {
            let share = table.quantity("fragment_size").between(0.0, 1.0).required()?;
            (ProbeKind::FragmentSize(share), Dimension::LENGTH)
        }
        "energy" => (ProbeKind::Energy(table.choice("energy").required()?), Dimension::ENERGY),
        "count" => (ProbeKind::Count(table.choice("count").required()?), Dimension::NONE),
        "momentum" => (ProbeKind::Momentum { along: along()? }, Dimension::MOMENTUM),
        "angular_momentum" => (ProbeKind::AngularMomentum { along: along()? }, Dimension::ANGULAR_MOMENTUM),
        "temperature" => temperature(table)?,
        "heat" => (ProbeKind::Heat(table.choice("heat").required()?), Dimension::ENERGY),
        "gas" => gas(table)?,
        "crack" => crack(table)?,
        "radial_cracks" => radial_cracks(table)?,
        "damaged" => damaged(table)?,
        "wave_speed" => {
            let inner = table.table(key)?;
            let body = inner.text("body").spanned().required();
            let wave = inner.choice("wave").required();
            inner.finish("here");
            (ProbeKind::WaveSpeed { body: body?, wave: wave? }, Dimension::VELOCITY)
        }
        _ => {
            table.flag("crack_area").check(|on| *on, "true; leave the probe out where it is not wanted").required()?;
            (ProbeKind::CrackArea, Dimension::AREA)
        }
    })
}

fn moment(table: &Table<'_>) -> Option<(ProbeKind, Dimension)> {
    let inner = table.table("moment")?;
    let (on, about) = (selection(&inner), axis(&inner));
    inner.finish("here");
    Some((ProbeKind::Moment { on: on?, about: about? }, Dimension::ENERGY))
}

fn rotation(table: &Table<'_>) -> Option<(ProbeKind, Dimension)> {
    let inner = table.table("rotation")?;
    let on = selection(&inner);
    let along = direction(&inner, "along").required();
    inner.finish("here");
    Some((ProbeKind::Rotation { on: on?, along: along? }, Dimension::NONE))
}

fn extensometer(table: &Table<'_>) -> Option<(ProbeKind, Dimension)> {
    let inner = table.table("extensometer")?;
    let on = selection(&inner);
    let [from, to] = ["from", "to"].map(|key| point(&inner, key).required());
    let foot = optional(&inner, "foot", |key| inner.quantity(key).positive().given());
    inner.finish("here");
    Some((ProbeKind::Extensometer { on: on?, ends: [from?, to?], foot: foot? }, Dimension::NONE))
}

/// The key `along`: a direction, or "radial" or "tangential" with the axis `about`.
fn along_or_about(table: &Table<'_>) -> Option<Along> {
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
fn axis(table: &Table<'_>) -> Option<Axis> {
    let inner = table.table_or_empty("about");
    let point = point(&inner, "point").or_if_absent(Vec3::zeros());
    let direction = direction(&inner, "axis").or_if_absent(Vec3::z());
    inner.finish("here");
    Some(Axis { point: point?, direction: direction? })
}

/// Where a tensor is measured, its component, and what else the table says of it.
fn stress_or_strain<T>(
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

fn gas(table: &Table<'_>) -> Option<(ProbeKind, Dimension)> {
    let inner = table.table("gas")?;
    let measure = inner.choice("measure").required();
    if measure == Some(GasMeasure::LeakedMass) {
        inner.refuse("group", "with leaked_mass, which is that of everything");
    }
    let group = optional(&inner, "group", |name| inner.text(name).spanned().given());
    inner.finish("here");
    let dimension = match measure? {
        GasMeasure::Pressure => Dimension::PRESSURE,
        GasMeasure::Temperature => Dimension::TEMPERATURE,
        GasMeasure::Mass | GasMeasure::LeakedMass => Dimension::MASS,
        GasMeasure::Energy => Dimension::ENERGY,
        GasMeasure::Volume => Dimension::LENGTH.power(3.0)?,
        GasMeasure::WettedArea => Dimension::AREA,
    };
    Some((ProbeKind::Gas { measure: measure?, group: group? }, dimension))
}

fn temperature(table: &Table<'_>) -> Option<(ProbeKind, Dimension)> {
    let inner = table.table("temperature")?;
    let on = selection(&inner);
    let take = inner.choice("take").or_if_absent(TemperatureTake::Mean);
    inner.finish("here");
    Some((ProbeKind::Temperature { on: on?, take: take? }, Dimension::TEMPERATURE))
}

fn fragment(table: &Table<'_>) -> Option<(ProbeKind, Dimension)> {
    let inner = table.table("fragment")?;
    let on = selection(&inner);
    let measure = inner.choice("measure").required();
    let along = if measure == Some(FragmentMeasure::Velocity) {
        direction(&inner, "along").required()
    } else {
        inner.refuse("along", "with this measure");
        Some(Vec3::zeros())
    };
    inner.finish("here");
    let measure = measure?;
    let dimension = match measure {
        FragmentMeasure::Mass => Dimension::MASS,
        FragmentMeasure::Volume => Dimension::VOLUME,
        FragmentMeasure::Size => Dimension::LENGTH,
        FragmentMeasure::Velocity => Dimension::VELOCITY,
    };
    Some((ProbeKind::Fragment { on: on?, measure, along: along? }, dimension))
}

fn crack(table: &Table<'_>) -> Option<(ProbeKind, Dimension)> {
    let inner = table.table("crack")?;
    let measure = inner.choice("measure").required();
    let along = if measure.is_none_or(CrackMeasure::has_direction) {
        direction(&inner, "along").required()
    } else {
        inner.refuse("along", "with this measure");
        Some(Vec3::zeros())
    };
    let within = optional(&inner, "where", |name| condition(&inner, name).spanned().given());
    let about_axis = matches!(measure, Some(CrackMeasure::Helix | CrackMeasure::Cone | CrackMeasure::ConeShare));
    let origin = if about_axis {
        point(&inner, "point").or_if_absent(Vec3::zeros())
    } else {
        inner.refuse("point", "with this measure");
        Some(Vec3::zeros())
    };
    inner.finish("here");
    let measure = measure?;
    let dimension = match measure {
        CrackMeasure::Area => Dimension::AREA,
        CrackMeasure::Centre | CrackMeasure::Front | CrackMeasure::Length | CrackMeasure::Tip => Dimension::LENGTH,
        _ => Dimension::NONE,
    };
    Some((ProbeKind::Crack { measure, along: along?, point: origin?, within: within? }, dimension))
}

fn radial_cracks(table: &Table<'_>) -> Option<(ProbeKind, Dimension)> {
    let inner = table.table("radial_cracks")?;
    let measure = inner.choice("measure").required();
    let about = axis(&inner);
    let radius = if measure == Some(RadialMeasure::Count) {
        inner.quantity("radius").positive().required()
    } else {
        inner.refuse("radius", "with this measure");
        Some(0.0)
    };
    let within = optional(&inner, "where", |name| condition(&inner, name).spanned().given());
    inner.finish("here");
    let measure = measure?;
    let dimension = if measure == RadialMeasure::Count { Dimension::NONE } else { Dimension::LENGTH };
    Some((ProbeKind::RadialCracks { measure, about: about?, radius: radius?, within: within? }, dimension))
}

fn damaged(table: &Table<'_>) -> Option<(ProbeKind, Dimension)> {
    let inner = table.table("damaged")?;
    let measure = inner.choice("measure").required();
    let threshold =
        inner.quantity("threshold").check(|share| *share > 0.0 && *share <= 1.0, "above 0, up to 1").or(0.5);
    let group = optional(&inner, "group", |name| inner.text(name).spanned().given());
    let within = optional(&inner, "where", |name| condition(&inner, name).spanned().given());
    inner.finish("here");
    let measure = measure?;
    let dimension = match measure {
        DamagedMeasure::Volume => Dimension::VOLUME,
        DamagedMeasure::Area => Dimension::AREA,
        DamagedMeasure::Share => Dimension::NONE,
    };
    Some((ProbeKind::Damaged { measure, threshold, group: group?, within: within? }, dimension))
}
