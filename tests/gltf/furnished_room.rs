//! The furnished room as a GLB of single triangles, turned and moved by its nodes: as many surfaces as of polygons, and the same light.

use std::path::Path;

use patchlight::scene::import::{ImportOptions, read_scene};

use super::glb::scene_as_glb;
use super::read;
use super::same_light::{assert_same_areas, assert_same_light};

#[test]
fn a_room_of_triangles_is_that_of_polygons() {
    let room = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/room.obj");
    let of_obj = read_scene(&room, &ImportOptions::default()).unwrap().scene;
    let of_glb = read(&scene_as_glb(&of_obj)).unwrap().scene;
    let counts = (of_glb.surfaces().len(), of_obj.surfaces().len());
    assert!(counts.0 <= counts.1, "{counts:?}");
    assert_same_areas("room", &of_glb, &of_obj);
    assert_same_light(&of_glb, &of_obj);
}
