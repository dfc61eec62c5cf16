//! Bright reflectors: surfaces that reflect so much light for their size that next-event estimation samples them as it does
//! emitters.
//!
//! Such are the trough around a tube and the ceiling above an emitter: paths seldom meet them, and bring much when they do. The
//! noise of paths goes with the variance of radiosities over all surfaces, so that tells whether sampling some of them apart is
//! worth it.

use super::particles::Landing;
use super::spots::{Spot, bright_spots};
use crate::scene::{Scene, SurfaceId};

/// A surface is bright if it reflects more than so many times the mean over all that reflect, in its brightest channel. Empirical.
const BRIGHT: f64 = 8.0;

/// Bright surfaces are sampled if without them the variance falls by more than this, in squares of the mean. Empirical.
const WORTH: f64 = 1.0;

/// They are sampled only if they are at most these parts of the area and of the number of all that reflect: few, and small. Empirical.
const MOST_AREA: f64 = 0.01;
const MOST_SURFACES: f64 = 0.125;

/// A bright reflector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reflector {
    pub surface: SurfaceId,
    /// The reflected radiosity in its brightest channel, in means over all surfaces that reflect.
    pub brightness: f64,
}

/// Cells of surfaces that reflect so many times less than those where light is, in W/m^2, are twice as large.
const DIM: f64 = 16.0;

/// All that is lit, if it were dim, would have at least this part of the cells that are where light is. The light that is known when cells are made may
/// be much less than what comes to a room through a hole, and values are asked for there as well. From a 16th to a half of it takes about as long in rooms
/// without, and much less than no limit behind a hole.
const DIM_PART: f64 = 0.25;

/// How bright surfaces are by what they reflect: where rays are aimed besides emitters, where cells may be coarse, and where they are fine.
#[derive(Clone, Debug)]
pub(crate) struct Brightness {
    /// Of which there are few, if any.
    pub reflectors: Vec<Reflector>,
    /// Parts of other surfaces, of which there are none in most scenes.
    pub spots: Vec<Spot>,
    /// By surface: so many times the area of cells elsewhere; infinite for what reflects nothing.
    pub coarser: Vec<f64>,
}

impl Brightness {
    /// As if all surfaces were equally bright.
    #[cfg(test)]
    pub fn even(scene: &Scene) -> Self {
        Self { reflectors: Vec::new(), spots: Vec::new(), coarser: vec![1.0; scene.surfaces().len()] }
    }

    /// By what each surface reflects, in W/m^2 in its brightest channel.
    pub fn of_surfaces(scene: &Scene, reflected: impl Fn(SurfaceId) -> f64) -> Self {
        let ids = || (0..scene.surfaces().len() as u32).map(SurfaceId);
        let reflected: Vec<f64> = ids().map(reflected).collect();
        let reflected = |id: SurfaceId| reflected[id.index()];

        // The mean over the light, not over the area: dark things do not count.
        let area = |id: SurfaceId| scene.surface(id).polygon.area();
        let power: f64 = ids().map(|id| area(id) * reflected(id)).sum();
        let mean = ids().map(|id| area(id) * reflected(id) * reflected(id)).sum::<f64>() / power.max(f64::MIN_POSITIVE);
        let whole: f64 = ids().filter(|id| reflected(*id) > 0.0).map(area).sum();
        let coarsest = whole * mean / (DIM_PART * power);
        let coarser = |id| match reflected(id) {
            0.0 if power > 0.0 => f64::INFINITY,
            reflected if power > 0.0 => (1.0 + mean / (DIM * reflected)).min(coarsest),
            _ => 1.0,
        };
        Self { reflectors: bright_reflectors(scene, &reflected), spots: Vec::new(), coarser: ids().map(coarser).collect() }
    }

    /// The same with the bright spots that landings of particles tell.
    pub fn with_spots(self, scene: &Scene, landings: &[Landing]) -> Self {
        let mut is_reflector = vec![false; scene.surfaces().len()];
        self.reflectors.iter().for_each(|of| is_reflector[of.surface.index()] = true);
        Self { spots: bright_spots(scene, landings, |surface| is_reflector[surface.index()]), ..self }
    }
}

/// Sums over surfaces, weighted by area: of 1, of what they reflect, and of its square.
#[derive(Clone, Copy, Default)]
struct Moments {
    area: f64,
    sum: f64,
    sum_sq: f64,
}

impl Moments {
    fn add(mut self, area: f64, brightness: f64) -> Self {
        self.area += area;
        self.sum += area * brightness;
        self.sum_sq += area * brightness * brightness;
        self
    }
}

/// The bright reflectors of a scene; none if sampling them is not worth it. `brightness` is what a surface reflects, in W/m^2 in its
/// brightest channel.
fn bright_reflectors(scene: &Scene, brightness: &impl Fn(SurfaceId) -> f64) -> Vec<Reflector> {
    let area = |surface: SurfaceId| scene.surface(surface).polygon.area();
    let all: Vec<Reflector> = (0..scene.surfaces().len() as u32)
        .map(SurfaceId)
        .map(|surface| Reflector { surface, brightness: brightness(surface) })
        .filter(|of| of.brightness > 0.0)
        .collect();

    // Those far above the mean.
    let moments = |of: &mut dyn Iterator<Item = &Reflector>| {
        of.fold(Moments::default(), |moments, of| moments.add(area(of.surface), of.brightness))
    };
    let whole = moments(&mut all.iter());
    let mean = whole.sum / whole.area;
    let is_bright = |of: &&Reflector| of.brightness > BRIGHT * mean;
    let left = moments(&mut all.iter().filter(|of| !is_bright(of)));

    // The variance of what a ray finds that ends anywhere on all surfaces, and if it finds nothing on the bright ones.
    let variance = |of: Moments| of.sum_sq / whole.area - (of.sum / whole.area).powi(2);
    let in_means = |of: &Reflector| Reflector { brightness: of.brightness / mean, ..*of };
    let bright: Vec<Reflector> = all.iter().filter(is_bright).map(in_means).collect();
    let are_few = bright.len() as f64 <= MOST_SURFACES * all.len() as f64 && whole.area - left.area <= MOST_AREA * whole.area;
    if are_few && variance(whole) - variance(left) > WORTH * mean * mean { bright } else { Vec::new() }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::Polygon;
    use crate::scene::{Material, Sides};

    #[test]
    fn reflectors_are_bright_small_and_few() {
        // Sixteen tiles of a square metre, and a plate of a 25th of that.
        let quad = |corner: DVec3, side: f64| {
            let (u, v) = (side * DVec3::X, side * DVec3::Y);
            Polygon::from_vertices(vec![corner, corner + u, corner + u + v, corner + v]).unwrap()
        };
        let tile = |k: u32| (quad(DVec3::new(f64::from(k / 4), f64::from(k % 4), 0.0), 1.0), 0, k);
        let mut faces: Vec<_> = (0..16).map(tile).collect();
        faces.push((quad(2.0 * DVec3::ONE, 0.2), 0, 16));
        let material = Material { name: String::new(), reflectance: vec![0.5], exitance: vec![0.0] };
        let scene = Scene::new(1, vec![material], faces, Sides::Front).unwrap();

        let chosen = |bright: SurfaceId, sent: f64| -> Vec<SurfaceId> {
            let brightness = |surface| if surface == bright { sent } else { 1.0 };
            bright_reflectors(&scene, &brightness).iter().map(|of| of.surface).collect()
        };
        let (plate, tile) = (SurfaceId(16), SurfaceId(3));
        assert_eq!(chosen(plate, 50.0), [plate]);
        assert!(chosen(plate, 1.0).is_empty());
        assert!(chosen(plate, 5.0).is_empty(), "not bright enough");
        assert!(chosen(tile, 50.0).is_empty(), "too large");
    }

    #[test]
    fn cells_are_coarse_where_it_is_dim_and_dark_things_do_not_count() {
        let square = |x: f64, side: f64| {
            let corner = DVec3::new(x, 0.0, 0.0);
            let (u, v) = (side * DVec3::X, side * DVec3::Y);
            Polygon::from_vertices(vec![corner, corner + u, corner + u + v, corner + v]).unwrap()
        };
        let material = Material { name: String::new(), reflectance: vec![0.5], exitance: vec![0.0] };
        let faces = vec![(square(0.0, 1.0), 0, 0), (square(2.0, 1.0), 0, 1), (square(4.0, 1e4), 0, 2)];
        let scene = Scene::new(1, vec![material], faces, Sides::Front).unwrap();
        let reflected = [3.0, 3.0 / DIM, 0.0];
        let coarser = Brightness::of_surfaces(&scene, |surface| reflected[surface.index()]).coarser;
        assert!((coarser[0] - (1.0 + 1.0 / DIM)).abs() < 0.01 && (coarser[1] - 2.0).abs() < 0.1, "{coarser:?}");
        assert!(coarser[2].is_infinite());

        // Hardly lit, all of that together has a quarter of the cells that the lit square has.
        let reflected = [3.0, 3e-12, 6e-12];
        let coarser = Brightness::of_surfaces(&scene, |surface| reflected[surface.index()]).coarser;
        let cells = (1.0 + 1e8) / coarser[2];
        assert!(coarser[1] == coarser[2] && (cells / 0.25 - 1.0).abs() < 0.01, "{coarser:?}");
    }
}
