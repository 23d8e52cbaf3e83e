//! Functions of time and position for supports and loads.

use fractum_math::Vec3;
use fractum_math::elementary::{exp, exp_m1, ln, sin};

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
    /// `peak` τ/rise until τ = `rise`, then `peak` exp(−(τ − rise)/decay), with τ = t − start ≥ 0; zero before.
    LinearExponential {
        /// Largest value.
        peak: f64,
        /// Begin [s].
        start: f64,
        /// Time from begin to peak [s], ≥ 0.
        rise: f64,
        /// Time from the peak to 1/e of it [s], > 0.
        decay: f64,
    },
    /// Another function, later by a time [s].
    Delayed(f64, Box<TimeFunction>),
    /// Expression of t, x, y, z.
    Expression(Field),
}

/// Times and positions at which a function is looked at before a run.
const LOOKS: usize = 1000;

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
                if (0.0..1.0).contains(&s) { peak * sin(std::f64::consts::PI * s) } else { 0.0 }
            }
            Self::DoubleExponential { scale, decay, rise, start } => {
                let tau = t - start;
                // as a product, since the two exponentials nearly cancel where the rates are close
                if tau < 0.0 { 0.0 } else { scale * exp(-decay * tau) * -exp_m1(-(rise - decay) * tau) }
            }
            Self::LinearExponential { peak, start, rise, decay } => {
                let tau = t - start;
                if tau < 0.0 {
                    0.0
                } else if tau < rise {
                    peak * tau / rise
                } else {
                    peak * exp(-(tau - rise) / decay)
                }
            }
            Self::Delayed(delay, ref function) => function.value(t - delay, position),
            Self::Expression(ref field) => field.value(t, position),
        }
    }

    /// Whether it is one of the pulses of a blast or a blow.
    pub fn is_pulse(&self) -> bool {
        match self {
            Self::Constant(_) | Self::Ramp(_) | Self::SmoothRamp(_) | Self::Expression(_) => false,
            Self::Delayed(_, function) => function.is_pulse(),
            Self::Triangle { .. }
            | Self::HalfSine { .. }
            | Self::DoubleExponential { .. }
            | Self::LinearExponential { .. } => true,
        }
    }

    /// Instants [s] at which a pulse begins and is largest; none of other functions.
    pub fn rise(&self) -> Option<[f64; 2]> {
        match *self {
            Self::Constant(_) | Self::Ramp(_) | Self::SmoothRamp(_) | Self::Expression(_) => None,
            Self::Triangle { start, rise, .. } | Self::LinearExponential { start, rise, .. } => {
                Some([start, start + rise])
            }
            Self::HalfSine { start, duration, .. } => Some([start, start + 0.5 * duration]),
            Self::DoubleExponential { decay, rise, start, .. } => {
                Some([start, start + ln(rise / decay) / (rise - decay)])
            }
            Self::Delayed(delay, ref function) => function.rise().map(|times| times.map(|time| time + delay)),
        }
    }

    /// Last instant of a table [s], and how far its value goes after another instant, over its largest value; none of other functions.
    pub fn rest_of_table(&self, after: f64) -> Option<(f64, f64)> {
        match self {
            Self::Ramp(points) | Self::SmoothRamp(points) => {
                let (last, _) = *points.last()?;
                let present = self.value(after, Vec3::zeros());
                let largest = points.iter().fold(0.0f64, |largest, (_, value)| largest.max(value.abs()));
                let rest = points.iter().filter(|(time, _)| *time > after);
                let way = rest.fold(0.0f64, |way, (_, value)| way.max((value - present).abs()));
                Some((last, if largest > 0.0 { way / largest } else { 0.0 }))
            }
            Self::Delayed(delay, function) => {
                function.rest_of_table(after - delay).map(|(last, way)| (last + delay, way))
            }
            _ => None,
        }
    }

    /// A double-exponential pulse by its largest value `peak`, the time `rise` [s] from its begin at `start` [s] to
    /// that value, and the time `decay` [s] from there until 1/e of it is left.
    ///
    /// `None` unless 2.1462 ≤ decay/rise ≤ 1e6: no difference of exponentials decays faster.
    pub fn double_exponential(peak: f64, rise: f64, decay: f64, start: f64) -> Option<Self> {
        let ratio = decay / rise;
        if !(ratio.is_finite() && ratio <= 1e6) {
            return None;
        }
        // With L = ln(b/a) the peak stands at τ = L/(b - a), so that a τ = L/(e^L - 1).
        let a_tau = |l: f64| l / exp_m1(l);
        let left = |l: f64| exp(-ratio * a_tau(l)) * exp_m1(-l * (1.0 + ratio)) / exp_m1(-l);
        let (mut low, mut high) = (1e-6, 30.0);
        let target = exp(-1.0);
        if left(low) > target || left(high) < target {
            return None;
        }
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if left(middle) < target { low = middle } else { high = middle }
        }
        let decay = a_tau(low) / rise;
        let scale = peak / (exp(-a_tau(low)) * -exp_m1(-low));
        Some(Self::DoubleExponential { scale, decay, rise: decay + low / rise, start })
    }

    /// A time [s] from the start of a run to its `end` [s] at which the value is not a finite number, with the position
    /// among `positions` [m] and the value. Looks at 1,000 times, or at 10 where it differs among up to 1,000 positions.
    pub fn not_finite(&self, end: f64, positions: &[Vec3]) -> Option<(f64, Vec3, f64)> {
        let times = if self.depends_on_time() { LOOKS } else { 0 };
        let positions = if self.depends_on_position() { positions } else { &[Vec3::zeros()] };
        let stride = positions.len().div_ceil(LOOKS).max(1);
        let stride_of_time = if positions.len() > 1 { LOOKS / 10 } else { 1 };
        for look in (0..=times).step_by(stride_of_time) {
            let t = end * (look as f64 / LOOKS as f64);
            for &position in positions.iter().step_by(stride) {
                let value = self.value(t, position);
                if !value.is_finite() {
                    return Some((t, position, value));
                }
            }
        }
        None
    }

    /// The first instant within a run at which the value is negative [s], and that value; where it is the same everywhere.
    pub fn negative(&self, end: f64) -> Option<(f64, f64)> {
        let times = if self.depends_on_time() { LOOKS } else { 0 };
        let looks = (0..=times).map(|look| end * (look as f64 / LOOKS as f64));
        looks.map(|t| (t, self.value(t, Vec3::zeros()))).find(|(_, value)| *value < 0.0)
    }

    /// Whether the value goes up and down again, or down and up, between two instants [s] at one of some positions [m].
    pub fn turns(&self, [begin, end]: [f64; 2], positions: &[Vec3]) -> bool {
        let turns_at = |position: Vec3| {
            let at = |look: usize| self.value(begin + (end - begin) * (look as f64 / LOOKS as f64), position);
            let (mut low, mut high) = (at(0), at(0));
            let (mut fell, mut rose) = (0.0f64, 0.0f64);
            for value in (1..=LOOKS).map(at) {
                (low, high) = (low.min(value), high.max(value));
                (fell, rose) = (fell.max(high - value), rose.max(value - low));
            }
            fell.min(rose) > 1e-9 * (high - low)
        };
        let positions = if self.depends_on_position() { positions } else { &[Vec3::zeros()] };
        self.depends_on_time() && positions.iter().any(|&position| turns_at(position))
    }

    /// Whether the value has both signs between two instants [s] at one of some positions [m].
    pub fn changes_sign(&self, [begin, end]: [f64; 2], positions: &[Vec3]) -> bool {
        let positions = if self.depends_on_position() { positions } else { &[Vec3::zeros()] };
        self.depends_on_time()
            && positions.iter().any(|&position| {
                let at = |look: usize| self.value(begin + (end - begin) * (look as f64 / LOOKS as f64), position);
                (0..=LOOKS).any(|look| at(look) > 0.0) && (0..=LOOKS).any(|look| at(look) < 0.0)
            })
    }

    /// How much later than another function it is [s]; none if it is a function of its own.
    pub fn delay(&self) -> Option<f64> {
        match self {
            Self::Delayed(delay, _) => Some(*delay),
            _ => None,
        }
    }

    /// Whether the value differs from point to point.
    pub fn depends_on_position(&self) -> bool {
        match self {
            Self::Expression(field) => field.depends_on_position(),
            Self::Delayed(_, function) => function.depends_on_position(),
            _ => false,
        }
    }

    /// Whether it is zero everywhere and at all times.
    pub fn is_zero(&self) -> bool {
        !self.depends_on_time() && !self.depends_on_position() && self.value(0.0, Vec3::zeros()) == 0.0
    }

    /// Whether the value changes with time.
    pub fn depends_on_time(&self) -> bool {
        match self {
            Self::Constant(_) => false,
            Self::Ramp(points) | Self::SmoothRamp(points) => points.windows(2).any(|pair| pair[0].1 != pair[1].1),
            Self::Expression(field) => field.depends_on_time(),
            Self::Delayed(_, function) => function.depends_on_time(),
            _ => true,
        }
    }
}

/// An expression of time t [s] and position x, y, z [m].
#[derive(Debug, Clone, PartialEq)]
pub struct Field(pub(crate) Program);

impl Field {
    /// The same everywhere.
    pub(super) fn constant(value: f64) -> Self {
        Self(Program::of_constant(value))
    }

    /// Its value where it is the same everywhere and at all times.
    pub fn constant_value(&self) -> Option<f64> {
        self.0.constant()
    }

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

#[cfg(test)]
mod tests {
    use super::*;

    fn at(function: &TimeFunction, t: f64) -> f64 {
        function.value(t, Vec3::zeros())
    }

    #[test]
    fn ramps_are_constant_outside_their_points() {
        let points = vec![(1.0, 10.0), (2.0, 20.0), (4.0, 0.0)];
        for function in [TimeFunction::Ramp(points.clone()), TimeFunction::SmoothRamp(points)] {
            for (t, value) in [(-1.0, 10.0), (1.0, 10.0), (1.5, 15.0), (2.0, 20.0), (3.0, 10.0), (4.0, 0.0), (9.0, 0.0)]
            {
                assert_eq!(at(&function, t), value, "{function:?} at {t}");
            }
        }
        assert_eq!(at(&TimeFunction::Ramp(vec![(1.0, 3.0)]), 0.0), 3.0);
    }

    #[test]
    fn pulses_tell_their_rise_and_tables_what_is_left_of_them() {
        let pulse = TimeFunction::double_exponential(7.0, 2.0, 9.0, 1.0).unwrap();
        let linear = TimeFunction::LinearExponential { peak: 7.0, start: 1.0, rise: 2.0, decay: 4.0 };
        for pulse in [pulse, linear] {
            let [start, peak] = pulse.rise().unwrap();
            assert!(start == 1.0 && (peak - 3.0).abs() < 1e-6 && (at(&pulse, peak) - 7.0).abs() < 1e-6, "{pulse:?}");
            let [late, _] = TimeFunction::Delayed(0.5, Box::new(pulse)).rise().unwrap();
            assert_eq!(late, 1.5);
        }
        let table = TimeFunction::Ramp(vec![(0.0, 0.0), (4.0, 8.0), (6.0, 8.0)]);
        assert_eq!(table.rise(), None);
        assert_eq!(table.rest_of_table(1.0), Some((6.0, 0.75)));
        assert_eq!(table.rest_of_table(5.0), Some((6.0, 0.0)));
        assert_eq!(TimeFunction::Delayed(1.0, Box::new(table)).rest_of_table(2.0), Some((7.0, 0.75)));
        assert_eq!(TimeFunction::Constant(3.0).rest_of_table(0.0), None);
    }

    #[test]
    fn smooth_ramps_have_no_jump_in_velocity_and_acceleration() {
        let function = TimeFunction::SmoothRamp(vec![(0.0, 0.0), (1.0, 1.0)]);
        let h = 1e-4;
        for t in [0.0, 1.0] {
            let slope = (at(&function, t + h) - at(&function, t - h)) / (2.0 * h);
            let curvature = (at(&function, t + h) - 2.0 * at(&function, t) + at(&function, t - h)) / (h * h);
            assert!(slope.abs() < 1e-6, "{slope}"); // 5 h² from the cubic term
            assert!(curvature.abs() < 20.0 * h, "{curvature}"); // 10 h
        }
    }

    #[test]
    fn values_that_are_no_numbers_are_found_with_time_and_place() {
        use crate::expression::Op;
        let root = |input: u16| {
            let code = vec![Op::Input(input), Op::Unary(crate::expression::Unary::Sqrt)];
            TimeFunction::Expression(Field(Program::new(code).unwrap()))
        };
        assert_eq!(root(0).not_finite(1.0, &[]), None);
        let (time, _, value) = root(0).not_finite(-1.0, &[]).unwrap();
        assert!(time == -1e-3 && value.is_nan(), "the root of a negative time");
        let points: Vec<Vec3> = (0..5000).map(|i| Vec3::x() * (2500.0 - f64::from(i))).collect();
        assert!(root(1).not_finite(1.0, &points).is_some_and(|(_, x, _)| x.x < 0.0));
        assert_eq!(root(1).not_finite(1.0, &points[..2500]), None);
        let steep = TimeFunction::Ramp(vec![(0.0, -1e308), (1.0, 1e308)]);
        assert!(steep.not_finite(1.0, &[]).is_some());
    }

    #[test]
    fn pulses_begin_peak_and_end_where_they_should() {
        let triangle = TimeFunction::Triangle { peak: 4.0, start: 1.0, duration: 4.0, rise: 1.0 };
        for (t, value) in [(0.9, 0.0), (1.0, 0.0), (1.5, 2.0), (2.0, 4.0), (3.5, 2.0), (5.0, 0.0), (6.0, 0.0)] {
            assert_eq!(at(&triangle, t), value, "triangle at {t}");
        }
        let instant = TimeFunction::Triangle { peak: 4.0, start: 0.0, duration: 4.0, rise: 0.0 };
        assert_eq!((at(&instant, 0.0), at(&instant, 2.0)), (4.0, 2.0));
        let saw = TimeFunction::Triangle { peak: 4.0, start: 0.0, duration: 4.0, rise: 4.0 };
        assert_eq!((at(&saw, 2.0), at(&saw, 4.0)), (2.0, 0.0));
        let half_sine = TimeFunction::HalfSine { peak: 2.0, start: 1.0, duration: 2.0 };
        for (t, value) in [(0.5, 0.0), (1.0, 0.0), (2.0, 2.0), (1.0 + 1.0 / 3.0, 1.0), (3.0, 0.0), (4.0, 0.0)] {
            assert!((at(&half_sine, t) - value).abs() < 1e-15, "half-sine at {t}");
        }
    }

    #[test]
    fn a_linear_rise_is_followed_by_an_exponential_decay() {
        let pulse = TimeFunction::LinearExponential { peak: 6.0, start: 1.0, rise: 2.0, decay: 4.0 };
        for (t, value) in [(0.9, 0.0), (1.0, 0.0), (2.0, 3.0), (3.0, 6.0), (7.0, 6.0 * (-1f64).exp())] {
            assert!((at(&pulse, t) - value).abs() < 1e-15, "at {t}");
        }
        let shock = TimeFunction::LinearExponential { peak: 6.0, start: 0.0, rise: 0.0, decay: 4.0 };
        assert_eq!((at(&shock, -1e-9), at(&shock, 0.0)), (0.0, 6.0));
        let later = TimeFunction::Delayed(10.0, Box::new(pulse.clone()));
        assert_eq!((at(&later, 10.9), at(&later, 12.0)), (0.0, at(&pulse, 2.0)));
        assert!(later.depends_on_time() && !later.depends_on_position());
    }

    #[test]
    fn double_exponentials_peak_and_decay_as_asked() {
        for ratio in [2.1462, 2.2, 3.0, 10.0, 1e3, 1e6] {
            let (rise, start, peak) = (2e-6, 5e-6, -30e6);
            let decay = ratio * rise;
            let function = TimeFunction::double_exponential(peak, rise, decay, start).unwrap();
            assert_eq!(at(&function, start), 0.0);
            assert_eq!(at(&function, 0.0), 0.0);
            assert!((at(&function, start + rise) / peak - 1.0).abs() < 1e-12, "{ratio}");
            assert!((at(&function, start + rise + decay) / peak - (-1f64).exp()).abs() < 1e-6, "{ratio}");
            for t in [0.9, 1.1] {
                assert!(at(&function, start + t * rise) / peak < 1.0, "{ratio}: the peak stands elsewhere");
            }
        }
        for ratio in [1.0, 2.14, 1e7, f64::NAN, f64::INFINITY] {
            assert_eq!(TimeFunction::double_exponential(1.0, 1.0, ratio, 0.0), None, "{ratio}");
        }
    }
}
