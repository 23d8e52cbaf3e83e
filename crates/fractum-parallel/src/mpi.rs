use mpi::collective::SystemOperation;
use mpi::datatype::PartitionMut;
use mpi::environment::Universe;
use mpi::request::multiple_scope;
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use mpi::{Count, Threading};

use crate::division::piece;
use crate::exchange::{Exchange, Message};

/// All processes that MPI has started together.
#[derive(Clone, Copy, Debug)]
pub struct World {
    rank: usize,
    size: usize,
}

/// Joins the processes that MPI has started; none where it cannot be used from the threads of a pool.
///
/// The universe must live as long as there is anything to exchange.
pub fn initialize() -> Option<(Universe, World)> {
    let (universe, threading) = mpi::initialize_with_threading(Threading::Serialized)?;
    let world = universe.world();
    let own = World { rank: world.rank() as usize, size: world.size() as usize };
    (threading >= Threading::Serialized).then_some((universe, own))
}

/// Where the values of each rank begin.
fn offsets(counts: &[Count]) -> Vec<Count> {
    let begin = |sum: &mut Count, count: &Count| {
        let first = *sum;
        *sum += count;
        Some(first)
    };
    counts.iter().scan(0, begin).collect()
}

impl World {
    /// Ends all processes at once.
    pub fn abort(&self, code: i32) -> ! {
        SimpleCommunicator::world().abort(code)
    }
}

impl Exchange for World {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.size
    }

    fn machine(&self) -> String {
        // Where MPI does not tell it, all processes count as being on one machine.
        mpi::environment::processor_name().unwrap_or_default()
    }

    fn swap(&self, messages: &mut [Message], work: &mut dyn FnMut()) {
        let world = SimpleCommunicator::world();
        multiple_scope(2 * messages.len(), |scope, requests| {
            for Message { rank, send, receive } in messages.iter_mut() {
                let other = world.process_at_rank(*rank as i32);
                requests.add(other.immediate_receive_into(scope, &mut receive[..]));
                requests.add(other.immediate_send(scope, &send[..]));
            }
            work();
            let mut done = Vec::with_capacity(requests.incomplete());
            requests.wait_all(&mut done);
        });
    }

    fn gather(&self, own: &[f64], counts: &[usize], all: &mut [f64]) {
        let counts: Vec<Count> = counts.iter().map(|&count| count as Count).collect();
        let offsets = offsets(&counts);
        let mut all = PartitionMut::new(all, counts, offsets);
        SimpleCommunicator::world().all_gather_varcount_into(own, &mut all);
    }

    fn gather_bytes(&self, own: &[u8]) -> Vec<Vec<u8>> {
        let world = SimpleCommunicator::world();
        let mut lengths: Vec<u64> = vec![0; self.size];
        world.all_gather_into(&(own.len() as u64), &mut lengths[..]);
        let lengths: Vec<usize> = lengths.into_iter().map(|length| length as usize).collect();
        let mut parts: Vec<Vec<u8>> = lengths.iter().map(|&length| Vec::with_capacity(length)).collect();
        // MPI counts what comes from all ranks by 32 bits.
        let limit = Count::MAX as usize / self.size;
        for round in 0..lengths.iter().max().map_or(0, |longest| longest.div_ceil(limit)) {
            let counts: Vec<Count> = lengths.iter().map(|&length| piece(length, round, limit).len() as Count).collect();
            let offsets = offsets(&counts);
            let mut all = vec![0; counts.iter().map(|&count| count as usize).sum()];
            let own = &own[piece(own.len(), round, limit)];
            world.all_gather_varcount_into(own, &mut PartitionMut::new(&mut all[..], &counts[..], &offsets[..]));
            for (part, (&first, &count)) in parts.iter_mut().zip(offsets.iter().zip(&counts)) {
                part.extend_from_slice(&all[first as usize..(first + count) as usize]);
            }
        }
        parts
    }

    fn any(&self, bits: u64) -> u64 {
        let mut all = 0;
        SimpleCommunicator::world().all_reduce_into(&bits, &mut all, SystemOperation::bitwise_or());
        all
    }
}
