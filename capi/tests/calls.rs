//! What functions do that are called as they should be: options, scenes from arrays and files, results, files, progress.

#[path = "support/calls.rs"]
mod support;

use std::ffi::{CString, c_char, c_void};
use std::path::Path;
use std::ptr::{null, null_mut};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use patchlight::pipeline;
use patchlight::progress::Silent;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::solve::{RunOptions, SolveOptions};
use patchlight_capi::patchlight_items::*;
use patchlight_capi::patchlight_real::*;
use patchlight_capi::patchlight_status::*;
use patchlight_capi::patchlight_whole::*;
use patchlight_capi::*;
use support::*;

fn c(text: &str) -> CString {
    CString::new(text).unwrap()
}

fn scenes() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes"))
}

#[test]
fn options_are_those_of_the_program_and_tell_about_themselves() {
    let mut count = 0;
    // SAFETY: A place for a count.
    done(unsafe { patchlight_option_count(&mut count) });
    let about = |option, what: patchlight_option_text| {
        text(|buffer, capacity, count| {
            // SAFETY: Places that `text` made.
            unsafe { patchlight_option_get_text(option, what as u32, buffer, capacity, count) }
        })
    };
    let keys: Vec<String> = (0..count).map(|option| about(option, patchlight_option_text::PATCHLIGHT_OPTION_KEY)).collect();
    let of_library: Vec<&str> = SolveOptions::entries().map(|entry| entry.key).collect();
    assert_eq!(keys[..of_library.len()], of_library);
    assert_eq!(keys[of_library.len()..], ["backend", "time", "memory"]);
    for (option, key) in keys.iter().enumerate() {
        let (mut value_type, options, key) = (0, options(&[]), c(key));
        let default = about(option, patchlight_option_text::PATCHLIGHT_OPTION_DEFAULT);
        assert!(
            !about(option, patchlight_option_text::PATCHLIGHT_OPTION_HELP).is_empty()
                && !about(option, patchlight_option_text::PATCHLIGHT_OPTION_RANGE).is_empty()
        );
        // SAFETY: Places for numbers, and texts that end in a zero.
        unsafe {
            done(patchlight_option_get_type(option, &mut value_type));
            assert!((1..=4).contains(&value_type));
            if !default.is_empty() {
                // A default is legal, and is what there is.
                done(patchlight_options_set_text(options, key.as_ptr(), c(&default).as_ptr()));
                assert_eq!(
                    text(|buffer, capacity, count| patchlight_options_get_text(options, key.as_ptr(), buffer, capacity, count)),
                    default
                );
            }
            done(patchlight_options_reset(options, key.as_ptr()));
        }
        done(patchlight_options_release(options));
    }
}

#[test]
fn options_are_set_by_their_types_and_bad_ones_change_nothing() {
    let options = options(&[]);
    let get = |key: &str| {
        let key = c(key);
        // SAFETY: Places that `text` made.
        text(|buffer, capacity, count| unsafe { patchlight_options_get_text(options, key.as_ptr(), buffer, capacity, count) })
    };
    // SAFETY: Texts that end in a zero.
    unsafe {
        done(patchlight_options_set_double(options, c("error").as_ptr(), 0.1));
        done(patchlight_options_set_uint64(options, c("seed").as_ptr(), u64::MAX));
        done(patchlight_options_set_bool(options, c("ambient").as_ptr(), 0));
        done(patchlight_options_set_double(options, c("memory").as_ptr(), 0.5));
        for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0, 2.0] {
            assert_eq!(told(patchlight_options_set_double(options, c("error").as_ptr(), bad)), PATCHLIGHT_OUT_OF_RANGE);
        }
        for bad in [f64::NAN, 0.0, -1.0, f64::INFINITY] {
            assert_eq!(told(patchlight_options_set_double(options, c("time").as_ptr(), bad)), PATCHLIGHT_OUT_OF_RANGE);
        }
        assert_eq!(told(patchlight_options_set_double(options, c("seed").as_ptr(), 1.0)), PATCHLIGHT_OUT_OF_RANGE);
        assert_eq!(
            told(patchlight_options_set_text(options, c("backend").as_ptr(), c("embree9").as_ptr())),
            PATCHLIGHT_OUT_OF_RANGE
        );
        assert_eq!(told(patchlight_options_set_text(options, c("eror").as_ptr(), c("1").as_ptr())), PATCHLIGHT_UNKNOWN_OPTION);
        assert_eq!(told(patchlight_options_set_uint64(options, c("threads").as_ptr(), 2)), PATCHLIGHT_UNKNOWN_OPTION);
        assert_eq!(told(patchlight_options_set_text(options, c("error").as_ptr(), c"\xff".as_ptr())), PATCHLIGHT_INVALID_ARGUMENT);
    }
    assert_eq!([get("error"), get("seed"), get("ambient"), get("memory")], ["0.1", "18446744073709551615", "false", "0.5"]);
    done(patchlight_options_release(options));
}

/// Lights a file in C and in Rust: all radiosities, values and bounds must be the same to the bit.
#[test]
fn a_file_is_lit_as_the_library_lights_it() {
    let (context, mut scene, mut solution) = (context(2), null_mut(), null_mut());
    let path = scenes().join("cornell.obj");
    let options = options(&[("error", "0.1"), ("seed", "7")]);
    // SAFETY: Places for handles, texts that end in a zero, a struct with its size.
    unsafe {
        done(patchlight_scene_create(context, 3, 0, &mut scene));
        done(patchlight_scene_add_file(scene, c(path.to_str().unwrap()).as_ptr(), 0));
        done(patchlight_scene_commit(scene));
        done(patchlight_solve(context, scene, &info(options), &mut solution));
    }
    let by_rust = SolveOptions { error: 0.1, seed: 7, ..SolveOptions::default() };
    let imported = read_scene(&path, &ImportOptions::default()).unwrap();
    let (lit, report) = pipeline::solve(imported.scene, &by_rust, &RunOptions::default(), &Silent).unwrap();
    let (lit, hierarchy) = (lit.solution(), lit.solution().hierarchy());
    assert_eq!(reals(solution, PATCHLIGHT_NODES, PATCHLIGHT_RADIOSITY), lit.radiosity().values());
    assert_eq!(wholes(solution, PATCHLIGHT_LINKS, PATCHLIGHT_SOURCE).len(), lit.links().len());
    let leaves: Vec<u32> = hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)).map(|node| node.0).collect();
    assert_eq!(wholes(solution, PATCHLIGHT_ELEMENTS, PATCHLIGHT_NODE), leaves);
    let corners: u32 = wholes(solution, PATCHLIGHT_ELEMENTS, PATCHLIGHT_CORNER_COUNT).iter().sum();
    assert_eq!(reals(solution, PATCHLIGHT_ELEMENTS, PATCHLIGHT_CORNERS).len(), 3 * corners as usize);

    let mut estimate = 0.0;
    // SAFETY: A place for a number, and places that `text` made.
    let json = unsafe {
        done(patchlight_solution_get_figure(solution, patchlight_figure::PATCHLIGHT_ERROR_ESTIMATE as u32, &mut estimate));
        text(|buffer, capacity, count| patchlight_solution_get_report(solution, buffer, capacity, count))
    };
    assert_eq!(estimate, report.error.estimate);
    assert!(json.contains("\"schema\"") && json.contains("cornell.obj") && json.contains("\"threads\": 2"), "{json}");
    done(patchlight_solution_release(solution));
    done(patchlight_options_release(options));
    done(patchlight_scene_release(scene));
    done(patchlight_context_release(context));
}

#[test]
fn a_solution_is_saved_loaded_exported_and_pictured() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| c(folder.path().join(name).to_str().unwrap());
    let (context, mut again) = (context(1), null_mut());
    let solution = lit_box(context, &[("bounds", "guaranteed")]);
    let camera = |width| patchlight_camera {
        size: size_of::<patchlight_camera>(),
        width,
        height: 6,
        eye: [0.0; 3],
        target: [0.0; 3],
        up: [0.0; 3],
        field_of_view: 0.0,
    };
    // SAFETY: Places for handles and numbers, texts that end in a zero, structs with their sizes.
    unsafe {
        done(patchlight_solution_save(solution, path("a.solution").as_ptr()));
        done(patchlight_solution_load(context, path("a.solution").as_ptr(), null(), &mut again));
        done(patchlight_solution_export(solution, path("a.ply").as_ptr()));
        assert_eq!(told(patchlight_solution_export(solution, path("a.txt").as_ptr())), PATCHLIGHT_INVALID_ARGUMENT);
        assert_eq!(told(patchlight_solution_save(solution, path("no/a.solution").as_ptr())), PATCHLIGHT_FILE_ERROR);
        assert_eq!(told(patchlight_solution_load(context, path("a.ply").as_ptr(), null(), &mut again)), PATCHLIGHT_FILE_ERROR);
        let mut status = PATCHLIGHT_OK;
        assert_eq!(told(patchlight_solution_get_status(again, &mut status)), PATCHLIGHT_NOT_AVAILABLE);

        let mut pictures = Vec::new();
        for of in [solution, again] {
            let (mut camera, mut radiance) = (camera(8), vec![0.0_f32; 48]);
            done(patchlight_solution_get_camera(of, &mut camera));
            done(patchlight_solution_get_picture(of, &camera, radiance.as_mut_ptr(), null_mut(), 48, null_mut()));
            done(patchlight_solution_write_picture(of, &camera, path("a.png").as_ptr()));
            done(patchlight_solution_write_picture(of, &camera, path("a.exr").as_ptr()));
            pictures.push(radiance);
        }
        assert!(pictures[0] == pictures[1] && pictures[0].iter().any(|&radiance| radiance > 0.0));
        let mut none = camera(0);
        assert_eq!(told(patchlight_solution_get_camera(solution, &mut none)), PATCHLIGHT_INVALID_ARGUMENT);
    }
    for name in ["a.solution", "a.ply", "a.png", "a.exr"] {
        assert!(folder.path().join(name).metadata().unwrap().len() > 100, "{name}");
    }
    done(patchlight_solution_release(again));
    done(patchlight_solution_release(solution));
    done(patchlight_context_release(context));
}

#[test]
fn bounds_hold_what_they_are_about() {
    let context = context(1);
    let solution = lit_box(context, &[("bounds", "guaranteed")]);
    let lower = reals(solution, PATCHLIGHT_SURFACES, PATCHLIGHT_LOWER);
    let upper = reals(solution, PATCHLIGHT_SURFACES, PATCHLIGHT_UPPER);
    let (point, normal) = ([0.5, 0.0, 0.5], [0.0, 1.0, 0.0]);
    let (mut radiosity, mut least, mut most) = (0.0_f32, 0.0_f32, 0.0_f32);
    let values = patchlight_values {
        size: size_of::<patchlight_values>(),
        capacity: 1,
        radiosity: &mut radiosity,
        standard_error: null_mut(),
        lower: &mut least,
        upper: &mut most,
    };
    // SAFETY: Arrays and places that live on.
    done(unsafe {
        patchlight_solution_get_values(solution, &array(DOUBLE, &point, 3), &array(DOUBLE, &normal, 3), &values, null_mut())
    });
    assert!(0.0 < least && least <= radiosity && radiosity <= most);
    assert!(lower.iter().zip(&upper).all(|(lower, upper)| lower <= upper) && lower.len() == 6);
    done(patchlight_solution_release(solution));
    done(patchlight_context_release(context));
}

/// Counts reports, and says whether two came at once.
struct User {
    reports: AtomicUsize,
    inside: AtomicBool,
    overlapped: AtomicBool,
    patience: usize,
}

unsafe extern "C" fn listen(user: *mut c_void, progress: *const patchlight_progress) -> i32 {
    // SAFETY: A `User` that the test below lends, and the report of the library.
    let (user, progress) = unsafe { (&*user.cast::<User>(), &*progress) };
    if user.inside.swap(true, Ordering::SeqCst) {
        user.overlapped.store(true, Ordering::SeqCst);
    }
    assert_eq!(progress.size, size_of::<patchlight_progress>());
    assert!((1..=8).contains(&progress.stage));
    let reports = user.reports.fetch_add(1, Ordering::SeqCst) + 1;
    user.inside.store(false, Ordering::SeqCst);
    i32::from(reports >= user.patience)
}

#[test]
fn progress_comes_from_one_thread_at_a_time_and_cancels() {
    let context = context(4);
    for patience in [usize::MAX, 1, 3] {
        let user =
            User { reports: AtomicUsize::new(0), inside: AtomicBool::new(false), overlapped: AtomicBool::new(false), patience };
        let (scene, options, mut solution) = (closed_box(context), options(&[("error", "0.05"), ("backend", "obvhs")]), null_mut());
        let info =
            patchlight_solve_info { progress: Some(listen), progress_user: (&raw const user).cast_mut().cast(), ..info(options) };
        // SAFETY: A struct with its size whose user lives on, and a place for a handle.
        let status = done(unsafe { patchlight_solve(context, scene, &info, &mut solution) });
        assert_eq!(status, if patience == usize::MAX { PATCHLIGHT_OK } else { PATCHLIGHT_CANCELLED });
        let reports = user.reports.load(Ordering::SeqCst);
        assert!(!user.overlapped.load(Ordering::SeqCst) && reports > 0 && reports <= patience, "{reports}");

        // What there is can be read; a picture that is cancelled writes nothing.
        assert_eq!(reals(solution, PATCHLIGHT_SURFACES, PATCHLIGHT_RADIOSITY).len(), 6);
        let quick =
            User { reports: AtomicUsize::new(0), inside: AtomicBool::new(false), overlapped: AtomicBool::new(false), patience: 1 };
        let mut camera = patchlight_camera {
            size: size_of::<patchlight_camera>(),
            width: 64,
            height: 64,
            eye: [0.0; 3],
            target: [0.0; 3],
            up: [0.0; 3],
            field_of_view: 0.0,
        };
        let mut radiance = vec![-1.0_f32; 64 * 64];
        // SAFETY: A user that lives on, and places for numbers.
        unsafe {
            done(patchlight_solution_set_progress(solution, Some(listen), (&raw const quick).cast_mut().cast()));
            done(patchlight_solution_get_camera(solution, &mut camera));
            let status =
                told(patchlight_solution_get_picture(solution, &camera, radiance.as_mut_ptr(), null_mut(), 64 * 64, null_mut()));
            assert_eq!(status, PATCHLIGHT_CANCELLED);
        }
        assert!(radiance.iter().all(|&x| x == -1.0));
        done(patchlight_solution_release(solution));
        done(patchlight_options_release(options));
        done(patchlight_scene_release(scene));
    }
    done(patchlight_context_release(context));
}

#[test]
fn limits_leave_a_solution_and_say_so() {
    let context = context(1);
    for (setting, expected) in [
        (("time", "1e-9"), PATCHLIGHT_LIMIT),
        (("max_links", "1"), PATCHLIGHT_LIMIT),
        // A little more than is needed to begin.
        (("memory", "0.0242"), PATCHLIGHT_MEMORY_LIMIT),
    ] {
        let (scene, options, mut solution) =
            (closed_box(context), options(&[("error", "0.01"), ("solver", "links"), setting]), null_mut());
        // SAFETY: A struct with its size, and a place for a handle.
        assert_eq!(done(unsafe { patchlight_solve(context, scene, &info(options), &mut solution) }), expected, "{setting:?}");
        assert_eq!(reals(solution, PATCHLIGHT_SURFACES, PATCHLIGHT_RADIOSITY).len(), 6);
        done(patchlight_solution_release(solution));
        done(patchlight_options_release(options));
        done(patchlight_scene_release(scene));
    }

    // Less than is needed to begin.
    let (scene, options, mut solution) = (closed_box(context), options(&[("memory", "0.001")]), null_mut());
    // SAFETY: A struct with its size, and a place for a handle.
    assert_eq!(told(unsafe { patchlight_solve(context, scene, &info(options), &mut solution) }), PATCHLIGHT_OUT_OF_RANGE);
    assert!(solution.is_null());
    done(patchlight_options_release(options));
    done(patchlight_scene_release(scene));
    done(patchlight_context_release(context));
}

unsafe extern "C" fn hear(user: *mut c_void, _level: u32, line: *const c_char) {
    // SAFETY: A vector that the test below lends, on its own thread, and a line of the library.
    unsafe { (*user.cast::<Vec<String>>()).push(std::ffi::CStr::from_ptr(line).to_str().unwrap().to_owned()) };
}

#[test]
fn contexts_share_threads_and_log_for_themselves() {
    let (first, mut second, mut threads) = (context(3), null_mut(), 0);
    let mut lines: Vec<String> = Vec::new();
    // SAFETY: Places for a handle and a number; the lines live longer than the contexts.
    unsafe {
        done(patchlight_context_create_sharing(first, &mut second));
        done(patchlight_context_set_log(second, Some(hear), (&raw mut lines).cast()));
        done(patchlight_context_release(first));
        done(patchlight_context_threads(second, &mut threads));
    }
    assert_eq!(threads, 3);
    let dark = open_box(second, 0.0);
    done(patchlight_scene_commit(dark));
    assert!(lines.len() == 1 && lines[0].contains("no light"), "{lines:?}");
    done(patchlight_solution_release(lit_box(second, &[])));
    assert!(lines.len() == 2 && lines[1].contains("elements"), "{lines:?}");
    done(patchlight_scene_release(dark));
    done(patchlight_context_release(second));
}

#[test]
fn arrays_and_a_file_make_one_scene() {
    let (context, mut scene) = (context(1), null_mut());
    // A lamp under the ceiling of the Cornell box, of floats with something in between.
    let lamp: [f32; 12] = [0.4, 0.9, 0.4, 7.0, 0.6, 0.9, 0.4, 7.0, 0.5, 0.9, 0.6, 7.0];
    let positions = patchlight_array { count: 3, stride: 16, ..array(FLOAT, &lamp, 4) };
    let (corners, rho, e) = ([0_u32, 1, 2], [0.5; 3], [9.0; 3]);
    let path = c(scenes().join("cornell.obj").to_str().unwrap());
    let mut figures = [0.0; 2];
    // SAFETY: Arrays and places that live on, and a text that ends in a zero.
    unsafe {
        done(patchlight_scene_create(context, 3, 0, &mut scene));
        done(patchlight_scene_add_file(scene, path.as_ptr(), 0));
        done(patchlight_scene_add_materials(scene, &array(DOUBLE, &rho, 3), &array(DOUBLE, &e, 3)));
        done(patchlight_scene_add_vertices(scene, &positions));
        done(patchlight_scene_add_faces(scene, &array(UINT32, &corners, 1), null(), null()));
        done(patchlight_scene_commit(scene));
        for (what, figure) in
            [patchlight_scene_figure::PATCHLIGHT_SCENE_SURFACES, patchlight_scene_figure::PATCHLIGHT_SCENE_MATERIALS]
                .into_iter()
                .zip(&mut figures)
        {
            done(patchlight_scene_get_figure(scene, what as u32, figure));
        }
    }
    let file = read_scene(&scenes().join("cornell.obj"), &ImportOptions::default()).unwrap().scene;
    assert_eq!(figures, [file.surfaces().len() as f64 + 1.0, file.materials().len() as f64 + 1.0]);
    done(patchlight_scene_release(scene));
    done(patchlight_context_release(context));
}
