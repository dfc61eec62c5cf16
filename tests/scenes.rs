//! The scenes in `scenes/` are what their generator writes, and they are read without any complaint.

use std::path::Path;

use patchlight::inspect::{DEFAULT_POINTS, inspect};
use patchlight::scene::import::{ImportOptions, Imported, read_scene};
use patchlight::scene::{SceneSummary, SurfaceId};
use patchlight::visibility::{Backend, NO_PLANE, OccluderMesh, Ray, Segment, build};

#[path = "../examples/generate_scenes/chang_shih.rs"]
mod chang_shih;
#[path = "../examples/generate_scenes/cornell.rs"]
mod cornell;
#[path = "../examples/generate_scenes/foliage.rs"]
mod foliage;
#[path = "../examples/generate_scenes/furnace.rs"]
mod furnace;
#[path = "../examples/generate_scenes/furniture.rs"]
mod furniture;
#[path = "../examples/generate_scenes/hall.rs"]
mod hall;
#[path = "../examples/generate_scenes/interior.rs"]
mod interior;
#[path = "../examples/generate_scenes/lischinski.rs"]
mod lischinski;
#[path = "../examples/generate_scenes/model.rs"]
mod model;
#[path = "../examples/generate_scenes/paper_rooms.rs"]
mod paper_rooms;
#[path = "../examples/generate_scenes/pyramid.rs"]
mod pyramid;
#[path = "../examples/generate_scenes/room.rs"]
mod room;
#[path = "../examples/generate_scenes/scenes.rs"]
mod scenes;
#[path = "../examples/generate_scenes/two_rooms.rs"]
mod two_rooms;
#[path = "../examples/generate_scenes/vegetation.rs"]
mod vegetation;

fn folder() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes"))
}

fn read(name: &str) -> (Imported, SceneSummary, patchlight::inspect::Inspection) {
    let imported = read_scene(&folder().join(name), &ImportOptions::default()).unwrap();
    let visibility = build(Backend::BruteForce, &OccluderMesh::of_scene(&imported.scene)).unwrap();
    let inspection = inspect(&imported.scene, visibility.as_ref(), DEFAULT_POINTS);
    let mut diagnostics = imported.diagnostics.clone();
    diagnostics.items.extend(inspection.suspicions(&imported.file, &imported.lines));
    let summary = SceneSummary::new(&imported.scene, &diagnostics);
    assert_eq!((&summary.repairs, &summary.suspicions), (&vec![], &vec![]), "{name}:\n{summary}\n{inspection:?}");
    (imported, summary, inspection)
}

/// What is said of the room with a window, and its lights as daylight.toml has them.
#[test]
fn daylight_is_lit_by_what_is_no_surface() {
    let options = ImportOptions { lights: Some(folder().join("daylight.toml")), ..ImportOptions::default() };
    let imported = read_scene(&folder().join("daylight.obj"), &options).unwrap();
    let summary = SceneSummary::new(&imported.scene, &imported.diagnostics);
    assert_eq!((summary.faces, summary.emitters, &summary.repairs, &summary.suspicions), (19, 0, &vec![], &vec![]), "{summary}");
    let kinds: Vec<&str> = summary.lights.iter().map(|light| light.kind).collect();
    assert_eq!(kinds, ["sun", "clear sky", "ies", "spot"]);
    let seen: Vec<f64> = summary.lights.iter().filter_map(|light| light.seen.map(f64::round)).collect();
    assert_eq!((seen[0], seen[1], seen[3]), (60_000.0, 12_000.0, 300.0));
    // 1200 cd times the cube of the cosine, on lines between every 5 degrees: 2 pi 1200 / 4 lm within a percent.
    assert!((seen[2] / (0.5 * std::f64::consts::PI * 1200.0) - 1.0).abs() < 0.01, "{}", seen[2]);
}

#[test]
fn the_committed_scenes_are_those_of_the_generator() {
    for (name, content) in scenes::all() {
        let committed = std::fs::read_to_string(folder().join(&name)).unwrap();
        assert!(committed == content, "scenes/{name} differs; run: cargo run --example generate_scenes");
    }
}

#[test]
fn the_furnace_is_closed_and_shines_pi_watts_a_square_metre() {
    let (_, summary, inspection) = read("furnace.obj");
    assert_eq!((summary.surfaces, summary.area, inspection.met.escaped(), inspection.met.met_back()), (6, 6.0, 0, 0));
    assert!(summary.emitted_power.iter().all(|power| (power / (6.0 * std::f64::consts::PI) - 1.0).abs() < 1e-15));
}

#[test]
fn the_cornell_box_has_its_published_measures() {
    let (imported, summary, inspection) = read("cornell.obj");
    assert_eq!((summary.faces, summary.emitters, inspection.met.met_back()), (20, 1, 0));
    assert_eq!(summary.bounds, [[0.0, 0.0, 0.0], [0.556, 0.5488, 0.5592]]);
    let light = imported.scene.surfaces().iter().find(|s| imported.scene.materials()[s.material as usize].emits()).unwrap();
    assert!((light.polygon.area() - 0.130 * 0.105).abs() < 1e-15);
    assert_eq!(light.polygon.normal(), [0.0, -1.0, 0.0]);
}

/// Directions spread evenly over the sphere (a spiral with the golden angle).
fn directions(count: u32) -> impl Iterator<Item = [f64; 3]> {
    (0..count).map(move |k| {
        let height = 1.0 - (2.0 * f64::from(k) + 1.0) / f64::from(count);
        let (sin, cos) = (f64::from(k) * 2.399_963_229_728_653).sin_cos();
        let radius = (1.0 - height * height).sqrt();
        [radius * cos, height, radius * sin]
    })
}

#[test]
fn the_room_is_closed_and_nothing_in_it_is_inside_out() {
    let (imported, summary, inspection) = read("room.obj");
    assert_eq!(inspection.met.escaped(), 0, "{inspection:?}");
    assert!((400..=900).contains(&summary.faces), "{}", summary.faces);
    assert!(summary.emitters >= 2);
    assert!((summary.bounds[1][0] - summary.bounds[0][0] - 5.16).abs() < 1e-12);

    // Whatever is seen from free points of the room shows its front.
    let scene = &imported.scene;
    let visibility = build(Backend::BruteForce, &OccluderMesh::of_scene(scene)).unwrap();
    for origin in [[4.72, 1.62, 3.82], [2.5, 2.3, 0.8], [1.5, 0.2, 3.7], [2.0, 0.2, 2.0], [2.6, 0.9, 1.1], [0.3, 0.75, 0.5]] {
        let rays: Vec<Ray> = directions(1500).map(|direction| Ray { origin, direction, origin_plane: NO_PLANE }).collect();
        let mut hits = vec![None; rays.len()];
        visibility.first_hits(&rays, &mut hits);
        for (ray, hit) in rays.iter().zip(hits) {
            let surface = &scene.surfaces()[hit.expect("the room is closed").surface as usize];
            let cosine: f64 = surface.polygon.normal().iter().zip(ray.direction).map(|(n, d)| n * d).sum();
            let line = imported.lines[surface.face as usize];
            assert!(cosine < 0.0 || surface.twin().is_some(), "from {origin:?} the back of the face in line {line} is seen");
        }
    }
}

#[test]
fn the_five_rooms_have_the_papers_numbers_of_polygons_and_are_closed() {
    let rooms = [("full_office", 170), ("dining_room", 402), ("east_room", 1006), ("west_room", 1647), ("hevea", 2355)];
    for (name, polygons) in rooms {
        let (_, summary, inspection) = read(&format!("{name}.obj"));
        assert_eq!((summary.faces, summary.surfaces, inspection.met.escaped()), (polygons, polygons, 0), "{name}");
        assert!(summary.emitters >= 2, "{name}");
    }
}

/// Polygons, emitters, edges of these and of all others, and whether light leaves: only through the openings of the sunlit room.
#[test]
fn the_scenes_of_the_thesis_have_its_numbers_of_polygons_and_lights() {
    let scenes = [
        ("exhibit_room", [47, 2, 8, 173], false),
        ("sunlit_room", [1688, 2, 8, 6744], true),
        ("gallery", [534, 6, 24, 2112], false),
        ("panelled_room", [2892, 6, 26, 11544], false),
    ];
    for (name, numbers, is_open) in scenes {
        let (imported, _, inspection) = read(&format!("{name}.obj"));
        let scene = &imported.scene;
        let corners = |is_counted: &dyn Fn(SurfaceId) -> bool| -> Vec<usize> {
            let ids = (0..scene.surfaces().len() as u32).map(SurfaceId).filter(|&id| is_counted(id));
            ids.map(|id| scene.surface(id).polygon.vertices().count()).collect()
        };
        let emits = |id: SurfaceId| scene.material_of(id).emits();
        let (dark, shining) = (corners(&|id| !emits(id)), corners(&emits));
        assert_eq!([dark.len() + shining.len(), shining.len(), shining.iter().sum(), dark.iter().sum()], numbers, "{name}");
        assert_eq!(inspection.met.escaped() > 0, is_open, "{name}");
    }
}

/// From no point of the other room a ray to the lamp gets through.
#[test]
fn of_the_two_rooms_one_sees_no_lamp() {
    let (imported, summary, inspection) = read("two_rooms.obj");
    assert_eq!((summary.faces, summary.emitters, inspection.met.escaped(), inspection.met.met_back()), (40, 1, 0, 0));
    let scene = &imported.scene;
    let visibility = build(Backend::BruteForce, &OccluderMesh::of_scene(scene)).unwrap();
    let lamp = (0..scene.surfaces().len() as u32).map(SurfaceId).find(|&id| scene.material_of(id).emits()).unwrap();
    let lamp = scene.surface(lamp);
    let corners: Vec<[f64; 3]> = lamp.polygon.vertices().collect();
    let (mut segments, steps) = (Vec::new(), 12);
    for to in &corners {
        for step in 0..steps * steps * steps {
            let along = |number: usize, from: f64, to: f64| from + (to - from) * (number as f64 + 0.5) / steps as f64;
            let x = along(step % steps, 4.2, 8.2);
            let from = [x, along(step / steps % steps, 0.0, 2.6), along(step / steps / steps, 0.0, 4.0)];
            segments.push(Segment { from, to: *to, from_plane: NO_PLANE, to_plane: lamp.plane() });
        }
    }
    let mut occluded = vec![false; segments.len()];
    visibility.occluded(&segments, &mut occluded);
    assert!(occluded.iter().all(|&occluded| occluded));
}

#[test]
fn the_scenes_for_bottom_up_refinement_have_the_papers_numbers_of_polygons() {
    // The back of its lamp is seen, as that of anything that hides polygons from each other and is one polygon itself.
    let imported = read_scene(&folder().join("four_polygons.obj"), &ImportOptions::default()).unwrap();
    assert!(imported.diagnostics.items.is_empty(), "{:?}", imported.diagnostics);
    let areas: Vec<f64> = imported.scene.surfaces().iter().map(|surface| surface.polygon.area()).collect();
    assert!(areas.iter().zip([1.0, 1.0, 1.0, 0.25]).all(|(area, expected)| (area - expected).abs() < 1e-12), "{areas:?}");
    assert_eq!(areas.len(), 4);
    let (_, summary, inspection) = read("living_room.obj");
    assert_eq!((summary.faces, summary.surfaces, inspection.met.escaped()), (246, 246, 0));
}

/// The floor alone reflects, so that its light is direct light.
#[test]
fn the_pyramid_is_black_under_two_small_lights() {
    let (imported, summary, _) = read("pyramid.obj");
    assert_eq!((summary.faces, summary.emitters), (7, 2));
    let scene = &imported.scene;
    let reflecting: Vec<f64> = (0..scene.surfaces().len() as u32)
        .map(SurfaceId)
        .filter(|&id| scene.material_of(id).reflectance.iter().any(|&rho| rho > 0.0))
        .map(|id| scene.surface(id).polygon.area())
        .collect();
    assert_eq!(reflecting, [16.0]);
}

#[test]
fn halls_have_as_many_polygons_as_asked_for_and_depend_on_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    for polygons in [1000, 2345, 5000] {
        let (obj, mtl) = hall::hall(polygons, 7).write("hall");
        assert!((obj.clone(), mtl.clone()) == hall::hall(polygons, 7).write("hall"));
        assert!(obj != hall::hall(polygons, 8).write("hall").0);
        std::fs::write(folder.path().join("hall.obj"), obj).unwrap();
        std::fs::write(folder.path().join("hall.mtl"), mtl).unwrap();
        let (_, summary, inspection) = read(folder.path().join("hall.obj").to_str().unwrap());
        assert_eq!((summary.surfaces, inspection.met.escaped()), (polygons, 0));
    }
}

#[test]
fn the_shrub_has_its_leaves_under_a_sky_without_a_gap() {
    // Limbs grow out of one another, so some points lie inside of others and see their backs.
    let (imported, summary, inspection) = read("shrub.obj");
    assert!(inspection.met.escaped() == 0 && 100 * inspection.met.met_back() < inspection.met.rays, "{inspection:?}");
    assert_eq!((summary.sheets, summary.emitters), (2000, 10));

    // The leaves that were asked for, of the area that was asked for, one side.
    let scene = &imported.scene;
    let is_leaf = |material: u32| scene.materials()[material as usize].name.starts_with("leaf");
    let leaves = scene.surfaces().iter().filter(|surface| is_leaf(surface.material));
    let area: f64 = leaves.map(|surface| surface.polygon.area()).sum();
    assert!((area / 12.0 - 1.0).abs() < 1e-6, "{area} m^2");
}

#[test]
fn vegetation_has_as_many_leaves_as_asked_for_and_depends_on_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    for (kind, count, sheets) in [("tree", 1500, 1500), ("hedge", 700, 700), ("garden", 1000, 1000), ("maize", 12, 12 * 12 * 6)] {
        let (obj, mtl) = vegetation::of_kind(kind, count, 7).unwrap().write(kind);
        assert!((obj.clone(), mtl.clone()) == vegetation::of_kind(kind, count, 7).unwrap().write(kind));
        assert!(obj != vegetation::of_kind(kind, count, 8).unwrap().write(kind).0);
        let file = folder.path().join(format!("{kind}.obj"));
        std::fs::write(&file, obj).unwrap();
        std::fs::write(file.with_extension("mtl"), mtl).unwrap();
        let imported = read_scene(&file, &ImportOptions::default()).unwrap();
        let summary = SceneSummary::new(&imported.scene, &imported.diagnostics);
        assert_eq!((summary.sheets, &summary.repairs), (sheets, &vec![]), "{kind}");
    }
    assert!(vegetation::of_kind("fern", 1, 1).is_none());
}
