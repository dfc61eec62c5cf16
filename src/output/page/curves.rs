//! Where light is not smooth, as a page has it.

use crate::discontinuities::{CurveSegment, Degree};

/// Of degrees in turn, how many segments there are, and the colour of pictures; and both ends of all segments, in metres, those of a degree in a row.
pub(super) fn told(curves: &[CurveSegment]) -> (Vec<(usize, [u8; 3])>, Vec<f32>) {
    let of_degree = |degree: Degree| curves.iter().filter(move |curve| curve.degree == degree);
    let degrees = [Degree::D0, Degree::D1, Degree::D2];
    let ends = degrees.into_iter().flat_map(of_degree).flat_map(|curve| curve.ends).flatten().map(|x| x as f32).collect();
    (degrees.map(|degree| (of_degree(degree).count(), degree.colour())).to_vec(), ends)
}
