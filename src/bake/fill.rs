//! Texels that nothing covers, and the padding around charts: filled from the chart's own texels, ring after ring.
//!
//! A texture filter mixes a texel with its neighbours, and a coarser level of the texture mixes more of them. So what is beside a chart's light must be
//! its own light, spread outwards, and neither black nor another chart's.

/// A rectangle of texels, padding included.
pub(super) struct Canvas {
    pub width: usize,
    pub channels: usize,
    /// By texel and channel; NaN where nothing is known.
    pub numbers: Vec<f32>,
}

impl Canvas {
    /// Nothing is known of it yet.
    pub fn new([width, height]: [usize; 2], channels: usize) -> Self {
        Self { width, channels, numbers: vec![f32::NAN; width * height * channels] }
    }

    /// Gives every texel that has no value the mean of its neighbours that have one, as often as it takes; 0 if none has.
    pub fn fill(&mut self) {
        let count = self.numbers.len() / self.channels;
        let is_known = |numbers: &[f32], texel: usize| !numbers[texel * self.channels].is_nan();
        let unknown = (0..count).filter(|&texel| !is_known(&self.numbers, texel));
        let mut ring: Vec<usize> =
            unknown.filter(|&texel| self.neighbours(texel).any(|other| is_known(&self.numbers, other))).collect();
        if ring.is_empty() && !is_known(&self.numbers, 0) {
            self.numbers.fill(0.0);
            return;
        }

        // The ring beside what is known, all of it from what was known before.
        while !ring.is_empty() {
            let mean = |&texel: &usize| -> Vec<f32> {
                let known: Vec<usize> = self.neighbours(texel).filter(|&other| is_known(&self.numbers, other)).collect();
                let sum = |channel: usize| known.iter().map(|&other| self.numbers[other * self.channels + channel]).sum::<f32>();
                (0..self.channels).map(|channel| sum(channel) / known.len() as f32).collect()
            };
            let means: Vec<Vec<f32>> = ring.iter().map(mean).collect();
            for (&texel, mean) in ring.iter().zip(&means) {
                self.numbers[texel * self.channels..][..self.channels].copy_from_slice(mean);
            }
            let beside = ring.iter().flat_map(|&texel| self.neighbours(texel));
            let mut next: Vec<usize> = beside.filter(|&texel| !is_known(&self.numbers, texel)).collect();
            next.sort_unstable();
            next.dedup();
            ring = next;
        }
    }

    /// The eight texels around one.
    fn neighbours(&self, texel: usize) -> impl Iterator<Item = usize> + use<> {
        let (width, height) = (self.width as isize, (self.numbers.len() / self.channels / self.width) as isize);
        let (column, row) = (texel as isize % width, texel as isize / width);
        (-1..=1).flat_map(move |down| (-1..=1).map(move |aside| (column + aside, row + down))).filter_map(move |(x, y)| {
            let is_other = (x, y) != (column, row) && (0..width).contains(&x) && (0..height).contains(&y);
            is_other.then_some((y * width + x) as usize)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_spreads_in_rings_and_stays_within_what_was_there() {
        let mut canvas = Canvas::new([5, 3], 2);
        canvas.numbers[2 * 5..2 * 5 + 2].copy_from_slice(&[1.0, 10.0]);
        canvas.numbers[2 * 9..2 * 9 + 2].copy_from_slice(&[3.0, 30.0]);
        canvas.fill();
        let of = |texel: usize| canvas.numbers[2 * texel..][..2].to_vec();
        assert_eq!([of(0), of(4), of(7)], [vec![1.0, 10.0], vec![3.0, 30.0], vec![2.0, 20.0]]);
        assert!(canvas.numbers.chunks(2).all(|pair| (1.0..=3.0).contains(&pair[0]) && (pair[1] - 10.0 * pair[0]).abs() < 1e-5));
    }

    #[test]
    fn what_is_wholly_hidden_is_black() {
        let mut canvas = Canvas::new([4, 4], 1);
        canvas.fill();
        assert_eq!(canvas.numbers, [0.0; 16]);
    }
}
