//! Every function with NULL, wrong sizes, handles that are not alive, from eight threads, after a failed commit: a status and a message.

#[path = "support/calls.rs"]
mod support;

use std::ffi::CString;
use std::ptr::{null, null_mut};

use patchlight_capi::patchlight_items::*;
use patchlight_capi::patchlight_real::*;
use patchlight_capi::patchlight_status::*;
use patchlight_capi::*;
use support::*;

/// A function by its name, and a call of it.
type Call = (&'static str, fn(&Handles) -> patchlight_status);

/// What functions are handed. All five handles are NULL, or not alive, or alive.
#[derive(Clone, Copy)]
struct Handles {
    context: *mut patchlight_context,
    options: *mut patchlight_options,
    scene: *mut patchlight_scene,
    solution: *mut patchlight_solution,
    mesh: *mut patchlight_mesh,
}

// SAFETY: Handles are numbers, and any thread may use any of them.
unsafe impl Send for Handles {}
// SAFETY: As above.
unsafe impl Sync for Handles {}

macro_rules! calls {
    ($($name:ident($h:ident $(, $argument:expr)*);)+) => {
        &[$((stringify!($name), |#[allow(unused_variables, reason = "some take no handle")] $h: &Handles| {
            #[allow(unused_unsafe, reason = "some take handles alone")]
            // SAFETY: NULL wherever a pointer is needed that is not a handle.
            unsafe { $name($($argument),*) }
        }),)+]
    };
}

/// All functions of the header but releases, whose NULL is let go by; every pointer that is no handle is NULL.
const CALLS: &[Call] = calls! {
    patchlight_context_create(h, 1, null_mut());
    patchlight_context_create_sharing(h, h.context, null_mut());
    patchlight_context_threads(h, h.context, null_mut());
    patchlight_mesh_export(h, h.mesh, null());
    patchlight_mesh_get_array(h, h.mesh, 1, null(), null_mut());
    patchlight_mesh_get_figure(h, h.mesh, 1, null_mut());
    patchlight_mesh_get_picture(h, h.mesh, null(), null_mut(), 0, null_mut());
    patchlight_mesh_get_values(h, h.mesh, null(), null(), null(), null_mut());
    patchlight_mesh_write_picture(h, h.mesh, null(), null());
    patchlight_option_count(h, null_mut());
    patchlight_option_get_text(h, 0, 1, null_mut(), 0, null_mut());
    patchlight_option_get_type(h, 0, null_mut());
    patchlight_options_create(h, null_mut());
    patchlight_options_get_text(h, h.options, null(), null_mut(), 0, null_mut());
    patchlight_options_reset(h, h.options, null());
    patchlight_options_set_bool(h, h.options, null(), 1);
    patchlight_options_set_double(h, h.options, null(), 1.0);
    patchlight_options_set_text(h, h.options, null(), null());
    patchlight_options_set_uint64(h, h.options, null(), 1);
    patchlight_scene_add_faces(h, h.scene, null(), null(), null());
    patchlight_scene_add_file(h, h.scene, null(), 0);
    patchlight_scene_add_lights(h, h.scene, null(), 0);
    patchlight_scene_add_materials(h, h.scene, null(), null());
    patchlight_scene_add_to_light_group(h, h.scene, null(), null());
    patchlight_scene_add_vertices(h, h.scene, null());
    patchlight_scene_create(h, h.context, 3, 0, null_mut());
    patchlight_scene_diagnostic(h, h.scene, 0, null_mut());
    patchlight_scene_diagnostic_count(h, h.scene, null_mut());
    patchlight_scene_diagnostic_text(h, h.scene, 0, null_mut(), 0, null_mut());
    patchlight_scene_get_figure(h, h.scene, 1, null_mut());
    patchlight_scene_group_lights(h, h.scene, 9);
    patchlight_scene_triangle_planes(h, h.scene, null_mut(), 0, null_mut());
    patchlight_scene_triangles(h, h.scene, null_mut(), 0, null_mut());
    patchlight_solution_count(h, h.solution, 1, null_mut());
    patchlight_solution_export(h, h.solution, null());
    patchlight_solution_get_camera(h, h.solution, null_mut());
    patchlight_solution_get_double(h, h.solution, 1, 1, null_mut(), 0, null_mut());
    patchlight_solution_get_figure(h, h.solution, 1, null_mut());
    patchlight_solution_get_mesh(h, h.solution, null_mut());
    patchlight_solution_get_picture(h, h.solution, null(), null_mut(), null_mut(), 0, null_mut());
    patchlight_solution_get_report(h, h.solution, null_mut(), 0, null_mut());
    patchlight_solution_get_status(h, h.solution, null_mut());
    patchlight_solution_get_uint32(h, h.solution, 1, 1, null_mut(), 0, null_mut());
    patchlight_solution_get_values(h, h.solution, null(), null(), null(), null_mut());
    patchlight_solution_light_group_count(h, h.solution, null_mut());
    patchlight_solution_light_group_name(h, h.solution, 0, null_mut(), 0, null_mut());
    patchlight_solution_load(h, h.context, null(), null(), null_mut());
    patchlight_solution_make_mesh(h, h.solution, 0.5, null_mut());
    patchlight_solution_relight(h, h.solution, null(), null_mut());
    patchlight_solution_save(h, h.solution, null());
    patchlight_solution_with_materials(h, h.solution, null(), null(), 0.0, null_mut());
    patchlight_solution_write_picture(h, h.solution, null(), null());
    patchlight_solve(h, h.context, h.scene, null(), null_mut());
    patchlight_get_version(h, null_mut(), null_mut(), null_mut());
};

/// Those that may succeed with a handle that is alive, and need nothing else.
const HANDLES_ALONE: &[Call] = calls! {
    patchlight_context_retain(h, h.context);
    patchlight_context_set_log(h, h.context, None, null_mut());
    patchlight_mesh_retain(h, h.mesh);
    patchlight_options_retain(h, h.options);
    patchlight_scene_commit(h, h.scene);
    patchlight_scene_retain(h, h.scene);
    patchlight_solution_retain(h, h.solution);
    patchlight_solution_set_progress(h, h.solution, None, null_mut());
};

const RELEASES: &[Call] = calls! {
    patchlight_context_release(h, h.context);
    patchlight_mesh_release(h, h.mesh);
    patchlight_options_release(h, h.options);
    patchlight_scene_release(h, h.scene);
    patchlight_solution_release(h, h.solution);
};

/// Those that take no handle.
const WITHOUT_HANDLES: [&str; 6] = [
    "patchlight_context_create",
    "patchlight_option_count",
    "patchlight_option_get_text",
    "patchlight_option_get_type",
    "patchlight_options_create",
    "patchlight_get_version",
];

const NOBODY: Handles =
    Handles { context: null_mut(), options: null_mut(), scene: null_mut(), solution: null_mut(), mesh: null_mut() };

fn alive() -> Handles {
    let context = context(1);
    let solution = lit_box(context, &[]);
    Handles { context, options: options(&[]), scene: closed_box(context), solution, mesh: mesh_of(solution, 0.5) }
}

fn release(handles: &Handles) {
    for (name, call) in RELEASES {
        assert_eq!(told(call(handles)), PATCHLIGHT_OK, "{name}");
    }
}

#[test]
fn the_lists_are_the_header() {
    let header = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/include/patchlight.h")).unwrap();
    let declared = header.lines().filter_map(|line| line.strip_prefix("patchlight_status ")?.split_once('('));
    let mut declared: Vec<&str> = declared.map(|(name, _)| name).collect();
    declared.sort_unstable();
    let mut called: Vec<&str> = [CALLS, HANDLES_ALONE, RELEASES].concat().iter().map(|(name, _)| *name).collect();
    called.push("patchlight_get_message");
    called.sort_unstable();
    assert_eq!(called, declared);
}

#[test]
fn null_is_refused_with_and_without_handles() {
    // SAFETY: NULL is what is asked about.
    assert_eq!(unsafe { patchlight_get_message(null_mut()) }, PATCHLIGHT_INVALID_ARGUMENT);
    for (name, call) in [CALLS, HANDLES_ALONE].concat() {
        assert!(told(call(&NOBODY)) as i32 >= 100, "{name}");
    }
    release(&NOBODY);
    let alive = alive();
    for (name, call) in CALLS {
        assert!(told(call(&alive)) as i32 >= 100, "{name}");
    }
    release(&alive);
}

#[test]
fn handles_that_were_released_or_are_of_another_kind_are_refused() {
    let alive = alive();
    let other = Handles {
        context: alive.scene.cast(),
        options: alive.solution.cast(),
        scene: alive.options.cast(),
        solution: alive.mesh.cast(),
        mesh: alive.context.cast(),
    };
    let nonsense = Handles {
        context: 7 as *mut _,
        options: usize::MAX as *mut _,
        scene: (&raw const alive).cast_mut().cast(),
        solution: (1_usize << 40) as *mut _,
        mesh: 9 as *mut _,
    };
    let refused = |handles: &Handles| {
        for (name, call) in [CALLS, HANDLES_ALONE, RELEASES].concat() {
            if !WITHOUT_HANDLES.contains(&name) {
                assert_eq!(told(call(handles)), PATCHLIGHT_INVALID_HANDLE, "{name}: {}", message());
            }
        }
    };
    refused(&other);
    refused(&nonsense);
    release(&alive);
    refused(&alive);
}

#[test]
fn a_handle_that_was_retained_lives_until_its_last_release() {
    let context = context(1);
    let solution = lit_box(context, &[]);
    done(patchlight_solution_retain(solution));
    done(patchlight_solution_release(solution));
    // The context went first.
    done(patchlight_context_release(context));
    assert_eq!(reals(solution, PATCHLIGHT_SURFACES, PATCHLIGHT_RADIOSITY).len(), 6);
    done(patchlight_solution_release(solution));
    assert_eq!(told(patchlight_solution_release(solution)), PATCHLIGHT_INVALID_HANDLE);
}

#[test]
fn eight_threads_do_all_of_it_at_once() {
    let alive = alive();
    std::thread::scope(|scope| {
        for _ in 0..8 {
            scope.spawn(move || {
                let alive = { alive };
                for _ in 0..20 {
                    for (name, call) in CALLS {
                        assert!(told(call(&alive)) as i32 >= 100 && told(call(&NOBODY)) as i32 >= 100, "{name}");
                    }
                    done(patchlight_solution_retain(alive.solution));
                    assert_eq!(reals(alive.solution, PATCHLIGHT_SURFACES, PATCHLIGHT_RADIOSITY).len(), 6);
                    done(patchlight_solution_release(alive.solution));
                }
                release(&self::alive());
            });
        }
    });
    release(&alive);
}

/// Codes and texts of the diagnostics of a scene.
fn diagnostics(scene: *mut patchlight_scene) -> Vec<(u32, u64, String)> {
    let mut count = 0;
    // SAFETY: Places for a count, a struct with its size, and what `text` made.
    unsafe {
        done(patchlight_scene_diagnostic_count(scene, &mut count));
        (0..count)
            .map(|number| {
                let size = size_of::<patchlight_diagnostic>();
                let mut diagnostic = patchlight_diagnostic { size, code: 0, severity: 0, face: 0, line: 0 };
                done(patchlight_scene_diagnostic(scene, number, &mut diagnostic));
                let text = text(|buffer, capacity, count| patchlight_scene_diagnostic_text(scene, number, buffer, capacity, count));
                assert_eq!((diagnostic.size, diagnostic.line), (size, PATCHLIGHT_NONE));
                (diagnostic.code, diagnostic.face, text)
            })
            .collect()
    }
}

#[test]
fn a_failed_commit_tells_all_and_can_be_mended() {
    let (context, mut scene, mut solution) = (context(1), null_mut(), null_mut());
    let vertices = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, f64::NAN, 0.0, 0.0];
    let (corners, materials) = ([0_u32, 1, 2, 0, 1, 3, 0, 1, 9, 0, 0, 1], [0_u32, 0, 0, 7]);
    // SAFETY: Arrays and places that live on.
    unsafe {
        done(patchlight_scene_create(context, 1, 0, &mut scene));
        assert_eq!(told(patchlight_scene_commit(scene)), PATCHLIGHT_INVALID_SCENE);
        done(patchlight_scene_add_vertices(scene, &array(DOUBLE, &vertices, 3)));
        done(patchlight_scene_add_faces(scene, &array(UINT32, &corners, 1), null(), &array(UINT32, &materials, 1)));
        done(patchlight_scene_add_materials(scene, &array(DOUBLE, &[f64::NAN], 1), &array(DOUBLE, &[-1.0], 1)));
    }
    assert_eq!(told(patchlight_scene_commit(scene)), PATCHLIGHT_INVALID_SCENE);
    let found = diagnostics(scene);
    let places: Vec<(u32, u64)> = found.iter().map(|(code, face, _)| (*code, *face)).collect();
    assert_eq!(places, [(301, 1), (300, 2), (300, 3), (302, PATCHLIGHT_NONE)], "{found:?}");
    assert!(found[0].2.starts_with("face 2: vertex 3") && found[3].2.contains("reflectance NaN"), "{found:?}");
    // SAFETY: A place for a handle.
    assert_eq!(told(unsafe { patchlight_solve(context, scene, null(), &mut solution) }), PATCHLIGHT_WRONG_STATE);
    assert!(solution.is_null());
    done(patchlight_scene_release(scene));

    // A scene that lacks a material is mended by adding it; a committed one is closed.
    let scene = open_box(context, 5.0);
    let face = [0_u32, 1, 2];
    // SAFETY: Arrays that live on.
    unsafe {
        done(patchlight_scene_add_faces(scene, &array(UINT32, &face, 1), null(), &array(UINT32, &[2_u32], 1)));
        assert_eq!(told(patchlight_scene_commit(scene)), PATCHLIGHT_INVALID_SCENE);
        done(patchlight_scene_add_materials(scene, &array(DOUBLE, &[0.5], 1), &array(DOUBLE, &[0.0], 1)));
        done(patchlight_scene_commit(scene));
        assert_eq!(told(patchlight_scene_add_vertices(scene, &array(DOUBLE, &[0.0; 3], 3))), PATCHLIGHT_WRONG_STATE);
        assert_eq!(told(patchlight_scene_commit(scene)), PATCHLIGHT_WRONG_STATE);
    }
    done(patchlight_scene_release(scene));
    done(patchlight_context_release(context));
}

#[test]
fn arrays_that_cannot_be_are_refused() {
    let context = context(1);
    let scene = open_box(context, 5.0);
    let good = array(DOUBLE, &VERTICES, 3);
    for (bad, expected) in [
        (patchlight_array { size: 0, ..good }, PATCHLIGHT_INVALID_ARGUMENT),
        (patchlight_array { format: 99, ..good }, PATCHLIGHT_INVALID_ARGUMENT),
        (patchlight_array { format: UINT32, ..good }, PATCHLIGHT_INVALID_ARGUMENT),
        (patchlight_array { data: null(), ..good }, PATCHLIGHT_INVALID_ARGUMENT),
        (patchlight_array { stride: 23, ..good }, PATCHLIGHT_INVALID_ARGUMENT),
        (patchlight_array { count: usize::MAX, ..good }, PATCHLIGHT_INVALID_ARGUMENT),
        (patchlight_array { count: 1 << 60, stride: 1 << 40, ..good }, PATCHLIGHT_INVALID_ARGUMENT),
    ] {
        // SAFETY: Arrays that are refused before they are read.
        assert_eq!(told(unsafe { patchlight_scene_add_vertices(scene, &bad) }), expected, "{bad:?}");
    }
    // SAFETY: Arrays that live on; the counts need more corners than there are.
    unsafe {
        let (corners, counts) = ([0_u32, 1, 2], [u32::MAX]);
        let status = patchlight_scene_add_faces(scene, &array(UINT32, &corners, 1), &array(UINT32, &counts, 1), null());
        assert_eq!(told(status), PATCHLIGHT_INVALID_ARGUMENT);
        let status = patchlight_scene_add_faces(scene, &array(UINT32, &corners[..2], 1), null(), null());
        assert_eq!(told(status), PATCHLIGHT_INVALID_ARGUMENT);
    }
    done(patchlight_scene_release(scene));
    done(patchlight_context_release(context));
}

#[test]
fn contradictions_between_options_are_found_by_the_solve() {
    let context = context(1);
    let (scene, options, mut solution) =
        (closed_box(context), options(&[("bounds", "guaranteed"), ("strategy", "lazy94")]), null_mut());
    // SAFETY: A struct with its size, and a place for a handle.
    assert_eq!(told(unsafe { patchlight_solve(context, scene, &info(options), &mut solution) }), PATCHLIGHT_OUT_OF_RANGE);
    assert!(message().contains("bounds"));
    let path = CString::new("/no/such/file.obj").unwrap();
    let mut of_file = null_mut();
    // SAFETY: A place for a handle, and a text that ends in a zero.
    unsafe {
        done(patchlight_scene_create(context, 3, 0, &mut of_file));
        assert_eq!(told(patchlight_scene_add_file(of_file, path.as_ptr(), 0)), PATCHLIGHT_INVALID_SCENE);
        assert_eq!(told(patchlight_scene_add_file(of_file, path.as_ptr(), 8)), PATCHLIGHT_INVALID_ARGUMENT);
        assert_eq!(told(patchlight_scene_add_lights(of_file, path.as_ptr(), 0)), PATCHLIGHT_INVALID_SCENE);
        assert_eq!(told(patchlight_scene_add_lights(of_file, path.as_ptr(), 8)), PATCHLIGHT_INVALID_ARGUMENT);
        assert_eq!(told(patchlight_scene_create(context, 0, 0, &mut of_file)), PATCHLIGHT_INVALID_ARGUMENT);
        assert_eq!(told(patchlight_scene_create(context, 3, 5, &mut of_file)), PATCHLIGHT_INVALID_ARGUMENT);
        let mut second = null_mut();
        assert_eq!(told(patchlight_context_create(u32::MAX, &mut second)), PATCHLIGHT_OUT_OF_RANGE);
    }
    done(patchlight_scene_release(of_file));
    done(patchlight_options_release(options));
    done(patchlight_scene_release(scene));
    done(patchlight_context_release(context));
}
