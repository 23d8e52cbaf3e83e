//! Mean stress and strain of a region of a body.

use fractum_dem::{StrainGauge, StrainMeasure, stress};
use fractum_math::{Rotation, Vec3, rotation_by, sphere_volume};

use crate::bonded::Bonded;
use crate::conditions::{Along, Points, Population};
use crate::leave::is_out;
use crate::measure::probe::{NeededPoints, Probe, ProbeNeeds, ProbedScene};
use crate::scene::Scene;

/// Virial stress of a set of particles.
#[derive(Clone, Debug, PartialEq)]
pub struct RegionStress {
    /// The particles, ascending.
    set: Vec<u32>,
    /// Body, bond, and how many of its particles are in the set.
    bonds: Vec<(u32, u32, f64)>,
    /// Volume that the set stands for [m³].
    volume: f64,
    between: [Along; 2],
}

impl RegionStress {
    /// - `set`: particles, ascending
    /// - `between`: the stress on a plane with the first normal along the second, at the middle of each bond without load
    pub fn new(bonded: &Bonded, set: &[u32], between: [Along; 2]) -> Self {
        let inside = |i: &u32| set.binary_search(i).is_ok();
        let (mut bonds, mut volume) = (Vec::new(), 0.0);
        for (index, body) in (0..).zip(bonded.bodies()) {
            for (bond, pair) in (0..).zip(body.bonds.pairs()) {
                let ends = pair.iter().filter(|i| inside(i)).count();
                if ends > 0 {
                    bonds.push((index, bond, ends as f64));
                }
            }
            let own = set.iter().filter(|&&i| body.range.contains(&(i as usize)));
            volume += own.map(|&i| sphere_volume(bonded.particles.radius[i as usize])).sum::<f64>() / body.fraction;
        }
        RegionStress { set: set.to_vec(), bonds, volume, between }
    }

    /// The bonds that it looks at (body, bond), and their particles.
    fn looks_at(&self, bonded: &Bonded) -> (Vec<(u32, u32)>, Vec<u32>) {
        let bonds: Vec<(u32, u32)> = self.bonds.iter().map(|&(body, bond, _)| (body, bond)).collect();
        let ends = |&(body, bond): &(u32, u32)| bonded.bodies()[body as usize].bonds.pairs()[bond as usize];
        let mut particles: Vec<u32> = bonds.iter().flat_map(ends).collect();
        particles.sort_unstable();
        particles.dedup();
        (bonds, particles)
    }
}

impl Probe for RegionStress {
    /// The component [Pa], at the places that the step ends with: a step after strains of the same row; tension is positive. Not a
    /// number once a particle of the set has left the run.
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        let scene = probed.scene;
        if self.set.iter().copied().any(is_out(scene, Population::Particles)) {
            return f64::NAN;
        }
        let ([normal, along], bonded) = (&self.between, &scene.bonded);
        let all = &bonded.particles;
        let of = |&(body, bond, ends): &(u32, u32, f64)| {
            let (bonds, bond) = (&bonded.bodies()[body as usize].bonds, bond as usize);
            if !bonds.is_live(bond) {
                return 0.0;
            }
            let virial = stress::virial(bonds.gap(bond, all), -bonds.forces_of(bond, all).force);
            let [from, to] = bonds.ends(bond, bonded.reference());
            let middle = (from + to) * 0.5;
            ends * normal.at(&middle).dot(&(virial * along.at(&middle)))
        };
        self.bonds.iter().map(of).sum::<f64>() / self.volume
    }

    fn needs(&self, scene: &Scene) -> ProbeNeeds {
        let (bonds, particles) = self.looks_at(&scene.bonded);
        ProbeNeeds { particles: NeededPoints::Some(particles), bonds, ..ProbeNeeds::default() }
    }
}

/// Mean strain of a set of nodes or particles.
#[derive(Clone, Debug, PartialEq)]
pub struct RegionStrain {
    population: Population,
    gauge: StrainGauge,
    /// Directions whose strain is measured.
    between: [Vec3; 2],
}

impl RegionStrain {
    /// None where the points do not span a volume, or the plane of both directions; particles for all measures but Cundall's.
    ///
    /// - `set`: points, ascending
    /// - `between`: the change of the angle between two directions, halved, or of length along one, at the centre of the set
    pub fn new(
        scene: (&Bonded, &fractum_fem::Solid),
        population: Population,
        set: &[u32],
        measure: StrainMeasure,
        between: [Along; 2],
    ) -> Option<Self> {
        let (bonded, solid) = scene;
        let place = |i: usize| match population {
            Population::Nodes => solid.reference[i],
            Population::Particles => bonded.reference()[i],
        };
        let gauge = StrainGauge::new(measure, set, place, |i| bonded.particles.radius[i])?;
        let centre = set.iter().map(|&i| place(i as usize)).sum::<Vec3>() / set.len() as f64;
        let between = between.map(|along| along.at(&centre));
        let measured = |direction: &Vec3| gauge.normal.is_none_or(|normal| normal.dot(direction).abs() < 1e-6);
        between.iter().all(measured).then_some(RegionStrain { population, gauge, between })
    }
}

impl Probe for RegionStrain {
    /// The component [-], at the instant of the last step. Not a number once a point of the set has left the run.
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        let scene = probed.scene;
        if self.gauge.points().any(is_out(scene, self.population)) {
            return f64::NAN;
        }
        let dt = scene.clock.dt_before;
        let all = &scene.bonded.particles;
        let strain = match self.population {
            Population::Nodes => {
                self.gauge.strain(|i| scene.solid.displacement_before(i, dt), |_| Rotation::identity())
            }
            Population::Particles => self.gauge.strain(
                |i| scene.bonded.displacement_before(i, dt),
                |i| rotation_by(all.spin[i] * -dt) * all.orientation[i],
            ),
        };
        self.between[0].dot(&(strain * self.between[1]))
    }

    fn needs(&self, _: &Scene) -> ProbeNeeds {
        ProbeNeeds::of_all(false)
    }
}
