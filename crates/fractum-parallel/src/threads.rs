use std::sync::{Arc, Barrier, Mutex, MutexGuard, PoisonError};

use crate::exchange::{Exchange, Message};

/// Ranks of one process, a thread for each.
#[derive(Debug)]
struct ThreadRank {
    rank: usize,
    hub: Arc<Hub>,
}

/// Where the threads meet.
#[derive(Debug)]
struct Hub {
    size: usize,
    barrier: Barrier,
    /// Numbers from rank a to rank b, at a · size + b.
    numbers: Mutex<Vec<Vec<f64>>>,
    bytes: Mutex<Vec<Vec<u8>>>,
}

/// The ends of an exchange between `size` threads. Each must be used by a thread of its own, with a rayon pool of its own.
pub fn threads(size: usize) -> Vec<Arc<dyn Exchange>> {
    let hub = Arc::new(Hub {
        size,
        barrier: Barrier::new(size),
        numbers: Mutex::new(vec![Vec::new(); size * size]),
        bytes: Mutex::new(vec![Vec::new(); size]),
    });
    (0..size).map(|rank| Arc::new(ThreadRank { rank, hub: hub.clone() }) as Arc<dyn Exchange>).collect()
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Exchange for ThreadRank {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.hub.size
    }

    fn machine(&self) -> String {
        String::new()
    }

    fn swap(&self, messages: &mut [Message], work: &mut dyn FnMut()) {
        let Hub { size, barrier, numbers, .. } = &*self.hub;
        for message in &*messages {
            lock(numbers)[self.rank * size + message.rank].clone_from(&message.send);
        }
        work();
        barrier.wait();
        for message in messages {
            message.receive.copy_from_slice(&lock(numbers)[message.rank * size + self.rank]);
        }
        barrier.wait();
    }

    fn gather(&self, own: &[f64], counts: &[usize], all: &mut [f64]) {
        let own: Vec<u8> = own.iter().flat_map(|value| value.to_le_bytes()).collect();
        let parts = self.gather_bytes(&own);
        assert!(parts.iter().zip(counts).all(|(part, &count)| part.len() == 8 * count), "counts of another exchange");
        let values = parts.iter().flat_map(|part| part.chunks_exact(8));
        all.iter_mut()
            .zip(values)
            .for_each(|(to, from)| *to = f64::from_le_bytes(from.try_into().expect("eight bytes")));
    }

    fn gather_bytes(&self, own: &[u8]) -> Vec<Vec<u8>> {
        let Hub { barrier, bytes, .. } = &*self.hub;
        lock(bytes)[self.rank] = own.to_vec();
        barrier.wait();
        let all = lock(bytes).clone();
        barrier.wait();
        all
    }

    fn any(&self, bits: u64) -> u64 {
        let all = self.gather_bytes(&bits.to_le_bytes());
        let of = |bytes: &Vec<u8>| u64::from_le_bytes(bytes.as_slice().try_into().expect("eight bytes"));
        all.iter().map(of).fold(0, |any, bits| any | bits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_rank_hears_all_others() {
        let ranks = threads(3);
        std::thread::scope(|scope| {
            for end in &ranks {
                scope.spawn(move || {
                    let me = end.rank();
                    let others = (0..3).filter(|&other| other != me);
                    let message = |rank| Message { rank, send: vec![(10 * me + rank) as f64], receive: vec![0.0] };
                    let mut messages: Vec<Message> = others.map(message).collect();
                    let mut worked = 0;
                    for _ in 0..3 {
                        end.swap(&mut messages, &mut || worked += 1);
                    }
                    assert_eq!(worked, 3);
                    assert!(messages.iter().all(|m| m.receive == [(10 * m.rank + me) as f64]));
                    let mut all = [0.0; 3];
                    end.gather(&vec![1.0 + me as f64; me], &[0, 1, 2], &mut all);
                    assert_eq!(all, [2.0, 3.0, 3.0]);
                    let mut by_owner = [[me as f64, 1.0], [me as f64, 2.0], [me as f64, 3.0], [me as f64, 4.0]];
                    crate::exchange::gather_by_owner(&**end, |item| [2, 0, 2, 1][item], &mut by_owner);
                    assert_eq!(by_owner, [[2.0, 1.0], [0.0, 2.0], [2.0, 3.0], [1.0, 4.0]]);
                    assert_eq!(crate::exchange::gather_named(&**end, &vec![me; me]), [1, 2, 2]);
                    assert_eq!(crate::exchange::gather_named::<usize>(&**end, &Vec::new()), []);
                    let words = (0..3).map(|rank| vec![u64::MAX - (10 * me + rank) as u64; (me + rank) % 3]).collect();
                    let received = crate::exchange::post(&**end, words);
                    for (rank, words) in received.iter().enumerate() {
                        assert_eq!(*words, vec![u64::MAX - (10 * rank + me) as u64; (me + rank) % 3]);
                    }
                    assert_eq!(end.any(1 << me), 0b111);
                    assert_eq!(crate::exchange::gather(&**end, &(me, "rank".to_owned()))[2], (2, "rank".to_owned()));
                });
            }
        });
    }
}
