//! Numbers of jobs, dealt out to the lanes of all processes one by one: whoever is done gets the next.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::super::interrupt;

/// Deals out numbers in an order, by their places in it; the first process keeps them.
pub struct Deal {
    /// The same in all processes.
    pub order: Vec<usize>,
    next: AtomicUsize,
}

impl Deal {
    /// In this order.
    pub fn new(order: Vec<usize>) -> Self {
        Self { order, next: AtomicUsize::new(0) }
    }

    /// The place of the next number, for a lane of this process; `None` if there is none left, or after an interrupt.
    pub fn next(&self, lane: usize) -> Option<usize> {
        #[cfg(feature = "mpi")]
        if !super::is_first() {
            return super::world::dealt(lane);
        }
        #[cfg(not(feature = "mpi"))]
        let _ = lane;
        self.next_here()
    }

    /// A lane of this process wants no more.
    pub fn leave(&self, lane: usize) {
        #[cfg(feature = "mpi")]
        if !super::is_first() {
            super::world::leave(lane);
        }
        #[cfg(not(feature = "mpi"))]
        let _ = lane;
    }

    /// In the first process: answers so many lanes of others, until none of them wants more or all `is_over`.
    pub fn serve(&self, lanes: usize, is_over: impl Fn() -> bool) {
        #[cfg(feature = "mpi")]
        if super::is_first() && lanes > 0 {
            super::world::deal(lanes, || self.next_here(), is_over);
        }
        #[cfg(not(feature = "mpi"))]
        let _ = (lanes, is_over);
    }

    fn next_here(&self) -> Option<usize> {
        if interrupt::count() > 0 {
            return None;
        }
        Some(self.next.fetch_add(1, Ordering::Relaxed)).filter(|&place| place < self.order.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_is_dealt_once_and_in_order() {
        let deal = Deal::new(vec![2, 0, 1]);
        assert_eq!(Vec::from_iter(std::iter::from_fn(|| deal.next(0))), [0, 1, 2]);
        assert_eq!(deal.next(1), None);
    }
}
