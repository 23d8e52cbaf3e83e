//! Properties of contacts, and of the restitution that their damping gives.

use std::f64::consts::PI;

use fractum_kernels::contact::{
    ContactForce, ContactLaw, ContactParameters, ElasticMaterial, Hertz, Linear, MaterialPair, PairMotion,
    damping_of_restitution, restitution_of_damping,
};

use super::draw::{Draw, Held, hold};

/// Friction, rolling friction (none in half of the draws) and damping.
pub(crate) fn surface(draw: &mut Draw) -> ContactParameters {
    ContactParameters {
        friction: draw.between(0.0, 1.5),
        rolling_friction: draw.between(-0.3, 0.3).max(0.0),
        damping_ratio: draw.between(0.0, 1.0),
    }
}

/// Two bodies: modulus, Poisson's ratio, radii, masses.
pub(crate) fn bodies(draw: &mut Draw) -> (f64, f64, [f64; 2], [f64; 2]) {
    let radius = draw.over_decades(1e-4, 1e1);
    let radii = [radius, radius * draw.over_decades(0.05, 20.0)];
    let density = draw.between(500.0, 8000.0);
    let masses = radii.map(|radius| 4.0 / 3.0 * PI * radius.powi(3) * density);
    (draw.over_decades(1e6, 5e11), draw.between(0.0, 0.49), radii, masses)
}

/// A law with its radius and reach of friction against rolling [m].
pub(crate) fn linear_spheres(draw: &mut Draw) -> (Linear, f64, ContactParameters) {
    let (young, nu, radii, masses) = bodies(draw);
    let surface = surface(draw);
    (Linear::between_spheres(young, nu, radii, masses, surface), radii[0].min(radii[1]), surface)
}

pub(crate) fn linear_discs(draw: &mut Draw) -> (Linear, f64, ContactParameters) {
    let (young, nu, radii, masses) = bodies(draw);
    let surface = surface(draw);
    let thickness = draw.over_decades(1e-3, 10.0);
    (Linear::between_discs(young, nu, radii, thickness, masses, surface), radii[0].min(radii[1]), surface)
}

pub(crate) fn hertz(draw: &mut Draw) -> (Hertz, f64, ContactParameters) {
    let (young, nu, radii, masses) = bodies(draw);
    let surface = surface(draw);
    let material = ElasticMaterial { young_modulus: young, poisson_ratio: nu };
    let reduced = |[a, b]: [f64; 2]| a * b / (a + b);
    let pair = MaterialPair::new([material, material], surface);
    (Hertz::new(&pair, reduced(radii), reduced(masses)), radii[0].min(radii[1]), surface)
}

/// A pair that meets, slides and rolls, and parts: it never pulls, friction stays within Coulomb's cone, nothing is given back that was
/// taken, in the end no energy is left in it, and turned axes change nothing.
///
/// - `by_remainder`: whether friction is booked as what is left of the work of mean forces
pub(crate) fn contact<L: ContactLaw>(
    draw: &mut Draw,
    (law, radius, surface): (L, f64, ContactParameters),
    by_remainder: bool,
) -> Held {
    let deepest = radius * draw.over_decades(1e-6, 1e-3);
    let turn = draw.turn();
    let normal = draw.vector().normalize();
    let across = draw.vector() * (draw.over_decades(0.01, 10.0) * deepest);
    let rolling = draw.vector() * (draw.over_decades(0.01, 10.0) * deepest / radius);
    let steps = 400;
    // One unit of time from the first approach to the parting; dampers see the duration of a natural contact.
    let (normal_stiffness, _) = law.stiffness(0.5 * deepest);
    let mass = 4.0 / 3.0 * PI * radius.powi(3) * 2000.0;
    let dt = PI * (mass / normal_stiffness).sqrt() / f64::from(steps);
    let overlap = |step: i32| deepest * (1.1 * (PI * f64::from(step) / f64::from(steps)).sin() - 0.1);
    let (mut memory, mut turned_memory) = (L::Memory::default(), L::Memory::default());
    let (mut work, mut taken, mut largest) = (0.0, 0.0, 0.0f64);
    let mut before = ContactForce::default();
    for step in 1..=steps {
        let approach = (overlap(step) - overlap(step - 1)) / dt;
        let phase = (7.0 * f64::from(step) / f64::from(steps)).sin() / (dt * f64::from(steps));
        let flat = across - normal * across.dot(&normal);
        let velocity = flat * phase - normal * approach;
        let motion = PairMotion { normal, overlap: overlap(step), velocity, spin: rolling * phase, dt };
        let force = law.force(&motion, &mut memory);
        let turned =
            PairMotion { normal: turn * normal, velocity: turn * velocity, spin: turn * motion.spin, ..motion };
        let force_turned = law.force(&turned, &mut turned_memory);

        let size = force.on_second.norm();
        let along = force.on_second.dot(&normal);
        let tangential = (force.on_second - normal * along).norm();
        hold(along >= -1e-12 * size, || format!("pulls with {along} at step {step}"))?;
        let within = tangential <= surface.friction * along * (1.0 + 1e-9) + 1e-12 * size;
        hold(within, || format!("friction {tangential} of {along} at step {step}, coefficient {}", surface.friction))?;
        let scale = force.stored.max(before.stored).max(largest);
        hold(force.stored >= 0.0, || format!("stores {}", force.stored))?;
        // A spring across or against rolling that turns over within a step, while what it can bear shrinks, has a mean force that does work
        // the other way: 1e-5 of the largest energy. The slip of linear springs takes it as none.
        let rounding = if by_remainder || surface.rolling_friction > 0.0 { 2e-5 } else { 1e-9 };
        hold(force.friction >= -rounding * scale, || {
            format!("friction gives {} of {scale} back at step {step}", force.friction)
        })?;
        let difference = (turn * force.on_second - force_turned.on_second).norm();
        hold(difference <= 1e-6 * (size + normal_stiffness * deepest), || {
            format!("turned axes change {difference} of {size}")
        })?;

        let mean = 0.5 * (before.on_second + force.on_second).dot(&velocity);
        let couple = 0.5 * (before.couple_on_second + force.couple_on_second).dot(&motion.spin);
        work -= (mean + couple) * dt;
        taken += force.friction + force.damping;
        largest = largest.max(force.stored).max(taken);
        before = force;
    }
    hold(before.stored == 0.0 && before.on_second.norm() == 0.0, || "holds energy after parting".into())?;
    hold(taken >= -1e-9 * largest, || format!("gives {taken} back"))?;
    hold((work - taken).abs() <= 0.03 * largest, || format!("took {taken} of {work}, {largest} at most"))
}

/// A pair that sticks, pressed together and pulled apart: its force is the derivative of its energy, the largest pull is that of DMT, nothing is left
/// beyond its reach, nothing is gained on the way, and friction stays within the cone of what the contact bears.
pub(crate) fn adhesion(draw: &mut Draw) -> Held {
    let (young, nu, radii, masses) = bodies(draw);
    let material = ElasticMaterial { young_modulus: young, poisson_ratio: nu };
    let reduced = |[a, b]: [f64; 2]| a * b / (a + b);
    let (radius, mass, surface) = (reduced(radii), reduced(masses), surface(draw));
    let energy = draw.over_decades(1e-3, 1e2);
    let law = Hertz::new(&MaterialPair::new([material, material], surface).sticking(energy), radius, mass);
    let pull = 2.0 * PI * energy * radius;
    hold((law.pull / pull - 1.0).abs() < 1e-12, || format!("pulls with {} for {pull}", law.pull))?;
    let reach = law.reach();
    let deepest = reach * draw.over_decades(0.01, 30.0);
    let (normal, across) = (draw.vector().normalize(), draw.vector());
    let free = Hertz { damping: 0.0, ..law };
    let still = |law: &Hertz, overlap: f64| {
        let force = law.force(&resting(normal, overlap), &mut Default::default());
        (force.on_second.dot(&normal), force.stored)
    };
    for share in [-0.99, -0.6, -0.1, 0.1, 0.7, 1.0, 3.0] {
        let (at, step) = (share * reach, 1e-6 * reach);
        let [below, above] = [at - step, at + step].map(|overlap| still(&free, overlap).1);
        let (force, slope) = (still(&free, at).0, (above - below) / (2.0 * step));
        hold((force - slope).abs() < 1e-4 * (pull + force.abs()), || format!("{force} at {share}, slope {slope}"))?;
        hold(force >= -pull * (1.0 + 1e-12), || format!("pulls with {force}"))?;
    }
    hold((still(&free, 0.0).0 / pull + 1.0).abs() < 1e-12, || "another pull at the first touch".to_owned())?;
    hold(still(&free, reach).0.abs() < 1e-9 * pull, || "no rest where the pull presses together".to_owned())?;
    hold(still(&free, -reach).1 == 0.0 && still(&free, -2.0 * reach).0 == 0.0, || "acts beyond its reach".to_owned())?;
    let steps = 2000;
    let dt = PI * (mass / law.stiffness(reach).0).sqrt() / f64::from(steps);
    let overlap = |step: i32| (deepest + 1.2 * reach) * (PI * f64::from(step) / f64::from(steps)).sin() - 1.2 * reach;
    let (mut memory, mut work, mut taken, mut largest) = (Default::default(), 0.0, 0.0, 0.0f64);
    let mut before = ContactForce::default();
    let flat = (across - normal * across.dot(&normal)) * (reach / (dt * f64::from(steps)));
    let mut last = 0.0;
    for step in 1..=steps {
        let approach = (overlap(step) - overlap(step - 1)) / dt;
        let motion =
            PairMotion { normal, overlap: overlap(step), velocity: flat - normal * approach, spin: across * 0.1, dt };
        let force = law.force(&motion, &mut memory);
        let along = force.on_second.dot(&normal);
        let held = still(&free, overlap(step)).0;
        let told = law.last_force(&memory, &normal, overlap(step));
        hold((told - force.on_second).norm() <= 1e-9 * (pull + force.on_second.norm()), || {
            format!("tells {told} for {} at step {step}", force.on_second)
        })?;
        let pulled = if overlap(step) >= 0.0 { pull } else { 0.0 };
        let tangential = (force.on_second - normal * along).norm();
        hold(tangential <= surface.friction * (along + pulled).max(0.0) * (1.0 + 1e-9) + 1e-9 * pull, || {
            format!("friction {tangential} beyond the cone at step {step}")
        })?;
        hold(along >= -pull * (1.0 + 1e-9) && held.is_finite(), || format!("pulls with {along} at step {step}"))?;
        hold(force.damping >= -1e-6 * largest, || format!("damping gives {}", force.damping))?;
        work -= 0.5 * (before.on_second + force.on_second).dot(&motion.velocity) * dt;
        work -= 0.5 * (before.couple_on_second + force.couple_on_second).dot(&motion.spin) * dt;
        taken += force.friction + force.damping;
        largest = largest.max(work.abs()).max(force.stored.abs());
        (before, last) = (force, force.stored);
    }
    hold(last == 0.0, || format!("{last} J are left"))?;
    hold((work - taken).abs() < 0.02 * largest, || format!("work {work}, taken {taken}, largest {largest}"))?;
    // A pair whose overlap was taken as it stands is at its first touch there, until it has parted.
    let (mut memory, found) = (Default::default(), 3.0 * reach);
    Hertz::add_overlap_offset(&mut memory, found);
    let overlap = |step: i32| {
        let share = f64::from(step) / f64::from(steps);
        found + reach * (2.0 * (PI * share).sin() - 4.2 * share)
    };
    let (mut work, mut before) = (0.0, free.force(&resting(normal, found), &mut memory));
    hold((before.on_second.dot(&normal) / pull + 1.0).abs() < 1e-9, || format!("{before:?} where it was found"))?;
    let bound = before.stored;
    for step in 1..=steps {
        let velocity = normal * ((overlap(step - 1) - overlap(step)) / dt);
        let force = free.force(&PairMotion { velocity, dt, ..resting(normal, overlap(step)) }, &mut memory);
        work -= 0.5 * (before.on_second + force.on_second).dot(&velocity) * dt;
        before = force;
    }
    hold((work + bound).abs() < 1e-3 * pull * reach && before.stored == 0.0, || {
        format!("parting took {work} J of {bound}, {} J are left", before.stored)
    })
}

/// A pair at rest.
fn resting(normal: fractum_kernels::Vec3, overlap: f64) -> PairMotion {
    let zero = fractum_kernels::Vec3::zeros();
    PairMotion { normal, overlap, velocity: zero, spin: zero, dt: 1e-6 }
}

/// A flat contact, with its full stiffness from the first touch.
pub(crate) fn hertz_flat(draw: &mut Draw) -> (Hertz, f64, ContactParameters) {
    let (young, nu, radii, masses) = bodies(draw);
    let surface = surface(draw);
    let (radius, mass) = (radii[0].min(radii[1]), masses[0].min(masses[1]));
    let normal = young * radius;
    (Hertz::flat([normal, normal / (2.0 * (1.0 + nu))], surface, radius, mass), radius, surface)
}

/// Discs of one thickness.
pub(crate) fn discs(draw: &mut Draw) -> (Hertz, f64, ContactParameters) {
    let (young, nu, radii, _) = bodies(draw);
    let surface = surface(draw);
    let material = ElasticMaterial { young_modulus: young, poisson_ratio: nu };
    let thickness = draw.over_decades(1e-3, 10.0);
    let density = draw.between(500.0, 8000.0);
    let masses = radii.map(|radius| PI * radius * radius * thickness * density);
    let reduced = |[a, b]: [f64; 2]| a * b / (a + b);
    let pair = MaterialPair::new([material, material], surface).of_thickness(Some(thickness));
    (Hertz::new(&pair, reduced(radii), reduced(masses)), radii[0].min(radii[1]), surface)
}

/// Two discs that hit head-on part with the restitution of their damping, at any step that runs take: energies add up.
pub(crate) fn rebound_of_discs(draw: &mut Draw) -> Held {
    let (law, _, surface) = discs(draw);
    let mass = law.flat.unwrap_or_default();
    let (normal, _) = law.stiffness(0.0);
    let steps = draw.over_decades(15.0, 500.0);
    let dt = PI * (mass / normal).sqrt() / steps;
    let approach = draw.over_decades(1e-4, 1e2);
    let (mut velocity, mut overlap) = (-approach, -draw.between(0.0, 1.0) * approach * dt);
    let (mut memory, mut taken, mut before) = (Default::default(), 0.0, ContactForce::default());
    let x = fractum_kernels::Vec3::x();
    let start = 0.5 * mass * approach * approach;
    for _ in 0..(3.0 * steps) as usize {
        let motion = PairMotion { overlap, velocity: x * velocity, dt, ..resting(x, overlap) };
        let force = law.force(&motion, &mut memory);
        taken += force.damping + force.friction;
        let after = velocity + force.on_second.x / mass * dt;
        let kinetic = 0.5 * mass * velocity * after;
        hold((kinetic + force.stored + taken - start).abs() < 1e-9 * start, || {
            format!("{kinetic} J move, {} are stored and {taken} taken of {start}", force.stored)
        })?;
        velocity = after;
        overlap -= velocity * dt;
        before = force;
    }
    hold(before.on_second.x == 0.0, || "still in contact".to_owned())?;
    let expected = restitution_of_damping(surface.damping_ratio);
    let found = velocity / approach;
    let most = 0.012 * (15.0 / steps).powi(2) + 1e-4;
    hold((found - expected).abs() < most, || format!("{found} for {expected} in {steps} steps"))
}

/// Restitution falls from one as damping grows, stays above zero, and its inverse gives it back.
pub(crate) fn restitution(draw: &mut Draw) -> Held {
    let ratio = draw.over_decades(1e-6, 4.0);
    let found = restitution_of_damping(ratio);
    hold(found > 0.0 && found < 1.0, || format!("{ratio}: {found}"))?;
    let more = restitution_of_damping(ratio * 1.001);
    hold(more < found, || format!("{ratio}: {more} with more damping, {found}"))?;
    let back = restitution_of_damping(damping_of_restitution(found));
    hold((back - found).abs() < 1e-9, || format!("{found} comes back as {back}"))
}
