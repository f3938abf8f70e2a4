//! The memory that searches work in, kept from one to the next so that queries do not allocate.

use super::packet::Packet;
use super::pencil::Pencil;
use super::trace::Trace;
use std::cell::Cell;

/// How many rays make a set: those of a packet, and at most so many are in hand at once.
pub(super) const WIDTH: usize = 64;

#[derive(Debug)]
pub(super) struct Scratch {
    /// One for each of [`WIDTH`] rays; on the heap, since they are large.
    pub(super) traces: Box<[Trace; WIDTH]>,
    pub(super) pencil: Pencil,
    pub(super) packet: Packet,
    /// Where in a batch the rays start that are searched for in turn, [`WIDTH`] from each.
    pub(super) starts: Vec<u32>,
}

thread_local! {
    static SCRATCH: Cell<Option<Box<Scratch>>> = const { Cell::new(None) };
}

impl Scratch {
    /// Lends this thread's to `work`.
    #[inline(always)]
    pub(super) fn lend<T>(work: impl FnOnce(&mut Self) -> T) -> T {
        let mut scratch = SCRATCH.take().unwrap_or_else(Self::idle);
        let result = work(&mut scratch);
        SCRATCH.set(Some(scratch));
        result
    }

    #[cold]
    fn idle() -> Box<Self> {
        let traces: Vec<Trace> = (0..WIDTH).map(|_| Trace::idle()).collect();
        // By way of a vector, since an array of them would be made on the stack, half a megabyte of it.
        let traces = traces.into_boxed_slice().try_into().expect("as many as were made");
        Box::new(Self { traces, pencil: Pencil::idle(), packet: Packet::idle(), starts: Vec::new() })
    }
}
