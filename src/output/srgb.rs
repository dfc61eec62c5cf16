//! The sRGB transfer function (IEC 61966-2-1).

/// Linear light in [0, 1] to 8 bits, rounded.
pub(super) fn encode_srgb(linear: f32) -> u8 {
    let encoded = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (255.0 * encoded.clamp(0.0, 1.0)).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_agrees_with_the_standard_at_its_landmarks() {
        assert_eq!([0.0, 1.0, 0.5, 0.18, 0.002].map(encode_srgb), [0, 255, 188, 118, 7]);
    }
}
