//! Rigid shapes that press on solids: the force of the exact solution on any mesh, impacts, friction.

use std::sync::Arc;

use fractum_fem::{Body, Elastic, ElementKind, Formulation, Kinematics, LocalDamping, Plane, Solid};
use fractum_math::Vec3;
use fractum_mesh::generate::{Jitter, structured_box, structured_rectangle};
use fractum_scene::coupling::Debris;
use fractum_scene::statics::{StaticSettings, StaticSolver};
use fractum_scene::{
    Bonded, ContactParameters, Contacts, Drive, ElasticMaterial, EnergyKind, Form, Frame, Gravity, Load, Loads, Motion,
    NodesOnShape, RigidBody, Scene, SceneSettings, Shape, Support, Supports, TimeStepSettings,
};
use fractum_tests::{jittered_box, statics, surface};

use crate::ranks::{advance, bits, on_two_threads, same_on_ranks};

const YOUNG: f64 = 1e9;
const DENSITY: f64 = 2400.0;

fn surface_of(friction: f64, damping_ratio: f64) -> ContactParameters {
    ContactParameters { friction, damping_ratio, rolling_friction: 0.0 }
}

/// A cube of side `size` [m] with `cells` elements across; a square as thick as wide in the plane.
fn cube(cells: u32, size: f64, nu: f64, formulation: Formulation, in_space: bool) -> Solid {
    cube_of(cells, size, nu, (formulation, Kinematics::Small), in_space)
}

fn cube_of(cells: u32, size: f64, nu: f64, kind: (Formulation, Kinematics), in_space: bool) -> Solid {
    let (formulation, kinematics) = kind;
    let elastic = Elastic { young_modulus: YOUNG, poisson_ratio: nu, density: DENSITY };
    let jitter = Some(Jitter { fraction: 0.1, seed: 3 });
    let (nodes, body) = if in_space {
        let mesh = structured_box([cells; 3], Vec3::repeat(size), jitter);
        (mesh.nodes, Body::new("cube", ElementKind::T4, mesh.tetrahedra, elastic))
    } else {
        let mesh = structured_rectangle([cells; 2], [size; 2], jitter);
        let elements = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
        let body = Body::new("cube", ElementKind::T3, elements, elastic);
        (mesh.nodes, Body { plane: Plane::Stress, thickness: size, ..body })
    };
    Solid::new(nodes, vec![Body { formulation, kinematics, ..body }]).unwrap()
}

/// A scene of one solid and planes that the rigid bodies are.
fn scene(
    solid: Solid,
    supports: Vec<Support>,
    loads: Vec<Load>,
    planes: Vec<RigidBody>,
    contact: ContactParameters,
    settings: SceneSettings,
) -> Scene {
    let mut nodes: Vec<u32> = surface(&solid).into_iter().flatten().collect();
    nodes.sort_unstable();
    nodes.dedup();
    let shapes = (0..planes.len()).map(|k| NodesOnShape::of_body(k, shape_of(&planes[k]), planes[k].surface)).collect();
    let gravity = loads.iter().filter_map(|load| match load {
        Load::Gravity(Gravity { axis, value, .. }) => Some((*axis, value.clone())),
        _ => None,
    });
    let contacts = Contacts::new(&Bonded::default(), Vec::new(), planes, Vec::new(), gravity.collect());
    let supports = Supports::new(supports, &solid.reference).unwrap();
    let loads = Loads::new(loads, solid.reference.len());
    let debris = Debris::new(&solid, vec![contact]);
    Scene::new(solid, supports, loads, debris, shapes, &nodes, settings).with_contacts(contacts, &nodes)
}

fn shape_of(body: &RigidBody) -> Shape {
    match body.form {
        Form::Shape { shape, .. } => shape,
        Form::Mesh { .. } => unreachable!("planes and boxes here"),
    }
}

fn plane(point: Vec3, normal: Vec3, contact: ContactParameters) -> RigidBody {
    let frame = Frame { rotation: fractum_math::rotation_between(&Vec3::z(), &normal), ..Frame::at(point) };
    let form = Form::Shape { shape: Shape::HalfSpace, hollow: false };
    RigidBody::new("plane", form, frame, ElasticMaterial::RIGID, contact)
}

fn settings(end: f64, safety: f64, mass_rate: f64) -> SceneSettings {
    SceneSettings {
        time_step: TimeStepSettings { safety, element_bound: false, fixed: None, begin: 0.0, end },
        damping: LocalDamping { local: 0.0, mass_rate },
        stiffness_time: 0.0,
        balance_stop: 1e-2,
        joined_below: 0.95,
    }
}

/// A plane that presses on a cube of a side [m] from above.
fn platen(size: f64, up: usize) -> RigidBody {
    let axis = Vec3::ith(up, 1.0);
    plane(axis * size, -axis, surface_of(0.0, 0.1))
}

fn bottom_of(solid: &Solid, up: usize, size: f64) -> Support {
    let nodes = (0..solid.reference.len() as u32).filter(|&n| solid.reference[n as usize][up] < 1e-9 * size).collect();
    Support::new("bottom", nodes, up, Motion::Fixed)
}

/// Force of a tool that has pressed a cube by 0.5 % of its side, over E A u/L, which is exact at any ν where nothing holds it sideways.
fn pressed(solid: Solid, size: f64, safety: f64, damping: LocalDamping) -> f64 {
    let up = if solid.is_plane() { 1 } else { 2 };
    let crossing = size * (DENSITY / YOUNG).sqrt();
    let mut press = platen(size, up);
    let (ramp, push) = (30.0 * crossing, 5e-3 * size);
    press.along[up] = Drive::Velocity(Arc::new(move |t, _| {
        if t < ramp { -push / ramp * (1.0 - (std::f64::consts::TAU * t / ramp).cos()) } else { 0.0 }
    }));
    let support = bottom_of(&solid, up, size);
    let mut settings = settings(50.0 * crossing, safety, 0.0);
    settings.damping = damping;
    let mut scene = scene(solid, vec![support], Vec::new(), vec![press], surface_of(0.0, 0.1), settings);
    while !scene.is_finished() {
        scene.step(scene.clock.step.is_multiple_of(100)).unwrap();
    }
    scene.step(true).unwrap();
    assert!(scene.ledger().residual_max_relative < 1e-9, "{:?}", scene.ledger());
    scene.contacts.rigid_bodies()[0].contact_force()[up] / (YOUNG * size * size * 5e-3)
}

/// Brings a scene to rest under all that it is to bear.
fn rest(scene: &mut Scene) {
    rest_by(scene, 0.25, |_| ());
}

/// The same in steps of the load parameter, with a look at each state.
fn rest_by(scene: &mut Scene, step: f64, mut look: impl FnMut(&Scene)) {
    let settings = StaticSettings { most_steps: 200, tolerance: 1e-6, linear_tolerance: 1e-12, ..statics(step, 1.0) };
    let mut solver = StaticSolver::new(scene, settings).unwrap();
    while !solver.is_finished(scene) {
        solver.step(scene).unwrap();
        look(scene);
    }
}

/// Force at rest of a tool that has pressed a cube by 0.5 % of its side, over E A u/L.
fn pressed_at_rest(solid: Solid, size: f64) -> f64 {
    let up = if solid.is_plane() { 1 } else { 2 };
    let mut press = platen(size, up);
    press.along[up] = Drive::Velocity(Arc::new(move |_, _| -5e-3 * size));
    // What no plane holds sideways must be held by the sides at the axes.
    let supports = (0..=up).map(|axis| bottom_of(&solid, axis, size)).collect();
    let none = surface_of(0.0, 0.1);
    let (free, exact) = (settings(1.0, 0.8, 0.0), YOUNG * size * size * 5e-3);
    let mut scene = scene(solid, supports, Vec::new(), vec![press], none, free);
    rest(&mut scene);
    assert!(scene.ledger().relative_residual() < 1e-3, "{:?}", scene.ledger());
    scene.contacts.rigid_bodies()[0].contact_force()[up] / exact
}

#[test]
fn a_plane_bears_the_exact_force_on_any_mesh() {
    use Formulation::{Smoothed, Standard};
    let rows = [
        (2, 0.02, 0.0, Smoothed, true, 0.8),
        (4, 0.02, 0.0, Standard, true, 0.8),
        (8, 0.02, 0.0, Smoothed, true, 0.8),
        (2, 0.02, 0.2, Standard, true, 0.5),
        (4, 0.02, 0.2, Smoothed, true, 0.5),
        (2, 20.0, 0.4, Smoothed, true, 0.8),
        (4, 20.0, 0.4, Standard, true, 0.5),
        (2, 0.02, 0.0, Standard, false, 0.8),
        (4, 0.02, 0.2, Smoothed, false, 0.5),
        (8, 0.02, 0.4, Standard, false, 0.8),
        (4, 20.0, 0.4, Smoothed, false, 0.5),
    ];
    let mut wrong = Vec::new();
    for (cells, size, nu, formulation, in_space, safety) in rows {
        let crossing = size * (DENSITY / YOUNG).sqrt();
        for damping in
            [LocalDamping { local: 0.0, mass_rate: 1.0 / crossing }, LocalDamping { local: 0.3, mass_rate: 0.0 }]
        {
            let share = pressed(cube(cells, size, nu, formulation, in_space), size, safety, damping);
            let row = format!("{cells} {size} {nu} {formulation:?} {in_space} {safety} {damping:?}: {share}");
            println!("{row}");
            if (share - 1.0).abs() > 5e-3 {
                wrong.push(row);
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn a_platen_bears_the_exact_force_at_rest_on_any_mesh() {
    use Formulation::{Smoothed, Standard};
    let rows = [
        (2, 0.02, 0.0, Smoothed, true),
        (4, 0.02, 0.0, Standard, true),
        (8, 0.02, 0.0, Standard, true),
        (2, 20.0, 0.3, Standard, true),
        (4, 20.0, 0.3, Smoothed, true),
        (2, 0.02, 0.0, Standard, false),
        (4, 0.02, 0.3, Smoothed, false),
        (8, 20.0, 0.4, Standard, false),
    ];
    for (cells, size, nu, formulation, in_space) in rows {
        let share = pressed_at_rest(cube(cells, size, nu, formulation, in_space), size);
        println!("{cells} {size} {nu} {formulation:?} {in_space}: {share}");
        assert!((share - 1.0).abs() < 5e-3, "{cells} {size} {nu} {formulation:?} {in_space}: {share}");
    }
}

/// Work at rest that presses a cube on a fixed base by 0.5 % of its side and shears it by `shear`: by a plane with friction, or by its own nodes.
fn work_at_rest(solid: Solid, size: f64, shear: f64, friction: Option<f64>) -> f64 {
    let up = if solid.is_plane() { 1 } else { 2 };
    let way = Vec3::ith(up, -5e-3 * size) + Vec3::x() * (shear * size);
    let axes = 0..=up;
    let at = |low: f64, high: f64| -> Vec<u32> {
        let nodes = 0..solid.reference.len() as u32;
        nodes.filter(|&n| (low * size..high * size).contains(&solid.reference[n as usize][up])).collect()
    };
    let [base, top] = [at(-1.0, 1e-9), at(1.0 - 1e-9, 2.0)];
    let mut supports: Vec<Support> =
        axes.clone().map(|axis| Support::new("base", base.clone(), axis, Motion::Fixed)).collect();
    let contact = surface_of(friction.unwrap_or(0.0), 0.0);
    let mut planes = Vec::new();
    if friction.is_some() {
        let mut press = platen(size, up);
        press.surface = contact;
        axes.for_each(|axis| press.along[axis] = Drive::Velocity(Arc::new(move |_, _| way[axis])));
        planes.push(press);
    } else {
        let moved = |axis: usize| Motion::Displacement(Arc::new(move |t, _| way[axis] * t));
        supports.extend(axes.map(|axis| Support::new("top", top.clone(), axis, moved(axis))));
    }
    let mut scene = scene(solid, supports, Vec::new(), planes, contact, settings(1.0, 0.8, 0.0));
    rest(&mut scene);
    let ledger = scene.ledger();
    assert!(ledger.relative_residual() < 1e-3, "{ledger:?}");
    ledger[EnergyKind::External]
}

#[test]
fn a_plane_with_friction_holds_at_rest_as_fixed_nodes_do() {
    use Formulation::{Smoothed, Standard};
    let rows = [
        (2, 0.02, 0.0, Standard, true),
        (4, 0.02, 0.0, Smoothed, true),
        (8, 0.02, 0.3, Standard, true),
        (2, 20.0, 0.3, Standard, true),
        (4, 20.0, 0.3, Smoothed, true),
        (2, 0.02, 0.3, Standard, false),
        (4, 0.02, 0.0, Smoothed, false),
        (8, 20.0, 0.3, Standard, false),
        (4, 0.02, 0.45, Smoothed, true),
        (4, 0.02, 0.45, Standard, false),
        (4, 0.02, 0.45, Standard, true),
    ];
    let mut wrong = Vec::new();
    for (cells, size, nu, formulation, in_space) in rows {
        let made = || cube(cells, size, nu, formulation, in_space);
        let works = |friction: Option<f64>| [0.0, 2e-3].map(|shear| work_at_rest(made(), size, shear, friction));
        let [exact, found] = [works(None), works(Some(10.0))];
        let (pressed, sheared) = (found[0] / exact[0], (found[1] - found[0]) / (exact[1] - exact[0]));
        let row = format!("{cells} {size} {nu} {formulation:?} {in_space}: pressed {pressed}, sheared {sheared}");
        println!("{row}");
        if (pressed - 1.0).abs() > 1e-2 || (sheared - 1.0).abs() > 1e-2 {
            wrong.push(row);
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// A plane that presses on a cube with a fixed base, slides over it and back: Coulomb's force, against the way, and energy is only taken.
#[test]
fn a_plane_that_slides_at_rest_and_back_rubs_as_coulomb_says() {
    use Formulation::{Smoothed, Standard};
    let rows = [
        (2, 0.02, 0.0, Standard, true, 0.3),
        (4, 0.02, 0.3, Smoothed, true, 0.1),
        (4, 20.0, 0.45, Smoothed, true, 0.6),
        (4, 0.02, 0.3, Standard, false, 0.9),
        (8, 0.02, 0.45, Smoothed, false, 0.3),
    ];
    let mut wrong = Vec::new();
    for (cells, size, nu, formulation, in_space, friction) in rows {
        let solid = cube(cells, size, nu, formulation, in_space);
        let up = if in_space { 2 } else { 1 };
        let base = (0..solid.reference.len() as u32).filter(|&n| solid.reference[n as usize][up] < 1e-9 * size);
        let base: Vec<u32> = base.collect();
        let supports = (0..=up).map(|axis| Support::new("base", base.clone(), axis, Motion::Fixed)).collect();
        let contact = surface_of(friction, 0.0);
        let mut press = platen(size, up);
        press.surface = contact;
        // Down in a tenth of the time, to one side until 0.55, then back.
        press.along[up] = Drive::Velocity(Arc::new(move |t, _| if t < 0.1 { -0.05 * size } else { 0.0 }));
        let aside = move |t: f64| if t < 0.1 { 0.0 } else { 0.2 * size * (0.55 - t).signum() };
        press.along[0] = Drive::Velocity(Arc::new(move |t, _| aside(t)));
        let mut scene = scene(solid, supports, Vec::new(), vec![press], contact, settings(1.0, 0.8, 0.0));
        let ([mut there, mut back], mut steps, mut rubbed, mut given) = ([0.0; 2], 0, 0.0f64, 0.0f64);
        rest_by(&mut scene, 0.05, |scene| {
            let force = scene.contacts.rigid_bodies()[0].contact_force();
            back = force[0] / force[up];
            if scene.clock.time < 0.551 {
                there = back;
            }
            steps += 1;
            let now = scene.ledger()[EnergyKind::Friction];
            (given, rubbed) = (given.max(rubbed - now), now);
        });
        let ledger = scene.ledger();
        let row = format!(
            "{cells} {size} {nu} {formulation:?} {in_space} {friction}: {there:.4} {back:.4} in {steps} steps, gives {:.1e}, residual {:.1e}",
            given / rubbed,
            ledger.residual_max_relative
        );
        println!("{row}");
        let of = |ratio: f64| (ratio / friction - 1.0).abs() < 5e-3;
        if !(of(-there) && of(back) && given < 1e-3 * rubbed && ledger.residual_max_relative < 1e-3) {
            wrong.push(row);
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// A strip that a plane meets lengthwise: the wave in it comes back after 2 L/c, and until then the plane bears ρ c v on its section.
#[test]
fn a_bar_leaves_a_plane_with_its_momentum_but_for_that_of_its_first_row() {
    let (length, width, speed) = (0.1, 0.01, 1.0);
    let celerity = (YOUNG / DENSITY).sqrt();
    for formulation in [Formulation::Smoothed, Formulation::Standard] {
        for cells in [10, 20, 40] {
            let elastic = Elastic { young_modulus: YOUNG, poisson_ratio: 0.0, density: DENSITY };
            let mesh = structured_rectangle([cells, 2], [length, width], None);
            let elements = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
            let body = Body::new("bar", ElementKind::T3, elements, elastic);
            let body = Body { plane: Plane::Stress, thickness: width, formulation, ..body };
            let solid = Solid::new(mesh.nodes, vec![body]).unwrap();
            let contact = surface_of(0.0, 0.1);
            let mut wall = plane(-Vec3::x() * 1e-5, Vec3::x(), contact);
            wall.along[0] = Drive::Velocity(Arc::new(move |_, _| speed));
            let end = 1e-5 / speed + 3.0 * length / celerity;
            let mut scene = scene(solid, Vec::new(), Vec::new(), vec![wall], contact, settings(end, 0.8, 0.0));
            let (mut impulse, mut parted) = (0.0, 0.0);
            while !scene.is_finished() {
                let dt = scene.clock.dt_after;
                scene.step(true).unwrap();
                let force = -scene.contacts.rigid_bodies()[0].contact_force().x;
                impulse += force * dt;
                if force > 0.0 {
                    parted = scene.clock.time - 1e-5 / speed;
                }
            }
            let ledger = scene.ledger();
            let whole: f64 = scene.solid.mass.iter().sum();
            let left: f64 = scene.solid.mass.iter().zip(&scene.solid.velocity).map(|(m, v)| m * v.x).sum();
            let start = 0.5 * whole * speed * speed; // as the plane sees it
            let (share, lasted) = (ledger[EnergyKind::Damping] / start, parted * celerity / (2.0 * length));
            let back = left / (whole * speed) - 1.0;
            println!("{formulation:?} {cells}: {back}, lost {share}, {lasted}, {ledger:?}");
            assert!((impulse - left).abs() < 1e-9 * whole * speed, "{impulse} {left}");
            assert!(ledger.residual_max_relative < 1e-10, "{ledger:?}");
            // Half a row of elements is stopped at once, and some of it again when waves come back.
            let row = 0.5 / f64::from(cells);
            assert!(share > 0.5 * row && share < 1.8 * row, "{cells}: {share} of {row}");
            assert!(
                back > 1.0 - 2.5 * row && back < 1.0 && (lasted - 1.0).abs() < 2.0 * row,
                "{cells}: {back} {lasted}"
            );
        }
    }
}

/// A cube between two planes that close: both bear the exact force, and so does each of two that move along with the cube.
#[test]
fn two_planes_press_a_cube_alike() {
    let size = 0.02;
    for (cells, formulation, in_space, friction) in [
        (2, Formulation::Smoothed, true, 0.0),
        (4, Formulation::Standard, true, 0.0),
        (4, Formulation::Smoothed, true, 0.3),
        (8, Formulation::Standard, false, 0.3),
    ] {
        let solid = cube(cells, size, 0.0, formulation, in_space);
        let up = if in_space { 2 } else { 1 };
        let (axis, crossing) = (Vec3::ith(up, 1.0), size * (DENSITY / YOUNG).sqrt());
        let contact = surface_of(friction, 0.1);
        let mut planes = vec![plane(axis * size, -axis, contact), plane(Vec3::zeros(), axis, contact)];
        let (ramp, push) = (30.0 * crossing, 2.5e-3 * size);
        for (plane, sign) in planes.iter_mut().zip([-1.0, 1.0]) {
            plane.along[up] = Drive::Velocity(Arc::new(move |t, _| {
                let closing =
                    if t < ramp { push / ramp * (1.0 - (std::f64::consts::TAU * t / ramp).cos()) } else { 0.0 };
                sign * closing
            }));
        }
        let settings = settings(50.0 * crossing, 0.8, 1.0 / crossing);
        let mut scene = scene(solid, Vec::new(), Vec::new(), planes, contact, settings);
        while !scene.is_finished() {
            scene.step(scene.clock.step.is_multiple_of(100)).unwrap();
        }
        scene.step(true).unwrap();
        let exact = YOUNG * size * size * 5e-3;
        let forces = [0, 1].map(|k| scene.contacts.rigid_bodies()[k].contact_force()[up] / exact);
        println!("{cells} {formulation:?} {in_space} {friction}: {forces:?} {:?}", scene.ledger());
        assert!((forces[0] - 1.0).abs() < 5e-3 && (forces[1] + 1.0).abs() < 5e-3, "{cells} {friction}: {forces:?}");
        assert!(scene.ledger().residual_max_relative < 1e-9, "{:?}", scene.ledger());
        assert!(scene.ledger()[EnergyKind::Friction] > -1e-9 * scene.ledger()[EnergyKind::External]);
    }
}

#[test]
fn a_block_slides_and_sticks_as_coulomb_says() {
    let size = 0.02;
    for (friction, tilt) in [(0.3f64, 0.6f64), (0.3, 0.2), (0.0, 0.4)] {
        let solid = cube(3, size, 0.2, Formulation::Smoothed, true);
        let crossing = size * (DENSITY / YOUNG).sqrt();
        let (end, g) = (200.0 * crossing, 1e3);
        // Gravity leans instead of the plane.
        let along = |axis: usize, value: f64| Load::Gravity(Gravity { axis, value: Arc::new(move |_, _| value) });
        let loads = vec![along(0, g * tilt.sin()), along(2, -g * tilt.cos())];
        let contact = surface_of(friction, 0.1);
        let floor = plane(Vec3::zeros(), Vec3::z(), contact);
        let mut scene = scene(solid, Vec::new(), loads, vec![floor], contact, settings(end, 0.8, 0.0));
        while !scene.is_finished() {
            scene.step(scene.clock.step.is_multiple_of(50)).unwrap();
        }
        scene.step(true).unwrap();
        let whole: f64 = scene.solid.mass.iter().sum();
        let speed = scene.solid.mass.iter().zip(&scene.solid.velocity).map(|(m, v)| m * v.x).sum::<f64>() / whole;
        let expected = (g * end * (tilt.sin() - friction * tilt.cos())).max(0.0);
        let free = g * end * tilt.sin();
        println!("{friction} {tilt}: {speed} {expected} of {free}");
        assert!((speed - expected).abs() < 0.01 * free, "{friction} {tilt}: {speed} {expected}");
        let ledger = scene.ledger();
        assert!(ledger.residual_max_relative < 1e-9, "{ledger:?}");
        assert!(ledger[EnergyKind::Friction] >= 0.0);
    }
}

/// A block on a floor that moves along x: friction drags it until it moves along.
#[test]
fn a_belt_takes_a_block_along() {
    let size = 0.02;
    let solid = cube(3, size, 0.2, Formulation::Smoothed, true);
    let crossing = size * (DENSITY / YOUNG).sqrt();
    let (end, g, friction, speed) = (300.0 * crossing, 1e3, 0.3, 0.08 * 1e3 * 300.0 * crossing);
    let weight = Load::Gravity(Gravity { axis: 2, value: Arc::new(move |_, _| -g) });
    let contact = surface_of(friction, 0.1);
    let mut belt = plane(Vec3::zeros(), Vec3::z(), contact);
    belt.along[0] = Drive::Velocity(Arc::new(move |_, _| speed));
    let mut scene = scene(solid, Vec::new(), vec![weight], vec![belt], contact, settings(end, 0.8, 0.0));
    let whole: f64 = scene.solid.mass.iter().sum();
    let along =
        |scene: &Scene| scene.solid.mass.iter().zip(&scene.solid.velocity).map(|(m, v)| m * v.x).sum::<f64>() / whole;
    let (mut halfway, mut fastest) = (0.0, 0.0f64);
    while !scene.is_finished() {
        scene.step(scene.clock.step.is_multiple_of(50)).unwrap();
        if scene.clock.time < 0.5 * speed / (friction * g) {
            halfway = along(&scene) / (friction * g * scene.clock.time);
        }
        fastest = fastest.max(along(&scene) / speed);
    }
    scene.step(true).unwrap();
    println!("{halfway} {fastest} {:?}", scene.ledger());
    // What the block swings by when it comes to stick is some 1 % of the speed.
    assert!((halfway - 1.0).abs() < 0.03 && (along(&scene) / speed - 1.0).abs() < 0.03 && fastest < 1.03);
    assert!(scene.ledger().residual_max_relative < 1e-9);
    // The slip of a mass that is brought to the speed of the belt costs as much as its motion.
    let lost = scene.ledger()[EnergyKind::Friction] / (0.5 * whole * speed * speed);
    assert!((lost - 1.0).abs() < 0.05, "{lost}");
}

/// Nodes at the edge of a block that two planes hold at once.
#[test]
fn two_planes_hold_the_same_nodes() {
    let size = 0.02;
    for (lean, friction) in [(0.0f64, 0.0), (0.0, 0.3), (0.8, 0.0)] {
        let solid = cube(3, size, 0.2, Formulation::Smoothed, true);
        let crossing = size * (DENSITY / YOUNG).sqrt();
        let (g, contact) = (1e3, surface_of(friction, 0.1));
        let along = |axis: usize, value: f64| Load::Gravity(Gravity { axis, value: Arc::new(move |_, _| value) });
        let loads = vec![along(0, -0.1 * g), along(2, -g)];
        let wall = plane(Vec3::zeros(), Vec3::new(lean.cos(), 0.0, lean.sin()), contact);
        let planes = vec![plane(Vec3::zeros(), Vec3::z(), contact), wall];
        let settings = settings(60.0 * crossing, 0.8, 1.0 / crossing);
        let mut scene = scene(solid, Vec::new(), loads, planes, contact, settings);
        let mut deepest = 0.0f64;
        while !scene.is_finished() {
            scene.step(scene.clock.step.is_multiple_of(50)).unwrap();
            for i in 0..scene.solid.reference.len() {
                let x = scene.solid.position(i);
                deepest = deepest.max(-x.z).max(-(x.x * lean.cos() + x.z * lean.sin()));
            }
        }
        scene.step(true).unwrap();
        let weight = g * scene.solid.mass.iter().sum::<f64>();
        let sum: Vec3 = scene.contacts.rigid_bodies().iter().map(RigidBody::contact_force).sum();
        println!("{lean} {friction}: {deepest:e} {:?}", sum / weight);
        assert!(deepest < 1e-5 * size, "{lean} {friction}: {deepest}");
        assert!((sum / weight + Vec3::new(0.1, 0.0, 1.0)).norm() < 0.02, "{lean} {friction}: {:?}", sum / weight);
        assert!(scene.ledger().residual_max_relative < 1e-9, "{:?}", scene.ledger());
    }
}

/// A ball that glances off a cube: nodes slide round a curved shape.
#[test]
fn a_glancing_blow_brings_no_energy() {
    let size = 0.02;
    let mut gains = Vec::new();
    for safety in [0.8, 0.4] {
        let solid = cube(4, size, 0.2, Formulation::Smoothed, true);
        let crossing = size * (DENSITY / YOUNG).sqrt();
        let contact = surface_of(0.0, 0.0);
        let form = Form::Shape { shape: Shape::Ball { radius: 0.5 * size }, hollow: false };
        let frame = Frame::at(Vec3::new(0.3 * size, 0.5 * size, -0.501 * size));
        let mut ball = RigidBody::new("ball", form, frame, ElasticMaterial::RIGID, contact);
        ball.along[0] = Drive::Velocity(Arc::new(|_, _| -0.5));
        ball.along[2] = Drive::Velocity(Arc::new(|_, _| 1.0));
        let start = 0.5 * 1.25 * solid.mass.iter().sum::<f64>();
        let mut scene =
            scene(solid, Vec::new(), Vec::new(), vec![ball], contact, settings(8.0 * crossing, safety, 0.0));
        let mut least = 0.0f64;
        while !scene.is_finished() {
            scene.step(true).unwrap();
            let ledger = scene.ledger();
            least = least.min(ledger[EnergyKind::Damping] / start);
        }
        let ledger = scene.ledger();
        println!("{safety}: damping from {least:e} to {:e}", ledger[EnergyKind::Damping] / start);
        assert!(ledger.residual_max_relative < 1e-9, "{ledger:?}");
        gains.push(-least);
    }
    assert!(gains.iter().all(|gain| *gain < 1e-3), "{gains:?}");
}

/// A tool that starts at once, presses, turns back at once and leaves: it pushes, never pulls, and brings no energy of its own.
#[test]
fn a_tool_that_leaps_presses_and_leaves_never_pulls() {
    use Formulation::{Smoothed, Standard};
    let size = 0.02;
    let radius = 0.6 * size;
    let shapes = [
        Shape::HalfSpace,
        Shape::Cuboid { half: Vec3::repeat(0.3 * size) },
        Shape::Cylinder { radius, half_length: size },
        Shape::Ball { radius },
    ];
    let mut wrong = Vec::new();
    for (row, shape) in shapes.into_iter().cycle().take(12).enumerate() {
        let friction = [0.0, 0.3, 0.9][row % 3];
        let (in_space, kinematics) =
            (row % 8 < 4, if row % 5 < 2 { Kinematics::Corotational } else { Kinematics::Small });
        let (formulation, safety) = (if row % 2 == 0 { Smoothed } else { Standard }, [0.8, 0.4][row / 6]);
        let solid = cube_of(4, size, 0.3, (formulation, kinematics), in_space);
        let (up, crossing) = (if in_space { 2 } else { 1 }, size * (DENSITY / YOUNG).sqrt());
        let axis = Vec3::ith(up, 1.0);
        let contact = surface_of(friction, 0.1);
        let reach = match shape {
            Shape::HalfSpace => 0.0,
            Shape::Cuboid { half } => half[up],
            Shape::Cylinder { radius, .. } | Shape::Tube { radius, .. } | Shape::Ball { radius } => radius,
        };
        let middle = Vec3::new(0.52 * size, 0.5 * size, 0.0);
        let at = middle + axis * (1.0001 * size + reach - middle[up]);
        let mut tool = plane(at, -axis, contact);
        if shape != Shape::HalfSpace {
            tool.form = Form::Shape { shape, hollow: false };
            let lies = if in_space { Vec3::y() } else { Vec3::z() };
            tool.frame = Frame { rotation: fractum_math::rotation_between(&Vec3::z(), &lies), ..Frame::at(at) };
        }
        let turn = 10.0 * crossing;
        let speed = 6e-3 * size / turn;
        tool.along[up] = Drive::Velocity(Arc::new(move |t, _| if t < turn { -speed } else { 3.0 * speed }));
        tool.along[0] = Drive::Velocity(Arc::new(move |t, _| if t < turn { 0.3 * speed } else { 0.0 }));
        let supports = vec![bottom_of(&solid, up, size), bottom_of(&solid, 0, size)];
        let settings = settings(30.0 * crossing, safety, 0.0);
        let mut scene = scene(solid, supports, Vec::new(), vec![tool], contact, settings);
        let (mut pulls, mut pushes, mut given) = (0.0f64, 0.0f64, 0.0f64);
        while !scene.is_finished() {
            scene.step(true).unwrap();
            let push = scene.contacts.rigid_bodies()[0].contact_force()[up];
            (pulls, pushes) = (pulls.max(-push), pushes.max(push));
            let [damping, friction] = [EnergyKind::Damping, EnergyKind::Friction].map(|kind| scene.ledger()[kind]);
            given = given.max(-damping).max(-friction);
        }
        let (ledger, left) = (scene.ledger(), scene.contacts.rigid_bodies()[0].contact_force().norm());
        let (taken, rubbed) = (ledger[EnergyKind::External], ledger[EnergyKind::Friction]);
        let told = format!(
            "{row} {shape:?} {friction} {in_space} {kinematics:?} {formulation:?} {safety}: pushes {pushes:e}, pulls {pulls:e}, \
             left {left:e}, given {given:e} of {taken:e}, rubbed {rubbed:e}, {ledger:?}"
        );
        println!("{told}");
        // The work of corotational elements is not that of their forces at both ends of a step.
        let round_off = if kinematics == Kinematics::Small { 1e-9 } else { 2e-5 };
        let balanced = ledger.residual_max_relative < round_off && given <= 1e-3 * taken;
        let lets_go = pushes > 0.0 && pulls <= 1e-12 * pushes && left == 0.0;
        if !(balanced && lets_go && (rubbed > 0.0) == (friction > 0.0)) {
            wrong.push(told);
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn held_nodes_have_the_same_bits_on_any_number_of_ranks_and_threads_and_after_a_checkpoint() {
    let made = || {
        let (nodes, body) = jittered_box([20, 10, 10], Vec3::new(0.4, 0.2, 0.2));
        let mut solid = Solid::new(nodes, vec![body.smoothed()]).unwrap();
        solid.velocity.fill(Vec3::new(0.2, 0.0, 0.0));
        let contact = surface_of(0.3, 0.1);
        let mut plate = plane(Vec3::new(0.0, 0.0, 0.2), -Vec3::z(), contact);
        plate.along[2] = Drive::Velocity(Arc::new(|_, _| -1.2));
        let planes = vec![plane(Vec3::zeros(), Vec3::z(), contact), plate];
        let weight = Load::Gravity(Gravity { axis: 2, value: Arc::new(|_, _| -9.81) });
        let mut settings = settings(1.0, 0.8, 0.0);
        settings.damping = LocalDamping { local: 0.1, mass_rate: 0.0 };
        scene(solid, Vec::new(), vec![weight], planes, contact, settings)
    };
    let single = same_on_ranks(40, made);
    assert!(single.ledger().residual_max_relative < 1e-9, "{:?}", single.ledger());
    assert!(single.contacts.rigid_bodies().iter().all(|body| body.contact_force().z != 0.0));
    let threaded = on_two_threads(|| {
        let mut scene = made();
        advance(&mut scene, 17);
        let mut resumed = made();
        resumed.restore(scene.state());
        advance(&mut resumed, 23);
        bits(&resumed)
    });
    assert!(threaded == bits(&single));
}
