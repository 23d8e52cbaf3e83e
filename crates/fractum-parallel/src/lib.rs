//! Exchange of numbers between the ranks that advance one scene together, and the division of work among them.
//!
//! A rank is a process started by MPI (feature `mpi`), or a thread ([`threads`]), which needs no MPI and serves tests. All
//! ranks make the same calls in the same order; every method waits for the others. No method adds numbers: sums are made by
//! who gets them, in an order of its own, so that they have the same bits for any number of ranks.

#![forbid(unsafe_code)]

mod division;
mod exchange;
#[cfg(feature = "mpi")]
mod mpi;
mod threads;
mod values;

pub use crate::division::{rank_of, runs_by_weight, runs_of};
pub use crate::exchange::{Exchange, Message, gather, gather_by_owner, gather_named, post};
#[cfg(feature = "mpi")]
pub use crate::mpi::{World, initialize};
pub use crate::values::{Exchanged, Gathered};
pub use threads::threads;
