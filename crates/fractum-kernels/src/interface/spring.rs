use serde::{Deserialize, Serialize};

use super::{InterfaceForce, InterfaceLaw, InterfaceSoftening, InterfaceState, tangential};
use crate::contact::slip_to_cone;
use crate::elementary::ln;
#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;
use crate::{Mat3, Vec3};

/// Looks at friction and strength, which depend on each other.
const LOOKS: usize = 40;
/// Halves of the way that slides over asperities, to rounding.
const HALVES: usize = 54;
/// Change of them that is rounding.
const ROUNDING: f64 = 1e-14;
/// Least ratio of the jump at the end of softening to that at its onset.
const LEAST_RATIO: f64 = 1.0 + 1e-6;
/// Step of a difference over the jump and that at the onset.
const DIFFERENCE: f64 = 1e-7;

/// An interface with a stiffness. A share 1 - D of each point is whole and elastic; the rest is broken, bears pressure, and rubs
/// (Alfano and Sacco 2006). Where softening begins on an ellipse of the stresses and ends with the energy of the mode, as in Camanho,
/// Davila and de Moura (2003); pressure raises the strength against sliding by μ p.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpringInterface {
    /// What it bears.
    pub law: InterfaceLaw,
    /// K_n and K_s [Pa/m], > 0.
    pub stiffness: [f64; 2],
}

/// What a jump asks of the strength: stress that opens and that slides [Pa], and the square of what they are on the ellipse of the strengths.
struct Asked {
    opens: f64,
    slides: f64,
    square: f64,
}

/// Where a jump stands on the softening curve of its mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standing {
    /// Stress of the whole interface over its strength, on the ellipse; ≥ 0.
    pub ratio: f64,
    /// The ratio from which on it softens further; 1 before it has begun to.
    pub onset: f64,
    /// Growth of the ratio over which it softens: to zero by a straight line, to 1/e of the strength by exponential decay.
    pub length: f64,
}

/// A point whose softening is given: the displacements are those at which it has come to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Led {
    /// Its jump [m].
    pub jump: Vec3,
    /// Its traction there [Pa].
    pub traction: Vec3,
    /// Stiffness about that jump [Pa/m]: its secant, and towards further softening that of the whole interface, which holds it there.
    pub stiffness: Mat3,
}

/// The ratio r at which exponential softening has come to a secant, exp((1 - r)/length)/r.
fn decayed_to(secant: f64, length: f64) -> f64 {
    let mut ratio = 1.0;
    // From below on a function whose slope falls: Newton's method does not pass the root.
    for _ in 0..LOOKS {
        let missing = ln(ratio) + (ratio - 1.0) / length + ln(secant);
        let change = missing / (1.0 / ratio + 1.0 / length);
        if change >= -ROUNDING * ratio {
            break;
        }
        ratio -= change;
    }
    ratio
}

/// Onset and end of softening for a jump.
struct Loading {
    /// Stress over strength on the ellipse.
    ratio: f64,
    /// Jump at the end of linear softening over that at the onset; for exponential softening energy over twice that at the onset.
    end: f64,
}

impl SpringInterface {
    /// Traction under a jump, and the history after it.
    ///
    /// - `jump`: opening, then slip along two directions [m]
    #[inline]
    pub fn load(&self, jump: Vec3, state: &mut InterfaceState) -> InterfaceForce {
        let (law, [normal, across]) = (&self.law, self.stiffness);
        let pressure = normal * (-jump.x).max(0.0);
        if state.secant > 0.0 {
            self.soften(&jump, pressure, state);
        }
        let slipped = Vec3::new(0.0, state.slip[0], state.slip[1]);
        // Asperities are worn by what has slid before.
        let (residual, worn) = (state.residual, slipped.norm());
        let bears = |pressure: f64| law.friction_at(residual, pressure, worn) * pressure;
        let trial = (Vec3::new(0.0, jump.y, jump.z) - slipped) * across;
        let size = trial.norm();
        // What has slid stands on asperities, which press.
        let presses = |slip: Vec3| normal * (law.dilated(slip.norm()) - jump.x).max(0.0);
        let mut rests = presses(slipped);
        let limit = bears(rests);
        let mut stick = slip_to_cone(trial, size, limit);
        if law.dilation > 0.0 && size > limit {
            // Share of the trial that slides: the less is left of it, and the more asperities press, the farther it went.
            let (mut holds, mut slides) = (0.0, 1.0);
            for _ in 0..HALVES {
                let share = 0.5 * (holds + slides);
                let limit = bears(presses(slipped + trial * (share / across)));
                *(if (1.0 - share) * size > limit { &mut holds } else { &mut slides }) = share;
            }
            (stick, rests) = (trial * (1.0 - slides), presses(slipped + trial * (slides / across)));
        }
        state.slip = [jump.y - stick.y / across, jump.z - stick.z / across];
        let (whole, broken) = (state.secant, 1.0 - state.secant);
        let elastic = Vec3::new(normal * jump.x, across * jump.y, across * jump.z);
        InterfaceForce {
            cohesive: Vec3::new(elastic.x.max(0.0), elastic.y, elastic.z) * whole,
            friction: stick * broken,
            contact: whole * pressure + broken * rests,
            stored: 0.5 * (whole * elastic.dot(&jump) + broken * (stick.dot(&stick) / across + rests * rests / normal)),
        }
    }

    /// Stiffness by which the present traction follows from the jump [Pa/m]: normal, tangential. What rubs counts by its secant.
    ///
    /// - `force`, `state`: those of [`SpringInterface::load`] at `jump`
    #[inline]
    pub fn secant(&self, jump: &Vec3, force: &InterfaceForce, state: &InterfaceState) -> [f64; 2] {
        let [normal, across] = self.stiffness;
        let (whole, broken) = (state.secant, 1.0 - state.secant);
        // Sides that were never joined, before anything moves: they touch, and hold.
        if whole == 0.0 && *jump == Vec3::zeros() {
            return self.stiffness;
        }
        let closed = if jump.x < 0.0 || force.contact > 0.0 { normal } else { whole * normal };
        let held = tangential(&Vec3::new(0.0, jump.y - state.slip[0], jump.z - state.slip[1]));
        let went = tangential(jump);
        let rubs = if went > 0.0 { (held / went).min(1.0) } else { 1.0 };
        let rubs = if force.contact > 0.0 { rubs } else { 0.0 };
        [closed, (whole + broken * rubs) * across]
    }

    /// How the traction changes with the jump [Pa/m], rows and columns: normal, two directions across; symmetric, and definite but for softening.
    ///
    /// [`SpringInterface::jacobian`] is not symmetric where modes are mixed or pressure makes friction, and its symmetric part is far from definite. This is the
    /// symmetric matrix whose tractions stay where those of the jacobian stay. An open face that softens keeps to the ellipse r = const, by the matrix
    /// D (1 - (1 - q) δ bᵀ) with the secant D, b = ∇r/r, and q the growth of the traction with that of δ: taken is D - (1 - q)/(b·D⁻¹b) b bᵀ. A closed face
    /// that slides keeps to the cone of friction: taken is K_n c cᵀ with c = (1, dt_s/dt_n), besides the softening along the slip.
    ///
    /// - `state`: the history that [`SpringInterface::load`] takes at `jump`
    /// - `secant`: [`SpringInterface::secant`] there
    #[inline]
    pub fn tangent(&self, jump: &Vec3, state: &InterfaceState, secant: [f64; 2]) -> Mat3 {
        let diagonal = Vec3::new(secant[0], secant[1], secant[1]);
        if state.secant == 0.0 && *jump == Vec3::zeros() {
            return Mat3::from_diagonal(&diagonal);
        }
        let at = |jump: Vec3| self.load(jump, &mut state.clone()).traction();
        let jump = &self.past_onset(jump, state);
        let here = at(*jump);
        let size = tangential(jump);
        let along = if size > 0.0 { Vec3::new(0.0, jump.y, jump.z) / size } else { Vec3::y() };
        if jump.x >= 0.0 && diagonal.min() > 0.0 {
            if !self.standing(jump, state).is_some_and(|standing| standing.ratio > standing.onset) {
                return Mat3::from_diagonal(&diagonal);
            }
            let asked = self.asked(jump, 0.0);
            let grows = (at(jump * (1.0 + DIFFERENCE)) - here).dot(jump) / (DIFFERENCE * here.dot(jump));
            let away = self.away(&asked, &along) / asked.square;
            let compliance = away.component_mul(&away).component_div(&diagonal).sum();
            return Mat3::from_diagonal(&diagonal) - away * away.transpose() * ((1.0 - grows) / compliance);
        }
        let across = Vec3::x().cross(&along);
        let onset = self.law.tensile_strength / self.stiffness[0] + self.law.cohesion / self.stiffness[1];
        let step = DIFFERENCE * (jump.norm() + onset).max(f64::MIN_POSITIVE.sqrt());
        let normal = Vec3::x() * if jump.x < 0.0 { -1.0 } else { 1.0 };
        let by_normal = (at(jump + normal * step) - here) * (normal.x / step);
        let by_slip = (at(jump + along * step) - here) / step;
        let rubs = if by_normal.x > 0.0 { by_normal.dot(&along) / by_normal.x } else { 0.0 };
        let cone = Vec3::x() + along * rubs;
        cone * cone.transpose() * by_normal.x
            + along * along.transpose() * by_slip.dot(&along)
            + across * across.transpose() * secant[1]
    }

    /// How the traction changes with the jump [Pa/m], rows and columns: normal, two directions across. By differences, away from zero: towards further
    /// softening, and of faces that just touch towards their opening.
    ///
    /// - `state`: the history that [`SpringInterface::load`] takes at `jump`
    #[inline]
    pub fn jacobian(&self, jump: &Vec3, state: &InterfaceState) -> Mat3 {
        let at = |jump: Vec3| self.load(jump, &mut state.clone()).traction();
        let jump = &self.past_onset(jump, state);
        let here = at(*jump);
        let onset = self.law.tensile_strength / self.stiffness[0] + self.law.cohesion / self.stiffness[1];
        let step = DIFFERENCE * (jump.norm() + onset).max(f64::MIN_POSITIVE.sqrt());
        let column = |axis: usize| {
            let step = if jump[axis] < 0.0 { -step } else { step };
            let mut moved = *jump;
            moved[axis] += step;
            (at(moved) - here) / step
        };
        Mat3::from_columns(&[0, 1, 2].map(column))
    }

    /// What opens and stands at its onset, as all that softened in the last step does, softens on: a jump just past it.
    #[inline]
    fn past_onset(&self, jump: &Vec3, state: &InterfaceState) -> Vec3 {
        let stands = |standing: Standing| (standing.ratio / standing.onset - 1.0).abs() <= DIFFERENCE;
        let is_there = jump.x >= 0.0 && self.standing(jump, state).is_some_and(stands);
        if is_there { jump * (1.0 + 2.0 * DIFFERENCE) } else { *jump }
    }

    /// Lets the strength go down where the jump asks for it.
    #[inline]
    fn soften(&self, jump: &Vec3, pressure: f64, state: &mut InterfaceState) {
        for _ in 0..LOOKS {
            let before = state.residual;
            let worn = tangential(&Vec3::new(0.0, state.slip[0], state.slip[1]));
            let friction = self.law.friction_at(before, pressure, worn);
            let Some(Loading { ratio, end }) = self.loading(jump, friction * pressure) else { return };
            let residual = match self.law.softening {
                InterfaceSoftening::Linear => ((end - ratio) / (end - 1.0)).max(0.0),
                InterfaceSoftening::Exponential => crate::elementary::exp((1.0 - ratio) / (end - 0.5)),
            };
            state.secant = state.secant.min(residual / ratio);
            state.residual = before.min(residual);
            if pressure == 0.0 || before - state.residual <= ROUNDING {
                return;
            }
        }
    }

    /// Where a jump lies between onset and end; none below the onset.
    ///
    /// - `rubs`: friction that helps against sliding [Pa]
    #[inline]
    fn loading(&self, jump: &Vec3, rubs: f64) -> Option<Loading> {
        let asked = self.asked(jump, rubs);
        if asked.square <= 1.0 { None } else { Some(self.on_curve(&asked)) }
    }

    /// What a jump asks of the strength.
    #[inline]
    fn asked(&self, jump: &Vec3, rubs: f64) -> Asked {
        let (law, [normal, across]) = (&self.law, self.stiffness);
        let opens = normal * jump.x.max(0.0);
        let slides = (across * tangential(jump) - rubs).max(0.0);
        let [first, second] = [opens / law.tensile_strength, slides / law.cohesion];
        Asked { opens, slides, square: first * first + second * second }
    }

    /// Gradient of half of the square that is asked [1/m].
    ///
    /// - `along`: direction of the slip
    #[inline]
    fn away(&self, asked: &Asked, along: &Vec3) -> Vec3 {
        let (law, [normal, across]) = (&self.law, self.stiffness);
        Vec3::x() * (asked.opens * normal / (law.tensile_strength * law.tensile_strength))
            + along * (asked.slides * across / (law.cohesion * law.cohesion))
    }

    /// Onset and end of the mode in which something is asked.
    #[inline]
    fn on_curve(&self, asked: &Asked) -> Loading {
        let (law, [normal, across]) = (&self.law, self.stiffness);
        let Asked { opens, slides, square } = *asked;
        let [opening, sliding] = [opens * opens / (normal * square), slides * slides / (across * square)];
        let energy = law.energy(sliding / (opening + sliding)) / (opening + sliding);
        let end = match law.softening {
            InterfaceSoftening::Linear => (2.0 * energy).max(LEAST_RATIO),
            InterfaceSoftening::Exponential => energy.max(0.5 * LEAST_RATIO),
        };
        Loading { ratio: square.sqrt(), end }
    }

    /// Where a jump stands on the softening curve of its mode; none where no strength is left, or nothing is asked of it.
    #[inline]
    pub fn standing(&self, jump: &Vec3, state: &InterfaceState) -> Option<Standing> {
        if state.secant == 0.0 || state.residual == 0.0 {
            return None;
        }
        let asked = self.asked(jump, self.rubs(jump, state));
        if asked.square < f64::MIN_POSITIVE {
            return None;
        }
        let Loading { ratio, end } = self.on_curve(&asked);
        let (onset, length) = match self.law.softening {
            InterfaceSoftening::Linear => (end / (1.0 + state.secant * (end - 1.0)), end - 1.0),
            InterfaceSoftening::Exponential => (decayed_to(state.secant, end - 0.5), end - 0.5),
        };
        Some(Standing { ratio, onset, length })
    }

    /// A point whose jump goes on to a given [ratio](Standing::ratio), in the mode that it has.
    ///
    /// - `jump`, `state`: those of the last iterate and of the last equilibrium; something is asked of its strength
    #[inline]
    pub fn lead(&self, jump: &Vec3, state: &InterfaceState, ratio: f64) -> Led {
        let [normal, across] = self.stiffness;
        let rubs = self.rubs(jump, state);
        let asked = self.asked(jump, rubs);
        let factor = ratio / asked.square.sqrt();
        let slip = tangential(jump);
        let along = if slip > 0.0 { Vec3::new(0.0, jump.y, jump.z) / slip } else { Vec3::zeros() };
        let slides = if asked.slides > 0.0 { (factor * asked.slides + rubs) / across } else { slip };
        let led = along * slides + Vec3::x() * if jump.x > 0.0 { factor * jump.x } else { jump.x };
        let mut after = *state;
        let force = self.load(led, &mut after);
        let [first, second] = self.secant(&led, &force, &after);
        let away = self.away(&asked, &along).normalize();
        let secant = Mat3::from_diagonal(&Vec3::new(first, second, second));
        let held = normal.max(across) - (secant * away).dot(&away);
        Led { jump: led, traction: force.traction(), stiffness: secant + away * away.transpose() * held.max(0.0) }
    }

    /// Friction that helps against sliding [Pa].
    #[inline]
    fn rubs(&self, jump: &Vec3, state: &InterfaceState) -> f64 {
        let pressure = self.stiffness[0] * (-jump.x).max(0.0);
        let worn = tangential(&Vec3::new(0.0, state.slip[0], state.slip[1]));
        self.law.friction_at(state.residual, pressure, worn) * pressure
    }

    /// Least energy over that which the interface stores up to its strength, over all modes: softening snaps back where it is 1 or less.
    pub fn least_ductility(&self) -> f64 {
        let (law, [normal, across]) = (&self.law, self.stiffness);
        if !law.is_bonded() {
            return f64::INFINITY;
        }
        let of_mode = |step: u32| {
            let share = f64::from(step) / 64.0;
            let opening = (1.0 - share) * law.tensile_strength * law.tensile_strength / normal;
            let sliding = share * law.cohesion * law.cohesion / across;
            2.0 * law.energy(sliding / (opening + sliding)) / (opening + sliding)
        };
        (0..=64).map(of_mode).fold(f64::INFINITY, f64::min)
    }
}
