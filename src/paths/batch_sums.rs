//! Irradiances as sums over batches of their samples: how these scatter tells the variance of the whole (the method of batch means).

/// How many batches tell the variance of a value: its standard error is then known to a fifth. At most as many as a value has rays.
pub(crate) const BATCHES: u32 = 16;

/// Irradiances at places, as sums over batches of samples.
pub(crate) struct BatchSums<'m> {
    channels: usize,
    batches: usize,
    /// By place, batch and channel, in W/m^2.
    sums: &'m mut [f64],
    /// By place and channel, in W^2/m^4: the sum over cells of the squares of what each brings. Empty where nobody asks.
    by_cells_sq: &'m mut [f64],
    /// By place and channel, in W/m^2: what of the sums emitters send straight. Empty where nobody asks.
    straight: &'m mut [f64],
}

impl<'m> BatchSums<'m> {
    pub fn new(channels: usize, batches: u32, sums: &'m mut [f64], by_cells_sq: &'m mut [f64]) -> Self {
        Self { channels, batches: batches as usize, sums, by_cells_sq, straight: &mut [] }
    }

    /// The same, which notes by place and channel what of the sums emitters send straight.
    pub fn with_straight(self, straight: &'m mut [f64]) -> Self {
        Self { straight, ..self }
    }

    /// A single batch: `sums` is by place and channel.
    pub fn whole(channels: usize, sums: &'m mut [f64]) -> Self {
        Self::new(channels, 1, sums, &mut [])
    }

    /// The sum of a batch at a place, by channel.
    pub fn of(&mut self, place: usize, batch: usize) -> &mut [f64] {
        &mut self.sums[(place * self.batches + batch) * self.channels..][..self.channels]
    }

    /// The sum to which sample `number` belongs if batches take samples in turn, by channel.
    pub fn in_turn(&mut self, place: usize, number: usize) -> &mut [f64] {
        self.of(place, number % self.batches)
    }

    /// The same if each batch takes a run of the `count` samples.
    pub fn in_runs(&mut self, place: usize, number: usize, count: usize) -> &mut [f64] {
        self.of(place, number * self.batches / count)
    }

    /// Channels of each sum.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Adds what is known with its variance to the sums of a place in a channel: spread over the batches so that they scatter as that variance
    /// says.
    pub fn add(&mut self, place: usize, channel: usize, irradiance: f64, variance: f64) {
        // Half of the batches get more than the mean, and as many less; of an odd number one gets the mean.
        let count = self.batches as f64;
        let pairs = self.batches / 2;
        let off = if pairs > 0 { (variance * (count - 1.0) / (count * 2.0 * pairs as f64)).sqrt() } else { 0.0 };
        for batch in 0..self.batches {
            let sign = if batch >= 2 * pairs { 0.0 } else { 1.0 - 2.0 * (batch % 2) as f64 };
            self.of(place, batch)[channel] += irradiance / count + sign * off;
        }
    }

    /// The squares of what cells bring to a place, by channel; `None` where nobody asks.
    pub fn by_cells_sq(&mut self, place: usize) -> Option<&mut [f64]> {
        self.by_cells_sq.get_mut(place * self.channels..(place + 1) * self.channels)
    }

    /// What emitters send straight to a place, by channel; `None` where nobody asks.
    pub fn straight(&mut self, place: usize) -> Option<&mut [f64]> {
        self.straight.get_mut(place * self.channels..(place + 1) * self.channels)
    }

    /// All that there is so far was sent straight.
    pub fn note_straight(&mut self) {
        let of_place = self.batches * self.channels;
        for (straight, sums) in self.straight.chunks_mut(self.channels).zip(self.sums.chunks(of_place)) {
            for (channel, straight) in straight.iter_mut().enumerate() {
                *straight = sums.iter().skip(channel).step_by(self.channels).sum();
            }
        }
    }

    /// The sums of so many places after the others.
    pub fn chunks(&mut self, places: usize) -> impl Iterator<Item = BatchSums<'_>> {
        let Self { channels, batches, .. } = *self;
        let mut by_cells_sq = self.by_cells_sq.chunks_mut(places * channels);
        let mut straight = self.straight.chunks_mut(places * channels);
        let sums = self.sums.chunks_mut(places * batches * channels);
        sums.map(move |sums| BatchSums {
            channels,
            batches,
            sums,
            by_cells_sq: by_cells_sq.next().unwrap_or_default(),
            straight: straight.next().unwrap_or_default(),
        })
    }

    /// The sum over all batches at a place in a channel, and its variance: exact for independent samples, too large where they are spread
    /// evenly. Infinite from a single batch.
    pub fn sum_and_variance(&self, place: usize, channel: usize) -> (f64, f64) {
        let own = &self.sums[place * self.batches * self.channels..][..self.batches * self.channels];
        let batches = || own.iter().skip(channel).step_by(self.channels);
        let (sum, count) = (batches().sum::<f64>(), self.batches as f64);
        let scatter: f64 = batches().map(|batch| (batch - sum / count).powi(2)).sum();
        (sum, if self.batches > 1 { scatter * count / (count - 1.0) } else { f64::INFINITY })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::sampling;

    #[test]
    fn what_is_known_with_its_variance_scatters_as_that_says() {
        for batches in [2, 3, 4, 7, 16] {
            let mut memory = [0.0; 2 * 2 * 16];
            let mut sums = BatchSums::new(2, batches, &mut memory, &mut []);
            sums.add(1, 0, 3.0, 0.25);
            let (sum, variance) = sums.sum_and_variance(1, 0);
            assert!((sum - 3.0).abs() < 1e-14 && (variance - 0.25).abs() < 1e-14, "{batches} batches: {sum}, {variance}");
            assert_eq!((sums.sum_and_variance(1, 1), sums.sum_and_variance(0, 0)), ((0.0, 0.0), (0.0, 0.0)));
        }
    }

    /// Sums of independent samples scatter as batches say, in turn or in runs.
    #[test]
    fn batches_tell_the_variance_of_their_sum() {
        let (trials, count) = (20_000_u64, 64);
        let mut told = [0.0; 2];
        let (mut total, mut total_sq) = (0.0, 0.0);
        for trial in 0..trials {
            let mut memory = [[0.0; 2 * 8]; 2];
            let [first, second] = &mut memory;
            let (mut turns, mut runs) = (BatchSums::new(2, 8, first, &mut []), BatchSums::new(2, 8, second, &mut []));
            for number in 0..count {
                let sample = sampling::unit(sampling::hash(trial, number as u64));
                turns.in_turn(0, number)[1] += sample;
                runs.in_runs(0, number, count)[1] += sample;
            }
            let (sum, variance) = turns.sum_and_variance(0, 1);
            told = [told[0] + variance, told[1] + runs.sum_and_variance(0, 1).1];
            (total, total_sq) = (total + sum, total_sq + sum * sum);
            assert_eq!(turns.sum_and_variance(0, 0), (0.0, 0.0));
        }
        let n = trials as f64;
        let variance = total_sq / n - (total / n).powi(2);
        // 64 uniform samples have a variance of 64 / 12; 20,000 trials tell it to 1%.
        assert!((variance / (64.0 / 12.0) - 1.0).abs() < 0.04, "{variance}");
        assert!(told.iter().all(|told| (told / n / variance - 1.0).abs() < 0.05), "{told:?} for {variance}");
    }
}
