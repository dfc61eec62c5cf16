//! Lightmaps of a solution.

use std::time::{Duration, Instant};

use glam::DVec3;
use rayon::prelude::*;

use super::Evaluator;
use crate::bake::{self, Aim, Asked, Atlas, BakeError, BakeRecord, Base, Found, Lightmap, NotFound, Terms, Texels};
use crate::discontinuities;
use crate::mesh::{LitMesh, MeshReader};
use crate::progress::{Observer, Stop};
use crate::scene::{Scene, SurfaceId};
use crate::solve::{self, Norm};
use crate::transmittance::Rays;
use crate::visibility::Backend;

/// How texels are found.
#[derive(Clone, Copy)]
enum Way<'a> {
    /// Off a lit mesh.
    Read(&'a LitMesh),
    /// By rays, perhaps after an earlier bake.
    Gather(Option<&'a BakeRecord>),
}

impl Evaluator {
    /// A lightmap, read off a lit mesh of this solution, or gathered where that is needed and interpolated between. `None` if the observer cancels.
    ///
    /// # Errors
    /// [`BakeError::OtherScene`] if `atlas` was made of another scene, [`BakeError::MeshIsWhole`] if it asks for what a mesh does not hold.
    pub fn bake(&self, atlas: &Atlas, mesh: Option<&LitMesh>, observer: &dyn Observer) -> Result<Option<Lightmap>, BakeError> {
        self.bake_within(atlas, mesh, None, observer)
    }

    /// The same of a scene that was baked before and changed since, here and there: the `earlier` light of texels is kept where it changed by what few gathers
    /// tell, and how far it is off is measured; the [report](bake::BakeReport) tells both. What is changed may be anything: lights, materials, surfaces.
    ///
    /// # Errors
    /// [`BakeError::Earlier`] if the earlier bake is of another scene, or was made on other terms; else as [`Evaluator::bake`].
    pub fn bake_since(
        &self,
        atlas: &Atlas,
        earlier: &BakeRecord,
        time_s: Option<f64>,
        observer: &dyn Observer,
    ) -> Result<Option<Lightmap>, BakeError> {
        self.bake_of(atlas, Way::Gather(Some(earlier)), time_s, observer)
    }

    /// Like [`Evaluator::bake`], in so many seconds: what is not found by then is interpolated from what there is, filled from beside it, or, where nothing is known of a
    /// chart, taken from the solver's own elements; the [report](bake::BakeReport) tells how much. Laying out the pages comes after that.
    ///
    /// # Errors
    /// As [`Evaluator::bake`].
    pub fn bake_within(
        &self,
        atlas: &Atlas,
        mesh: Option<&LitMesh>,
        time_s: Option<f64>,
        observer: &dyn Observer,
    ) -> Result<Option<Lightmap>, BakeError> {
        self.bake_of(atlas, mesh.map_or(Way::Gather(None), Way::Read), time_s, observer)
    }

    fn bake_of(
        &self,
        atlas: &Atlas,
        way: Way<'_>,
        time_s: Option<f64>,
        observer: &dyn Observer,
    ) -> Result<Option<Lightmap>, BakeError> {
        let until = time_s.and_then(|seconds| Instant::now().checked_add(Duration::try_from_secs_f64(seconds).ok()?));
        let (scene, seed) = (self.solution.scene(), self.solution.options().seed);
        if !atlas.is_of(scene) {
            return Err(BakeError::OtherScene);
        }
        match way {
            Way::Read(_) if atlas.options().separate || atlas.options().keep => return Err(BakeError::MeshIsWhole),
            Way::Gather(Some(earlier)) => earlier.check(self.terms(atlas))?,
            _ => {}
        }
        let rays = self.rays();
        let cancelled = || observer.cancelled();
        self.pool.install(|| {
            let mut texels = bake::texels_of(atlas, scene, &cancelled);
            let hidden = bake::hide(scene, &mut texels, &rays, seed, &cancelled);
            if cancelled() {
                return Ok(None);
            }
            let found = match way {
                Way::Read(mesh) => {
                    let stop = || observer.cancelled() || is_over(until);
                    read(&mut texels, &self.reader(mesh), scene, &stop);
                    let coarse = |surface, point| self.coarse_at(surface, point);
                    let nothing_between = vec![0; texels.len()];
                    bake::complete(scene, &mut texels, &nothing_between, &coarse);
                    Some(Found { not_found: NotFound::of(&texels), ..Found::default() })
                }
                Way::Gather(earlier) => {
                    let bases = earlier.map(|earlier| earlier.bases(scene, &texels)).transpose()?.unwrap_or_default();
                    self.gather_texels((atlas, &mut texels), &bases, &rays, until, observer)
                }
            };
            let Some(found) = found else { return Ok(None) };
            let lightmap = bake::finish(scene, atlas, &texels, (hidden, found), &cancelled);
            Ok((!observer.cancelled()).then_some(lightmap))
        })
    }

    /// What another bake must have in common with one of this atlas.
    fn terms(&self, atlas: &Atlas) -> Terms {
        let (options, bake) = (self.solution.options(), atlas.options());
        let (channels, is_local) = (self.solution.scene().channels() as u32, options.norm == Norm::Local);
        Terms { texel: bake.texel, channels, is_apart: bake.separate, error: options.error, is_local }
    }

    /// Bytes that baking takes with all that there is meanwhile, about: program, scene, visibility by this backend, solution and texels.
    pub fn bytes_to_bake(&self, atlas: &Atlas, backend: Backend) -> u64 {
        let scene = self.solution.scene();
        solve::least_bytes(scene, backend) + self.solution.memory_bytes() + atlas.bytes_to_bake(scene.channels())
    }

    /// Gathers texels; `None` if the observer cancels.
    fn gather_texels(
        &self,
        (atlas, texels): (&Atlas, &mut [Texels<'_>]),
        bases: &[Option<Base<'_>>],
        rays: &Rays<'_>,
        until: Option<Instant>,
        observer: &dyn Observer,
    ) -> Option<Found> {
        let (scene, options) = (self.solution.scene(), self.solution.options());
        let stop = || observer.cancelled() || is_over(until);
        let paths = self.solution.light_paths(rays, &stop);
        let gather = self.solution.gather_at_points(rays, paths.as_ref());
        let gather = if atlas.options().separate { gather.keeping_apart() } else { gather };
        let lines = discontinuities::of_shape(scene, &stop);
        let coarse = |surface, point| self.coarse_at(surface, point);
        let keep = atlas.options().keep.then(|| self.terms(atlas));
        let asked = Asked { gather: &gather, error_bars: self.solution.error_bars, observer, until, coarse: &coarse, keep };
        let aim = Aim { error: options.error, norm: options.norm.into(), seed: options.seed };
        bake::gather(scene, texels, &lines, bases, (aim, asked))
    }

    /// What the solver's element at a point reflects, by channel in W/m^2.
    fn coarse_at(&self, surface: SurfaceId, point: DVec3) -> Vec<f32> {
        let leaf = self.solution.hierarchy().leaf_at(surface, point);
        let exitance = &self.solution.scene().material_of(surface).exitance;
        self.solution.radiosity().of(leaf).iter().zip(exitance).map(|(b, e)| (b - e).max(0.0) as f32).collect()
    }
}

fn is_over(until: Option<Instant>) -> bool {
    until.is_some_and(|until| Instant::now() >= until)
}

/// Reads all texels that have no value yet off a mesh; once it is stopped, nothing more.
fn read(texels: &mut [Texels<'_>], reader: &MeshReader<'_>, scene: &Scene, stop: Stop<'_>) {
    texels.par_iter_mut().for_each(|of_chart| {
        let wanted: Vec<usize> = (0..of_chart.sites.len()).filter(|&index| of_chart.is_wanted(index)).collect();
        let of_texel = |&index: &usize| {
            if stop() {
                return None;
            }
            let mut reflected = vec![0.0; scene.channels()];
            reader.reflected_at(of_chart.point(scene, index), SurfaceId(of_chart.sites[index].surface), &mut reflected);
            Some(reflected.into_iter().map(|b| b as f32).collect::<Vec<f32>>())
        };
        let found: Vec<Option<Vec<f32>>> = wanted.par_iter().map(of_texel).collect();
        let found = wanted.iter().zip(&found).filter_map(|(&index, found)| Some((index, found.as_ref()?)));
        found.for_each(|(index, reflected)| of_chart.set(index, reflected, &[]));
    });
}
