//! Bedded rock: Young's modulus by the angle of a pull to the beds, waves by their direction, turning, stable steps, vibrations.

use std::f64::consts::PI;
use std::sync::Arc;

use fractum_fem::{
    Bedding, Body, Elastic, ElementKind, Formulation, Kinematics, LocalDamping, Plane, Solid, Stiffness, Viscosity,
    motion,
};
use fractum_math::{Mat3, Sym3, Vec3, rotation_by};
use fractum_mesh::generate::{Jitter, structured_box, structured_rectangle};
use fractum_scene::coupling::Debris;
use fractum_scene::statics::{LinearSolver, ModesSettings, StaticSettings, StaticSolver, find_modes};
use fractum_scene::{
    ContactParameters, Load, Loads, Motion, NodalForce, Scene, SceneSettings, Support, SupportedFacet, Supports,
    SurfaceSupports,
};
use fractum_tests::{jittered_box, noise, settings, statics, surface};

const FORMULATIONS: [Formulation; 2] = [Formulation::Standard, Formulation::Smoothed];

/// Within its beds.
const SHALE: Elastic = Elastic { density: 2500.0, young_modulus: 27e9, poisson_ratio: 0.15 };

fn beds(normal: Vec3) -> Bedding {
    Bedding { normal: normal.normalize(), young_modulus: 12e9, poisson_ratio: 0.2, shear_modulus: 4.5e9 }
}

/// Normals in no plane, in the xy-plane, and along axes.
fn normals() -> Vec<Vec3> {
    let skew = [Vec3::new(0.3, -0.7, 0.5), Vec3::new(-0.4, 0.2, 0.9), Vec3::new(1.0, 1.0, 1.0)];
    skew.into_iter().chain(in_plane()).chain([Vec3::z()]).collect()
}

fn in_plane() -> Vec<Vec3> {
    [0.0_f64, 30.0, 45.0, 60.0, 90.0, 135.0].map(|a| Vec3::new(a.to_radians().cos(), a.to_radians().sin(), 0.0)).into()
}

/// The strain of a pull of 1 Pa along x, axis by axis of the beds.
fn strain_of_pull(elastic: &Elastic, beds: &Bedding) -> Mat3 {
    let n = beds.normal;
    let a = n.cross(&Vec3::ith(n.iamin(), 1.0)).normalize();
    let axes = Mat3::from_columns(&[a, n.cross(&a), n]);
    let s = axes.transpose() * Mat3::from_diagonal(&Vec3::x()) * axes;
    let (young, nu) = (elastic.young_modulus, elastic.poisson_ratio);
    let (normal, across, shear) = (beds.young_modulus, beds.poisson_ratio, beds.shear_modulus);
    let twice = |value: f64| 0.5 * value / shear;
    let own = Mat3::new(
        (s.m11 - nu * s.m22) / young - across * s.m33 / normal,
        s.m12 * (1.0 + nu) / young,
        twice(s.m13),
        s.m12 * (1.0 + nu) / young,
        (s.m22 - nu * s.m11) / young - across * s.m33 / normal,
        twice(s.m23),
        twice(s.m13),
        twice(s.m23),
        s.m33 / normal - across * (s.m11 + s.m22) / normal,
    );
    axes * own * axes.transpose()
}

fn scene_of(solid: Solid, supports: Vec<Support>, loads: Vec<Load>, settings: SceneSettings) -> Scene {
    let supports = Supports::new(supports, &solid.reference).unwrap();
    let loads = Loads::new(loads, solid.reference.len());
    let debris = Debris::new(&solid, vec![ContactParameters::default()]);
    Scene::new(solid, supports, loads, debris, Vec::new(), &[], settings)
}

/// A box or a sheet of jittered elements, one metre long times `size`.
fn specimen(shape: ElementKind, size: f64) -> (Vec<Vec3>, Body) {
    if shape == ElementKind::T4 {
        return jittered_box([4, 3, 3], Vec3::new(1.0, 0.7, 0.6) * size);
    }
    let mesh = structured_rectangle([6, 4], [size, 0.7 * size], Some(Jitter { fraction: 0.15, seed: 5 }));
    let elements = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
    (mesh.nodes, Body { thickness: 0.1 * size, ..Body::new("sheet", shape, elements, SHALE) })
}

/// The modulus of a specimen that is pulled along x by even tractions on its ends, at rest, and its displacements.
fn pulled(nodes: Vec<Vec3>, body: Body) -> (f64, Vec<Vec3>) {
    let (plane, thickness) = (body.shape == ElementKind::T3, body.thickness);
    let solid = Solid::new(nodes, vec![body]).unwrap();
    let size = solid.reference.iter().fold(Vec3::zeros(), |most, p| most.sup(p));
    let traction = 1e6;
    let mut points = Vec::new();
    for facet in surface(&solid) {
        let [a, b, c] = facet.map(|node| solid.reference[node as usize]);
        let end = [a, b, c].iter().map(|p| p.x).sum::<f64>() / 3.0;
        let sign = if end < 1e-9 * size.x { -1.0 } else { 1.0 };
        if end > 1e-9 * size.x && end < size.x * (1.0 - 1e-9) {
            continue;
        }
        let (area, corners) =
            if plane { ((b - a).norm() * thickness, 2) } else { (0.5 * (b - a).cross(&(c - a)).norm(), 3) };
        points.extend(facet[..corners].iter().map(|&node| (node, sign * traction * area / corners as f64)));
    }
    let at = |x: Vec3| {
        let found = (0..).zip(&solid.reference).find(|(_, p)| (**p - x).norm() < 1e-9 * size.x);
        found.map(|(node, _)| vec![node]).unwrap()
    };
    let (origin, far, side) = (at(Vec3::zeros()), at(Vec3::new(size.x, 0.0, 0.0)), at(Vec3::new(0.0, size.y, 0.0)));
    let fixed = |nodes: &[u32], axis| Support::new("held", nodes.to_vec(), axis, Motion::Fixed);
    let mut supports = vec![fixed(&origin, 0), fixed(&origin, 1), fixed(&far, 1)];
    if !plane {
        supports.extend([fixed(&origin, 2), fixed(&far, 2), fixed(&side, 2)]);
    }
    let load = Load::Nodal(NodalForce { points, axis: 0, value: Arc::new(|t, _| t) });
    let mut scene = scene_of(solid, supports, vec![load], settings(1.0, 1e-2));
    let statics = StaticSettings { tolerance: 1e-9, ..statics(1.0, 1.0) };
    let mut solver = StaticSolver::new(&scene, statics).unwrap();
    while !solver.is_finished(&scene) {
        solver.step(&mut scene).unwrap();
    }
    assert!(scene.ledger().relative_residual() < 1e-9);
    let displacement = scene.solid.displacement;
    (traction * size.x / (displacement[far[0] as usize].x - displacement[origin[0] as usize].x), displacement)
}

#[test]
fn a_pull_has_the_modulus_of_its_angle_to_the_beds() {
    for size in [1e-3, 1.0] {
        for (nu, across) in [(0.15, 0.2), (0.0, 0.0), (0.45, 0.3)] {
            for normal in normals() {
                for formulation in FORMULATIONS {
                    let elastic = Elastic { poisson_ratio: nu, ..SHALE };
                    let bedding = Bedding { poisson_ratio: across, ..beds(normal) };
                    let strain = strain_of_pull(&elastic, &bedding);
                    let free = bedding.young_modulus_along(&elastic, bedding.normal.x);
                    assert!((strain.m11 * free - 1.0).abs() < 1e-12);
                    let seen = |shape, plane| {
                        let (nodes, body) = specimen(shape, size);
                        pulled(nodes, Body { elastic, bedding: Some(bedding), plane, formulation, ..body }).0
                    };
                    let what = format!("{size} m, nu {nu}, {normal:?}, {formulation:?}");
                    let space = seen(ElementKind::T4, Plane::Strain);
                    assert!((space / free - 1.0).abs() < 1e-9, "{what}: {space:e} of {free:e}");
                    let sheet = seen(ElementKind::T3, Plane::Stress);
                    assert!((sheet / free - 1.0).abs() < 1e-9, "{what}, plane stress: {sheet:e} of {free:e}");
                    if normal.z != 0.0 && normal != Vec3::z() {
                        continue;
                    }
                    // Nothing is stretched across the plane: what it would contract is held by a stress there.
                    let modulus = if normal.z == 0.0 { elastic.young_modulus } else { bedding.young_modulus };
                    let held = 1.0 / (strain.m11 - strain.m33 * strain.m33 * modulus);
                    let strained = seen(ElementKind::T3, Plane::Strain);
                    assert!((strained / held - 1.0).abs() < 1e-9, "{what}, plane strain: {strained:e} of {held:e}");
                }
            }
        }
    }
}

/// Also askew to a plane, where beds that differ in nothing bring no motion across it.
#[test]
fn beds_that_differ_in_nothing_give_the_displacements_of_hookes_law() {
    for nu in [0.0, 0.3, 0.45] {
        let elastic = Elastic { poisson_ratio: nu, ..SHALE };
        for normal in normals() {
            let shear_modulus = elastic.shear_modulus();
            let none = Bedding { normal: normal.normalize(), young_modulus: 27e9, poisson_ratio: nu, shear_modulus };
            for (shape, plane) in
                [(ElementKind::T4, Plane::Strain), (ElementKind::T3, Plane::Strain), (ElementKind::T3, Plane::Stress)]
            {
                for formulation in FORMULATIONS {
                    let run = |bedding| {
                        let (nodes, body) = specimen(shape, 1.0);
                        pulled(nodes, Body { elastic, bedding, plane, formulation, ..body }).1
                    };
                    let (with, without) = (run(Some(none)), run(None));
                    let largest = without.iter().map(|u| u.norm()).fold(0.0, f64::max);
                    for (with, without) in with.iter().zip(&without) {
                        let off = (with - without).norm() / largest;
                        assert!(off < 1e-12, "{nu} {normal:?} {shape:?} {plane:?} {formulation:?}: {off:e}");
                    }
                }
            }
        }
    }
}

/// ρ c² of the waves of an angle to the normal: quasi-compression, shear within the beds, quasi-shear. Mavko, Mukerji and Dvorkin, *The Rock Physics
/// Handbook* (2009), section 2.2.
fn wave_moduli(elastic: &Elastic, beds: &Bedding, cosine: f64) -> [f64; 3] {
    let law = Stiffness::new(elastic, &Bedding { normal: Vec3::z(), ..*beds }, None);
    let c = law.rows();
    let (c11, c33, c44, c66, c13) = (c[0][0], c[2][2], c[4][4], c[3][3], c[0][2]);
    let (along, within) = (cosine * cosine, 1.0 - cosine * cosine);
    let sum = c11 * within + c33 * along + c44;
    let difference = (c11 - c44) * within - (c33 - c44) * along;
    let root = (difference * difference + 4.0 * (c13 + c44).powi(2) * within * along).sqrt();
    [0.5 * (sum + root), c66 * within + c44 * along, 0.5 * (sum - root)]
}

/// Accelerations of nodes far from the surface of a box through which a wave goes that is 48 elements long.
#[test]
fn elements_see_all_three_waves_in_any_direction() {
    for formulation in FORMULATIONS {
        for normal in [Vec3::new(0.3, -0.7, 0.5), Vec3::z(), Vec3::new(1.0, 0.0, 1.0)] {
            let bedding = beds(normal);
            let law = Stiffness::new(&SHALE, &bedding, None);
            for direction in [Vec3::x(), Vec3::new(0.5, -0.3, 0.8).normalize(), bedding.normal] {
                let (moduli, motions) = law.of_waves(direction).eigen();
                let mut expected = wave_moduli(&SHALE, &bedding, direction.dot(&bedding.normal));
                expected.sort_by(|a, b| b.total_cmp(a));
                let mesh = structured_box([6; 3], Vec3::repeat(1.0), None);
                let body = Body::new("box", ElementKind::T4, mesh.tetrahedra, SHALE);
                let body = Body { formulation, bedding: Some(bedding), ..body };
                let mut solid = Solid::new(mesh.nodes, vec![body]).unwrap();
                for wave in 0..3 {
                    assert!((moduli[wave] / expected[wave] - 1.0).abs() < 1e-9, "{moduli:?} {expected:?}");
                    let (motion, number) = (motions.column(wave).into_owned(), 2.0 * PI / 8.0);
                    for node in 0..solid.reference.len() {
                        let phase = number * direction.dot(&(solid.reference[node] - Vec3::repeat(0.5)));
                        solid.displacement[node] = motion * (1e-6 * phase.cos());
                    }
                    solid.update_internal_forces(0.0, false);
                    let inside = |p: &Vec3| p.iter().all(|x| *x > 0.25 && *x < 0.75);
                    let (mut force, mut mass) = (0.0, 0.0);
                    for node in (0..solid.reference.len()).filter(|&node| inside(&solid.reference[node])) {
                        force -= solid.force[node].dot(&motion);
                        mass += solid.mass[node] * solid.displacement[node].dot(&motion);
                    }
                    let speed = (force / mass).sqrt() / number;
                    let exact = (expected[wave] / SHALE.density).sqrt();
                    let off = speed / exact - 1.0;
                    assert!(off.abs() < 0.01, "{formulation:?} {normal:?} {direction:?} {wave}: {speed} of {exact}");
                }
            }
        }
    }
}

/// A pulse that goes along x through the middle of a sheet, until waves from its sides arrive there.
#[test]
fn pulses_go_at_the_speeds_of_their_direction() {
    for degrees in [0.0_f64, 35.0, 90.0] {
        for formulation in FORMULATIONS {
            let angle = degrees.to_radians();
            let bedding = beds(Vec3::new(angle.cos(), angle.sin(), 0.0));
            let law = Stiffness::new(&SHALE, &bedding, Some(Plane::Strain));
            let (moduli, motions) = law.of_waves(Vec3::x()).eigen();
            let [compression, _, shear] = wave_moduli(&SHALE, &bedding, angle.cos());
            for (wave, modulus) in [(0, compression), (1, shear)] {
                assert!((moduli[wave] / modulus - 1.0).abs() < 1e-9);
                let speed = (modulus / SHALE.density).sqrt();
                let mesh = structured_rectangle([100, 120], [1.0, 1.2], Some(Jitter { fraction: 0.1, seed: 3 }));
                let elements = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
                let body = Body::new("sheet", ElementKind::T3, elements, SHALE);
                let body = Body { bedding: Some(bedding), formulation, ..body };
                let mut solid = Solid::new(mesh.nodes, vec![body]).unwrap();
                let motion = motions.column(wave).into_owned();
                let (start, width) = (0.35, 0.06);
                for node in 0..solid.reference.len() {
                    let x = (solid.reference[node].x - start) / width;
                    let pulse = 1e-6 * (-x * x).exp();
                    solid.displacement[node] = motion * pulse;
                    solid.velocity[node] = motion * (pulse * 2.0 * x / width * speed);
                }
                let way = 0.2;
                let mut scene = scene_of(solid, Vec::new(), Vec::new(), settings(way / speed, 1e-2));
                while !scene.is_finished() {
                    scene.step(false).unwrap();
                }
                // Where it is: the centre of its square on the middle line.
                let (mut sum, mut all) = (0.0, 0.0);
                for (p, u) in scene.solid.reference.iter().zip(&scene.solid.displacement) {
                    if (p.y - 0.6).abs() < 0.02 {
                        sum += p.x * u.dot(&motion).powi(2);
                        all += u.dot(&motion).powi(2);
                    }
                }
                let gone = sum / all - start;
                assert!(
                    (gone / way - 1.0).abs() < 0.01,
                    "{degrees} deg, {formulation:?}, wave {wave}: {gone} of {way}"
                );
            }
        }
    }
}

/// A wave along the normal of an absorbing side leaves, whatever the beds.
#[test]
fn absorbing_facets_let_all_waves_along_their_normal_pass() {
    let angle = 35f64.to_radians();
    let bedding = beds(Vec3::new(angle.cos(), angle.sin(), 0.0));
    let law = Stiffness::new(&SHALE, &bedding, Some(Plane::Strain));
    let answer = law.impedance(SHALE.density, Vec3::x());
    let (moduli, motions) = law.of_waves(Vec3::x()).eigen();
    for wave in [0, 1] {
        let motion: Vec3 = motions.column(wave).into_owned();
        let speed = (moduli[wave] / SHALE.density).sqrt();
        let mesh = structured_rectangle([60, 200], [0.6, 2.0], Some(Jitter { fraction: 0.1, seed: 3 }));
        let elements = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
        let body = Body::new("sheet", ElementKind::T3, elements, SHALE);
        let mut solid = Solid::new(mesh.nodes, vec![Body { bedding: Some(bedding), ..body }]).unwrap();
        for node in 0..solid.reference.len() {
            let x = (solid.reference[node].x - 0.4) / 0.06;
            let pulse = 1e-6 * (-x * x).exp();
            solid.displacement[node] = motion * pulse;
            solid.velocity[node] = motion * (pulse * 2.0 * x / 0.06 * speed);
        }
        let mut facets = surface(&solid);
        facets.retain(|facet| facet.iter().all(|&node| solid.reference[node as usize].x > 0.6 - 1e-9));
        let facet = |nodes: &[u32; 3]| {
            let [a, b, _] = nodes.map(|node| solid.reference[node as usize]);
            SupportedFacet { nodes: *nodes, area: (b - a).norm(), answer }
        };
        let facets: Vec<SupportedFacet> = facets.iter().map(facet).collect();
        let supports = SurfaceSupports::new(&facets, &[], &solid.mass);
        // Waves from the ends of the sides do not come to its middle line.
        let in_the_middle = |solid: &Solid| {
            let places = solid.reference.iter().zip(&solid.velocity);
            let on_line = places.filter(|(p, _)| (p.y - 1.0).abs() < 0.02 && p.x > 0.2);
            on_line.map(|(_, v)| v.norm()).fold(0.0, f64::max)
        };
        let start = in_the_middle(&solid);
        let scene = scene_of(solid, Vec::new(), Vec::new(), settings(0.38 / speed, 1e-2));
        let mut scene = scene.with_surface_supports(supports);
        while !scene.is_finished() {
            scene.step(false).unwrap();
        }
        let back = in_the_middle(&scene.solid) / start;
        // Two per cent of the speed are 0.04 % of the energy.
        assert!(back < 0.02, "wave {wave}: {back} comes back");
    }
}

/// At rest and in motion forces are the same, at any temperatures; free expansion makes no stress.
#[test]
fn beds_expand_and_are_at_rest_as_in_motion() {
    for normal in normals() {
        for (shape, plane) in
            [(ElementKind::T4, Plane::Strain), (ElementKind::T3, Plane::Strain), (ElementKind::T3, Plane::Stress)]
        {
            for formulation in FORMULATIONS {
                let (nodes, body) = specimen(shape, 1.0);
                let body = Body { formulation, elastic: SHALE, bedding: Some(beds(normal)), plane, ..body };
                let mut solid = Solid::new(nodes, vec![body]).unwrap();
                let axes = if shape == ElementKind::T4 { 3 } else { 2 };
                motion::set_expansion(&mut solid, &[1e-5]);
                let warm = vec![20.0; solid.reference.len()];
                motion::start_expanded(&mut solid, &warm);
                let what = format!("{normal:?} {shape:?} {plane:?} {formulation:?}");
                if axes == 3 || plane == Plane::Stress {
                    let places = solid.reference.clone();
                    solid.displacement.iter_mut().zip(places).for_each(|(u, p)| *u = p * 2e-4);
                    solid.update_internal_forces(0.0, false);
                    let most = solid.force.iter().map(|f| f.norm()).fold(0.0, f64::max);
                    assert!(most < 1e-11 * 27e9 * 2e-4, "{what}: {most}");
                }
                let rises: Vec<f64> = (0..solid.reference.len()).map(|node| 30.0 * noise(node)).collect();
                motion::start_expanded(&mut solid, &rises);
                for (node, u) in solid.displacement.iter_mut().enumerate() {
                    *u = Vec3::from_fn(|axis, _| if axis < axes { 1e-4 * noise(3 * node + axis) } else { 0.0 });
                }
                solid.update_internal_forces(0.0, false);
                let mut held = vec![Vec3::zeros(); solid.reference.len()];
                solid.secant_force(&solid.cell_damage(), &solid.displacement, &mut held);
                let most = held.iter().map(|f| f.norm()).fold(0.0, f64::max);
                for (held, force) in held.iter().zip(&solid.force) {
                    assert!((held + force).norm() < 1e-12 * most, "{what}: {held:?} {force:?}");
                }
            }
        }
    }
}

/// However far a body has turned and however it is strained, forces are the slope of the energy and turn nothing.
#[test]
fn forces_of_beds_that_turn_are_the_slope_of_their_energy() {
    for formulation in FORMULATIONS {
        for size in [1e-5, 1e-3, 0.05] {
            let (nodes, body) = jittered_box([2; 3], Vec3::repeat(1.0));
            let bedding = Some(beds(Vec3::new(0.3, -0.7, 0.5)));
            let body = Body { formulation, elastic: SHALE, bedding, kinematics: Kinematics::Corotational, ..body };
            let mut solid = Solid::new(nodes, vec![body]).unwrap();
            let turn = rotation_by(Vec3::new(0.7, -1.1, 0.4)).to_rotation_matrix().into_inner();
            let noise = |node: usize, axis: usize| noise(3 * node + axis);
            for node in 0..solid.reference.len() {
                let moved = solid.reference[node] + Vec3::from_fn(|axis, _| size * noise(node, axis));
                solid.displacement[node] = turn * moved - solid.reference[node];
            }
            let mut energy = |along: &[Vec3], step: f64| {
                let back = solid.displacement.clone();
                solid.displacement.iter_mut().zip(along).for_each(|(u, d)| *u += d * step);
                solid.update_internal_forces(0.0, true);
                let (energy, force) = (solid.elastic_energy(), solid.force.clone());
                solid.displacement = back;
                (energy, force)
            };
            let count = 27;
            let along: Vec<Vec3> = (0..count).map(|node| Vec3::from_fn(|axis, _| noise(node + 50, axis))).collect();
            let step = 1e-3 * size;
            let slope = (energy(&along, step).0 - energy(&along, -step).0) / (2.0 * step);
            let force = energy(&along, 0.0).1;
            let work: f64 = force.iter().zip(&along).map(|(f, d)| f.dot(d)).sum();
            assert!((slope / -work - 1.0).abs() < 1e-5, "{formulation:?} {size}: {slope} {work}");
            let places = solid.reference.iter().zip(&solid.displacement).map(|(p, u)| p + u);
            let couple: Vec3 = places.zip(&force).map(|(p, f)| p.cross(f)).sum();
            let largest = force.iter().map(|f| f.norm()).fold(0.0, f64::max);
            assert!(couple.norm() < 1e-11 * largest, "{formulation:?} {size}: {couple:?}");
        }
    }
}

/// Beds of any direction: the bound by elements holds, the estimate is below it, and steps of the estimate stay stable.
#[test]
fn steps_are_stable_whatever_the_direction_of_the_beds() {
    for (index, normal) in normals().into_iter().enumerate() {
        for (shape, plane) in
            [(ElementKind::T4, Plane::Strain), (ElementKind::T3, Plane::Strain), (ElementKind::T3, Plane::Stress)]
        {
            for formulation in FORMULATIONS {
                for [young_modulus, shear_modulus] in [[12e9, 4.5e9], [80e9, 20e9], [2e9, 0.3e9]] {
                    let bedding = Bedding { young_modulus, shear_modulus, poisson_ratio: 0.1, ..beds(normal) };
                    let (nodes, body) = specimen(shape, 0.1);
                    let body = Body { formulation, elastic: SHALE, bedding: Some(bedding), plane, ..body };
                    let mut solid = Solid::new(nodes, vec![body]).unwrap();
                    let (bound, found) = (motion::stable_step_bound(&solid), solid.stable_step());
                    let what = format!("{normal:?} {shape:?} {plane:?} {formulation:?} {young_modulus}");
                    let ratio = bound.frequency / (found.frequency / 1.02);
                    assert!(ratio > 1.0 - 1e-9, "{what}: {ratio}");
                    for node in 0..solid.reference.len() {
                        let axes = if shape == ElementKind::T4 { 3 } else { 2 };
                        let speed = |axis: usize| noise(7 * node + axis + index);
                        solid.velocity[node] = Vec3::from_fn(|axis, _| if axis < axes { speed(axis) } else { 0.0 });
                    }
                    let mut settings = settings(1.0, 1e-1);
                    settings.time_step.safety = 0.95;
                    let mut scene = scene_of(solid, Vec::new(), Vec::new(), settings);
                    for step in 0..400 {
                        scene.step(step % 20 == 0).unwrap_or_else(|error| panic!("{what}: {error}"));
                    }
                    let residual = scene.ledger().relative_residual();
                    assert!(residual < 1e-3, "{what}: {residual}");
                }
            }
        }
    }
}

/// A block of beds tumbles, vibrates and rubs inside; the same bits for any number of threads.
#[test]
fn beds_that_tumble_keep_the_balance_and_their_bits() {
    for formulation in FORMULATIONS {
        let run = |threads: usize, stiffness_time: f64| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let (nodes, body) = jittered_box([8; 3], Vec3::repeat(0.1));
                let bedding = Some(beds(Vec3::new(0.3, -0.7, 0.5)));
                let body = Body { formulation, elastic: SHALE, bedding, kinematics: Kinematics::Corotational, ..body };
                let mut solid = Solid::new(nodes, vec![body]).unwrap();
                motion::set_viscosity(&mut solid, Viscosity { stiffness_time, ..Viscosity::default() });
                for node in 0..solid.reference.len() {
                    let p = solid.reference[node] - Vec3::repeat(0.05);
                    let waves = Vec3::new((60.0 * p.y).sin(), (50.0 * p.z).sin(), (40.0 * p.x).sin());
                    solid.velocity[node] = Vec3::new(300.0, -500.0, 200.0).cross(&p) + waves * 5.0;
                }
                let mut settings = settings(1e-3, 1e-2);
                settings.stiffness_time = stiffness_time;
                let mut scene = scene_of(solid, Vec::new(), Vec::new(), settings);
                while !scene.is_finished() {
                    let measure = scene.clock.step.is_multiple_of(20);
                    scene.step(measure).unwrap();
                }
                scene.step(true).unwrap();
                let residual = scene.ledger().relative_residual();
                assert!(residual < 1e-3, "{formulation:?}: {residual}");
                scene.solid.displacement.iter().flat_map(|u| [u.x, u.y, u.z]).map(f64::to_bits).collect::<Vec<u64>>()
            })
        };
        for stiffness_time in [0.0, 1e-7] {
            let one = run(1, stiffness_time);
            assert!([2, 7].into_iter().all(|threads| run(threads, stiffness_time) == one), "{formulation:?}");
        }
    }
}

/// The first stretching of a free slender bar, √(E/ρ)/(2 L) with the modulus of its angle to the beds.
#[test]
fn bars_vibrate_with_the_modulus_of_their_angle() {
    for (degrees, formulation) in [0.0_f64, 40.0, 90.0].into_iter().flat_map(|a| FORMULATIONS.map(|f| (a, f))) {
        let angle = degrees.to_radians();
        let bedding = beds(Vec3::new(angle.cos(), angle.sin(), 0.0));
        let mesh = structured_rectangle([120, 6], [1.0, 0.04], None);
        let elements = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
        let body = Body::new("bar", ElementKind::T3, elements, SHALE);
        let body = Body { plane: Plane::Stress, bedding: Some(bedding), formulation, ..body };
        let mut settings = settings(1.0, 1e-2);
        settings.damping = LocalDamping::default();
        let scene = scene_of(Solid::new(mesh.nodes, vec![body]).unwrap(), Vec::new(), Vec::new(), settings);
        let linear = LinearSolver::Direct;
        let found = find_modes(&scene, ModesSettings { count: 16, linear }, || false).unwrap();
        assert_eq!((found.rigid_motions, found.mechanisms), (3, 0));
        let modulus = bedding.young_modulus_along(&SHALE, angle.cos());
        let exact = 0.5 * (modulus / SHALE.density).sqrt();
        let off = found.modes.iter().map(|mode| (mode.frequency / exact - 1.0).abs()).fold(f64::INFINITY, f64::min);
        assert!(off < 0.005, "{degrees} deg, {formulation:?}: {off} off {exact} Hz");
    }
}

/// No stress of a strain has the axes of the strain: turned with the body it is the one of the beds that turned too.
#[test]
fn stress_turns_with_the_beds() {
    let bedding = beds(Vec3::new(0.3, -0.7, 0.5));
    let turn = rotation_by(Vec3::new(0.7, -1.1, 0.4)).to_rotation_matrix().into_inner();
    let turned = Bedding { normal: turn * bedding.normal, ..bedding };
    let strain = Mat3::new(3.0, 0.5, -0.2, 0.5, -1.0, 0.7, -0.2, 0.7, 2.0) * 1e-4;
    let force_of = |bedding: Bedding, gradient: Mat3, kinematics| {
        let (nodes, body) = jittered_box([2; 3], Vec3::repeat(1.0));
        let body = Body { elastic: SHALE, bedding: Some(bedding), kinematics, ..body };
        let mut solid = Solid::new(nodes, vec![body]).unwrap();
        let places = solid.reference.clone();
        solid.displacement.iter_mut().zip(&places).for_each(|(u, p)| *u = gradient * p);
        solid.update_internal_forces(0.0, false);
        solid.force
    };
    let whole = turn * (Mat3::identity() + strain) - Mat3::identity();
    let of_turned = force_of(bedding, whole, Kinematics::Corotational);
    let as_it_was = force_of(bedding, strain, Kinematics::Corotational);
    for (turned, still) in of_turned.iter().zip(&as_it_was) {
        assert!((turned - turn * still).norm() < 1e-11 * 1e6, "{turned:?}");
    }
    let stress = |bedding: &Bedding, strain: Mat3| {
        Stiffness::new(&SHALE, bedding, None).stress(Sym3::symmetric_part(&strain)).to_matrix()
    };
    let off = stress(&turned, turn * strain * turn.transpose()) - turn * stress(&bedding, strain) * turn.transpose();
    assert!(off.norm() < 1e-12 * 27e9);
}
