//! Loose particles made ready: clouds filled, files read.

use std::f64::consts::PI;
use std::sync::Arc;

use fractum_dem::{BeamSection, Clumps, Particles};
use fractum_math::{Rotation, Vec3, rotation_between, sphere_volume};
use fractum_mesh::Mesh;
use fractum_pack::{Domain, Grading, PackError, cloud, dense, dense_discs, insert, orientations, place_in, read_stl};
use fractum_scene::Arrivals;

use crate::asked::{
    Amount, At, Clump, Fault, Filled, LooseFill, LooseRequest, Rate, Region, Stream, Turn, graded_count,
};
use crate::body::PreparedBody;
use crate::bonded::group_surface;
use crate::particle_file::{self, FileParticles};

/// Loose particles that were made.
pub struct MadeParticles {
    /// What the scene is built from.
    pub body: PreparedBody,
    /// What was read, where they come from a file.
    pub read: Option<String>,
}

/// Makes loose particles ready.
///
/// - `tell`: called with what is being done, where it takes long
///
/// # Errors
/// A file that holds no spheres; a region without room.
pub fn prepare_loose(asked: &LooseRequest<'_>, mesh: &Mesh, tell: &dyn Fn(&str)) -> Result<MadeParticles, Fault> {
    let (mut file, mut arrivals) = (None, None);
    let (position, radius, at) = match asked.source {
        LooseFill::File(of) => {
            let found = file.insert(particle_file::read(&of)?);
            (std::mem::take(&mut found.position), found.radius.clone(), At::Source)
        }
        LooseFill::Single { centre, radius } => (vec![centre], vec![radius], At::Body),
        LooseFill::Cloud { region, radius, dispersion, count, seed } => {
            let most = count.map_or(usize::MAX, |count| count as usize);
            let (mut centres, mut radii) = fill(region, radius, dispersion, most, seed);
            match count {
                Some(count) if centres.len() < most => {
                    let (half, mean) = (0.5 * dispersion, 2.0 * radius);
                    let uniform = if asked.thickness.is_some() { Grading::uniform_discs } else { Grading::uniform };
                    let grading = uniform(mean * (1.0 - half), mean * (1.0 + half));
                    let shape = domain(Filled::Region(region), mesh)?;
                    (centres, radii) = fill_graded(shape, asked.repeats, &grading, Amount::Count(count), seed, tell)?;
                }
                None if centres.is_empty() => {
                    let fault = Fault::new(At::Shape, "no particle of that radius has room in the region");
                    return Err(fault.remedy("a smaller particle_radius"));
                }
                _ => {}
            }
            (centres, radii, At::Shape)
        }
        LooseFill::Graded { filled, grading, amount, seed } => {
            let (centres, radii) = fill_graded(domain(filled, mesh)?, asked.repeats, grading, amount, seed, tell)?;
            (centres, radii, At::Shape)
        }
        LooseFill::Stream(stream) => {
            let (radii, due) = due(stream, asked.density)?;
            let (bounds, place) = places(stream)?;
            // They wait where the first tries would put them.
            let centres = radii.iter().zip(0..).map(|(radius, number)| place(*radius, number)).collect();
            arrivals = Some(Arrivals { due, bounds, place });
            (centres, radii, At::Shape)
        }
    };
    let grains = position.len();
    let wrong = |error| Fault::new(at, error);
    let (mut particles, mut clumps) = match (asked.clump, asked.thickness) {
        (Some(clump), _) => {
            let places = clump_places(clump, position, radius);
            Clumps::at_rest(&clump.shape, &places, asked.density).map_err(wrong)?
        }
        (None, Some(thickness)) => {
            file.iter().try_for_each(|file| check_plane(&position, file))?;
            let discs = Particles::discs_at_rest(position, radius, asked.density, thickness);
            (discs.map_err(wrong)?, Clumps::default())
        }
        (None, None) => {
            let mass = radius.iter().map(|r| sphere_volume(*r)).sum::<f64>() * asked.density;
            (Particles::at_rest(position, radius, mass).map_err(wrong)?, Clumps::default())
        }
    };
    if let Some(found) = file.as_ref().filter(|_| !clumps.is_empty()) {
        let of = |all: &[Vec3], grain: usize| all.get(grain).copied().unwrap_or_else(Vec3::zeros);
        (0..grains).for_each(|grain| clumps.set_motion(grain, of(&found.velocity, grain), of(&found.spin, grain)));
        clumps.start(&mut particles);
    } else if let Some(found) = &mut file {
        let motions = [(&mut particles.velocity, &mut found.velocity), (&mut particles.spin, &mut found.spin)];
        for (own, given) in motions.into_iter().filter(|(_, given)| !given.is_empty()) {
            *own = std::mem::take(given);
        }
    }
    // No bond uses it.
    let section = BeamSection::new(asked.young_modulus, 1.0).map_err(|error| Fault::new(at, error))?;
    let (pairs, shares, walls, law) = (Vec::new(), Vec::new(), Vec::new(), section.into());
    let body = PreparedBody {
        particles,
        pairs,
        law,
        shares,
        walls,
        domain: None,
        shift_to_walls: Vec::new(),
        out_of_flat_walls: Vec::new(),
        fraction: 1.0,
        fracture: None,
        arrivals,
        clumps,
        replaced: Vec::new(),
    };
    let read = file.map(|file| match file.bonds.len() {
        0 => file.told(),
        count => format!("{}; without its {count} bonds", file.told()),
    });
    Ok(MadeParticles { body, read })
}

/// Discs of a file lie in the plane z = 0, and stay there.
fn check_plane(position: &[Vec3], file: &FileParticles) -> Result<(), Fault> {
    let leaves = |i: &usize| {
        let of = |all: &[Vec3]| all.get(*i).copied().unwrap_or_else(Vec3::zeros);
        position[*i].z != 0.0 || of(&file.velocity).z != 0.0 || of(&file.spin).xy().norm() != 0.0
    };
    let Some(first) = (0..position.len()).find(leaves) else { return Ok(()) };
    let found = format!("its particle {first} lies beside the plane z = 0, moves out of it or turns about x or y");
    Err(Fault::new(At::File, found).remedy("discs in the plane z = 0, or spheres: leave thickness out"))
}

/// Centre of mass, radius of the sphere around it [m] and orientation of each grain.
fn clump_places(clump: &Clump, centres: Vec<Vec3>, radii: Vec<f64>) -> Vec<(Vec3, f64, Rotation)> {
    let turns = match clump.turn {
        // Sizes and places have numbers of their own.
        Turn::ByChance(seed) => orientations(centres.len(), seed.wrapping_add(1 << 40)),
        Turn::By(turn) => vec![turn; centres.len()],
    };
    centres.into_iter().zip(radii).zip(turns).map(|((centre, radius), turn)| (centre, radius, turn)).collect()
}

/// Particles that may be asked for.
const MOST: f64 = 2e7;

/// What to do about a region that is too full.
const FEWER: &str = "fewer particles or a lower solid_fraction, a wider curve, or a larger region";
/// Solid fraction up to which places are drawn until they are free; beyond it the particles push each other apart.
const LOOSE: f64 = 0.3;
/// The same of discs, by area.
const LOOSE_DISCS: f64 = 0.45;

fn fill_graded(
    Shaped { domain, turn, area }: Shaped,
    repeats: [bool; 3],
    grading: &Grading,
    amount: Amount,
    seed: u64,
    tell: &dyn Fn(&str),
) -> Result<(Vec<Vec3>, Vec<f64>), Fault> {
    let whole = area.unwrap_or_else(|| domain.volume());
    let count = graded_count(whole, grading, amount);
    if count > MOST {
        let fault =
            Fault::new(At::Size, format!("asks for {count:.2e} particles of these sizes, more than {MOST:.0e}"));
        return Err(fault.remedy("a smaller region, or sizes with fewer fines"));
    }
    let diameters = grading.draw(count as usize, seed);
    let radii: Vec<f64> = diameters.iter().map(|diameter| 0.5 * diameter).collect();
    // Places have numbers of their own.
    let seed = !seed;
    let turned = |centres: Vec<Vec3>| centres.iter().map(|x| turn.place(x)).collect();
    let (content, loose): (fn(f64) -> f64, f64) =
        if area.is_some() { (|r| PI * r * r, LOOSE_DISCS) } else { (sphere_volume, LOOSE) };
    if radii.iter().copied().map(content).sum::<f64>() <= loose * whole {
        let (mut lower, mut upper) = domain.bounds();
        if area.is_some() {
            (lower.z, upper.z) = (0.0, 0.0);
        }
        let centres = insert(&lower, &upper, |x| domain.depth(x), &radii, seed);
        if centres.len() == radii.len() {
            return Ok((turned(centres), radii));
        }
    }
    tell(&format!("placing {count} particles densely"));
    let placed = match area {
        Some(area) => dense_discs(&domain, area, &radii, seed),
        None => dense(&domain, repeats, &radii, seed),
    };
    match placed {
        Ok(centres) => Ok((turned(centres), radii)),
        Err(PackError::Dense { asked, reached }) => {
            let room = (reached / asked * count).floor();
            let found = format!(
                "fills {asked:.3} of the shape with {count} particles, and random places of these sizes end at {reached:.3} there: there is room for {room} only"
            );
            Err(Fault::new(At::Size, found).remedy(FEWER))
        }
        Err(error @ PackError::NoRoom { .. }) => {
            Err(Fault::new(At::Shape, error).remedy("a larger region, or smaller particles"))
        }
        Err(error @ PackError::TooDense(_)) => Err(Fault::new(At::Size, error).remedy(FEWER)),
        Err(error) => Err(Fault::new(At::Shape, error)),
    }
}

/// How a shape is turned about a point of it.
struct Turned {
    about: Vec3,
    by: Option<Rotation>,
}

impl Turned {
    fn place(&self, x: &Vec3) -> Vec3 {
        self.by.map_or(*x, |by| self.about + by * (x - self.about))
    }
}

/// What is filled as a shape that can be packed.
struct Shaped {
    domain: Domain,
    turn: Turned,
    /// Area that discs fill in the plane z = 0, in the middle of the shape [m²]; none in space.
    area: Option<f64>,
}

fn domain(filled: Filled<'_>, mesh: &Mesh) -> Result<Shaped, Fault> {
    let shaped = |domain: Domain| {
        let turn = Turned { about: Vec3::zeros(), by: None };
        let area = if let Filled::Region(region) = filled { region.area() } else { None };
        Shaped { domain, turn, area }
    };
    let surface = match filled {
        Filled::Region(&Region::Box { point, size }) => {
            return Ok(shaped(Domain::Box { lower: point, upper: point + size }));
        }
        Filled::Region(&Region::Rectangle { point, size }) => {
            let half = Vec3::z() * (0.5 * size.x.min(size.y));
            return Ok(shaped(Domain::Box { lower: point - half, upper: point + size + half }));
        }
        Filled::Region(&(Region::Sphere { point, radius } | Region::Circle { point, radius })) => {
            return Ok(shaped(Domain::Sphere { centre: point, radius }));
        }
        Filled::Region(&Region::Cylinder { point, axis, length, radius }) => {
            let turn = Turned { about: point, by: Some(rotation_between(&Vec3::x(), &axis)) };
            return Ok(Shaped { turn, ..shaped(Domain::Cylinder { start: point, length, radius }) });
        }
        Filled::Group(group) => group_surface(mesh, Some(group)),
        Filled::Stl { bytes, unit } => read_stl(bytes, unit),
    };
    let surface = surface.map_err(|error| Fault::new(At::Source, error))?;
    Ok(shaped(Domain::Surface(surface)))
}

/// Radii of the particles of a stream [m], and when each is due [s]: when the rate has brought it as a whole.
fn due(stream: &Stream, density: f64) -> Result<(Vec<f64>, Vec<f64>), Fault> {
    let expected = stream.count(density);
    if expected > MOST {
        let fault = Fault::new(At::Rate, format!("brings {expected:.2e} particles, more than {MOST:.0e}"));
        return Err(fault.remedy("a lower rate, a shorter time, or larger particles"));
    }
    let (mut radii, mut due, mut brought) = (Vec::new(), Vec::new(), 0.0);
    // By chance sizes may fall short of their mean: the time alone ends a stream by mass.
    let most = stream.most.map_or(usize::MAX, |most| most as usize);
    for radius in stream.sizes.radii(stream.seed).take(most) {
        brought += match stream.rate {
            Rate::Mass(rate) => sphere_volume(radius) * density / rate,
            Rate::Number(rate) => 1.0 / rate,
        };
        let time = stream.from + brought;
        // A number of particles that is asked for is there in spite of rounding.
        if stream.until.is_some_and(|until| time > until + 1e-9 * (until - stream.from)) {
            break;
        }
        radii.push(radius);
        due.push(time);
    }
    if radii.is_empty() {
        let fault = Fault::new(At::Rate, "brings less than one particle until its end");
        return Err(fault.remedy("a higher rate, a later end, or smaller particles"));
    }
    Ok((radii, due))
}

/// A place in a stream's region for a ball of a radius [m], by the number of the place.
type PlaceOf = Arc<dyn Fn(f64, u64) -> Vec3 + Send + Sync>;

/// Box around a stream's region, and places in it.
fn places(stream: &Stream) -> Result<([Vec3; 2], PlaceOf), Fault> {
    let (lower, upper) = bounds(&stream.region);
    let (depth, largest) = (depth_in(&stream.region), stream.sizes.largest());
    // Places have numbers of their own.
    let seed = !stream.seed;
    if place_in(&lower, &upper, &depth, largest, (seed, 0)).is_none() {
        let fault = Fault::new(At::Shape, "has no room for its largest particle");
        return Err(fault.remedy("a larger region, or smaller particles"));
    }
    let place = move |radius: f64, number: u64| {
        place_in(&lower, &upper, &depth, radius, (seed, number)).unwrap_or(0.5 * (lower + upper))
    };
    Ok(([lower, upper], Arc::new(place)))
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
        Region::Rectangle { point, size } => (point, point + size),
        Region::Circle { point, radius } => {
            let reach = Vec3::new(radius, radius, 0.0);
            (point - reach, point + reach)
        }
    }
}

/// Distance of a point from the wall of a region [m], positive inside.
fn depth_in(region: &Region) -> impl Fn(&Vec3) -> f64 + use<> {
    let region = *region;
    move |x| match region {
        Region::Box { point, size } => (x - point).min().min((point + size - x).min()),
        Region::Cylinder { point, axis, length, radius } => {
            let along = (x - point).dot(&axis);
            along.min(length - along).min(radius - (x - point - axis * along).norm())
        }
        Region::Sphere { point, radius } => radius - (x - point).norm(),
        Region::Rectangle { point, size } => (x - point).xy().min().min((point + size - x).xy().min()),
        Region::Circle { point, radius } => radius - (x - point).xy().norm(),
    }
}

fn fill(region: &Region, radius: f64, dispersion: f64, most: usize, seed: u64) -> (Vec<Vec3>, Vec<f64>) {
    let ((mut lower, mut upper), depth) = (bounds(region), depth_in(region));
    // Cells touch the walls of a box exactly; rounding must not push them out.
    let slack = if matches!(region, Region::Box { .. } | Region::Rectangle { .. }) { 1e-12 } else { 0.0 };
    let is_plane = region.area().is_some();
    if is_plane {
        // One layer of cells, in which discs lie side by side.
        (lower.z, upper.z) = (-2.0 * radius, 2.0 * radius);
    }
    let depth = |x: &Vec3| depth(x) * (1.0 + slack) + slack * radius;
    let (mut centres, radii) = cloud(&lower, &upper, depth, radius, dispersion, most, seed);
    if is_plane {
        centres.iter_mut().for_each(|x| x.z = 0.0);
    }
    (centres, radii)
}
