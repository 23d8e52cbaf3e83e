//! `[[bodies]]` of the kind `bonded`, and the beams of a material.

use fractum_dem::{Crushing, LocalBond};
use fractum_math::Vec3;
use fractum_pack::{Arrangement, Convention};
use fractum_prepare::Micro;

use super::{file_unit, metres, read_file, table_path, unit};
use crate::model::{BondLawKind, BondedBody, BondedShape, Bonds, FileContent, Material, PackingSource, ParticleSize};
use crate::reader::Table;
use crate::reader::presence::optional;
use crate::reader::vectors::{condition_of, initial_velocity, point};
use crate::tree::Value;
use crate::unit::Dimension;
use crate::{Choice, Diagnostic, Field, Place, Spanned};

/// Particles where nothing is said.
const PARTICLES: u64 = 10_000;
/// κ where nothing is said.
const DISPERSION: f64 = 0.25;

/// Kinds of shapes.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Box,
    Cylinder,
    Sphere,
    Group,
    Stl,
}

/// Names of the shapes that particles can fill.
pub(super) const SHAPES: [&str; 5] = ["box", "cylinder", "sphere", "group", "stl"];

/// Reads a bonded body of the material at `material`, which is nothing where it is wrong.
pub(super) fn bonded(table: &Table<'_>, material: Option<usize>, here: Option<&Material>) -> Option<BondedBody> {
    if table.has("packing") {
        table.refuse("replaces", "beside a packing made before");
    }
    let replaces = match table.has("packing") {
        true => Some(None),
        false => table.text("replaces").spanned().map(Some).or_if_absent(None),
    };
    let packing = packing(table);
    let law = law(table, here);
    let beams = here.and_then(|material| material.bonds.as_ref()).filter(|_| law == BondLawKind::CohesiveBeam);
    let (coordination, convention) = match beams {
        Some(beams) => {
            table.refuse("coordination", "beside the bonds of its material, which have one");
            table.refuse("convention", "beside the bonds of its material, which have one");
            (Some(Spanned::new(beams.value.coordination, beams.place.clone())), beams.value.convention)
        }
        None => {
            let coordination = table.quantity("coordination").between(2.0, 40.0).spanned().given();
            (coordination, table.choice("convention").or(Convention::Interior))
        }
    };
    let stiffens = |here: &Material| match &here.fracture {
        _ if law != BondLawKind::CohesiveBeam => Err("on interfaces: bond = \"cohesive-beam\" has it"),
        Some(own) if own.value.strength.criterion.level().is_none() => Err(
            "beside the criterion of single beams, which takes them as they are: choose one of the stress of particles",
        ),
        _ if matches!(replaces, Some(Some(_))) => Err("beside replaces: its walls are tied to the solid"),
        _ => Ok(()),
    };
    let wall_stiffening = match here.map(stiffens) {
        Some(Err(where_it_acts)) => {
            table.refuse("wall_stiffening", where_it_acts);
            0.0
        }
        _ => table.quantity("wall_stiffening").not_negative().or(0.0),
    };
    if let (Some(Some(_)), Some(own)) = (&replaces, here.and_then(|here| here.fracture.as_ref()))
        && own.value.strength.at_walls
    {
        let note = Diagnostic::error(
            &own.place,
            ".at_walls does not go with a body that replaces: its walls are tied to the solid",
        );
        table.reader.note(note.remedy("leave at_walls out, or give this body a material of its own"));
    }
    let groups = groups(table);
    let initial_velocity = initial_velocity(table);
    Some(BondedBody {
        material: material?,
        packing: packing?,
        replaces: replaces?,
        law,
        coordination,
        convention,
        wall_stiffening,
        groups: groups?,
        initial_velocity: initial_velocity?,
    })
}

/// The law of the bonds; tables of the material that it does not read are mistakes.
fn law(table: &Table<'_>, here: Option<&Material>) -> BondLawKind {
    let law = table.choice("bond").or(BondLawKind::default());
    let Some(here) = here else { return law };
    let refuse = |place: &Place, remedy: &str| {
        let note = Diagnostic::error(place, format!("has no effect on body bonds with bond = \"{}\"", law.name()));
        table.reader.note(note.remedy(remedy));
    };
    if law == BondLawKind::CohesiveBeam {
        if let Some(own) = &here.interfaces {
            refuse(&own.place, "bond = \"local\" on the body, or leave the table out");
        }
        return law;
    }
    if let Some(own) = &here.bonds {
        refuse(&own.place, "leave the table out: interfaces take their stiffness from the material");
    }
    if let Some(own) = &here.fracture {
        refuse(&own.place, "give the strengths in the table interface");
    }
    if law == BondLawKind::LocalNonlocal {
        refuse_beside_mean_strain(table, here);
    }
    law
}

/// What interfaces beside the mean strain of their particles do not know.
fn refuse_beside_mean_strain(table: &Table<'_>, here: &Material) {
    let note = |place: &Place, found: &str, remedy: &str| {
        let found = format!("{found}, which bond = \"local-nonlocal\" does not know");
        table.reader.note(Diagnostic::error(place, found).remedy(remedy));
    };
    if let Some(own) = &here.interfaces {
        let law = &own.value.law;
        if law.softening != [f64::INFINITY; 2] || law.crushing != Crushing::NONE {
            note(
                &own.place,
                "softens or crushes",
                "leave tension_softening, shear_softening, crushing_stress and crushing_ratio out, or take bond = \"local\"",
            );
        }
        if law.tensile_strength == 0.0 || law.shear_strength == 0.0 {
            note(&own.place, "has no strength", "strengths above zero, or bond = \"local\"");
        }
    }
    if let Some(own) = here.thermal.as_ref().filter(|own| own.value.expansion != 0.0) {
        note(&own.place, "expands", "leave expansion out, or take bond = \"local\"");
    }
    if here.poisson_ratio > LocalBond::LARGEST_POISSON_RATIO {
        note(&here.name.place, "has a Poisson's ratio above 0.49", "a smaller poisson_ratio, or bond = \"local\"");
    }
}

fn packing(table: &Table<'_>) -> Option<PackingSource> {
    if table.has("packing") {
        for key in
            ["shape", "point", "size", "length", "radius", "group", "file", "unit", "particles", "particle_radius"]
        {
            table.refuse(key, "beside a packing made before");
        }
        for key in ["dispersion", "seed", "arrangement"].into_iter().chain(FILE_KEYS) {
            table.refuse(key, "beside a packing made before");
        }
        return file(table, "packing").map(PackingSource::File);
    }
    if table.has("file") && !is_stl(table) {
        return particles(table);
    }
    for key in FILE_KEYS {
        table.refuse(key, "without a file of particles");
    }
    let kinds =
        [Kind::Box, Kind::Cylinder, Kind::Sphere, Kind::Group, Kind::Stl].into_iter().zip(SHAPES).map(|(k, n)| (n, k));
    let kinds: Vec<(&'static str, Kind)> = kinds.collect();
    let kind = table.one_of("shape", &kinds).spanned().required();
    let shape = match &kind {
        Some(kind) => shape(table, kind.value, &[]).map(|shape| Spanned::new(shape, kind.place.clone())),
        None => {
            table.pass_over(&["point", "size", "length", "radius", "group", "file", "unit"]);
            None
        }
    };
    let arrangement = table.choice("arrangement").or(Arrangement::default());
    if arrangement != Arrangement::Random {
        if kind.as_ref().is_some_and(|kind| kind.value != Kind::Box) {
            table.refuse("arrangement", "on this shape, only on a box");
        }
        for key in ["particles", "dispersion", "seed"] {
            table.refuse(key, "in a regular arrangement, which particle_radius decides");
        }
        if !table.has("particle_radius") {
            table.reader.note_missing(&table.place_of("particle_radius"), "the radius of the particles");
        }
    }
    let size = size(table);
    let dispersion = table.quantity("dispersion").check(|kappa| (0.0..=1.0).contains(kappa), DISPERSION_RANGE);
    let dispersion = dispersion.or_if_absent(DISPERSION);
    let seed = table.integer("seed").or_if_absent(1);
    Some(PackingSource::Shape { shape: shape?, size: size?, dispersion: dispersion?, seed: seed?, arrangement })
}

/// Keys of a file of particles.
const FILE_KEYS: [&str; 3] = ["frame", "species", "bond_gap"];

/// Particles of a file, and the shape that they fill.
fn particles(table: &Table<'_>) -> Option<PackingSource> {
    for key in ["particles", "particle_radius", "dispersion", "seed", "arrangement", "replaces"] {
        table.refuse(key, "beside a file of particles");
    }
    let shape = match table.has("shape") {
        true => {
            let kinds = [Kind::Box, Kind::Cylinder, Kind::Sphere].into_iter().zip(SHAPES);
            let kinds: Vec<(&'static str, Kind)> = kinds.map(|(kind, name)| (name, kind)).collect();
            let kind = table.one_of("shape", &kinds).spanned().given();
            kind.and_then(|kind| {
                let shape = shape(table, kind.value, &["file", "unit"])?;
                Some(Some(Spanned::new(shape, kind.place.clone())))
            })
        }
        false => {
            for key in ["point", "size", "length", "radius", "group"] {
                table.refuse(key, "without a shape");
            }
            Some(None)
        }
    };
    let file = file(table, "file");
    let unit = optional(table, "unit", |_| file_unit(table));
    let frame = optional(table, "frame", |name| frame(table, name));
    let species = optional(table, "species", |name| table.text(name).given());
    let bond_gap = optional(table, "bond_gap", |name| table.quantity(name).positive().given());
    if table.has("bond_gap") {
        table.refuse("coordination", "beside bond_gap, which decides about bonds");
    }
    Some(PackingSource::Particles {
        file: file?,
        unit: unit?.unwrap_or_else(|| metres(table.reader)),
        frame: frame?,
        species: species?,
        shape: shape?,
        bond_gap: bond_gap?,
    })
}

/// The number of a frame of a file.
pub(super) fn frame(table: &Table<'_>, key: &'static str) -> Option<u64> {
    table.integer(key).check(|frame| *frame < 1_000_000_000, "a number of a frame, from 0 on").given()
}

pub(super) const DISPERSION_RANGE: &str = "from 0 to 1 (0.25 is usual; packings below 0.15 tend to order)";

/// - `beside`: keys that are not the shape's
fn shape(table: &Table<'_>, kind: Kind, beside: &[&str]) -> Option<BondedShape> {
    let name = SHAPES[kind as usize];
    let takes: &[&str] = match kind {
        Kind::Box => &["point", "size"],
        Kind::Cylinder => &["point", "length", "radius"],
        Kind::Sphere => &["point", "radius"],
        Kind::Group => &["group"],
        Kind::Stl => &["file", "unit"],
    };
    for key in ["point", "size", "length", "radius", "group", "file", "unit"] {
        if !takes.contains(&key) && !beside.contains(&key) {
            table.refuse(key, &format!("on the shape \"{name}\""));
        }
    }
    let start = if takes.contains(&"point") { point(table, "point").or_if_absent(Vec3::zeros()) } else { None };
    let length = |key: &'static str| table.quantity(key).positive().required();
    Some(match kind {
        Kind::Box => {
            let size = point(table, "size").check(|size| size.min() > 0.0, "three lengths above 0").required();
            BondedShape::Box { point: start?, size: size? }
        }
        Kind::Cylinder => {
            let (length, radius) = (length("length"), length("radius"));
            BondedShape::Cylinder { point: start?, length: length?, radius: radius? }
        }
        Kind::Sphere => {
            let radius = length("radius");
            BondedShape::Sphere { point: start?, radius: radius? }
        }
        Kind::Group => BondedShape::Group(table.text("group").spanned().required()?),
        Kind::Stl => {
            let (file, unit) = stl(table)?;
            BondedShape::Stl { file, unit }
        }
    })
}

/// Whether the file of a body is that of its shape.
pub(super) fn is_stl(table: &Table<'_>) -> bool {
    table.peek("shape").is_some_and(|node| matches!(&node.value, Value::Text(text) if text == "stl"))
}

/// The STL file of a shape, and the length of its unit [m].
pub(super) fn stl(table: &Table<'_>) -> Option<(FileContent, f64)> {
    let file = file(table, "file");
    let unit = optional(table, "unit", |name| unit(table, name, Dimension::LENGTH));
    Some((file?, unit?.unwrap_or(table.reader.scale.of(Dimension::LENGTH))))
}

fn size(table: &Table<'_>) -> Option<Spanned<ParticleSize>> {
    if table.has("particle_radius") {
        table.refuse("particles", "beside particle_radius, from which the number follows");
        let radius = table.quantity("particle_radius").positive().spanned().required()?;
        return Some(radius.map(ParticleSize::Radius));
    }
    let count = table.integer("particles").check(|count| (20..=20_000_000).contains(count), "20 to 20 million");
    count
        .spanned()
        .or_if_absent(Spanned::new(PARTICLES, table.place_of("particles")))
        .map(|n| n.map(ParticleSize::Count))
}

/// Takes the file that a key names, with its contents; they belong to the identity of the case.
pub(super) fn file(table: &Table<'_>, key: &'static str) -> Option<FileContent> {
    let name = table.text(key).spanned().required()?;
    match read_file(&table_path(table.reader, &name.value)) {
        Ok(bytes) => {
            table.reader.tables.borrow_mut().push((name.value.clone(), bytes.clone()));
            Some(FileContent { name, bytes })
        }
        Err(error) => {
            let note = Diagnostic::error(&name.place, format!("= \"{}\" {error}", name.value));
            table.reader.note(note.remedy("paths are taken from the folder of the case file"));
            None
        }
    }
}

/// Named sets of particles.
pub(super) fn groups(table: &Table<'_>) -> Option<Vec<(Spanned<String>, Field)>> {
    let Some(groups) = table.table("groups") else { return Some(Vec::new()) };
    let mut complete = true;
    let mut found = Vec::new();
    for entry in groups.entries() {
        let name = Spanned::new(entry.name.clone(), entry.key_place.clone());
        match condition_of(groups.reader, &entry.node) {
            Some(field) => found.push((name, field)),
            None => complete = false,
        }
    }
    groups.finish("here");
    complete.then_some(found)
}

/// The `bonds` table of a material.
pub(super) fn bonds(table: Table<'_>) -> Option<Bonds> {
    let coordination = table.quantity("coordination").between(2.0, 40.0).required();
    let convention = table.choice("convention").required();
    let radius_ratio = table.quantity("radius_ratio").between(0.0, 2.0).required();
    let young_modulus = table.quantity("young_modulus").physical().required();
    table.finish("here");
    Some(Bonds {
        coordination: coordination?,
        convention: convention?,
        beams: Micro { radius_ratio: radius_ratio?, young_modulus: young_modulus? },
    })
}
