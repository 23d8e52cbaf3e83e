use std::ops::{Add, Mul, Neg, Sub};

/// `W` numbers handled side by side: plain arrays that the compiler turns into vector instructions.
#[derive(Clone, Copy)]
pub(super) struct Lanes<const W: usize>(pub(super) [f64; W]);

impl<const W: usize> Lanes<W> {
    #[inline(always)]
    pub(super) fn splat(value: f64) -> Self {
        Lanes([value; W])
    }

    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Lanes(self.0.map(f))
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Lanes(std::array::from_fn(|k| f(self.0[k], other.0[k])))
    }

    #[inline(always)]
    pub(super) fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }

    #[inline(always)]
    pub(super) fn recip(self) -> Self {
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

/// Vectors in space, `W` side by side.
pub(super) type Vector<const W: usize> = [Lanes<W>; 3];

#[inline(always)]
pub(super) fn add<const W: usize>(a: Vector<W>, b: Vector<W>) -> Vector<W> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(super) fn sub<const W: usize>(a: Vector<W>, b: Vector<W>) -> Vector<W> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(super) fn scale<const W: usize>(a: Vector<W>, s: Lanes<W>) -> Vector<W> {
    [a[0] * s, a[1] * s, a[2] * s]
}

#[inline(always)]
pub(super) fn dot<const W: usize>(a: Vector<W>, b: Vector<W>) -> Lanes<W> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(super) fn cross<const W: usize>(a: Vector<W>, b: Vector<W>) -> Vector<W> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `v` turned by the unit quaternion (w, u): v + 2 u × (u × v + w v).
#[inline(always)]
pub(super) fn rotate<const W: usize>(w: Lanes<W>, u: Vector<W>, v: Vector<W>) -> Vector<W> {
    let inner = add(cross(u, v), scale(v, w));
    let outer = cross(u, inner);
    add(v, add(outer, outer))
}
