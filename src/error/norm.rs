//! The norms in which errors are told: by energy, and locally.
//!
//! ```text
//! energy:  ||B~ - B|| / ||B - E||, root mean squares over all area
//! local:   root mean square over the lit area of |B~ - B| / max(|B - E|, m), m the median of |B - E| over the lit area
//! ```
//!
//! channels pooled in both. By energy a small bright place outweighs all others. The local norm is relative to the light at each place, and
//! to typical light where it is darker. What counts as the light at a point is the value there, as far as replicates do not contradict it; differences of two
//! values that are far apart are relative to the smaller: where a rare path makes one of them bright, it would else be told relative to itself. A point is
//! lit if that is more than what roundings let through, or if light comes there by paths too rare for values and replicates (`dark`).

/// In which norm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ErrorNorm {
    Energy,
    Local,
}

/// Less light than this part of the mean over all area is none: corners have the digits of a file, so slivers of what stands beside a surface lie in
/// front of it and light it by their width. If dark area counted as lit, the local norm would be too small by the root of its part.
const NONE: f64 = 1e-9;

/// The median light may be as little as so many standard deviations of the area below it leave open: 97.7% to one side, where the confidence of claims is
/// 97.5%.
pub(super) const MEDIAN_SIGMAS: f64 = 2.0;

/// A point as norms see it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lit {
    /// The area that it stands for, in m^2.
    pub area: f64,
    /// |B - E|, in W/m^2.
    pub light: f64,
    /// The same, but by the smaller of two values that are far apart: what differences are relative to.
    pub by_smaller: f64,
    /// An estimate of its square without bias, which may be negative.
    pub light_sq: f64,
    /// Whether light comes there, however little.
    pub is_reached: bool,
    /// Light that values and replicates do not find, in W/m^2.
    pub missed: f64,
}

impl Lit {
    /// A point with so much light, in W/m^2, that is known for sure.
    pub fn of(area: f64, light: f64) -> Self {
        Self { area, light, by_smaller: light, light_sq: light * light, is_reached: false, missed: 0.0 }
    }

    /// The light that is known to be there, in W/m^2.
    fn known(&self) -> f64 {
        self.light.max(self.missed)
    }
}

/// What squares of differences at points count: a factor for each, in m^4/W^2 per m^2 of its area, by which the sum is relative.
pub(super) struct NormWeights {
    /// By point, times its area.
    pub by_point: Vec<f64>,
    /// By point, so many times as much it would count if the median light were as little as it may be. Where half of the area is bright and half is dim
    /// the median lies between both, and hangs on a few points.
    pub if_dimmer: Vec<f64>,
}

impl NormWeights {
    /// `None` if no light is reflected, or too little is known of it.
    pub fn new(norm: ErrorNorm, points: &[Lit]) -> Option<Self> {
        let (by_point, if_dimmer): (Vec<f64>, Vec<f64>) = match norm {
            ErrorNorm::Energy => {
                let all: f64 = points.iter().map(|point| point.area * point.light_sq).sum();
                (all > 0.0).then(|| points.iter().map(|point| (point.area / all, 1.0)).unzip())?
            }
            ErrorNorm::Local => {
                let (typical, least) = (median_light(points)?, least_median_light(points)?);
                let lit: f64 = lit_points(points).map(|point| point.area).sum();
                let weights = |point: &Lit| {
                    let relative_to = point.by_smaller.max(typical);
                    (point.area / (lit * relative_to * relative_to), (relative_to / point.by_smaller.max(least)).powi(2))
                };
                points.iter().map(weights).unzip()
            }
        };
        by_point.iter().all(|weight| weight.is_finite()).then_some(Self { by_point, if_dimmer })
    }
}

/// The points where light is.
pub(super) fn lit_points(points: &[Lit]) -> impl Iterator<Item = &Lit> {
    let least = least_light(points);
    points.iter().filter(move |point| point.is_reached || point.light > least)
}

/// Light of no more than this, in W/m^2, is none.
pub(super) fn least_light(points: &[Lit]) -> f64 {
    let area: f64 = points.iter().map(|point| point.area).sum();
    NONE * points.iter().map(|point| point.area * point.light).sum::<f64>() / area
}

/// The median light over the lit area; `None` if all is dark, or if half of that area is lit by no one knows how little.
pub(super) fn median_light(points: &[Lit]) -> Option<f64> {
    light_above(points, 0.5)
}

/// As little as that median may be, for points that lie at random: what they find below it is so much less than half of the area (Woodruff, Journal of the
/// American Statistical Association 47, 1952).
fn least_median_light(points: &[Lit]) -> Option<f64> {
    let deviation = deviation_below(points, median_light(points)?);
    light_above(points, (0.5 - MEDIAN_SIGMAS * deviation).max(0.0))
}

/// The light above which all but this part of the lit area is.
fn light_above(points: &[Lit], part: f64) -> Option<f64> {
    let mut lit: Vec<(f64, f64)> = lit_points(points).map(|point| (point.known(), point.area)).collect();
    lit.sort_by(|a, b| a.0.total_cmp(&b.0));
    let wanted = part * lit.iter().map(|(_, area)| area).sum::<f64>();
    let mut below = 0.0;
    let middle = lit.iter().find(|(_, area)| {
        below += area;
        below >= wanted
    });
    middle.map(|(light, _)| *light).filter(|&light| light > least_light(points))
}

/// The standard deviation of the part of the lit area where no more than this light is found. Points lie at random in strata that follow one another
/// through the scene, so differences between neighbours tell it (Wolter, Introduction to Variance Estimation, 1985, section 7.2): of a dark room
/// beside a bright one it is certain how much of the area it is.
fn deviation_below(points: &[Lit], light: f64) -> f64 {
    let area: f64 = lit_points(points).map(|point| point.area).sum();
    let is_below = |point: &Lit| f64::from(u8::from(point.known() <= light));
    let part = lit_points(points).map(|point| point.area * is_below(point)).sum::<f64>() / area;
    let off: Vec<f64> = lit_points(points).map(|point| point.area * (is_below(point) - part) / area).collect();
    (0.5 * off.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum::<f64>()).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::sampling;

    #[test]
    fn by_energy_what_is_bright_counts_and_locally_what_is_large() {
        // Nine tenths of the area at 1, a tenth at 10, as much in the dark; everything 10% too bright.
        let points = [Lit::of(0.45, 1.0), Lit::of(0.45, 1.0), Lit::of(0.1, 10.0), Lit::of(1.0, 0.0)];
        let squares = |norm| -> Vec<f64> {
            let weights = NormWeights::new(norm, &points).unwrap().by_point;
            points.iter().zip(weights).map(|(point, weight)| weight * (0.1 * point.light).powi(2)).collect()
        };
        for norm in [ErrorNorm::Energy, ErrorNorm::Local] {
            assert!((squares(norm).iter().sum::<f64>().sqrt() - 0.1).abs() < 1e-12, "{norm:?}");
        }
        assert!((squares(ErrorNorm::Energy)[2] / 0.01 - 10.0 / 10.9).abs() < 1e-12);
        assert!((squares(ErrorNorm::Local)[2] / 0.01 - 0.1).abs() < 1e-12);
    }

    /// Of 500 points two standard deviations are 4.5% of the area, in whatever order they come by chance.
    #[test]
    fn between_bright_and_dim_halves_the_median_hangs_on_few_points() {
        let more = |lights: &mut dyn Iterator<Item = f64>| {
            let mut points: Vec<Lit> = lights.map(|light| Lit::of(1.0, light)).collect();
            let order = |point: &Lit| sampling::hash(7, point.light.to_bits());
            points.sort_by_key(order);
            let least = points.iter().map(|point| point.light).fold(f64::INFINITY, f64::min);
            let if_dimmer = NormWeights::new(ErrorNorm::Local, &points).unwrap().if_dimmer;
            points.iter().zip(if_dimmer).find(|(point, _)| point.light == least).unwrap().1
        };
        let halves = more(&mut (0..500).map(|index| f64::from(index).mul_add(1e-9, if index < 240 { 0.01 } else { 1.0 })));
        assert!((halves / 1e4 - 1.0).abs() < 1e-3, "{halves}");
        let even = more(&mut (0..500).map(|index| 1.0 + f64::from(index) / 500.0));
        assert!((even / (1.498_f64 / 1.454).powi(2) - 1.0).abs() < 0.01, "{even}");
        // Few points tell it less well.
        let few = more(&mut (0..25).map(|index| 1.0 + f64::from(index) / 25.0));
        assert!(few > 1.3, "{few}");
    }

    /// Strata of the dark room come before those of the bright one.
    #[test]
    fn of_rooms_one_after_the_other_it_is_certain_which_one_the_median_lies_in() {
        let points: Vec<Lit> = (0..500).map(|index| Lit::of(1.0, if index < 240 { 0.01 } else { 1.0 })).collect();
        assert!((deviation_below(&points, 0.01) - 1.0 / 500.0 / 2.0_f64.sqrt()).abs() < 1e-12);
        assert_eq!(NormWeights::new(ErrorNorm::Local, &points).unwrap().if_dimmer, vec![1.0; 500]);
    }

    #[test]
    fn the_median_is_by_lit_area_and_there_is_none_in_the_dark() {
        assert_eq!(median_light(&[Lit::of(1.0, 5.0), Lit::of(10.0, 0.0), Lit::of(3.0, 2.0), Lit::of(1.0, 1.0)]), Some(2.0));
        assert_eq!(median_light(&[Lit::of(1.0, 0.0)]), None);
        // What leaks past edges is no light, however large it is.
        let [room, outside] = [Lit::of(1.0, 2.0), Lit::of(1e4, 1e-14)];
        assert_eq!(median_light(&[room, outside]), Some(2.0));
        let weights = |points: &[Lit]| NormWeights::new(ErrorNorm::Local, points).unwrap().by_point;
        // Unless light is known to come there: then so little of it is known that there is no median.
        assert_eq!(median_light(&[room, Lit { is_reached: true, ..outside }]), None);
        assert_eq!(median_light(&[room, Lit { is_reached: true, missed: 0.5, ..outside }]), Some(0.5));
        assert_eq!(median_light(&[room, Lit { area: 0.5, is_reached: true, ..outside }]), Some(2.0));
        assert_eq!(weights(&[room, outside])[0], weights(&[room])[0]);
        for norm in [ErrorNorm::Energy, ErrorNorm::Local] {
            assert!(NormWeights::new(norm, &[Lit::of(1.0, 0.0)]).is_none());
        }
    }
}
