//! Pressure that enters the cracks it opens: the surface it acts on, its work, its front, and the state that is saved.

use std::sync::Arc;

use fractum_fem::{Body, ElementKind, Plane, Solid};
use fractum_math::Vec3;
use fractum_mesh::generate::{Jitter, structured_box, structured_rectangle};
use fractum_scene::coupling::Debris;
use fractum_scene::{ContactParameters, CrackPressure, Load, Loads, Motion, Pressure, Scene, Support, Supports};
use fractum_tests::{CONCRETE, settings, softening, surface};

const THICKNESS: f64 = 0.02;
const INNER: f64 = 0.02;

/// A quarter of a ring of radii 20 and 120 mm, of triangles where it has no cells in z.
fn ring(cells: [u32; 3]) -> Solid {
    let jitter = Some(Jitter { fraction: 0.15, seed: 7 });
    let law = softening(10.0);
    let body = |kind, elements| Body::new("ring", kind, elements, CONCRETE).smoothed().with_damage(law);
    let (nodes, body) = if cells[2] == 0 {
        let mesh = structured_rectangle([cells[0], cells[1]], [1.0, 1.0], jitter);
        let elements = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
        (mesh.nodes, Body { plane: Plane::Strain, thickness: THICKNESS, ..body(ElementKind::T3, elements) })
    } else {
        let mesh = structured_box(cells, Vec3::new(1.0, 1.0, THICKNESS), jitter);
        (mesh.nodes, body(ElementKind::T4, mesh.tetrahedra))
    };
    let bend = |p: Vec3| {
        let (angle, radius) = (std::f64::consts::FRAC_PI_2 * (1.0 - p.x), INNER + 0.1 * p.y);
        let flat = |c: f64| if c.abs() < 1e-12 { 0.0 } else { c };
        Vec3::new(flat(radius * angle.cos()), flat(radius * angle.sin()), p.z)
    };
    Solid::new(nodes.into_iter().map(bend).collect(), vec![body]).unwrap()
}

/// Facets of the hole.
fn hole(solid: &Solid) -> Vec<[u32; 3]> {
    let inside = |n: &u32| solid.reference[*n as usize].xy().norm() < 1.001 * INNER;
    surface(solid).into_iter().filter(|facet| facet.iter().all(inside)).collect()
}

/// 10 MPa within 4 µs that decay slowly.
fn pulse(t: f64) -> f64 {
    10e6 * (t / 4e-6).clamp(0.0, 1.0) * (-(t - 4e-6).max(0.0) / 60e-6).exp()
}

/// A ring under the pulse, in its hole alone (none) or in its cracks with a front.
fn blast(cells: [u32; 3], in_cracks: Option<Option<f64>>, end: f64) -> Scene {
    let solid = ring(cells);
    let facets = hole(&solid);
    let value = Arc::new(|t: f64, _: &Vec3| pulse(t));
    let load = match in_cracks {
        None => Load::Pressure(Pressure { facets, value }),
        Some(speed) => Load::CrackPressure(CrackPressure::new(facets, value, speed)),
    };
    let on_axis = |axis: usize| {
        let nodes = (0..solid.reference.len() as u32).filter(|&n| solid.reference[n as usize][axis] == 0.0);
        Support::new("symmetry", nodes.collect(), axis, Motion::Fixed)
    };
    let supports = Supports::new(vec![on_axis(0), on_axis(1)], &solid.reference).unwrap();
    let loads = Loads::new(vec![load], solid.reference.len());
    let debris = Debris::new(&solid, vec![ContactParameters { friction: 0.5, ..ContactParameters::default() }]);
    Scene::new(solid, supports, loads, debris, Vec::new(), &[], settings(end, f64::INFINITY))
}

/// Removed elements, work of the pressure and largest relative residual at the end.
fn run(mut scene: Scene) -> [f64; 3] {
    while !scene.is_finished() {
        scene.step(true).unwrap();
    }
    let ledger = scene.ledger();
    [scene.counts().removed_elements as f64, ledger[fractum_scene::EnergyKind::External], ledger.residual_max_relative]
}

#[test]
fn pressure_in_the_cracks_lengthens_them_and_the_balance_closes() {
    for cells in [[36, 27, 0], [9, 8, 2]] {
        let [dry, slow, at_once] =
            [None, Some(Some(200.0)), Some(None)].map(|in_cracks| run(blast(cells, in_cracks, 80e-6)));
        println!("{cells:?}: dry {dry:?}, front of 200 m/s {slow:?}, at once {at_once:?}");
        assert!(at_once[0] > 1.2 * dry[0] && at_once[1] > dry[1], "{cells:?}");
        assert!(slow[0] < at_once[0], "{cells:?}");
        for [_, _, residual] in [dry, slow, at_once] {
            assert!(residual < 1e-3, "{cells:?}: {residual}");
        }
    }
}

#[test]
fn a_front_that_never_gets_far_leaves_the_cracks_dry() {
    let cells = [36, 27, 0];
    // Walls of removed elements at the hole carry nothing instead of the facets that were there.
    let [_, none, _] = run(blast(cells, Some(Some(1e-3)), 80e-6));
    let [_, dry, _] = run(blast(cells, None, 80e-6));
    assert!(none < dry);
}

#[test]
fn a_run_goes_on_from_a_saved_state_with_the_same_bits() {
    let build = || blast([36, 27, 0], Some(Some(400.0)), 60e-6);
    let mut whole = build();
    let mut saved = None;
    while !whole.is_finished() {
        whole.step(false).unwrap();
        if whole.clock.time > 30e-6 && saved.is_none() {
            assert!(whole.counts().removed_elements > 0);
            saved = Some(whole.state());
        }
    }
    let mut resumed = build();
    resumed.restore(saved.unwrap());
    while !resumed.is_finished() {
        resumed.step(false).unwrap();
    }
    assert!(resumed.state() == whole.state());
}
