//! Lines that a mesh is to have: those that it has, and joints, which end and cross at common vertices.

use super::Trace;
use super::sheet::{Sheet, cross, distance};

/// Over the size of elements: what is nearer is one.
const NEAR: f64 = 0.4;
/// How far a node of a straight side slides to where a joint meets the side, over the length of the side.
const SLIDE: f64 = 0.5;
/// How much nearer to a straight side that it does not cross a joint may pass.
const BESIDE_SIDE: f64 = 0.5;
/// Vertices on the way of a joint before it is given up.
const MOST_VERTICES: usize = 10_000;

/// A line between two vertices.
#[derive(Clone, Debug)]
pub(super) struct Segment {
    pub(super) ends: [u32; 2],
    /// The side of the mesh that it is a part of.
    pub(super) fixed: Option<u32>,
    /// The joint that it is a part of.
    pub(super) joint: Option<u32>,
}

/// What became of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fate {
    /// It is in the mesh, with this length.
    Cut(f64),
    /// No part of it is where joints may be.
    Outside,
    /// It is not as long as an element there.
    Short {
        /// Its length.
        length: f64,
        /// That of an edge.
        edge: f64,
    },
    /// No triangles fill the mesh around it, near this place.
    Unfilled([f64; 2]),
    /// It meets another one, or the surface, at an angle that is too small for elements between them.
    Sharp {
        /// The other joint; none for a side of the body.
        other: Option<u32>,
        /// Their angle [rad].
        angle: f64,
        /// Where.
        at: [f64; 2],
    },
}

/// The lines of a mesh.
pub(super) struct Pattern<'a> {
    pub(super) sheet: &'a Sheet,
    pub(super) at: Vec<[f64; 2]>,
    /// The node of the mesh that a vertex is.
    pub(super) node: Vec<Option<u32>>,
    pub(super) segments: Vec<Segment>,
    /// Segments at each vertex.
    around: Vec<Vec<u32>>,
    /// Direction and group of each joint.
    joints: Vec<([f64; 2], u32)>,
    /// Whether a free end of a joint goes on to another one near by, or that one goes through the end.
    ends_move: bool,
    /// Largest distance by which an end or a vertex has moved.
    pub(super) shift: f64,
}

impl<'a> Pattern<'a> {
    /// - `ends_move`: whether a free end of a line goes on to another one near by, or that one goes through the end
    pub(super) fn new(sheet: &'a Sheet, ends_move: bool) -> Self {
        let mut pattern = Pattern {
            sheet,
            at: Vec::new(),
            node: Vec::new(),
            segments: Vec::new(),
            around: Vec::new(),
            joints: Vec::new(),
            ends_move,
            shift: 0.0,
        };
        let mut vertex = vec![u32::MAX; sheet.at.len()];
        let mut of = |pattern: &mut Pattern, node: u32| {
            if vertex[node as usize] == u32::MAX {
                vertex[node as usize] = pattern.vertex(sheet.at[node as usize], Some(node));
            }
            vertex[node as usize]
        };
        for (number, side) in (0..).zip(&sheet.fixed) {
            let ends = side.nodes.map(|node| of(&mut pattern, node));
            pattern.segment(Segment { ends, fixed: Some(number), joint: None });
        }
        for node in (0..sheet.at.len() as u32).filter(|&node| sheet.held[node as usize]) {
            of(&mut pattern, node);
        }
        pattern
    }

    pub(super) fn vertex(&mut self, at: [f64; 2], node: Option<u32>) -> u32 {
        self.at.push(at);
        self.node.push(node);
        self.around.push(Vec::new());
        self.at.len() as u32 - 1
    }

    fn segment(&mut self, segment: Segment) {
        let number = self.segments.len() as u32;
        segment.ends.iter().for_each(|&end| self.around[end as usize].push(number));
        self.segments.push(segment);
    }

    pub(super) fn place(&self, vertex: u32) -> [f64; 2] {
        self.at[vertex as usize]
    }

    /// Whether a side of the mesh has elements on both sides.
    pub(super) fn is_inner(&self, side: u32) -> bool {
        self.sheet.fixed[side as usize].triangles[1] != crate::topology::NO_ELEMENT
    }

    fn places(&self, segment: &Segment) -> [[f64; 2]; 2] {
        segment.ends.map(|end| self.place(end))
    }

    /// Divides a segment at a place; gives the vertex there.
    fn split(&mut self, number: u32, at: [f64; 2]) -> u32 {
        let middle = self.vertex(at, None);
        let Segment { ends: [first, last], fixed, joint } = self.segments[number as usize].clone();
        self.segments[number as usize].ends = [first, middle];
        self.around[last as usize].retain(|&other| other != number);
        self.around[middle as usize].push(number);
        self.segment(Segment { ends: [middle, last], fixed, joint });
        middle
    }

    /// Adds a joint, the next by number, unless it meets others at less than the least angle [rad]; the part of it that lies in a rectangle around the body.
    pub(super) fn add(&mut self, trace: &Trace, bounds: [[f64; 2]; 2], least: f64) -> Fate {
        let Some(ends) = clipped(trace.ends, bounds) else { return self.none(Fate::Outside) };
        let (length, edge) = (distance(ends[0], ends[1]), self.sheet.size_at(ends[0]).min(self.sheet.size_at(ends[1])));
        if length < edge {
            return self.none(Fate::Short { length, edge });
        }
        if let Some(fate) = self.sharp(ends, trace.group, least) {
            return self.none(fate);
        }
        let joint = self.lead(ends, trace.group);
        match self.length(joint) {
            length if length > 0.0 => Fate::Cut(length),
            _ => Fate::Outside,
        }
    }

    /// A joint of which nothing is there.
    pub(super) fn none(&mut self, fate: Fate) -> Fate {
        self.joints.push(([0.0; 2], 0));
        fate
    }

    /// Length of a joint.
    fn length(&self, joint: u32) -> f64 {
        let own = self.segments.iter().filter(|segment| segment.joint == Some(joint));
        own.map(|segment| self.places(segment)).map(|[a, b]| distance(a, b)).sum()
    }

    /// Adds a line of a group, whatever it meets; gives its number.
    pub(super) fn lead(&mut self, ends: [[f64; 2]; 2], group: u32) -> u32 {
        let [a, b] = [self.end(ends[0], ends[1]), self.end(ends[1], ends[0])];
        let direction = [ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]];
        let joint = self.joints.len() as u32;
        self.joints.push((direction, group));
        self.route([a, b], joint, &mut vec![a, b]);
        joint
    }

    /// Largest angle by which a part of a joint is turned [rad].
    pub(super) fn turn(&self) -> f64 {
        let of = |segment: &Segment| {
            let [a, b] = self.places(segment);
            let along = [b[0] - a[0], b[1] - a[1]];
            // A part that is shorter than an element has no direction to tell of.
            if distance(a, b) < 1.5 * self.sheet.size_at(a) {
                return None;
            }
            let (own, _) = self.joints[segment.joint? as usize];
            let (sine, cosine) = (own[0] * along[1] - own[1] * along[0], own[0] * along[0] + own[1] * along[1]);
            Some(fractum_math::elementary::atan2(sine.abs(), cosine.abs()))
        };
        self.segments.iter().filter_map(of).fold(0.0, f64::max)
    }

    /// Whether a joint meets another one at less than an angle.
    fn sharp(&self, ends: [[f64; 2]; 2], group: u32, least: f64) -> Option<Fate> {
        let [a, b] = ends;
        let length = distance(a, b);
        for segment in &self.segments {
            let [p, q] = self.places(segment);
            let own = distance(p, q);
            let sine = ((b[0] - a[0]) * (q[1] - p[1]) - (b[1] - a[1]) * (q[0] - p[0])).abs() / (length * own);
            if sine >= fractum_math::elementary::sin(least) {
                continue;
            }
            let (gap, at) = apart([a, b], [p, q]);
            let near = NEAR * self.sheet.size_at(at);
            if gap < near && !goes_on([a, b], [p, q], near) && self.sheet.is_allowed(group, at) {
                return Some(Fate::Sharp {
                    other: segment.joint,
                    angle: fractum_math::elementary::asin(sine.min(1.0)),
                    at,
                });
            }
        }
        None
    }

    /// The vertex at an end of a joint that comes from elsewhere.
    fn end(&mut self, at: [f64; 2], from: [f64; 2]) -> u32 {
        let near = NEAR * self.sheet.size_at(at);
        let used = |&vertex: &usize| !self.around[vertex].is_empty() || self.node[vertex].is_some();
        let nearest = (0..self.at.len()).filter(used).map(|vertex| (distance(self.at[vertex], at), vertex));
        if let Some((far, vertex)) = nearest.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(far, _)| *far < near) {
            self.shift = self.shift.max(far);
            return vertex as u32;
        }
        let beside = |segment: &Segment| {
            let [p, q] = self.places(segment);
            let (gap, foot, _) = foot(at, [p, q]);
            (gap, foot, [p, q])
        };
        let segments = (0u32..).zip(&self.segments).map(|(number, segment)| (number, beside(segment)));
        let closest = segments.min_by(|a, b| a.1.0.total_cmp(&b.1.0));
        if let Some((number, (gap, foot, line))) = closest
            && gap < near
        {
            // Where the way of the joint itself meets the line, if that is near by.
            let own = meeting([from, at], line).filter(|&(_, along, at_line)| {
                along * distance(from, at) - distance(from, at) < 2.0 * near && (0.0..1.0).contains(&at_line)
            });
            let to = own.map_or(foot, |(place, _, _)| place);
            self.shift = self.shift.max(distance(to, at));
            if let Some(vertex) = line_end(to, line, near) {
                return self.segments[number as usize].ends[vertex];
            }
            return self.split(number, to);
        }
        self.vertex(at, None)
    }

    /// Leads a joint from vertex to vertex around what is near to its way and through what crosses it.
    ///
    /// - `passed`: the vertices of the way, each of which it has once
    fn route(&mut self, [a, b]: [u32; 2], joint: u32, passed: &mut Vec<u32>) {
        if a == b || passed.len() > MOST_VERTICES {
            return;
        }
        let through = self.beside([a, b], passed).or_else(|| {
            let (segment, at) = self.crossed([a, b])?;
            Some(self.split(segment, at))
        });
        if let Some(vertex) = through {
            passed.push(vertex);
            self.route([a, vertex], joint, passed);
            self.route([vertex, b], joint, passed);
            return;
        }
        let [p, q] = [a, b].map(|end| self.place(end));
        let known = self.around[a as usize].iter().copied().find(|&s| self.segments[s as usize].ends.contains(&b));
        if let Some(known) = known {
            let inner = self.segments[known as usize].fixed.is_none_or(|side| self.is_inner(side));
            if inner {
                self.segments[known as usize].joint.get_or_insert(joint);
            }
            return;
        }
        let middle = [0, 1].map(|axis| f64::midpoint(p[axis], q[axis]));
        if self.sheet.is_allowed(self.joints[joint as usize].1, middle) {
            self.segment(Segment { ends: [a, b], fixed: None, joint: Some(joint) });
        }
    }

    /// The vertex through which a way between two others leads, moved onto it where it is free to; none if it goes straight on.
    fn beside(&mut self, [a, b]: [u32; 2], passed: &[u32]) -> Option<u32> {
        let [p, q] = [a, b].map(|end| self.place(end));
        let mut best: Option<(f64, u32, [f64; 2])> = None;
        for vertex in (0..self.at.len() as u32).filter(|vertex| !passed.contains(vertex)) {
            let at = self.place(vertex);
            if self.around[vertex as usize].is_empty() && self.node[vertex as usize].is_none() {
                continue;
            }
            let (gap, _, along) = foot(at, [p, q]);
            if along <= 0.0 || along >= 1.0 {
                continue;
            }
            let Some(to) = self.way_through(vertex, gap, [p, q]) else { continue };
            if best.is_none_or(|(least, ..)| gap < least) {
                best = Some((gap, vertex, to));
            }
        }
        let (_, vertex, to) = best?;
        self.shift = self.shift.max(distance(self.place(vertex), to));
        self.at[vertex as usize] = to;
        Some(vertex)
    }

    /// Where a vertex is if a way leads through it; none if that passes it by.
    fn way_through(&self, vertex: u32, gap: f64, way: [[f64; 2]; 2]) -> Option<[f64; 2]> {
        let (at, around) = (self.place(vertex), &self.around[vertex as usize]);
        let mut near = NEAR * self.sheet.size_at(at);
        if let Some(line) = self.slides(vertex) {
            let shorter = distance(at, line[0]).min(distance(at, line[1]));
            let meets = meeting(way, line).filter(|&(_, along, _)| along > 0.0 && along < 1.0);
            if let Some((to, ..)) = meets.filter(|(to, ..)| distance(*to, at) <= SLIDE * shorter) {
                return Some(to);
            }
            near *= BESIDE_SIDE;
        }
        if gap >= near {
            return None;
        }
        let is_free_end = self.ends_move && around.len() == 1 && self.segments[around[0] as usize].fixed.is_none();
        if !is_free_end || self.node[vertex as usize].is_some() {
            return Some(at);
        }
        let [first, last] = self.segments[around[0] as usize].ends;
        let other = self.place(if first == vertex { last } else { first });
        // Along its own way, or where it is.
        let own = meeting([other, at], way).filter(|&(_, _, along)| along > 0.0 && along < 1.0);
        Some(own.map(|(place, _, _)| place).filter(|&place| distance(place, at) < 2.0 * near).unwrap_or(at))
    }

    /// The straight side that a node may slide along.
    fn slides(&self, vertex: u32) -> Option<[[f64; 2]; 2]> {
        let node = self.node[vertex as usize]?;
        let &[first, second] = self.around[vertex as usize].as_slice() else { return None };
        let at = self.place(vertex);
        let (one, two) = (&self.segments[first as usize], &self.segments[second as usize]);
        let sides = [one.fixed?, two.fixed?].map(|side| &self.sheet.fixed[side as usize]);
        let far = |segment: &Segment| self.place(segment.ends[usize::from(segment.ends[0] == vertex)]);
        let line = [far(one), far(two)];
        let bend = cross(line[0], at, line[1]).abs() / (distance(line[0], at) * distance(line[1], at));
        let moved = self.sheet.held[node as usize] || self.sheet.at[node as usize] != at;
        (!moved && bend < 1e-6 && sides[0].lines.is_empty() == sides[1].lines.is_empty()).then_some(line)
    }

    /// The first segment that a way crosses, and where.
    fn crossed(&self, [a, b]: [u32; 2]) -> Option<(u32, [f64; 2])> {
        let way = [a, b].map(|end| self.place(end));
        let apart = |segment: &Segment| !segment.ends.contains(&a) && !segment.ends.contains(&b);
        let meets = |(number, segment): (u32, &Segment)| {
            let (at, along, across) = meeting(way, self.places(segment))?;
            (along > 0.0 && along < 1.0 && across > 0.0 && across < 1.0).then_some((along, number, at))
        };
        let all = (0..).zip(&self.segments).filter(|(_, segment)| apart(segment)).filter_map(meets);
        all.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, number, at)| (number, at))
    }
}

/// Whether two lines lead away from a common end in opposite directions.
fn goes_on([a, b]: [[f64; 2]; 2], [p, q]: [[f64; 2]; 2], near: f64) -> bool {
    let ends = [(a, b, p, q), (a, b, q, p), (b, a, p, q), (b, a, q, p)];
    ends.into_iter().any(|(one, far, two, other)| {
        let away = (far[0] - one[0]) * (other[0] - two[0]) + (far[1] - one[1]) * (other[1] - two[1]);
        distance(one, two) < near && away < 0.0
    })
}

/// The end of a line that a place on it is near to.
fn line_end(at: [f64; 2], line: [[f64; 2]; 2], near: f64) -> Option<usize> {
    (0..2).find(|&end| distance(at, line[end]) < near)
}

/// Distance of a place from a line between two others, the nearest place of it, and the share of the line there.
pub(super) fn foot(at: [f64; 2], [p, q]: [[f64; 2]; 2]) -> (f64, [f64; 2], f64) {
    let [x, y] = [q[0] - p[0], q[1] - p[1]];
    let along = ((at[0] - p[0]) * x + (at[1] - p[1]) * y) / (x * x + y * y);
    let clamped = along.clamp(0.0, 1.0);
    let foot = [p[0] + clamped * x, p[1] + clamped * y];
    (distance(at, foot), foot, along)
}

/// Where two lines meet, if they are not parallel, and the shares of both there.
pub(super) fn meeting([a, b]: [[f64; 2]; 2], [p, q]: [[f64; 2]; 2]) -> Option<([f64; 2], f64, f64)> {
    let ([ux, uy], [vx, vy]) = ([b[0] - a[0], b[1] - a[1]], [q[0] - p[0], q[1] - p[1]]);
    let below = ux * vy - uy * vx;
    if below == 0.0 {
        return None;
    }
    let [wx, wy] = [p[0] - a[0], p[1] - a[1]];
    let (along, across) = ((wx * vy - wy * vx) / below, (wx * uy - wy * ux) / below);
    Some(([a[0] + along * ux, a[1] + along * uy], along, across))
}

/// The part of a line in a rectangle (Liang and Barsky, *ACM Trans. Graphics* 3 (1984)).
pub(super) fn clipped([a, b]: [[f64; 2]; 2], [low, high]: [[f64; 2]; 2]) -> Option<[[f64; 2]; 2]> {
    let (mut from, mut to) = (0.0f64, 1.0f64);
    for axis in 0..2 {
        let along = b[axis] - a[axis];
        let shares = [low[axis], high[axis]].map(|limit| (limit - a[axis]) / along);
        if along == 0.0 {
            if a[axis] < low[axis] || a[axis] > high[axis] {
                return None;
            }
            continue;
        }
        from = from.max(shares[0].min(shares[1]));
        to = to.min(shares[0].max(shares[1]));
    }
    let at = |share: f64| [0, 1].map(|axis| a[axis] + share * (b[axis] - a[axis]));
    (from < to).then(|| [if from == 0.0 { a } else { at(from) }, if to == 1.0 { b } else { at(to) }])
}

/// Distance of two lines, and where they are nearest.
fn apart(one: [[f64; 2]; 2], two: [[f64; 2]; 2]) -> (f64, [f64; 2]) {
    if let Some((at, along, across)) = meeting(one, two)
        && (0.0..=1.0).contains(&along)
        && (0.0..=1.0).contains(&across)
    {
        return (0.0, at);
    }
    let ends = one.iter().map(|&at| (foot(at, two).0, at)).chain(two.iter().map(|&at| (foot(at, one).0, at)));
    ends.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, one[0]))
}
