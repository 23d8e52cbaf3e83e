//! Bars of bedded rock that are torn: strength by the angle to the beds, and the energy that the crack costs.

use std::sync::Arc;

use fractum_fem::{
    BedStrength, Bedding, Body, Criterion, CriterionKind, DamageLaw, DamageZone, Elastic, ElementKind, Formulation,
    Kinematics, Plane, Region, Regularisation, Solid, SolidError,
};
use fractum_math::Vec3;
use fractum_scene::coupling::Debris;
use fractum_scene::{ContactParameters, EnergyKind, Loads, Motion, Scene, Support, Supports};
use fractum_tests::settings;

use super::bars::{bricks, taken, tear};

/// Within its beds.
const SHALE: Elastic = Elastic { density: 2500.0, young_modulus: 27e9, poisson_ratio: 0.15 };

/// Half of the part that is weaker [cells], and by how much.
const HALF: f64 = 3.0;
const WEAKER: f64 = 0.9;

/// A bar along x that is weaker in its middle, with its angle between the pull and the normal of its beds.
#[derive(Clone, Debug)]
struct Bar {
    kind: ElementKind,
    plane: Plane,
    degrees: f64,
    elastic: Elastic,
    /// Cells along and across, and their size [m].
    cells: [u32; 2],
    size: f64,
    seed: u64,
}

fn strengths() -> DamageLaw {
    let beds = BedStrength {
        tensile_strength: 2e6,
        cohesion: 2.5e6,
        friction_angle: 30f64.to_radians(),
        fracture_energy: 30.0,
    };
    DamageLaw { beds: Some(beds), ..DamageLaw::rankine(6e6, 100.0) }
}

/// Jaeger's strength of a pull, and the fracture energy of what breaks.
fn expected(degrees: f64, law: &DamageLaw) -> [f64; 2] {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let beds = law.beds.unwrap();
    let opening = beds.tensile_strength / (cosine * cosine);
    let sliding = beds.cohesion / (sine * cosine + cosine * cosine * beds.friction_angle.tan());
    let of_beds = opening.min(sliding);
    if of_beds < law.tensile_strength {
        [of_beds, beds.fracture_energy]
    } else {
        [law.tensile_strength, law.fracture_energy]
    }
}

fn body(bar: &Bar) -> (Vec<Vec3>, Body) {
    let (extent, nodes, elements) = bricks(bar.kind, bar.cells, bar.size, bar.seed);
    let (sine, cosine) = bar.degrees.to_radians().sin_cos();
    let normal = match bar.kind {
        ElementKind::T3 => Vec3::new(cosine, sine, 0.0),
        ElementKind::T4 => Vec3::new(cosine, 0.8 * sine, 0.6 * sine),
    };
    let bedding = Bedding { normal, young_modulus: 12e9, poisson_ratio: 0.2, shear_modulus: 4.5e9 };
    let body = Body::new("bar", bar.kind, elements, bar.elastic).smoothed();
    let body = Body { plane: bar.plane, thickness: extent[2], bedding: Some(bedding), ..body };
    let half = HALF * bar.size;
    let factor = |p: &Vec3| if (p.x - 0.5 * extent[0]).abs() < half { WEAKER } else { 1.0 };
    let zone = DamageZone {
        law: strengths(),
        region: Region::Everywhere,
        strength_factor: body.edge_midpoints(&nodes).iter().map(factor).collect(),
        strength_by_chance: Vec::new(),
        reduce_strength_to_fit: false,
        regularisation: None,
        rate: None,
    };
    (nodes, Body { damage: Some(zone), ..body })
}

/// Strength over Jaeger's, and energy of the crack over G A.
fn torn(bar: &Bar) -> [f64; 2] {
    let (nodes, body) = body(bar);
    let [strength, energy] = expected(bar.degrees, &strengths());
    let end = bar.size * f64::from(bar.cells[0]);
    let pull = 20.0 * (strength / 12e9 * end + energy / strength);
    let (scene, peak) = tear(nodes, body, end, pull, &format!("{bar:?}"));
    let area = (bar.size * f64::from(bar.cells[1])).powi(2);
    [peak / (area * WEAKER * strength), taken(&scene) / (area * energy)]
}

/// Bars of all angles, and such as lie beside one of them: strength within 2 %, energy as docs/limits.md tells it.
#[test]
fn bars_have_jaegers_strength_and_about_the_energy_of_what_breaks() {
    let mut bars = bars_at(ElementKind::T3, Plane::Strain, [14, 6], &[0.0, 30.0, 45.0, 60.0, 90.0]);
    let beside = bars[1].clone();
    bars.extend(bars_at(ElementKind::T3, Plane::Stress, [14, 6], &[0.0, 30.0, 45.0, 60.0, 90.0]));
    bars.extend(bars_at(ElementKind::T4, Plane::Strain, [10, 4], &[30.0, 60.0]));
    bars.push(Bar { elastic: Elastic { poisson_ratio: 0.3, ..SHALE }, ..beside.clone() });
    bars.push(Bar { cells: [28, 12], size: 0.002, ..beside.clone() });
    bars.push(Bar { seed: 6, ..beside });
    have_their_strength(&bars);
}

#[test]
#[ignore = "half a minute: .ci/nightly heavy"]
fn bars_in_space_have_jaegers_strength_at_other_angles() {
    have_their_strength(&bars_at(ElementKind::T4, Plane::Strain, [10, 4], &[0.0, 45.0, 90.0]));
}

fn bars_at(kind: ElementKind, plane: Plane, cells: [u32; 2], angles: &[f64]) -> Vec<Bar> {
    let bar = |&degrees: &f64| Bar { kind, plane, degrees, elastic: SHALE, cells, size: 0.004, seed: 5 };
    angles.iter().map(bar).collect()
}

fn have_their_strength(bars: &[Bar]) {
    let mut missed = Vec::new();
    for bar in bars {
        let [peak, energy] = torn(bar);
        let text = format!("{bar:?}: strength {peak:.4}, energy {energy:.4}");
        println!("{text}");
        let most = if bar.kind == ElementKind::T3 { 1.25 } else { 1.1 };
        if (peak - 1.0).abs() >= 0.02 || !(1.0..most).contains(&energy) {
            missed.push(text);
        }
    }
    assert!(missed.is_empty(), "{missed:#?}");
}

/// A bar that is torn in motion: energies balance, and there are the same bits for any number of threads and after a resume.
#[test]
fn bars_torn_in_motion_keep_the_balance_and_their_bits() {
    for (kind, plane) in [(ElementKind::T3, Plane::Strain), (ElementKind::T4, Plane::Strain)] {
        let bar = Bar { kind, plane, degrees: 40.0, elastic: SHALE, cells: [10, 4], size: 0.004, seed: 3 };
        let make = || {
            let (nodes, body) = body(&bar);
            let body = Body { kinematics: Kinematics::Corotational, ..body };
            let solid = Solid::new(nodes, vec![body]).unwrap();
            let end = bar.size * f64::from(bar.cells[0]);
            let at = |keep: &dyn Fn(f64) -> bool| -> Vec<u32> {
                (0..solid.reference.len() as u32).filter(|&n| keep(solid.reference[n as usize].x)).collect()
            };
            let pull = |t: f64| 1.0 * t * (t / 2e-5).min(1.0);
            let supports = vec![
                Support::new("left", at(&|x| x < 1e-9), 0, Motion::Fixed),
                Support::new("right", at(&|x| x > end - 1e-9), 0, Motion::Displacement(Arc::new(move |t, _| pull(t)))),
            ];
            let supports = Supports::new(supports, &solid.reference).unwrap();
            let (loads, count) = (Loads::new(Vec::new(), solid.reference.len()), solid.body_count());
            let debris = Debris::new(&solid, vec![ContactParameters::default(); count]);
            Scene::new(solid, supports, loads, debris, Vec::new(), &[], settings(1e-4, 1e-2))
        };
        let finish = |scene: &mut Scene| {
            while !scene.is_finished() {
                let measure = scene.clock.step.is_multiple_of(20);
                scene.step(measure).unwrap();
            }
            scene.solid.displacement.iter().flat_map(|u| [u.x, u.y, u.z]).map(f64::to_bits).collect::<Vec<u64>>()
        };
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| finish(&mut make()))
        };
        let mut scene = make();
        while scene.solid.edge_damage(0).iter().all(|edge| edge.damage < 0.3) {
            scene.step(false).unwrap();
        }
        let mut resumed = make();
        resumed.restore(scene.state());
        let one = finish(&mut scene);
        let ledger = scene.ledger();
        println!("{kind:?}: {ledger:?}");
        assert!(ledger[EnergyKind::Damage] > 0.0 && ledger.residual_max_relative < 1e-2, "{kind:?}: {ledger:?}");
        assert!(finish(&mut resumed) == one, "{kind:?}: resumed");
        assert!([1, 2, 7].into_iter().all(|threads| run(threads) == one), "{kind:?}: threads");
    }
}

/// What has not been tried with beds is refused.
#[test]
fn damage_that_knows_no_beds_is_refused() {
    let bar = Bar {
        kind: ElementKind::T3,
        plane: Plane::Strain,
        degrees: 30.0,
        elastic: SHALE,
        cells: [4, 2],
        size: 0.004,
        seed: 1,
    };
    let refused = |change: &dyn Fn(&mut Body)| {
        let (nodes, mut body) = body(&bar);
        change(&mut body);
        matches!(Solid::new(nodes, vec![body]), Err(SolidError::BeddedDamage { .. }))
    };
    fn law(body: &mut Body) -> &mut DamageLaw {
        &mut body.damage.as_mut().unwrap().law
    }
    assert!(!refused(&|_| ()));
    assert!(refused(&|body| body.formulation = Formulation::Standard));
    assert!(refused(&|body| body.damage.as_mut().unwrap().regularisation = Some(Regularisation { length: None })));
    assert!(refused(&|body| law(body).unilateral = true));
    assert!(refused(&|body| law(body).friction = Some(0.5)));
    assert!(refused(&|body| law(body).rate_time = 1e-6));
    assert!(refused(&|body| law(body).criterion = Criterion::new(CriterionKind::Mazars, 0.6, 10.0, 0.2)));
    // Elements that resolve the rock may be too large for its beds.
    let (nodes, mut coarse) = body(&bar);
    law(&mut coarse).beds.as_mut().unwrap().fracture_energy = 0.1;
    assert!(matches!(Solid::new(nodes, vec![coarse]), Err(SolidError::ElementTooLarge { .. })));
}
