//! What refinement left out.

use super::job::Job;
use super::linked::Linked;
use super::report::SkippedWork;
use crate::links::{Dropped, Pair};
use crate::scene::SurfaceId;
use crate::transmittance::maps::Maps;

impl Linked<'_> {
    /// What refinement left out.
    pub fn skipped(&self) -> Vec<SkippedWork> {
        let work = |what: &str, count, estimate_saved_rays| SkippedWork {
            what: what.to_owned(),
            count,
            estimate_saved_rays,
            ..SkippedWork::default()
        };
        let Job { scene, options, rays, .. } = self.job;
        let Dropped { behind, black } = self.dropped;
        let asleep =
            |is_counted: &dyn Fn(&Pair) -> bool| self.links.dormant().iter().filter(|pair| is_counted(pair)).count() as u64;
        let (dark, within) = (asleep(&|pair| pair.receiver != pair.source), asleep(&|pair| pair.receiver == pair.source));
        let rays_of_pair = 2 * u64::from(options.links.rays_per_link);
        let unused = if self.clusters { 0 } else { self.hierarchy.cluster_count() as u64 };
        let is_dark = |surface: &u32| self.radiosity.of(self.hierarchy.node_of(SurfaceId(*surface))).iter().all(|&b| b == 0.0);
        let sealed = (0..scene.surfaces().len() as u32).filter(is_dark).count() as u64;
        let (spared, by_maps) = (rays.spared(), self.maps.as_ref().map_or(0, Maps::answered));
        let (everywhere, between) = if rays.is_clear_everywhere() { (spared, 0) } else { (0, spared) };
        vec![
            work("pairs behind one another", behind.pairs, behind.rays),
            work("pairs with a black receiver", black.pairs, black.rays),
            work("dormant pairs with a dark source, or for which there was no room", dark, rays_of_pair * dark),
            work("dormant pairs of a cluster with itself", within, rays_of_pair * within),
            work("surfaces that no light reaches", sealed, 0),
            work("clusters that are not linked", unused, 0),
            work("segments that transmittance maps answered, for the time that these take", by_maps, 0),
            work("segments in a scene where nothing occludes", everywhere, everywhere),
            work("segments between planes with nothing in between", between, between),
        ]
    }
}
