//! How four cells turn that are stretched by little, side by side, with the bits that each has alone.

use fractum_math::{FOUR, Lane, Sym3, by_component};

use crate::element::polar::{NEAR, product, roots, stretch_square};

/// Displacement gradients of four cells by rows, side by side.
pub(crate) struct FourGradients([[Lane; 3]; 3]);

/// M and n of four cells, see [`strain_and_turn`](crate::element::polar::strain_and_turn).
pub(crate) struct FourTurns {
    m: [[Lane; 3]; 3],
    n: [Lane; 6],
}

impl FourGradients {
    /// - `columns`: of each cell, derivatives along x, y, z
    #[inline(always)]
    pub(crate) fn new(columns: &[[Lane; 3]; FOUR]) -> Self {
        let mut rows = [[Lane::ZERO; 3]; 3];
        for row in 0..3 {
            for column in 0..3 {
                for k in 0..FOUR {
                    rows[row][column].0[k] = columns[k][column].0[row];
                }
            }
        }
        FourGradients(rows)
    }

    /// F = 1 + H.
    #[inline(always)]
    fn deformation(&self) -> [[Lane; 3]; 3] {
        let mut f = self.0;
        for row in 0..3 {
            for column in 0..3 {
                f[row][column] = Lane::splat(if row == column { 1.0 } else { 0.0 }) + f[row][column];
            }
        }
        f
    }

    /// Determinants of F: not positive where a cell is turned inside out.
    #[inline(always)]
    fn determinants(&self) -> [f64; FOUR] {
        let [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] = self.deformation();
        (xx * (yy * zz - zy * yz) - xy * (yx * zz - zx * yz) + xz * (yx * zy - zx * yy)).0
    }

    /// Strain and turn of the four cells; none where one of them needs more than the series for small stretches, or is turned inside out.
    #[inline(always)]
    pub(crate) fn strains_and_turns(&self) -> Option<([Sym3; FOUR], FourTurns)> {
        let determinants = self.determinants();
        let square = stretch_square(&self.0);
        let [xx, yy, zz, xy, yz, zx] = square;
        let size = xx * xx + yy * yy + zz * zz + Lane::splat(2.0) * (xy * xy + yz * yz + zx * zx);
        let mut is_near = true;
        for k in 0..FOUR {
            is_near &= size.0[k] <= NEAR * NEAR && determinants[k] > 0.0;
        }
        if !is_near {
            return None;
        }
        let (strain, n) = roots(square);
        let mut strains = [Sym3::ZERO; FOUR];
        for k in 0..FOUR {
            for (value, of_all) in strains[k].0.iter_mut().zip(&strain) {
                *value = of_all.0[k];
            }
        }
        Some((strains, FourTurns { m: self.deformation(), n }))
    }
}

impl FourTurns {
    /// Stress on the nodes of each cell by columns: M (1 + n) σ.
    #[inline(always)]
    pub(crate) fn stress_columns(&self, stresses: &[Sym3; FOUR]) -> [[Lane; 3]; FOUR] {
        let stress = by_component(stresses);
        let more = product(self.n, stress);
        let mut whole = stress;
        for c in 0..6 {
            whole[c] = whole[c] + more[c];
        }
        let [xx, yy, zz, xy, yz, zx] = whole;
        let mut columns = [[Lane::ZERO; 3]; FOUR];
        for (column, [a, b, c]) in [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]].into_iter().enumerate() {
            for row in 0..3 {
                let [x, y, z] = self.m[row];
                let values = Lane::ZERO.plus_product(x, a).plus_product(y, b).plus_product(z, c);
                for k in 0..FOUR {
                    columns[k][column].0[row] = values.0[k];
                }
            }
        }
        columns
    }
}

#[cfg(test)]
mod tests {
    use fractum_math::{Mat3, Vec3, rotation_by};
    use proptest::prelude::*;

    use super::*;
    use crate::element::polar::strain_and_turn;

    proptest! {
        #[test]
        fn four_cells_have_the_bits_of_each_alone(
            turns in prop::array::uniform4(prop::array::uniform3(-2.0f64..2.0)),
            stretches in prop::array::uniform4(prop::array::uniform6(-1.0f64..1.0)),
            stresses in prop::array::uniform4(prop::array::uniform6(-1e6f64..1e6)),
            power in -9.0f64..-2.0,
        ) {
            let gradients: [Mat3; FOUR] = std::array::from_fn(|k| {
                let rotation = rotation_by(Vec3::from(turns[k])).to_rotation_matrix().into_inner();
                let strain = (Sym3(stretches[k]) * 10f64.powf(power)).to_matrix();
                rotation * (Mat3::identity() + strain) - Mat3::identity()
            });
            let column = |h: &Mat3, c: usize| Lane([h[(0, c)], h[(1, c)], h[(2, c)], 0.0]);
            let four = FourGradients::new(&gradients.map(|h| [0, 1, 2].map(|c| column(&h, c))));
            let determinants = four.determinants();
            let together = four.strains_and_turns();
            let alone = gradients.map(|h| strain_and_turn(&h));
            // The series of one that is stretched too far has no tensor n.
            prop_assert_eq!(together.is_some(), alone.iter().all(|(_, _, n)| *n != Sym3::ZERO));
            for (k, h) in gradients.iter().enumerate() {
                prop_assert_eq!(determinants[k], (Mat3::identity() + h).determinant());
            }
            let Some((strains, turns)) = together else { return Ok(()) };
            let columns = turns.stress_columns(&stresses.map(Sym3));
            for (k, (strain, m, n)) in alone.iter().enumerate() {
                prop_assert_eq!(strains[k], *strain);
                let stress = Sym3(stresses[k]);
                let whole = stress + Sym3(product(n.0, stress.0));
                let expected = m * whole.to_matrix();
                for c in 0..3 {
                    for r in 0..3 {
                        let error = columns[k][c].0[r] - expected[(r, c)];
                        prop_assert!(error.abs() <= 1e-15 * 4e6, "{k} {r} {c}: {error:e}");
                    }
                }
            }
        }
    }
}
