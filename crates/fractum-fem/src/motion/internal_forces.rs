//! Internal forces of a solid, and the damage that comes with them.

use rayon::prelude::*;

use crate::motion::phase_damage::update_phase_fields;
use crate::motion::subcycled_solid::keep_internal;
use crate::solid::evaluate::BlockLaw;
use crate::solid::{BodyModel, Solid};

impl Solid {
    /// Replaces `force` by the internal forces of the present displacements, and advances damage.
    ///
    /// - `dt`: time since the last call [s] (for rate-dependent laws)
    /// - `measure`: whether to sum the elastic energy, see [`Solid::elastic_energy`]
    pub fn update_internal_forces(&mut self, dt: f64, measure: bool) {
        load_standard_edges(self, dt);
        update_phase_fields(self, dt);
        damage_standard_elements(self);
        let (subcycling, displacement, velocity) =
            (self.subcycling.take(), std::mem::take(&mut self.displacement), std::mem::take(&mut self.velocity));
        self.evaluate_own(|bodies, index, block| {
            let dt = match &subcycling {
                Some(subcycling) if subcycling.is_ahead(index) => return,
                Some(subcycling) if block.is_fine => dt / subcycling.parts_before(),
                _ => dt,
            };
            block.evaluate(&bodies[block.body], &displacement, &velocity, dt, measure);
        });
        (self.subcycling, self.displacement, self.velocity) = (subcycling, displacement, velocity);
        self.with_neighbours(|neighbours, solid| neighbours.exchange_cells(solid, measure));
        let Solid { blocks, .. } = self;
        let power: f64 = blocks.iter().map(|b| b.viscous_power).sum();
        self.viscous_dissipation += power * dt;
        self.gather_forces();
        keep_internal(self);
    }
}

/// First passes of bodies with damage in the standard formulation: element stress, edge histories.
fn load_standard_edges(solid: &mut Solid, dt: f64) {
    if solid.bodies.iter().all(|b| b.standard.is_none()) {
        return;
    }
    let Solid { displacement, blocks, bodies, .. } = solid;
    blocks.par_iter_mut().for_each(|block| block.effective_stress(&bodies[block.body], displacement));
    for model in bodies {
        let BodyModel { standard: Some(standard), alive, location, .. } = model else { continue };
        standard.update_edges(dt, alive, |element| {
            let (block, cell) = location.of(element);
            (blocks[block as usize].standard_cells(), cell as usize)
        });
        for element in standard.elements_of_growth() {
            let (block, cell) = location.of(element);
            if let BlockLaw::Standard(law) = &mut blocks[block as usize].law {
                law.expect_damage(cell as usize);
            }
        }
    }
}

/// Gives the elements of the standard formulation the damage of their edges, where that may have grown.
fn damage_standard_elements(solid: &mut Solid) {
    let Solid { blocks, bodies, .. } = solid;
    for (index, model) in bodies.iter().enumerate() {
        let BodyModel { standard: Some(standard), edges: Some(edges), .. } = model else { continue };
        blocks.par_iter_mut().filter(|b| b.body == index).for_each(|block| {
            let edge = |edge: u32| &standard.field.state[edge as usize];
            block.take_element_damage(|element| {
                let of = edges.of_element(element);
                let own = &of[..standard.shape.edge_count()];
                let least_seen = own.iter().map(|&e| edge(e).kappa).fold(f64::INFINITY, f64::min);
                (standard.element_damage(own, |e| edge(e).damage), least_seen)
            });
        });
    }
}
