//! Closed cracks that rub: a patch that is torn, closed and slid against closed forms, direct shear, triaxial tests.

use std::sync::Arc;

use fractum_fem::{
    Body, Criterion, CriterionKind, DamageLaw, Elastic, ElementKind, Kinematics, LocalDamping, Plane, Region, Solid,
    fields, rubbed_energy,
};
use fractum_math::{Mat3, Sym3, Vec3};
use fractum_mesh::generate::{Jitter, structured_box, structured_rectangle};
use fractum_scene::coupling::Debris;
use fractum_scene::{
    ContactParameters, EnergyKind, Ledger, Load, Loads, Motion, Pressure, Scene, SceneSettings, Support, Supports,
};
use fractum_tests::{CONCRETE, settings, surface};

/// Tensile strength, uniaxial compressive strength [Pa].
const STRENGTH: [f64; 2] = [3e6, 30e6];
const FRICTION_ANGLE: f64 = 30.0;

/// A specimen of cells of one size, with inner nodes moved by a seed.
#[derive(Clone, Copy, Debug)]
struct Specimen {
    kind: ElementKind,
    plane: Plane,
    kinematics: Kinematics,
    poisson_ratio: f64,
    /// Along x (and z in space), and along y.
    cells: [u32; 2],
    size: f64,
    /// 0 leaves the nodes in their rows.
    seed: u64,
    friction: f64,
}

const PLATE: Specimen = Specimen {
    kind: ElementKind::T3,
    plane: Plane::Strain,
    kinematics: Kinematics::Small,
    poisson_ratio: 0.2,
    cells: [10, 20],
    size: 0.005,
    seed: 1,
    friction: 0.6,
};
const BLOCK: Specimen = Specimen { kind: ElementKind::T4, cells: [5, 10], size: 0.01, ..PLATE };

impl Specimen {
    /// Width (and depth in space) and height [m].
    fn extent(&self) -> [f64; 2] {
        self.cells.map(|cells| self.size * f64::from(cells))
    }

    fn depth(&self) -> f64 {
        if self.kind == ElementKind::T3 { 1.0 } else { self.extent()[0] }
    }

    /// Bulk and shear modulus: in plane stress that of areas [Pa].
    fn moduli(&self) -> [f64; 2] {
        let elastic = Elastic { poisson_ratio: self.poisson_ratio, ..CONCRETE };
        let (lambda, mu) = (elastic.lame_lambda(), elastic.shear_modulus());
        let is_flat = self.kind == ElementKind::T3 && self.plane == Plane::Stress;
        [if is_flat { 2.0 * lambda * mu / (lambda + 2.0 * mu) + mu } else { lambda + 2.0 / 3.0 * mu }, mu]
    }

    /// Its nodes, and its body with a law; damage where `may_break`.
    fn body(&self, law: DamageLaw, may_break: impl Fn(&Vec3) -> bool) -> (Vec<Vec3>, Body) {
        let jitter = (self.seed > 0).then_some(Jitter { fraction: 0.15, seed: self.seed });
        let ([along, up], [width, height]) = (self.cells, self.extent());
        let (nodes, elements) = match self.kind {
            ElementKind::T3 => {
                let mesh = structured_rectangle([along, up], [width, height], jitter);
                (mesh.nodes, mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect())
            }
            ElementKind::T4 => {
                let mesh = structured_box([along, up, along], Vec3::new(width, height, width), jitter);
                (mesh.nodes, mesh.tetrahedra)
            }
        };
        let elastic = Elastic { poisson_ratio: self.poisson_ratio, ..CONCRETE };
        let law = DamageLaw { friction: Some(self.friction), ..law };
        let body = Body::new("rock", self.kind, elements, elastic).smoothed().with_damage(law);
        let mut body = Body { plane: self.plane, thickness: 1.0, kinematics: self.kinematics, ..body };
        let marked = body.edge_midpoints(&nodes).iter().map(may_break).collect();
        body.damage.as_mut().unwrap().region = Region::Edges(marked);
        (nodes, body)
    }
}

/// Moves all nodes to a uniform strain; the work of the forces on the way [J].
fn strain(solid: &mut Solid, strain: Sym3) -> f64 {
    let slope: Mat3 = strain.to_matrix();
    let force = solid.force.clone();
    for node in 0..solid.reference.len() {
        let displacement = slope * solid.reference[node];
        solid.velocity[node] = displacement - solid.displacement[node];
        solid.displacement[node] = displacement;
    }
    solid.update_internal_forces(1.0, true);
    let mean = force.iter().zip(&solid.force).map(|(before, now)| -0.5 * (before + now));
    mean.zip(&solid.velocity).map(|(force, moved)| force.dot(moved)).sum()
}

/// A crack opens until it is broken, closes, slides under pressure to and fro, opens and closes again.
#[test]
fn a_patch_that_is_torn_closes_and_slides_by_coulombs_law() {
    let mut specimens = Vec::new();
    for poisson_ratio in [0.0, 0.2, 0.45] {
        for friction in [0.0, 0.6] {
            let small = Specimen { poisson_ratio, friction, cells: [2, 2], ..PLATE };
            let flat = Specimen { plane: Plane::Stress, ..small };
            let space = Specimen { poisson_ratio, friction, cells: [2, 2], ..BLOCK };
            let turns = Specimen { kinematics: Kinematics::Corotational, ..space };
            specimens.extend([small, flat, space, turns]);
        }
    }
    for specimen in specimens {
        let (nodes, body) = specimen.body(DamageLaw::rankine(STRENGTH[0], 10.0), |_| true);
        let mut solid = Solid::new(nodes, vec![body]).unwrap();
        let [bulk, mu] = specimen.moduli();
        let (gap, far) = (1e-5, 2e-3);
        let volume = specimen.extent()[0] * specimen.extent()[1] * specimen.depth();
        let at = |opening: f64, slide: f64| Sym3([0.0, opening, 0.0, slide, 0.0, 0.0]);
        let mut work = 0.0;
        let mut go = |solid: &mut Solid, [from, to]: [[f64; 2]; 2], steps: u32| {
            for step in 1..=steps {
                let share = f64::from(step) / f64::from(steps);
                let [opening, slide] = [0, 1].map(|k| from[k] + (to[k] - from[k]) * share);
                work += strain(solid, at(opening, slide));
                let taken = solid.dissipated_energy() + rubbed_energy(solid);
                let missing = work - taken - solid.elastic_energy();
                let rounding = 1e-13 * CONCRETE.young_modulus * (opening * opening + slide * slide) * volume;
                assert!(
                    missing.abs() < 1e-9 * work.abs() + rounding,
                    "{specimen:?}: {missing} J of {work} J at {opening} {slide}"
                );
            }
        };
        let torn = 0.1;
        go(&mut solid, [[0.0, 0.0], [2e-3, 0.0]], 200);
        go(&mut solid, [[2e-3, 0.0], [torn, 0.0]], 50);
        assert!(rubbed_energy(&solid).abs() < 1e-9 * solid.dissipated_energy(), "{specimen:?}: an open crack rubs");
        go(&mut solid, [[torn, 0.0], [-gap, 0.0]], 50);
        let damage = solid.dissipated_energy();
        let pressure = bulk * gap;
        for (number, [from, to]) in [[0.0, far], [far, -far]].into_iter().enumerate() {
            let before = rubbed_energy(&solid);
            go(&mut solid, [[-gap, from], [-gap, to]], 4000);
            for (stress, _) in fields::element_fields(&solid, 0, None) {
                let [_, normal, _, shear, ..] = stress.0;
                let friction = specimen.friction * pressure * (to - from).signum();
                let off = (normal + pressure).abs().max((shear - friction).abs());
                assert!(off < 1e-6 * pressure, "{specimen:?}: {normal} {shear} of {pressure} {friction}");
            }
            if number == 1 {
                let slid = 2.0 * (2.0 * far - specimen.friction * pressure / mu);
                let exact = specimen.friction * pressure * slid * volume;
                let found = rubbed_energy(&solid) - before;
                assert!(
                    (found - exact).abs() < 1e-3 * exact.max(1e-6 * damage),
                    "{specimen:?}: {found} J of {exact} J"
                );
            }
        }
        go(&mut solid, [[-gap, -far], [gap, -far]], 50);
        let open = fields::element_fields(&solid, 0, None).iter().map(|(s, _)| s.dot(*s).sqrt()).fold(0.0, f64::max);
        assert!(open < 1e-6 * pressure, "{specimen:?}: {open} Pa across an open crack");
        // It sticks where it closes.
        go(&mut solid, [[gap, -far], [-gap, -far]], 50);
        let closed = fields::element_fields(&solid, 0, None);
        assert!(closed.iter().all(|(s, _)| s.0[3].abs() < 1e-6 * pressure && s.0[1] <= -pressure * (1.0 - 1e-6)));
        assert!((solid.dissipated_energy() - damage).abs() < 1e-9 * damage, "{specimen:?}: damage grows once more");
    }
}

/// What a test of a specimen has shown.
struct Tested {
    /// Largest stress on its upper end, and its mean over the last part of the run [Pa].
    peak: f64,
    residual: f64,
    ledger: Ledger,
}

/// Runs a scene whose upper end is moved.
///
/// - `along`: the stress that counts; `late`: share of the run that the mean is over
fn tested(mut scene: Scene, top: &[u32], along: Vec3, area: f64, late: f64) -> Tested {
    let places = scene.supports().places(top);
    let end = scene.settings().time_step.end;
    let (mut peak, mut sum, mut count) = (0.0f64, 0.0, 0.0);
    while !scene.is_finished() {
        scene.step(true).unwrap();
        let stress = scene.supports().reaction(&places, &along) / area;
        peak = peak.max(stress);
        if scene.clock.time > (1.0 - late) * end {
            (sum, count) = (sum + stress, count + 1.0);
        }
    }
    Tested { peak, residual: sum / count, ledger: *scene.ledger() }
}

/// A scene of a specimen that is pressed on some facets and moved at its upper end.
fn scene(
    (nodes, body): (Vec<Vec3>, Body),
    supports: impl FnOnce(&dyn Fn(f64) -> Vec<u32>) -> Vec<Support>,
    pressed: impl Fn(&Vec3) -> bool,
    pressure: f64,
    [rise, end, damping]: [f64; 3],
) -> Scene {
    let solid = Solid::new(nodes, vec![body]).unwrap();
    let at = |y: f64| -> Vec<u32> {
        (0..).zip(&solid.reference).filter(|(_, p)| (p.y - y).abs() < 1e-9).map(|(node, _)| node).collect()
    };
    let supports = Supports::new(supports(&at), &solid.reference).unwrap();
    let is_pressed =
        |facet: &[u32; 3]| pressed(&(facet.map(|n| solid.reference[n as usize]).iter().sum::<Vec3>() / 3.0));
    let facets = surface(&solid).into_iter().filter(is_pressed).collect();
    let value = Arc::new(move |t: f64, _: &Vec3| pressure * (t / rise).min(1.0));
    let load = Load::Pressure(Pressure { facets, value });
    let loads = Loads::new(vec![load], solid.reference.len());
    let debris = Debris::new(&solid, vec![ContactParameters::default()]);
    let settings = SceneSettings {
        damping: LocalDamping { local: damping, ..LocalDamping::default() },
        ..settings(end, f64::INFINITY)
    };
    Scene::new(solid, supports, loads, debris, Vec::new(), &[], settings)
}

fn still(_: f64, _: &Vec3) -> f64 {
    0.0
}

/// A velocity that begins after `rise`.
fn moved(speed: f64, rise: f64) -> Motion {
    Motion::Velocity(Arc::new(move |t, _| speed * ((t - rise) / (0.5 * rise)).clamp(0.0, 1.0)))
}

/// A specimen under confining pressure is shortened along y.
fn triaxial(specimen: &Specimen, pressure: f64) -> Tested {
    let criterion = Criterion::new(
        CriterionKind::MohrCoulomb,
        FRICTION_ANGLE.to_radians(),
        STRENGTH[1] / STRENGTH[0],
        specimen.poisson_ratio,
    );
    // Brittle: what failed has lost its cohesion within a strain of a hundredth.
    let law = DamageLaw { criterion, ..DamageLaw::rankine(STRENGTH[0], 3.0 * specimen.size / 0.003) };
    let ([width, height], rise) = (specimen.extent(), 3e-4);
    let ends = |at: &dyn Fn(f64) -> Vec<u32>| {
        vec![
            Support::new("bottom", at(0.0), 1, Motion::Velocity(Arc::new(still))),
            Support::new("top", at(height), 1, moved(-0.5, rise)),
        ]
    };
    let sides = |p: &Vec3| p.y > 1e-9 && p.y < height - 1e-9;
    let scene = scene(specimen.body(law, |_| true), ends, sides, pressure, [rise, 2.4e-3, 0.2]);
    let top: Vec<u32> =
        (0..).zip(&scene.solid.reference).filter(|(_, p)| p.y > height - 1e-9).map(|(node, _)| node).collect();
    tested(scene, &top, -Vec3::y(), width * specimen.depth(), 0.4)
}

/// Both strengths over those of Mohr and Coulomb, at three confining pressures.
fn misses(specimens: &[Specimen]) -> Vec<String> {
    let mut missed = Vec::new();
    let sine = FRICTION_ANGLE.to_radians().sin();
    let ratio = (1.0 + sine) / (1.0 - sine);
    for specimen in specimens {
        for pressure in [5e6, 10e6, 20e6] {
            let specimen = Specimen { friction: FRICTION_ANGLE.to_radians().tan(), ..*specimen };
            let Tested { peak, residual, ledger } = triaxial(&specimen, pressure);
            let found = [peak / (STRENGTH[1] + ratio * pressure), residual / (ratio * pressure)];
            let text = format!(
                "{:?} {:?}, nu {}, {:?} cells, seed {}, {pressure:.0} Pa: peak {:.3}, residual {:.3}, balance {:.1e}",
                specimen.kind,
                specimen.plane,
                specimen.poisson_ratio,
                specimen.cells,
                specimen.seed,
                found[0],
                found[1],
                ledger.residual_max_relative
            );
            println!("{text}");
            assert!(ledger.residual_max_relative < 1e-3, "{text}");
            if found.iter().any(|found| (found - 1.0).abs() > 0.05) {
                missed.push(text);
            }
        }
    }
    missed
}

#[test]
fn plates_under_confinement_have_the_peak_and_the_residual_strength_of_mohr_and_coulomb() {
    // With ν = 0.1 the stress across the thickness would be the smallest.
    let coarse = [0.2, 0.3].map(|poisson_ratio| Specimen { poisson_ratio, ..PLATE });
    let fine = Specimen { cells: [14, 28], size: 0.05 / 14.0, seed: 2, ..PLATE };
    let missed = misses(&[&coarse[..], &[fine]].concat());
    assert!(missed.is_empty(), "{missed:#?}");
}

#[test]
fn blocks_under_confinement_have_the_peak_and_the_residual_strength_of_mohr_and_coulomb() {
    let missed = misses(&[0.1, 0.3].map(|poisson_ratio| Specimen { poisson_ratio, ..BLOCK }));
    assert!(missed.is_empty(), "{missed:#?}");
}

/// A bar with a crack across, closed by a pressure: its upper part is moved sideways.
fn direct_shear(specimen: &Specimen, pressure: f64) -> Tested {
    let ([width, height], rise) = (specimen.extent(), 3e-4);
    let ends = |at: &dyn Fn(f64) -> Vec<u32>| {
        let bottom = (0..3).map(|axis| Support::new("bottom", at(0.0), axis, Motion::Velocity(Arc::new(still))));
        let mut all: Vec<Support> = bottom.collect();
        all.push(Support::new("top", at(height), 0, moved(0.1, rise)));
        all
    };
    // A row of cells is cracked with its edges above and below; the rest stays whole.
    let law = DamageLaw::rankine(STRENGTH[0], 10.0);
    let row = |p: &Vec3| (p.y - 0.5 * height).abs() < 0.75 * specimen.size;
    let (nodes, body) = specimen.body(law, row);
    let cracked: Vec<bool> = body.edge_midpoints(&nodes).iter().map(row).collect();
    let mut scene = scene((nodes, body), ends, |p| p.y > height - 1e-9, pressure, [rise, 4e-3, 0.1]);
    let mut state = scene.solid.state();
    let edges = state.bodies[0].edges.iter_mut().zip(cracked).filter(|(_, cracked)| *cracked);
    edges.for_each(|(edge, _)| (edge.damage, edge.kappa, edge.share) = (1.0, 1e4 * STRENGTH[0], specimen.friction));
    scene.solid.restore(state);
    let top: Vec<u32> =
        (0..).zip(&scene.solid.reference).filter(|(_, p)| p.y > height - 1e-9).map(|(node, _)| node).collect();
    tested(scene, &top, Vec3::x(), width * specimen.depth(), 0.4)
}

/// Residual shear stress over f p, at three pressures, with what describes it.
fn shear_ratios(specimens: &[Specimen]) -> Vec<(f64, String)> {
    let mut found = Vec::new();
    for specimen in specimens {
        for pressure in [1e6, 2e6, 4e6] {
            let Tested { peak, residual, ledger } = direct_shear(specimen, pressure);
            let [peak, residual] = [peak, residual].map(|stress| stress / (specimen.friction * pressure));
            let text = format!(
                "{:?} {:?}, nu {}, f {}, seed {}, {pressure:.0} Pa: over f p peak {peak:.3}, residual {residual:.3}, balance {:.1e}, friction {:.3e} J",
                specimen.kind,
                specimen.plane,
                specimen.poisson_ratio,
                specimen.friction,
                specimen.seed,
                ledger.residual_max_relative,
                ledger[EnergyKind::Friction]
            );
            println!("{text}");
            assert!(ledger.residual_max_relative < 1e-3, "{text}");
            found.push((residual, text));
        }
    }
    found
}

/// Faces of cracks are smooth where the lines of the mesh are straight (seed 0).
#[test]
fn a_cracked_bar_that_is_sheared_bears_f_times_its_pressure() {
    let wide = Specimen { cells: [20, 9], seed: 0, ..PLATE };
    let found = shear_ratios(&[
        wide,
        Specimen { poisson_ratio: 0.0, friction: 0.3, ..wide },
        Specimen { poisson_ratio: 0.4, plane: Plane::Stress, ..wide },
        Specimen { cells: [30, 15], size: 0.01 / 3.0, ..wide },
        Specimen { cells: [8, 5], seed: 0, ..BLOCK },
    ]);
    let missed: Vec<&String> =
        found.iter().filter(|(ratio, _)| (ratio - 1.0).abs() > 0.05).map(|(_, text)| text).collect();
    assert!(missed.is_empty(), "{missed:#?}");
}

/// Where the lines of the mesh are not straight, faces climb on each other.
#[test]
fn rough_faces_bear_more_than_smooth_ones() {
    for (ratio, text) in shear_ratios(&[1, 2, 3].map(|seed| Specimen { cells: [20, 9], seed, ..PLATE })) {
        assert!(ratio > 0.95, "{text}");
    }
}
