//! A picture.

/// Linear radiance per pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// In pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
    /// Channels per pixel: as many as the solution has.
    pub channels: usize,
    /// Radiance L = B / pi in W/m^2/sr, row after row from the top left; 0 where nothing is hit. Of a picture of irradiance, that over pi.
    pub radiance: Vec<f32>,
    /// The standard error of each, where it is known: noise, and what is known of bias, but not that a pixel shows a few points.
    pub standard_error: Option<Vec<f32>>,
}

impl Image {
    /// Bytes that a picture of this width and height takes while it is taken, and written in 8 bits.
    pub fn bytes_of([width, height]: [u32; 2], channels: usize) -> u64 {
        let of_pixel = channels * (size_of::<[f32; 2]>() + 2 * size_of::<f32>()) + 4 * size_of::<u32>();
        u64::from(width) * u64::from(height) * of_pixel as u64
    }

    /// A picture in which nothing is hit.
    pub fn black(width: u32, height: u32, channels: usize) -> Self {
        Self { width, height, channels, radiance: vec![0.0; width as usize * height as usize * channels], standard_error: None }
    }

    /// The same with the luminance of each pixel as its one channel. Standard errors are added as if they were one: channels share rays.
    ///
    /// # Errors
    /// The number of channels, if that is neither 1 nor 3: what is then seen of them is not known.
    pub fn to_luminance(&self) -> Result<Self, usize> {
        if self.channels != 1 && self.channels != 3 {
            return Err(self.channels);
        }
        let of = |numbers: &[f32]| numbers.chunks_exact(self.channels).map(luminance).collect::<Vec<f32>>();
        let (radiance, standard_error) = (of(&self.radiance), self.standard_error.as_deref().map(of));
        Ok(Self { channels: 1, radiance, standard_error, ..*self })
    }

    /// The pixels, row after row from the top left: `channels` radiances each.
    pub fn pixels(&self) -> impl ExactSizeIterator<Item = &[f32]> {
        self.radiance.chunks_exact(self.channels.max(1))
    }

    /// Whether `radiance` holds as many values as the other fields say.
    pub fn is_well_formed(&self) -> bool {
        let pixels = self.width as usize * self.height as usize;
        let count = pixels.checked_mul(self.channels);
        let fits = |numbers: &Vec<f32>| count == Some(numbers.len());
        self.channels > 0 && pixels > 0 && fits(&self.radiance) && self.standard_error.iter().all(fits)
    }
}

/// The luminance of a pixel: by Rec. 709 for three channels, else the mean.
pub(crate) fn luminance(pixel: &[f32]) -> f32 {
    match pixel {
        &[r, g, b] => 0.2126 * r + 0.7152 * g + 0.0722 * b,
        _ => pixel.iter().sum::<f32>() / pixel.len() as f32,
    }
}
