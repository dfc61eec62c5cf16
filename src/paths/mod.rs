//! Light by rays: paths, and next-event estimation from emitters, bright reflectors and bright spots. No link is known here.
//!
//! Start with `trace`: how a path goes on, and where it ends; `first_rays` is how it begins, `guide` where rays go. Paths end in the cells of
//! `grid`. `emitters`, `reflectors` and `spots` say what is sampled by next-event estimation; `next_event` and `reflector_rays` how, both by draws from a `light_tree` of `light_node`s.

mod around;
mod batch_sums;
mod course;
mod direct_sums;
mod emission;
mod emitters;
mod ends;
mod first_rays;
mod grid;
mod grids;
mod guide;
mod light_node;
mod light_tree;
mod next_event;
mod open_parts;
mod particles;
mod place;
mod recorded;
mod reflector_rays;
mod reflectors;
mod source_group;
mod spots;
mod terms;
mod trace;
mod trail;

pub(crate) use batch_sums::{BATCHES, BatchSums};
pub(crate) use course::Course;
pub(crate) use ends::{Continuation, Ends, NO_SURFACE, SeenOnTheWay, ValueEnd};
pub(crate) use grid::Grid;
pub(crate) use grids::{CellSize, NO_CELL, Resolution, cell_count};
pub(crate) use particles::{Illumination, Landing};
pub(crate) use place::{Directions, Place, Receives, place_at};
pub(crate) use recorded::{Brought, PathTerm};
pub(crate) use reflector_rays::SeenCell;
pub(crate) use reflectors::Brightness;
#[cfg(test)]
pub(crate) use reflectors::Reflector;
pub(crate) use spots::Spot;
pub(crate) use terms::{RowTerm, Terms};
pub(crate) use trace::{LightPaths, PathScratch};
pub(crate) use trail::{ProductNumbers, Products, Trail, UNREFLECTED};
