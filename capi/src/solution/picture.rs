//! Pictures.

use std::ffi::c_char;
use std::path::Path;

use patchlight::mesh::LitMesh;
use patchlight::output::{Destination, ImageFormat, PngExposure, Provenance, Quantity, write_exr, write_hdr, write_png};
use patchlight::picture::{Camera, Image};

use super::{Solution, cancelled, patchlight_solution};
use crate::entry::enter;
use crate::handles;
use crate::memory::{Buffer, SizedStruct, read_sized, text, write_sized};
use crate::observer::Watcher;
use crate::solve::check_answers;
use crate::status::{Ending, Outcome, PATCHLIGHT_NOT_AVAILABLE, patchlight_status};

/// A pinhole camera.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct patchlight_camera {
    /// `sizeof(patchlight_camera)`
    pub size: usize,
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// The eye, in metres.
    pub eye: [f64; 3],
    /// What is at the centre of the picture.
    pub target: [f64; 3],
    /// What points up in the picture; not parallel to the view.
    pub up: [f64; 3],
    /// Vertical field of view in degrees, above 0 and below 180.
    pub field_of_view: f64,
}

// SAFETY: repr(C), its size first, and numbers may be zero.
unsafe impl SizedStruct for patchlight_camera {
    const NAME: &'static str = "patchlight_camera";
}

/// # Safety
/// As the text at the head of the header demands.
unsafe fn camera(camera: *const patchlight_camera) -> Outcome<Camera> {
    // SAFETY: The caller's promise.
    let patchlight_camera { width, height, eye, target, up, field_of_view, .. } = unsafe { read_sized(camera)? };
    let camera = Camera { eye, target, up, field_of_view_degrees: field_of_view, width, height };
    camera.validate()?;
    Ok(camera)
}

/// Sets a camera that shows the scene. The width and height that it has are kept.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_solution_get_camera(
    solution: *mut patchlight_solution,
    camera: *mut patchlight_camera,
) -> patchlight_status {
    enter(|| {
        let solution = handles::get(solution)?;
        // SAFETY: The contract of the header.
        let patchlight_camera { width, height, .. } = unsafe { read_sized(camera)? };
        let (target, up) = ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0]);
        Camera { eye: [0.0; 3], target, up, field_of_view_degrees: 45.0, width, height }.validate()?;
        let Camera { eye, target, up, field_of_view_degrees, .. } = solution.evaluator.default_camera(width, height);
        check_answers(&solution.failed)?;
        let chosen = patchlight_camera { size: 0, width, height, eye, target, up, field_of_view: field_of_view_degrees };
        // SAFETY: The contract of the header.
        unsafe { write_sized(camera, &chosen) }
    })
}

/// What a picture shows: the values of a solution, or a mesh of it.
pub struct View<'a> {
    pub solution: &'a Solution,
    pub mesh: Option<&'a LitMesh>,
}

impl View<'_> {
    fn take(&self, camera: &Camera) -> Outcome<Image> {
        let Self { solution, mesh } = self;
        let watcher = Watcher::new(solution.listener(), &solution.failed);
        let image = match mesh {
            Some(mesh) => solution.evaluator.render_mesh(mesh, camera, &watcher)?,
            None => solution.evaluator.render(camera, &watcher)?,
        };
        check_answers(&solution.failed)?;
        image.ok_or_else(cancelled)
    }

    /// Takes a picture into buffers of the caller's.
    ///
    /// # Safety
    /// As the text at the head of the header demands.
    pub unsafe fn get(
        &self,
        camera: *const patchlight_camera,
        radiance: Buffer<f32>,
        standard_error: Option<Buffer<f32>>,
    ) -> Outcome {
        // SAFETY: The caller's promise.
        let camera = unsafe { self::camera(camera)? };
        let pixels = camera.width as usize * camera.height as usize;
        if !radiance.begin(pixels * self.solution.evaluator.solution().scene().channels())? {
            return Ok(());
        }
        let image = self.take(&camera)?;
        if let Some(errors) = standard_error {
            let missing = || Ending::new(PATCHLIGHT_NOT_AVAILABLE, "the standard errors of this solution are not known");
            errors.copy(image.standard_error.as_deref().ok_or_else(missing)?)?;
        }
        radiance.copy(&image.radiance)
    }

    /// Takes a picture and writes it.
    ///
    /// # Safety
    /// As the text at the head of the header demands.
    pub unsafe fn write(&self, camera: *const patchlight_camera, path: *const c_char) -> Outcome {
        // SAFETY: The caller's promise.
        let (camera, path) = unsafe { (self::camera(camera)?, Path::new(text(path, "path")?)) };
        let format = ImageFormat::of_path(path)?;
        let destination = Destination::new(path)?;
        let image = self.take(&camera)?;
        let provenance = Provenance::new(self.solution.evaluator.solution().options());
        destination.write(|file| match format {
            ImageFormat::Png => write_png(file, &image, PngExposure::Auto, &provenance).map(drop),
            ImageFormat::Exr => write_exr(file, &image, Quantity::Radiance, &provenance),
            ImageFormat::Hdr => write_hdr(file, &image, Quantity::Radiance, &provenance),
        })?;
        Ok(())
    }
}

/// Takes a picture: radiances in W/m^2/sr, row after row from the top left, with a number for each channel of a pixel. `standard_error` is
/// NULL, or has as much room.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_solution_get_picture(
    solution: *mut patchlight_solution,
    camera: *const patchlight_camera,
    radiance: *mut f32,
    standard_error: *mut f32,
    capacity: usize,
    count: *mut usize,
) -> patchlight_status {
    enter(|| {
        let solution = handles::get(solution)?;
        let has_errors = !standard_error.is_null();
        // SAFETY: The contract of the header; where `standard_error` is NULL, nothing is written to it.
        unsafe {
            let radiance = Buffer::new(radiance, capacity, count)?;
            let errors = has_errors.then(|| Buffer::new(standard_error, capacity, std::ptr::null_mut())).transpose()?;
            View { solution: &solution, mesh: None }.get(camera, radiance, errors)
        }
    })
}

/// Takes a picture and writes it: `.png` to look at, exposed automatically, or `.exr` with linear radiances.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_solution_write_picture(
    solution: *mut patchlight_solution,
    camera: *const patchlight_camera,
    path: *const c_char,
) -> patchlight_status {
    enter(|| {
        let solution = handles::get(solution)?;
        // SAFETY: The contract of the header.
        unsafe { View { solution: &solution, mesh: None }.write(camera, path) }
    })
}
