//! How many claims may fail.

/// Of so many claims, each true with probability 0.977, more than `most_failures` fail with a probability below 0.002.
pub fn most_failures(claims: usize) -> usize {
    let p = 1.0 - 0.977f64;
    let (mut term, mut below, mut k) = ((1.0 - p).powi(claims as i32), 0.0, 0);
    loop {
        below += term;
        if 1.0 - below < 0.002 {
            return k;
        }
        term *= (claims - k) as f64 / (k + 1) as f64 * p / (1.0 - p);
        k += 1;
    }
}
