//! What bonds bear, for criteria that look at every one.

use fractum_kernels::bond::ForceLanes;
use fractum_kernels::lanes::{Lanes, Vector, WIDTH, dot, scale, sub};

/// Sizes of what a bond bears.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoadSizes {
    /// Axial force [N], positive in tension.
    pub normal: f64,
    /// Bending moment at the middle, ½ |M₁ − M₂| of the moments on the two ends [N m].
    pub mean_bending: f64,
    /// The larger bending moment of both ends [N m].
    pub largest_bending: f64,
    /// Torsional moment [N m].
    pub torsion: f64,
    /// Radius of its section [m].
    pub radius: f64,
}

/// [`LoadSizes`] of bonds side by side, in the order of its first four fields.
pub type LoadLanes = [[f64; WIDTH]; 4];

#[inline(always)]
pub(super) fn load_sizes(gap: Vector<WIDTH>, forces: &ForceLanes<WIDTH>) -> LoadLanes {
    let n = scale(gap, dot(gap, gap).sqrt().recip());
    let across = |m: Vector<WIDTH>| sub(m, scale(n, dot(m, n)));
    let [first, second] = forces.moment.map(across);
    let difference = sub(first, second);
    let mean = dot(difference, difference).sqrt() * Lanes::splat(0.5);
    let (a, b) = (dot(first, first), dot(second, second));
    let largest = Lanes::<WIDTH>::of(|k| a.0[k].max(b.0[k])).sqrt();
    [(-dot(forces.force, n)).0, mean.0, largest.0, dot(forces.moment[0], n).0]
}
