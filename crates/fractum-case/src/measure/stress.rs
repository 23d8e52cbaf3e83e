//! Volume mean of a stress component over elements, or virial stress of particles [Pa].

use fractum_scene::{Along, NeededPoints, Probe, ProbeNeeds, ProbedScene, RegionStress, Scene};

use super::Measure;
use super::scenery::Scenery;
use super::tables::{StressComponent, stress_or_strain};
use crate::Spanned;
use crate::key_kind::{KeyDoc, KeyKind as K, key, names};
use crate::reader::Table;
use crate::selection::{GroupUse, Selection};
use crate::unit::Dimension as D;

/// Volume mean of a stress component over elements, or virial stress of particles [Pa].
#[derive(Debug, Clone, PartialEq)]
pub struct Stress {
    /// Elements by their middles, or particles.
    pub on: Selection,
    /// Normal of the plane, and direction of the stress on it.
    pub between: [Along; 2],
}

impl Measure for Stress {
    const KEY: &'static str = "stress";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].stress", K::Table, "", "Mean stress over elements by their volumes; or virial stress of particles, which is that of the bonds of these particles over their volume; in Pa"),
        key("probes[].stress.group", K::Text, "", "Mesh group of elements, or set of particles of a bonded body; required without `where`"),
        key("probes[].stress.where", K::Condition, "", "Which elements, by their middles, or particles, by their positions at the start; without `group`: which elements of all solid bodies"),
        key("probes[].stress.component", K::Choice(names::<StressComponent>), "required", "Component; tension is positive"),
        key("probes[].stress.about", K::Table, "", "radial, tangential and radial_tangential only: the axis"),
        key("probes[].stress.about.point", K::Point(D::LENGTH), "[0, 0, 0]", "A point of it"),
        key("probes[].stress.about.axis", K::Direction, "\"z\"", "Its direction"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        let (on, between, ()) = stress_or_strain(probe.table(Self::KEY)?, |_| Some(()))?;
        Some((Stress { on, between }, D::PRESSURE))
    }

    fn group(&self) -> Option<(&Spanned<String>, GroupUse)> {
        self.on.used_as(GroupUse::ProbeElements)
    }

    fn may_be_particles(&self) -> Option<&Selection> {
        Some(&self.on)
    }

    fn resolve(&self, scene: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        if let Some(particles) = scene.names.particles(&self.on) {
            return Some(Box::new(RegionStress::new(scene.bonded, &particles, self.between)));
        }
        Some(Box::new(OfElements { elements: scene.names.elements(&self.on), between: self.between }))
    }
}

/// Part of the elements of a body from which a probe looks at all of them: a smoothed edge has several elements, and further
/// probes find them done.
const MANY: usize = 8;

/// Volume mean over elements, but for those of bodies that have left or have not come in yet; not a number where no other is left.
#[derive(Debug)]
struct OfElements {
    /// Bodies and their elements.
    elements: Vec<(usize, u32)>,
    /// The stress on a plane with the first normal along the second, at the middle of the element without load.
    between: [Along; 2],
}

impl Probe for OfElements {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        let (solid, [normal, along]) = (&probed.scene.solid, &self.between);
        let (mut sum, mut volume) = (0.0, 0.0);
        let is_out = |body: usize| probed.scene.left().elements > 0 && !solid.alive(body).contains(&true);
        let out: Vec<bool> = (0..solid.body_count()).map(is_out).collect();
        let many = |body: usize| MANY * self.elements.len() >= solid.body(body).elements.len();
        for &(body, element) in self.elements.iter().filter(|(body, _)| !out[*body]) {
            let v = solid.element_volumes(body)[element as usize];
            let middle = solid.element_middle(body, element);
            let stress = probed.stress(body, element, many(body)).to_matrix();
            sum += v * normal.at(&middle).dot(&(stress * along.at(&middle)));
            volume += v;
        }
        if volume > 0.0 { sum / volume } else { f64::NAN }
    }

    fn needs(&self, _: &Scene) -> ProbeNeeds {
        ProbeNeeds { nodes: NeededPoints::Any, damage: true, ..ProbeNeeds::default() }
    }
}
