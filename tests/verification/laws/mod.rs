//! One table of laws, each held against its properties with numbers drawn from the whole range that a case may give.
//!
//! A new law is a new row. A failure names the row and the draw, which is the same on every machine.

use std::f64::consts::PI;

use fractum_contact::law::{
    ContactForce, ContactLaw, ContactParameters, ElasticMaterial, Hertz, Linear, MaterialPair, PairMotion,
};
use fractum_fem::{Criterion, CriterionKind, Degradation, Softening};
use fractum_gas::{EquationOfState, Jwl, NobleAbel, PerfectGas};
use fractum_heat::PackedSphere;
use fractum_math::{Sym3, Vec3};
use nalgebra::{Matrix3, Rotation3};

mod band;

/// What is wrong with a law, in words.
type Held = Result<(), String>;

/// A law with the properties that it must have.
struct Row {
    law: &'static str,
    holds: fn(&mut Draw) -> Held,
}

/// How often every row draws.
const DRAWS: u64 = 300;

const LAWS: &[Row] = &[
    Row { law: "softening, exponential", holds: |draw| softening(draw, Softening::Exponential) },
    Row { law: "softening, linear", holds: |draw| softening(draw, Softening::Linear) },
    Row {
        law: "softening, bilinear",
        holds: |draw| {
            let curve = bilinear(draw);
            softening(draw, curve)
        },
    },
    Row { law: "crack in a band, exponential", holds: |draw| band::torn_and_held(draw, Softening::Exponential) },
    Row { law: "crack in a band, linear", holds: |draw| band::torn_and_held(draw, Softening::Linear) },
    Row {
        law: "crack in a band, bilinear",
        holds: |draw| {
            let curve = bilinear(draw);
            band::torn_and_held(draw, curve)
        },
    },
    Row { law: "degradation, exponential", holds: |draw| degradation(draw, Softening::Exponential) },
    Row { law: "degradation, linear", holds: |draw| degradation(draw, Softening::Linear) },
    Row {
        law: "degradation, bilinear",
        holds: |draw| {
            let curve = bilinear(draw);
            degradation(draw, curve)
        },
    },
    Row { law: "criterion, Rankine", holds: |draw| criterion(draw, CriterionKind::Rankine) },
    Row {
        law: "criterion, Mohr-Coulomb with a tension cut-off",
        holds: |draw| criterion(draw, CriterionKind::MohrCoulomb),
    },
    Row { law: "criterion, Mohr-Coulomb", holds: |draw| criterion(draw, CriterionKind::PureMohrCoulomb) },
    Row { law: "criterion, Drucker-Prager", holds: |draw| criterion(draw, CriterionKind::DruckerPrager) },
    Row { law: "criterion, Mazars", holds: |draw| criterion(draw, CriterionKind::Mazars) },
    Row { law: "criterion, modified Mohr-Coulomb", holds: |draw| criterion(draw, CriterionKind::ModifiedMohrCoulomb) },
    Row {
        law: "contact, linear, spheres",
        holds: |draw| {
            let law = linear_spheres(draw);
            contact(draw, law, false)
        },
    },
    Row {
        law: "contact, linear, discs",
        holds: |draw| {
            let law = linear_discs(draw);
            contact(draw, law, false)
        },
    },
    Row {
        law: "contact, Hertz and Mindlin",
        holds: |draw| {
            let law = hertz(draw);
            contact(draw, law, true)
        },
    },
    Row { law: "gas, perfect", holds: |draw| gas(perfect(draw)) },
    Row { law: "gas, Noble and Abel", holds: |draw| gas(noble_abel(draw)) },
    Row { law: "gas, Jones-Wilkins-Lee", holds: |draw| gas(jwl(draw)) },
    Row { law: "heat between packed spheres", holds: conductance },
];

#[test]
fn every_law_has_its_properties_over_its_whole_range() {
    let mut wrong = Vec::new();
    for (number, row) in LAWS.iter().enumerate() {
        let fails = |draw: &u64| (row.holds)(&mut Draw::new(number as u64, *draw)).err();
        let failed: Vec<(u64, String)> = (0..DRAWS).filter_map(|draw| Some((draw, fails(&draw)?))).collect();
        if let Some((draw, what)) = failed.first() {
            wrong.push(format!("{}: {} of {DRAWS} draws, the first is {draw}: {what}", row.law, failed.len()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Random numbers of one draw (SplitMix64).
struct Draw(u64);

impl Draw {
    fn new(row: u64, draw: u64) -> Self {
        Draw(row.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ draw.wrapping_mul(0xd1b5_4a32_d192_ed03))
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Evenly between two numbers.
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.bits() >> 11) as f64 / (1u64 << 53) as f64)
    }

    /// Between two positive numbers, evenly over decades.
    fn over_decades(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[(self.bits() % all.len() as u64) as usize]
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.between(-1.0, 1.0), self.between(-1.0, 1.0), self.between(-1.0, 1.0))
    }

    fn turn(&mut self) -> Matrix3<f64> {
        Rotation3::new(self.vector() * PI).into_inner()
    }
}

/// An error unless a condition holds.
fn hold(holds: bool, what: impl FnOnce() -> String) -> Held {
    if holds { Ok(()) } else { Err(what()) }
}

/// A bilinear curve as a case gives it: stress of the kink over the strength, its opening over the last one.
fn bilinear(draw: &mut Draw) -> Softening {
    let (stress, share) = (draw.between(0.02, 0.98), draw.between(0.02, 0.98));
    Softening::Bilinear { stress, opening: 2.0 * share / (stress + share) }
}

/// A softening curve starts at the strength, falls, never gives stiffness back, and encloses the fracture energy.
fn softening(draw: &mut Draw, curve: Softening) -> Held {
    let (young, strength) = (draw.over_decades(1e6, 1e12), draw.over_decades(1e3, 1e9));
    let energy = draw.over_decades(1e-1, 1e5);
    let length = draw.between(0.001, 0.98) * curve.largest_length(young, strength, energy);
    // In units of the strength and of the strain at which it is reached.
    let brittleness = young * energy / (length * strength * strength);
    let ratio = |x: f64| curve.residual_ratio(x * strength, strength, length, young, energy);
    hold((ratio(1.0) - 1.0).abs() < 1e-9, || format!("{curve:?} starts at {}", ratio(1.0)))?;
    let end = match curve {
        Softening::Exponential => 1.0 + 40.0 * (brittleness - 0.5),
        Softening::Linear => 2.0 * brittleness + 1.0,
        Softening::Bilinear { stress, opening } => (2.0 - opening) / stress * brittleness + 1.0,
    };
    let steps = 20_000;
    let (mut area, mut last, mut x) = (0.5, 1.0, 1.0);
    for step in 1..=steps {
        let next = 1.0 + (end - 1.0) * f64::from(step) / f64::from(steps);
        let now = ratio(next);
        hold(now <= last * (1.0 + 1e-12) && now >= 0.0, || format!("{curve:?} rises to {now} from {last} at {next}"))?;
        hold(now / next <= last / x * (1.0 + 1e-12), || format!("{curve:?} heals at {next}"))?;
        area += 0.5 * (now + last) * (next - x);
        (last, x) = (now, next);
    }
    hold((area / brittleness - 1.0).abs() < 2e-3, || {
        format!("{curve:?} at b = {brittleness}: {} of its energy", area / brittleness)
    })
}

/// Stiffness falls from one to zero, the stress of a band that localises falls with it, and an unloaded point stays intact above the
/// least a₁ alone.
fn degradation(draw: &mut Draw, curve: Softening) -> Held {
    let law = Degradation::new(curve);
    let a1 = law.least_a1() * draw.over_decades(1.001, 1e5);
    hold((law.stiffness(a1, 0.0) - 1.0).abs() < 1e-15, || "not whole at first".into())?;
    hold(law.stiffness(a1, 1.0) < 1e-9, || format!("{} is left", law.stiffness(a1, 1.0)))?;
    let mut last = [1.0, f64::INFINITY];
    for d in (1..500).map(|i| f64::from(i) / 500.0) {
        let stiffness = law.stiffness(a1, d);
        // The square of the stress is in proportion to (2d - d²)/(1/ω - 1).
        let now = [stiffness, a1 * d * (2.0 - d) * stiffness / (1.0 - stiffness)];
        let falls = now[0] > 0.0 && now[0] < last[0] && now[1] < last[1] * (1.0 + 1e-9);
        hold(falls, || format!("{curve:?}, a1 = {a1}: {now:?} after {last:?} at {d}"))?;
        last = now;
    }
    // The energy of an unloaded point over f_t²/2E.
    let energy = |a1: f64, d: f64| law.stiffness(a1, d) + 0.5 * a1 * d * (2.0 - d);
    let lowest = |a1: f64| (1..2000).map(|i| energy(a1, f64::from(i) / 2000.0)).fold(f64::INFINITY, f64::min);
    hold(lowest(a1) > 1.0, || format!("{curve:?}, a1 = {a1}: an unloaded point falls to {}", lowest(a1)))?;
    let below = lowest(0.95 * law.least_a1());
    hold(below < 1.0, || format!("{curve:?}: below the least a1 an unloaded point has {below}"))
}

/// Uniaxial strengths, degree one, the same in turned axes, convex, and no cheap bound that hides a stress.
fn criterion(draw: &mut Draw, kind: CriterionKind) -> Held {
    let angle = draw.between(1.0, 60.0).to_radians();
    let least = kind.least_strength_ratio(angle);
    let (strength_ratio, poisson_ratio) = (least * draw.over_decades(1.001, 50.0), draw.between(0.0, 0.49));
    let criterion = Criterion::new(kind, angle, strength_ratio, poisson_ratio);
    let law = format!("angle {:.2} deg, ratio {strength_ratio:.3}, nu {poisson_ratio:.3}", angle.to_degrees());
    let q = |stress: Sym3| criterion.equivalent_stress(stress);
    let along = |size: f64| Sym3::new(size, 0.0, 0.0, 0.0, 0.0, 0.0);
    hold((q(along(1.0)) - 1.0).abs() < 1e-6, || format!("{law}: tension 1 is {}", q(along(1.0))))?;
    if kind.uses_compressive_strength() {
        let crushed = q(along(-strength_ratio));
        hold((crushed - 1.0).abs() < 1e-6 * strength_ratio, || {
            format!("{law}: the strength in compression is {crushed}")
        })?;
    }
    let mut stress = || Sym3(std::array::from_fn(|_| draw.between(-10.0, 10.0)));
    let (one, two) = (stress(), stress());
    let (turn, factor) = (draw.turn(), draw.over_decades(1e-3, 1e3));
    // The closed form of the principal values is exact to about 1e-8 of the norm.
    let norm = one.to_matrix().norm() + two.to_matrix().norm();
    hold((q(one * factor) - factor * q(one)).abs() < 1e-6 * factor * norm, || format!("{law}: not of degree one"))?;
    let turned = Sym3::symmetric_part(&(turn * one.to_matrix() * turn.transpose()));
    hold((q(turned) - q(one)).abs() < 1e-6 * norm, || format!("{law}: {} turned, {}", q(turned), q(one)))?;
    let mean = q((one + two) * 0.5);
    let bound = 0.5 * (q(one) + q(two));
    hold(mean <= bound + 1e-6 * norm, || format!("{law}: not convex, {mean} between, {bound}: {one:?} {two:?}"))?;
    let threshold = draw.between(0.1, 20.0);
    let hidden = criterion.surely_below(one, threshold) && q(one) > threshold * (1.0 + 1e-7);
    hold(!hidden, || format!("{law}: the bound hides {} above {threshold}", q(one)))
}

/// Friction, rolling friction (none in half of the draws) and damping.
fn surface(draw: &mut Draw) -> ContactParameters {
    ContactParameters {
        friction: draw.between(0.0, 1.5),
        rolling_friction: draw.between(-0.3, 0.3).max(0.0),
        damping_ratio: draw.between(0.0, 1.0),
    }
}

/// Two bodies: modulus, Poisson's ratio, radii, masses.
fn bodies(draw: &mut Draw) -> (f64, f64, [f64; 2], [f64; 2]) {
    let radius = draw.over_decades(1e-4, 1e1);
    let radii = [radius, radius * draw.over_decades(0.05, 20.0)];
    let density = draw.between(500.0, 8000.0);
    let masses = radii.map(|radius| 4.0 / 3.0 * PI * radius.powi(3) * density);
    (draw.over_decades(1e6, 5e11), draw.between(0.0, 0.49), radii, masses)
}

/// A law with its radius and reach of friction against rolling [m].
fn linear_spheres(draw: &mut Draw) -> (Linear, f64, ContactParameters) {
    let (young, nu, radii, masses) = bodies(draw);
    let surface = surface(draw);
    (Linear::between_spheres(young, nu, radii, masses, surface), radii[0].min(radii[1]), surface)
}

fn linear_discs(draw: &mut Draw) -> (Linear, f64, ContactParameters) {
    let (young, nu, radii, masses) = bodies(draw);
    let surface = surface(draw);
    let thickness = draw.over_decades(1e-3, 10.0);
    (Linear::between_discs(young, nu, radii, thickness, masses, surface), radii[0].min(radii[1]), surface)
}

fn hertz(draw: &mut Draw) -> (Hertz, f64, ContactParameters) {
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
fn contact<L: ContactLaw>(
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

/// Densities [kg/m³] and internal energies per mass [J/kg] of a gas.
fn perfect(draw: &mut Draw) -> (EquationOfState, f64, f64) {
    let law = PerfectGas { heat_ratio: draw.between(1.02, 3.0), gas_constant: draw.over_decades(50.0, 5000.0) };
    (EquationOfState::PerfectGas(law), draw.over_decades(1e-3, 3e3), draw.over_decades(1e3, 1e7))
}

fn noble_abel(draw: &mut Draw) -> (EquationOfState, f64, f64) {
    let covolume = draw.over_decades(1e-5, 3e-3);
    let law =
        NobleAbel { heat_ratio: draw.between(1.02, 3.0), gas_constant: draw.over_decades(50.0, 5000.0), covolume };
    (EquationOfState::NobleAbel(law), draw.over_decades(1e-3, 0.95 / covolume), draw.over_decades(1e3, 1e7))
}

fn jwl(draw: &mut Draw) -> (EquationOfState, f64, f64) {
    let density = draw.between(900.0, 1900.0);
    let law = Jwl {
        a: draw.over_decades(5e10, 9e11),
        b: draw.over_decades(5e8, 3e10),
        r1: draw.between(3.5, 6.5),
        r2: draw.between(0.8, 2.0),
        omega: draw.between(0.2, 0.5),
        density,
        heat_capacity: draw.between(800.0, 2000.0),
    };
    (EquationOfState::Jwl(law), draw.over_decades(1e-2, density), draw.over_decades(1e6, 1e7))
}

/// Pressure is positive and a matter of density and energy alone; sound travels with the slope of the isentrope; mass and energy at
/// a pressure and temperature have these.
fn gas((state, density, energy): (EquationOfState, f64, f64)) -> Held {
    let law = state.law();
    let pressure = |density: f64, energy: f64| law.pressure_line(density, 1.0).at(energy * density);
    let p = pressure(density, energy);
    let at = format!("{state:?} at {density} kg/m^3, {energy} J/kg");
    hold(p > 0.0 && p.is_finite(), || format!("{at}: {p} Pa"))?;
    let little = law.pressure_line(density * 3e-6, 3e-6).at(energy * density * 3e-6);
    hold((little / p - 1.0).abs() < 1e-9, || format!("{at}: {little} Pa in a small volume, {p} Pa"))?;
    // Along an isentrope du = p dρ/ρ².
    let d = 1e-5 * density;
    let path = |d: f64| pressure(density + d, energy + p * d / (density * density));
    let (slope, square) = ((path(d) - path(-d)) / (2.0 * d), law.sound_speed_squared(density, energy));
    hold((slope / square - 1.0).abs() < 1e-4, || {
        format!("{at}: slope {slope}, square of the speed of sound {square}")
    })?;
    let temperature = law.temperature(density, energy);
    hold(temperature >= 0.0 && temperature.is_finite(), || format!("{at}: {temperature} K"))?;
    if let Some((mass, inner)) = law.contents(0.3, p, temperature) {
        let again = law.pressure_line(mass, 0.3).at(inner);
        hold((again / p - 1.0).abs() < 1e-9, || format!("{at}: {again} Pa of these contents"))?;
        hold((mass / (0.3 * density) - 1.0).abs() < 1e-9, || format!("{at}: {mass} kg in 0.3 m^3"))?;
    }
    Ok(())
}

/// Conductance is positive, the same both ways, and grows with conductivity and size.
fn conductance(draw: &mut Draw) -> Held {
    let spheres = [0; 2].map(|_| PackedSphere::of(draw.between(1.0, 30.0) as usize));
    let radius = draw.over_decades(1e-5, 1.0);
    let radii = [radius, radius * draw.over_decades(0.05, 20.0)];
    let length = radii[0] + radii[1];
    let conductivity = draw.over_decades(1e-3, 1e3);
    let one = PackedSphere::conductance(spheres, radii, length, conductivity);
    let words = format!("{spheres:?} {radii:?}");
    hold(one > 0.0 && one.is_finite(), || format!("{words}: {one} W/K"))?;
    let other = PackedSphere::conductance([spheres[1], spheres[0]], [radii[1], radii[0]], length, conductivity);
    hold((other / one - 1.0).abs() < 1e-12, || format!("{words}: {one} and {other} W/K"))?;
    let doubled = PackedSphere::conductance(spheres, radii.map(|r| 2.0 * r), 2.0 * length, 3.0 * conductivity);
    hold((doubled / one - 6.0).abs() < 1e-9, || format!("{words}: {doubled} after {one} W/K"))?;
    let fraction = spheres.map(|sphere| sphere.fraction);
    hold(fraction.iter().all(|share| (0.0..=1.0).contains(share)), || format!("{words}: {fraction:?}"))
}
