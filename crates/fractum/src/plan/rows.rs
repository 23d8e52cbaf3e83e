//! Rows of a mesh: how many edges have common directions, which cracks of local damage like to follow.

use fractum_fem::{Body, ElementKind, Region};
use fractum_math::Vec3;

/// Edges within this angle of a direction belong to it: 5 degrees.
const COSINE: f64 = 0.996_194_698_091_745_5;

/// Edges looked at, and directions tried among them: a share is wanted to a few per cent.
const LOOKED_AT: usize = 5_000;
const TRIED: usize = 400;

/// Share of edges in common directions from which cracks may follow them. Meshes of the gallery made by rows have 0.54 or more,
/// irregular ones 0.31 or less; edges of any direction alike would have 0.17 in the plane and 0.03 in space.
pub(super) const MANY: f64 = 0.4;

/// Common directions that are looked for: those of rows of equilateral triangles, and of boxes cut into six tetrahedra.
pub(super) fn directions(shape: ElementKind) -> usize {
    match shape {
        ElementKind::T3 => 3,
        ElementKind::T4 => 7,
    }
}

/// Share of the edges that may be damaged that lie within 5 degrees of the most common directions of the mesh [-].
pub(super) fn share(body: &Body, nodes: &[Vec3]) -> f64 {
    let open = |edge: usize| match body.damage.as_ref().map(|zone| &zone.region) {
        Some(Region::Edges(marked)) => marked.get(edge).is_some_and(|&marked| marked),
        _ => true,
    };
    let mut armed: Vec<[u32; 2]> = Vec::new();
    let mut edge = 0;
    body.each_edge(nodes.len(), |ends| {
        armed.extend(open(edge).then_some(ends));
        edge += 1;
    });
    let every = armed.len().div_ceil(LOOKED_AT).max(1);
    let direction = |[i, j]: &[u32; 2]| (nodes[*j as usize] - nodes[*i as usize]).normalize();
    let all: Vec<Vec3> = armed.iter().step_by(every).map(direction).collect();
    in_common(&all, directions(body.shape))
}

/// Share of directions that lie around the most common one, the most common one among the others, and so on.
fn in_common(all: &[Vec3], count: usize) -> f64 {
    let near = |a: &Vec3, b: &Vec3| a.dot(b).abs() > COSINE;
    let mut left: Vec<Vec3> = all.to_vec();
    for _ in 0..count {
        let every = left.len().div_ceil(TRIED).max(1);
        let around = |tried: &&Vec3| left.iter().filter(|other| near(tried, other)).count();
        let Some(most) = left.iter().step_by(every).max_by_key(around).copied() else { break };
        left.retain(|other| !near(&most, other));
    }
    if all.is_empty() { 0.0 } else { 1.0 - left.len() as f64 / all.len() as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fractum_math::elementary::{cos, sin};

    #[test]
    fn lines_at_sixty_degrees_are_rows_and_a_fan_is_none() {
        let at = |degrees: f64| Vec3::new(cos(degrees.to_radians()), sin(degrees.to_radians()), 0.0);
        let lines: Vec<Vec3> = (0..300).map(|k| at(7.0 + 60.0 * f64::from(k % 3) + 180.0 * f64::from(k % 2))).collect();
        assert_eq!(in_common(&lines, 3), 1.0);
        let fan: Vec<Vec3> = (0..3600).map(|k| at(0.1 * f64::from(k))).collect();
        assert!((in_common(&fan, 3) - 1.0 / 6.0).abs() < 0.01, "{}", in_common(&fan, 3));
        assert_eq!(in_common(&[], 3), 0.0);
    }
}
