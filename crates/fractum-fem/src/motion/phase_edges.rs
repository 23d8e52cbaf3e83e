//! The edges that take part in the phase fields of a solid.

use crate::cells::cell::Geometry;
use crate::damage::phase::{Patch, PhaseField};
use crate::solid::{BodyModel, Solid};

impl Solid {
    /// Lets every edge take part in the phase field of its body, as a search for equilibrium needs it.
    pub fn wake_phase_fields(&mut self) {
        self.for_each_phase_field(|solid, body, field| {
            let edges = (0..field.value.len() as u32).filter(|&edge| !field.is_active(edge)).collect::<Vec<u32>>();
            solid.activate(body, field, &edges);
        });
    }

    /// Activates the edges that have passed their strength in the last forces.
    pub(crate) fn wake(&mut self, body: usize, field: &mut PhaseField) {
        let (mut woken, mut any) = (Vec::new(), false);
        let own = self.own_blocks();
        let Solid { blocks, bodies, neighbours, .. } = self;
        let blocks = blocks.iter_mut().enumerate().filter(|(_, block)| block.body == body);
        for (cells, is_own) in blocks.filter_map(|(index, block)| Some((block.edge_field_mut()?, own.contains(&index))))
        {
            if std::mem::take(&mut cells.woken) {
                any = true;
                woken.extend(is_own.then(|| cells.above_strength()).into_iter().flatten());
            }
        }
        if any {
            woken = neighbours.gather_names(woken);
        }
        // Every process finds the edges of the standard formulation.
        if let Some(standard) = &mut bodies[body].standard
            && std::mem::take(&mut standard.field.woken)
        {
            woken.extend(standard.field.above_strength());
        }
        self.activate(body, field, &woken);
    }

    /// Activates those of these edges that may be damaged and are not active yet.
    pub(crate) fn activate(&self, body: usize, field: &mut PhaseField, edges: &[u32]) {
        let model = &self.bodies[body];
        let Some(patch) = self.patch(model) else { return };
        for &edge in edges {
            let strength = self.edge(body, edge).map_or(f64::INFINITY, |(cells, cell)| cells.strength[cell]);
            if strength.is_finite() && !field.is_active(edge) {
                let block = (!model.needs_all_cells()).then(|| model.location.of(edge).0 as usize);
                let rank = block.map_or(0, |block| self.neighbours.owner(block));
                field.activate(&patch, (edge, rank), field.law.a1(strength));
                block.into_iter().for_each(|block| field.wake_block(block));
            }
        }
    }

    fn patch<'a>(&'a self, model: &'a BodyModel) -> Option<Patch<'a>> {
        let geometry = Geometry { body: &model.body, nodes: &self.reference };
        let BodyModel { edges, alive, .. } = model;
        Some(Patch { geometry, edges: edges.as_ref()?, alive })
    }

    /// Takes the share of removed elements out of the phase field of a body.
    ///
    /// - `edges`: those of the elements
    pub(crate) fn refresh_phase(&mut self, body: usize, edges: &[u32]) {
        let Some(mut field) = self.bodies[body].phase.take() else { return };
        if let Some(patch) = self.patch(&self.bodies[body]) {
            field.refresh(&patch, edges);
        }
        self.bodies[body].phase = Some(field);
    }

    /// Puts the saved phase field of a body back, for the elements that are there.
    pub(crate) fn restore_phase(&mut self, body: usize, state: &[(u32, [f64; 2], bool)]) {
        let Some(mut field) = self.bodies[body].phase.take() else { return };
        field.clear();
        for &(edge, values, rebuilt) in state {
            self.activate(body, &mut field, &[edge]);
            field.restore_last(values, rebuilt);
        }
        self.bodies[body].phase = Some(field);
    }
}
