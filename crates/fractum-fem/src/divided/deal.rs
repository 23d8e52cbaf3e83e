//! Elements on their way from the ranks that have read them to those whose cells they are part of.

use fractum_math::Vec3;
use fractum_mesh::renumber::HilbertCurve;
use fractum_mesh::topology::TETRAHEDRON_EDGES;
use fractum_parallel::{Exchange, gather, post};
use rayon::prelude::*;

use super::order::{Key, Order};
use super::{BodyShare, KnownAround, ReadBody, Replication};
use crate::body::Formulation;

/// Words of an element on its way.
const WORDS: usize = 7;
/// Those of an element.
type Words = [u64; WORDS];
/// Elements that are packed at a time.
const PACKED: usize = 1 << 16;

/// Deals the elements that all ranks have read out to those that need them. All ranks must call it, with the same bodies in the same order.
///
/// - `nodes`: positions of all nodes [m]
/// - `bodies`: the whole body has the elements of rank 0 first, then those of rank 1 and so on
///
/// # Panics
/// If a body has more elements than have a number of 32 bits.
pub fn deal(exchange: &dyn Exchange, nodes: &[Vec3], bodies: &[ReadBody], around: KnownAround) -> Vec<BodyShare> {
    let counts = gather(exchange, &bodies.iter().map(|body| body.elements.len()).collect::<Vec<_>>());
    let total = |body: usize| counts.iter().map(|counts| counts[body]).sum::<usize>();
    let first: Vec<usize> =
        (0..bodies.len()).map(|body| counts[..exchange.rank()].iter().map(|counts| counts[body]).sum()).collect();
    let cells: Vec<Cells> = curves(exchange, nodes, bodies)
        .into_iter()
        .enumerate()
        .map(|(index, curve)| Cells { body: &bodies[index], index, first: first[index], curve, nodes })
        .collect();
    let named: Vec<Key> = cells.par_iter().flat_map_iter(|cells| cells.keys()).collect();
    let order = Order::new(exchange, named, 2 * bodies.len());
    let mut is_near = nodes_of_whole(exchange, bodies, nodes.len());
    around.touched.iter().chain(around.measured).for_each(|&node| is_near[node as usize] = true);
    let none = || vec![Vec::new(); exchange.size()];
    let mut words = OnTheirWay { to: none(), to_all: Vec::new(), owned: none() };
    cells.iter().for_each(|cells| cells.pack(&order, &is_near, &mut words));
    let mut shares: Vec<BodyShare> = (0..bodies.len())
        .map(|body| {
            assert!(u32::try_from(total(body)).is_ok(), "a body of {} elements", total(body));
            BodyShare { count: total(body), replication: bodies[body].replication, ..BodyShare::default() }
        })
        .collect();
    let mut own = vec![0; bodies.len()];
    for run in order.runs() {
        let nodes = |key: &Key| [(key[2] >> 32) as u32, key[2] as u32];
        let body = run[0][0] as usize / 2;
        own[body] += run.len();
        if bodies[body].replication != Replication::Whole {
            shares[body].runs.push(run.iter().map(nodes).collect());
        }
    }
    drop(order);
    for of_rank in gather(exchange, &own) {
        shares.iter_mut().zip(of_rank).for_each(|(share, cells)| share.cells.push(cells));
    }
    for (body, share) in bodies.iter().zip(&mut shares).filter(|(body, _)| body.replication == Replication::Elements) {
        share.is_owned = vec![false; share.count];
        (share.elements, share.tags) = all_elements(exchange, body.elements, body.tags);
    }
    for word in post(exchange, words.owned).into_iter().flatten() {
        shares[(word >> 32) as usize].is_owned[word as u32 as usize] = true;
    }
    let mut received = post(exchange, words.to);
    received.extend(gather(exchange, &words.to_all));
    let packed = |(from, at): (u32, u32)| -> &Words { &received[from as usize].as_chunks().0[at as usize] };
    let all_from =
        |(from, words): (usize, &Vec<u64>)| (0..(words.len() / WORDS) as u32).map(move |at| (from as u32, at));
    let mut elements: Vec<(u32, u32)> = received.iter().enumerate().flat_map(all_from).collect();
    elements.par_sort_unstable_by_key(|&at| packed(at)[0]);
    elements.into_iter().for_each(|at| add_to_share(packed(at), exchange.rank(), &mut shares));
    let mut is_measured = vec![false; if around.measured.is_empty() { 0 } else { nodes.len() }];
    around.measured.iter().for_each(|&node| is_measured[node as usize] = true);
    for share in shares.iter_mut().filter(|share| share.replication == Replication::Part && !is_measured.is_empty()) {
        let all = |element: &[u32; 4]| element.iter().all(|&node| is_measured[node as usize]);
        let measured = (0..).zip(&share.elements).filter(|(_, element)| all(element)).map(|(number, _)| number);
        share.measured = measured.collect();
    }
    shares
}

/// Which nodes those of bodies are that every rank needs whole. All ranks must call it.
fn nodes_of_whole(exchange: &dyn Exchange, bodies: &[ReadBody], count: usize) -> Vec<bool> {
    let mut is_own = vec![false; count];
    let whole = bodies.iter().filter(|body| body.replication != Replication::Part);
    whole.flat_map(|body| body.elements).flatten().for_each(|&node| is_own[node as usize] = true);
    let own: Vec<u32> = (0..).zip(&is_own).filter(|(_, is_own)| **is_own).map(|(node, _)| node).collect();
    let mut is_of_whole = is_own;
    gather(exchange, &own).into_iter().flatten().for_each(|node| is_of_whole[node as usize] = true);
    is_of_whole
}

/// Elements that all ranks have read, in the order of the ranks, with their tags. All ranks must call it.
///
/// - `own`, `tags`: those that this rank has read
pub fn all_elements(exchange: &dyn Exchange, own: &[[u32; 4]], tags: &[u64]) -> (Vec<[u32; 4]>, Vec<u64>) {
    let counts = gather(exchange, &own.len());
    let count: usize = counts.iter().sum();
    let (mut elements, mut all_tags) = (vec![[0; 4]; count], vec![0; count]);
    // In rounds, so that the messages are small beside the elements.
    for begin in (0..counts.iter().copied().max().unwrap_or(0)).step_by(PACKED) {
        let of_rank = |&count: &usize| count.min(begin + PACKED) - count.min(begin);
        let round = begin.min(own.len())..own.len().min(begin + PACKED);
        let words = own[round.clone()].iter().zip(&tags[round]);
        let words = words.flat_map(|(&[a, b, c, d], &tag)| [pair(a, b), pair(c, d), tag].map(f64::from_bits));
        let words: Vec<f64> = words.collect();
        let lengths: Vec<usize> = counts.iter().map(|count| 3 * of_rank(count)).collect();
        let mut all = vec![0.0; lengths.iter().sum()];
        exchange.gather(&words, &lengths, &mut all);
        let (mut rest, mut first) = (all.as_chunks::<3>().0, 0);
        for rank_count in &counts {
            let (of_rank, others) = rest.split_at(of_rank(rank_count));
            for (place, &[ab, cd, tag]) in (first + begin..).zip(of_rank) {
                let ([a, b], [c, d]) = (halves(ab.to_bits()), halves(cd.to_bits()));
                (elements[place], all_tags[place]) = ([a, b, c, d], tag.to_bits());
            }
            (rest, first) = (others, first + rank_count);
        }
    }
    (elements, all_tags)
}

/// Elements for other ranks.
struct OnTheirWay {
    to: Vec<Vec<u64>>,
    /// Those that every rank gets.
    to_all: Vec<u64>,
    /// Body and number of elements that every rank gets otherwise, for the rank that owns them.
    owned: Vec<Vec<u64>>,
}

/// The curve through the cells of each body.
fn curves(exchange: &dyn Exchange, nodes: &[Vec3], bodies: &[ReadBody]) -> Vec<HilbertCurve> {
    let none = [Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)];
    let box_of = |body: &ReadBody| {
        let places = (0..body.elements.len()).flat_map(|element| middles(body, element, nodes));
        places.fold(none, |[low, high], place| [low.inf(&place), high.sup(&place)])
    };
    let own: Vec<[Vec3; 2]> = bodies.iter().map(box_of).collect();
    let all = gather(exchange, &own);
    let join = |[low, high]: [Vec3; 2], other: &[Vec3; 2]| [low.inf(&other[0]), high.sup(&other[1])];
    let of_body = |body: usize| all.iter().map(|own| own[body]).fold(none, |joined, own| join(joined, &own));
    (0..bodies.len()).map(of_body).map(|[low, high]| HilbertCurve::new(low, high)).collect()
}

/// Places by which the cells of an element are ordered, those of [`crate::cells::cell::Geometry`]: sums of nodes of each of its edges, or of the element.
fn middles<'a>(body: &ReadBody<'a>, element: usize, nodes: &'a [Vec3]) -> impl Iterator<Item = Vec3> + 'a {
    let corners = body.elements[element].map(|node| nodes[node as usize]);
    let smoothed = body.formulation == Formulation::Smoothed;
    let edges = TETRAHEDRON_EDGES.into_iter().filter(move |_| smoothed).map(move |[i, j]| corners[i] + corners[j]);
    edges.chain((!smoothed).then(|| corners.iter().sum()))
}

/// The cells of the elements of a body that this rank has read.
struct Cells<'a> {
    body: &'a ReadBody<'a>,
    index: usize,
    /// Number of its first element in the whole body.
    first: usize,
    curve: HilbertCurve,
    nodes: &'a [Vec3],
}

impl Cells<'_> {
    /// Cells of an element.
    fn keys_of(&self, element: usize) -> impl Iterator<Item = Key> + '_ {
        let edges = TETRAHEDRON_EDGES.map(|edge| edge.map(|corner| self.body.elements[element][corner]));
        let smoothed = self.body.formulation == Formulation::Smoothed;
        let number = (self.first + element) as u32;
        middles(self.body, element, self.nodes).enumerate().map(move |(at, middle)| {
            let [a, b] = if smoothed { edges[at] } else { [number; 2] };
            let is_sound = self.body.sound.get(element).is_some_and(|sound| sound[at]);
            [(2 * self.index + usize::from(is_sound)) as u64, self.curve.position(&middle), pair(a.min(b), a.max(b))]
        })
    }

    fn keys(&self) -> impl Iterator<Item = Key> + '_ {
        (0..self.body.elements.len()).flat_map(|element| self.keys_of(element))
    }

    /// Writes every element for the ranks that need it: its body and number, its nodes, its tag and the ranks of its edges.
    ///
    /// - `is_near`: nodes around which every rank needs all elements
    fn pack(&self, order: &Order, is_near: &[bool], words: &mut OnTheirWay) {
        let pack = |element: usize| {
            let mut ranks = [0; 6];
            for (at, key) in self.keys_of(element).enumerate() {
                // The one rank of an element stands in all places.
                ranks[at..].fill(order.rank(&key));
            }
            let [a, b, c, d] = self.body.elements[element];
            let of = |at: usize| pair(ranks[at], ranks[at + 1]);
            let head = (self.index as u64) << 32 | (self.first + element) as u64;
            (ranks, [head, pair(a, b), pair(c, d), self.body.tags[element], of(0), of(2), of(4)])
        };
        let count = self.body.elements.len();
        for begin in (0..count).step_by(PACKED) {
            let end = count.min(begin + PACKED);
            let packed: Vec<([u32; 6], Words)> = (begin..end).into_par_iter().map(pack).collect();
            for (element, (mut ranks, packed)) in (begin..end).zip(packed) {
                if self.body.replication == Replication::Elements {
                    let owner = ranks.iter().min().expect("of six edges");
                    words.owned[*owner as usize].push(packed[0]);
                    continue;
                }
                let is_for_all = self.body.elements[element].iter().any(|&node| is_near[node as usize]);
                if self.body.replication == Replication::Whole || is_for_all {
                    words.to_all.extend(packed);
                    continue;
                }
                ranks.sort_unstable();
                for of_rank in ranks.chunk_by(|a, b| a == b) {
                    words.to[of_rank[0] as usize].extend(packed);
                }
            }
        }
    }
}

/// Adds an element that has arrived to the share of its body.
fn add_to_share(&[head, a, b, tag, e, f, g]: &Words, me: usize, shares: &mut [BodyShare]) {
    let share = &mut shares[(head >> 32) as usize];
    let ([n0, n1], [n2, n3]) = (halves(a), halves(b));
    share.elements.push([n0, n1, n2, n3]);
    share.tags.push(tag);
    share.numbers.push(head as u32);
    let ([r0, r1], [r2, r3], [r4, r5]) = (halves(e), halves(f), halves(g));
    let owners = [r0, r1, r2, r3, r4, r5];
    // The lowest rank with a cell of it owns it.
    share.is_owned.push(owners.iter().min() == Some(&(me as u32)));
    share.owners.push(owners);
}

fn halves(word: u64) -> [u32; 2] {
    [(word >> 32) as u32, word as u32]
}

fn pair(a: u32, b: u32) -> u64 {
    u64::from(a) << 32 | u64::from(b)
}
