use fractum_dem::Crack;
use fractum_dem::crack_shape::{Axis, helix_angle};
use fractum_math::elementary::acos;
use fractum_math::{Mat3, Sym3, Vec3};
use serde::Serialize;

use super::Failure;
use crate::Sample;

/// Where cracks began and how they run.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Geometry {
    /// Distance of the first broken bond from the axis of a cylinder over its radius, or from the middle of a box over
    /// half its length.
    pub start: f64,
    /// Distance of the middle of the first twenty broken bonds from the axis or the middle, in the same way.
    pub early: f64,
    /// Angle of the crack [degrees]: of its normal to the axis x (tension, bending); of its trace on the end faces to
    /// the loaded diameter (Brazilian); of its helix on the surface to the axis (torsion). None for other tests.
    pub angle: Option<f64>,
    /// Root mean square distance of the broken bonds from the plane or line of the crack [m], where it has one.
    pub roughness: Option<f64>,
}

/// Bonds taken for the beginning of a crack.
const EARLY: usize = 20;

/// Measures the broken bonds of a test; none where nothing broke.
pub fn geometry(sample: &Sample, test: Failure, cracks: &[Crack]) -> Option<Geometry> {
    let first = cracks.first()?;
    let (lower, upper) = sample.packing.domain.bounds();
    let centre = (lower + upper) * 0.5;
    let radius = sample.cylinder_extents().map(|(_, r)| r);
    let size = radius.unwrap_or(0.5 * (upper.x - lower.x));
    let out = |x: Vec3| match radius {
        Some(_) => Vec3::new(0.0, x.y - centre.y, x.z - centre.z).norm() / size,
        None => (x - centre).norm() / size,
    };
    let early = &cracks[..cracks.len().min(EARLY)];
    let middle = early.iter().map(|c| c.position).sum::<Vec3>() / early.len() as f64;
    let (angle, roughness) = match test {
        Failure::Tension | Failure::Bending => plane(cracks.iter().map(|c| c.position))
            .map_or((None, None), |(normal, rough)| (Some(degrees(acos(normal.x.abs()))), Some(rough))),
        Failure::Brazilian => {
            let trace = |c: &&Crack| (c.position.y - centre.y).abs() < 0.7 * size;
            let flat = cracks.iter().filter(trace).map(|c| Vec3::new(0.0, c.position.y, c.position.z));
            line(flat).map_or((None, None), |(along, rough)| (Some(degrees(acos(along.y.abs()))), Some(rough)))
        }
        Failure::Torsion => {
            let points: Vec<(Vec3, f64)> = cracks.iter().map(|c| (c.position, c.area)).collect();
            let axis = Axis { point: centre, direction: Vec3::x() };
            (helix_angle(&points, &axis, size).map(degrees), None)
        }
        Failure::Compression => (None, None),
    };
    Some(Geometry { start: out(first.position), early: out(middle), angle, roughness })
}

fn degrees(angle: f64) -> f64 {
    angle.to_degrees()
}

/// Variances of points along their principal axes, with the axes.
fn spread(points: impl Iterator<Item = Vec3> + Clone) -> Option<([f64; 3], Mat3)> {
    let count = points.clone().count() as f64;
    if count < 3.0 {
        return None;
    }
    let mean = points.clone().sum::<Vec3>() / count;
    let moments = points.fold(Mat3::zeros(), |m, x| m + (x - mean) * (x - mean).transpose());
    Some(Sym3::symmetric_part(&(moments / count)).eigen())
}

/// Normal of the plane through points, and their distance from it.
fn plane(points: impl Iterator<Item = Vec3> + Clone) -> Option<(Vec3, f64)> {
    let (values, axes) = spread(points)?;
    Some((axes.column(2).into_owned(), values[2].max(0.0).sqrt()))
}

/// Direction of the line through points of a plane, and their distance from it.
fn line(points: impl Iterator<Item = Vec3> + Clone) -> Option<(Vec3, f64)> {
    let (values, axes) = spread(points)?;
    Some((axes.column(0).into_owned(), values[1].max(0.0).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plane_and_line_are_those_of_the_points() {
        let normal = Vec3::new(1.0, 0.2, 0.0).normalize();
        let point = |k: i32| {
            let (a, b) = (f64::from(k % 7), f64::from(k / 7));
            Vec3::new(0.2, -1.0, 0.0).normalize() * -a + Vec3::z() * b + normal * (0.01 * f64::from(k).sin())
        };
        let (found, rough) = plane((0..49).map(point)).unwrap();
        assert!(found.dot(&normal).abs() > 0.9999 && rough < 0.01);
        let (along, _) = line((0..9).map(|k| Vec3::new(0.0, f64::from(k), 0.1 * f64::from(k)))).unwrap();
        assert!((along.z / along.y - 0.1).abs() < 1e-9);
    }
}
