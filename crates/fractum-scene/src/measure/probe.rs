use std::cell::OnceCell;

use fractum_dem::crack_shape::Axis;
use fractum_fem::{CrackEdge, Fracture, Separation, Wave};
use fractum_math::{Sym3, Vec3};

use crate::conditions::{Along, PointProbe, Points, Population};
use crate::contacts::ContactProbe;
use crate::fragment::Fragment;
use crate::gas::GasMeasure;
use crate::heat::{HeatMeasure, TemperatureTake};
use crate::ledger::EnergyProbe;
use crate::measure::crack_extent::measure_extent;
use crate::measure::crack_measure::{CrackMeasure, InsideCracks, measure_crack};
use crate::measure::damaged::DamagedPart;
use crate::measure::gauges::Extensometer;
use crate::measure::piece_probe::{FragmentMeasure, SurfaceMeasure, measure_fragment, measure_surface, passing_size};
use crate::measure::radial_cracks::RadialCracks;
use crate::measure::region_probe::{RegionStrain, RegionStress};
use crate::scene::{CountKind, Counts, Scene};

/// A number that a scene yields at every instant.
#[derive(Clone, Debug, PartialEq)]
pub enum Probe {
    /// Something about a set of nodes or particles.
    Points {
        /// Whose points.
        population: Population,
        /// What is measured on them.
        probe: PointProbe,
    },
    /// An entry of the energy ledger, or its residual [J].
    Energy(EnergyProbe),
    /// A count.
    Count(CountKind),
    /// Volume mean of a stress component over elements [Pa].
    Stress {
        /// Bodies and their elements.
        elements: Vec<(usize, u32)>,
        /// The stress on a plane with the first normal along the second, at the middle of the element without load.
        between: [Along; 2],
    },
    /// Virial stress of particles [Pa], at the places that the step ends with: a step after strains of the same row.
    ParticleStress(RegionStress),
    /// Mean strain of nodes or particles.
    Strain(RegionStrain),
    /// Elongation between two places over their distance [-].
    Extensometer(Extensometer),
    /// Linear momentum along a direction [kg m/s].
    Momentum(Vec3),
    /// Angular momentum about the origin along a direction [kg m²/s].
    AngularMomentum(Vec3),
    /// Force of a rigid body on what it touches along a direction [N].
    RigidBodyForce {
        /// Rigid body.
        rigid_body: usize,
        /// Unit direction.
        direction: Vec3,
    },
    /// Force of contact of one body on another [N]; the scene must [watch](crate::Contacts::watch) it.
    ContactForce(ContactProbe),
    /// Way of the reference point of a rigid body along a direction, at the instant of the last step [m].
    RigidBodyDisplacement {
        /// Rigid body.
        rigid_body: usize,
        /// Unit direction.
        direction: Vec3,
    },
    /// Velocity of the reference point of a rigid body along a direction [m/s].
    RigidBodyVelocity {
        /// Rigid body.
        rigid_body: usize,
        /// Unit direction.
        direction: Vec3,
    },
    /// Something about the gas; not a number where there is none.
    Gas {
        /// What about it.
        measure: GasMeasure,
        /// Of this hole; of everything if absent.
        hole: Option<usize>,
    },
    /// Temperature of points [K]; not a number without heat.
    Temperature {
        /// Whose points.
        population: Population,
        /// The points.
        points: Vec<u32>,
        /// Which temperature of them.
        take: TemperatureTake,
    },
    /// Something about the heat of everything [J]; not a number without heat.
    Heat(HeatMeasure),
    /// Sum of the loads on nodes of solids along a component [N].
    Load {
        /// The nodes, ascending.
        points: Vec<u32>,
        /// Which component; directions about an axis are those of the places without load.
        along: Along,
    },
    /// Something about facets as they are at present.
    Surface {
        /// Outward facets; an edge in the plane repeats its second node.
        facets: Vec<[u32; 3]>,
        /// What about them.
        measure: SurfaceMeasure,
    },
    /// Something about the fragment that holds a node.
    Fragment {
        /// The nodes, of which the first counts.
        points: Vec<u32>,
        /// What about it.
        measure: FragmentMeasure,
        /// Direction of a velocity.
        along: Vec3,
    },
    /// Size below which a share of the mass of all fragments lies [m].
    FragmentSize(f64),
    /// Area of crack, Σ V d/l over the damaged edges [m²].
    CrackArea,
    /// How the crack lies: the edges that have lost at least half of their strength, and the broken bonds; not a number
    /// where there are none. Or how much has separated: removed elements, and broken bonds.
    Crack {
        /// What about it.
        measure: CrackMeasure,
        /// Direction, and the point of it that a helix or cone needs.
        axis: Axis,
        /// Which edges, elements and bonds count; all if absent.
        inside: Option<InsideCracks>,
    },
    /// Cracks that run away from a hole.
    RadialCracks(RadialCracks),
    /// What is damaged.
    Damaged(DamagedPart),
    /// Speed of a wave in a solid body, which does not change [m/s].
    WaveSpeed {
        /// Body.
        body: usize,
        /// Which wave.
        wave: Wave,
    },
}

/// What of a scene a probe looks at, for ranks that advance it together.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ProbeNeeds {
    /// Nodes whose motion it looks at.
    pub nodes: NeededPoints,
    /// Particles whose motion it looks at.
    pub particles: NeededPoints,
    /// Whether it looks at what supports do at these points, which is known where they are moved alone.
    pub of_supports: bool,
    /// Whether it looks at the damage of edges.
    pub damage: bool,
    /// Whether it looks at contacts among particles.
    pub contacts: bool,
    /// Bonds (body, bond) whose memory it looks at.
    pub bonds: Vec<(u32, u32)>,
}

/// Points that a probe looks at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NeededPoints {
    /// These.
    Some(Vec<u32>),
    /// Any of them.
    Any,
}

impl Default for NeededPoints {
    fn default() -> Self {
        NeededPoints::Some(Vec::new())
    }
}

/// A scene at one instant, with what several probes need of it.
pub struct ProbedScene<'a> {
    scene: &'a Scene,
    fragments: OnceCell<Vec<Fragment>>,
    separation: OnceCell<Separation>,
    crack_edges: OnceCell<Vec<CrackEdge>>,
    counts: Counts,
    fracture: OnceCell<Fracture>,
    /// Stress of all elements, body by body.
    stresses: Vec<OnceCell<Vec<Sym3>>>,
}

/// Part of the elements of a body from which a probe looks at all of them: a smoothed edge has several elements, and further
/// probes find them done.
const MANY: usize = 8;

impl<'a> ProbedScene<'a> {
    /// Before the first probe.
    pub fn new(scene: &'a Scene) -> Self {
        Self::with_counts(scene, scene.counts())
    }

    /// The same where [`Scene::counts`] are known.
    pub fn with_counts(scene: &'a Scene, counts: Counts) -> Self {
        ProbedScene {
            scene,
            fragments: OnceCell::new(),
            separation: OnceCell::new(),
            crack_edges: OnceCell::new(),
            counts,
            fracture: OnceCell::new(),
            stresses: vec![OnceCell::new(); scene.solid.body_count()],
        }
    }

    /// [`Scene::fragments`], found once.
    pub(crate) fn fragments(&self) -> &[Fragment] {
        self.fragments.get_or_init(|| self.scene.fragments())
    }

    /// [`fractum_fem::Solid::fracture`], found once.
    fn fracture(&self) -> &Fracture {
        self.fracture.get_or_init(|| self.scene.solid.fracture())
    }

    /// Stress of an element [Pa]; of all elements of its body at once where a probe has many of them.
    fn stress(&self, body: usize, element: u32, has_many: bool) -> Sym3 {
        let solid = &self.scene.solid;
        if !has_many {
            return solid.element_field(body, element).0;
        }
        let all = || solid.element_fields(body).into_iter().map(|(stress, _)| stress).collect();
        self.stresses[body].get_or_init(all)[element as usize]
    }

    /// [`fractum_fem::Solid::crack_edges`], found once.
    fn crack_edges(&self) -> &[CrackEdge] {
        self.crack_edges.get_or_init(|| self.scene.solid.crack_edges())
    }

    /// What has separated, found once.
    fn separation(&self) -> &Separation {
        self.separation.get_or_init(|| self.scene.solid.separation())
    }
}

impl Probe {
    /// Whether the value follows from which elements and bonds are gone, and from nothing else that changes.
    pub fn is_of_separation(&self) -> bool {
        match self {
            Probe::Crack { measure, .. } => measure.is_of_separation(),
            Probe::RadialCracks(_) => true,
            _ => false,
        }
    }

    /// What the value is found from.
    pub fn needs(&self, scene: &Scene) -> ProbeNeeds {
        use NeededPoints::{Any, Some};
        let nothing = ProbeNeeds::default;
        let all = |damage: bool| ProbeNeeds { nodes: Any, particles: Any, damage, ..nothing() };
        match self {
            Probe::Points { population, probe } => {
                let of_supports = probe.is_of_supports();
                match population {
                    Population::Nodes => {
                        ProbeNeeds { nodes: Some(probe.points(scene.supports())), of_supports, ..nothing() }
                    }
                    Population::Particles => {
                        let particles = Some(probe.points(scene.bonded.supports()));
                        ProbeNeeds { particles, of_supports, ..nothing() }
                    }
                }
            }
            Probe::Surface { facets, .. } => ProbeNeeds { nodes: Some(facets.concat()), ..nothing() },
            Probe::Stress { .. } => ProbeNeeds { nodes: Any, damage: true, ..nothing() },
            Probe::Gas { .. } => ProbeNeeds { nodes: Any, ..nothing() },
            Probe::ParticleStress(probe) => {
                let (bonds, particles) = probe.looks_at(&scene.bonded);
                ProbeNeeds { particles: Some(particles), bonds, ..nothing() }
            }
            Probe::Fragment { .. } | Probe::FragmentSize(_) | Probe::Count(CountKind::Fragments) => all(true),
            Probe::Strain(_) | Probe::Extensometer(_) | Probe::Momentum(_) | Probe::AngularMomentum(_) => all(false),
            Probe::Count(CountKind::BrokenEdges | CountKind::DamagedEdges) | Probe::CrackArea | Probe::Damaged(_) => {
                ProbeNeeds { damage: true, ..nothing() }
            }
            Probe::Crack { measure, .. } => ProbeNeeds { damage: !measure.is_of_separation(), ..nothing() },
            Probe::Count(CountKind::Contacts) => ProbeNeeds { contacts: true, ..nothing() },
            Probe::Energy(_)
            | Probe::Count(_)
            | Probe::ContactForce(_)
            | Probe::RigidBodyForce { .. }
            | Probe::RigidBodyDisplacement { .. }
            | Probe::RigidBodyVelocity { .. }
            | Probe::Temperature { .. }
            | Probe::Heat(_)
            | Probe::Load { .. }
            | Probe::RadialCracks(_)
            | Probe::WaveSpeed { .. } => nothing(),
        }
    }

    /// Whether the value needs the energies of the instant.
    pub fn needs_energy(&self) -> bool {
        matches!(self, Probe::Energy(_))
    }

    /// Value at the last step that was measured.
    pub fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        let scene = probed.scene;
        let solid = &scene.solid;
        match self {
            Probe::Points { population, probe } => {
                let (dt, has_left) = (scene.clock.dt_before, scene.has_left(*population));
                match population {
                    Population::Nodes => probe.value(solid, scene.supports(), dt, has_left),
                    Population::Particles => probe.value(&scene.bonded, scene.bonded.supports(), dt, has_left),
                }
            }
            Probe::Energy(kind) => scene.ledger().probe(*kind),
            Probe::Count(CountKind::Fragments) => probed.fragments().len() as f64,
            Probe::Count(CountKind::BrokenEdges) => probed.fracture().broken_edges as f64,
            Probe::Count(CountKind::DamagedEdges) => probed.fracture().damaged_edges as f64,
            Probe::Count(kind) => probed.counts.of(*kind) as f64,
            Probe::Stress { elements, between: [normal, along] } => {
                let (mut sum, mut volume) = (0.0, 0.0);
                let many = |body: usize| MANY * elements.len() >= solid.body(body).elements.len();
                for &(body, element) in elements {
                    let v = solid.element_volumes(body)[element as usize];
                    let middle = solid.element_middle(body, element);
                    let stress = probed.stress(body, element, many(body)).to_matrix();
                    sum += v * normal.at(&middle).dot(&(stress * along.at(&middle)));
                    volume += v;
                }
                sum / volume
            }
            Probe::ParticleStress(probe) => probe.value(scene),
            Probe::Strain(probe) => probe.value(scene),
            Probe::Extensometer(probe) => probe.value(scene),
            Probe::Momentum(direction) => {
                let nodes = (0..solid.mass.len()).map(|i| solid.mass[i] * solid.velocity[i].dot(direction));
                let rigid_bodies: Vec3 =
                    scene.contacts.rigid_bodies().iter().map(|rigid_body| rigid_body.momentum()).sum();
                nodes.sum::<f64>() + (scene.bonded.momentum() + rigid_bodies).dot(direction)
            }
            Probe::AngularMomentum(direction) => {
                let nodes = (0..solid.mass.len())
                    .map(|i| solid.mass[i] * Points::position(solid, i).cross(&solid.velocity[i]).dot(direction));
                let spins = scene.debris.spin_momentum(solid) + scene.bonded.angular_momentum();
                nodes.sum::<f64>() + spins.dot(direction)
            }
            Probe::RigidBodyForce { rigid_body, direction } => {
                -scene.contacts.rigid_bodies()[*rigid_body].contact_force().dot(direction)
            }
            Probe::ContactForce(probe) => scene.contacts.force_between(probe).unwrap_or(f64::NAN),
            Probe::RigidBodyDisplacement { rigid_body, direction } => {
                let rigid_body = &scene.contacts.rigid_bodies()[*rigid_body];
                (rigid_body.displacement() - rigid_body.frame.velocity * scene.clock.dt_before).dot(direction)
            }
            Probe::RigidBodyVelocity { rigid_body, direction } => {
                scene.contacts.rigid_bodies()[*rigid_body].frame.velocity.dot(direction)
            }
            Probe::Gas { measure, hole } => scene.gas().map_or(f64::NAN, |gas| gas.measure(solid, *measure, *hole)),
            Probe::Temperature { population, points, take } => {
                let of_particles = *population == Population::Particles;
                scene.heat().map_or(f64::NAN, |heat| heat.temperature_of(of_particles, points, *take))
            }
            Probe::Heat(measure) => scene.heat().map_or(f64::NAN, |heat| heat.measure(*measure)),
            Probe::Load { points, along } => scene.loads.resultant(points, |point| along.at(&solid.reference[point])),
            Probe::Surface { facets, measure } => measure_surface(solid, facets, *measure),
            Probe::Fragment { points, measure, along } => {
                measure_fragment(solid, probed.fragments(), points, *measure, along)
            }
            Probe::FragmentSize(share) => passing_size(solid, probed.fragments(), *share),
            Probe::CrackArea => probed.crack_edges().iter().map(CrackEdge::damaged_area).sum(),
            Probe::Crack { measure, axis, inside } if measure.is_of_separation() => {
                measure_extent(scene, probed.separation(), *measure, &axis.direction, inside.as_ref())
            }
            Probe::Crack { measure, axis, inside } => {
                measure_crack(scene, probed.crack_edges(), *measure, axis, inside.as_ref())
            }
            Probe::RadialCracks(probe) => probe.value(solid, probed.separation()),
            Probe::Damaged(probe) => probe.value(solid),
            Probe::WaveSpeed { body, wave } => solid.wave_speed(*body, *wave),
        }
    }
}
