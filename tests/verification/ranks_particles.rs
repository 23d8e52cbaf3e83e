//! Several ranks share bonded bodies and loose particles: the state has the bits of a single process, whatever their number.

use std::sync::Arc;

use fractum_dem::criterion::{BeamRankine, FractureCriterion, Hydrostatic, Level, Principal};
use fractum_dem::{AnyBondLaw, BeamSection, CrackFaces, LocalBond, Particles};
use fractum_fem::{LocalDamping, Solid};
use fractum_math::Vec3;
use fractum_scene::coupling::Debris;
use fractum_scene::{
    Along, BondFracture, Bonded, BondedPart, ContactBody, ContactMaterial, ContactPairs, ContactParameters,
    ContactProbe, Contacts, Domain, ElasticMaterial, FlatFaces, Form, Frame, Gravity, Load, Loads, Motion, NodalForce,
    PairContact, RigidBody, Scene, SceneSettings, Shape, Support, Supports,
};
use fractum_tests::{noise, settings};

use crate::meeting::{Target, crash};
use crate::ranks::{RANKS, advance, bits, same_on_ranks, shared};

const RADIUS: f64 = 0.01;
const SURFACE: ContactParameters = ContactParameters { friction: 0.3, damping_ratio: 0.1, rolling_friction: 0.0 };
const ELASTIC: ElasticMaterial = ElasticMaterial { young_modulus: 1e9, poisson_ratio: 0.2 };
const BEAM: BeamSection = BeamSection { radius: 0.6 * RADIUS, young_modulus: 1e9, poisson_ratio: 0.2 };

/// Particles on a grid in slices along x, as a packing has them: several blocks of them, with some disorder in places and velocities.
fn grid([x, y, z]: [usize; 3], from: Vec3, speed: f64) -> Particles {
    let cell = |i: usize| Vec3::new((i / (y * z)) as f64, (i / z % y) as f64, (i % z) as f64);
    let disorder = |i: usize| Vec3::from_fn(|axis, _| noise(3 * i + axis));
    let position = (0..x * y * z).map(|i| from + cell(i) * (2.0 * RADIUS) + disorder(i) * (0.2 * RADIUS));
    let mut grid = Particles::at_rest(position.collect(), vec![RADIUS; x * y * z], 0.01 * (x * y * z) as f64).unwrap();
    for i in 0..grid.len() {
        grid.velocity[i] = disorder(i + 7) * speed;
        grid.spin[i] = disorder(i + 11) * (speed / RADIUS);
    }
    grid
}

/// Bonds between all neighbours on a grid.
fn neighbours(particles: &Particles, [_, y, z]: [usize; 3]) -> Vec<[u32; 2]> {
    let near = |&[i, j]: &[usize; 2]| {
        j < particles.len() && (particles.position[i] - particles.position[j]).norm() < 3.2 * RADIUS
    };
    let beside = [1, z - 1, z, z + 1, y * z - z, y * z - 1, y * z, y * z + 1, y * z + z];
    let pairs = (0..particles.len()).flat_map(|i| beside.map(|way| [i, i + way]));
    pairs.filter(near).map(|pair| pair.map(|i| i as u32)).collect()
}

fn body(name: &str, cells: [usize; 3], from: Vec3, speed: f64, law: impl Into<AnyBondLaw>) -> BondedPart {
    let particles = grid(cells, from, speed);
    BondedPart {
        name: name.into(),
        pairs: neighbours(&particles, cells),
        particles,
        law: law.into(),
        shares: Vec::new(),
        density: 2400.0,
        fraction: 0.6,
        fracture: None,
        clumps: fractum_dem::Clumps::default(),
    }
}

fn breaking(criterion: Option<FractureCriterion>, volume: f64) -> Option<BondFracture> {
    Some(BondFracture {
        criterion,
        faces: CrackFaces { friction: 0.3, damping_ratio: 0.0 },
        volume,
        strength_factors: Vec::new(),
        to_wall: Vec::new(),
    })
}

/// A scene of particles alone, the loose ones of which stick with a work of adhesion [J/m²].
fn scene(bonded: Bonded, rigid_bodies: Vec<RigidBody>, settings: SceneSettings, adhesion: f64) -> Scene {
    let solid = Solid::new(Vec::new(), Vec::new()).unwrap();
    let debris = Debris::new(&solid, Vec::new());
    let material = |body: &fractum_scene::BondedBody| {
        let work_of_adhesion = if body.bonds.is_empty() { adhesion } else { 0.0 };
        ContactMaterial { elastic: ELASTIC, density: 2400.0, surface: SURFACE, work_of_adhesion }
    };
    let materials = bonded.bodies().iter().map(material).collect();
    let mut contacts = Contacts::new(&bonded, materials, rigid_bodies, Vec::new(), Vec::new());
    let flat = |body: &fractum_scene::BondedBody| {
        let shift = body.range.clone().map(|_| Vec3::z() * (-0.02 * RADIUS)).collect();
        (!body.bonds.is_empty()).then_some(FlatFaces { young_modulus: 1e9, poisson_ratio: 0.2, shift, out: Vec::new() })
    };
    contacts.flatten(bonded.bodies().iter().map(flat).collect(), &bonded.particles);
    let (loads, supports) = (Loads::new(Vec::new(), 0), Supports::new(Vec::new(), &[]).unwrap());
    Scene::new(solid, supports, loads, debris, Vec::new(), &[], settings)
        .with_bonded(bonded)
        .with_contacts(contacts, &[])
}

const BAR: [usize; 3] = [34, 14, 14];

/// A bar that is pulled apart by one end, under gravity, a force and all kinds of damping.
fn pulled(law: impl Into<AnyBondLaw>, fracture: Option<BondFracture>, speed: f64) -> Scene {
    let bar = BondedPart { fracture, ..body("bar", BAR, Vec3::zeros(), 0.1, law) };
    let count = bar.particles.len() as u32;
    let slice = (BAR[1] * BAR[2]) as u32;
    let mut bonded = Bonded::new(vec![bar]).unwrap();
    let moves = Motion::Velocity(Arc::new(move |_, _: &Vec3| speed));
    let left = (0..slice).collect();
    let right = (count - slice..count).collect();
    let sets = vec![Support::new("left", left, 0, Motion::Fixed), Support::new("right", right, 0, moves)];
    bonded.set_supports(sets, &[(5, 0b111)]).unwrap();
    let gravity = Load::Gravity(Gravity { axis: 2, value: Arc::new(|_, _| -9.81) });
    let force = NodalForce { points: vec![(40, 0.5), (3000, 0.5)], axis: 1, value: Arc::new(|_, _| 10.0) };
    bonded.set_loads(vec![gravity, Load::Nodal(force)]);
    bonded.set_dissipation(1.1);
    let mut settings = settings(1.0, 1e9);
    settings.damping = LocalDamping { local: 0.05, mass_rate: 1.0 };
    scene(bonded, Vec::new(), settings, 0.0)
}

const VOLUME: f64 = 34.0 * 14.0 * 14.0 * 8.0 * RADIUS * RADIUS * RADIUS;

#[test]
fn bonds_that_break_by_any_criterion_have_the_same_bits_on_any_number_of_ranks() {
    let principal = |level| {
        FractureCriterion::Principal(Principal { tensile_strength: 3e6, compressive_strength: Some(3e7), level })
    };
    let criteria = [
        FractureCriterion::BeamRankine(BeamRankine { strength: 2e7, moments: Default::default() }),
        FractureCriterion::Hydrostatic(Hydrostatic { strength: 1.5e6 }),
        principal(Level::Own),
        principal(Level::Neighbours),
        principal(Level::Second),
    ];
    let breaks = |criterion, to_wall: Vec<Vec3>| {
        let fracture = || breaking(Some(criterion), VOLUME).map(|own| BondFracture { to_wall: to_wall.clone(), ..own });
        let single = same_on_ranks(120, || pulled(BEAM, fracture(), 20.0));
        let broken = single.counts().broken_bonds;
        assert!(broken > 20 && broken < 9000, "{criterion:?}: {broken}");
        broken
    };
    let inside = criteria.map(|criterion| breaks(criterion, Vec::new()));
    // Judged at the lower sides.
    let [_, y, z] = BAR;
    let lower = |k: usize| if k == 0 { -RADIUS } else { 0.0 };
    let to_wall: Vec<Vec3> =
        (0..BAR.iter().product()).map(|i| Vec3::new(0.0, lower(i / z % y), lower(i % z))).collect();
    assert_ne!(breaks(principal(Level::Neighbours), to_wall), inside[3]);
}

#[test]
fn bonds_that_separate_by_their_law_have_the_same_bits_on_any_number_of_ranks() {
    let law = LocalBond { tensile_strength: 2e6, shear_strength: 2e6, ..LocalBond::elastic(1e9, 0.2) };
    let single = same_on_ranks(150, || pulled(law, breaking(None, VOLUME), 10.0));
    let broken = single.counts().broken_bonds;
    assert!(broken > 20 && broken < 9000, "{broken}");
}

/// A bonded block, and a cloud of loose beads in two layers that fall on it and on a rigid plane; what flies off leaves.
///
/// - `adhesion`: work of adhesion of the beads and of the plane [J/m²]
fn beads(adhesion: f64) -> Scene {
    let cells = [20, 12, 12];
    let block = BondedPart {
        fracture: breaking(
            Some(FractureCriterion::BeamRankine(BeamRankine { strength: 2e7, moments: Default::default() })),
            8.0 * (20.0 * 12.0 * 12.0) * RADIUS.powi(3),
        ),
        ..body("block", cells, Vec3::z() * (0.95 * RADIUS), 0.1, BEAM)
    };
    let mut cloud = body("beads", [40, 16, 4], Vec3::new(-0.1, -0.04, 0.255), 4.0, BEAM);
    cloud.particles.velocity.iter_mut().for_each(|velocity| velocity.z -= 3.0);
    let cloud = BondedPart { pairs: Vec::new(), ..cloud };
    let mut bonded = Bonded::new(vec![block, cloud]).unwrap();
    bonded.set_loads(vec![Load::Gravity(Gravity { axis: 2, value: Arc::new(|_, _| -9.81) })]);
    let form = Form::Shape { shape: Shape::HalfSpace, hollow: false };
    let mut plane = RigidBody::new("plane", form, Frame::at_rest(), ElasticMaterial::RIGID, SURFACE);
    plane.work_of_adhesion = adhesion;
    let domain = Domain { min: Vec3::new(-0.0895, -1.0, -1.0), max: Vec3::repeat(1.0) };
    scene(bonded, vec![plane], settings(1.0, 1e9), adhesion).with_domain(domain)
}

#[test]
fn loose_beads_on_a_bonded_block_on_a_plane_have_the_same_bits_on_any_number_of_ranks() {
    let contacts = [0.0, 50.0].map(|adhesion| {
        let single = same_on_ranks(500, || beads(adhesion));
        let counts = single.counts();
        assert!(counts.contacts > 200 && single.left().pieces > 0, "{counts:?} {:?}", single.left());
        counts.contacts
    });
    assert!(contacts[1] > contacts[0], "beads that stick: {contacts:?}");
}

#[test]
fn bodies_with_coefficients_of_their_own_have_the_same_bits_on_any_number_of_ranks() {
    let mut pairs = ContactPairs::default();
    let surface = ContactParameters { friction: 0.05, damping_ratio: 0.3, rolling_friction: 0.1 };
    let [block, cloud, plane] = [ContactBody::Particles(0), ContactBody::Particles(1), ContactBody::Rigid(0)];
    pairs.set([plane, cloud], PairContact { surface, work_of_adhesion: Some(50.0) });
    pairs.set([cloud, block], PairContact { surface, work_of_adhesion: None });
    let made = || {
        let mut scene = beads(0.0);
        scene.contacts = std::mem::take(&mut scene.contacts).with_pairs(&pairs);
        scene
    };
    let (paired, mut alone) = (same_on_ranks(300, made), beads(0.0));
    advance(&mut alone, 300);
    assert!(paired.counts().contacts > 100 && bits(&paired) != bits(&alone), "{:?}", paired.counts());
}

/// A block that breaks on another one, with beads around whose forces on both are asked for: they meet facets, discrete elements and each other.
#[test]
fn beads_around_a_solid_that_breaks_have_the_same_bits_on_any_number_of_ranks() {
    let probes = [ContactBody::Solid(0), ContactBody::Particles(0)].map(|on| ContactProbe {
        on,
        from: ContactBody::Particles(0),
        along: Along::Direction(Vec3::x()),
    });
    let made = || {
        let mut scene = crash(Target::Solid, (2400, 1500.0));
        probes.iter().for_each(|probe| scene.contacts.watch(*probe));
        scene
    };
    let single = same_on_ranks(1300, made);
    let counts = single.counts();
    assert!(counts.particles > 2400 && counts.contacts > 10, "{counts:?}");
    let state: serde_json::Value = serde_json::from_str(&bits(&single)).unwrap();
    let on_debris = state["contacts"]["nodes"]["debris"].as_array().map_or(0, Vec::len);
    assert!(on_debris > 0, "no bead touches a discrete element");
    let forces = |scene: &Scene| probes.map(|probe| scene.contacts.force_between(&probe));
    assert!(shared(3, 1300, made).iter().all(|scene| forces(scene) == forces(&single)), "{:?}", forces(&single));
}

#[test]
fn each_rank_moves_a_share_of_the_particles() {
    let criterion = FractureCriterion::BeamRankine(BeamRankine { strength: 2e7, moments: Default::default() });
    for scene in shared(3, 120, || pulled(BEAM, breaking(Some(criterion), VOLUME), 20.0)) {
        assert!(scene.counts().broken_bonds > 20);
        let share = scene.bonded.share().unwrap();
        assert!((2048..=2700).contains(&share.particles), "{share:?}");
        assert!(share.ghosts < 700 && share.everywhere == 2 * 196 + 1, "{share:?}");
    }
}

#[test]
fn particles_go_on_from_a_state_with_any_number_of_ranks() {
    let made = || {
        let criterion = FractureCriterion::BeamRankine(BeamRankine { strength: 2e7, moments: Default::default() });
        pulled(BEAM, breaking(Some(criterion), VOLUME), 20.0)
    };
    let expected = bits(&shared(1, 120, made)[0]);
    for first in [50, 101] {
        let state = shared(3, first, made).remove(1).state();
        let resumed = || {
            let mut scene = made();
            scene.restore(state.clone());
            scene
        };
        for ranks in RANKS {
            assert!(bits(&shared(ranks, 120 - first, resumed)[0]) == expected, "{first} steps, then {ranks} ranks");
        }
    }
}
