//! What is largest in the cells that carry: rotation, strain, and stress that no criterion looks at.

use std::borrow::Cow;

use fractum_kernels::material::CriterionKind;
use fractum_math::Sym3;
use fractum_math::elementary::asin;
use rayon::prelude::*;

use crate::body::{DamageZone, Kinematics, Region};
use crate::cells::kernel::strain;
use crate::element::CARRIES;
use crate::motion::turning::turn;
use crate::solid::Solid;
use crate::solid::body_model::BodyModel;
use crate::solid::evaluate::{Block, BlockLaw};

/// A largest value, and where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extreme {
    /// Body.
    pub body: usize,
    /// An element of it.
    pub element: u32,
    /// The value.
    pub value: f64,
}

/// Largest values over the cells of all bodies that carry; none where there is nothing to look at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extremes {
    /// Angle [rad] by which a cell of small strains has turned.
    pub rotation: Option<Extreme>,
    /// Strain [-], the root of the sum of its squares.
    pub strain: Option<Extreme>,
    /// Tensile principal stress over the tensile strength, of cells that the case has kept from damage [-].
    pub tension: Option<Extreme>,
    /// Compressive principal stress over the tensile strength, of cells whose criterion knows tension alone [-].
    pub compression: Option<Extreme>,
}

/// A value of a cell: block and cell.
type Found = Option<(f64, u32, u32)>;

/// The larger of two; of equal ones the first.
fn larger(a: Found, b: Found) -> Found {
    match (a, b) {
        (Some(first), Some(second)) if second.0 > first.0 => Some(second),
        (None, b) => b,
        (a, _) => a,
    }
}

/// Largest values of the present displacements.
pub fn extremes(solid: &Solid) -> Extremes {
    let of_blocks: Vec<[Found; 4]> =
        (0..solid.blocks.len() as u32).into_par_iter().map(|block| extremes_of(solid, block)).collect();
    let all = of_blocks.into_iter().fold([None; 4], |mut all, own| {
        all.iter_mut().zip(own).for_each(|(all, own)| *all = larger(*all, own));
        all
    });
    let [rotation, strain, tension, compression] = all.map(|found| {
        let (value, block, cell) = found?;
        let own = &solid.blocks[block as usize];
        Some(Extreme { body: own.body, element: element_around(solid, own, cell as usize), value })
    });
    Extremes { rotation, strain, tension, compression }
}

fn extremes_of(solid: &Solid, index: u32) -> [Found; 4] {
    let mut found: [Found; 4] = [None; 4];
    let block = &solid.blocks[index as usize];
    let model = &solid.bodies[block.body];
    let small = model.body.kinematics != Kinematics::Corotational;
    let zone = model.body.damage.as_ref();
    let kept_whole = zone.filter(|zone| match block.law {
        BlockLaw::Elastic => model.smoothed_edges().is_some(),
        BlockLaw::Standard(_) => matches!(zone.region, Region::Edges(_)),
        _ => false,
    });
    let in_tension = zone.filter(|zone| zone.law.criterion.kind() == CriterionKind::Rankine);
    for cell in 0..block.cells.len() {
        if block.cells.volume[cell] == 0.0 || block.damage_of(cell) > CARRIES {
            continue;
        }
        let h = block.cells.gradient(cell, |node| solid.displacement[node]);
        if small {
            found[0] = larger(found[0], Some((asin(turn(&h).min(1.0)), index, cell as u32)));
        }
        let elastic = block.cells.elastic_strain(cell, strain(&h, model.body.kinematics));
        found[1] = larger(found[1], Some((norm(elastic), index, cell as u32)));
        let unarmed = kept_whole.filter(|zone| model.may_not_part(zone, block.items[cell]));
        if unarmed.is_none() && in_tension.is_none() {
            continue;
        }
        let stress = model.elasticity.stress(elastic);
        // An element at the border of the region may be damaged in part.
        let carried = 1.0 - block.damage_of(cell);
        // Principal values are found where they may be the largest.
        let bound = norm(stress);
        for (which, zone, sign) in [(2, unarmed, carried), (3, in_tension, -1.0)] {
            let Some(strength) = zone.map(|zone| zone.law.tensile_strength) else { continue };
            if found[which].is_none_or(|(value, ..)| bound > value * strength) {
                let values = stress.principal_values().map(|value| sign * value / strength);
                let largest = values.into_iter().fold(0.0, f64::max);
                found[which] = larger(found[which], Some((largest, index, cell as u32)));
            }
        }
    }
    found
}

/// An element of a cell, a live one if there is one.
fn element_around(solid: &Solid, block: &Block, cell: usize) -> u32 {
    let (model, item) = (&solid.bodies[block.body], block.items[cell]);
    let one = [item];
    let around = model.smoothed_edges().map_or(Cow::Borrowed(&one[..]), |edges| edges.around(item));
    let alive = around.iter().copied().find(|&element| model.alive[element as usize]);
    alive.unwrap_or(around[0])
}

impl BodyModel {
    /// Whether an edge of the smoothed formulation, or an element of the standard one, lies where no crack may part it: of an element no way to
    /// cut it has all of its edges in the region of damage.
    fn may_not_part(&self, zone: &DamageZone, item: u32) -> bool {
        let (Some(standard), Some(edges), Region::Edges(marked)) = (&self.standard, &self.edges, &zone.region) else {
            return true;
        };
        let own = &edges.of_element(item)[..self.body.shape.edge_count()];
        standard.element_damage(own, |edge| f64::from(u8::from(marked[edge as usize]))) < 1.0
    }
}

/// Root of the sum of the squares of all components.
fn norm(tensor: Sym3) -> f64 {
    tensor.dot(tensor).sqrt()
}

#[cfg(test)]
mod tests {
    use fractum_kernels::material::{DamageLaw, Elastic};
    use fractum_math::Vec3;
    use fractum_math::elementary::{cos, sin};
    use fractum_mesh::generate::structured_box;

    use super::*;
    use crate::body::{Body, ElementKind};

    fn cube(change: impl FnOnce(&mut Body)) -> Solid {
        let mesh = structured_box([2; 3], Vec3::repeat(1.0), None);
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.0 };
        let mut body = Body::new("box", ElementKind::T4, mesh.tetrahedra, elastic);
        change(&mut body);
        Solid::new(mesh.nodes, vec![body]).unwrap()
    }

    fn moved(solid: &mut Solid, displacement: impl Fn(Vec3) -> Vec3) {
        solid.displacement = solid.reference.iter().map(|x| displacement(*x)).collect();
    }

    #[test]
    fn a_rotation_is_found_where_strains_are_small_and_no_strain_where_cells_turn() {
        let turned = |angle: f64| {
            move |x: Vec3| Vec3::new(x.x * cos(angle) - x.y * sin(angle), x.x * sin(angle) + x.y * cos(angle), x.z) - x
        };
        for angle in [0.01, 0.1, 0.3] {
            let mut solid = cube(|_| {});
            moved(&mut solid, turned(angle));
            let rotation = extremes(&solid).rotation.unwrap();
            assert!((rotation.value / angle - 1.0).abs() < 1e-9, "{rotation:?}");
            let mut solid = cube(|body| body.kinematics = Kinematics::Corotational);
            moved(&mut solid, turned(angle));
            let found = extremes(&solid);
            assert!(found.rotation.is_none() && found.strain.unwrap().value < 1e-12, "{found:?}");
        }
    }

    #[test]
    fn stress_is_looked_at_where_no_criterion_does() {
        let law = DamageLaw::rankine(3e6, 200.0);
        for smoothed in [true, false] {
            let with_damage = |body: &mut Body| {
                let kind = if smoothed { body.clone().smoothed() } else { body.clone() };
                *body = kind.with_damage(law.clone());
            };
            let guarded = |body: &mut Body| {
                with_damage(body);
                let nodes = structured_box([2; 3], Vec3::repeat(1.0), None).nodes;
                let count = Solid::new(nodes, vec![body.clone()]).unwrap().body_edges(0).unwrap().len();
                let Some(zone) = &mut body.damage else { return };
                zone.region = Region::Edges(vec![false; count]);
            };
            let mut solid = cube(guarded);
            // Uniaxial strain of 2 ft/E in tension, then of 10 ft/E in compression.
            moved(&mut solid, |x| Vec3::new(2e-4 * x.x, 0.0, 0.0));
            let found = extremes(&solid);
            assert!((found.tension.unwrap().value - 2.0).abs() < 1e-9, "{found:?}");
            // Principal values that are equal are found to the root of rounding.
            assert!(found.compression.unwrap().value.abs() < 1e-7, "{found:?}");
            assert!((found.strain.unwrap().value / 2e-4 - 1.0).abs() < 1e-9);
            moved(&mut solid, |x| Vec3::new(-1e-3 * x.x, 0.0, 0.0));
            let found = extremes(&solid);
            assert!(found.tension.unwrap().value.abs() < 1e-7, "{found:?}");
            assert!((found.compression.unwrap().value - 10.0).abs() < 1e-9, "{found:?}");
            // A body that may be damaged everywhere needs no look in tension.
            let mut solid = cube(with_damage);
            moved(&mut solid, |x| Vec3::new(2e-4 * x.x, 0.0, 0.0));
            assert!(extremes(&solid).tension.is_none());
        }
    }

    #[test]
    fn elements_of_the_standard_formulation_are_looked_at_where_no_crack_may_part_them() {
        let mesh = structured_box([2; 3], Vec3::repeat(1.0), None);
        // Edges in the lower half may be damaged; strain grows with z in one half of the body and with -z in the other.
        let region = |body: &mut Body| {
            *body = body.clone().with_damage(DamageLaw::rankine(3e6, 200.0));
            let edges = Solid::new(mesh.nodes.clone(), vec![body.clone()]).unwrap();
            let low = |edge: u32| {
                let [a, b] = edges.body_edges(0).unwrap().nodes(edge);
                mesh.nodes[a as usize].z + mesh.nodes[b as usize].z < 1.0 + 1e-9
            };
            let marked = (0..edges.body_edges(0).unwrap().len() as u32).map(low).collect();
            let Some(zone) = &mut body.damage else { return };
            zone.region = Region::Edges(marked);
        };
        let tension = |top: bool| {
            let mut solid = cube(region);
            let strain = |z: f64| if top { 4e-4 * (z - 0.5).max(0.0) } else { 4e-4 * (0.5 - z).max(0.0) };
            moved(&mut solid, |x| Vec3::new(strain(x.z) * x.x, 0.0, 0.0));
            extremes(&solid).tension.unwrap().value
        };
        assert!(tension(true) > 1.0 && tension(false) < 1e-7, "{} {}", tension(true), tension(false));
    }
}
