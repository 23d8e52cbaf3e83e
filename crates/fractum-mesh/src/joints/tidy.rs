//! Lines that came too near to each other as they were led around one another.

use super::pattern::{Pattern, Segment, foot, meeting};
use super::sheet::distance;

/// Over the size of elements: vertices that are nearer are one, and lines lead through vertices that are nearer.
const NEAR: f64 = 0.3;
/// Rounds, of which each may bring others together.
const ROUNDS: usize = 30;

/// Makes what is too near one, and what crosses meet.
pub(super) fn tidy(pattern: &mut Pattern<'_>) {
    for _ in 0..ROUNDS {
        let changed = contract(pattern) | cross(pattern) | bend(pattern);
        pattern.segments.retain(|segment| segment.ends[0] != segment.ends[1]);
        drop_doubles(pattern);
        if !changed {
            return;
        }
    }
}

fn used(pattern: &Pattern<'_>) -> Vec<u32> {
    let mut used: Vec<u32> = pattern.segments.iter().flat_map(|segment| segment.ends).collect();
    used.sort_unstable();
    used.dedup();
    used
}

/// Whether a vertex must stay: a node of the mesh, or on a side of it.
fn is_fixed(pattern: &Pattern<'_>) -> Vec<bool> {
    let mut fixed: Vec<bool> = pattern.node.iter().map(Option::is_some).collect();
    let sides = pattern.segments.iter().filter(|segment| segment.fixed.is_some());
    sides.flat_map(|segment| segment.ends).for_each(|end| fixed[end as usize] = true);
    fixed
}

/// Vertices that are near each other become one.
fn contract(pattern: &mut Pattern<'_>) -> bool {
    let (mut used, fixed) = (used(pattern), is_fixed(pattern));
    used.sort_by(|&a, &b| pattern.place(a)[0].total_cmp(&pattern.place(b)[0]));
    let size: Vec<f64> = used.iter().map(|&vertex| pattern.sheet.size_at(pattern.place(vertex))).collect();
    let mut name: Vec<u32> = (0..pattern.at.len() as u32).collect();
    let mut changed = false;
    for (index, &a) in used.iter().enumerate() {
        for &b in &used[index + 1..] {
            let near = NEAR * size[index];
            if pattern.place(b)[0] - pattern.place(a)[0] > near {
                break;
            }
            let is_one = name[a as usize] != a || name[b as usize] != b;
            if is_one || fixed[a as usize] && fixed[b as usize] || distance(pattern.place(a), pattern.place(b)) > near {
                continue;
            }
            let (stays, goes) = if fixed[b as usize] { (b, a) } else { (a, b) };
            name[goes as usize] = stays;
            changed = true;
        }
    }
    for segment in &mut pattern.segments {
        segment.ends = segment.ends.map(|end| name[end as usize]);
    }
    changed
}

/// Where two joints cross they get a vertex.
fn cross(pattern: &mut Pattern<'_>) -> bool {
    let mut order: Vec<usize> = (0..pattern.segments.len()).collect();
    let range = |pattern: &Pattern<'_>, segment: &Segment| {
        let [a, b] = segment.ends.map(|end| pattern.place(end)[0]);
        (a.min(b), a.max(b))
    };
    order.sort_by(|&a, &b| {
        let [a, b] = [a, b].map(|segment| range(pattern, &pattern.segments[segment]).0);
        a.total_cmp(&b)
    });
    let mut found: Vec<(usize, usize, [f64; 2])> = Vec::new();
    for (index, &one) in order.iter().enumerate() {
        let first = &pattern.segments[one];
        let end = range(pattern, first).1;
        for &two in &order[index + 1..] {
            let second = &pattern.segments[two];
            if range(pattern, second).0 > end {
                break;
            }
            let apart = first.ends.iter().all(|end| !second.ends.contains(end));
            if !apart || first.fixed.is_some() && second.fixed.is_some() {
                continue;
            }
            let lines = [first, second].map(|segment| segment.ends.map(|end| pattern.place(end)));
            if let Some((at, along, across)) = meeting(lines[0], lines[1])
                && along > 0.0
                && along < 1.0
                && across > 0.0
                && across < 1.0
            {
                found.push((one, two, at));
            }
        }
    }
    // One crossing of each segment at a time.
    let mut taken = vec![false; pattern.segments.len()];
    let changed = !found.is_empty();
    for (one, two, at) in found {
        if std::mem::replace(&mut taken[one], true) || std::mem::replace(&mut taken[two], true) {
            continue;
        }
        let middle = pattern.vertex(at, None);
        divide(pattern, one, middle);
        divide(pattern, two, middle);
    }
    changed
}

fn divide(pattern: &mut Pattern<'_>, segment: usize, middle: u32) {
    let Segment { ends: [first, last], fixed, joint } = pattern.segments[segment].clone();
    pattern.segments[segment].ends = [first, middle];
    pattern.segments.push(Segment { ends: [middle, last], fixed, joint });
}

/// Joints lead through vertices that they pass near by.
fn bend(pattern: &mut Pattern<'_>) -> bool {
    let mut used = used(pattern);
    used.sort_by(|&a, &b| pattern.place(a)[0].total_cmp(&pattern.place(b)[0]));
    let fixed = is_fixed(pattern);
    let mut changed = false;
    for number in 0..pattern.segments.len() {
        let segment = pattern.segments[number].clone();
        let line = segment.ends.map(|end| pattern.place(end));
        let middle = [0, 1].map(|axis| f64::midpoint(line[0][axis], line[1][axis]));
        let near = NEAR * pattern.sheet.size_at(middle);
        let [low, high] = [line[0][0].min(line[1][0]) - near, line[0][0].max(line[1][0]) + near];
        let from = used.partition_point(|&vertex| pattern.place(vertex)[0] < low);
        let beside = used[from..].iter().take_while(|&&vertex| pattern.place(vertex)[0] <= high).copied();
        let beside = beside.filter(|vertex| !segment.ends.contains(vertex)).filter_map(|vertex| {
            let (gap, foot, along) = foot(pattern.place(vertex), line);
            // By the elements there: those at the middle of a long line may be many times as large.
            let near = near.min(NEAR * pattern.sheet.size_at(pattern.place(vertex)));
            (gap < near && along > 0.0 && along < 1.0).then_some((gap, vertex, foot))
        });
        let Some((_, vertex, foot)) = beside.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
        if segment.fixed.is_some() {
            if fixed[vertex as usize] {
                continue;
            }
            // The side is as it is: the vertex goes onto it.
            pattern.shift = pattern.shift.max(distance(pattern.place(vertex), foot));
            pattern.at[vertex as usize] = foot;
        }
        divide(pattern, number, vertex);
        changed = true;
    }
    changed
}

/// Of two segments between the same vertices one stays: the side of the mesh, which then is a joint if it is inside of bodies.
fn drop_doubles(pattern: &mut Pattern<'_>) {
    let key = |segment: &Segment| {
        let [a, b] = segment.ends;
        ([a.min(b), a.max(b)], segment.fixed.is_none())
    };
    let mut order: Vec<usize> = (0..pattern.segments.len()).collect();
    order.sort_by_key(|&segment| key(&pattern.segments[segment]));
    let mut drop = vec![false; pattern.segments.len()];
    for pair in order.windows(2) {
        let [one, two] = [pair[0], pair[1]];
        if key(&pattern.segments[one]).0 != key(&pattern.segments[two]).0 {
            continue;
        }
        // The one that stays goes on in the place of the other, so that three are found too.
        let second = pattern.segments[two].clone();
        let first = pattern.segments[one].clone();
        let fixed = first.fixed.or(second.fixed);
        let inner = fixed.is_none_or(|side| pattern.is_inner(side));
        let joint = first.joint.or(second.joint).filter(|_| inner);
        let ends = if first.fixed.is_some() { first.ends } else { second.ends };
        drop[one] = true;
        pattern.segments[two] = Segment { ends, fixed, joint };
    }
    let mut keep = drop.iter();
    pattern.segments.retain(|_| keep.next() == Some(&false));
}
