//! Bodies of particles of a case made ready, and the surfaces of its rigid bodies read.
//!
//! The case knows names and places; what `fractum-prepare` is asked for, it is asked in plain shapes and materials. A fault
//! comes back with what it is about, and gets its place here.

use fractum_mesh::Mesh;
use fractum_pack::{ClosedSurface, Domain, PackError, SurfaceData, read_stl_facets};
use fractum_prepare::{
    At, BondedReport, BondedRequest, BondedSubstance, Cache, Fault, Filled, LooseFill, LooseRequest, PackingRequest,
    ParticleFile, PreparedBody, Region, Shape, prepare_bonded, prepare_loose,
};
use fractum_scene::ContactParameters;

use crate::build::PreparedFacets;
use crate::model::{
    BodyKind, BondedBody, BondedShape, Case, CloudShape, LooseBody, LooseSource, PackingSource, Periodic, RigidShape,
    SolverKind,
};
use crate::{Diagnostic, Diagnostics, Place, Spanned};

/// All bodies of particles of a case.
#[derive(Default)]
pub struct MadeBodies {
    /// What the scene is built from, in the order of the case.
    pub prepared: Vec<PreparedBody>,
    /// What the plan says of them.
    pub reports: Vec<BondedReport>,
    /// Bodies whose particles come from files, and what was read of these.
    pub reads: Vec<(String, String)>,
    /// Doubts that do not keep them from running.
    pub warnings: Vec<Diagnostic>,
    /// What took how long, for the log.
    pub timings: Vec<String>,
}

/// Makes the bodies of particles of a case ready.
///
/// - `tell`: called with what is being done, again and again while it takes long
///
/// # Errors
/// Everything that cannot be packed, bonded or calibrated, with its place.
pub fn prepare_bodies(case: &Case, mesh: &Mesh, cache: &Cache, tell: &dyn Fn(&str)) -> Result<MadeBodies, Diagnostics> {
    let mut all = MadeBodies::default();
    let mut errors = Vec::new();
    for body in &case.bodies {
        match &body.kind {
            BodyKind::Bonded(bonded) => {
                let own = case.contact_between([body, body]).map(|own| own.surface);
                let surface = own.unwrap_or_else(|| body.kind.surface(&case.materials));
                match prepare_bonded(&bonded_request(case, &body.name.value, bonded, surface), mesh, cache, tell) {
                    Ok(made) => {
                        let doubt = |doubt: fractum_prepare::Doubt| {
                            let found = format!(": {}", doubt.found);
                            Diagnostic::warning(doubt.code, &body.name.place, found).remedy(doubt.remedy)
                        };
                        all.warnings.extend(made.doubts.into_iter().map(doubt));
                        all.timings.extend(made.timing);
                        all.reads.extend(made.read.map(|told| (body.name.value.clone(), told)));
                        all.reports.push(made.report);
                        all.prepared.push(made.body);
                    }
                    Err(fault) => errors.push(of_bonded(case, &body.name, bonded, &fault)),
                }
            }
            BodyKind::Particles(loose) => match prepare_loose(&loose_request(case, loose), mesh, tell) {
                Ok(made) => {
                    all.reads.extend(made.read.map(|told| (body.name.value.clone(), told)));
                    all.prepared.push(made.body);
                }
                Err(fault) => errors.push(of_loose(&body.name.place, loose, &fault)),
            },
            BodyKind::Solid(_) | BodyKind::Rigid(_) => {}
        }
    }
    if errors.is_empty() { Ok(all) } else { Err(Diagnostics(errors)) }
}

fn bonded_request<'a>(
    case: &'a Case,
    name: &'a str,
    bonded: &'a BondedBody,
    surface: ContactParameters,
) -> BondedRequest<'a> {
    let material = &case.materials[bonded.material];
    let packing = match &bonded.packing {
        PackingSource::File(file) => PackingRequest::File(&file.bytes),
        PackingSource::Particles { file, unit, frame, species, shape, bond_gap } => PackingRequest::Particles {
            file: ParticleFile {
                bytes: &file.bytes,
                unit: unit.length,
                velocity_unit: None,
                frame: *frame,
                species: species.as_deref(),
            },
            shape: match (&case.periodic, shape) {
                (Some(own), _) => Some(periodic_shape(own)),
                (None, shape) => shape.as_ref().map(|shape| shape_of(&shape.value)),
            },
            bond_gap: *bond_gap,
        },
        PackingSource::Shape { shape, size, dispersion, seed, arrangement } => PackingRequest::Fill {
            shape: case.periodic.as_ref().map_or_else(|| shape_of(&shape.value), |own| periodic_shape(own)),
            size: size.value,
            dispersion: *dispersion,
            seed: *seed,
            arrangement: *arrangement,
        },
    };
    let group_of = |solid: &Spanned<String>| {
        let own = case.bodies.iter().find_map(|body| match &body.kind {
            BodyKind::Solid(own) if body.name.value == solid.value => Some(own.group.value.as_str()),
            _ => None,
        });
        own.unwrap_or_default()
    };
    BondedRequest {
        name,
        packing,
        replaces: bonded.replaces.as_ref().map(group_of),
        law: bonded.law,
        coordination: bonded.coordination.as_ref().map(|asked| asked.value),
        convention: bonded.convention,
        wall_stiffening: bonded.wall_stiffening,
        material: BondedSubstance {
            density: material.density,
            young_modulus: material.young_modulus,
            poisson_ratio: material.poisson_ratio,
            beams: material.bonds.as_ref().map(|bonds| bonds.value.beams),
            interfaces: material.interfaces.as_ref().map(|own| own.value),
            strength: material.fracture.as_ref().map(|failure| failure.value.strength),
            faces: surface.into(),
        },
        at_rest: case.solver.kind == SolverKind::Static,
    }
}

/// The periodic box, which a bonded body in it fills.
fn periodic_shape(periodic: &Periodic) -> Shape<'static> {
    let Periodic { point, size, .. } = periodic;
    Shape::Plain(Domain::Periodic { lower: *point, upper: point + size.value })
}

fn shape_of(shape: &BondedShape) -> Shape<'_> {
    Shape::Plain(match shape {
        BondedShape::Box { point, size } => Domain::Box { lower: *point, upper: point + size },
        BondedShape::Cylinder { point, length, radius } => {
            Domain::Cylinder { start: *point, length: *length, radius: *radius }
        }
        BondedShape::Sphere { point, radius } => Domain::Sphere { centre: *point, radius: *radius },
        BondedShape::Group(group) => return Shape::Group(&group.value),
        BondedShape::Stl { file, unit } => return Shape::Stl { bytes: &file.bytes, unit: *unit },
    })
}

fn loose_request<'a>(case: &'a Case, loose: &'a LooseBody) -> LooseRequest<'a> {
    let material = &case.materials[loose.material];
    let source = match &loose.source {
        LooseSource::File { file, unit, velocity_unit, frame, species } => LooseFill::File(ParticleFile {
            bytes: &file.bytes,
            unit: unit.length,
            velocity_unit: *velocity_unit,
            frame: *frame,
            species: species.as_deref(),
        }),
        LooseSource::Single { centre, radius } => LooseFill::Single { centre: *centre, radius: *radius },
        LooseSource::Cloud { region, radius, dispersion, count, seed } => LooseFill::Cloud {
            region: &region.value,
            radius: *radius,
            dispersion: *dispersion,
            count: count.as_ref().map(|count| count.value),
            seed: *seed,
        },
        LooseSource::Graded { shape, grading, amount, seed } => {
            let filled = match &shape.value {
                CloudShape::Region(region) => Filled::Region(region),
                CloudShape::Group(group) => Filled::Group(&group.value),
                CloudShape::Stl { file, unit } => Filled::Stl { bytes: &file.bytes, unit: *unit },
            };
            LooseFill::Graded { filled, grading, amount: amount.value, seed: *seed }
        }
        LooseSource::Inlet { stream, .. } => LooseFill::Stream(stream),
    };
    let clump = loose.clump.as_ref().map(|clump| &clump.value);
    let repeats = case.periodic.as_ref().map_or([false; 3], |own| repeats(own, &loose.source));
    let thickness = loose.thickness.as_ref().map(|thickness| thickness.value);
    LooseRequest { source, density: material.density, young_modulus: material.young_modulus, clump, thickness, repeats }
}

/// Axes along which a periodic box repeats with the edges of the box that a cloud fills.
fn repeats(periodic: &Periodic, source: &LooseSource) -> [bool; 3] {
    let region = match source {
        LooseSource::Cloud { region, .. } => &region.value,
        LooseSource::Graded { shape: Spanned { value: CloudShape::Region(region), .. }, .. } => region,
        _ => return [false; 3],
    };
    let Region::Box { point, size } = region else { return [false; 3] };
    [0, 1, 2].map(|axis| periodic.axes[axis] && periodic.spans(axis, point[axis], size[axis]))
}

/// A fault with its place: where the case says what it is about.
fn of_bonded(case: &Case, name: &Spanned<String>, bonded: &BondedBody, fault: &Fault) -> Diagnostic {
    let plain = |place: &Place| placed(place, String::new(), fault);
    match (fault.at, &bonded.packing) {
        (At::Material, _) => plain(&case.materials[bonded.material].name.place),
        (At::Coordination, _) => plain(bonded.coordination.as_ref().map_or(&name.place, |asked| &asked.place)),
        (At::Replaced, _) => bonded.replaces.as_ref().map_or_else(|| plain(&name.place), |solid| named(solid, fault)),
        (At::File, PackingSource::File(file) | PackingSource::Particles { file, .. }) => named(&file.name, fault),
        (At::Size, PackingSource::Shape { size, .. }) => plain(&size.place),
        (At::Shape, PackingSource::Shape { shape, .. }) => plain(&shape.place),
        (At::Source, PackingSource::Shape { shape, .. }) => plain(match &shape.value {
            BondedShape::Group(group) => &group.place,
            BondedShape::Stl { file, .. } => &file.name.place,
            _ => &shape.place,
        }),
        _ => plain(&name.place),
    }
}

/// As [`of_bonded`].
fn of_loose(name: &Place, loose: &LooseBody, fault: &Fault) -> Diagnostic {
    match (fault.at, &loose.source) {
        (At::File, LooseSource::File { file, .. }) => named(&file.name, fault),
        (At::Source, LooseSource::File { file, .. }) => placed(&file.name.place, String::new(), fault),
        (At::Size, LooseSource::Cloud { count: Some(count), .. }) => {
            placed(&count.place, format!("= {}", count.value), fault)
        }
        (At::Size, LooseSource::Graded { amount, .. }) => placed(&amount.place, String::new(), fault),
        (At::Rate, LooseSource::Inlet { rate, .. }) => placed(rate, String::new(), fault),
        (At::Shape, LooseSource::Inlet { region, .. }) => placed(region, String::new(), fault),
        (At::Shape, LooseSource::Cloud { region, .. }) => placed(&region.place, String::new(), fault),
        (At::Source, LooseSource::Graded { shape: Spanned { value: CloudShape::Group(group), .. }, .. }) => {
            named(group, fault)
        }
        (At::Source, LooseSource::Graded { shape: Spanned { value: CloudShape::Stl { file, .. }, .. }, .. }) => {
            named(&file.name, fault)
        }
        (At::Shape, LooseSource::Graded { shape, .. }) => placed(&shape.place, String::new(), fault),
        _ => placed(name, String::new(), fault),
    }
}

fn named(name: &Spanned<String>, fault: &Fault) -> Diagnostic {
    placed(&name.place, format!("= \"{}\"", name.value), fault)
}

fn placed(place: &Place, value: String, fault: &Fault) -> Diagnostic {
    let found = format!("{value}: {}", fault.found);
    Diagnostic::error(place, found).expected(fault.expected).remedy(fault.remedy)
}

/// The facets of the rigid bodies that come from STL files, in the order of the case: those of a closed surface look outward, those
/// of an open one as the file has them.
///
/// # Errors
/// Files that hold no surface.
pub fn facets(case: &Case) -> Result<Vec<PreparedFacets>, Diagnostics> {
    let (mut all, mut errors) = (Vec::new(), Vec::new());
    for body in &case.bodies {
        let BodyKind::Rigid(rigid) = &body.kind else { continue };
        let RigidShape::Stl { file, unit, .. } = &rigid.shape else { continue };
        let facets = read_stl_facets(&file.bytes, *unit).and_then(|data| match ClosedSurface::from_data(&data) {
            Ok(surface) => Ok(surface.data()),
            Err(PackError::OpenSurface { .. }) => Ok(data),
            Err(error) => Err(error),
        });
        match facets {
            Ok(SurfaceData { points, triangles }) => {
                let points = points.into_iter().map(Into::into).collect();
                all.push(PreparedFacets { points, triangles });
            }
            Err(error) => {
                errors.push(Diagnostic::error(&file.name.place, format!("= \"{}\": {error}", file.name.value)));
            }
        }
    }
    if errors.is_empty() { Ok(all) } else { Err(Diagnostics(errors)) }
}
