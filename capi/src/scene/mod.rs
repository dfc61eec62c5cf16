//! Scenes: put together from arrays and files, then committed.

mod build;
pub mod diagnostics;
pub mod light_groups;
mod note;
mod object;
pub mod read;

use std::ffi::c_char;
use std::path::Path;
use std::sync::Arc;

use patchlight::scene::Sides;
use patchlight::scene::import::{ArrayFace, ImportOptions, read_lights, read_scene};

use crate::array::{patchlight_array, reals, vectors, wholes};
use crate::context::{PATCHLIGHT_LOG_WARNING, patchlight_context};
use crate::entry::enter;
use crate::handles;
use crate::memory::{Out, text};
use crate::status::{Ending, Outcome, PATCHLIGHT_INVALID_SCENE, PATCHLIGHT_WRONG_STATE, patchlight_status};
pub use build::Committed;
use object::SceneObject;
pub use object::patchlight_scene;

/// Which sides of a face emit and receive. Values may be added.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum patchlight_sides {
    /// The front, where the corners run counter-clockwise.
    PATCHLIGHT_SIDES_FRONT = 0,
    /// Both.
    PATCHLIGHT_SIDES_BOTH = 1,
}

use patchlight_sides::*;

/// How a file is read: flags to be added up. Values may be added.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum patchlight_file_flags {
    /// What it names, such as material libraries, beside it and below its folder alone.
    PATCHLIGHT_FILE_DEFAULT = 0,
    /// What it names wherever it says that lies.
    PATCHLIGHT_FILE_ALLOW_ANY_PATH = 1,
}

use patchlight_file_flags::*;

/// Makes a scene without anything in it. `channels` is 1 for grey, 3 for linear Rec. 709, or the number of bands, up to 1024; `sides` is a
/// patchlight_sides.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_scene_create(
    context: *mut patchlight_context,
    channels: u32,
    sides: u32,
    scene: *mut *mut patchlight_scene,
) -> patchlight_status {
    enter(|| {
        let context = handles::get(context)?;
        // SAFETY: The contract of the header.
        let out = unsafe { Out::new(scene, "scene")? };
        let sides = match sides {
            _ if sides == PATCHLIGHT_SIDES_FRONT as u32 => Sides::Front,
            _ if sides == PATCHLIGHT_SIDES_BOTH as u32 => Sides::Both,
            _ => return Err(Ending::argument(format_args!("sides is {sides}, which is no patchlight_sides"))),
        };
        if !(1..=1024).contains(&channels) {
            return Err(Ending::argument(format_args!("channels is {channels}, it must be from 1 to 1024")));
        }
        out.set(handles::create(Arc::new(SceneObject::new(context, channels as usize, sides))))
    })
}

/// One more patchlight_scene_release is needed.
#[unsafe(no_mangle)]
pub extern "C" fn patchlight_scene_retain(scene: *mut patchlight_scene) -> patchlight_status {
    enter(|| handles::retain(scene))
}

/// Lets a scene go. Its solutions keep what they need. NULL is let go by.
#[unsafe(no_mangle)]
pub extern "C" fn patchlight_scene_release(scene: *mut patchlight_scene) -> patchlight_status {
    enter(|| handles::release(scene))
}

/// Adds materials, numbered in the order in which they are added, from 0. The items of `reflectance` are reflectances by channel, from 0 to
/// below 1, those of `exitance` are the power that is emitted, by channel, in W/m^2.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_scene_add_materials(
    scene: *mut patchlight_scene,
    reflectance: *const patchlight_array,
    exitance: *const patchlight_array,
) -> patchlight_status {
    enter(|| {
        let scene = handles::get(scene)?;
        let channels = scene.state().draft.channels();
        // SAFETY: The contract of the header.
        let (reflectance, exitance) =
            unsafe { (reals(reflectance, channels, "reflectance")?, reals(exitance, channels, "exitance")?) };
        if reflectance.len() != exitance.len() {
            return Err(Ending::argument("there are not as many exitances as reflectances"));
        }
        let rows = reflectance.chunks_exact(channels).zip(exitance.chunks_exact(channels));
        scene.change(|draft| {
            rows.for_each(|(reflectance, exitance)| draft.add_material(reflectance, exitance));
            Ok(())
        })
    })
}

/// Adds vertices, numbered in the order in which they are added, from 0. An item has three coordinates in metres.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_scene_add_vertices(
    scene: *mut patchlight_scene,
    positions: *const patchlight_array,
) -> patchlight_status {
    enter(|| {
        let scene = handles::get(scene)?;
        // SAFETY: The contract of the header.
        let positions = unsafe { vectors(positions, "positions")? };
        scene.change(|draft| {
            draft.vertices.extend(positions);
            Ok(())
        })
    })
}

/// Adds faces, numbered in the order in which they are added, from 0.
///
/// `corners` are numbers of vertices, face after face, counter-clockwise seen from the front; they may be added later. `counts` says how
/// many corners each face has; NULL stands for triangles. `materials` says which material each has; NULL stands for material 0. All three
/// have one whole number an item.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_scene_add_faces(
    scene: *mut patchlight_scene,
    corners: *const patchlight_array,
    counts: *const patchlight_array,
    materials: *const patchlight_array,
) -> patchlight_status {
    enter(|| {
        let scene = handles::get(scene)?;
        // SAFETY: The contract of the header.
        let corners = unsafe { wholes(corners, "corners")? };
        let counts = if counts.is_null() {
            vec![3; corners.len() / 3]
        } else {
            // SAFETY: The contract of the header.
            unsafe { wholes(counts, "counts")? }
        };
        let materials = if materials.is_null() {
            vec![0; counts.len()]
        } else {
            // SAFETY: The contract of the header.
            unsafe { wholes(materials, "materials")? }
        };
        if counts.len() != materials.len() {
            let message = format!("there are {} counts, but {} materials", counts.len(), materials.len());
            return Err(Ending::argument(message));
        }
        let needed = counts.iter().try_fold(0_u64, |sum, &count| sum.checked_add(count));
        if needed != Some(corners.len() as u64) {
            let message = format!("there are {} corners, the counts add up to another number", corners.len());
            return Err(Ending::argument(message));
        }
        let number = |number: u64| u32::try_from(number).unwrap_or(u32::MAX);
        let faces = counts.iter().zip(&materials).map(|(&count, &m)| ArrayFace { corners: count as usize, material: number(m) });
        scene.change(|draft| {
            draft.corners.extend(corners);
            draft.faces.extend(faces);
            Ok(())
        })
    })
}

/// Adds what is in a file (`.obj`, `.gltf`, `.glb`, `.ply`, `.stl`), for scenes of three channels. `flags` are of patchlight_file_flags. Its faces
/// and materials are numbered behind those of arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_scene_add_file(
    scene: *mut patchlight_scene,
    path: *const c_char,
    flags: u32,
) -> patchlight_status {
    enter(|| {
        let scene = handles::get(scene)?;
        // SAFETY: The contract of the header.
        let path = unsafe { text(path, "path")? };
        let allow_any_path = allows_any_path(flags)?;
        if scene.state().draft.channels() != 3 {
            return Err(Ending::new(PATCHLIGHT_WRONG_STATE, "files have three channels, this scene has another number"));
        }
        // The sides are made when all faces are known.
        let options = ImportOptions { allow_any_path, ..ImportOptions::default() };
        let imported = scene.context.workers.install(|| read_scene(Path::new(path), &options));
        let imported = imported.map_err(|error| Ending::new(PATCHLIGHT_INVALID_SCENE, error))?;
        scene.change(|draft| {
            draft.files.push(imported);
            Ok(())
        })
    })
}

/// Adds the lights of a TOML file, which are no surfaces: points, spots, measured luminaires, suns and skies. `flags` are of patchlight_file_flags.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_scene_add_lights(
    scene: *mut patchlight_scene,
    path: *const c_char,
    flags: u32,
) -> patchlight_status {
    enter(|| {
        let scene = handles::get(scene)?;
        // SAFETY: The contract of the header.
        let path = unsafe { text(path, "path")? };
        let (allow_any_path, channels) = (allows_any_path(flags)?, scene.state().draft.channels());
        let lights = read_lights(Path::new(path), channels, allow_any_path);
        let lights = lights.map_err(|error| Ending::new(PATCHLIGHT_INVALID_SCENE, error))?;
        scene.change(|draft| {
            draft.lights.push(lights);
            Ok(())
        })
    })
}

/// Validates a scene, and makes it ready to be solved. What was repaired or is suspicious, and if it fails all that is wrong, can be read as
/// diagnostics. A scene that failed may be added to, and committed again.
#[unsafe(no_mangle)]
pub extern "C" fn patchlight_scene_commit(scene: *mut patchlight_scene) -> patchlight_status {
    enter(|| {
        let scene = handles::get(scene)?;
        let warnings = scene.commit()?;
        // Not while the lock is held: who listens may call the library.
        warnings.iter().for_each(|warning| scene.context.log(PATCHLIGHT_LOG_WARNING, warning));
        Ok(())
    })
}

fn allows_any_path(flags: u32) -> Outcome<bool> {
    if flags & !(PATCHLIGHT_FILE_ALLOW_ANY_PATH as u32) != PATCHLIGHT_FILE_DEFAULT as u32 {
        return Err(Ending::argument(format_args!("flags is {flags}, which has bits that are no patchlight_file_flags")));
    }
    Ok(flags & PATCHLIGHT_FILE_ALLOW_ANY_PATH as u32 != 0)
}
