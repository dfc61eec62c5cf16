//! The files of a lightmap: its pages in every format, by parts of the light, and where faces lie.

use std::path::{Path, PathBuf};

use patchlight::bake::{LightPart, Lightmap};
use patchlight::output::{
    Destination, ImageFormat, LightmapCode, PngExposure, Provenance, Quantity, auto_exposure, write_hdr, write_lightmap_glb,
    write_lightmap_json, write_lightmap_png,
};
use patchlight::picture::Image;
use patchlight::scene::Scene;

use super::exit::Failure;
use super::files::Sink;
use super::progress::Voice;

/// What is written, and how.
#[derive(Debug)]
pub struct LightmapFiles {
    pub quantity: Quantity,
    pub exposure: PngExposure,
    pub pages: Vec<PageFile>,
    pub glb: Option<Destination>,
    pub json: Option<Sink>,
    pub voice: Voice,
}

/// How a page is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PageFormat {
    Picture(ImageFormat),
    Rgbm,
}

/// A file of each page.
#[derive(Clone, Debug)]
pub struct PageFile {
    /// That of the first page.
    pub path: PathBuf,
    pub format: PageFormat,
    /// The light that it holds: one part, or in formats that have layers several.
    parts: Vec<LightPart>,
}

const PARTS: [LightPart; 3] = [LightPart::All, LightPart::Direct, LightPart::Indirect];

fn name_of(part: LightPart) -> &'static str {
    match part {
        LightPart::All => "",
        LightPart::Direct => "direct",
        LightPart::Indirect => "indirect",
    }
}

impl PageFile {
    /// The files that this path stands for: with parts `separate`, .exr has layers of them, others have a file for each, with its name before the
    /// extension.
    pub fn of(path: &Path, format: PageFormat, separate: bool) -> Vec<Self> {
        let file = |path: PathBuf, parts: &[LightPart]| Self { path, format, parts: parts.to_vec() };
        if !separate {
            return vec![file(path.to_owned(), &[LightPart::All])];
        }
        if format == PageFormat::Picture(ImageFormat::Exr) {
            return vec![file(path.to_owned(), &PARTS)];
        }
        PARTS.iter().map(|&part| file(with_word(path, name_of(part)), &[part])).collect()
    }
}

/// A path with a word before its extension.
fn with_word(path: &Path, word: &str) -> PathBuf {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    if word.is_empty() { path.to_owned() } else { path.with_extension(format!("{word}.{extension}")) }
}

impl LightmapFiles {
    /// Whether there are any.
    pub fn are_some(&self) -> bool {
        !self.pages.is_empty() || self.glb.is_some()
    }

    /// The files of so many pages: of the second page on with its number before the extension.
    pub fn of_pages(&self, pages: usize) -> Result<Vec<Vec<Destination>>, Failure> {
        let of_file = |file: &PageFile| {
            let page = |number: usize| {
                let word = if number == 0 { String::new() } else { (number + 1).to_string() };
                Destination::new(&with_word(&file.path, &word)).map_err(Failure::usage)
            };
            (0..pages).map(page).collect()
        };
        self.pages.iter().map(of_file).collect()
    }

    /// Writes everything that was asked for.
    pub fn write(
        &self,
        files: &[Vec<Destination>],
        lightmap: &Lightmap,
        scene: &Scene,
        provenance: &Provenance,
    ) -> Result<(), Failure> {
        let (voice, quantity) = (self.voice, self.quantity);
        let ev = match self.exposure {
            PngExposure::Ev(ev) => ev,
            PngExposure::Auto => exposure_of(&lightmap.pages),
        };
        for (file, destinations) in self.pages.iter().zip(files) {
            self.write_pages(file, destinations, (lightmap, scene, ev), provenance)?;
        }
        if let Some(destination) = &self.glb {
            destination.write(|file| write_lightmap_glb(file, scene, lightmap, ev, provenance))?;
            voice.figure("wrote", format_args!("{} (exposure EV {ev:.2})", destination.path().display()));
        }
        if let Some(sink) = &self.json {
            sink.write(|writer| write_lightmap_json(writer, scene, lightmap, quantity, provenance))?;
            voice.figure("wrote", format_args!("{}", sink.name()));
        }
        Ok(())
    }

    /// Writes all pages of a file, at an exposure of `ev` where it is exposed.
    fn write_pages(
        &self,
        file: &PageFile,
        destinations: &[Destination],
        (lightmap, scene, ev): (&Lightmap, &Scene, f64),
        provenance: &Provenance,
    ) -> Result<(), Failure> {
        let quantity = self.quantity;
        let layers = |page: usize| file.parts.iter().map(|&part| image(lightmap, scene, (page, part), quantity)).collect();
        let pages: Vec<Vec<Image>> = (0..destinations.len()).map(layers).collect::<Result<_, _>>()?;
        let largest = pages.iter().flatten().flat_map(|image| &image.radiance).fold(0.0_f32, |most, &x| most.max(x));
        let code = match file.format {
            PageFormat::Rgbm => LightmapCode::Rgbm { range: f64::from(largest * quantity.per_radiance()) },
            PageFormat::Picture(_) => LightmapCode::Srgb { ev },
        };
        let light = match file.parts[..] {
            [LightPart::All] => String::new(),
            [part] => format!(", {} light", name_of(part)),
            _ => ", with layers of direct and indirect light".to_owned(),
        };
        for (images, destination) in pages.iter().zip(destinations) {
            write_page(destination, (file, images), (quantity, code), provenance)?;
            let path = destination.path().display();
            self.voice.figure("wrote", format_args!("{path} ({} in {}{light})", quantity.name(), quantity.unit()));
        }
        Ok(())
    }
}

/// A part of the light of a page as an image of a quantity.
fn image(lightmap: &Lightmap, scene: &Scene, (page, part): (usize, LightPart), quantity: Quantity) -> Result<Image, Failure> {
    let found = match quantity {
        Quantity::Irradiance | Quantity::Illuminance => lightmap.irradiance_of(scene, part, page),
        _ => lightmap.part(part, page),
    };
    let image = found.ok_or_else(|| Failure::failed("the lightmap does not keep direct and indirect light apart"))?;
    if quantity != Quantity::Illuminance {
        return Ok(image);
    }
    image.to_luminance().map_err(|channels| {
        Failure::usage(format_args!("--quantity illuminance: not known for {channels} channels, only for one or three"))
    })
}

fn write_page(
    destination: &Destination,
    (page, images): (&PageFile, &[Image]),
    (quantity, code): (Quantity, LightmapCode),
    provenance: &Provenance,
) -> Result<(), Failure> {
    #[cfg(not(feature = "openexr"))]
    use patchlight::output::write_exr_layers;
    #[cfg(feature = "openexr")]
    use patchlight::output::write_openexr_layers as write_exr_layers;
    let layers: Vec<(&str, &Image)> = page.parts.iter().map(|&part| name_of(part)).zip(images).collect();
    let image = &images[0];
    destination.write(|file| match page.format {
        PageFormat::Picture(ImageFormat::Exr) => write_exr_layers(file, &layers, quantity, provenance),
        PageFormat::Picture(ImageFormat::Hdr) => write_hdr(file, image, quantity, provenance),
        PageFormat::Picture(ImageFormat::Png) | PageFormat::Rgbm => write_lightmap_png(file, image, (quantity, code), provenance),
    })?;
    Ok(())
}

/// One exposure for all pages, each counting by its size.
fn exposure_of(pages: &[Image]) -> f64 {
    let of = |image: &Image| [f64::from(image.width) * f64::from(image.height), auto_exposure(image)];
    let [sum, area] = pages.iter().map(of).fold([0.0; 2], |[sum, total], [area, ev]| [sum + area * ev, total + area]);
    if area > 0.0 { sum / area } else { 0.0 }
}
