//! Light groups and other materials, from C: what the Rust library says, what physics says, and what is refused.

#[path = "support/calls.rs"]
mod support;

use std::ffi::CString;
use std::ptr::{null, null_mut};

use patchlight_capi::patchlight_figure::*;
use patchlight_capi::patchlight_items::*;
use patchlight_capi::patchlight_light_grouping::*;
use patchlight_capi::patchlight_real::*;
use patchlight_capi::patchlight_status::*;
use patchlight_capi::*;
use support::*;

fn solved(context: *mut patchlight_context, scene: *mut patchlight_scene, more: &[(&str, &str)]) -> *mut patchlight_solution {
    let mut solution = null_mut();
    let options = options(&[&[("error", "0.1"), ("backend", "obvhs")], more].concat());
    // SAFETY: A struct with its size, and a place for a handle.
    done(unsafe { patchlight_solve(context, scene, &info(options), &mut solution) });
    done(patchlight_options_release(options));
    done(patchlight_scene_release(scene));
    solution
}

fn of_surfaces(solution: *mut patchlight_solution) -> Vec<f64> {
    reals(solution, PATCHLIGHT_SURFACES, PATCHLIGHT_RADIOSITY)
}

fn figure(solution: *mut patchlight_solution, what: patchlight_figure) -> f64 {
    let mut figure = 0.0;
    // SAFETY: A place for a number.
    done(unsafe { patchlight_solution_get_figure(solution, what as u32, &mut figure) });
    figure
}

fn relit(solution: *mut patchlight_solution, weights: &[f64]) -> (patchlight_status, *mut patchlight_solution) {
    let mut relit = null_mut();
    // SAFETY: An array that lives on, and a place for a handle.
    let status = told(unsafe { patchlight_solution_relight(solution, &array(DOUBLE, weights, 1), &mut relit) });
    (status, relit)
}

/// A box whose ceiling emits, and its walls as well, in a group each.
fn grouped_box(context: *mut patchlight_context) -> *mut patchlight_scene {
    let scene = open_box(context, 5.0);
    let (reflectance, exitance, count) = ([0.6], [1.0], [3_u32]);
    let (positions, corners) = ([[0.3, 0.5, 0.3], [0.6, 0.5, 0.3], [0.3, 0.5, 0.6]].concat(), [8_u32, 9, 10]);
    let names = [("lamp", "material material 1"), ("tile", "material material 2")];
    // SAFETY: Arrays that live until the end of this function, and texts that end in a zero.
    unsafe {
        done(patchlight_scene_add_materials(scene, &array(DOUBLE, &reflectance, 1), &array(DOUBLE, &exitance, 1)));
        done(patchlight_scene_add_vertices(scene, &array(DOUBLE, &positions, 3)));
        done(patchlight_scene_add_faces(
            scene,
            &array(UINT32, &corners, 1),
            &array(UINT32, &count, 1),
            &array(UINT32, &[2_u32], 1),
        ));
        for (group, lights) in names.map(|(group, lights)| (CString::new(group).unwrap(), CString::new(lights).unwrap())) {
            done(patchlight_scene_add_to_light_group(scene, group.as_ptr(), lights.as_ptr()));
        }
    }
    done(patchlight_scene_commit(scene));
    scene
}

#[test]
fn groups_are_weighted() {
    let context = context(1);
    let solution = solved(context, grouped_box(context), &[]);
    let mut count = 0;
    // SAFETY: A place for a count.
    done(unsafe { patchlight_solution_light_group_count(solution, &mut count) });
    let name = |group| {
        text(|buffer, capacity, count| {
            // SAFETY: A buffer of the capacity that is told.
            unsafe { patchlight_solution_light_group_name(solution, group, buffer, capacity, count) }
        })
    };
    assert_eq!((count, name(0), name(1)), (2, "lamp".to_owned(), "tile".to_owned()));
    // SAFETY: A place for a count.
    let beyond = unsafe { patchlight_solution_light_group_name(solution, 2, null_mut(), 0, &mut count) };
    assert_eq!(told(beyond), PATCHLIGHT_INVALID_ARGUMENT);

    // Any weights are a sum of what each group brings.
    let [lamp, tile, both] = [[1.0, 0.0], [0.0, 1.0], [0.25, 3.0]].map(|weights| relit(solution, &weights).1);
    for ((lamp, tile), both) in of_surfaces(lamp).iter().zip(of_surfaces(tile)).zip(of_surfaces(both)) {
        let sum = 0.25 * lamp + 3.0 * tile;
        assert!((both - sum).abs() <= 1e-6 * sum, "{both} for {sum}");
    }
    let error = figure(lamp, PATCHLIGHT_ERROR_ESTIMATE);
    assert!(error > 0.0 && error == figure(lamp, PATCHLIGHT_ERROR_ENERGY));
    let mut none = 0.0;
    // SAFETY: A place for a number.
    let of_solve = unsafe { patchlight_solution_get_figure(lamp, PATCHLIGHT_RAYS as u32, &mut none) };
    assert_eq!(told(of_solve), PATCHLIGHT_NOT_AVAILABLE);

    // What is refused leaves nothing.
    for wrong in [&[1.0, -1.0][..], &[1.0, f64::NAN], &[1.0], &[1.0; 3]] {
        let (status, nothing) = relit(solution, wrong);
        assert!(status as i32 >= 100 && nothing.is_null(), "{wrong:?}");
    }
    for solution in [lamp, tile, both, solution] {
        done(patchlight_solution_release(solution));
    }
    done(patchlight_context_release(context));
}

#[test]
fn groupings_are_checked() {
    let context = context(1);
    let scene = open_box(context, 5.0);
    assert_eq!(told(patchlight_scene_group_lights(scene, 7)), PATCHLIGHT_INVALID_ARGUMENT);
    done(patchlight_scene_group_lights(scene, PATCHLIGHT_LIGHTS_BY_OBJECT as u32));
    assert_eq!(told(patchlight_scene_commit(scene)), PATCHLIGHT_INVALID_SCENE, "faces of arrays lie in no object");
    done(patchlight_scene_group_lights(scene, PATCHLIGHT_LIGHTS_BY_MATERIAL as u32));
    done(patchlight_scene_commit(scene));
    assert_eq!(told(patchlight_scene_group_lights(scene, 0)), PATCHLIGHT_WRONG_STATE);
    done(patchlight_scene_release(scene));

    // Without groups.
    let solution = solved(context, closed_box(context), &[]);
    let mut count = 9;
    // SAFETY: A place for a count.
    done(unsafe { patchlight_solution_light_group_count(solution, &mut count) });
    assert_eq!((count, relit(solution, &[1.0]).0), (0, PATCHLIGHT_NOT_AVAILABLE));
    done(patchlight_solution_release(solution));
    done(patchlight_context_release(context));
}

#[test]
fn other_materials_make_a_furnace_of_a_box() {
    let context = context(1);
    let solution = solved(context, closed_box(context), &[("keep_transport", "true")]);
    let with = |reflectance: *const patchlight_array, exitance: *const patchlight_array, error: f64| {
        let mut changed = null_mut();
        // SAFETY: Arrays that live on, and a place for a handle.
        let status = told(unsafe { patchlight_solution_with_materials(solution, reflectance, exitance, error, &mut changed) });
        (status, changed)
    };

    // All emit 1 W/m^2 and reflect one half.
    let (half, one) = (array(DOUBLE, &[0.5, 0.5], 1), array(DOUBLE, &[1.0, 1.0], 1));
    let (status, furnace) = with(&half, &one, 0.0);
    assert_eq!(status, PATCHLIGHT_OK);
    assert!(of_surfaces(furnace).iter().all(|b| (b - 2.0).abs() < 0.05), "{:?}", of_surfaces(furnace));
    assert_eq!(figure(furnace, PATCHLIGHT_ERROR_REQUESTED), 0.1);
    // The ceiling is sampled, and walls by paths: that has noise.
    let claimed = figure(furnace, PATCHLIGHT_ERROR_ESTIMATE);
    assert!(claimed > 0.0 && claimed <= 0.1, "{claimed}");

    // NULL leaves things as they are; what is claimed may be more than is asked for.
    let (status, same) = with(null(), null(), 1e-6);
    assert_eq!(status, PATCHLIGHT_LIMIT);
    assert!(figure(same, PATCHLIGHT_ERROR_ESTIMATE) > 1e-6 && figure(same, PATCHLIGHT_ERROR_REQUESTED) == 1e-6);

    // What is refused leaves nothing.
    let (few, white) = (array(DOUBLE, &[0.5], 1), array(DOUBLE, &[0.5, 1.0], 1));
    for (reflectance, error, expected) in [
        (&few, 0.0, PATCHLIGHT_INVALID_ARGUMENT),
        (&white, 0.0, PATCHLIGHT_OUT_OF_RANGE),
        (&half, -1.0, PATCHLIGHT_OUT_OF_RANGE),
        (&half, f64::NAN, PATCHLIGHT_OUT_OF_RANGE),
    ] {
        let (status, nothing) = with(reflectance, null(), error);
        assert!(status == expected && nothing.is_null(), "{status:?} for {expected:?}");
    }
    for solution in [furnace, same, solution] {
        done(patchlight_solution_release(solution));
    }
    done(patchlight_context_release(context));
}
