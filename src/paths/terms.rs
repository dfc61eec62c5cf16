//! Rows of terms: sums that are linear in radiosities and emission, and made of products of reflectances.

use serde::{Deserialize, Serialize};

/// A term of a row while rows are recorded.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowTerm {
    pub row: u32,
    pub product: u32,
    pub source: u32,
    pub weight: f64,
}

/// Rows of terms `weight * product * source`, see [`Products`](super::Products).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Terms {
    /// By row: where its terms end.
    ends: Vec<u32>,
    product: Vec<u32>,
    source: Vec<u32>,
    weight: Vec<f32>,
}

impl Terms {
    /// Ends as many rows as it takes to have `rows`; terms are pushed to the one after these.
    pub fn end_rows(&mut self, rows: usize) {
        self.ends.resize(rows, self.weight.len() as u32);
    }

    /// Adds a term to the row after those that have ended.
    pub fn push(&mut self, product: u32, source: u32, weight: f64) {
        self.product.push(product);
        self.source.push(source);
        self.weight.push(weight as f32);
    }

    /// Adds `rows` rows; `terms` are theirs, with rows counted from 0, and products get the numbers that `numbers` says. Terms of a row that differ in
    /// weight alone become one.
    pub fn append(&mut self, rows: usize, terms: &mut [RowTerm], numbers: &[u32]) {
        let first = self.ends.len();
        terms.iter_mut().for_each(|term| term.product = numbers[term.product as usize]);
        let what = |term: &RowTerm| (term.row, term.product, term.source);
        terms.sort_by_key(what);
        for alike in terms.chunk_by(|a, b| what(a) == what(b)) {
            self.end_rows(first + alike[0].row as usize);
            self.push(alike[0].product, alike[0].source, alike.iter().map(|term| term.weight).sum());
        }
        self.end_rows(first + rows);
    }

    /// The terms of a row: product, source and weight.
    pub fn row(&self, row: usize) -> impl Iterator<Item = (u32, u32, f32)> + '_ {
        let own = row.checked_sub(1).map_or(0, |before| self.ends[before] as usize)..self.ends[row] as usize;
        let terms = self.product[own.clone()].iter().zip(&self.source[own.clone()]).zip(&self.weight[own]);
        terms.map(|((&product, &source), &weight)| (product, source, weight))
    }

    /// Adds a row to sums by channel; `products` and `sources` are by number and channel.
    pub fn add_row(&self, row: usize, products: &[f64], sources: &[f64], sums: &mut [f64]) {
        let channels = sums.len();
        for (product, source, weight) in self.row(row) {
            let product = &products[product as usize * channels..][..channels];
            let source = &sources[source as usize * channels..][..channels];
            let brought = product.iter().zip(source);
            sums.iter_mut().zip(brought).for_each(|(sum, (product, source))| *sum += f64::from(weight) * product * source);
        }
    }

    /// How many terms there are.
    pub fn len(&self) -> usize {
        self.weight.len()
    }

    /// Bytes that they take.
    pub fn memory_bytes(&self) -> u64 {
        (size_of_val(&*self.ends) + self.weight.len() * (2 * size_of::<u32>() + size_of::<f32>())) as u64
    }

    /// Whether there are so many rows, of so many products and sources, and all weights are finite.
    pub fn are_valid(&self, rows: usize, products: usize, sources: usize) -> bool {
        let terms = self.weight.len();
        self.ends.len() == rows
            && self.product.len() == terms
            && self.source.len() == terms
            && self.ends.is_sorted()
            && self.ends.last().map_or(0, |&end| end as usize) == terms
            && self.product.iter().all(|&product| (product as usize) < products)
            && self.source.iter().all(|&source| (source as usize) < sources)
            && self.weight.iter().all(|weight| weight.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_add_up_whatever_the_order_in_which_terms_came() {
        let mut terms = Terms::default();
        let term = |row, product, source, weight| RowTerm { row, product, source, weight };
        terms.append(3, &mut [term(2, 1, 0, 4.0), term(0, 0, 1, 0.5), term(2, 0, 1, 1.0)], &[0, 1]);
        // Of the second trail both products are the first one here, so that these are one term.
        terms.append(1, &mut [term(0, 1, 1, 1.5), term(0, 0, 1, 0.5)], &[0, 0]);
        assert_eq!(terms.len(), 4);
        assert!(terms.are_valid(4, 2, 2) && !terms.are_valid(4, 1, 2) && !terms.are_valid(4, 2, 1) && !terms.are_valid(3, 2, 2));
        let (products, sources) = ([1.0, 1.0, 0.5, 0.25], [3.0, 5.0, 7.0, 11.0]);
        let row = |row| {
            let mut sums = [0.0; 2];
            terms.add_row(row, &products, &sources, &mut sums);
            sums
        };
        assert_eq!([row(0), row(1), row(2), row(3)], [[3.5, 5.5], [0.0; 2], [13.0, 16.0], [14.0, 22.0]]);
    }
}
