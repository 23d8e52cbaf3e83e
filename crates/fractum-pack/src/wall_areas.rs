//! The part of a wall that each of its particles shows outside.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use fractum_math::Vec3;
use fractum_math::elementary::{cos, sin};

use crate::domain::Domain;

/// Patches of a wall for each of its particles.
const PATCHES: f64 = 100.0;

impl Domain {
    /// Area vector of the part of a wall that is nearest to each of some particles [m²], out of the domain, and its moment about the
    /// origin, ∫ x × n dA [m³]: the wall is cut into small patches, each of which belongs to the particle of the smallest power
    /// |x − c|² − R². Their sum is that of the wall, so that the sums over all walls vanish to rounding.
    ///
    /// - `wall`: index into [`Domain::wall_names`]; `set`: its particles
    pub fn wall_areas(&self, wall: usize, set: &[u32], position: &[Vec3], radius: &[f64]) -> Vec<[Vec3; 2]> {
        let mut areas = vec![[Vec3::zeros(); 2]; set.len()];
        if set.is_empty() {
            return areas;
        }
        let mut whole = 0.0;
        self.visit_patches(wall, f64::INFINITY, &mut |_, area| whole += area.norm());
        let share = (whole / set.len() as f64).sqrt();
        let spheres: Vec<(Vec3, f64)> = set.iter().map(|&i| (position[i as usize], radius[i as usize])).collect();
        let nearest = Nearest::new(&spheres, 2.0 * share);
        self.visit_patches(wall, share / PATCHES.sqrt(), &mut |place, area| {
            let [sum, moment] = &mut areas[nearest.at(&place)];
            *sum += area;
            *moment += place.cross(&area);
        });
        areas
    }

    /// Visits patches of a wall, no wider than a length, with their middles and area vectors [m²].
    fn visit_patches(&self, wall: usize, width: f64, visit: &mut dyn FnMut(Vec3, Vec3)) {
        let parts = |length: f64| (length / width).ceil().max(1.0) as usize;
        match self {
            Domain::Periodic { .. } => {}
            Domain::Box { lower, upper } => {
                let (axis, size) = (wall / 2, upper - lower);
                let (sign, level) = if wall.is_multiple_of(2) { (-1.0, lower[axis]) } else { (1.0, upper[axis]) };
                let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
                let [nu, nv] = [u, v].map(|axis| parts(size[axis]));
                let mut area = Vec3::zeros();
                area[axis] = sign * size[u] * size[v] / (nu * nv) as f64;
                for k in 0..nu * nv {
                    let mut place = Vec3::zeros();
                    place[axis] = level;
                    place[u] = lower[u] + size[u] * ((k % nu) as f64 + 0.5) / nu as f64;
                    place[v] = lower[v] + size[v] * ((k / nu) as f64 + 0.5) / nv as f64;
                    visit(place, area);
                }
            }
            Domain::Cylinder { start, length, radius } if wall == 2 => {
                let (along, around) = (parts(*length), parts(2.0 * PI * radius).max(8));
                let angle = 2.0 * PI / around as f64;
                // The normal over the patch adds up to that of its chord.
                let size = 2.0 * radius * sin(0.5 * angle) * length / along as f64;
                for k in 0..along * around {
                    let turn = angle * ((k % around) as f64 + 0.5);
                    let normal = Vec3::new(0.0, cos(turn), sin(turn));
                    let x = length * ((k / around) as f64 + 0.5) / along as f64;
                    visit(start + Vec3::new(x, 0.0, 0.0) + normal * *radius, normal * size);
                }
            }
            Domain::Cylinder { start, length, radius } => {
                let (sign, x) = if wall == 0 { (-1.0, 0.0) } else { (1.0, *length) };
                let rings = parts(*radius);
                let wide = radius / rings as f64;
                for ring in 0..rings {
                    let [inner, outer] = [ring, ring + 1].map(|k| k as f64 * wide);
                    let (middle, around) = (0.5 * (inner + outer), 6 * (2 * ring + 1));
                    let size = PI * (outer * outer - inner * inner) / around as f64;
                    for k in 0..around {
                        let turn = 2.0 * PI * (k as f64 + 0.5) / around as f64;
                        let across = Vec3::new(x, middle * cos(turn), middle * sin(turn));
                        visit(start + across, Vec3::x() * (sign * size));
                    }
                }
            }
            Domain::Sphere { centre, radius } => {
                let bands = parts(PI * radius).max(8);
                let at = |band: usize| cos(PI * band as f64 / bands as f64);
                for band in 0..bands {
                    let (high, low) = (at(band), at(band + 1));
                    let height = 0.5 * (high + low);
                    let wide = (1.0 - height * height).max(0.0).sqrt();
                    let around = parts(2.0 * PI * radius * wide).max(8);
                    let size = 2.0 * PI * radius * radius * (high - low) / around as f64;
                    for k in 0..around {
                        let turn = 2.0 * PI * (k as f64 + 0.5) / around as f64;
                        let normal = Vec3::new(wide * cos(turn), wide * sin(turn), height);
                        visit(centre + normal * *radius, normal * size);
                    }
                }
            }
            Domain::Surface(surface) => surface.visit_triangles(|[a, b, c]| {
                let edges = [b - a, c - a];
                let longest = edges[0].norm().max(edges[1].norm()).max((c - b).norm());
                let cuts = if width.is_finite() { parts(longest) } else { 1 };
                let size = edges[0].cross(&edges[1]) * (0.5 / (cuts * cuts) as f64);
                for i in 0..cuts {
                    for j in 0..cuts - i {
                        let at = |s: f64, t: f64| a + (edges[0] * s + edges[1] * t) / cuts as f64;
                        let (i, j) = (i as f64, j as f64);
                        visit(at(i + 1.0 / 3.0, j + 1.0 / 3.0), size);
                        if (i + j) as usize + 1 < cuts {
                            visit(at(i + 2.0 / 3.0, j + 2.0 / 3.0), size);
                        }
                    }
                }
            }),
        }
    }
}

/// Spheres by cells, of which the one with the smallest power at a place is sought.
struct Nearest<'a> {
    spheres: &'a [(Vec3, f64)],
    cell: f64,
    largest: f64,
    cells: BTreeMap<[i64; 3], Vec<usize>>,
    /// Cells beyond which there is nothing.
    farthest: i64,
}

impl<'a> Nearest<'a> {
    fn new(spheres: &'a [(Vec3, f64)], cell: f64) -> Self {
        let mut cells: BTreeMap<[i64; 3], Vec<usize>> = BTreeMap::new();
        for (index, (place, _)) in spheres.iter().enumerate() {
            cells.entry(cell_of(place, cell)).or_default().push(index);
        }
        let extent = |of: fn(&i64, &i64) -> bool| {
            cells.keys().flatten().copied().reduce(|a, b| if of(&a, &b) { a } else { b }).unwrap_or(0)
        };
        let farthest = extent(|a, b| a > b) - extent(|a, b| a < b) + 2;
        let largest = spheres.iter().map(|(_, radius)| *radius).fold(0.0, f64::max);
        Nearest { spheres, cell, largest, cells, farthest }
    }

    fn at(&self, place: &Vec3) -> usize {
        let home = cell_of(place, self.cell);
        let (mut best, mut found) = (f64::INFINITY, 0);
        for ring in 0..=self.farthest {
            // Whatever is in this ring is at least so far away.
            let away = (ring - 1).max(0) as f64 * self.cell;
            if away * away - self.largest * self.largest > best {
                break;
            }
            for_ring(ring, |step| {
                let cell = [home[0] + step[0], home[1] + step[1], home[2] + step[2]];
                for &index in self.cells.get(&cell).into_iter().flatten() {
                    let (centre, radius) = &self.spheres[index];
                    let power = (place - centre).norm_squared() - radius * radius;
                    if power < best || (power == best && index < found) {
                        (best, found) = (power, index);
                    }
                }
            });
        }
        found
    }
}

fn cell_of(place: &Vec3, cell: f64) -> [i64; 3] {
    [place.x, place.y, place.z].map(|x| (x / cell).floor() as i64)
}

/// Visits the cells of the cube's shell that is so many cells from its middle.
fn for_ring(ring: i64, mut visit: impl FnMut([i64; 3])) {
    for x in -ring..=ring {
        for y in -ring..=ring {
            let whole = x.abs() == ring || y.abs() == ring;
            for z in (-ring..=ring).step_by(if whole || ring == 0 { 1 } else { 2 * ring as usize }) {
                visit([x, y, z]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::ClosedSurface;
    use crate::{PackSpec, pack};

    /// Area vector and moment of each wall, the area of all, and how far an area vector points to the middle.
    fn sums(domain: Domain, seed: u64) -> (Vec<[Vec3; 2]>, f64, f64) {
        let packing = pack(&PackSpec::new(domain, 400, seed)).unwrap();
        let mut walls = Vec::new();
        let mut inward = f64::NEG_INFINITY;
        for (wall, (_, set)) in packing.walls.iter().enumerate() {
            let areas = packing.domain.wall_areas(wall, set, &packing.position, &packing.radius);
            let centre = packing.position.iter().sum::<Vec3>() / packing.len() as f64;
            // A particle behind others shows nothing.
            let shown = set.iter().zip(&areas).filter(|(_, [area, _])| area.norm() > 0.0);
            for (&i, [area, _]) in shown {
                inward = inward.max(-(packing.position[i as usize] - centre).dot(area) / area.norm());
            }
            walls.push([0, 1].map(|k| areas.iter().map(|own| own[k]).sum::<Vec3>()));
        }
        (walls, packing.domain.area(), inward)
    }

    #[test]
    fn areas_of_closed_surfaces_add_up_to_nothing() {
        let triangles = {
            let (points, triangles) = crate::surface::tests::cube(1.0);
            Domain::Surface(ClosedSurface::new(&points, &triangles).unwrap())
        };
        let domains = [Domain::cuboid(1.0, 0.8, 0.9), Domain::cylinder(1.2, 0.5), Domain::sphere(0.7), triangles];
        for (seed, domain) in (3..).zip(domains) {
            let (walls, whole, inward) = sums(domain.clone(), seed);
            for k in [0, 1] {
                let sum: Vec3 = walls.iter().map(|wall| wall[k]).sum();
                assert!(sum.norm() < 1e-11 * whole, "{domain:?} {walls:?}");
            }
            assert!(inward < 0.0, "{domain:?}: a particle is pushed out");
        }
    }

    #[test]
    fn a_flat_wall_has_its_area() {
        let (walls, ..) = sums(Domain::cuboid(1.0, 0.8, 0.9), 5);
        let expected = [0.72, 0.72, 0.9, 0.9, 0.8, 0.8];
        for (wall, ([sum, _], expected)) in walls.iter().zip(expected).enumerate() {
            let sign = if wall % 2 == 0 { -1.0 } else { 1.0 };
            assert!((sum[wall / 2] - sign * expected).abs() < 1e-12, "{sum}");
        }
        let (walls, ..) = sums(Domain::cylinder(1.2, 0.5), 5);
        assert!((walls[1][0].x - PI * 0.25).abs() < 1e-12 && walls[2][0].norm() < 1e-12);
    }
}
