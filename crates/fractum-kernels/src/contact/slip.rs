use crate::Vec3;

/// Coulomb's slip: what is left of a trial force or stretch, brought back to the cone along its own direction (return
/// mapping; Simo and Hughes, *Computational Inelasticity* (1998), chapter 1). All friction of contacts goes through here.
///
/// - `size`: the trial force [N], or moment [N m]
/// - `limit`: the largest one, μ times the normal force, ≥ 0
#[inline]
pub fn slip_to_cone(trial: Vec3, size: f64, limit: f64) -> Vec3 {
    if size > limit { trial * (limit / size) } else { trial }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_sticks_stays_and_what_slips_ends_on_the_cone() {
        let (trial, stiffness) = (Vec3::new(3e-6, -4e-6, 0.0), 1e6);
        assert_eq!(slip_to_cone(trial, stiffness * trial.norm(), 5.1), trial);
        let left = slip_to_cone(trial, stiffness * trial.norm(), 2.0);
        assert!((stiffness * left.norm() - 2.0).abs() < 1e-12 && left.cross(&trial).norm() < 1e-24);
        assert_eq!(slip_to_cone(trial, stiffness * trial.norm(), 0.0), Vec3::zeros());
    }
}
