use std::f64::consts::PI;

use fractum_math::{Vec3, sphere_volume};
use serde::{Deserialize, Serialize};

use crate::period::Period;
use crate::surface::SurfaceData;
use crate::{ClosedSurface, PackError};

/// A closed shape to fill with particles.
#[derive(Clone, Debug)]
pub enum Domain {
    /// A box with faces normal to the axes; walls `x-`, `x+`, `y-`, `y+`, `z-`, `z+`.
    Box {
        /// Lower corner [m].
        lower: Vec3,
        /// Upper corner [m].
        upper: Vec3,
    },
    /// A circular cylinder along x; walls `x-`, `x+`, `radius`.
    Cylinder {
        /// Centre of the face `x-` [m].
        start: Vec3,
        /// Length [m].
        length: f64,
        /// Radius [m].
        radius: f64,
    },
    /// A sphere; wall `radius`.
    Sphere {
        /// Centre [m].
        centre: Vec3,
        /// Radius [m].
        radius: f64,
    },
    /// A closed triangulated surface; wall `surface`.
    Surface(ClosedSurface),
    /// A box with faces normal to the axes that repeats along them: no walls.
    Periodic {
        /// Lower corner [m].
        lower: Vec3,
        /// Upper corner [m].
        upper: Vec3,
    },
}

/// A domain's numbers, as stored in files.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum DomainData {
    /// See [`Domain::Box`].
    Box([f64; 3], [f64; 3]),
    /// See [`Domain::Cylinder`].
    Cylinder([f64; 3], f64, f64),
    /// See [`Domain::Sphere`].
    Sphere([f64; 3], f64),
    /// See [`Domain::Surface`].
    Surface(SurfaceData),
    /// See [`Domain::Periodic`].
    Periodic([f64; 3], [f64; 3]),
}

/// A particle pressed against a wall.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WallContact {
    /// Index into [`Domain::wall_names`].
    pub(crate) wall: usize,
    /// Overlap [m], positive when touching.
    pub(crate) overlap: f64,
    /// Unit vector that pushes the particle back.
    pub(crate) inward: Vec3,
}

/// Lengths that a shape may have [m]: beyond them areas and volumes come near the ends of floating point numbers.
const LENGTHS: std::ops::RangeInclusive<f64> = 1e-15..=1e15;
/// Largest distance from the origin over the smallest extent: overlaps of 1e-7 radii must be seen.
const FARTHEST: f64 = 1e6;

/// Directions closer than this count as one wall of a triangulated surface (cosine of about 25°): neighbouring facets
/// of a curved surface must not push twice.
const SAME_WALL_COSINE: f64 = 0.9;

impl Domain {
    /// A box from the origin with the given edges [m].
    pub fn cuboid(x: f64, y: f64, z: f64) -> Self {
        Domain::Box { lower: Vec3::zeros(), upper: Vec3::new(x, y, z) }
    }

    /// A cylinder along x from the origin [m].
    pub fn cylinder(length: f64, radius: f64) -> Self {
        Domain::Cylinder { start: Vec3::zeros(), length, radius }
    }

    /// A sphere about the origin [m].
    pub fn sphere(radius: f64) -> Self {
        Domain::Sphere { centre: Vec3::zeros(), radius }
    }

    /// Refuses dimensions that are not lengths of bodies, and shapes so far from the origin that positions in them are
    /// rounded.
    ///
    /// # Errors
    /// [`PackError::BadDimension`], [`PackError::TooFar`].
    pub fn check(&self) -> Result<(), PackError> {
        let lengths: Vec<(&'static str, f64)> = match self {
            Domain::Box { lower, upper } | Domain::Periodic { lower, upper } => {
                let d = upper - lower;
                vec![("extent in x", d.x), ("extent in y", d.y), ("extent in z", d.z)]
            }
            Domain::Cylinder { length, radius, start } => {
                vec![("length", *length), ("radius", *radius), ("place", 1.0 + 0.0 * start.sum())]
            }
            Domain::Sphere { radius, centre } => vec![("radius", *radius), ("place", 1.0 + 0.0 * centre.sum())],
            Domain::Surface(surface) => {
                let (lower, upper) = surface.bounds();
                vec![("smallest extent", (upper - lower).min()), ("largest extent", (upper - lower).max())]
            }
        };
        if let Some((what, value)) = lengths.into_iter().find(|(_, value)| !LENGTHS.contains(value)) {
            return Err(PackError::BadDimension { what, value });
        }
        let (lower, upper) = self.bounds();
        let (extent, distance) = ((upper - lower).min(), lower.amax().max(upper.amax()));
        if distance > FARTHEST * extent {
            return Err(PackError::TooFar { distance, extent });
        }
        Ok(())
    }

    /// Volume [m³].
    pub fn volume(&self) -> f64 {
        match self {
            Domain::Box { lower, upper } | Domain::Periodic { lower, upper } => (upper - lower).product(),
            Domain::Cylinder { length, radius, .. } => PI * radius * radius * length,
            Domain::Sphere { radius, .. } => sphere_volume(*radius),
            Domain::Surface(surface) => surface.volume(),
        }
    }

    /// Area of the boundary [m²].
    pub fn area(&self) -> f64 {
        match self {
            Domain::Box { lower, upper } => {
                let d = upper - lower;
                2.0 * (d.x * d.y + d.y * d.z + d.z * d.x)
            }
            Domain::Cylinder { length, radius, .. } => 2.0 * PI * radius * (length + radius),
            Domain::Sphere { radius, .. } => 4.0 * PI * radius * radius,
            Domain::Surface(surface) => surface.area(),
            Domain::Periodic { .. } => 0.0,
        }
    }

    /// Lower and upper corner of the bounding box [m].
    pub fn bounds(&self) -> (Vec3, Vec3) {
        match self {
            Domain::Box { lower, upper } | Domain::Periodic { lower, upper } => (*lower, *upper),
            Domain::Cylinder { start, length, radius } => {
                let half = Vec3::new(0.0, *radius, *radius);
                (start - half, start + half + Vec3::new(*length, 0.0, 0.0))
            }
            Domain::Sphere { centre, radius } => (centre.add_scalar(-radius), centre.add_scalar(*radius)),
            Domain::Surface(surface) => surface.bounds(),
        }
    }

    /// How it repeats; none for shapes with walls.
    pub fn period(&self) -> Option<Period> {
        let Domain::Periodic { lower, upper } = self else { return None };
        Some(Period::new(*lower, *upper))
    }

    /// Distance from `x` to the nearest wall [m], positive inside; infinite without walls.
    pub fn depth(&self, x: &Vec3) -> f64 {
        match self {
            Domain::Surface(surface) => surface.depth(x),
            _ => {
                let mut least = f64::INFINITY;
                self.plain_walls(x, |_, depth, _| least = least.min(depth));
                least
            }
        }
    }

    /// Names of the walls of a box.
    pub const BOX_WALLS: &'static [&'static str] = &["x-", "x+", "y-", "y+", "z-", "z+"];
    /// Names of the walls of a cylinder.
    pub const CYLINDER_WALLS: &'static [&'static str] = &["x-", "x+", "radius"];
    /// Names of the walls of a sphere.
    pub const SPHERE_WALLS: &'static [&'static str] = &["radius"];
    /// Names of the walls of a triangulated surface.
    pub const SURFACE_WALLS: &'static [&'static str] = &["surface"];

    /// Names of the walls, in the order of their sets.
    pub fn wall_names(&self) -> &'static [&'static str] {
        match self {
            Domain::Box { .. } => Domain::BOX_WALLS,
            Domain::Cylinder { .. } => Domain::CYLINDER_WALLS,
            Domain::Sphere { .. } => Domain::SPHERE_WALLS,
            Domain::Surface(_) => Domain::SURFACE_WALLS,
            Domain::Periodic { .. } => &[],
        }
    }

    /// Calls `visit(wall, depth of x below it, inward normal)` for every wall of an analytic shape.
    #[inline]
    fn plain_walls(&self, x: &Vec3, mut visit: impl FnMut(usize, f64, Vec3)) {
        match self {
            Domain::Box { lower, upper } => {
                for axis in 0..3 {
                    let mut normal = Vec3::zeros();
                    normal[axis] = 1.0;
                    visit(2 * axis, x[axis] - lower[axis], normal);
                    visit(2 * axis + 1, upper[axis] - x[axis], -normal);
                }
            }
            Domain::Cylinder { start, length, radius } => {
                visit(0, x.x - start.x, Vec3::x());
                visit(1, start.x + length - x.x, -Vec3::x());
                let out = Vec3::new(0.0, x.y - start.y, x.z - start.z);
                let distance = out.norm();
                visit(2, radius - distance, if distance > 0.0 { -out / distance } else { Vec3::y() });
            }
            Domain::Sphere { centre, radius } => {
                let out = x - centre;
                let distance = out.norm();
                visit(0, radius - distance, if distance > 0.0 { -out / distance } else { Vec3::y() });
            }
            Domain::Surface(_) | Domain::Periodic { .. } => {}
        }
    }

    /// Calls `visit(wall, depth of x below it, inward normal)` for every wall of an analytic shape, and for the nearest
    /// place of a triangulated surface.
    pub(crate) fn walls_at(&self, x: &Vec3, mut visit: impl FnMut(usize, f64, Vec3)) {
        match self {
            Domain::Surface(surface) => {
                if let (depth, Some(inward)) = surface.nearest(x) {
                    visit(0, depth, inward);
                }
            }
            _ => self.plain_walls(x, visit),
        }
    }

    /// Visits the walls that a sphere touches; `candidates` are the triangles near it (triangulated surfaces only).
    #[inline]
    pub(crate) fn contacts(&self, x: &Vec3, r: f64, candidates: &[u32], mut visit: impl FnMut(WallContact)) {
        let Domain::Surface(surface) = self else {
            return self.plain_walls(x, |wall, depth, inward| {
                if depth < r {
                    visit(WallContact { wall, overlap: r - depth, inward });
                }
            });
        };
        // Deepest first, so that a facet hidden behind a nearer one of about the same direction is skipped.
        let mut kept: Vec<(f64, Vec3)> = Vec::new();
        let mut touching: Vec<(f64, Vec3)> = Vec::new();
        for &triangle in candidates {
            let (offset, normal) = surface.offset(triangle, x);
            let distance = offset.norm();
            let outside = offset.dot(&normal) > 0.0;
            let depth = if outside { -distance } else { distance };
            if depth < r && distance < r {
                let inward = if outside || distance == 0.0 { -normal } else { offset / distance };
                touching.push((r - depth, inward));
            }
        }
        touching.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (overlap, inward) in touching {
            if kept.iter().all(|(_, other)| other.dot(&inward) < SAME_WALL_COSINE) {
                kept.push((overlap, inward));
                visit(WallContact { wall: 0, overlap, inward });
            }
        }
    }

    /// The numbers to store.
    pub fn data(&self) -> DomainData {
        match self {
            Domain::Box { lower, upper } => DomainData::Box((*lower).into(), (*upper).into()),
            Domain::Cylinder { start, length, radius } => DomainData::Cylinder((*start).into(), *length, *radius),
            Domain::Sphere { centre, radius } => DomainData::Sphere((*centre).into(), *radius),
            Domain::Surface(surface) => DomainData::Surface(surface.data()),
            Domain::Periodic { lower, upper } => DomainData::Periodic((*lower).into(), (*upper).into()),
        }
    }

    /// Rebuilds a domain from stored numbers.
    ///
    /// # Errors
    /// Those of [`Domain::check`] and [`ClosedSurface::new`].
    pub fn from_data(data: &DomainData) -> Result<Self, PackError> {
        let domain = match data {
            DomainData::Box(lower, upper) => Domain::Box { lower: (*lower).into(), upper: (*upper).into() },
            DomainData::Cylinder(start, length, radius) => {
                Domain::Cylinder { start: (*start).into(), length: *length, radius: *radius }
            }
            DomainData::Sphere(centre, radius) => Domain::Sphere { centre: (*centre).into(), radius: *radius },
            DomainData::Surface(data) => Domain::Surface(ClosedSurface::from_data(data)?),
            DomainData::Periodic(lower, upper) => Domain::Periodic { lower: (*lower).into(), upper: (*upper).into() },
        };
        domain.check()?;
        Ok(domain)
    }
}
