//! Strength of the particles of bonded bodies by chance.

use fractum_math::elementary::pow;
use fractum_math::{Vec3, sphere_volume};
use fractum_prepare::PreparedBody;
use rayon::prelude::*;

use super::WeibullReport;
use super::flaws::{Bounds, Flaw, FlawField, KEPT, Reach};
use super::spots::weakest_of_particles;
use crate::build::Context;
use crate::model::{Material, Scatter};

/// Diameter of a weak spot as strong as its surroundings, over the mean diameter of the particles: a crack of one particle alone does not run yet.
const DIAMETERS: f64 = 4.0;

impl Context<'_> {
    /// Gives the particles of a body the strength of their weakest flaw, where the material has scatter.
    ///
    /// Flaws lie in the spheres, as many as in the volume of the body.
    pub(in crate::build) fn scatter_particles(&mut self, body: &str, material: &Material, made: &mut PreparedBody) {
        let Some(failure) = &material.fracture else { return };
        let Some((weibull, seed)) = failure.value.scatter.as_ref().and_then(Scatter::weibull) else { return };
        let Some(fracture) = &mut made.fracture else { return };
        let (centres, radii) = (&made.particles.position, &made.particles.radius);
        let count = radii.len().max(1) as f64;
        let spheres: f64 = radii.iter().map(|radius| sphere_volume(*radius)).sum();
        let mean_diameter = 2.0 * radii.iter().sum::<f64>() / count;
        let reference = weibull.reference.measure();
        let [particle, whole] = [fracture.volume / count, fracture.volume].map(|volume| volume / reference);
        let spot = |radius: f64| sphere_volume(radius) / reference;
        let reach = match weibull.correlation_length {
            Some(length) => Reach::of_length(length),
            None => {
                // Stronger bonds stop a longer crack: a spot is so large that its crack runs through the strongest ones around it.
                let reach =
                    |strength: f64| Reach::of_crack(DIAMETERS * mean_diameter * strength * strength, weibull.modulus);
                let is_weak = |strength: f64| {
                    let level = pow(strength, weibull.modulus);
                    reach(strength).expected(level, spot, particle, whole) < KEPT
                };
                reach(last_of(is_weak))
            }
        };
        let most = reach.level_kept(spot, particle, whole);
        let field = FlawField::new(seed.wrapping_mul(8), 3, fracture.volume / spheres / reference);
        let of_particle = |particle: usize| {
            let (centre, radius) = (centres[particle], radii[particle]);
            let corner = Vec3::repeat(radius);
            let mut found = Vec::new();
            field.each_below(&Bounds { low: centre - corner, high: centre + corner }, most, &mut |flaw: Flaw| {
                if (flaw.place - centre).norm_squared() <= radius * radius {
                    found.push((particle as u32, flaw));
                }
            });
            found
        };
        let flaws: Vec<(u32, Flaw)> = (0..radii.len()).into_par_iter().flat_map_iter(of_particle).collect();
        let (levels, weakest) = weakest_of_particles(centres, &flaws, (reach, most));
        fracture.strength_factors = levels.into_iter().map(|level| weibull.factor(level)).collect();
        let asked = failure.value.strength;
        let strength = asked.tensile_strength.unwrap_or(asked.criterion.numbers().tensile_strength);
        let report = WeibullReport::of(weibull, strength, fracture.volume, [reach.radius, mean_diameter], weakest);
        self.weibull.push(WeibullReport { body: body.to_owned(), ..report });
    }
}

/// The largest factor of which something is true that is true of all smaller ones, between a thousandth and a thousand.
fn last_of(is_true: impl Fn(f64) -> bool) -> f64 {
    let halve = |[low, high]: [f64; 2], _| {
        let middle = (low * high).sqrt();
        if is_true(middle) { [middle, high] } else { [low, middle] }
    };
    (0..40).fold([1e-3, 1e3], halve)[0]
}
