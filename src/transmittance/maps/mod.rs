//! Transmittance maps: what clusters let through, by cells of lines, beside rays.
//!
//! Soler and Sillion 1996 store what a cluster lets through as a function of direction, in two dimensions, and open clusters of which that is not
//! good enough for a link. Here it is in three. A map has cells of lines through its cluster, by direction and by offset, since a beam between two nodes
//! rarely meets a cluster as a whole, and a mean over its whole shadow is wrong by a quarter (`beam`, at several resolutions of offsets).
//!
//! **A pair of nodes** asks with the segments that it would cast as rays ([`Maps::estimate`]). Each goes down the clusters: those between its ends whose
//! error is at most what the pair may have are taken as a whole, others are opened, surfaces are tested. Errors are handed down: what one cluster
//! does not use, the next may.
//!
//! **The error of a cluster** is an estimate, of three parts. With m the blocked part of its cell,
//!
//! ```text
//! m (1 - m) patch / section                       a beam as thin as a leaf is blocked or is not; a wide one meets many (k of them: 1/k)
//! (most - least)^2 / 12 min(1, (cell / beam)^3)   what varies from cell to cell varies within them too, and they blur the edges of the beam
//! m' (1 - m') / samples / cells                   noise of the map, where nothing is proved; m' = (1 + hits) / (2 + samples), as none is no proof
//! ```
//!
//! as variances, with `patch` the mean area of a leaf and `section` that of the beam where it passes the cluster, `cell` and `beam` how wide these are, and
//! `cells` how many of them lines fall into. Opening a cluster lessens the last two, not the first: where that alone is too large,
//! rays answer the pair. So they do near the ends, where beams are thin.
//!
//! **Bounds** rest on proofs alone ([`Maps::bound_passing`]): that no line of a cell is blocked, or that each is. In foliage cells without either are most,
//! but for clusters that are small against their leaves; there surfaces are looked at one by one. Of clusters one behind another, with blocked
//! parts in `[l, h]`, at least the largest l and at most the sum of all h is blocked (Frechet).
//!
//! Clusters one behind another are independent, line by line: their transmittances are multiplied. That is finer than the correlation of parents' means
//! (chi in the paper): a line meets the same cells of both.
//!
//! Beams are made when a line asks for them first, of the cluster's surfaces alone, with random numbers of their own: so neither threads nor order
//! change a bit.

mod beam;
mod bound;
mod cluster_map;
mod contents;
mod estimate;
mod frame;
mod line;
mod proof;

pub use cluster_map::MapResolution;
pub use estimate::{MapOptions, Maps};
