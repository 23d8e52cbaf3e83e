//! Particles of a bonded body that are tied to the surface of a solid.

use fractum_dem::Particles;
use fractum_fem::Solid;
use fractum_math::elementary::hypot;
use fractum_math::{Mat3, Rotation, Vec3, largest_eigenvalue, rotation_by};
use rayon::prelude::*;

use super::layer::Attachment;
use crate::bonded::Bonded;

/// Facets handled as one by the parallel loops.
const BLOCK: usize = 64;
/// Lanczos steps of the highest frequency; it converges from below, and the value carries a margin of 2 %.
const LANCZOS_STEPS: usize = 48;
/// Displacement over the smallest radius, and rotation, at which the stiffness is measured.
const PROBE: f64 = 1e-6;

/// Particles that follow facets of a solid, and give it what pulls at them.
///
/// A tied particle is at Σ w x + R d: the place on the facet by the weights of its nodes, and its offset from there, turned
/// with the facet; it turns by R, which is the rotation that brings the facet of the start closest to the present one (in the
/// sense of least squares, so that it is exact for a rigid motion, and its normal is the facet's). This is a function of the
/// nodes' positions alone, so that its transpose gives their forces: w F, and (J⁻¹ M) × y with the moment M of all forces of the
/// facet about the places, the turned corners y and J = Σ (x · y) I − x yᵀ. Their sum and their moment are those of the
/// particles, and elastic energy is conserved as in any system with constraints that do not change in time.
///
/// The mass of a tied particle goes to the nodes by the weights; its moment of inertia, (2/5) m r², is left out.
#[derive(Clone, Debug, Default)]
pub struct Ties {
    facets: Vec<TiedFacet>,
    particles: Vec<TiedParticle>,
    frequency: f64,
}

#[derive(Clone, Debug)]
struct TiedFacet {
    nodes: [u32; 3],
    /// Axes of the facet at the start, its first edge, across it and its normal.
    axes: Mat3,
    /// Corners at the start about their mean [m].
    rest: [Vec3; 3],
    /// First and last + 1 of its particles.
    particles: (u32, u32),
    /// Rotation since the start.
    rotation: Rotation,
    /// Turned corners about their mean [m].
    turned: [Vec3; 3],
    /// J⁻¹ [1/m²].
    inverse: Mat3,
    /// Forces of its particles on its nodes [N].
    force: [Vec3; 3],
}

#[derive(Clone, Debug)]
struct TiedParticle {
    particle: u32,
    weights: [f64; 3],
    /// From the place on the facet to the centre, at the start [m].
    offset: Vec3,
}

impl Ties {
    /// Ties particles at the present places; their masses go to the nodes.
    ///
    /// Each particle counts once: of several attachments the first holds.
    pub fn new(solid: &mut Solid, bonded: &mut Bonded, attachments: &[Attachment]) -> Ties {
        let mut wanted: Vec<Attachment> = attachments.to_vec();
        let mut seen = vec![false; bonded.particles.len()];
        wanted.retain(|a| !std::mem::replace(&mut seen[a.particle as usize], true));
        wanted.sort_by_key(|a| (a.facet, a.particle));
        let mut ties = Ties::default();
        for same in wanted.chunk_by(|a, b| a.facet == b.facet) {
            let first = ties.particles.len() as u32;
            let corners = same[0].facet.map(|n| solid.position(n as usize));
            for &Attachment { particle, weights, facet } in same {
                let i = particle as usize;
                let offset = bonded.particles.position[i] - mean(&corners, &weights);
                ties.particles.push(TiedParticle { particle, weights, offset });
                for (node, weight) in facet.into_iter().zip(weights) {
                    solid.add_mass(node as usize, weight * bonded.particles.mass[i]);
                }
            }
            ties.facets.push(TiedFacet::new(same[0].facet, &corners, (first, ties.particles.len() as u32)));
        }
        bonded.set_tied(ties.particles.iter().map(|p| p.particle).collect());
        ties.take_velocities(solid, &mut bonded.particles);
        ties.frequency = 1.02 * ties.highest_frequency(solid, bonded);
        ties
    }

    /// Whether nothing is tied.
    pub fn is_empty(&self) -> bool {
        self.particles.is_empty()
    }

    /// Tied particles, and facets that have some.
    pub fn counts(&self) -> (usize, usize) {
        (self.particles.len(), self.facets.len())
    }

    /// Pairs of a tied particle and a node of its facet, for what is connected.
    pub(crate) fn links(&self) -> impl Iterator<Item = (u32, u32)> {
        self.facets.iter().flat_map(|facet| self.of(facet).iter().map(|own| (own.particle, facet.nodes[0])))
    }

    /// Every tied particle, with its displacement and rotation by small motions of each node of its facet.
    pub(crate) fn motions(&self) -> impl Iterator<Item = (u32, [(u32, [Mat3; 2]); 3])> {
        self.facets.iter().flat_map(|facet| {
            let of = move |own: &TiedParticle| {
                let arm = (facet.rotation * own.offset).cross_matrix();
                let by = |k: usize| {
                    let turn = facet.inverse * facet.turned[k].cross_matrix();
                    (facet.nodes[k], [Mat3::identity() * own.weights[k] - arm * turn, turn])
                };
                (own.particle, [0, 1, 2].map(by))
            };
            self.of(facet).iter().map(of)
        })
    }

    /// Nodes that carry tied particles.
    pub(crate) fn nodes(&self) -> impl Iterator<Item = u32> {
        self.facets.iter().flat_map(|facet| facet.nodes)
    }

    /// Highest natural frequency of solids and bonded bodies together [rad/s]; 0 without ties.
    pub(crate) fn frequency(&self) -> f64 {
        self.frequency
    }

    fn of(&self, facet: &TiedFacet) -> &[TiedParticle] {
        &self.particles[facet.particles.0 as usize..facet.particles.1 as usize]
    }

    /// Hands the forces and moments of tied particles to the nodes; none are left on the particles.
    pub(crate) fn pass_on(&mut self, solid: &mut Solid, particles: &mut Particles) {
        let Ties { facets, particles: tied, .. } = self;
        let (force, moment) = (&particles.force, &particles.moment);
        facets.par_iter_mut().with_min_len(BLOCK).for_each(|facet| {
            let (first, end) = facet.particles;
            facet.collect(&tied[first as usize..end as usize], force, moment);
        });
        // In the order of the facets: the sum on a node has one order for any number of threads.
        for facet in facets.iter() {
            for (node, force) in facet.nodes.iter().zip(&facet.force) {
                solid.force[*node as usize] += force;
            }
        }
        for own in tied.iter() {
            particles.force[own.particle as usize] = Vec3::zeros();
            particles.moment[own.particle as usize] = Vec3::zeros();
        }
    }

    /// Puts tied particles where the nodes are, with their velocities and spins.
    pub(crate) fn follow(&mut self, solid: &Solid, particles: &mut Particles) {
        let Ties { facets, particles: tied, .. } = self;
        facets.par_iter_mut().with_min_len(BLOCK).for_each(|facet| facet.locate(solid));
        for facet in facets.iter() {
            let (first, end) = facet.particles;
            let corners = facet.nodes.map(|n| solid.position(n as usize));
            for TiedParticle { particle, weights, offset } in &tied[first as usize..end as usize] {
                let i = *particle as usize;
                particles.position[i] = mean(&corners, weights) + facet.rotation * offset;
                particles.orientation[i] = facet.rotation;
            }
        }
        self.take_velocities(solid, particles);
    }

    /// Gives tied particles the velocities of their facets.
    fn take_velocities(&self, solid: &Solid, particles: &mut Particles) {
        for facet in &self.facets {
            let velocity = facet.nodes.map(|n| solid.velocity[n as usize]);
            let momentum: Vec3 = facet.turned.iter().zip(&velocity).map(|(y, v)| y.cross(v)).sum();
            let spin = facet.inverse * momentum;
            for TiedParticle { particle, weights, offset } in self.of(facet) {
                let i = *particle as usize;
                particles.velocity[i] = mean(&velocity, weights) + spin.cross(&(facet.rotation * offset));
                particles.spin[i] = spin;
            }
        }
    }

    /// Takes up a saved state: nodes and particles are those of the checkpoint.
    pub(crate) fn restore(&mut self, solid: &Solid, particles: &Particles) {
        let Ties { facets, particles: tied, .. } = self;
        for facet in facets {
            // Of the two quaternions of one rotation, that of the saved run.
            facet.rotation = particles.orientation[tied[facet.particles.0 as usize].particle as usize];
            facet.locate(solid);
        }
    }

    /// Highest natural frequency of the undamaged whole at rest [rad/s].
    ///
    /// The stiffness is measured: forces of the scene's own bodies under a displacement far below any other length.
    fn highest_frequency(&self, solid: &Solid, bonded: &Bonded) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        let (mut solid, mut bonded, mut ties) = (solid.clone(), bonded.clone(), self.clone());
        solid.velocity.fill(Vec3::zeros());
        let start = (solid.displacement.clone(), bonded.particles.position.clone());
        let mut is_tied = vec![false; bonded.particles.len()];
        self.particles.iter().for_each(|p| is_tied[p.particle as usize] = true);
        let free: Vec<usize> = (0..is_tied.len()).filter(|&i| !is_tied[i]).collect();
        let (nodes, count) = (solid.mass.len(), solid.mass.len() + 2 * free.len());
        let smallest = bonded.particles.radius.iter().copied().fold(f64::INFINITY, f64::min);
        // Roots of masses: nodes, then particles, then their moments of inertia.
        let own = &bonded.particles;
        let masses = solid.mass.iter().copied();
        let masses = masses.chain(free.iter().map(|&i| own.mass[i])).chain(free.iter().map(|&i| own.inertia[i]));
        let root: Vec<f64> = masses.map(f64::sqrt).collect();
        let stiffness = |q: &[Vec3]| {
            let moved = |k: usize| {
                let length = if k < nodes + free.len() { smallest } else { 1.0 };
                q[k].norm() / (root[k] * length)
            };
            let scale = PROBE / (0..count).map(moved).fold(f64::MIN_POSITIVE, f64::max);
            let step = |k: usize| q[k] * (scale / root[k]);
            for n in 0..nodes {
                solid.displacement[n] = start.0[n] + step(n);
            }
            for (k, &i) in free.iter().enumerate() {
                bonded.particles.position[i] = start.1[i] + step(nodes + k);
                bonded.particles.orientation[i] = rotation_by(step(nodes + free.len() + k));
            }
            ties.follow(&solid, &mut bonded.particles);
            solid.update_internal_forces(0.0, false);
            bonded.update_bond_forces(0.0, false);
            ties.pass_on(&mut solid, &mut bonded.particles);
            let own = &bonded.particles;
            let forces = solid.force.iter().copied();
            let forces = forces.chain(free.iter().map(|&i| own.force[i])).chain(free.iter().map(|&i| own.moment[i]));
            forces.zip(&root).map(|(force, root)| force / (-scale * root)).collect()
        };
        largest_eigenvalue(count, LANCZOS_STEPS, &mut { stiffness }).max(0.0).sqrt()
    }
}

fn mean(of: &[Vec3; 3], weights: &[f64; 3]) -> Vec3 {
    of[0] * weights[0] + of[1] * weights[1] + of[2] * weights[2]
}

/// First edge of a triangle, the direction across it in its plane, and its normal.
fn axes([a, b, c]: &[Vec3; 3]) -> Mat3 {
    let (edge, other) = (b - a, c - a);
    let along = edge / edge.norm();
    let normal = edge.cross(&other);
    let normal = normal / normal.norm();
    Mat3::from_columns(&[along, normal.cross(&along), normal])
}

fn about_mean(corners: &[Vec3; 3]) -> [Vec3; 3] {
    let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    corners.map(|x| x - middle)
}

impl TiedFacet {
    fn new(nodes: [u32; 3], corners: &[Vec3; 3], particles: (u32, u32)) -> Self {
        let zero = [Vec3::zeros(); 3];
        let rest = about_mean(corners);
        let (axes, rotation) = (axes(corners), Rotation::identity());
        let mut facet =
            TiedFacet { nodes, axes, rest, particles, rotation, turned: zero, inverse: Mat3::zeros(), force: zero };
        facet.locate_at(corners);
        facet
    }

    fn locate(&mut self, solid: &Solid) {
        self.locate_at(&self.nodes.map(|n| solid.position(n as usize)));
    }

    /// Finds the rotation and what follows from it.
    fn locate_at(&mut self, corners: &[Vec3; 3]) {
        let now = axes(corners);
        let spread = about_mean(corners);
        // In the plane of the facet: the angle at which Σ y × x vanishes.
        let (mut cosine, mut sine) = (0.0, 0.0);
        for (rest, spread) in self.rest.iter().zip(&spread) {
            let (y, x) = (self.axes.tr_mul(rest), now.tr_mul(spread));
            cosine += y.x * x.x + y.y * x.y;
            sine += y.x * x.y - y.y * x.x;
        }
        let size = hypot(cosine, sine);
        let (c, s) = (cosine / size, sine / size);
        let plane = Mat3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
        let matrix = now * plane * self.axes.transpose();
        let rotation = Rotation::from_rotation_matrix(&nalgebra::Rotation3::from_matrix_unchecked(matrix));
        // A rotation has two quaternions: the one that continues the last.
        let opposite = rotation.coords.dot(&self.rotation.coords) < 0.0;
        self.rotation = if opposite { Rotation::new_unchecked(-rotation.into_inner()) } else { rotation };
        self.turned = self.rest.map(|y| matrix * y);
        let mut inertia = Mat3::zeros();
        for (y, x) in self.turned.iter().zip(&spread) {
            inertia += Mat3::identity() * x.dot(y) - x * y.transpose();
        }
        // A facet that has lost its area stops the run at the next balance.
        self.inverse = inertia.try_inverse().unwrap_or_else(|| Mat3::repeat(f64::NAN));
    }

    /// Sums the forces of its particles on its nodes.
    fn collect(&mut self, tied: &[TiedParticle], force: &[Vec3], moment: &[Vec3]) {
        self.force = [Vec3::zeros(); 3];
        let mut total = Vec3::zeros();
        for TiedParticle { particle, weights, offset } in tied {
            let i = *particle as usize;
            for (sum, weight) in self.force.iter_mut().zip(weights) {
                *sum += force[i] * *weight;
            }
            total += moment[i] + (self.rotation * offset).cross(&force[i]);
        }
        let turn = self.inverse.tr_mul(&total);
        for (sum, y) in self.force.iter_mut().zip(&self.turned) {
            *sum += turn.cross(y);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bonded::BondedPart;
    use crate::clock::TimeStepSettings;
    use crate::conditions::{Gravity, Load, Loads, Supports};
    use crate::coupling::Debris;
    use crate::coupling::Layer;
    use crate::{Scene, SceneSettings};
    use fractum_dem::{BeamSection, Clumps};
    use fractum_fem::{Body, Elastic, ElementKind, Kinematics, LocalDamping};
    use fractum_mesh::generate::{Jitter, structured_box};
    use fractum_mesh::topology;
    use std::sync::Arc;

    const RADIUS: f64 = 0.5e-3;
    const ELASTIC: Elastic = Elastic { density: 2500.0, young_modulus: 70e9, poisson_ratio: 0.2 };

    /// A cube of tetrahedra of 4 mm below z = 0 and a cubic lattice of 4 × 4 × 4 particles on it, tied.
    fn halves(loads: Vec<Load>, on_particles: Vec<Load>) -> Scene {
        let mesh = structured_box([3, 3, 3], Vec3::repeat(4e-3), Some(Jitter { fraction: 0.1, seed: 3 }));
        let nodes: Vec<Vec3> = mesh.nodes.iter().map(|x| x - Vec3::z() * 4e-3).collect();
        let facets: Vec<[u32; 3]> =
            topology::boundary_of_tetrahedra(&mesh.tetrahedra).iter().map(|f| f.nodes).collect();
        let mut body = Body::new("block", ElementKind::T4, mesh.tetrahedra, ELASTIC);
        body.kinematics = Kinematics::Corotational;
        let solid = Solid::new(nodes, vec![body]).unwrap();
        let mut position = Vec::new();
        for k in 0..64 {
            let place = Vec3::new((k % 4) as f64, (k / 4 % 4) as f64, (k / 16) as f64);
            position.push((place + Vec3::repeat(0.5)) * (2.0 * RADIUS));
        }
        let near = |i: usize, j: usize| (position[j] - position[i]).norm() < 2.9 * RADIUS;
        let pairs: Vec<[u32; 2]> = (0..64)
            .flat_map(|i| (i + 1..64).map(move |j| [i, j]))
            .filter(|&[i, j]| near(i, j))
            .map(|pair| pair.map(|i| i as u32))
            .collect();
        let particles = Particles::at_rest(position, vec![RADIUS; 64], 2500.0 * 64e-9).unwrap();
        let section = BeamSection { radius: 0.4 * RADIUS, young_modulus: 200e9, poisson_ratio: 0.3 };
        let (law, shares) = (section.into(), Vec::new());
        let part = BondedPart {
            name: "lattice".into(),
            particles,
            pairs,
            law,
            shares,
            density: 2500.0,
            fraction: 1.0,
            fracture: None,
            clumps: Clumps::default(),
        };
        let mut bonded = Bonded::new(vec![part]).unwrap();
        bonded.set_loads(on_particles);
        let among: Vec<u32> = (0..64).collect();
        let layer = Layer::find(&solid, &facets, &bonded.particles, &among, 0.1 * RADIUS).unwrap();
        assert_eq!((layer.attachments.len(), layer.facets > 4), (16, true));
        assert!(layer.least_gap.abs() < 1e-12);
        let debris = Debris::new(&solid, vec![crate::ContactParameters::default()]);
        let settings = SceneSettings {
            time_step: TimeStepSettings { safety: 0.5, element_bound: false, fixed: None, begin: 0.0, end: 1.0 },
            damping: LocalDamping::default(),
            stiffness_time: 0.0,
            balance_stop: 1e-2,
            joined_below: 0.95,
        };
        let loads = Loads::new(loads, solid.reference.len());
        let supports = Supports::new(Vec::new(), &solid.reference).unwrap();
        let scene = Scene::new(solid, supports, loads, debris, Vec::new(), &[], settings);
        scene.with_bonded(bonded).with_ties(&layer.attachments)
    }

    fn momenta(scene: &Scene) -> (Vec3, Vec3, f64) {
        let solid = &scene.solid;
        let (mut linear, mut angular) = (scene.bonded.momentum(), scene.bonded.angular_momentum());
        let mut size = 0.0;
        for i in 0..solid.mass.len() {
            linear += solid.velocity[i] * solid.mass[i];
            angular += solid.position(i).cross(&solid.velocity[i]) * solid.mass[i];
            size += solid.velocity[i].norm() * solid.mass[i];
        }
        (linear, angular, size)
    }

    #[test]
    fn a_rigid_motion_of_the_whole_gives_no_force() {
        let mut scene = halves(Vec::new(), Vec::new());
        let turn = Rotation::from_scaled_axis(Vec3::new(1.1, -0.7, 2.0));
        let shift = Vec3::new(0.3, -0.1, 0.2);
        let Scene { solid, bonded, ties, .. } = &mut scene;
        for i in 0..solid.mass.len() {
            solid.displacement[i] = turn * solid.reference[i] + shift - solid.reference[i];
        }
        let reference = bonded.reference().to_vec();
        for (i, x) in reference.iter().enumerate() {
            bonded.particles.position[i] = turn * x + shift;
            bonded.particles.orientation[i] = turn;
        }
        ties.follow(solid, &mut bonded.particles);
        for (i, x) in reference.iter().enumerate() {
            assert!((bonded.particles.position[i] - (turn * x + shift)).norm() < 1e-14);
            assert!(bonded.particles.orientation[i].angle_to(&turn) < 1e-7);
        }
        solid.update_internal_forces(0.0, false);
        bonded.update_bond_forces(0.0, false);
        ties.pass_on(solid, &mut bonded.particles);
        let scale = ELASTIC.young_modulus * RADIUS * RADIUS;
        let most = solid.force.iter().chain(&bonded.particles.force).map(|f| f.norm()).fold(0.0, f64::max);
        // Round-off of coordinates of 0.4 m over bonds of 1 mm.
        assert!(most < 1e-11 * scale, "{}", most / scale);
    }

    #[test]
    fn forces_and_moments_pass_whole_and_as_the_transpose_of_the_motion() {
        let mut scene = halves(Vec::new(), Vec::new());
        let Scene { solid, bonded, ties, .. } = &mut scene;
        let wave = |x: &Vec3, k: f64| Vec3::new((900.0 * x.y + k).sin(), (700.0 * x.z).cos(), (500.0 * x.x - k).sin());
        for i in 0..solid.mass.len() {
            solid.displacement[i] = wave(&solid.reference[i], 0.0) * 2e-4;
            solid.velocity[i] = wave(&solid.reference[i], 1.0);
        }
        ties.follow(solid, &mut bonded.particles);
        let own = &mut bonded.particles;
        for i in 0..own.len() {
            own.force[i] = wave(&own.position[i], 2.0) * 30.0;
            own.moment[i] = wave(&own.position[i], 3.0) * 0.02;
        }
        let tied: Vec<usize> = ties.particles.iter().map(|p| p.particle as usize).collect();
        let force: Vec3 = tied.iter().map(|&i| own.force[i]).sum();
        let moment: Vec3 = tied.iter().map(|&i| own.position[i].cross(&own.force[i]) + own.moment[i]).sum();
        let power: f64 =
            tied.iter().map(|&i| own.velocity[i].dot(&own.force[i]) + own.spin[i].dot(&own.moment[i])).sum();
        solid.force.fill(Vec3::zeros());
        ties.pass_on(solid, own);
        let nodes = 0..solid.mass.len();
        let passed: Vec3 = solid.force.iter().sum();
        let turning: Vec3 = nodes.clone().map(|i| solid.position(i).cross(&solid.force[i])).sum();
        let worked: f64 = nodes.map(|i| solid.velocity[i].dot(&solid.force[i])).sum();
        assert!((passed - force).norm() < 1e-13 * force.norm(), "{passed} {force}");
        assert!((turning - moment).norm() < 1e-12 * moment.norm(), "{turning} {moment}");
        assert!((worked / power - 1.0).abs() < 1e-11, "{worked} {power}");

        // The velocities are those of the map: central differences of the places.
        let (here, spin) = (own.velocity.clone(), own.spin.clone());
        let h = 1e-9;
        let mut at = |sign: f64| {
            for i in 0..solid.mass.len() {
                solid.displacement[i] += solid.velocity[i] * (sign * h);
            }
            ties.follow(solid, own);
            (own.position.clone(), own.orientation.clone())
        };
        let (after, before) = (at(1.0), at(-2.0));
        for &i in &tied {
            let rate = (after.0[i] - before.0[i]) / (2.0 * h);
            let turn = (after.1[i] * before.1[i].inverse()).scaled_axis() / (2.0 * h);
            assert!((rate - here[i]).norm() < 1e-6, "{rate} {}", here[i]);
            assert!((turn - spin[i]).norm() < 1e-3 * spin[i].norm() + 1e-3, "{turn} {}", spin[i]);
        }
    }

    #[test]
    fn a_free_body_of_two_tied_halves_keeps_momentum_and_energy_while_it_turns_and_rings() {
        let mut scene = halves(Vec::new(), Vec::new());
        let spin = Vec3::new(3000.0, -2000.0, 5000.0);
        let Scene { solid, bonded, ties, .. } = &mut scene;
        for i in 0..solid.mass.len() {
            let x = solid.reference[i];
            solid.velocity[i] =
                spin.cross(&x) + Vec3::new(2.0, 0.0, 5.0) + Vec3::z() * (4e3 * x.z) + Vec3::x() * (2e3 * x.y);
        }
        for i in 0..bonded.particles.len() {
            let x = bonded.particles.position[i];
            bonded.particles.velocity[i] = spin.cross(&x) + Vec3::new(2.0, 0.0, 5.0);
            bonded.particles.spin[i] = spin;
        }
        ties.take_velocities(solid, &mut bonded.particles);
        let mut start = None;
        for step in 0..4000 {
            scene.step(step % 20 == 0).unwrap();
            let now = momenta(&scene);
            let (linear, angular, size) = *start.get_or_insert(now);
            assert!((now.0 - linear).norm() < 1e-12 * size, "{step}: {} {linear}", now.0);
            assert!((now.1 - angular).norm() < 1e-12 * angular.norm(), "{step}: {} {angular}", now.1);
        }
        // It has turned, and rung on both sides.
        assert!(scene.bonded.particles.orientation[63].angle() > 0.5);
        let ledger = scene.ledger();
        let elastic = ledger[crate::ledger::EnergyKind::Elastic];
        assert!(elastic > 0.01 * ledger.initial && scene.bonded.energy().total() > 0.1 * elastic);
        assert!(ledger.residual_max_relative < 1e-4, "{}", ledger.residual_max_relative);
    }

    #[test]
    fn a_falling_body_weighs_once_and_a_saved_state_goes_on_bit_for_bit() {
        let gravity: crate::TimeFunction = Arc::new(|_: f64, _: &Vec3| -9.81);
        let on_nodes = vec![Load::Gravity(Gravity { axis: 2, value: gravity.clone() })];
        let on_particles = vec![Load::Gravity(Gravity { axis: 2, value: gravity })];
        let mut scene = halves(on_nodes, on_particles);
        let mut fresh = scene.clone();
        for _ in 0..50 {
            scene.step(true).unwrap();
        }
        let saved = scene.state();
        let time = scene.clock.time;
        let (linear, _, _) = momenta(&scene);
        // Velocities are those of half a step ago.
        let mass = 2500.0 * 2.0 * 64e-9;
        assert!((linear.z / (-9.81 * mass * (time - 0.5 * scene.clock.dt_before)) - 1.0).abs() < 1e-9);
        assert!(scene.ledger().residual_max_relative < 1e-9);
        fresh.restore(saved);
        for _ in 0..50 {
            scene.step(false).unwrap();
            fresh.step(false).unwrap();
        }
        assert_eq!(scene.state(), fresh.state());
        let pieces = scene.fragments();
        assert_eq!(pieces.len(), 1);
        assert!((pieces[0].mass / mass - 1.0).abs() < 1e-12 && (pieces[0].volume / 128e-9 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_step_is_stable_up_to_its_limit_and_not_far_beyond() {
        let run = |factor: f64| {
            let mut scene = halves(Vec::new(), Vec::new());
            // The bound of the bonds alone is left out: what counts is the frequency of the whole.
            let dt = factor * 2.0 / scene.ties.frequency();
            scene.settings.time_step.fixed = Some(dt);
            scene.clock = crate::Clock::new(dt);
            for (i, v) in scene.solid.velocity.iter_mut().enumerate() {
                *v = Vec3::new((i * i) as f64 % 1.3, (7 * i) as f64 % 1.7, (3 * i) as f64 % 1.1) - Vec3::repeat(0.6);
            }
            (0..3000).try_for_each(|k| scene.step(k % 10 == 0).map(|_| ()))
        };
        assert!(run(0.99).is_ok());
        assert!(run(1.05).is_err());
    }

    #[test]
    fn a_layer_that_touches_nothing_tells_how_far_off_it_is() {
        let scene = halves(Vec::new(), Vec::new());
        let facets: Vec<[u32; 3]> =
            topology::boundary_of_tetrahedra(&scene.solid.body(0).elements).iter().map(|f| f.nodes).collect();
        let top: Vec<u32> = (48..64).collect();
        let layer = Layer::find(&scene.solid, &facets, &scene.bonded.particles, &top, 0.1 * RADIUS).unwrap();
        assert!(layer.attachments.is_empty() && (layer.least_gap / (6.0 * RADIUS) - 1.0).abs() < 1e-9);
    }
}
