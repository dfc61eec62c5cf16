//! What followed paths bring, term by term, where their trails are kept.

use super::ends::Ends;
use super::grid::NO_CELL;
use super::trail::Trail;

/// What a term is in proportion to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Brought {
    /// The radiosity of a cell where a path ends.
    End(u32),
    /// That of another cell: of a reflector seen on the way, or of Russian roulette.
    Seen(u32),
    /// The emission of a source.
    Emission(u32),
}

/// A term of what a path brings: `weight * product * what`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PathTerm {
    pub path: usize,
    /// The number of the continuation that brings it; `None` where the first ray ends in a cell.
    pub continuation: Option<usize>,
    pub product: u32,
    pub what: Brought,
    pub weight: f64,
}

impl Ends {
    /// Visits all terms of what paths bring, `count` of them from each place.
    pub fn for_each_term(&self, count: usize, mut visit: impl FnMut(PathTerm)) {
        let Some(trail) = &self.trail else { return };
        for (path, &cell) in self.cell.iter().enumerate().filter(|(_, cell)| **cell != NO_CELL) {
            let product = trail.begin.get(path / count).copied().unwrap_or_default();
            visit(PathTerm { path, continuation: None, product, what: Brought::End(cell), weight: 1.0 });
        }
        let mut of_continuation = |number: usize, product: u32, what: Brought, weight: f64| {
            let path = self.continued[number].path;
            visit(PathTerm { path, continuation: Some(number), product, what, weight });
        };
        for (number, (continuation, &(product, weight))) in self.continued.iter().zip(&trail.at).enumerate() {
            if continuation.cell != NO_CELL {
                of_continuation(number, product, Brought::End(continuation.cell), weight);
            }
        }
        for (&(number, cell), &(product, weight)) in self.seen.iter().zip(&trail.seen) {
            of_continuation(number, product, Brought::Seen(cell), weight);
        }
        for collected in &trail.collected {
            let what = Brought::Emission(collected.source);
            of_continuation(collected.continuation, collected.product, what, collected.weight);
        }
    }

    /// Keeps the trails of paths that are followed from here on.
    pub fn keep_trail(&mut self, trail: Trail) {
        self.trail = Some(trail);
    }
}
