//! The atlas: charts side by side on pages.
//!
//! Charts are taken from the highest to the lowest, and packed by guillotine cuts (the crate `guillotiere`) into the smallest page that holds them all,
//! or, if that would be too large, into as many as it takes.

use std::collections::HashSet;

use glam::DVec3;
use guillotiere::{AtlasAllocator, size2};

use super::charts::{Chart, charts};
use super::file_charts::{charts as charts_of_file, side_in_metres};
use super::options::{BakeError, BakeOptions, MOST_TEXELS};
use crate::scene::{FileUv, Scene, SurfaceId, UvTriangle};

/// Sides of pages are multiples of this: what textures are compressed in.
const BLOCK: u32 = 4;

/// A page that was too small is tried again with sides so many times as long.
const GROWTH: f64 = 1.03;

/// Where the faces of a scene lie on the pages of a lightmap. Follows from the scene and the options alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Atlas {
    pub(super) charts: Vec<Placed>,
    /// Width and height of each page in texels.
    pub(super) pages: Vec<[u32; 2]>,
    pub(super) options: BakeOptions,
    /// Of the scene.
    pub(super) surfaces: usize,
    /// The triangles of the file that lays it out; none if it is laid out here.
    pub(super) triangles: Vec<UvTriangle>,
}

/// A chart with its place.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Placed {
    pub chart: Chart,
    pub page: usize,
    /// Where its first texel lies on the page.
    pub at: [u32; 2],
}

/// Where a surface lies on an atlas.
#[derive(Clone, Debug, PartialEq)]
pub struct FaceOnAtlas {
    /// The number of the surface.
    pub surface: u32,
    /// The number of its chart, and the page that it lies on.
    pub chart: usize,
    /// The page.
    pub page: usize,
    /// In metres: the surface's, or those of a triangle of the file that lays the page out.
    pub vertices: Vec<[f64; 3]>,
    /// The coordinates of the vertices, from the top left of the page: parts of its width and height.
    pub uv: Vec<[f64; 2]>,
}

impl Atlas {
    /// Lays out the charts of a scene.
    ///
    /// # Errors
    /// See [`BakeError`].
    pub fn new(scene: &Scene, options: &BakeOptions) -> Result<Self, BakeError> {
        options.validate()?;
        let charts = charts(scene, &options.chosen(scene)?, options.texel);
        let (padding, size) = (f64::from(2 * options.padding), f64::from(options.size));
        let padded = |chart: &Chart| chart.extent.map(|count| count + padding);
        let count: f64 = charts.iter().map(|chart| padded(chart).iter().product::<f64>()).sum();
        if count > MOST_TEXELS {
            return Err(BakeError::TooMany { texel: options.texel, count });
        }
        if let Some(chart) = charts.iter().find(|chart| padded(chart).iter().any(|&side| side > size)) {
            let [width, height] = padded(chart);
            let face = scene.surface(chart.surfaces[0]).face + 1;
            return Err(BakeError::ChartTooLarge { face, width, height, size: options.size });
        }

        // The highest first; the widest of those.
        let mut order: Vec<usize> = (0..charts.len()).collect();
        let key = |chart: &Chart| chart.extent.map(|count| count as u32);
        order.sort_by_key(|&number| (std::cmp::Reverse([1, 0].map(|axis: usize| key(&charts[number])[axis])), number));
        let sizes: Vec<[u32; 2]> = charts.iter().map(|chart| key(chart).map(|count| count + 2 * options.padding)).collect();
        let (places, pages) = pack(&sizes, order, options.size);
        let placed = |(chart, place): (Chart, (usize, [u32; 2]))| {
            let (page, at) = place;
            Placed { chart, page, at: at.map(|corner| corner + options.padding) }
        };
        let charts = charts.into_iter().zip(places).map(placed).collect();
        Ok(Self { charts, pages, options: options.clone(), surfaces: scene.surfaces().len(), triangles: Vec::new() })
    }

    /// The layout of a file: its coordinates as they are, on a page so large that texels have the wanted side in the mean over the area.
    ///
    /// Of texels that several faces share, the one that covers most of it has the texel. Padding does not move what the file lays out: it is filled as far
    /// as nothing else lies there.
    ///
    /// # Errors
    /// See [`BakeError`]; [`BakeError::Uv`] tells what is wrong with the coordinates.
    pub fn of_file(scene: &Scene, uv: &FileUv, options: &BakeOptions) -> Result<Self, BakeError> {
        options.validate()?;
        let chosen = options.chosen(scene)?;
        let faces: HashSet<u32> =
            scene.surfaces().iter().zip(&chosen).filter(|(_, chosen)| **chosen).map(|(surface, _)| surface.face).collect();
        let side = (side_in_metres(uv, &|face| faces.contains(&face))? / options.texel).round().max(1.0);
        let side = (side / f64::from(BLOCK)).ceil() * f64::from(BLOCK);
        if side > f64::from(options.size) || side * side > MOST_TEXELS {
            return Err(BakeError::PageTooLarge { texel: options.texel, side, size: options.size });
        }
        let charts = charts_of_file(scene, uv, &chosen, side as u32)?;
        let charts = charts.into_iter().map(|(chart, at)| Placed { chart, page: 0, at }).collect();
        let (pages, triangles) = (vec![[side as u32; 2]], uv.triangles.clone());
        Ok(Self { charts, pages, options: options.clone(), surfaces: scene.surfaces().len(), triangles })
    }

    /// Whether a file lays it out.
    pub fn is_of_file(&self) -> bool {
        !self.triangles.is_empty()
    }

    /// Whether it was made of this scene, as far as surfaces and their materials tell.
    pub(crate) fn is_of(&self, scene: &Scene) -> bool {
        let fits = |placed: &Placed| {
            placed.chart.surfaces.iter().all(|surface| {
                scene.surfaces().get(surface.index()).is_some_and(|surface| surface.material == placed.chart.material)
            })
        };
        self.surfaces == scene.surfaces().len() && self.charts.iter().all(fits)
    }

    /// The options that it was made with.
    pub fn options(&self) -> &BakeOptions {
        &self.options
    }

    /// How many charts there are.
    pub fn charts(&self) -> usize {
        self.charts.len()
    }

    /// Width and height of each page in texels.
    pub fn pages(&self) -> &[[u32; 2]] {
        &self.pages
    }

    /// Texels that charts cover with the rectangles around them, without padding.
    pub fn texels(&self) -> usize {
        self.charts.iter().map(|placed| placed.chart.size().iter().product::<usize>()).sum()
    }

    /// Where surfaces lie, in the order of charts. `scene` is the one that it was made of.
    pub fn faces<'a>(&'a self, scene: &'a Scene) -> impl Iterator<Item = FaceOnAtlas> + 'a {
        self.charts.iter().enumerate().flat_map(move |(chart, placed)| {
            let own = placed.chart.surfaces.iter().filter(|_| placed.chart.of_file.is_none());
            let own = own.map(move |&surface| self.face(scene, chart, placed, surface));
            let of_file = placed.chart.of_file.iter().flat_map(|parts| &parts.triangles);
            own.chain(of_file.map(move |&(triangle, surface)| self.triangle(chart, placed, (triangle, surface))))
        })
    }

    fn triangle(&self, chart: usize, placed: &Placed, (number, surface): (u32, SurfaceId)) -> FaceOnAtlas {
        let UvTriangle { corners, uv, .. } = &self.triangles[number as usize];
        FaceOnAtlas { surface: surface.0, chart, page: placed.page, vertices: corners.to_vec(), uv: uv.to_vec() }
    }

    fn face(&self, scene: &Scene, chart: usize, placed: &Placed, surface: SurfaceId) -> FaceOnAtlas {
        let page = placed.page;
        let on_page = |vertex: [f64; 3]| {
            let at = placed.chart.to_texels(DVec3::from(vertex)).to_array();
            std::array::from_fn(|axis| (f64::from(placed.at[axis]) + at[axis]) / f64::from(self.pages[page][axis]))
        };
        let vertices: Vec<[f64; 3]> = scene.surface(surface).polygon.vertices().collect();
        let uv = vertices.iter().copied().map(on_page).collect();
        FaceOnAtlas { surface: surface.0, chart, page, vertices, uv }
    }
}

/// Page and corner of rectangles, and the sizes of the pages: `order` says which comes first. None is wider or higher than a page.
fn pack(sizes: &[[u32; 2]], order: Vec<usize>, most: u32) -> (Vec<Corner>, Vec<[u32; 2]>) {
    let mut places = vec![(0, [0; 2]); sizes.len()];
    let (mut pages, mut left) = (Vec::new(), order);
    while !left.is_empty() {
        // The smallest page that may hold what is left, or one of the largest size.
        let area: f64 = left.iter().map(|&number| sizes[number].iter().map(|&side| f64::from(side)).product::<f64>()).sum();
        let longest = left.iter().flat_map(|&number| sizes[number]).max().unwrap_or(1);
        let mut side = (area.sqrt() as u32).max(longest).next_multiple_of(BLOCK).min(most);
        let (packed, rest) = loop {
            let (packed, rest) = fill_page(sizes, &left, side);
            if rest.is_empty() || side == most {
                break (packed, rest);
            }
            side = ((f64::from(side) * GROWTH) as u32).next_multiple_of(BLOCK).max(side + BLOCK).min(most);
        };

        // It is as large as its content.
        let end = |axis: usize| packed.iter().map(|&(number, at)| at[axis] + sizes[number][axis]).max().unwrap_or(1);
        let size = [0, 1].map(|axis: usize| end(axis).next_multiple_of(BLOCK).min(side));
        for (number, at) in packed {
            places[number] = (pages.len(), at);
        }
        pages.push(size);
        left = rest;
    }
    (places, pages)
}

/// The number of a page or of a rectangle, and the rectangle's corner.
type Corner = (usize, [u32; 2]);

/// Packs what fits into a page; the rest is returned, in its order.
fn fill_page(sizes: &[[u32; 2]], order: &[usize], side: u32) -> (Vec<Corner>, Vec<usize>) {
    let mut page = AtlasAllocator::new(size2(side as i32, side as i32));
    let (mut packed, mut rest) = (Vec::new(), Vec::new());
    for &number in order {
        let [width, height] = sizes[number].map(|side| side as i32);
        match page.allocate(size2(width, height)) {
            Some(place) => packed.push((number, [place.rectangle.min.x as u32, place.rectangle.min.y as u32])),
            None => rest.push(number),
        }
    }
    (packed, rest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::sampling;

    #[test]
    fn rectangles_do_not_overlap_and_pages_are_filled_well() {
        let side = |number: u64| 3 + (60.0 * sampling::unit(sampling::hash(number, 5)).powi(3)) as u32;
        let sizes: Vec<[u32; 2]> = (0..900).map(|number| [side(2 * number), side(2 * number + 1)]).collect();
        let mut order: Vec<usize> = (0..sizes.len()).collect();
        order.sort_by_key(|&number| std::cmp::Reverse(sizes[number][1]));
        for most in [4096, 256] {
            let (places, pages) = pack(&sizes, order.clone(), most);
            let mut taken: Vec<Vec<bool>> = pages.iter().map(|[width, height]| vec![false; (width * height) as usize]).collect();
            for (&(page, [left, top]), [width, height]) in places.iter().zip(&sizes) {
                for (x, y) in (top..top + height).flat_map(|y| (left..left + width).map(move |x| (x, y))) {
                    assert!(x < pages[page][0] && y < pages[page][1]);
                    let texel = &mut taken[page][(y * pages[page][0] + x) as usize];
                    assert!(!std::mem::replace(texel, true), "two at {x}, {y} of page {page}");
                }
            }
            let filled = taken.iter().flatten().filter(|taken| **taken).count() as f64;
            let all = taken.iter().map(Vec::len).sum::<usize>() as f64;
            assert!(filled > 0.8 * all, "{filled} of {all}");
            assert_eq!(pages.len() == 1, most == 4096);
            assert!(pages.iter().flatten().all(|side| side % BLOCK == 0 && *side <= most));
        }
    }
}
