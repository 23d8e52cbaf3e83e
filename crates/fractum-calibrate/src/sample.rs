use fractum_dem::{BeamSection, DemError, Lattice};
use fractum_math::{Vec3, sphere_volume};
use fractum_pack::{BondNetwork, Convention, Domain, Packing, bond, interior_fraction};

use crate::CalibrateError;

/// A bonded packing ready for virtual tests.
#[derive(Clone, Debug)]
pub struct Sample {
    /// The packing.
    pub packing: Packing,
    /// Its bonds.
    pub network: BondNetwork,
    /// The convention that counted them.
    pub convention: Convention,
    /// Factors on the stiffness of the bonds; none where all are 1.
    pub shares: Vec<f64>,
    /// From each particle to the wall at which its stress is taken; empty where stress is not taken at walls [m].
    pub to_wall: Vec<Vec3>,
    /// The lattice of the bonds.
    pub lattice: Lattice,
    /// Mean radius [m].
    pub mean_radius: f64,
    /// Volume fraction of the interior (0.64 where the sample has no interior).
    pub fraction: f64,
}

/// Micro-parameters: what a bonded body needs besides its packing.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Micro {
    /// Beam radius over the mean particle radius, r_m.
    pub radius_ratio: f64,
    /// Young's modulus of the beams E_m [Pa].
    pub young_modulus: f64,
}

/// Volume fraction taken where a sample is too small to measure its interior.
const RANDOM_CLOSE: f64 = 0.64;

impl Sample {
    /// Bonds a packing to a coordination.
    ///
    /// # Errors
    /// An unreachable coordination.
    pub fn new(packing: Packing, coordination: f64, convention: Convention) -> Result<Self, CalibrateError> {
        let network = bond(&packing, coordination, convention)?;
        Sample::of_network(packing, network, convention)
    }

    /// A packing with bonds that are given.
    ///
    /// # Errors
    /// Bonds that make no lattice.
    pub fn of_network(packing: Packing, network: BondNetwork, convention: Convention) -> Result<Self, CalibrateError> {
        let mean_radius = packing.mean_radius();
        let section = BeamSection::new(1.0, 0.5 * mean_radius).map_err(DemError::from)?;
        let lattice = lattice_of(&packing, &network, &[], section)?;
        let fraction = interior_fraction(&packing).unwrap_or(RANDOM_CLOSE);
        Ok(Sample {
            packing,
            network,
            convention,
            shares: Vec::new(),
            to_wall: Vec::new(),
            lattice,
            mean_radius,
            fraction,
        })
    }

    /// Makes bonds stiffer by a share for each of their particles that touches a wall. Bonds end at the centres of the outer particles,
    /// half a particle inside the body that they stand for: its rim would bear nothing.
    ///
    /// # Errors
    /// A share that is no number from 0 on.
    pub fn stiffen_walls(mut self, by: f64) -> Result<Self, CalibrateError> {
        if !(by.is_finite() && by >= 0.0) {
            let expected = "a number from 0 on";
            return Err(CalibrateError::Material { what: "stiffening of wall bonds", value: by, expected });
        }
        if by > 0.0 {
            let Sample { packing, network, lattice, shares, .. } = &mut self;
            let mut share = vec![0.0; packing.len()];
            packing.walls.iter().flat_map(|(_, set)| set).for_each(|&i| share[i as usize] = by);
            let own = |pair: &[u32; 2]| 1.0 + share[pair[0] as usize] + share[pair[1] as usize];
            *shares = network.pairs.iter().map(own).collect();
            *lattice = lattice_of(packing, network, shares, lattice.section())?;
        }
        Ok(self)
    }

    /// Lets a criterion take the stress of particles at walls at these; see [`fractum_dem::FailureSearch::read_at_walls`].
    pub fn read_at_walls(mut self) -> Self {
        self.to_wall = self.packing.to_walls();
        self
    }

    /// Sets the beams of all bonds.
    ///
    /// # Errors
    /// Numbers that make no beam.
    pub fn set_micro(&mut self, micro: Micro) -> Result<(), DemError> {
        self.lattice.set_section(BeamSection::new(micro.young_modulus, micro.radius_ratio * self.mean_radius)?)
    }

    /// Mean coordinate of a wall set along an axis [m].
    pub(crate) fn mean_along(&self, wall: &str, axis: usize) -> Option<f64> {
        let set = self.packing.wall(wall).filter(|s| !s.is_empty())?;
        Some(set.iter().map(|&i| self.packing.position[i as usize][axis]).sum::<f64>() / set.len() as f64)
    }

    /// Extents of a box sample: distance of the mean face positions plus one mean diameter (Nguyen et al. 2019, 2.4).
    pub fn box_extents(&self) -> Option<Vec3> {
        matches!(self.packing.domain, Domain::Box { .. }).then_some(())?;
        let extent = |axis: usize, low: &str, high: &str| {
            Some(self.mean_along(high, axis)? - self.mean_along(low, axis)? + 2.0 * self.mean_radius)
        };
        Some(Vec3::new(extent(0, "x-", "x+")?, extent(1, "y-", "y+")?, extent(2, "z-", "z+")?))
    }

    /// Length and radius of a cylinder sample, measured in the same way (Jebahi et al. 2015, eqs. 2.20–2.21).
    pub fn cylinder_extents(&self) -> Option<(f64, f64)> {
        let Domain::Cylinder { start, .. } = self.packing.domain else { return None };
        let length = self.mean_along("x+", 0)? - self.mean_along("x-", 0)? + 2.0 * self.mean_radius;
        Some((length, self.mean_distance(start, Vec3::new(0.0, 1.0, 1.0))? + self.mean_radius))
    }

    /// Radius of a sphere sample, measured in the same way.
    pub fn sphere_radius(&self) -> Option<f64> {
        let Domain::Sphere { centre, .. } = self.packing.domain else { return None };
        Some(self.mean_distance(centre, Vec3::repeat(1.0))? + self.mean_radius)
    }

    /// Volume of the measured body [m³]; that of the domain where no measure is defined.
    pub fn measured_volume(&self) -> f64 {
        use std::f64::consts::PI;
        let cuboid = || self.box_extents().map(|e| e.product());
        let cylinder = || self.cylinder_extents().map(|(l, r)| PI * r * r * l);
        let sphere = || self.sphere_radius().map(sphere_volume);
        cuboid().or_else(cylinder).or_else(sphere).unwrap_or_else(|| self.packing.domain.volume())
    }

    /// Mean distance of the set `radius` from a point, along the axes of `mask`.
    fn mean_distance(&self, from: Vec3, mask: Vec3) -> Option<f64> {
        let set = self.packing.wall("radius").filter(|s| !s.is_empty())?;
        let distance = |&i: &u32| (self.packing.position[i as usize] - from).component_mul(&mask).norm();
        Some(set.iter().map(distance).sum::<f64>() / set.len() as f64)
    }
}

fn lattice_of(
    packing: &Packing,
    network: &BondNetwork,
    shares: &[f64],
    section: BeamSection,
) -> Result<Lattice, DemError> {
    let period = packing.domain.period();
    let nearest = |apart: Vec3| period.map_or(apart, |period| period.nearest(apart));
    Lattice::between(&packing.position, &network.pairs, shares, section, packing.mean_radius(), &nearest)
}
