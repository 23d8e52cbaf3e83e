//! Dirichlet cells of spheres, and the space cells between their centres.

use fractum_contact::close_pairs;
use fractum_math::{Ragged, Vec3};
use rayon::prelude::*;

/// Half the edge of the cube that bounds a cell, and width of the gap up to which spheres shape it, over the largest radius. A hole
/// wider than this in the set leaves the cells around it open.
const REACH: f64 = 3.0;

/// By how much the powers of spheres are shifted, over the squares of their radii: regular arrangements then have one tessellation.
const SHIFT: f64 = 1e-7;

/// Sides of the cube; planes of neighbours come after them.
const SIDES: usize = 6;

/// Faces between the Dirichlet cells of spheres, and the tetrahedra of the centres whose cells meet in a point: the generalised
/// Dirichlet and Delaunay tessellations by the distance |x − xᵢ|² − rᵢ².
#[derive(Default)]
pub(crate) struct Tessellation {
    /// Spheres of each face between two cells that is closed, and its area vector from the first to the second [m²].
    pub(crate) faces: Vec<([u32; 2], Vec3)>,
    /// Centres of each space cell.
    pub(crate) tetrahedra: Vec<[u32; 4]>,
}

impl Tessellation {
    /// - `centre` [m], `radius` [m] > 0
    /// - `salt`: chooses one of the tessellations of an arrangement that has several
    pub(crate) fn new(centre: &[Vec3], radius: &[f64], salt: u32) -> Self {
        let reach = REACH * radius.iter().fold(0.0, |most: f64, r| most.max(*r));
        let pairs = close_pairs(centre, radius, reach);
        let near = Ragged::inverse(centre.len(), pairs.iter().map(|pair| pair.as_slice()));
        let power = |i: u32| {
            // A hash: a shift linear in the number would leave rows of spheres as they are.
            let mixed =
                (i ^ i >> 15).wrapping_add(1).wrapping_add(salt.wrapping_mul(0x9e37_79b9)).wrapping_mul(0x2c1b_3c6d);
            let mixed = (mixed ^ mixed >> 12).wrapping_mul(0x297a_2d39);
            let scatter = f64::from(mixed ^ mixed >> 15) / f64::from(u32::MAX);
            radius[i as usize].powi(2) * (1.0 + SHIFT * scatter)
        };
        let parts: Vec<Tessellation> = (0..centre.len() as u32)
            .into_par_iter()
            .map(|own| {
                let mut others: Vec<u32> =
                    near.row(own as usize).iter().map(|&pair| other(pairs[pair as usize], own)).collect();
                let distance = |i: &u32| (centre[*i as usize] - centre[own as usize]).norm_squared();
                others.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
                let mut cell = Cell::cube(reach);
                for &i in &others {
                    let way = centre[i as usize] - centre[own as usize];
                    cell.cut(Plane { normal: way, offset: 0.5 * (way.norm_squared() + power(own) - power(i)) });
                }
                cell.parts(own, &others)
            })
            .collect();
        let mut all = Tessellation::default();
        for mut part in parts {
            all.faces.append(&mut part.faces);
            all.tetrahedra.append(&mut part.tetrahedra);
        }
        all
    }
}

/// Volume of a tetrahedron times the gradients of its four shape functions [m²], and the volume [m³].
pub(crate) fn corner_areas([a, b, c, d]: [Vec3; 4]) -> ([Vec3; 4], f64) {
    let [x, y, z] = [b - a, c - a, d - a];
    let sixth = x.dot(&y.cross(&z)) / 6.0;
    // With the sign of the order of the corners.
    let own = [y.cross(&z), z.cross(&x), x.cross(&y)].map(|area| area * (sixth.signum() / 6.0));
    ([-(own[0] + own[1] + own[2]), own[0], own[1], own[2]], sixth.abs())
}

fn other([first, second]: [u32; 2], own: u32) -> u32 {
    if first == own { second } else { first }
}

/// Points x with normal · x ≤ offset, from the centre of the own sphere.
#[derive(Clone, Copy)]
struct Plane {
    normal: Vec3,
    offset: f64,
}

/// A convex cell by its corners, in each of which three planes meet, numbered counterclockwise from outside.
struct Cell {
    planes: Vec<Plane>,
    corners: Vec<([usize; 3], Vec3)>,
}

impl Cell {
    fn cube(half: f64) -> Self {
        let side = |k: usize| {
            let mut normal = Vec3::zeros();
            normal[k / 2] = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
            Plane { normal, offset: half }
        };
        let mut cube = Cell { planes: (0..SIDES).map(side).collect(), corners: Vec::new() };
        for corner in 0..8usize {
            let [x, y, z] = [corner & 1, 2 + (corner >> 1 & 1), 4 + (corner >> 2)];
            let odd = (corner & 1) + (corner >> 1 & 1) + (corner >> 2);
            cube.add_corner(if odd.is_multiple_of(2) { [x, y, z] } else { [y, x, z] });
        }
        cube
    }

    fn add_corner(&mut self, planes: [usize; 3]) {
        let [a, b, c] = planes.map(|k| self.planes[k]);
        let across = b.normal.cross(&c.normal);
        let sum = across * a.offset + c.normal.cross(&a.normal) * b.offset + a.normal.cross(&b.normal) * c.offset;
        self.corners.push((planes, sum / a.normal.dot(&across)));
    }

    /// Takes away what lies beyond a plane.
    fn cut(&mut self, plane: Plane) {
        let number = self.planes.len();
        self.planes.push(plane);
        let beyond = |place: &Vec3| plane.normal.dot(place) > plane.offset;
        let mut edges = Vec::new();
        self.corners.retain(|([a, b, c], place)| {
            let gone = beyond(place);
            if gone {
                edges.extend([[*a, *b], [*b, *c], [*c, *a]]);
            }
            !gone
        });
        for &[from, to] in &edges {
            if !edges.contains(&[to, from]) {
                self.add_corner([from, to, number]);
            }
        }
    }

    /// Closed faces towards spheres of a larger number, and tetrahedra of which the own sphere has the smallest.
    fn parts(&self, own: u32, others: &[u32]) -> Tessellation {
        let mut parts = Tessellation::default();
        for (k, &sphere) in others.iter().enumerate().filter(|(_, sphere)| **sphere > own) {
            if let Some(area) = self.face(SIDES + k) {
                parts.faces.push(([own, sphere], area));
            }
        }
        for (planes, _) in self.corners.iter().filter(|(planes, _)| planes.iter().all(|&k| k >= SIDES)) {
            let [a, b, c] = planes.map(|k| others[k - SIDES]);
            if own < a.min(b).min(c) {
                parts.tetrahedra.push([own, a, b, c]);
            }
        }
        parts
    }

    /// Area vector of a face outwards; none where there is no such face, or the cube bounds it.
    fn face(&self, plane: usize) -> Option<Vec3> {
        // Corners with the planes before and after this one.
        let turned = |&([a, b, c], place): &([usize; 3], Vec3)| match plane {
            _ if plane == a => Some((b, c, place)),
            _ if plane == b => Some((c, a, place)),
            _ if plane == c => Some((a, b, place)),
            _ => None,
        };
        let corners: Vec<(usize, usize, Vec3)> = self.corners.iter().filter_map(turned).collect();
        if corners.len() < 3 || corners.iter().any(|&(before, after, _)| before < SIDES || after < SIDES) {
            return None;
        }
        let mut area = Vec3::zeros();
        for (_, after, place) in &corners {
            let (.., next) = corners.iter().find(|(before, ..)| before == after)?;
            area += place.cross(next) * 0.5;
        }
        let outwards = area.dot(&self.planes[plane].normal) > 0.0;
        Some(if outwards { area } else { -area })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_of_a_cubic_arrangement_are_cubes_and_its_space_cells_fill_it() {
        let centre: Vec<Vec3> =
            (0..125).map(|i| Vec3::new((i % 5) as f64, (i / 5 % 5) as f64, (i / 25) as f64) * 2.0).collect();
        let found = Tessellation::new(&centre, &[1.0; 125], 0);
        let volume = |&[a, b, c, d]: &[u32; 4]| {
            let [a, b, c, d] = [a, b, c, d].map(|i| centre[i as usize]);
            ((b - a).cross(&(c - a)).dot(&(d - a)) / 6.0).abs()
        };
        let sum: f64 = found.tetrahedra.iter().map(volume).sum();
        assert!((sum - 512.0).abs() < 1e-9, "{sum}");
        // Of the sphere in the middle: six faces of 4 m², and slivers by the shift.
        let mut large = 0;
        for ([i, j], area) in found.faces.iter().filter(|(pair, _)| pair.contains(&62)) {
            let way = (centre[*j as usize] - centre[*i as usize]).normalize();
            assert!(
                (area - way * area.norm()).norm() < 1e-9 && (area.norm() < 1e-5 || (area.norm() - 4.0).abs() < 1e-5)
            );
            large += usize::from(area.norm() > 1.0);
        }
        assert_eq!(large, 6);
    }
}
