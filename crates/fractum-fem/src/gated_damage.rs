//! The crack-plane gates of a solid at work: crack points of damaged edges, and edges that open and close.

use std::collections::{BTreeMap, BTreeSet};

use fractum_math::Vec3;
use rayon::prelude::*;

use crate::damage::EdgeField;
use crate::evaluate::Block;
use crate::gate::{Cracked, Gate, Key, around, key};
use crate::solid::{BodyModel, Solid};

impl Solid {
    /// Whether some body has a crack-plane gate.
    pub fn has_gates(&self) -> bool {
        self.bodies.iter().any(|model| model.gate.is_some())
    }

    /// Gives edges that have become damaged their crack points, and opens and closes the intact edges near cracks.
    pub fn update_gates(&mut self) {
        for body in 0..self.bodies.len() {
            let Some(mut gate) = self.bodies[body].gate.take() else { continue };
            self.update_gate(body, &mut gate);
            self.bodies[body].gate = Some(gate);
            self.close_edges(body);
        }
    }

    fn update_gate(&self, body: usize, gate: &mut Gate) {
        let model = &self.bodies[body];
        let mut damaged = Vec::new();
        for block in self.blocks.iter().filter(|block| block.body == body) {
            let Some(field) = block.edge_field() else { continue };
            damaged.extend(field.edges.iter().zip(&field.state).filter(|(_, e)| e.damage > 0.0).map(|(&edge, _)| edge));
        }
        if damaged.is_empty() {
            return;
        }
        damaged.sort_unstable();
        let (known, fresh): (Vec<u32>, Vec<u32>) = damaged.into_iter().partition(|&e| gate.point[e as usize].is_some());
        let mut near: BTreeMap<Key, Vec<Cracked>> = BTreeMap::new();
        let add = |near: &mut BTreeMap<Key, Vec<Cracked>>, gate: &Gate, edge: u32| {
            let key = key(gate.middle[edge as usize], gate.cell);
            near.entry(key).or_default().extend(self.cracked(model, gate, edge));
        };
        for &edge in &known {
            add(&mut near, gate, edge);
        }
        let points: Vec<Vec3> = fresh
            .iter()
            .map(|&edge| {
                let place = gate.middle[edge as usize];
                gate.plane(edge, &near).map_or(place, |(x, n)| place - n * (place - x).dot(&n))
            })
            .collect();
        for (&edge, point) in fresh.iter().zip(points) {
            gate.point[edge as usize] = Some(point);
            add(&mut near, gate, edge);
        }
        let looked_at: BTreeSet<Key> = near.keys().flat_map(|&key| around(key)).collect();
        let intact: Vec<u32> = looked_at
            .iter()
            .filter_map(|key| gate.grid.get(key))
            .flatten()
            .copied()
            .filter(|&edge| gate.point[edge as usize].is_none())
            .collect();
        let closed: Vec<bool> = intact
            .par_iter()
            .map(|&edge| gate.plane(edge, &near).is_some_and(|(x, n)| !self.is_cut(model, edge, x, n)))
            .collect();
        gate.closed.fill(false);
        for (&edge, closed) in intact.iter().zip(closed) {
            gate.closed[edge as usize] = closed;
        }
    }

    fn cracked(&self, model: &BodyModel, gate: &Gate, edge: u32) -> Option<Cracked> {
        let (block, cell) = model.location[edge as usize];
        let (block, cell) = (&self.blocks[block as usize], cell as usize);
        let state = &block.edge_field()?.state[cell];
        let strain = block.strain_of(cell, model.body.kinematics, &self.displacement);
        Some(Cracked {
            middle: gate.middle[edge as usize],
            point: gate.point[edge as usize]?,
            opening: block.cells.volume[cell] * state.damage * state.kappa / model.body.elastic.young_modulus,
            nominal: model.hooke.stress(strain) * (1.0 - state.damage),
        })
    }

    /// Whether the plane through `point` with the normal `normal` cuts the elements around an edge.
    fn is_cut(&self, model: &BodyModel, edge: u32, point: Vec3, normal: Vec3) -> bool {
        let (block, cell) = model.location[edge as usize];
        let cells = &self.blocks[block as usize].cells;
        let heights = cells.global_nodes(cell as usize).map(|node| (self.reference[node] - point).dot(&normal));
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        low < 0.0 && high > 0.0
    }

    /// Lets the thresholds of intact edges follow the gate: no stress passes that of a closed one.
    pub(crate) fn close_edges(&mut self, body: usize) {
        let Solid { bodies, blocks, .. } = self;
        let Some(gate) = &bodies[body].gate else { return };
        let blocks = blocks.iter_mut().filter(|block| block.body == body);
        for EdgeField { edges, state, threshold, .. } in blocks.filter_map(Block::edge_field_mut) {
            for ((&edge, state), threshold) in edges.iter().zip(state).zip(threshold) {
                *threshold = if gate.is_closed(edge) { f64::INFINITY } else { state.threshold() };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{Body, ElementKind, Plane};
    use crate::material::{Criterion, DamageLaw, Elastic, Softening};
    use fractum_mesh::generate::structured_rectangle;

    const H: f64 = 0.01;

    /// A square plate of 11 x 11 cells that has been torn along x = 0 in its lower half, with the displacement after
    /// which the upper half is strained by `ahead` strengths.
    fn torn_plate(gate: bool, ahead: f64) -> Solid {
        let mesh = structured_rectangle([11, 11], [11.0 * H, 11.0 * H], None);
        let centred: Vec<Vec3> = mesh.nodes.iter().map(|p| p - Vec3::new(5.5 * H, 5.5 * H, 0.0)).collect();
        let elements = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.0 };
        let law = DamageLaw {
            criterion: Criterion::rankine(),
            tensile_strength: 3e6,
            fracture_energy: 100.0,
            softening: Softening::Exponential,
            residual: 0.02,
            unilateral: false,
            rate_time: 0.0,
        };
        let mut body = Body::new("plate", ElementKind::T3, elements, elastic).smoothed().with_damage(law);
        body.plane = Plane::Stress;
        body.damage.as_mut().unwrap().crack_plane_gate = gate;
        let mut solid = Solid::new(centred, vec![body]).unwrap();
        let strain = 1e-4;
        for (u, p) in solid.displacement.iter_mut().zip(&solid.reference) {
            u.x = if p.y < 0.0 { p.x.clamp(-0.5 * H, 0.5 * H) * 3.0 * strain } else { 0.0 };
        }
        solid.update_internal_forces(0.0, false);
        solid.update_gates();
        for (u, p) in solid.displacement.iter_mut().zip(&solid.reference) {
            u.x = ahead * strain * p.x;
        }
        solid
    }

    fn damaged(solid: &Solid) -> Vec<Vec3> {
        solid.crack_edges().iter().map(|edge| edge.middle).collect()
    }

    #[test]
    fn edges_beside_a_crack_stay_intact_and_those_in_its_plane_do_not() {
        let mut solid = torn_plate(true, 1.5);
        let before = damaged(&solid);
        assert!(!before.is_empty() && before.iter().all(|p| p.x.abs() < H && p.y < H));
        solid.update_internal_forces(0.0, false);
        let new: Vec<Vec3> = damaged(&solid).into_iter().filter(|p| !before.contains(p)).collect();
        let near = |p: &&Vec3| p.y > 0.0 && p.y < 1.2 * H && p.x.abs() < 2.0 * H;
        assert!(new.iter().filter(near).count() > 0);
        assert!(new.iter().filter(near).all(|p| p.x.abs() < 1.1 * H), "{new:?}");
        // Far from any crack nothing is closed.
        assert!(new.iter().any(|p| p.y > 4.0 * H && p.x > 3.0 * H));
    }

    #[test]
    fn without_gate_all_of_them_are_damaged() {
        let mut solid = torn_plate(false, 1.5);
        solid.update_internal_forces(0.0, false);
        assert!(!solid.has_gates());
        assert_eq!(damaged(&solid).len(), solid.body_edges(0).unwrap().nodes.len());
    }

    #[test]
    fn a_restored_solid_goes_on_alike() {
        let mut first = torn_plate(true, 1.5);
        let mut second = torn_plate(true, 0.0);
        second.restore(Solid::state(&first));
        for solid in [&mut first, &mut second] {
            solid.update_internal_forces(0.0, false);
            solid.update_gates();
        }
        assert_eq!(first.state(), second.state());
        assert!(!first.state().bodies[0].gate.closed.is_empty());
    }
}
