//! Loose particles made ready: clouds filled, tables read.

use fractum_dem::{BeamSection, Particles};
use fractum_math::{Vec3, sphere_volume};
use fractum_pack::{Grading, cloud, insert};

use crate::asked::{Amount, At, Fault, LooseFill, LooseRequest, Region, graded_count};
use crate::body::PreparedBody;

/// Makes loose particles ready.
///
/// # Errors
/// A file that is no table of spheres; a region without room.
pub fn prepare_loose(asked: &LooseRequest<'_>) -> Result<PreparedBody, Fault> {
    let (position, radius, at) = match asked.source {
        LooseFill::Table { bytes, unit } => {
            let (position, radius) = read_table(bytes, unit)?;
            (position, radius, At::Source)
        }
        LooseFill::Cloud { region, radius, dispersion, count, seed } => {
            let most = count.map_or(usize::MAX, |count| count as usize);
            let (centres, radii) = fill(region, radius, dispersion, most, seed);
            match count {
                Some(_) if centres.len() < most => {
                    let fault = Fault::new(At::Size, format!("there is room for {} only", centres.len()));
                    return Err(fault.remedy("a larger region, smaller particles, or fewer"));
                }
                None if centres.is_empty() => {
                    let fault = Fault::new(At::Shape, "no particle of that radius has room in the region");
                    return Err(fault.remedy("a smaller particle_radius"));
                }
                _ => {}
            }
            (centres, radii, At::Shape)
        }
        LooseFill::Graded { region, grading, amount, seed } => {
            let (centres, radii) = fill_graded(region, grading, amount, seed)?;
            (centres, radii, At::Shape)
        }
    };
    let volume: f64 = radius.iter().map(|r| sphere_volume(*r)).sum();
    let particles =
        Particles::at_rest(position, radius, volume * asked.density).map_err(|error| Fault::new(at, error))?;
    // No bond uses it.
    let section = BeamSection::new(asked.young_modulus, 1.0).map_err(|error| Fault::new(at, error))?;
    let (pairs, shares, walls, law) = (Vec::new(), Vec::new(), Vec::new(), section.into());
    Ok(PreparedBody {
        particles,
        pairs,
        law,
        shares,
        walls,
        domain: None,
        shift_to_walls: Vec::new(),
        fraction: 1.0,
        fracture: None,
        replaced: Vec::new(),
    })
}

/// Particles that may be asked for.
const MOST: f64 = 2e7;

fn fill_graded(region: &Region, grading: &Grading, amount: Amount, seed: u64) -> Result<(Vec<Vec3>, Vec<f64>), Fault> {
    let count = graded_count(region, grading, amount);
    if count > MOST {
        let fault =
            Fault::new(At::Size, format!("asks for {count:.2e} particles of these sizes, more than {MOST:.0e}"));
        return Err(fault.remedy("a smaller region, or sizes with fewer fines"));
    }
    let diameters = grading.draw(count as usize, seed);
    let radii: Vec<f64> = diameters.iter().map(|diameter| 0.5 * diameter).collect();
    let (lower, upper) = bounds(region);
    // Places have numbers of their own.
    let centres = insert(&lower, &upper, depth_in(region), &radii, !seed);
    if centres.len() < radii.len() {
        let found = format!("there is room for {} of {} particles, largest first", centres.len(), radii.len());
        return Err(Fault::new(At::Size, found).remedy("a lower solid_fraction or fewer particles, or a larger region"));
    }
    Ok((centres, radii))
}

/// Box around a region.
fn bounds(region: &Region) -> (Vec3, Vec3) {
    match *region {
        Region::Box { point, size } => (point, point + size),
        Region::Cylinder { point, axis, length, radius } => {
            let end = point + axis * length;
            let reach = axis.map(|a| radius * (1.0 - a * a).max(0.0).sqrt());
            (point.inf(&end) - reach, point.sup(&end) + reach)
        }
        Region::Sphere { point, radius } => (point - Vec3::repeat(radius), point + Vec3::repeat(radius)),
    }
}

/// Distance of a point from the wall of a region [m], positive inside.
fn depth_in(region: &Region) -> impl Fn(&Vec3) -> f64 {
    let region = *region;
    move |x| match region {
        Region::Box { point, size } => (x - point).min().min((point + size - x).min()),
        Region::Cylinder { point, axis, length, radius } => {
            let along = (x - point).dot(&axis);
            along.min(length - along).min(radius - (x - point - axis * along).norm())
        }
        Region::Sphere { point, radius } => radius - (x - point).norm(),
    }
}

fn fill(region: &Region, radius: f64, dispersion: f64, most: usize, seed: u64) -> (Vec<Vec3>, Vec<f64>) {
    let ((lower, upper), depth) = (bounds(region), depth_in(region));
    // Cells touch the walls of a box exactly; rounding must not push them out.
    let slack = if matches!(region, Region::Box { .. }) { 1e-12 } else { 0.0 };
    cloud(&lower, &upper, |x| depth(x) * (1.0 + slack) + slack * radius, radius, dispersion, most, seed)
}

/// Rows of x, y, z and radius, separated by commas, semicolons or blanks; a first row of names and `#` comments are
/// passed over.
fn read_table(bytes: &[u8], unit: f64) -> Result<(Vec<Vec3>, Vec<f64>), Fault> {
    let wrong = |found: String| Fault { expected: "rows of x, y, z, radius", ..Fault::new(At::File, found) };
    let text = std::str::from_utf8(bytes).map_err(|_| wrong("is not text".to_owned()))?;
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
