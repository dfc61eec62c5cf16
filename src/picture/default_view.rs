//! A view that shows the scene when none is asked for.
//!
//! Eyes are tried inside the scene and around it, and so are they where most of its surfaces are. A view gets a score by the front faces that some rays meet: which part of the
//! picture they fill, which part of the scene's area they are, and how many surfaces there are to see. The score falls with back
//! faces (the wall of a closed room from outside, the inside of furniture), with things right before the lens, and with a picture
//! full of a light. So a closed room is seen from inside, a box with an open front through its opening, a scene without walls from
//! outside, a model before a wide backdrop from near by. A heuristic; about 2e5 rays.

use std::collections::BTreeMap;

use glam::DVec3;

use super::camera::Camera;
use crate::geometry::Aabb;
use crate::scene::{Scene, SurfaceId, Up};
use crate::visibility::{Hit, Ray, Visibility};

/// Eyes that are tried inside the bounds of the scene.
const INSIDE_EYES: u32 = 400;

/// Rays in all directions that tell whether an eye stands free.
const SPHERE_RAYS: u32 = 48;

/// Eyes whose views get a score.
const KEPT_EYES: usize = 40;

/// Directions of views from inside, around the up axis.
const YAWS: u32 = 16;

/// Columns and rows of the rays that give a view its score.
const SCORE_RAYS: (u32, u32) = (16, 12);

/// The part of the surfaces that is left out on either side of where most of them are.
const LEFT_OUT: f64 = 0.04;

/// Eyes are tried inside the box of most surfaces, too, where it is smaller than the bounds of the scene by this: a room that a small sun far away lights. At
/// half of their size it still has an eighth of the eyes in the bounds.
const APART: f64 = 0.5;

/// Vertical field of view in degrees from inside a room: about that of a 20 mm lens.
const INSIDE_FIELD_OF_VIEW: f64 = 62.0;

/// Vertical field of view in degrees from outside.
const OUTSIDE_FIELD_OF_VIEW: f64 = 40.0;

impl Camera {
    /// A camera that shows `scene`; `visibility` must be of that scene. The same for the same scene and size, whatever the backend,
    /// as far as the backends agree.
    ///
    /// Up is where the [scene](Scene::up) says; else y or z, by the floors and the light that falls.
    pub fn default_view(scene: &Scene, visibility: &dyn Visibility, width: u32, height: u32) -> Self {
        let (bounds, detail) = (scene.bounds(), bounds_of_detail(scene));
        let survey = Survey {
            scene,
            visibility,
            up: scene.up().map_or_else(|| guess_up(scene), Up::vector),
            total_area: total_area(scene),
            bounds,
            detail,
        };
        let pitches_inside = [-4.0, -14.0];

        // From inside: eyes that stand free, in all directions around.
        let mut best: Option<(f64, Self)> = None;
        let mut judge = |camera: Self| {
            let score = survey.score(&camera);
            if best.as_ref().is_none_or(|(previous, _)| score > *previous) {
                best = Some((score, camera));
            }
        };
        let size = |camera: Self| Self { width, height, ..camera };
        let is_apart = detail.diagonal() < APART * bounds.diagonal();
        let among = if is_apart { vec![bounds, detail] } else { vec![bounds] };
        for eye in among.into_iter().flat_map(|bounds| survey.free_eyes(bounds)) {
            for pitch in pitches_inside {
                (0..YAWS).for_each(|yaw| judge(size(survey.view_from_inside(eye, f64::from(yaw) / f64::from(YAWS), pitch))));
            }
        }

        // From outside: level and from above, far enough away to see everything; and the same around where most of the surfaces
        // are.
        for bounds in [bounds, detail] {
            for yaw in 0..8 {
                for pitch in [0.0, -15.0, -35.0] {
                    judge(survey.view_from_outside(bounds, f64::from(yaw) / 8.0, pitch, width, height));
                }
            }
        }
        let (_, camera) = best.expect("views from outside are always judged");
        camera
    }
}

/// Which way is up: y or z. Floors face it, and light falls against it.
fn guess_up(scene: &Scene) -> DVec3 {
    let votes_for = |up: DVec3| -> f64 {
        let (mut floor, mut area, mut falling, mut power) = (0.0, 0.0, 0.0, 0.0);
        for (index, surface) in scene.surfaces().iter().enumerate() {
            let along = DVec3::from(surface.polygon.normal()).dot(up);
            let emitted: f64 = scene.material_of(SurfaceId(index as u32)).exitance.iter().sum::<f64>() * surface.polygon.area();
            area += surface.polygon.area();
            power += emitted;
            // Within about 25 degrees of level: stairs and ramps count, walls do not.
            if along > 0.9 {
                floor += surface.polygon.area();
            }
            falling += emitted * (-along).max(0.0);
        }
        floor / area + if power > 0.0 { falling / power } else { 0.0 }
    };
    if votes_for(DVec3::Z) > votes_for(DVec3::Y) { DVec3::Z } else { DVec3::Y }
}

/// The box around the centres of most surfaces, widened by the part that would be left out if they were evenly spread.
fn bounds_of_detail(scene: &Scene) -> Aabb {
    let mut bounds = scene.bounds();
    for axis in 0..3 {
        let mut centres: Vec<f64> = scene.surfaces().iter().map(|surface| surface.polygon.bounds().centre()[axis]).collect();
        centres.sort_unstable_by(f64::total_cmp);
        let quantile = |part: f64| centres[(part * (centres.len() - 1) as f64).round() as usize];
        let (low, high) = (quantile(LEFT_OUT), quantile(1.0 - LEFT_OUT));
        let margin = LEFT_OUT / (1.0 - 2.0 * LEFT_OUT) * (high - low);
        bounds.min[axis] = bounds.min[axis].max(low - margin);
        bounds.max[axis] = bounds.max[axis].min(high + margin);
    }
    bounds
}

fn total_area(scene: &Scene) -> f64 {
    scene.surfaces().iter().map(|surface| surface.polygon.area()).sum()
}

/// What the search for a view needs.
struct Survey<'a> {
    scene: &'a Scene,
    visibility: &'a dyn Visibility,
    up: DVec3,
    total_area: f64,
    /// Where all surfaces are.
    bounds: Aabb,
    /// Where most of the surfaces are.
    detail: Aabb,
}

impl Survey<'_> {
    /// Two horizontal directions, at right angles to each other and to up.
    fn level(&self) -> (DVec3, DVec3) {
        match self.up {
            DVec3::Z => (DVec3::X, DVec3::Y),
            DVec3::X => (DVec3::Y, DVec3::Z),
            _ => (DVec3::Z, DVec3::X),
        }
    }

    /// The direction at `yaw` (a part of the full turn) and `pitch` (degrees above level).
    fn direction(&self, yaw: f64, pitch: f64) -> DVec3 {
        let (first, second) = self.level();
        let (sin, cos) = (std::f64::consts::TAU * yaw).sin_cos();
        let (rise, run) = pitch.to_radians().sin_cos();
        run * (cos * first + sin * second) + rise * self.up
    }

    /// What each ray meets first.
    fn cast(&self, rays: &[Ray]) -> Vec<Met> {
        let mut hits = vec![None; rays.len()];
        self.visibility.first_hits(rays, &mut hits);
        rays.iter().zip(hits).map(|(ray, hit)| self.met(ray, hit)).collect()
    }

    fn met(&self, ray: &Ray, hit: Option<Hit>) -> Met {
        let Some(Hit { surface, distance }) = hit else { return Met::Nothing };
        let id = SurfaceId(surface);
        let surface = self.scene.surface(id);
        let cos = -DVec3::from(ray.direction).dot(DVec3::from(surface.polygon.normal()));
        if cos <= 0.0 && surface.twin.is_none() {
            return Met::Back;
        }
        Met::Front { surface: id, distance, cos: cos.abs(), emits: self.scene.material_of(id).emits() }
    }

    /// Eyes inside a box with hardly any back faces to see and some space around; those with many front faces and much space
    /// first.
    fn free_eyes(&self, bounds: Aabb) -> Vec<DVec3> {
        let (extent, diagonal) = (bounds.extent(), bounds.diagonal());
        let sphere: Vec<DVec3> = (0..SPHERE_RAYS).map(|k| fibonacci_direction(k, SPHERE_RAYS)).collect();
        let mut eyes: Vec<(f64, DVec3)> = (0..INSIDE_EYES)
            .filter_map(|k| {
                // Halton points; above the middle, as a person stands in a room.
                let unit = DVec3::new(radical_inverse(k + 1, 2), radical_inverse(k + 1, 3), radical_inverse(k + 1, 5));
                let squeezed = DVec3::splat(0.04) + 0.92 * unit;
                let height = 0.45 + 0.3 * unit;
                let part = squeezed * (DVec3::ONE - self.up) + height * self.up;
                let eye = bounds.min + part * extent;

                let rays: Vec<Ray> = sphere.iter().map(|&direction| ray(eye, direction)).collect();
                let met = self.cast(&rays);
                let share = |wanted: fn(&Met) -> bool| met.iter().filter(|met| wanted(met)).count() as f64 / f64::from(SPHERE_RAYS);
                let nearest = met.iter().filter_map(Met::distance).fold(f64::INFINITY, f64::min);
                let back = share(|met| matches!(met, Met::Back));
                if back > 0.1 || nearest < 0.02 * diagonal {
                    return None;
                }
                let front = share(|met| matches!(met, Met::Front { .. }));
                let air = met.iter().filter_map(Met::distance).sum::<f64>() / f64::from(SPHERE_RAYS);
                Some((front - 2.0 * back + 0.5 * (air / diagonal), eye))
            })
            .collect();
        eyes.sort_by(|a, b| b.0.total_cmp(&a.0));

        // Half are the best ones; the others are taken at even steps from the rest: corners have less space but better views.
        let best = eyes.len().min(KEPT_EYES / 2);
        let step = ((eyes.len() - best) / (KEPT_EYES / 2)).max(1);
        let others = eyes[best..].iter().step_by(step).take(KEPT_EYES / 2);
        eyes[..best].iter().chain(others).map(|&(_, eye)| eye).collect()
    }

    /// A view from `eye`, in a direction.
    fn view_from_inside(&self, eye: DVec3, yaw: f64, pitch: f64) -> Camera {
        let diagonal = self.bounds.diagonal();
        self.camera(eye, eye + 0.5 * diagonal * self.direction(yaw, pitch), INSIDE_FIELD_OF_VIEW)
    }

    /// A view of a box from outside, towards its centre, in which it just fills the picture.
    fn view_from_outside(&self, bounds: Aabb, yaw: f64, pitch: f64, width: u32, height: u32) -> Camera {
        let (centre, half) = (bounds.centre(), 0.5 * bounds.extent());
        let forward = self.direction(yaw, pitch);
        let right = forward.cross(self.up).normalize();
        let above = right.cross(forward);
        let tan_up = (0.5 * OUTSIDE_FIELD_OF_VIEW).to_radians().tan();
        let tan_right = tan_up * f64::from(width) / f64::from(height);
        let distance = (0..8)
            .map(|corner| {
                let sign = |axis: u32| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
                let corner = half * DVec3::new(sign(0), sign(1), sign(2));
                (corner.dot(above).abs() / tan_up).max(corner.dot(right).abs() / tan_right) - corner.dot(forward)
            })
            .fold(0.0, f64::max);
        self.camera(centre - 1.01 * distance * forward, centre, OUTSIDE_FIELD_OF_VIEW).with_size(width, height)
    }

    fn camera(&self, eye: DVec3, target: DVec3, field_of_view_degrees: f64) -> Camera {
        // Rounded to a ten-thousandth of the scene at most, so that people can read and type the numbers.
        let scale = 10.0_f64.powf((1e4 / self.bounds.diagonal()).log10().ceil());
        let rounded = |point: DVec3| ((point * scale).round() / scale).to_array();
        Camera {
            eye: rounded(eye),
            target: rounded(target),
            up: self.up.to_array(),
            field_of_view_degrees,
            width: SCORE_RAYS.0,
            height: SCORE_RAYS.1,
        }
    }

    /// The score of a picture: 0 if it shows nothing, below 0 if mostly what it should not.
    fn score(&self, camera: &Camera) -> f64 {
        // Rays at even steps over the picture, whatever its size.
        let Ok(rays) = camera.rays() else { return f64::NEG_INFINITY };
        let (columns, rows) = SCORE_RAYS;
        let step = (f64::from(camera.width) / f64::from(columns), f64::from(camera.height) / f64::from(rows));
        let rays: Vec<Ray> = (0..rows * columns)
            .map(|k| rays.through((f64::from(k % columns) + 0.5) * step.0, (f64::from(k / columns) + 0.5) * step.1))
            .collect();
        let half_height = (0.5 * camera.field_of_view_degrees).to_radians().tan();
        let pixel = 2.0 * half_height / f64::from(rows) * (2.0 * half_height * step.0 / step.1 / f64::from(rows));
        let forward = (DVec3::from(camera.target) - DVec3::from(camera.eye)).normalize();
        let near = 0.13 * self.detail.diagonal();

        // Count what the rays meet, and add up the area of front faces that the picture shows.
        let mut by_surface: BTreeMap<SurfaceId, f64> = BTreeMap::new();
        let (mut front, mut light, mut back, mut close, mut area) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for (ray, met) in rays.iter().zip(self.cast(&rays)) {
            match met {
                Met::Nothing => {}
                Met::Back => back += 1.0,
                Met::Front { surface, distance, cos, emits } => {
                    *by_surface.entry(surface).or_default() += 1.0;
                    let solid_angle = pixel * DVec3::from(ray.direction).dot(forward).powi(3);
                    area += solid_angle * distance * distance / cos.max(0.1);
                    front += 1.0;
                    light += f64::from(u8::from(emits));
                    close += f64::from(u8::from(distance < near));
                }
            }
        }

        // Weigh the parts.
        let all = f64::from(rows * columns);
        let shown = (area / self.total_area).min(1.0);
        let lights = if light > 0.0 { 0.05 - (light / all - 0.25).max(0.0) } else { 0.0 };
        // The entropy of surfaces in the picture: 0 for a single wall, 1 if every ray meets another surface.
        let variety = by_surface.values().map(|count| count / all * (all / count).ln()).sum::<f64>() / all.ln();
        front / all * (0.4 + shown) + 0.6 * variety + lights - 2.0 * back / all - close / all
    }
}

impl Camera {
    /// The same view in another size.
    #[must_use]
    pub fn with_size(self, width: u32, height: u32) -> Self {
        Self { width, height, ..self }
    }
}

/// What a ray meets first.
enum Met {
    Nothing,
    Back,
    Front { surface: SurfaceId, distance: f64, cos: f64, emits: bool },
}

impl Met {
    fn distance(&self) -> Option<f64> {
        match self {
            Self::Front { distance, .. } => Some(*distance),
            _ => None,
        }
    }
}

fn ray(origin: DVec3, direction: DVec3) -> Ray {
    Ray { origin: origin.to_array(), direction: direction.to_array(), origin_plane: crate::visibility::NO_PLANE }
}

/// The radical inverse: the digits of `index` in `base`, mirrored behind the point; low-discrepancy numbers in [0, 1).
fn radical_inverse(mut index: u32, base: u32) -> f64 {
    let (mut value, mut digit) = (0.0, 1.0);
    while index > 0 {
        digit /= f64::from(base);
        value += digit * f64::from(index % base);
        index /= base;
    }
    value
}

/// One of `count` directions, evenly spread over the sphere (the spherical Fibonacci lattice).
fn fibonacci_direction(k: u32, count: u32) -> DVec3 {
    let z = 1.0 - (2.0 * f64::from(k) + 1.0) / f64::from(count);
    let (sin, cos) = (f64::from(k) * std::f64::consts::PI * (3.0 - 5.0_f64.sqrt())).sin_cos();
    let radius = (1.0 - z * z).sqrt();
    DVec3::new(radius * cos, radius * sin, z)
}

#[cfg(test)]
mod tests;
