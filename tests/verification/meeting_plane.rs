//! Plane solids that touch each other: bars and corners that meet, blocks that slide, rest and break, a cylinder on a flat.

use std::sync::Arc;

use fractum_fem::{Body, Elastic, ElementKind, Kinematics, LocalDamping, Plane, Solid};
use fractum_math::{Rotation, Vec3};
use fractum_mesh::Mesh;
use fractum_mesh::generate::{Jitter, structured_rectangle};
use fractum_mesh::topology::boundary_of_triangles;
use fractum_scene::coupling::Debris;
use fractum_scene::{
    Along, Bonded, ContactBody, ContactParameters, ContactProbe, Contacts, EnergyKind, Gravity, Load, Loads, Motion,
    Scene, SolidSurface, Support, Supports,
};
use fractum_tests::{settings, softening};

use crate::meeting::{between, momenta};
use crate::ranks::{advance, bits, same_on_ranks};

const STONE: Elastic = Elastic { young_modulus: 30e9, poisson_ratio: 0.2, density: 2400.0 };
const SMOOTH: ContactParameters = ContactParameters { friction: 0.0, damping_ratio: 0.0, rolling_friction: 0.0 };

/// A plane body that flies.
#[derive(Clone)]
struct Sheet {
    mesh: Mesh,
    /// Where the origin of its mesh is [m], and its turn about it.
    middle: Vec3,
    turn: f64,
    velocity: Vec3,
    elastic: Elastic,
    thickness: f64,
    /// Fracture energy where it can break [J/m²].
    breaks: Option<f64>,
}

impl Sheet {
    /// A rectangle.
    fn new(cells: [u32; 2], size: [f64; 2], middle: [f64; 2]) -> Self {
        let mut mesh = structured_rectangle(cells, size, Some(Jitter { fraction: 0.05, seed: 5 }));
        mesh.nodes.iter_mut().for_each(|x| *x -= Vec3::new(size[0], size[1], 0.0) * 0.5);
        Sheet { middle: Vec3::new(middle[0], middle[1], 0.0), ..Sheet::of(mesh) }
    }

    fn of(mesh: Mesh) -> Self {
        let (middle, velocity, thickness) = (Vec3::zeros(), Vec3::zeros(), 0.02);
        Sheet { mesh, middle, turn: 0.0, velocity, elastic: STONE, thickness, breaks: None }
    }
}

/// How a scene of sheets moves.
struct Run {
    plane: Plane,
    contact: ContactParameters,
    safety: f64,
    end: f64,
    damping: LocalDamping,
    /// Whether the lowest nodes are held, and weight acts along -y, which grows for 60 ms.
    rests: bool,
}

impl Default for Run {
    fn default() -> Self {
        let damping = LocalDamping::default();
        Run { plane: Plane::Stress, contact: SMOOTH, safety: 0.8, end: 1.0, damping, rests: false }
    }
}

/// Sheets in one scene, which touch each other.
fn sheets(sheets: &[Sheet], run: &Run) -> Scene {
    let (mut nodes, mut bodies, mut outlines, mut velocity) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (index, sheet) in sheets.iter().enumerate() {
        let first = nodes.len() as u32;
        let triangles: Vec<[u32; 3]> = sheet.mesh.triangles.iter().map(|t| t.map(|n| n + first)).collect();
        let turn = Rotation::from_scaled_axis(Vec3::z() * sheet.turn);
        nodes.extend(sheet.mesh.nodes.iter().map(|x| turn * x + sheet.middle));
        velocity.resize(nodes.len(), sheet.velocity);
        let edges = boundary_of_triangles(&triangles);
        outlines.push(edges.iter().map(|edge| [edge.nodes[0], edge.nodes[1], edge.nodes[1]]).collect::<Vec<_>>());
        let elements = triangles.iter().map(|&[a, b, c]| [a, b, c, c]).collect();
        let body = Body::new(&format!("sheet {index}"), ElementKind::T3, elements, sheet.elastic).smoothed();
        let (plane, thickness) = (run.plane, sheet.thickness);
        let mut body = Body { kinematics: Kinematics::Corotational, plane, thickness, ..body };
        if let Some(energy) = sheet.breaks {
            body = body.with_damage(softening(energy));
            body.damage.as_mut().unwrap().reduce_strength_to_fit = true;
        }
        bodies.push(body);
    }
    let mut solid = Solid::new(nodes, bodies).unwrap();
    solid.velocity = velocity;
    let lowest = solid.reference.iter().map(|x| x.y).fold(f64::INFINITY, f64::min);
    let held = |x: &Vec3| run.rests && x.y < lowest + 1e-9;
    let held: Vec<u32> = (0..).zip(&solid.reference).filter(|(_, x)| held(x)).map(|(n, _)| n).collect();
    let supports = (0..2).map(|axis| Support::new("below", held.clone(), axis, Motion::Fixed)).collect();
    let weight = Load::Gravity(Gravity { axis: 1, value: Arc::new(|t, _| -9.81 * (t / 0.06).min(1.0)) });
    let loads = if run.rests { vec![weight] } else { Vec::new() };
    let loads = Loads::new(loads, solid.mass.len());
    let mut surface: Vec<u32> = outlines.iter().flatten().flatten().copied().collect();
    surface.sort_unstable();
    surface.dedup();
    let ground = |(body, lines): (usize, &Vec<[u32; 3]>)| SolidSurface::new(&solid, body, run.contact, lines).unwrap();
    let solids = outlines.iter().enumerate().map(ground).collect();
    let mut contacts = Contacts::new(&Bonded::default(), Vec::new(), Vec::new(), solids, Vec::new());
    for axis in 0..3 {
        let along = Along::Direction(Vec3::ith(axis, 1.0));
        contacts.watch(ContactProbe { on: ContactBody::Solid(0), from: ContactBody::Solid(1), along });
        contacts.watch(ContactProbe { on: ContactBody::Solid(1), from: ContactBody::Solid(0), along });
    }
    let debris = Debris::new(&solid, vec![run.contact; outlines.len()]);
    let mut settings = settings(run.end, 1e-2);
    (settings.damping, settings.time_step.safety) = (run.damping, run.safety);
    let supports = Supports::new(supports, &solid.reference).unwrap();
    Scene::new(solid, supports, loads, debris, Vec::new(), &surface, settings).with_contacts(contacts, &surface)
}

/// Mean of the velocity of a body.
fn velocity(scene: &Scene, body: usize) -> Vec3 {
    let mut nodes: Vec<u32> = scene.solid.body(body).elements.iter().flatten().copied().collect();
    nodes.sort_unstable();
    nodes.dedup();
    let mass: f64 = nodes.iter().map(|&n| scene.solid.mass[n as usize]).sum();
    nodes.iter().map(|&n| scene.solid.velocity[n as usize] * scene.solid.mass[n as usize]).sum::<Vec3>() / mass
}

/// How deep nodes of one body are within another one at most [m].
fn depth(scene: &Scene) -> f64 {
    let solid = &scene.solid;
    let at = |n: u32| solid.position(n as usize);
    let mut deepest = 0.0f64;
    for (own, other) in [(0, 1), (1, 0)] {
        let triangles: Vec<[u32; 3]> = solid.body(other).elements.iter().map(|e| [e[0], e[1], e[2]]).collect();
        let outline: Vec<[Vec3; 2]> = boundary_of_triangles(&triangles).iter().map(|e| e.nodes.map(at)).collect();
        let mut nodes: Vec<u32> = solid.body(own).elements.iter().flatten().copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        for x in nodes.iter().map(|&n| at(n)) {
            let turns = |[a, b]: [Vec3; 2]| (b - a).cross(&(x - a)).z >= 0.0;
            let within = |t: &[u32; 3]| (0..3).all(|k| turns([at(t[k]), at(t[(k + 1) % 3])]));
            if !triangles.iter().any(within) {
                continue;
            }
            let distance = |[a, b]: &[Vec3; 2]| {
                let (way, from) = (b - a, x - a);
                (from - way * (from.dot(&way) / way.norm_squared()).clamp(0.0, 1.0)).norm()
            };
            deepest = deepest.max(outline.iter().map(distance).fold(f64::INFINITY, f64::min));
        }
    }
    deepest
}

#[test]
fn bars_that_meet_head_on_exchange_their_velocities_in_two_passages_of_a_wave() {
    let (length, height, speed) = (0.1, 0.01, 2.0);
    let mut wrong = Vec::new();
    let usual = ContactParameters::default();
    for (nu, cells, scale, safety, contact) in [
        (0.0, [[40, 4], [40, 4]], 1.0, 0.4, SMOOTH),
        (0.2, [[40, 4], [40, 4]], 1.0, 0.4, SMOOTH),
        (0.45, [[40, 4], [40, 4]], 1.0, 0.4, SMOOTH),
        (0.2, [[40, 4], [50, 5]], 1e-3, 0.4, SMOOTH),
        (0.2, [[40, 1], [40, 1]], 1.0, 0.4, SMOOTH),
        (0.0, [[40, 3], [30, 4]], 1e-3, 0.4, SMOOTH),
        (0.2, [[40, 1], [40, 1]], 1.0, 0.8, usual),
        (0.2, [[40, 4], [50, 5]], 1.0, 0.8, usual),
        (0.2, [[40, 4], [40, 4]], 1.0, 0.8, SMOOTH),
        (0.2, [[40, 1], [40, 1]], 1.0, 0.8, SMOOTH),
    ] {
        let gap = 1e-4 * length;
        let bar = |cells, side: f64, velocity| {
            let elastic = Elastic { poisson_ratio: nu, ..STONE };
            let bar = Sheet::new(cells, [length * scale, height * scale], [side * 0.5 * (length + gap) * scale, 0.0]);
            Sheet { elastic, velocity: Vec3::x() * velocity, thickness: 0.02 * scale, ..bar }
        };
        let passage = 2.0 * length * scale / (STONE.young_modulus / STONE.density).sqrt();
        let end = gap * scale / speed + 1.25 * passage;
        let mut scene = sheets(
            &[bar(cells[0], -1.0, speed), bar(cells[1], 1.0, 0.0)],
            &Run { safety, end, contact, ..Run::default() },
        );
        let start = momenta(&scene);
        let (mut first, mut last, mut change, mut deepest) = (f64::NAN, f64::NAN, 0.0f64, 0.0f64);
        while !scene.is_finished() {
            scene.step(scene.clock.step.is_multiple_of(4)).unwrap();
            if scene.counts().contacts > 0 {
                (first, last) = (first.min(scene.clock.time), scene.clock.time);
            }
            let now = momenta(&scene);
            change = change.max((now.0 - start.0).norm() + (now.1 - start.1).norm() / (length * scale));
            if scene.clock.step.is_multiple_of(20) {
                deepest = deepest.max(depth(&scene));
            }
        }
        let [left, right] = [0, 1].map(|body| velocity(&scene, body).x / speed);
        let duration = (last - first) / passage;
        let residual = scene.ledger().residual_max_relative;
        let told = format!(
            "{nu} {cells:?} {scale} {safety}: {left:.4} {right:.4} duration {duration:.3} residual {residual:.1e} momentum {:.1e} depth {deepest:.2e} steps {}",
            change / start.0.norm(),
            scene.clock.step
        );
        println!("{told}");
        let exchanged = left.abs() < 0.03 && (right - 1.0).abs() < 0.03 && (duration - 1.0).abs() < 0.05;
        if !exchanged || residual > 1e-3 || change > 1e-12 * start.0.norm() {
            wrong.push(told);
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn corners_that_fall_on_a_flat_or_a_corner_come_back_and_do_not_slip_through() {
    let (side, speed) = (0.1, 5.0);
    let half = side * 0.5f64.sqrt();
    let mut wrong = Vec::new();
    for (turn, shift) in [(0.0, 0.0), (0.0, 3e-3), (45.0, 0.0), (45.0, 1e-4), (45.0, 3e-3), (30.0, 0.0)] {
        // The highest place of the lower body is at the origin.
        let top = if turn == 0.0 {
            [0.0, 0.5 * side]
        } else {
            [1.0, -1.0].map(|sign| half * f64::to_radians(45.0 + sign * turn).cos())
        };
        let gap = 1e-5 - if turn == 45.0 { shift } else { 0.0 };
        let upper = Sheet {
            turn: std::f64::consts::FRAC_PI_4,
            velocity: Vec3::y() * -speed,
            ..Sheet::new([8, 8], [side; 2], [shift, half + gap])
        };
        let lower = Sheet { turn: f64::to_radians(turn), ..Sheet::new([8, 8], [side; 2], top.map(|x| -x)) };
        let mut scene = sheets(&[upper, lower], &Run { end: 4e-4, ..Run::default() });
        let (start, mut deepest) = (momenta(&scene), 0.0f64);
        while !scene.is_finished() {
            scene.step(true).unwrap();
            if scene.clock.step.is_multiple_of(5) {
                deepest = deepest.max(depth(&scene));
            }
        }
        let now = momenta(&scene);
        let change = ((now.0 - start.0).norm() + (now.1 - start.1).norm() / side) / start.0.norm();
        let ledger = scene.ledger();
        let residual = ledger.residual_max_relative;
        let [first, second] = [0, 1].map(|body| velocity(&scene, body) / speed);
        let told = format!(
            "{turn} {shift}: {:.3} {:.3}, {:.3} {:.3}, depth {deepest:.1e} residual {residual:.1e} momentum {change:.1e} lost {:.1e} steps {}",
            first.x,
            first.y,
            second.x,
            second.y,
            ledger[EnergyKind::Damping],
            scene.clock.step
        );
        println!("{told}");
        if deepest > 0.05 * side / 8.0 || residual > 1e-3 || change > 1e-12 {
            wrong.push(told);
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// A block on a long slab that is held below.
fn block_on_slab(speed: f64, contact: ContactParameters, damping: LocalDamping, end: f64) -> Scene {
    let soft = Elastic { young_modulus: 4e7, poisson_ratio: 0.3, density: 2000.0 };
    let slab = Sheet { elastic: soft, ..Sheet::new([22, 2], [1.1, 0.1], [0.5, -0.05]) };
    let block = Sheet { elastic: soft, velocity: Vec3::x() * speed, ..Sheet::new([4, 2], [0.2, 0.1], [0.21, 0.05]) };
    sheets(&[block, slab], &Run { contact, damping, end, rests: true, plane: Plane::Strain, ..Run::default() })
}

#[test]
fn a_block_that_slides_on_another_body_is_slowed_down_by_friction_times_gravity() {
    let contact = ContactParameters { friction: 0.3, damping_ratio: 0.2, rolling_friction: 0.0 };
    let mut scene = block_on_slab(2.0, contact, LocalDamping::default(), 0.4);
    let (mut known, mut impulse) = (None, Vec3::zeros());
    while !scene.is_finished() {
        scene.step(true).unwrap();
        if scene.clock.time > 0.1 {
            let force = between(&scene, ContactBody::Solid(0), ContactBody::Solid(1));
            impulse += force * scene.clock.dt_before;
            known.get_or_insert((scene.clock.time, velocity(&scene, 0)));
        }
    }
    let (time, before) = known.unwrap();
    let slowed = (before.x - velocity(&scene, 0).x) / (scene.clock.time - time);
    let ledger = scene.ledger();
    println!(
        "{slowed} {} {} residual {} steps {}",
        slowed / (0.3 * 9.81),
        -impulse.x / impulse.y,
        ledger.residual_max_relative,
        scene.clock.step
    );
    assert!((slowed / (0.3 * 9.81) - 1.0).abs() < 0.01, "{slowed}");
    assert!((-impulse.x / impulse.y - 0.3).abs() < 0.003 && ledger.residual_max_relative < 1e-3, "{ledger:?}");
}

#[test]
fn a_block_at_rest_on_another_body_presses_with_its_weight() {
    let contact = ContactParameters { friction: 0.3, damping_ratio: 0.05, rolling_friction: 0.0 };
    let damping = LocalDamping { local: 0.4, ..LocalDamping::default() };
    let mut scene = block_on_slab(0.0, contact, damping, 0.15);
    while !scene.is_finished() {
        scene.step(true).unwrap();
    }
    let force = between(&scene, ContactBody::Solid(0), ContactBody::Solid(1));
    let weight = 2000.0 * 9.81 * 0.2 * 0.1 * 0.02;
    println!("{} {} depth {:.2e} steps {}", force.y / weight, force.x / weight, depth(&scene), scene.clock.step);
    assert!((force.y / weight - 1.0).abs() < 1e-3 && force.x.abs() < 1e-3 * weight, "{force:?} {weight}");
    // Springs give way by less than half of a row of elements under the same pressure does.
    assert!(depth(&scene) < 2000.0 * 9.81 * 0.1 / 4e7 * 0.05, "{}", depth(&scene));
}

/// A brittle block that flies askew at a free one.
fn crash() -> Scene {
    let contact = ContactParameters { friction: 0.4, damping_ratio: 0.05, rolling_friction: 0.0 };
    let flies = Sheet {
        turn: 0.4,
        velocity: Vec3::new(2.0, -12.0, 0.0),
        breaks: Some(20.0),
        ..Sheet::new([10, 10], [0.1; 2], [0.0, 0.0662])
    };
    let lies = Sheet { thickness: 0.03, ..Sheet::new([20, 6], [0.25, 0.06], [0.01, -0.03]) };
    sheets(&[flies, lies], &Run { contact, safety: 0.6, end: 1e-3, ..Run::default() })
}

#[test]
fn a_plane_block_that_breaks_on_another_keeps_momentum_and_energy() {
    let mut scene = crash();
    let (start, mut change) = (momenta(&scene), (0.0f64, 0.0f64));
    while !scene.is_finished() {
        scene.step(scene.clock.step.is_multiple_of(10)).unwrap();
        let now = momenta(&scene);
        change = (change.0.max((now.0 - start.0).norm()), change.1.max((now.1 - start.1).norm()));
    }
    let (counts, ledger) = (scene.counts(), scene.ledger());
    println!("{counts:?} {change:?} {} steps {}", ledger.residual_max_relative, scene.clock.step);
    assert!(counts.removed_elements > 20, "{counts:?}");
    assert!(change.0 < 1e-12 * start.0.norm() && change.1 < 1e-13 * start.0.norm(), "{change:?} {start:?}");
    assert!(ledger[EnergyKind::Friction] > 0.0 && ledger.residual_max_relative < 1e-3, "{ledger:?}");
}

#[test]
fn plane_bodies_that_meet_have_the_same_bits_on_ranks_and_threads_and_after_a_checkpoint() {
    let single = same_on_ranks(500, crash);
    assert!(single.counts().contacts > 2 && single.counts().removed_elements > 2, "{:?}", single.counts());
    for threads in [2, 7] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let again = pool.install(|| {
            let mut scene = crash();
            advance(&mut scene, 300);
            let mut resumed = crash();
            resumed.restore(scene.state());
            advance(&mut resumed, 200);
            bits(&resumed)
        });
        assert!(again == bits(&single), "{threads} threads");
    }
}
