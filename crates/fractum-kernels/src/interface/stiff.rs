use super::{InterfaceForce, InterfaceLaw, InterfaceState, tangential};
use crate::Vec3;
use crate::contact::slip_to_cone;
#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;

/// Traction over weighted jump of an interface that has just given way [m²/J]: as good as none.
const JUST_OPENED: f64 = 1e200;
/// Stiffness over that of inertia below which a traction is taken at the present jump.
const SOFT: f64 = 0.25;
/// Steps of Newton's method, and the change that is rounding.
const STEPS: usize = 60;
const ROUNDING: f64 = 1e-15;

/// The jump of a point without its own traction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeJump {
    /// At tⁿ [m]: opening, then slip along two directions.
    pub now: Vec3,
    /// At tⁿ⁺¹, if the point had no traction [m].
    pub ahead: Vec3,
    /// Traction that changes the jump at tⁿ⁺¹ by one metre [Pa/m], along each direction.
    pub inertia: Vec3,
}

/// Traction at tⁿ of an interface without a stiffness. Until its strength is met it leaves no jump at tⁿ⁺¹. Then it softens with the jump at
/// tⁿ: on the ellipse of the stresses, with the energy of the mode (Camacho and Ortiz 1996). Closed sides do not pass through each other,
/// and rub. Softening and limits are those of tⁿ, and what holds is found for tⁿ⁺¹ by inertia: no stiffness enters the stable step.
#[inline]
pub fn stiff_traction(law: &InterfaceLaw, free: &FreeJump, state: &mut InterfaceState) -> InterfaceForce {
    let stored = advance(law, &free.now, state);
    let opens = law.dilated(if state.residual < 1.0 { tangential(&free.now) } else { 0.0 });
    let [weight, across] = [law.tensile_strength * law.tensile_strength, law.cohesion * law.cohesion];
    let least = free.inertia.x.min(free.inertia.y).min(free.inertia.z);
    let is_soft = state.secant * weight.max(across) < SOFT * least;
    let pulls = if is_soft { state.secant * weight * free.now.x.max(0.0) } else { 0.0 };
    if free.ahead.x - pulls / free.inertia.x >= opens {
        return InterfaceForce { cohesive: pull(law, free, state), stored, ..InterfaceForce::default() };
    }
    // Closed.
    let contact = pulls + free.inertia.x * (opens - free.ahead.x);
    let friction = law.friction_at(state.residual, contact, tangential(&free.now)) * contact;
    let flat = |v: Vec3| Vec3::new(0.0, v.y, v.z);
    let (now, ahead) = (flat(free.now), flat(free.ahead));
    let inertia = free.inertia.y.min(free.inertia.z);
    let cohesion = law.cohesion * state.residual;
    if state.secant == f64::INFINITY {
        let needed = ahead.component_mul(&flat(free.inertia));
        let size = needed.norm();
        let mut cohesive = needed;
        let mut rubs = Vec3::zeros();
        if size > cohesion + friction {
            (cohesive, rubs) = (needed * (cohesion / size), needed * (friction / size));
            state.secant = JUST_OPENED;
        }
        return InterfaceForce { cohesive: cohesive + Vec3::new(pulls, 0.0, 0.0), friction: rubs, contact, stored };
    }
    let stiffness = state.secant * across;
    let held = now * stiffness;
    let held = slip_to_cone(held, held.norm(), cohesion);
    let needed = (ahead - now).component_mul(&flat(free.inertia)) - held;
    let rubs = slip_to_cone(needed, needed.norm(), friction);
    let cohesive = if rubs == needed || is_soft {
        held
    } else {
        let rest = ahead - rubs / inertia;
        let trial = rest / (1.0 / inertia + 1.0 / stiffness.max(f64::MIN_POSITIVE));
        slip_to_cone(trial, trial.norm(), cohesion)
    };
    InterfaceForce { cohesive: cohesive + Vec3::new(pulls, 0.0, 0.0), friction: rubs, contact, stored }
}

/// Lets the strength go down with the jump; the energy stored [J/m²].
#[inline]
fn advance(law: &InterfaceLaw, now: &Vec3, state: &mut InterfaceState) -> f64 {
    if state.secant == f64::INFINITY || state.secant == 0.0 {
        return 0.0;
    }
    let [opens, slides] = [law.tensile_strength * now.x.max(0.0), law.cohesion * tangential(now)];
    let square = opens * opens + slides * slides;
    let spent = square.sqrt();
    if spent <= 1.0 / JUST_OPENED {
        return 0.0;
    }
    let left = law.left(spent, law.energy(slides * slides / square));
    state.secant = state.secant.min(left / spent);
    state.residual = state.residual.min(left);
    0.5 * state.secant * square
}

/// Traction of an open interface, or of one that is whole.
#[inline]
fn pull(law: &InterfaceLaw, free: &FreeJump, state: &mut InterfaceState) -> Vec3 {
    if state.secant == 0.0 {
        return Vec3::zeros();
    }
    let [normal, across] = [law.tensile_strength * law.tensile_strength, law.cohesion * law.cohesion];
    let weight = Vec3::new(normal, across, across);
    let least = free.inertia.x.min(free.inertia.y).min(free.inertia.z);
    if state.secant * normal.max(across) < SOFT * least {
        let jump = Vec3::new(free.now.x.max(0.0), free.now.y, free.now.z);
        return weight.component_mul(&jump) * state.secant;
    }
    // t = a / (1/k + z/w): z is the weighted jump over the traction.
    let at = |z: f64| {
        let part = |a: f64, k: f64, w: f64| a / (1.0 / k + z / w);
        let (a, k) = (free.ahead, free.inertia);
        Vec3::new(part(a.x, k.x, normal), part(a.y, k.y, across), part(a.z, k.z, across))
    };
    let square = |t: &Vec3| t.x * t.x / normal + (t.y * t.y + t.z * t.z) / across;
    let mut z = if state.secant == f64::INFINITY { 0.0 } else { 1.0 / state.secant };
    let mut traction = at(z);
    let limit = state.residual;
    if square(&traction) <= limit * limit {
        return traction;
    }
    if limit == 0.0 {
        return Vec3::zeros();
    }
    if state.secant == f64::INFINITY {
        state.secant = JUST_OPENED;
    }
    // On the ellipse: Newton's method on 1/size, which is nearly straight in z.
    for _ in 0..STEPS {
        let size = square(&traction).sqrt();
        let slope = |t: f64, k: f64, w: f64| t * t / (w * w * (1.0 / k + z / w));
        let falls = slope(traction.x, free.inertia.x, normal)
            + slope(traction.y, free.inertia.y, across)
            + slope(traction.z, free.inertia.z, across);
        let change = (size / limit - 1.0) * size * size / falls;
        z += change;
        traction = at(z);
        if change <= ROUNDING * z {
            break;
        }
    }
    let size = square(&traction).sqrt();
    if size > limit { traction * (limit / size) } else { traction }
}
