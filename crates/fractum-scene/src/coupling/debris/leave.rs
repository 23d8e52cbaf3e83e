//! Discrete elements that leave the run.

use fractum_fem::Solid;

use super::{Debris, Handed, NONE};

impl Debris {
    /// Nodes that touch others, or whose torques an element got at the last step.
    pub(crate) fn bound_nodes(&self) -> impl Iterator<Item = u32> {
        let handed = self.state.handed.iter().map(|handed| self.state.nodes[handed.particle as usize]);
        self.state.contacts.iter().flat_map(|pair| pair.nodes).chain(handed)
    }

    /// Rotational energy of the free particles on these nodes [J].
    pub(crate) fn spin_energy(&self, solid: &Solid, nodes: &[bool]) -> f64 {
        let of = |particle: usize| {
            let node = self.state.nodes[particle] as usize;
            let inertia = self.inertia(solid.mass[node], self.radius[node]);
            if nodes[node] { 0.5 * inertia * self.state.spin[particle].norm_squared() } else { 0.0 }
        };
        (0..self.len()).map(of).sum()
    }

    /// Takes the particles of these nodes out of the run; they must not touch anything.
    pub(crate) fn let_leave(&mut self, solid: &Solid, nodes: &[bool]) {
        if self.is_empty() {
            return;
        }
        let mut state = self.saved();
        let stays: Vec<bool> = state.nodes.iter().map(|&node| !nodes[node as usize]).collect();
        let mut number = vec![NONE; stays.len()];
        let staying = number.iter_mut().zip(&stays).filter(|(_, stays)| **stays);
        (0..).zip(staying).for_each(|(count, (number, _))| *number = count);
        let keep = |particle: usize| stays[particle];
        retain_by(&mut state.nodes, keep);
        retain_by(&mut state.attached, keep);
        retain_by(&mut state.spin, keep);
        state.handed.iter_mut().for_each(|Handed { particle, .. }| *particle = number[*particle as usize]);
        state.special.retain(|special| special.nodes.iter().all(|&node| !nodes[node as usize]));
        self.restore(solid, state);
    }
}

fn retain_by<T>(values: &mut Vec<T>, keep: impl Fn(usize) -> bool) {
    let mut index = 0;
    values.retain(|_| {
        index += 1;
        keep(index - 1)
    });
}
