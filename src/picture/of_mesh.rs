//! A picture of a lit mesh: first hits from the backend, and the function at each of them.

use super::antialiased::{Antialiased, Met};
use super::camera::CameraRays;
use super::image::Image;
use super::shown::Shown;
use crate::mesh::{MeshCursor, MeshReader, SeenSurfaces};
use crate::progress::Observer;
use crate::scene::Scene;
use crate::transmittance::Rays;

/// What is shown through the pixels of a camera, black where a back is met, and where nothing is, but for the sky. `None` if the
/// observer cancels.
pub(crate) fn render_mesh(
    scene: &Scene,
    mesh: &MeshReader<'_>,
    visibility: &Rays<'_>,
    (camera, size): (&CameraRays, [u32; 2]),
    shown: Shown,
    observer: &dyn Observer,
) -> Option<Image> {
    let ([width, height], channels) = (size, scene.channels());
    let begin = || (MeshCursor::new(mesh), vec![0.0; channels]);
    let shade = |met: Met, (cursor, radiosity): &mut (MeshCursor<'_>, Vec<f64>), shade: &mut [f32]| {
        let (surface, point) = match met {
            Met::Surface(surface, point) => (surface, point),
            Met::Sky(direction) => return shown.add_sky(scene, direction, 1.0, shade),
        };
        cursor.radiosity_at(point, surface, radiosity);
        let material = scene.material_of(surface);
        for (channel, (value, &radiosity)) in shade.iter_mut().zip(&*radiosity).enumerate() {
            *value = shown.of(material, channel, radiosity) as f32;
        }
    };
    let radiance = Antialiased { scene, visibility, camera, size }.shaded(channels, observer, begin, shade)?;
    Some(Image { width, height, channels, radiance, standard_error: None })
}

/// What the pixels of a camera see of surfaces. `None` if the observer cancels.
pub(crate) fn seen_surfaces(
    scene: &Scene,
    visibility: &Rays<'_>,
    (camera, size): (&CameraRays, [u32; 2]),
    observer: &dyn Observer,
) -> Option<SeenSurfaces> {
    Antialiased { scene, visibility, camera, size }.seen(observer)
}
