//! The exact solution: direct light at the vertices of a grid on the floor, from the parts of the lights that these see.

use patchlight::direct::{DirectEffort, Method, direct_irradiance};
use patchlight::scene::{Scene, SurfaceId};
use patchlight::visibility::{Backend, OccluderMesh, build};

/// Vertices of the grid on each side, as in the thesis.
pub const SIDE: usize = 400;

/// The floor of the scene, which alone reflects, and its radiosity.
pub struct Exact {
    pub floor: SurfaceId,
    /// From the first corner: x and z in metres.
    pub low: [f64; 2],
    pub high: [f64; 2],
    /// By z, then x; the largest is 1.
    pub radiosity: Vec<f64>,
    /// What was 1, in W/m^2.
    pub brightest: f64,
    /// Whether the pyramid stands on the vertex.
    pub is_covered: Vec<bool>,
}

impl Exact {
    pub fn of(scene: &Scene) -> Self {
        let ids = || (0..scene.surfaces().len() as u32).map(SurfaceId);
        let reflectance = |id: SurfaceId| scene.material_of(id).reflectance[0];
        let floor = ids().find(|&id| reflectance(id) > 0.0).expect("the floor reflects");
        let corners: Vec<[f64; 3]> = scene.surface(floor).polygon.vertices().collect();
        let end = |axis: usize, pick: fn(f64, f64) -> f64| corners.iter().map(|corner| corner[axis]).reduce(pick).unwrap_or(0.0);
        let (low, high) = ([end(0, f64::min), end(2, f64::min)], [end(0, f64::max), end(2, f64::max)]);

        let places: Vec<[f64; 2]> = (0..SIDE * SIDE).map(|k| place([k % SIDE, k / SIDE], low, high)).collect();
        let points: Vec<(SurfaceId, [f64; 3])> = places.iter().map(|&[x, z]| (floor, [x, 0.0, z])).collect();
        let visibility = build(Backend::Auto, &OccluderMesh::of_scene(scene)).expect("a backend");
        let found = direct_irradiance(scene, &*visibility, &points, DirectEffort { rays: 1, method: Method::Exact }, 0);
        let irradiance: Vec<f64> = found.irradiance.iter().step_by(scene.channels()).copied().collect();
        let most = irradiance.iter().copied().fold(0.0, f64::max);

        // What stands on the floor: the sides of the pyramid meet it, and turn around what it covers.
        let sides: Vec<[[f64; 2]; 2]> = ids().filter_map(|id| side_on_floor(scene, id, floor)).collect();
        assert_eq!(sides.len(), 4, "the pyramid has four sides");
        let is_inside = |&[x, z]: &[f64; 2]| {
            let turn = |[[ax, az], [bx, bz]]: &[[f64; 2]; 2]| (bx - ax) * (z - az) - (bz - az) * (x - ax);
            sides.iter().all(|side| turn(side) > 0.0) || sides.iter().all(|side| turn(side) < 0.0)
        };
        Self {
            floor,
            low,
            high,
            radiosity: irradiance.iter().map(|h| h / most).collect(),
            brightest: most * reflectance(floor),
            is_covered: places.iter().map(is_inside).collect(),
        }
    }

    /// The grid coordinate of a place along an axis, 0 for x and 1 for z: a whole number at vertices.
    pub fn coordinate(&self, axis: usize, place: f64) -> f64 {
        (place - self.low[axis]) / (self.high[axis] - self.low[axis]) * (SIDE - 1) as f64
    }

    /// Where a vertex is.
    pub fn place(&self, vertex: [usize; 2]) -> [f64; 2] {
        place(vertex, self.low, self.high)
    }
}

fn place(vertex: [usize; 2], low: [f64; 2], high: [f64; 2]) -> [f64; 2] {
    std::array::from_fn(|axis| low[axis] + (high[axis] - low[axis]) * vertex[axis] as f64 / (SIDE - 1) as f64)
}

/// The side of a face that lies on the floor.
fn side_on_floor(scene: &Scene, id: SurfaceId, floor: SurfaceId) -> Option<[[f64; 2]; 2]> {
    let on_floor: Vec<[f64; 2]> =
        scene.surface(id).polygon.vertices().filter(|vertex| vertex[1] == 0.0).map(|vertex| [vertex[0], vertex[2]]).collect();
    let &[a, b] = &on_floor[..] else { return None };
    (id != floor).then_some([a, b])
}
