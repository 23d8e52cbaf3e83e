//! Gas in a hole that breaks the solid around it and follows its cracks: balance of solid and gas, adiabatic expansion,
//! what is saved, threads.

use fractum_fem::{Body, ElementKind, Plane, Region, Solid};
use fractum_gas::{EquationOfState, PerfectGas, SlitFlow};
use fractum_math::Vec3;
use fractum_mesh::generate::{Jitter, structured_box, structured_rectangle};
use fractum_mesh::topology::boundary_of_tetrahedra;
use fractum_scene::coupling::Debris;
use fractum_scene::{
    Charge, ContactParameters, EnergyKind, Gas, GasHole, GasSettings, HoleEnds, Loads, Motion, Scene, Support,
    Supports, SymmetryPlanes,
};
use fractum_tests::{CONCRETE, softening, surface};

const SIZE: f64 = 0.3;
const HEAT_RATIO: f64 = 1.3;

/// A plate, or a cube, with a hole of a tenth of its size in the middle.
fn holed(cells: u32, plane: bool, damage: bool) -> Solid {
    cut(cells, plane, if plane { 2 } else { 3 }, damage)
}

/// - `axes`: number of axes along which the hole ends; 2 in space for a hole along z through the cube
fn cut(cells: u32, plane: bool, axes: usize, damage: bool) -> Solid {
    let jitter = Some(Jitter { fraction: 0.1, seed: 3 });
    let (nodes, elements, kind) = if plane {
        let mesh = structured_rectangle([cells, cells], [SIZE, SIZE], jitter);
        (mesh.nodes, mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect(), ElementKind::T3)
    } else {
        let mesh = structured_box([cells; 3], Vec3::repeat(SIZE), jitter);
        (mesh.nodes, mesh.tetrahedra, ElementKind::T4)
    };
    let centre = |e: &[u32; 4]| {
        e[..kind.node_count()].iter().map(|&n| nodes[n as usize]).sum::<Vec3>() / kind.node_count() as f64
    };
    let far = |e: &[u32; 4]| {
        let away = (centre(e) - Vec3::repeat(0.5 * SIZE)).abs();
        away.iter().take(axes).any(|away| *away > 0.05 * SIZE)
    };
    let elements: Vec<[u32; 4]> = elements.into_iter().filter(|e: &[u32; 4]| far(e)).collect();
    let mut new = vec![u32::MAX; nodes.len()];
    elements.iter().flatten().for_each(|&n| new[n as usize] = 0);
    let kept: Vec<usize> = (0..nodes.len()).filter(|&n| new[n] == 0).collect();
    (0..).zip(&kept).for_each(|(number, &n)| new[n] = number);
    let elements: Vec<_> = elements.into_iter().map(|e| e.map(|n| new[n as usize])).collect();
    let law = softening(10.0);
    let body =
        Body { plane: Plane::Strain, thickness: 0.02, ..Body::new("block", kind, elements, CONCRETE).smoothed() };
    let body = if damage { body.with_damage(law) } else { body };
    Solid::new(kept.into_iter().map(|n| nodes[n]).collect(), vec![body]).unwrap()
}

/// Facets of the hole.
fn hole(solid: &Solid) -> Vec<[u32; 3]> {
    let inside = |&n: &u32| {
        let p = &solid.reference[n as usize];
        p.iter().take(if solid.is_plane() { 2 } else { 3 }).all(|c| *c > 0.01 * SIZE && *c < 0.99 * SIZE)
    };
    surface(solid).into_iter().filter(|facet| facet.iter().all(inside)).collect()
}

fn blast(solid: Solid, pressure: f64, end: f64) -> Scene {
    let facets = hole(&solid);
    blast_in(solid, facets, SymmetryPlanes::default(), pressure, end)
}

/// Gas in a hole of a solid that is held where it ends at planes of symmetry.
fn blast_in(solid: Solid, facets: Vec<[u32; 3]>, symmetry: SymmetryPlanes, pressure: f64, end: f64) -> Scene {
    let gas = GasSettings {
        law: EquationOfState::PerfectGas(PerfectGas { heat_ratio: HEAT_RATIO, gas_constant: 300.0 }),
        slits: SlitFlow { viscosity: 5e-5, roughness: 1e-5 },
        least_opening: 1e-5,
        in_cracks: true,
        outside_pressure: 1e5,
        symmetry,
        holes: vec![GasHole {
            stemming: None,
            ends: HoleEnds::find(&solid, &facets, symmetry, false).unwrap(),
            facets,
            charge: Charge::State { pressure, temperature: 2500.0 },
            source: None,
        }],
    };
    let loads = Loads::new(Vec::new(), solid.reference.len()).with_gas(Some(Gas::new(&solid, gas)));
    let debris = Debris::new(&solid, vec![ContactParameters { friction: 0.5, ..ContactParameters::default() }]);
    let held = (0..3).filter_map(|axis| {
        let on = |n: &u32| (solid.reference[*n as usize][axis] - symmetry.0[axis].unwrap()).abs() < 1e-9;
        symmetry.0[axis]?;
        let nodes = (0..solid.reference.len() as u32).filter(on).collect();
        Some(Support::new("symmetry", nodes, axis, Motion::Fixed))
    });
    let supports = Supports::new(held.collect(), &solid.reference).unwrap();
    let settings = fractum_tests::settings(end, f64::INFINITY);
    Scene::new(solid, supports, loads, debris, Vec::new(), &[], settings)
}

#[test]
fn gas_breaks_the_solid_follows_its_cracks_and_the_balance_closes() {
    for (cells, plane) in [(40, true), (10, false)] {
        let mut scene = blast(holed(cells, plane, true), 12e6, 150e-6);
        while !scene.is_finished() {
            scene.step(true).unwrap();
        }
        let ledger = *scene.ledger();
        let gas = scene.gas().unwrap();
        let work = ledger[EnergyKind::GasSupplied] - ledger[EnergyKind::Gas] - ledger[EnergyKind::GasLeaked];
        let filled = gas.cells().filter(|cell| cell.element().is_some() && cell.pressure > 1e5).count();
        println!(
            "{cells}: removed {}, cells {filled}, work {work:.3} J of {:.3} J, leaked {:.3} J, residual {:.2e}",
            scene.counts().removed_elements,
            ledger[EnergyKind::GasSupplied],
            ledger[EnergyKind::GasLeaked],
            ledger.residual_max_relative
        );
        assert!(filled > 10 && work > 0.0);
        assert!(ledger.residual_max_relative < 5e-3);
        assert_eq!(ledger[EnergyKind::External], 0.0);
        assert!(gas.cells().all(|cell| cell.amount.mass >= 0.0 && cell.amount.energy >= 0.0));
    }
}

#[test]
fn a_hole_through_a_cube_is_closed_by_stemming() {
    let solid = cut(11, false, 2, false);
    let z = |n: u32| solid.reference[n as usize].z;
    let inner = |n: &u32| (solid.reference[*n as usize] - Vec3::repeat(0.5 * SIZE)).xy().amax() < 0.3 * SIZE;
    let on_end = |f: &[u32; 3]| f.iter().all(|&n| z(n) == 0.0) || f.iter().all(|&n| z(n) == SIZE);
    let facets = boundary_of_tetrahedra(&solid.body(0).elements).into_iter().map(|facet| facet.nodes);
    let facets: Vec<[u32; 3]> = facets.filter(|f| f.iter().all(inner) && !on_end(f)).collect();
    let ends = HoleEnds::find(&solid, &facets, SymmetryPlanes::default(), true).unwrap();
    let rest: f64 = (0..solid.body(0).elements.len() as u32).map(|e| solid.element_volume(0, e)).sum();
    let volume = Gas::hole_volume(&solid, &facets, &ends);
    assert!((volume / (SIZE.powi(3) - rest) - 1.0).abs() < 1e-9, "{volume}");
    // Half of the wall of the hole has one rim, which is not flat.
    let half = |f: &&[u32; 3]| f.iter().all(|&n| solid.reference[n as usize].x <= 0.5 * SIZE);
    let half: Vec<[u32; 3]> = facets.iter().filter(half).copied().collect();
    assert!(HoleEnds::find(&solid, &half, SymmetryPlanes::default(), true).is_err());
}

/// The part of a plate or cube with a hole beyond the planes through its middle, with the facets of the hole.
fn part(cells: u32, plane: bool, damage: bool) -> (Solid, Vec<[u32; 3]>, SymmetryPlanes) {
    let (axes, half) = (if plane { 2 } else { 3 }, 0.5 * SIZE);
    let whole = cut(cells, plane, axes, damage);
    let body = whole.body(0);
    let corners = body.shape.node_count();
    let inside = |e: &&[u32; 4]| {
        let centre = e[..corners].iter().map(|&n| whole.reference[n as usize]).sum::<Vec3>() / corners as f64;
        centre.iter().take(axes).all(|c| *c > half)
    };
    let elements: Vec<[u32; 4]> = body.elements.iter().filter(inside).copied().collect();
    let mut new = vec![u32::MAX; whole.reference.len()];
    elements.iter().flatten().for_each(|&n| new[n as usize] = 0);
    let kept: Vec<usize> = (0..new.len()).filter(|&n| new[n] == 0).collect();
    (0..).zip(&kept).for_each(|(number, &n)| new[n] = number);
    // Nodes that the jitter has moved off the planes go back to them.
    let cell = SIZE / cells as f64;
    let on_plane = |c: f64| if (c - half).abs() < 0.3 * cell { half } else { c };
    let nodes = kept.into_iter().map(|n| {
        let mut place = whole.reference[n];
        place.iter_mut().take(axes).for_each(|c| *c = on_plane(*c));
        place
    });
    let elements: Vec<_> = elements.into_iter().map(|e| e.map(|n| new[n as usize])).collect();
    let nodes: Vec<Vec3> = nodes.collect();
    let mut body = Body { elements: elements.into(), ..body.clone() };
    let midpoints = body.edge_midpoints(&nodes);
    if let Some(zone) = &mut body.damage {
        // A crack can only run along a plane of symmetry.
        zone.region = Region::Edges(midpoints.iter().map(|p| p.x < half + cell).collect());
    }
    let solid = Solid::new(nodes, vec![body]).unwrap();
    let planes = SymmetryPlanes([Some(half), Some(half), (!plane).then_some(half)]);
    let near = |n: &u32| (solid.reference[*n as usize] - Vec3::repeat(half)).iter().take(axes).all(|c| *c < 0.3 * SIZE);
    let wall = |f: &[u32; 3]| f.iter().all(near) && !planes.hold(&solid, f, cell);
    let facets = surface(&solid).into_iter().filter(wall).collect();
    (solid, facets, planes)
}

#[test]
fn a_hole_may_end_at_planes_of_symmetry() {
    for (cells, plane, share) in [(40, true, 0.25), (20, false, 0.125)] {
        let (solid, facets, planes) = part(cells, plane, false);
        assert!(HoleEnds::find(&solid, &facets, SymmetryPlanes::default(), false).is_err());
        let ends = HoleEnds::find(&solid, &facets, planes, false).unwrap();
        let block = share * if plane { 0.02 * SIZE.powi(2) } else { SIZE.powi(3) };
        let rest: f64 = (0..solid.body(0).elements.len() as u32).map(|e| solid.element_volume(0, e)).sum();
        let volume = Gas::hole_volume(&solid, &facets, &ends);
        assert!((volume / (block - rest) - 1.0).abs() < 1e-9, "{volume}");
        let mut scene = blast_in(solid, facets, planes, 200e6, 100e-6);
        let hole = |scene: &Scene| scene.gas().unwrap().cells().next().unwrap();
        let invariant = |scene: &Scene| hole(scene).pressure * hole(scene).volume.powf(HEAT_RATIO);
        scene.step(true).unwrap();
        let (start, rest) = (invariant(&scene), hole(&scene).volume);
        let mut largest: f64 = 0.0;
        while !scene.is_finished() {
            scene.step(true).unwrap();
            largest = largest.max(hole(&scene).volume / rest - 1.0);
            assert!((invariant(&scene) / start - 1.0).abs() < 1e-6);
        }
        assert!(largest > 1e-2 && scene.ledger().residual_max_relative < 1e-9);
    }
}

#[test]
fn gas_does_not_leak_where_cracks_reach_a_plane_of_symmetry() {
    let (solid, facets, planes) = part(40, true, true);
    let mut scene = blast_in(solid, facets, planes, 20e6, 60e-6);
    let is_far = |scene: &Scene, (body, element): (usize, u32)| {
        scene.solid.element_middle(body, element).iter().take(2).any(|c| *c > 0.9 * SIZE)
    };
    let reached = |scene: &Scene| {
        scene.gas().unwrap().cells().filter_map(|cell| cell.element()).any(|element| is_far(scene, element))
    };
    while !scene.is_finished() && !reached(&scene) {
        scene.step(true).unwrap();
    }
    let gas = scene.gas().unwrap();
    let on_plane = gas.cells().filter_map(|cell| cell.element()).filter(|&(body, element)| {
        let nodes = scene.solid.body(body).elements[element as usize];
        (0..3).any(|i| planes.hold(&scene.solid, &[nodes[i], nodes[(i + 1) % 3]], 0.01))
    });
    let (on_plane, leaked) = (on_plane.count(), gas.leaked().mass);
    assert!(
        on_plane > 0 && leaked == 0.0,
        "{on_plane} cells on planes of {}, leaked {leaked:e} kg",
        gas.cells().count()
    );
}

#[test]
fn gas_in_a_hole_that_does_not_break_keeps_its_adiabatic_invariant() {
    for (cells, plane) in [(20, true), (10, false)] {
        let mut scene = blast(holed(cells, plane, false), 200e6, 200e-6);
        let invariant = |scene: &Scene| {
            let hole = scene.gas().unwrap().cells().next().unwrap();
            hole.pressure * hole.volume.powf(HEAT_RATIO)
        };
        scene.step(true).unwrap();
        let volume = |scene: &Scene| scene.gas().unwrap().cells().next().unwrap().volume;
        let (start, rest) = (invariant(&scene), volume(&scene));
        let mut largest: f64 = 0.0;
        while !scene.is_finished() {
            scene.step(true).unwrap();
            largest = largest.max(volume(&scene) / rest - 1.0);
        }
        let error = invariant(&scene) / start - 1.0;
        println!(
            "{cells}: volume up to {largest:.2e} more, invariant {error:.2e}, residual {:.2e}",
            scene.ledger().residual_max_relative
        );

        assert!(largest > 5e-3 && error.abs() < 1e-4);
        assert!(scene.ledger().residual_max_relative < 1e-6);
    }
}

#[test]
fn a_run_with_gas_goes_on_from_a_saved_state_with_the_same_bits_on_any_number_of_threads() {
    let end = 80e-6;
    let build = || blast(holed(30, true, true), 12e6, end);
    let run = |mut scene: Scene| {
        let mut saved = None;
        while !scene.is_finished() {
            scene.step(false).unwrap();
            if scene.clock.time > 0.5 * end && saved.is_none() {
                assert!(scene.gas().unwrap().cells().count() > 1);
                saved = Some(scene.state());
            }
        }
        (scene.state(), saved.unwrap())
    };
    let states = [1, 2, 7].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(build()))
    });
    assert!(states.iter().all(|state| *state == states[0]));
    let mut resumed = build();
    resumed.restore(states[0].1.clone());
    assert!(resumed.state() == states[0].1);
    while !resumed.is_finished() {
        resumed.step(false).unwrap();
    }
    assert!(resumed.state() == states[0].0);
}
