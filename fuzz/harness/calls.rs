//! Sequences of calls of the C interface that are made of bytes.
//!
//! Whatever is called in whatever order, with handles that live, are gone, or never were, and numbers of any kind: each call gives a status
//! from the header, and a message if and only if it is not `PATCHLIGHT_OK`; no other memory is touched.

use std::ffi::{CStr, c_void};
use std::ptr::{null, null_mut};

use patchlight_capi::patchlight_status::{self, *};
use patchlight_capi::*;

/// So that one input takes milliseconds.
const MOST_CALLS: usize = 40;
const MOST_SOLVES: usize = 3;
const MOST_MESHES: usize = 3;

/// Bytes, taken one by one; 0 when they are used up.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn next(&mut self) -> u8 {
        let Some((&first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        first
    }

    fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.next() as usize % choices.len()]
    }

    fn number(&mut self) -> f64 {
        self.pick(&[0.0, 0.5, 1.0, 0.25, 0.75, 1e-3, -1.0, 2.0, f64::NAN, f64::INFINITY, 1e300, 1e-300])
    }
}

/// Handles of all kinds that were made so far; those that were let go stay among them.
struct World {
    contexts: Vec<*mut patchlight_context>,
    options: Vec<*mut patchlight_options>,
    scenes: Vec<*mut patchlight_scene>,
    solutions: Vec<*mut patchlight_solution>,
    meshes: Vec<*mut patchlight_mesh>,
    solves: usize,
}

fn any<H>(handles: &[*mut H], bytes: &mut Bytes<'_>) -> *mut H {
    match bytes.next() as usize {
        0 => null_mut(),
        1 => 48 as *mut H,
        choice => handles.get(choice % handles.len().max(1)).copied().unwrap_or(null_mut()),
    }
}

fn check(status: patchlight_status) -> bool {
    let mut message = null();
    // SAFETY: A place for a pointer; the text lives until the next call.
    let text = unsafe {
        assert_eq!(patchlight_get_message(&mut message), PATCHLIGHT_OK);
        CStr::from_ptr(message).to_str().expect("messages are UTF-8")
    };
    assert!(status != PATCHLIGHT_INTERNAL_ERROR, "{text}");
    assert_eq!(text.is_empty(), status == PATCHLIGHT_OK, "{status:?}: {text}");
    (status as i32) < PATCHLIGHT_INVALID_ARGUMENT as i32
}

fn array<T>(format: patchlight_format, data: &[T], components: usize, bytes: &mut Bytes<'_>) -> patchlight_array {
    let size = size_of::<patchlight_array>();
    let array =
        patchlight_array { size, format: format as u32, data: data.as_ptr().cast(), count: data.len() / components, stride: 0 };
    // What is wrong must be found before anything is read.
    match bytes.next() {
        0 => patchlight_array { format: 77, ..array },
        1 => patchlight_array { count: usize::MAX, ..array },
        2 => patchlight_array { data: null(), ..array },
        3 => patchlight_array { stride: 1, ..array },
        4 => patchlight_array { size: 3, ..array },
        _ => array,
    }
}

unsafe extern "C" fn listen(user: *mut c_void, progress: *const patchlight_progress) -> i32 {
    // SAFETY: The report of the library, which lives until this returns.
    let stage = unsafe { (*progress).stage };
    i32::from(user.is_null() && stage == patchlight_stage::PATCHLIGHT_STAGE_ERROR as u32)
}

/// Cancels when it has been asked so often.
unsafe extern "C" fn lose_patience(user: *mut c_void, _: *const patchlight_progress) -> i32 {
    // SAFETY: A number that `make_mesh` lends, of one thread at a time.
    let patience = unsafe { &mut *user.cast::<u32>() };
    *patience = patience.saturating_sub(1);
    i32::from(*patience == 0)
}

unsafe extern "C" fn refuse(user: *mut c_void, bytes: u64) -> i32 {
    i32::from(user.is_null() && bytes > 25_000_000)
}

/// Plays the calls that the bytes stand for, and lets all handles go. Tells how many solves there were, and meshes.
pub fn play(bytes: &[u8]) -> [usize; 2] {
    let mut bytes = Bytes(bytes);
    let (contexts, options, scenes) = (Vec::new(), Vec::new(), Vec::new());
    let mut world = World { contexts, options, scenes, solutions: Vec::new(), meshes: Vec::new(), solves: 0 };
    for _ in 0..MOST_CALLS {
        if bytes.0.is_empty() {
            break;
        }
        match bytes.next() % 11 {
            0 => world.make(&mut bytes),
            1 => world.set(&mut bytes),
            2 | 3 => world.add(&mut bytes),
            4 => drop(check(patchlight_scene_commit(any(&world.scenes, &mut bytes)))),
            5 => world.solve(&mut bytes),
            6 => world.read(&mut bytes),
            7 => world.count(&mut bytes),
            8 => world.make_mesh(&mut bytes),
            9 => world.relight(&mut bytes),
            _ => world.read_mesh(&mut bytes),
        }
    }
    let made = [world.solves, world.meshes.len()];
    world.end();
    made
}

impl World {
    fn make(&mut self, bytes: &mut Bytes<'_>) {
        let (mut context, mut options, mut scene) = (null_mut(), null_mut(), null_mut());
        // SAFETY: Places for handles.
        unsafe {
            match bytes.next() % 4 {
                0 if check(patchlight_context_create(1, &mut context)) => self.contexts.push(context),
                1 if check(patchlight_context_create_sharing(any(&self.contexts, bytes), &mut context)) => {
                    self.contexts.push(context)
                }
                2 if check(patchlight_options_create(&mut options)) => self.options.push(options),
                3 => {
                    let (channels, sides) = (bytes.pick(&[1, 1, 1, 2, 3, 0, 2000]), bytes.pick(&[0, 0, 1, 9]));
                    if check(patchlight_scene_create(any(&self.contexts, bytes), channels, sides, &mut scene)) {
                        self.scenes.push(scene);
                    }
                }
                _ => {}
            }
        }
    }

    fn set(&mut self, bytes: &mut Bytes<'_>) {
        let options = any(&self.options, bytes);
        let keys = [c"error", c"seed", c"solver", c"time", c"memory", c"bounds", c"ambient", c"backend", c"nothing", c"max_links"];
        let values = [c"0.5", c"1", c"links", c"cells", c"guaranteed", c"true", c"obvhs", c"", c"-1", c"\xff"];
        let (key, value) = (bytes.pick(&keys).as_ptr(), bytes.pick(&values).as_ptr());
        // SAFETY: Texts that end in a zero.
        unsafe {
            check(match bytes.next() % 5 {
                0 => patchlight_options_set_double(options, key, bytes.number()),
                1 => patchlight_options_set_uint64(options, key, u64::from(bytes.next())),
                2 => patchlight_options_set_bool(options, key, i32::from(bytes.next())),
                3 => patchlight_options_reset(options, key),
                _ => patchlight_options_set_text(options, key, value),
            });
        }
    }

    fn add(&mut self, bytes: &mut Bytes<'_>) {
        let scene = any(&self.scenes, bytes);
        // SAFETY: Arrays that live on; those that are wrong are refused before they are read. Three numbers an item are there for three channels.
        unsafe {
            check(match bytes.next() % 3 {
                0 => {
                    let numbers: Vec<f64> = (0..12).map(|_| bytes.number()).collect();
                    patchlight_scene_add_vertices(scene, &array(patchlight_format::PATCHLIGHT_DOUBLE, &numbers, 3, bytes))
                }
                1 => {
                    let (rho, e) = ([0.5, bytes.number(), 0.1, 0.2, 0.3, 0.4], [bytes.number(), 1.0, 0.0, 0.0, 2.0, 1.0]);
                    let rho = array(patchlight_format::PATCHLIGHT_DOUBLE, &rho, 3, bytes);
                    patchlight_scene_add_materials(scene, &rho, &array(patchlight_format::PATCHLIGHT_DOUBLE, &e, 3, bytes))
                }
                _ => {
                    let corners: Vec<u32> = (0..12).map(|_| u32::from(bytes.next() % 9)).collect();
                    let (counts, materials) = ([4_u32, 3, 5], [0_u32, 1, 0]);
                    let corners = array(patchlight_format::PATCHLIGHT_UINT32, &corners, 1, bytes);
                    let counts = array(patchlight_format::PATCHLIGHT_UINT32, &counts, 1, bytes);
                    let materials = array(patchlight_format::PATCHLIGHT_UINT32, &materials, 1, bytes);
                    let optional = |array: &patchlight_array, is_there: bool| if is_there { &raw const *array } else { null() };
                    let (with_counts, with_materials) = (bytes.next() > 127, bytes.next() > 127);
                    patchlight_scene_add_faces(
                        scene,
                        &corners,
                        optional(&counts, with_counts),
                        optional(&materials, with_materials),
                    )
                }
            });
        }
    }

    fn solve(&mut self, bytes: &mut Bytes<'_>) {
        if self.solves >= MOST_SOLVES {
            return;
        }
        let mut limited = null_mut();
        let mut solution = null_mut();
        // SAFETY: Places for handles, texts that end in a zero, a struct with its size.
        unsafe {
            // Without a limit an input might take seconds.
            check(patchlight_options_create(&mut limited));
            for (key, value) in [(c"error", c"0.9"), (c"time", c"0.05"), (c"max_links", c"200"), (c"backend", c"obvhs")] {
                check(patchlight_options_set_text(limited, key.as_ptr(), value.as_ptr()));
            }
            let size = bytes.pick(&[size_of::<patchlight_solve_info>(), size_of::<patchlight_solve_info>(), 16, 0]);
            let user = bytes.pick(&[null_mut(), std::ptr::dangling_mut::<c_void>()]);
            let (progress_user, memory_user) = (user, user);
            let (progress, memory) = (Some(listen as _), bytes.pick(&[None, Some(refuse as _)]));
            let info =
                patchlight_solve_info { size, options: limited, progress, progress_user, visibility: null(), memory, memory_user };
            if check(patchlight_solve(any(&self.contexts, bytes), any(&self.scenes, bytes), &info, &mut solution)) {
                self.solves += 1;
                self.solutions.push(solution);
            }
            check(patchlight_options_release(limited));
        }
    }

    fn read(&mut self, bytes: &mut Bytes<'_>) {
        let solution = any(&self.solutions, bytes);
        let (items, what, mut count) = (u32::from(bytes.next() % 6), u32::from(bytes.next() % 24), 0);
        let capacity = usize::from(bytes.next());
        let (mut wholes, mut reals, mut floats) = (vec![0_u32; capacity], vec![0.0_f64; capacity], vec![0.0_f32; capacity]);
        let point = [bytes.number(), bytes.number(), bytes.number(), 0.0, 0.0, bytes.pick(&[1.0, -1.0, 2.0])];
        // SAFETY: Buffers of the capacity that is told, arrays and structs that live on.
        unsafe {
            check(match bytes.next() % 5 {
                0 => patchlight_solution_get_uint32(solution, items, what, wholes.as_mut_ptr(), capacity, &mut count),
                1 => patchlight_solution_get_double(solution, items, what, reals.as_mut_ptr(), capacity, &mut count),
                2 => patchlight_solution_get_figure(solution, 95 + what, &mut 0.0),
                3 => {
                    let position = array(patchlight_format::PATCHLIGHT_DOUBLE, &point[..3], 3, bytes);
                    let normal = array(patchlight_format::PATCHLIGHT_DOUBLE, &point[3..], 3, bytes);
                    let (size, radiosity, lower) = (size_of::<patchlight_values>(), floats.as_mut_ptr(), null_mut());
                    let values = patchlight_values { size, capacity, radiosity, standard_error: null_mut(), lower, upper: lower };
                    patchlight_solution_get_values(solution, &position, &normal, &values, &mut count)
                }
                _ => {
                    let size = size_of::<patchlight_camera>();
                    let (width, height) = (bytes.pick(&[4, 0, 1]), bytes.pick(&[3, 1, u32::MAX]));
                    let (eye, target) = ([bytes.number(); 3], [0.5, 0.5, bytes.number()]);
                    let camera = patchlight_camera { size, width, height, eye, target, up: [0.0, 1.0, 0.0], field_of_view: 45.0 };
                    patchlight_solution_get_picture(solution, &camera, floats.as_mut_ptr(), null_mut(), capacity, &mut count)
                }
            });
        }
    }

    fn relight(&mut self, bytes: &mut Bytes<'_>) {
        let (scene, solution, mut relit, mut count) = (any(&self.scenes, bytes), any(&self.solutions, bytes), null_mut(), 0);
        let numbers: Vec<f64> = (0..12).map(|_| bytes.number()).collect();
        let array = array(patchlight_format::PATCHLIGHT_DOUBLE, &numbers, 3, bytes);
        let (group, lights) =
            (bytes.pick(&[c"a", c"b", c"", c"\xff"]), bytes.pick(&[c"material material 1", c"light a", c"a", c""]));
        // SAFETY: Texts that end in a zero, places for handles and counts; three numbers an item are there for three channels.
        unsafe {
            check(match bytes.next() % 6 {
                0 => patchlight_scene_group_lights(scene, u32::from(bytes.next() % 4)),
                1 => patchlight_scene_add_to_light_group(scene, group.as_ptr(), lights.as_ptr()),
                2 => patchlight_solution_light_group_count(solution, &mut count),
                3 => patchlight_solution_light_group_name(solution, usize::from(bytes.next() % 3), null_mut(), 0, &mut count),
                4 => patchlight_solution_with_materials(solution, &array, null(), bytes.number(), &mut relit),
                _ => patchlight_solution_relight(solution, &array, &mut relit),
            });
        }
        if !relit.is_null() {
            self.solutions.push(relit);
        }
    }

    fn make_mesh(&mut self, bytes: &mut Bytes<'_>) {
        if self.meshes.len() >= MOST_MESHES {
            return;
        }
        let solution = any(&self.solutions, bytes);
        let error = bytes.pick(&[0.5, 0.9, 0.2, 0.05, 0.0, -1.0, 1.0, f64::NAN, f64::INFINITY]);
        let (mut mesh, mut patience) = (null_mut(), bytes.pick(&[60_u32, 20, 2, 1]));
        // SAFETY: A place for a handle, and a number that outlives its use: nobody listens afterwards.
        unsafe {
            // Without a limit an input might take minutes.
            check(patchlight_solution_set_progress(solution, Some(lose_patience), (&raw mut patience).cast()));
            if check(patchlight_solution_make_mesh(solution, error, &mut mesh)) && !mesh.is_null() {
                self.meshes.push(mesh);
            }
            check(patchlight_solution_set_progress(solution, None, null_mut()));
        }
    }

    fn read_mesh(&mut self, bytes: &mut Bytes<'_>) {
        let (mesh, what, mut count) = (any(&self.meshes, bytes), u32::from(bytes.next() % 7), 0);
        let (capacity, format) = (usize::from(bytes.next()) * 8, u32::from(bytes.next() % 6));
        // Up to three channels and six nodes of eight bytes fit in each stride.
        let stride = bytes.pick(&[48, 0, 49, 64, 3]);
        let mut room = vec![0_u8; capacity * 64];
        let size = bytes.pick(&[size_of::<patchlight_buffer>(), size_of::<patchlight_buffer>(), 8, 0]);
        let data = if bytes.next() == 0 { null_mut() } else { room.as_mut_ptr().cast() };
        let buffer = patchlight_buffer { size, format, data, capacity, stride };
        let point = [bytes.number(), bytes.number(), bytes.number(), 0.0, 0.0, bytes.pick(&[1.0, -1.0, 2.0])];
        // SAFETY: A buffer with more room than is told, arrays and structs that live on.
        unsafe {
            check(match bytes.next() % 4 {
                0 => patchlight_mesh_get_array(mesh, what, &buffer, &mut count),
                1 => patchlight_mesh_get_figure(mesh, what, &mut 0.0),
                2 => {
                    let position = array(patchlight_format::PATCHLIGHT_DOUBLE, &point[..3], 3, bytes);
                    let normal = array(patchlight_format::PATCHLIGHT_DOUBLE, &point[3..], 3, bytes);
                    patchlight_mesh_get_values(mesh, &position, &normal, &buffer, &mut count)
                }
                _ => {
                    let (size, eye) = (size_of::<patchlight_camera>(), [bytes.number(); 3]);
                    let (target, up) = ([0.5, 0.5, bytes.number()], [0.0, 1.0, 0.0]);
                    let camera = patchlight_camera { size, width: 4, height: 3, eye, target, up, field_of_view: 45.0 };
                    let mut floats = vec![0.0_f32; capacity];
                    patchlight_mesh_get_picture(mesh, &camera, floats.as_mut_ptr(), capacity, &mut count)
                }
            });
        }
    }

    /// Lets go, or holds on once more and lets go.
    fn count(&mut self, bytes: &mut Bytes<'_>) {
        let (context, options) = (any(&self.contexts, bytes), any(&self.options, bytes));
        let (scene, solution, mesh) = (any(&self.scenes, bytes), any(&self.solutions, bytes), any(&self.meshes, bytes));
        match bytes.next() % 7 {
            0 => check(patchlight_context_release(context)),
            1 => check(patchlight_options_release(options)),
            2 => check(patchlight_scene_release(scene)),
            3 => check(patchlight_solution_release(solution)),
            4 => check(patchlight_mesh_release(mesh)),
            5 => check(patchlight_mesh_retain(mesh)) && check(patchlight_mesh_release(mesh)),
            _ => check(patchlight_scene_retain(scene)) && check(patchlight_scene_release(scene)),
        };
    }

    /// Lets all go, as often as it takes.
    fn end(self) {
        self.meshes.into_iter().for_each(|handle| while check(patchlight_mesh_release(handle)) {});
        self.solutions.into_iter().for_each(|handle| while check(patchlight_solution_release(handle)) {});
        self.scenes.into_iter().for_each(|handle| while check(patchlight_scene_release(handle)) {});
        self.options.into_iter().for_each(|handle| while check(patchlight_options_release(handle)) {});
        self.contexts.into_iter().for_each(|handle| while check(patchlight_context_release(handle)) {});
    }
}
