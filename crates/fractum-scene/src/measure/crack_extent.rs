//! How much has separated: length, area and number of cracks, and where they have come to.

use fractum_dem::crack_shape::Axis;
use fractum_fem::{SeparatedElement, SeparatedFacet, Separation, cracks};
use fractum_math::{Vec3, numbered_parts};

use crate::interfaces::InterfaceFace;
use crate::measure::crack_measure::{CrackMeasure, InsideCracks, measure_crack};
use crate::measure::probe::{Probe, ProbeNeeds, ProbedScene};
use crate::scene::Scene;

/// How the crack lies: the edges that have lost at least half of their strength, and the broken bonds; not a number
/// where there are none. Or how much has separated: removed elements, and broken bonds.
#[derive(Clone, Debug, PartialEq)]
pub struct CrackProbe {
    /// What about it.
    pub measure: CrackMeasure,
    /// Direction, and the point of it that a helix or cone needs.
    pub axis: Axis,
    /// Which edges, elements and bonds count; all if absent.
    pub inside: Option<InsideCracks>,
}

impl Probe for CrackProbe {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        let (scene, measure, inside) = (probed.scene, self.measure, self.inside.as_ref());
        if measure.is_of_separation() {
            return measure_extent(scene, probed.separation(), measure, &self.axis.direction, inside);
        }
        measure_crack(scene, probed.crack_edges(), measure, &self.axis, inside)
    }

    fn needs(&self, _: &Scene) -> ProbeNeeds {
        ProbeNeeds { damage: !self.measure.is_of_separation(), ..ProbeNeeds::default() }
    }

    fn is_of_separation(&self) -> bool {
        self.measure.is_of_separation()
    }
}

impl InsideCracks {
    /// Whether an element of a solid counts.
    pub(crate) fn has_element(&self, body: usize, element: u32) -> bool {
        self.elements.get(body).is_some_and(|body| body.get(element as usize) == Some(&true))
    }

    /// Whether a bond of a bonded body counts.
    pub(crate) fn has_bond(&self, body: usize, bond: u32) -> bool {
        self.bonds.get(body).is_some_and(|body| body.get(bond as usize) == Some(&true))
    }
}

/// Removed elements that count.
pub(crate) fn separated_within(separation: &Separation, inside: Option<&InsideCracks>) -> Vec<SeparatedElement> {
    let counts = |of: &&SeparatedElement| inside.is_none_or(|inside| inside.has_element(of.body, of.element));
    separation.elements.iter().filter(counts).copied().collect()
}

/// A number about what has separated: zero before anything has, but for the tip, which then is not a number.
fn measure_extent(
    scene: &Scene,
    separation: &Separation,
    measure: CrackMeasure,
    direction: &Vec3,
    inside: Option<&InsideCracks>,
) -> f64 {
    let facets = separation.facets.iter();
    let facets = facets.filter(|facet| inside.is_none_or(|inside| inside.has_element(facet.body, facet.removed)));
    let bodies = scene.bonded.bodies().iter().enumerate();
    let broken = bodies.flat_map(|(index, body)| body.cracks().iter().map(move |crack| (index, crack)));
    let broken = broken.filter(|(body, crack)| inside.is_none_or(|inside| inside.has_bond(*body, crack.bond)));
    let broken = broken.map(|(_, crack)| crack);
    let solid = &scene.solid;
    // Of the two sides of an interface one counts.
    let counts = |face: &InterfaceFace| {
        let (body, element) = face.elements[0];
        inside.is_none_or(|inside| inside.has_element(body as usize, element))
    };
    let parted = scene.interfaces().broken().filter(|(face, ..)| counts(face));
    match measure {
        CrackMeasure::Length => {
            let parted =
                parted.map(|(face, part, area)| part * area / solid.body(face.elements[0].0 as usize).thickness);
            let depth = |facet: &SeparatedFacet| {
                let body = solid.body(facet.body);
                body.depth().map_or(body.thickness, |depth| depth.at(&solid.element_middle(facet.body, facet.removed)))
            };
            facets.map(|facet| facet.area / depth(facet)).sum::<f64>() + parted.sum::<f64>() + 0.0
        }
        CrackMeasure::Count => {
            let (_, of_solids) = cracks::separate_cracks(solid, &separated_within(separation, inside));
            let pairs: Vec<[u32; 2]> = broken.map(|crack| crack.pair).collect();
            f64::from(of_solids + separate_pairs(pairs))
        }
        CrackMeasure::Tip => {
            let elements = separated_within(separation, inside).into_iter().map(|of| of.middle);
            let middle = |face: &InterfaceFace| {
                let corners = &face.sides[0][..face.corners()];
                corners.iter().map(|&node| solid.reference[node as usize]).sum::<Vec3>() / corners.len() as f64
            };
            let places = elements.chain(broken.map(|crack| crack.position));
            let places = places.chain(parted.map(|(face, ..)| middle(face)));
            places.map(|place| place.dot(direction)).fold(f64::NAN, f64::max)
        }
        _ => {
            let parted: f64 = parted.map(|(_, part, area)| part * area).sum();
            facets.map(|facet| facet.area).sum::<f64>() + broken.map(|crack| crack.area).sum::<f64>() + parted
        }
    }
}

/// Sets of broken bonds that share particles.
fn separate_pairs(pairs: Vec<[u32; 2]>) -> u32 {
    let mut particles: Vec<u32> = pairs.iter().flatten().copied().collect();
    particles.sort_unstable();
    particles.dedup();
    let index = |particle: u32| particles.partition_point(|&other| other < particle) as u32;
    numbered_parts(particles.len(), pairs.iter().map(|pair| pair.map(index))).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bonds_that_share_particles_are_one_crack() {
        assert_eq!(separate_pairs(vec![[7, 3], [9, 20], [3, 4], [20, 21], [40, 41]]), 3);
        assert_eq!(separate_pairs(Vec::new()), 0);
    }
}
