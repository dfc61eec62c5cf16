//! The order in which pixels are taken where time may end before all are: those of a coarse grid first, then of finer ones.

/// The first grid has at most so many pixels: some hundredths of a second.
const FIRST_PIXELS: u64 = 1024;

/// Grids of pixels, each with half the spacing of the one before.
#[derive(Clone, Copy)]
pub(super) struct CoarseToFine {
    size: [u32; 2],
    first: u32,
}

impl CoarseToFine {
    /// All pixels at once.
    pub fn at_once(size: [u32; 2]) -> Self {
        Self { size, first: 1 }
    }

    /// From a grid of few pixels on.
    pub fn from_few(size: [u32; 2]) -> Self {
        let pixels_of = |step: u32| size.iter().map(|side| u64::from(side.div_ceil(step))).product::<u64>();
        let mut first = 1;
        while pixels_of(first) > FIRST_PIXELS {
            first *= 2;
        }
        Self { size, first }
    }

    /// The spacings of the grids, in pixels, in their order. Each grid holds those before it.
    pub fn steps(self) -> impl Iterator<Item = u32> {
        std::iter::successors(Some(self.first), |step| (*step > 1).then_some(step / 2))
    }

    /// Visits pixels that were not done, each with the one that is shown in its place: that of the finest grid that was. All of the first grid must be done.
    pub fn for_each_missing(self, is_done: &[bool], mut visit: impl FnMut(usize, usize)) {
        let width = self.size[0] as usize;
        for missing in (0..is_done.len()).filter(|&pixel| !is_done[pixel]) {
            let (column, row) = (missing % width, missing / width);
            let on_grid = |step: usize| (row - row % step) * width + column - column % step;
            let mut step = 2;
            while step < self.first as usize && !is_done[on_grid(step)] {
                step *= 2;
            }
            visit(missing, on_grid(step));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grids_begin_with_few_pixels_and_hold_those_before() {
        assert!(CoarseToFine::at_once([960, 720]).steps().eq([1]));
        assert!(CoarseToFine::from_few([32, 32]).steps().eq([1]));
        assert!(CoarseToFine::from_few([960, 720]).steps().eq([32, 16, 8, 4, 2, 1]));
        assert!(CoarseToFine::from_few([100_000, 1]).steps().eq([128, 64, 32, 16, 8, 4, 2, 1]));
    }

    #[test]
    fn what_is_missing_shows_the_finest_grid_that_is_done() {
        let grids = CoarseToFine { size: [8, 4], first: 4 };
        // The first grid, and one pixel of the next.
        let mut is_done = [false; 32];
        [0, 4, 18].into_iter().for_each(|pixel| is_done[pixel] = true);
        let mut shown = [u32::MAX; 32];
        grids.for_each_missing(&is_done, |missing, instead| shown[missing] = instead as u32);
        assert_eq!(shown.iter().filter(|&&pixel| pixel == u32::MAX).count(), 3);
        assert_eq!([shown[1], shown[3], shown[7], shown[31]], [0, 0, 4, 4]);
        assert_eq!([shown[19], shown[26], shown[27], shown[10]], [18, 18, 18, 0]);
    }
}
