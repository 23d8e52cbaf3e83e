//! Spheres of given sizes at random places that do not touch, as densely as random places allow: a random overlapping
//! start whose spheres, a little enlarged, push each other apart (O'Hern et al. 2003, Phys. Rev. E 68, 011306).

use fractum_math::{Vec3, sphere_volume};

use crate::PackError;
use crate::domain::Domain;
use crate::neighbours::{Neighbours, spatial_order};
use crate::period::Period;
use crate::random::Random;
use crate::relax::{Assembly, Relaxed};

/// Shares by which the radii are enlarged while the spheres push each other apart, one after another, and the steps of each: the
/// larger, the faster and the more even, and the farther below jamming the cloud must be.
const ENLARGED: [(f64, usize); 6] =
    [(0.05, 300), (0.02, 600), (0.01, 1000), (5e-3, 2000), (2e-3, 3000), (SMALLEST, STEPS)];
/// The smallest of these shares.
const SMALLEST: f64 = 1e-3;
/// Steps with it.
const STEPS: usize = 4000;
/// Part of the enlargement that may be used up.
const USED: f64 = 0.98;
/// Net force over mean contact force at which spheres are jammed.
const JAMMED: f64 = 0.02;
/// Search skin in mean radii: a random start is far from the end.
const SKIN: f64 = 0.3;
/// Share by which radii shrink at least while the largest fraction is looked for.
const SHRUNK: f64 = 1e-3;
/// Fraction above those of all random packings.
const MOST: f64 = 0.9;
/// Places that are drawn for a sphere before a shape has no room for it.
const DRAWS: usize = 100_000;

/// Centres of spheres that lie at random in a shape and do not touch [m].
///
/// The same numbers give the same bits for any number of threads.
///
/// - `repeats`: axes along which space repeats with the edges of a box, which has no walls there
/// - `radii` [m]
///
/// # Errors
/// Bad dimensions; [`PackError::NoRoom`] for a sphere that has no room by itself; [`PackError::Dense`] with the largest fraction
/// that was reached with these sizes; [`PackError::TooDense`] where none comes near.
pub fn dense(domain: &Domain, repeats: [bool; 3], radii: &[f64], seed: u64) -> Result<Vec<Vec3>, PackError> {
    let asked = radii.iter().copied().map(sphere_volume).sum::<f64>() / domain.volume();
    place(domain, repeats, false, radii, asked, seed)
}

/// The same of discs in the plane through the middle of a box or sphere, across z.
///
/// # Errors
/// Those of [`dense`].
pub fn dense_discs(domain: &Domain, area: f64, radii: &[f64], seed: u64) -> Result<Vec<Vec3>, PackError> {
    let asked = radii.iter().map(|radius| std::f64::consts::PI * radius * radius).sum::<f64>() / area;
    place(domain, [false; 3], true, radii, asked, seed)
}

/// - `asked`: share of the domain that is to be filled
fn place(
    domain: &Domain,
    repeats: [bool; 3],
    in_plane: bool,
    radii: &[f64],
    asked: f64,
    seed: u64,
) -> Result<Vec<Vec3>, PackError> {
    domain.check()?;
    let (mut lower, mut upper) = domain.bounds();
    if in_plane {
        (lower.z, upper.z) = (0.5 * (lower.z + upper.z), 0.5 * (lower.z + upper.z));
    }
    // What does not repeat is as a period without end, and a wall that is not there infinitely far.
    let period = repeats.contains(&true).then(|| {
        let end = |axis: usize, own: &Vec3, sign: f64| if repeats[axis] { own[axis] } else { sign * 1e300 };
        Period::new(Vec3::from_fn(|axis, _| end(axis, &lower, -1.0)), Vec3::from_fn(|axis, _| end(axis, &upper, 1.0)))
    });
    let walls = match (period, domain) {
        (None, Domain::Box { .. }) if in_plane => {
            let end = |x: &Vec3, z: f64| Vec3::new(x.x, x.y, z);
            Domain::Box { lower: end(&lower, f64::NEG_INFINITY), upper: end(&upper, f64::INFINITY) }
        }
        (None, _) => domain.clone(),
        (Some(_), _) => {
            let end = |axis: usize, own: &Vec3, sign: f64| if repeats[axis] { sign * f64::INFINITY } else { own[axis] };
            let [lower, upper] =
                [(&lower, -1.0), (&upper, 1.0)].map(|(own, sign)| Vec3::from_fn(|axis, _| end(axis, own, sign)));
            Domain::Box { lower, upper }
        }
    };
    let mut random = Random::new(seed);
    let mut place = |radius: f64| {
        let mut draw = || Vec3::from_fn(|axis, _| random.between(lower[axis], upper[axis]));
        (0..DRAWS).map(|_| draw()).find(|x| walls.depth(x) >= radius)
    };
    let start = radii.iter().map(|&radius| place(radius).ok_or(PackError::NoRoom { radius }));
    let start = start.collect::<Result<Vec<Vec3>, PackError>>()?;
    if asked > MOST {
        return Err(PackError::TooDense(asked));
    }
    let order = spatial_order(&start);
    let sorted: Vec<f64> = order.iter().map(|&i| radii[i as usize]).collect();
    let dimensions = if in_plane { 2 } else { 3 };
    let places = order.iter().map(|&i| start[i as usize]).collect();
    let mut cloud = Cloud::new(&walls, period, places, sorted, dimensions);
    if ENLARGED.into_iter().any(|(enlarged, steps)| cloud.push_apart(enlarged, steps)) {
        let mut centres = start;
        for (&i, x) in order.iter().zip(&cloud.assembly.position) {
            centres[i as usize] = period.map_or(*x, |period| period.within(x));
        }
        return Ok(centres);
    }
    Err(PackError::Dense { asked, reached: asked * cloud.shrink().powi(dimensions) })
}

/// Spheres on their way to places where they do not touch.
struct Cloud<'a> {
    assembly: Assembly<'a>,
    /// Radii as they are asked for [m].
    radius: Vec<f64>,
    /// Those of the cloud over them.
    scale: f64,
}

impl<'a> Cloud<'a> {
    fn new(walls: &'a Domain, period: Option<Period>, position: Vec<Vec3>, radius: Vec<f64>, dimensions: i32) -> Self {
        let smallest = radius.iter().copied().fold(f64::INFINITY, f64::min);
        let mut assembly = Assembly::new(walls, position, radius.clone());
        assembly.period = period;
        assembly.skin = SKIN;
        // Contacts, and with them stiffness, grow with the surface, or the circumference.
        assembly.mobility = radius.iter().map(|r| (smallest / r).powi(dimensions - 1)).collect();
        Cloud { assembly, radius, scale: 1.0 }
    }

    /// Lets spheres that are enlarged by a share push each other apart; whether none of them touches another one or a wall then.
    fn push_apart(&mut self, enlarged: f64, steps: usize) -> bool {
        self.relax(enlarged, steps).is_free && self.is_free()
    }

    /// Scale at which the spheres find places where they do not touch.
    fn shrink(&mut self) -> f64 {
        loop {
            let relaxed = self.relax(SMALLEST, STEPS);
            if relaxed.is_free && self.is_free() {
                return self.scale;
            }
            let overlap = relaxed.overlap / (2.0 * self.assembly.mean_radius());
            self.scale *= 1.0 - (0.5 * overlap).max(SHRUNK);
        }
    }

    fn relax(&mut self, enlarged: f64, steps: usize) -> Relaxed {
        if let Domain::Surface(surface) = self.assembly.domain {
            // Large spheres may squeeze a small one through a surface, which pushes what is near it only.
            for (x, r) in self.assembly.position.iter_mut().zip(&self.radius) {
                let (depth, inward) = surface.nearest(x);
                if let Some(inward) = inward.filter(|_| depth < 0.0) {
                    *x += inward * (r - depth);
                }
            }
        }
        let factor = self.scale * (1.0 + enlarged);
        self.assembly.set_radii(self.radius.iter().map(|r| r * factor).collect());
        self.assembly.accepted = USED * enlarged / (1.0 + enlarged);
        self.assembly.relax(JAMMED, steps)
    }

    /// Whether no sphere touches another one or a wall as large as it is meant to be.
    fn is_free(&self) -> bool {
        let Assembly { domain, position, period, .. } = &self.assembly;
        let radius: Vec<f64> = self.radius.iter().map(|r| r * self.scale).collect();
        let near = Neighbours::find(position, &radius, 1.0, 0.0, *period);
        (0..position.len()).all(|i| near.of(i).is_empty() && domain.depth(&position[i]) >= radius[i])
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;
    use crate::neighbours::Grid;
    use crate::surface::tests::cube;
    use crate::{ClosedSurface, Grading};

    const WALLS: [bool; 3] = [false; 3];

    fn radii(grading: &Grading, share: f64, domain: &Domain) -> Vec<f64> {
        let count = (share * domain.volume() / grading.mean_volume()).round() as usize;
        grading.draw(count, 5).iter().map(|d| 0.5 * d).collect()
    }

    fn one(across: f64) -> Grading {
        Grading::uniform(1.0 / across, 1.0 / across)
    }

    /// Share of the points of the inner half of a shape, by volume, that lie in spheres.
    fn inner(domain: &Domain, centres: &[Vec3], radii: &[f64]) -> f64 {
        let (lower, upper) = domain.bounds();
        let (middle, half) = (0.5 * (lower + upper), 0.5 * (upper - lower) * 0.5f64.cbrt());
        let largest = radii.iter().copied().fold(0.0, f64::max);
        let grid = Grid::new(centres, 2.0 * largest);
        let side = 60;
        let (mut points, mut covered) = (0.0, 0.0);
        for n in 0..side * side * side {
            let part = Vec3::new((n % side) as f64, (n / side % side) as f64, (n / side / side) as f64);
            let offset = ((part.add_scalar(0.5)) * (2.0 / side as f64)).add_scalar(-1.0).component_mul(&half);
            if domain.depth(&(middle + offset / 0.5f64.cbrt())) < 0.0 {
                continue;
            }
            points += 1.0;
            let mut inside = false;
            grid.around(&(middle + offset), largest, |i| {
                inside |= (centres[i as usize] - middle - offset).norm() < radii[i as usize];
            });
            covered += f64::from(u8::from(inside));
        }
        covered / points
    }

    /// Largest overlap of two spheres, or of one with a wall, over the smaller radius.
    fn overlap(domain: &Domain, repeats: [bool; 3], centres: &[Vec3], radii: &[f64]) -> f64 {
        let (lower, upper) = domain.bounds();
        let size = upper - lower;
        let mut worst = f64::NEG_INFINITY;
        for i in 0..centres.len() {
            let boxed = |a: usize| {
                if repeats[a] { f64::INFINITY } else { (centres[i][a] - lower[a]).min(upper[a] - centres[i][a]) }
            };
            let depth = match domain {
                Domain::Box { .. } => boxed(0).min(boxed(1)).min(boxed(2)),
                _ => domain.depth(&centres[i]),
            };
            worst = worst.max(1.0 - depth / radii[i]);
            for j in 0..i {
                let mut apart = centres[i] - centres[j];
                for axis in (0..3).filter(|&axis| repeats[axis]) {
                    apart[axis] -= size[axis] * (apart[axis] / size[axis]).round();
                }
                worst = worst.max((radii[i] + radii[j] - apart.norm()) / radii[i].min(radii[j]));
            }
        }
        worst
    }

    /// Solid fraction, that of the inner half, largest overlap, and time [s].
    fn filled(domain: &Domain, repeats: [bool; 3], radii: &[f64], seed: u64) -> Result<[f64; 4], PackError> {
        let clock = Instant::now();
        let centres = dense(domain, repeats, radii, seed)?;
        let time = clock.elapsed().as_secs_f64();
        let fraction = radii.iter().copied().map(sphere_volume).sum::<f64>() / domain.volume();
        Ok([fraction, inner(domain, &centres, radii), overlap(domain, repeats, &centres, radii), time])
    }

    #[test]
    fn no_two_touch_in_any_shape_of_any_sizes() {
        let (points, triangles) = cube(1.0);
        let (lower, upper) = (Vec3::new(-0.5, 1.0, 3.0), Vec3::new(0.5, 2.2, 3.9));
        let shapes = [
            ("box", Domain::cuboid(1.0, 1.2, 0.9), WALLS),
            ("cylinder", Domain::cylinder(1.2, 0.5), WALLS),
            ("sphere", Domain::sphere(0.6), WALLS),
            ("surface", Domain::Surface(ClosedSurface::new(&points, &triangles).unwrap()), WALLS),
            ("periodic", Domain::Box { lower, upper }, [true; 3]),
            ("periodic x, y", Domain::Box { lower, upper }, [true, true, false]),
        ];
        let curve = Grading::sieves(vec![[0.04, 0.0], [0.06, 0.3], [0.12, 0.7], [0.2, 1.0]]);
        let sizes = [
            ("one", one(12.0), [0.55, 0.6], 3),
            ("1 to 3", Grading::uniform(0.05, 0.15), [0.55, 0.61], 2),
            ("curve 1 to 5", curve, [0.57, 0.63], 1),
        ];
        println!("| shape | sizes | particles | fraction | inner half | overlap | s |");
        for (shape, domain, repeats) in &shapes {
            for (name, grading, [walled, free], seeds) in &sizes {
                let free_of_walls = *repeats == [true; 3];
                let asked = if free_of_walls { *free } else { *walled };
                let radii = radii(grading, asked, domain);
                for seed in 1..=*seeds {
                    let [fraction, inner, overlap, time] = filled(domain, *repeats, &radii, seed).unwrap();
                    let count = radii.len();
                    println!("| {shape} | {name} | {count} | {fraction:.4} | {inner:.4} | {overlap:.0e} | {time:.2} |");
                    assert!(overlap < 0.0, "{shape} {name} {seed}: {overlap}");
                    let largest = sphere_volume(radii[0]) / domain.volume();
                    assert!((fraction - asked).abs() < largest, "{shape} {name}: {fraction}");
                    let most = if free_of_walls { 0.02 } else { 0.1 };
                    assert!((inner / fraction - 1.0).abs() < most, "{shape} {name} {seed}: {inner} of {fraction}");
                }
            }
        }
    }

    #[test]
    fn discs_fill_a_plane_without_touching() {
        println!("| shape | sizes | discs | fraction | s |");
        for (shape, domain, area) in [
            ("square", Domain::cuboid(1.0, 1.0, 1.0), 1.0),
            ("circle", Domain::sphere(0.5), 0.25 * std::f64::consts::PI),
        ] {
            for (sizes, grading, asked) in [
                ("1 to 1.4", Grading::uniform_discs(0.03, 0.042), 0.8),
                ("1 to 3", Grading::uniform_discs(0.02, 0.06), 0.8),
                ("one", Grading::uniform_discs(0.04, 0.04), 0.78),
            ] {
                let count = (asked * area / grading.mean_volume()).floor() as usize;
                let radii: Vec<f64> = grading.draw(count, 3).iter().map(|d| 0.5 * d).collect();
                for seed in 1..=3 {
                    let clock = Instant::now();
                    let centres = dense_discs(&domain, area, &radii, seed).unwrap();
                    let fraction = radii.iter().map(|r| std::f64::consts::PI * r * r).sum::<f64>() / area;
                    println!("| {shape} | {sizes} | {count} | {fraction:.3} | {:.2} |", clock.elapsed().as_secs_f64());
                    let middle = 0.5 * (domain.bounds().0 + domain.bounds().1);
                    for i in 0..count {
                        assert_eq!(centres[i].z, middle.z);
                        let in_box = centres[i].xy().min().min((Vec3::repeat(1.0) - centres[i]).xy().min());
                        let depth = if shape == "circle" { domain.depth(&centres[i]) } else { in_box };
                        assert!(depth >= radii[i], "{shape} {sizes} {seed}");
                        for j in 0..i {
                            assert!((centres[i] - centres[j]).norm() > radii[i] + radii[j], "{shape} {sizes} {seed}");
                        }
                    }
                }
                let more: Vec<f64> = grading.draw((0.9 * area / grading.mean_volume()) as usize, 3);
                let more: Vec<f64> = more.iter().map(|d| 0.5 * d).collect();
                let Err(PackError::Dense { reached, .. }) = dense_discs(&domain, area, &more, 1) else { panic!() };
                println!("| {shape} | {sizes} | {} | at most {reached:.3} | |", more.len());
                assert!(reached > 0.79 && reached < 0.88, "{shape} {sizes}: {reached}");
            }
        }
    }

    #[test]
    fn a_seed_gives_the_same_bits_for_any_number_of_threads() {
        let domain = Domain::cuboid(1.0, 1.0, 1.0);
        let radii = radii(&Grading::uniform(0.05, 0.1), 0.57, &domain);
        let run = |threads, seed| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| dense(&domain, [true; 3], &radii, seed).unwrap())
        };
        let first = run(1, 1);
        assert_eq!(first, run(2, 1));
        assert_eq!(first, run(7, 1));
        assert_ne!(first, run(7, 2));
    }

    #[test]
    fn the_largest_fraction_is_told_and_walls_lower_it() {
        let [free, narrow, walled] = [([true; 3], 8.0), (WALLS, 5.0), (WALLS, 10.0)]
            .map(|(repeats, across)| largest("one", &one(across), (repeats, 0.68), 1));
        // Random close packing of one size is 0.64.
        assert!((0.615..0.65).contains(&free) && narrow < walled && walled < free, "{free} {narrow} {walled}");
        // What is told can be had.
        let domain = Domain::cuboid(1.0, 1.0, 1.0);
        let fewer = radii(&one(10.0), 0.985 * walled, &domain);
        assert!(filled(&domain, WALLS, &fewer, 3).unwrap()[2] < 0.0);
    }

    /// Mean over seeds of the largest fraction in a cube of side 1 m, which a message tells as more is asked for.
    fn largest(sizes: &str, grading: &Grading, (repeats, asked): ([bool; 3], f64), seeds: u64) -> f64 {
        let domain = Domain::cuboid(1.0, 1.0, 1.0);
        let radii = radii(grading, asked, &domain);
        let all = (1..=seeds).map(|seed| match dense(&domain, repeats, &radii, seed) {
            Err(PackError::Dense { reached, .. }) => reached,
            other => panic!("{other:?}"),
        });
        let (all, space) = (all.collect::<Vec<f64>>(), if repeats == WALLS { "box" } else { "periodic" });
        println!("| {space} | {sizes} | {:.0} | {all:.3?} |", 0.5 / radii[0]);
        all.iter().sum::<f64>() / all.len() as f64
    }

    #[test]
    #[ignore = "a minute: .ci/nightly heavy"]
    fn the_largest_fraction_grows_with_the_range_of_sizes() {
        println!("| space | sizes | diameters across | largest fraction |");
        let free = [8.0, 16.0].map(|across| largest("one", &one(across), ([true; 3], 0.68), 3));
        let walled =
            [(5.0, 3), (10.0, 3), (20.0, 1)].map(|(across, seeds)| largest("one", &one(across), (WALLS, 0.68), seeds));
        let three = largest("1 to 3", &Grading::uniform(0.05, 0.15), ([true; 3], 0.72), 2);
        let curve = Grading::sieves(vec![[0.04, 0.0], [0.06, 0.3], [0.12, 0.7], [0.2, 1.0]]);
        let five = largest("curve 1 to 5", &curve, ([true; 3], 0.76), 1);
        assert!(free[1] < three && three < five, "{free:?} {three} {five}");
        // Random close packing of one size is 0.64.
        assert!(free.iter().all(|own| (0.615..0.65).contains(own)), "{free:?}");
        assert!(walled[0] < walled[1] && walled[1] < walled[2] && walled[2] < free[1], "{walled:?}");
    }

    #[test]
    fn what_cannot_be_is_told() {
        let domain = Domain::cuboid(1.0, 1.0, 1.0);
        assert_eq!(dense(&domain, WALLS, &[0.55], 1), Err(PackError::NoRoom { radius: 0.55 }));
        assert!(matches!(dense(&domain, WALLS, &[0.1; 300], 1), Err(PackError::TooDense(share)) if share > 1.2));
        assert!(matches!(dense(&Domain::cuboid(1.0, 1.0, 0.0), WALLS, &[0.1], 1), Err(PackError::BadDimension { .. })));
    }
}
