//! Functions of time and position for supports and loads.

use fractum_math::Vec3;

use super::expression::Program;

/// A quantity as a function of time and position; all numbers in SI. Evaluation allocates nothing.
#[derive(Debug, Clone, PartialEq)]
pub enum TimeFunction {
    /// The same at all times.
    Constant(f64),
    /// Straight lines between points (time [s], value), times increasing; constant before the first and after the last.
    Ramp(Vec<(f64, f64)>),
    /// As `Ramp`, with quintic steps s³(10 − 15 s + 6 s²) between points: continuous to the second derivative.
    SmoothRamp(Vec<(f64, f64)>),
    /// Zero until `start` [s], rising linearly to `peak` over `rise` [s], back to zero at `start + duration` [s].
    Triangle {
        /// Largest value.
        peak: f64,
        /// Begin [s].
        start: f64,
        /// Time from begin to end [s], > 0.
        duration: f64,
        /// Time from begin to peak [s], within 0..duration.
        rise: f64,
    },
    /// Half a sine wave of height `peak` from `start` [s] over `duration` [s]; zero elsewhere.
    HalfSine {
        /// Largest value.
        peak: f64,
        /// Begin [s].
        start: f64,
        /// Time from begin to end [s], > 0.
        duration: f64,
    },
    /// `scale` (exp(−a τ) − exp(−b τ)) with τ = t − start ≥ 0, b > a > 0; zero before.
    DoubleExponential {
        /// Factor that makes the largest value equal to the peak asked for.
        scale: f64,
        /// Rate of decay a [1/s].
        decay: f64,
        /// Rate of rise b [1/s], above a.
        rise: f64,
        /// Begin [s].
        start: f64,
    },
    /// Expression of t, x, y, z.
    Expression(Field),
}

impl TimeFunction {
    /// Value at time `t` [s] and `position` [m].
    pub fn value(&self, t: f64, position: Vec3) -> f64 {
        match *self {
            Self::Constant(value) => value,
            Self::Ramp(ref points) => between(points, t, |s| s),
            Self::SmoothRamp(ref points) => between(points, t, |s| s * s * s * (10.0 + s * (6.0 * s - 15.0))),
            Self::Triangle { peak, start, duration, rise } => {
                let tau = t - start;
                if tau < 0.0 || tau >= duration {
                    0.0
                } else if tau < rise {
                    peak * tau / rise
                } else {
                    peak * (duration - tau) / (duration - rise)
                }
            }
            Self::HalfSine { peak, start, duration } => {
                let s = (t - start) / duration;
                if (0.0..1.0).contains(&s) { peak * (std::f64::consts::PI * s).sin() } else { 0.0 }
            }
            Self::DoubleExponential { scale, decay, rise, start } => {
                let tau = t - start;
                if tau < 0.0 { 0.0 } else { scale * ((-decay * tau).exp() - (-rise * tau).exp()) }
            }
            Self::Expression(ref field) => field.value(t, position),
        }
    }

    /// Whether the value differs from point to point.
    pub fn depends_on_position(&self) -> bool {
        matches!(self, Self::Expression(field) if field.depends_on_position())
    }

    /// Whether the value changes with time.
    pub fn depends_on_time(&self) -> bool {
        match self {
            Self::Constant(_) => false,
            Self::Ramp(points) | Self::SmoothRamp(points) => points.windows(2).any(|pair| pair[0].1 != pair[1].1),
            Self::Expression(field) => field.depends_on_time(),
            _ => true,
        }
    }
}

/// An expression of time t [s] and position x, y, z [m].
#[derive(Debug, Clone, PartialEq)]
pub struct Field(pub(crate) Program);

impl Field {
    /// Value at time `t` [s] and `position` [m], in SI; 1 and 0 for the truth of a condition.
    pub fn value(&self, t: f64, position: Vec3) -> f64 {
        self.0.evaluate(&[t, position.x, position.y, position.z])
    }

    /// Value where time plays no part.
    pub fn at(&self, position: Vec3) -> f64 {
        self.value(0.0, position)
    }

    /// Whether a condition holds at `position` [m].
    pub fn holds_at(&self, position: Vec3) -> bool {
        self.at(position) != 0.0
    }

    /// Whether the value differs from point to point.
    pub fn depends_on_position(&self) -> bool {
        (1..4).any(|input| self.0.reads(input))
    }

    /// Whether the value changes with time.
    pub fn depends_on_time(&self) -> bool {
        self.0.reads(0)
    }
}

/// Interpolates between points; `shape` maps 0..1 onto 0..1.
fn between(points: &[(f64, f64)], t: f64, shape: impl Fn(f64) -> f64) -> f64 {
    let next = points.partition_point(|&(time, _)| time <= t);
    match (next.checked_sub(1).and_then(|i| points.get(i)), points.get(next)) {
        (Some(&(t0, v0)), Some(&(t1, v1))) => v0 + (v1 - v0) * shape((t - t0) / (t1 - t0)),
        (Some(&(_, value)), None) | (None, Some(&(_, value))) => value,
        (None, None) => 0.0,
    }
}
