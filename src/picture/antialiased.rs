//! What pixels show: the function at their centres, and more rays through those in which it jumps.
//!
//! A pixel whose corners and centre lie on one surface, and whose neighbours are about as bright where they lie on that, takes the value at its centre.
//! Others, at edges and borders of shadows, take rays of a lattice; the more, the further two halves of these are apart. What is thinner than half a
//! pixel may pass between corners and centre.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::camera::CameraRays;
use crate::mesh::{SeenPoint, SeenSurfaces};
use crate::progress::{Observer, Progress, Stage};
use crate::scene::{Scene, SurfaceId};
use crate::transmittance::Rays;
use crate::visibility::{Hit, Ray};

/// Rows that are cast together: they share the corners between them, and the rows above and below are cast twice.
const BAND: u32 = 16;

/// A pixel shows a jump if its centre and that of a neighbour on its surface differ by more than this part of the larger: half of it is what the mean may
/// be off, less than is seen.
const JUMP: f32 = 0.1;

/// Rays through a pixel that shows a jump, and through one in which the means of two halves of these are further apart than by [`APART`] of the larger: at
/// the edges of lamps.
const RAYS_AT_JUMPS: u32 = 16;
const MOST_RAYS: u32 = 64;
const APART: f32 = 0.4;

/// Pixels whose rays are cast together.
const TOGETHER: usize = 256;

/// The pixels of a camera.
#[derive(Clone, Copy)]
pub(super) struct Antialiased<'a> {
    pub scene: &'a Scene,
    pub visibility: &'a Rays<'a>,
    pub camera: &'a CameraRays,
    /// In pixels.
    pub size: [u32; 2],
}

/// What a ray meets that can be seen.
#[derive(Clone, Copy, Debug)]
pub(super) enum Met {
    Surface(SurfaceId, DVec3),
    /// The sky, in a direction.
    Sky(DVec3),
}

/// What a ray shows.
#[derive(Clone, Copy)]
struct Sight {
    /// The surface that it meets, seen from either side; `None` is the sky.
    surface: Option<u32>,
    /// `None` is a back.
    met: Option<Met>,
}

/// What the corners and centres of the pixels of some rows show, row after row.
struct Band {
    rows: Range<u32>,
    width: u32,
    corners: Vec<Sight>,
    /// With those of the rows above and below, where there are such.
    centres: Vec<Sight>,
    /// The number of the first centre of `rows`.
    first: usize,
}

impl Band {
    /// How many pixels the rows have.
    fn len(&self) -> usize {
        self.rows.len() * self.width as usize
    }

    /// Whether all that is known of a pixel lies on one surface.
    fn shows_one_surface(&self, pixel: usize) -> bool {
        let width = self.width as usize;
        let corner = pixel + pixel / width;
        let corners = [corner, corner + 1, corner + width + 1, corner + width + 2];
        corners.iter().all(|&corner| self.corners[corner].surface == self.centres[self.first + pixel].surface)
    }

    /// The numbers of the centre of a pixel and of those beside, above and below it that lie on its surface.
    fn centre_and_neighbours(&self, pixel: usize) -> (usize, impl Iterator<Item = usize> + '_) {
        let (centre, width) = (self.first + pixel, self.width as usize);
        let column = pixel % width;
        let beside = [(column > 0, centre.wrapping_sub(1)), (column + 1 < width, centre + 1)];
        let others = [centre.wrapping_sub(width), centre + width].map(|other| (other < self.centres.len(), other));
        let is_like = move |other: &usize| self.centres[*other].surface == self.centres[centre].surface;
        (centre, beside.into_iter().chain(others).filter_map(|(is_there, other)| is_there.then_some(other)).filter(is_like))
    }

    /// Column and row of a pixel.
    fn place(&self, pixel: usize) -> [u32; 2] {
        let pixel = pixel as u32;
        [pixel % self.width, self.rows.start + pixel / self.width]
    }
}

impl Antialiased<'_> {
    fn bands(&self) -> u32 {
        self.size[1].div_ceil(BAND)
    }

    /// What some rays show.
    fn cast(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) -> Vec<Sight> {
        self.visibility.coherent_first_hits(rays, hits);
        let sight = |(ray, hit): (&Ray, &Option<Hit>)| {
            let direction = DVec3::from(ray.direction);
            let Some(hit) = hit else { return Sight { surface: None, met: Some(Met::Sky(direction)) } };
            let front = self.scene.side_towards(SurfaceId(hit.surface), -direction);
            let met = front.map(|surface| Met::Surface(surface, DVec3::from(ray.origin) + hit.distance * direction));
            Sight { surface: Some(hit.surface), met }
        };
        rays.iter().zip(&*hits).map(sight).collect()
    }

    fn band(&self, number: u32, hits: &mut Vec<Option<Hit>>) -> Band {
        let [width, height] = self.size;
        let rows = number * BAND..((number + 1) * BAND).min(height);
        let through = |row: u32, columns: u32, offset: f64| {
            (0..columns).map(move |column| self.camera.through(f64::from(column) + offset, f64::from(row) + offset))
        };
        let mut rays: Vec<Ray> = (rows.start..=rows.end).flat_map(|row| through(row, width + 1, 0.0)).collect();
        let corners = rays.len();
        let with_others = rows.start.saturating_sub(1)..(rows.end + 1).min(height);
        let first = (rows.start - with_others.start) as usize * width as usize;
        rays.extend(with_others.flat_map(|row| through(row, width, 0.5)));
        let mut sights = self.cast(&rays, hits);
        let centres = sights.split_off(corners);
        Band { rows, width, corners: sights, centres, first }
    }

    /// What so many rays through each of some pixels show, pixel after pixel.
    fn cast_through(&self, band: &Band, pixels: &[usize], count: u32, hits: &mut Vec<Option<Hit>>) -> Vec<Sight> {
        let through = |&pixel: &usize| {
            let [column, row] = band.place(pixel);
            (0..count).map(move |sample| self.camera.through_pixel(column, row, sample, count))
        };
        self.cast(&pixels.iter().flat_map(through).collect::<Vec<Ray>>(), hits)
    }

    /// All that is shown; `None` if the observer cancels.
    pub fn seen(&self, observer: &dyn Observer) -> Option<SeenSurfaces> {
        let mut seen = SeenSurfaces::new(self.scene);
        let of_band = |hits: &mut Vec<Option<Hit>>, number: u32| {
            let mut points: Vec<SeenPoint> = Vec::new();
            if observer.cancelled() {
                return points;
            }
            let mut add = |sight: &Sight, share: f64| {
                if let Some(Met::Surface(surface, point)) = sight.met {
                    points.push(seen.point(surface, point, share));
                }
            };
            let band = self.band(number, hits);
            let (of_one, others): (Vec<usize>, Vec<usize>) = (0..band.len()).partition(|&pixel| band.shows_one_surface(pixel));
            of_one.into_iter().for_each(|pixel| add(&band.centres[band.first + pixel], 1.0));
            for pixels in others.chunks(TOGETHER) {
                let sights = self.cast_through(&band, pixels, RAYS_AT_JUMPS, hits);
                sights.iter().for_each(|sight| add(sight, 1.0 / f64::from(RAYS_AT_JUMPS)));
            }
            points
        };
        let bands: Vec<Vec<SeenPoint>> = (0..self.bands()).into_par_iter().map_init(Vec::new, of_band).collect();
        bands.into_iter().for_each(|points| seen.extend(points));
        (!observer.cancelled()).then_some(seen)
    }

    /// Shades all pixels by some numbers each, of which so many, the first ones, tell where jumps are: `shade` adds what is met to numbers that are 0, with
    /// what `begin` makes for some rows, along which neighbours follow each other. `None` if the observer cancels.
    pub fn shaded<Row>(
        &self,
        [numbers, deciding]: [usize; 2],
        observer: &dyn Observer,
        begin: impl Fn() -> Row + Sync,
        shade: impl Fn(Met, &mut Row, &mut [f32]) + Sync,
    ) -> Option<Vec<f32>> {
        let [width, height] = self.size.map(|side| side as usize);
        let (mut pixels, done) = (vec![0.0; numbers * width * height], AtomicUsize::new(0));
        pixels.par_chunks_mut(numbers * width * BAND as usize).enumerate().for_each_init(Vec::new, |hits, (number, pixels)| {
            if observer.cancelled() {
                return;
            }
            let mut row = begin();
            let mut shade_all = |sights: &[Sight]| {
                let mut shades = vec![0.0_f32; numbers * sights.len()];
                for (sight, shade_of) in sights.iter().zip(shades.chunks_mut(numbers)) {
                    sight.met.into_iter().for_each(|met| shade(met, &mut row, shade_of));
                }
                shades
            };
            self.shade_band((&self.band(number as u32, hits), deciding), hits, &mut shade_all, pixels);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            let fraction = Some(done as f64 / f64::from(self.bands()));
            observer.progress(&Progress { stage: Stage::Render, round: 0, fraction, links: 0, elements: 0, error: None });
        });
        (!observer.cancelled()).then_some(pixels)
    }

    /// Fills in the pixels of some rows.
    fn shade_band(
        &self,
        (band, deciding): (&Band, usize),
        hits: &mut Vec<Option<Hit>>,
        shade_all: &mut impl FnMut(&[Sight]) -> Vec<f32>,
        pixels: &mut [f32],
    ) {
        // By centres, where these tell enough.
        let channels = pixels.len() / band.len();
        let shades = shade_all(&band.centres);
        let shade_of = |centre: usize| &shades[centre * channels..][..channels];
        let mut unsure = Vec::new();
        for (number, pixel) in pixels.chunks_mut(channels).enumerate() {
            let (centre, mut neighbours) = band.centre_and_neighbours(number);
            let jumps = |other| differ(&shade_of(centre)[..deciding], &shade_of(other)[..deciding], JUMP);
            if !band.shows_one_surface(number) || neighbours.any(jumps) {
                unsure.push(number);
            } else {
                pixel.copy_from_slice(shade_of(centre));
            }
        }

        // By more rays, until two halves of these agree.
        for count in [RAYS_AT_JUMPS, MOST_RAYS] {
            let mut still = Vec::new();
            for numbers in unsure.chunks(TOGETHER) {
                let shades = shade_all(&self.cast_through(band, numbers, count, hits));
                for (&number, shades) in numbers.iter().zip(shades.chunks(count as usize * channels)) {
                    let mut halves = [vec![0.0; channels], vec![0.0; channels]];
                    for (sample, of_sample) in shades.chunks(channels).enumerate() {
                        halves[sample % 2].iter_mut().zip(of_sample).for_each(|(sum, value)| *sum += value / count as f32);
                    }
                    let [even, odd] = &halves;
                    let pixel = &mut pixels[number * channels..][..channels];
                    pixel.iter_mut().zip(even.iter().zip(odd)).for_each(|(value, (even, odd))| *value = even + odd);
                    if differ(&even[..deciding], &odd[..deciding], APART) {
                        still.push(number);
                    }
                }
            }
            unsure = still;
        }
    }
}

/// Whether two shades differ in a channel by more than this part of the larger.
fn differ(a: &[f32], b: &[f32], part: f32) -> bool {
    a.iter().zip(b).any(|(a, b)| (a - b).abs() > part * a.max(*b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;
    use crate::picture::Camera;
    use crate::progress::Silent;
    use crate::scene::{Material, Sides};
    use crate::visibility::{Backend, OccluderMesh, build};

    const SIZE: [u32; 2] = [40, 30];

    /// Exitances of polygons in the plane z = 0, as a camera sees them from above, and points of that plane that rays through pixels meet.
    fn picture(faces: &[(f64, Vec<[f64; 2]>)]) -> (Vec<f32>, CameraRays) {
        let material = |&(exitance, _): &(f64, Vec<[f64; 2]>)| Material {
            name: String::new(),
            reflectance: vec![0.0],
            exitance: vec![exitance],
        };
        let polygon = |(number, (_, corners)): (usize, &(f64, Vec<[f64; 2]>))| {
            let corners: Vec<[f64; 3]> = corners.iter().map(|&[x, y]| [x, y, 0.0]).collect();
            (Polygon::new(&corners).unwrap(), number as u32, number as u32)
        };
        let polygons = faces.iter().enumerate().map(polygon).collect();
        let scene = Scene::new(1, faces.iter().map(material).collect(), polygons, Sides::Front).unwrap();
        let visibility = build(Backend::BruteForce, &OccluderMesh::of_scene(&scene)).unwrap();
        let [width, height] = SIZE;
        let camera =
            Camera { eye: [0.0, 0.0, 5.0], target: [0.0; 3], up: [0.0, 1.0, 0.0], field_of_view_degrees: 20.0, width, height };
        let rays = camera.rays().unwrap();
        let antialiased =
            Antialiased { scene: &scene, visibility: &Rays::new(visibility.as_ref(), &scene), camera: &rays, size: SIZE };
        let exitance = |met: Met, _: &mut (), shade: &mut [f32]| match met {
            Met::Surface(surface, _) => shade[0] = scene.material_of(surface).exitance[0] as f32,
            Met::Sky(_) => {}
        };
        (antialiased.shaded([1, 1], &Silent, || (), exitance).unwrap(), rays)
    }

    /// The part of a pixel where `is_there` holds, by many points.
    fn part(rays: &CameraRays, pixel: usize, is_there: impl Fn(DVec3) -> bool) -> f64 {
        const SIDE: usize = 50;
        let [column, row] = [pixel % SIZE[0] as usize, pixel / SIZE[0] as usize].map(|at| at as f64);
        let met = (0..SIDE * SIDE).filter(|k| {
            let [dx, dy] = [k % SIDE, k / SIDE].map(|at| (at as f64 + 0.5) / SIDE as f64);
            let ray = rays.through(column + dx, row + dy);
            let (origin, direction) = (DVec3::from(ray.origin), DVec3::from(ray.direction));
            is_there(origin - origin.z / direction.z * direction)
        });
        met.count() as f64 / (SIDE * SIDE) as f64
    }

    #[test]
    fn an_edge_is_as_bright_as_the_parts_of_its_pixels_say() {
        // Bright below the line x + slope y = 0, and dim or black above.
        for (slope, dim) in [(0.3, 0.0), (-1.0, 0.9), (4.0, 0.01), (0.02, 0.5)] {
            let on_line = |y: f64| [-slope * y, y];
            let left = vec![[-90.0, -9.0], on_line(-9.0), on_line(9.0), [-90.0, 9.0]];
            let right = vec![on_line(-9.0), [90.0, -9.0], [90.0, 9.0], on_line(9.0)];
            let (shown, rays) = picture(&[(1.0, left), (dim, right)]);
            for (pixel, &shown) in shown.iter().enumerate() {
                let bright = part(&rays, pixel, |at| at.x + slope * at.y < 0.0);
                let (expected, off) = (bright + (1.0 - bright) * dim, f64::from(shown) - (bright + (1.0 - bright) * dim));
                // A lattice of 16 points tells a half-plane's part of a square to a tenth, and where nothing changes all is exact.
                let most = if bright == 0.0 || bright == 1.0 { 1e-7 } else { 0.1 * (1.0 - dim) };
                assert!(off.abs() <= most, "slope {slope}, pixel {pixel}: {shown} for {expected}");
            }
        }
    }

    #[test]
    fn what_is_wider_than_half_a_pixel_is_missed_nowhere() {
        // Pixels are 5 * 2 tan(10 degrees) / 30 m wide, 5.9 cm.
        let bar = |low: f64| vec![[low, -9.0], [low + 0.035, -9.0], [low + 0.035, 9.0], [low, 9.0]];
        for low in [0.0, 0.011, 0.023, 0.037, 0.049] {
            let (shown, _) = picture(&[(1.0, bar(low))]);
            for row in shown.chunks(SIZE[0] as usize) {
                let width = row.iter().sum::<f32>() * (10.0_f32.to_radians().tan() / 3.0);
                assert!((width - 0.035).abs() < 0.004, "{low}: {width}");
            }
        }
    }
}
