//! Linear solutions with stiffnesses that are not symmetric: those of what rubs, and of mixed modes.

use fractum_math::Vec3;
use fractum_sparse::SparseError;

use super::contact::Spring;
use super::linear_system::LinearSystem;

/// Directions among which the forces are looked for.
const MOST: usize = 100;
/// Forces that are missing over those of the symmetric solution at which the search ends.
const TOLERANCE: f64 = 1e-7;

/// Solves (A + Bᵀ R B) x = b, with the matrix A of the system and what the springs have beside it, R of their lengths B x. Their forces f = R B x
/// follow from (1 + R B A⁻¹ Bᵀ) f = R B A⁻¹ b by generalised minimal residuals (Saad and Schultz 1986): what is missing is missing in forces, so that
/// springs that are much stiffer than all else are as exact.
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
    let forces_of = |field: &[Vec3]| -> Vec<Vec3> {
        springs.iter().filter_map(|spring| Some(spring.rest? * spring.of(field))).collect()
    };
    let first = forces_of(solution);
    let whole = norm(&first);
    if whole == 0.0 {
        return Ok(());
    }
    let mut pushed = vec![Vec3::zeros(); right.len()];
    let mut moved = vec![Vec3::zeros(); right.len()];
    let mut respond = |forces: &[Vec3], moved: &mut [Vec3]| {
        pushed.fill(Vec3::zeros());
        let rests = springs.iter().filter(|spring| spring.rest.is_some());
        rests.zip(forces).for_each(|(spring, force)| spring.push(*force, &mut pushed));
        system.solve(&pushed, moved)
    };
    let mut basis = vec![first.iter().map(|v| v / whole).collect::<Vec<Vec3>>()];
    // Columns of the triangle that rotations make of the projected operator, and what they make of the right-hand side.
    let (mut columns, mut rotations, mut shares): (Vec<Vec<f64>>, Vec<[f64; 2]>, _) =
        (Vec::new(), Vec::new(), vec![whole]);
    for place in 0..MOST {
        if shares[place].abs() <= TOLERANCE * whole {
            break;
        }
        respond(&basis[place], &mut moved)?;
        let mut next = forces_of(&moved);
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
    let mut forces = vec![Vec3::zeros(); first.len()];
    for (direction, share) in basis.iter().zip(&shares[..columns.len()]) {
        forces.iter_mut().zip(direction).for_each(|(force, direction)| *force += direction * *share);
    }
    respond(&forces, &mut moved)?;
    solution.iter_mut().zip(&moved).for_each(|(x, moved)| *x -= moved);
    Ok(())
}

fn norm(field: &[Vec3]) -> f64 {
    field.iter().map(Vec3::norm_squared).sum::<f64>().sqrt()
}
