//! Delaunay triangulation of points in the plane, point by point (Bowyer, *The Computer Journal* 24 (1981); Watson, *ibid.*).

/// No triangle.
const NONE: u32 = u32::MAX;

/// A triangle, counter-clockwise, and its neighbours opposite to each node.
#[derive(Clone, Copy)]
pub(crate) struct Triangle {
    pub(crate) nodes: [u32; 3],
    pub(crate) next: [u32; 3],
}

/// The triangles of some points. The last three nodes are those of a triangle around all points.
///
/// Points must be in no special position: no four on a circle, to the rounding of coordinates.
pub(crate) fn triangulate(points: &[[f64; 2]]) -> Vec<Triangle> {
    let count = points.len() as u32;
    let mut mesh = Growing {
        points: [points, &around(points)].concat(),
        triangles: vec![Triangle { nodes: [count, count + 1, count + 2], next: [NONE; 3] }],
        first: vec![NONE; points.len() + 3],
        seen: vec![NONE],
        last: 0,
    };
    (0..count).for_each(|point| mesh.insert(point));
    mesh.triangles
}

/// The triangle around some points.
pub(crate) fn around(points: &[[f64; 2]]) -> [[f64; 2]; 3] {
    let [low, high] = [f64::min, f64::max].map(|f| [0, 1].map(|axis| points.iter().map(|p| p[axis]).fold(f64::NAN, f)));
    let centre = [0, 1].map(|axis| f64::midpoint(low[axis], high[axis]));
    let far = 20.0 * (high[0] - low[0]).max(high[1] - low[1]);
    let corners = [[-1.0, -0.9], [1.1, -1.0], [0.1, 1.2]];
    corners.map(|corner| [centre[0] + far * corner[0], centre[1] + far * corner[1]])
}

struct Growing {
    points: Vec<[f64; 2]>,
    triangles: Vec<Triangle>,
    /// The new triangle whose outer edge begins at a node.
    first: Vec<u32>,
    /// The point for which a triangle was last looked at.
    seen: Vec<u32>,
    /// Where the next point is probably found.
    last: u32,
}

impl Growing {
    fn at(&self, node: u32) -> [f64; 2] {
        self.points[node as usize]
    }

    /// Twice the area of three nodes, the last of which is a place.
    fn area(&self, a: u32, b: u32, p: [f64; 2]) -> f64 {
        let [a, b] = [self.at(a), self.at(b)];
        (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
    }

    /// Whether a place lies in the circle of a triangle.
    fn is_in_circle(&self, triangle: u32, p: [f64; 2]) -> bool {
        let [a, b, c] = self.triangles[triangle as usize].nodes.map(|node| {
            let at = self.at(node);
            let [x, y] = [at[0] - p[0], at[1] - p[1]];
            [x, y, x * x + y * y]
        });
        let minor = |u: [f64; 3], v: [f64; 3]| u[0] * v[1] - v[0] * u[1];
        minor(b, c) * a[2] + minor(c, a) * b[2] + minor(a, b) * c[2] > 0.0
    }

    fn holder(&self, p: [f64; 2]) -> u32 {
        let mut triangle = self.last;
        'walk: loop {
            let Triangle { nodes, next } = self.triangles[triangle as usize];
            for (side, &next) in next.iter().enumerate() {
                if next != NONE && self.area(nodes[(side + 1) % 3], nodes[(side + 2) % 3], p) < 0.0 {
                    triangle = next;
                    continue 'walk;
                }
            }
            return triangle;
        }
    }

    fn insert(&mut self, point: u32) {
        let p = self.at(point);
        let mut cavity = vec![self.holder(p)];
        self.seen[cavity[0] as usize] = point;
        // Edges around the cavity with what lies beyond, in no order.
        let (mut rim, mut at) = (Vec::new(), 0);
        while at < cavity.len() {
            let triangle = cavity[at];
            at += 1;
            let Triangle { nodes, next } = self.triangles[triangle as usize];
            for side in 0..3 {
                let beyond = next[side];
                if beyond != NONE && self.seen[beyond as usize] == point {
                    continue;
                }
                if beyond != NONE && self.is_in_circle(beyond, p) {
                    self.seen[beyond as usize] = point;
                    cavity.push(beyond);
                } else {
                    rim.push(([nodes[(side + 1) % 3], nodes[(side + 2) % 3]], beyond));
                }
            }
        }
        let made: Vec<u32> = (0..rim.len()).map(|index| self.slot(cavity.get(index).copied())).collect();
        for (&([a, b], beyond), &new) in rim.iter().zip(&made) {
            self.triangles[new as usize] = Triangle { nodes: [a, b, point], next: [NONE, NONE, beyond] };
            self.first[a as usize] = new;
            if let Some(outer) = self.triangles.get_mut(beyond as usize) {
                let side = outer.nodes.iter().position(|&node| node != a && node != b);
                outer.next[side.unwrap_or(0)] = new;
            }
        }
        for (&([_, b], _), &new) in rim.iter().zip(&made) {
            let follows = self.first[b as usize];
            self.triangles[new as usize].next[0] = follows;
            self.triangles[follows as usize].next[1] = new;
        }
        self.last = made[0];
    }

    /// A place for a triangle: that of one which is gone, or a new one. A cavity has two triangles less than its rim has edges.
    fn slot(&mut self, gone: Option<u32>) -> u32 {
        gone.unwrap_or_else(|| {
            self.triangles.push(Triangle { nodes: [NONE; 3], next: [NONE; 3] });
            self.seen.push(NONE);
            self.triangles.len() as u32 - 1
        })
    }
}

/// Flips before an edge is given up, for each triangle that it crosses at first.
const MOST_FLIPS: usize = 10_000;

/// Makes an edge between two nodes by flips of the edges that it crosses (Sloan, *Adv. Eng. Software* 13 (1987)).
///
/// - `points`: with those of the triangle around them
/// - `kept`: whether an edge must stay
/// - returns false where an edge that must stay is in the way, or a node
pub(crate) fn recover(
    triangles: &mut [Triangle],
    points: &[[f64; 2]],
    [a, b]: [u32; 2],
    kept: &dyn Fn([u32; 2]) -> bool,
) -> bool {
    let at = |node: u32| points[node as usize];
    let turn = |a: u32, b: u32, c: u32| {
        let [a, b, c] = [a, b, c].map(at);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    let of_a: Vec<usize> = (0..triangles.len()).filter(|&t| triangles[t].nodes.contains(&a)).collect();
    if of_a.iter().any(|&t| triangles[t].nodes.contains(&b)) {
        return true;
    }
    let corner = |triangle: &Triangle, node: u32| triangle.nodes.iter().position(|&n| n == node).unwrap_or(0);
    let crossed = |triangle: &Triangle| {
        let [p, q] = [1, 2].map(|step| triangle.nodes[(corner(triangle, a) + step) % 3]);
        (turn(a, b, p) < 0.0 && turn(a, b, q) > 0.0).then_some([p, q])
    };
    let Some(mut first) = of_a.into_iter().find(|&t| crossed(&triangles[t]).is_some()) else { return false };
    for _ in 0..MOST_FLIPS {
        // From the first triangle on, the first edge on the way whose two triangles are convex together.
        let (mut here, mut side) = (first, corner(&triangles[first], a));
        let flipped = loop {
            let Triangle { nodes, next } = triangles[here];
            let [p, q] = [nodes[(side + 1) % 3], nodes[(side + 2) % 3]];
            let beyond = next[side] as usize;
            if kept([p, q]) || beyond >= triangles.len() {
                return false;
            }
            let other = triangles[beyond].next.iter().position(|&t| t as usize == here).unwrap_or(0);
            let (near, far) = (nodes[side], triangles[beyond].nodes[other]);
            let is_convex = turn(near, p, far) > 0.0 && turn(far, q, near) > 0.0;
            let still = |node: u32| node == a || node == b;
            let crosses = !still(near) && !still(far) && turn(a, b, near) * turn(a, b, far) < 0.0;
            if is_convex && (!crosses || far == b) {
                break Some((here, side, beyond, other));
            }
            if far == b {
                break None;
            }
            // On through the side of the triangle beyond that the edge crosses.
            let out = if turn(a, b, far) > 0.0 { q } else { p };
            side = corner(&triangles[beyond], out);
            here = beyond;
        };
        let Some((here, side, beyond, other)) = flipped else { return false };
        flip(triangles, [here, beyond], [side, other]);
        let has = |t: usize, node: u32| triangles[t].nodes.contains(&node);
        if [here, beyond].iter().any(|&t| has(t, a) && has(t, b)) {
            return true;
        }
        if let Some(&t) = [here, beyond].iter().find(|&&t| has(t, a) && crossed(&triangles[t]).is_some()) {
            first = t;
        }
    }
    false
}

/// Flips the edge between two triangles, which is opposite to these corners of them.
fn flip(triangles: &mut [Triangle], [here, beyond]: [usize; 2], [side, other]: [usize; 2]) {
    let (one, two) = (triangles[here], triangles[beyond]);
    let (near, p, q) = (one.nodes[side], one.nodes[(side + 1) % 3], one.nodes[(side + 2) % 3]);
    let far = two.nodes[other];
    // Counter-clockwise: near, p, q and far, q, p become near, p, far and near, far, q.
    let (beside_q, beside_p) = (one.next[(side + 1) % 3], one.next[(side + 2) % 3]);
    let (far_p, far_q) = (two.next[(other + 1) % 3], two.next[(other + 2) % 3]);
    triangles[here] = Triangle { nodes: [near, p, far], next: [far_p, beyond as u32, beside_p] };
    triangles[beyond] = Triangle { nodes: [near, far, q], next: [far_q, beside_q, here as u32] };
    let mut rename = |of: u32, from: usize, to: usize| {
        if let Some(triangle) = triangles.get_mut(of as usize)
            && let Some(side) = triangle.next.iter().position(|&t| t as usize == from)
        {
            triangle.next[side] = to as u32;
        }
    };
    rename(far_p, beyond, here);
    rename(beside_q, here, beyond);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::unit_interval;

    #[test]
    fn no_point_lies_in_the_circle_of_a_triangle() {
        let points: Vec<[f64; 2]> = (0..200).map(|i| [0, 1].map(|axis| unit_interval(3, 2 * i + axis))).collect();
        let triangles = triangulate(&points);
        // Euler: a triangle of three outer nodes with n inner ones has 2 n + 1 triangles.
        assert_eq!(triangles.len(), 2 * points.len() + 1);
        let mesh = Growing { points: points.clone(), triangles, first: Vec::new(), seen: Vec::new(), last: 0 };
        let inner = |t: &u32| mesh.triangles[*t as usize].nodes.iter().all(|&node| node < 200);
        for triangle in (0..mesh.triangles.len() as u32).filter(inner) {
            let nodes = mesh.triangles[triangle as usize].nodes;
            assert!(mesh.area(nodes[0], nodes[1], mesh.at(nodes[2])) > 0.0);
            let others = (0..200).filter(|node| !nodes.contains(node));
            assert!(others.into_iter().all(|node| !mesh.is_in_circle(triangle, mesh.at(node))));
        }
    }
}
