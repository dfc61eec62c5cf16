//! Random numbers that depend on ids alone, never on threads: counter-based hashing and Owen-scrambled Sobol points.

use std::sync::LazyLock;

use glam::DVec3;

use super::streams;

/// A hash of two numbers (the finalizer of SplitMix64: Steele, Lea, Flood 2014).
pub(crate) fn hash(a: u64, b: u64) -> u64 {
    let mut z = a.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ b.wrapping_add(0x6a09_e667_f3bc_c909);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A seed that depends on a point and `seed` alone.
pub(crate) fn seed_at(point: DVec3, seed: u64) -> u64 {
    point.to_array().iter().fold(seed, |seed, coordinate| hash(seed, coordinate.to_bits()))
}

/// A uniform number in [0, 1) from a hash.
pub(crate) fn unit(hash: u64) -> f64 {
    (hash >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

/// The first points of one Owen-scrambled Sobol sequence in two dimensions, as numbers of [`SHIFT_BITS`] bits.
static SOBOL_2D: LazyLock<Box<[[u32; 2]]>> = LazyLock::new(|| {
    let bits = |part: f64| (part * f64::from(1_u32 << SHIFT_BITS)) as u32;
    (0..SOBOL_2D_POINTS)
        .map(|index| {
            let [u, v, ..] = sobol_4d(index, 0);
            [bits(u), bits(v)]
        })
        .collect()
});

/// Points of the sequence; those after them have another shift.
pub(crate) const SOBOL_2D_POINTS: u32 = 1 << 13;

const SHIFT_BITS: u32 = 24;

/// The place of a cell on the Morton curve (Morton 1966) through a square of 2^16 columns and rows: it goes through one quarter
/// after the other, and so on in each.
pub(crate) fn along_curve(column: u32, row: u32) -> u32 {
    let interleaved = |mut bits: u32| {
        bits &= 0xffff;
        for (shift, mask) in [(8, 0x00ff_00ff), (4, 0x0f0f_0f0f), (2, 0x3333_3333), (1, 0x5555_5555)] {
            bits = (bits | bits << shift) & mask;
        }
        bits
    };
    interleaved(column) | interleaved(row) << 1
}

/// Points `0..` of an Owen-scrambled Sobol sequence in two dimensions, by index. `seed` picks random bits that all points are
/// shifted by (a digital shift): each point is uniform in the unit square, and together they are as evenly spread as the sequence.
/// Cheaper than a scrambling for each seed. After [`SOBOL_2D_POINTS`] the sequence begins anew with other bits.
pub(crate) fn shifted_sobol_2d(seed: u64) -> impl Fn(u32) -> [f64; 2] {
    let points = &**SOBOL_2D;
    let bits = |seed: u64| [seed, seed >> 32].map(|part| hash(part, streams::SOBOL_SHIFT) as u32 & ((1 << SHIFT_BITS) - 1));
    let first = bits(seed);
    move |index| {
        let (block, within) = (index / SOBOL_2D_POINTS, index % SOBOL_2D_POINTS);
        let shift = if block == 0 { first } else { bits(hash(seed, streams::SOBOL_BLOCK + u64::from(block))) };
        let point = points[within as usize];
        [0, 1].map(|axis: usize| (f64::from(point[axis] ^ shift[axis]) + 0.5) / f64::from(1_u32 << SHIFT_BITS))
    }
}

/// The indices below `count` in an order in which successive points of [`shifted_sobol_2d`] are near each other, whatever the seed:
/// a ray costs less after one of nearly the same direction.
pub(crate) fn neighbours_in_order(count: u32) -> Vec<u32> {
    // Along the Morton curve: a digital shift moves quarters of the square as a whole.
    let points = &**SOBOL_2D;
    let place_on_curve = |index: &u32| {
        let [u, v] = points[(index % SOBOL_2D_POINTS) as usize];
        let code =
            (0..SHIFT_BITS).rev().fold(0_u64, |code, bit| code << 2 | u64::from(u >> bit & 1) << 1 | u64::from(v >> bit & 1));
        (index / SOBOL_2D_POINTS, code)
    };
    let mut order: Vec<u32> = (0..count).collect();
    order.sort_by_cached_key(place_on_curve);
    order
}

/// Point `index` of an Owen-scrambled Sobol sequence in four dimensions (Burley 2020); `seed` picks the scrambling.
///
/// Indices repeat after 2^16.
pub(crate) fn sobol_4d(index: u32, seed: u64) -> [f64; 4] {
    let point: [f32; 4] = sobol_burley::sample_4d(index & 0xffff, 0, seed as u32 ^ (seed >> 32) as u32);
    point.map(f64::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_goes_through_one_quarter_after_the_other() {
        assert_eq!([[2, 2], [3, 2], [2, 3], [3, 3]].map(|[column, row]| along_curve(column, row)), [12, 13, 14, 15]);
        assert_eq!(along_curve(65535, 65535), u32::MAX);
    }

    /// Sums over more points than the sequence has are as good as their number says: none comes twice.
    #[test]
    fn longer_sequences_do_not_repeat() {
        let sobol = shifted_sobol_2d(5);
        let mut points: Vec<[u64; 2]> = (0..4 * SOBOL_2D_POINTS).map(|index| sobol(index).map(f64::to_bits)).collect();
        points.sort_unstable();
        points.dedup();
        assert_eq!(points.len(), 4 * SOBOL_2D_POINTS as usize);
        let order = neighbours_in_order(2 * SOBOL_2D_POINTS);
        let (first, second) = order.split_at(SOBOL_2D_POINTS as usize);
        assert!(first.iter().zip(second).all(|(one, other)| one + SOBOL_2D_POINTS == *other));
    }

    #[test]
    fn every_eight_neighbours_share_a_part_of_the_square_whatever_the_seed() {
        let count = 256;
        let order = neighbours_in_order(count);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..count));
        for seed in 0..20 {
            let sobol = shifted_sobol_2d(hash(seed, 0));
            for eight in order.chunks(8) {
                // 256 points by eights are 32 boxes, an eighth by a quarter of the square each.
                let cells = eight.iter().map(|&index| sobol(index)).map(|[u, v]| ((u * 8.0) as u32, (v * 4.0) as u32));
                let cells: std::collections::HashSet<_> = cells.collect();
                assert_eq!(cells.len(), 1, "seed {seed}: {cells:?}");
            }
        }
    }
}
