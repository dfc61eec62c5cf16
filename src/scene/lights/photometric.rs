//! From what an eye sees of light to watts, and back.

/// The luminous efficacy of white light of equal energy over the visible wavelengths, in lm/W: by it lighting programs turn radiometric colours into
/// photometric units (Radiance's `WHTEFFICACY`, `src/common/color.h`; Ward Larson and Shakespeare 1998). Inputs that are in other units, such as
/// lamps whose `Ke` is not in W/m^2/sr of visible light, make other numbers than lux of it.
pub const LUMENS_PER_WATT: f64 = 179.0;

/// The luminance of a colour: of linear Rec. 709, or grey. `None` of spectral bands, of which it is not known what an eye sees.
pub(crate) fn luminance(channels: &[f64]) -> Option<f64> {
    match *channels {
        [grey] => Some(grey),
        [r, g, b] => Some(0.2126 * r + 0.7152 * g + 0.0722 * b),
        _ => None,
    }
}
