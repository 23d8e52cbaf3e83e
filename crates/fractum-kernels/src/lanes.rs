//! Numbers and vectors side by side, for laws that handle several bonds at once, and for particles that move.

use core::ops::{Add, Mul, Neg, Sub};

#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;

/// Bonds computed side by side.
pub const WIDTH: usize = 8;

/// `W` numbers handled side by side: plain arrays that the compiler turns into vector instructions.
#[derive(Clone, Copy)]
pub struct Lanes<const W: usize>(pub [f64; W]);

impl<const W: usize> Lanes<W> {
    /// The same number in all lanes.
    #[inline(always)]
    pub fn splat(value: f64) -> Self {
        Lanes([value; W])
    }

    /// The number of each lane: a loop, since the closures of `array::from_fn` are not always inlined.
    #[inline(always)]
    pub fn of(number: impl Fn(usize) -> f64) -> Self {
        let mut out = [0.0; W];
        for k in 0..W {
            out[k] = number(k);
        }
        Lanes(out)
    }

    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Lanes::of(|k| f(self.0[k]))
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Lanes::of(|k| f(self.0[k], other.0[k]))
    }

    /// Square roots.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }

    /// Reciprocals.
    #[inline(always)]
    pub fn recip(self) -> Self {
        self.map(|v| 1.0 / v)
    }
}

impl<const W: usize> Add for Lanes<W> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<const W: usize> Sub for Lanes<W> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl<const W: usize> Mul for Lanes<W> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl<const W: usize> Neg for Lanes<W> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|v| -v)
    }
}

/// Has lanes computed side by side although their numbers are then taken one by one. The compiler finds vectors by the arrays that are stored, and
/// computes number by number where there are none; this stores them. Results are the same.
#[inline(always)]
pub fn side_by_side<T>(lanes: &T) {
    core::hint::black_box(lanes);
}

/// Vectors in space, `W` side by side.
pub type Vector<const W: usize> = [Lanes<W>; 3];

/// a + b.
#[inline(always)]
pub fn add<const W: usize>(a: Vector<W>, b: Vector<W>) -> Vector<W> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// a − b.
#[inline(always)]
pub fn sub<const W: usize>(a: Vector<W>, b: Vector<W>) -> Vector<W> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// s a.
#[inline(always)]
pub fn scale<const W: usize>(a: Vector<W>, s: Lanes<W>) -> Vector<W> {
    [a[0] * s, a[1] * s, a[2] * s]
}

/// a · b.
#[inline(always)]
pub fn dot<const W: usize>(a: Vector<W>, b: Vector<W>) -> Lanes<W> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b.
#[inline(always)]
pub fn cross<const W: usize>(a: Vector<W>, b: Vector<W>) -> Vector<W> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `v` turned by the unit quaternion (w, u): v + 2 u × (u × v + w v).
#[inline(always)]
pub fn rotate<const W: usize>(w: Lanes<W>, u: Vector<W>, v: Vector<W>) -> Vector<W> {
    let inner = add(cross(u, v), scale(v, w));
    let outer = cross(u, inner);
    add(v, add(outer, outer))
}

/// `v` turned back by the unit quaternion (w, u).
#[inline(always)]
pub fn rotate_back<const W: usize>(w: Lanes<W>, u: Vector<W>, v: Vector<W>) -> Vector<W> {
    rotate(w, [-u[0], -u[1], -u[2]], v)
}
