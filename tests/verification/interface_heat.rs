//! Heat through interfaces: steady flow against the sum of resistances, none where the sides have parted, the same state after a resume.

use std::sync::Arc;

use fractum_fem::{Elastic, Formulation, Solid};
use fractum_math::Vec3;
use fractum_scene::coupling::Debris;
use fractum_scene::{
    Bonded, ContactParameters, Heat, HeatCondition, HeatSettings, InterfaceKind, InterfaceLaw, Loads, Motion,
    PackingConduction, Scene, Support, Supports, TemperatureTake, ThermalMaterial,
};
use fractum_tests::{CONCRETE, settings};

use crate::slab::{OPEN, Slab, mirrored};

const BONDED: InterfaceLaw =
    InterfaceLaw { tensile_strength: 2e6, cohesion: 2e6, opening_energy: 50.0, sliding_energy: 50.0, ..OPEN };
const MATERIAL: ThermalMaterial = ThermalMaterial { conductivity: 3.0, capacity: 800.0, expansion: 0.0 };
const HOT: f64 = 400.0;
const COLD: f64 = 300.0;

/// Nodes of the elements on one side of the interface.
fn nodes_of(solid: &Solid, is_side: impl Fn(f64) -> bool) -> Vec<u32> {
    let body = solid.body(0);
    let corners = body.shape.node_count();
    let middle = |element: &[u32; 4]| element[..corners].iter().map(|&n| solid.reference[n as usize].y).sum::<f64>();
    let mut nodes: Vec<u32> = body.elements.iter().filter(|e| is_side(middle(e))).flatten().copied().collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

/// A column of ten elements on either side of an interface, hot above and cold below.
#[derive(Clone, Copy)]
struct Column {
    is_plane: bool,
    size: f64,
    law: InterfaceLaw,
    transfer: Option<f64>,
    material: ThermalMaterial,
    /// Speed at which the upper half leaves; none where nothing moves.
    speed: Option<f64>,
    end: f64,
}

const COLUMN: Column =
    Column { is_plane: true, size: 0.01, law: OPEN, transfer: None, material: MATERIAL, speed: None, end: 2e5 };

impl Column {
    fn height(&self) -> f64 {
        10.0 * self.size
    }

    fn scene(&self) -> Scene {
        let side = vec![0.0, self.size, 2.0 * self.size];
        let up: Vec<f64> = (0..=10).map(|row| f64::from(row) * self.size).collect();
        let third = if self.is_plane { Vec::new() } else { side.clone() };
        let elastic: Elastic = CONCRETE;
        let slab = Slab { places: [side, mirrored(&up), third], elastic, formulation: Formulation::Standard };
        let mesh = slab.mesh();
        let kind = InterfaceKind { name: "joint".to_owned(), law: self.law, stiffness: None };
        let (mut solid, interfaces) = slab.solid(&mesh, vec![kind], |_| 0);
        let [upper, lower] = [nodes_of(&solid, |y| y > 0.0), nodes_of(&solid, |y| y < 0.0)];
        let at = |y: f64| -> Vec<u32> {
            let near = |n: &u32| (solid.reference[*n as usize].y - y).abs() < 1e-6 * self.size;
            (0..solid.reference.len() as u32).filter(near).collect()
        };
        let held = |y: f64, value: f64| HeatCondition::Temperature {
            points: at(y),
            value: Arc::new(move |_, _: &Vec3| value),
        };
        let middle = 0.5 * (HOT + COLD);
        let slope = 0.5 * (HOT - COLD) / self.height();
        let heat = HeatSettings {
            solids: vec![self.material],
            bonded: Vec::new(),
            interfaces: vec![self.transfer],
            packing: PackingConduction::Table,
            initial: Arc::new(move |_, place| middle + slope * place.y),
            stress_free: COLD,
            conditions: if self.speed.is_some() {
                Vec::new()
            } else {
                vec![held(self.height(), HOT), held(-self.height(), COLD)]
            },
            implicit: self.speed.is_none(),
            step: self.speed.is_none().then_some(self.end / 100.0),
            safety: 0.5,
            longest: 1e-5,
            alone: self.speed.is_none(),
            at_rest: false,
            unstressed: false,
        };
        let heat = Heat::new(&mut solid, &mut Bonded::default(), &interfaces, heat).unwrap();
        let speed = self.speed.unwrap_or_default();
        let moves = |axis: usize| match axis {
            1 => Motion::Velocity(Arc::new(move |_, _| speed)),
            _ => Motion::Fixed,
        };
        let of = |nodes: &[u32], axis: usize, motion: Motion| Support::new("held", nodes.to_vec(), axis, motion);
        let supports = (0..3).flat_map(|axis| [of(&upper, axis, moves(axis)), of(&lower, axis, Motion::Fixed)]);
        let supports = Supports::new(supports.collect(), &solid.reference).unwrap();
        let loads = Loads::new(Vec::new(), solid.reference.len());
        let debris = Debris::new(&solid, vec![ContactParameters::default()]);
        let scene = Scene::new(solid, supports, loads, debris, Vec::new(), &[], settings(self.end, f64::INFINITY));
        scene.with_interfaces(interfaces).with_heat(heat, self.speed.is_none())
    }
}

/// Difference of temperature between both sides, mean over the faces [K].
fn jump(scene: &Scene) -> f64 {
    let temperature = scene.heat().unwrap().of_nodes();
    let of_face = |face: &fractum_scene::InterfaceFace| {
        let mean = |side: [u32; 3]| side.iter().map(|&n| temperature[n as usize]).sum::<f64>() / 3.0;
        (mean(face.sides[1]) - mean(face.sides[0])).abs()
    };
    let faces = scene.interfaces().faces();
    faces.iter().map(of_face).sum::<f64>() / faces.len() as f64
}

/// The resistances of both halves and of the interface stand one behind the other: in the plane and in space, metres and micrometres, given and as good as none.
#[test]
fn heat_passes_an_interface_by_its_coefficient() {
    for is_plane in [true, false] {
        for size in [0.01, 1e-5] {
            for transfer in [Some(5.0 / size * 0.01), Some(500.0 / size * 0.01), None] {
                for law in [OPEN, BONDED] {
                    let end = 2e5 * (size / 0.01f64).powi(2);
                    let own = Column { is_plane, size, transfer, law, end, ..COLUMN };
                    let mut scene = own.scene();
                    while scene.clock.time < own.end * (1.0 - 1e-9) {
                        scene.conduct_alone().unwrap();
                    }
                    let firm = 100.0 * MATERIAL.conductivity / size;
                    let resists = 1.0 / transfer.unwrap_or(firm);
                    let exact = (HOT - COLD) * resists / (resists + 20.0 * size / MATERIAL.conductivity);
                    let found = jump(&scene);
                    assert!((found / exact - 1.0).abs() < 1e-5, "{is_plane} {size} {transfer:?}: {found} for {exact}");
                    assert!(scene.heat().unwrap().ledger().residual().abs() < 1e-6);
                }
            }
        }
    }
}

/// Mean temperature of the lower half [K].
fn below(scene: &Scene) -> f64 {
    let lower = nodes_of(&scene.solid, |y| y < 0.0);
    scene.heat().unwrap().temperature_of(false, &lower, TemperatureTake::Mean)
}

/// No heat passes sides that have parted: at once where nothing joined them, once it has broken where a bond did; a resumed run goes on with the same bits.
#[test]
fn no_heat_passes_sides_that_have_parted() {
    let material = ThermalMaterial { conductivity: 1e5, ..MATERIAL };
    for law in [OPEN, BONDED] {
        let own = Column { law, material, speed: Some(1.0), end: 3e-4, size: 1e-3, ..COLUMN };
        let run = |mut scene: Scene, from: f64| {
            let mut seen = Vec::new();
            while !scene.is_finished() {
                scene.step(false).unwrap();
                seen.push((scene.clock.time, below(&scene), jump(&scene)));
                if scene.clock.time >= from {
                    break;
                }
            }
            (scene, seen)
        };
        let (scene, first) = run(own.scene(), 1e-4);
        let (saved, heat) = (scene.state(), scene.heat_state());
        let (whole, then) = run(scene, f64::INFINITY);
        let mut resumed = own.scene();
        resumed.restore(saved);
        resumed.restore_heat(heat);
        let (resumed, _) = run(resumed, f64::INFINITY);
        assert!(resumed.state() == whole.state() && resumed.heat_state() == whole.heat_state());
        // 50 um is where the bond has broken.
        let early = first.iter().find(|(time, ..)| *time > 3e-5).unwrap().2;
        let [(_, before, _), (_, after, apart)] = [then[0], then[then.len() - 1]];
        println!("{early} K between the sides, then {apart} K; below {before} and {after} K");
        let is_bonded = law.opening_energy == BONDED.opening_energy;
        assert!(if is_bonded { early < 1.0 } else { early > 1.0 }, "{early}");
        assert!(apart > 20.0 && (before - after).abs() < 1e-9, "{before} {after} K");
        assert!(if is_bonded { before > 326.0 } else { before < 326.0 }, "{before} K");
    }
}
