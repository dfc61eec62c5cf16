//! A set of unordered pairs of surfaces: the paper's n(n-1)/2 bits.

use crate::progress::Stop;

/// Pairs `(first, second)` with `first < second`, a row of bits for each `first`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct PairSet {
    rows: Vec<Row>,
}

/// The partners `second > first` of one surface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Row {
    first: usize,
    words: Vec<u64>,
}

impl PairSet {
    /// All pairs of `count` surfaces; `None` if stopped.
    pub fn all(count: usize, stop: Stop<'_>) -> Option<Self> {
        let row = |first: usize| {
            if stop() {
                return None;
            }
            let partners = count - first - 1;
            let mut words = vec![u64::MAX; partners.div_ceil(64)];
            if !partners.is_multiple_of(64)
                && let Some(last) = words.last_mut()
            {
                *last = (1 << (partners % 64)) - 1;
            }
            Some(Row { first, words })
        };
        let rows: Option<Vec<Row>> = (0..count).map(row).collect();
        Some(Self { rows: rows? })
    }

    /// Takes a pair in; `first < second`.
    pub fn insert(&mut self, first: usize, second: usize) {
        let bit = second - first - 1;
        self.rows[first].words[bit / 64] |= 1 << (bit % 64);
    }

    /// The rows, to be worked in parallel.
    pub fn rows_mut(&mut self) -> &mut [Row] {
        &mut self.rows
    }

    /// The rows, by first surface.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// The pairs, in order.
    pub fn iter(&self) -> impl Iterator<Item = (usize, usize)> {
        self.rows.iter().flat_map(|row| row.iter().map(move |second| (row.first, second)))
    }
}

impl Row {
    /// The smaller surface of its pairs.
    pub fn first(&self) -> usize {
        self.first
    }

    /// The partners, in order.
    pub fn iter(&self) -> impl Iterator<Item = usize> {
        let base = self.first + 1;
        self.words.iter().enumerate().flat_map(move |(index, &word)| bits(word).map(move |bit| base + 64 * index + bit))
    }

    /// Keeps the partners for which `keep` says so, asked in order.
    pub fn retain(&mut self, mut keep: impl FnMut(usize) -> bool) {
        let base = self.first + 1;
        for (index, word) in self.words.iter_mut().enumerate() {
            for bit in bits(*word) {
                if !keep(base + 64 * index + bit) {
                    *word &= !(1 << bit);
                }
            }
        }
    }
}

/// The positions of the bits that are set.
fn bits(word: u64) -> impl Iterator<Item = usize> {
    std::iter::successors(Some(word), |rest| Some(rest & rest.wrapping_sub(1)))
        .take_while(|&rest| rest != 0)
        .map(|rest| rest.trailing_zeros() as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_pairs_once_and_those_that_are_kept() {
        for count in [1, 2, 64, 65, 66, 130] {
            let mut pairs = PairSet::all(count, &|| false).unwrap();
            let all: Vec<(usize, usize)> = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b))).collect();
            assert_eq!(pairs.iter().collect::<Vec<_>>(), all);
            for row in pairs.rows_mut() {
                let first = row.first();
                row.retain(|second| (first + second).is_multiple_of(3));
            }
            let kept: Vec<(usize, usize)> = all.iter().copied().filter(|(a, b)| (a + b).is_multiple_of(3)).collect();
            assert_eq!(pairs.iter().collect::<Vec<_>>(), kept);

            // What was left out comes back in.
            all.iter().for_each(|&(first, second)| pairs.insert(first, second));
            assert_eq!(Some(pairs), PairSet::all(count, &|| false));
        }
    }
}
