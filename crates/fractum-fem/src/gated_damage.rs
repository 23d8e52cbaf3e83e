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
        for (&edge, closed) in intact.iter().zip(closed) {
            if closed {
                gate.close(edge);
            } else if gate.is_raised(edge) {
                let (present, most) = self.equivalent_stress(model, edge);
                gate.open(edge, present, most);
            }
        }
    }

    /// Present equivalent stress of an edge that may be damaged, and the largest strength that its length allows [Pa].
    fn equivalent_stress(&self, model: &BodyModel, edge: u32) -> (f64, f64) {
        let (block, cell) = model.location[edge as usize];
        let (block, cell) = (&self.blocks[block as usize], cell as usize);
        let strain = block.strain_of(cell, model.body.kinematics, &self.displacement);
        block.edge_field().map_or((0.0, 0.0), |field| {
            let present = field.softens.criterion.equivalent_stress(field.softens.hooke.stress(strain));
            (present, field.softens.largest_strength(field.length[cell]))
        })
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

    /// Lets the strengths of edges follow the gate: no stress passes that of a closed one.
    pub(crate) fn close_edges(&mut self, body: usize) {
        let Solid { bodies, blocks, .. } = self;
        let Some(gate) = &bodies[body].gate else { return };
        let blocks = blocks.iter_mut().filter(|block| block.body == body);
        for EdgeField { edges, state, threshold, strength, .. } in blocks.filter_map(Block::edge_field_mut) {
            for (((&edge, state), threshold), strength) in edges.iter().zip(state).zip(threshold).zip(strength) {
                let gated = gate.strength[edge as usize];
                if gated.is_infinite() {
                    // The removal of an element has damaged some.
                    *threshold = if state.damage == 0.0 { gated } else { state.threshold() };
                    continue;
                }
                *strength = gated;
                if state.damage == 0.0 {
                    state.kappa = gated;
                }
                *threshold = state.threshold();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{Body, ElementKind, Kinematics, Plane};
    use crate::material::{DamageLaw, Elastic};
    use fractum_mesh::generate::structured_rectangle;

    const H: f64 = 0.01;

    /// A square plate of 11 x 11 cells that has been torn along x = 0 in its lower half, with the displacement after
    /// which the upper half is strained by `ahead` strengths.
    fn torn_plate(gate: bool, ahead: f64) -> Solid {
        let mesh = structured_rectangle([11, 11], [11.0 * H, 11.0 * H], None);
        let centred: Vec<Vec3> = mesh.nodes.iter().map(|p| p - Vec3::new(5.5 * H, 5.5 * H, 0.0)).collect();
        let elements = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.0 };
        let law = DamageLaw::rankine(3e6, 100.0);
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

    /// Strains the upper half of a torn plate by `ahead` strengths.
    fn strain_ahead(solid: &mut Solid, ahead: f64) {
        for (u, p) in solid.displacement.iter_mut().zip(&solid.reference) {
            u.x = ahead * 1e-4 * p.x;
        }
        solid.update_internal_forces(0.0, false);
    }

    #[test]
    fn an_edge_whose_gate_opens_starts_from_its_stress() {
        let mut solid = torn_plate(true, 0.0);
        // A gate that is closed in the plane of the crack, where it is about to open.
        let edges = solid.body_edges(0).unwrap().nodes.clone();
        let middle = |[i, j]: [u32; 2]| (solid.reference[i as usize] + solid.reference[j as usize]) * 0.5;
        let ahead = |edge: &[u32; 2]| (middle(*edge) - Vec3::new(0.0, 2.5 * H, 0.0)).norm();
        let edge = (0..edges.len()).min_by(|&a, &b| ahead(&edges[a]).total_cmp(&ahead(&edges[b]))).unwrap() as u32;
        let mut state = Solid::state(&solid);
        state.bodies[0].gate.strength.push((edge, f64::INFINITY));
        solid.restore(state);
        let stress = |solid: &Solid| {
            let (field, cell) = solid.edge(0, edge).unwrap();
            let (block, _) = solid.bodies[0].location[edge as usize];
            let strain = solid.blocks[block as usize].strain_of(cell, Kinematics::Small, &solid.displacement);
            field.softens.opening_stress(strain).0[0] * (1.0 - field.state[cell].damage)
        };
        strain_ahead(&mut solid, 1.5);
        assert!((stress(&solid) / 4.5e6 - 1.0).abs() < 1e-9, "closed: {:e}", stress(&solid));
        solid.update_gates();
        strain_ahead(&mut solid, 1.5001);
        assert!((stress(&solid) / 4.5e6 - 1.0).abs() < 1e-4, "opened: {:e}", stress(&solid));
        strain_ahead(&mut solid, 3.0);
        let softer = stress(&solid);
        assert!(0.5 * 4.5e6 < softer && softer < 0.99 * 4.5e6, "{softer:e}");
        // Damage has made a state for good: nothing brings it back to its own strength.
        solid.update_gates();
        let mut restored = torn_plate(true, 0.0);
        restored.restore(Solid::state(&solid));
        for solid in [&mut solid, &mut restored] {
            strain_ahead(solid, 3.5);
        }
        assert_eq!(Solid::state(&solid), Solid::state(&restored));
    }

    #[test]
    fn an_open_edge_that_unloads_comes_back_to_its_own_strength() {
        let mut solid = torn_plate(true, 1.5);
        solid.update_internal_forces(0.0, false);
        let closed: Vec<u32> = Solid::state(&solid).bodies[0].gate.strength.iter().map(|edge| edge.0).collect();
        let mut gate = solid.bodies[0].gate.take().unwrap();
        for (present, expected) in [(4.5e6, 4.5e6), (4.8e6, 4.5e6), (4.0e6, 4.0e6), (1.0e6, 3.0e6), (4.5e6, 3.0e6)] {
            gate.open(closed[0], present, 1e9);
            assert_eq!(gate.strength[closed[0] as usize], expected);
        }
        gate.open(closed[1], 4.5e6, 3.6e6);
        assert_eq!(gate.strength[closed[1] as usize], 3.6e6, "no snap back");
        gate.open(closed[2], 4.5e6, 2.0e6);
        assert_eq!(gate.strength[closed[2] as usize], 3.0e6, "its own strength in any case");
    }

    #[test]
    fn edges_of_raised_strength_dissipate_the_fracture_energy() {
        let mut solid = torn_plate(true, 0.0);
        let intact = solid.body_edges(0).unwrap().nodes.len() as u32;
        let mut state = Solid::state(&solid);
        for edge in &mut state.bodies[0].edges {
            *edge = crate::damage::EdgeDamage::intact(4.5e6);
        }
        state.dissipated.fill(0.0);
        state.bodies[0].gate.strength = (0..intact).map(|edge| (edge, 4.5e6)).collect();
        solid.restore(state);
        let mut ahead = 1.5;
        while ahead < 600.0 {
            strain_ahead(&mut solid, ahead);
            ahead *= 1.001;
        }
        let surface: f64 = solid.crack_edges().iter().map(|edge| edge.area).sum();
        let ratio = solid.dissipated_energy() / (100.0 * surface);
        assert!((ratio - 1.0).abs() < 2e-3, "{ratio}");
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
        assert!(first.state().bodies[0].gate.strength.iter().any(|edge| edge.1.is_infinite()));
    }
}
