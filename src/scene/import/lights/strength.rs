//! How strong lights are: in watts by channel, or in what an eye sees of it, of a colour.
//!
//! A watt of luminance is [`LUMENS_PER_WATT`] lumens, here as in all outputs: the illuminance that comes of a light of so many candelas is what these
//! make of it.

use super::super::ImportError;
use super::kelvin;
use super::table::{Table, Value};
use crate::scene::{LUMENS_PER_WATT, luminance};

/// A way to say how strong a light is.
pub(super) struct Measure {
    /// Its key.
    pub key: &'static str,
    /// Whether it is what an eye sees, in candelas, lumens or lux.
    pub is_photometric: bool,
    /// What it is divided by to be a strength: of a flux the solid angle.
    pub per: f64,
}

/// The strength by channel, by the one of these measures that is there; `None` if there is none.
pub(super) fn strength(table: &Table<'_>, channels: usize, measures: &[Measure]) -> Result<Option<Vec<f64>>, ImportError> {
    let keys: Vec<&'static str> = measures.iter().map(|measure| measure.key).collect();
    let said = table.one_of(&keys)?;
    let Some((said, measure)) = said.and_then(|said| Some((said, measures.iter().find(|measure| measure.key == said.key)?))) else {
        return Ok(None);
    };
    if measure.is_photometric {
        let amount = said.number(0.0, f64::MAX)? / measure.per;
        return Ok(Some(of_seen(table, channels, amount)?));
    }
    if let Some(colour) = table.one_of(&["colour", "kelvin"])? {
        let what = format_args!("'{}' is in watts, which have no colour: give a number for each channel", measure.key);
        return Err(colour.wrong(what));
    }
    let watts = said.channels(channels)?;
    Ok(Some(watts.into_iter().map(|watts| watts / measure.per).collect()))
}

/// The strength by channel of which an eye sees so many candelas or lux: `colour` of the table, or the colour of a black body of so many `kelvin`, or white.
pub(super) fn of_seen(table: &Table<'_>, channels: usize, amount: f64) -> Result<Vec<f64>, ImportError> {
    if !matches!(channels, 1 | 3) {
        return Err(table.wrong(format_args!(
            "of {channels} channels it is not known what an eye sees: give watts for each, by 'power', 'intensity' or 'irradiance'"
        )));
    }
    let colour = match table.one_of(&["colour", "kelvin"])? {
        Some(said) if said.key == "colour" => said.channels(channels)?,
        Some(said) => black_body(said, channels)?,
        None => vec![1.0; channels],
    };
    let seen = luminance(&colour).unwrap_or(0.0);
    if seen <= 0.0 {
        return Err(table.wrong("its colour is black: a channel must be above 0"));
    }
    Ok(colour.iter().map(|channel| channel * amount / (seen * LUMENS_PER_WATT)).collect())
}

fn black_body(said: Value<'_>, channels: usize) -> Result<Vec<f64>, ImportError> {
    let colour = kelvin::colour(said.number(kelvin::LOWEST, kelvin::HIGHEST)?);
    Ok(if channels == 3 { colour.to_vec() } else { vec![1.0] })
}
