use fractum_dem::Crack;
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
            .map_or((None, None), |(normal, rough)| (Some(degrees(normal.x.abs().acos())), Some(rough))),
        Failure::Brazilian => {
            let trace = |c: &&Crack| (c.position.y - centre.y).abs() < 0.7 * size;
            let flat = cracks.iter().filter(trace).map(|c| Vec3::new(0.0, c.position.y, c.position.z));
            line(flat).map_or((None, None), |(along, rough)| (Some(degrees(along.y.abs().acos())), Some(rough)))
        }
        Failure::Torsion => (helix(cracks, centre, size).map(degrees), None),
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

/// Angle between the axis x and the helix on the surface that most broken bonds of the outer third lie on: the slope
/// θ = θ₀ + s x with the largest |Σ exp(i(θ − s x))|.
fn helix(cracks: &[Crack], centre: Vec3, radius: f64) -> Option<f64> {
    let on_surface = |c: &Crack| {
        let d = c.position - centre;
        (d.y.hypot(d.z) > 0.67 * radius).then(|| (d.x, d.z.atan2(d.y)))
    };
    let points: Vec<(f64, f64)> = cracks.iter().filter_map(on_surface).collect();
    if points.len() < 10 {
        return None;
    }
    // Angles to the axis from 5° to 85° of either hand, in steps of a quarter of a degree.
    let strength = |tangent: f64| {
        let s = tangent / radius;
        let (c, q) = points.iter().fold((0.0, 0.0), |(c, q), (x, theta)| {
            let (sine, cosine) = (theta - s * x).sin_cos();
            (c + cosine, q + sine)
        });
        c * c + q * q
    };
    let angles = (20..=340).flat_map(|k| [f64::from(k), -f64::from(k)]).map(|q| (0.25 * q).to_radians());
    angles
        .fold(None, |best: Option<(f64, f64)>, angle| {
            let value = strength(angle.tan());
            if best.is_none_or(|(b, _)| value > b) { Some((value, angle)) } else { best }
        })
        .map(|(_, angle)| angle.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use fractum_dem::criterion::Mode;

    fn crack(position: Vec3) -> Crack {
        Crack {
            bond: 0,
            pair: [0, 1],
            event: 1,
            time: 1.0,
            load: 1.0,
            position,
            normal: Vec3::x(),
            area: 1.0,
            mode: Mode::Tension,
            energy: 0.0,
        }
    }

    #[test]
    fn a_drawn_helix_is_found_with_its_angle() {
        // Three quarters of a turn at 40° to the axis, with jitter across it.
        let radius: f64 = 2.0;
        let slope = 40f64.to_radians().tan() / radius;
        let cracks: Vec<Crack> = (0..200)
            .map(|k| {
                let theta = f64::from(k) / 200.0 * 1.5 * std::f64::consts::PI;
                let jitter = 0.1 * (f64::from(k) * 1.7).sin();
                let r = 0.9 * radius;
                crack(Vec3::new(theta / slope + jitter, r * theta.cos(), r * theta.sin()))
            })
            .collect();
        let angle = helix(&cracks, Vec3::zeros(), radius).unwrap().to_degrees();
        assert!((angle - 40.0).abs() < 1.5, "{angle}");
    }

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
