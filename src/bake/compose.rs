//! Pages that a file lays out: charts lie beside each other without padding, and may share texels.
//!
//! A texel is that of the chart that covers most of it; one on which something stands comes after all that have a value. Then the page is filled outwards,
//! ring after ring, each texel from neighbours of one chart.

use super::atlas::Placed;
use super::fill::Canvas;
use super::texels::Texels;

/// Of a texel that no chart has.
pub(super) const NO_CHART: u32 = u32::MAX;

/// A page in numbers, and the chart of each texel.
pub(super) struct Page {
    pub numbers: Vec<f32>,
    pub chart: Vec<u32>,
}

/// Puts charts with their canvases, which have no padding, on a page of `size` with so many numbers for each texel, and fills so many rings.
pub(super) fn compose(size: [u32; 2], placed: &[Placed], texels: &[Texels<'_>], canvases: &[Canvas], rings: u32) -> Page {
    let [width, height] = size.map(|side| side as usize);
    let count = canvases.first().map_or(1, |canvas| canvas.channels);
    let mut page = Page { numbers: vec![0.0; width * height * count], chart: vec![NO_CHART; width * height] };
    let mut best = vec![0.0_f32; width * height];
    for (number, ((placed, texels), canvas)) in placed.iter().zip(texels).zip(canvases).enumerate() {
        let columns = texels.columns();
        for (index, site) in texels.sites.iter().enumerate() {
            let (column, row) = (placed.at[0] as usize + index % columns, placed.at[1] as usize + index / columns);
            let worth = site.covered + if site.is_covered() { 1.0 } else { 0.0 };
            if column < width && row < height && worth > best[row * width + column] {
                let texel = row * width + column;
                (best[texel], page.chart[texel]) = (worth, number as u32);
                page.numbers[texel * count..][..count].copy_from_slice(&canvas.numbers[index * count..][..count]);
            }
        }
    }
    (0..rings).for_each(|_| page.fill_ring([width, height], count));
    page
}

impl Page {
    /// Gives texels beside those of charts the mean of their neighbours of one chart, the first of them.
    fn fill_ring(&mut self, [width, height]: [usize; 2], count: usize) {
        let mut ring: Vec<(usize, u32, Vec<f32>)> = Vec::new();
        for texel in (0..self.chart.len()).filter(|&texel| self.chart[texel] == NO_CHART) {
            let (column, row) = (texel % width, texel / width);
            let columns = column.saturating_sub(1)..=(column + 1).min(width - 1);
            let rows = row.saturating_sub(1)..=(row + 1).min(height - 1);
            let around = || rows.clone().flat_map(|y| columns.clone().map(move |x| y * width + x));
            let Some(first) = around().map(|other| self.chart[other]).find(|&chart| chart != NO_CHART) else { continue };
            let same: Vec<usize> = around().filter(|&other| self.chart[other] == first).collect();
            let sum = |k: usize| same.iter().map(|&other| self.numbers[other * count + k]).sum::<f32>();
            ring.push((texel, first, (0..count).map(|k| sum(k) / same.len() as f32).collect()));
        }
        for (texel, chart, mean) in ring {
            self.chart[texel] = chart;
            self.numbers[texel * count..][..count].copy_from_slice(&mean);
        }
    }
}
