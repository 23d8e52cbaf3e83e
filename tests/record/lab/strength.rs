//! `record strength`: the published strengths on our own packings.

use clap::{Args, ValueEnum};
use fractum::{Failure, say};
use fractum_calibrate::{CalibrateError, Micro, Sample, lab, published};
use fractum_dem::FractureCriterion;
use fractum_dem::criterion::{BeamRankine, EndMoments, Hydrostatic, Level, Principal};
use fractum_pack::{Convention, Domain, PackSpec, Packing, pack};

/// Arguments of `record strength`.
#[derive(Args)]
pub(crate) struct StrengthArguments {
    /// Which table.
    #[arg(value_enum)]
    table: Table,
    /// Packings per row.
    #[arg(long, default_value_t = 2)]
    seeds: u64,
    /// Particles per packing; those of the source if not given.
    #[arg(long)]
    count: Option<usize>,
    /// Coordinations of the published rows to take, such as "8,10"; all if not given.
    #[arg(long, value_delimiter = ',')]
    coordination: Vec<f64>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Table {
    /// First break and load peak in tension against eq. (22) of Nguyen et al. (2019).
    Tension,
    /// Tables 9 and 10 of Nguyen et al. (2019): disc of 50 x 10 mm, arcs of 24 degrees.
    Brazilian,
    /// Table 11: cylinder of 4 x 100 mm.
    Torsion,
    /// Table 12: cube of 2 mm, strength in compression ten times that in tension.
    Compression,
    /// Table 4.1 of Jebahi et al. (2015): tension, bending and torsion with the beam criterion.
    Beam,
    /// Table 4.2: the same with the hydrostatic criterion.
    Hydrostatic,
}

/// Carries the command out.
pub(crate) fn run(arguments: &StrengthArguments) -> Result<(), Failure> {
    let StrengthArguments { table, seeds, count, coordination } = arguments;
    let rows = |domain: Domain, particles: usize, test| {
        published_rows(&domain, count.unwrap_or(particles), test, *seeds, coordination)
    };
    let done = match table {
        Table::Tension => rows(Domain::cuboid(2e-3, 2e-3, 2e-3), 10_000, lab::Failure::Tension),
        Table::Brazilian => rows(Domain::cylinder(10e-3, 25e-3), 20_000, lab::Failure::Brazilian),
        Table::Torsion => rows(Domain::cylinder(100e-3, 2e-3), 10_000, lab::Failure::Torsion),
        Table::Compression => rows(Domain::cuboid(2e-3, 2e-3, 2e-3), 10_000, lab::Failure::Compression),
        Table::Beam => {
            let criterion = |moments| FractureCriterion::BeamRankine(BeamRankine { strength: 292e6, moments });
            silica(count.unwrap_or(10_000), *seeds, criterion(EndMoments::Mean))
                .and_then(|()| silica(count.unwrap_or(10_000), *seeds, criterion(EndMoments::Largest)))
        }
        Table::Hydrostatic => {
            silica(count.unwrap_or(10_000), *seeds, FractureCriterion::Hydrostatic(Hydrostatic { strength: 64e6 }))
        }
    };
    done.map_err(|error| Failure::input(error.to_string()))
}

fn percent(value: f64, target: f64) -> f64 {
    100.0 * (value / target - 1.0)
}

/// One line per published row: strengths over the packings.
fn published_rows(
    domain: &Domain,
    count: usize,
    test: lab::Failure,
    seeds: u64,
    coordinations: &[f64],
) -> Result<(), CalibrateError> {
    let packings: Vec<Packing> =
        (1..=seeds).map(|seed| pack(&PackSpec::new(domain.clone(), count, seed))).collect::<Result<_, _>>()?;
    // Crushing is set to ten times the tensile strength.
    let crush = if test == lab::Failure::Compression { 10.0 } else { 1.0 };
    say!(
        "{count} particles, {seeds} packings; first break and load peak, difference from the target in %, scatter in %"
    );
    say!(
        "material  cn  sigma_m MPa | first MPa    diff scatter |  peak MPa    diff scatter | start  early  angle | Hondros to 0.6 R, % of the centre"
    );
    for a in published::anchors() {
        if !coordinations.is_empty() && !coordinations.contains(&a.coordination) {
            continue;
        }
        let (name, target) = if a.young_modulus < 100e9 { ("glass", 50e6) } else { ("alumina", 380e6) };
        let tensile_strength = target / published::strength_ratio(a.radius_ratio, a.coordination);
        let compressive_strength = (crush > 1.0).then_some(crush * tensile_strength);
        let criterion = FractureCriterion::Principal(Principal {
            tensile_strength,
            compressive_strength,
            level: Level::Neighbours,
        });
        let (mut first, mut peak) = (Vec::new(), Vec::new());
        let (mut start, mut early, mut angle, mut profile) = (0.0, 0.0, 0.0, vec![(0.0, 0.0); 6]);
        for packing in &packings {
            let mut sample = Sample::new(packing.clone(), a.coordination, Convention::All)?;
            sample.set_micro(Micro { radius_ratio: a.radius_ratio, young_modulus: a.beam_modulus })?;
            let broken = lab::break_sample(&sample, test, &lab::FailureOptions::new(test, criterion))?;
            first.push(broken.first_break.unwrap_or(f64::NAN));
            peak.push(broken.strength);
            let share = 1.0 / seeds as f64;
            if let Some(g) = lab::geometry(&sample, test, &broken.outcome.cracks) {
                start += share * g.start;
                early += share * g.early;
                angle += share * g.angle.unwrap_or(f64::NAN);
            }
            if test == lab::Failure::Brazilian
                && let (Some(point), Some(crack)) = (broken.outcome.first, broken.outcome.cracks.first())
            {
                let slices = lab::diameter(&sample, &broken.outcome.first_state, point.load / crack.time);
                for (sum, slice) in profile.iter_mut().zip(&slices) {
                    *sum = (sum.0 + share * slice.measured, sum.1 + share * slice.theory);
                }
            }
        }
        let ((f, sf), (p, sp)) = (spread(&first), spread(&peak));
        let centre = lab::hondros(0.0);
        let differences: Vec<String> =
            profile.iter().map(|(measured, theory)| format!("{:+.1}", 100.0 * (measured - theory) / centre)).collect();
        let differences = if test == lab::Failure::Brazilian { differences.join(" ") } else { String::new() };
        say!(
            "{name:8} {:3} {:12.2} | {:9.2} {:+7.2} {:7.2} | {:9.2} {:+7.2} {:7.2} | {start:5.3} {early:6.3} {angle:6.1} | {differences}",
            a.coordination,
            tensile_strength / 1e6,
            f / 1e6,
            percent(f, crush * target),
            100.0 * sf,
            p / 1e6,
            percent(p, crush * target),
            100.0 * sp,
        );
    }
    Ok(())
}

/// Tension and torsion of a cylinder and bending of a prism of silica glass with the beams of Jebahi et al. (2015).
fn silica(count: usize, seeds: u64, criterion: FractureCriterion) -> Result<(), CalibrateError> {
    let tests = [
        ("tension", lab::Failure::Tension, Domain::cylinder(5e-3, 1e-3)),
        ("bending", lab::Failure::Bending, Domain::cuboid(5e-3, 1.772e-3, 1.772e-3)),
        ("torsion", lab::Failure::Torsion, Domain::cylinder(5e-3, 1e-3)),
    ];
    say!(
        "{criterion:?}: {count} particles, {seeds} packings of 5 mm length; peak and first break in MPa, peak against tension in %"
    );
    let mut reference = None;
    for (name, test, domain) in tests {
        let (mut first, mut peak) = (Vec::new(), Vec::new());
        for seed in 1..=seeds {
            let packing = pack(&PackSpec::new(domain.clone(), count, seed))?;
            let mut sample = Sample::new(packing, 6.2, Convention::Interior)?;
            sample.set_micro(Micro { radius_ratio: 0.68, young_modulus: 295.5e9 })?;
            let mut options = lab::FailureOptions::new(test, criterion);
            // Strength is asked, not the whole fall of the load.
            options.stop = options.stop.max(0.8);
            let broken = lab::break_sample(&sample, test, &options)?;
            first.push(broken.first_break.unwrap_or(f64::NAN));
            peak.push(broken.strength);
        }
        let ((f, sf), (p, sp)) = (spread(&first), spread(&peak));
        let reference = *reference.get_or_insert(p);
        let each: Vec<String> = peak.iter().map(|v| format!("{:.1}", v / 1e6)).collect();
        say!(
            "{name:8} peak {:6.2} ({:.1} %) {:+6.1} %   first {:6.2} ({:.1} %)   each {}",
            p / 1e6,
            100.0 * sp,
            percent(p, reference),
            f / 1e6,
            100.0 * sf,
            each.join(" ")
        );
    }
    Ok(())
}

/// Mean, and standard deviation over the mean.
pub(super) fn spread(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square: f64 = values.iter().map(|v| (v / mean - 1.0).powi(2)).sum();
    (mean, (square / (count - 1.0).max(1.0)).sqrt())
}
