//! The search for overloaded bonds where several ranks share a body: each looks at its own sites, and all break what any names.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::Arc;

use fractum_math::Sym3;
use fractum_parallel::{Exchange, Exchanged, gather, rank_of};

use super::criterion::FailureSite;
use crate::bond::{BondGraph, Bonds};
use crate::particles::ParticleSubdomain;

/// The sites of a rank.
#[derive(Clone, Debug)]
pub(super) struct SearchSubdomain {
    exchange: Arc<dyn Exchange>,
    particles: Range<usize>,
    bonds: Range<usize>,
    /// Particles of others in the neighbourhoods of own ones, and the other way round.
    virials: Exchanged<u32>,
}

impl SearchSubdomain {
    /// - `rings`: how many bonds lead from a particle to the farthest of its neighbourhood
    pub(super) fn new(part: &ParticleSubdomain, bonds: &Bonds, graph: &BondGraph, rings: usize) -> Self {
        let (exchange, first) = (Arc::clone(part.exchange()), part.first());
        let me = exchange.rank();
        let mut between = BTreeMap::<usize, [BTreeSet<u32>; 2]>::new();
        // Bonds that break make neighbourhoods smaller: what is near now is all that ever will be.
        let (mut near, mut shell) = (Vec::new(), Vec::new());
        for own in part.own() {
            near.clear();
            near.push(own as u32);
            let mut begin = 0;
            for _ in 0..rings {
                shell.clear();
                let neighbours = near[begin..].iter().flat_map(|&i| graph.neighbours(i as usize));
                shell.extend(neighbours.map(|half| half.other));
                begin = near.len();
                near.extend(&shell);
            }
            for (&i, rank) in near.iter().zip(near.iter().map(|&i| rank_of(first, i as usize))) {
                if rank != me {
                    let [send, receive] = between.entry(rank).or_default();
                    send.insert(own as u32);
                    receive.insert(i);
                }
            }
        }
        let virials = Exchanged::of_sets(between);
        SearchSubdomain { particles: part.own(), bonds: bonds.own_bonds(), virials, exchange }
    }

    pub(super) fn particles(&self) -> Range<usize> {
        self.particles.clone()
    }

    pub(super) fn bonds(&self) -> Range<usize> {
        self.bonds.clone()
    }

    /// Whether any rank has something.
    pub(super) fn any(&self, has: bool) -> bool {
        self.exchange.any(u64::from(has)) != 0
    }

    /// Tells the virials of own particles, and whether they reach a limit, to those that have them in neighbourhoods. Whether one of others
    /// does.
    pub(super) fn exchange_virials(&mut self, virials: &mut [Sym3], reaching: &mut [bool]) -> bool {
        self.virials.fill(|i| {
            let [a, b, c, d, e, f] = virials[i as usize].0;
            [a, b, c, d, e, f, f64::from(u8::from(reaching[i as usize]))]
        });
        self.virials.swap(&*self.exchange, &mut || {});
        let mut any = false;
        self.virials.read(|i, [a, b, c, d, e, f, reaches]: [f64; 7]| {
            virials[i as usize] = Sym3([a, b, c, d, e, f]);
            reaching[i as usize] = reaches != 0.0;
            any |= reaches != 0.0;
        });
        any
    }

    /// The worst site of all ranks.
    pub(super) fn worst(&self, own: Option<FailureSite>) -> Option<FailureSite> {
        let own = own.map(|site| (site.index, site.ratio));
        let all = gather(&*self.exchange, &own).into_iter().flatten();
        let site = |(index, ratio)| FailureSite { index, ratio };
        all.map(site).reduce(|worst, site| if site.ratio > worst.ratio { site } else { worst })
    }

    pub(super) fn exchange(&self) -> &dyn Exchange {
        &*self.exchange
    }
}
