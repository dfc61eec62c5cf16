//! Visibility at many resolutions (Soler, Sillion 1996): links whose transmittance comes from maps of clusters, where these are as good as was asked for.
//!
//! The paper has form factors through clusters to a requested error, in two dimensions, and leaves refinement to others. So links are refined here as in
//! [`Strategy::Hanrahan91`], and what is asked of rays there is asked of maps first ([`maps`](crate::transmittance::maps)). Rays answer where maps
//! cannot: near the ends, behind large surfaces, and where beams are as thin as leaves.
//!
//! Values at points, and leaves that are gathered anew, see by rays: a point has no beam that is wide enough.

use super::job::Job;
use super::options::{SolveOptions, Strategy};
use crate::geometry::{sampling, streams};
use crate::hierarchy::Hierarchy;
use crate::links::MapsOfLinks;
use crate::transmittance::maps::{MapOptions, MapResolution, Maps};

/// The maps of a solve; nothing for other strategies, and where no cluster is dense.
pub(super) fn maps<'a>(job: &Job<'a>, hierarchy: &Hierarchy) -> Option<Maps<'a>> {
    let options = &job.options.multiresolution96;
    let map_options = MapOptions {
        resolution: MapResolution::default(),
        memory_bytes: options.map_memory,
        seed: sampling::hash(job.options.seed, streams::MAPS),
    };
    let is_wanted = job.options.strategy == Strategy::Multiresolution96 && options.transmittance_tolerance > 0.0;
    is_wanted.then(|| Maps::new(job.scene, hierarchy, &map_options)).filter(|maps| !maps.is_empty())
}

/// What links ask before rays, with the error that they may have.
pub(super) fn of_links<'a>(maps: Option<&'a Maps<'a>>, options: &SolveOptions) -> Option<MapsOfLinks<'a>> {
    maps.map(|maps| MapsOfLinks { maps, tolerance: options.multiresolution96.transmittance_tolerance })
}
