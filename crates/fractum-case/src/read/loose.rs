//! `[[bodies]]` of the kind `particles`.

use fractum_dem::ClumpShape;
use fractum_math::{Rotation, Vec3, rotation_by};
use fractum_pack::Grading;

use super::bonded::{DISPERSION_RANGE, Kind, SHAPES, file, frame, groups, is_stl, stl};
use super::{file_unit, inlet, metres, sizes};
use crate::model::{Amount, CloudShape, Clump, LooseBody, LooseSource, Region, Sizes, Turn};
use crate::reader::Table;
use crate::reader::presence::optional;
use crate::reader::vectors::{direction, initial_velocity, point, point_in_plane};
use crate::unit::Dimension;
use crate::{Diagnostic, Spanned};

/// Reads loose particles of the material at `material`, which is nothing where it is wrong.
pub(super) fn loose(table: &Table<'_>, material: Option<usize>) -> Option<LooseBody> {
    let thickness = optional(table, "thickness", |name| table.quantity(name).positive().spanned().given());
    let is_disc = table.has("thickness");
    if is_disc {
        table.refuse("clump", "beside thickness: clumps are rigid grains of spheres in space");
        table.refuse("inlet", "beside thickness: only spheres come in as time goes on");
    }
    let shape = clump_shape(table);
    let turn = turn(table, shape.is_some());
    let size = shape.as_ref().and_then(|shape| shape.as_ref()).map(|shape| shape.value.radius());
    let has_centre = !table.has("file") && table.has("centre");
    let source = if table.has("file") && !is_stl(table) {
        from_file(table, shape.is_some())
    } else if has_centre {
        single(table, size, is_disc)
    } else {
        cloud(table, size, is_disc)
    };
    if table.has("inlet") {
        table.refuse("groups", "beside inlet: where a particle comes in is not known before");
        table.refuse("clump", "beside inlet: only single spheres come in as time goes on");
    }
    let groups = groups(table);
    let initial_velocity = initial_velocity(table);
    if let Some([_, _, Some(along_z)]) = initial_velocity.as_ref().filter(|_| is_disc) {
        let note = Diagnostic::error(&along_z.place, "moves discs out of their plane");
        table
            .reader
            .note(note.expected("components along x and y").remedy("spheres move along z: leave thickness out"));
    }
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
        thickness: thickness?,
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
const OF_SHAPES: [&str; 12] = [
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
    "group",
];

/// A particle at a given place.
///
/// - `size`: radius of its clump as it is written [m]
fn single(table: &Table<'_>, size: Option<f64>, is_disc: bool) -> Option<LooseSource> {
    for key in OF_SHAPES.into_iter().chain(["seed", "unit", "velocity_unit", "frame", "species"]) {
        table.refuse(key, "beside centre, at which a single particle is");
    }
    let centre = if is_disc { point_in_plane(table, "centre") } else { point(table, "centre") }.required();
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

fn cloud(table: &Table<'_>, size: Option<f64>, is_disc: bool) -> Option<LooseSource> {
    if !table.has("shape") {
        let note = Diagnostic::error(&table.place, "has none of shape, file and centre");
        let expected = "a shape to fill with particles, a file of particles, or the centre of a single one";
        table.reader.note(note.expected(expected));
    }
    for key in ["velocity_unit", "frame", "species"] {
        table.refuse(key, "without a file of particles");
    }
    let has_inlet = table.has("inlet");
    let (graded, by_fraction) = (table.has("sizes"), table.has("solid_fraction"));
    let kinds = [Kind::Box, Kind::Cylinder, Kind::Sphere, Kind::Group, Kind::Stl].into_iter().zip(SHAPES);
    let kinds: Vec<(&'static str, Kind)> = kinds.map(|(kind, name)| (name, kind)).collect();
    let kinds: &[(&'static str, Kind)] = match (is_disc, has_inlet) {
        (true, _) => &[("rectangle", Kind::Box), ("circle", Kind::Sphere)],
        (false, true) => &kinds[..3],
        (false, false) => &kinds[..],
    };
    let kind = table.one_of("shape", kinds).spanned().given();
    let radius = if graded {
        for key in ["particle_radius", "dispersion"] {
            table.refuse(key, "beside sizes");
        }
        Some(0.0)
    } else if table.has("shape") {
        radius(table, size)
    } else {
        table.quantity("particle_radius").positive().given()
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
    let grading = if graded { sizes::sizes(table, is_disc).map(Some) } else { Some(None) };
    let shape = match &kind {
        Some(kind) => shape(table, kind.value, is_disc).map(|shape| Spanned::new(shape, kind.place.clone())),
        None => {
            table.pass_over(&["point", "size", "axis", "length", "radius", "file", "unit", "group"]);
            None
        }
    };
    // Places are drawn within cells of a region where nothing says how many particles there are.
    let is_region = matches!(&shape, None | Some(Spanned { value: CloudShape::Region(_), .. }));
    let by_amount = !has_inlet && (graded || by_fraction || !is_region);
    if has_inlet {
        table.refuse("solid_fraction", "beside inlet, whose rate says how many there are");
    }
    let amount = if by_amount { amount(table, count.as_ref().is_some_and(Option::is_some)) } else { Some(None) };
    let seed = table.integer("seed").or_if_absent(1);
    let region = |shape: Option<Spanned<CloudShape>>| match shape? {
        Spanned { value: CloudShape::Region(region), place } => Some(Spanned::new(region, place)),
        _ => None,
    };
    if has_inlet {
        let most = count.as_ref().map(|count| count.as_ref().map(|count| count.value));
        let inlet = inlet::inlet(table, most.is_some_and(|most| most.is_some()));
        let sizes = match grading? {
            Some(grading) => Sizes::Graded(grading),
            None => Sizes::Uniform { radius: radius?, dispersion: dispersion? },
        };
        return inlet?.source(region(shape)?, sizes, most?, seed?);
    }
    if by_amount {
        let of_one_law = |(radius, dispersion): (f64, f64)| {
            let uniform = if is_disc { Grading::uniform_discs } else { Grading::uniform };
            uniform(radius * (2.0 - dispersion), radius * (2.0 + dispersion))
        };
        let grading = grading?.or_else(|| radius.zip(dispersion).map(of_one_law));
        let (shape, grading, seed, count) = (shape?, grading?, seed?, count?);
        let amount = count.map(|count| count.map(Amount::Count)).or(amount?)?;
        return Some(LooseSource::Graded { shape, grading, amount, seed });
    }
    let region = region(shape)?;
    Some(LooseSource::Cloud { region, radius: radius?, dispersion: dispersion?, count: count?, seed: seed? })
}

/// How much of a graded cloud there is, where that is not a number of particles.
fn amount(table: &Table<'_>, counted: bool) -> Option<Option<Spanned<Amount>>> {
    if counted {
        table.refuse("solid_fraction", "beside particles");
        return Some(None);
    }
    let share =
        table.quantity("solid_fraction").check(|share| *share > 0.0 && *share <= 0.9, "above 0 and at most 0.9");
    let share = share.map(Amount::Fraction).spanned();
    Some(Some(share.or_if_absent(Spanned::new(Amount::Fraction(0.25), table.place_of("solid_fraction")))?))
}

fn shape(table: &Table<'_>, kind: Kind, is_disc: bool) -> Option<CloudShape> {
    let at = if is_disc { point_in_plane } else { point };
    let start = || at(table, "point").or_if_absent(Vec3::zeros());
    let length = |key: &'static str| table.quantity(key).positive().required();
    Some(CloudShape::Region(match kind {
        Kind::Box if is_disc => {
            let (start, size) = (start(), at(table, "size"));
            let size = size.check(|size| size.xy().min() > 0.0, "two lengths above 0").required();
            Region::Rectangle { point: start?, size: size? }
        }
        Kind::Box => {
            let (start, size) = (start(), at(table, "size"));
            let size = size.check(|size| size.min() > 0.0, "three lengths above 0").required();
            Region::Box { point: start?, size: size? }
        }
        Kind::Cylinder => {
            let start = start();
            let axis = direction(table, "axis").or_if_absent(Vec3::x());
            let (long, wide) = (length("length"), length("radius"));
            Region::Cylinder { point: start?, axis: axis?, length: long?, radius: wide? }
        }
        Kind::Sphere => {
            let (start, wide) = (start(), length("radius"));
            match is_disc {
                true => Region::Circle { point: start?, radius: wide? },
                false => Region::Sphere { point: start?, radius: wide? },
            }
        }
        Kind::Group => return Some(CloudShape::Group(table.text("group").spanned().required()?)),
        Kind::Stl => {
            let (file, unit) = stl(table)?;
            return Some(CloudShape::Stl { file, unit });
        }
    }))
}
