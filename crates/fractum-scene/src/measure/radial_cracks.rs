//! Cracks that run away from a hole: how many, how long, and how far from it all is crushed.

use std::f64::consts::{PI, TAU};

use fractum_dem::crack_shape::Axis;
use fractum_fem::{SeparatedElement, Separation, Solid, cracks};
use fractum_math::Vec3;

use crate::measure::crack_extent::separated_within;
use crate::measure::crack_measure::InsideCracks;
use crate::measure::probe::{Probe, ProbedScene};

/// What a probe measures of radial cracks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RadialMeasure {
    /// Cracks that cross a circle about the axis.
    Count,
    /// Largest extent of one crack away from the axis [m].
    Longest,
    /// Distance from the axis up to which the body is crushed all around; zero if nowhere [m].
    CrushedRadius,
}

/// Cracks that run away from an axis, without load.
#[derive(Clone, Debug, PartialEq)]
pub struct RadialCracks {
    measure: RadialMeasure,
    axis: Axis,
    /// Radius of the circle [m].
    radius: f64,
    inside: Option<InsideCracks>,
    /// Elements that may be crushed with the distances of their middles [m] and their volumes [m³], from the axis outwards.
    outwards: Vec<Ring>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Ring {
    distance: f64,
    volume: f64,
    body: usize,
    element: u32,
}

/// A crack crosses a circle if it goes this part of the radius to both sides of it: neither a lone element on the circle
/// nor a crack along it does.
const CROSSING: f64 = 0.05;

/// Gap between neighbouring directions below which a circle counts as broken all around.
const ALL_AROUND: f64 = PI / 6.0;

/// Share of the volume that is gone where a body is crushed.
const CRUSHED: f64 = 0.9;

impl Probe for RadialCracks {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        self.at_present(&probed.scene.solid, probed.separation())
    }

    fn is_of_separation(&self) -> bool {
        true
    }
}

impl RadialCracks {
    /// - `radius`: of the circle that [`RadialMeasure::Count`] looks at [m]
    /// - `inside`: which elements count; all if absent
    pub fn new(solid: &Solid, measure: RadialMeasure, axis: Axis, radius: f64, inside: Option<InsideCracks>) -> Self {
        let mut outwards = Vec::new();
        let bodies = (0..solid.body_count()).filter(|&body| solid.body(body).damage.is_some());
        for body in bodies.filter(|_| measure == RadialMeasure::CrushedRadius) {
            let elements = 0..solid.body(body).elements.len() as u32;
            let counts = |element: &u32| inside.as_ref().is_none_or(|inside| inside.has_element(body, *element));
            outwards.extend(elements.filter(counts).map(|element| Ring {
                distance: axis.cylindrical(solid.element_middle(body, element)).0,
                volume: solid.element_volume(body, element),
                body,
                element,
            }));
        }
        outwards.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        RadialCracks { measure, axis, radius, inside, outwards }
    }

    /// The number, at present.
    fn at_present(&self, solid: &Solid, separation: &Separation) -> f64 {
        let separated = || separated_within(separation, self.inside.as_ref());
        match self.measure {
            RadialMeasure::Count => f64::from(self.count(solid, separated())),
            RadialMeasure::Longest => self.longest(solid, &separated()),
            RadialMeasure::CrushedRadius => self.crushed_radius(solid),
        }
    }

    /// Least and largest distance of the nodes of an element from the axis [m].
    fn extent(&self, solid: &Solid, of: &SeparatedElement) -> [f64; 2] {
        let body = solid.body(of.body);
        let corners = &body.elements[of.element as usize][..body.shape.node_count()];
        let distances = corners.iter().map(|&node| self.axis.cylindrical(solid.reference[node as usize]).0);
        distances.fold([f64::INFINITY, 0.0], |[least, most], r| [least.min(r), most.max(r)])
    }

    /// Sets of separated elements on the circle that lie in cracks from within to without. A set that lies all around
    /// is no crack.
    fn count(&self, solid: &Solid, separated: Vec<SeparatedElement>) -> u32 {
        let [inner, outer] = [1.0 - CROSSING, 1.0 + CROSSING].map(|factor| factor * self.radius);
        let near: Vec<(SeparatedElement, [f64; 2])> = separated
            .into_iter()
            .map(|of| (of, self.extent(solid, &of)))
            .filter(|(_, [least, most])| *least <= outer && *most >= inner)
            .collect();
        let elements: Vec<SeparatedElement> = near.iter().map(|(of, _)| *of).collect();
        let (part, parts) = cracks::separate_cracks(solid, &elements);
        let reach = reach(near.iter().map(|(_, extent)| *extent), &part, parts);
        let crosses = |part: u32| reach[part as usize][0] <= inner && reach[part as usize][1] >= outer;
        let on_circle = |((of, [least, most]), part): (&(SeparatedElement, [f64; 2]), &u32)| {
            (*least <= self.radius && *most >= self.radius && crosses(*part)).then_some(*of)
        };
        let on_circle: Vec<SeparatedElement> = near.iter().zip(&part).filter_map(on_circle).collect();
        let (set, sets) = cracks::separate_cracks(solid, &on_circle);
        let of_set = |number: u32| on_circle.iter().zip(&set).filter(move |(_, set)| **set == number);
        let is_ring = |number: &u32| self.lies_all_around(of_set(*number).map(|(of, _)| of.middle));
        (0..sets).filter(|number| !is_ring(number)).count() as u32
    }

    fn lies_all_around(&self, places: impl Iterator<Item = Vec3>) -> bool {
        let mut angles: Vec<f64> = places.map(|place| self.axis.cylindrical(place).1).collect();
        angles.sort_by(f64::total_cmp);
        let Some((first, last)) = angles.first().copied().zip(angles.last().copied()) else { return false };
        let gap = angles.windows(2).map(|pair| pair[1] - pair[0]).fold(first + TAU - last, f64::max);
        gap < ALL_AROUND
    }

    fn longest(&self, solid: &Solid, separated: &[SeparatedElement]) -> f64 {
        let (part, parts) = cracks::separate_cracks(solid, separated);
        let reach = reach(separated.iter().map(|of| self.extent(solid, of)), &part, parts);
        reach.iter().map(|[from, to]| to - from).fold(0.0, f64::max)
    }

    /// Outwards, as far as what is gone exceeds its share by the most: where all is gone up to a circle and little beyond
    /// it, that is the circle.
    fn crushed_radius(&self, solid: &Solid) -> f64 {
        let (mut excess, mut largest, mut radius) = (0.0, 0.0, 0.0);
        for Ring { distance, volume, body, element } in &self.outwards {
            let gone = !solid.alive(*body)[*element as usize];
            excess += volume * if gone { 1.0 - CRUSHED } else { -CRUSHED };
            if excess > largest {
                (largest, radius) = (excess, *distance);
            }
        }
        radius
    }
}

/// Least and largest distance of each part of a set of elements.
fn reach(extents: impl Iterator<Item = [f64; 2]>, part: &[u32], parts: u32) -> Vec<[f64; 2]> {
    let mut reach = vec![[f64::INFINITY, 0.0f64]; parts as usize];
    for ([least, most], &part) in extents.zip(part) {
        let [from, to] = &mut reach[part as usize];
        (*from, *to) = (from.min(least), to.max(most));
    }
    reach
}

#[cfg(test)]
mod tests {
    use super::*;
    use fractum_fem::{Body, DamageLaw, Elastic, ElementKind};
    use fractum_math::elementary::sin_cos;
    use fractum_mesh::generate::structured_rectangle;

    const SIDE: f64 = 2.0;
    const CELLS: u32 = 100;
    const SPACING: f64 = SIDE / CELLS as f64;

    /// A plate about the origin without the elements whose middles, away from its centre, are gone.
    fn plate(gone: impl Fn(Vec3) -> bool) -> Solid {
        let law = DamageLaw::rankine(3e6, 1e4);
        let mesh = structured_rectangle([CELLS, CELLS], [SIDE, SIDE], None);
        let elements = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.2 };
        let body = Body::new("plate", ElementKind::T3, elements, elastic).smoothed().with_damage(law);
        let mut solid = Solid::new(mesh.nodes, vec![body]).unwrap();
        let mut state = solid.state();
        for (element, alive) in (0..).zip(&mut state.bodies[0].alive) {
            *alive = !gone(solid.element_middle(0, element) - centre());
        }
        solid.restore(state);
        solid
    }

    fn centre() -> Vec3 {
        Vec3::new(0.5 * SIDE, 0.5 * SIDE, 0.0)
    }

    fn measured(solid: &Solid, measure: RadialMeasure, radius: f64) -> f64 {
        let axis = Axis { point: centre(), direction: Vec3::z() };
        RadialCracks::new(solid, measure, axis, radius, None).at_present(solid, &Separation::of(solid))
    }

    /// On a ray at this angle, from one distance to another.
    fn on_ray(place: &Vec3, angle: f64, [from, to]: [f64; 2]) -> bool {
        let (sin, cos) = sin_cos(angle);
        let along = place.x * cos + place.y * sin;
        (place.y * cos - place.x * sin).abs() < 0.6 * SPACING && along > from && along < to
    }

    #[test]
    fn rays_are_counted_and_rings_are_not() {
        let rays = |place: Vec3| {
            let ring = (place.norm() - 0.8).abs() < SPACING && place.x > 0.3;
            let speck = (place - Vec3::new(0.0, -0.4, 0.0)).norm() < SPACING;
            let rays = (0..5).any(|i| on_ray(&place, 0.2 + 1.2 * f64::from(i), [0.15, 0.35 + 0.1 * f64::from(i)]));
            place.norm() < 0.2 || rays || ring || speck
        };
        let solid = plate(rays);
        let count = |radius| measured(&solid, RadialMeasure::Count, radius);
        assert_eq!([count(0.1), count(0.28), count(0.5), count(0.8)], [0.0, 5.0, 3.0, 0.0]);
        // The crushed disc belongs to the crack.
        let longest = measured(&solid, RadialMeasure::Longest, 0.0);
        assert!((longest - 0.75).abs() < 2.0 * SPACING, "{longest}");
        let crushed = measured(&solid, RadialMeasure::CrushedRadius, 0.0);
        assert!((crushed - 0.2).abs() < SPACING, "{crushed}");
    }

    #[test]
    fn a_sound_plate_has_no_cracks() {
        let solid = plate(|_| false);
        let of = |measure| measured(&solid, measure, 0.5);
        assert_eq!([RadialMeasure::Count, RadialMeasure::Longest, RadialMeasure::CrushedRadius].map(of), [0.0; 3]);
    }
}
