//! `fractum calibrate`: a material in, micro-parameters out.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Args, ValueEnum};
use fractum::{ExitCode, Failure, say};
use fractum_calibrate::strength_law::{self, READINGS, StrengthLaw, Survey};
use fractum_calibrate::{Calibration, Request, StrengthCriterion, calibrate, laws, published};
use fractum_case::{Dimension, parse_quantity};
use fractum_output::atomic;
use fractum_pack::Convention;

use super::shape::{choice, pressure};

/// Arguments of `fractum calibrate`.
#[derive(Args)]
pub(crate) struct CalibrateArguments {
    /// Young's modulus, such as "72 GPa".
    #[arg(long, required_unless_present_any = ["refit", "refit_strength"])]
    young: Option<String>,
    /// Poisson's ratio.
    #[arg(long, required_unless_present_any = ["refit", "refit_strength"])]
    poisson: Option<f64>,
    /// Density, written into material.toml.
    #[arg(long)]
    density: Option<String>,
    /// Tensile strength, such as "50 MPa": the strength of the criterion is found by breaking two packings.
    #[arg(long)]
    strength: Option<String>,
    /// Criterion whose strength is found.
    #[arg(long, value_enum, default_value = "principal", requires = "strength")]
    criterion: CriterionArgument,
    /// Take the stress of particles at walls there, as materials.NAME.fracture.at_walls does; not with single beams.
    #[arg(long, requires = "strength")]
    at_walls: bool,
    /// Coordination of the bonds; chosen to suit Poisson's ratio if not given.
    #[arg(long)]
    coordination: Option<f64>,
    /// How the coordination is counted.
    #[arg(long, value_parser = choice::<Convention>(), default_value = "interior")]
    convention: Convention,
    /// Particles of the calibration packings.
    #[arg(long, default_value_t = 10_000)]
    particles: usize,
    /// Seed of the first packing.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Packings to calibrate on; the result is their mean.
    #[arg(long, default_value_t = 1)]
    packings: usize,
    /// Folder for material.toml and calibration.json.
    #[arg(short, long, default_value = "calibration")]
    output: PathBuf,
    /// Make the stored laws again, into laws.csv and database.csv of the output folder.
    #[arg(long)]
    refit: bool,
    /// Fit the strength over that of the principal criterion, for the load peak and for the first break, to tension tests
    /// of our own packings, and compare with eq. (22) of Nguyen et al. (2019): strength-law.csv and strength-tests.csv.
    #[arg(long, conflicts_with = "refit")]
    refit_strength: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum CriterionArgument {
    Principal,
    Beam,
    Hydrostatic,
}

/// Calibrates, checks, reports and writes.
pub(crate) fn run(arguments: &CalibrateArguments) -> Result<ExitCode, Failure> {
    let wrong = |error: fractum_calibrate::CalibrateError| Failure::input(error.to_string());
    let started = Instant::now();
    let folder = &arguments.output;
    if arguments.refit {
        let points = laws::survey(&laws::Survey::default()).map_err(wrong)?;
        let fit = |convention| laws::Law::fit(&points, convention).map_err(wrong);
        let laws = [fit(Convention::All)?, fit(Convention::Interior)?];
        atomic::create_folder(folder)?;
        atomic::write(&folder.join("laws.csv"), laws::write(&laws).as_bytes())?;
        atomic::write(&folder.join("database.csv"), laws::write_database(&points).as_bytes())?;
        for law in &laws {
            let ([nu, nu_max], [e, e_max]) = (law.poisson_residual, law.young_residual);
            say!(
                "{:8} {} tests: nu rms {nu:.5} max {nu_max:.5}, E rms {:.2} % max {:.2} %",
                law.convention,
                law.tests,
                100.0 * e,
                100.0 * e_max
            );
        }
        say!("{} tests in {:.0} s; laws in {}", points.len(), started.elapsed().as_secs_f64(), folder.display());
        return Ok(ExitCode::Done);
    }
    if arguments.refit_strength {
        return refit_strength(folder, started);
    }
    let mut request =
        Request::new(pressure(arguments.young.as_deref().unwrap_or_default())?, arguments.poisson.unwrap_or(f64::NAN));
    let criterion = match arguments.criterion {
        CriterionArgument::Principal => StrengthCriterion::Principal,
        CriterionArgument::Beam => StrengthCriterion::Beam,
        CriterionArgument::Hydrostatic => StrengthCriterion::Hydrostatic,
    };
    let strength = arguments.strength.as_deref().map(pressure).transpose()?;
    request.tensile_strength = strength.map(|strength| (strength, criterion));
    if arguments.at_walls && criterion == StrengthCriterion::Beam {
        return Err(Failure::input("--at-walls has no effect on single beams; choose another --criterion"));
    }
    request.at_walls = arguments.at_walls;
    request.coordination = arguments.coordination;
    request.convention = arguments.convention;
    request.particles = arguments.particles;
    request.seed = arguments.seed;
    request.packings = arguments.packings;
    let density = arguments
        .density
        .as_deref()
        .map(|text| parse_quantity(text, Dimension::DENSITY).map_err(Failure::input))
        .transpose()?;
    let result = calibrate(&request).map_err(wrong)?;
    let seconds = started.elapsed().as_secs_f64();
    show(&result, seconds);
    atomic::create_folder(folder)?;
    let mut json = serde_json::to_value(&result).unwrap_or_default();
    json["seconds"] = seconds.into();
    atomic::write(
        &folder.join("calibration.json"),
        serde_json::to_string_pretty(&json).unwrap_or_default().as_bytes(),
    )?;
    atomic::write(&folder.join("material.toml"), material(&result, density).as_bytes())?;
    say!("material.toml and calibration.json in {}", folder.display());
    Ok(ExitCode::Done)
}

fn refit_strength(folder: &Path, started: Instant) -> Result<ExitCode, Failure> {
    let wrong = |error: fractum_calibrate::CalibrateError| Failure::input(error.to_string());
    let mut points = strength_law::survey(&Survey::fitted()).map_err(wrong)?;
    let law = StrengthLaw::fit(&points).map_err(wrong)?;
    let check = strength_law::survey(&Survey::check()).map_err(wrong)?;
    say!(
        "sigma_M/sigma_m in tension, differences in %: scatter of packings | fit on its {} tests, rms max | fit on {} tests of another packing | eq. (22) on both",
        points.len(),
        check.len()
    );
    for reading in READINGS {
        let fit = |p: &strength_law::Point| law.ratio(reading, p.radius_ratio, p.coordination, p.particles);
        let equation = |p: &strength_law::Point| published::strength_ratio(p.radius_ratio, p.coordination);
        let percent = |[rms, most]: [f64; 2]| format!("{:5.2} {:5.2}", 100.0 * rms, 100.0 * most);
        say!(
            "{:11} {:5.2} | {} | {} | {}   {}",
            format!("{reading:?}"),
            100.0 * strength_law::scatter(&points, reading),
            percent(strength_law::difference(&points, reading, fit)),
            percent(strength_law::difference(&check, reading, fit)),
            percent(strength_law::difference(&points, reading, equation)),
            percent(strength_law::difference(&check, reading, equation)),
        );
    }
    atomic::create_folder(folder)?;
    atomic::write(&folder.join("strength-law.csv"), strength_law::write_law(&law).as_bytes())?;
    points.extend(check);
    atomic::write(&folder.join("strength-tests.csv"), strength_law::write_tests(&points).as_bytes())?;
    say!("{} tests in {:.0} s; law in {}", points.len(), started.elapsed().as_secs_f64(), folder.display());
    Ok(ExitCode::Done)
}

fn show(c: &Calibration, seconds: f64) {
    let (e, nu) = (c.request.young_modulus, c.request.poisson_ratio);
    say!(
        "coordination         {} ({}), reachable Poisson's ratio {:.3} to {:.3}",
        c.coordination,
        c.request.convention,
        c.poisson_range[0],
        c.poisson_range[1]
    );
    say!(
        "beams                radius {:.5} mean radii, E_m {:.4e} Pa, Poisson's ratio 0.3",
        c.micro.radius_ratio,
        c.micro.young_modulus
    );
    if let Some(law) = c.law {
        say!("stored law says      radius {:.5}, E_m {:.4e} Pa", law.radius_ratio, law.young_modulus);
    }
    if let Some([r, y]) = c.scatter {
        say!(
            "scatter              {:.2} % in radius, {:.2} % in E_m over {} packings",
            100.0 * r,
            100.0 * y,
            c.inverted.len()
        );
    }
    let percent = |found: f64, asked: f64| 100.0 * (found / asked - 1.0);
    for (axis, (young, poisson)) in ["x", "y", "z"].iter().zip(c.own_check) {
        say!(
            "tension along {axis}      E {young:.4e} Pa ({:+.2} %), nu {poisson:.4} ({:+.2} %)",
            percent(young, e),
            percent(poisson, nu)
        );
    }
    say!(
        "another packing      E {:.4e} Pa ({:+.2} %), nu {:.4} ({:+.2} %), seed {}, mean over the axes",
        c.check_young_modulus,
        percent(c.check_young_modulus, e),
        c.check_poisson_ratio,
        percent(c.check_poisson_ratio, nu),
        c.check_seed
    );
    if let Some(s) = &c.strength {
        let [[low, high], [first_low, first_high]] = s.range;
        say!(
            "{:?} criterion  {:.4e} Pa for the load peak ({low:.4e} to {high:.4e} on the two packings)",
            s.criterion,
            s.peak
        );
        say!("                     {:.4e} Pa for the first break ({first_low:.4e} to {first_high:.4e})", s.first_break);
        if let Some([peak, first]) = s.own_law {
            say!(
                "                     {peak:.4e} Pa by the stored law for the load peak, {first:.4e} Pa for the first break"
            );
        }
        if let Some(law) = s.law {
            say!("                     {law:.4e} Pa by eq. (22) of Nguyen et al. (2019)");
        }
    }
    say!("{seconds:.1} s");
}

/// The material as a part of a case file.
fn material(c: &Calibration, density: Option<f64>) -> String {
    let mut text = format!(
        "# made by fractum calibrate; independent test: E {:.4e} Pa, nu {:.4}\n[materials.calibrated]\n",
        c.check_young_modulus, c.check_poisson_ratio
    );
    if let Some(density) = density {
        text += &format!("density = \"{density} kg/m^3\"\n");
    }
    text +=
        &format!("young_modulus = \"{:e} Pa\"\npoisson_ratio = {}\n", c.request.young_modulus, c.request.poisson_ratio);
    text += &format!(
        "[materials.calibrated.bonds]\ncoordination = {}\nconvention = \"{}\"\nradius_ratio = {}\nyoung_modulus = \"{:e} Pa\"\n",
        c.coordination, c.request.convention, c.micro.radius_ratio, c.micro.young_modulus
    );
    if let Some(strength) = &c.strength {
        let what = format!("{:?}", strength.criterion).to_lowercase();
        text += &format!(
            "[materials.calibrated.fracture] # for the load peak in tension\ncriterion = \"{what}\"\ncriterion_strength = \"{:e} Pa\"\n",
            strength.peak
        );
        if c.request.at_walls {
            text += "at_walls = true\n";
        }
    }
    text
}
