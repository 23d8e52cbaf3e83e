//! Values of some items that ranks send each other.

use std::collections::{BTreeMap, BTreeSet};

use crate::exchange::{Exchange, Message};

/// Items of which each rank sends some to all others.
#[derive(Clone, Debug)]
pub struct Gathered {
    items: Vec<Vec<u32>>,
    counts: Vec<usize>,
    own: Vec<f64>,
    all: Vec<f64>,
}

impl Gathered {
    /// - `items`: those of every rank
    pub fn new(items: Vec<Vec<u32>>) -> Self {
        Gathered { counts: vec![0; items.len()], items, own: Vec::new(), all: Vec::new() }
    }

    /// The items of a rank.
    pub fn of(&self, rank: usize) -> &[u32] {
        &self.items[rank]
    }

    /// Lets go of the memory of messages, which comes again where it is needed.
    pub fn release(&mut self) {
        (self.own, self.all) = (Vec::new(), Vec::new());
    }

    /// Gathers these items too.
    pub fn append(&mut self, more: &Gathered) {
        self.items.iter_mut().zip(&more.items).for_each(|(items, more)| items.extend(more));
    }

    /// Gives every rank the `N` values of these items.
    ///
    /// - `get`, `put`: read them from what this rank has, and write them there
    pub fn gather<const N: usize, S: ?Sized>(
        &mut self,
        exchange: &dyn Exchange,
        values: &mut S,
        get: impl Fn(&S, usize) -> [f64; N],
        put: impl Fn(&mut S, usize, [f64; N]),
    ) {
        let Gathered { items, counts, own, all } = self;
        counts.iter_mut().zip(&*items).for_each(|(count, items)| *count = N * items.len());
        let total = counts.iter().sum();
        if total == 0 {
            return;
        }
        own.clear();
        own.extend(items[exchange.rank()].iter().flat_map(|&item| get(values, item as usize)));
        all.resize(total, 0.0);
        exchange.gather(own, counts, all);
        for (&item, from) in items.iter().flatten().zip(all.as_chunks().0) {
            put(values, item as usize, *from);
        }
    }
}

/// Items whose values ranks send each other: which to send and which to receive, neighbour by neighbour.
#[derive(Clone, Debug)]
pub struct Exchanged<T> {
    messages: Vec<Message>,
    items: Vec<[Vec<T>; 2]>,
}

impl<T: Copy> Exchanged<T> {
    /// - `between`: what is sent to another rank, and what comes from it; both in the order of that rank
    pub fn new(between: BTreeMap<usize, [Vec<T>; 2]>) -> Self {
        let message = |&rank: &usize| Message { rank, ..Message::default() };
        Exchanged { messages: between.keys().map(message).collect(), items: between.into_values().collect() }
    }

    /// The same of sets.
    pub fn of_sets(between: BTreeMap<usize, [BTreeSet<T>; 2]>) -> Self
    where
        T: Ord,
    {
        let lists = |(rank, sets): (usize, [BTreeSet<T>; 2])| (rank, sets.map(|set| set.into_iter().collect()));
        Exchanged::new(between.into_iter().map(lists).collect())
    }

    /// What is sent.
    pub fn sent(&self) -> impl Iterator<Item = T> + '_ {
        self.items.iter().flat_map(|[send, _]| send).copied()
    }

    /// What is received.
    pub fn received(&self) -> impl Iterator<Item = T> + '_ {
        self.items.iter().flat_map(|[_, receive]| receive).copied()
    }

    /// Writes the `N` values of each item to be sent.
    pub fn fill<const N: usize>(&mut self, get: impl Fn(T) -> [f64; N]) {
        for (message, [send, receive]) in self.messages.iter_mut().zip(&self.items) {
            message.send.clear();
            message.send.extend(send.iter().flat_map(|&item| get(item)));
            message.receive.resize(N * receive.len(), 0.0);
        }
    }

    /// Sends and receives what was written, and does some work meanwhile.
    pub fn swap(&mut self, exchange: &dyn Exchange, work: &mut dyn FnMut()) {
        exchange.swap(&mut self.messages, work);
    }

    /// Reads the `N` values of each item that was received.
    pub fn read<const N: usize>(&self, mut put: impl FnMut(T, [f64; N])) {
        for (message, [_, receive]) in self.messages.iter().zip(&self.items) {
            for (from, &item) in message.receive.as_chunks().0.iter().zip(receive) {
                put(item, *from);
            }
        }
    }

    /// Exchanges the `N` values of all items.
    ///
    /// - `get`, `put`: read them from what this rank has, and write them there
    pub fn exchange<const N: usize, S: ?Sized>(
        &mut self,
        exchange: &dyn Exchange,
        values: &mut S,
        get: impl Fn(&S, T) -> [f64; N],
        put: impl Fn(&mut S, T, [f64; N]),
    ) {
        self.fill(|item| get(values, item));
        self.swap(exchange, &mut || {});
        self.read(|item, from| put(values, item, from));
    }
}
