use std::f64::consts::PI;

/// Volume of a sphere of a radius [m], in m³.
pub fn sphere_volume(radius: f64) -> f64 {
    4.0 / 3.0 * PI * radius.powi(3)
}
