//! Direct light at points: against closed forms, against rays, and where geometry touches.

#[path = "../support/fixtures.rs"]
mod fixtures;
#[path = "../support/rooms.rs"]
mod rooms;
#[path = "../support/triangles.rs"]
mod triangles;

mod against_rays;
mod closed_forms;
mod touching;

use patchlight::direct::{DirectEffort, DirectIrradiance, Method, direct_irradiance};
use patchlight::scene::{Scene, SurfaceId};
use patchlight::visibility::{Backend, OccluderMesh, Visibility, build};

fn backend(scene: &Scene, backend: Backend) -> Box<dyn Visibility> {
    build(backend, &OccluderMesh::of_scene(scene)).unwrap()
}

/// Direct irradiance by one method, with rays of the default backend.
fn direct(scene: &Scene, points: &[(SurfaceId, [f64; 3])], method: Method, rays: u32) -> DirectIrradiance {
    direct_irradiance(scene, &*backend(scene, Backend::Auto), points, DirectEffort { rays, method }, 1)
}

/// Exact direct irradiance; no ray is cast.
fn exact(scene: &Scene, points: &[(SurfaceId, [f64; 3])]) -> Vec<f64> {
    let found = direct(scene, points, Method::Exact, 1);
    assert_eq!(found.rays, 0);
    assert!(found.variance.iter().all(|&variance| variance == 0.0));
    found.irradiance
}

fn emitters(scene: &Scene) -> Vec<SurfaceId> {
    (0..scene.surfaces().len() as u32).map(SurfaceId).filter(|&id| scene.material_of(id).emits()).collect()
}
