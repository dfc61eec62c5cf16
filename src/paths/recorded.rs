//! What followed paths bring, term by term, where their trails are kept.

use super::ends::Ends;
use super::grids::NO_CELL;
use super::trail::{Collected, Trail};

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
    /// Whether the path of a value, if this one goes on from where that ends, brings it too.
    pub is_of_value: bool,
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
            visit(PathTerm { path, is_of_value: true, product, what: Brought::End(cell), weight: self.first_weight[path] });
        }
        let mut of_continuation = |number: usize, is_of_value: bool, (product, weight): (u32, f64), what: Brought| {
            visit(PathTerm { path: self.continued[number].path, is_of_value, product, what, weight });
        };
        for (number, (continuation, &at)) in self.continued.iter().zip(&trail.at).enumerate() {
            if continuation.cell != NO_CELL {
                of_continuation(number, continuation.value_end.is_none(), at, Brought::End(continuation.cell));
            }
        }
        for (seen, &at) in self.seen.iter().zip(&trail.seen) {
            of_continuation(seen.continuation, seen.is_of_value, at, Brought::Seen(seen.cell));
        }
        for &Collected { continuation, product, source, weight, is_of_value } in &trail.collected {
            of_continuation(continuation, is_of_value, (product, weight), Brought::Emission(source));
        }
    }

    /// Keeps the trails of paths that are followed from here on.
    pub fn keep_trail(&mut self, trail: Trail) {
        self.trail = Some(trail);
    }
}
