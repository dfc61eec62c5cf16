//! All work is done on the threads of the context: the pool that a Rust host shares with all its libraries is never begun.

#[path = "support/calls.rs"]
mod support;

use std::ffi::CString;
use std::ptr::{null, null_mut};

use patchlight_capi::*;
use support::*;

#[test]
fn the_pool_of_the_process_is_left_alone() {
    let context = context(2);
    for solver in ["links", "cells"] {
        let solution = lit_box(context, &[("solver", solver)]);
        let mut camera = patchlight_camera {
            size: size_of::<patchlight_camera>(),
            width: 8,
            height: 8,
            eye: [0.0; 3],
            target: [0.0; 3],
            up: [0.0; 3],
            field_of_view: 0.0,
        };
        let (point, normal, mut radiosity) = ([0.3, 0.0, 0.4], [0.0, 1.0, 0.0], [0.0_f32; 8 * 8]);
        let values = patchlight_values {
            size: size_of::<patchlight_values>(),
            capacity: 1,
            radiosity: radiosity.as_mut_ptr(),
            standard_error: null_mut(),
            lower: null_mut(),
            upper: null_mut(),
        };
        // SAFETY: Structs with their sizes, arrays that live on, and room for as many numbers as are told.
        unsafe {
            done(patchlight_solution_get_values(
                solution,
                &array(DOUBLE, &point, 3),
                &array(DOUBLE, &normal, 3),
                &values,
                null_mut(),
            ));
            done(patchlight_solution_get_camera(solution, &mut camera));
            done(patchlight_solution_get_picture(solution, &camera, radiosity.as_mut_ptr(), null_mut(), 64, null_mut()));
        }
        let folder = tempfile::tempdir().unwrap();
        let file = CString::new(folder.path().join("a.solution").to_str().unwrap()).unwrap();
        let mut again = null_mut();
        // SAFETY: A text that ends with 0, and a place for a handle.
        unsafe {
            done(patchlight_solution_save(solution, file.as_ptr()));
            done(patchlight_solution_load(context, file.as_ptr(), null(), &mut again));
        }
        done(patchlight_solution_release(again));
        done(patchlight_solution_release(solution));
    }
    done(patchlight_context_release(context));
    // It can be set up as long as nobody has used it.
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("the pool of the process was used");
}
