//! Time per step of a bonded body and of one static product, on the threads given by `RAYON_NUM_THREADS`.
//!
//! The body is a jittered cubic lattice in Morton-like order with about five bonds per particle (coordination 10),
//! as a packing gives it.

#[path = "../../../tests/calibration.rs"]
mod calibration;

use fractum_dem::criterion::{FractureCriterion, Level, Principal};
use fractum_dem::{
    AnyBondLaw, BeamSection, Bonds, CentralDifference, CrackFaces, Dof6, Fracture, Lattice, LocalBond, Occasion,
    ParticleDamping, Particles,
};
use fractum_math::Vec3;

fn main() {
    divan::main();
}

/// Particles in cubes of 8³ sites, cube after cube, and their bonds: nearest sites and two diagonals.
fn body(side: usize) -> (Vec<Vec3>, Vec<[u32; 2]>) {
    const CUBE: usize = 8;
    let mut sites = Vec::new();
    let cubes = side.div_ceil(CUBE);
    for c in 0..cubes.pow(3) {
        let corner = [c % cubes, c / cubes % cubes, c / (cubes * cubes)].map(|k| k * CUBE);
        for s in 0..CUBE.pow(3) {
            let site: [usize; 3] = [s % CUBE, s / CUBE % CUBE, s / (CUBE * CUBE)];
            let site: [usize; 3] = std::array::from_fn(|a| corner[a] + site[a]);
            if site.iter().all(|&k| k < side) {
                sites.push(site);
            }
        }
    }
    let mut id = vec![0u32; side.pow(3)];
    let flat = |s: [usize; 3]| (s[2] * side + s[1]) * side + s[0];
    sites.iter().enumerate().for_each(|(i, &s)| id[flat(s)] = i as u32);
    let jitter = |i: usize, a: usize| 0.1 * (((i * 3 + a) as f64) * 12.9898).sin();
    let position = sites.iter().enumerate().map(|(i, s)| Vec3::from_fn(|a, _| s[a] as f64 + jitter(i, a))).collect();
    let mut pairs = Vec::new();
    for &s in &sites {
        for step in [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [0, 1, 1]] {
            let t: [usize; 3] = std::array::from_fn(|a| s[a] + step[a]);
            if t.iter().all(|&k| k < side) {
                pairs.push([id[flat(s)], id[flat(t)]]);
            }
        }
    }
    (position, pairs)
}

/// 22³ = 10,648 and 47³ = 103,823 particles.
#[divan::bench(args = [22, 47], sample_count = 20)]
fn step(bencher: divan::Bencher, side: usize) {
    if let Ok(section) = BeamSection::new(1e9, 0.3) {
        step_under(bencher, side, section.into());
    }
}

/// Interfaces of the local law that stay elastic, but must be looked at.
#[divan::bench(args = [22, 47], sample_count = 20)]
fn step_of_interfaces(bencher: divan::Bencher, side: usize) {
    let strong = LocalBond { tensile_strength: 1e12, shear_strength: 1e12, ..LocalBond::elastic(1e9, 0.2) };
    step_under(bencher, side, strong.into());
}

/// Interfaces that have all separated, and rub where they are closed.
#[divan::bench(args = [22, 47], sample_count = 20)]
fn step_of_separated_interfaces(bencher: divan::Bencher, side: usize) {
    let weak =
        LocalBond { tensile_strength: 1e-3, shear_strength: 1e-3, friction: 0.4, ..LocalBond::elastic(1e9, 0.2) };
    step_under(bencher, side, weak.into());
}

/// Interfaces beside the mean strain of their particles, which fill 0.52 of the body.
#[divan::bench(args = [22, 47], sample_count = 20)]
fn step_of_mean_strains(bencher: divan::Bencher, side: usize) {
    let strong = LocalBond { tensile_strength: 1e12, mean_strain: Some(0.52), ..LocalBond::elastic(1e9, 0.2) };
    step_under(bencher, side, strong.into());
}

/// Steps before the first that counts: what can separate has done so.
const WARM: usize = 10;

fn step_under(bencher: divan::Bencher, side: usize, law: AnyBondLaw) {
    let (position, pairs) = body(side);
    let n = position.len();
    let Ok(mut particles) = Particles::at_rest(position, vec![0.5; n], n as f64) else { return };
    let Ok(mut bonds) = Bonds::new(&particles, &pairs, law) else { return };
    let dt = bonds.stable_step(&particles, 0.7);
    let mut motion = CentralDifference::new(&particles, dt, ParticleDamping::default());
    particles.velocity.iter_mut().enumerate().for_each(|(i, v)| v.x = 1e-3 * (i as f64).sin());
    let mut step = || {
        motion.kick_and_drift(&mut particles);
        particles.clear_forces();
        bonds.add_forces(&mut particles);
    };
    (0..WARM).for_each(|_| step());
    bencher.counter(divan::counter::ItemsCount::new(pairs.len())).bench_local(step);
}

#[divan::bench(args = [22, 47], sample_count = 20)]
fn static_product(bencher: divan::Bencher, side: usize) {
    let (position, pairs) = body(side);
    let section = BeamSection::new(1e9, 0.3).ok();
    let lattice = section.map(|section| Lattice::new(&position, &pairs, section, 0.5));
    let Some(Ok(lattice)) = lattice else { return };
    let state: Vec<Dof6> = (0..position.len()).map(|i| std::array::from_fn(|d| ((6 * i + d) as f64).sin())).collect();
    bencher.counter(divan::counter::ItemsCount::new(pairs.len())).bench_local(|| lattice.internal(&state));
}

/// A body far from failure: its bonds, and a criterion that watches them.
fn watched(side: usize) -> Option<(Bonds, Particles, Fracture)> {
    let (position, pairs) = body(side);
    let n = position.len();
    let mut particles = Particles::at_rest(position, vec![0.5; n], n as f64).ok()?;
    let bonds = Bonds::new(&particles, &pairs, BeamSection::new(1e9, 0.3).ok()?).ok()?;
    let principal = Principal { tensile_strength: 1e12, compressive_strength: None, level: Level::Neighbours };
    let faces = CrackFaces::default();
    let fracture =
        Fracture::new(&bonds, &particles, FractureCriterion::Principal(principal), faces, 0.52, n as f64).ok()?;
    particles.position.iter_mut().enumerate().for_each(|(i, x)| x.x += 1e-4 * (i as f64).sin());
    Some((bonds, particles, fracture))
}

#[divan::bench(args = [22, 47], sample_count = 20)]
fn forces_alone(bencher: divan::Bencher, side: usize) {
    let Some((mut bonds, mut particles, _)) = watched(side) else { return };
    bencher.bench_local(|| bonds.add_forces(&mut particles));
}

#[divan::bench(args = [22, 47], sample_count = 20)]
fn forces_and_criterion(bencher: divan::Bencher, side: usize) {
    let Some((mut bonds, mut particles, mut fracture)) = watched(side) else { return };
    bencher.bench_local(|| {
        fracture.add_bond_forces(&mut bonds, &mut particles);
        fracture.break_overloaded(&mut bonds, &particles, Occasion::default())
    });
}

/// Energies that the ledger asks for.
#[divan::bench(args = [22, 47], sample_count = 20)]
fn energies(bencher: divan::Bencher, side: usize) {
    if let Some((bonds, particles, _)) = watched(side) {
        bencher.counter(divan::counter::ItemsCount::new(bonds.len())).bench_local(|| bonds.energy(&particles));
    }
}
