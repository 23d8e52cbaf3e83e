use fractum_math::elementary::{cbrt, exp};
use fractum_math::{Vec3, sphere_volume};

use crate::domain::Domain;
use crate::neighbours::spatial_order;
use crate::packing::{Compaction, Packing};
use crate::random::Random;
use crate::relax::Assembly;
use crate::{Certificate, PackError};

/// What to pack.
#[derive(Clone, Debug)]
pub struct PackSpec {
    /// The shape to fill.
    pub domain: Domain,
    /// How many particles, or how large.
    pub size: PackSize,
    /// κ = (R_max − R_min)/R_mean of the uniform radii; 0.25 by default.
    pub dispersion: f64,
    /// Seed of the generator.
    pub seed: u64,
    /// Mean number of contacts of particles that touch no wall, at which compaction stops; 6.2 by default (random
    /// close packing).
    pub coordination: f64,
}

/// How the particle size is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PackSize {
    /// This many particles; the radii follow.
    Count(usize),
    /// Particles of about this mean radius [m]; the count follows (the radius reached differs by about 1 %).
    MeanRadius(f64),
}

impl PackSpec {
    /// A packing of `count` particles with the usual dispersion and coordination.
    pub fn new(domain: Domain, count: usize, seed: u64) -> Self {
        PackSpec { domain, size: PackSize::Count(count), dispersion: 0.25, seed, coordination: 6.2 }
    }
}

/// Core volume fraction of the forced insertion: slightly above jamming, where relaxation is fast.
const FRACTION_INSERTED: f64 = 0.651;
/// Loss of volume fraction near a wall, in mean diameters of wall-adjacent layer.
const WALL_LAYER: f64 = 0.16;
/// Contacts per particle at jamming, rattlers included.
const CRITICAL: f64 = 5.85;
/// d(z − z_c)²/d ln R: 7.9² × 3 φ.
const EXCESS_SLOPE: f64 = 120.0;
/// Width of the accepted window above the asked coordination.
const WINDOW: f64 = 0.08;
/// Narrowest extent of a domain, in mean diameters.
const NARROWEST: f64 = 2.5;
/// The same of a box that repeats, in which no particle may meet two images of another: the longest bonds are two diameters long.
const NARROWEST_PERIOD: f64 = 5.0;
/// Net force over mean contact force at which a state counts as relaxed.
const BALANCE: f64 = 0.02;
/// The same for the first relaxation after forced insertion.
const FIRST_BALANCE: f64 = 0.04;

/// Packings made before an uncertified one is given out, and the distance of their seeds.
const ATTEMPTS: u64 = 3;
const SEEDS_APART: u64 = 1_000_000;

/// Where the compaction of a packing is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PackProgress {
    /// Particles.
    pub count: usize,
    /// Times that all radii were scaled and the particles relaxed.
    pub rounds: usize,
    /// Contacts per particle off the walls, as they are now.
    pub reached: f64,
    /// The same as asked.
    pub asked: f64,
}

impl std::fmt::Display for PackProgress {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let PackProgress { count, rounds, reached, asked } = self;
        write!(f, "packing {count} particles: {reached:.2} of {asked} contacts each after round {rounds}")
    }
}

/// Packs as [`pack`] does, and again with another seed, a few times at most, where the certificate misses its targets: one
/// packing in six is less isotropic than it should be by chance.
///
/// Gives the first packing that needs no other seed, else the first that passes [`Certificate::check`], else the first of all.
///
/// - `tell`: called after each round of compaction
///
/// # Errors
/// Those of [`pack`].
pub fn pack_certified(spec: &PackSpec, tell: &dyn Fn(PackProgress)) -> Result<(Packing, Certificate), PackError> {
    let measured = |seed: u64| {
        let packing = pack_and_tell(&PackSpec { seed, ..spec.clone() }, tell)?;
        let certificate = Certificate::of(&packing);
        Ok((packing, certificate))
    };
    let first = measured(spec.seed)?;
    if first.1.is_good() {
        return Ok(first);
    }
    let mut best = first;
    for attempt in 1..ATTEMPTS {
        let other = measured(spec.seed.wrapping_add(attempt * SEEDS_APART))?;
        if other.1.is_good() {
            return Ok(other);
        }
        if best.1.check().is_err() && other.1.check().is_ok() {
            best = other;
        }
    }
    Ok(best)
}

/// Packs spheres into a domain: random insertion, forced insertion with relaxation, compaction to the asked
/// coordination, and release of the walls (Jebahi et al. 2015, algorithm 2).
///
/// The same specification gives the same bits for any number of threads.
///
/// # Errors
/// Bad dimensions, dispersion or counts; a domain too narrow for its particles; [`PackError::Refused`] when the
/// compaction does not reach the asked coordination.
pub fn pack(spec: &PackSpec) -> Result<Packing, PackError> {
    pack_and_tell(spec, &|_| {})
}

/// As [`pack`].
///
/// - `tell`: called after each round of compaction
///
/// # Errors
/// Those of [`pack`].
pub fn pack_and_tell(spec: &PackSpec, tell: &dyn Fn(PackProgress)) -> Result<Packing, PackError> {
    let (count, start_radius) = plan(spec)?;
    let mut random = Random::new(spec.seed);
    let half = 0.5 * spec.dispersion;
    let mut shape: Vec<f64> = (0..count).map(|_| random.between(1.0 - half, 1.0 + half)).collect();
    // The drawn sizes are scaled to the planned volume, so that the start does not depend on their scatter.
    let cube_mean = shape.iter().map(|r| r.powi(3)).sum::<f64>() / count as f64;
    let expected = 1.0 + half * half;
    let scale = start_radius * cbrt(expected / cube_mean);
    shape.iter_mut().for_each(|r| *r *= scale);

    let position = insert(&spec.domain, &shape, &mut random)?;
    let order = spatial_order(&position);
    let position: Vec<Vec3> = order.iter().map(|&i| position[i as usize]).collect();
    let radius: Vec<f64> = order.iter().map(|&i| shape[i as usize]).collect();
    let mut assembly = Assembly::new(&spec.domain, position, radius);
    let mut iterations = 0;
    let mut compaction = compact(&mut assembly, spec.coordination, &mut iterations, tell)?;
    let (contacts, walls) = assembly.touching();
    compaction.rattlers = rattlers(&contacts, &walls);
    compaction.contacts = contacts.iter().map(Vec::len).sum::<usize>() / 2;

    if spec.domain.period().is_some() {
        // No walls give way: the spheres shrink by what they overlap on average.
        assembly.scale_radii(1.0 - 0.5 * compaction.overlap);
        iterations += assembly.relax(0.1, 150).iterations;
    }
    for stiffness in [0.1, 0.01].into_iter().filter(|_| spec.domain.period().is_none()) {
        assembly.wall_stiffness = stiffness;
        iterations += assembly.relax(0.1, 150).iterations;
    }
    assembly.fit_walls();
    compaction.iterations = iterations;

    let order = spatial_order(&assembly.position);
    let sorted = |i: &u32| *i as usize;
    let inside = |x: &Vec3| spec.domain.period().map_or(*x, |period| period.within(x));
    let names = spec.domain.wall_names();
    let set = |w: usize| (0..count as u32).filter(|&k| walls[order[k as usize] as usize] >> w & 1 == 1).collect();
    Ok(Packing {
        domain: spec.domain.clone(),
        seed: spec.seed,
        dispersion: spec.dispersion,
        position: order.iter().map(|i| inside(&assembly.position[sorted(i)])).collect(),
        radius: order.iter().map(|i| assembly.radius[sorted(i)]).collect(),
        walls: names.iter().enumerate().map(|(w, name)| (name.to_string(), set(w))).collect(),
        compaction,
    })
}

/// Count and mean radius to start from.
fn plan(spec: &PackSpec) -> Result<(usize, f64), PackError> {
    spec.domain.check()?;
    if !(0.0..=1.0).contains(&spec.dispersion) {
        return Err(PackError::Dispersion(spec.dispersion));
    }
    if !(spec.coordination > 3.0 && spec.coordination < 8.0) {
        return Err(PackError::Refused {
            target: format!("contacts per particle {}", spec.coordination),
            reached: "not tried".into(),
            remedy: "random packings stop between 3 and 8 contacts; larger bond coordinations come from the search radius",
        });
    }
    let (volume, area) = (spec.domain.volume(), spec.domain.area());
    let cube_mean = 1.0 + (0.5 * spec.dispersion).powi(2);
    // φ V_effective = N (4/3)π R³ ⟨ρ³⟩, where a layer at the walls is less dense.
    let filled = |r: f64| FRACTION_INSERTED * (volume - WALL_LAYER * 2.0 * r * area).max(0.1 * volume);
    let sphere = |r: f64| sphere_volume(r) * cube_mean;
    let (count, radius) = match spec.size {
        PackSize::Count(count) => {
            let (mut low, mut high) = (0.0, cbrt(volume / count.max(1) as f64));
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if sphere(middle) * count as f64 > filled(middle) { high = middle } else { low = middle }
            }
            (count, low)
        }
        PackSize::MeanRadius(radius) => {
            if !(1e-15..=1e15).contains(&radius) {
                return Err(PackError::BadDimension { what: "mean particle radius", value: radius });
            }
            // From forced insertion to the end of compaction radii shrink by about 0.5 %.
            let start = radius * 1.005;
            ((filled(start) / sphere(start)).round().min(1e9) as usize, start)
        }
    };
    let (lower, upper) = spec.domain.bounds();
    let extent = (upper - lower).min();
    let across = extent / (2.0 * radius);
    let needed = if spec.domain.period().is_some() { NARROWEST_PERIOD } else { NARROWEST };
    if count < 20 && matches!(spec.size, PackSize::MeanRadius(_)) || across < needed {
        return Err(PackError::TooSmall { count, extent, across, needed });
    }
    if !(20..=20_000_000).contains(&count) {
        return Err(PackError::Count(count));
    }
    Ok((count, radius))
}

/// Random insertion without overlap until it fails often; the rest is forced in where most room is left among a few
/// random places.
fn insert(domain: &Domain, radius: &[f64], random: &mut Random) -> Result<Vec<Vec3>, PackError> {
    const FAILURES: usize = 60;
    const CANDIDATES: usize = 6;
    let (lower, upper) = domain.bounds();
    let largest = radius.iter().copied().fold(0.0, f64::max);
    let cell = 2.0 * largest;
    let size = [0, 1, 2].map(|a| (((upper[a] - lower[a]) / cell) as usize + 1).min(1 << 20));
    let cells = size.iter().map(|&s| s as f64).product::<f64>();
    if cells > 64.0 * radius.len() as f64 + 1e6 {
        return Err(PackError::Sparse(domain.volume() / (upper - lower).product()));
    }
    let mut first = vec![u32::MAX; cells as usize];
    let mut next = vec![u32::MAX; radius.len()];
    let mut position: Vec<Vec3> = Vec::with_capacity(radius.len());
    let coordinates = |p: &Vec3| [0, 1, 2].map(|a| (((p[a] - lower[a]) / cell).max(0.0) as usize).min(size[a] - 1));
    let period = domain.period();
    let mut failures = 0;
    for (i, &r) in radius.iter().enumerate() {
        let mut best: Option<(f64, Vec3)> = None;
        let mut tries = 0;
        let mut attempts = 0u64;
        loop {
            attempts += 1;
            if attempts > 10_000_000 {
                let extent = (upper - lower).min();
                return Err(PackError::TooSmall {
                    count: radius.len(),
                    extent,
                    across: extent / (2.0 * r),
                    needed: NARROWEST,
                });
            }
            let x = Vec3::from_fn(|a, _| random.between(lower[a], upper[a]));
            if domain.depth(&x) < r {
                continue;
            }
            let mut gap = f64::INFINITY;
            let mut look = |x: Vec3| {
                let [cx, cy, cz] = coordinates(&x);
                for z in cz.saturating_sub(1)..=(cz + 1).min(size[2] - 1) {
                    for y in cy.saturating_sub(1)..=(cy + 1).min(size[1] - 1) {
                        for c in cx.saturating_sub(1)..=(cx + 1).min(size[0] - 1) {
                            let mut j = first[(z * size[1] + y) * size[0] + c];
                            while j != u32::MAX {
                                gap = gap.min((position[j as usize] - x).norm() - r - radius[j as usize]);
                                j = next[j as usize];
                            }
                        }
                    }
                }
            };
            match period {
                None => look(x),
                Some(period) => period.images(x, cell).for_each(look),
            }
            if best.is_none_or(|(other, _)| gap > other) {
                best = Some((gap, x));
            }
            tries += 1;
            let free = gap >= 0.0;
            if !free {
                failures += 1;
            }
            let forcing = failures > FAILURES * radius.len() / 4;
            if free || forcing && tries >= CANDIDATES {
                break;
            }
        }
        let x = best.map_or(lower, |(_, x)| x);
        let [cx, cy, cz] = coordinates(&x);
        let home = (cz * size[1] + cy) * size[0] + cx;
        next[i] = first[home];
        first[home] = i as u32;
        position.push(x);
    }
    Ok(position)
}

/// Scales the radii, relaxing each time, until particles off the walls have the asked number of contacts.
///
/// Above jamming (z − z_c)² grows linearly with ln R (O'Hern et al. 2003, Phys. Rev. E 68, 011306), which makes the
/// next scale predictable; states slightly above jamming also relax much faster than those just below.
fn compact(
    assembly: &mut Assembly,
    asked: f64,
    iterations: &mut usize,
    tell: &dyn Fn(PackProgress),
) -> Result<Compaction, PackError> {
    let aim = asked + 0.5 * WINDOW;
    let excess = |z: f64| (z - CRITICAL).max(0.0).powi(2);
    let mut slope = EXCESS_SLOPE;
    let mut last: Option<(f64, f64)> = None;
    let mut scale: f64 = 0.0;
    let mut reached = 0.0;
    for round in 0..40 {
        let relaxed = assembly.relax(if round == 0 { FIRST_BALANCE } else { BALANCE }, 3000);
        *iterations += relaxed.iterations;
        let (contacts, walls) = assembly.touching();
        let interior: Vec<usize> = (0..contacts.len()).filter(|&i| walls[i] == 0).collect();
        let total: usize = interior.iter().map(|&i| contacts[i].len()).sum();
        reached = total as f64 / interior.len().max(1) as f64;
        tell(PackProgress { count: contacts.len(), rounds: round + 1, reached, asked });
        if reached >= asked && reached <= asked + WINDOW {
            let overlap = relaxed.overlap / assembly.mean_radius();
            return Ok(Compaction { coordination: reached, overlap, contacts: 0, rattlers: 0, iterations: 0 });
        }
        if let Some((other_scale, other)) = last.filter(|l| l.0 != scale) {
            let measured = (excess(reached) - excess(other)) / (scale - other_scale);
            if measured > 0.0 && reached > CRITICAL && other > CRITICAL {
                slope = measured.clamp(0.5 * EXCESS_SLOPE, 2.0 * EXCESS_SLOPE);
            }
        }
        last = Some((scale, reached));
        // Near the aim a smaller part of the predicted change, as each relaxation also shifts jamming a little.
        let part = if round < 6 { 1.0 } else { 0.6 };
        let change = (part * (excess(aim) - excess(reached)) / slope).clamp(-0.01, 0.004);
        scale += change;
        assembly.scale_radii(exp(change));
    }
    Err(PackError::Refused {
        target: format!("contacts per interior particle {asked} to {:.2}", asked + WINDOW),
        reached: format!("{reached:.3}"),
        remedy: "use more particles, or a dispersion of 0.25",
    })
}

/// Particles with fewer than four contacts (walls counted), removed until none is left.
fn rattlers(contacts: &[Vec<u32>], walls: &[u32]) -> usize {
    let mut live = vec![true; contacts.len()];
    let mut count: Vec<u32> = contacts.iter().zip(walls).map(|(c, w)| c.len() as u32 + w.count_ones()).collect();
    let mut queue: Vec<usize> = (0..contacts.len()).filter(|&i| count[i] < 4).collect();
    while let Some(i) = queue.pop() {
        if !std::mem::replace(&mut live[i], false) {
            continue;
        }
        for &j in &contacts[i] {
            let j = j as usize;
            count[j] -= 1;
            if live[j] && count[j] < 4 {
                queue.push(j);
            }
        }
    }
    live.iter().filter(|&&l| !l).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::tests::cube;
    use crate::{ClosedSurface, Convention, bond};

    fn digest(packing: &Packing) -> Vec<u64> {
        packing
            .position
            .iter()
            .flat_map(|p| [p.x, p.y, p.z])
            .chain(packing.radius.iter().copied())
            .map(f64::to_bits)
            .collect()
    }

    #[test]
    fn a_seed_gives_the_same_bits_for_any_number_of_threads() {
        let spec = PackSpec::new(Domain::cuboid(1.0, 1.2, 0.9), 2500, 3);
        let run = |threads| {
            rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| pack(&spec).unwrap())
        };
        let one = digest(&run(1));
        assert_eq!(one, digest(&run(2)));
        assert_eq!(one, digest(&run(7)));
        let other = pack(&PackSpec { seed: 4, ..spec.clone() }).unwrap();
        assert_ne!(one, digest(&other));
    }

    #[test]
    fn every_shape_is_filled_to_random_close_packing() {
        let (points, triangles) = cube(1.0);
        let shapes = [
            Domain::cuboid(1.0, 1.0, 1.0),
            Domain::cylinder(2.0, 0.5),
            Domain::sphere(0.7),
            Domain::Surface(ClosedSurface::new(&points, &triangles).unwrap()),
        ];
        for domain in shapes {
            let packing = pack(&PackSpec::new(domain, 2000, 1)).unwrap();
            let certificate = Certificate::of(&packing);
            assert!((6.2..=6.281).contains(&certificate.contacts.coordination_interior), "{certificate:?}");
            let core = certificate.fraction_core.unwrap();
            assert!((0.62..0.66).contains(&core), "{:?} {core}", packing.domain);
            assert!(certificate.overlap.mean < 2e-3 && certificate.contacts.rattlers < 0.05, "{certificate:?}");
            let worst = packing.position.iter().zip(&packing.radius).map(|(x, r)| packing.domain.depth(x) / r);
            let worst = worst.fold(1.0, f64::min);
            assert!(worst > 0.85, "a particle stands out of {:?}: {worst}", packing.domain);
            assert!(packing.walls.iter().all(|(_, set)| !set.is_empty()));
        }
    }

    #[test]
    fn a_box_that_repeats_is_filled_to_random_close_packing_without_walls() {
        let (lower, upper) = (Vec3::new(-1.0, 0.5, 3.0), Vec3::new(0.0, 1.7, 3.9));
        for seed in 1..4 {
            let packing = pack(&PackSpec::new(Domain::Periodic { lower, upper }, 1500, seed)).unwrap();
            let certificate = Certificate::of(&packing);
            certificate.check().unwrap();
            assert!((6.2..=6.281).contains(&certificate.contacts.coordination_all), "{certificate:?}");
            // All of it is core: by sample points, and by the spheres less their overlaps.
            let (core, spheres) = (certificate.fraction_core.unwrap(), certificate.fraction_box);
            assert!((0.625..0.65).contains(&core) && (core / spheres - 1.0).abs() < 5e-3, "{core} {spheres}");
            assert!(packing.walls.is_empty());
            assert!(packing.position.iter().all(|x| (0..3).all(|k| (lower[k]..=upper[k]).contains(&x[k]))));
            for coordination in [6.0, 8.0, 10.0] {
                let network = bond(&packing, coordination, Convention::Interior).unwrap();
                let through = |pair: &&[u32; 2]| {
                    let [a, b] = pair.map(|i| packing.position[i as usize]);
                    (a - b).norm() > 2.0 * packing.apart(pair.map(|i| i as usize)).norm()
                };
                let share = network.pairs.iter().filter(through).count() as f64 / network.pairs.len() as f64;
                assert!((0.1..0.5).contains(&share), "{share}");
            }
            let back = Packing::from_bytes(&packing.to_bytes()).unwrap();
            assert_eq!(digest(&packing), digest(&back));
            assert!(back.domain.period().is_some());
        }
    }

    #[test]
    fn a_triangulated_cube_packs_like_the_box() {
        let (points, triangles) = cube(1.0);
        let surface = Domain::Surface(ClosedSurface::new(&points, &triangles).unwrap());
        let meshed = Certificate::of(&pack(&PackSpec::new(surface, 3000, 1)).unwrap());
        let plain = Certificate::of(&pack(&PackSpec::new(Domain::cuboid(1.0, 1.0, 1.0), 3000, 1)).unwrap());
        assert!(
            (meshed.fraction_box - plain.fraction_box).abs() < 0.006,
            "{} {}",
            meshed.fraction_box,
            plain.fraction_box
        );
    }

    #[test]
    fn radii_have_the_asked_dispersion_and_mean() {
        let spec = PackSpec {
            size: PackSize::MeanRadius(0.03),
            dispersion: 0.4,
            ..PackSpec::new(Domain::cuboid(1.0, 1.0, 1.0), 0, 9)
        };
        let packing = pack(&spec).unwrap();
        assert!((packing.mean_radius() / 0.03 - 1.0).abs() < 0.015, "{}", packing.mean_radius());
        assert!((Certificate::of(&packing).dispersion - 0.4).abs() < 0.01);
    }

    #[test]
    fn both_conventions_reach_the_asked_coordination() {
        let packing = pack(&PackSpec::new(Domain::cuboid(1.0, 1.0, 1.0), 1500, 5)).unwrap();
        for asked in [6.0, 8.5, 13.0] {
            assert!((bond(&packing, asked, Convention::All).unwrap().coordination_all - asked).abs() < 0.002);
            let inside = bond(&packing, asked.max(6.3), Convention::Interior).unwrap();
            assert!((inside.coordination_interior - asked.max(6.3)).abs() < 0.002);
            assert!(inside.coordination_all < inside.coordination_interior);
        }
        for unreachable in [2.0, 60.0, f64::NAN] {
            assert!(matches!(bond(&packing, unreachable, Convention::All), Err(PackError::Coordination { .. })));
        }
    }

    #[test]
    fn impossible_requests_are_refused_with_a_reason() {
        let unit = || Domain::cuboid(1.0, 1.0, 1.0);
        let failing = |spec: PackSpec| pack(&spec).unwrap_err();
        assert!(matches!(
            failing(PackSpec { dispersion: 1.2, ..PackSpec::new(unit(), 100, 1) }),
            PackError::Dispersion(_)
        ));
        assert!(matches!(
            failing(PackSpec { dispersion: f64::NAN, ..PackSpec::new(unit(), 100, 1) }),
            PackError::Dispersion(_)
        ));
        assert!(matches!(failing(PackSpec::new(unit(), 3, 1)), PackError::TooSmall { .. } | PackError::Count(3)));
        assert!(matches!(failing(PackSpec::new(Domain::cuboid(1.0, 1.0, 0.01), 1000, 1)), PackError::TooSmall { .. }));
        assert!(matches!(
            failing(PackSpec::new(Domain::cuboid(1.0, -1.0, 1.0), 1000, 1)),
            PackError::BadDimension { .. }
        ));
        assert!(matches!(
            failing(PackSpec::new(Domain::sphere(f64::INFINITY), 1000, 1)),
            PackError::BadDimension { .. }
        ));
        let size = PackSize::MeanRadius(0.4);
        assert!(matches!(failing(PackSpec { size, ..PackSpec::new(unit(), 1, 1) }), PackError::TooSmall { .. }));
        assert!(matches!(
            failing(PackSpec { coordination: 9.0, ..PackSpec::new(unit(), 100, 1) }),
            PackError::Refused { .. }
        ));
    }

    #[test]
    fn an_uncertified_packing_is_tried_again_and_then_given_out_as_it_is() {
        // A slab three diameters thick is layered by its walls whatever the seed.
        let spec = PackSpec::new(Domain::cuboid(1.0, 1.0, 0.12), 1500, 1);
        let told = std::cell::RefCell::new(Vec::new());
        let (packing, certificate) = pack_certified(&spec, &|at| told.borrow_mut().push(at)).unwrap();
        let (first, last) = (told.borrow()[0], *told.borrow().last().unwrap());
        assert_eq!((first.rounds, first.count), (1, packing.len()));
        assert!((last.asked..last.asked + WINDOW).contains(&last.reached), "{last}");
        assert!(certificate.check().is_err(), "{certificate:?}");
        assert_eq!(digest(&packing), digest(&pack(&spec).unwrap()));
    }

    #[test]
    fn an_ordered_packing_fails_its_certificate() {
        // Equal spheres on a simple cubic lattice.
        let mut packing = pack(&PackSpec::new(Domain::cuboid(1.0, 1.0, 1.0), 1000, 1)).unwrap();
        packing.radius.fill(0.05);
        packing.position = (0..1000)
            .map(|i| Vec3::new((i % 10) as f64, (i / 10 % 10) as f64, (i / 100) as f64) * 0.1 + Vec3::repeat(0.05))
            .collect();
        assert!(matches!(Certificate::of(&packing).check(), Err(PackError::Refused { .. })));
    }

    #[test]
    fn absurd_sizes_are_refused() {
        let lengths = [5e-324, 1e-310, 1e-200, 1e-110, 1e-20, 1e20, 1e110, 1e200, f64::MAX, f64::INFINITY, f64::NAN];
        let mut specs = Vec::new();
        for x in lengths {
            let surface = ClosedSurface::new(&cube(x).0, &cube(x).1);
            let far = Vec3::repeat(x.max(1e10));
            specs.extend([Domain::cuboid(x, x, x), Domain::cuboid(1.0, 1.0, x), Domain::cylinder(1.0, x)]);
            specs.extend([Domain::cylinder(x, x), Domain::sphere(x), Domain::Sphere { centre: far, radius: 1.0 }]);
            specs.push(Domain::Box { lower: far, upper: far.add_scalar(1.0) });
            specs.extend(surface.map(Domain::Surface));
        }
        for domain in specs {
            for size in [PackSize::Count(100), PackSize::MeanRadius(0.05), PackSize::MeanRadius(1e-200)] {
                let spec = PackSpec { size, ..PackSpec::new(domain.clone(), 0, 1) };
                assert!(pack(&spec).is_err(), "{domain:?} {size:?}");
            }
        }
        for radius in lengths {
            let size = PackSize::MeanRadius(radius);
            assert!(
                pack(&PackSpec { size, ..PackSpec::new(Domain::cuboid(1.0, 1.0, 1.0), 0, 1) }).is_err(),
                "{radius}"
            );
        }
        for count in [0, 1, usize::MAX] {
            assert!(pack(&PackSpec::new(Domain::cuboid(1.0, 1.0, 1.0), count, 1)).is_err(), "{count}");
        }
    }
}
