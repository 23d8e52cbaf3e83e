//! Virtual tests against the tables of Nguyen, André and Huger (2019) and of Jebahi et al. (2015), ch. 2 and 4.
//!
//! The packings are our own, so that agreement is statistical: tolerances are a few times the scatter over packings
//! (about 0.4 % in E, 0.3 % in ν at 10,000 particles) plus the difference the authors print for themselves.

use std::sync::LazyLock;

use fractum_calibrate::{CalibrateError, Micro, Request, Sample, calibrate, invert, lab};
use fractum_dem::criterion::{BeamRankine, EndMoments};
use fractum_dem::{FractureCriterion, Tolerance};
use fractum_pack::{Convention, Domain, PackSpec, Packing, pack};

struct Row {
    material: String,
    values: Vec<f64>,
}

fn rows(text: &str) -> Vec<Row> {
    let data = text.lines().filter(|l| l.starts_with("glass") || l.starts_with("alumina"));
    data.map(|line| {
        let mut words = line.split(',');
        let material = words.next().unwrap().to_string();
        Row { material, values: words.map(|w| w.parse().unwrap()).collect() }
    })
    .collect()
}

fn target(material: &str) -> (f64, f64, f64) {
    if material == "glass" { (72e9, 0.23, 44.44e9) } else { (340e9, 0.24, 217.9e9) }
}

fn bonded(packing: &Packing, coordination: f64, radius_ratio: f64, young_modulus: f64) -> Sample {
    let mut sample = Sample::new(packing.clone(), coordination, Convention::All).unwrap();
    sample.set_micro(Micro { radius_ratio, young_modulus }).unwrap();
    sample
}

#[test]
#[cfg_attr(debug_assertions, ignore = "heavy: run with --release")]
fn tension_reproduces_rows_of_tables_5_and_6() {
    tension_reproduces(4);
}

#[test]
#[ignore = "heavy: all rows"]
fn tension_reproduces_tables_5_and_6() {
    tension_reproduces(1);
}

/// Every so many rows of the tables.
fn tension_reproduces(every: usize) {
    let packings: Vec<Packing> =
        (1..=3).map(|seed| pack(&PackSpec::new(Domain::cuboid(2e-3, 2e-3, 2e-3), 10_000, seed)).unwrap()).collect();
    for Row { material, values } in rows(include_str!("../reference/nguyen2019_elastic.csv")).into_iter().step_by(every)
    {
        let (coordination, young, poisson) = (values[0], target(&material).0, target(&material).1);
        let (mut mean_e, mut mean_nu) = (0.0, 0.0);
        for packing in &packings {
            let sample = bonded(packing, coordination, values[1], values[2] * 1e9);
            let (tension, _) = lab::tension(&sample, 0, None, Tolerance::default()).unwrap();
            mean_e += (tension.young_modulus / young - 1.0) / 3.0;
            mean_nu += (tension.poisson_ratio / poisson - 1.0) / 3.0;
        }
        println!("{material:8} cn {coordination:2}: E {:+.2} %  nu {:+.2} %", 100.0 * mean_e, 100.0 * mean_nu);
        // The authors' own alumina row at 13 is already 1.7 % off its target.
        let (allowed_e, allowed_nu) = match (coordination, material.as_str()) {
            (13.0, "alumina") => (0.035, 0.015),
            (8.0.., _) => (0.02, 0.015),
            _ => (0.04, 0.04),
        };
        assert!(mean_e.abs() < allowed_e, "{material} cn {coordination}: E off by {mean_e}");
        assert!(mean_nu.abs() < allowed_nu, "{material} cn {coordination}: nu off by {mean_nu}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "heavy: run with --release")]
fn hydrostatic_compression_of_a_sphere_reproduces_tables_7_and_8() {
    let packing = pack(&PackSpec::new(Domain::sphere(5e-3), 15_000, 1)).unwrap();
    for Row { material, values } in rows(include_str!("../reference/nguyen2019_elastic.csv")) {
        let sample = bonded(&packing, values[0], values[1], values[2] * 1e9);
        let (result, _) = lab::hydrostatic(&sample, Tolerance::default()).unwrap();
        let difference = result.bulk_modulus / target(&material).2 - 1.0;
        println!(
            "{material:8} cn {:2}: K {:+.2} % gauge {:?}",
            values[0],
            100.0 * difference,
            result.gauge_bulk_modulus
        );
        assert!(difference.abs() < 0.025, "{material} cn {}: K off by {difference}", values[0]);
    }
}

/// A silica cylinder (75 GPa, 0.17, 2200 kg/m³), 13 particles across, with the coordination of the book: its beams are
/// calibrated.
static SILICA: LazyLock<(Sample, Micro)> = LazyLock::new(|| {
    let packing = pack(&PackSpec::new(Domain::cylinder(5e-3, 0.5e-3), 10_000, 1)).unwrap();
    let mut sample = Sample::new(packing, 6.2, Convention::Interior).unwrap();
    let found = invert(&mut sample, 75e9, 0.17, 0.68).unwrap();
    (sample, found.micro)
});

#[test]
#[cfg_attr(debug_assertions, ignore = "heavy: run with --release")]
fn a_silica_cylinder_pulls_bends_and_twists_like_table_2_5() {
    let (young, poisson) = (75e9, 0.17);
    let shear = young / (2.0 * (1.0 + poisson));
    let differences = |sample: &Sample| {
        let (tension, _) = lab::tension(sample, 0, None, Tolerance::default()).unwrap();
        let (bending, _) = lab::bending(sample, Tolerance::default()).unwrap();
        let (torsion, _) = lab::torsion(sample, Tolerance::default()).unwrap();
        // Displacements go as one over the modulus.
        [young / tension.young_modulus - 1.0, young / bending.young_modulus - 1.0, shear / torsion.shear_modulus - 1.0]
    };
    let (sample, micro) = &*SILICA;
    let mut published = sample.clone();
    published.set_micro(Micro { radius_ratio: 0.68, young_modulus: 295.5e9 }).unwrap();
    println!("published beams:  tension, bending, torsion {:.4?}", differences(&published));
    let calibrated = differences(sample);
    println!("calibrated beams: tension, bending, torsion {calibrated:.4?} {micro:?}");
    // The book prints 1.20, 4.16 and 6.13 % for a cylinder whose size it does not give. Tension and bending meet that. In
    // torsion the soft layer at the wall weighs with the fourth power of the radius: 13 particles across miss the book's
    // value by 2 %, and the limit here is what this program reaches.
    for (difference, allowed) in calibrated.iter().zip([0.0120, 0.0416, 0.085]) {
        assert!(difference.abs() <= allowed, "{difference} against {allowed}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "heavy: run with --release")]
fn beams_of_published_strength_bear_the_tension_of_table_4_1() {
    let criterion = FractureCriterion::BeamRankine(BeamRankine { strength: 292e6, moments: EndMoments::Mean });
    let options = lab::FailureOptions { stop: 0.8, ..lab::FailureOptions::new(lab::Failure::Tension, criterion) };
    let strength = |seed| {
        let packing = pack(&PackSpec::new(Domain::cylinder(5e-3, 1e-3), 4000, seed)).unwrap();
        let mut sample = Sample::new(packing, 6.2, Convention::Interior).unwrap();
        sample.set_micro(Micro { radius_ratio: 0.68, young_modulus: 295.5e9 }).unwrap();
        lab::break_sample(&sample, lab::Failure::Tension, &options).unwrap().strength
    };
    let mean = 0.5 * (strength(1) + strength(2));
    // The mean of the book; packings scatter by 3 %.
    assert!((mean / 51.8e6 - 1.0).abs() < 0.06, "{mean}");
}

/// Periods over those of theory, less one, of the silica cylinder; `allowed` for each mode.
fn check_periods(modes: &[(lab::VibrationMode, f64)]) {
    let (sample, _) = &*SILICA;
    for &(mode, allowed) in modes {
        let v = lab::vibration(sample, mode, 2200.0, 75e9, 0.17).unwrap();
        let difference = v.period / v.theory - 1.0;
        println!("{mode:?} {difference:+.4} in {} steps", v.steps);
        assert!(difference.abs() <= allowed, "{mode:?}: {difference} against {allowed}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "heavy: run with --release")]
fn a_silica_cylinder_vibrates_like_table_2_6() {
    let impact = lab::impact(&SILICA.0, 2200.0, 75e9).unwrap();
    let speed = impact.wave_speed / impact.theory - 1.0;
    println!("wave speed {speed:+.4}");
    // The book prints 0.38, 0.50 and 0.40 %. Torsion misses its 0.50 %: the rod is soft there as in the static test, and
    // the limit is that of this program.
    assert!(speed.abs() <= 0.0040, "wave speed {speed}");
    check_periods(&[(lab::VibrationMode::Tension, 0.0038), (lab::VibrationMode::Torsion, 0.025)]);
}

#[test]
#[ignore = "a minute, for 29,000 steps: .ci/nightly heavy"]
fn a_silica_cylinder_bends_to_and_fro_like_table_2_6() {
    // The book prints 6.63 %.
    check_periods(&[(lab::VibrationMode::Bending, 0.0663)]);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "heavy: run with --release")]
fn the_moduli_of_one_material_agree() {
    // E and ν from tension, K from compression, G from shear of the same box: K = E/3(1-2ν), G = E/2(1+ν).
    let packing = pack(&PackSpec::new(Domain::cuboid(1e-3, 1e-3, 1e-3), 10_000, 4)).unwrap();
    let sample = bonded(&packing, 10.0, 0.348, 677.94e9);
    let (tension, _) = lab::tension(&sample, 0, None, Tolerance::default()).unwrap();
    let (compression, _) = lab::hydrostatic(&sample, Tolerance::default()).unwrap();
    let (shear, _) = lab::shear(&sample, Tolerance::default()).unwrap();
    let (e, nu) = (tension.young_modulus, tension.poisson_ratio);
    let (bulk, rigidity) = (e / (3.0 * (1.0 - 2.0 * nu)), e / (2.0 * (1.0 + nu)));
    println!(
        "K {:.4} G {:.4}  {tension:?} {compression:?} {shear:?}",
        compression.bulk_modulus / bulk,
        shear.shear_modulus / rigidity
    );
    assert!((compression.bulk_modulus / bulk - 1.0).abs() < 0.03);
    assert!((shear.shear_modulus / rigidity - 1.0).abs() < 0.03);
    // Walls cost a few per cent, so that the gauge section is stiffer by about that much.
    let gauge = tension.gauge_young_modulus.unwrap() / e;
    assert!((0.99..1.05).contains(&gauge), "{gauge}");
}

/// Calibrates materials of these moduli [Pa] and Poisson's ratios, and tests their packings and others.
fn check_calibration(materials: &[(f64, f64)]) {
    for &(young, poisson) in materials {
        let result = calibrate(&Request { seed: 21, ..Request::new(young, poisson) }).unwrap();
        let miss = |(e, nu): (f64, f64)| (e / young - 1.0, nu / poisson - 1.0);
        for axis in result.own_check.map(miss) {
            println!("E {:.0} GPa, nu {poisson}: {:+.2} %, {:+.2} %", young / 1e9, 100.0 * axis.0, 100.0 * axis.1);
            assert!(axis.0.abs() < 0.01 && axis.1.abs() < 0.01, "{result:?}");
        }
        // Another packing differs by the scatter between packings, which thin beams at low coordination (steel, 7.5)
        // raise to about 1 %.
        let other = miss((result.check_young_modulus, result.check_poisson_ratio));
        println!("  another packing: {:+.2} %, {:+.2} %", 100.0 * other.0, 100.0 * other.1);
        let allowed = if result.coordination < 8.0 { 0.02 } else { 0.01 };
        assert!(other.0.abs() < allowed && other.1.abs() < allowed, "{result:?}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "heavy: run with --release")]
fn calibrated_materials_pass_an_independent_test_within_one_per_cent() {
    // Glass, and steel, whose beams are thin.
    check_calibration(&[(72e9, 0.23), (210e9, 0.29)]);
}

#[test]
#[ignore = "half a minute, for four more materials: .ci/nightly heavy"]
fn calibrated_ceramics_and_rocks_pass_an_independent_test_within_one_per_cent() {
    // Alumina, silica, concrete, granite.
    check_calibration(&[(340e9, 0.24), (75e9, 0.17), (30e9, 0.20), (60e9, 0.25)]);
}

#[test]
fn impossible_materials_are_refused_with_what_is_possible() {
    let request = |young, poisson| Request { particles: 1000, ..Request::new(young, poisson) };
    assert!(matches!(calibrate(&request(-1.0, 0.2)), Err(CalibrateError::Material { .. })));
    assert!(matches!(calibrate(&request(1e9, 0.5)), Err(CalibrateError::Material { .. })));
    assert!(matches!(calibrate(&request(f64::NAN, 0.2)), Err(CalibrateError::Material { .. })));
    let error = calibrate(&request(1e9, 0.45)).unwrap_err();
    assert!(matches!(error, CalibrateError::PoissonRange { .. }), "{error}");
    let asked = Request { coordination: Some(10.0), ..request(1e9, 0.35) };
    let error = calibrate(&asked).unwrap_err();
    assert!(matches!(error, CalibrateError::PoissonRange { highest, .. } if highest < 0.35), "{error}");
    let error = calibrate(&Request { coordination: Some(90.0), ..request(1e9, 0.2) }).unwrap_err();
    assert!(matches!(error, CalibrateError::Pack(_)), "{error}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "heavy: run with --release")]
fn stress_of_neighbourhoods_is_that_of_the_section_as_in_table_1() {
    let packing = pack(&PackSpec::new(Domain::cuboid(2e-3, 2e-3, 2e-3), 10_000, 1)).unwrap();
    for radius_ratio in [0.2, 0.6, 1.0] {
        let sample = bonded(&packing, 10.0, radius_ratio, 500e9);
        let [_, first, second] = lab::virial_errors(&sample, sample.fraction, Tolerance::default()).unwrap();
        // The authors print 0.66 to 1.51 % and 1.37 to 2.14 %.
        assert!(first.abs() < 0.02 && second.abs() < 0.0214, "r_m {radius_ratio}: {first} {second}");
    }
}
