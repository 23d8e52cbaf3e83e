//! Paths of equilibrium through the snap-back of interfaces, against closed forms.

use std::sync::Arc;

use fractum_fem::ElementKind;
use fractum_scene::statics::{Control, StaticSettings, StaticSolver};
use fractum_scene::{EnergyKind, InterfaceLaw, InterfaceSoftening, Motion, Scene, StepError, Support};
use fractum_tests::{CONCRETE, statics};

use crate::interfaces::{Bar, LAW};

/// Pulls a bar by its right end, all of it held across.
fn pulled(bar: &Bar, longest: f64) -> (Scene, Vec<u32>) {
    let length = bar.extent()[0];
    let mut right = Vec::new();
    let (scene, _) = bar.scene(1.0, |mesh| {
        right = Bar::at(mesh, |p| p.x > length - 1e-9);
        let across = 1..if bar.kind == ElementKind::T3 { 2 } else { 3 };
        let all = Bar::at(mesh, |_| true);
        let moved = Motion::Displacement(Arc::new(move |t, _| longest * t));
        let held = across.map(|axis| Support::new("all", all.clone(), axis, Motion::Fixed));
        let mut supports: Vec<Support> = held.collect();
        supports.push(Support::new("left", Bar::at(mesh, |p| p.x < 1e-9), 0, Motion::Fixed));
        supports.push(Support::new("right", right.clone(), 0, moved));
        supports
    });
    (scene, right)
}

/// Traction of an interface that only opens, by its opening [m].
fn traction(law: &InterfaceLaw, stiffness: f64, opening: f64) -> f64 {
    let first = law.tensile_strength / stiffness;
    let energy = law.opening_energy / (law.tensile_strength * first);
    let ratio = opening / first;
    let left = match law.softening {
        _ if ratio <= 1.0 => ratio,
        InterfaceSoftening::Linear => ((2.0 * energy - ratio) / (2.0 * energy - 1.0)).max(0.0),
        InterfaceSoftening::Exponential => ((1.0 - ratio) / (energy - 0.5)).exp(),
    };
    law.tensile_strength * left
}

/// Two elastic bars and one face in series: u = t L/M + w(t), and t(w) is the law. The bars are so long that the end goes back as the face opens.
#[test]
fn two_bars_and_a_face_follow_their_curve_through_snap_back() {
    for kind in [ElementKind::T3, ElementKind::T4] {
        for softening in [InterfaceSoftening::Linear, InterfaceSoftening::Exponential] {
            for (poisson_ratio, stiffness) in [(0.0, 1e14), (0.2, 1e14), (0.4, 4e12)] {
                let law = InterfaceLaw { opening_energy: 2.0, sliding_energy: 2.0, softening, ..LAW };
                let bar = Bar { poisson_ratio, cells: [40, 1], ..Bar::new(kind, Some((law, Some([stiffness; 2])))) };
                let name = format!("{kind:?} {softening:?} {poisson_ratio}");
                let nu = poisson_ratio;
                let modulus = CONCRETE.young_modulus * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
                let elastic = law.tensile_strength * bar.extent()[0] / modulus;
                let (mut scene, right) = pulled(&bar, 3.0 * elastic);
                let settings = StaticSettings { control: Control::Path, ..statics(0.02, 1.0) };
                let mut solver = StaticSolver::new(&scene, settings).unwrap();
                let places = scene.supports().places(&right);
                let (mut peak, mut back, mut time, mut stress) = (0.0f64, false, 0.0, 0.0f64);
                while stress >= 0.05 * peak {
                    solver.step(&mut scene).unwrap_or_else(|error| panic!("{name}: {error}"));
                    stress = scene.supports().reaction(&places, &fractum_math::Vec3::x()) / bar.area();
                    let opening = 3.0 * elastic * scene.clock.time - stress * bar.extent()[0] / modulus;
                    let expected = traction(&law, stiffness, opening);
                    let error = (stress - expected).abs() / law.tensile_strength;
                    assert!(error < 1e-6, "{name}: {stress} at an opening of {opening:e}, {expected} expected");
                    back |= scene.clock.time < time;
                    (time, peak) = (scene.clock.time, peak.max(stress));
                }
                assert!((peak / law.tensile_strength - 1.0).abs() < 1e-6, "{name}: peak {peak}");
                assert!(back, "{name}: the end goes back");
                let ledger = scene.ledger();
                assert!(ledger.residual_max_relative < 1e-6, "{name}: {ledger:?}");
                // What is left below the curve: the last twentieth of the stress.
                let [stored, taken] = [EnergyKind::Interfaces, EnergyKind::InterfaceFracture].map(|kind| ledger[kind]);
                let share = (stored + taken) / (law.opening_energy * bar.area());
                assert!((0.94..1.01).contains(&share), "{name}: {share} of the fracture energy");
            }
        }
    }
}

/// Steps of the load alone have no equilibrium beyond the peak; where the case leaves the choice they give way to the path.
#[test]
fn steps_of_the_load_give_way_to_the_path_where_they_have_no_equilibrium() {
    let law = InterfaceLaw { opening_energy: 2.0, sliding_energy: 2.0, ..LAW };
    let bar = Bar { poisson_ratio: 0.0, cells: [40, 1], ..Bar::new(ElementKind::T3, Some((law, Some([1e14; 2])))) };
    let elastic = law.tensile_strength * bar.extent()[0] / CONCRETE.young_modulus;
    let run = |control: Control, step: f64| {
        let (mut scene, right) = pulled(&bar, 3.0 * elastic);
        let mut solver = StaticSolver::new(&scene, StaticSettings { control, ..statics(step, 1.0) }).unwrap();
        let places = scene.supports().places(&right);
        let (mut peak, mut stress) = (0.0f64, 0.0f64);
        while stress >= 0.1 * peak {
            solver.step(&mut scene)?;
            stress = scene.supports().reaction(&places, &fractum_math::Vec3::x()) / bar.area();
            peak = peak.max(stress);
        }
        Ok((peak, solver.has_turned_to_path()))
    };
    assert!(matches!(run(Control::Time, 0.02), Err(StepError::NoEquilibrium { .. })));
    let (by_path, _) = run(Control::Path, 0.02).unwrap();
    // The onset is met by steps of any size.
    for step in [0.02, 0.07, 0.24] {
        let (peak, has_turned) = run(Control::TimeThenPath, step).unwrap();
        assert!(has_turned);
        assert!((peak / by_path - 1.0).abs() < 1e-6, "{peak} {by_path} {step}");
    }
}

/// The path is the same on any threads, and goes on after a stop within its snap-back as if there had been none.
#[test]
fn a_path_of_interfaces_has_the_same_bits_on_any_threads_and_after_a_resume() {
    let law = InterfaceLaw { opening_energy: 2.0, sliding_energy: 2.0, ..LAW };
    let bar = Bar { cells: [40, 1], ..Bar::new(ElementKind::T4, Some((law, Some([1e14; 2])))) };
    let elastic = law.tensile_strength * bar.extent()[0] / CONCRETE.young_modulus;
    for control in [Control::Path, Control::TimeThenPath] {
        let run = |threads: usize, resume: bool| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let new = |scene: &Scene| {
                let settings = StaticSettings { control: control.clone(), ..statics(0.02, 1.0) };
                StaticSolver::new(scene, settings).unwrap()
            };
            pool.install(|| {
                let (mut scene, _) = pulled(&bar, 3.0 * elastic);
                let mut solver = new(&scene);
                let (mut back, mut time) = (0, 0.0);
                while back < 6 {
                    solver.step(&mut scene).unwrap();
                    back += u32::from(scene.clock.time < time);
                    time = scene.clock.time;
                    if resume && back == 3 {
                        let (state, remembered) = (scene.state(), solver.state());
                        scene = pulled(&bar, 3.0 * elastic).0;
                        solver = new(&scene);
                        scene.restore(state);
                        solver.restore(remembered);
                    }
                }
                (scene.solid.displacement.clone(), *scene.ledger(), scene.state())
            })
        };
        let one = run(1, false);
        for (threads, resume) in [(2, false), (7, false), (1, true)] {
            assert!(one == run(threads, resume), "{control:?} {threads} {resume}");
        }
    }
}
