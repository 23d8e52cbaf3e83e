//! Interfaces between elements: patches, strength and energy, waves, the same bits.

use std::sync::Arc;

use fractum_fem::{Body, Elastic, ElementKind, Formulation, Kinematics, Solid};
use fractum_math::{Mat3, Vec3};
use fractum_mesh::generate::{Jitter, structured_box, structured_rectangle};
use fractum_mesh::{CutAlong, Group, Mesh};
use fractum_scene::coupling::Debris;
use fractum_scene::statics::StaticSolver;
use fractum_scene::{
    ContactParameters, EnergyKind, InterfaceFace, InterfaceKind, InterfaceLaw, InterfaceSoftening, Interfaces, Loads,
    MixedMode, Motion, Scene, Support, Supports,
};
use fractum_tests::{CONCRETE, settings, statics};
use nalgebra::Rotation3;

pub(crate) const LAW: InterfaceLaw = InterfaceLaw {
    tensile_strength: 1e6,
    cohesion: 1.5e6,
    opening_energy: 40.0,
    sliding_energy: 80.0,
    friction: 0.6,
    residual_friction: 0.5,
    dilation: 0.0,
    dilation_slip: f64::INFINITY,
    mixed_mode: MixedMode::Power(1.0),
    softening: InterfaceSoftening::Linear,
    roughness: None,
};

/// A bar along x, in halves that an interface joins.
pub(crate) struct Bar {
    pub(crate) kind: ElementKind,
    pub(crate) cells: [u32; 2],
    /// Size of cells [m].
    pub(crate) size: f64,
    pub(crate) poisson_ratio: f64,
    pub(crate) formulation: Formulation,
    /// Turns all of it.
    pub(crate) turn: Mat3,
    pub(crate) seed: u64,
    /// Law and stiffness; none for a bar in one piece.
    pub(crate) interface: Option<(InterfaceLaw, Option<[f64; 2]>)>,
    /// Step [s]; absent means that of the elements.
    pub(crate) step: Option<f64>,
    pub(crate) kinematics: Kinematics,
}

impl Bar {
    pub(crate) fn new(kind: ElementKind, interface: Option<(InterfaceLaw, Option<[f64; 2]>)>) -> Self {
        let (cells, size, formulation) = ([8, 2], 0.01, Formulation::Smoothed);
        Bar {
            kind,
            cells,
            size,
            poisson_ratio: 0.2,
            formulation,
            turn: Mat3::identity(),
            seed: 3,
            interface,
            step: None,
            kinematics: Kinematics::Small,
        }
    }

    pub(crate) fn extent(&self) -> [f64; 2] {
        self.cells.map(|cells| self.size * f64::from(cells))
    }

    pub(crate) fn area(&self) -> f64 {
        self.extent()[1].powi(2)
    }

    /// The mesh before it turns, with groups of both halves.
    pub(crate) fn mesh(&self) -> Mesh {
        let ([along, across], [length, width]) = (self.cells, self.extent());
        let jitter = Some(Jitter { fraction: 0.15, seed: self.seed });
        let mut mesh = match self.kind {
            ElementKind::T3 => structured_rectangle([along, across], [length, width], jitter),
            ElementKind::T4 => structured_box([along, across, across], Vec3::new(length, width, width), jitter),
        };
        for node in &mut mesh.nodes {
            if (node.x - 0.5 * length).abs() < 0.3 * self.size {
                node.x = 0.5 * length;
            }
        }
        let elements: Vec<Vec<u32>> = match self.kind {
            ElementKind::T3 => mesh.triangles.iter().map(|e| e.to_vec()).collect(),
            ElementKind::T4 => mesh.tetrahedra.iter().map(|e| e.to_vec()).collect(),
        };
        let middle = |e: &[u32]| e.iter().map(|&n| mesh.nodes[n as usize].x).sum::<f64>() / e.len() as f64;
        for (tag, name) in [(90, "first"), (91, "second")] {
            let own = |e: &[u32]| (middle(e) < 0.5 * length) == (tag == 90);
            let members: Vec<u32> = (0u32..).zip(&elements).filter(|(_, e)| own(e)).map(|(number, _)| number).collect();
            let mut group = Group { name: name.to_owned(), dimension: 2, tag, ..Group::default() };
            match self.kind {
                ElementKind::T3 => group.triangles = members,
                ElementKind::T4 => (group.dimension, group.tetrahedra) = (3, members),
            }
            mesh.groups.push(group);
        }
        if self.interface.is_some() {
            mesh.cut(&[CutAlong::Between(&["first".to_owned(), "second".to_owned()])]).unwrap();
        }
        mesh
    }

    /// The scene that `supports` makes of the mesh as it turned; with that mesh as it was.
    pub(crate) fn scene(&self, end: f64, supports: impl FnOnce(&Mesh) -> Vec<Support>) -> (Scene, Mesh) {
        let mesh = self.mesh();
        let elements: Vec<[u32; 4]> = match self.kind {
            ElementKind::T3 => mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect(),
            ElementKind::T4 => mesh.tetrahedra.clone(),
        };
        let elastic = Elastic { poisson_ratio: self.poisson_ratio, ..CONCRETE };
        let body = Body::new("bar", self.kind, elements, elastic);
        let body =
            Body { formulation: self.formulation, thickness: self.extent()[1], kinematics: self.kinematics, ..body };
        let nodes = mesh.nodes.iter().map(|node| self.turn * node).collect();
        let solid = Solid::new(nodes, vec![body]).unwrap();
        let interfaces = self.interface.map(|(law, stiffness)| {
            let face = |face: &fractum_mesh::CutFace| InterfaceFace {
                kind: 0,
                sides: face.sides,
                elements: face.elements.map(|element| (0, element)),
            };
            let kinds = vec![InterfaceKind { name: "joint".to_owned(), law, stiffness }];
            Interfaces::new(&solid, kinds, mesh.cuts.iter().map(face).collect())
        });
        let supports = Supports::new(supports(&mesh), &solid.reference).unwrap();
        let loads = Loads::new(Vec::new(), solid.reference.len());
        let debris = Debris::new(&solid, vec![ContactParameters::default()]);
        let mut settings = settings(end, 1e-2);
        settings.time_step.fixed = self.step;
        let scene = Scene::new(solid, supports, loads, debris, Vec::new(), &[], settings);
        (interfaces.into_iter().fold(scene, Scene::with_interfaces), mesh)
    }

    /// Nodes of the mesh where something holds before it turns.
    pub(crate) fn at(mesh: &Mesh, keep: impl Fn(&Vec3) -> bool) -> Vec<u32> {
        (0..mesh.nodes.len() as u32).filter(|&n| keep(&mesh.nodes[n as usize])).collect()
    }

    /// Held at its left end and moved by a velocity at the right one, that grows from zero.
    pub(crate) fn pulled(&self, velocity: Vec3, end: f64) -> (Scene, Vec<u32>) {
        let length = self.extent()[0];
        let mut right = Vec::new();
        let rise = 0.1 * end;
        let (scene, _) = self.scene(end, |mesh| {
            right = Bar::at(mesh, |p| p.x > length - 1e-9);
            let left = Bar::at(mesh, |p| p.x < 1e-9);
            let axes = 0..if self.kind == ElementKind::T3 { 2 } else { 3 };
            let moved = |axis: usize| {
                let speed = velocity[axis];
                let way = move |t: f64| if t < rise { 0.5 * t * t / rise } else { t - 0.5 * rise };
                Motion::Displacement(Arc::new(move |t, _| speed * way(t)))
            };
            let held = axes.clone().map(|axis| Support::new("left", left.clone(), axis, Motion::Fixed));
            let held: Vec<Support> = held.collect();
            let drawn = axes.map(|axis| Support::new("right", right.clone(), axis, moved(axis)));
            held.into_iter().chain(drawn).collect()
        });
        (scene, right)
    }
}

const KINDS: [ElementKind; 2] = [ElementKind::T3, ElementKind::T4];

fn turn(kind: ElementKind, degrees: f64) -> Mat3 {
    let axis = if kind == ElementKind::T3 { Vec3::z() } else { Vec3::new(1.0, 2.0, -1.0).normalize() };
    Rotation3::new(axis * degrees.to_radians()).into_inner()
}

/// A uniform stress across an interface in any direction: strains are uniform, and the jump is traction over stiffness.
#[test]
fn a_patch_with_an_interface_is_exact_in_any_direction() {
    for kind in KINDS {
        for (degrees, nu, seed) in [(0.0, 0.0, 1), (27.0, 0.2, 2), (63.0, 0.45, 3)] {
            let stiffness = [4e12, 2e12];
            let law =
                InterfaceLaw { tensile_strength: 1e9, cohesion: 1e9, opening_energy: 1e6, sliding_energy: 1e6, ..LAW };
            let interface = Some((law, Some(stiffness)));
            let bar = Bar { poisson_ratio: nu, seed, turn: turn(kind, degrees), interface, ..Bar::new(kind, None) };
            // Before it turns: any strain, and the traction of its stress on the plane across x.
            let plane = kind == ElementKind::T3;
            let mut strain = Mat3::new(2e-5, 1e-5, -0.5e-5, 1e-5, -1e-5, 0.7e-5, -0.5e-5, 0.7e-5, 1.5e-5);
            if plane {
                strain.row_mut(2).fill(0.0);
                strain.column_mut(2).fill(0.0);
            }
            let young = CONCRETE.young_modulus;
            let (mu, lambda) = (0.5 * young / (1.0 + nu), young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)));
            let stress = strain * (2.0 * mu) + Mat3::identity() * (lambda * strain.trace());
            let traction = stress.column(0);
            let jump = Vec3::new(traction[0] / stiffness[0], traction[1] / stiffness[1], traction[2] / stiffness[1]);
            let (turn, [length, width]) = (bar.turn, bar.extent());
            let (mut scene, mesh) = bar.scene(1.0, |mesh| {
                let second = mesh.group_nodes("second");
                let is_outer = |p: &Vec3| {
                    let end = |x: f64, size: f64| x < 1e-9 || x > size - 1e-9;
                    end(p.x, length) || end(p.y, width) || (!plane && end(p.z, width))
                };
                let outer = Bar::at(mesh, is_outer);
                let sides = outer.into_iter().partition::<Vec<u32>, _>(|node| second.binary_search(node).is_err());
                let mut supports = Vec::new();
                for (nodes, jump) in [(sides.0, Vec3::zeros()), (sides.1, jump)] {
                    for axis in 0..if plane { 2 } else { 3 } {
                        let of =
                            move |t: f64, place: &Vec3| t * (turn * (strain * (turn.transpose() * place) + jump))[axis];
                        let moved = Motion::Displacement(Arc::new(of));
                        supports.push(Support::new("outer", nodes.clone(), axis, moved));
                    }
                }
                supports
            });
            let mut solver = StaticSolver::new(&scene, statics(1.0, 1.0)).unwrap();
            while !solver.is_finished(&scene) {
                solver.step(&mut scene).unwrap();
            }
            let second = mesh.group_nodes("second");
            let mut worst = 0.0f64;
            for (node, place) in (0u32..).zip(&mesh.nodes) {
                let own = if second.binary_search(&node).is_ok() { jump } else { Vec3::zeros() };
                let expected = turn * (strain * place + own);
                worst = worst.max((scene.solid.displacement[node as usize] - expected).norm());
            }
            let scale = (strain * Vec3::new(length, width, width)).norm();
            assert!(worst < 1e-10 * scale, "{kind:?} {degrees}: {worst:e} of {scale:e}");
            for face in 0..mesh.cuts.len() {
                let is = scene.interfaces().reading(face);
                assert!((is.normal_traction / traction[0] - 1.0).abs() < 1e-8, "{kind:?} {degrees}: {is:?}");
            }
            assert!(scene.ledger().residual_max_relative < 1e-9, "{:?}", scene.ledger());
        }
    }
}

/// Halves that have slid on each other and then turn together are opened by nothing, also where their body turns from small strains to corotational ones.
#[test]
fn a_body_that_begins_to_turn_does_not_open_what_has_slid() {
    for kinematics in [Kinematics::Auto, Kinematics::Corotational] {
        let law = InterfaceLaw { tensile_strength: 0.0, cohesion: 0.0, ..LAW };
        let bar = Bar { kinematics, ..Bar::new(ElementKind::T3, Some((law, Some([1e14, 1e12])))) };
        let (slip, end, degrees) = (1e-5, 2e-3, 3.0f64);
        let smooth = move |t: f64| {
            let t = (t / end).clamp(0.0, 1.0);
            t * t * (3.0 - 2.0 * t)
        };
        let (mut scene, _) = bar.scene(end, |mesh| {
            let second = mesh.group_nodes("second");
            let all = Bar::at(mesh, |_| true);
            let sides = all.into_iter().partition::<Vec<u32>, _>(|node| second.binary_search(node).is_err());
            let mut supports = Vec::new();
            for (nodes, slip) in [(sides.0, 0.0), (sides.1, slip)] {
                for axis in 0..2 {
                    let of = move |t: f64, place: &Vec3| {
                        let moved = place + Vec3::y() * (slip * smooth(2.0 * t));
                        let turn = degrees.to_radians() * smooth((t - 0.5 * end).max(0.0) * 2.0);
                        (Rotation3::from_axis_angle(&Vec3::z_axis(), turn) * moved - place)[axis]
                    };
                    supports.push(Support::new("all", nodes.clone(), axis, Motion::Displacement(Arc::new(of))));
                }
            }
            supports
        });
        let mut opened = 0.0f64;
        while !scene.is_finished() {
            scene.step(false).unwrap();
            for face in 0..scene.interfaces().faces().len() {
                opened = opened.max(scene.interfaces().reading(face).opening.abs());
            }
        }
        assert_eq!(scene.solid.body(0).kinematics, Kinematics::Corotational);
        // What is left is the slip times the angle at which the body counts as turning; without a strain it is none.
        let most = if kinematics == Kinematics::Auto { 0.003 } else { 1e-6 };
        assert!(opened < most * slip, "{kinematics:?}: {opened:e}");
        let slid = scene.interfaces().reading(0).slip.norm();
        assert!((slid / slip - 1.0).abs() < 0.01, "{kinematics:?}: {slid:e}");
    }
}

/// Until its strength is met a stiff interface is not there: the motion and the step are those of the bar in one piece.
#[test]
fn a_stiff_interface_moves_as_one_and_takes_nothing_of_the_step() {
    for kind in KINDS {
        let law = InterfaceLaw { tensile_strength: 1e12, cohesion: 1e12, ..LAW };
        let step = Some(5e-7);
        let bar = |interface| Bar { formulation: Formulation::Standard, interface, step, ..Bar::new(kind, None) };
        let run = |interface| {
            let (mut scene, _) = bar(interface).pulled(Vec3::new(1.0, 0.3, 0.0), 2e-4);
            let dt = scene.stable_dt();
            while !scene.is_finished() {
                scene.step(true).unwrap();
            }
            let place = scene.solid.reference.iter().position(|p| (p - Vec3::new(0.02, 0.0, 0.0)).norm() < 1e-9);
            (dt, scene.solid.displacement[place.unwrap()], scene.ledger().residual_max_relative)
        };
        let [whole, cut] = [None, Some((law, None))].map(run);
        // Nodes on the cut have the mass of one side alone.
        assert!(cut.0 >= 0.9 * whole.0, "{kind:?}: step {:e} of {:e}", cut.0, whole.0);
        let apart = (whole.1 - cut.1).norm() / whole.1.norm();
        assert!(apart < 1e-9, "{kind:?}: {apart:e}");
        assert!(cut.2 < 1e-3, "{kind:?}: {}", cut.2);
    }
}

/// Torn, sheared and torn askew: the strength of the ellipse, and the energy of the mode, stiff or not.
#[test]
fn a_bar_that_is_torn_has_the_strength_and_the_energy_of_its_interface() {
    for kind in KINDS {
        for softening in [InterfaceSoftening::Linear, InterfaceSoftening::Exponential] {
            for stiffness in [None, Some([2e13, 2e13])] {
                let law = InterfaceLaw { softening, ..LAW };
                let bar = Bar { poisson_ratio: 0.0, interface: Some((law, stiffness)), ..Bar::new(kind, None) };
                let opens = 2.0 * law.opening_energy / law.tensile_strength;
                let last = if softening == InterfaceSoftening::Linear { 1.3 } else { 3.5 };
                let end = 4e-3;
                let (mut scene, _) = bar.pulled(Vec3::x() * (last * opens / end), end);
                let (mut peak, mut step) = (0.0f64, 0);
                while !scene.is_finished() {
                    scene.step(step % 20 == 0).unwrap();
                    let traction = |face: usize| scene.interfaces().reading(face).normal_traction;
                    peak = (0..scene.interfaces().faces().len()).map(traction).fold(peak, f64::max);
                    step += 1;
                }
                let ledger = scene.ledger();
                let [peak, spent] = [
                    peak / law.tensile_strength,
                    ledger[EnergyKind::InterfaceFracture] / (law.opening_energy * bar.area()),
                ];
                let name = format!("{kind:?} {softening:?} {stiffness:?}: peak {peak} energy {spent} {ledger:?}");
                println!("{name}");
                let left = if softening == InterfaceSoftening::Linear { 0.0 } else { (-2.0 * last).exp() };
                assert!((peak - 1.0).abs() < 0.01, "{name}");
                assert!((spent - (1.0 - left)).abs() < 0.02, "{name}");
                assert!(ledger.residual_max_relative < 1e-3, "{name}");
            }
        }
    }
}

/// Opened, closed, slid and opened again under any law: the balance holds, and stiff sides do not pass through each other.
#[test]
fn an_interface_that_opens_closes_and_rubs_keeps_the_balance() {
    for kind in KINDS {
        for (stiffness, dilation) in [(None, 0.0), (None, 0.2), (Some([1e13, 5e12]), 0.0), (Some([1e13, 5e12]), 0.2)] {
            let law = InterfaceLaw { dilation, ..LAW };
            let bar = Bar { interface: Some((law, stiffness)), ..Bar::new(kind, None) };
            let length = bar.extent()[0];
            let opens = 2.0 * law.opening_energy / law.tensile_strength;
            let end = 2e-3;
            let (mut scene, mesh) = bar.scene(end, |mesh| {
                let right = Bar::at(mesh, |p| p.x > length - 1e-9);
                let left = Bar::at(mesh, |p| p.x < 1e-9);
                let way = move |t: f64| (2.0 * std::f64::consts::PI * t / end).sin() * 0.6 * opens;
                let slide = move |t: f64| (7.0 * t / end).sin() * opens;
                let axes = if kind == ElementKind::T3 { 2 } else { 3 };
                let mut supports: Vec<Support> =
                    (0..axes).map(|axis| Support::new("left", left.clone(), axis, Motion::Fixed)).collect();
                supports.push(Support::new(
                    "right",
                    right.clone(),
                    0,
                    Motion::Displacement(Arc::new(move |t, _| way(t))),
                ));
                supports.push(Support::new("right", right, 1, Motion::Displacement(Arc::new(move |t, _| slide(t)))));
                supports
            });
            let mut step = 0;
            while !scene.is_finished() {
                scene.step(step % 10 == 0).unwrap();
                step += 1;
                if stiffness.is_none() && dilation == 0.0 {
                    for face in 0..mesh.cuts.len() {
                        let is = scene.interfaces().reading(face);
                        assert!(is.opening > -1e-6 * opens, "{kind:?}: {is:?}");
                    }
                }
            }
            let ledger = scene.ledger();
            let name = format!("{kind:?} {stiffness:?} {dilation}: {ledger:?}");
            println!("{name}");
            assert!(ledger.residual_max_relative < 1e-3, "{name}");
            assert!(ledger[EnergyKind::Friction] > 0.0 && ledger[EnergyKind::InterfaceFracture] > 0.0, "{name}");
        }
    }
}

/// The same bits for any number of threads, and after a state was put back.
#[test]
fn interfaces_have_the_same_bits_on_any_threads_and_after_a_resume() {
    for stiffness in [None, Some([1e13, 5e12])] {
        let bar = Bar { cells: [10, 4], interface: Some((LAW, stiffness)), ..Bar::new(ElementKind::T4, None) };
        let end = 1e-3;
        let velocity = Vec3::new(0.15, 0.1, 0.0);
        let run = |threads: usize, resume: bool| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let (mut scene, _) = bar.pulled(velocity, end);
                while !scene.is_finished() {
                    scene.step(false).unwrap();
                    if resume && scene.clock.step == 150 {
                        let state = scene.state();
                        scene = bar.pulled(velocity, end).0;
                        scene.restore(state);
                    }
                }
                scene.step(true).unwrap();
                (scene.solid.displacement.clone(), *scene.ledger(), scene.state())
            })
        };
        let one = run(1, false);
        let broken: f64 = one.1[EnergyKind::InterfaceFracture];
        assert!(broken > 0.0, "{:?}", one.1);
        for (threads, resume) in [(2, false), (7, false), (1, true)] {
            let other = run(threads, resume);
            assert!(one == other, "{stiffness:?} {threads} {resume}");
        }
    }
}

/// A pulse through a spring between two halves: σ_t' = 2 K/Z (σ_i - σ_t) with the impedance Z of the bar (Schoenberg 1980), at three stiffnesses.
#[test]
fn a_pulse_passes_a_spring_by_its_stiffness() {
    let (speed, duration, end) = ((CONCRETE.young_modulus / CONCRETE.density).sqrt(), 8e-5, 3.2e-4);
    let step = 2e-7;
    let passed = |interface: Option<(InterfaceLaw, Option<[f64; 2]>)>| -> Vec<f64> {
        let bar = Bar {
            cells: [200, 2],
            size: 0.005,
            poisson_ratio: 0.0,
            step: Some(step),
            ..Bar::new(ElementKind::T3, interface)
        };
        let mut behind = 0;
        let (mut scene, _) = bar.scene(end, |mesh| {
            let nearest = |n: &usize| (mesh.nodes[*n] - Vec3::new(0.6, 0.005, 0.0)).norm();
            behind = (0..mesh.nodes.len()).min_by(|a, b| nearest(a).total_cmp(&nearest(b))).unwrap();
            let pushed = Arc::new(move |t: f64, _: &Vec3| {
                let phase = std::f64::consts::TAU * (t / duration).min(1.0);
                1e-7 * (phase - phase.sin())
            });
            vec![Support::new("left", Bar::at(mesh, |p| p.x < 1e-9), 0, Motion::Displacement(pushed))]
        });
        let mut velocity = Vec::new();
        while !scene.is_finished() {
            scene.step(false).unwrap();
            velocity.push(scene.solid.velocity[behind].x);
        }
        velocity
    };
    let incident = passed(None);
    let impedance = CONCRETE.density * speed;
    for times in [0.5, 2.0, 8.0] {
        let stiffness = times * impedance / duration;
        let strong =
            InterfaceLaw { tensile_strength: 1e9, cohesion: 1e9, opening_energy: 1e9, sliding_energy: 1e9, ..LAW };
        let found = passed(Some((strong, Some([stiffness; 2]))));
        let rate = 2.0 * stiffness / impedance * step;
        let (mut expected, mut worst, mut before) = (0.0, 0.0f64, 0.0);
        for (is, of) in found.iter().zip(&incident) {
            // The middle of a step for what comes and for what has passed.
            expected = (expected * (1.0 - 0.5 * rate) + 0.5 * rate * (of + before)) / (1.0 + 0.5 * rate);
            before = *of;
            worst = worst.max((is - expected).abs());
        }
        let largest = incident.iter().fold(0.0f64, |a, b| a.max(b.abs()));
        assert!(worst < 0.01 * largest, "{times}: off by {} of the pulse", worst / largest);
    }
}
