use fractum_fem::Solid;
use fractum_math::Vec3;

/// Radii of the discrete elements at the nodes: as large as possible without overlap of mesh neighbours [m].
///
/// Each starts at half the distance to its nearest neighbour in the reference configuration; then all grow together,
/// each by half of its smallest gap, until no room is left. The result does not depend on the order of anything.
pub fn largest_radii(solid: &Solid) -> Vec<f64> {
    let mut edges: Vec<[u32; 2]> = Vec::new();
    for body in 0..solid.body_count() {
        match solid.body_edges(body) {
            Some(own) => edges.extend(&own.nodes),
            None => edges.extend(solid.body(body).edges().nodes),
        }
    }
    grow(&solid.reference, &edges)
}

fn grow(nodes: &[Vec3], edges: &[[u32; 2]]) -> Vec<f64> {
    let length: Vec<f64> = edges.iter().map(|&[i, j]| (nodes[i as usize] - nodes[j as usize]).norm()).collect();
    let mut radius = vec![f64::INFINITY; nodes.len()];
    for (&[i, j], &l) in edges.iter().zip(&length) {
        for n in [i, j] {
            radius[n as usize] = radius[n as usize].min(0.5 * l);
        }
    }
    let mut gap = vec![0.0; nodes.len()];
    for _ in 0..30 {
        gap.fill(f64::INFINITY);
        for (&[i, j], &l) in edges.iter().zip(&length) {
            let room = l - radius[i as usize] - radius[j as usize];
            for n in [i, j] {
                gap[n as usize] = gap[n as usize].min(room);
            }
        }
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
        let radius = grow(&nodes, &edges);
        let room =
            |[i, j]: [u32; 2]| (nodes[i as usize] - nodes[j as usize]).norm() - radius[i as usize] - radius[j as usize];
        assert!(edges.iter().all(|&e| room(e) >= 0.0));
        for node in 0..4u32 {
            let tightest = edges.iter().filter(|e| e.contains(&node)).map(|&e| room(e)).fold(f64::INFINITY, f64::min);
            assert!(tightest < 1e-6, "node {node} has room {tightest}");
        }
    }
}
