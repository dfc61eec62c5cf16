//! Random numbers that depend on ids alone, never on threads: counter-based hashing and Owen-scrambled Sobol points.

/// A hash of two numbers (the finalizer of SplitMix64: Steele, Lea, Flood 2014).
pub(crate) fn hash(a: u64, b: u64) -> u64 {
    let mut z = a.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ b.wrapping_add(0x6a09_e667_f3bc_c909);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A uniform number in [0, 1) from a hash.
pub(crate) fn unit(hash: u64) -> f64 {
    (hash >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

/// Point `index` of an Owen-scrambled Sobol sequence in four dimensions (Burley 2020); `seed` picks the scrambling.
///
/// Indices repeat after 2^16.
pub(crate) fn sobol_4d(index: u32, seed: u64) -> [f64; 4] {
    let point: [f32; 4] = sobol_burley::sample_4d(index & 0xffff, 0, seed as u32 ^ (seed >> 32) as u32);
    point.map(f64::from)
}
