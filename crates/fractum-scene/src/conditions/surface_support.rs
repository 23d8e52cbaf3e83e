//! Supports on facets: absorbing boundaries and elastic foundations.
//!
//! An absorbing facet has the dashpots of Lysmer and Kuhlemeyer, *J. Eng. Mech. Div. ASCE* 95 (1969) 859-877: the traction
//! −ρ c_P v_n n − ρ c_S v_t, which a plane wave at normal incidence does not feel as a border; before beds −√(ρ Γ) v with Christoffel's
//! tensor Γ of the normal, of which the same is true for all three waves. An elastic one has springs,
//! −k_n u_n n − k_t u_t. Both are lumped at the nodes, a third of every facet (half of an edge in the plane) each.

use fractum_fem::Solid;
use fractum_fem::neighbours::{self, MovedNodes};
use fractum_math::Vec3;
use nalgebra::Matrix3;

/// A facet on which something outside answers to the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupportedFacet {
    /// Its nodes; an edge in the plane repeats its second one.
    pub nodes: [u32; 3],
    /// Area [m²].
    pub area: f64,
    /// What answers to motion per area: impedances of dashpots [Pa s/m], stiffnesses of springs [Pa/m].
    pub answer: Matrix3<f64>,
}

impl SupportedFacet {
    /// What answers along a unit normal and across it: ρ c_P and ρ c_S of dashpots [Pa s/m], stiffnesses of springs [Pa/m].
    pub fn along_and_across(normal: Vec3, [along, across]: [f64; 2]) -> Matrix3<f64> {
        let dyad = normal * normal.transpose();
        dyad * along + (Matrix3::identity() - dyad) * across
    }
}

/// Matrices at nodes, the sums over their facets.
#[derive(Clone, Debug, Default)]
struct NodeMatrices {
    /// Ascending.
    nodes: Vec<u32>,
    matrix: Vec<Matrix3<f64>>,
    /// Those that this process moves.
    moved: MovedNodes,
}

impl NodeMatrices {
    fn new(facets: &[SupportedFacet]) -> Self {
        let mut shares: Vec<(u32, Matrix3<f64>)> = Vec::new();
        for SupportedFacet { nodes, area, answer } in facets {
            let corners = if nodes[1] == nodes[2] { 2 } else { 3 };
            let share = answer * (area / corners as f64);
            shares.extend(nodes[..corners].iter().map(|&node| (node, share)));
        }
        shares.sort_by_key(|share| share.0);
        let mut own = NodeMatrices::default();
        for (node, share) in shares {
            if own.nodes.last() == Some(&node) {
                *own.matrix.last_mut().expect("there is a node") += share;
            } else {
                own.nodes.push(node);
                own.matrix.push(share);
            }
        }
        own
    }

    /// Has something done for every node that this process moves: its place among the nodes, the node, its matrix.
    fn for_each_moved(&mut self, solid: &mut Solid, mut act: impl FnMut(&mut Solid, usize, usize, &Matrix3<f64>)) {
        let NodeMatrices { nodes, matrix, moved } = self;
        let places = neighbours::moved_among(solid, nodes, moved);
        let mut act = |place: usize| act(solid, place, nodes[place] as usize, &matrix[place]);
        match places {
            Some(places) => places.iter().for_each(|&place| act(place as usize)),
            None => (0..nodes.len()).for_each(act),
        }
    }
}

/// All supports on facets of the solids.
#[derive(Clone, Debug, Default)]
pub struct SurfaceSupports {
    dashpots: NodeMatrices,
    /// Forces of the dashpots at tⁿ [N].
    absorbing: Vec<Vec3>,
    /// What each of them has taken so far [J]. Every process knows that of the nodes that it moves.
    taken: Vec<f64>,
    springs: NodeMatrices,
    /// Energy in each of the springs at tⁿ [J]. Every process knows that of the nodes that it moves.
    stored: Vec<f64>,
    /// Largest square of a frequency that springs add, K/m [1/s²].
    frequency_square: f64,
}

impl SurfaceSupports {
    /// Nodes that they act on.
    pub(crate) fn nodes(&self) -> impl Iterator<Item = u32> {
        self.dashpots.nodes.iter().chain(&self.springs.nodes).copied()
    }

    /// Stiffness of the springs of every node that has some [N/m].
    pub(crate) fn springs(&self) -> impl Iterator<Item = (u32, &Matrix3<f64>)> {
        self.springs.nodes.iter().copied().zip(&self.springs.matrix)
    }

    /// Whether they act on a node.
    pub(crate) fn act_on(&self, node: u32) -> bool {
        [&self.dashpots, &self.springs].iter().any(|own| own.nodes.binary_search(&node).is_ok())
    }

    /// - `absorbing`, `elastic`: facets with dashpots and with springs
    /// - `mass`: of all nodes [kg]
    pub fn new(absorbing: &[SupportedFacet], elastic: &[SupportedFacet], mass: &[f64]) -> Self {
        let (dashpots, springs) = (NodeMatrices::new(absorbing), NodeMatrices::new(elastic));
        let square = |(&node, k): (&u32, &Matrix3<f64>)| k.symmetric_eigenvalues().max() / mass[node as usize];
        let frequency_square = springs.nodes.iter().zip(&springs.matrix).map(square).fold(0.0, f64::max);
        SurfaceSupports {
            absorbing: vec![Vec3::zeros(); dashpots.nodes.len()],
            taken: vec![0.0; dashpots.nodes.len()],
            stored: vec![0.0; springs.nodes.len()],
            dashpots,
            springs,
            frequency_square,
        }
    }

    /// What springs add to the square of the highest frequency at most, by Weyl's inequality [1/s²].
    pub(crate) fn frequency_square(&self) -> f64 {
        self.frequency_square
    }

    /// Brings the energies of all nodes up to date. All processes that share a solid must call it.
    pub(crate) fn gather(&mut self, solid: &Solid) {
        for (own, energies) in [(&mut self.dashpots, &mut self.taken), (&mut self.springs, &mut self.stored)] {
            neighbours::exchange_node_values(solid, &own.nodes, &mut own.moved, energies);
        }
    }

    /// Energy in the springs when their forces were added last [J].
    pub(crate) fn stored(&self) -> f64 {
        self.stored.iter().sum::<f64>() + 0.0
    }

    /// What the dashpots have taken so far [J].
    pub(crate) fn absorbed(&self) -> f64 {
        self.taken.iter().sum::<f64>() + 0.0
    }

    /// What each of the dashpots has taken so far [J], for a checkpoint.
    pub(crate) fn taken(&self) -> &[f64] {
        &self.taken
    }

    /// Puts that back.
    pub(crate) fn restore(&mut self, taken: Vec<f64>) {
        self.taken = taken;
    }

    /// Adds the forces of the springs.
    pub(crate) fn push(&mut self, solid: &mut Solid) {
        let stored = &mut self.stored;
        self.springs.for_each_moved(solid, |solid, place, node, k| {
            let displacement = solid.displacement_from_start(node);
            let force = k * displacement;
            stored[place] = 0.5 * displacement.dot(&force);
            solid.force[node] -= force;
        });
    }

    /// Adds the forces of the dashpots, once all others are known, and books what they take in the half step before tⁿ.
    ///
    /// They answer to the mean of the velocities before and after, (v⁻ + v⁺)/2, which a system of three unknowns per node
    /// gives: the step stays as large as without them, and what they take is never negative.
    ///
    /// - `held`: bit a is set where axis a of a node is prescribed; empty if none is
    /// - `first`: at the start the velocities are those of t = 0 and not of a half step before, in which nothing is taken
    pub(crate) fn absorb(&mut self, solid: &mut Solid, held: &[u8], [dt_before, dt_kick]: [f64; 2], first: bool) {
        let SurfaceSupports { dashpots, absorbing, taken, .. } = self;
        dashpots.for_each_moved(solid, |solid, place, i, c| {
            let (before, mass) = (solid.velocity[i], solid.mass[i]);
            let c = among_free_axes(c, held.get(i).copied().unwrap_or(0));
            let mean = if first {
                before
            } else {
                // m (v⁺ - v⁻)/Δt = F - C (v⁺ + v⁻)/2, so that (m/Δt + C/2) (v⁺ + v⁻)/2 = (m/Δt) v⁻ + F/2.
                let matrix = Matrix3::identity() * (mass / dt_kick) + c * 0.5;
                let right = before * (mass / dt_kick) + solid.force[i] * 0.5;
                matrix.cholesky().map_or(before, |factor| factor.solve(&right))
            };
            absorbing[place] = -(c * mean);
            if !first {
                taken[place] -= 0.5 * dt_before * absorbing[place].dot(&before);
            }
            solid.force[i] += absorbing[place];
        });
    }

    /// Books what the dashpots take in the half step after tⁿ, with the velocities after the kick.
    pub(crate) fn absorb_after(&mut self, solid: &mut Solid, dt_after: f64) {
        let SurfaceSupports { dashpots, absorbing, taken, .. } = self;
        dashpots.for_each_moved(solid, |solid, place, i, _| {
            taken[place] -= 0.5 * dt_after * absorbing[place].dot(&solid.velocity[i]);
        });
    }
}

/// The matrix without the axes that are prescribed.
fn among_free_axes(matrix: &Matrix3<f64>, held: u8) -> Matrix3<f64> {
    let free = |axis: usize| held & (1 << axis) == 0;
    Matrix3::from_fn(|a, b| if free(a) && free(b) { matrix[(a, b)] } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn facets_share_their_matrices_with_their_nodes() {
        let answer = |normal| SupportedFacet::along_and_across(normal, [4.0, 1.0]);
        let facet = |nodes, normal| SupportedFacet { nodes, area: 6.0, answer: answer(normal) };
        let own = NodeMatrices::new(&[facet([3, 1, 1], Vec3::x()), facet([1, 5, 7], Vec3::y())]);
        assert_eq!(own.nodes, [1, 3, 5, 7]);
        assert_eq!(own.matrix[1], Matrix3::from_diagonal(&Vec3::new(12.0, 3.0, 3.0)));
        assert_eq!(own.matrix[2], Matrix3::from_diagonal(&Vec3::new(2.0, 8.0, 2.0)));
        assert_eq!(own.matrix[0], own.matrix[1] + own.matrix[2]);
    }
}
