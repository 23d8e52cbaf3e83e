//! Bonded bodies whose bonds are interfaces of the local constitutive law: nothing is calibrated.

use std::f64::consts::PI;

use fractum_calibrate::{CalibrateError, Sample};
use fractum_dem::{Clumps, CrackFaces, LocalBond, Particles};
use fractum_pack::{BondNetwork, Packing};
use fractum_scene::BondFracture;

use super::{BondedReport, Joints, Maker, Origin};
use crate::asked::{BondLawKind, BondedSubstance, Fault, InterfaceArea, Interfaces};
use crate::body::PreparedBody;
use crate::region::Region;

/// Coordination where none is asked: the polyhedra of [`InterfaceArea::Cells`] then fill a random packing.
const COORDINATION: f64 = 9.0;

/// Interfaces of a body, for the plan.
#[derive(Clone, Copy, Debug)]
pub struct InterfaceReport {
    /// Their law.
    pub law: LocalBond,
    /// Mean factor on their areas.
    pub mean_share: f64,
}

impl Maker<'_> {
    /// A body whose bonds are interfaces: their numbers are those of the material.
    ///
    /// - `pairs`: bonds that are given
    pub(super) fn make_interfaces(
        &self,
        packing: Packing,
        packing_from: Origin,
        region: Option<Region>,
        pairs: Option<Vec<[u32; 2]>>,
    ) -> Result<(PreparedBody, BondedReport), Fault> {
        let arrangement = self.arrangement();
        let usual = arrangement.neighbours().unwrap_or(COORDINATION);
        let coordination = self.asked.coordination.unwrap_or(usual);
        let sample = match pairs {
            Some(pairs) => {
                let network = BondNetwork::of_pairs(&packing, pairs);
                Sample::of_network(packing, network, self.asked.convention)
            }
            None => Sample::new(packing, coordination, self.asked.convention),
        };
        let mut sample = sample.map_err(|e| self.wrong(&e))?;
        sample.fraction = arrangement.fraction().unwrap_or(sample.fraction);
        let replaced = region.map_or_else(Vec::new, |region| region.elements);
        let material = self.material();
        // Regular arrangements fill space to their very faces, which are not flat.
        let of_body = || arrangement.fraction().unwrap_or(sample.packing.sphere_volume() / sample.measured_volume());
        let beside_mean = (self.asked.law == BondLawKind::LocalNonlocal).then(of_body);
        let made = with_interfaces(&sample, material, replaced, beside_mean);
        let (body, interfaces) = made.map_err(|e| self.wrong(&e))?;
        let mass = body.particles.mass.iter().sum();
        let report = self.report(&sample, mass, packing_from, Joints::Interfaces(interfaces));
        Ok((body, report))
    }
}

/// A bonded packing with interfaces, ready to move, and what there is to say of it.
///
/// - `beside_mean`: volume of the spheres over that of the body, where interfaces resist deviations from the mean strain of their particles only
///
/// # Errors
/// Particles without mass.
fn with_interfaces(
    sample: &Sample,
    material: &BondedSubstance,
    replaced: Vec<u32>,
    beside_mean: Option<f64>,
) -> Result<(PreparedBody, InterfaceReport), CalibrateError> {
    let mut own = material.interfaces.unwrap_or_else(|| Interfaces {
        area: InterfaceArea::Cells,
        law: LocalBond::elastic(material.young_modulus, material.poisson_ratio),
    });
    let volume = sample.measured_volume();
    own.law.mean_strain = beside_mean;
    let (position, radius) = (sample.packing.position.clone(), sample.packing.radius.clone());
    let particles = Particles::at_rest(position, radius, material.density * volume)?;
    let shares = shares(sample, own.area);
    let mean_share = shares.iter().sum::<f64>() / shares.len().max(1) as f64;
    let faces = CrackFaces { friction: own.law.friction, damping_ratio: own.law.damping_ratio };
    let fracture = BondFracture { criterion: None, faces, volume, strength_factors: Vec::new(), to_wall: Vec::new() };
    let body = PreparedBody {
        particles,
        pairs: sample.network.pairs.clone(),
        law: own.law.into(),
        shares,
        walls: sample.packing.walls.clone(),
        domain: Some(sample.packing.domain.clone()),
        arrivals: None,
        shift_to_walls: sample.packing.shift_to_walls(),
        out_of_flat_walls: sample.packing.out_of_flat_walls(),
        fraction: sample.fraction,
        fracture: own.law.can_fail().then_some(fracture),
        clumps: Clumps::default(),
        replaced,
    };
    Ok((body, InterfaceReport { law: own.law, mean_share }))
}

/// Factors α on the areas π min(r)² of the interfaces.
fn shares(sample: &Sample, area: InterfaceArea) -> Vec<f64> {
    let network = &sample.network;
    match area {
        InterfaceArea::Factor(factor) => vec![factor; network.pairs.len()],
        InterfaceArea::Porosity => {
            let factor = 40.0 * (1.0 - sample.fraction) / network.coordination_interior;
            vec![factor; network.pairs.len()]
        }
        InterfaceArea::Cells => cells(sample),
    }
}

/// Factors that make the interfaces of a particle the surface of a regular polyhedron about it, with as many faces as it has
/// neighbours (Oñate et al. 2017, eqs. 24 and 25). A particle at a wall lacks neighbours: it has the mean factor of the others.
fn cells(sample: &Sample) -> Vec<f64> {
    let (radius, pairs) = (&sample.packing.radius, &sample.network.pairs);
    let area = |[i, j]: [u32; 2]| PI * radius[i as usize].min(radius[j as usize]).powi(2);
    let (mut count, mut total) = (vec![0u32; radius.len()], vec![0.0; radius.len()]);
    for &pair in pairs {
        for i in pair.map(|i| i as usize) {
            count[i] += 1;
            total[i] += area(pair);
        }
    }
    let on_wall = sample.packing.on_wall();
    let own = |i: usize| {
        (!on_wall[i] && count[i] > 0).then(|| polyhedron(count[i]) * 4.0 * PI * radius[i].powi(2) / total[i])
    };
    let known: Vec<f64> = (0..radius.len()).filter_map(own).collect();
    let mean = if known.is_empty() { 1.0 } else { known.iter().sum::<f64>() / known.len() as f64 };
    let share = |pair: &[u32; 2]| {
        let ends = pair.map(|i| own(i as usize));
        match ends {
            [Some(first), Some(second)] => 0.5 * (first + second),
            [Some(one), None] | [None, Some(one)] => one,
            [None, None] => mean,
        }
    };
    pairs.iter().map(share).collect()
}

/// Surface of the regular polyhedra about a sphere over that of the sphere, by their faces.
const POLYHEDRA: [(f64, f64); 5] =
    [(4.0, 3.307_973), (6.0, 1.909_859), (8.0, 1.653_987), (12.0, 1.325_034), (20.0, 1.206_567)];

/// Surface of a polyhedron about a sphere over that of the sphere, on straight lines between the regular ones.
fn polyhedron(faces: u32) -> f64 {
    let faces = f64::from(faces).clamp(POLYHEDRA[0].0, POLYHEDRA[4].0);
    let at =
        POLYHEDRA.windows(2).find(|pair| faces <= pair[1].0).map_or([POLYHEDRA[3], POLYHEDRA[4]], |p| [p[0], p[1]]);
    let [(from, low), (to, high)] = at;
    low + (high - low) * (faces - from) / (to - from)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fractum_math::Vec3;
    use fractum_pack::{Arrangement, Convention, regular};

    #[test]
    fn polyhedra_have_the_surface_of_the_regular_ones() {
        // Surface over that of the inscribed sphere: 3 volume/(4 π r³), from edge and inradius.
        let (root3, root5) = (3f64.sqrt(), 5f64.sqrt());
        let exact = [
            (4, 6.0 * root3 / PI),
            (6, 6.0 / PI),
            (8, 3.0 * root3 / PI),
            (12, 3.0 * (25.0 + 10.0 * root5).sqrt() / (4.0 * PI * (2.5 + 1.1 * root5) / 4.0)),
            (20, 5.0 * root3 / (4.0 * PI * (root3 / 12.0 * (3.0 + root5)).powi(2))),
        ];
        for (faces, ratio) in exact {
            assert!((polyhedron(faces) / ratio - 1.0).abs() < 1e-6, "{faces}: {} {ratio}", polyhedron(faces));
        }
        assert_eq!((polyhedron(3), polyhedron(30)), (polyhedron(4), polyhedron(20)));
        assert!((polyhedron(7) - 0.5 * (polyhedron(6) + polyhedron(8))).abs() < 1e-12);
    }

    #[test]
    fn interfaces_of_a_cubic_arrangement_are_the_faces_of_its_cells() {
        let packing = regular(Vec3::zeros(), Vec3::repeat(1.0), 0.1, Arrangement::Cartesian).unwrap();
        let sample = Sample::new(packing, 6.0, Convention::Interior).unwrap();
        for share in shares(&sample, InterfaceArea::Cells) {
            assert!((share * PI * 0.01 / 0.04 - 1.0).abs() < 1e-6, "{share}");
        }
    }
}
