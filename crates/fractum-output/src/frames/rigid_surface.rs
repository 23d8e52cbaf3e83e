//! Surfaces of rigid bodies as triangles, to look at.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use fractum_math::Vec3;
use fractum_math::elementary::{cos, sin};
use fractum_scene::{Form, Frame, RigidBody, Scene, Shape};
use fractum_vtk::{Compression, Field, PendingFile, PolyCells, PolyData};

use crate::OutputError;
use crate::frames::triangles::{Triangles, corners, extent};

/// Triangles around a cylinder or sphere.
const AROUND: u32 = 32;
/// Side of a plane over the size of what the scene holds besides.
const PLANE: f64 = 2.0;
/// Size of a rigid body over that of what it may act on above which pictures leave it out.
const LARGEST_DRAWN: f64 = 2.0;

/// The rigid bodies of a scene, as they lie at its start.
#[derive(Clone, Debug, Default)]
pub(crate) struct RigidSurfaces {
    /// Points in the axes of each body, and where they are at the start.
    bodies: Vec<Vec<(Vec3, Vec3)>>,
    /// Points of triangles, counted over all bodies.
    triangles: Vec<[u32; 3]>,
    /// Body of each triangle.
    body: Vec<i32>,
    /// Whether pictures show the body of each triangle.
    drawn: Vec<u8>,
}

impl RigidSurfaces {
    /// Those of a scene at its start.
    pub(crate) fn new(scene: &Scene) -> Self {
        let mut surfaces = RigidSurfaces::default();
        let mut before = 0;
        let size = extent(deformable(scene)).norm();
        for (index, body) in (0..).zip(scene.contacts.rigid_bodies()) {
            let (points, triangles) = surface_of(body, scene);
            surfaces.triangles.extend(triangles.iter().map(|nodes| nodes.map(|node| node + before)));
            surfaces.body.extend(triangles.iter().map(|_| index));
            surfaces.drawn.extend(triangles.iter().map(|_| u8::from(is_drawn(body, &points, size))));
            before += points.len() as u32;
            surfaces.bodies.push(points.into_iter().map(|x| (x, in_space(&body.frame, &x))).collect());
        }
        surfaces
    }

    /// Whether there is no rigid body.
    pub(crate) fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// The surfaces at the present instant: where they were at the start, and how far they have moved.
    pub(crate) fn file(&self, scene: &Scene) -> Result<PendingFile, OutputError> {
        let (mut points, mut displacement): (Vec<[f64; 3]>, Vec<[f64; 3]>) = Default::default();
        for (body, own) in scene.contacts.rigid_bodies().iter().zip(&self.bodies) {
            for (x, start) in own {
                points.push((*start).into());
                displacement.push((in_space(&body.frame, x) - start).into());
            }
        }
        let data = PolyData {
            points: &points,
            cells: PolyCells::Triangles(&self.triangles),
            point_data: &[Field::vector("displacement", &displacement)],
            cell_data: &[Field::integer("body", &self.body), Field::flag("drawn", &self.drawn)],
            time: Some(scene.clock.time),
        };
        data.pending(Compression::Fast).map_err(OutputError::from)
    }
}

/// The surfaces that pictures show, where they are now.
pub fn drawn_surfaces(scene: &Scene) -> Triangles {
    let size = extent(deformable(scene)).norm();
    let mut all = Triangles::default();
    for body in scene.contacts.rigid_bodies() {
        let (points, triangles) = surface_of(body, scene);
        if is_drawn(body, &points, size) {
            let before = all.points.len() as u32;
            all.triangles.extend(triangles.iter().map(|nodes| nodes.map(|node| node + before)));
            all.points.extend(points.iter().map(|x| <[f64; 3]>::from(in_space(&body.frame, x))));
        }
    }
    all
}

/// Whether pictures show a rigid body: containers would hide their content, planes have no end, and beside what is much larger
/// the rest would be small.
///
/// - `points`: of its surface, in its own axes
/// - `size`: of what is not rigid [m]
fn is_drawn(body: &RigidBody, points: &[Vec3], size: f64) -> bool {
    let is_closed = match &body.form {
        Form::Shape { shape, hollow } => !hollow && *shape != Shape::HalfSpace,
        Form::Mesh { .. } => true,
    };
    is_closed && extent(points.iter()).norm() < LARGEST_DRAWN * size
}

/// Nodes and particles where they were at the start.
fn deformable(scene: &Scene) -> impl Iterator<Item = &Vec3> {
    scene.solid.reference.iter().chain(scene.bonded.reference())
}

fn in_space(frame: &Frame, x: &Vec3) -> Vec3 {
    frame.origin + frame.to_space(x)
}

/// Points in the axes of a body, and triangles.
fn surface_of(body: &RigidBody, scene: &Scene) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    match &body.form {
        Form::Mesh { mesh, points } => {
            let facets = (0..mesh.len() as u32).map(|facet| mesh.corners(facet));
            (points.clone(), facets.flat_map(fan).collect())
        }
        Form::Shape { shape, .. } => match *shape {
            Shape::HalfSpace => plane(&body.frame, scene),
            Shape::Cuboid { half } => {
                let points = (0..8).map(|corner| {
                    Vec3::from_fn(|axis, _| if corner >> axis & 1 == 1 { half[axis] } else { -half[axis] })
                });
                let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
                (points.collect(), sides.iter().flat_map(|side| fan(side)).collect())
            }
            Shape::Cylinder { radius, half_length } => {
                turned(&[(0.0, -half_length), (radius, -half_length), (radius, half_length), (0.0, half_length)])
            }
            Shape::Tube { radius, half_length } => turned(&[(radius, -half_length), (radius, half_length)]),
            Shape::Ball { radius } => {
                let rings = AROUND / 2;
                let of_ring = |ring: u32| {
                    if ring == 0 || ring == rings {
                        return (0.0, if ring == 0 { -radius } else { radius });
                    }
                    let latitude = PI * f64::from(ring) / f64::from(rings) - FRAC_PI_2;
                    (radius * cos(latitude), radius * sin(latitude))
                };
                turned(&(0..=rings).map(of_ring).collect::<Vec<_>>())
            }
        },
    }
}

/// A polygon as triangles around its first corner.
fn fan(corners: &[u32]) -> Vec<[u32; 3]> {
    corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]]).collect()
}

/// A profile of radii and heights, from below to above, turned about z.
fn turned(profile: &[(f64, f64)]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let angle = |i: u32| TAU * f64::from(i) / f64::from(AROUND);
    let ring = |&(radius, z): &(f64, f64)| {
        (0..AROUND).map(move |i| Vec3::new(radius * cos(angle(i)), radius * sin(angle(i)), z))
    };
    let points = profile.iter().flat_map(ring).collect();
    let mut triangles = Vec::new();
    for (below, pair) in (0..).map(|ring| ring * AROUND).zip(profile.windows(2)) {
        for (i, next) in (0..AROUND).map(|i| (below + i, below + (i + 1) % AROUND)) {
            // A ring of no radius is a point: one of two triangles is left.
            if pair[0].0 > 0.0 {
                triangles.push([i, next, next + AROUND]);
            }
            if pair[1].0 > 0.0 {
                triangles.push([i, next + AROUND, i + AROUND]);
            }
        }
    }
    (points, triangles)
}

/// A square of the plane, below the middle of everything else.
fn plane(frame: &Frame, scene: &Scene) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    if deformable(scene).next().is_none() {
        return (Vec::new(), Vec::new());
    }
    let [low, high] = corners(deformable(scene));
    let half = 0.5 * PLANE * (high - low).norm();
    let middle = frame.to_body(&(0.5 * (low + high)));
    let corner = |x: f64, y: f64| Vec3::new(middle.x + x * half, middle.y + y * half, 0.0);
    let points = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    (points, fan(&[0, 1, 2, 3]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Area and volume by the triangles, outward.
    fn measures((points, triangles): &(Vec<Vec3>, Vec<[u32; 3]>)) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for nodes in triangles {
            let [a, b, c] = nodes.map(|node| points[node as usize]);
            let normal = (b - a).cross(&(c - a)) * 0.5;
            sums[0] += normal.norm();
            sums[1] += normal.dot(&a) / 3.0;
        }
        sums
    }

    #[test]
    fn turned_profiles_have_the_area_and_volume_of_their_shapes() {
        // A regular polygon of 32 sides has 0.9936 of the area of its circle.
        let cylinder = turned(&[(0.0, -2.0), (1.0, -2.0), (1.0, 2.0), (0.0, 2.0)]);
        let [area, volume] = measures(&cylinder);
        assert!((volume / (4.0 * PI) - 0.9936).abs() < 1e-4, "{volume}");
        assert!((area / (10.0 * PI) - 1.0).abs() < 0.01, "{area}");
        let ball: Vec<(f64, f64)> = (0..=16)
            .map(|ring| PI * f64::from(ring) / 16.0 - FRAC_PI_2)
            .map(|latitude| (3.0 * latitude.cos().max(0.0), 3.0 * latitude.sin()))
            .collect();
        let [area, volume] = measures(&turned(&ball));
        assert!((volume / (36.0 * PI) - 1.0).abs() < 0.03 && volume < 36.0 * PI, "{volume}");
        assert!((area / (36.0 * PI) - 1.0).abs() < 0.02 && area < 36.0 * PI, "{area}");
    }
}
