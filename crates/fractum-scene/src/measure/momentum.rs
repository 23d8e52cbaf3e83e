//! Momentum of everything in a scene.

use fractum_math::Vec3;

use crate::conditions::Points;
use crate::contacts::RigidBody;
use crate::scene::Scene;

impl Scene {
    /// Linear momentum along a direction [kg m/s].
    pub fn momentum_along(&self, direction: &Vec3) -> f64 {
        let solid = &self.solid;
        let nodes = (0..solid.mass.len()).map(|i| solid.mass[i] * solid.velocity[i].dot(direction));
        let rigid_bodies: Vec3 = self.contacts.rigid_bodies().iter().map(RigidBody::momentum).sum();
        nodes.sum::<f64>() + (self.bonded.momentum() + rigid_bodies).dot(direction)
    }

    /// Angular momentum about the origin along a direction [kg m²/s].
    pub fn angular_momentum_along(&self, direction: &Vec3) -> f64 {
        let solid = &self.solid;
        let nodes = (0..solid.mass.len())
            .map(|i| solid.mass[i] * Points::position(solid, i).cross(&solid.velocity[i]).dot(direction));
        let rigid_bodies: Vec3 = self.contacts.rigid_bodies().iter().map(RigidBody::angular_momentum).sum();
        let others = self.debris.spin_momentum(solid) + self.bonded.angular_momentum() + rigid_bodies;
        nodes.sum::<f64>() + others.dot(direction)
    }
}
