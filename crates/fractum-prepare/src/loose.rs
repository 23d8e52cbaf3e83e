//! Loose particles and the facets of rigid bodies made ready: clouds filled, files read.

use fractum_dem::{BeamSection, Particles};
use fractum_io::build::{PreparedBody, PreparedFacets};
use fractum_io::case::model::{BodyKind, Case, FileContent, LooseBody, LooseSource, Material, Region, RigidShape};
use fractum_io::case::{Diagnostic, Diagnostics, Place};
use fractum_math::{Vec3, sphere_volume};
use fractum_pack::{cloud, read_stl};

/// The particles of a loose body.
///
/// # Errors
/// A file that is no table of spheres; a region without room.
pub(crate) fn prepare(body: &LooseBody, material: &Material) -> Result<PreparedBody, Box<Diagnostic>> {
    let (position, radius, place) = match &body.source {
        LooseSource::Table { file, unit } => {
            let (position, radius) = read_table(file, *unit)?;
            (position, radius, &file.name.place)
        }
        LooseSource::Cloud { region, radius, dispersion, count, seed } => {
            let most = count.as_ref().map_or(usize::MAX, |count| count.value as usize);
            let (centres, radii) = fill(&region.value, *radius, *dispersion, most, *seed);
            match count {
                Some(count) if centres.len() < most => {
                    let found = format!("= {}: there is room for {} only", count.value, centres.len());
                    let note = Diagnostic::error(&count.place, found);
                    return Err(Box::new(note.remedy("a larger region, smaller particles, or fewer")));
                }
                None if centres.is_empty() => {
                    let found = ": no particle of that radius has room in the region";
                    return Err(Box::new(Diagnostic::error(&region.place, found).remedy("a smaller particle_radius")));
                }
                _ => {}
            }
            (centres, radii, &region.place)
        }
    };
    let volume: f64 = radius.iter().map(|r| sphere_volume(*r)).sum();
    let wrong = |error: &dyn std::fmt::Display| Box::new(Diagnostic::error(place, format!(": {error}")));
    let particles = Particles::at_rest(position, radius, volume * material.density).map_err(|e| wrong(&e))?;
    // No bond uses it.
    let section = BeamSection::new(material.young_modulus, 1.0).map_err(|e| wrong(&e))?;
    let (pairs, shares, walls, law) = (Vec::new(), Vec::new(), Vec::new(), section.into());
    Ok(PreparedBody {
        particles,
        pairs,
        law,
        shares,
        walls,
        shift_to_walls: Vec::new(),
        fraction: 1.0,
        fracture: None,
        replaced: Vec::new(),
    })
}

fn fill(region: &Region, radius: f64, dispersion: f64, most: usize, seed: u64) -> (Vec<Vec3>, Vec<f64>) {
    match *region {
        Region::Box { point, size } => {
            let upper = point + size;
            let depth = |x: &Vec3| (x - point).min().min((upper - x).min());
            // Cells touch the walls exactly; rounding must not push them out.
            cloud(&point, &upper, |x| depth(x) * (1.0 + 1e-12) + 1e-12 * radius, radius, dispersion, most, seed)
        }
        Region::Cylinder { point, axis, length, radius: wide } => {
            let end = point + axis * length;
            let reach = axis.map(|a| wide * (1.0 - a * a).max(0.0).sqrt());
            let depth = |x: &Vec3| {
                let along = (x - point).dot(&axis);
                along.min(length - along).min(wide - (x - point - axis * along).norm())
            };
            cloud(&(point.inf(&end) - reach), &(point.sup(&end) + reach), depth, radius, dispersion, most, seed)
        }
        Region::Sphere { point, radius: wide } => {
            let depth = |x: &Vec3| wide - (x - point).norm();
            let reach = Vec3::repeat(wide);
            cloud(&(point - reach), &(point + reach), depth, radius, dispersion, most, seed)
        }
    }
}

/// Rows of x, y, z and radius, separated by commas, semicolons or blanks; a first row of names and `#` comments are
/// passed over.
fn read_table(file: &FileContent, unit: f64) -> Result<(Vec<Vec3>, Vec<f64>), Box<Diagnostic>> {
    let place: &Place = &file.name.place;
    let wrong = |found: String| {
        let note = Diagnostic::error(place, format!("= \"{}\": {found}", file.name.value));
        Box::new(note.expected("rows of x, y, z, radius"))
    };
    let text = std::str::from_utf8(&file.bytes).map_err(|_| wrong("is not text".to_owned()))?;
    let (mut position, mut radius) = (Vec::new(), Vec::new());
    let mut first = true;
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.split('#').next().unwrap_or_default();
        let words: Vec<&str> =
            line.split(|c: char| c == ',' || c == ';' || c.is_whitespace()).filter(|w| !w.is_empty()).collect();
        if words.is_empty() {
            continue;
        }
        let numbers: Option<Vec<f64>> = words.iter().map(|word| word.parse().ok()).collect();
        match numbers.as_deref() {
            Some(&[x, y, z, r]) if [x, y, z, r].iter().all(|v: &f64| v.is_finite()) && r > 0.0 => {
                position.push(Vec3::new(x, y, z) * unit);
                radius.push(r * unit);
            }
            None if first => {}
            _ => return Err(wrong(format!("line {number}: `{}`", line.trim()))),
        }
        first = false;
    }
    if position.is_empty() { Err(wrong("holds no particle".to_owned())) } else { Ok((position, radius)) }
}

/// The facets of the rigid bodies that come from STL files, in the order of the case.
///
/// # Errors
/// Files that hold no closed surface.
pub fn facets(case: &Case) -> Result<Vec<PreparedFacets>, Diagnostics> {
    let (mut all, mut errors) = (Vec::new(), Vec::new());
    for body in &case.bodies {
        let BodyKind::Rigid(rigid) = &body.kind else { continue };
        let RigidShape::Stl { file, unit, .. } = &rigid.shape else { continue };
        match read_stl(&file.bytes, *unit) {
            Ok(surface) => {
                let data = surface.data();
                let points = data.points.iter().map(|&p| p.into()).collect();
                all.push(PreparedFacets { points, triangles: data.triangles });
            }
            Err(error) => {
                errors.push(Diagnostic::error(&file.name.place, format!("= \"{}\": {error}", file.name.value)));
            }
        }
    }
    if errors.is_empty() { Ok(all) } else { Err(Diagnostics(errors)) }
}
