//! The answer as a function on the surfaces.

use super::solution::Solution;
use crate::direct::{Blockers, DirectLight};
use crate::discontinuities;
use crate::mesh::{LitMesh, MeshBuilder};
use crate::progress::{Observer, Progress, Stage};
use crate::scene::SurfaceId;
use crate::transmittance::Rays;
use crate::values::{FinalGather, IndirectGather, LinkGather, RayBudget};

impl Solution {
    /// Radiosity as a function on all surfaces that reflect, off the values at points by `error` in the local norm; `None` if the observer cancels.
    ///
    /// Elements follow the lines where surfaces touch. Other discontinuities are met by refinement.
    pub(crate) fn lit_mesh(&self, rays: &Rays<'_>, error: f64, observer: &dyn Observer) -> Option<LitMesh> {
        let Self { scene, hierarchy, links, exposure, radiosity, .. } = self;
        let stop = || observer.cancelled();

        // Indirect light, as values at points gather it.
        let paths = self.light_paths(rays, &stop);
        let whole = LinkGather::new(scene, hierarchy, links, radiosity, exposure, rays);
        let indirect = match (&self.cell_radiosities, &paths) {
            (Some(radiosities), Some(paths)) => IndirectGather::Cells(FinalGather { paths, radiosities, bounces: 0 }),
            _ => IndirectGather::Links(LinkGather::of_reflected(whole)),
        };

        // Direct light.
        let all = (0..scene.surfaces().len() as u32).map(SurfaceId);
        let emitters: Vec<SurfaceId> = all.clone().filter(|&surface| scene.material_of(surface).emits()).collect();
        let blockers = Blockers::of(scene);
        let direct = DirectLight { scene, rays, blockers: &blockers, emitters: &emitters };

        let contacts = discontinuities::find(scene, &[], &|_| 0.0, &stop);
        let reflects = |surface: &SurfaceId| scene.material_of(*surface).reflectance.iter().any(|&rho| rho > 0.0);
        let surfaces: Vec<SurfaceId> = all.filter(reflects).collect();
        let tell = |elements: u64| {
            observer.progress(&Progress { stage: Stage::Sample, round: 0, fraction: None, links: 0, elements, error: None });
        };
        let budget = RayBudget::of_values(self.point_rays, self.options.seed);
        let builder =
            MeshBuilder { scene, indirect: &indirect, direct: &direct, budget, lines: &contacts, error, tell: &tell, stop: &stop };
        builder.build(&surfaces)
    }
}
