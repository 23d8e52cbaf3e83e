//! Properties of bonds that are pulled, sheared, bent and twisted on any way.

use fractum_kernels::bond::{
    BeamSection, BondForces, BondLanes, BondLaw, BondedPair, Crushing, InterfaceFailure, LocalBond,
};
use fractum_kernels::lanes::{Lanes, Vector};
use fractum_kernels::{Rotation, Vec3};
use nalgebra::Rotation3;

use super::draw::{Draw, Held, hold};

/// Parts of a step that is looked at closely.
const PARTS: u32 = 256;

/// A beam as a case or the calibration gives it, and a strain that it feels.
pub(crate) fn beam(draw: &mut Draw) -> (BeamSection, f64) {
    let (young_modulus, radius) = (draw.over_decades(1e6, 1e12), draw.over_decades(1e-4, 1.0));
    (BeamSection { young_modulus, poisson_ratio: draw.between(0.0, 0.49), radius }, draw.over_decades(1e-6, 1e-1))
}

/// An interface with softening, friction and plastic compression, and a strain that damages it in most draws.
pub(crate) fn interface(draw: &mut Draw, failure: InterfaceFailure) -> (LocalBond, f64) {
    let (young_modulus, strain) = (draw.over_decades(1e6, 1e12), draw.over_decades(1e-6, 1e-3));
    let strength = |draw: &mut Draw| {
        let given = young_modulus * strain * draw.over_decades(0.1, 10.0);
        draw.one_of(&[given, given, given, 0.0, f64::INFINITY])
    };
    let (tensile_strength, shear_strength) = (strength(draw), strength(draw));
    let slope = |draw: &mut Draw| {
        let given = draw.over_decades(0.01, 100.0);
        draw.one_of(&[given, given, f64::INFINITY])
    };
    let softening = [slope(draw), slope(draw)];
    let first = young_modulus * strain * draw.over_decades(0.1, 1.0);
    let stress = [first, first * draw.between(1.0, 2.0), first * draw.between(2.0, 3.0)];
    let ratio = [draw.between(1.0, 3.0), draw.between(1.0, 9.0), draw.between(1.0, 24.0)];
    let crushing = draw.one_of(&[Crushing::NONE, Crushing { stress, ratio }]);
    let law = LocalBond {
        tensile_strength,
        shear_strength,
        internal_friction: draw.between(0.0, 2.0),
        friction: draw.between(0.0, 1.5),
        softening,
        failure,
        crushing,
        ..LocalBond::elastic(young_modulus, draw.between(0.0, 0.49))
    };
    (law, strain)
}

/// Two particles and their bond.
struct Start {
    axis: Vec3,
    length: f64,
    radii: [f64; 2],
}

impl Start {
    fn draw(draw: &mut Draw) -> Start {
        let radius = draw.over_decades(1e-4, 1.0);
        let radii = [radius, radius * draw.over_decades(0.1, 10.0)];
        let axis = draw.turn() * Vec3::x();
        Start { axis, length: (radii[0] + radii[1]) * draw.between(0.8, 1.2), radii }
    }

    /// The second particle moved and both turned, over the length and in radians.
    fn moved(&self, [shift, first, second]: [Vec3; 3]) -> BondedPair {
        let rotation = [first, second].map(Rotation::from_scaled_axis);
        let position = [Vec3::zeros(), (self.axis + shift) * self.length];
        BondedPair { position, rotation, axis: self.axis, length: self.length }
    }
}

/// The same pair in turned axes.
fn turned(pair: &BondedPair, turn: &Rotation) -> BondedPair {
    BondedPair { position: pair.position.map(|x| turn * x), rotation: pair.rotation.map(|q| turn * q), ..*pair }
}

fn size(forces: &BondForces, length: f64) -> f64 {
    forces.force.norm() * length + forces.moment[0].norm() + forces.moment[1].norm()
}

fn difference(one: &BondForces, two: &BondForces, length: f64) -> f64 {
    let moment = [0, 1].map(|k| one.moment[k] - two.moment[k]);
    size(&BondForces { force: one.force - two.force, moment }, length)
}

/// Work of forces on the way from one state of a pair to another.
fn work(forces: &BondForces, from: &BondedPair, to: &BondedPair) -> f64 {
    let turn = |k: usize| (to.rotation[k] * from.rotation[k].inverse()).scaled_axis();
    forces.force.dot(&(to.position[1] - from.position[1]))
        + forces.moment[0].dot(&turn(0))
        + forces.moment[1].dot(&turn(1))
}

/// A pair that moves to and fro: momentum and angular momentum are kept, forces are the derivative of the energy at fixed memory, work is
/// stored or dissipated and nothing dissipated comes back, a second look changes nothing, turned axes change nothing, and bonds side by side
/// have the bits of each alone.
pub(crate) fn bond<L: BondLaw>(draw: &mut Draw, (law, strain): (L, f64)) -> Held {
    law.check().map_err(|wrong| wrong.to_string())?;
    let start = Start::draw(draw);
    let own = law.parameters(start.length, start.radii, draw.between(0.5, 1.5));
    let turn = Rotation::from_matrix(&Rotation3::from_matrix_unchecked(draw.turn()).into_inner());
    let mut ends = || [0; 3].map(|_| draw.vector() * strain);
    let (one, two) = (ends(), ends());
    let at = |t: f64| start.moved([0, 1, 2].map(|k| one[k] * ((9.0 * t).sin() * t) + two[k] * (4.0 * t).sin()));
    let words = format!("{law:?}, radii {:?}, length {}", start.radii, start.length);
    let stiffness = law.stiffness(start.length, &own);
    // What a bond of this stiffness bears at this strain, in joules.
    let scale = (stiffness.axial * start.length * start.length + stiffness.bending + stiffness.twist) * strain;

    let rest = start.moved([Vec3::zeros(); 3]);
    let little = start.moved([start.axis * 1e-9, Vec3::zeros(), Vec3::zeros()]);
    let pull = -law.force(&little, &own, &mut L::Memory::default()).force.dot(&start.axis);
    let is_soft = pull == 0.0 || (pull / (stiffness.axial * 1e-9 * start.length) - 1.0).abs() < 1e-5;
    hold(is_soft, || format!("{words}: pulls with {pull}"))?;
    let rigid = law.force(&turned(&rest, &turn), &own, &mut L::Memory::default());
    let rounding = 1e-14 * scale / strain;
    hold(size(&rigid, start.length) < 10.0 * rounding, || format!("{words}: rigid motion gives {rigid:?}"))?;

    let (mut memory, mut memory_turned) = (L::Memory::default(), L::Memory::default());
    let (mut done, mut lost, mut largest) = (0.0, law.dissipated(start.length, &own, &memory), 0.0f64);
    let first = lost;
    let mut last = (rest, law.force(&rest, &own, &mut memory.clone()));
    let steps = 1200;
    for step in 1..=steps {
        let pair = at(f64::from(step) / f64::from(steps));
        let before = memory;
        let forces = law.force(&pair, &own, &mut memory);
        let arm = pair.position[1] - pair.position[0];
        let whole = arm.cross(&forces.force) + forces.moment[0] + forces.moment[1];
        let big = size(&forces, start.length);
        hold(whole.norm() <= 1e-11 * big + rounding, || format!("{words}: a moment {whole} of {big} at {step}"))?;

        let there = memory;
        let again = law.force(&pair, &own, &mut memory);
        // Slips are kept in the axes of the first particle: to and fro leaves their rounding.
        hold(difference(&again, &forces, start.length) <= 1e-10 * big + rounding, || {
            format!("{words}: a second look gives {again:?} after {forces:?} at {step}")
        })?;
        memory = there;
        let axes = law.force(&turned(&pair, &turn), &own, &mut memory_turned);
        let back = BondForces { force: turn * forces.force, moment: forces.moment.map(|m| turn * m) };
        hold(difference(&axes, &back, start.length) <= 1e-6 * scale, || {
            format!("{words}: turned axes change {back:?} to {axes:?} at {step}")
        })?;

        let stored = law.energy(&pair, &own, &memory).total();
        hold(stored >= -1e-12 * scale * strain, || format!("{words}: stores {stored}"))?;
        let dissipated = law.dissipated(start.length, &own, &memory);
        // A slip that turns over within a step, while what it can bear shrinks, has a mean force that does work the other way: parts of the step tell.
        let rounding = 1e-12 * scale * strain;
        if dissipated < lost - rounding {
            let (mut memory, mut before) = (before, lost);
            for part in 1..=PARTS {
                let t = f64::from((step - 1) * PARTS + part) / f64::from(steps * PARTS);
                law.force(&at(t), &own, &mut memory);
                let after = law.dissipated(start.length, &own, &memory);
                hold(after >= before - 1e-8 * largest - rounding, || {
                    format!("{words}: {after} J after {before} J at {step}, {part}")
                })?;
                before = after;
            }
        }
        done -= 0.5 * (work(&forces, &last.0, &pair) + work(&last.1, &last.0, &pair));
        lost = dissipated;
        largest = largest.max(stored).max(lost - first);
        if step % 120 == 0 {
            derivative(&law, &own, (&memory, &pair, &forces), strain, &words)?;
            alike(&law, &own, &[at(0.2), pair, at(0.7), at(1.0)], &memory, &words)?;
        }
        last = (pair, forces);
    }
    let stored = law.energy(&last.0, &own, &memory).total();
    let left = done - stored - (lost - first);
    // Where a pair parts, meets or breaks within a step, the mean of the forces at both ends is not that of the way.
    hold(left.abs() <= 1e-2 * largest, || {
        format!("{words}: {left} J of {done} J are missing, {stored} J stored, {lost} J lost, {largest} J at most")
    })
}

/// The forces are the derivative of the energy at fixed memory.
fn derivative<L: BondLaw>(
    law: &L,
    own: &L::Parameters,
    (memory, pair, forces): (&L::Memory, &BondedPair, &BondForces),
    strain: f64,
    words: &str,
) -> Held {
    let energy = |pair: &BondedPair| law.energy(pair, own, memory).total();
    let moved = |by: Vec3| BondedPair { position: [pair.position[0], pair.position[1] + by], ..*pair };
    let step = 1e-4 * strain * pair.length;
    let stiffness = law.stiffness(pair.length, own);
    let most = (stiffness.axial + stiffness.shear(pair.length)) * strain * pair.length;
    for axis in 0..3 {
        let by = Vec3::ith(axis, step);
        let slope = (energy(&moved(by)) - energy(&moved(-by))) / (2.0 * step);
        hold((slope + forces.force[axis]).abs() <= 1e-3 * most, || {
            format!("{words}: slope {slope} of the energy, force {} along {axis}", forces.force[axis])
        })?;
    }
    Ok(())
}

/// Four bonds side by side have the bits of each alone.
fn alike<L: BondLaw>(law: &L, own: &L::Parameters, pairs: &[BondedPair; 4], memory: &L::Memory, words: &str) -> Held {
    let lanes = pairs.each_ref().map(BondedPair::lanes);
    let number = |of: &dyn Fn(&BondLanes<1>) -> Lanes<1>| Lanes::<4>::of(|k| of(&lanes[k]).0[0]);
    let vector = |of: &dyn Fn(&BondLanes<1>) -> Vector<1>| [0, 1, 2].map(|a| number(&|lane| of(lane)[a]));
    let together = BondLanes {
        gap: vector(&|lane| lane.gap),
        turns: [0, 1].map(|end| (number(&|lane| lane.turns[end].0), vector(&|lane| lane.turns[end].1))),
        axis: vector(&|lane| lane.axis),
        inverse: number(&|lane| lane.inverse),
        live: number(&|lane| lane.live),
    };
    let (mut recent, mut memories) = (L::Recent::<4>::default(), [L::Memory::default(); 4]);
    (0..4).for_each(|k| L::remember(*memory, k, &mut recent, &mut memories));
    let forces = law.forces(&together, &[*own; 4], &mut recent, &mut memories);
    for (k, pair) in pairs.iter().enumerate() {
        let mut alone = *memory;
        let own_forces = law.force(pair, own, &mut alone);
        let of = |v: &Vector<4>| Vec3::new(v[0].0[k], v[1].0[k], v[2].0[k]);
        let is_same = of(&forces.force) == own_forces.force
            && [0, 1].map(|end| of(&forces.moment[end])) == own_forces.moment
            && L::recall(&recent, &memories, k) == alone;
        hold(is_same, || format!("{words}: bond {k} of four differs from one alone"))?;
    }
    Ok(())
}
