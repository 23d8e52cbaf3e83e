//! Properties of interfaces between elements.

use fractum_kernels::interface::{
    FreeJump, InterfaceForce, InterfaceLaw, InterfaceSoftening, InterfaceState, MixedMode, Roughness, SpringInterface,
    stiff_traction,
};
use fractum_kernels::{Mat3, Vec3};

use super::draw::{Draw, Held, hold};

/// Any law that a case may give.
fn law(draw: &mut Draw) -> InterfaceLaw {
    let strength = draw.over_decades(1e3, 1e9);
    let residual = draw.between(0.0, 1.2);
    InterfaceLaw {
        tensile_strength: strength,
        cohesion: strength * draw.over_decades(0.1, 20.0),
        opening_energy: draw.over_decades(1e-1, 1e4),
        sliding_energy: 0.0,
        friction: residual + draw.between(-0.5, 0.5).max(0.0),
        residual_friction: residual,
        dilation: residual * draw.between(-0.5, 0.5).max(0.0),
        dilation_slip: 0.0,
        mixed_mode: draw.one_of(&[
            MixedMode::Power(1.0),
            MixedMode::Power(2.0),
            MixedMode::BenzeggaghKenane(1.0),
            MixedMode::BenzeggaghKenane(2.3),
        ]),
        softening: draw.one_of(&[InterfaceSoftening::Linear, InterfaceSoftening::Exponential]),
        roughness: None,
    }
    .with_energies(draw)
}

trait WithEnergies {
    fn with_energies(self, draw: &mut Draw) -> Self;
    /// Opening and slip that break it, and length over which asperities rise [m].
    fn last(&self) -> [f64; 2];
}

impl WithEnergies for InterfaceLaw {
    fn with_energies(mut self, draw: &mut Draw) -> Self {
        self.sliding_energy = self.opening_energy * draw.over_decades(0.2, 20.0);
        self.dilation_slip = self.last()[1] * draw.over_decades(0.1, 3.0);
        self
    }

    fn last(&self) -> [f64; 2] {
        [2.0 * self.opening_energy / self.tensile_strength, 2.0 * self.sliding_energy / self.cohesion]
    }
}

/// Stiffness above which no mode snaps back, up to a thousand times it.
fn with_stiffness(draw: &mut Draw, law: InterfaceLaw) -> SpringInterface {
    let stiff = draw.over_decades(3.0, 1e3);
    let [opening, slip] = law.last();
    let stiffness = [law.tensile_strength / opening, law.cohesion / slip].map(|least| least * stiff);
    let mut found = SpringInterface { law, stiffness };
    while found.least_ductility() < 2.0 {
        found.stiffness = found.stiffness.map(|stiffness| 2.0 * stiffness);
    }
    found
}

/// Work, and what the parts of it come to.
#[derive(Default)]
struct Account {
    work: f64,
    stored: f64,
    friction: f64,
    before: Option<(Vec3, InterfaceForce)>,
}

impl Account {
    /// Returns what the step takes [J/m²].
    fn step(&mut self, jump: Vec3, force: InterfaceForce) -> f64 {
        let mut taken = 0.0;
        if let Some((was, old)) = self.before {
            let way = jump - was;
            let work = 0.5 * (old.traction() + force.traction()).dot(&way);
            let friction = 0.5 * (old.friction + force.friction).dot(&way);
            taken = work - (force.stored - self.stored);
            (self.work, self.friction) = (self.work + work, self.friction + friction);
        }
        self.stored = force.stored;
        self.before = Some((jump, force));
        taken
    }
}

/// A direction of opening and slip with the share of sliding that the law sees in it.
fn direction(draw: &mut Draw, scale: [f64; 2]) -> Vec3 {
    let (angle, turn) = (draw.between(0.0, 0.5 * std::f64::consts::PI), draw.between(0.0, 6.3));
    let angle = draw.one_of(&[0.0, 0.5 * std::f64::consts::PI, angle, angle, angle]);
    Vec3::new(scale[0] * angle.cos(), scale[1] * angle.sin() * turn.cos(), scale[1] * angle.sin() * turn.sin())
}

const STEPS: u32 = 6000;

fn flat(v: &Vec3) -> f64 {
    v.yz().norm()
}

/// Opened and slid along a straight way: the stress ellipse is met, and the energy of the mode is spent.
pub(crate) fn spring_proportional(draw: &mut Draw) -> Held {
    let law = InterfaceLaw { dilation: 0.0, ..law(draw) };
    let interface = with_stiffness(draw, law);
    let along = direction(draw, law.last());
    let [normal, across] = interface.stiffness;
    let [opening, sliding] = [normal * along.x * along.x, across * flat(&along).powi(2)];
    let share = sliding / (opening + sliding);
    let onset = (normal * along.x / law.tensile_strength).hypot(across * flat(&along) / law.cohesion).recip();
    let energy = law.energy(share);
    let first = 0.5 * (opening + sliding) * onset * onset;
    let last = onset
        * match law.softening {
            InterfaceSoftening::Linear => energy / first,
            InterfaceSoftening::Exponential => 1.0 + 40.0 * (energy / (2.0 * first) - 0.5),
        };
    let (mut state, mut account, mut largest) = (law.intact(false), Account::default(), 0.0f64);
    // Steps meet the onset.
    let elastic = (STEPS as f64 * (onset / last).sqrt()).ceil();
    let ways = (0..=elastic as u32).map(|step| onset * f64::from(step) / elastic);
    let ways =
        ways.chain((1..=STEPS).map(|step| onset + (last - onset) * (f64::from(step) / f64::from(STEPS)).powi(2)));
    for way in ways {
        let force = interface.load(along * way, &mut state);
        let traction = force.traction();
        largest = largest.max((traction.x / law.tensile_strength).hypot(flat(&traction) / law.cohesion));
        account.step(along * way, force);
    }
    hold((largest - 1.0).abs() < 1e-6, || format!("reaches {largest} of its strength"))?;
    let spent = account.work - account.stored;
    hold((spent / energy - 1.0).abs() < 1e-6, || format!("spends {spent} of {energy} J/m², share {share}"))
}

/// Both tangents along a straight way: elastic before the onset, the slope of the softening beyond it, and the way back to zero. The symmetric one takes the stress on
/// the ellipse as far down as the whole one, and has no other direction in which it falls.
pub(crate) fn spring_tangent(draw: &mut Draw) -> Held {
    let law = InterfaceLaw { dilation: 0.0, ..law(draw) };
    let interface = with_stiffness(draw, law);
    let along = direction(draw, law.last());
    let [normal, across] = interface.stiffness;
    let [opening, sliding] = [normal * along.x * along.x, across * flat(&along).powi(2)];
    let elastic = opening + sliding;
    let onset = (normal * along.x / law.tensile_strength).hypot(across * flat(&along) / law.cohesion).recip();
    // Energy over that at the onset.
    let ductility = law.energy(sliding / elastic) / (0.5 * elastic * onset * onset);
    let share = draw.between(0.05, 0.95);
    let state = law.intact(false);
    let at = |way: f64, state: &InterfaceState| {
        let (jump, mut after) = (along * way, *state);
        let force = interface.load(jump, &mut after);
        let secant = interface.secant(&jump, &force, &after);
        (interface.tangent(&jump, state, secant), interface.jacobian(&jump, state), secant, after)
    };
    let slope = |matrix: &Mat3| along.dot(&(matrix * along));
    let (symmetric, whole, ..) = at(share * onset, &state);
    for before in [symmetric, whole].map(|matrix| slope(&matrix)) {
        hold((before / elastic - 1.0).abs() < 1e-5, || format!("{before} for {elastic} Pa/m before the onset"))?;
    }
    let (way, expected) = match law.softening {
        InterfaceSoftening::Linear => (1.0 + share * (ductility - 1.0), -1.0 / (ductility - 1.0)),
        InterfaceSoftening::Exponential => {
            let scale = 0.5 * (ductility - 1.0);
            (1.0 + share * scale, -(-share).exp() / scale)
        }
    };
    let (symmetric, whole, secant, after) = at(way * onset, &state);
    let found = slope(&whole);
    hold((found / elastic - expected).abs() < 1e-3 * expected.abs(), || {
        format!("{found} for {} Pa/m, {law:?}", expected * elastic)
    })?;
    let [first, second] = [normal / law.tensile_strength, across / law.cohesion].map(|k| k * k);
    let away = Vec3::new(first * along.x, second * along.y, second * along.z);
    let pull = away.component_div(&Vec3::new(secant[0], secant[1], secant[1]));
    let down = pull.dot(&(symmetric * along)) / away.dot(&along) * after.secant;
    hold((down - expected).abs() < 1e-4 * expected.abs(), || format!("{down} for {expected}, {law:?}"))?;
    let falls = symmetric.symmetric_eigenvalues().iter().filter(|value| **value < 0.0).count();
    hold(falls == 1 && symmetric == symmetric.transpose(), || format!("{symmetric} in {falls} directions"))?;
    let (symmetric, whole, ..) = at(0.5 * way * onset, &after);
    let secant = after.secant * elastic;
    for back in [symmetric, whole].map(|matrix| slope(&matrix)) {
        hold((back / secant - 1.0).abs() < 1e-5, || format!("{back} for {secant} Pa/m on the way back"))?;
    }
    Ok(())
}

/// Strengths and stiffnesses in the same ratio: opened and slid along any straight way it bears what one without a stiffness does, t = χ (f_t² δ_n, c² δ_s)/λ.
pub(crate) fn spring_as_stiff(draw: &mut Draw) -> Held {
    let law = InterfaceLaw { dilation: 0.0, ..law(draw) };
    let squares = [law.tensile_strength, law.cohesion].map(|strength| strength * strength);
    let stiff = draw.over_decades(1e3, 1e5) / law.opening_energy.min(law.sliding_energy);
    let interface = SpringInterface { law, stiffness: squares.map(|square| square * stiff) };
    let along = direction(draw, law.last());
    let weighted = Vec3::new(squares[0] * along.x, squares[1] * along.y, squares[1] * along.z);
    let spent = weighted.dot(&along).sqrt();
    let sliding = squares[1] * flat(&along).powi(2) / (spent * spent);
    let energy = law.energy(sliding);
    let way = draw.between(0.05, 0.95) * 2.0 * energy / spent;
    let left = match law.softening {
        InterfaceSoftening::Linear => 1.0 - 0.5 * spent * way / energy,
        InterfaceSoftening::Exponential => (-spent * way / energy).exp(),
    };
    let expected = weighted * (left / spent);
    let found = interface.load(along * way, &mut law.intact(false)).traction();
    let over = |v: Vec3| (v.x / law.tensile_strength).hypot(flat(&v) / law.cohesion);
    hold(over(found - expected) < 1e-3, || format!("{found} for {expected}, {law:?}"))
}

/// Led down its curve in one mode, from any state on it, also by a longer or shorter jump than that: it stands where it was led to and softens from there, and its traction is that of the law.
pub(crate) fn spring_led(draw: &mut Draw) -> Held {
    let law = InterfaceLaw { dilation: 0.0, ..law(draw) };
    let interface = with_stiffness(draw, law);
    let along = direction(draw, law.last());
    let mut state = law.intact(false);
    let onset = interface.standing(&along, &state).map_or(f64::NAN, |standing| standing.ratio).recip();
    for _ in 0..8 {
        let Some(before) = interface.standing(&(along * onset), &state) else { return Ok(()) };
        hold((before.ratio - 1.0).abs() < 1e-12, || format!("{before:?} at the strength"))?;
        let ratio = before.onset + draw.between(0.01, 0.3) * before.onset.max(before.length);
        let far = draw.over_decades(0.1, 10.0);
        let led = interface.lead(&(along * (onset * far)), &state, ratio);
        let error = (led.jump - along * (onset * ratio)).norm() / led.jump.norm();
        hold(error < 1e-12, || format!("led past by {error}"))?;
        let force = interface.load(led.jump, &mut state);
        let error = (force.traction() - led.traction).norm();
        hold(error <= 1e-9 * law.tensile_strength, || format!("{:?} for {:?}", led.traction, force.traction()))?;
        let pivots = led.stiffness.symmetric_eigenvalues();
        hold(pivots.min() >= -1e-12 * pivots.max(), || format!("{pivots:?} of its stiffness"))?;
        let Some(after) = interface.standing(&led.jump, &state) else { return Ok(()) };
        let at = ratio / after.onset - 1.0;
        hold(at.abs() < 1e-9 && (after.ratio / ratio - 1.0).abs() < 1e-9, || {
            format!("stands at {after:?}, led to {ratio}")
        })?;
    }
    Ok(())
}

/// A way that opens, closes and slides for- and backwards.
fn any_way(draw: &mut Draw, scale: [f64; 2], steps: u32) -> Vec<Vec3> {
    let knots: Vec<Vec3> = (0..12)
        .map(|_| {
            let v = draw.vector();
            Vec3::new(scale[0] * (v.x + 0.3), scale[1] * v.y, scale[1] * v.z)
        })
        .collect();
    let mut ways = vec![Vec3::zeros()];
    let mut from = Vec3::zeros();
    for to in knots {
        ways.extend((1..=steps).map(|step| from + (to - from) * (f64::from(step) / f64::from(steps))));
        from = to;
    }
    ways
}

/// Parts of a step that is looked at closely.
const PARTS: u32 = 256;

/// Whatever the way: nothing is given back that was taken, the strength only falls, friction stays within its cone, and turned axes in
/// the face change nothing.
pub(crate) fn spring_any_way(draw: &mut Draw) -> Held {
    let law = InterfaceLaw { dilation: 0.0, ..law(draw) };
    let interface = with_stiffness(draw, law);
    let size = draw.over_decades(0.01, 1.0);
    let [opening, slip] = law.last();
    let (mut state, mut account, mut residual) = (law.intact(false), Account::default(), 1.0);
    let (sine, cosine) = draw.between(-3.0, 3.0).sin_cos();
    let turn = |v: &Vec3| Vec3::new(v.x, cosine * v.y - sine * v.z, sine * v.y + cosine * v.z);
    let mut turned = law.intact(false);
    let mut scale = 0.0f64;
    let mut was = Vec3::zeros();
    for jump in any_way(draw, [size * opening, size * slip], 2000) {
        let before = state;
        let force = interface.load(jump, &mut state);
        scale = scale.max(force.stored);
        hold(state.residual <= residual, || "the strength grows".to_owned())?;
        residual = state.residual;
        let cone = law.friction * force.contact;
        hold(force.friction.norm() <= cone * (1.0 + 1e-9), || format!("rubs with {force:?} under {cone}"))?;
        let other = interface.load(turn(&jump), &mut turned).traction();
        let apart = (turn(&force.traction()) - other).norm();
        hold(apart <= 1e-9 * (1.0 + law.cohesion), || format!("turned axes change {apart} Pa"))?;
        let mut taken = account.step(jump, force);
        if taken < -1e-5 * scale {
            // Where sides part or meet within the step, its forces at both ends are no mean.
            let (mut state, mut finer) = (before, Account::default());
            let parts = (0..=PARTS).map(|part| was + (jump - was) * (f64::from(part) / f64::from(PARTS)));
            taken = parts.map(|jump| finer.step(jump, interface.load(jump, &mut state))).sum();
        }
        hold(taken >= -1e-5 * scale, || format!("gives {} of {scale} J/m² back", -taken))?;
        was = jump;
    }
    Ok(())
}

/// Slid under a constant pressure, to and fro: peak c + μ p, residual μ_r p, G_II above the friction of the end, and dilation.
pub(crate) fn spring_sliding(draw: &mut Draw) -> Held {
    let law = law(draw);
    let interface = with_stiffness(draw, law);
    let [normal, across] = interface.stiffness;
    let pressure = law.cohesion * draw.over_decades(0.01, 10.0);
    let last = law.last()[1] * 40.0 + 2.0 * (law.cohesion + law.friction * pressure) / across;
    let mut state = law.intact(false);
    let (mut peak, mut rise) = (0.0f64, -pressure / normal);
    let steps = 4 * STEPS;
    for step in 0..=steps {
        let slip = last * (f64::from(step) / f64::from(steps)).powi(2);
        // The opening under which the pressure is the given one.
        let mut force = InterfaceForce::default();
        let (start, mut tried) = (state, state);
        for _ in 0..200 {
            tried = start;
            force = interface.load(Vec3::new(rise, slip, 0.0), &mut tried);
            let change = (-force.traction().x - pressure) / normal;
            rise += change;
            if change.abs() < 1e-14 * (pressure / normal + rise.abs()) {
                break;
            }
        }
        state = tried;
        peak = peak.max(force.traction().y);
        if step == steps {
            let residual = force.traction().y / (law.residual_friction * pressure).max(1e-6 * law.cohesion);
            hold(law.residual_friction == 0.0 || (residual - 1.0).abs() < 1e-6, || format!("residual {residual}"))?;
        }
    }
    // Asperities that rise before the onset press more.
    let expected = law.cohesion + law.friction * pressure;
    hold(law.dilation > 0.0 || (peak / expected - 1.0).abs() < 1e-3, || format!("peak {peak} of {expected} Pa"))?;
    let opened = rise + pressure / normal;
    let asked = law.dilated(state.slip[0]);
    hold((opened - asked).abs() <= 1e-6 * (asked + pressure / normal), || format!("opens {opened} of {asked} m"))
}

/// Leads a stiff interface along a way; inertia is that of a step.
struct Led {
    law: InterfaceLaw,
    inertia: f64,
    state: InterfaceState,
    account: Account,
}

impl Led {
    /// - `now`, `next`: jumps; `force`: what the driver holds it with
    fn step(&mut self, now: Vec3, next: Vec3, force: Vec3) -> InterfaceForce {
        let inertia = Vec3::repeat(self.inertia);
        let found =
            stiff_traction(&self.law, &FreeJump { now, ahead: next + force / self.inertia, inertia }, &mut self.state);
        self.account.step(now, found);
        found
    }
}

/// Traction of a whole point holds it in place; past the strength it goes down a straight way with the energy of the mode.
pub(crate) fn stiff_proportional(draw: &mut Draw) -> Held {
    let law = InterfaceLaw { dilation: 0.0, ..law(draw) };
    let along = direction(draw, law.last());
    let weights = Vec3::new(law.tensile_strength.powi(2), law.cohesion.powi(2), law.cohesion.powi(2));
    let spends = weights.component_mul(&along).dot(&along).sqrt();
    let share = weights.y * flat(&along).powi(2) / (spends * spends);
    let energy = law.energy(share);
    let last = match law.softening {
        InterfaceSoftening::Linear => 2.0 * energy / spends,
        InterfaceSoftening::Exponential => 40.0 * energy / spends,
    };
    let inertia = 1e3 * law.tensile_strength.max(law.cohesion) / (last * along.norm());
    let mut led = Led { law, inertia, state: law.intact(true), account: Account::default() };
    let strength = weights.component_mul(&along) / spends;
    // Below the strength it holds.
    let held = led.step(Vec3::zeros(), Vec3::zeros(), strength * 0.999).traction();
    hold((held - strength * 0.999).norm() < 1e-9 * strength.norm(), || format!("holds with {held:?}"))?;
    hold(led.state.residual == 1.0, || "is broken below its strength".to_owned())?;
    led.account = Account::default();
    let place = |step: u32| along * (last * (f64::from(step) / f64::from(STEPS)).powi(2));
    for step in 0..=STEPS {
        let spent = place(step).norm() / along.norm() * spends;
        let left = match law.softening {
            InterfaceSoftening::Linear => (1.0 - 0.5 * spent / energy).max(0.0),
            InterfaceSoftening::Exponential => (-spent / energy).exp(),
        };
        let expected = strength * left;
        let force = led.step(place(step), place(step + 1), expected).traction();
        hold((force - expected).norm() < 1e-6 * strength.norm(), || {
            format!("step {step}: {force:?} for {expected:?}")
        })?;
    }
    let spent = led.account.work - led.account.stored;
    hold((spent / energy - 1.0).abs() < 1e-6, || format!("spends {spent} of {energy} J/m²"))
}

/// A point between two masses that a driver pulls anywhere: the sides never pass through each other by more than rounding, the strength
/// only falls, and in all of the way energy is taken.
pub(crate) fn stiff_any_way(draw: &mut Draw) -> Held {
    let law = InterfaceLaw { dilation: 0.0, ..law(draw) };
    let [opening, slip] = law.last();
    let size = draw.over_decades(0.05, 2.0);
    let ways = any_way(draw, [size * opening, size * slip], 1000);
    let weights = [law.tensile_strength / opening, law.cohesion / slip];
    let driver = weights[0].max(weights[1]) * draw.over_decades(2.0, 20.0);
    // A driving spring in 30 steps per period.
    let inertia = driver * 25.0;
    let mut led = Led { law, inertia, state: law.intact(true), account: Account::default() };
    // What rounding leaves of a point that holds is no energy.
    let (mut now, mut rate, mut residual, mut largest) = (Vec3::zeros(), Vec3::zeros(), 1.0, 1e-9 * law.opening_energy);
    for way in ways {
        let pull = (way - now) * driver - rate * (0.3 * inertia);
        let free = FreeJump { now, ahead: now + rate + pull / inertia, inertia: Vec3::repeat(inertia) };
        let force = stiff_traction(&law, &free, &mut led.state);
        hold(led.state.residual <= residual, || "the strength grows".to_owned())?;
        residual = led.state.residual;
        led.account.step(now, force);
        largest = largest.max(led.account.work.abs());
        rate += (pull - force.traction()) / inertia;
        now += rate;
        hold(now.x > -1e-9 * opening, || format!("sides pass by {} m", -now.x))?;
        let taken = led.account.work - led.account.stored;
        hold(taken >= -1e-2 * largest, || format!("gives {taken} of {largest} J/m² back"))?;
    }
    Ok(())
}

/// Under pressure a stiff interface holds up to c + μ p, and rubs with μ_r p in the end.
pub(crate) fn stiff_sliding(draw: &mut Draw) -> Held {
    let law = InterfaceLaw { dilation: 0.0, ..law(draw) };
    let pressure = law.cohesion * draw.over_decades(0.01, 10.0);
    let last = 40.0 * law.last()[1];
    let strength = law.cohesion + law.friction * pressure;
    let inertia = 1e4 * strength / last;
    let mut led = Led { law, inertia, state: law.intact(true), account: Account::default() };
    let pushed = |along: f64| Vec3::new(-pressure, along, 0.0);
    let held = led.step(Vec3::zeros(), Vec3::zeros(), pushed(0.9999 * strength));
    hold(led.state.residual == 1.0 && (held.traction().y / strength - 0.9999).abs() < 1e-9, || format!("{held:?}"))?;
    led.account = Account::default();
    let place = |step: u32| Vec3::new(0.0, last * (f64::from(step) / f64::from(STEPS)).powi(2), 0.0);
    let mut force = InterfaceForce::default();
    for step in 0..=STEPS {
        let left = led.state.residual;
        let guess = left * law.cohesion + law.friction_at(left, pressure, 0.0) * pressure;
        force = led.step(place(step), place(step + 1), pushed(guess));
        hold((force.contact / pressure - 1.0).abs() < 1e-9, || format!("{force:?} under {pressure}"))?;
    }
    hold((force.friction.y - law.residual_friction * pressure).abs() < 1e-6 * strength, || {
        format!("ends with {force:?}")
    })?;
    let spent = led.account.work - led.account.friction;
    hold((spent / law.sliding_energy - 1.0).abs() < 1e-3, || format!("spends {spent} of {}", law.sliding_energy))
}

/// Rough sides that were never joined: Barton's strength under any pressure, which grows with it, and its wear; with a stiffness and without.
pub(crate) fn rough_sliding(draw: &mut Draw) -> Held {
    let smooth = draw.between(10f64.to_radians().tan(), 1.0);
    let roughness = Roughness {
        coefficient: draw.between(0.1, 20.0),
        wall_strength: draw.over_decades(1e6, 3e8),
        peak_slip: draw.over_decades(1e-5, 1e-1),
    };
    let law = InterfaceLaw {
        tensile_strength: 0.0,
        cohesion: 0.0,
        friction: smooth,
        residual_friction: smooth,
        dilation: 0.0,
        roughness: Some(roughness),
        ..law(draw)
    };
    let pressure = draw.over_decades(1e2, 1e9);
    let barton = |pressure: f64, slip: f64| {
        let worn = roughness.coefficient * (roughness.peak_slip / slip).min(1.0).powf(0.381);
        let raised = worn * (roughness.wall_strength / pressure).log10().max(0.0);
        pressure * (smooth.atan().to_degrees() + raised).min(70.0).to_radians().tan().max(smooth)
    };
    let bears = |pressure: f64| law.friction_at(0.0, pressure, 0.0) * pressure;
    hold((bears(pressure) / barton(pressure, 0.0) - 1.0).abs() < 1e-9, || format!("bears {}", bears(pressure)))?;
    hold(bears(1.01 * pressure) > bears(pressure), || format!("falls as the pressure grows from {pressure}"))?;
    let stiffness = pressure / roughness.peak_slip * draw.over_decades(10.0, 1e4);
    let interface = SpringInterface { law, stiffness: [stiffness; 2] };
    let mut state = law.intact(false);
    let mut led = Led { law, inertia: stiffness, state: law.intact(true), account: Account::default() };
    let slip_of = |step: u32| 30.0 * roughness.peak_slip * (f64::from(step) / f64::from(STEPS)).powi(2);
    let mut before = 0.0;
    for step in 0..=STEPS {
        let slip = slip_of(step);
        let worn = state.slip[0].abs();
        let force = interface.load(Vec3::new(-pressure / stiffness, slip, 0.0), &mut state).traction();
        let expected = barton(pressure, worn);
        let slides = state.slip[0] > worn + 1e-9 * slip;
        hold(!slides || (force.y / expected - 1.0).abs() < 1e-6, || format!("{} of {expected} Pa at {slip}", force.y))?;
        let stays = state.slip[0] >= before - 1e-9 * slip;
        hold(stays && force.y <= expected * (1.0 + 1e-6), || format!("{} Pa at {slip}", force.y))?;
        let pushed = Vec3::new(-pressure, 2.0 * barton(pressure, 0.0), 0.0);
        let stiff = led.step(Vec3::new(0.0, slip, 0.0), Vec3::new(0.0, slip_of(step + 1), 0.0), pushed);
        let expected = barton(stiff.contact, slip);
        hold((stiff.friction.y / expected - 1.0).abs() < 1e-6, || format!("{stiff:?} of {expected} Pa at {slip}"))?;
        before = state.slip[0];
    }
    Ok(())
}
