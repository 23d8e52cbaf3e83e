use core::ops::Mul;

/// Coulomb's slip: what is left of a trial force, stretch or strain, brought back to the cone along its own direction (return
/// mapping; Simo and Hughes, *Computational Inelasticity* (1998), chapter 1). All friction goes through here.
///
/// - `size`: the trial force [N], moment [N m] or stress [Pa]
/// - `limit`: the largest one, μ times the normal force or stress, ≥ 0
#[inline]
pub fn slip_to_cone<T: Mul<f64, Output = T>>(trial: T, size: f64, limit: f64) -> T {
    if size > limit { trial * (limit / size) } else { trial }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;

    #[test]
    fn what_sticks_stays_and_what_slips_ends_on_the_cone() {
        let (trial, stiffness) = (Vec3::new(3e-6, -4e-6, 0.0), 1e6);
        assert_eq!(slip_to_cone(trial, stiffness * trial.norm(), 5.1), trial);
        let left = slip_to_cone(trial, stiffness * trial.norm(), 2.0);
        assert!((stiffness * left.norm() - 2.0).abs() < 1e-12 && left.cross(&trial).norm() < 1e-24);
        assert_eq!(slip_to_cone(trial, stiffness * trial.norm(), 0.0), Vec3::zeros());
    }
}
