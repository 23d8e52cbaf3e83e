use super::*;
use crate::BeamSection;
use crate::criterion::{BeamRankine, Level, Principal};
use crate::fracture::LoadedBonds;
use fractum_math::{Sym3, Vec3};

/// A jittered cubic bar along x, bonded to nearest neighbours and along one diagonal.
fn bar(size: [usize; 3]) -> (Vec<Vec3>, Vec<[u32; 2]>) {
    let id = |s: [usize; 3]| ((s[0] * size[1] + s[1]) * size[2] + s[2]) as u32;
    let (mut position, mut pairs) = (Vec::new(), Vec::new());
    for x in 0..size[0] {
        for y in 0..size[1] {
            for z in 0..size[2] {
                let jitter = |a: usize| 0.08 * ((id([x, y, z]) as usize * 3 + a) as f64 * 12.9898).sin();
                position.push(Vec3::new(x as f64 + jitter(0), y as f64 + jitter(1), z as f64 + jitter(2)));
                for step in [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, 0, 1]] {
                    let t = [x + step[0], y + step[1], z + step[2]];
                    if (0..3).all(|a| t[a] < size[a]) {
                        pairs.push([id([x, y, z]), id(t)]);
                    }
                }
            }
        }
    }
    pairs.sort_unstable();
    (position, pairs)
}

fn pull(size: [usize; 3], criterion: FractureCriterion, limit: f64, residual: f64) -> BreakingOutcome {
    pull_scattered(size, criterion, &[], limit, residual)
}

/// - `strength_factors`: of the particles
fn pull_scattered(
    size: [usize; 3],
    criterion: FractureCriterion,
    strength_factors: &[f64],
    limit: f64,
    residual: f64,
) -> BreakingOutcome {
    let (position, pairs) = bar(size);
    let n = position.len();
    let face = size[1] * size[2];
    let lattice = Lattice::new(&position, &pairs, BeamSection::new(1e9, 0.3).unwrap(), 0.5).unwrap();
    let mut supports = LatticeSupports::none(n);
    (0..face).for_each(|i| supports.set(i as u32, 0, 0.0));
    (n - face..n).for_each(|i| supports.set(i as u32, 0, 1e-3));
    let last = (size[0] - 1) as f64;
    let guess: Vec<Dof6> = position.iter().map(|x| [1e-3 * x.x / last, 0.0, 0.0, 0.0, 0.0, 0.0]).collect();
    let radius = vec![0.5; n];
    let tolerance = Tolerance { residual, ..Tolerance::default() };
    let what = Breaking {
        criterion,
        pairs: &pairs,
        radius: &radius,
        strength_factors,
        to_wall: &[],
        fraction: 0.52,
        volume: n as f64,
        displacement: 1e-3,
        batch: Batch::PerSite,
        limit,
        stop: 1e-3,
        tolerance,
    };
    let (low, high): (Vec<u32>, Vec<u32>) = ((0..face as u32).collect(), ((n - face) as u32..n as u32).collect());
    quasi_static(lattice, supports, &guess, &what, |graph| graph.parts().separate(&low, &high)).unwrap()
}

fn principal(level: Level) -> FractureCriterion {
    FractureCriterion::Principal(Principal { tensile_strength: 1e5, compressive_strength: None, level })
}

#[test]
fn a_chain_breaks_at_the_strength_of_its_beams() {
    let position: Vec<Vec3> = (0..4).map(|i| Vec3::x() * f64::from(i)).collect();
    let pairs = [[0, 1], [1, 2], [2, 3]];
    let section = BeamSection::new(1e9, 0.3).unwrap();
    let lattice = Lattice::new(&position, &pairs, section, 0.5).unwrap();
    let mut supports = LatticeSupports::none(4);
    (0..6).for_each(|d| supports.set(0, d, 0.0));
    supports.set(3, 0, 1e-3);
    let what = Breaking {
        criterion: FractureCriterion::BeamRankine(BeamRankine { strength: 2e5, moments: Default::default() }),
        pairs: &pairs,
        radius: &[0.5; 4],
        strength_factors: &[],
        to_wall: &[],
        fraction: 0.5,
        volume: 3.0,
        displacement: 1e-3,
        batch: Batch::PerSite,
        limit: f64::INFINITY,
        stop: 1e-3,
        tolerance: Tolerance { residual: 1e-9, ..Tolerance::default() },
    };
    let outcome = quasi_static(lattice, supports, &[[0.0; 6]; 4], &what, |g| g.parts().count > 1).unwrap();
    let force = 2e5 * std::f64::consts::PI * 0.09;
    assert!((outcome.peak.load / force - 1.0).abs() < 1e-8 && outcome.separated);
    // All three beams bear the same to round-off: whether one or more of them go, the chain is apart at once.
    assert_eq!(outcome.curve.len(), 2);
    let energy: f64 = outcome.cracks[0].energy * 3.0;
    let last = outcome.curve.last().unwrap();
    assert!((last.work / energy - 1.0).abs() < 1e-6 && last.elastic < 1e-9 * energy);
    assert_eq!(outcome.cracks[0].area, 3.0);
}

#[test]
fn a_bar_comes_apart_and_its_load_curve_does_the_work() {
    for level in [Level::Own, Level::Neighbours, Level::Second] {
        let outcome = pull([8, 4, 4], principal(level), f64::INFINITY, 1e-6);
        assert!(outcome.separated && outcome.cracks.len() >= 16, "{level:?}: {}", outcome.cracks.len());
        assert!(outcome.peak.load >= outcome.first.unwrap().load);
        assert!(outcome.curve.windows(2).all(|w| w[1].displacement >= w[0].displacement));
        let last = outcome.curve.last().unwrap();
        let broken: f64 = outcome.cracks.iter().map(|c| c.energy).sum();
        // Sudden equilibria release more than the broken bonds had.
        assert!(last.work > broken && last.work.is_finite());
    }
}

#[test]
fn a_bar_breaks_first_where_its_particles_are_weak() {
    let (position, pairs) = bar([6, 3, 3]);
    let beam = FractureCriterion::BeamRankine(BeamRankine { strength: 2e5, moments: Default::default() });
    for criterion in [principal(Level::Own), principal(Level::Neighbours), beam] {
        let first = |factors: &[f64]| {
            let outcome = pull_scattered([6, 3, 3], criterion, factors, f64::INFINITY, 1e-8);
            (outcome.first.unwrap().load, outcome.peak.load, outcome.cracks[0].bond)
        };
        let (load, peak, _) = first(&[]);
        let half = first(&vec![0.5; position.len()]);
        assert!((half.0 / load - 0.5).abs() < 1e-6 && (half.1 / peak - 0.5).abs() < 1e-6, "{half:?}, {load}");
        let weak = position.len() / 2 + 1;
        let mut factors = vec![1.0; position.len()];
        factors[weak] = 0.4;
        let (one, _, bond) = first(&factors);
        assert!(one < 0.7 * load && one > 0.3 * load, "{one} of {load}");
        let around = |i: u32| i as usize == weak || pairs.iter().any(|p| p.contains(&i) && p.contains(&(weak as u32)));
        assert!(pairs[bond as usize].into_iter().any(around), "bond {bond}");
    }
}

#[test]
fn a_bar_that_holds_says_how_close_it_came() {
    let broken = pull([6, 3, 3], principal(Level::Neighbours), f64::INFINITY, 1e-6);
    let first = broken.first.unwrap().displacement / 1e-3;
    let held = pull([6, 3, 3], principal(Level::Neighbours), 0.8 * first, 1e-6);
    assert!(held.first.is_none() && held.cracks.is_empty() && !held.separated);
    assert!((held.closest.unwrap().ratio - 0.8).abs() < 1e-6);
    assert!((held.peak.displacement / 1e-3 - 0.8 * first).abs() < 1e-9 * first);
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let outcome = pool.install(|| pull([14, 10, 10], principal(Level::Neighbours), f64::INFINITY, 1e-3));
        let bits: Vec<u64> = outcome.curve.iter().map(|p| p.load.to_bits()).collect();
        (bits, outcome.cracks.iter().map(|c| c.bond).collect::<Vec<_>>())
    };
    let one = run(1);
    assert_eq!(one, run(2));
    assert_eq!(one, run(7));
}

#[test]
fn neighbourhoods_and_equilibria_follow_the_broken_bonds() {
    let (position, pairs) = bar([7, 4, 4]);
    let n = position.len();
    let section = BeamSection::new(1e9, 0.3).unwrap();
    let lattice = Lattice::new(&position, &pairs, section, 0.5).unwrap();
    let mut supports = LatticeSupports::none(n);
    (0..16).for_each(|i| supports.set(i, 0, 0.0));
    (n as u32 - 16..n as u32).for_each(|i| supports.set(i, 0, 1e-3));
    let tolerance = Tolerance { residual: 1e-10, ..Tolerance::default() };
    let guess = vec![[0.0; 6]; n];
    for level in [Level::Own, Level::Neighbours, Level::Second] {
        let radius: Vec<f64> = (0..n).map(|i| 0.4 + 0.1 * (i as f64).sin().abs()).collect();
        let mut graph = BondGraph::new(n, &pairs);
        let mut body = StaticBody::new(lattice.clone(), supports.clone(), &guess, tolerance).unwrap();
        let mut search = FailureSearch::new(principal(level), &graph, &radius, 0.6).unwrap();
        for bond in (0..pairs.len() as u32).filter(|b| b % 5 == 2) {
            graph.break_bond(bond);
            body.break_bond(bond);
            search.bond_broken(bond, &graph);
        }
        body.solve().unwrap();
        search.search(&body, &graph, f64::INFINITY);
        // From scratch, with the bonds that are left.
        let left: Vec<[u32; 2]> = (0..pairs.len()).filter(|b| b % 5 != 2).map(|b| pairs[b]).collect();
        let fresh = Lattice::new(&position, &left, section, 0.5).unwrap();
        let body2 = StaticBody::new(fresh, supports.clone(), &guess, tolerance).unwrap();
        let graph2 = BondGraph::new(n, &left);
        let mut search2 = FailureSearch::new(principal(level), &graph2, &radius, 0.6).unwrap();
        search2.search(&body2, &graph2, f64::INFINITY);
        assert!((body.energy() / body2.energy() - 1.0).abs() < 1e-8);
        let size = search2.stress().iter().map(|s| s.0[0].abs()).fold(0.0, f64::max);
        for (a, b) in search.stress().iter().zip(search2.stress()) {
            assert!((*a - *b).0.iter().all(|d| d.abs() < 1e-6 * size), "{a:?} {b:?}");
        }
        // The virials of a bar under tension add up to its load times its length.
        let mut virials = vec![Sym3::ZERO; n];
        body.virials(&mut virials);
        let virial: f64 = virials.iter().map(|d| d.0[0]).sum();
        let reach = |i: u32| body.reaction(i)[0] * position[i as usize].x;
        let held: f64 = (0..16).chain(n as u32 - 16..n as u32).map(reach).sum();
        assert!((virial / held - 1.0).abs() < 1e-6, "{virial} {held}");
    }
}

/// Statically determinate reactions do not feel that the load of a loose particle has gone on to the nearest one.
#[test]
fn the_load_of_a_loose_particle_goes_on_with_its_moment() {
    let (position, pairs) = bar([5, 3, 3]);
    let n = position.len();
    let lattice = Lattice::new(&position, &pairs, BeamSection::new(1e9, 0.3).unwrap(), 0.5).unwrap();
    let mut supports = LatticeSupports::none(n);
    (0..9).chain(n - 9..n).for_each(|i| supports.set(i as u32, 0, 0.0));
    // The middle of the bar and the particle beside it along y.
    let (across, beside) = (22u32, 25u32);
    [1, 2].into_iter().for_each(|axis| supports.set(across, axis, 0.0));
    supports.set(beside, 2, 0.0);
    // A corner, which a support holds along x alone.
    let loose = 0;
    let mut loads = vec![[0.0; 6]; n];
    loads[loose] = [0.0, 2e3, 1e3, 0.0, 0.0, 0.0];
    let tolerance = Tolerance { residual: 1e-8, ..Tolerance::default() };
    let mut body = StaticBody::under_loads(lattice, supports, &loads, &vec![[0.0; 6]; n], tolerance).unwrap();
    let reactions = |body: &StaticBody| [body.reaction(across)[1], body.reaction(across)[2], body.reaction(beside)[2]];
    let before = reactions(&body);
    assert!((before[0] + 2e3).abs() < 1e-3 && (before[1] + before[2] + 1e3).abs() < 1e-3, "{before:?}");
    let bonds = (0u32..).zip(&pairs).filter(|(_, pair)| pair.contains(&(loose as u32)));
    bonds.for_each(|(bond, _)| body.break_bond(bond));
    assert!(body.clone().solve().is_err());
    body.hand_over(loose, |i| i != loose);
    body.solve().unwrap();
    let after = reactions(&body);
    assert!(before.iter().zip(after).all(|(before, after)| (before - after).abs() < 1.0), "{before:?} {after:?}");
    assert!((body.share_of_loads(std::iter::empty()) - 1.0).abs() < 1e-12);
}
