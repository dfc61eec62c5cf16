//! The colour of a black body.
//!
//! Its chromaticity by the cubic splines of Kang, Moon, Hong, Lee, Cho and Kim, "Design of advanced color temperature control system for HDTV
//! applications", Journal of the Korean Physical Society 41(6), 2002, equations 9 and 10, which are within some 0.001 of it. What lies outside of the colours
//! of Rec. 709, below 1900 K, has its blue raised to 0.

/// Temperatures that the splines are for.
pub(super) const LOWEST: f64 = 1667.0;
pub(super) const HIGHEST: f64 = 25000.0;

/// From CIE XYZ to linear Rec. 709, by its primaries and white (ITU-R BT.709-6, table 1).
const TO_REC709: [[f64; 3]; 3] = [
    [3.240_969_941_904_521_3, -1.537_383_177_570_093_5, -0.498_610_760_293_003_3],
    [-0.969_243_636_280_879_8, 1.875_967_501_507_720_6, 0.041_555_057_407_175_6],
    [0.055_630_079_696_993_6, -0.203_976_958_888_976_5, 1.056_971_514_242_878_4],
];

/// The colour at a temperature in K, in linear Rec. 709, of luminance 1 but for what is raised to 0.
pub(super) fn colour(kelvin: f64) -> [f64; 3] {
    let [x, y] = chromaticity(kelvin);
    let xyz = [x / y, 1.0, (1.0 - x - y) / y];
    TO_REC709.map(|row| row.iter().zip(xyz).map(|(factor, value)| factor * value).sum::<f64>().max(0.0))
}

fn chromaticity(kelvin: f64) -> [f64; 2] {
    let t = 1e3 / kelvin;
    let x = if kelvin <= 4000.0 {
        cubic(t, [-0.266_123_9, -0.234_358_0, 0.877_695_6, 0.179_910])
    } else {
        cubic(t, [-3.025_846_9, 2.107_037_9, 0.222_634_7, 0.240_390])
    };
    let y = match kelvin {
        _ if kelvin <= 2222.0 => cubic(x, [-1.106_381_4, -1.348_110_20, 2.185_558_32, -0.202_196_83]),
        _ if kelvin <= 4000.0 => cubic(x, [-0.954_947_6, -1.374_185_93, 2.091_370_15, -0.167_488_67]),
        _ => cubic(x, [3.081_758_0, -5.873_386_70, 3.751_129_97, -0.370_014_83]),
    };
    [x, y]
}

fn cubic(x: f64, [a, b, c, d]: [f64; 4]) -> f64 {
    ((a * x + b) * x + c) * x + d
}

#[cfg(test)]
mod tests {
    use super::*;

    /// CIE standard illuminant A is a black body of 2856 K (CIE 015:2018, table T.3); the others are points of the Planckian locus (Wyszecki and Stiles, Color
    /// Science, table 1(3.11)).
    #[test]
    fn colours_lie_on_the_planckian_locus() {
        for (kelvin, x, y) in
            [(2000.0, 0.5267, 0.4133), (2856.0, 0.4476, 0.4074), (5000.0, 0.3451, 0.3516), (10_000.0, 0.2807, 0.2884)]
        {
            let found = chromaticity(kelvin);
            assert!((found[0] - x).abs() < 1.5e-3 && (found[1] - y).abs() < 1.5e-3, "{kelvin}: {found:?}");
        }
    }

    #[test]
    fn warm_light_is_red_and_white_is_even() {
        let [r, g, b] = colour(2700.0);
        assert!(r > g && g > b && b > 0.0);
        assert!(colour(6500.0).iter().all(|channel| (channel - 1.0).abs() < 0.05));
        assert_eq!(colour(LOWEST)[2], 0.0);
        let luminance = crate::scene::luminance(&colour(4000.0)).unwrap();
        assert!((luminance - 1.0).abs() < 1e-3);
    }
}
