//! The second solver's radiosities: one for each cell, from random light paths, as a sparse system that is iterated until it stands
//! still (stochastic Jacobi radiosity).
//!
//! Start with `radiosity`: what is solved. `assemble` makes the equations from paths, `equations` holds them, `iteration` solves
//! them. `stored_rows` keeps them for other materials, and `stored_system` is what becomes of them with some.

mod assemble;
mod equations;
mod iteration;
mod positions;
mod radiosity;
mod solved;
mod stored_rows;
mod stored_system;
mod view_points;

pub(crate) use radiosity::CellRadiosities;
pub(crate) use solved::SolvedCells;
pub(crate) use stored_rows::{RowMaterials, StoredRows};
