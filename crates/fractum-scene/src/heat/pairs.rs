//! Who conducts heat to whom: edges of elements, sides of interfaces that touch, and bonds.

use std::fmt::Display;

use fractum_fem::{Solid, motion};
use fractum_heat::{HeatNetwork, PackedSphere, effective_conductivity};
use fractum_math::Vec3;

use super::ThermalMaterial;
use super::across::Crossings;
use crate::bonded::{Bonded, BondedBody};
use crate::error::SceneError;
use crate::interfaces::Interfaces;

/// How the particles of a bonded body conduct.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PackingConduction {
    /// By the published table alone.
    Table,
    /// By the table, times what makes body and material alike: conductances by the conductivity of the body, found from one
    /// solution at rest along its longest side, and heat capacities by its mass.
    Measured,
}

/// How a bonded body conducts.
#[derive(Clone, Debug, PartialEq)]
pub struct PackingReport {
    /// Name of the body.
    pub name: String,
    /// Conductivity by the table over that of the material; NaN where it was not found.
    pub conductivity: f64,
    /// Heat capacity by the table over that of its mass.
    pub capacity: f64,
    /// Whether both were corrected.
    pub corrected: bool,
}

/// The pairs of all bodies, with what makes their conductances.
#[derive(Clone, Debug)]
pub(super) struct Pairs {
    pairs: Vec<[u32; 2]>,
    conductances: Vec<f64>,
    /// What each element gives to its pairs, body by body and element by element.
    parts: Vec<(u32, f64)>,
    /// Sides of interfaces, and the pair of each corner.
    crossings: Crossings,
    across: Vec<u32>,
    /// Conductances of the bonds, body by body, and the first pair that is a bond.
    bonds: Vec<f64>,
    first_bond: usize,
    /// Bonds that had broken when conductances were found.
    broken: usize,
    solids: Vec<ThermalMaterial>,
    /// Heat capacities of the particles [J/K].
    particles: Vec<f64>,
    packings: Vec<PackingReport>,
}

impl Pairs {
    pub(super) fn new(
        solid: &Solid,
        bonded: &Bonded,
        crossings: Crossings,
        solids: &[ThermalMaterial],
        of_bonded: &[ThermalMaterial],
        packing: PackingConduction,
    ) -> Result<Self, SceneError> {
        let mut all: Vec<([u32; 2], f64)> = Vec::new();
        for (body, material) in solids.iter().enumerate() {
            for element in 0..solid.body(body).elements.len() as u32 {
                let own = motion::element_conduction(solid, body, element);
                all.extend(own.map(|([i, j], g)| ([i.min(j), i.max(j)], g * material.conductivity)));
            }
        }
        let mut pairs: Vec<[u32; 2]> = all.iter().map(|(pair, _)| *pair).chain(crossings.pairs()).collect();
        pairs.sort_unstable();
        pairs.dedup();
        let place = |pair: &[u32; 2]| pairs.binary_search(pair).unwrap_or_default() as u32;
        let parts = all.iter().map(|(pair, g)| (place(pair), *g)).collect();
        let across = crossings.pairs().map(|pair| place(&pair)).collect();
        let (first_bond, nodes) = (pairs.len(), solid.reference.len() as u32);
        let mut found = Pairs {
            conductances: Vec::new(),
            parts,
            crossings,
            across,
            bonds: Vec::new(),
            first_bond,
            broken: usize::MAX,
            solids: solids.to_vec(),
            particles: bonded.particles.mass.clone(),
            packings: Vec::new(),
            pairs,
        };
        for (body, material) in bonded.bodies().iter().zip(of_bonded) {
            found.add_packing(bonded, body, material, packing)?;
            found.pairs.extend(body.bonds.pairs().iter().map(|pair| pair.map(|i| i + nodes)));
        }
        found.conductances = vec![0.0; found.pairs.len()];
        found.update(solid, bonded);
        Ok(found)
    }

    /// Capacities and conductances of a bonded body.
    fn add_packing(
        &mut self,
        bonded: &Bonded,
        body: &BondedBody,
        material: &ThermalMaterial,
        packing: PackingConduction,
    ) -> Result<(), SceneError> {
        let (particles, range) = (&bonded.particles, body.range.clone());
        let start = range.start as u32;
        let mut neighbours = vec![0usize; range.len()];
        body.bonds.pairs().iter().flatten().for_each(|&i| neighbours[(i - start) as usize] += 1);
        let spheres: Vec<PackedSphere> = neighbours.iter().map(|&n| PackedSphere::of(n)).collect();
        let mut conductances: Vec<f64> = (0..body.bonds.len())
            .map(|bond| {
                let ends = body.bonds.pairs()[bond];
                let radius = ends.map(|i| particles.radius[i as usize]);
                let of = ends.map(|i| spheres[(i - start) as usize]);
                PackedSphere::conductance(of, radius, body.bonds.length(bond), material.conductivity)
            })
            .collect();
        let mass = &particles.mass[range.clone()];
        let mut capacity: Vec<f64> = spheres
            .iter()
            .zip(&particles.radius[range.clone()])
            .zip(mass)
            .map(|((sphere, &radius), mass)| {
                material.capacity * sphere.volume(radius).map_or(*mass, |volume| body.density * volume)
            })
            .collect();
        let total: f64 = mass.iter().sum();
        let heavy = capacity.iter().sum::<f64>() / (material.capacity * total);
        let local: Vec<[u32; 2]> = body.bonds.pairs().iter().map(|pair| pair.map(|i| i - start)).collect();
        let network = HeatNetwork::new(capacity.clone(), &local, &conductances);
        let places = &bonded.reference()[range.clone()];
        let mean = particles.radius[range.clone()].iter().sum::<f64>() / range.len() as f64;
        let found = effective_conductivity(&network, places, longest_axis(places), 2.0 * mean, total / body.density);
        let conducts = ratio_of_packing(packing, &body.name, found.map(|lambda| lambda / material.conductivity))?;
        let corrected = packing == PackingConduction::Measured && conducts > 0.0 && heavy > 0.0;
        if corrected {
            conductances.iter_mut().for_each(|g| *g /= conducts);
            capacity.iter_mut().for_each(|c| *c /= heavy);
        }
        self.particles[range].copy_from_slice(&capacity);
        self.bonds.append(&mut conductances);
        let name = body.name.clone();
        self.packings.push(PackingReport { name, conductivity: conducts, capacity: heavy, corrected });
        Ok(())
    }

    pub(super) fn pairs(&self) -> &[[u32; 2]] {
        &self.pairs
    }

    pub(super) fn conductances(&self) -> &[f64] {
        &self.conductances
    }

    pub(super) fn packings(&self) -> &[PackingReport] {
        &self.packings
    }

    /// Heat capacities of nodes and particles [J/K].
    pub(super) fn capacity(&self, solid: &Solid, bonded: &Bonded) -> Vec<f64> {
        let of_body = |(body, material): (usize, &ThermalMaterial)| {
            let (own, per_mass) = (solid.body(body), material.capacity);
            let mass = move |element: u32| own.elastic.density * solid.element_volume(body, element);
            (0..own.elements.len() as u32).map(move |element| (body, element, per_mass * mass(element)))
        };
        let mut capacity = solid.lumped(self.solids.iter().enumerate().flat_map(of_body));
        debug_assert_eq!(self.particles.len(), bonded.particles.len());
        capacity.extend(&self.particles);
        capacity
    }

    /// Whether bonds have broken since the conductances were found.
    pub(super) fn has_lost_bonds(&self, bonded: &Bonded) -> bool {
        self.broken != bonded.bond_counts().1
    }

    /// Looks which sides of interfaces touch; whether any has met or parted.
    pub(super) fn look(&mut self, solid: &Solid, interfaces: &Interfaces) -> bool {
        self.crossings.look(solid, interfaces)
    }

    /// Finds the conductances from the elements, sides of interfaces and bonds that are left; nothing conducts through a crack.
    pub(super) fn update(&mut self, solid: &Solid, bonded: &Bonded) {
        self.conductances.fill(0.0);
        let mut parts = self.parts.iter();
        for body in 0..self.solids.len() {
            let corners = solid.body(body).shape.node_count();
            for alive in solid.alive(body) {
                for (pair, g) in parts.by_ref().take(corners * (corners - 1) / 2) {
                    self.conductances[*pair as usize] += if *alive { *g } else { 0.0 };
                }
            }
        }
        for (pair, conductance) in self.across.iter().zip(self.crossings.conductances()) {
            self.conductances[*pair as usize] += conductance;
        }
        let mut bond = 0;
        for body in bonded.bodies() {
            for own in 0..body.bonds.len() {
                let live = body.is_joined(own);
                self.conductances[self.first_bond + bond] = if live { self.bonds[bond] } else { 0.0 };
                bond += 1;
            }
        }
        self.broken = bonded.bond_counts().1;
    }
}

/// The conductivity of a packing over that of its material, NaN where it was not found but is told only.
fn ratio_of_packing(
    packing: PackingConduction,
    body: &str,
    found: Result<f64, impl Display>,
) -> Result<f64, SceneError> {
    match (found, packing) {
        (Ok(ratio), _) => Ok(ratio),
        (Err(_), PackingConduction::Table) => Ok(f64::NAN),
        (Err(error), PackingConduction::Measured) => {
            Err(SceneError::PackingConduction { body: body.to_owned(), reason: error.to_string() })
        }
    }
}

/// The axis along which places reach farthest.
fn longest_axis(places: &[Vec3]) -> usize {
    let extent = |axis: usize| {
        let along = places.iter().map(|place| place[axis]);
        along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
    };
    (1..3).fold(0, |longest, axis| if extent(axis) > extent(longest) { axis } else { longest })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_does_without_the_conductivity_of_the_packing() {
        let [table, measured] = [PackingConduction::Table, PackingConduction::Measured]
            .map(|packing| ratio_of_packing(packing, "box", Err("not solved")));
        assert!(table.unwrap().is_nan());
        assert!(measured.unwrap_err().to_string().contains("body box: the conductivity of its packing was not found"));
    }
}
