//! Hierarchical radiosity for polygonal scenes: view-independent diffuse global illumination, with an error figure.
//!
//! Patchlight solves the radiosity equation
//!
//! ```text
//! B(x) = E(x) + rho(x) * Integral k(x, y) V(x, y) B(y) dy,      k = cos_x cos_y / (pi |x - y|^2)
//! ```
//!
//! over planar polygons. ARCHITECTURE.md draws the layers; each module imports only from modules above it in the list below.
#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod bake;
pub mod bounds;
mod cells;
pub mod direct;
pub mod discontinuities;
mod error;
pub mod flatland;
pub mod form_factor;
pub mod geometry;
pub mod hierarchy;
pub mod inspect;
pub mod links;
pub mod mesh;
pub mod output;
mod paths;
pub mod picture;
pub mod pipeline;
pub mod progress;
pub mod scene;
pub mod solve;
pub mod sweep;
pub mod team;
pub mod transmittance;
pub mod values;
pub mod visibility;

/// The examples of README.md, compiled.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
