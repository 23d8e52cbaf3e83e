//! A body of particles, ready to be put into a scene.

use fractum_dem::{AnyBondLaw, Clumps, Particles};
use fractum_math::Vec3;
use fractum_pack::Domain;
use fractum_scene::{Arrivals, BondFracture};

/// The particles of a bonded or loose body: packed or read, bonded and calibrated.
#[derive(Clone, Debug)]
pub struct PreparedBody {
    /// Particles at rest.
    pub particles: Particles,
    /// The particles of each bond.
    pub pairs: Vec<[u32; 2]>,
    /// The law of its bonds.
    pub law: AnyBondLaw,
    /// Factors on the areas of the bonds; 1 where there are none.
    pub shares: Vec<f64>,
    /// Sets of particles that touch the walls of the shape, by name.
    pub walls: Vec<(String, Vec<u32>)>,
    /// The shape that it was packed into, whose walls these are.
    pub domain: Option<Domain>,
    /// How far each particle is from touching the walls of the shape exactly [m]; empty where that does not matter.
    pub shift_to_walls: Vec<Vec3>,
    /// The way out of the shape at each particle of a flat wall alone, zero for the others; empty where that does not matter.
    pub out_of_flat_walls: Vec<Vec3>,
    /// Volume fraction of the interior of its packing.
    pub fraction: f64,
    /// When its bonds break, with the criterion's own strengths.
    pub fracture: Option<BondFracture>,
    /// When they come into the run, and where; all are there from the start where there is nothing.
    pub arrivals: Option<Arrivals>,
    /// Rigid grains that the particles are spheres of.
    pub clumps: Clumps,
    /// Tetrahedra of the mesh that it takes the place of.
    pub replaced: Vec<u32>,
}
