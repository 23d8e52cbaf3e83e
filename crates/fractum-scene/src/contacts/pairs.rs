//! Contacts of particles by the coefficients of pairs of bodies.

use fractum_contact::law::MaterialPair;

use super::{ContactBody, ContactPairs, Contacts};

impl Contacts {
    /// The same, before the first step, with pairs that have coefficients of their own. Nodes of solids and their discrete
    /// elements take them from [`Debris`](crate::coupling::Debris::with_pairs).
    pub fn with_pairs(mut self, pairs: &ContactPairs) -> Self {
        let own = |bodies: [ContactBody; 2], pair: &mut MaterialPair| {
            if let Some(own) = pairs.get(bodies) {
                pair.surface = own.surface;
                pair.work_of_adhesion = own.work_of_adhesion.unwrap_or(pair.work_of_adhesion);
            }
        };
        let count = self.materials.len();
        for (index, pair) in self.pairs.iter_mut().enumerate() {
            own([index / count, index % count].map(ContactBody::Particles), pair);
        }
        for (rigid, (_, of_bodies)) in self.on_tools.iter_mut().enumerate() {
            for (body, pair) in of_bodies.iter_mut().enumerate() {
                own([ContactBody::Particles(body), ContactBody::Rigid(rigid)], pair);
            }
        }
        for solid in &mut self.solids {
            let ground = ContactBody::Solid(solid.body());
            solid.each_pair(|body, pair| own([ContactBody::Particles(body), ground], pair));
        }
        self.reaching()
    }
}
