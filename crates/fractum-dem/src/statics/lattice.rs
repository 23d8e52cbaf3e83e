//! The beam lattice in static equilibrium: one sparse solve instead of many time steps.

use fractum_math::{Mat3, Vec3};
use rayon::prelude::*;

use crate::DemError;
use crate::bond::{BeamSection, check_pairs, check_shares};

/// Displacement (x, y, z) [m] and rotation (x, y, z) of a particle; or the force [N] and moment [N m] conjugate to it.
pub type Dof6 = [f64; 6];

/// Number of particles handled as one block by the parallel loops; sums are combined in block order.
pub(crate) const BLOCK: usize = 1024;

/// Particles joined by linear Euler–Bernoulli beams, for small displacements about the reference state.
///
/// The stiffness is applied bond by bond and never assembled. Rotations are scaled by a length of the lattice, so that
/// all unknowns have the same magnitude.
#[derive(Clone, Debug)]
pub struct Lattice {
    section: BeamSection,
    position: Vec<Vec3>,
    offsets: Vec<u32>,
    ends: Vec<HalfBond>,
    /// Slots of each bond in `ends`.
    halves: Vec<[u32; 2]>,
    /// Length that turns rotations into displacements [m].
    scale: f64,
}

/// A bond as one of its particles sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HalfBond {
    pub(crate) other: u32,
    pub(crate) bond: u32,
    /// Unit vector towards the other particle.
    pub(crate) axis: [f64; 3],
    /// 1/length [1/m]; zero for a broken bond, which takes all its stiffness away.
    pub(crate) inverse: f64,
    /// Factor on the stiffness of the section.
    pub(crate) share: f64,
}

/// Prescribed degrees of freedom of the particles: a bit per fixed degree of freedom, and the value it is fixed to.
#[derive(Clone, Debug)]
pub struct LatticeSupports {
    pub(crate) fixed: Vec<u8>,
    pub(crate) value: Vec<Dof6>,
}

impl LatticeSupports {
    /// No supports on `count` particles.
    pub fn none(count: usize) -> Self {
        LatticeSupports { fixed: vec![0; count], value: vec![[0.0; 6]; count] }
    }

    /// Prescribes one degree of freedom (0–2 displacement [m], 3–5 rotation) of a particle.
    pub fn set(&mut self, particle: u32, dof: usize, value: f64) {
        self.fixed[particle as usize] |= 1 << dof;
        self.value[particle as usize][dof] = value;
    }

    /// The same degrees of freedom, held where they are.
    pub(crate) fn held(&self) -> Self {
        LatticeSupports { fixed: self.fixed.clone(), value: vec![[0.0; 6]; self.value.len()] }
    }

    /// Whether a degree of freedom is prescribed.
    pub fn is_fixed(&self, particle: u32, dof: usize) -> bool {
        self.fixed[particle as usize] >> dof & 1 == 1
    }
}

/// A state of equilibrium.
#[derive(Clone, Debug)]
pub struct Equilibrium {
    /// Displacements [m] and rotations.
    pub state: Vec<Dof6>,
    /// Internal forces [N] and moments [N m], K u: reactions at supports, the loads elsewhere.
    pub force: Vec<Dof6>,
    /// Elastic energy ½ u·K u [J].
    pub energy: f64,
    /// Iterations of the conjugate gradients.
    pub iterations: usize,
}

/// When to stop iterating.
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    /// Unbalanced force over the applied force (norms).
    pub residual: f64,
    /// Largest number of iterations.
    pub iterations: usize,
    /// Asked in every iteration: whether to give up with [`DemError::Interrupted`].
    pub stop: fn() -> bool,
}

impl Default for Tolerance {
    fn default() -> Self {
        Tolerance { residual: 1e-5, iterations: 20_000, stop: || false }
    }
}

impl Lattice {
    /// A lattice of equal beams.
    ///
    /// - `position`: reference centres [m]
    /// - `pairs`: the particles of each bond
    /// - `scale`: a length of the lattice, such as the mean particle radius [m]
    ///
    /// # Errors
    /// A section that is no beam; a bond that joins nothing.
    pub fn new(position: &[Vec3], pairs: &[[u32; 2]], section: BeamSection, scale: f64) -> Result<Self, DemError> {
        Self::with_shares(position, pairs, &[], section, scale)
    }

    /// [`Lattice::new`] with a factor on the stiffness of each beam.
    ///
    /// - `shares`: factors in the order of `pairs`; 1 where there are none
    ///
    /// # Errors
    /// As [`Lattice::new`]; another number of factors than of bonds.
    pub fn with_shares(
        position: &[Vec3],
        pairs: &[[u32; 2]],
        shares: &[f64],
        section: BeamSection,
        scale: f64,
    ) -> Result<Self, DemError> {
        Self::between(position, pairs, shares, section, scale, &|apart| apart)
    }

    /// [`Lattice::with_shares`] whose beams join images of particles.
    ///
    /// - `nearest`: from the vector between two centres to that between the first one and the image of the second [m]
    ///
    /// # Errors
    /// As [`Lattice::with_shares`].
    pub fn between(
        position: &[Vec3],
        pairs: &[[u32; 2]],
        shares: &[f64],
        section: BeamSection,
        scale: f64,
        nearest: &dyn Fn(Vec3) -> Vec3,
    ) -> Result<Self, DemError> {
        section.check()?;
        check_shares(pairs, shares)?;
        let count = position.len();
        let mut offsets = vec![0u32; count + 1];
        check_pairs(position, pairs)?;
        for &[first, second] in pairs {
            offsets[first as usize + 1] += 1;
            offsets[second as usize + 1] += 1;
        }
        for i in 0..count {
            offsets[i + 1] += offsets[i];
        }
        let mut next = offsets.clone();
        let mut ends = vec![HalfBond { other: 0, bond: 0, axis: [0.0; 3], inverse: 0.0, share: 1.0 }; 2 * pairs.len()];
        let mut halves = Vec::with_capacity(pairs.len());
        for (bond, &[first, second]) in pairs.iter().enumerate() {
            let d = nearest(position[second as usize] - position[first as usize]);
            let length = d.norm();
            let share = shares.get(bond).copied().unwrap_or(1.0);
            halves.push([(first, second, 1.0), (second, first, -1.0)].map(|(own, other, sign)| {
                let axis = (d * (sign / length)).into();
                let slot = next[own as usize];
                ends[slot as usize] = HalfBond { other, bond: bond as u32, axis, inverse: 1.0 / length, share };
                next[own as usize] += 1;
                slot
            }));
        }
        Ok(Lattice { section, position: position.to_vec(), offsets, ends, halves, scale })
    }

    /// Changes the section of all beams.
    ///
    /// # Errors
    /// A section that is no beam.
    pub fn set_section(&mut self, section: BeamSection) -> Result<(), DemError> {
        section.check()?;
        self.section = section;
        Ok(())
    }

    /// The section of all beams.
    pub fn section(&self) -> BeamSection {
        self.section
    }

    /// Reference centres [m].
    pub fn position(&self) -> &[Vec3] {
        &self.position
    }

    /// Length that turns rotations into displacements [m].
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// Whether there are no particles.
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }

    #[inline]
    pub(crate) fn ends(&self, i: usize) -> &[HalfBond] {
        &self.ends[self.offsets[i] as usize..self.offsets[i + 1] as usize]
    }

    /// Internal forces [N] and moments [N m] for displacements and rotations.
    pub fn internal(&self, state: &[Dof6]) -> Vec<Dof6> {
        let scaled: Vec<Dof6> = state.iter().map(|s| self.rescale(s, self.scale)).collect();
        let mut force = vec![[0.0; 6]; self.len()];
        let free = vec![0; self.len()];
        self.apply(&scaled, &free, &mut force);
        force.iter_mut().for_each(|f| *f = self.rescale(f, self.scale));
        force
    }

    /// Internal forces [N] and moments [N m] where all beams have a uniform gradient of displacement, and no particle turns.
    pub fn internal_of_gradient(&self, gradient: &Mat3) -> Vec<Dof6> {
        let section = self.section;
        let of = |i: usize| {
            let mut sum = [Vec3::zeros(); 2];
            for end in self.ends(i).iter().filter(|end| end.inverse > 0.0) {
                let n = Vec3::from(end.axis);
                let way = gradient * n;
                let along = way.dot(&n);
                // EA along the beam, 12 EI/l² across it; the way grows with its length.
                let across = section.bending() * end.inverse * end.inverse * end.share;
                sum[0] -= n * (section.axial() * end.share * along) + (way - n * along) * (12.0 * across);
                sum[1] -= n.cross(&way) * (6.0 * across / end.inverse);
            }
            let [force, moment] = sum;
            [force.x, force.y, force.z, moment.x, moment.y, moment.z]
        };
        (0..self.len()).into_par_iter().map(of).collect()
    }

    /// Twice the energy between two uniform gradients of displacement without turning particles [J].
    pub fn energy_of_gradients(&self, first: &Mat3, second: &Mat3) -> f64 {
        let section = self.section;
        let of = |end: &HalfBond| {
            let n = Vec3::from(end.axis);
            let (one, other) = (first * n, second * n);
            let along = one.dot(&n) * other.dot(&n);
            let across = 12.0 * section.bending() * end.inverse * end.inverse * (one.dot(&other) - along);
            (section.axial() * along + across) * end.share / end.inverse
        };
        // Every beam has two ends.
        0.5 * self.ends.iter().filter(|end| end.inverse > 0.0).map(of).sum::<f64>()
    }

    /// Multiplies the rotational part.
    pub(crate) fn rescale(&self, v: &Dof6, factor: f64) -> Dof6 {
        [v[0], v[1], v[2], v[3] * factor, v[4] * factor, v[5] * factor]
    }

    /// Forces on particle `i` in scaled variables.
    #[inline]
    pub(crate) fn row(&self, i: usize, x: &[Dof6], k: &Stiffness) -> Dof6 {
        let own = &x[i];
        let mut f = [0.0; 6];
        for end in self.ends(i) {
            let other = &x[end.other as usize];
            let n = end.axis;
            let inverse = end.inverse;
            let stiff = inverse * end.share;
            let bend = k.bending * stiff;
            let shear = 6.0 * bend * inverse * k.scale;
            let transverse = 12.0 * bend * inverse * inverse;
            let axial = k.axial * stiff - transverse;
            let du = [other[0] - own[0], other[1] - own[1], other[2] - own[2]];
            let stretch = axial * (du[0] * n[0] + du[1] * n[1] + du[2] * n[2]);
            let sum = [own[3] + other[3], own[4] + other[4], own[5] + other[5]];
            // 2 EI/l (2 θ_i + θ_j) in scaled variables, and the twist θ_j − θ_i about the axis.
            let two = 2.0 * bend * k.scale * k.scale;
            let mix = [own[3] + sum[0], own[4] + sum[1], own[5] + sum[2]];
            let twist =
                (sum[0] - 2.0 * own[3]) * n[0] + (sum[1] - 2.0 * own[4]) * n[1] + (sum[2] - 2.0 * own[5]) * n[2];
            let along =
                two * (mix[0] * n[0] + mix[1] * n[1] + mix[2] * n[2]) + k.torsion * k.scale * k.scale * stiff * twist;
            f[0] += shear * (sum[1] * n[2] - sum[2] * n[1]) - stretch * n[0] - transverse * du[0];
            f[1] += shear * (sum[2] * n[0] - sum[0] * n[2]) - stretch * n[1] - transverse * du[1];
            f[2] += shear * (sum[0] * n[1] - sum[1] * n[0]) - stretch * n[2] - transverse * du[2];
            f[3] += two * mix[0] - shear * (n[1] * du[2] - n[2] * du[1]) - along * n[0];
            f[4] += two * mix[1] - shear * (n[2] * du[0] - n[0] * du[2]) - along * n[1];
            f[5] += two * mix[2] - shear * (n[0] * du[1] - n[1] * du[0]) - along * n[2];
        }
        f
    }

    pub(crate) fn stiffness(&self) -> Stiffness {
        Stiffness {
            axial: self.section.axial(),
            bending: self.section.bending(),
            torsion: self.section.torsion(),
            scale: 1.0 / self.scale,
        }
    }

    /// K x with fixed rows set to zero, and x·K x.
    pub(crate) fn apply(&self, x: &[Dof6], fixed: &[u8], out: &mut [Dof6]) -> f64 {
        let k = self.stiffness();
        let partial: Vec<f64> = out
            .par_chunks_mut(BLOCK)
            .enumerate()
            .map(|(block, out)| {
                let mut product = 0.0;
                for (slot, f) in out.iter_mut().enumerate() {
                    let i = block * BLOCK + slot;
                    *f = self.row(i, x, &k);
                    if fixed[i] != 0 {
                        clear(f, fixed[i]);
                    }
                    product += dot(f, &x[i]);
                }
                product
            })
            .collect();
        partial.iter().sum()
    }

    /// Diagonal of K in scaled variables.
    pub(crate) fn diagonal(&self) -> Vec<Dof6> {
        let k = self.stiffness();
        (0..self.len()).into_par_iter().map(|i| self.diagonal_row(i, &k)).collect()
    }

    /// Diagonal of K at a particle, in scaled variables.
    pub(crate) fn diagonal_row(&self, i: usize, k: &Stiffness) -> Dof6 {
        let mut d = [0.0; 6];
        for end in self.ends(i) {
            let stiff = end.inverse * end.share;
            let bend = k.bending * stiff;
            let transverse = 12.0 * bend * end.inverse * end.inverse;
            for a in 0..3 {
                let square = end.axis[a] * end.axis[a];
                d[a] += k.axial * stiff * square + transverse * (1.0 - square);
                d[a + 3] += k.scale * k.scale * (4.0 * bend * (1.0 - square) + k.torsion * stiff * square);
            }
        }
        d
    }

    /// Breaks a bond for ever: it has no stiffness any more.
    pub fn break_bond(&mut self, bond: u32) {
        for slot in self.halves[bond as usize] {
            self.ends[slot as usize].inverse = 0.0;
        }
    }

    /// Bonds without stiffness.
    pub(crate) fn loose(&self) -> impl Iterator<Item = u32> {
        (0..self.halves.len() as u32).filter(|&bond| self.bond(bond)[0].inverse == 0.0)
    }

    /// The only bond that holds a particle and the particle at its other end; none where more bonds hold it.
    pub(crate) fn last_bond(&self, i: usize) -> Option<(u32, usize)> {
        let mut left = self.ends(i).iter().filter(|end| end.inverse > 0.0);
        let last = left.next().filter(|_| left.next().is_none())?;
        Some((last.bond, last.other as usize))
    }

    /// The ends of a bond, at its first and at its second particle.
    pub(crate) fn bond(&self, bond: u32) -> [&HalfBond; 2] {
        self.halves[bond as usize].map(|slot| &self.ends[slot as usize])
    }

    /// Force that each bond exerts on its first particle, for a state: calls `visit(i, j, force on i)` once per bond,
    /// in a fixed order, with i < j.
    pub fn bond_forces(&self, state: &[Dof6], mut visit: impl FnMut(usize, usize, Vec3)) {
        let k = Stiffness { scale: 1.0, ..self.stiffness() };
        for i in 0..self.len() {
            for end in self.ends(i).iter().filter(|end| end.other as usize > i) {
                let j = end.other as usize;
                let (a, b) = (&state[i], &state[j]);
                let n = Vec3::from(end.axis);
                let du = Vec3::new(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
                let sum = Vec3::new(a[3] + b[3], a[4] + b[4], a[5] + b[5]);
                let stiff = end.inverse * end.share;
                let bend = k.bending * stiff * end.inverse;
                let along = du.dot(&n);
                let across = du - n * along;
                visit(
                    i,
                    j,
                    n * (k.axial * stiff * along) + across * (12.0 * bend * end.inverse) - sum.cross(&n) * (6.0 * bend),
                );
            }
        }
    }
}

/// Section constants and 1/length of the rotation scale.
pub(crate) struct Stiffness {
    pub(crate) axial: f64,
    pub(crate) bending: f64,
    pub(crate) torsion: f64,
    pub(crate) scale: f64,
}

#[inline]
pub(crate) fn dot(a: &Dof6, b: &Dof6) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4] + a[5] * b[5]
}

#[inline]
pub(crate) fn clear(f: &mut Dof6, fixed: u8) {
    for (d, value) in f.iter_mut().enumerate() {
        if fixed >> d & 1 == 1 {
            *value = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use fractum_kernels::bond::{BondForces, BondLaw, BondedPair};
    use fractum_math::Rotation;
    use proptest::prelude::*;

    use super::*;

    /// The 12×12 stiffness of a beam along x (Przemieniecki, *Theory of Matrix Structural Analysis*, 1968, ch. 5).
    fn textbook(section: &BeamSection, l: f64) -> nalgebra_matrix::Matrix12 {
        let (ea, ei, gj) = (section.axial(), section.bending(), section.torsion());
        let mut k = nalgebra_matrix::Matrix12::zeros();
        let mut put = |i: usize, j: usize, v: f64| {
            k[(i, j)] = v;
            k[(j, i)] = v;
        };
        for (a, b, v) in [(0, 6, ea / l), (3, 9, gj / l)] {
            put(a, a, v);
            put(b, b, v);
            put(a, b, -v);
        }
        let (k1, k2, k3, k4) = (12.0 * ei / l.powi(3), 6.0 * ei / (l * l), 4.0 * ei / l, 2.0 * ei / l);
        // Bending in xy (v, θz) and in xz (w, θy; the couplings change sign).
        for (v, t, s) in [(1, 5, 1.0), (2, 4, -1.0)] {
            put(v, v, k1);
            put(v + 6, v + 6, k1);
            put(v, v + 6, -k1);
            put(t, t, k3);
            put(t + 6, t + 6, k3);
            put(t, t + 6, k4);
            put(v, t, s * k2);
            put(v, t + 6, s * k2);
            put(v + 6, t, -s * k2);
            put(v + 6, t + 6, -s * k2);
        }
        k
    }

    mod nalgebra_matrix {
        pub(super) type Matrix12 = nalgebra::SMatrix<f64, 12, 12>;
    }

    #[test]
    fn one_bond_has_the_textbook_stiffness() {
        let section = BeamSection { young_modulus: 3.0, poisson_ratio: 0.3, radius: 0.7 };
        let l = 1.7;
        let lattice = Lattice::new(&[Vec3::zeros(), Vec3::x() * l], &[[0, 1]], section, 0.4).unwrap();
        let expected = textbook(&section, l);
        for dof in 0..12 {
            let mut state = [[0.0; 6]; 2];
            state[dof / 6][dof % 6] = 1.0;
            let force = lattice.internal(&state);
            for row in 0..12 {
                let difference = force[row / 6][row % 6] - expected[(row, dof)];
                assert!(difference.abs() < 1e-12 * expected.norm(), "row {row} column {dof}: {difference}");
            }
        }
    }

    fn random_body(points: &[[f64; 3]]) -> (Vec<Vec3>, Vec<[u32; 2]>) {
        let position: Vec<Vec3> = points.iter().map(|&p| p.into()).collect();
        let n = position.len() as u32;
        let pairs = (0..n).flat_map(|i| (i + 1..n).map(move |j| [i, j]));
        let apart = |&[i, j]: &[u32; 2]| (position[i as usize] - position[j as usize]).norm() > 0.05;
        let pairs = pairs.filter(apart).collect();
        (position, pairs)
    }

    proptest! {
        #[test]
        fn forces_and_moments_balance(
            points in prop::collection::vec(prop::array::uniform3(-1.0f64..1.0), 2..8), seed in 0u32..1000,
        ) {
            let (position, pairs) = random_body(&points);
            let lattice = Lattice::new(&position, &pairs, BeamSection::new(2.0, 0.3).unwrap(), 0.2).unwrap();
            let wave = |k: usize| ((k as f64 + 1.0) * (f64::from(seed) + 0.37)).sin();
            let state: Vec<Dof6> = (0..position.len()).map(|i| std::array::from_fn(|d| wave(6 * i + d))).collect();
            let force = lattice.internal(&state);
            let part = |v: &Dof6, o: usize| Vec3::new(v[o], v[o + 1], v[o + 2]);
            let size: f64 = 1e-30 + force.iter().map(|f| part(f, 0).norm() + part(f, 3).norm()).sum::<f64>();
            let total: Vec3 = force.iter().map(|f| part(f, 0)).sum();
            let moment: Vec3 = force.iter().zip(&position).map(|(f, x)| part(f, 3) + x.cross(&part(f, 0))).sum();
            prop_assert!(total.norm() < 1e-12 * size && moment.norm() < 1e-12 * size);
        }

        #[test]
        fn small_rigid_motion_gives_no_force(
            points in prop::collection::vec(prop::array::uniform3(-1.0f64..1.0), 2..8),
            shift in prop::array::uniform3(-1.0f64..1.0), spin in prop::array::uniform3(-1.0f64..1.0),
        ) {
            let (position, pairs) = random_body(&points);
            let lattice = Lattice::new(&position, &pairs, BeamSection::new(1.0, 0.3).unwrap(), 0.2).unwrap();
            let (shift, spin) = (Vec3::from(shift), Vec3::from(spin));
            let move_of = |x: &Vec3| { let u = shift + spin.cross(x); [u.x, u.y, u.z, spin.x, spin.y, spin.z] };
            let state: Vec<Dof6> = position.iter().map(move_of).collect();
            let stiff: f64 = lattice.diagonal().iter().flatten().sum();
            for force in lattice.internal(&state) {
                prop_assert!(force.iter().all(|f| f.abs() < 1e-13 * (1.0 + stiff)));
            }
        }
    }

    #[test]
    fn a_cantilever_chain_bends_like_a_beam() {
        // Twenty beams in line behave as one: tip deflection F L³/(3 E I), rotation F L²/(2 E I), exactly.
        let n = 21;
        let position: Vec<Vec3> = (0..n).map(|i| Vec3::x() * (0.1 * i as f64)).collect();
        let pairs: Vec<[u32; 2]> = (1..n as u32).map(|i| [i - 1, i]).collect();
        let section = BeamSection::new(1e9, 0.03).unwrap();
        let lattice = Lattice::new(&position, &pairs, section, 0.05).unwrap();
        let mut supports = LatticeSupports::none(n);
        (0..6).for_each(|d| supports.set(0, d, 0.0));
        let mut loads = vec![[0.0; 6]; n];
        loads[n - 1][1] = 5.0;
        let tolerance = Tolerance { residual: 1e-11, ..Tolerance::default() };
        let rest = lattice.solve(&supports, Some(&loads), &vec![[0.0; 6]; n], tolerance).unwrap();
        let (l, ei) = (2.0f64, section.bending());
        assert!((rest.state[n - 1][1] / (5.0 * l.powi(3) / (3.0 * ei)) - 1.0).abs() < 1e-8);
        assert!((rest.state[n - 1][5] / (5.0 * l.powi(2) / (2.0 * ei)) - 1.0).abs() < 1e-8);
        assert!((rest.force[0][1] + 5.0).abs() < 1e-8 && (rest.force[0][5] + 10.0).abs() < 1e-8);
        assert!((rest.energy / (0.5 * 5.0 * rest.state[n - 1][1]) - 1.0).abs() < 1e-8);
    }

    #[test]
    fn a_load_without_support_is_an_error() {
        let position = [Vec3::zeros(), Vec3::x()];
        let lattice = Lattice::new(&position, &[[0, 1]], BeamSection::new(1.0, 0.3).unwrap(), 0.2).unwrap();
        let loads = [[1.0, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0; 6]];
        let solved = lattice.solve(&LatticeSupports::none(2), Some(&loads), &[[0.0; 6]; 2], Tolerance::default());
        assert!(matches!(solved, Err(DemError::NotConverged { .. })), "{solved:?}");
        assert!(matches!(
            lattice.solve(&LatticeSupports::none(3), None, &[[0.0; 6]; 2], Tolerance::default()),
            Err(DemError::Length { .. })
        ));
        assert!(matches!(Lattice::new(&position, &[[0, 2]], lattice.section(), 0.2), Err(DemError::BadBond { .. })));
        assert!(matches!(Lattice::new(&position, &[[1, 1]], lattice.section(), 0.2), Err(DemError::BadBond { .. })));
        assert!(BeamSection::new(f64::NAN, 1.0).is_err() && BeamSection::new(1.0, -1.0).is_err());
    }

    #[test]
    fn small_motion_of_a_bond_has_the_stiffness_of_the_lattice() {
        let (axis, section) = (
            Vec3::new(2.8, 0.8, -0.4).normalize(),
            BeamSection { young_modulus: 2.0, poisson_ratio: 0.3, radius: 0.6 },
        );
        let position = [Vec3::zeros(), axis * 1.2];
        let start = BondedPair { position, rotation: [Rotation::identity(); 2], axis, length: 1.2 };
        let share = 1.3;
        let lattice = Lattice::with_shares(&position, &[[0, 1]], &[share], section, 0.5).unwrap();
        let h = 1e-7;
        for dof in 0..12 {
            let mut state = [[0.0; 6]; 2];
            state[dof / 6][dof % 6] = h;
            let shift = |e: usize, o: usize| Vec3::new(state[e][o], state[e][o + 1], state[e][o + 2]);
            let moved = BondedPair {
                position: [start.position[0] + shift(0, 0), start.position[1] + shift(1, 0)],
                rotation: [Rotation::from_scaled_axis(shift(0, 3)), Rotation::from_scaled_axis(shift(1, 3))],
                ..start
            };
            let BondForces { force, moment } = section.force(&moved, &share, &mut ());
            let expected = lattice.internal(&state);
            for a in 0..3 {
                for (found, row) in [
                    (-force[a], expected[0][a]),
                    (force[a], expected[1][a]),
                    (moment[0][a], expected[0][a + 3]),
                    (moment[1][a], expected[1][a + 3]),
                ] {
                    assert!((found + row).abs() < 1e-6 * h * section.axial(), "dof {dof} axis {a}: {found} {row}");
                }
            }
        }
    }
}
