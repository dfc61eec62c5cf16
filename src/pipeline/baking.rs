//! Lightmaps of a solution.

use rayon::prelude::*;

use super::Evaluator;
use crate::bake::{self, Aim, Asked, Atlas, BakeError, Found, Lightmap, Texels};
use crate::discontinuities;
use crate::mesh::{LitMesh, MeshReader};
use crate::progress::Observer;
use crate::scene::SurfaceId;
use crate::transmittance::Rays;

impl Evaluator {
    /// A lightmap, read off a lit mesh of this solution, or gathered where that is needed and interpolated between. `None` if the observer cancels.
    ///
    /// # Errors
    /// [`BakeError::OtherScene`] if `atlas` was made of another scene, [`BakeError::MeshIsWhole`] if it asks for what a mesh does not hold.
    pub fn bake(&self, atlas: &Atlas, mesh: Option<&LitMesh>, observer: &dyn Observer) -> Result<Option<Lightmap>, BakeError> {
        let (scene, seed) = (self.solution.scene(), self.solution.options().seed);
        if !atlas.is_of(scene) {
            return Err(BakeError::OtherScene);
        }
        if mesh.is_some() && atlas.options().separate {
            return Err(BakeError::MeshIsWhole);
        }
        let rays = Rays::new(&*self.visibility, scene);
        let stop = || observer.cancelled();
        Ok(self.pool.install(|| {
            let mut texels = bake::texels_of(atlas, scene);
            let hidden = bake::hide(scene, &mut texels, &rays, seed, &stop);
            let found = match mesh {
                Some(mesh) => {
                    read(&mut texels, &self.reader(mesh), scene, &stop);
                    None
                }
                None => Some(self.gather_texels(&mut texels, &rays, (atlas.options().separate, observer))?),
            };
            (!observer.cancelled()).then(|| bake::finish(scene, atlas, &texels, hidden, found.as_ref()))
        }))
    }

    /// Gathers texels; `None` if the observer cancels.
    fn gather_texels(
        &self,
        texels: &mut [Texels<'_>],
        rays: &Rays<'_>,
        (is_separate, observer): (bool, &dyn Observer),
    ) -> Option<Found> {
        let (scene, options) = (self.solution.scene(), self.solution.options());
        let stop = || observer.cancelled();
        let paths = self.solution.light_paths(rays, &stop);
        let gather = self.solution.gather_at_points(rays, paths.as_ref());
        let gather = if is_separate { gather.keeping_apart() } else { gather };
        let lines = discontinuities::of_shape(scene, &stop);
        let asked = Asked { gather: &gather, error_bars: self.solution.error_bars, observer };
        let aim = Aim { error: options.error, norm: options.norm.into(), seed: options.seed };
        bake::gather(scene, texels, &lines, aim, asked)
    }
}

/// Reads all texels that have no value yet off a mesh; once it is stopped, nothing more.
fn read(texels: &mut [Texels<'_>], reader: &MeshReader<'_>, scene: &crate::scene::Scene, stop: &(dyn Fn() -> bool + Sync)) {
    texels.par_iter_mut().for_each(|of_chart| {
        let wanted: Vec<usize> = (0..of_chart.sites.len()).filter(|&index| of_chart.is_wanted(index)).collect();
        let of_texel = |&index: &usize| {
            let mut reflected = vec![0.0; scene.channels()];
            if !stop() {
                reader.reflected_at(of_chart.point(scene, index), SurfaceId(of_chart.sites[index].surface), &mut reflected);
            }
            reflected.into_iter().map(|b| b as f32).collect::<Vec<f32>>()
        };
        let found: Vec<Vec<f32>> = wanted.par_iter().map(of_texel).collect();
        wanted.iter().zip(&found).for_each(|(&index, reflected)| of_chart.set(index, reflected, &[]));
    });
}
