//! Groups of coplanar surfaces.
//!
//! A surface never hides anything from a point in its own plane, so visibility leaves the surfaces of both end planes alone. A wrong
//! split only costs false self-occlusion along shared edges, a wrong join lets light through a wall: joins are strict.
//!
//! # Tolerance
//! Surfaces are taken from the widest to the narrowest, since a wide one knows its normal best. The first surface of a group fixes its
//! plane, through its centroid. Another belongs to it if each of its vertices lies within its own [`tolerance`](Precision::of) of that
//! plane, and its normal or the reverse is within [`ANGLE_TOLERANCE`]; of several planes the nearest is taken, so that a number stands for
//! one plane within the tolerance, however long a chain of nearly coplanar surfaces is. Twins always share one.
//!
//! # Cost
//! O(n log n): planes are found in cells of similar normals, sorted by their offset from the scene's centre. A surface that is narrow
//! beside the tolerance knows its own offset badly and looks at a wider range of planes.

use std::collections::{BTreeMap, HashMap};

use glam::DVec3;
use rayon::prelude::*;

use super::{Scene, Surface};
use crate::geometry::{Facet, median};

/// Distance from a plane that still counts as in it, as a fraction of the size that [`Precision`] tells: files give six or seven digits.
const DISTANCE_TOLERANCE: f64 = 1e-6;

/// How closely places are known: files round coordinates to so many digits, or to so many decimals.
struct Precision {
    /// The scene's diagonal.
    most: f64,
    /// Four times the median distance of a vertex from the median of all, which is about the diagonal, unless a few surfaces lie far away:
    /// a ground of many kilometres must not blur the room that stands on it.
    typical: f64,
}

impl Precision {
    fn new(scene: &Scene) -> Self {
        // Where all surfaces are sides of sheets, one side of each has the same medians as both.
        let are_sheets = scene.surfaces.par_iter().all(|surface| surface.twin.is_some());
        let counts = |(index, surface): &(usize, &Surface)| !are_sheets || surface.twin.is_some_and(|twin| twin.index() > *index);
        let counted = scene.surfaces.par_iter().enumerate().filter(counts);
        let vertices: Vec<DVec3> = counted.flat_map_iter(|(_, surface)| surface.polygon.facet().vertices).copied().collect();
        let along = |axis: usize| median(vertices.iter().map(|vertex| vertex[axis]).collect());
        let (x, (y, z)) = rayon::join(|| along(0), || rayon::join(|| along(1), || along(2)));
        let middle = DVec3::new(x, y, z);
        let typical = 4.0 * median(vertices.par_iter().map(|vertex| vertex.distance(middle)).collect());
        Self { most: scene.bounds().diagonal(), typical }
    }

    /// How far the vertices of a surface may lie off the plane that they are in.
    fn of(&self, surface: &Surface) -> f64 {
        let farthest = surface.polygon.facet().vertices.iter().map(|vertex| vertex.abs().max_element()).fold(0.0, f64::max);
        DISTANCE_TOLERANCE * self.typical.max(2.0 * farthest).min(self.most)
    }
}

/// Angle in radians that normals may differ by. It keeps small facets of curved surfaces, which lie within the distance of many planes,
/// out of planes that only pass through them.
pub(super) const ANGLE_TOLERANCE: f64 = 1e-3;

/// Side of a cell of normals: large beside the angle, so that a surface rarely has to look into more than one.
const CELL: f64 = 16.0 * ANGLE_TOLERANCE;

/// A plane in Hessian form: `normal . (x - centre of the scene) = offset`.
#[derive(Clone, Copy)]
struct Plane {
    normal: DVec3,
    offset: f64,
}

impl Scene {
    /// How closely most places of the scene are known, in metres: what is nearer to each other counts as touching.
    pub(crate) fn contact_tolerance(&self) -> f64 {
        let Precision { most, typical } = Precision::new(self);
        DISTANCE_TOLERANCE * typical.min(most)
    }

    /// Numbers the planes: two surfaces get the same number if and only if they lie in one plane, on either side of it.
    ///
    /// Numbers count from 0 in the order of the surfaces.
    pub(super) fn group_planes(&mut self) {
        let centre = self.bounds().centre();
        let precision = Precision::new(self);

        // From the widest to the narrowest, in the input's order where equally wide; of two twins only the first.
        let width = |surface: &Surface| surface.polygon.area() / surface.polygon.facet().radius;
        let mut order: Vec<(f64, usize)> = (self.surfaces.par_iter().enumerate())
            .filter(|(index, surface)| surface.twin.is_none_or(|twin| twin.index() > *index))
            .map(|(index, surface)| (width(surface), index))
            .collect();
        order.par_sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));

        // What each asks for, in parallel; then the planes, one after the other.
        let sought = |&(_, index): &(f64, usize)| {
            let surface = &self.surfaces[index];
            (index, Sought::new(surface.polygon.facet(), centre, precision.of(surface)))
        };
        let sought: Vec<(usize, Sought)> = order.par_iter().map(sought).collect();
        let mut finder = PlaneFinder::new(centre);
        let mut plane_of = vec![u32::MAX; self.surfaces.len()];
        for (index, sought) in sought {
            plane_of[index] = finder.find_or_add(&sought, || self.surfaces[index].polygon.facet().vertices);
        }
        for (index, surface) in self.surfaces.iter().enumerate() {
            if let Some(twin) = surface.twin.filter(|twin| twin.index() < index) {
                plane_of[index] = plane_of[twin.index()];
            }
        }

        // Renumber in the order of the surfaces.
        let mut number = vec![u32::MAX; finder.count as usize];
        let mut next = 0;
        for (surface, plane) in self.surfaces.but_polygons_mut().iter_mut().zip(plane_of) {
            let number = &mut number[plane as usize];
            if *number == u32::MAX {
                *number = next;
                next += 1;
            }
            surface.plane = *number;
        }
    }
}

/// The planes that a surface may lie in.
struct Sought {
    /// Its own.
    own: Plane,
    /// Its centroid, from the scene's centre.
    centroid: DVec3,
    /// How far the offset of another may be off.
    reach: f64,
    /// How far its vertices may lie off.
    tolerance: f64,
    /// What rounding may make of an offset.
    rounding: f64,
}

impl Sought {
    fn new(facet: Facet<'_>, centre: DVec3, tolerance: f64) -> Self {
        let centroid = facet.centroid - centre;
        let (arm, rounding) = (centroid.length(), 1e-12 * (centroid.length() + facet.radius));
        // If all vertices lie within the tolerance of a plane, the normals differ by at most twice the tolerance over the least width of
        // the polygon, which is at least area / (2 radius). That bounds how far the offset along the own normal can be off.
        let angle = (4.0 * tolerance * facet.radius / facet.area).min(ANGLE_TOLERANCE) + 1e-12;
        let own = Plane { normal: facet.normal, offset: facet.normal.dot(centroid) };
        Self { own, centroid, reach: tolerance + angle * arm + rounding, tolerance, rounding }
    }
}

/// The planes so far with their numbers, sorted by offset in cells of similar normals.
struct PlaneFinder {
    centre: DVec3,
    count: u32,
    cells: HashMap<u32, BTreeMap<(u64, u32), Plane>>,
}

impl PlaneFinder {
    fn new(centre: DVec3) -> Self {
        Self { centre, count: 0, cells: HashMap::new() }
    }

    /// The nearest plane that a surface with these vertices lies in, else a new one through it.
    fn find_or_add<'a>(&mut self, sought: &Sought, vertices: impl Fn() -> &'a [DVec3]) -> u32 {
        let &Sought { own, reach, tolerance, rounding, .. } = sought;
        let mut best: Option<(f64, u32)> = None;
        for Plane { normal, offset } in [own, Plane { normal: -own.normal, offset: -own.offset }] {
            for cell in cells_around(normal) {
                let Some(cell) = self.cells.get(&cell) else { continue };
                for (&(_, index), plane) in cell.range((sortable(offset - reach), 0)..=(sortable(offset + reach), u32::MAX)) {
                    // A polygon that lies in it has its centroid there; few do, so the vertices of few are fetched.
                    let height = |from_centre: DVec3| (plane.normal.dot(from_centre) - plane.offset).abs();
                    if (plane.normal - normal).length() > ANGLE_TOLERANCE || height(sought.centroid) > tolerance + rounding {
                        continue;
                    }
                    let height = |vertex: &DVec3| height(*vertex - self.centre);
                    let distance = vertices().iter().map(height).fold(0.0, f64::max);
                    if distance <= tolerance && best.is_none_or(|best| (distance, index) < best) {
                        best = Some((distance, index));
                    }
                }
            }
        }
        if let Some((_, index)) = best {
            return index;
        }

        let index = self.count;
        self.count += 1;
        self.cells.entry(number_of(own.normal.to_array().map(cell_of))).or_default().insert((sortable(own.offset), index), own);
        index
    }
}

/// Cells along an axis: coordinates of normals, and of what lies within the angle of them, are within +-1.01.
const CELLS: u32 = 128;

/// The cell along an axis in which a coordinate lies.
fn cell_of(coordinate: f64) -> u32 {
    (coordinate / CELL + 0.5 * f64::from(CELLS)) as u32
}

/// The number of a cell.
fn number_of([x, y, z]: [u32; 3]) -> u32 {
    (x * CELLS + y) * CELLS + z
}

/// The cells that may hold normals within [`ANGLE_TOLERANCE`] of `normal`: one, up to eight near the borders.
fn cells_around(normal: DVec3) -> impl Iterator<Item = u32> {
    let [x, y, z] = normal.to_array().map(|c| cell_of(c - ANGLE_TOLERANCE)..=cell_of(c + ANGLE_TOLERANCE));
    x.flat_map(move |x| {
        let z = z.clone();
        y.clone().flat_map(move |y| z.clone().map(move |z| number_of([x, y, z])))
    })
}

/// Bits that sort as the number does, -0 as 0.
fn sortable(number: f64) -> u64 {
    let bits = (number + 0.0).to_bits();
    if bits >> 63 == 0 { bits | 1 << 63 } else { !bits }
}

#[cfg(test)]
mod tests {
    use super::super::{Material, Sides};
    use super::*;
    use crate::geometry::Polygon;

    fn scene(polygons: Vec<Polygon>, sides: Sides) -> Scene {
        let grey = Material { name: "grey".to_owned(), reflectance: vec![0.5], exitance: vec![0.0] };
        let faces = polygons.into_iter().enumerate().map(|(face, polygon)| (polygon, 0, face as u32)).collect();
        Scene::new(1, vec![grey], faces, sides).unwrap()
    }

    fn planes(polygons: Vec<Polygon>) -> Vec<u32> {
        scene(polygons, Sides::Front).surfaces().iter().map(|surface| surface.plane).collect()
    }

    /// A quad of size `size` in the plane through `origin` spanned by the turned x and y axes.
    fn quad(origin: DVec3, turn: glam::DQuat, size: f64) -> Polygon {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
        Polygon::from_vertices(corners.iter().map(|&corner| origin + turn * (corner * size)).collect()).unwrap()
    }

    /// Fixed numbers from 0 to 1.
    fn chance(index: u32, dimension: u32) -> f64 {
        f64::from(sobol_burley::sample(index, dimension, 1))
    }

    #[test]
    fn a_box_has_six_planes_wherever_it_is() {
        for offset in [0.0, 1e3, 1e6] {
            // Each side of a turned cube as four quads, every other one seen from behind.
            let centre = DVec3::new(offset, -0.7 * offset, 0.3 * offset);
            let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 0.2, 0.1);
            let mut polygons = Vec::new();
            for axis in [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z] {
                let side = turn * glam::DQuat::from_rotation_arc(DVec3::Z, axis);
                for (k, corner) in [(-1.0, -1.0), (0.0, -1.0), (-1.0, 0.0), (0.0, 0.0)].into_iter().enumerate() {
                    let piece = quad(centre + side * DVec3::new(corner.0, corner.1, 1.0), side, 1.0);
                    polygons.push(if k % 2 == 0 { piece } else { piece.reversed() });
                }
            }
            let expected: Vec<u32> = (0..24).map(|k| k / 4).collect();
            assert_eq!(planes(polygons), expected, "offset {offset}");
        }
    }

    #[test]
    fn parallel_planes_part_at_the_tolerance() {
        // The diagonal is close to 14.14; planes 0.1 tolerances apart are one, 2 tolerances apart are two.
        let floor = || quad(DVec3::ZERO, glam::DQuat::IDENTITY, 10.0);
        let raised = |height: f64| quad(DVec3::new(1.0, 1.0, height), glam::DQuat::IDENTITY, 1.0);
        assert_eq!(planes(vec![floor(), raised(1.4e-6)]), [0, 0]);
        assert_eq!(planes(vec![floor(), raised(2.8e-5)]), [0, 1]);
        assert_eq!(planes(vec![floor(), raised(-2.8e-5), raised(2.8e-5), raised(0.0)]), [0, 1, 2, 0]);
    }

    #[test]
    fn a_small_facet_within_the_distance_but_turned_is_in_another_plane() {
        let floor = quad(DVec3::ZERO, glam::DQuat::IDENTITY, 10.0);
        let tilted = quad(DVec3::new(5.0, 5.0, 0.0), glam::DQuat::from_rotation_x(0.3), 1e-5);
        assert_eq!(planes(vec![floor, tilted]), [0, 1]);
    }

    #[test]
    fn rounding_to_seven_digits_keeps_walls_together() {
        // Turned walls in a room of 10 m, cut into small quads with coordinates rounded to a micrometre.
        let turn = glam::DQuat::from_rotation_y(0.4);
        let rounded = |v: DVec3| (v * 1e6).round() / 1e6;
        let mut polygons = Vec::new();
        for wall in 0..3 {
            for k in 0..400 {
                let origin = DVec3::new(0.5 * f64::from(k % 20), 0.5 * f64::from(k / 20), 3.0 * f64::from(wall));
                let corners = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
                let corners: Vec<DVec3> = corners.iter().map(|c| rounded(turn * (origin + 0.5 * *c))).collect();
                polygons.push(Polygon::from_vertices(corners).unwrap());
            }
        }
        let expected: Vec<u32> = (0..1200).map(|k| k / 400).collect();
        assert_eq!(planes(polygons), expected);
    }

    /// The definition, checked on pairs: same number only within the tolerance, and coplanar pairs get the same.
    #[test]
    fn numbers_agree_with_all_pairs() {
        let mut polygons = Vec::new();
        for k in 0..300 {
            // A few orientations and heights, so that many are coplanar.
            let angle = (chance(k, 0) * 4.0).floor() * 0.7;
            let turn = glam::DQuat::from_rotation_x(angle) * glam::DQuat::from_rotation_y(angle * 1.3);
            let height = (chance(k, 1) * 5.0).floor();
            let within = turn * DVec3::new(10.0 * chance(k, 2), 10.0 * chance(k, 3), height);
            let polygon = quad(within + DVec3::splat(500.0), turn, 0.3 + chance(k, 0));
            polygons.push(if k % 3 == 0 { polygon.reversed() } else { polygon });
        }
        let scene = scene(polygons, Sides::Front);
        let tolerance = DISTANCE_TOLERANCE * scene.bounds().diagonal();
        let mut coplanar_pairs = 0;
        for a in scene.surfaces() {
            for b in scene.surfaces() {
                let facet = a.polygon.facet();
                let farthest = b.polygon.facet().vertices.iter().map(|v| facet.height(*v).abs()).fold(0.0, f64::max);
                assert!(a.plane != b.plane || farthest <= 3.0 * tolerance);
                assert!(a.plane == b.plane || farthest > 1e-9);
                coplanar_pairs += u32::from(a.plane == b.plane);
            }
        }
        assert!(coplanar_pairs > 3000, "{coplanar_pairs}");
    }

    #[test]
    fn a_far_ground_does_not_join_what_is_apart_in_a_room() {
        // Leaves of a book, a tenth of a millimetre apart, and a shelf; below them a ground of 20 km, in one piece and in many.
        let leaf = |k: u32| quad(DVec3::new(0.3, 0.2, 1.0 + 1e-4 * f64::from(k)), glam::DQuat::IDENTITY, 0.2);
        let leaves = || (0..20).map(leaf).chain([quad(DVec3::ZERO, glam::DQuat::IDENTITY, 1.0)]).collect::<Vec<_>>();
        let expected: Vec<u32> = (0..21).collect();
        for pieces in [0, 1, 4] {
            let side = 2e4 / f64::from(pieces.max(1));
            let corner = |k: u32| DVec3::new(side * f64::from(k % pieces) - 1e4, side * f64::from(k / pieces) - 1e4, -1.0);
            let ground = (0..pieces * pieces).map(|k| quad(corner(k), glam::DQuat::IDENTITY, side));
            let planes = planes(leaves().into_iter().chain(ground).collect());
            assert_eq!(planes[..21], expected, "{pieces}");
            assert!(planes[21..].iter().all(|&plane| plane == 21), "{pieces}");
        }
    }

    #[test]
    fn twins_share_a_plane_and_surfaces_alone_get_their_backs() {
        let (lone, sheet) = (quad(DVec3::ZERO, glam::DQuat::IDENTITY, 1.0), quad(DVec3::Z, glam::DQuat::from_rotation_x(1.0), 1.0));
        // The back of the sheet starts at another corner.
        let mut corners: Vec<[f64; 3]> = sheet.reversed().vertices().collect();
        corners.rotate_left(1);
        let back = Polygon::new(&corners).unwrap();
        let all = vec![sheet.clone(), lone, back];

        let front = scene(all.clone(), Sides::Front);
        let twins = |scene: &Scene| scene.surfaces().iter().map(|s| s.twin.map(|twin| twin.0)).collect::<Vec<_>>();
        assert_eq!(twins(&front), [Some(2), None, Some(0)]);
        assert_eq!(front.surfaces().iter().map(|s| s.plane).collect::<Vec<_>>(), [0, 1, 0]);

        let both = scene(all, Sides::Both);
        assert_eq!(twins(&both), [Some(3), Some(2), Some(1), Some(0)]);
        assert_eq!(both.surfaces().iter().map(|s| (s.plane, s.face)).collect::<Vec<_>>(), [(0, 0), (1, 1), (1, 1), (0, 2)]);
        assert_eq!(both.surfaces()[2].polygon.normal(), [0.0, 0.0, -1.0]);

        // What has both sides already is left as it is.
        let again = scene(both.surfaces().iter().map(|s| s.polygon.clone()).collect(), Sides::Both);
        assert_eq!((twins(&again), again.surfaces().len()), (twins(&both), 4));
    }

    #[test]
    fn planes_out_of_order_are_found_out() {
        let quads = [0.0, 1.0, 2.0].map(|height| quad(height * DVec3::Z, glam::DQuat::IDENTITY, 1.0));
        let mut scene = scene(quads.to_vec(), Sides::Front);
        assert_eq!(scene.validate(), Ok(()));
        for plane in [3, u32::MAX] {
            scene.surfaces.but_polygons_mut()[2].plane = plane;
            assert!(scene.validate().unwrap_err().contains("surface 2: its plane"));
        }
    }
}
