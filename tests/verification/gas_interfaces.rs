//! Gas in interfaces: steady flow through a joint, its opening against a crack under pressure, a bond that gas breaks, and elements that break beside it.

use fractum_fem::{Elastic, Formulation, LocalDamping, Solid};
use fractum_gas::{EquationOfState, PerfectGas, SlitFlow};
use fractum_math::Vec3;
use fractum_scene::coupling::Debris;
use fractum_scene::{
    Charge, ContactParameters, EnergyKind, Gas, GasHole, GasMeasure, GasRoom, GasSettings, HoleEnds, InterfaceKind,
    InterfaceLaw, Interfaces, Loads, Scene, Supports, SymmetryPlanes,
};
use fractum_tests::{CONCRETE, settings, softening, surface};

use crate::slab::{OPEN, Slab, fixed, graded, mirrored};

const BONDED: InterfaceLaw =
    InterfaceLaw { tensile_strength: 2e6, cohesion: 4e6, opening_energy: 20.0, sliding_energy: 80.0, ..OPEN };
const HEAT_RATIO: f64 = 1.3;

/// Half of a slab whose other half lies beyond x = 0, with a hole there, from which a joint goes out along y = 0.
#[derive(Clone)]
struct Jointed {
    is_plane: bool,
    elastic: Elastic,
    law: InterfaceLaw,
    stiffness: Option<[f64; 2]>,
    formulation: Formulation,
    /// Size of the elements along the joint, which in space is two of them deep under one that is whole; half width of the hole, begin and end of the joint, and end of the slab [m].
    size: f64,
    hole: f64,
    begin: f64,
    joint: f64,
    far: f64,
    pressure: f64,
    outside: f64,
    slits: SlitFlow,
    least_opening: f64,
    end: f64,
    damping: f64,
    safety: f64,
    is_held: bool,
    /// Whether its elements may break.
    breaks: bool,
}

impl Jointed {
    fn scene(&self) -> Scene {
        let along = graded(self.size, self.joint.min(self.far), self.far, 1.2);
        let across = mirrored(&graded(self.size, 2.0 * self.hole, self.far, 1.2));
        let third = if self.is_plane { Vec::new() } else { [0.0, 1.0, 2.0, 3.0].map(|z| z * self.size).to_vec() };
        let slab = Slab { places: [along, across, third], elastic: self.elastic, formulation: self.formulation };
        let is_cut = |p: &Vec3| p.x > self.begin && p.x < self.joint && p.z < 2.0 * self.size;
        let mesh = slab.mesh_with(|p| p.x > self.hole || p.y.abs() > self.hole, is_cut);
        let kind = InterfaceKind { name: "joint".to_owned(), law: self.law, stiffness: self.stiffness };
        let (solid, interfaces) = slab.solid(&mesh, vec![kind.clone()], |_| 0);
        let (solid, interfaces) = if self.breaks {
            let body = solid.body(0).clone().with_damage(softening(10.0));
            let solid = Solid::new(mesh.nodes.clone(), vec![body]).unwrap();
            let interfaces = Interfaces::new(&solid, vec![kind], interfaces.faces().to_vec());
            (solid, interfaces)
        } else {
            (solid, interfaces)
        };
        let depth = 3.0 * self.size;
        let symmetry = SymmetryPlanes([Some(0.0), None, None]);
        let symmetry = if self.is_plane { symmetry } else { SymmetryPlanes([Some(0.0), None, Some(0.0)]) };
        let near = 1e-6 * self.size;
        let on_wall = |node: &u32| {
            let p = solid.reference[*node as usize];
            p.x < self.hole + near && p.y.abs() < self.hole + near
        };
        let is_joint = |facet: &[u32; 3]| facet.iter().all(|&node| solid.reference[node as usize].y.abs() < near);
        let is_end = |facet: &[u32; 3]| {
            [0.0, depth].iter().any(|z| facet.iter().all(|&n| (solid.reference[n as usize].z - z).abs() < near))
                && !self.is_plane
                || facet.iter().all(|&n| solid.reference[n as usize].x < near)
        };
        let facets: Vec<[u32; 3]> = surface(&solid).into_iter().collect();
        let facets: Vec<[u32; 3]> =
            facets.into_iter().filter(|f| f.iter().all(on_wall) && !is_joint(f) && !is_end(f)).collect();
        let pairs = interfaces.faces().iter().flat_map(|face| [0, 1, 2].map(|k| face.sides.map(|side| side[k])));
        let root = fractum_math::connected(solid.reference.len(), pairs);
        let joined: Vec<[u32; 3]> = facets.iter().map(|facet| facet.map(|node| root[node as usize])).collect();
        let ends = HoleEnds::find(&solid, &joined, symmetry, !self.is_plane).unwrap();
        let gas = GasSettings {
            law: EquationOfState::PerfectGas(PerfectGas { heat_ratio: HEAT_RATIO, gas_constant: 300.0 }),
            slits: self.slits,
            least_opening: self.least_opening,
            in_cracks: true,
            outside_pressure: self.outside,
            symmetry,
            holes: vec![GasHole {
                stemming: None,
                ends,
                facets,
                charge: Charge::State { pressure: self.pressure, temperature: 1000.0 },
                source: None,
            }],
        };
        let nodes = |keep: &dyn Fn(&Vec3) -> bool| -> Vec<u32> {
            (0..solid.reference.len() as u32).filter(|&n| keep(&solid.reference[n as usize])).collect()
        };
        let all: Vec<usize> = if self.is_held { vec![0, 1, 2] } else { Vec::new() };
        let mut supports: Vec<_> = all.into_iter().map(|axis| fixed(nodes(&|_| true), axis)).collect();
        if !self.is_held {
            supports.push(fixed(nodes(&|p| p.x < near), 0));
            if !self.is_plane {
                supports.push(fixed(nodes(&|_| true), 2));
            }
        }
        let supports = Supports::new(supports, &solid.reference).unwrap();
        let loads = Loads::new(Vec::new(), solid.reference.len()).with_gas(Some(Gas::new(&solid, gas)));
        let debris = Debris::new(&solid, vec![ContactParameters::default()]);
        let mut settings = settings(self.end, f64::INFINITY);
        settings.time_step.safety = self.safety;
        settings.damping = LocalDamping { local: 0.0, mass_rate: self.damping };
        Scene::new(solid, supports, loads, debris, Vec::new(), &[], settings).with_interfaces(interfaces)
    }

    fn run(&self) -> Scene {
        let mut scene = self.scene();
        while !scene.is_finished() {
            scene.step(true).unwrap();
        }
        scene
    }
}

const PLATE: Jointed = Jointed {
    is_plane: true,
    elastic: CONCRETE,
    law: OPEN,
    stiffness: None,
    formulation: Formulation::Smoothed,
    size: 5e-3,
    hole: 5e-3,
    begin: 0.0,
    joint: 0.1,
    far: 1.0,
    pressure: 20e6,
    outside: 1e5,
    slits: SlitFlow { viscosity: 5e-5, roughness: 0.0 },
    least_opening: 1e-5,
    end: 2e-3,
    damping: 0.0,
    safety: 0.8,
    is_held: false,
    breaks: false,
};

fn faces(scene: &Scene) -> impl Iterator<Item = fractum_scene::GasCell> {
    scene.gas().unwrap().cells().filter(|cell| matches!(cell.room, GasRoom::Face(_)))
}

/// Rate at which mass leaks in the last tenth of a run [kg/s], and the mean of the square of the pressure in the hole there [Pa²].
fn leak_rate(own: &Jointed) -> (Scene, f64, f64) {
    let mut scene = own.scene();
    let look = |scene: &Scene| {
        let gas = scene.gas().unwrap();
        (scene.clock.time, gas.leaked().mass, gas.cells().next().unwrap().pressure.powi(2))
    };
    let mut before = None;
    while !scene.is_finished() {
        scene.step(false).unwrap();
        if before.is_none() && scene.clock.time > 0.9 * own.end {
            before = Some(look(&scene));
        }
    }
    let ((from, less, first), (to, more, last)) = (before.unwrap(), look(&scene));
    (scene, (more - less) / (to - from), 0.5 * (first + last))
}

/// A joint between walls that do not move, from a hole to the surface: w³ b (p₁² - p₂²)/(24 μ R T L), in the plane and in space, metres and millimetres. The density is that of
/// the face from which the gas comes, so that half of the faces have twice the error, and two sizes lead to none.
#[test]
fn steady_flow_through_a_joint_is_that_of_a_slit() {
    let error = |is_plane: bool, scale: f64, size: f64| {
        let own = Jointed {
            is_plane,
            size: size * scale,
            hole: 0.05 * scale,
            joint: 0.15 * scale,
            far: 0.15 * scale,
            pressure: 1e4,
            outside: 5e3,
            slits: SlitFlow { viscosity: 1e-4 * scale, roughness: 0.0 },
            least_opening: 1e-3 * scale,
            end: 8e-3 * scale,
            is_held: true,
            ..PLATE
        };
        let (scene, rate, square) = leak_rate(&own);
        let gas = scene.gas().unwrap();
        let hole = gas.cells().next().unwrap();
        let depth = if is_plane { 1.0 } else { 2.0 * own.size };
        let cubed = own.least_opening.powi(3) * depth;
        let squares = square - own.outside.powi(2);
        let resists = 24.0 * own.slits.viscosity * 300.0 * hole.temperature * 0.1 * scale;
        // The wall of half of the hole, and both sides of the joint.
        let wetted = gas.measure(&scene.solid, GasMeasure::WettedArea, Some(0));
        let wall = 4.0 * own.hole * if is_plane { 1.0 } else { 3.0 * own.size };
        assert!((wetted / (wall + 0.2 * scale * depth) - 1.0).abs() < 1e-9, "{wetted}");
        rate / (cubed * squares / resists) - 1.0
    };
    let [coarse, fine] = [0.01, 0.005].map(|size| error(true, 1.0, size));
    println!("{coarse:.4} {fine:.4}");
    assert!(fine.abs() < 0.02 && (2.0 * fine - coarse).abs() < 0.005, "{coarse} {fine}");
    let [space, small] = [(false, 1.0), (true, 1e-3)].map(|(is_plane, scale)| error(is_plane, scale, 0.01));
    println!("in space {space:.4}, in millimetres {small:.4}");
    assert!((space - coarse).abs() < 0.01 && (small - coarse).abs() < 1e-3, "{space} {small}");
}

/// A joint that gas has filled opens as a crack under its pressure (Sneddon 1946), and holds it at one pressure; Poisson's ratios, a stiff joint and one of springs.
#[test]
fn a_joint_full_of_gas_opens_as_a_crack_under_pressure() {
    for (poisson_ratio, stiffness) in [(0.0, None), (0.2, None), (0.4, None), (0.2, Some([6e13, 6e13]))] {
        let elastic = Elastic { poisson_ratio, ..CONCRETE };
        let own = Jointed { elastic, stiffness, damping: 2e3, end: 4e-3, ..PLATE };
        let scene = own.run();
        let ledger = scene.ledger();
        let pressures: Vec<f64> = scene.gas().unwrap().cells().map(|cell| cell.pressure).collect();
        let [low, high] = pressures.iter().fold([f64::MAX, 0.0], |[low, high], p| [p.min(low), p.max(high)]);
        let modulus = elastic.young_modulus / (1.0 - poisson_ratio * poisson_ratio);
        // Half-way along the joint, the hole being a part of the crack.
        let exact = 4.0 * high * own.joint * 0.75f64.sqrt() / modulus;
        let at = |face: usize| {
            let corners = scene.interfaces().faces()[face].sides[0].map(|node| scene.solid.reference[node as usize].x);
            0.5 * (corners[0] + corners[1])
        };
        let nearest = (0..scene.interfaces().faces().len())
            .min_by(|a, b| (at(*a) - 0.05).abs().total_cmp(&(at(*b) - 0.05).abs()))
            .unwrap();
        let opening = scene.interfaces().reading(nearest).opening;
        println!(
            "nu {poisson_ratio}: pressures {:.4} to {:.4} MPa, opening {:.4}, residual {:.1e}",
            low * 1e-6,
            high * 1e-6,
            opening / exact - 1.0,
            ledger.residual_max_relative
        );
        assert!(high / low < 1.02 && ledger.residual_max_relative < 1e-3);
        assert!((opening / exact - 1.0).abs() < 0.05, "{}", opening / exact);
    }
}

/// Gas breaks a bond that holds it in a hole, and follows the crack; the same bits on 1, 2 and 7 threads and after a resume.
#[test]
fn gas_breaks_a_bond_and_follows_its_crack() {
    let own = Jointed { law: BONDED, far: 0.2, size: 4e-3, hole: 8e-3, joint: 0.16, end: 150e-6, ..PLATE };
    let run = |mut scene: Scene| {
        let mut saved = None;
        while !scene.is_finished() {
            scene.step(true).unwrap();
            if scene.clock.time > 0.5 * own.end && saved.is_none() {
                saved = Some(scene.state());
            }
        }
        (scene.state(), saved.unwrap(), scene)
    };
    let runs = [1, 2, 7].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(own.scene()))
    });
    let (state, saved, scene) = &runs[0];
    assert!(runs.iter().all(|(own, ..)| own == state));
    let mut resumed = own.scene();
    resumed.restore(saved.clone());
    assert!(resumed.state() == *saved);
    while !resumed.is_finished() {
        resumed.step(true).unwrap();
    }
    assert!(resumed.state() == *state);
    let wet = faces(scene).filter(|cell| cell.pressure > 1e5).count();
    let ledger = scene.ledger();
    println!("{wet} of {} faces, residual {:.1e}", scene.interfaces().faces().len(), ledger.residual_max_relative);
    assert!(wet > 5 && wet < scene.interfaces().faces().len());
    assert!(ledger.residual_max_relative < 1e-3 && ledger[EnergyKind::InterfaceFracture] > 0.0);
    // Whole faces hold nothing.
    let readings = (0..scene.interfaces().faces().len()).map(|face| scene.interfaces().reading(face).residual);
    assert!(readings.zip(faces(scene)).all(|(left, cell)| left < 1.0 || cell.amount.mass == 0.0));
}

/// The same in space, with half the step.
#[test]
fn gas_breaks_a_bond_in_space() {
    let own =
        Jointed { is_plane: false, law: BONDED, far: 0.1, size: 4e-3, hole: 8e-3, joint: 0.08, end: 60e-6, ..PLATE };
    let open = [0.8, 0.4].map(|safety| {
        let scene = Jointed { safety, ..own }.run();
        let open = faces(&scene).filter(|cell| cell.amount.mass > 0.0).count();
        let residual = scene.ledger().residual_max_relative;
        println!("{open} of {} faces, residual {residual:.1e}", faces(&scene).count());
        assert!(open > 5 && open < faces(&scene).count() && residual < 1e-3);
        open
    });
    assert!(open[0].abs_diff(open[1]) <= 2, "{open:?}");
}

/// Gas that comes to a joint only through elements that break wets its faces as those of the hole it came from.
#[test]
fn gas_comes_to_a_joint_through_elements_that_break() {
    let own = Jointed { breaks: true, size: 2e-3, hole: 6e-3, far: 0.12, joint: 0.04, ..PLATE };
    let own = Jointed { begin: own.hole + 4e-3, pressure: 80e6, end: 60e-6, ..own };
    let scene = own.run();
    let gas = scene.gas().unwrap();
    let filled = faces(&scene).filter(|cell| cell.amount.mass > 0.0).count();
    let [from_hole, all] = [Some(0), None].map(|hole| gas.measure(&scene.solid, GasMeasure::WettedArea, hole));
    println!("{filled} of {} faces, {from_hole} and {all} m2", faces(&scene).count());
    assert!(filled > 3 && (from_hole / all - 1.0).abs() < 1e-12);
}

/// Gas that a bond holds back stays where it is.
#[test]
fn a_bond_that_holds_keeps_gas_out() {
    let own = Jointed { law: InterfaceLaw { tensile_strength: 1e9, cohesion: 1e9, ..BONDED }, end: 100e-6, ..PLATE };
    let scene = own.run();
    assert!(faces(&scene).all(|cell| cell.amount.mass == 0.0));
    assert_eq!(scene.gas().unwrap().leaked().mass, 0.0);
}

/// Gas goes from a joint into the elements that break ahead of it and beside it; none of it gets lost, and the balance closes.
#[test]
fn gas_goes_on_from_a_joint_into_elements_that_break() {
    let own =
        Jointed { breaks: true, joint: 0.03, far: 0.12, size: 2e-3, hole: 6e-3, pressure: 60e6, end: 60e-6, ..PLATE };
    let scene = own.run();
    let gas = scene.gas().unwrap();
    let (supplied, ledger) = (own.scene().gas().unwrap().measure(&scene.solid, GasMeasure::Mass, None), scene.ledger());
    let held = gas.measure(&scene.solid, GasMeasure::Mass, None) + gas.leaked().mass;
    let filled = |cell: &fractum_scene::GasCell| cell.pressure > 1e5;
    let beyond = |cell: &fractum_scene::GasCell| {
        let (body, element) = cell.element()?;
        (scene.solid.element_middle(body, element).x > own.joint).then_some(())
    };
    let [broken, ahead, joint] = [
        gas.cells().filter(|cell| cell.element().is_some() && filled(cell)).count(),
        gas.cells().filter(|cell| beyond(cell).is_some() && filled(cell)).count(),
        faces(&scene).filter(filled).count(),
    ];
    println!("{joint} faces, {broken} elements, {ahead} ahead, residual {:.1e}", ledger.residual_max_relative);
    assert!(joint > 5 && broken > 10 && ahead > 0);
    assert!((held / supplied - 1.0).abs() < 1e-12 && ledger.residual_max_relative < 1e-3);
}
