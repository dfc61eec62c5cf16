//! What sensors measure, as CSV.
//!
//! The columns of the sensors, `x,y,z,nx,ny,nz`, then the irradiance per channel in W/m^2, `H_r,H_g,H_b` for three channels, else `H_0,H_1,...`, and
//! the standard errors of these, `se_r,...`. For one or three channels the illuminance in lx follows, `lux`, and its standard error, `se_lux`. Empty is
//! what was not measured. Behind them are the other columns that the sensors came with.

use std::io::{self, Write};

use super::LUMENS_PER_WATT;
use super::points::Points;
use super::values::{Columns, channel_columns, write_columns};
use crate::picture::luminance;
use crate::values::Irradiances;

/// Illuminances of sensors.
#[derive(Clone, Debug, PartialEq)]
pub struct Illuminances {
    /// In lx: [`LUMENS_PER_WATT`] times the luminance of the irradiance by Rec. 709, of one channel times that; NaN where there is none.
    pub lux: Vec<f32>,
    /// The standard error of each, as if all channels were off to the same side: they share rays.
    pub standard_error: Vec<f32>,
}

impl Illuminances {
    /// Of irradiances of one or three channels; what an eye sees of others is not known.
    pub fn of(irradiances: &Irradiances) -> Option<Self> {
        let channels = irradiances.channels;
        let lux = |numbers: &[f32]| luminance(numbers) * LUMENS_PER_WATT as f32;
        let of = |numbers: &[f32]| numbers.chunks_exact(channels).map(lux).collect();
        let is_seen = channels == 1 || channels == 3;
        is_seen.then(|| Self { lux: of(&irradiances.irradiance), standard_error: of(&irradiances.standard_error) })
    }
}

/// Writes sensors with what they measure, in their order.
///
/// # Errors
/// What the writer says, and [`io::ErrorKind::InvalidInput`] if there are not `channels` irradiances for each sensor.
pub fn write_irradiances(writer: &mut impl Write, sensors: &Points, irradiances: &Irradiances) -> io::Result<()> {
    let (channels, illuminances) = (irradiances.channels, Illuminances::of(irradiances));
    let mut columns = vec![
        Columns { names: channel_columns("H", channels), numbers: &irradiances.irradiance },
        Columns { names: channel_columns("se", channels), numbers: &irradiances.standard_error },
    ];
    if let Some(Illuminances { lux, standard_error }) = &illuminances {
        columns.push(Columns { names: vec!["lux".to_owned()], numbers: lux });
        columns.push(Columns { names: vec!["se_lux".to_owned()], numbers: standard_error });
    }
    write_columns(writer, sensors, &columns, None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::points::read_points;

    fn written(sensors: &str, irradiances: &Irradiances) -> io::Result<String> {
        let mut text = Vec::new();
        write_irradiances(&mut text, &read_points(sensors.as_bytes(), "S.csv").unwrap(), irradiances)?;
        Ok(String::from_utf8(text).unwrap())
    }

    #[test]
    fn irradiance_and_illuminance_stand_beside_the_sensors() {
        let nan = f32::NAN;
        let irradiances = Irradiances {
            channels: 3,
            irradiance: vec![1.0, 1.0, 1.0, nan, nan, nan],
            standard_error: vec![0.5, 0.5, 0.5, nan, nan, nan],
        };
        let sensors = "name,x,y,z,nx,ny,nz,lux,H_r\ndesk,0,1,2,0,0,1,7,8\nshelf,3,4,5,1,0,0,9,9\n";
        let expected = "x,y,z,nx,ny,nz,H_r,H_g,H_b,se_r,se_g,se_b,lux,se_lux,name\n\
            0,1,2,0,0,1,1,1,1,0.5,0.5,0.5,179,89.5,desk\n3,4,5,1,0,0,,,,,,,,,shelf\n";
        assert_eq!(written(sensors, &irradiances).unwrap(), expected);
    }

    #[test]
    fn of_bands_there_is_no_illuminance() {
        let irradiances = Irradiances { channels: 2, irradiance: vec![1.0, 2.0], standard_error: vec![0.0, 0.25] };
        let sensors = "x,y,z,nx,ny,nz\n0,0,0,0,0,1\n";
        assert_eq!(written(sensors, &irradiances).unwrap(), "x,y,z,nx,ny,nz,H_0,H_1,se_0,se_1\n0,0,0,0,0,1,1,2,0,0.25\n");
        assert!(written(&format!("{sensors}1,0,0,0,0,1\n"), &irradiances).is_err());
    }
}
