//! One scene that several ranks advance together: which nodes all of them must move, and what they cannot share.

use std::sync::Arc;

use fractum_parallel::Exchange;

use crate::scene::Scene;

impl Scene {
    /// What ranks cannot share of this scene, in words; none where they can.
    pub fn cannot_be_shared(&self) -> Option<&'static str> {
        if self.solid.body_count() == 0 {
            return Some("a scene without solids");
        }
        self.optional.heat.as_ref().map(|_| "heat")
    }

    /// Whether something looks at all nodes in every step. Every rank does alike what is no cell of a solid: particles and their
    /// bonds, contact, rigid bodies, ties and gas.
    fn needs_all_nodes(&self) -> bool {
        let damping = self.settings.damping;
        self.loads.points().is_none()
            || self.loads.gas().is_some()
            || damping.local != 0.0
            || damping.mass_rate != 0.0
            || self.removals.domain.is_some()
            || !self.debris.is_empty()
            || self.solid.fracture().removed_elements > 0
            || !self.bonded.is_empty()
            || !self.contacts.is_empty()
            || !self.shape_contacts.is_empty()
    }

    /// Leaves a share of the cells to each rank of an exchange. Every rank must have the same scene in the same state, and
    /// all of them step it together from then on; see [`Scene::gather_ranks`].
    ///
    /// - `watched`: nodes that are looked at after every step, where that is more than those of supports that move and of loads
    pub fn share_out(&mut self, exchange: Arc<dyn Exchange>, watched: &[u32]) {
        let all = self.needs_all_nodes();
        let loaded = self.loads.points();
        let mut everywhere: Vec<u32> = self.supports.driven().chain(loaded.into_iter().flatten()).collect();
        everywhere.extend(self.optional.surface_supports.nodes());
        everywhere.extend(watched);
        self.solid.share_out(exchange, &everywhere, all);
    }

    /// Brings what this rank has of the nodes and cells of others up to date, before anyone looks at all of them. All ranks must
    /// call it. What a measured step has measured is up to date without it, but for viscous stress.
    pub fn gather_ranks(&mut self) {
        self.solid.gather_ranks();
    }
}
