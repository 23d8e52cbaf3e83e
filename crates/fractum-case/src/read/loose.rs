//! `[[bodies]]` of the kind `particles`.

use fractum_dem::ClumpShape;
use fractum_math::{Rotation, Vec3, rotation_by};

use super::bonded::{DISPERSION_RANGE, file, frame, groups};
use super::{file_unit, inlet, metres, sizes};
use crate::model::{Amount, Clump, LooseBody, LooseSource, Region, Sizes, Turn};
use crate::reader::Table;
use crate::reader::presence::optional;
use crate::reader::vectors::{direction, initial_velocity, point};
use crate::unit::Dimension;
use crate::{Diagnostic, Spanned};

#[derive(Clone, Copy)]
enum Kind {
    Box,
    Cylinder,
    Sphere,
}

/// Reads loose particles of the material at `material`, which is nothing where it is wrong.
pub(super) fn loose(table: &Table<'_>, material: Option<usize>) -> Option<LooseBody> {
    let shape = clump_shape(table);
    let turn = turn(table, shape.is_some());
    let size = shape.as_ref().and_then(|shape| shape.as_ref()).map(|shape| shape.value.radius());
    let has_centre = !table.has("file") && table.has("centre");
    let source = if table.has("file") {
        from_file(table, shape.is_some())
    } else if has_centre {
        single(table, size)
    } else {
        cloud(table, size)
    };
    if table.has("inlet") {
        table.refuse("groups", "beside inlet: where a particle comes in is not known before");
        table.refuse("clump", "beside inlet: only single spheres come in as time goes on");
    }
    let groups = groups(table);
    let initial_velocity = initial_velocity(table);
    let clump = match (shape, turn?) {
        (None, _) => None,
        (Some(shape), turn) => {
            let seed = table.integer("seed").or(1);
            let by_chance = if has_centre { Turn::By(Rotation::identity()) } else { Turn::ByChance(seed) };
            Some(shape?.map(|shape| Clump { shape, turn: turn.map_or(by_chance, Turn::By) }))
        }
    };
    Some(LooseBody {
        material: material?,
        source: source?,
        clump,
        groups: groups?,
        initial_velocity: initial_velocity?,
    })
}

/// The shape of clumps: nothing without one, `Some(None)` where it is wrong.
fn clump_shape(table: &Table<'_>) -> Option<Option<Spanned<ClumpShape>>> {
    if !table.has("clump") {
        return None;
    }
    let spheres = table.tables("clump").into_iter().map(|sphere| {
        let at = point(&sphere, "at").required();
        let radius = sphere.quantity("radius").positive().required();
        sphere.finish("in a clump");
        Some((at?, radius?))
    });
    // All of them are read, so that all mistakes are told.
    let spheres: Vec<Option<(Vec3, f64)>> = spheres.collect();
    let Some(spheres) = spheres.into_iter().collect::<Option<Vec<_>>>() else { return Some(None) };
    let place = table.place_below("clump");
    Some(match ClumpShape::new(&spheres) {
        Ok(shape) => Some(Spanned::new(shape, place)),
        Err(error) => {
            let note = Diagnostic::error(&place, error.to_string());
            table.reader.note(note.expected("1 to 100 spheres that touch or overlap, each of another place or size"));
            None
        }
    })
}

/// How all grains are turned; `Some(None)` where nothing says it.
fn turn(table: &Table<'_>, is_clump: bool) -> Option<Option<Rotation>> {
    if !is_clump {
        table.refuse("orientation", "without clump: a sphere looks the same from all sides");
    }
    let Some(orientation) = table.table("orientation").filter(|_| is_clump) else { return Some(None) };
    let axis = direction(&orientation, "axis").required();
    let angle = orientation.quantity("angle").required();
    orientation.finish("here");
    Some(Some(rotation_by(axis? * angle?)))
}

/// Keys of a shape that is filled with particles.
const OF_SHAPES: [&str; 11] = [
    "shape",
    "point",
    "size",
    "axis",
    "length",
    "radius",
    "particles",
    "dispersion",
    "sizes",
    "solid_fraction",
    "inlet",
];

/// A particle at a given place.
///
/// - `size`: radius of its clump as it is written [m]
fn single(table: &Table<'_>, size: Option<f64>) -> Option<LooseSource> {
    for key in OF_SHAPES.into_iter().chain(["seed", "unit", "velocity_unit", "frame", "species"]) {
        table.refuse(key, "beside centre, at which a single particle is");
    }
    let centre = point(table, "centre").required();
    let radius = radius(table, size);
    Some(LooseSource::Single { centre: centre?, radius: radius? })
}

/// Radius of particles; of clumps that of the sphere around one, as it is written if nothing says another.
fn radius(table: &Table<'_>, size: Option<f64>) -> Option<f64> {
    let radius = table.quantity("particle_radius").positive();
    match size {
        Some(size) => radius.or_if_absent(size),
        // A clump that is wrong says enough.
        None if table.has("clump") => radius.given(),
        None => radius.required(),
    }
}

fn from_file(table: &Table<'_>, is_clump: bool) -> Option<LooseSource> {
    for key in OF_SHAPES.into_iter().chain(["particle_radius", "centre"]) {
        table.refuse(key, "beside a file of particles");
    }
    if !is_clump || table.has("orientation") {
        table.refuse("seed", "beside a file of particles");
    }
    let unit = optional(table, "unit", |_| file_unit(table));
    let file = file(table, "file");
    let velocity_unit = optional(table, "velocity_unit", |name| super::unit(table, name, Dimension::VELOCITY));
    if table.has("velocity_unit") {
        table.refuse("initial_velocity", "beside velocity_unit, which takes the velocities of the file");
    }
    let frame = optional(table, "frame", |name| frame(table, name));
    let species = optional(table, "species", |name| table.text(name).given());
    Some(LooseSource::File {
        file: file?,
        unit: unit?.unwrap_or_else(|| metres(table.reader)),
        velocity_unit: velocity_unit?,
        frame: frame?,
        species: species?,
    })
}

fn cloud(table: &Table<'_>, size: Option<f64>) -> Option<LooseSource> {
    if !table.has("shape") {
        let note = Diagnostic::error(&table.place, "has none of shape, file and centre");
        let expected = "a shape to fill with particles, a file of particles, or the centre of a single one";
        table.reader.note(note.expected(expected));
    }
    for key in ["velocity_unit", "frame", "species"] {
        table.refuse(key, "without a file of particles");
    }
    let graded = table.has("sizes");
    let kinds = [("box", Kind::Box), ("cylinder", Kind::Cylinder), ("sphere", Kind::Sphere)];
    let kind = table.one_of("shape", &kinds).spanned().given();
    let radius = if graded {
        for key in ["particle_radius", "dispersion"] {
            table.refuse(key, "beside sizes");
        }
        Some(0.0)
    } else {
        table.refuse("solid_fraction", "without sizes");
        if table.has("shape") { radius(table, size) } else { table.quantity("particle_radius").positive().given() }
    };
    let count = optional(table, "particles", |name| {
        let count = table.integer(name).check(|count| (1..=20_000_000).contains(count), "1 to 20 million");
        count.spanned().given()
    });
    let dispersion = if graded {
        Some(0.0)
    } else {
        let dispersion = table.quantity("dispersion").check(|kappa| (0.0..=1.0).contains(kappa), DISPERSION_RANGE);
        dispersion.or_if_absent(0.0)
    };
    let grading = if graded { sizes::sizes(table).map(Some) } else { Some(None) };
    let has_inlet = table.has("inlet");
    if has_inlet {
        table.refuse("solid_fraction", "beside inlet, whose rate says how many there are");
    }
    let amount =
        if graded && !has_inlet { amount(table, count.as_ref().is_some_and(Option::is_some)) } else { Some(None) };
    let seed = table.integer("seed").or_if_absent(1);
    let region = match &kind {
        Some(kind) => region(table, kind.value).map(|region| Spanned::new(region, kind.place.clone())),
        None => {
            table.pass_over(&["point", "size", "axis", "length", "radius", "unit"]);
            None
        }
    };
    if has_inlet {
        let most = count.as_ref().map(|count| count.as_ref().map(|count| count.value));
        let inlet = inlet::inlet(table, most.is_some_and(|most| most.is_some()));
        let sizes = match grading? {
            Some(grading) => Sizes::Graded(grading),
            None => Sizes::Uniform { radius: radius?, dispersion: dispersion? },
        };
        return inlet?.source(region?, sizes, most?, seed?);
    }
    if let Some(grading) = grading? {
        let (region, seed, count) = (region?, seed?, count?);
        let amount = count.map(|count| count.map(Amount::Count)).or(amount?)?;
        return Some(LooseSource::Graded { region, grading, amount, seed });
    }
    Some(LooseSource::Cloud { region: region?, radius: radius?, dispersion: dispersion?, count: count?, seed: seed? })
}

/// How much of a graded cloud there is, where that is not a number of particles.
fn amount(table: &Table<'_>, counted: bool) -> Option<Option<Spanned<Amount>>> {
    if counted {
        table.refuse("solid_fraction", "beside particles");
        return Some(None);
    }
    let share =
        table.quantity("solid_fraction").check(|share| *share > 0.0 && *share <= 0.5, "above 0 and at most 0.5");
    let share = share.map(Amount::Fraction).spanned();
    Some(Some(share.or_if_absent(Spanned::new(Amount::Fraction(0.25), table.place_of("solid_fraction")))?))
}

fn region(table: &Table<'_>, kind: Kind) -> Option<Region> {
    let start = point(table, "point").or_if_absent(Vec3::zeros());
    let length = |key: &'static str| table.quantity(key).positive().required();
    Some(match kind {
        Kind::Box => {
            let size = point(table, "size").check(|size| size.min() > 0.0, "three lengths above 0").required();
            Region::Box { point: start?, size: size? }
        }
        Kind::Cylinder => {
            let axis = direction(table, "axis").or_if_absent(Vec3::x());
            let (long, wide) = (length("length"), length("radius"));
            Region::Cylinder { point: start?, axis: axis?, length: long?, radius: wide? }
        }
        Kind::Sphere => {
            let wide = length("radius");
            Region::Sphere { point: start?, radius: wide? }
        }
    })
}
