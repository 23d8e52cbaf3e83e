use fractum_fem::{Solid, neighbours};
use fractum_math::Vec3;

/// Radii of the discrete elements at the nodes: as large as possible without overlap of mesh neighbours [m].
///
/// Each starts at half the distance to its nearest neighbour in the reference configuration; then all grow together,
/// each by half of its smallest gap, until no room is left. The result does not depend on the order of anything. Ranks of which none has
/// all elements must all call it.
pub fn largest_radii(solid: &Solid) -> Vec<f64> {
    let edges: Vec<[u32; 2]> = (0..solid.body_count()).flat_map(|body| neighbours::owned_edges(solid, body)).collect();
    let Some(mut shared) = neighbours::shared_nodes(solid) else { return grow(&solid.reference, &edges, |_| ()) };
    let mut radius = grow(&solid.reference, &edges, |values| shared.take_least(values));
    shared.gather(&mut radius);
    radius
}

/// - `take_least`: takes into account, at every node, what edges of other ranks leave
fn grow(nodes: &[Vec3], edges: &[[u32; 2]], mut take_least: impl FnMut(&mut [f64])) -> Vec<f64> {
    let length: Vec<f64> = edges.iter().map(|&[i, j]| (nodes[i as usize] - nodes[j as usize]).norm()).collect();
    let mut radius = vec![f64::INFINITY; nodes.len()];
    for (&[i, j], &l) in edges.iter().zip(&length) {
        for n in [i, j] {
            radius[n as usize] = radius[n as usize].min(0.5 * l);
        }
    }
    take_least(&mut radius);
    let mut gap = vec![0.0; nodes.len()];
    for _ in 0..30 {
        gap.fill(f64::INFINITY);
        for (&[i, j], &l) in edges.iter().zip(&length) {
            let room = l - radius[i as usize] - radius[j as usize];
            for n in [i, j] {
                gap[n as usize] = gap[n as usize].min(room);
            }
        }
        take_least(&mut gap);
        for (r, gap) in radius.iter_mut().zip(&gap) {
            // The last bit of room stays: rounding must not make neighbours overlap.
            *r += 0.5 * (gap - 1e-14 * *r).max(0.0);
        }
    }
    radius
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_never_overlap_and_nobody_could_grow() {
        let nodes: Vec<Vec3> = [0.0, 1.0, 1.4, 3.0].iter().map(|&x| Vec3::x() * x).collect();
        let edges = [[0, 1], [1, 2], [2, 3]];
        let radius = grow(&nodes, &edges, |_| ());
        let room =
            |[i, j]: [u32; 2]| (nodes[i as usize] - nodes[j as usize]).norm() - radius[i as usize] - radius[j as usize];
        assert!(edges.iter().all(|&e| room(e) >= 0.0));
        for node in 0..4u32 {
            let tightest = edges.iter().filter(|e| e.contains(&node)).map(|&e| room(e)).fold(f64::INFINITY, f64::min);
            assert!(tightest < 1e-6, "node {node} has room {tightest}");
        }
    }
}
