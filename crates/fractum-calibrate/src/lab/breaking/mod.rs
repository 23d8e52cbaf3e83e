//! Tests to failure: each moves supports until the body comes apart.

mod brazilian;
mod geometry;
mod motion;
mod setup;

pub use brazilian::{Diameter, diameter, hondros};
pub use geometry::{Geometry, geometry};
pub use motion::{BrokenInMotion, MotionEnergy, MotionOptions, break_in_motion};

use fractum_dem::{
    Batch, Breaking, BreakingOutcome, CriticalLoad, FractureCriterion, LoadPoint, LoadStage, QuasiStatic, Tolerance,
    quasi_static,
};
use serde::Serialize;

use super::STRAIN;
use crate::{CalibrateError, Sample};
use setup::Setup;

/// How a sample is broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Failure {
    /// A box or a cylinder pulled along x by its ends, which are free to contract.
    Tension,
    /// A box or a cylinder pressed along x by its ends, which are free to expand.
    Compression,
    /// A box along x bent by opposite rotations of its ends about z.
    Bending,
    /// A cylinder twisted by opposite rotations of its ends.
    Torsion,
    /// A disc (a short cylinder) pressed across its diameter y by two arcs of 24°.
    Brazilian,
}

/// How to break.
#[derive(Clone, Copy, Debug)]
pub struct FailureOptions {
    /// When bonds break.
    pub criterion: FractureCriterion,
    /// How many bonds break between two equilibria.
    pub batch: Batch,
    /// Largest nominal strain, for samples that shall not break.
    pub limit: f64,
    /// The sample has lost its strength when cracks have come to rest and the load is below this share of its peak.
    pub stop: f64,
    /// When equilibrium is reached.
    pub tolerance: Tolerance,
}

impl FailureOptions {
    /// The usual way for a test. Only in tension does a crack take all of the load away; the halves of a split disc and the
    /// pressed side of a bent prism go on bearing. There the run ends when the crack that brought the load down by a
    /// tenth, in bending by 3 %, has come to rest.
    pub fn new(test: Failure, criterion: FractureCriterion) -> Self {
        let stop = match test {
            Failure::Tension => 0.02,
            // Past its crack the compressed side of a prism is a hinge, whose moment grows with the rotation for ever.
            Failure::Bending => 0.97,
            _ => 0.9,
        };
        let tolerance = Tolerance { residual: 1e-3, ..Tolerance::default() };
        FailureOptions { criterion, batch: Batch::default(), limit: f64::INFINITY, stop, tolerance }
    }
}

/// A sample that was broken.
#[derive(Clone, Debug)]
pub struct Broken {
    /// Nominal stress when the first bond broke [Pa].
    pub first_break: Option<f64>,
    /// Largest nominal stress [Pa].
    pub strength: f64,
    /// Nominal stress per unit of load [1/m² or 1/m³].
    pub stress_per_load: f64,
    /// Nominal strain per unit of displacement [1/m or 1].
    pub strain_per_displacement: f64,
    /// Displacement (or rotation) of the supports at load factor one.
    pub displacement: f64,
    /// All of it.
    pub outcome: BreakingOutcome,
}

impl Broken {
    /// Nominal stress [Pa] at a point.
    pub fn stress(&self, point: &CriticalLoad) -> f64 {
        point.load * self.stress_per_load
    }
}

/// Breaks a sample quasi-statically.
///
/// The nominal stress is that of elementary theory for the measured body, where it is largest: F/A; 6 M/(b h²); 2 M/(π R³);
/// 2 F/(π t D).
///
/// # Errors
/// Another shape; an impossible criterion; a solve that does not converge.
pub fn break_sample(sample: &Sample, test: Failure, options: &FailureOptions) -> Result<Broken, CalibrateError> {
    let setup = Setup::of(sample, test)?;
    let what = breaking(sample, &setup, options);
    let Setup { supports, guess, displacement, stress_per_load, strain_per_displacement, ends, middle } = setup;
    let separated = |graph: &fractum_dem::BondGraph| match &middle {
        None => graph.parts().separate(&ends[0], &ends[1]),
        Some(inside) => graph.parts_among(|i| inside[i]).separate(&ends[0], &ends[1]),
    };
    let outcome = quasi_static(sample.lattice.clone(), supports, &guess, &what, separated)?;
    Ok(Broken {
        first_break: outcome.first.map(|p| p.load * stress_per_load),
        strength: outcome.peak.load * stress_per_load,
        stress_per_load,
        strain_per_displacement,
        displacement,
        outcome,
    })
}

/// What is to be broken of a sample.
fn breaking<'a>(sample: &'a Sample, setup: &Setup, options: &FailureOptions) -> Breaking<'a> {
    Breaking {
        criterion: options.criterion,
        pairs: &sample.network.pairs,
        radius: &sample.packing.radius,
        strength_factors: &[],
        to_wall: &sample.to_wall,
        fraction: sample.fraction,
        volume: sample.measured_volume(),
        displacement: setup.displacement,
        batch: options.batch,
        limit: options.limit / (setup.displacement * setup.strain_per_displacement),
        stop: options.stop,
        tolerance: options.tolerance,
    }
}

/// The load at which the first bond breaks; none where nothing does.
fn first_break(
    sample: &Sample,
    test: Failure,
    options: &FailureOptions,
) -> Result<Option<CriticalLoad>, CalibrateError> {
    let setup = Setup::of(sample, test)?;
    let what = breaking(sample, &setup, options);
    let mut run = QuasiStatic::new(sample.lattice.clone(), setup.supports, &setup.guess, &what)?;
    let (LoadPoint { displacement, load, .. }, stage) = run.load_to_next_failure(|_| false);
    Ok((stage == LoadStage::Failing).then_some(CriticalLoad { displacement, load, broken: 0 }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Micro;
    use fractum_dem::criterion::{Level, Principal};
    use fractum_pack::{Convention, Domain, PackSpec, pack};

    fn broken(domain: Domain, count: usize, test: Failure, compressive_strength: Option<f64>) -> (Sample, Broken) {
        let packing = pack(&PackSpec::new(domain, count, 1)).unwrap();
        let mut sample = Sample::new(packing, 10.0, Convention::All).unwrap();
        sample.set_micro(Micro { radius_ratio: 0.348, young_modulus: 677.94e9 }).unwrap();
        // Eq. (22) of Nguyen et al. (2019) for a material of 50 MPa.
        let tensile_strength = 60.06e6;
        let level = Level::Neighbours;
        let criterion = FractureCriterion::Principal(Principal { tensile_strength, compressive_strength, level });
        let result = break_sample(&sample, test, &FailureOptions::new(test, criterion)).unwrap();
        (sample, result)
    }

    #[test]
    fn a_cube_breaks_across_near_the_asked_strength() {
        let (sample, result) = broken(Domain::cuboid(2e-3, 2e-3, 2e-3), 800, Failure::Tension, None);
        // 800 particles: scatter of several per cent, and a weak surface layer.
        assert!((40e6..56e6).contains(&result.strength), "{}", result.strength);
        assert!(result.first_break.unwrap() <= result.strength);
        assert!(result.outcome.separated);
        let angle = geometry(&sample, Failure::Tension, &result.outcome.cracks).unwrap().angle.unwrap();
        assert!(angle < 30.0, "{angle}");
    }

    #[test]
    fn a_disc_splits_along_its_loaded_diameter() {
        let (sample, result) = broken(Domain::cylinder(10e-3, 25e-3), 1500, Failure::Brazilian, None);
        assert!((40e6..62e6).contains(&result.strength), "{}", result.strength);
        let found = geometry(&sample, Failure::Brazilian, &result.outcome.cracks).unwrap();
        assert!(found.early < 0.4 && found.angle.unwrap() < 20.0, "{found:?}");
    }

    #[test]
    fn a_cube_in_motion_breaks_at_the_load_of_the_cube_at_rest_and_keeps_its_energy() {
        let (sample, rest) = broken(Domain::cuboid(2e-3, 2e-3, 2e-3), 500, Failure::Tension, None);
        let level = Level::Neighbours;
        let criterion =
            FractureCriterion::Principal(Principal { tensile_strength: 60.06e6, compressive_strength: None, level });
        let options = FailureOptions::new(Failure::Tension, criterion);
        let faces = fractum_dem::CrackFaces::default();
        let motion =
            MotionOptions { density: 2500.0, transits: 40.0, of: None, pressure: 0.0, start: 0.9, faces, safety: 0.5 };
        let moved = break_in_motion(&sample, Failure::Tension, &options, &motion).unwrap();
        assert!((moved.first_break.unwrap() / rest.first_break.unwrap() - 1.0).abs() < 0.01, "{moved:?}");
        assert!((moved.strength / rest.strength - 1.0).abs() < 0.02, "{} {}", moved.strength, rest.strength);
        assert!(moved.broken > 100 && moved.energy.residual_max_relative < 1e-3, "{:?}", moved.energy);
    }

    #[test]
    fn read_at_its_walls_a_rod_breaks_first_as_much_earlier_as_its_stress_grows_outwards() {
        let first = |domain: &Domain, test: Failure| {
            let packing = pack(&PackSpec::new(domain.clone(), 700, 1)).unwrap();
            let mut sample = Sample::new(packing, 10.0, Convention::All).unwrap();
            sample.set_micro(Micro { radius_ratio: 0.348, young_modulus: 677.94e9 }).unwrap();
            let level = Level::Neighbours;
            let criterion = Principal { tensile_strength: 60.06e6, compressive_strength: None, level };
            let options = FailureOptions::new(test, FractureCriterion::Principal(criterion));
            let strength = |sample: &Sample| break_sample(sample, test, &options).unwrap();
            let (plain, at_walls) = (strength(&sample), strength(&sample.clone().read_at_walls()));
            [at_walls.first_break.unwrap() / plain.first_break.unwrap(), at_walls.strength / plain.strength]
        };
        let [_, pulled] = first(&Domain::cuboid(2e-3, 2e-3, 2e-3), Failure::Tension);
        assert!((pulled - 1.0).abs() < 0.03, "{pulled}");
        // Six particles across: the middle of a neighbourhood lies a quarter of the radius inside.
        let [twisted, peak] = first(&Domain::cylinder(4e-3, 0.7e-3), Failure::Torsion);
        assert!((0.6..0.85).contains(&twisted) && peak < 1.0, "{twisted} {peak}");
    }

    #[test]
    fn compression_needs_a_strength_of_its_own() {
        let (_, result) = broken(Domain::cuboid(2e-3, 2e-3, 2e-3), 500, Failure::Compression, Some(600.6e6));
        assert!((300e6..600e6).contains(&result.strength), "{}", result.strength);
    }
}
