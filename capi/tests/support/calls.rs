//! The interface as a test in Rust sees it: a small scene, and short names for what C programs write.
#![allow(dead_code, reason = "each test uses a part of it")]

use std::ffi::{CStr, CString, c_void};
use std::ptr::{null, null_mut};

use patchlight_capi::patchlight_status::{self, PATCHLIGHT_INVALID_ARGUMENT, PATCHLIGHT_OK};
use patchlight_capi::*;

pub const FLOAT: u32 = patchlight_format::PATCHLIGHT_FLOAT as u32;
pub const DOUBLE: u32 = patchlight_format::PATCHLIGHT_DOUBLE as u32;
pub const UINT32: u32 = patchlight_format::PATCHLIGHT_UINT32 as u32;

/// What the last call had to tell.
pub fn message() -> String {
    let mut message = null();
    // SAFETY: A place for a pointer; the text lives until the next call.
    unsafe {
        assert_eq!(patchlight_get_message(&mut message), PATCHLIGHT_OK);
        CStr::from_ptr(message).to_str().unwrap().to_owned()
    }
}

/// The status of a call, which tells something if and only if it is not `PATCHLIGHT_OK`.
#[track_caller]
pub fn told(status: patchlight_status) -> patchlight_status {
    assert_eq!(message().is_empty(), status == PATCHLIGHT_OK, "{status:?}: {}", message());
    status
}

/// A call that must not fail.
#[track_caller]
pub fn done(status: patchlight_status) -> patchlight_status {
    assert!((status as i32) < PATCHLIGHT_INVALID_ARGUMENT as i32, "{status:?}: {}", message());
    told(status)
}

pub fn array<T>(format: u32, data: &[T], components: usize) -> patchlight_array {
    let count = data.len() / components;
    patchlight_array { size: size_of::<patchlight_array>(), format, data: data.as_ptr().cast(), count, stride: 0 }
}

pub fn context(threads: u32) -> *mut patchlight_context {
    let mut context = null_mut();
    // SAFETY: A place for a handle.
    done(unsafe { patchlight_context_create(threads, &mut context) });
    context
}

pub fn options(settings: &[(&str, &str)]) -> *mut patchlight_options {
    let mut options = null_mut();
    // SAFETY: A place for a handle, and texts that end in a zero.
    unsafe {
        done(patchlight_options_create(&mut options));
        for (key, value) in settings {
            let (key, value) = (CString::new(*key).unwrap(), CString::new(*value).unwrap());
            done(patchlight_options_set_text(options, key.as_ptr(), value.as_ptr()));
        }
    }
    options
}

pub const VERTICES: [f64; 24] =
    [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 1.0, 1.0];
pub const CORNERS: [u32; 24] = [0, 4, 5, 1, 3, 2, 6, 7, 4, 7, 6, 5, 0, 1, 2, 3, 0, 3, 7, 4, 1, 5, 6, 2];

/// A box of one channel that faces inwards, not committed. `bright` is what the ceiling emits.
pub fn open_box(context: *mut patchlight_context, bright: f64) -> *mut patchlight_scene {
    let mut scene = null_mut();
    let (positions, corners) = (array(DOUBLE, &VERTICES, 3), array(UINT32, &CORNERS, 1));
    let (counts, materials) = ([4_u32; 6], [0_u32, 1, 0, 0, 0, 0]);
    let (counts, materials) = (array(UINT32, &counts, 1), array(UINT32, &materials, 1));
    let (reflectance, exitance) = ([0.6, 0.3], [0.0, bright]);
    let (reflectance, exitance) = (array(DOUBLE, &reflectance, 1), array(DOUBLE, &exitance, 1));
    // SAFETY: Arrays that live until the end of this function, and a place for a handle.
    unsafe {
        done(patchlight_scene_create(context, 1, 0, &mut scene));
        done(patchlight_scene_add_materials(scene, &reflectance, &exitance));
        done(patchlight_scene_add_vertices(scene, &positions));
        done(patchlight_scene_add_faces(scene, &corners, &counts, &materials));
    }
    scene
}

pub fn closed_box(context: *mut patchlight_context) -> *mut patchlight_scene {
    let scene = open_box(context, 5.0);
    done(patchlight_scene_commit(scene));
    scene
}

pub fn info(options: *mut patchlight_options) -> patchlight_solve_info {
    let size = size_of::<patchlight_solve_info>();
    patchlight_solve_info {
        size,
        options,
        progress: None,
        progress_user: null_mut::<c_void>(),
        visibility: null(),
        memory: None,
        memory_user: null_mut(),
    }
}

/// A box that is lit, coarsely.
pub fn lit_box(context: *mut patchlight_context, settings: &[(&str, &str)]) -> *mut patchlight_solution {
    let (scene, options, mut solution) = (closed_box(context), options(&[("error", "0.5"), ("backend", "obvhs")]), null_mut());
    for (key, value) in settings {
        let (key, value) = (CString::new(*key).unwrap(), CString::new(*value).unwrap());
        // SAFETY: Texts that end in a zero.
        done(unsafe { patchlight_options_set_text(options, key.as_ptr(), value.as_ptr()) });
    }
    // SAFETY: A struct with its size, and a place for a handle.
    done(unsafe { patchlight_solve(context, scene, &info(options), &mut solution) });
    done(patchlight_options_release(options));
    done(patchlight_scene_release(scene));
    solution
}

/// A mesh of a solution.
pub fn mesh_of(solution: *mut patchlight_solution, error: f64) -> *mut patchlight_mesh {
    let mut mesh = null_mut();
    // SAFETY: A place for a handle.
    done(unsafe { patchlight_solution_make_mesh(solution, error, &mut mesh) });
    mesh
}

/// Text of a function that takes buffer, capacity and count.
pub fn text(mut call: impl FnMut(*mut std::ffi::c_char, usize, *mut usize) -> patchlight_status) -> String {
    let mut count = 0;
    done(call(null_mut(), 0, &mut count));
    let mut buffer = vec![0_u8; count];
    done(call(buffer.as_mut_ptr().cast(), count, null_mut()));
    CStr::from_bytes_with_nul(&buffer).unwrap().to_str().unwrap().to_owned()
}

/// Numbers by surfaces, elements, nodes or links.
pub fn reals(solution: *mut patchlight_solution, items: patchlight_items, what: patchlight_real) -> Vec<f64> {
    let mut count = 0;
    // SAFETY: Places for a count and for as many numbers.
    unsafe {
        done(patchlight_solution_get_double(solution, items as u32, what as u32, null_mut(), 0, &mut count));
        let mut numbers = vec![0.0; count];
        done(patchlight_solution_get_double(solution, items as u32, what as u32, numbers.as_mut_ptr(), count, null_mut()));
        numbers
    }
}

pub fn wholes(solution: *mut patchlight_solution, items: patchlight_items, what: patchlight_whole) -> Vec<u32> {
    let mut count = 0;
    // SAFETY: Places for a count and for as many numbers.
    unsafe {
        done(patchlight_solution_get_uint32(solution, items as u32, what as u32, null_mut(), 0, &mut count));
        let mut numbers = vec![0; count];
        done(patchlight_solution_get_uint32(solution, items as u32, what as u32, numbers.as_mut_ptr(), count, null_mut()));
        numbers
    }
}
