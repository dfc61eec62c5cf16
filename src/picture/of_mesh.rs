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
    let begin = || Row { cursor: MeshCursor::new(mesh), radiosity: vec![0.0; channels], errors: vec![0.0; channels] };
    let shade = |met: Met, row: &mut Row<'_>, shade: &mut [f32]| {
        let (shade, errors) = shade.split_at_mut(channels);
        let (surface, point) = match met {
            Met::Surface(surface, point) => (surface, point),
            Met::Sky(direction) => return shown.add_sky(scene, direction, 1.0, shade),
        };
        row.cursor.radiosity_and_error_at(point, surface, &mut row.radiosity, &mut row.errors);
        let material = scene.material_of(surface);
        for (channel, (value, &radiosity)) in shade.iter_mut().zip(&row.radiosity).enumerate() {
            *value = shown.of(material, channel, radiosity) as f32;
        }
        for (channel, (value, &error)) in errors.iter_mut().zip(&row.errors).enumerate() {
            *value = shown.of_difference(material, channel, error) as f32;
        }
    };
    let antialiased = Antialiased { scene, visibility, camera, size };
    if !mesh.knows_errors() {
        let radiance = antialiased.shaded([channels, channels], observer, begin, shade)?;
        return Some(Image { width, height, channels, radiance, standard_error: None });
    }
    let both = antialiased.shaded([2 * channels, channels], observer, begin, shade)?;
    let of = |first: usize| both.chunks(channels).skip(first).step_by(2).flatten().copied().collect::<Vec<f32>>();
    Some(Image { width, height, channels, radiance: of(0), standard_error: Some(of(1)) })
}

/// What is reused along some rows.
struct Row<'a> {
    cursor: MeshCursor<'a>,
    radiosity: Vec<f64>,
    errors: Vec<f64>,
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
