use serde::{Deserialize, Serialize};

#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;

/// A normal spring that knows the work that it has taken.
///
/// Central differences let the force of an instant act over the halves of the steps beside it. The spring of constant stiffness k has then
/// taken ½ k δ² as long as it is in contact, but not where a contact begins or ends within a step. The force at its first and at its last
/// instant is therefore the one with which the mass m on the spring leaves with the energy that it has come with: with the ways of the steps
/// before and after, w and w - (F + D) Δt²/m under the force of the damper D, a quadratic equation for F. Other forces on the
/// mass change the way after a little; what that leaves is told when the contact ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct AccountedSpring {
    /// At the last step [N].
    force: f64,
    /// Work that it has taken and not given back [J].
    energy: f64,
}

/// A mass in front of a spring.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pressed {
    /// k [N/m].
    pub(super) stiffness: f64,
    /// m [kg].
    pub(super) mass: f64,
    /// c [N s/m].
    pub(super) viscosity: f64,
    /// Overlap δ > 0 [m].
    pub(super) overlap: f64,
    /// Change w of the overlap in the step to here [m].
    pub(super) way: f64,
    /// Step [s].
    pub(super) dt: f64,
}

impl AccountedSpring {
    /// Work that the spring has taken and not given back [J].
    #[inline]
    pub(super) fn energy(&self) -> f64 {
        self.energy
    }

    /// Whether the contact begins.
    #[inline]
    pub(super) fn is_new(&self) -> bool {
        *self == AccountedSpring::default()
    }

    /// Force at the last step [N].
    #[inline]
    pub(super) fn force(&self) -> f64 {
        self.force
    }

    /// Takes the energy of an overlap [m] for what it has taken: where the normal turns, steps along the last one miss some of it. What it had taken beyond
    /// it [J].
    #[inline]
    pub(super) fn take_energy_of(&mut self, stiffness: f64, overlap: f64) -> f64 {
        let before = core::mem::replace(&mut self.energy, 0.5 * stiffness * overlap * overlap);
        before - self.energy
    }

    /// Force of the spring [N].
    #[inline]
    pub(super) fn press(&mut self, pressed: &Pressed) -> f64 {
        let Pressed { stiffness, mass, overlap, way, dt, viscosity } = *pressed;
        let full = stiffness * overlap;
        let damper = if dt > 0.0 { viscosity * way / dt } else { 0.0 };
        let per_force = dt * dt / mass;
        let is_new = self.is_new();
        self.energy += 0.5 * self.force * way;
        let force = if is_new && way > overlap {
            // (F (w + w') = k δ (δ + w'), with the way after, w' = w'' - F Δt²/m.
            let free = way - damper * per_force;
            let half = 0.5 * (way + free + full * per_force);
            let root = (half * half - full * (overlap + free) * per_force).max(0.0).sqrt();
            let stays = full * (overlap + free) / (half + root);
            // Where the mass leaves in the next step it does so as fast as it came.
            if overlap + free < stays * per_force { (way + free).max(0.0) / per_force } else { stays }
        } else {
            if is_new {
                // What it had before this step, all of its energy where it begins at rest.
                let before = (overlap - way).max(0.0);
                self.energy = 0.5 * stiffness * before * before;
            }
            let next = overlap + way - (full + damper.max(-full)) * per_force;
            if next < 0.0 {
                // E = ½ F (way out in the next step - way in this one).
                let half = 0.5 * (damper * per_force - 2.0 * way);
                let root = (half * half + 2.0 * self.energy.max(0.0) * per_force).sqrt();
                let small =
                    if half > 0.0 { 2.0 * self.energy.max(0.0) / (half + root) } else { (root - half) / per_force };
                small.max(0.0)
            } else {
                full
            }
        };
        self.energy += 0.5 * force * way;
        self.force = force;
        force
    }

    /// Ends the contact; what the last step leaves of its energy [J].
    #[inline]
    pub(super) fn part(&mut self, way: f64) -> f64 {
        let left = self.energy + 0.5 * self.force * way;
        *self = AccountedSpring::default();
        left
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A contact may begin at the end of a step, but for rounding: the whole of the next way is overlap.
    #[test]
    fn a_mass_that_touches_at_an_instant_brings_its_energy_once() {
        let (dt, stiffness) = (1.0, 0.3);
        for overlap in [0.0, 1e-17] {
            let mut spring = AccountedSpring::default();
            let pressed = |overlap: f64, way: f64| Pressed { stiffness, mass: 1.0, viscosity: 0.0, overlap, way, dt };
            if overlap > 0.0 {
                spring.press(&pressed(overlap, 1.0));
            }
            let force = spring.press(&pressed(1.0, 1.0));
            assert!((force - stiffness).abs() < 1e-15 && (spring.energy() - 0.5 * stiffness).abs() < 1e-15);
        }
        // One that overlaps at rest has the energy of its overlap.
        let mut spring = AccountedSpring::default();
        spring.press(&Pressed { stiffness, mass: 1.0, viscosity: 0.0, overlap: 0.5, way: 0.0, dt });
        assert!((spring.energy() - 0.125 * stiffness).abs() < 1e-15);
    }

    proptest! {
        /// A mass that meets the spring leaves as fast as it came, at any step and wherever in a step it touches.
        #[test]
        fn a_mass_leaves_as_fast_as_it_came(stiffness in 0.01f64..2.5, share in 0.01f64..0.99) {
            let (dt, mut x, mut v) = (1.0, share, -1.0);
            let mut spring = AccountedSpring::default();
            let mut kinetic = 0.5;
            for _ in 0..200 {
                x += v * dt;
                let way = -v * dt;
                if x >= 0.0 {
                    prop_assert!(spring.part(way).abs() < 1e-12);
                    if v > 0.0 { break }
                    continue;
                }
                let pressed = Pressed { stiffness, mass: 1.0, viscosity: 0.0, overlap: -x, way, dt };
                let after = v + spring.press(&pressed) * dt;
                kinetic = 0.5 * v * after;
                prop_assert!((kinetic + spring.energy() - 0.5).abs() < 1e-12, "{} + {}", kinetic, spring.energy());
                v = after;
            }
            prop_assert!((v - 1.0).abs() < 1e-9, "{v} {kinetic}");
        }
    }
}
