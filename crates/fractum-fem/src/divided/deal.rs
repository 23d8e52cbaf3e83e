//! Elements on their way from the ranks that have read them to those whose cells they are part of.

use fractum_math::Vec3;
use fractum_mesh::renumber::HilbertCurve;
use fractum_mesh::topology::TETRAHEDRON_EDGES;
use fractum_parallel::{Exchange, gather, post};
use rayon::prelude::*;

use super::order::{Key, Order};
use super::{BodyShare, ReadBody};
use crate::body::Formulation;

/// Words of an element on its way.
const WORDS: usize = 7;
/// Elements that are packed at a time.
const PACKED: usize = 1 << 16;

/// Deals the elements that all ranks have read out to those that need them. All ranks must call it, with the same bodies in the same order.
///
/// - `nodes`: positions of all nodes [m]
/// - `bodies`: the whole body has the elements of rank 0 first, then those of rank 1 and so on
///
/// # Panics
/// If a body has more elements than have a number of 32 bits.
pub fn deal(exchange: &dyn Exchange, nodes: &[Vec3], bodies: &[ReadBody]) -> Vec<BodyShare> {
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
    let order = Order::new(exchange, named, bodies.len());
    let mut words = vec![Vec::new(); exchange.size()];
    cells.iter().for_each(|cells| cells.pack(&order, &mut words));
    let mut shares: Vec<BodyShare> = (0..bodies.len())
        .map(|body| {
            assert!(u32::try_from(total(body)).is_ok(), "a body of {} elements", total(body));
            BodyShare { count: total(body), ..BodyShare::default() }
        })
        .collect();
    for run in order.runs() {
        let nodes = |key: &Key| [(key[2] >> 32) as u32, key[2] as u32];
        shares[run[0][0] as usize].runs.push(run.iter().map(nodes).collect());
    }
    drop(order);
    let received = post(exchange, words);
    let packed = |(rank, at): (u32, u32)| -> &[u64; WORDS] { &received[rank as usize].as_chunks().0[at as usize] };
    let of_rank =
        |(rank, words): (usize, &Vec<u64>)| (0..(words.len() / WORDS) as u32).map(move |at| (rank as u32, at));
    let mut elements: Vec<(u32, u32)> = received.iter().enumerate().flat_map(of_rank).collect();
    elements.par_sort_unstable_by_key(|&at| packed(at)[0]);
    elements.into_iter().for_each(|at| shares_of(packed(at), &mut shares));
    shares
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

/// Places by which the cells of an element are ordered, those of [`crate::cell::Geometry`]: sums of nodes of each of its edges, or of the element.
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
            [self.index as u64, self.curve.position(&middle), pair(a.min(b), a.max(b))]
        })
    }

    fn keys(&self) -> impl Iterator<Item = Key> + '_ {
        (0..self.body.elements.len()).flat_map(|element| self.keys_of(element))
    }

    /// Writes every element for the ranks that need it: its body and number, its nodes, its tag and the ranks of its edges.
    fn pack(&self, order: &Order, words: &mut [Vec<u64>]) {
        let pack = |element: usize| {
            let mut ranks = [0; 6];
            let found = self.keys_of(element).map(|key| order.rank(&key)).enumerate();
            let count = found.map(|(at, rank)| ranks[at] = rank).count();
            let mut to = ranks[..count].to_vec();
            to.sort_unstable();
            to.dedup();
            let [a, b, c, d] = self.body.elements[element];
            let of = |at: usize| pair(ranks[at], ranks[at + 1]);
            let number = (self.first + element) as u64;
            (to, [self.index as u64, number, pair(a, b), pair(c, d), self.body.tags[element], of(0), of(2), of(4)])
        };
        let count = self.body.elements.len();
        for begin in (0..count).step_by(PACKED) {
            let packed: Vec<_> = (begin..count.min(begin + PACKED)).into_par_iter().map(pack).collect();
            for (to, [body, number, nodes @ .., of_edges]) in packed {
                for (at, rank) in to.into_iter().enumerate() {
                    // The lowest rank that has it tells of it.
                    let head = body << 33 | number << 1 | u64::from(at == 0);
                    let [a, b, tag, e, f] = nodes;
                    words[rank as usize].extend([head, a, b, tag, e, f, of_edges]);
                }
            }
        }
    }
}

/// Adds an element that has arrived to the share of its body.
fn shares_of(&[head, a, b, tag, e, f, g]: &[u64; WORDS], shares: &mut [BodyShare]) {
    let share = &mut shares[(head >> 33) as usize];
    let halves = |word: u64| [(word >> 32) as u32, word as u32];
    let ([n0, n1], [n2, n3]) = (halves(a), halves(b));
    share.elements.push([n0, n1, n2, n3]);
    share.tags.push(tag);
    share.numbers.push((head >> 1) as u32);
    share.is_told.push(head & 1 == 1);
    let ([r0, r1], [r2, r3], [r4, r5]) = (halves(e), halves(f), halves(g));
    share.owners.push([r0, r1, r2, r3, r4, r5]);
}

fn pair(a: u32, b: u32) -> u64 {
    u64::from(a) << 32 | u64::from(b)
}
