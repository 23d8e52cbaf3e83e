use std::fmt::Debug;

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Numbers for another rank, and numbers from it.
#[derive(Clone, Debug, Default)]
pub struct Message {
    /// The other rank.
    pub rank: usize,
    /// For it.
    pub send: Vec<f64>,
    /// From it; as long as what it sends.
    pub receive: Vec<f64>,
}

/// What the ranks send each other.
pub trait Exchange: Debug + Send + Sync {
    /// Number of this rank, from 0.
    fn rank(&self) -> usize;

    /// Number of ranks.
    fn size(&self) -> usize;

    /// Name of the machine that this rank is on.
    fn machine(&self) -> String;

    /// Sends and receives a message for each neighbour, and does some work while they travel. Of two ranks both have a message for each
    /// other, or none.
    fn swap(&self, messages: &mut [Message], work: &mut dyn FnMut());

    /// Gives every rank the values of all, rank after rank.
    ///
    /// - `counts`: number of values of each rank; `all` is as long as their sum
    fn gather(&self, own: &[f64], counts: &[usize], all: &mut [f64]);

    /// Gives every rank the bytes of all, rank after rank.
    fn gather_bytes(&self, own: &[u8]) -> Vec<Vec<u8>>;

    /// The bits that are set on any rank.
    fn any(&self, bits: u64) -> u64;
}

/// What all ranks name, rank after rank: a word where none names anything.
pub fn gather_named<T: Serialize + DeserializeOwned>(exchange: &dyn Exchange, own: &Vec<T>) -> Vec<T> {
    let is_any = exchange.any(u64::from(!own.is_empty())) != 0;
    if is_any { gather(exchange, own).into_iter().flatten().collect() } else { Vec::new() }
}

/// Gives every rank the values of all items, each by the rank that owns it.
pub fn gather_by_owner<const N: usize>(
    exchange: &dyn Exchange,
    owner: impl Fn(usize) -> usize,
    values: &mut [[f64; N]],
) {
    let mut counts = vec![0; exchange.size()];
    (0..values.len()).for_each(|item| counts[owner(item)] += N);
    let own = (0..values.len()).filter(|&item| owner(item) == exchange.rank()).flat_map(|item| values[item]);
    let own: Vec<f64> = own.collect();
    let mut all = vec![0.0; N * values.len()];
    exchange.gather(&own, &counts, &mut all);
    let begin = |sum: &mut usize, count: &usize| Some(std::mem::replace(sum, *sum + count));
    let mut next: Vec<usize> = counts.iter().scan(0, begin).collect();
    for (item, value) in values.iter_mut().enumerate() {
        let next = &mut next[owner(item)];
        value.copy_from_slice(&all[*next..*next + N]);
        *next += N;
    }
}

/// Sends words to every rank, and gets those for this one: rank after rank, the own ones among them.
pub fn post(exchange: &dyn Exchange, mut words: Vec<Vec<u64>>) -> Vec<Vec<u64>> {
    let (me, size) = (exchange.rank(), exchange.size());
    let counts: Vec<f64> = words.iter().map(|words| words.len() as f64).collect();
    let mut all = vec![0.0; size * size];
    exchange.gather(&counts, &vec![size; size], &mut all);
    let own = std::mem::take(&mut words[me]);
    let message = |(rank, words): (usize, Vec<u64>)| {
        let receive = all[size * rank + me] as usize;
        // Numbers travel as they are, whatever their bits mean.
        let send: Vec<f64> = words.into_iter().map(f64::from_bits).collect();
        (rank != me && send.len() + receive > 0).then(|| Message { rank, send, receive: vec![0.0; receive] })
    };
    let mut messages: Vec<Message> = words.into_iter().enumerate().filter_map(message).collect();
    exchange.swap(&mut messages, &mut || {});
    let mut received = vec![Vec::new(); size];
    received[me] = own;
    for Message { rank, receive, .. } in messages {
        received[rank] = receive.into_iter().map(f64::to_bits).collect();
    }
    received
}

/// Gives every rank the values of all, rank after rank.
///
/// # Panics
/// If a value cannot be written or read, which is a mistake of the program.
pub fn gather<T: Serialize + DeserializeOwned>(exchange: &dyn Exchange, own: &T) -> Vec<T> {
    let own = postcard::to_stdvec(own).expect("plain data");
    let read = |bytes: &Vec<u8>| postcard::from_bytes(bytes).expect("all ranks run the same program");
    exchange.gather_bytes(&own).iter().map(read).collect()
}
