//! `[[bodies]]` of the kind `particles`.

use fractum_math::Vec3;

use super::bonded::{DISPERSION_RANGE, file, frame, groups};
use super::{inlet, sizes, unit};
use crate::model::{Amount, LooseBody, LooseSource, Region, Sizes};
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
    let source = if table.has("file") { from_file(table) } else { cloud(table) };
    if table.has("inlet") {
        table.refuse("groups", "beside inlet: where a particle comes in is not known before");
    }
    let groups = groups(table);
    let initial_velocity = initial_velocity(table);
    Some(LooseBody { material: material?, source: source?, groups: groups?, initial_velocity: initial_velocity? })
}

fn from_file(table: &Table<'_>) -> Option<LooseSource> {
    for key in [
        "shape",
        "point",
        "size",
        "axis",
        "length",
        "radius",
        "particles",
        "particle_radius",
        "dispersion",
        "sizes",
        "solid_fraction",
        "seed",
        "inlet",
    ] {
        table.refuse(key, "beside a file of particles");
    }
    let unit = optional(table, "unit", |name| unit(table, name, Dimension::LENGTH));
    let file = file(table, "file");
    let velocity_unit = optional(table, "velocity_unit", |name| super::unit(table, name, Dimension::VELOCITY));
    if table.has("velocity_unit") {
        table.refuse("initial_velocity", "beside velocity_unit, which takes the velocities of the file");
    }
    let frame = optional(table, "frame", |name| frame(table, name));
    let species = optional(table, "species", |name| table.text(name).given());
    Some(LooseSource::File {
        file: file?,
        unit: unit?.unwrap_or(table.reader.scale.of(Dimension::LENGTH)),
        velocity_unit: velocity_unit?,
        frame: frame?,
        species: species?,
    })
}

fn cloud(table: &Table<'_>) -> Option<LooseSource> {
    if !table.has("shape") {
        let note = Diagnostic::error(&table.place, "has neither shape nor file");
        table.reader.note(note.expected("a shape to fill with particles, or a file of particles"));
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
        let radius = table.quantity("particle_radius").positive();
        if table.has("shape") { radius.required() } else { radius.given() }
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
