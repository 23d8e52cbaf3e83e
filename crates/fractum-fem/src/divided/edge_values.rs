//! Stress, damage and strain of edges that other ranks evaluate, for the means over the edges of an element.

use std::collections::BTreeMap;

use fractum_math::Sym3;
use fractum_mesh::topology::TETRAHEDRON_EDGES;
use fractum_parallel::{Exchange, Exchanged, post};

use super::{BodyShare, EdgeValue};
use crate::body::edges::BodyEdges;

/// Numbers of an [`EdgeValue`].
const NUMBERS: usize = 19;

/// Values of edges that this rank gets of others, and of those that it sends.
#[derive(Clone, Debug, Default)]
pub(crate) struct EdgeValues {
    /// Edges that are sent, by their number on this rank, and places in `values` of those that come.
    swapped: Option<Exchanged<u32>>,
    pub(crate) values: Vec<EdgeValue>,
}

impl EdgeValues {
    /// - `elements`, `edges`: those of this rank
    /// - returns with each edge of others the place that its value will have
    pub(crate) fn new(
        exchange: &dyn Exchange,
        share: &BodyShare,
        elements: &[[u32; 4]],
        edges: &BodyEdges,
    ) -> (Self, BTreeMap<u32, u32>) {
        let me = exchange.rank();
        let mut of_rank = vec![BTreeMap::<[u32; 2], u32>::new(); exchange.size()];
        let owned = (0..elements.len()).filter(|&element| share.is_owned[element]);
        for element in owned {
            for (at, edge) in TETRAHEDRON_EDGES.into_iter().enumerate() {
                let rank = share.owners[element][at] as usize;
                if rank != me {
                    let [a, b] = edge.map(|corner| elements[element][corner]);
                    of_rank[rank].insert([a.min(b), a.max(b)], edges.of_element(element as u32)[at]);
                }
            }
        }
        let ask =
            |wanted: &BTreeMap<[u32; 2], u32>| wanted.keys().map(|&[a, b]| u64::from(a) << 32 | u64::from(b)).collect();
        let asked = post(exchange, of_rank.iter().map(ask).collect());
        let mut between = BTreeMap::<usize, [Vec<u32>; 2]>::new();
        let mut places = BTreeMap::new();
        for (rank, wanted) in of_rank.iter().enumerate().filter(|(_, wanted)| !wanted.is_empty()) {
            for &edge in wanted.values() {
                let place = places.len() as u32;
                places.insert(edge, place);
                between.entry(rank).or_default()[1].push(place);
            }
        }
        for (rank, words) in asked.iter().enumerate().filter(|(_, words)| !words.is_empty()) {
            let number = |&word: &u64| {
                let nodes = [(word >> 32) as u32, word as u32];
                edges.find(nodes).expect("this rank has the elements around its edges")
            };
            between.entry(rank).or_default()[0].extend(words.iter().map(number));
        }
        let values = vec![EdgeValue::default(); places.len()];
        (EdgeValues { swapped: Some(Exchanged::new(between)), values }, places)
    }

    /// Gets the values of others. All ranks must call it.
    ///
    /// - `value`: of an edge of this rank
    pub(crate) fn swap(&mut self, exchange: &dyn Exchange, value: impl Fn(u32) -> EdgeValue) {
        let Some(swapped) = &mut self.swapped else { return };
        let get = |_: &Vec<EdgeValue>, edge: u32| {
            let EdgeValue { stress, earlier_stress, damage, strain } = value(edge);
            let mut numbers = [damage; NUMBERS];
            numbers[..6].copy_from_slice(&stress.0);
            numbers[6..12].copy_from_slice(&strain.0);
            numbers[12..18].copy_from_slice(&earlier_stress.0);
            numbers
        };
        let put = |values: &mut Vec<EdgeValue>, place: u32, numbers: [f64; NUMBERS]| {
            let [stress, strain, earlier_stress] =
                [0, 6, 12].map(|first| Sym3(std::array::from_fn(|k| numbers[first + k])));
            values[place as usize] = EdgeValue { stress, earlier_stress, damage: numbers[18], strain };
        };
        swapped.exchange(exchange, &mut self.values, get, put);
    }
}
