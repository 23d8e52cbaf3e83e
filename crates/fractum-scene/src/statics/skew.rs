//! Linear solutions with stiffnesses that are not symmetric: those of what rubs, and of mixed modes.

use fractum_math::Vec3;
use fractum_sparse::SparseError;

use super::contact::Spring;
use super::linear_system::LinearSystem;

/// Directions among which the solution is looked for.
const MOST: usize = 40;
/// Residual over that of no solution at which the search ends.
const TOLERANCE: f64 = 1e-8;

/// Solves (A + N) x = b, with the matrix A of the system and what the springs have beside it: generalised minimal residuals, after A⁻¹
/// (Saad and Schultz 1986).
///
/// # Errors
/// As [`LinearSystem::solve`].
pub(super) fn solve(
    system: &mut LinearSystem,
    springs: &[Spring],
    right: &[Vec3],
    solution: &mut [Vec3],
) -> Result<(), SparseError> {
    system.solve(right, solution)?;
    let whole = norm(solution);
    if whole == 0.0 || springs.iter().all(|spring| spring.rest.is_none()) {
        return Ok(());
    }
    let mut basis = vec![solution.iter().map(|v| v / whole).collect::<Vec<Vec3>>()];
    // Columns of the triangle that rotations make of the projected operator, and what they make of the right-hand side.
    let (mut columns, mut rotations, mut shares): (Vec<Vec<f64>>, Vec<[f64; 2]>, _) =
        (Vec::new(), Vec::new(), vec![whole]);
    let mut forces = vec![Vec3::zeros(); right.len()];
    for place in 0..MOST {
        if shares[place].abs() <= TOLERANCE * whole {
            break;
        }
        forces.fill(Vec3::zeros());
        for spring in springs {
            if let Some(rest) = &spring.rest {
                spring.push(rest * spring.of(&basis[place]), &mut forces);
            }
        }
        let mut next = vec![Vec3::zeros(); right.len()];
        system.solve(&forces, &mut next)?;
        next.iter_mut().zip(&basis[place]).for_each(|(next, last)| *next += last);
        let mut column = Vec::with_capacity(place + 1);
        for direction in &basis {
            let part: f64 = next.iter().zip(direction).map(|(a, b)| a.dot(b)).sum();
            next.iter_mut().zip(direction).for_each(|(next, direction)| *next -= direction * part);
            column.push(part);
        }
        for (i, [c, s]) in rotations.iter().enumerate() {
            [column[i], column[i + 1]] = [c * column[i] + s * column[i + 1], c * column[i + 1] - s * column[i]];
        }
        let left = norm(&next);
        let size = (column[place] * column[place] + left * left).sqrt();
        if size == 0.0 {
            break;
        }
        let [c, s] = [column[place] / size, left / size];
        column[place] = size;
        columns.push(column);
        rotations.push([c, s]);
        shares.push(-s * shares[place]);
        shares[place] *= c;
        if left == 0.0 {
            break;
        }
        next.iter_mut().for_each(|v| *v /= left);
        basis.push(next);
    }
    for row in (0..columns.len()).rev() {
        let known: f64 = (row + 1..columns.len()).map(|k| columns[k][row] * shares[k]).sum();
        shares[row] = (shares[row] - known) / columns[row][row];
    }
    solution.fill(Vec3::zeros());
    for (direction, share) in basis.iter().zip(&shares[..columns.len()]) {
        solution.iter_mut().zip(direction).for_each(|(x, direction)| *x += direction * *share);
    }
    Ok(())
}

fn norm(field: &[Vec3]) -> f64 {
    field.iter().map(Vec3::norm_squared).sum::<f64>().sqrt()
}
