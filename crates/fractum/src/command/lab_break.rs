//! `fractum lab break`: a sample loaded until it is in two.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};
use fractum::{Failure, say};
use fractum_calibrate::{Micro, Sample, lab, published};
use fractum_case::{Dimension, parse_quantity};
use fractum_dem::criterion::{BreakMode, CriterionNumbers, EndMoments, FractureCriterion, Level};
use fractum_dem::{Batch, CrackFaces, Dof6, LoadPoint, Particles, Piece, pieces};
use fractum_math::Vec3;
use fractum_output::atomic;
use fractum_output::fragments::{self, Fragment};
use fractum_output::frames::cracks::{self, Columns};
use fractum_pack::Convention;
use fractum_scene::equivalent_diameter;
use fractum_vtk::{Compression, Field, PolyCells, PolyData};

use super::shape::{ShapeArguments, choice, pressure};

/// Pictures among the files that are told.
const PICTURES: &str = if cfg!(feature = "report") { "load.svg, picture.png, " } else { "" };

/// Arguments of `fractum lab break`.
#[derive(Args)]
pub(crate) struct BreakArguments {
    /// What is done to the sample.
    #[arg(value_enum)]
    test: Test,
    #[command(flatten)]
    shape: ShapeArguments,
    /// Coordination of the bonds.
    #[arg(long, default_value_t = 10.0)]
    coordination: f64,
    /// How the coordination is counted.
    #[arg(long, value_parser = choice::<Convention>(), default_value = "interior")]
    convention: Convention,
    /// Beam radius over the mean particle radius.
    #[arg(long, default_value_t = 0.348)]
    radius_ratio: f64,
    /// Share by which bonds are stiffer for each of their particles at a wall.
    #[arg(long, default_value_t = 0.0)]
    wall_stiffening: f64,
    /// Take the stress of particles at walls at these, by its gradient, instead of at the middle of their neighbourhoods.
    #[arg(long)]
    at_walls: bool,
    /// Young's modulus of the beams, such as "678 GPa".
    #[arg(long, default_value = "678 GPa")]
    beam_young: String,
    #[command(flatten)]
    criterion: CriterionArguments,
    /// What breaks between two equilibria: for every overloaded particle, or one bond only.
    #[arg(long, value_parser = choice::<Batch>(), default_value = "site")]
    batch: Batch,
    /// Largest nominal strain; a sample that holds says how close it came.
    #[arg(long)]
    limit: Option<f64>,
    /// Load over its peak below which a sample whose cracks have come to rest has lost its strength; 0.02 in
    /// tension, 0.97 in bending, 0.9 elsewhere.
    #[arg(long)]
    stop: Option<f64>,
    /// Unbalanced forces over the applied ones at which an equilibrium is accepted.
    #[arg(long, default_value_t = 1e-3)]
    residual: f64,
    #[command(flatten)]
    motion: MotionArguments,
    /// Folder for the results.
    #[arg(short, long, default_value = "results/lab/break")]
    output: PathBuf,
}

/// When bonds break.
#[derive(Args)]
struct CriterionArguments {
    /// When bonds break.
    #[arg(long, value_parser = criterion_names(), default_value = "principal")]
    criterion: String,
    /// Strength of the criterion, in tension, such as "60 MPa"; by default the one that gives the material 50 MPa
    /// by eq. (22) of Nguyen et al. (2019).
    #[arg(long)]
    strength: Option<String>,
    /// Strength of the criterion in compression, such as "600 MPa"; ten times --strength where a criterion needs one.
    #[arg(long)]
    compressive: Option<String>,
    /// Friction angle of mohr-coulomb, in degrees.
    #[arg(long, default_value_t = 35.0)]
    friction_angle: f64,
    /// Neighbours that the stress is taken over: 0 none, 1 those bonded to the particle, 2 theirs too.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u8).range(0..=2))]
    level: u8,
    /// Bending moment that the beam criterion takes.
    #[arg(long, value_parser = choice::<EndMoments>(), default_value = "mean")]
    moments: EndMoments,
}

/// How the sample is broken in motion.
#[derive(Args)]
struct MotionArguments {
    /// Break the sample in motion too, by explicit steps with the supports at constant speed: the time in which the load
    /// would rise from zero to the first break, in times that a wave takes along the sample; 80 is slow.
    #[arg(long)]
    transits: Option<f64>,
    /// Density of the continuum, for motion and for the mass of fragments.
    #[arg(long, default_value = "2500 kg/m^3")]
    density: String,
    /// Friction of crack faces, in motion.
    #[arg(long, default_value_t = 0.5)]
    friction: f64,
    /// Time step over the largest stable one, in motion.
    #[arg(long, default_value_t = 0.5)]
    safety: f64,
}

#[derive(Clone, Copy, ValueEnum)]
enum Test {
    /// A box or cylinder pulled along x.
    Tension,
    /// A box or cylinder pressed along x.
    Compression,
    /// A box along x bent by rotations of its ends about z.
    Bending,
    /// A cylinder twisted.
    Torsion,
    /// A disc (short cylinder) pressed across its diameter by two arcs of 24 degrees.
    Brazilian,
}

/// Names of the criteria.
fn criterion_names() -> PossibleValuesParser {
    PossibleValuesParser::new(FractureCriterion::KINDS.iter().map(|kind| kind.name))
}

impl From<Test> for lab::Failure {
    fn from(test: Test) -> Self {
        match test {
            Test::Tension => lab::Failure::Tension,
            Test::Compression => lab::Failure::Compression,
            Test::Bending => lab::Failure::Bending,
            Test::Torsion => lab::Failure::Torsion,
            Test::Brazilian => lab::Failure::Brazilian,
        }
    }
}

/// Tensile strength of the material that the default strength of the criterion stands for [Pa].
const DEFAULT_STRENGTH: f64 = 50e6;

impl BreakArguments {
    fn criterion(&self, sample: &Sample) -> Result<FractureCriterion, Failure> {
        let CriterionArguments { criterion, strength, compressive, friction_angle, level, moments } = &self.criterion;
        let tensile_strength = match strength {
            Some(text) => pressure(text)?,
            None => DEFAULT_STRENGTH / published::strength_ratio(self.radius_ratio, sample.network.coordination_all),
        };
        let given = compressive.as_deref().map(pressure).transpose()?;
        // Pressed samples need a strength in compression; elsewhere it is there when asked for.
        let pressed = matches!(self.test, Test::Compression).then_some(10.0 * tensile_strength);
        let numbers = CriterionNumbers {
            compressive_strength: given.or(pressed),
            friction_angle: friction_angle.to_radians(),
            level: Level::from_number(*level).unwrap_or_default(),
            moments: *moments,
            ..CriterionNumbers::new(tensile_strength)
        };
        let kind = FractureCriterion::KINDS.iter().find(|kind| kind.name == criterion);
        let unknown = || Failure::input(format!("no criterion \"{criterion}\""));
        kind.map(|kind| (kind.make)(&numbers)).ok_or_else(unknown)
    }
}

/// Breaks a sample, reports and writes.
pub(crate) fn run(arguments: &BreakArguments) -> Result<(), Failure> {
    let wrong = |error: fractum_calibrate::CalibrateError| Failure::input(error.to_string());
    let micro = Micro { radius_ratio: arguments.radius_ratio, young_modulus: pressure(&arguments.beam_young)? };
    let packing = arguments.shape.packing()?;
    let started = Instant::now();
    let sample = Sample::new(packing, arguments.coordination, arguments.convention).map_err(wrong)?;
    let mut sample = sample.stiffen_walls(arguments.wall_stiffening).map_err(wrong)?;
    if arguments.at_walls {
        sample = sample.read_at_walls();
    }
    sample.set_micro(micro).map_err(|error| Failure::input(error.to_string()))?;
    let criterion = arguments.criterion(&sample)?;
    if arguments.wall_stiffening > 0.0 && criterion.level().is_none() {
        return Err(Failure::input(
            "--wall-stiffening has no effect on a criterion of single beams; choose one of the stress of particles",
        ));
    }
    let test: lab::Failure = arguments.test.into();
    let mut options = lab::FailureOptions::new(test, criterion);
    options.batch = arguments.batch;
    options.limit = arguments.limit.unwrap_or(f64::INFINITY);
    options.stop = arguments.stop.unwrap_or(options.stop);
    options.tolerance.residual = arguments.residual;
    let broken = lab::break_sample(&sample, test, &options).map_err(wrong)?;
    let seconds = started.elapsed().as_secs_f64();
    let folder = &arguments.output;
    atomic::create_folder(folder)?;
    let mut summary = summary(&sample, test, &criterion, &broken, seconds);
    let density = parse_quantity(&arguments.motion.density, Dimension::DENSITY).map_err(Failure::input)?;
    if let Some(transits) = arguments.motion.transits {
        let faces = CrackFaces { friction: arguments.motion.friction, damping_ratio: 0.0 };
        let motion = lab::MotionOptions {
            density,
            transits,
            of: None,
            pressure: 0.0,
            start: 0.9,
            faces,
            safety: arguments.motion.safety,
        };
        let started = Instant::now();
        let moved = lab::break_in_motion(&sample, test, &options, &motion).map_err(wrong)?;
        say!(
            "in motion       first break {:.4e} Pa, load peak {:.4e} Pa, balance to {:.1e}; {} steps, {:.1} s",
            moved.first_break.unwrap_or(f64::NAN),
            moved.strength,
            moved.energy.residual_max_relative,
            moved.steps,
            started.elapsed().as_secs_f64()
        );
        summary["motion"] = serde_json::to_value(&moved).unwrap_or_default();
        atomic::write(&folder.join("motion.csv"), load_curve(&moved.curve, &broken).as_bytes())?;
        write_fragments(&folder.join("motion-fragments.csv"), moved.pieces, density)?;
    }
    atomic::write(&folder.join("summary.json"), serde_json::to_string_pretty(&summary).unwrap_or_default().as_bytes())?;
    write(folder, &sample, &broken)?;
    write_fragments(&folder.join("fragments.csv"), pieces_at_rest(&sample, &broken, density)?, density)?;
    show(&sample, test, &criterion, &broken);
    say!(
        "{seconds:.1} s; load.csv, cracks.csv, fragments.csv, broken.vtp, particles.vtp, {PICTURES}summary.json in {}",
        folder.display()
    );
    Ok(())
}

/// What the terminal shows.
fn show(sample: &Sample, test: lab::Failure, criterion: &FractureCriterion, broken: &lab::Broken) {
    let outcome = &broken.outcome;
    match (broken.first_break, outcome.closest) {
        (Some(first), _) => {
            say!("first break     {:.4e} Pa nominal stress", first);
            say!("load peak       {:.4e} Pa after {} broken bonds", broken.strength, outcome.peak.broken);
            say!("broken bonds    {} of {}", outcome.cracks.len(), sample.network.pairs.len());
        }
        (None, Some(site)) => say!(
            "nothing broke up to {:.4e} Pa: the largest ratio is {:.4}, at {} {}",
            broken.strength,
            site.ratio,
            if criterion.level().is_some() { "particle" } else { "bond" },
            site.index
        ),
        (None, None) => say!("nothing bears anything"),
    }
    if let Some(g) = lab::geometry(sample, test, &outcome.cracks) {
        let angle = g.angle.map_or(String::new(), |a| format!("; angle {a:.1} degrees"));
        say!(
            "crack           began at {:.3} of the radius or half length ({:.3} for the first twenty){angle}",
            g.start,
            g.early
        );
    }
}

fn summary(
    sample: &Sample,
    test: lab::Failure,
    criterion: &FractureCriterion,
    broken: &lab::Broken,
    seconds: f64,
) -> serde_json::Value {
    let outcome = &broken.outcome;
    let parts = outcome.graph.parts();
    let mut sizes = vec![0usize; parts.count];
    parts.of.iter().for_each(|&p| sizes[p as usize] += 1);
    sizes.sort_unstable_by(|a, b| b.cmp(a));
    sizes.truncate(10);
    let mut modes = serde_json::Map::new();
    for mode in BreakMode::ALL {
        let count = outcome.cracks.iter().filter(|c| c.mode == mode).count();
        modes.insert(mode.word().into(), count.into());
    }
    let last = outcome.curve.last();
    let diameter = (test == lab::Failure::Brazilian).then(|| {
        // A state at load factor one has the load of the first break over its factor.
        let factor = outcome.cracks.first().map_or(f64::NAN, |c| c.time);
        let load = outcome.first.map_or(f64::NAN, |p| p.load) / factor;
        lab::diameter(sample, &outcome.first_state, load)
    });
    serde_json::json!({
        "test": test,
        "criterion": criterion,
        "particles": sample.packing.len(),
        "seed": sample.packing.seed,
        "bonds": sample.network.pairs.len(),
        "coordination": { "all": sample.network.coordination_all, "interior": sample.network.coordination_interior },
        "volume_fraction": sample.fraction,
        "first_break": broken.first_break,
        "strength": broken.strength,
        "first": outcome.first,
        "peak": outcome.peak,
        "peak_strain": outcome.peak.displacement * broken.strain_per_displacement,
        "separated": outcome.separated,
        "closest": outcome.closest,
        "broken_bonds": outcome.cracks.len(),
        "modes": modes,
        "crack_area": outcome.cracks.iter().map(|c| c.area).sum::<f64>(),
        "crack": lab::geometry(sample, test, &outcome.cracks),
        "fragments": { "count": parts.count, "largest": sizes },
        "energy": {
            "external": last.map(|l| l.work),
            "elastic": last.map(|l| l.elastic),
            "broken_bonds": outcome.cracks.iter().map(|c| c.energy).sum::<f64>(),
        },
        "diameter": diameter,
        "equilibria": outcome.effort.0,
        "iterations": outcome.effort.1,
        "iterations_to_peak": outcome.effort_to_peak.1,
        "seconds": seconds,
    })
}

/// A load curve as CSV.
fn load_curve(curve: &[LoadPoint], broken: &lab::Broken) -> String {
    let mut text =
        String::from("displacement,load,nominal stress [Pa],nominal strain,elastic [J],work [J],broken bonds\n");
    for p in curve {
        let strain = p.displacement * broken.strain_per_displacement;
        let (u, f, e, w, n) = (p.displacement, p.load, p.elastic, p.work, p.broken);
        // Writing into a string has no way to fail.
        let _ = writeln!(text, "{u:e},{f:e},{:e},{strain:e},{e:e},{w:e},{n}", f * broken.stress_per_load);
    }
    text
}

fn write(folder: &Path, sample: &Sample, broken: &lab::Broken) -> Result<(), Failure> {
    let outcome = &broken.outcome;
    let stress = broken.stress_per_load;
    atomic::write(&folder.join("load.csv"), load_curve(&outcome.curve, broken).as_bytes())?;
    let columns = Columns { time: "load factor", load: Some(("nominal stress [Pa]", stress)) };
    let table = cracks::table(outcome.cracks.iter().map(|c| (None, c)), columns);
    atomic::write(&folder.join("cracks.csv"), table.as_bytes())?;
    #[cfg(feature = "report")]
    super::lab_pictures::load(&folder.join("load.svg"), broken)?;
    fields(folder, sample, broken)
}

/// The pieces in the last state.
fn pieces_at_rest(sample: &Sample, broken: &lab::Broken, density: f64) -> Result<Vec<Piece>, Failure> {
    let outcome = &broken.outcome;
    let factor = outcome.curve.last().map_or(0.0, |point| point.displacement) / broken.displacement;
    let shifted = sample.packing.position.iter().zip(&outcome.last_state);
    let position = shifted.map(|(x, u)| x + Vec3::new(u[0], u[1], u[2]) * factor).collect();
    let particles = Particles::at_rest(position, sample.packing.radius.clone(), density * sample.measured_volume())
        .map_err(|error| Failure::input(format!("{error}; check --density")))?;
    Ok(pieces(&particles, outcome.graph.live_pairs(), |i| particles.mass[i]))
}

/// `fragments.csv` as a run writes it, the heaviest piece first.
fn write_fragments(path: &Path, mut pieces: Vec<Piece>, density: f64) -> Result<(), Failure> {
    pieces.sort_by(|a, b| b.mass.total_cmp(&a.mass));
    let fragment = |(id, piece): (u64, &Piece)| Fragment {
        id,
        mass: piece.mass,
        volume: piece.content / density,
        nodes: piece.particles.len() as u64,
        elements: 0,
        centroid: piece.centroid.into(),
        velocity: piece.velocity.into(),
        largest_extent: (piece.bounds[1] - piece.bounds[0]).max(),
        stays: false,
        size: equivalent_diameter(piece.content / density, None),
    };
    let table: Vec<Fragment> = (1..).zip(&pieces).map(fragment).collect();
    Ok(fragments::write(path, &table)?)
}

/// Files for ParaView, and the picture.
fn fields(folder: &Path, sample: &Sample, broken: &lab::Broken) -> Result<(), Failure> {
    let outcome = &broken.outcome;
    let points: Vec<[f64; 3]> = sample.packing.position.iter().map(|x| (*x).into()).collect();
    let polygons = cracks::polygons(outcome.cracks.iter(), None)?;
    atomic::write(&folder.join("broken.vtp"), &polygons.bytes())?;
    let parts = outcome.graph.parts();
    let fragment: Vec<i32> = parts.of.iter().map(|&p| p as i32).collect();
    let lost = cracks::lost_bonds(points.len(), outcome.cracks.iter());
    let displacement = |state: &[Dof6]| state.iter().map(|u| [u[0], u[1], u[2]]).collect::<Vec<[f64; 3]>>();
    let (first, last) = (displacement(&outcome.first_state), displacement(&outcome.last_state));
    let data = PolyData {
        points: &points,
        cells: PolyCells::Points,
        point_data: &[
            Field::scalar("radius", &sample.packing.radius),
            Field::integer("fragment", &fragment),
            Field::scalar("broken_bonds", &lost),
            Field::vector("displacement_per_load_factor", &last),
            Field::vector("displacement_per_load_factor_unbroken", &first),
        ],
        cell_data: &[],
        time: None,
    };
    let file = data.pending(Compression::default()).map_err(|error| Failure::Output(error.into()))?;
    atomic::write(&folder.join("particles.vtp"), &file.bytes())?;
    #[cfg(feature = "report")]
    super::lab_pictures::section(&folder.join("picture.png"), sample, &points, &lost)?;
    Ok(())
}
