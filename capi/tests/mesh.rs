//! Lit meshes: those of the Rust library, in buffers of any type and stride; and what cannot be.

#[path = "support/calls.rs"]
mod support;

use std::ffi::{CString, c_void};
use std::path::Path;
use std::ptr::{null, null_mut};

use patchlight::mesh::LitMesh;
use patchlight::output::{Provenance, write_mesh_ply};
use patchlight::picture::Camera;
use patchlight::pipeline::{self, Evaluator};
use patchlight::progress::Silent;
use patchlight::scene::SurfacePoint;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::solve::{RunOptions, SolveOptions};
use patchlight_capi::patchlight_mesh_array::*;
use patchlight_capi::patchlight_mesh_figure::*;
use patchlight_capi::patchlight_status::*;
use patchlight_capi::*;
use support::*;

const UINT64: u32 = patchlight_format::PATCHLIGHT_UINT64 as u32;

fn cornell() -> String {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/cornell.obj")).to_str().unwrap().to_owned()
}

/// The Cornell box, solved in C.
fn by_c(context: *mut patchlight_context) -> *mut patchlight_solution {
    solved(context, &cornell())
}

/// A file, solved in C.
fn solved(context: *mut patchlight_context, file: &str) -> *mut patchlight_solution {
    let (mut scene, mut solution) = (null_mut(), null_mut());
    let (options, path) = (options(&[("error", "0.1"), ("backend", "obvhs")]), CString::new(file).unwrap());
    // SAFETY: Places for handles, a text that ends in a zero, a struct with its size.
    unsafe {
        done(patchlight_scene_create(context, 3, 0, &mut scene));
        done(patchlight_scene_add_file(scene, path.as_ptr(), 0));
        done(patchlight_scene_commit(scene));
        done(patchlight_solve(context, scene, &info(options), &mut solution));
    }
    done(patchlight_options_release(options));
    done(patchlight_scene_release(scene));
    solution
}

/// The same in Rust.
fn by_rust() -> Evaluator {
    let scene = read_scene(Path::new(&cornell()), &ImportOptions::default()).unwrap().scene;
    let run = RunOptions { backend: "obvhs".parse().unwrap(), ..RunOptions::default() };
    pipeline::solve(scene, &SolveOptions { error: 0.1, ..SolveOptions::default() }, &run, &Silent).unwrap().0
}

fn count(mesh: *mut patchlight_mesh, what: patchlight_mesh_array) -> usize {
    let mut count = 0;
    // SAFETY: A place for a count.
    done(unsafe { patchlight_mesh_get_array(mesh, what as u32, null(), &mut count) });
    count
}

/// An array of a mesh, with `components` numbers an item.
fn read<T: Copy + Default>(mesh: *mut patchlight_mesh, what: patchlight_mesh_array, format: u32, components: usize) -> Vec<T> {
    let items = count(mesh, what);
    let mut numbers = vec![T::default(); items * components];
    let buffer = buffer(format, &mut numbers, components);
    // SAFETY: A buffer with its size that lives on.
    done(unsafe { patchlight_mesh_get_array(mesh, what as u32, &buffer, null_mut()) });
    numbers
}

fn buffer<T>(format: u32, data: &mut [T], components: usize) -> patchlight_buffer {
    let (size, capacity) = (size_of::<patchlight_buffer>(), data.len() / components);
    patchlight_buffer { size, format, data: data.as_mut_ptr().cast(), capacity, stride: 0 }
}

fn figure(mesh: *mut patchlight_mesh, what: patchlight_mesh_figure) -> f64 {
    let mut figure = -1.0;
    // SAFETY: A place for a number.
    done(unsafe { patchlight_mesh_get_figure(mesh, what as u32, &mut figure) });
    figure
}

#[test]
fn a_mesh_is_the_one_of_the_library() {
    let context = context(2);
    let solution = by_c(context);
    let mesh = mesh_of(solution, 0.1);
    // What the mesh needs of its solution it keeps.
    done(patchlight_solution_release(solution));
    done(patchlight_context_release(context));
    let evaluator = by_rust();
    let (made, scene) = (evaluator.lit_mesh(0.1, &Silent).unwrap(), evaluator.solution().scene());

    // Numbers of every type.
    assert_eq!(figure(mesh, PATCHLIGHT_MESH_CHANNELS), 3.0);
    assert_eq!(figure(mesh, PATCHLIGHT_MESH_NODE_COUNT), made.nodes() as f64);
    assert_eq!(figure(mesh, PATCHLIGHT_MESH_ELEMENT_COUNT), made.elements() as f64);
    assert_eq!([figure(mesh, PATCHLIGHT_MESH_MEASURED), figure(mesh, PATCHLIGHT_MESH_CLAIMED)], [made.measured, made.claimed]);
    let positions: Vec<f64> = read(mesh, PATCHLIGHT_MESH_POSITIONS, DOUBLE, 3);
    assert_eq!(positions, made.parts(scene).flat_map(|part| part.nodes).flatten().collect::<Vec<_>>());
    let as_floats: Vec<f32> = read(mesh, PATCHLIGHT_MESH_POSITIONS, FLOAT, 3);
    assert_eq!(as_floats, positions.iter().map(|&x| x as f32).collect::<Vec<_>>());
    let radiosity: Vec<f32> = read(mesh, PATCHLIGHT_MESH_RADIOSITY, FLOAT, 3);
    assert_eq!(radiosity, made.parts(scene).flat_map(|part| part.radiosity).collect::<Vec<_>>());
    let errors: Vec<f32> = read(mesh, PATCHLIGHT_MESH_ELEMENT_ERROR, FLOAT, 1);
    assert_eq!(errors, made.parts(scene).flat_map(|part| part.standard_errors).collect::<Vec<_>>());
    assert!(errors.len() == made.elements() && errors.iter().all(|error| error.is_finite()));
    let nodes: Vec<u32> = read(mesh, PATCHLIGHT_MESH_ELEMENT_NODES, UINT32, 6);
    let as_long: Vec<u64> = read(mesh, PATCHLIGHT_MESH_ELEMENT_NODES, UINT64, 6);
    assert_eq!(as_long, nodes.iter().map(|&node| u64::from(node)).collect::<Vec<_>>());

    // Elements are those that the library visits, one by one.
    let surfaces: Vec<u32> = read(mesh, PATCHLIGHT_MESH_ELEMENT_SURFACE, UINT32, 1);
    let mut element = 0;
    made.for_each_element(scene, |surface, at, light| {
        let own = &nodes[6 * element..][..6];
        let found: Vec<f64> = own.iter().flat_map(|&node| &positions[3 * node as usize..][..3]).copied().collect();
        let lit: Vec<f32> = own.iter().flat_map(|&node| &radiosity[3 * node as usize..][..3]).copied().collect();
        assert!(found == at.concat() && lit == light && surfaces[element] == surface, "element {element}");
        element += 1;
    });
    assert_eq!(element, surfaces.len());
    // They share nodes: of a surface's N triangles, about N / 2 corners and 3 N / 2 edges.
    assert!(made.nodes() < 3 * made.elements(), "{} nodes, {} elements", made.nodes(), made.elements());
    pictures_and_files(mesh, &evaluator, &made);
    done(patchlight_mesh_release(mesh));
}

fn pictures_and_files(mesh: *mut patchlight_mesh, evaluator: &Evaluator, made: &LitMesh) {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| CString::new(folder.path().join(name).to_str().unwrap()).unwrap();
    let camera = evaluator.default_camera(16, 12);
    let Camera { eye, target, up, field_of_view_degrees: field_of_view, width, height } = camera;
    let view = patchlight_camera { size: size_of::<patchlight_camera>(), width, height, eye, target, up, field_of_view };
    let mut radiance = vec![0.0_f32; 16 * 12 * 3];
    // SAFETY: Structs with their sizes, a buffer of the capacity that is told, texts that end in a zero.
    unsafe {
        done(patchlight_mesh_get_picture(mesh, &view, radiance.as_mut_ptr(), radiance.len(), null_mut()));
        done(patchlight_mesh_write_picture(mesh, &view, path("a.png").as_ptr()));
        done(patchlight_mesh_export(mesh, path("a.ply").as_ptr()));
        assert_eq!(told(patchlight_mesh_export(mesh, path("a.obj").as_ptr())), PATCHLIGHT_INVALID_ARGUMENT);
        assert_eq!(told(patchlight_mesh_write_picture(mesh, &view, path("a.ply").as_ptr())), PATCHLIGHT_INVALID_ARGUMENT);
        assert_eq!(told(patchlight_mesh_export(mesh, path("no/a.ply").as_ptr())), PATCHLIGHT_FILE_ERROR);
    }
    assert_eq!(radiance, evaluator.render_mesh(made, &camera, &Silent).unwrap().unwrap().radiance);
    let mut expected = Vec::new();
    let lit = evaluator.solution();
    write_mesh_ply(&mut expected, lit.scene(), made, &Provenance::new(lit.options())).unwrap();
    assert!(std::fs::read(folder.path().join("a.ply")).unwrap() == expected);
    assert!(std::fs::metadata(folder.path().join("a.png")).unwrap().len() > 100);
}

#[test]
fn values_are_those_of_the_library_with_any_stride() {
    let context = context(1);
    let solution = by_c(context);
    let (mesh, evaluator) = (mesh_of(solution, 0.1), by_rust());
    let made = evaluator.lit_mesh(0.1, &Silent).unwrap();
    let at = [0.45, 0.0, 0.1, 0.4, 0.0, 0.2, 9.0, 9.0, 9.0];
    let (positions, normals) = (array(DOUBLE, &at, 3), array(DOUBLE, &[0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0], 3));
    let points: Vec<SurfacePoint> =
        at.chunks(3).map(|at| SurfacePoint { position: at.try_into().unwrap(), normal: [0.0, 1.0, 0.0] }).collect();
    let expected = evaluator.values_of_mesh(&made, &points);

    // Items of 29 bytes, not aligned to anything; what lies between them stays.
    let (mut bytes, mut missed) = ([0xaa_u8; 90], 0);
    let into = patchlight_buffer { capacity: 3, stride: 29, ..buffer(DOUBLE, &mut bytes[1..], 1) };
    // SAFETY: Arrays and a buffer that live on, and a place for a count.
    done(unsafe { patchlight_mesh_get_values(mesh, &positions, &normals, &into, &mut missed) });
    for (point, value) in expected.chunks(3).enumerate() {
        let item = &bytes[1 + 29 * point..];
        let found: Vec<f64> = item[..24].chunks(8).map(|number| f64::from_ne_bytes(number.try_into().unwrap())).collect();
        assert!(
            found.iter().zip(value).all(|(&found, &value)| found.to_bits() == f64::from(value).to_bits()),
            "{found:?} {value:?}"
        );
        assert!(item.iter().skip(24).take(5).all(|&byte| byte == 0xaa));
    }
    assert!(missed == 1 && bytes[0] == 0xaa && expected[0] > 0.0 && expected[6].is_nan(), "{missed} {expected:?}");
    done(patchlight_mesh_release(mesh));
    done(patchlight_solution_release(solution));
    done(patchlight_context_release(context));
}

#[test]
fn buffers_that_cannot_be_are_refused_and_left_alone() {
    let context = context(1);
    let solution = lit_box(context, &[]);
    let mesh = mesh_of(solution, 0.5);
    let items = count(mesh, PATCHLIGHT_MESH_POSITIONS);
    let mut numbers = vec![-1.0_f64; 3 * items];
    let good = buffer(DOUBLE, &mut numbers, 3);
    for (bad, expected) in [
        (patchlight_buffer { size: 0, ..good }, PATCHLIGHT_INVALID_ARGUMENT),
        (patchlight_buffer { format: 99, ..good }, PATCHLIGHT_INVALID_ARGUMENT),
        (patchlight_buffer { format: UINT32, ..good }, PATCHLIGHT_INVALID_ARGUMENT),
        (patchlight_buffer { data: null_mut(), ..good }, PATCHLIGHT_INVALID_ARGUMENT),
        (patchlight_buffer { stride: 23, ..good }, PATCHLIGHT_INVALID_ARGUMENT),
        (patchlight_buffer { capacity: usize::MAX, ..good }, PATCHLIGHT_INVALID_ARGUMENT),
        (patchlight_buffer { capacity: 1 << 40, stride: 1 << 40, ..good }, PATCHLIGHT_INVALID_ARGUMENT),
        (patchlight_buffer { capacity: items - 1, ..good }, PATCHLIGHT_BUFFER_TOO_SMALL),
        (patchlight_buffer { data: null_mut(), capacity: 0, ..good }, PATCHLIGHT_INVALID_ARGUMENT),
    ] {
        let mut found = 0;
        // SAFETY: Buffers that are refused before they are written.
        let status = unsafe { patchlight_mesh_get_array(mesh, PATCHLIGHT_MESH_POSITIONS as u32, &bad, &mut found) };
        assert_eq!(told(status), expected, "{bad:?}");
        assert!(expected != PATCHLIGHT_BUFFER_TOO_SMALL || found == items);
    }
    // SAFETY: Buffers that live on, and a place for a count.
    unsafe {
        let wholes = patchlight_mesh_get_array(mesh, PATCHLIGHT_MESH_ELEMENT_NODES as u32, &good, null_mut());
        assert_eq!(told(wholes), PATCHLIGHT_INVALID_ARGUMENT);
        for what in [0, 6, u32::MAX] {
            assert_eq!(told(patchlight_mesh_get_array(mesh, what, &good, null_mut())), PATCHLIGHT_INVALID_ARGUMENT);
        }
        for what in [0, 6, u32::MAX] {
            assert_eq!(told(patchlight_mesh_get_figure(mesh, what, &mut 0.0)), PATCHLIGHT_INVALID_ARGUMENT);
        }
        // A point that is none, and no room for its value.
        let (at, up) = ([0.5, 0.0, 0.5, f64::NAN, 0.0, 0.0], [0.0, 1.0, 0.0]);
        let (point, none, normal) = (array(DOUBLE, &at[..3], 3), array(DOUBLE, &at[3..], 3), array(DOUBLE, &up, 3));
        let one = buffer(DOUBLE, &mut numbers[..1], 1);
        assert_eq!(told(patchlight_mesh_get_values(mesh, &none, &normal, &one, null_mut())), PATCHLIGHT_INVALID_ARGUMENT);
        let full = patchlight_buffer { capacity: 0, ..one };
        assert_eq!(told(patchlight_mesh_get_values(mesh, &point, &normal, &full, null_mut())), PATCHLIGHT_BUFFER_TOO_SMALL);
    }
    assert!(numbers.iter().all(|&number| number == -1.0));
    done(patchlight_mesh_release(mesh));
    done(patchlight_solution_release(solution));
    done(patchlight_context_release(context));
}

unsafe extern "C" fn refuse(user: *mut c_void, progress: *const patchlight_progress) -> i32 {
    // SAFETY: A place that the test below lends, and the report of the library.
    unsafe { *user.cast::<u64>() += 1 + (*progress).elements };
    1
}

#[test]
fn errors_that_cannot_be_are_refused_and_who_listens_may_cancel() {
    let context = context(1);
    let (solution, mut mesh, mut told_of) = (lit_box(context, &[]), null_mut(), 0_u64);
    // SAFETY: A place for a handle, and one that outlives the calls.
    unsafe {
        for bad in [f64::NAN, f64::INFINITY, 0.0, -0.1, 1.0] {
            assert_eq!(told(patchlight_solution_make_mesh(solution, bad, &mut mesh)), PATCHLIGHT_OUT_OF_RANGE, "{bad}");
        }
        done(patchlight_solution_set_progress(solution, Some(refuse), (&raw mut told_of).cast()));
        assert_eq!(told(patchlight_solution_make_mesh(solution, 0.5, &mut mesh)), PATCHLIGHT_CANCELLED);
    }
    assert!(mesh.is_null() && told_of > 0);
    // SAFETY: Nobody listens any more.
    done(unsafe { patchlight_solution_set_progress(solution, None, null_mut()) });
    let mesh = mesh_of(solution, 0.5);
    done(patchlight_mesh_retain(mesh));
    done(patchlight_mesh_release(mesh));
    assert!(count(mesh, PATCHLIGHT_MESH_ELEMENT_SURFACE) >= 12);
    done(patchlight_mesh_release(mesh));
    assert_eq!(told(patchlight_mesh_release(mesh)), PATCHLIGHT_INVALID_HANDLE);
    done(patchlight_solution_release(solution));
    done(patchlight_context_release(context));
}

/// A small square under a far lamp: what is asked for is below what numbers can tell, and few elements are all that may be.
#[test]
fn a_mesh_that_is_not_as_good_as_asked_for_says_so_and_is_there() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let lamp = "v -5 -5 20\nv -5 5 20\nv 5 5 20\nv 5 -5 20\nusemtl lamp\nf 5 6 7 8\n";
    let square = format!("mtllib a.mtl\nv 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\nusemtl grey\nf 1 2 3 4\n{lamp}");
    std::fs::write(path("a.obj"), square).unwrap();
    std::fs::write(path("a.mtl"), "newmtl grey\nKd 0.5 0.5 0.5\nnewmtl lamp\nKd 0 0 0\nKe 10 10 10\n").unwrap();

    let context = context(1);
    let (solution, mut mesh) = (solved(context, &path("a.obj")), null_mut());
    // SAFETY: A place for a handle.
    let status = told(unsafe { patchlight_solution_make_mesh(solution, 1e-300, &mut mesh) });
    assert!(status == PATCHLIGHT_LIMIT && message().contains("was asked for"), "{status:?}: {}", message());
    assert!(figure(mesh, PATCHLIGHT_MESH_CLAIMED) > 1e-300);
    done(patchlight_mesh_release(mesh));
    done(patchlight_solution_release(solution));
    done(patchlight_context_release(context));
}

/// The mesh that a solution has, or the status that says that it has none.
fn own(solution: *mut patchlight_solution) -> Result<*mut patchlight_mesh, patchlight_status> {
    let mut mesh = null_mut();
    // SAFETY: A place for a handle.
    let status = told(unsafe { patchlight_solution_get_mesh(solution, &mut mesh) });
    if status == PATCHLIGHT_OK { Ok(mesh) } else { Err(status) }
}

#[test]
fn a_solution_may_have_a_mesh_of_its_own_and_keeps_it_in_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = CString::new(folder.path().join("a.solution").to_str().unwrap()).unwrap();
    let context = context(1);
    let (without, with) = (lit_box(context, &[]), lit_box(context, &[("lit_mesh", "true")]));
    let (mut again, mut whole, mut of_values) = (null_mut(), -1.0, -1.0);
    let [whole_of, of_values_of] = [patchlight_figure::PATCHLIGHT_ERROR_MESH, patchlight_figure::PATCHLIGHT_ERROR_ESTIMATE];
    // SAFETY: Texts that end in a zero, places for handles and numbers.
    unsafe {
        done(patchlight_solution_get_figure(with, whole_of as u32, &mut whole));
        done(patchlight_solution_get_figure(with, of_values_of as u32, &mut of_values));
        assert_eq!(told(patchlight_solution_get_figure(without, whole_of as u32, &mut whole)), PATCHLIGHT_NOT_AVAILABLE);
        done(patchlight_solution_save(with, path.as_ptr()));
        done(patchlight_solution_load(context, path.as_ptr(), null(), &mut again));
    }
    assert_eq!(own(without), Err(PATCHLIGHT_NOT_AVAILABLE));
    let (mesh, same) = (own(with).unwrap(), own(again).unwrap());
    assert_eq!(whole, figure(mesh, PATCHLIGHT_MESH_CLAIMED).hypot(of_values));
    for what in [PATCHLIGHT_MESH_MEASURED, PATCHLIGHT_MESH_CLAIMED, PATCHLIGHT_MESH_NODE_COUNT] {
        assert_eq!(figure(mesh, what), figure(same, what));
    }
    for (what, components) in [(PATCHLIGHT_MESH_POSITIONS, 3), (PATCHLIGHT_MESH_RADIOSITY, 1)] {
        let numbers = |mesh| read::<f64>(mesh, what, DOUBLE, components);
        assert!(!numbers(mesh).is_empty() && numbers(mesh) == numbers(same));
    }
    for mesh in [mesh, same] {
        done(patchlight_mesh_release(mesh));
    }
    for solution in [without, with, again] {
        done(patchlight_solution_release(solution));
    }
    done(patchlight_context_release(context));
}
