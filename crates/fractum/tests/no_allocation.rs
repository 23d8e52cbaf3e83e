//! Once warm, a step asks for no memory, on any thread.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use fractum_dem::{BeamSection, ClumpShape, Clumps, Particles};
use fractum_fem::{Body, DamageLaw, Elastic, ElementKind, Kinematics, RateCurves, Solid, Viscosity, cracks, motion};
use fractum_math::{Rotation, Vec3};
use fractum_mesh::generate::{Jitter, structured_box};
use fractum_mesh::topology::boundary_of_tetrahedra;
use fractum_scene::coupling::{Debris, Layer};
use fractum_scene::{
    Bonded, BondedPart, BoxMeasure, BoxServo, BoxStrain, ContactMaterial, ContactParameters, Contacts, ElasticMaterial,
    Gravity, Load, Loads, Motion, NodalForce, NodesOnShape, Scene, SceneSettings, SolidSurface, Support, Supports,
    TimeFunction, TimeStepSettings, measure_periodic_box, periodic_cell, with_periodic_box,
};

/// The allocator of the system, counting requests while it is told to.
struct Counting;

static ARMED: AtomicBool = AtomicBool::new(false);
static REQUESTS: AtomicUsize = AtomicUsize::new(0);

fn count() {
    if ARMED.load(Ordering::Relaxed) {
        REQUESTS.fetch_add(1, Ordering::Relaxed);
    }
}

// Only an allocator sees every allocation, and the trait of allocators is unsafe to implement. This one hands every
// request on to the system's, whose contract it thereby keeps.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count();
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        unsafe { System.realloc(pointer, layout, size) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

const SIZE: Vec3 = Vec3::new(0.8, 0.3, 0.3);
const ELASTIC: Elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.2 };
const STRENGTH: f64 = 3e6;

/// Nodes and a body large enough for several blocks and several chunks of nodes.
fn block() -> (Vec<Vec3>, Body) {
    let mesh = structured_box([32, 12, 12], SIZE, Some(Jitter { fraction: 0.1, seed: 1 }));
    (mesh.nodes, Body::new("block", ElementKind::T4, mesh.tetrahedra, ELASTIC))
}

fn armed(body: Body) -> Body {
    body.with_damage(DamageLaw::rankine(STRENGTH, 10e3))
}

fn where_x(nodes: &[Vec3], x: f64) -> Vec<u32> {
    (0..).zip(nodes).filter(|(_, p)| (p.x - x).abs() < 1e-9).map(|(n, _)| n).collect()
}

/// The block, held at one end and pulled at the other at `speed` [m/s], with a pressure and gravity.
fn pulled(nodes: Vec<Vec3>, body: Body, speed: f64, viscosity: Viscosity) -> Scene {
    let mut solid = Solid::new(nodes, vec![body]).unwrap();
    motion::set_viscosity(&mut solid, viscosity);
    pulled_solid(solid, SIZE.x, speed)
}

/// The block with two layers of cells an eighth as thick, which take short steps by themselves.
fn graded(mut nodes: Vec<Vec3>, body: Body) -> Scene {
    let (from, to) = (0.4, 0.45);
    nodes.iter_mut().for_each(|node| node.x -= 0.875 * (node.x - from).clamp(0.0, to - from));
    pulled_solid(Solid::subcycled(nodes, vec![body]).unwrap(), SIZE.x - 0.875 * (to - from), 0.01)
}

fn pulled_solid(solid: Solid, length: f64, speed: f64) -> Scene {
    let (left, right) = (where_x(&solid.reference, 0.0), where_x(&solid.reference, length));
    let supports = vec![
        Support::new("left", left, 0, Motion::Fixed),
        Support::new("right", right.clone(), 0, Motion::Velocity(Arc::new(move |_, _| speed))),
    ];
    let loads = vec![
        Load::Nodal(NodalForce {
            points: right.iter().map(|&n| (n, 1e-3)).collect(),
            axis: 1,
            value: Arc::new(|t, _| 1e3 * t),
        }),
        Load::Gravity(Gravity { axis: 2, value: Arc::new(|_, _| -9.81) }),
    ];
    scene(solid, supports, loads, Vec::new())
}

/// The block, falling on a plane through its lower side.
fn landing(nodes: Vec<Vec3>, body: Body) -> Scene {
    let mut solid = Solid::new(nodes, vec![body]).unwrap();
    solid.velocity.fill(Vec3::new(0.1, 0.0, -0.1));
    scene(
        solid,
        Vec::new(),
        Vec::new(),
        vec![NodesOnShape::plane(
            Vec3::zeros(),
            Vec3::z(),
            ContactParameters { friction: 0.3, ..ContactParameters::default() },
        )],
    )
}

/// Two bars with edges up and down, one across the other, which flies at it.
fn crossed() -> Scene {
    let size = Vec3::new(0.06, 0.01, 0.01);
    let mesh = structured_box([6, 2, 2], size, None);
    let edge_up = Rotation::from_scaled_axis(Vec3::x() * std::f64::consts::FRAC_PI_4);
    let across = Rotation::from_scaled_axis(Vec3::z() * 1.2);
    let bar =
        |turn: Rotation, up: f64| mesh.nodes.iter().map(move |x| turn * (edge_up * (x - size * 0.5)) + Vec3::z() * up);
    let nodes: Vec<Vec3> = bar(Rotation::identity(), 0.0).chain(bar(across, 0.01 * 2f64.sqrt() + 1e-7)).collect();
    let count = mesh.nodes.len() as u32;
    let elements =
        [0, count].map(|first| -> Vec<[u32; 4]> { mesh.tetrahedra.iter().map(|e| e.map(|n| n + first)).collect() });
    let facets =
        elements.clone().map(|e| -> Vec<[u32; 3]> { boundary_of_tetrahedra(&e).iter().map(|f| f.nodes).collect() });
    let mut surface: Vec<u32> = facets.iter().flatten().flatten().copied().collect();
    surface.sort_unstable();
    surface.dedup();
    let bodies = elements.map(|elements| Body::new("bar", ElementKind::T4, elements, ELASTIC));
    let mut solid = Solid::new(nodes, bodies.to_vec()).unwrap();
    solid.velocity[count as usize..].fill(Vec3::z() * -2.0);
    let ground = |(body, facets): (usize, &Vec<[u32; 3]>)| {
        SolidSurface::new(&solid, body, ContactParameters::default(), facets).unwrap()
    };
    let solids = facets.iter().enumerate().map(ground).collect();
    let contacts = Contacts::new(&Bonded::default(), Vec::new(), Vec::new(), solids, Vec::new());
    scene(solid, Vec::new(), Vec::new(), Vec::new()).with_contacts(contacts, &surface)
}

fn scene(solid: Solid, supports: Vec<Support>, loads: Vec<Load>, planes: Vec<NodesOnShape>) -> Scene {
    let supports = Supports::new(supports, &solid.reference).unwrap();
    let loads = Loads::new(loads, solid.mass.len());
    let debris = Debris::new(&solid, vec![ContactParameters::default(); solid.body_count()]);
    let surface: Vec<u32> = (0..).zip(&solid.reference).filter(|(_, p)| p.z < 1e-9).map(|(n, _)| n).collect();
    let settings = SceneSettings {
        time_step: TimeStepSettings { safety: 0.8, element_bound: false, fixed: None, begin: 0.0, end: 1.0 },
        damping: Default::default(),
        stiffness_time: 0.0,
        balance_stop: 1e-2,
        joined_below: 0.95,
    };
    Scene::new(solid, supports, loads, debris, planes, &surface, settings)
}

/// A lattice of its own; φ of the scheme of Tchamwa and Wielgosz.
fn bonded_bar(phi: f64) -> Scene {
    let mut bonded = lattice();
    bonded.set_dissipation(phi);
    scene(Solid::new(Vec::new(), Vec::new()).unwrap(), Vec::new(), Vec::new(), Vec::new()).with_bonded(bonded)
}

/// The lattice under a block of tetrahedra, to which its upper particles are tied.
fn tied_bar() -> Scene {
    let mesh = structured_box([20, 8, 4], Vec3::new(29.0, 9.0, 5.0), None);
    let nodes: Vec<Vec3> = mesh.nodes.iter().map(|x| x + Vec3::z() * 9.5).collect();
    let elastic = Elastic { density: 1.0, young_modulus: 1e3, poisson_ratio: 0.2 };
    let facets: Vec<[u32; 3]> = boundary_of_tetrahedra(&mesh.tetrahedra).iter().map(|f| f.nodes).collect();
    let solid = Solid::new(nodes, vec![Body::new("block", ElementKind::T4, mesh.tetrahedra, elastic)]).unwrap();
    let bonded = lattice();
    let free: Vec<u32> = (0..3000).filter(|i| (1..29).contains(&(i % 30))).collect();
    let layer = Layer::find(&solid, &facets, &bonded.particles, &free, 0.2).unwrap();
    scene(solid, Vec::new(), Vec::new(), Vec::new()).with_bonded(bonded).with_ties(&layer.attachments)
}

/// A jittered lattice of bonded particles, held at one end and pulled at the other, under gravity.
fn lattice() -> Bonded {
    const SIDES: [usize; 3] = [30, 10, 10];
    let site =
        |i: usize| Vec3::new((i % SIDES[0]) as f64, (i / SIDES[0] % SIDES[1]) as f64, (i / SIDES[0] / SIDES[1]) as f64);
    let count = SIDES.iter().product::<usize>();
    let position: Vec<Vec3> = (0..count).map(|i| site(i) + Vec3::repeat(0.1 * (i as f64 * 1.7).sin())).collect();
    let near = |i: usize, j: usize| (site(i) - site(j)).norm_squared() == 1.0;
    let steps = [1, SIDES[0], SIDES[0] * SIDES[1]];
    let ahead = |i: usize| steps.map(|step| i + step).into_iter().filter(move |&j| j < count && near(i, j));
    let pairs = (0..count).flat_map(|i| ahead(i).map(move |j| [i as u32, j as u32])).collect();
    let particles = Particles::at_rest(position.clone(), vec![0.5; count], count as f64).unwrap();
    let section = BeamSection::new(1e3, 0.3).unwrap();
    let (law, shares) = (section.into(), Vec::new());
    let part = BondedPart {
        name: "bar".into(),
        particles,
        pairs,
        law,
        shares,
        density: 1.0,
        fraction: 1.0,
        fracture: None,
        clumps: Clumps::default(),
    };
    let mut bonded = Bonded::new(vec![part]).unwrap();
    let end = |x: f64| (0..count as u32).filter(|&i| site(i as usize).x == x).collect::<Vec<u32>>();
    let pull = Motion::Velocity(Arc::new(|_, _| 1e-3));
    let supports = vec![Support::new("low", end(0.0), 0, Motion::Fixed), Support::new("high", end(29.0), 0, pull)];
    bonded.set_supports(supports, &[(0, 0b111)]).unwrap();
    let force = Load::Nodal(NodalForce { points: vec![(150, 1.0)], axis: 1, value: Arc::new(|t, _| t) });
    bonded.set_loads(vec![force, Load::Gravity(Gravity { axis: 2, value: Arc::new(|_, _| -1e-3) })]);
    bonded
}

/// Dumbbells that lie side by side under gravity, pressed a little.
fn clumps() -> Scene {
    let shape = ClumpShape::new(&[(Vec3::zeros(), 0.5), (Vec3::x() * 0.8, 0.5)]).unwrap();
    let place = |i: usize| {
        let at = Vec3::new((i % 20) as f64 * 1.85, (i / 20 % 10) as f64 * 0.999, (i / 200) as f64 * 0.999);
        (at, shape.radius(), Rotation::identity())
    };
    let places: Vec<_> = (0..1000).map(place).collect();
    let (particles, clumps) = Clumps::at_rest(&shape, &places, 1.0).unwrap();
    let law = BeamSection::new(1e3, 0.3).unwrap().into();
    let (pairs, shares, name) = (Vec::new(), Vec::new(), "grains".into());
    let part = BondedPart { name, particles, pairs, law, shares, density: 1.0, fraction: 1.0, fracture: None, clumps };
    let mut bonded = Bonded::new(vec![part]).unwrap();
    bonded.set_loads(vec![Load::Gravity(Gravity { axis: 2, value: Arc::new(|_, _| -1e-3) })]);
    let contacts = Contacts::new(&bonded, vec![soft()], Vec::new(), Vec::new(), Vec::new());
    scene(Solid::new(Vec::new(), Vec::new()).unwrap(), Vec::new(), Vec::new(), Vec::new())
        .with_bonded(bonded)
        .with_contacts(contacts, &[])
}

/// A cubic lattice of bonded particles through all sides of a box that is pulled, sheared and held.
fn repeating() -> Scene {
    const SIDE: usize = 12;
    let at = |i: usize| [i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE];
    let count = SIDE.pow(3);
    let next = |i: usize, axis: usize| {
        let mut other = at(i);
        other[axis] = (other[axis] + 1) % SIDE;
        [i as u32, (other[0] + SIDE * (other[1] + SIDE * other[2])) as u32]
    };
    let pairs = (0..count).flat_map(|i| [0, 1, 2].map(|axis| next(i, axis))).collect();
    let position = (0..count).map(|i| Vec3::from(at(i).map(|k| k as f64))).collect();
    let part = BondedPart {
        name: "lattice".into(),
        particles: Particles::at_rest(position, vec![0.5; count], count as f64).unwrap(),
        pairs,
        law: BeamSection::new(1e3, 0.3).unwrap().into(),
        shares: Vec::new(),
        density: 1.0,
        fraction: 0.5,
        fracture: None,
        clumps: Clumps::default(),
    };
    let cell = periodic_cell(Vec3::zeros(), &Vec3::repeat(SIDE as f64), [true; 3]);
    let bonded = Bonded::within(vec![part], Some(&cell)).unwrap();
    let contacts = Contacts::new(&bonded, vec![soft()], Vec::new(), Vec::new(), Vec::new()).within(cell);
    let servo = BoxServo { axis: 1, stress: Arc::new(|_, _| -1.0), rate: 1e-3, slows_at: 0.1 };
    let rates = [[0, 0], [0, 2]].map(|at| {
        let rate: TimeFunction = Arc::new(|_, _| 1e-4);
        (at, rate)
    });
    let scene = scene(Solid::new(Vec::new(), Vec::new()).unwrap(), Vec::new(), Vec::new(), Vec::new());
    let scene = scene.with_bonded(bonded).with_contacts(contacts, &[]);
    with_periodic_box(scene, cell, BoxStrain { rates: rates.to_vec(), servos: vec![servo] })
}

fn soft() -> ContactMaterial {
    ContactMaterial {
        elastic: ElasticMaterial { young_modulus: 1e3, poisson_ratio: 0.2 },
        density: 1.0,
        surface: ContactParameters::default(),
        work_of_adhesion: 0.0,
    }
}

/// Requests for memory in 100 steps, after 50 that warm up; the queues of the threads grow in these.
fn requests(scene: &mut Scene) -> usize {
    let mut advance = |steps: usize| (0..steps).all(|_| scene.step(false).unwrap().removed == 0);
    assert!(advance(50));
    REQUESTS.store(0, Ordering::Relaxed);
    ARMED.store(true, Ordering::Relaxed);
    let intact = advance(100);
    ARMED.store(false, Ordering::Relaxed);
    assert!(intact, "removal of elements may ask for memory: the scene must do without");
    REQUESTS.load(Ordering::Relaxed)
}

// One test for all: the count is that of the whole process.
#[test]
fn a_warm_step_allocates_nothing() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    pool.install(|| {
        let mut scene = clumps();
        assert_eq!(requests(&mut scene), 0, "clumps in contact");
        assert!(scene.counts().contacts > 100, "{}", scene.counts().contacts);

        let (nodes, plain) = block();
        let corotational = Body { kinematics: Kinematics::Corotational, ..plain.clone() };
        let smoothed = plain.clone().smoothed();
        let viscosity = Viscosity { stiffness_time: 1e-9, bulk_linear: 0.06, bulk_quadratic: 1.2 };
        let calm = Viscosity::default();

        let mut scene = pulled(nodes.clone(), plain.clone(), 0.01, calm);
        assert_eq!(requests(&mut scene), 0, "plain elastic");

        let until_it_turns = Body { kinematics: Kinematics::Auto, ..smoothed.clone() };
        let mut scene = pulled(nodes.clone(), until_it_turns, 0.01, calm);
        assert_eq!(requests(&mut scene), 0, "small strains until it turns");
        assert_eq!(scene.solid.body(0).kinematics, Kinematics::Auto);

        let mut scene = pulled(nodes.clone(), corotational.smoothed(), 0.01, viscosity);
        assert_eq!(requests(&mut scene), 0, "smoothed, large rotations, viscous");

        let mut scene = pulled(nodes.clone(), armed(smoothed.clone()), 0.01, calm);
        assert_eq!(requests(&mut scene), 0, "smoothed with armed damage");
        assert_eq!(cracks::fracture(&scene.solid).damaged_edges, 0);

        // ρ c v = 4.7 MPa: the end that is pulled is damaged; it is too tough to be cut through in these steps.
        let mut scene = pulled(nodes.clone(), armed(smoothed.clone()), 0.5, calm);
        assert_eq!(requests(&mut scene), 0, "smoothed with growing damage");
        assert!(cracks::fracture(&scene.solid).damaged_edges > 0);

        let mut scene = pulled(nodes.clone(), armed(plain.clone()), 0.5, calm);
        assert_eq!(requests(&mut scene), 0, "standard with growing damage");
        assert!(cracks::fracture(&scene.solid).damaged_edges > 0);

        for body in [&smoothed, &plain] {
            let mut body = armed(body.clone());
            let curves = RateCurves { strength: vec![[1e-3, 1.0], [1e3, 1.3]], compression: None, energy: Vec::new() };
            body.damage.as_mut().unwrap().rate = Some(Arc::new(curves));
            let mut scene = pulled(nodes.clone(), body, 0.5, calm);
            assert_eq!(requests(&mut scene), 0, "strength by rate");
            assert!(
                fractum_fem::rate_report(&scene.solid, 0)
                    .is_some_and(|report| report.count > 0 && report.rates[2] > 1.0)
            );
        }

        let mut scene = graded(nodes.clone(), armed(smoothed.clone()));
        assert_eq!(requests(&mut scene), 0, "steps of two sizes");
        assert!(scene.subcycling().is_some_and(|(parts, ..)| parts > 3));

        let mut scene = bonded_bar(1.0);
        assert_eq!(requests(&mut scene), 0, "bonded particles");
        assert!(scene.counts().bonds > 7000);

        let mut scene = repeating();
        assert_eq!(requests(&mut scene), 0, "bonded through the sides of a periodic box");
        assert!(measure_periodic_box(&scene, BoxMeasure::Volume) > 1.0);

        let mut scene = bonded_bar(1.2);
        assert_eq!(requests(&mut scene), 0, "bonded particles, high frequencies damped");

        let mut scene = tied_bar();
        assert_eq!(requests(&mut scene), 0, "tied");
        assert!(scene.ties.counts().0 > 200);

        let mut scene = crossed();
        assert_eq!(requests(&mut scene), 0, "edge on edge");
        assert!(scene.counts().contacts > 0);

        let mut scene = landing(nodes, armed(smoothed));
        assert_eq!(requests(&mut scene), 0, "on a rigid plane");
        assert!(scene.counts().contacts > 0);
    });
    // A count that cannot count proves nothing.
    ARMED.store(true, Ordering::Relaxed);
    drop(std::hint::black_box(vec![1u8; 100]));
    ARMED.store(false, Ordering::Relaxed);
    assert!(REQUESTS.load(Ordering::Relaxed) > 0);
}
