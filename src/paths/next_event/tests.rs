//! Next-event estimation against what all emitters bring, and how much a single ray may weigh.

use glam::DVec3;

use super::*;
use crate::geometry::Polygon;
use crate::paths::Place;
use crate::scene::{Material, Scene, Sides};
use crate::transmittance::Rays;
use crate::visibility::{Backend, OccluderMesh, build};

/// A floor and `count` small emitters above it, turned every way, some behind others.
fn emitters_over_a_floor(count: u64) -> Scene {
    let material = |reflectance: f64, exitance: f64| Material {
        name: format!("{exitance}"),
        reflectance: vec![reflectance],
        exitance: vec![exitance],
    };
    let quad =
        |corner: DVec3, u: DVec3, v: DVec3| Polygon::from_vertices(vec![corner, corner + u, corner + u + v, corner + v]).unwrap();
    let mut faces = vec![(quad(DVec3::ZERO, 10.0 * DVec3::X, 10.0 * DVec3::Y), 0, 0)];
    for emitter in 0..count {
        let random = |draw| sampling::unit(sampling::hash(emitter, draw));
        let direction = |draw| (DVec3::new(random(draw), random(draw + 1), random(draw + 2)) - 0.5).normalize();
        let normal = (direction(10) - 0.6 * DVec3::Z).normalize();
        let u = normal.cross(direction(20)).normalize();
        let corner = DVec3::new(10.0 * random(1), 10.0 * random(2), 0.5 + 3.0 * random(3));
        faces.push((quad(corner, 0.1 * u, 0.1 * normal.cross(u)), 1 + (emitter % 3) as u32, 1 + emitter as u32));
    }
    let materials = vec![material(0.5, 0.0), material(0.0, 1.0), material(0.0, 5.0), material(0.0, 20.0)];
    Scene::new(1, materials, faces, Sides::Front).unwrap()
}

fn places(seed: u64) -> Vec<Place> {
    let place = |k: u64| {
        let coordinate = |draw| 10.0 * sampling::unit(sampling::hash(k, draw));
        let point = DVec3::new(coordinate(40), coordinate(41), 0.0);
        Place { point, surface: SurfaceId(0), seed: sampling::hash(seed, k) }
    };
    (0..20).map(place).collect()
}

#[test]
fn emitters_from_the_tree_bring_what_all_bring() {
    let scene = emitters_over_a_floor(1000);
    let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
    let rays = Rays::new(&*visibility, &scene);
    let emitters = Emitters::new(&scene, &rays);

    // With more rays than emitters every emitter gets its share of rays. 16 rays draw emitters, a thousand times: for each
    // place alone, or for four places together, which lie metres apart. So do single rays, without control variates.
    let mut expected = vec![0.0; 20];
    let mut memory = EmitterRays::default();
    emitters.add_sampled_irradiance(&places(1), 1, 50_000, &mut memory, &mut BatchSums::whole(1, &mut expected));
    for (together, count) in [(1, 16), (4, 16), (1, 1)] {
        let (mut sum, mut sum_sq) = (vec![0.0; 20], vec![0.0; 20]);
        let rounds = 1000;
        for round in 0..rounds {
            let mut found = vec![0.0; 20];
            emitters.add_sampled_irradiance(
                &places(100 + round),
                together,
                count,
                &mut memory,
                &mut BatchSums::whole(1, &mut found),
            );
            found.iter().zip(sum.iter_mut().zip(sum_sq.iter_mut())).for_each(|(h, (sum, sum_sq))| {
                *sum += h;
                *sum_sq += h * h;
            });
        }
        for (place, expected) in expected.iter().enumerate() {
            let n = rounds as f64;
            let mean = sum[place] / n;
            let sigma = ((sum_sq[place] / n - mean * mean) / n).sqrt();
            // What is expected has noise of its own, less than 0.3% with 50 rays to an emitter on average.
            let off = (mean - expected).abs();
            assert!(
                off <= 4.5 * sigma + 0.003 * expected,
                "{together}, {count} rays, place {place}: {mean} +- {sigma}, not {expected}"
            );
            let scatter = sigma * n.sqrt() / mean;
            assert!(scatter < 1.0 || together > 1 || count == 1, "place {place}: a single sample scatters by {scatter}");
        }
    }
}

/// A place a hand's breadth, and a millimetre, below a ceiling that glows: parts of it are drawn as all pieces would be.
#[test]
fn single_rays_to_a_large_emitter_near_by_bring_its_form_factor() {
    let square = |z: f64, half: f64, down: bool| {
        let corners = [[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]];
        Polygon::new(&if down { [corners[0], corners[3], corners[2], corners[1]] } else { corners }).unwrap()
    };
    let material = |exitance: f64| Material { name: String::new(), reflectance: vec![0.5], exitance: vec![exitance] };
    let faces = vec![(square(0.0, 1.0, false), 0, 0), (square(0.1, 2.0, true), 1, 1), (square(3.0, 1.0, true), 1, 2)];
    for height in [0.0, 0.099] {
        let scene = Scene::new(1, vec![material(0.0), material(1.0)], faces.clone(), Sides::Front).unwrap();
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);
        let emitters = Emitters::new(&scene, &rays);
        let (point, normal) = (DVec3::new(0.3, 0.2, height), DVec3::Z);
        let expected = point_to_polygon(point, normal, &scene.surface(SurfaceId(1)).polygon.facet());
        let (mut sum, mut sum_sq, count) = (0.0, 0.0, 4000);
        for seed in 0..count {
            let (mut memory, mut found) = (EmitterRays::default(), vec![0.0]);
            let place = Place { point, surface: SurfaceId(0), seed: sampling::hash(5, seed) };
            emitters.add_sampled_irradiance(&[place], 1, 1, &mut memory, &mut BatchSums::whole(1, &mut found));
            sum += found[0];
            sum_sq += found[0] * found[0];
        }
        // The other emitter is hidden. A single ray to what is seen weighs no more than a few times all.
        let mean = sum / count as f64;
        let deviation = (sum_sq / count as f64 - mean * mean).sqrt();
        assert!((mean - expected).abs() < 4.0 * deviation / (count as f64).sqrt(), "{mean} for {expected} at {height}");
        assert!(deviation < 0.7 * mean, "{deviation} of {mean} at {height}");
    }
}

#[test]
fn an_emitter_beside_a_place_is_drawn_by_what_it_sends_however_large_its_group() {
    // Emitters far apart, and places a hand's breadth from each of them.
    let scene = emitters_over_a_floor(200);
    let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
    let rays = Rays::new(&*visibility, &scene);
    let emitters = Emitters::new(&scene, &rays);
    for beside in &emitters.emitters {
        let facet = beside.facet(&scene);
        let (point, normal) = (facet.centroid + 0.1 * facet.normal, -facet.normal);
        let sends = |number: u32| {
            let emitter = &emitters.emitters[number as usize];
            point_to_polygon(point, normal, &emitter.facet(&scene)) * brightest(&scene, emitter.surface)
        };
        let mut draws = Draws::default();
        let numbers = (0..64).map(|k| (f64::from(k) + 0.5) / 64.0);
        let tree = emitters.tree.as_ref().unwrap();
        tree.draw(std::iter::once(point), normal, sends, numbers, &mut draws);

        // Probabilities are those of draws, and those of all sources add up to less than 1 by as much as draws find nothing.
        let probability = |number: u32| tree.probability(number, point, normal, sends);
        for drawn in &draws.drawn {
            assert!((probability(drawn.number) / drawn.probability - 1.0).abs() < 1e-12);
        }
        let of_all: f64 = (0..emitters.emitters.len() as u32).map(probability).sum();
        assert!((of_all - draws.drawn.len() as f64 / 64.0).abs() < 0.05 && of_all < 1.0 + 1e-9, "{of_all}");

        // Every ray stands for at most a few times all that arrives.
        let all: f64 = (0..emitters.emitters.len() as u32).map(sends).sum();
        for emitter in draws.drawn {
            assert!(
                sends(emitter.number) / emitter.probability <= 4.0 * all,
                "{:?} of {all} by {}",
                sends(emitter.number),
                emitter.probability
            );
        }
    }
}

#[test]
fn no_ray_weighs_much_however_near_an_emitter_is() {
    // A lamp of a square metre faces the floor from so high.
    for height in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5] {
        let material = |exitance: f64| Material { name: format!("{exitance}"), reflectance: vec![0.5], exitance: vec![exitance] };
        let square = |corner: DVec3, u: DVec3, v: DVec3| {
            Polygon::from_vertices(vec![corner, corner + u, corner + u + v, corner + v]).unwrap()
        };
        let lamp = square(DVec3::new(1.0, 1.0, height), DVec3::Y, DVec3::X);
        let faces = vec![(square(DVec3::ZERO, 3.0 * DVec3::X, 3.0 * DVec3::Y), 0, 0), (lamp, 1, 1)];
        let scene = Scene::new(1, vec![material(0.0), material(1.0)], faces, Sides::Front).unwrap();
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);
        let (emitters, memory) = (Emitters::new(&scene, &rays), &mut EmitterRays::default());
        for at in [[1.43, 1.71], [1.001, 1.5], [0.9995, 1.2]] {
            let place = Place { point: DVec3::new(at[0], at[1], 0.0), surface: SurfaceId(0), seed: 1 };
            emitters.add_sampled_irradiance(&[place], 1, 256, memory, &mut BatchSums::whole(1, &mut [0.0]));
            let most = memory.drawn.iter().map(|drawn| drawn.sampled / drawn.form_factor).fold(0.0, f64::max);
            // A piece is at least twice its radius away, so its points lie no nearer than half of its distance; between parallel planes the
            // kernel goes with the fourth power of that.
            assert!(most < 16.0, "a sample of {most} times the form factor from {height} at {at:?}");
            assert!(memory.pieces.len() < 500, "{} pieces from {height} at {at:?}", memory.pieces.len());
        }
    }
}

/// Corners with the digits of a file are a little off one plane, so points of a sheet lie before or behind it: of its own back they see nothing.
#[test]
fn a_sheet_does_not_light_itself_from_behind() {
    let u = DVec3::new(1.0, 2.0, -3.0).normalize();
    let v = DVec3::new(3.0, 1.0, 2.0).cross(u).normalize();
    let corner = DVec3::new(0.1, 0.2, 0.3);
    let written = |corner: DVec3| (1e8 * corner).round() * 1e-8;
    let corners = [corner, corner + u, corner + u + v, corner + v].map(written);
    let sheet = Polygon::from_vertices(corners.to_vec()).unwrap();
    let glowing = Material { name: String::new(), reflectance: vec![0.5], exitance: vec![1.0] };
    let scene = Scene::new(1, vec![glowing], vec![(sheet, 0, 0)], Sides::Both).unwrap();
    let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
    let rays = Rays::new(&*visibility, &scene);
    let (emitters, memory) = (Emitters::new(&scene, &rays), &mut EmitterRays::default());

    // Points of the triangle of three corners.
    let random = |k: u64, draw| sampling::unit(sampling::hash(k, draw));
    let [u, v] = [corners[1] - corners[0], corners[2] - corners[0]];
    let point = |k: u64| corners[0] + 0.5 * (random(k, 1) * u + random(k, 2) * v);
    let places: Vec<Place> = (0..2000).map(|k| Place { point: point(k), surface: SurfaceId(k as u32 / 1000), seed: k }).collect();
    let height = |place: &Place| scene.surface(place.surface).polygon.facet().height(place.point);
    assert!(places.iter().all(|place| height(place).abs() < 1e-7) && places.iter().any(|place| height(place) < -1e-10));
    // By so many rays all emitters get some, or each ray draws one.
    for count in [1, 8] {
        let mut irradiance = vec![0.0; places.len()];
        emitters.add_sampled_irradiance(&places, 1, count, memory, &mut BatchSums::whole(1, &mut irradiance));
        assert!(irradiance.iter().all(|&h| h == 0.0), "{count} rays: {irradiance:?}");
    }
}

#[test]
fn rays_do_not_grow_with_the_number_of_emitters() {
    for count in [1, 16, 17, 1000] {
        let scene = emitters_over_a_floor(count);
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);
        let (emitters, memory) = (Emitters::new(&scene, &rays), &mut EmitterRays::default());
        emitters.add_sampled_irradiance(&places(1), 1, 24, memory, &mut BatchSums::whole(1, &mut [0.0; 20]));
        let cast = rays.segments().count();
        assert!(cast + rays.spared() <= 20 * 24, "{count} emitters: {cast} rays");
    }
}

/// A lamp over a floor, cut into so many strips both ways.
fn lamp_in_pieces(side: u32) -> Scene {
    let at = |k: u32| 4.0 + 2.0 * f64::from(k) / f64::from(side);
    let piece = |i: u32, j: u32| {
        Polygon::new(&[[at(i), at(j), 2.0], [at(i), at(j + 1), 2.0], [at(i + 1), at(j + 1), 2.0], [at(i + 1), at(j), 2.0]]).unwrap()
    };
    let floor = Polygon::new(&[[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [10.0, 10.0, 0.0], [0.0, 10.0, 0.0]]).unwrap();
    let material = |exitance: f64| Material { name: format!("{exitance}"), reflectance: vec![0.5], exitance: vec![exitance] };
    let pieces = (0..side).flat_map(|i| (0..side).map(move |j| (piece(i, j), 1, 1)));
    Scene::new(1, vec![material(0.0), material(1.0)], std::iter::once((floor, 0, 0)).chain(pieces).collect(), Sides::Front).unwrap()
}

#[test]
fn into_how_many_pieces_a_lamp_is_cut_changes_nothing() {
    let found = [1, 8].map(|side| {
        let scene = lamp_in_pieces(side);
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        let rays = Rays::new(&*visibility, &scene);
        let (emitters, memory) = (Emitters::new(&scene, &rays), &mut EmitterRays::default());
        assert_eq!(emitters.emitters.len(), 1);
        let mut irradiance = vec![0.0; 20];
        emitters.add_sampled_irradiance(&places(1), 1, 8, memory, &mut BatchSums::whole(1, &mut irradiance));
        (irradiance, rays.segments().count() + rays.spared())
    });
    assert_eq!(found[0].1, found[1].1);
    // Nothing is in between, so all is exact, up to the rounding of corners.
    found[0].0.iter().zip(&found[1].0).for_each(|(whole, cut)| assert!((whole / cut - 1.0).abs() < 1e-9, "{whole} and {cut}"));
}

#[test]
fn places_together_draw_the_emitters_of_one_place_with_all_of_their_rays() {
    let scene = emitters_over_a_floor(1000);
    let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
    let rays = Rays::new(&*visibility, &scene);
    let emitters = Emitters::new(&scene, &rays);
    let drawn = |places: &[Place], together: usize, count: u32| {
        let mut memory = EmitterRays::default();
        let mut irradiance = vec![0.0; places.len()];
        emitters.add_sampled_irradiance(places, together, count, &mut memory, &mut BatchSums::whole(1, &mut irradiance));
        let mut drawn: Vec<u32> = memory.drawn.iter().map(|drawn| drawn.surface.0).collect();
        drawn.sort_unstable();
        drawn
    };
    for place in places(3) {
        assert_eq!(drawn(&[place; 4], 4, 4), drawn(&[place], 1, 16));
    }
}

/// A lamp that reaches below the horizon of a place on a wall, where a board behind the wall hides it: several rays, which go to the rest alone, tell exactly
/// what it brings. The same with a screen before the half of the rest that brings most: by few rays it is neither brighter nor darker than it is, by many
/// at most a little. From afar the lamp is one piece, from near by it is several.
#[test]
fn however_many_rays_bring_what_is_above_the_horizon_and_not_hidden() {
    let quad = |[x0, x1]: [f64; 2], [y0, y1]: [f64; 2], z: f64| {
        Polygon::new(&[[x0, y0, z], [x0, y1, z], [x1, y1, z], [x1, y0, z]]).unwrap()
    };
    let wall = Polygon::new(&[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 3.5], [-1.0, 0.0, 3.5]]).unwrap();
    let material = |rho: f64, exitance: f64| Material { name: String::new(), reflectance: vec![rho], exitance: vec![exitance] };
    let materials = vec![material(0.5, 0.0), material(0.0, 1.0), material(0.0, 0.0)];
    let normal = wall.facet().normal;
    for (height, is_hidden) in [(2.5, false), (2.5, true), (3.0, false), (3.0, true)] {
        // Board and screen are half-way up to the lamp. The board ends just behind the wall, or rays along the wall would touch it.
        let middle = 0.5 * (height + 4.0);
        let [lamp, board, screen] =
            [([-0.6, 0.4], 4.0), ([0.001, 3.0], middle), ([-3.0, -0.15], middle)].map(|(y, z)| quad([-0.5, 0.5], y, z));
        let mut faces = vec![(wall.clone(), 0, 0), (lamp, 1, 1), (board, 2, 2)];
        faces.extend(is_hidden.then_some((screen, 2, 3)));
        let scene = Scene::new(1, materials.clone(), faces, Sides::Front).unwrap();
        let visibility = build(Backend::default(), &OccluderMesh::of_scene(&scene)).unwrap();
        // Where nothing stands in front of both planes rays would not be asked, as they are in rooms with furniture.
        let rays = Rays::new(&*visibility, &scene).asking_between_clear_planes().asking_in_clear_scenes();
        let (emitters, mut memory) = (Emitters::new(&scene, &rays), EmitterRays::default());

        let place = |seed: u64| Place { point: DVec3::new(0.0, 0.0, height), surface: SurfaceId(0), seed };
        let seen = quad([-0.5, 0.5], [if is_hidden { -0.3 } else { -0.6 }, 0.0], 4.0);
        let expected = point_to_polygon(place(0).point, normal, &seen.facet());
        for count in [1, 2, 3, 5, 7, 8, 11, 15, 16, 17, 24, 51] {
            let (mut sum, mut sum_sq) = (0.0, 0.0);
            let rounds = 50_000;
            for round in 0..rounds {
                let mut found = [0.0];
                let place = place(sampling::hash(round, u64::from(count)));
                emitters.add_sampled_irradiance(&[place], 1, count, &mut memory, &mut BatchSums::whole(1, &mut found));
                let is_exact = is_hidden || count == 1 || (found[0] / expected - 1.0).abs() < 1e-9;
                assert!(is_exact, "{} for {expected} by {count} rays from {height}", found[0]);
                sum += found[0];
                sum_sq += found[0] * found[0];
            }
            let mean = sum / rounds as f64;
            let deviation = ((sum_sq / rounds as f64 - mean * mean).max(0.0) / rounds as f64).sqrt();
            let allowed = 4.0 * deviation + if count > FEW_RAYS { 0.003 * expected } else { 1e-9 };
            assert!(
                (mean - expected).abs() < allowed,
                "{mean} for {expected} by {count} rays from {height}, give or take {deviation}"
            );
        }
    }
}
