//! libpatchlight: the C interface of Patchlight.
//!
//! Thin: values of C become a validated request, and that becomes calls of the Rust library. `include/patchlight.h` is made from these
//! sources by cbindgen, and `docs/c.md` says how it is used. Where to begin: `entry` is what every function does around its body,
//! `handles` what a handle is, `memory` how memory of the caller's is read and written; then a file for each object.
#![allow(non_camel_case_types, reason = "types have the names that they have in C")]
#![allow(clippy::missing_safety_doc, reason = "what callers promise stands once, at the head of the header")]

mod array;
mod context;
mod entry;
mod float_state;
mod handles;
mod memory;
mod mesh;
mod observer;
mod options;
mod scene;
mod solution;
mod solve;
mod status;
mod target;
mod version;
mod visibility;

// What programs call, object by object.
pub use array::{patchlight_array, patchlight_format};
pub use context::{
    patchlight_context, patchlight_context_create, patchlight_context_create_sharing, patchlight_context_release,
    patchlight_context_retain, patchlight_context_set_log, patchlight_context_threads, patchlight_log_function,
    patchlight_log_level,
};
pub use mesh::files::{patchlight_mesh_export, patchlight_mesh_get_picture, patchlight_mesh_write_picture};
pub use mesh::read::{patchlight_mesh_array, patchlight_mesh_get_array, patchlight_mesh_get_values};
pub use mesh::{
    patchlight_mesh, patchlight_mesh_figure, patchlight_mesh_get_figure, patchlight_mesh_release, patchlight_mesh_retain,
    patchlight_solution_get_mesh, patchlight_solution_make_mesh,
};
pub use observer::{patchlight_memory_function, patchlight_progress, patchlight_progress_function, patchlight_stage};
pub use options::{
    patchlight_option_count, patchlight_option_get_text, patchlight_option_get_type, patchlight_option_text,
    patchlight_option_type, patchlight_options, patchlight_options_create, patchlight_options_get_text, patchlight_options_release,
    patchlight_options_reset, patchlight_options_retain, patchlight_options_set_bool, patchlight_options_set_double,
    patchlight_options_set_text, patchlight_options_set_uint64,
};
pub use scene::diagnostics::{
    PATCHLIGHT_NONE, patchlight_diagnostic, patchlight_diagnostic_code, patchlight_scene_diagnostic,
    patchlight_scene_diagnostic_count, patchlight_scene_diagnostic_text, patchlight_severity,
};
pub use scene::light_groups::{patchlight_light_grouping, patchlight_scene_add_to_light_group, patchlight_scene_group_lights};
pub use scene::read::{
    patchlight_scene_figure, patchlight_scene_get_figure, patchlight_scene_triangle_planes, patchlight_scene_triangles,
};
pub use scene::{
    patchlight_file_flags, patchlight_scene, patchlight_scene_add_faces, patchlight_scene_add_file, patchlight_scene_add_lights,
    patchlight_scene_add_materials, patchlight_scene_add_vertices, patchlight_scene_commit, patchlight_scene_create,
    patchlight_scene_release, patchlight_scene_retain, patchlight_sides,
};
pub use solution::files::{patchlight_solution_export, patchlight_solution_load, patchlight_solution_save};
pub use solution::picture::{
    patchlight_camera, patchlight_solution_get_camera, patchlight_solution_get_picture, patchlight_solution_write_picture,
};
pub use solution::read::{
    patchlight_figure, patchlight_items, patchlight_real, patchlight_solution_count, patchlight_solution_get_double,
    patchlight_solution_get_figure, patchlight_solution_get_report, patchlight_solution_get_uint32, patchlight_whole,
};
pub use solution::relight::{
    patchlight_solution_light_group_count, patchlight_solution_light_group_name, patchlight_solution_relight,
    patchlight_solution_with_materials,
};
pub use solution::values::{patchlight_solution_get_values, patchlight_values};
pub use solution::{
    patchlight_solution, patchlight_solution_get_status, patchlight_solution_release, patchlight_solution_retain,
    patchlight_solution_set_progress,
};
pub use solve::{patchlight_solve, patchlight_solve_info};
pub use status::patchlight_status;
pub use target::patchlight_buffer;
pub use version::{
    PATCHLIGHT_VERSION_MAJOR, PATCHLIGHT_VERSION_MINOR, PATCHLIGHT_VERSION_PATCH, patchlight_get_message, patchlight_get_version,
};
pub use visibility::{
    PATCHLIGHT_NO_SURFACE, patchlight_first_hits_function, patchlight_hit, patchlight_occluded_function, patchlight_ray,
    patchlight_release_function, patchlight_segment, patchlight_visibility,
};
