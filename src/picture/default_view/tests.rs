//! Hand-made rooms: the default view must show what is in them.

use super::*;
use crate::geometry::Polygon;
use crate::scene::{Material, Sides};
use crate::visibility::{Backend, OccluderMesh, build};

const GREY: u32 = 0;
const LIGHT: u32 = 1;

#[derive(Default)]
struct Faces(Vec<(Polygon, u32, u32)>);

impl Faces {
    fn quad(&mut self, corners: [[f64; 3]; 4], material: u32) {
        let face = self.0.len() as u32;
        self.0.push((Polygon::new(&corners).unwrap(), material, face));
    }

    /// The six sides of a box, without those in `open`; `inward` says whether they are seen from inside.
    fn cuboid(&mut self, min: [f64; 3], max: [f64; 3], inward: bool, open: &[usize]) {
        let corner = |x: usize, y: usize, z: usize| [[min[0], max[0]][x], [min[1], max[1]][y], [min[2], max[2]][z]];
        let c = corner;
        let sides = [
            [c(0, 0, 0), c(0, 0, 1), c(0, 1, 1), c(0, 1, 0)],
            [c(1, 0, 0), c(1, 1, 0), c(1, 1, 1), c(1, 0, 1)],
            [c(0, 0, 0), c(1, 0, 0), c(1, 0, 1), c(0, 0, 1)],
            [c(0, 1, 0), c(0, 1, 1), c(1, 1, 1), c(1, 1, 0)],
            [c(0, 0, 0), c(0, 1, 0), c(1, 1, 0), c(1, 0, 0)],
            [c(0, 0, 1), c(1, 0, 1), c(1, 1, 1), c(0, 1, 1)],
        ];
        for (side, mut corners) in sides.into_iter().enumerate() {
            if inward {
                corners.reverse();
            }
            if !open.contains(&side) {
                self.quad(corners, GREY);
            }
        }
    }

    fn scene(self) -> Scene {
        let material = |name: &str, exitance| Material { name: name.to_owned(), reflectance: vec![0.5], exitance: vec![exitance] };
        Scene::new(1, vec![material("grey", 0.0), material("light", 10.0)], self.0, Sides::Front).unwrap()
    }
}

/// A room of 5 x 4 x 2.6 m, z up, with a table, a cupboard and a light below the ceiling.
fn room() -> Faces {
    let mut faces = Faces::default();
    faces.cuboid([0.0; 3], [5.0, 4.0, 2.6], true, &[]);
    faces.cuboid([2.0, 1.5, 0.0], [3.2, 2.5, 0.75], false, &[4]);
    faces.cuboid([0.0, 3.0, 0.0], [0.6, 4.0, 2.2], false, &[0, 3, 4]);
    faces.quad([[2.0, 1.5, 2.59], [2.0, 2.5, 2.59], [3.0, 2.5, 2.59], [3.0, 1.5, 2.59]], LIGHT);
    faces
}

/// Unit Cornell box, y up, open towards +z, with two blocks and a light.
fn cornell() -> Scene {
    let mut faces = Faces::default();
    faces.cuboid([-1.0, 0.0, -1.0], [1.0, 2.0, 1.0], true, &[5]);
    faces.cuboid([-0.7, 0.0, -0.7], [-0.1, 1.2, -0.1], false, &[2]);
    faces.cuboid([0.2, 0.0, 0.0], [0.8, 0.6, 0.6], false, &[2]);
    faces.quad([[-0.3, 1.99, -0.3], [0.3, 1.99, -0.3], [0.3, 1.99, 0.3], [-0.3, 1.99, 0.3]], LIGHT);
    faces.scene()
}

/// Shares of the picture that show front faces, back faces, lights; and how many surfaces it shows.
struct Shown {
    front: f64,
    back: f64,
    light: f64,
    surfaces: usize,
}

fn shown(scene: &Scene, camera: &Camera) -> Shown {
    let visibility = build(Backend::BruteForce, &OccluderMesh::of_scene(scene)).unwrap();
    let rays = camera.rays().unwrap();
    let rays: Vec<Ray> =
        (0..camera.width * camera.height).map(|k| rays.through_pixel(k % camera.width, k / camera.width, 0, 1)).collect();
    let mut hits = vec![None; rays.len()];
    visibility.first_hits(&rays, &mut hits);
    let mut shown = Shown { front: 0.0, back: 0.0, light: 0.0, surfaces: 0 };
    let mut seen = std::collections::BTreeSet::new();
    for (ray, hit) in rays.iter().zip(hits) {
        let Some(hit) = hit else { continue };
        let part = 1.0 / rays.len() as f64;
        let facing = DVec3::from(ray.direction).dot(DVec3::from(scene.surface(SurfaceId(hit.surface)).polygon.normal())) < 0.0;
        *(if facing { &mut shown.front } else { &mut shown.back }) += part;
        if scene.material_of(SurfaceId(hit.surface)).emits() {
            shown.light += part;
        }
        seen.insert(hit.surface);
    }
    shown.surfaces = seen.len();
    shown
}

fn default_view(scene: &Scene, width: u32, height: u32) -> Camera {
    let visibility = build(Backend::BruteForce, &OccluderMesh::of_scene(scene)).unwrap();
    Camera::default_view(scene, visibility.as_ref(), width, height)
}

#[test]
fn a_closed_room_is_seen_from_inside() {
    // With a sun far away, too, which makes the bounds of the scene a thousand times as large as the room.
    let mut with_sun = room();
    with_sun.quad([[50.0, 30.0, 20.0], [50.0, 30.0, 21.0], [50.0, 31.0, 21.0], [50.0, 31.0, 20.0]], LIGHT);
    for scene in [room().scene(), with_sun.scene()] {
        let camera = default_view(&scene, 96, 72);
        let inside = camera.eye.iter().zip([5.0, 4.0, 2.6]).all(|(&x, max)| x > 0.0 && x < max);
        assert!(inside, "{camera}");
        assert_eq!(camera.up, [0.0, 0.0, 1.0]);
        let shown = shown(&scene, &camera);
        assert!(shown.front > 0.99 && shown.back < 0.001, "{} front, {} back: {camera}", shown.front, shown.back);
        assert!(shown.light < 0.3 && shown.surfaces >= 7, "{} light, {} surfaces: {camera}", shown.light, shown.surfaces);
    }
}

#[test]
fn an_open_box_is_seen_through_its_opening() {
    let scene = cornell();
    let camera = default_view(&scene, 72, 72);
    assert!(camera.eye[2] > 1.0, "{camera}");
    assert_eq!(camera.up, [0.0, 1.0, 0.0]);
    let shown = shown(&scene, &camera);
    assert!(shown.front > 0.9 && shown.back < 0.02, "{} front, {} back: {camera}", shown.front, shown.back);
    assert!(shown.light > 0.0 && shown.light < 0.2 && shown.surfaces >= 10, "{} {}: {camera}", shown.light, shown.surfaces);
}

#[test]
fn a_wide_picture_of_an_open_box_is_still_mostly_front_faces() {
    let scene = cornell();
    let shown = shown(&scene, &default_view(&scene, 96, 72));
    assert!(shown.front > 0.6 && shown.back < 0.05, "{} front, {} back", shown.front, shown.back);
}

#[test]
fn a_scene_without_walls_is_seen_from_outside_and_above() {
    let mut faces = Faces::default();
    faces.quad([[-3.0, 0.0, -3.0], [-3.0, 0.0, 3.0], [3.0, 0.0, 3.0], [3.0, 0.0, -3.0]], GREY);
    faces.cuboid([-0.5, 0.0, -0.5], [0.5, 1.0, 0.5], false, &[2]);
    faces.quad([[-0.5, 3.0, -0.5], [0.5, 3.0, -0.5], [0.5, 3.0, 0.5], [-0.5, 3.0, 0.5]], LIGHT);
    let scene = faces.scene();
    let camera = default_view(&scene, 96, 72);
    let shown = shown(&scene, &camera);
    assert!(camera.eye[1] > 0.0 && shown.front > 0.2 && shown.back < 0.05, "{} {}: {camera}", shown.front, shown.back);
}

#[test]
fn one_triangle_far_from_the_origin_is_still_a_picture() {
    let offset = 1e6;
    let corners = [[offset, 0.0, 0.0], [offset + 1e-3, 0.0, 0.0], [offset, 1e-3, 0.0]];
    let faces = Faces(vec![(Polygon::new(&corners).unwrap(), GREY, 0)]);
    let scene = faces.scene();
    let camera = default_view(&scene, 40, 30);
    assert!(camera.validate().is_ok());
    assert!(shown(&scene, &camera).front > 0.05, "{camera}");
}

#[test]
fn the_view_is_the_same_every_time() {
    let scene = room().scene();
    assert_eq!(default_view(&scene, 64, 48), default_view(&scene, 64, 48));
}
