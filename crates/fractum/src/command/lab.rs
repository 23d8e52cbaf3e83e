//! `fractum lab`: virtual tests on bonded packings.

use clap::{Args, Subcommand, ValueEnum};
use fractum::{ExitCode, Failure, say};
use fractum_calibrate::{CalibrateError, Micro, Sample, lab};
use fractum_case::{Dimension, parse_quantity};
use fractum_dem::Tolerance;
use fractum_pack::Convention;

use super::lab_break::{self, BreakArguments};
use super::shape::{ShapeArguments, choice, pressure};

/// Arguments of `fractum lab`.
#[derive(Subcommand)]
pub(crate) enum LabCommand {
    /// One test on one sample.
    Test(Box<TestArguments>),
    /// Load a sample until it is in two.
    Break(Box<BreakArguments>),
    /// A word that is none of these.
    #[command(external_subcommand)]
    Other(Vec<String>),
}

/// Published tables, which the tests record.
const RECORDS: [&str; 5] = ["strength", "tables", "virial", "chain", "convergence"];

/// One virtual test.
#[derive(Args)]
pub(crate) struct TestArguments {
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
    #[arg(long, default_value_t = 0.4)]
    radius_ratio: f64,
    /// Young's modulus of the beams, such as "700 GPa".
    #[arg(long, default_value = "1 GPa")]
    beam_young: String,
    /// Share by which bonds are stiffer for each of their particles at a wall.
    #[arg(long, default_value_t = 0.0)]
    wall_stiffening: f64,
    /// Density of the continuum, for the tests in time.
    #[arg(long, default_value = "1000 kg/m^3")]
    density: String,
    /// Axis of a tension test.
    #[arg(long, value_enum, default_value = "x")]
    axis: Axis,
}

#[derive(Clone, Copy, ValueEnum)]
enum Test {
    Tension,
    Hydrostatic,
    Shear,
    Bending,
    Torsion,
    /// Period of free vibration along a cylinder.
    TensionPeriod,
    /// Period of free vibration across a cylinder.
    BendingPeriod,
    /// Period of free vibration about a cylinder's axis.
    TorsionPeriod,
    /// Speed of a pulse along a cylinder.
    Impact,
}

#[derive(Clone, Copy, ValueEnum)]
enum Axis {
    X,
    Y,
    Z,
}

fn wrong(error: CalibrateError) -> Failure {
    Failure::input(error.to_string())
}

/// Carries out a laboratory command.
pub(crate) fn run(command: &LabCommand) -> Result<ExitCode, Failure> {
    match command {
        LabCommand::Test(arguments) => test(arguments)?,
        LabCommand::Break(arguments) => lab_break::run(arguments)?,
        LabCommand::Other(words) => {
            let word = words.first().map_or("", String::as_str);
            let known = RECORDS.contains(&word);
            let record = "is a matter of the tests: cargo run --release -p fractum-record --";
            return Err(Failure::input(match known {
                true => format!("\"{word}\" {record} {}", words.join(" ")),
                false => format!("no test \"{word}\"; fractum lab test and fractum lab break load a sample"),
            }));
        }
    }
    Ok(ExitCode::Done)
}

fn test(arguments: &TestArguments) -> Result<(), Failure> {
    let micro = Micro { radius_ratio: arguments.radius_ratio, young_modulus: pressure(&arguments.beam_young)? };
    let density = parse_quantity(&arguments.density, Dimension::DENSITY).map_err(Failure::input)?;
    if density <= 0.0 {
        return Err(Failure::input(format!("density {density}; expected a positive number of kg/m^3")));
    }
    let packing = arguments.shape.packing()?;
    let result = (|| -> Result<serde_json::Value, CalibrateError> {
        let sample = Sample::new(packing, arguments.coordination, arguments.convention)?;
        let mut sample = sample.stiffen_walls(arguments.wall_stiffening)?;
        sample.set_micro(micro)?;
        let tolerance = Tolerance::default();
        let value = match arguments.test {
            Test::Tension => serde_json::to_value(lab::tension(&sample, arguments.axis as usize, None, tolerance)?.0),
            Test::Hydrostatic => serde_json::to_value(lab::hydrostatic(&sample, tolerance)?.0),
            Test::Shear => serde_json::to_value(lab::shear(&sample, tolerance)?.0),
            Test::Bending => serde_json::to_value(lab::bending(&sample, tolerance)?.0),
            Test::Torsion => serde_json::to_value(lab::torsion(&sample, tolerance)?.0),
            // The theory takes the elastic constants that the same sample shows in tension.
            timed => {
                let tension = lab::tension(&sample, 0, None, tolerance)?.0;
                let (young, poisson) = (tension.young_modulus, tension.poisson_ratio);
                let mode = match timed {
                    Test::TensionPeriod => lab::VibrationMode::Tension,
                    Test::BendingPeriod => lab::VibrationMode::Bending,
                    Test::TorsionPeriod => lab::VibrationMode::Torsion,
                    _ => return Ok(serde_json::to_value(lab::impact(&sample, density, young)?).unwrap_or_default()),
                };
                serde_json::to_value(lab::vibration(&sample, mode, density, young, poisson)?)
            }
        };
        Ok(value.unwrap_or_default())
    })();
    let result = result.map_err(wrong)?;
    say!("{}", serde_json::to_string_pretty(&result).unwrap_or_default());
    Ok(())
}
