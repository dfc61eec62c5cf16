//! Lights that are no surfaces, from C.

#[path = "support/calls.rs"]
mod support;

use std::ffi::CString;
use std::ptr::{null, null_mut};

use patchlight_capi::*;
use support::*;

/// A lamp above a square: the middle receives its candelas over the square of the distance.
#[test]
fn lights_of_a_file_light_a_scene() {
    let (context, mut scene, mut solution) = (context(1), null_mut(), null_mut());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lights.toml");
    std::fs::write(&path, "[[point]]\nposition = [0.5, 0.5, 2]\nintensity = 12\n").unwrap();
    let path = CString::new(path.to_str().unwrap()).unwrap();
    let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]].concat();
    let (corners, count, rho, e) = ([0_u32, 1, 2, 3], [4_u32], [0.5], [0.0]);
    let (point, normal, mut value) = ([0.5, 0.5, 0.0], [0.0, 0.0, 1.0], 0.0_f32);
    // SAFETY: Arrays and places that live on, and a text that ends in a zero.
    unsafe {
        done(patchlight_scene_create(context, 1, 0, &mut scene));
        done(patchlight_scene_add_materials(scene, &array(DOUBLE, &rho, 1), &array(DOUBLE, &e, 1)));
        done(patchlight_scene_add_vertices(scene, &array(DOUBLE, &positions, 3)));
        done(patchlight_scene_add_faces(scene, &array(UINT32, &corners, 1), &array(UINT32, &count, 1), null()));
        done(patchlight_scene_add_lights(scene, path.as_ptr(), 0));
        done(patchlight_scene_commit(scene));
        done(patchlight_solve(context, scene, null(), &mut solution));
        let values = patchlight_values {
            size: size_of::<patchlight_values>(),
            capacity: 1,
            radiosity: &mut value,
            standard_error: null_mut(),
            lower: null_mut(),
            upper: null_mut(),
        };
        let at = [array(DOUBLE, &point, 3), array(DOUBLE, &normal, 3)];
        done(patchlight_solution_get_values(solution, &at[0], &at[1], &values, null_mut()));
    }
    assert!((f64::from(value) - 0.5 * 12.0 / 4.0).abs() < 1e-6, "{value}");
    done(patchlight_solution_release(solution));
    done(patchlight_scene_release(scene));
    done(patchlight_context_release(context));
}
