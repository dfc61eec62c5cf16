//! The lightmap: pages with all charts, and what is known of it.

use std::f32::consts::PI;

use rayon::prelude::*;
use serde::Serialize;

use super::atlas::{Atlas, Placed};
use super::fill::Canvas;
use super::gathered::Found;
use super::seams::{self, Seams};
use super::texels::Texels;
use crate::error::ErrorNorm;
use crate::picture::{Image, Shown};
use crate::scene::Scene;
use crate::values::ValuesError;

/// Light as textures.
#[derive(Clone, Debug, PartialEq)]
pub struct Lightmap {
    /// Where the faces lie.
    pub atlas: Atlas,
    /// The pages in linear radiance B / pi, row after row from the top left; 0 where there is no chart.
    pub pages: Vec<Image>,
    /// What is known of it.
    pub report: BakeReport,
}

/// What is known of a lightmap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct BakeReport {
    /// Texels with a value of their own.
    pub texels: u64,
    /// Texels of faces on which something stands, which are filled from others of their chart.
    pub hidden: u64,
    /// Texels that were gathered by rays: 0 if all were read off a lit mesh.
    pub gathered: u64,
    /// How wrong the gathered ones are; `None` if none were, or that is not known.
    pub error: Option<ValuesError>,
    /// How far the interpolated ones are off gathers, relative in the norm of the options, at two standard deviations; `None` if there are none.
    pub interpolated: Option<f64>,
    /// How wrong all are together, relative in the norm of the options: an estimate.
    pub whole: Option<f64>,
    /// Seams between charts that meet at a flat angle.
    pub seams: Seams,
}

/// What was found on the way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Held {
    pub hidden: u64,
    /// How texels were gathered, and the norm that this is told in; `None` if they were read off a mesh.
    pub found: Option<(Found, ErrorNorm)>,
}

/// Lays all texels on their pages, fills what has none, and compares the seams.
pub(crate) fn finish(scene: &Scene, atlas: &Atlas, texels: &[Texels<'_>], held: Held) -> Lightmap {
    let channels = scene.channels();
    let mut pages: Vec<Image> = atlas.pages.iter().map(|&[width, height]| Image::black(width, height, channels)).collect();
    let padding = atlas.options.padding as usize;
    let canvases: Vec<Canvas> = texels.par_iter().map(|texels| filled(texels, padding)).collect();
    for (placed, canvas) in atlas.charts.iter().zip(&canvases) {
        let page = &mut pages[placed.page];
        for (row, numbers) in canvas.numbers.chunks(canvas.width * channels).enumerate() {
            let [left, top] = placed.at.map(|corner| corner as usize - padding);
            let start = ((top + row) * page.width as usize + left) * channels;
            page.radiance[start..][..numbers.len()].copy_from_slice(numbers);
        }
    }

    let count = texels.iter().flat_map(|texels| &texels.sites).filter(|site| site.is_covered()).count() as u64;
    let seams = seams::compare(scene, atlas, &pages);
    let report = BakeReport { texels: count, hidden: held.hidden, seams, ..held.report(count) };
    Lightmap { atlas: atlas.clone(), pages, report }
}

/// The radiances of a chart with its padding.
fn filled(texels: &Texels<'_>, padding: usize) -> Canvas {
    let ([columns, rows], channels) = (texels.chart.size(), texels.channels());
    let mut canvas = Canvas::new([columns + 2 * padding, rows + 2 * padding], channels);
    for index in (0..texels.sites.len()).filter(|&index| texels.sites[index].is_covered() && texels.is_known(index)) {
        let (column, row) = (index % columns + padding, index / columns + padding);
        let numbers = &mut canvas.numbers[(row * canvas.width + column) * channels..][..channels];
        numbers.iter_mut().zip(texels.radiosity_of(index)).for_each(|(number, b)| *number = b / PI);
    }
    canvas.fill();
    canvas
}

impl Held {
    /// What is known of so many texels.
    fn report(&self, texels: u64) -> BakeReport {
        let Some((found, norm)) = self.found else { return BakeReport::default() };
        let Found { gathered, error, interpolated } = found;

        // All have the errors of gathers; those between also what they are off these.
        let share = 1.0 - gathered as f64 / texels.max(1) as f64;
        let of_gathers = error.map(|error| match norm {
            ErrorNorm::Energy => error.energy,
            ErrorNorm::Local => error.local,
        });
        let whole = of_gathers.map(|of_gathers| of_gathers.hypot(share.max(0.0).sqrt() * interpolated.unwrap_or(0.0)));
        BakeReport { gathered, error, interpolated, whole, ..BakeReport::default() }
    }
}

impl Lightmap {
    /// A page as irradiance H = (B - E) / rho over pi, 0 where nothing is reflected. `scene` is the one that was baked.
    pub fn irradiance(&self, scene: &Scene, page: usize) -> Image {
        let (mut image, padding) = (self.pages[page].clone(), self.atlas.options.padding as usize);
        for Placed { chart, at, .. } in self.atlas.charts.iter().filter(|placed| placed.page == page) {
            let material = &scene.materials()[chart.material as usize];
            let ([columns, rows], [left, top]) = (chart.size(), at.map(|corner| corner as usize - padding));
            for row in top..top + rows + 2 * padding {
                let start = (row * image.width as usize + left) * image.channels;
                let numbers = &mut image.radiance[start..][..(columns + 2 * padding) * image.channels];
                for (k, number) in numbers.iter_mut().enumerate() {
                    *number = Shown::Irradiance.of(material, k % image.channels, f64::from(*number * PI)) as f32;
                }
            }
        }
        image
    }
}
