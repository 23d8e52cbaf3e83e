//! Contact without what has left the run.

use fractum_contact::SphereContacts;
use fractum_dem::Particles;
use fractum_fem::Solid;

use super::debris_among::DebrisAmong;
use super::{Contacts, SolidSurface};
use crate::coupling::Debris;

impl Contacts {
    /// Visits every bonded or loose particle that touched something at the last step, but for the faces of its own body.
    pub(crate) fn each_touching_particle(&self, mut visit: impl FnMut(u32)) {
        self.among.iter().flat_map(SphereContacts::touching).flatten().for_each(&mut visit);
        let grounds = self.on_tools.iter().map(|(contacts, _)| contacts);
        for contacts in grounds.chain(self.solids.iter().map(SolidSurface::contacts)) {
            contacts.touches().for_each(|touch| visit(touch.sphere));
        }
        let count = self.body.len();
        let particles = self.nodes.debris.iter().flat_map(DebrisAmong::pairs_touching).map(|[i, _]| i);
        particles.filter(|&i| (i as usize) < count).for_each(visit);
    }

    /// Visits every node of solids that touched a facet, a container or a particle at the last step, or whose facet was touched.
    pub(crate) fn each_touching_node(&self, debris: &Debris, particles: &Particles, mut visit: impl FnMut(u32)) {
        for nodes in self.nodes.on_tools.iter().flatten() {
            nodes.touches().for_each(|(_, _, node)| visit(node));
        }
        for ground in &self.solids {
            ground.each_touching_node(&particles.position, &mut visit);
        }
        let edges = self.nodes.edges.iter().flat_map(|edges| edges.touches());
        edges.flat_map(|touch| touch.nodes.iter().flatten()).for_each(|&node| visit(node));
        let count = particles.len();
        let born = self.nodes.debris.iter().flat_map(DebrisAmong::pairs_touching).flatten();
        born.filter_map(|i| (i as usize).checked_sub(count)).for_each(|born| visit(debris.state().nodes[born]));
    }

    /// Has all particles looked for anew, since some have left.
    ///
    /// - `radii`: of the particles; negative ones of those that have left [m]
    pub(crate) fn look_again(&mut self, radii: &[f64]) {
        self.among.iter_mut().for_each(SphereContacts::look_again);
        self.nodes.debris.iter_mut().for_each(DebrisAmong::look_again);
        self.on_tools.iter_mut().for_each(|(contacts, _)| contacts.look_again());
        self.solids.iter_mut().for_each(|ground| ground.look_again(radii));
    }

    /// Takes nodes of solids out of all contact, of which none touches anything.
    ///
    /// - `debris`: without them; `born`: its nodes before
    /// - `gone`: all nodes that have left so far; `elements`: those that have left now
    pub(crate) fn let_nodes_leave(
        &mut self,
        solid: &Solid,
        debris: &Debris,
        particles: usize,
        born: &[u32],
        gone: &[u32],
        elements: &[(usize, u32)],
    ) {
        for ground in &mut self.solids {
            ground.remove_facets(solid, elements);
            ground.visitors_mut().iter_mut().for_each(|nodes| nodes.let_leave(gone, debris));
        }
        self.nodes.edges.iter_mut().for_each(|edges| edges.remove(&self.solids));
        self.nodes.on_tools.iter_mut().flatten().for_each(|nodes| nodes.let_leave(gone, debris));
        if let Some(among) = &mut self.nodes.debris {
            among.let_leave(particles, born, &debris.state().nodes);
        }
    }

    /// Leaves out nodes of solids that had left when the state was saved.
    pub(crate) fn leave_out(&mut self, gone: impl Iterator<Item = u32>) {
        let gone: Vec<u32> = gone.collect();
        let on_solids = self.solids.iter_mut().filter_map(|ground| ground.visitors_mut().as_mut());
        on_solids.chain(self.nodes.on_tools.iter_mut().flatten()).for_each(|nodes| nodes.leave_out(&gone));
    }
}
