//! Files: reads results, computes nothing.
//!
//! Every file states quantity, unit, version and options ([`Provenance`]) as far as its format has room for it. The same result
//! gives the same bytes; what belongs to the run alone (threads, times, paths) is in the [report](RunReport) and nowhere else.
//!
//! Encoders write to any [`std::io::Write`]; [`Destination`] replaces a file only by a complete one.
//!
//! | file | written by | holds |
//! |---|---|---|
//! | `.exr` | [`write_exr`] | linear radiance or radiosity, 32-bit float |
//! | `.hdr` | [`write_hdr`] | the same in Radiance's format, within half a percent of the largest channel |
//! | `.png` | [`write_png`], [`write_display`] | an exposed, tone-mapped picture for display, or false colours with a legend |
//! | `.png` | [`write_keyed_png`] | a picture in colours, with a key that says what they mean |
//! | `.ply` | [`write_mesh_ply`] | the lit mesh with float radiosities at its nodes |
//! | `.ply` | [`write_ply`] | the leaves of the hierarchy with float radiosities |
//! | `.glb`, `.vtp` | [`export_mesh`], [`export_elements`] | the same for viewers and for ParaView |
//! | solution | [`write_solution`] | everything, to be read back by [`read_solution`] |
//! | bake | [`write_bake_record`] | what a later bake of a changed scene takes, to be read back by [`read_bake_record`] |
//! | `.csv` | [`write_values`] | radiosities at the points that [`read_points`] read |
//! | `.csv` | [`write_irradiances`] | irradiances and illuminances at sensors |
//! | `.csv` | [`write_fluxes`] | emitted, incident, absorbed and net power by face, object, group and material |
//! | `.html` | [`write_page`] | the lit scene in 3D, and what is known of it, in a page that loads nothing |
//! | `.ply`, `.glb`, `.vtp` | [`export_vertex_light`] | light at the vertices of faces |
//! | `.png` | [`write_lightmap_png`] | a page of a lightmap in sRGB or RGBM |
//! | `.glb` | [`write_lightmap_glb`] | the scene with its lightmap |
//! | `.json` | [`write_lightmap_json`] | where faces lie on a lightmap |
//! | `.json` | [`write_report`] | what the run tells about itself |
//! | `.png` | [`write_plot`] | the same as plots: error against time, where time went, and light |

mod atomic;
pub mod bake_file;
mod export;
pub mod exr;
pub mod false_colours;
pub mod flux;
mod format;
mod framed;
mod glb;
mod glyphs;
mod hdr;
pub mod irradiances;
mod keyed_png;
mod legend;
pub mod lightmap_glb;
pub mod lightmap_json;
pub mod lightmap_png;
pub mod measured_plane;
pub mod mesh_ply;
#[cfg(feature = "openexr")]
pub mod openexr;
mod origin;
pub mod page;
mod patches;
pub mod plots;
mod ply;
pub mod png;
pub mod points;
mod provenance;
pub mod report;
pub mod solution_file;
mod srgb;
pub mod values;
mod vertex_ply;
mod vtp;

pub use atomic::{Destination, DestinationError};
pub use bake_file::{BakeFileError, read_bake_record, write_bake_record};
pub use export::{export_elements, export_mesh, export_vertex_light};
pub use exr::{write_exr, write_exr_layers};
pub use false_colours::{Scale, ScaleError};
pub use flux::write_fluxes;
pub use format::{ExportFormat, ImageFormat, UnknownExtension};
pub use hdr::write_hdr;
pub use irradiances::{Illuminances, write_irradiances};
pub use keyed_png::{KeyLine, write_keyed_png};
pub use legend::LEAST_SIZE_WITH_LEGEND;
pub use lightmap_glb::write_lightmap_glb;
pub use lightmap_json::write_lightmap_json;
pub use lightmap_png::{LightmapCode, write_lightmap_png};
pub use measured_plane::{MeasuredPlane, ShownPlane};
pub use mesh_ply::{write_mesh_ply, write_quadratic_mesh_ply};
#[cfg(feature = "openexr")]
pub use openexr::{write_openexr, write_openexr_layers};
pub use page::{Page, write_page};
pub use plots::{Plot, write_plot};
pub use ply::write_ply;
pub use png::{Display, Look, PngExposure, auto_exposure, write_display, write_png};
pub use points::{Points, PointsError, read_points};
pub use provenance::{LUMENS_PER_WATT, Provenance, Quantity};
pub use report::{
    CpuReport, ErrorFigures, MemoryReport, REPORT_SCHEMA, RunReport, SceneReport, Timing, write_error, write_light_groups,
    write_report,
};
pub use solution_file::{
    SOLUTION_FORMAT_VERSION, SolutionFileError, is_solution_file, read_solution, read_solution_from, write_solution,
};
pub use values::{write_bounded_values, write_values};
