//! The lowest eigenpairs of K φ = λ M φ with a lumped mass, by a block Davidson method.
//!
//! A basis grows by the residuals of the wanted pairs, to which an inverse of the stiffness is applied. With a factorisation the
//! basis is the one of a shift-and-invert Lanczos method with full reorthogonalisation, in blocks; with a preconditioner the method
//! needs no factorisation. Pairs are found in the whole basis, which starts from more random vectors than there are pairs
//! to find: equal eigenvalues are found as often as they occur.

use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::basis::{Basis, Bundle};
use crate::block::BlockMatrix;

/// An inverse of a stiffness, exact or nearly so.
pub trait Inverse<const B: usize> {
    /// Applies it to vectors, in place.
    fn apply(&mut self, vectors: &mut Bundle);
}

/// What vibrates.
#[derive(Clone, Copy, Debug)]
pub struct Vibration<'a, const B: usize> {
    /// K, with held unknowns taken out ([`BlockMatrix::hold`]).
    pub stiffness: &'a BlockMatrix<B>,
    /// Diagonal of M; 0 where an unknown is held.
    pub mass: &'a [[f64; B]],
    /// Motions without stiffness that are known and not looked for.
    pub rigid: &'a [Vec<[f64; B]>],
}

/// How the lowest pairs are looked for.
#[derive(Clone, Copy, Debug)]
pub struct Search {
    /// Number of pairs.
    pub count: usize,
    /// Residual M⁻¹ᐟ² (K φ − λ M φ) over λ at which a pair is accepted, or over `small` where λ is less. The error of λ is of second
    /// order in it.
    pub tolerance: f64,
    /// An eigenvalue that counts as small [1/s²].
    pub small: f64,
    /// Extensions of the basis after which the search ends in any case.
    pub most: usize,
    /// Whether to give up, asked at every extension.
    pub stop: fn() -> bool,
}

/// What was found.
#[derive(Clone, Debug, Default)]
pub struct Pairs<const B: usize> {
    /// λ, ascending.
    pub values: Vec<f64>,
    /// φ with φᵀ M φ = 1; the largest component is positive.
    pub vectors: Vec<Vec<[f64; B]>>,
    /// Residual of each pair, see [`Search::tolerance`].
    pub residuals: Vec<f64>,
    /// Extensions of the basis.
    pub extensions: usize,
    /// Whether all residuals are small enough.
    pub converged: bool,
}

/// Vectors of the basis beyond the wanted ones after a restart: a few, and a part of these.
const GUARDS: [usize; 2] = [4, 4];
/// Pairs beyond the wanted ones by whose residuals the basis grows too: those that may yet come among these.
const BEYOND: usize = 2;
/// Vectors of the basis over those that a restart leaves.
const GROWTH: usize = 4;
/// Part of the square of a vector that is left beside the basis below which it brings nothing new.
const NOTHING_NEW: f64 = 1e-22;
/// Eigenvalue of the Gram matrix of unit vectors below which a sum of them is noise.
const PARALLEL: f64 = 1e-10;
/// Residual that counts as found at most, where rounding lets it fall no further.
const COARSE: f64 = 1e-3;
/// Roundings of the largest eigenvalue that a residual consists of at least.
const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// Finds the lowest eigenpairs; fewer where there are not so many.
///
/// - `inverse`: of K, or of K + α M with a small α > 0 where K is singular
pub fn lowest_pairs<const B: usize>(
    vibration: Vibration<'_, B>,
    inverse: &mut dyn Inverse<B>,
    search: Search,
) -> Pairs<B> {
    let Vibration { stiffness, mass, rigid } = vibration;
    let mass = mass.as_flattened();
    let rows = mass.len();
    let free = mass.iter().filter(|m| **m > 0.0).count().saturating_sub(rigid.len());
    let count = search.count.min(free);
    let kept = (count + GUARDS[0] + count / GUARDS[1]).min(free);
    let floor = ROUNDING * largest_ratio(stiffness, mass);
    let mut fixed = Basis::new(rows);
    for motion in rigid {
        let mut one = Basis::new(rows);
        one.extend(1, |row, _| motion.as_flattened()[row]);
        let own = orthonormal(one, &[&fixed], mass);
        fixed.append(&own);
    }
    let (mut basis, mut image) = (Basis::new(rows), Basis::new(rows));
    let mut form = DMatrix::<f64>::zeros(0, 0);
    let mut start = Bundle::zeros(rows, kept);
    start.values.par_iter_mut().enumerate().for_each(|(i, value)| *value = random(i) * mass[i / kept.max(1)]);
    inverse.apply(&mut start);
    let mut new = orthonormal(masked(start, mass), &[&fixed], mass);
    let mut found = Pairs::default();
    let mut before: Option<DMatrix<f64>> = None;
    let (mut values, mut weights) = (Vec::new(), DMatrix::zeros(0, 0));
    loop {
        let stiff = multiplied(stiffness, &new);
        form = bordered(&form, &basis.products(&stiff, None), &new.products(&stiff, None));
        basis.append(&new);
        image.append(&stiff);
        (values, weights) = if new.count() > 0 { sorted_eigen(&form) } else { (values, weights) };
        found.extensions += 1;
        // Residuals of the pairs that are not good enough.
        let within = kept.min(values.len());
        let leading = weights.columns(0, within).into_owned();
        let mut residual = image.combined(&leading);
        let vectors = basis.combined(&leading);
        let negative: Vec<f64> = values[..within].iter().map(|value| -value).collect();
        residual.add_weighted(&vectors, mass, &negative);
        let sizes = sizes(&residual, mass);
        let is_good = |pair: usize| {
            let scale = values[pair].abs().max(search.small);
            sizes[pair] <= (search.tolerance * scale).max(floor)
        };
        let wanted = count.min(within);
        let all_good = (0..wanted).all(is_good);
        if all_good || new.count() == 0 || found.extensions >= search.most || (search.stop)() {
            for pair in 0..wanted {
                found.values.push(values[pair]);
                found.vectors.push(with_sign(vectors.vector(pair)));
                found.residuals.push(sizes[pair] / values[pair].abs().max(search.small));
            }
            found.converged = all_good && wanted == count && found.residuals.iter().all(|residual| *residual < COARSE);
            return found;
        }
        let open: Vec<usize> = (0..within.min(count + BEYOND)).filter(|&pair| !is_good(pair)).collect();
        let mut picked = DMatrix::zeros(within, open.len());
        open.iter().enumerate().for_each(|(column, &pair)| picked[(pair, column)] = 1.0 / sizes[pair]);
        let mut next = residual.combined(&picked).bundle(|row| f64::from(u8::from(mass[row] > 0.0)));
        inverse.apply(&mut next);
        let next = masked(next, mass);
        if basis.count() + next.count() > GROWTH * kept.max(1) {
            let q = restart(&leading, before.take());
            basis = basis.combined(&q);
            image = image.combined(&q);
            form = q.transpose() * &form * &q;
            form = (&form + form.transpose()) * 0.5;
            (values, weights) = sorted_eigen(&form);
        }
        before = Some(weights.columns(0, within.min(weights.ncols())).into_owned());
        new = orthonormal(next, &[&fixed, &basis], mass);
    }
}

/// The largest of K_aa / m_a, twice: above the largest eigenvalue, or near to it.
fn largest_ratio<const B: usize>(stiffness: &BlockMatrix<B>, mass: &[f64]) -> f64 {
    let of = |i: usize| {
        let diagonal = stiffness.diagonal(i / B)[i % B][i % B];
        if mass[i] > 0.0 { 2.0 * diagonal / mass[i] } else { 0.0 }
    };
    (0..mass.len()).map(of).fold(0.0, f64::max)
}

/// Vectors without the entries of held unknowns.
fn masked(mut bundle: Bundle, mass: &[f64]) -> Basis {
    let width = bundle.width.max(1);
    for (entries, _) in bundle.values.chunks_exact_mut(width).zip(mass).filter(|(_, mass)| **mass <= 0.0) {
        entries.fill(0.0);
    }
    Basis::of_bundle(&bundle)
}

/// K times the vectors.
fn multiplied<const B: usize>(stiffness: &BlockMatrix<B>, vectors: &Basis) -> Basis {
    let x = vectors.bundle(|_| 1.0);
    let mut y = Bundle::zeros(x.values.len() / x.width.max(1), x.width);
    stiffness.multiply_many(&x, &mut y);
    Basis::of_bundle(&y)
}

/// A symmetric matrix with further rows and columns.
fn bordered(form: &DMatrix<f64>, beside: &DMatrix<f64>, corner: &DMatrix<f64>) -> DMatrix<f64> {
    let old = form.nrows();
    DMatrix::from_fn(old + corner.nrows(), old + corner.nrows(), |i, j| match (i < old, j < old) {
        (true, true) => form[(i, j)],
        (true, false) => beside[(i, j - old)],
        (false, true) => beside[(j, i - old)],
        (false, false) => 0.5 * (corner[(i - old, j - old)] + corner[(j - old, i - old)]),
    })
}

/// Eigenvalues, ascending, and eigenvectors.
fn sorted_eigen(form: &DMatrix<f64>) -> (Vec<f64>, DMatrix<f64>) {
    let eigen = form.clone().symmetric_eigen();
    let mut order: Vec<usize> = (0..form.nrows()).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    let values = order.iter().map(|&i| eigen.eigenvalues[i]).collect();
    (values, eigen.eigenvectors.select_columns(&order))
}

/// Norms of residuals.
fn sizes(residual: &Basis, mass: &[f64]) -> Vec<f64> {
    let inverse: Vec<f64> = mass.iter().map(|m| if *m > 0.0 { 1.0 / m } else { 0.0 }).collect();
    residual.squares(&inverse).into_iter().map(f64::sqrt).collect()
}

/// Coefficients of the basis that goes on: the best pairs, and what they were one extension ago.
fn restart(leading: &DMatrix<f64>, before: Option<DMatrix<f64>>) -> DMatrix<f64> {
    let Some(before) = before else { return leading.clone() };
    let earlier = before.resize_vertically(leading.nrows(), 0.0);
    let mut q: Vec<nalgebra::DVector<f64>> = leading.column_iter().map(|c| c.into_owned()).collect();
    for column in earlier.column_iter() {
        let mut rest = column.into_owned();
        for _ in 0..2 {
            for known in &q {
                let along = known.dot(&rest);
                rest.axpy(-along, known, 1.0);
            }
        }
        let size = rest.norm();
        if size > 1e-6 {
            q.push(rest / size);
        }
    }
    DMatrix::from_columns(&q)
}

/// What vectors bring beside others, M-orthonormal.
fn orthonormal(mut new: Basis, others: &[&Basis], mass: &[f64]) -> Basis {
    for _ in 0..2 {
        let before = new.squares(mass);
        for other in others.iter().filter(|other| other.count() > 0) {
            let along = other.products(&new, Some(mass));
            new.add(other, &-along);
        }
        let lengths = new.squares(mass);
        let kept: Vec<usize> = (0..new.count()).filter(|&v| lengths[v] > NOTHING_NEW * before[v]).collect();
        let unit =
            DMatrix::from_fn(new.count(), kept.len(), |i, j| if i == kept[j] { 1.0 / lengths[i].sqrt() } else { 0.0 });
        new = new.combined(&unit);
        // Of vectors that are nearly parallel what they have in common stays.
        let (values, directions) = sorted_eigen(&new.products(&new, Some(mass)));
        let good: Vec<usize> = (0..values.len()).rev().filter(|&i| values[i] > PARALLEL).collect();
        let scaled =
            DMatrix::from_fn(values.len(), good.len(), |i, j| directions[(i, good[j])] / values[good[j]].sqrt());
        new = new.combined(&scaled);
    }
    new
}

/// The vector or its opposite, so that the component that is largest by size is positive.
fn with_sign<const B: usize>(mut vector: Vec<[f64; B]>) -> Vec<[f64; B]> {
    // Of equal ones the first, though rounding may favour another.
    let largest = vector.as_flattened().iter().fold(0.0f64, |most, v| most.max(v.abs()));
    let first = vector.as_flattened().iter().find(|v| v.abs() >= (1.0 - 1e-6) * largest);
    if first.is_some_and(|v| *v < 0.0) {
        vector.as_flattened_mut().iter_mut().for_each(|v| *v = -*v);
    }
    vector
}

/// A number in (−½, ½) without pattern.
fn random(index: usize) -> f64 {
    let mut x = (index as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 53) as f64 - 0.5
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cholesky::Factor;
    use crate::coarse::Motions;
    use crate::incomplete::Preconditioner;

    /// A net, its places, and a mass for each unknown.
    fn net(n: u32) -> (BlockMatrix<2>, Vec<[f64; 3]>, Vec<[f64; 2]>) {
        let (k, places) = crate::net::net(n);
        let border =
            |p: &[f64; 3]| [p[0], p[1]].iter().filter(|x| **x == 0.0 || **x == f64::from(n - 1)).count() as i32;
        let mass = places.iter().map(|p| [2.0 * 0.5f64.powi(border(p)); 2]).collect();
        (k, places, mass)
    }

    fn search(count: usize) -> Search {
        Search { count, tolerance: 1e-6, small: 1e-9, most: 200, stop: || false }
    }

    /// All eigenvalues by a dense solver; held unknowns are left out.
    fn dense(k: &BlockMatrix<2>, mass: &[[f64; 2]]) -> Vec<f64> {
        let free: Vec<usize> = (0..2 * mass.len()).filter(|&i| mass[i / 2][i % 2] > 0.0).collect();
        let of = |i: usize, j: usize| {
            let found = k.pattern().row(i / 2).binary_search(&((j / 2) as u32));
            found.map_or(0.0, |place| k.row(i / 2)[place][i % 2][j % 2])
        };
        let scale = |i: usize| mass[i / 2][i % 2].sqrt();
        let n = free.len();
        let matrix = DMatrix::from_fn(n, n, |a, b| of(free[a], free[b]) / (scale(free[a]) * scale(free[b])));
        let mut values: Vec<f64> = matrix.symmetric_eigenvalues().iter().copied().collect();
        values.sort_by(f64::total_cmp);
        values
    }

    fn near(found: &[f64], exact: &[f64]) {
        for (found, exact) in found.iter().zip(exact) {
            assert!((found / exact - 1.0).abs() < 1e-9, "{found} against {exact}");
        }
    }

    #[test]
    fn pairs_of_a_held_net_are_those_of_a_dense_solver() {
        let (mut k, places, mut mass) = net(14);
        let held: Vec<u8> = places.iter().map(|p| if p[0] == 0.0 { 3 } else { 0 }).collect();
        held.iter().zip(&mut mass).filter(|(h, _)| **h != 0).for_each(|(_, m)| *m = [0.0; 2]);
        k.hold(&held, k.largest_diagonal());
        let vibration = Vibration { stiffness: &k, mass: &mass, rigid: &[] };
        let exact = dense(&k, &mass);
        let mut factor = Factor::new(k.pattern(), &places, 2).unwrap();
        factor.refactor(&k).unwrap();
        let direct = lowest_pairs(vibration, &mut factor, search(8));
        assert!(direct.converged && direct.values.len() == 8, "{direct:?}");
        near(&direct.values, &exact);
        let motions = Motions { places: &places, held: &held, cluster: 15 };
        let mut preconditioner = Preconditioner::new(&k, Some(motions)).unwrap();
        let iterative = lowest_pairs(vibration, &mut preconditioner, search(8));
        assert!(iterative.converged, "{iterative:?}");
        near(&iterative.values, &exact);
        println!("{} and {} extensions", direct.extensions, iterative.extensions);
        for (i, one) in direct.vectors.iter().enumerate() {
            for (j, other) in direct.vectors.iter().enumerate() {
                let product: f64 =
                    (0..mass.len()).map(|n| (0..2).map(|a| one[n][a] * mass[n][a] * other[n][a]).sum::<f64>()).sum();
                assert!((product - f64::from(u8::from(i == j))).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn a_free_square_has_its_double_eigenvalues_twice_and_no_rigid_motion() {
        let (k, places, mass) = net(12);
        let centre = 5.5;
        let one = |of: fn(f64, f64) -> [f64; 2]| places.iter().map(|p| of(p[0] - centre, p[1] - centre)).collect();
        let rigid: [Vec<[f64; 2]>; 3] = [one(|_, _| [1.0, 0.0]), one(|_, _| [0.0, 1.0]), one(|x, y| [-y, x])];
        let exact = dense(&k, &mass);
        assert!(exact[2] < 1e-10 && exact[3] > 1e-4);
        let doubles = (3..13).filter(|&i| exact[i + 1] / exact[i] - 1.0 < 1e-9).count();
        assert!(doubles >= 2, "{:?}", &exact[..14]);
        let mut shifted = k.clone();
        shifted.add_diagonal(&mass, 1e-4 * exact[3]);
        let mut factor = Factor::new(k.pattern(), &places, 2).unwrap();
        factor.refactor(&shifted).unwrap();
        let vibration = Vibration { stiffness: &k, mass: &mass, rigid: &rigid };
        let held = vec![0; places.len()];
        let motions = Motions { places: &places, held: &held, cluster: 15 };
        let mut preconditioner = Preconditioner::new(&shifted, Some(motions)).unwrap();
        // Double eigenvalues stand at every place of the row, also at its end.
        for count in (1..=14).chain([280, 400]) {
            let mut inverses: Vec<&mut dyn Inverse<2>> = vec![&mut factor];
            if count <= 14 {
                inverses.push(&mut preconditioner);
            }
            for inverse in inverses {
                let found = lowest_pairs(vibration, inverse, search(count));
                assert!(found.values.len() == count.min(exact.len() - 3), "{count}: {}", found.values.len());
                near(&found.values, &exact[3..]);
            }
        }
    }

    #[test]
    fn pairs_have_the_same_bits_for_any_number_of_threads() {
        let (mut k, places, mut mass) = net(60);
        let held: Vec<u8> = places.iter().map(|p| if p[1] == 0.0 { 3 } else { 0 }).collect();
        held.iter().zip(&mut mass).filter(|(h, _)| **h != 0).for_each(|(_, m)| *m = [0.0; 2]);
        k.hold(&held, k.largest_diagonal());
        let found = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let motions = Motions { places: &places, held: &held, cluster: 64 };
                let mut preconditioner = Preconditioner::new(&k, Some(motions)).unwrap();
                let vibration = Vibration { stiffness: &k, mass: &mass, rigid: &[] };
                lowest_pairs(vibration, &mut preconditioner, search(3))
            })
        };
        let one = found(1);
        assert!(one.converged);
        for threads in [2, 5] {
            let other = found(threads);
            assert!(other.values == one.values && other.vectors == one.vectors, "{threads} threads");
        }
    }
}
