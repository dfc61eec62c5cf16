//! The reader and the writer of points and values in CSV.

use patchlight::output::{Points, read_points, write_values};
use patchlight::values::Values;

/// Reads the bytes as points. Those that are taken can be written with values and read again: the same points, and the same text.
pub fn read_csv(bytes: &[u8]) {
    let points = match read_points(bytes, "P.csv") {
        Ok(points) => points,
        Err(error) => return assert!(error.to_string().starts_with("P.csv:")),
    };
    for point in points.surface_points() {
        assert!(point.position.iter().all(|x| x.is_finite()));
        assert!((point.normal.iter().map(|n| n * n).sum::<f64>() - 1.0).abs() < 1e-11, "{:?}", point.normal);
    }

    let written = with_values(&points);
    let read = read_points(&written[..], "V.csv").expect("what is written can be read");
    assert_eq!(read.surface_points(), points.surface_points());
    assert_eq!(with_values(&read), written);
}

/// Points with values of three channels, some of which are not known.
fn with_values(points: &Points) -> Vec<u8> {
    let radiosity: Vec<f32> =
        (0..3 * points.len()).map(|index| if index % 7 == 0 { f32::NAN } else { index as f32 / 3.0 }).collect();
    let values = Values {
        channels: 3,
        standard_error: radiosity.clone(),
        radiosity,
        faces: vec![Some(0); points.len()],
        missed: 0,
        error: None,
    };
    let mut written = Vec::new();
    write_values(&mut written, points, &values).expect("memory suffices");
    written
}
