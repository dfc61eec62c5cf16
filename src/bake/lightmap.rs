//! The lightmap: pages with all charts, and what is known of it.

use std::f32::consts::PI;
use std::ops::Range;

use rayon::prelude::*;
use serde::Serialize;

use super::atlas::{Atlas, Placed};
use super::charts::Chart;
use super::compose::{NO_CHART, compose};
use super::fill::Canvas;
use super::gathered::{Found, Kept};
use super::record::BakeRecord;
use super::seams::{self, Seams};
use super::texels::Texels;
use crate::picture::{Image, Shown};
use crate::progress::Stop;
use crate::scene::Scene;

/// Light as textures.
#[derive(Clone, Debug, PartialEq)]
pub struct Lightmap {
    /// Where the faces lie.
    pub atlas: Atlas,
    /// The pages in linear radiance B / pi, row after row from the top left; 0 where there is no chart.
    pub pages: Vec<Image>,
    /// What of it is direct light, page by page: what surfaces emit, and what they reflect of light that comes straight from emitters. Only if parts
    /// were to be kept apart.
    pub direct: Option<Vec<Image>>,
    /// The chart that each texel is of, on a page that a file lays out.
    pub(super) owners: Option<Vec<u32>>,
    /// What is known of it.
    pub report: BakeReport,
    /// What a later bake can take from it, if that was to be [kept](super::BakeOptions::keep) and all was found.
    pub record: Option<BakeRecord>,
}

/// A part of the light of a lightmap. Direct and indirect light add up to all of it, to rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightPart {
    /// All light.
    All,
    /// What surfaces emit, and what they reflect of light that comes straight from emitters; of irradiance, the latter.
    Direct,
    /// What was reflected at least once on its way.
    Indirect,
}

/// What is known of a lightmap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct BakeReport {
    /// Texels with a value of their own.
    pub texels: u64,
    /// Texels of faces on which something stands, which are filled from others of their chart.
    pub hidden: u64,
    /// Texels at which direct light was gathered, and those at which indirect light was: 0 if all were read off a lit mesh.
    pub gathered: [u64; 2],
    /// How wrong the gathered ones are; errors are root mean squares relative to the light, in the norm of the options. `None` if none were gathered, or
    /// if that is not known.
    pub error: Option<f64>,
    /// How far interpolated and kept ones are off gathers, at two standard deviations; infinite if the time was over before that was known.
    pub interpolated: f64,
    /// What was kept from an earlier bake, of direct and of indirect light.
    pub kept: [Kept; 2],
    /// How wrong all are together: an estimate.
    pub whole: Option<f64>,
    /// Texels that the limit of time kept from being found: interpolated from what there was, or filled from others of their chart.
    pub filled: u64,
    /// Texels of charts in which nothing was found in time: they have the radiosities of the solver's own elements, all of it as indirect light beside
    /// what was known of direct light.
    pub coarse: u64,
    /// Seams between charts that meet at a flat angle.
    pub seams: Seams,
}

impl BakeReport {
    /// Whether no limit ended it before all texels were found, and their error was known.
    pub fn is_complete(&self) -> bool {
        self.filled == 0 && self.coarse == 0 && self.interpolated.is_finite()
    }
}

/// Lays all texels on their pages, fills what has none, and compares the seams. Of all texels `hidden` are so; they were found as `found` says. Stopped,
/// it is not to be used.
pub(crate) fn finish(
    scene: &Scene,
    atlas: &Atlas,
    texels: &[Texels<'_>],
    (hidden, found): (u64, Found),
    stop: Stop<'_>,
) -> Lightmap {
    let channels = scene.channels();
    let padding = if atlas.is_of_file() { 0 } else { atlas.options.padding as usize };
    let canvases: Vec<Canvas> = texels.par_iter().map(|texels| filled(texels, padding, stop)).collect();
    let (pages, owners) = if atlas.is_of_file() {
        let page = compose(atlas.pages[0], &atlas.charts, texels, &canvases, atlas.options.padding);
        (vec![page.numbers], Some(page.chart))
    } else {
        (lay(atlas, &canvases), None)
    };
    let count = if atlas.options.separate { 2 * channels } else { channels };
    let images = |numbers: Range<usize>| -> Vec<Image> {
        let image = |(&[width, height], page): (&[u32; 2], &Vec<f32>)| {
            let radiance = page.chunks(count).flat_map(|texel| &texel[numbers.clone()]).copied().collect();
            Image { width, height, channels, radiance, standard_error: None }
        };
        atlas.pages.iter().zip(&pages).map(image).collect()
    };
    let direct = atlas.options.separate.then(|| images(channels..count));
    let pages = images(0..channels);

    let count = texels.iter().flat_map(|texels| &texels.sites).filter(|site| site.is_covered()).count() as u64;
    let seams = if stop() { Seams::default() } else { seams::compare(scene, atlas, &pages) };
    let report = BakeReport { texels: count, hidden, seams, ..BakeReport::default() };
    let report = BakeReport {
        gathered: found.gathered,
        error: found.error,
        interpolated: found.interpolated,
        kept: found.kept,
        whole: found.error.map(|error| error.hypot(found.interpolated)).filter(|whole| whole.is_finite()),
        filled: found.not_found.filled,
        coarse: found.not_found.coarse,
        ..report
    };
    Lightmap { atlas: atlas.clone(), pages, direct, owners, report, record: found.record }
}

/// The numbers of pages that were laid out here, texel after texel.
fn lay(atlas: &Atlas, canvases: &[Canvas]) -> Vec<Vec<f32>> {
    let (padding, count) = (atlas.options.padding as usize, canvases.first().map_or(1, |canvas| canvas.channels));
    let mut pages: Vec<Vec<f32>> =
        atlas.pages.iter().map(|&[width, height]| vec![0.0; width as usize * height as usize * count]).collect();
    for (placed, canvas) in atlas.charts.iter().zip(canvases) {
        let (page, width) = (&mut pages[placed.page], atlas.pages[placed.page][0] as usize);
        let [left, top] = placed.at.map(|corner| corner as usize - padding);
        for (row, numbers) in canvas.numbers.chunks(canvas.width * count).enumerate() {
            page[((top + row) * width + left) * count..][..numbers.len()].copy_from_slice(numbers);
        }
    }
    pages
}

impl Atlas {
    /// Bytes that baking it takes beside the solution, with the images that are written of it, for so many channels.
    pub fn bytes_to_bake(&self, channels: usize) -> u64 {
        let numbers = channels * if self.options.separate { 2 } else { 1 };
        let (texels, texel) = (self.texels() as u64, Texels::bytes_of(channels, numbers) as u64);
        let pixels: u64 = self.pages.iter().map(|[width, height]| u64::from(*width) * u64::from(*height)).sum();

        // Charts with their padding, and pages of them; later pages with an image of each part, and their channels one by one.
        let parts = if self.options.separate { 3 } else { 1 };
        let of_pixel = (2 * numbers).max(numbers + 2 * parts * channels) * size_of::<f32>();
        texels * texel + pixels * of_pixel as u64
    }
}

/// The radiances of a chart with its padding.
fn filled(texels: &Texels<'_>, padding: usize, stop: Stop<'_>) -> Canvas {
    let ([columns, rows], count) = (texels.chart.size(), texels.numbers());
    let mut canvas = Canvas::new([columns + 2 * padding, rows + 2 * padding], count);
    for index in (0..texels.sites.len()).filter(|&index| texels.sites[index].is_covered() && texels.is_known(index)) {
        let (column, row) = (index % columns + padding, index / columns + padding);
        let numbers = &mut canvas.numbers[(row * canvas.width + column) * count..][..count];
        numbers
            .iter_mut()
            .zip(texels.numbers_of(index))
            .zip(texels.material.exitance.iter().cycle())
            .for_each(|((number, b), e)| *number = (b + *e as f32) / PI);
    }
    if !stop() {
        canvas.fill();
    }
    canvas
}

impl Lightmap {
    /// A page as irradiance H = (B - E) / rho over pi, 0 where nothing is reflected. `scene` is the one that was baked.
    pub fn irradiance(&self, scene: &Scene, page: usize) -> Image {
        self.to_irradiance(scene, page, self.pages[page].clone())
    }

    /// A part of the light of a page in linear radiance; `None` if parts were not kept apart.
    pub fn part(&self, part: LightPart, page: usize) -> Option<Image> {
        let direct = || Some(&self.direct.as_ref()?[page]);
        match part {
            LightPart::All => Some(self.pages[page].clone()),
            LightPart::Direct => direct().cloned(),
            LightPart::Indirect => Some(difference(&self.pages[page], direct()?)),
        }
    }

    /// The same as irradiance over pi.
    pub fn irradiance_of(&self, scene: &Scene, part: LightPart, page: usize) -> Option<Image> {
        match part {
            LightPart::All => Some(self.irradiance(scene, page)),
            LightPart::Direct => Some(self.to_irradiance(scene, page, self.part(part, page)?)),
            LightPart::Indirect => {
                let direct = self.irradiance_of(scene, LightPart::Direct, page)?;
                Some(difference(&self.irradiance(scene, page), &direct))
            }
        }
    }

    fn to_irradiance(&self, scene: &Scene, page: usize, mut image: Image) -> Image {
        let count = image.channels;
        let irradiance = |numbers: &mut [f32], chart: &Chart| {
            let material = &scene.materials()[chart.material as usize];
            for (k, number) in numbers.iter_mut().enumerate() {
                *number = Shown::Irradiance.of(material, k % count, f64::from(*number * PI)) as f32;
            }
        };
        if let Some(owners) = &self.owners {
            let texels = image.radiance.chunks_mut(count).zip(owners).filter(|(_, owner)| **owner != NO_CHART);
            texels.for_each(|(numbers, &owner)| irradiance(numbers, &self.atlas.charts[owner as usize].chart));
            return image;
        }
        let padding = self.atlas.options.padding as usize;
        for Placed { chart, at, .. } in self.atlas.charts.iter().filter(|placed| placed.page == page) {
            let ([columns, rows], [left, top]) = (chart.size(), at.map(|corner| corner as usize - padding));
            for row in top..top + rows + 2 * padding {
                let start = (row * image.width as usize + left) * count;
                irradiance(&mut image.radiance[start..][..(columns + 2 * padding) * count], chart);
            }
        }
        image
    }
}

/// What is left of all light; rounding takes nothing below zero.
fn difference(all: &Image, part: &Image) -> Image {
    let radiance = all.radiance.iter().zip(&part.radiance).map(|(all, part)| (all - part).max(0.0)).collect();
    Image { radiance, ..all.clone() }
}
