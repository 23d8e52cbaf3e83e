//! The stress of particles at a wall, taken at the wall: its gradient over what is around them carries it there.

use fractum_math::{Sym3, Vec3};

use super::Level;
use crate::bond::BondGraph;

/// The most that a reading at a wall may be, over that of the neighbourhood: what scatters from particle to particle is no gradient.
pub(in crate::fracture) const MOST: f64 = 1.5;

/// Smallest determinant of the second moments of places over the cube of their mean at which they tell a gradient in space.
const FLAT: f64 = 1e-3;

/// A row that there is not.
const NONE: u32 = u32::MAX;

/// For each particle at a wall, what takes the virials around it to the difference between the stress at the wall and that of its
/// neighbourhood.
///
/// The gradient is that of the linear field closest to the stresses of the particles up to two bonds away, each with the weight of its
/// volume V: ∇σ = M⁻¹ Σ V (x − x̄) σ with M = Σ V (x − x̄) ⊗ (x − x̄). A neighbourhood's stress is a mean, and so that of its own
/// centroid c; at the wall, p, it is σ + (p − c) · ∇σ. A linear field is met exactly, and a uniform one is not changed.
#[derive(Clone, Debug)]
pub(in crate::fracture) struct AtWalls {
    /// Centres without load [m].
    position: Vec<Vec3>,
    /// The row of each particle.
    row: Vec<u32>,
    /// Particles at walls and the places on these that they face [m].
    walls: Vec<(u32, Vec3)>,
    /// Particles, and the factors on their virials [1/m³], for each of these.
    factors: Vec<Vec<(u32, f64)>>,
    /// Scratch.
    near: Vec<u32>,
}

impl AtWalls {
    /// - `to_wall`: from each centre to the wall that it faces, zero off the walls [m]
    pub(in crate::fracture) fn new(position: &[Vec3], to_wall: &[Vec3]) -> Self {
        let mut at = AtWalls {
            position: position.to_vec(),
            row: vec![NONE; position.len()],
            walls: Vec::new(),
            factors: Vec::new(),
            near: Vec::new(),
        };
        for (i, offset) in to_wall.iter().enumerate().filter(|(_, offset)| **offset != Vec3::zeros()) {
            at.row[i] = at.walls.len() as u32;
            at.walls.push((i as u32, position[i] + offset));
            at.factors.push(Vec::new());
        }
        at
    }

    /// Finds the factors of a particle anew, from the bonds that hold.
    ///
    /// - `fraction`: volume fraction of the interior
    pub(in crate::fracture) fn gather(
        &mut self,
        i: usize,
        graph: &BondGraph,
        volume: &[f64],
        fraction: f64,
        level: Level,
    ) {
        let AtWalls { position, row, walls, factors, near } = self;
        let Some((_, wall)) = walls.get(row[i] as usize) else { return };
        let factors = &mut factors[row[i] as usize];
        factors.clear();
        near.clear();
        near.push(i as u32);
        near.extend(graph.neighbours(i).map(|half| half.other));
        let ring = near.len();
        for k in 1..ring {
            near.extend(graph.neighbours(near[k] as usize).map(|half| half.other));
        }
        let own = match level {
            Level::Own => &near[..1],
            Level::Neighbours => &near[..ring],
            Level::Second => &near[..],
        };
        let from = if level == Level::Second { None } else { Some(centroid(own, position, volume)) };
        near.sort_unstable();
        near.dedup();
        let middle = centroid(near, position, volume);
        let from = from.unwrap_or(middle);
        let mut moments = Sym3::ZERO;
        for &j in near.iter() {
            let arm = position[j as usize] - middle;
            moments += Sym3::symmetric_part(&(arm * arm.transpose())) * volume[j as usize];
        }
        let moments = moments.to_matrix();
        if moments.determinant() < FLAT * (moments.trace() / 3.0).powi(3) {
            return;
        }
        let Some(inverse) = moments.try_inverse() else { return };
        let way = inverse * (wall - from);
        factors.extend(near.iter().map(|&j| (j, fraction * way.dot(&(position[j as usize] - middle)))));
    }

    /// Whether a particle is at a wall.
    #[inline]
    pub(in crate::fracture) fn holds(&self, i: usize) -> bool {
        self.row[i] != NONE
    }

    /// What the stress at the wall of such a particle is above that of its neighbourhood [Pa].
    #[inline]
    pub(in crate::fracture) fn difference(&self, i: usize, virials: &[Sym3]) -> Sym3 {
        let mut sum = Sym3::ZERO;
        self.factors[self.row[i] as usize].iter().for_each(|&(j, factor)| sum += virials[j as usize] * factor);
        sum
    }
}

/// Mean place of some particles, with the weights of their volumes [m].
fn centroid(of: &[u32], position: &[Vec3], volume: &[f64]) -> Vec3 {
    let (mut sum, mut all) = (Vec3::zeros(), 0.0);
    for &j in of {
        sum += position[j as usize] * volume[j as usize];
        all += volume[j as usize];
    }
    sum / all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fracture::criterion::{FractureCriterion, Principal};
    use crate::fracture::{FailureSearch, LoadedBonds};

    const FRACTION: f64 = 0.6;

    fn scatter(seed: usize) -> f64 {
        let s = (seed as f64 * 12.9898).sin() * 43_758.545;
        s - s.floor() - 0.5
    }

    /// Spheres of a jittered lattice in a box whose walls they face, and bonds to the nearest ones.
    fn block() -> (Vec<Vec3>, Vec<f64>, Vec<Vec3>, BondGraph) {
        let site = |i: usize| Vec3::new((i % 6) as f64, (i / 6 % 6) as f64, (i / 36) as f64);
        let position: Vec<Vec3> = (0..216).map(|i| site(i) + Vec3::from_fn(|a, _| 0.3 * scatter(3 * i + a))).collect();
        let radius = (0..216).map(|i| 0.5 + 0.1 * scatter(7000 + i)).collect();
        let to_wall = position.iter().map(|x| {
            x.map(|c| {
                if c < 1.5 {
                    -0.5 - c
                } else if c > 3.5 {
                    5.5 - c
                } else {
                    0.0
                }
            })
        });
        let near = |[i, j]: [usize; 2]| (position[i] - position[j]).norm() < 1.5;
        let pairs = (0..216).flat_map(|j| (0..j).map(move |i| [i, j])).filter(|pair| near(*pair));
        let pairs: Vec<[u32; 2]> = pairs.map(|pair| pair.map(|i| i as u32)).collect();
        (position.clone(), radius, to_wall.collect(), BondGraph::new(216, &pairs))
    }

    struct Field(Vec<Sym3>);

    impl LoadedBonds for Field {
        fn virials(&self, out: &mut [Sym3]) {
            out.copy_from_slice(&self.0);
        }
        fn load(&self, _bond: u32) -> crate::fracture::criterion::BondLoad {
            Default::default()
        }
        fn axis(&self, _bond: u32) -> Vec3 {
            Vec3::x()
        }
    }

    fn principal(tensile_strength: f64, level: Level) -> FractureCriterion {
        FractureCriterion::Principal(Principal { tensile_strength, compressive_strength: None, level })
    }

    #[test]
    fn a_linear_stress_is_that_of_the_wall_and_a_uniform_one_stays() {
        let (position, radius, to_wall, mut graph) = block();
        let (mean, slope) = (Sym3::new(3.0, 1.0, 2.0, 0.5, -0.4, 0.2), Sym3::new(0.2, -0.1, 0.3, 0.1, 0.2, -0.3));
        let linear = |x: &Vec3| mean + slope * (0.3 * x.x - 0.2 * x.y + 0.5 * x.z);
        for level in [Level::Own, Level::Neighbours, Level::Second] {
            let mut search = FailureSearch::new(principal(1.0, level), &graph, &radius, FRACTION).unwrap();
            search.read_at_walls(&position, &to_wall, &graph);
            for bond in (0..graph.pairs().len() as u32).filter(|bond| bond % 7 == 3) {
                graph.break_bond(bond);
                search.bond_broken(bond, &graph);
            }
            let mut read = |stress: &dyn Fn(&Vec3) -> Sym3| {
                let virial = |(x, r): (&Vec3, &f64)| stress(x) * (fractum_math::sphere_volume(*r) / FRACTION);
                let body = Field(position.iter().zip(&radius).map(virial).collect());
                search.search(&body, &graph, 0.0);
                search.stress().to_vec()
            };
            let (linear_read, uniform) = (read(&linear), read(&|_| mean));
            for i in (0..position.len()).filter(|i| to_wall[*i] != Vec3::zeros()) {
                let exact = linear(&(position[i] + to_wall[i]));
                assert!((linear_read[i] - exact).0.iter().all(|d| d.abs() < 1e-9), "{i} {level:?}");
                assert!((uniform[i] - mean).0.iter().all(|d| d.abs() < 1e-9), "{i} {level:?}");
            }
        }
    }

    #[test]
    fn what_scatters_adds_half_at_most() {
        let (position, radius, to_wall, graph) = block();
        let level = Level::Neighbours;
        let body = Field((0..216).map(|i| Sym3::isotropic(if i % 3 == 0 { 1.0 } else { 0.0 })).collect());
        let searched = |at_walls: bool| {
            let mut search = FailureSearch::new(principal(0.25, level), &graph, &radius, FRACTION).unwrap();
            search.read_at_walls(&position, if at_walls { &to_wall } else { &[] }, &graph);
            search.search(&body, &graph, 0.0);
            let mut ratios = vec![0.0; 216];
            search.overloaded().iter().for_each(|site| ratios[site.index as usize] = site.ratio);
            ratios
        };
        let [plain, at_walls] = [false, true].map(searched);
        let rise = |(plain, at): (&f64, &f64)| at / plain;
        let most = plain.iter().zip(&at_walls).map(rise).fold(0.0, f64::max);
        assert!((most - MOST).abs() < 1e-12, "{most}");
    }

    #[test]
    fn a_row_of_particles_has_no_gradient() {
        let position: Vec<Vec3> = (0..5).map(|i| Vec3::x() * f64::from(i)).collect();
        let graph = BondGraph::new(5, &[[0, 1], [1, 2], [2, 3], [3, 4]]);
        let mut at = AtWalls::new(&position, &[-Vec3::x(); 5]);
        at.gather(0, &graph, &[1.0; 5], FRACTION, Level::Neighbours);
        assert_eq!(at.difference(0, &[Sym3::isotropic(1.0); 5]), Sym3::ZERO);
    }
}
