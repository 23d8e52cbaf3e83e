//! Published tables of bonded bodies on our own packings.

mod plot;
mod strength;

use std::path::{Path, PathBuf};

use clap::Subcommand;
use fractum::{Failure, say};
use fractum_calibrate::{CalibrateError, Micro, Sample, lab, published};
use fractum_dem::Tolerance;
use fractum_output::atomic;
use fractum_pack::{Convention, Domain, PackSpec, Packing, pack};

use plot::{Diagram, Series, svg};
use strength::{StrengthArguments, spread};

/// What is recorded.
#[derive(Subcommand)]
pub(crate) enum LabCommand {
    /// Published strengths on our own packings.
    Strength(StrengthArguments),
    /// Tables 5 to 8 of Nguyen et al. (2019): the published micro-parameters on our own packings.
    Tables {
        /// Packings per row.
        #[arg(long, default_value_t = 3)]
        seeds: u64,
    },
    /// Table 1 of Nguyen et al. (2019): stress of particles and their neighbours against that of a pulled cube.
    Virial {
        /// Packings per row.
        #[arg(long, default_value_t = 3)]
        seeds: u64,
        /// Particles per packing.
        #[arg(long, default_value_t = 10_000)]
        count: usize,
    },
    /// A row of particles in free tension, bending and torsion against the clamped-free bar.
    Chain {
        /// Particles after the clamped one.
        #[arg(long, default_value_t = 40)]
        particles: usize,
    },
    /// E and Poisson's ratio against the number of particles, both conventions, as CSV and as a plot beside it.
    Convergence {
        /// Packings per size.
        #[arg(long, default_value_t = 4)]
        seeds: u64,
        /// Largest number of particles.
        #[arg(long, default_value_t = 50_000)]
        largest: usize,
        /// CSV file to write.
        #[arg(short, long, default_value = "convergence.csv")]
        output: PathBuf,
    },
}

fn wrong(error: CalibrateError) -> Failure {
    Failure::input(error.to_string())
}

/// Records a table.
pub(crate) fn run(command: &LabCommand) -> Result<(), Failure> {
    match command {
        LabCommand::Strength(arguments) => strength::run(arguments),
        LabCommand::Tables { seeds } => tables(*seeds).map_err(wrong),
        LabCommand::Virial { seeds, count } => virial(*seeds, *count).map_err(wrong),
        LabCommand::Chain { particles } => chain(*particles).map_err(wrong),
        LabCommand::Convergence { seeds, largest, output } => convergence(*seeds, *largest, output),
    }
}

fn chain(particles: usize) -> Result<(), CalibrateError> {
    say!("mode     period [s]   of theory [s]   difference");
    for mode in [lab::VibrationMode::Tension, lab::VibrationMode::Bending, lab::VibrationMode::Torsion] {
        let lab::Vibration { period, theory, .. } = lab::chain(mode, particles)?;
        let name = format!("{mode:?}").to_lowercase();
        say!("{name:8} {period:.6e} {theory:.6e}    {:+.3} %", 100.0 * (period / theory - 1.0));
    }
    Ok(())
}

fn tables(seeds: u64) -> Result<(), CalibrateError> {
    let make = |domain: Domain, count: usize| -> Result<Vec<Packing>, CalibrateError> {
        Ok((1..=seeds).map(|seed| pack(&PackSpec::new(domain.clone(), count, seed))).collect::<Result<_, _>>()?)
    };
    let cubes = make(Domain::cuboid(2e-3, 2e-3, 2e-3), 10_000)?;
    let spheres = make(Domain::sphere(5e-3), 15_000)?;
    say!("mean over {seeds} packings; differences from the target in %, scatter as standard deviation in %");
    say!(
        "target E, nu           cn    r_m   E_m GPa |  E GPa   diff  scatter |    nu    diff  scatter |  K GPa   diff  scatter"
    );
    for a in published::anchors() {
        let bonded = |packing: &Packing| -> Result<Sample, CalibrateError> {
            let mut sample = Sample::new(packing.clone(), a.coordination, Convention::All)?;
            sample.set_micro(Micro { radius_ratio: a.radius_ratio, young_modulus: a.beam_modulus })?;
            Ok(sample)
        };
        let (mut young, mut poisson, mut bulk) = (Vec::new(), Vec::new(), Vec::new());
        for packing in &cubes {
            let (tension, _) = lab::tension(&bonded(packing)?, 0, None, Tolerance::default())?;
            young.push(tension.young_modulus);
            poisson.push(tension.poisson_ratio);
        }
        for packing in &spheres {
            bulk.push(lab::hydrostatic(&bonded(packing)?, Tolerance::default())?.0.bulk_modulus);
        }
        let target = a.young_modulus / (3.0 * (1.0 - 2.0 * a.poisson_ratio));
        let ((e, se), (n, sn), (k, sk)) = (spread(&young), spread(&poisson), spread(&bulk));
        say!(
            "{:5.0} GPa {:5.2} {:12.0} {:6.3} {:9.2} | {:6.2} {:+6.2} {:8.2} | {:.4} {:+6.2} {:8.2} | {:6.2} {:+6.2} {:8.2}",
            a.young_modulus / 1e9,
            a.poisson_ratio,
            a.coordination,
            a.radius_ratio,
            a.beam_modulus / 1e9,
            e / 1e9,
            100.0 * (e / a.young_modulus - 1.0),
            100.0 * se,
            n,
            100.0 * (n / a.poisson_ratio - 1.0),
            100.0 * sn,
            k / 1e9,
            100.0 * (k / target - 1.0),
            100.0 * sk,
        );
    }
    Ok(())
}

/// Stress of neighbourhoods in cubes of 2 mm at coordination 10, for five radii of the beams.
fn virial(seeds: u64, count: usize) -> Result<(), CalibrateError> {
    let cube = |seed| pack(&PackSpec::new(Domain::cuboid(2e-3, 2e-3, 2e-3), count, seed));
    let packings: Vec<Packing> = (1..=seeds).map(cube).collect::<Result<_, _>>()?;
    say!("{count} particles, {seeds} packings; mean stress of particles over F/(Ly Lz), less 1, in %");
    say!("       volume fraction of the core      of the whole body");
    say!("r_m    level 0  level 1  level 2    level 0  level 1  level 2");
    for radius_ratio in [0.2, 0.4, 0.6, 0.8, 1.0] {
        let mut sums = [0.0; 6];
        for packing in &packings {
            let mut sample = Sample::new(packing.clone(), 10.0, Convention::All)?;
            sample.set_micro(Micro { radius_ratio, young_modulus: 500e9 })?;
            let whole = packing.sphere_volume() / sample.measured_volume();
            for (k, fraction) in [sample.fraction, whole].into_iter().enumerate() {
                let errors = lab::virial_errors(&sample, fraction, Tolerance::default())?;
                sums[3 * k..].iter_mut().zip(errors).for_each(|(sum, error)| *sum += error);
            }
        }
        let [a, b, c, d, e, f] = sums.map(|sum| 100.0 * sum / seeds as f64);
        say!("{radius_ratio:.1}  {a:+9.2}{b:+9.2}{c:+9.2}  {d:+9.2}{e:+9.2}{f:+9.2}");
    }
    Ok(())
}

/// Sizes of the convergence study.
const SIZES: [usize; 8] = [200, 500, 1_000, 2_000, 5_000, 10_000, 20_000, 50_000];

/// Beams of the study: glass at coordination 10 (Nguyen et al. 2019, Table 5).
const STUDY: (f64, Micro) = (10.0, Micro { radius_ratio: 0.348, young_modulus: 677.94e9 });

fn convergence(seeds: u64, largest: usize, output: &Path) -> Result<(), Failure> {
    let mut text =
        String::from("particles,convention,packings,E [Pa],E scatter [%],nu,nu scatter [%],gauge E [Pa],gauge nu\n");
    let conventions = [(Convention::All, "#b42"), (Convention::Interior, "#06c")];
    let series = || conventions.map(|(c, colour)| Series { name: c.to_string(), colour, points: Vec::new() }).into();
    let mut young = Diagram { title: "Young's modulus [GPa] against particles", series: series() };
    let mut poisson = Diagram { title: "Poisson's ratio against particles", series: series() };
    for count in SIZES.into_iter().filter(|&c| c <= largest) {
        let cube = |seed| pack(&PackSpec::new(Domain::cuboid(2e-3, 2e-3, 2e-3), count, seed));
        let packings: Vec<Packing> = (1..=seeds).map(cube).collect::<Result<_, _>>().map_err(|e| wrong(e.into()))?;
        for (k, (convention, _)) in conventions.into_iter().enumerate() {
            let tests = packings.iter().map(|packing| -> Result<lab::Tension, CalibrateError> {
                let mut sample = Sample::new(packing.clone(), STUDY.0, convention)?;
                sample.set_micro(STUDY.1)?;
                Ok(lab::tension(&sample, 0, None, Tolerance::default())?.0)
            });
            let tests = tests.collect::<Result<Vec<_>, _>>().map_err(wrong)?;
            let column =
                |f: &dyn Fn(&lab::Tension) -> Option<f64>| spread(&tests.iter().filter_map(f).collect::<Vec<f64>>());
            let ((e, se), (n, sn)) = (column(&|t| Some(t.young_modulus)), column(&|t| Some(t.poisson_ratio)));
            let (ge, gn) = (column(&|t| t.gauge_young_modulus).0, column(&|t| t.gauge_poisson_ratio).0);
            let line = format!(
                "{count},{convention},{seeds},{e:.4e},{:.3},{n:.5},{:.3},{ge:.4e},{gn:.5}",
                100.0 * se,
                100.0 * sn
            );
            say!("{line}");
            text += &(line + "\n");
            young.series[k].points.push([count as f64, e / 1e9, se * e / 1e9]);
            poisson.series[k].points.push([count as f64, n, sn * n]);
        }
    }
    atomic::write(output, text.as_bytes())?;
    atomic::write(&output.with_extension("svg"), svg(&[young, poisson]).as_bytes())?;
    Ok(())
}
