//! Interfaces between two particles: what a network of one such bond does.

use fractum_kernels::bond::{BondForces, Crushing, InterfaceFailure, LocalBond, Separation};
use fractum_kernels::contact::{ContactMemory, Linear, PairMotion, Rolling};
use fractum_math::{Rotation, Vec3};
use proptest::prelude::*;

use super::BondNetwork;
use crate::bond::{BondGraph, Bonds};
use crate::particles::Particles;

const LENGTH: f64 = 0.95;
const RADII: [f64; 2] = [0.5, 0.4];

/// An interface that softens in tension and shear, with α = 1.2.
fn law() -> LocalBond {
    LocalBond {
        tensile_strength: 3e5,
        shear_strength: 5e5,
        internal_friction: 0.3,
        friction: 0.4,
        softening: [0.2, 0.1],
        ..LocalBond::elastic(1e9, 0.25)
    }
}

const SHARE: f64 = 1.2;

fn area() -> f64 {
    SHARE * std::f64::consts::PI * 0.16
}

/// Two particles along an oblique axis, and their bond.
fn pair(law: LocalBond) -> (Particles, BondNetwork<LocalBond>) {
    let particles = Particles::at_rest(vec![Vec3::zeros(), axis() * LENGTH], RADII.to_vec(), 2.0).unwrap();
    let bonds = BondNetwork::with_shares(&particles, &[[0, 1]], &[SHARE], law).unwrap();
    (particles, bonds)
}

fn axis() -> Vec3 {
    Vec3::new(2.0, 1.0, -2.0) / 3.0
}

/// A direction across the axis.
fn side() -> Vec3 {
    Vec3::new(1.0, -2.0, 0.0).normalize()
}

/// Moves the second particle to a stretch along the axis and a shift of the interface to the side [m], by turns of both particles
/// that leave their centres on the axis: exact shear at any size.
fn place(particles: &mut Particles, stretch: f64, shift: f64) {
    particles.position[1] = axis() * (LENGTH + stretch);
    let turn = Rotation::from_scaled_axis(axis().cross(&side()) * -(shift / LENGTH).asin());
    particles.orientation = vec![turn; 2];
}

/// Normal and shear stress times the area after a move: the force on the second particle along the axis, and that to the side, which acts on the
/// arm of the turned interface.
fn force(particles: &mut Particles, bonds: &mut BondNetwork<LocalBond>, stretch: f64, shift: f64) -> [f64; 2] {
    place(particles, stretch, shift);
    particles.clear_forces();
    bonds.add_forces(particles);
    let arm = (1.0 - (shift / LENGTH).powi(2)).sqrt() * LENGTH / (LENGTH + stretch);
    [-particles.force[1].dot(&axis()), -particles.force[1].dot(&side()) / arm]
}

#[test]
fn tension_rises_to_the_strength_softens_on_a_line_and_takes_the_fracture_energy() {
    let (mut particles, mut bonds) = pair(law());
    let stiffness = 1e9 * area() / LENGTH;
    let peak = 3e5 * area();
    let (onset, end) = (peak / stiffness, peak / stiffness * (1.0 + 1.0 / 0.2));
    let mut largest = 0.0f64;
    for step in 0..=40_000 {
        let u = 1.1 * end * f64::from(step) / 40_000.0;
        let [found, across] = force(&mut particles, &mut bonds, u, 0.0);
        let expected = if u <= onset { stiffness * u } else { (peak * (end - u) / (end - onset)).max(0.0) };
        assert!((found - expected).abs() < 1e-9 * peak && across.abs() < 1e-9 * peak, "{u}: {found} {expected}");
        largest = largest.max(found);
        if step == 12_000 {
            // Back to rest and out again: on the line to the origin.
            let there = found / u;
            for k in (0..=300).chain((0..300).rev()) {
                let [back, _] = force(&mut particles, &mut bonds, u * (1.0 - f64::from(k) / 300.0), 0.0);
                assert!((back - there * u * (1.0 - f64::from(k) / 300.0)).abs() < 1e-9 * peak);
            }
        }
    }
    assert!((largest / peak - 1.0).abs() < 2e-4);
    let energy = 0.5 * peak * peak * (1.0 / stiffness + 1.0 / (0.2 * stiffness));
    assert!((bonds.dissipated() / energy - 1.0).abs() < 1e-6, "{} {energy}", bonds.dissipated());
    let mut separated = Vec::new();
    bonds.take_separated(&mut separated);
    assert_eq!(separated, [(0, Separation::Tension)]);
    bonds.take_separated(&mut separated);
    assert!(separated.is_empty());
}

#[test]
fn shear_rises_to_the_strength_and_softens_to_friction_under_pressure() {
    for pressure in [0.0, 4e5] {
        let (mut particles, mut bonds) = pair(law());
        let modulus = 1e9 / 2.5;
        let stretch = -pressure / 1e9 * LENGTH;
        let (stiffness, cohesion) = (modulus * area() / LENGTH, 5e5 * area());
        let (begin, end) = (cohesion / stiffness, cohesion / stiffness * (1.0 + 1.0 / 0.1));
        let held = 0.3 * pressure * area();
        let rubbing = 0.4 * pressure * area();
        let shift = held / stiffness;
        for step in 0..=40_000 {
            let u = 1.1 * (end + shift) * f64::from(step) / 40_000.0;
            let [push, found] = force(&mut particles, &mut bonds, stretch, u);
            assert!((push + pressure * area()).abs() < 1e-9 * cohesion);
            // Elastic part 1 - D, and part D that rubs.
            let effective = (u - shift).max(0.0);
            let damage = if effective <= begin {
                0.0
            } else {
                (1.0 - begin * (end - effective) / (effective * (end - begin))).min(1.0)
            };
            let expected = (1.0 - damage) * stiffness * u + damage * rubbing;
            assert!((found - expected).abs() < 1e-6 * cohesion, "{pressure} {u}: {found} {expected}");
        }
        // Friction takes ∫ D dp; without pressure only the fracture energy.
        let energy = 0.5 * cohesion * cohesion * (1.0 / stiffness + 1.0 / (0.1 * stiffness));
        let found = bonds.dissipated();
        assert!(if pressure == 0.0 { (found / energy - 1.0).abs() < 1e-6 } else { found > energy }, "{found} {energy}");
        let mut separated = Vec::new();
        bonds.take_separated(&mut separated);
        assert_eq!(separated, [(0, Separation::Shear)]);
    }
}

#[test]
fn coupled_failure_begins_on_the_circle_of_both_ratios_and_takes_both_stiffnesses() {
    let law = LocalBond { failure: InterfaceFailure::Coupled, ..law() };
    let (mut particles, mut bonds) = pair(law);
    let (along, across) = (3e5 / 1e9 * LENGTH, 5e5 / 4e8 * LENGTH);
    let intact = force(&mut particles, &mut bonds, 0.599 * along, 0.8 * across);
    assert!((intact[0] - 0.599 * 3e5 * area()).abs() < 1e-6 * intact[0] && bonds.dissipated() == 0.0);
    // Within both strengths, and beyond the circle.
    let (mut other, mut alike) = pair(law);
    let [pull, _] = force(&mut other, &mut alike, 0.8 * along, 0.8 * across);
    assert!(pull < 0.75 * 3e5 * area());
    let [pull, push] = force(&mut particles, &mut bonds, 1.2 * along, 1.6 * across);
    let (pull, push) = (pull / (1.2 * 3e5 * area()), push / (1.6 * 5e5 * area()));
    let end = 0.36 * 6.0 + 0.64 * 11.0;
    let whole = (end - 2.0) / (2.0 * (end - 1.0));
    assert!((pull - whole).abs() < 1e-6 && (push - whole).abs() < 1e-6, "{pull} {push} {whole}");
}

#[test]
fn compression_follows_three_lines_unloads_elastically_and_keeps_what_is_plastic() {
    let crushing = Crushing { stress: [8.5e6, 9e6, 11e6], ratio: [3.0, 9.0, 24.0] };
    let law = LocalBond { crushing, friction: 0.0, ..LocalBond::elastic(3.8e9, 0.2) };
    let (mut particles, mut bonds) = pair(law);
    let knees = [8.5e6 / 3.8e9, 0.5e6 * 3.0 / 3.8e9, 2e6 * 9.0 / 3.8e9];
    let strain = [knees[0], knees[0] + knees[1], knees.iter().sum::<f64>()];
    let curve = |e: f64| {
        let points = [(0.0, 0.0), (strain[0], 8.5e6), (strain[1], 9e6), (strain[2], 11e6)];
        let at = points.windows(2).find(|p| e <= p[1].0);
        at.map_or(11e6 + (e - strain[2]) * 3.8e9 / 24.0, |p| {
            p[0].1 + (e - p[0].0) * (p[1].1 - p[0].1) / (p[1].0 - p[0].0)
        })
    };
    let most = 2.0 * strain[2];
    let mut work = 0.0;
    let mut last = [0.0; 2];
    for step in 0..=40_000 {
        let e = most * f64::from(step) / 40_000.0;
        let [found, _] = force(&mut particles, &mut bonds, -e * LENGTH, 0.0);
        assert!((-found / (curve(e) * area()) - 1.0).abs() < 1e-9 || step == 0, "{e}: {found}");
        work += 0.5 * (last[1] - found) * (e - last[0]) * LENGTH;
        last = [e, -found];
    }
    let elastic = curve(most) / 3.8e9;
    for part in [0.7, 0.2, 0.0] {
        let e = most - elastic * (1.0 - part);
        let [found, _] = force(&mut particles, &mut bonds, -e * LENGTH, 0.0);
        assert!((-found - part * curve(most) * area()).abs() < 1e-9 * curve(most) * area());
    }
    let stored = 0.5 * curve(most) * elastic * area() * LENGTH;
    assert!((bonds.dissipated() / (work - stored) - 1.0).abs() < 1e-6);
}

#[test]
fn a_bond_without_strength_is_the_contact_of_two_spheres() {
    let law = LocalBond { tensile_strength: 0.0, shear_strength: 0.0, ..law() };
    let (mut particles, mut bonds) = pair(law);
    let stiffness = 1e9 * area() / LENGTH;
    let contact = Linear {
        normal_stiffness: stiffness,
        tangential_stiffness: stiffness / 2.5,
        normal_damping: 0.0,
        friction: 0.4,
        rolling: Rolling::default(),
    };
    let mut memory = ContactMemory::default();
    let (mut last, mut slid, mut most) = ([0.0; 2], 0, 0.0f64);
    for step in 0..=30_000 {
        let t = f64::from(step) / 30_000.0;
        // Pressed, rubbed to and fro, parted, and pressed again.
        let wave = fractum_math::elementary::sin(20.0 * t);
        let now = [1e-4 * (0.2 - fractum_math::elementary::sin(9.0 * t)), 1.2e-4 * wave];
        let found = force(&mut particles, &mut bonds, now[0], now[1]);
        // The interface of the second particle moves to the side against the first.
        let velocity = axis() * (now[0] - last[0]) + side() * (now[1] - last[1]);
        let motion = PairMotion { normal: axis(), overlap: -now[0], velocity, spin: Vec3::zeros(), dt: 1.0 };
        let expected = contact.force(&motion, &mut memory).on_second;
        let expected = [-expected.dot(&axis()), -expected.dot(&side())];
        let size = 1e-4 * stiffness;
        // That law counts the share of the step in which a contact closes: a way of 3e-4 of the size makes an eighth of it.
        assert!((0..2).all(|k| (found[k] - expected[k]).abs() < 4e-5 * size), "{step}: {found:?} {expected:?}");
        slid += usize::from(found[1] != 0.0 && (found[1].abs() + 0.4 * found[0]).abs() < 1e-9 * size);
        most = most.max(found[1].abs());
        last = now;
    }
    assert!(slid > 3000 && most > 0.0);
    let mut separated = Vec::new();
    bonds.take_separated(&mut separated);
    assert!(separated.is_empty());
}

#[test]
fn viscous_forces_oppose_the_change_of_length_with_the_constant_of_the_source() {
    let law = LocalBond { damping_ratio: 0.1, ..law() };
    let particles = Particles::at_rest(vec![Vec3::zeros(), axis() * LENGTH], RADII.to_vec(), 2.0).unwrap();
    let bonds = Bonds::with_shares(&particles, &[[0, 1]], &[SHARE], law).unwrap();
    let graph = BondGraph::new(2, bonds.pairs());
    let mut moving = particles.clone();
    moving.velocity[1] = axis() * 0.3 + side();
    let mut found = vec![Vec3::zeros(); 2];
    bonds.add_viscous_forces(&moving, &graph, &mut found);
    let [a, b] = [particles.mass[0], particles.mass[1]];
    let stiffness = 1e9 * area() / LENGTH;
    let viscosity = 2.0 * 0.1 * area() / (LENGTH * 0.4) * (a * b / (a + b) * stiffness).sqrt();
    assert!((found[1] + axis() * (0.3 * viscosity)).norm() < 1e-12 * viscosity && found[0] == -found[1]);
    assert!((bonds.viscous_time(&particles) / (viscosity / stiffness) - 1.0).abs() < 1e-12);
}

#[test]
fn what_a_pair_that_rubs_turns_and_twists_does_is_stored_or_dissipated() {
    let (mut particles, mut bonds) = pair(law());
    let steps = 4000;
    let (mut work, mut before): (f64, Option<Particles>) = (0.0, None);
    let mut start = f64::NAN;
    for step in 0..=steps {
        let t = f64::from(step) / f64::from(steps);
        place(&mut particles, -2e-4, 0.3 * t);
        let whole = Rotation::from_scaled_axis(Vec3::new(0.3, 2.0, -1.0) * t);
        particles.position[1] = whole * particles.position[1];
        particles.orientation[1] = Rotation::from_scaled_axis(axis() * t) * particles.orientation[1];
        particles.orientation.iter_mut().for_each(|q| *q = whole * *q);
        particles.clear_forces();
        bonds.add_forces(&mut particles);
        if let Some(before) = &before {
            for i in 0..2 {
                let turn = (particles.orientation[i] * before.orientation[i].inverse()).scaled_axis();
                work += 0.5 * (particles.force[i] + before.force[i]).dot(&(particles.position[i] - before.position[i]));
                work += 0.5 * (particles.moment[i] + before.moment[i]).dot(&turn);
            }
        } else {
            start = bonds.energy(&particles).total();
        }
        before = Some(particles.clone());
    }
    let dissipated = bonds.dissipated();
    let left = work + bonds.energy(&particles).total() - start + dissipated;
    assert!(dissipated > 0.0 && left.abs() < 2e-4 * dissipated, "{left} {dissipated}");
}

const UNIT: std::ops::Range<f64> = -1.0..1.0;

proptest! {
    #[test]
    fn forces_of_whole_bonds_are_the_derivative_of_the_energy_and_keep_momentum(
        x in prop::array::uniform3(UNIT), r in prop::array::uniform3(UNIT), s in prop::array::uniform3(UNIT),
    ) {
        let start = Particles::at_rest(vec![Vec3::zeros(), axis() * LENGTH], RADII.to_vec(), 2.0).unwrap();
        let bonds = BondNetwork::new(&start, &[[0, 1]], LocalBond::elastic(2.0, 0.3)).unwrap();
        let mut moved = start.clone();
        moved.position[1] += Vec3::from(x) * 0.2;
        moved.orientation = [r, s].map(|turn| Rotation::from_scaled_axis(Vec3::from(turn) * 0.5)).to_vec();
        let BondForces { force, moment } = bonds.forces_of(0, &moved);
        let size = force.norm() + moment[0].norm() + moment[1].norm() + 1e-3;
        let arm = moved.position[1] - moved.position[0];
        prop_assert!((arm.cross(&force) + moment[0] + moment[1]).norm() < 1e-12 * size);
        let h = 1e-5;
        for axis in 0..3 {
            let mut step = Vec3::zeros();
            step[axis] = h;
            let energy = |change: &dyn Fn(&mut Particles, f64), by: f64| {
                let mut there = moved.clone();
                change(&mut there, by);
                bonds.energy(&there).total()
            };
            let slope = |change: &dyn Fn(&mut Particles, f64)| (energy(change, 1.0) - energy(change, -1.0)) / (2.0 * h);
            for end in 0..2 {
                let push = slope(&|p, by| p.position[end] += step * by);
                let own = if end == 1 { force } else { -force };
                prop_assert!((push + own[axis]).abs() < 1e-7 * size, "{push} {}", own[axis]);
                let turn = slope(&|p, by| p.orientation[end] = Rotation::from_scaled_axis(step * by) * p.orientation[end]);
                prop_assert!((turn + moment[end][axis]).abs() < 1e-7 * size, "{turn} {}", moment[end][axis]);
            }
        }
    }

    #[test]
    fn rigid_motion_changes_neither_forces_nor_memory_of_damaged_bonds(
        x in prop::array::uniform3(-9.0f64..9.0), r in prop::array::uniform3(-3.0f64..3.0), shift in 0.5f64..14.0,
    ) {
        let (mut particles, mut bonds) = pair(law());
        force(&mut particles, &mut bonds, -2e-4, shift * 1e-3);
        let (before, memory) = (particles.clone(), bonds.memory());
        let turn = Rotation::from_scaled_axis(Vec3::from(r));
        for i in 0..2 {
            particles.position[i] = turn * before.position[i] + Vec3::from(x);
            particles.orientation[i] = turn * before.orientation[i];
        }
        let BondForces { force, moment } = bonds.forces_of(0, &particles);
        let size = before.force[1].norm();
        prop_assert!((force - turn * before.force[1]).norm() < 1e-6 * size);
        prop_assert!((moment[0] - turn * before.moment[0]).norm() < 1e-6 * size);
        let total = (particles.position[1] - particles.position[0]).cross(&force) + moment[0] + moment[1];
        prop_assert!(total.norm() < 1e-12 * size);
        // A second look at the same state leaves the memory as it is, and the forces to the rounding of a slip that is turned to and fro.
        let mut again = before.clone();
        again.clear_forces();
        bonds.add_forces(&mut again);
        prop_assert!((again.force[1] - before.force[1]).norm() < 1e-12 * size);
        prop_assert_eq!(bonds.memory(), memory);
    }
}
