//! Time per element and step: plain elements, smoothed ones, damage armed and damage growing. One thread.
//!
//! `cargo bench -p fractum-fem` prints items (elements) per second on meshes of 56,000 and 511,000 tetrahedra, one in
//! the cache and one larger than it.

#[path = "../../../tests/calibration.rs"]
mod calibration;

use divan::counter::ItemsCount;
use divan::{Bencher, main as run_benches};
use fractum_fem::{Body, DamageLaw, Elastic, ElementKind, Kinematics, LocalDamping, Regularisation, Solid};
use fractum_math::Vec3;
use fractum_mesh::generate::{Jitter, structured_box};
use fractum_mesh::renumber::renumber_along_hilbert_curve;

const CONCRETE: Elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.2 };
const CELLS: [u32; 2] = [21, 44];

fn main() {
    // The kernels are timed on one thread.
    let _ = rayon::ThreadPoolBuilder::new().num_threads(1).build_global();
    run_benches();
}

fn solid(cells: u32, prepare: impl Fn(Body) -> Body) -> (Solid, usize, f64) {
    let mesh = structured_box([cells; 3], Vec3::new(1.0, 1.0, 1.0), Some(Jitter { fraction: 0.1, seed: 1 }));
    let (mesh, _) = renumber_along_hilbert_curve(&mesh);
    let count = mesh.tetrahedra.len();
    let body = prepare(Body::new("box", ElementKind::T4, mesh.tetrahedra, CONCRETE));
    let mut solid = Solid::new(mesh.nodes, vec![body]).expect("a structured mesh makes a solid");
    for (i, u) in solid.displacement.iter_mut().enumerate() {
        u.x = 1e-7 * (0.1 * i as f64).sin();
    }
    let dt = 0.8 * solid.stable_step().dt();
    (solid, count, dt)
}

fn law(strength: f64) -> DamageLaw {
    DamageLaw::rankine(strength, 1e3)
}

fn bench_step(bencher: Bencher, cells: u32, prepare: impl Fn(Body) -> Body) {
    let (mut solid, count, dt) = solid(cells, prepare);
    bencher.counter(ItemsCount::new(count)).bench_local(|| {
        solid.update_internal_forces(dt, false);
        solid.kick_and_drift(dt, dt, LocalDamping::default(), &[], false)
    });
}

#[divan::bench(args = CELLS)]
fn plain(bencher: Bencher, cells: u32) {
    bench_step(bencher, cells, |body| body);
}

#[divan::bench(args = CELLS)]
fn smoothed(bencher: Bencher, cells: u32) {
    bench_step(bencher, cells, Body::smoothed);
}

#[divan::bench(args = CELLS)]
fn smoothed_armed(bencher: Bencher, cells: u32) {
    bench_step(bencher, cells, |body| body.smoothed().with_damage(law(3e6)));
}

/// Every edge is loaded beyond its strength: the price of the damage path.
#[divan::bench(args = [21])]
fn smoothed_damaged(bencher: Bencher, cells: u32) {
    bench_step(bencher, cells, |body| body.smoothed().with_damage(law(1e3)));
}

/// Forces of cells that are armed (strength 3 MPa), damaged (1 kPa) or have a phase field (100 kPa) in two steps, by kinematics and rotation about the z axis [rad].
///
/// All nodes swing more and more: in the first of the steps every damaged cell passes what it has seen, in the second it unloads.
#[divan::bench(args = [
    ("armed", false, 0.0), ("armed", true, 0.0), ("armed", true, 0.7),
    ("damaged", false, 0.0), ("damaged", true, 0.0), ("damaged", true, 0.7),
    ("phase field", false, 0.0), ("phase field", true, 0.7),
])]
fn cells_in_motion(bencher: Bencher, (state, corotational, angle): (&str, bool, f64)) {
    let kinematics = if corotational { Kinematics::Corotational } else { Kinematics::Small };
    let law = match state {
        "armed" => law(3e6),
        "damaged" => law(1e3),
        _ => DamageLaw::rankine(1e5, 1.0),
    };
    let (mut solid, count, dt) = solid(21, |body| {
        let mut body = body.smoothed().with_damage(law.clone());
        let zone = body.damage.as_mut().expect("it has just got a law");
        zone.regularisation = (state == "phase field").then_some(Regularisation { length: None });
        Body { kinematics, ..body }
    });
    swing_in_pairs(bencher, (&mut solid, count), angle, |solid| solid.update_internal_forces(dt, false));
}

/// The work of [`cells_in_motion`] beside the forces.
#[divan::bench]
fn cells_moved_alone(bencher: Bencher) {
    let (mut solid, count, _) = solid(21, |body| body);
    swing_in_pairs(bencher, (&mut solid, count), 0.0, |_| ());
}

/// Times pairs of steps in which all nodes swing, with `work` in each.
fn swing_in_pairs(bencher: Bencher, (solid, count): (&mut Solid, usize), angle: f64, work: impl Fn(&mut Solid)) {
    let (sin, cos) = f64::sin_cos(angle);
    let turned = |x: Vec3| Vec3::new(cos * x.x - sin * x.y, sin * x.x + cos * x.y, x.z);
    let mut pair = 0;
    bencher.counter(ItemsCount::new(2 * count)).bench_local(|| {
        pair += 1;
        let most = 1e-6 * (1.0 + 1e-3 * f64::from(pair));
        for swing in [most, 0.8 * most] {
            for (i, (u, x)) in solid.displacement.iter_mut().zip(&solid.reference).enumerate() {
                *u = turned(x + Vec3::new(swing * (0.1 * i as f64).sin(), 0.0, 0.0)) - x;
            }
            work(solid);
        }
    });
}

/// Building the cells, and the Lanczos process for the stable step.
#[divan::bench(args = [21])]
fn set_up(bencher: Bencher, cells: u32) {
    bencher.bench_local(|| solid(cells, Body::smoothed).2);
}
